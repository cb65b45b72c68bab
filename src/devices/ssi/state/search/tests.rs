//! Tests of frame files written by users, by this program and by logic analysers.

use super::*;

fn parse_frames(text: &str, clocks: u8) -> Result<(u8, Vec<u64>), Text> {
    super::parse_frames(text, clocks).map(|read| (read.clocks, read.frames))
}

fn of(text: &str, clocks: u8) -> Result<Frames, Text> {
    parse_frame_file(text, "own".to_owned(), clocks)
}

#[test]
fn reads_one_frame_per_line() {
    assert_eq!(parse_frames("1010\n\n# comment\n0b1111\n", 25), Ok((4, vec![0b1010, 0b1111])));
    assert_eq!(parse_frames("0B10_10\n1 1 1 1\n", 25), Ok((4, vec![0b1010, 0b1111])));
    assert_eq!(parse_frames("time;frame\n0.1;0x1F\n0.2;0x2\n", 25), Ok((25, vec![0x1F, 2])));
    assert_eq!(parse_frames("\u{feff}t,\"frame\"\n1,\"0x0B\"\n", 8), Ok((8, vec![0x0B])));
    // Additional columns are ignored.
    assert_eq!(parse_frames("frame,position\n10101,5\n10111,1010\n", 8), Ok((5, vec![0b10101, 0b10111])));
    assert_eq!(parse_frames("10101 17\n11111 -\n", 8), Ok((5, vec![0b10101, 0b11111])));
    assert_eq!(parse_frames("1010101010 11\n", 8), Ok((10, vec![0b10_1010_1010])));
    assert_eq!(parse_frames("1010 1010 11\n", 8), Ok((10, vec![0b10_1010_1011])));
}

#[test]
fn parses_clock_count() {
    assert_eq!(read_clocks(" 25 "), Ok(25));
    assert_eq!(read_clocks("0x40"), Ok(64));
    for (text, id) in [("0", "ssi_find.clocks_range"), ("65", "ssi_find.clocks_range"), ("many", "ssi_form.whole")] {
        assert_eq!(read_clocks(text).unwrap_err().id(), id, "{text}");
    }
}

#[test]
fn reports_invalid_line() {
    let said = |text: &str| parse_frames(text, 8).unwrap_err();
    let line = said("1010\n10\n");
    assert_eq!(line.id(), "ssi_find.line");
    assert!(line.terminal_text().contains('2'), "{}", line.terminal_text());
    assert_eq!(said("0x1\nx\n").id(), "ssi_find.line");
    assert_eq!(said("0x1FF\n").id(), "ssi_find.line");
    for text in ["", "# nothing\n", "heading\n"] {
        assert_eq!(said(text).id(), "ssi_find.no_frames");
    }
}

/// The header and two rows of `position ssi --csv`. The second row is the AHM36 frame in Gray code (reference section
/// 8). Its position 091D4B6h was decoded by hand, and its raw word 0D93EECh is 14237420 in decimal.
const OWN: &str =
    "t_s,raw,turns,steps,degrees,millimetres,valid\n0.000000,0,0,0,0,,true\n0.001000,14237420,291,10843,238.25,,true\n";

#[test]
fn reads_frames_from_position_table() {
    let read = of(OWN, 27).unwrap();
    assert_eq!((read.clocks, read.frames, read.are_numbers), (27, vec![0, 0x0D9_3EEC], true));
    let said = |text: &str| of(text, 27).unwrap_err();
    let cut = said(&OWN[..OWN.len() - 7]);
    assert_eq!(cut.id(), "ssi_capture.cut_off");
    assert!(
        cut.terminal_text().starts_with("The file is incomplete: line 3 has 5 columns instead of 7"),
        "{}",
        cut.terminal_text()
    );
    assert_eq!(said(&OWN.replace("238.25", "238,25")).id(), "ssi_capture.columns");
    assert_eq!(said(&OWN.replace(",0,0,0", ",,0,0")).id(), "ssi_find.line");
    assert_eq!(said("t_s,raw,turns\n").id(), "ssi_find.no_frames");
    // 14237420 needs 24 bits.
    let few = of(OWN, 23).unwrap_err().terminal_text();
    assert!(few.starts_with("Line 3: 14237420 has 24 bits") && few.contains("23 clocks"), "{few}");
}

/// A burst of 4 clocks at 500 kHz that transfers 1011, as recorded by a logic analyser (reference section 1).
const EDGES: [(f64, &str); 13] = [
    (0.0, "1,1"),
    (40.0, "0,1"),
    (41.0, "1,1"),
    (42.0, "0,1"),
    (43.0, "1,1"),
    (43.2, "1,0"),
    (44.0, "0,0"),
    (45.0, "1,0"),
    (45.3, "1,1"),
    (46.0, "0,1"),
    (47.0, "1,1"),
    (48.0, "1,0"),
    (68.0, "1,1"),
];

fn saleae_csv(heading: &str, delimiter: char, decimal: char) -> String {
    let rows = EDGES.map(|(micros, levels)| {
        let time = format!("{:.9}", micros * 1e-6).replace('.', &decimal.to_string());
        format!("{time}{delimiter}{}\n", levels.replace(',', &delimiter.to_string()))
    });
    format!("{heading}\n{}", rows.concat())
}

#[test]
fn reads_frames_from_logic_analyser() {
    let expected = |text: &str| {
        let read = of(text, 27).unwrap();
        assert_eq!((read.clocks, read.frames, read.left_out), (4, vec![0b1011], 0), "{text}");
    };
    expected(&saleae_csv("Time [s],Channel 0,Channel 1", ',', '.'));
    expected(&saleae_csv("\u{feff}\"Time [s]\",\"D0\",\"D1\"", ',', '.').replace('\n', "\r\n"));
    expected(&saleae_csv("Time [s];Channel 0;Channel 1", ';', ','));
    // The channels are swapped. They are identified by their names or by the number of changes.
    let exchanged = |heading: &str| {
        let rows = EDGES.map(|(micros, own)| format!("{:.9},{},{}\n", micros * 1e-6, &own[2..], &own[..1]));
        format!("{heading}\n{}", rows.concat())
    };
    expected(&exchanged("Time [s],DATA+,CLOCK+"));
    expected(&exchanged("Time [s],Channel 0,Channel 1"));
    // An additional channel never changes.
    let rows = saleae_csv("Time [s],Channel 0,Channel 1", ',', '.');
    let beside = |(number, row): (usize, &str)| format!("{row},{}\n", if number == 0 { "Channel 2" } else { "0" });
    expected(&rows.lines().enumerate().map(beside).collect::<String>());
    // sigrok exports contain times in a named unit, times in a unit that depends on the sample rate, or a row for each
    // sample.
    let comment = "; CSV generated by libsigrok 0.6.0\n; Channels (2/8): D0, D1\n; Samplerate: 10 MHz\n";
    let nanoseconds = EDGES.map(|(micros, own)| format!("{},{own}\n", (micros * 1e3).round())).concat();
    expected(&format!("{comment}nanoseconds,logic,logic\n{nanoseconds}"));
    expected(&format!("{comment}Time,D0,D1\n{nanoseconds}"));
    let samples: String = (0..700)
        .map(|sample| {
            let at = f64::from(sample) / 10.0 + 1e-6;
            EDGES.iter().rev().find(|(micros, _)| *micros <= at).map(|(_, own)| format!("{own}\n")).unwrap()
        })
        .collect();
    expected(&format!("{comment}D0,D1\n{samples}"));
    expected(&format!("{comment}{samples}"));
}

#[test]
fn invalid_recording_error_names_remedy() {
    let good = saleae_csv("Time [s],Channel 0,Channel 1", ',', '.');
    let cases = [
        ("Time [s],Channel 0\n0,1\n1,0\n".to_owned(), "ssi_capture.one_channel"),
        // The levels are analogue values.
        ("Time [s],Channel 0,Channel 1\n0,3.29,0.02\n".to_owned(), "ssi_capture.level"),
        // The file ends in the middle of a row.
        (good[..good.len() - 3].to_owned(), "ssi_capture.cut_off"),
        // The numbers have decimal commas, but commas also separate the columns.
        (good.replace("0.0000", "0,0000"), "ssi_capture.columns"),
        (good.replace("0.000040000", "12:00:01"), "ssi_capture.time"),
        (good.replace("0.000041000", "0.000039000"), "ssi_capture.back"),
        ("Time [s],Channel 0,Channel 1\n0,1,1\n1,1,1\n".to_owned(), "ssi_capture.no_edges"),
        ("Time [s],A,B,C\n0,1,1,0\n1,0,0,1\n2,1,1,0\n".to_owned(), "ssi_capture.channels"),
        ("Time,D0,D1\n0,1,1\n1,0,1\n".to_owned(), "ssi_capture.no_times"),
        // The clock never pauses.
        ("Time [s],CLK,DATA\n0,1,1\n1,0,1\n2,1,1\n3,0,1\n".to_owned(), "ssi_capture.no_pause"),
        ("Time [s],CLK,DATA\n0,1,1\n1,1,0\n".to_owned(), "ssi_capture.no_clock"),
    ];
    for (text, id) in cases {
        let why = of(&text, 27).unwrap_err();
        assert_eq!(why.id(), id, "{text}");
        for language in [crate::app::Language::English, crate::app::Language::German] {
            let words = why.to_string_in(language);
            let sentences = words.matches(". ").count() + words.matches(": ").count();
            assert!(sentences > 0 && words.ends_with('.') && !words.contains('{'), "{words}");
        }
    }
    let line = of(&good.replace("0.000041000", "0.000039000"), 27).unwrap_err().terminal_text();
    assert!(line.contains("line 4"), "{line}");
}

#[test]
fn rejects_huge_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("capture.csv");
    std::fs::File::create(&path).unwrap().set_len(crate::store::MAX_TEXT_BYTES + 1).unwrap();
    let why = read_frames(&path, 27).unwrap_err();
    assert_eq!(why.id(), "ssi_capture.too_large");
    assert!(why.terminal_text().contains("16 MB"), "{}", why.terminal_text());
}
