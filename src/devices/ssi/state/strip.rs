//! A frame as a row of cells, one for each clock. The boundaries between fields and single bits can be moved. A move
//! returns a new frame and does not change the layout.

mod labels;
mod moving;
#[cfg(test)]
mod tests;

pub use labels::{
    cell_text, clocks_text, field, field_name, handle_hint, handle_text, name, reach_text, short_label, value,
};
pub use moving::move_part;

use crate::devices::ssi::protocol::{BitMeaning, Flags, GrayCoverage, Layout, Range, Role, Word};

/// A frame divided into cells and fields.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    layout: Layout,
    cells: Vec<Cell>,
    fields: Vec<Field>,
    handles: Vec<Handle>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Clock number, starting at 1.
    pub clock: u8,
    pub role: Role,
    /// Index of the field that contains the cell.
    pub field: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    pub kind: Kind,
    /// First clock of the field.
    pub first: u8,
    /// Last clock of the field.
    pub last: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Zeros before the position.
    Before,
    /// Zeros between turns and steps.
    Between,
    /// Zeros after the position.
    Behind,
    Gap,
    /// Zeros after the repetition.
    After,
    Turns,
    Steps,
    /// Bits of a position that is not divided into turns and steps.
    Position,
    Error(usize),
    Parity,
    Again,
}

/// A movable part of a frame. A boundary is located after a clock, or at 0 before the first clock. A bit and the
/// position are located on a clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Handle {
    /// Start of the position. If it is moved, zeros before the position become turn bits, or turn bits become zeros.
    LeadEnd,
    /// Boundary between turns and steps without zeros between them. If it is moved, turn bits become step bits, or step
    /// bits become turn bits.
    Split,
    /// End of the turns, before zeros that separate turns and steps.
    TurnsEnd,
    /// Start of the steps, after zeros that separate turns and steps.
    BetweenEnd,
    /// End of the position. If it is moved, free bits after the position become step bits, or step bits become free
    /// bits.
    StepsEnd,
    /// End of the area that is coded or shifted together with the position.
    AreaEnd,
    /// End of the first word in a frame that sends the word twice.
    WordEnd,
    GapEnd,
    FrameEnd,
    Position,
    Error(usize),
    Parity,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellState {
    pub bit: bool,
    /// Effect on the position if the bit is an active error bit, or a 1 that should be 0.
    pub meaning: Option<BitMeaning>,
}

impl Strip {
    pub fn from_layout(layout: &Layout) -> Self {
        let descriptor = layout.descriptor();
        let roles = layout.clock_roles();
        let is_position = |role: &Role| matches!(role, Role::Multiturn(_) | Role::Singleturn(_) | Role::Position(_));
        let is_turns = |role: &Role| matches!(role, Role::Multiturn(_));
        let is_steps = |role: &Role| matches!(role, Role::Singleturn(_));
        let begins = roles.iter().position(is_position).unwrap_or(0);
        let between = match (roles.iter().rposition(is_turns), roles.iter().position(is_steps)) {
            (Some(last), Some(first)) => last..first,
            _ => 0..0,
        };
        let word = usize::from(descriptor.clocks_per_word());
        let gap = descriptor.repeat.map_or(0, |repeat| usize::from(repeat.gap));
        let kind = |at: usize, role: Role| match role {
            Role::Zero if at >= word + gap => Kind::After,
            Role::Zero if at >= word => Kind::Gap,
            Role::Zero if at < begins => Kind::Before,
            Role::Zero if between.contains(&at) => Kind::Between,
            Role::Zero => Kind::Behind,
            Role::Multiturn(_) => Kind::Turns,
            Role::Singleturn(_) => Kind::Steps,
            Role::Position(_) => Kind::Position,
            Role::Error(index) => Kind::Error(index),
            Role::Parity => Kind::Parity,
            Role::Repetition(_) => Kind::Again,
        };
        // In a frame without a repetition, all zeros after the position are of the same kind.
        let kind = |at: usize, role: Role| match kind(at, role) {
            Kind::After if descriptor.repeat.is_none() => Kind::Behind,
            kind => kind,
        };
        let (mut cells, mut fields): (Vec<Cell>, Vec<Field>) = (Vec::new(), Vec::new());
        for (at, (clock, role)) in (1..=layout.clock_count()).zip(&roles).enumerate() {
            let kind = kind(at, *role);
            match fields.last_mut() {
                Some(field) if field.kind == kind => field.last = clock,
                _ => fields.push(Field { kind, first: clock, last: clock }),
            }
            cells.push(Cell { clock, role: *role, field: fields.len().saturating_sub(1) });
        }
        let handles = moving::strip_handles(layout);
        Strip { layout: layout.clone(), cells, fields, handles }
    }

    pub const fn layout(&self) -> &Layout {
        &self.layout
    }

    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// Returns the movable parts in clock order.
    pub fn strip_handles(&self) -> &[Handle] {
        &self.handles
    }

    /// Returns the clock of a part, from 0 to 64, or `None` if the frame does not have the part.
    pub fn clock(&self, handle: Handle) -> Option<u8> {
        moving::clock(&self.layout, handle)
    }

    /// Returns the strip after a part was moved to a clock, or as close to it as possible. See [`move_part`].
    pub fn with_moved_part(&self, handle: Handle, to: u8, following: bool) -> Strip {
        Strip::from_layout(&move_part(&self.layout, handle, to, following))
    }

    /// Returns the first and the last clock to which a part can be moved.
    pub fn limits(&self, handle: Handle, following: bool) -> (u8, u8) {
        let end = |to| moving::clock(&move_part(&self.layout, handle, to, following), handle).unwrap_or(to);
        (end(0), end(u8::MAX))
    }

    pub fn position(&self) -> Option<(u8, u8)> {
        let own = |field: &&Field| matches!(field.kind, Kind::Turns | Kind::Steps | Kind::Position);
        let first = self.fields.iter().find(own)?;
        let last = self.fields.iter().rfind(own)?;
        Some((first.first, last.last))
    }

    pub fn cell_states(&self, frame: u64) -> Vec<CellState> {
        let descriptor = self.layout.descriptor();
        let flags = self.layout.decode(frame).flags;
        let cells = self.layout.to_cells(frame).into_iter();
        cells
            .map(|cell| {
                let meaning = match cell.role {
                    Role::Error(index) if flags.contains(Flags::error(index)) => {
                        descriptor.errors.get(index).map(|bit| bit.meaning)
                    }
                    // If the Gray code covers more than the position, a zero can be sent as a 1.
                    Role::Zero if descriptor.coded == GrayCoverage::Position && cell.bit != descriptor.inverted => {
                        Some(BitMeaning::Warning)
                    }
                    Role::Parity if flags.contains(Flags::PARITY) => Some(BitMeaning::Invalid),
                    Role::Repetition(clock) if self.bit(frame, clock) != cell.bit => Some(BitMeaning::Invalid),
                    _ => None,
                };
                CellState { bit: cell.bit, meaning }
            })
            .collect()
    }

    fn bit(&self, frame: u64, clock: u8) -> bool {
        let behind = self.layout.clock_count().saturating_sub(clock);
        frame >> behind & 1 == 1
    }
}

impl Field {
    pub const fn count(&self) -> u8 {
        self.last.saturating_sub(self.first) + 1
    }

    pub const fn is_zero_field(&self) -> bool {
        matches!(self.kind, Kind::Before | Kind::Between | Kind::Behind | Kind::Gap | Kind::After)
    }

    /// Returns whether the field is an error or parity bit. Each of these bits is a separate field.
    pub const fn is_single_bit(&self) -> bool {
        matches!(self.kind, Kind::Error(_) | Kind::Parity)
    }
}

impl Handle {
    /// Returns whether the handle is located on a clock, rather than between two clocks.
    pub const fn is_on_clock(self) -> bool {
        matches!(self, Handle::Error(_) | Handle::Parity | Handle::Position)
    }
}

/// Returns whether error or parity bits directly follow the position and therefore move with its end.
pub fn bits_follow_position(layout: &Layout) -> bool {
    !moving::bits_after_position(layout).is_empty()
}

/// Returns whether the frame has patterns of explicit bits, which depend on the length of the frame.
fn has_explicit_bit_patterns(layout: &Layout) -> bool {
    layout.descriptor().patterns.iter().any(|pattern| matches!(pattern.word, Word::Bits(_)))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PositionParts {
    /// Numbers of turn bits and step bits. Neither is 0.
    Both(u8, u8),
    /// Number of bits, if there are only turn bits or only step bits.
    One(u8),
    /// Number of bits needed for a number of steps, which cannot be changed bit by bit.
    Whole(u8),
}

impl PositionParts {
    fn from_layout(layout: &Layout) -> Self {
        let bits = layout.position_code().bits();
        match layout.descriptor().range {
            Range::Bits { multiturn, singleturn } if bits == multiturn + singleturn => {
                if multiturn > 0 && singleturn > 0 {
                    PositionParts::Both(multiturn, singleturn)
                } else {
                    PositionParts::One(bits)
                }
            }
            Range::Length { bits: own, .. } if bits == own => PositionParts::One(bits),
            _ => PositionParts::Whole(bits),
        }
    }

    const fn bits(self) -> u8 {
        match self {
            PositionParts::Both(turns, steps) => turns + steps,
            PositionParts::One(bits) | PositionParts::Whole(bits) => bits,
        }
    }
}
