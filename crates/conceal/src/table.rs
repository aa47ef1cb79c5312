//! What a nominal model leaves over, as a table for programs that find equations in tables.
//!
//! r = M Σφ′v + R(v) + ½ ρ A v² − F          motion: what pushes forward and is not in the model [N]
//! r = P_source − P_model                    power of battery or fuel that nothing in the model takes [W]
//!
//! φ is the hat over two blocks of half a second, so that no noisy speed is differentiated: Σφ′v is the difference of two
//! block means. `acceleration_m_s2` is what the model makes of the recorded force, where there is one: the recorded one
//! and the force would give the residual back. The model is the plant's own formulation with the nominal parameters of the scenario, and the free
//! parameters come as columns of their own: what r changes by their stated spread.

use crate::case::{Case, Probe, generate};
use crate::error::ConcealError;
use crate::write::put;
use headland_trace::Run;
use std::fmt::Write;
use std::path::Path;

/// Length of a block [s].
const BLOCK_S: f64 = 0.5;

/// The table of a case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Names of the columns; `free:` are those of free parameters.
    pub columns: Vec<String>,
    /// Run, whether it is held out, and values.
    pub rows: Vec<(String, bool, Vec<f64>)>,
    /// Standard deviation of the noise of the residual, white parts only.
    pub noise: f64,
}

/// Writes the table of a case of a set, and what is hidden in it, as `case_000.csv` and `case_000.json`.
///
/// # Errors
/// As [`generate`], and [`ConcealError::File`].
pub fn export(seed: u64, case: usize, folder: &Path) -> Result<(), ConcealError> {
    let made = generate(seed, case, Probe::No)?;
    let power = on_power(&made);
    let table = table(&made, power);
    let mut text = String::from("run,held_out,");
    text.push_str(&table.columns.join(","));
    text.push('\n');
    for (run, held_out, values) in &table.rows {
        let _ = write!(text, "{run},{}", u8::from(*held_out));
        for value in values {
            let _ = write!(text, ",{value:.6e}");
        }
        text.push('\n');
    }
    std::fs::create_dir_all(folder)
        .map_err(|source| ConcealError::File { path: folder.to_owned(), source })?;
    put(&folder.join(format!("case_{case:03}.csv")), &text)?;
    let hidden: Vec<serde_json::Value> = made
        .truth
        .hidden
        .iter()
        .map(|cause| {
            serde_json::json!({"id": cause.id, "law": cause.law, "class": cause.class,
                "strength": cause.strength, "variables": variables(&cause.law)})
        })
        .collect();
    let about = serde_json::json!({
        "case": case, "kind": made.truth.kind, "family": made.truth.family, "hidden": hidden,
        "unit": if power { "W" } else { "N" }, "noise": table.noise, "block_s": BLOCK_S,
    });
    put(&folder.join(format!("case_{case:03}.json")), &format!("{about:#}\n"))
}

/// Whether the balance of power is the one to look at: where only it can be had, or where what is hidden takes power.
fn on_power(case: &Case) -> bool {
    let source = case.plan.vehicle.electric.is_some() || case.plan.vehicle.engine.is_some();
    let hidden = case.truth.hidden.iter().find(|cause| cause.class == "physics");
    source && (!case.plan.knows_force() || hidden.is_some_and(|cause| cause.column.ends_with("_w")))
}

/// The table: residual, channels, free parameters, and the hidden force or power, whose name is `hidden`.
pub fn table(case: &Case, power: bool) -> Table {
    let plan = &case.plan;
    let nominal = |end: &str| -> Option<f64> {
        plan.nominal.priors.iter().find(|prior| prior.path.ends_with(end)).map(|prior| prior.nominal)
    };
    let mut columns: Vec<String> =
        ["residual", "hidden", "speed_m_s", "acceleration_m_s2", "time_s", "force_n", "pass"]
            .map(str::to_owned)
            .to_vec();
    let extra: Vec<&str> =
        ["position_m", "curvature_per_m", "air_temperature_c", "coasting", "engine_speed_rad_s"]
            .into_iter()
            .filter(|name| plan.has(name))
            .collect();
    columns.extend(extra.iter().map(|name| (*name).to_owned()));
    columns.extend(["cos_heading", "sin_heading", "load_n"].map(str::to_owned));
    let free: Vec<_> = plan.nominal.priors.iter().filter(|prior| prior.free).collect();
    columns.extend(free.iter().map(|prior| format!("free:{}", prior.path)));
    let mut table = Table { columns, rows: Vec::new(), noise: 0.0 };
    let vehicle = &plan.vehicle;
    let g = vehicle.gravity_m_s2;
    let turning = vehicle.turning_kg;
    let area = nominal("drag_area_m2").unwrap_or(vehicle.drag_area_m2);
    let level = vehicle.ground.share(0.0);
    let coefficient = nominal("coefficient").unwrap_or(level);
    let mut passes: Vec<(usize, f64)> = Vec::new();
    for ((log, along), run) in case.logs.iter().zip(&case.along).zip(&plan.runs) {
        let pass = passes.iter().filter(|(lane, _)| *lane == run.lane).count() as f64 + 1.0;
        passes.push((run.lane, pass));
        let mass = nominal("mass_kg").unwrap_or(vehicle.mass_kg) + run.ballast_kg;
        for hat in hats(log) {
            let mean = |name: &str| hat.mean(log, name);
            let (Some(v), Some(change)) = (mean("speed_m_s"), hat.change(log, "speed_m_s")) else { continue };
            let heading = mean("heading_rad").unwrap_or_else(|| {
                plan.course.heading_rad(mean("position_m").unwrap_or(run.position_m), run.reversed)
            });
            // The wind that an anemometer shows is no secret.
            let wind = mean("wind_speed_m_s").zip(mean("wind_direction_rad")).unwrap_or((0.0, 0.0));
            let head_m_s = v + wind.0 * (wind.1 - heading).cos();
            let air_speed_2 = head_m_s * head_m_s.hypot(wind.0 * (wind.1 - heading).sin());
            let resistance = mass * g * coefficient * vehicle.ground.share(v) / level
                + 0.5 * vehicle.air_density_kg_m3 * area * air_speed_2;
            let needed = (mass + turning) * change + resistance;
            let measured = match (&vehicle.electric, mean("tractive_force_n")) {
                (Some(electric), _) => mean("motor_torque_n_m").map(|torque| electric.rim_n(torque)),
                (None, force) => force,
            };
            let force = measured.unwrap_or(needed);
            let residual = if power {
                power_left(case, &hat, log, force, v, &nominal)
            } else {
                measured.map(|force| needed - force)
            };
            let (Some(residual), Some(hidden)) = (residual, hidden(case, &hat, along, power)) else {
                continue;
            };
            // Recorded force and recorded acceleration together are the residual, and explain nothing.
            let acceleration =
                if power || measured.is_none() { change } else { (force - resistance) / (mass + turning) };
            let mut values = vec![residual, hidden, v, acceleration, hat.middle_s, force, pass];
            values.extend(extra.iter().map(|name| mean(name).unwrap_or(f64::NAN)));
            values.extend([heading.cos(), heading.sin(), mass * g]);
            for prior in &free {
                let of_force = match prior.path.rsplit('.').next().unwrap_or_default() {
                    "mass_kg" => change + g * coefficient * vehicle.ground.share(v) / level,
                    "drag_area_m2" => 0.5 * vehicle.air_density_kg_m3 * air_speed_2,
                    "coefficient" => mass * g * vehicle.ground.share(v) / level,
                    _ => 0.0,
                };
                let of = if power {
                    of_power(case, prior, force, v, of_force, measured.is_some())
                } else {
                    of_force
                };
                values.push(prior.sd * of);
            }
            if values.iter().all(|value| value.is_finite()) {
                table.rows.push((run.id.clone(), run.held_out, values));
            }
        }
    }
    // At one second: blocks of half a second have √2 of it, and slopes of means are a little worse than lines.
    table.noise = if power { plan.power_noise_w() } else { plan.force_noise_n() } * 2f64.sqrt();
    table
}

/// Power that the source gives and the nominal model does not take [W].
fn power_left(
    case: &Case,
    hat: &Hat,
    log: &Run,
    force_n: f64,
    speed_m_s: f64,
    nominal: &dyn Fn(&str) -> Option<f64>,
) -> Option<f64> {
    let vehicle = &case.plan.vehicle;
    if let Some(electric) = &vehicle.electric {
        let torque = hat.mean(log, "motor_torque_n_m")?;
        let turn = speed_m_s * electric.gear_ratio / electric.radius_m;
        let efficiency = nominal("drive_efficiency").unwrap_or(electric.efficiency);
        let shaft = torque * turn;
        let taken = if shaft >= 0.0 { shaft / efficiency } else { shaft * efficiency };
        let standby = nominal("standby_power_w").unwrap_or(electric.standby_w);
        let given = hat.mean(log, "battery_voltage_v")? * hat.mean(log, "battery_current_a")?;
        return Some(given - taken - standby);
    }
    let engine = vehicle.engine.as_ref()?;
    let efficiency = nominal("willans_efficiency").unwrap_or(engine.efficiency);
    let accessory = nominal("accessory_power_w").unwrap_or(engine.accessory_w);
    let shaft = engine.shaft_w(force_n * speed_m_s, 0.0) - engine.accessory_w + accessory;
    let burnt = shaft + engine.friction_n_m * engine.line_rad_s(shaft, engine.friction_n_m);
    Some(engine.heat_j_kg * hat.mean(log, "fuel_rate_kg_s")? - burnt.max(0.0) / efficiency)
}

/// By what the residual of power changes with a parameter's error.
fn of_power(
    case: &Case,
    prior: &crate::truth::Prior,
    force_n: f64,
    speed_m_s: f64,
    of_force: f64,
    measured: bool,
) -> f64 {
    let vehicle = &case.plan.vehicle;
    let rim_w = force_n * speed_m_s;
    match (prior.path.rsplit('.').next().unwrap_or_default(), &vehicle.engine, &vehicle.electric) {
        ("standby_power_w", ..) => 1.0,
        ("drive_efficiency", _, Some(electric)) => rim_w / (electric.efficiency * electric.efficiency),
        ("accessory_power_w", Some(engine), _) => 1.0 / engine.efficiency,
        ("willans_efficiency", Some(engine), _) => {
            engine.shaft_w(rim_w, 0.0).max(0.0) / (engine.efficiency * engine.efficiency)
        }
        (_, Some(engine), _) if !measured => of_force * speed_m_s / (engine.transmission * engine.efficiency),
        _ => 0.0,
    }
}

/// All hidden physics in the unit of the residual.
fn hidden(case: &Case, hat: &Hat, along: &Run, power: bool) -> Option<f64> {
    let mut sum = 0.0;
    for cause in case.truth.hidden.iter().filter(|cause| cause.class == "physics") {
        let column = match (&cause.power_column, power) {
            (Some(column), true) => column,
            _ => &cause.column,
        };
        if column.ends_with(if power { "_w" } else { "_n" }) {
            sum += hat.mean(along, column)?;
        }
    }
    Some(sum)
}

/// Channels on which a law depends: what an equation for it has to hold, and nothing else.
fn variables(law: &str) -> Vec<&'static str> {
    match law.split('/').next_back().unwrap_or(law) {
        "wind" => vec!["speed_m_s", "cos_heading", "sin_heading"],
        "grade" | "soft_ground" | "fading_wave" | "lug" => vec!["position_m"],
        "grade_constant" => vec!["cos_heading", "sin_heading"],
        "rotating_inertia" | "mass" | "hysteresis" | "pump_by_change" => vec!["acceleration_m_s2"],
        "aerodynamic_drag" | "rolling_speed_law" | "speed_threshold" | "three_halves" | "sticking"
        | "saturating" | "latch" | "fan_by_speed" | "shift_transient" => vec!["speed_m_s"],
        "warm_up" | "cold_start" | "spells" | "switched" | "clocked" | "braking" => vec!["time_s"],
        "payload_change" => vec!["time_s", "acceleration_m_s2"],
        "driveline_temperature" | "drawbar_load" => vec!["time_s", "speed_m_s"],
        "cold" => vec!["air_temperature_c"],
        "stiffening" => vec!["air_temperature_c", "speed_m_s"],
        "multipass" => vec!["pass"],
        "neutral_drag" => vec!["coasting", "speed_m_s"],
        "cornering_drag" | "one_sided" => vec!["curvature_per_m", "speed_m_s"],
        "load_dependence" => vec!["load_n"],
        "driveline_efficiency" => vec!["force_n"],
        "variator_loss" | "product" => vec!["force_n", "speed_m_s"],
        "engine_friction" => vec!["engine_speed_rad_s"],
        _ => Vec::new(),
    }
}

/// A hat over two blocks of rows, as the weights of what is between one row and the next.
struct Hat {
    middle_s: f64,
    /// Row, and weight of the way from it to the next one; they sum to 1.
    weights: Vec<(usize, f64)>,
    /// Time between the means of the blocks [s].
    apart_s: f64,
    left: std::ops::Range<usize>,
    right: std::ops::Range<usize>,
}

/// Hats of a run, each beginning in the middle of the last.
fn hats(run: &Run) -> Vec<Hat> {
    let time_s = run.trace.time_s();
    let row = |at_s: f64| time_s.partition_point(|time| *time < at_s - 1e-9);
    let mut all = Vec::new();
    let mut from_s = time_s.first().copied().unwrap_or(0.0);
    while from_s + 2.0 * BLOCK_S <= time_s.last().copied().unwrap_or(0.0) {
        let middle_s = from_s + BLOCK_S;
        let (left, right) = (row(from_s)..row(middle_s), row(middle_s)..row(middle_s + BLOCK_S));
        from_s += BLOCK_S;
        if left.len() < 2 || right.len() < 2 {
            continue;
        }
        // The difference of two means is a sum of steps, each counted by how many rows of the left lie before it.
        let mut weights = Vec::new();
        for index in left.start..right.end - 1 {
            let before = if index < left.end {
                (index + 1 - left.start) as f64 / left.len() as f64
            } else {
                (right.end - 1 - index) as f64 / right.len() as f64
            };
            weights.push((index, before * (time_s[index + 1] - time_s[index])));
        }
        let apart_s: f64 = weights.iter().map(|(_, weight)| weight).sum();
        for (_, weight) in &mut weights {
            *weight /= apart_s;
        }
        all.push(Hat { middle_s, weights, apart_s, left, right });
    }
    all
}

impl Hat {
    /// Weighted mean of a channel; none where it is missing or has gaps.
    fn mean(&self, run: &Run, name: &str) -> Option<f64> {
        let values = run.trace.get(name)?;
        let between = |(row, weight): &(usize, f64)| 0.5 * (values[*row] + values[row + 1]) * weight;
        Some(self.weights.iter().map(between).sum::<f64>()).filter(|value| value.is_finite())
    }

    /// Change of a channel a second: difference of the means of the blocks, over that of their times.
    fn change(&self, run: &Run, name: &str) -> Option<f64> {
        let values = run.trace.get(name)?;
        let mean =
            |rows: &std::ops::Range<usize>| values[rows.clone()].iter().sum::<f64>() / rows.len() as f64;
        Some((mean(&self.right) - mean(&self.left)) / self.apart_s).filter(|value| value.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Kind, kind_of};
    use crate::score::correlation;

    /// With exact parameters and sensors the residual is what was hidden, but for the pitch that the sensors see.
    #[test]
    fn without_noise_the_residual_is_the_hidden_force() {
        let known = ["aerodynamic_drag", "rolling_speed_law", "wind", "grade", "driveline_efficiency"];
        let mut seen = 0;
        for number in (0..30).filter(|number| kind_of(*number).0 == Kind::Single) {
            let made = generate(9, number, Probe::Noiseless).unwrap();
            let law = made.truth.hidden[0].law.as_str();
            if seen == 2 {
                break;
            }
            if !known.contains(&law) || on_power(&made) {
                continue;
            }
            seen += 1;
            let table = table(&made, false);
            let column = |at: usize| -> Vec<f64> { table.rows.iter().map(|row| row.2[at]).collect() };
            let (residual, hidden) = (column(0), column(1));
            let square: f64 = hidden.iter().map(|value| value * value).sum();
            let slope = residual.iter().zip(&hidden).map(|(r, h)| r * h).sum::<f64>() / square;
            assert!((slope - 1.0).abs() < 0.03, "case {number}, {law}: {slope}");
            assert!(correlation(&residual, &hidden) > 0.97, "case {number}, {law}");
        }
        assert_eq!(seen, 2);
    }

    /// Nothing is hidden in every twentieth case, and its engine is logged: fuel is what the model burns.
    #[test]
    fn without_noise_fuel_is_what_the_nominal_engine_burns() {
        let made = generate(3, 19, Probe::Noiseless).unwrap();
        assert_eq!((made.truth.kind.as_str(), made.truth.family.as_str()), ("empty", "fuel"));
        let table = table(&made, true);
        let residual: f64 = table.rows.iter().map(|row| row.2[0]).sum::<f64>() / table.rows.len() as f64;
        let burnt = made.logs.iter().flat_map(|log| log.trace.get("fuel_rate_kg_s").unwrap().iter());
        let mean_w = 42.8e6 * burnt.clone().sum::<f64>() / burnt.count() as f64;
        assert!(residual.abs() < 0.01 * mean_w, "{residual} of {mean_w} W");
    }
}
