//! An unknown encoder on an adapter: the program has no description of it, and its frames have other widths.

use std::collections::BTreeMap;

use encoder_studio::buses::bridge::protocol::{
    BissStatus, Capabilities, ErrorCode, Hello, Message, Receiver, Reply, Request,
};
use encoder_studio::devices::biss::procedures::{self as device, Error, FrameSource, Station};
use encoder_studio::devices::biss::protocol::{Crc, Descriptions, Layout, PositionData};
use encoder_studio::sim::ByteDevice;
use encoder_studio::units::{CharacterFormat, Moment};

use super::support::{Bus, Rig, Transport};
use crate::support::MARGIN;

/// An adapter with a 14-bit singleturn encoder, which replies immediately.
struct UnknownEncoder {
    layout: Layout,
    /// Number of steps between two frames.
    step: u32,
    place: u32,
    clocked: u8,
    direct: BTreeMap<u8, u8>,
    receiver: Receiver,
    inbox: Vec<u8>,
}

impl UnknownEncoder {
    fn new(step: u32) -> Self {
        let crc = Crc::new(Crc::POSITION, 0, true).ok();
        let manufacturer = [(0x7E, b'X'), (0x7F, b'y')];
        UnknownEncoder {
            layout: Layout::new(0, 14, true, true, crc).unwrap(),
            step,
            place: 100,
            clocked: 0,
            direct: manufacturer.into_iter().collect(),
            receiver: Receiver::default(),
            inbox: Vec::new(),
        }
    }

    fn answer(&mut self, request: Request) -> Message {
        Message::Reply(match request {
            Request::Hello => Reply::Hello(Hello {
                capabilities: Capabilities::BISS.union(Capabilities::BISS_REGISTERS),
                max_clock_hz: 1_000_000,
                max_sample_hz: 0,
                name: "test".to_owned(),
                serial: String::new(),
                firmware: String::new(),
            }),
            Request::BissConfig { clock_hz, data_bits, crc_bits, .. } => {
                self.clocked = data_bits + crc_bits;
                Reply::BissConfig { clock_hz }
            }
            Request::BissRead => {
                self.place = (self.place + self.step) % (1 << 14);
                let reading = PositionData { singleturn: self.place, ..PositionData::default() };
                // After the end of the frame, the line is low.
                let bits = self.layout.bits();
                let frame = u128::from(self.layout.emit(&reading)) << 64 >> bits >> (64 - self.clocked);
                Reply::BissRead { t_us: 0, status: BissStatus::OK, raw: frame as u64 }
            }
            Request::BissRegisterRead { address, .. } => {
                Reply::BissRegisterRead { value: self.direct.get(&address).copied().unwrap_or(0) }
            }
            other => {
                let (op, text) = (other.operation().byte(), String::new());
                return Message::Error { op, code: ErrorCode::NOT_SUPPORTED, text };
            }
        })
    }
}

impl ByteDevice for UnknownEncoder {
    fn on_bytes(&mut self, _now: Moment, bytes: &[u8]) {
        self.receiver.push(bytes);
        while let Some(packet) = self.receiver.next_packet() {
            let message = self.answer(Request::parse(&packet).unwrap());
            self.inbox.extend(message.emit(packet.seq).emit());
        }
    }

    fn poll(&mut self, _now: Moment) -> Vec<u8> {
        std::mem::take(&mut self.inbox)
    }

    fn poll_at(&self) -> Option<Moment> {
        None
    }

    fn set_host_format(&mut self, _now: Moment, _format: CharacterFormat) {}

    fn connect(&mut self, _now: Moment) {}
}

#[test]
fn finds_frame_while_turning() {
    let mut rig = Rig::with(UnknownEncoder::new(5), Transport::Adapter);
    let identity = device::identify(&mut rig.master(), &Descriptions::built_in()).unwrap();
    assert_eq!(identity.description.name(), "BiSS C encoder");
    assert_eq!((identity.source, identity.layout.data_bits(), identity.layout.bits()), (FrameSource::Checksum, 16, 22));
    assert_eq!(
        (identity.multiturn_bits(), identity.singleturn_bits()),
        (None, None),
        "what of it are turns is not told"
    );
    assert_eq!((identity.mismatch, identity.data_sheet), (None, None));
    let reading = rig.master().position().unwrap();
    assert_eq!((reading.turns, reading.steps), (0, rig.device().place));
    assert_eq!(
        (reading.is_split_known, reading.angle_degrees()),
        (false, None),
        "raw, until somebody says what a turn is"
    );
    assert_eq!((reading.error, reading.warning), (Some(false), Some(false)));
}

#[test]
fn survey_works_without_frame_at_rest() {
    let mut rig = Rig::with(UnknownEncoder::new(0), Transport::Adapter);
    let survey = device::read_all_registers(&mut rig.master(), &Descriptions::built_in(), &mut |_, _, _| {}).unwrap();
    assert_eq!((survey.identity.source, survey.status.position), (FrameSource::Assumed, None));
    assert_eq!(survey.identity.kind.manufacturer, *b"Xy");
    let error = rig.master().position().unwrap_err();
    assert!(matches!(error, Error::WrongWidths { data_bits: 35, crc_bits: 6, .. }), "{error}");
}

/// The user enters the numbers of turns and steps, even for a shaft at rest. 14 bits are 16384 steps per turn (issue
/// 22.20).
#[test]
fn given_frame_converts_positions_to_angles() {
    let mut rig = Rig::with(UnknownEncoder::new(0), Transport::Adapter);
    rig.station = Station::from_query(&"mt=0&st=14".parse().unwrap(), Transport::Adapter, MARGIN).unwrap();
    let identity = device::identify(&mut rig.master(), &Descriptions::built_in()).unwrap();
    assert_eq!((identity.source, identity.layout.bits()), (FrameSource::Given, 22));
    assert_eq!((identity.multiturn_bits(), identity.singleturn_bits()), (Some(0), Some(14)));
    let reading = rig.master().position().unwrap();
    assert_eq!((reading.steps, reading.angle_degrees()), (100, Some(100.0 * 360.0 / 16384.0)));
    // A kit encoder reports its frame format itself.
    let mut kit = Bus::new("");
    kit.station.given = Layout::new(0, 14, true, true, None).ok();
    let identity = device::identify(&mut kit.master(), &Descriptions::built_in()).unwrap();
    assert_eq!((identity.source, identity.layout.bits()), (FrameSource::DataSheet, 41));
}
