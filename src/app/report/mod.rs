//! Reports on a profile: its values and what they mean, the history of the device, and the differences from another
//! profile. The window and the command line create reports in the same way, from a profile and the logbook. Runs in a
//! task.

mod bytes;
mod company;
mod content;
mod format;
mod history;
mod results;
mod sections;
mod status;

use std::path::Path;

pub use bytes::byte_table;
pub use company::{check_company, company};
pub use content::{ReportContent, ReportContext};
pub use format::{ReportFormat, current_time_text};

pub use results::SessionResult;
pub use status::{DeviceReading, StatusLine};

use self::results::result_section;
use self::sections::{comparison_section, time};
use self::status::status_section;
use super::comparison::compare_documents;
use super::documents::new_document;
use super::{KindRegistry, Language, Text, explain};
use crate::link::{LinkScheme, LinkUrl};
use crate::profile::{Body, ProfileDocument, ProfileError};
use crate::report::{Fact, Labels, Report, Section};
use crate::store::{AssetName, Store};

/// Function that creates a report in a task.
pub type CreateReport = Box<dyn FnOnce(&ReportContext<'_>) -> Result<Report, Text> + Send>;

/// The subject of a report, and what the report contains besides the values.
#[derive(Clone, Debug)]
pub struct ReportRequest {
    /// Values to report.
    pub document: ProfileDocument,
    /// Name of the profile without its folder, or the link to the device without secrets.
    pub source: ReportSource,
    /// Name and content of the profile to compare with.
    pub compared: Option<(String, Body)>,
    pub asset: Option<AssetName>,
    /// Status that the device reported when it was read, if known.
    pub status: Option<Vec<StatusLine>>,
    /// Results of the current session, for a device that is open in the window.
    pub results: Vec<SessionResult>,
    pub language: Language,
}

/// Origin of the values in a report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReportSource {
    /// A profile, with the name of its file.
    Profile(String),
    /// A device, with the link as it may be displayed, and whether the device is virtual.
    Device { link: String, is_virtual: bool },
}

impl ReportRequest {
    /// Creates a request for a profile without a comparison.
    pub fn for_profile(path: &Path, document: ProfileDocument, language: Language) -> Self {
        let source = ReportSource::Profile(file_name(path));
        ReportRequest { document, source, compared: None, asset: None, status: None, results: Vec::new(), language }
    }

    /// Creates a request for a device that has just been read.
    pub fn for_device(url: &LinkUrl, kinds: KindRegistry, reading: DeviceReading, language: Language) -> Self {
        let source = ReportSource::Device { link: kinds.display_link(url), is_virtual: url.scheme == LinkScheme::Sim };
        let (document, status) = (new_document(reading.body), reading.status);
        ReportRequest { document, source, compared: None, asset: None, status, results: Vec::new(), language }
    }

    /// Creates the report.
    ///
    /// # Errors
    /// Returns a message if the profiles are of different kinds or the logbook cannot be read.
    pub fn create(&self, kinds: KindRegistry, store: &Store) -> Result<Report, Text> {
        let ReportRequest { document, source, compared, language, .. } = self;
        let kind = kinds.for_profile(document.device()).ok_or_else(|| {
            let known = kinds.formats.kinds().collect();
            explain::profile_error_text(&ProfileError::Device { found: document.device().to_owned(), known }, kinds)
        })?;
        let context = ReportContext::new(store, *language);
        let content = kind
            .report(document, &context)
            .ok_or_else(|| explain::profile_error_text(&document.body.wrong_kind_error(kind.keyword()), kinds))??;
        let history = history::read(&content, source, store)?;
        let asset = self.asset.as_ref().map(ToString::to_string).or_else(|| history.asset().map(str::to_owned));
        let mut sections = content.sections;
        sections.extend(self.status.as_ref().map(|status| status_section(&context, status)));
        sections.extend(self.results.iter().map(|result| result_section(&context, result)));
        if let Some((name, body)) = compared {
            let compared = compare_documents(kinds, document, &new_document(body.clone()))
                .map_err(|error| explain::profile_error_text(&error, kinds))?;
            sections.push(comparison_section(&context, name, &compared));
        }
        sections.extend(history.sections(&context, kinds));
        let subject = context.localize(Text::new("report.subject").with("bus", kind.bus_name()));
        Ok(report(&context, subject, content.title, origin(&context, document, source, asset), sections))
    }
}

/// Creates a report on data other than a profile, such as a capture. `source` is the label for the name.
pub fn data_report(
    context: &ReportContext<'_>,
    (subject, source): (Text, Text),
    name: String,
    asset: Option<&AssetName>,
    content: ReportContent,
) -> Report {
    let mut origin = vec![Fact::new(context.localize(source), name)];
    origin.extend(asset.map(|asset| Fact::new(context.localize("logbook.kind_assigned"), asset.to_string())));
    origin.push(program_fact(context));
    report(context, context.localize(subject), content.title, origin, content.sections)
}

fn report(
    context: &ReportContext<'_>,
    subject: String,
    title: String,
    origin: Vec<Fact>,
    sections: Vec<Section>,
) -> Report {
    let (language, labels) = (language_tag(context.language), labels(context));
    Report { language, subject, title, company: None, origin, sections, labels }
}

/// Returns the name of a file without its folder, because reports are passed on to other people.
pub fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

const fn language_tag(language: Language) -> &'static str {
    match language {
        Language::English => "en",
        Language::German => "de",
    }
}

fn origin(
    context: &ReportContext<'_>,
    document: &ProfileDocument,
    source: &ReportSource,
    asset: Option<String>,
) -> Vec<Fact> {
    let mut facts = vec![match source {
        ReportSource::Profile(name) => Fact::new(context.localize("report.profile"), name),
        ReportSource::Device { link, .. } => Fact::new(context.localize("report.link"), link),
    }];
    if let Some(saved) = &document.saved {
        let shown = saved.parse().map_or_else(|_| saved.clone(), time);
        facts.push(Fact::new(context.localize("report.read_at"), shown));
    }
    if let Some(note) = &document.note {
        facts.push(Fact::new(context.localize("report.note"), note));
    }
    if let Some(asset) = asset {
        facts.push(Fact::new(context.localize("logbook.kind_assigned"), asset));
    }
    facts.push(program_fact(context));
    facts
}

fn program_fact(context: &ReportContext<'_>) -> Fact {
    Fact::new(context.localize("report.program"), format!("encoder-studio {}", env!("CARGO_PKG_VERSION")))
}

fn labels(context: &ReportContext<'_>) -> Labels {
    Labels {
        number: context.localize("report.number"),
        content_hash: context.localize("report.content_hash"),
        printed: context.localize("report.printed"),
        page: context.localize("report.page"),
        of: context.localize("report.of"),
        no_certificate: context.localize("report.no_certificate"),
        signatures: ["report.made_by", "report.checked_by", "report.place_date"].map(|id| context.localize(id)).into(),
    }
}
