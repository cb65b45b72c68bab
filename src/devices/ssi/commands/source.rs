//! Frames given to a command: as arguments, in a file, or on standard input.

use std::io::Read;
use std::path::Path;

use crate::cli::output::Output;
use crate::cli::runner::to_failure;
use crate::cli::{Failure, Result};
use crate::devices::ssi::protocol::{FrameTextError, Layout, parse_frame};
use crate::devices::ssi::state::{Frames, Origin, TEXTS, parse_frame_file, read_frames};
use crate::store::MAX_TEXT_BYTES;

/// Argument that selects standard input instead of a file or a frame.
const INPUT: &str = "-";

/// Reads frames from a file, or from standard input if the path is `-`. A frame written as a number has `clocks` bits.
/// A remark reports incomplete bursts.
pub(super) fn read(output: &Output, path: &Path, clocks: u8) -> Result<Frames> {
    let frames = if path == Path::new(INPUT) {
        parse_frame_file(&input()?, "standard input".to_owned(), clocks)
    } else {
        read_frames(path, clocks)
    };
    let frames = frames.map_err(|why| to_failure(&why))?;
    if frames.left_out > 0 {
        output.print_message(&TEXTS.text("ssi_capture.left_out").with("count", frames.left_out).terminal_text());
    }
    Ok(frames)
}

fn input() -> Result<String> {
    let mut text = String::new();
    let unreadable = |error: std::io::Error| Failure::Failed(vec![format!("Standard input cannot be read: {error}.")]);
    std::io::stdin().lock().take(MAX_TEXT_BYTES + 1).read_to_string(&mut text).map_err(unreadable)?;
    if text.len() as u64 > MAX_TEXT_BYTES {
        let too_large = TEXTS.text("ssi_capture.too_large").with("path", "Standard input");
        return Err(to_failure(&too_large.with("megabytes", MAX_TEXT_BYTES >> 20)));
    }
    Ok(text)
}

/// Returns the frames given by an argument: a single frame, `@FILE`, or `-` for standard input.
pub(super) fn read_frame_argument(output: &Output, layout: &Layout, text: &str) -> Result<Vec<u64>> {
    let path = match text.strip_prefix('@') {
        Some(path) => path,
        None if text == INPUT => INPUT,
        None => return parse_frame_argument(layout, text).map(|frame| vec![frame]),
    };
    let clocks = layout.clock_count();
    let Frames { origin, clocks: bits, frames, .. } = read(output, Path::new(path), clocks)?;
    if bits != clocks {
        let name = match origin {
            Origin::File(name) => name,
            Origin::Live => path.to_owned(),
        };
        let other = TEXTS.text("ssi_capture.other_clocks").with("name", name);
        return Err(to_failure(&other.with("bits", bits).with("clocks", clocks)));
    }
    Ok(frames)
}

/// Parses a frame argument into right-justified bits.
fn parse_frame_argument(layout: &Layout, text: &str) -> Result<u64> {
    parse_frame(text, layout.clock_count()).map_err(|error| match error {
        FrameTextError::Form(_) => Failure::Usage(error.to_string()),
        FrameTextError::Bits { .. } => Failure::Failed(vec![format!("{error}.")]),
    })
}
