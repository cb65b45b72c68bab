//! An open INTERBUS encoder or a profile of one: known data, edits and running jobs.

use std::collections::{BTreeMap, VecDeque};

use super::preview::Preview;
use super::record::Record;
use super::staged::{EditedValues, Mark, Staged, ValueId};
use super::table::Import;
use super::trace::Meaning;
use super::{cams, words};
use crate::app::check::CheckLine;
use crate::app::services::Services;
use crate::app::session::{HasDraft, HasMemory, HasProfile, Phase, Session, Source, truncated_list};
use crate::app::{PendingEdits, Severity, Text};
use crate::devices::interbus::jobs::Interbus;
use crate::devices::interbus::procedures::{Handshake, Identity, Survey, WordReading};
use crate::devices::interbus::profile::{InterbusProfile, ProfileIdentity, Scale};
use crate::devices::interbus::protocol::{
    EncoderMode, ProgramNumber, ReadOutNumber, StartupMode, Value, WindowShift, WordOrder,
};
use crate::devices::interbus::state::TEXTS;
use crate::sim::Motor;

use super::word_meaning::WordContext;

/// Maximum number of handshake steps shown.
const STEPS: usize = 200;

pub struct Encoder {
    pub session: Session<Interbus>,
    pub survey: Option<Survey>,
    pub check: Option<Vec<CheckLine>>,
    pub staged: Staged,
    pub read_outs: BTreeMap<u16, Value>,
    pub record: Record,
    /// Comparison of the reported cam outputs with those of the cam programs.
    pub preview: Preview,
    /// Words of the last handshakes, newest last.
    pub handshake: VecDeque<Handshake>,
    pub motor: Option<Motor>,
    /// Cam table that was read but has not been applied yet.
    pub import: Option<Import>,
    pub scale: Scale,
    /// Reason why the last edit was refused.
    pub refusal: Option<Text>,
    /// Whether the user has confirmed that the machine stands still.
    stopped: bool,
    /// Program for the rows of a table being opened that do not specify one.
    pub(super) table_program: ProgramNumber,
    /// Programs that were written and must be read again.
    pub(super) read_after: Vec<ProgramNumber>,
    pub(super) trace: Meaning,
}

impl Encoder {
    pub(super) fn with(session: Session<Interbus>, staged: Staged) -> Self {
        Encoder {
            session,
            survey: None,
            check: None,
            staged,
            read_outs: BTreeMap::new(),
            record: Record::default(),
            preview: Preview::default(),
            handshake: VecDeque::new(),
            motor: None,
            import: None,
            table_program: ProgramNumber::FIRST,
            scale: Scale::default(),
            refusal: None,
            stopped: false,
            read_after: Vec::new(),
            trace: Meaning::new(WordOrder::default()),
        }
    }

    pub fn marks(&self) -> Vec<Mark> {
        self.staged.wanted().map(EditedValues::marks).unwrap_or_default()
    }

    /// Returns the marks to show on every page, with those of the given program first.
    pub fn visible_marks(&self, program: Option<ProgramNumber>) -> Vec<Text> {
        let mut marks: Vec<Mark> = self.marks();
        marks.sort_by_key(|mark| program.is_none() || mark.program() != program);
        truncated_list(&cams::words::marks(&marks), Text::clone)
    }

    pub fn profile(&self) -> Option<&InterbusProfile> {
        let Source::File { document, .. } = &self.session.source else { return None };
        document.body.get::<InterbusProfile>()
    }

    /// Returns the profile with its edits applied, or `None` for a connected encoder.
    pub(crate) fn wanted_profile(&self) -> Option<InterbusProfile> {
        let (profile, wanted) = (self.profile()?, self.staged.wanted()?);
        Some(InterbusProfile { image: wanted.image.clone(), names: wanted.names.clone(), ..profile.clone() })
    }

    pub fn identity(&self) -> Option<&Identity> {
        self.survey.as_ref().map(|survey| &survey.identity)
    }

    pub fn profile_identity(&self) -> Option<&ProfileIdentity> {
        self.profile().map(|profile| &profile.identity)
    }

    /// Returns the serial number, or `None` if nothing has been read.
    pub fn serial_number(&self) -> Option<&str> {
        let profile = || self.profile_identity().map(|own| own.serial_number.as_str());
        self.identity().map(|own| own.serial_number.as_str()).or_else(profile)
    }

    pub fn mode(&self) -> Option<StartupMode> {
        let read = || self.identity().map(|own| own.mode);
        self.record.last().and_then(|reading| reading.mode).or_else(read)
    }

    /// Returns the context needed to decode IN words.
    pub fn known(&self) -> WordContext {
        let mode = match self.mode() {
            Some(StartupMode::Velocity) => EncoderMode::Velocity,
            Some(StartupMode::Cams(_)) => EncoderMode::Cam,
            _ => EncoderMode::Position,
        };
        WordContext { mode, read_out: None, shift: self.shift() }
    }

    pub fn shift(&self) -> Option<WindowShift> {
        self.staged.device().and_then(|image| image.shift)
    }

    /// Returns the latest position in steps, or `None` if the last word does not contain one.
    pub fn position(&self) -> Option<u32> {
        self.record.last().and_then(WordReading::position)
    }

    pub(super) fn word_order(&self) -> WordOrder {
        let Source::Link(url) = &self.session.source else { return WordOrder::default() };
        url.query.read("order", &WordOrder::WORDS).ok().flatten().unwrap_or_default()
    }

    /// Returns whether the user has confirmed that the machine stands still. A virtual encoder moves no machine and
    /// needs no confirmation.
    pub fn is_stopped(&self) -> bool {
        self.stopped || self.session.is_virtual()
    }

    /// Returns whether the user must confirm that the machine stands still before continuing.
    pub fn needs_standstill(&self) -> bool {
        self.session.phase != Phase::Offline && !self.session.is_virtual()
    }

    pub(super) fn set_stopped(&mut self, stopped: bool) {
        self.stopped = stopped;
    }

    /// Returns the number of steps in the measuring range, including edits.
    pub fn range(&self) -> u32 {
        self.staged.wanted().map_or(0, EditedValues::range)
    }

    pub fn read_out(&self, what: ReadOutNumber) -> Option<Value> {
        self.read_outs.get(&what.number()).copied()
    }

    pub(super) fn known_programs(&self) -> Vec<ProgramNumber> {
        self.staged.device().map(|image| image.known().map(|(number, _)| number).collect()).unwrap_or_default()
    }

    /// Returns how many of the eight programs have been read.
    pub fn known_program_count(&self) -> usize {
        self.staged.device().map_or(0, |image| image.known().count())
    }

    /// Returns the memory's write cycle count as recorded on this computer, excluding stores that cannot be counted.
    pub fn stores(&self) -> Option<u64> {
        self.session.cycles
    }

    pub fn edits_parameters(&self) -> bool {
        self.staged.differences().iter().any(|own| matches!(own.place, ValueId::Parameter(_)))
    }

    pub fn edits_cams(&self) -> bool {
        self.staged.differences().iter().any(|own| !matches!(own.place, ValueId::Parameter(_)))
    }

    pub fn is_dirty(&self) -> bool {
        self.staged.is_dirty()
    }

    /// Adopts the results of a survey. Edits are kept unless they belong to another encoder.
    pub(super) fn apply_survey(&mut self, survey: Survey, services: &mut Services) {
        if self.is_different_device(&survey.identity) {
            self.handle_device_replacement(&survey.identity.serial_number, services);
        }
        let first = self.survey.is_none();
        self.session.title = Some(title(&survey.identity));
        self.staged.refresh_parameters(survey.parameters);
        for (read_out, value) in survey.read_outs() {
            self.read_outs.insert(read_out.number(), value);
        }
        self.survey = Some(survey);
        let mode = self.known().mode;
        self.trace.found(mode);
        if first {
            self.load_draft(services);
            self.log_answer(services);
        }
        self.list_backups(services);
    }

    /// Returns whether the identity belongs to an encoder other than the one last read.
    pub(super) fn is_different_device(&self, identity: &Identity) -> bool {
        self.identity().is_some_and(|known| known.serial_number != identity.serial_number)
    }

    fn log_answer(&self, services: &mut Services) {
        let Some(identity) = self.identity() else { return };
        let fact = TEXTS
            .text("log.interbus")
            .with("serial", &identity.serial_number)
            .with("version", identity.software_version)
            .with_text("range", words::range(identity.steps, identity.revolutions));
        services.note(Severity::Note, vec![fact], Some(&self.session.name()));
    }

    pub(super) fn show_handshake_step(&mut self, step: Handshake) {
        self.handshake.push_back(step);
        let surplus = self.handshake.len().saturating_sub(STEPS);
        self.handshake.drain(..surplus);
    }
}

fn title(identity: &Identity) -> String {
    format!("K3 · {}", identity.serial_number)
}
