//! The commands `save` and `restore` for INTERBUS profiles, and reading an encoder for a comparison.

use serde_json::json;

use super::DisturbanceLevel;
use super::InterbusCommands;
use super::plan::{commit_plan, plan_report, prepare_plan};
use super::run::{Runner, programs, read_survey};
use crate::app::report::DeviceReading;
use crate::cli::args::{CommonArgs, Restore, SaveArgs};
use crate::cli::commands::ProfileCommands;
use crate::cli::output::{Output, count};
use crate::cli::profiles::{
    UnrestoredItems, print_missing, print_skipped_mounting, profile_to_restore, restore_options, save_profile,
    write_restore,
};
use crate::cli::{Result, Success};
use crate::devices::interbus::jobs::{Change, InterbusJob, InterbusOutput};
use crate::devices::interbus::profile::{self, Image, InterbusProfile, PlanError, RecordedValues, programs_to_read};
use crate::devices::interbus::state::explain;
use crate::devices::interbus::state::status_lines;
use crate::profile::Body;
use crate::result_of;

pub(super) fn save(common: &CommonArgs, output: &Output, save: &SaveArgs) -> Result {
    let profile = read_profile(common, output)?;
    let programs = profile.image.known_programs().count();
    save_profile(common, &save.file, Body::new(profile))?;
    let json = json!({"file": save.file, "programs": programs});
    output.show(&json, &format!("{}: {}\n", save.file.display(), count(programs, "cam program")))?;
    Ok(Success::Completed)
}

impl ProfileCommands for InterbusCommands {
    fn restore(&self, common: &CommonArgs, output: &Output, restore: &Restore, profile: Body) -> Result {
        let options = restore_options(restore)?;
        let profile = profile_to_restore::<InterbusProfile>(restore, profile)?;
        let mut runner = Runner::open(common)?;
        let disturbs =
            if programs_to_read(&profile).is_empty() { DisturbanceLevel::Reading } else { DisturbanceLevel::Programs };
        disturbs.confirm_start(common, output, Some(&restore.consent))?;
        let prepared = prepare_plan(&mut runner, output, Change::Restore { profile: Box::new(profile), options })?;
        if let Some(types) = prepared.other_type {
            output.print_message(&explain::other_type(types).terminal_text());
        }
        print_missing(output, &prepared.missing);
        print_skipped_mounting(output, &prepared.mounting_left);
        let redo = prepared.mounting_written.iter().map(ToString::to_string).collect();
        let left = UnrestoredItems { unchanged: prepared.unchanged, missing: prepared.missing.clone(), redo };
        let plan = plan_report(&prepared);
        write_restore(common, output, restore, prepared, &plan, &left, |prepared| {
            commit_plan(&mut runner, output, prepared, &restore.consent)
        })
    }

    /// Reads the encoder for a comparison, limited to the items of the profile if one is given. Reading a cam program
    /// switches the outputs of the encoder.
    fn read_for_comparison(&self, common: &CommonArgs, output: &Output, profile: Option<&Body>) -> Result<Body> {
        let profile = match profile.and_then(Body::get::<InterbusProfile>) {
            None => read_profile(common, output)?,
            Some(profile) => read_comparable_profile(common, output, profile)?,
        };
        Ok(Body::new(profile))
    }

    fn read_for_report(&self, common: &CommonArgs, output: &Output) -> Result<DeviceReading> {
        let mut runner = Runner::open(common)?;
        DisturbanceLevel::Programs.confirm_start(common, output, None)?;
        let status = result_of!(runner.run(InterbusJob::Status)?, InterbusOutput::Status(status) => *status);
        let profile = saved_profile(&mut runner)?;
        Ok(DeviceReading { body: Body::new(profile), status: Some(status_lines(status.error)) })
    }

    /// Returns a message if two profiles belong to different encoders. A profile without a serial number matches any
    /// encoder of the same type.
    fn device_mismatch(&self, profile: &Body, device: &Body) -> Option<String> {
        let error =
            profile::check_device(profile.get::<InterbusProfile>()?, &device.get::<InterbusProfile>()?.identity)
                .err()?;
        Some(match error {
            PlanError::TypeMismatch(types) => explain::other_type(types).terminal_text(),
            PlanError::OtherDevice { profile, device } => {
                format!("The profile is of serial number {profile}, the encoder has {device}.")
            }
            other => format!("{other}."),
        })
    }
}

fn read_profile(common: &CommonArgs, output: &Output) -> Result<InterbusProfile> {
    let mut runner = Runner::open(common)?;
    DisturbanceLevel::Programs.confirm_start(common, output, None)?;
    saved_profile(&mut runner)
}

fn saved_profile(runner: &mut Runner) -> Result<InterbusProfile> {
    Ok(result_of!(runner.run(InterbusJob::Save { programs: true })?, InterbusOutput::Saved(profile) => *profile))
}

fn read_comparable_profile(common: &CommonArgs, output: &Output, profile: &InterbusProfile) -> Result<InterbusProfile> {
    let needed = programs_to_read(profile);
    let mut runner = Runner::open(common)?;
    let disturbs = if needed.is_empty() { DisturbanceLevel::Reading } else { DisturbanceLevel::Programs };
    disturbs.confirm_start(common, output, None)?;
    let survey = read_survey(&mut runner)?;
    let mut image = Image::from_parameters(survey.parameters);
    if !needed.is_empty() {
        let (read, shift) = programs(&mut runner, needed)?;
        image.shift = Some(shift);
        for (number, program) in read {
            if let Some(place) = image.program_mut(number) {
                *place = Some(program);
            }
        }
    }
    Ok(InterbusProfile::new(survey.identity.profile(), image, RecordedValues::default()))
}
