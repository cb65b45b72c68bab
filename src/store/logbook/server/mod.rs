//! The server for a shared logbook. Several computers send their entries to one PostgreSQL database and receive those
//! of the others. A write is always recorded in the local file first and never waits for the server.

mod address;
mod client;
mod error;
mod hold;
mod keyring;
mod schema;
mod transfer;

use std::fmt;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, TryLockError};
use std::thread;
use std::time::{Duration, Instant};

use jiff::Timestamp;

pub use address::{Password, ServerAddress, ServerAddressError};
pub use error::{ServerError, ServerErrorKind, UnreachableCause};
pub use hold::{DeviceHold, OtherHolder};
pub use keyring::KeyringError;
pub use transfer::Transferred;

use super::entry::DeviceKey;
use client::Client;

/// Interval at which a thread checks whether another thread has finished its transfer.
const RETRY: Duration = Duration::from_millis(5);
/// Time for which a failed attempt is not repeated, so that the steps of a command do not all wait for an unreachable
/// server.
const FAILURE_RETRY_DELAY: Duration = Duration::from_secs(5);

/// The logbook server of this process, if any. Clones refer to the same server.
#[derive(Clone, Default)]
pub struct LogbookServer(Arc<Shared>);

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    /// The connection. Only one thread uses it at a time.
    connection: Mutex<Option<Connection>>,
}

#[derive(Default)]
struct State {
    address: Option<Result<ServerAddress, ServerAddressError>>,
    contact: ServerContact,
    failed: Option<(Instant, ServerError)>,
    /// Devices that are connected to this program.
    held: Vec<DeviceKey>,
    /// Whether devices of this program are announced on the server.
    is_announced: bool,
}

struct Connection {
    client: Client,
    address: ServerAddress,
    identity: String,
}

/// The result of the last contact with the server.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ServerContact {
    /// Whether the last transfer was complete.
    pub is_reached: bool,
    /// Reason why the last transfer failed.
    pub problem: Option<ServerError>,
    /// Time of the first failure since the last complete transfer.
    pub away_since: Option<Timestamp>,
    /// Other programs that are connected to a device of this one.
    pub others: Vec<OtherHolder>,
}

impl LogbookServer {
    /// Maximum time for a transfer for which the user waits.
    pub const TIMEOUT: Duration = Duration::from_secs(2);

    /// Sets or removes the server. An invalid address is treated as an unreachable server.
    pub fn set_address(&self, address: Option<Result<ServerAddress, ServerAddressError>>) {
        let mut state = self.state();
        if state.address != address {
            *state = State { address, held: std::mem::take(&mut state.held), ..State::default() };
        }
    }

    /// Permits another access to the keyring, because the user may have changed it.
    pub fn retry_keyring() {
        keyring::allow_request();
    }

    /// Tests the connection to a server without changing anything there. Returns the number of entries, or `None` if
    /// the server has no logbook yet.
    ///
    /// # Errors
    /// Returns an error if the server cannot be used.
    pub fn test(address: &ServerAddress, limit: Duration) -> Result<Option<u64>, ServerError> {
        keyring::allow_request();
        let connected = Connection::connect(address, Instant::now() + limit);
        connected
            .and_then(|mut client| schema::count_entries(&mut client))
            .map_err(|problem| problem.into_error(&address.name()))
    }

    /// Returns whether the entries are shared over a server, even if it is unreachable.
    pub fn is_set(&self) -> bool {
        self.state().address.is_some()
    }

    /// Returns whether a device connected to this program is announced on the server.
    pub fn is_announced(&self) -> bool {
        self.state().is_announced
    }

    pub fn contact(&self) -> ServerContact {
        self.state().contact.clone()
    }

    /// Sends the entries of the local file to the server and receives those of other computers. May take up to `limit`.
    /// Returns `None` if no server is set.
    ///
    /// # Errors
    /// Returns an error if the server or the local file cannot be used. What was sent and received until then is kept, and
    /// the rest follows the next time.
    pub fn transfer(&self, path: &Path, limit: Duration) -> Option<Result<Transferred, ServerError>> {
        let address = self.state().address.clone()?;
        let address = match address {
            Ok(address) => address,
            Err(problem) => {
                let failed = Err(ServerErrorKind::Address(problem).into_error(""));
                self.note(None, &failed, Vec::new());
                return Some(failed);
            }
        };
        let deadline = Instant::now() + limit;
        let mut connection = loop {
            match self.0.connection.try_lock() {
                Ok(connection) => break connection,
                Err(TryLockError::Poisoned(poisoned)) => break poisoned.into_inner(),
                Err(TryLockError::WouldBlock) if Instant::now() > deadline => {
                    return Some(Err(ServerErrorKind::NoReply.into_error(&address.name())));
                }
                Err(TryLockError::WouldBlock) => thread::sleep(RETRY),
            }
        };
        let (held, is_announced) = {
            let state = self.state();
            (state.held.clone(), state.is_announced)
        };
        let announced = (is_announced || !held.is_empty()).then_some(held.as_slice());
        let result = transfer_over_connection(&mut connection, &address, path, announced, deadline);
        let result = result.map_err(|problem| problem.into_error(&address.name()));
        let (result, others) = match result {
            Ok((done, others)) => {
                self.state().is_announced = !held.is_empty();
                (Ok(done), others)
            }
            Err(error) => {
                *connection = None;
                (Err(error), Vec::new())
            }
        };
        self.note(Some(&address), &result, others);
        Some(result)
    }

    /// Transfers entries like [`transfer`](Self::transfer), but immediately returns the error of an attempt that failed
    /// a few seconds ago.
    ///
    /// # Errors
    /// Returns an error if the server or the local file cannot be used.
    pub fn transfer_unless_recently_failed(
        &self,
        path: &Path,
        limit: Duration,
    ) -> Option<Result<Transferred, ServerError>> {
        let failed = self.state().failed.clone();
        match failed {
            Some((at, error)) if at.elapsed() < FAILURE_RETRY_DELAY => Some(Err(error)),
            _ => self.transfer(path, limit),
        }
    }

    fn note(
        &self,
        address: Option<&ServerAddress>,
        result: &Result<Transferred, ServerError>,
        others: Vec<OtherHolder>,
    ) {
        let mut state = self.state();
        // The server setting may have changed meanwhile.
        if state.address.as_ref().and_then(|address| address.as_ref().ok()) != address {
            return;
        }
        let now = Timestamp::now();
        match result {
            Ok(_) => {
                state.contact = ServerContact { is_reached: true, others, ..ServerContact::default() };
                state.failed = None;
            }
            Err(error) => {
                state.contact.is_reached = false;
                state.contact.away_since.get_or_insert(now);
                state.contact.problem = Some(error.clone());
                state.failed = Some((Instant::now(), error.clone()));
            }
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns a unique name for this running program.
fn program() -> &'static str {
    static NAME: OnceLock<String> = OnceLock::new();
    NAME.get_or_init(|| format!("{:032x}", fastrand::u128(..)))
}

/// Transfers entries and announces the devices in `held`, unless it is `None`.
fn transfer_over_connection(
    connection: &mut Option<Connection>,
    address: &ServerAddress,
    path: &Path,
    held: Option<&[DeviceKey]>,
    deadline: Instant,
) -> Result<(Transferred, Vec<OtherHolder>), ServerErrorKind> {
    let usable = connection.take().filter(|own| own.address == *address && !own.client.postgres.is_closed());
    let open = match usable {
        Some(open) => open,
        None => Connection::open(address, deadline)?,
    };
    let Connection { client, identity, .. } = connection.insert(open);
    client.set_deadline(deadline);
    let done = transfer::transfer(client, identity, path)?;
    let others = held.map(|held| hold::renew(client, program(), held)).transpose()?;
    Ok((done, others.unwrap_or_default()))
}

impl Connection {
    fn open(address: &ServerAddress, deadline: Instant) -> Result<Self, ServerErrorKind> {
        let mut client = Self::connect(address, deadline)?;
        let identity = schema::prepare(&mut client)?;
        Ok(Connection { client, address: address.clone(), identity })
    }

    /// Connects with a known password. The keyring is accessed only if the server requires a password.
    fn connect(address: &ServerAddress, deadline: Instant) -> Result<Client, ServerErrorKind> {
        let known = address.password.clone().or_else(Password::from_environment);
        let known = known.or_else(|| keyring::known_password(address));
        match Client::connect(address, known.as_ref(), deadline) {
            Err(ServerErrorKind::PasswordMissing) => {
                let found = keyring::password(address, deadline);
                let found = found.inspect_err(|error| tracing::debug!("{error}")).ok().flatten();
                let password = found.ok_or(ServerErrorKind::PasswordMissing)?;
                Client::connect(address, Some(&password), deadline)
            }
            result => result,
        }
    }
}

impl fmt::Debug for LogbookServer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("LogbookServer").field(&self.state().address).finish()
    }
}

impl PartialEq for LogbookServer {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Eq for LogbookServer {}
