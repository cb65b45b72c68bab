//! Texts in English and German from one table (`assets/texts.ron`).

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

/// A language of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Language {
    /// English.
    English,
    /// German.
    German,
}

/// A text of the table with its arguments: what is said, before it is known in which language.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    id: &'static str,
    arguments: Vec<(&'static str, Argument)>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Argument {
    Words(String),
    /// As English writes it, with a point.
    Number(String),
    /// In English and in German.
    Name(String, String),
    Text(Text),
    List(Vec<Text>),
}

impl Argument {
    fn said(&self, place: Place) -> String {
        match self {
            Argument::Number(number) if matches!(place, Place::Window(Language::German)) => number.replace('.', ","),
            Argument::Name(_, german) if matches!(place, Place::Window(Language::German)) => german.clone(),
            Argument::Words(words) | Argument::Number(words) | Argument::Name(words, _) => words.clone(),
            Argument::Text(text) => text.said(place),
            Argument::List(texts) => texts.iter().map(|text| text.said(place)).collect::<Vec<_>>().join(", "),
        }
    }
}

/// The table.
#[derive(Debug)]
pub struct Texts(BTreeMap<String, Row>);

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    en: String,
    de: String,
    /// English for the command line; empty where it is that of the window.
    #[serde(default)]
    terminal: String,
}

/// Where a text is said.
#[derive(Clone, Copy)]
enum Place {
    Window(Language),
    Terminal,
}

static BUILT_IN: LazyLock<Texts> = LazyLock::new(|| {
    // That it parses is tested; without it every text would be its own name.
    Texts(ron::from_str(Texts::SOURCE).unwrap_or_default())
});

impl Text {
    /// The text of that name in the table.
    pub fn new(id: &'static str) -> Self {
        Text { id, arguments: Vec::new() }
    }

    /// With words, a number or a name for `{name}`.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl ToString) -> Self {
        self.arguments.push((name, Argument::Words(value.to_string())));
        self
    }

    /// With another text for `{name}`.
    #[must_use]
    pub fn with_text(mut self, name: &'static str, text: Text) -> Self {
        self.arguments.push((name, Argument::Text(text)));
        self
    }

    /// With a name for `{name}` that stands in no table: as it is in English and in German.
    #[must_use]
    pub fn with_name(mut self, name: &'static str, english: &str, german: &str) -> Self {
        self.arguments.push((name, Argument::Name(english.to_owned(), german.to_owned())));
        self
    }

    /// With a number of so many decimals for `{name}`: 1.5 in English, 1,5 in German.
    #[must_use]
    pub fn with_number(mut self, name: &'static str, value: f64, decimals: usize) -> Self {
        self.arguments.push((name, Argument::Number(format!("{value:.decimals$}"))));
        self
    }

    /// With other texts for `{name}`, one after the other with commas.
    #[must_use]
    pub fn with_list(mut self, name: &'static str, texts: impl IntoIterator<Item = Text>) -> Self {
        self.arguments.push((name, Argument::List(texts.into_iter().collect())));
        self
    }

    /// The text of that name with the arguments with which it is `words` in English; nothing where it cannot be.
    pub(crate) fn recognised(id: &'static str, words: &str) -> Option<Self> {
        let mut text = Text::new(id);
        let (mut template, mut rest) = (BUILT_IN.0.get(id)?.en.as_str(), words);
        while let Some((before, after)) = template.split_once('{') {
            let (name, behind) = after.split_once('}')?;
            rest = rest.strip_prefix(before)?;
            // An argument ends where what stands behind it begins; the last one, where that is the end.
            let length = match behind.split_once('{') {
                Some((literal, _)) => rest.find(literal)?,
                None => rest.strip_suffix(behind)?.len(),
            };
            let (argument, remaining) = rest.split_at_checked(length)?;
            text = text.with(name, argument);
            (template, rest) = (behind, remaining);
        }
        (template == rest).then_some(text)
    }

    /// It is about this file.
    pub(super) fn is_about(&self, path: &Path) -> bool {
        let name = path.display().to_string();
        let is_it = |(argument, value): &(&str, Argument)| {
            *argument == "path" && matches!(value, Argument::Words(words) if *words == name)
        };
        self.arguments.iter().any(is_it)
    }

    /// The text's name in the table.
    pub fn id(&self) -> &'static str {
        self.id
    }

    /// The words in the window, with hints for somebody in front of it.
    pub fn words(&self, language: Language) -> String {
        self.said(Place::Window(language))
    }

    /// The words on the command line, which always speaks English, with hints for its users.
    pub fn terminal(&self) -> String {
        self.said(Place::Terminal)
    }

    fn said(&self, place: Place) -> String {
        let Some(row) = BUILT_IN.0.get(self.id) else { return self.id.to_owned() };
        let template = match place {
            Place::Window(Language::German) => &row.de,
            Place::Terminal if !row.terminal.is_empty() => &row.terminal,
            Place::Window(Language::English) | Place::Terminal => &row.en,
        };
        // One pass over the template: an argument may contain braces of its own.
        let mut words = String::new();
        let mut rest = template.as_str();
        while let Some((before, after)) = rest.split_once('{') {
            words.push_str(before);
            let Some((name, behind)) = after.split_once('}') else { break };
            match self.arguments.iter().find(|(own, _)| *own == name) {
                Some((_, argument)) => words.push_str(&argument.said(place)),
                None => words.push_str(name),
            }
            rest = behind;
        }
        words.push_str(rest);
        words
    }
}

/// A number in digits with the language's decimal sign.
pub(crate) fn signed(number: &str, language: Language) -> String {
    Argument::Number(number.to_owned()).said(Place::Window(language))
}

/// A number of so many decimals with the language's decimal sign.
pub fn decimal(value: f64, decimals: usize, language: Language) -> String {
    Argument::Number(format!("{value:.decimals$}")).said(Place::Window(language))
}

impl Texts {
    /// The table's source.
    pub const SOURCE: &'static str = include_str!("../../assets/texts.ron");

    /// The table that ships with the program.
    pub fn built_in() -> &'static Texts {
        &BUILT_IN
    }

    /// Names of all texts.
    pub fn ids(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(template: &str) -> Vec<&str> {
        let mut places: Vec<&str> =
            template.split('{').skip(1).filter_map(|part| part.split_once('}')).map(|(name, _)| name).collect();
        places.sort_unstable();
        places.dedup();
        places
    }

    #[test]
    fn both_languages_say_the_same_things() {
        let table: BTreeMap<String, Row> = ron::from_str(Texts::SOURCE).unwrap();
        assert!(!table.is_empty());
        for (id, row) in &table {
            assert!(!row.en.is_empty() && !row.de.is_empty(), "{id}");
            assert_eq!(places(&row.en), places(&row.de), "{id}");
            assert!(places(&row.terminal).iter().all(|place| places(&row.en).contains(place)), "{id}");
        }
    }

    #[test]
    fn no_row_hides_another() {
        let names =
            Texts::SOURCE.lines().filter_map(|line| line.strip_prefix("    \"")?.split_once("\": (")).map(|row| row.0);
        let names: Vec<&str> = names.collect();
        assert_eq!(names.len(), Texts::built_in().ids().count(), "a name stands twice");
    }

    #[test]
    fn arguments_are_filled_in_once() {
        let text = Text::new("link.busy").with("target", "{target}");
        assert!(text.words(Language::English).starts_with("{target} is in use"));
        assert!(text.words(Language::German).starts_with("{target} wird von"));
    }

    #[test]
    fn numbers_and_lists_are_said_in_the_language() {
        let text = Text::new("link.busy").with_number("target", 1.25, 1);
        assert!(text.words(Language::English).starts_with("1.2 is"));
        assert!(text.words(Language::German).starts_with("1,2 wird"));
        assert!(text.terminal().starts_with("1.2 is"));
        let list = [Text::new("status.code_09"), Text::new("status.code_0a")];
        let text = Text::new("encoder.rejected").with("command", "reset").with_list("codes", list);
        assert!(text.words(Language::German).ends_with("abgelehnt: Paritätsfehler, Prüfsummenfehler."));
    }

    #[test]
    fn the_command_line_has_hints_of_its_own() {
        let cause = Text::new("link.not_found").with("target", "COM3");
        let text = Text::new("encoder.unclear").with("command", "reset").with_text("cause", cause);
        assert!(text.terminal().contains("\"encoder-studio ports\" lists"), "{}", text.terminal());
        assert!(text.words(Language::English).contains("Connect… lists"), "{}", text.words(Language::English));
        assert_eq!(Text::new("encoder.cancelled").terminal(), Text::new("encoder.cancelled").words(Language::English));
    }

    #[test]
    fn a_text_is_recognised_by_its_english_words() {
        let recognised = |id, words| Text::recognised(id, words).map(|text| text.words(Language::German));
        assert_eq!(recognised("phrase.number", "a number from 1 to 8").unwrap(), "eine Zahl von 1 bis 8");
        assert_eq!(recognised("phrase.text", "a text").unwrap(), "ein Text");
        assert_eq!(recognised("phrase.twice", "a {b} stands twice").unwrap(), "a {b} steht zweimal da");
        for (id, words) in [("phrase.text", "a text such"), ("phrase.number", "a number"), ("phrase.twice", "twice")] {
            assert_eq!(recognised(id, words), None, "{words}");
        }
    }

    #[test]
    fn the_window_says_nothing_about_the_command_line() {
        let table: BTreeMap<String, Row> = ron::from_str(Texts::SOURCE).unwrap();
        for (id, row) in &table {
            for hint in ["--", "encoder-studio ", "=HEX", "echo=", "do hiperface"] {
                assert!(!row.en.contains(hint) && !row.de.contains(hint), "{id}: {hint}");
            }
        }
    }
}
