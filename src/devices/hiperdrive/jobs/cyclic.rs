//! The thread of a cyclic connection. It sends packets at absolute deadlines, receives in between, and checks the
//! dead-man controls for every packet. A stop is sent in the next packet, at most one interval later.
//!
//! The thread ends on request, when its handle is dropped, when the connection is lost, or when the program exits. The
//! drives are then stopped and switched off, and nothing more is sent. If sending or receiving fails, transmission ends
//! immediately and the target's watchdog stops the drives.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use crossbeam_channel::{Receiver, bounded};

use super::motion::Motion;
use crate::devices::hiperdrive::procedures::OpenedConnection;
use crate::devices::hiperdrive::procedures::cyclic::{ConnectionLoss, Drives};
use crate::devices::hiperdrive::protocol::DriveNumber;
use crate::link::{Clock, DatagramChannel, request_realtime_priority};

/// A cyclic connection that runs on its own thread. Dropping it stops the drives and ends the thread;
/// [`close`](Self::close) also waits until the thread has ended.
pub struct Cyclic {
    motion: Motion,
    commands: Arc<CyclicCommands>,
    ended: Receiver<Never>,
}

/// State shared between the handle and the connection thread.
#[derive(Default)]
struct CyclicCommands {
    end: AtomicBool,
    lost: Mutex<Option<ConnectionLoss>>,
}

/// Item type of a channel that never carries a value. The channel disconnects when the thread ends.
enum Never {}

/// A cyclic connection without a thread, driven by its owner. Tests run it in virtual time.
pub struct CyclicRunner {
    drives: Drives,
    port: Box<dyn DatagramChannel>,
    clock: Arc<dyn Clock>,
    motion: Motion,
    commands: Arc<CyclicCommands>,
    packet: Vec<u8>,
}

/// Maximum time to wait for the thread to end. It covers the stop sequence, three packets that switch the drives off,
/// and a margin for the operating system.
const END_TIMEOUT: Duration = Duration::from_millis(1500);
/// Maximum number of received packets to handle once the next send is due. The maximum prevents a flood of packets from
/// delaying the send.
const MAX_PACKETS_AT_ONCE: usize = 64;

impl Cyclic {
    /// Starts the thread for an open connection. `port` must be directed at the target.
    ///
    /// # Errors
    /// Returns an error if the system cannot create a thread. Nothing has been sent in this case.
    pub fn start(
        port: Box<dyn DatagramChannel>,
        opened: &OpenedConnection,
        drives: &[DriveNumber],
        clock: Arc<dyn Clock>,
        motion: &Motion,
    ) -> std::io::Result<Self> {
        let mut pump = CyclicRunner::new(port, opened, drives, clock, motion);
        let commands = pump.commands.clone();
        let (alive, ended) = bounded(0);
        let failed = motion.clone();
        let thread = std::thread::Builder::new().name("cyclic".to_owned()).spawn(move || {
            let _alive: crossbeam_channel::Sender<Never> = alive;
            failed.set_realtime_priority(request_realtime_priority());
            let turned = catch_unwind(AssertUnwindSafe(|| while pump.run_once() {}));
            if turned.is_err() {
                failed.mark_failed();
            }
        });
        if let Err(error) = thread {
            motion.mark_failed();
            return Err(error);
        }
        Ok(Cyclic { motion: motion.clone(), commands, ended })
    }

    /// Returns the reason if the connection was lost. The owner must then close it with an explicit message.
    pub fn connection_loss(&self) -> Option<ConnectionLoss> {
        self.motion.connection_loss()
    }

    /// Reports a loss detected by the session and stops the drives.
    pub fn report_loss(&self, why: ConnectionLoss) {
        *self.commands.lost.lock().unwrap_or_else(PoisonError::into_inner) = Some(why);
    }

    /// Stops the drives, switches them off and ends the thread. The caller must still close the connection. If the
    /// connection was lost, returns the reason.
    pub fn close(self) -> Option<ConnectionLoss> {
        self.commands.end.store(true, Ordering::SeqCst);
        // The channel disconnects when the thread ends. After the time-out, the thread is no longer awaited.
        let _ = self.ended.recv_timeout(END_TIMEOUT);
        self.connection_loss()
    }
}

impl Drop for Cyclic {
    fn drop(&mut self) {
        self.commands.end.store(true, Ordering::SeqCst);
    }
}

impl CyclicRunner {
    /// Creates the runner for a newly opened connection. `port` must be directed at the target.
    pub fn new(
        port: Box<dyn DatagramChannel>,
        opened: &OpenedConnection,
        drives: &[DriveNumber],
        clock: Arc<dyn Clock>,
        motion: &Motion,
    ) -> Self {
        let drives = Drives::new(opened, drives, motion.open(), clock.now());
        motion.publish_drive_states(&drives);
        let (motion, commands) = (motion.clone(), Arc::default());
        CyclicRunner { drives, port, clock, motion, commands, packet: Vec::new() }
    }

    /// Requests that the drives stop and the connection end. [`run_once`](Self::run_once) executes the request.
    pub fn request_end(&self) {
        self.commands.end.store(true, Ordering::SeqCst);
    }

    /// Receives packets until the next packet is due, then sends it. Returns `false` once the connection has ended.
    pub fn run_once(&mut self) -> bool {
        let due = self.drives.poll_at();
        let mut late = 0;
        while late < MAX_PACKETS_AT_ONCE {
            match self.port.receive(due, &mut self.packet) {
                Ok(true) => {
                    let now = self.clock.now();
                    self.drives.on_packet(now, &self.packet);
                    late += usize::from(now >= due);
                }
                Ok(false) => break,
                Err(error) => {
                    self.report_loss(error.into());
                    return false;
                }
            }
        }
        self.apply_commands();
        self.drives.watch_parameters(&self.motion.watched_parameters());
        let now = self.clock.now();
        let packet = self.motion.with_motion_intent(|intent, permit| self.drives.poll(now, intent, permit));
        let sent = packet.map_or(Ok(()), |packet| self.port.send(&packet));
        if let Err(error) = sent {
            self.report_loss(error.into());
            return false;
        }
        self.motion.publish_drive_states(&self.drives);
        !self.drives.is_finished()
    }

    fn apply_commands(&mut self) {
        let now = self.clock.now();
        if let Some(why) = self.commands.lost.lock().unwrap_or_else(PoisonError::into_inner).take() {
            self.drives.connection_lost(now, why);
        }
        if self.commands.end.load(Ordering::SeqCst) || self.motion.is_shutting_down() {
            self.drives.close(now);
        }
    }

    fn report_loss(&mut self, why: ConnectionLoss) {
        self.drives.connection_lost(self.clock.now(), why);
        self.motion.publish_drive_states(&self.drives);
    }
}
