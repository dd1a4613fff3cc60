//! PNG images in memory.

/// An sRGB image of 8 bits a channel. `pixels` has three bytes for each, row by row from the top.
pub(crate) fn rgb(width: u32, height: u32, pixels: &[u8]) -> Vec<u8> {
    encode(width, height, pixels, png::ColorType::Rgb)
}

/// The same with an opacity: four bytes a pixel.
pub(crate) fn rgba(width: u32, height: u32, pixels: &[u8]) -> Vec<u8> {
    encode(width, height, pixels, png::ColorType::Rgba)
}

fn encode(width: u32, height: u32, pixels: &[u8], color: png::ColorType) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let encoded = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(pixels)?;
        writer.finish()
    });
    debug_assert!(encoded.is_ok(), "memory takes everything, and the dimensions fit");
    bytes
}
