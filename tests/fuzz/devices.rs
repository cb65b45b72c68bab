//! Fuzz tests of virtual devices. They must not panic or send without end.

use std::time::Duration;

use encoder_studio::buses::bridge::sim::Adapter;
use encoder_studio::devices::{biss, hiperdrive, hiperface, interbus};
use encoder_studio::kinds::attachable_kinds;
use encoder_studio::sim::ByteDevice;
use encoder_studio::units::Moment;

use crate::{fuzz, hex_lines};

/// Maximum number of bytes that a device may send in 1.5 s. An adapter that streams at full speed sends the most.
const MAX_SENT_BYTES: usize = 1_500_000;

/// Passes an input to a device nine bytes at a time, polls it for another second, and returns the number of bytes sent.
fn receive(device: &mut dyn ByteDevice, bytes: &[u8]) -> usize {
    let (mut now, mut sent) = (Moment::START, 0);
    device.connect(now);
    for part in bytes.chunks(9) {
        device.on_bytes(now, part);
        now = now + Duration::from_millis(30);
        sent += device.poll(now).len();
    }
    sent + device.poll(now + Duration::from_secs(1)).len()
}

#[test]
fn virtual_devices() {
    let lines = [
        include_str!("corpus/bridge.txt"),
        include_str!("corpus/ubicom.txt"),
        include_str!("corpus/ethernet_ip.txt"),
        include_str!("corpus/interbus.txt"),
    ];
    let vectors: Vec<&str> =
        include_str!("../vectors/hiperface.txt").lines().filter_map(|line| line.strip_prefix("> ")).collect();
    let examples = [lines.map(hex_lines).concat(), hex_lines(&vectors.join("\n"))].concat();
    fuzz("virtual devices", &examples, |bytes| {
        let mut bus = hiperface::sim::Bus::new(&hiperface::sim::Config::from_pairs(&[]).unwrap());
        let mut port = biss::sim::UbicomPort::new(&biss::sim::Config::from_pairs(&[]).unwrap());
        let mut adapter = Adapter::from_pairs(&[], attachable_kinds()).unwrap();
        let gateway = interbus::sim::Gateway::new(&interbus::sim::Config::from_pairs(&[]).unwrap());
        let target = hiperdrive::sim::Target::new(&hiperdrive::sim::Config::from_pairs(&[]).unwrap());
        let mut connection = target.connect_from(std::net::Ipv4Addr::LOCALHOST);
        let devices: [&mut dyn ByteDevice; 5] =
            [&mut bus, &mut port, &mut adapter, &mut gateway.new_connection(), &mut connection];
        for device in devices {
            let sent = receive(device, bytes);
            assert!(sent <= MAX_SENT_BYTES, "{sent} bytes");
        }
    });
}
