//! Notices to the user. The latest one stays on display until it has been read, and the log contains all of them.

use std::collections::VecDeque;
use std::path::Path;
use std::time::Duration;

use jiff::Zoned;

use super::Text;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    Note,
    Good,
    Warning,
    Error,
}

impl Severity {
    /// Returns the remaining display time of a notice that has been visible for `shown`, or `None` if it stays until
    /// the user closes it.
    pub fn display_time(self, shown: Duration) -> Option<Duration> {
        let seconds = match self {
            Severity::Note | Severity::Good => 6,
            Severity::Warning => 20,
            Severity::Error => return None,
        };
        Some(Duration::from_secs(seconds).saturating_sub(shown))
    }
}

#[derive(Clone, Debug)]
pub struct Notice {
    pub at: Zoned,
    pub severity: Severity,
    pub texts: Vec<Text>,
    pub about: Option<String>,
    pub part: Option<Text>,
}

impl Notice {
    /// Returns a prefix with the names of the device and the part. The prefix is empty if the notice has neither.
    pub fn device_prefix(&self, words: impl Fn(&Text) -> String) -> String {
        let names = self.about.clone().into_iter().chain(self.part.as_ref().map(words));
        let names: Vec<String> = names.collect();
        if names.is_empty() { String::new() } else { format!("{}: ", names.join(", ")) }
    }
}

/// The log of notices, newest last. If it is full, the oldest ones are removed.
#[derive(Debug, Default)]
pub struct NoticeLog {
    notices: VecDeque<Notice>,
    /// Notice displayed in the window, if any.
    standing: Option<Notice>,
}

impl NoticeLog {
    const CAPACITY: usize = 2_000;

    /// Adds a notice and displays it until the user closes it or another one replaces it.
    pub fn add(&mut self, notice: Notice) {
        // A success does not replace a warning or an error.
        if notice.severity >= Severity::Warning
            || self.standing.as_ref().is_none_or(|old| old.severity <= Severity::Good)
        {
            self.standing = Some(notice.clone());
        }
        self.add_to_log(notice);
    }

    pub fn add_to_log(&mut self, notice: Notice) {
        if notice.severity >= Severity::Warning {
            tracing::warn!("{}", terminal_text(&notice));
        } else {
            tracing::info!("{}", terminal_text(&notice));
        }
        self.notices.push_back(notice);
        if self.notices.len() > Self::CAPACITY {
            self.notices.pop_front();
        }
    }

    pub fn notices(&self) -> impl DoubleEndedIterator<Item = &Notice> + ExactSizeIterator {
        self.notices.iter()
    }

    pub fn current(&self) -> Option<&Notice> {
        self.standing.as_ref()
    }

    /// Removes a notice about a session from the window because it no longer applies.
    pub(crate) fn remove_from_window(&mut self, id: &str, about: Option<&str>) {
        let is_it =
            |notice: &Notice| notice.about.as_deref() == about && notice.texts.iter().any(|text| text.id() == id);
        if self.standing.as_ref().is_some_and(is_it) {
            self.standing = None;
        }
    }

    /// Removes a notice about a session from the window, unless it is an error. A more important message is now
    /// displayed elsewhere.
    pub(crate) fn remove_minor(&mut self, about: &str) {
        let is_it = |notice: &Notice| notice.severity < Severity::Error && notice.about.as_deref() == Some(about);
        self.standing.take_if(|notice| is_it(notice));
    }

    /// Removes an error about a file from the window because the file has now been read or written.
    pub(crate) fn remove_file_notices(&mut self, path: &Path) {
        let is_it = |notice: &Notice| {
            notice.severity == Severity::Error && notice.texts.first().is_some_and(|text| text.refers_to(path))
        };
        self.standing.take_if(|notice| is_it(notice));
    }

    pub fn dismiss(&mut self) {
        self.standing = None;
    }
}

fn terminal_text(notice: &Notice) -> String {
    let words: Vec<String> = notice.texts.iter().map(Text::terminal_text).collect();
    format!("{}{}", notice.device_prefix(Text::terminal_text), words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn success_does_not_replace_warning() {
        let notice = |severity| Notice {
            at: Zoned::now(),
            severity,
            texts: vec![Text::new("session.busy")],
            about: None,
            part: None,
        };
        let cases = [
            (Severity::Note, Severity::Good, true),
            (Severity::Good, Severity::Note, true),
            (Severity::Warning, Severity::Good, false),
            (Severity::Error, Severity::Good, false),
            (Severity::Error, Severity::Note, false),
            (Severity::Good, Severity::Warning, true),
            (Severity::Error, Severity::Warning, true),
        ];
        for (old, new, replaced) in cases {
            let mut log = NoticeLog::default();
            log.add(notice(old));
            log.add(notice(new));
            assert_eq!(
                log.current().map(|own| own.severity),
                Some(if replaced { new } else { old }),
                "{old:?} {new:?}"
            );
            assert_eq!(log.notices().len(), 2);
        }
    }

    #[test]
    fn errors_outlast_success_notices() {
        let left = |severity: Severity| severity.display_time(Duration::from_millis(5_500));
        assert_eq!(left(Severity::Note), Some(Duration::from_millis(500)));
        assert_eq!(left(Severity::Good), left(Severity::Note));
        assert_eq!(left(Severity::Warning), Some(Duration::from_millis(14_500)));
        assert_eq!(left(Severity::Error), None);
        assert_eq!(Severity::Warning.display_time(Duration::from_secs(21)), Some(Duration::ZERO));
    }

    /// Saving a file removes only the errors about that file.
    #[test]
    fn saving_dismisses_file_errors() {
        let mut log = NoticeLog::default();
        let full = Text::new("file.disk_full").with("path", "/a/b.csv");
        let texts = vec![full, Text::new("session.not_saved")];
        log.add(Notice { at: Zoned::now(), severity: Severity::Error, texts, about: None, part: None });
        log.remove_file_notices(Path::new("/a/c.csv"));
        assert!(log.current().is_some());
        log.remove_file_notices(Path::new("/a/b.csv"));
        assert!(log.current().is_none() && log.notices().len() == 1);
    }

    #[test]
    fn connection_loss_replaces_warning() {
        let cases = [
            (Severity::Warning, Some("one"), false),
            (Severity::Good, Some("one"), false),
            (Severity::Error, Some("one"), true),
            (Severity::Warning, Some("other"), true),
            (Severity::Warning, None, true),
        ];
        for (severity, about, stays) in cases {
            let mut log = NoticeLog::default();
            let (about, texts) = (about.map(str::to_owned), vec![Text::new("session.busy")]);
            log.add(Notice { at: Zoned::now(), severity, texts, about, part: None });
            log.remove_minor("one");
            assert_eq!((log.current().is_some(), log.notices().len()), (stays, 1), "{severity:?}");
        }
    }

    #[test]
    fn removes_resolved_notice() {
        let mut log = NoticeLog::default();
        let texts = vec![Text::new("session.not_connected")];
        log.add(Notice {
            at: Zoned::now(),
            severity: Severity::Warning,
            texts,
            about: Some("one".to_owned()),
            part: None,
        });
        log.remove_from_window("session.busy", Some("one"));
        log.remove_from_window("session.not_connected", Some("other"));
        assert!(log.current().is_some());
        log.remove_from_window("session.not_connected", Some("one"));
        assert!(log.current().is_none() && log.notices().len() == 1);
    }
}
