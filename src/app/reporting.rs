//! Reports from the window: on a saved profile, on the last values read from a device with the results of its session,
//! or on a capture. The device is not accessed.

use std::path::{Path, PathBuf};

use super::action::{Action, RecorderOwner, TaskResult};
use super::documents::format_whole_seconds;
use super::file_question::FileQuestion;
use super::report::{
    CreateReport, DeviceReading, ReportContext, ReportFormat, ReportRequest, company, current_time_text,
};
use super::session::Source;
use super::studio::Studio;
use super::{AnyDevice, Severity, Text, explain};
use crate::report::Report;
use crate::store::{FileError, write_atomically};

impl Studio {
    pub(super) fn ask_report_path(&mut self, owner: RecorderOwner) {
        let suggested = self.suggested_path(Some(owner), "html");
        self.services.file_question = Some(FileQuestion::Report { owner, suggested });
    }

    /// Starts a task that writes a report. The file extension determines the format.
    pub(super) fn write_report(&mut self, owner: RecorderOwner, path: PathBuf) {
        let (name, prepared) = match owner {
            RecorderOwner::Device(session) => {
                let Some(device) = self.device(session) else { return };
                (Some(device.name()), self.device_report(device))
            }
            RecorderOwner::Tool(tab) => {
                let report = self.tool(tab).and_then(|tool| tool.report());
                (None, report.ok_or_else(|| Text::new("report.nothing_shown")))
            }
        };
        let prepared = prepared.and_then(|create| {
            let format = ReportFormat::of_file(&path).ok_or_else(|| Text::new("report.extension"))?;
            Ok((create, format))
        });
        let (create, format) = match prepared {
            Ok(prepared) => prepared,
            Err(why) => return self.services.notify(Severity::Error, vec![why], name.as_deref()),
        };
        let language = self.settings.language;
        let printed = current_time_text(&self.services.current_time(), language);
        let (store, settings) = (self.services.world.store.clone(), self.settings.clone());
        self.services.tasks.run("report", move || {
            let content = company(&settings).and_then(|company| {
                let report = Report { company, ..create(&ReportContext::new(&store, language))? };
                format.render(&report, &printed)
            });
            let result = content.map(|bytes| write_atomically(&path, &bytes));
            Action::Done(TaskResult::ReportWritten { path, result })
        });
    }

    fn device_report(&self, device: &AnyDevice) -> Result<CreateReport, Text> {
        let (request, kinds) = (self.report_request(device)?, self.services.world.kinds);
        Ok(Box::new(move |context| request.create(kinds, context.store)))
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
                let mut request = ReportRequest::for_device(url, self.services.world.kinds, reading, language);
                // The values may have been read long ago.
                request.document.saved = device.last_read_time().map(format_whole_seconds);
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
