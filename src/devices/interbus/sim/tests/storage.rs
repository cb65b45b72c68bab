//! Tests of the EEPROM: stored values, power loss and wear (reference 3, `U`).

use super::*;
use crate::devices::interbus::protocol::StartupMode;

#[test]
fn power_loss_discards_unstored_values() {
    let mut master = Master::with("steps=360&revolutions=1&position=4096");
    master.put(&[0x0200_00B4, 0x8000_0000, 0, 0x0200_0009]);
    master.encoder.disconnect();
    assert_eq!((master.encoder.read(master.now), master.encoder.memory().gear().total_steps()), (None, 180));
    master.encoder.write(master.now, 0);
    master.encoder.connect(master.now);
    assert_eq!((master.read(), master.encoder.store_count()), (90, 4));
}

/// The gateway still sends the same word after the power loss, and the encoder processes it as a new one.
#[test]
fn processes_master_word_after_power_up() {
    let mut master = Master::with("steps=360&revolutions=1&position=4096");
    master.put(&[0x0200_00B4]);
    master.power_cycle();
    assert_eq!((master.read(), master.encoder.store_count()), (0xC200_00B4, 3));
}

#[test]
fn mode_and_preset_survive_without_store() {
    let mut master = Master::with("steps=360&revolutions=1&position=4096");
    master.put(&[0x0800_0005, 0x8000_0000, 0, 0x4000_0000, 0, 0x2080_0004, 0x8000_0000]);
    master.power_cycle();
    assert_eq!(master.encoder.startup_mode(), StartupMode::Cams(program(4)));
    master.exchange(&[(0x2080_0000, 5), (0, 5), (0x4000_0000, 5), (0x2021_0006, 0xA000_0000)]);
    assert_eq!(master.encoder.store_count(), 4);
}

#[test]
fn power_loss_during_store_loses_parameters() {
    let mut master = Master::with("steps=360&revolutions=1&cams=demo&fault=die-in-store:2");
    master.put(&[0x0600_0004, 0x8000_0000, 0, 0x0200_00B4]);
    master.write(0x8000_0000);
    assert_eq!((master.encoder.read(master.now), master.encoder.has_power()), (None, false));
    master.encoder.connect(master.now);
    assert_eq!((master.read(), master.encoder.store_count()), (0x8600_0000, 5));
    assert_eq!((master.encoder.memory().gear().total_steps(), master.encoder.memory().direction()), (0x01FF_FFFF, 3));
    assert_eq!(master.encoder.memory().program(program(1)).mask, 0xFF);
    // After the parameters have been set again, the encoder works.
    master.exchange(&[(0x0400_0001, 0x8200_0000), (0x0200_0168, 0xC200_0168), (0x0400_0001, 0xC400_0001)]);
    master.write(0x8000_0000);
    assert_eq!((master.read() >> 31, master.encoder.store_count()), (0, 6));
}

#[test]
fn power_loss_during_store_loses_program() {
    let mut master = Master::with("steps=360&revolutions=1&cams=demo&fault=die-in-store:1");
    master.put(&[0x2080_0001, 0x4000_0001]);
    master.write(0x8000_0000);
    master.power_cycle();
    assert_eq!(master.read(), 0x8600_0000);
    let memory = master.encoder.memory();
    assert_eq!([1, 2].map(|number| memory.program(program(number)).mask), [0, 0xFF]);
    assert_eq!(memory.gear().total_steps(), 360);
}

#[test]
fn worn_out_eeprom_keeps_nothing() {
    let mut master = Master::with("steps=360&revolutions=1&stores=499&position=4096");
    master.exchange(&[(0x0600_0004, 0xC600_0004), (0x8000_0000, 180), (0, 180)]);
    assert_eq!(master.encoder.store_count(), 500);
    for stores in [501, 502] {
        master.exchange(&[(0x0600_0003, 0xC600_0003), (0x8000_0000, 0x8600_0000), (0, 0x8600_0000)]);
        assert_eq!(master.encoder.store_count(), stores);
    }
    master.exchange(&[(0x2021_0001, 0xA1FF_FFFF)]);
}
