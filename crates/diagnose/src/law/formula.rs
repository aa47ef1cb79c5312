//! What a formula is looked for in: the rows of one balance, beside what is known, and what may stand in it.

use crate::balances::balance::Kind;
use crate::balances::noise::Whiteners;
use crate::balances::rows::Row;
use crate::causes::catalogue::{Cause, ELECTRIC, FORCE, MECHANICAL, RESISTANCE, is_lost_share};
use crate::causes::trial::{Pool, Shown, effect, lost_drive_n, per_newton, per_slip};
use crate::choosing::state::{Part, Stand, State};
use crate::law::nameable::{agreed_m_s2, made_m_s2, moved_m_s2, variables, way_is_place};
use crate::line::Line;
use crate::runs::recorded::Recorded;
use crate::runs::said::Said;
use crate::{Case, DiagnoseError, System};
use headland_symbolic::{
    Enters, Law, Nuisance, Options, Problem, Rows, SymbolicError, Target, Variable, find,
};

/// What forces make.
const ACCELERATION: &str = "acceleration";

/// What is sought in a balance.
#[derive(Clone)]
pub struct Sought {
    /// The balance.
    pub kind: Kind,
    /// What the formula is.
    pub target: Target,
    /// What takes power, in the effect `expression`.
    consumer: &'static str,
    /// Whether places were recorded,
    placed: bool,
    /// and whether the way that a run came says them as well.
    from_one_place: bool,
    /// Whether it may name times and places.
    somewhen: bool,
    /// Force of the drive that a share of it is lost of, sample by sample of every run [N].
    drive_n: Vec<Vec<f64>>,
    /// Acceleration that a force may be made of, likewise [m/s²]; none where it may not.
    accelerations_m_s2: Option<Vec<Vec<f64>>>,
    /// Acceleration that a power may be made of, likewise, where it is not that of the speed, which is its twin then.
    sudden_m_s2: Option<Vec<Vec<f64>>>,
    /// What a formula of one makes of the rows of each balance that it shows in, sample by sample of every run: one watt or
    /// one newton, or all that a share is lost of.
    shows: Shown,
}

impl Sought {
    /// A formula of a balance; none where nothing has such a formula.
    pub fn new(
        case: &Case,
        system: &System,
        kind: Kind,
        target: Target,
    ) -> Result<Option<Self>, DiagnoseError> {
        let consumer = consumer(case, kind)?;
        let shows = match (target, kind) {
            (Target::Share, Kind::Motion) if !case.driven() => return Ok(None),
            (Target::Share, Kind::Motion) => vec![(kind, lost_drive_n(case)?)],
            (Target::Share, Kind::Slip) => per_slip(case, system)?,
            (Target::Force, _) => per_newton(case, system)?,
            (Target::Share, _) => of_powers(case, system, (kind, consumer), &driven_w(case))?,
            (Target::Power, _) => of_powers(case, system, (kind, consumer), &ones(case))?,
        };
        // Of the motion a law may know the force that was measured alone: the one that it asks for is made of it.
        let drive_n = |(run, said): (&Recorded, &Said)| match (target, kind) {
            (Target::Share, Kind::Motion) => run.known_force_n(),
            (Target::Share, _) => drive_n(run, said),
            (Target::Power, Kind::Shaft | Kind::Fuel) if run.force_is_known() => drive_n(run, said),
            (Target::Power, Kind::Battery) if run.force_is_known() => run.known_force_n(),
            _ => Vec::new(),
        };
        let drive_n = case.runs.iter().zip(&case.nominal).map(drive_n).collect();
        let placed = case.runs.iter().any(|run| run.measured.trace.get("position_m").is_some());
        let of_motion = target == Target::Force && kind == Kind::Motion;
        let accelerations_m_s2 = if of_motion { agreed_m_s2(case) } else { None };
        Ok(shows.iter().any(|(shown, _)| *shown == kind).then_some(Self {
            kind,
            target,
            consumer,
            placed,
            from_one_place: placed && way_is_place(case),
            somewhen: true,
            drive_n,
            accelerations_m_s2,
            sudden_m_s2: None,
            shows,
        }))
    }

    /// The same by a formula that names neither times nor places.
    pub fn anywhen(&self) -> Self {
        Self { somewhen: false, ..self.clone() }
    }

    /// The same for a law of a power that names the acceleration, by that which measured forces make: they show what is sudden better than
    /// the speed does.
    pub fn by_forces(&self, case: &Case, law: &Law) -> Option<Self> {
        let forced = case.runs.iter().all(Recorded::force_is_known);
        let able = self.target == Target::Power && forced && law.names(ACCELERATION);
        able.then(|| Self { sudden_m_s2: Some(made_m_s2(case)), ..self.clone() })
    }

    /// Whether places were recorded, and whether the way that a run came says them as well.
    pub fn places(&self) -> (bool, bool) {
        (self.placed, self.from_one_place)
    }

    /// What a law is in the effect `expression`: a force that pushes more than all that resists only there pushes. Nothing pushes by the
    /// clock: steps of a coarse speed come at the same times in runs that slow down alike.
    pub fn role(&self, case: &Case, law: &Law) -> &'static str {
        /// Share of the samples.
        const NOW_AND_THEN: f64 = 0.01;
        const CLOCK: &str = "t";
        if self.target != Target::Force {
            return self.consumer;
        }
        if law.names(CLOCK) {
            return RESISTANCE;
        }
        let of_run = |(said, own): (&Said, &Vec<f64>)| {
            let forces = said.resistance_n.iter().zip(own);
            forces.filter(|(resistance, own)| **own < (-**resistance).min(0.0)).count()
        };
        let pushed: usize = case.nominal.iter().zip(&law.prediction).map(of_run).sum();
        let all: usize = law.prediction.iter().map(Vec::len).sum();
        if pushed as f64 > NOW_AND_THEN * all as f64 { FORCE } else { RESISTANCE }
    }

    /// Whether a law of a force hangs on the acceleration that it makes.
    pub fn hangs(&self, law: &Law) -> bool {
        self.accelerations_m_s2.is_some() && law.text.contains(ACCELERATION)
    }

    /// Whether a law of a force hangs on the acceleration that it makes as a mass does: by a term that is in proportion to it, nearly, at the
    /// accelerations that were driven, or by about as much as the vehicle's own, which is the force itself by another name.
    pub fn is_mass(&self, case: &Case, law: &Law) -> bool {
        /// Share of the term's square that goes in proportion.
        const NEARLY: f64 = 0.97;
        /// Share of the mass.
        const OWN: f64 = 0.8;
        let Some(accelerations) = self.accelerations_m_s2.as_ref().filter(|_| self.hangs(law)) else {
            return false;
        };
        let masses_kg = case.nominal.iter().filter_map(Said::first_mass_kg);
        let own_kg = OWN * masses_kg.fold(f64::INFINITY, f64::min);
        let terms = if law.each.is_empty() { std::slice::from_ref(law) } else { &law.each[..] };
        let mut bent = terms.iter().filter(|term| term.text.contains(ACCELERATION));
        bent.any(|term| straight(&term.prediction, accelerations) > NEARLY || steepest_kg(term) > own_kg)
    }

    /// Whether a law is found more truly once it is known: one that hangs on the acceleration that it makes, or a slip, which makes the
    /// more of wheels the more they slip.
    pub fn makes_itself(&self, law: &Law) -> bool {
        self.hangs(law) || self.kind == Kind::Slip
    }

    /// The same once a law is known: the vehicle accelerates as it does with that, where that hangs on the acceleration, and wheels that
    /// slip turn as they do with it, by v_w − v = s v / (1 − s).
    pub fn moved_by(&self, case: &Case, law: &Law) -> Self {
        /// Of wheels that slip more than this nothing is in proportion.
        const MOST: f64 = 0.5;
        let moved_m_s2 = self.hangs(law).then(|| moved_m_s2(case, &law.prediction));
        let mut shows = self.shows.clone();
        if self.kind == Kind::Slip {
            let slip = shows.iter_mut().filter(|(kind, _)| *kind == Kind::Slip);
            for (samples, slips) in slip.flat_map(|(_, runs)| runs.iter_mut().zip(&law.prediction)) {
                for (sample, slip) in samples.iter_mut().zip(slips) {
                    *sample /= 1.0 - slip.clamp(-MOST, MOST);
                }
            }
        }
        let accelerations_m_s2 = moved_m_s2.or_else(|| self.accelerations_m_s2.clone());
        Self { accelerations_m_s2, shows, ..self.clone() }
    }

    /// The same of the drive without what its force answers, sample by sample of every run [N].
    fn without_answers(&self, answers_n: &[Vec<f64>]) -> Self {
        /// A force is none that is less than this [N].
        const NONE_N: f64 = 1.0;
        let without = |(drive_n, answers_n): (&Vec<f64>, &Vec<f64>)| {
            drive_n.iter().zip(answers_n).map(|(drive_n, answer_n)| drive_n - answer_n).collect()
        };
        let drive_n: Vec<Vec<f64>> = self.drive_n.iter().zip(answers_n).map(without).collect();
        let of_one = |(run, shown): (usize, &Vec<f64>)| {
            let pairs = shown.iter().zip(self.drive_n[run].iter().zip(&drive_n[run]));
            let share = |(shown, (all, left)): (&f64, (&f64, &f64))| {
                if all.abs() < NONE_N { *shown } else { shown * left / all }
            };
            pairs.map(share).collect()
        };
        let shows = self
            .shows
            .iter()
            .map(|(kind, of)| (*kind, of.iter().enumerate().map(of_one).collect()))
            .collect();
        Self { drive_n, shows, ..self.clone() }
    }

    /// What a balance's rows are made of, of what a formula says of a run; nothing where it does not show there.
    pub fn samples(&self, kind: Kind, run: usize, said: &[f64]) -> Vec<f64> {
        self.samples_of_every(1, kind, run, said)
    }

    /// As [`Sought::samples`], of every so many samples of the run.
    fn samples_of_every(&self, every: usize, kind: Kind, run: usize, said: &[f64]) -> Vec<f64> {
        let Some((_, of_one)) = self.shows.iter().find(|(own, _)| *own == kind) else { return Vec::new() };
        // Where it shows in other runs only nothing is there.
        if of_one[run].is_empty() {
            return Vec::new();
        }
        said.iter().enumerate().map(|(index, value)| of_one[run][every * index] * value).collect()
    }

    /// Whether a share of the drive that is lost is one that is gained, as often as not: the share of a nominal loss that was stated too
    /// large may be.
    pub fn gains(&self, law: &Law) -> bool {
        /// Of all that the law takes and gives.
        const MOST: f64 = 0.1;
        let (mut gained, mut all) = (0.0, 0.0);
        for (_, lost_n) in self.forces_and_losses_n(law) {
            gained += (-lost_n).max(0.0);
            all += lost_n.abs();
        }
        gained > MOST * all
    }

    /// Whether of a force that rises hardly more goes on: no drive loses all that is added to it, and such a law answers a force with
    /// itself, whatever the vehicle does.
    pub fn answers_itself(&self, law: &Law) -> bool {
        /// Of what the force rises by.
        const MOST: f64 = 0.5;
        let (forces_n, losses_n): (Vec<f64>, Vec<f64>) = self.forces_and_losses_n(law).unzip();
        Line::through(&forces_n, &losses_n).slope > MOST
    }

    /// The size of the drive's force and what a law says is lost of it, sample by sample [N]; none where no share is sought.
    fn forces_and_losses_n<'a>(&'a self, law: &'a Law) -> impl Iterator<Item = (f64, f64)> + 'a {
        let runs = law.prediction.iter().zip(&self.drive_n).filter(|_| is_lost_share(self.target, self.kind));
        let pairs = runs.flat_map(|(shares, drive_n)| shares.iter().zip(drive_n));
        pairs.map(|(share, drive_n)| (drive_n.abs(), share * drive_n.abs()))
    }

    /// What may stand in the formula. What is lost on the way of a force is no matter of places or times; turns load the gears
    /// between wheels that turn unlike each other.
    fn variables(&self, case: &Case) -> Vec<Variable> {
        const OF_A_DRIVE: [&str; 6] = ["v", "temperature", "m", "engine_speed", "oil_temperature", "kappa"];
        let mut all = variables(case, if self.target == Target::Force { Kind::Motion } else { self.kind });
        if !self.somewhen {
            all.retain(|variable| !["t", "x"].contains(&variable.name.as_str()));
        }
        if is_lost_share(self.target, self.kind) {
            all.retain(|variable| OF_A_DRIVE.contains(&variable.name.as_str()));
        }
        // What an engine gives beside its wheels goes with the size of their force, whichever way that acts: its sign is that of a power
        // that is known.
        let of_share = self.target == Target::Share;
        if of_share || self.drive_n.iter().all(|run| !run.is_empty()) && self.target == Target::Power {
            let (name, unit) = ("F_drive".to_owned(), "N".to_owned());
            let enters = if of_share { Enters::Freely } else { Enters::BySize };
            all.push(Variable { name, unit, runs: self.drive_n.clone(), twin: None, finest: 0.0, enters });
        }
        if let Some(runs) = &self.sudden_m_s2 {
            for variable in all.iter_mut().filter(|variable| variable.name == ACCELERATION) {
                variable.twin = Some(std::mem::replace(&mut variable.runs, runs.clone()));
            }
        }
        if let Some(runs) = &self.accelerations_m_s2 {
            let (name, unit) = (ACCELERATION.to_owned(), "m/s²".to_owned());
            all.push(Variable {
                name,
                unit,
                runs: runs.clone(),
                twin: None,
                finest: 0.0,
                enters: Enters::Bent,
            });
        }
        all
    }
}

/// The share of the square of a force [N] that is in proportion to an acceleration [m/s²].
fn straight(force_n: &[Vec<f64>], accelerations_m_s2: &[Vec<f64>]) -> f64 {
    let runs = || force_n.iter().zip(accelerations_m_s2);
    let pairs = || runs().flat_map(|(forces, accelerations)| forces.iter().zip(accelerations));
    let sum = |of: fn(f64, f64) -> f64| pairs().map(|(force, at)| of(*force, *at)).sum::<f64>();
    sum(|force, at| force * at).powi(2) / (sum(|force, _| force * force) * sum(|_, at| at * at))
}

/// How steeply a term rises with an acceleration where it does so most [kg]: tanh(a/s) by 1/s, what sets in beyond a value by that as well,
/// and a step by half of it.
fn steepest_kg(term: &Law) -> f64 {
    const STEP: &str = "0.5 *";
    let amplitude_n = term.constants.iter().find(|one| one.is_amplitude()).map_or(0.0, |one| one.value);
    let scale = |name: &str| name.starts_with(ACCELERATION) && term.text.contains(&format!("/ {name}"));
    let scale_m_s2 =
        term.constants.iter().find(|one| scale(&one.name)).map_or(f64::INFINITY, |one| one.value);
    let share = if term.text.contains(STEP) { 0.5 } else { 1.0 };
    share * (amplitude_n / scale_m_s2).abs()
}

/// The force of the drive, sample by sample [N]: as measured, or as the motion asks for it where the vehicle does not roll freely.
fn drive_n(run: &Recorded, said: &Said) -> Vec<f64> {
    if let Some(force_n) = run.measured.trace.get("tractive_force_n") {
        return force_n.to_vec();
    }
    let coasting = run.measured.trace.get("coasting");
    let asked_n = |index: usize| {
        let free = coasting.is_some_and(|coasting| coasting[index] >= 0.5);
        let moved_n = said.effective_mass_kg[index] * run.acceleration_m_s2[index];
        if free { 0.0 } else { moved_n + said.resistance_n[index] }
    };
    (0..run.acceleration_m_s2.len()).map(asked_n).collect()
}

/// What the force of the drive takes, sample by sample [W].
fn driven_w(case: &Case) -> Vec<Vec<f64>> {
    let of_run = |(run, said): (&Recorded, &Said)| {
        drive_n(run, said).iter().zip(&run.motion.value).map(|(force_n, v)| (force_n * v).abs()).collect()
    };
    case.runs.iter().zip(&case.nominal).map(of_run).collect()
}

/// One, at every sample of every run.
fn ones(case: &Case) -> Vec<Vec<f64>> {
    case.runs.iter().map(|run| vec![1.0; run.motion.value.len()]).collect()
}

/// What powers [W] make of the balance that they are drawn in, and of those in which that shows: what takes power at the shaft
/// takes fuel for it.
fn of_powers(
    case: &Case,
    system: &System,
    (kind, consumer): (Kind, &'static str),
    power_w: &[Vec<f64>],
) -> Result<Shown, DiagnoseError> {
    let shows: &[Kind] = match kind {
        Kind::Shaft => &[Kind::Shaft, Kind::Fuel],
        Kind::Fuel => &[Kind::Fuel],
        _ => return Ok(vec![(kind, power_w.to_vec())]),
    };
    let shown = |kind: &Kind| {
        let watts = per_watt(case, system, (*kind, consumer))?;
        let times = |run: &Vec<f64>| run.iter().map(|power_w| watts * power_w).collect();
        Ok((*kind, power_w.iter().map(times).collect()))
    };
    shows.iter().filter(|kind| system.has(**kind)).map(shown).collect()
}

/// What takes power in a balance: what an engine gives by torque or takes in fuel is taken off its shaft, and where a second store can give
/// it, as from a battery, as electric power.
fn consumer(case: &Case, kind: Kind) -> Result<&'static str, DiagnoseError> {
    if !matches!(kind, Kind::Shaft | Kind::Fuel) {
        return Ok(ELECTRIC);
    }
    let study = &case.study;
    let model = study.model_of(study.scenario(), &case.runs[0].measured, &study.priors())?;
    Ok(if model.driveline.needs_management() { ELECTRIC } else { MECHANICAL })
}

/// Power at the shaft or in the fuel that a consumer of one watt takes, on average.
fn per_watt(
    case: &Case,
    system: &System,
    (kind, consumer): (Kind, &'static str),
) -> Result<f64, DiagnoseError> {
    /// A consumer of a usual size [W].
    const USUAL_W: f64 = 1000.0;
    let consumer = Cause::consumer(consumer);
    let column = effect(case, system, &consumer, USUAL_W, &|_| consumer.written(&[USUAL_W]))?;
    let (mut sum, mut count) = (0.0, 0.0);
    for (chunk, rows) in system.chunks.iter().zip(&column) {
        if system.kind(chunk) == kind && case.fit[chunk.run] {
            sum += rows.sum();
            count += rows.len() as f64;
        }
    }
    Ok(if sum > 0.0 { sum / count } else { 1.0 })
}

/// From samples to whitened rows of one balance.
struct Whitening<'a> {
    system: &'a System,
    whiteners: Whiteners,
    sought: &'a Sought,
    /// Every how many samples of each run one is looked at.
    every: Vec<usize>,
}

impl Whitening<'_> {
    fn of(&self, run: usize, values: impl Fn(usize) -> nalgebra::DVector<f64>) -> Vec<f64> {
        let chunks = self.system.chunks.iter().enumerate();
        let own = chunks.filter(|(_, chunk)| chunk.run == run && self.system.kind(chunk) == self.sought.kind);
        own.flat_map(|(index, chunk)| {
            self.whiteners.white(index, chunk, &values(index)).iter().copied().collect::<Vec<_>>()
        })
        .collect()
    }
}

impl Rows for Whitening<'_> {
    fn rows(&self, run: usize, samples: &[f64]) -> Vec<f64> {
        let every = self.every[run];
        let samples = self.sought.samples_of_every(every, self.sought.kind, run, samples);
        self.of(run, |index| {
            let rows = &self.system.chunks[index].rows;
            nalgebra::DVector::from_iterator(
                rows.len(),
                rows.iter().map(|row| row.mean_of_every(every, &samples)),
            )
        })
    }

    fn every(&self, run: usize) -> usize {
        self.every[run]
    }
}

/// Every how many samples of a run one is enough for the rows of a balance: a wave that rows show takes four blocks.
fn every(system: &System, kind: Kind, run: usize) -> usize {
    /// Samples of a block that are looked at, at least.
    const SAMPLES: usize = 6;
    let own = system.chunks.iter().filter(|chunk| chunk.run == run && system.kind(chunk) == kind);
    let block = |row: &Row| (row.samples[2] - row.samples[0]) / 2;
    let least = own.flat_map(|chunk| &chunk.rows).map(block).min();
    least.map_or(1, |samples| (samples / SAMPLES).max(1))
}

/// The law that is worth it, beside what is known, and behind it the best of fewer terms. Its noise is that of the set that says most,
/// and what that one leaves a driver answers with force.
pub fn laws(
    case: &Case,
    system: &System,
    pool: &Pool,
    beside: &[Part],
    known: &Stand,
    sought: &Sought,
) -> Result<Vec<Law>, DiagnoseError> {
    let noises = &known.noises;
    let Some(whiteners) = noises.whiteners(&system.chunks) else { return Ok(Vec::new()) };
    let state = State { case, system, pool, fit: &case.fit };
    let unanswered = match (sought.target, sought.kind) {
        (Target::Share, Kind::Motion) => Some(sought.without_answers(&state.answers_n(known))),
        _ => None,
    };
    let sought = unanswered.as_ref().unwrap_or(sought);
    let runs = 0..case.runs.len();
    let every = runs.clone().map(|run| every(system, sought.kind, run)).collect();
    let whitening = Whitening { system, whiteners, sought, every };
    // What a function does is taken away; all other causes are free beside the law.
    let stand =
        if beside.iter().any(|part| part.spread.is_some()) { state.settle(beside, noises) } else { None };
    let mut residual = system.residual.clone();
    for part in beside.iter().filter(|part| part.spread.is_some()) {
        let Some(stand) = &stand else { continue };
        for (residual, effect) in residual.iter_mut().zip(stand.effect(&state, part)) {
            *residual -= effect;
        }
    }
    let residual: Vec<Vec<f64>> =
        runs.clone().map(|run| whitening.of(run, |index| residual[index].clone())).collect();
    let parametric: Vec<Part> = beside.iter().filter(|part| part.spread.is_none()).cloned().collect();
    let all_sd = state.sd();
    let nuisances: Vec<Nuisance> = state
        .columns(&parametric)
        .into_iter()
        .map(|column| Nuisance {
            sd: all_sd[column],
            runs: runs
                .clone()
                .map(|run| whitening.of(run, |index| pool.columns[column][index].clone()))
                .collect(),
        })
        .collect();
    let variables = sought.variables(case);
    let fit = enough(&case.fit, &residual);
    let times_s: Vec<Vec<f64>> = case.runs.iter().map(|run| run.measured.trace.time_s().to_vec()).collect();
    let problem = Problem {
        variables: &variables,
        times_s: &times_s,
        target: sought.target,
        rows: &whitening,
        residual: &residual,
        nuisances: &nuisances,
        fit: &fit,
    };
    let options = Options { seed: case.options.seed, ..Options::default() };
    match find(&problem, &options, &|| case.progress.interrupted()) {
        Ok(found) => Ok(found.laws().into_iter().cloned().collect()),
        Err(SymbolicError::Interrupted) => Err(DiagnoseError::Interrupted),
        // What is no problem for it has no law either: no rows, a run without samples.
        Err(_) => Ok(Vec::new()),
    }
}

/// The fitted runs that are enough to find a formula by: evenly taken among them where their rows are many. What is found is
/// judged by all of them.
fn enough(fit: &[bool], rows: &[Vec<f64>]) -> Vec<bool> {
    const ENOUGH: usize = 7_000;
    let all: usize = rows.iter().zip(fit).filter(|(_, fit)| **fit).map(|(rows, _)| rows.len()).sum();
    let every = all.div_ceil(ENOUGH).max(1);
    let mut fitted = 0;
    let take = |fit: &bool| {
        fitted += usize::from(*fit);
        *fit && fitted % every == every / 2
    };
    fit.iter().map(take).collect()
}

#[cfg(test)]
mod tests {
    use super::{Sought, enough, steepest_kg, straight};
    use crate::balances::balance::Kind;
    use crate::causes::catalogue::ELECTRIC;
    use headland_symbolic::{Law, Target};

    #[test]
    fn a_loss_that_takes_all_that_a_force_rises_by_answers_with_itself() {
        let force_n: Vec<f64> = (20..=130).step_by(10).map(f64::from).collect();
        let sought = Sought {
            kind: Kind::Motion,
            target: Target::Share,
            consumer: ELECTRIC,
            placed: false,
            from_one_place: false,
            somewhen: true,
            drive_n: vec![force_n.clone()],
            accelerations_m_s2: None,
            sudden_m_s2: None,
            shows: Vec::new(),
        };
        let loses = |share: &dyn Fn(f64) -> f64| {
            let prediction = vec![force_n.iter().map(|force_n| share(*force_n)).collect()];
            Law { prediction, ..Law::default() }
        };
        assert!(sought.answers_itself(&loses(&|force_n| 1.06 * (force_n / 119.0).tanh())));
        // A fifth of the greatest force, by its square.
        assert!(!sought.answers_itself(&loses(&|force_n| 0.2 * force_n / 130.0)));
        assert!(!sought.answers_itself(&loses(&|_| 0.3)));
    }

    #[test]
    fn what_saturates_beyond_all_that_was_driven_is_in_proportion() {
        let driven: Vec<f64> = (-50..=50).map(|step| 0.02 * f64::from(step)).collect();
        let of = |at_m_s2: f64| {
            let force_n = driven.iter().map(|at| 160.0 * (at / at_m_s2).tanh()).collect();
            straight(&[force_n], std::slice::from_ref(&driven))
        };
        assert!(of(2.0) > 0.97 && of(0.3) < 0.97, "{} {}", of(2.0), of(0.3));
    }

    #[test]
    fn a_force_rises_with_the_acceleration_by_its_scale() {
        let constant = |(name, value): (&str, f64)| headland_symbolic::Constant {
            name: name.to_owned(),
            value,
            sd: None,
            unit: String::new(),
        };
        let kg = |text: &str| {
            let values = [("a1_n", 160.0), ("acceleration1_m_s2", -0.2), ("acceleration2_m_s2", 2.0)];
            let constants = values.map(constant).into_iter().collect();
            steepest_kg(&Law { text: text.to_owned(), constants, ..Law::default() })
        };
        assert_eq!(kg("a1_n * tanh(acceleration / acceleration2_m_s2)"), 80.0);
        assert_eq!(kg("a1_n * max((acceleration1_m_s2 - acceleration) / acceleration2_m_s2, 0)"), 80.0);
        let step = "a1_n * 0.5 * (1 - tanh((acceleration - acceleration1_m_s2) / acceleration2_m_s2))";
        assert_eq!(kg(step), 40.0);
    }

    #[test]
    fn of_many_rows_a_share_of_the_runs_is_taken_evenly() {
        let fit = [true, true, false, true, true, true, true];
        assert_eq!(enough(&fit, &vec![vec![0.0; 10]; 7]), fit);
        let few = enough(&fit, &vec![vec![0.0; 3000]; 7]);
        assert_eq!(few, [true, false, false, false, true, false, false]);
    }
}
