//! A proxy between a host and a target whose connections can be cut. It forwards the TCP stream and the UDP packets.
//! When a connection is opened, it replaces the packets' ports with its own.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, AtomicU16, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{JoinHandle, spawn};
use std::time::Duration;

/// The direction of a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Transport {
    ToTarget,
    ToHost,
}

pub(super) struct Wires {
    place: String,
    shared: Arc<Shared>,
}

struct Shared {
    /// Both ends of the TCP stream.
    streams: Mutex<Vec<TcpStream>>,
    /// Sockets that receive the packets of the host and those of the target.
    sockets: [UdpSocket; 2],
    cut: [AtomicBool; 2],
    /// Port at which the host receives packets.
    host: AtomicU16,
    target: u16,
    end: AtomicBool,
}

/// A guard that sends random bytes in both directions until it is ended.
pub(super) struct Flood {
    end: Arc<AtomicBool>,
    sent: Arc<AtomicU64>,
    thread: JoinHandle<()>,
}

impl Wires {
    /// Creates the proxy for a target at `host:port`.
    pub(super) fn to(target: &str) -> Self {
        let port = target.rsplit(':').next().unwrap().parse().unwrap();
        let socket = || {
            let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
            socket.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
            socket
        };
        let shared = Arc::new(Shared {
            streams: Mutex::default(),
            sockets: [socket(), socket()],
            cut: Default::default(),
            host: AtomicU16::new(0),
            target: port,
            end: AtomicBool::new(false),
        });
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let place = listener.local_addr().unwrap().to_string();
        let (passing, target) = (shared.clone(), target.to_owned());
        spawn(move || {
            let (host, _) = listener.accept().unwrap();
            let target = TcpStream::connect(target).unwrap();
            passing.streams.lock().unwrap().extend([host.try_clone().unwrap(), target.try_clone().unwrap()]);
            let (from, to, way) = (host.try_clone().unwrap(), target.try_clone().unwrap(), passing.clone());
            spawn(move || way.pass_stream(from, to, 0x8001, 1));
            spawn(move || passing.pass_stream(target, host, 0x8000, 0));
        });
        for way in [Transport::ToTarget, Transport::ToHost] {
            let passing = shared.clone();
            spawn(move || passing.pass_packets(way));
        }
        Wires { place, shared }
    }

    pub(super) fn place(&self) -> String {
        self.place.clone()
    }

    pub(super) fn cut_stream(&self) {
        for stream in self.shared.streams.lock().unwrap().iter() {
            // One of the streams may already have ended.
            let _ = stream.shutdown(Shutdown::Both);
        }
    }

    pub(super) fn cut(&self, way: Transport) {
        self.shared.cut[way as usize].store(true, Ordering::SeqCst);
    }

    pub(super) fn restore(&self, way: Transport) {
        self.shared.cut[way as usize].store(false, Ordering::SeqCst);
    }

    /// Sends random bytes to both ports until it is stopped.
    pub(super) fn flood(&self) -> Flood {
        let (end, sent) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicU64::new(0)));
        let ports = [self.shared.target, self.shared.host.load(Ordering::SeqCst)];
        let (ends, counts) = (end.clone(), sent.clone());
        let thread = spawn(move || {
            let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
            let mut dice = fastrand::Rng::with_seed(1);
            while !ends.load(Ordering::SeqCst) {
                let packet: Vec<u8> = (0..dice.usize(0..80)).map(|_| dice.u8(..)).collect();
                for port in ports {
                    // If the buffer is full, the packet is dropped.
                    let _ = socket.send_to(&packet, ("127.0.0.1", port));
                }
                // Yields the processor to other threads.
                if counts.fetch_add(1, Ordering::SeqCst) % 20 == 0 {
                    std::thread::sleep(Duration::from_millis(1));
                }
            }
        });
        Flood { end, sent, thread }
    }
}

impl Flood {
    /// Stops sending and returns the number of packets sent.
    pub(super) fn end(self) -> u64 {
        self.end.store(true, Ordering::SeqCst);
        self.thread.join().unwrap();
        self.sent.load(Ordering::SeqCst)
    }
}

impl Drop for Wires {
    fn drop(&mut self) {
        self.shared.end.store(true, Ordering::SeqCst);
        self.cut_stream();
    }
}

impl Shared {
    /// Forwards a stream, with each frame in one piece. The port in an address item of type `item` is replaced with
    /// that of one of the proxy's sockets.
    fn pass_stream(&self, mut from: TcpStream, mut to: TcpStream, item: u16, ours: usize) {
        let mut buffer = [0; 4096];
        while let Ok(count) = from.read(&mut buffer) {
            if count == 0 {
                break;
            }
            let bytes = &mut buffer[..count];
            // The item's type and length, and the address family, whose high byte comes first.
            let [low, high] = item.to_le_bytes();
            let head = [low, high, 16, 0, 0, 2];
            if let Some(at) = bytes.windows(6).position(|window| window == head) {
                let port = &mut bytes[at + 6..at + 8];
                if item == 0x8001 {
                    self.host.store(u16::from_be_bytes([port[0], port[1]]), Ordering::SeqCst);
                }
                port.copy_from_slice(&self.sockets[ours].local_addr().unwrap().port().to_be_bytes());
            }
            if to.write_all(bytes).is_err() {
                break;
            }
        }
        let _ = to.shutdown(Shutdown::Both);
    }

    fn pass_packets(&self, way: Transport) {
        let (socket, other) = match way {
            Transport::ToTarget => (&self.sockets[0], &self.sockets[1]),
            Transport::ToHost => (&self.sockets[1], &self.sockets[0]),
        };
        let mut buffer = [0; 1500];
        while !self.end.load(Ordering::SeqCst) {
            let Ok((count, _)) = socket.recv_from(&mut buffer) else { continue };
            let port = match way {
                Transport::ToTarget => self.target,
                Transport::ToHost => self.host.load(Ordering::SeqCst),
            };
            if !self.cut[way as usize].load(Ordering::SeqCst) {
                // The receiver may no longer exist.
                let _ = other.send_to(&buffer[..count], ("127.0.0.1", port));
            }
        }
    }
}
