//! HIPERFACE: an encoder on the desk, its memory beside what the user has made of it, and the review of a write.

mod act;
mod action;
pub mod commutation;
mod drafts;
mod encoder;
pub mod forms;
mod meaning;
mod mounting;
mod news;
mod record;
mod rest;
pub mod review;
pub mod rules;
mod staged;

pub use action::{Action, Done};
pub use drafts::DraftKey;
pub(in crate::app) use drafts::file_key;
pub use encoder::{Encoder, Phase, Source};
pub(in crate::app) use encoder::{Opening, without_codes};
pub(in crate::app) use news::{LastWords, last_words};
pub use record::{Record, watch_name};
pub use review::{Review, ReviewState};
pub use rules::Allowed;
pub use staged::{Staged, StagedError};
