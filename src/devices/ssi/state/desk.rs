//! SSI encoders among the devices of the studio.

use std::path::PathBuf;
use std::sync::Arc;

use super::encoder::Encoder;
use crate::app::Severity;
use crate::app::session::Source;
use crate::app::studio::Studio;
use crate::app::tab::Tab;
use crate::devices::ssi::protocol::Families;
use crate::devices::ssi::state::explain as words;
use crate::store::StoreError;

impl Studio {
    /// The encoder or layout that the SSI tab shows.
    pub fn ssi(&self) -> Option<&Encoder> {
        self.device(self.shown.of(Tab::Ssi)?)?.get()
    }

    /// Shows a tab. A layout needs no device: where there is none, one to begin with.
    pub(crate) fn show_tab(&mut self, tab: Tab) {
        self.settings.tab = tab;
        if tab == Tab::Ssi && self.ssi().is_none() {
            self.new_layout();
        }
    }

    /// A layout that is in no file yet, with the first name that no other such layout has.
    pub(crate) fn new_layout(&mut self) {
        let taken = |name: &PathBuf| {
            let others = self.devices.iter().map(|device| device.source());
            others.into_iter().any(|source| matches!(source, Source::New { suggested } if suggested == name))
        };
        let further = (2..).map(|number: u32| PathBuf::from(format!("layout-{number}.ron")));
        let mut names = std::iter::once(PathBuf::from("layout.ron")).chain(further);
        let Some(name) = names.find(|name| !taken(name)) else { return };
        let id = self.new_id();
        let layout = Encoder::new_layout(id, name, &mut self.services);
        self.devices.push(Box::new(layout));
        self.show(Tab::Ssi, id);
    }

    /// The families were read; those that cannot be used are told.
    pub(crate) fn take_families(&mut self, families: Arc<Families>, broken: &[StoreError]) {
        for error in broken {
            self.services.tell(Severity::Warning, vec![words::store(error)], None);
        }
        for device in &mut self.devices {
            if let Some(encoder) = device.get_mut::<Encoder>() {
                encoder.take_families(families.clone());
            }
        }
        self.services.families = families;
    }
}
