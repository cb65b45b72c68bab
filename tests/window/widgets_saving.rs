//! Tests of the keys and the dialog that save an open profile.

use crate::tabs::Tabs as _;
use std::fs;

use egui::{Key, Modifiers};
use encoder_studio::app::{Action, Language, PendingEdits};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;

use crate::screen::Screen;
use crate::support::Outside;

const SIZE: [f32; 2] = [1000.0, 640.0];

const OWN: &str = "(schema: 1, device: \"hiperface\",\n\
    identity: (serial_number: \"A1\", encoder_type: 0x37),\n\
    interface: (settings: 0xE4, address: 0x40),\n\
    fields: [(number: 0, status: 0xC8, bytes: [\"00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F\"])], // end\n)\n";

/// Ctrl+S writes the open file. If others have changed it, both versions are shown side by side, in both languages, and
/// each button has the labelled effect (issue 22.25).
#[test]
fn shows_versions_side_by_side() {
    let outside = Outside::new("");
    let path = outside.path("own.ron");
    fs::write(&path, OWN).unwrap();
    let mut studio = outside.studio();
    studio.start_with(None, Some(path.clone()));
    let mut screen = Screen::of(outside, studio, SIZE);
    screen.until("it is open", |studio| studio.hiperface().is_some());
    let put = |screen: &mut Screen, address, byte| {
        screen.ask(Hiperface::Put { field: 0, address, bytes: vec![byte] });
    };
    let save = |screen: &mut Screen| {
        screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
        screen.steps();
    };
    let is_saved = |studio: &encoder_studio::app::Studio| !studio.hiperface().unwrap().staged.is_dirty();
    put(&mut screen, 0, 0x58);
    save(&mut screen);
    screen.until("it is saved", is_saved);
    let mine = OWN.replace("\"00 01", "\"58 01");
    assert_eq!(fs::read_to_string(&path).unwrap(), mine);

    let theirs = mine.replace("01 02", "AA 02").replace("\"A1\"", "\"A2\"");
    fs::write(&path, &theirs).unwrap();
    put(&mut screen, 2, 0x59);
    save(&mut screen);
    screen.until("it is asked", |studio| studio.diverged.is_some());
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        screen.check_language();
        assert!(screen.shows("identity.serial_number") && screen.shows("\"A2\"") && screen.shows("58 AA 02"));
    }
    assert!(!screen.is_enabled("diverged.merge"), "one entry was changed by both");
    screen.click("file.cancel");
    assert!(screen.studio().diverged.is_none() && screen.encoder().staged.is_dirty());
    save(&mut screen);
    screen.until("it is asked", |studio| studio.diverged.is_some());
    screen.click("diverged.keep_mine");
    screen.until("it is saved", is_saved);
    assert_eq!(fs::read_to_string(&path).unwrap(), mine.replace("01 02", "01 59"));

    fs::write(&path, &theirs).unwrap();
    put(&mut screen, 3, 0x5A);
    save(&mut screen);
    screen.until("it is asked", |studio| studio.diverged.is_some());
    screen.click("diverged.reload");
    assert!(!screen.encoder().staged.is_dirty());
    assert_eq!((screen.encoder().staged.byte(0, 1), fs::read_to_string(&path).unwrap()), (Some(0xAA), theirs));
}
