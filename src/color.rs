//! From values to colours: maps, ranges and the palette that files carry.

use crate::curvature::{FaceClass, FaceCurvature};
use crate::error::Error;
use crate::mesh::Face;
use crate::quantity::Quantity;
use rayon::prelude::*;

/// An sRGB colour, 8 bits a channel.
pub type Rgb = [u8; 3];

/// Colours of a palette: `SCALE` for the range, one for faces without estimate.
pub const PALETTE: usize = 256;
/// Colours that the range is divided into; odd, so that the middle of a range has a colour of its own.
const SCALE: usize = PALETTE - 1;
const NOT_ESTIMATED: Rgb = [128, 128, 128];
/// The last colour of the palette.
pub(crate) const NOT_ESTIMATED_INDEX: usize = PALETTE - 1;

/// A named colour scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colormap {
    name: &'static str,
}

/// Name, gradient and whether it runs backwards. Diverging ones first.
type Entry = (&'static str, colorous::Gradient, bool);

const GRADIENTS: [Entry; 11] = [
    ("blue-red", colorous::RED_BLUE, true),
    ("purple-orange", colorous::PURPLE_ORANGE, true),
    ("purple-green", colorous::PURPLE_GREEN, false),
    ("brown-green", colorous::BROWN_GREEN, false),
    ("viridis", colorous::VIRIDIS, false),
    ("cividis", colorous::CIVIDIS, false),
    ("magma", colorous::MAGMA, false),
    ("inferno", colorous::INFERNO, false),
    ("plasma", colorous::PLASMA, false),
    ("turbo", colorous::TURBO, false),
    ("greys", colorous::GREYS, true),
];

/// Colours of the classes flat to hyperbolic, told apart by the colour-blind too
/// (Okabe and Ito, Color Universal Design, 2008).
const CLASSES: [Rgb; 5] = [[240, 228, 66], [86, 180, 233], [213, 94, 0], [204, 121, 167], [0, 114, 178]];

impl Colormap {
    /// Names of all maps that can be chosen.
    pub fn names() -> impl Iterator<Item = &'static str> {
        GRADIENTS.iter().map(|entry| entry.0)
    }

    /// The map of that name.
    ///
    /// # Errors
    /// [`Error::Usage`] that lists the names there are.
    pub fn named(name: &str) -> Result<Self, Error> {
        let entry = GRADIENTS.iter().find(|entry| entry.0 == name);
        let entry = entry.ok_or_else(|| {
            let known: Vec<&str> = Colormap::names().collect();
            Error::Usage(format!("unknown colour map \"{name}\"; known are {}", known.join(", ")))
        })?;
        Ok(Colormap { name: entry.0 })
    }

    /// Diverging for signed quantities, sequential for others, one colour each for classes.
    pub fn default_for(quantity: Quantity) -> Self {
        match quantity {
            Quantity::Class => Colormap { name: "classes" },
            _ if quantity.is_signed() => Colormap { name: "blue-red" },
            _ => Colormap { name: "viridis" },
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// All colours of the palette; the last is for faces without estimate.
    pub fn palette(self) -> [Rgb; PALETTE] {
        let mut palette = [NOT_ESTIMATED; PALETTE];
        match GRADIENTS.iter().find(|entry| entry.0 == self.name) {
            Some((_, gradient, backwards)) => {
                for (i, color) in palette[..SCALE].iter_mut().enumerate() {
                    let at = i as f64 / (SCALE - 1) as f64;
                    let rgb = gradient.eval_continuous(if *backwards { 1.0 - at } else { at });
                    *color = [rgb.r, rgb.g, rgb.b];
                }
            }
            None => {
                for (i, color) in palette[..SCALE].iter_mut().enumerate() {
                    *color = CLASSES[i * CLASSES.len() / SCALE];
                }
            }
        }
        palette
    }
}

/// The values that the ends of the colour scale stand for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Range {
    /// From the data: see [`ColorScale::new`].
    #[default]
    Auto,
    /// From a value to a larger one, in the unit of the quantity.
    Fixed(f64, f64),
}

/// A quantity's colours: map and range.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorScale {
    /// The quantity shown.
    pub quantity: Quantity,
    /// Its colours.
    pub map: Colormap,
    /// The value of the first colour.
    pub low: f64,
    /// The value of the last colour.
    pub high: f64,
    /// Faces whose value lies outside the range and that have the colour of its end.
    pub clipped: usize,
}

/// The share of faces whose magnitude an automatic range holds.
const ROBUST: f64 = 0.95;

impl ColorScale {
    /// Chooses the range where it is automatic: -1 to 1 for the shape index; otherwise the 95th
    /// percentile of the magnitudes, on both sides of zero for a signed quantity, from zero for
    /// others. Where that is zero, the largest magnitude; where all are zero, 1.
    ///
    /// # Errors
    /// [`Error::Usage`] for a range that is empty or reversed, or a quantity without a scale.
    pub fn new(
        quantity: Quantity,
        map: Option<Colormap>,
        range: Range,
        values: &[FaceCurvature],
    ) -> Result<Self, Error> {
        check(quantity, range)?;
        let (low, high) = match (range, quantity) {
            (_, Quantity::Class) => (0.0, CLASSES.len() as f64),
            (Range::Fixed(low, high), _) => (low, high),
            (Range::Auto, Quantity::ShapeIndex) => (-1.0, 1.0),
            (Range::Auto, _) => {
                let reach = robust_magnitude(quantity, values);
                (if quantity.is_signed() { -reach } else { 0.0 }, reach)
            }
        };
        let map = match quantity {
            Quantity::Class => Colormap::default_for(quantity),
            _ => map.unwrap_or(Colormap::default_for(quantity)),
        };
        let clipped = values.par_iter().filter(|v| {
            let value = f64::from(quantity.value(Face(0), v, 0));
            value < low || value > high
        });
        let clipped = if quantity == Quantity::Class { 0 } else { clipped.count() };
        Ok(ColorScale { quantity, map, low, high, clipped })
    }

    /// The index of a face's colour in the palette.
    #[inline]
    pub fn color_index(&self, of: &FaceCurvature) -> usize {
        let value = f64::from(self.quantity.value(Face(0), of, 0));
        if !of.is_estimated() || value.is_nan() {
            return NOT_ESTIMATED_INDEX;
        }
        if self.quantity == Quantity::Class {
            return class_index(of.class);
        }
        scale_index((value - self.low) / (self.high - self.low))
    }
}

/// The colour at a share of the range, 0 to 1; beyond, that of the nearer end.
pub(crate) fn scale_index(share: f64) -> usize {
    (share * (SCALE - 1) as f64).round().clamp(0.0, (SCALE - 1) as f64) as usize
}

/// The middle of a class's band in the palette.
pub(crate) fn class_index(class: FaceClass) -> usize {
    let band = SCALE / CLASSES.len();
    usize::try_from(class.code()).map_or(NOT_ESTIMATED_INDEX, |code| band * code + band / 2)
}

/// Refuses quantities and ranges that make no scale.
///
/// # Errors
/// [`Error::Usage`] with the reason.
pub(crate) fn check(quantity: Quantity, range: Range) -> Result<(), Error> {
    use Quantity::{Coverage, DirMax, DirMin, Face, Radius};
    if matches!(quantity, Face | DirMax | DirMin | Radius | Coverage) {
        return Err(Error::Usage(format!("faces cannot be coloured by {}", quantity.token())));
    }
    match range {
        Range::Fixed(..) if quantity == Quantity::Class => {
            Err(Error::Usage("classes have no range; leave --range out".into()))
        }
        Range::Fixed(low, high) if !(low < high && low.is_finite() && high.is_finite()) => {
            Err(Error::Usage(format!("the range {low}:{high} is empty or reversed; give the lower value first")))
        }
        _ => Ok(()),
    }
}

fn robust_magnitude(quantity: Quantity, values: &[FaceCurvature]) -> f64 {
    let mut magnitudes: Vec<f32> = values
        .par_iter()
        .filter(|v| v.is_estimated())
        .map(|v| quantity.value(Face(0), v, 0).abs())
        .filter(|m| m.is_finite())
        .collect();
    if magnitudes.is_empty() {
        return 1.0;
    }
    let at = ((magnitudes.len() - 1) as f64 * ROBUST).round() as usize;
    let (_, robust, above) = magnitudes.select_nth_unstable_by(at, f32::total_cmp);
    let reach = if *robust > 0.0 { *robust } else { above.iter().copied().fold(0.0, f32::max) };
    if reach > 0.0 { reach.into() } else { 1.0 }
}

/// The linear-light value of an sRGB channel, 8 bits in and out.
pub(crate) fn linear(channel: u8) -> u8 {
    (255.0 * linear_factor(channel)).round() as u8
}

/// The linear-light value of an sRGB channel, 0 to 1.
pub(crate) fn linear_factor(channel: u8) -> f32 {
    let c = f32::from(channel) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_k(k_max: f32, k_min: f32) -> FaceCurvature {
        FaceCurvature { k_max, k_min, class: FaceClass::Elliptic, ..FaceCurvature::NOT_ESTIMATED }
    }

    #[test]
    fn zero_has_the_middle_colour_and_no_estimate_is_grey() {
        let values = [with_k(2.0, 2.0), with_k(-1.0, -1.0), with_k(0.0, 0.0), FaceCurvature::NOT_ESTIMATED];
        let scale = ColorScale::new(Quantity::Mean, None, Range::Auto, &values).expect("a scale");
        assert_eq!((scale.low, scale.high), (-2.0, 2.0));
        assert_eq!(values.map(|v| scale.color_index(&v)), [254, 64, 127, 255]);
        let palette = scale.map.palette();
        assert_eq!(palette[255], NOT_ESTIMATED);
        assert!(palette[0][2] > palette[0][0] && palette[254][0] > palette[254][2], "blue is low, red is high");
    }

    #[test]
    fn what_lies_outside_the_range_is_counted() {
        let values = [with_k(2.0, 2.0), with_k(-1.0, -1.0)];
        let scale = ColorScale::new(Quantity::KMax, None, Range::Fixed(0.0, 1.0), &values).expect("a scale");
        assert_eq!(scale.clipped, 2);
        assert!(ColorScale::new(Quantity::KMax, None, Range::Fixed(1.0, 0.0), &values).is_err_and(|e| e.is_usage()));
    }

    #[test]
    fn each_class_has_its_own_colour() {
        let palette = Colormap::default_for(Quantity::Class).palette();
        for class in FaceClass::ALL {
            let color = palette[class_index(class)];
            let expected = usize::try_from(class.code()).map_or(NOT_ESTIMATED, |code| CLASSES[code]);
            assert_eq!(color, expected, "{class:?}");
        }
    }
}
