//! An open BiSS encoder or encoder profile: its known data, the user's edits, and the running jobs.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::guide::ProcedureRun;
use super::meaning::FrameDecoder;
use super::memory::Memory;
use super::record::{FrameStream, Record};
use super::table::Table;
use crate::app::check::CheckResultLine;
use crate::app::services::Services;
use crate::app::session::{HasDraft, HasMemory, HasProfile, Session, Source};
use crate::app::{PendingEdits, Text};
use crate::devices::biss::jobs::Biss;
use crate::devices::biss::procedures::{EncoderStatus, Identity, Survey};
use crate::devices::biss::profile::{BissProfile, ProfileIdentity};
use crate::devices::biss::protocol::{Description, DeviceMode, Eds, EdsBank, EdsError};
use crate::devices::biss::state::explain;
use crate::sim::Motor;

pub struct Encoder {
    pub session: Session<Biss>,
    pub survey: Option<Survey>,
    pub status: Option<EncoderStatus>,
    pub check: Option<Vec<CheckResultLine>>,
    pub description: Option<Arc<Description>>,
    pub memory: Memory,
    pub table: Table,
    pub record: Record,
    /// The running guided procedure, or the last one with its result.
    pub guide: Option<ProcedureRun>,
    /// Why the last request for data was rejected, if it was rejected.
    pub refusal: Option<Text>,
    pub motor: Option<Motor>,
    pub(super) meaning: FrameDecoder,
    /// Banks that have been read when they became visible, or that could not be read. They are not read automatically
    /// again.
    pub(super) seen: BTreeSet<Option<u8>>,
    /// Banks that were written and must be read back.
    pub(super) read_after: BTreeSet<u8>,
}

impl Encoder {
    pub(super) fn from_session(session: Session<Biss>) -> Self {
        Encoder {
            session,
            survey: None,
            status: None,
            check: None,
            description: None,
            memory: Memory::default(),
            table: Table::default(),
            record: Record::default(),
            guide: None,
            refusal: None,
            motor: None,
            meaning: FrameDecoder::default(),
            seen: BTreeSet::new(),
            read_after: BTreeSet::new(),
        }
    }

    pub(super) fn set_description(&mut self, description: Option<Arc<Description>>) {
        let sheet = self.survey.as_ref().and_then(|survey| survey.identity.data_sheet.as_ref());
        let last = sheet.and_then(|sheet| sheet.common.eds.as_ref().ok()).and_then(Eds::last_user_bank);
        self.table = description.as_ref().map(|own| Table::from_description(own, last)).unwrap_or_default();
        self.description = description;
    }

    pub(super) fn load_profile(&mut self, profile: &BissProfile) {
        let sheets = profile.recorded.eds.iter().map(|listed| listed.bank);
        for bank in profile.banks().chain(sheets) {
            bank.registers().for_each(|(at, byte)| self.memory.store_bytes(at, &[byte]));
        }
    }

    pub fn profile(&self) -> Option<&BissProfile> {
        let Source::File { document, .. } = &self.session.source else { return None };
        document.body.get::<BissProfile>()
    }

    /// Returns the profile with its edits, or `None` if this is an encoder.
    pub(crate) fn edited_profile(&self) -> Option<BissProfile> {
        let mut profile = self.profile()?.clone();
        self.add_edits_to_profile(&mut profile);
        Some(profile)
    }

    /// Applies the edits to a profile.
    pub(super) fn add_edits_to_profile(&self, profile: &mut BissProfile) {
        for (at, byte) in self.memory.iter() {
            profile.set_register(at, byte);
        }
    }

    pub fn identity(&self) -> Option<&Identity> {
        self.survey.as_ref().map(|survey| &survey.identity)
    }

    /// Returns the data sheet from the encoder or the profile, with the common bank first.
    pub fn data_sheet(&self) -> Option<[Result<Eds, EdsError>; 2]> {
        if let Some(identity) = self.identity() {
            return identity.data_sheet.as_ref().map(|sheet| [sheet.common.eds, sheet.encoder.eds]);
        }
        let banks = &self.profile()?.recorded.eds;
        let parsed = |bank: EdsBank| {
            let listed = banks.iter().find(|listed| listed.bank.number == bank.kit_number())?;
            Some(Eds::parse(bank, listed.bank.bytes))
        };
        Some([parsed(EdsBank::Common)?, parsed(EdsBank::Encoder)?])
    }

    /// Returns the stream that an adapter is sending, or `None` if no adapter is streaming.
    pub fn active_stream(&self) -> Option<&FrameStream> {
        self.record.current_stream().filter(|_| self.session.is_polling())
    }

    pub fn profile_identity(&self) -> Option<&ProfileIdentity> {
        self.profile().map(|profile| &profile.identity)
    }

    /// Returns the serial number, which is empty if the encoder has none, or `None` if the encoder has not been read.
    pub fn serial_number(&self) -> Option<&str> {
        let profile = || self.profile_identity().map(|own| own.serial_number.as_str());
        self.identity().map(|own| own.serial_number.as_str()).or_else(profile)
    }

    pub fn is_dirty(&self) -> bool {
        self.memory.is_dirty()
    }

    /// Applies the values read from the encoder. Edits are kept unless it is a different encoder.
    pub(super) fn apply_survey(&mut self, survey: Survey, services: &mut Services) {
        self.session.last_read_time = Some(services.current_time().timestamp());
        let fresh = std::mem::take(&mut self.session.just_connected);
        // Without a serial number, this may be any encoder of the same type.
        let unproven = fresh && self.survey.is_some() && survey.identity.serial_number.is_empty();
        if unproven || self.is_different_device(&survey.identity) {
            self.handle_device_replacement(&survey.identity.serial_number, services);
        }
        let first = self.survey.is_none();
        let Survey { identity, status, registers, .. } = &survey;
        self.session.title = Some(title(identity));
        self.status = Some(status.clone());
        if let Some(position) = status.position {
            self.record.add_position(position);
        }
        for (at, byte) in registers.iter() {
            self.memory.store_bytes(at, &[byte]);
        }
        let description = identity.description.clone();
        self.survey = Some(survey);
        self.set_description(Some(description));
        if first {
            self.load_draft(services);
        }
        if fresh {
            self.log_first_reply(services);
        }
        self.list_backups(services);
    }

    /// Stores the device mode in which registers were just read, or `None` for operation mode.
    pub(super) fn set_device_mode(&mut self, unsaved: Option<DeviceMode>) {
        if let Some(mode) = self.status.as_mut().and_then(|status| status.mode.as_mut()) {
            *mode = unsaved.unwrap_or(DeviceMode::OPERATION);
        }
    }

    /// Returns a message if registers may show values that were never saved. This is the case if the encoder is in a
    /// device mode, or was when the profile was read.
    pub fn unsaved_warning(&self) -> Option<Text> {
        if let Some(profile) = self.profile() {
            return explain::profile_unsaved(profile);
        }
        let mode = self.status.as_ref()?.mode.filter(|mode| *mode != DeviceMode::OPERATION)?;
        Some(explain::unsaved_warning(mode))
    }

    /// Returns whether the identity differs from the one that was read before.
    pub(super) fn is_different_device(&self, identity: &Identity) -> bool {
        let who = |identity: &Identity| (identity.kind.clone(), identity.serial_number.clone());
        self.identity().is_some_and(|known| who(known) != who(identity))
    }
}

/// Returns the name used for an encoder in the log and in jobs.
fn title(identity: &Identity) -> String {
    let name = identity.description.name();
    if identity.serial_number.is_empty() { name.to_owned() } else { format!("{name} · {}", identity.serial_number) }
}
