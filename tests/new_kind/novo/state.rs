//! The application state of a Novo encoder or of its profile.

use std::convert::Infallible;

use encoder_studio::app::session::{HasDraft, HasMemory, HasProfile, HasSession, Interruption, Session, SessionEvents};
use encoder_studio::app::track::{DeviceRecorder, PositionSample, PositionScales};
use encoder_studio::app::{
    ActionContext, Catalogue, DeviceAction, DeviceMemory, DeviceModel, EditBase, Edits, JobState, OpenedConnection,
    PendingEdits, Recording, Services, Tab, Text,
};
use encoder_studio::profile::Body;

use super::jobs::{Error, Job, JobError, Novo, Output, Sample};
use super::profile::NovoProfile;
use super::protocol::{ITEMS, TURN, Values};

pub(crate) static TEXTS: Catalogue = Catalogue::new(
    r#"{
    "novo.write": (en: "Write values", de: "Werte schreiben"),
    "novo.restore": (en: "Restore the values of {serial}", de: "Werte von {serial} wiederherstellen"),
    "novo.cost": (en: "Write cycles: {cycles}", de: "Schreibzyklen: {cycles}"),
    "novo.written": (en: "Values written and read back: {count}", de: "Werte geschrieben und zurückgelesen: {count}"),
    "novo.silent": (en: "The encoder does not answer.", de: "Der Geber antwortet nicht."),
    "novo.values": (en: "Values of the encoder", de: "Werte des Gebers"),
    "novo.link": (en: "Link", de: "Verbindung"),
}"#,
);

/// The actions that only this kind has.
pub(crate) enum Action {
    Set(usize, u16),
}

impl DeviceAction for Action {}

/// The profile read from the encoder or from a file.
#[derive(Clone, Default)]
pub(crate) struct Own(Option<NovoProfile>);

impl EditBase for Own {
    type Location = usize;
    type Value = u16;

    fn is_edit(&self, item: usize, value: u16) -> bool {
        self.0.as_ref().and_then(|own| own.values.get(item)).is_some_and(|own| *own != value)
    }
}

pub(crate) struct Encoder {
    pub(super) session: Session<Novo>,
    /// The edits by item number.
    pub(crate) staged: Edits<Own>,
    pub(crate) last: Option<Sample>,
    pub(super) track: DeviceRecorder<Infallible>,
}

impl Encoder {
    pub(super) fn with(session: Session<Novo>) -> Self {
        Encoder { session, staged: Edits::default(), last: None, track: DeviceRecorder::default() }
    }

    /// Returns the values including the edits, or `None` if the encoder has not been read.
    pub(crate) fn wanted(&self) -> Option<Values> {
        let mut values = self.read()?.values;
        self.staged.iter().for_each(|(item, value)| values[item] = value);
        Some(values)
    }
    pub(crate) fn read(&self) -> Option<&NovoProfile> {
        self.staged.base().0.as_ref()
    }
    pub(super) fn take(&mut self, read: NovoProfile) {
        self.staged.update_base(|own| own.0 = Some(read));
    }
    fn see(&mut self, samples: &[Sample], dropped: u64) {
        let sighting = |(at, position): &Sample| PositionSample {
            at: *at,
            position: Some(i64::from(*position)),
            is_bad: false,
            is_warned: false,
        };
        self.track.record_dropped(dropped);
        self.track.add_positions(
            &samples.iter().map(sighting).collect::<Vec<_>>(),
            &PositionScales::for_steps_per_turn(Some(65536), TURN.into()),
        );
        self.last = samples.last().copied().or(self.last);
    }
    fn surveyed(&mut self, read: NovoProfile, services: &mut Services) {
        if self.read().is_some_and(|own| own.serial != read.serial) {
            self.handle_device_replacement(&read.serial.to_string(), services);
        }
        let is_first = self.read().is_none();
        self.session.title = Some(format!("Novo · {}", read.serial));
        if std::mem::take(&mut self.session.just_connected) {
            self.session.log_first_reply(Vec::new(), services);
        }
        self.take(read.clone());
        if is_first {
            self.load_draft(services);
        }
        let edits = self.staged.is_dirty().then(|| self.staged.count());
        let device = self.device_key();
        self.session.save_read_values(device, Body::new(read), edits, Vec::new(), services);
        self.list_backups(services);
    }
}

impl HasSession for Encoder {
    type Device = Novo;

    fn session(&self) -> &Session<Novo> {
        &self.session
    }
    fn session_mut(&mut self) -> &mut Session<Novo> {
        &mut self.session
    }
}

impl SessionEvents for Encoder {
    fn handle_samples(&mut self, samples: Vec<Sample>, dropped: u64) {
        self.see(&samples, dropped);
    }
    fn message_received(&mut self, remark: Infallible, _: &mut Services) {
        match remark {}
    }
    fn handle_finished_job(&mut self, output: Output, services: &mut Services) {
        match output {
            Output::Surveyed(read) => self.surveyed(read, services),
            Output::Position(sample) => self.see(&[sample], 0),
            Output::Prepared(prepared) => self.adopt_plan(prepared, services),
            Output::Committed(committed) => self.handle_commit_end(*committed, services),
        }
    }
    fn is_no_response(&self, error: &JobError) -> bool {
        error.device() == Some(&Error::Silent)
    }
    fn discard_requests(&mut self) {
        self.discard_plan();
    }
    fn handle_interruption(&mut self, how: Interruption<'_, JobError>, texts: &[Text], _: &mut Services) -> bool {
        self.handle_interrupted_write(how, texts)
    }
}

impl DeviceModel for Encoder {
    const TAB: Tab = Tab::named("Novo");
    type Action = Action;
    type TaskResult = Infallible;

    fn accepts_item(&self, item: &str) -> bool {
        ITEMS.contains(&item)
    }
    fn take_item(&mut self, item: &str, from: &Body) -> Result<(), Text> {
        let item = ITEMS.iter().position(|own| *own == item);
        let value = item.and_then(|item| Some((item, from.get::<NovoProfile>()?.values[item])));
        self.staged.edit_values(value);
        value.map(drop).ok_or_else(|| Text::new("comparison.not_taken"))
    }

    fn connect(&mut self, opened: OpenedConnection<Novo>, services: &mut Services) {
        self.release_thread(JobState::Cancelled, services);
        self.track.begin_session(&opened.began);
        self.session.attach_connection(opened, services);
        self.submit(Job::Survey, services);
    }
    fn handle_action(&mut self, Action::Set(item, value): Action, _: &mut ActionContext<'_>) {
        self.staged.edit_values([(item, value)]);
    }
    fn handle_result(&mut self, done: Infallible, _: &mut Services) {
        match done {}
    }
    fn position_job(&self) -> Job {
        Job::Position
    }
    fn recording(&self) -> &dyn Recording {
        &self.track
    }
    fn record_mut(&mut self) -> &mut dyn Recording {
        &mut self.track
    }
    fn memory(&self) -> Option<&dyn DeviceMemory> {
        Some(self)
    }
    fn memory_mut(&mut self) -> Result<&mut dyn DeviceMemory, Text> {
        Ok(self)
    }
}
