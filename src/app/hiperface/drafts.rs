//! Edits outlive a crash: they are kept beside the studio's other data as they are made, one file for each encoder or
//! profile, and come back with it. Each has one owner: a second session with the same encoder, here or in another window,
//! neither takes nor overwrites them.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::Done;
use super::encoder::{Encoder, Source};
use crate::app::services::Services;
use crate::app::studio::SessionId;
use crate::app::{Severity, Text, explain};
use crate::protocol::hiperface::KIND;
use crate::store::{Claim, Drafts, FileError};

type Edits = Vec<(u8, usize, u8)>;

/// How long another session may take to give up its claim: one that was closed still writes.
const PATIENCE: Duration = Duration::from_secs(1);
const RETRY: Duration = Duration::from_millis(20);

/// Whose draft it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DraftKey {
    /// The kind of device, virtual ones apart; or of files.
    pub(super) kind: &'static str,
    /// Type and serial number, or the file.
    pub(super) name: String,
}

/// How it stands with the draft on disk.
#[derive(Debug, Default)]
pub(super) struct Drafting {
    /// What was last handed over to be kept.
    kept: Edits,
    /// A task is at it.
    busy: bool,
    /// The draft of an earlier time has been looked for: before that, nothing is kept over it.
    looked: bool,
    /// The right to keep it; without, it belongs to another window or session.
    claim: Option<Arc<Claim>>,
    /// That it cannot be kept has been said.
    told: bool,
}

/// The name of a file's draft: of the file itself, whichever way leads to it. As a task: it asks the disk.
pub(in crate::app) fn file_key(path: &Path) -> String {
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    // FNV-1a, the same in every version of the program.
    let mut hash: u64 = 0xCBF2_9CE4_8422_2325;
    for byte in path.as_os_str().as_encoded_bytes() {
        hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3);
    }
    format!("{hash:016x}")
}

impl Encoder {
    /// Whose draft it is; `None` for an encoder that does not say who it is.
    fn draft_key(&self) -> Option<DraftKey> {
        match &self.source {
            Source::File { key, .. } => Some(DraftKey { kind: "hiperface-files", name: key.clone() }),
            Source::Link(_) => {
                let identity = self.identity.as_ref()?;
                let serial = &identity.serial.serial_number;
                let kind = if self.is_virtual() { "hiperface-virtual" } else { KIND };
                let name = format!("{:02X}-{serial}", identity.label.encoder_type);
                (!serial.is_empty()).then_some(DraftKey { kind, name })
            }
        }
    }

    pub(super) fn load_draft(&mut self, services: &Services) {
        self.claim_draft(services, |drafts, key| drafts.load(key.kind, &key.name));
    }

    /// What was just saved has no edits: those of an earlier time are for what it replaced.
    pub(super) fn begin_draft(&mut self, services: &Services) {
        self.claim_draft(services, |drafts, key| drafts.remove(key.kind, &key.name).map(|()| None));
    }

    fn claim_draft(
        &mut self,
        services: &Services,
        load: impl FnOnce(&Drafts, &DraftKey) -> Result<Option<String>, FileError> + Send + 'static,
    ) {
        let Some(key) = self.draft_key() else { return };
        let (drafts, id) = (services.world.store.drafts(), self.id);
        self.drafting.busy = true;
        services.tasks.run("draft", move || {
            let began = Instant::now();
            let claim = loop {
                match drafts.claim(key.kind, &key.name) {
                    Ok(None) if began.elapsed() < PATIENCE => std::thread::sleep(RETRY),
                    Ok(claim) => break Ok(claim),
                    Err(error) => break Err(error),
                }
            };
            let result = match &claim {
                Ok(None) => Ok(None),
                _ => load(&drafts, &key),
            };
            done(id, Done::Draft { key, claim, result })
        });
    }

    /// What a task says of another encoder's or profile's draft is old by now.
    fn is_own(&self, key: &DraftKey) -> bool {
        self.draft_key().as_ref() == Some(key)
    }

    pub(super) fn take_draft(
        &mut self,
        key: &DraftKey,
        claim: Result<Option<Claim>, FileError>,
        result: Result<Option<String>, FileError>,
        services: &mut Services,
    ) {
        if !self.is_own(key) {
            return;
        }
        self.drafting.busy = false;
        match claim {
            Ok(Some(claim)) => self.drafting.claim = Some(Arc::new(claim)),
            Ok(None) => {
                let text = Text::new("session.draft_elsewhere");
                services.tell(Severity::Warning, vec![text], Some(&self.name()));
                return;
            }
            // Nobody can keep a draft in such a folder, which is told when there is something to keep.
            Err(_) => {}
        }
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

    pub(super) fn draft_kept(&mut self, key: &DraftKey, result: Result<(), FileError>, services: &mut Services) {
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
    pub(in crate::app) fn keep_draft(&mut self, services: &mut Services) {
        self.tell_of_no_draft(services);
        if self.drafting.busy || !self.drafting.looked {
            return;
        }
        let edits: Edits = self.staged.edits().collect();
        if edits == self.drafting.kept {
            return;
        }
        let Some(key) = self.draft_key() else { return };
        self.drafting.kept.clone_from(&edits);
        self.drafting.busy = true;
        keep(key, edits, self.drafting.claim.clone(), self.id, services);
    }

    /// An encoder without a serial number has no draft, which is said once, with the first edit.
    fn tell_of_no_draft(&mut self, services: &mut Services) {
        let nameless = self.identity.as_ref().is_some_and(|identity| identity.serial.serial_number.is_empty());
        if nameless
            && matches!(self.source, Source::Link(_))
            && self.staged.is_dirty()
            && !std::mem::replace(&mut self.drafting.told, true)
        {
            services.tell(Severity::Warning, vec![Text::new("session.draft_none")], Some(&self.name()));
        }
    }

    /// Its edits come back after it was closed.
    pub(in crate::app) fn keeps_edits(&self) -> bool {
        self.drafting.looked && self.draft_key().is_some()
    }

    /// Every edit is on disk, as far as the disk takes it.
    pub(in crate::app) fn is_draft_kept(&self) -> bool {
        !self.drafting.busy
    }

    /// Another encoder comes, or none: what is edited for this one stays on disk.
    pub(in crate::app) fn leave_draft(&mut self, services: &mut Services) {
        let edits: Edits = self.staged.edits().collect();
        let drafting = std::mem::take(&mut self.drafting);
        if let Some(key) = self.draft_key()
            && drafting.looked
            && edits != drafting.kept
        {
            keep(key, edits, drafting.claim, self.id, services);
        }
    }

    /// The edits are in the file of `key` now: where that is another one, those for the one before are no draft any more.
    pub(super) fn forget_draft_unless(&mut self, key: &str, services: &mut Services) -> bool {
        let Source::File { key: own, .. } = &self.source else { return false };
        if own == key {
            return false;
        }
        let drafting = std::mem::take(&mut self.drafting);
        if let Some(key) = self.draft_key()
            && drafting.looked
        {
            keep(key, Edits::new(), drafting.claim, self.id, services);
        }
        true
    }
}

/// Hands edits over to be kept; the claim lives until they are.
fn keep(key: DraftKey, edits: Edits, claim: Option<Arc<Claim>>, id: SessionId, services: &mut Services) {
    services.drafts_on_their_way += 1;
    let drafts = services.world.store.drafts();
    services.tasks.run("draft", move || {
        let result = if edits.is_empty() {
            drafts.remove(key.kind, &key.name)
        } else {
            drafts.keep(key.kind, &key.name, &ron::to_string(&edits).unwrap_or_default())
        };
        drop(claim);
        done(id, Done::DraftKept { key, result })
    });
}

fn done(id: SessionId, done: Done) -> crate::app::Action {
    crate::app::Action::Done(crate::app::action::Done::Hiperface(id, done))
}
