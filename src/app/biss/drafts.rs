//! Edits of an encoder's plain data, kept over a crash: global address and byte.

use std::path::PathBuf;

use super::encoder::Encoder;
use crate::app::session::{Drafted, Drafting, Session};
use crate::profile::Document;
use crate::protocol::biss::KIND;
use crate::worker::biss::Biss;

/// Edited bytes: global address, byte.
pub(in crate::app) type Edits = Vec<(u16, u8)>;

impl Drafted for Encoder {
    const KIND: &'static str = KIND;
    type Device = Biss;
    type Edits = Edits;

    fn session(&self) -> &Session<Biss> {
        &self.session
    }

    fn session_mut(&mut self) -> &mut Session<Biss> {
        &mut self.session
    }

    fn drafting(&self) -> &Drafting<Edits> {
        &self.drafting
    }

    fn drafting_mut(&mut self) -> &mut Drafting<Edits> {
        &mut self.drafting
    }

    fn type_and_serial(&self) -> Option<(String, String)> {
        self.key().map(|key| (key.device_type, key.serial_number))
    }

    fn edited(&self) -> Edits {
        self.memory.edits()
    }

    fn take_edits(&mut self, edits: Edits) {
        self.memory.take_draft(edits);
    }

    fn take_document(&mut self, path: PathBuf, key: String, document: Document) {
        let Some(profile) = document.body.biss() else { return };
        self.take_profile(profile);
        self.session.take_document(path, key, document);
    }
}
