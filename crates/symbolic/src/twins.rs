//! What is left of a law where another sensor is asked for its variables.
//!
//! A variable that shares the noise of its sensor with the residual lets a law follow that noise, in runs that were left out as well. The
//! noise of another sensor is its own: what it says of the same quantity keeps what is there, and nothing of the other's noise.

use crate::polish::Polished;
use crate::problem::Bench;
use crate::term::Term;
use crate::variable::Checked;
use crate::vector::{add, dot};

/// The least of the shares that the twins of its variables leave of what a law, and each of its terms, takes of the squared residual; none
/// where no variable of it has a twin.
pub(crate) fn kept(bench: &Bench, law: &Polished) -> Option<f64> {
    let mut amplitude = 0;
    let (mut none, mut moved) = (law.left.clone(), law.left.clone());
    let mut shares = Vec::new();
    for term in &law.terms {
        let amplitudes = &law.amplitudes[amplitude..amplitude + term.width()];
        amplitude += term.width();
        if !term.has_twin(&bench.variables) {
            continue;
        }
        let own = rows(bench, term, amplitudes, Term::samples);
        let twin = rows(bench, term, amplitudes, Term::samples_by_twins);
        let (mut without, mut by_twin) = (law.left.clone(), law.left.clone());
        for of in [&mut without, &mut by_twin, &mut none, &mut moved] {
            add(of, 1.0, &own);
        }
        for of in [&mut by_twin, &mut moved] {
            add(of, -1.0, &twin);
        }
        shares.push(left(dot(&without, &without), law.cost, dot(&by_twin, &by_twin)));
    }
    let all = (!shares.is_empty()).then(|| left(dot(&none, &none), law.cost, dot(&moved, &moved)));
    shares.into_iter().chain(all).reduce(f64::min)
}

/// What one law takes of a squared residual, as a share of what another takes.
fn left(nothing: f64, own: f64, twin: f64) -> f64 {
    (nothing - twin) / (nothing - own).max(f64::MIN_POSITIVE)
}

/// What a term does to the rows that are fitted, projected.
fn rows(
    bench: &Bench,
    term: &Term,
    amplitudes: &[f64],
    samples: fn(&Term, &[Checked], usize) -> Vec<Vec<f64>>,
) -> Vec<f64> {
    let of_run = |(run, _): &(usize, usize)| {
        let columns = samples(term, &bench.variables, *run);
        let length = columns.first().map_or(0, Vec::len);
        let sum = |at: usize| columns.iter().zip(amplitudes).map(|(column, share)| share * column[at]).sum();
        let said: Vec<f64> = (0..length).map(sum).collect();
        bench.rows_of(*run, &said)
    };
    bench.project(&bench.fitted.iter().flat_map(of_run).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::kept;
    use crate::polish::amplitudes;
    use crate::problem::{AsTheyAre, Bench, Problem, Target};
    use crate::shape::{Factor, Shape};
    use crate::term::Term;
    use crate::variable::{Enters, Variable};

    /// Two sensors of one acceleration, each with a noise of its own, and the share that the second leaves of a law of the first.
    fn share(residual: impl Fn(f64, f64) -> f64) -> f64 {
        let at = |step: u16| f64::from(step);
        let truth = |step: u16| (0.11 * at(step)).sin();
        let noise = |step: u16| 0.3 * (2.9 * at(step)).sin();
        let steps = || 0..300u16;
        let of = |value: &dyn Fn(u16) -> f64| vec![steps().map(value).collect::<Vec<f64>>()];
        let variables = [Variable {
            name: "acceleration".to_owned(),
            unit: "m/s²".to_owned(),
            runs: of(&|step| truth(step) + noise(step)),
            twin: Some(of(&|step| truth(step) + 0.3 * (1.7 * at(step)).cos())),
            finest: 0.0,
            enters: Enters::Freely,
        }];
        let times_s = of(&at);
        let residual = of(&|step| residual(truth(step), noise(step)));
        let problem = Problem {
            variables: &variables,
            times_s: &times_s,
            target: Target::Power,
            rows: &AsTheyAre,
            residual: &residual,
            nuisances: &[],
            fit: &[true],
        };
        let bench = Bench::new(&problem).unwrap();
        let term = Term::of(Factor { variable: 0, shape: Shape::Power(1.0), scale: 1.0, centre: 0.0 });
        kept(&bench, &amplitudes(&bench, vec![term]).unwrap()).unwrap()
    }

    #[test]
    fn another_sensor_keeps_what_is_there_and_none_of_a_noise() {
        let there = share(|truth, _| 900.0 * truth);
        let noise = share(|_, noise| 900.0 * noise);
        assert!(there > 0.9 && noise < 0.1, "{there} {noise}");
    }
}
