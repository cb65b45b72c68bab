//! The BiSS device type as the studio knows it before a device is open.

use std::sync::Arc;

use super::{BissForm, Encoder, items, report};
use crate::app::report::{ReportContent, ReportContext};
use crate::app::services::Services;
use crate::app::session::Session;
use crate::app::{DeviceType, ItemValues, ProfileSubject, Text};
use crate::devices::biss::jobs::{Biss, check_link, load_descriptions};
use crate::devices::biss::procedures::{BusParameters, FrameParameters, LineParameters, PinParameters};
use crate::devices::biss::profile::BissProfile;
use crate::devices::biss::protocol::Descriptions;
use crate::devices::biss::sim::Config;
use crate::devices::biss::state::explain;
use crate::link::LinkUrl;
use crate::parameter::ParameterGroup as _;
use crate::profile::{Cause, ProfileDocument};
use crate::store::Store;
use crate::worker::OpenError;

impl DeviceType for Encoder {
    const BUS: &'static str = "BiSS";
    type Profile = BissProfile;
    type Form = BissForm;
    type Tables = Descriptions;

    fn check_link(url: &LinkUrl) -> Result<(), OpenError> {
        check_link(url)
    }

    fn explain_rejection(cause: &Cause) -> Option<Text> {
        explain::entry_error_text(cause)
    }

    fn item_name(item: &str, manual_name: Option<&str>) -> Option<Text> {
        items::item_name(item, manual_name)
    }

    fn item_group(item: &str) -> Option<Text> {
        items::item_group(item)
    }

    fn item_values(profile: &BissProfile, _document: &ProfileDocument) -> ItemValues {
        let profile = profile.clone();
        Box::new(move |item, value| items::item_value(&profile, item, value))
    }

    fn profile_subject(profile: &BissProfile) -> ProfileSubject {
        let identity = &profile.identity;
        ProfileSubject {
            name: String::new(),
            device_type: identity.description.clone(),
            serial_number: identity.serial_number.clone(),
        }
    }

    fn report(
        profile: &BissProfile,
        document: &ProfileDocument,
        context: &ReportContext<'_>,
    ) -> Result<ReportContent, Text> {
        report::content(profile, document, context)
    }

    fn load_tables(store: &Store) -> Self::Tables {
        load_descriptions(store).0
    }

    fn create(session: Session<Biss>, profile: Option<(&BissProfile, Descriptions)>, _: &mut Services) -> Self {
        let mut encoder = Encoder::from_session(session);
        if let Some((profile, tables)) = profile {
            let described =
                tables.find_by_name(&profile.identity.description).or_else(|| tables.iter().last()).cloned();
            encoder.set_description(described.map(Arc::new));
            encoder.load_profile(profile);
        }
        encoder
    }

    fn secret_parameters() -> Vec<&'static str> {
        [
            PinParameters::SECRETS,
            LineParameters::SECRETS,
            BusParameters::SECRETS,
            FrameParameters::SECRETS,
            Config::SECRETS,
        ]
        .concat()
    }
}
