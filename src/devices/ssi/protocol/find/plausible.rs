//! Plausibility of a layout. Most encoders have one of a few common widths, and none has, for example, 4096 turns of 2
//! steps. The most common layout has a weight of 0, and a changed setting has a weight of about 1.

/// Common numbers of step bits with their weights.
const STEPS: [(u8, f64); 16] = [
    (12, 0.0),
    (13, 0.0),
    (14, 0.2),
    (10, 1.0),
    (16, 0.6),
    (17, 0.6),
    (18, 0.6),
    (15, 1.0),
    (19, 1.2),
    (20, 1.2),
    (9, 1.4),
    (11, 1.4),
    (8, 1.4),
    (21, 1.6),
    (22, 1.6),
    (24, 1.6),
];
/// Common numbers of turn bits with their weights.
const TURNS: [(u8, f64); 9] =
    [(0, 0.0), (12, 0.0), (13, 0.6), (16, 0.6), (14, 1.0), (10, 1.4), (8, 1.4), (15, 1.6), (11, 1.6)];
/// Minimum number of step bits in multiturn encoders.
const MIN_MULTITURN_STEP_BITS: u8 = 8;

/// Returns the weight of a combination of turn bits and step bits. Less common combinations have a higher weight.
pub(super) fn width_penalty(multiturn: u8, singleturn: u8) -> f64 {
    let of = |table: &[(u8, f64)], bits: u8, other: f64| {
        table.iter().find(|(known, _)| *known == bits).map_or(other, |(_, weight)| *weight)
    };
    let few = if singleturn < MIN_MULTITURN_STEP_BITS { f64::from(MIN_MULTITURN_STEP_BITS - singleturn) } else { 0.0 };
    let many = if multiturn == 0 && singleturn > 18 { 1.0 } else { 0.0 };
    of(&STEPS, singleturn, 2.5) + of(&TURNS, multiturn, 2.5) + few + many
}

/// Returns the usual ways to divide the bits into turns and steps, most common first.
pub(super) fn common_bit_splits(bits: u8, most: usize) -> Vec<(u8, u8)> {
    let mut all: Vec<(u8, u8)> =
        (0..bits).map(|turns| (turns, bits - turns)).filter(|(turns, steps)| *turns <= 32 && *steps <= 32).collect();
    all.sort_by(|a, b| width_penalty(a.0, a.1).total_cmp(&width_penalty(b.0, b.1)));
    all.truncate(most);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_widths_rank_first() {
        assert_eq!(common_bit_splits(25, 1), [(12, 13)]);
        assert_eq!(common_bit_splits(24, 1), [(12, 12)]);
        assert_eq!(common_bit_splits(13, 1), [(0, 13)]);
        assert_eq!(common_bit_splits(30, 1), [(12, 18)]);
        assert_eq!(common_bit_splits(1, 4), [(0, 1)]);
        assert!(width_penalty(12, 1) > width_penalty(0, 13) + 6.0, "4096 turns of 2 steps");
        assert!(common_bit_splits(64, 9).iter().all(|(turns, steps)| turns + steps == 64));
    }
}
