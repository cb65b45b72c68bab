//! Reads an encoder over a noisy line on both kinds of connection. The job must end with a correct result or an error.

use std::fs;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::bits::ByteOrder;
use encoder_studio::buses::bridge::procedures::AdapterError;
use encoder_studio::devices::biss::jobs::{BissJob, BissOutput, JobError, open};
use encoder_studio::devices::biss::procedures::{Echo, Error, Survey};
use encoder_studio::link::{CancelToken, LinkUrl, TraceEntry, write_entry, write_header};
use encoder_studio::store::Store;

use super::support::{Bench, Transport};

const WAYS: [Transport; 2] = [Transport::ConfigPin, Transport::Adapter];

fn survey(bench: &mut Bench) -> Result<Survey, Error> {
    match bench.run(BissJob::Survey) {
        Ok(BissOutput::Surveyed(survey)) => Ok(*survey),
        Ok(other) => panic!("{other:?}"),
        Err(JobError::Device(error)) => Err(error),
        Err(other) => panic!("{other}"),
    }
}

/// Returns the result of the reading without the time of its position.
fn timeless(survey: Survey) -> Survey {
    let mut survey = survey;
    if let Some(reading) = &mut survey.status.position {
        reading.at = Default::default();
        reading.crc_errors = 0;
    }
    survey
}

#[test]
fn bad_line_survey_is_correct_or_fails() {
    let (mut right, mut failed) = (0, 0);
    for way in WAYS {
        let truth = timeless(survey(&mut Bench::new(way, "")).unwrap());
        // The line to an adapter is a cable of one metre: the job ends if a packet is lost twice.
        let noises = match way {
            Transport::ConfigPin => ["drop:0.005", "flip:0.005", "garbage:0.005", "drop:0.02,flip:0.02,garbage:0.02"],
            Transport::Adapter => ["drop:0.0005", "flip:0.0005", "garbage:0.0005", "drop:0.005"],
        };
        for noise in noises {
            for seed in 0..6 {
                let mut bench = Bench::new(way, &format!("seed={seed}&fault={noise}"));
                match survey(&mut bench) {
                    Ok(survey) => {
                        right += 1;
                        assert_eq!(timeless(survey), truth, "{way:?} {noise}, seed {seed}");
                    }
                    Err(
                        Error::NoReply { .. }
                        | Error::Damaged { .. }
                        | Error::Unclear { .. }
                        | Error::Adapter(AdapterError::Silent),
                    ) => failed += 1,
                    Err(other) => panic!("{way:?} {noise}, seed {seed}: {other}"),
                }
            }
        }
    }
    println!("{right} right, {failed} failed");
    assert!(right > 30, "{right} of 48");
}

#[test]
fn echo_and_byte_order_preserve_values() {
    let truth = timeless(survey(&mut Bench::new(Transport::ConfigPin, "")).unwrap());
    for query in ["echo=on", "order=high-first", "echo=on&order=high-first"] {
        let mut bench = Bench::new(Transport::ConfigPin, query);
        let mut read = timeless(survey(&mut bench).unwrap());
        let order = if query.contains("order") { ByteOrder::HighFirst } else { ByteOrder::LowFirst };
        assert_eq!(read.identity.order.replace(order), Some(order), "{query}");
        read.identity.order = truth.identity.order;
        assert_eq!(read, truth, "{query}");
        let told = if query.contains("echo") { Echo::On } else { Echo::Off };
        assert_eq!((bench.session.station().line.echo, bench.session.station().line.damaged), (told, 0));
    }
}

/// The line is cut at every hundredth exchange. Within ten seconds, the job reports that the encoder does not answer.
#[test]
fn silence_ends_survey_in_ten_seconds() {
    for way in WAYS {
        for frames in (0..170).step_by(17) {
            let mut bench = Bench::new(way, "");
            bench.tap().mute_from = Some(frames);
            let error = survey(&mut bench).unwrap_err();
            assert!(error.is_lost(), "{way:?} from {frames} on: {error}");
            // A survey without faults takes half a second.
            assert!(bench.now() < Duration::from_secs(11), "{way:?} from {frames} on: {:?}", bench.now());
        }
    }
}

#[test]
fn lost_link_stops_all_requests() {
    for way in WAYS {
        let mut bench = Bench::new(way, "");
        bench.tap().lost_from = Some(40);
        assert!(matches!(survey(&mut bench), Err(Error::Link(_))));
        assert_eq!(bench.tap().sent.len(), 41);
    }
}

#[test]
fn cancels_between_exchanges() {
    for way in WAYS {
        let mut bench = Bench::new(way, "");
        bench.session.set_cancel(CancelToken::after_transactions(60));
        assert_eq!(survey(&mut bench), Err(Error::Cancelled));
        assert_eq!(bench.tap().sent.len(), 60);
    }
}

/// A replayed recording gives the same replies as the encoder did.
#[test]
fn replays_recordings_of_both_interfaces() {
    for way in WAYS {
        let entries = Arc::<Mutex<Vec<TraceEntry>>>::default();
        let mut bench = Bench::new(way, "serial=4711");
        let heard = entries.clone();
        bench.session.add_watcher(move |entry| heard.lock().unwrap().push(entry.clone()));
        let truth = timeless(survey(&mut bench).unwrap());
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.trace");
        let mut text = Vec::new();
        write_header(&mut text).unwrap();
        entries.lock().unwrap().iter().for_each(|entry| write_entry(&mut text, entry).unwrap());
        fs::write(&path, text).unwrap();
        let bridge = if way == Transport::Adapter { "?bridge=on" } else { "" };
        let url: LinkUrl = format!("replay:{}{bridge}", path.display()).parse().unwrap();
        let mut session = open(&url, Store::at_root(folder.path())).unwrap();
        let BissOutput::Surveyed(again) = session.run_inline(BissJob::Survey).unwrap() else { panic!() };
        assert_eq!(timeless(*again), truth, "{way:?}");
    }
}
