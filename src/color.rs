//! From values to colours: maps, ranges and the palette that files carry.

use crate::curvature::{FaceClass, FaceCurvature};
use crate::error::Error;
use crate::mesh::Face;
use crate::quantity::Quantity;
use rayon::prelude::*;

/// An sRGB colour, 8 bits a channel.
pub type Rgb = [u8; 3];

/// Colours of a palette: `SCALE` for the range, one for faces without estimate.
pub(crate) const PALETTE: usize = 256;
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

/// How a gradient's colours are spaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Spacing {
    /// Two arms that meet in the middle, each of even steps.
    Diverging,
    /// As its makers spaced it.
    Given,
}

/// Name, gradient, whether it runs backwards, and spacing.
type Entry = (&'static str, colorous::Gradient, bool, Spacing);

const GRADIENTS: [Entry; 11] = [
    ("blue-red", colorous::RED_BLUE, true, Spacing::Diverging),
    ("purple-orange", colorous::PURPLE_ORANGE, true, Spacing::Diverging),
    ("purple-green", colorous::PURPLE_GREEN, false, Spacing::Diverging),
    ("brown-green", colorous::BROWN_GREEN, false, Spacing::Diverging),
    ("viridis", colorous::VIRIDIS, false, Spacing::Given),
    ("cividis", colorous::CIVIDIS, false, Spacing::Given),
    ("magma", colorous::MAGMA, false, Spacing::Given),
    ("inferno", colorous::INFERNO, false, Spacing::Given),
    ("plasma", colorous::PLASMA, false, Spacing::Given),
    ("turbo", colorous::TURBO, false, Spacing::Given),
    ("greys", colorous::GREYS, true, Spacing::Given),
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

    /// The one that shows a quantity where `wanted` is asked for; classes have one of their own.
    pub(crate) fn of(quantity: Quantity, wanted: Option<Colormap>) -> Self {
        wanted.filter(|_| quantity != Quantity::Class).unwrap_or(Colormap::default_for(quantity))
    }

    /// Diverging for signed quantities, sequential for others, one colour each for classes.
    pub fn default_for(quantity: Quantity) -> Self {
        match quantity {
            Quantity::Class => Colormap { name: "classes" },
            _ if quantity.is_signed() => Colormap { name: "blue-red" },
            _ => Colormap { name: "viridis" },
        }
    }

    /// All maps and that of the classes.
    pub(crate) fn all() -> impl Iterator<Item = Colormap> {
        let classes = Colormap::default_for(Quantity::Class);
        Colormap::names().map(|name| Colormap { name }).chain([classes])
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// All colours of the palette; the last is for faces without estimate.
    pub fn palette(self) -> [Rgb; PALETTE] {
        let mut palette = [NOT_ESTIMATED; PALETTE];
        match GRADIENTS.iter().find(|entry| entry.0 == self.name) {
            Some((_, gradient, backwards, spacing)) => {
                let color = |at: f64| {
                    let rgb = gradient.eval_continuous(if *backwards { 1.0 - at } else { at });
                    [rgb.r, rgb.g, rgb.b]
                };
                let spaced: Box<dyn Fn(f64) -> f64> = match spacing {
                    Spacing::Given => Box::new(|at| at),
                    Spacing::Diverging => {
                        let (low, high) = (even_steps(&color, 0.0, 0.5), even_steps(&color, 0.5, 1.0));
                        Box::new(move |at| if at < 0.5 { low(2.0 * at) } else { high(2.0 * at - 1.0) })
                    }
                };
                for (i, slot) in palette[..SCALE].iter_mut().enumerate() {
                    *slot = color(spaced(i as f64 / (SCALE - 1) as f64));
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

/// Where on a gradient between `from` and `to` equal steps from 0 to 1 look equally large.
fn even_steps(color: &dyn Fn(f64) -> Rgb, from: f64, to: f64) -> Box<dyn Fn(f64) -> f64> {
    /// Finer, and the rounding of colours to 8 bits would be measured.
    const PARTS: usize = 32;
    let place = move |part: f64| from + (to - from) * part / PARTS as f64;
    let mut lengths = vec![0.0];
    for part in 0..PARTS {
        let (a, b) = (oklab(color(place(part as f64))), oklab(color(place(part as f64 + 1.0))));
        let step = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
        lengths.push(lengths[part] + step);
    }
    Box::new(move |share| {
        let wanted = share.clamp(0.0, 1.0) * lengths[PARTS];
        let part = lengths[1..PARTS].partition_point(|&length| length < wanted);
        let step = lengths[part + 1] - lengths[part];
        place(part as f64 + if step > 0.0 { (wanted - lengths[part]) / step } else { 0.0 })
    })
}

/// Lightness and two opponent colours, in which equal distances look about equally large
/// (Ottosson, A perceptual color space for image processing, 2020).
fn oklab(color: Rgb) -> [f64; 3] {
    let [r, g, b] = color.map(|channel| f64::from(linear_factor(channel)));
    let l = (0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b).cbrt();
    let m = (0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b).cbrt();
    let s = (0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b).cbrt();
    [
        0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
        1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
        0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
    ]
}

/// The values that the ends of the colour scale stand for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ColorRange {
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
        range: ColorRange,
        values: &[FaceCurvature],
    ) -> Result<Self, Error> {
        check(quantity, range)?;
        let (low, high) = match (range, quantity) {
            (_, Quantity::Class) => (0.0, CLASSES.len() as f64),
            (ColorRange::Fixed(low, high), _) => (low, high),
            (ColorRange::Auto, Quantity::ShapeIndex) => (-1.0, 1.0),
            (ColorRange::Auto, _) => {
                let reach = robust_magnitude(quantity, values);
                (if quantity.is_signed() { -reach } else { 0.0 }, reach)
            }
        };
        let map = Colormap::of(quantity, map);
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
pub(crate) fn check(quantity: Quantity, range: ColorRange) -> Result<(), Error> {
    use Quantity::{DirMax, DirMin, Face, Method, Radius};
    if matches!(quantity, Face | DirMax | DirMin | Radius | Method) {
        return Err(Error::Usage(format!("faces cannot be coloured by {}", quantity.token())));
    }
    match range {
        ColorRange::Fixed(..) if quantity == Quantity::Class => {
            Err(Error::Usage("classes have no range; leave --range out".into()))
        }
        ColorRange::Fixed(low, high) if !(low < high && low.is_finite() && high.is_finite()) => {
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
        let scale = ColorScale::new(Quantity::Mean, None, ColorRange::Auto, &values).expect("a scale");
        assert_eq!((scale.low, scale.high), (-2.0, 2.0));
        assert_eq!(values.map(|v| scale.color_index(&v)), [254, 64, 127, 255]);
        let palette = scale.map.palette();
        assert_eq!(palette[255], NOT_ESTIMATED);
        assert!(palette[0][2] > palette[0][0] && palette[254][0] > palette[254][2], "blue is low, red is high");
    }

    #[test]
    fn steps_of_a_scale_look_equally_large() {
        let distance = |a: Rgb, b: Rgb| {
            let (a, b) = (oklab(a), oklab(b));
            (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
        };
        for (name, _, _, spacing) in GRADIENTS {
            let palette = Colormap::named(name).expect("known").palette();
            if spacing == Spacing::Given {
                continue;
            }
            for arm in [0..=127, 127..=254] {
                let colors: Vec<Rgb> = arm.step_by(12).map(|i| palette[i]).collect();
                let steps: Vec<f64> = colors.windows(2).map(|pair| distance(pair[0], pair[1])).collect();
                let (least, most) = steps.iter().fold((f64::MAX, 0.0_f64), |(l, m), &s| (l.min(s), m.max(s)));
                assert!(most < 1.35 * least, "{name}: {least} to {most}");
            }
            let lightness = |i: usize| oklab(palette[i])[0];
            assert!((0..255).all(|i| lightness(i) <= lightness(127) + 1e-9), "{name} is lightest in the middle");
        }
        let classes: Vec<[f64; 3]> = CLASSES.iter().map(|&color| oklab(color)).collect();
        for (i, a) in CLASSES.iter().enumerate() {
            assert!(CLASSES[..i].iter().all(|b| distance(*a, *b) > 0.15), "{classes:?}");
        }
    }

    #[test]
    fn what_lies_outside_the_range_is_counted() {
        let values = [with_k(2.0, 2.0), with_k(-1.0, -1.0)];
        let scale = ColorScale::new(Quantity::KMax, None, ColorRange::Fixed(0.0, 1.0), &values).expect("a scale");
        assert_eq!(scale.clipped, 2);
        assert!(
            ColorScale::new(Quantity::KMax, None, ColorRange::Fixed(1.0, 0.0), &values).is_err_and(|e| e.is_usage())
        );
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
