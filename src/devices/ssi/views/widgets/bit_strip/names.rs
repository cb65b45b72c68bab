//! Names of the fields, below their brackets. A name is centred if it fits below its field. Otherwise, it is placed
//! next to a leader line, on as many rows as needed.

use std::cmp::Ordering;
use std::sync::Arc;

use egui::text::{LayoutJob, TextWrapping};
use egui::{Color32, FontId, Galley, Painter, Rect, Stroke, Ui, Vec2, pos2};

use super::rows::{NAME_HEIGHT, Rows};
use crate::analysis::quality::Verdict;
use crate::devices::ssi::protocol::BitMeaning;
use crate::devices::ssi::state::strip::{Field, Strip, field_name, name, short_label};
use crate::ui::{Theme, controls};

pub(super) struct NameTag {
    /// Index of the field in the strip.
    pub(super) field: usize,
    line: usize,
    level: usize,
    /// Left edge relative to the first cell in its line of cells.
    left: f32,
    /// Position of the leader line relative to the first cell in its line of cells, or `None` without a leader line.
    leader: Option<f32>,
    galley: Arc<Galley>,
}

const NAME_SPACING: f32 = 6.0;
/// Maximum width of a name. A longer name is truncated, and the tooltip shows it in full.
const MAX_NAME_WIDTH: f32 = 160.0;
/// Number of rows that are searched for free space for a name, which equals the maximum number of error bits.
const LEVELS: usize = 8;

/// A name that is wider than its field.
struct OverflowingName {
    index: usize,
    line: usize,
    x: f32,
    /// Whether the names of both neighbouring fields fit below their fields.
    alone: bool,
    /// Whether the name starts at its leader line, rather than ends there.
    begins: bool,
    room: f32,
    galley: Arc<Galley>,
}

impl OverflowingName {
    /// Places the name in a free space beside the names that have already been placed.
    fn place_beside_tags(self, tags: &[NameTag]) -> NameTag {
        let width = self.galley.size().x;
        let middle = self.x - width / 2.0;
        let is_in = (-NAME_SPACING..=self.room + NAME_SPACING - width).contains(&middle);
        let (left, level) = if self.alone && is_in && self.is_free(tags, middle, 0) {
            (middle, 0)
        } else {
            let left = if self.begins {
                (self.x - NAME_SPACING / 2.0).min(self.room + NAME_SPACING - width)
            } else {
                self.x + NAME_SPACING / 2.0 - width
            };
            let free = (0..LEVELS).find(|level| self.is_free(tags, left, *level));
            // If a name cannot avoid leader lines, it must at least avoid the other names.
            let apart = || (0..).find(|level| self.has_no_overlap(tags, left, *level));
            (left, free.or_else(apart).unwrap_or(LEVELS))
        };
        let leader = Some(self.x).filter(|_| level > 0);
        NameTag { field: self.index, line: self.line, level, left, leader, galley: self.galley }
    }

    /// Returns whether the name overlaps no other name at this offset and level.
    fn has_no_overlap(&self, tags: &[NameTag], left: f32, level: usize) -> bool {
        let right = left + self.galley.size().x;
        let own = tags.iter().filter(|tag| tag.line == self.line && tag.level == level);
        own.map(NameTag::horizontal_span).all(|(from, to)| right + NAME_SPACING <= from || to + NAME_SPACING <= left)
    }

    /// Returns whether the name overlaps no other name, does not cross the leader line of a lower name, and leaves a
    /// clear path for its own leader line.
    fn is_free(&self, tags: &[NameTag], left: f32, level: usize) -> bool {
        let right = left + self.galley.size().x;
        let mut others = tags.iter().filter(|tag| tag.line == self.line);
        let crossed = others.any(|tag| {
            let (from, to) = tag.horizontal_span();
            match tag.level.cmp(&level) {
                Ordering::Equal => false,
                Ordering::Greater => tag.leader.is_some_and(|x| left <= x && x <= right),
                Ordering::Less => from <= self.x && self.x <= to,
            }
        });
        self.has_no_overlap(tags, left, level) && !crossed
    }
}

impl NameTag {
    fn horizontal_span(&self) -> (f32, f32) {
        (self.left, self.left + self.galley.size().x)
    }

    pub(super) fn tag_rect(&self, rows: &Rows, lane: Rect) -> Rect {
        let top = lane.bottom() + self.level as f32 * NAME_HEIGHT;
        Rect::from_min_size(pos2(rows.left_edge() + self.left, top), Vec2::new(self.galley.size().x, NAME_HEIGHT))
    }

    pub(super) fn paint(&self, painter: &Painter, theme: &Theme, (rows, lane): (&Rows, Rect), colour: Color32) {
        let rect = self.tag_rect(rows, lane);
        if let Some(x) = self.leader {
            let stroke = Stroke::new(1.0, theme.palette.line);
            painter.vline(rows.left_edge() + x, lane.center().y + 4.0..=rect.top() + 3.0, stroke);
        }
        painter.galley_with_override_text_color(rect.left_top(), self.galley.clone(), colour);
    }
}

/// Returns the names of all fields, and the number of rows of names below each line of cells. `rows` has no position
/// yet, because the height of a line depends on the result.
pub(super) fn name_tags(
    ui: &Ui,
    theme: &Theme,
    strip: &Strip,
    rows: &Rows,
    meaning_of: impl Fn(&Field) -> Option<BitMeaning>,
) -> (Vec<NameTag>, Vec<usize>) {
    let galley = |own: &Field, words: String| {
        let size = theme.sizes.caption;
        let (font, words) = match meaning_of(own) {
            Some(meaning) => (
                theme.bold_font(size),
                format!("{} {words}", controls::verdict_badge(theme, meaning_verdict(meaning)).0),
            ),
            None => (FontId::proportional(size), words),
        };
        let mut job = LayoutJob::simple_singleline(words, font, theme.palette.muted.into());
        job.wrap = TextWrapping::truncate_at_width(MAX_NAME_WIDTH);
        ui.painter().layout_job(job)
    };
    let mut tags: Vec<NameTag> = Vec::new();
    let mut narrow = Vec::new();
    for (index, own) in strip.fields().iter().enumerate() {
        let (run, line) = widest_run(rows, own);
        let words =
            [theme.format_text(&name(strip, own)), theme.format_text(&short_label(strip, own)), field_name(strip, own)];
        let fits = words.into_iter().map(|words| galley(own, words)).find(|own| own.size().x <= run.width() + 2.0);
        match fits {
            Some(galley) => {
                let left = run.center().x - galley.size().x / 2.0;
                tags.push(NameTag { field: index, line, level: 0, left, leader: None, galley });
            }
            None => narrow.push((index, own, run, line)),
        }
    }
    let room = rows.width(strip.layout().clock_count());
    let narrow = narrow.into_iter().map(|(index, own, run, line)| {
        let galley = galley(own, field_name(strip, own));
        let begins = run.center().x + NAME_SPACING / 2.0 < galley.size().x;
        OverflowingName { index, line, x: run.center().x, alone: true, begins, room, galley }
    });
    let mut narrow: Vec<OverflowingName> = narrow.collect();
    // If several adjacent names do not fit, each ends at its own leader line, which leaves space for the line of the
    // next name. There is no space for this at the left end. There, each name begins at its own line, and the last name
    // is the highest.
    for group in narrow.chunk_by_mut(|a, b| a.index + 1 == b.index && a.line == b.line) {
        let (alone, begins) = (group.len() == 1, group.iter().any(|own| own.begins));
        for own in group {
            (own.alone, own.begins) = (alone, begins);
        }
    }
    let (begin, end): (Vec<OverflowingName>, Vec<OverflowingName>) = narrow.into_iter().partition(|own| own.begins);
    for narrow in end.into_iter().chain(begin.into_iter().rev()) {
        tags.push(narrow.place_beside_tags(&tags));
    }
    let levels = (0..rows.count(strip.layout().clock_count())).map(|line| {
        let own = tags.iter().filter(|tag| tag.line == line);
        own.map(|tag| tag.level + 1).max().unwrap_or(1)
    });
    let levels = levels.collect();
    (tags, levels)
}

/// Returns the verdict that corresponds to the effect of a bit on the position.
pub(super) const fn meaning_verdict(meaning: BitMeaning) -> Verdict {
    match meaning {
        BitMeaning::Invalid => Verdict::Fault,
        BitMeaning::Warning => Verdict::Warn,
    }
}

/// Returns the widest run of a field and the line that contains it.
pub(super) fn widest_run(rows: &Rows, field: &Field) -> (Rect, usize) {
    let runs = rows.range_rects(field.first, field.last);
    let line = rows.line_for_clock(field.first);
    let widest = runs.into_iter().enumerate().rev().max_by(|(_, a), (_, b)| a.width().total_cmp(&b.width()));
    widest.map_or((rows.cell_rect(field.first), line), |(number, run)| (run, line + number))
}
