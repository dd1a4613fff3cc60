//! The filters of meshopt's compression, undone: attributes that were put another way so that they pack
//! better (`EXT_meshopt_compression` and `KHR_meshopt_compression`, appendix B).

use std::f32::consts::FRAC_1_SQRT_2;

/// What undoes a filter of elements of `stride` bytes in place, or that there is no such filter.
pub(super) fn of(filter: &str, stride: usize) -> Result<fn(&mut [u8]), String> {
    Ok(match (filter, stride) {
        ("NONE", _) => |_| (),
        ("EXPONENTIAL", _) => exponential,
        ("OCTAHEDRAL", 4) => |bytes| each_of_bytes(bytes, |element| octahedral(element, 127.0)),
        ("OCTAHEDRAL", 8) => |bytes| each_of_halves(bytes, |element| octahedral(element, 32767.0)),
        ("QUATERNION", 8) => |bytes| each_of_halves(bytes, quaternion),
        ("COLOR", 4) => |bytes| each_of_bytes(bytes, |element| color(element, 8)),
        ("COLOR", 8) => |bytes| each_of_halves(bytes, |element| color(element, 16)),
        ("OCTAHEDRAL" | "QUATERNION" | "COLOR", _) => {
            return Err(format!("elements of {stride} bytes cannot have the filter {filter}"));
        }
        _ => return Err(format!("the filter {filter:.20} is not known")),
    })
}

fn each_of_bytes(bytes: &mut [u8], undo: impl Fn([i32; 4]) -> [i32; 4]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        *element = undo(element.map(|byte| i32::from(byte as i8))).map(|value| value as u8);
    }
}

fn each_of_halves(bytes: &mut [u8], undo: impl Fn([i32; 4]) -> [i32; 4]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let (halves, _) = element.as_chunks_mut::<2>();
        let values = [0, 1, 2, 3].map(|i| i32::from(i16::from_le_bytes(halves[i])));
        for (half, value) in halves.iter_mut().zip(undo(values)) {
            *half = (value as u16).to_le_bytes();
        }
    }
}

fn exponential(words: &mut [u8]) {
    for bytes in words.as_chunks_mut::<4>().0 {
        *bytes = exponential_word(*bytes).to_le_bytes();
    }
}

/// A 32-bit word has an exponent in its highest byte and a mantissa below, both signed.
pub(in crate::io::gltf) fn exponential_word(bytes: [u8; 4]) -> f32 {
    let word = i32::from_le_bytes(bytes);
    (f64::from(word << 8 >> 8) * f64::from(word >> 24).exp2()) as f32
}

/// A unit vector as its place on an octahedron unfolded into a square; the third number is 1 in this
/// scale, the fourth stands for itself.
fn octahedral([x, y, one, w]: [i32; 4], largest: f32) -> [i32; 4] {
    // A damaged file may have 0 there; the division then gives no number, and that is cast to 0.
    let (x, y) = (x as f32 / one as f32, y as f32 / one as f32);
    let z = 1.0 - x.abs() - y.abs();
    // The lower half of the octahedron is folded outwards.
    let fold = (-z).max(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let scale = largest / (x * x + y * y + z * z).sqrt();
    let [x, y, z] = [x, y, z].map(|part| (part * scale).round() as i32);
    [x, y, z, w]
}

/// A unit quaternion without its largest part, whose number is in the lowest bits of the last.
fn quaternion([x, y, z, last]: [i32; 4]) -> [i32; 4] {
    let one = (last | 3) as f32;
    let parts = [x, y, z].map(|part| part as f32 * FRAC_1_SQRT_2 / one);
    let largest = (1.0 - parts.iter().map(|part| part * part).sum::<f32>()).max(0.0).sqrt();
    let [x, y, z, largest] = [parts[0], parts[1], parts[2], largest].map(|part| (part * 32767.0).round() as i32);
    let mut out = [largest, x, y, z];
    out.rotate_right((last & 3) as usize);
    out
}

/// Luma, two differences of colour, and an opacity whose highest bit says how many bits all have.
fn color([y, co, cg, a]: [i32; 4], bits: u32) -> [i32; 4] {
    let all = (1 << bits) - 1;
    let (y, a) = (y & all, a & all);
    // All ones, up to the highest bit of the opacity; it lacks its lowest bit.
    let ones = if a == 0 { 0 } else { all >> (a.leading_zeros() - (32 - bits)) };
    let a = (a << 1 & ones) | (a & 1);
    let scale = all as f32 / ones as f32;
    [y + co - cg, y + cg, y - co - cg, a].map(|part| (part as f32 * scale + 0.5) as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_may_be_negative() {
        let mut words = [(-2_i32 << 24 | 3).to_le_bytes(), (1_i32 << 24 | 0x00ff_ffff).to_le_bytes()].concat();
        exponential(&mut words);
        assert_eq!(words, [0.75_f32.to_le_bytes(), (-2.0_f32).to_le_bytes()].concat());
    }

    #[test]
    fn corners_and_folds_of_the_octahedron() {
        for (packed, unit) in [
            ([0, 0, 127, 5], [0, 0, 127, 5]),
            ([127, 0, 127, 0], [127, 0, 0, 0]),
            ([0, -127, 127, 0], [0, -127, 0, 0]),
            ([127, 127, 127, -1], [0, 0, -127, -1]),
            ([7, 0, 7, 0], [127, 0, 0, 0]),
        ] {
            assert_eq!(octahedral(packed, 127.0), unit, "{packed:?}");
        }
        assert_eq!(octahedral([0, 0, 0, 0], 127.0), [0; 4], "damaged, and no panic");
    }

    #[test]
    fn the_largest_part_of_a_quaternion_goes_where_it_was() {
        for place in 0..4 {
            let mut expected = [0; 4];
            expected[place] = 32767;
            assert_eq!(quaternion([0, 0, 0, 0x7ffc | place as i32]), expected);
        }
        // Two equal parts: 1 / sqrt 2 is the largest number of the others.
        assert_eq!(quaternion([0x7fff, 0, 0, 0x7fff]), [23170, 0, 0, 23170]);
    }

    #[test]
    fn grey_and_red_of_eight_bits() {
        // Opacity 255 of eight bits is stored as 127 with the highest bit set.
        assert_eq!(color([128, 0, 0, 255], 8), [128, 128, 128, 255]);
        assert_eq!(color([63, 127, -64, 255], 8), [254, 0, 0, 255]);
        assert_eq!(color([0, 0, 0, 0], 8)[3], 0, "damaged, and no panic");
    }

    #[test]
    fn sizes_are_checked() {
        assert!(of("OCTAHEDRAL", 12).is_err() && of("QUATERNION", 4).is_err() && of("NEW", 4).is_err());
    }
}
