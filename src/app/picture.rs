//! Export of a part of the window as a PNG image.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use crate::store::{FileError, FileErrorKind, FileOperation, write_atomically};

/// An RGB image, row by row from the top.
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    /// Red, green and blue components of each pixel.
    bytes: Arc<[u8]>,
}

impl fmt::Debug for Picture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Picture({} × {})", self.width, self.height)
    }
}

impl Picture {
    /// Creates an image from RGB pixels. Returns `None` if the size is zero or the number of bytes does not match it.
    pub fn new(width: u32, height: u32, bytes: Vec<u8>) -> Option<Self> {
        let wanted = u64::from(width) * u64::from(height) * 3;
        let fits = wanted > 0 && u64::try_from(bytes.len()) == Ok(wanted);
        fits.then(|| Picture { width, height, bytes: bytes.into() })
    }

    /// Saves the image as a PNG file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written. An existing file then stays unchanged.
    pub(super) fn save(&self, path: &Path) -> Result<(), FileError> {
        let refused = |error: std::io::Error| FileError {
            path: path.to_owned(),
            task: FileOperation::Write,
            problem: FileErrorKind::from(error),
        };
        write_atomically(path, &self.encode_png().map_err(refused)?)
    }

    fn encode_png(&self) -> Result<Vec<u8>, std::io::Error> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.write_header()?.write_image_data(&self.bytes)?;
        Ok(file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn image_size_matches_pixel_count() {
        assert!(Picture::new(2, 1, vec![0; 5]).is_none());
        assert!(Picture::new(0, 7, Vec::new()).is_none());
        let pixels = vec![255, 0, 0, 0, 0, 255];
        let picture = Picture::new(2, 1, pixels.clone()).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(picture.encode_png().unwrap())).read_info().unwrap();
        let mut read = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut read).unwrap();
        assert_eq!((info.width, info.height, read), (2, 1, pixels));
    }

    #[test]
    fn failed_encoding_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        let short = Picture { width: 2, height: 2, bytes: vec![0; 5].into() };
        assert!(short.save(&path).is_err() && !path.exists());
        Picture { height: 1, bytes: vec![0; 6].into(), ..short }.save(&path).unwrap();
        assert!(std::fs::read(&path).unwrap().starts_with(b"\x89PNG"));
    }
}
