//! The files of the user, and the server of the logbook that the settings or the environment name.

use std::time::Duration;

use super::Result;
use super::args::CommonArgs;
use super::output::Output;
use super::runner::to_failure;
use crate::app::{Settings, Text, explain, server_address};
use crate::store::{Logbook, Store, read_text};

/// Maximum time for each request to the server of the logbook.
const SERVER_TIMEOUT: Duration = Duration::from_secs(2);

/// Returns the files of the user. Entries carry the user's name as the settings demand, and are shared over the server
/// that they name.
pub(super) fn user_store(common: &CommonArgs) -> Result<Store> {
    let store = Store::for_user().map_err(|error| to_failure(&explain::store_error_text(&error)))?;
    let settings =
        read_text(&store.settings_path()).map_or_else(|_| Settings::default(), |text| Settings::of_file(&text));
    settings.user_name.apply();
    common.server.set_address(server_address(&settings));
    Ok(store.with_server(common.server.clone()))
}

/// Exchanges entries with the server of the logbook, if there is one. A server that is away is reported at the end of
/// the command.
pub(super) fn exchange_entries(store: &Store) {
    store.logbook_server().transfer_unless_away(&store.logbook_path(), SERVER_TIMEOUT);
}

/// Sends the entries that the command has recorded, and reports a server that is away. The command does not fail.
pub(super) fn finish_entries(common: &CommonArgs, output: &Output) {
    common.log.complete();
    if !common.server.is_set() {
        return;
    }
    let Ok(store) = Store::for_user() else { return };
    for holder in common.server.contact().others {
        output.print_message(&explain::other_holder_text(&holder).terminal_text());
    }
    common.log.release_device();
    let path = store.logbook_path();
    let waiting = || Logbook::open(&path).and_then(|logbook| logbook.count_waiting()).unwrap_or(0);
    if waiting() > 0 {
        exchange_entries(&store.with_server(common.server.clone()));
    }
    if let Some(problem) = common.server.contact().problem {
        output.print_message(&explain::server_error_text(&problem).terminal_text());
        let count = waiting();
        if count > 0 {
            output.print_message(&Text::new("server.waiting").with("count", count).terminal_text());
        }
    }
}
