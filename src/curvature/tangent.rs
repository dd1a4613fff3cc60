//! Formula (2): turning of the section's tangent over the arc length.
//!
//! Source: M. Szilvasi-Nagy, Face-based Estimations of Curvatures on Triangle Meshes, section 2.

use super::Sample;
use crate::disk::Diameter;

/// The turning of both legs' last segments against the face, over their lengths. Right for turns
/// up to half a circle per leg.
pub(super) fn turning(diameter: &Diameter<'_>) -> Option<Sample> {
    let legs = [diameter.forward, diameter.backward];
    let length: f64 = legs.iter().map(|leg| leg.length).sum();
    // Bending away from the normal turns the tangent downwards.
    let turn: f64 = legs.iter().map(|leg| -leg.tangent.y.atan2(leg.tangent.x)).sum();
    (length > 0.0).then(|| Sample { curvature: turn / length, weight: length * length })
}
