//! Bounds that do not fit what compressed data decode to.
//!
//! Some packers state `min` and `max` of the values before their filters rounded them. While the data
//! are compressed nobody sees it; written plainly the bounds must be those of the data.

use super::Accessors;
use crate::error::ParseError;
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::{Accessor, Index, validation::Checked};
use serde_json::{Value, json};

/// The true bounds of an accessor that states others.
pub(in crate::io::gltf) struct Corrected {
    pub(in crate::io::gltf) accessor: usize,
    pub(in crate::io::gltf) min: Value,
    pub(in crate::io::gltf) max: Value,
}

impl Accessors<'_> {
    /// Those of the accessors over decoded views whose bounds are not those of their elements.
    pub(in crate::io::gltf) fn corrected_bounds(&self) -> Result<Vec<Corrected>, ParseError> {
        let mut corrected = Vec::new();
        for (i, accessor) in self.accessors.iter().enumerate() {
            if accessor.min.is_none() && accessor.max.is_none() || !self.is_decoded(accessor)? {
                continue;
            }
            let Some([min, max]) = self.bounds(i, accessor) else { continue };
            let fits = |stated: &Option<Value>, found: &[f64]| {
                let stated = stated.as_ref().and_then(Value::as_array);
                stated.is_none_or(|stated| {
                    let stated = stated.iter().map(|c| c.as_f64().map(|c| f64::from(c as f32)));
                    stated.eq(found.iter().map(|&c| Some(f64::from(c as f32))))
                })
            };
            if !fits(&accessor.min, &min) || !fits(&accessor.max, &max) {
                corrected.push(Corrected { accessor: i, min: numbers(&min), max: numbers(&max) });
            }
        }
        Ok(corrected)
    }

    /// True where the elements, or what replaces some, were compressed.
    fn is_decoded(&self, accessor: &Accessor) -> Result<bool, ParseError> {
        let sparse = accessor.sparse.iter().map(|sparse| sparse.values.buffer_view);
        for view in accessor.buffer_view.into_iter().chain(sparse) {
            if self.buffers.unpacked(view.value())?.is_some() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Least and greatest of each component, integers as they stand; `None` for matrices, for nothing,
    /// and where a component is no number.
    fn bounds(&self, index: usize, accessor: &Accessor) -> Option<[Vec<f64>; 2]> {
        let (Checked::Valid(component), Checked::Valid(shape)) = (&accessor.component_type, &accessor.type_) else {
            return None;
        };
        if matches!(shape, Type::Mat2 | Type::Mat3 | Type::Mat4) {
            return None;
        }
        let component = component.0;
        // One that is broken and that no geometry needs stays as it is.
        let array = self.any(Index::new(index as u32), "").ok()?;
        let count = array.len() as u32;
        let raw = array.raw().ok()?;
        let [mut min, mut max] = [f64::INFINITY, f64::NEG_INFINITY].map(|start| vec![start; shape.multiplicity()]);
        for element in 0..count {
            for (c, bytes) in raw.get(element).chunks_exact(component.size()).enumerate() {
                let value = number(component, bytes);
                if !value.is_finite() {
                    return None;
                }
                (min[c], max[c]) = (min[c].min(value), max[c].max(value));
            }
        }
        (count > 0).then_some([min, max])
    }
}

/// A component as a number.
fn number(component: ComponentType, bytes: &[u8]) -> f64 {
    let mut word = [0; 4];
    word[..bytes.len()].copy_from_slice(bytes);
    match component {
        ComponentType::I8 => f64::from(word[0] as i8),
        ComponentType::U8 => f64::from(word[0]),
        ComponentType::I16 => f64::from(i16::from_le_bytes([word[0], word[1]])),
        ComponentType::U16 => f64::from(u16::from_le_bytes([word[0], word[1]])),
        ComponentType::U32 => f64::from(u32::from_le_bytes(word)),
        ComponentType::F32 => f64::from(f32::from_le_bytes(word)),
    }
}

/// Whole numbers without a point: the bounds of integers are integers.
fn numbers(values: &[f64]) -> Value {
    let number = |&value: &f64| match value {
        whole if whole.fract() == 0.0 && whole.abs() < 1e15 => json!(whole as i64),
        value => json!(value),
    };
    values.iter().map(number).collect()
}
