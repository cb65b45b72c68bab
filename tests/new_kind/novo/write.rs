//! Writes a plan to a Novo encoder.

use encoder_studio::profile::{Body, ChangedItem, ConfirmedPlan, DeviceError, ProfileDocument, Write, WrittenChanges};
use encoder_studio::store::{DeviceKey, EntryKind};
use encoder_studio::worker::SessionContext;
use encoder_studio::worker::commit::{PlanHeader, PlannedWrite, backup_document};

use super::jobs::{Error, MAX_WRITE_CYCLES, Novo, Prepared, device_key};
use super::profile::{NovoPlan, NovoProfile, Op};
use super::protocol::{Request, Values, item_address};

pub(super) struct NovoWrite<'w> {
    pub(super) novo: &'w mut Novo,
    pub(super) context: &'w mut SessionContext,
}

impl Write for NovoWrite<'_> {
    type Base = (u16, Values);
    type Op = Op;
    type Error = Error;
    type Written = WrittenChanges;
    type EndState = ();

    fn confirm_base(&mut self, plan: &NovoPlan) -> Result<(), Error> {
        let now = self.novo.survey(self.context)?;
        if plan.base == (now.serial, now.values) { Ok(()) } else { Err(Error::Changed) }
    }
    fn apply(
        &mut self,
        op: &Op,
        _: &ConfirmedPlan<'_, (u16, Values), Op>,
        done: &mut WrittenChanges,
    ) -> Result<(), Error> {
        let address = item_address(op.item);
        done.write_cycles += 1;
        self.novo.ask(self.context, Request::Write(address, op.to))?;
        if self.novo.ask(self.context, Request::Read(address))? != op.to {
            return Err(Error::NotAccepted(op.name()));
        }
        done.verified += 1;
        done.count_operation(1);
        Ok(())
    }
    fn end_state(&mut self, _: &Error) {}
}

impl DeviceError for Error {
    fn is_only_cancelled(&self) -> bool {
        *self == Error::Cancelled
    }
}

impl PlannedWrite for Prepared {
    type Base = (u16, Values);
    type Op = Op;
    type Kind = ();

    fn header(&self) -> PlanHeader<'_, Self> {
        PlanHeader { plan: &self.plan, kind: (), cycles_seen: self.seen, wear_limit: MAX_WRITE_CYCLES }
    }

    fn device(&self, is_virtual: bool) -> DeviceKey {
        device_key(self.serial, is_virtual)
    }
    fn changed_items(&self, op: &Op) -> Vec<ChangedItem> {
        vec![ChangedItem::new(op.name(), None, None)]
    }
    fn entry_kind(&self) -> EntryKind {
        EntryKind::Write
    }
    fn backup(&self) -> ProfileDocument {
        let (serial, values) = self.plan.base;
        backup_document(Body::new(NovoProfile { serial, values }))
    }
}
