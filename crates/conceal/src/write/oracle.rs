//! The hidden physics as a scenario's effects: with it and the true parameters, a fit is as good as a fit can be.

use crate::hidden::{Law, Unlisted};
use crate::plan::Plan;
use std::f64::consts::TAU;

/// All of the laws; none where one differs from run to run, remembers, or is no effect of a motion.
pub fn oracle(laws: &[Law], plan: &Plan) -> Option<String> {
    if plan.runs.iter().any(|run| run.lane != 0) && laws.iter().any(by_place) {
        return None;
    }
    let texts: Option<Vec<String>> = laws.iter().map(|law| effect(law, plan)).collect();
    texts.map(|texts| texts.join(", "))
}

fn by_place(law: &Law) -> bool {
    use Unlisted::{FadingWave, Lug};
    matches!(law, Law::Grade { .. } | Law::SoftGround { .. } | Law::Other(FadingWave { .. } | Lug { .. }))
}

fn effect(law: &Law, plan: &Plan) -> Option<String> {
    Some(match law {
        Law::Grade { waves } => {
            let at = |x: f64| -> f64 {
                waves.iter().map(|(size, length, phase)| size * (TAU * x / length + phase).sin()).sum()
            };
            let (mut places, mut grades) = (Vec::new(), Vec::new());
            for step in -20..660 {
                // Fine enough for waves of 45 m, long enough for every lane.
                let x = 4.0 * f64::from(step);
                places.push(format!("{x:?}"));
                grades.push(format!("{:.6}", at(x)));
            }
            format!("grade(positions_m: [{}], grades: [{}])", places.join(", "), grades.join(", "))
        }
        Law::SoftGround { patches, half_wheelbase_m } => {
            let mut edges: Vec<f64> = Vec::new();
            for (from, to, _) in patches {
                for place in [from, to] {
                    edges.extend([place - half_wheelbase_m, place + half_wheelbase_m]);
                }
            }
            edges.sort_by(f64::total_cmp);
            let under = |x: f64| -> f64 {
                let axle = |x: f64| -> f64 {
                    patches.iter().filter(|(from, to, _)| x >= *from && x < *to).map(|patch| patch.2).sum()
                };
                0.5 * (axle(x - half_wheelbase_m) + axle(x + half_wheelbase_m))
            };
            let middles = edges.windows(2).map(|pair| format!("{:.6}", under(0.5 * (pair[0] + pair[1]))));
            let middles: Vec<String> = middles.collect();
            format!("soft_ground(positions_m: {edges:?}, coefficients: [{}])", middles.join(", "))
        }
        Law::PayloadChange { from_s, to_s, mass_kg } => {
            format!("payload_change(times_s: [{from_s:?}, {to_s:?}], masses_kg: [0.0, {mass_kg:?}])")
        }
        Law::RollingSpeedLaw { linear, reference_speed_m_s } => {
            formula("-c * N * (v - b_m_s) / b_m_s", &[("c", *linear), ("b_m_s", *reference_speed_m_s)])
        }
        Law::LoadDependence { coefficient, exponent, reference_mass_kg } => format!(
            "load_dependence(coefficient: {coefficient:?}, exponent: {exponent:?}, reference_mass_kg: \
             {reference_mass_kg:?})"
        ),
        Law::TyreCold { coefficient_per_k, reference_temperature_c } => format!(
            "rolling_temperature(cold_coefficient: 0.0, time_constant_s: 60.0, coefficient_per_k: \
             {coefficient_per_k:?}, reference_temperature_c: {reference_temperature_c:?})"
        ),
        Law::VariatorLoss { loss, node_m_s } => {
            format!("variator_loss(loss: {loss:?}, node_speeds_m_s: [{node_m_s:?}])")
        }
        Law::ShiftTransient { force_n, speed_m_s, width_m_s } => format!(
            "shift_transient(force_n: {force_n:?}, speeds_m_s: [{speed_m_s:?}], width_m_s: {width_m_s:?})"
        ),
        Law::Other(law) => unlisted(law)?,
        // These differ from run to run, or do nothing to a motion that was recorded.
        Law::Multipass { .. }
        | Law::Braking { .. }
        | Law::DrawbarSpells { .. }
        | Law::AuxiliarySwitched { .. }
        | Law::TurboLag { .. }
        | Law::RegenerationLimit { .. } => return None,
        _ => {
            let fields: Vec<String> =
                law.told().iter().map(|told| format!("{}: {:?}", told.name, told.value)).collect();
            format!("{}({})", law.id(), fields.join(", "))
        }
    })
    .filter(|_| plan.knows_force())
}

fn unlisted(law: &Unlisted) -> Option<String> {
    Some(match *law {
        Unlisted::FadingWave { force_n, wavelength_m, phase_rad, fade_m } => formula(
            "-a_n * sin(turns * x / wave_m + phase) * exp(-max(x, 0) / fade_m)",
            &[
                ("a_n", force_n),
                ("turns", TAU),
                ("wave_m", wavelength_m),
                ("phase", phase_rad),
                ("fade_m", fade_m),
            ],
        ),
        Unlisted::ThreeHalves { force_n, speed_m_s } => {
            formula("-a_n * (v / b_m_s) ^ 1.5", &[("a_n", force_n), ("b_m_s", speed_m_s)])
        }
        Unlisted::Sticking { force_n, speed_m_s } => {
            formula("-a_n / (1 + v / b_m_s)", &[("a_n", force_n), ("b_m_s", speed_m_s)])
        }
        Unlisted::Lug { force_n, wavelength_m } => formula(
            "-a_n * sin(turns * x / wave_m)",
            &[("a_n", force_n), ("turns", TAU), ("wave_m", wavelength_m)],
        ),
        Unlisted::Saturating { force_n, speed_m_s } => {
            formula("-a_n * (1 - exp(-v / b_m_s))", &[("a_n", force_n), ("b_m_s", speed_m_s)])
        }
        Unlisted::OneSided { force_n, side_m_s2 } => {
            formula("-a_n * max(kappa * v ^ 2, 0) / b_m_s2", &[("a_n", force_n), ("b_m_s2", side_m_s2)])
        }
        _ => return None,
    })
}

fn formula(text: &str, constants: &[(&str, f64)]) -> String {
    let constants: Vec<String> =
        constants.iter().map(|(name, value)| format!("\"{name}\": {value:?}")).collect();
    format!("expression(force: \"{text}\", constants: {{{}}})", constants.join(", "))
}
