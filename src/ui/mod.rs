//! The window, which only draws. Views read the state and push actions. They store only text buffers and selections,
//! and never perform I/O, decode, sort or block.

pub mod backups;
mod cards;
pub(crate) mod check;
mod commands;
mod comparison;
pub mod controls;
pub(crate) mod device_view;
pub(crate) mod dialogs;
mod docks;
pub mod edit_bar;
mod entries;
mod header;
pub mod icons;
mod input_order;
mod keys;
mod label_column;
mod live_pace;
mod logbook;
pub(crate) mod motor;
mod navigation;
pub mod page;
pub(crate) mod panels;
pub mod plot;
mod profile_library;
mod renderer;
mod review;
mod row_selection;
mod run;
pub(crate) mod status_line;
pub(crate) mod stop_debounce;
mod termination;
mod theme;
mod views;
pub mod widgets;
mod window;
pub(crate) mod wiring;
pub(crate) mod workspace;

pub use commands::NamedAction;
pub use device_view::{
    DeviceView, PageInfo, SessionView, TabPage, TabViews, ToolPages, ToolView, TypedDeviceView, ViewedProfile,
};
pub use dialogs::connect::{ConnectForm, TypedConnectForm};
pub use run::run;
pub use theme::{Theme, install_fonts};
pub use views::Views;
pub use window::Window;
