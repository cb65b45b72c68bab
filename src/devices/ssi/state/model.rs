//! An SSI encoder among the devices of the studio.

use std::path::PathBuf;

use super::design::Edit;
use super::{Action, Done, Encoder};
use crate::app::action::Opened;
use crate::app::recorder::Recorder;
use crate::app::services::{Services, World};
use crate::app::{ActContext, DeviceCommand, DeviceModel, Prepare, Tab};
use crate::devices::ssi::jobs::Ssi;
use crate::link::LinkUrl;
use crate::profile::{Body, ProfileError};

impl DeviceModel for Encoder {
    const TAB: Tab = Tab::Ssi;
    type Action = Action;
    type Done = Done;

    fn prepare(&self, _world: &World) -> Prepare<Ssi> {
        let asking = self.asking();
        Box::new(move |session| session.ask_like(asking))
    }

    fn connect(&mut self, opened: Opened<Ssi>, services: &mut Services) {
        Encoder::connect(self, opened, services);
    }

    fn act(&mut self, action: Action, context: &mut ActContext<'_>) {
        Encoder::act(self, action, context);
    }

    fn command(&mut self, command: DeviceCommand, services: &mut Services) {
        Encoder::command(self, command, services);
    }

    fn done(&mut self, done: Done, services: &mut Services) {
        Encoder::done(self, done, services);
    }

    fn wanted_body(&self) -> Option<Body> {
        Some(Body::new(self.wanted_profile()))
    }

    fn take_over(&mut self, body: Body, _services: &mut Services) -> Result<(), ProfileError> {
        self.edit(Edit::Whole(Box::new(body.into_profile()?)));
        Ok(())
    }

    fn edits(&self) -> usize {
        Encoder::edits(self)
    }

    fn is_dirty(&self) -> bool {
        Encoder::is_dirty(self)
    }

    fn can_undo(&self) -> bool {
        Encoder::can_undo(self)
    }

    fn can_redo(&self) -> bool {
        Encoder::can_redo(self)
    }

    fn save(&mut self, path: PathBuf, services: &mut Services) {
        Encoder::save(self, path, services);
    }

    fn is_savable(&self) -> bool {
        // A layout can be saved at any time.
        true
    }

    fn recorder(&self) -> &Recorder {
        self.record.recorder()
    }

    fn recorder_mut(&mut self) -> &mut Recorder {
        self.record.recorder_mut()
    }

    fn dropped(&self) -> u64 {
        self.record.dropped()
    }

    fn streams(&self) -> bool {
        // There is always an adapter.
        true
    }

    fn take_link(&mut self, url: &LinkUrl) {
        Encoder::take_link(self, url);
    }
}
