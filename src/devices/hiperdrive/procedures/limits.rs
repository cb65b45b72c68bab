//! Motion limits of a drive. Scale, limits, confirmation, locks and reading times form a single value.
//!
//! The worker updates the value when parameters are read, and the window displays it. The dead-man control obtains a
//! [`Permit`] from it for each packet. Only the need for a confirmation is stored in the settings, since it must
//! outlast a session.

use std::time::Duration;

use super::dead_man::{MotionLock, Permit};
use super::rules::{GROUPS, MotionLimitParameters};
use crate::devices::hiperdrive::protocol::drive_parameter::{
    DENOMINATOR, LOWER_LIMIT, NO_TIMEOUT, NUMERATOR, TIMEOUT, UPPER_LIMIT,
};
use crate::devices::hiperdrive::protocol::{ParameterNumber, PositionScale, Topology, Variant};
use crate::units::Moment;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DriveLimits {
    rules: MotionLimitParameters,
    /// Whether scale and limits are known to have their factory values.
    is_factory: bool,
    /// Whether the scale has changed since the user confirmed the limits.
    unconfirmed: bool,
    /// Time at which each group of parameters was read, or `None` if the parameters must be read again because they may
    /// have changed.
    read: Option<[Moment; GROUPS]>,
    /// Time from which the readings are in doubt. Before the next motion starts, all groups must be read again after
    /// this time.
    doubted: Option<Moment>,
}

/// Limits as shown to the user, with their scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DisplayedLimits {
    /// Parameters 154 and 156.
    pub scale: (i64, i64),
    /// Parameters 158 and 160, in scaled steps.
    pub limits: (i64, i64),
}

/// Time for which a reading of the limits is valid. It is long enough to read all limits again even from a slow device.
const VALIDITY: Duration = Duration::from_secs(4);

/// Returns whether a drive with this RS-485 time-out (parameter 186) stops when communication is lost. Values that the
/// manual does not define are assumed not to stop it.
pub(super) fn stops_on_timeout(timeout: i64) -> bool {
    let row = ParameterNumber::new(TIMEOUT).and_then(ParameterNumber::row);
    timeout != NO_TIMEOUT && row.is_some_and(|row| row.range.contains(timeout))
}

impl DriveLimits {
    /// Creates the limits of a drive whose parameters were all read at the given time.
    pub fn from_rules(rules: MotionLimitParameters, (topology, variant): (Topology, Variant), at: Moment) -> Self {
        let mut limits = DriveLimits::default();
        limits.update(rules, (topology, variant), [at; GROUPS]);
        limits
    }

    /// Stores newly read parameters. `times` contains the time at which the reading of each group began. A change of
    /// scale requires confirmation, because the limits are then at other positions. A reading that began before
    /// [`invalidate`](Self::invalidate) was called does not make the limits valid again.
    pub fn update(
        &mut self,
        rules: MotionLimitParameters,
        (topology, variant): (Topology, Variant),
        times: [Moment; GROUPS],
    ) {
        self.unconfirmed |= self.rules.scale.is_some() && self.rules.scale != rules.scale;
        self.is_factory = rules.has_factory_settings(topology, variant);
        self.rules = rules;
        self.read = Some(times);
        self.doubted = self.doubted.filter(|since| times.into_iter().any(|at| at < *since));
    }

    pub const fn rules(&self) -> MotionLimitParameters {
        self.rules
    }

    /// Returns the time at which each group of parameters was read, or `None` if all must be read immediately.
    pub fn read_times(&self) -> Option<[Moment; GROUPS]> {
        self.read.filter(|_| self.doubted.is_none())
    }

    /// Requires that the parameters are read again before the next motion, because another master may have changed
    /// them. A running motion continues while the last reading is valid.
    pub fn invalidate(&mut self, now: Moment) {
        // Each thread reads the clock before it stores the doubt, so the later time may be stored first.
        self.doubted = self.doubted.max(Some(now));
    }

    /// Discards the parameter readings. Unconfirmed limits remain unconfirmed.
    pub fn clear(&mut self) {
        // The scale is kept, so that a change can be detected.
        let rules = MotionLimitParameters { scale: self.rules.scale, ..MotionLimitParameters::default() };
        *self = DriveLimits { rules, unconfirmed: self.unconfirmed, ..DriveLimits::default() };
    }

    pub const fn require_confirmation(&mut self) {
        self.unconfirmed = true;
    }

    pub const fn is_unconfirmed(&self) -> bool {
        self.unconfirmed
    }

    /// Confirms the limits as shown to the user. Returns `false` without any effect if the limits have changed since
    /// then.
    pub fn confirm_displayed(&mut self, seen: DisplayedLimits) -> bool {
        let counts = self.displayed_limits() == Some(seen);
        self.unconfirmed &= !counts;
        counts
    }

    /// Returns the limits to show to the user for confirmation, or `None` if they have not been read.
    pub fn displayed_limits(&self) -> Option<DisplayedLimits> {
        Some(DisplayedLimits { scale: self.rules.scale?, limits: self.rules.limits? })
    }

    /// Returns the limits (parameters 158 and 160) in scaled steps, or `None` if they have not been read or do not form
    /// a range.
    pub fn limits(&self) -> Option<(i32, i32)> {
        let (lower, upper) = self.rules.limits?;
        let limits = (i32::try_from(lower).ok()?, i32::try_from(upper).ok()?);
        (limits.0 < limits.1).then_some(limits)
    }

    /// Returns the position scale (parameters 154 and 156), or `None` if it has not been read or is invalid.
    pub fn scale(&self) -> Option<PositionScale> {
        let (numerator, denominator) = self.rules.scale?;
        PositionScale::new(u16::try_from(numerator).ok()?, u16::try_from(denominator).ok()?).ok()
    }

    /// Returns whether a motion may start with this reading, which must be recent and not invalidated.
    pub fn is_valid(&self, now: Moment) -> bool {
        self.doubted.is_none() && self.is_fresh(now)
    }

    fn is_fresh(&self, now: Moment) -> bool {
        self.read.is_some_and(|times| times.into_iter().all(|at| now.duration_since(at) <= VALIDITY))
    }

    /// Returns whether scale and limits have their factory values, which an endless run requires.
    pub const fn is_endless_run_allowed(&self) -> bool {
        self.is_factory
    }

    /// Returns the reasons why the drive may not move, most important first.
    pub fn motion_locks(&self) -> Vec<MotionLock> {
        let MotionLimitParameters { requested, timeout, .. } = self.rules;
        // An invalid scale or range is treated like one that was not read.
        let unread = requested.is_none() || self.scale().is_none() || self.limits().is_none() || timeout.is_none();
        [
            (MotionLock::Unread, unread),
            (MotionLock::NotRequested, requested.is_some_and(|value| value != 1)),
            (MotionLock::NoTimeout, timeout.is_some_and(|value| !stops_on_timeout(value))),
            (MotionLock::LimitsUnconfirmed, self.unconfirmed),
        ]
        .into_iter()
        .filter_map(|(lock, holds)| holds.then_some(lock))
        .collect()
    }

    /// Returns the motion permit (limits, locks and exceptions) of the drive at the given time. `expert` is `true` if
    /// the user has allowed an endless run.
    pub fn motion_permit(&self, now: Moment, expert: bool) -> Permit {
        let mut locks = self.motion_locks();
        locks.extend((!locks.contains(&MotionLock::Unread) && !self.is_fresh(now)).then_some(MotionLock::Outdated));
        let endless = self.is_factory && expert;
        Permit {
            limits: self.limits(),
            locks,
            endless,
            doubted: self.doubted.is_some(),
            degree: self.steps_per_degree(),
        }
    }

    /// Returns the number of scaled steps per degree, at least 1. Returns 1 if the scale has not been read.
    pub fn steps_per_degree(&self) -> u32 {
        self.scale().map_or(1, |scale| scale.degrees_to_steps(1.0))
    }
}

impl MotionLimitParameters {
    fn has_factory_settings(&self, topology: Topology, variant: Variant) -> bool {
        let factory = |number| {
            let row = ParameterNumber::new(number).and_then(ParameterNumber::row)?;
            row.factory_value(topology, variant.row()?.family)
        };
        let (scale, limits) =
            (factory(NUMERATOR).zip(factory(DENOMINATOR)), factory(LOWER_LIMIT).zip(factory(UPPER_LIMIT)));
        scale.is_some() && limits.is_some() && (self.scale, self.limits) == (scale, limits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HDA30A: (Topology, Variant) = (Topology::Adapter, Variant::new(7));

    /// Returns the factory value of an HDA30A parameter. The limits are ±511 turns of 65536 steps (reference, section
    /// 5).
    fn factory(number: u16) -> Option<i64> {
        Some(match number {
            152 => 1,
            154 => 256,
            156 => 1,
            158 => -33_488_896,
            160 => 33_488_896,
            186 => 20,
            _ => return None,
        })
    }

    fn rules(changed: &[(u16, Option<i64>)]) -> MotionLimitParameters {
        MotionLimitParameters::from_parameters(|number| {
            let own = changed.iter().find(|(own, _)| *own == number);
            own.map_or_else(|| factory(number), |(_, value)| *value)
        })
    }

    fn at(ms: u64) -> Moment {
        Moment::START + Duration::from_millis(ms)
    }

    #[test]
    fn parameters_lock_or_permit_motion() {
        let whole = Some((-33_488_896, 33_488_896));
        // At 65536 steps per turn, a degree is 182.04 steps. At 256 / 400 · 256 = 163.84 steps per turn, it is less
        // than one step.
        let permit = |limits, locks: &[MotionLock], endless, degree| Permit {
            limits,
            locks: locks.to_vec(),
            endless,
            doubted: false,
            degree,
        };
        type Case<'c> = (&'c str, &'c [(u16, Option<i64>)], Permit);
        let cases: [Case<'_>; 8] = [
            ("factory", &[], permit(whole, &[], true, 183)),
            ("given up", &[(152, Some(0))], permit(whole, &[MotionLock::NotRequested], true, 183)),
            ("no time-out", &[(186, Some(255))], permit(whole, &[MotionLock::NoTimeout], true, 183)),
            ("scaled", &[(156, Some(400))], permit(whole, &[], false, 1)),
            ("limited", &[(160, Some(65536))], permit(Some((-33_488_896, 65536)), &[], false, 183)),
            ("unread", &[(186, None)], permit(whole, &[MotionLock::Unread], true, 183)),
            ("no limit", &[(158, None)], permit(None, &[MotionLock::Unread], false, 183)),
            ("no scale", &[(154, None)], permit(whole, &[MotionLock::Unread], false, 1)),
        ];
        for (label, changed, expected) in cases {
            let limits = DriveLimits::from_rules(rules(changed), HDA30A, at(0));
            assert_eq!(limits.motion_permit(at(0), true), expected, "{label}");
            assert!(!limits.motion_permit(at(0), false).endless, "{label}: only for an expert");
        }
        let other = DriveLimits::from_rules(rules(&[]), (Topology::Adapter, Variant::OTHER), at(0));
        assert!(!other.is_endless_run_allowed(), "its factory values are not known");
    }

    /// An invalid scale, range or time-out permits no motion, as if it had not been read. Parameter 152 must be 0 or 1,
    /// parameter 160 above parameter 158, and parameter 186 from 1 to 100, or 255 for no time-out (reference, section
    /// 4; issue 21.3).
    #[test]
    fn invalid_parameters_prevent_motion() {
        type Case<'c> = (&'c [(u16, Option<i64>)], MotionLock);
        let cases: [Case<'_>; 8] = [
            (&[(154, Some(0))], MotionLock::Unread),
            (&[(156, Some(0))], MotionLock::Unread),
            (&[(154, Some(65_536))], MotionLock::Unread),
            (&[(158, Some(1000)), (160, Some(1000))], MotionLock::Unread),
            (&[(158, Some(1000)), (160, Some(-1000))], MotionLock::Unread),
            (&[(152, Some(2))], MotionLock::NotRequested),
            (&[(186, Some(0))], MotionLock::NoTimeout),
            (&[(186, Some(101))], MotionLock::NoTimeout),
        ];
        for (changed, lock) in cases {
            let limits = DriveLimits::from_rules(rules(changed), HDA30A, at(0));
            assert_eq!(limits.motion_permit(at(0), true).locks, [lock], "{changed:?}");
        }
        for tenths in [1, 100] {
            assert_eq!(
                DriveLimits::from_rules(rules(&[(186, Some(tenths))]), HDA30A, at(0)).motion_locks(),
                [],
                "{tenths}"
            );
        }
    }

    /// If the limits are invalidated twice, the later time applies, in whichever order the calls arrive (issue 21.3).
    #[test]
    fn latest_limit_invalidation_wins() {
        let mut limits = DriveLimits::from_rules(rules(&[]), HDA30A, at(0));
        limits.invalidate(at(100));
        limits.invalidate(at(50));
        limits.update(rules(&[]), HDA30A, [at(70); GROUPS]);
        assert!(!limits.is_valid(at(100)), "read before the later one");
        limits.update(rules(&[]), HDA30A, [at(100); GROUPS]);
        assert!(limits.is_valid(at(100)));
    }

    /// Each reading has a time stamp, which the dead-man control checks (issue 21.3).
    #[test]
    fn reading_expires_after_four_seconds() {
        let mut limits = DriveLimits::from_rules(rules(&[]), HDA30A, at(0));
        limits.update(rules(&[]), HDA30A, [at(1000), at(500), at(1000), at(1000)]);
        for (ms, locks) in [(4500, vec![]), (4501, vec![MotionLock::Outdated])] {
            assert_eq!(limits.motion_permit(at(ms), false).locks, locks, "{ms}");
            assert_eq!(limits.is_valid(at(ms)), locks.is_empty(), "{ms}");
        }
        limits.invalidate(at(1000));
        assert!(!limits.is_valid(at(1000)) && limits.motion_permit(at(1000), false).doubted, "nothing begins");
        assert_eq!(
            (limits.motion_permit(at(1000), false).locks, limits.read_times()),
            (vec![], None),
            "what moves goes on"
        );
        // The reading of one group had already begun when the doubt arose.
        limits.update(rules(&[]), HDA30A, [at(999), at(1100), at(1100), at(1100)]);
        assert_eq!((limits.read_times(), limits.is_valid(at(1100))), (None, false));
        limits.update(rules(&[]), HDA30A, [at(1200); GROUPS]);
        assert_eq!((limits.read_times(), limits.is_valid(at(1200))), (Some([at(1200); GROUPS]), true));
        limits.clear();
        assert_eq!(limits.motion_permit(at(1000), false).locks, [MotionLock::Unread]);
        assert_eq!(limits.limits(), None);
    }

    /// A confirmation applies to the limits and the scale that were shown. It becomes void when the scale changes
    /// (issue 21.3).
    #[test]
    fn confirms_only_displayed_limits() {
        let scaled = rules(&[(154, Some(400)), (156, Some(256)), (158, Some(-1000)), (160, Some(1000))]);
        let mut limits = DriveLimits::from_rules(rules(&[]), HDA30A, at(0));
        assert!(!limits.is_unconfirmed(), "as it was found");
        let before = limits.displayed_limits().unwrap();
        limits.clear();
        limits.update(scaled, HDA30A, [at(1); GROUPS]);
        assert_eq!(limits.motion_locks(), [MotionLock::LimitsUnconfirmed]);
        assert!(!limits.confirm_displayed(before), "shown under the scale of before");
        let seen = limits.displayed_limits().unwrap();
        for other in [DisplayedLimits { limits: (-1000, 1001), ..seen }, DisplayedLimits { scale: (400, 255), ..seen }]
        {
            assert!(!limits.confirm_displayed(other) && limits.is_unconfirmed(), "{other:?}");
        }
        limits.clear();
        assert!(limits.is_unconfirmed() && !limits.confirm_displayed(seen), "nothing is known that could be confirmed");
        limits.update(scaled, HDA30A, [at(2); GROUPS]);
        assert!(limits.confirm_displayed(seen) && limits.motion_locks().is_empty());
    }
}
