//! The registers read from an encoder, and the user's edits. A write is planned from the differences, but nothing is
//! written here.
//!
//! Only bytes of a data area that the description marks as writable can be edited. Other writes, such as a filter, a
//! preset or a command, are reviewed separately and are not treated as edits.

use std::collections::{BTreeMap, BTreeSet};

use crate::app::{EditBase, Edits};
use crate::devices::biss::protocol::{Area, Description, Register, RegisterAddress};

#[derive(Clone, Debug, Default)]
pub struct Registers {
    read: BTreeMap<RegisterAddress, u8>,
    /// Registers whose values have changed since the previous reading.
    changed: BTreeSet<RegisterAddress>,
}

impl EditBase for Registers {
    type Location = RegisterAddress;
    type Value = u8;

    fn is_edit(&self, at: RegisterAddress, byte: u8) -> bool {
        self.read.get(&at) != Some(&byte)
    }
}

pub type Memory = Edits<Registers>;

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MemoryError {
    /// The register has not been read, so the value to be replaced is unknown.
    #[error("{0} has not been read")]
    NotRead(RegisterAddress),
    /// The register does not belong to an editable data area.
    #[error("{0} is not user data")]
    NoData(RegisterAddress),
}

/// Runs of consecutive edited bytes, each with its start address, the values in the encoder and the edited values.
pub type EditedRuns = Vec<(RegisterAddress, Vec<u8>, Vec<u8>)>;

impl Memory {
    /// Stores bytes that were read, starting at `start`. An edit is dropped if the encoder already has its value.
    pub fn store_bytes(&mut self, start: RegisterAddress, bytes: &[u8]) {
        self.update_base(|own| {
            for (at, byte) in (start.global_number()..).zip(bytes) {
                let Some(at) = RegisterAddress::from_global(at) else { break };
                match own.read.insert(at, *byte) {
                    Some(before) if before != *byte => own.changed.insert(at),
                    _ => own.changed.remove(&at),
                };
            }
        });
    }

    /// Returns the value of a register as read, or `None` if the register was not read.
    pub fn read(&self, at: RegisterAddress) -> Option<u8> {
        self.base().read.get(&at).copied()
    }

    /// Returns the edited value of a register, or the value that was read if the register has not been edited.
    pub fn edited_value(&self, at: RegisterAddress) -> Option<u8> {
        self.get(at).or_else(|| self.read(at))
    }

    /// Returns `count` bytes as read, or `None` if some of them were not read.
    pub fn bytes(&self, start: RegisterAddress, count: usize) -> Option<Vec<u8>> {
        let place = |at| RegisterAddress::from_global(at).and_then(|at| self.read(at));
        (start.global_number()..).take(count).map(place).collect()
    }

    /// Returns the bytes of a described register as read, or `None` if some of them were not read.
    pub fn register(&self, register: &Register) -> Option<Vec<u8>> {
        self.bytes(register.address, register.width.into())
    }

    /// Returns the bytes of an area, both as read and as edited. Returns `None` if some of them were not read.
    pub fn area_bytes(&self, area: &Area) -> Option<(Vec<u8>, Vec<u8>)> {
        let places: Vec<RegisterAddress> = area_addresses(area).collect();
        let read = places.iter().map(|at| self.read(*at)).collect::<Option<Vec<u8>>>()?;
        let wanted = places.iter().map(|at| self.edited_value(*at)).collect::<Option<Vec<u8>>>()?;
        Some((read, wanted))
    }

    /// Returns the longest run of banks in an area that were read completely, or `None` if there is none. A profile may
    /// contain only some of them.
    pub fn longest_readable_run(&self, area: &Area) -> Option<Area> {
        let is_read = |bank: u8| {
            let mut places = (0..RegisterAddress::BANK_SIZE).map(|offset| RegisterAddress::in_bank(bank, offset));
            places.all(|at| at.is_some_and(|at| self.read(at).is_some()))
        };
        let mut best: Option<(u8, u8)> = None;
        let mut first = None;
        for bank in area.banks() {
            first = is_read(bank).then(|| first.unwrap_or(bank));
            if let Some(first) = first
                && best.is_none_or(|(from, to)| bank - first > to - from)
            {
                best = Some((first, bank));
            }
        }
        best.map(|(first, last)| Area { first, last, ..area.clone() })
    }

    pub fn has_changed(&self, at: RegisterAddress) -> bool {
        self.base().changed.contains(&at)
    }

    pub fn is_edited(&self, at: RegisterAddress) -> bool {
        self.get(at).is_some()
    }

    /// Edits consecutive bytes, starting at `start`, as one undoable step.
    ///
    /// # Errors
    /// Returns a [`MemoryError`] without changing anything if the edit is rejected.
    pub fn edit_bytes(
        &mut self,
        description: &Description,
        start: RegisterAddress,
        bytes: &[u8],
    ) -> Result<(), MemoryError> {
        let mut wanted = Vec::with_capacity(bytes.len());
        for (at, byte) in (start.global_number()..).zip(bytes) {
            let at = RegisterAddress::from_global(at).ok_or(MemoryError::NoData(start))?;
            if !description.area_at(at).is_some_and(|area| area.access.is_writable()) {
                return Err(MemoryError::NoData(at));
            }
            self.read(at).ok_or(MemoryError::NotRead(at))?;
            wanted.push((at, *byte));
        }
        self.edit_values(wanted);
        Ok(())
    }

    /// Discards the edits of `count` consecutive bytes, starting at `start`.
    pub fn revert_range(&mut self, start: RegisterAddress, count: usize) {
        let range =
            start.global_number()..start.global_number().saturating_add(u16::try_from(count).unwrap_or(u16::MAX));
        self.revert_matching(|at| range.contains(&at.global_number()));
    }

    /// Returns the runs of edited bytes. Runs do not cross bank boundaries.
    pub fn edited_runs(&self) -> EditedRuns {
        let mut runs: EditedRuns = Vec::new();
        for (at, byte) in self.iter() {
            let old = self.read(at).unwrap_or(byte);
            let next =
                |start: RegisterAddress, count: usize| u8::try_from(count).ok().and_then(|own| start.offset_by(own));
            match runs.last_mut() {
                Some((start, before, wanted)) if next(*start, wanted.len()) == Some(at) => {
                    before.push(old);
                    wanted.push(byte);
                }
                _ => runs.push((at, vec![old], vec![byte])),
            }
        }
        runs
    }

    /// Returns the edits to store in a draft, as global addresses and bytes.
    pub fn draft_edits(&self) -> Vec<(u16, u8)> {
        self.iter().map(|(at, byte)| (at.global_number(), byte)).collect()
    }

    /// Adopts the edits in a draft. An edit is dropped when its register is read and already has that value.
    pub fn take_draft(&mut self, draft: Vec<(u16, u8)>) {
        let places = draft.into_iter().filter_map(|(at, byte)| Some((RegisterAddress::from_global(at)?, byte)));
        self.edit_values(places);
    }
}

/// Returns the register addresses of an area in ascending order.
pub fn area_addresses(area: &Area) -> impl Iterator<Item = RegisterAddress> + use<> {
    area.banks().flat_map(|bank| {
        (0..RegisterAddress::BANK_SIZE).filter_map(move |offset| RegisterAddress::in_bank(bank, offset))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::PendingEdits as _;
    use crate::devices::biss::protocol::Descriptions;

    fn kit() -> Description {
        Descriptions::built_in().find_by_name("POSITAL IXARC kit encoder").unwrap().clone()
    }

    fn at(text: &str) -> RegisterAddress {
        text.parse().unwrap()
    }

    #[test]
    fn edit_differs_from_read_value() {
        let mut memory = Memory::default();
        assert_eq!(memory.edit_bytes(&kit(), at("0x24:0x10"), &[1]), Err(MemoryError::NotRead(at("0x24:0x10"))));
        memory.store_bytes(at("0x24:0x00"), &[0xFF; 64]);
        memory.edit_bytes(&kit(), at("0x24:0x10"), &[1, 0xFF, 3]).unwrap();
        assert_eq!((memory.edited_value(at("0x24:0x10")), memory.read(at("0x24:0x10"))), (Some(1), Some(0xFF)));
        assert_eq!(memory.draft_edits(), [(0x950, 1), (0x952, 3)]);
        assert!(!memory.is_edited(at("0x24:0x11")));
        memory.undo();
        assert!(!memory.is_dirty() && memory.can_redo());
        memory.redo();
        memory.store_bytes(at("0x24:0x10"), &[1]);
        assert_eq!(memory.draft_edits(), [(0x952, 3)], "the encoder has it by now");
        memory.revert_range(at("0x24:0x12"), 1);
        assert!(!memory.is_dirty());
    }

    #[test]
    fn edits_only_plain_data() {
        let mut memory = Memory::default();
        memory.store_bytes(at("0x40"), &[0; 64]);
        memory.store_bytes(at("0x02:0x00"), &[0; 64]);
        for text in ["0x6A", "0x02:0x05"] {
            assert_eq!(memory.edit_bytes(&kit(), at(text), &[1]), Err(MemoryError::NoData(at(text))));
        }
        memory.store_bytes(at("0x43:0x3F"), &[0]);
        assert_eq!(memory.edit_bytes(&kit(), at("0x43:0x3F"), &[1, 2]), Err(MemoryError::NoData(at("0x44:0x00"))));
        assert!(!memory.is_dirty(), "all or nothing");
    }

    #[test]
    fn shows_longest_readable_bank_run() {
        let mut memory = Memory::default();
        let kit = kit();
        let area = kit.area_at(at("0x24:0x00")).unwrap();
        let part = |memory: &Memory| memory.longest_readable_run(area).map(|own| (own.first, own.last));
        memory.store_bytes(at("0x24:0x01"), &[0; 63]);
        assert_eq!(part(&memory), None, "not the whole bank");
        memory.store_bytes(at("0x25:0x00"), &[0; 64]);
        memory.store_bytes(at("0x30:0x00"), &[0; 128]);
        assert_eq!(part(&memory), Some((0x30, 0x31)));
        memory.store_bytes(at("0x24:0x00"), &[0; 0x20 * 64]);
        assert_eq!(part(&memory), Some((area.first, area.last)));
    }

    #[test]
    fn ranges_end_with_their_bank() {
        let mut memory = Memory::default();
        memory.store_bytes(at("0x04:0x00"), &[0; 128]);
        memory.edit_bytes(&kit(), at("0x04:0x3E"), &[1, 2, 3, 4]).unwrap();
        let runs = memory.edited_runs();
        assert_eq!(runs[0], (at("0x04:0x3E"), vec![0, 0], vec![1, 2]));
        assert_eq!(runs[1], (at("0x05:0x00"), vec![0, 0], vec![3, 4]));
    }

    #[test]
    fn marks_changes_since_previous_reading() {
        let mut memory = Memory::default();
        memory.store_bytes(at("0x66"), &[0x4B]);
        assert!(!memory.has_changed(at("0x66")), "nothing to compare with");
        memory.store_bytes(at("0x66"), &[0x4C]);
        assert!(memory.has_changed(at("0x66")));
        memory.store_bytes(at("0x66"), &[0x4C]);
        assert!(!memory.has_changed(at("0x66")));
    }
}
