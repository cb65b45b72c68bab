//! HIPERDRIVE drives behind an adapter or a hub, at the end of a session, and the handle that moves them.

mod motion;

pub use motion::{DriveView, Motion, View};
