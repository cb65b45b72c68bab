//! Creation and comparison of SSI profiles. A profile is created from a layout, because an encoder cannot report its
//! settings.

use std::path::Path;

use serde_json::json;

use super::args::{LayoutOption, SsiLayoutArgs};
use super::layout::select_layout;
use crate::app::explain;
use crate::cli::args::{CommonArgs, SaveArgs};
use crate::cli::output::{Output, count};
use crate::cli::runner::to_failure;
use crate::cli::{Failure, Result, Success};
use crate::devices::ssi::profile::SsiProfile;
use crate::profile::{Body, ProfileDocument};
use crate::store::write_atomically;

pub(super) fn save(common: &CommonArgs, output: &Output, save: &SaveArgs) -> Result {
    let LayoutOption { layout: Some(spec) } = save.own.read()? else {
        let why = "save ssi needs --layout FILE|SPEC: an SSI encoder does not report the layout of its frame";
        return Err(Failure::Usage(why.to_owned()));
    };
    if common.link.is_some() {
        return Err(Failure::Usage("save ssi saves the layout of --layout without a device: remove --link".to_owned()));
    }
    let profile = select_layout(output, &SsiLayoutArgs { spec })?.profile;
    let clocks = profile.descriptor.clocks;
    write(&save.file, &profile_document(profile).emit())?;
    let json = json!({"file": save.file, "clocks": clocks});
    output.show(&json, &format!("{}: {}\n", save.file.display(), count(clocks.into(), "clock")))?;
    Ok(Success::Completed)
}

/// Creates a profile document. It has no time stamp, because the layout was not read from a device.
pub(super) fn profile_document(profile: SsiProfile) -> ProfileDocument {
    ProfileDocument { saved: None, ..ProfileDocument::new(String::new(), Body::new(profile)) }
}

pub(super) fn write(path: &Path, text: &str) -> Result<()> {
    write_atomically(path, text.as_bytes()).map_err(|error| to_failure(&explain::file_error_text(&error)))
}
