//! The connection to a server for a shared logbook: its address, and the thread that exchanges entries with it. The
//! window never waits for the server.

use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};

use super::action::{Action, TaskResult};
use super::logbook::LOGBOOK_TAB;
use super::studio::Studio;
use super::tasks::ActionMailbox;
use super::{Settings, Severity, explain};
use crate::store::{Logbook, ServerAddress, ServerAddressError, ServerContact, ServerError, ServerErrorKind, Store};

/// Environment variable that overrides the server address from the settings.
const VARIABLE: &str = "ENCODER_STUDIO_LOGBOOK";

/// Interval at which the thread looks for entries to send.
const SEND_INTERVAL: Duration = Duration::from_secs(1);
/// Interval at which the thread fetches entries from other computers.
const RECEIVE_INTERVAL: Duration = Duration::from_secs(10);
/// Maximum time for an exchange, long enough for the first one to copy all entries from other computers. A server that
/// does not reply is noticed earlier.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Returns the server address from the environment, or else from the settings. Returns `None` if neither contains one.
/// If the setting could not be read, the server counts as unreachable.
pub(super) fn server_address(settings: &Settings) -> Option<Result<ServerAddress, ServerAddressError>> {
    match server_from_environment() {
        Some(address) => Some(ServerAddress::from_environment(&address)),
        None if settings.logbook.trim().is_empty() => None,
        None if settings.logbook == Settings::UNKNOWN_LOGBOOK => Some(Err(ServerAddressError::SettingsUnreadable)),
        None => Some(ServerAddress::from_setting(&settings.logbook)),
    }
}

fn server_from_environment() -> Option<String> {
    std::env::var(VARIABLE).ok().filter(|address| !address.trim().is_empty())
}

/// Returns whether the environment overrides the server address from the settings.
pub(super) fn is_server_given() -> bool {
    server_from_environment().is_some()
}

/// State of the exchange with the server.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ServerExchange {
    pub contact: ServerContact,
    /// Number of entries not yet sent to the server.
    pub waiting: u64,
}

/// The thread that exchanges entries with the server. It ends when this value is dropped.
#[derive(Debug)]
pub(super) struct ServerThread {
    _stop: Sender<()>,
}

impl ServerThread {
    fn start(store: Store, mailbox: ActionMailbox) -> Self {
        let (stop, stopped) = bounded(0);
        // Without a thread, entries wait in the local file, as they do without the server.
        let spawned = thread::Builder::new()
            .name("logbook server".to_owned())
            .spawn(move || exchange(&store, &mailbox, &stopped));
        if let Err(error) = spawned {
            tracing::warn!("entries are not sent to the server of the logbook: {error}");
        }
        ServerThread { _stop: stop }
    }
}

fn exchange(store: &Store, mailbox: &ActionMailbox, stopped: &Receiver<()>) {
    let (server, path) = (store.logbook_server(), store.logbook_path());
    let count_waiting = || match path.try_exists() {
        Ok(false) => 0,
        _ => Logbook::open(&path).and_then(|logbook| logbook.count_waiting()).unwrap_or(0),
    };
    let (mut last, mut known): (Option<Instant>, Option<ServerExchange>) = (None, None);
    loop {
        let is_due = last.is_none_or(|at| at.elapsed() >= RECEIVE_INTERVAL);
        if server.is_set() && (is_due || count_waiting() > 0) {
            let result = server.transfer_unless_recently_failed(&path, TIMEOUT);
            last = Some(Instant::now());
            let received = result.and_then(Result::ok).is_some_and(|done| done.received > 0);
            let state = ServerExchange { contact: server.contact(), waiting: count_waiting() };
            if received || known.as_ref() != Some(&state) {
                known = Some(state.clone());
                mailbox.send(Action::Done(TaskResult::EntriesExchanged { received, state }));
            }
        }
        if stopped.recv_timeout(SEND_INTERVAL) != Err(RecvTimeoutError::Timeout) {
            return;
        }
    }
}

impl Studio {
    /// Returns the state of the exchange with the logbook server, or `None` if the logbook is not shared.
    pub fn server_exchange(&self) -> Option<&ServerExchange> {
        self.services.world.store.logbook_server().is_set().then_some(self.logbook.exchange())
    }

    /// Starts the thread that exchanges entries, once a server is set.
    pub(super) fn start_exchange(&mut self) {
        let store = &self.services.world.store;
        if self.server_thread.is_none() && store.logbook_server().is_set() {
            self.server_thread = Some(ServerThread::start(store.clone(), self.mailbox()));
        }
    }

    /// Updates the state of the exchange. An unreachable server is reported only once until it can be reached again.
    pub(super) fn show_exchange(&mut self, received: bool, state: ServerExchange) {
        let before = std::mem::replace(self.logbook.exchange_mut(), state);
        if received {
            self.logbook.mark_stale();
        }
        let contact = self.logbook.exchange().contact.clone();
        // Settings that cannot be read have been reported already.
        let is_told =
            |own: &ServerError| own.problem == ServerErrorKind::Address(ServerAddressError::SettingsUnreadable);
        let is_new = |own: &ServerError| before.contact.problem.is_none() && !is_told(own);
        if let Some(problem) = contact.problem.filter(is_new) {
            let text = vec![explain::server_error_text(&problem)];
            // The page of the logbook shows it beside its entries.
            if self.settings.tab == LOGBOOK_TAB {
                self.services.log_without_display(Severity::Warning, text, None);
            } else {
                self.services.notify(Severity::Warning, text, None);
            }
        }
        for holder in contact.others.iter().filter(|holder| !before.contact.others.contains(holder)) {
            self.services.notify(Severity::Warning, vec![explain::device_in_use_text(holder)], None);
        }
    }
}
