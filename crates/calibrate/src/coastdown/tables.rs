//! One row a run, one row a pair.

use super::fit::Fitted;
use super::motion::{Air, Motion, Term};
use super::report::{PairRow, RunRow};
use super::segment::Coast;

/// What a run says for itself, beside the pool of the road load and, where there is one, of the speed law.
pub fn runs(
    coasts: &[Coast],
    paths: &[Option<String>],
    road_load: &Fitted,
    law: Option<&Fitted>,
) -> Vec<RunRow> {
    let motion = Motion { terms: &road_load.terms, parameters: &road_load.parameters, air: Air::WindOnly };
    coasts
        .iter()
        .enumerate()
        .map(|(index, coast)| {
            let (offset, offset_sd) = road_load.offsets[index];
            let pooled = mean(coast, |at| motion.resistance_n(coast, coast.ambient[at], coast.speed_m_s[at]));
            let law = law.map(|law| coefficients(coast, law, index));
            RunRow {
                run: coast.id.clone(),
                path: paths[coast.path].clone(),
                reversed: coast.sign < 0.0,
                from_s: coast.from_s,
                duration_s: coast.duration_s(),
                samples: coast.time_s.len(),
                initial_m_s: road_load.initial_m_s[index],
                last_m_s: coast.last_m_s(),
                apparent_resistance_n: pooled + offset * coast.weight_n(),
                offset,
                offset_sd,
                offset_in_sd: offset / offset_sd.hypot(road_load.noise.between_runs),
                c_w: law.map(|(own, _)| own),
                c_w_apparent: law.map(|(_, apparent)| apparent),
                rms_m_s: road_load.rms_m_s[index],
            }
        })
        .collect()
}

/// c_w of one run: with the asymmetry of its path taken out, and with it left in.
fn coefficients(coast: &Coast, law: &Fitted, index: usize) -> (f64, f64) {
    let Some(Term::Rolling { scale_m_s }) = law.terms.first() else { return (f64::NAN, f64::NAN) };
    let per_coefficient = mean(coast, |at| coast.weight_n() * (1.0 + coast.speed_m_s[at] / scale_m_s));
    let directional: Vec<Term> = law.terms[1..].to_vec();
    let calm = Coast {
        half_density_drag_area_kg_m: coast.half_density_drag_area_kg_m,
        ambient: vec![super::segment::Ambient::default(); coast.ambient.len()],
        ..coast.clone()
    };
    let motion = Motion { terms: &directional, parameters: &law.parameters[1..], air: Air::WindOnly };
    let asymmetry = mean(coast, |at| motion.resistance_n(&calm, calm.ambient[at], calm.speed_m_s[at]));
    let own = law.parameters[0] + law.offsets[index].0;
    (own, own + asymmetry / per_coefficient)
}

/// Each run along a path with the unused run against it whose initial speed is nearest.
pub fn pairs(coasts: &[Coast], rows: &[RunRow], road_load: &Fitted) -> Vec<PairRow> {
    let mut used = vec![false; coasts.len()];
    let mut pairs = Vec::new();
    for (index, coast) in coasts.iter().enumerate().filter(|(_, coast)| coast.sign > 0.0) {
        let distance = |other: usize| (rows[other].initial_m_s - rows[index].initial_m_s).abs();
        let free = (0..coasts.len())
            .filter(|other| coasts[*other].sign < 0.0 && coasts[*other].path == coast.path && !used[*other]);
        let Some(other) = free.min_by(|left, right| distance(*left).total_cmp(&distance(*right))) else {
            continue;
        };
        // A run from another speed is no partner: its resistance differs for other reasons than its direction.
        if distance(other) > 0.25 * rows[index].initial_m_s {
            continue;
        }
        used[other] = true;
        let speeds = common_speeds(&coasts[index], &coasts[other]);
        let resistance = |at: usize| apparent_n(&coasts[at], road_load, at, &speeds);
        pairs.push(pair(
            [&coasts[index], &coasts[other]],
            [&rows[index], &rows[other]],
            [resistance(index), resistance(other)],
            speeds.iter().sum::<f64>() / speeds.len() as f64,
        ));
    }
    pairs
}

/// Speeds that both runs went through: a run uphill is soon slow, and its mean resistance is not that of one downhill.
fn common_speeds(one: &Coast, other: &Coast) -> Vec<f64> {
    let high = one.speed_m_s[0].min(other.speed_m_s[0]);
    let low = one.last_m_s().max(other.last_m_s()).min(high);
    (0..=10).map(|part| low + (high - low) * 0.1 * f64::from(part)).collect()
}

/// Mean resistance of one run over some speeds, whatever its cause.
fn apparent_n(coast: &Coast, road_load: &Fitted, index: usize, speeds: &[f64]) -> f64 {
    let motion = Motion { terms: &road_load.terms, parameters: &road_load.parameters, air: Air::WindOnly };
    let ambient = coast.ambient[coast.ambient.len() / 2];
    let sum: f64 = speeds.iter().map(|speed| motion.resistance_n(coast, ambient, *speed)).sum();
    sum / speeds.len() as f64 + road_load.offsets[index].0 * coast.weight_n()
}

fn pair(coasts: [&Coast; 2], rows: [&RunRow; 2], resistance_n: [f64; 2], speed_m_s: f64) -> PairRow {
    let [forward, reversed] = rows;
    let asymmetry_n = 0.5 * (resistance_n[0] - resistance_n[1]);
    let weight = 0.5 * (coasts[0].weight_n() + coasts[1].weight_n());
    let k = coasts[0].half_density_drag_area_kg_m.filter(|k| *k > 0.0);
    PairRow {
        forward: forward.run.clone(),
        reversed: reversed.run.clone(),
        resistance_n: 0.5 * (resistance_n[0] + resistance_n[1]),
        asymmetry_n,
        as_grade: asymmetry_n / weight,
        as_headwind_m_s: k.map(|k| asymmetry_n / (2.0 * k * speed_m_s)),
        c_w: forward.c_w_apparent.zip(reversed.c_w_apparent).map(|(one, other)| 0.5 * (one + other)),
    }
}

/// Mean over the samples of a run.
fn mean(coast: &Coast, value: impl Fn(usize) -> f64) -> f64 {
    let samples = coast.time_s.len();
    (0..samples).map(value).sum::<f64>() / samples as f64
}
