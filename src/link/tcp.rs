//! `tcp:HOST:PORT` — the same bytes through a serial device server in raw mode. Speed and parity are set at the server.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::time::Duration;

use super::{ByteLink, Clock, LinkError, LinkErrorKind};
use crate::units::{CharacterFormat, Moment};

/// A raw TCP connection.
pub struct TcpLink {
    stream: TcpStream,
    target: String,
    clock: Arc<dyn Clock>,
}

impl TcpLink {
    const CONNECT_TIME: Duration = Duration::from_secs(3);

    /// Connects to `host:port`.
    ///
    /// # Errors
    /// [`LinkErrorKind::NotFound`] for a name that nobody knows, [`LinkErrorKind::Unreachable`] where nobody answers.
    pub fn connect(target: &str, clock: Arc<dyn Clock>) -> Result<Self, LinkError> {
        let fail = |kind| LinkError::new(target, kind);
        let addresses = target.to_socket_addrs().map_err(|_| fail(LinkErrorKind::NotFound))?;
        let mut reason = fail(LinkErrorKind::NotFound);
        for address in addresses {
            match TcpStream::connect_timeout(&address, Self::CONNECT_TIME) {
                Ok(stream) => {
                    // A frame must not wait for more bytes; where that cannot be asked for, it is only slower.
                    let _ = stream.set_nodelay(true);
                    return Ok(TcpLink { stream, target: target.to_owned(), clock });
                }
                Err(error) => reason = fail(LinkErrorKind::Unreachable(error.to_string())),
            }
        }
        Err(reason)
    }

    fn lost(&self, error: &std::io::Error) -> LinkError {
        LinkError::during_use(&self.target, error)
    }
}

impl ByteLink for TcpLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.stream.write_all(bytes).map_err(|error| self.lost(&error))
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        let mut buffer = [0; 512];
        loop {
            let left = until.since(self.clock.now());
            // Zero would mean "wait for ever".
            let patience = left.max(Duration::from_micros(100));
            self.stream.set_read_timeout(Some(patience)).map_err(|error| self.lost(&error))?;
            match self.stream.read(&mut buffer) {
                Ok(0) => return Err(LinkError::new(&self.target, LinkErrorKind::Lost)),
                Ok(count) => {
                    into.extend(buffer.iter().take(count));
                    return Ok(());
                }
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                    if self.clock.now() >= until {
                        return Ok(());
                    }
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.lost(&error)),
            }
        }
    }

    fn set_format(&mut self, _format: CharacterFormat) -> Result<(), LinkError> {
        Ok(())
    }

    fn sets_format(&self) -> bool {
        false
    }

    fn check(&mut self) -> Result<(), LinkError> {
        let mut byte = [0];
        let peeked =
            self.stream.set_read_timeout(Some(Duration::from_micros(100))).and_then(|()| self.stream.peek(&mut byte));
        match peeked {
            Ok(0) => Err(LinkError::new(&self.target, LinkErrorKind::Lost)),
            Ok(_) => Ok(()),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => Ok(()),
            Err(error) => Err(self.lost(&error)),
        }
    }
}
