//! Plans the operations of a restore, field by field.

use std::ops::Range;

use super::undo::delete;
use super::{DeviceState, PlanError};
use crate::devices::hiperface::profile::{Base, FieldImage, FieldRange, HiperfacePlan, HiperfaceProfile, Op};
use crate::devices::hiperface::protocol::{DataFieldStatus, FieldSize};
use crate::profile::difference::differing_ranges;

pub(super) struct Planner<'a> {
    pub(super) profile: &'a HiperfaceProfile,
    pub(super) device: &'a DeviceState,
    pub(super) wanted: Vec<FieldImage>,
    /// Fields whose bytes of unknown meaning are left unchanged.
    pub(super) left: Vec<u8>,
    pub(super) is_other: bool,
    pub(super) with_mounting: bool,
    pub(super) ops: Vec<Op>,
    pub(super) unchanged: u64,
    pub(super) missing: Vec<FieldRange>,
    pub(super) mounting_left: Vec<FieldRange>,
    pub(super) mounting_written: Vec<FieldRange>,
    pub(super) touched: Vec<u8>,
}

impl Planner<'_> {
    /// Excludes fields whose bytes of unknown meaning are left unchanged, unless mounting values are written to them.
    /// If such a field is missing in the encoder and a later field must be created, the field is created without
    /// content.
    pub(super) fn skip_unknown_fields(&mut self) {
        let (profile, device, with_mounting) = (self.profile, self.device, self.with_mounting);
        let left = std::mem::take(&mut self.left);
        let stays = |own: &FieldImage| {
            let bytes = own.bytes.as_ref().map_or(0, Vec::len);
            let has_mounting = (0..bytes).any(|at| profile.depends_on_mounting(own.number, at));
            !left.contains(&own.number) || (with_mounting && has_mounting)
        };
        let last = self.wanted.iter().filter(|own| stays(own)).map(|own| own.number).max();
        for target in std::mem::take(&mut self.wanted) {
            let now = device.fields.iter().find(|field| field.number == target.number);
            match now {
                _ if !left.contains(&target.number) => self.wanted.push(target),
                Some(now) if stays(&target) => {
                    let fits = now.status.size() == target.status.size();
                    let status = if fits { now.status } else { target.status };
                    self.wanted.push(FieldImage { status, ..target });
                }
                None if stays(&target) => self.wanted.push(target),
                None if last.is_some_and(|last| target.number < last) => {
                    self.wanted.push(FieldImage { bytes: None, ..target });
                }
                _ => {}
            }
        }
        self.left = left;
        if !with_mounting {
            self.report_skipped_mounting();
        }
    }

    fn report_skipped_mounting(&mut self) {
        let profile = self.profile;
        for target in &profile.fields {
            let is_wanted = self.target_field(target.number).is_some_and(|own| own.bytes.is_some());
            if is_wanted || !self.left.contains(&target.number) {
                continue;
            }
            let now = self.device.fields.iter().find(|field| field.number == target.number);
            let old = now.and_then(|now| now.bytes.as_deref()).unwrap_or_default();
            let new = target.bytes.as_deref().unwrap_or_default();
            for range in differing_ranges(old, new).into_iter().chain(std::iter::once(old.len()..new.len())) {
                self.writable_parts(target.number, range);
            }
        }
    }

    /// Checks that the fields to be created are numbered consecutively.
    pub(super) fn check_fields_are_consecutive(&self) -> Result<(), PlanError> {
        let mut next = self.device.memory.fields;
        for field in self.wanted.iter().filter(|field| field.number >= self.device.memory.fields) {
            if field.number != next {
                return Err(PlanError::Gap { field: field.number, missing: next });
            }
            next = next.saturating_add(1);
        }
        Ok(())
    }

    /// Returns the first field that must be created again, because its size changes and other fields follow it.
    pub(super) fn first_field_to_recreate(&self, allowed: bool) -> Result<Option<u8>, PlanError> {
        let last = self.device.fields.last().map(|field| field.number);
        for target in &self.wanted {
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

    pub(super) fn check_memory(&self, recreated: Option<u8>) -> Result<(), PlanError> {
        let blocks =
            |fields: &[FieldImage]| fields.iter().map(|f| usize::from(f.status.size().block_count())).sum::<usize>();
        let mut after: Vec<FieldImage> =
            self.device.fields.iter().filter(|now| self.target_field(now.number).is_none()).cloned().collect();
        after.extend(self.target_fields(recreated));
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

    fn target_field(&self, number: u8) -> Option<&FieldImage> {
        self.wanted.iter().find(|field| field.number == number)
    }

    /// Returns the fields of the profile. If fields must be created again, fields that exist only in the encoder are
    /// added.
    pub(super) fn target_fields(&self, recreated: Option<u8>) -> Vec<FieldImage> {
        let mut targets = self.wanted.clone();
        if let Some(first) = recreated {
            let own = self.device.fields.iter().filter(|f| f.number >= first && self.target_field(f.number).is_none());
            targets.extend(own.cloned());
            targets.sort_by_key(|field| field.number);
            // Fields without bytes in the profile keep the bytes of the encoder.
            for target in targets.iter_mut().filter(|target| target.bytes.is_none() && target.number >= first) {
                let own = self.device.fields.iter().find(|field| field.number == target.number);
                target.bytes =
                    own.filter(|own| own.status.size() == target.status.size()).and_then(|own| own.bytes.clone());
            }
        }
        targets
    }

    pub(super) fn delete_fields_from(&mut self, first: u8) -> Result<(), PlanError> {
        for now in self.device.fields.iter().rev().filter(|field| field.number >= first) {
            if now.bytes.is_none() {
                return Err(PlanError::WouldLose { field: now.number, code: now.status.code() });
            }
            self.touched.push(now.number);
            self.ops.push(delete(now));
        }
        Ok(())
    }

    /// Plans a new field. All its bytes are written, because its initial content is unknown. Write protection is set
    /// last.
    pub(super) fn create(&mut self, target: &FieldImage) {
        let writable = target.status.with_write_enable(true);
        let first = if target.bytes.is_some() { writable } else { target.status };
        if target.bytes.is_none() && !self.left.contains(&target.number) {
            // The field is created because others may follow it, but its former content is unknown.
            self.missing.push(FieldRange::whole_field(target.number));
        }
        self.ops.push(Op::Define { field: target.number, from: None, to: first });
        if let Some(bytes) = &target.bytes {
            for range in self.writable_parts(target.number, 0..bytes.len()) {
                self.store_bytes(target.number, writable, range, None, bytes);
            }
        }
        if first != target.status {
            self.ops.push(Op::Define { field: target.number, from: Some(first), to: target.status });
        }
    }

    pub(super) fn change_field(&mut self, now: &FieldImage, target: &FieldImage) {
        // A field that is unreadable on one side is left unchanged.
        let (Some(old), Some(new)) = (&now.bytes, &target.bytes) else {
            if now != target {
                self.missing.push(FieldRange::whole_field(now.number));
            }
            return;
        };
        let mut stores: Vec<(Range<usize>, bool)> = Vec::new();
        for run in differing_ranges(old, new) {
            stores.extend(self.writable_parts(now.number, run).into_iter().map(|range| (range, true)));
        }
        if new.len() > old.len() {
            // The content of the part by which the last field grows is unknown.
            stores
                .extend(self.writable_parts(now.number, old.len()..new.len()).into_iter().map(|range| (range, false)));
        }
        self.unchanged += u64::from(now.status == target.status);
        let changed: usize = differing_ranges(old, new).iter().map(ExactSizeIterator::len).sum();
        self.unchanged += (old.len().min(new.len()) - changed) as u64;

        let can_write_first = now.status.is_writable() && now.status.size() >= target.status.size();
        let working =
            if stores.is_empty() || can_write_first { now.status } else { target.status.with_write_enable(true) };
        if working != now.status {
            self.define_field(now.number, now.status, working);
        }
        for (range, known) in stores {
            self.store_bytes(now.number, working, range, known.then_some(old.as_slice()), new);
        }
        if working != target.status {
            self.define_field(now.number, working, target.status);
        }
    }

    /// Returns the parts of a range that may be written. If the profile is from another encoder, mounting values may be
    /// excluded.
    fn writable_parts(&mut self, field: u8, range: Range<usize>) -> Vec<Range<usize>> {
        if !self.is_other {
            return vec![range];
        }
        let (mut allowed, mut of_mounting) = (Vec::new(), Vec::new());
        for at in range {
            let is_mounting = self.profile.depends_on_mounting(field, at);
            if is_mounting {
                extend_runs(&mut of_mounting, at);
            }
            if if is_mounting { self.with_mounting } else { !self.left.contains(&field) } {
                extend_runs(&mut allowed, at);
            }
        }
        let of_mounting = of_mounting.into_iter().map(|run| FieldRange::new(field, run.start, run.len()));
        if self.with_mounting {
            self.mounting_written.extend(of_mounting);
        } else {
            self.mounting_left.extend(of_mounting);
        }
        allowed
    }

    fn define_field(&mut self, field: u8, from: DataFieldStatus, to: DataFieldStatus) {
        self.touched.push(field);
        self.ops.push(Op::Define { field, from: Some(from), to });
    }

    fn store_bytes(&mut self, field: u8, status: DataFieldStatus, range: Range<usize>, old: Option<&[u8]>, new: &[u8]) {
        let (Ok(address), Some(new)) = (u8::try_from(range.start), new.get(range.clone())) else { return };
        if old.is_some() {
            self.touched.push(field);
        }
        let old = old.and_then(|old| old.get(range)).map(<[u8]>::to_vec);
        self.ops.push(Op::Store { field, address, status, old, new: new.to_vec() });
    }

    pub(super) fn finish(mut self) -> crate::profile::Restore<HiperfacePlan, FieldRange, FieldRange> {
        for now in &self.device.fields {
            if self.target_field(now.number).is_none() && !self.left.contains(&now.number) {
                self.missing.push(FieldRange::whole_field(now.number));
            }
        }
        let fields = self.device.fields.iter().filter(|field| self.touched.contains(&field.number)).cloned().collect();
        crate::profile::Restore {
            plan: HiperfacePlan {
                base: Base { field_count: self.device.memory.fields, fields, scalars: Vec::new() },
                ops: self.ops,
            },
            unchanged: self.unchanged,
            missing: self.missing,
            mounting_left: self.mounting_left,
            mounting_written: self.mounting_written,
        }
    }
}

fn extend_runs(runs: &mut Vec<Range<usize>>, at: usize) {
    match runs.last_mut() {
        Some(run) if run.end == at => run.end += 1,
        _ => runs.push(at..at + 1),
    }
}
