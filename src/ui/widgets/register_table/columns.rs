//! The columns of a table: the least important ones are hidden if they do not fit, and two share the rest of the width.

use egui::Rangef;

use super::RegisterKind;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Column {
    Marks,
    Address,
    Name,
    Value,
    Decimal,
    Meaning,
    Access,
    Range,
    Default,
}

/// Columns of bytes with their minimum widths, in order; that of the value follows from its kind.
const BYTES: [(Column, f32); 8] = [
    (Column::Marks, 38.0),
    (Column::Address, 80.0),
    (Column::Name, 118.0),
    (Column::Value, 60.0),
    (Column::Decimal, 96.0),
    (Column::Meaning, 130.0),
    (Column::Access, 48.0),
    (Column::Default, 84.0),
];
/// Those of numbers.
const NUMBERS: [(Column, f32); 7] = [
    (Column::Marks, 42.0),
    (Column::Address, 36.0),
    (Column::Name, 180.0),
    (Column::Value, 60.0),
    (Column::Meaning, 110.0),
    (Column::Range, 130.0),
    (Column::Default, 96.0),
];
/// The columns that are hidden, in this order. Their values move to the tooltip.
const LEAST: [Column; 4] = [Column::Decimal, Column::Default, Column::Access, Column::Range];
/// Share of the remaining width for the name; the meaning gets the rest.
const NAME: f32 = 0.45;

/// The columns that are there, from left to right.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Columns(Vec<(Column, Rangef)>);

impl Columns {
    /// Lays out the columns in this width, with this width for the value.
    pub(super) fn new(kind: RegisterKind, width: f32, value: f32) -> Self {
        let mut shown = all(kind).to_vec();
        for (column, own) in &mut shown {
            if *column == Column::Value {
                *own = own.max(value);
            }
        }
        for least in LEAST {
            if total(&shown) > width {
                shown.retain(|(column, _)| *column != least);
            }
        }
        let spare = (width - total(&shown)).max(0.0);
        let mut left = 0.0;
        let place = |(column, least): (Column, f32)| {
            let own = match column {
                Column::Name => least + (spare * NAME).floor(),
                Column::Meaning => least + spare - (spare * NAME).floor(),
                _ => least,
            };
            let range = Rangef::new(left, left + own);
            left = range.max;
            (column, range)
        };
        Columns(shown.into_iter().map(place).collect())
    }

    /// Returns whether columns are hidden.
    pub(super) fn hides(&self, kind: RegisterKind) -> bool {
        self.0.len() < all(kind).len()
    }

    /// Returns the range of a column, from the left of the table; `None` if it is hidden.
    pub(super) fn range(&self, column: Column) -> Option<Rangef> {
        self.0.iter().find(|(own, _)| *own == column).map(|(_, range)| *range)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (Column, Rangef)> {
        self.0.iter().copied()
    }

    pub(super) fn width(&self) -> f32 {
        self.0.last().map_or(0.0, |(_, range)| range.max)
    }
}

const fn all(kind: RegisterKind) -> &'static [(Column, f32)] {
    match kind {
        RegisterKind::Bytes { .. } => &BYTES,
        RegisterKind::Numbers => &NUMBERS,
    }
}

fn total(columns: &[(Column, f32)]) -> f32 {
    columns.iter().map(|(_, width)| width).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BYTES: RegisterKind = RegisterKind::Bytes { widest: 1 };

    fn shown(kind: RegisterKind, width: f32) -> Vec<Column> {
        Columns::new(kind, width, 100.0).iter().map(|(column, _)| column).collect()
    }

    #[test]
    fn the_least_important_columns_are_hidden_first() {
        use Column::*;
        // 38 + 80 + 118 + 100 + 96 + 130 + 48 + 84 = 694.
        assert_eq!(shown(BYTES, 694.0).len(), 8);
        assert_eq!(shown(BYTES, 693.0), [Marks, Address, Name, Value, Meaning, Access, Default]);
        assert_eq!(shown(BYTES, 597.0), [Marks, Address, Name, Value, Meaning, Access]);
        assert_eq!(shown(BYTES, 513.0), [Marks, Address, Name, Value, Meaning]);
        assert_eq!(shown(BYTES, -1.0), [Marks, Address, Name, Value, Meaning]);
        // 42 + 36 + 180 + 100 + 110 + 130 + 96 = 694.
        assert_eq!(shown(RegisterKind::Numbers, 694.0), [Marks, Address, Name, Value, Meaning, Range, Default]);
        assert_eq!(shown(RegisterKind::Numbers, 693.0), [Marks, Address, Name, Value, Meaning, Range]);
        assert_eq!(shown(RegisterKind::Numbers, 597.0), [Marks, Address, Name, Value, Meaning]);
        let hides = |width| Columns::new(RegisterKind::Numbers, width, 100.0).hides(RegisterKind::Numbers);
        assert!(!hides(694.0) && hides(693.0));
    }

    #[test]
    fn name_and_meaning_take_the_remaining_width() {
        let columns = Columns::new(BYTES, 794.0, 100.0);
        assert_eq!(columns.range(Column::Name), Some(Rangef::new(118.0, 281.0)));
        assert_eq!(columns.range(Column::Value), Some(Rangef::new(281.0, 381.0)));
        assert_eq!(columns.range(Column::Meaning), Some(Rangef::new(477.0, 662.0)));
        assert_eq!((columns.width(), Columns::new(BYTES, 100.0, 10.0).width()), (794.0, 426.0));
    }
}
