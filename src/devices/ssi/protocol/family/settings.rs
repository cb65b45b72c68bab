//! Derivation of a frame from the settings of an encoder family.

use super::{Alignment, ErrorPlace, Family, Frame, SettingName};
use crate::devices::ssi::protocol::code::{Code, CodeError, PositionCode};
use crate::devices::ssi::protocol::descriptor::{ErrorBit, FrameDescriptor, GrayCoverage};
use crate::devices::ssi::protocol::layout::{Layout, LayoutError};
use crate::devices::ssi::protocol::range::{Direction, Fraction, Range, RangeError};

/// Settings of an encoder family. `None` selects the factory setting, or the highest resolution that the other settings
/// allow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Width of the multiturn part in bits.
    pub multiturn: Option<u8>,
    /// Width of the singleturn part, or of a linear position, in bits.
    pub singleturn: Option<u8>,
    /// Number of steps per turn, or in total on a round axis, if it is not a power of two.
    pub steps: Option<u32>,
    /// Number of turns, each with `steps` steps.
    pub turns: Option<u32>,
    /// Number of turns over which `steps` are distributed on a round axis.
    pub revolutions: Option<Fraction>,
    /// Code of the position.
    pub code: Option<Code>,
    /// Bits that a Gray code covers.
    pub coded: Option<GrayCoverage>,
    /// Number of clocks in a burst.
    pub clocks: Option<u8>,
    /// Alignment of the position.
    pub align: Option<Alignment>,
    /// Whether the frame is delayed by one clock.
    pub shift: bool,
    /// Location of the error bits.
    pub errors: Option<ErrorPlace>,
    /// Length of a step in nanometres.
    pub step_nanometres: Option<u32>,
    /// Counting direction.
    pub direction: Option<Direction>,
    /// Position at the zero point of the shaft.
    pub preset: Option<u64>,
}

/// The frame that a family sends with certain settings.
#[derive(Clone, Debug, PartialEq)]
pub struct ResolvedFrame {
    /// Layout of the frame.
    pub layout: Layout,
    /// Alignment of the position.
    pub align: Alignment,
    /// Location of the error bits.
    pub errors: ErrorPlace,
    /// Counting direction. It does not affect the decoding of a frame.
    pub direction: Direction,
    /// Position at the zero point of the shaft, within the range. It does not affect the decoding of a frame.
    pub preset: u64,
    /// Remarks about settings that were accepted although the manual does not mention them.
    pub advice: Vec<SettingAdvice>,
}

/// A remark about an accepted setting that the manual does not mention.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingAdvice {
    /// The manual lists other codes for this family.
    Code(Code),
    /// The burst has more clocks than the frame has bits. The content of the additional clocks is unknown.
    Clocks {
        /// Number of bits in the frame.
        bits: u8,
        /// Requested number of clocks.
        clocks: u8,
    },
}

/// The reason why settings are invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingsError {
    /// The family does not have this setting.
    #[error("{family} has no {field}")]
    None {
        /// Name of the encoder family.
        family: String,
        /// Setting that the family does not have.
        field: SettingName,
    },
    /// The two settings cannot be combined.
    #[error("{0} and {1} cannot be used together")]
    Both(SettingName, SettingName),
    /// A value is outside its limits.
    #[error("{family}: {field} must be from {least} to {most}, not {value}")]
    Limit {
        /// Name of the encoder family.
        family: String,
        /// Setting whose value is outside its limits.
        field: SettingName,
        /// Minimum value that the family allows.
        least: u64,
        /// Maximum value that the family allows.
        most: u64,
        /// Requested value.
        value: u64,
    },
    /// The family does not support the alignment, or a position with this alignment does not fit into the frame.
    #[error("{family} does not support the alignment {align} for {bits} position bits; supported: {possible}")]
    Align {
        /// Name of the encoder family.
        family: String,
        /// Width of the position in bits.
        bits: u8,
        /// Requested alignment.
        align: Alignment,
        /// List of the alignments that the family supports.
        possible: String,
    },
    /// The family does not support this location of the error bits.
    #[error("{family} does not support the setting {place} for error bits; supported: {possible}")]
    Errors {
        /// Name of the encoder family.
        family: String,
        /// Requested location of the error bits.
        place: ErrorPlace,
        /// List of the locations that the family supports.
        possible: String,
    },
    /// The burst has more clocks than the encoder allows.
    #[error("{family} supports at most {most} clocks, not {clocks}")]
    Clocks {
        /// Name of the encoder family.
        family: String,
        /// Maximum number of clocks that the family allows.
        most: u8,
        /// Requested number of clocks.
        clocks: u8,
    },
    /// The range of positions is invalid.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The code cannot represent the positions.
    #[error(transparent)]
    Code(#[from] CodeError),
    /// The resulting frame is invalid.
    #[error(transparent)]
    Layout(#[from] LayoutError),
}

impl Settings {
    /// Returns the frame that a family sends with these settings.
    ///
    /// # Errors
    /// Returns a [`SettingsError`] if the family cannot send such a frame.
    pub fn resolve(&self, family: &Family) -> Result<ResolvedFrame, SettingsError> {
        let range = self.position_range(family)?;
        let preset = self.preset.unwrap_or(0);
        check_limit(family, SettingName::Preset, (0, range.last_position()?), preset)?;
        let code = self.code.unwrap_or_else(|| family.code());
        let bits = PositionCode::new(code, range.last_position()?)?.bits();
        let frame = family.frames.iter().find(|frame| bits <= frame.up_to).or(family.frames.last());
        let Some(frame) = frame else {
            return Err(SettingsError::None { family: family.name.clone(), field: SettingName::Frame });
        };
        let fitting =
            |align: &Alignment| leading_zeros(*align, &range, bits).is_some_and(|lead| fits_frame(frame, lead, bits));
        let align = self.align.or_else(|| family.align.iter().copied().find(fitting)).unwrap_or(Alignment::Left);
        let lead = leading_zeros(align, &range, bits)
            .filter(|lead| fits_frame(frame, *lead, bits) && family.align.contains(&align));
        let Some(lead) = lead else {
            let possible = family.align.iter().filter(|align| fitting(align));
            return Err(SettingsError::Align {
                family: family.name.clone(),
                bits,
                align,
                possible: value_list(possible),
            });
        };
        // Alignment to clock 25 is the same as alignment to clock 24 with a shift. See reference section 6, trap 3.
        let shift_right = self.shift && align != Alignment::Right25;
        if shift_right && !family.shift {
            return Err(SettingsError::None { family: family.name.clone(), field: SettingName::ShiftRight });
        }
        let area = frame.area.unwrap_or(bits);
        let place = self.errors.or(frame.place.first().copied()).unwrap_or(ErrorPlace::None);
        if place != ErrorPlace::None && !frame.place.contains(&place) {
            let possible = if frame.place.is_empty() { &[ErrorPlace::None][..] } else { &frame.place };
            return Err(SettingsError::Errors {
                family: family.name.clone(),
                place,
                possible: value_list(possible.iter()),
            });
        }
        let errors = error_bits_at(frame, place, lead + bits);
        let last_error = errors.iter().map(|bit| bit.clock).max().unwrap_or(0);
        // Error bits that follow the position do not change the length of the frame if there is enough room for them.
        let fixed = error_bits_at(frame, ErrorPlace::Fix, 0).iter().map(|bit| bit.clock).max().unwrap_or(0);
        let whole = if place == ErrorPlace::Following && frame.area.is_some() { fixed } else { last_error };
        let own = area.max(whole);
        let clocks = self.clocks.unwrap_or(own);
        let most = frame.most_clocks;
        if let Some(most) = most.filter(|most| clocks > *most) {
            return Err(SettingsError::Clocks { family: family.name.clone(), most, clocks });
        }
        let descriptor = FrameDescriptor {
            clocks,
            range,
            code,
            coded: self.coded.unwrap_or(GrayCoverage::Position),
            // A host that cannot use error bits clocks in only the position, without the zeros after it. See manual
            // 3.1.
            area: if place == ErrorPlace::None { area.min(clocks) } else { area },
            lead,
            between: 0,
            shift_right,
            errors,
            parity: None,
            repeat: None,
            inverted: false,
            patterns: family.patterns.clone(),
        };
        let named = family.codes.contains(&code);
        let longer = clocks > own && most.is_none();
        let advice = [
            (!named).then_some(SettingAdvice::Code(code)),
            longer.then_some(SettingAdvice::Clocks { bits: own, clocks }),
        ];
        let layout = Layout::new(descriptor)?;
        Ok(ResolvedFrame {
            layout,
            align,
            errors: place,
            direction: self.direction.unwrap_or_default(),
            preset,
            advice: advice.into_iter().flatten().collect(),
        })
    }

    fn position_range(&self, family: &Family) -> Result<Range, SettingsError> {
        let none = |field| SettingsError::None { family: family.name.clone(), field };
        let limit = |field, limits, value| check_limit(family, field, limits, value);
        let within = |field, (least, _, most): (u8, u8, u8), value: u8| {
            limit(field, (least.into(), most.into()), value.into()).map(|()| value)
        };
        if let Some(steps) = self.steps {
            let Some(limits) = family.steps else { return Err(none(SettingName::AnySteps)) };
            let others = [
                (self.multiturn.is_some(), SettingName::Mt),
                (self.singleturn.is_some(), SettingName::St),
                (self.step_nanometres.is_some(), SettingName::Step),
            ];
            if let Some((_, other)) = others.into_iter().find(|(given, _)| *given) {
                return Err(SettingsError::Both(SettingName::Steps, other));
            }
            if self.revolutions.is_some() && self.turns.is_some() {
                return Err(SettingsError::Both(SettingName::Revolutions, SettingName::Turns));
            }
            if family.multiturn.is_none() && self.turns.is_some_and(|turns| turns > 1) {
                return Err(none(SettingName::Turns));
            }
            limit(SettingName::Steps, (2, limits.total.into()), steps.into())?;
            return match (self.revolutions, self.turns) {
                (Some(revolutions), _) => {
                    let Some((above, below)) = limits.revolutions else { return Err(none(SettingName::RoundAxis)) };
                    limit(SettingName::RevolutionsAbove, (1, above.into()), revolutions.numerator.into())?;
                    limit(SettingName::RevolutionsBelow, (1, below.into()), revolutions.denominator.into())?;
                    let most = u64::from(limits.per_turn) * u64::from(revolutions.numerator);
                    let most = most / u64::from(revolutions.denominator);
                    limit(SettingName::StepsAround, (2, most), steps.into())?;
                    Ok(Range::RoundAxis { steps, revolutions })
                }
                (None, turns) => {
                    limit(SettingName::StepsPerTurn, (2, limits.per_turn.into()), steps.into())?;
                    let turns = turns.unwrap_or(1);
                    limit(SettingName::StepsAltogether, (2, limits.total.into()), u64::from(steps) * u64::from(turns))?;
                    Ok(Range::Steps { per_turn: steps, turns })
                }
            };
        }
        if self.turns.is_some() || self.revolutions.is_some() {
            return Err(none(SettingName::TurnsWithoutSteps));
        }
        if let Some(step) = family.step_nanometres {
            if self.multiturn.is_some() {
                return Err(none(SettingName::Multiturn));
            }
            let bits = within(SettingName::Bits, family.singleturn, self.singleturn.unwrap_or(family.singleturn.1))?;
            return Ok(Range::Length { bits, step_nanometres: self.step_nanometres.unwrap_or(step) });
        }
        if self.step_nanometres.is_some() {
            return Err(none(SettingName::StepLength));
        }
        let multiturn = match (self.multiturn, family.multiturn) {
            (Some(_), None) => return Err(none(SettingName::Multiturn)),
            (None, None) => 0,
            (asked, Some(limits)) => within(SettingName::MultiturnBits, limits, asked.unwrap_or(limits.1))?,
        };
        let (least, delivered, most) = family.singleturn;
        let left = family.together.map_or(most, |together| together.saturating_sub(multiturn)).min(most);
        let asked = self.singleturn.unwrap_or(delivered.min(left));
        let singleturn = within(SettingName::SingleturnBits, (least, delivered, left), asked)?;
        Ok(Range::Bits { multiturn, singleturn })
    }
}

fn check_limit(
    family: &Family,
    field: SettingName,
    (least, most): (u64, u64),
    value: u64,
) -> Result<(), SettingsError> {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(SettingsError::Limit { family: family.name.clone(), field, least, most, value })
    }
}

/// Returns the number of zeros before the position, or `None` if the position is too wide for the alignment.
fn leading_zeros(align: Alignment, range: &Range, bits: u8) -> Option<u8> {
    let tree = |slot: u8, behind: u8| match *range {
        Range::Bits { multiturn, singleturn } if bits == multiturn + singleturn && singleturn <= behind => {
            slot.checked_sub(multiturn)
        }
        _ => None,
    };
    match align {
        Alignment::Left => Some(0),
        Alignment::Right24 => 24_u8.checked_sub(bits),
        Alignment::Right25 => 25_u8.checked_sub(bits),
        Alignment::Tree12 => tree(12, 13),
        Alignment::Tree13 => tree(13, 12),
    }
}

fn fits_frame(frame: &Frame, lead: u8, bits: u8) -> bool {
    lead + bits <= frame.area.unwrap_or(bits)
}

/// Returns the error bits of a frame at the given location. The last position bit is on clock `behind`.
fn error_bits_at(frame: &Frame, place: ErrorPlace, behind: u8) -> Vec<ErrorBit> {
    let first = frame.errors.iter().map(|bit| bit.clock).min().unwrap_or(1);
    let moved = |bit: &ErrorBit| match place {
        ErrorPlace::Following => ErrorBit { clock: bit.clock - first + behind + 1, ..bit.clone() },
        ErrorPlace::Fix | ErrorPlace::None => bit.clone(),
    };
    if place == ErrorPlace::None { Vec::new() } else { frame.errors.iter().map(moved).collect() }
}

fn value_list<T: ToString>(possible: impl Iterator<Item = T>) -> String {
    let words: Vec<String> = possible.map(|one| one.to_string()).collect();
    if words.is_empty() { "none".to_owned() } else { words.join(", ") }
}
