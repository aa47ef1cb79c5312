//! The analysis of a study, from runs to result.

use super::CoastDownError;
use super::estimate::Judged;
use super::fit::{Fitted, Model};
use super::input::{CoastRun, Constant, Settings, SpeedUnit};
use super::motion::{Air, Term};
use super::null_space::{self, Sight};
use super::report::{CoastDown, ForceAt, LeftOut, RoadLoad, SCHEMA, SpeedLaw, UnitReading};
use super::segment::{Coast, coast_of};
use super::tables;
use super::two_stage::{TwoStage, two_stage};
use nalgebra::DVector;

/// Runs that were checked and cut to their coast-downs.
#[derive(Clone, Debug)]
pub struct Study {
    /// The coast-downs, in the order of the runs.
    pub(super) coasts: Vec<Coast>,
    /// Name of each path; none for runs without one.
    pub(super) paths: Vec<Option<String>>,
    left_out: Vec<LeftOut>,
    /// The same coast-downs with one uncertain constant moved by its standard deviation each.
    shifted: Vec<Vec<Coast>>,
    pub(super) settings: Settings,
}

/// Analyses a study of coast-downs.
///
/// # Errors
/// [`CoastDownError`] where runs or settings are impossible, no run coasts, or nothing can be determined.
pub fn analyse(runs: &[CoastRun], settings: &Settings) -> Result<CoastDown, CoastDownError> {
    Study::new(runs, settings)?.analyse()
}

impl Study {
    /// Checks the runs and finds the coast-down in each.
    ///
    /// # Errors
    /// [`CoastDownError`] where a run or a setting is impossible, or no run coasts.
    pub fn new(runs: &[CoastRun], settings: &Settings) -> Result<Self, CoastDownError> {
        check_settings(settings)?;
        let mut paths: Vec<Option<String>> = Vec::new();
        let mut coasts = Vec::new();
        let mut left_out = Vec::new();
        for (index, run) in runs.iter().enumerate() {
            if runs[..index].iter().any(|other| other.id == run.id) {
                return Err(CoastDownError::Twice { run: run.id.clone() });
            }
            check_constants(run)?;
            let known = paths.iter().position(|path| *path == run.path);
            let path = known.unwrap_or(paths.len());
            match coast_of(run, index, path, settings) {
                Ok(coast) => {
                    coasts.push(coast);
                    if known.is_none() {
                        paths.push(run.path.clone());
                    }
                }
                Err(error @ CoastDownError::NoCoasting { .. }) if runs.len() > 1 => {
                    left_out.push(LeftOut { run: run.id.clone(), reason: error.to_string() });
                }
                Err(error) => return Err(error),
            }
        }
        if coasts.is_empty() {
            return Err(CoastDownError::NoRun);
        }
        let shifted = shifted(runs, &coasts);
        Ok(Self { coasts, paths, left_out, shifted, settings: *settings })
    }

    /// Everything.
    ///
    /// # Errors
    /// [`CoastDownError`] where a fit fails.
    pub fn analyse(&self) -> Result<CoastDown, CoastDownError> {
        let (judged, sight) = self.judge_road_load()?;
        let road_load = self.describe_road_load(&judged);
        let law = self.settings.speed_law_unit.map(|unit| self.judge_speed_law(unit, &sight)).transpose()?;
        let speed_law = match (&law, self.settings.speed_law_unit) {
            (Some(law), Some(unit)) => Some(self.describe_speed_law(unit, law, &sight)?),
            _ => None,
        };
        let two_stage = |with_rotating_mass| {
            let unit = self.settings.speed_law_unit?;
            self.two_stage(unit, with_rotating_mass)
        };
        let runs =
            tables::runs(&self.coasts, &self.paths, &judged.fitted, law.as_ref().map(|law| &law.fitted));
        let pairs = tables::pairs(&self.coasts, &runs, &judged.fitted);
        Ok(CoastDown {
            schema: SCHEMA.to_owned(),
            null_space: null_space::sentences(self, &sight, &judged.fitted, self.settings.speed_law_unit),
            road_load,
            speed_law,
            two_stage: two_stage(false),
            two_stage_with_rotating_mass: two_stage(true),
            runs,
            pairs,
            left_out: self.left_out.clone(),
        })
    }

    /// The two-stage aggregation of the reference study; none where runs are too short to be differentiated.
    pub fn two_stage(&self, unit: SpeedUnit, with_rotating_mass: bool) -> Option<TwoStage> {
        two_stage(&self.coasts, unit.hundred_m_s(), self.settings.difference_s, with_rotating_mass)
    }

    /// Fit of c_w (1 + v/100) with the grade and wind that both directions separate.
    ///
    /// # Errors
    /// [`CoastDownError`] where the runs cannot determine it.
    pub fn speed_law(&self, unit: SpeedUnit) -> Result<SpeedLaw, CoastDownError> {
        let sight = self.judge_road_load_blindness()?;
        let judged = self.judge_speed_law(unit, &sight)?;
        self.describe_speed_law(unit, &judged, &sight)
    }

    fn describe_speed_law(
        &self,
        unit: SpeedUnit,
        judged: &Judged,
        sight: &Sight,
    ) -> Result<SpeedLaw, CoastDownError> {
        let units = SpeedUnit::ALL
            .into_iter()
            .map(|unit| {
                let fitted = self.law_model(unit, sight).fit()?;
                let square: f64 = fitted.rms_m_s.iter().map(|rms| rms * rms).sum();
                Ok(UnitReading {
                    unit,
                    c_w: fitted.parameters[0],
                    rms_m_s: (square / fitted.rms_m_s.len() as f64).sqrt(),
                    between_runs_sd: fitted.noise.between_runs,
                })
            })
            .collect::<Result<Vec<_>, CoastDownError>>()?;
        Ok(SpeedLaw { unit, fit: judged.report(|term| self.name(term)), units })
    }

    fn judge_speed_law(&self, unit: SpeedUnit, sight: &Sight) -> Result<Judged, CoastDownError> {
        let model = self.law_model(unit, sight);
        let fitted = model.fit()?;
        Judged::new(&model, fitted, &self.shifted, &self.settings)
    }

    fn law_model(&self, unit: SpeedUnit, sight: &Sight) -> Model<'_> {
        let mut terms = vec![Term::Rolling { scale_m_s: unit.hundred_m_s() }];
        terms.extend(sight.directional());
        Model { name: "c_w", coasts: &self.coasts, terms, air: Air::Known }
    }

    fn road_load_model(&self, terms: Vec<Term>) -> Model<'_> {
        Model { name: "the road load", coasts: &self.coasts, terms, air: Air::WindOnly }
    }

    /// What the runs can tell apart, judged with the road load fitted to them.
    fn judge_road_load_blindness(&self) -> Result<Sight, CoastDownError> {
        let model = self.road_load_model(vec![Term::Constant]);
        let rough = Sight::of(self, &model, &model.fit()?)?;
        let model = self.road_load_model(rough.without_wind());
        Sight::of(self, &model, &model.fit()?)
    }

    fn judge_road_load(&self) -> Result<(Judged, Sight), CoastDownError> {
        let sight = self.judge_road_load_blindness()?;
        let model = self.road_load_model(sight.separable());
        let fitted = model.fit()?;
        Ok((Judged::new(&model, fitted, &self.shifted, &self.settings)?, sight))
    }

    /// The road load alone, without intervals.
    pub(super) fn fit_road_load(&self) -> Result<Fitted, CoastDownError> {
        let sight = self.judge_road_load_blindness()?;
        self.road_load_model(sight.separable()).fit()
    }

    fn describe_road_load(&self, judged: &Judged) -> RoadLoad {
        let speeds = self.coasts.iter().flat_map(|coast| &coast.speed_m_s);
        let (slowest, fastest) =
            speeds.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(*v), high.max(*v)));
        let forces = (0..=4)
            .map(|part| {
                let speed_m_s = slowest + (fastest - slowest) * 0.25 * f64::from(part);
                let direction = DVector::from_iterator(
                    judged.fitted.terms.len(),
                    judged.fitted.terms.iter().map(|term| match term {
                        Term::Constant => 1.0,
                        Term::Linear => speed_m_s,
                        Term::Quadratic => speed_m_s * speed_m_s,
                        _ => 0.0,
                    }),
                );
                let (force_n, spread) = judged.combination(&direction);
                ForceAt { speed_m_s, force_n, interval_95: spread.map(|spread| spread.interval) }
            })
            .collect();
        RoadLoad { fit: judged.report(|term| self.name(term)), forces }
    }

    /// Name and unit of a term as they are reported.
    pub(super) fn name(&self, term: Term) -> (String, &'static str) {
        let of_path = |what: &str, path: usize| match &self.paths[path] {
            Some(name) => format!("{what} of `{name}`"),
            None => what.to_owned(),
        };
        match term {
            Term::Constant => ("f0".to_owned(), "N"),
            Term::Linear => ("f1".to_owned(), "N s/m"),
            Term::Quadratic => ("f2".to_owned(), "N s²/m²"),
            Term::Rolling { .. } => ("c_w".to_owned(), "1"),
            Term::Grade { path } => (of_path("grade", path), "1"),
            Term::Headwind { path } => (of_path("head wind", path), "m/s"),
            Term::RotatingMass => ("rotating mass".to_owned(), "kg"),
            Term::SpeedScale => ("scale of the speed sensor".to_owned(), "1"),
            Term::Offset => ("offset".to_owned(), "1"),
        }
    }
}

fn check_settings(settings: &Settings) -> Result<(), CoastDownError> {
    let refuse = |name, found, expected| Err(CoastDownError::Setting { name, found, expected });
    if !(settings.lowest_speed_m_s >= 0.0 && settings.lowest_speed_m_s.is_finite()) {
        return refuse("lowest_speed_m_s", settings.lowest_speed_m_s, "0 or more");
    }
    if !(settings.trim_s >= 0.0 && settings.trim_s.is_finite()) {
        return refuse("trim_s", settings.trim_s, "0 or more");
    }
    if !(settings.difference_s > 0.0 && settings.difference_s.is_finite()) {
        return refuse("difference_s", settings.difference_s, "more than 0");
    }
    Ok(())
}

fn check_constants(run: &CoastRun) -> Result<(), CoastDownError> {
    let refuse =
        |name, found, expected| Err(CoastDownError::Constant { run: run.id.clone(), name, found, expected });
    let optional = |constant: Option<Constant>| constant.unwrap_or(Constant::exact(1.0));
    let constants = [
        ("mass_kg", run.mass_kg, true),
        ("rotating_mass_kg", run.rotating_mass_kg, false),
        ("drag_area_m2", optional(run.drag_area_m2), false),
        ("air_density_kg_m3", optional(run.air_density_kg_m3), false),
    ];
    for (name, constant, positive) in constants {
        if positive && !(constant.value > 0.0 && constant.value.is_finite()) {
            return refuse(name, constant.value, "more than 0");
        }
        if !(constant.value >= 0.0 && constant.value.is_finite()) {
            return refuse(name, constant.value, "0 or more");
        }
        if !(constant.sd >= 0.0 && constant.sd.is_finite()) {
            return refuse(name, constant.sd, "a standard deviation of 0 or more");
        }
    }
    Ok(())
}

/// Moves a constant by its standard deviation, and says how far.
type Shift<'a> = dyn Fn(&CoastRun, &mut Coast) -> f64 + 'a;

/// Constants are taken as shared: an error of one is the same in all runs, each by its own standard deviation.
fn shifted(runs: &[CoastRun], coasts: &[Coast]) -> Vec<Vec<Coast>> {
    let mass = |run: &CoastRun, coast: &mut Coast| {
        coast.mass_kg += run.mass_kg.sd;
        coast.effective_mass_kg += run.mass_kg.sd;
        run.mass_kg.sd
    };
    let rotating = |run: &CoastRun, coast: &mut Coast| {
        coast.effective_mass_kg += run.rotating_mass_kg.sd;
        run.rotating_mass_kg.sd
    };
    let scale = |constant: Option<Constant>, coast: &mut Coast| {
        let (Some(constant), Some(k)) = (constant, coast.half_density_drag_area_kg_m.as_mut()) else {
            return 0.0;
        };
        if constant.value > 0.0 {
            *k *= 1.0 + constant.sd / constant.value;
        }
        constant.sd
    };
    let area = |run: &CoastRun, coast: &mut Coast| scale(run.drag_area_m2, coast);
    let density = |run: &CoastRun, coast: &mut Coast| scale(run.air_density_kg_m3, coast);
    let shifts: [&Shift; 4] = [&mass, &rotating, &area, &density];
    shifts
        .into_iter()
        .filter_map(|shift| {
            let mut moved = coasts.to_vec();
            let total: f64 = moved.iter_mut().map(|coast| shift(&runs[coast.run], coast)).sum();
            (total > 0.0).then_some(moved)
        })
        .collect()
}
