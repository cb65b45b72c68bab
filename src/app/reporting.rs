//! Reports from the window: of a profile as saved, or of the values read last from a device. They are the same as those
//! of the command line. The device is not accessed.

use std::path::{Path, PathBuf};

use super::action::{Action, RecorderOwner, TaskResult};
use super::file_question::FileQuestion;
use super::report::{DeviceReading, ReportFormat, ReportRequest, company, current_time_text};
use super::session::Source;
use super::studio::{SessionId, Studio};
use super::{AnyDevice, Severity, Text, explain};
use crate::report::Report;
use crate::store::{FileError, write_atomically};

impl Studio {
    pub(super) fn ask_report_path(&mut self, session: SessionId) {
        let suggested = self.suggested_path(Some(RecorderOwner::Device(session)), "html");
        self.services.file_question = Some(FileQuestion::Report { session, suggested });
    }

    /// Starts a task that writes a report. The extension of the file determines its format.
    pub(super) fn write_report(&mut self, session: SessionId, path: PathBuf) {
        let Some(device) = self.device(session) else { return };
        let name = device.name();
        let prepared = self.report_request(device).and_then(|request| {
            let format = ReportFormat::of_file(&path).ok_or_else(|| Text::new("report.extension"))?;
            Ok((request, format))
        });
        let (request, format) = match prepared {
            Ok(prepared) => prepared,
            Err(why) => return self.services.notify(Severity::Error, vec![why], Some(&name)),
        };
        let printed = current_time_text(&self.services.current_time(), request.language);
        let (kinds, store) = (self.services.world.kinds, self.services.world.store.clone());
        let settings = self.settings.clone();
        self.services.tasks.run("report", move || {
            let content = company(&settings).and_then(|company| {
                let report = Report { company, ..request.create(kinds, &store)? };
                format.render(&report, &printed)
            });
            let result = content.map(|bytes| write_atomically(&path, &bytes));
            Action::Done(TaskResult::ReportWritten { path, result })
        });
    }

    fn report_request(&self, device: &AnyDevice) -> Result<ReportRequest, Text> {
        let language = self.settings.language;
        match device.source() {
            Source::File { .. } if device.is_dirty() => Err(Text::new("report.unsaved")),
            Source::File { path, document, .. } => Ok(ReportRequest::for_profile(path, (**document).clone(), language)),
            Source::Link(_) | Source::New { .. } => {
                let body = match device.comparable_body() {
                    None => return Err(Text::new("report.nothing_read")),
                    Some(Err(missing)) => return Err(Text::new("report.not_all_read").with_list("missing", missing)),
                    Some(Ok(body)) => body,
                };
                let Source::Link(url) = device.source() else { return Err(Text::new("report.unsaved")) };
                let reading = DeviceReading { body, status: device.reported_status() };
                let request = ReportRequest::for_device(url, self.services.world.kinds, reading, language);
                Ok(ReportRequest { results: device.session_results(), ..request })
            }
        }
    }

    pub(super) fn finish_report(&mut self, path: &Path, result: Result<Result<(), FileError>, Text>) {
        let result = result.and_then(|written| written.map_err(|error| explain::file_error_text(&error)));
        match result {
            Ok(()) => {
                let text = Text::new("report.saved").with("path", path.display());
                self.services.notify(Severity::Good, vec![text], None);
            }
            Err(why) => self.services.notify(Severity::Error, vec![why], None),
        }
    }
}
