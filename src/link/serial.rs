//! Serial ports, usually of a USB–RS-485 converter (`serial:PATH`) or of an adapter (`bridge:PATH`). DTR and RTS keep
//! the state they have after opening.

use std::io::{ErrorKind, Read, Write};
use std::sync::Arc;
use std::time::Duration;

use serialport::{ClearBuffer, SerialPort, SerialPortBuilder, SerialPortType};

use super::{ByteLink, Clock, LinkError, LinkErrorKind};
use crate::units::{CharacterFormat, Moment, Parity};

/// An example of a serial port, with links to it.
pub struct PortExample {
    /// Name of the port.
    pub port: &'static str,
    /// Link to a device at the port.
    pub serial: &'static str,
    /// Link to an adapter at the port.
    pub bridge: &'static str,
}

/// An example of a port name on this operating system, with links to it.
pub const PORT_EXAMPLE: PortExample = if cfg!(windows) {
    PortExample { port: "COM3", serial: "serial:COM3", bridge: "bridge:COM3" }
} else {
    PortExample { port: "/dev/ttyUSB0", serial: "serial:/dev/ttyUSB0", bridge: "bridge:/dev/ttyUSB0" }
};

/// A serial port of this computer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortInfo {
    /// Path or name, as used in a link.
    pub path: String,
    /// Manufacturer and product of the adapter as reported by the system. May be empty.
    pub description: String,
    /// Serial number of the adapter, if it is connected over USB.
    pub serial_number: Option<String>,
}

/// Returns the serial ports of this computer, ordered by name. Pseudo-terminals can be opened but are not listed.
///
/// # Errors
/// Returns an error if the system does not list its ports.
pub fn ports() -> Result<Vec<PortInfo>, LinkError> {
    if !platform::can_list_ports() {
        return Ok(Vec::new());
    }
    let found = serialport::available_ports()
        .map_err(|error| LinkError::new("serial ports", LinkErrorKind::Other(error.description)))?;
    let mut ports: Vec<PortInfo> = found
        .into_iter()
        .map(|port| {
            let (description, serial_number) = match port.port_type {
                SerialPortType::UsbPort(usb) => {
                    let words: Vec<String> = [usb.manufacturer, usb.product].into_iter().flatten().collect();
                    (words.join(" "), usb.serial_number)
                }
                _ => (String::new(), None),
            };
            PortInfo { path: port.port_name, description, serial_number }
        })
        .collect();
    ports.sort_by(|a, b| split_port_number(&a.path).cmp(&split_port_number(&b.path)));
    Ok(ports)
}

/// Splits a port name into its text and number, so that `COM3` is sorted before `COM10`.
fn split_port_number(path: &str) -> (&str, u64, &str) {
    let name = path.trim_end_matches(|c: char| c.is_ascii_digit());
    (name, path.strip_prefix(name).and_then(|number| number.parse().ok()).unwrap_or(0), path)
}

/// Minimum time-out of a read. Windows treats a time-out of less than a millisecond as none, and waits until the buffer
/// is full.
const SHORTEST_TIMEOUT: Duration = if cfg!(windows) { Duration::from_millis(1) } else { Duration::ZERO };

/// An open serial port.
pub struct SerialLink {
    port: Box<dyn SerialPort>,
    target: String,
    clock: Arc<dyn Clock>,
}

impl SerialLink {
    /// Opens a port for exclusive use.
    ///
    /// # Errors
    /// Returns [`LinkErrorKind::NotFound`], [`Permission`](LinkErrorKind::Permission), [`Busy`](LinkErrorKind::Busy),
    /// [`NotAPort`](LinkErrorKind::NotAPort), [`Format`](LinkErrorKind::Format) or another system error.
    pub fn open(path: &str, format: CharacterFormat, clock: Arc<dyn Clock>) -> Result<Self, LinkError> {
        Self::open_configured(path, format, clock, |builder| builder)
    }

    /// Opens the port of an adapter with DTR asserted, because an edge on DTR resets many microcontrollers. Linux
    /// always asserts DTR on opening, and other systems do so on request.
    ///
    /// # Errors
    /// Returns the same errors as [`open`](Self::open).
    pub fn open_adapter(path: &str, format: CharacterFormat, clock: Arc<dyn Clock>) -> Result<Self, LinkError> {
        Self::open_configured(path, format, clock, |builder| builder.dtr_on_open(true))
    }

    fn open_configured(
        path: &str,
        format: CharacterFormat,
        clock: Arc<dyn Clock>,
        lines: impl FnOnce(SerialPortBuilder) -> SerialPortBuilder,
    ) -> Result<Self, LinkError> {
        let builder = serialport::new(path, format.baud.bits_per_second())
            .parity(parity(format.parity))
            .timeout(Duration::from_millis(10));
        let port = lines(builder).open().map_err(|error| LinkError::new(path, open_error_kind(path, &error)))?;
        let link = SerialLink { port, target: path.to_owned(), clock };
        link.warn_if_parity_differs(format);
        // Bytes from before the opening belong to no reply. If they cannot be cleared, they damage the first frame,
        // which is then requested again.
        let _ = link.port.clear(ClearBuffer::Input);
        Ok(link)
    }

    fn warn_if_parity_differs(&self, format: CharacterFormat) {
        if let Ok(actual) = self.port.parity()
            && actual != parity(format.parity)
        {
            tracing::warn!(
                "{}: the port does not take {} parity; the encoder may not understand",
                self.target,
                format.parity
            );
        }
    }

    fn connection_error(&self, error: &std::io::Error) -> LinkError {
        LinkError::from_io_error(&self.target, error)
    }
}

impl ByteLink for SerialLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let time_to_leave = Duration::from_secs(5);
        self.port
            .set_timeout(time_to_leave)
            .map_err(std::io::Error::from)
            .and_then(|()| self.port.write_all(bytes))
            .map_err(|error| self.connection_error(&error))
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        let mut buffer = [0; 512];
        loop {
            let left = until.duration_since(self.clock.now());
            self.port.set_timeout(left.max(SHORTEST_TIMEOUT)).map_err(|error| self.connection_error(&error.into()))?;
            match self.port.read(&mut buffer) {
                Ok(0) => return Err(LinkError::new(&self.target, LinkErrorKind::Lost)),
                Ok(count) => {
                    into.extend(buffer.iter().take(count));
                    return Ok(());
                }
                Err(error) if error.kind() == ErrorKind::TimedOut => {
                    if self.clock.now() >= until {
                        return Ok(());
                    }
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.connection_error(&error)),
            }
        }
    }

    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError> {
        let set = self
            .port
            .set_baud_rate(format.baud.bits_per_second())
            .and_then(|()| self.port.set_parity(parity(format.parity)));
        self.warn_if_parity_differs(format);
        set.map_err(|_| LinkError::new(&self.target, LinkErrorKind::Format(format.to_string())))
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        self.port.bytes_to_read().map(drop).map_err(|error| self.connection_error(&error.into()))
    }
}

fn parity(parity: Parity) -> serialport::Parity {
    match parity {
        Parity::None => serialport::Parity::None,
        Parity::Even => serialport::Parity::Even,
        Parity::Odd => serialport::Parity::Odd,
    }
}

/// System error message for a file without a baud rate, such as /dev/null.
const NOT_A_TERMINAL_MESSAGE: &str = "Not a typewriter";

fn open_error_kind(path: &str, error: &serialport::Error) -> LinkErrorKind {
    match error.kind {
        serialport::ErrorKind::Io(ErrorKind::NotFound) => LinkErrorKind::NotFound,
        serialport::ErrorKind::Io(ErrorKind::PermissionDenied) => platform::permission_error(path),
        serialport::ErrorKind::NoDevice if platform::path_exists(path) => LinkErrorKind::Busy,
        serialport::ErrorKind::NoDevice => LinkErrorKind::NotFound,
        _ if platform::is_not_serial_port(path) || error.description == NOT_A_TERMINAL_MESSAGE => {
            LinkErrorKind::NotAPort
        }
        serialport::ErrorKind::InvalidInput => LinkErrorKind::Format(error.description.clone()),
        _ => LinkErrorKind::Other(error.description.clone()),
    }
}

#[cfg(unix)]
mod platform {
    //! Systems on which ports are files owned by a group.

    use std::os::unix::fs::{FileTypeExt, MetadataExt};
    use std::path::Path;

    use super::LinkErrorKind;

    /// Returns whether `serialport` can list ports. On Linux, the crate reads this folder without checking that it
    /// exists.
    pub(super) fn can_list_ports() -> bool {
        !cfg!(target_os = "linux") || Path::new("/sys/class/tty").is_dir()
    }

    pub(super) fn path_exists(path: &str) -> bool {
        Path::new(path).exists()
    }

    pub(super) fn is_not_serial_port(path: &str) -> bool {
        std::fs::metadata(path).is_ok_and(|file| !file.file_type().is_char_device())
    }

    pub(super) fn permission_error(path: &str) -> LinkErrorKind {
        let group = std::fs::metadata(path).ok().and_then(|file| group_name(file.gid()));
        LinkErrorKind::Permission { group }
    }

    /// Returns the name of a group. Returns `None` for `root`, because a message must not advise users to join that
    /// group.
    fn group_name(gid: u32) -> Option<String> {
        let groups = std::fs::read_to_string("/etc/group").ok()?;
        let id = gid.to_string();
        groups
            .lines()
            .find(|line| line.split(':').nth(2) == Some(&id))
            .and_then(|line| line.split(':').next())
            .filter(|name| *name != "root")
            .map(ToOwned::to_owned)
    }
}

#[cfg(not(unix))]
mod platform {
    //! Systems on which ports have names such as `COM3` and no owner. Opening a port that is in use fails with "access
    //! denied".

    use super::LinkErrorKind;

    pub(super) fn can_list_ports() -> bool {
        true
    }

    pub(super) fn path_exists(path: &str) -> bool {
        serialport::available_ports()
            .is_ok_and(|ports| ports.iter().any(|port| port.port_name.eq_ignore_ascii_case(path)))
    }

    pub(super) fn is_not_serial_port(_path: &str) -> bool {
        false
    }

    pub(super) fn permission_error(_path: &str) -> LinkErrorKind {
        LinkErrorKind::Busy
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorts_ports_by_number() {
        let mut ports = ["COM10", "/dev/ttyUSB10", "COM3", "/dev/ttyUSB2", "/dev/ttyS0", "COM"];
        ports.sort_by_key(|path| split_port_number(path));
        assert_eq!(ports, ["/dev/ttyS0", "/dev/ttyUSB2", "/dev/ttyUSB10", "COM", "COM3", "COM10"]);
    }

    #[cfg(unix)]
    #[test]
    fn open_failures_have_distinct_kinds() {
        let error = |kind| serialport::Error::new(kind, "words of the system");
        let io = |kind| error(serialport::ErrorKind::Io(kind));
        assert_eq!(open_error_kind("/dev/nope", &io(ErrorKind::NotFound)), LinkErrorKind::NotFound);
        assert_eq!(open_error_kind("/dev/null", &error(serialport::ErrorKind::NoDevice)), LinkErrorKind::Busy);
        assert_eq!(open_error_kind("/dev/nope", &error(serialport::ErrorKind::NoDevice)), LinkErrorKind::NotFound);
        let denied = open_error_kind("/dev/null", &io(ErrorKind::PermissionDenied));
        assert!(matches!(denied, LinkErrorKind::Permission { .. }), "{denied:?}");
        assert_eq!(open_error_kind("/", &error(serialport::ErrorKind::Unknown)), LinkErrorKind::NotAPort);
    }
}
