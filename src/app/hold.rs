//! A button that counts while it is held, without its picture: what begins a hold, and everything that ends it.
//!
//! | what comes | nothing is held | held by the pointer | held by a key |
//! |---|---|---|---|
//! | the pointer goes down on it | begins; not while Space or Enter is down | ends | ends |
//! | the pointer goes down elsewhere, a second finger | – | ends | ends |
//! | the pointer goes up, or leaves the button | – | ends | – |
//! | a fresh press of Space or Enter, without modifiers | begins, while it has the keyboard, no pointer is down and nothing moves | ends | ends |
//! | the same key again | a stop, while something moves | ends | goes on: it repeats itself |
//! | any other key, modifiers | – | ends | ends |
//! | the key goes up | – | – | ends |
//! | the keyboard goes to another widget | keys are forgotten | keys are forgotten | ends |
//! | the window loses or gets the keyboard; it is disabled, enabled, or was not in the last picture | keys are forgotten | ends | ends |
//!
//! What has ended begins again only by another press; a key only by one that is [fresh](FreshKeys), which none is at once
//! after another key.

use super::press::{FreshKeys, PressKey};

/// What a picture of the button begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HoldScene {
    /// It may be pressed.
    pub enabled: bool,
    /// The window has the keyboard.
    pub window: bool,
    /// The button has the keyboard.
    pub keyboard: bool,
    /// Something moves that this button does not hold, or was stopped just now: a key means that.
    pub moving: bool,
}

/// What came since the picture before, in its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldInput {
    /// The window got or lost the keyboard.
    WindowFocus(bool),
    /// A key went down, or repeats itself.
    Down {
        /// Which one.
        key: PressKey,
        /// Without modifiers.
        plain: bool,
    },
    /// A key went up.
    Up(PressKey),
    /// Another key went down.
    OtherKey,
    /// A modifier went down or up.
    Modifiers,
    /// A button of the pointer went down.
    PointerDown {
        /// The first one, on this button.
        on: bool,
    },
    /// The pointer went to another place.
    PointerMoved {
        /// On this button.
        inside: bool,
    },
    /// A button of the pointer went up.
    PointerUp,
    /// The pointer is nowhere any more.
    PointerGone,
    /// A finger came down, also one that is the pointer: then the pointer goes down after it.
    Finger,
}

/// What became of a hold in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldEvent {
    /// It begins.
    Press,
    /// It goes on: told with every picture.
    Hold,
    /// It is over.
    Release,
    /// A key was pressed that holds nothing, while something moves: everything is to stop.
    Stop,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Holder {
    Pointer,
    Key(PressKey),
}

/// What a button remembers from one picture to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HoldState {
    scene: Option<HoldScene>,
    holder: Option<Holder>,
    keys: FreshKeys,
    /// A button of the pointer is down, wherever.
    pointer: bool,
    was_held: bool,
    /// A hold has begun since the last picture.
    began: bool,
    stop: bool,
    next_picture: Option<f64>,
}

impl HoldState {
    /// A picture begins; `follows`: the button was in the picture before it.
    pub fn begin(&mut self, scene: HoldScene, follows: bool) {
        let before = self.scene.replace(scene).filter(|_| follows);
        self.pointer &= before.is_some();
        self.was_held = self.holder.is_some();
        (self.began, self.stop) = (false, false);
        let same = before.is_some_and(|own| (own.enabled, own.window) == (scene.enabled, scene.window));
        if !same {
            self.let_go();
            self.keys.forget();
        }
        if before.is_none_or(|own| own.keyboard != scene.keyboard) {
            self.keys.forget();
            if matches!(self.holder, Some(Holder::Key(_))) {
                self.let_go();
            }
        }
    }

    /// Takes what came, by the clock of the pictures.
    pub fn take(&mut self, now: f64, input: HoldInput) {
        let Some(scene) = self.scene else { return };
        match input {
            HoldInput::WindowFocus(_) => {
                self.keys.forget();
                self.let_go();
            }
            HoldInput::Down { key, plain } => self.key_down(key, plain, scene),
            HoldInput::Up(key) => {
                if scene.window {
                    self.keys.release(key, now);
                }
                if self.holder == Some(Holder::Key(key)) {
                    self.let_go();
                }
            }
            HoldInput::OtherKey => {
                self.keys.doubt(now);
                self.let_go();
            }
            HoldInput::Modifiers | HoldInput::Finger => self.let_go(),
            HoldInput::PointerDown { on } => {
                let alone = self.holder.is_none() && !self.pointer && !self.is_any_key_down();
                self.pointer = true;
                self.let_go();
                if on && alone && scene.enabled && scene.window {
                    self.hold_by(Holder::Pointer);
                }
            }
            HoldInput::PointerMoved { inside: true } => {}
            HoldInput::PointerMoved { inside: false } => self.let_go_of_pointer(),
            HoldInput::PointerUp | HoldInput::PointerGone => {
                self.pointer = false;
                self.let_go_of_pointer();
            }
        }
    }

    /// The picture of this time ends, with the pointer down or not, and on the button or not. What became of the hold.
    pub fn end(&mut self, now: f64, pointer_down: bool, inside: bool) -> Option<HoldEvent> {
        self.next_picture = self.keys.end_picture(now);
        self.pointer = pointer_down;
        if !(pointer_down && inside) {
            self.let_go_of_pointer();
        }
        // Let go and pressed between two pictures: the next press counts.
        if self.stop || self.was_held && self.began {
            self.let_go();
        }
        match (self.was_held, self.holder.is_some()) {
            _ if self.stop => Some(HoldEvent::Stop),
            (false, true) => Some(HoldEvent::Press),
            (true, true) => Some(HoldEvent::Hold),
            (true, false) => Some(HoldEvent::Release),
            (false, false) => None,
        }
    }

    /// In how many seconds a picture is needed at the latest, so that a key that went up counts as up.
    pub const fn next_picture(&self) -> Option<f64> {
        self.next_picture
    }

    /// It is held.
    pub const fn is_held(&self) -> bool {
        self.holder.is_some()
    }

    /// The pointer holds it.
    pub fn is_held_by_pointer(&self) -> bool {
        self.holder == Some(Holder::Pointer)
    }

    /// It has the keyboard, and no key has been seen up yet: the first press will not count.
    pub fn waits_for_release(&self) -> bool {
        let has_keyboard = self.scene.is_some_and(|scene| scene.enabled && scene.window && scene.keyboard);
        let armed = self.keys.is_armed(PressKey::Space) || self.keys.is_armed(PressKey::Enter);
        has_keyboard && !armed && self.holder.is_none()
    }

    fn key_down(&mut self, key: PressKey, plain: bool, scene: HoldScene) {
        let fresh = self.keys.press(key);
        match self.holder {
            Some(Holder::Key(own)) if own == key && plain => {}
            Some(_) => self.let_go(),
            None if !scene.keyboard => {}
            None if scene.moving => self.stop = true,
            None if fresh && plain && scene.enabled && scene.window && !self.pointer => self.hold_by(Holder::Key(key)),
            None => {}
        }
    }

    fn is_any_key_down(&self) -> bool {
        self.keys.is_down(PressKey::Space) || self.keys.is_down(PressKey::Enter)
    }

    fn hold_by(&mut self, holder: Holder) {
        self.holder = Some(holder);
        self.began = true;
    }

    fn let_go(&mut self) {
        self.holder = None;
    }

    fn let_go_of_pointer(&mut self) {
        if self.holder == Some(Holder::Pointer) {
            self.let_go();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::HoldEvent::{Hold, Press, Release, Stop};
    use super::PressKey::{Enter, Space};
    use super::*;

    const SCENE: HoldScene = HoldScene { enabled: true, window: true, keyboard: true, moving: false };
    const DOWN: HoldInput = HoldInput::Down { key: Space, plain: true };
    const UP: HoldInput = HoldInput::Up(Space);
    const POINTER: HoldInput = HoldInput::PointerDown { on: true };

    /// A button, a picture each fifth of a second.
    struct Pad {
        state: HoldState,
        now: f64,
        apart: f64,
        scene: HoldScene,
        pointer: bool,
        follows: bool,
    }

    impl Pad {
        fn new() -> Self {
            Pad { state: HoldState::default(), now: 0.0, apart: 0.2, scene: SCENE, pointer: false, follows: true }
        }

        /// With the keyboard, and after Space and Enter were seen up.
        fn armed() -> Self {
            let mut pad = Pad::new();
            assert_eq!(pad.picture(&[]), None);
            assert_eq!(pad.picture(&[DOWN, HoldInput::Down { key: Enter, plain: true }]), None);
            assert_eq!(pad.lift(&[UP, HoldInput::Up(Enter)]), None);
            pad
        }

        /// A picture in which keys go up, and one that sees them up.
        fn lift(&mut self, inputs: &[HoldInput]) -> Option<HoldEvent> {
            let event = self.picture(inputs);
            assert_eq!(self.picture(&[]), None);
            event
        }

        fn picture(&mut self, inputs: &[HoldInput]) -> Option<HoldEvent> {
            self.now += self.apart;
            self.state.begin(self.scene, self.follows);
            for input in inputs {
                self.pointer = match input {
                    HoldInput::PointerDown { .. } => true,
                    HoldInput::PointerUp => false,
                    _ => self.pointer,
                };
                self.state.take(self.now, *input);
            }
            self.state.end(self.now, self.pointer, true)
        }
    }

    /// Issue 21.2: what X11 delivers where Space is held and the window loses the keyboard and gets it back.
    #[test]
    fn a_key_that_is_held_while_the_keyboard_goes_and_comes_holds_nothing() {
        let mut pad = Pad::armed();
        assert_eq!(pad.picture(&[DOWN]), Some(Press));
        assert_eq!(pad.picture(&[DOWN]), Some(Hold), "it repeats itself");
        pad.scene.window = false;
        // The release is made up by the toolkit.
        assert_eq!(pad.picture(&[HoldInput::Modifiers, UP, HoldInput::WindowFocus(false)]), Some(Release));
        assert_eq!(pad.picture(&[]), None);
        pad.scene.window = true;
        assert_eq!(pad.picture(&[HoldInput::WindowFocus(true), HoldInput::Modifiers, DOWN]), None);
        for _ in 0..20 {
            assert_eq!(pad.picture(&[DOWN]), None, "it is still held");
        }
        assert!(pad.state.waits_for_release());
        assert_eq!(pad.lift(&[UP]), None);
        assert!(!pad.state.waits_for_release());
        assert_eq!(pad.picture(&[DOWN]), Some(Press));
        // All of it between two pictures.
        let blink = [UP, HoldInput::WindowFocus(false), HoldInput::WindowFocus(true), DOWN];
        assert_eq!(pad.picture(&blink), Some(Release));
        assert_eq!(pad.picture(&[DOWN]), None);
    }

    /// Issue 21.2: whatever changes around the button, a key counts only after it was seen up.
    #[test]
    fn after_each_change_a_key_counts_only_once_it_was_seen_up() {
        type Change = fn(&mut Pad);
        let changes: [(&str, Change); 4] = [
            ("the keyboard was elsewhere in the window", |pad| {
                pad.scene.keyboard = false;
                pad.picture(&[]);
                pad.scene.keyboard = true;
            }),
            ("the window was without it", |pad| {
                pad.scene.window = false;
                pad.picture(&[]);
                pad.scene.window = true;
            }),
            ("it was disabled", |pad| {
                pad.scene.enabled = false;
                pad.picture(&[]);
                pad.scene.enabled = true;
            }),
            ("another page was shown", |pad| pad.follows = false),
        ];
        for (what, change) in changes {
            for held in [false, true] {
                let mut pad = Pad::armed();
                if held {
                    assert_eq!(pad.picture(&[DOWN]), Some(Press));
                }
                change(&mut pad);
                pad.picture(&[DOWN]);
                pad.follows = true;
                assert!(!pad.state.is_held(), "{what}, {held}");
                assert_eq!(pad.picture(&[DOWN]), None, "{what}, {held}");
                assert_eq!(pad.lift(&[UP]), None, "{what}, {held}");
                assert_eq!(pad.picture(&[DOWN]), Some(Press), "{what}, {held}");
            }
        }
    }

    /// Issue 21.2: a pointer that is down already begins nothing, whatever becomes possible meanwhile.
    #[test]
    fn a_pointer_begins_a_hold_only_by_going_down() {
        let mut pad = Pad::armed();
        pad.scene.enabled = false;
        assert_eq!(pad.picture(&[POINTER]), None);
        pad.scene.enabled = true;
        assert_eq!(pad.picture(&[]), None);
        assert_eq!(pad.picture(&[HoldInput::PointerUp]), None);
        assert_eq!(pad.picture(&[POINTER]), Some(Press));
        // Disabled and enabled again while it is held.
        pad.scene.enabled = false;
        assert_eq!(pad.picture(&[]), Some(Release));
        pad.scene.enabled = true;
        assert_eq!(pad.picture(&[]), None);
        // Off the button and back.
        pad.picture(&[HoldInput::PointerUp]);
        assert_eq!(pad.picture(&[POINTER]), Some(Press));
        let aside = [HoldInput::PointerMoved { inside: false }, HoldInput::PointerMoved { inside: true }];
        assert_eq!(pad.picture(&aside), Some(Release));
        assert_eq!(pad.picture(&[]), None);
        // In a window without the keyboard, which gets it by that very click.
        pad.picture(&[HoldInput::PointerUp]);
        assert_eq!(pad.picture(&[POINTER, HoldInput::WindowFocus(true)]), None);
        assert_eq!(pad.picture(&[]), None);
    }

    /// Issue 21.2: any key while the pointer holds it, any second thing while a key does.
    #[test]
    fn whatever_comes_beside_what_holds_it_ends_it() {
        let beside = [
            HoldInput::OtherKey,
            HoldInput::Modifiers,
            HoldInput::Down { key: Enter, plain: true },
            HoldInput::Down { key: Enter, plain: false },
            HoldInput::PointerDown { on: true },
            HoldInput::PointerDown { on: false },
            HoldInput::Finger,
            HoldInput::WindowFocus(true),
            HoldInput::Down { key: Space, plain: false },
        ];
        for input in beside {
            for holds in [DOWN, POINTER] {
                let mut pad = Pad::armed();
                assert_eq!(pad.picture(&[holds]), Some(Press));
                assert_eq!(pad.picture(&[]), Some(Hold));
                assert_eq!(pad.picture(&[input]), Some(Release), "{input:?} beside {holds:?}");
                assert_eq!(pad.picture(&[]), None, "{input:?} beside {holds:?}");
                assert_eq!(pad.picture(&[DOWN]), None, "{input:?} beside {holds:?}");
            }
        }
        let mut pad = Pad::armed();
        pad.picture(&[POINTER]);
        assert_eq!(pad.picture(&[DOWN]), Some(Release), "also the key that could hold it");
        // Two at once: neither.
        let mut pad = Pad::armed();
        assert_eq!(pad.picture(&[DOWN, POINTER]), None);
        let mut pad = Pad::armed();
        assert_eq!(pad.picture(&[POINTER, DOWN]), None);
        // The pointer is down elsewhere.
        let mut pad = Pad::armed();
        pad.picture(&[HoldInput::PointerDown { on: false }]);
        assert_eq!(pad.picture(&[DOWN]), None);
    }

    /// Issue 21.2: whoever hits a key while something moves means that, also where it does not count as a press.
    #[test]
    fn a_key_stops_what_moves_and_begins_nothing() {
        for armed in [false, true] {
            let mut pad = if armed { Pad::armed() } else { Pad::new() };
            pad.scene.moving = true;
            assert_eq!(pad.picture(&[DOWN]), Some(Stop), "{armed}");
            pad.scene.moving = false;
            assert_eq!(pad.picture(&[DOWN]), None, "{armed}: still held");
            assert_eq!(pad.lift(&[UP]), None);
            assert_eq!(pad.picture(&[DOWN]), Some(Press));
        }
        let mut pad = Pad::armed();
        (pad.scene.moving, pad.scene.keyboard) = (true, false);
        assert_eq!(pad.picture(&[DOWN]), None, "not meant for it");
    }

    /// Issue 21.2: a key that repeats itself by a release and a press at once, which come in two pictures of any distance.
    #[test]
    fn a_repetition_that_is_split_over_two_pictures_holds_nothing() {
        for apart in [0.016, 0.05, 0.08, 0.25] {
            let mut pad = Pad::armed();
            pad.apart = apart;
            assert_eq!(pad.picture(&[DOWN]), Some(Press), "{apart}");
            assert_eq!(pad.picture(&[UP]), Some(Release), "{apart}");
            for _ in 0..30 {
                assert_eq!(pad.picture(&[DOWN]), None, "{apart}");
                assert_eq!(pad.picture(&[UP]), None, "{apart}");
            }
        }
    }

    /// Issue 22.29: a barcode scanner types Enter within milliseconds of the last digit.
    #[test]
    fn a_press_at_once_after_another_key_holds_nothing() {
        let mut pad = Pad::armed();
        assert_eq!(pad.picture(&[HoldInput::OtherKey, DOWN]), None);
        assert_eq!(pad.lift(&[UP]), None);
        assert_eq!(pad.picture(&[HoldInput::OtherKey]), None);
        assert_eq!(pad.picture(&[DOWN]), None);
        assert_eq!(pad.lift(&[UP]), None);
        assert_eq!(pad.lift(&[HoldInput::OtherKey]), None);
        assert_eq!(pad.picture(&[DOWN]), Some(Press));
    }

    /// Issue 21.2: a person's press a tenth of a second after the release, with no other event in between.
    #[test]
    fn a_release_asks_for_the_picture_by_which_the_next_press_counts() {
        let mut pad = Pad::armed();
        assert_eq!(pad.picture(&[DOWN]), Some(Press));
        assert_eq!(pad.state.next_picture(), None, "while it is held");
        assert_eq!(pad.picture(&[UP]), Some(Release));
        let released = pad.now;
        while let Some(next) = pad.state.next_picture() {
            pad.apart = next;
            assert_eq!(pad.picture(&[]), None);
            assert!(pad.now < released + 0.0501);
        }
        pad.apart = released + 0.1 - pad.now;
        assert_eq!(pad.picture(&[DOWN]), Some(Press));
    }

    #[test]
    fn what_is_over_within_a_picture_is_no_hold() {
        let mut pad = Pad::armed();
        assert_eq!(pad.picture(&[DOWN, UP]), None);
        assert_eq!(pad.picture(&[POINTER, HoldInput::PointerUp]), None);
        assert_eq!(pad.picture(&[POINTER]), Some(Press));
        assert_eq!(pad.picture(&[HoldInput::PointerUp, POINTER]), Some(Release), "the next press counts");
        assert_eq!(pad.picture(&[]), None);
    }
}
