//! What a description knows of its sensors, taken out of their channels.
//!
//! corrected = (raw − bias) / scale, and the value of a sensor that is late by `latency_s` moves to the time at which
//! it was true: corrected(t) = raw(t + latency), linear between samples, on the log's own time base; where the log
//! ends before t + latency there is no value (NaN).

use crate::Sensor;
use headland_trace::{Trace, TraceError};

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
            let shifted = |time: &f64| trace.at(&channel.name, time + latency_s).unwrap_or(f64::NAN);
            values = trace.time_s().iter().map(shifted).collect();
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

    #[test]
    fn noise_alone_changes_nothing() {
        assert_eq!(with(Sensor { noise: Some(0.1), ..Sensor::default() }), [1.0, 3.0, 5.0, 9.0]);
    }
}
