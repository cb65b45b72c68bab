//! The register page: a list of banks and the register table.

use egui::{RichText, ScrollArea, Ui};

use crate::app::{Action, DeviceCommand, PendingEdits, Text};
use crate::devices::biss::protocol::{Access, Name, ValueDecoding};
use crate::devices::biss::state::explain;
use crate::devices::biss::state::{BissAction as Biss, Encoder, Group, RegisterEntry, TEXTS};
use crate::devices::biss::views::translate;
use crate::ui::controls::{dropdown, empty_placeholder, enabled_button, icon_menu};
use crate::ui::widgets::{
    RegisterBits, RegisterEvent, RegisterGroup, RegisterKind, RegisterLocation, RegisterRow, RegisterTable,
    RegisterView, register_table,
};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct RegistersUiState {
    table: RegisterView,
    folded: bool,
}

/// Width of the bank list in points. A page narrower than [`MIN_TWO_COLUMN_WIDTH`] has a drop-down list above the table
/// instead.
const BANK_LIST_WIDTH: f32 = 176.0;
const MIN_TWO_COLUMN_WIDTH: f32 = 840.0;

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut RegistersUiState,
    actions: &mut Vec<Action>,
) {
    if encoder.description.is_none() {
        let read = (icons::ARROW_CLOCKWISE, theme.translate("memory.read"), encoder.session.is_readable());
        if empty_placeholder(ui, theme, &translate(theme, "registers.nothing"), Some((read.0, &read.1, read.2))) {
            actions.push(Action::Command(encoder.session.id, DeviceCommand::Read));
        }
        return;
    }
    let groups: Vec<RegisterGroup> =
        encoder.table.groups().iter().map(|own| register_group(theme, encoder, own)).collect();
    if !std::mem::replace(&mut view.folded, true) {
        // Users usually look at one bank at a time, most often at the direct registers.
        (1..groups.len()).for_each(|at| view.table.set_folded(at, true));
    }
    let beside = ui.available_width() >= MIN_TWO_COLUMN_WIDTH;
    super::messages_ui(ui, theme, encoder, actions);
    header_ui(ui, theme, encoder, (&groups, beside), view, actions);
    ui.add_space(theme.space.inside);
    let height = ui.available_height();
    if !beside {
        table_ui(ui, theme, encoder, &groups, height, view, actions);
        return;
    }
    ui.horizontal_top(|ui| {
        ui.allocate_ui_with_layout(
            egui::vec2(BANK_LIST_WIDTH, height),
            egui::Layout::top_down(egui::Align::Min),
            |ui| {
                ui.set_min_width(BANK_LIST_WIDTH);
                bank_list_ui(ui, theme, encoder, &groups, view);
            },
        );
        ui.vertical(|ui| table_ui(ui, theme, encoder, &groups, height, view, actions));
    });
}

fn header_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    (groups, beside): (&[RegisterGroup], bool),
    view: &mut RegistersUiState,
    actions: &mut Vec<Action>,
) {
    let mut at = view.table.selected_group().unwrap_or_default();
    ui.horizontal(|ui| {
        if !beside {
            let label = translate(theme, "registers.bank");
            if dropdown(ui, &label, &mut at, groups.iter().map(|own| own.title.clone()).enumerate()) {
                view.table.select(RegisterLocation { group: at, row: 0 });
            }
        }
        if let Some(own) = encoder.table.groups().get(at) {
            let word = theme.format_text(&read_button_label(own.bank));
            if enabled_button(ui, encoder.session.is_ready(), icons::ARROW_CLOCKWISE, &word).clicked() {
                actions.push(Action::device(encoder.session.id, Biss::ReadBank(own.bank)));
            }
        }
        watch_selection_ui(ui, theme, encoder, view, actions);
        if let Some(problem) = view.table.problem(theme) {
            let words = format!("{} {problem}", icons::WARNING_CIRCLE);
            ui.add(egui::Label::new(RichText::new(words).color(theme.palette.bad)).truncate());
        } else if encoder.memory.is_dirty() {
            ui.add(egui::Label::new(theme.caption(translate(theme, "registers.edited"))).truncate());
        } else if !encoder.record.watched_registers().is_empty() && encoder.session.is_polling() {
            ui.add(egui::Label::new(theme.caption(translate(theme, "registers.watching"))).truncate());
        }
    });
}

fn read_button_label(bank: Option<u8>) -> Text {
    match bank {
        None => TEXTS.text("registers.read_direct"),
        Some(bank) => TEXTS.text("registers.read_bank").with("bank", format!("0x{bank:02X}")),
    }
}

fn watch_selection_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &RegistersUiState,
    actions: &mut Vec<Action>,
) {
    let selected = view.table.selected();
    let group = selected.and_then(|place| encoder.table.groups().get(place.group));
    let row = selected.zip(group).and_then(|(place, group)| group.rows().get(place.row));
    let watched = encoder.record.watched_registers();
    if let Some(row) = row {
        let on = watched.iter().any(|own| own.address == row.register.address);
        let word = TEXTS.text(if on { "registers.unwatch" } else { "registers.watch" });
        let word = theme.format_text(&word.with("address", row.register.address));
        let button = enabled_button(ui, row.register.access.is_readable() && !row.is_data, icons::EYE, &word);
        if button.on_hover_text(theme.format_text(&explain::name_text(&row.register.name))).clicked() {
            let register = Box::new(row.register.clone());
            actions.push(Action::device(encoder.session.id, Biss::Watch(register, !on)));
        }
    }
    if !watched.is_empty() {
        let word = theme.format_text(&TEXTS.text("registers.watched").with("count", watched.len()));
        icon_menu(ui, icons::LIST_CHECKS, &word, |ui| {
            ui.label(theme.heading(&word));
            for own in watched {
                let name = format!("{}  {}", own.address, theme.format_text(&explain::name_text(&own.name)));
                if ui.button(format!("{}  {name}", icons::X)).clicked() {
                    actions.push(Action::device(encoder.session.id, Biss::Watch(Box::new(own), false)));
                }
            }
        });
    }
}

fn bank_list_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, groups: &[RegisterGroup], view: &mut RegistersUiState) {
    let selected = view.table.selected_group();
    ScrollArea::vertical().id_salt("banks").auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for (at, own) in encoder.table.groups().iter().enumerate() {
            let title = groups.get(at).map(|group| group.title.clone()).unwrap_or_default();
            let ink = if own.is_read(&encoder.memory) { theme.palette.text } else { theme.palette.muted };
            let text = RichText::new(&title).color(ink);
            let button = egui::Button::selectable(selected == Some(at), (text, egui::Atom::grow()));
            let response = ui.add(button.truncate().min_size(egui::vec2(BANK_LIST_WIDTH - 16.0, 24.0)));
            if response.on_hover_text(&title).clicked() {
                view.table.select(RegisterLocation { group: at, row: 0 });
            }
        }
    });
}

fn table_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    groups: &[RegisterGroup],
    height: f32,
    view: &mut RegistersUiState,
    actions: &mut Vec<Action>,
) {
    let none = translate(theme, "registers.elsewhere");
    let row = |place: RegisterLocation| {
        let shown = encoder.table.groups().get(place.group).and_then(|own| own.entry(place.row, &encoder.memory));
        shown.map(|own| register_row(theme, encoder, &own, &none)).unwrap_or_default()
    };
    let label = theme.translate("page.registers");
    let widest = encoder.description.iter().flat_map(|own| own.registers()).map(|own| usize::from(own.width)).max();
    let kind = RegisterKind::Bytes { widest: widest.unwrap_or(1) };
    let table = RegisterTable { label: &label, groups, row: &row, kind };
    let mut typed = Vec::new();
    let output = register_table(ui, theme, &table, height, &mut view.table, &mut |place, text| {
        let byte = parse(text)?;
        typed.push((place, byte));
        Ok(())
    });
    let start = |place: RegisterLocation| {
        let row = encoder.table.groups().get(place.group)?.rows().get(place.row)?;
        Some(row.register.address)
    };
    for (place, byte) in typed {
        let put = start(place).map(|start| Biss::Put { start, bytes: vec![byte] });
        actions.extend(put.map(|put| Action::device(encoder.session.id, put)));
    }
    if let Some(RegisterEvent::Revert(place)) = output.event {
        let revert = start(place).map(|start| Biss::Revert { start, count: 1 });
        actions.extend(revert.map(|revert| Action::device(encoder.session.id, revert)));
    }
    // Visible registers are read once automatically if nothing else is running.
    let in_sight = encoder.table.groups().iter().enumerate().skip(output.groups.start).take(output.groups.len());
    let unread = |(at, own): &(usize, &Group)| !view.table.is_folded(*at) && encoder.should_read_bank(own);
    if let Some((_, own)) = in_sight.into_iter().find(unread) {
        actions.push(Action::device(encoder.session.id, Biss::ReadVisibleBank(own.bank)));
    }
}

fn register_group(theme: &Theme, encoder: &Encoder, own: &Group) -> RegisterGroup {
    let title = match (own.bank, &own.name) {
        (None, _) => translate(theme, "registers.direct"),
        (Some(bank), None) => format!("0x{bank:02X}"),
        (Some(bank), Some(name)) => format!("0x{bank:02X}  {}", theme.format_text(&explain::name_text(name))),
    };
    let note = if own.is_read(&encoder.memory) { String::new() } else { translate(theme, "registers.not_read") };
    RegisterGroup { title, note, rows: own.rows().len() }
}

fn register_row(theme: &Theme, encoder: &Encoder, shown: &RegisterEntry<'_>, elsewhere: &str) -> RegisterRow {
    let register = &shown.row.register;
    let name = if register.name.is_empty() {
        translate(theme, "registers.byte")
    } else {
        theme.format_text(&explain::name_text(&register.name))
    };
    // A code is not a physical quantity.
    let is_quantity = matches!(register.decoding, ValueDecoding::Number | ValueDecoding::Scaled { .. });
    RegisterRow {
        address: register.address.to_string(),
        name,
        value: shown.bytes.as_deref().map(crate::bits::hex).unwrap_or_default(),
        decimal: shown.to_number().filter(|_| is_quantity).map(|own| own.to_string()).unwrap_or_default(),
        meaning: encoder.describe_register(shown).map(|own| theme.format_text(&own)).unwrap_or_default(),
        access: match register.access {
            Access::R => "R",
            Access::W => "W",
            Access::Rw => "RW",
        }
        .to_owned(),
        default: crate::bits::hex(&register.default),
        differs: shown.differs_from_factory_default(),
        changed: shown.has_changed,
        edited: shown.is_edited,
        cost: (!register.saves.is_empty()).then(|| translate(theme, "registers.cost")),
        read_only: (!shown.row.is_data).then(|| elsewhere.to_owned()),
        fields: fields(theme, shown),
        ..RegisterRow::default()
    }
}

fn fields(theme: &Theme, shown: &RegisterEntry<'_>) -> Vec<RegisterBits> {
    let ValueDecoding::Bits(names) = &shown.row.register.decoding else { return Vec::new() };
    let number = shown.to_number();
    let bit = |(bit, name): &(u8, Name)| {
        let is_set = number.map(|number| number >> bit & 1 == 1);
        RegisterBits {
            bits: format!("b{bit}"),
            name: theme.format_text(&explain::name_text(name)),
            value: is_set.map(|set| u8::from(set).to_string()).unwrap_or_default(),
            meaning: is_set
                .map(|set| translate(theme, if set { "registers.set" } else { "registers.clear" }))
                .unwrap_or_default(),
            lit: is_set == Some(true),
        }
    };
    names.iter().map(bit).collect()
}

/// Parses a hexadecimal byte as shown in the table.
fn parse(text: &str) -> Result<u8, Text> {
    let digits = text.trim().trim_start_matches("0x").trim_end_matches(['h', 'H']);
    let byte = u8::from_str_radix(digits, 16).ok().filter(|_| !digits.starts_with('+'));
    byte.ok_or_else(|| TEXTS.text("registers.no_byte").with("text", text.trim()))
}
