//! What is diagnosed: a scenario, a recording, and everything that is prepared once.

use crate::DiagnoseError;
use crate::balance::{Balance, Drive0, Kind, Said, balance, block_s, drives, kinds, locate, said};
use crate::catalogue::{Around, Cause, Form, causes};
use crate::gram::Column;
use crate::profile::Profile;
use headland_calibrate::study::Study;
use headland_plugin::{Registry, closest};
use headland_recording::Recording;
use headland_scenario::Scenario;
use nalgebra::DVector;

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

/// A scenario with a recording, prepared.
pub(crate) struct Case<'a> {
    pub study: Study<'a>,
    pub registry: &'a Registry,
    pub drives: Vec<Drive0>,
    /// What the nominal model says.
    pub nominal: Vec<Said>,
    /// Whether each run may be fitted.
    pub fit: Vec<bool>,
    /// Whether the runs that are held out were chosen here.
    pub chosen: bool,
    pub causes: Vec<Cause>,
    pub kinds: Vec<Kind>,
    pub progress: &'a dyn Progress,
    pub seed: u64,
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
        let study = Study::new(scenario, recording, registry)?;
        let model = scenario.model(registry)?;
        let mut drives = drives(&study, recording, &model);
        locate(&mut drives, scenario);
        let marked: Vec<bool> = recording.runs.iter().map(|run| run.held_out).collect();
        if marked.iter().all(|held| *held) {
            return Err(headland_calibrate::study::StudyError::AllHeldOut.into());
        }
        let (fit, chosen) = split(&marked);
        let mut case = Self {
            study,
            registry,
            drives,
            nominal: Vec::new(),
            fit,
            chosen,
            causes: Vec::new(),
            kinds: Kind::ORDER.to_vec(),
            progress,
            seed: options.seed,
            options,
        };
        case.nominal = case.said(scenario, &case.study.priors())?;
        for (drive, said) in case.drives.iter_mut().zip(&case.nominal) {
            accelerate(drive, said);
        }
        case.kinds = kinds(&case.drives, &case.nominal);
        let around = case.around(&model);
        let mut all = causes(&around);
        check_names(&all, registry, options)?;
        bound(&mut all, registry);
        case.causes = all
            .into_iter()
            .filter(|cause| !options.without.iter().any(|id| id == cause.id))
            .filter(|cause| options.only.is_empty() || options.only.iter().any(|id| id == cause.id))
            .collect();
        Ok(case)
    }

    /// What a scenario's model says of every run.
    pub fn said(&self, scenario: &Scenario, values: &[f64]) -> Result<Vec<Said>, DiagnoseError> {
        self.said_of(&self.drives, scenario, values)
    }

    /// As [`Case::said`], of other recordings of the same runs.
    pub fn said_of(
        &self,
        drives: &[Drive0],
        scenario: &Scenario,
        values: &[f64],
    ) -> Result<Vec<Said>, DiagnoseError> {
        let model = |run: usize| Ok(self.study.model_of(scenario, &drives[run].measured, values)?);
        said(self.registry, drives, &self.kinds, model, |_| None)
    }

    /// As [`Case::said`], with one more effect, which may be another in each run.
    pub fn said_with(
        &self,
        text: &(impl Fn(&Drive0) -> String + Sync),
        values: &[f64],
    ) -> Result<Vec<Said>, DiagnoseError> {
        let mut variants: Vec<(String, Scenario)> = Vec::new();
        for drive in &self.drives {
            let text = text(drive);
            if !variants.iter().any(|(known, _)| *known == text) {
                let scenario = self.study.scenario().with_effect(&text, self.registry)?;
                variants.push((text, scenario));
            }
        }
        let model = |run: usize| {
            let text = text(&self.drives[run]);
            let scenario = variants.iter().find(|(known, _)| *known == text).map(|(_, scenario)| scenario);
            let scenario = scenario.unwrap_or(self.study.scenario());
            Ok(self.study.model_of(scenario, &self.drives[run].measured, values)?)
        };
        said(self.registry, &self.drives, &self.kinds, model, |_| None)
    }

    /// The balances, from the ground up.
    pub fn balances(&self, usable: &[Vec<bool>]) -> Vec<Balance> {
        let block_s = block_s(&self.drives);
        self.kinds
            .iter()
            .map(|kind| balance(*kind, &self.drives, &self.nominal, block_s, usable))
            .filter(|balance| balance.chunks.iter().any(|chunk| self.fit[chunk.run]))
            .collect()
    }

    /// Whether the user lets a cause be claimed.
    pub fn wanted(&self, id: &str) -> bool {
        let Options { without, only, .. } = self.options;
        !without.iter().any(|one| one == id) && (only.is_empty() || only.iter().any(|one| one == id))
    }

    /// Causes that the user does not want claimed.
    pub fn banned(&self) -> Vec<&str> {
        self.options.without.iter().map(String::as_str).collect()
    }

    /// A function-valued cause on a balance.
    pub fn profile<'b>(&self, balance: &Balance, form: Form, signature: &'b Column) -> Profile<'b> {
        let over_position = form == Form::OverPosition;
        let group_of: Vec<usize> = if over_position {
            self.drives.iter().map(|drive| drive.path).collect()
        } else {
            (0..self.drives.len()).collect()
        };
        let groups = group_of.iter().max().map_or(0, |most| most + 1);
        let mut extents = vec![(f64::INFINITY, f64::NEG_INFINITY); groups];
        let at: Column = balance
            .chunks
            .iter()
            .map(|chunk| {
                let drive = &self.drives[chunk.run];
                let place = |row: &crate::rows::Row| {
                    let at = if over_position { row.mean(&drive.position_m) } else { row.time_s };
                    if at.is_finite() { at } else { 0.0 }
                };
                let at = DVector::from_iterator(chunk.rows.len(), chunk.rows.iter().map(place));
                let extent = &mut extents[group_of[chunk.run]];
                *extent = (extent.0.min(at.min()), extent.1.max(at.max()));
                at
            })
            .collect();
        for extent in &mut extents {
            if !extent.0.is_finite() {
                *extent = (0.0, 1.0);
            }
        }
        Profile { signature, at, group_of, extents }
    }

    fn around(&self, model: &headland_sim::Model) -> Around {
        let mut speeds: Vec<f64> = self
            .drives
            .iter()
            .flat_map(|drive| drive.motion.value.iter().step_by(7))
            .copied()
            .filter(|speed| *speed > 0.4)
            .collect();
        speeds.sort_by(f64::total_cmp);
        let quantile = |share: f64| {
            // A share of a length.
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "between 0 and the length"
            )]
            let index = (share * speeds.len().saturating_sub(1) as f64) as usize;
            speeds.get(index).copied().unwrap_or(1.0)
        };
        let names = self.drives.first().map(|drive| drive.measured.trace.channels()).unwrap_or_default();
        let everywhere =
            |name: &str| self.drives.iter().all(|drive| drive.measured.trace.get(name).is_some());
        let mut drives = false;
        for drive in &self.drives {
            let coasting = drive.measured.trace.get("coasting");
            for (index, force) in drive.force_n.iter().flatten().enumerate() {
                let free = coasting.is_some_and(|coasting| coasting[index] >= 0.5);
                drives |= !free && force.is_finite() && *force != 0.0;
            }
        }
        let mut passes = vec![0; self.drives.len()];
        for drive in &self.drives {
            passes[drive.path] += 1;
        }
        let temperatures =
            self.drives.iter().filter_map(|drive| drive.measured.trace.get("air_temperature_c"));
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in temperatures.flatten().filter(|value| value.is_finite()) {
            (low, high) = (low.min(*value), high.max(*value));
        }
        let situation_area = match model.vehicle.resistance {
            headland_sim::Resistance::Drag { area_m2 } => area_m2,
            headland_sim::Resistance::RoadLoad { f2_n_s2_m2, air_density_kg_m3, .. } => {
                2.0 * f2_n_s2_m2 / air_density_kg_m3
            }
        };
        Around {
            mass_kg: model.vehicle.mass_kg,
            gravity_m_s2: model.gravity_m_s2,
            drag_area_m2: situation_area,
            speeds_m_s: [0.2, 0.35, 0.5, 0.65, 0.8].map(quantile),
            duration_s: self.drives.iter().map(|drive| drive.measured.trace.duration_s()).fold(0.0, f64::max),
            channels: names
                .iter()
                .map(|channel| channel.name.clone())
                .filter(|name| everywhere(name))
                .collect(),
            drives: drives || self.drives.iter().all(|drive| drive.force_n.is_none()),
            passes: passes.into_iter().max().unwrap_or(1),
            temperatures_k: (high - low).max(0.0),
        }
    }
}

/// The acceleration that recorded force and nominal model make, where the vehicle moves and the force is known.
fn accelerate(drive: &mut Drive0, said: &Said) {
    /// Below this speed friction at rest decides [m/s].
    const SLOWEST_M_S: f64 = 0.4;
    let Some(force) = &drive.force_n else { return };
    for (index, acceleration) in drive.acceleration_m_s2.iter_mut().enumerate() {
        let made = (force[index] - said.resistance_n[index]) / said.effective_mass_kg[index];
        if made.is_finite() && drive.motion.value[index] > SLOWEST_M_S {
            *acceleration = made;
        }
    }
}

/// A parameter that its effect does not let be negative is not searched below zero.
fn bound(causes: &mut [Cause], registry: &Registry) {
    use headland_plugin::Bound::{Efficiency, NotNegative, Positive};
    for cause in causes {
        let Some(card) = registry.effects.card(cause.id) else { continue };
        for term in &mut cause.terms {
            let parameter = card.parameters.iter().find(|parameter| parameter.name == term.name);
            let positive =
                parameter.is_some_and(|one| matches!(one.bound, NotNegative | Positive | Efficiency));
            term.positive |= positive;
        }
    }
}

/// Which runs are fitted: all that are not marked, or two of three where none is marked.
fn split(marked: &[bool]) -> (Vec<bool>, bool) {
    /// Fewer runs are all needed.
    const FEWEST: usize = 3;
    if marked.iter().any(|held| *held) {
        return (marked.iter().map(|held| !held).collect(), false);
    }
    if marked.len() < FEWEST {
        return (vec![true; marked.len()], true);
    }
    // Of ten runs the third, the seventh and the tenth: both directions, early and late.
    let held = |index: usize| index % 10 == 2 || index % 10 == 6 || index % 10 == 9;
    ((0..marked.len()).map(|index| !held(index)).collect(), true)
}

fn check_names(all: &[Cause], registry: &Registry, options: &Options) -> Result<(), DiagnoseError> {
    let mut known: Vec<&'static str> = all.iter().map(|cause| cause.id).collect();
    known.extend(registry.cards(headland_plugin::Kind::Effect).iter().map(|card| card.name));
    known.extend(["latency", "speed_scale", "force_scale", "accelerometer_bias", "accelerometer_tilt"]);
    known.extend(["clock_drift", "quantisation", "dropout", "stuck_channel"]);
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
