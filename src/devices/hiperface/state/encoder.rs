//! An open encoder or an open profile, with its edits and running jobs.

use std::collections::BTreeMap;

use super::commutation::Commutation;
use super::meaning::FrameDecoder;
use super::record::Record;
use super::rest::RestReadingRequest;
use super::{StagedEdits, rules};
use crate::app::services::Services;
use crate::app::session::{HasDraft, HasMemory, HasProfile, Session, Source};
use crate::app::{PendingEdits, Severity, Text, explain};
use crate::devices::hiperface::jobs::Hiperface;
use crate::devices::hiperface::procedures::{Identity, LineQuality, PolledSample, Survey, UnreadableField, check};
use crate::devices::hiperface::profile::{FieldImage, HiperfaceProfile, Item};
use crate::devices::hiperface::protocol::{AccessCode, AccessCodeNumber, LineSettings, StatusCode};
use crate::devices::hiperface::state::TEXTS;
use crate::devices::hiperface::state::explain as words;

pub struct Encoder {
    pub session: Session<Hiperface>,
    pub identity: Option<Identity>,
    pub staged: StagedEdits,
    /// Status codes that the encoder has reported, or `None` if they were never read.
    pub codes: Option<Vec<StatusCode>>,
    /// Reasons why data fields could not be read, by field number. Fields with an unknown access code are not included.
    pub unreadable: BTreeMap<u8, Text>,
    pub line_quality: LineQuality,
    pub check: Option<Vec<check::HiperfaceStepResult>>,
    pub counter: Option<u32>,
    /// Previous and new position, if this program has set the position.
    pub position_set: Option<(u32, u32)>,
    /// Last analogue value of each channel with its limit, or the reason why the encoder has no value for the channel.
    pub analogue: BTreeMap<u8, Result<(i16, Option<i16>), Text>>,
    pub record: Record,
    pub commutation: Commutation,
    pub(super) rest: RestReadingRequest,
    pub(super) meaning: FrameDecoder,
    /// Access codes that the user has entered or changed. The next session with this encoder starts with them.
    pub(super) access_codes: Vec<(AccessCodeNumber, AccessCode)>,
    pub(super) asked: Option<Item>,
    /// Access codes that are passed to the session again once the encoder is identified.
    pub(super) pending_codes: Vec<(AccessCodeNumber, AccessCode)>,
    /// Interface settings of the encoder after the running job.
    pub(super) settings_after_job: Option<LineSettings>,
    /// Number of the access code that the user entered last. The next survey shows whether this code is correct.
    pub(super) tried_code: Option<AccessCodeNumber>,
}

impl Encoder {
    pub(super) fn from_session(session: Session<Hiperface>) -> Self {
        Encoder {
            session,
            identity: None,
            staged: StagedEdits::default(),
            codes: None,
            unreadable: BTreeMap::new(),
            line_quality: LineQuality::default(),
            check: None,
            counter: None,
            position_set: None,
            analogue: BTreeMap::new(),
            record: Record::default(),
            commutation: Commutation::default(),
            rest: RestReadingRequest::default(),
            meaning: FrameDecoder::default(),
            access_codes: Vec::new(),
            asked: None,
            pending_codes: Vec::new(),
            settings_after_job: None,
            tried_code: None,
        }
    }

    pub(super) fn identify(&mut self, identity: Identity) {
        let serial = &identity.serial.serial_number;
        self.session.title =
            Some(if serial.is_empty() { identity.name.clone() } else { format!("{} · {serial}", identity.name) });
        self.identity = Some(identity);
    }

    fn log_first_reply(&self, services: &mut Services) {
        let Some(identity) = &self.identity else { return };
        let (label, firmware) = (&identity.label, identity.serial.firmware_version.trim());
        let firmware =
            if firmware.is_empty() { Text::new("encoder_card.not_told") } else { explain::literal_text(firmware) };
        let line = TEXTS.text("log.line").with("address", format!("{:02X}h", identity.address));
        let kind = TEXTS.text("log.type").with("type", format!("{:02X}h", label.encoder_type));
        let facts = vec![
            line.with_text("settings", words::line_settings(label.settings)),
            kind.with_text("firmware", firmware),
        ];
        self.session.log_first_reply(facts, services);
    }

    /// Returns whether there are edits that have not been written.
    pub fn is_dirty(&self) -> bool {
        self.staged.is_dirty()
    }

    pub fn field(&self, number: u8) -> Option<&FieldImage> {
        self.staged.device().iter().find(|field| field.number == number)
    }

    /// Returns the profile with all edits, or `None` if the session has no profile.
    pub(crate) fn edited_profile(&self) -> Option<HiperfaceProfile> {
        let Source::File { document, .. } = &self.session.source else { return None };
        let mut profile = document.body.get::<HiperfaceProfile>()?.clone();
        profile.fields = self.staged.edited_fields();
        // The edited bytes may also contain a commutation offset.
        profile.mark_mounting_dependent_values();
        Some(profile)
    }

    /// Takes over the values read from the encoder. Edits are kept unless they belong to another encoder.
    pub(super) fn apply_survey(&mut self, survey: Survey, services: &mut Services) {
        self.session.last_read_time = Some(services.current_time().timestamp());
        let Survey { identity, codes, fields, unreadable, line, counter, position } = survey;
        let fresh = std::mem::take(&mut self.session.just_connected);
        // Without a serial number, this may be any encoder of the type. It is considered the same encoder if its memory
        // is unchanged.
        let unproven = fresh && identity.serial.serial_number.is_empty() && fields != self.staged.device();
        if self.is_different_device(&identity) || (self.identity.is_some() && unproven) {
            self.handle_device_replacement(&identity.serial.serial_number, services);
        }
        let first = self.identity.is_none();
        self.identify(identity);
        self.staged.refresh(fields);
        self.counter = counter;
        self.codes = Some(codes);
        self.line_quality = line;
        self.record_unreadable_fields(&unreadable, services);
        if let Some(position) = position {
            self.add_samples(vec![position], 0);
        }
        if first {
            self.load_draft(services);
        }
        if fresh {
            self.log_first_reply(services);
        }
        self.report_code_result(services);
        self.list_backups(services);
    }

    fn record_unreadable_fields(&mut self, fields: &[UnreadableField], services: &mut Services) {
        let why = |own: &UnreadableField| {
            let text = Text::new("session.field_unreadable").with("field", own.number);
            text.with_text("why", words::encoder_error_text(&own.why))
        };
        let before = std::mem::take(&mut self.unreadable);
        self.unreadable = fields.iter().map(|own| (own.number, why(own))).collect();
        if !self.unreadable.is_empty() && self.unreadable != before {
            let texts = self.unreadable.values().cloned().collect();
            services.notify(Severity::Warning, texts, Some(&self.session.name()));
        }
    }

    /// Returns the reason why a field cannot be edited, or `None` if it can be edited.
    pub fn edit_lock_reason(&self, field: &FieldImage) -> Option<Text> {
        self.unreadable.get(&field.number).cloned().or_else(|| rules::check_edit(field).err())
    }

    pub(super) fn add_samples(&mut self, samples: Vec<PolledSample>, dropped: u64) {
        let geometry = self.identity.as_ref().and_then(|identity| identity.geometry);
        self.record.add_samples(samples, dropped, geometry);
    }

    /// Reports whether the last entered access code unlocks its fields. The message does not contain the code.
    fn report_code_result(&mut self, services: &mut Services) {
        let Some(number) = self.tried_code.take() else { return };
        let own = |field: &&FieldImage| field.status.code() == number && field.status.code_required();
        let fields: Vec<&FieldImage> = self.staged.device().iter().filter(own).collect();
        let shut: Vec<String> =
            fields.iter().filter(|field| field.bytes.is_none()).map(|field| field.number.to_string()).collect();
        let (severity, text) = match (fields.is_empty(), shut.is_empty()) {
            (true, _) => (Severity::Note, Text::new("session.code_unused")),
            (false, true) => (Severity::Good, Text::new("session.code_fits")),
            (false, false) => (Severity::Warning, Text::new("session.code_wrong").with("fields", shut.join(", "))),
        };
        if severity == Severity::Warning {
            self.access_codes.retain(|(own, _)| *own != number);
        }
        services.notify(severity, vec![text.with("number", number)], Some(&self.session.name()));
    }

    /// Returns whether the type or the serial number shows that this is a different encoder.
    pub(super) fn is_different_device(&self, identity: &Identity) -> bool {
        let who = |identity: &Identity| (identity.label.encoder_type, identity.serial.serial_number.clone());
        self.identity.as_ref().is_some_and(|known| who(known) != who(identity))
    }
}
