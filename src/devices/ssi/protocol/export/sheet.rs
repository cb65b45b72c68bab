//! The settings of a control's SSI module for this frame. The terms are those of the modules' own manuals. The encoder is
//! not changed.

use std::fmt::Write;

use crate::devices::ssi::protocol::code::Code;
use crate::devices::ssi::protocol::descriptor::Coded;
use crate::devices::ssi::protocol::explain::Role;
use crate::devices::ssi::protocol::layout::Layout;
use crate::devices::ssi::protocol::timing::Times;

/// The location of the position and the other bits, counted as modules count: bit 0 is the last one received.
struct Places {
    frame: u8,
    lowest: u8,
    highest: u8,
    /// Lowest and highest bit of the turns.
    turns: Option<(u8, u8)>,
    /// Lowest and highest bit of the steps.
    steps: Option<(u8, u8)>,
    others: Vec<(u8, String)>,
}

impl Places {
    fn new(layout: &Layout) -> Self {
        let frame = layout.clocks();
        let bits = (0..frame).rev().zip(layout.roles());
        let (mut position, mut turns, mut steps, mut others) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (bit, role) in bits {
            match role {
                Role::Multiturn(_) => turns.push(bit),
                Role::Singleturn(_) => steps.push(bit),
                Role::Error(_) | Role::Parity => others.push((bit, layout.role_name(role))),
                Role::Position(_) | Role::Zero | Role::Again(_) => {}
            }
            if matches!(role, Role::Multiturn(_) | Role::Singleturn(_) | Role::Position(_)) {
                position.push(bit);
            }
        }
        let ends = |bits: &[u8]| Some((*bits.last()?, *bits.first()?));
        let (lowest, highest) = ends(&position).unwrap_or((0, 0));
        Places { frame, lowest, highest, turns: ends(&turns), steps: ends(&steps), others }
    }

    /// Returns the number of bits after the position.
    fn behind(&self) -> u8 {
        self.lowest
    }
}

/// Returns the settings of common modules, a paragraph each.
pub fn settings_sheet(layout: &Layout, times: Option<&Times>, title: &str) -> String {
    let places = Places::new(layout);
    let descriptor = layout.descriptor();
    let gray = descriptor.code == Code::Gray;
    let code = match descriptor.code {
        Code::Binary => "binary (dual)",
        Code::Gray => "Gray",
        Code::GrayExcess => "Gray excess",
        Code::Bcd => "BCD",
    };
    let mut text =
        format!("SSI settings: {title}\n\nThis sheet is for the control. It does not program the encoder.\n\n");
    let mut line = |label: &str, value: &str| {
        // Writing into a String cannot fail.
        let _ = writeln!(text, "{label:32}{value}");
    };
    line("Frame length", &format!("{} bits", places.frame));
    line("Code", code);
    line("Position, lowest bit (LSB)", &format!("bit {}", places.lowest));
    line("Position, highest bit (MSB)", &format!("bit {}", places.highest));
    for (bit, name) in &places.others {
        line(name, &format!("bit {bit}"));
    }
    if let Some(parity) = descriptor.parity {
        line("Parity", if parity.even { "even" } else { "odd" });
    }
    if let Some(times) = times {
        line(
            "Monoflop time (tm)",
            &format!("{} to {} µs; the pause must be longer", times.monoflop.0, times.monoflop.1),
        );
        line("Highest clock", &format!("{} kHz, less on long cables", times.most_hz / 1000));
    }
    text.push_str("Bit 0 is the last bit received, bit ");
    let _ = writeln!(text, "{} the first.", places.frame - 1);
    if let Some(why) = obstacle(layout) {
        let _ = writeln!(text, "\n{why} Read the whole frame as binary, and decode it in the program.");
    }
    module(&mut text, "SIMATIC TM PosInput, SSI_Absolute_Encoder", &siemens(layout, &places, gray));
    module(&mut text, "Beckhoff EL5001, EL5002, EJ5002 (object 8000h)", &beckhoff(layout, &places, gray));
    module(&mut text, "Delta AS02HC", &delta(layout, &places, gray));
    module(&mut text, "Synapticon SOMANET (object 2209h)", &synapticon(layout, &places, gray));
    text
}

/// Returns the property that no module can decode.
fn obstacle(layout: &Layout) -> Option<&'static str> {
    let descriptor = layout.descriptor();
    match descriptor.code {
        Code::GrayExcess => {
            Some("Gray excess: modules know binary and Gray; as Gray the value is too high by a fixed number.")
        }
        Code::Bcd => Some("BCD: modules know binary and Gray."),
        _ if descriptor.coded != Coded::Position => {
            Some("The Gray code goes over more than the position; modules convert the position alone.")
        }
        _ if descriptor.inverted => Some("The data wires are exchanged: exchange them again."),
        _ if descriptor.between > 0 => Some("Turns and steps are apart; most modules read one position without a gap."),
        _ => None,
    }
}

fn module(text: &mut String, name: &str, settings: &[(&str, String)]) {
    let _ = writeln!(text, "\n{name}");
    for (label, value) in settings {
        let _ = writeln!(text, "  {label:32}{value}");
    }
}

fn siemens(layout: &Layout, places: &Places, gray: bool) -> Vec<(&'static str, String)> {
    let width = places.highest - places.lowest + 1;
    let lengths = if (10..=40).contains(&places.frame) { "" } else { " (the module takes 10 to 40)" };
    let wide = if width > 32 { " (more than 32 bits apart: the module takes 32)" } else { "" };
    let parity = layout.descriptor().parity.map_or("none", |parity| if parity.even { "even" } else { "odd" });
    vec![
        ("Frame length", format!("{} bit{lengths}", places.frame)),
        ("Code type", if gray { "Gray" } else { "Dual" }.to_owned()),
        ("Parity", parity.to_owned()),
        ("Bit number LSB of the position", places.lowest.to_string()),
        ("Bit number MSB of the position", format!("{}{wide}", places.highest)),
    ]
}

fn beckhoff(layout: &Layout, places: &Places, gray: bool) -> Vec<(&'static str, String)> {
    let frame_type = match places.frame {
        25 => "0 (multiturn, 25 bits)".to_owned(),
        13 => "1 (singleturn, 13 bits)".to_owned(),
        bits @ 1..=32 => format!("2 (variable, {bits} bits)"),
        bits => format!("none: the terminal reads up to 32 bits, not {bits}"),
    };
    // A parity bit has no information about the encoder.
    let tells = layout.descriptor().parity.is_none_or(|parity| parity.clock != places.frame);
    let fails = u8::from(tells && matches!(places.others.as_slice(), [.., (0, _)]));
    let behind = places.behind() - fails;
    let mut settings = vec![
        (":06 SSI coding", if gray { "1 (Gray)" } else { "0 (binary)" }.to_owned()),
        (":0F SSI frame type", frame_type),
        (":11 SSI frame size", places.frame.to_string()),
        (":12 SSI data length", (places.frame - fails).to_string()),
        (":02 Enable power failure bit", if fails == 1 { "1: the last bit is an error bit" } else { "0" }.to_owned()),
    ];
    if behind > 0 {
        settings.push(("In the program", format!("divide the value by {} ({behind} bits follow)", 1_u64 << behind)));
    }
    settings
}

fn delta(layout: &Layout, places: &Places, gray: bool) -> Vec<(&'static str, String)> {
    let field = |ends: Option<(u8, u8)>| match ends {
        Some((low, high)) if low == high => format!("1 bit at b{high}"),
        Some((low, high)) => format!("{} bits from b{high}", high - low + 1),
        None => "0 bits".to_owned(),
    };
    let position = Some((places.lowest, places.highest));
    let steps = if places.steps.is_some() { places.steps } else { position };
    let status: Vec<u8> =
        places.others.iter().map(|(bit, _)| *bit).filter(|_| layout.descriptor().parity.is_none()).collect();
    let ends = status.last().zip(status.first()).map(|(low, high)| (*low, *high));
    vec![
        ("Multi-turn data", field(places.turns)),
        ("Single-turn data", field(steps)),
        ("Status data", field(ends)),
        ("Code", if gray { "Gray" } else { "binary" }.to_owned()),
    ]
}

fn synapticon(layout: &Layout, places: &Places, gray: bool) -> Vec<(&'static str, String)> {
    // Its bits are counted from the first one received.
    let first =
        |ends: Option<(u8, u8)>| ends.map_or_else(|| "–".to_owned(), |(_, high)| (places.frame - 1 - high).to_string());
    let count = |ends: Option<(u8, u8)>| ends.map_or(0, |(low, high)| high - low + 1).to_string();
    let steps = if places.steps.is_some() { places.steps } else { Some((places.lowest, places.highest)) };
    let parity =
        layout.descriptor().parity.map_or("0 (none)", |parity| if parity.even { "2 (even)" } else { "1 (odd)" });
    vec![
        ("Multiturn bits", count(places.turns)),
        (":11 Multiturn first bit", first(places.turns)),
        ("Singleturn bits", count(steps)),
        (":9 Singleturn first bit", first(steps)),
        (":12 Parity type", parity.to_owned()),
        (":14 Data ordering", if gray { "1 (Gray)" } else { "0 (binary)" }.to_owned()),
    ]
}
