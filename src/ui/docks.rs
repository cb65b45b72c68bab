//! The panels around the workspace: they can be docked and resized, and are restored. A layout that does not load is
//! replaced by the default.

use egui_tiles::{Container, SimplificationOptions, TileId, Tiles, Tree, UiResponse};
use serde::{Deserialize, Serialize};

use super::{Theme, Views, panels, workspace};
use crate::app::{Action, Studio};

/// A panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Pane {
    /// The content of the open tab.
    Workspace,
    /// Live values and their curve.
    Live,
    /// The trace panel.
    Trace,
    Jobs,
    Log,
}

impl Pane {
    const ALL: [Pane; 5] = [Pane::Workspace, Pane::Live, Pane::Trace, Pane::Jobs, Pane::Log];
}

/// The arrangement of the panels.
pub(super) struct Docks {
    tree: Tree<Pane>,
    edited: bool,
}

impl Docks {
    /// Loads the stored arrangement, or else the default.
    pub(super) fn load(layout: Option<&str>) -> Self {
        let tree = layout.and_then(|text| ron::from_str::<Tree<Pane>>(text).ok()).filter(is_complete);
        Docks { tree: tree.unwrap_or_else(first_layout), edited: false }
    }

    /// Returns the arrangement as text, if it has changed since the last call.
    pub(super) fn changed(&mut self) -> Option<String> {
        std::mem::take(&mut self.edited).then(|| ron::to_string(&self.tree).ok()).flatten()
    }

    pub(super) fn reset(&mut self) {
        self.tree = first_layout();
        self.edited = true;
    }

    pub(super) fn ui(
        &mut self,
        ui: &mut egui::Ui,
        theme: &Theme,
        studio: &Studio,
        views: &mut Views,
        actions: &mut Vec<Action>,
    ) {
        let mut behaviour = Behaviour { theme, studio, views, actions, edited: false };
        self.tree.ui(&mut behaviour, ui);
        self.edited |= behaviour.edited;
    }
}

/// Returns whether each panel is in it once.
fn is_complete(tree: &Tree<Pane>) -> bool {
    Pane::ALL.iter().all(|pane| {
        let same = |tile: &egui_tiles::Tile<Pane>| matches!(tile, egui_tiles::Tile::Pane(own) if own == pane);
        tree.tiles.tiles().filter(|tile| same(tile)).count() == 1
    })
}

fn first_layout() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let workspace = tiles.insert_pane(Pane::Workspace);
    let live = tiles.insert_pane(Pane::Live);
    let live = tiles.insert_tab_tile(vec![live]);
    let lower = [Pane::Trace, Pane::Jobs, Pane::Log].map(|pane| tiles.insert_pane(pane));
    let lower = tiles.insert_tab_tile(lower.to_vec());
    let upper = egui_tiles::Linear::new_binary(egui_tiles::LinearDir::Horizontal, [workspace, live], 0.7);
    let upper = tiles.insert_container(Container::Linear(upper));
    let root = egui_tiles::Linear::new_binary(egui_tiles::LinearDir::Vertical, [upper, lower], 0.78);
    let root = tiles.insert_container(Container::Linear(root));
    Tree::new(egui::Id::unique("docks"), root, tiles)
}

struct Behaviour<'a> {
    theme: &'a Theme,
    studio: &'a Studio,
    views: &'a mut Views,
    actions: &'a mut Vec<Action>,
    edited: bool,
}

impl egui_tiles::Behavior<Pane> for Behaviour<'_> {
    fn pane_ui(&mut self, ui: &mut egui::Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        let (theme, studio) = (self.theme, self.studio);
        let margin = if *pane == Pane::Workspace { 0 } else { 8 };
        let fill = if *pane == Pane::Workspace { theme.palette.surface } else { theme.palette.raised };
        ui.painter().rect_filled(ui.max_rect(), 0.0, fill);
        egui::Frame::NONE.inner_margin(margin).show(ui, |ui| match pane {
            Pane::Workspace => workspace::workspace_ui(ui, theme, studio, self.views, self.actions),
            Pane::Live => panels::live_ui(ui, theme, studio, self.views, self.actions),
            Pane::Trace => panels::trace_ui(ui, theme, studio, self.views),
            Pane::Jobs => panels::jobs_ui(ui, theme, studio),
            Pane::Log => panels::log_ui(ui, theme, studio),
        });
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> egui::WidgetText {
        self.theme
            .say(match pane {
                Pane::Workspace => "panel.workspace",
                Pane::Live => "panel.live",
                Pane::Trace => "panel.trace",
                Pane::Jobs => "panel.jobs",
                Pane::Log => "panel.log",
            })
            .into()
    }

    fn simplification_options(&self) -> SimplificationOptions {
        // A single panel keeps its tab, which shows its name and is used for dragging.
        SimplificationOptions { prune_single_child_tabs: false, ..SimplificationOptions::default() }
    }

    fn min_size(&self) -> f32 {
        120.0
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        4.0
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        28.0
    }

    fn tab_bar_color(&self, _visuals: &egui::Visuals) -> egui::Color32 {
        self.theme.palette.surface.into()
    }

    fn tab_bg_color(
        &self,
        _visuals: &egui::Visuals,
        _tiles: &Tiles<Pane>,
        _tile: TileId,
        state: &egui_tiles::TabState,
    ) -> egui::Color32 {
        if state.active { self.theme.palette.raised.into() } else { egui::Color32::TRANSPARENT }
    }

    fn tab_outline_stroke(
        &self,
        _visuals: &egui::Visuals,
        _tiles: &Tiles<Pane>,
        _tile: TileId,
        _state: &egui_tiles::TabState,
    ) -> egui::Stroke {
        egui::Stroke::NONE
    }

    fn tab_bar_hline_stroke(&self, _visuals: &egui::Visuals) -> egui::Stroke {
        egui::Stroke::new(1.0, self.theme.palette.line)
    }

    fn tab_text_color(
        &self,
        _visuals: &egui::Visuals,
        _tiles: &Tiles<Pane>,
        _tile: TileId,
        state: &egui_tiles::TabState,
    ) -> egui::Color32 {
        if state.active { self.theme.palette.text.into() } else { self.theme.palette.muted.into() }
    }

    fn on_edit(&mut self, _edit: egui_tiles::EditAction) {
        self.edited = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Settings;
    use crate::app::recorded::SETTINGS;

    /// Names of panels are stored in users' settings.
    #[test]
    fn panels_stand_as_recorded() {
        let layout = Settings::parse(SETTINGS).unwrap().layout.unwrap();
        let tree: Tree<Pane> = ron::from_str(&layout).unwrap();
        assert!(is_complete(&tree));
        let again: Tree<Pane> = ron::from_str(&ron::to_string(&tree).unwrap()).unwrap();
        assert_eq!(again, tree);
    }
}
