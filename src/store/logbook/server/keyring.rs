//! Server passwords in the system's keyring: the secret service of the desktop, or the credential manager of Windows. A
//! locked keyring prompts the user, so each access has a time limit.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};
use std::{io, thread};

use crossbeam_channel::{Receiver, Sender, TryRecvError, bounded};
use keyring_core::{CredentialStore, Entry, Error};

use super::address::{Password, ServerAddress};

/// Name under which the keyring lists the passwords of this program.
const SERVICE: &str = "encoder-studio";
/// Maximum time to wait for the keyring. A user who is prompted may take longer, in which case the next attempt
/// succeeds.
const TIMEOUT: Duration = Duration::from_secs(3);

/// The request of this process. A locked keyring prompts the user, so only one request runs at a time, and the next one
/// requires a user action.
static REQUEST: Mutex<Option<Request>> = Mutex::new(None);

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the keyring of the system cannot be used: {why}")]
pub struct KeyringError {
    pub why: String,
}

type Reply = Result<Option<Password>, KeyringError>;

/// A request for a password, which runs in a separate thread.
#[derive(Clone)]
struct Request {
    account: String,
    reply: Arc<OnceLock<Reply>>,
    /// This channel is disconnected when the thread has ended.
    ended: Receiver<()>,
}

/// Returns the password for a server, or `None` if the keyring does not contain it.
///
/// # Errors
/// Returns an error if there is no keyring, or if it does not reply in time.
pub(super) fn password(address: &ServerAddress, deadline: Instant) -> Reply {
    let account = address.account();
    let user = account.clone();
    request(&REQUEST, account, deadline.min(Instant::now() + TIMEOUT), move || {
        let found = system_keyring().and_then(|keyring| Entry::new_in_store(&keyring, SERVICE, &user)?.get_password());
        match found {
            Ok(text) => Ok(Password::new(text)),
            Err(Error::NoEntry) => Ok(None),
            Err(error) => Err(KeyringError { why: error.to_string() }),
        }
    })
}

/// Returns the password for a server if the keyring has already returned it. Does not access the keyring.
pub(super) fn known_password(address: &ServerAddress) -> Option<Password> {
    let request = REQUEST.lock().unwrap_or_else(PoisonError::into_inner);
    let own = request.as_ref().filter(|own| own.account == address.account())?;
    own.reply.get()?.clone().ok().flatten()
}

/// Permits another request to the keyring after a user action.
pub(super) fn allow_request() {
    allow(&REQUEST);
}

fn allow(place: &Mutex<Option<Request>>) {
    let mut request = place.lock().unwrap_or_else(PoisonError::into_inner);
    request.take_if(|own| own.has_ended());
}

/// Returns the reply to the process's keyring request, starting one if there is none for this account.
fn request(
    place: &Mutex<Option<Request>>,
    account: String,
    deadline: Instant,
    ask: impl FnOnce() -> Reply + Send + 'static,
) -> Reply {
    let failed = |why: String| KeyringError { why };
    let own = {
        let mut request = place.lock().unwrap_or_else(PoisonError::into_inner);
        request.take_if(|own| own.has_ended() && own.account != account);
        match &*request {
            Some(own) => own.clone(),
            None => {
                request.insert(Request::start(account.clone(), ask).map_err(|error| failed(error.to_string()))?).clone()
            }
        }
    };
    // Nothing is ever sent: the channel ends with the thread.
    let _ = own.ended.recv_deadline(deadline);
    let reply = own.reply.get().filter(|_| own.account == account).cloned();
    reply.unwrap_or_else(|| Err(failed(io::Error::from(io::ErrorKind::TimedOut).to_string())))
}

impl Request {
    fn start(account: String, ask: impl FnOnce() -> Reply + Send + 'static) -> io::Result<Self> {
        let (ending, ended): (Sender<()>, _) = bounded(0);
        let reply = Arc::new(OnceLock::new());
        let result = reply.clone();
        thread::Builder::new().name("keyring".to_owned()).spawn(move || {
            let _ = result.set(ask());
            drop(ending);
        })?;
        Ok(Request { account, reply, ended })
    }

    fn has_ended(&self) -> bool {
        self.ended.try_recv() == Err(TryRecvError::Disconnected)
    }
}

impl ServerAddress {
    /// Saves the password of this address in the system's keyring.
    ///
    /// # Errors
    /// Returns an error if there is no keyring, or if it does not reply in time.
    pub fn save_password(&self) -> Result<(), KeyringError> {
        let Some(password) = self.password.clone() else { return Ok(()) };
        let (user, (sender, receiver)) = (self.account(), bounded(1));
        let failed = |why: String| KeyringError { why };
        let work = move || {
            let saved = system_keyring()
                .and_then(|keyring| Entry::new_in_store(&keyring, SERVICE, &user)?.set_password(password.reveal()));
            let _ = sender.send(saved);
        };
        thread::Builder::new().name("keyring".to_owned()).spawn(work).map_err(|error| failed(error.to_string()))?;
        let late = |_| failed(io::Error::from(io::ErrorKind::TimedOut).to_string());
        receiver.recv_timeout(TIMEOUT).map_err(late)?.map_err(|error| failed(error.to_string()))
    }
}

#[cfg(unix)]
fn system_keyring() -> keyring_core::Result<Arc<CredentialStore>> {
    Ok(zbus_secret_service_keyring_store::Store::new()?)
}

#[cfg(windows)]
fn system_keyring() -> keyring_core::Result<Arc<CredentialStore>> {
    Ok(windows_native_keyring_store::Store::new()?)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn asks_keyring_once() {
        let (place, asked) = (Mutex::new(None), Arc::new(AtomicUsize::new(0)));
        let (unlock, unlocked) = bounded::<()>(0);
        let find = |account: &str, patience: u64| {
            let (asked, unlocked) = (asked.clone(), unlocked.clone());
            let deadline = Instant::now() + Duration::from_millis(patience);
            request(&place, account.to_owned(), deadline, move || {
                asked.fetch_add(1, Ordering::SeqCst);
                let _ = unlocked.recv();
                Ok(Password::new("k3y".to_owned()))
            })
        };
        for account in ["bench@db", "bench@db", "other@db"] {
            assert!(find(account, 10).is_err(), "it is locked");
            allow(&place);
        }
        assert_eq!(asked.load(Ordering::SeqCst), 1, "the first request is still open");
        drop(unlock);
        assert_eq!(find("bench@db", 10_000), Ok(Password::new("k3y".to_owned())));
        assert_eq!(find("bench@db", 10_000), Ok(Password::new("k3y".to_owned())));
        assert_eq!(asked.load(Ordering::SeqCst), 1);
        allow(&place);
        assert!(find("bench@db", 10_000).is_ok());
        assert!(find("other@db", 10_000).is_ok(), "another account");
        assert_eq!(asked.load(Ordering::SeqCst), 3);
    }
}
