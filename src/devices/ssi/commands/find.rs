//! The command `ssi find`, which lists the layouts that fit recorded frames, best first, and the motion that would
//! distinguish them.

use serde_json::{Value as Json, json};

use super::args::SsiFindArgs;
use super::layout::families;
use super::source;
use crate::cli::output::{Lines, Output, count};
use crate::cli::runner::to_failure;
use crate::cli::{Result, Success};
use crate::devices::ssi::protocol::{self, Families, LayoutClass, Search};
use crate::devices::ssi::state::Frames;
use crate::devices::ssi::state::explain;

/// Maximum number of bits in a frame, and the default for hexadecimal frames.
const MAX_CLOCKS: u8 = 64;

pub(super) fn find(output: &Output, SsiFindArgs { file, clocks }: &SsiFindArgs) -> Result {
    let families = families(output)?;
    let Frames { clocks: read, frames, are_numbers, .. } = source::read(output, file, clocks.unwrap_or(MAX_CLOCKS))?;
    let clocks = match clocks {
        // Hexadecimal digits do not show how many zeros precede the highest 1.
        None if are_numbers => {
            let any = frames.iter().fold(1, |any, frame| any | frame);
            let clocks = (u64::BITS - any.leading_zeros()) as u8;
            output.print_message(&format!(
                "Frames in hex and decimal do not show their number of clocks; {clocks} was assumed. Use --clocks N to set it."
            ));
            clocks
        }
        _ => read,
    };
    let search = protocol::find(&frames, clocks, &families);
    output.show(&json(&search, &families), &text(&search, &families))?;
    if search.classes.is_empty() {
        return Err(to_failure(&explain::uncertainty_text(search.uncertainty)));
    }
    Ok(Success::Completed)
}

fn json(search: &Search, families: &Families) -> Json {
    let layouts: Vec<Json> = search
        .classes
        .iter()
        .map(|class| {
            let others: Vec<String> = class.members.iter().skip(1).map(|member| member.spec_text(families)).collect();
            json!({
                "spec": spec_text(class, families),
                "score": class.evidence.score,
                "explained": class.evidence.explained,
                "why": evidence_text(class),
                "same": others,
            })
        })
        .collect();
    json!({
        "frames": search.frames,
        "layouts": layouts,
        "ambiguous": search.uncertainty.is_some(),
        "next": next_motion(search).filter(|_| search.uncertainty.is_some()),
    })
}

fn text(search: &Search, families: &Families) -> String {
    if search.classes.is_empty() {
        return String::new();
    }
    let mut lines = Lines::default();
    lines.add_line("frames", search.frames);
    for (number, class) in (1..).zip(&search.classes) {
        lines.add_line(format!("layout {number}"), spec_text(class, families));
        lines.add_line("  score", format!("{:.2}", class.evidence.score));
        lines.add_line("  why", evidence_text(class));
        let others = class.members.len().saturating_sub(1);
        if others > 0 {
            let shown: Vec<String> =
                class.members.iter().skip(1).take(3).map(|member| member.spec_text(families)).collect();
            let same = format!("{}, as {}", count(others, "layout"), shown.join(" or "));
            lines.add_line("  the same here", same);
        }
    }
    let verdict = explain::uncertainty_text(search.uncertainty).terminal_text();
    let next = next_motion(search).map_or_else(String::new, |next| next + "\n");
    format!("{}{verdict}\n{next}", lines.text())
}

/// Returns the most probable layout of a class as a value for `--layout`.
fn spec_text(class: &LayoutClass, families: &Families) -> String {
    class.members.first().map_or_else(String::new, |member| member.spec_text(families))
}

fn evidence_text(class: &LayoutClass) -> String {
    let frame = class.members.first().map(|member| explain::layout_summary(&member.layout).terminal_text());
    let evidence = explain::evidence_for(&class.evidence).terminal_text();
    frame.into_iter().chain([evidence]).collect::<Vec<_>>().join("; ")
}

/// Returns the motion that would distinguish the remaining layouts, or `None` if the result is certain.
fn next_motion(search: &Search) -> Option<String> {
    let uncertainty = search.uncertainty.filter(|uncertainty| *uncertainty != protocol::UncertaintyReason::Open);
    let uncertainty = uncertainty.map(|uncertainty| explain::uncertainty_text(Some(uncertainty)).terminal_text());
    let open = search.classes.first().into_iter().flat_map(|class| &class.open);
    let open = open.map(|open| explain::open_question_text(*open).terminal_text());
    let all: Vec<String> = uncertainty.into_iter().chain(open).collect();
    (!all.is_empty()).then(|| all.join(" "))
}
