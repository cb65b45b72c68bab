//! Tests of the command line that scripts rely on: the commands, options and values of all kinds.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use clap::Arg;

use crate::cli::command;
use crate::kinds::program;

/// Scripts rely on the commands, options and their values, but not on descriptions. `ENCODER_STUDIO_RECORD=1` updates
/// the recorded list.
#[test]
fn commands_match_recorded_options() {
    let mut text = String::new();
    list(&mut text, "encoder-studio", &command(program().commands));
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/cli/options.txt");
    if std::env::var_os("ENCODER_STUDIO_RECORD").is_some() {
        std::fs::write(path, &text).unwrap();
    }
    let recorded = std::fs::read_to_string(path).unwrap();
    let (is, was) = (arguments_by_command(&text), arguments_by_command(&recorded));
    assert_eq!(is.keys().collect::<Vec<_>>(), was.keys().collect::<Vec<_>>());
    for (command, own) in &is {
        assert_eq!(own, &was[command], "{command}");
    }
}

/// The positional arguments and the options of a command.
#[derive(Debug, Default, PartialEq)]
struct Taken<'t> {
    arguments: Vec<&'t str>,
    options: BTreeSet<&'t str>,
}

fn arguments_by_command(text: &str) -> BTreeMap<&str, Taken<'_>> {
    let mut commands: BTreeMap<&str, Taken<'_>> = BTreeMap::new();
    let mut command = "";
    for line in text.lines() {
        match line.strip_prefix("  ") {
            None => {
                command = line;
                assert!(commands.insert(line, Taken::default()).is_none(), "{line} stands there twice");
            }
            Some(own) if own.starts_with('<') => commands.entry(command).or_default().arguments.push(own),
            Some(own) => {
                assert!(commands.entry(command).or_default().options.insert(own), "{command} {own} twice");
            }
        }
    }
    commands
}

fn list(text: &mut String, path: &str, command: &clap::Command) {
    let _ = writeln!(text, "{path}");
    let arguments: Vec<&Arg> = command.get_arguments().collect();
    for arg in arguments {
        let name = match (arg.get_long(), arg.get_short()) {
            (Some(long), Some(short)) => format!("-{short}, --{long}"),
            (Some(long), None) => format!("--{long}"),
            (None, Some(short)) => format!("-{short}"),
            (None, None) => format!("<{}>", arg.get_id()),
        };
        let _ = write!(text, "  {name} {:?}", arg.get_action());
        for (word, is) in [("global", arg.is_global_set()), ("required", arg.is_required_set())] {
            let _ = write!(text, "{}", if is { format!(" {word}") } else { String::new() });
        }
        for value in arg.get_possible_values() {
            let _ = write!(text, " {}", value.get_name());
        }
        let _ = writeln!(text);
    }
    for own in command.get_subcommands() {
        list(text, &format!("{path} {}", own.get_name()), own);
    }
}
