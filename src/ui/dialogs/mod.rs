//! Dialogs over the window: connecting, a question, a path entry, about, help.

mod about;
pub(crate) mod connect;
mod diverged;
mod file;
mod question;

pub(super) use about::{about_ui, help_ui};
pub(super) use connect::{ConnectView, connect_ui};
pub(super) use diverged::diverged_ui;
pub(super) use file::{FileView, ask, file_ui};
pub(super) use question::question_ui;
