//! `do`: an action of a kind of device with its arguments.

use clap::{Args, ValueEnum};

use super::{AssetArgs, ConsentArgs};
use crate::cli::commands::KindOptions;
use crate::cli::{Failure, Result};

#[derive(Args)]
pub struct ActionArgs {
    /// Kind of device.
    pub(in crate::cli) device: String,
    /// Action to carry out
    pub(crate) action: String,
    /// Arguments of the action
    #[arg(allow_negative_numbers = true)]
    pub(crate) arguments: Vec<String>,
    #[command(flatten)]
    pub(crate) consent: ConsentArgs,
    #[command(flatten)]
    pub(in crate::cli) asset: AssetArgs,
    #[command(flatten)]
    pub(crate) own: KindOptions,
}

impl ActionArgs {
    /// Parses the action name as an action of type `A`. `kind` and `known` are the name of the kind of device and its
    /// list of actions, for the error message.
    ///
    /// # Errors Returns an error if this kind of device does not have the action.
    pub(crate) fn parse_action<A: ValueEnum>(&self, kind: &str, known: &str) -> Result<A> {
        let action = &self.action;
        A::from_str(action, false)
            .map_err(|_| Failure::Usage(format!("{action} is not an action of {kind} devices; these are {known}")))
    }
}
