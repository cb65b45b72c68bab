//! `do`: its actions, and what they take.

use clap::{Args, ValueEnum};

use super::Consenting;
use crate::cli::Failure;
use crate::cli::commands::OwnOptions;

#[derive(Args)]
pub(crate) struct Do {
    /// The kind of device.
    pub(in crate::cli) device: String,
    /// What to do.
    pub(crate) action: Action,
    /// What the action takes, as said there.
    #[arg(allow_negative_numbers = true)]
    pub(crate) arguments: Vec<String>,
    #[command(flatten)]
    pub(crate) consent: Consenting,
    #[command(flatten)]
    pub(crate) own: OwnOptions,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Action {
    /// hiperface: restart the encoder and read its status.
    Reset,
    // Several kinds of device have it.
    #[value(
        help = "hiperface: the start-up sequence with a verdict a line, with restart behind it after a restart; biss: identity, errors, position, data sheet, limits, wear with a verdict a line; interbus: gateway, word order, handshake, identity; hiperdrive: device, supply, address, and of each drive request, line, errors, range"
    )]
    Check,
    // Two kinds of device have it.
    #[value(
        help = "hiperface: POSITION, the nearest value that keeps the phase to the sine signal; hiperdrive: POSITION [--drive N], what the drive's place becomes, rounded to 64 steps and saved"
    )]
    SetPosition,
    /// hiperface: POSITION, for kit encoders, aligns the code tracks as well.
    Synchronise,
    // Brackets in what rustdoc reads would be links.
    #[value(help = "hiperface: NUMBER SIZE|STATUS [code=N] [ce=0|1] [we=0|1]")]
    CreateField,
    /// hiperface: NUMBER SIZE, the last field only.
    ResizeField,
    /// hiperface: NUMBER, write protect.
    LockField,
    /// hiperface: NUMBER, make writable.
    UnlockField,
    /// hiperface: NUMBER, the last field only.
    DeleteField,
    /// hiperface: NUMBER HEX, the present code is given with --code.
    ChangeCode,
    /// hiperface: counter + 1.
    IncrementCounter,
    /// hiperface: counter to 0.
    ClearCounter,
    /// hiperface: SETTINGS, interface settings until the next restart.
    ConfigureForNow,
    /// biss: calibrate the singleturn; the motor turns counterclockwise, then clockwise, at 500 ± 2 rpm.
    Calibrate,
    #[value(
        help = "biss: [save], test the Wiegand sensor; the motor turns clockwise, then counterclockwise, at 500 to 2000 rpm"
    )]
    WiegandTest,
    /// biss: balanced|dynamic.
    Filter,
    #[value(
        help = "biss: [ST [MT]] [singleturn|multiturn]: store a value (MT 0 if left out), then make the shaft's place that value; without a value the stored one; interbus: [POSITION], the same at standstill"
    )]
    Preset,
    // Two kinds of device have it.
    #[value(
        help = "biss: back to operation and the password cleared, after a procedure was cut off; values that were entered and not saved are lost, which a terminal asks for (--yes); interbus: out of a parameterisation that was left, to run"
    )]
    LeadBack,
    /// interbus: back to what was delivered; experimental, since only the manual's appendix has it.
    Default,
    /// hiperdrive: the fault of a drive (--drive N).
    Acknowledge,
    /// hiperdrive: what was written and is not saved yet (47 = 1).
    Save,
    /// hiperdrive: the device's own parameters from the factory, not saved (47 = -1); with --all everything, saved (47 = -3).
    Factory,
    /// hiperdrive: the device's own parameters as saved last, not those of its drives (47 = -2).
    Recall,
    /// hiperdrive: which drives are there; resets them (47 = -4).
    PresenceTest,
    #[value(
        help = "biss: [calibrate] [wiegand-test] [save] [preset=ST,MT] [data=FILE] in one run; without the first two both are meant"
    )]
    Mounting,
}

/// The action as it is written.
pub(crate) fn action_name(action: Action) -> String {
    action.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}

/// An action that is for another kind of device.
pub(crate) fn no_action(action: Action, kind: &str, known: &str) -> Failure {
    Failure::Usage(format!("{} is not an action of {kind} devices; these are {known}", action_name(action)))
}
