//! Architecture rules that the compiler does not check: layers use only lower ones, protocol code is pure, simulators
//! do not use procedures, only the user can give consent, and every text is in a catalogue.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

mod adapter;
mod paths;
mod places;
mod words;

use paths::{Used, paths};
use places::{Owner, Place, module_path_segments};

/// The only file that lists all devices and the parts added by buses and Signals.
const KINDS_FILE: &str = "src/kinds.rs";

struct Source {
    path: String,
    modules: Vec<String>,
    place: Place,
    text: String,
}

impl Source {
    /// Returns the numbered lines of code, excluding comments and tests.
    fn code(&self) -> impl Iterator<Item = (usize, &str)> {
        self.without_tests().lines().enumerate().map(|(at, line)| (at + 1, line.split("//").next().unwrap_or_default()))
    }

    /// Returns the text without a test module at the end of the file. `#[cfg(test)] mod tests;` is kept wherever it is.
    fn without_tests(&self) -> &str {
        let end = self.text.find("\n#[cfg(test)]\nmod tests {").unwrap_or(self.text.len());
        &self.text[..end]
    }

    /// Returns the folder of the file within `src`.
    fn folder(&self) -> Option<&str> {
        Some(self.path.strip_prefix("src/")?.rsplit_once('/')?.0)
    }

    fn is_test(&self) -> bool {
        self.path.contains("/tests") || self.path.contains("vectors")
    }

    /// Returns the modules of other folders that the code uses, with their locations.
    fn uses(&self, text: &str) -> Vec<(Used, Place)> {
        let used = paths(&self.modules, text);
        let placed = used.into_iter().filter_map(|used| Place::of(&used.path).map(|place| (used, place)));
        placed.filter(|(_, place)| *place != self.place).collect()
    }
}

fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    collect(&root, &mut files);
    files
        .into_iter()
        .map(|file| {
            let inside = file.strip_prefix(&root).unwrap().to_str().unwrap();
            let (path, modules) = (format!("src/{inside}"), module_path_segments(inside));
            let place = Place::of(&modules).unwrap_or_else(|| panic!("{path} has no place: see ARCHITECTURE.md"));
            let is_loose = matches!(place.owner, Owner::Device(_)) && place.layer == "kinds" && modules.len() > 2;
            assert!(!is_loose, "{path} stands in no module of its device: see ARCHITECTURE.md");
            Source { path, modules, place, text: fs::read_to_string(&file).unwrap() }
        })
        .collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// Returns whether a path is the list of devices for the virtual adapter, which is needed to open an adapter. Devices,
/// bus tests and Signals may use no other part of the list of kinds.
fn is_attachable_kinds_path(path: &[String]) -> bool {
    path == ["kinds", "attachable_kinds"]
}

#[test]
fn layers_use_only_lower_layers() {
    for source in sources() {
        for (used, place) in source.uses(source.without_tests()) {
            let up = place.floor() > source.place.floor() && !is_attachable_kinds_path(&used.path);
            assert!(!up, "{}:{} reaches up to {}", source.path, used.line, used.path.join("::"));
        }
    }
}

/// Layers on the same level may use each other only as listed here.
#[test]
fn same_level_dependencies_are_listed() {
    const ALLOWED: [(&str, &str); 4] =
        [("profile", "protocol"), ("link", "sim"), ("worker", "procedures"), ("cli", "app")];
    for source in sources().iter().filter(|source| source.place.floor() < 6) {
        for (used, place) in source.uses(source.without_tests()) {
            let (own, other) = (source.place.layer, place.layer);
            let neighbour = place.floor() == source.place.floor() && other != own;
            let allowed = !neighbour || ALLOWED.contains(&(own, other)) || place.floor() == 1;
            assert!(allowed, "{}:{} uses its neighbour {}", source.path, used.line, used.path.join("::"));
        }
    }
}

/// Two folders that depend on each other would effectively be a single folder. Subfolders count as part of a folder.
#[test]
fn core_folders_are_acyclic() {
    let sources: Vec<Source> = sources().into_iter().filter(|source| source.place.owner == Owner::Core).collect();
    let folders: BTreeSet<&str> = sources.iter().filter_map(|source| source.folder()).collect();
    let mut uses: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for source in sources.iter().filter(|source| !source.is_test()) {
        let Some(own) = source.folder() else { continue };
        for used in paths(&source.modules, source.without_tests()) {
            let longest = (1..=used.path.len()).rev().map(|count| used.path[..count].join("/"));
            let other = longest.filter_map(|path| folders.get(path.as_str()).copied()).next();
            let apart = |other: &&str| !Path::new(own).starts_with(other) && !Path::new(other).starts_with(own);
            uses.entry(own).or_default().extend(other.filter(apart));
        }
    }
    // A folder that uses none of the remaining folders cannot be part of a cycle.
    while let Some(last) = uses.iter().find(|(_, used)| !used.iter().any(|own| uses.contains_key(own))) {
        let last = *last.0;
        uses.remove(last);
    }
    assert!(uses.is_empty(), "these use each other: {uses:?}");
}

/// The list of kinds may use everything. Devices may use buses, and so may Signals for an adapter's inputs.
#[test]
fn device_and_bus_uses_are_allowed() {
    for source in sources() {
        let lists = source.path == KINDS_FILE || source.path.starts_with("src/kinds/");
        for (used, place) in source.uses(&source.text) {
            let allowed = match (&source.place.owner, &place.owner) {
                (_, Owner::Core) => true,
                (Owner::Device(_) | Owner::Signals, Owner::Bus(_)) => true,
                (own, other) => own == other || lists,
            };
            assert!(allowed, "{}:{} knows {}", source.path, used.line, used.path.join("::"));
        }
    }
}

#[test]
fn lower_layers_are_pure() {
    const FORBIDDEN: [&str; 12] = [
        "std::net",
        "std::fs",
        "std::io",
        "std::thread",
        "std::sync",
        "std::process",
        "Instant",
        "SystemTime",
        "crossbeam",
        "serialport",
        "egui",
        "jiff",
    ];
    for source in sources().iter().filter(|source| source.place.floor() <= 2 && !source.is_test()) {
        for (line, code) in source.code() {
            let found = FORBIDDEN.iter().find(|word| code.contains(**word));
            assert!(found.is_none(), "{}:{line} uses {}", source.path, found.unwrap());
        }
    }
}

#[test]
fn simulators_use_no_clock_or_procedures() {
    for source in sources().iter().filter(|source| source.place.layer == "sim") {
        for (line, code) in source.code() {
            for word in ["std::thread", "Instant", "SystemTime"] {
                assert!(!code.contains(word), "{}:{line} uses {word}", source.path);
            }
        }
        for (used, place) in source.uses(source.without_tests()) {
            let known = !["procedures", "worker", "link"].contains(&place.layer);
            assert!(known, "{}:{} uses {}", source.path, used.line, used.path.join("::"));
        }
    }
}

#[test]
fn only_front_ends_give_consent() {
    let gives = |source: &Source| !source.is_test() && source.code().any(|(_, code)| code.contains("Consent::to("));
    let mut found: Vec<String> = sources().into_iter().filter(gives).map(|source| source.path).collect();
    found.sort();
    assert_eq!(found, ["src/app/session/memory.rs", "src/cli/consent.rs"]);
}

/// Operations require a confirmed plan. The only function that confirms a plan also saves the backup.
#[test]
fn only_commit_module_confirms_plans() {
    let confirms = |source: &Source| source.code().any(|(_, code)| code.contains("ConfirmedPlan::confirm("));
    let found: Vec<String> = sources().into_iter().filter(confirms).map(|source| source.path).collect();
    assert_eq!(found, ["src/worker/commit.rs"]);
}

#[test]
fn modules_are_documented_and_short() {
    for source in sources() {
        assert!(source.text.starts_with("//!"), "{} does not open with //!", source.path);
        let length = source.text.lines().count();
        assert!(length <= 450, "{} has {length} lines: split it by concept", source.path);
        for (at, line) in source.text.lines().enumerate() {
            let open = ["TODO", "FIXME", "XXX"].iter().any(|word| line.contains(word)) && !line.contains('#');
            assert!(!open, "{}:{} has a left-over without an issue's number", source.path, at + 1);
        }
    }
}

/// Returns the text IDs in an owner's catalogue.
fn catalogue_ids(owner: &Owner) -> BTreeSet<String> {
    let name = match owner {
        Owner::Core => "common",
        Owner::Device(name) | Owner::Bus(name) => name,
        Owner::Signals => "signals",
    };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/texts").join(name).with_extension("ron");
    let Ok(source) = fs::read_to_string(path) else { return BTreeSet::new() };
    let names = source.lines().filter_map(|line| line.strip_prefix("    \"")?.split_once("\": ("));
    names.map(|(name, _)| name.to_owned()).collect()
}

/// The text IDs that a source file may use: those in its owner's catalogue, and the common ones.
struct Known(Vec<(Owner, BTreeSet<String>)>);

impl Known {
    fn read(sources: &[Source]) -> Self {
        let mut known = vec![(Owner::Core, catalogue_ids(&Owner::Core))];
        for source in sources {
            if known.iter().all(|(owner, _)| *owner != source.place.owner) {
                known.push((source.place.owner.clone(), catalogue_ids(&source.place.owner)));
            }
        }
        let names = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/texts")).unwrap().count();
        assert_eq!(known.iter().filter(|(_, ids)| !ids.is_empty()).count(), names, "a catalogue that no place has");
        Known(known)
    }

    fn holds(&self, source: &Source, id: &str) -> bool {
        self.0.iter().any(|(owner, ids)| {
            let may = *owner == Owner::Core || *owner == source.place.owner;
            may && ids.contains(id)
        })
    }
}

#[test]
fn text_table_is_complete_and_used() {
    let sources = sources();
    let known = Known::read(&sources);
    let areas: BTreeSet<&str> =
        known.0.iter().flat_map(|(_, ids)| ids).filter_map(|id| id.split_once('.')).map(|(area, _)| area).collect();
    let mut used = BTreeSet::new();
    // Texts are used by the layers from the state upwards and by tables of parameters, whose entries are named where
    // they are declared.
    let says = |source: &&Source| source.place.floor() >= 5 || source.text.contains("parameters! {");
    for source in sources.iter().filter(says).filter(|source| !source.path.ends_with("texts.rs")) {
        for (line, code) in source.code() {
            for word in code.split('"').skip(1).step_by(2) {
                let looks_like_an_id = word.split_once('.').is_some_and(|(area, name)| {
                    areas.contains(area)
                        && !name.is_empty()
                        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
                });
                if looks_like_an_id {
                    assert!(known.holds(source, word), "{}:{line}: \"{word}\" is not in assets/texts", source.path);
                    used.insert(word.to_owned());
                }
            }
        }
    }
    // The id of a text for a numbered table row is checked against that table.
    let is_numbered = |id: &str| id.split_once('.').is_some_and(|(_, name)| name.parse::<u16>().is_ok());
    let ids = known.0.iter().flat_map(|(_, ids)| ids);
    let unused: Vec<&String> = ids.filter(|id| !used.contains(*id) && !is_numbered(id)).collect();
    assert!(unused.is_empty(), "rows of assets/texts that nothing uses: {unused:?}");
}

#[test]
fn only_window_draws() {
    for source in sources().iter().filter(|source| source.place.layer != "ui") {
        for (line, code) in source.code() {
            assert!(!code.contains("egui") && !code.contains("eframe"), "{}:{line} names egui", source.path);
        }
    }
}

/// All texts in the window come from the catalogues. A literal in a view must be a text ID or invisible. It counts as
/// text if it contains three or more consecutive letters that are not all capitals.
#[test]
fn views_contain_no_literals() {
    /// Code before a literal that is an identifier for egui, an argument of a text, or a name for the system or the
    /// compiler.
    const NAMES: [&str; 21] = [
        "Id::unique(",
        "id_salt(",
        "make_persistent_id(",
        "make_persistent_id((",
        "modal(ctx, theme,",
        "with_stable_ids(ui,",
        "add_filter(filter, &[",
        "Panel::top(",
        "Panel::bottom(",
        "Panel::left(",
        "Panel::right(",
        "Plot::new(",
        ".with(",
        "Grid::new(",
        ".with_text(",
        ".with_number(",
        ".name(",
        "env!(",
        "include_str!(",
        "target_os =",
        "reason =",
    ];
    /// The name of the program, example inputs, and names from the manual.
    const ALLOWED: [&str; 7] =
        ["encoder-studio", "drop:0.01", "capture.trace", "atm60,code=gray", "error%1bposition%24ge", "nERR", "nWARN"];
    /// Files that are not views: they contain terminal messages or names of renderers and fonts.
    const NO_VIEWS: [&str; 3] = ["src/ui/renderer.rs", "src/ui/run.rs", "src/ui/theme.rs"];
    let sources = sources();
    let known = Known::read(&sources);
    let mut texts = Vec::new();
    let is_view = |source: &&Source| source.place.layer == "ui" && !source.is_test();
    for source in sources.iter().filter(is_view).filter(|source| !NO_VIEWS.contains(&source.path.as_str())) {
        for literal in literals(&source.text) {
            let name = NAMES.iter().any(|before| literal.before.ends_with(before));
            let word = has_word(&literal.text) && !known.holds(source, &literal.text);
            if word && !name && !ALLOWED.contains(&literal.text.as_str()) {
                texts.push(format!("{}:{} {:?}", source.path, literal.line, literal.text));
            }
        }
    }
    assert!(texts.is_empty(), "literal texts:\n{}", texts.join("\n"));
}

#[test]
fn used_texts_are_in_table() {
    let sources = sources();
    let known = Known::read(&sources);
    for source in sources.iter().filter(|source| source.place.floor() >= 5 && !source.is_test()) {
        for literal in literals(&source.text) {
            let asked = ["Text::new(", "TEXTS.text(", "theme.translate(", "translate(theme,"]
                .iter()
                .any(|before| literal.before.ends_with(before))
                && !literal.before.ends_with("RichText::new(");
            let place = format!("{}:{}", source.path, literal.line);
            assert!(!asked || known.holds(source, &literal.text), "{place}: no text {:?}", literal.text);
        }
    }
}

/// Returns whether a string has three or more consecutive letters that are not all capitals, outside format arguments.
fn has_word(text: &str) -> bool {
    let mut bare = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('{') {
        bare.push_str(before);
        bare.push(' ');
        rest = after.split_once('}').map_or("", |(_, behind)| behind);
    }
    bare.push_str(rest);
    let words = bare.split(|c: char| !c.is_alphabetic());
    words.into_iter().any(|word| word.chars().count() >= 3 && word.chars().any(char::is_lowercase))
}

/// A string literal and the text before it.
struct Literal {
    line: usize,
    before: String,
    text: String,
}

/// Returns the string literals in a source file, excluding comments and tests at its end.
fn literals(source: &str) -> Vec<Literal> {
    let source = source.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let characters: Vec<char> = source.chars().collect();
    let mut found = Vec::new();
    let (mut at, mut line) = (0, 1);
    while at < characters.len() {
        match (characters[at], characters.get(at + 1)) {
            ('/', Some('/')) => {
                while at < characters.len() && characters[at] != '\n' {
                    at += 1;
                }
            }
            // A character literal may be a quotation mark. A lifetime has no second quote.
            ('\'', Some('\\')) => at += 3,
            ('\'', Some(_)) if characters.get(at + 2) == Some(&'\'') => at += 3,
            ('"', _) => {
                let (first, own) = (at + 1, line);
                at = first;
                while characters[at] != '"' {
                    line += usize::from(characters[at] == '\n');
                    at += if characters[at] == '\\' { 2 } else { 1 };
                }
                let before: String = characters[first.saturating_sub(60)..first - 1].iter().collect();
                let text: String = characters[first..at].iter().collect();
                let before = before.trim_end().to_owned();
                found.push(Literal { line: own, before, text: unescaped(&text) });
                at += 1;
            }
            (character, _) => {
                line += usize::from(character == '\n');
                at += 1;
            }
        }
    }
    found
}

/// Returns a text with escape sequences removed. No escape sequence in the texts stands for a letter.
fn unescaped(text: &str) -> String {
    let mut characters = text.chars();
    let mut bare = String::new();
    while let Some(character) = characters.next() {
        match character {
            '\\' => match characters.next() {
                Some('u') => drop(characters.by_ref().find(|c| *c == '}')),
                _ => bare.push(' '),
            },
            other => bare.push(other),
        }
    }
    bare
}

#[test]
fn detects_literals() {
    let source =
        "fn a<'x>() { // \"no text\"\n  say(\"page.memory\"); b('\"', \"one \\\"two\\\"\");\n  c(\"{value:.3} mm\"); }";
    let found: Vec<(usize, String)> = literals(source).into_iter().map(|own| (own.line, own.text)).collect();
    let expected = [(2, "page.memory"), (2, "one  two "), (3, "{value:.3} mm")];
    assert_eq!(found, expected.map(|(line, text)| (line, text.to_owned())));
    for (text, word) in
        [("Save", true), ("{value} steps", true), ("HIPERFACE", false), ("{value} mm", false), ("kHz", true)]
    {
        assert_eq!(has_word(text), word, "{text}");
    }
}
