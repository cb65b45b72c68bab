//! Searches for encoders with unknown settings.
//!
//! The search listens for a second before it sends the first byte. If any bytes are received, a machine may be running,
//! and nothing is sent. The search sends 52h, because 50h would remove codes from an encoder's status queue. The
//! broadcast address is tried last, and only if the user states that a single encoder is connected, because several
//! encoders would reply at the same time.

use std::fmt;
use std::time::Duration;

use super::master::ExchangeFailure;
use super::{Error, Master};
use crate::devices::hiperface::protocol::{Answer, BAUDS, BROADCAST, DeviceAddress, Reply, Request, Timing, TypeLabel};
use crate::units::{Baud, CharacterFormat, Parity};

/// Time for which the search listens for traffic from a running machine.
pub const LISTEN_DURATION: Duration = Duration::from_secs(1);

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FindOptions {
    /// Whether the user has confirmed that exactly one encoder is connected. If no address replies, the broadcast
    /// address is then tried as well.
    pub one_encoder: bool,
    /// Maximum time to wait for the user to switch the encoder off and on again. After the restart, the encoder is
    /// searched for with its default settings.
    pub power_cycle: Option<Duration>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundEncoder {
    pub address: u8,
    pub format: CharacterFormat,
    pub label: TypeLabel,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SearchStep {
    Listening,
    DefaultWindow,
    Probing { address: u8, format: CharacterFormat },
}

impl fmt::Display for SearchStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SearchStep::Listening => f.write_str("listening to the bus"),
            SearchStep::DefaultWindow => f.write_str("waiting for the encoder to be switched on"),
            SearchStep::Probing { address, format } => write!(f, "{address:02X}h at {format}"),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SearchProgress<'a> {
    Trying {
        done: u64,
        total: u64,
        attempt: &'a SearchStep,
    },
    /// An encoder has replied. Each encoder is reported once.
    Found(&'a FoundEncoder),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EncoderSearchResult {
    /// Another device is sending on the line, so the search sent nothing.
    ForeignTraffic {
        /// Bytes received while listening.
        bytes: usize,
    },
    Searched {
        /// Encoders in the order in which they replied. The list may be empty.
        found: Vec<FoundEncoder>,
        /// Whether all combinations were tried. `false` means that the user cancelled the search.
        complete: bool,
    },
}

/// Tries all baud rates, parities and addresses, or only the addresses if the link cannot set the baud rate. The port
/// settings are restored at the end. If the user cancels, the encoders found so far are returned.
///
/// # Errors
/// Returns an error if the connection fails.
pub fn find(
    master: &mut Master<'_>,
    options: &FindOptions,
    watch: &mut dyn FnMut(SearchProgress<'_>),
) -> Result<EncoderSearchResult, Error> {
    let before = (master.station().address, master.station().format);
    let mut search = Search { found: Vec::new(), watch };
    let result = search.run(master, options);
    master.run_uncancellable(|master| {
        master.station().address = before.0;
        master.set_format(before.1)
    })?;
    match result {
        Ok(Some(bytes)) => Ok(EncoderSearchResult::ForeignTraffic { bytes }),
        Ok(None) => Ok(EncoderSearchResult::Searched { found: search.found, complete: true }),
        Err(Error::Cancelled) => Ok(EncoderSearchResult::Searched { found: search.found, complete: false }),
        Err(error) => Err(error),
    }
}

struct Search<'a> {
    found: Vec<FoundEncoder>,
    watch: &'a mut dyn FnMut(SearchProgress<'_>),
}

impl Search<'_> {
    /// Runs the search. If another device is sending, returns the number of bytes received from it instead.
    fn run(&mut self, master: &mut Master<'_>, options: &FindOptions) -> Result<Option<usize>, Error> {
        // A device server has a fixed format. Trying several formats would find the same encoder several times.
        let formats = if master.can_set_format() { formats_by_likelihood() } else { vec![master.station().format] };
        let per_format = 32 + u64::from(options.one_encoder);
        let total = 1 + per_format * formats.len() as u64;
        self.report_progress(0, total, &SearchStep::Listening);
        let heard = master.read_pending(LISTEN_DURATION)?;
        if !heard.is_empty() {
            return Ok(Some(heard.len()));
        }
        if let Some(patience) = options.power_cycle {
            self.report_progress(0, total, &SearchStep::DefaultWindow);
            let hit = search_in_default_window(master, patience, options.one_encoder)?;
            self.add_found_encoder(hit);
        }
        let mut done = 1;
        for format in formats {
            master.set_format(format)?;
            let found_before = self.found.len();
            let broadcast = options.one_encoder.then_some(BROADCAST);
            for address in DeviceAddress::all().map(DeviceAddress::byte).chain(broadcast) {
                self.report_progress(done, total, &SearchStep::Probing { address, format });
                done += 1;
                if address == BROADCAST && self.found.len() > found_before {
                    continue;
                }
                let hit = probe_address(master, address, format)?;
                self.add_found_encoder(hit);
            }
        }
        Ok(None)
    }

    fn report_progress(&mut self, done: u64, total: u64, attempt: &SearchStep) {
        (self.watch)(SearchProgress::Trying { done, total, attempt });
    }

    fn add_found_encoder(&mut self, hit: Option<FoundEncoder>) {
        if let Some(hit) = hit.filter(|hit| !self.found.contains(hit)) {
            (self.watch)(SearchProgress::Found(&hit));
            self.found.push(hit);
        }
    }
}

/// Returns the formats in order of likelihood: 9600 with each parity, then the other baud rates.
fn formats_by_likelihood() -> Vec<CharacterFormat> {
    let rest = BAUDS.into_iter().rev().filter(|baud| *baud != Baud::B9600);
    std::iter::once(Baud::B9600)
        .chain(rest)
        .flat_map(|baud| Parity::ALL.map(|parity| CharacterFormat { baud, parity }))
        .collect()
}

/// Sends a request with factory settings every tenth of a second until an encoder that was just switched on replies.
fn search_in_default_window(
    master: &mut Master<'_>,
    patience: Duration,
    broadcast: bool,
) -> Result<Option<FoundEncoder>, Error> {
    master.set_format(CharacterFormat::FACTORY)?;
    let address = if broadcast { BROADCAST } else { master.station().address };
    let end = master.now() + patience;
    while master.now() < end {
        if let Some(found) = probe_address(master, address, CharacterFormat::FACTORY)? {
            return Ok(Some(found));
        }
        master.wait(Timing::INITIALISATION)?;
    }
    Ok(None)
}

/// Sends a request, and sends it again if the reply is damaged, because even a damaged reply shows that a device is
/// present.
fn probe_address(master: &mut Master<'_>, address: u8, format: CharacterFormat) -> Result<Option<FoundEncoder>, Error> {
    master.station().address = address;
    for _ in 0..2 {
        match master.exchange_once(&Request::ReadTypeLabel)? {
            Ok(answered) => {
                let sender = answered.sender;
                return Ok(match answered.answer {
                    Answer::Reply { reply: Reply::TypeLabel(label), .. } => {
                        Some(FoundEncoder { address: sender, format, label })
                    }
                    _ => None,
                });
            }
            Err(ExchangeFailure::Silence { .. }) => return Ok(None),
            Err(ExchangeFailure::Damage(_)) => {}
        }
    }
    Ok(None)
}
