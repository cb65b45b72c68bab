//! Search for the settings of a family that yield a given frame.

use super::{Alignment, ErrorPlace, Family, Settings};
use crate::devices::ssi::protocol::descriptor::FrameDescriptor;
use crate::devices::ssi::protocol::range::Range;

type ResetSettingFn = fn(&mut Settings);

/// Functions that reset a single setting to its default, in the order in which they are tried.
const RESET_FUNCTIONS: [ResetSettingFn; 12] = [
    |settings| settings.clocks = None,
    |settings| settings.align = None,
    |settings| settings.errors = None,
    |settings| settings.shift = false,
    |settings| settings.coded = None,
    |settings| settings.code = None,
    |settings| settings.multiturn = None,
    |settings| settings.singleturn = None,
    |settings| settings.turns = None,
    |settings| settings.revolutions = None,
    |settings| settings.steps = None,
    |settings| settings.step_nanometres = None,
];

impl Family {
    /// Returns the smallest set of settings with which this family sends exactly this frame, or `None` if it cannot.
    /// Direction and preset keep their factory settings, because they are not part of a frame.
    pub fn settings_for_frame(&self, frame: &FrameDescriptor) -> Option<Settings> {
        let asked = self.derived_settings(frame);
        let aligns: Vec<Option<Alignment>> =
            std::iter::once(None).chain(self.align.iter().copied().map(Some)).collect();
        let places = [ErrorPlace::None, ErrorPlace::Fix, ErrorPlace::Following];
        let tried = aligns.into_iter().flat_map(|align| places.map(|place| (align, place)));
        tried
            .map(|(align, place)| Settings { align, errors: Some(place), ..asked.clone() })
            .filter(|settings| self.can_send_frame(settings, frame))
            .map(|settings| self.drop_unneeded_settings(settings, frame))
            .min_by_key(count)
    }

    fn can_send_frame(&self, settings: &Settings, frame: &FrameDescriptor) -> bool {
        settings.resolve(self).is_ok_and(|resolved| resolved.layout.descriptor() == frame)
    }

    /// Resets every setting that is not needed to produce the frame.
    fn drop_unneeded_settings(&self, settings: Settings, frame: &FrameDescriptor) -> Settings {
        RESET_FUNCTIONS.iter().fold(settings, |settings, leave| {
            let mut fewer = settings.clone();
            leave(&mut fewer);
            if self.can_send_frame(&fewer, frame) { fewer } else { settings }
        })
    }

    /// Returns the settings that follow directly from a frame. The alignment and the location of the error bits are
    /// left open.
    fn derived_settings(&self, frame: &FrameDescriptor) -> Settings {
        let asked = Settings {
            code: Some(frame.code),
            coded: Some(frame.coded),
            clocks: Some(frame.clocks),
            shift: frame.shift_right,
            ..Settings::default()
        };
        match frame.range {
            // A singleturn encoder has no setting for turns, not even 0.
            Range::Bits { multiturn: 0, singleturn } if self.multiturn.is_none() => {
                Settings { singleturn: Some(singleturn), ..asked }
            }
            Range::Bits { multiturn, singleturn } => {
                Settings { multiturn: Some(multiturn), singleturn: Some(singleturn), ..asked }
            }
            Range::Steps { per_turn, turns } => Settings { steps: Some(per_turn), turns: Some(turns), ..asked },
            Range::RoundAxis { steps, revolutions } => {
                Settings { steps: Some(steps), revolutions: Some(revolutions), ..asked }
            }
            Range::Length { bits, step_nanometres } => {
                Settings { singleturn: Some(bits), step_nanometres: Some(step_nanometres), ..asked }
            }
        }
    }
}

fn count(settings: &Settings) -> usize {
    RESET_FUNCTIONS
        .iter()
        .filter(|leave| {
            let mut left = (*settings).clone();
            leave(&mut left);
            left != *settings
        })
        .count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::ssi::protocol::{Families, Parity};

    fn frame(families: &Families, text: &str) -> Option<FrameDescriptor> {
        let (key, settings) = Settings::parse(text).unwrap();
        let resolved = settings.resolve(families.find_by_key(&key).unwrap()).ok()?;
        Some(resolved.layout.descriptor().clone())
    }

    /// Returns the specifications of many combinations of settings, without those that the family cannot send.
    fn spread(families: &Families, family: &Family) -> Vec<String> {
        let resolutions: &[&str] = match family.key.as_str() {
            "kh53" | "ttk70" => &["", ",step=500"],
            "afs60s" | "afm60s" => &["", ",st=13", ",st=1"],
            _ => &[
                "",
                ",st=8",
                ",mt=8,st=8",
                ",mt=0,st=12",
                ",mt=13",
                ",mt=12,st=13",
                ",st=13",
                ",steps=360",
                ",steps=3600,turns=12",
                ",steps=100,revolutions=25/2",
            ],
        };
        let mut all = Vec::new();
        for resolution in resolutions {
            for code in ["", ",code=gray", ",code=gray-excess", ",code=bcd", ",code=gray,over=padded"] {
                for align in ["", ",align=left", ",align=right24", ",align=right25", ",align=tree13_12"] {
                    for rest in ["", ",err=none", ",err=fix", ",err=following", ",shift=1", ",clocks=28"] {
                        all.push(format!("{}{resolution}{code}{align}{rest}", family.key));
                    }
                }
            }
        }
        all.retain(|text| frame(families, text).is_some());
        all
    }

    #[test]
    fn finds_family_frames_with_minimal_settings() {
        let families = Families::built_in();
        for family in families.iter() {
            let spread = spread(&families, family);
            assert!(spread.len() >= 10, "{}: {spread:?}", family.key);
            for text in spread {
                let sent = frame(&families, &text).unwrap();
                let found = family.settings_for_frame(&sent).unwrap_or_else(|| panic!("{text}"));
                assert_eq!(found.resolve(family).unwrap().layout.descriptor(), &sent, "{text}");
                let (_, asked) = Settings::parse(&text).unwrap();
                assert!(count(&found) <= count(&asked), "{text}: {}", found.emit(&family.key));
            }
        }
    }

    #[test]
    fn omits_default_settings() {
        let cases = [
            ("ahm36,code=binary,mt=12,st=14,clocks=27,align=left,err=fix", "ahm36"),
            ("atm60,mt=12,st=13,align=tree12_13,err=none", "atm60"),
            ("atm60,mt=13,st=12,align=tree13_12", "atm60,mt=13"),
            // These two specifications describe the same frame.
            ("atm60,mt=12,st=12,align=right25", "atm60,st=12,align=tree13_12"),
            ("atm60,mt=0,st=12,code=gray", "atm60,code=gray,mt=0,st=12"),
            ("ahm36,steps=1000,turns=1", "ahm36,steps=1000"),
            ("ttk70,clocks=31,step=1000", "ttk70,clocks=31"),
            ("ahs36,direction=ccw,preset=5", "ahs36"),
        ];
        let families = Families::built_in();
        for (text, fewest) in cases {
            let family = families.find_by_key(fewest.split(',').next().unwrap()).unwrap();
            assert_eq!(
                family.settings_for_frame(&frame(&families, text).unwrap()).unwrap().emit(&family.key),
                fewest,
                "{text}"
            );
        }
    }

    #[test]
    fn unsupported_frames_have_no_settings() {
        let families = Families::built_in();
        for family in families.iter() {
            let own = frame(&families, &family.key).unwrap();
            let parity = own.clocks + 1;
            let others = [
                ("exchanged wires", FrameDescriptor { inverted: true, ..own.clone() }),
                (
                    "parity",
                    FrameDescriptor {
                        clocks: parity,
                        parity: Some(Parity { clock: parity, even: true }),
                        ..own.clone()
                    },
                ),
                ("zeros in between", FrameDescriptor { between: 1, ..own.clone() }),
                (
                    "another range",
                    FrameDescriptor { range: Range::Bits { multiturn: 20, singleturn: 2 }, ..own.clone() },
                ),
            ];
            for (what, other) in others {
                assert_eq!(family.settings_for_frame(&other), None, "{}: {what}", family.key);
            }
        }
        let ahs36 = frame(&families, "ahs36").unwrap();
        let sends = |key: &str| families.find_by_key(key).unwrap().settings_for_frame(&ahs36).is_some();
        assert_eq!(families.iter().filter(|family| sends(&family.key)).count(), 1);
    }
}
