//! Handling the user's actions on an encoder. Edits take effect immediately. All other actions start a job or a task.

use std::time::Duration;

use super::action::BissAction;
use super::encoder::Encoder;
use super::format;
use crate::app::services::Services;
use crate::app::session::{HasDraft, HasMemory, HasProfile, Phase, SessionEvents};
use crate::app::{ActionContext, PendingEdits, Severity, Text};
use crate::devices::biss::jobs::{BissJob, Change};
use crate::devices::biss::profile::{BissProfile, RegisterRange};
use crate::devices::biss::protocol::{Area, Register, RegisterAddress};
use crate::devices::biss::state::TEXTS;
use crate::profile::Body;

use super::table::Group;
use crate::devices::biss::state::explain as explained;

/// Interval at which watched registers are read. Their values change slowly, and each reading delays the positions.
const WATCH_INTERVAL: Duration = Duration::from_millis(500);

impl Encoder {
    pub(crate) fn handle_action(&mut self, action: BissAction, context: &mut ActionContext<'_>) {
        let services = &mut *context.services;
        match action {
            BissAction::PlanMounting { mut run, motor, data } => {
                let profile = data.map_or(Ok(None), |id| context.edited_session_profile(id));
                match profile {
                    Ok(profile) => {
                        run.data = profile.and_then(|body| body.into_profile().ok()).map(Box::new);
                        self.plan(Change::Guided { run: *run, motor }, context.services);
                    }
                    Err(refusal) => context.services.notify(Severity::Error, vec![refusal], None),
                }
            }
            BissAction::ReadStatus => self.submit(BissJob::Status, services),
            BissAction::Check => self.submit(BissJob::Check, services),
            BissAction::Watch(register, on) => self.watch_register(*register, on),
            BissAction::ReadBank(bank) => self.read_bank(bank, services),
            BissAction::ReadVisibleBank(bank) => {
                // A bank is read only once, and only if nothing is running and no stream would be interrupted.
                let free = self.session.is_ready() && self.active_stream().is_none();
                if free && self.seen.insert(bank) {
                    self.read_bank(bank, services);
                }
            }
            BissAction::ReadArea(first) => self.read_area(first, services),
            BissAction::Put { start, bytes } => self.edit_bytes(start, &bytes, services),
            BissAction::Revert { start, count } => self.memory.revert_range(start, count),
            BissAction::Plan(change) => self.plan(*change, services),
            BissAction::Answer(task, answer) => self.answer_task(task, answer),
            BissAction::CloseGuide => self.close_procedure(),
            BissAction::ReturnToOperation => self.submit(BissJob::ReturnToOperation, services),
            BissAction::Turn(rpm) => {
                if let Some(motor) = &self.motor {
                    motor.set_rpm(rpm);
                }
            }
            BissAction::Save(path) => self.save(path, services),
        }
    }

    fn watch_register(&mut self, register: Register, on: bool) {
        let mut watched = self.record.watched_registers();
        watched.retain(|own| own.address != register.address);
        if on {
            watched.push(register);
        }
        self.record.set_watched(&watched);
        self.update_watches();
    }

    pub(super) fn update_watches(&mut self) {
        let ranges =
            self.record.watched_registers().into_iter().filter_map(|own| RegisterRange::new(own.address, own.width));
        if let Some(line) = &self.session.line {
            line.watch_values(ranges.map(|range| (range, WATCH_INTERVAL)).collect());
        }
    }

    fn read_bank(&mut self, bank: Option<u8>, services: &mut Services) {
        let job = match bank {
            None => BissJob::ReadDirect,
            Some(bank) => BissJob::ReadBank(bank),
        };
        self.submit(job, services);
    }

    fn read_area(&mut self, first: u8, services: &mut Services) {
        let area = self.description.iter().flat_map(|own| own.areas()).find(|own| own.first == first).cloned();
        if let Some(area) = area {
            self.submit(BissJob::ReadArea(area), services);
        }
    }

    /// Returns whether a bank that has become visible should be read. This is not the case if it was read before, an
    /// attempt failed, a job is running, or a stream would be interrupted.
    pub fn should_read_bank(&self, group: &Group) -> bool {
        let free = self.session.is_ready() && self.active_stream().is_none();
        free && !group.is_read(&self.memory) && !self.seen.contains(&group.bank)
    }

    /// Returns the part of an area that can be shown, which is the whole area of an encoder, or what a profile
    /// contains.
    pub fn visible_area(&self, area: &Area) -> Option<Area> {
        if self.profile().is_some() { self.memory.longest_readable_run(area) } else { Some(area.clone()) }
    }

    /// Returns the reason why an area cannot currently be edited, or `None` if it can be edited.
    pub fn not_editable_reason(&self, area: &Area) -> Option<Text> {
        if !area.access.is_writable() {
            return Some(TEXTS.text("data.read_only"));
        }
        // The access rights of the encoder do not apply to a profile, which is only a file.
        (self.session.phase != Phase::Offline && self.session.is_writing()).then(|| Text::new("session.busy"))
    }

    fn edit_bytes(&mut self, start: RegisterAddress, bytes: &[u8], services: &mut Services) {
        if self.session.is_writing() {
            return self.session.report_rejection(Text::new("session.busy"), services);
        }
        let Some(description) = self.description.clone() else { return };
        if let Err(error) = self.memory.edit_bytes(&description, start, bytes) {
            self.session.report_rejection(format::edit_error_text(error), services);
        }
    }

    /// Saves a newly read profile to the requested file.
    pub(super) fn save_profile(&mut self, profile: BissProfile, services: &mut Services) {
        let edits = self.is_dirty().then(|| self.memory.count());
        let remarks = explained::unsaved_profile_warning(&profile).into_iter().collect();
        let device = self.device_key();
        self.session.save_read_values(device, Body::new(profile), edits, remarks, services);
    }
}
