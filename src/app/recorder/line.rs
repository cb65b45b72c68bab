//! A line of a recorder: a column of samples with a name and units.

use super::GroupId;
use crate::analysis::history::{Sample, Value};
use crate::app::Text;

/// Number of a line in its recorder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LineId(pub(super) u32);

/// A unit in which a line can be seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    pub unit: Text,
    /// Size of one unit of the samples in this unit; not zero.
    pub factor: f64,
    /// Decimals that make sense.
    pub decimals: usize,
}

impl Scale {
    /// Creates a unit of which one of the samples' own unit is `factor`.
    pub fn new(unit: &'static str, factor: f64, decimals: usize) -> Self {
        Scale { unit: Text::new(unit), factor, decimals }
    }
}

/// A column of samples over time.
#[derive(Clone, Debug)]
pub struct Series {
    pub id: LineId,
    pub name: Text,
    /// Its name as a column of a table.
    pub heading: String,
    /// The colour, one of eight; further lines start again.
    pub colour: usize,
    pub shown: bool,
    /// The displayed range of values, in the line's unit; `None`: fits the visible samples.
    pub range: Option<(f64, f64)>,
    /// Nothing more is added to it; it stays for its recorded samples.
    pub ended: bool,
    /// Its values are calculated from another line: a missing one is no fault of the device.
    pub derived: bool,
    /// The present remark: why there are no samples.
    pub remark: Option<Text>,
    pub(super) group: GroupId,
    pub(super) column: usize,
    pub(super) scales: Vec<Scale>,
    pub(super) scale: usize,
}

impl Series {
    /// Creates a line from a column of a group; the first of the scales, at least one, is displayed.
    pub fn of(group: GroupId, column: usize, name: Text, heading: impl Into<String>, scales: Vec<Scale>) -> Self {
        Series {
            id: LineId::default(),
            name,
            heading: heading.into(),
            colour: 0,
            shown: true,
            range: None,
            ended: false,
            derived: false,
            remark: None,
            group,
            column,
            scales,
            scale: 0,
        }
    }

    #[must_use]
    pub(crate) fn hidden(self) -> Self {
        Series { shown: false, ..self }
    }

    #[must_use]
    pub(crate) fn derived(self) -> Self {
        Series { derived: true, ..self }
    }

    pub fn column(&self) -> usize {
        self.column
    }

    pub fn scales(&self) -> &[Scale] {
        &self.scales
    }

    /// Returns the index of the scale that is shown.
    pub fn scale_number(&self) -> usize {
        self.scale
    }

    pub fn scale(&self) -> Option<&Scale> {
        self.scales.get(self.scale)
    }

    /// Returns the unit that the user has chosen; `None` for the default.
    pub(super) fn chosen(&self) -> Option<Text> {
        self.scale().filter(|_| self.scale > 0).map(|scale| scale.unit.clone())
    }

    /// Shows this unit; the default if there is no such.
    pub(super) fn choose(&mut self, unit: Option<&Text>) {
        self.scale = self.scales.iter().position(|scale| Some(&scale.unit) == unit).unwrap_or_default();
    }

    /// Returns the size of one unit of the samples in the shown unit.
    pub fn factor(&self) -> f64 {
        self.scale().map_or(1.0, |scale| scale.factor)
    }

    /// Decimals that make sense in the shown unit.
    pub fn decimals(&self) -> usize {
        self.scale().map_or(0, |scale| scale.decimals)
    }

    /// Returns the value of a sample in the shown unit.
    pub fn value(&self, sample: &Sample) -> f64 {
        sample.value.to_f64() * self.factor()
    }

    /// Returns `later` minus `earlier` in the unit shown: counts are subtracted before they are rounded.
    pub fn difference(&self, earlier: &Sample, later: &Sample) -> f64 {
        let difference = match (earlier.value, later.value) {
            (Value::Whole(earlier), Value::Whole(later)) => (i128::from(later) - i128::from(earlier)) as f64,
            (earlier, later) => later.to_f64() - earlier.to_f64(),
        };
        difference * self.factor()
    }
}
