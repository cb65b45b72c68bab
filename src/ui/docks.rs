//! The panels around the workspace. They can be docked and resized, and their layout is restored at the next start. If
//! the stored layout cannot be loaded, the default layout is used.

use egui_tiles::{Container, SimplificationOptions, Tile, TileId, Tiles, Tree, UiResponse};
use serde::{Deserialize, Serialize};

use super::{Theme, Views, panels, workspace};
use crate::app::{Action, LOGBOOK_TAB, Studio};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Pane {
    Workspace,
    Live,
    Trace,
    Jobs,
    Log,
}

/// Initial width of the Live panel, as a fraction of the row.
const LIVE_SHARE: f32 = 0.3;
/// Width in points of the Live panel without its plot.
const VALUES_WIDTH: f32 = 248.0;

impl Pane {
    const ALL: [Pane; 5] = [Pane::Workspace, Pane::Live, Pane::Trace, Pane::Jobs, Pane::Log];
    const LOWER_PANES: [Pane; 3] = [Pane::Trace, Pane::Jobs, Pane::Log];
}

pub(super) struct Docks {
    tree: Tree<Pane>,
    edited: bool,
    /// Whether the Live panel was drawn without its plot in the last frame, or `None` before the first frame.
    alone: Option<bool>,
    /// Width of the Live panel with its plot, as a fraction of the row.
    with_plot: f32,
}

impl Docks {
    /// Loads the stored layout, or creates the default layout if none is stored.
    pub(super) fn load(layout: Option<&str>) -> Self {
        let tree = layout.and_then(|text| ron::from_str::<Tree<Pane>>(text).ok()).filter(is_complete);
        Docks { tree: tree.unwrap_or_else(default_layout), edited: false, alone: None, with_plot: LIVE_SHARE }
    }

    /// Returns the serialized layout if it has changed since the last call.
    pub(super) fn take_changed_layout(&mut self) -> Option<String> {
        std::mem::take(&mut self.edited).then(|| ron::to_string(&self.tree).ok()).flatten()
    }

    pub(super) fn reset(&mut self) {
        self.tree = default_layout();
        self.edited = true;
    }

    pub(super) fn show(
        &mut self,
        ui: &mut egui::Ui,
        theme: &Theme,
        studio: &Studio,
        views: &mut Views,
        actions: &mut Vec<Action>,
    ) {
        self.resize_live_panel(studio.settings.values_alone, ui.available_width());
        let mut panes = if studio.settings.lower_open { Vec::new() } else { Pane::LOWER_PANES.to_vec() };
        if studio.settings.tab == LOGBOOK_TAB {
            panes.push(Pane::Live);
        }
        let hidden = self.tiles_with_only(&panes);
        hidden.iter().for_each(|tile| self.tree.set_visible(*tile, false));
        let mut behaviour = DockBehaviour { theme, studio, views, actions, edited: false };
        self.tree.ui(&mut behaviour, ui);
        self.edited |= behaviour.edited;
        // The stored layout contains all panels in their places.
        hidden.iter().for_each(|tile| self.tree.set_visible(*tile, true));
    }

    /// Resizes the Live panel when its plot appears or disappears. Without the plot, the panel is as wide as its
    /// values. With the plot, it regains its previous width.
    fn resize_live_panel(&mut self, alone: bool, width: f32) {
        if self.alone.replace(alone).is_none_or(|before| before == alone) {
            return;
        }
        let Some(mut tile) = self.tree.tiles.find_pane(&Pane::Live) else { return };
        while let Some(parent) = self.tree.tiles.parent_of(tile) {
            if let Some(Tile::Container(Container::Linear(row))) = self.tree.tiles.get_mut(parent)
                && row.dir == egui_tiles::LinearDir::Horizontal
            {
                let beside: f32 = row.children.iter().filter(|own| **own != tile).map(|own| row.shares[*own]).sum();
                let before = row.shares[tile] / (row.shares[tile] + beside);
                let part = if alone {
                    self.with_plot = before;
                    (VALUES_WIDTH / width.max(VALUES_WIDTH * 2.0)).min(before)
                } else {
                    self.with_plot
                };
                row.shares.set_share(tile, beside * part / (1.0 - part).max(0.1));
                self.edited = true;
                return;
            }
            tile = parent;
        }
    }

    /// Returns the tiles that contain only the given panes, wherever the user has dragged them.
    fn tiles_with_only(&self, panes: &[Pane]) -> Vec<TileId> {
        let mut tiles = Vec::new();
        if let Some(root) = self.tree.root() {
            self.collect_tiles(root, panes, &mut tiles);
        }
        tiles
    }

    /// Collects the outermost tiles at or below `tile` that contain only the given panes. A pane that shares a tab bar
    /// with another pane is left out.
    fn collect_tiles(&self, tile: TileId, panes: &[Pane], tiles: &mut Vec<TileId>) {
        if self.contains_only(tile, panes) {
            tiles.push(tile);
        } else if let Some(Container::Linear(_) | Container::Grid(_)) = self.tree.tiles.get_container(tile) {
            let children = self.tree.tiles.get_container(tile).map(Container::children_vec).unwrap_or_default();
            children.into_iter().for_each(|child| self.collect_tiles(child, panes, tiles));
        }
    }

    fn contains_only(&self, tile: TileId, panes: &[Pane]) -> bool {
        match self.tree.tiles.get(tile) {
            Some(Tile::Pane(pane)) => panes.contains(pane),
            Some(Tile::Container(container)) => container.children().all(|child| self.contains_only(*child, panes)),
            None => false,
        }
    }
}

/// Returns whether the tree contains each pane exactly once.
fn is_complete(tree: &Tree<Pane>) -> bool {
    Pane::ALL.iter().all(|pane| {
        let same = |tile: &Tile<Pane>| matches!(tile, Tile::Pane(own) if own == pane);
        tree.tiles.tiles().filter(|tile| same(tile)).count() == 1
    })
}

fn default_layout() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let workspace = tiles.insert_pane(Pane::Workspace);
    let live = tiles.insert_pane(Pane::Live);
    let live = tiles.insert_tab_tile(vec![live]);
    let lower = [Pane::Trace, Pane::Jobs, Pane::Log].map(|pane| tiles.insert_pane(pane));
    let lower = tiles.insert_tab_tile(lower.to_vec());
    let upper = egui_tiles::Linear::new_binary(egui_tiles::LinearDir::Horizontal, [workspace, live], 1.0 - LIVE_SHARE);
    let upper = tiles.insert_container(Container::Linear(upper));
    let root = egui_tiles::Linear::new_binary(egui_tiles::LinearDir::Vertical, [upper, lower], 0.7);
    let root = tiles.insert_container(Container::Linear(root));
    Tree::new(egui::Id::unique("docks"), root, tiles)
}

struct DockBehaviour<'a> {
    theme: &'a Theme,
    studio: &'a Studio,
    views: &'a mut Views,
    actions: &'a mut Vec<Action>,
    edited: bool,
}

impl egui_tiles::Behavior<Pane> for DockBehaviour<'_> {
    fn pane_ui(&mut self, ui: &mut egui::Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        let (theme, studio) = (self.theme, self.studio);
        let margin = if *pane == Pane::Workspace { 0 } else { 8 };
        let fill = if *pane == Pane::Workspace { theme.palette.surface } else { theme.palette.raised };
        ui.painter().rect_filled(ui.max_rect(), 0.0, fill);
        egui::Frame::NONE.inner_margin(margin).show(ui, |ui| match pane {
            Pane::Workspace => workspace::workspace_ui(ui, theme, studio, self.views, self.actions),
            Pane::Live => panels::live_ui(ui, theme, studio, self.views, self.actions),
            Pane::Trace => panels::trace_ui(ui, theme, studio, self.views, self.actions),
            Pane::Jobs => panels::jobs_ui(ui, theme, studio),
            Pane::Log => panels::log_ui(ui, theme, studio),
        });
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> egui::WidgetText {
        self.theme
            .translate(match pane {
                Pane::Workspace => "panel.workspace",
                Pane::Live => "panel.live",
                Pane::Trace => "panel.trace",
                Pane::Jobs => "panel.jobs",
                Pane::Log => "panel.log",
            })
            .into()
    }

    fn simplification_options(&self) -> SimplificationOptions {
        // A single panel keeps its tab, which shows its name and can be dragged.
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

    #[test]
    fn recorded_panel_layouts_load() {
        let layout = Settings::parse(SETTINGS).unwrap().layout.unwrap();
        let tree: Tree<Pane> = ron::from_str(&layout).unwrap();
        assert!(is_complete(&tree));
        let again: Tree<Pane> = ron::from_str(&ron::to_string(&tree).unwrap()).unwrap();
        assert_eq!(again, tree);
    }
}
