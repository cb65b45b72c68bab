//! Tests with tables from spreadsheets and drawings, and with errors in them.

use super::{CamTable, Column, TableNote, TableOptions, TableProblem, TableProblemKind, emit_table};
use crate::analysis::capture::Delimiter;
use crate::devices::interbus::profile::{CamNames, Direction, Image, OutsideRangeError, Parameters, Scale, Unit};
use crate::devices::interbus::protocol::{Cam, CamNumber, Program, ProgramNumber, Value};

fn number(program: u8) -> ProgramNumber {
    ProgramNumber::new(program).unwrap()
}

fn cam(cam: u8) -> CamNumber {
    CamNumber::new(cam).unwrap()
}

fn options(scale: Scale, range: u32) -> TableOptions {
    TableOptions { scale, range, program: number(1) }
}

fn steps(text: &str) -> CamTable {
    options(Scale::default(), 1000).read(text)
}

/// Returns the program, cam, name, start and stop of each row.
fn rows(table: &CamTable) -> Vec<(u8, u8, &str, u32, u32)> {
    let row = |row: &'_ super::TableRow| (row.program.get(), row.cam.get(), row.start.step, row.stop.step);
    table.rows.iter().map(|own| (row(own), own.name.as_str())).map(|((p, c, a, b), name)| (p, c, name, a, b)).collect()
}

#[test]
fn finds_columns_by_name_or_position() {
    for (text, expected) in [
        ("program,cam,name,start,stop\n2,3,feed,10,20\n", (2, 3, "feed", 10, 20)),
        ("Programm;Nocken;Spur;Ein;Aus\n2;3;Vorschub;10;20\n", (2, 3, "Vorschub", 10, 20)),
        ("Stop\tStart\tName\n20\t10\tfeed\n", (1, 0, "feed", 10, 20)),
        ("Start [steps];Stop [steps]\n10;20\n", (1, 0, "", 10, 20)),
        ("10,20", (1, 0, "", 10, 20)),
        ("5;10;20", (1, 5, "", 10, 20)),
        ("feed\t10\t20", (1, 0, "feed", 10, 20)),
        ("3;feed;10;20", (3, 0, "feed", 10, 20)),
        ("3;7;10;20", (3, 7, "", 10, 20)),
        ("3;7;\"a;b \"\"c\"\"\";10;20\r\n", (3, 7, "a;b \"c\"", 10, 20)),
        ("\u{FEFF}cam;start;stop\r\n\r\n Cam 6 ; 10 ; 20 \r\n;;\r\n", (1, 6, "", 10, 20)),
        ("Signal,From,To,Comment\nfeed,10,20,as before\n", (1, 0, "feed", 10, 20)),
    ] {
        let table = steps(text);
        assert_eq!((rows(&table), &table.problems), (vec![expected], &vec![]), "{text:?}");
        assert_eq!(table.header, text.to_lowercase().contains("sta") || text.contains("Ein") || text.contains("From"));
    }
}

#[test]
fn accepts_unambiguous_decimal_comma() {
    let degrees = options(Scale::in_degrees(3600.0, 0).unwrap(), 3600);
    for (text, delimiter) in [
        ("10,5;20,25°", Delimiter::Semicolon),
        ("10.5\t20.25", Delimiter::Tab),
        ("10.5,20.25", Delimiter::Comma),
        ("10.5 deg;2,025e1", Delimiter::Semicolon),
    ] {
        let table = degrees.read(text);
        assert_eq!(rows(&table), [(1, 0, "", 105, 203)], "{text}: {:?}", table.problems);
        assert_eq!(table.delimiter, Some(delimiter));
    }
    // If commas separate the columns, they cannot be decimal commas, so this row has five columns.
    assert_eq!(rows(&steps("1,2,3,20,25")), [(1, 2, "3", 20, 25)]);
}

#[test]
fn reports_rounded_edges() {
    // There are 8192 steps per turn, and the zero of the machine is at 1000. 10° are 227.56 steps, and 228 steps are
    // 10.0195°. 350° are 7964.44 steps, and 7964 steps are 349.9805°.
    let table = options(Scale::in_degrees(8192.0, 1000).unwrap(), 8192).read("feed;350;10\nplain;0;90");
    assert_eq!(rows(&table), [(1, 0, "feed", 772, 1228), (1, 1, "plain", 1000, 3048)]);
    let row = &table.rows[0];
    assert!((row.start.off + 0.019_531_25).abs() < 1e-9 && (row.stop.off - 0.019_531_25).abs() < 1e-9, "{row:?}");
    assert_eq!((row.start.requested, row.stop.requested), (350.0, 10.0));
    assert_eq!(table.rounded_rows().map(|row| row.line).collect::<Vec<_>>(), [1]);
    assert!((table.max_rounding_error() - 0.019_531_25).abs() < 1e-9);
    let table = options(Scale::in_millimetres(12.5, 0).unwrap(), 10_000).read("feed;100;200,03");
    assert_eq!(rows(&table), [(1, 0, "feed", 1250, 2500)]);
    assert!((table.rows[0].stop.off + 0.03).abs() < 1e-9);
}

#[test]
fn full_turn_pulse_ends_one_step_early() {
    let degrees = options(Scale::in_degrees(1000.0, 0).unwrap(), 1000);
    for (text, start, stop) in [("0;360", 0, 999), ("90;450", 250, 249), ("-90;270", 750, 749), ("350;370", 972, 28)] {
        assert_eq!(rows(&degrees.read(text)), [(1, 0, "", start, stop)], "{text}");
    }
    // The stop at 360° becomes the last step at 359.64°.
    assert!((degrees.read("0;360").rows[0].stop.off + 0.36).abs() < 1e-9);
}

#[test]
fn two_pulses_per_track_use_two_cams() {
    let table = steps("name;start;stop\nGlue;10;20\nfeed;0;500\nglue;40;50\n");
    assert_eq!(rows(&table), [(1, 0, "Glue", 10, 20), (1, 1, "feed", 0, 500), (1, 2, "glue", 40, 50)]);
    let cams = vec![cam(0), cam(2)];
    assert_eq!(table.notes, [TableNote::Pulses { program: number(1), name: "Glue".to_owned(), cams }]);
    // Pulses of different programs do not share a track, even if they have the same name.
    assert_eq!(steps("1;glue;10;20\n2;glue;40;50").notes, []);
}

#[test]
fn unnumbered_cams_take_unused_numbers() {
    let table = steps("cam;name;start;stop\n;a;1;2\n0;b;3;4\n;c;5;6\n2;d;7;8\n");
    assert_eq!(rows(&table), [(1, 1, "a", 1, 2), (1, 0, "b", 3, 4), (1, 3, "c", 5, 6), (1, 2, "d", 7, 8)]);
    let filled = table.to_programs();
    assert_eq!(filled.len(), 1);
    assert_eq!(filled[0].cams.iter().flatten().count(), 4);
    assert_eq!((filled[0].names[3].as_str(), filled[0].names[7].as_str()), ("c", ""));
}

fn problem(line: u64, column: u64, what: TableProblemKind) -> TableProblem {
    TableProblem { line, column, kind: what }
}

#[test]
fn keeps_valid_rows_despite_errors() {
    let text = "program;cam;name;start;stop\n\
        9;0;a;1;2\n\
        1;8;b;1;2\n\
        1;x;c;1;2\n\
        1;1;d;one;2\n\
        1;2;e;1\n\
        1;3;f;1000;2\n\
        1;4;g;1;-1\n\
        1;5;fine;1;2\n\
        1;5;again;3;4\n\
        nan;5;h;1;2\n\
        1;6;i;inf;2\n";
    let table = steps(text);
    let told = |text: &str| text.to_owned();
    let outside = |value| OutsideRangeError { value, least: 0.0, most: 999.0 };
    let expected = [
        problem(2, 1, TableProblemKind::Program { text: told("9") }),
        problem(3, 2, TableProblemKind::Cam { text: told("8") }),
        problem(4, 2, TableProblemKind::Cam { text: told("x") }),
        problem(5, 4, TableProblemKind::Number { text: told("one") }),
        problem(6, 5, TableProblemKind::Missing(Column::Stop)),
        problem(7, 4, TableProblemKind::Outside { column: Column::Start, outside: outside(1000.0) }),
        problem(8, 5, TableProblemKind::Outside { column: Column::Stop, outside: outside(-1.0) }),
        problem(10, 2, TableProblemKind::Twice { program: number(1), cam: cam(5), first: 9 }),
        problem(11, 1, TableProblemKind::Program { text: told("nan") }),
        problem(12, 4, TableProblemKind::Number { text: told("inf") }),
    ];
    assert_eq!(table.problems, expected);
    assert_eq!(rows(&table), [(1, 5, "fine", 1, 2)]);
}

#[test]
fn rejects_ninth_cam() {
    let text: String = (0..9).map(|row| format!("track {row};{};{}\n", row * 10, row * 10 + 5)).collect();
    let table = steps(&text);
    assert_eq!(table.rows.len(), 8);
    assert_eq!(table.problems, [problem(9, 1, TableProblemKind::Full(number(1)))]);
}

#[test]
fn reports_empty_table() {
    for text in ["", "\n \n", ";;\n", "name;start;stop\n"] {
        assert_eq!(steps(text).problems[0].kind, TableProblemKind::Empty, "{text:?}");
    }
    let table = steps("name;start\nfeed;5\n");
    assert_eq!(table.problems, [problem(1, 1, TableProblemKind::NoColumn(Column::Stop))]);
    let long = format!("{};1;2", "n".repeat(41));
    assert_eq!(steps(&long).problems, [problem(1, 1, TableProblemKind::Name { most: 40 })]);
    let long = steps(&format!("1;{};2", "x".repeat(100)));
    let TableProblemKind::Number { text } = &long.problems[0].kind else { panic!("{:?}", long.problems) };
    assert_eq!(text.chars().count(), 25, "only the beginning is told");
}

#[test]
fn reports_unit_mismatch_in_header() {
    let table = options(Scale::in_degrees(1000.0, 0).unwrap(), 1000).read("name;start [mm];stop [mm]\nfeed;36;72\n");
    assert_eq!(rows(&table), [(1, 0, "feed", 100, 200)]);
    assert_eq!(table.notes, [TableNote::OtherUnit { header: Unit::Millimetres, used: Unit::Degrees }]);
    assert_eq!(steps("start (steps);stop (steps)\n1;2").notes, []);
}

#[test]
fn emitted_tables_round_trip() {
    let parameters =
        |steps| Parameters { steps, revolutions: 4096, direction: Direction::Clockwise, preset: 0, zero_shift: 0 };
    let edges = |start, stop| Some(Cam { start: Value::new(start).unwrap(), stop: Value::new(stop).unwrap() });
    for (range, scale) in [
        (1000, Scale::default()),
        (1000, Scale::in_degrees(1000.0, 300).unwrap()),
        (8192, Scale::in_degrees(8192.0, 4000).unwrap()),
        (33_554_431, Scale::in_degrees(33_554_431.0, 5).unwrap()),
        (20_000, Scale::in_millimetres(7.77, 1234).unwrap()),
    ] {
        let mut image = Image::from_parameters(parameters(range));
        let mut program = Program { mask: 0b1000_0101, ..Program::default() };
        program.cams[0] = edges(range - 7, 3);
        program.cams[2] = edges(range / 3, range / 2);
        program.cams[4] = edges(1, 2);
        program.cams[7] = edges(17, 16);
        *image.program_mut(number(6)).unwrap() = Some(program);
        let mut names = CamNames::default();
        names.set_cam(number(6), cam(2), "a;b, \"c\"".to_owned());
        for comma in [false, true] {
            let text = emit_table(&image, &names, &scale, comma);
            let table = options(scale, range).read(&text);
            assert!(table.problems.is_empty() && table.notes.is_empty() && table.header, "{text}{:?}", table.problems);
            let expected = [(6, 0, "", range - 7, 3), (6, 2, "a;b, \"c\"", range / 3, range / 2), (6, 7, "", 17, 16)];
            assert_eq!(rows(&table), expected, "{text}");
        }
    }
}

#[test]
fn pasted_text_never_panics() {
    use proptest::prelude::*;
    proptest!(|(text in "[0-9,;\t\n\"°a-z. -]{0,200}")| {
        let table = steps(&text);
        prop_assert!(table.rows.iter().all(|row| row.start.step < 1000 && row.stop.step < 1000));
        prop_assert!(table.rows.iter().all(|row| row.line as usize <= text.lines().count()));
    });
    let table = steps("\"never closed;1;2\n1;2");
    assert_eq!((rows(&table), &table.notes), (vec![(1, 0, "", 1, 2)], &vec![TableNote::OtherHeader]));
}
