//! Messages about damaged replies.

use super::format::status_with_number;
use crate::app::Text;
use crate::devices::hiperface::procedures::ReplyDamage;
use crate::devices::hiperface::protocol::{FrameError, ReplyError};
use crate::devices::hiperface::state::TEXTS;

pub fn damage_text(damage: &ReplyDamage) -> Text {
    match damage {
        ReplyDamage::Reply(error) => reply_error_text(error),
        ReplyDamage::Unreadable => TEXTS.text("damage.unreadable"),
        ReplyDamage::Trailing => TEXTS.text("damage.trailing"),
        ReplyDamage::Late => TEXTS.text("damage.late"),
        ReplyDamage::Echo => TEXTS.text("damage.echo"),
        ReplyDamage::AtEncoder(code) => TEXTS.text("damage.at_encoder").with_text("code", status_with_number(*code)),
        ReplyDamage::Inconsistent => Text::new("damage.inconsistent"),
    }
}

fn reply_error_text(error: &ReplyError) -> Text {
    let byte = |byte: &u8| format!("{byte:02X}h");
    match error {
        ReplyError::Frame(FrameError::Short { got }) => TEXTS.text("damage.short").with("got", got),
        ReplyError::Frame(FrameError::Checksum { expected, got }) => {
            TEXTS.text("damage.checksum").with("got", format!("{got:02X}")).with("expected", format!("{expected:02X}"))
        }
        ReplyError::Address { expected, got } => {
            TEXTS.text("damage.address").with("got", byte(got)).with("expected", byte(expected))
        }
        ReplyError::Command { expected, got } => {
            TEXTS.text("damage.command").with("got", byte(got)).with("expected", byte(expected))
        }
        ReplyError::Length { command, got } => {
            TEXTS.text("damage.length").with("got", got).with("command", byte(command))
        }
        ReplyError::Argument => TEXTS.text("damage.argument"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::devices::hiperface::protocol::StatusCode;

    #[test]
    fn reply_damage_text_matches_protocol_error() {
        let cases = [
            ReplyDamage::Reply(ReplyError::Frame(FrameError::Short { got: 2 })),
            ReplyDamage::Reply(ReplyError::Frame(FrameError::Checksum { expected: 0x0A, got: 0xB0 })),
            ReplyDamage::Reply(ReplyError::Address { expected: 0x40, got: 0x41 }),
            ReplyDamage::Reply(ReplyError::Command { expected: 0x42, got: 0x50 }),
            ReplyDamage::Reply(ReplyError::Length { command: 0x42, got: 3 }),
            ReplyDamage::Reply(ReplyError::Argument),
            ReplyDamage::Unreadable,
            ReplyDamage::Trailing,
            ReplyDamage::Late,
            ReplyDamage::Echo,
            ReplyDamage::AtEncoder(StatusCode::PARITY),
            ReplyDamage::Inconsistent,
        ];
        for found in cases {
            assert_eq!(damage_text(&found).to_string_in(Language::English), found.to_string());
            assert_ne!(damage_text(&found).to_string_in(Language::German), found.to_string());
        }
    }
}
