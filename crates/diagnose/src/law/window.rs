//! The listed causes that begin and end when a law does.

use crate::causes::catalogue::{RAMP, Term};
use crate::causes::trial::{Pool, add_trial};
use crate::choosing::state::Part;
use crate::{Case, DiagnoseError, System};
use headland_symbolic::{EDGE, Law};
use std::f64::consts::TAU;

/// The listed causes that begin and end, at the times at which a law does: a formula finds edges that no grid has.
pub fn windows(case: &Case, system: &System, pool: &mut Pool, law: &Law) -> Result<Vec<Part>, DiagnoseError> {
    let Some((window, ramp)) = window_s(law, case.longest_s()) else { return Ok(Vec::new()) };
    let before = pool.trials.len();
    for (number, cause) in case.causes.iter().enumerate().filter(|(_, cause)| cause.own.is_none()) {
        let Some((from, to)) = cause.window() else { continue };
        let shaped = cause.terms.iter().enumerate().filter(|(_, term)| !term.linear);
        let value = |(place, term): (usize, &Term)| match place {
            _ if place == from => Some(window[0]),
            _ if place == to => Some(window[1]),
            _ if term.name == RAMP => ramp,
            _ => None,
        };
        let shape: Option<Vec<f64>> = shaped.map(value).collect();
        if let Some(shape) = shape.filter(|shape| cause.possible(shape)) {
            add_trial(case, system, pool, number, &shape)?;
        }
    }
    Ok(pool.trials[before..].iter().map(|trial| Part { trial: trial.clone(), spread: None }).collect())
}

/// When a law sets in and ends, and how long its edges take [s]: at two steps, about the middle of one bump, or where what goes on and off
/// again and again is on only once in runs of this length. A straight line through the middle of tanh(t / s) takes 2 s.
fn window_s(law: &Law, longest_s: f64) -> Option<([f64; 2], Option<f64>)> {
    let has = |text: String| law.text.contains(&text);
    let middles: Vec<usize> =
        (0..law.constants.len()).filter(|at| has(format!("(t - {})", law.constants[*at].name))).collect();
    let value = |at: usize| law.constants.get(at).map(|constant| constant.value);
    match middles[..] {
        [middle] if law.terms == 1 && has(" - level".to_owned()) => {
            let (middle_s, period_s, level) = (value(middle)?, value(middle + 1)?, value(middle + 2)?);
            on_once_s(middle_s, period_s, level, longest_s)
        }
        _ if law.names("sin") => None,
        [one, other] => {
            let times = [value(one)?.min(value(other)?), value(one)?.max(value(other)?)];
            let soft = |middle: usize| has(format!("tanh((t - {}) /", law.constants[middle].name));
            let edges = [one, other].map(|middle| value(middle + 1).filter(|_| soft(middle)));
            Some((times, edges[0].zip(edges[1]).map(|(one, other)| one.abs() + other.abs())))
        }
        [middle] => {
            let (about_s, width) = (value(middle)?, law.constants.get(middle + 1)?);
            let bump = has(format!("((t - {}) / {})^2", law.constants[middle].name, width.name));
            bump.then_some(([about_s - width.value, about_s + width.value], None))
        }
        _ => None,
    }
}

/// When sin(2π (t − t₁) / t₂) is above a level in runs of this length, where that is once.
fn on_once_s(middle_s: f64, period_s: f64, level: f64, longest_s: f64) -> Option<([f64; 2], Option<f64>)> {
    if !(-1.0..1.0).contains(&level) || period_s <= 0.0 {
        return None;
    }
    let rises = level.asin() / TAU;
    let [from_s, to_s] = [rises, 0.5 - rises].map(|turn| middle_s + turn * period_s);
    let first = (-to_s / period_s).floor() + 1.0;
    let [from_s, to_s] = [from_s, to_s].map(|at_s| at_s + first * period_s);
    let slope = TAU / period_s * (1.0 - level * level).sqrt();
    let ramp_s = 2.0 / (EDGE * slope);
    (from_s < longest_s && from_s + period_s >= longest_s).then_some(([from_s, to_s], Some(ramp_s)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::sound::law;

    #[test]
    fn a_law_sets_in_and_ends_at_its_steps_or_beside_its_bump() {
        let steps = law(
            "a1_n * 0.5 * (1 + tanh((t - t1_s) / t2_s)) + a2_n * 0.5 * (1 + tanh((t - t3_s) / t4_s))",
            &[("a1_n", 5.0), ("t1_s", 29.0), ("t2_s", 0.6), ("a2_n", -5.0), ("t3_s", 13.0), ("t4_s", 0.6)],
        );
        assert_eq!(window_s(&steps, 60.0), Some(([13.0, 29.0], Some(1.2))));
        let bump = "a1_n * exp(-((t - t1_s) / t2_s)^2)";
        let told = |text: &str, constants: &[(&str, f64)]| window_s(&law(text, constants), 60.0);
        assert_eq!(told(bump, &[("a1_n", 5.0), ("t1_s", 20.0), ("t2_s", 4.0)]), Some(([16.0, 24.0], None)));
        let pulse = "a1_n * 0.5 * (1 + tanh(20 * (sin(6.28 * (t - t1_s) / t2_s) - level1)))";
        let pulsed =
            |t2_s: f64| told(pulse, &[("a1_n", 5.0), ("t1_s", 2.0), ("t2_s", t2_s), ("level1", 0.5)]);
        assert_eq!(pulsed(8.0), None);
        let ([from_s, to_s], ramp_s) = pulsed(72.0).expect("it is on once");
        assert!((from_s - 8.0).abs() < 1e-9 && (to_s - 32.0).abs() < 1e-9, "{from_s} to {to_s}");
        assert!((ramp_s.unwrap() - 72.0 / (20.0 * std::f64::consts::PI * 0.75_f64.sqrt())).abs() < 1e-9);
        assert_eq!(told("a1_n * exp(-t / t1_s)", &[("a1_n", 5.0), ("t1_s", 20.0)]), None);
    }
}
