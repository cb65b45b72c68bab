//! SSI encoders as a device type: what is possible before a device is open.

use std::path::{Path, PathBuf};

use super::design::LayoutDesigner;
use super::families::families;
use super::{Encoder, SsiForm, items, report};
use crate::app::report::{ReportContent, ReportContext};
use crate::app::services::Services;
use crate::app::session::{HasDraft, Session, Source};
use crate::app::studio::SessionId;
use crate::app::{DeviceType, ItemValues, ProfileSubject, Text};
use crate::devices::ssi::jobs::{Ssi, check_link};
use crate::devices::ssi::procedures::LinkParameters;
use crate::devices::ssi::profile::SsiProfile;
use crate::devices::ssi::sim::Settings;
use crate::devices::ssi::state::explain;
use crate::link::LinkUrl;
use crate::parameter::ParameterGroup as _;
use crate::profile::{Cause, ProfileDocument};
use crate::store::Store;
use crate::worker::OpenError;

impl DeviceType for Encoder {
    const BUS: &'static str = "SSI";
    type Profile = SsiProfile;
    type Form = SsiForm;
    type Tables = ();

    fn check_link(url: &LinkUrl) -> Result<(), OpenError> {
        check_link(url)
    }

    fn explain_rejection(cause: &Cause) -> Option<Text> {
        explain::entry_error_text(cause)
    }

    fn item_name(item: &str, _manual_name: Option<&str>) -> Option<Text> {
        items::item_name(item)
    }

    fn item_group(item: &str) -> Option<Text> {
        items::item_group(item)
    }

    fn item_values(profile: &SsiProfile, _document: &ProfileDocument) -> ItemValues {
        let profile = profile.clone();
        Box::new(move |item, value| items::item_value(&profile, item, value))
    }

    fn profile_subject(profile: &SsiProfile) -> ProfileSubject {
        ProfileSubject {
            name: profile.name.clone(),
            device_type: profile.family.clone().unwrap_or_default(),
            serial_number: String::new(),
        }
    }

    fn report(
        profile: &SsiProfile,
        document: &ProfileDocument,
        context: &ReportContext<'_>,
    ) -> Result<ReportContent, Text> {
        report::content(profile, document, context)
    }

    fn load_tables(_store: &Store) -> Self::Tables {}

    fn create(session: Session<Ssi>, profile: Option<(&SsiProfile, ())>, services: &mut Services) -> Self {
        let families = families(services);
        let mut designer = match &session.source {
            Source::Link(url) => LayoutDesigner::for_link(url, families),
            Source::File { .. } | Source::New { .. } => LayoutDesigner::factory_default(families),
        };
        if let Some((profile, ())) = profile {
            designer.open(profile.clone());
        }
        Encoder::from_session(session, designer)
    }

    /// Creates a profile with the factory layout of the first family, and gives it the first unused name.
    fn new_profile(id: SessionId, is_taken: &dyn Fn(&Path) -> bool, services: &mut Services) -> Option<Self> {
        let further = (2..).map(|number: u32| PathBuf::from(format!("layout-{number}.ron")));
        let mut names = std::iter::once(PathBuf::from("layout.ron")).chain(further);
        let suggested = names.find(|name| !is_taken(name))?;
        let mut encoder = Self::create(Session::new_unsaved(id, suggested), None, services);
        encoder.load_draft(services);
        Some(encoder)
    }

    fn secret_parameters() -> Vec<&'static str> {
        [LinkParameters::SECRETS, Settings::SECRETS].concat()
    }
}
