//! The files created by a write, and disks that cannot store them.

use std::fs;

use encoder_studio::devices::hiperface::jobs::{Change, JobError};
use encoder_studio::devices::hiperface::profile::FieldRange;
use encoder_studio::devices::hiperface::protocol::{AccessCode, AccessCodeNumber};
use encoder_studio::store::{Logbook, Store};
use encoder_studio::worker::NotStarted;

use crate::support::{Desk, backup};

fn store_byte(value: u8) -> Change {
    Change::Store(vec![(FieldRange::new(0, 3, 1), vec![value])])
}

#[test]
fn writes_nothing_without_backup() {
    for in_the_way in ["data", "data/backups", "data/backups/hiperface", "data/backups/hiperface/GB0450179"] {
        let mut desk = Desk::new("");
        let path = desk.folder.path().join(in_the_way);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, "a file").unwrap();
        let memory = desk.memory();
        let error = desk.change(store_byte(0xEE)).unwrap_err();
        // Without a folder, the number of write cycles is unknown as well.
        let refused = match in_the_way {
            "data" => matches!(error, JobError::NotStarted(NotStarted::WearUnknown { cost: 1 })),
            _ => matches!(error, JobError::NotStarted(NotStarted::BackupFailed(_))),
        };
        assert!(refused, "{in_the_way}: {error:?}");
        assert_eq!((desk.memory(), desk.wear()), (memory, 0), "{in_the_way}");
    }
}

/// Without the logbook, the previous write cycles are unknown. A write must be forced, and the missing records are
/// reported (issue 22.4).
#[test]
fn broken_logbook_stops_unforced_write() {
    for garbage in [true, false] {
        let mut desk = Desk::new("");
        let path = Store::at_root(desk.folder.path()).logbook_path();
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        if garbage {
            fs::write(&path, "this is no database, and longer than the hundred bytes of the header that SQLite looks for in a file: it is text").unwrap();
        } else {
            fs::create_dir(&path).unwrap();
        }
        let prepared = desk.prepare(store_byte(0xEE)).unwrap();
        let error = desk.commit(&prepared).unwrap_err();
        assert!(matches!(error, JobError::NotStarted(NotStarted::WearUnknown { cost: 1 })), "{error:?}");
        assert_eq!(desk.wear(), 0);
        let done = desk.commit_with_force(&prepared).unwrap();
        // A damaged file is kept under another name, and a new one is created (issue 30).
        assert_eq!(done.logbook_warning.is_some(), !garbage);
        assert_eq!(desk.memory()[0].1[3], 0xEE);
        assert_eq!(done.written.verified, 1);
        if garbage {
            let kept = Logbook::open(&path).unwrap().damaged_file().unwrap().unwrap();
            assert!(fs::read_to_string(kept).unwrap().starts_with("this is no database"));
        }
    }
}

#[test]
fn backup_is_profile_of_previous_state() {
    let mut desk = Desk::new("");
    let before = desk.memory();
    let done = desk.change(store_byte(0xEE)).unwrap();
    let kept = backup(&done.backup.unwrap());
    assert_eq!(kept.identity.serial_number, "GB0450179");
    assert_eq!(kept.fields[0].bytes.as_ref(), Some(&before[0].1));
    desk.restore(&kept).unwrap();
    assert_eq!(desk.memory(), before);
}

/// The codes used here do not appear in any file in any form.
#[test]
fn stores_no_access_code() {
    let mut desk = Desk::new("codes=0:9D,2:66");
    desk.remember_code(0, 0x9D);
    desk.remember_code(2, 0x66);
    desk.change(store_byte(0xEE)).unwrap();
    let number = AccessCodeNumber::new(2).unwrap();
    desk.change(Change::ChangeCode { number, new: AccessCode::new(0xC3) }).unwrap();
    desk.change(Change::ChangeCode { number: AccessCodeNumber::ZERO, new: AccessCode::new(0xC3) }).unwrap();
    let sent = desk.tap().sent.len();
    desk.tap().deaf_from = Some(sent + 12);
    let _ = desk.change(store_byte(0x11));
    let mut folders = vec![desk.folder.path().to_owned()];
    let mut files = 0;
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            files += 1;
            let content = fs::read(&path).unwrap();
            let text = String::from_utf8_lossy(&content);
            for word in ["9D", "0x66", "66h", "C3"] {
                // The name plate consists of other bytes, none of which equals one of these.
                assert!(!text.split(|c: char| !c.is_ascii_alphanumeric()).any(|w| w == word), "{word} in {path:?}");
            }
        }
    }
    assert!(files >= 4);
}
