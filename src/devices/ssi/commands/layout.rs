//! The layout given by `--layout`: a profile file, a family with its settings, a frame in one-word notation, or a
//! LinuxCNC format string.

use std::path::Path;

use super::args::SsiLayoutArgs;
use crate::app::{KindRegistry, explain};
use crate::cli::output::Output;
use crate::cli::profiles::load;
use crate::cli::runner::to_failure;
use crate::cli::{Failure, Result};
use crate::devices::ssi::jobs::families as read_families;
use crate::devices::ssi::profile::SsiProfile;
use crate::devices::ssi::protocol::{
    Families, Family, FrameDescriptor, Layout, ResolvedFrame, Settings, SpecError, Times, from_linuxcnc,
};
use crate::devices::ssi::state::explain as words;
use crate::store::Store;

pub(crate) struct SelectedLayout {
    pub(crate) profile: SsiProfile,
    pub(crate) layout: Layout,
    /// Timing limits of the layout's family, or `None` if the family is unknown.
    pub(crate) times: Option<Times>,
    pub(crate) title: String,
}

/// Returns the layout given by `--layout`. Prints a remark for each setting that the manual does not mention.
pub(crate) fn select_layout(output: &Output, SsiLayoutArgs { spec }: &SsiLayoutArgs) -> Result<SelectedLayout> {
    if let Some(format) = spec.strip_prefix("linuxcnc:") {
        let layout = from_linuxcnc(format).map_err(|error| Failure::Usage(format!("--layout: {error}")))?;
        let profile = SsiProfile::new(layout.descriptor().clone());
        return Ok(SelectedLayout { profile, layout, times: None, title: spec.clone() });
    }
    if let Some(frame) = FrameDescriptor::parse(spec) {
        return choose_frame_layout(spec, frame);
    }
    let families = families(output)?;
    if is_file(spec, &families) {
        from_file(output, spec, &families)
    } else {
        select_family_layout(output, spec, &families)
    }
}

/// Returns the encoder families. User-defined families replace built-in ones with the same key, and errors in their
/// files are printed.
pub(super) fn families(output: &Output) -> Result<Families> {
    let store = Store::for_user().map_err(|error| to_failure(&explain::store_error_text(&error)))?;
    let (families, broken) = read_families(&store);
    for error in broken {
        output.print_message(&words::family_error_text(&error).terminal_text());
    }
    Ok(families)
}

/// Returns whether the specification names a file: it has a path or an extension, or the file exists and no family has
/// this name. Text after the first comma is ignored, because settings may contain `/` in fractions.
fn is_file(spec: &str, families: &Families) -> bool {
    let key = spec.split(',').next().unwrap_or(spec);
    let is_path = key.contains('/') || key.contains(std::path::MAIN_SEPARATOR);
    let ends = Path::new(spec).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("ron"));
    is_path || ends || (families.find_by_key(&key.to_ascii_lowercase()).is_none() && Path::new(spec).is_file())
}

fn choose_frame_layout(spec: &str, frame: std::result::Result<FrameDescriptor, SpecError>) -> Result<SelectedLayout> {
    let frame = frame.map_err(|error| Failure::Usage(format!("--layout: {error}")))?;
    let layout = Layout::new(frame).map_err(|error| Failure::Failed(vec![format!("{spec}: {error}.")]))?;
    let profile = SsiProfile::new(layout.descriptor().clone());
    Ok(SelectedLayout { profile, layout, times: None, title: spec.to_owned() })
}

fn from_file(output: &Output, spec: &str, families: &Families) -> Result<SelectedLayout> {
    let path = Path::new(spec);
    let failure = |error| to_failure(&explain::profile_file_error_text(path, &error, KindRegistry::NONE));
    let profile = load(output, path)?.into_profile::<SsiProfile>().map_err(failure)?;
    let frame = profile.descriptor.clone();
    let layout = Layout::new(frame).map_err(|error| Failure::Failed(vec![format!("{spec}: {error}.")]))?;
    let family = profile.family.as_deref().and_then(|key| families.find_by_key(key));
    match (profile.family.as_deref(), family) {
        (Some(key), None) => {
            output.print_message(&format!("{spec} names the unknown family {key:?}, so its times are not known."));
        }
        (_, Some(family)) => print_frame_remarks(output, family, &profile),
        (None, None) => {}
    }
    let times = family.map(|family| family.times);
    // The title does not contain the folder, because exports may be passed on to other people.
    let file = path.file_name().map_or_else(|| spec.to_owned(), |name| name.to_string_lossy().into_owned());
    let title = if profile.name.is_empty() { file } else { profile.name.clone() };
    Ok(SelectedLayout { title, profile, layout, times })
}

/// Prints remarks on the profile's frame, or a message if no settings of its family result in this frame.
fn print_frame_remarks(output: &Output, family: &Family, profile: &SsiProfile) {
    let settings = family.settings_for_frame(&profile.descriptor);
    match settings.and_then(|settings| settings.resolve(family).ok()) {
        Some(resolved) => print_advice(output, &resolved),
        None => output.print_message(&format!(
            "No settings of {} result in this frame; only the times of the family are used.",
            family.name
        )),
    }
}

fn print_advice(output: &Output, resolved: &ResolvedFrame) {
    for advice in &resolved.advice {
        output.print_message(&words::advice_text(advice).terminal_text());
    }
}

fn select_family_layout(output: &Output, spec: &str, families: &Families) -> Result<SelectedLayout> {
    let (key, settings) = Settings::parse(spec).map_err(|error| Failure::Usage(format!("--layout: {error}")))?;
    let Some(family) = families.find_by_key(&key) else {
        let known: Vec<&str> = families.iter().map(|family| family.key.as_str()).collect();
        let known = known.join(" ");
        return Err(Failure::Usage(format!("--layout: {key:?} is neither a file nor a family; families: {known}")));
    };
    let resolved = settings.resolve(family).map_err(|error| Failure::Failed(vec![format!("{error}.")]))?;
    print_advice(output, &resolved);
    let profile = SsiProfile::from_family(family, &resolved);
    Ok(SelectedLayout { profile, layout: resolved.layout, times: Some(family.times), title: spec.to_owned() })
}
