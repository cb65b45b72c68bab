//! Contents of the steps in the axis set-up: entries, results and jog buttons.

use egui::{RichText, Ui, vec2};

use super::AxisPanel;
use crate::app::{Action, Severity, Text};
use crate::devices::hiperdrive::protocol::Direction;
use crate::devices::hiperdrive::state::axis::{
    AxisAction as Run, AxisButton, AxisStep, LengthEntries, TestTarget, labels,
};
use crate::devices::hiperdrive::state::{MotorCommand, TEXTS};
use crate::devices::hiperdrive::views::jog::jog_button_ui;
use crate::devices::hiperdrive::views::translate;
use crate::ui::controls::{button_with_reason, entry, paragraph, problem_ui, row, text_entry};
use crate::ui::widgets::HoldButton;
use crate::ui::{Theme, icons};

const ENTRY_WIDTH: f32 = 112.0;
const JOG_BUTTON_HEIGHT: f32 = 64.0;
const GO_BUTTON_WIDTH: f32 = 172.0;

pub(super) fn content_ui(
    ui: &mut Ui,
    theme: &Theme,
    shown: &AxisPanel<'_>,
    entries: &mut LengthEntries,
    actions: &mut Vec<Action>,
) {
    let step = shown.axis.step();
    if step.needs_cyclic_connection() {
        control_ui(ui, theme, shown, actions);
    }
    if step.is_jogging() {
        jog_buttons_ui(ui, theme, shown, actions);
    }
    match step {
        AxisStep::Scale => {
            number_ui(ui, theme, "hd_axis.pitch", &mut entries.pitch);
            number_ui(ui, theme, "hd_axis.resolution", &mut entries.resolution);
        }
        AxisStep::Confirm => limits_ui(ui, theme, shown, actions),
        AxisStep::Reference => number_ui(ui, theme, "hd_axis.reference", &mut entries.reference),
        AxisStep::Lower => number_ui(ui, theme, "hd_axis.lower", &mut entries.lower),
        AxisStep::Upper => number_ui(ui, theme, "hd_axis.upper", &mut entries.upper),
        AxisStep::Test => test_ui(ui, theme, shown, actions),
        AxisStep::PowerCycle => supply_switch_ui(ui, theme, shown, actions),
        AxisStep::Request | AxisStep::Jog | AxisStep::Save => {}
    }
    if matches!(
        step,
        AxisStep::Request | AxisStep::Scale | AxisStep::Reference | AxisStep::Lower | AxisStep::Upper | AxisStep::Save
    ) {
        ui.add_space(theme.space.inside);
        ui.horizontal_wrapped(|ui| buttons_ui(ui, theme, shown, actions));
    }
}

fn buttons_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, actions: &mut Vec<Action>) {
    let step = shown.axis.step();
    if matches!(step, AxisStep::Lower | AxisStep::Upper) {
        let allowed = shown.axis.check_can_adopt_position(shown.seen);
        if button_with_reason(ui, theme, &allowed, icons::TARGET, &translate(theme, "hd_axis.take_place")).clicked() {
            shown.push(actions, Run::TakePlace);
        }
    }
    if step != AxisStep::Lower {
        let word = theme.format_text(&labels::button_label(step));
        shown.button_ui(ui, theme, AxisButton::Do, (icons::PENCIL_SIMPLE, &word), actions);
    }
    if step == AxisStep::Request {
        super::write_back_button_ui(ui, theme, shown, actions);
    }
    super::skip_ui(ui, theme, shown, actions);
}

/// Draws messages about the entries and results of the step, but no clickable widgets.
pub(super) fn messages_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, entries: &LengthEntries) {
    let step = shown.axis.step();
    if step.is_jogging() {
        availability_ui(ui, theme, shown);
    }
    match step {
        AxisStep::Scale => scale(ui, theme, shown, entries),
        AxisStep::Reference => reference_ui(ui, theme, shown, entries),
        AxisStep::Test => {
            for own in TestTarget::ALL {
                let Some(outcome) = shown.axis.test_outcome(own) else { continue };
                let ink = if outcome.is_good() { theme.palette.good } else { theme.palette.bad };
                let place = theme.format_text(&labels::target_text(own));
                let words = theme.format_text(&labels::outcome_text(&outcome, shown.seen));
                row(ui, theme, &place, RichText::new(words).color(ink));
            }
        }
        _ => {}
    }
}

/// Draws the buttons that take control and acknowledge a fault. Before that, the drive cannot be moved.
fn control_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, actions: &mut Vec<Action>) {
    ui.horizontal_wrapped(|ui| {
        let word = translate(theme, "hd_axis.take");
        shown.button_ui(ui, theme, AxisButton::Take, (icons::PLUGS_CONNECTED, &word), actions);
        let word = translate(theme, "hd_axis.acknowledge");
        shown.button_ui(ui, theme, AxisButton::Acknowledge, (icons::CHECK, &word), actions);
    });
    ui.add_space(theme.space.inside);
}

fn check_can_jog(shown: &AxisPanel<'_>, direction: Direction) -> Result<(), Text> {
    shown.axis.may_move(shown.seen).and_then(|()| shown.unit.check_can_jog(shown.axis.drive(), direction))
}

/// Draws what the jog buttons do, or why they are blocked.
fn availability_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>) {
    let blocked = [Direction::Counterclockwise, Direction::Clockwise].map(|own| check_can_jog(shown, own).err());
    if let Some(outside) = shown.unit.outside_limits_text(shown.axis.drive()) {
        super::line_ui(ui, theme, Severity::Error, &outside);
    }
    if let Some(why) = blocked.into_iter().flatten().next()
        && shown.seen.controlled
        && shown.axis.invalidated_step().is_none()
        // The reason is already shown above.
        && shown.axis.check_can_continue(shown.seen).err().as_ref() != Some(&why)
    {
        super::warning_ui(ui, theme, &why);
    }
    if let Some(status) = shown.unit.current_or_last_request(shown.axis.drive()) {
        let ink = if status.is_well { theme.palette.muted } else { theme.palette.warn };
        paragraph(ui, RichText::new(theme.format_text(&status.words)).color(ink));
    }
}

fn jog_buttons_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, actions: &mut Vec<Action>) {
    let width = ((ui.available_width() - theme.space.between) / 2.0).max(0.0);
    let caption = theme.format_text(&labels::speed_torque_text("hd_axis.jog_hold"));
    ui.horizontal(|ui| {
        for (direction, word, label) in
            [(Direction::Counterclockwise, "−", "hd_axis.jog_down"), (Direction::Clockwise, "+", "hd_axis.jog_up")]
        {
            let (label, enabled) = (translate(theme, label), check_can_jog(shown, direction).is_ok());
            let has_ended = shown.unit.moves.has_held_jog_ended();
            let button = HoldButton { word, caption: &caption, label: &label, enabled, has_ended };
            let press = MotorCommand::SlowJogPress { direction, repeated: false };
            let about = (shown.unit.session.id, shown.axis.drive());
            jog_button_ui(ui, theme, about, press, (&button, vec2(width, JOG_BUTTON_HEIGHT)), actions);
        }
    });
    ui.add_space(theme.space.inside);
}

fn number_ui(ui: &mut Ui, theme: &Theme, id: &'static str, text: &mut String) {
    let word = translate(theme, id);
    entry(ui, theme, &word, |ui| text_entry(ui, text, ENTRY_WIDTH, &word, ""));
}

/// Draws the values that would result from the entered pitch and resolution, before they are written.
fn scale(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, entries: &LengthEntries) {
    if entries.pitch.trim().is_empty() {
        return;
    }
    let preview = match entries.preview(shown.seen) {
        Ok(preview) => preview,
        Err(why) => return problem_ui(ui, theme, Some(&why)),
    };
    let ruler = Some(preview.ruler);
    let range = |low: Text, high: Text| TEXTS.text("hd_axis.range").with_text("low", low).with_text("high", high);
    let mm = |steps: i32| labels::millimetres_text(ruler, steps.into());
    let scale = format!("{} / {}", preview.scale.numerator(), preview.scale.denominator());
    row(ui, theme, &translate(theme, "hd_axis.preview_scale"), theme.monospace(scale));
    row(
        ui,
        theme,
        &translate(theme, "hd_axis.preview_steps"),
        theme.monospace(theme.format_significant_digits(preview.scale.steps_per_turn())),
    );
    row(ui, theme, &translate(theme, "hd_axis.preview_grain"), theme.monospace(theme.format_text(&mm(64))));
    let whole = theme.format_text(&range(mm(preview.lower), mm(preview.upper)));
    row(ui, theme, &translate(theme, "hd_axis.preview_range"), theme.monospace(whole));
    if let (Some((low, high)), true) = (preview.unchanged, shown.seen.scale != Some(preview.scale)) {
        let value = |own: f64| TEXTS.text("hd_axis.millimetres").with_number("value", own, 0);
        let text = TEXTS.text("hd_axis.preview_unchanged_value");
        let text = text.with_text("low", value(low)).with_text("high", value(high));
        row(
            ui,
            theme,
            &translate(theme, "hd_axis.preview_unchanged"),
            RichText::new(theme.format_text(&text)).color(theme.palette.warn),
        );
    }
}

fn limits_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, actions: &mut Vec<Action>) {
    let mm = |steps: i32| labels::millimetres_text(shown.seen.ruler(), steps.into());
    let range = |(low, high): (i32, i32)| {
        theme.format_text(&TEXTS.text("hd_axis.range").with_text("low", mm(low)).with_text("high", mm(high)))
    };
    ui.label(theme.value(shown.seen.limits.map_or_else(|| translate(theme, "hd_axis.none"), range)));
    ui.add_space(theme.space.inside);
    ui.horizontal_wrapped(|ui| {
        let word = translate(theme, "hd_axis.confirm");
        shown.button_ui(ui, theme, AxisButton::Confirm, (icons::EYE, &word), actions);
        let word = translate(theme, "hd_axis.widen");
        shown.button_ui(ui, theme, AxisButton::Widen, (icons::ARROWS_OUT_LINE_HORIZONTAL, &word), actions);
    });
}

fn reference_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, entries: &LengthEntries) {
    let ruler = shown.seen.ruler();
    match entries.parse_reference(ruler, shown.seen.limits) {
        Ok(own) if own.asked != own.becomes => {
            let text = TEXTS
                .text("hd_axis.becomes")
                .with_text("position", labels::millimetres_text(ruler, own.becomes.into()));
            paragraph(ui, RichText::new(theme.format_text(&text)).color(theme.palette.warn));
        }
        Ok(_) => {}
        Err(why) => problem_ui(ui, theme, Some(&why)),
    }
}

fn test_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, actions: &mut Vec<Action>) {
    let mm = |steps: i32| theme.format_text(&labels::millimetres_text(shown.seen.ruler(), steps.into()));
    for own in TestTarget::ALL {
        let word = theme.format_text(&labels::target_text(own));
        entry(ui, theme, &word, |ui| {
            let target = shown.axis.target(own, shown.seen).ok();
            let go = format!("{} {}", translate(theme, "hd_axis.go"), target.map(&mm).unwrap_or_default());
            // The results of the three test moves are drawn below each other.
            let size = vec2(GO_BUTTON_WIDTH, ui.spacing().interact_size.y);
            ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
                ui.set_min_width(GO_BUTTON_WIDTH);
                shown.button_ui(ui, theme, AxisButton::Go(own), (icons::PLAY, &go), actions);
            });
            if shown.axis.running_test_target() == Some(own) {
                ui.label(theme.label(translate(theme, "hd_axis.goes")));
            } else if let Some(outcome) = shown.axis.test_outcome(own) {
                let (icon, ink) = match outcome.is_good() {
                    true => (icons::CHECK, theme.palette.good),
                    false => (icons::X, theme.palette.bad),
                };
                ui.label(RichText::new(icon).color(ink));
            }
        });
    }
}

/// Draws the controls for the power cycle. The supply of a virtual device is switched here, but that of a real device
/// by hand.
fn supply_switch_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, actions: &mut Vec<Action>) {
    ui.horizontal_wrapped(|ui| {
        let word = theme.format_text(&labels::button_label(AxisStep::PowerCycle));
        shown.button_ui(ui, theme, AxisButton::Do, (icons::PENCIL_SIMPLE, &word), actions);
        let word = translate(theme, "hd_axis.give");
        shown.button_ui(ui, theme, AxisButton::Give, (icons::PLUGS, &word), actions);
        if shown.seen.is_virtual {
            let word = translate(theme, "hd_axis.power_cycle");
            shown.button_ui(ui, theme, AxisButton::PowerCycle, (icons::POWER, &word), actions);
        } else {
            let word = translate(theme, "hd_axis.restarted");
            shown.button_ui(ui, theme, AxisButton::Restarted, (icons::POWER, &word), actions);
        }
        super::skip_ui(ui, theme, shown, actions);
    });
}
