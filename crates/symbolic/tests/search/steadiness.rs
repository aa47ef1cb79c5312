//! The same question has the same answer, to the bit.

use crate::plant::{At, Plant, Sparse};
use crate::recovery::options;
use headland_symbolic::{Found, Options, Problem, find};

fn law(at: &At) -> f64 {
    400.0 * (-((at.v - 5.0) / 1.1_f64).powi(2)).exp()
}

/// Every number to its last digit.
fn told(found: &Found) -> String {
    format!("{found:?}")
}

#[test]
fn one_thread_and_two_find_the_same_bits() {
    let made = Plant::new(21, 6, 120.0).problem(21, law);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| told(&find(&made.problem(), &options(), &|| false).unwrap()))
    };
    let one = with(1);
    assert!(one == with(2) && one == with(3));
}

#[test]
fn runs_that_may_not_be_fitted_change_nothing_but_their_own_figure() {
    let plant = Plant::new(22, 6, 120.0);
    let made = plant.problem(22, law);
    let mut other = plant.problem(22, law);
    assert!(!made.fit[2]);
    other.residual[2].iter_mut().for_each(|row| *row += 50.0);
    let (one, two) = (
        find(&made.problem(), &options(), &|| false).unwrap(),
        find(&other.problem(), &options(), &|| false).unwrap(),
    );
    let (one, two) = (one.law().unwrap(), two.law().unwrap());
    assert_eq!((&one.text, &one.constants), (&two.text, &two.constants));
    assert_ne!(one.unseen, two.unseen);
}

#[test]
fn another_seed_draws_another_chance_and_finds_the_same_law() {
    let made = Plant::new(23, 6, 120.0).problem(23, law);
    let with = |seed| find(&made.problem(), &Options { seed, ..options() }, &|| false).unwrap();
    let (one, two) = (with(1), with(2));
    assert_ne!(one.chance.draws, two.chance.draws);
    assert_eq!(one.law().unwrap().text, two.law().unwrap().text);
}

/// What is averaged over many samples is found by half of them, and told at all of them.
#[test]
fn every_second_sample_is_enough_for_the_same_law() {
    let made = Plant::new(24, 6, 120.0).problem(24, law);
    let sparse = Sparse(made.weak.clone());
    let all = find(&made.problem(), &options(), &|| false).unwrap();
    let half = find(&Problem { rows: &sparse, ..made.problem() }, &options(), &|| false).unwrap();
    let (all, half) = (all.law().unwrap(), half.law().unwrap());
    assert_eq!(all.text, half.text);
    assert_eq!(half.prediction[0].len(), made.variables[0].runs[0].len());
    for (one, other) in all.constants.iter().zip(&half.constants) {
        let sd = one.sd.unwrap_or(0.0);
        assert!((one.value - other.value).abs() <= 0.3 * sd, "{one:?} against {other:?}");
    }
}
