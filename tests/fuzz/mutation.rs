//! Random mutations of example inputs.

use fastrand::Rng;

/// Values at the limits of fields, and characters with a meaning in the text formats.
const SPECIAL_BYTES: &[&[u8]] = &[
    &[0],
    &[0xFF],
    &[0x7F],
    &[0x80],
    &[0, 0],
    &[0xFF, 0xFF],
    &[0xFF, 0xFF, 0xFF, 0xFF],
    &[0, 0, 0, 0x80],
    b"(",
    b")",
    b"[",
    b"]",
    b"\"",
    b",",
    b":",
    b";",
    b"\n",
    b"\r\n",
    b"-",
    b"1e999",
    b"99999999999999999999",
    b"-0.0",
    b"NaN",
    b"\\u{0}",
    b"//",
    b"/*",
    b"Some(",
    b"0x",
    b"%00",
    b"\xEF\xBB\xBF",
];

/// Returns the example with up to six changes. A change may insert part of `other`.
pub(crate) fn mutate(example: &[u8], other: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut bytes = example.to_vec();
    for _ in 0..rng.usize(1..=6) {
        let at = rng.usize(..=bytes.len());
        match rng.u8(..9) {
            0 if at < bytes.len() => bytes[at] ^= 1 << rng.u8(..8),
            1 if at < bytes.len() => bytes[at] = rng.u8(..),
            2 => bytes.insert(at, rng.u8(..)),
            3 => bytes.truncate(at),
            4 => {
                let end = (at + rng.usize(..16)).min(bytes.len());
                bytes.drain(at..end);
            }
            5 => {
                let part = part(&bytes.clone(), rng);
                bytes.splice(at..at, part);
            }
            6 => {
                let part = part(other, rng);
                let end = (at + rng.usize(..=part.len())).min(bytes.len());
                bytes.splice(at..end, part);
            }
            7 => {
                let special = rng.choice(SPECIAL_BYTES).unwrap();
                let end = (at + rng.usize(..=special.len())).min(bytes.len());
                bytes.splice(at..end, special.iter().copied());
            }
            _ => bytes.extend((0..rng.usize(..8)).map(|_| rng.u8(..))),
        }
    }
    bytes
}

fn part(bytes: &[u8], rng: &mut Rng) -> Vec<u8> {
    let start = rng.usize(..=bytes.len());
    let end = (start + rng.usize(..64)).min(bytes.len());
    bytes[start..end].to_vec()
}
