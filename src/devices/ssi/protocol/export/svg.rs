//! Pictures as SVG: the frame as a row of cells, and a burst in time, to scale.

use std::fmt::Write;

use crate::devices::ssi::protocol::explain::Role;
use crate::devices::ssi::protocol::layout::Layout;
use crate::devices::ssi::protocol::timing::{Reads, Times};

/// Width of a cell, with its border.
const CELL: u32 = 22;
const MARGIN: u32 = 16;
const FONT: &str = "font-family=\"Inter, Arial, sans-serif\"";

/// Returns a field's colour on paper: light enough for black text on it.
fn colour(role: Role) -> &'static str {
    match role {
        Role::Zero => "#eeeeee",
        Role::Multiturn(_) => "#ffd9a0",
        Role::Singleturn(_) | Role::Position(_) => "#b8dcff",
        Role::Error(_) => "#ffb8b0",
        Role::Parity => "#d5c4f7",
        Role::Again(_) => "#d9e8d0",
    }
}

fn family(role: Role) -> &'static str {
    match role {
        Role::Zero => "0",
        Role::Multiturn(_) => "MT",
        Role::Singleturn(_) => "ST",
        Role::Position(_) => "P",
        Role::Error(_) => "E",
        Role::Parity => "PAR",
        Role::Again(_) => "=",
    }
}

/// Draws the frame, a cell per clock; with the bits of a frame if there is one.
pub fn frame_svg(layout: &Layout, frame: Option<u64>, title: &str) -> String {
    let roles = layout.roles();
    let clocks = u32::from(layout.clocks());
    let width = 2 * MARGIN + clocks * CELL;
    let mut svg = open(width, 112, title);
    let mut begins = 0_usize;
    for (index, role) in roles.iter().enumerate() {
        let x = MARGIN + index as u32 * CELL;
        let clock = index + 1;
        let bit = frame.map_or_else(String::new, |frame| (frame >> (clocks as usize - clock) & 1).to_string());
        let fill = colour(*role);
        let middle = x + CELL / 2;
        let _ = writeln!(
            svg,
            "<rect x=\"{x}\" y=\"44\" width=\"{CELL}\" height=\"28\" fill=\"{fill}\" stroke=\"#555\"/>\n\
             <text x=\"{middle}\" y=\"38\" font-size=\"9\" fill=\"#555\" text-anchor=\"middle\" {FONT}>{clock}</text>\n\
             <text x=\"{middle}\" y=\"63\" font-size=\"13\" text-anchor=\"middle\" {FONT}>{bit}</text>"
        );
        let ends =
            roles.get(index + 1).is_none_or(|next| family(*next) != family(*role) || matches!(role, Role::Error(_)));
        if ends {
            let from = MARGIN + begins as u32 * CELL;
            let to = x + CELL;
            let first = roles.get(begins).copied().unwrap_or(*role);
            let name = match role {
                Role::Error(_) | Role::Parity => layout.role_name(*role),
                Role::Zero => "0".to_owned(),
                _ if begins == index => layout.role_name(*role),
                _ => format!("{} … {}", layout.role_name(first), layout.role_name(*role)),
            };
            // Names of single clocks are at two heights, so that neighbours do not overlap.
            let y = if begins == index && index % 2 == 1 { 104 } else { 90 };
            let _ = writeln!(
                svg,
                "<path d=\"M{} 77 H{}\" stroke=\"#555\" fill=\"none\"/>\n\
                 <text x=\"{}\" y=\"{y}\" font-size=\"10\" text-anchor=\"middle\" {FONT}>{}</text>",
                from + 2,
                to - 2,
                (from + to) / 2,
                escaped(&name)
            );
            begins = index + 1;
        }
    }
    svg.push_str("</svg>\n");
    svg
}

/// Draws a burst and the pause after it, to scale, with the clock, the data and the times of a transfer (manual, figure 2).
pub fn timing_svg(layout: &Layout, times: &Times, reads: &Reads, title: &str) -> String {
    let timing = times.reckon(reads);
    let (burst, pause) = (timing.burst.as_secs_f64(), reads.pause.as_secs_f64());
    let width = 900_u32;
    let scale = f64::from(width - 2 * MARGIN) / (burst + pause).max(1e-9);
    let x = |seconds: f64| f64::from(MARGIN) + seconds * scale;
    let period = timing.period.as_secs_f64();
    let mut svg = open(width, 170, title);
    // The clock rests high; the first falling edge latches, each rising edge shifts a bit.
    let mut clock = format!("M{:.2} 50", x(0.0));
    for index in 0..layout.clocks() {
        let at = f64::from(index) * period;
        let _ = write!(clock, " V74 H{:.2} V50 H{:.2}", x(at + period / 2.0), x(at + period));
    }
    let _ = write!(clock, " H{:.2}", x(burst + pause));
    let monoflop = times.monoflop.1 * 1e-6;
    let data_ends = x(burst);
    let idle = x((burst + monoflop).min(burst + pause));
    let _ = writeln!(
        svg,
        "<path d=\"{clock}\" stroke=\"#1a5fb4\" fill=\"none\"/>\n\
         <rect x=\"{:.2}\" y=\"92\" width=\"{:.2}\" height=\"24\" fill=\"#b8dcff\" stroke=\"#555\"/>\n\
         <path d=\"M{:.2} 92 H{:.2} M{data_ends:.2} 116 H{idle:.2} V92 H{:.2}\" stroke=\"#26a269\" fill=\"none\"/>",
        x(period / 2.0),
        data_ends - x(period / 2.0),
        x(0.0),
        x(period / 2.0),
        x(burst + pause),
    );
    for (y, name) in [(46, "clock"), (88, "data")] {
        let _ = writeln!(svg, "<text x=\"{MARGIN}\" y=\"{y}\" font-size=\"10\" fill=\"#555\" {FONT}>{name}</text>");
    }
    let mut span = |from: f64, to: f64, y: u32, text: &str| {
        let _ = writeln!(
            svg,
            "<path d=\"M{from:.2} {y} H{to:.2} M{from:.2} {} V{} M{to:.2} {} V{}\" stroke=\"#555\" fill=\"none\"/>\n\
             <text x=\"{:.2}\" y=\"{}\" font-size=\"11\" text-anchor=\"middle\" {FONT}>{}</text>",
            y - 4,
            y + 4,
            y - 4,
            y + 4,
            f64::midpoint(from, to),
            y + 14,
            escaped(text)
        );
    };
    span(x(0.0), x(burst), 130, &format!("{} clocks, {:.2} µs", layout.clocks(), burst * 1e6));
    span(x(burst), x(burst + pause), 130, &format!("pause {:.1} µs, tm up to {:.0} µs", pause * 1e6, monoflop * 1e6));
    svg.push_str("</svg>\n");
    svg
}

fn open(width: u32, height: u32, title: &str) -> String {
    let title = escaped(title);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         role=\"img\" aria-label=\"{title}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n\
         <text x=\"{MARGIN}\" y=\"20\" font-size=\"12\" font-weight=\"bold\" {FONT}>{title}</text>\n"
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
