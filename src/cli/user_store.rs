//! The files of the user, and the server of the logbook that the settings or the environment name.

use std::sync::Once;
use std::time::Duration;

use super::Result;
use super::args::CommonArgs;
use super::output::{Output, write_stderr};
use super::runner::to_failure;
use crate::app::{CommandSettings, Text, explain};
use crate::store::{Logbook, LogbookServer, ServerAddressError, ServerErrorKind, Store};

/// Maximum time for an exchange with the server of the logbook.
const SERVER_TIMEOUT: Duration = Duration::from_secs(2);

/// A command may read its settings several times.
static SETTINGS_REPORTED: Once = Once::new();
/// A command names other holders before its question or at its end.
static HOLDERS_REPORTED: Once = Once::new();

/// Returns the files of the user. Entries carry the user's name as the settings demand, and are shared over the server
/// that they name.
pub(super) fn user_store(common: &CommonArgs) -> Result<Store> {
    let store = Store::for_user().map_err(|error| to_failure(&explain::store_error_text(&error)))?;
    let CommandSettings { settings, server, problem } = CommandSettings::read(&store.settings_path());
    if let Some(problem) = problem {
        SETTINGS_REPORTED.call_once(|| write_stderr(&format!("{}\n", problem.terminal_text())));
    }
    settings.user_name.apply();
    common.server.set_address(server);
    Ok(store.with_server(common.server.clone()))
}

/// Exchanges entries with the server of the logbook, if there is one. A server that is away is reported at the end of
/// the command.
pub(super) fn exchange_entries(store: &Store) {
    store.logbook_server().transfer_unless_away(&store.logbook_path(), SERVER_TIMEOUT);
}

/// Names the other programs that hold the device of this command, the first time that there are any.
pub(super) fn report_other_holders(server: &LogbookServer, output: &Output) {
    let others = server.contact().others;
    if others.is_empty() {
        return;
    }
    HOLDERS_REPORTED.call_once(|| {
        for holder in others {
            output.print_message(&explain::other_holder_text(&holder).terminal_text());
        }
    });
}

/// Sends the entries that the command has recorded, and reports a server that is away. The command does not fail.
pub(super) fn finish_entries(common: &CommonArgs, output: &Output) {
    common.log.complete();
    if !common.server.is_set() {
        return;
    }
    let Ok(store) = Store::for_user() else { return };
    report_other_holders(&common.server, output);
    common.log.release_device();
    let path = store.logbook_path();
    let waiting = || Logbook::open(&path).and_then(|logbook| logbook.count_waiting()).unwrap_or(0);
    if waiting() > 0 || common.server.is_announced() {
        exchange_entries(&store.with_server(common.server.clone()));
    }
    if let Some(problem) = common.server.contact().problem {
        output.print_message(&explain::server_error_text(&problem).terminal_text());
        let is_known = problem.problem != ServerErrorKind::Address(ServerAddressError::SettingsUnreadable);
        let count = waiting();
        if count > 0 && is_known {
            output.print_message(&Text::new("server.waiting").with("count", count).terminal_text());
        }
    }
}
