//! The selector for one side of the comparison, with a line of details below it.

use egui::{RichText, Ui, WidgetInfo};

use crate::app::session::{Phase, Source};
use crate::app::{Action, ComparisonAction, ComparisonSource, ComparisonView, Side, Studio, Text, entry_kind_text};
use crate::store::{Entry, EntryKind};
use crate::ui::Theme;
use crate::ui::backups::time;

/// Maximum number of characters shown for the changes of a logbook entry in the list.
const MAX_CHANGES: usize = 60;

/// Draws the list of sources with details of the selected one below it.
pub(super) fn side_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    (view, side): (&ComparisonView, Side),
    choices: &[ComparisonSource],
    actions: &mut Vec<Action>,
) {
    let name = theme.translate(match side {
        Side::Left => "comparison.left",
        Side::Right => "comparison.right",
    });
    let chosen = view.side(side).source();
    let shown = chosen.map_or_else(|| theme.translate("comparison.choose"), |own| label(theme, studio, own));
    let height = ui.ctx().content_rect().height() * 0.6;
    let list = egui::ComboBox::from_id_salt("source").selected_text(&shown).height(height).truncate();
    let response = list.width(ui.available_width()).show_ui(ui, |ui| {
        for heading in ["comparison.open_ones", "comparison.backups", "comparison.moments"] {
            let mut listed = choices.iter().filter(|own| section(own) == heading).peekable();
            if listed.peek().is_some() {
                ui.label(theme.caption(theme.translate(heading)));
            }
            for source in listed {
                if ui.selectable_label(chosen == Some(source), label(theme, studio, source)).clicked() {
                    actions.push(Action::Comparison(ComparisonAction::Choose(side, source.clone())));
                }
            }
        }
        ui.separator();
        if ui.selectable_label(false, theme.translate("comparison.file")).clicked() {
            actions.push(Action::Comparison(ComparisonAction::AskFile(side)));
        }
    });
    response.response.widget_info(|| {
        let mut info = WidgetInfo::labeled(egui::Role::ComboBox, true, &name);
        info.current_text_value = Some(shown.clone());
        info
    });
    facts_ui(ui, theme, studio, (view, side));
}

/// Draws one line: the reason why the side cannot be compared, its number of edits, or the origin of its values.
fn facts_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, (view, side): (&ComparisonView, Side)) {
    let side = view.side(side);
    let palette = theme.palette;
    let (words, colour) = if let Some(problem) = side.problem().first() {
        (theme.format_text(problem), palette.bad)
    } else if side.edit_count() > 0 {
        let id = if side.edit_count() == 1 { "comparison.edits_one" } else { "comparison.edits" };
        (theme.format_text(&Text::new(id).with("count", side.edit_count())), palette.staged)
    } else {
        let place = match side.source() {
            None => String::new(),
            Some(_) if side.document().is_none() => theme.translate("comparison.reading"),
            Some(ComparisonSource::Session(id)) => match studio.device(*id) {
                Some(device) if *device.phase() != Phase::Offline => theme.translate("comparison.as_read"),
                Some(device) if matches!(device.source(), Source::File { .. }) => device.data_source(),
                _ => String::new(),
            },
            Some(source) => source.path().map(|path| path.display().to_string()).unwrap_or_default(),
        };
        (place, palette.muted)
    };
    let line = RichText::new(&words).size(theme.sizes.caption).color(colour);
    ui.add(egui::Label::new(line).truncate());
}

/// Returns the heading under which a source is listed.
fn section(source: &ComparisonSource) -> &'static str {
    match source {
        ComparisonSource::Session(_) | ComparisonSource::File(_) => "comparison.open_ones",
        ComparisonSource::Backup(_) => "comparison.backups",
        ComparisonSource::Entry(_) => "comparison.moments",
    }
}

/// Returns the name of a source in the list.
fn label(theme: &Theme, studio: &Studio, source: &ComparisonSource) -> String {
    match source {
        ComparisonSource::Session(id) => studio.device(*id).map(|device| device.name()).unwrap_or_default(),
        ComparisonSource::File(path) => path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
        ComparisonSource::Backup(backup) => {
            theme.format_text(&Text::new("comparison.backup").with("time", time(backup.taken)))
        }
        ComparisonSource::Entry(entry) => entry_label(theme, studio, entry),
    }
}

fn entry_label(theme: &Theme, studio: &Studio, entry: &Entry) -> String {
    let changes = match (entry.kind, entry.backup.as_ref().and_then(|path| path.file_name())) {
        (EntryKind::Backup, Some(name)) => name.to_string_lossy().into_owned(),
        _ => theme.format_text(&studio.entry_text(entry)).replace('\n', " "),
    };
    let is_long = changes.chars().count() > MAX_CHANGES;
    let changes = changes.chars().take(MAX_CHANGES).chain(is_long.then_some('…')).collect::<String>();
    let text = Text::new("comparison.moment")
        .with("time", time(entry.at))
        .with_text("kind", Text::new(entry_kind_text(entry.kind)))
        .with("device", &entry.device.serial_number)
        .with("text", changes);
    theme.format_text(&text)
}
