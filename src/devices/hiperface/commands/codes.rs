//! Access codes on the command line: `--code` of every command and of the window, preceded by the environment. Messages
//! never repeat what may be a code.

use std::str::FromStr;

use clap::Args;

use crate::cli::{Failure, Result};
use crate::devices::hiperface::procedures::AccessCodes;
use crate::devices::hiperface::protocol::{AccessCode, AccessCodeNumber};

/// Access code option of every command.
#[derive(Args)]
pub(super) struct CodeOption {
    /// Access code N, if it is not 55h; repeatable. Also read from ENCODER_STUDIO_CODES="0=66,2=1A".
    #[arg(long = "code", global = true, value_name = "N=HEX")]
    // Taken as text: an error message about a wrong argument repeats it, and this may be a code.
    pub(super) codes: Vec<String>,
}

/// Access code with its number.
#[derive(Clone, Copy)]
struct Code {
    number: AccessCodeNumber,
    code: AccessCode,
}

impl FromStr for Code {
    type Err = String;

    /// Parses an access code with its number. The error message never repeats the input, since it may be a code.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let form = || "an access code has the form N=HEX with N from 0 to 3, such as 2=1A".to_owned();
        let (number, code) = text.split_once('=').ok_or_else(form)?;
        let number = number.trim().parse().ok().and_then(AccessCodeNumber::new).ok_or_else(form)?;
        Ok(Code { number, code: parse_code(code).ok_or_else(form)? })
    }
}

/// Parses an access code: one or two hex digits, with or without `0x` or a final `h`.
pub(super) fn parse_code(text: &str) -> Option<AccessCode> {
    match crate::bits::parse_hex(text.trim()).ok()?.as_slice() {
        [byte] => Some(AccessCode::new(*byte)),
        _ => None,
    }
}

/// Returns the access codes from the environment, followed by those from the command line.
pub(super) fn given(option: &CodeOption) -> Result<AccessCodes> {
    let mut codes = Vec::new();
    if let Ok(text) = std::env::var("ENCODER_STUDIO_CODES") {
        for code in text.split(',').filter(|code| !code.trim().is_empty()) {
            codes.push(read(code.trim(), "ENCODER_STUDIO_CODES")?);
        }
    }
    for code in &option.codes {
        codes.push(read(code, "--code")?);
    }
    Ok(codes.into_iter().map(|Code { number, code }| (number, code)).collect())
}

fn read(text: &str, from: &str) -> Result<Code> {
    text.parse().map_err(|why| Failure::Usage(format!("{from}: {why}")))
}
