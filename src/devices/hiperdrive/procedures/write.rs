//! Executes a plan. The values on which the plan is based are read again first. Each operation is executed and then
//! read back (reference, section 4).

use std::time::Duration;

pub use crate::profile::WrittenChanges;

use super::error::RequestedItem;
use super::identify::{device_parameter, drive_parameter, drive_status, read_drive_text, read_topology};
use super::network::settings;
use super::{Error, Identity, Master};
use crate::buses::ethernet_ip::protocol::{ConfigurationControl, InterfaceConfiguration};
use crate::devices::hiperdrive::profile::{Base, HiperdrivePlan, Item, NetworkSettings, Op, Service};
use crate::devices::hiperdrive::protocol::drive_parameter::{
    ACKNOWLEDGE, DENOMINATOR, LOWER_LIMIT, NUMERATOR, POSITION, REFERENCE, STATUS, UPPER_LIMIT,
};
use crate::devices::hiperdrive::protocol::{
    DriveNumber, ErrorCode, ParameterNumber, State, StatusBit, StatusWord, nearest_reference,
};
use crate::profile::{ConfirmedPlan, Write};

/// A write that was interrupted. Values written before the interruption may be lost at power-off unless they are saved.
pub type InterruptedWrite = crate::profile::InterruptedWrite<Op, Error, WrittenChanges, ()>;

impl InterruptedWrite {
    /// Returns the item changed by the unfinished operation, which may have been partly executed. Returns `None` if the
    /// operation did not start, for example after a cancellation.
    pub fn uncertain_write(&self) -> Option<String> {
        self.unfinished.as_ref().filter(|_| !self.cause.is_cancelled()).map(Op::item_name)
    }
}

/// Interval between two reads of parameter 47.
const POLL_INTERVAL: Duration = Duration::from_millis(50);
/// Delay before the first read after an operation that includes a reset, which may not start immediately.
const RESET_START_DELAY: Duration = Duration::from_millis(100);

pub struct DeviceWriter<'w, 'm> {
    pub master: Master<'m>,
    pub identity: &'w Identity,
}

impl Write for DeviceWriter<'_, '_> {
    type Base = Base;
    type Op = Op;
    type Error = Error;
    type Written = WrittenChanges;
    type EndState = ();

    /// Checks that the drives are unchanged and that no drive is moving.
    fn confirm_base(&mut self, plan: &HiperdrivePlan) -> Result<(), Error> {
        let (master, identity) = (&mut self.master, self.identity);
        let changed = |item: String| Err(Error::Changed { item });
        if master.read_number(device_parameter(17)?)?.to_string() != identity.serial_number {
            return changed("the device itself".to_owned());
        }
        for drive in affected_drives(plan, identity) {
            if let Some(known) = identity.drive(drive)
                && read_drive_text(master, 123, drive)? != known.serial_number
            {
                return changed(format!("drive {}", drive.get()));
            }
            let status = master.read_number(drive_parameter(STATUS, drive)?)?;
            // The status word has 16 bits.
            if StatusWord::new(status as u16).state() == State::Moving {
                return Err(Error::Moving { drive });
            }
        }
        for (number, before) in &plan.base.values {
            if master.read_number(*number)? != *before {
                return changed(Item(*number).to_string());
            }
        }
        if let Some(before) = &plan.base.network
            && settings(master)? != *before
        {
            return changed("network".to_owned());
        }
        Ok(())
    }

    fn apply(
        &mut self,
        op: &Op,
        confirmed: &ConfirmedPlan<'_, Base, Op>,
        done: &mut WrittenChanges,
    ) -> Result<(), Error> {
        if !has_incomplete_scale_or_limits(&confirmed.plan().ops, done.ops) {
            self.master.check_cancel()?;
        }
        self.master.run_uncancellable(|master| execute(master, op, done))?;
        done.count_operation(op.change_count());
        Ok(())
    }

    fn end_state(&mut self, _: &Error) {}
}

/// Returns the drives affected by a plan: all drives if the plan affects the whole device.
fn affected_drives(plan: &HiperdrivePlan, identity: &Identity) -> Vec<DriveNumber> {
    let of_op = |op: &Op| match op {
        Op::Write { number, .. } => number.drive(),
        Op::Service(Service::Acknowledge(drive)) => Some(*drive),
        Op::Service(_) | Op::Network { .. } => None,
    };
    let resets = |op: &Op| matches!(op, Op::Service(service) if *service != Service::Save && service.code().is_some());
    if plan.ops.iter().any(resets) {
        return identity.drives.iter().map(|drive| drive.number).collect();
    }
    let mut drives: Vec<DriveNumber> = plan.ops.iter().filter_map(of_op).collect();
    drives.sort();
    drives.dedup();
    drives
}

/// Returns whether the scale and limits of a drive are only partly written before this operation. A write must not stop
/// at this point, because the same limits mean other positions under another scale.
fn has_incomplete_scale_or_limits(ops: &[Op], at: usize) -> bool {
    let place = |op: &Op| match op {
        Op::Write { number, .. }
            if matches!(number.drive1_number(), NUMERATOR | DENOMINATOR | LOWER_LIMIT | UPPER_LIMIT) =>
        {
            number.drive()
        }
        _ => None,
    };
    let (begun, left) = ops.split_at_checked(at).unwrap_or((ops, &[]));
    left.iter().filter_map(place).any(|drive| begun.iter().filter_map(place).any(|own| own == drive))
}

fn execute(master: &mut Master<'_>, op: &Op, done: &mut WrittenChanges) -> Result<(), Error> {
    match op {
        Op::Write { number, new, .. } => {
            write(master, *number, *new)?;
            done.verified += 1;
        }
        Op::Service(service) => perform_service(master, *service, done)?,
        Op::Network { from, to } => {
            done.write_cycles += 1;
            write_network(master, from, to)?;
            done.verified += 1;
        }
    }
    Ok(())
}

/// Writes a parameter and reads it back. For parameter 198, the drive rounds the value to 64 steps (reference, section
/// 4) and adopts it as its position.
fn write(master: &mut Master<'_>, number: ParameterNumber, wanted: i64) -> Result<(), Error> {
    master.set_parameter(number, wanted)?;
    let reads = master.read_number(number)?;
    let Some(drive) = number.drive().filter(|_| number.drive1_number() == REFERENCE) else {
        return if reads == wanted { Ok(()) } else { Err(Error::NotAccepted { number, wanted, reads }) };
    };
    let rounded = i32::try_from(wanted).ok().and_then(nearest_reference).map_or(wanted, i64::from);
    if reads != rounded && reads != wanted {
        return Err(Error::NotAccepted { number, wanted, reads });
    }
    let number = drive_parameter(POSITION, drive)?;
    let (numerator, denominator) = (
        master.read_number(drive_parameter(NUMERATOR, drive)?)?,
        master.read_number(drive_parameter(DENOMINATOR, drive)?)?,
    );
    // A drive at standstill readjusts its position by less than five degrees, which is 1/72 of a turn. A turn has 256 ·
    // numerator / denominator steps.
    let near = (256 * numerator / denominator.max(1) / 72).max(64);
    let position = master.read_number(number)?;
    if (position - reads).abs() <= near {
        Ok(())
    } else {
        Err(Error::NotAccepted { number, wanted: reads, reads: position })
    }
}

fn perform_service(master: &mut Master<'_>, service: Service, done: &mut WrittenChanges) -> Result<(), Error> {
    match service {
        Service::Acknowledge(drive) => return acknowledge(master, drive),
        Service::Save | Service::FactoryAll => done.write_cycles += 1,
        Service::Recall | Service::Factory | Service::Reset => {}
    }
    let Some(code) = service.code() else { return Ok(()) };
    // The time limit depends on the topology.
    read_topology(master)?;
    master.set_parameter(ParameterNumber::SAVE, code)?;
    let patience = master.max_wait(ParameterNumber::SAVE, code);
    await_idle(master, service, patience)
}

/// Waits until parameter 47 is 0. The device may reply to the request before it has finished the service.
fn await_idle(master: &mut Master<'_>, service: Service, patience: Duration) -> Result<(), Error> {
    let begun = master.now();
    if matches!(service, Service::Reset | Service::FactoryAll) {
        master.wait(RESET_START_DELAY)?;
    }
    loop {
        let waited = master.now().duration_since(begun);
        // During a reset, the device may reject reads.
        let reads = match master.read_number(ParameterNumber::SAVE) {
            Ok(0) => return Ok(()),
            Ok(reads) => reads,
            Err(error) if error.is_unavailable() => -1,
            Err(error) => return Err(error),
        };
        if waited >= patience {
            return Err(Error::Busy { reads, milliseconds: waited.as_millis() as u64 });
        }
        master.wait(POLL_INTERVAL)?;
    }
}

/// Method of clearing a drive's fault (reference, section 4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultReset {
    /// The drive has no fault.
    Nothing,
    /// Setting parameter 197 to 0, which clears nothing but an RS-485 fault.
    Acknowledgement,
    /// A reset of all drives before the acknowledgement.
    Reset,
}

/// Determines how to clear a drive's fault.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn find_remedy(master: &mut Master<'_>, drive: DriveNumber) -> Result<FaultReset, Error> {
    let status = drive_status(master, drive)?;
    // Older errors are already acknowledged.
    let mut recent = status.buffer.iter().take(usize::from(status.faults));
    let word = status.status;
    let has_failed = matches!(word.state(), State::Fault | State::Locked) || word.is_set(StatusBit::Warning);
    Ok(match status.faults {
        0 if !has_failed => FaultReset::Nothing,
        _ if recent.any(|code| *code != ErrorCode::RS485) => FaultReset::Reset,
        _ => FaultReset::Acknowledgement,
    })
}

/// Clears the fault of a drive by writing 0 to parameter 197. If a reset is required first, it is a separate operation.
fn acknowledge(master: &mut Master<'_>, drive: DriveNumber) -> Result<(), Error> {
    let number = drive_parameter(ACKNOWLEDGE, drive)?;
    master.set_parameter(number, 0)?;
    match master.read_number(number)? {
        0 => Ok(()),
        reads => Err(Error::NotAccepted { number, wanted: 0, reads }),
    }
}

/// Writes the address source first and then the addresses, because setting the source to *stored* stores the current
/// address (reference, section 1).
fn write_network(master: &mut Master<'_>, from: &NetworkSettings, to: &NetworkSettings) -> Result<(), Error> {
    if from.source != to.source {
        let attribute = ConfigurationControl::ATTRIBUTE;
        let requested = RequestedItem::Network { attribute };
        let before = master.read_attribute(requested, ConfigurationControl::CLASS, attribute)?;
        let before = ConfigurationControl::parse(&before);
        let before = before.map_err(|cause| Error::Damaged { requested, tries: 1, cause: cause.into() })?;
        set_network(master, attribute, before.with_source(to.source).emit().to_vec())?;
    }
    if from.interface != to.interface {
        set_network(master, InterfaceConfiguration::ATTRIBUTE, to.interface.emit())?;
    }
    if settings(master)? == *to {
        Ok(())
    } else {
        Err(Error::NetworkNotTaken { attribute: InterfaceConfiguration::ATTRIBUTE })
    }
}

fn set_network(master: &mut Master<'_>, attribute: u16, data: Vec<u8>) -> Result<(), Error> {
    master.set_attribute(RequestedItem::SetNetwork { attribute }, (ConfigurationControl::CLASS, attribute), data)
}
