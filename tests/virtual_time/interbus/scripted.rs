//! An encoder whose replies a test defines word by word.

use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::devices::interbus::jobs::{ChangeKind, Commit, Committed, JobError, Prepared};
use encoder_studio::devices::interbus::procedures::write::{EncoderWriter, InterruptedWrite, WrittenChanges};
use encoder_studio::devices::interbus::procedures::{
    Error, Exception, Handshake, Identity, Master, ProcessData, RequestedItem,
};
use encoder_studio::devices::interbus::profile::{
    Base, CamChange, Direction, Edge, InterbusPlan, Op, ParameterChange, Parameters, ProgramChange,
};
use encoder_studio::devices::interbus::protocol::{CamNumber, Flags, Parameter, StartupMode, Value};
use encoder_studio::profile::Consent;
use encoder_studio::store::Store;
use encoder_studio::units::Moment;
use encoder_studio::worker::Progress;
use encoder_studio::worker::commit::write_plan;

use super::support::{program, station};

/// The position that the encoder returns unless the script defines another reply.
pub(crate) const POSITION: u32 = 1234;

/// An encoder that immediately acknowledges every word that is not in the script. For a word in the script, it returns
/// the given IN words in consecutive cycles and then repeats the last one. A requested value stays on IN until
/// `00000000` or `80000000`.
#[derive(Default)]
pub(crate) struct Script {
    /// Replies by OUT word. If there are several lists, each write of the word uses the next one.
    pub(crate) answers: HashMap<u32, VecDeque<Vec<u32>>>,
    /// The OUT word that the gateway reports instead of the written one.
    pub(crate) output: Option<u32>,
    /// Whether `00000000` ends cam mode and velocity mode.
    pub(crate) normal_ends_modes: bool,
    /// Whether a requested cam value remains after `00000000`.
    pub(crate) normal_keeps_values: bool,
    /// Every word written, without immediate repetitions.
    pub(crate) sent: Arc<Mutex<Vec<u32>>>,
    pub(crate) mode: u32,
    pub(crate) out: u32,
    pub(crate) standing: VecDeque<u32>,
    pub(crate) input: u32,
    pub(crate) now: Duration,
    /// Interval between two reads of IN.
    pub(crate) pace: Duration,
    /// A word that the gateway rejects the first time, the exception code, and whether the word is written
    /// nevertheless.
    pub(crate) refuses: Option<(u32, u8, bool)>,
}

impl Script {
    pub(crate) fn new() -> Self {
        Script { mode: 1, input: POSITION, pace: Duration::from_millis(5), ..Script::default() }
    }

    pub(crate) fn in_mode(mode: u32) -> Self {
        Script { mode, ..Script::new() }
    }

    /// Adds the replies to a word.
    pub(crate) fn on(mut self, out: u32, words: &[u32]) -> Self {
        self.answers.entry(out).or_default().push_back(words.to_vec());
        self
    }

    fn take(&mut self, out: u32) {
        self.sent.lock().unwrap().push(out);
        self.out = out;
        let was = self.input;
        if let Some(words) = self.answers.get_mut(&out).and_then(VecDeque::pop_front) {
            self.standing = words.into();
            return;
        }
        self.standing.clear();
        let value = match out {
            0 | 0x8000_0000 => {
                if out == 0 && self.normal_ends_modes && self.mode > 1 {
                    self.mode = 1;
                }
                let stays = out == 0 && self.normal_keeps_values && self.mode > 2 && was >> 29 == 0b101;
                if stays { was } else { POSITION }
            }
            0x2021_0009 => 0xA000_0000 | self.mode,
            0x2021_0003 => 0xA000_0003,
            _ if out >> 16 == 0x2021 => 0xA000_0003 + (out & 0xF) * 100,
            _ if out >> 16 == 0x2020 => 0xA000_0000,
            0x2040_0000 | 0x2040_0001 if self.mode < 3 => {
                self.mode = if out & 1 == 1 { 2 } else { 1 };
                POSITION
            }
            _ => {
                if out >> 16 == 0x2080 {
                    self.mode = if out & 0xF == 0 { 1 } else { (out & 0xF) + 2 };
                }
                out | 0xC000_0000
            }
        };
        self.standing.push_back(value);
    }
}

impl ProcessData for Script {
    fn run_cycle(&mut self, out: u32) -> Result<u32, Error> {
        let refused = self.refuses.take_if(|(word, ..)| *word == out);
        if out != self.out && !matches!(refused, Some((.., false))) {
            self.take(out);
        }
        self.now += self.pace;
        if let Some((word, code, _)) = refused {
            let asked = RequestedItem::Write { register: 0, word };
            return Err(Error::Exception { requested: asked, exception: Exception::new(code) });
        }
        self.input()
    }

    fn input(&mut self) -> Result<u32, Error> {
        if let Some(word) = self.standing.pop_front() {
            self.input = word;
        }
        Ok(self.input)
    }

    fn output(&mut self) -> Result<Option<u32>, Error> {
        Ok(Some(self.output.unwrap_or(self.out)))
    }

    fn now(&self) -> Moment {
        Moment::from_elapsed(self.now)
    }

    fn wait(&mut self, duration: Duration) -> Result<(), Error> {
        self.now += duration;
        Ok(())
    }

    fn ignore_cancellation(&mut self, ignore: bool) -> bool {
        ignore
    }
}

/// Returns the identity of the scripted encoder.
pub(crate) fn identity() -> Identity {
    Identity {
        serial_number: "3".to_owned(),
        steps: 103,
        revolutions: 203,
        direction: Direction::Clockwise,
        software_version: 703,
        mode: StartupMode::K3,
        flags: Flags::new(Value::default()),
    }
}

/// Executes operations with a script. Returns the result, each step, and all words written.
pub(crate) fn carry_out(
    script: Script,
    ops: Vec<Op>,
) -> (Result<WrittenChanges, Box<InterruptedWrite>>, Vec<Handshake>, Vec<u32>) {
    let plan = InterbusPlan { base: Base::default(), ops };
    let (folder, consent) = (tempfile::tempdir().unwrap(), Consent::to(plan.id()));
    let parameters =
        Parameters { steps: 103, revolutions: 203, direction: Direction::Clockwise, preset: 0, zero_shift: 0 };
    let prepared = Prepared {
        kind: ChangeKind::Edits,
        plan,
        identity: identity(),
        parameters,
        cycles_seen: Some(encoder_studio::worker::commit::CycleCount::complete(0)),
        unchanged: 0,
        missing: Vec::new(),
        mounting_left: Vec::new(),
        other_type: None,
        mounting_written: Vec::new(),
    };
    let commit = Commit { prepared, consent, force_wear: false, undoes: None };
    let (mut station, sent) = (station(""), script.sent.clone());
    let mut steps = Vec::new();
    let ended: Result<Committed, JobError> = {
        let master = Master::for_job(script, &mut station).with_reporter(|step| steps.push(step));
        let mut write = EncoderWriter { master, identity: &commit.prepared.identity };
        // The words that read values back are left out.
        let begins = &mut |at: Progress<&Op>| {
            if at.done == 0 {
                sent.lock().unwrap().clear()
            }
        };
        write_plan(&Store::at_root(folder.path()), true, &commit, &mut write, begins)
    };
    let ended = match ended {
        Ok(done) => Ok(done.written),
        Err(JobError::Interrupted { interrupted, .. }) => Err(interrupted),
        Err(other) => panic!("{other}"),
    };
    let sent = sent.lock().unwrap().clone();
    (ended, steps, sent)
}

/// Returns the operations that set the parameters and store them once.
pub(crate) fn parameters(changes: &[(Parameter, u32)]) -> Vec<Op> {
    let change = |(parameter, to): &(Parameter, u32)| ParameterChange { parameter: *parameter, from: 0, to: *to };
    vec![Op::Parameterise(changes.iter().map(change).collect())]
}

/// Returns the operations that set the mask and both edges of a cam in program 1.
pub(crate) fn cams(cam: u8, start: u32, stop: u32, mask: u8) -> Vec<Op> {
    let change = |edge, to: u32| CamChange {
        cam: CamNumber::new(cam).unwrap(),
        edge,
        from: Value::default(),
        to: Value::new(to).unwrap(),
    };
    let cams = vec![change(Edge::Start, start), change(Edge::Stop, stop)];
    vec![Op::Program(ProgramChange { program: program(1), cams, mask: Some((0, mask)), shift: None })]
}
