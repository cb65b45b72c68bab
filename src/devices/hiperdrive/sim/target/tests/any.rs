//! Property tests with arbitrary input. Nothing panics, and the target continues to reply.

use proptest::prelude::*;

use super::*;

fn answers(host: &mut Host) {
    host.wait(100);
    let now = host.now;
    *host = Host { target: host.target.connect_from(PEER), now, session: 0 };
    host.register();
    host.is_asking("0E 03 20 64 24 01 30 11", "8E 00 00 00 67 12");
}

/// Generates frames from the reference with random changes.
fn corrupt_frame() -> impl Strategy<Value = Vec<u8>> {
    let messages = [OPEN, CLOSE, "0E 03 20 65 24 01 30 6B", "10 03 20 64 24 01 30 2F 01 00", "01 02 20 01 24 01"];
    let message = proptest::sample::select(messages.to_vec()).prop_map(|text| unconnected(&bytes(text)));
    let data = prop_oneof![message, any::<Vec<u8>>()];
    let command = prop_oneof![Just(0x6F_u16), Just(0x70), Just(0x65), Just(0x63), any::<u16>()];
    (command, data, proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4)).prop_map(
        |(command, data, changes)| {
            let mut data = data;
            for (at, byte) in changes {
                if !data.is_empty() {
                    let place = at.index(data.len());
                    data[place] = byte;
                }
            }
            frame(command, 0, &data)
        },
    )
}

proptest! {
    #[test]
    fn target_survives_any_stream(stream: Vec<Vec<u8>>) {
        let mut host = Host::new("");
        for bytes in &stream {
            host.bytes(bytes);
        }
        answers(&mut host);
    }

    #[test]
    fn target_survives_any_frame(frames in proptest::collection::vec(corrupt_frame(), 1..20), topology in 0..3_u8) {
        let mut host = Host::new(["", "hub=4", "hub=8"][usize::from(topology)]);
        for mut frame in frames {
            frame[4..8].copy_from_slice(&host.session.to_le_bytes());
            host.bytes(&frame);
            host.datagrams();
        }
        answers(&mut host);
    }

    /// Any datagram is counted exactly once.
    #[test]
    fn target_survives_any_datagram(
        packets in proptest::collection::vec(
            prop_oneof![
                any::<Vec<u8>>().prop_map(|bytes| (None, bytes)),
                (any::<u32>(), any::<[u8; 16]>()).prop_map(|(sequence, data)| (Some(sequence), data.to_vec())),
                (0..50_u32, any::<[u8; 16]>()).prop_map(|(sequence, data)| (Some(sequence), data.to_vec())),
            ],
            1..60,
        ),
        cut: prop::sample::Index,
    ) {
        let mut host = Host::opened("");
        for (sequence, data) in &packets {
            match sequence {
                Some(sequence) => host.packet(*sequence, 1, data),
                None => host.target.on_datagram(host.now, FROM, data),
            }
            host.wait(1);
            host.datagrams();
        }
        let figures = host.target.traffic_counters();
        let counted = figures.packets + figures.stale + figures.malformed + figures.foreign;
        prop_assert_eq!(counted, packets.len() as u64);
        host.packet(7, 1, &vec![0; cut.index(100)]);
        answers(&mut host);
    }
}
