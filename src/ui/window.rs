//! The window: header, navigation, panels, dialogs and keyboard. Implements the eframe application.

use std::time::Duration;

use egui::{Key, Modifiers, Panel, Ui};

use super::commands::{self, CommandEffect};
use super::device_view::TabViews;
use super::dialogs::{self, FileView, PaletteUiState};
use super::docks::Docks;
use super::input_order::DeferredInput;
use super::keys::KeyboardFilter;
use super::live_pace::LivePace;
use super::navigation::navigation_ui;
use super::page::with_stable_ids;
use super::widgets::{HoldButtonContext, set_hold_button_context};
use super::{Theme, Views, comparison, header, profile_library, review, status_line, stop_debounce};
use crate::app::{Action, AnyDevice, Studio, ThemeData};

pub struct Window {
    studio: Studio,
    views: Views,
    docks: Docks,
    keys: KeyboardFilter,
    held_input: DeferredInput,
    /// Whether a request to close the window has already been handled in this frame.
    close_heard: bool,
    look: &'static ThemeData,
    dressed: Option<crate::app::ColorScheme>,
    /// Displayed notice, and the time on the window's clock at which it appeared.
    notice_since: Option<(jiff::Zoned, f64)>,
    live_pace: LivePace,
    processor_time: fn() -> Option<Duration>,
}

impl Window {
    pub fn new(studio: Studio, look: &'static ThemeData, tabs: TabViews) -> Self {
        let docks = Docks::load(studio.settings.layout.as_deref());
        let views = Views::new(tabs);
        Window {
            studio,
            views,
            docks,
            keys: KeyboardFilter::new(),
            held_input: DeferredInput::default(),
            close_heard: false,
            look,
            dressed: None,
            notice_since: None,
            live_pace: LivePace::default(),
            processor_time: || None,
        }
    }

    /// Adapts the rate of live frames to the processor time used by the program, as returned by `processor_time`.
    #[must_use]
    pub(super) fn with_processor_time(self, processor_time: fn() -> Option<Duration>) -> Self {
        Window { processor_time, ..self }
    }

    pub fn studio(&self) -> &Studio {
        &self.studio
    }

    /// Splits the input of a frame so that typed text reaches the entry that was clicked just before it. Nothing is
    /// held back while drives are under control.
    pub fn split_input(&mut self, ctx: &egui::Context, input: &mut egui::RawInput) {
        let at_once = !input.focused || self.studio.has_control();
        if self.held_input.split_frame_events(&mut input.events, at_once) {
            ctx.request_repaint();
        }
    }

    pub fn draw(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.studio.poll();
        let mut actions = Vec::new();
        let theme = Theme::new(self.look, self.studio.settings.theme, self.studio.settings.language);
        self.handle_input(&ctx, &theme, &mut actions);
        let in_use = egui::Popup::is_any_open(&ctx) || ctx.dragged_id().is_some();
        if self.dressed.replace(self.studio.settings.theme) != Some(self.studio.settings.theme) {
            theme.apply_to(&ctx);
        }
        self.draw_panels(ui, &theme, &mut actions);
        self.dialogs_ui(&ctx, &theme, &mut actions);
        header::stop_overlay_ui(&ctx, &theme, &self.studio, &mut actions);
        self.handle_escape(&ctx, in_use, &mut actions);
        if !actions.is_empty() {
            // The effect of the actions must be drawn.
            ctx.request_repaint();
        }
        for action in actions {
            self.studio.handle_action(action);
        }
        if let Some(question) = self.studio.take_file_question() {
            dialogs::ask_for_file(question, &theme, self.studio.mailbox());
        }
        if let Some(question) = self.studio.take_path_question() {
            self.show_path_entry(question);
        }
        self.finish_frame(&ctx);
    }

    fn show_path_entry(&mut self, question: crate::app::FileQuestion) {
        self.views.file = Some(FileView::new(question, self.studio.folders()));
    }

    fn draw_panels(&mut self, ui: &mut Ui, theme: &Theme, actions: &mut Vec<Action>) {
        let flat = |fill: crate::app::Rgb| egui::Frame::NONE.fill(fill.into());
        let palette = theme.palette;
        let Window { studio, views, .. } = self;
        Panel::top("header")
            .exact_size(48.0)
            .frame(flat(palette.raised).inner_margin(egui::Margin::symmetric(12, 0)))
            .show(ui, |ui| header::header_ui(ui, theme, studio, views, actions));
        write_indicator_ui(ui, theme, studio);
        motion_indicator_ui(ui, theme, studio);
        self.status_line(ui, theme, actions);
        let Window { studio, views, docks, .. } = self;
        Panel::left("navigation")
            .exact_size(if ui.available_width() < 1000.0 { 148.0 } else { 158.0 })
            .frame(flat(palette.surface).inner_margin(8))
            .show(ui, |ui| {
                with_stable_ids(ui, "entries", |ui| navigation_ui(ui, theme, studio, views, docks, actions));
            });
        egui::CentralPanel::default().frame(flat(palette.surface)).show(ui, |ui| {
            docks.show(ui, theme, studio, views, actions);
        });
        if let Some(layout) = docks.take_changed_layout() {
            actions.push(Action::KeepLayout(layout));
        }
    }

    fn dialogs_ui(&mut self, ctx: &egui::Context, theme: &Theme, actions: &mut Vec<Action>) {
        if let Some(device) = self.studio.selected_device() {
            review::review_ui(ctx, theme, device, actions);
        }
        let forms = (self.views.tabs, &mut self.views.connect);
        dialogs::connect_ui(ctx, theme, &self.studio, forms, actions);
        dialogs::server_ui(ctx, theme, &self.studio, &mut self.views.server, actions);
        dialogs::company_ui(ctx, theme, &self.studio, &mut self.views.company, actions);
        profile_library::library_ui(ctx, theme, &self.studio, &mut self.views.library, actions);
        if let Some(file) = &mut self.views.file
            && dialogs::file_ui(ctx, theme, file, actions)
        {
            self.views.file = None;
        }
        if self.views.about && dialogs::about_ui(ctx, theme) {
            self.views.about = false;
        }
        if self.views.help
            && let Some(page) = self.views.page(&self.studio)
            && dialogs::help_ui(ctx, theme, (page.word, page.help))
        {
            self.views.help = false;
        }
        if let Some(mut palette) = self.views.palette.take() {
            let commands = commands::all_commands(theme, &self.studio, &self.views);
            match dialogs::palette_ui(ctx, theme, &mut palette, commands) {
                Some(effect) => self.execute_effect(effect, actions),
                None => self.views.palette = Some(palette),
            }
        }
        let pictures = (self.views.tabs, &mut self.views.compares_pictures);
        comparison::comparison_ui(ctx, theme, &self.studio, pictures, actions);
        dialogs::diverged_ui(ctx, theme, &self.studio, actions);
        dialogs::question_ui(ctx, theme, &self.studio, actions);
    }

    /// Draws the status line at the bottom, including the current notice. A notice that requires an action stays until
    /// it is dismissed, and other notices disappear after a while.
    fn status_line(&mut self, ui: &mut Ui, theme: &Theme, actions: &mut Vec<Action>) {
        status_line::status_line_ui(ui, theme, &self.studio, &mut self.views, actions);
        let Some(notice) = self.studio.services.log.current() else {
            self.notice_since = None;
            return;
        };
        let now = ui.input(|input| input.time);
        let since = match &self.notice_since {
            Some((at, since)) if *at == notice.at => *since,
            _ => now,
        };
        self.notice_since = Some((notice.at.clone(), since));
        match notice.severity.display_time(Duration::from_secs_f64(now - since)) {
            Some(Duration::ZERO) => actions.push(Action::Dismiss),
            Some(left) => ui.ctx().request_repaint_after(left),
            None => {}
        }
    }

    /// Handles requests to close the window even if nothing is drawn, as while it is minimised. Never prolongs a
    /// motion.
    pub fn logic(&mut self, ctx: &egui::Context) {
        self.handle_close_request(ctx);
        // The drawing of this frame must know about it.
        self.close_heard = true;
        // No frame contains the jog buttons of a minimised window.
        if self.studio.is_motion_active() && ctx.input(|input| input.raw.viewport().minimized == Some(true)) {
            self.studio.handle_action(Action::ReleaseMotion);
        }
        if !self.studio.is_closing() && !self.studio.drive_stop_handles().has_begun() {
            if ctx.input(|input| input.raw.viewport().minimized == Some(true)) {
                // Process samples and frames before too many accumulate.
                self.studio.poll();
            }
            return;
        }
        self.studio.poll();
        if self.studio.can_close() {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
        ctx.request_repaint_after(Duration::from_millis(30));
    }

    /// Handles a request to close the window. All motion is stopped before any question is asked.
    fn handle_close_request(&mut self, ctx: &egui::Context) {
        let (asked, minimised) = ctx.input(|input| {
            let viewport = input.raw.viewport();
            (viewport.close_requested(), viewport.minimized == Some(true))
        });
        if !asked || self.studio.can_close() {
            return;
        }
        ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
        self.studio.handle_action(Action::Close);
        if self.studio.question.is_some() && minimised {
            ctx.send_viewport_cmd(egui::ViewportCommand::Minimized(false));
            ctx.send_viewport_cmd(egui::ViewportCommand::Focus);
        }
    }

    fn handle_input(&mut self, ctx: &egui::Context, theme: &Theme, actions: &mut Vec<Action>) {
        if !std::mem::take(&mut self.close_heard) {
            self.handle_close_request(ctx);
        }
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        actions.extend(dropped.iter().map(|file| Action::Open(file.path().to_owned())));
        let (moves, asks) = (self.studio.is_requested_motion_running(), self.is_asking());
        if self.keys.filter_events(ctx, moves, asks) {
            actions.push(Action::StopMotion);
        }
        let pressed = |modifiers, key| ctx.input_mut(|input| input.consume_key(modifiers, key));
        if pressed(Modifiers::NONE, commands::HELP_KEY) {
            self.views.help = !self.views.help;
        }
        let covered = self.has_open_dialog() || self.views.help;
        set_hold_button_context(ctx, HoldButtonContext { covered, moving: self.studio.is_motion_active() });
        if covered || !ctx.input(|input| input.focused) {
            // The held button is not visible, or the release of its key will not be reported. The effect is already in
            // this frame. An action would request another frame each time.
            self.studio.handle_action(Action::ReleaseMotion);
        }
        if self.has_open_dialog() {
            return;
        }
        if pressed(Modifiers::COMMAND, Key::K) {
            self.views.palette = Some(PaletteUiState::default());
            return;
        }
        if !ctx.input(|input| input.events.iter().any(|event| matches!(event, egui::Event::Key { pressed: true, .. })))
        {
            return;
        }
        let typing = ctx.text_edit_focused();
        for command in commands::shortcut_commands(theme, &self.studio, &self.views) {
            let keys = command.shortcut.filter(|_| !typing || !command.yields_to_typing);
            if keys.is_some_and(|keys| pressed(keys.modifiers, keys.logical_key)) {
                self.execute_effect(command.effect, actions);
            }
        }
    }

    /// Executes a command that was chosen by its shortcut or in the command palette.
    fn execute_effect(&mut self, effect: CommandEffect, actions: &mut Vec<Action>) {
        let Window { studio, views, docks, .. } = self;
        match effect {
            CommandEffect::Act(action) => {
                if matches!(action, Action::ShowTab(_)) {
                    views.plot.restore_size();
                }
                actions.push(action);
            }
            CommandEffect::Page(session, page) => {
                if let Some(view) = studio.device(session).and_then(|device| views.session(device)) {
                    view.open(page);
                    views.plot.restore_size();
                    actions.push(Action::Select(session));
                }
            }
            CommandEffect::ToolPage(tab, page) => {
                if let Some(tool) = views.tool_pages(tab) {
                    tool.open(page);
                    views.plot.restore_size();
                    actions.push(Action::ShowTab(tab));
                }
            }
            CommandEffect::ToggleHelp => views.help = !views.help,
            CommandEffect::About => views.about = true,
            CommandEffect::ResetLayout => docks.reset(),
        }
    }

    /// Returns whether a dialog covers the window and has the keyboard focus.
    fn has_open_dialog(&self) -> bool {
        let dialog = self.views.file.is_some()
            || self.views.about
            || self.views.palette.is_some()
            || self.studio.comparison().is_some()
            || self.studio.profile_library().is_some();
        self.studio.connect.is_some() || self.studio.has_form() || self.is_asking() || dialog
    }

    fn is_asking(&self) -> bool {
        let asks = self.studio.question.is_some() || self.studio.diverged.is_some();
        asks || self.studio.selected_device().is_some_and(AnyDevice::is_reviewing)
    }

    /// Handles the Escape key: stops the running job, or else closes the open dialog or panel. A half-typed byte, an
    /// open menu or a drag in progress is cancelled first.
    fn handle_escape(&mut self, ctx: &egui::Context, in_use: bool, actions: &mut Vec<Action>) {
        // While this window moves a drive, Esc applies to the motion, even if something is open or dragged.
        let moves = self.studio.is_requested_motion_running();
        let press_began = stop_debounce::is_escape_pressed(ctx);
        let is_pressed = ctx.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape));
        if !is_pressed && press_began && moves {
            // With Ctrl or Alt, Esc closes nothing but still stops.
            stop_debounce::register_stop_press(ctx, true, ctx.input(|input| input.time));
            actions.push(Action::StopMotion);
        }
        if !is_pressed || (in_use || !press_began) && !moves {
            return;
        }
        let means_motion = stop_debounce::register_stop_press(ctx, moves, ctx.input(|input| input.time));
        // A held key stops only what has started since it was pressed. A further press within half a second also
        // applies to motion only. This includes a motion requested in this frame that has not begun.
        if !press_began || means_motion && !moves {
            actions.push(Action::StopMotion);
            return;
        }
        let views = &mut self.views;
        if !moves
            && !self.studio.is_working()
            && (views.palette.take().is_some()
                || views.file.take().is_some()
                || std::mem::take(&mut views.about)
                || std::mem::take(&mut views.help)
                || views.plot.restore_size())
        {
            return;
        }
        actions.push(Action::Escape);
    }

    fn finish_frame(&mut self, ctx: &egui::Context) {
        let size = ctx.content_rect().size();
        let size = (size.x.round() as u32, size.y.round() as u32);
        if self.studio.settings.size != Some(size) {
            self.studio.handle_action(Action::StoreWindowSize(size.0, size.1));
        }
        if self.studio.can_close() {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
        self.views.remove_closed_sessions(&self.studio);
        if self.studio.is_moving() {
            // These frames refresh any motion. It stops after 250 ms without a frame.
            ctx.request_repaint_after(Duration::from_millis(30));
        } else if self.studio.is_live() {
            ctx.request_repaint_after(
                self.live_pace.next(Duration::from_secs_f64(ctx.input(|input| input.time)), (self.processor_time)()),
            );
        }
    }
}

/// Draws a red edge on the header while a drive moves.
fn motion_indicator_ui(ui: &mut Ui, theme: &Theme, studio: &Studio) {
    if studio.is_moving() {
        let screen = ui.ctx().content_rect();
        let edge = egui::Rect::from_min_size(screen.min + egui::vec2(0.0, 45.0), egui::vec2(screen.width(), 3.0));
        ui.ctx().debug_painter().rect_filled(edge, 0.0, theme.palette.bad);
    }
}

/// Draws an animated bar along the top edge during a write.
fn write_indicator_ui(ui: &mut Ui, theme: &Theme, studio: &Studio) {
    if !studio.devices().iter().any(|device| device.is_writing()) {
        return;
    }
    let screen = ui.ctx().content_rect();
    let time = ui.input(|input| input.time);
    let width = screen.width() * 0.25;
    let left = screen.left() + (screen.width() + width) * (time as f32 * 0.6).fract() - width;
    let bar = egui::Rect::from_min_size(egui::pos2(left, screen.top()), egui::vec2(width, 3.0));
    ui.ctx().debug_painter().rect_filled(bar, 0.0, theme.palette.accent);
    ui.ctx().request_repaint_after(Duration::from_millis(33));
}
