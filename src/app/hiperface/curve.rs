//! The position over time, as far as the first plot needs it: a bounded number of samples, with gaps where there was none.

use std::collections::VecDeque;

use crate::device::hiperface::{PositionReading, Sample};
use crate::units::Moment;

/// A point of the curve; no value is a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Seconds on the session's clock.
    pub seconds: f64,
    /// Turns, or millimetres of a linear encoder, or steps where nobody knows; `None` where there was no valid position.
    pub value: Option<f64>,
}

/// What the values of a curve are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Revolutions.
    Turns,
    /// Millimetres.
    Millimetres,
    /// Steps of the position word.
    Steps,
}

/// The newest positions.
#[derive(Debug, Default)]
pub struct Curve {
    points: VecDeque<Point>,
    unit: Option<Unit>,
    last: Option<PositionReading>,
    no_position: Option<Sample>,
    dropped: u64,
}

impl Curve {
    const CAPACITY: usize = 20_000;

    pub(super) fn add(&mut self, samples: Vec<Sample>, dropped: u64) {
        self.dropped += dropped;
        for sample in samples {
            let point = match sample {
                Sample::Position(reading) => {
                    let (unit, value) = value_of(&reading);
                    if self.unit.replace(unit).is_some_and(|before| before != unit) {
                        self.points.clear();
                    }
                    let value = Some(value).filter(|_| reading.valid);
                    let point = Point { seconds: seconds(reading.at), value };
                    self.last = Some(reading);
                    self.no_position = None;
                    point
                }
                Sample::NoPosition { at, codes } => {
                    self.no_position = Some(Sample::NoPosition { at, codes });
                    Point { seconds: seconds(at), value: None }
                }
            };
            self.points.push_back(point);
        }
        let surplus = self.points.len().saturating_sub(Self::CAPACITY);
        self.points.drain(..surplus);
    }

    /// The points, the oldest first.
    pub fn points(&self) -> &VecDeque<Point> {
        &self.points
    }

    /// What the values are.
    pub fn unit(&self) -> Unit {
        self.unit.unwrap_or(Unit::Turns)
    }

    /// The last position, as long as the encoder has one to give.
    pub fn last(&self) -> Option<&PositionReading> {
        self.last.as_ref().filter(|_| self.no_position.is_none())
    }

    /// The encoder has no position to give at the moment.
    pub fn refused(&self) -> bool {
        self.no_position.is_some()
    }

    /// Samples that came too fast to be shown.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    pub(super) fn clear(&mut self) {
        let last = self.last.take();
        *self = Curve { last, ..Curve::default() };
    }

    pub(super) fn forget(&mut self) {
        *self = Curve::default();
    }
}

fn seconds(at: Moment) -> f64 {
    at.since_start().as_secs_f64()
}

fn value_of(reading: &PositionReading) -> (Unit, f64) {
    let Some(position) = reading.position else { return (Unit::Steps, f64::from(reading.raw)) };
    if let Some(millimetres) = position.millimetres() {
        return (Unit::Millimetres, millimetres);
    }
    let turns = position.turns().unwrap_or(0) as f64;
    (Unit::Turns, turns + position.degrees().unwrap_or(0.0) / 360.0)
}
