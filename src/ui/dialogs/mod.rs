//! Dialogs over the window: connecting, a question, typing a path, the about dialog, help, and the command palette.

mod about;
mod company;
pub(crate) mod connect;
mod diverged;
mod file;
mod palette;
mod question;
mod server;

pub(super) use about::{about_ui, help_ui};
pub(super) use company::{CompanyView, company_ui};
pub(super) use connect::{ConnectView, connect_ui};
pub(super) use diverged::diverged_ui;
pub(super) use file::{FileView, ask_for_file, file_ui};
pub(super) use palette::{PaletteUiState, palette_ui};
pub(super) use question::question_ui;
pub(super) use server::{ServerView, server_ui};
