//! Which drive it is (parameter 120, reference 4).

use super::scaling::Family;

/// A drive's variant. Numbers that are not known are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variant(u16);

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct VariantRow {
    /// Which one.
    pub variant: Variant,
    /// As it is sold.
    pub name: &'static str,
    /// How far it turns (of HRA `U`).
    pub family: Family,
}

const fn row(number: u16, name: &'static str, family: Family) -> VariantRow {
    VariantRow { variant: Variant(number), name, family }
}

/// All of them.
pub const VARIANTS: [VariantRow; 13] = [
    row(1, "HRA25A", Family::Short),
    row(2, "HRA25B", Family::Short),
    row(3, "HRA25E", Family::Short),
    row(4, "HRA35A", Family::Short),
    row(5, "HRA35B", Family::Short),
    row(6, "HRA35E", Family::Short),
    row(7, "HDA30A", Family::Short),
    row(8, "HDA30B", Family::Short),
    row(9, "HDA30E", Family::Short),
    row(10, "HDA45A", Family::Short),
    row(11, "HDA45B", Family::Short),
    row(12, "HDA45E", Family::Short),
    row(13, "HDA70", Family::Long),
];

impl Variant {
    /// 0: no drive.
    pub const NONE: Variant = Variant(0);
    /// FFFFh: one that is in no table.
    pub const OTHER: Variant = Variant(0xFFFF);

    /// Any number is a variant.
    pub const fn new(number: u16) -> Self {
        Variant(number)
    }

    /// Its number.
    pub const fn number(self) -> u16 {
        self.0
    }

    /// Its row; `None` for no drive and for what is not known.
    pub fn row(self) -> Option<&'static VariantRow> {
        VARIANTS.iter().find(|row| row.variant == self)
    }
}
