//! Access codes from the environment and from the `--code` option of every command. Messages never repeat text that
//! could be an access code.

use std::str::FromStr;

use clap::Args;

use crate::cli::{Failure, Result};
use crate::devices::hiperface::procedures::InitialAccessCodes;
use crate::devices::hiperface::protocol::{AccessCode, AccessCodeNumber};

/// Access code option of every command.
#[derive(Args)]
pub(super) struct AccessCodeArgs {
    /// Access code N, if it is not 55h; repeatable. Also read from ENCODER_STUDIO_CODES="0=66,2=1A".
    #[arg(long = "code", global = true, value_name = "N=HEX")]
    // Parsed later: clap repeats an invalid argument in its error message, and the argument may be an access code.
    pub(super) codes: Vec<String>,
}

#[derive(Clone, Copy)]
struct CodeArg {
    number: AccessCodeNumber,
    code: AccessCode,
}

impl FromStr for CodeArg {
    type Err = String;

    /// Parses an access code number and its code. The error message does not repeat the text, because it may be an
    /// access code.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let form = || "an access code has the form N=HEX with N from 0 to 3, such as 2=1A".to_owned();
        let (number, code) = text.split_once('=').ok_or_else(form)?;
        let number = number.trim().parse().ok().and_then(AccessCodeNumber::new).ok_or_else(form)?;
        Ok(CodeArg { number, code: parse_code(code).ok_or_else(form)? })
    }
}

/// Parses an access code of one or two hexadecimal digits. A prefix `0x` or a suffix `h` is allowed.
pub(super) fn parse_code(text: &str) -> Option<AccessCode> {
    match crate::bits::parse_hex(text.trim()).ok()?.as_slice() {
        [byte] => Some(AccessCode::new(*byte)),
        _ => None,
    }
}

/// Returns the access codes from the environment, followed by those from the command line.
pub(super) fn collect_access_codes(option: &AccessCodeArgs) -> Result<InitialAccessCodes> {
    let mut codes = Vec::new();
    if let Ok(text) = std::env::var("ENCODER_STUDIO_CODES") {
        for code in text.split(',').filter(|code| !code.trim().is_empty()) {
            codes.push(read(code.trim(), "ENCODER_STUDIO_CODES")?);
        }
    }
    for code in &option.codes {
        codes.push(read(code, "--code")?);
    }
    Ok(codes.into_iter().map(|CodeArg { number, code }| (number, code)).collect())
}

fn read(text: &str, from: &str) -> Result<CodeArg> {
    text.parse().map_err(|why| Failure::Usage(format!("{from}: {why}")))
}
