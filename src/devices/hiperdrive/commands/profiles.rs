//! The `save` and `restore` commands for an adapter or a hub. Also reads the device for other commands, which compare
//! it.

use serde_json::json;

use super::HiperdriveCommands;
use super::plan::{commit_plan, plan_report, prepare_plan};
use super::run::Runner;
use crate::app::report::DeviceReading;
use crate::cli::args::{CommonArgs, Restore, SaveArgs};
use crate::cli::commands::ProfileCommands;
use crate::cli::output::{Output, count};
use crate::cli::profiles::{UnrestoredItems, profile_to_restore, restore_options, save_profile, write_restore};
use crate::cli::{Result, Success};
use crate::devices::hiperdrive::jobs::{Change, HiperdriveJob, HiperdriveOutput, Prepared};
use crate::devices::hiperdrive::profile::{self, HiperdriveProfile, Item};
use crate::devices::hiperdrive::protocol::drive_parameter::REFERENCE;
use crate::devices::hiperdrive::state::explain;
use crate::devices::hiperdrive::state::status_lines;
use crate::profile::{Body, IrreversibleItem, Redo};
use crate::result_of;

pub(super) fn save(common: &CommonArgs, output: &Output, save: &SaveArgs) -> Result {
    let profile = read_profile(common)?;
    let (parameters, drives) = (profile.image.values.len(), profile.identity.drives.len());
    save_profile(common, &save.file, Body::new(profile))?;
    let json = json!({"file": save.file, "parameters": parameters, "drives": drives});
    let counted = format!("{} of the device and {}", count(parameters, "parameter"), count(drives, "drive"));
    output.show(&json, &format!("{}: {counted}\n", save.file.display()))?;
    Ok(Success::Completed)
}

impl ProfileCommands for HiperdriveCommands {
    fn restore(&self, common: &CommonArgs, output: &Output, restore: &Restore, profile: Body) -> Result {
        let options = restore_options(restore)?;
        let profile = profile_to_restore::<HiperdriveProfile>(restore, profile)?;
        let mut runner = Runner::open(common)?;
        let prepared = prepare_plan(&mut runner, output, Change::Restore { profile: Box::new(profile), options })?;
        for types in &prepared.other_types {
            output.print_message(&explain::other_type(types).terminal_text());
        }
        for words in missing_items(&prepared) {
            output.print_message(&words);
        }
        for item in &prepared.mounting_left {
            let how = match item.0.drive1_number() {
                REFERENCE => "a reference is never restored; set it with \"do hiperdrive set-position\"",
                _ => "use --with-mounting to restore it",
            };
            output.print_message(&format!("{item} belongs to the mounting and is not restored: {how}"));
        }
        let redo = prepared.mounting_written.iter().map(ToString::to_string).collect();
        let left = UnrestoredItems { unchanged: prepared.unchanged, missing: prepared.missing.clone(), redo };
        let plan = plan_report(&prepared);
        write_restore(common, output, restore, prepared, &plan, &left, |prepared| {
            commit_plan(&mut runner, output, prepared, &restore.consent)
        })
    }

    fn read_for_comparison(&self, common: &CommonArgs, _output: &Output, _profile: Option<&Body>) -> Result<Body> {
        Ok(Body::new(read_profile(common)?))
    }

    fn read_for_report(&self, common: &CommonArgs, _output: &Output) -> Result<DeviceReading> {
        let mut runner = Runner::open(common)?;
        let status = result_of!(runner.run(HiperdriveJob::Status)?, HiperdriveOutput::Status(status) => *status);
        let profile = result_of!(runner.run(HiperdriveJob::Save)?, HiperdriveOutput::Saved(profile) => *profile);
        let status = Some(status.drives.iter().flat_map(status_lines).collect());
        Ok(DeviceReading { body: Body::new(profile), status })
    }

    fn redo_command(&self, kept: &IrreversibleItem) -> Option<String> {
        match &kept.redo {
            Redo::SetPosition => Some("set the reference again with \"do hiperdrive set-position\"".to_owned()),
            _ => None,
        }
    }

    /// Returns a message if the two profiles are from different devices or have different drives. Serial numbers are
    /// compared only if the profile contains them.
    fn device_mismatch(&self, profile: &Body, device: &Body) -> Option<String> {
        let error =
            profile::check_device(profile.get::<HiperdriveProfile>()?, &device.get::<HiperdriveProfile>()?.identity)
                .err()?;
        Some(match error {
            profile::PlanError::OtherDevice { profile, device } => {
                format!("The profile is of serial number {profile}, the device has {device}.")
            }
            other => format!("{other}."),
        })
    }
}

fn read_profile(common: &CommonArgs) -> Result<HiperdriveProfile> {
    Ok(result_of!(Runner::open(common)?.run(HiperdriveJob::Save)?, HiperdriveOutput::Saved(profile) => *profile))
}

/// Lists the profile items that the device does not have. An empty port is listed once, regardless of the number of its
/// parameters.
fn missing_items(prepared: &Prepared) -> Vec<String> {
    let missing = prepared.missing.iter().map(|name| (name, name.parse::<Item>().ok().and_then(|item| item.0.drive())));
    let words = missing.map(|(name, drive)| match drive.filter(|drive| prepared.identity.drive(*drive).is_none()) {
        Some(drive) => format!("no drive is connected to port {}: its parameters are not restored", drive.get()),
        None => format!("{name} is not restored: the device does not have it"),
    });
    let mut words: Vec<String> = words.collect();
    words.dedup();
    words
}
