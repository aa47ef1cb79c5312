//! Means of a fast log over blocks of time.

use headland_trace::{Trace, TraceError};

/// Length of a block [s]: a vehicle that rolls out loses a tenth of a metre per second in it at most.
pub const BLOCK_S: f64 = 0.1;
/// A log with at least so many samples a block is averaged.
const LEAST: f64 = 4.0;

/// Whether a log is so fast that its blocks say all that a roll-out has to tell.
pub fn is_fast(trace: &Trace) -> bool {
    trace.len() > 1 && trace.duration_s() / (trace.len() - 1) as f64 * LEAST <= BLOCK_S
}

/// Each channel as the mean of what is there in each block; a block without samples leaves no row.
///
/// Deviations within a block (the teeth of a wheel sensor, vibration) are no independent witnesses of a roll-out, and a
/// model of their correlation would have to know the sensor.
pub fn means(trace: &Trace) -> Result<Trace, TraceError> {
    let time = trace.time_s();
    let first_s = time.first().copied().unwrap_or(0.0);
    let mut ends = Vec::new();
    for (index, at) in time.iter().enumerate() {
        let block = ((at - first_s) / BLOCK_S + 1e-9).floor();
        match ends.last_mut() {
            Some((last, end)) if *last == block => *end = index + 1,
            _ => ends.push((block, index + 1)),
        }
    }
    let mean = |values: &[f64]| -> Vec<f64> {
        let mut from = 0;
        let mut means = Vec::with_capacity(ends.len());
        for (_, end) in &ends {
            let present: Vec<f64> =
                values[from..*end].iter().copied().filter(|value| value.is_finite()).collect();
            means.push(if present.is_empty() {
                f64::NAN
            } else {
                present.iter().sum::<f64>() / present.len() as f64
            });
            from = *end;
        }
        means
    };
    let mut averaged = Trace::new(mean(time))?;
    for channel in trace.channels() {
        averaged.push(channel.name.clone(), mean(&channel.values), channel.origin)?;
    }
    Ok(averaged)
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_trace::Origin;

    #[test]
    fn a_block_is_the_mean_of_its_samples_in_time_and_value() {
        let mut trace = Trace::new((0..10_u8).map(|at| f64::from(at) * 0.02).collect()).unwrap();
        let speed = vec![1.0, 2.0, 3.0, f64::NAN, 4.0, 5.0, 5.0, 5.0, 5.0, 10.0];
        trace.push("speed_m_s", speed, Origin::Measured).unwrap();
        assert!(is_fast(&trace));
        let means = means(&trace).unwrap();
        assert_eq!(means.get("speed_m_s").unwrap(), [2.5, 6.0]);
        assert!((means.time_s()[0] - 0.04).abs() < 1e-12 && (means.time_s()[1] - 0.14).abs() < 1e-12);
    }

    #[test]
    fn a_log_of_ten_samples_a_second_stays_as_it_is() {
        let trace = Trace::new((0..10_u8).map(|at| f64::from(at) * 0.1).collect()).unwrap();
        assert!(!is_fast(&trace));
    }
}
