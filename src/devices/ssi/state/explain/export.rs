//! Texts of exported files in both languages. The English texts are the same as on the command line.

use super::code_text;
use crate::app::Text;
use crate::devices::ssi::protocol::{Code, ExportText, SettingMeaning, UnsupportedModuleFeature};
use crate::devices::ssi::state::TEXTS;

pub fn export_text(text: &ExportText) -> Text {
    let own = |id| TEXTS.text(id);
    match text {
        ExportText::SheetTitle(title) => own("ssi_sheet.title").with("title", title),
        ExportText::SheetPurpose => own("ssi_sheet.purpose"),
        ExportText::FrameLength => own("ssi_sheet.frame_length"),
        ExportText::Bits(bits) => own("ssi_sheet.bits").with("bits", bits),
        ExportText::Code => own("ssi_form.code"),
        ExportText::CodeName(Code::Binary) => own("ssi_sheet.dual"),
        ExportText::CodeName(other) => code_text(*other),
        ExportText::LowestBit => own("ssi_sheet.lowest"),
        ExportText::HighestBit => own("ssi_sheet.highest"),
        ExportText::BitNumber(bit) => own("ssi_sheet.bit").with("bit", bit),
        ExportText::ParityBit => own("ssi_sheet.parity_bit"),
        ExportText::Parity => own("ssi_form.parity"),
        ExportText::ParityIs { even: true } => own("ssi_form.parity_even"),
        ExportText::ParityIs { even: false } => own("ssi_form.parity_odd"),
        ExportText::NoParity => own("ssi_form.parity_none"),
        ExportText::Monoflop => own("ssi_sheet.monoflop"),
        ExportText::MonoflopTimes { least, most } => {
            own("ssi_sheet.monoflop_times").with_formatted_number("least", least).with_formatted_number("most", most)
        }
        ExportText::HighestClock => own("ssi_sheet.highest_clock"),
        ExportText::ClockLimit { kilohertz } => own("ssi_sheet.clock_limit").with("khz", kilohertz),
        ExportText::Counting { first } => own("ssi_sheet.counting").with("first", first),
        ExportText::Obstacle(why) => own(match why {
            UnsupportedModuleFeature::GrayExcess => "ssi_sheet.gray_excess",
            UnsupportedModuleFeature::Bcd => "ssi_sheet.bcd",
            UnsupportedModuleFeature::GrayOver => "ssi_sheet.gray_over",
            UnsupportedModuleFeature::Inverted => "ssi_sheet.inverted",
            UnsupportedModuleFeature::Between => "ssi_sheet.between",
        }),
        ExportText::ReadAsBinary => own("ssi_sheet.as_binary"),
        ExportText::CodeType => own("ssi_sheet.code_type"),
        ExportText::FrameBits { bits, fits: true } => own("ssi_sheet.frame_bits").with("bits", bits),
        ExportText::FrameBits { bits, fits: false } => own("ssi_sheet.frame_bits_unfit").with("bits", bits),
        ExportText::BitNumberLowest => own("ssi_sheet.number_lowest"),
        ExportText::BitNumberHighest => own("ssi_sheet.number_highest"),
        ExportText::HighestNumber { bit, fits: true } => own("ssi_sheet.number").with("bit", bit),
        ExportText::HighestNumber { bit, fits: false } => own("ssi_sheet.number_unfit").with("bit", bit),
        ExportText::Setting(number, value) => {
            own("ssi_sheet.setting").with("number", number).with_text("value", setting_text(*value))
        }
        ExportText::FrameTypeNone { bits } => own("ssi_sheet.no_type").with("bits", bits),
        ExportText::LastIsError => own("ssi_sheet.last_is_error"),
        ExportText::InTheProgram => own("ssi_sheet.program"),
        ExportText::Divide { by, bits } => own("ssi_sheet.divide").with("by", by).with("bits", bits),
        ExportText::Field { bits: 1, highest } => own("ssi_sheet.field_one").with("highest", highest),
        ExportText::Field { bits, highest } => own("ssi_sheet.field").with("bits", bits).with("highest", highest),
        ExportText::NoField => own("ssi_sheet.bits").with("bits", 0),
        ExportText::Binary => own("ssi_form.binary"),
        ExportText::TableHeading => own("ssi_sheet.table"),
        ExportText::ClockLine => own("ssi_sheet.clock_line"),
        ExportText::DataLine => own("ssi_sheet.data_line"),
        ExportText::BurstSpan { clocks, micros } => {
            own("ssi_sheet.burst").with("clocks", clocks).with_number("micros", *micros, 2)
        }
        ExportText::PauseSpan { micros, monoflop_micros } => {
            own("ssi_sheet.pause").with_number("micros", *micros, 1).with_number("monoflop", *monoflop_micros, 0)
        }
    }
}

fn setting_text(value: SettingMeaning) -> Text {
    match value {
        SettingMeaning::Gray => TEXTS.text("ssi_form.gray"),
        SettingMeaning::Binary => TEXTS.text("ssi_form.binary"),
        SettingMeaning::Multiturn => TEXTS.text("ssi_sheet.multiturn"),
        SettingMeaning::Singleturn => TEXTS.text("ssi_sheet.singleturn"),
        SettingMeaning::Variable(bits) => TEXTS.text("ssi_sheet.variable").with("bits", bits),
        SettingMeaning::NoParity => TEXTS.text("ssi_form.parity_none"),
        SettingMeaning::Even => TEXTS.text("ssi_form.parity_even"),
        SettingMeaning::Odd => TEXTS.text("ssi_form.parity_odd"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};
    use crate::devices::ssi::protocol::english_text;

    /// The English texts in the catalogue match those of the command line.
    #[test]
    fn both_languages_have_same_content() {
        let codes = [Code::Binary, Code::Gray, Code::GrayExcess, Code::Bcd].map(ExportText::CodeName);
        let obstacles = [
            UnsupportedModuleFeature::GrayExcess,
            UnsupportedModuleFeature::Bcd,
            UnsupportedModuleFeature::GrayOver,
            UnsupportedModuleFeature::Inverted,
            UnsupportedModuleFeature::Between,
        ];
        let values = [
            SettingMeaning::Gray,
            SettingMeaning::Binary,
            SettingMeaning::Multiturn,
            SettingMeaning::Singleturn,
            SettingMeaning::Variable(21),
            SettingMeaning::NoParity,
            SettingMeaning::Even,
            SettingMeaning::Odd,
        ];
        let others = [
            ExportText::SheetTitle("own".to_owned()),
            ExportText::SheetPurpose,
            ExportText::FrameLength,
            ExportText::Bits(21),
            ExportText::Code,
            ExportText::LowestBit,
            ExportText::HighestBit,
            ExportText::BitNumber(7),
            ExportText::ParityBit,
            ExportText::Parity,
            ExportText::ParityIs { even: true },
            ExportText::ParityIs { even: false },
            ExportText::NoParity,
            ExportText::Monoflop,
            ExportText::MonoflopTimes { least: 12.5, most: 25.0 },
            ExportText::HighestClock,
            ExportText::ClockLimit { kilohertz: 2000 },
            ExportText::Counting { first: 26 },
            ExportText::ReadAsBinary,
            ExportText::CodeType,
            ExportText::FrameBits { bits: 21, fits: true },
            ExportText::FrameBits { bits: 51, fits: false },
            ExportText::BitNumberLowest,
            ExportText::BitNumberHighest,
            ExportText::HighestNumber { bit: 7, fits: true },
            ExportText::HighestNumber { bit: 7, fits: false },
            ExportText::FrameTypeNone { bits: 51 },
            ExportText::LastIsError,
            ExportText::InTheProgram,
            ExportText::Divide { by: 8, bits: 3 },
            ExportText::Field { bits: 1, highest: 3 },
            ExportText::Field { bits: 14, highest: 14 },
            ExportText::NoField,
            ExportText::Binary,
            ExportText::TableHeading,
            ExportText::ClockLine,
            ExportText::DataLine,
            ExportText::BurstSpan { clocks: 27, micros: 67.5 },
            ExportText::PauseSpan { micros: 250.0, monoflop_micros: 25.0 },
        ];
        let obstacles = obstacles.map(ExportText::Obstacle);
        let values = values.map(|value| ExportText::Setting(2, value));
        for text in others.iter().chain(&codes).chain(&obstacles).chain(&values) {
            assert_eq!(export_text(text).to_string_in(English), english_text(text));
            let german = export_text(text).to_string_in(German);
            assert!(!german.contains('{') && !german.is_empty(), "{german}");
        }
    }
}
