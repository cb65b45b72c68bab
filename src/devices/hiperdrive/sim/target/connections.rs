//! The connection manager of the target, which opens and closes cyclic and explicit connections, and unwraps requests.
//!
//! Assumptions (`U`: not documented):
//! - There is one cyclic connection, to one master.
//! - It has sizes with and without parameter words, intervals from 5 to 100 ms, no configuration data and no multicast.
//! - Explicit connections (class 3) are available, and end with their session.
//! - A ForwardOpen with long fields (5Bh) is not supported.

use std::net::{Ipv4Addr, SocketAddrV4};
use std::time::Duration;

use super::cyclic::Cyclic;
use super::device::{Originator, TargetDevice};
use super::objects::{class_and_attribute, status_of};
use crate::buses::ethernet_ip::protocol::{
    ConnectionOwner, EPath, ElectronicKey, ForwardClose, ForwardCloseSuccess, ForwardErrorReply, ForwardOpen,
    ForwardOpenSuccess, GeneralStatus, IMPLICIT_MESSAGE_PORT, IoPacket, Item, ItemList, LogicalKind, NetworkType,
    RealTimeFormat, Reply, Request, Segment, Service, SocketAddress, Trigger,
};
use crate::devices::hiperdrive::protocol::{ASSEMBLIES, Layout};
use crate::units::Moment;

#[derive(Debug, Default)]
pub(super) struct Connections {
    pub(super) cyclic: Option<Cyclic>,
    explicit: Vec<ExplicitConnection>,
    /// Number of connections opened so far. Every connection gets a new number.
    opened: u32,
}

#[derive(Debug)]
struct ExplicitConnection {
    owner: ConnectionOwner,
    session: u32,
    to_target_id: u32,
    to_originator_id: u32,
    timeout: Duration,
    heard: Moment,
}

/// Reason for rejecting a connection, sent as the first extended status word.
type ExtendedStatus = u16;

const IN_USE: ExtendedStatus = 0x0100;
const TRANSPORT: ExtendedStatus = 0x0103;
const OTHER_MASTER: ExtendedStatus = 0x0106;
const NOT_FOUND: ExtendedStatus = 0x0107;
const NETWORK_TYPE: ExtendedStatus = 0x0108;
const INTERVAL: ExtendedStatus = 0x0111;
const NO_MORE_CONNECTIONS: ExtendedStatus = 0x0113;
const WRONG_VENDOR: ExtendedStatus = 0x0114;
const WRONG_TYPE: ExtendedStatus = 0x0115;
const WRONG_REVISION: ExtendedStatus = 0x0116;
const ASSEMBLY: ExtendedStatus = 0x0117;
const TO_TARGET_SIZE: ExtendedStatus = 0x0127;
const TO_ORIGINATOR_SIZE: ExtendedStatus = 0x0128;
const SEGMENT: ExtendedStatus = 0x0315;

const INTERVALS_US: std::ops::RangeInclusive<u32> = 5_000..=100_000;
const MAX_EXPLICIT: usize = 4;
const UNCONNECTED_SEND: u8 = 0x52;
const ASSEMBLY_CLASS: u16 = 0x04;
const MESSAGE_ROUTER: u16 = 0x02;

impl Connections {
    /// Creates the state after a power failure, with no connections.
    pub(super) fn after_power_loss(lost: &Connections) -> Self {
        Connections { opened: lost.opened, ..Connections::default() }
    }

    pub(super) const fn has_cyclic_connection(&self) -> bool {
        self.cyclic.is_some()
    }

    pub(super) fn next_due(&self) -> Option<Moment> {
        self.cyclic.as_ref().map(Cyclic::next_packet_time)
    }

    pub(super) fn end_session(&mut self, session: u32) {
        self.explicit.retain(|explicit| explicit.session != session);
    }

    pub(super) fn remove_timed_out(&mut self, now: Moment) {
        self.explicit.retain(|explicit| now.duration_since(explicit.heard) < explicit.timeout);
    }

    /// Records a message over an explicit connection and returns the connection number for the reply.
    pub(super) fn message(&mut self, to_target_id: u32, session: u32, now: Moment) -> Option<u32> {
        let mut explicit = self.explicit.iter_mut();
        let found = explicit.find(|one| one.to_target_id == to_target_id && one.session == session)?;
        found.heard = now;
        Some(found.to_originator_id)
    }

    fn next_id(&mut self) -> u32 {
        self.opened = self.opened.wrapping_add(1);
        0x0002_0000 | self.opened & 0xFFFF
    }
}

impl TargetDevice {
    /// Handles a request to the connection manager. Returns the reply and the socket items to send with it.
    pub(super) fn handle_connection(
        &mut self,
        from: (Originator, u32),
        request: &Request,
        items: &ItemList,
    ) -> (Reply, Vec<Item>) {
        let alone = |reply| (reply, Vec::new());
        if let Err(status) = class_and_attribute(&request.path) {
            return alone(request.error_reply(status));
        }
        match request.service {
            Service::FORWARD_OPEN => match ForwardOpen::parse(&request.data) {
                Ok(open) => self.open(from, request, &open, items),
                Err(error) => alone(request.error_reply(status_of(error))),
            },
            Service::FORWARD_CLOSE => match ForwardClose::parse(&request.data) {
                Ok(close) => alone(self.close(request, &close)),
                Err(error) => alone(request.error_reply(status_of(error))),
            },
            service if service.code() == UNCONNECTED_SEND => match unwrap_request(&request.data) {
                Ok(inner) if inner.class_id() == Some(Request::CONNECTION_MANAGER) => {
                    self.handle_connection(from, &inner, items)
                }
                Ok(inner) => alone(self.handle_request(&inner)),
                Err(status) => alone(request.error_reply(status)),
            },
            _ => alone(request.error_reply(GeneralStatus::NO_SERVICE)),
        }
    }

    fn open(
        &mut self,
        from: (Originator, u32),
        request: &Request,
        open: &ForwardOpen,
        items: &ItemList,
    ) -> (Reply, Vec<Item>) {
        let opened = match open.transport.transport_class() {
            1 => self.open_cyclic_connection(from.0, open, items),
            3 => self.open_explicit_connection(from.1, open).map(|id| (id, Vec::new())),
            _ => Err(TRANSPORT),
        };
        match opened {
            Ok((to_target_id, sockets)) => {
                let opened = ForwardOpenSuccess {
                    to_target_id,
                    to_originator_id: open.to_originator_id,
                    owner: open.owner,
                    to_target_interval_us: open.to_target_interval_us,
                    to_originator_interval_us: open.to_originator_interval_us,
                    application: Vec::new(),
                };
                (request.success_reply(opened.emit()), sockets)
            }
            Err(extended) => {
                let refused = ForwardErrorReply { owner: open.owner, remaining_path_words: 0 };
                (refused.reply(request, extended), Vec::new())
            }
        }
    }

    fn open_cyclic_connection(
        &mut self,
        from: Originator,
        open: &ForwardOpen,
        items: &ItemList,
    ) -> Result<(u32, Vec<Item>), ExtendedStatus> {
        match &self.connections.cyclic {
            Some(cyclic) if cyclic.owner == open.owner => return Err(IN_USE),
            Some(_) => return Err(OTHER_MASTER),
            None => {}
        }
        if open.transport.trigger() != Trigger::Cyclic {
            return Err(TRANSPORT);
        }
        self.check_path(&open.path)?;
        let kinds = [open.to_target, open.to_originator];
        if kinds.iter().any(|one| one.kind() != NetworkType::PointToPoint || one.has_redundant_owner()) {
            return Err(NETWORK_TYPE);
        }
        let layout = self.layout(open)?;
        let intervals = [open.to_target_interval_us, open.to_originator_interval_us];
        if !intervals.iter().all(|interval| INTERVALS_US.contains(interval)) {
            return Err(INTERVAL);
        }
        let id = self.connections.next_id();
        let to = originator_socket(from.address, items.socket_to_originator());
        self.station.open(self.now, open.target_timeout());
        self.connections.cyclic = Some(Cyclic::new(open, id, layout, to, self.now));
        let own = SocketAddress::new(Ipv4Addr::UNSPECIFIED, self.udp);
        Ok((id, vec![Item::SocketToTarget(own)]))
    }

    /// Checks that a connection path leads to assemblies 100 and 101, with an optional configuration assembly 104, and
    /// that its electronic key matches.
    fn check_path(&mut self, path: &EPath) -> Result<(), ExtendedStatus> {
        let [configuration, to_target, to_originator] = ASSEMBLIES;
        for segment in &path.0 {
            match segment {
                Segment::Key(key) => self.check_key(key)?,
                Segment::Logical { .. } => {}
                Segment::Data(_) | Segment::Unknown(_) => return Err(SEGMENT),
            }
        }
        let instance = path.first_value(LogicalKind::Instance);
        let points: Vec<u16> = path.values_of(LogicalKind::ConnectionPoint).collect();
        let fits = path.first_value(LogicalKind::Class) == Some(ASSEMBLY_CLASS)
            && instance.is_none_or(|instance| instance == configuration)
            && points == [to_target, to_originator];
        if fits { Ok(()) } else { Err(ASSEMBLY) }
    }

    /// Checks whether an electronic key matches this device. A field of 0 matches any device.
    fn check_key(&mut self, key: &ElectronicKey) -> Result<(), ExtendedStatus> {
        let own = self.identity();
        let fits = |wanted: u16, own: u16| wanted == 0 || wanted == own;
        let (major, compatible) = (key.major & 0x7F, key.major & 0x80 != 0);
        let minor = match compatible {
            true => key.minor <= own.revision.minor,
            false => fits(key.minor.into(), own.revision.minor.into()),
        };
        if !fits(key.vendor, own.vendor) || !fits(key.product_code, own.product_code) {
            Err(WRONG_VENDOR)
        } else if !fits(key.device_type, own.device_type) {
            Err(WRONG_TYPE)
        } else if !fits(major.into(), own.revision.major.into()) || !minor {
            Err(WRONG_REVISION)
        } else {
            Ok(())
        }
    }

    /// Returns the layout that a request to open a connection asks for, with or without parameter words.
    fn layout(&self, open: &ForwardOpen) -> Result<Layout, ExtendedStatus> {
        let topology = self.station.topology();
        let layouts = [true, false].map(|pkw| Layout { topology, pkw, order: self.order });
        let length = usize::from(open.to_target.size().saturating_sub(IoPacket::size_overhead(RealTimeFormat::Header)));
        let layout = layouts.into_iter().find(|layout| layout.byte_length() == length).ok_or(TO_TARGET_SIZE)?;
        let back = layout.byte_length() + usize::from(IoPacket::size_overhead(RealTimeFormat::Modeless));
        if usize::from(open.to_originator.size()) == back { Ok(layout) } else { Err(TO_ORIGINATOR_SIZE) }
    }

    fn open_explicit_connection(&mut self, session: u32, open: &ForwardOpen) -> Result<u32, ExtendedStatus> {
        let connections = &mut self.connections;
        if connections.explicit.iter().any(|explicit| explicit.owner == open.owner) {
            return Err(IN_USE);
        }
        if connections.explicit.len() >= MAX_EXPLICIT {
            return Err(NO_MORE_CONNECTIONS);
        }
        let path = EPath::to_instance(MESSAGE_ROUTER, 1);
        if open.path.emit() != path.emit() {
            return Err(SEGMENT);
        }
        let id = connections.next_id();
        connections.explicit.push(ExplicitConnection {
            owner: open.owner,
            session,
            to_target_id: id,
            to_originator_id: open.to_originator_id,
            timeout: open.target_timeout(),
            heard: self.now,
        });
        Ok(id)
    }

    fn close(&mut self, request: &Request, close: &ForwardClose) -> Reply {
        let connections = &mut self.connections;
        let before = connections.explicit.len();
        connections.explicit.retain(|explicit| explicit.owner != close.owner);
        let cyclic = connections.cyclic.take_if(|cyclic| cyclic.owner == close.owner);
        if cyclic.is_some() {
            self.station.close(self.now);
        } else if self.connections.explicit.len() == before {
            let refused = ForwardErrorReply { owner: close.owner, remaining_path_words: 0 };
            return refused.reply(request, NOT_FOUND);
        }
        request.success_reply(ForwardCloseSuccess { owner: close.owner, application: Vec::new() }.emit())
    }
}

/// Returns the address to which cyclic data are sent: the one that the originator requested or, by default, its own
/// address with the usual port.
fn originator_socket(peer: Ipv4Addr, requested: Option<SocketAddress>) -> SocketAddrV4 {
    match requested {
        Some(socket) if socket.address.is_unspecified() => SocketAddrV4::new(peer, socket.port),
        Some(socket) => SocketAddrV4::new(socket.address, socket.port),
        None => SocketAddrV4::new(peer, IMPLICIT_MESSAGE_PORT),
    }
}

/// Extracts the request from an Unconnected_Send. Its data contain a time-out, a length, the request padded to whole
/// words, and a route, which is ignored.
fn unwrap_request(data: &[u8]) -> Result<Request, GeneralStatus> {
    let [_, _, low, high, rest @ ..] = data else { return Err(GeneralStatus::TOO_SHORT) };
    let length = usize::from(u16::from_le_bytes([*low, *high]));
    let message = rest.get(..length).ok_or(GeneralStatus::TOO_SHORT)?;
    let inner = Request::parse(message).map_err(|_| GeneralStatus::new(0x04))?;
    // Only one level of wrapping is allowed.
    if inner.service.code() == UNCONNECTED_SEND { Err(GeneralStatus::NO_SERVICE) } else { Ok(inner) }
}
