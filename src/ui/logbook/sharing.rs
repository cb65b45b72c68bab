//! The line below the entries, which shows the sharing status, or the damaged file whose entries are missing.

use egui::{RichText, Ui};

use crate::app::{Action, ServerAction, Studio, Text, explain};
use crate::ui::controls::{labelled_button, message_label, right_aligned};
use crate::ui::{Theme, icons};

/// Height of the line in points.
pub(super) const HEIGHT: f32 = 32.0;

pub(super) fn sharing_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, actions: &mut Vec<Action>) {
    right_aligned(ui, |ui| {
        if labelled_button(ui, icons::PLUGS_CONNECTED, &theme.translate("logbook.share")).clicked() {
            actions.push(Action::Server(ServerAction::Open));
        }
        ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
            let (icon, ink, text) = state(theme, studio);
            ui.label(RichText::new(icon).color(ink));
            message_label(ui, theme, theme.format_text(&text), ink.into());
        });
    });
}

/// Returns the icon, colour and text of the sharing state. A damaged file takes precedence over an unreachable server.
fn state(theme: &Theme, studio: &Studio) -> (&'static str, crate::app::Rgb, Text) {
    let palette = theme.palette;
    let matches = studio.logbook().matches().and_then(|matches| matches.as_ref().ok());
    if let Some(kept) = matches.and_then(|matches| matches.damaged.as_ref()) {
        let text = Text::new("logbook.lacks_damaged").with("kept", kept.display());
        return (icons::WARNING, palette.warn, text);
    }
    let Some(exchange) = studio.server_exchange() else {
        return (icons::INFO, palette.muted, Text::new("logbook.local"));
    };
    match &exchange.contact.problem {
        Some(problem) => (
            icons::WARNING,
            palette.warn,
            unreachable_server_notice(exchange.waiting, explain::server_error_text(problem)),
        ),
        None if !exchange.contact.is_reached => {
            (icons::ARROWS_CLOCKWISE, palette.muted, Text::new("logbook.connecting"))
        }
        None if exchange.waiting > 0 => {
            (icons::ARROWS_CLOCKWISE, palette.muted, Text::new("logbook.sending").with("count", exchange.waiting))
        }
        None => (icons::CHECK_CIRCLE, palette.good, Text::new("logbook.shared")),
    }
}

fn unreachable_server_notice(waiting: u64, problem: Text) -> Text {
    match waiting {
        0 => problem,
        count => Text::new("logbook.away").with_text("problem", problem).with("count", count),
    }
}
