//! A device on the desk as what it is, for those who know one kind, and what only some kinds can do.

use super::AnyDevice;
use crate::app::SineCosineSource;
use crate::devices::biss::state as biss;
use crate::devices::hiperdrive::state as hiperdrive;
use crate::devices::hiperface::state as hiperface;
use crate::devices::interbus::state as interbus;
use crate::devices::ssi::state as ssi;

impl AnyDevice {
    /// The kinds of devices that there are, by their words in profiles.
    pub(in crate::app) const KINDS: [&'static str; 5] = [
        crate::devices::hiperface::protocol::KIND,
        crate::devices::biss::protocol::KIND,
        crate::devices::ssi::protocol::KIND,
        crate::devices::interbus::protocol::KIND,
        crate::devices::hiperdrive::protocol::KIND,
    ];

    /// As a HIPERFACE encoder.
    pub fn hiperface(&self) -> Option<&hiperface::Encoder> {
        if let AnyDevice::Hiperface(own) = self { Some(own) } else { None }
    }

    pub(in crate::app) fn hiperface_mut(&mut self) -> Option<&mut hiperface::Encoder> {
        if let AnyDevice::Hiperface(own) = self { Some(own) } else { None }
    }

    /// As a BiSS encoder.
    pub fn biss(&self) -> Option<&biss::Encoder> {
        if let AnyDevice::Biss(own) = self { Some(own) } else { None }
    }

    pub(in crate::app) fn biss_mut(&mut self) -> Option<&mut biss::Encoder> {
        if let AnyDevice::Biss(own) = self { Some(own) } else { None }
    }

    /// As an SSI encoder.
    pub fn ssi(&self) -> Option<&ssi::Encoder> {
        if let AnyDevice::Ssi(own) = self { Some(own) } else { None }
    }

    pub(crate) fn ssi_mut(&mut self) -> Option<&mut ssi::Encoder> {
        if let AnyDevice::Ssi(own) = self { Some(own) } else { None }
    }

    /// As an INTERBUS encoder.
    pub fn interbus(&self) -> Option<&interbus::Encoder> {
        if let AnyDevice::Interbus(own) = self { Some(own) } else { None }
    }

    pub(crate) fn interbus_mut(&mut self) -> Option<&mut interbus::Encoder> {
        if let AnyDevice::Interbus(own) = self { Some(own) } else { None }
    }

    /// As HIPERDRIVE drives behind an adapter or a hub.
    pub fn hiperdrive(&self) -> Option<&hiperdrive::Unit> {
        if let AnyDevice::Hiperdrive(own) = self { Some(own) } else { None }
    }

    pub(crate) fn hiperdrive_mut(&mut self) -> Option<&mut hiperdrive::Unit> {
        if let AnyDevice::Hiperdrive(own) = self { Some(own) } else { None }
    }

    /// Its sine and cosine; `None` for a kind that gives none.
    pub fn sine_cosine(&self) -> Option<&dyn SineCosineSource> {
        match self {
            AnyDevice::Hiperface(own) => Some(own.as_ref()),
            AnyDevice::Biss(_) | AnyDevice::Ssi(_) | AnyDevice::Interbus(_) | AnyDevice::Hiperdrive(_) => None,
        }
    }

    pub(in crate::app) fn sine_cosine_mut(&mut self) -> Option<&mut dyn SineCosineSource> {
        match self {
            AnyDevice::Hiperface(own) => Some(own.as_mut()),
            AnyDevice::Biss(_) | AnyDevice::Ssi(_) | AnyDevice::Interbus(_) | AnyDevice::Hiperdrive(_) => None,
        }
    }
}
