//! Datagrams over UDP: cyclic data to and from one target ([`UdpPort`]), and broadcast requests ([`UdpBroadcast`]).

use std::io::{self, ErrorKind};
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, ToSocketAddrs, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TryRecvError, bounded};
use if_addrs::{IfAddr, Ifv4Addr};

use super::{
    BroadcastChannel, Clock, DatagramChannel, DatagramPort, LinkError, LinkErrorKind, request_realtime_priority,
};
use crate::units::Moment;

/// Maximum length of a datagram in bytes. With a smaller buffer, Linux would truncate longer datagrams, and Windows
/// would report an error.
const MAX_DATAGRAM_LEN: usize = 65_535;
/// Maximum number of received packets waiting to be read. Further packets are dropped.
const MAX_WAITING_PACKETS: usize = 64;
/// Maximum time until a receiver thread notices that its channel has been dropped.
const DROP_CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// A factory for UDP channels to the target of a TCP connection. Channels use the local address from which the target
/// can be reached.
pub struct UdpPort {
    target: String,
    clock: Arc<dyn Clock>,
}

impl UdpPort {
    /// Creates a factory for channels to `target`, the `host:port` of a TCP connection.
    pub fn new(target: &str, clock: Arc<dyn Clock>) -> Self {
        UdpPort { target: target.to_owned(), clock }
    }
}

impl DatagramPort for UdpPort {
    fn open(&mut self) -> Result<Box<dyn DatagramChannel>, LinkError> {
        let fail = |kind| LinkError::new(&self.target, kind);
        let mut addresses = self.target.to_socket_addrs().map_err(|_| fail(LinkErrorKind::NotFound))?;
        let found = addresses.find_map(|address| match address {
            SocketAddr::V4(address) => Some(address),
            SocketAddr::V6(_) => None,
        });
        let target = found.ok_or_else(|| {
            fail(LinkErrorKind::Unreachable("cyclic data need an address of IP version 4".to_owned()))
        })?;
        let unreachable = |error: io::Error| fail(LinkErrorKind::Unreachable(error.to_string()));
        let local = local_address_for(target).map_err(unreachable)?;
        let socket = UdpSocket::bind((local, 0)).map_err(unreachable)?;
        let port = socket.local_addr().map_err(unreachable)?.port();
        let (sender, heard) = bounded(MAX_WAITING_PACKETS);
        let mut packets = UdpChannel {
            name: self.target.clone(),
            target,
            local,
            port,
            socket: Arc::new(socket),
            listeners: Vec::new(),
            sender,
            heard,
            clock: self.clock.clone(),
        };
        let socket = packets.socket.clone();
        packets.start_listening(socket)?;
        Ok(Box::new(packets))
    }
}

/// Returns the local address from which the target can be reached.
fn local_address_for(target: SocketAddrV4) -> io::Result<Ipv4Addr> {
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
    // Connecting a UDP socket does not send anything, but selects the network interface.
    socket.connect(target)?;
    match socket.local_addr()? {
        SocketAddr::V4(address) => Ok(*address.ip()),
        SocketAddr::V6(_) => Err(ErrorKind::Unsupported.into()),
    }
}

/// A channel for packets to and from a single target. A separate thread receives the packets, so a wait ends as soon as
/// a packet arrives.
struct UdpChannel {
    name: String,
    target: SocketAddrV4,
    local: Ipv4Addr,
    port: u16,
    socket: Arc<UdpSocket>,
    listeners: Vec<SocketListener>,
    sender: Sender<Vec<u8>>,
    heard: Receiver<Vec<u8>>,
    clock: Arc<dyn Clock>,
}

/// A thread that listens on a socket until this value is dropped.
struct SocketListener {
    is_stopped: Arc<AtomicBool>,
}

impl Drop for SocketListener {
    fn drop(&mut self) {
        self.is_stopped.store(true, Ordering::Relaxed);
    }
}

impl UdpChannel {
    fn connection_error(&self, error: &io::Error) -> LinkError {
        LinkError::new(&self.name, LinkErrorKind::Unreachable(error.to_string()))
    }

    fn start_listening(&mut self, socket: Arc<UdpSocket>) -> Result<(), LinkError> {
        socket.set_read_timeout(Some(DROP_CHECK_INTERVAL)).map_err(|error| self.connection_error(&error))?;
        let deaf = Arc::new(AtomicBool::new(false));
        let (hears, sender, from) = (deaf.clone(), self.sender.clone(), *self.target.ip());
        let thread = std::thread::Builder::new().name("cyclic packets".to_owned());
        let started = thread.spawn(move || {
            request_realtime_priority();
            let mut buffer = vec![0; MAX_DATAGRAM_LEN];
            while !hears.load(Ordering::Relaxed) {
                match socket.recv_from(&mut buffer) {
                    // Packets from other senders are dropped, and so are packets that the queue cannot hold.
                    Ok((count, SocketAddr::V4(sent_by))) if *sent_by.ip() == from => {
                        let _ = sender.try_send(buffer.iter().take(count).copied().collect());
                    }
                    Ok(_) => {}
                    // The system reports a closed port of the target as an error. The target may open it again.
                    Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                    // The error may repeat without limit, so the thread pauses.
                    Err(error) if is_transient(&error) => std::thread::sleep(Duration::from_millis(1)),
                    Err(_) => return,
                }
            }
        });
        started.map_err(|error| self.connection_error(&error))?;
        self.listeners.push(SocketListener { is_stopped: deaf });
        Ok(())
    }
}

fn is_transient(error: &io::Error) -> bool {
    use ErrorKind::{ConnectionRefused, ConnectionReset, Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), WouldBlock | TimedOut | Interrupted | ConnectionRefused | ConnectionReset)
}

impl DatagramChannel for UdpChannel {
    fn port(&self) -> u16 {
        self.port
    }

    fn set_target_port(&mut self, port: u16) {
        self.target.set_port(port);
    }

    fn join(&mut self, group: SocketAddrV4) -> Result<(), LinkError> {
        let socket =
            UdpSocket::bind((Ipv4Addr::UNSPECIFIED, group.port())).map_err(|error| self.connection_error(&error))?;
        socket.join_multicast_v4(group.ip(), &self.local).map_err(|error| self.connection_error(&error))?;
        self.start_listening(Arc::new(socket))
    }

    fn send(&mut self, packet: &[u8]) -> Result<(), LinkError> {
        match self.socket.send_to(packet, self.target) {
            Ok(_) => Ok(()),
            // The system reports an error of an earlier packet.
            Err(error) if is_transient(&error) => Ok(()),
            Err(error) => Err(LinkError::from_io_error(&self.name, &error)),
        }
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<bool, LinkError> {
        let received = if cfg!(windows) {
            sleep_for_packet(&self.heard, until, &*self.clock)
        } else {
            self.heard.recv_timeout(until.duration_since(self.clock.now()))
        };
        match received {
            Ok(packet) => {
                *into = packet;
                Ok(true)
            }
            Err(RecvTimeoutError::Timeout) => Ok(false),
            Err(RecvTimeoutError::Disconnected) => Err(LinkError::new(&self.name, LinkErrorKind::Lost)),
        }
    }
}

/// Waits for a packet in short sleeps. On Windows, waiting for a channel ends at the next tick of the system timer, up
/// to 15.6 ms late, whereas a sleep uses a high-resolution timer.
fn sleep_for_packet(heard: &Receiver<Vec<u8>>, until: Moment, clock: &dyn Clock) -> Result<Vec<u8>, RecvTimeoutError> {
    const POLL_THRESHOLD: Duration = Duration::from_millis(1);
    loop {
        match heard.try_recv() {
            Ok(packet) => return Ok(packet),
            Err(TryRecvError::Disconnected) => return Err(RecvTimeoutError::Disconnected),
            Err(TryRecvError::Empty) => {}
        }
        let now = clock.now();
        if now >= until {
            return Err(RecvTimeoutError::Timeout);
        }
        clock.sleep_until(until.min(now + POLL_THRESHOLD));
    }
}

/// A channel for broadcast requests to a port.
pub struct UdpBroadcast {
    socket: UdpSocket,
    to: Vec<SocketAddrV4>,
    clock: Arc<dyn Clock>,
}

impl UdpBroadcast {
    /// Creates a channel that broadcasts on every network.
    ///
    /// # Errors
    /// Returns an error if the system has no free socket.
    pub fn on_all_networks(port: u16, clock: Arc<dyn Clock>) -> Result<Self, LinkError> {
        let mut networks = vec![Ipv4Addr::BROADCAST];
        networks.extend(local_networks());
        networks.dedup();
        Self::new(networks.into_iter().map(|address| SocketAddrV4::new(address, port)).collect(), clock)
    }

    /// Creates a channel that sends to the given addresses.
    ///
    /// # Errors
    /// Returns an error if the system has no free socket.
    pub fn new(to: Vec<SocketAddrV4>, clock: Arc<dyn Clock>) -> Result<Self, LinkError> {
        let open = || {
            let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
            socket.set_broadcast(true)?;
            Ok(socket)
        };
        let socket = open().map_err(|error: io::Error| Self::send_error(&to, &error))?;
        Ok(UdpBroadcast { socket, to, clock })
    }

    fn send_error(to: &[SocketAddrV4], error: &io::Error) -> LinkError {
        let to: Vec<String> = to.iter().map(ToString::to_string).collect();
        LinkError::new(to.join(", "), LinkErrorKind::Unreachable(error.to_string()))
    }
}

/// Returns the broadcast addresses of the directly connected networks, or an empty list if they are unknown.
fn local_networks() -> Vec<Ipv4Addr> {
    let interfaces = if_addrs::get_if_addrs().unwrap_or_default();
    let addresses = interfaces.into_iter().filter(|own| !own.is_loopback() && !own.is_p2p());
    addresses.filter_map(|own| if let IfAddr::V4(own) = own.addr { broadcast_address(&own) } else { None }).collect()
}

/// Returns the broadcast address of a network, or `None` if the network contains no other device.
fn broadcast_address(own: &Ifv4Addr) -> Option<Ipv4Addr> {
    let mask = own.netmask.to_bits();
    // Mask 0 would yield 255.255.255.255, which is always included.
    (mask != 0 && mask != u32::MAX).then(|| Ipv4Addr::from_bits(own.ip.to_bits() | !mask))
}

impl BroadcastChannel for UdpBroadcast {
    fn broadcast(&mut self, packet: &[u8]) -> Result<(), LinkError> {
        let mut failed = None;
        let mut sent = false;
        for to in &self.to {
            match self.socket.send_to(packet, to) {
                Ok(_) => sent = true,
                Err(error) => failed = Some(error),
            }
        }
        match failed {
            Some(error) if !sent => Err(Self::send_error(&self.to, &error)),
            _ => Ok(()),
        }
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<Option<Ipv4Addr>, LinkError> {
        let mut buffer = vec![0; MAX_DATAGRAM_LEN];
        loop {
            let left = until.duration_since(self.clock.now());
            if left.is_zero() {
                return Ok(None);
            }
            let heard = self.socket.set_read_timeout(Some(left)).and_then(|()| self.socket.recv_from(&mut buffer));
            match heard {
                Ok((count, SocketAddr::V4(from))) => {
                    *into = buffer.iter().take(count).copied().collect();
                    return Ok(Some(*from.ip()));
                }
                Ok(_) => {}
                Err(error) if is_transient(&error) => {}
                Err(error) => return Err(Self::send_error(&self.to, &error)),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::RealClock;

    fn pair() -> (UdpSocket, Box<dyn DatagramChannel>, Arc<RealClock>) {
        let target = UdpSocket::bind("127.0.0.1:0").unwrap();
        target.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
        let clock = Arc::new(RealClock::start());
        let mut packets = UdpPort::new("127.0.0.1:44818", clock.clone()).open().unwrap();
        packets.set_target_port(target.local_addr().unwrap().port());
        (target, packets, clock)
    }

    #[test]
    fn delivers_packets_and_replies() {
        let (target, mut packets, clock) = pair();
        packets.send(b"out").unwrap();
        let mut buffer = [0; 16];
        let (count, from) = target.recv_from(&mut buffer).unwrap();
        assert_eq!((&buffer[..count], from.port()), (&b"out"[..], packets.port()));
        target.send_to(b"in 1", from).unwrap();
        target.send_to(b"in 2", from).unwrap();
        let mut heard = b"old".to_vec();
        let until = clock.now() + Duration::from_secs(5);
        assert!(packets.receive(until, &mut heard).unwrap());
        assert_eq!(heard, b"in 1");
        assert!(packets.receive(until, &mut heard).unwrap());
        assert_eq!(heard, b"in 2");
        let until = clock.now() + Duration::from_millis(5);
        assert!(!packets.receive(until, &mut heard).unwrap());
        assert!(clock.now() >= until, "it waits for as long as it was told");
    }

    #[test]
    fn drops_packets_from_other_senders() {
        let (target, mut packets, clock) = pair();
        let to = ("127.0.0.1", packets.port());
        // All addresses in 127/8 belong to this computer.
        if let Ok(other) = UdpSocket::bind("127.0.0.2:0") {
            other.send_to(b"stray", to).unwrap();
        }
        target.send_to(b"own", to).unwrap();
        let mut heard = Vec::new();
        assert!(packets.receive(clock.now() + Duration::from_secs(5), &mut heard).unwrap());
        assert_eq!(heard, b"own");
        drop(target);
        for _ in 0..3 {
            packets.send(b"nobody").unwrap();
            assert!(!packets.receive(clock.now() + Duration::from_millis(20), &mut heard).unwrap());
        }
    }

    #[test]
    fn addressed_devices_reply_to_broadcast() {
        let target = UdpSocket::bind("127.0.0.1:0").unwrap();
        let SocketAddr::V4(address) = target.local_addr().unwrap() else { panic!() };
        let clock = Arc::new(RealClock::start());
        let mut shout = UdpBroadcast::new(vec![address], clock.clone()).unwrap();
        shout.broadcast(b"who?").unwrap();
        let mut buffer = [0; 16];
        let (count, from) = target.recv_from(&mut buffer).unwrap();
        assert_eq!(&buffer[..count], b"who?");
        target.send_to(b"me", from).unwrap();
        let mut heard = Vec::new();
        let by = shout.receive(clock.now() + Duration::from_secs(5), &mut heard).unwrap();
        assert_eq!((by, heard.as_slice()), (Some(Ipv4Addr::LOCALHOST), &b"me"[..]));
        assert_eq!(shout.receive(clock.now() + Duration::from_millis(20), &mut heard).unwrap(), None);
    }

    #[test]
    fn sends_to_broadcast_address() {
        let of = |ip: [u8; 4], mask: [u8; 4]| {
            broadcast_address(&Ifv4Addr { ip: ip.into(), netmask: mask.into(), prefixlen: 0, broadcast: None })
        };
        assert_eq!(of([192, 168, 1, 7], [255, 255, 255, 0]), Some(Ipv4Addr::new(192, 168, 1, 255)));
        assert_eq!(of([10, 17, 3, 4], [255, 240, 0, 0]), Some(Ipv4Addr::new(10, 31, 255, 255)));
        assert_eq!(of([10, 7, 0, 1], [255, 255, 255, 255]), None);
        assert_eq!(of([10, 7, 0, 1], [0, 0, 0, 0]), None);
    }

    #[test]
    fn receives_long_datagrams_whole() {
        let (target, mut packets, clock) = pair();
        let long = vec![7; 9000];
        target.send_to(&long, ("127.0.0.1", packets.port())).unwrap();
        let mut heard = Vec::new();
        assert!(packets.receive(clock.now() + Duration::from_secs(5), &mut heard).unwrap());
        assert_eq!(heard, long);
    }

    #[test]
    fn wait_ends_with_packet_or_timeout() {
        let (sender, heard) = bounded(1);
        let clock = RealClock::start();
        let until = clock.now() + Duration::from_millis(5);
        assert_eq!(sleep_for_packet(&heard, until, &clock), Err(RecvTimeoutError::Timeout));
        assert!(clock.now() >= until);
        sender.send(b"in".to_vec()).unwrap();
        assert_eq!(sleep_for_packet(&heard, until, &clock), Ok(b"in".to_vec()), "also when the time is over");
        drop(sender);
        let later = clock.now() + Duration::from_secs(5);
        assert_eq!(sleep_for_packet(&heard, later, &clock), Err(RecvTimeoutError::Disconnected));
    }
}
