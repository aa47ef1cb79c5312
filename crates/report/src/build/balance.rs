//! Where force and energy went.

use crate::{Axis, Flow, Line, Lines, Plot, ReportError, Sankey, Series, quantity};
use headland_trace::Trace;
use headland_units::{stem, unit_of_name};

/// Share of the larger side by which sources and sinks may differ before the difference is drawn.
const CLOSED: f64 = 1e-6;

/// Forces over time, one for each of these channels; all channels in newtons if none is named. Stacked areas, or lines.
///
/// # Errors
/// [`ReportError::Trace`] where the trace lacks a named channel.
pub fn force_budget(trace: &Trace, channels: &[&str], stacked: bool) -> Result<Plot, ReportError> {
    let all: Vec<&str> = trace
        .channels()
        .iter()
        .map(|channel| channel.name.as_str())
        .filter(|name| unit_of_name(name).is_some_and(|unit| unit.symbol == "N"))
        .collect();
    let channels = if channels.is_empty() { &all } else { channels };
    let series = channels
        .iter()
        .map(|name| {
            let values = trace.require(name)?;
            Ok(Series::new(stem(name).replace('_', " "), trace.time_s(), values).drawn(Line::Solid))
        })
        .collect::<Result<_, ReportError>>()?;
    let lines = Lines::over_time(Axis::new("force", "N"), series);
    Ok(Plot::new("Force budget", if stacked { lines.stacked() } else { lines }))
}

/// Energy in joules from sources through the vehicle, called `through`, to sinks.
///
/// A negative source is drawn as a sink and the other way round; zeros and missing values are left out. What the two
/// sides differ by is drawn as "residual" where it is more than a millionth, and said below the plot in any case.
pub fn energy_flow(through: &str, sources: &[(&str, f64)], sinks: &[(&str, f64)]) -> Plot {
    let (mut entering, mut leaving) = (Vec::new(), Vec::new());
    for (name, value) in sources.iter().copied().chain(sinks.iter().map(|(name, value)| (*name, -value))) {
        if value > 0.0 {
            entering.push((name, value));
        } else if value < 0.0 {
            leaving.push((name, -value));
        }
    }
    let sum = |side: &[(&str, f64)]| side.iter().map(|(_, value)| value).sum::<f64>();
    let (fed, spent) = (sum(&entering), sum(&leaving));
    let residual = fed - spent;
    if residual.abs() > CLOSED * fed.max(spent) {
        let side = if residual > 0.0 { &mut leaving } else { &mut entering };
        side.push(("residual", residual.abs()));
    }
    // A name on both sides (kinetic energy at start and end) is two nodes.
    let both = |name: &str| {
        name == through
            || (entering.iter().any(|(other, _)| *other == name)
                && leaving.iter().any(|(other, _)| *other == name))
    };
    let label =
        |name: &str, side: &str| if both(name) { format!("{name} ({side})") } else { name.to_owned() };
    let flows = entering
        .iter()
        .map(|(name, value)| Flow { from: label(name, "in"), to: through.to_owned(), value: *value })
        .chain(leaving.iter().map(|(name, value)| Flow {
            from: through.to_owned(),
            to: label(name, "out"),
            value: *value,
        }))
        .collect();
    let words = format!(
        "In {}, out {}, residual {}.",
        quantity(fed, "J"),
        quantity(spent, "J"),
        quantity(residual, "J")
    );
    Plot::new("Energy flow", Sankey { axis: Axis::new("energy", "J"), flows, ..Sankey::default() })
        .words(words)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kind;
    use headland_trace::Origin;

    fn flows(plot: &Plot) -> Vec<(String, String, f64)> {
        let Kind::Sankey(sankey) = &plot.kind else { panic!("no sankey") };
        sankey.flows.iter().map(|flow| (flow.from.clone(), flow.to.clone(), flow.value)).collect()
    }

    fn flow(from: &str, to: &str, value: f64) -> (String, String, f64) {
        (from.to_owned(), to.to_owned(), value)
    }

    #[test]
    fn a_negative_sink_is_a_source_and_the_gap_is_drawn() {
        let plot =
            energy_flow("vehicle", &[("fuel", 100.0)], &[("soil", 90.0), ("grade", -5.0), ("air", 0.0)]);
        assert_eq!(
            flows(&plot),
            [
                flow("fuel", "vehicle", 100.0),
                flow("grade", "vehicle", 5.0),
                flow("vehicle", "soil", 90.0),
                flow("vehicle", "residual", 15.0),
            ]
        );
        assert_eq!(plot.words, "In 105\u{a0}J, out 90\u{a0}J, residual 15\u{a0}J.");
        assert!(plot.draw().is_ok());
    }

    #[test]
    fn a_closed_ledger_draws_no_residual_and_a_name_on_both_sides_is_two_nodes() {
        let plot =
            energy_flow("vehicle", &[("kinetic", 452.0)], &[("kinetic", 100.0), ("soil", 352.0 - 1e-6)]);
        let flows = flows(&plot);
        assert_eq!(flows[0], flow("kinetic (in)", "vehicle", 452.0));
        assert_eq!(flows[1], flow("vehicle", "kinetic (out)", 100.0));
        assert_eq!(flows.len(), 3);
        assert!(plot.draw().is_ok());
    }

    #[test]
    fn only_forces_enter_the_budget() {
        let mut trace = Trace::new(vec![0.0, 1.0]).unwrap();
        for name in ["rolling_resistance_n", "motor_torque_n_m", "air_drag_n", "speed_m_s"] {
            trace.push(name, vec![1.0, 2.0], Origin::Predicted).unwrap();
        }
        let spec = force_budget(&trace, &[], true).unwrap().draw().unwrap().spec;
        let names: Vec<&str> =
            spec["series"].as_array().unwrap().iter().filter_map(|one| one["name"].as_str()).collect();
        assert_eq!(names, ["rolling resistance", "air drag"]);
        assert!(force_budget(&trace, &["brake_n"], true).is_err());
    }
}
