//! Location of the commutation offset in the memory. The assistant proposes a free location, and warns before other
//! data is replaced. This module does not change the memory.

use super::{Commutation, Storage};
use crate::app::Text;
use crate::app::number::parse_integer;
use crate::devices::hiperface::profile::{CommutationRecord, FieldImage};
use crate::devices::hiperface::protocol::Geometry;
use crate::devices::hiperface::state::{StagedEdits, TEXTS, rules};

/// Byte values of empty memory, after erasing or before the first write.
const FILLERS: [u8; 2] = [0x00, 0xFF];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OffsetLocation {
    pub field: u8,
    /// Index of the first byte.
    pub address: usize,
}

impl Commutation {
    /// Returns the location that the user has entered, or else a proposed location. The proposal is an existing record
    /// that can be replaced. If there is none, it is an empty block in the last writable field that has one.
    ///
    /// # Errors
    /// Returns an error if no field has enough space or the typed address is invalid.
    pub fn offset_location(&self, staged: &StagedEdits) -> Result<OffsetLocation, Text> {
        let no_room = || TEXTS.text("commutation.no_room").with("bytes", CommutationRecord::BYTES);
        let form = &self.form;
        let wanted = staged.edited_fields();
        let writable = || wanted.iter().rev().filter(|field| rules::check_edit(field).is_ok());
        let candidates = || writable().filter(|field| form.field.is_none_or(|own| own == field.number));
        if form.address.trim().is_empty() {
            let kept = candidates().find_map(|field| first(field, |bytes| is_replaceable_record(form.storage, bytes)));
            let free = || candidates().find_map(|field| first(field, is_filler));
            return kept.or_else(free).ok_or_else(no_room);
        }
        let address = parse_integer(TEXTS.text("commutation.address"), &form.address, 0, 127)? as usize;
        let field = form.field.or_else(|| writable().next().map(|field| field.number));
        let field = field.ok_or_else(no_room)?;
        Ok(OffsetLocation { field, address })
    }

    /// Returns a warning about the data that the offset would replace, or `None` if the location is empty or already
    /// contains an offset.
    pub fn replacement_warning(&self, geometry: Option<Geometry>, staged: &StagedEdits) -> Option<Text> {
        let (field, address, bytes) = self.bytes(geometry, staged).ok()?;
        let places = address..address + bytes.len();
        let wanted: Vec<u8> = places.clone().filter_map(|at| staged.byte(field, at)).collect();
        // If the offset has already been entered here as an edit, the warning is about the bytes in the encoder.
        let there = match wanted == bytes {
            true => places.filter_map(|at| staged.device_byte(field, at)).collect(),
            false => wanted,
        };
        if there.len() < bytes.len()
            || there == bytes
            || is_filler(&there)
            || is_replaceable_record(self.form.storage, &there)
        {
            return None;
        }
        let text = TEXTS.text("commutation.replaces").with("field", field).with("first", address);
        Some(text.with("last", address + bytes.len() - 1).with("text", ascii(&there)))
    }
}

/// Returns the first block of a field that satisfies `holds`. Blocks have the size of a commutation record even if the
/// offset is stored as a number, because zeros between other numbers may be data.
fn first(field: &FieldImage, holds: impl Fn(&[u8]) -> bool) -> Option<OffsetLocation> {
    let block = field.bytes.as_deref()?.chunks_exact(CommutationRecord::BYTES).position(holds)?;
    Some(OffsetLocation { field: field.number, address: block * CommutationRecord::BYTES })
}

fn is_filler(bytes: &[u8]) -> bool {
    FILLERS.iter().any(|filler| bytes.iter().all(|byte| byte == filler))
}

/// Returns whether the location contains a complete record, which a new record may replace.
fn is_replaceable_record(storage: Storage, bytes: &[u8]) -> bool {
    storage == Storage::Record && matches!(CommutationRecord::parse(bytes), Some(Ok(_)))
}

fn ascii(bytes: &[u8]) -> String {
    let shown = |byte: &u8| if byte.is_ascii_graphic() || *byte == b' ' { char::from(*byte) } else { '·' };
    bytes.iter().map(shown).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::hiperface::protocol::DataFieldStatus;

    /// Returns a memory with a writable field of 16 bytes (D8h), a writable field of 48 bytes (DAh) and a
    /// write-protected field (89h). The status bytes are defined for command 4Dh in the manual.
    fn memory(fields: &[(u8, &[u8])]) -> StagedEdits {
        let image = |(number, (status, bytes)): (u8, &(u8, &[u8]))| FieldImage {
            number,
            status: DataFieldStatus::from_byte(*status),
            bytes: Some(bytes.to_vec()),
        };
        let mut staged = StagedEdits::default();
        staged.refresh((0..).zip(fields).map(image).collect());
        staged
    }

    fn proposed_location(
        staged: &StagedEdits,
        storage: Storage,
        field: Option<u8>,
    ) -> Result<(u8, usize), &'static str> {
        let mut commutation = Commutation::default();
        (commutation.form.storage, commutation.form.field) = (storage, field);
        commutation.offset_location(staged).map(|place| (place.field, place.address)).map_err(|text| text.id())
    }

    const PLATE: &[u8; 16] = b"EMD71K-4 3000rpm";

    #[test]
    fn proposes_only_empty_location() {
        let service: Vec<u8> = [PLATE.as_slice(), b"SERVICE\x00\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF", &[0xFF; 16]].concat();
        let empty = &[0; 32];
        for (label, fields, record, number) in [
            ("full", vec![(0xD8, PLATE.as_slice())], Err("commutation.no_room"), Err("commutation.no_room")),
            ("the last", vec![(0xD9, empty.as_slice()), (0xDA, &service)], Ok((1, 32)), Ok((1, 32))),
            ("the last that has room", vec![(0xD9, empty), (0xD8, PLATE)], Ok((0, 0)), Ok((0, 0))),
            ("protected", vec![(0x89, empty)], Err("commutation.no_room"), Err("commutation.no_room")),
            ("none", vec![], Err("commutation.no_room"), Err("commutation.no_room")),
        ] {
            let staged = memory(&fields);
            assert_eq!(proposed_location(&staged, Storage::Record, None), record, "{label}");
            assert_eq!(proposed_location(&staged, Storage::Number, None), number, "{label}");
        }
        let both = memory(&[(0xD9, empty), (0xDA, &service)]);
        assert_eq!(proposed_location(&both, Storage::Record, Some(0)), Ok((0, 0)), "in the field that is chosen");
    }

    /// The existing record has the offset 5305 1EB8h and four pole pairs. Its CRC was calculated with Python's
    /// `binascii.crc_hqx`.
    #[test]
    fn proposes_replacing_existing_record() {
        let record = [0x43, 0x4F, 0x31, 0x00, 0x53, 0x05, 0x1E, 0xB8, 4, 0, 0, 0, 0, 0, 0x2A, 0x23];
        let fields = memory(&[(0xD8, &record), (0xD9, &[0; 32])]);
        assert_eq!(proposed_location(&fields, Storage::Record, None), Ok((0, 0)));
        assert_eq!(proposed_location(&fields, Storage::Number, None), Ok((1, 0)));
        let mut damaged = record;
        damaged[7] ^= 1;
        let fields = memory(&[(0xD8, &damaged), (0xD9, &[0; 32])]);
        assert_eq!(proposed_location(&fields, Storage::Record, None), Ok((1, 0)));
    }

    #[test]
    fn shows_bytes_as_text() {
        assert_eq!(ascii(b"EMD71K-4 \x0B\xB8\xFFrpm"), "EMD71K-4 ···rpm");
    }
}
