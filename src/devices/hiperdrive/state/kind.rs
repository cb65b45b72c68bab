//! HIPERDRIVE as a device type: what the user interface needs before a device is open.

use super::{HiperdriveDevice, HiperdriveForm, items, report};
use crate::app::report::{ReportContent, ReportContext};
use crate::app::services::Services;
use crate::app::session::Session;
use crate::app::{DeviceType, ItemValues, ProfileSubject, Text};
use crate::devices::hiperdrive::jobs::{Hiperdrive, check_link};
use crate::devices::hiperdrive::procedures::LinkParameters;
use crate::devices::hiperdrive::profile::HiperdriveProfile;
use crate::devices::hiperdrive::protocol::Topology;
use crate::devices::hiperdrive::sim::Config;
use crate::devices::hiperdrive::state::explain;
use crate::link::LinkUrl;
use crate::parameter::ParameterGroup as _;
use crate::profile::{Cause, ProfileDocument};
use crate::store::Store;
use crate::worker::OpenError;

impl DeviceType for HiperdriveDevice {
    const BUS: &'static str = "HIPERDRIVE";
    type Profile = HiperdriveProfile;
    type Form = HiperdriveForm;
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

    fn item_values(profile: &HiperdriveProfile, document: &ProfileDocument) -> ItemValues {
        items::item_values(profile, document)
    }

    fn profile_subject(profile: &HiperdriveProfile) -> ProfileSubject {
        let identity = &profile.identity;
        let category = identity.topology.map(Topology::category);
        let drives = identity.drives.iter().map(|drive| drive.name.as_str()).filter(|name| !name.is_empty());
        let mut parts: Vec<&str> = category.into_iter().chain(drives).collect();
        // A hub has several drives of the same type.
        parts.dedup();
        ProfileSubject {
            name: String::new(),
            device_type: parts.join(" · "),
            serial_number: identity.serial_number.clone(),
        }
    }

    fn report(
        profile: &HiperdriveProfile,
        document: &ProfileDocument,
        context: &ReportContext<'_>,
    ) -> Result<ReportContent, Text> {
        report::content(profile, document, context)
    }

    fn load_tables(_store: &Store) -> Self::Tables {}

    fn create(session: Session<Hiperdrive>, profile: Option<(&HiperdriveProfile, ())>, _: &mut Services) -> Self {
        let mut unit = HiperdriveDevice::from_session(session);
        if let Some((profile, ())) = profile {
            unit.adopt_profile(profile);
        }
        unit
    }

    fn secret_parameters() -> Vec<&'static str> {
        [LinkParameters::SECRETS, Config::SECRETS].concat()
    }
}
