//! `EXT_meshopt_compression` of what Osculate adds to a document.
//!
//! Numbers stay 32-bit floats for every reader and keep their unit: they are rounded to steps that pack
//! well, by the extension's exponential filter. Integers (`KHR_mesh_quantization`) would need a node with a
//! scale above them, and curvature would no longer be in the unit of the positions beside it.

use super::{ALIGNMENT, Draft, Piece};
use crate::annotation::Annotation;
use crate::io::gltf::layout::Stream;
use crate::io::gltf::meshopt::{self, encode};
use crate::progress::NoProgress;
use crate::quantity::Quantity;
use serde_json::{Value, json};
use std::io;

/// How a piece is coded.
pub(super) struct Coding {
    mode: &'static str,
    filter: Option<&'static str>,
    stride: usize,
    count: usize,
    /// Compressed bytes.
    length: usize,
}

/// What numbers are rounded to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rounding {
    /// Nothing: the bits stay.
    Bits,
    /// Multiples of two to this power.
    Step(i32),
    /// Sixteen significant bits.
    Significant,
}

/// Whole numbers below this fit the mantissa of the exponential filter.
const LARGEST_WHOLE: usize = 1 << 23;

/// Directions and shares are multiples of two to this power.
const SHARE_STEP: i32 = -15;

/// Positions are multiples of a power of two that is the mesh's size times two to this, at most.
const POSITION_STEP: i32 = -16;

impl Draft<'_> {
    /// Compresses every stream that the extension can hold; the original's bytes stay as they are.
    pub(in crate::io::gltf) fn compress(&mut self, annotation: &Annotation<'_>) -> io::Result<()> {
        let placed: Vec<(usize, usize)> = self.placed.iter().map(|(&view, &piece)| (view, piece)).collect();
        for (view, piece) in placed {
            let Piece::Stream(stream) = &self.pieces[piece] else { continue };
            let stride = stream.stride();
            let is_index = matches!(stream, Stream::Indices { .. });
            if !is_index && !stride.is_multiple_of(4) {
                continue;
            }
            let mut bytes = Vec::with_capacity(stream.byte_length() as usize);
            stream.write(annotation, &mut bytes, &NoProgress)?;
            let (mode, filter, is_position) = if is_index {
                ("INDICES", None, false)
            } else {
                let is_position = matches!(stream, Stream::Corners { .. } | Stream::Positions { .. });
                let rounding = rounding(annotation, stream, &bytes);
                round(&mut bytes, rounding);
                ("ATTRIBUTES", (rounding != Rounding::Bits).then_some("EXPONENTIAL"), is_position)
            };
            if is_position {
                self.set_bounds(view, &bytes);
            }
            let coded =
                if is_index { encode::indices(&bytes, stride) } else { Some(encode::attributes(&bytes, stride)) };
            let Some(coded) = coded else { continue };
            self.coded.insert(piece, Coding { mode, filter, stride, count: bytes.len() / stride, length: coded.len() });
            self.pieces[piece] = Piece::Bytes(coded);
        }
        Ok(())
    }

    /// States the bounds of positions as they are decoded.
    fn set_bounds(&mut self, view: usize, words: &[u8]) {
        let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for (i, word) in words.as_chunks::<4>().0.iter().enumerate() {
            let value = meshopt::exponential(*word);
            (min[i % 3], max[i % 3]) = (min[i % 3].min(value), max[i % 3].max(value));
        }
        for accessor in self.list("accessors").iter_mut().filter(|accessor| accessor["bufferView"] == view) {
            accessor["min"] = json!(min);
            accessor["max"] = json!(max);
        }
    }

    /// Adds the buffer that stands for what compressed views decode to, and the extension's name.
    pub(super) fn add_stand_in(&mut self, length: u64) {
        let name = meshopt::NAMES[0];
        self.list("buffers").push(json!({ "byteLength": length, "extensions": { name: { "fallback": true } } }));
        self.use_extension(name);
        self.list("extensionsRequired").push(name.into());
    }
}

impl Coding {
    /// Rewrites a view: its compressed bytes are in the first buffer at `offset`; what they decode to is to
    /// be found in the second, behind `stand_in` other bytes.
    pub(super) fn describe(&self, view: &mut Value, buffers: [usize; 2], offset: u64, stand_in: &mut u64) {
        let length = self.stride * self.count;
        let mut description = json!({
            "buffer": buffers[0], "byteOffset": offset, "byteLength": self.length, "byteStride": self.stride,
            "count": self.count, "mode": self.mode,
        });
        if let Some(filter) = self.filter {
            description["filter"] = filter.into();
        }
        super::pack::put(view, buffers[1], *stand_in);
        view["byteLength"] = length.into();
        view["extensions"] = json!({ meshopt::NAMES[0]: description });
        *stand_in = (*stand_in + length as u64).next_multiple_of(ALIGNMENT);
    }
}

/// What the numbers of a stream are rounded to.
fn rounding(annotation: &Annotation<'_>, stream: &Stream<'_>, bytes: &[u8]) -> Rounding {
    let whole = |count: usize| if count < LARGEST_WHOLE { Rounding::Step(0) } else { Rounding::Bits };
    let of = |quantity: Quantity| match quantity {
        Quantity::Face => whole(annotation.values.len()),
        Quantity::Class => Rounding::Step(0),
        Quantity::DirMax | Quantity::DirMin => Rounding::Step(SHARE_STEP),
        Quantity::ShapeIndex | Quantity::Coverage | Quantity::Confidence => Rounding::Step(SHARE_STEP),
        _ => Rounding::Significant,
    };
    match stream {
        Stream::Corners { .. } | Stream::Positions { .. } => position_step(bytes),
        Stream::Value { quantity, .. } | Stream::VertexValue { quantity, .. } => of(*quantity),
        Stream::Column { quantity, .. } if *quantity == Quantity::Face => Rounding::Bits,
        Stream::Column { quantity, .. } => of(*quantity),
        Stream::Row { faces, .. } => whole(faces.len()),
        // The middle of one of 256 texels, or of all: odd multiples of 1/512. Exact.
        Stream::PaletteCoordinate { .. } => Rounding::Step(-9),
        Stream::Copied { .. } | Stream::Indices { .. } | Stream::VertexColor { .. } => Rounding::Bits,
    }
}

/// The step of positions by their extent. Where they lie far from zero it is as large as it has to be.
fn position_step(bytes: &[u8]) -> Rounding {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for (i, word) in bytes.as_chunks::<4>().0.iter().enumerate() {
        let value = f32::from_le_bytes(*word);
        (low[i % 3], high[i % 3]) = (low[i % 3].min(value), high[i % 3].max(value));
    }
    let size = (0..3).map(|c| f64::from(high[c]) - f64::from(low[c])).fold(0.0, f64::max);
    let farthest = (0..3).map(|c| high[c].abs().max(low[c].abs())).fold(0.0, f32::max);
    if farthest == 0.0 || !farthest.is_finite() {
        return Rounding::Step(0);
    }
    let least = f64::from(farthest).log2().floor() as i32 - 21;
    let step = if size > 0.0 { size.log2().floor() as i32 + POSITION_STEP } else { least };
    Rounding::Step(step.max(least))
}

/// Rounds 32-bit floats and puts each as a mantissa of 24 bits under an exponent of 8, both signed.
fn round(bytes: &mut [u8], rounding: Rounding) {
    let significant = |value: f32| if value == 0.0 { 0 } else { f64::from(value.abs()).log2().floor() as i32 - 15 };
    let exponent: &dyn Fn(f32) -> i32 = match rounding {
        Rounding::Bits => return,
        Rounding::Step(step) => &move |_| step,
        Rounding::Significant => &significant,
    };
    for word in bytes.as_chunks_mut::<4>().0 {
        let value = f32::from_le_bytes(*word);
        // Powers of two that are normal floats themselves, whose products decoders do not lose.
        let exponent = exponent(value).clamp(-126, 112);
        let mantissa = (f64::from(value) / f64::from(exponent).exp2()).round() as i32;
        let limit = LARGEST_WHOLE as i32 - 1;
        *word = (exponent << 24 | (mantissa.clamp(-limit, limit) & 0x00ff_ffff)).to_le_bytes();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rounded(values: &[f32], rounding: Rounding) -> Vec<f32> {
        let mut bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        round(&mut bytes, rounding);
        bytes.as_chunks().0.iter().map(|word| meshopt::exponential(*word)).collect()
    }

    #[test]
    fn numbers_are_rounded_to_the_step_or_to_sixteen_bits() {
        assert_eq!(rounded(&[-1.0, 0.0, 8_388_607.0], Rounding::Step(0)), [-1.0, 0.0, 8_388_607.0]);
        assert_eq!(rounded(&[0.500_01, -0.3], Rounding::Step(-2)), [0.5, -0.25]);
        let values = [1e-20, -3.3, 0.1, 3.4e38, -1.0, 0.0, 65535.0];
        for (given, got) in values.into_iter().zip(rounded(&values, Rounding::Significant)) {
            assert!((given - got).abs() <= given.abs() / 65536.0, "{given} {got}");
        }
    }

    #[test]
    fn positions_are_rounded_to_a_share_of_the_extent() {
        let bytes = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
        assert_eq!(position_step(&bytes(&[0.0, 0.0, 0.0, 1.0, 0.5, -2.0])), Rounding::Step(1 - 16));
        assert_eq!(position_step(&bytes(&[5.0, 0.0, 0.0, 5.0, 0.0, 0.0])), Rounding::Step(2 - 21));
        assert_eq!(position_step(&bytes(&[1024.0, 0.0, 0.0, 1024.5, 0.0, 0.0])), Rounding::Step(10 - 21));
        assert_eq!(rounded(&[0.0; 3], position_step(&bytes(&[0.0; 3]))), [0.0; 3]);
    }
}
