//! Opens and closes the cyclic connection with explicit messages (reference, section 7). Its packets are handled in
//! `cyclic`.
//!
//! The connection sizes and types that a device accepts are not documented (`U`). They are tried in this order: with
//! parameter words, point to point; then multicast; then without parameter words.

use core::net::{Ipv4Addr, SocketAddrV4};
use std::time::Duration;

use super::{Master, RetryPolicy, SEND_ONCE};
use crate::buses::ethernet_ip::protocol::{
    ConnectionOwner, ConnectionTimeout, EPath, ForwardClose, ForwardOpen, ForwardOpenSuccess, GeneralStatus, IoPacket,
    Item, NetworkParameters, NetworkPriority, NetworkType, RealTimeFormat, RequestTimeout, SocketAddress, Transport,
};
use crate::devices::hiperdrive::procedures::Error;
use crate::devices::hiperdrive::procedures::error::{ErrorReply, RequestedItem};
use crate::devices::hiperdrive::protocol::{ASSEMBLIES, Layout, Topology};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpenedConnection {
    pub to_target_id: u32,
    pub to_originator_id: u32,
    pub to_target_interval: Duration,
    pub to_originator_interval: Duration,
    /// Time without a packet after which the target closes the connection and the drives stop.
    pub timeout: Duration,
    pub layout: Layout,
    pub port: u16,
    /// Multicast group of the packets from the target, if multicast is used.
    pub group: Option<SocketAddrV4>,
    pub close: ForwardClose,
}

/// Vendor ID of this program. The number is not assigned to any vendor (reference, section 9).
const VENDOR: u16 = 0x1234;
/// Code for a time-out of eight intervals, which tolerates a single delay of the host. Long intervals use the code for
/// four intervals, so that the drives stop soon enough.
const TIMEOUT: u8 = 1;
const LONG_TIMEOUT: u8 = 0;
/// Interval from which the time-out for long intervals is used.
const LONG_INTERVAL: Duration = Duration::from_millis(35);
/// Factor by which a device may lengthen the requested interval, within the maximum interval.
const MAX_INTERVAL_FACTOR: u32 = 2;
const MAX_INTERVAL: Duration = Duration::from_millis(100);

/// Extended status with which a device rejects a connection that is already in use.
const CONNECTION_IN_USE: u16 = 0x0100;
const OUTPUTS_OWNED_BY_ANOTHER_MASTER: u16 = 0x0106;
const KIND: u16 = 0x0108;
const KINDS: [u16; 3] = [KIND, 0x0123, 0x0124];
const SIZES: [u16; 3] = [0x0109, 0x0127, 0x0128];

impl Master<'_> {
    /// Opens the cyclic connection. The target sends its packets to the local `port`.
    ///
    /// # Errors
    /// Returns [`Error::OtherMaster`] or [`Error::Refused`] if the device rejects the request, or another error if the
    /// exchange fails.
    pub fn forward_open(&mut self, topology: Topology, port: u16) -> Result<OpenedConnection, Error> {
        let order = self.station.link.order;
        let with = |pkw| Layout { topology, pkw, order };
        let tries = [
            (with(true), NetworkType::PointToPoint),
            (with(true), NetworkType::Multicast),
            (with(false), NetworkType::PointToPoint),
            (with(false), NetworkType::Multicast),
        ];
        let mut refused = None;
        for (layout, kind) in tries {
            let matters = refused.as_ref().is_none_or(|refusal| avoids_rejection(refusal, layout, kind));
            if !matters {
                continue;
            }
            match self.open_with_layout(layout, kind, port) {
                Err(Error::Refused { refusal, .. }) => match refusal.extended.first() {
                    Some(&extended @ (CONNECTION_IN_USE | OUTPUTS_OWNED_BY_ANOTHER_MASTER))
                        if is_connection_rejection(&refusal) =>
                    {
                        return Err(Error::OtherMaster { extended });
                    }
                    _ => refused = Some(refusal),
                },
                ended => return ended,
            }
        }
        match refused {
            Some(refusal) => Err(Error::Refused { requested: RequestedItem::Open, refusal }),
            None => Err(Error::NoCyclic),
        }
    }

    /// Closes a cyclic connection, ignoring cancellation. It is not an error if the connection has already ended.
    ///
    /// # Errors
    /// Returns [`Error::Refused`] if the device rejects the request, or another error if the exchange fails.
    pub fn forward_close(&mut self, close: &ForwardClose) -> Result<(), Error> {
        const CONNECTION_NOT_FOUND: u16 = 0x0107;
        match self
            .run_uncancellable(|master| master.request(RequestedItem::Close, &close.request(), RetryPolicy::Always))
        {
            Err(Error::Refused { refusal, .. }) if refusal.extended.first() == Some(&CONNECTION_NOT_FOUND) => Ok(()),
            ended => ended.map(|_| ()),
        }
    }

    /// Closes a possibly open connection that cannot be used. Errors are ignored, because the original error is
    /// reported instead.
    fn close_without_reply(&mut self, close: &ForwardClose) {
        if let Err(why) = self.run_uncancellable(|master| master.forward_close(close)) {
            tracing::warn!("{why}");
        }
    }

    fn open_with_layout(&mut self, layout: Layout, kind: NetworkType, port: u16) -> Result<OpenedConnection, Error> {
        self.station.connections = self.station.connections.wrapping_add(1);
        let serial = self.station.connections;
        let owner =
            ConnectionOwner { connection_serial: serial, vendor: VENDOR, serial_number: self.station.originator };
        // No image is longer than 72 bytes.
        let length = layout.byte_length() as u16;
        let parameters = |kind, format| {
            let size = length + IoPacket::size_overhead(format);
            NetworkParameters::new(kind, NetworkPriority::Scheduled, size)
        };
        let to_target = parameters(NetworkType::PointToPoint, RealTimeFormat::Header).ok_or(Error::NoCyclic)?;
        let to_originator = parameters(kind, RealTimeFormat::Modeless).ok_or(Error::NoCyclic)?;
        let interval = self.station.link.interval.as_micros() as u32;
        let timeout = if self.station.link.interval < LONG_INTERVAL { TIMEOUT } else { LONG_TIMEOUT };
        let [configuration, to, from] = ASSEMBLIES;
        let open = ForwardOpen {
            timeout: RequestTimeout::TWO_SECOND_TIMEOUT,
            to_target_id: 0,
            to_originator_id: self.station.originator.rotate_left(16) ^ u32::from(serial),
            owner,
            connection_timeout: ConnectionTimeout::new(timeout).ok_or(Error::NoCyclic)?,
            to_target_interval_us: interval,
            to_target,
            to_originator_interval_us: interval,
            to_originator,
            transport: Transport::CYCLIC,
            path: EPath::to_assemblies(configuration, to, from),
        };
        let ours = Item::SocketToOriginator(SocketAddress::new(Ipv4Addr::UNSPECIFIED, port));
        let close = ForwardClose { timeout: open.timeout, owner, path: open.path.clone() };
        // The request is sent once, because a second one would be rejected as in use. The connection may be open even
        // if the reply is not understood.
        let requested = self.request_with_items(RequestedItem::Open, &open.request(), &[ours], SEND_ONCE);
        let opened = requested.and_then(|(reply, items)| match ForwardOpenSuccess::parse(&reply.data) {
            Ok(opened) => Ok((opened, items)),
            Err(cause) => Err(Error::Damaged { requested: RequestedItem::Open, tries: 1, cause: cause.into() }),
        });
        if let Err(Error::NoReply { .. } | Error::Damaged { .. }) = &opened {
            self.close_without_reply(&close);
        }
        let (opened, items) = opened?;
        let micros = |us: u32| Duration::from_micros(us.into());
        let to_target_interval = micros(opened.to_target_interval_us);
        let slowest = to_target_interval.max(micros(opened.to_originator_interval_us));
        if slowest > MAX_INTERVAL.min(self.station.link.interval * MAX_INTERVAL_FACTOR) {
            self.close_without_reply(&close);
            let milliseconds = |time: Duration| time.as_millis() as u64;
            let (asked_ms, got_ms) = (milliseconds(self.station.link.interval), milliseconds(slowest));
            return Err(Error::TooSlow { asked_ms, got_ms });
        }
        Ok(OpenedConnection {
            to_target_id: opened.to_target_id,
            to_originator_id: opened.to_originator_id,
            to_target_interval,
            to_originator_interval: micros(opened.to_originator_interval_us),
            timeout: open.connection_timeout.for_interval(to_target_interval),
            layout,
            port: items.socket_to_target().map_or(self.station.udp, |address| address.port),
            group: items.socket_to_originator().and_then(multicast_address),
            close,
        })
    }
}

fn multicast_address(to: SocketAddress) -> Option<SocketAddrV4> {
    to.address.is_multicast().then(|| SocketAddrV4::new(to.address, to.port))
}

fn is_connection_rejection(refusal: &ErrorReply) -> bool {
    refusal.status == GeneralStatus::CONNECTION
}

/// Returns whether this layout and network type avoid the reason for the rejection.
fn avoids_rejection(refusal: &ErrorReply, layout: Layout, kind: NetworkType) -> bool {
    let first = refusal.extended.first().filter(|_| is_connection_rejection(refusal));
    match first {
        Some(code) if KINDS.contains(code) => kind == NetworkType::Multicast,
        Some(code) if SIZES.contains(code) => !layout.pkw,
        _ => false,
    }
}
