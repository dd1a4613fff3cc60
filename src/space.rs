//! Axes and units of the input, and how an output has them.

use crate::error::Error;
use crate::io::InputFormat;
use crate::quantity::Quantity;
use crate::soup::Soup;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};

/// The unit that the input's coordinates are in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[non_exhaustive]
pub enum Unit {
    /// Millimetres.
    #[serde(rename = "mm")]
    Millimetre,
    /// Centimetres.
    #[serde(rename = "cm")]
    Centimetre,
    /// Metres.
    #[serde(rename = "m")]
    Metre,
    /// Inches.
    #[serde(rename = "in")]
    Inch,
}

impl Unit {
    /// Metres in one of this unit.
    pub fn in_metres(self) -> f64 {
        match self {
            Unit::Millimetre => 0.001,
            Unit::Centimetre => 0.01,
            Unit::Metre => 1.0,
            Unit::Inch => 0.0254,
        }
    }

    /// Its symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            Unit::Millimetre => "mm",
            Unit::Centimetre => "cm",
            Unit::Metre => "m",
            Unit::Inch => "in",
        }
    }

    /// The unit that a file of another format than glTF names.
    pub(crate) fn of_file(soup: &Soup, format: InputFormat) -> Option<Self> {
        let metres = soup.metres_per_unit.filter(|_| format != InputFormat::Gltf)?;
        let all = [Unit::Millimetre, Unit::Centimetre, Unit::Metre, Unit::Inch];
        all.into_iter().find(|unit| unit.in_metres() == metres)
    }

    /// What to do about a unit that the file names: lengths are only scaled where that is asked for.
    pub(crate) fn hint(self) -> String {
        let unit = self.symbol();
        format!("the file says that its lengths are in {unit}: --unit {unit} makes them metres in glTF")
    }
}

/// From the input's axes and units to those of an output.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Space {
    /// True when the input's +Z is up and becomes the output's +Y.
    pub z_up: bool,
    /// The input's unit, where it is known; lengths then become metres, unless they are kept.
    pub unit: Option<Unit>,
    /// True where the output keeps the input's axes and unit, which are then only told.
    pub(crate) is_kept: bool,
}

/// Which of the input's axes points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum UpAxis {
    /// +Y, as in glTF.
    Y,
    /// +Z; a glTF output is turned so that it becomes +Y.
    Z,
}

impl Space {
    /// From an input's axes and units to those of glTF. Without `up`, +Z is up in STL and 3MF and +Y in
    /// everything else.
    ///
    /// # Errors
    /// [`Error::Usage`] where the input is glTF, whose axes and unit are fixed.
    pub fn to_gltf(input: InputFormat, up: Option<UpAxis>, unit: Option<Unit>) -> Result<Self, Error> {
        if input == InputFormat::Gltf {
            if unit.is_some() {
                return Err(Error::Usage("--unit does not apply to glTF, whose unit is the metre".into()));
            }
            if up == Some(UpAxis::Z) {
                return Err(Error::Usage("--up z does not apply to glTF, in which Y is up".into()));
            }
        }
        let z_up = up.map_or(input.is_z_up(), |up| up == UpAxis::Z);
        let unit = if input == InputFormat::Gltf { Some(Unit::Metre) } else { unit };
        Ok(Space { z_up, unit, is_kept: false })
    }

    /// For outputs in the input's own axes and units.
    pub(crate) fn kept(self) -> Self {
        Space { is_kept: true, ..self }
    }

    /// True where the input's +Z becomes the output's +Y.
    fn turns(self) -> bool {
        self.z_up && !self.is_kept
    }

    /// Output length of an input length of one.
    pub fn scale(self) -> f64 {
        self.unit.filter(|_| !self.is_kept).map_or(1.0, Unit::in_metres)
    }

    /// A point or vector of the input with length.
    pub fn point(self, p: DVec3) -> DVec3 {
        self.scale() * if self.turns() { DVec3::new(p.x, p.z, -p.y) } else { p }
    }

    /// A unit vector of the input.
    pub fn direction(self, d: Vec3) -> Vec3 {
        if self.turns() { Vec3::new(d.x, d.z, -d.y) } else { d }
    }

    /// Which component of a direction of the input becomes a component of the output, and its sign there.
    pub(crate) fn turned_component(self, component: usize) -> (usize, f32) {
        match (self.turns(), component) {
            (true, 1) => (2, 1.0),
            (true, 2) => (1, -1.0),
            _ => (component, 1.0),
        }
    }

    /// The factor for a quantity of this dimension (a power of length).
    pub fn factor(self, dimension: i32) -> f64 {
        self.scale().powi(dimension)
    }

    /// The output's unit of length, where it is known.
    fn output_unit(self) -> Option<&'static str> {
        self.unit.map(|unit| if self.is_kept { unit.symbol() } else { "m" })
    }

    /// The unit of a quantity in the output, such as `1/m^2`; `1/unit` where the length unit is not known.
    pub fn unit_of(self, quantity: Quantity) -> String {
        let length = self.output_unit().unwrap_or("unit");
        match quantity.dimension() {
            0 => String::new(),
            1 => length.to_owned(),
            -1 => format!("1/{length}"),
            n => format!("1/{length}^{}", -n),
        }
    }

    /// Units and up axis of the input and unit of the output.
    pub fn units(self) -> Value {
        json!({
            "input": self.unit.map_or("unknown", Unit::symbol),
            "output": self.output_unit().unwrap_or("unknown"),
            "input_up": if self.z_up { "z" } else { "y" },
        })
    }
}
