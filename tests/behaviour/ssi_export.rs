//! Exported decoders against the program's own: C is compiled and run, structured text is compared with a reviewed file.

use std::io::Write;
use std::process::{Command, Stdio};

use encoder_studio::devices::ssi::protocol::{
    Code, Coded, Descriptor, ErrorBit, Families, FrameReading, Layout, Meaning, Parity, Range, Repeat, Settings, c99,
    structured_text,
};

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
    settings.resolve(Families::built_in().named(&key).unwrap()).unwrap().layout
}

/// Returns an unusual layout: Gray over everything, parity, both words of a repetition, exchanged wires, an error bit that
/// is active at 0.
fn unusual() -> Layout {
    Layout::new(Descriptor {
        clocks: 51,
        code: Code::Gray,
        coded: Coded::AreaAndErrors,
        area: 22,
        lead: 1,
        between: 1,
        errors: vec![ErrorBit {
            name: "LAMP".to_owned(),
            clock: 24,
            meaning: Meaning::Invalid,
            active_low: true,
            cleared_by_transfer: false,
        }],
        parity: Some(Parity { clock: 25, even: false }),
        repeat: Some(Repeat { word: 25, gap: 1 }),
        inverted: true,
        range: Range::Bits { multiturn: 7, singleturn: 12 },
        ..Descriptor::plain(0, 0)
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
    all.push(("unusual */ /* ??/".to_owned(), unusual()));
    all
}

/// Returns the positions of the layout, disturbed ones, and any bits.
fn frames(layout: &Layout) -> Vec<u64> {
    let mut rng = fastrand::Rng::with_seed(11);
    let mut frames = vec![0, u64::MAX, 0xFF_FFFE, 0x0F_FFFE];
    for _ in 0..500 {
        let flags = encoder_studio::devices::ssi::protocol::Flags::error(rng.usize(..4));
        let frame = layout.encode(rng.u64(..=layout.coding().last()), flags).unwrap();
        frames.extend([frame, frame ^ 1 << rng.u8(..layout.clocks()), rng.u64(..)]);
    }
    frames
}

fn told(layout: &Layout, reading: FrameReading) -> String {
    use encoder_studio::devices::ssi::protocol::Location;
    let (turns, steps) = match layout.descriptor().range.place(reading.position) {
        Location::Shaft { turns, steps, .. } => (turns, steps),
        Location::Length { .. } => (0, reading.position),
    };
    format!("{} {turns} {steps} {}", reading.position, u8::from(layout.is_valid(reading)))
}

#[test]
fn the_exported_c_decodes_as_the_program_does() {
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
        std::fs::write(&source, c99(&layout, &title) + MAIN).unwrap();
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
            assert_eq!(line, told(&layout, layout.decode(*frame)), "{title}, frame {frame:X}");
        }
    }
}

/// `EXPECT=write` writes the file again, to be reviewed before it is committed.
#[test]
fn the_exported_structured_text_is_the_reviewed_one() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/vectors/ssi_ahs36.st");
    let text = structured_text(&family("ahs36,st=12,code=gray"), "AHS36, 12 bits, Gray");
    if std::env::var_os("EXPECT").is_some_and(|it| it == "write") {
        std::fs::write(path, &text).unwrap();
    }
    assert_eq!(text, std::fs::read_to_string(path).unwrap());
}
