//! Tests of read-outs (references 3 and 7).

use super::*;

#[test]
fn read_outs_match_manual() {
    let mut master = Master::with(
        "serial=4000&steps=360&revolutions=2&direction=ccw&preset=12&zero-shift=34&position=0&temperature=25.3",
    );
    let cases = [
        (0x0, 0xA000_0FA0),
        (0x1, 0xA000_0168),
        (0x2, 0xA000_0002),
        (0x3, 0xA000_0004),
        (0x4, 0xA000_000C),
        (0x5, 0xA000_0022),
        (0x6, 0xA000_0000),
        (0x7, 0xA000_00CC),
        (0x8, 0xA000_03E8),
        (0x9, 0xA000_0001),
        (0xA, 0xA000_0002),
        (0xB, 0xA400_0000),
        (0xC, 0xA000_00FD),
        (0x0D, 0xA000_0040),
        (0x5D, 0xA000_0045),
        (0xFD, 0xA000_004F),
        (0xE, 0xA400_0000),
        (0x10D, 0xA400_0000),
        (0xFFFF, 0xA400_0000),
    ];
    for (number, expected) in cases {
        // Both 00000000h and 80000000h end a read-out.
        master.exchange(&[
            (0x2021_0000 | number, expected),
            (0, 34),
            (0x2021_0000 | number, expected),
            (0x8000_0000, 34),
        ]);
        master.exchange(&[(0, 34)]);
    }
    assert_eq!(master.encoder.store_count(), 3);
}

#[test]
fn unspecified_behaviour_is_configurable() {
    let cold = |bits: &str| Master::with(&format!("temperature=-10&temperature-bits={bits}"));
    cold("25").exchange(&[(0x2021_000C, 0xA1FF_FF9C)]);
    cold("16").exchange(&[(0x2021_000C, 0xA000_FF9C)]);
    Master::with("complement=bit").exchange(&[(0x2021_0003, 0xA000_0000)]);
    Master::with("complement=bit&direction=ccw").exchange(&[(0x2021_0003, 0xA000_0001)]);
}

#[test]
fn stale_read_out_lasts_configured_time() {
    let mut master = Master::with("stale=2&serial=4000&steps=360&revolutions=1&position=0");
    master.write(0x2021_0000);
    assert_eq!([0; 4].map(|_| master.read()), [0, 0, 0xA000_0FA0, 0xA000_0FA0]);
    master.write(0x2021_0001);
    assert_eq!([0; 4].map(|_| master.read()), [0xA000_0FA0, 0xA000_0FA0, 0xA000_0168, 0xA000_0168]);
}

#[test]
fn counts_operating_time() {
    let mut master = Master::with("operating-time=7");
    master.wait(25 * 60_000);
    master.exchange(&[(0x2021_0008, 0xA000_0009)]);
}
