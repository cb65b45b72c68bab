//! Profiles over texts of a person, of every kind.

use super::*;
use crate::profile::Body;
use crate::protocol::hiperdrive::ParameterNumber;
use crate::protocol::interbus::{Cam, CamNumber, ProgramNumber, Value};

const HIPERFACE: &str = "// bench 3, Monday\r\n(\r\n  schema: 1, device: \"hiperface\",\r\n  fields: [ // the motor's\r\n    (status: 0xC8, number: 0, // ours\r\n     bytes: [\r\n       \"00 01 02 03 04 05 06 07\", // name plate\r\n       \"08 09 0a 0b 0c 0d 0e 0f\",\r\n     ]),\r\n  ],\r\n  interface: (settings: 0xE4, address: 64), /* as wired */\r\n  identity: (serial_number: \"A1\", encoder_type: 0x37),\r\n  recorded: (), mounting: [],\r\n)";

const SSI: &str = "(schema: 1, device: \"ssi\", name: \"lift\", // hall 2\n\
    frame: ( // as in the manual\n\
    \tclocks: 25, singleturn: 12, multiturn: 12, // ours\n\
    \terrors: [(name: \"ERR\", meaning: \"invalid\", clock: 25)],\n\
    ),\n\
    preset: 7) // end\n";

const INTERBUS: &str = "(\n\
    device: \"interbus\", schema: 1,\n\
    // the format of the week\n\
    programs: [\n\
    (program: 2, mask: 3, cams: [\n\
    (cam: 1, start: 10, stop: 20), // knife\n\
    (stop: 200, start: 100, cam: 0, name: \"glue\"),\n\
    ]),\n\
    ],\n\
    parameters: (steps: 0x1000, revolutions: 1, direction: \"cw\", preset: 0, zero_shift: 0), // gear\n\
    )\n";

const HIPERDRIVE: &str = "(\n\
    schema: 1, device: \"hiperdrive\",\n\
    drives: [(number: 1, parameters: {\n\
    166: 50, // slow\n\
    158: 1000, // to the wall\n\
    })],\n\
    )\n";

const BISS: &str = "(schema: 1, device: \"biss\",\n\
    // shelf 4\n\
    identity: (serial_number: \"1\", profile_id: 24873, device_id: \"010168110001\", manufacturer: \"46 72\"),\n\
    data: [], // none yet\n\
    filter: 4, // fast loops\n\
    )\n";

fn edited(text: &str, edit: impl FnOnce(&mut Document)) -> (Document, Carried) {
    let mut document = Document::parse(text).unwrap();
    edit(&mut document);
    let carried = document.emit_over(text);
    assert_eq!(Document::parse(&carried.text).unwrap().emit(), document.emit());
    (document, carried)
}

fn number(number: u16) -> ParameterNumber {
    ParameterNumber::new(number).unwrap()
}

fn cam(start: u32, stop: u32) -> Option<Cam> {
    Some(Cam { start: Value::new(start).unwrap(), stop: Value::new(stop).unwrap() })
}

/// Issue 22.26: a save of what was not changed leaves the text as it is, for every kind.
#[test]
fn what_is_not_changed_stays_as_it_is_written() {
    for text in [HIPERFACE, SSI, INTERBUS, HIPERDRIVE, BISS] {
        let (_, carried) = edited(text, |_| {});
        assert_eq!(carried, Carried { text: text.to_owned(), lost: Vec::new() });
    }
}

/// Issue 22.26: one value changed is one place changed, for every kind.
#[test]
fn a_change_touches_nothing_else() {
    let hiperface = |document: &mut Document| {
        let Body::Hiperface(own) = &mut document.body else { panic!() };
        own.interface.address = 0x41;
    };
    let ssi = |document: &mut Document| {
        let Body::Ssi(own) = &mut document.body else { panic!() };
        own.preset = 9;
        own.reading.clock_hz = 250_000;
    };
    let interbus = |document: &mut Document| {
        let Body::Interbus(own) = &mut document.body else { panic!() };
        let program = own.image.program_mut(ProgramNumber::new(2).unwrap()).unwrap().as_mut().unwrap();
        program.set_cam(CamNumber::new(1).unwrap(), cam(15, 20));
    };
    let hiperdrive = |document: &mut Document| {
        let Body::Hiperdrive(own) = &mut document.body else { panic!() };
        own.image.values.insert(number(166), 40);
    };
    let biss = |document: &mut Document| {
        let Body::Biss(own) = &mut document.body else { panic!() };
        own.filter = Some(crate::protocol::biss::Filter::from_byte(0));
    };
    type Edit<'e> = &'e dyn Fn(&mut Document);
    let cases: [(&str, Edit, &str, &str); 5] = [
        (HIPERFACE, &hiperface, "address: 64", "address: 0x41"),
        (SSI, &ssi, "preset: 7", "preset: 9, reading: (\n    clock_hz: 250000,\n)"),
        (INTERBUS, &interbus, "start: 10,", "start: 15,"),
        (HIPERDRIVE, &hiperdrive, "166: 50", "166: 40"),
        (BISS, &biss, "filter: 4", "filter: 0x00"),
    ];
    for (text, edit, from, to) in cases {
        let (_, carried) = edited(text, edit);
        // An entry that is new is written as this program writes it, in its place.
        let squeezed = |text: &str| text.split_whitespace().collect::<String>().replace(",)", ")");
        assert_eq!(squeezed(&carried.text), squeezed(&text.replace(from, to)));
        assert_eq!(carried.lost, Vec::<String>::new());
        assert_eq!(carried.text.matches("\r\n").count() > 0, text.contains("\r\n"));
        assert!(!carried.text.replace("\r\n", "").contains('\n') || !text.contains("\r\n"));
    }
}

/// Issue 22.26: bytes that a person keeps in lines of another length are written anew, which is said; the rest stays.
#[test]
fn bytes_in_lines_of_a_persons_own_are_written_anew() {
    let (_, carried) = edited(HIPERFACE, |document| {
        let Body::Hiperface(own) = &mut document.body else { panic!() };
        own.fields[0].bytes.as_mut().unwrap()[1] = 0xFF;
    });
    assert_eq!(carried.lost, ["name plate"]);
    let rest = [
        "// bench 3, Monday\r\n",
        "status: 0xC8, number: 0, // ours\r\n",
        "(settings: 0xE4, address: 64), /* as wired */",
    ];
    rest.iter().for_each(|kept| assert!(carried.text.contains(kept), "{kept}\n{}", carried.text));
    assert!(carried.text.contains("\"00 FF 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F\""));
}

/// Issue 22.26: what comes and what goes takes its line and no other.
#[test]
fn entries_come_and_go() {
    let (_, carried) = edited(INTERBUS, |document| {
        let Body::Interbus(own) = &mut document.body else { panic!() };
        let program = own.image.program_mut(ProgramNumber::new(2).unwrap()).unwrap().as_mut().unwrap();
        program.set_cam(CamNumber::new(1).unwrap(), None);
        program.set_cam(CamNumber::new(4).unwrap(), cam(300, 400));
        document.note = Some("as of today".to_owned());
    });
    let expected = INTERBUS
        .replace("(cam: 1, start: 10, stop: 20), // knife\n", "")
        .replace("name: \"glue\"),\n", "name: \"glue\"),\n(cam: 4, start: 300, stop: 400),\n")
        .replace("device: \"interbus\", schema: 1,\n", "device: \"interbus\",\nnote: \"as of today\",\nschema: 1,\n");
    let lines = |text: &str| text.lines().map(|line| line.trim().to_owned()).collect::<Vec<_>>();
    assert_eq!(lines(&carried.text), lines(&expected));
    assert_eq!(carried.lost, ["knife"]);
    let (_, carried) = edited(HIPERDRIVE, |document| {
        let Body::Hiperdrive(own) = &mut document.body else { panic!() };
        own.image.values.remove(&number(158));
        own.image.values.insert(number(24), 1);
    });
    assert!(carried.text.contains("\n166: 50, // slow\n})],\n"), "{}", carried.text);
    assert!(carried.text.contains("parameters: {"), "{}", carried.text);
    assert_eq!(carried.lost, ["to the wall"]);
}

/// Issue 22.26: what the ready-made profiles say about their own values goes with the values.
#[test]
fn comments_of_the_program_follow_their_values() {
    let text = include_str!("../../../profiles/interbus/packaging-machine.ron");
    let (document, carried) = edited(text, |document| {
        let Body::Interbus(own) = &mut document.body else { panic!() };
        let program = own.image.program_mut(ProgramNumber::new(1).unwrap()).unwrap().as_mut().unwrap();
        program.mask = 0x03;
    });
    assert_eq!(carried, Carried { text: document.emit(), lost: Vec::new() });
    assert!(carried.text.contains("mask: 0x03, // these cams work: 0, 1\n"));
}

/// Issue 22.25: what two people changed since they had the same profile.
#[test]
fn who_changed_what_is_told_entry_by_entry() {
    let base = Document::parse(INTERBUS).unwrap();
    let theirs = Document::parse(&INTERBUS.replace("start: 10,", "start: 12,").replace("mask: 3", "mask: 1")).unwrap();
    let mine =
        Document::parse(&INTERBUS.replace("start: 10,", "start: 14,").replace("stop: 200", "stop: 222")).unwrap();
    let found = divergence(&base, &theirs, &mine);
    let told: Vec<(String, Changed)> = found.iter().map(|(change, who)| (change.place(), *who)).collect();
    let place = |rest: &str| format!("programs[program: 2].{rest}");
    let expected = [
        (place("mask"), Changed::There),
        (place("cams[cam: 0].stop"), Changed::Here),
        (place("cams[cam: 1].start"), Changed::Both),
    ];
    assert_eq!(told, expected);
    let here: Vec<Change> = found.into_iter().filter(|(_, who)| *who == Changed::Here).map(|(own, _)| own).collect();
    let merged = theirs.changed(&here).unwrap();
    let expected = INTERBUS.replace("start: 10,", "start: 12,").replace("mask: 3", "mask: 1");
    assert_eq!(merged, Document::parse(&expected.replace("stop: 200", "stop: 222")).unwrap());
}

/// The ready-made profiles, by their kinds.
fn ready_made() -> Vec<(&'static str, String)> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles");
    let mut found = Vec::new();
    for kind in Body::KINDS {
        for file in std::fs::read_dir(root.join(kind)).unwrap() {
            found.push((kind, std::fs::read_to_string(file.unwrap().path()).unwrap()));
        }
    }
    assert!(found.len() > 20, "{}", found.len());
    found
}

/// Issue 22.26: whatever a profile becomes, it says that and nothing else, and each comment of a person stays or is named.
#[test]
fn any_profile_over_any_text_says_what_it_is_and_no_comment_goes_unnamed() {
    let all = ready_made();
    for (kind, text) in &all {
        for line_end in ["\n", "\r\n"] {
            let lines = text.lines().enumerate().map(|(at, line)| format!("{line}{line_end}// own {at}.{line_end}"));
            let commented: String = lines.collect();
            for (_, other) in all.iter().filter(|(own, _)| own == kind) {
                let document = Document::parse(other).unwrap();
                let carried = document.emit_over(&commented);
                assert_eq!(Document::parse(&carried.text).unwrap().emit(), document.emit());
                for at in 0..text.lines().count() {
                    let own = format!("own {at}.");
                    let stays = carried.text.contains(&format!("// {own}"));
                    assert_eq!(stays, !carried.lost.contains(&own), "{own}");
                }
                if line_end == "\r\n" {
                    assert!(!carried.text.replace("\r\n", "").contains('\n'));
                }
            }
            let own = Document::parse(text).unwrap().emit_over(&commented);
            assert_eq!(own, Carried { text: commented, lost: Vec::new() });
        }
    }
}

/// A text with other blanks between its words: those of `picks` in turn. Comments are numbered.
fn spaced(text: &str, picks: &[usize]) -> (String, usize) {
    const WAYS: usize = 9;
    let (mut out, mut comments, mut at, mut pick) = (String::new(), 0, 0, picks.iter().cycle());
    let mut quoted = false;
    let letters: Vec<char> = text.chars().collect();
    while at < letters.len() {
        let letter = letters[at];
        let between = !quoted && (letter.is_whitespace() || "([{,".contains(letter));
        if quoted && letter == '\\' {
            out.extend([letter, letters[at + 1]]);
            at += 2;
            continue;
        }
        if letter == '"' {
            quoted = !quoted;
        }
        if !quoted && letters[at..].starts_with(&['/', '/']) {
            at += letters[at..].iter().position(|own| *own == '\n').unwrap_or(letters.len() - at);
            continue;
        }
        if !letter.is_whitespace() || quoted {
            out.push(letter);
        }
        at += 1;
        if !between {
            continue;
        }
        let own = format!("own {comments}.");
        let blank = match pick.next().unwrap() % WAYS {
            0 => " ".to_owned(),
            1 => "\n".to_owned(),
            2 => "\t\r\n  ".to_owned(),
            3 => format!(" // {own}\n"),
            4 => format!("// {own}\r\n"),
            5 => format!(" /* {own} */ "),
            6 => format!("/* {own} */"),
            7 => format!("\n/* \"( /* ,[ */ {{\n{own} */\n"),
            _ => format!(" // \u{1F527} ü\" ( , {own}\n"),
        };
        comments += usize::from(blank.contains(&own));
        out.push_str(&blank);
    }
    (out, comments)
}

proptest::proptest! {
    #![proptest_config(proptest::test_runner::Config { cases: 256, ..Default::default() })]

    /// Issue 22.26: wherever a person puts comments and line ends, and whatever is saved over that.
    #[test]
    fn comments_between_any_words_stay_or_are_named(
        from in 0_usize..100,
        to in 0_usize..100,
        picks in proptest::collection::vec(0_usize..9, 1..200),
    ) {
        let mut all = ready_made();
        all.extend([(Body::KINDS[0], HIPERFACE), (Body::KINDS[1], BISS), (Body::KINDS[2], SSI)].map(|(kind, text)| (kind, text.to_owned())));
        all.extend([(Body::KINDS[3], INTERBUS), (Body::KINDS[4], HIPERDRIVE)].map(|(kind, text)| (kind, text.to_owned())));
        let (kind, text) = &all[from % all.len()];
        let others: Vec<&String> = all.iter().filter(|(own, _)| own == kind).map(|(_, text)| text).collect();
        let document = Document::parse(others[to % others.len()]).unwrap();
        let (spaced, comments) = spaced(text, &picks);
        let before = Document::parse(&spaced).unwrap();
        proptest::prop_assert_eq!(before.emit(), Document::parse(text).unwrap().emit());
        let same = before.emit_over(&spaced);
        proptest::prop_assert_eq!(same, Carried { text: spaced.clone(), lost: Vec::new() });
        let carried = document.emit_over(&spaced);
        proptest::prop_assert_eq!(Document::parse(&carried.text).unwrap().emit(), document.emit());
        for at in 0..comments {
            let own = format!("own {at}.");
            let stays = carried.text.contains(&own);
            let is_named = carried.lost.iter().any(|lost| lost.contains(&own));
            proptest::prop_assert!(stays != is_named, "{own}\n{spaced}\n----\n{}", carried.text);
        }
    }
}
