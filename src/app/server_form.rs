//! The form for the logbook server: its address, its password, and a connection test. The password is stored in the
//! system's keyring, never in the settings.

use std::time::Duration;

use super::action::{Action, TaskResult};
use super::logbook_server::is_server_given;
use super::studio::Studio;
use super::{Settings, Severity, Text, explain};
use crate::store::{KeyringError, LogbookServer, Password, ServerAddress, ServerError};

/// Maximum duration of a connection test.
const TEST_TIMEOUT: Duration = Duration::from_secs(5);

/// State of the open form.
#[derive(Debug, Default)]
pub struct ServerForm {
    /// Address from the settings, without a password.
    address: String,
    /// Password found in the address of the settings.
    password: Option<Password>,
    /// Number of the running test. Results of other tests are ignored.
    test: Option<u32>,
    outcome: Option<Result<Text, Text>>,
}

/// An action of the form.
#[derive(Debug)]
pub enum ServerAction {
    Open,
    Close,
    /// Test the connection to the server. Nothing is changed on the server.
    Test {
        address: String,
        password: Option<Password>,
    },
    /// Share the logbook through this server. An empty address stops sharing.
    Save {
        address: String,
        password: Option<Password>,
    },
}

impl ServerForm {
    /// Creates a form with the server from the settings.
    fn new(settings: &Settings) -> Self {
        let setting = &settings.logbook;
        let (address, password) = match ServerAddress::from_environment(setting) {
            Ok(address) => (address.to_string(), address.password().cloned()),
            Err(_) if setting == Settings::UNKNOWN_LOGBOOK => (String::new(), None),
            Err(_) => (setting.clone(), None),
        };
        ServerForm { address, password, ..ServerForm::default() }
    }

    /// Returns the initial address, which contains no password.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Returns the initial password.
    pub fn password(&self) -> Option<&Password> {
        self.password.as_ref()
    }

    pub fn is_testing(&self) -> bool {
        self.test.is_some()
    }

    /// Returns the result of the last test, or the reason why the address is invalid.
    pub fn outcome(&self) -> Option<&Result<Text, Text>> {
        self.outcome.as_ref()
    }

    /// Returns whether an environment variable overrides the server address from the settings.
    pub fn is_server_given(&self) -> bool {
        is_server_given()
    }
}

/// Parses a typed address. A password in the address is moved out of it.
fn parse(address: &str, password: Option<Password>) -> Result<ServerAddress, Text> {
    let parsed = ServerAddress::from_environment(address);
    parsed.map(|address| address.with_password(password)).map_err(|error| explain::server_address_error_text(&error))
}

impl Studio {
    /// Returns the form, or `None` if it is closed.
    pub fn server_form(&self) -> Option<&ServerForm> {
        self.server_form.as_ref()
    }

    pub(super) fn apply_server_action(&mut self, action: ServerAction) {
        match action {
            ServerAction::Open => self.server_form = Some(ServerForm::new(&self.settings)),
            ServerAction::Close => self.server_form = None,
            ServerAction::Test { address, password } => self.test_server(&address, password),
            ServerAction::Save { address, password } => self.save_server(&address, password),
        }
    }

    fn test_server(&mut self, address: &str, password: Option<Password>) {
        let number = self.next_number();
        let Some(form) = &mut self.server_form else { return };
        match parse(address, password) {
            Err(why) => (form.test, form.outcome) = (None, Some(Err(why))),
            Ok(address) => {
                (form.test, form.outcome) = (Some(number), None);
                self.services.tasks.run("server test", move || {
                    let result = LogbookServer::test(&address, TEST_TIMEOUT);
                    Action::Done(TaskResult::ServerTested(number, result))
                });
            }
        }
    }

    pub(super) fn show_server_test(&mut self, number: u32, result: Result<Option<u64>, ServerError>) {
        let Some(form) = self.server_form.as_mut().filter(|form| form.test == Some(number)) else { return };
        form.test = None;
        form.outcome = Some(match result {
            Ok(Some(count)) => Ok(Text::new("server_form.reached").with("count", count)),
            Ok(None) => Ok(Text::new("server_form.reached_empty")),
            Err(error) => Err(explain::server_error_text(&error)),
        });
    }

    fn save_server(&mut self, address: &str, password: Option<Password>) {
        let address = match address.trim() {
            "" => None,
            typed => match parse(typed, password) {
                Ok(address) => Some(address),
                Err(why) => {
                    if let Some(form) = &mut self.server_form {
                        (form.test, form.outcome) = (None, Some(Err(why)));
                    }
                    return;
                }
            },
        };
        self.server_form = None;
        self.settings.logbook = address.as_ref().map(ToString::to_string).unwrap_or_default();
        if !is_server_given() {
            LogbookServer::retry_keyring();
            self.services.world.store.logbook_server().set_address(address.clone().map(Ok));
        }
        if let Some(address) = address.filter(ServerAddress::has_password) {
            self.services.tasks.run("keyring", move || {
                let saved = address.save_password();
                Action::Done(TaskResult::PasswordSaved(saved))
            });
        }
    }

    /// Reports a password that could not be saved. It remains in use until the program ends.
    pub(super) fn finish_password(&mut self, saved: Result<(), KeyringError>) {
        if let Err(error) = saved {
            let text = Text::new("server_form.no_keyring").with("why", error.why);
            self.services.notify(Severity::Warning, vec![text], None);
        }
    }
}
