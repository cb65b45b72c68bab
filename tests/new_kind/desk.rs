//! The program with the test kind, in the test environment.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use encoder_studio::app::review::Stage;
use encoder_studio::app::{
    Action as StudioAction, AnyDevice, DeviceCommand, ReviewAction, Severity, Studio, StudioEnvironment,
};
use encoder_studio::kinds::{KINDS, Program};
use encoder_studio::store::Store;

use super::novo::NOVO;
use super::novo::state::{Action, Encoder};

/// Returns the program with the test kind added to its own kinds.
pub(crate) fn program() -> Program {
    static PROGRAM: OnceLock<Program> = OnceLock::new();
    *PROGRAM.get_or_init(|| Program::new(&[KINDS, &[NOVO]].concat(), &[], &[], &[]))
}

pub(crate) struct Desk {
    pub(crate) studio: Studio,
    pub(crate) folder: tempfile::TempDir,
}

impl Desk {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let world = StudioEnvironment {
            ports: Arc::new(|| Ok(vec![])),
            ..StudioEnvironment::production(Store::at_root(folder.path()), program().studio)
        };
        Desk { studio: Studio::new(world, Arc::new(|| ())), folder }
    }

    /// Connects to the virtual encoder and reads it.
    pub(crate) fn connected(query: &str) -> Self {
        let mut desk = Desk::new();
        desk.open(query);
        desk
    }

    pub(crate) fn open(&mut self, query: &str) {
        use encoder_studio::app::DeviceModel;
        self.studio.handle_action(StudioAction::ShowTab(Encoder::TAB));
        self.studio.start_with(Some(format!("sim:{query}").parse().unwrap()), None);
        self.until_ready();
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn shown(&self) -> &AnyDevice {
        self.studio.selected_device().unwrap()
    }

    pub(crate) fn encoder(&self) -> &Encoder {
        self.studio.selected_model().unwrap()
    }

    pub(crate) fn notice_ids(&self, least: Severity) -> Vec<&'static str> {
        let notices = self.studio.services.log.notices().filter(|notice| notice.severity >= least);
        notices.flat_map(|notice| notice.texts.iter().map(encoder_studio::app::Text::id)).collect()
    }

    #[track_caller]
    pub(crate) fn until(&mut self, what: &str, condition: impl Fn(&Desk) -> bool) {
        let began = Instant::now();
        loop {
            self.studio.poll();
            if condition(self) {
                return;
            }
            assert!(began.elapsed() < Duration::from_secs(20), "never: {what}; {:?}", self.notice_ids(Severity::Note));
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[track_caller]
    pub(crate) fn until_ready(&mut self) {
        self.until("it is read", |desk| desk.shown().is_ready() && desk.shown().backups().is_some());
    }

    pub(crate) fn command(&mut self, command: DeviceCommand) {
        let action = self.shown().command(command);
        self.studio.handle_action(action);
    }

    pub(crate) fn set(&mut self, item: usize, value: u16) {
        let id = self.shown().id();
        self.studio.handle_action(StudioAction::device(id, Action::Set(item, value)));
    }

    pub(crate) fn review(&mut self, action: ReviewAction) {
        let id = self.shown().id();
        self.studio.handle_action(StudioAction::Review(id, action));
    }

    #[track_caller]
    pub(crate) fn until_stage(&mut self, wanted: impl Fn(&Stage) -> bool) -> Stage {
        let found = |desk: &Desk| desk.shown().review_sheet().map(|sheet| sheet.stage).filter(&wanted);
        self.until("the review is there", |desk| found(desk).is_some() && desk.shown().is_ready());
        found(self).unwrap()
    }

    /// Writes the reviewed plan and returns the final stage of the review.
    #[track_caller]
    pub(crate) fn write(&mut self) -> Stage {
        let Stage::Ready(plan) = self.until_stage(|stage| matches!(stage, Stage::Ready(_))) else { panic!("no plan") };
        self.review(ReviewAction::Write(plan));
        self.until_stage(|stage| matches!(stage, Stage::Done { .. }))
    }
}
