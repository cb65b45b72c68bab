//! An open adapter or hub with its drives, or a profile of one: data, edits, running jobs, and motion of the drives.

use std::collections::BTreeMap;

use jiff::Zoned;

use super::axis::Axis;
use super::moves::DriveMotion;
use super::record::Record;
use super::remembered::ExchangedValues;
use super::ruler::{PositionUnit, Ruler};
use super::staged::{EditFinding, StagedEdits};
use super::trace::FrameDecoder;
use super::unsaved::UnsavedChanges;
use crate::app::check::CheckResultLine;
use crate::app::live_session::LiveSession;
use crate::app::session::{Phase, Session, Source};
use crate::app::{PendingEdits, SettingsReadState, Text};
use crate::devices::hiperdrive::jobs::Hiperdrive;
use crate::devices::hiperdrive::procedures::{
    DriveIdentity, DriveLimits, DriveReading, DriveStatus, Identity, Network, Status, Survey,
};
use crate::devices::hiperdrive::profile::{HiperdriveProfile, Image, ProfileIdentity};
use crate::devices::hiperdrive::protocol::drive_parameter::{
    POSITION, SPEED, SPEED_DENOMINATOR, SPEED_NUMERATOR, STATUS,
};
use crate::devices::hiperdrive::protocol::{
    ActualValues, DriveNumber, Length, ParameterNumber, PositionScale, SpeedScale, State, StatusWord, Value,
};
use crate::devices::hiperdrive::sim::Target;
use crate::units::Moment;

pub struct HiperdriveDevice {
    pub session: Session<Hiperdrive>,
    pub survey: Option<Survey>,
    pub status: Option<Status>,
    pub check: Option<Vec<CheckResultLine>>,
    pub staged: StagedEdits,
    pub record: Record,
    pub(super) records: BTreeMap<DriveNumber, Record>,
    /// Start of the session, from which recording times are counted.
    pub(super) began: Option<Zoned>,
    pub moves: DriveMotion,
    pub measure: PositionUnit,
    pub refusal: Option<Text>,
    pub target: Option<Target>,
    /// Whether the temperature of the device is recorded together with the position.
    pub(super) watches_device: bool,
    pub(super) watches_drive: bool,
    pub(super) drive: DriveNumber,
    pub(super) pitches: BTreeMap<DriveNumber, Length>,
    pub(super) axes: BTreeMap<DriveNumber, Axis>,
    /// Whether the supply of the virtual device has been switched since the parameters were read.
    pub(super) switched: bool,
    pub(super) unsaved: UnsavedChanges,
    /// Values last exchanged with the settings, or `None` before the first exchange.
    pub(super) exchanged: Option<ExchangedValues>,
    /// Whether another window's marks of unconfirmed limits have been read since control was taken.
    pub(super) marks: SettingsReadState,
    /// Last reading of each drive that was taken without control.
    pub(super) readings: BTreeMap<DriveNumber, DriveReading>,
    /// Whether limits and scaling may have changed since they were read, for example after control is taken.
    pub(super) is_stale: bool,
    pub(super) watched: DriveNumber,
    /// Whether polling has already been started automatically since the link was opened.
    pub(super) has_polled: bool,
    /// Whether errors must be read again as soon as the line is free.
    pub(super) looks_at_errors: bool,
    /// Whether everything must be read again, because another master has changed the limits of a drive.
    pub(super) looks_at_all: bool,
    pub(super) decoder: FrameDecoder,
    /// Whether the window is operated over a remote desktop, where a button release may arrive late.
    pub(super) is_remote: bool,
}

impl HiperdriveDevice {
    pub(super) fn from_session(session: Session<Hiperdrive>) -> Self {
        HiperdriveDevice {
            session,
            survey: None,
            status: None,
            check: None,
            staged: StagedEdits::default(),
            record: Record::default(),
            records: BTreeMap::new(),
            began: None,
            moves: DriveMotion::default(),
            measure: PositionUnit::default(),
            refusal: None,
            target: None,
            watches_device: false,
            watches_drive: false,
            drive: DriveNumber::FIRST,
            pitches: BTreeMap::new(),
            axes: BTreeMap::new(),
            switched: false,
            unsaved: UnsavedChanges::default(),
            exchanged: None,
            marks: SettingsReadState::Unread,
            readings: BTreeMap::new(),
            is_stale: false,
            watched: DriveNumber::FIRST,
            has_polled: false,
            looks_at_errors: false,
            looks_at_all: false,
            decoder: FrameDecoder::default(),
            is_remote: false,
        }
    }

    /// Adopts the values of the profile from which this session was opened.
    pub(super) fn adopt_profile(&mut self, profile: &HiperdriveProfile) {
        self.staged = StagedEdits::for_profile(profile.image.clone());
        let drives = profile.identity.drives.iter();
        self.staged.set_families(drives.filter_map(|own| Some((own.number, own.family()?))).collect());
        self.drive = self.drives().first().copied().unwrap_or(DriveNumber::FIRST);
    }

    pub fn profile(&self) -> Option<&HiperdriveProfile> {
        let Source::File { document, .. } = &self.session.source else { return None };
        document.body.get::<HiperdriveProfile>()
    }

    /// Returns the profile with the edited values, or `None` if this is not a profile.
    pub(crate) fn edited_profile(&self) -> Option<HiperdriveProfile> {
        let (profile, wanted) = (self.profile()?, self.staged.edited_values()?);
        Some(HiperdriveProfile { image: wanted.clone(), ..profile.clone() })
    }

    pub fn identity(&self) -> Option<&Identity> {
        self.survey.as_ref().map(|survey| &survey.identity)
    }

    pub fn profile_identity(&self) -> Option<&ProfileIdentity> {
        self.profile().map(|profile| &profile.identity)
    }

    pub fn serial_number(&self) -> Option<&str> {
        let profile = || self.profile_identity().map(|own| own.serial_number.as_str());
        self.identity().map(|own| own.serial_number.as_str()).or_else(profile)
    }

    pub fn network(&self) -> Option<&Network> {
        self.survey.as_ref().map(|survey| &survey.network)
    }

    pub fn drives(&self) -> Vec<DriveNumber> {
        match self.identity() {
            Some(own) => own.drives.iter().map(|drive| drive.number).collect(),
            None => self.staged.edited_values().map(Image::drives).unwrap_or_default(),
        }
    }

    pub fn drive(&self) -> DriveNumber {
        self.drive
    }

    pub(super) fn show_drive(&mut self, drive: DriveNumber) {
        if self.drive != drive {
            self.moves.end_held_action();
            // Only the selected drive and the one moved last are read repeatedly.
            self.moves.invalidate_limits(drive);
            let before = std::mem::replace(&mut self.drive, drive);
            let next = self.records.remove(&drive).unwrap_or_else(|| self.new_record());
            self.records.insert(before, std::mem::replace(&mut self.record, next));
            self.record.mark_gap();
            self.record.track.poll(self.session.line.as_ref().and_then(LiveSession::polling_interval), false);
            self.request_temperatures();
        }
    }

    fn new_record(&self) -> Record {
        let mut record = Record::default();
        self.began.iter().for_each(|began| record.begin_session(began));
        record
    }

    pub fn drive_identity(&self, drive: DriveNumber) -> Option<&DriveIdentity> {
        self.identity()?.drive(drive)
    }

    /// Returns the value of a parameter as last read.
    pub fn value(&self, number: ParameterNumber) -> Option<&Value> {
        self.survey.as_ref()?.values.get(&number)
    }

    /// Returns the last read value of a numeric drive parameter, given its number for drive 1.
    pub fn parameter_value(&self, drive: DriveNumber, number: u16) -> Option<i64> {
        match self.value(ParameterNumber::for_drive(number, drive)?)? {
            Value::Number(value) => Some(*value),
            Value::Text(_) => None,
        }
    }

    pub fn drive_status(&self, drive: DriveNumber) -> Option<&DriveStatus> {
        self.status.as_ref()?.drives.iter().find(|own| own.number == drive)
    }

    /// Returns the latest data from a drive, received over the cyclic connection or by polling.
    pub fn actual_values(&self, drive: DriveNumber) -> Option<ActualValues> {
        let read = || self.readings.get(&drive).map(|reading| reading.actual);
        // Values read at the start are no longer valid if the connection is lost.
        let surveyed =
            || self.surveyed_values(drive).filter(|_| self.session.phase == Phase::Connected && !self.is_stale);
        self.moves.actual_values(drive).or_else(read).or_else(surveyed)
    }

    /// Returns when the drive last reported, on the session's clock. Returns `None` if it has done so only in a reading
    /// of all parameters.
    pub(super) fn last_report_time(&self, drive: DriveNumber) -> Option<Moment> {
        match self.moves.drive(drive) {
            Some(own) => own.received_at,
            None => self.readings.get(&drive).map(|reading| reading.at),
        }
    }

    fn surveyed_values(&self, drive: DriveNumber) -> Option<ActualValues> {
        Some(ActualValues {
            status: StatusWord::new(u16::try_from(self.parameter_value(drive, STATUS)?).ok()?),
            speed: i16::try_from(self.parameter_value(drive, SPEED)?).ok()?,
            position: i32::try_from(self.parameter_value(drive, POSITION)?).ok()?,
        })
    }

    pub fn state(&self, drive: DriveNumber) -> Option<State> {
        self.actual_values(drive).map(|own| own.status.state())
    }

    /// Returns whether any drive is moving or about to move, as far as known.
    pub fn is_moving(&self) -> bool {
        self.moves.is_moving() || self.drives().into_iter().any(|drive| self.polled_state(drive) == Some(State::Moving))
    }

    /// Returns the state of a drive that is being polled, or `None` for any other drive.
    pub fn polled_state(&self, drive: DriveNumber) -> Option<State> {
        let is_polled = self.session.is_polling() && !self.moves.is_open() && drive == self.watched;
        // Data from before the end of polling are outdated.
        let read = self.readings.get(&drive).filter(|_| is_polled).map(|reading| reading.actual);
        self.moves.actual_values(drive).or(read).map(|own| own.status.state())
    }

    pub fn ruler(&self, drive: DriveNumber) -> Ruler {
        Ruler { scale: self.scale(drive).unwrap_or(PositionScale::FACTORY), pitch: self.spindle_pitch(drive) }
    }

    pub fn edited_ruler(&self, drive: DriveNumber) -> Ruler {
        let scale = self.staged.edited_values().and_then(|image| image.scale(drive)).unwrap_or(PositionScale::FACTORY);
        Ruler { scale, pitch: self.spindle_pitch(drive) }
    }

    /// Returns the pitch of the drive's spindle, if entered by the user.
    pub fn spindle_pitch(&self, drive: DriveNumber) -> Option<Length> {
        self.pitches.get(&drive).copied()
    }

    pub fn speed_scale(&self, drive: DriveNumber) -> SpeedScale {
        let part = |number| self.parameter_value(drive, number).and_then(|value| u16::try_from(value).ok());
        let scale = part(SPEED_NUMERATOR)
            .zip(part(SPEED_DENOMINATOR))
            .and_then(|(above, below)| SpeedScale::new(above, below).ok());
        scale.unwrap_or(SpeedScale::FACTORY)
    }

    /// Returns the limits of a drive as last read for motion. Returns `None` for a profile, or if nothing was read.
    pub fn drive_limits(&self, drive: DriveNumber) -> Option<&DriveLimits> {
        self.moves.limits(drive)
    }

    /// Returns the position scale of a drive, or `None` if it has not been read.
    pub fn scale(&self, drive: DriveNumber) -> Option<PositionScale> {
        let as_read = || self.staged.base()?.scale(drive);
        self.drive_limits(drive).and_then(DriveLimits::scale).or_else(as_read)
    }

    /// Returns the limits of a drive in scaled steps, or `None` if they have not been read.
    pub fn limits(&self, drive: DriveNumber) -> Option<(i32, i32)> {
        let as_read = || {
            let (lower, upper) = self.staged.base()?.limits(drive)?;
            Some((i32::try_from(lower).ok()?, i32::try_from(upper).ok()?))
        };
        self.drive_limits(drive).and_then(DriveLimits::limits).or_else(as_read)
    }

    /// Returns the limits that the user must confirm before the drive moves, if any.
    pub fn limits_to_confirm(&self, drive: DriveNumber) -> Option<(i32, i32)> {
        self.limits(drive).filter(|_| self.moves.unconfirmed_drives().contains(&drive))
    }

    pub fn findings(&self) -> Vec<EditFinding> {
        self.staged.findings(|drive| self.actual_values(drive).map(|own| i64::from(own.position)))
    }

    pub fn is_dirty(&self) -> bool {
        self.staged.is_dirty()
    }
}
