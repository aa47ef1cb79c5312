//! The signal itself, before and after, in the runs that prove it.

use super::Shown;
use crate::balances::balance::{FUEL_J_KG, Kind};
use crate::causes::sensors::corrected;
use crate::choosing::search::Found;
use crate::proof::forward::modelled;
use crate::proof::prove::{Proof, improved};
use crate::proof::refine::Refined;
use crate::runs::recorded::Recorded;
use crate::{Case, DiagnoseError, System};
use headland_sim::Replay;
use rayon::prelude::*;

/// So many runs are shown.
const SHOWN: usize = 6;

/// The runs that were held out, or the first of those fitted where none was.
pub fn shown(
    case: &Case,
    system: &System,
    found: Option<&Found>,
    refined: &Refined,
    proof: &Proof,
) -> Result<Vec<Shown>, DiagnoseError> {
    let bearing = || (0..case.runs.len()).filter(|run| case.bears[*run]);
    let any = bearing().any(|run| !case.fit[run]);
    let chosen: Vec<usize> = bearing().filter(|run| !any || !case.fit[*run]).take(SHOWN).collect();
    let mut sound = case.raw.clone();
    for (id, value) in refined.artefacts() {
        sound = corrected(&sound, id, value)?;
    }
    if proof.signal != Kind::Motion.signal() {
        let Some(found) = found else { return Ok(Vec::new()) };
        return Ok(chosen
            .iter()
            .filter_map(|run| of_rows(case, system, found, proof.signal, (*run, &sound[*run])))
            .collect());
    }
    let all = chosen.into_par_iter().map(|run| of_speed(case, &sound[run], refined, (run, proof)));
    Ok(all.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

fn of_speed(
    case: &Case,
    after: &Recorded,
    refined: &Refined,
    (run, proof): (usize, &Proof),
) -> Result<Option<Shown>, DiagnoseError> {
    let before = &case.raw[run];
    let Some(drive) = after.shown_forward() else { return Ok(None) };
    // As the proof tells it: a picture in other windows would be one of another error.
    let how =
        |of: &Recorded| Replay { drive, window_s: proof.measure.windows_s[run], ..of.measured.how.clone() };
    let nominal = case.study.model(&before.measured, &case.study.priors())?;
    let cured = case.study.model_of(&improved(case, refined, run)?, &after.measured, &refined.values())?;
    let before_m_s = modelled(&nominal, before, &how(before))?;
    let after_m_s = modelled(&cured, after, &how(after))?;
    let measured = after.measured.trace.get("speed_m_s").map(<[f64]>::to_vec).unwrap_or_default();
    let time_s = after.measured.trace.time_s().to_vec();
    let whole = [&before_m_s, &after_m_s, &measured].iter().all(|values| values.len() == time_s.len());
    Ok(whole.then(|| Shown {
        run: after.measured.id.clone(),
        held_out: !case.fit[run],
        signal: "speed_m_s".to_owned(),
        time_s,
        measured,
        before: before_m_s,
        after: after_m_s,
    }))
}

/// A signal that nothing drives forward, from the rows of its balance: measured, and measured less what is left over.
fn of_rows(
    case: &Case,
    system: &System,
    found: &Found,
    signal: &str,
    (run, sound): (usize, &Recorded),
) -> Option<Shown> {
    let number = system.kinds.iter().position(|kind| kind.signal() == signal)?;
    let unit = if system.kinds[number] == Kind::Fuel { 1.0 / FUEL_J_KG } else { 1.0 };
    let (recorded, sound) = (case.runs[run].measured.trace.get(signal)?, sound.measured.trace.get(signal)?);
    let mut shown = Shown {
        run: case.runs[run].measured.id.clone(),
        held_out: !case.fit[run],
        signal: signal.to_owned(),
        time_s: Vec::new(),
        measured: Vec::new(),
        before: Vec::new(),
        after: Vec::new(),
    };
    for (index, chunk) in system.chunks.iter().enumerate() {
        if chunk.run != run || chunk.balance != number {
            continue;
        }
        for (row, place) in chunk.rows.iter().enumerate() {
            shown.time_s.push(place.time_s);
            shown.measured.push(place.mean(sound));
            shown.before.push(place.mean(recorded) - unit * system.residual[index][row]);
            shown.after.push(place.mean(sound) - unit * found.left[index][row]);
        }
    }
    Some(shown)
}
