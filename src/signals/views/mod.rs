//! The Signals tab, with one page for each view of sine and cosine. It needs neither an encoder nor a session.

mod adapter;
mod error;
mod input_circuit;
mod nonlinearity;
mod numbers;
mod octant;
mod quality;
mod scope;
mod source;
mod synchronise;
mod table;
mod virtual_encoder;

use egui::Ui;

use crate::app::{Action, SineCosineSource, Studio, Text, ToolKind};
use crate::signals::state::input_circuit::Form as Circuit;
use crate::signals::state::{Signals, SignalsKind, TEXTS};
use crate::ui::device_view::{PageInfo, TabPage, ToolPages, ToolView, page_at, page_infos};
use crate::ui::{Theme, icons, page};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Page {
    Scope,
    /// Lissajous figure and measured values with their limits.
    #[default]
    Quality,
    Error,
    Synchronise,
    InputCircuit,
}

impl TabPage for Page {
    const PAGES: &'static [(Self, PageInfo)] = &[
        (Page::Scope, PageInfo::new(icons::WAVE_SINE, "page.scope", "help.scope")),
        (Page::Quality, PageInfo::new(icons::TARGET, "page.quality", "help.quality")),
        (Page::Error, PageInfo::new(icons::CHART_LINE, "page.error", "help.error")),
        (Page::Synchronise, PageInfo::new(icons::CROSSHAIR, "page.synchronise", "help.synchronise")),
        (Page::InputCircuit, PageInfo::new(icons::SLIDERS, "page.input_circuit", "help.input_circuit")),
    ];
}

/// Typed text that has not taken effect yet, and the reason if it is invalid.
type Draft = Option<(String, Option<Text>)>;

#[derive(Default)]
pub(crate) struct SignalsUiState {
    page: Page,
    source: source::SourceUiState,
    periods: Draft,
    corrected: bool,
    pictures: [quality::LissajousTexture; 2],
    octant: octant::OctantUiState,
    scope: scope::ScopeUiState,
    input_circuit: Circuit,
}

pub(crate) struct SignalsView;

impl ToolView for SignalsView {
    fn kind(&self) -> &'static dyn ToolKind {
        &SignalsKind
    }

    fn title(&self) -> &'static str {
        "tab.signals"
    }

    fn pages(&self) -> Vec<PageInfo> {
        page_infos::<Page>()
    }

    fn create_pages(&self) -> Box<dyn ToolPages> {
        Box::new(SignalsUiState::default())
    }
}

impl ToolPages for SignalsUiState {
    fn page(&self) -> usize {
        self.page.index()
    }

    fn open(&mut self, page: usize) {
        self.page = page_at(page).unwrap_or(self.page);
    }

    fn page_ui(&mut self, ui: &mut Ui, theme: &Theme, studio: &Studio, actions: &mut Vec<Action>) {
        if let Some(signals) = studio.tool_as() {
            page_ui(ui, theme, signals, studio.sine_cosine(), self, actions);
        }
    }
}

fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    signals: &Signals,
    device: Option<&dyn SineCosineSource>,
    view: &mut SignalsUiState,
    actions: &mut Vec<Action>,
) {
    page::scrollable_page(ui, theme, view.page.index(), |ui| match view.page {
        Page::Scope => {
            if source::source_ui(ui, theme, signals, &mut view.source, actions) {
                scope::page_ui(ui, theme, signals, view, actions);
            }
        }
        Page::Quality => {
            if source::source_ui(ui, theme, signals, &mut view.source, actions) {
                quality::page_ui(ui, theme, signals, view, actions);
            }
        }
        Page::Error => {
            if source::source_ui(ui, theme, signals, &mut view.source, actions) {
                error::page_ui(ui, theme, signals, view, actions);
            }
        }
        Page::Synchronise => {
            source::problem_ui(ui, theme, signals);
            synchronise::page_ui(ui, theme, signals, device, actions);
        }
        Page::InputCircuit => {
            source::problem_ui(ui, theme, signals);
            input_circuit::page_ui(ui, theme, &mut view.input_circuit);
        }
    });
}

/// Returns a message in the window's language, from the catalogue of the Signals tab or the common one.
pub(crate) fn translate(theme: &Theme, id: &'static str) -> String {
    theme.format_text(&TEXTS.text(id))
}
