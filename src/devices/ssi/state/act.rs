//! Handles the user's actions on an SSI encoder or layout. Changes to the layout take effect immediately. Everything
//! else runs as a job or a background task.

use std::path::PathBuf;

use super::action::{SsiAction, TrialInput};
use super::design::Edit;
use super::encoder::Encoder;
use super::families::families;
use super::search::{Frames, MAX_SEARCHED_FRAMES, Origin, SearchState, read_frames};
use super::{TaskResult, strip};
use crate::app::action::{Action as StudioAction, TaskResult as StudioDone};
use crate::app::services::Services;
use crate::app::session::{HasDraft, SessionEvents, Source};
use crate::app::{ActionContext, DeviceCommand, DeviceFile, DeviceModel, FileQuestion, Text};
use crate::devices::ssi::jobs::SsiJob;
use crate::devices::ssi::protocol::{find, frame_bits};
use crate::devices::ssi::state::TEXTS;
use crate::store::write_atomically;

impl Encoder {
    pub(crate) fn handle_action(&mut self, action: SsiAction, context: &mut ActionContext<'_>) {
        let services = &mut *context.services;
        match action {
            SsiAction::SendLayout => {
                let Some(url) = self.link_for_layout() else { return };
                // The draft belongs to the encoder at the previous link.
                self.release_draft(services);
                self.switch_link(&url);
                self.session.source = Source::Link(url);
                context.queue_command(DeviceCommand::Reconnect);
            }
            SsiAction::Check => self.submit(SsiJob::Check(Box::new(self.designer.layout().clone())), services),
            SsiAction::Edit(edit) => self.apply_edit(*edit),
            SsiAction::Enter(field, input) => match self.designer.parse_entry(field, &input) {
                Ok(edit) => self.apply_edit(edit),
                Err(why) => self.designer.show_rejection(why),
            },
            SsiAction::Move(handle, to) => {
                let layout = self.designer.layout();
                let moved = strip::move_part(layout, handle, to, self.designer.error_bits_follow_position());
                self.apply_edit(Edit::Frame(Box::new(moved.descriptor().clone())));
            }
            SsiAction::AddErrorBit => {
                if let Some(frame) = self.designer.with_error_bit() {
                    self.apply_edit(Edit::Frame(Box::new(frame)));
                }
            }
            SsiAction::RemoveErrorBit(index) => {
                let frame = self.designer.without_error_bit(index);
                self.apply_edit(Edit::Frame(Box::new(frame)));
            }
            SsiAction::Try(with) => self.start_trial(with),
            SsiAction::SetClocks(clocks) => {
                self.clocks = clocks
                    .map(|clocks| clocks.clamp(1, 64))
                    .filter(|clocks| *clocks != self.designer.layout().clock_count());
            }
            SsiAction::Find => self.find_in_record(services),
            SsiAction::AskFrames => {
                let words = (TEXTS.text("file.open_frames_title"), TEXTS.text("file.frames"));
                let file = DeviceFile::to_read(self.session.id, words, &["txt", "csv"], SsiAction::FindIn);
                services.file_question = Some(FileQuestion::OfDevice(file));
            }
            SsiAction::FindIn(path) => self.find_in_file(path, services),
            SsiAction::ForgetSearch => self.search = SearchState::Nothing,
            SsiAction::Take(class, member) => self.apply_search_result(class, member),
            SsiAction::ForgetErrors => self.record.reset_tally(),
            SsiAction::AskExport(format, language) => {
                let suggested = self.suggested_path(format.file_extensions().first().copied().unwrap_or("txt"));
                let words = (TEXTS.text("file.export_title"), TEXTS.text(format.keyword()));
                let export = move |path, _| SsiAction::Export(format, language, path);
                let file =
                    DeviceFile::write_question(self.session.id, words, format.file_extensions(), suggested, export);
                services.file_question = Some(FileQuestion::OfDevice(file));
            }
            SsiAction::Export(format, language, path) => match self.designer.export(format, language) {
                Ok(text) => self.write_text(path, text, services),
                Err(why) => self.session.report_rejection(why, services),
            },
            SsiAction::AskSaveFrames => {
                let suggested = self.suggested_path("txt");
                let words = (TEXTS.text("file.frames_title"), TEXTS.text("file.frames"));
                let save = |path, _| SsiAction::SaveFrames(path);
                let file = DeviceFile::write_question(self.session.id, words, &["txt"], suggested, save);
                services.file_question = Some(FileQuestion::OfDevice(file));
            }
            SsiAction::SaveFrames(path) => {
                let clocks = self.clock_count();
                let words = self.record.latest_words(clocks);
                if words.is_empty() {
                    return self.session.report_rejection(TEXTS.text("ssi_find.nothing_read"), services);
                }
                let lines: Vec<String> = words.iter().map(|word| frame_bits(*word, clocks)).collect();
                self.write_text(path, lines.join("\n") + "\n", services);
            }
            SsiAction::Turn(rpm) => {
                if let Some(motor) = &self.motor {
                    motor.set_rpm(rpm);
                }
            }
        }
    }

    fn start_trial(&mut self, with: TrialInput) {
        let layout = self.designer.layout();
        // If the last word read is displayed, the trial starts with it.
        if self.is_showing_live_frame()
            && let Some(word) = self.record.last().map(|seen| seen.word)
        {
            self.trial.set_frame(word);
        }
        self.follows = with == TrialInput::Live;
        match with {
            TrialInput::Position(position) => self.trial.set_position(layout, position),
            TrialInput::Place(turns, steps) => self.trial.set_turn_and_step(layout, turns, steps),
            TrialInput::Bits(text) => self.trial.set_text(layout, &text),
            TrialInput::Toggle(clock) => self.trial.toggle(layout, clock),
            TrialInput::Live => {}
        }
    }

    /// Returns a suggested file name with the given extension.
    pub(super) fn suggested_path(&self, ending: &str) -> PathBuf {
        match &self.session.source {
            Source::File { path, .. } if ending == "ron" => path.clone(),
            Source::File { path, .. } => path.with_extension(ending),
            _ => {
                let title = self.designer.title();
                let name = title.chars().map(|c| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' });
                PathBuf::from(format!("{}.{ending}", name.collect::<String>()))
            }
        }
    }

    fn find_in_record(&mut self, services: &mut Services) {
        let clocks = self.clock_count();
        let frames = self.record.latest_words(clocks);
        if frames.is_empty() {
            self.search = SearchState::Failed(TEXTS.text("ssi_find.nothing_read"));
            return;
        }
        self.find(services, move || {
            Ok(Frames { origin: Origin::Live, clocks, frames, left_out: 0, are_numbers: false })
        });
    }

    fn find_in_file(&mut self, path: PathBuf, services: &mut Services) {
        let clocks = self.clock_count();
        self.find(services, move || read_frames(&path, clocks));
    }

    /// Starts a search on a background thread, because it tries several thousand layouts.
    fn find(&mut self, services: &mut Services, frames: impl FnOnce() -> Result<Frames, Text> + Send + 'static) {
        self.searches = self.searches.wrapping_add(1);
        let number = self.searches;
        self.search = SearchState::Running(number);
        let (session, families) = (self.session.id, families(services));
        services.tasks.run("find", move || {
            let result = frames().map(|Frames { origin, clocks, mut frames, left_out, .. }| {
                frames.drain(..frames.len().saturating_sub(MAX_SEARCHED_FRAMES));
                let search = Box::new(find(&frames, clocks, &families));
                SearchState::Found { origin, clocks, left_out, frames, search }
            });
            let search = Box::new(result.unwrap_or_else(SearchState::Failed));
            StudioAction::Done(StudioDone::device(session, TaskResult::Found { number, search }))
        });
    }

    fn apply_search_result(&mut self, class: usize, member: usize) {
        let SearchState::Found { search, .. } = &self.search else { return };
        let Some(proposal) = search.classes.get(class).and_then(|class| class.members.get(member)) else { return };
        let mut profile = self.edited_profile();
        profile.family = proposal.family.as_ref().map(|(key, _)| key.clone());
        profile.descriptor = proposal.layout.descriptor().clone();
        profile.preset = 0;
        self.apply_edit(Edit::Whole(Box::new(profile)));
        self.clocks = None;
        self.follows = true;
    }

    fn write_text(&self, path: PathBuf, text: String, services: &Services) {
        let session = self.session.id;
        services.tasks.run("export", move || {
            let result = write_atomically(&path, text.as_bytes());
            StudioAction::Done(StudioDone::device(session, TaskResult::Written(path, result)))
        });
    }
}
