//! The EEPROM of an encoder, with consecutive data fields and four access codes (manual, "Datenspeicherung und
//! Verwaltung"). Checks are made in this order, and each has its own status code: field (12h), range (11h), access code
//! (0Fh), write enable (0Eh), size (10h). This module does not handle frames, time or wear.
//!
//! The manual leaves some behaviour open (`U`). In this model, bytes that were never written are FFh. The bytes of a
//! deleted field remain in the memory, and reappear in a field created in its place. Changing a field requires its
//! current access code.

use std::ops::Range;

use crate::devices::hiperface::protocol::{
    AccessCode, AccessCodeNumber, DataFieldStatus, EXTENDED_LABEL_FIELD, FieldSize, FreeMemory, StatusCode,
};

#[derive(Clone, Debug, PartialEq)]
pub struct Memory {
    bytes: Vec<u8>,
    fields: Vec<DataFieldStatus>,
    codes: [AccessCode; 4],
    extended_label: Option<Vec<u8>>,
}

impl Memory {
    /// Status of the extended label: an existing, write-protected field of 64 bytes that requires no access code.
    const LABEL_STATUS: DataFieldStatus = DataFieldStatus::from_byte(0x83);

    /// Creates a memory with the given number of 16-byte blocks. It has no fields, and all access codes have factory
    /// values.
    pub fn new(blocks: u8) -> Self {
        Memory {
            bytes: vec![0xFF; usize::from(blocks) * FieldSize::BLOCK],
            fields: Vec::new(),
            codes: [AccessCode::FACTORY; 4],
            extended_label: None,
        }
    }

    /// Adds the read-only field FFh of 64 bytes.
    #[must_use]
    pub(super) fn with_extended_label(mut self, content: &[u8]) -> Self {
        let mut label = content.to_vec();
        label.resize(Self::LABEL_STATUS.size().bytes(), 0);
        self.extended_label = Some(label);
        self
    }

    #[must_use]
    pub(super) fn with_codes(mut self, codes: [AccessCode; 4]) -> Self {
        self.codes = codes;
        self
    }

    /// Returns the free memory (4Eh).
    pub fn free_memory(&self) -> FreeMemory {
        let blocks = (self.bytes.len() - self.used_bytes()) / FieldSize::BLOCK;
        // Both numbers fit into a byte, because a memory has at most 255 blocks and a field has at least one.
        let byte = |count: usize| u8::try_from(count).unwrap_or(u8::MAX);
        FreeMemory { blocks: byte(blocks), fields: byte(self.fields.len()) }
    }

    /// Returns the status of a field (4Ch).
    ///
    /// # Errors
    /// Returns 12h if the field does not exist.
    pub fn status(&self, field: u8) -> Result<DataFieldStatus, StatusCode> {
        if field == EXTENDED_LABEL_FIELD {
            return self.extended_label.as_ref().map(|_| Self::LABEL_STATUS).ok_or(StatusCode::NO_SUCH_FIELD);
        }
        self.fields.get(usize::from(field)).copied().ok_or(StatusCode::NO_SUCH_FIELD)
    }

    /// Returns all bytes of a field without checking its access code, or `None` if the field does not exist.
    pub fn field_bytes(&self, field: u8) -> Option<&[u8]> {
        if field == EXTENDED_LABEL_FIELD {
            return self.extended_label.as_deref();
        }
        self.bytes.get(self.field_range(field)?)
    }

    pub fn code(&self, number: AccessCodeNumber) -> AccessCode {
        // Access code numbers are 0 to 3, so the fallback is never used.
        self.codes.get(usize::from(number.get())).copied().unwrap_or(AccessCode::FACTORY)
    }

    /// Reads bytes of a field (4Ah).
    ///
    /// # Errors
    /// Returns 12h or 11h if the bytes do not exist, or 0Fh if the field requires another access code.
    pub fn read(&self, field: u8, address: u8, count: u8, code: AccessCode) -> Result<&[u8], StatusCode> {
        let status = self.status(field)?;
        let bytes = self.field_bytes(field).ok_or(StatusCode::NO_SUCH_FIELD)?;
        let start = usize::from(address);
        let wanted = bytes.get(start..start + usize::from(count)).ok_or(StatusCode::OUT_OF_FIELD)?;
        self.check_code_if_required(status, code)?;
        Ok(wanted)
    }

    /// Checks whether `count` bytes could be written with 4Bh.
    ///
    /// # Errors
    /// Returns 12h or 11h if the bytes do not exist, 0Fh if the field requires another access code, or 0Eh if it is
    /// write-protected, as FFh always is.
    pub fn check_store_request(
        &self,
        field: u8,
        address: u8,
        count: usize,
        code: AccessCode,
    ) -> Result<(), StatusCode> {
        let status = self.status(field)?;
        if usize::from(address) + count > status.size().bytes() {
            return Err(StatusCode::OUT_OF_FIELD);
        }
        self.check_code_if_required(status, code)?;
        if status.is_writable() { Ok(()) } else { Err(StatusCode::WRITE_PROTECTED) }
    }

    /// Writes bytes to a field (4Bh).
    ///
    /// # Errors
    /// Returns any error that [`check_store_request`](Self::check_store_request) returns. In this case, no data is
    /// written.
    pub fn store_bytes(&mut self, field: u8, address: u8, data: &[u8], code: AccessCode) -> Result<(), StatusCode> {
        self.check_store_request(field, address, data.len(), code)?;
        let start = self.field_range(field).ok_or(StatusCode::NO_SUCH_FIELD)?.start + usize::from(address);
        let target = self.bytes.get_mut(start..start + data.len()).ok_or(StatusCode::OUT_OF_FIELD)?;
        target.copy_from_slice(data);
        Ok(())
    }

    /// Creates the next field, or changes or deletes an existing one (4Dh).
    ///
    /// # Errors
    /// Returns 12h for a number beyond the next one, 0Fh for a wrong access code, 0Eh for FFh, or 10h if the memory is
    /// too small. 10h is also returned if a field other than the last would be deleted or change its size.
    pub fn define_field(&mut self, field: u8, status: DataFieldStatus, code: AccessCode) -> Result<(), StatusCode> {
        let next = usize::from(field) == self.fields.len() && field != EXTENDED_LABEL_FIELD;
        match (next, status.exists()) {
            (true, true) => self.create(status, code),
            (_, true) => self.change_field(field, status, code),
            (_, false) => self.delete(field, code),
        }
    }

    /// Changes an access code (4Fh).
    ///
    /// # Errors
    /// Returns 0Fh if `old` is not the current value.
    pub fn change_code(
        &mut self,
        number: AccessCodeNumber,
        old: AccessCode,
        new: AccessCode,
    ) -> Result<(), StatusCode> {
        self.check_code(number, old)?;
        if let Some(code) = self.codes.get_mut(usize::from(number.get())) {
            *code = new;
        }
        Ok(())
    }

    pub(super) fn check_code(&self, number: AccessCodeNumber, code: AccessCode) -> Result<(), StatusCode> {
        if self.code(number) == code { Ok(()) } else { Err(StatusCode::WRONG_CODE) }
    }

    fn create(&mut self, status: DataFieldStatus, code: AccessCode) -> Result<(), StatusCode> {
        self.check_code(status.code(), code)?;
        if self.used_bytes() + status.size().bytes() > self.bytes.len() {
            return Err(StatusCode::SIZE_FIXED);
        }
        self.fields.push(status);
        Ok(())
    }

    fn change_field(&mut self, field: u8, status: DataFieldStatus, code: AccessCode) -> Result<(), StatusCode> {
        let present = self.check_field_access(field, code)?;
        let used_then = self.used_bytes() - present.size().bytes() + status.size().bytes();
        if present.size() != status.size() && (!self.is_last(field) || used_then > self.bytes.len()) {
            return Err(StatusCode::SIZE_FIXED);
        }
        if let Some(entry) = self.fields.get_mut(usize::from(field)) {
            *entry = status;
        }
        Ok(())
    }

    fn delete(&mut self, field: u8, code: AccessCode) -> Result<(), StatusCode> {
        self.check_field_access(field, code)?;
        if !self.is_last(field) {
            return Err(StatusCode::SIZE_FIXED);
        }
        self.fields.pop();
        Ok(())
    }

    /// Returns the status of a field if `code` is its access code and the field is not reserved for the encoder. The
    /// access code is required even if CE is 0.
    fn check_field_access(&self, field: u8, code: AccessCode) -> Result<DataFieldStatus, StatusCode> {
        let present = self.status(field)?;
        self.check_code(present.code(), code)?;
        if field == EXTENDED_LABEL_FIELD { Err(StatusCode::WRITE_PROTECTED) } else { Ok(present) }
    }

    fn check_code_if_required(&self, status: DataFieldStatus, code: AccessCode) -> Result<(), StatusCode> {
        if status.code_required() { self.check_code(status.code(), code) } else { Ok(()) }
    }

    fn is_last(&self, field: u8) -> bool {
        usize::from(field) + 1 == self.fields.len()
    }

    fn used_bytes(&self) -> usize {
        self.fields.iter().map(|status| status.size().bytes()).sum()
    }

    fn field_range(&self, field: u8) -> Option<Range<usize>> {
        let number = usize::from(field);
        let size = self.fields.get(number)?.size().bytes();
        let start: usize = self.fields.iter().take(number).map(|status| status.size().bytes()).sum();
        Some(start..start + size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CODE: AccessCode = AccessCode::FACTORY;
    const WRONG: AccessCode = AccessCode::new(0x00);

    fn status(byte: u8) -> DataFieldStatus {
        DataFieldStatus::from_byte(byte)
    }

    /// Returns a memory of eight blocks with field 0 (32 bytes) and field 1 (16 bytes).
    fn two_fields() -> Memory {
        let mut memory = Memory::new(8);
        memory.define_field(0, status(0xC9), CODE).unwrap();
        memory.define_field(1, status(0xE8), CODE).unwrap();
        memory
    }

    #[test]
    fn fields_are_contiguous() {
        let mut memory = two_fields();
        assert_eq!(memory.free_memory(), FreeMemory { blocks: 5, fields: 2 });
        memory.store_bytes(0, 31, &[1], CODE).unwrap();
        memory.store_bytes(1, 0, &[2], CODE).unwrap();
        assert_eq!(memory.bytes[31..33], [1, 2]);
        assert_eq!(memory.field_bytes(1).unwrap()[..2], [2, 0xFF]);
        assert_eq!(memory.field_bytes(2), None);
    }

    #[test]
    fn rejects_invalid_reads_and_writes() {
        let mut memory = two_fields();
        assert_eq!(memory.read(2, 0, 1, CODE), Err(StatusCode::NO_SUCH_FIELD));
        assert_eq!(memory.read(1, 16, 1, WRONG), Err(StatusCode::OUT_OF_FIELD));
        assert_eq!(memory.read(1, 15, 1, WRONG), Err(StatusCode::WRONG_CODE));
        assert_eq!(memory.store_bytes(2, 0, &[0], CODE), Err(StatusCode::NO_SUCH_FIELD));
        assert_eq!(memory.store_bytes(0, 31, &[0, 0], CODE), Err(StatusCode::OUT_OF_FIELD));
        memory.define_field(1, status(0xA8), CODE).unwrap(); // WE = 0
        assert_eq!(memory.store_bytes(1, 0, &[0], WRONG), Err(StatusCode::WRONG_CODE));
        assert_eq!(memory.store_bytes(1, 0, &[0], CODE), Err(StatusCode::WRITE_PROTECTED));
        memory.define_field(1, status(0xE0), CODE).unwrap(); // CE = 0
        assert_eq!(memory.store_bytes(1, 0, &[7], WRONG), Ok(()));
        assert_eq!(memory.read(1, 0, 1, WRONG), Ok(&[7][..]));
    }

    #[test]
    fn rejects_invalid_definitions() {
        let mut memory = two_fields();
        // description, field, status, code, expected result
        let cases = [
            ("a number is left out", 3, 0xC8, CODE, StatusCode::NO_SUCH_FIELD),
            ("deleting the next", 2, 0x48, CODE, StatusCode::NO_SUCH_FIELD),
            ("wrong code to create", 2, 0xC8, WRONG, StatusCode::WRONG_CODE),
            ("six blocks, five are free", 2, 0xCD, CODE, StatusCode::SIZE_FIXED),
            ("wrong code to change, though CE = 0 is asked", 1, 0xE0, WRONG, StatusCode::WRONG_CODE),
            ("size of a field that is not the last", 0, 0xC8, CODE, StatusCode::SIZE_FIXED),
            ("seven blocks, six are there", 1, 0xEE, CODE, StatusCode::SIZE_FIXED),
            ("deleting a field that is not the last", 0, 0x49, CODE, StatusCode::SIZE_FIXED),
            ("there is no label", 0xFF, 0xC8, CODE, StatusCode::NO_SUCH_FIELD),
        ];
        let before = memory.clone();
        for (what, field, byte, code, answer) in cases {
            assert_eq!(memory.define_field(field, status(byte), code), Err(answer), "{what}");
        }
        assert!(memory == before, "what is refused changes nothing");
    }

    #[test]
    fn field_change_needs_current_code() {
        let mut memory = two_fields();
        let code2 = AccessCodeNumber::new(2).unwrap();
        memory.change_code(code2, CODE, AccessCode::new(0x66)).unwrap();
        assert_eq!(memory.change_code(code2, CODE, CODE), Err(StatusCode::WRONG_CODE));
        // Changing field 1 from access code 2 to 0 requires code 2.
        assert_eq!(memory.define_field(1, status(0xC8), CODE), Err(StatusCode::WRONG_CODE));
        assert_eq!(memory.define_field(1, status(0xC8), AccessCode::new(0x66)), Ok(()));
        assert_eq!(memory.read(1, 0, 1, CODE), Ok(&[0xFF][..]));
    }

    #[test]
    fn resizing_last_field_keeps_content() {
        let mut memory = two_fields();
        memory.store_bytes(1, 0, &[0x08, 0x15], CODE).unwrap();
        memory.define_field(1, status(0xED), CODE).unwrap();
        assert_eq!(memory.free_memory(), FreeMemory { blocks: 0, fields: 2 });
        memory.define_field(1, status(0x68), CODE).unwrap();
        assert_eq!(memory.free_memory(), FreeMemory { blocks: 6, fields: 1 });
        memory.define_field(1, status(0xC8), CODE).unwrap();
        assert_eq!(memory.field_bytes(1).unwrap()[..3], [0x08, 0x15, 0xFF]);
    }

    #[test]
    fn label_is_read_only() {
        let mut memory = Memory::new(8).with_extended_label(&[0x53]);
        assert_eq!(memory.status(0xFF).unwrap().byte(), 0x83);
        assert_eq!(memory.read(0xFF, 0, 64, WRONG).unwrap().len(), 64);
        assert_eq!(memory.read(0xFF, 1, 64, CODE), Err(StatusCode::OUT_OF_FIELD));
        assert_eq!(memory.store_bytes(0xFF, 0, &[0], CODE), Err(StatusCode::WRITE_PROTECTED));
        assert_eq!(memory.define_field(0xFF, status(0x03), CODE), Err(StatusCode::WRITE_PROTECTED));
        assert_eq!(memory.free_memory().fields, 0, "the label is not counted");
    }
}
