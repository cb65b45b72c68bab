//! An open SSI encoder or a layout of one: the layout being designed, a trial frame, the words read, and the result of
//! a search. The encoder has no memory; nothing is ever written to it.

use std::sync::Arc;

use super::design::{Design, Designer, Edit};
use super::record::{ReadWord, Record, Streamed};
use super::search::SearchState;
use super::trial::{Decoded, Trial};
use crate::app::check::CheckLine;
use crate::app::session::{Phase, Session, Source};
use crate::app::{PendingEdits, Text};
use crate::devices::ssi::jobs::Ssi;
use crate::devices::ssi::procedures::{Asking, Identity};
use crate::devices::ssi::profile::SsiProfile;
use crate::devices::ssi::protocol::{Families, Layout, Reads, Times, Timing};
use crate::link::LinkUrl;
use crate::sim::Motor;

/// An SSI encoder, or a layout of one.
pub struct Encoder {
    pub session: Session<Ssi>,
    pub designer: Designer,
    pub trial: Trial,
    /// Set if the trial frame follows the word read last.
    pub(super) follows: bool,
    pub record: Record,
    pub hunt: SearchState,
    pub(super) searches: u32,
    /// The adapter and its settings for reading words, once known.
    pub identity: Option<Identity>,
    /// The last device check.
    pub check: Option<Vec<CheckLine>>,
    pub motor: Option<Motor>,
    pub(super) clocks: Option<u8>,
    /// The settings last sent to the adapter for reading words.
    pub(super) requested: Option<Asking>,
}

impl Encoder {
    pub(super) fn with(session: Session<Ssi>, designer: Designer) -> Self {
        let mut trial = Trial::default();
        // A position whose bits can be distinguished.
        trial.set_position(designer.layout(), designer.layout().coding().last() / 3);
        Encoder {
            record: Record::new(designer.layout().clone()),
            session,
            designer,
            trial,
            follows: true,
            hunt: SearchState::default(),
            searches: 0,
            identity: None,
            check: None,
            motor: None,
            clocks: None,
            requested: None,
        }
    }

    pub fn design(&self) -> &Design {
        self.designer.design()
    }

    /// Returns the displayed frame: the word read last if this is selected and there is one, else the trial frame.
    pub fn displayed_frame(&self) -> Decoded {
        let live = || self.record.last().and_then(|seen| seen.decoded.clone());
        self.is_following().then(live).flatten().unwrap_or_else(|| self.trial.decoded(self.designer.layout()))
    }

    /// Returns whether the word that was read last is shown.
    pub fn is_following(&self) -> bool {
        self.follows && self.record.last().is_some_and(|seen| seen.decoded.is_some())
    }

    /// Returns the word read last; `None` if there is none.
    pub fn last(&self) -> Option<&ReadWord> {
        self.record.last()
    }

    /// Returns what an adapter streams now; `None` if it does not.
    pub fn streamed(&self) -> Option<&Streamed> {
        self.record.streamed().filter(|_| self.session.is_polling())
    }

    /// Returns the clocks of the words being read: those of the layout, unless others are tried.
    pub fn clocks(&self) -> u8 {
        self.clocks.unwrap_or_else(|| self.designer.layout().clocks())
    }

    /// Returns whether other clocks than those of the layout are tried.
    pub fn has_own_clocks(&self) -> bool {
        self.clocks.is_some_and(|clocks| clocks != self.designer.layout().clocks())
    }

    pub(crate) fn asking(&self) -> Asking {
        let reading = &self.design().profile.reading;
        Asking { clocks: self.clocks(), clock_hz: reading.clock_hz, pause_us: reading.pause_us }
    }

    /// Returns whether the layout is not as it was saved.
    pub fn is_dirty(&self) -> bool {
        self.designer.is_dirty()
    }

    /// Returns the layout as it would be saved.
    pub(crate) fn wanted_profile(&self) -> SsiProfile {
        self.design().profile.clone()
    }

    pub(crate) fn take_families(&mut self, families: Arc<Families>) {
        self.designer.take_families(families);
    }

    /// Changes the layout and everything that depends on it.
    pub(super) fn edit(&mut self, edit: Edit) {
        let before = self.designer.layout().clone();
        if self.designer.edit(edit) {
            self.follow_layout(&before);
        }
    }

    pub(super) fn follow_layout(&mut self, before: &Layout) {
        if self.identity.is_some() {
            self.name_after_family();
        }
        let now = self.designer.layout();
        if before == now {
            return;
        }
        self.trial.follow(before, now);
        self.record.read_as(now);
    }

    /// Names the device of the link after its family.
    pub(super) fn name_after_family(&mut self) {
        let family = self.designer.family().map(|family| family.name.clone());
        self.session.title = family.or_else(|| Some("SSI".to_owned())).filter(|_| self.session.phase != Phase::Offline);
    }

    /// Returns the link to a virtual encoder that sends this layout, if it is connected to one that sends another; a link
    /// can only describe frames of a family.
    pub fn link_to_send(&self) -> Option<LinkUrl> {
        let Source::Link(url) = &self.session.source else { return None };
        let (family, settings) = (self.designer.family()?, self.design().settings.as_ref()?);
        let differs = self.session.is_virtual() && self.designer.sent_by(url) != self.design().profile.descriptor;
        differs.then(|| {
            let mut url = url.clone();
            url.query.set("ssi", &settings.emit(&family.key));
            url
        })
    }

    /// Returns whether it is a profile in a file, or will be.
    pub fn is_profile(&self) -> bool {
        !matches!(self.session.source, Source::Link(_))
    }

    /// Returns why the adapter cannot read the present layout.
    pub fn refusal(&self) -> Option<&Text> {
        self.designer.problem()
    }
}

impl Designer {
    /// Returns the times that apply: those of the family, else what the manual says of SSI as such.
    pub fn applicable_times(&self) -> Times {
        self.times().copied().unwrap_or(Times::GENERAL)
    }

    /// Returns the times of reading the layout as it is set.
    pub fn timing(&self) -> Timing {
        let reads = self.reads();
        self.times().map_or_else(|| Times::of_any_encoder(&reads), |times| times.reckon(&reads))
    }

    /// Returns how frames are read, for checking the times.
    pub fn reads(&self) -> Reads {
        self.design().profile.reads()
    }

    /// Returns the user's name for it, or that of its family.
    pub fn title(&self) -> String {
        let profile = &self.design().profile;
        if !profile.name.is_empty() {
            return profile.name.clone();
        }
        match (self.family(), &self.design().settings) {
            (Some(family), Some(settings)) => settings.emit(&family.key),
            (Some(family), None) => family.name.clone(),
            (None, _) => "SSI".to_owned(),
        }
    }
}
