//! `tcp:HOST:PORT`: a serial device server in raw mode. Baud rate and parity are set on the server.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::time::Duration;

use super::{ByteLink, Clock, LinkError, LinkErrorKind};
use crate::units::{CharacterFormat, Moment};

/// A raw TCP connection to a serial device server.
pub struct TcpLink {
    stream: TcpStream,
    target: String,
    clock: Arc<dyn Clock>,
}

impl TcpLink {
    const CONNECT_TIME: Duration = Duration::from_secs(3);
    /// Duration below which a wait polls the socket, because socket time-outs have the resolution of the system tick.
    const POLL_THRESHOLD: Duration = Duration::from_millis(10);
    const POLL_INTERVAL: Duration = Duration::from_micros(500);

    /// Connects to `host:port`.
    ///
    /// # Errors
    /// Returns [`LinkErrorKind::NotFound`] for an unknown name, or [`LinkErrorKind::Unreachable`] if there is no
    /// response.
    pub fn connect(target: &str, clock: Arc<dyn Clock>) -> Result<Self, LinkError> {
        let fail = |kind| LinkError::new(target, kind);
        let addresses = target.to_socket_addrs().map_err(|_| fail(LinkErrorKind::NotFound))?;
        let mut reason = fail(LinkErrorKind::NotFound);
        for address in addresses {
            match TcpStream::connect_timeout(&address, Self::CONNECT_TIME) {
                Ok(stream) => {
                    // Frames are sent without waiting for more bytes. Without this option, the connection is only
                    // slower.
                    let _ = stream.set_nodelay(true);
                    return Ok(TcpLink { stream, target: target.to_owned(), clock });
                }
                Err(error) => reason = fail(LinkErrorKind::Unreachable(error.to_string())),
            }
        }
        Err(reason)
    }

    /// Reads bytes, polling instead of blocking if the wait is short.
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> std::io::Result<usize> {
        if wait >= Self::POLL_THRESHOLD {
            self.stream.set_read_timeout(Some(wait))?;
            return self.stream.read(buffer);
        }
        self.stream.set_nonblocking(true)?;
        let read = self.stream.read(buffer);
        self.stream.set_nonblocking(false)?;
        read
    }

    fn connection_error(&self, error: &std::io::Error) -> LinkError {
        LinkError::from_io_error(&self.target, error)
    }
}

impl ByteLink for TcpLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.stream.write_all(bytes).map_err(|error| self.connection_error(&error))
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        let mut buffer = [0; 512];
        loop {
            let left = until.duration_since(self.clock.now());
            match self.read(&mut buffer, left) {
                Ok(0) => return Err(LinkError::new(&self.target, LinkErrorKind::Lost)),
                Ok(count) => {
                    into.extend(buffer.iter().take(count));
                    return Ok(());
                }
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                    let now = self.clock.now();
                    if now >= until {
                        return Ok(());
                    }
                    if left < Self::POLL_THRESHOLD {
                        self.clock.sleep_until(until.min(now + Self::POLL_INTERVAL));
                    }
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.connection_error(&error)),
            }
        }
    }

    fn set_format(&mut self, _format: CharacterFormat) -> Result<(), LinkError> {
        Ok(())
    }

    fn can_set_format(&self) -> bool {
        false
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        let mut byte = [0];
        let peeked = self.stream.set_nonblocking(true).and_then(|()| self.stream.peek(&mut byte));
        self.stream.set_nonblocking(false).map_err(|error| self.connection_error(&error))?;
        match peeked {
            Ok(0) => Err(LinkError::new(&self.target, LinkErrorKind::Lost)),
            Ok(_) => Ok(()),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => Ok(()),
            Err(error) => Err(self.connection_error(&error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::RealClock;
    use std::net::TcpListener;

    /// Without polling, each of a hundred short waits would last until the next system tick, up to a second in total.
    #[test]
    fn polling_does_not_wait() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let clock = Arc::new(RealClock::start());
        let target = listener.local_addr().unwrap().to_string();
        let mut link = TcpLink::connect(&target, clock.clone()).unwrap();
        let (mut peer, _) = listener.accept().unwrap();
        let mut bytes = Vec::new();
        let begun = clock.now();
        for _ in 0..100 {
            link.receive(clock.now(), &mut bytes).unwrap();
            link.check_connection().unwrap();
        }
        assert!(
            clock.now().duration_since(begun) < Duration::from_millis(200),
            "{:?}",
            clock.now().duration_since(begun)
        );
        let until = clock.now() + Duration::from_millis(5);
        link.receive(until, &mut bytes).unwrap();
        assert!(clock.now() >= until && bytes.is_empty());
        peer.write_all(b"abc").unwrap();
        link.receive(clock.now() + Duration::from_secs(5), &mut bytes).unwrap();
        assert_eq!(bytes, b"abc");
        link.send(b"x").unwrap();
        drop(peer);
        let lost = (0..100).find_map(|_| link.receive(clock.now() + Duration::from_millis(5), &mut bytes).err());
        assert!(lost.is_some_and(|error| error.is_lost()));
    }
}
