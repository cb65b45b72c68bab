//! The search page, which ranks and explains the layouts that fit the last frames read or the frames in a file. Layouts
//! that the frames cannot distinguish form a class, which states the motion that would distinguish them.

use egui::{RichText, Ui};

use super::frames;
use crate::app::{Action, Text};
use crate::devices::ssi::protocol::{FrameDescriptor, LayoutClass, LayoutProposal, Search, UncertaintyReason};
use crate::devices::ssi::state::explain;
use crate::devices::ssi::state::{Encoder, Origin, SearchState, SsiAction as Ssi, TEXTS, read_clocks};
use crate::devices::ssi::views::translate;
use crate::ui::controls::{
    card, card_with_trailing, committed_entry, enabled_button, entry, icon_button, paragraph, primary_button, row,
    show_error_below, spinner,
};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct FindUiState {
    clocks: Option<(String, Option<Text>)>,
    unfolded: Option<usize>,
}

/// Maximum number of classes shown. The others fit even worse.
const CLASSES: usize = 6;
/// Number of layouts of a class that are shown before it is expanded.
const MEMBERS: usize = 4;

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut FindUiState,
    actions: &mut Vec<Action>,
) {
    source(ui, theme, encoder, view, actions);
    theme.add_gap(ui);
    match &encoder.search {
        SearchState::Nothing => {}
        SearchState::Running(_) => {
            ui.horizontal(|ui| {
                spinner(ui, theme);
                ui.label(translate(theme, "ssi_find.running"));
            });
        }
        SearchState::Failed(why) => {
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(icons::X_CIRCLE).color(theme.palette.bad));
                paragraph(ui, theme.format_text(why));
            });
        }
        SearchState::Found { origin, clocks, left_out, frames, search } => {
            search_results_ui(ui, theme, encoder, view, (origin, *clocks, search), actions);
            if *left_out > 0 {
                let text = TEXTS.text("ssi_capture.left_out").with("count", left_out);
                ui.add_space(theme.space.between);
                paragraph(ui, theme.caption(theme.format_text(&text)));
            }
            theme.add_gap(ui);
            frames::card_ui(ui, theme, encoder, (*clocks, frames), actions);
        }
    }
}

fn source(ui: &mut Ui, theme: &Theme, encoder: &Encoder, view: &mut FindUiState, actions: &mut Vec<Action>) {
    let id = encoder.session.id;
    let mut ask = |action| actions.push(Action::device(id, action));
    card(ui, theme, TEXTS.text("ssi_find.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "ssi_find.words")));
        ui.add_space(theme.space.inside);
        let word = translate(theme, "ssi_find.clocks");
        entry(ui, theme, &word, |ui| {
            committed_entry(ui, &mut view.clocks, &encoder.clock_count().to_string(), 56.0, &word, |text| {
                ask(Ssi::SetClocks(Some(read_clocks(text)?)));
                Ok(())
            });
            if encoder.has_trial_clocks()
                && icon_button(ui, true, icons::ARROW_COUNTER_CLOCKWISE, &translate(theme, "ssi_find.own_clocks"))
                    .clicked()
            {
                view.clocks = None;
                ask(Ssi::SetClocks(None));
            }
        });
        show_error_below(ui, theme, view.clocks.as_ref().and_then(|(_, why)| why.as_ref()));
        let words = encoder.record.count(encoder.clock_count());
        row(ui, theme, &translate(theme, "ssi_find.read"), theme.monospace(words.to_string()));
        if !encoder.is_profile() && words == 0 {
            paragraph(ui, theme.caption(translate(theme, "ssi_find.poll")));
        }
        ui.add_space(theme.space.inside);
        ui.horizontal_wrapped(|ui| {
            if enabled_button(ui, true, icons::FOLDER_OPEN, &translate(theme, "ssi_find.file")).clicked() {
                ask(Ssi::AskFrames);
            }
            if enabled_button(ui, words > 0, icons::FLOPPY_DISK, &translate(theme, "ssi_find.save")).clicked() {
                ask(Ssi::AskSaveFrames);
            }
            let running = matches!(encoder.search, SearchState::Running(_));
            let find = primary_button(
                ui,
                theme,
                words > 0 && !running,
                icons::MAGNIFYING_GLASS,
                &translate(theme, "ssi_find.find"),
            );
            if find.on_disabled_hover_text(translate(theme, "ssi_find.poll")).clicked() {
                ask(Ssi::Find);
            }
        });
    });
}

fn search_results_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut FindUiState,
    (origin, clocks, search): (&Origin, u8, &Search),
    actions: &mut Vec<Action>,
) {
    let source = match origin {
        Origin::Live => TEXTS.text("ssi_find.of_live"),
        Origin::File(name) => TEXTS.text("ssi_find.of_file").with("name", name),
    };
    let text = TEXTS
        .text("ssi_find.frames")
        .with("frames", search.frames)
        .with("clocks", clocks)
        .with("different", search.different)
        .with_text("source", source);
    paragraph(ui, theme.label(theme.format_text(&text)));
    let (icon, colour) = match search.uncertainty {
        None => (icons::CHECK_CIRCLE, theme.palette.good),
        Some(UncertaintyReason::Open) => (icons::QUESTION, theme.palette.accent),
        Some(UncertaintyReason::Stuck { .. }) => (icons::X_CIRCLE, theme.palette.bad),
        Some(UncertaintyReason::Standing | UncertaintyReason::Nothing | UncertaintyReason::Close) => {
            (icons::WARNING, theme.palette.warn)
        }
    };
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icon).color(colour));
        paragraph(ui, theme.format_text(&explain::uncertainty_text(search.uncertainty)));
    });
    for (number, class) in search.classes.iter().take(CLASSES).enumerate() {
        ui.add_space(theme.space.between);
        ui.push_id(number, |ui| class_ui(ui, theme, encoder, (number, class), view, actions));
    }
}

fn class_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    (number, class): (usize, &LayoutClass),
    view: &mut FindUiState,
    actions: &mut Vec<Action>,
) {
    let id = encoder.session.id;
    let evidence = &class.evidence;
    let rank = TEXTS.text("ssi_find.rank").with("number", number + 1).with_number("bits", evidence.bits_per_frame, 2);
    let aside = |ui: &mut Ui| {
        ui.label(theme.caption(theme.format_text(&rank)));
    };
    card_with_trailing(
        ui,
        theme,
        TEXTS.text(if number == 0 { "ssi_find.best" } else { "ssi_find.other" }),
        aside,
        |ui| {
            let all = view.unfolded == Some(number);
            let shown = if all { class.members.len() } else { MEMBERS };
            for (place, proposal) in class.members.iter().take(shown).enumerate() {
                ui.horizontal(|ui| {
                    let word = translate(theme, "ssi_find.take");
                    let take = enabled_button(ui, true, icons::CHECK, &word);
                    if take.clicked() {
                        actions.push(Action::device(id, Ssi::Take(number, place)));
                    }
                    ui.vertical(|ui| {
                        ui.spacing_mut().item_spacing.y = theme.space.inside;
                        title_ui(ui, theme, encoder, proposal);
                        ui.add(
                            egui::Label::new(
                                theme.caption(theme.format_text(&explain::layout_summary(&proposal.layout))),
                            )
                            .wrap(),
                        );
                    });
                });
            }
            let more = class.members.len().saturating_sub(shown);
            if more > 0 {
                let text = TEXTS.text("ssi_find.more").with("count", more);
                if ui.link(theme.format_text(&text)).clicked() {
                    view.unfolded = Some(number);
                }
            }
            for open in &class.open {
                ui.horizontal_top(|ui| {
                    ui.label(RichText::new(icons::QUESTION).color(theme.palette.accent));
                    paragraph(ui, theme.format_text(&explain::open_question_text(*open)));
                });
            }
            paragraph(ui, theme.caption(theme.format_text(&explain::evidence_for(evidence))));
        },
    );
}

fn title_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, proposal: &LayoutProposal) {
    let Some((key, settings)) = &proposal.family else {
        ui.label(translate(theme, "ssi_find.any"));
        return;
    };
    let family = encoder.designer.families().find_by_key(key);
    // Swapped wires are not a setting, so they are ignored when the fewest settings are determined.
    let frame = FrameDescriptor { inverted: false, ..proposal.layout.descriptor().clone() };
    let fewest = family.and_then(|family| family.settings_for_frame(&frame));
    let name = family.map_or(key.as_str(), |family| family.name.as_str());
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(name).font(theme.bold_font(theme.sizes.body)));
        ui.label(theme.monospace(fewest.as_ref().unwrap_or(settings).emit(key)));
    });
}
