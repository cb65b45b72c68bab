//! An open INTERBUS encoder or profile, with its known values, edits and jobs.

use std::collections::{BTreeMap, VecDeque};

use super::preview::OutputComparison;
use super::record::Record;
use super::staged::{EditFinding, EditedValues, StagedEdits, ValueId};
use super::table::Import;
use super::trace::FrameDecoder;
use super::{cams, format};
use crate::analysis::check::CycleCount;
use crate::app::check::CheckResultLine;
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

/// Maximum number of handshake steps that are kept.
const STEPS: usize = 200;

pub struct Encoder {
    pub session: Session<Interbus>,
    pub survey: Option<Survey>,
    pub check: Option<Vec<CheckResultLine>>,
    pub staged: StagedEdits,
    pub read_outs: BTreeMap<u16, Value>,
    pub record: Record,
    /// Comparison of the encoder's outputs with its cam programs.
    pub preview: OutputComparison,
    /// Steps of recent handshakes in chronological order.
    pub handshake: VecDeque<Handshake>,
    pub motor: Option<Motor>,
    /// Cam table that has been read but not applied yet.
    pub import: Option<Import>,
    pub scale: Scale,
    /// Reason why the last edit was rejected.
    pub refusal: Option<Text>,
    /// Whether the user has confirmed that the machine is at standstill.
    stopped: bool,
    /// Program for rows of a table file that do not name one.
    pub(super) table_program: ProgramNumber,
    /// Programs that were written and must be read again.
    pub(super) read_after: Vec<ProgramNumber>,
    pub(super) trace: FrameDecoder,
}

impl Encoder {
    pub(super) fn from_session(session: Session<Interbus>, staged: StagedEdits) -> Self {
        Encoder {
            session,
            survey: None,
            check: None,
            staged,
            read_outs: BTreeMap::new(),
            record: Record::default(),
            preview: OutputComparison::default(),
            handshake: VecDeque::new(),
            motor: None,
            import: None,
            table_program: ProgramNumber::FIRST,
            scale: Scale::default(),
            refusal: None,
            stopped: false,
            read_after: Vec::new(),
            trace: FrameDecoder::new(WordOrder::default()),
        }
    }

    pub fn findings(&self) -> Vec<EditFinding> {
        self.staged.edited_values().map(EditedValues::findings).unwrap_or_default()
    }

    /// Returns the messages about edits that every page shows, with those about the given program first.
    pub fn visible_marks(&self, program: Option<ProgramNumber>) -> Vec<Text> {
        let mut marks: Vec<EditFinding> = self.findings();
        marks.sort_by_key(|mark| program.is_none() || mark.program() != program);
        truncated_list(&cams::labels::describe_findings(&marks), Text::clone)
    }

    pub fn profile(&self) -> Option<&InterbusProfile> {
        let Source::File { document, .. } = &self.session.source else { return None };
        document.body.get::<InterbusProfile>()
    }

    /// Returns the profile with the edits applied, or `None` for a connected encoder.
    pub(crate) fn edited_profile(&self) -> Option<InterbusProfile> {
        let (profile, wanted) = (self.profile()?, self.staged.edited_values()?);
        Some(InterbusProfile { image: wanted.image.clone(), names: wanted.names.clone(), ..profile.clone() })
    }

    pub fn identity(&self) -> Option<&Identity> {
        self.survey.as_ref().map(|survey| &survey.identity)
    }

    pub fn profile_identity(&self) -> Option<&ProfileIdentity> {
        self.profile().map(|profile| &profile.identity)
    }

    /// Returns the serial number, or `None` if it is unknown.
    pub fn serial_number(&self) -> Option<&str> {
        let profile = || self.profile_identity().map(|own| own.serial_number.as_str());
        self.identity().map(|own| own.serial_number.as_str()).or_else(profile)
    }

    pub fn mode(&self) -> Option<StartupMode> {
        let read = || self.identity().map(|own| own.mode);
        self.record.last().and_then(|reading| reading.mode).or_else(read)
    }

    /// Returns what is known about the encoder to interpret an IN word.
    pub fn word_context(&self) -> WordContext {
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

    /// Returns the latest position in steps, or `None` if the last word does not contain it.
    pub fn position(&self) -> Option<u32> {
        self.record.last().and_then(WordReading::position)
    }

    pub(super) fn word_order(&self) -> WordOrder {
        let Source::Link(url) = &self.session.source else { return WordOrder::default() };
        url.query.read("order", &WordOrder::KEYWORDS).ok().flatten().unwrap_or_default()
    }

    /// Returns whether the user has confirmed that the machine is at standstill. A virtual encoder needs no
    /// confirmation.
    pub fn is_stopped(&self) -> bool {
        self.stopped || self.session.is_virtual()
    }

    /// Returns whether the user must confirm that the machine is at standstill before the encoder may be disturbed.
    pub fn needs_standstill_confirmation(&self) -> bool {
        self.session.phase != Phase::Offline && !self.session.is_virtual()
    }

    pub(super) fn set_stopped(&mut self, stopped: bool) {
        self.stopped = stopped;
    }

    /// Returns the number of steps in the measuring range, as edited.
    pub fn step_count(&self) -> u32 {
        self.staged.edited_values().map_or(0, EditedValues::step_count)
    }

    pub fn read_out(&self, what: ReadOutNumber) -> Option<Value> {
        self.read_outs.get(&what.to_u16()).copied()
    }

    pub(super) fn known_programs(&self) -> Vec<ProgramNumber> {
        self.staged.device().map(|image| image.known_programs().map(|(number, _)| number).collect()).unwrap_or_default()
    }

    /// Returns the number of programs that have been read.
    pub fn known_program_count(&self) -> usize {
        self.staged.device().map_or(0, |image| image.known_programs().count())
    }

    /// Returns the number of EEPROM write cycles recorded on this computer. Those by other programs are not included.
    pub fn store_count(&self) -> Option<CycleCount> {
        self.session.cycles
    }

    pub fn has_parameter_edits(&self) -> bool {
        self.staged.differences().iter().any(|own| matches!(own.place, ValueId::Parameter(_)))
    }

    pub fn has_cam_edits(&self) -> bool {
        self.staged.differences().iter().any(|own| !matches!(own.place, ValueId::Parameter(_)))
    }

    pub fn is_dirty(&self) -> bool {
        self.staged.is_dirty()
    }

    /// Updates the encoder with the values just read. Edits are kept unless they belong to another encoder.
    pub(super) fn apply_survey(&mut self, survey: Survey, services: &mut Services) {
        self.session.last_read_time = Some(services.current_time().timestamp());
        if self.is_different_device(&survey.identity) {
            self.handle_device_replacement(&survey.identity.serial_number, services);
        }
        let first = self.survey.is_none();
        self.session.title = Some(title(&survey.identity));
        self.staged.refresh_parameters(survey.parameters);
        for (read_out, value) in survey.read_outs() {
            self.read_outs.insert(read_out.to_u16(), value);
        }
        self.survey = Some(survey);
        let mode = self.word_context().mode;
        self.trace.set_mode(mode);
        if first {
            self.load_draft(services);
            self.log_first_reply(services);
        }
        self.list_backups(services);
    }

    /// Returns whether the identity belongs to a different encoder than the last one read.
    pub(super) fn is_different_device(&self, identity: &Identity) -> bool {
        self.identity().is_some_and(|known| known.serial_number != identity.serial_number)
    }

    fn log_first_reply(&self, services: &mut Services) {
        let Some(identity) = self.identity() else { return };
        let fact = TEXTS
            .text("log.interbus")
            .with("serial", &identity.serial_number)
            .with("version", identity.software_version)
            .with_text("range", format::range_text(identity.steps, identity.revolutions));
        services.log_without_display(Severity::Note, vec![fact], Some(&self.session.name()));
    }

    pub(super) fn record_handshake_step(&mut self, step: Handshake) {
        self.handshake.push_back(step);
        let surplus = self.handshake.len().saturating_sub(STEPS);
        self.handshake.drain(..surplus);
    }
}

fn title(identity: &Identity) -> String {
    format!("K3 · {}", identity.serial_number)
}
