//! Tests of the real widgets in the Signals tab, found by their accessible labels.

use crate::tabs::Tabs as _;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use encoder_studio::app::{Action, ColorScheme, Language};
use encoder_studio::signals::state::{ExampleCapture, Origin, SignalsAction as Signals, SourceAction};
use encoder_studio::sim::sine_cosine::Quantity;

use crate::screen::Screen;
use crate::support::{HANGING_LINK, Outside};

const SIZES: [[f32; 2]; 3] = [[1280.0, 800.0], [1024.0, 640.0], [960.0, 540.0]];

impl Screen {
    fn signals(&mut self, action: Signals) {
        self.act(Action::tool(action));
        self.until("it is read", |studio| studio.signals().capture_reading().is_none());
    }

    #[track_caller]
    pub(crate) fn check_signals_pages(&mut self) {
        for language in [Language::English, Language::German] {
            for theme in [ColorScheme::Dark, ColorScheme::Light] {
                self.act(Action::SetLanguage(language));
                self.act(Action::SetTheme(theme));
                for page in encoder_studio::kinds::program().tabs.page_text_ids(crate::tabs::SIGNALS) {
                    self.click(page);
                    self.check_language();
                }
            }
        }
        self.act(Action::SetLanguage(Language::English));
        self.click("page.quality");
    }
}

#[test]
fn draws_every_page_at_every_size() {
    for size in SIZES {
        let mut screen = Screen::opened(Outside::new(""), Some(HANGING_LINK), size);
        screen.act(Action::ShowTab(crate::tabs::SIGNALS));
        screen.check_signals_pages();
        assert!(screen.shows(&screen.say("signals.nothing")));
        assert!(!screen.shows(&screen.say("shell.empty")), "it needs no session");
        for example in ExampleCapture::ALL {
            screen.signals(Signals::Example(example));
            screen.click("signals.table");
            screen.check_signals_pages();
            screen.click("signals.table");
        }
        let path = screen.outside.path("straight-line.csv");
        std::fs::write(&path, "0,1,1\n1,2,2\n2,3,3\n3,4,4\n4,5,5\n5,6,6\n6,7,7\n").unwrap();
        screen.signals(Signals::Open(path.clone()));
        screen.check_signals_pages();
        std::fs::write(&path, "0,1,1\n1,2,?\n").unwrap();
        screen.signals(Signals::Open(path));
        screen.check_signals_pages();
        assert!(screen.shows("row 2, column 3"));
    }
}

#[test]
fn opens_tab_and_loads_example() {
    let mut screen = Screen::new_form(SIZES[0]);
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::Num6);
    screen.steps();
    assert_eq!(screen.studio().settings.tab, crate::tabs::SIGNALS);
    assert!(!screen.has_button("page.memory") && screen.has_button("page.quality"));
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::Num1);
    screen.steps();
    assert!(screen.has_button("page.memory") && !screen.has_button("page.quality"));
    screen.click("tab.signals");
    screen.click("signals.example_errors");
    screen.until("it is read", |studio| studio.signals().measurement().is_some());
    assert!(screen.shows("the permitted range is 0.9 to 1.1 V"));
    // The parameters of the example give 2 · 0.5 / 1.12 V, and 40 mV of 0.5 V.
    assert!(screen.shows("0.8928 V") && screen.shows("8.00 %"));
    assert!(screen.harness.query_all_by_label(&screen.say("quality.outside")).count() >= 6);
    screen.key(Key::F1);
    assert!(screen.shows(&screen.say("help.quality")));
}

#[test]
fn figure_has_accessible_value() {
    let mut screen = Screen::opened(Outside::new(""), Some(HANGING_LINK), SIZES[0]);
    screen.act(Action::ShowTab(crate::tabs::SIGNALS));
    screen.signals(Signals::Example(ExampleCapture::WithErrors));
    let value = |screen: &Screen| {
        let label = screen.say("quality.lissajous");
        let image = screen
            .harness
            .query_all_by_role_and_label(egui::Role::Image, &label)
            .find_map(|node| node.accesskit_node().value())
            .unwrap_or_default();
        image.to_owned()
    };
    assert_eq!(value(&screen), "Vector length 0.415 … 0.558 V, allowed 0.45 to 0.55 V");
    screen.click("quality.corrected");
    screen.act(Action::SetLanguage(Language::German));
    assert!(value(&screen).contains("0,415 … 0,558 V"), "{}", value(&screen));
}

/// An error while reading a capture is shown on every page of the tab (issue 22.14).
#[test]
fn every_page_shows_failed_capture() {
    let mut screen = Screen::opened(Outside::new(""), Some(HANGING_LINK), SIZES[0]);
    screen.act(Action::ShowTab(crate::tabs::SIGNALS));
    let path = screen.outside.path("broken.csv");
    std::fs::write(&path, "t,sin,cos\n0,1,2\n1,oops,3\n").unwrap();
    screen.act(Action::Open(path));
    screen.until("it is refused", |studio| studio.signals().problem().is_some());
    for page in ["page.scope", "page.quality", "page.error", "page.synchronise", "page.input_circuit"] {
        screen.click(page);
        assert!(screen.shows("row 3, column 2"), "{page}");
    }
}

#[test]
fn rejects_invalid_periods() {
    let mut screen = Screen::opened(Outside::new(""), Some(HANGING_LINK), SIZES[0]);
    screen.act(Action::ShowTab(crate::tabs::SIGNALS));
    screen.signals(Signals::Example(ExampleCapture::Healthy));
    let label = screen.say("quality.periods_per_turn");
    let type_in = |screen: &mut Screen, text: &str| {
        let entry = |screen: &Screen| {
            let entries = screen.harness.query_all_by_role_and_label(egui::Role::TextInput, &label);
            entries.last().unwrap().focus();
        };
        entry(screen);
        screen.steps();
        screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        screen.steps();
        screen.harness.event(egui::Event::Text(text.to_owned()));
        screen.steps();
        screen.key(Key::Enter);
    };
    type_in(&mut screen, "512");
    assert_eq!(screen.studio().signals().signal_periods(), Some(512));
    type_in(&mut screen, "0");
    assert_eq!(screen.studio().signals().signal_periods(), Some(512));
    assert!(screen.shows("\"0\" is not a whole number from 1 to 65536."));
    type_in(&mut screen, "64");
    assert_eq!(screen.studio().signals().signal_periods(), Some(64));
    assert!(!screen.shows("is not a whole number"));
}

#[test]
fn compares_kept_capture_in_columns() {
    let mut screen = Screen::opened(Outside::new(""), Some(HANGING_LINK), SIZES[0]);
    screen.act(Action::ShowTab(crate::tabs::SIGNALS));
    screen.signals(Signals::Example(ExampleCapture::WithErrors));
    screen.click("compare.keep");
    assert!(!screen.is_enabled("compare.keep"), "it would be compared with itself");
    screen.signals(Signals::Example(ExampleCapture::Healthy));
    screen.check_signals_pages();
    screen.click("page.quality");
    assert!(screen.shows("Compared with offset-gain-phase.csv"));
    // The differences are 1.0020 V − 0.8928 V and 0.40 % − 8.00 %.
    assert!(screen.shows("+0.1092") && screen.shows("-7.60"));
    screen.click("page.error");
    assert!(screen.shows(&screen.say("error.kept_raw")));
    screen.click("compare.drop");
    assert!(screen.studio().signals().comparison_result().is_none());
    assert!(!screen.shows(&screen.say("error.kept_raw")));
}

#[test]
fn converts_voltages_exactly_and_by_table() {
    let mut screen = Screen::opened(Outside::new(""), Some(HANGING_LINK), SIZES[0]);
    screen.act(Action::ShowTab(crate::tabs::SIGNALS));
    screen.signals(Signals::Example(ExampleCapture::Healthy));
    screen.click("page.error");
    // With 32 intervals, the result is 7.93e-5 rad, or 16.27 bits (reference, section 3). The arctangent of 0.25 /
    // 0.433 is 30.0007°.
    assert!(screen.shows("0.00454°") && screen.shows("16.27") && screen.shows("30.00073°"));
}

#[test]
fn starts_holds_and_stops_virtual_encoder() {
    for size in SIZES {
        let mut screen = Screen::opened(Outside::new(""), Some(HANGING_LINK), size);
        screen.act(Action::ShowTab(crate::tabs::SIGNALS));
        screen.click("virtual.start");
        let measured = |studio: &encoder_studio::app::Studio| {
            studio.signals().measurement().is_some_and(|own| own.origin == Origin::Virtual)
        };
        screen.until("it is measured", measured);
        assert!(screen.shows(&screen.say("shell.virtual")) && screen.shows(&screen.say("virtual.running")));
        screen.click("virtual.settings");
        screen.check_signals_pages();
        let slider = screen.words(&encoder_studio::app::explain::signal::setting_name(Quantity::Noise));
        assert!(screen.harness.query_all_by_role_and_label(egui::Role::Slider, &slider).next().is_some());
        screen.signals(Signals::Source(SourceAction::Set(Quantity::Amplitude, 7.0)));
        assert!(screen.shows("Amplitude: 7 is outside the range 0 to 2 V."));
        screen.click("virtual.hold");
        assert!(screen.studio().signals().source().is_frozen());
        screen.click("virtual.go_on");
        assert!(!screen.studio().signals().source().is_frozen());
        screen.click("shell.stop");
        assert!(!screen.studio().signals().source().is_running());
        assert!(screen.shows(&screen.say("virtual.stopped")) && screen.has_button("virtual.again"));
        screen.click("signals.source");
        screen.click("signals.example_healthy");
        screen.until("it is read", |studio| studio.signals().table().is_some());
        assert!(!screen.shows(&screen.say("shell.virtual")) && !screen.has_button("virtual.settings"));
    }
}
