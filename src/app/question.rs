//! Questions to the user before data are lost, a job is interrupted, or bytes are sent on a line that may have a drive.

use std::path::PathBuf;

use super::Text;
use super::action::RecorderOwner;
use super::file_question::FileQuestion;
use super::session::SaveRequest;
use super::studio::SessionId;
use super::tab::Tab;

#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    pub text: Text,
    pub confirm: Text,
    pub decline: Text,
    pub(super) then: FollowUpAction,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum FollowUpAction {
    CloseWindow,
    CloseSession(SessionId),
    Write(FileQuestion, PathBuf),
    Forget(RecorderOwner),
    Save(Box<SaveRequest>),
    OpenLink(SessionId),
    /// Continue the device search that was started from this tab's connection form.
    Find(Tab),
}

impl Question {
    pub(super) fn new(text: Text, confirm: Text, then: FollowUpAction) -> Self {
        Question { text, confirm, decline: Text::new("question.stay"), then }
    }

    /// Asks whether another master may be on the line to which a link refers.
    pub(crate) fn other_master(link: String, then: FollowUpAction) -> Self {
        Question {
            text: Text::new("question.drive").with("link", link),
            confirm: Text::new("question.no_drive"),
            decline: Text::new("question.maybe_drive"),
            then,
        }
    }
}
