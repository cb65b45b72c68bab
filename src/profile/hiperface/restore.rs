//! What restoring a profile would do: only what differs, in the fewest writes, and nothing that belongs to another
//! encoder's mounting.

use std::ops::Range;

use super::{Base, FieldImage, FieldRange, HiperfacePlan, HiperfaceProfile, Op};
use crate::profile::difference::runs;
use crate::protocol::hiperface::{CodeNumber, DataFieldStatus, FieldSize, FreeMemory};

/// What a restore may do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RestoreOptions {
    /// The profile may go onto an encoder with another serial number.
    pub allow_other_device: bool,
    /// Values of the mounting may go onto another encoder.
    pub with_mounting: bool,
    /// A field that has another size and is not the last may be deleted and created again, with all that come after it.
    pub recreate: bool,
}

/// An encoder's memory as it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceState {
    /// Serial number; empty where the encoder does not tell.
    pub serial_number: String,
    /// Type byte.
    pub encoder_type: u8,
    /// Free memory and number of fields.
    pub memory: FreeMemory,
    /// All fields in ascending order.
    pub fields: Vec<FieldImage>,
}

/// What a restore would do.
pub type Restore = crate::profile::Restore<HiperfacePlan, FieldRange>;

/// Why a profile cannot be restored.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// The profile was read from another encoder.
    #[error("the profile is of serial number {profile:?}, the encoder has {device:?}")]
    OtherDevice {
        /// In the profile.
        profile: String,
        /// In the encoder.
        device: String,
    },
    /// The profile is of another type of encoder.
    #[error("the profile is of type {profile:02X}h, the encoder of type {device:02X}h")]
    OtherType {
        /// In the profile.
        profile: u8,
        /// In the encoder.
        device: u8,
    },
    /// Only the last field changes its size.
    #[error("field {field} has {device} bytes in the encoder and {profile} in the profile, and is not the last")]
    SizeFixed {
        /// The field.
        field: u8,
        /// Bytes in the profile.
        profile: usize,
        /// Bytes in the encoder.
        device: usize,
    },
    /// Fields are created in ascending order.
    #[error("field {field} cannot be created before field {missing}")]
    Gap {
        /// The field.
        field: u8,
        /// The field that neither side has.
        missing: u8,
    },
    /// The EEPROM is too small.
    #[error("{needed} bytes are needed and {free} are free")]
    NoMemory {
        /// Bytes that the plan needs.
        needed: usize,
        /// Bytes that are free.
        free: usize,
    },
    /// A field has to be created again and its content cannot be read.
    #[error("field {field} has to be created again and its content cannot be read: access code {code} is not known")]
    WouldLose {
        /// The field.
        field: u8,
        /// Its code.
        code: CodeNumber,
    },
    /// Fields are created in ascending order.
    #[error("field {field} cannot be created: the next one is {next}")]
    NotNext {
        /// The field asked for.
        field: u8,
        /// The only one that can be created.
        next: u8,
    },
    /// Only the last field is deleted or changes its size.
    #[error("field {field} is not the last: that is {last}")]
    NotLast {
        /// The field asked for.
        field: u8,
        /// The only one that can.
        last: u8,
    },
    /// There is no such field.
    #[error("field {field} does not exist; the encoder has {count}")]
    NoSuchField {
        /// The field asked for.
        field: u8,
        /// Number of fields.
        count: u8,
    },
    /// WE is 0.
    #[error("field {field} is write protected")]
    WriteProtected {
        /// The field.
        field: u8,
    },
    /// Bytes beyond the end of the field.
    #[error("field {field} has bytes 0 to {last}; {count} bytes at {start} do not fit")]
    OutOfField {
        /// The field.
        field: u8,
        /// Its last byte.
        last: usize,
        /// First byte to write.
        start: usize,
        /// Bytes to write.
        count: usize,
    },
    /// The content of the field cannot be read.
    #[error("field {field} cannot be read: access code {code} is not known")]
    CodeUnknown {
        /// The field.
        field: u8,
        /// Its code.
        code: CodeNumber,
    },
}

/// Plans a restore.
///
/// # Errors
/// See [`PlanError`]; nothing has been written.
pub fn plan_restore(
    profile: &HiperfaceProfile,
    device: &DeviceState,
    options: RestoreOptions,
) -> Result<Restore, PlanError> {
    let same_device = is_same_device(profile, &device.serial_number);
    if !options.allow_other_device {
        check_device(profile, &device.serial_number, device.encoder_type)?;
    }
    let mut planner = Planner {
        profile,
        device,
        keep_mounting: !same_device && !options.with_mounting,
        ops: Vec::new(),
        unchanged: 0,
        missing: Vec::new(),
        mounting_left: Vec::new(),
        touched: Vec::new(),
    };
    planner.check_order()?;
    let recreated = planner.first_to_recreate(options.recreate)?;
    planner.check_memory(recreated)?;
    let mut kept = device.fields.clone();
    if let Some(first) = recreated {
        planner.delete_from(first)?;
        kept.truncate(usize::from(first));
    }
    for target in planner.targets(recreated) {
        match kept.iter().find(|field| field.number == target.number) {
            Some(now) => planner.change(now, &target),
            None => planner.create(&target),
        }
    }
    Ok(planner.finish())
}

/// Refuses an encoder that the profile was not read from. Encoders that do not tell their serial number are never the
/// same one.
///
/// # Errors
/// [`PlanError::OtherDevice`], [`PlanError::OtherType`].
pub fn check_device(profile: &HiperfaceProfile, serial_number: &str, encoder_type: u8) -> Result<(), PlanError> {
    if !is_same_device(profile, serial_number) {
        return Err(PlanError::OtherDevice {
            profile: profile.identity.serial_number.clone(),
            device: serial_number.to_owned(),
        });
    }
    if profile.identity.encoder_type != encoder_type {
        return Err(PlanError::OtherType { profile: profile.identity.encoder_type, device: encoder_type });
    }
    Ok(())
}

fn is_same_device(profile: &HiperfaceProfile, serial_number: &str) -> bool {
    !serial_number.is_empty() && profile.identity.serial_number == serial_number
}

struct Planner<'a> {
    profile: &'a HiperfaceProfile,
    device: &'a DeviceState,
    keep_mounting: bool,
    ops: Vec<Op>,
    unchanged: u64,
    missing: Vec<String>,
    mounting_left: Vec<FieldRange>,
    touched: Vec<u8>,
}

impl Planner<'_> {
    /// Fields that are to be created have to follow each other.
    fn check_order(&self) -> Result<(), PlanError> {
        let mut next = self.device.memory.fields;
        for field in self.profile.fields.iter().filter(|field| field.number >= self.device.memory.fields) {
            if field.number != next {
                return Err(PlanError::Gap { field: field.number, missing: next });
            }
            next = next.saturating_add(1);
        }
        Ok(())
    }

    /// The first field whose size has to change although fields follow it.
    fn first_to_recreate(&self, allowed: bool) -> Result<Option<u8>, PlanError> {
        let last = self.device.fields.last().map(|field| field.number);
        for target in &self.profile.fields {
            let Some(now) = self.device.fields.iter().find(|field| field.number == target.number) else { continue };
            if now.status.size() != target.status.size() && Some(now.number) != last {
                if allowed {
                    return Ok(Some(now.number));
                }
                return Err(PlanError::SizeFixed {
                    field: now.number,
                    profile: target.status.size().bytes(),
                    device: now.status.size().bytes(),
                });
            }
        }
        Ok(None)
    }

    fn check_memory(&self, recreated: Option<u8>) -> Result<(), PlanError> {
        let blocks =
            |fields: &[FieldImage]| fields.iter().map(|f| usize::from(f.status.size().blocks())).sum::<usize>();
        let mut after: Vec<FieldImage> =
            self.device.fields.iter().filter(|now| self.target_of(now.number).is_none()).cloned().collect();
        after.extend(self.targets(recreated));
        after.sort_by_key(|field| field.number);
        after.dedup_by_key(|field| field.number);
        let have = blocks(&self.device.fields) + usize::from(self.device.memory.blocks);
        let needed = blocks(&after);
        if needed > have {
            let now = blocks(&self.device.fields);
            return Err(PlanError::NoMemory {
                needed: needed.saturating_sub(now) * FieldSize::BLOCK,
                free: self.device.memory.bytes(),
            });
        }
        Ok(())
    }

    fn target_of(&self, number: u8) -> Option<&FieldImage> {
        self.profile.fields.iter().find(|field| field.number == number)
    }

    /// The fields as they are to be: those of the profile, and, where fields are created again, the encoder's own that
    /// the profile does not have.
    fn targets(&self, recreated: Option<u8>) -> Vec<FieldImage> {
        let mut targets = self.profile.fields.clone();
        if let Some(first) = recreated {
            let own = self.device.fields.iter().filter(|f| f.number >= first && self.target_of(f.number).is_none());
            targets.extend(own.cloned());
            targets.sort_by_key(|field| field.number);
            // What the profile has no bytes for keeps its own.
            for target in targets.iter_mut().filter(|target| target.bytes.is_none() && target.number >= first) {
                let own = self.device.fields.iter().find(|field| field.number == target.number);
                target.bytes =
                    own.filter(|own| own.status.size() == target.status.size()).and_then(|own| own.bytes.clone());
            }
        }
        targets
    }

    fn delete_from(&mut self, first: u8) -> Result<(), PlanError> {
        for now in self.device.fields.iter().rev().filter(|field| field.number >= first) {
            if now.bytes.is_none() {
                return Err(PlanError::WouldLose { field: now.number, code: now.status.code() });
            }
            self.touched.push(now.number);
            self.ops.push(Op::Define { field: now.number, from: Some(now.status), to: now.status.deleted() });
        }
        Ok(())
    }

    /// What a new field holds is not known, so all of it is written; then it is protected if it has to be.
    fn create(&mut self, target: &FieldImage) {
        let writable = target.status.with_write_enable(true);
        let first = if target.bytes.is_some() { writable } else { target.status };
        if target.bytes.is_none() {
            // It is created because others may follow it; what was in it nobody knows.
            self.missing.push(FieldRange { field: target.number, start: 0, count: None }.to_string());
        }
        self.ops.push(Op::Define { field: target.number, from: None, to: first });
        if let Some(bytes) = &target.bytes {
            for range in self.allowed(target.number, 0..bytes.len()) {
                self.store(target.number, writable, range, None, bytes);
            }
        }
        if first != target.status {
            self.ops.push(Op::Define { field: target.number, from: Some(first), to: target.status });
        }
    }

    fn change(&mut self, now: &FieldImage, target: &FieldImage) {
        // A field that one side cannot read is left alone.
        let (Some(old), Some(new)) = (&now.bytes, &target.bytes) else {
            if now != target {
                self.missing.push(FieldRange { field: now.number, start: 0, count: None }.to_string());
            }
            return;
        };
        let mut stores: Vec<(Range<usize>, bool)> = Vec::new();
        for run in runs(old, new) {
            stores.extend(self.allowed(now.number, run).into_iter().map(|range| (range, true)));
        }
        if new.len() > old.len() {
            // The part that the last field grows by: its content is not known.
            stores.extend(self.allowed(now.number, old.len()..new.len()).into_iter().map(|range| (range, false)));
        }
        self.unchanged += u64::from(now.status == target.status);
        let changed: usize = runs(old, new).iter().map(ExactSizeIterator::len).sum();
        self.unchanged += (old.len().min(new.len()) - changed) as u64;

        let can_write_first = now.status.is_writable() && now.status.size() >= target.status.size();
        let working =
            if stores.is_empty() || can_write_first { now.status } else { target.status.with_write_enable(true) };
        if working != now.status {
            self.define(now.number, now.status, working);
        }
        for (range, known) in stores {
            self.store(now.number, working, range, known.then_some(old.as_slice()), new);
        }
        if working != target.status {
            self.define(now.number, working, target.status);
        }
    }

    /// The parts of a range that may be written: all, or all but the values of the mounting.
    fn allowed(&mut self, field: u8, range: Range<usize>) -> Vec<Range<usize>> {
        if !self.keep_mounting {
            return vec![range];
        }
        let mut allowed: Vec<Range<usize>> = Vec::new();
        let mut left: Vec<Range<usize>> = Vec::new();
        for at in range {
            let part = if self.profile.is_mounting(field, at) { &mut left } else { &mut allowed };
            match part.last_mut() {
                Some(run) if run.end == at => run.end += 1,
                _ => part.push(at..at + 1),
            }
        }
        self.mounting_left.extend(left.into_iter().map(|run| FieldRange::new(field, run.start, run.len())));
        allowed
    }

    fn define(&mut self, field: u8, from: DataFieldStatus, to: DataFieldStatus) {
        self.touched.push(field);
        self.ops.push(Op::Define { field, from: Some(from), to });
    }

    fn store(&mut self, field: u8, status: DataFieldStatus, range: Range<usize>, old: Option<&[u8]>, new: &[u8]) {
        let (Ok(address), Some(new)) = (u8::try_from(range.start), new.get(range.clone())) else { return };
        if old.is_some() {
            self.touched.push(field);
        }
        let old = old.and_then(|old| old.get(range)).map(<[u8]>::to_vec);
        self.ops.push(Op::Store { field, address, status, old, new: new.to_vec() });
    }

    fn finish(mut self) -> Restore {
        for now in &self.device.fields {
            if self.target_of(now.number).is_none() {
                self.missing.push(FieldRange { field: now.number, start: 0, count: None }.to_string());
            }
        }
        let fields = self.device.fields.iter().filter(|field| self.touched.contains(&field.number)).cloned().collect();
        Restore {
            plan: HiperfacePlan {
                base: Base { field_count: self.device.memory.fields, fields, scalars: Vec::new() },
                ops: self.ops,
            },
            unchanged: self.unchanged,
            missing: self.missing,
            mounting_left: self.mounting_left,
        }
    }
}

#[cfg(test)]
mod tests;
