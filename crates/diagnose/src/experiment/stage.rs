//! The proposed runs as a recording of their own, with rows and regressors made like those of the recording at hand.

use super::columns::nothing;
use super::course::{Course, Without, courses};
use super::draft::{ballasted, base, drafted, forced};
use super::signature::by_values;
use crate::balances::balance::{Kind, System, block_s};
use crate::balances::gram::Column;
use crate::balances::noise::{Noise, Shape};
use crate::causes::catalogue::{Cause, Class};
use crate::causes::remembered::Remembered;
use crate::causes::sensors::{PITCH, PITCH_RAD_S2_M, fault};
use crate::causes::trial::{Pool, Trial, add_trial, for_run, nuisance};
use crate::proof::refine::{Refined, said_with_all};
use crate::{Case, DiagnoseError};
use headland_calibrate::study::Measured;
use headland_scenario::Scenario;
use headland_sim::Model;
use rayon::prelude::*;

/// Proposed runs, ready to be asked what a cause would do in them.
pub struct Stage<'a> {
    /// The case that they make.
    pub case: Case<'a>,
    /// What each run is.
    pub courses: Vec<Course>,
    /// Their rows.
    pub system: System,
    /// Their regressors.
    pub pool: Pool,
}

/// Noise of an accelerometer that is not there yet: scatter of a sample, and what the ground shakes it by [m/s²].
const ACCELEROMETER_M_S2: f64 = 0.05;
const SHAKEN_M_S2: f64 = 0.02;
/// The shaking of neighbouring rows is alike.
const SHAKEN_PERSISTENCE: f64 = 0.7;
/// An accelerometer's offset, which is free by its usual size where one is proposed: nobody has told it yet [m/s²].
const OFFSET: &str = "accelerometer_bias";
const OFFSET_M_S2: f64 = 0.15;

impl<'a> Stage<'a> {
    /// Drafts the runs, with everything that was found at work. Runs that do without something are only drafted where one
    /// of the causes in doubt would be silent.
    pub fn new(case: &Case<'a>, refined: &Refined, doubted: &[usize]) -> Result<Option<Self>, DiagnoseError> {
        let Some(base) = base(case) else { return Ok(None) };
        let values = refined.values();
        let known = |one: &&crate::proof::refine::Cured| {
            one.function().is_none() && one.events.is_empty() && one.cause.class != Class::Artefact
        };
        let effects: Vec<(Cause, Vec<f64>)> =
            refined.causes.iter().filter(known).map(|one| (one.cause.clone(), one.values())).collect();
        let modelled = |course: Option<&Course>| -> Result<Option<Model>, DiagnoseError> {
            let mut document = case.study.scenario().document().clone();
            let silent = |cause: &Cause| course.is_some_and(|course| course.without.silences(cause));
            for (cause, values) in effects.iter().filter(|(cause, _)| !silent(cause)) {
                document = document.with_effect(&for_run(&cause.written(values), cause, &base))?;
            }
            let scenario = Scenario::of(document, case.registry)?;
            let ballast_kg = course.map_or(0.0, |course| course.ballast_kg);
            let Some(known) = ballasted(case, &base, ballast_kg) else { return Ok(None) };
            let measured = Measured { known, ..base.measured.clone() };
            Ok(Some(case.study.model_of(&scenario, &measured, &values)?))
        };
        let Some(plain) = modelled(None)? else { return Ok(None) };
        let pass = case.runs.iter().filter(|run| run.path == base.path).count();
        let tells = |course: &Course| {
            let silent = |cause: &usize| course.without.silences(&case.causes[*cause]);
            course.without == Without::Nothing || doubted.iter().any(silent)
        };
        let (mut kept, mut runs) = (Vec::new(), Vec::new());
        for course in courses(case, &base, plain.vehicle.mass_kg).into_iter().filter(tells) {
            let Some(model) = modelled(Some(&course))? else { continue };
            if let Some(mut run) = drafted(case, &base, &course, &model)? {
                run.measured.how.passes_before = pass;
                runs.push(run);
                kept.push(course);
            }
        }
        runs.par_iter_mut().zip(&kept).try_for_each(|(run, course)| {
            let acting: Vec<(Cause, Vec<f64>)> =
                effects.iter().filter(|(cause, _)| !course.without.silences(cause)).cloned().collect();
            let said = said_with_all(case, std::slice::from_ref(run), &acting, &values)?;
            said.first().map_or(Ok(()), |said| forced(run, &base, said))
        })?;
        let mut kinds = case.kinds.clone();
        let bare = !kinds.contains(&Kind::Parity);
        if bare && kept.iter().any(|course| course.accelerometer) {
            kinds.insert(0, Kind::Parity);
        }
        let mut study = case.study.clone();
        study.runs.clear();
        let mut stage = Case {
            study,
            registry: case.registry,
            sound: Vec::new(),
            fit: vec![true; runs.len()],
            cycles: case.cycles,
            bears: vec![true; runs.len()],
            raw: runs.clone(),
            runs,
            corrections: case.corrections.clone(),
            no_faults: case.no_faults.clone(),
            scale: case.scale,
            late_s: case.late_s,
            late_powers: case.late_powers.clone(),
            logged_s: Vec::new(),
            sensors: case.sensors.clone(),
            only: None,
            nominal: Vec::new(),
            rows: case.rows,
            so_far: None,
            remembered: Remembered::default(),
            unmoved: case.unmoved,
            chosen: false,
            paths: case.paths.clone(),
            causes: case.causes.clone(),
            kinds,
            progress: case.progress,
            options: case.options,
        };
        stage.nominal = stage.said(case.study.scenario(), &case.study.priors())?;
        let usable: Vec<Vec<bool>> =
            stage.runs.iter().map(|run| vec![true; run.measured.trace.len()]).collect();
        let (kinds, block_s) = (&stage.kinds, |kind| block_s(kind, &case.runs, case.rows));
        let system = System::new(kinds, &stage.runs, &stage.nominal, &block_s, &usable, &stage.fit);
        if system.chunks.is_empty() {
            return Ok(None);
        }
        let mut pool = nuisance(&stage, &system)?;
        if bare && system.has(Kind::Parity) {
            for (id, sd) in [(OFFSET, OFFSET_M_S2), (PITCH, PITCH_RAD_S2_M)] {
                if let Some((_, column)) = pool.small.iter().find(|(known, _)| *known == id) {
                    pool.sd[*column] = sd;
                } else {
                    pool.small.push((id, pool.columns.len()));
                    pool.columns.push(fault(&stage, &system, id, sd)?);
                    pool.sd.push(sd);
                }
            }
            pool.nuisance = pool.columns.len();
        }
        Ok(Some(Self { case: stage, courses: kept, system, pool }))
    }

    /// Makes the regressors of a cause, unless they are there.
    pub fn bring(&mut self, cause: usize, shape: &[f64]) -> Result<(), DiagnoseError> {
        let known = |trial: &Trial| trial.cause == cause && trial.shape == shape;
        if by_values(self.case.causes[cause].form) || self.pool.trials.iter().any(known) {
            return Ok(());
        }
        add_trial(&self.case, &self.system, &mut self.pool, cause, shape)
    }

    /// Faults of sensors that are free, with their columns.
    pub fn faults(&self) -> impl Iterator<Item = &(&'static str, usize)> {
        self.pool.small.iter().chain(&self.pool.corrected)
    }

    /// The column of one term of a cause; of nothing where the cause does nothing there.
    pub fn column(&self, like: &Trial, term: usize) -> Column {
        let mut trials = self.pool.trials.iter();
        let trial = trials.find(|trial| {
            trial.cause == like.cause && trial.shape == like.shape && trial.terms.contains(&term)
        });
        let column = trial.and_then(|trial| {
            let place = trial.terms.iter().position(|own| *own == term)?;
            Some(self.pool.columns[trial.columns[place]].clone())
        });
        column.unwrap_or_else(|| nothing(&self.system))
    }

    /// What an accelerometer would add to the rows of the parity balance.
    pub fn accelerometer(&self) -> Noise {
        let (mut lasts_s, mut count) = (0.0, 0usize);
        for run in &self.case.runs {
            count += run.measured.trace.len();
            lasts_s += run.measured.trace.duration_s();
        }
        let samples = (block_s(Kind::Motion, &self.case.runs, self.case.rows) * count as f64
            / lasts_s.max(1e-9))
        .max(1.0);
        Noise {
            shape: Shape::Averaged,
            sensor: ACCELEROMETER_M_S2.powi(2) / samples,
            process: SHAKEN_M_S2.powi(2),
            persistence: SHAKEN_PERSISTENCE,
        }
    }
}
