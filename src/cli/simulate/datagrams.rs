//! Serves a virtual device over TCP and UDP on the same port number. The sending thread sleeps until a packet is due,
//! because socket time-outs only have the resolution of the system tick.

use std::io::ErrorKind;
use std::net::{SocketAddr, SocketAddrV4, TcpListener, ToSocketAddrs, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::Scope;
use std::time::Duration;

use super::IDLE_WAIT;
use crate::link::{Clock, RealClock, request_realtime_priority};
use crate::sim::DatagramDevice;

/// Maximum sleep of the sending thread. Every packet is due at least this long after its request.
const MAX_SLEEP: Duration = Duration::from_millis(4);
/// Number of ports to try if the port is not specified.
const PORTS_TO_TRY: usize = 50;
/// Buffer size in bytes, larger than any packet.
const BUFFER_SIZE: usize = 2048;

/// Binds a TCP and a UDP socket to the same IPv4 port number. Port 0 selects a number that is free for both.
pub(super) fn bind_tcp_and_udp(address: &str) -> std::io::Result<(TcpListener, UdpSocket, SocketAddrV4)> {
    let mut last = std::io::Error::from(ErrorKind::AddrNotAvailable);
    for place in address.to_socket_addrs()? {
        let SocketAddr::V4(place) = place else { continue };
        let tries = if place.port() == 0 { PORTS_TO_TRY } else { 1 };
        for _ in 0..tries {
            match bind_both(place) {
                Ok(bound) => return Ok(bound),
                Err(error) => last = error,
            }
        }
    }
    Err(last)
}

fn bind_both(place: SocketAddrV4) -> std::io::Result<(TcpListener, UdpSocket, SocketAddrV4)> {
    let listener = TcpListener::bind(place)?;
    let at = SocketAddrV4::new(*place.ip(), listener.local_addr()?.port());
    let socket = UdpSocket::bind(at)?;
    socket.set_read_timeout(Some(IDLE_WAIT))?;
    Ok((listener, socket, at))
}

pub(super) struct ServedDevice {
    socket: UdpSocket,
    /// The device. It is locked while its packets are taken and sent, so packets cannot overtake each other.
    device: Mutex<Box<dyn DatagramDevice>>,
    clock: Arc<RealClock>,
}

impl ServedDevice {
    pub(super) fn new(socket: UdpSocket, device: Box<dyn DatagramDevice>, clock: Arc<RealClock>) -> Self {
        ServedDevice { socket, device: Mutex::new(device), clock }
    }

    /// Receives and sends packets until the program is interrupted.
    ///
    /// # Errors
    /// Returns an error if no thread could be started.
    pub(super) fn start<'scope>(
        &'scope self,
        scope: &'scope Scope<'scope, '_>,
        ended: &'scope AtomicBool,
    ) -> std::io::Result<()> {
        let named = |name: &str| std::thread::Builder::new().name(name.to_owned());
        named("datagrams in").spawn_scoped(scope, move || self.receive(ended))?;
        named("datagrams out").spawn_scoped(scope, move || self.send(ended))?;
        Ok(())
    }

    fn receive(&self, ended: &AtomicBool) {
        request_realtime_priority();
        let mut buffer = [0; BUFFER_SIZE];
        while !ended.load(Ordering::SeqCst) {
            match self.socket.recv_from(&mut buffer) {
                Ok((count, SocketAddr::V4(from))) => {
                    let packet = buffer.get(..count).unwrap_or_default();
                    self.drive_device(|device, clock| device.on_datagram(clock.now(), from, packet));
                }
                Ok(_) => {}
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                // Some systems report here that an earlier packet had no receiver.
                Err(_) => std::thread::sleep(Duration::from_millis(1)),
            }
        }
    }

    fn send(&self, ended: &AtomicBool) {
        request_realtime_priority();
        while !ended.load(Ordering::SeqCst) {
            let next = self.drive_device(|_, _| ());
            std::thread::sleep(next.min(MAX_SLEEP));
        }
    }

    /// Calls `work` with the device and sends all packets that are due. Returns the time until the next packet is due.
    fn drive_device(&self, work: impl FnOnce(&mut dyn DatagramDevice, &RealClock)) -> Duration {
        let mut device = self.device.lock().unwrap_or_else(PoisonError::into_inner);
        work(&mut **device, &self.clock);
        for (to, packet) in device.poll_datagrams(self.clock.now()) {
            // A packet that cannot be sent is lost, as on any network.
            let _ = self.socket.send_to(&packet, to);
        }
        device.poll_datagrams_at().map_or(MAX_SLEEP, |next| next.duration_since(self.clock.now()))
    }
}
