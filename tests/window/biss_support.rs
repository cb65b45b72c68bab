//! Test support: the application with a BiSS encoder.

use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use encoder_studio::app::{Action, Studio};
use encoder_studio::devices::biss::protocol::RegisterAddress;
use encoder_studio::devices::biss::state::{BissAction as Biss, Encoder};

use crate::support::Desk;

pub(crate) fn at(text: &str) -> RegisterAddress {
    text.parse().unwrap()
}

/// Returns whether the device is connected, has been read, and is idle.
pub(crate) fn is_read(studio: &Studio) -> bool {
    studio.biss().is_some_and(|own| own.session.is_ready() && own.survey.is_some())
}

/// Starts the application, opens a link in the BiSS tab and waits until the encoder has been read.
pub(crate) fn open(link: &str) -> Desk {
    let mut desk = Desk::fresh("");
    connect(&mut desk, link);
    desk
}

/// Opens a link in the BiSS tab and waits until the encoder has been read.
pub(crate) fn connect(desk: &mut Desk, link: &str) {
    desk.act(Action::ShowTab(crate::tabs::BISS));
    desk.studio.start_with(Some(link.parse().unwrap()), None);
    desk.until("the encoder is read", is_read);
    desk.settle();
}

pub(crate) fn encoder(desk: &Desk) -> &Encoder {
    desk.studio.biss().expect("a BiSS encoder is shown")
}

pub(crate) fn command(desk: &mut Desk, command: DeviceCommand) {
    let id = encoder(desk).session.id;
    desk.act(Action::Command(id, command));
}

pub(crate) fn ask(desk: &mut Desk, action: Biss) {
    let id = encoder(desk).session.id;
    desk.act(Action::device(id, action));
}
