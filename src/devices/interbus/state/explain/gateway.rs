//! Messages about gateway requests, rejections and damaged replies.

use crate::app::Text;
use crate::devices::interbus::procedures::{Exception, ReplyDamage, RequestedItem};
use crate::devices::interbus::state::TEXTS;

pub(super) fn item_text(requested: RequestedItem) -> Text {
    let id = match requested {
        RequestedItem::Input { .. } => "ib_asked.input",
        RequestedItem::Output { .. } => "ib_asked.output",
        RequestedItem::Write { .. } => "ib_asked.write",
    };
    let text = TEXTS.text(id).with("register", requested.register());
    match requested {
        RequestedItem::Write { word, .. } => text.with("word", super::format_word(word)),
        RequestedItem::Input { .. } | RequestedItem::Output { .. } => text,
    }
}

pub(super) fn exception_name(exception: Exception) -> Text {
    TEXTS.text(match exception.code() {
        0x01 => "ib_exception_name.function",
        0x02 => "ib_exception_name.address",
        0x03 => "ib_exception_name.value",
        0x04 => "ib_exception_name.failure",
        0x05 => "ib_exception_name.acknowledge",
        0x06 => "ib_exception_name.busy",
        0x08 => "ib_exception_name.memory",
        0x0A => "ib_exception_name.path",
        0x0B => "ib_exception_name.target",
        _ => "ib_exception_name.other",
    })
}

/// Returns the most likely cause of an exception and a remedy.
pub fn exception_text(exception: Exception) -> Text {
    TEXTS.text(match exception.code() {
        0x01 => "ib_exception.function",
        0x02 => "ib_exception.address",
        0x03 => "ib_exception.value",
        0x04 => "ib_exception.failure",
        0x05 | 0x06 => "ib_exception.busy",
        0x08 => "ib_exception.memory",
        0x0A => "ib_exception.path",
        0x0B => "ib_exception.target",
        _ => "ib_exception.other",
    })
}

pub fn damage_text(damage: ReplyDamage) -> Text {
    match damage {
        ReplyDamage::NoFrame { bytes } => TEXTS.text("ib_damage.no_frame").with("bytes", bytes),
        ReplyDamage::Unit { requested, got } => TEXTS.text("ib_damage.unit").with("asked", requested).with("got", got),
        ReplyDamage::Function { requested, got } => {
            TEXTS.text("ib_damage.function").with("asked", requested).with("got", got)
        }
        ReplyDamage::Registers => TEXTS.text("ib_damage.registers"),
    }
}
