//! A scenario held against a recording: what drives the model, what it is told, and what it is judged by.

use crate::curved::{self, is_straight, with_curvature};
use crate::fit::{Fit, Parameter, Residuals, fit};
use crate::laid;
use crate::sparse::{self, Sparse, filled};
use crate::statistics::{mean, median};
use headland_plugin::Registry;
use headland_recording::{RecordedRun, Recording};
use headland_scenario::{Scenario, ScenarioError};
use headland_sim::{Drive, Inputs, Model, Outcome, Replay, ReplayError, chainage_from_m, replay, travelled};
use headland_trace::{Origin, Trace, TraceError};
use rayon::prelude::*;

/// A recording that cannot be held against a scenario.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The scenario.
    #[error("{}", .0.told())]
    Scenario(Box<ScenarioError>),
    /// A run cannot drive the model.
    #[error("run `{run}`: {error}")]
    Replay {
        /// The run.
        run: String,
        /// Why.
        error: ReplayError,
    },
    /// A run does not say how fast the vehicle was.
    #[error(
        "run `{run}`: {}; a model is driven along the recorded speed, so at least two samples of `speed_m_s` are needed; \
         measured are: {}",
        if *there { "channel `speed_m_s` has fewer than two values" } else { "there is no channel `speed_m_s`" },
        measured.join(", ")
    )]
    NoSpeed {
        /// The run.
        run: String,
        /// Whether there is such a channel at all.
        there: bool,
        /// Channels that were measured.
        measured: Vec<String>,
    },
    /// Two samples are so far apart that they are not of one run.
    #[error(
        "run `{run}`: `time_s` jumps from {before_s:?} s to {after_s:?} s, and nothing drives longer than {most_s} s between \
         two samples; is the clock of the first samples not set, or the unit of time wrong?"
    )]
    Jump {
        /// The run.
        run: String,
        /// Time before [s].
        before_s: f64,
        /// Time after [s].
        after_s: f64,
        /// Longest time between two samples of one run [s].
        most_s: f64,
    },
    /// Nothing that was measured is predicted.
    #[error(
        "run `{run}` holds nothing that the model predicts when `{drive}` drives it; measured are: {}; it would take one of: {}",
        measured.join(", "), wanted.join(", ")
    )]
    NothingToCompare {
        /// The run.
        run: String,
        /// What drives the model.
        drive: &'static str,
        /// Channels that were measured.
        measured: Vec<String>,
        /// Channels that could be compared.
        wanted: Vec<String>,
    },
    /// The scenario frees nothing.
    #[error("{} has no `free` parameters, so there is nothing to fit", path.display())]
    NothingFree {
        /// The scenario.
        path: std::path::PathBuf,
    },
    /// [`Study::stop`] said so.
    #[error("interrupted")]
    Interrupted,
    /// There is nothing left to fit.
    #[error("every run of the recording is held out; at least one has to be `use: fit`")]
    AllHeldOut,
    /// A trace does not come together: a bug.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

impl From<ScenarioError> for StudyError {
    fn from(error: ScenarioError) -> Self {
        Self::Scenario(Box::new(error))
    }
}

/// One recorded run, ready to drive the model.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Its name.
    pub id: String,
    /// Its channels, with what follows from them (`battery_power_w`).
    pub trace: Trace,
    /// How it drives the model.
    pub how: Replay,
    /// Channels by which the model is judged.
    pub signals: Vec<String>,
    /// Whether it must not be fitted.
    pub held_out: bool,
    /// Values that the recording knows for this run: dotted path and value.
    pub known: Vec<(String, f64)>,
    /// Samples that are compared.
    pub compared: Vec<bool>,
    /// Samples at which it is not known what the model is driven by, and which are therefore not compared; empty where there are none.
    pub unknown: Vec<bool>,
}

/// A scenario with the recording that it is held against.
#[derive(Clone)]
pub struct Study<'a> {
    scenario: &'a Scenario,
    registry: &'a Registry,
    /// The runs.
    pub runs: Vec<Measured>,
    /// The free parameters, with what the recording knows of them as prior.
    pub parameters: Vec<Parameter>,
    paths: Vec<String>,
    /// What was decided on the way, for people.
    pub notes: Vec<String>,
    /// Whether the scenario's path is straight, so that east and north along it say no more than the distance.
    pub straight: bool,
    /// Asked before each replay whether to give up.
    pub stop: fn() -> bool,
}

/// Samples farther apart are not of one run [s]: thirty days. A clock that was set on the way jumps by years.
const LONGEST_JUMP_S: f64 = 30.0 * 86_400.0;
/// Half width of the local fit of recorded speed, in samples, where the scenario does not say: so many,
const SMOOTHING_SAMPLES: f64 = 5.0;
/// no longer than this [s], or an acceleration that comes and goes within seconds would be less than it was,
const LONGEST_SMOOTHING_S: f64 = 1.5;
/// and no fewer than a parabola needs.
const LEAST_SMOOTHING_SAMPLES: f64 = 2.0;
/// Recordings longer than this are driven forward in windows [s].
const LONG_S: f64 = 180.0;
/// Their length [s].
const WINDOW_S: f64 = 30.0;
/// The channel that says whether the vehicle rolls free.
const COASTING: &str = "coasting";
/// Channels that only a vehicle has that something drives.
const DRIVING: [&str; 6] = [
    "tractive_force_n",
    "motor_torque_n_m",
    "engine_torque_n_m",
    "fuel_rate_kg_s",
    "battery_current_a",
    "state_of_charge",
];

impl<'a> Study<'a> {
    /// Brings a scenario and a recording together.
    ///
    /// # Errors
    /// [`StudyError`] where a run cannot drive the model, or gives nothing to judge it by.
    pub fn new(
        scenario: &'a Scenario,
        recording: &Recording,
        registry: &'a Registry,
    ) -> Result<Self, StudyError> {
        let study = Self::of_any(scenario, recording, registry)?;
        match study.runs.iter().find(|run| run.signals.is_empty()) {
            Some(run) => Err(StudyError::NothingToCompare {
                run: run.id.clone(),
                drive: drive_name(run.how.drive),
                measured: run.trace.channels().iter().map(|channel| channel.name.clone()).collect(),
                wanted: signals(run.how.drive).iter().map(|name| (*name).to_owned()).collect(),
            }),
            None => Ok(study),
        }
    }

    /// As [`Study::new`], though a run may hold nothing that the model predicts.
    ///
    /// # Errors
    /// [`StudyError`] where a run cannot drive the model.
    pub fn of_any(
        scenario: &'a Scenario,
        recording: &Recording,
        registry: &'a Registry,
    ) -> Result<Self, StudyError> {
        let model = scenario.model(registry)?;
        let straight = is_straight(&model);
        let turned = if straight { with_curvature(recording)? } else { None };
        let mut notes = turned.as_ref().map_or_else(Vec::new, |(_, made)| curved::told(made));
        let mut recording = turned.map_or_else(|| recording.clone(), |(turned, _)| turned);
        notes.extend(laid::told(&laid::lay(&mut recording.runs)?));
        let mut runs: Vec<Measured> = Vec::new();
        let mut gaps: Vec<Sparse> = Vec::new();
        for (number, run) in recording.runs.iter().enumerate() {
            let length_m = path_length_m(&recording, run.path.as_deref());
            let mut measured = measured(scenario, &model, run, length_m, (&mut notes, &mut gaps))?;
            let same = |other: &&RecordedRun| run.path.is_some() && other.path == run.path;
            measured.how.passes_before = recording.runs[..number].iter().filter(same).count();
            runs.push(measured);
        }
        notes.extend(sparse::told(&gaps));
        let mut parameters = Vec::new();
        let mut paths = Vec::new();
        for free in &scenario.free {
            let mut parameter =
                Parameter { name: free.name.clone(), value: free.value, sd: free.sd, bounds: free.bounds };
            for known in &recording.known {
                if scenario.document().resolve(&known.name).is_ok_and(|path| path == free.path) {
                    parameter.value = known.value.clamp(free.bounds.0, free.bounds.1);
                    parameter.sd = known.sd.or(parameter.sd);
                    let beyond = if parameter.value == known.value {
                        String::new()
                    } else {
                        format!(
                            ", and so beyond its bounds, of which the nearer one is taken: {}",
                            parameter.value
                        )
                    };
                    notes.push(format!(
                        "the prior of `{}` is what the recording knows of it: {}{beyond}",
                        free.name, known.value
                    ));
                }
            }
            parameters.push(parameter);
            paths.push(free.path.clone());
        }
        let mut unique: Vec<String> = Vec::new();
        for note in notes {
            if !unique.contains(&note) {
                unique.push(note);
            }
        }
        let notes = unique;
        Ok(Self { scenario, registry, runs, parameters, paths, notes, straight, stop: || false }.limited())
    }

    /// The scenario.
    pub fn scenario(&self) -> &Scenario {
        self.scenario
    }

    /// Dotted paths of the free parameters.
    pub fn paths(&self) -> &[String] {
        &self.paths
    }

    /// Where nobody gave a free parameter a bound, that is the last value that the model accepts, where it refuses any.
    fn limited(mut self) -> Self {
        /// Nothing is ever so many standard deviations from its prior.
        const FAR: f64 = 40.0;
        const HALVINGS: usize = 40;
        let Some(run) = self.runs.first().cloned() else { return self };
        for index in 0..self.parameters.len() {
            let Parameter { value, sd, bounds, .. } = self.parameters[index].clone();
            let reach = FAR * sd.unwrap_or(value.abs());
            let able = |changed: f64| {
                let mut values = self.priors();
                values[index] = changed;
                self.model(&run, &values).is_ok()
            };
            let last = |bound: f64, side: f64| {
                let (mut inside, mut beyond) = (value, value + side * reach);
                if bound.is_finite() || able(beyond) || !able(inside) {
                    return bound;
                }
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (inside + beyond);
                    if able(middle) { inside = middle } else { beyond = middle }
                }
                inside
            };
            self.parameters[index].bounds = (last(bounds.0, -1.0), last(bounds.1, 1.0));
        }
        self
    }

    /// The prior values of the free parameters.
    pub fn priors(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.value).collect()
    }

    /// The values that the scenario stands for: its own number where a prior is stated apart from it, as a calibration
    /// leaves it, else the prior.
    pub fn start(&self) -> Vec<f64> {
        let value = |(free, parameter): (&headland_scenario::Free, &Parameter)| {
            let stands = self.scenario.document().number(&free.path);
            stands.filter(|stands| *stands != free.value).unwrap_or(parameter.value)
        };
        self.scenario.free.iter().zip(&self.parameters).map(value).collect()
    }

    /// The model of a run, with these values of the free parameters.
    ///
    /// # Errors
    /// [`StudyError::Scenario`].
    pub fn model(&self, run: &Measured, values: &[f64]) -> Result<Model, StudyError> {
        self.model_of(self.scenario, run, values)
    }

    /// As [`Study::model`], of a variant of the scenario.
    ///
    /// # Errors
    /// [`StudyError::Scenario`].
    pub fn model_of(&self, scenario: &Scenario, run: &Measured, values: &[f64]) -> Result<Model, StudyError> {
        let known = |path: &str| run.known.iter().find(|(own, _)| own == path).map(|(_, value)| *value);
        // What is known of one run, as ballast is, differs from the rest by as much, whatever the rest is fitted to.
        let free = self.paths.iter().zip(&self.parameters).zip(values).map(|((path, parameter), value)| {
            (path.as_str(), value + known(path).map_or(0.0, |known| known - parameter.value))
        });
        let fixed = run.known.iter().map(|(path, value)| (path.as_str(), *value));
        let fixed = fixed.filter(|(path, _)| !self.paths.iter().any(|free| free == path));
        let changes: Vec<(&str, f64)> = free.chain(fixed).collect();
        Ok(scenario.model_with(&changes, self.registry)?)
    }

    /// Drives the model with a run.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn replay(&self, run: &Measured, values: &[f64]) -> Result<Outcome, StudyError> {
        if (self.stop)() {
            return Err(StudyError::Interrupted);
        }
        let model = self.model(run, values)?;
        let mut outcome = replay(&model, &run.trace, &run.how)
            .map_err(|error| StudyError::Replay { run: run.id.clone(), error })?;
        derive(&mut outcome.trace, Origin::Predicted)?;
        Ok(outcome)
    }

    /// Drives the model with every run, in parallel.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn replay_all(&self, values: &[f64]) -> Result<Vec<Outcome>, StudyError> {
        self.runs.par_iter().map(|run| self.replay(run, values)).collect()
    }

    /// Fits the free parameters to the runs that are not held out.
    ///
    /// Each channel is weighted by the scatter of its residual, which is found along the way.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn calibrate(&self) -> Result<Fit, StudyError> {
        /// Rounds in which weights and parameters settle.
        const ROUNDS: usize = 3;
        if self.parameters.is_empty() {
            return Err(StudyError::NothingFree { path: self.scenario.document().path().to_owned() });
        }
        let runs: Vec<&Measured> = self.runs.iter().filter(|run| !run.held_out).collect();
        if runs.is_empty() {
            return Err(StudyError::AllHeldOut);
        }
        let mut weights = self.weights(&runs, &self.priors())?;
        let mut found = fit(&self.parameters, |values| self.residuals(&runs, values, &weights))?;
        for _ in 1..ROUNDS {
            weights = self.weights(&runs, &found.values())?;
            found = fit(&self.parameters, |values| self.residuals(&runs, values, &weights))?;
        }
        Ok(found)
    }

    /// Signal by signal and run by run: 1 / (scatter · √(samples per independent sample)).
    ///
    /// A run that fits worse than the middle one counts by its own scatter, so that a few logs with a fault (channels
    /// that are out of step, a sensor that fails) do not decide for all.
    fn weights(&self, runs: &[&Measured], values: &[f64]) -> Result<Weights, StudyError> {
        let outcomes: Vec<Outcome> =
            runs.par_iter().map(|run| self.replay(run, values)).collect::<Result<_, _>>()?;
        let mut names: Vec<&String> = runs.iter().flat_map(|run| &run.signals).collect();
        names.sort_unstable();
        names.dedup();
        let mut weights = Vec::new();
        for name in names {
            let scatter: Vec<f64> =
                runs.iter().zip(&outcomes).map(|(run, outcome)| rms(run, &outcome.trace, name)).collect();
            let known: Vec<f64> = scatter.iter().copied().filter(|rms| rms.is_finite()).collect();
            let middle = median(&known);
            let trust: Vec<f64> =
                scatter.iter().map(|rms| if *rms > middle { middle / rms } else { 1.0 }).collect();
            let (mut sum, mut product, mut count) = (0.0, 0.0, 0usize);
            for ((run, outcome), trust) in runs.iter().zip(&outcomes).zip(&trust) {
                let residual = difference(run, &outcome.trace, name);
                let square = trust * trust;
                sum += square * residual.iter().map(|value| value * value).sum::<f64>();
                product += square * residual.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>();
                count += residual.iter().filter(|value| **value != 0.0).count();
            }
            let pooled = if count == 0 || sum == 0.0 {
                1.0
            } else {
                // An autoregressive residual of correlation r is worth (1 − r)/(1 + r) of its samples.
                let correlation = (product / sum).clamp(0.0, 0.9999);
                let share = (1.0 - correlation) / (1.0 + correlation);
                (share / (sum / count as f64)).sqrt()
            };
            weights.push((name.clone(), trust.iter().map(|trust| trust * pooled).collect()));
        }
        Ok(weights)
    }

    fn residuals(
        &self,
        runs: &[&Measured],
        values: &[f64],
        weights: &Weights,
    ) -> Result<Residuals, StudyError> {
        let of_run = |(index, run): (usize, &&Measured)| -> Result<Residuals, StudyError> {
            let outcome = self.replay(run, values)?;
            let mut clusters: Residuals = Vec::new();
            for (name, weights) in weights.iter().filter(|(name, _)| run.signals.contains(name)) {
                let weight = weights[index];
                let residual: Vec<f64> =
                    difference(run, &outcome.trace, name).iter().map(|value| value * weight).collect();
                let blocks = blocks(run, runs.len());
                for (index, block) in residual.chunks(residual.len().div_ceil(blocks).max(1)).enumerate() {
                    if clusters.len() <= index {
                        clusters.push(Vec::new());
                    }
                    clusters[index].extend_from_slice(block);
                }
            }
            Ok(clusters)
        };
        let all: Vec<Residuals> = runs.par_iter().enumerate().map(of_run).collect::<Result<_, _>>()?;
        Ok(all.into_iter().flatten().collect())
    }
}

/// Signal, and the weight of a residual in each run.
type Weights = Vec<(String, Vec<f64>)>;

/// In how many blocks a run is cut, so that there are enough of them to see their scatter.
fn blocks(run: &Measured, runs: usize) -> usize {
    /// So many clusters give an interval worth its name.
    const WANTED: usize = 10;
    /// A shorter block would depend on its neighbours [s].
    const SHORTEST_S: f64 = 20.0;
    if runs >= WANTED {
        return 1;
    }
    let possible = (run.trace.duration_s() / SHORTEST_S).max(1.0);
    // The number is small and positive.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 1 and some thousands"
    )]
    let possible = possible as usize;
    WANTED.div_ceil(runs).min(possible)
}

/// Modelled minus measured; 0 where one of them is missing or not compared.
fn difference(run: &Measured, modelled: &Trace, name: &str) -> Vec<f64> {
    let (Some(measured), Some(modelled)) = (run.trace.get(name), modelled.get(name)) else {
        return vec![0.0; run.trace.len()];
    };
    let one = |((measured, modelled), compared): ((&f64, &f64), &bool)| {
        let difference = modelled - measured;
        if *compared && difference.is_finite() { difference } else { 0.0 }
    };
    measured.iter().zip(modelled).zip(&run.compared).map(one).collect()
}

/// Refuses a run that no model can be driven along.
fn refuse(run: &RecordedRun) -> Result<(), StudyError> {
    let (trace, id) = (&run.trace, run.id.clone());
    let jump = trace.time_s().windows(2).find(|pair| pair[1] - pair[0] > LONGEST_JUMP_S);
    if let Some([before_s, after_s]) = jump {
        return Err(StudyError::Jump {
            run: id,
            before_s: *before_s,
            after_s: *after_s,
            most_s: LONGEST_JUMP_S,
        });
    }
    let speed = trace.get("speed_m_s");
    let known = speed.map_or(0, |speed| speed.iter().filter(|value| value.is_finite()).count());
    if known < 2 {
        let measured = trace.channels().iter().map(|channel| channel.name.clone()).collect();
        return Err(StudyError::NoSpeed { run: id, there: speed.is_some(), measured });
    }
    Ok(())
}

fn measured(
    scenario: &Scenario,
    model: &Model,
    run: &RecordedRun,
    length_m: f64,
    (notes, gaps): (&mut Vec<String>, &mut Vec<Sparse>),
) -> Result<Measured, StudyError> {
    refuse(run)?;
    let settings = &scenario.replay;
    let around = filled(&run.trace, |name| sparse::AROUND.contains(&name))?;
    let drive = settings.drive.unwrap_or_else(|| drive_of(&around.trace, model));
    // What is compared stays as it came.
    let asked = settings.inputs.iter().flat_map(|asked| &asked.listed).flat_map(|input| input.channels());
    let driving: Vec<&str> = driving(drive).iter().chain(asked).copied().collect();
    let driven = filled(&around.trace, |name| driving.contains(&name))?;
    gaps.extend(around.sparse.into_iter().chain(driven.sparse));
    let mut trace = driven.trace;
    derive(&mut trace, Origin::Measured)?;
    if drive == Drive::Coast && trace.get(COASTING).is_none() {
        let why =
            if settings.drive.is_some() { "the scenario says so" } else { "its driveline never drives" };
        notes.push(format!("taken to coast throughout, which no channel says: {why}"));
        trace.push(COASTING, vec![1.0; trace.len()], Origin::Driven)?;
    }
    let also = match &settings.inputs {
        None => inputs_of(&trace, drive),
        Some(asked) if asked.all => {
            let mut also = inputs_of(&trace, drive);
            also.extend(asked.listed.iter().filter(|input| !Inputs::ALL.contains(input)));
            also
        }
        Some(asked) => asked.listed.clone(),
    };
    let period_s = trace.period_s();
    let smoothing_s = settings.smoothing_s.unwrap_or_else(|| smoothed_s(period_s));
    let forward = drive != Drive::Speed && drive != Drive::Coast;
    let window_s = settings.window_s.or((forward && trace.duration_s() > LONG_S).then_some(WINDOW_S));
    let mut known = Vec::new();
    for one in &run.known {
        match scenario.document().resolve(&one.name) {
            Ok(path) => known.push((path, one.value)),
            Err(_) => {
                notes.push(format!(
                    "the recording knows `{}`, which names no one parameter of the scenario",
                    one.name
                ));
            }
        }
    }
    let wanted = signals(drive);
    let signals: Vec<String> = wanted
        .iter()
        .filter(|name| trace.get(name).is_some_and(|values| values.iter().any(|value| value.is_finite())))
        .map(|name| (*name).to_owned())
        .collect();
    let signals = predicted(signals, model, &trace);
    // Positions that fall are those of the path itself; those that grow begin at its end.
    let reversed_from_m =
        run.reversed.then(|| trace.get("position_m").and_then(chainage_from_m).unwrap_or(length_m));
    notes.extend(beyond_the_terrain(model.terrain.extent_m(), &trace, reversed_from_m));
    notes.extend(begun_at_the_end(model.terrain.extent_m(), &trace, reversed_from_m));
    let how = Replay {
        drive,
        also,
        window_s,
        smoothing_s,
        step_s: settings.step_s,
        reversed_from_m,
        passes_before: 0,
        follows_brakes: !model.effects.iter().any(|effect| effect.name.starts_with("braking")),
    };
    let compared = compared(&trace, smoothing_s, settings.least_acceleration_m_s2);
    let (id, unknown) = (run.id.clone(), around.unknown);
    let mut measured = Measured { id, trace, how, signals, held_out: run.held_out, known, compared, unknown };
    let followed = measured.how.followed(&measured.trace);
    measured.compared.iter_mut().zip(followed).for_each(|(compared, followed)| *compared &= !followed);
    measured.compared.iter_mut().zip(&measured.unknown).for_each(|(compared, unknown)| *compared &= !unknown);
    Ok(measured)
}

/// Channels of what drives a model so.
fn driving(drive: Drive) -> &'static [&'static str] {
    match drive {
        Drive::Speed | Drive::Coast => &[],
        Drive::Force => &["tractive_force_n"],
        Drive::Torque => &["motor_torque_n_m", "engine_torque_n_m"],
    }
}

/// Where a run is on its path, sample by sample [m]: as it was recorded, or as far as these speeds [m/s] bring it. Places that grow along
/// a run from the end of its path, here [m], are an odometer's; those that fall are the path's own.
pub fn places_m(trace: &Trace, speeds_m_s: &[f64], reversed_from_m: Option<f64>) -> Vec<f64> {
    let back = |far: &[f64], from_m: f64| far.iter().map(|far| from_m - far).collect();
    match (trace.get("position_m"), reversed_from_m) {
        (Some(position), Some(from_m)) if chainage_from_m(position).is_none() => back(position, from_m),
        (Some(position), _) => position.to_vec(),
        (None, Some(from_m)) => back(&travelled(trace.time_s(), speeds_m_s), from_m),
        (None, None) => travelled(trace.time_s(), speeds_m_s),
    }
}

/// A place is not known better than this [m].
const ABOUT_M: f64 = 5.0;

/// What there is to say of a run that goes further than its terrain is known, of which the slope at the end goes on.
fn beyond_the_terrain(
    extent_m: Option<(f64, f64)>,
    trace: &Trace,
    reversed_from_m: Option<f64>,
) -> Option<String> {
    let (begin_m, end_m) = extent_m?;
    let places_m = places_m(trace, trace.get("speed_m_s")?, reversed_from_m);
    let places = || places_m.iter().copied().filter(|place| place.is_finite());
    let (least_m, most_m) =
        (places().fold(f64::INFINITY, f64::min), places().fold(f64::NEG_INFINITY, f64::max));
    (least_m < begin_m - ABOUT_M || most_m > end_m + ABOUT_M).then(|| {
        format!(
            "driven from {least_m:.0} to {most_m:.0} m of a terrain that is known from {begin_m:.0} to {end_m:.0} m: \
             beyond its ends it is taken to go on as it does there"
        )
    })
}

/// Where a run against its path is taken to begin, which an odometer does not know and a surveyed terrain hangs on.
fn begun_at_the_end(
    extent_m: Option<(f64, f64)>,
    trace: &Trace,
    reversed_from_m: Option<f64>,
) -> Option<String> {
    let (_, end_m) = extent_m?;
    let odometer = trace.get("position_m").is_none_or(|position| chainage_from_m(position).is_none());
    reversed_from_m.filter(|from_m| odometer && (from_m - end_m).abs() > ABOUT_M).map(|from_m| {
        format!(
            "no place on the path is known of runs against it: they are taken to begin at {from_m:.0} m, as far as the farthest \
             run came, of a terrain that is known up to {end_m:.0} m"
        )
    })
}

/// How far the farthest run of a path came [m].
fn path_length_m(recording: &Recording, path: Option<&str>) -> f64 {
    let of_run = |run: &RecordedRun| match (run.trace.get("position_m"), run.trace.get("speed_m_s")) {
        (Some(position), _) => position.iter().copied().filter(|value| value.is_finite()).fold(0.0, f64::max),
        (None, Some(speed)) => travelled(run.trace.time_s(), speed).last().copied().unwrap_or(0.0),
        _ => 0.0,
    };
    recording.runs.iter().filter(|run| run.path.as_deref() == path).map(of_run).fold(0.0, f64::max)
}

/// What can drive the model best: rolling free, a recorded force, a recorded torque, and else the speed. A driveline that
/// never drives coasts where nothing was recorded that could have driven. Where nothing was that the speed could foretell either,
/// the parts that roll free are left.
fn drive_of(trace: &Trace, model: &Model) -> Drive {
    let coasts = |values: &[f64]| values.iter().all(|value| *value >= 0.5);
    let known = |name: &&str| trace.get(name).is_some();
    if trace.get(COASTING).map_or(!model.driveline.drives() && !DRIVING.iter().any(known), coasts) {
        Drive::Coast
    } else if trace.get("tractive_force_n").is_some() {
        Drive::Force
    } else if trace.get("motor_torque_n_m").or_else(|| trace.get("engine_torque_n_m")).is_some()
        && model.driveline.force_of_torque_n(1.0, 1.0).is_some()
    {
        Drive::Torque
    } else if Inputs::Coasting.whole(trace)
        && is_coasting(trace).contains(&true)
        && !signals(Drive::Speed).iter().any(known)
    {
        Drive::Coast
    } else {
        Drive::Speed
    }
}

/// Sample by sample, whether a recording says that the vehicle rolls free.
fn is_coasting(trace: &Trace) -> Vec<bool> {
    trace.get(COASTING).map_or_else(Vec::new, |values| values.iter().map(|value| *value >= 0.5).collect())
}

/// Every circumstance that was recorded throughout; neutral only where it is not all that drives.
fn inputs_of(trace: &Trace, drive: Drive) -> Vec<Inputs> {
    let throughout = drive == Drive::Coast && !is_coasting(trace).contains(&false);
    Inputs::ALL
        .into_iter()
        .filter(|input| !(throughout && *input == Inputs::Coasting))
        .filter(|input| input.whole(trace))
        .collect()
}

/// The name of a drive, as scenarios write it.
pub fn drive_name(drive: Drive) -> &'static str {
    match drive {
        Drive::Speed => "Speed",
        Drive::Torque => "Torque",
        Drive::Force => "Force",
        Drive::Coast => "Coast",
    }
}

fn signals(drive: Drive) -> &'static [&'static str] {
    match drive {
        Drive::Speed => &[
            "tractive_force_n",
            "motor_torque_n_m",
            "engine_torque_n_m",
            "fuel_rate_kg_s",
            "battery_power_w",
        ],
        Drive::Torque | Drive::Force | Drive::Coast => &["speed_m_s", "fuel_rate_kg_s", "battery_power_w"],
    }
}

/// Half width of the local fit of a recorded speed [s] by the time between its samples, where the scenario does not say.
fn smoothed_s(period_s: f64) -> f64 {
    (SMOOTHING_SAMPLES * period_s).min(LONGEST_SMOOTHING_S).max(LEAST_SMOOTHING_SAMPLES * period_s)
}

/// Those that the model's driveline shows at all.
fn predicted(signals: Vec<String>, model: &Model, trace: &Trace) -> Vec<String> {
    let how = Replay {
        drive: Drive::Speed,
        also: Vec::new(),
        window_s: None,
        smoothing_s: 1.0,
        step_s: 1.0,
        reversed_from_m: None,
        passes_before: 0,
        follows_brakes: false,
    };
    let times = trace.time_s();
    let Some(first) = times.first() else { return Vec::new() };
    let probe = trace.slice(*first, times.get(9).copied().unwrap_or(*first));
    let Ok(mut outcome) = replay(model, &probe, &how) else { return signals };
    if derive(&mut outcome.trace, Origin::Predicted).is_err() {
        return signals;
    }
    let shown = |name: &String| {
        outcome.trace.get(name).is_some_and(|values| values.iter().any(|value| !value.is_nan()))
    };
    signals.into_iter().filter(shown).collect()
}

/// Samples in which the vehicle does not slow down harder than `least`.
fn compared(trace: &Trace, smoothing_s: f64, least_m_s2: Option<f64>) -> Vec<bool> {
    let Some(least) = least_m_s2 else { return vec![true; trace.len()] };
    match trace.get("speed_m_s") {
        Some(speed) => {
            let motion = headland_sim::local_fit(trace.time_s(), speed, smoothing_s);
            motion.slope.iter().map(|slope| *slope >= least).collect()
        }
        None => vec![true; trace.len()],
    }
}

/// Adds what follows from other channels.
fn derive(trace: &mut Trace, origin: Origin) -> Result<(), TraceError> {
    if trace.get("battery_power_w").is_none()
        && let (Some(voltage), Some(current)) =
            (trace.get("battery_voltage_v"), trace.get("battery_current_a"))
    {
        let power = voltage.iter().zip(current).map(|(voltage, current)| voltage * current).collect();
        trace.push("battery_power_w", power, origin)?;
    }
    Ok(())
}

/// Root mean square of what is compared, by signal: modelled minus measured.
pub fn rms(run: &Measured, modelled: &Trace, name: &str) -> f64 {
    let squares: Vec<f64> = difference(run, modelled, name)
        .iter()
        .filter(|value| **value != 0.0)
        .map(|value| value * value)
        .collect();
    if squares.is_empty() { f64::NAN } else { mean(&squares).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::{begun_at_the_end, beyond_the_terrain, smoothed_s};
    use headland_trace::{Origin, Trace};

    /// 60 m at 10 m/s on a profile of 50 m, and back from its end by an odometer and by a chainage.
    #[test]
    fn a_run_that_leaves_its_terrain_is_told() {
        let trace = |places: fn(f64) -> f64| {
            let mut trace = Trace::new((0..7).map(f64::from).collect()).unwrap();
            trace.push("speed_m_s", vec![10.0; 7], Origin::Measured).unwrap();
            let places = (0..7).map(|second| places(10.0 * f64::from(second))).collect();
            trace.push("position_m", places, Origin::Measured).unwrap();
            trace
        };
        let told = |trace: &Trace, from_m| beyond_the_terrain(Some((0.0, 50.0)), trace, from_m);
        let grows = trace(|far| far);
        assert!(told(&grows, None).unwrap().contains("from 0 to 60 m"));
        assert!(told(&grows, Some(50.0)).unwrap().contains("from -10 to 50 m"));
        assert!(told(&trace(|far| 50.0 - 0.8 * far), Some(50.0)).is_none());
        assert!(beyond_the_terrain(None, &grows, None).is_none());
        let begun = |trace: &Trace, from_m| begun_at_the_end(Some((0.0, 50.0)), trace, from_m);
        assert!(begun(&grows, Some(40.0)).unwrap().contains("begin at 40 m"));
        assert!(begun(&grows, Some(50.0)).is_none(), "that is where the terrain ends");
        assert!(begun(&grows, None).is_none(), "it goes along the path");
        assert!(begun(&trace(|far| 40.0 - far), Some(40.0)).is_none(), "it says where it is");
        let mut unplaced = grows;
        unplaced.remove("position_m");
        assert!(told(&unplaced, None).unwrap().contains("to 60 m"));
    }

    #[test]
    fn a_coarse_log_is_smoothed_over_as_few_samples_as_make_a_parabola() {
        let told = [(0.02, 0.1), (0.1, 0.5), (0.5, 1.5), (1.0, 2.0), (2.0, 4.0)];
        for (period_s, half_s) in told {
            assert!(
                (smoothed_s(period_s) - half_s).abs() < 1e-12,
                "{period_s} s: {} s",
                smoothed_s(period_s)
            );
        }
    }
}
