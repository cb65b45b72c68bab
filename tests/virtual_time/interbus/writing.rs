//! Only differences are written and read back, with one store per operation, unless the change is rejected.

use std::path::Path;
use std::time::Duration;

use encoder_studio::devices::interbus::jobs::{
    Change, ChangeKind, Commit, InterbusJob, InterbusOutput, JobError, JobStep, WEAR_LIMIT, WearAfterPlan,
};
use encoder_studio::devices::interbus::procedures::Error;
use encoder_studio::devices::interbus::procedures::write::EndState;
use encoder_studio::devices::interbus::profile::InterbusProfile;
use encoder_studio::devices::interbus::profile::{Image, Item, ItemValue, Op, RestoreOptions};
use encoder_studio::devices::interbus::protocol::{CamNumber, ProgramNumber, StartupMode};
use encoder_studio::link::{CancelToken, Clock};
use encoder_studio::profile::{Consent, ProfileDocument};
use encoder_studio::store::{DeviceKey, Logbook, Store, read_text};
use encoder_studio::worker::commit::CycleCount;
use encoder_studio::worker::{Event, JobId, NotStarted, Progress};

use super::support::{Stand, cam, program};

const SCALED: &str = "steps=3600&revolutions=1&preset=10&serial=77&cams=demo&position=100";

/// Returns the current content of the encoder, including the given programs.
fn image(stand: &mut Stand, programs: &[u8]) -> Image {
    let survey = match stand.run(InterbusJob::Survey).unwrap() {
        InterbusOutput::Surveyed(survey) => *survey,
        other => panic!("{other:?}"),
    };
    let mut image = Image::from_parameters(survey.parameters);
    for (number, own) in stand.programs(programs) {
        *image.program_mut(program(number)).unwrap() = Some(own);
    }
    image
}

fn edited(stand: &mut Stand, programs: &[u8], edit: impl FnOnce(&mut Image)) -> Change {
    let mut wanted = image(stand, programs);
    edit(&mut wanted);
    stand.trace.lock().unwrap().clear();
    Change::Write(Box::new(wanted))
}

/// Returns the words that set a value, excluding requests for values and words of normal operation.
fn setting(stand: &Stand) -> Vec<u32> {
    let questions = |word: &u32| matches!(word >> 16, 0x2020 | 0x2021);
    stand.sent().into_iter().filter(|word| *word != 0 && !questions(word)).collect()
}

#[test]
fn parameters_take_one_store() {
    for faults in ["", "&busy=80&stale=6"] {
        let mut stand = Stand::new(&format!("{SCALED}{faults}"));
        let before = stand.stores();
        let change = edited(&mut stand, &[], |wanted| {
            (wanted.parameters.steps, wanted.parameters.revolutions) = (20_000, 4);
            wanted.parameters.preset = 19_999;
        });
        let prepared = stand.prepare(change);
        assert_eq!((prepared.plan.ops.len(), prepared.plan.write_cycles()), (1, 1));
        assert_eq!((setting(&stand), stand.stores()), (vec![], before), "a plan writes nothing");
        let done = stand.commit(prepared).unwrap();
        assert_eq!((done.written.ops, done.written.written, done.written.verified), (1, 3, 3));
        assert_eq!((done.written.write_cycles, stand.stores()), (1, before + 1));
        // 20 000 (4E20h) is possible only after 4 turns are set.
        assert_eq!(setting(&stand), [0x0400_0004, 0x0200_4E20, 0x0800_4E1F, 0x8000_0000]);
        assert_eq!(stand.left(), (0, StartupMode::K3));
        let kept = stand.gateway.with_encoder(|encoder| encoder.stored().clone());
        assert_eq!((kept.gear().total_steps(), kept.gear().turns(), kept.preset()), (20_000, 4, 19_999));
        // The session now knows the gear.
        assert_eq!(stand.session.take_sample().unwrap().gear.map(|gear| gear.total_steps()), Some(20_000));
        let backup = done.backup.unwrap();
        let document =
            ProfileDocument::parse(&read_text(&backup).unwrap(), encoder_studio::kinds::program().studio.formats)
                .unwrap();
        assert_eq!(document.body.get::<InterbusProfile>().unwrap().image.parameters.preset, 10);
    }
}

/// Four of 64 cams differ, in two programs. The issue specifies the number of words.
#[test]
fn sends_only_changed_edges() {
    let all: Vec<u8> = (1..=8).collect();
    for faults in ["", "&busy=40&stale=3", "&selection=output", "&program=5"] {
        let mut stand = Stand::new(&format!("{SCALED}{faults}"));
        let (before, found) = (stand.stores(), stand.left().1);
        let change = edited(&mut stand, &all, |wanted| {
            for (number, own) in [(2, 1), (2, 6), (7, 0), (7, 7)] {
                let item = Item::Cam(program(number), CamNumber::new(own).unwrap());
                assert!(wanted.set_value(item, ItemValue::Cam(cam(3000 + u32::from(own), 7))));
            }
            assert!(wanted.set_value(Item::CamMask(program(7)), ItemValue::Mask(0x3C)));
        });
        let prepared = stand.prepare(change);
        assert_eq!((prepared.plan.ops.len(), prepared.plan.write_cycles()), (2, 2));
        stand.trace.lock().unwrap().clear();
        let done = stand.commit(prepared).unwrap();
        assert_eq!((done.written.ops, done.written.written, done.written.verified), (2, 5, 5), "{faults}");
        assert_eq!((done.written.write_cycles, stand.stores()), (2, before + 2), "{faults}");
        // Only edges are sent: their words begin with 010 or 011. In another mode, 40000000 would set a preset.
        let edges = setting(&stand).into_iter().filter(|word| matches!(word >> 29, 0b010 | 0b011)).count();
        assert_eq!(edges, 8, "{faults}");
        assert_eq!(stand.left(), (0, found), "{faults}");
        let kept = stand.gateway.with_encoder(|encoder| encoder.stored().clone());
        assert_eq!(kept.program(program(7)).cams[0], Some(cam(3000, 7)), "{faults}");
        assert_eq!((kept.program(program(7)).mask, kept.program(program(2)).cams[6]), (0x3C, Some(cam(3006, 7))));
        assert_eq!(kept.gear().total_steps(), 3600, "{faults}");
    }
}

#[test]
fn sets_shift_with_program_or_alone() {
    for (programs, edges, stores) in [(&[3][..], 1, 1), (&[], 0, 1)] {
        let mut stand = Stand::new(SCALED);
        let before = stand.stores();
        let change = edited(&mut stand, programs, |wanted| {
            assert!(wanted.set_value(Item::Shift, ItemValue::Number(8)));
            if edges > 0 {
                assert!(wanted.set_value(Item::CamMask(program(3)), ItemValue::Mask(0x11)));
            }
        });
        let prepared = stand.prepare(change);
        stand.commit(prepared).unwrap();
        assert_eq!(stand.stores(), before + stores);
        assert!(setting(&stand).contains(&0x2010_0008));
        assert_eq!(stand.gateway.with_encoder(|encoder| encoder.stored().shift().get()), 8);
    }
}

#[test]
fn preset_fires_once_at_standstill() {
    for found in ["", "&program=2"] {
        let mut stand = Stand::new(&format!("{SCALED}{found}"));
        let before = stand.left();
        let prepared = stand.prepare(Change::Preset { value: 1800 });
        assert_eq!((prepared.kind, prepared.plan.write_cycles()), (ChangeKind::Preset, 1));
        let done = stand.commit(prepared).unwrap();
        assert_eq!((done.written.ops, done.written.verified), (2, 2));
        assert_eq!(stand.sent().iter().filter(|word| **word == 0x4000_0000).count(), 1);
        assert_eq!(stand.left(), before);
        stand.run(InterbusJob::Select(StartupMode::K3)).unwrap();
        assert_eq!(stand.session.take_sample().unwrap().position(), Some(1800));
    }
}

#[test]
fn rejects_preset_while_turning() {
    let mut stand = Stand::new(SCALED);
    let prepared = stand.prepare(Change::Preset { value: 0 });
    stand.session.motor().unwrap().set_rpm(5.0);
    stand.trace.lock().unwrap().clear();
    let error = stand.commit(prepared).unwrap_err();
    assert!(matches!(error, JobError::Device(Error::Moving { .. })), "{error}");
    assert_eq!((setting(&stand), stand.left()), (vec![], (0, StartupMode::K3)));
}

#[test]
fn sets_default_and_reads_back() {
    let mut stand = Stand::new(SCALED);
    let before = stand.stores();
    let prepared = stand.prepare(Change::Default);
    let done = stand.commit(prepared).unwrap();
    assert_eq!((done.written.ops, done.written.write_cycles, stand.stores()), (1, 1, before + 1));
    assert!(setting(&stand).contains(&0x0E00_0000));
    let delivered = stand.gateway.with_encoder(|encoder| encoder.memory().gear().total_steps());
    assert_eq!(stand.session.take_sample().unwrap().gear.map(|gear| gear.total_steps()), Some(delivered));
}

#[test]
fn restore_keeps_mounting_of_other_encoder() {
    let mut first = Stand::new("steps=3600&revolutions=1&preset=99&serial=1&cams=demo");
    let profile = match first.run(InterbusJob::Save { programs: true }).unwrap() {
        InterbusOutput::Saved(profile) => profile,
        other => panic!("{other:?}"),
    };
    let mut other = Stand::new("steps=720&revolutions=1&preset=5&serial=2");
    let refused = other
        .run(InterbusJob::Prepare(Change::Restore { profile: profile.clone(), options: RestoreOptions::default() }));
    assert!(matches!(refused, Err(JobError::Plan(_))), "{refused:?}");
    let options = RestoreOptions { allow_other_device: true, ..RestoreOptions::default() };
    let prepared = other.prepare(Change::Restore { profile: profile.clone(), options });
    assert_eq!(prepared.mounting_left, [Item::Preset]);
    other.commit(prepared).unwrap();
    let kept = other.gateway.with_encoder(|encoder| encoder.stored().clone());
    assert_eq!((kept.gear().total_steps(), kept.preset()), (3600, 5));
    for number in ProgramNumber::all() {
        let wanted = profile.image.program(number).unwrap();
        assert_eq!((kept.program(number).mask, kept.program(number).cams), (wanted.mask, wanted.cams));
    }
    // When the write is repeated, nothing differs, and nothing is written.
    let (stores, prepared) = (other.stores(), other.prepare(Change::Restore { profile, options }));
    assert!(prepared.plan.is_empty());
    assert!(other.commit(prepared).unwrap().backup.is_none());
    assert_eq!(other.stores(), stores);
}

#[test]
fn change_since_plan_stops_write() {
    let moment = |stand: &Stand| stand.clock.now();
    // Another master sets the preset with 08000001 and returns to normal operation.
    let mut stand = Stand::new(SCALED);
    let change = edited(&mut stand, &[], |wanted| wanted.parameters.zero_shift = 5);
    let prepared = stand.prepare(change);
    let now = moment(&stand);
    stand.gateway.with_encoder(|encoder| [0x0800_0001, 0x8000_0000, 0].map(|word| encoder.write(now, word)));
    let error = stand.commit(prepared).unwrap_err();
    assert_eq!(error.to_string(), "preset has changed since the plan was made");
    assert_eq!(stand.left(), (0, StartupMode::K3));
    // Here it changes the mask of a program.
    let change = edited(&mut stand, &[4], |wanted| {
        assert!(wanted.set_value(Item::CamMask(program(4)), ItemValue::Mask(0xFF)));
    });
    let prepared = stand.prepare(change);
    let now = moment(&stand);
    let words = [0x2080_0004, 0x2040_0081, 0x8000_0000, 0x2080_0000, 0];
    stand.gateway.with_encoder(|encoder| words.map(|word| encoder.write(now, word)));
    let error = stand.commit(prepared).unwrap_err();
    assert_eq!(error.to_string(), "cam program 4 has changed since the plan was made");
}

#[test]
fn consent_covers_only_its_plan() {
    let mut stand = Stand::new(SCALED);
    let prepared = stand.prepare(Change::Preset { value: 1 });
    let consent = Consent::to(stand.prepare(Change::Preset { value: 2 }).plan.id());
    let commit = Commit { prepared, consent, force_wear: false, undoes: None };
    let error = stand.run(InterbusJob::Commit(Box::new(commit))).unwrap_err();
    assert!(matches!(error, JobError::NotStarted(NotStarted::OtherPlan)), "{error}");
}

#[test]
fn worn_eeprom_needs_force() {
    let mut stand = Stand::new(SCALED);
    let mut prepared = stand.prepare(Change::Default);
    for (seen, refused) in [(Some(WEAR_LIMIT - 2), false), (Some(WEAR_LIMIT - 1), true), (None, true)] {
        let seen = seen.map(CycleCount::complete);
        prepared.cycles_seen = seen;
        assert_eq!(matches!(prepared.wear_to_report(), Some(WearAfterPlan::Worn(_) | WearAfterPlan::Unknown)), refused);
        let prepared = stand.prepare(Change::Default);
        let prepared = encoder_studio::devices::interbus::jobs::Prepared { cycles_seen: seen, ..prepared };
        let consent = Consent::to(prepared.plan.id());
        let job = |force_wear| {
            InterbusJob::Commit(Box::new(Commit { prepared: prepared.clone(), consent, force_wear, undoes: None }))
        };
        let ended = stand.run(job(false));
        let is_refused = match seen {
            Some(_) => matches!(ended, Err(JobError::NotStarted(NotStarted::Worn { .. }))),
            // An unknown number of stores is not treated as 0 (issue 22.4).
            None => matches!(ended, Err(JobError::NotStarted(NotStarted::WearUnknown { cost: 1 }))),
        };
        assert_eq!(is_refused, refused, "{seen:?}: {ended:?}");
        if refused {
            stand.run(job(true)).unwrap();
        }
    }
}

#[test]
fn logbook_counts_stores_by_serial_number() {
    let mut stand = Stand::new(SCALED);
    for value in [1, 2, 3] {
        let prepared = stand.prepare(Change::Preset { value });
        assert_eq!(prepared.cycles_seen, Some(CycleCount::complete(u64::from(value - 1))));
        stand.commit(prepared).unwrap();
    }
    let logbook = Logbook::open(&Store::at_root(stand.folder.path()).logbook_path()).unwrap();
    let own = |serial_number: &str| DeviceKey {
        kind: "interbus".to_owned(),
        device_type: "K3".to_owned(),
        serial_number: serial_number.to_owned(),
        is_virtual: true,
    };
    assert_eq!(logbook.write_cycles(&own("77")).unwrap(), 3);
    assert_eq!(logbook.write_cycles(&own("78")).unwrap(), 0);
    let history = logbook.history(&own("77"), 9).unwrap();
    let spent: Vec<u64> =
        history.iter().filter_map(|entry| entry.conclusion.as_ref()).map(|own| own.cycles_spent).collect();
    assert_eq!(spent, [1, 1, 1]);
    assert!(history.iter().all(|entry| entry.planned_cycles == 1 && entry.backup.as_deref().is_some_and(Path::exists)));
}

/// An encoder may store a program when it is left, changed or not (manual 5.4.4), so each program selected for reading
/// counts as one store. For a changed program, the store belongs to the write (issue 22.3).
#[test]
fn reading_programs_counts_as_stores() {
    let mut stand = Stand::new(SCALED);
    stand.run(InterbusJob::Survey).unwrap();
    stand.run(InterbusJob::Check).unwrap();
    assert_eq!(stand.counted(), 0);
    stand.programs(&[1, 3, 8]);
    assert_eq!(stand.counted(), 3);
    stand.run(InterbusJob::Read("cam:2:0".parse().unwrap())).unwrap();
    assert_eq!(stand.counted(), 4);
    // The program is read for the plan and again before it is written, which stores it.
    let before = stand.stores();
    let prepared = stand.prepare(Change::Item(Item::CamMask(program(6)), ItemValue::Mask(0x5A)));
    assert_eq!(prepared.cycles_seen, Some(CycleCount::complete(5)));
    let done = stand.commit(prepared).unwrap();
    assert_eq!((done.written.write_cycles, stand.stores() - before, stand.counted()), (1, 1, 7));
    // The program that was selected at first is left as well.
    let mut stand = Stand::new(&format!("{SCALED}&program=4"));
    stand.programs(&[6]);
    assert_eq!(stand.counted(), 2);
    stand.programs(&[4]);
    assert_eq!(stand.counted(), 2);
    // Parameters that another master has partly set are stored when the mode is restored.
    let now = stand.clock.now();
    stand.gateway.with_encoder(|encoder| encoder.write(now, 0x2040_0011));
    stand.run(InterbusJob::RestoreMode).unwrap();
    assert_eq!(stand.counted(), 3);
}

/// This encoder stores the number of steps minus one: 3599 means 3600 steps.
#[test]
fn steps_minus_one_is_passed_unchanged() {
    let mut stand = Stand::new("steps=3600&revolutions=1&steps-minus-one=on");
    let identity = match stand.run(InterbusJob::Identify).unwrap() {
        InterbusOutput::Identity(identity) => *identity,
        other => panic!("{other:?}"),
    };
    assert_eq!((identity.steps, identity.flags.steps_minus_one()), (3599, true));
    assert_eq!(identity.gear().map(|gear| gear.total_steps()), Ok(3600));
    let change = edited(&mut stand, &[], |wanted| wanted.parameters.steps = 719);
    let prepared = stand.prepare(change);
    stand.commit(prepared).unwrap();
    assert_eq!(stand.gateway.with_encoder(|encoder| encoder.stored().gear().total_steps()), 720);
    assert_eq!(stand.session.take_sample().unwrap().gear.map(|gear| gear.total_steps()), Some(720));
}

/// A cancellation takes effect between two words. The encoder then runs in its original mode again.
#[test]
fn cancelling_leaves_encoder_running() {
    let wanted = |stand: &mut Stand| {
        edited(stand, &[6], |wanted| {
            wanted.parameters.zero_shift = 3;
            assert!(wanted.set_value(Item::Cam(program(6), CamNumber::new(2).unwrap()), ItemValue::Cam(cam(1, 2))));
        })
    };
    let mut interrupted_ones = 0;
    for after in (0..1500).step_by(7) {
        let mut stand = Stand::new(&format!("{SCALED}&program=4"));
        let change = wanted(&mut stand);
        let prepared = stand.prepare(change);
        let consent = Consent::to(prepared.plan.id());
        let stores = stand.stores();
        stand.session.set_cancel(CancelToken::after_transactions(after));
        let ended =
            stand.run(InterbusJob::Commit(Box::new(Commit { prepared, consent, force_wear: false, undoes: None })));
        let spent = stand.stores() - stores;
        assert_eq!(stand.left(), (0, StartupMode::Cams(program(4))), "after {after}");
        match ended {
            Err(JobError::Interrupted { interrupted, .. }) => {
                interrupted_ones += 1;
                assert!(interrupted.cause.is_cancelled(), "after {after}: {interrupted}");
                assert_eq!(interrupted.end_state, EndState::AsFound, "after {after}");
                assert!(u64::from(spent) <= interrupted.done.write_cycles, "after {after}: {spent}");
            }
            Err(JobError::Device(error)) => assert_eq!((error.is_cancelled(), spent), (true, 0), "after {after}"),
            Err(error) => panic!("{error}"),
            Ok(_) => {
                assert_eq!(spent, 2);
                break;
            }
        }
        stand.session.set_cancel(CancelToken::default());
        let reading = stand.session.take_sample().unwrap();
        assert!(reading.is_valid() && reading.cams().is_some(), "after {after}");
    }
    assert!(interrupted_ones > 10);
}

#[test]
fn operation_reports_changes() {
    let mut stand = Stand::new(SCALED);
    let prepared = stand.prepare(Change::Preset { value: 7 });
    assert!(matches!(prepared.plan.ops.as_slice(), [Op::Parameterise(_), Op::FirePreset { value: 7 }]));
    let (mut told, consent) = (Vec::new(), Consent::to(prepared.plan.id()));
    let commit = InterbusJob::Commit(Box::new(Commit { prepared, consent, force_wear: false, undoes: None }));
    let ended = stand.session.run(JobId::default(), commit, &mut |event| {
        if let Event::Progress(_, Progress { done, total, step: JobStep::Operation(item) }) = event {
            told.push((done, total, item));
        }
    });
    assert!(matches!(ended, Event::Finished(..)));
    // The preset is set first and applied afterwards.
    assert_eq!(told, [(0, 2, "preset".to_owned()), (1, 2, "position".to_owned())]);
}

/// The position is already close to the preset. The encoder first returns old words, then the preset.
#[test]
fn sets_nearby_preset_exactly() {
    for (preset, faults) in [(102, "stale=6"), (98, "stale=6&busy=60"), (101, "stale=6"), (102, "stale=0")] {
        let mut stand = Stand::new(&format!("steps=8192&revolutions=1&serial=77&position=100&{faults}"));
        assert_eq!(stand.session.take_sample().unwrap().position(), Some(100));
        let prepared = stand.prepare(Change::Preset { value: preset });
        stand.commit(prepared).unwrap();
        assert_eq!(stand.session.take_sample().unwrap().position(), Some(preset), "{faults}");
        assert_eq!(stand.left(), (0, StartupMode::K3));
    }
}

/// After the content is lost, IN is always 86000000. The remedy in the message has to work.
#[test]
fn recovers_encoder_with_lost_parameters() {
    let mut stand = Stand::new("steps=360&revolutions=1&cams=demo&serial=5&fault=die-in-store:1");
    let profile = match stand.run(InterbusJob::Save { programs: true }).unwrap() {
        InterbusOutput::Saved(profile) => profile,
        other => panic!("{other:?}"),
    };
    let change = edited(&mut stand, &[], |wanted| wanted.parameters.zero_shift = 5);
    let prepared = stand.prepare(change);
    assert!(matches!(stand.commit(prepared), Err(JobError::Interrupted { .. })));
    let now = stand.clock.now();
    stand.gateway.with_encoder(|encoder| encoder.connect(now));
    match stand.run(InterbusJob::RestoreMode).unwrap() {
        InterbusOutput::ModeRestored(mode) => assert_eq!(mode, StartupMode::K3),
        other => panic!("{other:?}"),
    }
    assert_eq!((stand.session.take_sample().unwrap().word, stand.left()), (0x8600_0000, (0, StartupMode::K3)));
    let begun = stand.elapsed();
    let prepared = stand.prepare(Change::Restore { profile, options: RestoreOptions::default() });
    let done = stand.commit(prepared).unwrap();
    assert_eq!(done.written.verified, done.written.written);
    let kept = stand.gateway.with_encoder(|encoder| encoder.stored().clone());
    assert_eq!((kept.gear().total_steps(), kept.gear().turns()), (360, 1));
    assert!(stand.session.take_sample().unwrap().is_valid());
    assert_eq!(stand.left(), (0, StartupMode::K3));
    assert!(stand.elapsed() - begun < Duration::from_secs(120), "{:?}", stand.elapsed() - begun);
}
