//! The preview of a profile: its device, its origin and its first items.

use egui::{RichText, ScrollArea, Ui};

use crate::app::{
    ComparedGroup, ComparedRow, ComparedRows, ItemValue, LibraryEntry, ListedProfile, ProfileLibrary, Text,
};
use crate::bits::hex;
use crate::ui::Theme;
use crate::ui::backups::time;
use crate::ui::controls::{card, fill_width, paragraph, problem_ui, row};

/// Maximum number of items shown.
const ITEMS: usize = 12;
/// Maximum number of bytes shown of an item.
const BYTES: usize = 16;

pub(super) fn preview_ui(ui: &mut Ui, theme: &Theme, library: &ProfileLibrary, entry: &LibraryEntry) {
    ScrollArea::vertical().id_salt(entry.path()).auto_shrink(false).show(ui, |ui| {
        fill_width(ui);
        card(ui, theme, "report.profile", |ui| {
            row(ui, theme, &theme.translate("report.file"), entry.file_name());
            if let Some(profile) = entry.profile() {
                facts_ui(ui, theme, profile);
            }
            let folder = entry.path().parent().map(|folder| folder.display().to_string());
            row(ui, theme, &theme.translate("library.folder"), folder.unwrap_or_default());
            if let Some(problem) = entry.problem() {
                ui.add_space(theme.space.between);
                problem_ui(ui, theme, Some(problem.text()));
            }
        });
        let Some(preview) = library.preview() else { return };
        theme.add_gap(ui);
        card(ui, theme, "library.content", |ui| match preview {
            Ok(rows) => items_ui(ui, theme, rows),
            Err(why) => problem_ui(ui, theme, Some(why)),
        });
    });
}

fn facts_ui(ui: &mut Ui, theme: &Theme, profile: &ListedProfile) {
    let (subject, document) = (profile.subject(), profile.document());
    let saved = document.saved.as_ref().map(|saved| saved.parse().map_or_else(|_| saved.clone(), time));
    let facts = [
        ("library.device", Some(profile.bus().to_owned())),
        ("report.name", Some(subject.name.clone())),
        ("library.type", Some(subject.device_type.clone())),
        ("encoder_card.serial", Some(subject.serial_number.clone())),
        ("report.read_at", saved),
        ("report.note", document.note.clone()),
    ];
    for (label, value) in facts {
        if let Some(value) = value.filter(|value| !value.is_empty()) {
            row(ui, theme, &theme.translate(label), value);
        }
    }
}

/// Draws the groups with their number of items, and the first items.
fn items_ui(ui: &mut Ui, theme: &Theme, rows: &ComparedRows) {
    let total: usize = rows.groups.iter().map(|group| group.rows.len()).sum();
    if total == 0 {
        paragraph(ui, theme.label(theme.translate("library.no_items")));
        return;
    }
    let mut left = ITEMS;
    for ComparedGroup { title, rows } in &rows.groups {
        if let Some(title) = title {
            let text = Text::new("library.group").with_text("group", title.clone()).with("count", rows.len());
            ui.add_space(theme.space.inside);
            ui.label(RichText::new(theme.format_text(&text)).font(theme.bold_font(theme.sizes.body)));
        }
        for ComparedRow { name, left: value, .. } in rows.iter().take(left) {
            let value = value.as_ref().map(|value| value_text(theme, value)).unwrap_or_default();
            row(ui, theme, &theme.format_text(name), value);
        }
        left = left.saturating_sub(rows.len());
    }
    if total > ITEMS {
        let text = Text::new("library.first_items").with("count", ITEMS).with("total", total);
        ui.add_space(theme.space.between);
        paragraph(ui, theme.caption(theme.format_text(&text)));
    }
}

fn value_text(theme: &Theme, value: &ItemValue) -> RichText {
    match value {
        ItemValue::Text(text) => RichText::new(theme.format_text(text)),
        ItemValue::Bytes(bytes) => {
            let shown = hex(bytes.get(..BYTES).unwrap_or(bytes));
            theme.monospace(if bytes.len() > BYTES { format!("{shown} …") } else { shown })
        }
    }
}
