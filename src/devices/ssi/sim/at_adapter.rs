//! The SSI encoder behind a virtual adapter, configured in the query of a `sim:` link.

use super::encoder::{Encoder, FrameSender};
use super::injected_fault::InjectedFault;
use crate::buses::bridge::sim::{AttachableKind, AttachedDevice};
use crate::expected::AllowedValues;
use crate::parameter::{ANY, Checked, OptionalValue, Parameters, Refused};
use crate::parameters;
use crate::sim::ConfigError;

pub const DELIVERED: &str = "atm60,code=gray";

parameters! {
    pub struct Settings: ConfigError {
        /// Family and settings of the encoder. A host that clocks a different number of bits receives a truncated
        /// frame, or zeros after the frame.
        encoder: Option<Encoder> = None,
            "ssi" => OptionalValue(Checked(AllowedValues::Family, Encoder::named)),
            "connect.ssi_layout" like "atm60,code=gray";
        /// Active error bits, and words sent instead of the frame, each with its interval in seconds
        /// (`ERRSYNC:0.5,ERRSI:4`, `safety-fault`).
        troubles: String = String::new(), "ssi-error" => ANY;
    }
}

#[derive(Clone, Debug)]
pub struct AtAdapter {
    /// Encoder to use if the settings name none, or `None` for the factory settings.
    encoder: Option<Encoder>,
}

impl AtAdapter {
    /// Adapter for an encoder with factory settings, unless the settings specify another one.
    pub const DELIVERED: AtAdapter = AtAdapter { encoder: None };

    /// Creates an adapter that uses the given encoder unless the settings name another.
    pub const fn with_default_encoder(encoder: Encoder) -> Self {
        AtAdapter { encoder: Some(encoder) }
    }
}

impl AttachableKind for AtAdapter {
    fn keys(&self) -> &'static [&'static str] {
        Settings::KEYS
    }

    fn attach_device(&self, pairs: &[(String, String)]) -> Result<Option<AttachedDevice>, ConfigError> {
        let Settings { encoder, troubles } = Settings::read(pairs)?;
        let own = encoder.or_else(|| self.encoder.clone()).or_else(|| Encoder::named(DELIVERED));
        let Some(encoder) = own else { return Ok(None) };
        let troubles = parse_faults(&troubles, &encoder)?;
        Ok(Some(AttachedDevice::Ssi(Box::new(FrameSender { encoder, troubles, transferred: None }))))
    }
}

fn parse_faults(value: &str, encoder: &Encoder) -> Result<Vec<InjectedFault>, Refused> {
    let allowed = || match InjectedFault::names(&encoder.layout) {
        own if own.is_empty() => AllowedValues::NoErrorBits,
        own => AllowedValues::ErrorBits(own),
    };
    let troubles = InjectedFault::read(value, &encoder.layout);
    troubles.ok_or_else(|| Refused::new("ssi-error", value, allowed()))
}
