//! Plots of one run: forces, powers, where it drove.

use super::wheels::of_an_axle;
use headland_report::{Axis, Lines, Plot, ReportError, Series, build};
use headland_trace::Trace;
use headland_units::{stem, unit_of_name};

/// Forces over time; none where the model has none.
pub fn forces(trace: &Trace) -> Result<Plot, ReportError> {
    let used: Vec<&str> = trace
        .channels()
        .iter()
        .filter(|channel| unit_of_name(&channel.name).is_some_and(|unit| unit.symbol == "N"))
        .filter(|channel| !channel.name.starts_with("measured_") && !of_an_axle(&channel.name))
        .filter(|channel| channel.values.iter().any(|value| value.is_finite() && *value != 0.0))
        .map(|channel| channel.name.as_str())
        .collect();
    let words = "Traction pushes forward; a resistance is positive where it slows the vehicle down.";
    Ok(build::force_budget(trace, &used, false)?.words(words))
}

/// Powers over time: at the wheels, of the shafts, of the battery; none where nothing has a power.
pub fn powers(trace: &Trace) -> Option<Plot> {
    const PRODUCTS: [(&str, [&str; 2]); 4] = [
        ("at the wheels", ["tractive_force_n", "speed_m_s"]),
        ("engine", ["engine_torque_n_m", "engine_speed_rad_s"]),
        ("motor", ["motor_torque_n_m", "motor_speed_rad_s"]),
        ("battery", ["battery_voltage_v", "battery_current_a"]),
    ];
    let mut series = Vec::new();
    for (name, [one, other]) in PRODUCTS {
        if let (Some(one), Some(other)) = (trace.get(one), trace.get(other)) {
            let product: Vec<f64> = one.iter().zip(other).map(|(one, other)| one * other).collect();
            series.push(Series::new(name, trace.time_s(), product));
        }
    }
    for channel in trace.channels() {
        let is_power = unit_of_name(&channel.name).is_some_and(|unit| unit.symbol == "W");
        let shown = channel.values.iter().any(|value| value.is_finite() && *value != 0.0);
        let twice = channel.name == "battery_power_w" || channel.name.starts_with("measured_");
        if is_power && shown && !twice {
            let name = stem(&channel.name).replace('_', " ").replace(" power", "");
            series.push(Series::new(name, trace.time_s(), channel.values.clone()));
        }
    }
    (!series.is_empty())
        .then(|| Plot::new("Power over time", Lines::over_time(Axis::new("power", "W"), series)))
}

/// The path from above, coloured by speed; none where the vehicle did not move or where is not known.
pub fn map(trace: &Trace) -> Option<Plot> {
    let reach = |name: &str| {
        let values = trace.get(name)?.iter().copied().filter(|value| value.is_finite());
        let (low, high) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        (high > low).then_some(high - low).or(Some(0.0))
    };
    // A straight line tells nothing that its plot along the path does not.
    if reach("east_m")?.min(reach("north_m")?) < 1.0 {
        return None;
    }
    build::path_map(trace, Some("speed_m_s"), &[]).ok()
}

/// Speed, and height where it varies, along the path.
pub fn along(trace: &Trace) -> Vec<Plot> {
    let Some(position) = trace.get("position_m") else { return Vec::new() };
    let plot = |channel: &str, name: &str| {
        let values = trace.get(channel)?;
        let first = values.iter().copied().find(|value| value.is_finite())?;
        if values.iter().all(|value| !value.is_finite() || *value == first) {
            return None;
        }
        let series = vec![Series::new(name, position.to_vec(), values.to_vec())];
        let title = format!("{name} along the path");
        Some(Plot::new(title, Lines::over(Axis::of("position_m"), Axis::of(channel), series)))
    };
    [("speed_m_s", "Speed"), ("elevation_m", "Height")]
        .into_iter()
        .filter_map(|(channel, name)| plot(channel, name))
        .collect()
}
