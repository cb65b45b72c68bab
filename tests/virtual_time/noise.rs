//! Noise on the line. A displayed value must be correct, or an error is reported. Only undetectable damage may lead to
//! a wrong value, and the trace then contains the damaged frame.

use encoder_studio::devices::hiperface::jobs::{Change, HiperfaceJob, HiperfaceOutput, JobError, Value};
use encoder_studio::devices::hiperface::profile::{FieldRange, HiperfaceProfile, Item};
use encoder_studio::sim::SimulatedFaults;

use crate::support::{Desk, backup, bytes, exchanges, xor};

const NOISE: [&str; 5] = ["drop:0.02", "flip:0.02", "drop:0.02,flip:0.02", "garbage:0.02", "flip:0.02,garbage:0.02"];

/// Returns an encoder on a noisy line. It has a name plate and three data fields with varied content.
fn noisy_desk(seed: u8, noise: &str) -> Desk {
    let mut desk = Desk::new(&format!("seed={seed}&codes=2:66&position={}", u32::from(seed) * 64_123));
    desk.remember_code(2, 0x66);
    for (number, status) in [(1, 0xE8), (2, 0xCB), (3, 0xC7)] {
        let status = encoder_studio::devices::hiperface::protocol::DataFieldStatus::from_byte(status);
        desk.change(Change::CreateField { number, status }).unwrap();
        let bytes = bytes(seed.wrapping_add(number), status.size().bytes());
        desk.change(Change::Store(vec![(FieldRange::new(number, 0, bytes.len()), bytes)])).unwrap();
    }
    set_noise(&desk, noise);
    let mut noisy = desk.copied();
    noisy.remember_code(2, 0x66);
    noisy
}

fn set_noise(desk: &Desk, noise: &str) {
    desk.bus().set_faults(&noise.parse::<SimulatedFaults>().unwrap());
}

/// Returns whether the bytes are a valid reply to 42h that contains this position.
fn is_position_reply(reply: &[u8], position: u32) -> bool {
    let [a, b, c, d] = position.to_be_bytes();
    reply.len() == 7 && reply[0] == 0x40 && reply[1] & 0x7F == 0x42 && reply[2..6] == [a, b, c, d] && xor(reply) == 0
}

#[test]
fn position_is_correct_or_fails() {
    let (mut read, mut failed, mut wrong) = (0, 0, 0);
    for noise in NOISE {
        for seed in 0..8 {
            let mut desk = noisy_desk(seed, noise);
            let now = encoder_studio::link::Clock::now(&*desk.clock);
            let truth = desk.bus().encoders()[0].position(now);
            for _ in 0..100 {
                desk.trace.lock().unwrap().clear();
                match desk.run(HiperfaceJob::Position(None)) {
                    Ok(HiperfaceOutput::Position(reading)) => {
                        read += 1;
                        if reading.raw != truth {
                            wrong += 1;
                            let trace = desk.trace.lock().unwrap();
                            let replies = exchanges(&trace);
                            let shown =
                                replies.iter().filter(|(request, _)| request == "40 42 02").flat_map(|(_, r)| r);
                            let proof = shown.filter(|reply| is_position_reply(reply, reading.raw)).count();
                            assert!(proof > 0, "{noise}, seed {seed}: {:08X} from nowhere: {trace:?}", reading.raw);
                        }
                    }
                    Ok(other) => panic!("{other:?}"),
                    Err(JobError::Device(_)) => failed += 1,
                    Err(other) => panic!("{other:?}"),
                }
            }
        }
    }
    println!("positions: {read} read, {failed} errors, {wrong} wrong from undetectable frames");
    assert!(read > 3000, "{read} of 4000 read");
    // Damage is not detected if the same bit is inverted in two of nine bytes, not counting one in the head: 36 · 0.02²
    // / 8 per frame, or 0.2 %.
    assert!(wrong * 100 < read, "{wrong} of {read} wrong");
}

/// Returns byte `at` of the field, as contained in a valid reply to 4Ah.
fn reply_field_byte(reply: &[u8], field: u8, at: usize) -> Option<u8> {
    let [0x40, command, f, start, count, data @ .., _] = reply else { return None };
    let right = command & 0x7F == 0x4A && *f == field && data.len() == usize::from(*count) && xor(reply) == 0;
    right.then(|| data.get(at.checked_sub(usize::from(*start))?).copied())?
}

#[test]
fn field_is_correct_or_fails() {
    let (mut read, mut failed, mut wrong) = (0, 0, 0);
    for noise in NOISE {
        for seed in 10..18 {
            let mut desk = noisy_desk(seed, noise);
            let truth = desk.memory();
            for round in 0..40 {
                let field = round % 4;
                let size = truth[field].1.len();
                let start = (round * 7) % size;
                let count = (size - start).min(1 + round * 3);
                let number = field as u8;
                desk.trace.lock().unwrap().clear();
                match desk.run(HiperfaceJob::Read(Item::Field(FieldRange::new(number, start, count)))) {
                    Ok(HiperfaceOutput::Value(Value::Bytes(got))) => {
                        read += 1;
                        assert_eq!(got.len(), count);
                        let expected = &truth[field].1[start..start + count];
                        if got != expected {
                            wrong += 1;
                            let trace = desk.trace.lock().unwrap();
                            let exchanges = exchanges(&trace);
                            for (at, byte) in got.iter().enumerate() {
                                let mut replies = exchanges.iter().flat_map(|(_, replies)| replies);
                                let proof =
                                    replies.any(|reply| reply_field_byte(reply, number, start + at) == Some(*byte));
                                assert!(proof, "{noise}, seed {seed}: byte {at} of field {field} from nowhere");
                            }
                        }
                    }
                    Ok(other) => panic!("{other:?}"),
                    Err(JobError::Device(_)) => failed += 1,
                    Err(other) => panic!("{other:?}"),
                }
            }
        }
    }
    println!("field reads: {read} read, {failed} errors, {wrong} wrong from undetectable frames");
    assert!(read > 800, "{read} of 1600 read");
    assert!(wrong * 100 < read, "{wrong} of {read} wrong");
}

/// Compares the content of two saved profiles: identity, fields and counter.
fn assert_same(got: &HiperfaceProfile, truth: &HiperfaceProfile, context: &str) {
    assert_eq!(got.identity, truth.identity, "{context}");
    assert_eq!(got.interface, truth.interface, "{context}");
    assert_eq!(got.fields, truth.fields, "{context}");
    assert_eq!(got.recorded.counter, truth.recorded.counter, "{context}");
}

#[test]
fn save_is_correct_or_fails() {
    let (mut saved, mut failed) = (0, 0);
    // A low level of noise is harder to handle, because the first damage may be one that cannot be detected.
    for noise in ["drop:0.02", "flip:0.02", "drop:0.02,flip:0.02", "garbage:0.02", "flip:0.005", "drop:0.005"] {
        for seed in 0..60 {
            let mut desk = noisy_desk(seed, "");
            let truth = desk.save().unwrap();
            let mut desk = desk.copied();
            desk.remember_code(2, 0x66);
            set_noise(&desk, noise);
            match desk.save() {
                Ok(profile) => {
                    saved += 1;
                    assert_same(&profile, &truth, &format!("{noise}, seed {seed}"));
                }
                Err(JobError::Device(_)) => failed += 1,
                Err(other) => panic!("{other:?}"),
            }
        }
    }
    println!("saves: {saved} right, {failed} errors");
    assert!(saved > 180, "{saved} of 360 saved");
}

#[test]
fn second_restore_completes_interrupted_restore() {
    let (mut at_once, mut described, mut before_any) = (0, 0, 0);
    for noise in NOISE {
        for seed in 0..12 {
            let mut desk = noisy_desk(seed, "");
            let mut wanted = desk.save().unwrap();
            for field in &mut wanted.fields {
                let bytes = field.bytes.as_mut().unwrap();
                bytes[3] ^= 0x5A;
                let middle = bytes.len() / 2;
                bytes[middle..middle + 4].copy_from_slice(&[seed, 2, 1, 0xA7]);
            }
            let (before, worn) = (desk.memory(), desk.wear());
            set_noise(&desk, noise);
            let context = format!("{noise}, seed {seed}");
            match desk.restore(&wanted) {
                Ok(done) => {
                    at_once += 1;
                    assert_eq!(done.written.verified, done.written.written, "{context}");
                    assert!(done.written.write_cycles >= desk.wear() - worn, "{context}");
                }
                Err(JobError::Interrupted { interrupted, backup: path, planned, .. }) => {
                    described += 1;
                    assert!(interrupted.done.ops <= planned, "{context}");
                    assert!(interrupted.done.write_cycles >= desk.wear() - worn, "{context}: {interrupted:?}");
                    let kept = backup(&path);
                    for field in kept.fields {
                        assert_eq!(field.bytes.as_ref(), Some(&before[usize::from(field.number)].1), "{context}");
                    }
                }
                Err(error) => {
                    before_any += 1;
                    assert_eq!(desk.memory(), before, "{context}: {error}");
                    assert_eq!(desk.wear(), worn, "{context}: {error}");
                }
            }
            set_noise(&desk, "");
            desk.restore(&wanted).unwrap();
            for (field, (status, bytes)) in wanted.fields.iter().zip(desk.memory()) {
                assert_eq!((field.status.byte(), field.bytes.as_ref()), (status, Some(&bytes)), "{context}");
            }
        }
    }
    println!("restores: {at_once} at once, {described} interrupted, {before_any} given up before the first write");
    assert!(at_once > 10);
}
