//! Design of a layout. Every change can be undone. An invalid change is rejected with a message, so that the frame is
//! always valid.

mod reshape;

use std::sync::Arc;

use super::strip;
use crate::app::history::History;
use crate::app::{PendingEdits, Text};
use crate::devices::ssi::profile::{ReadingSettings, SsiProfile};
use crate::devices::ssi::protocol::{
    Code, Direction, ErrorPlace, Families, Family, FrameDescriptor, Layout, Range, SettingAdvice, Settings, Times,
    from_linuxcnc,
};
use crate::devices::ssi::sim::DEFAULT_ENCODER;
use crate::devices::ssi::state::TEXTS;
use crate::devices::ssi::state::explain;
use crate::link::{LinkScheme, LinkUrl};

const DEFAULT_FAMILY: &str = "ahm36";

#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    pub profile: SsiProfile,
    pub layout: Layout,
    /// Settings with which the family sends exactly this frame, or `None` if the layout has no family or its family
    /// cannot send the frame.
    pub settings: Option<Settings>,
    /// Remarks about accepted settings that the manual of the family does not mention.
    pub advice: Vec<SettingAdvice>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// Switches to the factory layout of the family with this key.
    Family(String),
    /// Detaches the frame from its family, so that every part of it can be edited.
    Free,
    /// Changes the settings of the family.
    Settings(Box<Settings>),
    Frame(Box<FrameDescriptor>),
    /// Changes the range of positions or the code. The frame becomes longer or shorter as required.
    Position(Range, Code),
    Direction(Direction),
    /// Sets the position at the zero point of the shaft.
    Preset(u64),
    Reading(ReadingSettings),
    Name(String),
    Whole(Box<SsiProfile>),
    LinuxCnc(String),
}

#[derive(Clone, Debug)]
pub struct LayoutDesigner {
    families: Arc<Families>,
    now: Design,
    saved: SsiProfile,
    history: History<SsiProfile>,
    problem: Option<Text>,
}

impl Design {
    /// Creates the design of a layout with its family. If several combinations of settings yield the frame, `requested`
    /// is preferred, or else the smallest one.
    ///
    /// # Errors
    /// Returns an error with the reason if the layout is invalid.
    fn from_profile(profile: SsiProfile, families: &Families, requested: Option<&Settings>) -> Result<Self, Text> {
        let layout = Layout::new(profile.descriptor.clone()).map_err(|error| explain::layout_error_text(&error))?;
        let family = profile.family.as_deref().and_then(|key| families.find_by_key(key));
        let sends = |family: &Family, settings: &Settings| {
            settings.resolve(family).is_ok_and(|resolved| *resolved.layout.descriptor() == profile.descriptor)
        };
        let settings = family.and_then(|family| {
            let requested = requested.filter(|requested| sends(family, requested));
            requested.cloned().or_else(|| family.settings_for_frame(&profile.descriptor))
        });
        let resolved = family.zip(settings.as_ref()).and_then(|(family, settings)| settings.resolve(family).ok());
        let advice = resolved.map(|resolved| resolved.advice).unwrap_or_default();
        Ok(Design { profile, layout, settings, advice })
    }
}

impl Default for Design {
    fn default() -> Self {
        let layout = Layout::default();
        let profile = SsiProfile::new(layout.descriptor().clone());
        Design { profile, layout, settings: None, advice: Vec::new() }
    }
}

impl LayoutDesigner {
    /// Creates a designer for a saved layout. An invalid layout, which no file can contain, is replaced by the default.
    fn from_profile(profile: SsiProfile, families: Arc<Families>) -> Self {
        let now = Design::from_profile(profile, &families, None).unwrap_or_default();
        let saved = now.profile.clone();
        LayoutDesigner { families, now, saved, history: History::default(), problem: None }
    }

    /// Creates a designer for the factory layout of the default family.
    pub(super) fn factory_default(families: Arc<Families>) -> Self {
        let profile = parse_profile(DEFAULT_FAMILY, &families);
        LayoutDesigner::from_profile(profile, families)
    }

    /// Creates a designer for a link. The layout is known only if the link refers to a virtual encoder.
    pub(super) fn for_link(url: &LinkUrl, families: Arc<Families>) -> Self {
        let sent = url.query.get("ssi").filter(|_| url.scheme == LinkScheme::Sim);
        let mut profile = parse_profile(sent.unwrap_or(DEFAULT_ENCODER), &families);
        profile.reading = reading_for_link(profile.reading, url, |_| true);
        LayoutDesigner::from_profile(profile, families)
    }

    /// Returns the reading settings after a change of the link. Parameters that have changed are taken from the new
    /// link, and all other settings are kept.
    pub(super) fn reading_after_link_change(&self, before: &LinkUrl, now: &LinkUrl) -> ReadingSettings {
        reading_for_link(self.now.profile.reading, now, |name| before.query.get(name) != now.query.get(name))
    }

    /// Returns the frame sent by the virtual encoder at a link.
    pub(super) fn virtual_encoder_descriptor(&self, url: &LinkUrl) -> FrameDescriptor {
        parse_profile(url.query.get("ssi").unwrap_or(DEFAULT_ENCODER), &self.families).descriptor
    }

    pub(super) fn open(&mut self, profile: SsiProfile) {
        *self = LayoutDesigner::from_profile(profile, self.families.clone());
    }

    pub fn design(&self) -> &Design {
        &self.now
    }

    pub fn layout(&self) -> &Layout {
        &self.now.layout
    }

    pub fn families(&self) -> &Families {
        &self.families
    }

    pub fn family(&self) -> Option<&Family> {
        self.families.find_by_key(self.now.profile.family.as_deref()?)
    }

    pub fn times(&self) -> Option<&Times> {
        self.family().map(|family| &family.times)
    }

    /// Returns whether error and parity bits move with the end of the position. The family settings determine this if
    /// there are any; otherwise, it depends on the frame.
    pub fn error_bits_follow_position(&self) -> bool {
        let settings = self.family().zip(self.now.settings.as_ref());
        match settings.and_then(|(family, settings)| settings.resolve(family).ok()) {
            Some(resolved) => resolved.errors == ErrorPlace::Following,
            None => strip::bits_follow_position(&self.now.layout),
        }
    }

    pub fn problem(&self) -> Option<&Text> {
        self.problem.as_ref()
    }

    pub(super) fn saved(&self) -> &SsiProfile {
        &self.saved
    }

    pub(super) fn update_families(&mut self, families: Arc<Families>) {
        self.families = families;
        if let Ok(design) = Design::from_profile(self.now.profile.clone(), &self.families, self.now.settings.as_ref()) {
            self.now = design;
        }
    }

    /// Changes the layout as one undo step. Returns `false` if nothing changed.
    pub(super) fn apply_edit(&mut self, edit: Edit) -> bool {
        let requested = match &edit {
            Edit::Settings(settings) => Some((**settings).clone()),
            _ => self.now.settings.clone(),
        };
        match self
            .preview_edit(edit)
            .and_then(|profile| Design::from_profile(profile, &self.families, requested.as_ref()))
        {
            Ok(design) => {
                self.problem = None;
                if design.profile == self.now.profile {
                    // Different settings can result in the same frame.
                    self.now = design;
                    return false;
                }
                let before = std::mem::replace(&mut self.now, design);
                self.history.record_step(before.profile);
                true
            }
            Err(why) => {
                self.problem = Some(why);
                false
            }
        }
    }

    pub(super) fn show_rejection(&mut self, why: Text) {
        self.problem = Some(why);
    }

    fn preview_edit(&self, edit: Edit) -> Result<SsiProfile, Text> {
        let mut profile = self.now.profile.clone();
        match edit {
            Edit::Family(key) => {
                let Some(family) = self.families.find_by_key(&key) else {
                    return Err(TEXTS.text("ssi.no_family").with("key", key));
                };
                // The old preset has no meaning in the new layout.
                profile.preset = 0;
                return resolved_profile(profile, family, Settings::default());
            }
            Edit::Free => profile.family = None,
            Edit::Settings(settings) => {
                let Some(family) = self.family() else { return Err(TEXTS.text("ssi.no_family").with("key", "–")) };
                return resolved_profile(profile, family, *settings);
            }
            Edit::Frame(descriptor) => profile.descriptor = *descriptor,
            Edit::Position(range, code) => {
                profile.descriptor = reshape::with_positions(&profile.descriptor, range, code)
                    .map_err(|error| explain::layout_error_text(&error))?;
            }
            Edit::Direction(direction) => profile.direction = direction,
            Edit::Preset(preset) => profile.preset = preset,
            Edit::Reading(reading) => profile.reading = reading,
            Edit::Name(name) => profile.name = name,
            Edit::Whole(whole) => return Ok(*whole),
            Edit::LinuxCnc(format) => {
                let layout = from_linuxcnc(&format).map_err(|error| explain::format_error_text(&error))?;
                profile.family = None;
                profile.descriptor = layout.descriptor().clone();
            }
        }
        // A preset beyond the new range is invalid.
        let last = profile.descriptor.range.last_position().unwrap_or(0);
        if profile.preset > last {
            return Err(TEXTS.text("ssi.preset_range").with("preset", profile.preset).with("most", last));
        }
        Ok(profile)
    }

    fn step_by(&mut self, step: fn(&mut History<SsiProfile>, &mut SsiProfile) -> bool) -> bool {
        let mut profile = self.now.profile.clone();
        if !step(&mut self.history, &mut profile) {
            return false;
        }
        self.problem = None;
        // The layout was valid when the step was made.
        let Ok(design) = Design::from_profile(profile, &self.families, self.now.settings.as_ref()) else {
            return false;
        };
        self.now = design;
        true
    }

    /// Marks the profile as saved. Undo steps are kept.
    pub(super) fn mark_saved(&mut self, profile: SsiProfile) {
        self.saved = profile;
    }
}

impl PendingEdits for LayoutDesigner {
    fn count(&self) -> usize {
        usize::from(self.is_dirty())
    }

    fn is_dirty(&self) -> bool {
        self.now.profile != self.saved
    }

    fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    fn undo(&mut self) -> bool {
        self.step_by(History::undo)
    }

    fn redo(&mut self) -> bool {
        self.step_by(History::redo)
    }

    fn discard_all(&mut self) -> bool {
        self.apply_edit(Edit::Whole(Box::new(self.saved.clone())))
    }

    fn clear_undo_steps(&mut self) {
        self.history.clear_steps();
    }
}

/// Returns the reading settings, overridden by those link parameters for which `counts` returns `true`.
fn reading_for_link(reading: ReadingSettings, url: &LinkUrl, counts: impl Fn(&str) -> bool) -> ReadingSettings {
    let number = |name: &str| url.query.get(name).filter(|_| counts(name)).and_then(|text| text.parse::<u32>().ok());
    let pause_us = number("pause").and_then(|pause| u16::try_from(pause).ok());
    ReadingSettings {
        clock_hz: number("clock").unwrap_or(reading.clock_hz),
        pause_us: pause_us.unwrap_or(reading.pause_us),
        ..reading
    }
}

/// Parses a family with its settings. An invalid text results in a minimal layout.
fn parse_profile(text: &str, families: &Families) -> SsiProfile {
    let resolved = Settings::parse(text).ok().and_then(|(key, settings)| {
        let family = families.find_by_key(&key)?;
        Some(SsiProfile::from_family(family, &settings.resolve(family).ok()?))
    });
    resolved.unwrap_or_else(|| Design::default().profile)
}

/// Returns the profile with the frame that a family sends with these settings. Direction and preset are kept.
fn resolved_profile(mut profile: SsiProfile, family: &Family, settings: Settings) -> Result<SsiProfile, Text> {
    let settings = Settings { direction: Some(profile.direction), preset: Some(profile.preset), ..settings };
    let resolved = settings.resolve(family).map_err(|error| explain::settings_error_text(&error))?;
    profile.descriptor = resolved.layout.descriptor().clone();
    profile.family = Some(family.key.clone());
    Ok(profile)
}
