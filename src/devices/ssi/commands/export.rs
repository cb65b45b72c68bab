//! The command `ssi export`, which exports a layout for other programs or as a profile.

use std::time::Duration;

use serde_json::json;

use super::args::{SsiExportArgs, SsiFormat};
use super::layout::{SelectedLayout, select_layout};
use super::profiles::{profile_document, write};
use crate::cli::output::Output;
use crate::cli::{Failure, Result, Success};
use crate::devices::ssi::protocol::{
    ReadConditions, Times, WordWidthError, bit_table, english_text, frame_drawing, generate_c99, scl_source,
    settings_sheet, structured_text, structured_text_32, timing_drawing, to_linuxcnc,
};
use crate::devices::ssi::state::TEXTS;
use crate::devices::ssi::state::explain;

pub(super) fn export(output: &Output, arguments: &SsiExportArgs) -> Result {
    let SsiExportArgs { layout: spec, format, file, clock, pause, cable, synchronous } = arguments;
    let is_timed = clock.is_some() || pause.is_some() || cable.is_some() || *synchronous;
    if is_timed && *format != SsiFormat::Timing {
        return Err(Failure::Usage("--clock, --pause, --cable and --synchronous are for --format timing".to_owned()));
    }
    let chosen = select_layout(output, spec)?;
    let SelectedLayout { layout, times, title, .. } = &chosen;
    let text = match format {
        SsiFormat::C => generate_c99(layout, title),
        SsiFormat::St => structured_text(layout, title),
        SsiFormat::StDword => structured_text_32(layout, title).map_err(word_width_failure)?,
        SsiFormat::Scl => scl_source(layout, title).map_err(word_width_failure)?,
        SsiFormat::Linuxcnc => to_linuxcnc(layout).map_err(|error| Failure::Failed(vec![format!("{error}.")]))? + "\n",
        SsiFormat::Csv => bit_table(layout, &english_text),
        SsiFormat::Sheet => settings_sheet(layout, times.as_ref(), title, &english_text),
        SsiFormat::Svg => frame_drawing(layout, None, title, &english_text).to_svg(),
        SsiFormat::Profile => profile_document(chosen.profile).emit(),
        SsiFormat::Timing => {
            // The default of each option comes from the profile.
            let own = chosen.profile.read_conditions();
            let reads = ReadConditions {
                clock_hz: clock.map_or(own.clock_hz, f64::from),
                pause: pause.map_or(own.pause, |micros| Duration::from_micros(micros.into())),
                cable_metres: cable.map(f64::from).or(own.cable_metres),
                synchronous: *synchronous || own.synchronous,
                ..own
            };
            let timing = match times {
                Some(times) => times.calculate_timing(&reads),
                None => {
                    output.print_message(&TEXTS.text("ssi_timing.general").terminal_text());
                    Times::for_any_encoder(&reads)
                }
            };
            for warning in timing.warnings {
                output.print_message(&explain::timing_warning_text(&warning).terminal_text());
            }
            timing_drawing(layout, times.as_ref().unwrap_or(&Times::GENERAL_LIMITS), &reads, title, &english_text)
                .to_svg()
        }
    };
    match file {
        None => output.show(&json!({ "text": text }), &text)?,
        Some(path) => {
            write(path, &text)?;
            output.show(&json!({ "file": path.display().to_string() }), "")?;
        }
    }
    Ok(Success::Completed)
}

fn word_width_failure(error: WordWidthError) -> Failure {
    Failure::Failed(vec![explain::word_width_error_text(error).terminal_text()])
}
