//! The devices on the desk, of whatever kind: what the studio asks of each of them.

mod any_device;
mod command;
mod model;
mod open_device;
mod shown;

pub use command::DeviceCommand;
pub(crate) use model::{ActContext, DeviceMemory, DeviceModel, MotionControl, Prepare};
pub use open_device::{AnyDevice, OpenDevice};
pub(super) use shown::Shown;

use super::action::Known;
use super::services::Services;
use super::session::ProfileFile;
use super::studio::SessionId;
use super::tab::Tab;
use crate::devices::biss::state as biss;
use crate::devices::hiperdrive::state as hiperdrive;
use crate::devices::hiperface::state as hiperface;
use crate::devices::interbus::state as interbus;
use crate::devices::ssi::state as ssi;
use crate::link::LinkUrl;
use crate::profile::Document;

/// At a link that is being opened; `None` for a tab that shows no device.
pub(super) fn device_at_link(tab: Tab, id: SessionId, url: LinkUrl, services: &mut Services) -> Option<Box<AnyDevice>> {
    match tab {
        Tab::Hiperface => Some(Box::new(hiperface::Encoder::at_link(id, url))),
        Tab::Biss => Some(Box::new(biss::Encoder::at_link(id, url))),
        Tab::Ssi => Some(Box::new(ssi::Encoder::at_link(id, url, services))),
        Tab::Interbus => Some(Box::new(interbus::Encoder::at_link(id, url))),
        Tab::Hiperdrive => Some(Box::new(hiperdrive::Unit::at_link(id, url))),
        Tab::Signals => None,
    }
}

/// A profile; `None` of a kind of device that the window does not show.
pub(super) fn device_in_file(
    id: SessionId,
    file: ProfileFile,
    document: Document,
    known: Known,
    services: &mut Services,
) -> Option<Box<AnyDevice>> {
    Some(match document.body.kind() {
        crate::devices::hiperface::protocol::KIND => {
            let types = services.encoder_types(known.hiperface);
            Box::new(hiperface::Encoder::in_file(id, file, document, &types, services))
        }
        crate::devices::biss::protocol::KIND => {
            Box::new(biss::Encoder::in_file(id, file, document, &known.biss, services))
        }
        crate::devices::ssi::protocol::KIND => Box::new(ssi::Encoder::in_file(id, file, document, services)),
        crate::devices::interbus::protocol::KIND => Box::new(interbus::Encoder::in_file(id, file, document, services)),
        crate::devices::hiperdrive::protocol::KIND => Box::new(hiperdrive::Unit::in_file(id, file, document, services)),
        _ => return None,
    })
}
