//! Opening of streaming adapters. A `bridge:` link refers to a real adapter and a `sim:` link to a virtual one.

use std::sync::Arc;
use std::time::Duration;

use super::OpenAdapterFn;
use crate::buses::bridge::sim::{Adapter, AttachableKind};
use crate::link::line::MARGIN;
use crate::link::{Clock, LinkScheme, LinkUrl, UrlError};
use crate::parameter::{Keywords, OptionalValue, ParameterGroup};
use crate::parameters;
use crate::units::{Baud, CharacterFormat, Parity};
use crate::worker::OpenError;
use crate::worker::open::{connect_simulated, open_byte_stream, reply_margin, simulator_settings, wrong_target_error};

/// Link parameter that selects the virtual adapter. Streams do not need the parameter but accept it, because sessions
/// require it.
const BRIDGE: &str = "bridge";
/// Character format of the adapter's serial port. It matters only if a serial converter is in between.
pub(crate) const FORMAT: CharacterFormat = CharacterFormat { baud: Baud::B115200, parity: Parity::None };

parameters! {
    struct LinkParameters: UrlError {
        /// Additional time allowed for a reply. `None` selects the default of the link.
        margin: Option<Duration> = None, "margin" => OptionalValue(MARGIN);
    }
}

/// Returns the margin for late replies, and a function that opens the connection and may be called on any thread.
/// `devices` can be attached to a virtual adapter.
///
/// # Errors
/// Returns an error if the link does not refer to an adapter or a parameter is invalid. Nothing has been opened in this
/// case.
pub fn open_adapter(
    url: &LinkUrl,
    clock: Arc<dyn Clock>,
    devices: &[&dyn AttachableKind],
) -> Result<(Duration, OpenAdapterFn), OpenError> {
    if !matches!(url.scheme, LinkScheme::Sim | LinkScheme::Bridge) {
        return Err(wrong_target_error(url.scheme, "sim: and bridge:"));
    }
    let mut line = LinkParameters::KEYS.to_vec();
    if url.scheme == LinkScheme::Sim {
        url.query.read(BRIDGE, &Keywords(&[("on", ())]))?;
        line.push(BRIDGE);
    }
    let adapter = Adapter::from_pairs(&simulator_settings(url, &line, &[])?, devices)?;
    let late = LinkParameters::read(url.query.pairs())?.margin.unwrap_or(reply_margin(url.scheme));
    let url = url.clone();
    let open = move || open_byte_stream(&url, FORMAT, &clock, || Ok(connect_simulated(adapter, &clock)));
    Ok((late, Box::new(open)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::VirtualClock;

    fn opened(text: &str) -> Result<Duration, String> {
        let adapter = open_adapter(&text.parse().unwrap(), Arc::new(VirtualClock::default()), &[]);
        adapter.map(|(margin, _)| margin).map_err(|error| error.to_string())
    }

    #[test]
    fn opens_adapter_or_reports_reason() {
        for (text, milliseconds) in [
            ("sim:", 20),
            ("sim:?bridge=on&rpm=60&noise=0.1&margin=7", 7),
            ("bridge:/dev/ttyACM0", 100),
            ("bridge:tcp:host:4001?margin=2000", 2000),
        ] {
            assert_eq!(opened(text), Ok(Duration::from_millis(milliseconds)), "{text}");
        }
        for (text, why) in [
            (
                "serial:/dev/ttyUSB0",
                "serial: links cannot be used for this device; valid links begin with sim: and bridge:",
            ),
            ("tcp:host:1", "tcp: links cannot be used for this device; valid links begin with sim: and bridge:"),
            ("bridge:/dev/x?rpm=1", "rpm is not a parameter of bridge: links; valid parameters are margin"),
            ("bridge:/dev/x?margin=2001", "margin=2001 is not valid (allowed: a time in milliseconds from 0 to 2000)"),
            ("sim:?bridge=off", "bridge=off is not valid (allowed: on)"),
            ("sim:?rpm=NaN", "rpm"),
            ("sim:?what=1", "what"),
        ] {
            let error = opened(text).unwrap_err();
            assert!(error.contains(why), "{text}: {error}");
        }
    }
}
