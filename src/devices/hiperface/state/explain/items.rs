//! Names of encoder items, and messages about rejected profile entries.

use crate::app::Text;
use crate::app::explain::literal_text;
use crate::devices::hiperface::procedures::ReadBackValue;
use crate::devices::hiperface::profile::{EntryError, FieldRange, Item, PlanItem};
use crate::devices::hiperface::state::TEXTS;
use crate::profile::Cause;

pub fn item_text(item: &Item) -> Text {
    match item {
        Item::Field(range) => field_range(range),
        Item::Status(field) => TEXTS.text("hf_item.status").with("field", field),
        Item::Analogue(channel) => TEXTS.text("hf_item.analogue").with("channel", format!("0x{channel:02X}")),
        Item::Counter => TEXTS.text("hf_item.counter"),
        Item::Address => TEXTS.text("hf_item.address"),
        Item::Settings => TEXTS.text("hf_item.settings"),
    }
}

pub fn field_range(range: &FieldRange) -> Text {
    let id = match range {
        FieldRange { count: Some(_), .. } => "hf_item.range",
        FieldRange { start: 0, count: None, .. } => "hf_item.field",
        FieldRange { count: None, .. } => "hf_item.rest",
    };
    let text = TEXTS.text(id).with("field", range.field).with("first", range.start);
    text.with("count", range.count.unwrap_or_default())
}

pub fn plan_item_text(own: &PlanItem) -> Text {
    match own {
        PlanItem::Item(own) => item_text(own),
        PlanItem::Encoder => TEXTS.text("hf_item.encoder"),
        PlanItem::FieldCount => TEXTS.text("hf_item.field_count"),
        PlanItem::Position => TEXTS.text("hf_item.position"),
        PlanItem::Code(number) => TEXTS.text("hf_item.code").with("number", number),
    }
}

pub fn read_back(read: &ReadBackValue) -> Text {
    match read {
        ReadBackValue::Value(value) => literal_text(value),
        ReadBackValue::StatusMismatch => TEXTS.text("hf_item.another_status"),
    }
}

pub fn rejection_text(cause: &Cause) -> Option<Text> {
    Some(match cause.get()? {
        EntryError::Twice(field) => TEXTS.text("hf_entry.twice").with("field", field),
        EntryError::Status(status) => TEXTS.text("hf_entry.status").with("status", format!("{status:02X}h")),
        EntryError::Locked => TEXTS.text("hf_entry.locked"),
        EntryError::NotLocked => TEXTS.text("hf_entry.not_locked"),
        EntryError::Size { got, expected } => TEXTS.text("hf_entry.size").with("got", got).with("expected", expected),
        EntryError::Marked(text) => TEXTS.text("hf_entry.marked").with("text", format!("{text:?}")),
    })
}
