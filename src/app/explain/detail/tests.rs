//! Tests of error messages from lower layers, in both languages. Messages specific to a device are tested with that
//! device.

use super::*;
use crate::app::Language::{English, German};
use crate::link::{LinkUrl, read_trace};

/// Checks that the English text equals the lower layer's message and the German text differs from it.
#[track_caller]
pub(crate) fn check(text: &Text, error: &dyn std::fmt::Display) {
    assert_eq!(text.to_string_in(English), error.to_string());
    assert_eq!(text.terminal_text(), error.to_string());
    let german = text.to_string_in(German);
    assert_ne!(german, error.to_string());
    for english in [" is ", " must ", " from ", " to ", " the ", " or ", " and ", " of ", " a "] {
        assert!(!format!(" {german} ").contains(english), "{german}");
    }
}

#[test]
fn explains_link_errors_in_both_languages() {
    for text in ["usb:1", "serial:", "replay:", "tcp:host", "bridge:", "serial:x?baud", "serial:x?baud=1&baud=2"] {
        let error = text.parse::<LinkUrl>().unwrap_err();
        check(&url_error_text(&error), &error);
    }
    let error = UrlError::Device { scheme: "bridge", known: "sim:, serial:, tcp:, replay:" };
    assert_eq!(url_error_text(&error).to_string_in(English), error.to_string());
    assert_ne!(url_error_text(&error).to_string_in(German), error.to_string());
    let known = "baud, parity".to_owned();
    let error = UrlError::Unknown { name: "bad".to_owned(), scheme: "serial", known };
    check(&url_error_text(&error), &error);
}

#[test]
fn explains_file_errors_in_both_languages() {
    for text in ["", "# encoder-studio trace 1\n0.1 = 40", "# encoder-studio trace 1\n1 > 4G"] {
        let error = read_trace(text).unwrap_err();
        check(&trace_error_text(&error), &error);
    }
    let problems = [
        LogbookErrorKind::NoAccess,
        LogbookErrorKind::WriteProtected,
        LogbookErrorKind::Locked,
        LogbookErrorKind::DiskFull,
        LogbookErrorKind::Damaged { what: "page 3".to_owned() },
        LogbookErrorKind::SetAside { kept: "l-damaged.sqlite".into() },
        LogbookErrorKind::Newer { found: 3, known: 2 },
    ];
    for problem in problems {
        let error = LogbookError { path: "l.sqlite".into(), problem };
        check(&logbook_problem(&error), &error);
    }
}
