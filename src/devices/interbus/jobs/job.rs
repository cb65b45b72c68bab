//! Jobs of an INTERBUS encoder and their results.

use crate::analysis::check::CycleCount;
use std::fmt;

use crate::devices::interbus::procedures::check::InterbusStepResult;
use crate::devices::interbus::procedures::write::{InterruptedWrite, WrittenChanges};
use crate::devices::interbus::procedures::{Error, Handshake, Identity, Status, Survey, WordReading};
use crate::devices::interbus::profile::{
    Image, InterbusPlan, InterbusProfile, Item, ItemValue, Parameters, PlanError, RestoreOptions, TypeMismatch,
};
use crate::devices::interbus::protocol::{
    DESIGN_WRITE_CYCLES, GUARANTEED_WRITE_CYCLES, KIND, Program, ProgramNumber, ReadOutNumber, StartupMode, Value,
    WindowShift,
};
use crate::store::{DeviceKey, EntryKind};

/// Number of EEPROM write cycles at which the user is first warned of wear. The EEPROM is designed for about 200
/// cycles, and 500 at most (reference 3).
pub const WEAR_WARNING: u64 = 150;
/// Number of EEPROM write cycles above which the user has to confirm a second time.
pub const WEAR_CONFIRMATION: u64 = DESIGN_WRITE_CYCLES as u64;
/// Maximum number of EEPROM write cycles that the manufacturer guarantees.
pub const WEAR_GUARANTEE: u64 = GUARANTEED_WRITE_CYCLES as u64;
/// Number of EEPROM write cycles from which the EEPROM counts as worn out.
pub const WEAR_LIMIT: u64 = 450;

/// Returns the number of EEPROM write cycles up to which a plan with this cost may start without being forced. A plan
/// with a cost of 0 causes no wear and has no limit.
pub const fn wear_limit(cost: u64) -> u64 {
    if cost == 0 { u64::MAX } else { WEAR_LIMIT - 1 }
}

/// A job on an INTERBUS encoder. All jobs except [`Hello`](Self::Hello) and [`Position`](Self::Position) briefly
/// replace the position and make the cam outputs invalid. Reading a cam program selects it. After the job, the encoder
/// returns to its previous mode unless the job selects another mode.
#[derive(Debug)]
pub enum InterbusJob {
    /// Reads the IN word as soon as a window has connected. Nothing is sent to the encoder.
    Hello,
    /// Reads everything that can be read without selecting a cam program.
    Survey,
    /// Reads the given cam programs and the window shift.
    Programs(Vec<ProgramNumber>),
    Identify,
    Status,
    /// Checks the gateway and the encoder, with a verdict for each step.
    Check,
    /// Reads the IN word once. Nothing is sent to the encoder.
    Position,
    Read(Item),
    /// Reads a single read-out or OPC chip register.
    ReadOut(ReadOutNumber),
    /// Switches the IN word to the position, the speed or a cam program. The encoder stays in this mode.
    Select(StartupMode),
    Save {
        programs: bool,
    },
    /// Plans a change without writing anything.
    Prepare(Change),
    Commit(Box<Commit>),
    /// Ends an interrupted parameterisation, an error or a read-out. Values that were set but not stored are now
    /// stored, which uses one EEPROM write cycle.
    RestoreMode,
}

#[derive(Clone, Debug)]
pub enum Change {
    Restore {
        profile: Box<InterbusProfile>,
        options: RestoreOptions,
    },
    /// Writes the given EEPROM content. Missing items are neither read nor changed.
    Write(Box<Image>),
    Item(Item, ItemValue),
    /// Stores a preset value and sets the current position to it. The shaft must be at standstill.
    Preset {
        value: u32,
    },
    /// Restores the factory settings. This is experimental (see reference 6.10).
    Default,
}

/// Kind of change, which determines how to complete it after an interruption.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeKind {
    Restore,
    /// A write of edited values. After an interruption, the values not yet written remain as edits.
    Edits,
    Preset,
    Default,
}

impl ChangeKind {
    /// Returns the kind of the logbook entry.
    pub const fn entry_kind(self) -> EntryKind {
        match self {
            ChangeKind::Restore => EntryKind::Restore,
            ChangeKind::Edits => EntryKind::Write,
            ChangeKind::Preset => EntryKind::Preset,
            ChangeKind::Default => EntryKind::Procedure,
        }
    }
}

impl Change {
    pub const fn kind(&self) -> ChangeKind {
        match self {
            Change::Restore { .. } => ChangeKind::Restore,
            Change::Write(_) | Change::Item(..) => ChangeKind::Edits,
            Change::Preset { .. } => ChangeKind::Preset,
            Change::Default => ChangeKind::Default,
        }
    }
}

#[derive(Clone, Debug)]
pub struct Prepared {
    pub kind: ChangeKind,
    pub plan: InterbusPlan,
    pub identity: Identity,
    /// Position parameters that were read from the encoder for the plan.
    pub parameters: Parameters,
    /// EEPROM write cycles of the encoder in the logbook of this computer, or `None` if there is no record.
    pub cycles_seen: Option<CycleCount>,
    /// Number of items that already have the planned value.
    pub unchanged: u64,
    /// Profile items that the encoder does not have.
    pub missing: Vec<String>,
    /// Mounting-dependent values that differ from the profile but are left unchanged.
    pub mounting_left: Vec<Item>,
    pub other_type: Option<TypeMismatch>,
    /// Mounting-dependent values that are copied from another device and must be readjusted.
    pub mounting_written: Vec<Item>,
}

/// Wear of the EEPROM after a plan, counted in write cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WearAfterPlan {
    /// The number of cycles should be shown to the user.
    Known(u64),
    /// The number of cycles exceeds the design limit, so the user must confirm.
    Ask(u64),
    /// The number of cycles is so high that the plan is rejected unless it is forced.
    Worn(u64),
    /// The number of earlier cycles is unknown, so the plan is rejected unless it is forced.
    Unknown,
}

impl WearAfterPlan {
    /// Returns the wear after the given number of EEPROM write cycles, or `None` if it needs no message.
    pub const fn from_stores(stores: u64) -> Option<Self> {
        match stores {
            WEAR_LIMIT.. => Some(WearAfterPlan::Worn(stores)),
            _ if stores > WEAR_CONFIRMATION => Some(WearAfterPlan::Ask(stores)),
            WEAR_WARNING.. => Some(WearAfterPlan::Known(stores)),
            _ => None,
        }
    }
}

impl Prepared {
    /// Returns the wear after the plan, or `None` if it needs no message.
    pub fn wear_to_report(&self) -> Option<WearAfterPlan> {
        let cost = self.plan.write_cycles();
        let Some(CycleCount { seen, .. }) = self.cycles_seen else {
            return (cost > 0).then_some(WearAfterPlan::Unknown);
        };
        WearAfterPlan::from_stores(seen.saturating_add(cost)).filter(|_| cost > 0)
    }
}

pub type Commit = crate::worker::commit::ApprovedPlan<Prepared>;

pub type Committed = crate::worker::CommitResult<WrittenChanges>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceMessage {
    Handshake(Handshake),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobStep {
    ReadOut(ReadOutNumber),
    Program(ProgramNumber),
    Operation(String),
}

impl fmt::Display for JobStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            JobStep::ReadOut(read_out) => match read_out.row() {
                Some(row) => f.write_str(row.name),
                None => write!(f, "read-out 0x{:X}", read_out.to_u16()),
            },
            JobStep::Program(program) => write!(f, "cam program {}", program.get()),
            JobStep::Operation(item) => f.write_str(item),
        }
    }
}

#[derive(Debug)]
pub enum InterbusOutput {
    Hello(WordReading),
    Surveyed(Box<Survey>),
    Programs(Vec<(ProgramNumber, Program)>, WindowShift),
    Identity(Box<Identity>),
    Status(Box<Status>),
    Check(Vec<InterbusStepResult>),
    Position(WordReading),
    Item(ItemValue),
    ReadOut(ReadOutNumber, Value),
    Selected(StartupMode),
    Saved(Box<InterbusProfile>),
    Prepared(Box<Prepared>),
    Committed(Box<Committed>),
    ModeRestored(StartupMode),
}

pub type JobError = crate::worker::JobError<Error, PlanError, InterruptedWrite, ChangeKind>;

impl From<PlanError> for JobError {
    fn from(error: PlanError) -> Self {
        JobError::Plan(error)
    }
}

/// Returns the key of an encoder in backups and in the logbook. Only the serial number differs between encoders.
pub fn device_key(identity: &Identity, is_virtual: bool) -> DeviceKey {
    logbook_key(&identity.serial_number, is_virtual)
}

pub fn logbook_key(serial_number: &str, is_virtual: bool) -> DeviceKey {
    DeviceKey::new(KIND, "K3", serial_number, is_virtual)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::interbus::profile::{Base, Op};
    use crate::devices::interbus::protocol::Flags;

    #[test]
    fn enforces_wear_limits() {
        let identity = Identity {
            serial_number: "1".to_owned(),
            steps: 4096,
            revolutions: 1,
            direction: crate::devices::interbus::profile::Direction::Clockwise,
            software_version: 1,
            mode: StartupMode::K3,
            flags: Flags::new(Value::default()),
        };
        let wear = |seen: Option<u64>, stores: usize| {
            let ops = std::iter::repeat_n(Op::Default, stores).collect();
            let plan = InterbusPlan { base: Base::default(), ops };
            let (kind, identity) = (ChangeKind::Default, identity.clone());
            let parameters =
                Parameters { steps: 4096, revolutions: 1, direction: identity.direction, preset: 0, zero_shift: 0 };
            let prepared = Prepared {
                kind,
                plan,
                identity,
                parameters,
                cycles_seen: seen.map(CycleCount::complete),
                unchanged: 0,
                missing: Vec::new(),
                mounting_left: Vec::new(),
                other_type: None,
                mounting_written: Vec::new(),
            };
            prepared.wear_to_report()
        };
        let cases = [
            (Some(0), 1, None),
            // The number of earlier EEPROM write cycles is unknown (issue 22.4).
            (None, 1, Some(WearAfterPlan::Unknown)),
            (None, 0, None),
            (Some(148), 1, None),
            (Some(149), 1, Some(WearAfterPlan::Known(150))),
            (Some(199), 1, Some(WearAfterPlan::Known(200))),
            (Some(200), 1, Some(WearAfterPlan::Ask(201))),
            (Some(448), 1, Some(WearAfterPlan::Ask(449))),
            (Some(441), 9, Some(WearAfterPlan::Worn(450))),
            (Some(900), 0, None),
        ];
        for (seen, stores, told) in cases {
            assert_eq!(wear(seen, stores), told, "{seen:?} + {stores}");
        }
    }
}
