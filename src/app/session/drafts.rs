//! Drafts, which preserve edits across a crash. Each edit is stored immediately in the program's data folder, with one
//! file per device or profile.
//!
//! A draft has a single owner. A second session with the same device, in this or another window, neither adopts nor
//! overwrites it. Only the kind of device knows the content of an edit.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::app::action::{Action, TaskResult};
use crate::app::services::Services;
use crate::app::studio::SessionId;
use crate::app::{Severity, Text, explain};
use crate::store::{Claim, Drafts, FileError};

pub(super) const DRAFT_RESTORED_ID: &str = "session.draft_back";

/// Maximum time to wait for another session to release its claim on a draft. A closed session may still be writing.
const CLAIM_TIMEOUT: Duration = Duration::from_secs(1);
const RETRY: Duration = Duration::from_millis(20);

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DraftKey {
    kind: String,
    name: String,
}

impl DraftKey {
    /// Creates the key of a device from its type and serial number. Virtual devices have separate keys.
    pub(in crate::app) fn for_device(kind: &str, is_virtual: bool, name: String) -> Self {
        DraftKey { kind: if is_virtual { format!("{kind}-virtual") } else { kind.to_owned() }, name }
    }

    /// Creates the key of a profile from its [`file_key`].
    pub(in crate::app) fn for_file(kind: &str, key: &str) -> Self {
        DraftKey { kind: format!("{kind}-files"), name: key.to_owned() }
    }
}

pub enum DraftOutcome {
    Looked {
        key: DraftKey,
        /// Exclusive right to store the draft, or `None` if another window or session holds it.
        claim: Result<Option<Claim>, FileError>,
        result: Result<Option<String>, FileError>,
    },
    Kept {
        key: DraftKey,
        result: Result<(), FileError>,
    },
}

pub trait DraftEdits: Serialize + DeserializeOwned + Clone + PartialEq + Default + Send + 'static {
    fn has_no_edits(&self) -> bool;
}

impl<T: Serialize + DeserializeOwned + Clone + PartialEq + Send + 'static> DraftEdits for Vec<T> {
    fn has_no_edits(&self) -> bool {
        self.is_empty()
    }
}

#[derive(Debug)]
pub(crate) struct ActiveDraft<E> {
    session: SessionId,
    /// Last edits passed on for storage.
    kept: E,
    busy: bool,
    /// Whether the edits may have changed since they were last passed on for storage.
    due: bool,
    /// Whether the search for an earlier draft has ended. Until then, the draft is not overwritten.
    is_loaded: bool,
    /// Exclusive right to store the draft, or `None` if another window or session holds it.
    claim: Option<Arc<Claim>>,
    is_failure_reported: bool,
}

/// Returns the draft name for a file, which is the same for every path to that file. This function accesses the disk,
/// so it must run in a task.
pub(in crate::app) fn file_key(path: &Path) -> String {
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    // The hash is FNV-1a in every version of the program.
    let mut hash: u64 = 0xCBF2_9CE4_8422_2325;
    for byte in path.as_os_str().as_encoded_bytes() {
        hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3);
    }
    format!("{hash:016x}")
}

impl<E: DraftEdits> ActiveDraft<E> {
    /// Creates the state of a draft before the search for an earlier one.
    pub(in crate::app) fn new(session: SessionId) -> Self {
        ActiveDraft {
            session,
            kept: E::default(),
            busy: false,
            due: true,
            is_loaded: false,
            claim: None,
            is_failure_reported: false,
        }
    }

    pub(in crate::app) fn load(&mut self, key: DraftKey, services: &Services) {
        self.claim_draft(key, services, |drafts, key| drafts.load(&key.kind, &key.name));
    }

    /// Claims the draft of a newly saved profile without edits. An earlier draft belongs to the file that was replaced,
    /// and is removed.
    pub(in crate::app) fn begin_for_profile(&mut self, key: DraftKey, services: &Services) {
        self.claim_draft(key, services, |drafts, key| drafts.remove(&key.kind, &key.name).map(|()| None));
    }

    fn claim_draft(
        &mut self,
        key: DraftKey,
        services: &Services,
        load: impl FnOnce(&Drafts, &DraftKey) -> Result<Option<String>, FileError> + Send + 'static,
    ) {
        let (drafts, session) = (services.world.store.drafts(), self.session);
        self.busy = true;
        services.tasks.run("draft", move || {
            let began = Instant::now();
            let claim = loop {
                match drafts.claim_draft(&key.kind, &key.name) {
                    Ok(None) if began.elapsed() < CLAIM_TIMEOUT => std::thread::sleep(RETRY),
                    Ok(claim) => break Ok(claim),
                    Err(error) => break Err(error),
                }
            };
            let result = match &claim {
                Ok(None) => Ok(None),
                _ => load(&drafts, &key),
            };
            Action::Done(TaskResult::Draft(session, DraftOutcome::Looked { key, claim, result }))
        });
    }

    /// Handles the result of a draft task. Returns the edits of an earlier session, if any.
    ///
    /// A result for a draft other than `own` is outdated. If `dirty` is set, new edits take precedence over earlier
    /// ones.
    pub(in crate::app) fn handle_outcome(
        &mut self,
        done: DraftOutcome,
        own: Option<&DraftKey>,
        dirty: bool,
        name: &str,
        services: &mut Services,
    ) -> Option<E> {
        let (claim, result) = match done {
            DraftOutcome::Looked { key, claim, result } if own == Some(&key) => (claim, result),
            DraftOutcome::Looked { .. } => return None,
            DraftOutcome::Kept { key, result } => {
                self.handle_draft_stored(own == Some(&key), result, name, services);
                return None;
            }
        };
        self.busy = false;
        match claim {
            Ok(Some(claim)) => self.claim = Some(Arc::new(claim)),
            Ok(None) => {
                services.notify(Severity::Warning, vec![Text::new("session.draft_elsewhere")], Some(name));
                return None;
            }
            // No draft can be stored in this folder. This is reported when there is a draft to store.
            Err(_) => {}
        }
        self.is_loaded = true;
        let text = match result {
            Ok(text) => text?,
            Err(error) => {
                services.notify(Severity::Warning, vec![explain::file_error_text(&error)], Some(name));
                return None;
            }
        };
        if dirty {
            return None;
        }
        match ron::from_str::<E>(&text) {
            Ok(edits) => Some(edits),
            Err(error) => {
                tracing::warn!("the draft of {name} cannot be read: {error}");
                let place = error.span.start;
                let text = Text::new("session.draft_broken").with("line", place.line).with("column", place.col);
                services.notify(Severity::Warning, vec![text], Some(name));
                None
            }
        }
    }

    /// Handles the edits restored from a draft. `edits` contains those that are still valid.
    pub(in crate::app) fn restore_edits(&mut self, edits: E, name: &str, services: &mut Services) {
        if !edits.has_no_edits() {
            services.notify(Severity::Warning, vec![Text::new(DRAFT_RESTORED_ID)], Some(name));
        }
        self.kept = edits;
    }

    fn handle_draft_stored(
        &mut self,
        is_own: bool,
        result: Result<(), FileError>,
        name: &str,
        services: &mut Services,
    ) {
        if is_own {
            self.busy = false;
        }
        if let Err(error) = result
            && !std::mem::replace(&mut self.is_failure_reported, true)
        {
            let text = Text::new("session.draft_not_kept").with_text("why", explain::file_error_text(&error));
            services.notify(Severity::Warning, vec![text], Some(name));
        }
    }

    pub(in crate::app) fn mark_draft_due(&mut self) {
        self.due = true;
    }

    /// Returns whether events have arrived since the last check, so that the edits must be compared again.
    pub(in crate::app) fn is_due(&self) -> bool {
        self.due && !self.busy
    }

    /// Stores the edits if they have changed. Only one task runs at a time; later changes are stored by the next one.
    pub(in crate::app) fn save(&mut self, key: Option<DraftKey>, edits: E, services: &mut Services) {
        if self.busy {
            return;
        }
        self.due = false;
        if !self.is_loaded || edits == self.kept {
            return;
        }
        let Some(key) = key else { return };
        self.kept.clone_from(&edits);
        self.busy = true;
        store_edits(key, edits, self.claim.clone(), self.session, services);
    }

    /// Reports, once at the first edit, that edits of a device without a serial number are not stored as a draft.
    pub(in crate::app) fn report_missing_draft(&mut self, name: &str, services: &mut Services) {
        if !std::mem::replace(&mut self.is_failure_reported, true) {
            services.notify(Severity::Warning, vec![Text::new("session.draft_none")], Some(name));
        }
    }

    /// Returns whether the search for an earlier draft has ended. Edits are then restored when the device is opened
    /// again.
    pub(crate) fn is_loaded(&self) -> bool {
        self.is_loaded
    }

    pub(in crate::app) fn is_kept(&self) -> bool {
        !self.busy
    }

    /// Leaves the edits of the previous device on disk, because that device is no longer open.
    pub(in crate::app) fn leave_on_disk(&mut self, key: Option<DraftKey>, edits: E, services: &mut Services) {
        let before = std::mem::replace(self, ActiveDraft::new(self.session));
        if let Some(key) = key
            && before.is_loaded
            && edits != before.kept
        {
            store_edits(key, edits, before.claim, self.session, services);
        }
    }

    /// Removes the draft because the edits are now stored in another file.
    pub(in crate::app) fn remove_draft(&mut self, key: Option<DraftKey>, services: &mut Services) {
        let before = std::mem::replace(self, ActiveDraft::new(self.session));
        if let Some(key) = key
            && before.is_loaded
        {
            store_edits(key, E::default(), before.claim, self.session, services);
        }
    }
}

/// Starts a task that stores edits. The claim is held until they are stored.
fn store_edits<E: DraftEdits>(
    key: DraftKey,
    edits: E,
    claim: Option<Arc<Claim>>,
    session: SessionId,
    services: &mut Services,
) {
    services.drafts_on_their_way += 1;
    let drafts = services.world.store.drafts();
    services.tasks.run("draft", move || {
        let result = if edits.has_no_edits() {
            drafts.remove(&key.kind, &key.name)
        } else {
            drafts.save(&key.kind, &key.name, &ron::to_string(&edits).unwrap_or_default())
        };
        drop(claim);
        Action::Done(TaskResult::Draft(session, DraftOutcome::Kept { key, result }))
    });
}
