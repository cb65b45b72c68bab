//! Messages for damaged replies.

use crate::app::Text;
use crate::buses::ubicom::protocol::ReplyError;
use crate::devices::biss::procedures::Damage;
use crate::devices::biss::protocol::FrameError;
use crate::devices::biss::state::TEXTS;

pub fn damage_text(damage: &Damage) -> Text {
    let byte = |byte: &u8| format!("0x{byte:02X}");
    match damage {
        Damage::NoFrame { bytes } => TEXTS.text("biss.damage_no_frame").with("bytes", bytes),
        Damage::Reply(ReplyError::Address { expected, got }) => {
            TEXTS.text("biss.damage_node").with("got", byte(got)).with("expected", byte(expected))
        }
        Damage::Reply(ReplyError::Command { expected, got }) => {
            TEXTS.text("biss.damage_command").with("got", byte(got)).with("expected", byte(expected))
        }
        Damage::Reply(ReplyError::Length { expected, got }) => {
            TEXTS.text("biss.damage_length").with("got", got).with("expected", expected)
        }
        Damage::Echo => TEXTS.text("biss.damage_echo"),
        Damage::Frame(error) => frame(error),
        Damage::ControlFrame => TEXTS.text("biss.damage_control"),
        Damage::Inconsistent => Text::new("damage.inconsistent"),
    }
}

fn frame(error: &FrameError) -> Text {
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
    fn damage_texts_match_the_protocol_errors() {
        let cases = [
            Damage::NoFrame { bytes: 7 },
            Damage::Reply(ReplyError::Address { expected: 1, got: 2 }),
            Damage::Reply(ReplyError::Command { expected: 1, got: 2 }),
            Damage::Reply(ReplyError::Length { expected: 1, got: 2 }),
            Damage::Echo,
            Damage::Frame(FrameError::StuckLow),
            Damage::Frame(FrameError::StuckHigh),
            Damage::Frame(FrameError::Long { bits: 41 }),
            Damage::Frame(FrameError::Crc { expected: 0x0F, got: 0x3A }),
            Damage::ControlFrame,
            Damage::Inconsistent,
        ];
        for found in cases {
            assert_eq!(damage_text(&found).to_string_in(Language::English), found.to_string());
            assert_ne!(damage_text(&found).to_string_in(Language::German), found.to_string());
        }
    }
}
