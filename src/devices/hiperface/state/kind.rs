//! What the studio knows of HIPERFACE before there is a device.

use super::{Encoder, LinkForm};
use crate::app::services::Services;
use crate::app::session::{Drafted, ProfileFile, Session};
use crate::app::studio::SessionId;
use crate::app::{DeviceType, Severity, Text};
use crate::devices::hiperface::jobs::{self, check, encoder_types};
use crate::devices::hiperface::profile::HiperfaceProfile;
use crate::devices::hiperface::protocol::EncoderTypes;
use crate::devices::hiperface::state::explain as words;
use crate::link::LinkUrl;
use crate::profile::{Cause, Document};
use crate::store::{Store, StoreError};
use crate::worker::OpenError;

impl DeviceType for Encoder {
    const BUS: &'static str = "HIPERFACE";
    type Profile = HiperfaceProfile;
    type Form = LinkForm;
    type Tables = Result<EncoderTypes, StoreError>;

    fn check(url: &LinkUrl) -> Result<(), OpenError> {
        check(url)
    }

    fn may_have_other_master(url: &LinkUrl) -> bool {
        jobs::may_have_other_master(url)
    }

    fn explain(cause: &Cause) -> Option<Text> {
        words::refused(cause)
    }

    fn at_link(id: SessionId, url: LinkUrl, _services: &mut Services) -> Self {
        Encoder::with(Session::at_link(id, url))
    }

    fn tables(store: &Store) -> Self::Tables {
        encoder_types(store)
    }

    fn in_file(
        id: SessionId,
        file: ProfileFile,
        document: Document,
        tables: Self::Tables,
        services: &mut Services,
    ) -> Self {
        let types = tables.unwrap_or_else(|error| {
            services.tell(Severity::Warning, vec![words::store(&error)], None);
            EncoderTypes::built_in()
        });
        let profile = document.body.get::<HiperfaceProfile>();
        let fields = profile.map(|profile| profile.fields.clone()).unwrap_or_default();
        let identity = profile.map(|profile| crate::devices::hiperface::procedures::identity_of(profile, &types));
        let counter = profile.and_then(|profile| profile.recorded.counter);
        let mut encoder = Encoder::with(Session::in_file(id, file, document));
        if let Some(identity) = identity {
            encoder.identify(identity);
        }
        encoder.counter = counter;
        encoder.staged.refresh(fields);
        encoder.load_draft(services);
        encoder
    }
}
