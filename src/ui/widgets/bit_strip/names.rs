//! The names of the fields below their brackets: in the middle where there is room, else beside a line that leads down
//! to them, as many lines of them as keep them apart.

use std::sync::Arc;

use egui::{Color32, FontId, Galley, Painter, Rect, Stroke, Ui, Vec2, pos2};

use super::rows::{NAME, Rows};
use crate::app::ssi::strip::{Field, Strip, bare, name, short};
use crate::protocol::ssi::Meaning;
use crate::signal::quality::Verdict;
use crate::ui::{Skin, controls};

/// A name and where it is.
pub(super) struct Tag {
    /// Which of the strip's fields it is of.
    pub(super) field: usize,
    line: usize,
    /// Which line of names.
    level: usize,
    /// From the first cell of its line.
    left: f32,
    /// From where a line leads down to it, counted likewise.
    leader: Option<f32>,
    galley: Arc<Galley>,
}

/// Between two names on a line.
const APART: f32 = 6.0;
/// Lines of names at most, before the last: as many as a frame has error bits.
const LEVELS: usize = 8;

impl Tag {
    fn span(&self) -> (f32, f32) {
        (self.left, self.left + self.galley.size().x)
    }

    /// The rectangle of its words.
    pub(super) fn rect(&self, rows: &Rows, lane: Rect) -> Rect {
        let top = lane.bottom() + self.level as f32 * NAME;
        Rect::from_min_size(pos2(rows.left() + self.left, top), Vec2::new(self.galley.size().x, NAME))
    }

    /// Paints it below its bracket.
    pub(super) fn paint(&self, painter: &Painter, skin: &Skin, (rows, lane): (&Rows, Rect), colour: Color32) {
        let rect = self.rect(rows, lane);
        if let Some(x) = self.leader {
            let stroke = Stroke::new(1.0, skin.palette.line);
            painter.vline(rows.left() + x, lane.center().y + 4.0..=rect.top() + 3.0, stroke);
        }
        painter.galley_with_override_text_color(rect.left_top(), self.galley.clone(), colour);
    }
}

/// The names of all fields, and how many lines of them there are below each line of cells. `rows` are at no place yet:
/// how high they are depends on this.
pub(super) fn tags(
    ui: &Ui,
    skin: &Skin,
    strip: &Strip,
    rows: &Rows,
    told: impl Fn(&Field) -> Option<Meaning>,
) -> (Vec<Tag>, Vec<usize>) {
    let galley = |own: &Field, words: String| {
        let size = skin.sizes.caption;
        let (font, words) = match told(own) {
            Some(meaning) => (skin.strong(size), format!("{} {words}", controls::verdict(skin, verdict(meaning)).0)),
            None => (FontId::proportional(size), words),
        };
        ui.painter().layout_no_wrap(words, font, skin.palette.muted.into())
    };
    let mut tags: Vec<Tag> = Vec::new();
    let mut narrow = Vec::new();
    for (index, own) in strip.fields().iter().enumerate() {
        let (run, line) = widest(rows, own);
        let words = [skin.words(&name(strip, own)), skin.words(&short(strip, own)), bare(strip, own)];
        let fits = words.into_iter().map(|words| galley(own, words)).find(|own| own.size().x <= run.width() + 2.0);
        match fits {
            Some(galley) => {
                let left = run.center().x - galley.size().x / 2.0;
                tags.push(Tag { field: index, line, level: 0, left, leader: None, galley });
            }
            None => narrow.push((index, own, run, line)),
        }
    }
    for (at, (index, own, run, line)) in narrow.iter().enumerate() {
        let beside =
            |other: Option<&(usize, &Field, Rect, usize)>| other.is_some_and(|other| other.0.abs_diff(*index) == 1);
        let alone = !beside(narrow.get(at + 1)) && !beside(at.checked_sub(1).and_then(|at| narrow.get(at)));
        let galley = galley(own, bare(strip, own));
        let (x, width) = (run.center().x, galley.size().x);
        let free = |left: f32, level: usize| {
            let own = tags.iter().filter(|tag| tag.line == *line);
            own.clone().filter(|tag| tag.level == level).map(Tag::span).all(|(from, to)| {
                // Nor across a line that leads further down.
                left + width + APART <= from || to + APART <= left
            }) && own.filter(|tag| tag.level > level).filter_map(|tag| tag.leader).all(|x| left + width < x || x < left)
        };
        let inside = |left: f32| left >= rows.cell(1).left() - APART;
        // Where several stand side by side, each ends at its own line, so that the next one's passes it.
        let before = x + APART / 2.0 - width;
        let (left, level) = if alone && inside(x - width / 2.0) && free(x - width / 2.0, 0) {
            (x - width / 2.0, 0)
        } else {
            let left = if inside(before) { before } else { x - APART / 2.0 };
            (left, (0..LEVELS).find(|level| free(left, *level)).unwrap_or(LEVELS))
        };
        tags.push(Tag { field: *index, line: *line, level, left, leader: Some(x).filter(|_| level > 0), galley });
    }
    let levels = (0..rows.count(strip.layout().clocks())).map(|line| {
        let own = tags.iter().filter(|tag| tag.line == line);
        own.map(|tag| tag.level + 1).max().unwrap_or(1)
    });
    let levels = levels.collect();
    (tags, levels)
}

/// What is told of a position, as a verdict.
pub(super) const fn verdict(meaning: Meaning) -> Verdict {
    match meaning {
        Meaning::Invalid => Verdict::Fault,
        Meaning::Warning => Verdict::Warn,
    }
}

/// The widest of a field's runs, and its line.
pub(super) fn widest(rows: &Rows, field: &Field) -> (Rect, usize) {
    let runs = rows.runs(field.first, field.last);
    let line = rows.line(field.first);
    let widest = runs.into_iter().enumerate().rev().max_by(|(_, a), (_, b)| a.width().total_cmp(&b.width()));
    widest.map_or((rows.cell(field.first), line), |(number, run)| (run, line + number))
}
