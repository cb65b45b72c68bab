//! The user's files, and the logbook server from the settings or the environment.

use std::sync::Once;

use super::Result;
use super::args::CommonArgs;
use super::output::{Output, write_stderr};
use super::runner::to_failure;
use crate::app::{CommandSettings, Text, explain};
use crate::store::{Logbook, LogbookServer, ServerAddressError, ServerErrorKind, Store};

/// Ensures that a settings problem is reported once, although a command may read the settings several times.
static SETTINGS_REPORTED: Once = Once::new();
/// Ensures that other users of the device are reported once, before the command asks for consent or at its end.
static HOLDERS_REPORTED: Once = Once::new();

/// Opens the user's files. The settings determine the user name in new logbook entries and the server that shares them.
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

/// Exchanges entries with the logbook server, if any. An unavailable server is reported at the end of the command.
pub(super) fn exchange_entries(store: &Store) {
    store.logbook_server().transfer_unless_recently_failed(&store.logbook_path(), LogbookServer::TIMEOUT);
}

/// Reports the other programs that have the device of this command open. Only the first such report is printed.
pub(super) fn report_other_holders(server: &LogbookServer, output: &Output) {
    let others = server.contact().others;
    if others.is_empty() {
        return;
    }
    HOLDERS_REPORTED.call_once(|| {
        for holder in others {
            output.print_message(&explain::device_in_use_text(&holder).terminal_text());
        }
    });
}

/// Sends the new entries of this command to the logbook server. If the server is unavailable, this is reported, but the
/// command does not fail.
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
