//! Consistent overhead byte stuffing (COBS). Encoded bytes contain no 00, so a 00 can mark the end of each packet. See
//! Cheshire & Baker, IEEE/ACM Transactions on Networking 7, 1999.

use alloc::vec::Vec;

/// Maximum number of bytes that follow a code byte.
const BLOCK: usize = 254;

/// The reason why bytes are not valid COBS.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CobsError {
    /// The byte at this index is 00, which is only allowed at the end of a packet.
    #[error("byte {0} of the packet is 00")]
    Zero(usize),
    /// The packet ends before the last block is complete. The value is the number of missing bytes.
    #[error("the packet ends {0} bytes too early")]
    Short(usize),
}

/// Encodes bytes. The result does not include the 00 at the end of a packet.
pub fn encode(bytes: &[u8]) -> Vec<u8> {
    let mut stuffed = Vec::with_capacity(bytes.len() + bytes.len() / BLOCK + 1);
    // A full block at the end is not followed by an empty one.
    let mut open = true;
    for (at, run) in bytes.split(|byte| *byte == 0).enumerate() {
        if at > 0 && !open {
            // The 00 before this run follows a full block, so an empty block represents it.
            stuffed.push(1);
        }
        open = true;
        let mut rest = run;
        while let Some((block, more)) = rest.split_at_checked(BLOCK) {
            stuffed.push(0xFF);
            stuffed.extend(block);
            (rest, open) = (more, !more.is_empty());
        }
        if open {
            // The length is below 255.
            stuffed.push(rest.len() as u8 + 1);
            stuffed.extend(rest);
        }
    }
    stuffed
}

/// Decodes bytes, which must not include the 00 at the end of a packet.
///
/// # Errors
/// Returns a [`CobsError`] if the bytes are not valid COBS.
pub fn decode(stuffed: &[u8]) -> Result<Vec<u8>, CobsError> {
    if let Some(at) = stuffed.iter().position(|byte| *byte == 0) {
        return Err(CobsError::Zero(at));
    }
    let mut bytes = Vec::with_capacity(stuffed.len());
    let mut rest = stuffed;
    while let Some((code, behind)) = rest.split_first() {
        let length = usize::from(*code) - 1;
        let short = CobsError::Short(length.saturating_sub(behind.len()));
        let (block, more) = behind.split_at_checked(length).ok_or(short)?;
        bytes.extend(block);
        if *code != 0xFF && !more.is_empty() {
            bytes.push(0);
        }
        rest = more;
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{vec, vec::Vec};

    use proptest::prelude::*;

    /// The expected bytes are published examples of COBS, without the terminating 00.
    #[test]
    fn published_examples_encode_and_decode() {
        let counting = |first: u8, count: u8| (0..count).map(|at| first.wrapping_add(at)).collect::<Vec<u8>>();
        let cases = [
            (vec![], vec![0x01]),
            (vec![0x00], vec![0x01, 0x01]),
            (vec![0x00, 0x00], vec![0x01, 0x01, 0x01]),
            (vec![0x00, 0x11, 0x00], vec![0x01, 0x02, 0x11, 0x01]),
            (vec![0x11, 0x22, 0x00, 0x33], vec![0x03, 0x11, 0x22, 0x02, 0x33]),
            (vec![0x11, 0x22, 0x33, 0x44], vec![0x05, 0x11, 0x22, 0x33, 0x44]),
            (vec![0x11, 0x00, 0x00, 0x00], vec![0x02, 0x11, 0x01, 0x01, 0x01]),
            (counting(1, 254), [vec![0xFF], counting(1, 254)].concat()),
            ([vec![0], counting(1, 254)].concat(), [vec![0x01, 0xFF], counting(1, 254)].concat()),
            (counting(1, 255), [vec![0xFF], counting(1, 254), vec![0x02, 0xFF]].concat()),
            ([counting(2, 254), vec![0]].concat(), [vec![0xFF], counting(2, 254), vec![0x01, 0x01]].concat()),
            ([counting(3, 253), vec![0, 1]].concat(), [vec![0xFE], counting(3, 253), vec![0x02, 0x01]].concat()),
        ];
        for (bytes, stuffed) in cases {
            assert_eq!(encode(&bytes), stuffed);
            assert_eq!(decode(&stuffed), Ok(bytes));
        }
        // An encoder may end a full block with an empty one.
        let longer = [vec![0xFF], counting(1, 254), vec![0x01]].concat();
        assert_eq!(decode(&longer), Ok(counting(1, 254)));
    }

    #[test]
    fn rejects_unstuffed_bytes() {
        assert_eq!(decode(&[0x03, 0x11, 0x00]), Err(CobsError::Zero(2)));
        assert_eq!(decode(&[0x03, 0x11]), Err(CobsError::Short(1)));
        assert_eq!(decode(&[0xFF]), Err(CobsError::Short(254)));
    }

    proptest! {
        #[test]
        fn stuffed_bytes_round_trip(bytes in proptest::collection::vec(prop_oneof![Just(0u8), any::<u8>()], 0..1200)) {
            let stuffed = encode(&bytes);
            prop_assert!(!stuffed.contains(&0) && stuffed.len() <= bytes.len() + bytes.len() / 254 + 1);
            prop_assert_eq!(decode(&stuffed), Ok(bytes));
        }

        #[test]
        fn full_blocks_round_trip(length in 250usize..260, zero in 0usize..520) {
            let mut bytes = vec![7; 2 * length];
            if let Some(byte) = bytes.get_mut(zero) {
                *byte = 0;
            }
            prop_assert_eq!(decode(&encode(&bytes)), Ok(bytes));
        }

        #[test]
        fn arbitrary_bytes_never_panic(bytes: Vec<u8>) {
            let _ = decode(&bytes);
        }
    }
}
