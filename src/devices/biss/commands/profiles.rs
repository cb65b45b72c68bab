//! The `save` and `restore` commands for BiSS encoders, and the reading of an encoder for comparisons and reports.

use serde_json::json;

use super::BissCommands;
use super::plan::{commit_plan, plan_report, prepare_plan};
use super::run::Runner;
use crate::app::Text;
use crate::app::report::DeviceReading;
use crate::cli::args::{CommonArgs, Restore, SaveArgs};
use crate::cli::commands::ProfileCommands;
use crate::cli::output::{Output, count};
use crate::cli::profiles::{
    UnrestoredItems, print_missing, print_skipped_mounting, profile_to_restore, restore_options, save_profile,
    write_restore,
};
use crate::cli::{Result, Success};
use crate::devices::biss::jobs::{BissJob, BissOutput, Change};
use crate::devices::biss::profile::{BissProfile, ProfileIdentity};
use crate::devices::biss::protocol::DeviceMode;
use crate::devices::biss::state::explain;
use crate::devices::biss::state::status_lines;
use crate::profile::{Body, IrreversibleItem, Redo};
use crate::result_of;

pub(super) fn save(common: &CommonArgs, output: &Output, save: &SaveArgs) -> Result {
    let profile = read_saved_profile(common, BissJob::Save)?;
    let banks = profile.banks().count();
    let (mode, unsaved) = (profile.recorded.device_mode, explain::unsaved_profile_warning(&profile));
    save_profile(common, &save.file, Body::new(profile))?;
    if let Some(words) = unsaved {
        output.print_message(&words.terminal_text());
    }
    let json = json!({"file": save.file, "banks": banks, "unsaved_in_mode": mode.map(DeviceMode::byte)});
    output.show(&json, &format!("{}: {}\n", save.file.display(), count(banks, "bank")))?;
    Ok(Success::Completed)
}

impl ProfileCommands for BissCommands {
    fn restore(&self, common: &CommonArgs, output: &Output, restore: &Restore, profile: Body) -> Result {
        let options = restore_options(restore)?;
        let profile = profile_to_restore::<BissProfile>(restore, profile)?;
        let mut runner = Runner::open(common)?;
        let prepared = prepare_plan(&mut runner, Change::Restore { profile: Box::new(profile), options })?;
        if let Some(types) = &prepared.other_type {
            output.print_message(&explain::other_type(types).terminal_text());
        }
        print_missing(output, &prepared.missing);
        print_skipped_mounting(output, &prepared.mounting_left);
        let redo = prepared.mounting_written.iter().map(ToString::to_string).collect();
        let left = UnrestoredItems { unchanged: prepared.unchanged, missing: prepared.missing.clone(), redo };
        let plan = plan_report(&prepared);
        write_restore(common, output, restore, prepared, &plan, &left, |prepared| {
            commit_plan(&mut runner, output, prepared, &restore.consent, super::OPERATOR_TIMEOUT)
                .map(|(spent, _)| spent)
        })
    }

    /// Reads the encoder for comparison. Fails if its registers may show values that were never saved.
    fn read_for_comparison(&self, common: &CommonArgs, _output: &Output, _profile: Option<&Body>) -> Result<Body> {
        Ok(Body::new(read_saved_profile(common, BissJob::SaveToCompare)?))
    }

    fn read_for_report(&self, common: &CommonArgs, _output: &Output) -> Result<DeviceReading> {
        let mut runner = Runner::open(common)?;
        let status = result_of!(runner.run(BissJob::Status)?, BissOutput::Status(status) => *status);
        let profile = result_of!(runner.run(BissJob::Save)?, BissOutput::Saved(profile) => *profile);
        let status = Some(status_lines(&status));
        Ok(DeviceReading { body: Body::new(profile), status })
    }

    fn redo_command(&self, kept: &IrreversibleItem) -> Option<String> {
        match &kept.redo {
            Redo::Write(old) => Some(format!("use \"write biss {} 0x{old}\"", kept.item)),
            Redo::Repeat => Some("repeat the procedure (help do lists the actions)".to_owned()),
            _ => None,
        }
    }

    /// Returns a message if the profile was read outside operation mode and may therefore contain unsaved values.
    fn profile_note(&self, profile: &Body) -> Option<Text> {
        explain::profile_unsaved(profile.get()?)
    }

    fn device_mismatch(&self, profile: &Body, device: &Body) -> Option<String> {
        let (profile, device) = (&profile.get::<BissProfile>()?.identity, &device.get::<BissProfile>()?.identity);
        let who = |one: &ProfileIdentity| (one.serial_number.clone(), one.kind());
        (who(profile) != who(device)).then(|| {
            let [profile, device] = [profile, device].map(|one| format!("{} ({})", one.serial_number, one.kind()));
            format!("The profile is of {profile}, the encoder is {device}.")
        })
    }
}

fn read_saved_profile(common: &CommonArgs, job: BissJob) -> Result<BissProfile> {
    Ok(result_of!(Runner::open(common)?.run(job)?, BissOutput::Saved(profile) => *profile))
}
