//! Tests of injected faults.

use super::*;

const GET_107: &str = "0E 03 20 65 24 01 30 6B";
const SAVE: &str = "10 03 20 64 24 01 30 2F 01 00";

fn get(host: &mut Host) -> Option<(u32, Vec<u8>)> {
    host.frame(0x6F, &unconnected(&bytes(GET_107)))
}

#[test]
fn power_cycle_keeps_only_saved_values() {
    let mut host = Host::new("");
    let (get, set) = ("0E 03 20 65 24 01 30 A6", "10 03 20 65 24 01 30 A6 C8 00");
    host.is_asking(set, "90 00 00 00");
    host.target.power_cycle();
    assert_eq!(host.frame(0x6F, &unconnected(&bytes(get))).map(|(status, _)| status), Some(0x64));
    host.register();
    host.is_asking(get, "8E 00 00 00 5E 01");
    host.is_asking(set, "90 00 00 00");
    host.is_asking(SAVE, "90 00 00 00");
    host.wait(200);
    host.target.power_cycle();
    host.register();
    host.is_asking(get, "8E 00 00 00 C8 00");
    // The values −1 and −2 concern parameters of the adapter itself. Parameter 166 belongs to the drive.
    for recall in ["10 03 20 64 24 01 30 2F FF FF", "10 03 20 64 24 01 30 2F FE FF"] {
        host.is_asking(recall, "90 00 00 00");
        host.wait(200);
        host.is_asking(get, "8E 00 00 00 C8 00");
    }
    // The value −3 also saves.
    host.is_asking("10 03 20 64 24 01 30 2F FD FF", "90 00 00 00");
    host.wait(200);
    host.target.power_cycle();
    host.register();
    host.is_asking(get, "8E 00 00 00 5E 01");
    assert_eq!(host.target.with_station(|station| station.save_count()), 2);
}

/// If the supply fails during a save, only the first half of the values is saved, in the order of their numbers: 152,
/// but not 186.
#[test]
fn power_fails_during_save() {
    let mut host = Host::new("fault=die-in-store:2");
    host.is_asking(SAVE, "90 00 00 00");
    host.wait(200);
    for set in ["10 03 20 65 24 01 30 98 00", "10 03 20 65 24 01 30 BA 0A 00"] {
        host.is_asking(set, "90 00 00 00");
    }
    assert_eq!(host.open(OPEN), OPENED);
    host.is_asking(SAVE, "90 00 00 00");
    host.is_asking("0E 03 20 64 24 01 30 2F", "8E 00 00 00 01 00");
    host.datagrams();
    host.wait(100);
    assert_eq!(get(&mut host), None);
    host.target.on_datagram(host.now, FROM, &frame(0x63, 0, &[]));
    host.wait(1000);
    assert_eq!((host.datagrams(), get(&mut host)), (vec![], None));
    // The target replies again after the next connection.
    host.target.connect(host.now);
    assert_eq!(get(&mut host).map(|(status, _)| status), Some(0x64));
    host.register();
    host.is_asking("0E 03 20 65 24 01 30 98", "8E 00 00 00 00");
    host.is_asking("0E 03 20 65 24 01 30 BA", "8E 00 00 00 14 00");
    host.is_asking(SAVE, "90 00 00 00");
    host.wait(200);
    host.is_asking(GET_107, "8E 00 00 00 00 00 00 00");
}

/// After the given number of frames and packets, the target no longer receives or replies, and its drives lose their
/// master.
#[test]
fn silent_target_ignores_requests() {
    // RegisterSession, ForwardOpen and the fifteen packets that start the motion.
    let mut host = Host::opened("fault=silent-after:17");
    host.words(1, &[0x0400, 0x0401, 0x0409, 0x0439, 0x0479]);
    host.wait(10);
    assert!(host.status().is_some());
    for sequence in 16..40 {
        host.word(sequence, 0x0479);
        host.wait(10);
    }
    assert_eq!((host.status(), get(&mut host)), (None, None));
    let stands = host.target.with_station(|station| {
        let drive = crate::devices::hiperdrive::protocol::DriveNumber::FIRST;
        station.drive(drive).map(|drive| drive.actual_values(host.now).speed)
    });
    assert_eq!(stands, Some(0));
}

#[test]
fn drops_or_corrupts_replies_and_packets() {
    let mut late = Host::bare("fault=delay:7");
    assert_eq!(late.bytes(&bytes(REGISTER)), [0; 0]);
    late.wait(3);
    assert_eq!(late.target.poll(late.now).len(), 28);

    let mut lossy = Host::bare("fault=drop:1");
    assert_eq!(lossy.bytes(&bytes(REGISTER)), [0; 0]);
    lossy.target.on_datagram(lossy.now, FROM, &frame(0x63, 0, &[]));
    assert_eq!((lossy.datagrams(), lossy.target.traffic_counters().frames), (vec![], 1));

    for (fault, damaged) in [("flip:1", 1..2), ("garbage:1", 30..224)] {
        let mut noisy = Host::new("");
        noisy.target.set_faults(&fault.parse().unwrap());
        let reply = noisy.bytes(&frame(0x64, 0, &[]));
        let whole = frame(0x64, 0, &[0, 0]);
        let bits: u32 = reply.iter().zip(&whole).map(|(got, sent)| (got ^ sent).count_ones()).sum();
        assert_eq!(reply.len(), whole.len());
        assert!(damaged.contains(&bits), "{fault}: {bits}");
    }
}

/// A connection survives the loss of a fifth of all packets, because it ends only after eight lost packets in a row.
#[test]
fn lossy_line_keeps_master() {
    let mut host = Host::opened("seed=3");
    host.target.set_faults(&"drop:0.2".parse().unwrap());
    host.words(1, &[0x0400; 100]);
    let came = host.datagrams().len();
    assert!((180..300).contains(&came), "{came} of some 300");
    let figures = host.target.traffic_counters();
    assert!((180..300).contains(&figures.packets), "{figures:?}");
}
