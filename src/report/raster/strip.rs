//! The legend below a picture: what is shown, its colours and their values.

use crate::color::{ColorScale, Rgb, class_index, scale_index};
use crate::curvature::FaceClass;
use crate::legend::number;
use crate::quantity::Quantity;
use crate::space::Unit;
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Rows that it takes.
pub(super) const HEIGHT: usize = 78;
const BAR_TOP: usize = 26;
const BAR_HEIGHT: usize = 12;
const LABELS: usize = 44;
const WIDEST: usize = 560;
const CHARACTER: usize = get_raster_width(FontWeight::Regular, RasterHeight::Size16);

/// Draws it into the rows from `top` on.
pub(super) fn draw(
    image: &mut [[u8; 4]],
    width: usize,
    top: usize,
    colors: &ColorScale,
    unit: Option<Unit>,
    transparent: bool,
) {
    // Grey is read on light and on dark; ink on paper is read better.
    let ink: Rgb = if transparent { [120, 120, 120] } else { [40, 44, 49] };
    let bar = WIDEST.min(width * 4 / 5);
    let left = (width - bar) / 2;
    let palette = colors.map.palette();
    let mut canvas = Canvas { image, width };
    let length = unit.map_or("unit", Unit::symbol);
    let (title, bands, labels) = if colors.quantity == Quantity::Class {
        let classes: Vec<FaceClass> = FaceClass::ALL.into_iter().filter(|class| class.code() >= 0).collect();
        let share = |i: usize| (i as f64 + 0.5) / classes.len() as f64;
        let labels = classes.iter().enumerate().map(|(i, class)| (share(i), class.name().to_owned())).collect();
        ("class".to_owned(), classes.iter().map(|&class| palette[class_index(class)]).collect::<Vec<_>>(), labels)
    } else {
        let title = match colors.quantity.dimension() {
            0 => colors.quantity.token().to_owned(),
            -1 => format!("{} [1/{length}]", colors.quantity.token()),
            n => format!("{} [1/{length}^{}]", colors.quantity.token(), -n),
        };
        let value = |share: f64| colors.low * (1.0 - share) + colors.high * share;
        let labels: Vec<(f64, String)> = [0.0, 0.5, 1.0].map(|share| (share, number(value(share)))).into();
        (title, (0..bar).map(|x| palette[scale_index(x as f64 / (bar - 1) as f64)]).collect(), labels)
    };
    canvas.text(left as i64, top, &title, ink);
    for y in top + BAR_TOP..top + BAR_TOP + BAR_HEIGHT {
        for x in 0..bar {
            let [r, g, b] = bands[x * bands.len() / bar];
            canvas.put(left + x, y, [r, g, b, 255]);
        }
    }
    for (share, label) in labels {
        let middle = left as f64 + share * bar as f64;
        let start = middle - 0.5 * (CHARACTER * label.chars().count()) as f64;
        canvas.text(start.clamp(4.0, width as f64) as i64, top + LABELS, &label, ink);
    }
}

struct Canvas<'i> {
    image: &'i mut [[u8; 4]],
    width: usize,
}

impl Canvas<'_> {
    fn put(&mut self, x: usize, y: usize, color: [u8; 4]) {
        if x < self.width
            && let Some(pixel) = self.image.get_mut(y * self.width + x)
        {
            *pixel = color;
        }
    }

    fn text(&mut self, x: i64, y: usize, text: &str, [r, g, b]: Rgb) {
        for (n, character) in (0..).zip(text.chars()) {
            let Some(raster) = get_raster(character, FontWeight::Regular, RasterHeight::Size16) else { continue };
            for (row, line) in raster.rows().enumerate() {
                for (column, &opacity) in line.iter().enumerate().filter(|(_, opacity)| **opacity > 0) {
                    if let Ok(x) = usize::try_from(x + n * CHARACTER as i64 + column as i64) {
                        self.put(x, y + row, [r, g, b, opacity]);
                    }
                }
            }
        }
    }
}
