//! The Signals tool, which analyses recorded or live sine and cosine signals. It needs no open device.

pub(crate) mod commands;
pub mod state;
pub mod views;

use crate::kinds::ToolTab;

pub const TAB: ToolTab = ToolTab { view: &views::SignalsView };
