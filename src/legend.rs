//! A picture of the colour scales: what each colour stands for, as SVG or PNG.

use crate::annotation::Annotation;
use crate::color::{ColorScale, Rgb, class_index, scale_index};
use crate::curvature::FaceClass;
use crate::error::Error;
use crate::io::{Output, png};
use crate::quantity::Quantity;
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

const WIDTH: usize = 480;
const MARGIN: usize = 24;
const BAR: usize = WIDTH - 2 * MARGIN;
/// Height of a scale: title, bar, numbers, and what lies outside.
const HEIGHT: usize = 96;
const TITLE: usize = 8;
const BAR_TOP: usize = 30;
const BAR_HEIGHT: usize = 22;
const NUMBERS: usize = 58;
const OUTSIDE: usize = 76;
/// Width of a character.
const CHARACTER: usize = get_raster_width(FontWeight::Regular, RasterHeight::Size16);

/// One scale as it is drawn.
struct Scale {
    title: String,
    /// Bands of colour from left to right, equally wide.
    colors: Vec<Rgb>,
    /// Text under the bar: where its middle is, 0 to 1.
    labels: Vec<(f64, String)>,
    outside: String,
}

/// Checks that a legend can be written under this name.
///
/// # Errors
/// [`Error::Usage`] for another extension than .svg and .png.
pub(crate) fn check(path: &Path) -> Result<(), Error> {
    let extension = path.extension().map(|e| e.to_ascii_lowercase());
    match extension.as_ref().and_then(|e| e.to_str()) {
        Some("svg" | "png") => Ok(()),
        _ => Err(Error::Usage(format!("{}: the extension of a legend must be .svg or .png", path.display()))),
    }
}

/// Writes a picture of all colour scales of an annotation, in the units of the values it writes.
///
/// # Errors
/// [`Error::Io`].
pub(crate) fn write(annotation: &Annotation<'_>, out: &mut Output) -> Result<(), Error> {
    let scales: Vec<Scale> = annotation.colors.iter().map(|colors| scale(annotation, colors)).collect();
    let is_svg = out.path().extension().is_some_and(|e| e.eq_ignore_ascii_case("svg"));
    let bytes = if is_svg { svg(&scales).into_bytes() } else { pixels(&scales) };
    out.write_all(&bytes).map_err(|e| out.error(e))
}

fn scale(annotation: &Annotation<'_>, colors: &ColorScale) -> Scale {
    let palette = colors.map.palette();
    if colors.quantity == Quantity::Class {
        let classes: Vec<FaceClass> = FaceClass::ALL.into_iter().filter(|class| class.code() >= 0).collect();
        let count = classes.len();
        let middle = |i: usize| (i as f64 + 0.5) / count as f64;
        return Scale {
            title: "class".into(),
            colors: classes.iter().map(|&class| palette[class_index(class)]).collect(),
            labels: classes.iter().enumerate().map(|(i, class)| (middle(i), class.name().to_owned())).collect(),
            outside: "grey: not estimated".into(),
        };
    }
    let unit = annotation.space.unit_of(colors.quantity);
    let factor = annotation.space.factor(colors.quantity.dimension());
    let label = |share: f64| (share, number(factor * (colors.low * (1.0 - share) + colors.high * share)));
    Scale {
        title: if unit.is_empty() {
            colors.quantity.token().into()
        } else {
            format!("{} [{unit}]", colors.quantity.token())
        },
        colors: (0..BAR).map(|x| palette[scale_index(x as f64 / (BAR - 1) as f64)]).collect(),
        labels: [0.0, 0.25, 0.5, 0.75, 1.0].map(label).into(),
        outside: match colors.clipped {
            0 => "grey: not estimated".into(),
            n => format!("{n} faces beyond the ends; grey: not estimated"),
        },
    }
}

/// A number of three digits.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let magnitude = value.abs().log10().floor();
    if (-3.0..5.0).contains(&magnitude) {
        let decimals = (2.0 - magnitude).max(0.0) as usize;
        let text = format!("{value:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.2e}")
    }
}

/// Where a text begins whose middle is at a share of the bar, kept inside the picture.
fn left(share: f64, text: &str) -> usize {
    let width = CHARACTER * text.len();
    let middle = MARGIN as f64 + share * BAR as f64;
    (middle - 0.5 * width as f64).clamp(4.0, (WIDTH - 4).saturating_sub(width) as f64) as usize
}

fn svg(scales: &[Scale]) -> String {
    let height = HEIGHT * scales.len();
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} {height}\" \
         font-family=\"monospace\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    for (i, scale) in scales.iter().enumerate() {
        let top = i * HEIGHT;
        let band = BAR as f64 / scale.colors.len() as f64;
        // Writing to a string cannot fail.
        let _ = writeln!(text, "<text x=\"{MARGIN}\" y=\"{}\">{}</text>", top + TITLE + 13, scale.title);
        for (b, [r, g, b_]) in scale.colors.iter().enumerate() {
            let (x, y) = (MARGIN as f64 + b as f64 * band, top + BAR_TOP);
            let _ = writeln!(
                text,
                "<rect x=\"{x}\" y=\"{y}\" width=\"{}\" height=\"{BAR_HEIGHT}\" fill=\"#{r:02x}{g:02x}{b_:02x}\"/>",
                band + if b + 1 < scale.colors.len() { 0.5 } else { 0.0 }
            );
        }
        for (share, label) in &scale.labels {
            let _ = writeln!(text, "<text x=\"{}\" y=\"{}\">{label}</text>", left(*share, label), top + NUMBERS + 13);
        }
        let _ =
            writeln!(text, "<text x=\"{MARGIN}\" y=\"{}\" fill=\"#666\">{}</text>", top + OUTSIDE + 13, scale.outside);
    }
    text + "</svg>\n"
}

fn pixels(scales: &[Scale]) -> Vec<u8> {
    let height = HEIGHT * scales.len();
    let mut image = vec![255; 3 * WIDTH * height];
    for (i, scale) in scales.iter().enumerate() {
        let top = i * HEIGHT;
        for y in top + BAR_TOP..top + BAR_TOP + BAR_HEIGHT {
            for x in 0..BAR {
                let at = 3 * (y * WIDTH + MARGIN + x);
                image[at..at + 3].copy_from_slice(&scale.colors[x * scale.colors.len() / BAR]);
            }
        }
        draw(&mut image, MARGIN, top + TITLE, &scale.title, 0);
        for (share, label) in &scale.labels {
            draw(&mut image, left(*share, label), top + NUMBERS, label, 0);
        }
        draw(&mut image, MARGIN, top + OUTSIDE, &scale.outside, 100);
    }
    png::rgb(WIDTH as u32, height as u32, &image)
}

/// Draws a text in a shade of grey.
fn draw(image: &mut [u8], x: usize, y: usize, text: &str, shade: u8) {
    for (n, character) in text.chars().enumerate() {
        let Some(raster) = get_raster(character, FontWeight::Regular, RasterHeight::Size16) else { continue };
        for (row, line) in raster.rows().enumerate() {
            for (column, &ink) in line.iter().enumerate() {
                let x = x + n * CHARACTER + column;
                let at = 3 * ((y + row) * WIDTH + x);
                let Some(pixel) = image.get_mut(at..at + 3).filter(|_| x < WIDTH) else { continue };
                for channel in pixel {
                    let (paper, ink) = (u32::from(*channel), u32::from(ink));
                    *channel = ((paper * (255 - ink) + u32::from(shade) * ink) / 255) as u8;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (0.5, "0.5"),
            (-1.309_06, "-1.31"),
            (1309.06, "1309"),
            (0.001_234, "0.00123"),
            (2.5e-7, "2.50e-7"),
            (1e6, "1.00e6"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
