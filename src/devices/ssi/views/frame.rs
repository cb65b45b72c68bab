//! The frame page: family, bit strip, all settings, and a trial frame.

use egui::{RichText, Ui};

use super::SsiUiState as Tab;
use super::form::rows_ui;
use super::trial;
use crate::app::{Action, AnyDevice, DeviceCommand, DeviceModel, PendingEdits, Studio, Text};
use crate::devices::ssi::protocol::Family;
use crate::devices::ssi::state::explain;
use crate::devices::ssi::state::strip::{self, Strip};
use crate::devices::ssi::state::{Edit, Encoder, Group, SsiAction as Ssi, TEXTS, TrialInput};
use crate::devices::ssi::views::translate;
use crate::devices::ssi::views::widgets::{BitStrip, StripEvent, bit_strip};
use crate::ui::controls::{
    card_with_trailing, committed_entry, dropdown, enabled_button, folding_card, icon_button, labelled_button, name,
    paragraph, primary_button, show_error_below, two_columns,
};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct FrameUiState {
    selected: Option<u8>,
    format: String,
    named: Option<(String, Option<Text>)>,
}

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    (studio, device): (&Studio, &AnyDevice),
    encoder: &Encoder,
    view: &mut Tab,
    actions: &mut Vec<Action>,
) {
    layout_ui(ui, theme, encoder, &mut view.frame, actions);
    theme.add_gap(ui);
    let form = encoder.designer.form_groups();
    let (left, right) = columns(&form);
    two_columns(
        ui,
        theme,
        (view, &mut *actions),
        |ui, (view, actions)| {
            trial::card_ui(ui, theme, encoder, &mut view.trial, actions);
            for group in right {
                theme.add_gap(ui);
                group_ui(ui, theme, encoder, group, view, actions);
            }
        },
        |ui, (view, actions)| {
            for (number, group) in left.iter().enumerate() {
                if number > 0 {
                    theme.add_gap(ui);
                }
                group_ui(ui, theme, encoder, group, view, actions);
            }
        },
    );
    theme.add_gap(ui);
    buttons_ui(ui, theme, studio, device, encoder, actions);
}

/// Divides the form into the groups beside the trial frame and the groups below it.
fn columns(form: &[Group]) -> (&[Group], &[Group]) {
    form.split_at(form.len().min(2))
}

fn layout_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, view: &mut FrameUiState, actions: &mut Vec<Action>) {
    let designer = &encoder.designer;
    let id = encoder.session.id;
    let aside = |ui: &mut Ui| {
        if icon_button(ui, encoder.designer.can_redo(), icons::ARROW_U_UP_RIGHT, &theme.translate("memory.redo"))
            .clicked()
        {
            actions.push(Action::Command(id, DeviceCommand::Redo));
        }
        if icon_button(ui, encoder.designer.can_undo(), icons::ARROW_U_UP_LEFT, &theme.translate("memory.undo"))
            .clicked()
        {
            actions.push(Action::Command(id, DeviceCommand::Undo));
        }
    };
    let mut asked = Vec::new();
    card_with_trailing(ui, theme, TEXTS.text("ssi_layout.title"), aside, |ui| {
        family(ui, theme, encoder, view, &mut asked);
        ui.add_space(theme.space.between);
        strip_ui(ui, theme, encoder, view, &mut asked);
        if encoder.link_for_layout().is_some() {
            ui.horizontal_wrapped(|ui| {
                ui.label(RichText::new(icons::INFO).color(theme.palette.accent));
                ui.label(translate(theme, "ssi_layout.sends_other"));
                if labelled_button(ui, icons::PLAY, &translate(theme, "ssi_layout.send")).clicked() {
                    asked.push(Action::device(id, Ssi::SendLayout));
                }
            });
        }
        show_error_below(ui, theme, designer.problem());
        for advice in &designer.design().advice {
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(icons::INFO).color(theme.palette.accent));
                paragraph(ui, theme.caption(theme.format_text(&explain::advice_text(advice))));
            });
        }
        if designer.layout().loses_lowest_bit() {
            paragraph(ui, RichText::new(translate(theme, "ssi_layout.loses")).color(theme.palette.warn));
        }
    });
    actions.append(&mut asked);
}

fn family(ui: &mut Ui, theme: &Theme, encoder: &Encoder, view: &mut FrameUiState, actions: &mut Vec<Action>) {
    let designer = &encoder.designer;
    let id = encoder.session.id;
    let edit = |edit| Action::device(id, Ssi::Edit(Box::new(edit)));
    let families: Vec<&Family> = designer.families().iter().collect();
    let own = designer.family().and_then(|own| families.iter().position(|family| family.key == own.key));
    let mut chosen = own;
    ui.horizontal_wrapped(|ui| {
        let word = translate(theme, "ssi_layout.family");
        ui.label(theme.label(&word));
        let all = families.iter().enumerate().map(|(at, family)| (Some(at), family.name.clone()));
        let free = std::iter::once((None, translate(theme, "ssi_layout.free")));
        if dropdown(ui, &word, &mut chosen, free.chain(all)) {
            let key = chosen.and_then(|at| families.get(at)).map(|family| family.key.clone());
            actions.push(edit(key.map_or(Edit::Free, Edit::Family)));
        }
        let word = translate(theme, "ssi_layout.name");
        let profile = &designer.design().profile;
        ui.label(theme.label(&word));
        committed_entry(ui, &mut view.named, &profile.name, 160.0, &word, |text| {
            actions.push(edit(Edit::Name(text.trim().to_owned())));
            Ok(())
        });
        ui.menu_button(format!("{}  {}", icons::DOWNLOAD_SIMPLE, translate(theme, "ssi_layout.import")), |ui| {
            ui.set_width(320.0);
            paragraph(ui, theme.caption(translate(theme, "ssi_layout.import_words")));
            if labelled_button(ui, icons::PLUS, &translate(theme, "ssi.new_layout")).clicked() {
                actions.push(Action::New(Encoder::TAB));
                ui.close();
            }
            if labelled_button(ui, icons::FOLDER_OPEN, &theme.translate("profile_card.open")).clicked() {
                actions.push(Action::AskOpen);
                ui.close();
            }
            ui.separator();
            let word = translate(theme, "ssi_layout.linuxcnc");
            ui.label(theme.label(&word));
            crate::ui::controls::mono_entry(ui, theme, &mut view.format, 300.0, &word, "error%1bposition%24ge");
            if enabled_button(ui, !view.format.trim().is_empty(), icons::CHECK, &translate(theme, "ssi_layout.take"))
                .clicked()
            {
                actions.push(edit(Edit::LinuxCnc(view.format.trim().to_owned())));
                ui.close();
            }
        });
    });
    match designer.family() {
        Some(family) if designer.design().settings.is_none() => {
            ui.horizontal_wrapped(|ui| {
                let text = TEXTS.text("ssi_layout.by_hand").with("family", &family.name);
                ui.label(RichText::new(icons::WARNING).color(theme.palette.warn));
                ui.label(theme.format_text(&text));
                if labelled_button(ui, icons::ARROW_COUNTER_CLOCKWISE, &translate(theme, "ssi_layout.delivered"))
                    .clicked()
                {
                    actions.push(edit(Edit::Family(family.key.clone())));
                }
            });
        }
        Some(family) => {
            paragraph(ui, theme.caption(theme.format_text(&explain::note_text(family, &family.source))));
        }
        None => paragraph(ui, theme.caption(translate(theme, "ssi_layout.free_words"))),
    }
}

fn strip_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, view: &mut FrameUiState, actions: &mut Vec<Action>) {
    let layout = encoder.designer.layout();
    let id = encoder.session.id;
    let strip = Strip::from_layout(layout);
    let label = translate(theme, "ssi_layout.title");
    let selected = view.selected.filter(|clock| *clock <= layout.clock_count());
    let model = BitStrip {
        label: &label,
        strip: &strip,
        frame: Some(encoder.displayed_frame().frame),
        selected,
        toggles: true,
        movable: true,
        following: encoder.designer.error_bits_follow_position(),
    };
    match bit_strip(ui, theme, &model) {
        Some(StripEvent::Moved(handle, to)) => actions.push(Action::device(id, Ssi::Move(handle, to))),
        Some(StripEvent::Selected(clock)) => view.selected = Some(clock),
        Some(StripEvent::Toggled(clock)) => {
            view.selected = Some(clock);
            actions.push(Action::device(id, Ssi::Try(TrialInput::Toggle(clock))));
        }
        // The strip itself shows the resulting frame.
        Some(StripEvent::Preview(..)) | None => {}
    }
    let words = match selected {
        Some(clock) => theme.format_text(&strip::cell_text(&strip, clock)),
        None => translate(theme, "ssi_layout.hint"),
    };
    paragraph(ui, theme.caption(words));
}

fn group_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, group: &Group, view: &mut Tab, actions: &mut Vec<Action>) {
    let id = encoder.session.id;
    let error = group.error();
    let mut asked = None;
    let aside = |ui: &mut Ui| {
        if let Some(index) = error
            && icon_button(ui, true, icons::TRASH, &translate(theme, "ssi_form.remove_error")).clicked()
        {
            asked = Some(Ssi::RemoveErrorBit(index));
        }
    };
    ui.push_id(error, |ui| {
        let content = |ui: &mut Ui| {
            rows_ui(ui, theme, encoder, &group.rows, &mut view.form, actions);
            if group.accepts_error_bits()
                && enabled_button(
                    ui,
                    encoder.designer.with_error_bit().is_some(),
                    icons::PLUS,
                    &translate(theme, "ssi_form.add_error"),
                )
                .clicked()
            {
                actions.push(Action::device(id, Ssi::AddErrorBit));
            }
        };
        let title = TEXTS.text(group.title);
        if group.is_foldable() {
            folding_card(ui, theme, title, content);
        } else {
            card_with_trailing(ui, theme, title, aside, content);
        }
    });
    actions.extend(asked.map(|asked| Action::device(id, asked)));
}

fn buttons_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    device: &AnyDevice,
    encoder: &Encoder,
    actions: &mut Vec<Action>,
) {
    let is_dirty = encoder.is_dirty();
    ui.horizontal(|ui| {
        if enabled_button(ui, is_dirty, icons::ARROW_COUNTER_CLOCKWISE, &theme.translate("memory.revert")).clicked() {
            actions.push(device.command(DeviceCommand::RevertAll));
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if primary_button(ui, theme, true, icons::FLOPPY_DISK, &theme.translate("profile_card.save")).clicked() {
                actions.push(Action::Save(device.id()));
            }
            adopt_for_device_ui(ui, theme, studio, device, actions);
            if is_dirty {
                let words = RichText::new(translate(theme, "ssi_layout.unsaved")).color(theme.palette.staged);
                ui.add(egui::Label::new(words).truncate());
            }
        });
    });
}

fn adopt_for_device_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, device: &AnyDevice, actions: &mut Vec<Action>) {
    let own = |other: &&AnyDevice| other.tab() == device.tab() && other.is_connected() && other.id() != device.id();
    let targets: Vec<&AnyDevice> = studio.devices().iter().map(Box::as_ref).filter(own).collect();
    if targets.is_empty() {
        return;
    }
    let word = translate(theme, "ssi_layout.take_for");
    let menu = ui.menu_button(format!("{}  {word}", icons::PLUGS_CONNECTED), |ui| {
        for target in targets {
            if ui.button(format!("{} · {}", target.name(), target.data_source())).clicked() {
                actions.push(device.command(DeviceCommand::WriteInto(target.id())));
                ui.close();
            }
        }
    });
    name(menu.response, true, &word).on_hover_text(translate(theme, "ssi_layout.take_for_hint"));
}
