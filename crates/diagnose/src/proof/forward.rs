//! Runs driven forward: the speed that a scenario makes of what drove them, against the one that was recorded.
//!
//! A long run is driven in windows that each begin with the recorded speed, so that nothing drifts away. Where a force falls with
//! speed, as friction does that breaks loose, two speeds that begin next to each other part: the window is then no longer than
//! they take to be a few times as far apart, and the force is what is judged and not the luck of the first sample.

use crate::causes::catalogue::LawText;
use crate::proof::prove::{Errors, improved};
use crate::proof::refine::Refined;
use crate::runs::recorded::Recorded;
use crate::{Case, DiagnoseError};
use headland_calibrate::statistics::mean;
use headland_sim::{Model, Replay, replay};
use headland_trace::Channel;
use rayon::prelude::*;

/// Longest window in which a long run is driven forward [s].
const WINDOW_S: f64 = 30.0;

/// Shortest one [s].
const SHORTEST_S: f64 = 2.0;

/// The window that a run is driven forward in [s]; none of one that is driven as a whole.
pub fn usual_window_s(run: &Recorded) -> Option<f64> {
    let long = run.measured.trace.duration_s() > 2.0 * WINDOW_S;
    run.measured.how.window_s.or(long.then_some(WINDOW_S))
}

/// The same of every run with what was found.
pub fn windows_s(
    case: &Case,
    runs: &[Recorded],
    refined: &Refined,
) -> Result<Vec<Option<f64>>, DiagnoseError> {
    /// Two speeds that begin next to each other are no further apart at the end than so many times that, as root mean squares.
    const APART: f64 = 2.0;
    let of_run = |place: usize| {
        let run = &runs[place];
        let mut window_s = usual_window_s(run);
        while parts(case, run, refined, (place, window_s))?.is_some_and(|times| times > APART) {
            let shorter = 0.5 * window_s.unwrap_or(run.measured.trace.duration_s());
            if shorter < SHORTEST_S {
                break;
            }
            window_s = Some(shorter);
        }
        Ok(window_s)
    };
    (0..runs.len()).into_par_iter().map(of_run).collect()
}

/// Shorter windows of runs whose forces agree with a law of the place, or one that remembers, row by row, and whose speed driven forward
/// is hardly nearer with that law than without: a vehicle that is caught where the recorded one just passed, or the other way round, says
/// nothing of what pushed it before. What else there is leads no vehicle elsewhere. `rows` are the errors of the balance, which hold more
/// of the noise.
pub fn agreeing(
    case: &Case,
    runs: &[Recorded],
    refined: &Refined,
    mut windows_s: Vec<Option<f64>>,
    rows: &[Errors],
) -> Result<Vec<Option<f64>>, DiagnoseError> {
    /// Share of an error beyond which it is hardly less.
    const HARDLY: f64 = 0.5;
    /// And below which a balance is closed for the greater part.
    const CLOSED: f64 = 0.7;
    let mut lawless = refined.clone();
    lawless.causes.retain(|cured| !cured.cause.law.as_ref().is_some_and(LawText::leads_elsewhere));
    loop {
        let forward = speeds(case, runs, refined, &windows_s)?;
        let without = speeds(case, runs, &lawless, &windows_s)?;
        let mut any = false;
        for (place, ((forward, without), rows)) in forward.iter().zip(&without).zip(rows).enumerate() {
            let half_s = 0.5 * windows_s[place].unwrap_or(runs[place].measured.trace.duration_s());
            let open = rows.after / rows.before;
            let agrees = open < CLOSED && forward.after > HARDLY.max(open) * without.after;
            if agrees && half_s >= SHORTEST_S {
                windows_s[place] = Some(half_s);
                any = true;
            }
        }
        if !any {
            return Ok(windows_s);
        }
    }
}

/// By how many times two speeds part on the way, as a root mean square; none where the run cannot be driven forward.
fn parts(
    case: &Case,
    run: &Recorded,
    refined: &Refined,
    (place, window_s): (usize, Option<f64>),
) -> Result<Option<f64>, DiagnoseError> {
    /// By so much the two begin apart [m/s].
    const BEGIN_M_S: f64 = 0.05;
    let Some(drive) = run.shown_forward() else { return Ok(None) };
    let model = case.study.model_of(&improved(case, refined, place)?, &run.measured, &refined.values())?;
    let how = Replay { drive, window_s, ..run.measured.how.clone() };
    let own = modelled(&model, run, &how)?;
    let mut most: Option<f64> = None;
    // What a faster vehicle passes may hold a slower one.
    for begin_m_s in [-BEGIN_M_S, BEGIN_M_S] {
        let mut beside = run.clone();
        let trace = &mut beside.measured.trace;
        let Some(Channel { name, values, origin }) = trace.remove("speed_m_s") else { return Ok(None) };
        let moved = values.iter().map(|speed| speed + begin_m_s).collect();
        let Ok(()) = trace.push(name, moved, origin) else { return Ok(None) };
        let other = modelled(&model, &beside, &how)?;
        let apart = own.iter().zip(&other).map(|(one, other)| ((other - one) / begin_m_s).powi(2));
        let apart: Vec<f64> = apart.filter(|square| square.is_finite()).collect();
        let times = (!apart.is_empty()).then(|| mean(&apart).sqrt());
        most = most.into_iter().chain(times).reduce(f64::max);
    }
    Ok(most)
}

/// The speed that a model makes of what drove a run, sample by sample [m/s].
pub fn modelled(model: &Model, run: &Recorded, how: &Replay) -> Result<Vec<f64>, DiagnoseError> {
    let failed = |error| DiagnoseError::Replay { run: run.measured.id.clone(), error };
    let trace = replay(model, &run.measured.trace, how).map_err(failed)?.trace;
    Ok(trace.get("speed_m_s").unwrap_or(&[]).to_vec())
}

/// Errors of the speed, driven forward with the nominal scenario and with what was found.
pub fn speeds(
    case: &Case,
    runs: &[Recorded],
    refined: &Refined,
    windows_s: &[Option<f64>],
) -> Result<Vec<Errors>, DiagnoseError> {
    let rmse = |model: &Model, run: &Recorded, how: &Replay| -> Result<f64, DiagnoseError> {
        let followed = run.measured.how.followed(&run.measured.trace);
        let sound =
            |index: usize| !followed[index] && case.sound.get(run.number).is_none_or(|sound| sound[index]);
        let measured = run.measured.trace.get("speed_m_s").unwrap_or(&[]);
        let modelled = modelled(model, run, how)?;
        let speeds = modelled.iter().zip(measured).enumerate();
        let squares: Vec<f64> = speeds
            .filter(|(index, _)| sound(*index))
            .map(|(_, (one, other))| (one - other).powi(2))
            .filter(|value| value.is_finite())
            .collect();
        Ok((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
    };
    (0..runs.len())
        .into_par_iter()
        .map(|place| {
            let (before, after) = (&case.raw[place], &runs[place]);
            let Some(drive) = after.shown_forward() else {
                return Ok(Errors { before: f64::NAN, after: f64::NAN });
            };
            let nominal = case.study.model(&before.measured, &case.study.priors())?;
            let scenario = improved(case, refined, place)?;
            let cured = case.study.model_of(&scenario, &after.measured, &refined.values())?;
            let how = Replay { drive, window_s: windows_s[place], ..after.measured.how.clone() };
            Ok(Errors { before: rmse(&nominal, before, &how)?, after: rmse(&cured, after, &how)? })
        })
        .collect()
}

/// What the description says of the speed sensor, or the scatter about the local fit.
pub fn speed_noise(case: &Case) -> f64 {
    let mut squares = 0.0;
    let mut count = 0usize;
    for drive in &case.raw {
        if let Some(speed) = drive.measured.trace.get("speed_m_s") {
            for (measured, smooth) in speed.iter().zip(&drive.motion.value) {
                let error = (measured - smooth).powi(2);
                if error.is_finite() {
                    squares += error;
                    count += 1;
                }
            }
        }
    }
    (squares / count.max(1) as f64).sqrt()
}
