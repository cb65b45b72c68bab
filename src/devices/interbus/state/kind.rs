//! The INTERBUS encoder as a kind of device in the program.

use super::staged::StagedEdits;
use super::{Encoder, InterbusForm, items, report};
use crate::app::report::{ReportContent, ReportContext};
use crate::app::services::Services;
use crate::app::session::Session;
use crate::app::{DeviceType, ItemValues, ProfileSubject, Text};
use crate::devices::interbus::jobs::{Interbus, check_link, logbook_key};
use crate::devices::interbus::procedures::LinkParameters;
use crate::devices::interbus::profile::InterbusProfile;
use crate::devices::interbus::sim::Config;
use crate::devices::interbus::state::explain;
use crate::link::LinkUrl;
use crate::parameter::ParameterGroup as _;
use crate::profile::{Cause, ProfileDocument};
use crate::store::Store;
use crate::worker::OpenError;

impl DeviceType for Encoder {
    const BUS: &'static str = "INTERBUS";
    type Profile = InterbusProfile;
    type Form = InterbusForm;
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

    fn item_values(profile: &InterbusProfile, _document: &ProfileDocument) -> ItemValues {
        let profile = profile.clone();
        Box::new(move |item, _| items::item_value(&profile, item))
    }

    fn profile_subject(profile: &InterbusProfile) -> ProfileSubject {
        let key = logbook_key(&profile.identity.serial_number, false);
        ProfileSubject { name: String::new(), device_type: key.device_type, serial_number: key.serial_number }
    }

    fn report(
        profile: &InterbusProfile,
        document: &ProfileDocument,
        context: &ReportContext<'_>,
    ) -> Result<ReportContent, Text> {
        report::content(profile, document, context)
    }

    fn load_tables(_store: &Store) -> Self::Tables {}

    fn create(session: Session<Interbus>, profile: Option<(&InterbusProfile, ())>, _: &mut Services) -> Self {
        let staged =
            profile.map(|(profile, ())| StagedEdits::for_profile(profile.image.clone(), profile.names.clone()));
        Encoder::from_session(session, staged.unwrap_or_default())
    }

    fn secret_parameters() -> Vec<&'static str> {
        [LinkParameters::SECRETS, Config::SECRETS].concat()
    }
}
