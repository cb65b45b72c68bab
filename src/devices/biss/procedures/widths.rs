//! The search for the frame of an encoder with unknown widths, while its shaft turns.

use std::time::Duration;

use super::{Error, Master};
use crate::devices::biss::protocol::{Crc, Layout, LayoutError, data_bits_of};

/// Maximum number of bits of a frame, data and checksum.
const CLOCKED: u8 = 64;
/// Maximum number of frames examined, and the interval between them.
const FRAMES: usize = 200;
const BETWEEN: Duration = Duration::from_millis(2);
/// Bits within a revolution at most.
const MOST: u8 = 32;

/// Searches for the frame by its checksum, while the shaft turns: CRC6 43h inverted, with an error and a warning bit
/// after the position, as BiSS encoders have them (`U`). The number of turn bits cannot be observed: as many bits as
/// fit a word of 32 count as one turn.
///
/// # Errors
/// [`Error::WidthsUnknown`] if no length fits, or the shaft stands still; errors of the exchange.
pub(super) fn find_widths(master: &mut Master<'_>) -> Result<Layout, Error> {
    let crc = Crc::new(Crc::POSITION, 0, true).map_err(LayoutError::from)?;
    let mut frames = Vec::with_capacity(FRAMES);
    while frames.len() < FRAMES {
        frames.push(master.frame(CLOCKED - crc.width(), crc.width())?);
        if let Some(bits) = data_bits_of(&frames, CLOCKED, &crc) {
            let position = bits.saturating_sub(2);
            let singleturn = position.min(MOST);
            return Ok(Layout::new(position - singleturn, singleturn, true, true, Some(crc))?);
        }
        master.wait(BETWEEN)?;
    }
    let moving = frames.windows(2).any(|pair| pair.first() != pair.last());
    Err(Error::WidthsUnknown { moving })
}
