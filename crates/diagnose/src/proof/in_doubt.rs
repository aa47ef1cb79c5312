//! Free parameters where a cause is in doubt: their intervals hold whichever of the named ones it is.

use crate::proof::refine::{HALF_95, Refined};

/// Widens the intervals of the free parameters by what each is beside the rivals of what was found; `bounds` are those of each,
/// and `changes` how far what was found has it from where the scenario does.
pub fn widen(refined: &mut Refined, bounds: &[(f64, f64)], changes: &[f64]) {
    for rival in refined.causes.iter().flat_map(|cured| &cured.accepted.rivals) {
        for (place, (free, beside)) in refined.free.iter_mut().zip(&rival.free).enumerate() {
            let (low, high) = bounds[place];
            let value = free.value + beside.change - changes[place];
            let half = HALF_95 * beside.sd;
            free.ci95[0] = free.ci95[0].min((value - half).max(low));
            free.ci95[1] = free.ci95[1].max((value + half).min(high));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::causes::catalogue::spell;
    use crate::causes::trial::Trial;
    use crate::choosing::search::{Accepted, Beside, Rival};
    use crate::proof::refine::{Cured, Free};

    /// A coefficient of 0.06 beside the cause that was found, of 0.08 beside its rival and of no more than 0.083 at all.
    #[test]
    fn an_interval_holds_what_a_rival_makes_of_it_within_its_bounds() {
        let rival = |sd: f64| Rival {
            cause: 0,
            gain: 20.0,
            squared_correlation: 0.9,
            free: vec![Beside { change: 0.03, sd }],
        };
        let of = |rivals: Vec<Rival>| {
            let trial = Trial::new(0, &[], Vec::new(), Vec::new());
            let accepted = Accepted {
                trial,
                gain: 20.0,
                by_chance: 7.0,
                rivals,
                function: None,
                along: None,
                balance: 0,
            };
            let cause = spell("grade");
            let cured = Cured::new(cause, accepted, Vec::new());
            let name = "coefficient".to_owned();
            let free = Free { name, prior: 0.05, value: 0.06, ci95: [0.058, 0.062], asked: 0.06 };
            let mut refined = Refined { causes: vec![cured], free: vec![free], null_space: Vec::new() };
            widen(&mut refined, &[(0.01, 0.083)], &[0.01]);
            refined.free[0].ci95
        };
        let near = |found: [f64; 2], expected: [f64; 2]| {
            assert!((0..2).all(|end| (found[end] - expected[end]).abs() < 1e-12), "{found:?}");
        };
        near(of(Vec::new()), [0.058, 0.062]);
        near(of(vec![rival(0.001)]), [0.058, 0.08 + 1.96e-3]);
        near(of(vec![rival(0.001), rival(0.03)]), [0.08 - 1.96 * 0.03, 0.083]);
    }
}
