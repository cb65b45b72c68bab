//! Names and units of a table's columns, which determine the columns with time, sine and cosine. The names follow SICK
//! 8010701: SIN, REFSIN, COS, REFCOS.

/// Column numbers of a table, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Columns {
    /// Time column. If `None`, the samples are evenly spaced at an unknown interval.
    pub time: Option<usize>,
    pub sine: usize,
    pub cosine: usize,
    /// Columns with REFSIN and REFCOS against ground. If `None`, sine and cosine are already differential.
    pub references: Option<(usize, usize)>,
    /// Column with the shaft angle of a reference encoder in degrees, if any.
    pub reference_angle: Option<usize>,
    /// Column with the absolute position in whole steps of 1/32 period, if any.
    pub absolute: Option<usize>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeUnit {
    #[default]
    Seconds,
    Milliseconds,
    Microseconds,
    Nanoseconds,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VoltUnit {
    #[default]
    Volts,
    Millivolts,
    Microvolts,
}

impl Columns {
    /// Columns for time, sine and cosine, in this order.
    pub const TIME_SINE_COSINE: Columns =
        Columns { time: Some(1), sine: 2, cosine: 3, references: None, reference_angle: None, absolute: None };

    /// Returns the highest column number in use.
    pub fn last(&self) -> usize {
        let (refsin, refcos) = self.references.unwrap_or_default();
        let others = [self.time, self.reference_angle, self.absolute].map(Option::unwrap_or_default);
        [self.sine, self.cosine, refsin, refcos].into_iter().chain(others).max().unwrap_or_default()
    }

    /// Returns the same columns with the first one as the time column, because it contains sample numbers.
    pub(super) fn with_sample_counter(self) -> Columns {
        let others = [Some(self.sine), Some(self.cosine), self.reference_angle, self.absolute];
        let (refsin, refcos) = self.references.unzip();
        let is_taken = others.into_iter().chain([refsin, refcos]).any(|column| column == Some(1));
        Columns { time: self.time.or((!is_taken).then_some(1)), ..self }
    }

    /// Finds the columns by name. Returns `None` if sine or cosine is missing.
    pub(super) fn find_by_name(names: &[String]) -> Option<Columns> {
        let find = |known: &[&str]| {
            let at = names.iter().position(|name| known.contains(&name_without_unit(name).as_str()));
            at.map(|at| at + 1)
        };
        let references = find(&["refsin", "sinref", "sinminus", "sin-", "-sin", "nsin"])
            .zip(find(&["refcos", "cosref", "cosminus", "cos-", "-cos", "ncos"]));
        Some(Columns {
            time: find(&["time", "t", "zeit", "times", "seconds", "second", "timestamp"]),
            sine: find(&["sin", "sine", "sinus", "sin+", "+sin", "sinplus"])?,
            cosine: find(&["cos", "cosine", "cosinus", "kosinus", "cos+", "+cos", "cosplus"])?,
            references,
            // A reference in volts is not a reference angle.
            reference_angle: find(&["reference", "referenz", "ref", "angle", "winkel", "mechanical angle"])
                .filter(|at| !names.get(at - 1).is_some_and(|name| is_in_volts(name))),
            absolute: find(&["absolute", "absolut", "abs", "absolute position", "position", "pos"]),
        })
    }
}

impl TimeUnit {
    /// Returns the length of the unit in seconds.
    pub const fn factor(self) -> f64 {
        match self {
            TimeUnit::Seconds => 1.0,
            TimeUnit::Milliseconds => 1e-3,
            TimeUnit::Microseconds => 1e-6,
            TimeUnit::Nanoseconds => 1e-9,
        }
    }

    pub(super) fn parse(text: &str) -> Option<Self> {
        match text {
            "s" | "sec" | "second" | "seconds" => Some(TimeUnit::Seconds),
            "ms" => Some(TimeUnit::Milliseconds),
            // Unicode has two micro signs.
            "us" | "\u{b5}s" | "\u{3bc}s" => Some(TimeUnit::Microseconds),
            "ns" => Some(TimeUnit::Nanoseconds),
            _ => None,
        }
    }
}

impl VoltUnit {
    /// Returns the size of the unit in volts.
    pub const fn factor(self) -> f64 {
        match self {
            VoltUnit::Volts => 1.0,
            VoltUnit::Millivolts => 1e-3,
            VoltUnit::Microvolts => 1e-6,
        }
    }

    pub(super) fn parse(text: &str) -> Option<Self> {
        match text {
            "v" | "volt" | "volts" => Some(VoltUnit::Volts),
            "mv" => Some(VoltUnit::Millivolts),
            "uv" | "\u{b5}v" | "\u{3bc}v" => Some(VoltUnit::Microvolts),
            _ => None,
        }
    }
}

fn is_degrees(text: &str) -> bool {
    ["deg", "degree", "degrees", "\u{b0}", "grad"].contains(&text)
}

fn is_in_volts(name: &str) -> bool {
    column_unit(&name.trim().to_lowercase()).is_some_and(|unit| VoltUnit::parse(unit).is_some())
}

/// Returns whether a lower-case string is a unit of time, voltage or angle.
pub(super) fn is_unit(text: &str) -> bool {
    TimeUnit::parse(text).is_some() || VoltUnit::parse(text).is_some() || is_degrees(text)
}

/// Returns a column name in lower case and without its unit: `Time [ms]` becomes `time`.
fn name_without_unit(name: &str) -> String {
    let name = name.trim().to_lowercase();
    let bare = match column_unit(&name) {
        Some(unit) => name.strip_suffix([']', ')']).unwrap_or(&name).strip_suffix(unit).unwrap_or(&name).to_owned(),
        None => name,
    };
    bare.trim_end_matches([' ', '[', '(', '/', '_', ',']).trim().to_owned()
}

/// Returns the unit in a lower-case column name, such as `ms` in `time_ms`. The unit is in brackets or follows a space,
/// a slash or an underscore. A name entirely in brackets is itself a unit, as in a line of units.
pub(super) fn column_unit(name: &str) -> Option<&str> {
    let name = name.trim();
    let inside = name.strip_suffix([']', ')']).unwrap_or(name);
    let (_, unit) = inside.rsplit_once(['[', '(', '/', '_', ' '])?;
    is_unit(unit).then_some(unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(names: &str) -> Option<Columns> {
        Columns::find_by_name(&names.split('|').map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn recognizes_columns_by_name() {
        let plain = Some(Columns::TIME_SINE_COSINE);
        for names in ["time|sin|cos", "Time [ms]|Sine (V)|Cosine (V)", "t/s|SIN_mV|COS_mV", "Zeit|Sinus|Kosinus"] {
            assert_eq!(named(names), plain, "{names}");
        }
        let expected =
            Columns { time: Some(5), sine: 1, cosine: 3, references: Some((2, 4)), ..Columns::TIME_SINE_COSINE };
        assert_eq!(named("SIN|REFSIN|COS|REFCOS|t"), Some(expected));
        assert_eq!(expected.last(), 5);
        let untimed = Columns { time: None, sine: 2, cosine: 1, ..Columns::TIME_SINE_COSINE };
        assert_eq!(named("cos|sin"), Some(untimed));
        for names in ["a|b|c", "time|sin|x", ""] {
            assert_eq!(named(names), None, "{names}");
        }
    }

    #[test]
    fn parses_units_in_column_names() {
        let rows = [
            ("time [ms]", Some("ms")),
            ("t/\u{b5}s", Some("\u{b5}s")),
            ("sin_mv", Some("mv")),
            ("(v)", Some("v")),
            ("sine v", Some("v")),
            ("channel a", None),
            ("cos", None),
        ];
        for (name, unit) in rows {
            assert_eq!(column_unit(name), unit, "{name}");
        }
    }
}
