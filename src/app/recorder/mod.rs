//! A chart recorder that shows incoming samples as lines over time. It can follow the samples and zoom, and it has two
//! cursors, a trigger and CSV export. It depends neither on devices nor on drawing. The owner defines the source, unit
//! and number of the samples.

mod cursors;
mod ended;
mod export;
mod line;
#[cfg(test)]
mod tests;
mod trigger;
mod view;
#[cfg(test)]
mod within_range_tests;

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

pub use cursors::{Cursor, CursorReadings};
pub use export::{ExportResult, TableExport};
pub use line::{Scale, Series, SeriesId};
pub use trigger::{Trigger, TriggerCondition, TriggerState};
pub use view::TimeWindow;

use trigger::TriggerDetector;

use crate::analysis::SampleTime;
use crate::analysis::history::{BatchError, ColumnPart, History, Kind, Sample};
use crate::app::Text;

#[derive(Clone, Debug, PartialEq)]
pub enum RecorderAction {
    Show(SeriesId, bool),
    /// Display the values of a line in the unit with this index.
    SetScale(SeriesId, usize),
    /// Set the displayed range of a line. `None` fits the range to all visible samples.
    SetRange(SeriesId, Option<(f64, f64)>),
    /// Draw all lines on a common axis, or each line on its own axis.
    ShareAxis(bool),
    Follow,
    Pause,
    Fit,
    Look(SampleTime, SampleTime),
    /// Set the duration of the view in nanoseconds. The end of the view stays in place.
    SetSpan(i64),
    /// Make the view longer (factor above 1) or shorter (below 1) around a point in time.
    Zoom(SampleTime, f64),
    /// Move a cursor to a point in time, or remove it.
    SetCursor(Cursor, Option<SampleTime>),
    ShowCursors(bool),
    Arm(Trigger),
    Disarm,
    Clear,
    CancelExport,
}

/// Interval in nanoseconds between two displayed samples without time stamps.
pub const UNTIMED_SAMPLE_INTERVAL_NS: i64 = 1_000;

/// The number of a group of samples that are recorded together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct GroupId(u32);

#[derive(Debug)]
struct Group {
    history: History,
    stamp: SampleGroupStamp,
    columns: Vec<Kind>,
    capacity: usize,
    longest_pause: Option<i64>,
}

/// An identifier of the samples in a group. Unlike a group number, it changes when the group is cleared, and is unique
/// among all recorders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleGroupStamp(u64);

impl SampleGroupStamp {
    fn new() -> Self {
        static NEXT_STAMP: AtomicU64 = AtomicU64::new(0);
        SampleGroupStamp(NEXT_STAMP.fetch_add(1, Ordering::Relaxed))
    }
}

impl Group {
    fn history(columns: &[Kind], capacity: usize, longest_pause: Option<i64>) -> History {
        let history = History::new(columns, capacity);
        match longest_pause {
            Some(pause) => history.with_longest_pause(pause),
            None => history,
        }
    }

    /// Marks a gap before the next sample. Nothing happens if there are no samples yet.
    fn break_before_next(&mut self) {
        if !self.history.indices().is_empty() {
            self.history.break_before_next();
        }
    }
}

#[derive(Debug, Default)]
pub struct Recorder {
    groups: BTreeMap<GroupId, Group>,
    lines: Vec<Series>,
    next: u32,
    view: TimeWindow,
    counts: bool,
    finished: bool,
    one_axis: bool,
    cursors: [Option<SampleTime>; 2],
    watch: Option<TriggerDetector>,
    export: Option<TableExport>,
    /// Time up to which the recording has been exported to a table.
    saved: Option<SampleTime>,
}

impl Recorder {
    /// Creates an empty recorder whose view follows the samples and spans `span` nanoseconds.
    pub fn new(span: i64) -> Self {
        Recorder { view: TimeWindow::Follow { span: span.max(1) }, ..Recorder::default() }
    }

    /// Creates a recorder for samples without time stamps. Sample n is displayed at n times [`UNTIMED_SAMPLE_INTERVAL_NS`]. The view
    /// follows the samples and shows the given number of them.
    pub fn without_timestamps(samples: i64) -> Self {
        Recorder { counts: true, ..Recorder::new(samples.saturating_mul(UNTIMED_SAMPLE_INTERVAL_NS)) }
    }

    /// Marks the recording as complete. A trigger that has not fired by then is marked as missed.
    pub(crate) fn finish(&mut self) {
        self.finished = true;
    }

    pub fn counts_samples(&self) -> bool {
        self.counts
    }

    /// Adds a group for at most `capacity` samples with the given columns. Samples more than `longest_pause`
    /// nanoseconds apart are not joined.
    pub fn add_group(&mut self, columns: &[Kind], capacity: usize, longest_pause: Option<i64>) -> GroupId {
        let history = Group::history(columns, capacity, longest_pause);
        let id = GroupId(self.next_number());
        let stamp = SampleGroupStamp::new();
        self.groups.insert(id, Group { history, stamp, columns: columns.to_vec(), capacity, longest_pause });
        id
    }

    /// Adds a line for a column of a group, displayed in the first of its units.
    pub fn add_line(&mut self, line: Series) -> SeriesId {
        let id = SeriesId(self.next_number());
        let taken = |colour: &usize| self.lines.iter().all(|own| own.colour != *colour);
        let colour = (0..).find(taken).unwrap_or(0);
        self.lines.push(Series { id, colour, ..line });
        id
    }

    /// Removes a line. Its samples are removed too, unless another line displays samples of the same group.
    pub(in crate::app) fn remove_line(&mut self, id: SeriesId) {
        let Some(at) = self.lines.iter().position(|line| line.id == id) else { return };
        let group = self.lines.remove(at).group;
        if self.lines.iter().all(|line| line.group != group) {
            self.groups.remove(&group);
        }
        self.clear_trigger(id);
    }

    fn clear_trigger(&mut self, id: SeriesId) {
        if self.watch.as_ref().is_some_and(|watch| watch.trigger().line == id) {
            self.watch = None;
        }
    }

    pub(in crate::app) fn set_remark(&mut self, id: SeriesId, remark: Option<Text>) {
        self.with_line(id, |line| line.remark = remark);
    }

    /// Appends samples to a group. If they would displace samples of a held view, the whole batch is ignored.
    ///
    /// # Errors
    /// Returns an error if the samples do not have the columns of the group, or if a time is earlier than the previous
    /// one.
    pub fn append(&mut self, group: GroupId, times: &[SampleTime], parts: &[ColumnPart<'_>]) -> Result<(), BatchError> {
        if self.would_evict_held_view(group, times.len()) {
            self.break_before_next(group);
            return Ok(());
        }
        let Some(Group { history, .. }) = self.groups.get_mut(&group) else { return Err(BatchError::Shape) };
        let before = history.indices().end;
        history.append(times, parts)?;
        self.find_trigger(group, before);
        Ok(())
    }

    /// Marks a gap before the next samples of every group.
    pub(in crate::app) fn mark_gap_in_all_groups(&mut self) {
        self.groups.values_mut().for_each(Group::break_before_next);
    }

    /// Marks a gap before the next samples of a group.
    pub(crate) fn break_before_next(&mut self, group: GroupId) {
        self.groups.get_mut(&group).into_iter().for_each(Group::break_before_next);
    }

    pub fn handle_action(&mut self, action: RecorderAction) {
        match action {
            RecorderAction::Show(id, shown) => self.with_line(id, |line| line.shown = shown),
            RecorderAction::SetScale(id, scale) => self.set_scale(id, scale),
            RecorderAction::SetRange(id, range) => {
                let sound = range.filter(|(low, high)| low.is_finite() && high.is_finite() && low < high);
                self.with_line(id, |line| line.range = sound);
            }
            RecorderAction::ShareAxis(one_axis) => {
                self.one_axis = one_axis;
                self.lines.iter_mut().for_each(|line| line.range = None);
            }
            RecorderAction::Follow => self.follow_newest(),
            RecorderAction::Pause => self.pause(),
            RecorderAction::Fit => self.fit_window(),
            RecorderAction::Look(from, to) => self.zoom_to(from, to),
            RecorderAction::SetSpan(span) => self.set_span(span),
            RecorderAction::Zoom(about, factor) => self.zoom_around(about, factor),
            RecorderAction::SetCursor(cursor, time) => self.set_cursor(cursor, time),
            RecorderAction::ShowCursors(shown) => self.show_cursors(shown),
            RecorderAction::Arm(trigger) => self.arm_trigger(trigger),
            RecorderAction::Disarm => self.disarm(),
            RecorderAction::Clear => self.clear(),
            RecorderAction::CancelExport => {
                if let Some(export) = &self.export {
                    export.cancel();
                }
            }
        }
    }

    /// Returns all lines, in the order in which they were added.
    pub fn series(&self) -> &[Series] {
        &self.lines
    }

    pub fn series_by_id(&self, id: SeriesId) -> Option<&Series> {
        self.lines.iter().find(|line| line.id == id)
    }

    /// Returns the displayed lines. An ended line is included only if it has samples in the visible range.
    pub fn visible_series(&self) -> impl Iterator<Item = &Series> {
        let (from, to) = self.window_bounds();
        let is_visible = move |line: &&Series| {
            !line.ended
                || self
                    .history(line)
                    .is_some_and(|history| !history.indices_between(from, to.saturating_add_ns(1)).is_empty())
        };
        self.selected_series().filter(is_visible)
    }

    fn selected_series(&self) -> impl Iterator<Item = &Series> {
        self.lines.iter().filter(|line| line.shown)
    }

    pub fn history(&self, line: &Series) -> Option<&History> {
        self.groups.get(&line.group).map(|group| &group.history)
    }

    pub fn group_stamp(&self, line: &Series) -> Option<SampleGroupStamp> {
        self.groups.get(&line.group).map(|group| group.stamp)
    }

    pub fn has_one_axis(&self) -> bool {
        self.one_axis
    }

    pub fn is_empty(&self) -> bool {
        self.groups.values().all(|group| group.history.indices().is_empty())
    }

    /// Returns the sample of a line nearest to a point in time.
    pub fn nearest_sample(&self, line: &Series, time: SampleTime) -> Option<Sample> {
        let history = self.history(line)?;
        history.sample(line.column, history.nearest_index(time)?)
    }

    /// Returns the memory used by the samples in bytes.
    pub fn memory(&self) -> usize {
        self.groups.values().map(|group| group.history.memory()).sum()
    }

    /// Returns the times of the first and last samples of all groups.
    pub fn recorded_span(&self) -> Option<(SampleTime, SampleTime)> {
        let ends = self.groups.values().filter_map(|Group { history, .. }| {
            let all = history.indices();
            Some((history.time(all.start)?, history.time(all.end.checked_sub(1)?)?))
        });
        ends.reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))
    }

    /// Discards all samples and the ended lines. Active lines, units and the duration of the view are kept.
    pub(crate) fn clear(&mut self) {
        let ended: Vec<SeriesId> = self.lines.iter().filter(|line| line.ended).map(|line| line.id).collect();
        ended.into_iter().for_each(|id| self.remove_line(id));
        for Group { history, stamp, columns, capacity, longest_pause } in self.groups.values_mut() {
            *history = Group::history(columns, *capacity, *longest_pause);
            *stamp = SampleGroupStamp::new();
        }
        // A table that is not complete is discarded.
        self.export = None;
        self.saved = None;
        self.cursors = [None; 2];
        self.watch = self.watch.take().map(TriggerDetector::rearmed);
        self.lines.iter_mut().for_each(|line| line.range = None);
        self.follow_newest();
    }

    fn set_scale(&mut self, id: SeriesId, scale: usize) {
        self.with_line(id, |line| {
            if scale < line.scales.len() {
                line.scale = scale;
                line.range = None;
            }
        });
        // The trigger level was entered in the old unit.
        self.clear_trigger(id);
    }

    fn with_line(&mut self, id: SeriesId, change: impl FnOnce(&mut Series)) {
        if let Some(line) = self.lines.iter_mut().find(|line| line.id == id) {
            change(line);
        }
    }

    fn next_number(&mut self) -> u32 {
        self.next += 1;
        self.next
    }
}
