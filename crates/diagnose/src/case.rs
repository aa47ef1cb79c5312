//! What is diagnosed: a scenario, a recording, and everything that is prepared once.

use crate::DiagnoseError;
use crate::balances::balance::{Kind, Rows, System, bearing, block_s, kinds};
use crate::causes::catalogue::{ARTEFACTS, Around, Cause, causes};
use crate::causes::cycles::{Cycles, cycles};
use crate::causes::own::own;
use crate::causes::remembered::Remembered;
use crate::causes::sensors::corrected;
use crate::choosing::search::Accepted;
use crate::proof::mirror;
use crate::runs::placed;
use crate::runs::recorded::{Recorded, recorded};
use crate::runs::said::{Said, said};
use crate::runs::split::{split, traits};
use crate::runs::standin::{Prepared, prepared};
use crate::runs::way::Scale;
use crate::so_far::SoFar;
use crate::soundness::unmoved::{UNMOVED, UNTOLD, is_mass, moved};
use headland_calibrate::curved::is_straight;
use headland_calibrate::statistics::{median, quantile_of_sorted, sorted};
use headland_calibrate::study::Study;
use headland_plugin::{Contact, Registry, closest};
use headland_recording::{Recording, Sensor};
use headland_scenario::Scenario;
use headland_sim::Inputs;
use std::collections::BTreeSet;
use std::sync::Arc;

/// What the user wants of a diagnosis.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Causes that are left out of the library.
    pub without: Vec<String>,
    /// Causes that alone are tried; all where empty.
    pub only: Vec<String>,
    /// Seed of all draws.
    pub seed: u64,
}

/// Hears how far a diagnosis is.
pub trait Progress: Sync {
    /// A step begins.
    fn step(&self, what: &str);
    /// Whether the user wants it to end.
    fn interrupted(&self) -> bool;
}

/// Nobody listens, and nobody interrupts.
#[derive(Clone, Copy, Debug)]
pub struct Silent;

impl Progress for Silent {
    fn step(&self, _: &str) {}

    fn interrupted(&self) -> bool {
        false
    }
}

/// A fault of a sensor that the runs were corrected for.
#[derive(Clone, Debug)]
pub(crate) struct Correction {
    pub id: &'static str,
    pub value: f64,
    /// How it was accepted.
    pub accepted: Accepted,
}

/// A scenario with a recording, prepared.
pub(crate) struct Case<'a> {
    pub study: Study<'a>,
    pub registry: &'a Registry,
    /// The runs, corrected for what is known of their sensors.
    pub runs: Vec<Recorded>,
    /// The runs as they were recorded.
    pub raw: Vec<Recorded>,
    /// Faults of sensors that the runs were corrected for, and by how much.
    pub corrections: Vec<Correction>,
    /// Faults that turned out to be none.
    pub no_faults: Vec<&'static str>,
    /// What the way says of the scale of the speed, which the runs are corrected for where it is wrong.
    pub scale: Option<Scale>,
    /// How late the speed of coast-downs was before the runs were corrected for it [s], where it was.
    pub late_s: Option<f64>,
    /// Channels of powers that are late, and by how much [s].
    pub late_powers: Vec<(&'static str, f64)>,
    /// The causes that are tried, where it is not all of them.
    pub only: Option<BTreeSet<usize>>,
    /// Times of the rows of their logs [s], which may be more than the runs have.
    pub logged_s: Vec<Vec<f64>>,
    /// What is known of the sensors: channel and sensor.
    pub sensors: Vec<(String, Sensor)>,
    /// Names of the paths, by the number that the runs have of them; none where a run drove alone.
    pub paths: Vec<Option<String>>,
    /// What the nominal model says.
    pub nominal: Vec<Said>,
    /// How many rows the runs are brought to.
    pub rows: Rows,
    /// What was found so far, where anything was.
    pub so_far: Option<SoFar>,
    /// What effects do beside it.
    pub remembered: Remembered,
    /// Samples at which no channel shows a fault by itself; empty before they were looked for.
    pub sound: Vec<Vec<bool>>,
    /// Whether each run may be fitted.
    pub fit: Vec<bool>,
    /// How they are driven by the clock.
    pub cycles: Cycles,
    /// Whether any balance can use a run. Effects are reconstructed along the others, and nothing is learned from them.
    pub bears: Vec<bool>,
    /// Whether the speed was held, so that no mass is told.
    pub unmoved: bool,
    /// Whether the runs that are held out were chosen here.
    pub chosen: bool,
    pub causes: Vec<Cause>,
    pub kinds: Vec<Kind>,
    pub progress: &'a dyn Progress,
    pub options: &'a Options,
}

impl<'a> Case<'a> {
    pub fn new(
        scenario: &'a Scenario,
        recording: &Recording,
        registry: &'a Registry,
        options: &'a Options,
        progress: &'a dyn Progress,
    ) -> Result<Self, DiagnoseError> {
        progress.step("reading");
        let model = scenario.model(registry)?;
        let prepared = prepared(recording, wanted(options, SPEED_SCALE), is_straight(&model))?;
        let recording = &prepared.recording;
        let mut study = Study::of_any(scenario, recording, registry)?;
        // Brakes are looked for: what they did has to show.
        study.runs.iter_mut().for_each(|run| run.how.follows_brakes = false);
        // Nobody could list what was not recorded.
        for run in study.runs.iter_mut().filter(|run| prepared.curved && Inputs::Curvature.whole(&run.trace))
        {
            if !run.how.also.contains(&Inputs::Curvature) {
                run.how.also.push(Inputs::Curvature);
            }
        }
        let mut runs = recorded(&study, &prepared, &model);
        placed::by_the_clock_of_speed(&mut runs)?;
        study.notes.extend(prepared.notes.iter().cloned());
        let marked: Vec<bool> = recording.runs.iter().map(|run| run.held_out).collect();
        if marked.iter().all(|held| *held) {
            return Err(headland_calibrate::study::StudyError::AllHeldOut.into());
        }
        let mut paths = vec![None; runs.len()];
        for (run, described) in runs.iter().zip(&recording.runs) {
            paths[run.path].clone_from(&described.path);
        }
        let mut case = Self {
            study,
            registry,
            raw: runs.clone(),
            runs,
            corrections: Vec::new(),
            no_faults: right(&prepared).into_iter().collect(),
            scale: prepared.scale,
            late_s: None,
            late_powers: Vec::new(),
            logged_s: prepared.logged_s.clone(),
            sensors: recording.runs.iter().flat_map(|run| run.sensors.clone()).collect(),
            only: None,
            paths,
            nominal: Vec::new(),
            rows: Rows::Few,
            so_far: None,
            remembered: Remembered::default(),
            sound: Vec::new(),
            fit: Vec::new(),
            cycles: Cycles::Apart,
            bears: Vec::new(),
            unmoved: false,
            chosen: false,
            causes: Vec::new(),
            kinds: Kind::ORDER.to_vec(),
            progress,
            options,
        };
        case.suppose()?;
        case.kinds = kinds(&case.runs, &case.nominal);
        case.bears = bearing(&case.kinds, &case.runs, &case.nominal);
        (case.fit, case.chosen) = split(&marked, &case.bears, &traits(&case.runs));
        case.cycles = cycles(&case.runs, &case.fit);
        if !case.kinds.is_empty() {
            case.study.notes.extend(idle(&case));
        }
        let moved = moved(&case.runs, &case.fit);
        if let Some(moved) = moved {
            for one in case.study.parameters.iter_mut().filter(|one| is_mass(&one.name)) {
                one.sd = one.sd.map(|sd| UNMOVED * sd);
            }
            case.unmoved = true;
            case.study.notes.push(format!(
                "The speed was held: what the force changes makes {:.0} % of the acceleration that it would make of the \
                 scenario's mass. Such runs tell no mass, and it stays as the scenario has it.",
                100.0 * moved.max(0.0)
            ));
        }
        let mut all = causes(&case.around(&model));
        all.retain(|cause| moved.is_none() || !UNTOLD.contains(&cause.id));
        // One run alone cannot tell a speed that is measured too long from a vehicle that is heavier than the scenario's.
        let alone = case.fit.iter().filter(|fit| **fit).count() == 1;
        let heavier = case.study.parameters.iter().any(|one| is_mass(&one.name));
        all.retain(|cause| !(alone && heavier && cause.id == SPEED_SCALE));
        bound(&mut all, registry);
        all.extend(own(&case)?);
        check_names(&all, registry, options)?;
        all.retain(|cause| case.wanted(cause.id));
        case.causes = all;
        Ok(case)
    }

    /// Takes faults of sensors out of the recordings.
    pub fn correct(&mut self, corrections: Vec<Correction>) -> Result<(), DiagnoseError> {
        self.runs = self.raw.clone();
        for correction in &corrections {
            self.runs = corrected(&self.runs, correction.id, correction.value)?;
        }
        self.corrections = corrections;
        self.suppose()
    }

    /// What the nominal model says of the runs, and how it would have accelerated.
    pub fn suppose(&mut self) -> Result<(), DiagnoseError> {
        self.remembered.forget();
        self.nominal = self.said(self.study.scenario(), &self.study.priors())?;
        for (run, said) in self.runs.iter_mut().zip(&self.nominal) {
            run.acceleration_m_s2 = run.accelerated_m_s2(&said.resistance_n, &said.effective_mass_kg);
        }
        self.build_again()
    }

    /// A step begins; an error where the user wants an end.
    pub fn step(&self, what: &str) -> Result<(), DiagnoseError> {
        self.progress.step(what);
        if self.progress.interrupted() { Err(DiagnoseError::Interrupted) } else { Ok(()) }
    }

    /// What a scenario's model says of every run.
    pub fn said(&self, scenario: &Scenario, values: &[f64]) -> Result<Vec<Said>, DiagnoseError> {
        self.said_of(&self.runs, scenario, values)
    }

    /// As [`Case::said`], of other recordings of the same runs.
    pub fn said_of(
        &self,
        runs: &[Recorded],
        scenario: &Scenario,
        values: &[f64],
    ) -> Result<Vec<Said>, DiagnoseError> {
        said(runs, &self.kinds, |run| Ok(self.study.model_of(scenario, &runs[run].measured, values)?))
    }

    /// What a scenario's model says of every run beside what was found so far.
    pub fn said_so_far_with(&self, scenario: &Scenario, values: &[f64]) -> Result<Vec<Said>, DiagnoseError> {
        said(&self.runs, &self.kinds, |run| self.model_so_far(scenario, run, values))
    }

    /// As [`Case::said`], with one more effect, which may be another in each run, and what the balances `kinds` need.
    pub fn said_with(
        &self,
        text: &(impl Fn(&Recorded) -> String + Sync),
        values: &[f64],
        kinds: &[Kind],
    ) -> Result<Vec<Said>, DiagnoseError> {
        let scenarios = self.variants(text)?;
        said(&self.runs, kinds, |run| {
            Ok(self.study.model_of(&scenarios[run], &self.runs[run].measured, values)?)
        })
    }

    /// The same beside what was found so far.
    pub fn said_beside(
        &self,
        text: &(impl Fn(&Recorded) -> String + Sync),
        values: &[f64],
        kinds: &[Kind],
    ) -> Result<Vec<Said>, DiagnoseError> {
        let scenarios = self.variants(text)?;
        said(&self.runs, kinds, |run| self.model_so_far(&scenarios[run], run, values))
    }

    /// The scenario of every run with one more effect.
    fn variants(&self, text: &impl Fn(&Recorded) -> String) -> Result<Vec<Arc<Scenario>>, DiagnoseError> {
        let mut known: Vec<(String, Arc<Scenario>)> = Vec::new();
        let one = |run: &Recorded| {
            let text = text(run);
            if let Some((_, scenario)) = known.iter().find(|(own, _)| *own == text) {
                return Ok(Arc::clone(scenario));
            }
            let scenario = Arc::new(self.study.scenario().with_effect(&text, self.registry)?);
            known.push((text, Arc::clone(&scenario)));
            Ok(scenario)
        };
        self.runs.iter().map(one).collect()
    }

    /// Identifiers of causes.
    pub fn ids(&self, causes: &[usize]) -> Vec<&'static str> {
        causes.iter().map(|cause| self.causes[*cause].id).collect()
    }

    /// The rows of every balance, of samples that are `usable`.
    pub fn system(&self, usable: &[Vec<bool>]) -> System {
        let block_s = |kind| block_s(kind, &self.runs, self.rows);
        let mut system = System::new(&self.kinds, &self.runs, &self.nominal, &block_s, usable, &self.fit);
        if self.so_far.is_some() {
            let of = |kind| {
                self.together_so_far(kind).cloned().unwrap_or_else(|| vec![Vec::new(); self.runs.len()])
            };
            let together = system.column(of);
            for (left, own) in system.residual.iter_mut().zip(&together) {
                *left += own;
            }
        }
        system
    }

    /// Names of the channels of all runs.
    pub fn channels(&self) -> Vec<String> {
        let all = self.runs.iter().flat_map(|run| run.measured.trace.channels());
        let mut names: Vec<String> = all.map(|channel| channel.name.clone()).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Whether the runs can tell a free parameter.
    pub fn tells(&self, parameter: &str) -> bool {
        !(self.unmoved && is_mass(parameter))
    }

    /// Whether the user lets a cause be claimed.
    pub fn wanted(&self, id: &str) -> bool {
        wanted(self.options, id)
    }

    /// Whether a function with one value throughout would be another cause, which nobody wants.
    pub fn is_left_out_as(&self, function: &Cause) -> bool {
        let other = function.even().map(|(id, _)| id).filter(|id| *id != function.id);
        other.is_some_and(|other| self.options.without.iter().any(|id| id == other))
    }

    /// The scale of the speed that was taken out of the recordings because the way says that it is wrong.
    pub fn faulty_scale(&self) -> Option<Scale> {
        self.scale.filter(|scale| self.wanted(SPEED_SCALE) && scale.is_wrong())
    }

    fn around(&self, model: &headland_sim::Model) -> Around {
        let moving = |run: &'_ Recorded| -> Vec<f64> {
            let speeds = run.motion.value.iter().step_by(7).map(|speed| speed.abs());
            speeds.filter(|speed| *speed > crate::runs::recorded::SLOWEST_M_S).collect()
        };
        let speeds = sorted(&self.runs.iter().flat_map(moving).collect::<Vec<f64>>());
        let quantile = |share: f64| if speeds.is_empty() { 1.0 } else { quantile_of_sorted(&speeds, share) };
        let none = !self.bears.contains(&true);
        let bearing =
            || self.runs.iter().zip(&self.bears).filter(|(_, bears)| none || **bears).map(|(run, _)| run);
        let names = bearing().next().map(|run| run.measured.trace.channels()).unwrap_or_default();
        let everywhere = |name: &str| bearing().all(|run| run.measured.trace.get(name).is_some());
        let mut passes = vec![0; self.runs.len()];
        for run in &self.runs {
            passes[run.path] += 1;
        }
        let temperatures = self.runs.iter().filter_map(|run| run.measured.trace.get("air_temperature_c"));
        let (coldest, warmest) = range(temperatures.flatten().copied());
        let told = self.runs.iter().all(|run| Inputs::OilTemperature.whole(&run.measured.trace));
        let oils =
            self.runs.iter().filter(|_| told).filter_map(|run| run.measured.trace.get("oil_temperature_c"));
        let (cool, hottest) = range(oils.flatten().copied());
        let weight_n = model.vehicle.mass_kg * model.gravity_m_s2;
        let resistances: Vec<f64> = self
            .nominal
            .iter()
            .flat_map(|said| said.resistance_n.iter().step_by(7))
            .filter(|force| force.is_finite())
            .map(|force| force / weight_n)
            .collect();
        Around {
            mass_kg: model.vehicle.mass_kg,
            gravity_m_s2: model.gravity_m_s2,
            drag_area_m2: model.vehicle.resistance.drag_area_m2(),
            rotating_mass_kg: model.vehicle.rotating_mass_kg,
            masses_kg: range(self.nominal.iter().filter_map(Said::first_mass_kg)),
            coefficient: if resistances.is_empty() { 0.0 } else { median(&resistances).max(0.0) },
            soil_coefficient: walking(model),
            speeds_m_s: [0.2, 0.35, 0.5, 0.65, 0.8].map(quantile),
            range_m_s: (quantile(0.05), quantile(0.98)),
            fastest_m_s: quantile(1.0),
            one_ratio: model.driveline.force_of_torque_n(1.0, 1.0).is_some(),
            duration_s: self.longest_s(),
            reach_m: self.runs.iter().flat_map(|run| &run.position_m).copied().fold(0.0, f64::max),
            channels: names
                .iter()
                .map(|channel| channel.name.clone())
                .filter(|name| everywhere(name))
                .collect(),
            drives: self.driven() || !self.runs.iter().all(Recorded::force_is_known),
            passes: passes.into_iter().max().unwrap_or(1),
            temperatures_k: (warmest - coldest).max(0.0),
            oil_k: (hottest - cool).max(0.0),
            beginnings: beginnings(&self.fit, &self.bears),
            lanes_rad: mirror::lanes_rad(self),
            pulls: bearing().any(|run| run.force_n.is_some() || run.pull_n.is_some()),
        }
    }

    /// The greatest speed of all runs [m/s]; none where none is known.
    pub fn fastest_m_s(&self) -> Option<f64> {
        let speeds = self.runs.iter().flat_map(|run| &run.motion.value);
        speeds.map(|speed| speed.abs()).filter(|speed| speed.is_finite()).max_by(f64::total_cmp)
    }

    /// Length of the longest run [s].
    pub fn longest_s(&self) -> f64 {
        self.runs.iter().map(|run| run.measured.trace.duration_s()).fold(0.0, f64::max)
    }

    /// Whether fitted runs drive a path both ways.
    pub fn drives_a_path_both_ways(&self) -> bool {
        let fitted = self.runs.iter().zip(&self.fit).filter(|(_, fit)| **fit);
        let ways: Vec<(usize, bool)> =
            fitted.map(|(run, _)| (run.path, run.measured.how.reversed_from_m.is_some())).collect();
        ways.iter().any(|(path, way)| ways.contains(&(*path, !way)))
    }

    /// Whether force or torque drives somewhere.
    pub fn driven(&self) -> bool {
        self.runs.iter().any(is_driven)
    }

    /// Whether it drives in a run that is fitted.
    pub fn fitted_is_driven(&self) -> bool {
        self.runs.iter().zip(&self.fit).any(|(run, fit)| *fit && is_driven(run))
    }
}

/// Whether force or torque drives a run somewhere.
fn is_driven(run: &Recorded) -> bool {
    let coasting = run.measured.trace.get("coasting");
    run.force_n.iter().flatten().enumerate().any(|(index, force)| {
        let free = coasting.is_some_and(|coasting| coasting[index] >= 0.5);
        !free && force.is_finite() && *force != 0.0
    })
}

/// The cause of which the way may know beforehand.
const SPEED_SCALE: &str = "speed_scale";

/// Whether the user lets a cause be claimed.
fn wanted(options: &Options, id: &str) -> bool {
    let Options { without, only, .. } = options;
    !without.iter().any(|one| one == id) && (only.is_empty() || only.iter().any(|one| one == id))
}

/// A fault that the way leaves no room for: a scale of the speed that is right, or was corrected. Beside the speed of wheels
/// `speed_scale` is one of theirs, of which the way says nothing.
fn right(prepared: &Prepared) -> Option<&'static str> {
    let known = prepared.scale.is_some_and(|scale| scale.is_right() || scale.is_wrong());
    let wheels = prepared.recording.runs.iter().any(|run| run.trace.get("wheel_speed_m_s").is_some());
    (known && !wheels).then_some(SPEED_SCALE)
}

/// Resistance of the nominal ground over weight at walking speed.
fn walking(model: &headland_sim::Model) -> f64 {
    let weight_n = model.vehicle.mass_kg * model.gravity_m_s2;
    let resistance_n = match model.vehicle.resistance {
        headland_sim::Resistance::RoadLoad { f0_n, .. } => f0_n,
        headland_sim::Resistance::Drag { .. } => model.soil.as_ref().map_or(0.0, |soil| {
            let contact = Contact { load_n: weight_n, speed_m_s: 1.0, position_m: 0.0 };
            soil.resistance_at_n(&contact, &model.terrain.at(0.0))
        }),
    };
    if resistance_n.is_finite() { resistance_n.max(0.0) / weight_n } else { 0.0 }
}

/// Least and greatest of the finite values; infinite and reversed where there are none.
pub fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|value| value.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

/// A parameter that its effect does not let be negative is not searched below zero.
fn bound(causes: &mut [Cause], registry: &Registry) {
    use headland_plugin::Bound::{Efficiency, NotNegative, Positive, Within};
    for cause in causes {
        let Some(card) = registry.effects.card(cause.id) else { continue };
        for term in &mut cause.terms {
            let parameter = card.parameters.iter().find(|parameter| parameter.name == term.name);
            match parameter.map(|parameter| parameter.bound) {
                Some(NotNegative | Positive | Efficiency) => term.low = term.low.max(0.0),
                Some(Within(low, high)) => (term.low, term.high) = (term.low.max(low), term.high.min(high)),
                _ => {}
            }
        }
    }
}

/// The fitted runs that may have begun otherwise than the others: a few in which it would show, so that not too many are tried.
fn beginnings(fit: &[bool], bears: &[bool]) -> Vec<usize> {
    /// More runs than this are not tried one by one.
    const MOST: usize = 4;
    let fitted: Vec<usize> = (0..fit.len()).filter(|run| fit[*run] && bears[*run]).collect();
    if fitted.len() < 2 { Vec::new() } else { fitted.into_iter().take(MOST).collect() }
}

/// The runs that are not fitted and not held out, and why.
fn idle(case: &Case) -> Option<String> {
    let runs = case.runs.iter().zip(&case.bears).filter(|(_, bears)| !**bears);
    let names: Vec<&str> = runs.map(|(run, _)| run.measured.id.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "In {} nothing was recorded that a balance could use: what was found elsewhere is reconstructed along {}, and \
             nothing is learned from {}.",
            names.join(", "),
            if names.len() == 1 { "it" } else { "them" },
            if names.len() == 1 { "it" } else { "them" },
        )
    })
}

fn check_names(all: &[Cause], registry: &Registry, options: &Options) -> Result<(), DiagnoseError> {
    let mut known: Vec<&'static str> = all.iter().map(|cause| cause.id).collect();
    known.extend(registry.cards(headland_plugin::Kind::Effect).iter().map(|card| card.name));
    known.extend(ARTEFACTS);
    known.push("unlisted");
    known.sort_unstable();
    known.dedup();
    for id in options.without.iter().chain(&options.only) {
        if !known.contains(&id.as_str()) {
            return Err(DiagnoseError::UnknownCause {
                id: id.clone(),
                suggestion: closest(id, &known),
                known,
            });
        }
    }
    Ok(())
}
