//! What a drive may do, as its parameters say it.

use super::dead_man::{Lock, Permit};
use super::identify::of;
use super::{Error, Master};
use crate::protocol::hiperdrive::{DriveNumber, ParameterNumber, Topology, Variant};

/// The parameters that rule a drive's motion; `None` for what was not read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rules {
    /// Parameter 152.
    pub requested: Option<i64>,
    /// Parameters 154 and 156.
    pub scale: Option<(i64, i64)>,
    /// Parameters 158 and 160.
    pub limits: Option<(i64, i64)>,
    /// Parameter 186.
    pub timeout: Option<i64>,
}

/// Parameter 186: a drive that hears nothing goes on.
const NEVER: i64 = 255;

impl Rules {
    /// By the values of parameters, asked for by their numbers of drive 1.
    pub fn by(read: impl Fn(u16) -> Option<i64>) -> Self {
        Rules {
            requested: read(152),
            scale: read(154).zip(read(156)),
            limits: read(158).zip(read(160)),
            timeout: read(186),
        }
    }

    /// What a drive may do. An endless run is for drives whose scale and limits are the factory's.
    pub fn permit(&self, topology: Topology, variant: Variant) -> Permit {
        let Rules { requested, scale, limits, timeout } = *self;
        let mut locks = Vec::new();
        if requested.is_none() || scale.is_none() || limits.is_none() || timeout.is_none() {
            locks.push(Lock::Unread);
        }
        locks.extend((requested == Some(0)).then_some(Lock::NotRequested));
        locks.extend((timeout == Some(NEVER)).then_some(Lock::NoTimeout));
        let factory = |number| {
            let row = ParameterNumber::new(number).and_then(ParameterNumber::row)?;
            row.factory_value(topology, variant.row()?.family)
        };
        let endless =
            scale.is_some() && scale == factory(154).zip(factory(156)) && limits == factory(158).zip(factory(160));
        let limit = |(lower, upper)| Some((i32::try_from(lower).ok()?, i32::try_from(upper).ok()?));
        Permit { limits: limits.and_then(limit), locks, endless }
    }
}

/// Reads what rules a drive.
///
/// # Errors
/// The way.
pub fn read_rules(master: &mut Master<'_>, drive: DriveNumber) -> Result<Rules, Error> {
    let mut values = Vec::new();
    for base in [152, 154, 156, 158, 160, 186] {
        match master.read_number(of(base, drive)?) {
            Ok(value) => values.push((base, value)),
            Err(error) if error.is_unsaid() => {}
            Err(error) => return Err(error),
        }
    }
    Ok(Rules::by(|wanted| values.iter().find(|(base, _)| *base == wanted).map(|(_, value)| *value)))
}

/// What rules a drive is read again in so many groups: what belongs together is read together.
pub const GROUPS: usize = 4;

/// Reads one group of the parameters that rule a drive again.
///
/// # Errors
/// The way.
pub fn read_rule(master: &mut Master<'_>, drive: DriveNumber, known: Rules, group: usize) -> Result<Rules, Error> {
    let mut read = |base| match master.read_number(of(base, drive)?) {
        Ok(value) => Ok(Some(value)),
        Err(error) if error.is_unsaid() => Ok(None),
        Err(error) => Err(error),
    };
    Ok(match group % GROUPS {
        0 => Rules { requested: read(152)?, ..known },
        1 => Rules { timeout: read(186)?, ..known },
        2 => Rules { scale: read(154)?.zip(read(156)?), ..known },
        _ => Rules { limits: read(158)?.zip(read(160)?), ..known },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An HDA30A from the factory: ±511 turns of 65536 steps (reference 5).
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

    #[test]
    fn what_parameters_say_locks_and_permits() {
        let hda30a = Variant::new(7);
        let permit = |changed: &[(u16, Option<i64>)]| {
            let read = |number| {
                let own = changed.iter().find(|(own, _)| *own == number);
                own.map_or_else(|| factory(number), |(_, value)| *value)
            };
            Rules::by(read).permit(Topology::Adapter, hda30a)
        };
        let whole = Some((-33_488_896, 33_488_896));
        type Case<'c> = (&'c str, &'c [(u16, Option<i64>)], Permit);
        let cases: [Case<'_>; 7] = [
            ("factory", &[], Permit { limits: whole, locks: vec![], endless: true }),
            ("given up", &[(152, Some(0))], Permit { limits: whole, locks: vec![Lock::NotRequested], endless: true }),
            ("no time-out", &[(186, Some(255))], Permit { limits: whole, locks: vec![Lock::NoTimeout], endless: true }),
            ("scaled", &[(156, Some(400))], Permit { limits: whole, locks: vec![], endless: false }),
            (
                "limited",
                &[(160, Some(65536))],
                Permit { limits: Some((-33_488_896, 65536)), locks: vec![], endless: false },
            ),
            ("unread", &[(186, None)], Permit { limits: whole, locks: vec![Lock::Unread], endless: true }),
            ("no limit", &[(158, None)], Permit { limits: None, locks: vec![Lock::Unread], endless: false }),
        ];
        for (label, changed, expected) in cases {
            assert_eq!(permit(changed), expected, "{label}");
        }
        assert!(
            !Rules::by(factory).permit(Topology::Adapter, Variant::OTHER).endless,
            "whose factory values nobody knows"
        );
    }
}
