//! Handles frames: sessions, lists, and the commands that carry CIP messages.

use std::net::SocketAddrV4;

use super::device::{Originator, TargetDevice};
use crate::buses::ethernet_ip::protocol::{
    Body, Command, EncapsulationStatus, Frame, GeneralStatus, IdentityItem, Item, ItemList, Reply, Request, Service,
    SocketAddress,
};

/// ListServices item (0100h) with version, capability flags and name. The flags announce CIP over TCP and cyclic data
/// over UDP.
const SERVICES: (u16, [u8; 20]) = (0x0100, *b"\x01\x00\x20\x01Communications\0\0");
/// Value of attribute 8 of the identity object while the device is operational.
const OPERATIONAL: u8 = 3;
/// CIP status for an unknown path segment.
const PATH_SEGMENT: GeneralStatus = GeneralStatus::new(0x04);

type Refusal = EncapsulationStatus;

impl TargetDevice {
    /// Returns the reply to a frame, if there is one.
    pub(super) fn reply_to(&mut self, from: Originator, frame: &Frame) -> Option<Frame> {
        // According to ODVA, a request with options or with a nonzero status is invalid.
        if frame.options != 0 || frame.status != EncapsulationStatus::OK {
            return None;
        }
        let body = match frame.command {
            Command::NOP => return None,
            Command::UNREGISTER_SESSION => {
                if self.sessions.get(&frame.session) == Some(&from) {
                    self.end_session(frame.session);
                }
                return None;
            }
            Command::REGISTER_SESSION => return Some(self.register(from, frame)),
            Command::LIST_IDENTITY | Command::LIST_SERVICES | Command::LIST_INTERFACES => {
                Ok(self.list_reply(frame.command))
            }
            Command::SEND_RR_DATA => self.unconnected_reply(from, frame),
            Command::SEND_UNIT_DATA => self.handle_unit_data(from, frame).transpose()?,
            _ => Err(EncapsulationStatus::UNSUPPORTED),
        };
        Some(match body {
            Ok(body) => frame.reply(&body),
            Err(status) => frame.error_reply(status),
        })
    }

    /// Handles a frame received in a datagram. Only list commands are answered; for any other frame, returns `false`.
    pub(super) fn answer_datagram(&mut self, from: SocketAddrV4, frame: &Frame) -> bool {
        let asked = matches!(frame.command, Command::LIST_IDENTITY | Command::LIST_SERVICES | Command::LIST_INTERFACES);
        if asked && frame.options == 0 {
            let reply = frame.reply(&self.list_reply(frame.command));
            self.send(self.now, from, reply.emit());
        }
        asked
    }

    fn register(&mut self, from: Originator, frame: &Frame) -> Frame {
        let status = match frame.parse_body() {
            Ok(Body::Register { version: Frame::VERSION, options: 0 }) => None,
            Ok(Body::Register { version: Frame::VERSION, .. }) => Some(EncapsulationStatus::UNSUPPORTED),
            Ok(Body::Register { .. }) => Some(EncapsulationStatus::VERSION),
            _ => Some(EncapsulationStatus::MALFORMED),
        };
        if let Some(status) = status {
            return frame.error_reply(status);
        }
        // A TCP connection has one session. Another request returns the existing session (`U`).
        if let Some((session, _)) = self.sessions.iter().find(|(_, owner)| **owner == from) {
            return Frame { session: *session, ..frame.error_reply(EncapsulationStatus::UNSUPPORTED) };
        }
        let session = loop {
            let session = self.rng.u32(1..);
            if !self.sessions.contains_key(&session) {
                break session;
            }
        };
        self.sessions.insert(session, from);
        Frame { session, ..frame.reply(&Body::Register { version: Frame::VERSION, options: 0 }) }
    }

    fn list_reply(&mut self, command: Command) -> Body {
        let items = match command {
            Command::LIST_IDENTITY => vec![Item::Identity(IdentityItem {
                version: Frame::VERSION,
                socket: SocketAddress::new(*self.listens.ip(), self.listens.port()),
                identity: self.identity(),
                state: OPERATIONAL,
            })],
            Command::LIST_SERVICES => vec![Item::Unknown { kind: SERVICES.0, data: SERVICES.1.to_vec() }],
            _ => Vec::new(),
        };
        Body::List(ItemList(items))
    }

    /// Parses the items of a frame, which must belong to a session of the originator.
    fn parse_items(&self, from: Originator, frame: &Frame) -> Result<ItemList, Refusal> {
        if self.sessions.get(&frame.session) != Some(&from) {
            return Err(EncapsulationStatus::NO_SESSION);
        }
        match frame.parse_body() {
            Ok(Body::Data { interface: 0, items, .. }) => Ok(items),
            _ => Err(EncapsulationStatus::MALFORMED),
        }
    }

    fn unconnected_reply(&mut self, from: Originator, frame: &Frame) -> Result<Body, Refusal> {
        let items = self.parse_items(from, frame)?;
        let (Some(Item::Null), Some(message)) = (items.0.first(), items.unconnected_data()) else {
            return Err(EncapsulationStatus::MALFORMED);
        };
        let (reply, sockets) = self.message((from, frame.session), message, &items)?;
        let items = [Item::Null, Item::UnconnectedData(reply.emit())].into_iter().chain(sockets).collect();
        Ok(Body::Data { interface: 0, timeout_s: 0, items: ItemList(items) })
    }

    /// Handles a SendUnitData frame. Returns `None` if the connection is unknown.
    fn handle_unit_data(&mut self, from: Originator, frame: &Frame) -> Result<Option<Body>, Refusal> {
        let items = self.parse_items(from, frame)?;
        let [Item::ConnectedAddress(connection), Item::ConnectedData(data), ..] = items.0.as_slice() else {
            return Err(EncapsulationStatus::MALFORMED);
        };
        let Some(to_originator) = self.connections.message(*connection, frame.session, self.now) else {
            return Ok(None);
        };
        let (count, message) = data.split_first_chunk::<2>().ok_or(EncapsulationStatus::MALFORMED)?;
        let (reply, _) = self.message((from, frame.session), message, &items)?;
        let data = [&count[..], &reply.emit()].concat();
        let items = ItemList(vec![Item::ConnectedAddress(to_originator), Item::ConnectedData(data)]);
        Ok(Some(Body::Data { interface: 0, timeout_s: 0, items }))
    }

    /// Handles a CIP message. Returns the reply and the socket items to send with it.
    fn message(
        &mut self,
        from: (Originator, u32),
        message: &[u8],
        items: &ItemList,
    ) -> Result<(Reply, Vec<Item>), Refusal> {
        match Request::parse(message) {
            Ok(request) if request.class_id() == Some(Request::CONNECTION_MANAGER) => {
                Ok(self.handle_connection(from, &request, items))
            }
            Ok(request) => Ok((self.handle_request(&request), Vec::new())),
            Err(_) => {
                let service = message.first().and_then(|code| Service::new(*code));
                let service = service.ok_or(EncapsulationStatus::MALFORMED)?;
                let reply = Reply { service, status: PATH_SEGMENT, extended: Vec::new(), data: Vec::new() };
                Ok((reply, Vec::new()))
            }
        }
    }
}
