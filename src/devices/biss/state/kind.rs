//! What the studio knows of BiSS before there is a device.

use std::sync::Arc;

use super::{BissForm, Encoder};
use crate::app::services::Services;
use crate::app::session::{Drafted, ProfileFile, Session};
use crate::app::studio::SessionId;
use crate::app::{DeviceType, Text};
use crate::devices::biss::jobs::{check, descriptions};
use crate::devices::biss::profile::BissProfile;
use crate::devices::biss::protocol::Descriptions;
use crate::devices::biss::state::explain;
use crate::link::LinkUrl;
use crate::profile::{Cause, Document};
use crate::store::Store;
use crate::worker::OpenError;

impl DeviceType for Encoder {
    const BUS: &'static str = "BiSS";
    type Profile = BissProfile;
    type Form = BissForm;
    type Tables = Descriptions;

    fn check(url: &LinkUrl) -> Result<(), OpenError> {
        check(url)
    }

    fn explain(cause: &Cause) -> Option<Text> {
        explain::entry(cause)
    }

    fn at_link(id: SessionId, url: LinkUrl, _services: &mut Services) -> Self {
        Encoder::with(Session::at_link(id, url))
    }

    fn tables(store: &Store) -> Self::Tables {
        descriptions(store).0
    }

    fn in_file(
        id: SessionId,
        file: ProfileFile,
        document: Document,
        tables: Self::Tables,
        services: &mut Services,
    ) -> Self {
        let mut encoder = Encoder::with(Session::in_file(id, file, document.clone()));
        if let Some(profile) = document.body.get::<BissProfile>() {
            let described = tables.named(&profile.identity.description).or_else(|| tables.iter().last()).cloned();
            encoder.describe(described.map(Arc::new));
            encoder.take_profile(profile);
        }
        encoder.load_draft(services);
        encoder
    }
}
