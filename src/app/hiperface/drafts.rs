//! Edits outlive a crash: they are kept beside the studio's other data as they are made, one file for each encoder or
//! profile, and come back with it.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

use super::Done;
use super::encoder::{Encoder, Source};
use crate::app::services::Services;
use crate::app::studio::SessionId;
use crate::app::{Severity, Text, explain};
use crate::protocol::hiperface::KIND;
use crate::store::FileError;

type Edits = Vec<(u8, usize, u8)>;

/// How it stands with the draft on disk.
#[derive(Debug, Default)]
pub(super) struct Drafting {
    /// What was last handed over to be kept.
    kept: Edits,
    /// A task is at it.
    busy: bool,
    /// The draft of an earlier time has been looked for: before that, nothing is kept over it.
    looked: bool,
    /// That it cannot be kept has been said.
    told: bool,
}

impl Encoder {
    /// Kind and key of its draft; `None` for an encoder that does not say who it is.
    fn draft_key(&self) -> Option<(&'static str, String)> {
        match &self.source {
            Source::File { path, .. } => {
                let mut hasher = DefaultHasher::new();
                path.hash(&mut hasher);
                Some(("files", format!("{:016x}", hasher.finish())))
            }
            Source::Link(_) => {
                let serial = &self.identity.as_ref()?.serial.serial_number;
                let kind = if self.is_virtual() { "virtual" } else { KIND };
                (!serial.is_empty()).then(|| (kind, serial.clone()))
            }
        }
    }

    pub(super) fn load_draft(&mut self, services: &Services) {
        let Some((kind, key)) = self.draft_key() else { return };
        let (drafts, id) = (services.world.store.drafts(), self.id);
        self.drafting.busy = true;
        services.tasks.run("draft", move || {
            let result = drafts.load(kind, &key);
            done(id, Done::Draft { key, result })
        });
    }

    /// What a task says of another encoder's or profile's draft is old by now.
    fn is_own(&self, key: &str) -> bool {
        self.draft_key().is_some_and(|(_, own)| own == key)
    }

    pub(super) fn take_draft(&mut self, key: &str, result: Result<Option<String>, FileError>, services: &mut Services) {
        if !self.is_own(key) {
            return;
        }
        self.drafting.busy = false;
        self.drafting.looked = true;
        let text = match result {
            Ok(None) => return,
            Ok(Some(text)) => text,
            Err(error) => {
                services.tell(Severity::Warning, vec![explain::file(&error)], Some(&self.name()));
                return;
            }
        };
        // Edits that were made meanwhile are newer.
        if self.staged.is_dirty() {
            return;
        }
        match ron::from_str::<Edits>(&text) {
            Ok(edits) => {
                self.staged.take_draft(edits);
                self.drafting.kept = self.staged.edits().collect();
                if self.staged.is_dirty() {
                    let text = Text::new("session.draft_back");
                    services.tell(Severity::Warning, vec![text], Some(&self.name()));
                }
            }
            Err(error) => {
                let text = Text::new("session.draft_broken").with("why", error);
                services.tell(Severity::Warning, vec![text], Some(&self.name()));
            }
        }
    }

    pub(super) fn draft_kept(&mut self, key: &str, result: Result<(), FileError>, services: &mut Services) {
        if self.is_own(key) {
            self.drafting.busy = false;
        }
        if let Err(error) = result
            && !std::mem::replace(&mut self.drafting.told, true)
        {
            let text = Text::new("session.draft_not_kept").with_text("why", explain::file(&error));
            services.tell(Severity::Warning, vec![text], Some(&self.name()));
        }
    }

    /// Keeps the edits when they have changed. One task at a time: what comes meanwhile goes with the next one.
    pub(in crate::app) fn keep_draft(&mut self, services: &Services) {
        if self.drafting.busy || !self.drafting.looked {
            return;
        }
        let edits: Edits = self.staged.edits().collect();
        if edits == self.drafting.kept {
            return;
        }
        let Some((kind, key)) = self.draft_key() else { return };
        self.drafting.kept.clone_from(&edits);
        self.drafting.busy = true;
        keep(kind, key, edits, self.id, services);
    }

    /// Every edit is on disk, as far as the disk takes it.
    pub(in crate::app) fn is_draft_kept(&self) -> bool {
        !self.drafting.busy
    }

    /// Another encoder comes, or none: what is edited for this one stays on disk.
    pub(in crate::app) fn leave_draft(&mut self, services: &Services) {
        let edits: Edits = self.staged.edits().collect();
        if let Some((kind, key)) = self.draft_key()
            && self.drafting.looked
            && edits != self.drafting.kept
        {
            keep(kind, key, edits, self.id, services);
        }
        self.drafting = Drafting::default();
    }

    /// The edits are in `path` now: where that is another file, those for the one before are no draft any more.
    pub(super) fn forget_draft_unless(&mut self, path: &Path, services: &Services) {
        if matches!(&self.source, Source::File { path: own, .. } if own != path)
            && let Some((kind, key)) = self.draft_key()
        {
            keep(kind, key, Edits::new(), self.id, services);
            self.drafting = Drafting { looked: true, ..Drafting::default() };
        }
    }
}

fn keep(kind: &'static str, key: String, edits: Edits, id: SessionId, services: &Services) {
    let drafts = services.world.store.drafts();
    services.tasks.run("draft", move || {
        let result = if edits.is_empty() {
            drafts.remove(kind, &key)
        } else {
            drafts.keep(kind, &key, &ron::to_string(&edits).unwrap_or_default())
        };
        done(id, Done::DraftKept { key, result })
    });
}

fn done(id: SessionId, done: Done) -> crate::app::Action {
    crate::app::Action::Done(crate::app::action::Done::Hiperface(id, done))
}
