//! Test support: runs the built program in a separate folder, with independent encoders and hosts (`tests/foreign`).

use std::ffi::OsStr;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Output, Stdio};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

use encoder_studio::profile::ChangedItem;
use encoder_studio::store::{DeviceKey, EntryKind, Intent, Logbook, Outcome};
use jiff::Timestamp;

use serde_json::Value;
use tempfile::TempDir;

/// Time limit that is longer than any program takes. A program that runs longer has hung.
const HANG_TIMEOUT: Duration = Duration::from_secs(60);

/// A temporary folder that contains all files of a test.
pub(crate) struct Bench {
    folder: TempDir,
    encoders: AtomicU32,
}

/// Exit status and output of a finished program.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) status: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
    pub(crate) took: Duration,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Bench { folder: TempDir::new().unwrap(), encoders: AtomicU32::new(0) }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Returns the path of a file as an argument.
    pub(crate) fn file(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        fs::write(self.path(name), content).unwrap();
        self.file(name)
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Opens the logbook in this folder.
    pub(crate) fn logbook(&self) -> Logbook {
        Logbook::open(&self.path("data").join("encoder-studio").join("logbook.sqlite")).unwrap()
    }

    /// Adds an old write to the logbook so that the device has the given number of write cycles.
    pub(crate) fn wear_to(&self, device: &DeviceKey, cycles: u64) {
        let mut logbook = self.logbook();
        let spent = cycles - logbook.write_cycles(device).unwrap();
        let items = vec![ChangedItem::new("long ago", None, None)];
        let intent = Intent { kind: EntryKind::Write, items, planned_cycles: spent, backup: None, undoes: None };
        let id = logbook.record_intent(Timestamp::now(), device, &intent).unwrap();
        logbook.record_outcome(id, Timestamp::now(), Outcome::Done, spent).unwrap();
    }

    /// Returns a command that starts the program with the given arguments.
    pub(crate) fn program(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_encoder-studio"));
        command
            .args(arguments)
            .env("HOME", self.folder.path())
            .env("XDG_DATA_HOME", self.path("data"))
            .env("XDG_CONFIG_HOME", self.path("config"))
            .env_remove("ENCODER_STUDIO_CODES")
            .env_remove("ENCODER_STUDIO_LOGBOOK")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Ran {
        finish(self.program(arguments))
    }

    /// Returns the content of all text files in the folder and its subfolders.
    pub(crate) fn all_text_files(&self) -> String {
        let mut text = String::new();
        collect(self.folder.path(), &mut text);
        text
    }

    /// Returns the text without the random folder name.
    pub(crate) fn with_folder_removed(&self, text: &str) -> String {
        text.replace(self.folder.path().to_str().unwrap(), "")
    }

    /// Starts an independent HIPERFACE encoder. If this is not possible, prints a line and returns `None`.
    pub(crate) fn encoder(&self, arguments: &[&str]) -> Option<Foreign> {
        self.start_on_terminal("encoder.py", "serial:", arguments)
    }

    /// Starts an independent kit encoder with UBICOM. If this is not possible, prints a line and returns `None`.
    pub(crate) fn kit(&self, arguments: &[&str]) -> Option<Foreign> {
        self.start_on_terminal("ubicom_encoder.py", "serial:", arguments)
    }

    /// Starts an independent adapter on a pseudo-terminal, with the kit encoder connected to it.
    pub(crate) fn adapter_on_terminal(&self, arguments: &[&str]) -> Option<Foreign> {
        self.start_on_terminal("bridge_adapter.py", "bridge:", arguments)
    }

    /// Starts an independent adapter on a TCP port, with the kit encoder connected to it.
    pub(crate) fn adapter(&self, arguments: &[&str]) -> Option<Foreign> {
        let mut foreign = self.foreign("bridge_adapter.py", arguments)?;
        foreign.url = format!("bridge:tcp:{}", foreign.place);
        Some(foreign)
    }

    /// Starts an independent adapter with a HIPERFACE encoder on its serial line.
    pub(crate) fn serial_adapter(&self, arguments: &[&str]) -> Option<Foreign> {
        let mut foreign = self.foreign("bridge_serial.py", arguments)?;
        foreign.url = format!("bridge:tcp:{}", foreign.place);
        Some(foreign)
    }

    /// Starts an independent gateway with a K3 encoder connected to it.
    pub(crate) fn gateway(&self, arguments: &[&str]) -> Option<Foreign> {
        let mut foreign = self.foreign("interbus_gateway.py", arguments)?;
        foreign.url = format!("modbus:{}", foreign.place);
        Some(foreign)
    }

    /// Starts an independent EtherNet/IP target with HIPERDRIVE parameters.
    pub(crate) fn target(&self, arguments: &[&str]) -> Option<Foreign> {
        python("enip_target.py")?;
        let mut foreign = self.foreign("enip_target.py", arguments).unwrap();
        foreign.url = format!("enip:{}", foreign.place);
        Some(foreign)
    }

    /// Starts an EtherNet/IP target that records packets and accepts faults. Its drives take time to move.
    pub(crate) fn moving_target(&self, arguments: &[&str]) -> Option<Foreign> {
        let record = self.file("record");
        self.foreign("moving_target.py", &[&["--record", &record], arguments].concat())
    }

    fn start_on_terminal(&self, script: &str, scheme: &str, arguments: &[&str]) -> Option<Foreign> {
        let number = self.encoders.load(Ordering::SeqCst);
        let link = self.file(&format!("enc{number}"));
        let mut foreign = self.foreign(script, &[&["--link", &link], arguments].concat())?;
        foreign.url = format!("{scheme}{link}");
        foreign.place = link;
        Some(foreign)
    }

    fn foreign(&self, script: &str, arguments: &[&str]) -> Option<Foreign> {
        let number = self.encoders.fetch_add(1, Ordering::SeqCst);
        let log = self.path(&format!("log{number}"));
        let mut command = python(script)?;
        command.args(["--stdin-eof", "--log", log.to_str().unwrap()]).args(arguments);
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let mut ready = String::new();
        let mut said = BufReader::new(child.stdout.take().unwrap());
        said.read_line(&mut ready).unwrap();
        let place = ready.trim_end().strip_prefix("ready ").map(str::to_owned);
        let foreign = Foreign { child, said, url: String::new(), place: place.clone().unwrap_or_default(), log };
        if place.is_some() {
            return Some(foreign);
        }
        skip("no pseudo-terminal can be made here");
        None
    }
}

fn collect(folder: &Path, text: &mut String) {
    for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let kind = entry.file_type().unwrap();
        // The log of a foreign encoder contains the unmasked data on the line, so it is excluded.
        let foreign = entry.file_name().to_str().is_some_and(|name| name.starts_with("log"));
        if kind.is_dir() {
            collect(&entry.path(), text);
        } else if kind.is_file() && !foreign {
            text.push_str(&String::from_utf8_lossy(&fs::read(entry.path()).unwrap()));
        }
    }
}

/// Runs a program until it exits.
pub(crate) fn finish(mut command: Command) -> Ran {
    let begun = Instant::now();
    let child = command.spawn().unwrap();
    ended(child, begun)
}

/// Waits until a program exits and returns its output.
pub(crate) fn ended(mut child: Child, begun: Instant) -> Ran {
    // The output may exceed the buffers of the pipes if a test polls for a long time, so threads read it.
    let reader = |pipe: Option<Box<dyn std::io::Read + Send>>| {
        std::thread::spawn(move || {
            let mut text = Vec::new();
            pipe.map(|mut pipe| pipe.read_to_end(&mut text));
            String::from_utf8(text).unwrap()
        })
    };
    let out = reader(child.stdout.take().map(|pipe| Box::new(pipe) as _));
    let err = reader(child.stderr.take().map(|pipe| Box::new(pipe) as _));
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if begun.elapsed() > HANG_TIMEOUT {
            child.kill().unwrap();
        }
        sleep(Duration::from_millis(5));
    };
    let took = begun.elapsed();
    // A foreign encoder only notices that a client has disconnected if the next one connects some milliseconds later.
    sleep(Duration::from_millis(20));
    Ran { status: status.code(), out: out.join().unwrap(), err: err.join().unwrap(), took }
}

impl Ran {
    /// Checks that the program succeeded, and returns the JSON object it printed.
    #[track_caller]
    pub(crate) fn json(&self) -> Value {
        assert_eq!(self.status, Some(0), "{self:?}");
        self.json_with_status(0)
    }

    /// Checks the exit status, and returns the JSON object the program printed.
    #[track_caller]
    pub(crate) fn json_with_status(&self, status: i32) -> Value {
        assert_eq!(self.status, Some(status), "{self:?}");
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }

    /// Checks that the program failed with the given status, printed nothing to stdout, and printed one to four lines
    /// with all the given words to stderr.
    #[track_caller]
    pub(crate) fn fails(&self, status: i32, words: &[&str]) {
        assert_eq!(self.status, Some(status), "{self:?}");
        assert_eq!(self.out, "", "{self:?}");
        self.assert_stderr(words);
    }

    /// Checks that stderr has one to four lines with all the given words, not counting log warnings.
    #[track_caller]
    pub(crate) fn assert_stderr(&self, words: &[&str]) {
        let lines: Vec<&str> = self.err.lines().filter(|line| !line.trim_start().starts_with("WARN")).collect();
        let shown: Vec<&&str> = lines.iter().filter(|line| !line.is_empty()).collect();
        assert!((1..=4).contains(&shown.len()), "{self:?}");
        assert!(!self.err.contains("panicked"), "{self:?}");
        for word in words {
            assert!(lines.join("\n").contains(word), "{word:?} is not in {self:?}");
        }
    }
}

/// An independently written encoder that runs in a separate process.
pub(crate) struct Foreign {
    child: Child,
    said: BufReader<ChildStdout>,
    /// Link to the encoder, for the option `--link`.
    pub(crate) url: String,
    /// Symbolic link to the encoder's terminal, or the address of the encoder.
    pub(crate) place: String,
    log: PathBuf,
}

impl Foreign {
    /// Returns the requests since the last call, one per line: frames for HIPERFACE, registers for BiSS, and words for
    /// INTERBUS.
    pub(crate) fn requests(&self) -> Vec<String> {
        let text = fs::read_to_string(&self.log).unwrap_or_default();
        fs::write(&self.log, "").unwrap();
        text.lines().map(str::to_owned).collect()
    }

    /// Returns the registers written since the last call, such as `0x24:0x10 AA`.
    pub(crate) fn registers_written(&self) -> Vec<String> {
        self.requests().iter().filter_map(|line| line.strip_prefix("W ")).map(str::to_owned).collect()
    }

    /// Returns the requests since the last call that write to the encoder.
    pub(crate) fn writes(&self) -> Vec<String> {
        let reads = ["42", "44", "46", "4A", "4C", "4E", "50", "52", "56"];
        self.requests().into_iter().filter(|frame| !reads.contains(&frame.get(3..5).unwrap_or_default())).collect()
    }

    /// Extends the time to wait for replies on a busy computer. A reply that comes too late would lose the data that it
    /// removed from the encoder.
    pub(crate) fn with_long_reply_margin(mut self) -> Self {
        self.url.push_str("?margin=1500");
        self
    }

    /// Sends a control command to the simulated encoder, if it accepts any.
    pub(crate) fn command(&mut self, line: &str) {
        writeln!(self.child.stdin.as_mut().unwrap(), "{line}").unwrap();
        let mut done = String::new();
        self.said.read_line(&mut done).unwrap();
        assert!(done.starts_with("done"), "{line}: {done}");
    }

    /// Kills the process of the encoder, to simulate a loss of power.
    pub(crate) fn kill(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }

    /// Sends frames as another host would, adding checksums, and returns the replies.
    pub(crate) fn host_address(&self, frames: &[&str]) -> Vec<String> {
        host_address(&self.place, &[&["--sum"], frames].concat())
    }
}

impl Drop for Foreign {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Runs an independent HIPERFACE host on a path or `tcp:HOST:PORT`. Returns the replies, with `-` for a missing one.
pub(crate) fn host_address(path: &str, arguments: &[&str]) -> Vec<String> {
    foreign_host("master.py", path, arguments)
}

/// Runs an independent host and returns one line per action.
pub(crate) fn foreign_host(script: &str, path: &str, arguments: &[&str]) -> Vec<String> {
    foreign_host_with(python(script).unwrap(), path, arguments)
}

/// Runs an independent host with a specific Python interpreter and returns one line per action.
pub(crate) fn foreign_host_with(mut command: Command, path: &str, arguments: &[&str]) -> Vec<String> {
    let options: Vec<&str> = arguments.iter().copied().filter(|argument| argument.starts_with("--")).collect();
    let frames: Vec<&str> = arguments.iter().copied().filter(|argument| !argument.starts_with("--")).collect();
    let Output { status, stdout, stderr } = command.args(options).arg(path).args(frames).output().unwrap();
    assert!(status.success(), "{}", String::from_utf8_lossy(&stderr));
    sleep(Duration::from_millis(20));
    String::from_utf8(stdout).unwrap().lines().map(str::to_owned).collect()
}

/// A virtual device in a separate process.
pub(crate) struct Simulated {
    child: Option<Child>,
    /// The address, which is the word after `ready KIND`.
    pub(crate) place: String,
}

impl Simulated {
    /// Starts a virtual device. The first argument is the kind of device.
    pub(crate) fn start(bench: &Bench, arguments: &[&str]) -> Self {
        let mut child = bench.program(&[&["simulate"], arguments].concat()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let ready = format!("ready {} ", arguments[0]);
        let place = line.trim_end().strip_prefix(&ready).unwrap_or_else(|| panic!("{line:?}")).to_owned();
        Simulated { child: Some(child), place }
    }

    /// Sends a signal to the process and waits until it exits.
    pub(crate) fn end(mut self, signal_name: &str) {
        let child = self.child.take().unwrap();
        signal(&child, signal_name);
        let ran = ended(child, Instant::now());
        assert!(ran.status.is_some(), "killed instead of ended: {ran:?}");
        assert!(ran.took < Duration::from_secs(5), "{ran:?}");
        assert!(!ran.err.contains("panicked"), "{ran:?}");
    }
}

impl Drop for Simulated {
    fn drop(&mut self) {
        if let Some(mut child) = self.child.take() {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Python code that runs its arguments as a command on a pseudo-terminal, with stdin as the typed input.
const PTY_SCRIPT: &str = "import os, pty, sys; sys.exit(os.waitstatus_to_exitcode(pty.spawn(sys.argv[1:])))";

/// Runs the program on a pseudo-terminal and types an answer.
pub(crate) fn run_on_terminal(bench: &Bench, arguments: &[&str], answer: &str) -> Ran {
    let program = bench.program(arguments);
    let mut command = Command::new(interpreter().unwrap());
    command.args(["-c", PTY_SCRIPT]).arg(program.get_program()).args(program.get_args());
    command.envs(program.get_envs().filter_map(|(name, value)| Some((name, value?))));
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.as_mut().unwrap().write_all(answer.as_bytes()).unwrap();
    ended(child, Instant::now())
}

/// Prints that a test is skipped, or fails if no test may be skipped (`ENCODER_STUDIO_NO_SKIP`).
pub(crate) fn skip(why: &str) {
    assert!(std::env::var_os("ENCODER_STUDIO_NO_SKIP").is_none(), "may not be skipped: {why}");
    println!("skipped: {why}");
}

/// Returns the path of the Python interpreter, or `None` if Python is not installed. `python3` may be a script that
/// searches for the interpreter, which is much slower than starting it directly.
fn interpreter() -> Option<&'static Path> {
    static PATH: OnceLock<Option<PathBuf>> = OnceLock::new();
    let find = || {
        let output = Command::new("python3").args(["-c", "import sys; print(sys.executable)"]).output().ok()?;
        output.status.success().then(|| String::from_utf8(output.stdout).unwrap().trim_end().into())
    };
    PATH.get_or_init(find).as_deref()
}

/// Returns the command for a Python program. Prints a line and returns `None` if Python is missing.
pub(crate) fn python(script: &str) -> Option<Command> {
    let Some(interpreter) = interpreter() else {
        skip("python3 is not installed");
        return None;
    };
    Some(python_command(interpreter.as_os_str(), script))
}

/// Returns the command for a program in `tests/foreign`. Its compiled modules are stored outside the source folder.
fn python_command(interpreter: &OsStr, script: &str) -> Command {
    let mut command = Command::new(interpreter);
    command.env_remove("PYTHONDONTWRITEBYTECODE");
    command.env("PYTHONPYCACHEPREFIX", Path::new(env!("CARGO_TARGET_TMPDIR")).join("python"));
    command.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign").join(script));
    command
}

/// Returns the command for a program that uses pycomm3. Prints a line and returns `None` if pycomm3 is missing.
/// `.ci/run` passes the path of a Python interpreter with pycomm3 in `ENCODER_STUDIO_PYCOMM3`.
pub(crate) fn pycomm3(script: &str) -> Option<Command> {
    let Some(interpreter) = std::env::var_os("ENCODER_STUDIO_PYCOMM3") else {
        skip("ENCODER_STUDIO_PYCOMM3 names no Python with pycomm3 (.ci/run makes one)");
        return None;
    };
    Some(python_command(&interpreter, script))
}

/// Returns a frame as logged by the encoder, with a checksum that is the XOR of all bytes.
pub(crate) fn frame(bytes: &str) -> String {
    let sum = bytes.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()).fold(0, |sum, byte| sum ^ byte);
    format!("{bytes} {sum:02X}")
}

/// Sends the signal with the given name to a program.
pub(crate) fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([&format!("-{name}"), &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}
