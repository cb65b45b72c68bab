//! Every parameter: what it is, what is wanted of it, what it may be, what it comes with from the factory, whether it is kept.

use std::collections::BTreeMap;

use egui::{RichText, Ui};
use egui_extras::{Column, TableBuilder};

use crate::app::hiperdrive::{Action as Hiperdrive, Row, Unit, forms};
use crate::app::{Action, Text};
use crate::protocol::hiperdrive::ParameterNumber;
use crate::ui::controls::{card, empty, options, paragraph, settled_entry, text_entry};
use crate::ui::{Skin, icons};

/// What is typed and does not count yet, and what is looked for.
#[derive(Default)]
pub(super) struct View {
    sought: String,
    shown: Shown,
    drafts: BTreeMap<ParameterNumber, Option<(String, Option<Text>)>>,
}

/// Which parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Shown {
    All,
    /// Those that can be written; whatever is looked for by name or number.
    #[default]
    Written,
    /// Those that are edited or were another value when they were read before.
    Changed,
}

/// Widths and heights.
const NUMBER: f32 = 44.0;
const VALUE: f32 = 168.0;
const ENTRY: f32 = 88.0;
const RANGE: f32 = 136.0;
const FACTORY: f32 = 80.0;
const KEPT: f32 = 48.0;
/// Of a line that is read, and of one that is typed into.
const READ: f32 = 20.0;
const TYPED: f32 = 34.0;
const NARROW: f32 = 600.0;

pub(super) fn page_ui(ui: &mut Ui, skin: &Skin, unit: &Unit, view: &mut View, actions: &mut Vec<Action>) {
    ui.horizontal_wrapped(|ui| {
        text_entry(ui, &mut view.sought, 180.0, &skin.say("hd_params.seek"), &skin.say("hd_params.seek"));
        let shown = [
            (Shown::All, "hd_params.all"),
            (Shown::Written, "hd_params.written"),
            (Shown::Changed, "hd_params.changed"),
        ];
        options(ui, &skin.say("hd_params.show"), &mut view.shown, shown.map(|(own, id)| (own, skin.say(id))));
    });
    if let Some(refusal) = &unit.refusal {
        paragraph(ui, RichText::new(skin.words(refusal)).color(skin.palette.bad));
    }
    // What is typed and cannot be stands above the table too: a row has no room for it.
    for (number, draft) in &view.drafts {
        if let Some((_, Some(why))) = draft {
            paragraph(ui, RichText::new(format!("{number}: {}", skin.words(why))).color(skin.palette.bad));
        }
    }
    for (title, drive) in [("hd_params.drive", Some(unit.drive())), ("hd_params.device", None)] {
        let rows: Vec<Row> = unit.rows(drive).into_iter().filter(|row| view.shows(skin, row)).collect();
        card(ui, skin, title, |ui| {
            if rows.is_empty() {
                empty(ui, skin, &skin.say("hd_params.none"), None);
            } else {
                table(ui, skin, unit, &rows, view, actions);
            }
        });
        ui.add_space(skin.space.groups);
    }
    paragraph(ui, skin.caption(skin.say("hd_params.controller")));
    paragraph(ui, skin.caption(skin.say("hd_params.not_kept")));
}

impl View {
    fn shows(&self, skin: &Skin, row: &Row) -> bool {
        let sought = self.sought.trim().to_lowercase();
        let fits = sought.is_empty()
            || row.number.get().to_string().contains(&sought)
            || skin.words(&row.name).to_lowercase().contains(&sought);
        fits && match self.shown {
            Shown::All => true,
            Shown::Written => row.is_editable || !sought.is_empty(),
            Shown::Changed => row.is_edited || row.changed_from.is_some(),
        }
    }
}

fn table(ui: &mut Ui, skin: &Skin, unit: &Unit, rows: &[Row], view: &mut View, actions: &mut Vec<Action>) {
    let narrow = ui.available_width() < NARROW;
    let id = rows.first().map(|row| row.number);
    ui.push_id(id, |ui| {
        ui.spacing_mut().interact_size.y = 20.0;
        ui.spacing_mut().item_spacing.y = 0.0;
        let mut table = TableBuilder::new(ui)
            .vscroll(false)
            .cell_layout(egui::Layout::left_to_right(egui::Align::Center))
            .column(Column::exact(NUMBER))
            .column(Column::remainder().at_least(96.0).clip(true))
            .column(Column::exact(VALUE));
        if !narrow {
            table = table.column(Column::exact(RANGE).clip(true)).column(Column::exact(FACTORY).clip(true));
        }
        table
            .column(Column::exact(KEPT))
            .header(20.0, |mut header| {
                let heads = ["hd_params.number", "hd_params.name", "hd_params.value"];
                let wide = ["hd_params.range", "hd_params.factory"];
                let wide = wide.into_iter().filter(|_| !narrow);
                for head in heads.into_iter().chain(wide).chain(["hd_params.kept"]) {
                    header.col(|ui| {
                        ui.label(skin.caption(skin.say(head)));
                    });
                }
            })
            .body(|body| {
                let heights = rows.iter().map(|row| if row.is_editable { TYPED } else { READ });
                body.heterogeneous_rows(heights, |mut line| {
                    let Some(row) = rows.get(line.index()) else { return };
                    line.col(|ui| {
                        ui.label(skin.mono(row.number.to_string()));
                    });
                    line.col(|ui| {
                        let name = egui::Label::new(skin.words(&row.name)).truncate();
                        ui.add(name).on_hover_text(hint(skin, row));
                    });
                    line.col(|ui| value(ui, skin, unit, row, view, actions));
                    if !narrow {
                        line.col(|ui| {
                            let range = words(skin, row.range.as_ref());
                            ui.add(egui::Label::new(skin.caption(&range)).truncate()).on_hover_text(range);
                        });
                        line.col(|ui| {
                            ui.add(egui::Label::new(skin.caption(&row.factory)).truncate());
                        });
                    }
                    line.col(|ui| {
                        if row.kind.saved {
                            ui.label(skin.label(icons::FLOPPY_DISK)).on_hover_text(skin.say("hd_params.is_kept"));
                        }
                    });
                });
            });
    });
}

/// The value: to be edited where that can be.
fn value(ui: &mut Ui, skin: &Skin, unit: &Unit, row: &Row, view: &mut View, actions: &mut Vec<Action>) {
    let is_wrong = view.drafts.get(&row.number).is_some_and(|own| matches!(own, Some((_, Some(_)))));
    let ink = match (row.is_edited, row.changed_from) {
        _ if is_wrong => Some(skin.palette.bad),
        (true, _) => Some(skin.palette.staged),
        (false, Some(_)) => Some(skin.palette.accent),
        (false, None) => None,
    };
    if !row.is_editable {
        // A unit that is a part of another one is multiplied.
        let unit = words(skin, row.unit.as_ref());
        let times = if unit.starts_with('0') { "× " } else { "" };
        let mut text = skin.mono(format!("{} {times}{unit}", row.shown));
        if let Some(ink) = ink {
            text = text.color(ink);
        }
        let label = ui.add(egui::Label::new(text).truncate().selectable(true));
        if let Some(meaning) = &row.meaning {
            label.on_hover_text(skin.words(meaning));
        }
        return;
    }
    let label = format!("{} {}", row.number, skin.words(&row.name));
    let draft = view.drafts.entry(row.number).or_default();
    let shown = row.staged.map_or_else(|| row.shown.clone(), |staged| staged.to_string());
    if let Some(ink) = ink {
        ui.visuals_mut().override_text_color = Some(ink.into());
    }
    let response = settled_entry(ui, draft, &shown, ENTRY, &label, |text| {
        let edit = forms::parameter(row, text)?;
        actions.push(Action::Hiperdrive(unit.session.id, Hiperdrive::Edit(Box::new(edit))));
        Ok(())
    });
    ui.visuals_mut().override_text_color = None;
    if let Some((_, Some(why))) = draft {
        let why = skin.words(why);
        ui.label(RichText::new(icons::WARNING_CIRCLE).color(skin.palette.bad)).on_hover_text(&why);
        response.on_hover_text(why);
    } else {
        ui.label(skin.caption(words(skin, row.unit.as_ref())));
    }
}

/// What stands behind a name.
fn hint(skin: &Skin, row: &Row) -> String {
    let mut lines = vec![skin.words(&row.name)];
    lines.extend(row.meaning.as_ref().map(|meaning| skin.words(meaning)));
    let range = row.range.as_ref().map(|range| skin.words(range));
    lines.extend(range.map(|range| format!("{}: {range}", skin.say("hd_params.range"))));
    if !row.factory.is_empty() {
        lines.push(format!("{}: {}", skin.say("hd_params.factory"), row.factory));
    }
    if let Some(was) = row.changed_from {
        lines.push(skin.words(&Text::new("hd_params.was").with("value", was)));
    }
    lines.join("\n")
}

/// What there is of it.
fn words(skin: &Skin, text: Option<&Text>) -> String {
    text.map(|text| skin.words(text)).unwrap_or_default()
}
