//! Arguments of `ssi`, and the `--layout` option that shared commands accept for SSI encoders.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

#[derive(Subcommand)]
pub(crate) enum Ssi {
    /// Decode frames.
    Decode(SsiDecodeArgs),
    /// Encode a position as a frame.
    Encode(SsiEncodeArgs),
    /// Find layouts that match recorded frames, best match first.
    ///
    /// The shaft must turn during the recording. Each layout is printed as a SPEC for --layout.
    Find(SsiFindArgs),
    /// Export a layout as a decoder or a table for other programs, as a picture, or as a profile.
    #[command(after_long_help = PROFILE)]
    Export(SsiExportArgs),
}

/// Help text that explains the entries of a handwritten profile.
const PROFILE: &str = "\
Entries of the frame in a profile (omitted entries have their default values):
  clocks: 27                       number of bits in a burst, 1 to 64
  multiturn: 12, singleturn: 14    number of turn bits and of step bits
    steps: 3600, turns: 4096       alternative: any number of steps per turn
    steps: 100, revolutions: \"25/2\"
                                   alternative: steps over a number of turns (round axis)
    bits: 24, step_nanometres: 1000
                                   alternative: a length
  code: \"gray\"                     binary, gray, gray-excess or bcd
  over: \"padded\"                   bits in Gray code: position, padded (zeros too) or errors (error bits too)
  area: 26                         number of clocks of the position, including the zeros before and after it
  lead: 1, between: 2              zeros before the position, and between turns and steps
  shift: true                      the area is sent one clock later, and its last bit is lost
  inverted: true                   the data wires are swapped
  errors: [(name: \"ERROR\", clock: 27, meaning: \"invalid\")]
                                   or meaning \"warning\"; also active_low: true, cleared_by_transfer: true
  parity: (clock: 28, even: true)  parity bit over all previous bits
  repeat: (word: 25, gap: 1)       the frame is sent twice in a burst
  patterns: [(name: \"fault\", word: \"ones\", meaning: \"invalid\")]
                                   frames that are not positions; the word is ones or 0x…
Other entries of a profile: name, family (defines the timing), direction: \"ccw\", preset: 100, and
  reading: (clock_hz: 400000, pause_us: 200, cable_metres: 20, synchronous: true)";

#[derive(Args)]
pub(crate) struct SsiDecodeArgs {
    #[command(flatten)]
    pub(crate) layout: SsiLayoutArgs,
    /// Frame as bits in clock order (0b1010… or 1010…), or as 0x…, right-justified; repeatable. @FILE reads the frames
    /// from a file in a format accepted by ssi find, and - reads them from standard input.
    #[arg(required = true, value_name = "FRAME")]
    pub(crate) frames: Vec<String>,
}

#[derive(Args)]
pub(crate) struct SsiFindArgs {
    /// File with one frame per line, in the order of reading, as bits in clock order or as 0x…, right-justified; other
    /// columns are ignored. A table from position ssi --csv is also accepted, as are clock and data from a logic
    /// analyser (CSV from Saleae Logic or sigrok). Use - for standard input.
    #[arg(value_name = "FRAMES.txt")]
    pub(crate) file: PathBuf,
    /// Number of bits per frame, for frames in hexadecimal.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=64))]
    pub(crate) clocks: Option<u8>,
}

#[derive(Args)]
pub(crate) struct SsiEncodeArgs {
    #[command(flatten)]
    pub(crate) layout: SsiLayoutArgs,
    /// Turns and steps as one number. If also given, --turns and --steps must match it.
    #[arg(long, value_name = "N", required_unless_present = "steps", allow_negative_numbers = true)]
    pub(crate) position: Option<String>,
    /// Whole turns. Default: 0.
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(crate) turns: Option<String>,
    /// Steps within the turn.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(crate) steps: Option<String>,
    /// Name of an error bit to set; repeatable.
    #[arg(long = "error", value_name = "NAME")]
    pub(crate) errors: Vec<String>,
}

#[derive(Args)]
pub(crate) struct SsiExportArgs {
    #[command(flatten)]
    pub(crate) layout: SsiLayoutArgs,
    /// Format to write.
    #[arg(long, value_enum)]
    pub(crate) format: SsiFormat,
    /// timing: clock in hertz. Default: the value in the profile, or else 400000.
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u32).range(1_000..=20_000_000))]
    pub(crate) clock: Option<u32>,
    /// timing: pause after a burst in microseconds. Default: the value in the profile, or else 250.
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) pause: Option<u32>,
    /// timing: cable length in metres.
    #[arg(long, value_name = "M")]
    pub(crate) cable: Option<u16>,
    /// timing: synchronous mode, in which the encoder samples the position in step with the host's clock.
    #[arg(long)]
    pub(crate) synchronous: bool,
    /// File to write. Default: standard output.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    pub(crate) file: Option<PathBuf>,
}

/// The optional `--layout` argument of shared commands.
#[derive(Args)]
pub(super) struct LayoutOption {
    #[arg(long, value_name = "FILE|SPEC")]
    pub(super) layout: Option<String>,
}

#[derive(Args)]
pub(crate) struct SsiLayoutArgs {
    /// Profile of an SSI encoder, or a family with settings, such as ahm36,code=gray,st=12. Omitted settings
    /// have the factory value and the highest resolution.
    ///
    /// Families: ahs36 ahm36 afs60 afm60 afs60s afm60s atm60 atm90 ars60 ttk70 kh53. Settings:
    /// code=binary|gray|gray-excess|bcd, over=position|padded|errors (bits in Gray code), mt= and st= (bits), steps=
    /// with turns= or revolutions=25/2, clocks=, align=left|right24|right25|tree12_13|tree13_12, shift=0|1,
    /// err=none|fix|following, step= (nanometres), direction=cw|ccw and preset= (which do not change how a frame is
    /// read). Or linuxcnc: followed by a LinuxCNC format string. Or any frame, as printed by ssi find:
    /// frame,clocks=27,lead=1,mt=12,st=13,code=gray,ones=1 with clocks=, mt= and st= (or steps= with turns= or
    /// revolutions=, or bits= with step=), code=, over=, area=, lead=, between=, shift=, inverted=0|1,
    /// parity=even@27|odd@27, repeat=25+1, and clocks of further bits: ones= (always 1), err=, unknown=.
    #[arg(long = "layout", value_name = "FILE|SPEC")]
    pub(crate) spec: String,
}

/// Format of an exported layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SsiFormat {
    /// A function in C99.
    C,
    /// A function block in IEC 61131-3 structured text.
    St,
    /// A LinuxCNC format string for ssi_chan.
    Linuxcnc,
    /// A table with one row for each clock.
    Csv,
    /// Settings for common SSI modules of PLCs.
    Sheet,
    /// A profile for --layout and the window.
    Profile,
    /// A picture of the frame.
    Svg,
    /// A timing diagram of a burst; violated limits are reported on stderr.
    Timing,
    /// Structured text for 32-bit PLCs: DWORD instead of LWORD, and two of them for frames of more than 32 clocks.
    StDword,
    /// A function block for S7-1200 and S7-1500, as a source file for TIA Portal.
    Scl,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::ssi::protocol::Families;

    #[test]
    fn built_in_families_have_help_and_profile() {
        let command = SsiLayoutArgs::augment_args(clap::Command::new("test"));
        let option = command.get_arguments().find(|option| option.get_id() == "spec").unwrap();
        let help = option.get_long_help().unwrap().to_string();
        let (_, families) = help.split_once("Families: ").unwrap();
        let (listed, _) = families.split_once('.').unwrap();
        let listed: Vec<&str> = listed.split_whitespace().collect();
        for family in Families::built_in().iter() {
            assert!(listed.contains(&family.key.as_str()), "{} is not in the help", family.key);
            let profile = format!("{}/profiles/ssi/{}.ron", env!("CARGO_MANIFEST_DIR"), family.key);
            assert!(std::path::Path::new(&profile).exists(), "{profile} does not exist");
        }
    }
}
