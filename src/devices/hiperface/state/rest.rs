//! Reads the position while the shaft is at rest, for the commutation assistant or for the user.

use super::{Encoder, HiperfaceAction};
use crate::app::services::Services;
use crate::app::session::SessionEvents;
use crate::app::{SineCosineOrigin, SineCosineRange, SineCosineReading, SineCosineSource, SineCosineVolts, Text};
use crate::devices::hiperface::jobs::HiperfaceJob;
use crate::devices::hiperface::procedures::RestPosition;
use crate::devices::hiperface::protocol::Geometry;

/// A reading at rest that the user has requested outside the commutation assistant.
#[derive(Debug, Default)]
pub(super) struct RestReadingRequest {
    is_under_way: bool,
    result: Option<Result<RestPosition, Text>>,
}

impl Encoder {
    /// Returns the signal periods and turns of the encoder, if known.
    pub fn geometry(&self) -> Option<Geometry> {
        self.identity.as_ref().and_then(|identity| identity.geometry)
    }

    pub(super) fn submit_rest_reading(&mut self, services: &mut Services) {
        self.rest.is_under_way = self.try_submit(HiperfaceJob::Rest, services);
    }

    pub(super) fn handle_rest_reading(&mut self, rest: RestPosition) {
        if std::mem::take(&mut self.rest.is_under_way) {
            self.rest.result = Some(Ok(rest));
            return;
        }
        let geometry = self.geometry();
        self.commutation.accept_position(rest, geometry);
    }

    /// Handles a failed job, and returns whether it was a reading at rest. If so, its error is displayed next to the
    /// request.
    pub(super) fn handle_rest_failure(&mut self, why: &Text) -> bool {
        if std::mem::take(&mut self.rest.is_under_way) {
            self.rest.result = Some(Err(why.clone()));
            return true;
        }
        self.commutation.handle_failure(why)
    }

    pub(super) fn cancel_rest_reading(&mut self) {
        self.rest.is_under_way = false;
        self.commutation.cancel_request();
    }
}

impl SineCosineSource for Encoder {
    fn is_ready(&self) -> bool {
        self.session.is_ready()
    }

    fn read_action(&self) -> crate::app::Action {
        crate::app::Action::device(self.session.id, HiperfaceAction::ReadRest)
    }

    fn origin(&self) -> SineCosineOrigin {
        let range = match self.geometry() {
            Some(Geometry::Rotary { periods, turns }) => Some(SineCosineRange { periods, turns }),
            Some(Geometry::Linear { .. }) | None => None,
        };
        let serial_number = self.identity.as_ref().map(|own| own.serial.serial_number.clone());
        SineCosineOrigin { session: self.session.id, serial_number, range }
    }

    fn take_reading(&mut self) -> Option<Result<SineCosineReading, Text>> {
        self.rest.result.take().map(|result| result.map(SineCosineReading::from))
    }
}

impl From<RestPosition> for SineCosineReading {
    fn from(rest: RestPosition) -> Self {
        let signals = rest.signals.map(|own| SineCosineVolts { sine_v: own.sine_v, cosine_v: own.cosine_v });
        SineCosineReading { position: rest.raw, valid: rest.valid, signals }
    }
}
