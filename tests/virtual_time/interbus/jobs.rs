//! Reading: the words sent, and the state of the encoder afterwards.

use encoder_studio::devices::interbus::jobs::{InterbusJob, InterbusOutput, JobError, open};
use encoder_studio::devices::interbus::procedures::check::{CheckFinding, CheckStep, InterbusStepResult, Verdict};
use encoder_studio::devices::interbus::procedures::{Error, WordReply};
use encoder_studio::devices::interbus::profile::{Direction, Item, ItemValue};
use encoder_studio::devices::interbus::protocol::{EncoderMode, ReadOutNumber, StartupMode};
use encoder_studio::link::{write_entry, write_header};
use encoder_studio::store::Store;
use encoder_studio::units::Moment;

use super::support::{Stand, cam, gateway, program, station};

const K3: StartupMode = StartupMode::K3;

/// An encoder with 4096 steps per turn, at a quarter of a turn.
const QUARTER_TURN_ENCODER: &str = "steps=4096&revolutions=1&position=2048&serial=123456";

#[test]
fn reading_in_word_writes_nothing() {
    let mut stand = Stand::new(QUARTER_TURN_ENCODER);
    for job in [InterbusJob::Hello, InterbusJob::Position] {
        let reading = match stand.run(job).unwrap() {
            InterbusOutput::Hello(reading) | InterbusOutput::Position(reading) => reading,
            other => panic!("{other:?}"),
        };
        assert_eq!((reading.word, reading.position(), reading.mode), (1024, Some(1024), None));
    }
    assert_eq!(stand.session.take_sample().unwrap().word, 1024);
    assert_eq!(stand.sent(), Vec::<u32>::new());
}

#[test]
fn identify_returns_to_position() {
    let mut stand = Stand::new(QUARTER_TURN_ENCODER);
    let stores = stand.stores();
    let identity = match stand.run(InterbusJob::Identify).unwrap() {
        InterbusOutput::Identity(identity) => *identity,
        other => panic!("{other:?}"),
    };
    assert_eq!(identity.serial_number, "123456");
    assert_eq!((identity.steps, identity.revolutions, identity.direction), (4096, 1, Direction::Clockwise));
    assert_eq!((identity.mode, identity.flags.steps_minus_one()), (K3, false));
    // The mode comes first. `00000000` separates two values that look the same.
    let numbers = [9, 0, 1, 2, 3, 7, 0xA];
    let expected: Vec<u32> = numbers.into_iter().flat_map(|number| [0x2021_0000 + number, 0]).collect();
    assert_eq!(stand.sent(), expected);
    assert_eq!((stand.left(), stand.stores()), ((0, K3), stores));
    let reading = stand.session.take_sample().unwrap();
    assert_eq!((reading.mode, reading.position()), (Some(K3), Some(1024)));
    assert!(reading.turn_position().is_some_and(|place| (place.turns, place.degrees) == (0, 90.0)));
}

#[test]
fn survey_covers_every_readout() {
    let mut stand =
        Stand::new("steps=360000&revolutions=100&preset=77&zero-shift=5&temperature=-10&operating-time=1000");
    let survey = match stand.run(InterbusJob::Survey).unwrap() {
        InterbusOutput::Surveyed(survey) => *survey,
        other => panic!("{other:?}"),
    };
    let own = survey.parameters;
    assert_eq!((own.steps, own.revolutions, own.preset, own.zero_shift), (360_000, 100, 77, 5));
    assert_eq!(survey.read_outs().count(), 12);
    assert_eq!(stand.left(), (0, K3));
    for (item, value) in [
        (Item::Steps, ItemValue::Number(360_000)),
        (Item::Preset, ItemValue::Number(77)),
        (Item::Direction, ItemValue::Direction(Direction::Clockwise)),
        (Item::Temperature, ItemValue::TenthsOfDegree(survey.temperature_tenths)),
        (Item::OperatingTime, ItemValue::Minutes(survey.operating_minutes)),
    ] {
        assert!(matches!(stand.run(InterbusJob::Read(item)).unwrap(), InterbusOutput::Item(read) if read == value));
    }
    let register = ReadOutNumber::chip_register(5).unwrap();
    assert!(
        matches!(stand.run(InterbusJob::ReadOut(register)).unwrap(), InterbusOutput::ReadOut(own, _) if own == register)
    );
    let error = stand.run(InterbusJob::ReadOut(ReadOutNumber::new(0xB))).unwrap_err();
    assert_eq!(error.to_string(), "the encoder has no value for 2021000B (read-out)");
    assert_eq!(stand.left(), (0, K3));
}

/// The previous value must disappear before a new one counts, however long that takes.
#[test]
fn ignores_stale_values_and_busy_words() {
    for query in ["stale=3", "stale=30", "busy=200&stale=5", "stale=3&busy=900"] {
        let mut stand = Stand::new(&format!("steps=4000&revolutions=10&serial=99&{query}"));
        let survey = match stand.run(InterbusJob::Survey).unwrap() {
            InterbusOutput::Surveyed(survey) => *survey,
            other => panic!("{other:?}"),
        };
        assert_eq!(survey.identity.serial_number, "99", "{query}");
        assert_eq!((survey.parameters.steps, survey.parameters.revolutions), (4000, 10), "{query}");
    }
}

#[test]
fn selects_and_deselects_cam_programs() {
    for (query, found) in [
        ("cams=demo", StartupMode::K3),
        ("cams=demo&selection=output", StartupMode::K3),
        ("cams=demo&program=3", StartupMode::Cams(program(3))),
        ("cams=demo&program=3&stale=4", StartupMode::Cams(program(3))),
        ("cams=demo&selection=output&busy=50&stale=4", StartupMode::K3),
    ] {
        let mut stand = Stand::new(query);
        let stores = stand.stores();
        let wanted: Vec<u8> = vec![1, 3, 8];
        let read = stand.programs(&wanted);
        for (number, own) in read {
            let held = stand.gateway.with_encoder(|encoder| *encoder.memory().program(program(number)));
            assert_eq!(own.mask, held.mask, "{query}");
            assert_eq!(own.cams, held.cams, "{query}");
            assert!(own.cams.iter().all(Option::is_some), "{query}");
        }
        assert_eq!((stand.left(), stand.stores()), ((0, found), stores), "{query}");
    }
}

#[test]
fn keeps_selected_mode() {
    let mut stand = Stand::new("cams=demo&rpm=60");
    for mode in [
        StartupMode::Velocity,
        StartupMode::Cams(program(2)),
        StartupMode::Velocity,
        StartupMode::Cams(program(7)),
        StartupMode::Cams(program(1)),
        K3,
    ] {
        let output = stand.run(InterbusJob::Select(mode)).unwrap();
        assert!(matches!(output, InterbusOutput::Selected(own) if own == mode), "{mode:?}");
        assert_eq!(stand.left(), (0, mode));
        // Requests in between do not change the mode.
        stand.run(InterbusJob::Identify).unwrap();
        assert_eq!(stand.left(), (0, mode));
        let reading = stand.session.take_sample().unwrap();
        assert_eq!(reading.mode, Some(mode));
        match mode {
            StartupMode::Velocity => assert_eq!(reading.rpm(), Some(60)),
            StartupMode::Cams(_) => assert!(reading.cams().is_some()),
            _ => assert!(reading.position().is_some()),
        }
    }
    let error =
        stand.run(InterbusJob::Select(StartupMode::parse(encoder_studio::devices::interbus::protocol::Value::MAX)));
    assert!(matches!(error, Err(JobError::Device(Error::NotSelectable { .. }))), "{error:?}");
}

#[test]
fn handshake_steps_report_words() {
    let mut stand = Stand::new("busy=30&serial=7");
    let (ended, steps) = stand.follow(InterbusJob::ReadOut(ReadOutNumber::SERIAL_NUMBER));
    assert!(ended.is_ok());
    let told: Vec<(u32, u32)> = steps.iter().map(|step| (step.out, step.input)).collect();
    assert!(told.contains(&(0x2021_0000, 0xA000_0007)), "{told:08X?}");
    assert!(matches!(steps.last().map(|step| (step.out, step.reply)), Some((0, WordReply::Runs))));
    // No word is sent twice in a row.
    assert!(steps.windows(2).all(|pair| (pair[0].out, pair[0].reply) != (pair[1].out, pair[1].reply)));
}

#[test]
fn saved_profile_matches_encoder() {
    let mut stand = Stand::new("steps=36000&revolutions=10&preset=5&cams=demo&serial=31");
    let stores = stand.stores();
    for programs in [false, true] {
        let profile = match stand.run(InterbusJob::Save { programs }).unwrap() {
            InterbusOutput::Saved(profile) => *profile,
            other => panic!("{other:?}"),
        };
        assert_eq!((profile.identity.serial_number.as_str(), profile.image.parameters.steps), ("31", 36_000));
        assert_eq!(profile.image.known_programs().count(), if programs { 8 } else { 0 });
        assert_eq!(profile.image.shift.is_some(), programs);
        assert!(profile.depends_on_mounting(Item::Preset));
    }
    assert_eq!((stand.left(), stand.stores()), ((0, K3), stores));
}

#[test]
fn registers_select_encoder_on_gateway() {
    let gateway = gateway("encoders=3&unit=5&input=100&output=200&order=low-first&serial=40");
    for (query, serial) in
        [("unit=5&input=100&output=200&order=low-first", "40"), ("unit=5&input=104&output=204&order=low-first", "42")]
    {
        let mut stand = Stand::with(gateway.new_connection(), station(query));
        match stand.run(InterbusJob::Identify).unwrap() {
            InterbusOutput::Identity(identity) => assert_eq!(identity.serial_number, serial),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn returns_from_parameterisation_on_request() {
    let mut stand = Stand::new("steps=4096&revolutions=1");
    stand.gateway.with_encoder(|encoder| encoder.write(Moment::START, 0x0200_00FF));
    let error = stand.run(InterbusJob::Identify).unwrap_err();
    assert_eq!(error.to_string(), "the encoder is being parameterised: IN is C20000FF");
    assert_eq!(stand.sent(), Vec::<u32>::new(), "whoever is at it is not disturbed");
    assert!(matches!(stand.run(InterbusJob::RestoreMode).unwrap(), InterbusOutput::ModeRestored(mode) if mode == K3));
    assert_eq!(stand.left(), (0, K3));
    stand.gateway.with_encoder(|encoder| assert_eq!(encoder.mode(), EncoderMode::Position));
}

#[test]
fn reads_cam_as_item() {
    let mut stand = Stand::new("cams=demo&steps=3600&revolutions=1");
    let stores = stand.stores();
    let held = stand.gateway.with_encoder(|encoder| *encoder.memory().program(program(2)));
    let first = held.cams[0].unwrap();
    let item: Item = "cam:2:0".parse().unwrap();
    let output = stand.run(InterbusJob::Read(item)).unwrap();
    assert!(
        matches!(output, InterbusOutput::Item(ItemValue::Cam(own)) if own == cam(first.start.get(), first.stop.get()))
    );
    let output = stand.run(InterbusJob::Read("cam-mask:2".parse().unwrap())).unwrap();
    assert!(matches!(output, InterbusOutput::Item(ItemValue::Mask(own)) if own == held.mask));
    assert!(matches!(stand.run(InterbusJob::Read(Item::Shift)).unwrap(), InterbusOutput::Item(ItemValue::Number(0))));
    assert_eq!((stand.left(), stand.stores()), ((0, K3), stores));
}

fn checked(stand: &mut Stand) -> Vec<InterbusStepResult> {
    match stand.run(InterbusJob::Check).unwrap() {
        InterbusOutput::Check(lines) => lines,
        other => panic!("{other:?}"),
    }
}

fn verdict(lines: &[InterbusStepResult], step: CheckStep) -> Option<Verdict> {
    lines.iter().find(|line| line.step == step).map(|line| line.verdict)
}

#[test]
fn device_check_sets_nothing() {
    let mut stand = Stand::new("steps=3600&revolutions=1&serial=8&temperature=41&program=2&cams=demo");
    let stores = stand.stores();
    let lines = checked(&mut stand);
    assert!(lines.iter().all(|line| line.verdict == Verdict::Good), "{lines:?}");
    let steps: Vec<CheckStep> = lines.iter().map(|line| line.step).collect();
    use CheckStep::{Gateway, Handshake, Identity, InputWord, Temperature, Wear, WordOrder};
    assert_eq!(steps, [Gateway, WordOrder, InputWord, Handshake, Identity, Temperature, Wear]);
    let found = |finding: CheckFinding| lines.iter().any(|line| line.findings.contains(&finding));
    assert!(found(CheckFinding::SerialNumber("8".to_owned())) && found(CheckFinding::Temperature(410)));
    assert!(
        found(CheckFinding::Gear { steps: 3600, turns: 1 })
            && found(CheckFinding::Wear { seen: encoder_studio::worker::commit::CycleCount::complete(0), limit: 450 })
    );
    assert_eq!((stand.left(), stand.stores()), ((0, StartupMode::Cams(program(2))), stores));
}

#[test]
fn device_check_reports_faults() {
    // The halves of the word are swapped. One step below 3 000 000 is 2DC6BFh, which then looks like an echo, although
    // OUT requests nothing.
    let far = gateway("steps=33554431&revolutions=4096&position=3000000&order=low-first");
    let mut stand = Stand::with(far, station(""));
    let lines = checked(&mut stand);
    assert_eq!(verdict(&lines, CheckStep::WordOrder), Some(Verdict::Bad), "{lines:?}");
    assert_eq!(
        (verdict(&lines, CheckStep::Identity), stand.sent()),
        (None, vec![]),
        "nothing is sent into the wrong half"
    );
    let error = stand.run(InterbusJob::Identify).unwrap_err();
    assert_eq!(error.to_string(), "IN C6BF002D is plausible only as 002DC6BF: the word order may be swapped");
    // The encoder was left in parameterisation.
    let mut stand = Stand::new("steps=4096&revolutions=1");
    stand.gateway.with_encoder(|encoder| encoder.write(Moment::START, 0x0200_00FF));
    let lines = checked(&mut stand);
    assert_eq!(verdict(&lines, CheckStep::InputWord), Some(Verdict::Bad), "{lines:?}");
    assert_eq!(stand.sent(), Vec::<u32>::new());
    // Another master is reading its serial number.
    let mut stand = Stand::new("steps=4096&revolutions=1");
    stand.gateway.with_encoder(|encoder| encoder.write(Moment::START, 0x2021_0000));
    let lines = checked(&mut stand);
    assert_eq!(verdict(&lines, CheckStep::InputWord), Some(Verdict::Attention), "{lines:?}");
    assert_eq!((verdict(&lines, CheckStep::Handshake), stand.sent()), (None, vec![]), "whoever reads is not disturbed");
    // The encoder is not a K3, so OUT has no effect.
    let mut stand = Stand::new("class=K2&position=77");
    let lines = checked(&mut stand);
    assert_eq!(verdict(&lines, CheckStep::Handshake), Some(Verdict::Bad), "{lines:?}");
    let mut stand = Stand::new("steps=100&revolutions=1&preset=10&steps-minus-one=on&temperature=90");
    let lines = checked(&mut stand);
    for step in [CheckStep::Identity, CheckStep::Temperature] {
        assert_eq!(verdict(&lines, step), Some(Verdict::Attention), "{lines:?}");
    }
}

/// The jobs also run on a recording, even if requests are numbered differently.
#[test]
fn replays_recorded_trace() {
    let mut stand = Stand::new("steps=3600&revolutions=1&serial=4711");
    stand.run(InterbusJob::Identify).unwrap();
    let mut file = Vec::new();
    write_header(&mut file).unwrap();
    for entry in stand.trace.lock().unwrap().iter() {
        write_entry(&mut file, entry).unwrap();
    }
    let path = stand.folder.path().join("words.trace");
    std::fs::write(&path, file).unwrap();
    let url = format!("replay:{}?cycle=1", path.display()).parse().unwrap();
    let mut session = open(&url, Store::at_root(stand.folder.path())).unwrap();
    for _ in 0..2 {
        match session.run_inline(InterbusJob::Identify).unwrap() {
            InterbusOutput::Identity(identity) => assert_eq!(identity.serial_number, "4711"),
            other => panic!("{other:?}"),
        }
    }
}
