//! Tests of the registers in operation mode: the register table in the manual's appendix, temperature, errors and
//! warnings.

use super::*;
use crate::devices::biss::protocol::{Descriptions, ErrorRegister};

/// Every register with a default in the description must contain it.
#[test]
fn new_encoder_has_factory_settings() {
    let mut host = Host::with("");
    let all = Descriptions::built_in();
    let kit = all.find_by_name("POSITAL IXARC kit encoder").unwrap();
    let mut compared = 0;
    for register in kit.registers() {
        let at = |offset| register.address.offset_by(offset).unwrap();
        let read: Vec<u8> = (0..register.width).map(|byte| host.encoder.read(host.now, at(byte)).unwrap()).collect();
        if !register.default.is_empty() {
            assert_eq!(read, register.default, "{}", register.name);
            compared += 1;
        }
    }
    assert_eq!(compared, 7 + 9 + 4 + 14 + 17, "direct, banks 0 to 3 of the manual's appendix");
    let fixed = [("0x02:0x3F", 0xF4), ("0x03:0x3F", 0x31), ("0x74", 1), ("0x75", 6), ("0x76", 0), ("0x66", 0x50)];
    fixed.iter().for_each(|(register, value)| host.expect(register, *value));
    let serial = ["0x44", "0x45", "0x46", "0x47"].map(|register| host.read(register));
    assert_eq!(serial, [0x00, 0x12, 0xD6, 0x87]);
    assert_eq!(host.position(), Some((0x1234, 0x18000)));
}

#[test]
fn encoder_has_68_banks() {
    let mut host = Host::with("");
    host.expect("0x43:0x3F", 0);
    assert_eq!(host.encoder.read(host.now, address("0x44:0x00")), None);
    assert!(!host.write("0x44:0x00", 1));
    host.put("0x40", 0x24);
    host.expect("0x40", 0x24);
    assert_eq!(host.encoder.address(0x10), Some(address("0x24:0x10")));
    assert_eq!(host.encoder.address(0x66), Some(address("0x66")));
    assert_eq!(host.encoder.bank(), 0x24);
    assert_eq!(host.encoder.address(0x80), None);
}

#[test]
fn rejects_writes_to_read_only_registers() {
    let mut host = Host::with("");
    for register in ["0x41", "0x66", "0x6E", "0x74", "0x7F", "0x67", "0x00:0x01", "0x00:0x09", "0x02:0x05", "0x03:0x0A"]
    {
        let before = host.read(register);
        assert!(!host.write(register, 0x55), "{register}");
        host.expect(register, before);
    }
}

/// According to manual 6.8, the warning is set at 125 °C and above, and cleared below 123 °C.
#[test]
fn temperature_warning_has_hysteresis() {
    let mut host = Host::with("");
    for (celsius, register, warns) in [
        (124, 0xAE, false),
        (125, 0xAF, true),
        (124, 0xAE, true),
        (123, 0xAD, true),
        (122, 0xAC, false),
        (124, 0xAE, false),
    ] {
        host.encoder.set_temperature(celsius);
        host.expect("0x66", register);
        host.expect("0x69", u8::from(warns));
        assert_eq!(
            host.encoder.position_at(host.now).map(|reading| (reading.error, reading.warning)),
            Some((false, warns))
        );
    }
    host.encoder.set_temperature(-40);
    host.expect("0x66", 0x0A);
}

#[test]
fn error_invalidates_position() {
    let mut host = Host::with("errors=0x12");
    host.expect("0x68", 0x12);
    assert_eq!(host.encoder.position_at(host.now).map(|reading| reading.error), Some(true));
    host.encoder.set_errors(ErrorRegister::new(0));
    host.expect("0x68", 0);
    assert_eq!(host.encoder.position_at(host.now).map(|reading| reading.error), Some(false));
}

#[test]
fn older_firmware_has_fewer_registers() {
    let mut host = Host::with("firmware=1.5.9&errors=0x12&temperature=130");
    host.expect("0x68", 0);
    host.expect("0x69", 0);
    host.enter(0x07);
    assert!(!host.write("0x01:0x00", 0x04), "singleturn alone from 1.6.0 on");
    let mut host = Host::with("firmware=1.1.9");
    host.put("0x6B", 0x2A);
    assert!(!host.write("0x6A", 0x07), "preset from 1.2.0 on");
    host.enter(0x05);
    let mut host = Host::with("firmware=1.0.9");
    host.put("0x6B", 0x2A);
    assert!(!host.write("0x6A", 0x05), "filter from 1.1.0 on");
    host.expect("0x6E", 0);
}
