//! Formatting BiSS encoder data and jobs as text.

use std::sync::LazyLock;

use super::memory::MemoryError;
use crate::app::Text;
use crate::app::explain::literal_text;
use crate::devices::biss::jobs::BissJob;
use crate::devices::biss::protocol::{
    Description, Descriptions, EdsBank, EdsError, EdsField, EdsValue, PositionFilter, RegisterAddress, StatusBitMeaning,
};
use crate::devices::biss::state::TEXTS;
use crate::devices::biss::state::explain as words;

pub(super) fn job_name(job: &BissJob) -> Text {
    match job {
        BissJob::Survey | BissJob::Identify => Text::new("job.survey"),
        BissJob::Status => TEXTS.text("job.biss_status"),
        BissJob::Check => Text::new("job.check"),
        BissJob::Position => Text::new("job.position"),
        BissJob::Read(range) => Text::new("job.read").with("item", range),
        BissJob::ReadDirect => TEXTS.text("job.read_direct"),
        BissJob::ReadBank(bank) => TEXTS.text("job.read_bank").with("bank", format!("0x{bank:02X}")),
        BissJob::ReadArea(area) => Text::new("job.read").with_text("item", words::name_text(&area.name)),
        BissJob::Save | BissJob::SaveToCompare => Text::new("job.save"),
        BissJob::Prepare(change) => Text::new("job.prepare").with_text("change", words::change_text(change)),
        BissJob::Commit(_) => Text::new("job.write"),
        BissJob::ReturnToOperation => Text::new("job.lead_back"),
    }
}

pub(super) fn edit_error_text(error: MemoryError) -> Text {
    match error {
        MemoryError::NotRead(at) => TEXTS.text("registers.unread").with("address", at),
        MemoryError::NoData(at) => TEXTS.text("registers.no_data").with("address", at),
    }
}

pub fn filter(filter: PositionFilter) -> Text {
    match filter {
        PositionFilter::Balanced => TEXTS.text("biss_status.balanced"),
        PositionFilter::Dynamic => TEXTS.text("biss_status.dynamic"),
        PositionFilter::Unknown(code) => TEXTS.text("eds.unknown").with("code", format!("0x{code:02X}")),
    }
}

/// Returns the reason why a data sheet bank is invalid.
pub fn data_sheet_error_text(error: &EdsError) -> Text {
    match error {
        EdsError::Checksum { expected, got, .. } => TEXTS
            .text("sheet_card.bad_sum")
            .with("expected", format!("0x{expected:02X}"))
            .with("got", format!("0x{got:02X}")),
        other => literal_text(other),
    }
}

pub fn eds_value_text(value: EdsValue) -> Text {
    let text = |id| TEXTS.text(id);
    match value {
        EdsValue::Number(1, "banks") => text("eds.one_bank"),
        EdsValue::Number(1, "slave addresses") => text("eds.one_address"),
        EdsValue::Number(number, "banks") => text("eds.banks").with("count", number),
        EdsValue::Number(number, "slave addresses") => text("eds.addresses").with("count", number),
        EdsValue::Number(number, "") => literal_text(number),
        EdsValue::Number(number, unit) => literal_text(format!("{number} {unit}")),
        EdsValue::Bank(bank) => literal_text(format!("0x{bank:02X}")),
        EdsValue::NotAvailable => text("eds.none"),
        EdsValue::Ticks(ticks) => text("eds.ticks").with("ticks", ticks),
        EdsValue::Adaptive => text("eds.adaptive"),
        EdsValue::NoLimit => text("eds.no_limit"),
        EdsValue::Kelvin(kelvin) => literal_text(format!("{kelvin} K  {} °C", value.to_celsius().unwrap_or_default())),
        EdsValue::Polynomial(0) => text("eds.no_crc"),
        EdsValue::Polynomial(polynomial) => literal_text(format!("0x{polynomial:X}")),
        EdsValue::Profile(profile) => literal_text(profile),
        EdsValue::Feedback(StatusBitMeaning::None) => text("eds.no_bit"),
        EdsValue::Feedback(StatusBitMeaning::Error) => text("eds.error_bit"),
        EdsValue::Feedback(StatusBitMeaning::Warning) => text("eds.warning_bit"),
        EdsValue::Feedback(StatusBitMeaning::Unknown(code)) => {
            TEXTS.text("eds.unknown").with("code", format!("0x{code:02X}"))
        }
        EdsValue::EncoderType(0) => text("eds.rotary"),
        EdsValue::EncoderType(code) => TEXTS.text("eds.unknown").with("code", format!("0x{code:02X}")),
        EdsValue::Code(code) => literal_text(format!("0x{code:X}")),
    }
}

/// Returns the meaning of a data sheet field, or `None` if its number is self-explanatory.
pub(super) fn explained_value_text(value: EdsValue) -> Option<Text> {
    match value {
        EdsValue::Number(_, "") => None,
        EdsValue::Ticks(_) => Some(TEXTS.text("eds.no_unit")),
        _ => Some(eds_value_text(value)),
    }
}

/// Returns the name of a data sheet field, as used in the manual.
pub fn eds_field_name(bank: EdsBank, field: &EdsField) -> Text {
    let at = RegisterAddress::in_bank(bank.kit_number(), field.offset);
    let described = at.zip(KIT_DESCRIPTION.as_ref()).and_then(|(at, kit)| kit.register_at(at));
    described.map_or_else(|| literal_text(field.name), |register| words::name_text(&register.name))
}

/// The built-in description of the kit encoder, which provides the names of data sheet fields in both languages. All
/// data sheets have these fields.
static KIT_DESCRIPTION: LazyLock<Option<Description>> =
    LazyLock::new(|| Descriptions::built_in().iter().find(|own| own.identity().is_some()).cloned());
