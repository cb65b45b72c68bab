//! The simulated spindle, which accelerates, brakes and hits obstacles. Units are milliseconds and steps of 1/65536
//! turn.

use std::time::Duration;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleLoad {
    /// Load as a percentage of the nominal torque. The spindle moves only if the effective torque is at least this
    /// high.
    pub percent: u8,
    /// Position of the lower obstacle, in steps of 65536 per shaft turn.
    pub wall_below: Option<f64>,
    /// Position of the upper obstacle, in steps of 65536 per shaft turn.
    pub wall_above: Option<f64>,
    /// Ambient temperature of the drive, in degrees Celsius.
    pub ambient: f64,
    pub defect: Option<DriveDefect>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveDefect {
    /// The drive does not stop at its target or at its limits.
    RunsOn,
    /// The drive turns in the wrong direction.
    Reversed,
    /// The drive sets status bit 15 (outside the limits) at any position.
    SaysOutside,
}

impl Default for SpindleLoad {
    fn default() -> Self {
        SpindleLoad { percent: 10, wall_below: None, wall_above: None, ambient: 25.0, defect: None }
    }
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Axis {
    place: f64,
    /// Speed in steps per second.
    speed: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum AxisSetpoint {
    Rest,
    /// Moves to a position at no more than a maximum speed.
    Place {
        at: f64,
        speed: f64,
    },
    /// Turns at a signed speed.
    Speed(f64),
}

impl AxisSetpoint {
    /// Returns the setpoint that a drive with this defect actually follows at this position.
    pub(super) fn with_defect(self, defect: Option<DriveDefect>, place: f64) -> AxisSetpoint {
        let turned = |speed: f64| if defect == Some(DriveDefect::Reversed) { -speed } else { speed };
        match (self, defect) {
            (wanted, None | Some(DriveDefect::SaysOutside)) | (wanted @ AxisSetpoint::Rest, _) => wanted,
            (AxisSetpoint::Place { at, speed }, Some(_)) => AxisSetpoint::Speed(turned((at - place).signum() * speed)),
            (AxisSetpoint::Speed(speed), Some(_)) => AxisSetpoint::Speed(turned(speed)),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TickOutcome {
    OnTheWay,
    /// The drive is at its target, or at rest if requested.
    There,
    Held {
        above: bool,
    },
}

/// Number of steps per turn.
pub(super) const TURN: f64 = 65536.0;
pub(super) const TICK: Duration = Duration::from_millis(1);
const TICK_SECONDS: f64 = 1e-3;
/// Assumed acceleration. The drive reaches 35 rpm, or brakes from 35 rpm, in 0.1 s.
const ACCELERATION: f64 = 350.0 / 60.0 * TURN;

impl Axis {
    pub(super) const fn at_position(place: f64) -> Self {
        Axis { place, speed: 0.0 }
    }

    pub(super) const fn place(&self) -> f64 {
        self.place
    }

    pub(super) fn rpm(&self) -> f64 {
        self.speed / TURN * 60.0
    }

    pub(super) const fn is_at_rest(&self) -> bool {
        self.speed == 0.0
    }

    pub(super) const fn halt(&mut self) {
        self.speed = 0.0;
    }

    pub(super) fn tick(&mut self, wanted: AxisSetpoint, load: &SpindleLoad) -> TickOutcome {
        let gain = ACCELERATION * TICK_SECONDS;
        let aim = match wanted {
            AxisSetpoint::Rest => 0.0,
            AxisSetpoint::Speed(speed) => speed,
            // The speed is limited so that the drive can still brake in time, in steps of one millisecond.
            AxisSetpoint::Place { at, speed } => {
                let (way, half) = (at - self.place, gain / 2.0);
                way.signum() * speed.min((half * half + 2.0 * ACCELERATION * way.abs()).sqrt() - half)
            }
        };
        self.speed += (aim - self.speed).clamp(-gain, gain);
        let next = self.place + self.speed * TICK_SECONDS;
        if let Some(held) = blocking_obstacle(load, next) {
            (self.place, self.speed) = (held.0, 0.0);
            let arrived =
                wanted == AxisSetpoint::Rest || matches!(wanted, AxisSetpoint::Place { at, .. } if at == self.place);
            return if arrived { TickOutcome::There } else { TickOutcome::Held { above: held.1 } };
        }
        self.place = next;
        match wanted {
            AxisSetpoint::Place { at, .. } if self.speed.abs() <= 4.0 * gain && (at - self.place).abs() <= 2.0 => {
                (self.place, self.speed) = (at, 0.0);
                TickOutcome::There
            }
            AxisSetpoint::Rest if self.is_at_rest() => TickOutcome::There,
            _ => TickOutcome::OnTheWay,
        }
    }
}

/// Returns the obstacle that the spindle has reached at this position, if any. The flag is `true` for the upper
/// obstacle.
fn blocking_obstacle(load: &SpindleLoad, place: f64) -> Option<(f64, bool)> {
    let below = load.wall_below.filter(|wall| place < *wall).map(|wall| (wall, false));
    below.or_else(|| load.wall_above.filter(|wall| place > *wall).map(|wall| (wall, true)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks_until(axis: &mut Axis, wanted: AxisSetpoint, load: &SpindleLoad) -> (u32, TickOutcome) {
        for tick in 1..100_000 {
            match axis.tick(wanted, load) {
                TickOutcome::OnTheWay => {}
                came => return (tick, came),
            }
        }
        panic!("it never ends: {axis:?}");
    }

    /// At 35 rpm, 0.1 s of acceleration and 0.1 s of braking together cover 1/60 · 35 · 0.1 = 0.0583 turns. A full turn
    /// takes 0.2 + (1 − 0.0583) / 0.5833 s.
    #[test]
    fn turn_takes_expected_time() {
        let mut axis = Axis::default();
        let speed = 35.0 / 60.0 * TURN;
        let (ticks, came) = ticks_until(&mut axis, AxisSetpoint::Place { at: TURN, speed }, &SpindleLoad::default());
        assert_eq!((came, axis.place(), axis.is_at_rest()), (TickOutcome::There, TURN, true));
        assert!((1800..=1830).contains(&ticks), "{ticks} ms where 1814 were expected");
    }

    #[test]
    fn axis_stops_within_100_ms() {
        let mut axis = Axis::default();
        let load = SpindleLoad::default();
        for _ in 0..500 {
            axis.tick(AxisSetpoint::Speed(-35.0 / 60.0 * TURN), &load);
        }
        assert!((axis.rpm() + 35.0).abs() < 1e-9);
        let (ticks, _) = ticks_until(&mut axis, AxisSetpoint::Rest, &load);
        assert!((99..=101).contains(&ticks), "{ticks} ms");
    }

    #[test]
    fn blocked_axis_can_reverse() {
        let load = SpindleLoad { wall_above: Some(1000.0), ..SpindleLoad::default() };
        let mut axis = Axis::default();
        let to = |at| AxisSetpoint::Place { at, speed: TURN };
        assert_eq!(ticks_until(&mut axis, to(5000.0), &load).1, TickOutcome::Held { above: true });
        assert_eq!(axis.place(), 1000.0);
        assert_eq!(ticks_until(&mut axis, to(-300.0), &load).1, TickOutcome::There);
        // A spindle that is reversed at full speed overshoots and returns.
        for _ in 0..300 {
            axis.tick(AxisSetpoint::Speed(-TURN), &load);
        }
        let turned = axis.place();
        assert_eq!(ticks_until(&mut axis, to(turned), &load).1, TickOutcome::There);
        assert_eq!(axis.place(), turned);
    }
}
