//! Tests of the control frame with published bit strings in both directions, with a connected host and encoder, and
//! with damaged bits.

use proptest::prelude::*;

use super::*;

/// Read requests as CDM bits in the order of transmission, from section 3 of the reference.
const READS: [(u8, &str); 11] = [
    (0x00, "11000000000001101010000000000000"),
    (0x05, "11000000010110011010000000000000"),
    (0x40, "11000100000000011010000000000000"),
    (0x42, "11000100001001111010000000000000"),
    (0x66, "11000110011000011010000000000000"),
    (0x68, "11000110100000001010000000000000"),
    (0x69, "11000110100100111010000000000000"),
    (0x6A, "11000110101001101010000000000000"),
    (0x6B, "11000110101101011010000000000000"),
    (0x6E, "11000110111010101010000000000000"),
    (0x7F, "11000111111111001010000000000000"),
];
const WRITES: [(u8, u8, &str); 10] = [
    (0x40, 0x01, "11000100000000010110000000111000"),
    (0x40, 0x02, "11000100000000010110000001010010"),
    (0x6B, 0x2A, "11000110101101010110010101010000"),
    (0x6A, 0x07, "11000110101001100110000011101100"),
    (0x6A, 0x00, "11000110101001100110000000011110"),
    (0x00, 0x02, "11000000000001100110000001010010"),
    (0x00, 0x03, "11000000000001100110000001110100"),
    (0x02, 0x00, "11000000001000000110000000011110"),
    (0x03, 0x80, "11000000001100110111000000000010"),
    (0x04, 0x01, "11000000010010100110000000111000"),
];
/// CDS bits for a read that returns 4Bh, from section 3 of the reference. The lock bits and the echoed R and W precede
/// the value, and P follows it.
const CDS_4B: &str = "010000000000000001010100101101100";

fn bits(text: &str) -> Vec<bool> {
    text.bytes().map(|byte| byte == b'1').collect()
}

fn text(bits: &[bool]) -> String {
    bits.iter().map(|bit| if *bit { '1' } else { '0' }).collect()
}

/// A line with a host, an encoder and the encoder's registers.
struct Line {
    host: Host,
    encoder: Encoder,
    registers: [u8; 128],
    /// Number of cycles that the encoder needs to provide a value.
    processing: u8,
    /// Bits on the line, starting with the first 1 that the host sends.
    cdm: Vec<bool>,
    cds: Vec<bool>,
    events: Vec<Event>,
    /// Index of the CDM bit to invert, counted from the start bit.
    flip_cdm: Option<usize>,
    flip_cds: Option<usize>,
}

impl Line {
    fn new(processing: u8) -> Self {
        let mut registers = [0; 128];
        registers.iter_mut().zip(0..).for_each(|(register, address)| *register = address ^ 0xA5);
        Line {
            host: Host::default(),
            encoder: Encoder::new(0),
            registers,
            processing,
            cdm: Vec::new(),
            cds: Vec::new(),
            events: Vec::new(),
            flip_cdm: None,
            flip_cds: None,
        }
    }

    /// Replaces the encoder with an idle one that has the given number.
    fn attach(&mut self, slave: u8) {
        self.encoder = Encoder::new(slave);
        (0..REST_CYCLES).for_each(|_| assert_eq!(self.encoder.receive_cdm(false), None));
    }

    fn ask(&mut self, request: Request) -> Result<Vec<u8>, ControlError> {
        (self.cdm, self.cds) = (Vec::new(), Vec::new());
        self.host.submit(request).unwrap();
        let mut pending: Option<(u8, u8)> = None;
        for _ in 0..5_000 {
            if let Some((address, 0)) = pending {
                self.encoder.provide_value(self.registers[usize::from(address)]);
                pending = None;
            }
            pending = pending.map(|(address, cycles)| (address, cycles - 1));
            let cycle = self.cds.len();
            let cds = self.encoder.next_cds() ^ (self.flip_cds == Some(cycle));
            let step = self.host.run_cycle(cds);
            if step.cdm || !self.cdm.is_empty() {
                self.cds.push(cds);
                self.cdm.push(step.cdm);
            }
            let cdm = step.cdm ^ (!self.cdm.is_empty() && self.flip_cdm == Some(cycle));
            let event = self.encoder.receive_cdm(cdm);
            match event {
                Some(Event::Read { address }) => pending = Some((address, self.processing)),
                Some(Event::Write { address, value }) => self.registers[usize::from(address)] = value,
                Some(Event::Damaged) | None => {}
            }
            self.events.extend(event);
            if let Some(outcome) = step.outcome {
                return outcome;
            }
        }
        panic!("the host never ends");
    }
}

#[test]
fn published_reads_match() {
    for (address, cdm) in READS {
        let mut line = Line::new(0);
        let value = line.registers[usize::from(address)];
        assert_eq!(line.ask(Request::read(0, address, 1).unwrap()), Ok(vec![value]), "{address:02X}");
        assert_eq!(text(&line.cdm), cdm, "{address:02X}");
        assert_eq!(line.events, [Event::Read { address }]);
    }
}

#[test]
fn published_writes_match() {
    for (address, value, cdm) in WRITES {
        let mut line = Line::new(0);
        assert_eq!(line.ask(Request::write(0, address, &[value]).unwrap()), Ok(vec![value]), "{address:02X}");
        assert_eq!(text(&line.cdm), cdm, "{address:02X}");
        assert_eq!(line.events, [Event::Write { address, value }]);
        assert_eq!(line.registers[usize::from(address)], value);
    }
}

/// Encoder and host are tested separately, each with the published bits of the other side.
#[test]
fn published_reply_matches() {
    let (_, cdm) = READS[4];
    let mut encoder = Encoder::new(0);
    (0..REST_CYCLES).for_each(|_| assert!(!encoder.next_cds() && encoder.receive_cdm(false).is_none()));
    let mut cds = Vec::new();
    for bit in bits(cdm) {
        cds.push(encoder.next_cds());
        if encoder.receive_cdm(bit) == Some(Event::Read { address: 0x66 }) {
            encoder.provide_value(0x4B);
        }
    }
    cds.push(encoder.next_cds());
    assert_eq!(text(&cds), CDS_4B);

    let mut host = Host::default();
    host.submit(Request::read(0, 0x66, 1).unwrap()).unwrap();
    (0..REST_CYCLES).for_each(|_| assert_eq!(host.run_cycle(false), Step { cdm: false, outcome: None }));
    let steps: Vec<Step> = bits(CDS_4B)[..32].iter().map(|bit| host.run_cycle(*bit)).collect();
    assert_eq!(text(&steps.iter().map(|step| step.cdm).collect::<Vec<_>>()), cdm);
    assert!(steps[..31].iter().all(|step| step.outcome.is_none()));
    assert_eq!(steps[31].outcome, Some(Ok(vec![0x4B])));
}

#[test]
fn reads_and_writes_consecutive_registers() {
    let mut line = Line::new(0);
    let read = line.ask(Request::read(0, 0x78, 8).unwrap());
    assert_eq!(read, Ok(vec![0xDD, 0xDC, 0xDF, 0xDE, 0xD9, 0xD8, 0xDB, 0xDA]));
    assert_eq!(line.cdm.len(), 32 + 7 * 13, "thirteen cycles for each further register");
    assert_eq!(line.ask(Request::write(0, 0x02, &[0x00, 0x80, 0x01]).unwrap()), Ok(vec![0x00, 0x80, 0x01]));
    assert_eq!(line.registers[2..5], [0x00, 0x80, 0x01]);
}

#[test]
fn encoder_may_delay_host() {
    for processing in [1, 13, 14, 50] {
        let mut line = Line::new(processing);
        assert_eq!(line.ask(Request::read(0, 0x66, 2).unwrap()), Ok(vec![0xC3, 0xC2]), "{processing} cycles");
        assert_eq!(line.cdm.len(), 32 + 13 + 2 * usize::from(processing));
    }
    let mut line = Line::new(51);
    assert_eq!(line.ask(Request::read(0, 0x66, 1).unwrap()), Err(ControlError::TimeOut(0x66)));
    line.processing = 0;
    assert_eq!(line.ask(Request::read(0, 0x66, 1).unwrap()), Ok(vec![0xC3]), "and it goes on after that");
}

#[test]
fn ignores_unknown_slaves_and_corrupt_requests() {
    let mut line = Line::new(0);
    assert_eq!(line.ask(Request::read(3, 0x66, 1).unwrap()), Err(ControlError::NoSlave(3)));
    line.attach(3);
    assert_eq!(line.ask(Request::read(3, 0x66, 1).unwrap()), Ok(vec![0xC3]));
    assert_eq!(line.ask(Request::read(0, 0x66, 1).unwrap()), Err(ControlError::NoSlave(0)));
    // The encoder does not reply to a head with a damaged checksum.
    line.attach(0);
    line.flip_cdm = Some(14);
    assert_eq!(line.ask(Request::read(0, 0x66, 1).unwrap()), Err(ControlError::Rejected(0x66)));
    assert_eq!(line.events.last(), Some(&Event::Damaged));
}

#[test]
fn ignores_command() {
    let mut encoder = Encoder::new(0);
    (0..REST_CYCLES).for_each(|_| assert_eq!(encoder.receive_cdm(false), None));
    // The bits are S, CTS = 0, CMD 01 and CRC4 C. The bits after them would read a register, but no register is
    // accessed.
    for bit in bits("1000000000011100101000000000000") {
        encoder.next_cds();
        assert_eq!(encoder.receive_cdm(bit), None);
    }
}

/// After fourteen zeros, the line is idle, whatever was sent before.
#[test]
fn fourteen_zeros_reset_line() {
    let (_, _, write) = WRITES[2];
    for cut in 0..=write.len() {
        let mut line = Line::new(0);
        (0..REST_CYCLES).for_each(|_| assert_eq!(line.encoder.receive_cdm(false), None));
        for bit in &bits(write)[..cut] {
            line.encoder.next_cds();
            line.encoder.receive_cdm(*bit);
        }
        // The host aborts the write here and sends another request.
        let read = line.ask(Request::read(0, 0x66, 1).unwrap());
        assert_eq!(read, Ok(vec![0xC3]), "cut at {cut}");
    }
    let mut encoder = Encoder::new(0);
    (0..REST_CYCLES - 1).for_each(|_| assert_eq!(encoder.receive_cdm(false), None));
    encoder.receive_cdm(true);
    assert!(!encoder.next_cds(), "thirteen are too few");
}

#[test]
fn aborted_request_leaves_host_ready() {
    let mut host = Host::default();
    host.submit(Request::read(0, 0x66, 1).unwrap()).unwrap();
    assert!(host.submit(Request::read(0, 0x67, 1).unwrap()).is_err());
    (0..20).for_each(|_| drop(host.run_cycle(true)));
    host.abandon();
    assert!(!host.is_busy());
    host.submit(Request::read(0, 0x40, 1).unwrap()).unwrap();
    (0..REST_CYCLES).for_each(|_| assert!(!host.run_cycle(false).cdm));
    assert!(host.run_cycle(false).cdm);
}

/// A flipped bit never causes a wrong value to be read or written.
#[test]
fn detects_any_single_flipped_bit() {
    let read = || Request::read(0, 0x66, 1).unwrap();
    for cycle in 0..32 {
        let mut line = Line::new(0);
        line.flip_cds = Some(cycle);
        let read = line.ask(read());
        // The lock bits of other encoders and the zeros after them contain no data.
        let carries_nothing = matches!(cycle, 0 | 2..=16);
        assert_eq!(read.is_ok(), carries_nothing, "CDS {cycle}: {read:?}");
        assert!(read.is_err() || read == Ok(vec![0xC3]), "CDS {cycle}");
    }
    for cycle in 0..31 {
        let mut line = Line::new(0);
        let before = line.registers;
        line.flip_cdm = Some(cycle);
        let written = line.ask(Request::write(0, 0x6B, &[0x2A]).unwrap());
        assert!(written.is_err(), "CDM {cycle}: {written:?}");
        assert_eq!(line.registers, before, "CDM {cycle}");
        assert!(!line.events.iter().any(|event| matches!(event, Event::Write { .. })), "CDM {cycle}");
    }
}

#[test]
fn rejects_impossible_requests() {
    assert_eq!(Request::read(8, 0, 1), Err(RequestError::Slave(8)));
    assert_eq!(Request::read(0, 0x80, 1), Err(RequestError::Range { address: 0x80, count: 1 }));
    assert_eq!(Request::read(0, 0x7F, 2), Err(RequestError::Range { address: 0x7F, count: 2 }));
    assert_eq!(Request::read(0, 0, 0), Err(RequestError::Range { address: 0, count: 0 }));
    assert_eq!(Request::write(0, 0, &[0; 129]), Err(RequestError::Range { address: 0, count: 129 }));
    assert!(Request::read(7, 0, 128).is_ok());
}

proptest! {
    #[test]
    fn written_registers_read_back(
        address in 0u8..0x80, values in proptest::collection::vec(any::<u8>(), 1..20), processing in 0u8..=50,
    ) {
        let values: Vec<u8> = values.into_iter().take(0x80 - usize::from(address)).collect();
        let mut line = Line::new(processing);
        prop_assert_eq!(line.ask(Request::write(0, address, &values).unwrap()), Ok(values.clone()));
        let count = values.len() as u8;
        prop_assert_eq!(line.ask(Request::read(0, address, count).unwrap()), Ok(values));
    }

    #[test]
    fn noise_never_panics(noise in proptest::collection::vec(any::<bool>(), 0..400)) {
        let (mut host, mut encoder) = (Host::default(), Encoder::new(0));
        for bit in noise {
            if !host.is_busy() {
                let _ = host.submit(Request::read(0, 0x40, 3).unwrap());
            }
            host.run_cycle(bit);
            encoder.next_cds();
            if let Some(Event::Read { .. }) = encoder.receive_cdm(bit) {
                encoder.provide_value(7);
            }
        }
    }
}
