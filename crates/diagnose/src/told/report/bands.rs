//! How sure a reconstructed effect is, sample by sample.

use crate::causes::catalogue::Form;
use crate::causes::profile::Function;
use crate::proof::prove::{Reconstructed, reconstruct};
use crate::proof::refine::{Cured, HALF_95, Refined};
use crate::runs::recorded::Recorded;
use crate::{Case, DiagnoseError, System};

/// Half widths of the 95 % band of an effect, run by run, in the unit of the effect.
#[derive(Clone, Debug)]
pub struct Banded {
    /// One series for each run.
    pub half: Vec<Vec<f64>>,
}

/// Where a function is smaller than this share of its greatest value, its effect is too small to be divided by it.
const TOO_SMALL: f64 = 1e-3;

/// The band of an effect; none where nothing is known of it.
pub fn band(
    case: &Case,
    system: &System,
    cured: &Cured,
    refined: &Refined,
    effect: &Reconstructed,
) -> Result<Option<Banded>, DiagnoseError> {
    if !cured.events.is_empty() {
        return Ok(Some(of_spells(case, cured)));
    }
    match cured.along().function() {
        Some(function) => Ok(Some(of_function(case, cured, function, effect))),
        None => of_parameters(case, system, cured, refined, effect),
    }
}

fn of_spells(case: &Case, cured: &Cured) -> Banded {
    let of_run = |(run, drive): (usize, &Recorded)| -> Vec<f64> {
        let at = |time: &f64| {
            let inside = cured
                .events
                .iter()
                .filter(|event| event.run == run && (event.from_s..event.to_s).contains(time));
            inside.map(|event| (HALF_95 * event.sd_n).powi(2)).sum::<f64>().sqrt()
        };
        drive.measured.trace.time_s().iter().map(at).collect()
    };
    Banded { half: case.runs.iter().enumerate().map(of_run).collect() }
}

/// The deviations at the knots, times what a function of one would do: the effect over the function's value.
fn of_function(case: &Case, cured: &Cured, function: &Function, effect: &Reconstructed) -> Banded {
    let over_position = cured.cause.form == Form::OverPosition;
    let values = function.values.iter().flat_map(|(values, _)| values.iter());
    let greatest = values.fold(0.0_f64, |most, value| most.max(value.abs()));
    // Its standard deviation where its value is looked up.
    let sds = Function {
        values: function.values.iter().map(|(_, sd)| (sd.clone(), sd.clone())).collect(),
        ..function.clone()
    };
    let half = case.runs.iter().zip(&effect.runs).map(|(drive, samples)| {
        let time_s = drive.measured.trace.time_s();
        let group = function.group_of(cured.cause.form, drive);
        let at = |index: usize| if over_position { drive.position_m[index] } else { time_s[index] };
        let mut unit: Vec<f64> = samples
            .iter()
            .enumerate()
            .map(|(index, sample)| {
                let value = function.value(group, at(index));
                if value.abs() > TOO_SMALL * greatest { (sample / value).abs() } else { f64::NAN }
            })
            .collect();
        hold(&mut unit);
        let band = |(index, unit): (usize, &f64)| HALF_95 * unit * sds.value(group, at(index));
        unit.iter().enumerate().map(band).collect()
    });
    Banded { half: half.collect() }
}

/// Values that are not known are those before them, or the first that is.
fn hold(values: &mut [f64]) {
    let mut last = values.iter().copied().find(|value| value.is_finite()).unwrap_or(0.0);
    for value in values {
        if value.is_finite() {
            last = *value;
        } else {
            *value = last;
        }
    }
}

/// Each parameter moved to an end of its interval; what that changes adds up as squares, as if they were independent.
fn of_parameters(
    case: &Case,
    system: &System,
    cured: &Cured,
    refined: &Refined,
    effect: &Reconstructed,
) -> Result<Option<Banded>, DiagnoseError> {
    let mut squares: Vec<Vec<f64>> = effect.runs.iter().map(|run| vec![0.0; run.len()]).collect();
    let mut any = false;
    for (index, (value, [low, high])) in cured.values.iter().enumerate() {
        let half = 0.5 * (high - low);
        if !(half.is_finite() && half > 0.0) {
            continue;
        }
        any = true;
        // To the other end where the effect can be no more: the band is as wide on both sides.
        let to = |value: f64| {
            let mut moved = cured.clone();
            moved.values[index].0 = value;
            reconstruct(case, system, &moved, refined)
        };
        let there = match to(value + half) {
            Err(DiagnoseError::Interrupted) => return Err(DiagnoseError::Interrupted),
            Err(_) => to(value - half)?,
            Ok(there) => there,
        };
        for (squares, (there, here)) in squares.iter_mut().zip(there.runs.iter().zip(&effect.runs)) {
            for (square, (there, here)) in squares.iter_mut().zip(there.iter().zip(here)) {
                *square += (there - here).powi(2);
            }
        }
    }
    let half = |run: &Vec<f64>| run.iter().map(|square| square.sqrt()).collect();
    Ok(any.then(|| Banded { half: squares.iter().map(half).collect() }))
}
