//! The HIPERDRIVE tab: one page per task, with a bar above them that is always visible.

mod axis;
mod bar;
mod connect_form;
mod device;
mod errors;
mod figures;
mod jog;
mod leds;
mod live;
mod motion;
mod network;
pub(crate) mod outside;
mod parameters;
mod run;
mod scale;
mod state_machine;
mod travel;

use std::collections::BTreeMap;

use crate::devices::hiperdrive::state::TEXTS;

use egui::Ui;

use crate::app::{Action, AnyDevice, Rgb, Studio, Text};
use crate::devices::hiperdrive::protocol::DriveNumber;
use crate::devices::hiperdrive::state::{HiperdriveAction, HiperdriveDevice};
use crate::ui::device_view::{PageInfo, TabPage, TypedDeviceView};
use crate::ui::{NamedAction, Theme, backups, edit_bar, icons, page};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Page {
    #[default]
    Motion,
    Parameters,
    Axis,
    Diagnosis,
    Device,
    Backups,
}

impl TabPage for Page {
    const PAGES: &'static [(Self, PageInfo)] = &[
        (Page::Motion, PageInfo::new(icons::GAUGE, "page.motion", "help.hd_motion")),
        (Page::Parameters, PageInfo::new(icons::SLIDERS, "page.parameters", "help.hd_parameters")),
        (Page::Axis, PageInfo::new(icons::RULER, "page.axis", "help.hd_axis")),
        (Page::Diagnosis, PageInfo::new(icons::MAGNIFYING_GLASS, "page.diagnosis", "help.hd_diagnosis")),
        (Page::Device, PageInfo::new(icons::CPU, "page.device", "help.hd_device")),
        (Page::Backups, PageInfo::new(icons::CLOCK_COUNTER_CLOCKWISE, "page.backups", "help.backups")),
    ];
}

impl Page {
    fn has_edit_bar(self) -> bool {
        self == Page::Parameters
    }
}

#[derive(Default)]
pub(crate) struct HiperdriveUiState {
    drives: BTreeMap<DriveNumber, DriveEntries>,
    parameters: parameters::DriveParametersUiState,
    leds: leds::LedsUiState,
    network: network::NetworkUiState,
}

#[derive(Default)]
struct DriveEntries {
    motion: motion::MotionUiState,
    axis: axis::AxisUiState,
}

pub(crate) struct HiperdriveView;

impl TypedDeviceView for HiperdriveView {
    type Device = HiperdriveDevice;
    type Page = Page;
    type Memory = HiperdriveUiState;
    type ConnectForm = connect_form::HiperdriveConnectForm;

    const HAS_UNDO_KEYS: bool = true;

    fn serial_number(unit: &HiperdriveDevice) -> Option<&str> {
        unit.serial_number()
    }

    fn named_actions(theme: &Theme, unit: &HiperdriveDevice) -> Vec<NamedAction> {
        let own = |word, action| {
            NamedAction::new(theme, word, unit.session.is_ready(), Action::device(unit.session.id, action))
        };
        vec![own("check_card.run", HiperdriveAction::Check), own("palette.read_status", HiperdriveAction::ReadStatus)]
    }

    fn is_edited(unit: &HiperdriveDevice, page: Page) -> bool {
        page == Page::Parameters && unit.is_dirty()
    }

    fn page_ui(
        ui: &mut Ui,
        theme: &Theme,
        (studio, device): (&Studio, &AnyDevice),
        unit: &HiperdriveDevice,
        (page, view): (Page, &mut HiperdriveUiState),
        actions: &mut Vec<Action>,
    ) {
        let around = page::side_margin(ui, theme);
        let narrow = f32::from(around) < theme.space.around;
        let sides = |top, bottom| egui::Margin { left: around, right: around, top, bottom };
        let id = egui::Id::unique(unit.session.id);
        if unit.profile().is_none() {
            // The bar with STOP and its note stays in place while the rest scrolls.
            egui::Panel::top(id.with("hiperdrive_bar"))
                .frame(egui::Frame::NONE.inner_margin(sides(8, 8)))
                .show(ui, |ui| bar::bar_ui(ui, theme, studio, unit, actions));
        }
        if page.has_edit_bar() {
            egui::Panel::bottom(id.with("hiperdrive_foot"))
                .frame(egui::Frame::NONE.inner_margin(sides(0, 8)))
                .show_separator_line(false)
                .show(ui, |ui| edit_bar::edit_bar_ui(ui, theme, (studio, device), edit_bar::EditKind::Values, actions));
        }
        let drive = unit.drive();
        if page == Page::Parameters {
            // A table handles its own scrolling.
            let frame = egui::Frame::NONE.inner_margin(sides(if narrow { 8 } else { 16 }, 0));
            frame.show(ui, |ui| parameters::page_ui(ui, theme, unit, &mut view.parameters, actions));
            return;
        }
        page::scrollable_page(ui, theme, (unit.session.id, page.index()), |ui| match page {
            // Each drive has its own entries with their own undo history.
            Page::Motion => {
                let own = &mut view.drives.entry(drive).or_default().motion;
                ui.push_id(drive, |ui| motion::page_ui(ui, theme, unit, own, actions));
            }
            Page::Parameters => {}
            Page::Axis => {
                let own = &mut view.drives.entry(drive).or_default().axis;
                ui.push_id(drive, |ui| axis::page_ui(ui, theme, unit, own, actions));
            }
            Page::Diagnosis => {
                errors::cards_ui(ui, theme, unit, actions);
                theme.add_gap(ui);
                leds::cards_ui(ui, theme, &mut view.leds);
            }
            Page::Device => {
                device::cards_ui(ui, theme, unit, actions);
                theme.add_gap(ui);
                network::card_ui(ui, theme, unit, &mut view.network, actions);
            }
            Page::Backups => backups::page_ui(ui, theme, (studio, device), actions),
        });
    }

    fn value_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, ink: Rgb) {
        live::value_ui(ui, theme, unit, ink);
    }

    fn watch_menu(
        ui: &mut Ui,
        theme: &Theme,
        unit: &HiperdriveDevice,
        _view: &mut HiperdriveUiState,
        actions: &mut Vec<Action>,
    ) {
        live::watch_menu(ui, theme, unit, actions);
    }

    fn motion(unit: &HiperdriveDevice) -> Option<Text> {
        if !unit.is_moving() {
            return None;
        }
        let moving = unit.moving_drives();
        if unit.drives().len() < 2 || moving.is_empty() {
            return Some(TEXTS.text("shell.moving"));
        }
        let drives: Vec<String> = moving.into_iter().map(|drive| drive.get().to_string()).collect();
        Some(TEXTS.text("shell.moving_drives").with("drives", drives.join(", ")))
    }
}

/// Returns a message from this catalogue or the common one, in the window language.
pub(crate) fn translate(theme: &Theme, id: &'static str) -> String {
    theme.format_text(&TEXTS.text(id))
}
