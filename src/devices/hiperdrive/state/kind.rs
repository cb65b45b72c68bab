//! HIPERDRIVE as a kind of device for the studio, before a device is open.

use super::staged::StagedEdits;
use super::{HiperdriveDevice, HiperdriveForm};
use crate::app::services::Services;
use crate::app::session::Session;
use crate::app::{DeviceType, Text};
use crate::devices::hiperdrive::jobs::{Hiperdrive, check_link};
use crate::devices::hiperdrive::procedures::LinkParameters;
use crate::devices::hiperdrive::profile::HiperdriveProfile;
use crate::devices::hiperdrive::protocol::DriveNumber;
use crate::devices::hiperdrive::sim::Config;
use crate::devices::hiperdrive::state::explain;
use crate::link::LinkUrl;
use crate::parameter::ParameterGroup as _;
use crate::profile::Cause;
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

    fn load_tables(_store: &Store) -> Self::Tables {}

    fn create(session: Session<Hiperdrive>, profile: Option<(&HiperdriveProfile, ())>, _: &mut Services) -> Self {
        let mut unit = HiperdriveDevice::from_session(session);
        if let Some((profile, ())) = profile {
            unit.staged = StagedEdits::for_profile(profile.image.clone());
            let drives = profile.identity.drives.iter();
            unit.staged.set_families(drives.filter_map(|own| Some((own.number, own.family()?))).collect());
            unit.drive = unit.drives().first().copied().unwrap_or(DriveNumber::FIRST);
        }
        unit
    }

    fn secret_parameters() -> Vec<&'static str> {
        [LinkParameters::SECRETS, Config::SECRETS].concat()
    }
}
