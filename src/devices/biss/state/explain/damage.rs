//! Messages for damaged replies.

use crate::app::Text;
use crate::buses::ubicom::protocol::ReplyError;
use crate::devices::biss::procedures::ReplyDamage;
use crate::devices::biss::protocol::FrameError;
use crate::devices::biss::state::TEXTS;

pub fn damage_text(damage: &ReplyDamage) -> Text {
    let byte = |byte: &u8| format!("0x{byte:02X}");
    match damage {
        ReplyDamage::NoFrame { bytes } => TEXTS.text("biss.damage_no_frame").with("bytes", bytes),
        ReplyDamage::Reply(ReplyError::Address { expected, got }) => {
            TEXTS.text("biss.damage_node").with("got", byte(got)).with("expected", byte(expected))
        }
        ReplyDamage::Reply(ReplyError::Command { expected, got }) => {
            TEXTS.text("biss.damage_command").with("got", byte(got)).with("expected", byte(expected))
        }
        ReplyDamage::Reply(ReplyError::Length { expected, got }) => {
            TEXTS.text("biss.damage_length").with("got", got).with("expected", expected)
        }
        ReplyDamage::Echo => TEXTS.text("biss.damage_echo"),
        ReplyDamage::Frame(error) => frame_error_text(error),
        ReplyDamage::ControlFrame => TEXTS.text("biss.damage_control"),
        ReplyDamage::Inconsistent => Text::new("damage.inconsistent"),
    }
}

fn frame_error_text(error: &FrameError) -> Text {
    match error {
        FrameError::StuckLow => TEXTS.text("biss.damage_low"),
        FrameError::StuckHigh => TEXTS.text("biss.damage_high"),
        FrameError::Long { bits } => TEXTS.text("biss.damage_long").with("bits", bits),
        FrameError::Crc { expected, got } => {
            TEXTS.text("biss.damage_crc").with("got", format!("{got:02X}")).with("expected", format!("{expected:02X}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;

    #[test]
    fn corrupt_reply_texts_match_protocol_errors() {
        let cases = [
            ReplyDamage::NoFrame { bytes: 7 },
            ReplyDamage::Reply(ReplyError::Address { expected: 1, got: 2 }),
            ReplyDamage::Reply(ReplyError::Command { expected: 1, got: 2 }),
            ReplyDamage::Reply(ReplyError::Length { expected: 1, got: 2 }),
            ReplyDamage::Echo,
            ReplyDamage::Frame(FrameError::StuckLow),
            ReplyDamage::Frame(FrameError::StuckHigh),
            ReplyDamage::Frame(FrameError::Long { bits: 41 }),
            ReplyDamage::Frame(FrameError::Crc { expected: 0x0F, got: 0x3A }),
            ReplyDamage::ControlFrame,
            ReplyDamage::Inconsistent,
        ];
        for found in cases {
            assert_eq!(damage_text(&found).to_string_in(Language::English), found.to_string());
            assert_ne!(damage_text(&found).to_string_in(Language::German), found.to_string());
        }
    }
}
