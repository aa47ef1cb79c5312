//! The result of a coast-down analysis: what `coastdown.json` holds.

use super::input::SpeedUnit;
use super::two_stage::TwoStage;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const SCHEMA: &str = "headland.coastdown/1";

/// Everything that was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoastDown {
    /// [`SCHEMA`].
    pub schema: String,
    /// f0, f1, f2 of calm air, with grade and wind of each path that both directions separate.
    pub road_load: RoadLoad,
    /// c_w of c_w (1 + v/100), where its unit was stated.
    pub speed_law: Option<SpeedLaw>,
    /// The two-stage aggregation as published: without rotating mass.
    pub two_stage: Option<TwoStage>,
    /// The same with rotating mass.
    pub two_stage_with_rotating_mass: Option<TwoStage>,
    /// One row a run.
    pub runs: Vec<RunRow>,
    /// One row a pair of runs on one path in both directions.
    pub pairs: Vec<PairRow>,
    /// Runs that could not be used, and why.
    pub left_out: Vec<LeftOut>,
    /// What the data cannot separate, one sentence each.
    pub null_space: Vec<String>,
}

/// A parameter with its uncertainty. Intervals are absent where the runs leave no degree of freedom to judge by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Name.
    pub name: String,
    /// Unit; `1` for a pure number.
    pub unit: String,
    /// Value.
    pub value: f64,
    /// Standard error: scatter between runs and uncertainty of the constants.
    pub standard_error: Option<f64>,
    /// Degrees of freedom of the standard error.
    pub degrees_of_freedom: Option<f64>,
    /// The 95 % interval to use: the studentised bootstrap where the runs allow one, Student's otherwise.
    pub interval_95: Option<[f64; 2]>,
    /// Student's t with Satterthwaite's degrees of freedom.
    pub student_95: Option<[f64; 2]>,
    /// Studentised bootstrap over runs.
    pub bootstrap_95: Option<[f64; 2]>,
    /// Percentile bootstrap over runs, for comparison: too narrow for few runs.
    pub percentile_95: Option<[f64; 2]>,
}

/// What a fit found beside its parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FitReport {
    /// The parameters.
    pub estimates: Vec<Estimate>,
    /// Their covariance, in their order, each in its unit; of scatter between runs and of the constants.
    pub covariance: Vec<Vec<f64>>,
    /// Root mean square of the residual of speed over all samples, each run with its own offset [m/s].
    pub rms_m_s: f64,
    /// Standard deviation of a speed sample, as the residuals show it [m/s].
    pub sample_sd_m_s: f64,
    /// How long a deviation of speed lasts [s].
    pub correlation_time_s: f64,
    /// Standard deviation between runs beyond sensor noise: of c_w where that is fitted, else of resistance over weight.
    pub between_runs_sd: f64,
    /// Replicates of the bootstrap.
    pub replicates: usize,
    /// Replicates whose runs could not determine the parameters.
    pub singular_replicates: usize,
}

impl FitReport {
    /// The estimate of this name.
    pub fn estimate(&self, name: &str) -> Option<&Estimate> {
        self.estimates.iter().find(|estimate| estimate.name == name)
    }
}

/// Road loads F = f0 + f1 v + f2 v², v in m/s, on level ground in calm air.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RoadLoad {
    /// The fit. A coefficient that the runs cannot separate at all is not in it.
    pub fit: FitReport,
    /// Resistance at speeds that the runs covered.
    pub forces: Vec<ForceAt>,
}

/// Resistance at one speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForceAt {
    /// Speed [m/s].
    pub speed_m_s: f64,
    /// Resistance on level ground in calm air [N].
    pub force_n: f64,
    /// 95 % interval, Student's t [N].
    pub interval_95: Option<[f64; 2]>,
}

/// c_w (1 + v/100) G.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpeedLaw {
    /// Unit of v.
    pub unit: SpeedUnit,
    /// The fit; `c_w` is its first estimate.
    pub fit: FitReport,
    /// The same runs read with each unit: a wrong one shows in the residual.
    pub units: Vec<UnitReading>,
}

/// The coefficient if v had this unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnitReading {
    /// Unit of v.
    pub unit: SpeedUnit,
    /// Coefficient.
    pub c_w: f64,
    /// Root mean square of the residual of speed [m/s].
    pub rms_m_s: f64,
    /// Standard deviation of c_w between runs beyond sensor noise.
    pub between_runs_sd: f64,
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRow {
    /// Name.
    pub run: String,
    /// Path, where one was named.
    pub path: Option<String>,
    /// Direction.
    pub reversed: bool,
    /// Start of the coast-down in the trace [s].
    pub from_s: f64,
    /// Its duration [s].
    pub duration_s: f64,
    /// Samples used.
    pub samples: usize,
    /// Fitted speed at its start [m/s].
    pub initial_m_s: f64,
    /// Measured speed at its end [m/s].
    pub last_m_s: f64,
    /// Mean resistance of this run alone, grade and wind of its path included [N].
    pub apparent_resistance_n: f64,
    /// Its resistance beyond the pool, over weight; grade and wind of its path taken out.
    pub offset: f64,
    /// Standard deviation of the offset from noise within the run.
    pub offset_sd: f64,
    /// Offset over the standard deviation that noise and the variation between runs let expect.
    pub offset_in_sd: f64,
    /// c_w of this run alone, with grade and wind of its path taken out.
    pub c_w: Option<f64>,
    /// c_w of this run alone, as if the path were level and calm.
    pub c_w_apparent: Option<f64>,
    /// Root mean square of its residual [m/s].
    pub rms_m_s: f64,
}

/// Two runs on one path in opposite directions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairRow {
    /// Run along the path.
    pub forward: String,
    /// Run against it.
    pub reversed: String,
    /// Half the sum of their mean resistances over the speeds that both went through [N]: what does not depend on
    /// direction.
    pub resistance_n: f64,
    /// Half the difference of their mean resistances [N]: what does.
    pub asymmetry_n: f64,
    /// The difference read as a grade of the path in its forward direction, all of it.
    pub as_grade: f64,
    /// The difference read as wind against the forward direction [m/s], all of it; where drag area and density are known.
    pub as_headwind_m_s: Option<f64>,
    /// c_w of the pair: mean of the apparent values.
    pub c_w: Option<f64>,
}

/// A run that could not be used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeftOut {
    /// Name.
    pub run: String,
    /// Why.
    pub reason: String,
}
