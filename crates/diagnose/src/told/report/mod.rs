//! The answer: `diagnosis.json`, and what is written beside it.

mod answer;
mod bands;
mod finding;
mod series;
mod shown;

pub use answer::{Beside, inconclusive, report};

use crate::balances::balance::Kind;
use crate::experiment::Experiment;
use crate::told::map::Mismatch;
use headland_trace::Run;
use serde::Serialize;

/// What a diagnosis says in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Physics is missing.
    MissingPhysics,
    /// A sensor is wrong.
    SensorArtefact,
    /// Both.
    Both,
    /// Nothing is missing.
    None,
    /// Several causes explain it as well.
    CannotTell,
    /// A cause that nobody listed.
    Unlisted,
}

#[cfg(test)]
pub use finding::tests::finding;

/// What a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FindingKind {
    /// Something of the world.
    Physics,
    /// Something of a sensor.
    Artefact,
    /// An equation of its own.
    Unlisted,
}

/// A stretch of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// The run.
    pub run: String,
    /// Begin [s].
    pub from_s: f64,
    /// End [s].
    pub to_s: f64,
    /// Position at the begin [m].
    pub from_position_m: f64,
    /// Position at the end [m].
    pub to_position_m: f64,
}

/// A parameter of a finding.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterReport {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Its unit.
    pub unit: String,
}

/// A cause that explains as much.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RivalReport {
    /// Its identifier.
    pub id: String,
    /// Squared correlation with the cause that was named, free parameters projected out.
    pub squared_correlation: f64,
    /// Growth of ln p in the place of the cause that was named.
    pub evidence: f64,
    /// The equation of a law, which has no other name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub equation: Option<String>,
}

/// A finding.
#[derive(Clone, Debug, Serialize)]
pub struct FindingReport {
    /// World or sensor.
    pub kind: FindingKind,
    /// The contract's identifier.
    pub id: String,
    /// The balance in which it shows.
    pub balance: Kind,
    /// One sentence for a person.
    pub sentence: String,
    /// Its equation.
    pub equation: String,
    /// Channels that it depends on.
    pub depends_on: Vec<String>,
    /// Where it works.
    #[serde(rename = "where")]
    pub stretches: Vec<Interval>,
    /// Its parameters.
    pub parameters: Vec<ParameterReport>,
    /// Share of the mismatch that it explains.
    pub share_of_mismatch: f64,
    /// Growth of ln p by this cause, and what chance alone would reach once in a hundred.
    pub evidence: [f64; 2],
    /// Causes that explain as much.
    pub indistinguishable_from: Vec<RivalReport>,
    /// The run that would tell.
    pub next_experiment: String,
}

/// Errors over some runs.
#[derive(Clone, Debug, Serialize)]
pub struct FitRuns {
    /// The runs.
    pub runs: Vec<String>,
    /// Root mean square error with the nominal scenario.
    pub rmse_before: f64,
    /// With what was found.
    pub rmse_after: f64,
    /// What the sensor explains: of a speed the noise of its sensor, of other signals what neighbouring rows differ by.
    pub noise: f64,
}

/// Before and after.
#[derive(Clone, Debug, Serialize)]
pub struct Fit {
    /// The signal.
    pub signal: String,
    /// Runs that were fitted.
    pub fitted: FitRuns,
    /// Runs that were not; none where there were too few.
    pub held_out: Option<FitRuns>,
    /// Error at the end over the noise of the sensor; of a signal without a noise of its own what is left of the rows of the fitted runs over
    /// what neighbours differ by, in the balance where that is most. Near 1 where nothing is left to explain.
    pub lack_of_fit: f64,
}

impl Fit {
    /// What its noise is called.
    pub fn noise_in_words(&self) -> &'static str {
        if self.has_noise_of_its_own() {
            "the noise of the sensor"
        } else {
            "what neighbouring stretches differ by"
        }
    }

    /// What its lack of fit is of: a signal without a noise of its own is judged by the rows of a balance, and not sample by sample as its
    /// error is.
    pub fn left_in_words(&self) -> &'static str {
        if self.has_noise_of_its_own() {
            "What is left"
        } else {
            "Of the fitted runs, row by row, what is left"
        }
    }

    /// Whether its signal has a noise that is known by itself.
    fn has_noise_of_its_own(&self) -> bool {
        self.signal == "speed_m_s"
    }
}

/// An error that grows by more than this has grown.
const WORSE: f64 = 1.02;

impl FitRuns {
    /// Whether what was found made the error greater.
    pub(crate) fn grows(&self) -> bool {
        self.rmse_after > WORSE * self.rmse_before
    }
}

impl Fit {
    /// Whether what was found made the error greater in the runs that it never saw.
    pub(crate) fn grows(&self) -> bool {
        self.held_out.as_ref().is_some_and(FitRuns::grows)
    }

    /// Whether runs held out are foretold far better than before, and about as well as those that were fitted.
    pub(crate) fn is_foretold(&self) -> bool {
        /// Share of the error before.
        const FAR_BETTER: f64 = 0.5;
        /// Errors of few runs differ by this factor.
        const ABOUT: f64 = 1.3;
        self.held_out.as_ref().is_some_and(|held_out| {
            held_out.rmse_after < FAR_BETTER * held_out.rmse_before
                && held_out.rmse_after < ABOUT * self.fitted.rmse_after
        })
    }

    /// Whether a signal is as near to the noise as what each run tells of itself can follow it, or hardly anything is left of the error: a force
    /// that was measured with noise of its own moves a speed by more than the noise of that.
    pub(crate) fn is_followed(&self) -> bool {
        /// This share of the error before.
        const HARDLY: f64 = 0.05;
        /// A speed by so many times the noise,
        const FOLLOWED: f64 = 3.0;
        /// and what is rougher than a speed by this many: motors, pumps and gears leave more in a power than sensors do.
        const FOLLOWED_ELSE: f64 = 6.0;
        let most = if self.signal == "speed_m_s" { FOLLOWED } else { FOLLOWED_ELSE };
        let FitRuns { rmse_before, rmse_after, noise, .. } = self.fitted;
        rmse_after < most * noise || rmse_after < HARDLY * rmse_before
    }
}

/// A free parameter.
#[derive(Clone, Debug, Serialize)]
pub struct Calibrated {
    /// Its name.
    pub name: String,
    /// Its prior value.
    pub prior: f64,
    /// Its value.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Its unit.
    pub unit: String,
}

/// A cause that was tried.
#[derive(Clone, Debug, Serialize)]
pub struct Tried {
    /// The round: one cause is accepted in each.
    pub round: usize,
    /// The cause.
    pub id: String,
    /// Its non-linear parameters.
    pub shape: Vec<f64>,
    /// Growth of ln p.
    pub gain: f64,
    /// What the growth has to exceed.
    pub needed: f64,
}

/// `diagnosis.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// `headland.diagnosis/1`.
    pub schema: &'static str,
    /// What it says in a word.
    pub verdict: Verdict,
    /// One paragraph for a person.
    pub answer: String,
    /// The first balance, from the ground up, that does not close with the free parameters alone.
    pub first_balance: Option<Kind>,
    /// Where and under which conditions the balances do not close with the free parameters alone.
    pub mismatch: Vec<Mismatch>,
    /// Where they do not close with everything that was found.
    pub mismatch_left: Vec<Mismatch>,
    /// The findings, by their share of the mismatch.
    pub findings: Vec<FindingReport>,
    /// Before and after.
    pub fit: Fit,
    /// The free parameters.
    pub calibrated: Vec<Calibrated>,
    /// What the data cannot separate.
    pub null_space: Vec<String>,
    /// Runs that would separate causes in doubt, the one that tells most first.
    pub experiments: Vec<Experiment>,
    /// Causes that explain each run by itself, but not one from the others.
    pub unproven: Vec<String>,
    /// What was decided on the way.
    pub notes: Vec<String>,
    /// The best causes of every round and why they lost: the evidence they brought.
    pub tried: Vec<Tried>,
}

/// A diagnosis with what is written beside it.
#[derive(Clone, Debug)]
pub struct Diagnosed {
    /// `diagnosis.json`.
    pub diagnosis: Diagnosis,
    /// The improved scenario for each path: the first is `scenario.ron`.
    pub scenarios: Vec<String>,
    /// The improved scenario for runs on another road, `scenario_elsewhere.ron`: without what belongs to one path or to one run.
    pub elsewhere: Option<String>,
    /// Every effect along every run, for `effects.parquet`.
    pub effects: Vec<Run>,
    /// Corrections of channels for the improved `recording.ron`: channel, latency [s], scale, bias.
    pub corrections: Vec<(String, f64, f64, f64)>,
    /// What every balance leaves over, for pictures.
    pub residuals: Vec<LeftOver>,
    /// The signal itself, before and after, in the runs that prove it.
    pub shown: Vec<Shown>,
}

/// A signal in one run: as it was measured, and as the model makes it before and after.
#[derive(Clone, Debug)]
pub struct Shown {
    /// The run.
    pub run: String,
    /// Whether it was held out.
    pub held_out: bool,
    /// The channel.
    pub signal: String,
    /// Times [s].
    pub time_s: Vec<f64>,
    /// As recorded; where a sensor was found wrong, as that sensor ought to have recorded it.
    pub measured: Vec<f64>,
    /// With the nominal scenario, against what was recorded.
    pub before: Vec<f64>,
    /// With what was found.
    pub after: Vec<f64>,
}

/// What a balance leaves over in one run, row by row.
#[derive(Clone, Debug)]
pub struct LeftOver {
    /// The balance.
    pub balance: Kind,
    /// The run.
    pub run: String,
    /// Whether the run was held out.
    pub held_out: bool,
    /// The path that it drove: runs of the same number share it.
    pub path: usize,
    /// Whether it went against the path.
    pub reversed: bool,
    /// Time of each row [s].
    pub time_s: Vec<f64>,
    /// Position of each row along the path [m].
    pub position_m: Vec<f64>,
    /// Speed of each row [m/s].
    pub speed_m_s: Vec<f64>,
    /// Measured minus modelled with the free parameters alone, in the unit of the balance.
    pub before: Vec<f64>,
    /// With everything that was found.
    pub after: Vec<f64>,
}
