//! Tests of the target with packets from the reference and packets composed by hand. Inputs and expected outputs are
//! bytes.

mod any;
mod connections;
mod explicit;
mod faults;

use std::net::{Ipv4Addr, SocketAddrV4};
use std::time::Duration;

use super::Target;
use crate::bits::{hex, parse_hex};
use crate::devices::hiperdrive::sim::Config;
use crate::sim::setting::query_pairs;
use crate::sim::{ByteDevice, DatagramDevice};
use crate::units::Moment;

/// An originator with a TCP connection and a UDP port.
struct Host {
    target: Target,
    now: Moment,
    session: u32,
}

const PEER: Ipv4Addr = Ipv4Addr::new(10, 0, 0, 7);
const FROM: SocketAddrV4 = SocketAddrV4::new(PEER, 40000);
const REGISTER: &str = "65 00 04 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 01 00 00 00";
/// ForwardOpen from the reference (section 9), with an interval of 10 ms and parameter words.
const OPEN: &str = "54 02 20 06 24 01 03 FA 00 00 00 00 01 00 01 00 01 00 34 12 CD AB 00 00 01 00 00 00 10 27 00 00 16 48 \
                    10 27 00 00 12 48 01 04 20 04 24 68 2C 64 2C 65";
const OPENED: &str = "D4 00 00 00 01 00 02 00 01 00 01 00 01 00 34 12 CD AB 00 00 10 27 00 00 10 27 00 00 00 00";
const CLOSE: &str = "4E 02 20 06 24 01 03 FA 01 00 34 12 CD AB 00 00 04 00 20 04 24 68 2C 64 2C 65";

fn bytes(text: &str) -> Vec<u8> {
    parse_hex(text).unwrap()
}

fn config(query: &str) -> Config {
    Config::from_pairs(&query_pairs(query)).unwrap()
}

/// Builds a frame in which status, context and options are 0.
fn frame(command: u16, session: u32, data: &[u8]) -> Vec<u8> {
    let length = u16::try_from(data.len()).unwrap();
    [&command.to_le_bytes()[..], &length.to_le_bytes(), &session.to_le_bytes(), &[0; 16], data].concat()
}

/// Builds the data of a SendRRData frame: interface, time-out, and two items.
fn unconnected(message: &[u8]) -> Vec<u8> {
    let length = u16::try_from(message.len()).unwrap();
    [&bytes("00 00 00 00 00 00 02 00 00 00 00 00 B2 00")[..], &length.to_le_bytes(), message].concat()
}

impl Host {
    /// Creates a host with an open TCP connection but no session.
    fn bare(query: &str) -> Self {
        let target = Target::new(&config(query)).connect_from(PEER);
        Host { target, now: Moment::START, session: 0 }
    }

    fn new(query: &str) -> Self {
        let mut host = Host::bare(query);
        host.register();
        host
    }

    fn register(&mut self) {
        let reply = self.bytes(&bytes(REGISTER));
        self.session = u32::from_le_bytes(reply[4..8].try_into().unwrap());
    }

    fn wait(&mut self, ms: u64) {
        self.now = self.now + Duration::from_millis(ms);
    }

    /// Sends bytes, waits 5 ms, and returns the bytes received.
    fn bytes(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.target.on_bytes(self.now, bytes);
        self.wait(5);
        self.target.poll(self.now)
    }

    /// Sends a frame in the session and returns the status and the data of its reply.
    fn frame(&mut self, command: u16, data: &[u8]) -> Option<(u32, Vec<u8>)> {
        let reply = self.bytes(&frame(command, self.session, data));
        let status = reply.get(8..12)?.try_into().unwrap();
        Some((u32::from_le_bytes(status), reply[24..].to_vec()))
    }

    /// Sends a CIP request and returns the items of the reply, from the CIP message onwards.
    fn items(&mut self, request: &str) -> String {
        let (status, data) = self.frame(0x6F, &unconnected(&bytes(request))).expect("no reply");
        assert_eq!(status, 0, "{request}");
        assert_eq!(data[6..14], [data[6], 0, 0, 0, 0, 0, 0xB2, 0], "{}", hex(&data));
        hex(&data[16..])
    }

    #[track_caller]
    fn is_asking(&mut self, request: &str, reply: &str) {
        assert_eq!(self.items(request), reply, "{request}");
    }

    /// Sends a ForwardOpen and returns the reply without the socket item.
    fn open(&mut self, request: &str) -> String {
        let reply = self.items(request);
        reply.split(" 00 80 10 00").next().unwrap().to_owned()
    }

    fn opened(query: &str) -> Self {
        let mut host = Host::new(query);
        assert_eq!(host.open(OPEN), OPENED);
        host
    }

    /// Sends a packet over connection 00020001.
    fn packet(&mut self, sequence: u32, header: u32, data: &[u8]) {
        self.packet_on_connection(0x0002_0001, sequence, header, data);
    }

    fn packet_on_connection(&mut self, connection: u32, sequence: u32, header: u32, data: &[u8]) {
        let length = u16::try_from(data.len() + 6).unwrap();
        let packet = [
            &bytes("02 00 02 80 08 00")[..],
            &connection.to_le_bytes(),
            &sequence.to_le_bytes(),
            &bytes("B1 00"),
            &length.to_le_bytes(),
            &sequence.to_le_bytes()[..2],
            &header.to_le_bytes(),
            data,
        ];
        self.target.on_datagram(self.now, FROM, &packet.concat());
    }

    /// Sends a control word to the drive of an adapter, with the data from the reference: full speed and torque, and a
    /// target of 2.5 turns.
    fn word(&mut self, sequence: u32, control: u16) {
        let [low, high] = control.to_le_bytes();
        self.packet(sequence, 1, &[low, high, 100, 100, 0, 0x80, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    }

    /// Sends each control word in three packets and returns the next sequence number.
    fn words(&mut self, mut sequence: u32, words: &[u16]) -> u32 {
        for word in words {
            for _ in 0..3 {
                self.word(sequence, *word);
                sequence += 1;
                self.wait(10);
            }
        }
        sequence
    }

    /// Returns the datagrams received since the last call.
    fn datagrams(&mut self) -> Vec<(SocketAddrV4, String)> {
        let came = self.target.poll_datagrams(self.now);
        came.into_iter().map(|(to, packet)| (to, hex(&packet))).collect()
    }

    /// Returns the status word in the newest packet.
    fn status(&mut self) -> Option<u16> {
        let (_, packet) = self.datagrams().pop()?;
        let packet = bytes(&packet);
        Some(u16::from_le_bytes([packet[20], packet[21]]))
    }
}
