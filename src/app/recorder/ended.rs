//! Ended lines, whose samples no longer arrive or now have other units. They keep their samples and units, and are
//! listed after the active lines.

use super::{Recorder, Scale, Series, SeriesId};
use crate::app::Text;

impl Recorder {
    /// Replaces a line with a new one of the same colour and, if possible, the same unit. The old line ends under the
    /// given name.
    pub(in crate::app) fn replace_line(
        &mut self,
        old: SeriesId,
        new: Series,
        (name, heading): (Text, String),
    ) -> SeriesId {
        let id = self.add_line(new);
        if let (Some(before), Some(at)) =
            (self.series_by_id(old).cloned(), self.lines.iter().position(|line| line.id == old))
        {
            let unit = before.chosen_unit();
            let free = self.series_by_id(id).map_or(0, |line| line.colour);
            self.end_line(old, name, heading);
            self.with_line(old, |line| line.colour = free);
            self.with_line(id, |line| {
                (line.colour, line.shown) = (before.colour, before.shown);
                line.choose_unit(unit.as_ref());
            });
            if let Some(line) = self.remove_series(id) {
                self.lines.insert(at.min(self.lines.len()), line);
            }
        }
        id
    }

    fn remove_series(&mut self, id: SeriesId) -> Option<Series> {
        let at = self.lines.iter().position(|line| line.id == id)?;
        Some(self.lines.remove(at))
    }

    /// Ends a line. It receives no more samples and is listed after the active lines.
    pub(in crate::app) fn end_line(&mut self, id: SeriesId, name: Text, heading: String) {
        if let Some(line) = self.remove_series(id) {
            self.lines.push(Series { ended: true, remark: None, name, heading, ..line });
        }
        self.clear_trigger(id);
    }

    pub(in crate::app) fn resume_line(&mut self, id: SeriesId, name: Text, heading: String) {
        let mut group = None;
        self.with_line(id, |line| {
            (line.ended, line.name, line.heading) = (false, name, heading);
            group = Some(line.group);
        });
        group.into_iter().for_each(|group| self.break_before_next(group));
    }

    /// Changes the selectable units of a line.
    pub(in crate::app) fn set_scales(&mut self, id: SeriesId, scales: Vec<Scale>) {
        if self.series_by_id(id).is_none_or(|line| line.scales == scales) {
            return;
        }
        self.with_line(id, |line| {
            let unit = line.chosen_unit();
            (line.scales, line.range) = (scales, None);
            line.choose_unit(unit.as_ref());
        });
        // The trigger level was entered in the old unit.
        self.clear_trigger(id);
    }

    pub(in crate::app) fn has_samples(&self, id: SeriesId) -> bool {
        self.series_by_id(id).and_then(|line| self.history(line)).is_some_and(|history| !history.indices().is_empty())
    }
}
