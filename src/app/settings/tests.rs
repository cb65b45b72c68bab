//! Tests that settings are saved and read back, including invalid and unknown entries.

use super::*;

const HIPERFACE: Tab = Tab::named("Hiperface");
const BISS: Tab = Tab::named("Biss");

#[test]
fn round_trips_settings_ignoring_unknown() {
    let mut settings = Settings { theme: ColorScheme::Light, language: Language::German, ..Settings::default() };
    settings.use_link(HIPERFACE, "serial:/dev/ttyUSB0");
    settings.layout = Some("(tiles: {})".to_owned());
    assert_eq!(Settings::parse(&settings.emit()), Ok(settings));
    assert_eq!(Settings::parse("(theme: Light, colour: 7)").map(|s| s.theme), Ok(ColorScheme::Light));
    assert!(Settings::parse("(theme: Mauve)").is_err());
    assert!(Settings::parse("").is_err());
}

#[test]
fn keeps_readable_parts_of_broken_settings() {
    let mut settings = Settings { theme: ColorScheme::Light, size: Some((1500, 900)), ..Settings::default() };
    settings.use_link(HIPERFACE, "serial:/dev/ttyUSB0");
    let broken = settings.emit().replace("tab: First", "tab: 7");
    assert!(Settings::parse(&broken).is_err());
    assert_eq!(Settings::parse_partial(&broken), settings);
    assert_eq!(Settings::parse_partial("(theme: Light, links: 7)").theme, ColorScheme::Light);
    assert_eq!(Settings::parse_partial("(links: [\"sim:\"])").links_of(Tab::default()), ["sim:"], "from before");
    assert!(Settings::parse_partial("no settings").links_of(HIPERFACE).is_empty());
}

#[test]
fn finds_unknown_name() {
    let all = Settings { lower_open: true, company: Some("x".into()), logbook: "x".into(), ..Settings::default() };
    assert_eq!(Settings::unknown_name(&all.emit()), None);
    assert_eq!(Settings::unknown_name("(theme: Light, logbok: \"\")").as_deref(), Some("logbok"));
    assert_eq!(Settings::unknown_name("(theme: "), None);
}

/// If the setting for the user name cannot be read, no name may get into the logbook.
#[test]
fn unreadable_setting_hides_user_name() {
    for (text, expected) in [
        ("(theme: Mauve)", UserName::Full),
        ("(theme: Mauve, user_name: Initials)", UserName::Initials),
        ("(theme: Mauve, user_name: Of)", UserName::Off),
        ("(user_name: Initials", UserName::Off),
        ("", UserName::Off),
    ] {
        assert_eq!(Settings::parse_partial(text).user_name, expected, "{text}");
    }
}

/// Links are kept even if their tab belongs to another version of the program.
#[test]
fn keeps_unknown_tab_links() {
    let text = "(tab: Gearbox, links: {Hiperface: [\"sim:\"], Gearbox: [\"tcp:host:1\"]})";
    let mut settings = Settings::parse(text).unwrap();
    settings.replace_unknown_tab(KindRegistry::NONE);
    settings.use_link(HIPERFACE, "tcp:host:2");
    let again = Settings::parse(&settings.emit()).unwrap();
    assert_eq!(again.tab, Tab::default());
    assert_eq!(again.links_of(Tab::named("Gearbox")), ["tcp:host:1"]);
    assert_eq!(again.links_of(HIPERFACE), ["tcp:host:2", "sim:"]);
}

#[test]
fn keeps_settings_changed_since_start() {
    let mut found = Settings { theme: ColorScheme::Light, size: Some((1500, 900)), ..Settings::default() };
    found.use_link(HIPERFACE, "tcp:host:1");
    let mut settings = Settings { language: Language::German, ..Settings::default() };
    settings.use_link(HIPERFACE, "sim:");
    let settings = found.with_changes(&Settings::default(), &settings);
    assert_eq!(
        (settings.theme, settings.language, settings.size),
        (ColorScheme::Light, Language::German, Some((1500, 900)))
    );
    assert_eq!(settings.links_of(HIPERFACE), ["sim:", "tcp:host:1"]);
}

fn with_drives(drives: &str) -> Settings {
    Settings::parse(&format!("(drives: {{\"HUB-4 7\": ({drives})}})")).unwrap()
}

/// Changes made here are merged into the content written by another window.
#[test]
fn merges_concurrent_settings_changes() {
    let cases = [
        ("marked there", "unconfirmed: [1], marks: {1: 1}", "", "", "unconfirmed: [1], marks: {1: 1}"),
        ("marked here", "", "", "unconfirmed: [1], marks: {1: 1}", "unconfirmed: [1], marks: {1: 1}"),
        (
            "marked on both sides",
            "unconfirmed: [1], marks: {1: 1}",
            "",
            "unconfirmed: [1, 2], marks: {1: 1, 2: 1}",
            "unconfirmed: [1, 2], marks: {1: 2, 2: 1}",
        ),
        (
            "confirmed here",
            "unconfirmed: [1, 3], marks: {1: 4, 3: 1}",
            "unconfirmed: [1], marks: {1: 4}",
            "marks: {1: 4}",
            "unconfirmed: [3], marks: {1: 4, 3: 1}",
        ),
        (
            "confirmed here, and marked there once more since",
            "unconfirmed: [1], marks: {1: 5}",
            "unconfirmed: [1], marks: {1: 4}",
            "marks: {1: 4}",
            "unconfirmed: [1], marks: {1: 5}",
        ),
        (
            "confirmed there, and changed here otherwise",
            "marks: {1: 4}",
            "unconfirmed: [1], marks: {1: 4}",
            "unconfirmed: [1], marks: {1: 4}, measure: Turns",
            "marks: {1: 4}, measure: Turns",
        ),
        (
            "by a program that does not count",
            "unconfirmed: [1]",
            "unconfirmed: [1], marks: {1: 4}",
            "marks: {1: 4}",
            "unconfirmed: [1]",
        ),
        (
            "spindles of two drives, and one that is gone",
            "pitches: {1: 4000000, 2: 5000000, 3: 1000000}, measure: Turns",
            "pitches: {1: 3000000, 3: 1000000}",
            "pitches: {1: 3000000, 4: 6000000}",
            "pitches: {1: 4000000, 2: 5000000, 4: 6000000}, measure: Turns",
        ),
    ];
    for (label, there, known, ours, expected) in cases {
        let merged = with_drives(there).with_changes(&with_drives(known), &with_drives(ours));
        assert_eq!(merged, with_drives(expected), "{label}");
    }
}

/// Unconfirmed limits stay locked even if the rest of the entry cannot be read.
#[test]
fn reads_marks_from_broken_entry() {
    let broken = "(drives: {\"HUB-4 7\": (measure: Cubits, unconfirmed: [1], marks: {1: 2})})";
    assert!(Settings::parse(broken).is_err());
    assert_eq!(Settings::parse_partial(broken), with_drives("unconfirmed: [1], marks: {1: 2}"));
}

/// Links used by other windows in the meantime are kept, after those used here.
#[test]
fn merges_links_between_windows() {
    let of = |links: &[&str]| {
        let mut settings = Settings::default();
        links.iter().rev().for_each(|link| settings.use_link(BISS, link));
        settings
    };
    type Links<'l> = &'l [&'l str];
    let cases: [[Links<'_>; 4]; 5] = [
        [&["x", "a", "b"], &["a", "b"], &["a", "b"], &["x", "a", "b"]],
        [&["x", "a", "b"], &["a", "b"], &["b", "a"], &["b", "x", "a"]],
        [&["x", "a", "b"], &["a", "b"], &["n", "a", "b"], &["n", "x", "a", "b"]],
        [&["b", "a"], &["a", "b"], &["n", "b", "a"], &["n", "b", "a"]],
        [&["a"], &[], &[], &["a"]],
    ];
    for [there, known, ours, expected] in cases {
        let merged = of(there).with_changes(&of(known), &of(ours));
        assert_eq!(merged.links_of(BISS), expected, "{there:?} {known:?} {ours:?}");
    }
}

/// A settings file from an older version can be read although it contains no marks.
#[test]
fn reads_settings_without_marks() {
    let before = "(drives: {\"HUB-4 7\": (pitches: {1: 4000000}, measure: Millimetres, unconfirmed: [1])})";
    let settings = Settings::parse(before).unwrap();
    assert_eq!(settings, with_drives("pitches: {1: 4000000}, measure: Millimetres, unconfirmed: [1], marks: {}"));
}

#[test]
fn lists_latest_link_first() {
    let mut settings = Settings::default();
    for at in 0..20 {
        settings.use_link(HIPERFACE, &format!("tcp:host:{at}"));
    }
    settings.use_link(HIPERFACE, "tcp:host:15");
    assert_eq!(settings.links_of(HIPERFACE).len(), 12);
    assert_eq!(settings.links_of(HIPERFACE)[..3], ["tcp:host:15", "tcp:host:19", "tcp:host:18"]);
}

/// Profiles that another window has used are kept, and older settings have none.
#[test]
fn recent_profiles_are_merged_newest_first() {
    let of = |paths: &[&str]| {
        let mut settings = Settings::default();
        paths.iter().rev().for_each(|path| settings.use_profile(path));
        settings
    };
    let merged = of(&["/x", "/a"]).with_changes(&of(&["/a"]), &of(&["/b", "/a"]));
    assert_eq!(merged.recent_profiles(), ["/b", "/x", "/a"]);
    assert_eq!(Settings::parse(&merged.emit()), Ok(merged.clone()));
    let broken = merged.emit().replace("theme: Dark", "theme: Mauve");
    assert_eq!(Settings::parse_partial(&broken).recent_profiles(), merged.recent_profiles());
    assert!(Settings::parse("(theme: Light)").unwrap().recent_profiles().is_empty());
    let many: Vec<String> = (0..20).map(|at| format!("/{at}")).collect();
    let many: Vec<&str> = many.iter().map(String::as_str).collect();
    assert_eq!(of(&many).recent_profiles().len(), 12);
    assert_eq!(of(&many).recent_profiles()[..2], ["/0", "/1"]);
}
