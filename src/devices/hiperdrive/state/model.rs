//! HIPERDRIVE drives behind an adapter or a hub among the devices of the studio.

use std::convert::Infallible;
use std::path::PathBuf;

use super::{Action, Unit};
use crate::app::action::Opened;
use crate::app::recorder::Recorder;
use crate::app::services::Services;
use crate::app::session::Saved;
use crate::app::{ActContext, DeviceCommand, DeviceMemory, DeviceModel, Marks, MotionControl, RememberedDrives, Tab};
use crate::devices::hiperdrive::jobs::Hiperdrive;
use crate::profile::{Body, ProfileError};

impl DeviceModel for Unit {
    const TAB: Tab = Tab::Hiperdrive;
    type Action = Action;
    type Done = Infallible;

    fn connect(&mut self, opened: Opened<Hiperdrive>, services: &mut Services) {
        Unit::connect(self, opened, services);
    }

    fn act(&mut self, action: Action, context: &mut ActContext<'_>) {
        Unit::act(self, action, context.services);
    }

    fn command(&mut self, command: DeviceCommand, services: &mut Services) {
        Unit::command(self, command, services);
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
        Unit::edits(self)
    }

    fn is_dirty(&self) -> bool {
        Unit::is_dirty(self)
    }

    fn can_undo(&self) -> bool {
        Unit::can_undo(self)
    }

    fn can_redo(&self) -> bool {
        Unit::can_redo(self)
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

    fn recorders(&self) -> Vec<&Recorder> {
        Unit::recorders(self).collect()
    }

    fn recorders_mut(&mut self) -> Vec<&mut Recorder> {
        Unit::recorders_mut(self).collect()
    }

    fn is_active(&self) -> bool {
        Unit::is_active(self)
    }

    fn stop(&mut self, services: &mut Services) {
        Unit::stop(self, services);
    }

    fn motion(&self) -> Option<&dyn MotionControl> {
        Some(self)
    }

    fn motion_mut(&mut self) -> Option<&mut dyn MotionControl> {
        Some(self)
    }
}

impl MotionControl for Unit {
    fn stop(&mut self) {
        self.moves.stop();
    }

    fn let_go(&mut self) {
        self.moves.let_go();
    }

    fn is_moving(&self) -> bool {
        Unit::is_moving(self)
    }

    fn moves_by_hand(&self) -> bool {
        self.moves.is_moving() || self.moves.is_under_way()
    }

    fn is_under_way(&self) -> bool {
        self.moves.is_under_way()
    }

    fn is_in_control(&self) -> bool {
        self.moves.is_open()
    }

    fn remembered_as(&self) -> Option<String> {
        Unit::remembered_as(self)
    }

    fn exchange_remembered(&mut self, kept: &RememberedDrives) -> Option<RememberedDrives> {
        Unit::exchange_remembered(self, kept)
    }

    fn lock_by(&mut self, found: &RememberedDrives) {
        Unit::lock_by(self, found);
    }

    fn marks(&self) -> Marks {
        self.marks
    }

    fn set_marks(&mut self, marks: Marks) {
        self.marks = marks;
    }
}
