//! Stops the drives of a session when the program exits.

use crate::app::DriveStopHandle;
use crate::devices::hiperdrive::jobs::Motion;

impl DriveStopHandle for Motion {
    fn release_drives(&self) {
        Motion::release_drives(self);
    }

    fn is_connected(&self) -> bool {
        Motion::is_connected(self)
    }

    fn is_orphaned(&self) -> bool {
        Motion::is_orphaned(self)
    }
}
