//! A HIPERFACE encoder among the devices of the studio.

use std::convert::Infallible;
use std::path::PathBuf;

use super::{Action, Encoder};
use crate::app::action::Opened;
use crate::app::recorder::Recorder;
use crate::app::services::{Services, World};
use crate::app::session::Saved;
use crate::app::{ActContext, DeviceCommand, DeviceMemory, DeviceModel, Prepare, SineCosineSource, Tab};
use crate::devices::hiperface::jobs::Hiperface;
use crate::devices::hiperface::procedures::AccessCodes;
use crate::profile::{Body, ProfileError};

impl DeviceModel for Encoder {
    const TAB: Tab = Tab::Hiperface;
    type Action = Action;
    type Done = Infallible;

    fn prepare(&self, world: &World) -> Prepare<Hiperface> {
        let codes = world.given.get::<AccessCodes>().cloned().unwrap_or_default();
        Box::new(move |session| codes.set_in(session.codes_mut()))
    }

    fn connect(&mut self, opened: Opened<Hiperface>, services: &mut Services) {
        Encoder::connect(self, opened, services);
    }

    fn act(&mut self, action: Action, context: &mut ActContext<'_>) {
        Encoder::act(self, action, context.services);
    }

    fn command(&mut self, command: DeviceCommand, services: &mut Services) {
        Encoder::command(self, command, services);
    }

    fn done(&mut self, done: Infallible, _services: &mut Services) {
        match done {}
    }

    fn wanted_body(&self) -> Option<Body> {
        Saved::wanted_body(self)
    }

    fn take_over(&mut self, body: Body, services: &mut Services) -> Result<(), ProfileError> {
        Saved::restore(self, body, services)
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
        Saved::save(self, path, services);
    }

    fn is_savable(&self) -> bool {
        self.saves_what_was_read() || self.session.is_savable()
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

    fn memory(&self) -> Option<&dyn DeviceMemory> {
        Some(self)
    }

    fn memory_mut(&mut self) -> Option<&mut dyn DeviceMemory> {
        Some(self)
    }

    fn sine_cosine(&self) -> Option<&dyn SineCosineSource> {
        Some(self)
    }

    fn sine_cosine_mut(&mut self) -> Option<&mut dyn SineCosineSource> {
        Some(self)
    }
}
