//! What the commands about profiles do with a BiSS encoder: `save`, `restore`, and reading it for a comparison.

use serde_json::json;

use super::run::Runner;
use crate::cli::args::{Common, Save};
use crate::cli::output::{Output, count};
use crate::cli::profiles::keep;
use crate::cli::runner::unexpected;
use crate::cli::{Done, Result};
use crate::profile::Body;
use crate::profile::biss::BissProfile;
use crate::worker::biss::{BissJob, BissOutput};

pub(super) fn save(common: &Common, output: &Output, save: &Save) -> Result {
    let profile = saved(common)?;
    let banks = profile.banks().count();
    keep(&save.file, Body::Biss(profile))?;
    let json = json!({"file": save.file, "banks": banks});
    output.show(&json, &format!("{}: {}\n", save.file.display(), count(banks, "bank")))?;
    Ok(Done::Well)
}

/// The encoder as it is, for a comparison.
pub(super) fn present(common: &Common) -> Result<Body> {
    Ok(Body::Biss(saved(common)?))
}

fn saved(common: &Common) -> Result<BissProfile> {
    match Runner::open(common)?.run(BissJob::Save)? {
        BissOutput::Saved(profile) => Ok(*profile),
        other => Err(unexpected(&other)),
    }
}
