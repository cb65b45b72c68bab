//! An open SSI encoder or layout: the layout being designed, a trial frame, the words read, and the search result. The
//! encoder has no memory, so nothing is written to it.

use std::sync::Arc;

use super::design::{Design, Edit, LayoutDesigner};
use super::record::{ReceivedWord, Record, WordStream};
use super::search::SearchState;
use super::trial::{Decoded, TrialFrame};
use crate::app::PendingEdits;
use crate::app::check::CheckResultLine;
use crate::app::session::{Phase, Session, Source};
use crate::devices::ssi::jobs::Ssi;
use crate::devices::ssi::procedures::{ClockSettings, Identity};
use crate::devices::ssi::profile::SsiProfile;
use crate::devices::ssi::protocol::{Families, Layout, ReadConditions, Times, Timing};
use crate::link::LinkUrl;
use crate::sim::Motor;

pub struct Encoder {
    pub session: Session<Ssi>,
    pub designer: LayoutDesigner,
    pub trial: TrialFrame,
    /// Whether the last word read is displayed in place of the trial frame.
    pub(super) follows: bool,
    pub record: Record,
    pub search: SearchState,
    pub(super) searches: u32,
    /// Identity of the adapter and its settings for reading words, once known.
    pub identity: Option<Identity>,
    pub check: Option<Vec<CheckResultLine>>,
    pub motor: Option<Motor>,
    pub(super) clocks: Option<u8>,
    pub(super) requested: Option<ClockSettings>,
}

impl Encoder {
    pub(super) fn from_session(session: Session<Ssi>, designer: LayoutDesigner) -> Self {
        let mut trial = TrialFrame::default();
        // The bits of this position differ from each other.
        trial.set_position(designer.layout(), designer.layout().position_code().last_position() / 3);
        Encoder {
            record: Record::new(designer.layout().clone()),
            session,
            designer,
            trial,
            follows: true,
            search: SearchState::default(),
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

    /// Returns the displayed frame: the last word read if it is available and selected for display, or else the trial
    /// frame.
    pub fn displayed_frame(&self) -> Decoded {
        let live = || self.record.last().and_then(|seen| seen.decoded.clone());
        self.is_showing_live_frame().then(live).flatten().unwrap_or_else(|| self.trial.decode(self.designer.layout()))
    }

    /// Returns whether the last word read is displayed.
    pub fn is_showing_live_frame(&self) -> bool {
        self.follows && self.record.last().is_some_and(|seen| seen.decoded.is_some())
    }

    pub fn last(&self) -> Option<&ReceivedWord> {
        self.record.last()
    }

    /// Returns the stream of words from the adapter, or `None` if there is none.
    pub fn current_stream(&self) -> Option<&WordStream> {
        self.record.current_stream().filter(|_| self.session.is_polling())
    }

    /// Returns the number of clocks per word, which is that of the layout unless another one is being tried.
    pub fn clock_count(&self) -> u8 {
        self.clocks.unwrap_or_else(|| self.designer.layout().clock_count())
    }

    /// Returns whether a number of clocks is being tried that differs from that of the layout.
    pub fn has_trial_clocks(&self) -> bool {
        self.clocks.is_some_and(|clocks| clocks != self.designer.layout().clock_count())
    }

    pub(crate) fn query_settings(&self) -> ClockSettings {
        let reading = &self.design().profile.reading;
        ClockSettings { clocks: self.clock_count(), clock_hz: reading.clock_hz, pause_us: reading.pause_us }
    }

    pub fn is_dirty(&self) -> bool {
        self.designer.is_dirty()
    }

    pub(crate) fn edited_profile(&self) -> SsiProfile {
        self.design().profile.clone()
    }

    pub(crate) fn update_families(&mut self, families: Arc<Families>) {
        self.designer.update_families(families);
    }

    pub(super) fn apply_edit(&mut self, edit: Edit) {
        let before = self.designer.layout().clone();
        if self.designer.apply_edit(edit) {
            self.handle_layout_change(&before);
        }
    }

    pub(super) fn handle_layout_change(&mut self, before: &Layout) {
        if self.identity.is_some() {
            self.set_title_from_family();
        }
        let now = self.designer.layout();
        if before == now {
            return;
        }
        self.trial.switch_layout(before, now);
        self.record.reinterpret(now);
    }

    pub(super) fn set_title_from_family(&mut self) {
        let family = self.designer.family().map(|family| family.name.clone());
        self.session.title = family.or_else(|| Some("SSI".to_owned())).filter(|_| self.session.phase != Phase::Offline);
    }

    /// Returns the link to a virtual encoder that sends this layout. Returns `None` if the current virtual encoder
    /// already does, or if the layout has no family, because a link can only specify a family.
    pub fn link_for_layout(&self) -> Option<LinkUrl> {
        let Source::Link(url) = &self.session.source else { return None };
        let (family, settings) = (self.designer.family()?, self.design().settings.as_ref()?);
        let differs = self.session.is_virtual()
            && self.designer.virtual_encoder_descriptor(url) != self.design().profile.descriptor;
        differs.then(|| {
            let mut url = url.clone();
            url.query.set("ssi", &settings.emit(&family.key));
            url
        })
    }

    /// Returns whether the layout belongs to a profile rather than to a link.
    pub fn is_profile(&self) -> bool {
        !matches!(self.session.source, Source::Link(_))
    }
}

impl LayoutDesigner {
    /// Returns the timing limits of the family, or those of SSI in general if there is no family.
    pub fn applicable_times(&self) -> Times {
        self.times().copied().unwrap_or(Times::GENERAL_LIMITS)
    }

    pub fn timing(&self) -> Timing {
        let reads = self.read_conditions();
        self.times().map_or_else(|| Times::for_any_encoder(&reads), |times| times.calculate_timing(&reads))
    }

    pub fn read_conditions(&self) -> ReadConditions {
        self.design().profile.read_conditions()
    }

    /// Returns the user-defined name of the layout, or the name of the family if there is none.
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
