//! What is written beside the answer: effects along the runs, corrections of channels, what the balances leave over.

use super::LeftOver;
use super::bands::Banded;
use super::finding::late;
use crate::choosing::search::Found;
use crate::proof::prove::{Proof, Reconstructed, forces_n};
use crate::proof::refine::{Cured, Refined};
use crate::{Case, DiagnoseError, System};
use headland_trace::{Origin, Run, Trace};

/// Every effect along every run, with its 95 % band where one is known, in every row of the logs; one that a power showed is told
/// as the force that it is as well.
pub fn effects(
    case: &Case,
    (proof, refined): (&Proof, &Refined),
    bands: &[Option<Banded>],
) -> Result<Vec<Run>, DiagnoseError> {
    let force = |(cured, effect): (&Cured, &Reconstructed)| match effect.unit {
        "w" => forces_n(case, &cured.along(), refined),
        _ => Ok(None),
    };
    let forces = refined.causes.iter().zip(&proof.effects).map(force).collect::<Result<Vec<_>, _>>()?;
    let mut runs = Vec::new();
    for (index, drive) in case.runs.iter().enumerate() {
        let mut trace = Trace::new(drive.measured.trace.time_s().to_vec())?;
        for ((effect, forces_n), band) in proof.effects.iter().zip(&forces).zip(bands) {
            let name = format!("{}_{}", effect.id, effect.unit);
            if trace.get(&name).is_some() {
                continue;
            }
            trace.push(name.clone(), effect.runs[index].clone(), Origin::Predicted)?;
            if let Some(band) = band {
                let side = |sign: f64| -> Vec<f64> {
                    let both = effect.runs[index].iter().zip(&band.half[index]);
                    both.map(|(value, half)| value + sign * half).collect()
                };
                trace.push(format!("{name}_low"), side(-1.0), Origin::Predicted)?;
                trace.push(format!("{name}_high"), side(1.0), Origin::Predicted)?;
            }
            let force = format!("{}_n", effect.id);
            if let (Some(forces_n), None) = (forces_n, trace.get(&force)) {
                trace.push(force, forces_n[index].clone(), Origin::Predicted)?;
            }
        }
        runs.push(Run { id: drive.measured.id.clone(), trace: in_rows(&trace, &case.logged_s[index])? });
    }
    Ok(runs)
}

/// A trace in the rows of a log; before its first sample and behind its last one it is what it is there.
fn in_rows(trace: &Trace, logged_s: &[f64]) -> Result<Trace, DiagnoseError> {
    let (Some(first), Some(last)) = (trace.time_s().first(), trace.time_s().last()) else {
        return Ok(trace.clone());
    };
    let mut made = Trace::new(logged_s.to_vec())?;
    for channel in trace.channels() {
        let at = |time: &f64| trace.at(&channel.name, time.clamp(*first, *last)).unwrap_or(f64::NAN);
        made.push(channel.name.clone(), logged_s.iter().map(at).collect(), channel.origin)?;
    }
    Ok(made)
}

/// Channel, latency [s], scale, bias.
pub fn corrections(case: &Case, refined: &Refined) -> Vec<(String, f64, f64, f64)> {
    let correction = |(id, value): (&str, f64)| match id {
        "latency" => {
            let channel = late(case, value);
            let latency_s = if channel == "speed_m_s" { value } else { -value };
            Some((channel.to_owned(), latency_s, 1.0, 0.0))
        }
        "speed_scale" => Some(("speed_m_s".to_owned(), 0.0, 1.0 + value, 0.0)),
        "force_scale" => Some(("tractive_force_n".to_owned(), 0.0, 1.0 + value, 0.0)),
        "accelerometer_bias" => Some(("specific_force_m_s2".to_owned(), 0.0, 1.0, value)),
        _ => None,
    };
    let way = case.faulty_scale().map(|scale| ("speed_scale", scale.value));
    let begins = case.late_s.map(|late_s| ("latency", late_s));
    let powers = case.late_powers.iter().map(|(name, late_s)| ((*name).to_owned(), *late_s, 1.0, 0.0));
    let others = way.into_iter().chain(begins).chain(refined.artefacts()).filter_map(correction);
    others.chain(powers).collect()
}

/// What every balance leaves over in every run.
pub fn residuals(case: &Case, system: &System, found: &Found) -> Vec<LeftOver> {
    let mut all = Vec::new();
    for (number, kind) in system.kinds.iter().enumerate() {
        for (run, recorded) in case.runs.iter().enumerate() {
            let mut one = LeftOver {
                balance: *kind,
                run: recorded.measured.id.clone(),
                held_out: !case.fit[run],
                path: recorded.path,
                reversed: recorded.measured.how.reversed_from_m.is_some(),
                time_s: Vec::new(),
                position_m: Vec::new(),
                speed_m_s: Vec::new(),
                before: Vec::new(),
                after: Vec::new(),
            };
            for (index, chunk) in system.chunks.iter().enumerate() {
                if chunk.run == run && chunk.balance == number {
                    one.time_s.extend(chunk.rows.iter().map(|row| row.time_s));
                    one.position_m.extend(chunk.rows.iter().map(|row| row.mean(&recorded.position_m)));
                    one.speed_m_s.extend(chunk.rows.iter().map(|row| row.mean(&recorded.motion.value)));
                    one.before.extend(found.before[index].iter());
                    one.after.extend(found.left[index].iter());
                }
            }
            all.push(one);
        }
    }
    all
}
