//! Compares exported decoders with the program's own. C is compiled and run, and structured text is compared with a
//! reviewed file.

use std::io::Write;
use std::process::{Command, Stdio};

use encoder_studio::devices::ssi::protocol::{
    BitMeaning, Code, ErrorBit, Families, FrameDescriptor, FrameReading, GrayCoverage, Layout, Parity, Range, Repeat,
    Settings, WordWidthError, generate_c99, scl_source, structured_text, structured_text_32,
};

use crate::support::python;

const MAIN: &str = r#"
#include <inttypes.h>
#include <stdio.h>

int main(void)
{
    uint64_t frame;
    while (scanf("%" SCNx64, &frame) == 1) {
        ssi_reading r = ssi_decode(frame);
        printf("%" PRIu64 " %" PRIu64 " %" PRIu64 " %d\n", r.position, r.turns, r.steps, r.valid);
    }
    return 0;
}
"#;

fn family(text: &str) -> Layout {
    let (key, settings) = Settings::parse(text).unwrap();
    settings.resolve(Families::built_in().find_by_key(&key).unwrap()).unwrap().layout
}

/// Returns an unusual layout: Gray code that includes the error bits, parity, a repeated word, swapped wires, and an
/// error bit that is active low.
fn unusual_step_cost() -> Layout {
    Layout::new(FrameDescriptor {
        clocks: 51,
        code: Code::Gray,
        coded: GrayCoverage::AreaAndErrors,
        area: 22,
        lead: 1,
        between: 1,
        errors: vec![ErrorBit {
            name: "LAMP".to_owned(),
            clock: 24,
            meaning: BitMeaning::Invalid,
            active_low: true,
            cleared_by_transfer: false,
        }],
        parity: Some(Parity { clock: 25, even: false }),
        repeat: Some(Repeat { word: 25, gap: 1 }),
        inverted: true,
        range: Range::Bits { multiturn: 7, singleturn: 12 },
        ..FrameDescriptor::binary(0, 0)
    })
    .unwrap()
}

fn layouts() -> Vec<(String, Layout)> {
    let texts = [
        "ahs36,st=12,err=following",
        "ahm36,code=gray",
        "afm60s,code=gray",
        "atm60,shift=1,code=gray,err=fix",
        "atm60,mt=8,st=8,code=gray,over=padded,shift=1",
        "atm60,steps=3600,code=gray-excess",
        "ahm36,steps=100,revolutions=25/2,code=bcd",
        "ahm36,steps=1000,turns=400",
        "ars60",
        "kh53,code=gray",
        "ttk70,clocks=31",
    ];
    let mut all: Vec<(String, Layout)> = texts.iter().map(|text| ((*text).to_owned(), family(text))).collect();
    all.push(("unusual */ /* ??/".to_owned(), unusual_step_cost()));
    all
}

/// Returns frames with valid positions, damaged frames, and frames of random bits for a layout.
fn frames(layout: &Layout) -> Vec<u64> {
    let mut rng = fastrand::Rng::with_seed(11);
    let mut frames = vec![0, u64::MAX, 0xFF_FFFE, 0x0F_FFFE];
    for _ in 0..500 {
        let flags = encoder_studio::devices::ssi::protocol::Flags::error(rng.usize(..4));
        let frame = layout.encode(rng.u64(..=layout.position_code().last_position()), flags).unwrap();
        frames.extend([frame, frame ^ 1 << rng.u8(..layout.clock_count()), rng.u64(..)]);
    }
    frames
}

fn expected_line(layout: &Layout, reading: FrameReading) -> String {
    use encoder_studio::devices::ssi::protocol::Location;
    let (turns, steps) = match layout.descriptor().range.locate(reading.position) {
        Location::Shaft { turns, steps, .. } => (turns, steps),
        Location::Length { .. } => (0, reading.position),
    };
    format!("{} {turns} {steps} {}", reading.position, u8::from(layout.is_valid(reading)))
}

#[test]
fn exported_c_code_matches_program() {
    let compiler = ["cc", "gcc", "clang"].into_iter().find(|name| {
        Command::new(name)
            .arg("--version")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status()
            .is_ok_and(|it| it.success())
    });
    let Some(compiler) = compiler else {
        println!("skipped: no C compiler (cc, gcc, clang) on this machine");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    for (at, (title, layout)) in layouts().into_iter().enumerate() {
        let source = folder.path().join(format!("{at}.c"));
        let program = folder.path().join(format!("{at}.out"));
        std::fs::write(&source, generate_c99(&layout, &title) + MAIN).unwrap();
        let strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-o"];
        let built = Command::new(compiler).args(strict).arg(&program).arg(&source).output().unwrap();
        assert!(built.status.success(), "{title}: {}", String::from_utf8_lossy(&built.stderr));
        let frames = frames(&layout);
        let mut child = Command::new(&program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let text: String = frames.iter().map(|frame| format!("{frame:x}\n")).collect();
        child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        let output = String::from_utf8(output.stdout).unwrap();
        let lines: Vec<&str> = output.lines().collect();
        assert_eq!(lines.len(), frames.len(), "{title}");
        for (frame, line) in frames.iter().zip(lines) {
            assert_eq!(line, expected_line(&layout, layout.decode(*frame)), "{title}, frame {frame:X}");
        }
    }
}

/// With `EXPECT=write`, the test updates the file, which must be reviewed before it is committed.
#[test]
fn exported_structured_text_matches_reviewed_file() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/vectors/ssi_ahs36.st");
    let text = structured_text(&family("ahs36,st=12,code=gray"), "AHS36, 12 bits, Gray");
    if std::env::var_os("EXPECT").is_some_and(|it| it == "write") {
        std::fs::write(path, &text).unwrap();
    }
    assert_eq!(text, std::fs::read_to_string(path).unwrap());
}

/// Frames from section 8 of the reference with their position, turns, steps, and whether the position is valid. Each
/// position combines the turns and steps of the table in one number.
const REFERENCE: [(&str, u64, &str); 12] = [
    ("ahs36", 0x54B6, "10843 0 10843 1"),
    ("ahs36,code=gray", 0x7EEC, "10843 0 10843 1"),
    ("ahs36,st=12,err=following", 0x55E4, "2748 0 2748 0"),
    ("ahm36,code=gray", 0x0D9_3EEC, "4778587 291 10843 1"),
    ("afs60,st=13", 0x91A2, "4660 0 4660 0"),
    // Frames of more than 32 clocks: 5A5h turns and 2ABCDh steps for two families, then all ones, which is a fault.
    ("afm60", 0xB4B5_5E68, "378973133 1445 175053 1"),
    ("afm60s", 0xB4B5_5E68, "378973133 1445 175053 1"),
    ("afm60s", 0x1_FFFF_FFFF, "1073741823 4095 262143 0"),
    ("atm60,mt=8,st=8,code=gray", 0x1EF440, "42300 165 60 1"),
    // The shift discards the lowest bit, which is 0 here.
    ("atm60,shift=1", 0x05A_591A, "11842100 1445 4660 1"),
    ("atm60,steps=3600,code=gray-excess", 0xE5E, "1234 0 1234 1"),
    ("kh53", 0xFF_FFFE, "16777214 0 16777214 0"),
];

fn decoders_for_32_bit_targets(layout: &Layout) -> [(&'static str, Result<String, WordWidthError>); 2] {
    [("st", structured_text_32(layout, "title")), ("scl", scl_source(layout, "title"))]
}

/// Runs an exported 32-bit decoder on the frames in Python and returns its results, or `None` if Python is missing.
fn run_32_bit_decoder(text: &str, frames: &[u64]) -> Option<Vec<String>> {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("decoder.txt");
    std::fs::write(&source, text).unwrap();
    let mut player = python("structured_text.py")?;
    let mut child = player.arg(&source).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let lines: String = frames.iter().map(|frame| format!("{frame:x}\n")).collect();
    // The decoder answers while it is still reading, and a pipe cannot hold all of the data, so a thread writes them.
    let writer = std::thread::spawn(move || input.write_all(lines.as_bytes()));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap().unwrap();
    assert!(output.status.success(), "{text}");
    Some(String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect())
}

#[test]
fn decoders_32_bit_read_reference_frames() {
    for (spec, frame, meant) in REFERENCE {
        for (name, text) in decoders_for_32_bit_targets(&family(spec)) {
            let Some(lines) = run_32_bit_decoder(&text.unwrap(), &[frame]) else { return };
            assert_eq!(lines, [meant], "{spec} as {name}, frame {frame:X}");
        }
    }
}

#[test]
fn decoders_32_bit_match_program() {
    for (title, layout) in layouts() {
        for (name, text) in decoders_for_32_bit_targets(&layout) {
            let text = text.unwrap_or_else(|error| panic!("{title}: {error}"));
            let mut frames = frames(&layout);
            let all = u64::MAX >> (64 - layout.clock_count());
            frames.iter_mut().for_each(|frame| *frame &= all);
            let Some(lines) = run_32_bit_decoder(&text, &frames) else { return };
            assert_eq!(lines.len(), frames.len(), "{title}");
            for (frame, line) in frames.iter().zip(lines) {
                assert_eq!(line, expected_line(&layout, layout.decode(*frame)), "{title} as {name}, frame {frame:X}");
            }
        }
    }
}

#[test]
fn rejects_layouts_wider_than_32_bits() {
    let wide = Layout::new(FrameDescriptor::binary(12, 22)).unwrap();
    let axis = family("atm60,steps=8000000,revolutions=4095/4");
    for (layout, error) in [(wide, WordWidthError::Position { bits: 34 }), (axis, WordWidthError::RoundAxis)] {
        for (_, text) in decoders_for_32_bit_targets(&layout) {
            assert_eq!(text, Err(error));
        }
    }
}

/// In an external source, TIA Portal requires a quoted name, a version, local variables with `#`, and named parameters.
#[test]
fn scl_is_valid_external_source() {
    let text = scl_source(&family("afm60,code=gray"), "Zuführung\n(* 2 *)").unwrap();
    assert!(
        text.starts_with(
            "FUNCTION_BLOCK \"SSI_DECODE\"\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\nVAR_INPUT\n"
        )
    );
    assert!(text.ends_with("END_FUNCTION_BLOCK\n") && text.is_ascii());
    let (declared, body) = text.split_once("BEGIN\n").unwrap();
    assert_eq!(declared.matches("END_VAR").count(), 3);
    assert!(body.contains("    // SSI decoder: Zuf_hrung (* 2 *)\n"), "{body}");
    assert!(body.contains("SHL(IN := #word_high, N := 29)"), "{body}");
    let statements = body.lines().filter(|line| !line.trim_start().starts_with("//"));
    for line in statements {
        let bare = |name: &str| line.match_indices(name).any(|(at, _)| !line[..at].ends_with(['#', '_']));
        assert!(!["position", "turns", "steps", "flags", "word_", "frame_"].into_iter().any(bare), "{line}");
    }
    for type_ in ["LWORD", "ULINT", "LWord", "ULInt"] {
        assert!(!text.contains(type_), "an S7-1200 has no {type_}");
    }
}
