//! Messages for errors of an adapter, a hub or a drive: what happened and what to do.

use super::names::parameter_name_text;
use super::status;
use crate::app::Text;
use crate::app::explain::{link_error_text, literal_text};
use crate::buses::ethernet_ip::protocol::{EncapsulationStatus, GeneralStatus};
use crate::devices::hiperdrive::procedures::{
    Error, ErrorReply, LateReplyError, ReplyDamage, RequestedItem, WrongLength,
};
use crate::devices::hiperdrive::protocol::{OutOfRange, ParameterNumber, ParameterRange, Topology};
use crate::devices::hiperdrive::state::TEXTS;

pub fn device_error_text(error: &Error) -> Text {
    match error {
        Error::Link(error) => link_error_text(error),
        Error::Cancelled => Text::new("encoder.cancelled"),
        Error::NeverSilent => TEXTS.text("hd_said.never_silent"),
        Error::NoReply { requested: what, tries, late: None } => {
            TEXTS.text("hd_said.no_reply").with_text("asked", item_text(*what)).with("tries", tries)
        }
        Error::NoReply { requested: what, tries, late: Some(LateReplyError { took, waited }) } => TEXTS
            .text("hd_said.late_reply")
            .with_text("asked", item_text(*what))
            .with("tries", tries)
            .with("took", took.as_millis())
            .with("waited", waited.as_millis()),
        Error::Damaged { requested: what, tries, cause } => TEXTS
            .text("hd_said.damaged")
            .with_text("asked", item_text(*what))
            .with("tries", tries)
            .with_text("why", damage_text(cause)),
        Error::Encapsulation { requested: what, status } => TEXTS
            .text("hd_said.refused")
            .with_text("asked", item_text(*what))
            .with_text("status", status::encapsulation_status_text(*status))
            .with_text("remedy", frame_remedy(*status)),
        Error::Refused { requested: what, refusal } => TEXTS
            .text("hd_said.refused")
            .with_text("asked", item_text(*what))
            .with_text("status", status::refusal_text(refusal))
            .with_text("remedy", remedy_text(refusal)),
        Error::OtherMaster { extended } => TEXTS.text("hd_said.other_master").with("code", format!("0x{extended:04X}")),
        Error::TooSlow { asked_ms, got_ms } => {
            TEXTS.text("hd_said.too_slow").with("asked", asked_ms).with("got", got_ms)
        }
        Error::CoarseTimer { asked_ms, step_ms } => {
            TEXTS.text("hd_said.coarse_timer").with("asked", asked_ms).with("step", step_ms)
        }
        Error::InControl => TEXTS.text("hd_said.in_control"),
        Error::NoCyclic => TEXTS.text("hd_said.no_cyclic"),
        Error::Unknown(number) => TEXTS.text("hd_said.unknown").with("number", number),
        Error::NoNumber(number) => TEXTS.text("hd_said.unknown").with("number", number),
        Error::NoPlace { drive, topology: Topology::Adapter } => {
            TEXTS.text("hd_said.one_drive").with("drive", drive.get())
        }
        Error::NoPlace { drive, topology } => {
            TEXTS.text("hd_said.no_place").with("drive", drive.get()).with("places", topology.drives())
        }
        Error::NoDrive { drive } => TEXTS.text("hd_said.no_drive").with("drive", drive.get()),
        Error::NotRequested { drive } => TEXTS.text("hd_said.not_requested").with("drive", drive.get()),
        Error::OutOfRange(error) => out_of_range(error),
        Error::Refuses(error) => out_of_range_text("hd_said.refuses", error),
        Error::Length(error) => wrong_length(error),
        Error::Value { number, cause } => {
            parameter_text("hd_said.value", *number).with_text("why", status::value_error_text(cause))
        }
        Error::ReadOnly { number, .. } => parameter_text("hd_said.read_only", *number),
        Error::WriteOnly { number, .. } => parameter_text("hd_said.write_only", *number),
        Error::Motion { number, .. } => parameter_text("hd_said.motion", *number),
        Error::Moving { drive } => TEXTS.text("hd_said.moving").with("drive", drive.get()),
        Error::NotHiperdrive { product } => TEXTS.text("hd_said.other_device").with("says", product),
        Error::NotAccepted { number, wanted, reads } => {
            parameter_text("hd_said.not_taken", *number).with("wanted", wanted).with("reads", reads)
        }
        Error::NetworkNotTaken { attribute } => TEXTS.text("hd_said.network_not_taken").with("attribute", attribute),
        Error::Busy { reads, milliseconds } => {
            TEXTS.text("hd_said.busy").with("reads", reads).with("milliseconds", milliseconds)
        }
        Error::Changed { item } => TEXTS.text("hd_said.changed").with("item", item),
    }
}

pub fn out_of_range(error: &OutOfRange) -> Text {
    match error.range {
        ParameterRange::OneOf([]) => parameter_text("hd_said.a_text", error.number),
        _ => out_of_range_text("hd_said.out_of_range", error),
    }
}

pub fn wrong_length(error: &WrongLength) -> Text {
    parameter_text("hd_said.length", error.number).with("expected", error.expected).with("got", error.got)
}

pub fn range_text(range: ParameterRange) -> Text {
    match range {
        ParameterRange::Any => TEXTS.text("hd_range.any"),
        ParameterRange::Within(low, high) if low == high => TEXTS.text("hd_range.only").with("low", low),
        ParameterRange::Within(low, high) => TEXTS.text("hd_range.within").with("low", low).with("high", high),
        ParameterRange::WithinOrEqual(low, high, also) => {
            TEXTS.text("hd_range.within_or").with("low", low).with("high", high).with("also", also)
        }
        ParameterRange::OneOf(values) => Text::new("plain.words").with_list("words", values.iter().map(literal_text)),
    }
}

fn out_of_range_text(id: &'static str, error: &OutOfRange) -> Text {
    parameter_text(id, error.number).with("value", error.value).with_text("range", range_text(error.range))
}

/// Returns a message that includes the number and the name of a parameter.
pub(super) fn parameter_text(id: &'static str, number: ParameterNumber) -> Text {
    TEXTS.text(id).with("number", number).with_text("name", parameter_name_text(number))
}

fn item_text(requested: RequestedItem) -> Text {
    match requested {
        RequestedItem::Session => TEXTS.text("hd_asked.session"),
        RequestedItem::Parameter(number) => parameter_text("hd_asked.parameter", number),
        RequestedItem::Set(number) => parameter_text("hd_asked.set", number),
        RequestedItem::Identity => TEXTS.text("hd_asked.identity"),
        RequestedItem::Network { attribute } => TEXTS.text("hd_asked.network").with("attribute", attribute),
        RequestedItem::SetNetwork { attribute } => TEXTS.text("hd_asked.set_network").with("attribute", attribute),
        RequestedItem::Mac => TEXTS.text("hd_asked.mac"),
        RequestedItem::Open => TEXTS.text("hd_asked.open"),
        RequestedItem::Close => TEXTS.text("hd_asked.close"),
    }
}

pub fn damage_text(damage: &ReplyDamage) -> Text {
    match damage {
        ReplyDamage::Packet(why) => TEXTS.text("hd_damage.packet").with_text("why", status::packet_error_text(why)),
        ReplyDamage::Value(why) => TEXTS.text("hd_damage.value").with_text("why", status::value_error_text(why)),
        ReplyDamage::Empty => TEXTS.text("hd_damage.empty"),
        ReplyDamage::Service { .. } => TEXTS.text("hd_damage.service"),
        ReplyDamage::Cut { bytes } => TEXTS.text("hd_damage.cut").with("bytes", bytes),
    }
}

fn frame_remedy(status: EncapsulationStatus) -> Text {
    TEXTS.text(match status.code() {
        0x01 | 0x69 => "hd_status.absent",
        0x02 => "hd_status.again",
        0x64 => "hd_status.anew",
        _ => "hd_status.defect",
    })
}

fn remedy_text(refusal: &ErrorReply) -> Text {
    if refusal.status == GeneralStatus::CONNECTION
        && let Some(row) = refusal.row()
    {
        return TEXTS.text(match row.code {
            0x0100 | 0x0113 => "hd_status.full",
            0x0107 | 0x0203 => "hd_status.anew",
            0x0108 | 0x0109 | 0x0127 | 0x0128 | 0x0117 => "hd_status.size",
            0x0111 => "hd_status.interval",
            0x0204 => "hd_status.again",
            _ => "hd_status.defect",
        });
    }
    TEXTS.text(match refusal.status.code() {
        0x02 => "hd_status.full",
        0x05 | 0x08 | 0x14 | 0x16 => "hd_status.absent",
        0x07 => "hd_status.anew",
        0x09 | 0x20 => "hd_status.value",
        0x0C | 0x10 | 0x0F => "hd_status.state",
        0x0E => "hd_status.read_only",
        0x13 | 0x15 => "hd_status.length",
        0x19 => "hd_status.again",
        0x03 | 0x04 | 0x12 | 0x1C | 0x26 => "hd_status.defect",
        _ => "hd_status.manual",
    })
}
