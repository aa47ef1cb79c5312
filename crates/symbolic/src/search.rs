//! The search: terms are screened, polished and added one by one, from several laws at once, and exchanged.
//!
//! A beam of laws of k terms proposes laws of k + 1: the families of terms that add most by screening, one start each.
//! The amount of work is fixed by the options and the size of the data, never by a clock, so that results repeat.

use crate::SymbolicError;
use crate::chance::{Chance, Null, persistence, statistic};
use crate::dictionary::{dictionary, envelopes, switched};
use crate::levels::levelled;
use crate::polish::{Polished, amplitudes, polish};
use crate::problem::Bench;
use crate::screen::Screen;
use crate::shape::{Factor, Shape};
use crate::term::Term;
use crate::vector::{dot, normalise, take_out};
use rayon::prelude::*;

/// How much is searched.
#[derive(Clone, Debug)]
pub struct Options {
    /// Terms that are added at most.
    pub most_terms: usize,
    /// Draws of what chance can do.
    pub draws: usize,
    /// How improbable every term has to be by chance alone.
    pub significance: f64,
    /// Seed of the draws.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self { most_terms: 3, draws: 100, significance: 0.01, seed: 0 }
    }
}

/// Laws that are continued, for each number of terms.
const BEAM: usize = 3;
/// Families that are polished, for each law that is continued, by number of terms.
const FAMILIES: [usize; 3] = [28, 9, 5];
/// Peaks of the scan whose amplitude may vary, for the first and for later terms.
const PEAKS: [usize; 2] = [4, 2];
/// Steps of the polishing.
const STEPS: usize = 12;
/// Laws in which terms are exchanged, and families that are tried in the place of each.
const EXCHANGED: usize = 2;
const EXCHANGES: usize = 3;
/// Laws of each number of terms that are validated.
const VALIDATED: usize = 14;
/// Laws whose deviance differs by less say as much.
const AS_GOOD: f64 = 1.0;

/// What was searched.
pub(crate) struct Searched {
    /// The law of nothing first, then laws of one term, of two, ...
    pub laws: Vec<Polished>,
    pub chance: Chance,
}

/// Whether the caller wants it to end.
pub(crate) type Stop<'a> = &'a (dyn Fn() -> bool + Sync);

/// Searches.
pub(crate) fn search(bench: &Bench, options: &Options, stop: Stop) -> Result<Searched, SymbolicError> {
    let screen = Screen::new(bench, dictionary(&bench.variables), stop)?;
    let chances = |persistence| Null::new(bench, &screen, options.draws, options.seed, persistence);
    let null = chances(0.0);
    let hunt = Hunt { bench, screen: &screen, stop };
    let nothing = Polished::nothing(bench);
    let mut laws = vec![nothing.clone()];
    let mut beam = vec![nothing];
    let mut chance = Chance {
        draws: null.draws.clone(),
        steps: Vec::new(),
        p_values: Vec::new(),
        persistence: Vec::new(),
        terms: 0,
    };
    for level in 0..options.most_terms {
        if stop() {
            return Err(SymbolicError::Interrupted);
        }
        let families = FAMILIES.get(level).copied().unwrap_or(FAMILIES[2]);
        let (mut found, step) = hunt.grow(&beam, families, PEAKS[level.min(1)])?;
        hunt.sort(&mut found);
        let clocked = hunt.clocked(&found[..found.len().min(EXCHANGED)])?;
        if !clocked.is_empty() {
            found.extend(clocked);
            hunt.sort(&mut found);
        }
        if level > 0 {
            let more = hunt.exchange(&found[..found.len().min(EXCHANGED)])?;
            found.extend(more);
            hunt.sort(&mut found);
        }
        // Rows that the whitening left persistent make larger steps by chance.
        let left = found.first().map_or(0.0, |law| persistence(bench, &law.left));
        let mut p_value = null.p_value(step);
        if left != 0.0 && p_value <= options.significance {
            p_value = p_value.max(chances(left).p_value(step));
        }
        chance.steps.push(step);
        chance.p_values.push(p_value);
        chance.persistence.push(left);
        beam = found.iter().take(BEAM).cloned().collect();
        laws.extend(found.into_iter().take(VALIDATED));
        if p_value > options.significance || beam.is_empty() {
            break;
        }
        chance.terms = level + 1;
    }
    Ok(Searched { laws, chance })
}

struct Hunt<'a> {
    bench: &'a Bench<'a>,
    screen: &'a Screen,
    stop: Stop<'a>,
}

impl Hunt<'_> {
    /// Deviance with what constants cost (Schwarz, *Ann. Statist.* 6, 1978).
    fn rank(&self, law: &Polished) -> f64 {
        let rows = self.bench.rows as f64;
        rows * law.cost.max(f64::MIN_POSITIVE).ln() + law.constants() as f64 * rows.ln()
    }

    /// Best first; of two that are the same but for rounding one is left.
    fn sort(&self, laws: &mut Vec<Polished>) {
        let family = |law: &Polished| {
            let mut all: Vec<_> = law.terms.iter().map(Term::family).collect();
            all.sort();
            all
        };
        laws.sort_by(|one, other| {
            self.rank(one).total_cmp(&self.rank(other)).then_with(|| family(one).cmp(&family(other)))
        });
        let same = |one: &Polished, other: &Polished| {
            family(one) == family(other) && (one.cost - other.cost).abs() < 1e-3 * other.cost.min(1.0)
        };
        laws.dedup_by(|one, other| same(one, other));
    }

    /// Laws with one term more than those of the beam, and the statistic of the largest step from the first of them.
    fn grow(
        &self,
        beam: &[Polished],
        families: usize,
        peaks: usize,
    ) -> Result<(Vec<Polished>, f64), SymbolicError> {
        let mut starts = Vec::new();
        let mut step = 0.0;
        for (index, law) in beam.iter().enumerate() {
            let (best, terms) = self.propose(law, families, peaks);
            if index == 0 {
                step = best;
            }
            starts.extend(terms.into_iter().map(|term| {
                let mut all = law.terms.clone();
                all.push(term);
                all
            }));
        }
        Ok((self.polished(starts)?, step))
    }

    fn polished(&self, starts: Vec<Vec<Term>>) -> Result<Vec<Polished>, SymbolicError> {
        let one = |terms: Vec<Term>| {
            if (self.stop)() {
                return Err(SymbolicError::Interrupted);
            }
            Ok(amplitudes(self.bench, terms)
                .map(|start| self.turned(self.on(polish(self.bench, levelled(self.bench, start), STEPS)))))
        };
        let all: Result<Vec<Option<Polished>>, _> = starts.into_par_iter().map(one).collect();
        Ok(all?.into_iter().flatten().collect())
    }

    /// The same with pulses and switches that take while they are on, where they say as much as those that give: beside a constant that is
    /// known well enough they do not, and what is switched on takes.
    fn on(&self, law: Polished) -> Polished {
        let mut law = law;
        for index in 0..law.terms.len() {
            let first: usize = law.terms[..index].iter().map(Term::width).sum();
            let Some(other) = law.terms[index].complement().filter(|_| law.amplitudes[first] < 0.0) else {
                continue;
            };
            let mut terms = law.terms.clone();
            terms[index] = other;
            let other = amplitudes(self.bench, terms).map(|start| polish(self.bench, start, STEPS));
            if let Some(other) = other.filter(|other| self.rank(other) < self.rank(&law) + AS_GOOD) {
                law = other;
            }
        }
        law
    }

    /// The same with steps the other way where that says more: of two that differ by a constant the screening knows which is better
    /// by itself alone.
    fn turned(&self, law: Polished) -> Polished {
        let mut law = law;
        for index in 0..law.terms.len() {
            for other in law.terms[index].turned() {
                let mut terms = law.terms.clone();
                terms[index] = other;
                let other = amplitudes(self.bench, terms).filter(|other| other.cost < law.cost - AS_GOOD);
                if let Some(other) = other {
                    law = polish(self.bench, other, STEPS);
                }
            }
        }
        law
    }

    /// The terms that add most to a law, one of each family, and the statistic of the best of the dictionary.
    fn propose(&self, law: &Polished, families: usize, peaks: usize) -> (f64, Vec<Term>) {
        let left = self.screen.thin(self.bench, &law.left);
        let basis = orthonormal(law.basis.iter().map(|column| self.screen.thin(self.bench, column)));
        let gains = self.screen.gains(&basis, &left);
        let best = gains.iter().copied().fold(0.0, f64::max);
        let peaks = self.screen.peaks(&gains, peaks);
        let bends = |term: &Term| term.bends(&self.bench.variables);
        let bent = law.terms.iter().any(bends);
        let mut all: Vec<(f64, Term)> = gains
            .iter()
            .zip(&self.screen.terms)
            .enumerate()
            // Of the waves only peaks are starts, and two that bend are in proportion to what each of them may not be.
            .filter(|(index, (_, term))| (!term.is_wave() || peaks.contains(index)) && !(bent && bends(term)))
            .map(|(_, (gain, term))| (*gain, term.clone()))
            .collect();
        let modulated: Vec<Term> = peaks
            .iter()
            .flat_map(|peak| {
                let wave = self.screen.terms[*peak].factors[0];
                let of = |envelope| Term::product(envelope, wave);
                envelopes(&self.bench.variables, wave.variable).into_iter().filter_map(of).collect::<Vec<_>>()
            })
            .collect();
        let pulses = peaks.iter().flat_map(|peak| pulses(&self.screen.terms[*peak].factors[0]));
        let driven = self.best_switches(&gains).into_iter().flat_map(|switch| {
            let of = move |power| Term::product(switch, power);
            switched(&self.bench.variables).into_iter().filter_map(of)
        });
        let judged: Vec<(f64, Term)> = modulated
            .into_iter()
            .chain(pulses)
            .chain(driven)
            .collect::<Vec<Term>>()
            .into_par_iter()
            .map(|term| (self.screen.gain_of(self.bench, &term, &basis, &left), term))
            .collect();
        all.extend(judged);
        // Sorting is stable: of equal gains the earlier, simpler term comes first.
        all.sort_by(|one, other| other.0.total_cmp(&one.0));
        let mut terms: Vec<Term> = Vec::new();
        let mut known = Vec::new();
        for (_, term) in all.into_iter().filter(|(gain, _)| *gain > 0.0) {
            let family = term.family();
            // Two peaks of one variable are two starts: their basins are narrow.
            let most = if term.is_wave() && term.factors.len() == 1 { 2 } else { 1 };
            if known.iter().filter(|other| **other == family).count() < most {
                known.push(family);
                terms.push(term);
            }
            if terms.len() == families {
                break;
            }
        }
        (statistic(best, dot(&left, &left), left.len()), terms)
    }

    /// The switches of the dictionary that add most by themselves, one of each variable.
    fn best_switches(&self, gains: &[f64]) -> Vec<Factor> {
        let switch = |term: &Term| match term.factors[..] {
            [factor] if factor.shape == Shape::Latch => Some(factor),
            _ => None,
        };
        let mut best: Vec<(f64, Factor)> = Vec::new();
        for (gain, factor) in
            gains.iter().zip(&self.screen.terms).filter_map(|(gain, term)| Some((*gain, switch(term)?)))
        {
            match best.iter_mut().find(|(_, own)| own.variable == factor.variable) {
                Some(own) if own.0 < gain => *own = (gain, factor),
                Some(_) => {}
                None => best.push((gain, factor)),
            }
        }
        best.into_iter().map(|(_, factor)| factor).collect()
    }

    /// Pulses in the place of waves whose period is known by now, and of those that are harmonics of them: edges lead to no period
    /// that is not nearly right, and a wave does.
    fn clocked(&self, laws: &[Polished]) -> Result<Vec<Polished>, SymbolicError> {
        let mut starts = Vec::new();
        for law in laws {
            for wave in law.terms.iter().filter_map(Term::as_wave) {
                let harmonic = |term: &Term| term.as_wave().is_some_and(|other| wave.has_harmonic(&other));
                let rest: Vec<Term> = law.terms.iter().filter(|term| !harmonic(term)).cloned().collect();
                starts.extend(pulses(&wave).map(|pulse| rest.iter().cloned().chain([pulse]).collect()));
            }
        }
        self.polished(starts)
    }

    /// Each term of each law in turn gives its place to others.
    fn exchange(&self, laws: &[Polished]) -> Result<Vec<Polished>, SymbolicError> {
        let mut starts = Vec::new();
        for law in laws {
            for index in 0..law.terms.len() {
                let mut rest = law.terms.clone();
                rest.remove(index);
                let Some(rest) = amplitudes(self.bench, rest) else { continue };
                let (_, terms) = self.propose(&rest, EXCHANGES, 1);
                starts.extend(terms.into_iter().map(|term| {
                    let mut all = rest.terms.clone();
                    all.push(term);
                    all
                }));
            }
        }
        self.polished(starts)
    }
}

/// Pulses of the period of a wave: what goes on and off has a wave in it that is found first. They begin in all eighths of
/// the first half; in the other half the same are off that are on here.
fn pulses(wave: &Factor) -> impl Iterator<Item = Term> {
    const BEGINS: u8 = 4;
    const EIGHTH: f64 = 0.125;
    let of = *wave;
    (0..BEGINS).map(move |begin| {
        let centre = f64::from(begin) * EIGHTH * of.scale;
        Term::of(Factor { shape: Shape::Pulse(0.0), centre, ..of })
    })
}

/// Columns made orthonormal again, after rows were taken out of them.
fn orthonormal(columns: impl Iterator<Item = Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        take_out(&mut column, &basis);
        if normalise(&mut column) > 0.0 {
            basis.push(column);
        }
    }
    basis
}
