//! Values of options that are more than a number or a word.

use super::choices::ColorByArg;
use clap::ValueEnum;
use glam::DVec3;
use osculate::{ColorRange, Quantity, Radius, ViewFrom};

pub(super) fn radius(text: &str) -> Result<Radius, String> {
    match text {
        "auto" => Ok(Radius::Auto),
        _ => text.parse().map(Radius::Length).map_err(|_| "give a length or auto".into()),
    }
}

pub(super) fn radius_factor(text: &str) -> Result<Radius, String> {
    let (number, of) = text.split_once(':').unwrap_or((text, "face"));
    let factor = number.parse().map_err(|_| format!("\"{number}\" is no number"))?;
    match of {
        "face" => Ok(Radius::FaceFactor(factor)),
        "mesh" => Ok(Radius::MeshFactor(factor)),
        _ => Err(format!("\"{of}\" is neither face nor mesh")),
    }
}

pub(super) fn range(text: &str) -> Result<ColorRange, String> {
    if text == "auto" {
        return Ok(ColorRange::Auto);
    }
    let (low, high) = text.split_once(':').ok_or("give LOW:HIGH, such as -0.5:0.5, or auto")?;
    let number = |s: &str| s.parse().map_err(|_| format!("\"{s}\" is no number"));
    Ok(ColorRange::Fixed(number(low)?, number(high)?))
}

/// A quantity that colours can show.
pub(super) fn shown(text: &str) -> Result<Quantity, String> {
    let choices = || ColorByArg::value_variants().iter().filter_map(|&choice| Option::<Quantity>::from(choice));
    choices().find(|quantity| quantity.token() == text.trim()).ok_or_else(|| {
        let known: Vec<&str> = choices().map(Quantity::token).collect();
        format!("known are {}", known.join(", "))
    })
}

pub(super) fn vector(text: &str) -> Result<DVec3, String> {
    numbers(text).map(DVec3::from_array).ok_or_else(|| "give three numbers separated by commas".into())
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers: Vec<f64> = text.split(',').map(|s| s.trim().parse().ok()).collect::<Option<_>>()?;
    numbers.try_into().ok().filter(|all: &[f64; N]| all.iter().all(|c| c.is_finite()))
}

pub(super) fn pair(text: &str) -> Result<[f64; 2], String> {
    numbers(text).ok_or_else(|| "give two numbers separated by a comma".into())
}

pub(super) fn plane(text: &str) -> Result<[f64; 4], String> {
    match numbers(text) {
        Some([0.0, 0.0, 0.0, _]) => Err("a, b and c must not all be 0".into()),
        Some(plane) => Ok(plane),
        None => Err("give four numbers a,b,c,d".into()),
    }
}

pub(super) fn seeds(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n @ 1..=1_000_000) => Ok(n),
        _ => Err("give a number from 1 to 1000000".into()),
    }
}

pub(super) fn cells(text: &str) -> Result<[usize; 2], String> {
    let numbers: Result<Vec<usize>, _> = text.split(',').map(str::trim).map(str::parse).collect();
    match numbers.as_deref() {
        Ok(&[u @ 1..=30_000, v @ 1..=30_000]) => Ok([u, v]),
        _ => Err("give two numbers from 1 to 30000 separated by a comma".into()),
    }
}

pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let sides: Option<(u32, u32)> =
        text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.trim().parse().ok()?, h.trim().parse().ok()?)));
    sides.map(|(width, height)| [width, height]).ok_or_else(|| "give WIDTHxHEIGHT, such as 1200x900".into())
}

pub(super) fn view(text: &str) -> Result<ViewFrom, String> {
    Ok(match text {
        "iso" => ViewFrom::Iso,
        "x" => ViewFrom::X,
        "y" => ViewFrom::Y,
        "z" => ViewFrom::Z,
        _ => ViewFrom::Along(vector(text).map_err(|_| "give iso, x, y, z, or three numbers separated by commas")?),
    })
}

pub(super) fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n @ 1..=1024) => Ok(n),
        _ => Err("give a number from 1 to 1024".into()),
    }
}
