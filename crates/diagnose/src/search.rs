//! Which causes a balance needs: added one by one while the evidence grows more than chance could make it grow.

use crate::balance::Balance;
use crate::catalogue::{Cause, Class, Form};
use crate::gram::{Column, Estimate, Reduced, Whitened};
use crate::noise::{Noise, Shape};
use crate::profile::{Function, Profile, Spread};
use crate::trial::{Pool, Trial};
use crate::Case;
use headland_calibrate::statistics::{Draws, quantile_of_sorted, sorted};
use nalgebra::DVector;

/// A cause that the balance needs.
#[derive(Clone, Debug)]
pub struct Accepted {
    /// Its trial.
    pub trial: Trial,
    /// Growth of ln p.
    pub gain: f64,
    /// What chance would have made of the best of all trials, once in a hundred.
    pub by_chance: f64,
    /// Causes that explain as much: index of the cause, growth of ln p, squared correlation.
    pub rivals: Vec<(usize, f64, f64)>,
    /// The function, where it is one.
    pub function: Option<Function>,
}

/// One round: the best trials, each with the growth of ln p that it brought.
#[derive(Clone, Debug)]
pub struct Round {
    /// What a growth has to exceed.
    pub by_chance: f64,
    /// Cause, its shape and its gain, the best first.
    pub causes: Vec<(usize, Vec<f64>, f64)>,
}

/// What was found in a balance.
pub struct Found {
    /// What was tried, round after round.
    pub tried: Vec<Round>,
    /// The causes, in the order in which they were accepted.
    pub accepted: Vec<Accepted>,
    /// Noise before and after.
    pub noise: (Noise, Noise),
    /// Values of the used columns at the end.
    pub used: Vec<usize>,
    /// Their estimate.
    pub estimate: Estimate,
    /// What is left of every row.
    pub left: Column,
    /// What the free parameters alone leave of every row.
    pub before: Column,
    /// Variance per row that is not noise of the sensors, before and after.
    pub lack_of_fit: (f64, f64),
}

impl Accepted {
    /// Whether it is this cause, or cannot be told from it.
    fn stands_for(&self, id: &str, causes: &[Cause]) -> bool {
        /// Two causes of this squared correlation are one to the data.
        const SAME: f64 = 0.7;
        let rival = |(cause, _, correlation): &(usize, f64, f64)| causes[*cause].id == id && *correlation > SAME;
        causes[self.trial.cause].id == id || self.rivals.iter().any(rival)
    }
}

/// A difference of ln p that is none.
const NEARLY: f64 = 1.0;
/// At most so many causes.
const MOST_CAUSES: usize = 3;
/// Trials whose noise is estimated anew.
const FINALISTS: usize = 8;
/// A growth of ln p within this of the best one does not tell the two apart: odds of one to twenty.
const TOLERANCE: f64 = 3.0;
/// No growth below this counts, whatever chance can do.
const LEAST_GAIN: f64 = 4.0;
/// Draws of the null distribution.
const DRAWS: u64 = 300;
/// An effect has to be at least this share of a row's noise, as root mean square.
const LEAST_EFFECT: f64 = 0.15;
/// A second or third cause has to be at least this share of what was to be explained, as mean square.
const LEAST_SHARE: f64 = 0.03;
/// A sensor that is this close to right is right: share of a scale, of a sampling period for a latency.
const LEAST_SCALE: f64 = 0.005;

/// Searches one balance.
pub fn search(case: &Case, balance: &Balance, pool: &Pool, causes: &[Cause], banned: &[&str]) -> Option<Found> {
    let fit = &case.fit;
    let nuisance: Vec<usize> = (0..pool.nuisance).collect();
    let mut used = nuisance.clone();
    let mut accepted: Vec<Accepted> = Vec::new();
    let mut function: Option<(usize, Spread)> = None;
    let mut tried: Vec<Round> = Vec::new();
    let state = State { case, balance, pool, fit };
    let (mut noise, mut here) = state.settle(&used, None)?;
    let first_noise = noise;
    let before = state.left(&used, &here.estimate, None);
    for _ in 0..MOST_CAUSES {
        let mut contest: Vec<Contest> = Vec::new();
        let base = here.estimate.log_evidence;
        for trial in &pool.trials {
            let cause = &causes[trial.cause];
            let known = accepted.iter().any(|one| one.stands_for(cause.id, causes));
            if known || banned.contains(&cause.id) || matches!(cause.form, Form::OverPosition | Form::OverTime) {
                continue;
            }
            let mut with = used.clone();
            with.extend(&trial.columns);
            let Some(estimate) = here.reduced.estimate(&with, &pool.sd) else { continue };
            if impossible(cause, trial, &estimate, used.len()) {
                continue;
            }
            contest.push(Contest { trial: trial.clone(), gain: estimate.log_evidence - base, spread: None });
        }
        contest.sort_by(|one, other| other.gain.total_cmp(&one.gain));
        let by_chance = chance(&state, &here.reduced, &used, causes, banned);
        contest.truncate(FINALISTS.max(contest.iter().filter(|one| one.gain > contest[0].gain - 10.0).count().min(16)));
        if function.is_none() {
            for trial in &pool.trials {
                let cause = &causes[trial.cause];
                let known = accepted.iter().any(|one| one.stands_for(cause.id, causes));
                if known || banned.contains(&cause.id) || !matches!(cause.form, Form::OverPosition | Form::OverTime) {
                    continue;
                }
                if let Some((gain, spread)) = state.best_spread(trial, cause, &used, &noise, base) {
                    contest.push(Contest { trial: trial.clone(), gain, spread: Some(spread) });
                }
            }
        }
        // The noise belongs to what is explained: each finalist is judged with its own.
        let mut judged: Vec<(Contest, Noise, Settled)> = Vec::new();
        for one in contest {
            let mut with = used.clone();
            let mut own = function;
            if let Some(spread) = one.spread {
                own = Some((one.trial.columns[0], spread));
            } else {
                with.extend(&one.trial.columns);
            }
            let Some((noise, settled)) = state.settle_from(&with, own, &noise) else { continue };
            let gain = settled.estimate.log_evidence - base;
            judged.push((Contest { gain, ..one }, noise, settled));
        }
        // Of two that explain as much, a cause in the world is named before a fault of a sensor.
        let rank = |one: &Contest| {
            let artefact = causes[one.trial.cause].class == Class::Artefact;
            one.gain - if artefact { NEARLY } else { 0.0 }
        };
        judged.sort_by(|one, other| rank(&other.0).total_cmp(&rank(&one.0)));
        tried.push(Round {
            by_chance: LEAST_GAIN.max(by_chance),
            causes: judged.iter().map(|(one, _, _)| (one.trial.cause, one.trial.shape.clone(), one.gain)).collect(),
        });
        let threshold = LEAST_GAIN.max(by_chance);
        let mut chosen = None;
        for (place, (one, noise, _)) in judged.iter().enumerate() {
            if one.gain < threshold {
                break;
            }
            let mut with = used.clone();
            let own = match one.spread {
                Some(spread) => Some((one.trial.columns[0], spread)),
                None => {
                    with.extend(&one.trial.columns);
                    function
                }
            };
            let Some((next_noise, settled)) = state.settle_from(&with, own, noise) else { continue };
            if state.matters(&with, &settled, &one.trial, own, &next_noise) {
                chosen = Some((place, with, own, next_noise, settled));
                break;
            }
        }
        let Some((place, with, own, next_noise, settled)) = chosen else { break };
        let best = &judged[place].0;
        let cause = &causes[best.trial.cause];
        let mut rivals: Vec<(usize, f64, f64)> = Vec::new();
        for (other, _, _) in judged.iter().skip(place + 1) {
            let rival = &causes[other.trial.cause];
            let listed = rivals.iter().any(|(known, _, _)| causes[*known].id == rival.id);
            if rival.id == cause.id || listed {
                continue;
            }
            let correlation =
                here.reduced.squared_correlation(&best.trial.columns, &other.trial.columns, &used, &pool.sd);
            if other.gain > best.gain - TOLERANCE {
                rivals.push((other.trial.cause, other.gain, correlation));
            }
        }
        accepted.push(Accepted { trial: best.trial.clone(), gain: best.gain, by_chance, rivals, function: None });
        used = with;
        function = own;
        noise = next_noise;
        here = settled;
    }
    let made = function.and_then(|own| state.function(&used, &here.estimate, own, &noise, causes));
    if let Some((column, function)) = made {
        for one in &mut accepted {
            name_by_shape(one, &function, causes, pool);
            if one.trial.columns == [column] && matches!(causes[one.trial.cause].form, Form::OverPosition | Form::OverTime) {
                one.function = Some(function.clone());
            }
        }
    }
    let shown = accepted.iter().find_map(|one| one.function.as_ref().map(|function| (&one.trial, function)));
    let left = state.left(&used, &here.estimate, shown.map(|(trial, function)| (trial, &causes[trial.cause], function)));
    /// Beyond this the sensors have no part.
    const MOST: f64 = 1e4;
    let lack = |noise: &Noise| (noise.process / noise.sensor.max(f64::MIN_POSITIVE)).min(MOST);
    Some(Found {
        tried,
        lack_of_fit: (lack(&first_noise), lack(&noise)),
        accepted,
        noise: (first_noise, noise),
        used,
        estimate: here.estimate,
        left,
        before,
    })
}

struct Contest {
    trial: Trial,
    gain: f64,
    spread: Option<Spread>,
}

struct Settled {
    reduced: Reduced,
    estimate: Estimate,
}

struct State<'a> {
    case: &'a Case<'a>,
    balance: &'a Balance,
    pool: &'a Pool,
    fit: &'a [bool],
}

impl State<'_> {
    fn settle(&self, used: &[usize], own: Option<(usize, Spread)>) -> Option<(Noise, Settled)> {
        let chunks: Vec<_> = self.fit_chunks().cloned().collect();
        let residual: Column = self.fit_rows(&self.balance.residual);
        let noise = Noise::of(self.balance.shape, &chunks, &residual);
        self.settle_from(used, own, &noise)
    }

    fn fit_chunks(&self) -> impl Iterator<Item = &crate::rows::Chunk> {
        self.balance.chunks.iter().filter(|chunk| self.fit[chunk.run])
    }

    fn fit_rows(&self, column: &Column) -> Column {
        let of = |(chunk, values): (&crate::rows::Chunk, &DVector<f64>)| self.fit[chunk.run].then(|| values.clone());
        self.balance.chunks.iter().zip(column).filter_map(of).collect()
    }

    /// Estimates, and lets the noise follow.
    fn settle_from(&self, used: &[usize], own: Option<(usize, Spread)>, start: &Noise) -> Option<(Noise, Settled)> {
        const ROUNDS: usize = 15;
        /// A growth of ln p below this is none.
        const SETTLED: f64 = 0.02;
        let chunks: Vec<_> = self.fit_chunks().cloned().collect();
        let mut noise = *start;
        let mut best: Option<(Noise, Settled)> = None;
        for _ in 0..ROUNDS {
            let whitened = Whitened::new(&self.balance.chunks, &self.balance.residual, &self.pool.columns, &noise)?;
            let reduced = match own {
                None => whitened.reduced(&self.balance.chunks, self.fit),
                Some((column, spread)) => {
                    self.profile_of(column)?.eliminate(&whitened, &self.balance.chunks, self.fit, &spread)?
                }
            };
            let estimate = reduced.estimate(used, &self.pool.sd)?;
            let left = match own {
                None => self.left(used, &estimate, None),
                Some((column, spread)) => {
                    let profile = self.profile_of(column)?;
                    let function = profile.function(
                        &whitened,
                        &self.balance.chunks,
                        self.fit,
                        &spread,
                        used,
                        &estimate.beta,
                    );
                    self.minus(self.left(used, &estimate, None), column, &profile, &function)
                }
            };
            let next = Noise::of(self.balance.shape, &chunks, &self.fit_rows(&left));
            let better =
                best.as_ref().is_none_or(|(_, one)| estimate.log_evidence > one.estimate.log_evidence + SETTLED);
            if !better {
                break;
            }
            best = Some((noise, Settled { reduced, estimate }));
            if next == noise {
                break;
            }
            noise = next;
        }
        best
    }

    fn left(&self, used: &[usize], estimate: &Estimate, own: Option<(&Trial, &Cause, &Function)>) -> Column {
        let mut left = self.balance.residual.clone();
        for (position, index) in used.iter().enumerate() {
            for (chunk, values) in left.iter_mut().zip(&self.pool.columns[*index]) {
                *chunk -= values * estimate.beta[position];
            }
        }
        match own {
            Some((trial, _, function)) => match self.profile_of(trial.columns[0]) {
                Some(profile) => self.minus(left, trial.columns[0], &profile, function),
                None => left,
            },
            None => left,
        }
    }

    fn minus(&self, mut left: Column, column: usize, profile: &Profile, function: &Function) -> Column {
        for (index, chunk) in self.balance.chunks.iter().enumerate() {
            let group = profile.group_of[chunk.run];
            for row in 0..chunk.rows.len() {
                let value = function.value(group, profile.at[index][row]);
                left[index][row] -= self.pool.columns[column][index][row] * value;
            }
        }
        left
    }

    fn profile_of(&self, column: usize) -> Option<Profile<'_>> {
        let trial = self.pool.trials.iter().find(|trial| trial.columns == [column])?;
        Some(self.case.profile(self.balance, self.case.causes[trial.cause].form, &self.pool.columns[column]))
    }

    fn best_spread(
        &self,
        trial: &Trial,
        cause: &Cause,
        used: &[usize],
        noise: &Noise,
        base: f64,
    ) -> Option<(f64, Spread)> {
        let whitened = Whitened::new(&self.balance.chunks, &self.balance.residual, &self.pool.columns, noise)?;
        let profile = self.profile_of(trial.columns[0])?;
        let longest = profile.extents.iter().map(|(from, to)| to - from).fold(0.0, f64::max);
        let lengths: &[f64] = match cause.form {
            Form::OverPosition => &[5.0, 15.0, 50.0, 150.0, 450.0],
            _ => &[5.0, 20.0, 80.0, 320.0],
        };
        let mut best: Option<(f64, Spread)> = None;
        for length in lengths.iter().filter(|length| **length < longest) {
            for share in [0.3, 1.0, 3.0] {
                let spread = Spread { length: *length, size: share * cause.terms[0].scale };
                let reduced = profile.eliminate(&whitened, &self.balance.chunks, self.fit, &spread);
                let estimate = reduced.and_then(|reduced| reduced.estimate(used, &self.pool.sd));
                let Some(estimate) = estimate else { continue };
                let gain = estimate.log_evidence - base;
                if best.is_none_or(|(known, _)| gain > known) {
                    best = Some((gain, spread));
                }
            }
        }
        best
    }

    fn function(
        &self,
        used: &[usize],
        estimate: &Estimate,
        (column, spread): (usize, Spread),
        noise: &Noise,
        _: &[Cause],
    ) -> Option<(usize, Function)> {
        let whitened = Whitened::new(&self.balance.chunks, &self.balance.residual, &self.pool.columns, noise)?;
        let profile = self.profile_of(column)?;
        let function =
            profile.function(&whitened, &self.balance.chunks, self.fit, &spread, used, &estimate.beta);
        Some((column, function))
    }

    /// Whether an effect is more than the ear can hear: its size against a row's noise.
    fn matters(
        &self,
        used: &[usize],
        settled: &Settled,
        trial: &Trial,
        own: Option<(usize, Spread)>,
        noise: &Noise,
    ) -> bool {
        if own.is_some_and(|(column, _)| trial.columns == [column]) {
            return true;
        }
        let own = self.mean_square(&trial.columns, used, settled);
        let others: Vec<usize> = used.iter().copied().filter(|column| *column >= self.pool.nuisance).collect();
        let all = self.mean_square(&others, used, settled);
        // Differences of speed are noisy row by row and not over a run, so their rows are no measure.
        let heard = match self.balance.shape {
            Shape::Differenced => true,
            Shape::Averaged => own.sqrt() > LEAST_EFFECT * noise.sd(),
        };
        heard && own > LEAST_SHARE * all && self.beyond_the_sensor(used, settled, trial)
    }

    /// Mean square of what some columns explain together.
    fn mean_square(&self, columns: &[usize], used: &[usize], settled: &Settled) -> f64 {
        let (mut sum, mut count) = (0.0, 0usize);
        for (index, chunk) in self.balance.chunks.iter().enumerate().filter(|(_, chunk)| self.fit[chunk.run]) {
            let mut effect = DVector::zeros(chunk.rows.len());
            for column in columns {
                if let Some(position) = used.iter().position(|used| used == column) {
                    effect += &self.pool.columns[*column][index] * settled.estimate.beta[position];
                }
            }
            sum += effect.norm_squared();
            count += effect.len();
        }
        sum / count.max(1) as f64
    }

    /// Whether a sensor's fault is one that anybody would mind.
    fn beyond_the_sensor(&self, used: &[usize], settled: &Settled, trial: &Trial) -> bool {
        let cause = &self.case.causes[trial.cause];
        let position = used.iter().position(|used| trial.columns.first() == Some(used));
        let value = position.map_or(0.0, |position| settled.estimate.beta[position].abs());
        match cause.id {
            "latency" => {
                let period = |drive: &crate::balance::Drive0| {
                    drive.measured.trace.duration_s() / (drive.measured.trace.len().max(2) - 1) as f64
                };
                value > self.case.drives.iter().map(period).fold(0.0, f64::max)
            }
            "speed_scale" | "force_scale" => value > LEAST_SCALE,
            _ => true,
        }
    }
}

/// Whether a cause would have to be what it cannot be.
fn impossible(cause: &Cause, trial: &Trial, estimate: &Estimate, first: usize) -> bool {
    let positive = |(index, term): (usize, &usize)| cause.terms[*term].positive && estimate.beta[first + index] < 0.0;
    trial.terms.iter().enumerate().any(positive)
}

/// The growth of ln p that the best of all trials reaches by chance once in a hundred, if nothing is missing.
fn chance(state: &State, reduced: &Reduced, used: &[usize], causes: &[Cause], banned: &[&str]) -> f64 {
    let pool = state.pool;
    let usable = |trial: &&Trial| {
        let cause = &causes[trial.cause];
        !banned.contains(&cause.id) && !matches!(cause.form, Form::OverPosition | Form::OverTime)
    };
    let trials: Vec<&Trial> = pool.trials.iter().filter(usable).collect();
    let mut jittered = reduced.matrix.clone();
    for index in 0..jittered.nrows() {
        jittered[(index, index)] = jittered[(index, index)] * (1.0 + 1e-9) + 1e-300;
    }
    let Some(cholesky) = jittered.cholesky() else { return LEAST_GAIN };
    let factor = cholesky.l();
    let mut best: Vec<f64> = Vec::new();
    for draw in 0..DRAWS {
        let mut draws = Draws::new(state.case.seed, draw);
        let white = DVector::from_fn(factor.nrows(), |_, _| draws.normal());
        let mut problem = reduced.clone();
        problem.vector = &factor * white;
        problem.scalar = 0.0;
        let Some(base) = problem.estimate(used, &pool.sd) else { continue };
        let gain = trials.iter().filter_map(|trial| {
            let mut with = used.to_vec();
            with.extend(&trial.columns);
            Some(problem.estimate(&with, &pool.sd)?.log_evidence - base.log_evidence)
        });
        best.push(gain.fold(f64::NEG_INFINITY, f64::max));
    }
    if best.is_empty() { LEAST_GAIN } else { quantile_of_sorted(&sorted(&best), 0.99) }
}

/// A function over position that these recordings give to slopes and to soft ground alike: where it rises in places above
/// a floor it is told as ground, where it goes both ways as slopes. The other stays named beside it.
fn name_by_shape(one: &mut Accepted, function: &Function, causes: &[Cause], pool: &Pool) {
    /// So many times higher than deep is 'in places'.
    const LOPSIDED: f64 = 2.0;
    let id = causes[one.trial.cause].id;
    let twin = match id {
        "grade" => "soft_ground",
        "soft_ground" => "grade",
        _ => return,
    };
    let Some(place) = one.rivals.iter().position(|(rival, _, _)| causes[*rival].id == twin) else { return };
    let values: Vec<f64> = function.values.iter().flat_map(|(values, _)| values.iter().copied()).collect();
    let values = sorted(&values);
    let [low, middle, high] = [0.02, 0.5, 0.98].map(|share| quantile_of_sorted(&values, share));
    let ground = high - middle > LOPSIDED * (middle - low);
    if ground == (id == "soft_ground") {
        return;
    }
    let rival = one.rivals[place].0;
    if let Some(trial) = pool.trials.iter().find(|trial| trial.cause == rival) {
        one.rivals[place].0 = one.trial.cause;
        one.trial = Trial { columns: one.trial.columns.clone(), ..trial.clone() };
    }
}
