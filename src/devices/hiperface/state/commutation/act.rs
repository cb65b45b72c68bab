//! Handles the user's actions in the commutation assistant.

use super::outcome::reading_permission;
use super::{CommutationAction, VectorSlot};
use crate::app::services::Services;
use crate::app::session::{HasMemory, SessionEvents};
use crate::app::{Severity, Text};
use crate::devices::hiperface::jobs::{Change, HiperfaceJob};
use crate::devices::hiperface::state::{Encoder, TEXTS};

impl Encoder {
    pub(in crate::devices::hiperface::state) fn handle_commutation_action(
        &mut self,
        action: CommutationAction,
        services: &mut Services,
    ) {
        match action {
            CommutationAction::Edit(form) => {
                self.commutation.form = *form;
                self.commutation.problem = None;
            }
            CommutationAction::Read(slot) => self.read_into_slot(slot, services),
            CommutationAction::Use(slot) => self.commutation.apply_typed_value(slot),
            CommutationAction::Clear => self.commutation.forget_readings(),
            CommutationAction::Store => {
                match self.with_verified_offset(|own| own.commutation.bytes(own.geometry(), &own.staged)) {
                    Ok((field, address, bytes)) => {
                        self.edit_bytes(field, address, &bytes, services);
                        // The location is stored in the form, so that the next offset replaces this one even if another
                        // location is empty.
                        (self.commutation.form.field, self.commutation.form.address) =
                            (Some(field), address.to_string());
                        let is_there = |(at, byte): (usize, &u8)| self.staged.byte(field, at) == Some(*byte);
                        if (address..).zip(&bytes).all(is_there) {
                            let edited = (address..address + bytes.len()).any(|at| self.staged.is_edited(field, at));
                            let id = if edited { "commutation.staged" } else { "commutation.same" };
                            let text = TEXTS.text(id).with("field", field).with("address", address);
                            services.notify(Severity::Good, vec![text], Some(&self.session.name()));
                        }
                    }
                    Err(why) => self.commutation.problem = Some(why),
                }
            }
            CommutationAction::Set => match self.with_verified_offset(|own| own.commutation.setting(own.geometry())) {
                Ok(setting) => {
                    let (wanted, exact) = (setting.value, setting.exact);
                    let change = Change::SetPosition { wanted, exact, synchronise: false, kit: false };
                    self.plan(change, services);
                }
                Err(why) => self.commutation.problem = Some(why),
            },
        }
    }

    /// Returns the result if the offset has been verified, or an error otherwise.
    fn with_verified_offset<T>(&self, result: impl FnOnce(&Self) -> Result<T, Text>) -> Result<T, Text> {
        let result = result(self)?;
        self.commutation.check_offset_is_verified(self.geometry()).map(|()| result)
    }

    fn read_into_slot(&mut self, slot: VectorSlot, services: &mut Services) {
        if let Err(why) = reading_permission(&self.commutation, self.session.is_ready()) {
            self.commutation.problem = Some(why);
            return;
        }
        self.commutation.problem = None;
        if self.try_submit(HiperfaceJob::Rest, services) {
            self.commutation.request_reading(slot);
        }
    }
}
