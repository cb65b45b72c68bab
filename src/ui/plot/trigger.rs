//! The trigger form: line, event, level, and the fraction of the view before the event.

use egui::{RichText, Ui};

use crate::app::Text;
use crate::app::recorder::{Recorder, RecorderAction, SeriesId, Trigger, TriggerCondition};
use crate::ui::controls::{entry, options, primary_button, text_entry};
use crate::ui::{Theme, icons};

pub(super) struct Form {
    line: SeriesId,
    when: TriggerCondition,
    level: String,
    before: u32,
    repeat: bool,
    problem: Option<Text>,
}

impl Default for Form {
    fn default() -> Self {
        Form {
            line: SeriesId::default(),
            when: TriggerCondition::Rising,
            level: "0".to_owned(),
            before: 25,
            repeat: false,
            problem: None,
        }
    }
}

fn condition_id(when: TriggerCondition) -> &'static str {
    match when {
        TriggerCondition::Above => "trigger.above",
        TriggerCondition::Below => "trigger.below",
        TriggerCondition::Rising => "trigger.rising",
        TriggerCondition::Falling => "trigger.falling",
        TriggerCondition::Error => "trigger.error",
    }
}

pub(super) fn form_ui(
    ui: &mut Ui,
    theme: &Theme,
    recorder: &Recorder,
    form: &mut Form,
    actions: &mut Vec<RecorderAction>,
) {
    ui.set_width(300.0);
    if recorder.series_by_id(form.line).is_none_or(|line| !line.shown)
        && let Some(first) = recorder.visible_series().next()
    {
        form.line = first.id;
    }
    let label = |ui: &mut Ui, id: &'static str| {
        ui.label(theme.label(theme.translate(id)));
        theme.translate(id)
    };
    let word_of = label(ui, "trigger.line");
    let lines: Vec<(SeriesId, String)> =
        recorder.visible_series().map(|line| (line.id, theme.format_text(&line.name))).collect();
    options(ui, &word_of, &mut form.line, lines);
    let word_of = label(ui, "trigger.when");
    options(
        ui,
        &word_of,
        &mut form.when,
        TriggerCondition::ALL.map(|when| (when, theme.translate(condition_id(when)))),
    );
    let mut enter = false;
    if form.when.needs_level() {
        entry(ui, theme, &theme.translate("trigger.level"), |ui| {
            let response = text_entry(ui, &mut form.level, 88.0, &theme.translate("trigger.level"), "");
            if response.changed() {
                form.problem = None;
            }
            enter = response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            let unit = recorder.series_by_id(form.line).and_then(|line| line.scale());
            ui.label(theme.label(unit.map(|scale| theme.format_text(&scale.unit)).unwrap_or_default()));
        });
    }
    let word_of = label(ui, "trigger.before");
    options(ui, &word_of, &mut form.before, [0, 10, 25, 50, 75, 90].map(|share| (share, format!("{share} %"))));
    ui.checkbox(&mut form.repeat, theme.translate("trigger.repeat"));
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        if primary_button(ui, theme, true, icons::LIGHTNING, &theme.translate("trigger.arm")).clicked() || enter {
            match form.parse_trigger() {
                Ok(trigger) => {
                    form.problem = None;
                    actions.push(RecorderAction::Arm(trigger));
                    ui.close();
                }
                Err(problem) => form.problem = Some(problem),
            }
        }
    });
    if let Some(problem) = &form.problem {
        ui.label(RichText::new(theme.format_text(problem)).color(theme.palette.bad));
    }
}

impl Form {
    fn parse_trigger(&self) -> Result<Trigger, Text> {
        let level = match crate::app::parse_decimal(&self.level) {
            _ if !self.when.needs_level() => 0.0,
            Some(level) => level,
            None => return Err(Text::new("trigger.no_level")),
        };
        let before = f64::from(self.before) / 100.0;
        Ok(Trigger { line: self.line, when: self.when, level, before, repeat: self.repeat })
    }
}
