//! The motor of a virtual shaft, as a shared handle. The motor has no clock, so a change takes effect at the next
//! request to the encoder.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The motor of a virtual encoder, shared by all clones.
#[derive(Clone, Debug)]
pub struct Motor(Arc<AtomicU64>);

impl Motor {
    /// Maximum speed in revolutions per minute, in either direction.
    pub const MAX_RPM: f64 = 12_000.0;

    pub(crate) fn with_speed(rpm: f64) -> Self {
        Motor(Arc::new(AtomicU64::new(rpm.to_bits())))
    }

    /// Returns the speed in revolutions per minute, positive clockwise. Positions increase during clockwise rotation.
    pub fn rpm(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::SeqCst))
    }

    /// Sets the speed, clamped to [`MAX_RPM`](Self::MAX_RPM). NaN is ignored.
    pub fn set_rpm(&self, rpm: f64) {
        if !rpm.is_nan() {
            self.0.store(rpm.clamp(-Self::MAX_RPM, Self::MAX_RPM).to_bits(), Ordering::SeqCst);
        }
    }
}
