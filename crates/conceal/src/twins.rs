//! Which other causes nobody could tell from the hidden one in the runs that were driven.
//!
//! A cause X is a twin of the hidden cause H where X at its best, with the free parameters moved within their stated
//! spreads, leaves an expected ln p of less than 3 behind H:
//!
//! ½ min (‖y − N b − X c‖² / σ² + Σ (b/sd)²) < 3        y what H does, second by second; σ its balance's noise at 1 s
//!
//! So brake drag, rolling resistance and a slope are twins where one lane is driven one way, and are none where it is
//! driven both ways. σ counts white noise only: real sensors also drift, so that fewer pairs are called twins than are.
//! Source: expected log-likelihood ratio of nested Gaussian models; Cox, *JRSS B* 24 (1962) 406.
//! Functions of place and of time (`grade`, `soft_ground`, `payload_change`) are never twins of a constant, though they
//! hold it: who names them says more than the runs can show. Two pairs are twins by what they are: forces in spells of
//! single runs are brakes or a pull at the hitch, and where the drive may not brake, brakes do.

use crate::hidden::Law;
use crate::plan::Plan;
use crate::plant::Sample;

/// ln p that has to part two causes.
pub const APART: f64 = 3.0;

/// A second of a run, on average.
#[derive(Clone, Debug, Default)]
pub(crate) struct Second {
    pass: f64,
    way: f64,
    time_s: f64,
    speed: f64,
    acceleration: f64,
    heading: f64,
    curvature: f64,
    drive_n: f64,
    coasting: f64,
    load_n: f64,
    air_speed_2: f64,
    air_c: f64,
    engine: f64,
    source_per_n: f64,
    current: f64,
    /// What each hidden cause does.
    hidden: Vec<f64>,
}

/// Seconds of a run that is fitted.
pub(crate) fn seconds(samples: &[Sample], reversed: bool, passes_before: f64) -> Vec<Second> {
    const STEPS: usize = 1000;
    let mean = |chunk: &[Sample], pick: &dyn Fn(&Sample) -> f64| {
        chunk.iter().map(pick).sum::<f64>() / chunk.len() as f64
    };
    let of = |chunk: &[Sample]| Second {
        pass: passes_before,
        way: if reversed { -1.0 } else { 1.0 },
        time_s: mean(chunk, &|one| one.time_s),
        speed: mean(chunk, &|one| one.speed_m_s),
        acceleration: mean(chunk, &|one| one.acceleration_m_s2),
        heading: chunk[0].heading_rad,
        curvature: mean(chunk, &|one| one.curvature_per_m),
        drive_n: mean(chunk, &|one| one.drive_n),
        coasting: chunk[0].coasting,
        load_n: chunk[0].load_n,
        air_speed_2: mean(chunk, &|one| one.air_speed_2),
        air_c: chunk[0].air_c,
        engine: mean(chunk, &|one| one.engine_speed_rad_s),
        source_per_n: mean(chunk, &|one| one.source_per_n),
        current: mean(chunk, &|one| one.battery_current_a),
        hidden: (0..chunk[0].hidden.len()).map(|law| mean(chunk, &|one| one.hidden[law])).collect(),
    };
    samples.chunks_exact(STEPS).map(of).collect()
}

/// How much a hidden cause shows, and what it cannot be told from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// ln p that it gains over the free parameters alone.
    pub evidence: f64,
    /// Contract's ids of its twins.
    pub twins: Vec<String>,
}

/// What can be seen of a law.
pub(crate) fn seen(plan: &Plan, laws: &[Law], which: usize, seconds: &[Second]) -> Seen {
    let law = &laws[which];
    if seconds.is_empty() || matches!(law, Law::TurboLag { .. }) {
        // What the engine could not give shows in a demand, which no log has.
        return Seen::default();
    }
    let (unit, _) = law.amount(&crate::hidden::Now::default(), 0.0);
    let mut hidden: Vec<f64> = seconds.iter().map(|one| one.hidden[which]).collect();
    let by_source = unit == "w" || (plan.vehicle.engine.is_some() && !plan.knows_force());
    let noise = match (unit, by_source) {
        ("m_s", _) => plan.second_noise("speed_m_s").hypot(plan.second_noise("wheel_speed_m_s")),
        (_, true) => plan.power_noise_w(),
        _ => plan.force_noise_n(),
    };
    if unit == "n" && by_source {
        for (value, second) in hidden.iter_mut().zip(seconds) {
            *value *= -second.source_per_n;
        }
    }
    let noise = noise.max(1e-9);
    let to_unit = |force: Vec<f64>| -> Vec<f64> {
        if by_source {
            force.iter().zip(seconds).map(|(force, second)| -force * second.source_per_n).collect()
        } else {
            force
        }
    };
    let forces = unit != "m_s";
    let mut free: Vec<(Vec<f64>, f64)> = Vec::new();
    for prior in plan.nominal.priors.iter().filter(|prior| prior.free) {
        if let Some(column) = nuisance(&prior.path, plan, seconds, by_source).filter(|_| forces) {
            let is_power = prior.path.contains("driveline");
            free.push((if is_power { column } else { to_unit(column) }, prior.sd));
        }
    }
    let evidence = left(&hidden, &free, &[], noise);
    let mut twins: Vec<String> = Vec::new();
    if evidence >= APART && forces {
        for (id, columns) in candidates(plan, seconds, by_source) {
            if id == law.id() || twins.iter().any(|twin| twin == id) {
                continue;
            }
            let is_power = POWERS.contains(&id);
            let columns: Vec<Vec<f64>> =
                columns.into_iter().map(|column| if is_power { column } else { to_unit(column) }).collect();
            if left(&hidden, &free, &columns, noise) < APART {
                twins.push(id.to_owned());
            }
        }
    }
    match law {
        Law::RegenerationLimit { .. } | Law::DrawbarSpells { .. } => twins.push("braking".to_owned()),
        Law::Braking { .. } if !plan.has("brake") => twins.push("drawbar_load".to_owned()),
        _ => {}
    }
    twins.sort();
    twins.dedup();
    Seen { evidence, twins }
}

/// Causes whose columns are powers.
const POWERS: [&str; 4] = ["engine_friction", "cold_start", "auxiliary_power", "battery_resistance"];

/// Change of the forward force, or of the power taken, for each unit of a free parameter.
fn nuisance(path: &str, plan: &Plan, seconds: &[Second], by_source: bool) -> Option<Vec<f64>> {
    let vehicle = &plan.vehicle;
    let g = vehicle.gravity_m_s2;
    let each = |of: &dyn Fn(&Second) -> f64| Some(seconds.iter().map(of).collect());
    match path.rsplit('.').next()? {
        "mass_kg" => each(&|one| -one.acceleration - g * vehicle.ground.share(one.speed)),
        "drag_area_m2" => each(&|one| -0.5 * vehicle.air_density_kg_m3 * one.air_speed_2),
        "coefficient" => {
            let level = vehicle.ground.share(0.0);
            each(&|one| -one.load_n * vehicle.ground.share(one.speed) / level)
        }
        "standby_power_w" if by_source => each(&|_| 1.0),
        "accessory_power_w" if by_source => {
            let efficiency = vehicle.engine.as_ref()?.efficiency;
            each(&|_| 1.0 / efficiency)
        }
        "drive_efficiency" if by_source => {
            let efficiency = vehicle.electric.as_ref()?.efficiency;
            each(&|one| -one.drive_n * one.speed / (efficiency * efficiency))
        }
        "willans_efficiency" if by_source => {
            let engine = vehicle.engine.as_ref()?;
            each(&|one| {
                let shaft = engine.shaft_w(one.drive_n * one.speed, 0.0) + engine.friction_n_m * one.engine;
                -shaft.max(0.0) / (engine.efficiency * engine.efficiency)
            })
        }
        _ => None,
    }
}

/// Columns of every cause that can be written with a few numbers: a forward force or a power taken, and one entry for
/// each shape that is tried.
fn candidates(plan: &Plan, seconds: &[Second], by_source: bool) -> Vec<(&'static str, Vec<Vec<f64>>)> {
    let g = plan.vehicle.gravity_m_s2;
    let ground = &plan.vehicle.ground;
    let each = |of: &dyn Fn(&Second) -> f64| -> Vec<f64> { seconds.iter().map(of).collect() };
    let longest = seconds.iter().map(|one| one.time_s).fold(1.0, f64::max);
    let mut speeds: Vec<f64> = seconds.iter().map(|one| one.speed).collect();
    speeds.sort_by(f64::total_cmp);
    let mut all: Vec<(&'static str, Vec<Vec<f64>>)> = vec![
        (
            "wind",
            vec![each(&|one| -one.speed * one.heading.cos()), each(&|one| -one.speed * one.heading.sin())],
        ),
        ("grade_constant", vec![each(&|one| -one.way * one.load_n)]),
        ("mass", vec![each(&|one| -one.acceleration - g * ground.share(one.speed))]),
        ("rotating_inertia", vec![each(&|one| -one.acceleration)]),
        ("aerodynamic_drag", vec![each(&|one| -one.air_speed_2)]),
        ("rolling_resistance", vec![each(&|one| -one.load_n)]),
        ("rolling_speed_law", vec![each(&|one| -one.load_n * one.speed), each(&|one| -one.load_n)]),
        ("brake_drag", vec![each(&|_| -1.0)]),
        ("driveline_efficiency", vec![each(&|one| -one.drive_n.abs())]),
    ];
    if plan.has("coasting") {
        all.push(("neutral_drag", vec![each(&|one| -one.coasting), each(&|one| -one.coasting * one.speed)]));
    }
    if plan.has("curvature_per_m") {
        all.push((
            "cornering_drag",
            vec![each(&|one| -(one.load_n * one.curvature).powi(2) * one.speed.powi(4))],
        ));
    }
    for step in 0..8_u8 {
        let tau = 0.05 * longest * 2f64.powi(step.into());
        let fades = |one: &Second| (-one.time_s / tau).exp();
        all.push(("rolling_temperature", vec![each(&|one| -one.load_n * fades(one))]));
        all.push((
            "driveline_temperature",
            vec![each(&|one| -fades(one)), each(&|one| -one.speed * fades(one))],
        ));
        if by_source && plan.vehicle.engine.is_some() {
            all.push(("cold_start", vec![each(&|one| one.engine * fades(one))]));
        }
        let at = speeds[(speeds.len() - 1) * (usize::from(step) + 1) / 9];
        for width in [0.1, 0.5, 2.0] {
            let over = |one: &Second| ((one.speed - at) / width).clamp(0.0, 1.0);
            all.push(("speed_threshold", vec![each(&|one| -over(one))]));
            let bell = |one: &Second| (-0.5 * ((one.speed - at) / width).powi(2)).exp();
            all.push(("shift_transient", vec![each(&|one| (one.coasting - 1.0) * bell(one))]));
        }
        let through = |one: &Second| (1.0 - one.speed / at.max(0.1)).abs().min(1.0);
        all.push(("variator_loss", vec![each(&|one| -through(one) * one.drive_n.abs())]));
        let factor = 0.5 + 0.06 * f64::from(step);
        all.push(("multipass", vec![each(&|one| -one.load_n * (factor.powf(one.pass) - 1.0))]));
        let load = seconds[0].load_n;
        let exponent = [-0.7, -0.5, -0.3, 0.3, 0.5, 0.8, 1.0, 1.2][usize::from(step)];
        all.push((
            "load_dependence",
            vec![each(&|one| -one.load_n * ((one.load_n / load).powf(exponent) - 1.0))],
        ));
        for later in step + 1..9 {
            let (from, to) = (longest * f64::from(step) / 8.0, longest * f64::from(later) / 8.0);
            let lowered = |one: &Second| f64::from(u8::from(one.time_s >= from && one.time_s < to));
            all.push((
                "drawbar_load",
                vec![each(&|one| -lowered(one)), each(&|one| -one.speed * lowered(one))],
            ));
        }
    }
    if plan.has("air_temperature_c") {
        all.push(("rolling_temperature", vec![each(&|one| -one.load_n * (20.0 - one.air_c))]));
    }
    if by_source {
        all.push(("auxiliary_power", vec![each(&|_| 1.0)]));
        if plan.has("air_temperature_c") {
            all.push(("auxiliary_power", vec![each(&|one| (18.0 - one.air_c).max(0.0))]));
        }
        if plan.vehicle.engine.is_some() {
            all.push(("engine_friction", vec![each(&|one| one.engine)]));
        } else {
            all.push(("battery_resistance", vec![each(&|one| one.current * one.current)]));
        }
    }
    all
}

/// ½ min (‖y − N b − X c‖² / σ² + Σ (b/sd)²), by the normal equations of scaled columns.
fn left(hidden: &[f64], free: &[(Vec<f64>, f64)], columns: &[Vec<f64>], noise: f64) -> f64 {
    /// Against columns that depend on each other; a prior of a million times the noise.
    const RIDGE: f64 = 1e-12;
    let rows = hidden.len();
    let mut scaled: Vec<(Vec<f64>, f64)> = Vec::new();
    for (column, sd) in free {
        scaled.push((column.iter().map(|value| value * sd / noise).collect(), 1.0));
    }
    for column in columns {
        let size = column.iter().map(|value| value * value).sum::<f64>().sqrt();
        if size > 0.0 {
            scaled.push((column.iter().map(|value| value / size).collect(), RIDGE));
        }
    }
    let y: Vec<f64> = hidden.iter().map(|value| value / noise).collect();
    let n = scaled.len();
    let mut matrix = vec![vec![0.0; n + 1]; n];
    for i in 0..n {
        for j in 0..n {
            matrix[i][j] = (0..rows).map(|row| scaled[i].0[row] * scaled[j].0[row]).sum();
        }
        matrix[i][i] += scaled[i].1;
        matrix[i][n] = (0..rows).map(|row| scaled[i].0[row] * y[row]).sum();
    }
    let solution = solve(&mut matrix);
    let mut sum = 0.0;
    for row in 0..rows {
        let said: f64 = scaled.iter().zip(&solution).map(|((column, _), value)| column[row] * value).sum();
        sum += (y[row] - said).powi(2);
    }
    let priors: f64 = scaled.iter().zip(&solution).map(|((_, ridge), value)| ridge * value * value).sum();
    0.5 * (sum + priors)
}

/// Gaussian elimination with pivots of a small system whose right side is its last column.
fn solve(matrix: &mut [Vec<f64>]) -> Vec<f64> {
    let n = matrix.len();
    for column in 0..n {
        let pivot = (column..n)
            .max_by(|a, b| matrix[*a][column].abs().total_cmp(&matrix[*b][column].abs()))
            .unwrap_or(column);
        matrix.swap(column, pivot);
        let head = matrix[column].clone();
        if head[column] == 0.0 {
            continue;
        }
        for row in matrix.iter_mut().skip(column + 1) {
            let share = row[column] / head[column];
            for (value, above) in row.iter_mut().zip(&head).skip(column) {
                *value -= share * above;
            }
        }
    }
    let mut solution = vec![0.0; n];
    for row in (0..n).rev() {
        let known: f64 = (row + 1..n).map(|column| matrix[row][column] * solution[column]).sum();
        if matrix[row][row] != 0.0 {
            solution[row] = (matrix[row][n] - known) / matrix[row][row];
        }
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dice::Dice;
    use crate::family::{Family, Needs};

    /// y = 3 with σ = 1 over 8 s is worth ½ · 72; a constant explains it whole, a free level of sd 1 but for
    /// ½ · 72 / (1 + 8).
    #[test]
    fn what_is_left_is_what_no_column_explains() {
        let y = vec![3.0; 8];
        let ones = vec![1.0; 8];
        assert!((left(&y, &[], &[], 1.0) - 36.0).abs() < 1e-9);
        assert!(left(&y, &[], std::slice::from_ref(&ones), 1.0) < 1e-6);
        assert!((left(&y, &[(ones, 1.0)], &[], 1.0) - 4.0).abs() < 1e-9);
    }

    /// Two runs of 60 s with speed and acceleration of all kinds; the hidden force is told by the way that is driven.
    fn twins_of(law: &Law, back: f64, hidden_n: impl Fn(f64) -> f64) -> Vec<String> {
        let needs = Needs { exact: true, calm: true, ..Needs::default() };
        let plan = Family::Transport.plan(&needs, &mut Dice::new(4, 0));
        let load_n = plan.vehicle.mass_kg * plan.vehicle.gravity_m_s2;
        let mut seconds = Vec::new();
        for (pass, way) in [1.0, back].into_iter().enumerate() {
            for second in 0..60 {
                let time_s = f64::from(second);
                let speed = 6.0 + 3.0 * (0.4 * time_s).sin() + (0.17 * time_s).cos();
                seconds.push(Second {
                    pass: pass as f64,
                    way,
                    time_s,
                    speed,
                    acceleration: 1.2 * (0.4 * time_s).cos() - 0.17 * (0.17 * time_s).sin(),
                    heading: if way > 0.0 { 0.3 } else { 0.3 + std::f64::consts::PI },
                    drive_n: 8000.0 * (0.4 * time_s).cos(),
                    load_n,
                    air_speed_2: speed * speed,
                    hidden: vec![hidden_n(way)],
                    ..Second::default()
                });
            }
        }
        let seen = seen(&plan, std::slice::from_ref(law), 0, &seconds);
        assert!(seen.evidence > 100.0, "{}", seen.evidence);
        seen.twins
    }

    #[test]
    fn a_slope_is_a_drag_where_a_lane_is_driven_one_way_and_none_where_it_is_driven_both_ways() {
        let slope = Law::GradeConstant { grade: 0.02 };
        let one_way = twins_of(&slope, 1.0, |way| -2000.0 * way);
        let both_ways = twins_of(&slope, -1.0, |way| -2000.0 * way);
        for id in ["brake_drag", "rolling_resistance"] {
            assert!(one_way.iter().any(|twin| twin == id), "{id} of {one_way:?}");
            assert!(!both_ways.iter().any(|twin| twin == id), "{id} of {both_ways:?}");
        }
    }

    #[test]
    fn drags_of_flat_ground_stay_twins_both_ways_and_inertia_is_none() {
        let drag = Law::BrakeDrag { force_n: 2000.0 };
        let both_ways = twins_of(&drag, -1.0, |_| -2000.0);
        assert!(both_ways.contains(&"rolling_resistance".to_owned()), "{both_ways:?}");
        for id in ["grade_constant", "rotating_inertia", "aerodynamic_drag", "wind"] {
            assert!(!both_ways.iter().any(|twin| twin == id), "{id} of {both_ways:?}");
        }
    }

    #[test]
    fn brakes_are_what_a_limit_of_the_drive_calls_for() {
        let limit = Law::RegenerationLimit { power_w: 1.0, no_speed_m_s: 0.0, full_speed_m_s: 1.0 };
        assert!(twins_of(&limit, -1.0, |_| -2000.0).contains(&"braking".to_owned()));
    }
}
