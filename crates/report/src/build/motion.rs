//! What moved, how it differs, and where.

use crate::{Axis, Cloud, Colour, Highlight, Interval, Line, Lines, Map, Plot, ReportError, Scatter, Series};
use headland_trace::{Origin, Trace};

/// One channel of several traces over time, each under its name; driven channels are broken lines and say so.
///
/// # Errors
/// [`ReportError::Trace`] where a trace lacks the channel.
pub fn over_time(
    channel: &str,
    traces: &[(&str, &Trace)],
    shaded: Vec<Interval>,
) -> Result<Plot, ReportError> {
    let axis = Axis::of(channel);
    let series = traces
        .iter()
        .map(|(name, trace)| {
            let values = trace.require(channel)?;
            let origin = trace.channel(channel).map(|channel| channel.origin).unwrap_or_default();
            Ok(match origin {
                Origin::Driven => {
                    Series::new(format!("{name} (driven)"), trace.time_s(), values).drawn(Line::Dashed)
                }
                Origin::Measured | Origin::Predicted => Series::new(*name, trace.time_s(), values),
            })
        })
        .collect::<Result<_, ReportError>>()?;
    let title = format!("{} over time", capital(&axis.label));
    Ok(Plot::new(title, Lines::over_time(axis, series).shaded(shaded)))
}

/// Predicted minus measured over time, at the samples of the measurement; optionally with the noise of the sensor (unit
/// of the channel, one standard deviation) as a band of two.
///
/// # Errors
/// [`ReportError::Trace`] where a trace lacks the channel.
pub fn residual_over_time(
    channel: &str,
    measured: &Trace,
    predicted: &Trace,
    noise: Option<f64>,
    shaded: Vec<Interval>,
) -> Result<Plot, ReportError> {
    let residual = residual(channel, measured, predicted)?;
    let axis = Axis::of(channel);
    let mut series = vec![Series::new("predicted − measured", measured.time_s(), residual)];
    if let (Some(noise), [first, .., last]) = (noise, measured.time_s()) {
        // Level, so its ends are enough.
        let expected = Series::new("expected from the sensor (±2σ)", [*first, *last], [0.0; 2])
            .band([-2.0 * noise; 2], [2.0 * noise; 2])
            .drawn(Line::Dashed);
        series.push(expected);
    }
    let title = format!("Residual of {} over time", axis.label);
    let axis = Axis::new(format!("residual of {}", axis.label), axis.unit);
    Ok(Plot::new(title, Lines::over_time(axis, series).shaded(shaded)))
}

/// Predicted minus measured `channel` against the measured channel `against`, coloured by time.
///
/// # Errors
/// [`ReportError::Trace`] where a trace lacks a channel.
pub fn residual_against(
    channel: &str,
    against: &str,
    measured: &Trace,
    predicted: &Trace,
) -> Result<Plot, ReportError> {
    let residual = residual(channel, measured, predicted)?;
    let (x, y) = (Axis::of(against), Axis::of(channel));
    let title = format!("Residual of {} against {}", y.label, x.label);
    let colour = Colour { axis: Axis::time(), values: measured.time_s().to_vec() };
    let cloud = Cloud {
        name: "predicted − measured".to_owned(),
        x: measured.require(against)?.to_vec(),
        y: residual,
        colour: Some(colour),
        joined: false,
    };
    let y = Axis::new(format!("residual of {}", y.label), y.unit);
    Ok(Plot::new(title, Scatter { x, y, clouds: vec![cloud] }))
}

/// The path from `east_m` and `north_m`, coloured by a channel, with arrows where there is `heading_rad`; `parts` are
/// intervals of time, in seconds, to set off.
///
/// # Errors
/// [`ReportError::Trace`] where the trace lacks the place or the colouring channel.
pub fn path_map(trace: &Trace, coloured_by: Option<&str>, parts: &[Interval]) -> Result<Plot, ReportError> {
    let colour = coloured_by
        .map(|channel| {
            Ok::<_, ReportError>(Colour { axis: Axis::of(channel), values: trace.require(channel)?.to_vec() })
        })
        .transpose()?;
    let time = trace.time_s();
    let highlights = parts
        .iter()
        .filter_map(|part| {
            let first = time.partition_point(|at| *at < part.from);
            let end = time.partition_point(|at| *at <= part.to);
            (end > first).then(|| Highlight { label: part.label.clone(), first, last: end - 1 })
        })
        .collect();
    let map = Map {
        east_m: trace.require("east_m")?.to_vec(),
        north_m: trace.require("north_m")?.to_vec(),
        colour,
        heading_rad: trace.get("heading_rad").map(<[f64]>::to_vec),
        highlights,
    };
    Ok(Plot::new("Path", map))
}

/// Predicted, at the samples of the measurement, minus measured; NaN where one of them is missing.
fn residual(channel: &str, measured: &Trace, predicted: &Trace) -> Result<Vec<f64>, ReportError> {
    predicted.require(channel)?;
    let values = measured.require(channel)?;
    let residual = measured
        .time_s()
        .iter()
        .zip(values)
        .map(|(time, value)| predicted.at(channel, *time).unwrap_or(f64::NAN) - value);
    Ok(residual.collect())
}

fn capital(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_uppercase().chain(characters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kind;

    fn trace(times: &[f64], name: &str, values: &[f64], origin: Origin) -> Trace {
        let mut trace = Trace::new(times.to_vec()).unwrap();
        trace.push(name, values.to_vec(), origin).unwrap();
        trace
    }

    #[test]
    fn the_residual_is_predicted_minus_measured_where_both_are() {
        let measured =
            trace(&[0.0, 1.0, 2.0, 3.0], "speed_m_s", &[1.0, 1.0, f64::NAN, 1.0], Origin::Measured);
        let predicted = trace(&[0.0, 2.0], "speed_m_s", &[2.0, 6.0], Origin::Predicted);
        let residual = residual("speed_m_s", &measured, &predicted).unwrap();
        assert_eq!(residual[..2], [1.0, 3.0]);
        assert!(residual[2].is_nan() && residual[3].is_nan());
    }

    #[test]
    fn a_missing_channel_is_refused_and_a_driven_one_is_called_so() {
        let driven = trace(&[0.0, 1.0], "speed_m_s", &[1.0, 2.0], Origin::Driven);
        assert!(over_time("grade", &[("r1", &driven)], Vec::new()).is_err());
        let plot = over_time("speed_m_s", &[("r1", &driven)], Vec::new()).unwrap();
        assert_eq!(plot.title, "Speed over time");
        assert_eq!(plot.draw().unwrap().spec["series"][0]["name"], "r1 (driven)");
    }

    #[test]
    fn intervals_of_time_become_parts_of_the_path() {
        let mut trace = trace(&[0.0, 1.0, 2.0, 3.0], "east_m", &[0.0, 1.0, 2.0, 3.0], Origin::Measured);
        trace.push("north_m", vec![0.0; 4], Origin::Measured).unwrap();
        let soft = Interval { from: 0.5, to: 2.0, label: "soft".to_owned() };
        let never = Interval { from: 7.0, to: 9.0, label: "never".to_owned() };
        let Kind::Map(map) = path_map(&trace, None, &[soft, never]).unwrap().kind else { panic!("no map") };
        assert_eq!(map.highlights, [Highlight { label: "soft".to_owned(), first: 1, last: 2 }]);
    }
}
