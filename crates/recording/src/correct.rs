//! What a description knows of its sensors, taken out of their channels.
//!
//! corrected = (raw − bias) / scale, and the value of a sensor that is late by `latency_s` moves to the time at which
//! it was true: corrected(t) = raw(t + latency), linear between samples, on the log's own time base; where the log
//! ends before t + latency there is no value (NaN). A channel that has a new value in one row of several has one in as many
//! rows afterwards, those nearest to when it was true, and in between it is empty or repeated as before.

use crate::Sensor;
use crate::renewal::renewals;
use headland_trace::{Channel, Trace, TraceError};

/// Times that differ by this share are the same.
const TOUCH: f64 = 1e-9;

/// The trace with each described sensor corrected.
pub(crate) fn correct(trace: Trace, sensors: &[(String, Sensor)]) -> Result<Trace, TraceError> {
    let of = |name: &str| sensors.iter().find(|(channel, _)| channel == name).map(|(_, sensor)| *sensor);
    if !trace.channels().iter().any(|channel| of(&channel.name).is_some_and(|sensor| changes(&sensor))) {
        return Ok(trace);
    }
    let mut corrected = Trace::new(trace.time_s().to_vec())?;
    for channel in trace.channels() {
        let sensor = of(&channel.name).unwrap_or_default();
        let (scale, bias) = (sensor.scale.unwrap_or(1.0), sensor.bias.unwrap_or(0.0));
        let latency_s = sensor.latency_s.unwrap_or(0.0);
        let mut values = channel.values.clone();
        if latency_s != 0.0 {
            values = earlier(&trace, channel, latency_s);
        }
        if scale != 1.0 || bias != 0.0 {
            for value in &mut values {
                *value = (*value - bias) / scale;
            }
        }
        corrected.push(channel.name.clone(), values, channel.origin)?;
    }
    Ok(corrected)
}

/// The values of a channel when they were true.
fn earlier(trace: &Trace, channel: &Channel, latency_s: f64) -> Vec<f64> {
    let time_s = trace.time_s();
    let Some(new) = renewals(&channel.values) else {
        let at = |time: &f64| trace.at(&channel.name, time + latency_s).unwrap_or(f64::NAN);
        return time_s.iter().map(at).collect();
    };
    let held = channel.values.iter().filter(|value| value.is_finite()).count() > new.len();
    let true_s: Vec<f64> = new.iter().map(|row| time_s[*row] - latency_s).collect();
    let mut values = vec![f64::NAN; time_s.len()];
    for (place, own_s) in true_s.iter().enumerate() {
        let row = nearest(time_s, *own_s);
        // Beyond the ends of the log there is no row that is near.
        let near_s = 0.5 * trace.period_s() + TOUCH * own_s.abs().max(1.0);
        if (time_s[row] - own_s).abs() > near_s {
            continue;
        }
        let apart_s = time_s[row] - own_s;
        let beside = if apart_s >= 0.0 { place + 1 } else { place.wrapping_sub(1) };
        let own = channel.values[new[place]];
        values[row] = match new.get(beside) {
            Some(other) => own + apart_s / (true_s[beside] - own_s) * (channel.values[*other] - own),
            None if apart_s.abs() <= TOUCH * own_s.abs().max(1.0) => own,
            None => f64::NAN,
        };
    }
    if held {
        let longest = new.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap_or(1);
        let mut last: Option<usize> = None;
        for row in 0..values.len() {
            match last {
                _ if values[row].is_finite() => last = Some(row),
                Some(from) if row - from < longest => values[row] = values[from],
                _ => {}
            }
        }
    }
    values
}

/// The row whose time is nearest.
fn nearest(time_s: &[f64], at_s: f64) -> usize {
    let right = time_s.partition_point(|time| *time < at_s).min(time_s.len() - 1);
    let left = right.saturating_sub(1);
    if at_s - time_s[left] < time_s[right] - at_s { left } else { right }
}

/// Whether anything is to be taken out.
fn changes(sensor: &Sensor) -> bool {
    sensor.latency_s.is_some_and(|latency_s| latency_s != 0.0)
        || sensor.scale.is_some_and(|scale| scale != 1.0)
        || sensor.bias.is_some_and(|bias| bias != 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_trace::Origin;

    fn ramp() -> Trace {
        let mut trace = Trace::new(vec![0.0, 1.0, 2.0, 4.0]).unwrap();
        trace.push("speed_m_s", vec![1.0, 3.0, 5.0, 9.0], Origin::Measured).unwrap();
        trace
    }

    fn with(sensor: Sensor) -> Vec<f64> {
        let corrected = correct(ramp(), &[("speed_m_s".to_owned(), sensor)]).unwrap();
        corrected.get("speed_m_s").unwrap().to_vec()
    }

    #[test]
    fn bias_and_scale_are_taken_out_in_this_order() {
        assert_eq!(
            with(Sensor { scale: Some(2.0), bias: Some(1.0), ..Sensor::default() }),
            [0.0, 1.0, 2.0, 4.0]
        );
    }

    /// The ramp is 1 + 2 t; read half a second late it was 2 at t = 0.
    #[test]
    fn a_late_sensor_moves_to_when_it_was_true() {
        let late = with(Sensor { latency_s: Some(0.5), ..Sensor::default() });
        assert_eq!(late[..3], [2.0, 4.0, 6.0]);
        assert!(late[3].is_nan());
        let early = with(Sensor { latency_s: Some(-1.0), ..Sensor::default() });
        assert!(early[0].is_nan());
        assert_eq!(early[1..], [1.0, 3.0, 7.0]);
    }

    /// A receiver of 10 Hz in a log of 50 Hz, late by 0.187 s: what it says of 2 t² is true at 0.013, 0.113, …
    #[test]
    fn a_late_channel_that_is_empty_or_held_between_its_values_stays_so() {
        const LATE_S: f64 = 0.187;
        let law = |time_s: f64| 2.0 * time_s * time_s;
        let log = |held: bool| {
            let mut trace = Trace::new((0..300).map(|row| 0.02 * f64::from(row)).collect()).unwrap();
            let value = |row: usize| {
                let new = 5 * (row / 5);
                if held || row == new { law(0.02 * new as f64 - LATE_S) } else { f64::NAN }
            };
            trace.push("speed_m_s", (0..300).map(value).collect(), Origin::Measured).unwrap();
            let sensor = Sensor { latency_s: Some(LATE_S), ..Sensor::default() };
            correct(trace, &[("speed_m_s".to_owned(), sensor)]).unwrap().get("speed_m_s").unwrap().to_vec()
        };
        let (empty, held) = (log(false), log(true));
        let known: Vec<usize> = (0..300).filter(|row| empty[*row].is_finite()).collect();
        assert_eq!(known.len(), 57, "58 values were true within the log, and the last has none to its right");
        for row in &known {
            // Linear between values that are 0.1 s apart.
            assert!(
                (empty[*row] - law(0.02 * *row as f64)).abs() < 0.5 * 4.0 * 0.007 * 0.093 + 1e-9,
                "row {row}"
            );
            assert!(held[*row] == empty[*row] && row + 4 >= 300 || held[*row + 4] == empty[*row]);
        }
        assert_eq!(known.windows(2).filter(|pair| pair[1] - pair[0] == 5).count(), 56);
    }

    #[test]
    fn noise_alone_changes_nothing() {
        assert_eq!(with(Sensor { noise: Some(0.1), ..Sensor::default() }), [1.0, 3.0, 5.0, 9.0]);
    }
}
