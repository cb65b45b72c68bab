//! Serves a virtual device to other programs on a pseudo-terminal or a TCP port, and over UDP for devices that require
//! it. Only this module runs virtual devices in real time.

mod datagrams;

use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::args::SimulateArgs;
use super::output::Output;
use super::{Failure, Result, Success};
use crate::link::{Clock, RealClock};
use crate::sim::{ByteDevice, DatagramDevice};
use crate::units::{Baud, CharacterFormat, Moment};

/// Time to wait for bytes while the device is idle. A Ctrl-C is delayed by at most this time.
const IDLE_WAIT: Duration = Duration::from_millis(20);
/// Waiting time below which the thread sleeps, because socket time-outs only have the resolution of the system tick.
const SLEEP_THRESHOLD: Duration = Duration::from_millis(10);

/// A virtual device that can be served.
pub trait ServableDevice: ByteDevice {
    /// Returns the line format at `now`. Returns `None` if the device has no serial line or is not receiving.
    fn line_format(&self, _now: Moment) -> Option<CharacterFormat> {
        None
    }

    /// Returns a device for another simultaneous client at the given address. Returns `None` if the device has a single
    /// line, so that clients are served one after another.
    fn clone_for_peer(&self, _peer: Ipv4Addr) -> Option<Box<dyn ServableDevice>> {
        None
    }

    /// Returns the UDP side of the same device, which is served on the same port number as TCP.
    fn datagram_device(&self) -> Option<Box<dyn DatagramDevice>> {
        None
    }

    fn on_listening(&self, _at: SocketAddrV4) {}

    fn has_ended(&self) -> bool {
        false
    }
}

pub(super) fn run_simulation(output: &Output, arguments: &SimulateArgs) -> Result {
    let kind = output.commands().device(&arguments.device)?;
    let simulated = kind.create_simulated(output, arguments)?;
    let ended = Arc::new(AtomicBool::new(false));
    let end = ended.clone();
    ctrlc::set_handler(move || end.store(true, Ordering::SeqCst))
        .map_err(|error| Failure::Failed(vec![format!("Could not install the Ctrl-C handler: {error}.")]))?;
    let mut device = Device { kind: kind.name(), simulated, clock: Arc::new(RealClock::start()) };
    match (&arguments.pty, &arguments.listen) {
        (Some(path), _) => terminal::serve_path(path, &mut device, &ended)?,
        (None, Some(address)) => serve_tcp(address, &mut device, &ended)?,
        (None, None) => return Err(Failure::Usage("simulate needs --pty PATH or --listen ADDR".to_owned())),
    }
    Ok(Success::Completed)
}

pub fn settings(output: &Output, arguments: &SimulateArgs) -> Result<Vec<(String, String)>> {
    let mut pairs: Vec<(String, String)> = Vec::new();
    for setting in &arguments.settings {
        let (name, value) =
            setting.split_once('=').ok_or_else(|| Failure::Usage(format!("{setting:?} is not NAME=VALUE")))?;
        pairs.push((name.to_owned(), value.to_owned()));
    }
    for option in output.commands().devices().iter().flat_map(|device| device.setting_options()) {
        let name = option.get_id().as_str();
        pairs.extend(arguments.own.text(name).map(|value| (name.to_owned(), value.clone())));
    }
    pairs.extend(arguments.seed.map(|seed| ("seed".to_owned(), seed.to_string())));
    pairs.extend(arguments.fault.clone().map(|fault| ("fault".to_owned(), fault)));
    Ok(pairs)
}

struct Device {
    kind: &'static str,
    simulated: Box<dyn ServableDevice>,
    clock: Arc<RealClock>,
}

enum ReadOutcome {
    Bytes(usize),
    Nothing,
    End,
}

impl Device {
    fn clone_for_peer(&self, peer: SocketAddr) -> Option<Device> {
        let address = match peer {
            SocketAddr::V4(peer) => *peer.ip(),
            SocketAddr::V6(peer) => peer.ip().to_ipv4_mapped().unwrap_or(Ipv4Addr::UNSPECIFIED),
        };
        let simulated = self.simulated.clone_for_peer(address)?;
        Some(Device { kind: self.kind, simulated, clock: self.clock.clone() })
    }

    /// Serves a client until it disconnects or the program is interrupted. The device adopts the client's baud rate if
    /// this can be read.
    fn serve_client(&mut self, client: &mut impl SimulatorClient, ended: &AtomicBool) -> std::io::Result<()> {
        self.simulated.connect(self.clock.now());
        let mut buffer = [0; 512];
        while !ended.load(Ordering::SeqCst) {
            let now = self.clock.now();
            let wait = self.simulated.poll_at().map_or(IDLE_WAIT, |next| next.duration_since(now).min(IDLE_WAIT));
            let outcome = client.read(&mut buffer, wait)?;
            let now = self.clock.now();
            self.apply_client_baud(client.baud());
            match outcome {
                ReadOutcome::Bytes(count) => self.simulated.on_bytes(now, buffer.get(..count).unwrap_or_default()),
                ReadOutcome::Nothing => {}
                ReadOutcome::End => return Ok(()),
            }
            let reply = self.simulated.poll(self.clock.now());
            if !reply.is_empty() {
                client.write(&reply)?;
            }
            if self.simulated.has_ended() {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Adopts the baud rate of the client. Over TCP, neither baud rate nor parity can be read, and on a pseudo-terminal
    /// the parity cannot. Properties that cannot be read are assumed to match.
    fn apply_client_baud(&mut self, baud: Option<Baud>) {
        let now = self.clock.now();
        if let Some(own) = self.simulated.line_format(now) {
            let format = CharacterFormat { baud: baud.unwrap_or(own.baud), parity: own.parity };
            self.simulated.set_host_format(now, format);
        }
    }

    /// Prints the address of the device. Scripts wait for this line.
    fn print_ready(&self, place: &str) -> Result<()> {
        let mut out = std::io::stdout().lock();
        writeln!(out, "ready {} {place}", self.kind)
            .and_then(|()| out.flush())
            .map_err(|error| Failure::Failed(vec![format!("Could not print the result: {error}.")]))
    }
}

trait SimulatorClient {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> std::io::Result<ReadOutcome>;
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<()>;
    fn baud(&self) -> Option<Baud>;
}

impl SimulatorClient for TcpStream {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> std::io::Result<ReadOutcome> {
        if wait >= SLEEP_THRESHOLD {
            self.set_read_timeout(Some(wait))?;
            return Ok(read_outcome(Read::read(self, buffer)));
        }
        self.set_nonblocking(true)?;
        let mut came = read_outcome(Read::read(self, buffer));
        if matches!(came, ReadOutcome::Nothing) {
            std::thread::sleep(wait);
            came = read_outcome(Read::read(self, buffer));
        }
        self.set_nonblocking(false)?;
        Ok(came)
    }

    fn write(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        match self.write_all(bytes) {
            // A client that does not read streamed data in time loses them.
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => Ok(()),
            ended => ended,
        }
    }

    fn baud(&self) -> Option<Baud> {
        None
    }
}

fn read_outcome(read: std::io::Result<usize>) -> ReadOutcome {
    match read {
        Ok(0) => ReadOutcome::End,
        Ok(count) => ReadOutcome::Bytes(count),
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted) => {
            ReadOutcome::Nothing
        }
        Err(_) => ReadOutcome::End,
    }
}

fn serve_tcp(address: &str, device: &mut Device, ended: &AtomicBool) -> Result<()> {
    let cannot = |error: std::io::Error| match error.kind() {
        ErrorKind::InvalidInput => Failure::Usage(format!("{address} is not HOST:PORT, such as 127.0.0.1:4001")),
        ErrorKind::AddrInUse => {
            let what = "the address is in use by another program; stop that program, or choose another port";
            Failure::Failed(vec![format!("{address}: {what}.")])
        }
        _ => Failure::Failed(vec![format!(
            "{address}: cannot listen on this address: {error}. Use an address of this computer, such as \
             127.0.0.1:4001."
        )]),
    };
    let (listener, packets) = match device.simulated.datagram_device() {
        Some(own) => {
            let (listener, socket, at) = datagrams::bind_tcp_and_udp(address).map_err(cannot)?;
            device.simulated.on_listening(at);
            (listener, Some(datagrams::ServedDevice::new(socket, own, device.clock.clone())))
        }
        None => (TcpListener::bind(address).map_err(cannot)?, None),
    };
    listener.set_nonblocking(true).map_err(cannot)?;
    // The scope ends when all clients have disconnected.
    std::thread::scope(|scope| {
        let begun = packets
            .iter()
            .try_for_each(|packets| packets.start(scope, ended))
            .and_then(|()| listener.local_addr())
            .map_err(cannot)
            .and_then(|at| device.print_ready(&at.to_string()));
        // Otherwise, the thread that sends the packets would run forever, because the program has not started.
        begun.inspect_err(|_| ended.store(true, Ordering::SeqCst))?;
        while !ended.load(Ordering::SeqCst) {
            let Ok((client, peer)) = listener.accept() else {
                std::thread::sleep(IDLE_WAIT);
                continue;
            };
            match device.clone_for_peer(peer) {
                None => serve_tcp_client(device, client, ended),
                Some(mut own) => {
                    let attended = move || serve_tcp_client(&mut own, client, ended);
                    // If no thread can be started, the client is disconnected.
                    let _ = std::thread::Builder::new().spawn_scoped(scope, attended);
                }
            }
        }
        Ok(())
    })
}

/// Serves a client over TCP. If a client cannot be served, it is disconnected, and the next one may connect.
fn serve_tcp_client(device: &mut Device, mut client: TcpStream, ended: &AtomicBool) {
    let _ = client
        .set_nonblocking(false)
        .and_then(|()| client.set_nodelay(true))
        .and_then(|()| client.set_write_timeout(Some(IDLE_WAIT * 10)))
        .and_then(|()| device.serve_client(&mut client, ended));
}

#[cfg(unix)]
mod terminal {
    //! Pseudo-terminals. Only the client opens the other end. When the client closes it, this end detects a hang-up,
    //! and the virtual device is powered on again for the next client.

    use std::io::{ErrorKind, Read, Write};
    use std::os::unix::fs::symlink;
    use std::path::{Path, PathBuf};
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::Duration;

    use serialport::{SerialPort, TTYPort};

    use super::{Clock as _, Device, Failure, IDLE_WAIT, ReadOutcome, Result, SimulatorClient};
    use crate::units::Baud;

    pub(super) fn serve_path(path: &Path, device: &mut Device, ended: &AtomicBool) -> Result<()> {
        let cannot = |what: String| Failure::Failed(vec![format!("{}: {what}.", path.display())]);
        let (mut master, mut slave) = TTYPort::pair().map_err(|error| cannot(error.description))?;
        let name = slave.name().ok_or_else(|| cannot("the pseudo-terminal has no name".to_owned()))?;
        // The terminal has the speed of the encoder until a client sets another one.
        if let Some(own) = device.simulated.line_format(device.clock.now()) {
            let _ = slave.set_baud_rate(own.baud.bits_per_second());
        }
        drop(slave);
        let _link = SymbolicLink::create(path, Path::new(&name)).map_err(|error| match error.kind() {
            ErrorKind::AlreadyExists => cannot("the path already exists; remove it, or choose another path".into()),
            ErrorKind::NotFound => cannot("the folder does not exist; create it, or choose another path".into()),
            _ => cannot(error.to_string()),
        })?;
        device.print_ready(&path.display().to_string())?;
        while !ended.load(Ordering::SeqCst) {
            device.serve_client(&mut master, ended).map_err(|error| cannot(error.to_string()))?;
            wait_for_client(&mut master, ended);
        }
        Ok(())
    }

    /// A symbolic link that is removed when the program ends.
    struct SymbolicLink {
        path: PathBuf,
        target: PathBuf,
    }

    impl SymbolicLink {
        /// Creates the link. A dangling link left by an earlier run is replaced. Any other existing file belongs to
        /// another program and causes an error.
        fn create(path: &Path, target: &Path) -> std::io::Result<Self> {
            if path.is_symlink() && !path.exists() {
                std::fs::remove_file(path)?;
            }
            symlink(target, path)?;
            Ok(SymbolicLink { path: path.to_owned(), target: target.to_owned() })
        }
    }

    impl Drop for SymbolicLink {
        fn drop(&mut self) {
            if std::fs::read_link(&self.path).is_ok_and(|target| target == self.target) {
                // This is the program's own link. If it cannot be removed, the next run replaces it.
                let _ = std::fs::remove_file(&self.path);
            }
        }
    }

    fn wait_for_client(master: &mut TTYPort, ended: &AtomicBool) {
        while !ended.load(Ordering::SeqCst) {
            match master.bytes_to_read() {
                Ok(0) if has_hung_up(master) => std::thread::sleep(IDLE_WAIT / 4),
                _ => return,
            }
        }
    }

    /// Returns whether no client has the other end open.
    fn has_hung_up(master: &mut TTYPort) -> bool {
        let _ = master.set_timeout(Duration::ZERO);
        matches!(Read::read(master, &mut []), Err(error) if error.kind() != ErrorKind::TimedOut)
    }

    impl SimulatorClient for TTYPort {
        fn read(&mut self, buffer: &mut [u8], wait: Duration) -> std::io::Result<ReadOutcome> {
            self.set_timeout(wait)?;
            match Read::read(self, buffer) {
                Ok(0) => Ok(ReadOutcome::End),
                Ok(count) => Ok(ReadOutcome::Bytes(count)),
                Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted) => {
                    Ok(ReadOutcome::Nothing)
                }
                Err(_) => Ok(ReadOutcome::End),
            }
        }

        fn write(&mut self, bytes: &[u8]) -> std::io::Result<()> {
            // A client that disconnects in the meantime does not receive the reply, as on a real line.
            let _ = self.write_all(bytes);
            Ok(())
        }

        fn baud(&self) -> Option<Baud> {
            self.baud_rate().ok().and_then(Baud::new)
        }
    }
}

#[cfg(not(unix))]
mod terminal {
    //! Fallback for systems without pseudo-terminals.

    use std::path::Path;
    use std::sync::atomic::AtomicBool;

    use super::{Device, Failure, Result};

    pub(super) fn serve_path(_path: &Path, _device: &mut Device, _ended: &AtomicBool) -> Result<()> {
        Err(Failure::Usage("this system has no pseudo-terminals: use --listen ADDR".to_owned()))
    }
}
