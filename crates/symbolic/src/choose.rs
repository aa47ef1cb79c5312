//! Which law: complexity against error on runs that were left out.

use crate::SymbolicError;
use crate::law::{Law, Written, write};
use crate::polish::{Polished, amplitudes};
use crate::problem::Bench;
use crate::search::{Searched, Stop};
use crate::twins::kept;
use crate::validate::{Judge, Verdict};
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Everything that was found.
#[derive(Clone, Debug)]
pub struct Found {
    /// The best law of each complexity that is better than every simpler one; no law at all comes first.
    pub front: Vec<Law>,
    /// The law that is worth its complexity and more than chance; none where no law is.
    pub chosen: Option<usize>,
    /// What chance can do.
    pub chance: crate::Chance,
}

impl Found {
    /// The law that was chosen.
    pub fn law(&self) -> Option<&Law> {
        self.chosen.and_then(|index| self.front.get(index))
    }

    /// The law that was chosen, and behind it the best of each smaller number of terms.
    pub fn laws(&self) -> Vec<&Law> {
        let mut laws: Vec<&Law> = self.law().into_iter().collect();
        let simpler = self.front[..self.chosen.unwrap_or(0)].iter().rev();
        for law in simpler.filter(|law| law.terms > 0) {
            if laws.last().is_some_and(|last| law.terms < last.terms) {
                laws.push(law);
            }
        }
        laws
    }
}

/// A law that was validated.
struct Judged {
    law: Polished,
    verdict: Verdict,
    /// Deviance of each fold.
    folds: Vec<f64>,
}

/// Validates, sorts and chooses.
pub(crate) fn choose(bench: &Bench, searched: Searched, stop: Stop) -> Result<Found, SymbolicError> {
    let judge = Judge::new(bench);
    let one = |law: &Polished| {
        if stop() {
            return Err(SymbolicError::Interrupted);
        }
        Ok(judge.judge(bench, law))
    };
    let verdicts: Result<Vec<Option<Verdict>>, _> = searched.laws.par_iter().map(one).collect();
    // The variance of the noise: that of the best law, which is white where the caller whitened with the right noise.
    let variance = searched
        .laws
        .iter()
        .map(|law| law.cost / bench.rows.saturating_sub(law.constants()).max(1) as f64)
        .fold(f64::INFINITY, f64::min)
        .max(f64::MIN_POSITIVE);
    let mut judged: Vec<Judged> = searched
        .laws
        .into_iter()
        .zip(verdicts?)
        .filter_map(|(law, verdict)| {
            let verdict = verdict?;
            let folds = verdict.folds.iter().map(|(error, spread)| error / variance + spread).collect();
            Some(Judged { law, verdict, folds })
        })
        .collect();
    judged.sort_by(|one, other| {
        one.law.complexity().cmp(&other.law.complexity()).then(one.total().total_cmp(&other.total()))
    });
    let front = front(judged);
    let allowed = |one: &&Judged| one.law.terms.len() <= searched.chance.terms;
    let best = front.iter().filter(allowed).min_by(|one, other| one.total().total_cmp(&other.total()));
    let Some(best) = best else {
        return Ok(Found { front: Vec::new(), chosen: None, chance: searched.chance });
    };
    let chosen = front
        .iter()
        .position(|one| allowed(&one) && as_good(one, best))
        .filter(|index| !front[*index].law.terms.is_empty());
    let nothing = front.first().unwrap_or(best);
    let told = |(index, one): (usize, &Judged)| {
        let law = told(bench, one, nothing, best, variance);
        // Nobody asks for laws that are longer than the one that was chosen.
        let asked = chosen.is_some_and(|chosen| index <= chosen);
        let powers = if asked { other_powers(bench, &judge, &one.law, variance) } else { Vec::new() };
        Law { powers, ..law }
    };
    let laws = front.iter().enumerate().map(told).collect();
    Ok(Found { front: laws, chosen, chance: searched.chance })
}

impl Judged {
    fn total(&self) -> f64 {
        self.folds.iter().sum()
    }
}

/// Each better than all that are simpler.
fn front(judged: Vec<Judged>) -> Vec<Judged> {
    let mut front: Vec<Judged> = Vec::new();
    for one in judged {
        if front.last().is_none_or(|last| one.total() < last.total()) {
            front.push(one);
        }
    }
    front
}

/// Whether a law is not told from the best: within one standard error, or within odds of one to twenty.
fn as_good(one: &Judged, best: &Judged) -> bool {
    /// Twice the logarithm of the odds. Among many laws some are better by more than one standard error by luck.
    const EVEN: f64 = 6.0;
    let (beyond, sd) = difference(one, best);
    beyond <= sd.max(EVEN)
}

/// By how much one law is worse than another, over all folds, and the standard error of that.
fn difference(one: &Judged, best: &Judged) -> (f64, f64) {
    let apart: Vec<f64> = one.folds.iter().zip(&best.folds).map(|(one, best)| one - best).collect();
    let count = apart.len() as f64;
    let mean = apart.iter().sum::<f64>() / count;
    let variance = apart.iter().map(|apart| (apart - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    (mean * count, (variance * count).sqrt())
}

fn told(bench: &Bench, one: &Judged, nothing: &Judged, best: &Judged, variance: f64) -> Law {
    let covariance = &one.verdict.covariance * variance;
    let written = written(bench, &one.law, &covariance);
    let (beyond, sd) = difference(one, best);
    let sum = |of: &Judged| of.verdict.folds.iter().map(|(error, _)| error).sum::<f64>();
    let unseen = one.verdict.unseen.zip(nothing.verdict.unseen);
    let alone = |(law, covariance): (Polished, DMatrix<f64>)| plain(bench, &law, &covariance);
    let several = one.law.terms.len() > 1;
    let each = if several { one.law.each(&covariance).into_iter().map(alone).collect() } else { Vec::new() };
    Law {
        text: written.text,
        constants: written.constants,
        terms: one.law.terms.len(),
        complexity: one.law.complexity(),
        gain: 0.5 * bench.rows as f64 * (nothing.law.cost / one.law.cost.max(f64::MIN_POSITIVE)).ln(),
        error: one.total() - nothing.total(),
        error_beyond_best: beyond,
        error_beyond_best_sd: sd,
        explained: 1.0 - sum(one) / sum(nothing).max(f64::MIN_POSITIVE),
        kept: kept(bench, &one.law),
        unseen: unseen.map(|(one, nothing)| 1.0 - one / nothing.max(f64::MIN_POSITIVE)),
        prediction: written.prediction,
        each,
        powers: Vec::new(),
    }
}

/// A law as it is written, of all runs.
fn written(bench: &Bench, law: &Polished, covariance: &DMatrix<f64>) -> Written {
    let runs = bench.fitted.len() + bench.unseen.len();
    let runs = bench.variables.first().map_or(runs, |variable| variable.runs.len());
    write(bench, law, covariance, runs)
}

/// A law of which nobody asked how it fares.
fn plain(bench: &Bench, law: &Polished, covariance: &DMatrix<f64>) -> Law {
    let written = written(bench, law, covariance);
    let none = f64::NAN;
    Law {
        text: written.text,
        constants: written.constants,
        terms: law.terms.len(),
        complexity: law.complexity(),
        error: none,
        error_beyond_best: none,
        error_beyond_best_sd: none,
        explained: none,
        prediction: written.prediction,
        ..Law::default()
    }
}

/// A law with another power of what stands in it, in the place of each, and amplitudes anew.
fn other_powers(bench: &Bench, judge: &Judge, law: &Polished, variance: f64) -> Vec<Law> {
    let with = |place: usize| {
        law.terms[place].other_powers(&bench.variables).into_iter().filter_map(move |term| {
            let mut terms = law.terms.clone();
            terms[place] = term;
            let law = amplitudes(bench, terms)?;
            let covariance = judge.judge(bench, &law)?.covariance * variance;
            Some(plain(bench, &law, &covariance))
        })
    };
    (0..law.terms.len()).flat_map(with).collect()
}
