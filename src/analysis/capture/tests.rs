//! Tests with tables as written by instruments, and with files that are not tables.

use super::super::import::TableImport;
use super::*;
use crate::analysis::capture::Capture;

fn read_in_pieces(pieces: usize, text: &[u8], wishes: &TableHints) -> Result<(Layout, Capture), CaptureError> {
    let mut import = TableImport::from_head(text, wishes)?;
    for piece in text.chunks(pieces) {
        import.process(piece)?;
    }
    import.finish()
}

#[track_caller]
fn read(text: impl AsRef<[u8]>) -> Result<(Layout, Capture), CaptureError> {
    let text = text.as_ref();
    let whole = read_in_pieces(1 << 20, text, &TableHints::default());
    for pieces in [1, 7] {
        assert_eq!(read_in_pieces(pieces, text, &TableHints::default()), whole, "in pieces of {pieces}");
    }
    whole
}

/// All of these tables contain the rows 0 s, 0.25 V, 0.5 V and 0.001 s, −0.3 V, 0.4 V.
#[test]
fn equivalent_tables_parse_equally() {
    let ways: [(&str, &[u8]); 17] = [
        ("plain", b"0,0.25,0.5\n0.001,-0.3,0.4\n"),
        ("no last line break", b"0,0.25,0.5\n0.001,-0.3,0.4"),
        ("Windows", b"time,sin,cos\r\n0,0.25,0.5\r\n0.001,-0.3,0.4\r\n"),
        ("byte order mark", b"\xEF\xBB\xBFtime;sin;cos\n0;0.25;0.5\n0.001;-0.3;0.4\n"),
        ("German", b"Zeit;Sinus;Kosinus\n0;0,25;0,5\n0,001;-0,3;0,4\n"),
        ("tabs", b"t\tsin\tcos\n0\t0.25\t0.5\n1e-3\t-0.3\t+4E-1\n"),
        ("tabs and commas", b"0\t0,25\t0,5\n1e-3\t-0,3\t0,4\n"),
        ("units", b"time [ms],sin [mV],cos [mV]\n0,250,500\n1,-300,400\n"),
        ("microseconds", "t (\u{b5}s);sin (V);cos (V)\n0;0.25;0.5\n1000;-.3;.4\n".as_bytes()),
        ("Latin microseconds", b"t (\xB5s);sin (V);cos (V)\n0;0.25;0.5\n1000;-0.3;0.4\n"),
        ("line of units", b"Time,Channel A,Channel B\n(ms),(mV),(mV)\n\n0,250,500\n1,-300,400\n"),
        ("preamble", b"Model,X200\nFirmware,1.2\n\ntime,sin,cos\n0,0.25,0.5\n0.001,-0.3,0.4\n"),
        ("another order", b"cos,n,sin,t\n0.5,7,0.25,0\n0.4,8,-0.3,0.001\n"),
        ("quoted", b"\"t\",\"sin\",\"cos\"\n\"0\",\"0,25\",\"0,5\"\n\"0,001\",\"-0,3\",\"0,4\"\n"),
        ("spaces, blank lines, last delimiter", b"\n0 , 0.25 , 0.5 ,\n\n 0.001, -0.3 , 0.4 ,\n   \n"),
        ("comment", b"# t, sin, cos\n0,0.25,0.5\n0.001,-0.3,0.4\n"),
        ("four channels", b"t,SIN,REFSIN,COS,REFCOS\n0,2.75,2.5,3,2.5\n0.001,2.2,2.5,2.9,2.5\n"),
    ];
    for (label, text) in ways {
        let (_, capture) = read(text).unwrap_or_else(|error| panic!("{label}: {error}"));
        let near = |values: &[f64], expected: [f64; 2]| {
            values.len() == 2 && values.iter().zip(expected).all(|(value, expected)| (value - expected).abs() < 1e-12)
        };
        assert!(near(&capture.time_s, [0.0, 0.001]), "{label}: {capture:?}");
        assert!(near(&capture.sine_v, [0.25, -0.3]), "{label}: {capture:?}");
        assert!(near(&capture.cosine_v, [0.5, 0.4]), "{label}: {capture:?}");
        assert_eq!(capture.wires.is_some(), label == "four channels", "{label}");
    }
    let (_, capture) = read("t,SIN,REFSIN,COS,REFCOS\n0,0.1,2.5,3,2.5\n1,0.2,2.5,2.9,2.5\n").unwrap();
    // The voltages are taken from the table: (0.1 − 2.5) + 2.5 would be a different number.
    assert_eq!(capture.wires.unwrap().sin_v, [0.1, 0.2]);
}

#[test]
fn overrides_detected_layout() {
    let text = b"Time (ms);A (mV);B (mV)\n0;1,5;2\n1;3;4\n";
    let (layout, _) = read(text).unwrap();
    let expected = Layout {
        delimiter: Delimiter::Semicolon,
        decimal_comma: true,
        first_row: 2,
        names: ["Time (ms)", "A (mV)", "B (mV)"].map(str::to_owned).to_vec(),
        columns: Columns::TIME_SINE_COSINE,
        time_unit: TimeUnit::Milliseconds,
        volts_per_unit: 1e-3,
        clock: None,
    };
    assert_eq!(layout, expected);
    let wishes = TableHints {
        columns: Some(Columns { time: None, sine: 3, cosine: 2, ..Columns::TIME_SINE_COSINE }),
        volts_per_unit: Some(2.0),
        ..TableHints::default()
    };
    let (_, capture) = read_in_pieces(99, text, &wishes).unwrap();
    assert_eq!((capture.sine_v, capture.cosine_v, capture.time_s), (vec![4.0, 8.0], vec![3.0, 6.0], vec![]));
}

#[test]
fn errors_name_row_and_column() {
    let not_a_number = |row, column, text: &str| CaptureError::NotANumber { row, column, text: text.to_owned() };
    let not_finite = |row, column, text: &str| CaptureError::NotFinite { row, column, text: text.to_owned() };
    let cases: [(&str, CaptureError); 21] = [
        ("", CaptureError::Empty),
        (" \n\r\n", CaptureError::Empty),
        ("time,sin,cos\n", CaptureError::NoNumbers),
        ("no table at all", CaptureError::NoNumbers),
        ("1\n2\n3\n", CaptureError::OneColumn),
        ("sin\n0.5\n", CaptureError::OneColumn),
        ("1,2\n3,4\n", CaptureError::TooFewColumns { columns: 2 }),
        ("t,sin,cos\n0,abc,0.5\n", not_a_number(2, 2, "abc")),
        ("0,1,2\n1,2,x\n", not_a_number(2, 3, "x")),
        ("t,sin,cos\r\n0,1,2\r\n\r\n1,,2\r\n", not_a_number(4, 2, "")),
        ("0,1,2\n1,NaN,3\n", not_finite(2, 2, "NaN")),
        ("0,1,2\n1,2,-inf\n", not_finite(2, 3, "-inf")),
        ("0,1,2\n1,2,1.2.3", not_a_number(2, 3, "1.2.3")),
        ("0;1,5;2\n1;2;1.234,5", not_a_number(2, 3, "1.234,5")),
        ("0,1,2\n1,OVERLOAD,3\n", not_a_number(2, 2, "OVERLOAD")),
        ("0,1,2\n1,2,1.2.3\n", not_a_number(2, 3, "1.2.3")),
        ("0;1,5;2\n1;2;1.234,5\n", not_a_number(2, 3, "1.234,5")),
        ("0,1,2\n1,--2,3\n", not_a_number(2, 2, "--2")),
        ("t,sin,cos\nnan,0.1,0.2\n", not_finite(2, 1, "nan")),
        ("t,sin,cos\n,0.1,0.2\n1,2,3\n", not_a_number(2, 1, "")),
        ("0,1,2\n1,2\n", CaptureError::ShortRow { row: 2, columns: 2, needed: 3 }),
    ];
    for (text, expected) in cases {
        assert_eq!(read(text).unwrap_err(), expected, "{text:?}");
    }
    let long = format!("0,1,2\n1,{},3\n", "z".repeat(5000));
    assert_eq!(read(long).unwrap_err(), not_a_number(2, 2, &("z".repeat(24) + "…")));
}

#[test]
fn counts_rows_beyond_sniffed_head() {
    let mut text: String = (0..20_000).map(|at| format!("{at}e-6,0.{at},-0.{at}\n")).collect();
    let (_, capture) = read_in_pieces(4096, text.as_bytes(), &TableHints::default()).unwrap();
    assert_eq!(capture.sine_v.len(), 20_000);
    assert!((capture.time_s[19_999] - 0.019_999).abs() < 1e-12);
    text.push_str("0,?,0\n");
    let expected = CaptureError::NotANumber { row: 20_001, column: 2, text: "?".to_owned() };
    assert_eq!(read_in_pieces(4096, text.as_bytes(), &TableHints::default()).unwrap_err(), expected);
}

#[test]
fn recognizes_reference_and_position_columns() {
    let both = (Some(vec![359.5, 0.25]), Some(vec![7_i64, -8]));
    let cases: [(&str, _); 7] = [
        ("t,sin,cos,reference,absolute\n0,.1,.2,359.5,7\n1,.1,.2,0.25,-8\n", both.clone()),
        ("absolut;t;angle [deg];sin;cos\n7;0;359,5;0,1;0,2\n-8;1;0,25;0,1;0,2\n", both.clone()),
        ("t,sin,cos,ref_deg,Position\n0,.1,.2,359.5,7.0\n1,.1,.2,0.25,-8\n", both.clone()),
        ("t [s],sin [V],cos [V],Winkel (\u{b0}),abs\n0,.1,.2,359.5,7\n1,.1,.2,0.25,-8\n", both.clone()),
        ("t,sin,cos,ref [V],position\n0,.1,.2,2.5,7.5\n1,.1,.2,2.5,-8\n", (None, None)),
        ("t,sin,cos,angle,position\n0,.1,.2,,left\n1,.1,.2,1,1\n", (None, None)),
        ("0,.1,.2,359.5,7\n1,.1,.2,0.25,-8\n", (None, None)),
    ];
    for (text, expected) in cases {
        let (layout, capture) = read(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!((capture.reference_deg, capture.absolute), expected, "{text}");
        assert_eq!(layout.columns.reference_angle.is_some(), expected.0.is_some(), "{text}");
    }
    let wishes = TableHints {
        columns: Some(Columns { reference_angle: Some(4), absolute: Some(5), ..Columns::TIME_SINE_COSINE }),
        ..TableHints::default()
    };
    let (_, capture) = read_in_pieces(99, b"0,.1,.2,359.5,7\n1,.1,.2,0.25,-8\n", &wishes).unwrap();
    assert_eq!((capture.reference_deg, capture.absolute), both);
    let error = read_in_pieces(99, b"0,.1,.2,359.5,7\n1,.1,.2,0.25,-8.5\n", &wishes).unwrap_err();
    assert_eq!(error, CaptureError::NotWhole { row: 2, column: 5, text: "-8.5".to_owned() });
    let error = read("t,sin,cos,reference\n0,1,2,3\n1,1,2\n").unwrap_err();
    assert_eq!(error, CaptureError::ShortRow { row: 3, columns: 3, needed: 4 });
}

/// If an oscilloscope writes Start and Increment, the first column contains sample numbers (issue 22.13).
#[test]
fn start_and_increment_define_times() {
    let text =
        "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-6.000e-03,2.000e-06,\n0,0.1,0.2,,\n1,0.3,0.4,,\n2,0.5,0.6,,\n";
    let (layout, capture) = read(text).unwrap();
    assert_eq!(layout.clock, Some(SampleClock { start_s: -6e-3, increment_s: 2e-6 }));
    for (time, expected) in capture.time_s.iter().zip([-6e-3, -5.998e-3, -5.996e-3]) {
        assert!((time - expected).abs() < 1e-12, "{time}");
    }
    assert_eq!((capture.sine_v, capture.cosine_v), (vec![0.1, 0.3, 0.5], vec![0.2, 0.4, 0.6]));
    // The same in millivolts, with other separators.
    let (_, capture) = read("X;CH1;CH2;START;INCREMENT\nSequence;mV;mV;0;0,5\n0;1;2;;\n2;3;4;;\n").unwrap();
    assert_eq!((capture.time_s, capture.sine_v), (vec![0.0, 1.0], vec![0.001, 0.003]));
    // Sample numbers are never interpreted as seconds.
    for second in ["Sequence,Volt,Volt,,", "Sequence,Volt,Volt,now,soon", "Sequence,Volt,Volt,0,0"] {
        let text = format!("X,CH1,CH2,Start,Increment\n{second}\n0,0.1,0.2,,\n1,0.3,0.4,,\n");
        assert_eq!(read(text).unwrap_err(), CaptureError::NoSampleClock { row: 2 }, "{second}");
    }
    // A unit given by the user takes precedence.
    let wishes = TableHints { time_unit: Some(TimeUnit::Milliseconds), ..TableHints::default() };
    assert_eq!(read_in_pieces(99, text.as_bytes(), &wishes).unwrap().1.time_s, [0.0, 1e-3, 2e-3]);
}

/// Rows without a value and a truncated last line are skipped and counted. Six rows are enough for a measurement (issue
/// 22.13).
#[test]
fn skips_rows_without_value() {
    let six = "0,1,2\n1,2,3\n2,3,4\n3,4,5\n4,5,6\n5,6,7\n";
    for gap in ["6,,3", "6,NaN,3", "6,2,-inf", "6,OVERLOAD,3", "6,2,---", "6,2,\u{221e}", "6, ,3"] {
        let (_, capture) =
            read(format!("t,sin,cos\n{six}{gap}\n7,8,9\n")).unwrap_or_else(|error| panic!("{gap}: {error}"));
        assert_eq!((capture.skipped_rows, capture.time_s), (1, vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 7.0]), "{gap}");
        assert_eq!((capture.sine_v[6], capture.cosine_v[6], capture.sine_v.len()), (8.0, 9.0, 7), "{gap}");
    }
    for (broken, column) in [("6,#,3", 2), ("nan,2,3", 1), (",2,3", 1)] {
        let error = read(format!("t,sin,cos\n{six}{broken}\n7,8,9\n")).unwrap_err();
        let place = match error {
            CaptureError::NotANumber { row, column, .. } | CaptureError::NotFinite { row, column, .. } => (row, column),
            other => panic!("{broken}: {other}"),
        };
        assert_eq!(place, (8, column), "{broken}");
    }
    for cut in ["6,3", "6,3,-", "6,", "6,3,4e", "6"] {
        let (_, capture) = read(format!("t,sin,cos\n{six}{cut}")).unwrap();
        assert_eq!((capture.sine_v.len(), capture.skipped_rows), (6, 1), "{cut}");
    }
    let wires = "0,3,2.5,2,2.5,7\n".repeat(6);
    let (_, capture) = read(format!("t,SIN,REFSIN,COS,REFCOS,abs\n{wires}1,3,OL,2,2.5,8\n2,3,2.5,2,2.5,9\n")).unwrap();
    let absolute = capture.absolute.unwrap();
    assert_eq!(
        (absolute.len(), absolute[6], capture.wires.unwrap().sin_v.len()),
        (7, 9, 7),
        "all columns stay in step"
    );
    let most = format!("t,sin,cos\n{six}{}", "6,NaN,2\n".repeat(7));
    assert_eq!(read(most).unwrap_err(), CaptureError::NoValues { skipped_rows: 7, rows: 13, row: 8 });
}

/// A table in UTF-16 and a second header row with units are accepted (issue 22.13).
#[test]
fn accepts_encodings_and_unit_rows() {
    let text = "Zeit (\u{b5}s)\tSinus\tKosinus\r\n0\t0,25\t0,5\r\n1000\t-0,3\t0,4\r\n";
    let units: Vec<u16> = text.encode_utf16().collect();
    let le: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let be: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
    for bytes in [[&[0xFF, 0xFE], &le[..]].concat(), le, [&[0xFE, 0xFF], &be[..]].concat(), be] {
        let (layout, capture) = read(bytes).unwrap();
        assert_eq!((layout.first_row, &layout.names[0][..]), (2, "Zeit (\u{b5}s)"));
        assert_eq!((capture.time_s, capture.sine_v), (vec![0.0, 0.001], vec![0.25, -0.3]));
    }
    let rows = [
        "t,sin,cos\ns,mV,mV\n",
        "t,sin,cos\n,mV,mV\n",
        "n,sin,cos\n#,mV,mV\n",
        "Time,Channel A,Channel B\n(s),(mV),(mV)\n\n",
        "t,sin,cos\nSample, mV , mV \n",
    ];
    for head in rows {
        let (_, capture) =
            read(format!("{head}0,250,500\n1,-300,400\n")).unwrap_or_else(|error| panic!("{head}: {error}"));
        assert_eq!((capture.sine_v, capture.cosine_v), (vec![0.25, -0.3], vec![0.5, 0.4]), "{head}");
    }
}

/// Rows with missing values before the first complete row do not hide the names and units of the columns (issue 22.13).
#[test]
fn finds_header_before_incomplete_rows() {
    let rows = "2,3,4\n3,4,5\n4,5,6\n5,6,7\n6,7,8\n7,8,9\n";
    for gap in ["1,,", "1,OVERLOAD,OVERLOAD", "1,---,---", "1, , "] {
        let (layout, capture) = read(format!("t [ms],cos,sin [mV]\n0,,\n{gap}\n{rows}")).unwrap();
        assert_eq!((layout.columns.sine, layout.columns.cosine, layout.first_row), (3, 2, 2), "{gap}");
        assert_eq!((capture.time_s[0], capture.sine_v[0], capture.skipped_rows), (0.002, 0.004, 2), "{gap}");
    }
    let (layout, capture) = read(format!("0,,\n1,OL,OL\n{rows}")).unwrap();
    assert_eq!((layout.names, capture.skipped_rows, capture.sine_v.len()), (Vec::new(), 2, 6), "without names");
}

/// A truncated last line is skipped. After an open quotation mark, however, several lines would be lost, which is an
/// error (issue 22.13).
#[test]
fn rejects_unclosed_quote() {
    let six = "0,1,2\n1,2,3\n2,3,4\n3,4,5\n4,5,6\n5,6,7\n";
    for (open, column) in [("6,\"3,4", "in a value"), ("6,3,4,\"24 V", "in a note")] {
        let text = format!("t,sin,cos,note\n{six}{open}\n7,8,9\n8,9,1\n");
        assert_eq!(read(text).unwrap_err(), CaptureError::OpenQuote { row: 8 }, "{column}");
    }
    let long = format!("t,sin,cos\n{six}6,3,4,\"{}", "7,8,9\n".repeat(400_000));
    assert_eq!(
        read_in_pieces(4096, long.as_bytes(), &TableHints::default()).unwrap_err(),
        CaptureError::OpenQuote { row: 8 }
    );
    // A quotation that spans two lines and is closed at the end of the file.
    let (_, capture) = read(format!("t,sin,cos,note\n{six}6,7,8,\"two\nlines\"")).unwrap();
    assert_eq!((capture.sine_v.len(), capture.skipped_rows), (7, 0));
}

/// An oscilloscope's sample numbers are converted to times regardless of the channel names, and must be whole numbers
/// (issue 22.13).
#[test]
fn sample_numbers_are_leading_integers() {
    let (layout, capture) = read("X,sin,cos,Start,Increment\nSequence,V,V,1,0.5\n0,1,2,,\n1,3,4,,\n").unwrap();
    assert_eq!((layout.columns.time, capture.time_s), (Some(1), vec![1.0, 1.5]));
    let times = "X,CH1,CH2,Start,Increment\nSequence,V,V,1,0.5\n0,1,2,,\n0.5,3,4,,\n";
    let expected = CaptureError::NotASampleNumber { row: 4, column: 1, text: "0.5".to_owned() };
    assert_eq!(read(times).unwrap_err(), expected);
    let wishes = TableHints { time_unit: Some(TimeUnit::Seconds), ..TableHints::default() };
    assert_eq!(read_in_pieces(99, times.as_bytes(), &wishes).unwrap().1.time_s, [0.0, 0.5]);
}

/// SCPI instruments write 9.9E37 for an overload and 9.91E37 for a missing value (issue 22.13).
#[test]
fn scpi_overload_values_count_as_missing() {
    let six = "0,1,2\n1,2,3\n2,3,4\n3,4,5\n4,5,6\n5,6,7\n";
    for gap in ["6,9.9E+37,3", "6,2,-9.9E37", "6,9.91E+37,3"] {
        let (_, capture) = read(format!("t,sin,cos\n{six}{gap}\n7,8,9\n")).unwrap();
        assert_eq!((capture.skipped_rows, capture.sine_v.len(), capture.sine_v[6]), (1, 7, 8.0), "{gap}");
    }
}
