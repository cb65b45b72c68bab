//! The SSI encoder behind a virtual adapter, as the query of a `sim:` link gives it.

use super::encoder::{Encoder, Sending};
use super::trouble::Trouble;
use crate::buses::bridge::sim::{Attachable, Attached};
use crate::expected::Expected;
use crate::sim::ConfigError;
use crate::sim::setting::Setting;

/// The SSI frame of an encoder that nothing else is said of: 12 bits of turns, 13 within one.
pub const DELIVERED: &str = "atm60,code=gray";

const FAMILY: &str = "ssi";
const TROUBLES: &str = "ssi-error";

/// An SSI encoder on the shaft at an adapter.
///
/// | key | value |
/// |---|---|
/// | `ssi` | family and settings of the SSI encoder, `atm60,code=gray`; a host that clocks otherwise gets its frame cut off, or zeros behind it |
/// | `ssi-error` | error bits of its frame that speak and words that it sends instead (`ERRSYNC:0.5,ERRSI:4`, `safety-fault`), each with the seconds after which it happens again |
#[derive(Clone, Debug)]
pub struct AtAdapter {
    /// Where the settings name none; none: as delivered.
    encoder: Option<Encoder>,
}

impl AtAdapter {
    /// The encoder as delivered, where the settings name no other.
    pub const DELIVERED: AtAdapter = AtAdapter { encoder: None };

    /// This encoder, where the settings name no other.
    pub const fn sending(encoder: Encoder) -> Self {
        AtAdapter { encoder: Some(encoder) }
    }
}

impl Attachable for AtAdapter {
    fn keys(&self) -> &'static [&'static str] {
        &[FAMILY, TROUBLES]
    }

    fn attached(&self, pairs: &[(String, String)]) -> Result<Option<Attached>, ConfigError> {
        let mut encoder = self.encoder.clone().or_else(|| Encoder::named(DELIVERED));
        let mut troubles = "";
        for (key, value) in pairs {
            let setting = Setting { key, value };
            if key == TROUBLES {
                troubles = value;
            } else {
                encoder = Some(Encoder::named(value).ok_or_else(|| setting.refused(Expected::Family))?);
            }
        }
        let Some(encoder) = encoder else { return Ok(None) };
        let troubles = read_troubles(troubles, &encoder)?;
        Ok(Some(Attached::Ssi(Box::new(Sending { encoder, troubles, transferred: None }))))
    }
}

fn read_troubles(value: &str, encoder: &Encoder) -> Result<Vec<Trouble>, ConfigError> {
    let allowed = || match Trouble::names(&encoder.layout) {
        own if own.is_empty() => Expected::NoErrorBits,
        own => Expected::ErrorBits(own),
    };
    let troubles = Trouble::read(value, &encoder.layout);
    troubles.ok_or_else(|| Setting { key: TROUBLES, value }.refused(allowed()))
}
