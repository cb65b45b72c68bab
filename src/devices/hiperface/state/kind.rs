//! Properties and functions of the HIPERFACE device kind that do not require an open encoder.

use super::{Encoder, LinkForm, items, report};
use crate::app::report::{ReportContent, ReportContext};
use crate::app::services::Services;
use crate::app::session::Session;
use crate::app::{DeviceType, ItemValues, ProfileSubject, Severity, Text};
use crate::devices::hiperface::jobs::{self, Hiperface, check_link, encoder_types};
use crate::devices::hiperface::procedures::{LinkParameters, recorded_identity};
use crate::devices::hiperface::profile::HiperfaceProfile;
use crate::devices::hiperface::protocol::EncoderTypes;
use crate::devices::hiperface::sim::Config;
use crate::devices::hiperface::state::explain;
use crate::link::{LinkScheme, LinkUrl};
use crate::parameter::ParameterGroup as _;
use crate::profile::{Cause, ProfileDocument};
use crate::store::{Store, StoreError};
use crate::worker::OpenError;

impl DeviceType for Encoder {
    const BUS: &'static str = "HIPERFACE";
    type Profile = HiperfaceProfile;
    type Form = LinkForm;
    type Tables = Result<EncoderTypes, StoreError>;

    fn check_link(url: &LinkUrl) -> Result<(), OpenError> {
        check_link(url)
    }

    fn is_typical_link(url: &LinkUrl) -> bool {
        // Adapters were made for clocked buses, and only some have a serial line.
        url.scheme != LinkScheme::Bridge
    }

    fn may_have_other_master(url: &LinkUrl) -> bool {
        jobs::may_have_other_master(url)
    }

    fn explain_rejection(cause: &Cause) -> Option<Text> {
        explain::rejection_text(cause)
    }

    fn item_name(item: &str, _manual_name: Option<&str>) -> Option<Text> {
        items::item_name(item)
    }

    fn item_group(item: &str) -> Option<Text> {
        items::item_group(item)
    }

    fn item_values(_profile: &HiperfaceProfile, _document: &ProfileDocument) -> ItemValues {
        Box::new(items::item_value)
    }

    fn profile_subject(profile: &HiperfaceProfile) -> ProfileSubject {
        let identity = &profile.identity;
        ProfileSubject {
            name: String::new(),
            device_type: identity.encoder_name.clone(),
            serial_number: identity.serial_number.clone(),
        }
    }

    fn report(
        profile: &HiperfaceProfile,
        document: &ProfileDocument,
        context: &ReportContext<'_>,
    ) -> Result<ReportContent, Text> {
        report::content(profile, document, context)
    }

    fn load_tables(store: &Store) -> Self::Tables {
        encoder_types(store)
    }

    fn create(
        session: Session<Hiperface>,
        profile: Option<(&HiperfaceProfile, Self::Tables)>,
        services: &mut Services,
    ) -> Self {
        let mut encoder = Encoder::from_session(session);
        if let Some((profile, tables)) = profile {
            let types = tables.unwrap_or_else(|error| {
                services.notify(Severity::Warning, vec![explain::table_error_text(&error)], None);
                EncoderTypes::built_in()
            });
            encoder.identify(recorded_identity(profile, &types));
            encoder.counter = profile.recorded.counter;
            encoder.staged.refresh(profile.fields.clone());
        }
        encoder
    }

    fn secret_parameters() -> Vec<&'static str> {
        [LinkParameters::SECRETS, Config::SECRETS].concat()
    }
}
