//! The encoder's data fields together with the edited bytes. A write is planned from the differences. This module does
//! not write anything to the encoder.
//!
//! Edits are kept when the encoder is read again. Edited bytes keep their edited values, and all other bytes are
//! updated. If a field cannot be read because its access code is unknown, its edits are kept until the field is
//! readable.

use crate::app::{EditBase, Edits};
use crate::devices::hiperface::profile::{FieldImage, FieldRange};

/// Data fields with edited bytes. Each byte is identified by its field number and index.
pub type StagedEdits = Edits<Vec<FieldImage>>;

impl EditBase for Vec<FieldImage> {
    type Location = (u8, usize);
    type Value = u8;

    /// Returns whether a byte differs from the byte in the encoder. In a field that could not be read, every byte
    /// counts as different.
    fn is_edit(&self, (field, address): (u8, usize), byte: u8) -> bool {
        let image = self.iter().find(|image| image.number == field);
        match image.map(|image| (&image.bytes, image.status)) {
            Some((Some(bytes), _)) => bytes.get(address).is_some_and(|own| *own != byte),
            Some((None, status)) => address < status.size().bytes(),
            None => false,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ByteEditError {
    #[error("data field {field} does not exist")]
    NoField { field: u8 },
    /// The field could not be read, because its access code is unknown.
    #[error("data field {field} is locked")]
    Locked { field: u8 },
    /// The bytes extend beyond the end of the field.
    #[error("data field {field} ends at {last}")]
    Outside {
        field: u8,
        /// Index of the last byte of the field.
        last: usize,
    },
}

impl StagedEdits {
    /// Takes over the bytes read from the encoder. An edit is dropped if its byte no longer exists or already has the
    /// edited value.
    pub fn refresh(&mut self, device: Vec<FieldImage>) {
        self.update_base(|own| *own = device);
    }

    pub fn device(&self) -> &[FieldImage] {
        self.base()
    }

    pub fn edited_fields(&self) -> Vec<FieldImage> {
        let mut fields = self.base().clone();
        for ((number, address), byte) in self.iter() {
            let field = fields.iter_mut().find(|field| field.number == number);
            if let Some(own) = field.and_then(|field| field.bytes.as_mut()).and_then(|bytes| bytes.get_mut(address)) {
                *own = byte;
            }
        }
        fields
    }

    pub fn device_byte(&self, field: u8, address: usize) -> Option<u8> {
        self.field(field)?.bytes.as_ref()?.get(address).copied()
    }

    pub fn byte(&self, field: u8, address: usize) -> Option<u8> {
        self.get((field, address)).or_else(|| self.device_byte(field, address))
    }

    /// Returns whether the byte has an edit that has not been written.
    pub fn is_edited(&self, field: u8, address: usize) -> bool {
        self.get((field, address)).is_some()
    }

    /// Returns the ranges of consecutive edited bytes.
    pub fn edited_byte_ranges(&self) -> Vec<FieldRange> {
        let mut runs: Vec<FieldRange> = Vec::new();
        for ((field, address), _) in self.iter() {
            match runs.last_mut() {
                Some(FieldRange { field: own, start, count: Some(count) })
                    if *own == field && *start + *count == address =>
                {
                    *count += 1;
                }
                _ => runs.push(FieldRange::new(field, address, 1)),
            }
        }
        runs
    }

    /// Returns the ranges of consecutive edited bytes, with their new values.
    pub fn edited_ranges(&self) -> Vec<(FieldRange, Vec<u8>)> {
        let bytes = |range: &FieldRange| {
            let addresses = (range.start..).take(range.count.unwrap_or(0));
            addresses.filter_map(|address| self.byte(range.field, address)).collect()
        };
        self.edited_byte_ranges().into_iter().map(|range| (range, bytes(&range))).collect()
    }

    /// Edits consecutive bytes of a field as one undoable step.
    ///
    /// # Errors
    /// Returns an error without changing anything if the field does not exist, is locked or is too short.
    pub fn edit_bytes(&mut self, field: u8, address: usize, bytes: &[u8]) -> Result<(), ByteEditError> {
        let image = self.field(field).ok_or(ByteEditError::NoField { field })?;
        let size = image.bytes.as_ref().ok_or(ByteEditError::Locked { field })?.len();
        if address.checked_add(bytes.len()).is_none_or(|end| end > size) {
            return Err(ByteEditError::Outside { field, last: size.saturating_sub(1) });
        }
        self.edit_values((address..).zip(bytes).map(|(at, byte)| ((field, at), *byte)));
        Ok(())
    }

    pub fn revert_range(&mut self, range: FieldRange) {
        self.revert_matching(|(field, address)| range.contains(field, address));
    }

    pub fn edited_bytes(&self) -> impl Iterator<Item = (u8, usize, u8)> {
        self.iter().map(|((field, address), byte)| (field, address, byte))
    }

    /// Takes over the edits of a draft. Edits of missing bytes and edits that change nothing are dropped.
    pub fn take_draft(&mut self, draft: impl IntoIterator<Item = (u8, usize, u8)>) {
        self.edit_values(draft.into_iter().map(|(field, address, byte)| ((field, address), byte)));
    }

    fn field(&self, number: u8) -> Option<&FieldImage> {
        self.base().iter().find(|field| field.number == number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::PendingEdits as _;
    use crate::devices::hiperface::protocol::DataFieldStatus;

    fn fields(first: &[u8; 16]) -> Vec<FieldImage> {
        let status = DataFieldStatus::from_byte;
        vec![
            FieldImage { number: 0, status: status(0xC8), bytes: Some(first.to_vec()) },
            FieldImage { number: 1, status: status(0xE8), bytes: None },
        ]
    }

    fn staged() -> StagedEdits {
        let mut staged = StagedEdits::default();
        staged.refresh(fields(&[0; 16]));
        staged
    }

    #[test]
    fn edits_do_not_touch_device() {
        let mut staged = staged();
        staged.edit_bytes(0, 3, &[0x08, 0x00, 0x15]).unwrap();
        assert_eq!((staged.device_byte(0, 3), staged.byte(0, 3)), (Some(0), Some(0x08)));
        assert!(staged.is_edited(0, 3) && !staged.is_edited(0, 4) && staged.is_edited(0, 5));
        assert_eq!(staged.edited_byte_ranges(), [FieldRange::new(0, 3, 1), FieldRange::new(0, 5, 1)]);
        assert_eq!(staged.edited_fields()[0].bytes.as_ref().unwrap()[5], 0x15);
        staged.edit_bytes(0, 3, &[0, 0, 0]).unwrap();
        assert!(!staged.is_dirty(), "as the device has it is no edit");
    }

    #[test]
    fn rejected_edits_change_nothing() {
        let mut staged = staged();
        assert_eq!(staged.edit_bytes(0, 15, &[1, 2]), Err(ByteEditError::Outside { field: 0, last: 15 }));
        assert_eq!(staged.edit_bytes(0, usize::MAX, &[1]), Err(ByteEditError::Outside { field: 0, last: 15 }));
        assert_eq!(staged.edit_bytes(1, 0, &[1]), Err(ByteEditError::Locked { field: 1 }));
        assert_eq!(staged.edit_bytes(7, 0, &[1]), Err(ByteEditError::NoField { field: 7 }));
        assert!(!staged.is_dirty() && !staged.undo());
    }

    #[test]
    fn undoes_and_redoes_edits() {
        let mut staged = staged();
        staged.edit_bytes(0, 0, &[1, 2]).unwrap();
        staged.edit_bytes(0, 1, &[3]).unwrap();
        assert!(staged.undo());
        assert_eq!((staged.byte(0, 0), staged.byte(0, 1)), (Some(1), Some(2)));
        assert!(staged.undo() && !staged.is_dirty() && !staged.undo());
        assert!(staged.redo() && staged.redo() && !staged.redo());
        assert_eq!(staged.byte(0, 1), Some(3));
        staged.discard_all();
        assert!(!staged.is_dirty());
        assert!(staged.undo() && staged.byte(0, 1) == Some(3));
        staged.revert_range(FieldRange::new(0, 1, 1));
        assert!(staged.is_edited(0, 0) && !staged.is_edited(0, 1));
    }

    #[test]
    fn edits_survive_rereading() {
        let mut staged = staged();
        staged.edit_bytes(0, 0, &[1, 2]).unwrap();
        let mut now = [0; 16];
        now[1] = 2; // written in the meantime by this or another program
        now[9] = 9;
        staged.refresh(fields(&now));
        assert!(staged.is_edited(0, 0) && !staged.is_edited(0, 1));
        assert_eq!(staged.byte(0, 9), Some(9), "what was not edited follows the device");
        assert!(staged.undo());
        assert!(!staged.is_edited(0, 0));
        assert_eq!(staged.byte(0, 1), Some(2));
    }

    #[test]
    fn edits_wait_for_unreadable_field() {
        let mut staged = staged();
        staged.edit_bytes(0, 0, &[1, 2]).unwrap();
        let mut locked = fields(&[0; 16]);
        locked[0].bytes = None;
        staged.refresh(locked);
        assert!(staged.is_dirty());
        assert_eq!(
            staged.edited_ranges(),
            [(FieldRange::new(0, 0, 2), vec![1, 2])],
            "a plan says which code is missing"
        );
        staged.refresh(fields(&[1; 16]));
        assert_eq!(staged.edited_bytes().collect::<Vec<_>>(), [(0, 1, 2)]);
    }

    #[test]
    fn restores_draft() {
        let mut staged = staged();
        staged.edit_bytes(0, 0, &[1, 2]).unwrap();
        let draft: Vec<(u8, usize, u8)> = staged.edited_bytes().collect();
        let mut other = self::staged();
        other.take_draft(draft.into_iter().chain([(5, 0, 1), (0, 99, 1), (0, 3, 0)]));
        assert_eq!(other.edited_fields(), staged.edited_fields());
        assert_eq!(other.edited_bytes().count(), 2);
    }
}
