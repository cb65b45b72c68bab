//! The host's side of the control frame.

use super::super::crc::crc4;
use super::{ControlError, MAX_WAIT_CYCLES, REST_CYCLES, Request};

/// The host's side of the control channel. Call [`run_cycle`](Self::run_cycle) once per cycle. Requests are processed
/// one at a time, and the line is idle in between.
#[derive(Clone, Debug)]
pub struct Host {
    /// Number of consecutive cycles with CDM = 0. The counter saturates.
    zeros: u8,
    waiting: Option<Request>,
    state: State,
}

/// The result of one cycle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// CDM bit of the cycle. During the time-out, the clock line carries the inverse of this bit.
    pub cdm: bool,
    /// Result of the request, if it ended in this cycle: the values read, or the values that the encoder echoed during
    /// a write.
    pub outcome: Option<Result<Vec<u8>, ControlError>>,
}

#[derive(Clone, Debug)]
enum State {
    Rest,
    /// Sending the head in cycles 0 to 18. `bits` holds the CDM bits, and bit 18 is sent first.
    Head {
        request: Request,
        bits: u32,
        cycle: u8,
    },
    /// Waiting for the encoder's start bit S. Meanwhile, the host repeats its own start bit.
    Start {
        transfer: Transfer,
        cycles: u8,
    },
    /// Transferring DATA and CRC4. `received` bits have arrived.
    Data {
        transfer: Transfer,
        word: u16,
        received: u8,
    },
}

#[derive(Clone, Debug)]
struct Transfer {
    request: Request,
    values: Vec<u8>,
}

impl Transfer {
    fn address(&self) -> u8 {
        self.request.address.saturating_add(u8::try_from(self.values.len()).unwrap_or(u8::MAX))
    }

    /// Returns the DATA or CRC4 bit that the host sends at index `at`, counted from the first bit sent.
    fn bit(&self, at: u8) -> bool {
        self.request.data(self.values.len()) << at & 0x800 != 0
    }
}

impl Default for Host {
    fn default() -> Self {
        Host { zeros: 0, waiting: None, state: State::Rest }
    }
}

impl Host {
    /// Last cycle of a request's head. The encoder may send its start bit S in the next cycle.
    const LAST_HEAD_CYCLE: u8 = 18;
    const WORD_BITS: u8 = 12;

    /// Submits a request, which is sent as soon as the line is idle.
    ///
    /// # Errors
    /// Returns the given request as an error if another one is in progress.
    pub fn submit(&mut self, request: Request) -> Result<(), Request> {
        if self.is_busy() {
            return Err(request);
        }
        self.waiting = Some(request);
        Ok(())
    }

    /// Returns whether a request is in progress.
    pub fn is_busy(&self) -> bool {
        self.waiting.is_some() || !matches!(self.state, State::Rest)
    }

    /// Abandons the request. The encoder discards it when it receives the zeros before the next request.
    pub fn abandon(&mut self) {
        self.waiting = None;
        self.reset_to_rest();
    }

    /// Runs one cycle with the received CDS bit and returns the CDM bit that ends the cycle.
    pub fn run_cycle(&mut self, cds: bool) -> Step {
        let step = match std::mem::replace(&mut self.state, State::Rest) {
            State::Rest => self.begin_request(),
            State::Head { request, bits, cycle } => self.send_head(request, bits, cycle, cds),
            State::Start { transfer, cycles } => self.start(transfer, cycles, cds),
            State::Data { transfer, word, received } => self.data(transfer, word << 1 | u16::from(cds), received + 1),
        };
        self.zeros = if step.cdm { 0 } else { self.zeros.saturating_add(1) };
        step
    }

    fn begin_request(&mut self) -> Step {
        if self.zeros < REST_CYCLES {
            return Step { cdm: false, outcome: None };
        }
        match self.waiting.take() {
            None => Step { cdm: false, outcome: None },
            Some(request) => {
                let bits = head_bits(&request);
                self.state = State::Head { request, bits, cycle: 1 };
                Step { cdm: true, outcome: None }
            }
        }
    }

    fn send_head(&mut self, request: Request, bits: u32, cycle: u8, cds: bool) -> Step {
        // The bit that the encoder must send in this cycle, if known.
        let expected = match cycle {
            17 => Some(request.is_read()),
            18 => Some(!request.is_read()),
            _ => None,
        };
        if cycle == request.slave + 1 && !cds {
            return self.fail_request(ControlError::NoSlave(request.slave));
        }
        if expected.is_some_and(|expected| expected != cds) {
            return self.fail_request(ControlError::Rejected(request.address));
        }
        let cdm = bits >> (Self::LAST_HEAD_CYCLE - cycle) & 1 == 1;
        self.state = if cycle < Self::LAST_HEAD_CYCLE {
            State::Head { request, bits, cycle: cycle + 1 }
        } else {
            State::Start { transfer: Transfer { request, values: Vec::new() }, cycles: 0 }
        };
        Step { cdm, outcome: None }
    }

    fn start(&mut self, transfer: Transfer, cycles: u8, cds: bool) -> Step {
        if !cds && cycles >= MAX_WAIT_CYCLES {
            return self.fail_request(ControlError::TimeOut(transfer.address()));
        }
        if !cds {
            self.state = State::Start { transfer, cycles: cycles + 1 };
            return Step { cdm: true, outcome: None };
        }
        let cdm = transfer.bit(0);
        self.state = State::Data { transfer, word: 0, received: 0 };
        Step { cdm, outcome: None }
    }

    fn data(&mut self, mut transfer: Transfer, word: u16, received: u8) -> Step {
        if received < Self::WORD_BITS {
            let cdm = transfer.bit(received);
            self.state = State::Data { transfer, word, received };
            return Step { cdm, outcome: None };
        }
        let [value, got] = [(word >> 4) as u8, (word & 0xF) as u8];
        let expected = crc4(value.into(), 8);
        if got != expected {
            return self.fail_request(ControlError::Crc { address: transfer.address(), expected, got });
        }
        transfer.values.push(value);
        if transfer.values.len() < transfer.request.count() {
            self.state = State::Start { transfer, cycles: 0 };
            return Step { cdm: true, outcome: None };
        }
        self.reset_to_rest();
        Step { cdm: false, outcome: Some(Ok(transfer.values)) }
    }

    fn fail_request(&mut self, error: ControlError) -> Step {
        self.reset_to_rest();
        Step { cdm: false, outcome: Some(Err(error)) }
    }

    /// Restarts the count of zeros before the next request, because earlier zeros may have been data.
    fn reset_to_rest(&mut self) {
        self.state = State::Rest;
        self.zeros = 0;
    }
}

/// Returns the head of a request: S, CTS, ID, ADR, CRC4, R, W and S.
fn head_bits(request: &Request) -> u32 {
    let header = 1 << 10 | u16::from(request.slave) << 7 | u16::from(request.address);
    let access = if request.is_read() { 0b10 } else { 0b01 };
    1 << 18 | u32::from(header) << 7 | u32::from(crc4(header, 11)) << 3 | access << 1 | 1
}
