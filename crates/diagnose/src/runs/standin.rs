//! Runs that lack a channel: a recording brought to where every run that is left can drive the model.
//!
//! A run that does not know its speed over ground is driven by the speed of its wheels, which differs from it by the slip
//! alone; what compares the two is left out there. A run that knows neither is left out. Before that a speed loses what no
//! vehicle can have, and the scale that the way says is wrong.

use crate::DiagnoseError;
use crate::causes::sensors::with_channel;
use crate::runs::leaps::{leaps, without};
use crate::runs::thinned::thinned;
use crate::runs::way::{Scale, scale};
use headland_calibrate::curved::{self, with_curvature};
use headland_calibrate::laid;
use headland_calibrate::sparse::{self, Sparse, filled};
use headland_calibrate::study::StudyError;
use headland_recording::{RecordedRun, Recording};
use headland_trace::{Origin, Trace};

/// Speed over ground and speed of the wheels.
const OVER_GROUND: &str = "speed_m_s";
const OF_WHEELS: &str = "wheel_speed_m_s";
/// Fewer samples make no motion.
const FEWEST: usize = 2;
/// Speed over ground that is missing for less is a gap, and no channel that was not recorded [s].
const LASTS_S: f64 = 10.0;

/// A recording whose runs can all drive the model.
pub struct Prepared {
    /// The runs that are left, each with a speed.
    pub recording: Recording,
    /// For each of them the samples whose speed is that of the wheels; empty where it is none.
    pub stands_in: Vec<Vec<bool>>,
    /// For each of them the samples at which it is not known what it was driven by; empty where there are none.
    pub unknown: Vec<Vec<bool>>,
    /// For each of them first and last sample of the stretches whose speed no vehicle can have.
    pub leaps: Vec<Vec<(usize, usize)>>,
    /// What the way says of the scale of the speed over ground; the runs are corrected where it is wrong.
    pub scale: Option<Scale>,
    /// Times of the rows of their logs [s], which may be more than those in which the speed is new.
    pub logged_s: Vec<Vec<f64>>,
    /// Whether curvature was made of the turns that the runs show.
    pub curved: bool,
    /// What was decided, for people.
    pub notes: Vec<String>,
}

/// Prepares a recording; a `wrong` scale of speed is taken out of it where the user lets one be claimed. Where the scenario's
/// path is `straight`, it gets the curvature that its runs show.
///
/// # Errors
/// [`StudyError::NoSpeed`] where no run has a speed of any kind.
pub fn prepared(recording: &Recording, wrong: bool, straight: bool) -> Result<Prepared, DiagnoseError> {
    let curved = if straight { with_curvature(recording)? } else { None };
    let (recording, curved) = curved.unwrap_or_else(|| (recording.clone(), Vec::new()));
    let mut own = Prepared {
        recording: recording.clone(),
        stands_in: Vec::new(),
        unknown: Vec::new(),
        leaps: Vec::new(),
        scale: None,
        logged_s: Vec::new(),
        curved: !curved.is_empty(),
        notes: curved::told(&curved),
    };
    let (mut whole, mut partly, mut out): (Vec<String>, Vec<String>, Vec<String>) = Default::default();
    own.recording.runs.clear();
    let mut sparse: Vec<Sparse> = Vec::new();
    let (mut runs, mut unknown): (Vec<RecordedRun>, Vec<Vec<bool>>) = Default::default();
    let mut leapt: Vec<Vec<(usize, usize)>> = Vec::new();
    let mut rare: Vec<String> = Vec::new();
    for run in &recording.runs {
        let thin = thinned(&run.trace, speed(&run.trace))?;
        if thin.is_some() {
            rare.push(run.id.clone());
        }
        let (trace, own) = settled(thin.as_ref().unwrap_or(&run.trace))?;
        let made = filled(&trace, |_| true)?;
        sparse.extend(made.sparse);
        unknown.push(made.unknown);
        leapt.push(own);
        runs.push(RecordedRun { trace: made.trace, ..run.clone() });
    }
    own.scale = scale(&runs);
    if let Some(scale) = own.scale.filter(|scale| wrong && scale.is_wrong()) {
        for run in &mut runs {
            run.trace = with_speed(&run.trace, |speed| speed / (1.0 + scale.value))?;
        }
    }
    let logged = recording.runs.iter().map(|run| run.trace.time_s().to_vec());
    for ((run, logged_s), (unknown, leapt)) in runs.iter().zip(logged).zip(unknown.into_iter().zip(leapt)) {
        let Some(stands_in) = standing_in(&run.trace) else {
            out.push(run.id.clone());
            continue;
        };
        let mut run = run.clone();
        if stands_in.contains(&true) {
            run.trace = with_stand_in(&run.trace, &stands_in)?;
            if stands_in.contains(&false) { &mut partly } else { &mut whole }.push(run.id.clone());
            own.stands_in.push(stands_in);
        } else {
            own.stands_in.push(Vec::new());
        }
        own.recording.runs.push(run);
        own.logged_s.push(logged_s);
        own.unknown.push(unknown);
        own.leaps.push(leapt);
    }
    if own.recording.runs.is_empty() {
        return Err(match recording.runs.first() {
            Some(run) => no_speed(run).into(),
            None => StudyError::AllHeldOut.into(),
        });
    }
    own.notes.extend(told(&rare, "the speed is new in one row of several; only those are looked at"));
    own.notes.extend(sparse::told(&sparse));
    let leapt: Vec<String> = own
        .recording
        .runs
        .iter()
        .zip(&own.leaps)
        .filter(|(_, leaps)| !leaps.is_empty())
        .map(|(run, _)| run.id.clone())
        .collect();
    own.notes.extend(told(
        &leapt,
        "speed leaps to where no vehicle can get and back; nothing is told by it there",
    ));
    own.notes.extend(laid::told(&laid::lay(&mut own.recording.runs)?));
    own.notes
        .extend(told(&whole, "no speed over ground was recorded; the speed of the wheels stands in for it"));
    own.notes.extend(told(
        &partly,
        "speed over ground is missing in places; there the speed of the wheels stands in for it",
    ));
    own.notes.extend(told(&out, "no speed was recorded, neither over ground nor of the wheels; left out"));
    Ok(own)
}

/// A run whose speed (that of its wheels where there is no other) has no value where no vehicle can have it, and where that is.
fn settled(trace: &Trace) -> Result<(Trace, Vec<(usize, usize)>), DiagnoseError> {
    let name = speed(trace);
    let leaps = leaps(trace, name);
    if leaps.is_empty() {
        return Ok((trace.clone(), leaps));
    }
    Ok((with_channel(trace, name, without(trace, name, &leaps))?, leaps))
}

/// The speed that moves a run: over ground, or of the wheels where there is no other.
fn speed(trace: &Trace) -> &'static str {
    if trace.get(OVER_GROUND).is_some() { OVER_GROUND } else { OF_WHEELS }
}

/// A run with its speed over ground changed, where it has one.
fn with_speed(trace: &Trace, change: impl Fn(f64) -> f64) -> Result<Trace, DiagnoseError> {
    let Some(speed) = trace.get(OVER_GROUND) else { return Ok(trace.clone()) };
    with_channel(trace, OVER_GROUND, speed.iter().map(|speed| change(*speed)).collect())
}

/// Samples whose speed over ground is missing where that of the wheels is known; none where nothing can drive the run.
fn standing_in(trace: &Trace) -> Option<Vec<bool>> {
    let known = |name: &str| -> Vec<bool> {
        trace.get(name).map_or_else(
            || vec![false; trace.len()],
            |values| values.iter().map(|one| one.is_finite()).collect(),
        )
    };
    let count = |known: &[bool]| known.iter().filter(|known| **known).count();
    let (ground, wheels) = (known(OVER_GROUND), known(OF_WHEELS));
    let has_ground = count(&ground) >= FEWEST;
    if count(&wheels) < FEWEST {
        return has_ground.then(|| vec![false; trace.len()]);
    }
    if !has_ground {
        return Some(vec![true; trace.len()]);
    }
    let mut stands_in = vec![false; trace.len()];
    let time_s = trace.time_s();
    let mut from = 0;
    while from < ground.len() {
        let to = (from..ground.len()).find(|index| ground[*index] != ground[from]).unwrap_or(ground.len());
        if !ground[from] && time_s[to - 1] - time_s[from] >= LASTS_S {
            stands_in[from..to].copy_from_slice(&wheels[from..to]);
        }
        from = to;
    }
    Some(stands_in)
}

/// The trace with the speed of the wheels where it stands in for that over ground.
pub fn with_stand_in(trace: &Trace, stands_in: &[bool]) -> Result<Trace, DiagnoseError> {
    let mut made = trace.clone();
    let wheels = trace.get(OF_WHEELS).unwrap_or(&[]);
    let ground = made.remove(OVER_GROUND);
    let origin = ground.as_ref().map_or(Origin::Measured, |ground| ground.origin);
    let own = |index: usize| ground.as_ref().map_or(f64::NAN, |ground| ground.values[index]);
    let speed = stands_in
        .iter()
        .enumerate()
        .map(|(index, stands_in)| if *stands_in { wheels[index] } else { own(index) })
        .collect();
    made.push(OVER_GROUND, speed, origin)?;
    Ok(made)
}

fn told(runs: &[String], what: &str) -> Option<String> {
    (!runs.is_empty()).then(|| format!("In {} {what}.", runs.join(", ")))
}

fn no_speed(run: &RecordedRun) -> StudyError {
    StudyError::NoSpeed {
        run: run.id.clone(),
        there: run.trace.get(OVER_GROUND).is_some(),
        measured: run.trace.channels().iter().map(|channel| channel.name.clone()).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace(speed: Option<&[f64]>, wheels: Option<&[f64]>) -> Trace {
        let count = speed.or(wheels).unwrap_or(&[]).len();
        let mut trace = Trace::new((0..count).map(|index| index as f64).collect()).unwrap();
        for (name, values) in [(OVER_GROUND, speed), (OF_WHEELS, wheels)] {
            if let Some(values) = values {
                trace.push(name, values.to_vec(), Origin::Measured).unwrap();
            }
        }
        trace
    }

    #[test]
    fn wheels_stand_in_for_a_speed_that_was_not_recorded_and_not_for_a_short_gap() {
        let wheels = [2.0; 40];
        assert_eq!(standing_in(&trace(None, Some(&wheels))), Some(vec![true; 40]));
        assert_eq!(standing_in(&trace(Some(&[f64::NAN; 40]), Some(&wheels))), Some(vec![true; 40]));
        assert_eq!(standing_in(&trace(Some(&wheels), None)), Some(vec![false; 40]));
        assert_eq!(standing_in(&trace(Some(&[f64::NAN; 40]), None)), None);
        let mut ground = [1.8; 40];
        ground[3..6].fill(f64::NAN);
        ground[15..40].fill(f64::NAN);
        let own = trace(Some(&ground), Some(&wheels));
        let stands_in = standing_in(&own).unwrap();
        assert!(!stands_in[4] && stands_in[15] && stands_in[39] && !stands_in[14]);
        let made = with_stand_in(&own, &stands_in).unwrap();
        let speed = made.get(OVER_GROUND).unwrap();
        assert!(speed[4].is_nan() && speed[14] == 1.8 && speed[15] == 2.0);
    }
}
