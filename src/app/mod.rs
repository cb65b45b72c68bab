//! What the program knows and can do, without drawing: all state of the window and what can be done with it, the words
//! for a person, the look as data.

mod action;
mod closing;
pub mod connect;
mod devices;
mod edits;
pub mod explain;
mod files;
pub mod hiperface;
mod keep;
mod leaving;
mod line;
mod look;
mod notices;
mod number;
mod opening;
mod picture;
pub mod recorder;
pub mod review;
mod services;
pub mod session;
mod settings;
pub mod signals;
mod studio;
mod tasks;
mod texts;
mod trace;
mod track;

pub use action::{Action, Desk, Done, FileQuestion, Question, ReviewAction};
pub use devices::{AnyDevice, Wish};
pub use keep::SettingsRead;
pub use leaving::Patience;
pub use line::{Line, Progressing, Running};
pub use look::{Look, Palette, Rgb, Spaces, TextSizes};
pub use notices::{Log, Notice, Severity};
pub use number::number;
pub use picture::Picture;
pub use services::{JobEnd, JobRecord, Opener, Services, World};
pub use settings::{Settings, Theme};
pub use studio::{SessionId, Studio, Tab};
pub use tasks::{Mailbox, Tasks, Wake};
pub use texts::{Language, Text, Texts, decimal};
pub use trace::{TraceLine, TraceLog};
