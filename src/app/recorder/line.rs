//! A line of a recorder: a column of samples with a name and units.

use super::GroupId;
use crate::analysis::history::{Sample, Value};
use crate::app::Text;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SeriesId(pub(super) u32);

#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    pub unit: Text,
    /// Size of this unit relative to the unit of the samples, never 0.
    pub factor: f64,
    /// Number of decimals to display.
    pub decimals: usize,
    /// Number of counts after which the displayed value wraps to 0, or `None` for continuous values.
    pub range: Option<i64>,
}

impl Scale {
    /// Creates a unit that is `factor` times the unit of the samples.
    pub fn new(unit: &'static str, factor: f64, decimals: usize) -> Self {
        Scale { unit: Text::new(unit), factor, decimals, range: None }
    }

    /// Wraps the displayed values at a range of counts.
    #[must_use]
    pub fn within(self, range: i64) -> Self {
        Scale { range: Some(range.max(1)), ..self }
    }
}

#[derive(Clone, Debug)]
pub struct Series {
    pub id: SeriesId,
    pub name: Text,
    /// Heading of the column in an exported table.
    pub heading: String,
    /// Index of the colour, 0 to 7. Further lines reuse the colours.
    pub colour: usize,
    pub shown: bool,
    /// Displayed range in the unit of the line, or `None` to fit all visible samples.
    pub range: Option<(f64, f64)>,
    pub ended: bool,
    /// Whether the values are calculated from another line. A missing value then does not indicate a fault of the
    /// device.
    pub derived: bool,
    /// The reason why there are no samples, if known.
    pub remark: Option<Text>,
    pub(super) group: GroupId,
    pub(super) column: usize,
    pub(super) scales: Vec<Scale>,
    pub(super) scale: usize,
}

impl Series {
    /// Creates a line for a column of a group. `scales` must not be empty; its first unit is displayed.
    pub fn new(group: GroupId, column: usize, name: Text, heading: impl Into<String>, scales: Vec<Scale>) -> Self {
        Series {
            id: SeriesId::default(),
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
    pub(crate) fn initially_hidden(self) -> Self {
        Series { shown: false, ..self }
    }

    #[must_use]
    pub(crate) fn into_derived(self) -> Self {
        Series { derived: true, ..self }
    }

    pub fn column(&self) -> usize {
        self.column
    }

    pub fn scales(&self) -> &[Scale] {
        &self.scales
    }

    pub fn scale_number(&self) -> usize {
        self.scale
    }

    pub fn scale(&self) -> Option<&Scale> {
        self.scales.get(self.scale)
    }

    /// Returns the unit chosen by the user, or `None` for the default.
    pub(super) fn chosen_unit(&self) -> Option<Text> {
        self.scale().filter(|_| self.scale > 0).map(|scale| scale.unit.clone())
    }

    /// Selects the unit in which values are displayed. If it does not exist, the default unit is used.
    pub(super) fn choose_unit(&mut self, unit: Option<&Text>) {
        self.scale = self.scales.iter().position(|scale| Some(&scale.unit) == unit).unwrap_or_default();
    }

    pub fn factor(&self) -> f64 {
        self.scale().map_or(1.0, |scale| scale.factor)
    }

    /// Returns the number of decimal places for values in the displayed unit.
    pub fn decimal_places(&self) -> usize {
        self.scale().map_or(0, |scale| scale.decimals)
    }

    /// Returns the range after which displayed values wrap to 0, in units of the samples.
    pub fn sample_wrap_range(&self) -> Option<i64> {
        self.scale().and_then(|scale| scale.range)
    }

    pub fn value(&self, sample: &Sample) -> f64 {
        within_range(sample.value, self.sample_wrap_range()) * self.factor()
    }

    /// Returns `later` minus `earlier` in the displayed unit. Counts are subtracted as integers before they are
    /// rounded.
    pub fn difference(&self, earlier: &Sample, later: &Sample) -> f64 {
        let difference = match (earlier.value, later.value) {
            (Value::Whole(earlier), Value::Whole(later)) => (i128::from(later) - i128::from(earlier)) as f64,
            (earlier, later) => later.to_f64() - earlier.to_f64(),
        };
        difference * self.factor()
    }
}

/// Returns the value of a sample within a range of counts. Real values and values without a range are returned
/// unchanged.
pub(super) fn within_range(value: Value, range: Option<i64>) -> f64 {
    match (value, range) {
        (Value::Whole(count), Some(range)) => count.rem_euclid(range.max(1)) as f64,
        (value, _) => value.to_f64(),
    }
}
