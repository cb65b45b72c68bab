//! The `save` and `restore` commands for HIPERFACE encoders, and reading an encoder for a comparison.

use std::collections::BTreeMap;

use serde_json::json;

use super::HiperfaceCommands;
use super::write::{commit_plan, operations_json, plan_text};
use crate::app::report::DeviceReading;
use crate::cli::args::{CommonArgs, Restore, SaveArgs};
use crate::cli::commands::ProfileCommands;
use crate::cli::output::{Output, count};
use crate::cli::plan::PlanReport;
use crate::cli::profiles::{UnrestoredItems, print_skipped_mounting, profile_to_restore, save_profile, write_restore};
use crate::cli::{Failure, Result, Success};
use crate::devices::hiperface::commands::run::Runner;
use crate::devices::hiperface::jobs::{Change, HiperfaceJob, HiperfaceOutput, Prepared, SavedProfile};
use crate::devices::hiperface::procedures::SaveOptions;
use crate::devices::hiperface::profile::{FieldRange, HiperfaceProfile, Item, RestoreOptions, UnknownMeaningField};
use crate::devices::hiperface::state::explain;
use crate::devices::hiperface::state::status_lines;
use crate::profile::{Body, IrreversibleItem, Redo};
use crate::result_of;

pub(super) fn save(common: &CommonArgs, output: &Output, save: &SaveArgs) -> Result {
    let mut runner = Runner::open(common)?;
    let saved = read_saved_profile(&mut runner, SaveOptions { complete: save.complete })?;
    report_locked_fields(output, &saved, "saved without its bytes");
    let fields = saved.profile.fields.len();
    let locked: Vec<u8> = saved.locked.iter().map(|(field, _)| *field).collect();
    save_profile(common, &save.file, Body::new(saved.profile))?;
    let json = json!({"file": save.file, "fields": fields, "locked": locked});
    output.show(&json, &format!("{}: {}\n", save.file.display(), count(fields, "data field")))?;
    Ok(Success::Completed)
}

impl ProfileCommands for HiperfaceCommands {
    fn restore(&self, common: &CommonArgs, output: &Output, restore: &Restore, profile: Body) -> Result {
        let profile = profile_to_restore::<HiperfaceProfile>(restore, profile)?;
        let options = RestoreOptions {
            allow_other_device: restore.allow_other_device,
            allow_other_type: restore.allow_other_type,
            with_mounting: restore.with_mounting,
            recreate: restore.recreate,
            copy: parse_decisions(restore)?,
        };
        let mut runner = Runner::open(common)?;
        let change = Change::Restore { profile: Box::new(profile), options };
        let prepared =
            result_of!(runner.run(HiperfaceJob::Prepare(change))?, HiperfaceOutput::Prepared(prepared) => *prepared);
        if let Some(types) = prepared.other_type {
            output.print_message(&explain::other_type(types).terminal_text());
        }
        check_copy_decisions(output, &prepared, restore.dry_run)?;
        if let Some(text) = explain::remaining_fields_text(&prepared.created_left) {
            output.print_message(&text.terminal_text());
        }
        for item in prepared.missing.iter().filter(|item| restore.must_report(&item.to_string())) {
            output.print_message(&format!(
                "{item} is not restored: it is missing in the profile or the encoder, or cannot be read"
            ));
        }
        print_skipped_mounting(output, &prepared.mounting_left);
        let redo = prepared.redo().iter().map(ToString::to_string).collect();
        let missing = prepared.missing.iter().map(ToString::to_string).collect();
        let left = UnrestoredItems { unchanged: prepared.unchanged, missing, redo };
        let plan = plan_report(&prepared);
        write_restore(common, output, restore, prepared, &plan, &left, |prepared| {
            commit_plan(&mut runner, output, prepared, &restore.consent)
        })
    }

    fn read_for_comparison(&self, common: &CommonArgs, output: &Output, _profile: Option<&Body>) -> Result<Body> {
        let saved = read_saved_profile(&mut Runner::open(common)?, SaveOptions::default())?;
        report_locked_fields(output, &saved, "compared without its bytes");
        Ok(Body::new(saved.profile))
    }

    fn read_for_report(&self, common: &CommonArgs, output: &Output) -> Result<DeviceReading> {
        let mut runner = Runner::open(common)?;
        let codes = result_of!(runner.run(HiperfaceJob::Status)?, HiperfaceOutput::Status(codes) => codes);
        let saved = read_saved_profile(&mut runner, SaveOptions::default())?;
        report_locked_fields(output, &saved, "reported without its bytes");
        let status = Some(status_lines(&codes));
        Ok(DeviceReading { body: Body::new(saved.profile), status })
    }

    fn redo_command(&self, kept: &IrreversibleItem) -> Option<String> {
        match (&kept.redo, kept.item.parse()) {
            (Redo::Delete, Ok(Item::Status(field))) => {
                Some(format!("use \"do hiperface delete-field {field}\" if its bytes are not needed"))
            }
            (Redo::Write(old), _) => Some(format!("use \"write hiperface {} 0x{old}\"", kept.item)),
            (Redo::SetPosition, _) => Some("set it again with \"do hiperface set-position\"".to_owned()),
            (Redo::ChangeCode, _) => Some("use \"do hiperface change-code\" with the code before".to_owned()),
            _ => None,
        }
    }

    fn device_mismatch(&self, profile: &Body, device: &Body) -> Option<String> {
        let (profile, device) =
            (&profile.get::<HiperfaceProfile>()?.identity, &device.get::<HiperfaceProfile>()?.identity);
        let same = (&profile.serial_number, profile.encoder_type) == (&device.serial_number, device.encoder_type);
        (!same).then(|| {
            format!(
                "The profile is of {} (type {:02X}h), the encoder is {} (type {:02X}h).",
                profile.serial_number, profile.encoder_type, device.serial_number, device.encoder_type
            )
        })
    }
}

fn read_saved_profile(runner: &mut Runner, options: SaveOptions) -> Result<Box<SavedProfile>> {
    Ok(result_of!(runner.run(HiperfaceJob::Save(options))?, HiperfaceOutput::Saved(saved) => saved))
}

fn report_locked_fields(output: &Output, saved: &SavedProfile, what: &str) {
    for (field, code) in &saved.locked {
        output.print_message(&format!(
            "Data field {field} is {what}: access code {code} is different. Specify it with --code {code}=HEX."
        ));
    }
}

/// Returns the decisions given by `--copy` and `--leave` about data fields with bytes of unknown meaning.
fn parse_decisions(restore: &Restore) -> Result<BTreeMap<u8, bool>> {
    let mut answers = BTreeMap::new();
    for (given, copies) in [(&restore.copy, true), (&restore.leave, false)] {
        for text in given {
            let Item::Field(FieldRange { field, start: 0, count: None }) = super::parse_item(text)? else {
                return Err(Failure::Usage(format!("{text:?} is not a whole data field: use field:N")));
            };
            if answers.insert(field, copies).is_some_and(|before| before != copies) {
                return Err(Failure::Usage(format!("field:{field} cannot be both in --copy and in --leave")));
            }
        }
    }
    Ok(answers)
}

/// Reports the data fields that contain bytes of unknown meaning. Each of them requires a decision on the command line,
/// or an error is returned. A dry run leaves fields without a decision unchanged.
fn check_copy_decisions(output: &Output, prepared: &Prepared, dry_run: bool) -> Result<()> {
    let words = |own: &UnknownMeaningField| explain::unknown_field(own).terminal_text();
    let fields = &prepared.unknown_fields;
    let open: Vec<&UnknownMeaningField> = fields.iter().filter(|own| own.answer.is_none()).collect();
    if !dry_run && !open.is_empty() {
        let open: Vec<String> = open.into_iter().map(words).collect();
        return Err(Failure::Failed(vec![format!(
            "{} Nothing was written. Specify --copy field:N or --leave field:N for each.",
            open.join(" ")
        )]));
    }
    for own in fields {
        let item = own.as_range();
        let becomes = match own.answer {
            Some(true) => "They are copied.".to_owned(),
            Some(false) => "They are not changed.".to_owned(),
            None => format!("They are not changed; a restore needs --copy {item} or --leave {item}."),
        };
        output.print_message(&format!("{} {becomes}", words(own)));
    }
    Ok(())
}

fn plan_report(prepared: &Prepared) -> PlanReport {
    let (operations, write_cycles) = (operations_json(&prepared.plan), prepared.plan.write_cycles());
    PlanReport { operations, text: plan_text(prepared), write_cycles }
}
