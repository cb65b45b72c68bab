//! What the studio knows of HIPERDRIVE before there is a device.

use super::staged::Staged;
use super::{HiperdriveForm, Unit};
use crate::app::services::Services;
use crate::app::session::{Drafted, ProfileFile, Session};
use crate::app::studio::SessionId;
use crate::app::{DeviceType, Text};
use crate::devices::hiperdrive::jobs::check;
use crate::devices::hiperdrive::profile::HiperdriveProfile;
use crate::devices::hiperdrive::protocol::DriveNumber;
use crate::devices::hiperdrive::state::explain;
use crate::link::LinkUrl;
use crate::profile::{Cause, Document};
use crate::store::Store;
use crate::worker::OpenError;

impl DeviceType for Unit {
    const BUS: &'static str = "HIPERDRIVE";
    type Profile = HiperdriveProfile;
    type Form = HiperdriveForm;
    type Tables = ();

    fn check(url: &LinkUrl) -> Result<(), OpenError> {
        check(url)
    }

    fn explain(cause: &Cause) -> Option<Text> {
        explain::entry(cause)
    }

    fn at_link(id: SessionId, url: LinkUrl, _services: &mut Services) -> Self {
        Unit::with(Session::at_link(id, url), Staged::default())
    }

    fn tables(_store: &Store) -> Self::Tables {}

    fn in_file(id: SessionId, file: ProfileFile, document: Document, _tables: (), services: &mut Services) -> Self {
        let staged = match document.body.get::<HiperdriveProfile>() {
            Some(profile) => {
                let mut staged = Staged::of_profile(profile.image.clone());
                let drives = profile.identity.drives.iter();
                staged.know(drives.filter_map(|own| Some((own.number, own.family()?))).collect());
                staged
            }
            None => Staged::default(),
        };
        let mut unit = Unit::with(Session::in_file(id, file, document), staged);
        unit.drive = unit.drives().first().copied().unwrap_or(DriveNumber::FIRST);
        unit.load_draft(services);
        unit
    }
}
