//! Deletes the fields that a write created when its backup is restored.

use super::DeviceState;
use crate::devices::hiperface::profile::{FieldImage, HiperfacePlan, HiperfaceProfile, Op};
use crate::devices::hiperface::protocol::FreeMemory;

/// Returns the created fields to delete, and the numbers of the created fields to keep. A field is deleted only if it
/// has not changed since the write and all later fields are deleted too.
pub(super) fn deletable_created_fields(profile: &HiperfaceProfile, device: &DeviceState) -> (Vec<FieldImage>, Vec<u8>) {
    let (mut undone, mut left) = (Vec::new(), Vec::new());
    for now in device.fields.iter().rev() {
        let is_wanted = profile.fields.iter().any(|field| field.number == now.number);
        let created = profile.created.iter().find(|field| field.number == now.number).filter(|_| !is_wanted);
        match created {
            // Only the last field can be deleted.
            Some(created) if created == now && undone.len() + usize::from(now.number) + 1 == device.fields.len() => {
                undone.push(now.clone());
            }
            Some(created) => left.push(created.number),
            None => {}
        }
    }
    left.reverse();
    (undone, left)
}

pub(super) fn without_fields(device: &DeviceState, deleted: &[FieldImage]) -> DeviceState {
    let blocks =
        deleted.iter().fold(device.memory.blocks, |sum, own| sum.saturating_add(own.status.size().block_count()));
    let count = u8::try_from(deleted.len()).unwrap_or(u8::MAX);
    let fields = device.fields.iter().filter(|own| !deleted.contains(own)).cloned().collect();
    let memory = FreeMemory { blocks, fields: device.memory.fields.saturating_sub(count) };
    DeviceState { memory, fields, ..device.clone() }
}

pub(super) fn delete(field: &FieldImage) -> Op {
    Op::Define { field: field.number, from: Some(field.status), to: field.status.as_deleted() }
}

/// Returns the fields that a plan both creates and fills completely.
pub fn created_fields(plan: &HiperfacePlan) -> Vec<FieldImage> {
    let mut created: Vec<(FieldImage, usize)> = Vec::new();
    let had = |number: u8| plan.base.fields.iter().any(|field| field.number == number);
    for op in &plan.ops {
        match op {
            Op::Define { field, from: None, to } if !had(*field) => {
                let bytes = Some(vec![0; to.size().bytes()]);
                created.push((FieldImage { number: *field, status: *to, bytes }, 0));
            }
            Op::Define { field, from: Some(_), to } => {
                if let Some((own, _)) = created.iter_mut().find(|(own, _)| own.number == *field) {
                    own.status = *to;
                }
            }
            Op::Store { field, address, new, .. } => {
                let own = created.iter_mut().find(|(own, _)| own.number == *field);
                let Some((FieldImage { bytes: Some(bytes), .. }, written)) = own else { continue };
                let start = usize::from(*address);
                if let Some(place) = bytes.get_mut(start..start + new.len()) {
                    place.copy_from_slice(new);
                    *written += new.len();
                }
            }
            _ => {}
        }
    }
    let whole = |(own, written): &(FieldImage, usize)| own.bytes.as_ref().is_some_and(|bytes| bytes.len() == *written);
    created.into_iter().filter(whole).map(|(own, _)| own).collect()
}
