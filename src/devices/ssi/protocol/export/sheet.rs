//! Settings with which the SSI module of a PLC can read this frame, in the terms of the module manuals. The settings of
//! the encoder stay the same.

use std::fmt::Write;

use super::svg::role_name;
use super::text::{ExportText, SettingMeaning, TranslateFn, UnsupportedModuleFeature};
use crate::devices::ssi::protocol::code::Code;
use crate::devices::ssi::protocol::descriptor::GrayCoverage;
use crate::devices::ssi::protocol::explain::Role;
use crate::devices::ssi::protocol::layout::Layout;
use crate::devices::ssi::protocol::timing::Times;

/// Locations of the position and of the other bits of a frame. Bits are numbered as in interface modules, where bit 0
/// is the last bit received.
struct BitLocations {
    frame: u8,
    lowest: u8,
    highest: u8,
    /// Lowest and highest bit of the turns, if they have separate bits.
    turns: Option<(u8, u8)>,
    /// Lowest and highest bit of the steps, if they have separate bits.
    steps: Option<(u8, u8)>,
    others: Vec<(u8, String)>,
}

impl BitLocations {
    fn new(layout: &Layout, say: TranslateFn<'_>) -> Self {
        let frame = layout.clock_count();
        let bits = (0..frame).rev().zip(layout.clock_roles());
        let (mut position, mut turns, mut steps, mut others) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (bit, role) in bits {
            match role {
                Role::Multiturn(_) => turns.push(bit),
                Role::Singleturn(_) => steps.push(bit),
                Role::Error(_) | Role::Parity => others.push((bit, role_name(layout, role, say))),
                Role::Position(_) | Role::Zero | Role::Repetition(_) => {}
            }
            if matches!(role, Role::Multiturn(_) | Role::Singleturn(_) | Role::Position(_)) {
                position.push(bit);
            }
        }
        let ends = |bits: &[u8]| Some((*bits.last()?, *bits.first()?));
        let (lowest, highest) = ends(&position).unwrap_or((0, 0));
        BitLocations { frame, lowest, highest, turns: ends(&turns), steps: ends(&steps), others }
    }

    fn lowest_bit(&self) -> u8 {
        self.lowest
    }
}

/// Returns the settings for common interface modules, one paragraph per module.
pub fn settings_sheet(layout: &Layout, times: Option<&Times>, title: &str, say: TranslateFn<'_>) -> String {
    let places = BitLocations::new(layout, say);
    let descriptor = layout.descriptor();
    let heading = say(&ExportText::SheetTitle(title.to_owned()));
    let mut text = format!("{heading}\n\n{}\n\n", say(&ExportText::SheetPurpose));
    let mut line = |label: &str, value: &ExportText| {
        // Writing into a String cannot fail.
        let _ = writeln!(text, "{label:32}{}", say(value));
    };
    line(&say(&ExportText::FrameLength), &ExportText::Bits(places.frame));
    line(&say(&ExportText::Code), &ExportText::CodeName(descriptor.code));
    line(&say(&ExportText::LowestBit), &ExportText::BitNumber(places.lowest));
    line(&say(&ExportText::HighestBit), &ExportText::BitNumber(places.highest));
    for (bit, name) in &places.others {
        line(name, &ExportText::BitNumber(*bit));
    }
    if let Some(parity) = descriptor.parity {
        line(&say(&ExportText::Parity), &ExportText::ParityIs { even: parity.even });
    }
    if let Some(times) = times {
        let (least, most) = times.monoflop;
        line(&say(&ExportText::Monoflop), &ExportText::MonoflopTimes { least, most });
        line(&say(&ExportText::HighestClock), &ExportText::ClockLimit { kilohertz: times.most_hz / 1000 });
    }
    let _ = writeln!(text, "{}", say(&ExportText::Counting { first: places.frame - 1 }));
    if let Some(why) = unsupported_feature(layout) {
        let _ = writeln!(text, "\n{} {}", say(&ExportText::Obstacle(why)), say(&ExportText::ReadAsBinary));
    }
    let mut module = |name: &str, settings: Vec<(SheetLabel, Setting)>| {
        let _ = writeln!(text, "\n{name}");
        for (label, value) in settings {
            let label = match label {
                SheetLabel::Own(label) => label.to_owned(),
                SheetLabel::Text(label) => say(&label),
            };
            let value = match value {
                Setting::Plain(value) => value,
                Setting::Text(value) => say(&value),
            };
            let _ = writeln!(text, "  {label:32}{value}");
        }
    };
    module("SIMATIC TM PosInput, SSI_Absolute_Encoder", siemens_settings(layout, &places));
    module("Beckhoff EL5001, EL5002, EJ5002 (object 8000h)", beckhoff_settings(layout, &places));
    module("Delta AS02HC", delta_settings(layout, &places));
    module("Synapticon SOMANET (object 2209h)", synapticon_settings(layout, &places));
    text
}

enum SheetLabel {
    /// Term from the module manual, which is the same in every language.
    Own(&'static str),
    Text(ExportText),
}

enum Setting {
    /// Text that is the same in every language.
    Plain(String),
    Text(ExportText),
}

/// Returns the property of the frame that no module can decode, if any.
fn unsupported_feature(layout: &Layout) -> Option<UnsupportedModuleFeature> {
    let descriptor = layout.descriptor();
    match descriptor.code {
        Code::GrayExcess => Some(UnsupportedModuleFeature::GrayExcess),
        Code::Bcd => Some(UnsupportedModuleFeature::Bcd),
        _ if descriptor.coded != GrayCoverage::Position => Some(UnsupportedModuleFeature::GrayOver),
        _ if descriptor.inverted => Some(UnsupportedModuleFeature::Inverted),
        _ if descriptor.between > 0 => Some(UnsupportedModuleFeature::Between),
        _ => None,
    }
}

fn is_gray(layout: &Layout) -> bool {
    layout.descriptor().code == Code::Gray
}

/// Returns the code setting: 1 for Gray, 0 for binary.
fn code_setting(layout: &Layout) -> Setting {
    let (number, value) = if is_gray(layout) { (1, SettingMeaning::Gray) } else { (0, SettingMeaning::Binary) };
    Setting::Text(ExportText::Setting(number, value))
}

fn siemens_settings(layout: &Layout, places: &BitLocations) -> Vec<(SheetLabel, Setting)> {
    let width = places.highest - places.lowest + 1;
    let (bits, bit) = (places.frame, places.highest);
    let parity = layout.descriptor().parity;
    let parity = parity.map_or(ExportText::NoParity, |parity| ExportText::ParityIs { even: parity.even });
    let code = if is_gray(layout) { "Gray" } else { "Dual" };
    vec![
        (
            SheetLabel::Text(ExportText::FrameLength),
            Setting::Text(ExportText::FrameBits { bits, fits: (10..=40).contains(&bits) }),
        ),
        (SheetLabel::Text(ExportText::CodeType), Setting::Plain(code.to_owned())),
        (SheetLabel::Text(ExportText::Parity), Setting::Text(parity)),
        (SheetLabel::Text(ExportText::BitNumberLowest), Setting::Plain(places.lowest.to_string())),
        (
            SheetLabel::Text(ExportText::BitNumberHighest),
            Setting::Text(ExportText::HighestNumber { bit, fits: width <= 32 }),
        ),
    ]
}

fn beckhoff_settings(layout: &Layout, places: &BitLocations) -> Vec<(SheetLabel, Setting)> {
    let frame_type = match places.frame {
        25 => ExportText::Setting(0, SettingMeaning::Multiturn),
        13 => ExportText::Setting(1, SettingMeaning::Singleturn),
        bits @ 1..=32 => ExportText::Setting(2, SettingMeaning::Variable(bits)),
        bits => ExportText::FrameTypeNone { bits },
    };
    // A parity bit does not describe the state of the encoder.
    let tells = layout.descriptor().parity.is_none_or(|parity| parity.clock != places.frame);
    let fails = u8::from(tells && matches!(places.others.as_slice(), [.., (0, _)]));
    let bits = places.lowest_bit() - fails;
    let error = if fails == 1 { Setting::Text(ExportText::LastIsError) } else { Setting::Plain("0".to_owned()) };
    let mut settings = vec![
        (SheetLabel::Own(":06 SSI coding"), code_setting(layout)),
        (SheetLabel::Own(":0F SSI frame type"), Setting::Text(frame_type)),
        (SheetLabel::Own(":11 SSI frame size"), Setting::Plain(places.frame.to_string())),
        (SheetLabel::Own(":12 SSI data length"), Setting::Plain((places.frame - fails).to_string())),
        (SheetLabel::Own(":02 Enable power failure bit"), error),
    ];
    if bits > 0 {
        let divide = ExportText::Divide { by: 1_u64 << bits, bits };
        settings.push((SheetLabel::Text(ExportText::InTheProgram), Setting::Text(divide)));
    }
    settings
}

fn delta_settings(layout: &Layout, places: &BitLocations) -> Vec<(SheetLabel, Setting)> {
    let field = |ends: Option<(u8, u8)>| {
        Setting::Text(match ends {
            Some((low, highest)) => ExportText::Field { bits: highest - low + 1, highest },
            None => ExportText::NoField,
        })
    };
    let position = Some((places.lowest, places.highest));
    let steps = if places.steps.is_some() { places.steps } else { position };
    let status: Vec<u8> =
        places.others.iter().map(|(bit, _)| *bit).filter(|_| layout.descriptor().parity.is_none()).collect();
    let ends = status.last().zip(status.first()).map(|(low, high)| (*low, *high));
    let code = if is_gray(layout) { ExportText::CodeName(Code::Gray) } else { ExportText::Binary };
    vec![
        (SheetLabel::Own("Multi-turn data"), field(places.turns)),
        (SheetLabel::Own("Single-turn data"), field(steps)),
        (SheetLabel::Own("Status data"), field(ends)),
        (SheetLabel::Own("Code"), Setting::Text(code)),
    ]
}

fn synapticon_settings(layout: &Layout, places: &BitLocations) -> Vec<(SheetLabel, Setting)> {
    // This module numbers the bits from the first one received.
    let first = |ends: Option<(u8, u8)>| {
        Setting::Plain(ends.map_or_else(|| "–".to_owned(), |(_, high)| (places.frame - 1 - high).to_string()))
    };
    let count = |ends: Option<(u8, u8)>| Setting::Plain(ends.map_or(0, |(low, high)| high - low + 1).to_string());
    let steps = if places.steps.is_some() { places.steps } else { Some((places.lowest, places.highest)) };
    let (number, parity) = match layout.descriptor().parity.map(|parity| parity.even) {
        None => (0, SettingMeaning::NoParity),
        Some(false) => (1, SettingMeaning::Odd),
        Some(true) => (2, SettingMeaning::Even),
    };
    vec![
        (SheetLabel::Own("Multiturn bits"), count(places.turns)),
        (SheetLabel::Own(":11 Multiturn first bit"), first(places.turns)),
        (SheetLabel::Own("Singleturn bits"), count(steps)),
        (SheetLabel::Own(":9 Singleturn first bit"), first(steps)),
        (SheetLabel::Own(":12 Parity type"), Setting::Text(ExportText::Setting(number, parity))),
        (SheetLabel::Own(":14 Data ordering"), code_setting(layout)),
    ]
}
