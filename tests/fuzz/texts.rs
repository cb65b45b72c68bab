//! Fuzz tests of the parsers for files, links and user input.

use encoder_studio::analysis::capture::{TableHints, TableImport, decode_head};
use encoder_studio::app::Settings;
use encoder_studio::devices::biss::protocol::Description;
use encoder_studio::devices::hiperface::protocol::EncoderTypes;
use encoder_studio::devices::ssi::protocol::{Family, parse_frame};
use encoder_studio::kinds::program;
use encoder_studio::link::LinkUrl;
use encoder_studio::profile::ProfileDocument;

use crate::fuzz;

/// Returns all files in a folder of the project and its subfolders.
fn files(folder: &str) -> Vec<Vec<u8>> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut found = Vec::new();
    let mut folders = vec![root];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            match entry.is_dir() {
                true => folders.push(entry),
                // The rest of a long table has no other structure than its beginning.
                false => found.push(std::fs::read(entry).unwrap().into_iter().take(20_000).collect()),
            }
        }
    }
    found.sort();
    found
}

#[test]
fn profiles() {
    let formats = program().studio.formats;
    fuzz("profiles", &files("profiles"), |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        // A document of a newer schema is kept as it is.
        if let Ok(document) = ProfileDocument::parse(text, formats)
            && !document.is_newer()
        {
            let again = ProfileDocument::parse(&document.emit(), formats);
            assert_eq!(again.unwrap().emit(), document.emit());
        }
    });
}

#[test]
fn captures() {
    fuzz("captures", &files("profiles/signals"), |bytes| {
        let _ = decode_head(bytes);
        if let Ok(mut import) = TableImport::from_head(bytes, &TableHints::default()) {
            let fed: Result<Vec<()>, _> = bytes.chunks(1000).map(|part| import.process(part)).collect();
            if fed.is_ok() {
                let _ = import.finish();
            }
        }
    });
}

#[test]
fn device_tables() {
    fuzz("devices", &files("assets/devices"), |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        let _ = EncoderTypes::parse(text);
        let _ = Description::parse("a.ron", text);
        let _ = Family::parse("a.ron", text);
    });
}

#[test]
fn settings() {
    fuzz("settings", &files("tests/fixtures/settings"), |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        if let Ok(settings) = Settings::parse(text) {
            assert_eq!(Settings::parse(&settings.emit()).map(|again| again.emit()), Ok(settings.emit()));
        }
    });
}

#[test]
fn links_and_entries() {
    let examples: Vec<Vec<u8>> = [
        "serial:/dev/ttyUSB0?baud=38400&parity=even&address=40",
        "tcp:192.168.1.5:4001?timeout=44",
        "bridge:serial:/dev/ttyACM0?clock=2000000&voltage=5",
        "bridge:serial:/dev/ttyACM0 ?",
        "serial:/dev/ttyUSB0?baud=38400 & ",
        "sim:?bridge=on&fault=drop:0.01,flip:0.02&rpm=-300.5",
        "enip:192.168.1.200?rpi=8",
        "modbus:10.0.0.7:502?input=0&output=0&words=low-first",
        "ssi:atm60,code=gray",
        "0x065EDD3",
        "0011001011110110111010011",
    ]
    .iter()
    .map(|text| text.as_bytes().to_vec())
    .collect();
    fuzz("links", &examples, |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        if let Ok(url) = text.parse::<LinkUrl>() {
            assert_eq!(url.to_string().parse::<LinkUrl>().unwrap(), url);
        }
        for clocks in [1, 25, 64] {
            let _ = parse_frame(text, clocks);
        }
    });
}
