//! INTERBUS encoders among the devices of the studio.

use super::action::Action;
use super::encoder::Encoder;
use crate::app::services::Services;
use crate::app::studio::{SessionId, Studio};
use crate::app::tab::Tab;

impl Studio {
    /// The encoder or profile that the INTERBUS tab shows.
    pub fn interbus(&self) -> Option<&Encoder> {
        self.device(self.shown.of(Tab::Interbus)?)?.get()
    }

    pub(crate) fn act_interbus(&mut self, id: SessionId, action: Action) {
        match action {
            Action::Reconnect => self.reconnect(id),
            Action::WriteInto(_) if self.is_only_looked_at(id) => {}
            Action::WriteInto(target) => {
                let profile = self.device(id).and_then(|device| device.get::<Encoder>()?.wanted_profile());
                let Some(profile) = profile else { return };
                self.show(Tab::Interbus, target);
                self.with_interbus(target, |encoder, services| encoder.plan_restore(profile, services));
            }
            action => self.with_interbus(id, |encoder, services| encoder.act(action, services)),
        }
    }

    pub(crate) fn with_interbus(&mut self, id: SessionId, act: impl FnOnce(&mut Encoder, &mut Services)) {
        self.with_device(id, |device, services| {
            if let Some(encoder) = device.get_mut::<Encoder>() {
                act(encoder, services);
            }
        });
    }
}
