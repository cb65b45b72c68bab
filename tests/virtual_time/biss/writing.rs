//! Tests of restoring and writing. A write uses as few registers and saves as possible, is planned first and recorded
//! afterwards, and is rejected if the base values have changed. Lost replies and wear are also tested.

use std::time::Duration;

use encoder_studio::devices::biss::jobs::{
    BissJob, Change, Commit, JobError, OperatorPresence, WEAR_LIMIT, device_key,
};
use encoder_studio::devices::biss::procedures::Error;
use encoder_studio::devices::biss::procedures::procedure::{Failure, Outcome};
use encoder_studio::devices::biss::profile::{BissProfile, Op, PlanError, PresetSetting, RestoreOptions};
use encoder_studio::devices::biss::protocol::{PositionFilter, PresetValue};
use encoder_studio::kinds::program;
use encoder_studio::profile::{ChangedItem, Consent, ProfileDocument};
use encoder_studio::store::{Entry, EntryKind, Intent, Logbook, Outcome as CountedFinding, read_text};
use encoder_studio::worker::NotStarted;
use encoder_studio::worker::commit::{ApprovedPlan, CycleCount};
use jiff::Timestamp;

use super::hands::{
    OPERATION_MODE_STATE, TestOperator, calibration, data, exchanges, filter, interrupted, preset, restore_of,
    wiegand_test,
};
use super::support::{Bench, Transport, at};

const WAYS: [Transport; 2] = [Transport::ConfigPin, Transport::Adapter];

/// Returns the profile with the given bytes changed in a bank.
fn with_bank_bytes(profile: &BissProfile, number: u8, bytes: &[(usize, u8)]) -> BissProfile {
    let mut wanted = profile.clone();
    let mut bank = profile.bank(number).unwrap();
    bytes.iter().for_each(|(place, byte)| bank.bytes[*place] = *byte);
    let image = wanted.data.iter_mut().find(|image| (image.first..=image.last).contains(&number)).unwrap();
    image.listed.retain(|listed| listed.bank.number != number);
    image.listed.push(bank.into());
    wanted
}

fn history(bench: &mut Bench) -> Vec<Entry> {
    let prepared = bench.prepare(filter()).unwrap();
    let logbook = Logbook::open(&bench.store().logbook_path()).unwrap();
    logbook.history(&device_key(&prepared.identity, true), 9).unwrap()
}

/// Returns the UBICOM writes to the given banks, each with its global address and the written byte.
fn writes_to_banks(bench: &Bench, banks: std::ops::RangeInclusive<u8>) -> Vec<(u16, u8)> {
    let is_write = |frame: &&Vec<u8>| frame[..3] == [0x80, 0x01, 0x02];
    let tap = bench.tap();
    let writes = tap.sent.iter().filter(is_write).map(|frame| (u16::from_le_bytes([frame[5], frame[6]]), frame[7]));
    let range = 0x40 + 0x40 * u16::from(*banks.start())..0x80 + 0x40 * u16::from(*banks.end());
    writes.filter(|(global, _)| range.contains(global)).collect()
}

/// Three bytes in one bank take three register writes and one save, in the plan and in the logbook.
#[test]
fn three_bytes_take_one_save() {
    let mut bench = Bench::new(Transport::ConfigPin, "");
    let saved = bench.save();
    let wanted = with_bank_bytes(&saved, 0x24, &[(0x10, 1), (0x11, 2), (0x30, 3)]);
    let prepared = bench.prepare(restore_of(&wanted)).unwrap();
    assert_eq!((prepared.plan.ops.len(), prepared.plan.write_cycles()), (1, 1));
    let Op::StoreData { registers, .. } = &prepared.plan.ops[0] else { panic!("{:?}", prepared.plan) };
    assert_eq!(registers.len(), 3);
    assert_eq!(prepared.unchanged, 1 + 6 + 64 * 64 - 3);
    let before = bench.flash_cycles();
    bench.tap().sent.clear();
    let committed = bench.commit_unattended(&prepared, Duration::ZERO).unwrap();
    // Bank 24h begins at address 0940h.
    assert_eq!(writes_to_banks(&bench, 0x04..=0x43), [(0x0950, 1), (0x0951, 2), (0x0970, 3)]);
    let commands = writes_to_banks(&bench, 0x00..=0x00);
    assert_eq!(commands, [(0x005A, 2), (0x005A, 3)], "opened for OEM data, and saved once");
    assert_eq!(bench.flash_cycles() - before, 1);
    let written = committed.written;
    assert_eq!((written.written, written.verified, written.write_cycles), (3, 3, 1));
    assert_eq!(written.outcomes, [Outcome::Stored { registers: 3 }]);
    let entry = &history(&mut bench)[0];
    assert_eq!(
        (entry.description.as_str(), entry.planned_cycles),
        ("0x24:0x10+2 OEM data: 0000 → 0102, 0x24:0x30 OEM data: 00 → 03", 1)
    );
    let conclusion = entry.conclusion.as_ref().unwrap();
    assert_eq!((&conclusion.outcome, conclusion.cycles_spent), (&CountedFinding::Done, 1));
    assert!(bench.prepare(restore_of(&wanted)).unwrap().plan.is_empty());

    // The backup restores the previous bytes.
    let text = read_text(&committed.backup.unwrap()).unwrap();
    let kept = ProfileDocument::parse(&text, program().studio.formats).unwrap();
    assert_eq!(kept.note.as_deref(), Some("before-image of a write"));
    let kept = kept.body.into_profile::<BissProfile>().unwrap();
    assert_eq!((kept.banks().count(), kept.bank(0x24).unwrap().bytes), (1, [0; 64]));
    bench.change(restore_of(&kept)).unwrap();
    assert_eq!(bench.save(), saved);
}

#[test]
fn restores_only_differences() {
    for way in WAYS {
        let mut bench = Bench::new(way, "position=0x20007");
        let saved = bench.save();
        let mut wanted = with_bank_bytes(&with_bank_bytes(&saved, 0x05, &[(0, 9)]), 0x43, &[(0x3F, 8)]);
        wanted.filter = Some(PositionFilter::Dynamic);
        let value = PresetValue::new(0x18000, 3).unwrap();
        wanted.preset = Some(PresetSetting { value, unknown: Default::default() });
        let prepared = bench.prepare(restore_of(&wanted)).unwrap();
        assert_eq!(prepared.plan.write_cycles(), 4, "motor data, OEM data, filter, preset value");
        let before = bench.flash_cycles();
        let written = bench.commit_unattended(&prepared, Duration::ZERO).unwrap().written;
        assert_eq!((written.ops, written.written, written.verified, written.write_cycles), (4, 4, 4, 4));
        assert_eq!(bench.flash_cycles() - before, 4);
        let now = bench.save();
        assert_eq!((&now.data, now.filter, &now.preset), (&wanted.data, wanted.filter, &wanted.preset));
        let place = bench.encoder(|encoder, now| encoder.position_at(now)).map(|own| (own.multiturn, own.singleturn));
        assert_eq!(place, Some((1, 7)), "the preset was stored and not carried out");
        assert!(bench.prepare(restore_of(&wanted)).unwrap().plan.is_empty());
        bench.change(restore_of(&saved)).unwrap();
        assert_eq!(bench.save(), saved, "{way:?}");
        assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
    }
}

#[test]
fn other_encoder_keeps_its_mounting() {
    let mut from = Bench::new(Transport::ConfigPin, "serial=1");
    from.change(preset(0x8000, 1)).unwrap();
    let profile = with_bank_bytes(&from.save(), 0x24, &[(0, 1)]);
    let mut bench = Bench::new(Transport::ConfigPin, "serial=2");
    let error = bench.prepare(restore_of(&profile)).unwrap_err();
    assert!(matches!(error, JobError::Plan(PlanError::OtherDevice { .. })), "{error}");
    let restore = |with_mounting| {
        let options = RestoreOptions { allow_other_device: true, with_mounting, ..RestoreOptions::default() };
        Change::Restore { profile: Box::new(profile.clone()), options }
    };
    let prepared = bench.prepare(restore(false)).unwrap();
    let left: Vec<String> = prepared.mounting_left.iter().map(ToString::to_string).collect();
    assert_eq!((prepared.plan.write_cycles(), left), (1, vec!["0x01:0x02+6".to_owned()]));
    assert_eq!(bench.prepare(restore(true)).unwrap().plan.write_cycles(), 2);
}

/// The values on which the plan is based change before it is executed. Nothing is written.
#[test]
fn changed_base_stops_plan() {
    type Case = (fn() -> Change, fn(&mut Bench), &'static str);
    let cases: [Case; 4] = [
        (data, |bench| drop(bench.change(Change::Write(vec![("0x24:0x00".parse().unwrap(), vec![9])]))), "bank 0x24"),
        (filter, |bench| drop(bench.change(filter())), "0x6E"),
        (|| preset(5, 5), |bench| drop(bench.change(preset(6, 6))), "0x01:0x02+6"),
        (calibration, |bench| drop(bench.change(filter())), "0x6E"),
    ];
    for (change, meddle, item) in cases {
        let mut bench = Bench::new(Transport::ConfigPin, "");
        let prepared = bench.prepare(change()).unwrap();
        meddle(&mut bench);
        let before = bench.flash_cycles();
        let error = bench.commit_unattended(&prepared, Duration::ZERO).unwrap_err();
        assert!(matches!(&error, JobError::Device(Error::Changed { item: own }) if own == item), "{error}");
        assert_eq!(bench.flash_cycles(), before);
    }
    // Another encoder with the same memory is connected to the same cable.
    let prepared = Bench::new(Transport::ConfigPin, "serial=1").prepare(data()).unwrap();
    let mut other = Bench::new(Transport::ConfigPin, "serial=2");
    let error = other.commit_unattended(&prepared, Duration::ZERO).unwrap_err();
    assert!(matches!(&error, JobError::Device(Error::Changed { item }) if item == "the encoder itself"), "{error}");
    assert_eq!(other.flash_bank(0x24), [0; 64]);
}

#[test]
fn consent_covers_only_its_plan() {
    let mut bench = Bench::new(Transport::ConfigPin, "");
    let shown = bench.prepare(filter()).unwrap();
    let prepared = bench.prepare(data()).unwrap();
    let consent = Consent::to(shown.plan.id());
    let attendance = OperatorPresence::Attended(Default::default());
    let commit = Commit { agreed: ApprovedPlan { prepared, consent, force_wear: false, undoes: None }, attendance };
    let error = bench.run(BissJob::Commit(Box::new(commit))).unwrap_err();
    assert_eq!(error.to_string(), "the consent is for another plan");
    assert_eq!(bench.flash_bank(0x24), [0; 64]);
}

/// An unknown number of write cycles must not count as 0 (issue 22.4).
#[test]
fn unknown_wear_needs_force() {
    let mut bench = Bench::new(Transport::ConfigPin, "");
    // A connection may already be recorded.
    let _ = std::fs::remove_file(bench.store().logbook_path());
    std::fs::create_dir_all(bench.store().logbook_path()).unwrap();
    let prepared = bench.prepare(filter()).unwrap();
    let (seen, before) = (prepared.cycles_seen, bench.flash_cycles());
    let error = bench.commit_unattended(&prepared, Duration::ZERO).unwrap_err();
    assert!(matches!(error, JobError::NotStarted(NotStarted::WearUnknown { .. })), "{error}");
    assert_eq!((seen, bench.flash_cycles()), (None, before));
    let consent = Consent::to(prepared.plan.id());
    let attendance =
        OperatorPresence::Unattended(encoder_studio::devices::biss::procedures::procedure::UnattendedOperator {
            patience: Duration::ZERO,
        });
    bench
        .run(BissJob::Commit(Box::new(Commit {
            agreed: ApprovedPlan { prepared, consent, force_wear: true, undoes: None },
            attendance,
        })))
        .unwrap();
    assert_eq!(bench.flash_cycles() - before, 1);
}

/// The manual allows 1000 write cycles (6.1), which are counted in the logbook. A plan beyond this limit must be
/// forced.
#[test]
fn worn_encoder_needs_force() {
    let mut bench = Bench::new(Transport::ConfigPin, "");
    let prepared = bench.prepare(preset(1, 1)).unwrap();
    assert_eq!(
        (prepared.cycles_seen, prepared.plan.write_cycles(), WEAR_LIMIT),
        (Some(CycleCount::complete(0)), 2, 1000)
    );
    let mut logbook = Logbook::open(&bench.store().logbook_path()).unwrap();
    let items = vec![ChangedItem::new("long ago", None, None)];
    let intent = Intent { kind: EntryKind::Write, items, planned_cycles: 999, backup: None, undoes: None };
    let id = logbook.record_intent(Timestamp::now(), &device_key(&prepared.identity, true), &intent).unwrap();
    logbook.record_outcome(id, Timestamp::now(), CountedFinding::Done, 999).unwrap();
    let prepared = bench.prepare(preset(1, 1)).unwrap();
    assert_eq!(prepared.cycles_seen, Some(CycleCount::complete(999)));
    let before = bench.flash_cycles();
    let error = bench.commit_unattended(&prepared, Duration::ZERO).unwrap_err();
    assert!(matches!(error, JobError::NotStarted(NotStarted::Worn { seen: 999, cost: 2, limit: 1000 })), "{error}");
    assert_eq!(bench.flash_cycles(), before);
    // One write cycle is left.
    let one = bench.prepare(filter()).unwrap();
    bench.commit_unattended(&one, Duration::ZERO).unwrap();
    let prepared = bench.prepare(preset(1, 1)).unwrap();
    let consent = Consent::to(prepared.plan.id());
    let attendance =
        OperatorPresence::Unattended(encoder_studio::devices::biss::procedures::procedure::UnattendedOperator {
            patience: Duration::ZERO,
        });
    bench
        .run(BissJob::Commit(Box::new(Commit {
            agreed: ApprovedPlan { prepared, consent, force_wear: true, undoes: None },
            attendance,
        })))
        .unwrap();
    assert_eq!(bench.flash_cycles() - before, 3);
}

/// At each exchange in turn, a reply or request is lost. A write is never repeated if that would use a write cycle, and
/// the report describes the actual result.
#[test]
fn tolerates_single_losses() {
    type Scene = (&'static str, fn() -> Change, u32);
    let scenes: [Scene; 3] = [("data", data, 1), ("filter", filter, 1), ("preset", || preset(7, 7), 2)];
    for (name, change, cost) in scenes {
        for lost in ["answer", "request"] {
            let mut original = Bench::new(Transport::ConfigPin, "");
            let prepared = original.prepare(change()).unwrap();
            let before = original.flash_cycles();
            let mut failures = 0;
            for exchange in exchanges(&original, &prepared) {
                let context = format!("{name}, {lost} {exchange} lost");
                let mut bench = original.copied();
                match lost {
                    "answer" => bench.tap().swallow_reply = Some(exchange),
                    _ => bench.tap().swallow_request = Some(exchange),
                }
                let ended = bench.commit_unattended(&prepared, Duration::ZERO);
                let spent = bench.flash_cycles() - before;
                assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE, "{context}");
                match ended {
                    Ok(committed) => {
                        assert_eq!(spent, cost, "{context}");
                        assert_eq!(committed.written.verified, committed.written.written, "{context}");
                    }
                    // A command that was not received and must not be sent twice.
                    Err(error) => {
                        failures += 1;
                        assert_eq!(lost, "request", "{context}: {error}");
                        let told = interrupted(error);
                        let unheard = matches!(told.cause, Failure::Status { .. } | Failure::NotVerified { .. });
                        assert!(unheard, "{context}: {told}");
                        assert_eq!(told.end_state.standing, None, "{context}");
                        assert!(told.done.write_cycles >= u64::from(spent) && spent < cost, "{context}");
                    }
                }
            }
            assert_eq!(failures > 0, lost == "request", "{name}");
        }
    }
}

/// A Wiegand result cannot be read back, so it is reported as unclear if it may not have been saved.
#[test]
fn reports_unverifiable_results_as_unclear() {
    let mut original = Bench::new(Transport::ConfigPin, "");
    let prepared = original.prepare(wiegand_test(true)).unwrap();
    for lost in ["answer", "request"] {
        let mut bench = original.copied();
        let mut hands = TestOperator::on(&bench);
        let (tap, counter) = (bench.tap_handle(), bench.counter());
        let commit = hands.attended_commit_job(&prepared);
        let error = bench
            .run_watched(commit, &mut |news| {
                hands.hear(news);
                if news.step == encoder_studio::devices::biss::procedures::procedure::ProcedureStep::Save {
                    let next = Some(counter());
                    match lost {
                        "answer" => tap.lock().unwrap().swallow_reply = next,
                        _ => tap.lock().unwrap().swallow_request = next,
                    }
                }
            })
            .unwrap_err();
        let told = interrupted(*error);
        assert!(matches!(told.cause, Failure::Device(Error::Unclear { value: 5, .. })), "{lost}: {told}");
        assert_eq!((told.end_state.standing, told.done.write_cycles), (None, 1));
        assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
    }
}

#[test]
fn noisy_writes_are_correct_or_fail() {
    let (mut right, mut told) = (0, 0);
    for noise in ["drop:0.005", "flip:0.005", "garbage:0.005"] {
        for seed in 0..6 {
            let mut quiet = Bench::new(Transport::ConfigPin, &format!("seed={seed}"));
            let prepared = quiet.prepare(data()).unwrap();
            let mut bench = Bench::new(Transport::ConfigPin, &format!("seed={seed}&fault={noise}"));
            match bench.commit_unattended(&prepared, Duration::ZERO) {
                Ok(_) => {
                    right += 1;
                    assert_eq!(bench.flash_bank(0x25)[0], 0xA4, "{noise}, seed {seed}");
                    assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE, "{noise}, seed {seed}");
                }
                Err(JobError::Interrupted { interrupted, .. }) => {
                    told += 1;
                    super::hands::assert_reported_state(
                        &interrupted.end_state,
                        &bench,
                        &format!("{noise}, seed {seed}"),
                    );
                }
                Err(_) => told += 1,
            }
        }
    }
    assert!(right >= 12, "{right} right, {told} told");
}

/// Registers that no procedure uses are written one by one, at the cost given in the register description.
#[test]
fn writes_and_reads_back_single_register() {
    let mut bench = Bench::new(Transport::ConfigPin, "");
    let write = |place: &str, byte| Change::Write(vec![(place.parse().unwrap(), vec![byte])]);
    let prepared = bench.prepare(write("0x40", 5)).unwrap();
    assert_eq!(prepared.plan.write_cycles(), 0);
    let written = bench.commit_unattended(&prepared, Duration::ZERO).unwrap().written;
    assert_eq!((written.verified, written.write_cycles, bench.encoder_reads(at("0x40"))), (1, 0, Some(5)));
    // The kit encoder has no register at this address and rejects the write.
    let prepared = bench.prepare(write("0x50", 1)).unwrap();
    let told = interrupted(bench.commit_unattended(&prepared, Duration::ZERO).unwrap_err());
    assert!(matches!(told.cause, Failure::Device(Error::Refused { .. })), "{told}");
    assert_eq!((told.done.write_cycles, told.end_state.standing), (0, None));
    for place in ["0x6A", "0x6B", "0x00:0x1A", "0x01:0x02"] {
        let error = bench.prepare(write(place, 1)).unwrap_err();
        assert!(matches!(error, JobError::Plan(PlanError::Guarded { .. })), "{place}: {error}");
    }
    let error = bench.prepare(write("0x66", 1)).unwrap_err();
    assert!(matches!(error, JobError::Plan(PlanError::ReadOnly { .. })), "{error}");
    let nothing = bench.prepare(Change::Write(Vec::new())).unwrap();
    assert!(nothing.plan.is_empty());
    assert!(bench.commit_unattended(&nothing, Duration::ZERO).unwrap().backup.is_none());
}
