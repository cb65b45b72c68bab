//! Where the columns of a table stand: those that matter least fall away where there is no room, and two take what is left.

use egui::Rangef;

/// A column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Column {
    Marks,
    Address,
    Name,
    Hex,
    Decimal,
    Meaning,
    Access,
    Default,
}

/// Columns with their least widths, in their order; that of the bytes follows from them.
const WIDTHS: [(Column, f32); 8] = [
    (Column::Marks, 38.0),
    (Column::Address, 80.0),
    (Column::Name, 118.0),
    (Column::Hex, 60.0),
    (Column::Decimal, 96.0),
    (Column::Meaning, 130.0),
    (Column::Access, 48.0),
    (Column::Default, 84.0),
];
/// What falls away, the first first. It is under the pointer then.
const LEAST: [Column; 3] = [Column::Decimal, Column::Default, Column::Access];
/// The share of what is left that the name gets; the meaning gets the rest.
const NAME: f32 = 0.45;

/// The columns that are there, from left to right.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Columns(Vec<(Column, Rangef)>);

impl Columns {
    /// The columns in so much room, with so much for the bytes.
    pub(super) fn new(width: f32, hex: f32) -> Self {
        let mut shown = WIDTHS.to_vec();
        for (column, own) in &mut shown {
            if *column == Column::Hex {
                *own = own.max(hex);
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

    /// Where a column stands, from the left of the table; `None` where there is no room for it.
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

fn total(columns: &[(Column, f32)]) -> f32 {
    columns.iter().map(|(_, width)| width).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(width: f32) -> Vec<Column> {
        Columns::new(width, 100.0).iter().map(|(column, _)| column).collect()
    }

    #[test]
    fn what_matters_least_falls_away_first() {
        use Column::*;
        // 38 + 80 + 118 + 100 + 96 + 130 + 48 + 84 = 694.
        assert_eq!(shown(694.0).len(), 8);
        assert_eq!(shown(693.0), [Marks, Address, Name, Hex, Meaning, Access, Default]);
        assert_eq!(shown(597.0), [Marks, Address, Name, Hex, Meaning, Access]);
        assert_eq!(shown(513.0), [Marks, Address, Name, Hex, Meaning]);
        assert_eq!(shown(-1.0), [Marks, Address, Name, Hex, Meaning]);
    }

    #[test]
    fn name_and_meaning_take_what_is_left() {
        let columns = Columns::new(794.0, 100.0);
        assert_eq!(columns.range(Column::Name), Some(Rangef::new(118.0, 281.0)));
        assert_eq!(columns.range(Column::Hex), Some(Rangef::new(281.0, 381.0)));
        assert_eq!(columns.range(Column::Meaning), Some(Rangef::new(477.0, 662.0)));
        assert_eq!((columns.width(), Columns::new(100.0, 10.0).width()), (794.0, 426.0));
    }
}
