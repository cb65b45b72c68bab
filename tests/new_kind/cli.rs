//! The test kind on the command line. The test binary runs the program in separate processes.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use encoder_studio::cli::{Invocation, run as run_program};

use super::desk::program;

/// The environment variable that contains the program's arguments, one per line.
const ARGUMENTS: &str = "NEW_KIND_ARGUMENTS";

/// Runs the program in a process started by [`start`]. Without arguments, the program requests the window.
#[test]
fn program_under_test() {
    let arguments = std::env::var(ARGUMENTS).unwrap_or_default();
    let words = std::iter::once("encoder-studio").chain(arguments.lines()).map(Into::into);
    let program = program();
    match run_program(words, program.studio, program.commands) {
        Invocation::Command(status) => std::process::exit(status.into()),
        Invocation::Window(_) => assert!(arguments.is_empty()),
    }
}

/// Starts the program with the given arguments in a separate process and folder.
fn start(home: &Path, arguments: &[&str]) -> Child {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", "cli::program_under_test", "--nocapture"]).env(ARGUMENTS, arguments.join("\n"));
    command.env("HOME", home).env("XDG_DATA_HOME", home).env("XDG_CONFIG_HOME", home).current_dir(home);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Runs a command and returns its exit status, standard output and standard error.
fn run(home: &Path, arguments: &[&str]) -> (i32, String, String) {
    let output = start(home, arguments).wait_with_output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let printed = text(output.stdout).replace("\nrunning 1 test\n", "");
    (output.status.code().unwrap(), printed, text(output.stderr))
}

#[test]
fn command_line_round_trip() {
    let home = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run(home.path(), arguments);
    let done = |printed: &str| (0, printed.to_owned(), String::new());
    assert_eq!(run(&["identify", "novo", "--link", "sim:?serial=77"]), done("serial number  77\n"));
    assert_eq!(
        run(&["position", "novo", "--link", "sim:", "--json", "--count", "2"]).1,
        "{\"position\":0}\n".repeat(2)
    );
    assert_eq!(run(&["save", "novo", "--link", "sim:", "-o", "a.ron"]), done("a.ron\n"));
    assert_eq!(run(&["verify", "a.ron", "--link", "sim:"]), done("equal (4 compared)\n"));

    let profile = home.path().join("a.ron");
    let text = std::fs::read_to_string(&profile).unwrap();
    std::fs::write(&profile, text.replace("least: 0", "least: 512")).unwrap();
    let (status, printed, _) = run(&["verify", "a.ron", "--link", "sim:"]);
    assert_eq!((status, printed.as_str()), (3, "least  512  →  0\ndifferent (4 compared)\n"));
    let (status, printed, said) = run(&["restore", "a.ron", "--link", "sim:", "--yes", "--json"]);
    let result: serde_json::Value = serde_json::from_str(&printed).unwrap_or_else(|_| panic!("{printed}{said}"));
    let counted = ["written", "unchanged", "verified", "write_cycles"].map(|name| result[name].as_u64().unwrap());
    assert_eq!((status, counted), (0, [1, 3, 1, 1]));
    assert!(Path::new(result["backup"].as_str().unwrap()).exists());
    let (status, _, said) = run(&["restore", "a.ron", "--link", "sim:?serial=5", "--yes"]);
    assert_eq!((status, said.as_str()), (1, "error: the profile is of serial number 1001, the encoder has 5\n"));
}

#[test]
fn rejects_unsupported_commands() {
    let home = tempfile::tempdir().unwrap();
    for arguments in [["status", "novo", "--link", "sim:"], ["identify", "novo", "--link", "modbus:plc"]] {
        let (status, printed, said) = run(home.path(), &arguments);
        assert!(status == 2 && printed.is_empty() && !said.is_empty(), "{arguments:?} {said}");
    }
}

#[test]
fn simulates_encoder() {
    let home = tempfile::tempdir().unwrap();
    let mut served = start(home.path(), &["simulate", "novo", "--listen", "127.0.0.1:0", "--set", "serial=7000"]);
    let lines = BufReader::new(served.stdout.take().unwrap()).lines().map(Result::unwrap);
    let place = lines.into_iter().find_map(|line| line.strip_prefix("ready novo ").map(ToOwned::to_owned)).unwrap();
    let (status, printed, said) = run(home.path(), &["identify", "novo", "--link", &format!("tcp:{place}")]);
    served.kill().unwrap();
    served.wait().unwrap();
    assert_eq!((status, printed.as_str()), (0, "serial number  7000\n"), "{said}");
}
