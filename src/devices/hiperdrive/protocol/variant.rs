//! Variants of a drive (parameter 120, reference, section 4).

use super::scaling::Family;

/// Product variant of a drive, from parameter 120. Unknown numbers are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variant(u16);

/// Row of the variant table.
#[derive(Clone, Copy, Debug)]
pub struct VariantRow {
    /// Variant that this row describes.
    pub variant: Variant,
    /// Product name.
    pub name: &'static str,
    /// Drive family, which determines the travel. For HRA, the family is an assumption (`U`).
    pub family: Family,
}

const fn row(number: u16, name: &'static str, family: Family) -> VariantRow {
    VariantRow { variant: Variant(number), name, family }
}

/// All known variants.
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
    /// Variant 0, which stands for no connected drive.
    pub const NONE: Variant = Variant(0);
    /// Variant FFFFh, which the manual does not list.
    pub const OTHER: Variant = Variant(0xFFFF);

    /// Creates a variant from its number, even an unknown one.
    pub const fn new(number: u16) -> Self {
        Variant(number)
    }

    /// Returns the number.
    pub const fn number(self) -> u16 {
        self.0
    }

    /// Returns the table row, or `None` if no drive is connected or the variant is unknown.
    pub fn row(self) -> Option<&'static VariantRow> {
        VARIANTS.iter().find(|row| row.variant == self)
    }
}
