//! Messages about an imported cam table.

use crate::analysis::capture::Delimiter;
use crate::app::Text;
use crate::devices::interbus::profile::{
    CamTable, Column, Scale, TableEdge, TableNote, TableProblem, TableProblemKind, TableRow, Unit,
};
use crate::devices::interbus::state::TEXTS;

/// Maximum number of displayed decimals.
const MAX_DECIMALS: usize = 6;

/// Describes how a table was read: its delimiter, and whether its columns have names.
pub fn layout_text(table: &CamTable) -> Text {
    let delimiter = match table.delimiter {
        Some(Delimiter::Tab) => "camtable.tab",
        Some(Delimiter::Semicolon) => "camtable.semicolon",
        Some(Delimiter::Comma) | None => "camtable.comma",
    };
    let id = if table.header { "camtable.with_header" } else { "camtable.without_header" };
    TEXTS.text(id).with("count", table.rows.len()).with_text("delimiter", TEXTS.text(delimiter))
}

/// Describes a problem in a table and where it is.
pub fn problem_text(problem: &TableProblem) -> Text {
    let text = TEXTS.text("camtable.problem").with("line", problem.line).with("column", problem.column);
    text.with_text("what", problem_kind_text(&problem.kind))
}

fn problem_kind_text(wrong: &TableProblemKind) -> Text {
    match wrong {
        TableProblemKind::Empty => TEXTS.text("camtable.empty"),
        TableProblemKind::NoColumn(own) => TEXTS.text("camtable.no_column").with_text("column", column(*own)),
        TableProblemKind::Missing(own) => TEXTS.text("camtable.missing").with_text("column", column(*own)),
        TableProblemKind::Number { text } => TEXTS.text("camtable.number").with("text", text),
        TableProblemKind::Program { text } => TEXTS.text("camtable.program").with("text", text),
        TableProblemKind::Cam { text } => TEXTS.text("camtable.cam").with("text", text),
        TableProblemKind::Outside { column: own, outside } => {
            let decimals = |value: f64| if value.fract() == 0.0 { 0 } else { 3 };
            let text = TEXTS.text("camtable.outside").with_text("column", column(*own));
            let text = text.with_number("value", outside.value, decimals(outside.value));
            let text = text.with_number("least", outside.least, decimals(outside.least));
            text.with_number("most", outside.most, decimals(outside.most))
        }
        TableProblemKind::Full(program) => TEXTS.text("camtable.full").with("program", program.get()),
        TableProblemKind::Twice { program, cam, first } => {
            let text = TEXTS.text("camtable.twice").with("program", program.get()).with("cam", cam.get());
            text.with("first", first)
        }
        TableProblemKind::Name { most } => TEXTS.text("camtable.name").with("most", most),
    }
}

pub fn note_text(note: &TableNote) -> Text {
    match note {
        TableNote::Pulses { program, name, cams } => {
            let cams: Vec<String> = cams.iter().map(|cam| cam.get().to_string()).collect();
            let text = TEXTS.text("camtable.pulses").with("program", program.get()).with("name", name);
            text.with("count", cams.len()).with("cams", cams.join(", "))
        }
        TableNote::OtherHeader => TEXTS.text("camtable.other_header"),
        TableNote::OtherUnit { header, used } => {
            let text = TEXTS.text("camtable.other_unit").with_text("header", unit(*header));
            text.with_text("used", unit(*used))
        }
    }
}

pub fn rounding_text(row: &TableRow, scale: &Scale) -> Text {
    let text = TEXTS.text("camtable.rounded").with("line", row.line).with("program", row.program.get());
    let text = text.with("cam", row.cam.get());
    text.with_text("start", edge_text(row.start, scale)).with_text("stop", edge_text(row.stop, scale))
}

/// Describes the given position of an edge, its rounded position and the difference.
pub fn edge_text(edge: TableEdge, scale: &Scale) -> Text {
    let decimals = scale.decimal_places() + 1;
    let id = if edge.is_rounded() { "camtable.edge_off" } else { "camtable.edge" };
    // The number has as many decimals as in the table, because rounding would hide the difference.
    let requested = decimals.max(decimal_count(edge.requested));
    let text = TEXTS.text(id).with_number("asked", edge.requested, requested).with("unit", scale.unit().symbol());
    let off = TEXTS.text(if edge.off < 0.0 { "camtable.less" } else { "camtable.more" });
    let off = off.with_number("off", edge.off.abs(), decimals + 1).with("unit", scale.unit().symbol());
    text.with("step", edge.step).with_text("off", off)
}

fn decimal_count(number: f64) -> usize {
    let written = number.to_string();
    written.split_once('.').map_or(0, |(_, decimals)| decimals.len()).min(MAX_DECIMALS)
}

fn column(column: Column) -> Text {
    TEXTS.text(match column {
        Column::Program => "camtable.column_program",
        Column::Cam => "camtable.column_cam",
        Column::Name => "camtable.column_name",
        Column::Start => "camtable.column_start",
        Column::Stop => "camtable.column_stop",
    })
}

pub fn unit(unit: Unit) -> Text {
    TEXTS.text(match unit {
        Unit::Steps => "camtable.steps",
        Unit::Degrees => "camtable.degrees",
        Unit::Millimetres => "camtable.millimetres",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::devices::interbus::profile::TableOptions;
    use crate::devices::interbus::protocol::ProgramNumber;

    #[test]
    fn describes_table_in_sentences() {
        let scale = Scale::in_degrees(8192.0, 1000).unwrap();
        let options = TableOptions { scale, range: 8192, program: ProgramNumber::new(2).unwrap() };
        let table = options.read("name;start;stop\nfeed;350;10\nglue;20;30\nglue;40;x\nGlue;100;110,5\n");
        let says = |text: Text| text.to_string_in(Language::English);
        assert_eq!(
            says(layout_text(&table)),
            "Pulses read: 3. The columns are separated by semicolons, and the first line contains their names."
        );
        assert_eq!(says(problem_text(&table.problems[0])), "Line 4, column 3: \"x\" is not a number.");
        let pulses = "Program 2: Glue has 2 pulses, which use cams 1, 2.";
        assert_eq!(table.notes.iter().map(note_text).map(says).collect::<Vec<_>>(), [pulses.replace("Glue", "glue")]);
        // 228 steps are 10.01953°.
        let rounded = "Line 2, program 2, cam 0: start 350.000° → step 772 (0.0195° lower), stop 10.000° → step 1228 \
                       (0.0195° higher)";
        assert_eq!(says(rounding_text(&table.rows[0], &scale)), rounded);
        let german = rounding_text(&table.rows[0], &scale).to_string_in(Language::German);
        assert!(german.contains("350,000° → Schritt 772 (0,0195° weniger)"), "{german}");
    }

    /// The message about rounding repeats the value as typed. For example, 10.05 is rounded to step 10, which is 0.05
    /// lower.
    #[test]
    fn rounding_shows_typed_value() {
        let scale = Scale::default();
        let options = TableOptions { scale, range: 3600, program: ProgramNumber::FIRST };
        let table = options.read("name;start;stop\nglue;10,05;20\n");
        let says = rounding_text(&table.rows[0], &scale).to_string_in(Language::English);
        assert!(says.contains("start 10.05 → step 10 (0.05 lower)"), "{says}");
    }

    #[test]
    fn each_problem_is_one_sentence() {
        let options = TableOptions { scale: Scale::default(), range: 1000, program: ProgramNumber::new(1).unwrap() };
        let table = options.read("program;cam;start;stop\n9;0;1;2\n1;8;1;2\n1;0;1000;2\n1;1;1\n1;2;1;2\n1;2;3;4\n");
        let told: Vec<String> =
            table.problems.iter().map(|own| problem_text(own).to_string_in(Language::English)).collect();
        let expected = [
            "Line 2, column 1: Cam program \"9\" does not exist. Choose a program from 1 to 8.",
            "Line 3, column 2: Cam \"8\" does not exist. Choose a cam from 0 to 7.",
            "Line 4, column 3: The value 1000 for start is outside the measuring range 0 to 999.",
            "Line 5, column 4: The value for stop is missing.",
            "Line 7, column 2: Cam 2 of program 1 is already defined in line 6. The definition in line 6 is used.",
        ];
        assert_eq!(told, expected);
    }
}
