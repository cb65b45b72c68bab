//! Another master sets the reference to the same number at another position, so no parameter changes.

use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use encoder_studio::devices::hiperdrive::protocol::ParameterNumber;
use encoder_studio::sim::SimulatedFaults;

use super::*;

/// Advances the axis set-up until the position has been set to 128 steps, and then jogs the shaft by 0.15 turns.
fn setup_jogged_from_reference() -> Desk {
    let mut desk = referenced("sim:?requested=0&timeout=250", 1, false);
    jog(&mut desk, Direction::Clockwise, 60);
    desk.settle();
    assert!(position(&mut desk) > 180 && number(&desk, 198) == 128);
    desk
}

fn set_reference_externally(desk: &Desk) {
    let reference = ParameterNumber::for_drive(198, DriveNumber::FIRST).unwrap();
    let target = unit(desk).target.clone().unwrap();
    target.with_station(|station| station.write(Moment::default(), reference, &Value::Number(128)).unwrap());
}

/// The position jumps at standstill, and everything based on the reference becomes invalid (issue 21.6 c).
#[test]
fn detects_reference_change_by_another_master() {
    let mut desk = setup_jogged_from_reference();
    assert_eq!(axis(&desk).invalidated_step(), None);
    set_reference_externally(&desk);
    desk.until("it is noticed", |studio| {
        studio.hiperdrive().unwrap().axis().unwrap().invalidated_step() == Some(AxisStep::Reference)
    });
    assert_eq!(number(&desk, 198), 128, "the parameter says nothing of it");
    assert_eq!(axis(&desk).may_move(&seen(&desk)).unwrap_err().id(), "hd_axis.fallen");
}

/// While the connection was lost, the axis may also have been moved. The change is therefore reported without stating a
/// cause (issue 21.6 c).
#[test]
fn reports_position_change_while_disconnected() {
    let mut desk = setup_jogged_from_reference();
    let target = unit(&desk).target.clone().unwrap();
    target.set_faults(&"silent-after:0".parse().unwrap());
    desk.until("it is silent", |studio| {
        let own = studio.hiperdrive().unwrap();
        let has_ended =
            studio.services.log.notices().any(|own| own.texts.iter().any(|text| text.id() == "session.poll_failed"));
        !own.drive_facts(own.drive()).connected && has_ended
    });
    set_reference_externally(&desk);
    target.set_faults(&SimulatedFaults::default());
    desk.until("it can be asked", |studio| !studio.hiperdrive().unwrap().session.is_busy());
    command(&mut desk, DeviceCommand::Read);
    desk.until("it is told", |studio| {
        let own = studio.hiperdrive().unwrap();
        labels::unexplained_change_text(own.axis().unwrap(), &own.drive_facts(own.drive())).is_some()
    });
    assert_eq!(axis(&desk).invalidated_step(), None);
    let told = labels::unexplained_change_text(axis(&desk), &seen(&desk)).unwrap().to_string_in(Language::English);
    assert!(
        told.starts_with("The position changed by -0.")
            && told.contains("Either the axis was moved or its reference was set again"),
        "{told}"
    );
}
