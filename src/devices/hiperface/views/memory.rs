//! The memory page: the map of data fields with their actions, the bytes of the selected field with their meaning, and
//! the bar for writing edits.

use egui::{RichText, Ui};

use crate::app::session::Phase;
use crate::app::{Action, AnyDevice, DeviceCommand, Studio, Text};
use crate::devices::hiperface::jobs::Change;
use crate::devices::hiperface::profile::{FieldImage, FieldRange};
use crate::devices::hiperface::protocol::{AccessCodeNumber, DataFieldStatus, FieldSize, FreeMemory};
use crate::devices::hiperface::state::explain;
use crate::devices::hiperface::state::{Encoder, HiperfaceAction as Hiperface, StagedEdits, TEXTS, forms, rules};
use crate::devices::hiperface::views::translate;
use crate::ui::controls::{button_with_reason, dropdown, empty_placeholder, name, paragraph};
use crate::ui::widgets::{
    FieldMap, HexAnnotation, HexEdit, HexModel, HexView, MapEvent, MapField, field_map, hex_editor, hex_lines,
    typed_view,
};
use crate::ui::{Theme, edit_bar, icons};

/// State of the memory page, such as the selected field and the entries.
pub(super) struct MemoryUiState {
    field: u8,
    free: bool,
    hex: HexView,
    size: FieldSize,
    code: AccessCodeNumber,
    code_required: bool,
}

impl Default for MemoryUiState {
    fn default() -> Self {
        let size = FieldSize::all().next();
        MemoryUiState {
            field: 0,
            free: false,
            hex: HexView::default(),
            size: size.unwrap_or(DataFieldStatus::from_byte(0).size()),
            code: AccessCodeNumber::ZERO,
            code_required: true,
        }
    }
}

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    (studio, device): (&Studio, &AnyDevice),
    encoder: &Encoder,
    view: &mut MemoryUiState,
    actions: &mut Vec<Action>,
) {
    let wanted = encoder.staged.edited_fields();
    let memory = encoder.identity.as_ref().and_then(|identity| identity.memory);
    if encoder.identity.is_none() {
        let read = (icons::ARROW_CLOCKWISE, theme.translate("memory.read"), encoder.session.is_readable());
        if empty_placeholder(ui, theme, &translate(theme, "memory.nothing"), Some((read.0, &read.1, read.2))) {
            actions.push(Action::Command(encoder.session.id, DeviceCommand::Read));
        }
        return;
    }
    egui::Panel::bottom("memory_foot").frame(egui::Frame::NONE).show_separator_line(false).show(ui, |ui| {
        edit_bar::edit_bar_ui(ui, theme, (studio, device), edit_bar::EditKind::Bytes, actions);
    });
    memory_map_ui(ui, theme, encoder, &wanted, memory, view, actions);
    ui.add_space(theme.space.between);
    let selected = wanted.iter().find(|field| field.number == view.field).filter(|_| !view.free);
    match (selected, memory) {
        (Some(field), _) => field_ui(ui, theme, encoder, field, memory, view, actions),
        (None, Some(memory)) => create_field_ui(ui, theme, encoder, memory, view, actions),
        (None, None) => {
            ui.label(theme.label(translate(theme, "memory.no_fields")));
        }
    }
}

fn memory_map_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    wanted: &[FieldImage],
    memory: Option<FreeMemory>,
    view: &mut MemoryUiState,
    actions: &mut Vec<Action>,
) {
    let fields: Vec<MapField> = wanted
        .iter()
        .map(|field| {
            let status = theme.format_text(&explain::field_status(field.status));
            let label = TEXTS.text("memory.field").with("number", field.number);
            MapField {
                number: field.number,
                blocks: usize::from(field.status.size().block_count()),
                label: theme.format_text(&label),
                caption: format!("{} B", field.status.size().bytes()),
                colour: usize::from(field.number),
                locked: !field.status.is_writable(),
                unreadable: field.bytes.is_none(),
                edited: encoder.staged.edited_bytes().any(|(number, ..)| number == field.number),
                tooltip: format!("{}\n{status}", theme.format_text(&label)),
            }
        })
        .collect();
    let free_blocks = memory.map_or(0, |memory| usize::from(memory.blocks));
    // If available, at least eight free blocks are drawn, because a field can have up to eight blocks.
    let taken: usize = fields.iter().map(|field| field.blocks).sum();
    let a_line = (ui.available_width() / 48.0) as usize;
    let shown_free = free_blocks.min(a_line.saturating_sub(taken).max(8));
    let selected = (!view.free).then_some(view.field);
    let free = theme.format_text(&TEXTS.text("memory.free").with("bytes", memory.map_or(0, FreeMemory::bytes)));
    let last = wanted.last().filter(|_| encoder.session.is_ready());
    let resize = last.zip(memory).map(|(last, memory)| {
        let largest = rules::largest_size(memory, last);
        1..=usize::from(largest.block_count())
    });
    let model = FieldMap {
        fields: &fields,
        free_blocks: shown_free,
        selected,
        free_label: &free,
        free_tooltip: &translate(theme, "memory.free_hint"),
        block_bytes: FieldSize::BLOCK,
        resize,
    };
    let event = field_map(ui, theme, &model);
    let sizes = fields.iter().map(|field| field.blocks * FieldSize::BLOCK).sum::<usize>();
    let id = if fields.len() == 1 { "memory.used_one" } else { "memory.used" };
    let used = TEXTS.text(id).with("fields", fields.len()).with("used", sizes);
    let words =
        if memory.is_some() { format!("{} · {free}", theme.format_text(&used)) } else { theme.format_text(&used) };
    ui.label(theme.caption(words));
    match event {
        Some(MapEvent::Select(number)) => {
            if number != view.field {
                view.hex = HexView::default();
            }
            view.field = number;
            view.free = false;
        }
        Some(MapEvent::SelectFree) => view.free = true,
        Some(MapEvent::ResizeLast { blocks }) => {
            let size = u8::try_from(blocks).ok().and_then(FieldSize::from_blocks);
            if let (Some(size), Some(last)) = (size, wanted.last()) {
                let change = Change::ResizeField { number: last.number, size };
                actions.push(Action::device(encoder.session.id, Hiperface::Plan(change)));
            }
        }
        None => {}
    }
}

fn field_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    field: &FieldImage,
    memory: Option<FreeMemory>,
    view: &mut MemoryUiState,
    actions: &mut Vec<Action>,
) {
    field_header_ui(ui, theme, encoder, field, memory, actions);
    let Some(bytes) = &field.bytes else {
        ui.add_space(theme.space.between);
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icons::KEY).color(theme.palette.warn));
            let why = encoder.edit_lock_reason(field);
            paragraph(ui, why.map(|why| theme.format_text(&why)).unwrap_or_default());
        });
        return;
    };
    let read_only = match encoder.session.phase {
        Phase::Offline => None,
        _ if encoder.session.is_writing() => Some(Text::new("session.busy")),
        _ => encoder.edit_lock_reason(field),
    };
    let device = encoder.field(field.number).and_then(|own| own.bytes.clone()).unwrap_or_default();
    let mounting = encoder.mounting_ranges(field.number);
    let marks: Vec<HexAnnotation> =
        mounting.iter().map(|(range, words)| HexAnnotation { range: range.clone(), words }).collect();
    let beside = ui.available_width() >= 820.0;
    let lines = hex_lines(ui.available_height(), beside);
    let model = HexModel { marks: &marks, read_only: read_only.as_ref(), lines, ..HexModel::new(&device, bytes) };
    let label = theme.format_text(&TEXTS.text("memory.bytes").with("number", field.number));
    let mut edits = Vec::new();
    if beside {
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| edits = hex_editor(ui, theme, &label, &model, &mut view.hex));
            ui.add_space(theme.space.between);
            ui.vertical(|ui| typed_view(ui, theme, view.hex.to_read(bytes)));
        });
    } else {
        egui::ScrollArea::vertical().id_salt("field").auto_shrink(false).show(ui, |ui| {
            // Leave room for the focus ring.
            ui.add_space(theme.space.inside);
            edits = hex_editor(ui, theme, &label, &model, &mut view.hex);
            if let [mark, ..] = marks.as_slice() {
                let text = TEXTS.text("memory.mounting").with("what", mark.words);
                ui.label(theme.caption(theme.format_text(&text)));
            }
            ui.add_space(theme.space.between);
            typed_view(ui, theme, view.hex.to_read(bytes));
        });
    }
    // The undo buttons of the edit bar move the cursor in the same way as the keyboard shortcuts.
    if actions.iter().any(|own| matches!(own, Action::Command(_, DeviceCommand::Undo | DeviceCommand::Redo))) {
        view.hex.move_to_change(bytes);
    }
    let number = field.number;
    let id = encoder.session.id;
    actions.extend(edits.into_iter().map(|edit| match edit {
        HexEdit::Put { address, bytes } => Action::device(id, Hiperface::Put { field: number, address, bytes }),
        HexEdit::Undo => Action::Command(id, DeviceCommand::Undo),
        HexEdit::Redo => Action::Command(id, DeviceCommand::Redo),
        HexEdit::Revert { range } => {
            Action::device(id, Hiperface::Revert(FieldRange::new(number, range.start, range.len())))
        }
    }));
}

/// Draws the heading of the selected field with its actions. A disabled action states why it is disabled.
fn field_header_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    field: &FieldImage,
    memory: Option<FreeMemory>,
    actions: &mut Vec<Action>,
) {
    let mut change = None;
    ui.horizontal(|ui| {
        ui.label(theme.heading(theme.format_text(&TEXTS.text("memory.field").with("number", field.number))));
        ui.label(theme.label(theme.format_text(&explain::field_status(field.status))));
    });
    let Some(memory) = memory else { return };
    ui.horizontal_wrapped(|ui| {
        let ready = || if encoder.session.is_ready() { Ok(()) } else { Err(Text::new("session.not_ready")) };
        let lock = field.status.is_writable();
        let (icon, word) =
            if lock { (icons::LOCK_SIMPLE, "memory.lock") } else { (icons::LOCK_SIMPLE_OPEN, "memory.unlock") };
        if button_with_reason(ui, theme, &ready().and_then(|()| rules::status(field)), icon, &translate(theme, word))
            .clicked()
        {
            change = Some(Change::LockField { number: field.number, lock });
        }
        code_menu_ui(ui, theme, &ready().and_then(|()| rules::status(field)), field, &mut change);
        let resizable = ready().and_then(|()| rules::check_resizable(memory, field));
        size_menu_ui(ui, theme, &resizable, memory, (field, &encoder.staged), &mut change);
        let deletable = ready().and_then(|()| rules::delete(memory, field, &encoder.staged));
        if button_with_reason(ui, theme, &deletable, icons::TRASH, &translate(theme, "memory.delete")).clicked() {
            change = Some(Change::DeleteField { number: field.number });
        }
    });
    actions.extend(change.map(|change| Action::device(encoder.session.id, Hiperface::Plan(change))));
}

fn code_menu_ui(
    ui: &mut Ui,
    theme: &Theme,
    allowed: &rules::ActionPermission,
    field: &FieldImage,
    change: &mut Option<Change>,
) {
    let word = translate(theme, "memory.code");
    ui.add_enabled_ui(allowed.is_ok(), |ui| {
        let menu = ui.menu_button(format!("{}  {word}", icons::KEY), |ui| {
            for code in AccessCodeNumber::all() {
                for required in [true, false] {
                    let id = if required { "memory.code_required" } else { "memory.code_free" };
                    let words = theme.format_text(&TEXTS.text(id).with("number", code));
                    let is_own = field.status.code() == code && field.status.code_required() == required;
                    if ui.selectable_label(is_own, words).clicked() {
                        let status = field.status.with_code(code, required);
                        *change = Some(Change::Redefine { number: field.number, status });
                        ui.close();
                    }
                }
            }
        });
        name(menu.response, allowed.is_ok(), &word);
    });
}

fn size_menu_ui(
    ui: &mut Ui,
    theme: &Theme,
    allowed: &rules::ActionPermission,
    memory: FreeMemory,
    (field, staged): (&FieldImage, &StagedEdits),
    change: &mut Option<Change>,
) {
    let word = translate(theme, "memory.resize");
    if allowed.is_err() {
        button_with_reason(ui, theme, allowed, icons::ARROWS_OUT_LINE_HORIZONTAL, &word);
        return;
    }
    let menu = ui.menu_button(format!("{}  {word}", icons::ARROWS_OUT_LINE_HORIZONTAL), |ui| {
        for size in FieldSize::all() {
            let allowed = rules::resize(memory, field, size, staged);
            let own = egui::Button::selectable(size == field.status.size(), format!("{} B", size.bytes()));
            let response = ui.add_enabled(allowed.is_ok(), own);
            let response = match &allowed {
                Ok(()) => response,
                Err(why) => response.on_disabled_hover_text(theme.format_text(why)),
            };
            if response.clicked() {
                *change = Some(Change::ResizeField { number: field.number, size });
                ui.close();
            }
        }
    });
    name(menu.response, true, &word);
}

fn create_field_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    memory: FreeMemory,
    view: &mut MemoryUiState,
    actions: &mut Vec<Action>,
) {
    ui.label(theme.heading(theme.format_text(&TEXTS.text("memory.create_title").with("number", memory.fields))));
    ui.label(theme.label(translate(theme, "memory.create_words")));
    ui.add_space(theme.space.inside);
    ui.horizontal_wrapped(|ui| {
        ui.label(theme.label(translate(theme, "memory.size")));
        let sizes = FieldSize::all().map(|size| (size, format!("{} B", size.bytes())));
        dropdown(ui, &translate(theme, "memory.size"), &mut view.size, sizes);
        ui.label(theme.label(translate(theme, "memory.code")));
        let codes = AccessCodeNumber::all().map(|code| (code, code.to_string()));
        dropdown(ui, &translate(theme, "memory.code"), &mut view.code, codes);
        ui.checkbox(&mut view.code_required, translate(theme, "memory.required"));
        let allowed = if encoder.session.is_ready() {
            rules::create(memory, view.size, view.code, view.code_required)
        } else {
            Err(Text::new("session.not_ready"))
        };
        if button_with_reason(ui, theme, &allowed, icons::PLUS, &translate(theme, "memory.create")).clicked() {
            let status = forms::new_field(view.size, view.code, view.code_required);
            let change = Change::CreateField { number: memory.fields, status };
            actions.push(Action::device(encoder.session.id, Hiperface::Plan(change)));
        }
    });
}
