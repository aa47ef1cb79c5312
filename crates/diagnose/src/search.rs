//! Which causes a balance needs: added one by one while the evidence grows more than chance could make it grow.

use crate::Case;
use crate::balance::Balance;
use crate::catalogue::{Cause, Class, Form};
use crate::gram::{Column, Estimate, Reduced, Whitened};
use crate::noise::{Noise, Shape};
use crate::profile::{Function, Profile, Spread};
use crate::trial::{Pool, Trial};
use headland_calibrate::statistics::{Draws, quantile_of_sorted, sorted};
use nalgebra::DVector;
use rayon::prelude::*;

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
    /// Growth of ln p on the runs that were held out, by what was accepted; none where there are none.
    pub held_out_gain: Option<f64>,
    /// Variance per row that is not noise of the sensors, before and after.
    pub lack_of_fit: (f64, f64),
}

impl Accepted {
    /// Whether it is this cause, or cannot be told from it.
    fn stands_for(&self, id: &str, causes: &[Cause]) -> bool {
        /// Two causes of this squared correlation are one to the data.
        const SAME: f64 = 0.7;
        let rival =
            |(cause, _, correlation): &(usize, f64, f64)| causes[*cause].id == id && *correlation > SAME;
        causes[self.trial.cause].id == id || self.rivals.iter().any(rival)
    }
}

/// Beyond this ratio of variances the sensors have no part.
const MOST_LACK: f64 = 1e4;
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
pub fn search(
    case: &Case,
    balance: &Balance,
    pool: &Pool,
    causes: &[Cause],
    banned: &[&str],
) -> Option<Found> {
    let state = State { case, balance, pool, fit: &case.fit, banned };
    let used: Vec<usize> = (0..pool.nuisance).collect();
    let (noise, here) = state.settle(&used, None)?;
    let first_noise = noise;
    let before = state.left(&used, &here.estimate, None);
    let mut stand = Stand { used, function: None, noise, here };
    let mut accepted: Vec<Accepted> = Vec::new();
    let mut tried: Vec<Round> = Vec::new();
    for _ in 0..MOST_CAUSES {
        let by_chance = state.chance(&stand);
        let judged = state.judge(state.contest(&stand, &accepted), &stand);
        tried.push(Round {
            by_chance: LEAST_GAIN.max(by_chance),
            causes: judged.iter().map(|one| (one.trial.cause, one.trial.shape.clone(), one.gain)).collect(),
        });
        let Some((place, next)) = state.choose(&judged, &stand, LEAST_GAIN.max(by_chance)) else { break };
        let best = &judged[place];
        accepted.push(Accepted {
            trial: best.trial.clone(),
            gain: best.gain,
            by_chance,
            rivals: state.rivals(best, &judged[place + 1..], &stand),
            function: None,
        });
        stand = next;
    }
    let Stand { used, function, noise, here } = stand;
    let made = function.and_then(|own| state.function(&used, &here.estimate, own, &noise));
    if let Some((column, function)) = made {
        for one in &mut accepted {
            name_by_shape(one, &function, causes, pool);
            if one.trial.columns == [column] && over_something(&causes[one.trial.cause]) {
                one.function = Some(function.clone());
            }
        }
    }
    let shown = accepted.iter().find_map(|one| one.function.as_ref().map(|function| (&one.trial, function)));
    let left = state.left(&used, &here.estimate, shown);
    let lack = |noise: &Noise| (noise.process / noise.sensor.max(f64::MIN_POSITIVE)).min(MOST_LACK);
    Some(Found {
        tried,
        held_out_gain: state.held_out_gain(&before, &left, &noise),
        lack_of_fit: (lack(&first_noise), lack(&noise)),
        accepted,
        noise: (first_noise, noise),
        used,
        estimate: here.estimate,
        left,
        before,
    })
}

/// What it costs to have had the choice among so many shapes: ln of their number. A spell at the same time in every run,
/// with nothing that tells why, is less likely from the start.
fn choice(cause: &Cause) -> f64 {
    const BY_THE_CLOCK: f64 = 3.0;
    let clock = cause.terms.iter().any(|term| term.name == "from_s");
    (cause.shapes.len().max(1) as f64).ln() + if clock { BY_THE_CLOCK } else { 0.0 }
}

/// Whether a cause is a function of position or time.
fn over_something(cause: &Cause) -> bool {
    matches!(cause.form, Form::OverPosition | Form::OverTime)
}

/// Where the search stands.
struct Stand {
    used: Vec<usize>,
    function: Option<(usize, Spread)>,
    noise: Noise,
    here: Settled,
}

impl Stand {
    /// The columns and the function that it would have with one more cause.
    fn with(&self, one: &Contest) -> (Vec<usize>, Option<(usize, Spread)>) {
        let mut used = self.used.clone();
        let mut function = self.function;
        if let Some(spread) = one.spread {
            function = Some((one.trial.columns[0], spread));
        } else {
            used.extend(&one.trial.columns);
        }
        (used, function)
    }
}

/// A trial in a round.
#[derive(Clone)]
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
    banned: &'a [&'a str],
}

impl State<'_> {
    fn causes(&self) -> &[Cause] {
        &self.case.causes
    }

    /// The trials that are worth judging: by columns, and by functions where there is none yet.
    fn contest(&self, stand: &Stand, accepted: &[Accepted]) -> Vec<Contest> {
        /// Trials within this of the best one are judged, though they be many.
        const CLOSE: f64 = 10.0;
        let base = stand.here.estimate.log_evidence;
        let open = |trial: &&Trial| {
            let id = self.causes()[trial.cause].id;
            !self.banned.contains(&id) && !accepted.iter().any(|one| one.stands_for(id, self.causes()))
        };
        let mut contest: Vec<Contest> = Vec::new();
        for trial in self.pool.trials.iter().filter(open) {
            let cause = &self.causes()[trial.cause];
            if over_something(cause) {
                continue;
            }
            let mut with = stand.used.clone();
            with.extend(&trial.columns);
            let Some(estimate) = stand.here.reduced.estimate(&with, &self.pool.sd) else { continue };
            if !impossible(cause, trial, &estimate, stand.used.len()) {
                let gain = estimate.log_evidence - base - choice(cause);
                contest.push(Contest { trial: trial.clone(), gain, spread: None });
            }
        }
        contest.sort_by(|one, other| other.gain.total_cmp(&one.gain));
        if let Some(best) = contest.first().map(|one| one.gain) {
            let close = contest.iter().filter(|one| one.gain > best - CLOSE).count();
            contest.truncate(FINALISTS.max(close.min(2 * FINALISTS)));
        }
        if stand.function.is_none() {
            for trial in self.pool.trials.iter().filter(open) {
                let cause = &self.causes()[trial.cause];
                if over_something(cause)
                    && let Some((gain, spread)) =
                        self.best_spread(trial, cause, &stand.used, &stand.noise, base)
                {
                    contest.push(Contest { trial: trial.clone(), gain, spread: Some(spread) });
                }
            }
        }
        contest
    }

    /// The noise belongs to what is explained: each finalist is judged with its own. The best comes first.
    fn judge(&self, contest: Vec<Contest>, stand: &Stand) -> Vec<Contest> {
        let base = stand.here.estimate.log_evidence;
        let own = |one: Contest| {
            let (used, function) = stand.with(&one);
            let (_, settled) = self.settle_from(&used, function, &stand.noise)?;
            let gain = settled.estimate.log_evidence - base - choice(&self.causes()[one.trial.cause]);
            Some(Contest { gain, ..one })
        };
        let mut judged: Vec<Contest> = contest.into_par_iter().filter_map(own).collect();
        // Of two that explain as much, a cause in the world is named before a fault of a sensor.
        let rank = |one: &Contest| {
            let artefact = self.causes()[one.trial.cause].class == Class::Artefact;
            one.gain - if artefact { NEARLY } else { 0.0 }
        };
        judged.sort_by(|one, other| rank(other).total_cmp(&rank(one)));
        judged
    }

    /// The best that exceeds the threshold and matters, and where the search stands with it.
    fn choose(&self, judged: &[Contest], stand: &Stand, threshold: f64) -> Option<(usize, Stand)> {
        for (place, one) in judged.iter().enumerate() {
            if one.gain < threshold {
                return None;
            }
            let (used, function) = stand.with(one);
            let Some((noise, here)) = self.settle_from(&used, function, &stand.noise) else { continue };
            if self.matters(&used, &here, &one.trial, function, &noise) {
                return Some((place, Stand { used, function, noise, here }));
            }
        }
        None
    }

    /// Causes that explain as much as the best.
    fn rivals(&self, best: &Contest, others: &[Contest], stand: &Stand) -> Vec<(usize, f64, f64)> {
        let id = self.causes()[best.trial.cause].id;
        let mut rivals: Vec<(usize, f64, f64)> = Vec::new();
        for other in others {
            let rival = self.causes()[other.trial.cause].id;
            let listed = rivals.iter().any(|(known, _, _)| self.causes()[*known].id == rival);
            if rival == id || listed || other.gain <= best.gain - TOLERANCE {
                continue;
            }
            let reduced = &stand.here.reduced;
            let (one, two) = (&best.trial.columns, &other.trial.columns);
            let correlation = reduced.squared_correlation(one, two, &stand.used, &self.pool.sd);
            rivals.push((other.trial.cause, other.gain, correlation));
        }
        rivals
    }

    /// What was accepted, judged on the rows that were never used.
    fn held_out_gain(&self, before: &Column, left: &Column, noise: &Noise) -> Option<f64> {
        let whitener = noise.whitener(&self.balance.chunks)?;
        let mut gain = None;
        for (index, chunk) in self.balance.chunks.iter().enumerate().filter(|(_, chunk)| !self.fit[chunk.run])
        {
            let cost = |column: &Column| whitener.whiten(chunk, &column[index]).norm_squared();
            *gain.get_or_insert(0.0) += 0.5 * (cost(before) - cost(left));
        }
        gain
    }

    /// The growth of ln p that the best of all trials reaches by chance once in a hundred, if nothing is missing.
    fn chance(&self, stand: &Stand) -> f64 {
        let pool = self.pool;
        let usable = |trial: &&Trial| {
            let cause = &self.causes()[trial.cause];
            !self.banned.contains(&cause.id) && !over_something(cause)
        };
        let trials: Vec<&Trial> = pool.trials.iter().filter(usable).collect();
        let reduced = &stand.here.reduced;
        let mut jittered = reduced.matrix.clone();
        for index in 0..jittered.nrows() {
            jittered[(index, index)] = jittered[(index, index)] * (1.0 + 1e-9) + 1e-300;
        }
        let Some(cholesky) = jittered.cholesky() else { return LEAST_GAIN };
        let factor = cholesky.l();
        let one = |draw: u64| {
            let mut draws = Draws::new(self.case.seed, draw);
            let white = DVector::from_fn(factor.nrows(), |_, _| draws.normal());
            let mut problem = reduced.clone();
            problem.vector = &factor * white;
            problem.scalar = 0.0;
            let base = problem.estimate(&stand.used, &pool.sd)?;
            let gain = trials.iter().filter_map(|trial| {
                let mut with = stand.used.clone();
                with.extend(&trial.columns);
                Some(problem.estimate(&with, &pool.sd)?.log_evidence - base.log_evidence)
            });
            Some(gain.fold(f64::NEG_INFINITY, f64::max))
        };
        let best: Vec<f64> = (0..DRAWS).into_par_iter().filter_map(one).collect();
        if best.is_empty() { LEAST_GAIN } else { quantile_of_sorted(&sorted(&best), 0.99) }
    }

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
        let of = |(chunk, values): (&crate::rows::Chunk, &DVector<f64>)| {
            self.fit[chunk.run].then(|| values.clone())
        };
        self.balance.chunks.iter().zip(column).filter_map(of).collect()
    }

    /// Estimates, and lets the noise follow.
    fn settle_from(
        &self,
        used: &[usize],
        own: Option<(usize, Spread)>,
        start: &Noise,
    ) -> Option<(Noise, Settled)> {
        const ROUNDS: usize = 15;
        /// A growth of ln p below this is none.
        const SETTLED: f64 = 0.02;
        let chunks: Vec<_> = self.fit_chunks().cloned().collect();
        let mut noise = *start;
        let mut best: Option<(Noise, Settled)> = None;
        for _ in 0..ROUNDS {
            let whitened =
                Whitened::new(&self.balance.chunks, &self.balance.residual, &self.pool.columns, &noise)?;
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
            let better = best
                .as_ref()
                .is_none_or(|(_, one)| estimate.log_evidence > one.estimate.log_evidence + SETTLED);
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

    fn left(&self, used: &[usize], estimate: &Estimate, own: Option<(&Trial, &Function)>) -> Column {
        let mut left = self.balance.residual.clone();
        for (position, index) in used.iter().enumerate() {
            for (chunk, values) in left.iter_mut().zip(&self.pool.columns[*index]) {
                *chunk -= values * estimate.beta[position];
            }
        }
        match own {
            Some((trial, function)) => match self.profile_of(trial.columns[0]) {
                Some(profile) => self.minus(left, trial.columns[0], &profile, function),
                None => left,
            },
            None => left,
        }
    }

    fn minus(&self, mut left: Column, column: usize, profile: &Profile, function: &Function) -> Column {
        for (index, chunk) in self.balance.chunks.iter().enumerate() {
            let group = profile.group_of[chunk.run];
            let signature = &self.pool.columns[column][index];
            for ((left, at), signature) in left[index].iter_mut().zip(&profile.at[index]).zip(signature) {
                *left -= signature * function.value(group, *at);
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
        let whitened =
            Whitened::new(&self.balance.chunks, &self.balance.residual, &self.pool.columns, noise)?;
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
    ) -> Option<(usize, Function)> {
        let whitened =
            Whitened::new(&self.balance.chunks, &self.balance.residual, &self.pool.columns, noise)?;
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
        let others: Vec<usize> =
            used.iter().copied().filter(|column| *column >= self.pool.nuisance).collect();
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
        for (index, chunk) in self.balance.chunks.iter().enumerate().filter(|(_, chunk)| self.fit[chunk.run])
        {
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
    let positive =
        |(index, term): (usize, &usize)| cause.terms[*term].positive && estimate.beta[first + index] < 0.0;
    trial.terms.iter().enumerate().any(positive)
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
