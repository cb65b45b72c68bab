//! Commands about profiles: `save`, `diff`, `verify`, `restore`.

use std::path::Path;

use jiff::Timestamp;
use serde_json::{Value as Json, json};

use super::write::{commit, operations, plan_text, require_consent};
use crate::app::explain;
use crate::cli::args::{Common, Diff, Restore, Save};
use crate::cli::output::{Lines, Output, count};
use crate::cli::runner::{Runner, failed, unexpected};
use crate::cli::{Done, Failure, Result};
use crate::device::hiperface::SaveOptions;
use crate::profile::hiperface::{HiperfaceProfile, RestoreOptions, compare};
use crate::profile::{Body, Comparison, Document};
use crate::store::{read_text, write_atomically};
use crate::worker::hiperface::{Change, HiperfaceJob, HiperfaceOutput, SavedProfile};

pub(super) fn save(common: &Common, output: &Output, save: &Save) -> Result {
    let mut runner = Runner::open(common)?;
    let saved = saved(&mut runner, SaveOptions { complete: save.complete })?;
    name_locked(output, &saved, "saved without its bytes");
    let fields = saved.profile.fields.len();
    let locked: Vec<u8> = saved.locked.iter().map(|(field, _)| *field).collect();
    let document = Document::new(now(), Body::Hiperface(saved.profile));
    write_atomically(&save.file, document.emit().as_bytes()).map_err(|error| failed(&explain::file(&error)))?;
    let json = json!({"file": save.file, "fields": fields, "locked": locked});
    output.show(&json, &format!("{}: {}\n", save.file.display(), count(fields, "data field")))?;
    Ok(Done::Well)
}

fn now() -> String {
    let now = Timestamp::now();
    Timestamp::from_second(now.as_second()).unwrap_or(now).to_string()
}

fn saved(runner: &mut Runner, options: SaveOptions) -> Result<Box<SavedProfile>> {
    match runner.run(HiperfaceJob::Save(options))? {
        HiperfaceOutput::Saved(saved) => Ok(saved),
        other => Err(unexpected(&other)),
    }
}

fn name_locked(output: &Output, saved: &SavedProfile, what: &str) {
    for (field, code) in &saved.locked {
        output.remark(&format!(
            "Data field {field} is {what}: access code {code} is another; give it with --code {code}=HEX."
        ));
    }
}

/// The encoder as it is, for a comparison.
fn device(common: &Common, output: &Output) -> Result<HiperfaceProfile> {
    let saved = saved(&mut Runner::open(common)?, SaveOptions::default())?;
    name_locked(output, &saved, "compared without its bytes");
    Ok(saved.profile)
}

fn load(path: &Path) -> Result<HiperfaceProfile> {
    let text = read_text(path).map_err(|error| failed(&explain::file(&error)))?;
    let profile = Document::parse(&text).and_then(|document| document.body.into_hiperface());
    profile.map_err(|error| failed(&explain::profile(path, &error)))
}

pub(in crate::cli) fn diff(common: &Common, output: &Output, diff: &Diff) -> Result {
    if diff.right.is_some() == common.link.is_some() {
        return Err(Failure::Usage("diff takes a second file or --link URL, one of them".to_owned()));
    }
    let left = load(&diff.left)?;
    let right = match &diff.right {
        Some(path) => load(path)?,
        None => device(common, output)?,
    };
    let comparison = compare(&left.fields, &right.fields);
    let missing = comparison.missing();
    show_comparison(output, &comparison, comparison.differences.is_empty() && missing.is_empty())
}

pub(in crate::cli) fn verify(common: &Common, output: &Output, file: &Path) -> Result {
    let profile = load(file)?;
    let device = device(common, output)?;
    name_other_device(output, &profile, &device);
    let comparison = compare(&profile.fields, &device.fields);
    // What only the device has is not the profile's business.
    let equal = comparison.differences.is_empty() && comparison.only_left.is_empty();
    show_comparison(output, &comparison, equal)
}

/// What is compared may be of two encoders: that is allowed, and has to be known.
fn name_other_device(output: &Output, profile: &HiperfaceProfile, device: &HiperfaceProfile) {
    let (profile, device) = (&profile.identity, &device.identity);
    if (&profile.serial_number, profile.encoder_type) != (&device.serial_number, device.encoder_type) {
        output.remark(&format!(
            "The profile is of {} (type {:02X}h), the encoder is {} (type {:02X}h).",
            profile.serial_number, profile.encoder_type, device.serial_number, device.encoder_type
        ));
    }
}

fn show_comparison(output: &Output, comparison: &Comparison, equal: bool) -> Result {
    let differences: Vec<Json> = comparison
        .differences
        .iter()
        .map(|difference| json!({"item": difference.item, "left": difference.left, "right": difference.right}))
        .collect();
    let missing = comparison.missing();
    let json = json!({
        "equal": equal,
        "differences": differences,
        "compared": comparison.compared,
        "missing": missing,
    });
    let mut lines = Lines::default();
    for difference in &comparison.differences {
        lines.add(&difference.item, format!("{}  →  {}", difference.left, difference.right));
    }
    for item in &comparison.only_left {
        lines.add(item, "only on the left");
    }
    for item in &comparison.only_right {
        lines.add(item, "only on the right");
    }
    let compared = comparison.compared;
    let verdict =
        if equal { format!("equal ({compared} compared)\n") } else { format!("different ({compared} compared)\n") };
    output.show(&json, &(lines.text() + &verdict))?;
    Ok(if equal { Done::Well } else { Done::Differs })
}

pub(in crate::cli) fn restore(common: &Common, output: &Output, restore: &Restore) -> Result {
    let profile = Box::new(load(&restore.file)?);
    if !restore.dry_run {
        require_consent(&restore.consent)?;
    }
    let options = RestoreOptions {
        allow_other_device: restore.allow_other_device,
        with_mounting: restore.with_mounting,
        recreate: restore.recreate,
    };
    let mut runner = Runner::open(common)?;
    let prepared = match runner.run(HiperfaceJob::Prepare(Change::Restore { profile, options }))? {
        HiperfaceOutput::Prepared(prepared) => *prepared,
        other => return Err(unexpected(&other)),
    };
    for item in &prepared.missing {
        output.remark(&format!("{item} is left alone: profile or encoder does not have it, or it cannot be read"));
    }
    for range in &prepared.mounting_left {
        output.remark(&format!(
            "{range} belongs to the mounting of another encoder and is left alone; --with-mounting restores it"
        ));
    }
    let (unchanged, missing) = (prepared.unchanged, prepared.missing.clone());
    if restore.dry_run {
        let json = json!({
            "dry_run": true,
            "operations": operations(&prepared.plan),
            "written": 0,
            "unchanged": unchanged,
            "verified": 0,
            "write_cycles": prepared.plan.write_cycles(),
            "backup": null,
            "missing": missing,
        });
        output.show(&json, &plan_text(&prepared))?;
        return Ok(Done::Well);
    }
    let committed = commit(&mut runner, output, prepared, &restore.consent)?;
    let written = &committed.written;
    let json = json!({
        "written": written.written,
        "unchanged": unchanged,
        "verified": written.verified,
        "write_cycles": written.write_cycles,
        "backup": committed.backup,
        "missing": missing,
    });
    let mut lines = Lines::default();
    lines
        .add("written", written.written)
        .add("unchanged", unchanged)
        .add("verified", written.verified)
        .add("write cycles", written.write_cycles);
    if let Some(backup) = &committed.backup {
        lines.add("backup", backup.display());
    }
    output.show_written(&json, &lines.text())?;
    Ok(Done::Well)
}
