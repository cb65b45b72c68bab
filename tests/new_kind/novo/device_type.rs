//! The device type of Novo encoders: opening a session, the connection form, the review and the report.

use encoder_studio::app::connect::form::{FormModel, NoFinder};
use encoder_studio::app::report::{ReportContent, ReportContext};
use encoder_studio::app::review::{self, Review, Reviewable};
use encoder_studio::app::session::{Kind, Session};
use encoder_studio::app::{DeviceType, Services, Severity, Text, explain};
use encoder_studio::link::LinkUrl;
use encoder_studio::profile::ProfileDocument;
use encoder_studio::report::{Block, CellStyle, Section};
use encoder_studio::store::Store;
use encoder_studio::worker::{self, OpenError};

use super::jobs::{self, Error, Job, JobError, Novo, Output};
use super::profile::NovoProfile;
use super::protocol::{KIND, name_of};
use super::sim::Virtual;
use super::state::{Encoder, TEXTS};

impl Kind for Novo {
    const KIND: &'static str = KIND;
    type Edits = Vec<(usize, u16)>;
    type SessionHandle = ();
    type Review = Review<Self>;

    fn session_handle(_: &worker::Session<Self>) {}

    fn open(url: &LinkUrl, store: Store) -> Result<worker::Session<Self>, OpenError> {
        jobs::open(url, store)
    }
    fn job_text(job: &Job) -> Text {
        match job {
            Job::Survey => Text::new("job.survey"),
            Job::Position => Text::new("job.position"),
            Job::Prepare(change) => Text::new("job.prepare").with_text("change", Self::change_title(change)),
            Job::Commit(_) => Text::new("job.write"),
        }
    }
    fn writes_memory(job: &Job) -> bool {
        matches!(job, Job::Commit(_))
    }
    fn survey_job() -> Job {
        Job::Survey
    }
    fn step_text(item: &usize) -> Text {
        explain::literal_text(name_of(*item))
    }
    fn result_texts(output: &Output) -> Option<(Severity, Vec<Text>)> {
        let Output::Committed(committed) = output else { return None };
        Some(review::write_result_messages::<Novo>(committed))
    }
    fn error_texts(error: &JobError) -> Vec<Text> {
        vec![match (error, error.device()) {
            (JobError::NotStarted(why), _) => explain::not_started_text(why),
            (_, Some(Error::Cancelled)) => Text::new("encoder.cancelled"),
            (_, Some(Error::Silent)) => TEXTS.text("novo.silent"),
            (_, Some(Error::Link(error))) => explain::link_error_text(error),
            _ => explain::literal_text(error),
        }]
    }
    fn connection_error(error: &JobError) -> Option<Text> {
        let Some(Error::Link(error)) = error.device() else { return None };
        Some(explain::link_error_text(error))
    }
}

impl DeviceType for Encoder {
    const BUS: &'static str = "NOVO";
    type Profile = NovoProfile;
    type Form = NovoForm;
    type Tables = ();

    fn check_link(url: &LinkUrl) -> Result<(), OpenError> {
        jobs::check(url)
    }
    fn secret_parameters() -> Vec<&'static str> {
        Virtual::SECRETS.to_vec()
    }
    fn load_tables(_: &Store) {}
    fn report(profile: &NovoProfile, _: &ProfileDocument, context: &ReportContext<'_>) -> Result<ReportContent, Text> {
        let mut table =
            context.table([("report.item".into(), CellStyle::Code), ("report.value".into(), CellStyle::Number)]);
        for (item, value) in profile.values.iter().enumerate() {
            table.add_row([name_of(item).to_owned(), value.to_string()]);
        }
        let settings = Section::new(context.localize("report.settings")).with(Block::Table(table));
        Ok(ReportContent { title: KIND.to_owned(), key: None, sections: vec![settings] })
    }

    fn create(session: Session<Novo>, profile: Option<(&NovoProfile, ())>, _: &mut Services) -> Self {
        let mut own = Encoder::with(session);
        profile.into_iter().for_each(|(profile, ())| own.take(profile.clone()));
        own
    }
}

/// The connection form for the virtual encoder or an encoder behind a device server.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NovoForm {
    pub(crate) link: String,
}

impl FormModel for NovoForm {
    type Finder = NoFinder<Self>;

    fn default_link() -> LinkUrl {
        LinkUrl::simulated()
    }
    fn from_url(url: &LinkUrl) -> Self {
        NovoForm { link: url.to_string() }
    }
    fn url(&self) -> Result<LinkUrl, Text> {
        let url: LinkUrl = self.link.parse().map_err(|error| explain::url_error_text(&error))?;
        jobs::check(&url).map_err(|error| explain::open_error_text(&error))?;
        Ok(url)
    }
    fn example_link(&self) -> &'static str {
        "tcp:192.168.0.7:4001"
    }
}
