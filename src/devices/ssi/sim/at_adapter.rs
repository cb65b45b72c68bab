//! Virtual SSI encoder behind a virtual adapter. The query of a `sim:` link configures it.

use super::encoder::{Encoder, FrameSender};
use super::injected_fault::InjectedFault;
use crate::buses::bridge::sim::{AttachableKind, AttachedDevice};
use crate::expected::AllowedValues;
use crate::parameter::{ANY, CustomNotation, OptionalValue, ParameterGroup, RejectedParameter};
use crate::parameters;
use crate::sim::ConfigError;

pub const DEFAULT_ENCODER: &str = "atm60,code=gray";

parameters! {
    pub struct Settings: ConfigError {
        /// Family and settings of the encoder. A host that clocks fewer bits receives a part of the frame. A host that
        /// clocks more bits receives zeros after the frame.
        encoder: Option<Encoder> = None,
            "ssi" => OptionalValue(CustomNotation(AllowedValues::Family, Encoder::parse)),
            "connect.ssi_layout" like "atm60,code=gray";
        /// Active error bits, and words sent in place of the frame, such as `ERRSYNC:0.5,ERRSI:4` or `safety-fault`.
        /// The number is the interval in seconds.
        troubles: String = String::new(), "ssi-error" => ANY;
    }
}

#[derive(Clone, Debug)]
pub struct AttachableEncoder {
    /// Encoder to use if the settings do not name one, or `None` for the encoder with factory settings.
    encoder: Option<Encoder>,
}

impl AttachableEncoder {
    /// An adapter whose encoder has factory settings unless the link names another one.
    pub const DEFAULT_ADAPTER: AttachableEncoder = AttachableEncoder { encoder: None };

    /// Creates an adapter with the given encoder, which is used unless the link names another one.
    pub const fn with_default_encoder(encoder: Encoder) -> Self {
        AttachableEncoder { encoder: Some(encoder) }
    }
}

impl AttachableKind for AttachableEncoder {
    fn setting_names(&self) -> &'static [&'static str] {
        Settings::KEYS
    }

    fn attach_device(&self, pairs: &[(String, String)]) -> Result<Option<AttachedDevice>, ConfigError> {
        let Settings { encoder, troubles } = Settings::read(pairs)?;
        let own = encoder.or_else(|| self.encoder.clone()).or_else(|| Encoder::parse(DEFAULT_ENCODER));
        let Some(encoder) = own else { return Ok(None) };
        let troubles = parse_faults(&troubles, &encoder)?;
        Ok(Some(AttachedDevice::Ssi(Box::new(FrameSender { encoder, troubles, transferred: None }))))
    }
}

fn parse_faults(value: &str, encoder: &Encoder) -> Result<Vec<InjectedFault>, RejectedParameter> {
    let allowed = || match InjectedFault::setting_names(&encoder.layout) {
        own if own.is_empty() => AllowedValues::NoErrorBits,
        own => AllowedValues::ErrorBits(own),
    };
    let troubles = InjectedFault::read(value, &encoder.layout);
    troubles.ok_or_else(|| RejectedParameter::new("ssi-error", value, allowed()))
}
