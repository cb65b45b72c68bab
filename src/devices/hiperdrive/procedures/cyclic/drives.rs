//! The drives of a cyclic connection, each with its dead-man control, from the opening of the connection to its end.

use std::time::Duration;

use super::{Connection, ConnectionLoss, LinkStatistics, ParameterReadings, ParameterWords};
use crate::devices::hiperdrive::procedures::OpenedConnection;
use crate::devices::hiperdrive::procedures::dead_man::{DeadMan, MotionIntent, Permit};
use crate::devices::hiperdrive::protocol::{ActualValues, DriveNumber, OutputData, OutputImage, ParameterNumber};
use crate::units::Moment;

#[derive(Clone, Debug)]
pub struct Drives {
    connection: Connection,
    controlled: Vec<ControlledDrive>,
    /// Parameter words, if the connection includes them.
    words: Option<ParameterWords>,
    places: usize,
    lost: Option<ConnectionLoss>,
    ending: Option<ShutdownProgress>,
}

#[derive(Clone, Debug)]
struct ControlledDrive {
    dead_man: DeadMan,
    /// Data received since the last packet was sent.
    received: Option<ActualValues>,
}

/// Shutdown of the connection: the drives are stopped, then switched off, and finally transmission ends.
#[derive(Clone, Copy, Debug)]
struct ShutdownProgress {
    since: Moment,
    off: u32,
}

/// Time allowed for the stop sequence, including braking.
const STOP_SEQUENCE_TIME: Duration = Duration::from_millis(700);
/// Number of packets that switch the drives off. There are several, since a packet may be lost.
const SWITCH_OFF_PACKETS: u32 = 3;

impl Drives {
    /// Creates the drives of a connection that was opened at `now`. Requests numbered up to `spent` cannot start a
    /// motion.
    pub fn new(opened: &OpenedConnection, drives: &[DriveNumber], spent: u64, now: Moment) -> Self {
        let places = opened.layout.topology.drives();
        let placed = drives.iter().filter(|drive| drive.get() <= places);
        let men =
            placed.map(|drive| ControlledDrive { dead_man: DeadMan::new(*drive, spent), received: None }).collect();
        Drives {
            connection: Connection::new(opened, now),
            controlled: men,
            words: opened.layout.pkw.then(ParameterWords::default),
            places: places.into(),
            lost: None,
            ending: None,
        }
    }

    pub fn dead_man_switches(&self) -> impl Iterator<Item = &DeadMan> {
        self.controlled.iter().map(|man| &man.dead_man)
    }

    pub const fn statistics(&self) -> &LinkStatistics {
        self.connection.statistics()
    }

    /// Sets the parameters to read through the parameter words, if the connection includes them.
    pub fn watch_parameters(&mut self, watched: &[ParameterNumber]) {
        if let Some(words) = &mut self.words {
            words.set_watched(watched);
        }
    }

    /// Returns the latest readings of the watched parameters, or `None` without parameter words.
    pub fn parameters(&self) -> Option<&ParameterReadings> {
        self.words.as_ref().map(ParameterWords::readings)
    }

    /// Returns the reason if the connection was lost.
    pub const fn connection_loss(&self) -> Option<&ConnectionLoss> {
        self.lost.as_ref()
    }

    pub const fn is_ending(&self) -> bool {
        self.ending.is_some()
    }

    /// Returns whether the transmission has ended, so that the connection can be closed.
    pub fn is_finished(&self) -> bool {
        let off = self.ending.is_some_and(|ending| ending.off >= SWITCH_OFF_PACKETS);
        off || matches!(self.lost, Some(ConnectionLoss::DoesNotStand(_) | ConnectionLoss::Port(_)))
    }

    /// Begins to close the connection by stopping the drives. They are switched off afterwards.
    pub fn close(&mut self, now: Moment) {
        if self.ending.is_none() {
            self.ending = Some(ShutdownProgress { since: now, off: 0 });
            self.controlled.iter_mut().for_each(|man| man.dead_man.connection_lost(now));
        }
    }

    /// Records that the connection was lost. Stop commands are still sent, since they may reach the drives.
    pub fn connection_lost(&mut self, now: Moment, why: ConnectionLoss) {
        if self.lost.is_none() && !self.is_finished() {
            self.lost = Some(why);
        }
        self.close(now);
    }

    pub fn on_packet(&mut self, now: Moment, bytes: &[u8]) -> bool {
        let Some(image) = self.connection.on_packet(now, bytes) else { return false };
        for man in &mut self.controlled {
            man.received = image.drives.get(index_of(man.dead_man.drive())).copied();
        }
        if let (Some(own), Some(received)) = (&mut self.words, image.pkw) {
            own.receive(now, received);
        }
        true
    }

    pub const fn poll_at(&self) -> Moment {
        self.connection.poll_at()
    }

    /// Returns the packet that is due now, if any. The caller must first handle all packets received so far.
    pub fn poll(
        &mut self,
        now: Moment,
        intent: &MotionIntent,
        permit: impl Fn(DriveNumber) -> Permit,
    ) -> Option<Vec<u8>> {
        if now < self.poll_at() || self.is_finished() {
            return None;
        }
        let moves = self.dead_man_switches().any(|man| !man.is_idle());
        if let Some(after) = self.connection.excessive_silence(now, moves) {
            self.connection_lost(now, ConnectionLoss::Silent { after });
        }
        if self.connection.has_timed_out(now) {
            self.controlled.iter_mut().for_each(|man| man.dead_man.handle_contact_loss(now));
        }
        let rest = MotionIntent::idle(intent.drive, intent.number, now);
        let intent = if self.is_ending() { &rest } else { intent };
        let mut drives = vec![OutputData::default(); self.places];
        for man in &mut self.controlled {
            let number = man.dead_man.drive();
            let setpoint = man.dead_man.next(now, man.received.take(), intent, &permit(number));
            if let Some(out) = drives.get_mut(index_of(number)) {
                *out = setpoint.into();
            }
        }
        self.switch_off_when_ending(now, &mut drives);
        let moving_on = self.dead_man_switches().find(|man| man.has_exhausted_stop_levels()).map(DeadMan::drive);
        if let Some(number) = moving_on {
            self.lost.get_or_insert(ConnectionLoss::DoesNotStand(number));
            self.close(now);
        }
        let ending = self.is_ending();
        let pkw = self.words.as_mut().filter(|_| !ending).map(|words| words.request(now));
        Some(self.connection.next_packet(now, &OutputImage { drives, pkw }))
    }

    fn switch_off_when_ending(&mut self, now: Moment, drives: &mut [OutputData]) {
        let idle = self.dead_man_switches().all(DeadMan::is_idle);
        let Some(ending) = &mut self.ending else { return };
        if idle || ending.off > 0 || now.duration_since(ending.since) >= STOP_SEQUENCE_TIME {
            ending.off += 1;
            for out in drives {
                out.control = 0;
            }
        }
    }
}

fn index_of(number: DriveNumber) -> usize {
    usize::from(number.get()) - 1
}
