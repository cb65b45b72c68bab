//! The families of SSI encoders, shared by all sessions.

use std::sync::Arc;

use super::Encoder;
use super::explain;
use crate::app::action::{Action, TaskResult};
use crate::app::services::Services;
use crate::app::{AnyDevice, Severity};
use crate::devices::ssi::jobs;
use crate::devices::ssi::protocol::Families;

/// Returns the built-in families, and the user-defined ones once they are loaded. The first call starts to load them in
/// a task.
pub(super) fn families(services: &mut Services) -> Arc<Families> {
    if let Some(families) = services.shared_data::<Arc<Families>>() {
        return families.clone();
    }
    let built_in = Arc::new(Families::built_in());
    services.share_value(built_in.clone());
    let store = services.world.store.clone();
    services.tasks.run("families", move || {
        let (families, broken) = jobs::families(&store);
        Action::Done(TaskResult::Shared(Box::new(move |services, devices| {
            for error in &broken {
                services.notify(Severity::Warning, vec![explain::family_error_text(error)], None);
            }
            update_families(&Arc::new(families), services, devices);
        })))
    });
    built_in
}

fn update_families(families: &Arc<Families>, services: &mut Services, devices: &mut [Box<AnyDevice>]) {
    for encoder in devices.iter_mut().filter_map(|device| device.get_mut::<Encoder>()) {
        encoder.update_families(families.clone());
    }
    services.share_value(families.clone());
}
