//! Property tests with arbitrary input: nothing panics, and the invariants hold.

use proptest::prelude::*;

use super::gateway::Host;
use super::*;
use crate::devices::interbus::protocol::ProgramNumber;
use crate::sim::ByteDevice;

/// Generates words that are more often valid than purely random ones.
fn word() -> impl Strategy<Value = u32> {
    let of_parameters = (0_u32..16, 0_u32..0x3000).prop_map(|(code, data)| code << 25 | data);
    let of_cams = (0x20_u32..0x70, any::<u32>()).prop_map(|(code, data)| code << 24 | data & 0xFF_FFFF);
    let selected = (0_u32..10).prop_map(|number| 0x2080_0000 | number);
    let known = prop::sample::select(vec![0, 0x8000_0000, 0x4000_0000, 0x6000_0000, 0x2040_0001, 0x2021_0009]);
    prop_oneof![of_parameters, of_cams, selected, known, any::<u32>()]
}

proptest! {
    #[test]
    fn arbitrary_words_keep_memory_consistent(words in prop::collection::vec((word(), 0_u64..30), 0..60), stores in 495_u32..505) {
        let mut master = Master::with(&format!("stale=1&busy=5&cams=demo&steps=360&revolutions=1&stores={stores}&rpm=60"));
        for (word, pause) in words {
            let before = master.encoder.store_count();
            master.write(word);
            master.wait(pause);
            master.read();
            let (encoder, memory) = (&master.encoder, master.encoder.memory());
            // A word uses at most one EEPROM write cycle, and a word with the prefix 000 uses none.
            prop_assert!(encoder.store_count() == before || encoder.store_count() == before + 1 && word >> 29 != 0);
            prop_assert!(memory.gear().total_steps() <= 8192 * memory.gear().turns());
            prop_assert!(ProgramNumber::all().all(|number| memory.program(number).cams.iter().all(Option::is_some)));
        }
        // Without power, only stored values remain.
        master.encoder.disconnect();
        prop_assert!(master.encoder.memory() == master.encoder.stored());
    }

    #[test]
    fn arbitrary_bytes_do_not_panic(pieces in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..40), 0..20)) {
        let mut host = Host::with("encoders=3&fault=flip:0.1,drop:0.1,garbage:0.1");
        for piece in pieces {
            host.gateway.on_bytes(host.now, &piece);
            host.now = host.now + Duration::from_millis(3);
            host.gateway.poll(host.now);
        }
    }

    /// A complete request receives exactly one reply, with the same transaction number, unit and function.
    #[test]
    fn every_request_gets_one_matching_reply(number in any::<u16>(), unit in any::<u8>(), pdu in prop::collection::vec(any::<u8>(), 1..60), function in 0_u8..20) {
        let mut host = Host::with("encoders=3");
        let pdu: Vec<u8> = [&[function][..], &pdu[1..]].concat();
        let length = u8::try_from(pdu.len() + 1).unwrap();
        let [high, low] = number.to_be_bytes();
        let request = [&[high, low, 0, 0, 0, length, unit][..], &pdu].concat();
        host.gateway.on_bytes(host.now, &request);
        let reply = host.gateway.poll(host.now + Duration::from_millis(3));
        prop_assert_eq!(&reply[..4], &[high, low, 0, 0]);
        prop_assert_eq!(usize::from(reply[5]), reply.len() - 6);
        prop_assert_eq!((reply[6], reply[7] & 0x7F), (unit, function));
    }
}
