//! How often a channel is really renewed: a bus or a receiver gives a value ten times a second, and a log that is faster
//! repeats it.

use headland_trace::Trace;

/// Fewer renewals tell nothing.
const FEWEST: usize = 20;
/// Fewer samples than this are few.
const FEW: usize = 5;
/// Renewals are regular where this share of them comes after the usual number of samples or whole times that.
const REGULAR: f64 = 0.8;

/// Time from one renewal of a channel to the next [s]; the period of the log where it is not regularly held, or not there.
pub fn renewed_s(trace: &Trace, name: &str) -> f64 {
    let period_s = trace.period_s();
    let Some(values) = trace.get(name) else { return period_s };
    let changes: Vec<usize> = (1..values.len())
        .filter(|index| values[*index].is_finite() && values[*index] != values[index - 1])
        .collect();
    let held: Vec<usize> = changes.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if held.len() < FEWEST {
        return period_s;
    }
    let mut sorted = held.clone();
    sorted.sort_unstable();
    let usual = sorted[sorted.len() / 2];
    // Rates that are no whole multiples of each other make one sample more or less. A value that happens to come twice is
    // held for twice as long; among few samples everything is about a multiple.
    let regular: Vec<usize> = held
        .into_iter()
        .filter(|held| {
            let over = held % usual;
            held.abs_diff(usual) <= 1 || usual >= FEW && *held > usual && (over <= 1 || over + 1 >= usual)
        })
        .collect();
    if usual < 2 || (regular.len() as f64) < REGULAR * sorted.len() as f64 {
        return period_s;
    }
    let once: Vec<f64> =
        regular.iter().filter(|held| held.abs_diff(usual) <= 1).map(|held| *held as f64).collect();
    period_s * once.iter().sum::<f64>() / once.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(value: impl Fn(usize) -> f64) -> f64 {
        let mut trace = Trace::new((0..500).map(|index| 0.02 * f64::from(index)).collect()).unwrap();
        trace.push("speed_m_s", (0..500).map(value).collect(), headland_trace::Origin::Measured).unwrap();
        renewed_s(&trace, "speed_m_s")
    }

    #[test]
    fn a_value_that_is_held_for_five_samples_is_renewed_ten_times_a_second() {
        assert!((of(|index| ((index / 5) as f64).sin()) - 0.1).abs() < 1e-9);
        // 15 Hz in a log of 50 Hz: three or four samples.
        assert!((of(|index| (index as f64 * 0.3).floor().sin()) - 1.0 / 15.0).abs() < 2e-3);
    }

    #[test]
    fn a_coarse_value_is_not_held_and_a_fine_one_is_renewed_every_time() {
        assert!((of(|index| (0.3 * (0.02 * index as f64).powi(2)).round()) - 0.02).abs() < 1e-9);
        assert!((of(|index| (index as f64).sqrt()) - 0.02).abs() < 1e-9);
    }
}
