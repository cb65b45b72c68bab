//! Detection of an unknown frame layout while the shaft turns.

use std::time::Duration;

use super::{Error, Master};
use crate::devices::biss::protocol::{Crc, Layout, LayoutError, detect_data_bits};

/// Number of bits read per frame, which is the maximum frame length including the checksum.
const FRAME_BITS: u8 = 64;
/// Maximum number of frames to examine.
const MAX_FRAMES: usize = 200;
const READING_INTERVAL: Duration = Duration::from_millis(2);
/// Maximum width of the singleturn position in bits.
const MAX_SINGLETURN_BITS: u8 = 32;

/// Finds the frame layout at which the checksum matches while the shaft turns. The position is assumed to be followed
/// by an error bit, a warning bit and an inverted CRC6 43h, as usual for BiSS encoders (`U`). The multiturn width
/// cannot be determined, so the lowest bits of the position, up to 32, are taken as the singleturn position.
///
/// # Errors
/// Returns [`Error::WidthsUnknown`] if no length fits or the shaft is at standstill, or another error if the exchange
/// fails.
pub(super) fn find_frame_layout(master: &mut Master<'_>) -> Result<Layout, Error> {
    let crc = Crc::new(Crc::POSITION, 0, true).map_err(LayoutError::from)?;
    let mut frames = Vec::with_capacity(MAX_FRAMES);
    while frames.len() < MAX_FRAMES {
        frames.push(master.read_frame(FRAME_BITS - crc.width(), crc.width())?);
        if let Some(bits) = detect_data_bits(&frames, FRAME_BITS, &crc) {
            let position = bits.saturating_sub(2);
            let singleturn = position.min(MAX_SINGLETURN_BITS);
            return Ok(Layout::new(position - singleturn, singleturn, true, true, Some(crc))?);
        }
        master.wait(READING_INTERVAL)?;
    }
    let moving = frames.windows(2).any(|pair| pair.first() != pair.last());
    Err(Error::WidthsUnknown { moving })
}
