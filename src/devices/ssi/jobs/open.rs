//! Opens a session with an SSI encoder from a link.

use std::sync::Arc;

use super::Ssi;
use crate::buses::bridge::jobs::FORMAT;
use crate::buses::bridge::sim::Adapter;
use crate::devices::ssi::procedures::{LinkParameters, Station};
use crate::kinds::attachable_kinds;
use crate::link::{Clock, LinkScheme, LinkUrl, RealClock};
use crate::store::Store;
use crate::worker::open::{connect_simulated, open_byte_stream, reply_margin, simulator_settings, wrong_target_error};
use crate::worker::{OpenError, Session};

/// Checks a link to an SSI encoder, without opening the link.
///
/// # Errors
/// Returns [`OpenError::Url`] or [`OpenError::Sim`] if a setting is invalid.
pub fn check_link(url: &LinkUrl) -> Result<(), OpenError> {
    read(url).map(|_| ())
}

/// Opens a link to an SSI encoder. The schemes are `bridge:` for an encoder behind an adapter, `sim:` for a virtual
/// encoder, and `replay:` for a recording.
///
/// # Errors
/// Returns an [`OpenError`] if the link cannot be opened. In this case, nothing has been sent.
pub fn open(url: &LinkUrl, store: Store) -> Result<Session<Ssi>, OpenError> {
    let (station, adapter) = read(url)?;
    let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
    let mut motor = None;
    // The serial format is only relevant for an adapter behind a converter. It is the same for all adapters.
    let wire = open_byte_stream(url, FORMAT, &clock, || {
        motor = Some(adapter.motor());
        Ok(connect_simulated(adapter, &clock))
    })?;
    Ok(Session::for_adapter(wire, clock, station, store, motor))
}

/// Parses the parameters of a link: the line settings, and the virtual adapter for a `sim:` link.
fn read(url: &LinkUrl) -> Result<(Station, Adapter), OpenError> {
    if !matches!(url.scheme, LinkScheme::Sim | LinkScheme::Bridge | LinkScheme::Replay) {
        return Err(wrong_target_error(url.scheme, "sim:, bridge:, replay:"));
    }
    let adapter = Adapter::from_pairs(&simulator_settings(url, LinkParameters::KEYS, &[])?, attachable_kinds())?;
    Ok((Station::from_query(&url.query, reply_margin(url.scheme))?, adapter))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opens_adapter_or_reports_reason() {
        for text in [
            "sim:",
            "sim:?ssi=atm60,code=gray&rpm=60&seed=7&fault=drop:0.01",
            "sim:?supply=switched&voltage=24&clock=1500000&pause=25&margin=7",
            "bridge:/dev/ttyACM0",
            "bridge:tcp:host:4001?margin=2000&voltage=5",
            "replay:words.trace?clock=1000000",
        ] {
            assert!(check_link(&text.parse().unwrap()).is_ok(), "{text}");
        }
        for (text, why) in [
            (
                "serial:/dev/ttyUSB0",
                "serial: links cannot be used for this device; valid links begin with sim:, bridge:, replay:",
            ),
            (
                "modbus:host",
                "modbus: links cannot be used for this device; valid links begin with sim:, bridge:, replay:",
            ),
            ("tcp:host:1", "tcp: links cannot be used for this device; valid links begin with sim:, bridge:, replay:"),
            (
                "bridge:/dev/x?rpm=1",
                "rpm is not a parameter of bridge: links; valid parameters are margin, clock, pause, voltage, leave-supply",
            ),
            ("bridge:/dev/x?layout=atm60", "layout is not a parameter of bridge: links"),
            ("bridge:/dev/x?clock=5", "clock=5 is not valid (allowed: a frequency in hertz from 80000 to 10000000)"),
            ("sim:?ssi=atm61", "`ssi=atm61` is not valid (allowed: a family of SSI encoders"),
            ("sim:?what=1", "a virtual adapter has no setting `what`"),
        ] {
            let error = check_link(&text.parse().unwrap()).unwrap_err().to_string();
            assert!(error.starts_with(why), "{text}: {error}");
        }
    }
}
