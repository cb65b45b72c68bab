//! The devices on the desk, of whatever kind: what the studio asks of each of them.

mod of_kind;
mod shown;
mod wish;

use std::path::PathBuf;

use super::Text;
pub(super) use shown::Shown;
pub use wish::Wish;

use super::action::{Known, ReadError, ReviewAction};
use super::closing::MUCH;
use super::line::Progressing;
use super::recorder::Recorder;
use super::review::Sheet;
use super::services::{JobEnd, Services};
use super::session::{
    DraftDone, Drafted, Listed, OnLine, Opening, Phase, ProfileFile, Saved, Saving, Source, WithMemory,
};
use super::studio::SessionId;
use super::tab::Tab;
use super::trace::TraceLog;
use crate::devices::biss::state as biss;
use crate::devices::hiperdrive::state as hiperdrive;
use crate::devices::hiperface::state as hiperface;
use crate::devices::interbus::state as interbus;
use crate::devices::ssi::state as ssi;
use crate::link::LinkUrl;
use crate::profile::Document;
use crate::store::{Backup, DeviceKey, Entry, FileError, StatusEntry};

/// A device on the desk, or a profile of one.
pub enum AnyDevice {
    /// A HIPERFACE encoder.
    Hiperface(Box<hiperface::Encoder>),
    /// A BiSS encoder.
    Biss(Box<biss::Encoder>),
    /// An SSI encoder.
    Ssi(Box<ssi::Encoder>),
    /// An INTERBUS encoder.
    Interbus(Box<interbus::Encoder>),
    /// HIPERDRIVE drives behind an adapter or a hub.
    Hiperdrive(Box<hiperdrive::Unit>),
}

/// The same for every kind.
macro_rules! each {
    ($device:expr, $own:ident => $do:expr) => {
        match $device {
            AnyDevice::Hiperface($own) => $do,
            AnyDevice::Biss($own) => $do,
            AnyDevice::Ssi($own) => $do,
            AnyDevice::Interbus($own) => $do,
            AnyDevice::Hiperdrive($own) => $do,
        }
    };
}

/// The same for every kind that has a memory; what it is for one that has none.
macro_rules! each_with_memory {
    ($device:expr, $own:ident => $do:expr, $none:expr) => {
        match $device {
            AnyDevice::Hiperface($own) => $do,
            AnyDevice::Biss($own) => $do,
            AnyDevice::Interbus($own) => $do,
            AnyDevice::Hiperdrive($own) => $do,
            AnyDevice::Ssi(_) => $none,
        }
    };
}

impl AnyDevice {
    /// At a link that is being opened; `None` for a tab that shows no device.
    pub(super) fn at_link(tab: Tab, id: SessionId, url: LinkUrl, services: &mut Services) -> Option<Self> {
        match tab {
            Tab::Hiperface => Some(AnyDevice::Hiperface(Box::new(hiperface::Encoder::at_link(id, url)))),
            Tab::Biss => Some(AnyDevice::Biss(Box::new(biss::Encoder::at_link(id, url)))),
            Tab::Ssi => Some(AnyDevice::Ssi(Box::new(ssi::Encoder::at_link(id, url, services)))),
            Tab::Interbus => Some(AnyDevice::Interbus(Box::new(interbus::Encoder::at_link(id, url)))),
            Tab::Hiperdrive => Some(AnyDevice::Hiperdrive(Box::new(hiperdrive::Unit::at_link(id, url)))),
            Tab::Signals => None,
        }
    }

    /// A profile; `None` of a kind of device that the window does not show.
    pub(super) fn in_file(
        id: SessionId,
        file: ProfileFile,
        document: Document,
        known: Known,
        services: &mut Services,
    ) -> Option<Self> {
        Some(match document.body.kind() {
            crate::devices::hiperface::protocol::KIND => {
                let types = services.encoder_types(known.hiperface);
                AnyDevice::Hiperface(Box::new(hiperface::Encoder::in_file(id, file, document, &types, services)))
            }
            crate::devices::biss::protocol::KIND => {
                AnyDevice::Biss(Box::new(biss::Encoder::in_file(id, file, document, &known.biss, services)))
            }
            crate::devices::ssi::protocol::KIND => {
                AnyDevice::Ssi(Box::new(ssi::Encoder::in_file(id, file, document, services)))
            }
            crate::devices::interbus::protocol::KIND => {
                AnyDevice::Interbus(Box::new(interbus::Encoder::in_file(id, file, document, services)))
            }
            crate::devices::hiperdrive::protocol::KIND => {
                AnyDevice::Hiperdrive(Box::new(hiperdrive::Unit::in_file(id, file, document, services)))
            }
            _ => return None,
        })
    }

    /// Its number in the studio.
    pub fn id(&self) -> SessionId {
        each!(self, own => own.session.id)
    }

    /// The tab that shows it.
    pub fn tab(&self) -> Tab {
        match self {
            AnyDevice::Hiperface(_) => Tab::Hiperface,
            AnyDevice::Biss(_) => Tab::Biss,
            AnyDevice::Ssi(_) => Tab::Ssi,
            AnyDevice::Interbus(_) => Tab::Interbus,
            AnyDevice::Hiperdrive(_) => Tab::Hiperdrive,
        }
    }

    /// The name by which the log and the jobs call it.
    pub fn name(&self) -> String {
        each!(self, own => own.session.name())
    }

    /// Where the data come from, in words that may be seen.
    pub fn place(&self) -> String {
        each!(self, own => own.session.place())
    }

    /// Where the data come from.
    pub fn source(&self) -> &Source {
        each!(self, own => &own.session.source)
    }

    /// Another link leads to its wire, and counts from now on.
    pub(crate) fn take_link(&mut self, url: LinkUrl) {
        if let AnyDevice::Ssi(own) = self {
            own.take_link(&url);
        }
        each!(self, own => own.session.source = Source::Link(url));
    }

    /// How it stands with the connection.
    pub fn phase(&self) -> &Phase {
        each!(self, own => &own.session.phase)
    }

    pub(super) fn phase_mut(&mut self) -> &mut Phase {
        each!(self, own => &mut own.session.phase)
    }

    /// Its link is being opened.
    pub(super) fn is_opening(&self) -> bool {
        each!(self, own => own.session.opening.is_some())
    }

    pub(super) fn opening_mut(&mut self) -> &mut Option<Opening> {
        each!(self, own => &mut own.session.opening)
    }

    /// What has passed over the line.
    pub fn trace(&self) -> &TraceLog {
        each!(self, own => &own.session.trace)
    }

    /// The device lives in this process.
    pub fn is_virtual(&self) -> bool {
        each!(self, own => own.session.is_virtual())
    }

    /// Its line is open.
    pub fn is_connected(&self) -> bool {
        each!(self, own => own.session.line().is_some())
    }

    /// Something runs on its line.
    pub fn is_busy(&self) -> bool {
        each!(self, own => own.session.is_busy())
    }

    /// Its memory is being changed.
    pub fn is_writing(&self) -> bool {
        each!(self, own => own.session.is_writing())
    }

    /// It is read all the time.
    pub fn is_polling(&self) -> bool {
        each!(self, own => own.session.is_polling())
    }

    /// There is something to stop.
    pub fn is_active(&self) -> bool {
        match self {
            AnyDevice::Hiperdrive(own) => own.is_active(),
            _ => each!(self, own => own.session.is_active()),
        }
    }

    /// Connected and nothing runs: a job may begin.
    pub fn is_ready(&self) -> bool {
        each!(self, own => own.session.is_ready())
    }

    /// Its positions can come as a stream, thousands a second.
    pub fn streams(&self) -> bool {
        match self {
            AnyDevice::Hiperface(_) | AnyDevice::Interbus(_) | AnyDevice::Hiperdrive(_) => false,
            AnyDevice::Biss(own) => own.streams(),
            // There is always an adapter.
            AnyDevice::Ssi(_) => true,
        }
    }

    /// Samples that were taken and dropped before they were recorded.
    pub fn dropped(&self) -> u64 {
        each!(self, own => own.record.dropped())
    }

    /// This is the attempt to open its link that counts.
    pub(super) fn is_attempt(&self, attempt: u32) -> bool {
        each!(self, own => own.session.is_attempt(attempt))
    }

    /// It can be read again: also a device that did not answer, and a profile.
    pub fn is_readable(&self) -> bool {
        each!(self, own => own.session.is_readable())
    }

    /// A profile of it can be saved now.
    pub fn is_savable(&self) -> bool {
        match self {
            // A layout can be saved at any time.
            AnyDevice::Ssi(_) => true,
            _ => {
                let was_read = each_with_memory!(self, own => own.saves_what_was_read(), false);
                was_read || each!(self, own => own.session.is_savable())
            }
        }
    }

    /// The job that runs.
    pub fn running(&self) -> Option<Progressing> {
        each!(self, own => own.session.line().and_then(|line| line.progressing()))
    }

    /// There are edits that are not written.
    pub fn is_dirty(&self) -> bool {
        each!(self, own => own.is_dirty())
    }

    /// Edits that are not written.
    pub fn edits(&self) -> usize {
        each!(self, own => own.edits())
    }

    /// There is an edit to take back.
    pub fn can_undo(&self) -> bool {
        each!(self, own => own.can_undo())
    }

    /// There is an edit to do again.
    pub fn can_redo(&self) -> bool {
        each!(self, own => own.can_redo())
    }

    /// Backups, or why there are none; `None`: not asked for yet.
    pub fn backups(&self) -> Option<&Result<Vec<Backup>, Text>> {
        each!(self, own => own.session.backups.as_ref())
    }

    /// Writes of this device that the logbook knows, or why it does not tell; `None`: not asked for yet.
    pub fn writes(&self) -> Option<&Result<Vec<Entry>, Text>> {
        each!(self, own => own.session.writes.as_ref())
    }

    /// Status codes of this device that the logbook knows, the newest first.
    pub fn statuses(&self) -> &[StatusEntry] {
        each!(self, own => &own.session.statuses)
    }

    /// Its edits come back after it was closed.
    pub fn keeps_edits(&self) -> bool {
        each!(self, own => own.keeps_edits())
    }

    /// Every edit is on disk, as far as the disk takes it.
    pub fn is_draft_kept(&self) -> bool {
        each!(self, own => own.session.drafting.is_kept())
    }

    /// A review of a write is open.
    pub fn is_reviewing(&self) -> bool {
        each_with_memory!(self, own => own.review.is_some(), false)
    }

    /// The review of a write, where one is on its way.
    pub fn sheet(&self) -> Option<Sheet> {
        each_with_memory!(self, own => {
            let running = own.session.line().and_then(|line| line.running());
            let done = running.and_then(|running| running.progress.as_ref()).map_or(0, |progress| progress.done);
            own.sheet(usize::try_from(done).unwrap_or(usize::MAX))
        }, None)
    }

    pub(super) fn act_review(&mut self, action: ReviewAction, services: &mut Services) {
        each_with_memory!(self, own => match action {
            ReviewAction::Write(plan) => own.write(plan, services),
            ReviewAction::Toggle(permit) => own.plan_with(permit, services),
            ReviewAction::ForceWear(force) => own.force_wear(force),
            ReviewAction::Close => own.close_review(),
        }, ())
    }

    /// What was recorded of it.
    pub fn recorder(&self) -> &Recorder {
        each!(self, own => own.record.recorder())
    }

    pub(super) fn recorder_mut(&mut self) -> &mut Recorder {
        each!(self, own => own.record.recorder_mut())
    }

    /// Its recorders: the one of what is shown first.
    pub(super) fn recorders(&self) -> Vec<&Recorder> {
        match self.hiperdrive() {
            Some(unit) => unit.recorders().collect(),
            None => vec![self.recorder()],
        }
    }

    pub(super) fn recorders_mut(&mut self) -> Vec<&mut Recorder> {
        match self {
            AnyDevice::Hiperdrive(unit) => unit.recorders_mut().collect(),
            other => vec![other.recorder_mut()],
        }
    }

    /// There are minutes of a recording that no table has.
    pub(super) fn has_recorded_much(&self) -> bool {
        self.recorders().into_iter().any(|recorder| recorder.unsaved() >= MUCH)
    }

    pub(super) fn suggested_file(&self) -> PathBuf {
        each!(self, own => own.session.suggested_file())
    }

    /// Saves a profile.
    pub(super) fn save(&mut self, path: PathBuf, services: &mut Services) {
        each!(self, own => own.save(path, services))
    }

    pub(super) fn close_review(&mut self) {
        each_with_memory!(self, own => own.close_review(), ())
    }

    pub(super) fn pump(&mut self, services: &mut Services) {
        each!(self, own => own.pump(services))
    }

    pub(super) fn stop(&mut self, services: &mut Services) {
        match self {
            AnyDevice::Hiperdrive(own) => own.stop(services),
            _ => each!(self, own => own.session.stop(services)),
        }
    }

    pub(super) fn lose(&mut self, why: Text, services: &mut Services) {
        each!(self, own => own.lose(why, services))
    }

    pub(super) fn let_go(&mut self, end: JobEnd, services: &mut Services) {
        each!(self, own => own.let_go(end, services))
    }

    pub(super) fn keep_draft(&mut self, services: &mut Services) {
        each!(self, own => own.keep_draft(services))
    }

    pub(crate) fn leave_draft(&mut self, services: &mut Services) {
        each!(self, own => own.leave_draft(services))
    }

    pub(super) fn take_draft(&mut self, done: DraftDone, services: &mut Services) {
        each!(self, own => own.take_draft(done, services))
    }

    /// A profile was read again from its file; edits stay.
    pub(super) fn take_document(&mut self, file: ProfileFile, document: Document) {
        each!(self, own => own.take_document(file, document))
    }

    /// A save has come to a question: another one may begin.
    pub(super) fn save_waits(&mut self) {
        each!(self, own => own.session.is_saving = false)
    }

    /// All edits are taken back, as one step.
    pub(super) fn revert_edits(&mut self) {
        each!(self, own => own.revert_edits())
    }

    /// A profile was written, or not.
    pub(super) fn written(
        &mut self,
        saving: Saving,
        file: ProfileFile,
        result: Result<(), FileError>,
        services: &mut Services,
    ) {
        each!(self, own => own.written(saving, file, result, services))
    }

    /// Backups and writes were listed; those of another device than the one that is connected by now are dropped.
    pub(super) fn listed(&mut self, of: &DeviceKey, listed: Listed) {
        each_with_memory!(self, own => {
            if own.key().as_ref() == Some(of) {
                own.session.take_backups(listed);
            }
        }, ())
    }

    /// A backup was read, or not; one for another device than the one that is connected by now is dropped.
    pub(super) fn take_backup(
        &mut self,
        of: &DeviceKey,
        path: &std::path::Path,
        result: Result<Box<Document>, ReadError>,
        services: &mut Services,
    ) {
        each_with_memory!(self, own => {
            if own.key().as_ref() == Some(of) {
                own.take_backup(path, result, services);
            }
        }, ())
    }
}
