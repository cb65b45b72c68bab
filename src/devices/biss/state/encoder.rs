//! An open BiSS encoder, or a profile of one: its known data, the user's edits, and the running jobs.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::guide::Guide;
use super::meaning::Meaning;
use super::memory::Memory;
use super::record::{Record, Streamed};
use super::table::Table;
use crate::app::check::CheckLine;
use crate::app::services::Services;
use crate::app::session::{Drafted, Saved, Session, Source, WithMemory};
use crate::app::{PendingEdits, Text};
use crate::devices::biss::jobs::Biss;
use crate::devices::biss::procedures::{Identity, Status, Survey};
use crate::devices::biss::profile::{BissProfile, ProfileIdentity};
use crate::devices::biss::protocol::{Description, DeviceMode, Eds, EdsBank, EdsError};
use crate::devices::biss::state::explain as words;
use crate::sim::Motor;

/// A BiSS encoder, or a profile of one.
pub struct Encoder {
    pub session: Session<Biss>,
    pub survey: Option<Survey>,
    /// The status as last read.
    pub status: Option<Status>,
    /// The last device check.
    pub check: Option<Vec<CheckLine>>,
    pub description: Option<Arc<Description>>,
    pub memory: Memory,
    /// Its registers as a table.
    pub table: Table,
    pub record: Record,
    /// The running procedure, or the last one with its end.
    pub guide: Option<Guide>,
    /// Why the last request for data was refused.
    pub refusal: Option<Text>,
    pub motor: Option<Motor>,
    pub(super) meaning: Meaning,
    /// Banks read because they became visible, or that could not be read: they are not requested automatically again.
    pub(super) seen: BTreeSet<Option<u8>>,
    /// Banks that were written, to be read again.
    pub(super) read_after: BTreeSet<u8>,
}

impl Encoder {
    pub(super) fn with(session: Session<Biss>) -> Self {
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
            meaning: Meaning::default(),
            seen: BTreeSet::new(),
            read_after: BTreeSet::new(),
        }
    }

    pub(super) fn describe(&mut self, description: Option<Arc<Description>>) {
        let sheet = self.survey.as_ref().and_then(|survey| survey.identity.data_sheet.as_ref());
        let last = sheet.and_then(|sheet| sheet.common.eds.as_ref().ok()).and_then(Eds::last_user_bank);
        self.table = description.as_ref().map(|own| Table::of(own, last)).unwrap_or_default();
        self.description = description;
    }

    pub(super) fn take_profile(&mut self, profile: &BissProfile) {
        let sheets = profile.recorded.eds.iter().map(|listed| listed.bank);
        for bank in profile.banks().chain(sheets) {
            bank.registers().for_each(|(at, byte)| self.memory.take(at, &[byte]));
        }
    }

    pub fn profile(&self) -> Option<&BissProfile> {
        let Source::File { document, .. } = &self.session.source else { return None };
        document.body.get::<BissProfile>()
    }

    /// Returns the edited profile, if this is one.
    pub(crate) fn wanted_profile(&self) -> Option<BissProfile> {
        let mut profile = self.profile()?.clone();
        for (at, byte) in self.memory.iter() {
            profile.put(at, byte);
        }
        Some(profile)
    }

    /// Returns the identity, as far as known.
    pub fn identity(&self) -> Option<&Identity> {
        self.survey.as_ref().map(|survey| &survey.identity)
    }

    /// Returns its data sheet, common part first: as read, or from a profile.
    pub fn data_sheet(&self) -> Option<[Result<Eds, EdsError>; 2]> {
        if let Some(identity) = self.identity() {
            return identity.data_sheet.as_ref().map(|sheet| [sheet.common.eds, sheet.encoder.eds]);
        }
        let banks = &self.profile()?.recorded.eds;
        let parsed = |bank: EdsBank| {
            let listed = banks.iter().find(|listed| listed.bank.number == bank.number())?;
            Some(Eds::parse(bank, listed.bank.bytes))
        };
        Some([parsed(EdsBank::Common)?, parsed(EdsBank::Encoder)?])
    }

    /// Returns what an adapter streams now; `None` if it does not.
    pub fn streamed(&self) -> Option<&Streamed> {
        self.record.streamed().filter(|_| self.session.is_polling())
    }

    pub fn profile_identity(&self) -> Option<&ProfileIdentity> {
        self.profile().map(|profile| &profile.identity)
    }

    /// Returns the serial number; empty if the encoder has none, `None` if nothing was read.
    pub fn serial_number(&self) -> Option<&str> {
        let profile = || self.profile_identity().map(|own| own.serial_number.as_str());
        self.identity().map(|own| own.serial_number.as_str()).or_else(profile)
    }

    /// Returns whether there are edits that are not written.
    pub fn is_dirty(&self) -> bool {
        self.memory.is_dirty()
    }

    /// Takes over a reading of the encoder; edits stay, unless they are for another encoder.
    pub(super) fn take_survey(&mut self, survey: Survey, services: &mut Services) {
        let fresh = std::mem::take(&mut self.session.just_connected);
        // Without a serial number, it may be any encoder of its type.
        let unproven = fresh && self.survey.is_some() && survey.identity.serial_number.is_empty();
        if unproven || self.is_another(&survey.identity) {
            self.replaced_by(&survey.identity.serial_number, services);
        }
        let first = self.survey.is_none();
        let Survey { identity, status, registers, .. } = &survey;
        self.session.title = Some(title(identity));
        self.status = Some(status.clone());
        if let Some(position) = status.position {
            self.record.add_position(position);
        }
        for (at, byte) in registers.iter() {
            self.memory.take(at, &[byte]);
        }
        let description = identity.description.clone();
        self.survey = Some(survey);
        self.describe(Some(description));
        if first {
            self.load_draft(services);
        }
        if fresh {
            self.log_answer(services);
        }
        self.list_backups(services);
    }

    /// Takes the device mode in which registers were read just now; `None` in operation.
    pub(super) fn see_mode(&mut self, unsaved: Option<DeviceMode>) {
        if let Some(mode) = self.status.as_mut().and_then(|status| status.mode.as_mut()) {
            *mode = unsaved.unwrap_or(DeviceMode::OPERATION);
        }
    }

    /// Returns the text of the device mode in which its registers may show values that were never saved: of the encoder, or
    /// of a profile when it was read.
    pub fn unsaved(&self) -> Option<Text> {
        if let Some(profile) = self.profile() {
            return words::profile_unsaved(profile);
        }
        let mode = self.status.as_ref()?.mode.filter(|mode| *mode != DeviceMode::OPERATION)?;
        Some(words::unsaved(mode))
    }

    /// Returns whether this is another encoder than the one read before.
    pub(super) fn is_another(&self, identity: &Identity) -> bool {
        let who = |identity: &Identity| (identity.kind.clone(), identity.serial_number.clone());
        self.identity().is_some_and(|known| who(known) != who(identity))
    }
}

/// Returns the name by which the log and the jobs call an encoder.
fn title(identity: &Identity) -> String {
    let name = identity.description.name();
    if identity.serial_number.is_empty() { name.to_owned() } else { format!("{name} · {}", identity.serial_number) }
}
