//! Plots of what the axles do.

use headland_report::{Axis, Lines, Plot, Series};
use headland_trace::Trace;

/// How the channels of an axle begin.
const AXLE: &str = "axle_";

/// Whether a channel is that of one axle.
pub fn of_an_axle(channel: &str) -> bool {
    channel.starts_with(AXLE)
}

/// Slip, and what each axle carries and pulls, over time; none where the vehicle has no axles.
pub fn plots(trace: &Trace) -> Vec<Plot> {
    let slip: Vec<Series> = series(trace, "_slip");
    if slip.is_empty() {
        return Vec::new();
    }
    let words = "Slip is what the wheels turn without moving the vehicle, as a share of their speed.";
    let mut plots =
        vec![Plot::new("Slip over time", Lines::over_time(Axis::new("slip", ""), slip)).words(words)];
    for (what, title) in
        [("_load_n", "Axle loads over time"), ("_traction_n", "Traction of the axles over time")]
    {
        let series = series(trace, what);
        if !series.is_empty() {
            plots.push(Plot::new(title, Lines::over_time(Axis::new("force", "N"), series)));
        }
    }
    plots
}

/// One line an axle.
fn series(trace: &Trace, what: &str) -> Vec<Series> {
    let channels = trace.channels().iter();
    let of_axles = channels.filter_map(|channel| {
        let number = channel.name.strip_prefix(AXLE)?.strip_suffix(what)?;
        Some(Series::new(format!("axle {number}"), trace.time_s(), channel.values.clone()))
    });
    of_axles.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_trace::Origin;

    #[test]
    fn a_vehicle_with_axles_has_three_plots_and_one_without_none() {
        let mut trace = Trace::new(vec![0.0, 1.0]).unwrap();
        assert!(plots(&trace).is_empty());
        for name in ["axle_1_slip", "axle_2_slip", "axle_1_load_n", "axle_1_traction_n", "slip"] {
            trace.push(name, vec![0.1, 0.2], Origin::Predicted).unwrap();
        }
        assert_eq!(plots(&trace).len(), 3);
        assert_eq!(series(&trace, "_slip").len(), 2);
        assert!(of_an_axle("axle_1_load_n") && !of_an_axle("slip"));
    }
}
