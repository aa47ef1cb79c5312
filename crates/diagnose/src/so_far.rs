//! What was found so far, as part of the model that regressors are made with. Slopes and winds accelerate too, and weight
//! acts on a slope as well: what is in proportion to mass or acceleration is only told rightly beside them.
//!
//! A map of a path that one run drove alone tells how that run accelerates, and no more: a mass that pushed on its slopes would
//! take its whole shape up again at the cost of one number.

use crate::balances::balance::{Kind, change};
use crate::causes::catalogue::{Cause, Class, Form, Term};
use crate::causes::trial::Pool;
use crate::choosing::search::Found;
use crate::proof::mirror::is_whole;
use crate::proof::prove::text;
use crate::proof::refine::{Cured, Refined, plain};
use crate::runs::recorded::{Recorded, share_paths};
use crate::runs::said::{Said, said};
use crate::{Case, DiagnoseError};
use headland_plugin::{Action, Effect, Situation, State};
use headland_scenario::Scenario;
use headland_sim::{Model, Named};
use std::sync::Arc;

/// Slip of driven wheels, which turn at v / (1 − s).
const SLIP: &str = "wheel_slip";
/// Accelerations that change by less than this share of themselves, in the root mean square, are as they were.
const SAME: f64 = 0.05;

/// The effects of each run.
type Effects = Vec<Vec<Arc<dyn Effect>>>;
/// Effects by what they are in a scenario.
type Known = Vec<(Vec<String>, Vec<Arc<dyn Effect>>)>;

/// What changes in every balance, run by run and sample by sample.
type Changes = Vec<(Kind, Vec<Vec<f64>>)>;

/// Effects of each run, and what the model with them says.
pub struct SoFar {
    /// Those that tell how the runs accelerate, those that regressors are made beside, and those of them that are masses or
    /// what masses push on.
    effects: [Effects; 3],
    /// The free parameters beside them.
    values: Vec<f64>,
    /// How much the wheels slip: parameters of their slip by their names.
    slip: Vec<(&'static str, f64)>,
    said: Vec<Said>,
    accelerations_m_s2: Vec<Vec<f64>>,
    /// What they do together beyond the sum of what each does beside the others, by balance and run: extra mass pushes on a
    /// slope that was found once, and each of the two has all of that in its regressor.
    together: Changes,
}

/// An effect in many models at once.
#[derive(Debug)]
struct Shared(Arc<dyn Effect>);

impl Effect for Shared {
    fn states(&self) -> Vec<State> {
        self.0.states()
    }

    fn act(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Action {
        self.0.act(at, states, rates)
    }

    fn limits_n(&self, at: &Situation, states: &[f64]) -> (f64, f64) {
        self.0.limits_n(at, states)
    }

    fn follow(&self, at: &Situation, states: &[f64], rates: &mut [f64]) {
        self.0.follow(at, states, rates);
    }
}

impl Case<'_> {
    /// Takes what was found into the model that regressors are made with. Whether that changed how the runs accelerate.
    pub fn build_on(&mut self, pool: &Pool, found: &Found) -> Result<bool, DiagnoseError> {
        if found.accepted.is_empty() || self.runs.iter().all(|run| run.force_n.is_none()) {
            return Ok(false);
        }
        let refined = plain(self, pool, found);
        let shared = share_paths(&self.runs, &self.fit);
        // Wheels that slip accelerate nothing, and beside themselves they would slip twice: what that does is far from twice as much.
        let slips = |cured: &Cured| cured.cause.id == SLIP;
        // What takes power alone accelerates nothing and weighs nothing, and an engine that cut its fuel before it was found would take
        // less of it beside itself than it takes of it.
        let consumes =
            |cured: &Cured| !cured.cause.upstream && cured.cause.balances.iter().all(|kind| kind.is_power());
        // Beside a wind that blows otherwise in each run more drag area would be that wind.
        let blows = |cured: &Cured| cured.cause.blows_by_run();
        let shown = |cured: &Cured| {
            (shared || cured.cause.form != Form::OverPosition)
                && !slips(cured)
                && !consumes(cured)
                && !blows(cured)
        };
        // Masses, and what they push on; of a wind, which is no sum of columns, nothing of the kind can be said.
        let is_mass = |cured: &Cured| ["mass", "payload_change"].contains(&cured.cause.id);
        let pushes = refined.causes.iter().any(is_mass);
        let weighs = |cured: &Cured| pushes && shown(cured) && !is_whole(&cured.cause);
        let all = [
            effects(self, &refined, &|_| true)?,
            effects(self, &refined, &shown)?,
            effects(self, &refined, &weighs)?,
        ];
        let slip = refined.causes.iter().filter(|cured| slips(cured)).flat_map(|cured| {
            let values = cured.values.iter().map(|(value, _)| *value);
            cured.cause.terms.iter().map(|term| term.name).zip(values)
        });
        let so_far = self.so_far_of(all, (refined.values(), slip.collect()))?;
        let (mut changed, mut all) = (0.0, 0.0);
        for (run, after) in self.runs.iter().zip(&so_far.accelerations_m_s2) {
            for (before, after) in run.acceleration_m_s2.iter().zip(after) {
                if before.is_finite() && after.is_finite() {
                    changed += (after - before).powi(2);
                    all += after.powi(2);
                }
            }
        }
        let changes = changed > SAME * SAME * all;
        if changes {
            self.take_up(so_far);
        }
        Ok(changes)
    }

    /// What was found so far once more, after the recordings were corrected.
    pub fn build_again(&mut self) -> Result<(), DiagnoseError> {
        if let Some(so_far) = self.so_far.take() {
            let so_far = self.so_far_of(so_far.effects, (so_far.values, so_far.slip))?;
            self.take_up(so_far);
        }
        Ok(())
    }

    /// Whether regressors are made beside what was found.
    pub fn has_built(&self) -> bool {
        self.so_far.is_some()
    }

    /// Takes what was found out of the model for a while.
    pub fn set_aside(&mut self) -> Result<Option<SoFar>, DiagnoseError> {
        let kept = self.so_far.take();
        self.suppose()?;
        Ok(kept)
    }

    /// Takes up again what was set aside.
    pub fn take_back(&mut self, kept: Option<SoFar>) -> Result<(), DiagnoseError> {
        self.forget()?;
        if let Some(kept) = kept {
            self.take_up(kept);
        }
        Ok(())
    }

    /// Takes what was found out of the model again.
    pub fn forget(&mut self) -> Result<(), DiagnoseError> {
        if self.so_far.take().is_some() { self.suppose() } else { Ok(()) }
    }

    fn take_up(&mut self, so_far: SoFar) {
        self.remembered.forget();
        for (run, acceleration) in self.runs.iter_mut().zip(&so_far.accelerations_m_s2) {
            run.acceleration_m_s2.clone_from(acceleration);
        }
        self.so_far = Some(so_far);
    }

    fn so_far_of(
        &self,
        effects: [Effects; 3],
        (values, slip): (Vec<f64>, Vec<(&'static str, f64)>),
    ) -> Result<SoFar, DiagnoseError> {
        let with = |effects: &Effects, values: &[f64]| {
            said(&self.runs, &self.kinds, |run| {
                let model = self.study.model_of(self.study.scenario(), &self.runs[run].measured, values)?;
                Ok(beside(model, &effects[run]))
            })
        };
        // The vehicle as it was found tells how it accelerates, the nominal one what a regressor changes.
        let (told, said) = (with(&effects[0], &values)?, with(&effects[1], &self.study.priors())?);
        let accelerated = |(run, said): (&Recorded, &Said)| {
            run.accelerated_m_s2(&said.resistance_n, &said.effective_mass_kg)
        };
        let accelerations_m_s2 = self.runs.iter().zip(&told).map(accelerated).collect();
        let together = self.together(&effects[2])?;
        Ok(SoFar { effects, values, slip, said, accelerations_m_s2, together })
    }

    /// What effects do together, as a model with all of them says it, beyond the sum of what each does beside the others.
    fn together(&self, effects: &Effects) -> Result<Changes, DiagnoseError> {
        let most = effects.iter().map(Vec::len).max().unwrap_or(0);
        if most < 2 {
            return Ok(Vec::new());
        }
        let without = |place: usize| {
            said(&self.runs, &self.kinds, |run| {
                let model = self.study.model_of(
                    self.study.scenario(),
                    &self.runs[run].measured,
                    &self.study.priors(),
                )?;
                let others = effects[run].iter().enumerate().filter(|(own, _)| *own != place);
                Ok(beside(model, &others.map(|(_, effect)| Arc::clone(effect)).collect::<Vec<_>>()))
            })
        };
        // Without none of them, all of them are there.
        let said_with_all = without(most)?;
        let lesser = (0..most).map(without).collect::<Result<Vec<_>, _>>()?;
        let of = |kind: Kind| {
            let of_run = |(number, run): (usize, &Recorded)| {
                let by = |before: &Said| change(kind, run, before, &said_with_all[number]);
                let mut all = by(&self.nominal[number]);
                for lesser in &lesser {
                    for (all, own) in all.iter_mut().zip(by(&lesser[number])) {
                        *all -= own;
                    }
                }
                all
            };
            (kind, self.runs.iter().enumerate().map(of_run).collect())
        };
        Ok(self.kinds.iter().copied().map(of).collect())
    }

    /// What was found so far does together beyond the sum of its regressors, sample by sample, run by run; nothing where it is
    /// their sum.
    pub fn together_so_far(&self, kind: Kind) -> Option<&Vec<Vec<f64>>> {
        let so_far = self.so_far.as_ref()?;
        so_far.together.iter().find(|(own, _)| *own == kind).map(|(_, runs)| runs)
    }

    /// As much of a cause as was found of it so far, where that is far from twice half of it.
    pub fn step_so_far(&self, cause: &Cause, term: &Term) -> Option<f64> {
        let mut slip =
            self.so_far.iter().filter(|_| cause.id == SLIP).flat_map(|so_far| &so_far.slip).copied();
        slip.find(|(name, value)| *name == term.name && *value > 0.0).map(|(_, value)| value)
    }

    /// What the model says of every run with what was found so far.
    pub fn said_so_far(&self) -> &[Said] {
        self.so_far.as_ref().map_or(&self.nominal, |so_far| &so_far.said)
    }

    /// The model of a run with what was found so far.
    pub fn model_so_far(
        &self,
        scenario: &Scenario,
        run: usize,
        values: &[f64],
    ) -> Result<Model, DiagnoseError> {
        let model = self.study.model_of(scenario, &self.runs[run].measured, values)?;
        Ok(match &self.so_far {
            Some(so_far) => beside(model, &so_far.effects[1][run]),
            None => model,
        })
    }
}

fn beside(mut model: Model, effects: &[Arc<dyn Effect>]) -> Model {
    for (number, effect) in effects.iter().enumerate() {
        let plugin = Box::new(Shared(Arc::clone(effect)));
        model.effects.push(Named { name: format!("so_far_{number}"), plugin });
    }
    model
}

/// The effects that were found and are `wanted`, run by run; runs with the same ones share them.
fn effects(
    case: &Case,
    refined: &Refined,
    wanted: &dyn Fn(&Cured) -> bool,
) -> Result<Effects, DiagnoseError> {
    let mut known: Known = Vec::new();
    let physics = refined.causes.iter().filter(|cured| cured.cause.class == Class::Physics && wanted(cured));
    let physics: Vec<_> = physics.map(Cured::along).collect();
    let mut all = Vec::new();
    for run in 0..case.runs.len() {
        let texts: Vec<String> = physics.iter().filter_map(|cured| text(case, cured, run)).collect();
        if let Some((_, effects)) = known.iter().find(|(own, _)| *own == texts) {
            all.push(effects.clone());
            continue;
        }
        let mut scenario = case.study.scenario().clone();
        for text in &texts {
            scenario = scenario.with_effect(text, case.registry)?;
        }
        let mut model = case.study.model_of(&scenario, &case.runs[run].measured, &case.study.priors())?;
        let added = model.effects.split_off(model.effects.len() - texts.len());
        let effects: Vec<Arc<dyn Effect>> = added.into_iter().map(|named| Arc::from(named.plugin)).collect();
        known.push((texts, effects.clone()));
        all.push(effects);
    }
    Ok(all)
}
