//! The 32 bits of the cam output word for the current window shift. A row below shows which position bits the window
//! contains.
//!
//! * **Size**: The widget has the available width. If 32 cells do not fit, half of them are on a second line.
//! * **Keyboard**: Tab skips the widget.
//! * **Pointer**: The meaning of the bit under the pointer is shown.
//! * **Accessible**: The widget is an image with the given label, and its value lists the groups. Each group is a label
//!   with its bits.
//! * **Painting**: Each bit is a cell with the bit number above it. The cell contains the bit or, without a word, the
//!   number of the position bit or cam. The position bits are in a separate row, and those that are not sent are
//!   hollow.

use egui::accesskit::Role;
use egui::{
    Align2, Color32, CornerRadius, FontId, Painter, Rect, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, pos2,
};

use crate::app::Text;
use crate::devices::interbus::protocol::{CamBit, CamOutput, Value, WindowShift};
use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::views::translate;
use crate::ui::Theme;
use crate::ui::widgets::{BitCell, series_colour};

#[derive(Clone, Copy, Debug)]
pub(crate) struct WordLayout<'a> {
    pub(crate) label: &'a str,
    pub(crate) shift: WindowShift,
    /// Received cam output word, or `None` to show only the layout.
    pub(crate) word: Option<u32>,
    /// Measuring range in steps. Position bits that it does not need are always 0.
    pub(crate) range: u32,
}

/// Adjacent bits of the same kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Group {
    kind: Kind,
    /// Highest bit of the group within the word.
    high: u8,
    low: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Invalid,
    Zero,
    Window,
    Cams,
}

const MIN_CELL_WIDTH: f32 = 17.0;
const MAX_CELL_WIDTH: f32 = 26.0;
const NUMBER_HEIGHT: f32 = 15.0;
const CELL_HEIGHT: f32 = 24.0;
const NAME_HEIGHT: f32 = 20.0;
const GAP_HEIGHT: f32 = 8.0;
const BITS: u8 = 32;
const POSITION: u8 = Value::BITS as u8;

impl Kind {
    const fn from_bit(bit: CamBit) -> Self {
        match bit {
            CamBit::Invalid => Kind::Invalid,
            CamBit::Zero => Kind::Zero,
            CamBit::Position(_) => Kind::Window,
            CamBit::Cam(_) => Kind::Cams,
        }
    }

    fn display_colour(self, theme: &Theme) -> Color32 {
        match self {
            Kind::Invalid => theme.palette.bad.into(),
            Kind::Zero => theme.palette.muted.into(),
            Kind::Window => series_colour(theme, 1),
            Kind::Cams => series_colour(theme, 2),
        }
    }
}

impl WordLayout<'_> {
    fn bit(&self, bit: u8) -> CamBit {
        CamOutput::bit(bit, self.shift).unwrap_or(CamBit::Zero)
    }

    /// Returns the groups of bits, from the highest to the lowest.
    fn bit_groups(&self) -> Vec<Group> {
        let mut groups: Vec<Group> = Vec::new();
        for bit in (0..BITS).rev() {
            let kind = Kind::from_bit(self.bit(bit));
            match groups.last_mut() {
                Some(group) if group.kind == kind => group.low = bit,
                _ => groups.push(Group { kind, high: bit, low: bit }),
            }
        }
        groups
    }

    /// Returns the highest and the lowest position bit that the window contains.
    fn window_bits(&self) -> Option<(u8, u8)> {
        let mask = self.shift.mask();
        let high = mask.checked_ilog2()?;
        u8::try_from(high).ok().zip(u8::try_from(mask.trailing_zeros()).ok())
    }

    /// Returns the name of a group and the numbers of its bits.
    fn name(&self, group: Group) -> Text {
        match group.kind {
            Kind::Invalid => TEXTS.text("cams.word_invalid"),
            Kind::Zero => TEXTS.text("cams.word_zero"),
            Kind::Cams => TEXTS.text("cams.word_cams"),
            Kind::Window => {
                let (high, low) = self.window_bits().unwrap_or_default();
                TEXTS.text("cams.word_window").with("high", high).with("low", low)
            }
        }
    }

    fn bit_text(&self, bit: u8) -> Text {
        let own = match self.bit(bit) {
            CamBit::Invalid => TEXTS.text("cams.word_invalid"),
            CamBit::Zero => TEXTS.text("cams.word_zero"),
            CamBit::Position(number) => TEXTS.text("cams.word_position").with("bit", number),
            CamBit::Cam(number) => TEXTS.text("cams.output_of").with("cam", number),
        };
        TEXTS.text("cams.word_bit").with("bit", bit).with_text("what", own)
    }

    fn is_set(&self, bit: u8) -> Option<bool> {
        self.word.map(|word| word >> bit & 1 == 1)
    }
}

struct CellGrid {
    left: f32,
    top: f32,
    cell: f32,
    columns: u8,
}

impl CellGrid {
    fn new(room: f32) -> Self {
        let columns = if room >= f32::from(BITS) * MIN_CELL_WIDTH { BITS } else { BITS / 2 };
        let cell = (room / f32::from(columns)).floor().clamp(MIN_CELL_WIDTH, MAX_CELL_WIDTH);
        CellGrid { left: 0.0, top: 0.0, cell, columns }
    }

    fn line_height() -> f32 {
        NUMBER_HEIGHT + CELL_HEIGHT + NAME_HEIGHT + GAP_HEIGHT
    }

    fn size(&self) -> Vec2 {
        let lines = f32::from(BITS / self.columns) * CellGrid::line_height();
        Vec2::new(f32::from(self.columns) * self.cell, lines + CELL_HEIGHT * f32::from(self.position_lines()))
    }

    /// Returns how many lines the position bits take up.
    const fn position_lines(&self) -> u8 {
        POSITION.div_ceil(self.columns)
    }

    fn at_origin(self, origin: egui::Pos2) -> Self {
        CellGrid { left: origin.x, top: origin.y, ..self }
    }

    fn bit_rect(&self, bit: u8) -> Rect {
        let place = BITS - 1 - bit.min(BITS - 1);
        let line = f32::from(place / self.columns) * CellGrid::line_height() + NUMBER_HEIGHT;
        self.cell_at(place % self.columns, line)
    }

    fn position(&self, bit: u8) -> Rect {
        let lines = self.position_lines() * self.columns;
        let place = lines - 1 - bit.min(lines - 1);
        let word = f32::from(BITS / self.columns) * CellGrid::line_height();
        self.cell_at(place % self.columns, word + f32::from(place / self.columns) * CELL_HEIGHT)
    }

    fn cell_at(&self, column: u8, line: f32) -> Rect {
        let at = pos2(self.left + f32::from(column) * self.cell, self.top + line);
        Rect::from_min_size(at, Vec2::new(self.cell - 1.0, CELL_HEIGHT - 1.0))
    }

    /// Returns the rectangles around the bits from `high` down to `low`, one per line.
    fn range_rects(&self, high: u8, low: u8) -> Vec<Rect> {
        let mut runs: Vec<Rect> = Vec::new();
        for bit in (low..=high).rev() {
            let cell = self.bit_rect(bit);
            match runs.last_mut().filter(|run| (run.top() - cell.top()).abs() < 1.0) {
                Some(run) => *run = run.union(cell),
                None => runs.push(cell),
            }
        }
        runs
    }
}

pub(crate) fn word_layout(ui: &mut Ui, theme: &Theme, layout: &WordLayout<'_>) {
    let cells = CellGrid::new(ui.available_width());
    let (outer, response) = ui.allocate_exact_size(cells.size(), Sense::hover());
    let cells = cells.at_origin(outer.min);
    let values: Vec<String> = layout.bit_groups().iter().map(|group| describe_group(theme, layout, *group)).collect();
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::Image, true, layout.label);
        info.current_text_value = Some(values.join(", "));
        info
    });
    let base = response.id;
    for bit in (0..BITS).rev() {
        word_bit(ui, theme, layout, bit, cells.bit_rect(bit));
        let own = ui.interact(cells.bit_rect(bit), base.with(bit), Sense::hover());
        own.on_hover_text(theme.format_text(&layout.bit_text(bit)));
    }
    for (group, words) in layout.bit_groups().into_iter().zip(&values) {
        draw_group_name(ui, theme, layout, &cells, group);
        let Some(run) =
            cells.range_rects(group.high, group.low).into_iter().max_by(|a, b| a.width().total_cmp(&b.width()))
        else {
            continue;
        };
        let lane = Rect::from_min_size(run.left_bottom(), Vec2::new(run.width(), NAME_HEIGHT));
        let own = ui.interact(lane, base.with((group.high, group.low)), Sense::hover());
        own.widget_info(|| WidgetInfo::labeled(Role::Label, true, words));
        own.on_hover_text(words);
    }
    paint_position(ui.painter(), theme, layout, &cells);
    ui.add(egui::Label::new(theme.caption(translate(theme, "cams.word_of_position"))).wrap());
}

/// Describes a group and where it is in the word, with its bits if there is a word.
fn describe_group(theme: &Theme, layout: &WordLayout<'_>, group: Group) -> String {
    let name = theme.format_text(&layout.name(group));
    let place = if group.high == group.low {
        TEXTS.text("cams.word_place").with("bit", group.high)
    } else {
        TEXTS.text("cams.word_places").with("high", group.high).with("low", group.low)
    };
    let bits: Option<String> =
        (group.low..=group.high).rev().map(|bit| layout.is_set(bit).map(|set| if set { '1' } else { '0' })).collect();
    let place = theme.format_text(&place);
    match bits {
        Some(bits) => format!("{name}, {place}: {bits}"),
        None => format!("{name}, {place}"),
    }
}

fn word_bit(ui: &Ui, theme: &Theme, layout: &WordLayout<'_>, bit: u8, rect: Rect) {
    let kind = Kind::from_bit(layout.bit(bit));
    let blank = match layout.bit(bit) {
        CamBit::Invalid => "!".to_owned(),
        CamBit::Zero => "0".to_owned(),
        CamBit::Position(number) | CamBit::Cam(number) => number.to_string(),
    };
    let set = layout.is_set(bit);
    let is_wrong = set == Some(true) && matches!(kind, Kind::Invalid | Kind::Zero);
    let painter = ui.painter();
    BitCell { ink: kind.display_colour(theme), bit: set, blank: &blank, alarm: is_wrong }.paint(painter, theme, rect);
    let font = FontId::monospace(theme.sizes.caption);
    let above = pos2(rect.center().x, rect.top() - NUMBER_HEIGHT / 2.0);
    painter.text(above, Align2::CENTER_CENTER, bit.to_string(), font, theme.palette.muted.into());
}

/// Draws a bracket below a group, with its name if that fits.
fn draw_group_name(ui: &Ui, theme: &Theme, layout: &WordLayout<'_>, cells: &CellGrid, group: Group) {
    let painter = ui.painter();
    let ink = group.kind.display_colour(theme);
    let runs = cells.range_rects(group.high, group.low);
    for run in &runs {
        painter.hline(run.left() + 1.0..=run.right() - 1.0, run.bottom() + 3.0, Stroke::new(2.0, ink));
    }
    let Some(run) = runs.into_iter().max_by(|a, b| a.width().total_cmp(&b.width())) else { return };
    let font = FontId::proportional(theme.sizes.caption);
    let words = theme.format_text(&layout.name(group));
    let galley = painter.layout_no_wrap(words, font, theme.palette.muted.into());
    if galley.size().x <= run.width() {
        let at = pos2(run.center().x - galley.size().x / 2.0, run.bottom() + 5.0);
        painter.galley(at, galley, theme.palette.muted.into());
    }
}

/// Draws the position bits, and marks those that are not sent or not needed for the range.
fn paint_position(painter: &Painter, theme: &Theme, layout: &WordLayout<'_>, cells: &CellGrid) {
    let mask = layout.shift.mask();
    let last = layout.range.saturating_sub(1);
    let used = u32::BITS - last.leading_zeros();
    let bits = layout.word.and_then(|word| CamOutput::parse(word).ok()).map(|own| own.position_bits(layout.shift));
    let ink = Kind::Window.display_colour(theme);
    for bit in (0..POSITION).rev() {
        let rect = cells.position(bit);
        let is_sent = mask >> bit & 1 == 1;
        let font = FontId::monospace(theme.sizes.caption);
        if is_sent {
            let set = bits.map(|bits| bits >> bit & 1 == 1);
            BitCell { ink, bit: set, blank: &bit.to_string(), alarm: false }.paint(painter, theme, rect);
        } else {
            let is_used = u32::from(bit) < used;
            let colour = if is_used { theme.palette.warn } else { theme.palette.line };
            painter.rect_stroke(rect, CornerRadius::same(2), Stroke::new(1.0, colour), StrokeKind::Inside);
            let ink = if is_used { theme.palette.text } else { theme.palette.muted };
            painter.text(rect.center(), Align2::CENTER_CENTER, bit.to_string(), font, ink.into());
        }
    }
}
