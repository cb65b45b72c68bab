//! Test support: the real window, operated through its accessible labels, which are looked up in the text catalogues.

use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use std::time::{Duration, Instant};

use egui::{Key, Role, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};
use encoder_studio::app::connect::ConnectAction as Connect;
use encoder_studio::app::{Action, Language, Studio, Tab, Text, ThemeData};
use encoder_studio::devices::hiperface::state::{Encoder, HiperfaceAction as Hiperface};
use encoder_studio::kinds::program;
use encoder_studio::link::LinkUrl;
use encoder_studio::ui::{Window, install_fonts};

use crate::support::{LONG, Outside, asks_for_drive, log, only_master};
use crate::texts;

/// The window as the program displays it.
pub(crate) struct Shown(Window);

impl eframe::App for Shown {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.0.draw(ui);
    }
}

pub(crate) struct Screen {
    pub(crate) harness: Harness<'static, Shown>,
    pub(crate) outside: Outside,
}

impl Screen {
    /// Opens a window that connects to this link, or to the virtual encoder if none is given.
    pub(crate) fn opened(outside: Outside, link: Option<&str>, size: [f32; 2]) -> Self {
        let mut studio = outside.studio();
        studio.start_with(link.map(|link| link.parse::<LinkUrl>().unwrap()), None);
        only_master(&mut studio);
        Self::of(outside, studio, size)
    }

    /// Creates a window for the given application state and environment.
    pub(crate) fn of(outside: Outside, studio: Studio, size: [f32; 2]) -> Self {
        let harness = Harness::builder().with_size(Vec2::from(size)).build_eframe(|cc| {
            install_fonts(&cc.egui_ctx);
            Shown(Window::new(studio, ThemeData::built_in().unwrap(), program().tabs))
        });
        Screen { harness, outside }
    }

    /// Creates a window that connects to this link in the given tab.
    pub(crate) fn open_in_tab(tab: Tab, link: &str, size: [f32; 2]) -> Self {
        let mut screen = Self::opened(Outside::new(""), Some("serial:/dev/nothing"), size);
        screen.act(Action::ShowTab(tab));
        screen.act(Action::Connect(Connect::Open));
        screen.act(Action::Connect(Connect::Use(link.to_owned())));
        screen.act(Action::Connect(Connect::Connect));
        screen
    }

    /// Creates a window in which the virtual encoder has been connected and read.
    pub(crate) fn new_form(size: [f32; 2]) -> Self {
        let mut screen = Self::opened(Outside::new(""), None, size);
        screen.until("the encoder is read", |studio| {
            studio.hiperface().is_some_and(|encoder| encoder.session.is_ready() && encoder.identity.is_some())
        });
        screen
    }

    pub(crate) fn studio(&self) -> &Studio {
        self.harness.state().0.studio()
    }

    pub(crate) fn encoder(&self) -> &Encoder {
        self.studio().hiperface().expect("an encoder is shown")
    }

    fn language(&self) -> Language {
        self.studio().settings.language
    }

    /// Draws enough frames for a click to take effect.
    pub(crate) fn steps(&mut self) {
        for _ in 0..4 {
            self.harness.step();
        }
    }

    #[track_caller]
    pub(crate) fn until(&mut self, what: &str, condition: impl Fn(&Studio) -> bool) {
        let began = Instant::now();
        loop {
            self.harness.step();
            texts::check_all(self.studio());
            if condition(self.studio()) {
                return self.steps();
            }
            assert!(began.elapsed() < LONG, "never: {what}\n{}", log(self.studio()));
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Runs an action directly, without a widget.
    pub(crate) fn act(&mut self, action: Action) {
        self.studio().mailbox().send(action);
        self.steps();
        self.only_master();
    }

    /// Sends an action to the displayed HIPERFACE encoder.
    pub(crate) fn ask(&mut self, action: Hiperface) {
        self.act(Action::device(self.encoder().session.id, action));
    }

    pub(crate) fn command(&mut self, command: DeviceCommand) {
        self.act(Action::Command(self.encoder().session.id, command));
    }

    pub(crate) fn say(&self, id: &'static str) -> String {
        crate::texts::text(id).to_string_in(self.language())
    }

    pub(crate) fn words(&self, text: &Text) -> String {
        text.to_string_in(self.language())
    }

    /// Returns the button with this label. If there are several, returns the last one, which is drawn on top.
    #[track_caller]
    pub(crate) fn button(&self, id: &'static str) -> Node<'_> {
        self.buttons(id).last().unwrap_or_else(|| panic!("there is no button {:?}", self.say(id)))
    }

    fn buttons(&self, id: &'static str) -> impl Iterator<Item = Node<'_>> {
        let label = self.say(id);
        self.harness.query_all_by(move |node| node.role() == Role::Button && node.label().as_ref() == Some(&label))
    }

    pub(crate) fn has_button(&self, id: &'static str) -> bool {
        self.buttons(id).next().is_some()
    }

    /// Checks that no visible text is in the other language, is a text ID, or has a placeholder without a value.
    #[track_caller]
    pub(crate) fn check_language(&self) {
        let foreign = texts::texts_of_other_language(self.language());
        let mut seen = 0;
        for node in self.harness.query_all_by(|_| true) {
            let node = node.accesskit_node();
            seen += usize::from(node.label().is_some());
            for words in [node.label(), node.value()].into_iter().flatten() {
                assert!(!foreign.contains(words.as_str()), "{words:?} in {:?}", self.language());
                assert!(!texts::is_name(&words), "{words:?} is the name of a text");
                let open = words.split_once('{').is_some_and(|(_, rest)| rest.contains('}'));
                assert!(!open, "{words:?} has a place left open");
            }
        }
        assert!(seen > 20, "{seen} labels");
    }

    pub(crate) fn shows(&self, words: &str) -> bool {
        self.harness.query_all_by_label_contains(words).next().is_some()
    }

    pub(crate) fn is_enabled(&self, id: &'static str) -> bool {
        !self.button(id).accesskit_node().is_disabled()
    }

    #[track_caller]
    pub(crate) fn click(&mut self, id: &'static str) {
        assert!(self.is_enabled(id), "{id} is disabled");
        self.button(id).click();
        self.steps();
        self.only_master();
    }

    /// Confirms that no drive is on the line, if the window asks. These tests have no drive.
    fn only_master(&mut self) {
        if asks_for_drive(self.studio()) {
            self.studio().mailbox().send(Action::Confirm);
            self.steps();
        }
    }

    pub(crate) fn key(&mut self, key: Key) {
        self.harness.key_press(key);
        self.steps();
    }
}
