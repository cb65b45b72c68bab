//! Opening of links and execution of jobs. Progress messages and status codes are printed to stderr, and Ctrl-C is
//! passed on to the worker.

use std::fs::File;
use std::io::{BufWriter, IsTerminal, Write, stderr};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crossbeam_channel::RecvTimeoutError;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::args::CommonArgs;
use super::commands::DeviceCommands;
use super::consent::{can_prompt, read_answer};
use super::output::write_stderr;
use super::slow_reply_notice::{ReplyTiming, SlowReplyNotice};
use super::user_store::user_store;
use super::{Failure, Result};
use crate::app::session::Kind;
use crate::app::{Text, TypeMap, explain};
use crate::link::{LinkError, LinkUrl, write_entry, write_header};
use crate::store::Store;
use crate::worker::{Device, Event, OpenError, Session, Worker};

/// A device on which the command line can run jobs.
pub trait CliDevice: Kind {
    /// Device-specific state that stays outside the worker thread.
    type Context;
    /// Whether the line allows only one master. A connected drive may be a second one. `--only-master` confirms that no
    /// drive is connected.
    const HAS_ONE_MASTER: bool = false;
    /// Commands of this device kind.
    const COMMANDS: &'static dyn DeviceCommands;

    /// Returns whether there may be another master on the line of a link. If so, the user is asked before the first
    /// byte is sent.
    fn may_have_other_master(_url: &LinkUrl) -> bool {
        false
    }

    /// Prepares a session according to the options that every command has.
    fn prepare_context(session: &mut Session<Self>, given: &TypeMap) -> Self::Context;

    /// Prints a message from the device immediately. The default prints nothing.
    fn print_message(_remark: &Self::DeviceMessage) {}

    /// Describes a step for the progress bar on a terminal.
    fn describe_step(doing: &Self::JobStep) -> String;

    /// Returns a message to print on the terminal during a step. It is printed each time it changes.
    fn step_message(_doing: &Self::JobStep) -> Option<String> {
        None
    }

    /// Returns the measured reply times. Returns `None` if they are not measured or the link has no time-out.
    fn reply_times(_session: &Session<Self>) -> Option<ReplyTiming> {
        None
    }

    /// Returns a function that is called for each Ctrl-C. Its argument is `true` for the second Ctrl-C, which ends the
    /// program.
    fn interrupt_handler(_kept: &Self::Context) -> Box<dyn Fn(bool) + Send> {
        Box::new(|_| ())
    }
}

pub struct Runner<D: CliDevice> {
    worker: Worker<D>,
    /// The user's files.
    pub(super) store: Store,
    /// Whether Ctrl-C was pressed. Unlike the worker's cancellation flag, which applies to a single job, it stays set.
    interrupted: Arc<AtomicBool>,
    reply_notice: SlowReplyNotice,
    pub remarks: Vec<D::DeviceMessage>,
    /// Device-specific state that stays outside the worker thread.
    pub context: D::Context,
}

pub enum JobFailure<D: CliDevice> {
    Job(Box<D::Error>),
    Interrupted,
    Lost(LinkError),
    Worker,
}

/// Maximum time for leaving a temporary state, such as control of a drive or a supply that was switched on.
const RESTORE_TIMEOUT: Duration = Duration::from_secs(4);

impl<D: CliDevice> Drop for Runner<D> {
    fn drop(&mut self) {
        if !self.worker.finish(RESTORE_TIMEOUT) {
            tracing::warn!("the link could not be closed properly");
        }
    }
}

impl<D: CliDevice> Runner<D> {
    pub fn open(common: &CommonArgs) -> Result<Self> {
        let Some(url) = &common.link else {
            return Err(Failure::Usage("this command needs --link URL; without hardware, use --link sim:".to_owned()));
        };
        let given = common.kind_option_values()?;
        if let Some(why) = common.commands.foreign_common_option_error(D::COMMANDS, &common.own) {
            return Err(Failure::Usage(why));
        }
        if D::may_have_other_master(url) {
            ask_for_other_master(common)?;
        }
        if common.only_master && !D::HAS_ONE_MASTER {
            return Err(Failure::Usage(common.commands.option_rejection("--only-master", D::COMMANDS.name())));
        }
        let store = user_store(common)?;
        let mut session = D::open(url, store.clone()).map_err(|error| match error {
            OpenError::Url(_) | OpenError::Sim(_) => Failure::Usage(explain::open_error_text(&error).terminal_text()),
            error => to_failure(&D::open_error(&error)),
        })?;
        session.share_log(common.log.clone());
        let context = D::prepare_context(&mut session, &given);
        if let Some(path) = &common.trace {
            record_trace(&mut session, path)?;
        }
        let reply_notice = SlowReplyNotice::start(D::reply_times(&session));
        let worker = Worker::spawn(session, Arc::new(|| ()))
            .map_err(|error| Failure::Failed(vec![format!("Could not start a thread: {error}.")]))?;
        let stop_handle = worker.stop_handle();
        let interrupted = Arc::new(AtomicBool::new(false));
        let pressed = interrupted.clone();
        let interrupt = D::interrupt_handler(&context);
        ctrlc::set_handler(move || {
            let again = pressed.swap(true, Ordering::SeqCst);
            interrupt(again);
            if again {
                std::process::exit(130);
            }
            stop_handle.stop();
        })
        .map_err(|error| Failure::Failed(vec![format!("Could not install the Ctrl-C handler: {error}.")]))?;
        Ok(Runner { worker, store, interrupted, reply_notice, remarks: Vec::new(), context })
    }

    pub fn run(&mut self, job: D::Job) -> Result<D::Output> {
        self.try_run(job).map_err(JobFailure::into_failure)
    }

    /// Runs a job until it ends, and returns its error to the caller.
    pub(super) fn try_run(&mut self, job: D::Job) -> std::result::Result<D::Output, JobFailure<D>> {
        self.remarks.clear();
        let id = self.worker.submit(job).map_err(|_| JobFailure::Worker)?;
        if self.is_interrupted() {
            // Ctrl-C came before the job began and applies to it as well.
            self.worker.stop();
        }
        let bar = TerminalProgressBar::default();
        let mut announced = None;
        loop {
            let Some(event) = self.next_event()? else {
                if let Some(words) = self.reply_notice.take_message() {
                    bar.print_line(&words);
                }
                continue;
            };
            match event {
                Event::Progress(of, progress) if of == id => {
                    let words = D::step_message(&progress.step);
                    if let Some(words) = words.as_ref().filter(|_| words != announced) {
                        bar.print_line(words);
                    }
                    announced = words;
                    bar.show(progress.done, progress.total, &D::describe_step(&progress.step));
                }
                Event::DeviceMessage(remark) => {
                    D::print_message(&remark);
                    self.remarks.push(remark);
                }
                Event::Finished(of, output) if of == id => return Ok(*output),
                Event::Failed(of, error) | Event::Cancelled(of, error) if of == id => {
                    return Err(JobFailure::Job(error));
                }
                _ => {}
            }
        }
    }

    /// Returns the next event, or `None` if a check for slow replies is due.
    fn next_event(&self) -> std::result::Result<Option<Event<D>>, JobFailure<D>> {
        let events = self.worker.events();
        let Some(left) = self.reply_notice.time_until_check() else {
            return events.recv().map(Some).map_err(|_| JobFailure::Worker);
        };
        match events.recv_timeout(left) {
            Ok(event) => Ok(Some(event)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(JobFailure::Worker),
        }
    }

    /// Waits between two jobs. The wait ends early if the user cancels or the connection is lost.
    pub(super) fn pause(&self, duration: Duration) -> Result<()> {
        let end = Instant::now() + duration;
        loop {
            self.check_interrupt().map_err(JobFailure::into_failure)?;
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(());
            }
            match self.worker.events().recv_timeout(left.min(Duration::from_millis(50))) {
                Ok(Event::Lost(error)) => return Err(JobFailure::<D>::Lost(error).into_failure()),
                Ok(_) | Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Err(JobFailure::<D>::Worker.into_failure()),
            }
        }
    }

    pub(crate) fn is_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::SeqCst)
    }

    fn check_interrupt(&self) -> std::result::Result<(), JobFailure<D>> {
        if self.is_interrupted() { Err(JobFailure::Interrupted) } else { Ok(()) }
    }
}

impl<D: CliDevice> JobFailure<D> {
    pub fn into_failure(self) -> Failure {
        match self {
            JobFailure::Job(error) => {
                Failure::Failed(combine_lines(D::error_texts(&error).iter().map(Text::terminal_text).collect()))
            }
            JobFailure::Interrupted => to_failure(&Text::new("encoder.cancelled")),
            JobFailure::Lost(error) => to_failure(&explain::link_error_text(&error)),
            JobFailure::Worker => Failure::Failed(vec!["The session ended unexpectedly.".to_owned()]),
        }
    }
}

/// Limits the number of lines to four, by joining all sentences between the first and the last into one line.
fn combine_lines(mut sentences: Vec<String>) -> Vec<String> {
    if sentences.len() > 4 {
        let last = sentences.split_off(sentences.len() - 1);
        let middle = sentences.split_off(1).join(" ");
        sentences.push(middle);
        sentences.extend(last);
    }
    sentences
}

pub fn to_failure(text: &Text) -> Failure {
    Failure::Failed(vec![text.terminal_text()])
}

/// Extracts the result of a job: `result_of!(runner.run(job)?, Output::Saved(profile) => *profile)`. If the job has
/// returned another result, the calling function returns an error.
#[macro_export]
macro_rules! result_of {
    ($result:expr, $wanted:pat => $value:expr) => {
        match $result {
            $wanted => $value,
            other => return Err($crate::cli::unexpected_output(&other)),
        }
    };
}

/// Returns the failure for a job result of an unexpected type. The message reports a defect of this program.
pub fn unexpected_output(output: &impl std::fmt::Debug) -> Failure {
    Failure::Failed(vec![format!("Unexpected result: {output:?}.")])
}

/// Asks whether a drive is on the line. Does not ask without a terminal or if the user has already confirmed that there
/// is none.
fn ask_for_other_master(common: &CommonArgs) -> Result<()> {
    if common.only_master || !can_prompt() {
        return Ok(());
    }
    let reply = read_answer("Is a drive or controller connected to this line, or powered? [yes/no/not sure] ");
    if matches!(reply.as_str(), "n" | "N" | "no") {
        return Ok(());
    }
    Err(to_failure(&Text::new("session.maybe_drive")))
}

fn record_trace<D: Device>(session: &mut Session<D>, path: &Path) -> Result<()> {
    let cannot = |error: std::io::Error| {
        Failure::Failed(vec![format!("{}: could not record the trace: {error}.", path.display())])
    };
    let mut file = BufWriter::new(File::create(path).map_err(cannot)?);
    write_header(&mut file).map_err(cannot)?;
    let name = path.display().to_string();
    let mut works = true;
    session.add_watcher(move |entry| {
        // Every frame is flushed. The trace is then complete however the program ends.
        if works && write_entry(&mut file, entry).and_then(|()| file.flush()).is_err() {
            works = false;
            tracing::warn!("{name}: the trace is incomplete because a write to the file failed");
        }
    });
    Ok(())
}

/// A progress bar, drawn on a terminal only.
pub(crate) struct TerminalProgressBar(ProgressBar);

impl Default for TerminalProgressBar {
    fn default() -> Self {
        let target = if stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target);
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}") {
            bar.set_style(style);
        }
        TerminalProgressBar(bar)
    }
}

impl TerminalProgressBar {
    pub(crate) fn show(&self, done: u64, total: u64, what: &impl ToString) {
        self.0.set_length(total);
        self.0.set_position(done);
        self.0.set_message(what.to_string());
    }
}

impl TerminalProgressBar {
    /// Prints a line above the bar, or directly if the bar is not shown yet.
    fn print_line(&self, words: &str) {
        match self.0.length() {
            Some(_) => self.0.println(words),
            None if self.0.is_hidden() => {}
            None => write_stderr(&format!("{words}\n")),
        }
    }
}

impl Drop for TerminalProgressBar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
