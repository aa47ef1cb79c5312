//! Which runs are fitted and which are held out, where nobody said so.

use crate::runs::recorded::Recorded;
use headland_calibrate::statistics::quantile_of_sorted;
use headland_calibrate::statistics::sorted;

/// Fewer runs are all needed.
const FEWEST: usize = 3;
/// Of more runs than this every kind is among those that are fitted, whichever are held out.
const MANY: usize = 12;
/// Runs that lie evenly among the others are held out where nothing else decides.
const UNEVEN: f64 = 0.1;

/// What a run is like; what cannot be learned without a run of the same kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traits {
    /// Whether it is driven.
    driven: bool,
    /// The path, and whether it drove the other way.
    way: (usize, bool),
    /// Mass, in steps by which a load is told from none.
    load: i64,
}

/// What the runs are like.
pub fn traits(runs: &[Recorded]) -> Vec<Traits> {
    /// A force that is nearly always below this share of the largest of all runs drives nothing.
    const DRIVES: f64 = 0.1;
    const OFTEN: f64 = 0.9;
    /// A load is told from none by this share of the mass.
    const LOAD: f64 = 0.05;
    let often = |run: &Recorded| {
        let force = run.force_n.as_ref().or(run.pull_n.as_ref())?;
        let sizes = sorted(
            &force.iter().map(|force| force.abs()).filter(|force| force.is_finite()).collect::<Vec<f64>>(),
        );
        (!sizes.is_empty()).then(|| quantile_of_sorted(&sizes, OFTEN))
    };
    let largest = runs.iter().filter_map(often).fold(0.0, f64::max);
    let of = |run: &Recorded| {
        let mass_kg = run.measured.known.iter().find(|(path, _)| path.ends_with("mass_kg"));
        // Far below what a number can hold.
        #[allow(clippy::cast_possible_truncation, reason = "a small number of steps")]
        let load = mass_kg.map_or(0, |(_, mass_kg)| (mass_kg.ln() / LOAD).round() as i64);
        Traits {
            driven: often(run).is_none_or(|force| force > DRIVES * largest),
            way: (run.path, run.measured.how.reversed_from_m.is_some()),
            load,
        }
    };
    runs.iter().map(of).collect()
}

/// Which runs are fitted: all that are not marked; or, where none of those that bear on anything is marked, about two of
/// three, among which is every kind of run.
pub fn split(marked: &[bool], bears: &[bool], traits: &[Traits]) -> (Vec<bool>, bool) {
    // Where no run bears on anything, there is another error.
    let none = !bears.contains(&true);
    let bears = |run: usize| none || bears[run];
    if (0..marked.len()).any(|run| marked[run] && bears(run)) {
        return ((0..marked.len()).map(|run| !marked[run] && bears(run)).collect(), false);
    }
    let bearing: Vec<usize> = (0..marked.len()).filter(|run| bears(*run)).collect();
    // Of ten runs the third, the seventh and the tenth: both directions, early and late.
    let even = |place: usize| place % 10 == 2 || place % 10 == 6 || place % 10 == 9;
    let mut held: Vec<bool> =
        (0..bearing.len()).map(|place| bearing.len() >= FEWEST && even(place)).collect();
    if held.contains(&true) && held.len() <= MANY {
        let own: Vec<Traits> = bearing.iter().map(|run| traits[*run]).collect();
        held = best(&own, &held);
    }
    let mut fit = vec![false; marked.len()];
    for (held, run) in held.iter().zip(&bearing) {
        fit[*run] = !held;
    }
    (fit, true)
}

/// The choice of as many runs that leaves the others the most to learn from.
fn best(traits: &[Traits], even: &[bool]) -> Vec<bool> {
    let wanted = even.iter().filter(|held| **held).count();
    let choices = (0_u32..1 << even.len()).filter(|choice| choice.count_ones() as usize == wanted);
    let choices =
        choices.map(|choice| (0..even.len()).map(|run| choice >> run & 1 == 1).collect::<Vec<bool>>());
    let first = (loss(traits, even, even), even.to_vec());
    choices
        .map(|held| (loss(traits, &held, even), held))
        .fold(first, |best, one| if one.0 < best.0 - 1e-9 { one } else { best })
        .1
}

/// What a choice of runs that are held out loses: kinds of which none is left to learn from.
fn loss(traits: &[Traits], held: &[bool], even: &[bool]) -> f64 {
    let on = |side: bool| traits.iter().zip(held).filter(move |(_, held)| **held == side).map(|(one, _)| one);
    let missing = |alike: &dyn Fn(&Traits, &Traits) -> bool| {
        on(true).filter(|one| !on(false).any(|other| alike(one, other))).count() as f64
    };
    let unlearned = 2.0 * missing(&|one, other| one.driven == other.driven)
        + missing(&|one, other| one.way.0 == other.way.0)
        + missing(&|one, other| one.way == other.way)
        + missing(&|one, other| one.load == other.load)
        + missing(&|one, other| one == other);
    let moved = held.iter().zip(even).filter(|(one, other)| one != other).count() as f64;
    unlearned + UNEVEN * moved / traits.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(driven: bool, reversed: bool) -> Traits {
        Traits { driven, way: (0, reversed), load: 0 }
    }

    #[test]
    fn the_only_run_that_is_driven_is_fitted() {
        let runs = [run(false, false), run(false, true), run(true, false)];
        let (fit, chosen) = split(&[false; 3], &[true; 3], &runs);
        assert!(chosen && fit == [false, true, true], "{fit:?}");
    }

    #[test]
    fn runs_that_are_alike_are_held_out_evenly() {
        let (fit, _) = split(&[false; 10], &[true; 10], &[run(true, false); 10]);
        let held: Vec<usize> = (0..10).filter(|run| !fit[*run]).collect();
        assert_eq!(held, [2, 6, 9]);
    }

    #[test]
    fn what_is_marked_stays_and_two_runs_are_both_fitted() {
        let runs = [run(true, false); 4];
        assert_eq!(split(&[false, true, false, false], &[true; 4], &runs).0, [true, false, true, true]);
        assert_eq!(split(&[false; 2], &[true; 2], &runs[..2]).0, [true, true]);
        assert_eq!(split(&[false; 3], &[true, true, false], &runs[..3]).0, [true, true, false]);
    }

    /// Each way is driven twice and coasted twice, and two of the eight runs are held out.
    #[test]
    fn every_kind_of_run_stays_among_those_that_are_fitted() {
        let runs: Vec<Traits> = (0..8).map(|index| run(index % 4 > 1, index % 2 == 1)).collect();
        let (fit, _) = split(&[false; 8], &[true; 8], &runs);
        assert_eq!(fit.iter().filter(|fit| !**fit).count(), 2);
        for kind in &runs {
            assert!(runs.iter().zip(&fit).any(|(one, fit)| one == kind && *fit));
        }
    }
}
