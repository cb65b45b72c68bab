//! Compares the parameter table with a second transcription of the manual (`hiperdrive_parameters.txt`), and the limits
//! with the turns of each drive family (issue 21.10).

use std::collections::BTreeMap;
use std::time::Duration;

use super::super::*;

const FILE: &str = include_str!("../../../../../tests/vectors/hiperdrive_parameters.txt");

/// Row of the second transcription.
struct TranscribedRow<'t> {
    number: u16,
    bits: &'t str,
    range: &'t str,
    saved: &'t str,
    factory: &'t str,
    access: &'t str,
    unit: &'t str,
    answered: &'t str,
}

/// Turns of a drive family: its travel (manual 9.2), and the range and factory value of each parameter.
struct TurnsTable {
    way: i64,
    rows: BTreeMap<u16, (i64, i64, i64)>,
}

fn table_lines() -> impl Iterator<Item = &'static str> {
    FILE.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'))
}

fn transcribed_rows() -> Vec<TranscribedRow<'static>> {
    let mut rows = Vec::new();
    for line in table_lines().filter(|line| line.contains(" | ") && !line.starts_with('[')) {
        let fields: Vec<&str> = line.split('|').map(str::trim).collect();
        let [numbers, _name, bits, range, saved, factory, access, unit, page, answered] = fields[..] else {
            panic!("{line}");
        };
        assert!((23..=30).contains(&page.parse::<u8>().unwrap()), "section 6.2 is on pages 23 to 30: {line}");
        let (first, last, every) = match numbers.split_once('-') {
            None => (numbers, numbers, "1"),
            Some((first, rest)) => {
                let (last, every) = rest.split_once('/').unwrap();
                (first, last, every)
            }
        };
        let (first, last): (u16, u16) = (first.parse().unwrap(), last.parse().unwrap());
        for number in (first..=last).step_by(every.parse().unwrap()) {
            rows.push(TranscribedRow { number, bits, range, saved, factory, access, unit, answered });
        }
    }
    rows
}

fn families() -> BTreeMap<&'static str, TurnsTable> {
    let mut families = BTreeMap::new();
    let mut current = "";
    for line in table_lines().skip_while(|line| !line.starts_with('[')) {
        if let Some(head) = line.strip_prefix('[') {
            let (name, rest) = head.split_once(" | ").unwrap();
            let way = rest.rsplit_once("way ").unwrap().1.trim_end_matches(']').parse().unwrap();
            current = name;
            families.insert(name, TurnsTable { way, rows: BTreeMap::new() });
            continue;
        }
        let [number, range, factory] = line.split_whitespace().collect::<Vec<_>>()[..] else { panic!("{line}") };
        let (low, high) = range.split_once('…').unwrap();
        let row = (low.parse().unwrap(), high.parse().unwrap(), factory.parse().unwrap());
        families.get_mut(current).unwrap().rows.insert(number.parse().unwrap(), row);
    }
    families
}

fn kind(bits: &str) -> Kind {
    match bits {
        "8" => Kind::U8,
        // A temperature may be below zero (U).
        "8?" => Kind::I8,
        "16?" | "±15" => Kind::I16,
        "16" => Kind::U16,
        "32" => Kind::U32,
        "±31" => Kind::I32,
        "text" => Kind::Text,
        other => panic!("{other}"),
    }
}

fn parse_numbers(text: &str) -> Vec<i64> {
    text.split(',').map(|own| own.trim().parse().unwrap()).collect()
}

/// Returns allowed and disallowed values to test: at the limits, next to them, and in the gaps of a list.
fn probe_values(typed: &TranscribedRow<'_>) -> (Vec<i64>, Vec<i64>) {
    let all = || match typed.bits {
        "32" => (0, 4_294_967_295),
        "16" => (0, 65_535),
        "±31" => (-2_147_483_648, 2_147_483_647),
        other => panic!("{other}"),
    };
    let between = |(low, high): (i64, i64)| (vec![low, low + 1, high - 1, high], vec![low - 1, high + 1]);
    match typed.range {
        // If turns and scale are unknown, only the number of bits limits the value.
        "*" | "turns" | "way" => between(all()),
        // The range 0…0 is a single number.
        "0…0" => (vec![0], vec![-1, 1]),
        range => match (range.split_once('…'), range) {
            (Some((low, rest)), _) => {
                let (high, also) = rest.split_once(',').unwrap_or((rest, ""));
                let (mut good, mut bad) = between((low.parse().unwrap(), high.parse().unwrap()));
                if !also.is_empty() {
                    let also: i64 = also.parse().unwrap();
                    good.push(also);
                    bad.extend([also - 1, also + 1]);
                }
                (good, bad)
            }
            (None, list) => {
                let good = parse_numbers(list);
                let beside = good.iter().flat_map(|own| [own - 1, own + 1]);
                let bad = beside.filter(|own| !good.contains(own)).collect();
                (good, bad)
            }
        },
    }
}

/// Every row matches in type, access, unit, saving, factory value and allowed values. No row is missing, and none is
/// superfluous (issue 21.10).
#[test]
fn parameter_rows_match_manual() {
    let typed = transcribed_rows();
    let own: Vec<u16> = PARAMETERS.iter().map(|row| row.number).collect();
    assert_eq!(own, typed.iter().map(|row| row.number).collect::<Vec<_>>());
    for typed in &typed {
        let own = typed.number;
        let number = ParameterNumber::new(own).unwrap();
        let row = number.row().unwrap();
        assert_eq!((row.kind, row.unit), (kind(typed.bits), typed.unit), "{own}");
        let access = match typed.access {
            "R" => ParameterAccess::Read,
            "R/W" => ParameterAccess::ReadWrite,
            "W" => ParameterAccess::Write,
            other => panic!("{other}"),
        };
        assert_eq!((row.access, row.saved), (access, typed.saved == "ja"), "{own}");
        let factory = match typed.factory {
            "-" if own == 192 => FactoryValue::Automatic,
            "-" => FactoryValue::None,
            "turns -" => FactoryValue::Turns(-1),
            "turns +" => FactoryValue::Turns(1),
            "hub 0 adapter 1" => FactoryValue::Topology { adapter: 1, hub: 0 },
            number => FactoryValue::Number(number.parse().unwrap()),
        };
        assert_eq!(row.factory, factory, "{own}");
        let reach = match typed.range {
            "turns" => Some(StepLimit::Position),
            "way" => Some(StepLimit::Step),
            _ => None,
        };
        assert_eq!(row.reach, reach, "{own}");
        if typed.range == "-" {
            assert_eq!((row.access, typed.saved), (ParameterAccess::Read, "-"), "{own}");
            continue;
        }
        let (good, bad) = probe_values(typed);
        for value in good {
            assert_eq!(row.check_value(number, value, Travel::UNKNOWN), Ok(value), "{own}");
        }
        for value in bad {
            let refused = row.check_value(number, value, Travel::UNKNOWN).unwrap_err();
            assert_eq!((refused.number, refused.value), (number, value), "{own}");
        }
    }
}

/// Only the values listed in the manual have a long reply time (issue 21.8).
#[test]
fn reply_times_match_manual() {
    for typed in transcribed_rows() {
        let row = ParameterNumber::new(typed.number).unwrap().row().unwrap();
        let mut expected = BTreeMap::new();
        for part in typed.answered.split(';').filter(|part| *part != "-") {
            let (value, times) = part.trim().trim_start_matches('~').split_once(':').unwrap();
            let [adapter, hub] = times.split_whitespace().map(|ms| ms.parse().unwrap()).collect::<Vec<u64>>()[..]
            else {
                panic!("{part}");
            };
            expected.insert(value.parse::<i64>().unwrap(), (adapter, hub));
        }
        for value in -5..=2 {
            let ms = |topology| row.write_duration(value, topology).map(|time: Duration| time.as_millis() as u64);
            let (adapter, hub) = expected.get(&value).copied().unzip();
            let own = typed.number;
            assert_eq!((ms(Some(Topology::Adapter)), ms(Some(Topology::Hub4))), (adapter, hub), "{own} = {value}");
            assert_eq!((ms(Some(Topology::Hub8)), ms(None)), (hub, hub), "{own} = {value}");
        }
        assert_eq!(row.slow.len(), expected.len(), "{}", typed.number);
    }
}

/// For each family and scale, the limits are within turns · 256 · numerator / denominator steps in either direction,
/// rounded towards 0, and within 32 bits (issue 21.10).
#[test]
fn limit_ranges_match_family_turns() {
    let names = [("HDA 30, HDA 45", Family::Short), ("HDA 70", Family::Long), ("PSE441", Family::Pse441)];
    let mut families = families();
    assert_eq!(families.len(), names.len());
    for (name, family) in names {
        let TurnsTable { way, rows } = families.remove(name).unwrap();
        for (numerator, denominator) in [(256, 1), (400, 256), (100, 256), (25, 192), (1, 65_535), (65_535, 1), (3, 7)]
        {
            let steps = |turns: i64| {
                let steps = i128::from(turns) * 256 * numerator / denominator;
                steps.clamp(i32::MIN.into(), i32::MAX.into()) as i64
            };
            let scale = PositionScale::new(numerator as u16, denominator as u16).ok();
            let travel = Travel { family: Some(family), scale };
            for own in [158, 160, 198, 170, 176] {
                let number = ParameterNumber::new(own).unwrap();
                let row = number.row().unwrap();
                let (low, high) = rows.get(&own).map_or((-way, way), |(low, high, _)| (*low, *high));
                let (low, high) = (steps(low), steps(high));
                let label = format!("{own} of {name} at {numerator}/{denominator}");
                for value in [low, 0, high] {
                    assert_eq!(row.check_value(number, value, travel), Ok(value), "{label}");
                }
                for value in [low - 1, high + 1] {
                    let refused = row.check_value(number, value, travel).unwrap_err();
                    assert_eq!(refused.range, ParameterRange::Within(low, high), "{label}");
                }
            }
            for topology in [Topology::Adapter, Topology::Hub8] {
                for (own, (.., factory)) in &rows {
                    let row = ParameterNumber::new(*own).unwrap().row().unwrap();
                    // With factory settings, a turn has 65536 steps (manual 8.4).
                    assert_eq!(row.factory_value(topology, family), Some(factory * 65_536), "{own} of {name}");
                }
            }
        }
    }
    // If turns or scale are unknown, only the number of bits limits the value.
    let number = ParameterNumber::new(158).unwrap();
    let all = ParameterRange::Within(-2_147_483_648, 2_147_483_647);
    for (family, scale) in [(None, PositionScale::new(400, 256).ok()), (Some(Family::Short), None)] {
        assert_eq!(number.row().unwrap().allowed_values(Travel { family, scale }), Some(all));
    }
}
