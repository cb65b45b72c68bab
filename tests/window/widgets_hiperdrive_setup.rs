//! Tests of the indicators, the network page and the axis set-up, operated as a user does and checked in both
//! languages.

use crate::tabs::Tabs as _;
use egui::Key;
use egui::accesskit::Role;
use egui_kittest::Node;
use egui_kittest::kittest::Queryable;
use encoder_studio::app::DeviceCommand;
use encoder_studio::app::review::Stage;
use encoder_studio::app::{Action, Language, ReviewAction, Studio, Text, connect};
use encoder_studio::buses::ethernet_ip::protocol::AddressSource;
use encoder_studio::devices::hiperdrive::procedures::dead_man::TargetState;
use encoder_studio::devices::hiperdrive::protocol::{DriveNumber, ErrorCode, ParameterNumber, State, Value};
use encoder_studio::devices::hiperdrive::state::axis::AxisStep;
use encoder_studio::devices::hiperdrive::state::{EditFinding, HiperdriveAction as Hiperdrive, MotorCommand};
use encoder_studio::units::Moment;

use crate::screen::Screen;

/// Window size that fits a complete page.
const TALL: [f32; 2] = [1280.0, 2400.0];

fn page(link: &str, page: &'static str) -> Screen {
    let mut screen = Screen::open_in_tab(crate::tabs::HIPERDRIVE, link, TALL);
    screen.until("it is read", |studio| {
        studio.hiperdrive().is_some_and(|own| own.survey.is_some() && own.session.is_ready())
    });
    screen.click(page);
    screen
}

impl Screen {
    fn entry<'a>(&'a self, label: &'a str) -> Node<'a> {
        self.harness.get_by_role_and_label(Role::TextInput, label)
    }

    /// Replaces the text of an entry.
    fn put(&mut self, label: &str, text: &str) {
        self.entry(label).focus();
        self.steps();
        self.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
        self.entry(label).type_text(text);
        self.steps();
    }

    fn press(&mut self, role: Role, label: &str) {
        self.harness.get_by_role_and_label(role, label).click();
        self.steps();
    }
}

#[test]
fn clicking_leds_sets_observed_states() {
    let mut screen = page("sim:", "page.diagnosis");
    assert!(screen.shows("All requested drives are connected, and no others. No drive has an error."));
    screen.press(Role::RadioButton, "Device: Bus adapter");
    assert!(screen.shows("The drive has no errors."));
    screen.press(Role::Button, "RS485: green");
    assert!(screen.shows("No supply voltage.") && screen.shows("Check the control supply and its fuse."));
    screen.press(Role::RadioButton, "Device: Hub");
    screen.press(Role::RadioButton, "Switch S3: 3");
    assert!(
        screen.shows("The drive is neither connected nor requested.") && screen.shows("Switch S3 is set to drive 3")
    );
    screen.press(Role::Button, "NS: green");
    screen.press(Role::Button, "NS: green, flashing");
    screen.press(Role::Button, "NS: red, flashing");
    assert!(screen.shows("Another device has the same address."));
}

#[test]
fn checks_and_writes_typed_address() {
    let mut screen = page("sim:", "page.device");
    assert!(screen.shows("from a DHCP server") && !screen.is_enabled("hd_net.write"));
    screen.press(Role::RadioButton, "Address source: stored");
    screen.put("Address", "192.168.5.255");
    screen.put("Subnet mask", "255.255.255.0");
    assert!(
        screen.shows("192.168.5.255 is the broadcast address of the network.") && !screen.is_enabled("hd_net.write")
    );
    screen.put("Address", "192.168.5.20");
    screen.put("Gateway", "192.168.6.1");
    assert!(screen.shows("The gateway 192.168.6.1 is outside the network 192.168.5.0/24."));
    screen.put("Gateway", "192.168.5.1");
    assert!(screen.shows("The device uses the stored address 192.168.5.20."));
    screen.click("hd_net.write");
    screen.until("the plan is there", |studio| {
        studio.selected_device().unwrap().review_sheet().is_some_and(|sheet| matches!(sheet.stage, Stage::Ready(_)))
            && studio.hiperdrive().unwrap().session.is_ready()
    });
    // The dialog shows the warning as well, above the form.
    let sheet = screen.studio().selected_device().unwrap().review_sheet().unwrap();
    let warned = |text: &Text| {
        text.terminal_text().contains("At the next power-up") && text.terminal_text().contains("192.168.5.20")
    };
    assert!(sheet.warnings.iter().any(warned), "{:?}", sheet.warnings);
    let Stage::Ready(plan) = sheet.stage else { panic!("no plan") };
    let id = screen.studio().hiperdrive().unwrap().session.id;
    screen.act(Action::Review(id, ReviewAction::Write(plan)));
    screen.until("it is written and read", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.session.is_ready()
            && own.network_settings().is_some_and(|own| {
                own.source == AddressSource::Stored && own.interface.address.to_string() == "192.168.5.20"
            })
    });
}

#[test]
fn axis_setup_names_missing_steps() {
    let mut screen = page("sim:?requested=0", "page.axis");
    screen.check_language();
    screen.click("hd_axis.begin");
    assert!(!screen.is_enabled("hd_axis.next") && screen.shows("Request the drive first (parameter 152 = 1)."));
    assert_eq!(screen.studio().hiperdrive().unwrap().axis().unwrap().step(), AxisStep::Request);
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        for id in ["page.axis", "page.device", "page.diagnosis"] {
            screen.click(id);
            screen.check_language();
        }
    }
    screen.click("page.axis");
    screen.click("hd_axis.cancel");
    assert!(screen.shows("Nothing was written."));
}

/// The limits keep their physical positions. A spindle with a pitch of 4 mm and steps of 0.01 mm has 400 steps per
/// turn, and 511 turns in each direction are 2044 mm, or 204400 steps (reference, section 5).
#[test]
fn pitch_and_resolution_set_scale() {
    let mut screen = page("sim:", "page.parameters");
    screen.press(Role::RadioButton, "Show: Scaling");
    assert!(!screen.is_enabled("hd_scale.set"), "without a pitch there is no scale");
    screen.put("Spindle pitch", "four");
    screen.entry("Step size").focus();
    screen.steps();
    assert!(screen.shows("\"four\" is not a valid length"));
    screen.put("Spindle pitch", "4");
    screen.put("Step size", "0.0000001");
    let own = screen.studio().hiperdrive().unwrap();
    assert_eq!(own.spindle_pitch(own.drive()).map(|own| own.nanometres), Some(4_000_000));
    screen.click("hd_scale.set");
    assert!(screen.studio().hiperdrive().unwrap().staged.differences().is_empty());
    screen.put("Step size", "0.01");
    screen.click("hd_scale.set");
    assert!(screen.shows("400 steps") && screen.shows("-2044.00 … 2044.00 mm"));
    let own = screen.studio().hiperdrive().unwrap();
    let wanted = own.staged.edited_values().unwrap();
    assert_eq!(wanted.scale(own.drive()).unwrap().steps_per_turn(), 400.0);
    assert_eq!(wanted.limits(own.drive()), Some((-204_400, 204_400)));
    let id = own.session.id;
    // The review shows the limits in millimetres, each with its own scale, old and new on one line.
    screen.act(Action::Command(id, DeviceCommand::Review));
    screen.until("there is a plan", |studio| {
        studio.selected_device().unwrap().review_sheet().is_some_and(|sheet| matches!(sheet.stage, Stage::Ready(_)))
    });
    assert!(screen.shows("256  →  400") && screen.shows("-33488896 · -2044.0000 mm  →  -204400 · -2044.00 mm"));
    screen.act(Action::Review(id, ReviewAction::Close));
    // If the limits keep their numbers instead, they are 164 times further away.
    screen.act(Action::Command(id, DeviceCommand::Undo));
    screen.press(Role::RadioButton, "Limits: keep their values");
    screen.click("hd_scale.set");
    let own = screen.studio().hiperdrive().unwrap();
    assert_eq!(own.staged.edited_values().unwrap().limits(own.drive()), Some((-33_488_896, 33_488_896)));
    assert!(matches!(own.findings()[..], [EditFinding::LimitsMove { .. }]));
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        screen.check_language();
    }
}

/// The user types a number into the table. An invalid one stays in its row with the reason, even after other rows were
/// shown.
#[test]
fn accepts_typed_parameters() {
    let mut screen = page("sim:?hub=4&drives=1,0,1", "page.parameters");
    let row =
        |screen: &Screen, label: &str| screen.harness.query_by_role_and_label(Role::Row, label).map(|own| own.rect());
    assert!(row(&screen, "105 Status word").is_none(), "it is not to be set");
    let begin = |screen: &mut Screen, label: &str| {
        let table = screen.harness.get_by_role_and_label(Role::Table, "Parameters");
        table.focus();
        screen.harness.get_by_role_and_label(Role::Row, label).click();
        screen.steps();
        screen.key(Key::F2);
    };
    begin(&mut screen, "166 Maximum speed");
    screen.put("166 Maximum speed", "9999");
    screen.key(Key::Enter);
    assert!(screen.shows("Allowed values: 5 to 350"));
    // When other rows are shown, the invalid text stays with its own row.
    screen.press(Role::RadioButton, "Show: All");
    assert!(row(&screen, "105 Status word").is_some());
    screen.put("166 Maximum speed", "300");
    screen.key(Key::Enter);
    let edits = |screen: &Screen| {
        let own = screen.studio().hiperdrive().unwrap();
        own.staged.differences().iter().map(|own| (own.number.get(), own.from, own.to)).collect::<Vec<_>>()
    };
    assert_eq!(edits(&screen), [(166, Some(350), Some(300))]);
    assert!(!screen.shows("Allowed values: 5 to 350"));
    // A read-only value cannot be edited, and a message says so.
    begin(&mut screen, "105 Status word");
    assert!(screen.shows("105 (Status word) is read-only"));
    // Typed text is applied before other rows are shown, and before there are no rows at all.
    begin(&mut screen, "172 Jog 1 speed");
    screen.put("172 Jog 1 speed", "50");
    screen.press(Role::RadioButton, "Show: Changed");
    assert_eq!(edits(&screen), [(166, Some(350), Some(300)), (172, Some(100), Some(50))]);
    begin(&mut screen, "172 Jog 1 speed");
    screen.put("172 Jog 1 speed", "100");
    screen.press(Role::RadioButton, "Show: Scaling");
    assert_eq!(edits(&screen), [(166, Some(350), Some(300))]);
    assert!(screen.shows("Spindle pitch"));
    screen.press(Role::RadioButton, "Show: All");
    // Another drive has other rows, and the typed text does not go into them.
    begin(&mut screen, "158 Lower limit");
    screen.put("158 Lower limit", "17");
    let id = screen.studio().hiperdrive().unwrap().session.id;
    let three = encoder_studio::devices::hiperdrive::protocol::DriveNumber::new(3).unwrap();
    screen.act(Action::device(id, Hiperdrive::SelectDrive(three)));
    screen.steps();
    assert_eq!(edits(&screen), [(166, Some(350), Some(300))]);
    assert!(screen.harness.query_by_role_and_label(Role::TextInput, "158 Lower limit").is_none());
}

/// A second click that was meant for the previous step must not leave the new one.
#[test]
fn double_click_does_not_skip_step() {
    let mut screen = page("sim:", "page.axis");
    screen.click("hd_axis.begin");
    screen.steps();
    assert!(screen.is_enabled("hd_axis.next"), "it is requested");
    screen.button("hd_axis.next").click();
    screen.harness.step();
    screen.harness.step();
    assert_eq!(screen.studio().hiperdrive().unwrap().axis().unwrap().step(), AxisStep::Scale);
    assert!(!screen.is_enabled("hd_axis.back"));
    screen.steps();
    assert!(screen.is_enabled("hd_axis.back"));
}

/// A dialog blocks the controls below it, but not STOP.
#[test]
fn stop_is_reachable_over_dialog() {
    let mut screen = page("sim:", "page.motion");
    let id = screen.studio().hiperdrive().unwrap().session.id;
    let act = |screen: &mut Screen, action| screen.act(Action::device(id, action));
    act(&mut screen, Hiperdrive::Take);
    screen.until("the control is taken", |studio| {
        studio.hiperdrive().is_some_and(|own| own.moves.is_open() && own.session.is_ready())
    });
    act(&mut screen, Hiperdrive::Drive(MotorCommand::Move { target: 30_000_000 }));
    screen.until("it moves", Studio::is_moving);
    screen.act(Action::Connect(connect::ConnectAction::Open));
    assert!(screen.studio().connect.is_some() && screen.studio().is_moving(), "a move goes on under a dialog");
    screen.click("hd_bar.stop");
    screen.until("it stands", |studio| !studio.is_moving());
    let own = screen.studio().hiperdrive().unwrap();
    assert!(own.actual_values(own.drive()).unwrap().position < 30_000_000 && screen.studio().connect.is_some());
}

/// Whatever the drive reports, no clickable control moves, and the step stays until the user leaves it (issue 21.6 i).
#[test]
fn step_layout_does_not_shift() {
    let mut screen = page("sim:", "page.axis");
    let advance = |screen: &mut Screen, step: AxisStep| {
        screen.click("hd_axis.next");
        screen.steps();
        assert_eq!(screen.studio().hiperdrive().unwrap().axis().unwrap().step(), step);
    };
    screen.click("hd_axis.begin");
    screen.steps();
    assert!(!screen.is_enabled("hd_axis.recall"), "nothing is known to differ");
    advance(&mut screen, AxisStep::Scale);
    // 655.36 mm per turn in steps of 0.01 mm are the 65536 steps of the factory setting, so there is nothing to write.
    screen.put("Pitch (mm per turn)", "655.36");
    assert!(!screen.is_enabled("hd_axis.write"));
    advance(&mut screen, AxisStep::Confirm);
    screen.click("hd_axis.confirm");
    advance(&mut screen, AxisStep::Jog);
    let places = |screen: &Screen| {
        [
            "hd_axis.take",
            "hd_axis.acknowledge",
            "hd_axis.jog_down",
            "hd_axis.jog_up",
            "hd_axis.back",
            "hd_axis.cancel",
            "hd_axis.next",
        ]
        .map(|id| screen.button(id).rect())
    };
    let before = places(&screen);
    let unit = |screen: &Screen| screen.studio().hiperdrive().unwrap().target.clone().unwrap();
    screen.click("hd_axis.take");
    screen.until("control", |studio| {
        studio.hiperdrive().is_some_and(|own| own.may_move(own.drive()).is_ok() && own.session.is_ready())
    });
    screen.steps();
    assert_eq!(places(&screen), before, "with control");
    let id = screen.studio().hiperdrive().unwrap().session.id;
    screen.act(Action::device(id, Hiperdrive::Drive(MotorCommand::Lead(TargetState::Enabled))));
    screen.until("it is enabled", |studio| {
        studio.hiperdrive().is_some_and(|own| own.state(own.drive()) == Some(State::Enabled))
    });
    unit(&screen).with_station(|own| {
        own.drive(DriveNumber::FIRST).unwrap().inject_error(Moment::default(), ErrorCode::FOLLOWING_ERROR)
    });
    screen.until("its code is read", |studio| {
        studio.hiperdrive().is_some_and(|own| own.drive_facts(own.drive()).error == Some(ErrorCode::FOLLOWING_ERROR))
    });
    screen.steps();
    assert!(screen.shows("Fault 8203") && screen.is_enabled("hd_axis.acknowledge"));
    assert!(!screen.is_enabled("hd_axis.jog_up") && !screen.is_enabled("hd_axis.jog_down"));
    assert_eq!(places(&screen), before, "in a fault");
    let scale = ParameterNumber::for_drive(154, DriveNumber::FIRST).unwrap();
    unit(&screen).with_station(|own| own.write(Moment::default(), scale, &Value::Number(400)).unwrap());
    screen.until("somebody else has set the scale", |studio| {
        studio.hiperdrive().is_some_and(|own| own.axis().unwrap().invalidated_step() == Some(AxisStep::Scale))
    });
    screen.steps();
    assert!(screen.shows("Step 2 (Pitch and resolution) is no longer valid"));
    assert_eq!(
        (screen.studio().hiperdrive().unwrap().axis().unwrap().step(), places(&screen)),
        (AxisStep::Jog, before)
    );
    screen.click("hd_axis.back");
    assert_eq!(screen.studio().hiperdrive().unwrap().axis().unwrap().step(), AxisStep::Scale);
}
