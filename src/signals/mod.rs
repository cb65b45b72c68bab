//! Signals: analysis of sine and cosine without a device.

pub(crate) mod commands;
pub mod state;
pub mod views;

use crate::kinds::ToolTab;

pub const TAB: ToolTab = ToolTab { view: &views::SignalsView };
