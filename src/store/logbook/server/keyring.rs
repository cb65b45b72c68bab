//! Passwords of servers in the keyring of the system: the secret service of the desktop, or the credential manager of
//! Windows. A keyring may be locked and ask the user, so each access has a time limit.

use std::sync::Arc;
use std::time::Duration;
use std::{io, thread};

use crossbeam_channel::bounded;
use keyring_core::{CredentialStore, Entry, Error};

use super::address::{Password, ServerAddress};

/// Name under which the keyring lists the passwords of this program.
const SERVICE: &str = "encoder-studio";
/// Maximum time to wait for the keyring. A user who is asked by it may take longer; the next attempt succeeds then.
const TIMEOUT: Duration = Duration::from_secs(3);

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the keyring of the system cannot be used: {why}")]
pub struct KeyringError {
    pub why: String,
}

/// Returns the password of a server, or `None` if the keyring has none.
///
/// # Errors
/// Returns an error if there is no keyring, or if it does not reply in time.
pub(super) fn password(address: &ServerAddress) -> Result<Option<Password>, KeyringError> {
    with_entry(address, |entry| match entry.get_password() {
        Ok(text) => Ok(Password::new(text)),
        Err(Error::NoEntry) => Ok(None),
        Err(error) => Err(error),
    })
}

impl ServerAddress {
    /// Saves the password of this address in the keyring of the system, if it has one.
    ///
    /// # Errors
    /// Returns an error if there is no keyring, or if it does not reply in time.
    pub fn save_password(&self) -> Result<(), KeyringError> {
        let Some(password) = self.password.clone() else { return Ok(()) };
        with_entry(self, move |entry| entry.set_password(password.reveal()))
    }
}

fn with_entry<T: Send + 'static>(
    address: &ServerAddress,
    access: impl FnOnce(&Entry) -> keyring_core::Result<T> + Send + 'static,
) -> Result<T, KeyringError> {
    let (user, (sender, receiver)) = (address.account(), bounded(1));
    let failed = |why: String| KeyringError { why };
    let work = move || {
        let result = system_keyring().and_then(|keyring| access(&Entry::new_in_store(&keyring, SERVICE, &user)?));
        let _ = sender.send(result);
    };
    thread::Builder::new().name("keyring".to_owned()).spawn(work).map_err(|error| failed(error.to_string()))?;
    let late = |_| failed(io::Error::from(io::ErrorKind::TimedOut).to_string());
    receiver.recv_timeout(TIMEOUT).map_err(late)?.map_err(|error| failed(error.to_string()))
}

#[cfg(unix)]
fn system_keyring() -> keyring_core::Result<Arc<CredentialStore>> {
    Ok(zbus_secret_service_keyring_store::Store::new()?)
}

#[cfg(windows)]
fn system_keyring() -> keyring_core::Result<Arc<CredentialStore>> {
    Ok(windows_native_keyring_store::Store::new()?)
}
