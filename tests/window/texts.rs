//! Test support that checks the texts in both languages: each is in a catalogue, all of its placeholders have values,
//! and no ID occurs twice.

use crate::tabs::Tabs as _;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::LazyLock;

use encoder_studio::app::review::OperationDescription;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{COMMON, Catalogue};
use encoder_studio::app::{JobState, Language, Notice, Studio, Text};
use encoder_studio::buses::bridge;
use encoder_studio::devices::hiperface::state::explain;
use encoder_studio::devices::hiperface::state::{Encoder, ReviewState};
use encoder_studio::devices::{biss, hiperdrive, hiperface, interbus, ssi};
use encoder_studio::signals;

#[derive(serde::Deserialize)]
struct Row {
    en: String,
    de: String,
    #[serde(default)]
    terminal: String,
}

/// The text catalogues of the program and of all device kinds.
const CATALOGUES: [&Catalogue; 9] = [
    &COMMON,
    &hiperface::state::TEXTS,
    &biss::state::TEXTS,
    &ssi::state::TEXTS,
    &interbus::state::TEXTS,
    &hiperdrive::state::TEXTS,
    &bridge::state::TEXTS,
    &signals::state::TEXTS,
    &crate::novo::state::TEXTS,
];

/// The rows of all catalogues by text ID.
static TABLE: LazyLock<BTreeMap<String, Row>> = LazyLock::new(|| {
    let rows = CATALOGUES.map(|own| ron::from_str::<BTreeMap<String, Row>>(own.source()).unwrap());
    rows.into_iter().flatten().collect()
});

/// Returns the text with the given ID from any catalogue.
#[track_caller]
pub(crate) fn text(id: &'static str) -> Text {
    let own = CATALOGUES.into_iter().find(|own| own.ids().any(|known| known == id));
    own.unwrap_or_else(|| panic!("there is no text {id}")).text(id)
}

fn places(template: &str) -> impl Iterator<Item = &str> {
    template.split('{').skip(1).filter_map(|part| part.split_once('}')).map(|(name, _)| name)
}

thread_local! {
    /// The last text that was checked for each ID. The same texts are displayed for many frames.
    static CHECKED: RefCell<HashMap<&'static str, Text>> = RefCell::default();
}

/// Checks that a text is in its catalogue, has all arguments, and is not empty in either language.
#[track_caller]
pub(crate) fn check(text: &Text) {
    if CHECKED.with_borrow(|checked| checked.get(text.id()) == Some(text)) {
        return;
    }
    let row = TABLE.get(text.id()).unwrap_or_else(|| panic!("{} is not in the table", text.id()));
    let arguments = format!("{text:?}");
    for template in [&row.en, &row.de, &row.terminal] {
        for place in places(template) {
            assert!(arguments.contains(&format!("(\"{place}\", ")), "{} has nothing for {place}", text.id());
        }
    }
    for words in [text.to_string_in(Language::English), text.to_string_in(Language::German), text.terminal_text()] {
        assert!(!words.is_empty() && !words.contains('{'), "{}: {words}", text.id());
    }
    CHECKED.with_borrow_mut(|checked| checked.insert(text.id(), text.clone()));
}

fn check_notice(notice: &Notice) {
    assert!(!notice.texts.is_empty());
    notice.texts.iter().for_each(check);
}

/// Checks every text that the window could show at the moment.
#[track_caller]
pub(crate) fn check_all(studio: &Studio) {
    studio.services.log.notices().for_each(check_notice);
    studio.services.log.current().iter().for_each(|notice| check_notice(notice));
    for job in studio.services.jobs() {
        check(&job.title);
        if let JobState::Failed(why) = &job.end {
            check(why);
        }
    }
    if let Some(question) = &studio.question {
        check(&question.text);
        check(&question.confirm);
    }
    if let Some(dialog) = &studio.connect {
        dialog.problem.iter().for_each(check);
        if let Some(Err(why)) = &dialog.ports {
            check(why);
        }
        crate::tabs::search(dialog).into_iter().filter_map(|search| search.end.as_ref()).for_each(check);
    }
    if let Some(library) = studio.profile_library() {
        library.entries().filter_map(|entry| entry.problem()).for_each(|problem| check(problem.text()));
        library.preview().and_then(|preview| preview.as_ref().err()).into_iter().for_each(check);
    }
    studio.signals().problem().into_iter().for_each(check);
    studio.signals().source().problem().into_iter().for_each(check);
    studio.devices().iter().filter_map(|own| own.get()).for_each(check_encoder);
}

fn check_encoder(encoder: &Encoder) {
    if let Phase::Lost(why) | Phase::Silent(why) = &encoder.session.phase {
        check(why);
    }
    for why in encoder.analogue.values().filter_map(|value| value.as_ref().err()) {
        check(why);
    }
    for field in encoder.staged.device() {
        check(&explain::field_status(field.status));
    }
    encoder.codes.iter().flatten().for_each(|code| check(&explain::status_code_name(*code)));
    if let Some(Err(why)) = &encoder.session.backups {
        check(why);
    }
    if let Some(Err(why)) = &encoder.session.writes {
        check(why);
    }
    let Some(review) = &encoder.session.review else { return };
    check(&review.title);
    if let ReviewState::Failed { texts, .. } = &review.state {
        texts.iter().for_each(check);
    }
    let sheet = review.to_sheet(0);
    sheet.lines.iter().flat_map(OperationDescription::texts).for_each(check);
    sheet.needs.iter().chain(&sheet.warnings).chain(&sheet.cost).for_each(check);
}

/// Returns whether a string is a text ID, which the window shows if no catalogue contains the text.
pub(crate) fn is_name(words: &str) -> bool {
    let part = |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_lowercase() || c == '_');
    words.split_once('.').is_some_and(|(area, name)| {
        part(area) && part(name) && TABLE.keys().any(|own| own.split_once('.').is_some_and(|(own, _)| own == area))
    })
}

/// Returns texts without arguments that occur only in the other language.
pub(crate) fn texts_of_other_language(language: Language) -> BTreeSet<&'static str> {
    let own = |row: &'static Row| if language == Language::English { &row.en } else { &row.de };
    let other = |row: &'static Row| if language == Language::English { &row.de } else { &row.en };
    let known: BTreeSet<&str> = TABLE.values().map(|row| own(row).as_str()).collect();
    let foreign = TABLE.values().map(|row| other(row).as_str());
    foreign.filter(|words| !words.contains('{') && !known.contains(words)).collect()
}

#[test]
fn text_ids_are_unique() {
    let mut names = BTreeSet::new();
    for line in CATALOGUES.into_iter().flat_map(|own| own.source().lines()) {
        let name = line.strip_prefix("    \"").and_then(|line| line.split_once("\": (")).map(|(name, _)| name);
        if let Some(name) = name {
            assert!(names.insert(name), "{name} appears twice");
        }
    }
    assert_eq!(names.len(), TABLE.len());
}
