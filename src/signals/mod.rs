//! The Signals tool: analysis of recorded or live sine and cosine signals, without a session.

pub(crate) mod commands;
pub mod state;
pub mod views;

use crate::kinds::ToolTab;

pub const TAB: ToolTab = ToolTab { view: &views::SignalsView };
