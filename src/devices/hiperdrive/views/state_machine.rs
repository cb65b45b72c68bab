//! State diagram: the seven states of a drive and the transitions between them (HIPERDRIVE reference, section 3).
//!
//! * **Size**: the available width, with five states in a row, and fault and lock below them.
//! * **Keyboard**: Tab moves through the reachable states. Space or Enter requests one.
//! * **Pointer**: a click on a reachable state requests it.
//! * **Accessible**: one button per state, with its name. The current state is selected, and unreachable ones are
//!   disabled.
//! * **Painting**: the current state is filled, in the accent colour in general, in the colour for good while moving,
//!   and in those for error and warning for fault and lock. Reachable states are outlined in the accent colour. The
//!   arrows are the same as in the figure of the manual.

use egui::accesskit::Role;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, pos2, vec2};

use crate::devices::hiperdrive::protocol::State;
use crate::ui::Theme;
use crate::ui::widgets::focus_ring;

#[derive(Clone, Copy, Debug)]
pub(crate) struct StateMachine<'a> {
    pub(crate) present: Option<State>,
    /// States that are reachable from the current state.
    pub(crate) reachable: &'a [State],
    pub(crate) names: &'a [String; 7],
    /// What a change to each state does, if possible.
    pub(crate) hints: &'a [Option<String>; 7],
}

const BOX_HEIGHT: f32 = 28.0;
const MAX_GAP: f32 = 28.0;
const BOX_SPACING: f32 = 16.0;
const MAX_BOX_WIDTH: f32 = 128.0;
/// Length of an arrowhead, and half its width.
const ARROWHEAD: f32 = 6.0;

const fn grid_position(state: State) -> (f32, f32) {
    match state {
        State::NotReady => (0.0, 0.0),
        State::Ready => (1.0, 0.0),
        State::Operational => (2.0, 0.0),
        State::Enabled => (3.0, 0.0),
        State::Moving => (4.0, 0.0),
        State::Fault => (3.0, 1.0),
        State::Locked => (1.0, 1.0),
    }
}

struct DiagramLayout {
    origin: Pos2,
    width: f32,
    gap: f32,
}

impl DiagramLayout {
    fn new(rect: Rect) -> Self {
        let gap = MAX_GAP.min(rect.width() / 20.0);
        let width = ((rect.width() - 4.0 * gap) / 5.0).clamp(1.0, MAX_BOX_WIDTH);
        // Excess width goes between the boxes, up to a limit.
        let gap = ((rect.width() - 5.0 * width) / 4.0).clamp(gap, MAX_GAP * 2.0);
        DiagramLayout { origin: rect.min, width, gap }
    }

    fn box_rect(&self, state: State) -> Rect {
        let (column, row) = grid_position(state);
        let min = self.origin + vec2(column * (self.width + self.gap), row * (BOX_HEIGHT + BOX_SPACING));
        Rect::from_min_size(min, vec2(self.width, BOX_HEIGHT))
    }
}

pub(crate) fn state_machine(ui: &mut Ui, theme: &Theme, machine: &StateMachine<'_>) -> Option<State> {
    let size = vec2(ui.available_width().max(240.0), 2.0 * BOX_HEIGHT + BOX_SPACING);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let plan = DiagramLayout::new(rect);
    paint_arrows(ui.painter(), theme, &plan, machine.present);
    let mut wanted = None;
    for ((state, name), hint) in State::ALL.into_iter().zip(machine.names).zip(machine.hints) {
        let place = plan.box_rect(state);
        let is_reachable = machine.reachable.contains(&state);
        let is_present = machine.present == Some(state);
        let sense = if is_reachable { Sense::click() } else { Sense::hover() };
        let mut response = ui.interact(place, ui.scope_id().with(state), sense);
        response.widget_info(|| {
            let mut info = WidgetInfo::selected(Role::Button, is_reachable, is_present, name);
            info.enabled = is_reachable;
            info
        });
        if let Some(hint) = hint {
            response = response.on_hover_text(hint);
        }
        state_box_ui(
            ui.painter(),
            theme,
            place,
            name,
            box_style(theme, state, is_present, is_reachable, response.hovered()),
        );
        if response.has_focus() {
            focus_ring(ui.painter(), theme, place, theme.radius);
        }
        if response.clicked() {
            wanted = Some(state);
        }
    }
    wanted
}

struct BoxStyle {
    fill: Color32,
    edge: Stroke,
    ink: Color32,
    strong: bool,
}

fn box_style(theme: &Theme, state: State, is_present: bool, is_reachable: bool, hovered: bool) -> BoxStyle {
    let palette = theme.palette;
    if is_present {
        let (fill, ink) = match state {
            State::Fault => (palette.bad, palette.on_bad),
            State::Locked => (palette.warn, palette.on_bad),
            State::Moving => (palette.good, palette.on_bad),
            _ => (palette.accent, palette.on_accent),
        };
        return BoxStyle { fill: fill.into(), edge: Stroke::NONE, ink: ink.into(), strong: true };
    }
    let (edge, ink) = if is_reachable { (palette.accent, palette.text) } else { (palette.line, palette.muted) };
    let fill = match (is_reachable, hovered) {
        (true, true) => Color32::from(palette.accent).gamma_multiply(0.15),
        _ => palette.raised.into(),
    };
    BoxStyle { fill, edge: Stroke::new(1.0, edge), ink: ink.into(), strong: false }
}

fn state_box_ui(painter: &Painter, theme: &Theme, rect: Rect, name: &str, look: BoxStyle) {
    painter.rect_filled(rect, theme.radius, look.fill);
    painter.rect_stroke(rect, theme.radius, look.edge, StrokeKind::Inside);
    let font = |size| if look.strong { theme.bold_font(size) } else { FontId::proportional(size) };
    let room = rect.width() - 8.0;
    let whole = painter.layout_no_wrap(name.to_owned(), font(theme.sizes.body), look.ink);
    let words = if whole.size().x <= room {
        whole
    } else {
        painter.layout(name.to_owned(), font(theme.sizes.caption), look.ink, room)
    };
    painter.galley(Align2::CENTER_CENTER.align_size_within_rect(words.size(), rect).min, words, look.ink);
}

/// Draws the arrows between the boxes: in both directions within the row, three into the fault, and two out of the
/// lock.
fn paint_arrows(painter: &Painter, theme: &Theme, plan: &DiagramLayout, present: Option<State>) {
    let faint = Color32::from(theme.palette.muted).gamma_multiply(0.7);
    // Arrows from the present state are highlighted.
    let ink = |from: &[State]| {
        let own = present.is_some_and(|present| from.contains(&present));
        Stroke::new(if own { 1.5 } else { 1.0 }, if own { theme.palette.accent.into() } else { faint })
    };
    let row = [State::NotReady, State::Ready, State::Operational, State::Enabled, State::Moving];
    for (left, right) in row.iter().zip(row.iter().skip(1)) {
        let (a, b) = (plan.box_rect(*left), plan.box_rect(*right));
        let (up, down) = (a.center().y - 6.0, a.center().y + 6.0);
        paint_line(painter, &[pos2(a.right() + 2.0, up), pos2(b.left() - 2.0, up)], ink(&[*left]));
        paint_line(painter, &[pos2(b.left() - 2.0, down), pos2(a.right() + 2.0, down)], ink(&[*right]));
    }
    let level = plan.box_rect(State::Enabled).bottom() + BOX_SPACING / 2.0;
    let fault = plan.box_rect(State::Fault);
    for from in [State::Operational, State::Enabled, State::Moving] {
        let from_box = plan.box_rect(from);
        let start = pos2(from_box.center().x, from_box.bottom() + 2.0);
        let bends = [start, pos2(start.x, level), pos2(fault.center().x, level), fault.center_top() - vec2(0.0, 2.0)];
        paint_line(painter, &bends, ink(&[from]));
    }
    let lock = plan.box_rect(State::Locked);
    let between = [pos2(fault.left() - 2.0, fault.center().y), pos2(lock.right() + 2.0, lock.center().y)];
    paint_line(painter, &between, ink(&[State::Fault]));
    let ready = plan.box_rect(State::Ready);
    paint_line(
        painter,
        &[lock.center_top() - vec2(0.0, 2.0), ready.center_bottom() + vec2(0.0, 2.0)],
        ink(&[State::Locked]),
    );
    let idle = plan.box_rect(State::NotReady);
    let side = [
        pos2(lock.left() - 2.0, lock.center().y),
        pos2(idle.center().x, lock.center().y),
        idle.center_bottom() + Vec2::new(0.0, 2.0),
    ];
    paint_line(painter, &side, ink(&[State::Locked]));
}

fn paint_line(painter: &Painter, points: &[Pos2], stroke: Stroke) {
    for (from, to) in points.iter().zip(points.iter().skip(1)) {
        painter.line_segment([*from, *to], stroke);
    }
    let mut last = points.iter().rev();
    let (Some(tip), Some(before)) = (last.next(), last.find(|before| points.last() != Some(before))) else { return };
    let along = (*tip - *before).normalized() * ARROWHEAD;
    let across = along.rot90() * 0.5;
    let head = vec![*tip, *tip - along + across, *tip - along - across];
    painter.add(egui::Shape::convex_polygon(head, stroke.color, Stroke::NONE));
}

#[cfg(test)]
mod tests {
    use egui::Key;
    use egui_kittest::Harness;
    use egui_kittest::kittest::{NodeT, Queryable};

    use super::*;
    use crate::ui::widgets::tests::{NONE, focus, press, theme, window};

    fn states(present: Option<State>) -> Harness<'static, Vec<State>> {
        let names = State::ALL.map(|state| state.name().to_owned());
        let hints = State::ALL.map(|state| (state == State::Ready).then(|| "Control word 0x0400".to_owned()));
        let reachable: Vec<State> = match present {
            Some(State::Operational) => vec![State::NotReady, State::Ready, State::Enabled],
            _ => Vec::new(),
        };
        window(Vec::new(), move |ui, asked: &mut Vec<State>| {
            let machine = StateMachine { present, reachable: &reachable, names: &names, hints: &hints };
            asked.extend(state_machine(ui, &theme(), &machine));
        })
    }

    #[test]
    fn offers_only_reachable_states() {
        let mut harness = states(Some(State::Operational));
        for state in State::ALL {
            let node = harness.get_by_label(state.name());
            let reachable = matches!(state, State::NotReady | State::Ready | State::Enabled);
            assert_eq!(node.accesskit_node().is_disabled(), !reachable, "{state}");
            node.click();
            harness.run();
            let expected: &[State] = if reachable { &[state] } else { &[] };
            assert_eq!(std::mem::take(harness.state_mut()), expected, "{state}");
        }
        focus(&mut harness, "enabled");
        press(&mut harness, &[(NONE, Key::Enter)]);
        assert_eq!(*harness.state(), [State::Enabled]);
        assert!(states(None).get_by_label("moving").accesskit_node().is_disabled());
    }
}
