//! The one table of quantities: names in every file, dimension, and what is written by default.

use crate::curvature::FaceCurvature;
use crate::error::Error;
use crate::mesh::Face;

/// A value that every face has. In the order of CSV columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Quantity {
    /// The face's number, from 0, in the order of the input.
    Face,
    /// The class code, -1 to 4.
    Class,
    /// Largest normal curvature.
    KMax,
    /// Smallest normal curvature.
    KMin,
    /// Mean curvature.
    Mean,
    /// Gaussian curvature, the product of k_max and k_min.
    Gauss,
    /// Gaussian curvature from the disk's perimeter.
    GaussPerimeter,
    /// Shape index.
    ShapeIndex,
    /// Curvedness.
    Curvedness,
    /// Unit tangent of k_max.
    DirMax,
    /// Unit tangent of k_min.
    DirMin,
    /// Length of the disk's legs.
    Radius,
    /// Share of the legs that reached the radius, or of the window without borders.
    Coverage,
    /// Where the values come from: a word, in CSV only.
    Method,
    /// How far to trust the values.
    Confidence,
}

/// A row of the table.
struct Row {
    quantity: Quantity,
    /// CSV column or columns, PLY face property, and `--attributes` token when there is one column.
    columns: &'static [&'static str],
    /// glTF attribute of each column.
    attributes: &'static [&'static str],
    /// The quantity changes by the scale of lengths to this power.
    dimension: i32,
    in_csv: bool,
    in_gltf: bool,
}

const TABLE: [Row; 15] = [
    row(Quantity::Face, &["face"], &["_FACE_ID"], 0, true, true),
    row(Quantity::Class, &["class"], &["_CURVATURE_CLASS"], 0, true, true),
    row(Quantity::KMax, &["k_max"], &["_CURVATURE_MAX"], -1, true, true),
    row(Quantity::KMin, &["k_min"], &["_CURVATURE_MIN"], -1, true, true),
    row(Quantity::Mean, &["mean"], &["_CURVATURE_MEAN"], -1, true, true),
    row(Quantity::Gauss, &["gauss"], &["_CURVATURE_GAUSS"], -2, true, true),
    row(Quantity::GaussPerimeter, &["gauss_perimeter"], &["_CURVATURE_GAUSS_PERIMETER"], -2, true, true),
    row(Quantity::ShapeIndex, &["shape_index"], &["_SHAPE_INDEX"], 0, false, false),
    row(Quantity::Curvedness, &["curvedness"], &["_CURVEDNESS"], -1, false, false),
    row(
        Quantity::DirMax,
        &["dir_max_x", "dir_max_y", "dir_max_z"],
        &["_DIRECTION_MAX_X", "_DIRECTION_MAX_Y", "_DIRECTION_MAX_Z"],
        0,
        true,
        true,
    ),
    row(
        Quantity::DirMin,
        &["dir_min_x", "dir_min_y", "dir_min_z"],
        &["_DIRECTION_MIN_X", "_DIRECTION_MIN_Y", "_DIRECTION_MIN_Z"],
        0,
        true,
        false,
    ),
    row(Quantity::Radius, &["radius"], &["_RADIUS"], 1, true, false),
    row(Quantity::Coverage, &["coverage"], &["_COVERAGE"], 0, true, true),
    row(Quantity::Method, &["method"], &[], 0, true, false),
    row(Quantity::Confidence, &["confidence"], &["_CONFIDENCE"], 0, true, true),
];

const fn row(
    quantity: Quantity,
    columns: &'static [&'static str],
    attributes: &'static [&'static str],
    dimension: i32,
    in_csv: bool,
    in_gltf: bool,
) -> Row {
    Row { quantity, columns, attributes, dimension, in_csv, in_gltf }
}

impl Quantity {
    /// All quantities, in the order of CSV columns.
    pub const ALL: [Quantity; 15] = {
        let mut all = [Quantity::Face; 15];
        let mut i = 0;
        while i < 15 {
            all[i] = TABLE[i].quantity;
            i += 1;
        }
        all
    };

    fn row(self) -> &'static Row {
        &TABLE[self as usize]
    }

    /// The name on the command line, such as `k_max` or `dir_max`.
    pub fn token(self) -> &'static str {
        match self {
            Quantity::DirMax => "dir_max",
            Quantity::DirMin => "dir_min",
            _ => self.row().columns[0],
        }
    }

    /// The quantity with this name on the command line.
    pub fn from_token(token: &str) -> Option<Self> {
        Quantity::ALL.into_iter().find(|q| q.token() == token)
    }

    /// Names of its CSV columns and PLY properties: three for a direction, one otherwise.
    pub fn columns(self) -> &'static [&'static str] {
        self.row().columns
    }

    /// False for a quantity that is a word and no number: only CSV has it.
    pub fn is_number(self) -> bool {
        self != Quantity::Method
    }

    /// Names of its glTF attributes, one for each column; none for a word.
    pub fn attributes(self) -> &'static [&'static str] {
        self.row().attributes
    }

    /// Making all lengths s times as long multiplies the quantity by s to this power.
    pub fn dimension(self) -> i32 {
        self.row().dimension
    }

    /// True for quantities whose zero divides two kinds of surface.
    pub fn is_signed(self) -> bool {
        use Quantity::{Gauss, GaussPerimeter, KMax, KMin, Mean, ShapeIndex};
        matches!(self, KMax | KMin | Mean | Gauss | GaussPerimeter | ShapeIndex)
    }

    /// The quantity of a face; for a direction, its component along axis `component`. NaN where it
    /// is not estimated.
    #[inline]
    pub fn value(self, face: Face, of: &FaceCurvature, component: usize) -> f32 {
        match self {
            Quantity::Face => face.0 as f32,
            Quantity::Class => of.class.code().into(),
            Quantity::KMax => of.k_max,
            Quantity::KMin => of.k_min,
            Quantity::Mean => of.mean(),
            Quantity::Gauss => of.gauss(),
            Quantity::GaussPerimeter => of.gauss_perimeter,
            Quantity::ShapeIndex => of.shape_index(),
            Quantity::Curvedness => of.curvedness(),
            Quantity::DirMax if of.is_estimated() => of.dir_max[component],
            Quantity::DirMin if of.is_estimated() => of.dir_min[component],
            Quantity::DirMax | Quantity::DirMin => f32::NAN,
            Quantity::Radius => of.radius,
            Quantity::Coverage => of.coverage,
            Quantity::Method => f32::NAN,
            Quantity::Confidence => of.confidence,
        }
    }

    /// The values of many faces in a row, of which `first` is the first, as [`Quantity::value`] has each: what they are
    /// is asked once.
    pub(crate) fn values(self, first: Face, of: &[FaceCurvature], component: usize, out: &mut [f32]) {
        macro_rules! each {
            ($($quantity:ident)+) => {
                match self {
                    $(Quantity::$quantity => out.iter_mut().zip(of).zip(first.0..).for_each(|((slot, of), face)| {
                        *slot = Quantity::$quantity.value(Face(face), of, component);
                    }),)+
                }
            };
        }
        each!(Face Class KMax KMin Mean Gauss GaussPerimeter ShapeIndex Curvedness DirMax DirMin Radius Coverage
            Method Confidence);
    }

    /// The value times `factor`, as binary files carry it: always finite, 0 where the face has no
    /// such value (class: -1).
    pub(crate) fn stored(self, face: Face, of: &FaceCurvature, component: usize, factor: f64) -> f32 {
        finite(f64::from(self.value(face, of, component)) * factor)
    }
}

/// A value as binary files carry it.
#[inline]
pub(crate) fn finite(value: f64) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(f32::MIN.into(), f32::MAX.into()) as f32 }
}

/// Which quantities a file gets: those its format has by default, or others, or both.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Selection {
    defaults: bool,
    extra: Vec<Quantity>,
    /// Left out of the defaults.
    #[serde(skip)]
    without: Option<Quantity>,
}

impl Default for Selection {
    fn default() -> Self {
        Selection { defaults: true, extra: Vec::new(), without: None }
    }
}

impl Selection {
    /// Reads a list such as `k_max,k_min` or `default,shape_index`; `all`, `default` and `none` stand
    /// for what they say.
    ///
    /// # Errors
    /// [`Error::Usage`] that names an unknown token and lists the known ones.
    pub fn parse(list: &str) -> Result<Self, Error> {
        let mut selection = Selection { defaults: false, extra: Vec::new(), without: None };
        for token in list.split(',').map(str::trim) {
            match token {
                "default" => selection.defaults = true,
                "all" => selection.extra.extend(Quantity::ALL),
                "none" => {}
                _ => selection.extra.push(Quantity::from_token(token).ok_or_else(|| {
                    let known: Vec<&str> = Quantity::ALL.iter().map(|q| q.token()).collect();
                    Error::Usage(format!(
                        "unknown attribute \"{token}\"; known are {}, default, all and none",
                        known.join(", ")
                    ))
                })?),
            }
        }
        Ok(selection)
    }

    /// True for a quantity that was asked for by name, or by `all`.
    pub fn names(&self, quantity: Quantity) -> bool {
        self.extra.contains(&quantity)
    }

    /// The same with a quantity left out of the defaults.
    pub(crate) fn without(&self, quantity: Quantity) -> Selection {
        Selection { without: Some(quantity), ..self.clone() }
    }

    /// The quantities of a CSV file, in the order of the table.
    pub fn for_csv(&self) -> Vec<Quantity> {
        self.pick(|row| row.in_csv)
    }

    /// The quantities of a file that holds numbers only (PLY, NPZ), in the order of the table.
    pub fn for_tables(&self) -> Vec<Quantity> {
        self.for_csv().into_iter().filter(|q| q.is_number()).collect()
    }

    /// The quantities of a glTF file, in the order of the table.
    pub fn for_gltf(&self) -> Vec<Quantity> {
        self.pick(|row| row.in_gltf).into_iter().filter(|q| q.is_number()).collect()
    }

    fn pick(&self, by_default: impl Fn(&Row) -> bool) -> Vec<Quantity> {
        let wanted = |row: &&Row| {
            (self.defaults && by_default(row) && self.without != Some(row.quantity))
                || self.extra.contains(&row.quantity)
        };
        TABLE.iter().filter(wanted).map(|row| row.quantity).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_quantity_stands_in_its_own_row() {
        for (i, quantity) in Quantity::ALL.into_iter().enumerate() {
            assert_eq!(quantity as usize, i);
            assert_eq!(quantity.row().quantity, quantity);
            assert_eq!(Quantity::from_token(quantity.token()), Some(quantity));
            assert!(quantity.columns().len() == quantity.attributes().len() || !quantity.is_number());
        }
    }

    #[test]
    fn selections_keep_the_order_of_the_table() {
        let picked = |list| Selection::parse(list).map(|s| s.for_gltf());
        assert_eq!(picked("k_min,k_max").ok(), Some(vec![Quantity::KMax, Quantity::KMin]));
        assert!(
            picked("default,shape_index")
                .is_ok_and(|q| q.contains(&Quantity::ShapeIndex) && q.contains(&Quantity::Face))
        );
        assert_eq!(picked("none").ok(), Some(vec![]));
        assert!(picked("k_mux").is_err_and(|e| e.to_string().contains("k_mux") && e.is_usage()));
    }
}
