//! The columns of a register table. The least important ones are hidden if space is short, and two columns share the
//! remaining width.

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

/// A column with its preferred and minimum width.
type ColumnWidth = (Column, f32, f32);

/// Columns of a byte table in display order. The width of the value column depends on the register kind.
const BYTES: [ColumnWidth; 8] = [
    (Column::Marks, 38.0, 34.0),
    (Column::Address, 80.0, 76.0),
    (Column::Name, 118.0, 92.0),
    (Column::Value, 60.0, 60.0),
    (Column::Decimal, 96.0, 72.0),
    (Column::Meaning, 130.0, 84.0),
    (Column::Access, 48.0, 40.0),
    (Column::Default, 84.0, 52.0),
];
const NUMBERS: [ColumnWidth; 7] = [
    (Column::Marks, 42.0, 40.0),
    (Column::Address, 36.0, 36.0),
    (Column::Name, 172.0, 152.0),
    (Column::Value, 60.0, 60.0),
    (Column::Meaning, 140.0, 64.0),
    (Column::Range, 146.0, 88.0),
    (Column::Default, 84.0, 78.0),
];
/// Columns in the order in which they are hidden if space is short. The tooltip shows the hidden values.
const HIDING_ORDER: [Column; 4] = [Column::Decimal, Column::Default, Column::Access, Column::Range];
/// Fraction of the remaining width for the name column. The meaning column receives the rest.
const NAME_SHARE: f32 = 0.45;

/// Visible columns, from left to right.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Columns {
    ranges: Vec<(Column, Rangef)>,
    /// Whether columns are hidden or narrower than usual.
    is_narrow: bool,
    /// Whether names are drawn in the small font because one of them does not fit otherwise.
    pub(super) has_small_names: bool,
}

impl Columns {
    /// Lays out the columns within `width`. `value` is the width of the value column.
    pub(super) fn new(kind: RegisterKind, width: f32, value: f32) -> Self {
        let mut shown = all_columns(kind).to_vec();
        for (column, usual, least) in &mut shown {
            if *column == Column::Value {
                (*usual, *least) = (usual.max(value), least.max(value));
            }
        }
        for least in HIDING_ORDER {
            if total(&shown).1 > width {
                shown.retain(|(column, ..)| *column != least);
            }
        }
        let (usual, least) = total(&shown);
        // In between, all columns are narrowed by the same fraction of the difference to their minimum.
        let share = if usual > least { ((width - least) / (usual - least)).clamp(0.0, 1.0) } else { 1.0 };
        let spare = (width - usual).max(0.0);
        let mut left = 0.0;
        let place = |(column, usual, least): ColumnWidth| {
            let own = least + ((usual - least) * share).floor();
            let own = match column {
                Column::Name => own + (spare * NAME_SHARE).floor(),
                Column::Meaning => own + spare - (spare * NAME_SHARE).floor(),
                _ => own,
            };
            let range = Rangef::new(left, left + own);
            left = range.max;
            (column, range)
        };
        let is_narrow = share < 1.0 || shown.len() < all_columns(kind).len();
        Columns { ranges: shown.into_iter().map(place).collect(), is_narrow, has_small_names: false }
    }

    pub(super) fn is_narrow(&self) -> bool {
        self.is_narrow
    }

    /// Returns the horizontal extent of a column, measured from the left edge of the table, or `None` if the column is
    /// hidden.
    pub(super) fn column_range(&self, column: Column) -> Option<Rangef> {
        self.ranges.iter().find(|(own, _)| *own == column).map(|(_, range)| *range)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (Column, Rangef)> {
        self.ranges.iter().copied()
    }

    pub(super) fn width(&self) -> f32 {
        self.ranges.last().map_or(0.0, |(_, range)| range.max)
    }
}

const fn all_columns(kind: RegisterKind) -> &'static [ColumnWidth] {
    match kind {
        RegisterKind::Bytes { .. } => &BYTES,
        RegisterKind::Numbers => &NUMBERS,
    }
}

/// Returns the total preferred and minimum widths of the given columns.
fn total(columns: &[ColumnWidth]) -> (f32, f32) {
    columns.iter().fold((0.0, 0.0), |sum, (_, usual, least)| (sum.0 + usual, sum.1 + least))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BYTES: RegisterKind = RegisterKind::Bytes { widest: 1 };

    fn shown(kind: RegisterKind, width: f32) -> Vec<Column> {
        Columns::new(kind, width, 100.0).iter().map(|(column, _)| column).collect()
    }

    #[test]
    fn hides_least_important_columns_first() {
        use Column::*;
        // 34 + 76 + 92 + 100 + 72 + 84 + 40 + 52 = 550.
        assert_eq!(shown(BYTES, 550.0).len(), 8);
        assert_eq!(shown(BYTES, 549.0), [Marks, Address, Name, Value, Meaning, Access, Default]);
        assert_eq!(shown(BYTES, 477.0), [Marks, Address, Name, Value, Meaning, Access]);
        assert_eq!(shown(BYTES, 425.0), [Marks, Address, Name, Value, Meaning]);
        assert_eq!(shown(BYTES, -1.0), [Marks, Address, Name, Value, Meaning]);
        // 40 + 36 + 152 + 100 + 64 + 88 + 78 = 558.
        assert_eq!(shown(RegisterKind::Numbers, 558.0), [Marks, Address, Name, Value, Meaning, Range, Default]);
        assert_eq!(shown(RegisterKind::Numbers, 557.0), [Marks, Address, Name, Value, Meaning, Range]);
        assert_eq!(shown(RegisterKind::Numbers, 479.0), [Marks, Address, Name, Value, Meaning]);
        // 42 + 36 + 172 + 100 + 140 + 146 + 84 = 720.
        let is_narrow = |width| Columns::new(RegisterKind::Numbers, width, 100.0).is_narrow();
        assert!(!is_narrow(720.0) && is_narrow(719.0) && is_narrow(500.0));
    }

    /// At 622, halfway between the usual width of 694 and the minimum of 550, each column has lost half of what it can.
    #[test]
    fn narrows_columns_before_hiding() {
        let columns = Columns::new(BYTES, 622.0, 100.0);
        let widths: Vec<f32> = columns.iter().map(|(_, range)| range.span()).collect();
        assert_eq!(widths, [36.0, 78.0, 105.0, 100.0, 84.0, 107.0, 44.0, 68.0]);
        for width in 550..800 {
            let columns = Columns::new(BYTES, width as f32, 100.0);
            assert!(columns.width() <= width as f32 && columns.width() > width as f32 - 8.0, "{width}");
        }
    }

    #[test]
    fn name_and_meaning_share_remaining_width() {
        let columns = Columns::new(BYTES, 794.0, 100.0);
        assert_eq!(columns.column_range(Column::Name), Some(Rangef::new(118.0, 281.0)));
        assert_eq!(columns.column_range(Column::Value), Some(Rangef::new(281.0, 381.0)));
        assert_eq!(columns.column_range(Column::Meaning), Some(Rangef::new(477.0, 662.0)));
        assert_eq!((columns.width(), Columns::new(BYTES, 100.0, 10.0).width()), (794.0, 346.0));
    }
}
