//! Messages for errors in a description file.

use super::layout_error_text;
use crate::app::{Text, explain as general};
use crate::devices::biss::protocol::{DescriptionErrorKind, Register, UniqueItem};
use crate::devices::biss::state::TEXTS;

pub(super) fn description_problem_text(flaw: &DescriptionErrorKind) -> Text {
    match flaw {
        DescriptionErrorKind::Form(words) => general::literal_text(words),
        DescriptionErrorKind::Direct(address) => TEXTS.text("biss_flaw.direct").with("address", format_byte(*address)),
        DescriptionErrorKind::Banked { bank, offset } => {
            TEXTS.text("biss_flaw.banked").with("bank", format_byte(*bank)).with("offset", format_byte(*offset))
        }
        DescriptionErrorKind::Width { name, width } => {
            let text = TEXTS.text("biss_flaw.width").with("name", name).with("width", width);
            text.with("most", Register::MAX_WIDTH)
        }
        DescriptionErrorKind::BeyondBank { name, width, address } => {
            TEXTS.text("biss_flaw.beyond_bank").with("name", name).with("width", width).with("address", address)
        }
        DescriptionErrorKind::Default { name, bytes, width } => {
            TEXTS.text("biss_flaw.default").with("name", name).with("bytes", bytes).with("width", width)
        }
        DescriptionErrorKind::Bit { name, bit, width } => {
            TEXTS.text("biss_flaw.bit").with("name", name).with("bit", bit).with("width", width)
        }
        DescriptionErrorKind::NotFinite(name) => TEXTS.text("biss_flaw.endless").with("name", name),
        DescriptionErrorKind::SavesOnReadOnly(name) => TEXTS.text("biss_flaw.saves_nothing").with("name", name),
        DescriptionErrorKind::Banks { name, first, last } => TEXTS
            .text("biss_flaw.banks")
            .with("name", name)
            .with("first", format_byte(*first))
            .with("last", format_byte(*last)),
        DescriptionErrorKind::Layout(error) => layout_error_text(error),
        DescriptionErrorKind::Twice(claim) => TEXTS.text("biss_flaw.twice").with_text("claim", self::item_text(claim)),
        DescriptionErrorKind::GermanEmpty(name) => TEXTS.text("biss_flaw.german_empty").with("name", name),
        DescriptionErrorKind::UnusedGermanName(name) => TEXTS.text("biss_flaw.german_needless").with("name", name),
    }
}

fn item_text(claim: &UniqueItem) -> Text {
    match claim {
        UniqueItem::Register(address) => TEXTS.text("biss_flaw.register").with("address", address),
        UniqueItem::Role(role) => TEXTS.text("biss_flaw.role").with("role", format!("{role:?}")),
        UniqueItem::Bank(bank) => TEXTS.text("biss_flaw.bank").with("bank", format_byte(*bank)),
        UniqueItem::Procedure(kind) => TEXTS.text("biss_flaw.procedure").with("procedure", format!("{kind:?}")),
        UniqueItem::Name(name) => TEXTS.text("biss_flaw.name").with("name", name),
    }
}

fn format_byte(byte: u8) -> String {
    format!("0x{byte:02X}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::explain::assert_in_both_languages;
    use crate::devices::biss::protocol::{LayoutError, ProcedureKind, Role};

    #[test]
    fn explains_description_errors() {
        let (name, address) = ("y".to_owned(), "0x7F".parse().unwrap());
        let flaws = [
            DescriptionErrorKind::Direct(0x3F),
            DescriptionErrorKind::Banked { bank: 1, offset: 0x40 },
            DescriptionErrorKind::Width { name: name.clone(), width: 9 },
            DescriptionErrorKind::BeyondBank { name: name.clone(), width: 2, address },
            DescriptionErrorKind::Default { name: name.clone(), bytes: 2, width: 1 },
            DescriptionErrorKind::Bit { name: name.clone(), bit: 8, width: 1 },
            DescriptionErrorKind::NotFinite(name.clone()),
            DescriptionErrorKind::SavesOnReadOnly(name.clone()),
            DescriptionErrorKind::Banks { name: name.clone(), first: 5, last: 4 },
            DescriptionErrorKind::Layout(LayoutError::Empty),
            DescriptionErrorKind::Twice(UniqueItem::Register(address)),
            DescriptionErrorKind::Twice(UniqueItem::Role(Role::Mode)),
            DescriptionErrorKind::Twice(UniqueItem::Bank(5)),
            DescriptionErrorKind::Twice(UniqueItem::Procedure(ProcedureKind::Preset)),
            DescriptionErrorKind::Twice(UniqueItem::Name(name.clone())),
            DescriptionErrorKind::GermanEmpty(name.clone()),
            DescriptionErrorKind::UnusedGermanName(name),
        ];
        for own in flaws {
            assert_in_both_languages(&description_problem_text(&own), &own);
        }
    }
}
