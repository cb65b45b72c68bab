//! The lines of a register table: group headings, registers, and the bit fields of unfolded registers. They are not
//! stored, so the computing time depends on the number of groups rather than registers.

use super::view::SelectedRow;
use super::{RegisterLocation, RegisterTable, RegisterView};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineKind {
    Group(usize),
    Row(RegisterLocation),
    /// A bit field of a register, given by its index.
    Bits(RegisterLocation, usize),
}

#[derive(Clone, Debug)]
pub(super) struct Lines {
    sections: Vec<Section>,
    total: usize,
}

#[derive(Clone, Debug)]
struct Section {
    start: usize,
    rows: usize,
    /// Unfolded registers, each with its number of bit fields.
    open: Vec<(usize, usize)>,
}

impl Lines {
    pub(super) fn new(table: &RegisterTable<'_>, view: &RegisterView) -> Self {
        let mut total = 0;
        let section = |(number, group): (usize, &super::RegisterGroup)| {
            let rows = if view.folded.contains(&number) { 0 } else { group.rows };
            let range = RegisterLocation { group: number, row: 0 }..RegisterLocation { group: number, row: rows };
            let fields = |place: &RegisterLocation| (place.row, (table.row)(*place).fields.len());
            let open: Vec<_> = if rows > 0 { view.open.range(range).map(fields).collect() } else { Vec::new() };
            let own = Section { start: total, rows, open };
            total += 1 + rows + own.open.iter().map(|(_, fields)| fields).sum::<usize>();
            own
        };
        let sections = table.groups.iter().enumerate().map(section).collect();
        Lines { sections, total }
    }

    pub(super) fn total(&self) -> usize {
        self.total
    }

    /// Returns the kind of the line with the given index, counted from zero.
    pub(super) fn kind_of(&self, line: usize) -> Option<LineKind> {
        let group = self.group_at(line)?;
        let section = self.sections.get(group)?;
        let Some(mut rest) = line.checked_sub(section.start + 1) else { return Some(LineKind::Group(group)) };
        for (row, fields) in &section.open {
            if rest <= *row {
                break;
            }
            if rest <= row + fields {
                return Some(LineKind::Bits(RegisterLocation { group, row: *row }, rest - row - 1));
            }
            rest -= fields;
        }
        Some(LineKind::Row(RegisterLocation { group, row: rest }))
    }

    pub(super) fn group_at(&self, line: usize) -> Option<usize> {
        if line >= self.total {
            return None;
        }
        self.sections.partition_point(|section| section.start <= line).checked_sub(1)
    }

    /// Returns the line on which an item is shown, or `None` if it is hidden.
    pub(super) fn line_index(&self, what: SelectedRow) -> Option<usize> {
        match what {
            SelectedRow::Group(group) => self.sections.get(group).map(|section| section.start),
            SelectedRow::Row(place) => {
                let section = self.sections.get(place.group).filter(|section| place.row < section.rows)?;
                let above = section.open.iter().take_while(|(row, _)| *row < place.row);
                Some(section.start + 1 + place.row + above.map(|(_, fields)| fields).sum::<usize>())
            }
        }
    }

    /// Returns the item that can be selected on a line. A bit field selects its register.
    pub(super) fn selection_at(&self, line: usize) -> Option<SelectedRow> {
        Some(match self.kind_of(line)? {
            LineKind::Group(group) => SelectedRow::Group(group),
            LineKind::Row(place) | LineKind::Bits(place, _) => SelectedRow::Row(place),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{RegisterBits, RegisterGroup, RegisterKind, RegisterRow};
    use super::*;

    fn group(rows: usize) -> RegisterGroup {
        RegisterGroup { rows, ..RegisterGroup::default() }
    }

    fn place(group: usize, row: usize) -> RegisterLocation {
        RegisterLocation { group, row }
    }

    #[test]
    fn lines_and_rows_map_both_ways() {
        let groups = [group(3), group(0), group(2), group(4)];
        let row = |own: RegisterLocation| RegisterRow {
            fields: vec![RegisterBits::default(); own.row + 1],
            ..Default::default()
        };
        let table = RegisterTable { label: "", groups: &groups, row: &row, kind: RegisterKind::Numbers };
        let mut view = RegisterView::default();
        view.set_folded(2, true);
        [place(0, 0), place(0, 1), place(3, 3), place(2, 1)].into_iter().for_each(|own| view.set_expanded(own, true));
        let lines = Lines::new(&table, &view);
        let expected = [
            LineKind::Group(0),
            LineKind::Row(place(0, 0)),
            LineKind::Bits(place(0, 0), 0),
            LineKind::Row(place(0, 1)),
            LineKind::Bits(place(0, 1), 0),
            LineKind::Bits(place(0, 1), 1),
            LineKind::Row(place(0, 2)),
            LineKind::Group(1),
            LineKind::Group(2),
            LineKind::Group(3),
            LineKind::Row(place(3, 0)),
            LineKind::Row(place(3, 1)),
            LineKind::Row(place(3, 2)),
            LineKind::Row(place(3, 3)),
            LineKind::Bits(place(3, 3), 0),
            LineKind::Bits(place(3, 3), 1),
            LineKind::Bits(place(3, 3), 2),
            LineKind::Bits(place(3, 3), 3),
        ];
        assert_eq!(lines.total(), expected.len());
        for (line, kind) in expected.into_iter().enumerate() {
            assert_eq!(lines.kind_of(line), Some(kind), "{line}");
            let back = match kind {
                LineKind::Group(group) => lines.line_index(SelectedRow::Group(group)),
                LineKind::Row(place) => lines.line_index(SelectedRow::Row(place)),
                LineKind::Bits(..) => Some(line),
            };
            assert_eq!(back, Some(line), "{kind:?}");
        }
        assert_eq!(lines.kind_of(expected.len()), None);
        assert_eq!(lines.line_index(SelectedRow::Row(place(2, 0))), None, "its group is folded");
        assert_eq!(lines.selection_at(4), Some(SelectedRow::Row(place(0, 1))));
        assert_eq!(Lines::new(&RegisterTable { groups: &[], ..table }, &view).kind_of(0), None);
    }
}
