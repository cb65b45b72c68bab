//! Reasons why the logbook server cannot be used, and what to do.

use super::{literal_text, logbook_problem};
use crate::app::Text;
use crate::store::{OtherHolder, ServerAddressError, ServerError, ServerErrorKind, UnreachableCause};

pub fn server_error_text(error: &ServerError) -> Text {
    let of_server = |id| Text::new(id).with("server", &error.server);
    match &error.problem {
        ServerErrorKind::Address(problem) => server_address_error_text(problem),
        ServerErrorKind::UnknownHost => of_server("server.unknown_host"),
        ServerErrorKind::Unreachable { why } => {
            of_server("server.unreachable").with_text("why", connection_failure_text(why))
        }
        ServerErrorKind::NoReply => of_server("server.no_reply"),
        ServerErrorKind::PasswordMissing => of_server("server.password_missing"),
        ServerErrorKind::WrongPassword => of_server("server.wrong_password"),
        ServerErrorKind::Rejected { why } => of_server("server.rejected").with("why", why),
        ServerErrorKind::NoDatabase => of_server("server.no_database"),
        ServerErrorKind::Encryption { why } => of_server("server.encryption").with("why", why),
        ServerErrorKind::Certificates { path, why } => {
            Text::new("server.certificates").with("path", path.display()).with("why", why)
        }
        ServerErrorKind::NoRights { what } => of_server("server.no_rights").with("what", what),
        ServerErrorKind::DiskFull => of_server("server.disk_full"),
        ServerErrorKind::Newer { found, known } => of_server("server.newer").with("found", found).with("known", known),
        ServerErrorKind::Older { found, known } => of_server("server.older").with("found", found).with("known", known),
        ServerErrorKind::OtherServer => of_server("server.other_server"),
        ServerErrorKind::Local(error) => of_server("server.local").with_text("why", logbook_problem(error)),
        ServerErrorKind::Database { what, .. } => of_server("server.other").with_text("why", literal_text(what)),
    }
}

fn connection_failure_text(cause: &UnreachableCause) -> Text {
    match cause {
        UnreachableCause::Refused => Text::new("server.refused"),
        UnreachableCause::NoRoute => Text::new("server.no_route"),
        UnreachableCause::Lost => Text::new("server.lost"),
        UnreachableCause::Other(why) => literal_text(why),
    }
}

/// Returns the warning that another program is connected to the same device.
pub fn device_in_use_text(holder: &OtherHolder) -> Text {
    let text = match &holder.user {
        Some(user) => Text::new("server.held_by_user").with("user", user),
        None => Text::new("server.held"),
    };
    text.with("bench", &holder.bench).with("serial_number", &holder.device.serial_number)
}

pub fn server_address_error_text(error: &ServerAddressError) -> Text {
    match error {
        ServerAddressError::NotAnAddress => Text::new("server.not_an_address"),
        ServerAddressError::Ambiguous => Text::new("server.ambiguous_address"),
        ServerAddressError::UnknownParameter { name } => Text::new("server.unknown_parameter").with("name", name),
        ServerAddressError::ContainsPassword => Text::new("server.contains_password"),
        ServerAddressError::SettingsUnreadable => Text::new("server.settings_unread"),
        ServerAddressError::UnknownEncryption { found } => Text::new("server.encryption_mode").with("found", found),
    }
}
