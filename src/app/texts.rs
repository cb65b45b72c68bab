//! Texts in English and German from the catalogues in `assets/texts`: a common one, and one each for the devices, the
//! adapter and the Signals tool. Each text refers to its catalogue.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Language {
    English,
    German,
}

/// A text from a catalogue with its arguments, independent of the language.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    catalogue: &'static Catalogue,
    id: &'static str,
    arguments: Vec<(&'static str, TextArgument)>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum TextArgument {
    Words(String),
    /// A number with a decimal point, as written in English.
    Number(String),
    Name(String, String),
    Text(Text),
    List(Vec<Text>),
}

impl TextArgument {
    /// Returns the heap memory of the argument in bytes.
    fn size(&self) -> usize {
        match self {
            TextArgument::Words(words) | TextArgument::Number(words) => words.len(),
            TextArgument::Name(english, german) => english.len() + german.len(),
            TextArgument::Text(text) => text.size(),
            TextArgument::List(texts) => texts.iter().map(Text::size).sum(),
        }
    }

    fn text_for(&self, place: Output) -> String {
        match self {
            TextArgument::Number(number) if matches!(place, Output::Window(Language::German)) => {
                number.replace('.', ",")
            }
            TextArgument::Name(_, german) if matches!(place, Output::Window(Language::German)) => german.clone(),
            TextArgument::Words(words) | TextArgument::Number(words) | TextArgument::Name(words, _) => words.clone(),
            TextArgument::Text(text) => text.text_for(place),
            TextArgument::List(texts) => texts.iter().map(|text| text.text_for(place)).collect::<Vec<_>>().join(", "),
        }
    }
}

pub struct Catalogue {
    source: &'static str,
    rows: OnceLock<BTreeMap<String, Row>>,
}

/// The catalogue of texts that are not specific to a device.
pub static COMMON: Catalogue = Catalogue::new(include_str!("../../assets/texts/common.ron"));

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    en: String,
    de: String,
    /// English text for the command line, or an empty string if it is the same as in the window.
    #[serde(default)]
    terminal: String,
}

#[derive(Clone, Copy)]
enum Output {
    Window(Language),
    Terminal,
}

impl Text {
    pub fn new(id: &'static str) -> Self {
        COMMON.text(id)
    }

    /// Replaces `{name}` with a value that is the same in every language.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl ToString) -> Self {
        self.arguments.push((name, TextArgument::Words(value.to_string())));
        self
    }

    /// Replaces `{name}` with another text.
    #[must_use]
    pub fn with_text(mut self, name: &'static str, text: Text) -> Self {
        self.arguments.push((name, TextArgument::Text(text)));
        self
    }

    /// Replaces `{name}` with a name given in English and German.
    #[must_use]
    pub fn with_name(mut self, name: &'static str, english: &str, german: &str) -> Self {
        self.arguments.push((name, TextArgument::Name(english.to_owned(), german.to_owned())));
        self
    }

    /// Replaces `{name}` with a number rounded to the given decimals, such as 1.5 in English and 1,5 in German.
    #[must_use]
    pub fn with_number(mut self, name: &'static str, value: f64, decimals: usize) -> Self {
        self.arguments.push((name, TextArgument::Number(format!("{value:.decimals$}"))));
        self
    }

    /// Replaces `{name}` with a formatted number. Only the decimal separator is adapted to the language.
    #[must_use]
    pub(crate) fn with_formatted_number(mut self, name: &'static str, digits: impl ToString) -> Self {
        self.arguments.push((name, TextArgument::Number(digits.to_string())));
        self
    }

    /// Replaces `{name}` with several texts, separated by commas.
    #[must_use]
    pub fn with_list(mut self, name: &'static str, texts: impl IntoIterator<Item = Text>) -> Self {
        self.arguments.push((name, TextArgument::List(texts.into_iter().collect())));
        self
    }

    pub(super) fn refers_to(&self, path: &Path) -> bool {
        let name = path.display().to_string();
        let is_it = |(argument, value): &(&str, TextArgument)| {
            *argument == "path" && matches!(value, TextArgument::Words(words) if *words == name)
        };
        self.arguments.iter().any(is_it)
    }

    /// Returns the approximate memory use in bytes.
    pub(super) fn size(&self) -> usize {
        let arguments = self.arguments.iter().map(|(_, own)| size_of_val(own) + size_of::<&str>() + own.size());
        size_of::<Self>() + arguments.sum::<usize>()
    }

    pub fn id(&self) -> &'static str {
        self.id
    }

    pub fn to_string_in(&self, language: Language) -> String {
        self.text_for(Output::Window(language))
    }

    /// Returns the text for the command line, in English and with hints for the command line.
    pub fn terminal_text(&self) -> String {
        self.text_for(Output::Terminal)
    }

    fn text_for(&self, place: Output) -> String {
        let Some(row) = self.catalogue.rows().get(self.id) else { return self.id.to_owned() };
        let template = match place {
            Output::Window(Language::German) => &row.de,
            Output::Terminal if !row.terminal.is_empty() => &row.terminal,
            Output::Window(Language::English) | Output::Terminal => &row.en,
        };
        // The template is scanned only once, because an argument may itself contain braces.
        let mut words = String::new();
        let mut rest = template.as_str();
        while let Some((before, after)) = rest.split_once('{') {
            words.push_str(before);
            let Some((name, behind)) = after.split_once('}') else { break };
            match self.arguments.iter().find(|(own, _)| *own == name) {
                Some((_, argument)) => words.push_str(&argument.text_for(place)),
                None => words.push_str(name),
            }
            rest = behind;
        }
        words.push_str(rest);
        words
    }
}

/// Adapts the decimal point of a formatted number to a language.
pub(crate) fn localize_number(number: &str, language: Language) -> String {
    TextArgument::Number(number.to_owned()).text_for(Output::Window(language))
}

/// Formats a number with the given number of decimals and the decimal separator of a language.
pub fn format_decimal(value: f64, decimals: usize, language: Language) -> String {
    TextArgument::Number(format!("{value:.decimals$}")).text_for(Output::Window(language))
}

impl From<&'static str> for Text {
    fn from(id: &'static str) -> Self {
        Text::new(id)
    }
}

impl Catalogue {
    pub const fn new(source: &'static str) -> Self {
        Catalogue { source, rows: OnceLock::new() }
    }

    /// Returns the text with the given id from this catalogue, or else from the common one.
    pub fn text(&'static self, id: &'static str) -> Text {
        let is_own = *self != COMMON && self.rows().contains_key(id);
        let catalogue = if is_own { self } else { &COMMON };
        // An unknown id is found by the tests. The window would show the id instead of a text.
        debug_assert!(catalogue.rows().contains_key(id), "no text {id}");
        Text { catalogue, id, arguments: Vec::new() }
    }

    /// Returns the text for an entry of a numbered table, such as `hd_parameter.158`.
    pub(crate) fn numbered_text(&'static self, area: &str, number: u16) -> Option<Text> {
        let (id, _) = self.rows().get_key_value(&format!("{area}.{number}"))?;
        Some(Text { catalogue: self, id, arguments: Vec::new() })
    }

    pub fn ids(&self) -> impl Iterator<Item = &str> {
        self.rows().keys().map(String::as_str)
    }

    pub fn source(&self) -> &'static str {
        self.source
    }

    fn rows(&self) -> &BTreeMap<String, Row> {
        // A test checks that the catalogue can be parsed. Otherwise the window would show ids instead of texts.
        self.rows.get_or_init(|| ron::from_str(self.source).unwrap_or_default())
    }
}

impl PartialEq for Catalogue {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl Eq for Catalogue {}

impl fmt::Debug for Catalogue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Catalogue({} rows)", self.rows().len())
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

    fn catalogues() -> BTreeMap<String, String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/texts");
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        files.map(|path| (path.display().to_string(), std::fs::read_to_string(&path).unwrap())).collect()
    }

    fn rows(source: &str) -> BTreeMap<String, Row> {
        ron::from_str(source).unwrap()
    }

    #[test]
    fn languages_share_texts_and_arguments() {
        for (file, source) in catalogues() {
            let table = rows(&source);
            assert!(!table.is_empty(), "{file}");
            for (id, row) in &table {
                assert!(!row.en.is_empty() && !row.de.is_empty(), "{id}");
                assert_eq!(places(&row.en), places(&row.de), "{id}");
                assert!(places(&row.terminal).iter().all(|place| places(&row.en).contains(place)), "{id}");
            }
        }
    }

    #[test]
    fn text_ids_are_unique() {
        let (catalogues, mut names) = (catalogues(), std::collections::BTreeSet::new());
        for (file, source) in &catalogues {
            let own =
                source.lines().filter_map(|line| line.strip_prefix("    \"")?.split_once("\": (")).map(|row| row.0);
            let own: Vec<&str> = own.collect();
            assert_eq!(own.len(), rows(source).len(), "a name appears twice in {file}");
            for name in own {
                assert!(names.insert(name), "{name} stands in two files");
            }
        }
    }

    #[test]
    fn substitutes_arguments_once() {
        let text = Text::new("link.busy").with("target", "{target}");
        assert!(text.to_string_in(Language::English).starts_with("{target} is in use"));
        assert!(text.to_string_in(Language::German).starts_with("{target} wird von"));
    }

    #[test]
    fn localizes_numbers_and_lists() {
        let text = Text::new("link.busy").with_number("target", 1.25, 1);
        assert!(text.to_string_in(Language::English).starts_with("1.2 is"));
        assert!(text.to_string_in(Language::German).starts_with("1,2 wird"));
        assert!(text.terminal_text().starts_with("1.2 is"));
        let list = [Text::new("parity.even"), Text::new("parity.odd")];
        let text = Text::new("link.other").with("target", "COM3").with_list("why", list);
        assert!(
            text.to_string_in(Language::German).contains("gerade, ungerade"),
            "{}",
            text.to_string_in(Language::German)
        );
    }

    #[test]
    fn command_line_has_separate_hints() {
        let cause = Text::new("link.not_found").with("target", "COM3");
        let text = Text::new("link.other").with("target", "COM3").with_text("why", cause);
        assert!(text.terminal_text().contains("\"encoder-studio ports\" lists"), "{}", text.terminal_text());
        assert!(
            text.to_string_in(Language::English).contains("\"Connect…\" dialog lists"),
            "{}",
            text.to_string_in(Language::English)
        );
        assert_eq!(
            Text::new("encoder.cancelled").terminal_text(),
            Text::new("encoder.cancelled").to_string_in(Language::English)
        );
    }

    #[test]
    fn window_texts_omit_command_line() {
        for source in catalogues().values() {
            for (id, row) in &rows(source) {
                for hint in ["--", "encoder-studio ", "=HEX", "echo=", "do hiperface"] {
                    assert!(!row.en.contains(hint) && !row.de.contains(hint), "{id}: {hint}");
                }
            }
        }
    }
}
