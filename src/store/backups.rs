//! Device backups, taken before each write. Each backup is a file in a folder for its device and serial number, and is
//! never overwritten or removed. The caller supplies the text, which must not contain access codes.

use std::fs;
use std::path::{Path, PathBuf};

use jiff::Timestamp;
use jiff::civil::DateTime;
use jiff::tz::TimeZone;

use super::file_error::{FileError, FileErrorKind, FileOperation};
use super::file_names::{LetterCase, safe_name};
use super::files::{create_folder, write_new};

/// Time format of file names: UTC without colons, which Windows does not allow.
const TIME: &str = "%Y-%m-%dT%H-%M-%SZ";
const EXTENSION: &str = "ron";

/// Maximum number of backups of a device per second. More would indicate a runaway loop.
const MAX_BACKUPS_PER_SECOND: u32 = 1000;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Backups(PathBuf);

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Backup {
    pub path: PathBuf,
    /// Time of the backup, in whole seconds.
    pub taken: Timestamp,
}

impl Backups {
    pub(super) fn in_folder(folder: PathBuf) -> Self {
        Backups(folder)
    }

    /// Writes a backup to `<device>/<serial number>/2026-11-21T12-14-47Z.ron` and returns its path. If a backup from
    /// the same second exists, `-2`, `-3` and so on is appended to the time.
    ///
    /// # Errors
    /// Returns an error if the folder cannot be created or the file cannot be written. In this case, no file is left
    /// behind.
    pub fn save(&self, device: &str, serial_number: &str, taken: Timestamp, text: &str) -> Result<PathBuf, FileError> {
        let folder = self.device_folder(device, serial_number);
        create_folder(&folder)?;
        let time = taken.strftime(TIME).to_string();
        for number in 1..=MAX_BACKUPS_PER_SECOND {
            let path = folder.join(file_name(&time, number));
            match write_new(&path, text.as_bytes()) {
                Err(FileError { problem: FileErrorKind::Exists, .. }) => {}
                result => return result.map(|()| path),
            }
        }
        Err(FileErrorKind::Exists
            .into_error(FileOperation::Write, &folder.join(file_name(&time, MAX_BACKUPS_PER_SECOND))))
    }

    /// Returns the backups of a device, newest first. Any other files in the folder are ignored.
    ///
    /// # Errors
    /// Returns an error if the folder exists but cannot be read.
    pub fn list_for_device(&self, device: &str, serial_number: &str) -> Result<Vec<Backup>, FileError> {
        let folder = self.device_folder(device, serial_number);
        let failed = |error: std::io::Error| FileErrorKind::from(error).into_error(FileOperation::List, &folder);
        let entries = match fs::read_dir(&folder) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries.map_err(failed)?,
        };
        let mut backups = Vec::new();
        for entry in entries {
            let path = entry.map_err(failed)?.path();
            if let Some(order) = parse_file_name(&path)
                && path.is_file()
            {
                backups.push((order, path));
            }
        }
        backups.sort_by_key(|(order, _)| std::cmp::Reverse(*order));
        Ok(backups.into_iter().map(|((taken, _), path)| Backup { path, taken }).collect())
    }

    fn device_folder(&self, device: &str, serial_number: &str) -> PathBuf {
        // `device` is a keyword of this program. It is escaped nevertheless, so no path can lead out of the folder.
        self.0.join(safe_name(device, LetterCase::Kept)).join(safe_name(serial_number, LetterCase::Told))
    }
}

fn file_name(time: &str, number: u32) -> String {
    match number {
        1 => format!("{time}.{EXTENSION}"),
        _ => format!("{time}-{number}.{EXTENSION}"),
    }
}

/// Parses the time and number in the file name of a backup. Returns `None` for names that [`file_name`] does not
/// create.
fn parse_file_name(path: &Path) -> Option<(Timestamp, u32)> {
    let name = path.file_name()?.to_str()?;
    let (time, number) = name.strip_suffix(EXTENSION)?.strip_suffix('.')?.split_once('Z')?;
    let time = format!("{time}Z");
    let number = if number.is_empty() { 1 } else { number.strip_prefix('-')?.parse().ok()? };
    let taken = DateTime::strptime(TIME, &time).ok()?.to_zoned(TimeZone::UTC).ok()?.timestamp();
    (file_name(&taken.strftime(TIME).to_string(), number) == name).then_some((taken, number))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::read_text;

    fn at(text: &str) -> Timestamp {
        text.parse().unwrap()
    }

    fn backups() -> (tempfile::TempDir, Backups) {
        let root = tempfile::tempdir().unwrap();
        let backups = Backups::in_folder(root.path().join("data/backups"));
        (root, backups)
    }

    #[test]
    fn lists_newest_backup_first() {
        let (root, backups) = backups();
        let first = backups.save("hiperface", "12345678", at("2026-11-21T12:14:47.9Z"), "first").unwrap();
        let folder = root.path().join("data/backups/hiperface/12345678");
        assert_eq!(first, folder.join("2026-11-21T12-14-47Z.ron"));
        let later = backups.save("hiperface", "12345678", at("2027-01-01T00:00:00Z"), "later").unwrap();
        let second = backups.save("hiperface", "12345678", at("2026-11-21T12:14:47.1Z"), "second").unwrap();
        assert_eq!(second, folder.join("2026-11-21T12-14-47Z-2.ron"));
        assert_eq!(read_text(&first).unwrap(), "first");

        fs::create_dir(folder.join("2026-11-21T12-14-48Z.ron")).unwrap();
        let foreign = ["notes.txt", "x.ron", "2026-11-21T12-14-47Z-1.ron", "2026-11-21T12-14-47Z-02.ron"];
        for name in foreign.iter().chain(&["2026-13-21T12-14-47Z.ron", "2026-1-21T12-14-47Z.ron", "Z.ron", ".ron"]) {
            fs::write(folder.join(name), "x").unwrap();
        }
        let listed = backups.list_for_device("hiperface", "12345678").unwrap();
        let paths: Vec<_> = listed.iter().map(|backup| backup.path.clone()).collect();
        assert_eq!(paths, [later, second, first]);
        assert_eq!(listed[1].taken, at("2026-11-21T12:14:47Z"));
        assert_eq!(backups.list_for_device("hiperface", "1234567"), Ok(Vec::new()));
    }

    #[test]
    fn keeps_backups_within_one_second() {
        let (_root, backups) = backups();
        let taken = at("2026-11-21T12:14:47Z");
        std::thread::scope(|scope| {
            for thread in 0..4 {
                let backups = &backups;
                scope.spawn(move || {
                    for _ in 0..3 {
                        backups.save("hiperface", "1", taken, &thread.to_string()).unwrap();
                    }
                });
            }
        });
        let listed = backups.list_for_device("hiperface", "1").unwrap();
        assert_eq!(listed.len(), 12);
        assert!(listed[0].path.ends_with("2026-11-21T12-14-47Z-12.ron"), "{:?}", listed[0]);
        let mut texts: Vec<_> = listed.iter().map(|backup| read_text(&backup.path).unwrap()).collect();
        texts.sort();
        assert_eq!(texts.concat(), "000111222333");
    }

    #[test]
    fn serial_numbers_have_separate_folders() {
        let cases = [
            ("12345678", "12345678"),
            ("AB-1_2.3", "AB-1_2.3"),
            ("", "%none"),
            (".", "%2E"),
            ("..", "%2E%2E"),
            ("../X", "%2E.%2FX"),
            ("A/B", "A%2FB"),
            ("A\\B:C", "A%5CB%3AC"),
            ("   ", "%20%20%20"),
            ("1 ", "1%20"),
            ("1.", "1%2E"),
            ("%20", "%2520"),
            ("\0", "%00"),
            ("Ä", "%C3%84"),
            ("NUL", "%4EUL"),
            ("NUL.1", "%4EUL.1"),
            ("COM1", "%43OM1"),
            ("COM10", "COM10"),
            ("AbC", "AbC%ulu"),
            ("con", "%63on%ll"),
        ];
        let (root, backups) = backups();
        for (serial_number, expected) in cases {
            assert_eq!(safe_name(serial_number, LetterCase::Told), expected, "{serial_number:?}");
            let path = backups.save("hiperface", serial_number, at("2026-11-21T12:14:47Z"), serial_number).unwrap();
            assert_eq!(path.parent(), Some(root.path().join("data/backups/hiperface").join(expected).as_path()));
            let listed = backups.list_for_device("hiperface", serial_number).unwrap();
            assert_eq!(listed.len(), 1, "{serial_number:?}");
            assert_eq!(read_text(&listed[0].path).unwrap(), serial_number);
        }
        let outside = backups.save("../..", "1", at("2026-11-21T12:14:47Z"), "x").unwrap();
        assert!(outside.starts_with(root.path().join("data/backups/%2E.%2F.%2E")), "{outside:?}");
    }

    #[test]
    fn reports_file_instead_of_folder() {
        let (root, backups) = backups();
        fs::write(root.path().join("data"), "x").unwrap();
        let error = backups.save("hiperface", "1", at("2026-11-21T12:14:47Z"), "x").unwrap_err();
        assert_eq!((error.task, error.problem), (FileOperation::CreateFolder, FileErrorKind::NotFolder));
        assert!(backups.list_for_device("hiperface", "1").is_err());
    }
}
