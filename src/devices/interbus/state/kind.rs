//! What the studio knows of INTERBUS before there is a device.

use super::staged::Staged;
use super::{Encoder, InterbusForm};
use crate::app::services::Services;
use crate::app::session::{Drafted, ProfileFile, Session};
use crate::app::studio::SessionId;
use crate::app::{DeviceType, Text};
use crate::devices::interbus::jobs::check;
use crate::devices::interbus::profile::InterbusProfile;
use crate::devices::interbus::state::explain;
use crate::link::LinkUrl;
use crate::profile::{Cause, Document};
use crate::store::Store;
use crate::worker::OpenError;

impl DeviceType for Encoder {
    const BUS: &'static str = "INTERBUS";
    type Profile = InterbusProfile;
    type Form = InterbusForm;
    type Tables = ();

    fn check(url: &LinkUrl) -> Result<(), OpenError> {
        check(url)
    }

    fn explain(cause: &Cause) -> Option<Text> {
        explain::entry(cause)
    }

    fn at_link(id: SessionId, url: LinkUrl, _services: &mut Services) -> Self {
        Encoder::with(Session::at_link(id, url), Staged::default())
    }

    fn tables(_store: &Store) -> Self::Tables {}

    fn in_file(id: SessionId, file: ProfileFile, document: Document, _tables: (), services: &mut Services) -> Self {
        let staged = match document.body.get::<InterbusProfile>() {
            Some(profile) => Staged::of_profile(profile.image.clone(), profile.names.clone()),
            None => Staged::default(),
        };
        let mut encoder = Encoder::with(Session::in_file(id, file, document), staged);
        encoder.load_draft(services);
        encoder
    }
}
