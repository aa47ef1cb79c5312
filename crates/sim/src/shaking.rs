//! How hard a vehicle is shaken, of its recorded vertical acceleration.
//!
//! ⟨a²⟩(t) = mean of (a − ā)² over t ± 1 s, ā the mean of the same two seconds
//!
//! Source: definition of the variance. What rolls on tyres alone bounces about twice a second (Wong, *Theory of Ground Vehicles* (2008),
//! chapter 7) and, damped by a fifteenth of the critical, spends the energy of a bounce in 1 / (2 ζ ω) = 0.5 s. What the motion paid
//! in a window is what was spent in it but for what the bounce held at its ends, about √2 of those half seconds out of its length:
//! in two seconds a third, in one as much as two thirds. Much longer windows mix roads and speeds.
//! What lasts, as the offset of an accelerometer or gravity that was left in it, is no shaking. Samples of no value are left out.
//! Leaves out what shakes faster than half the rate of the log, where an accelerometer takes that away before it samples.

/// So much of the time before and after a sample [s].
const REACH_S: f64 = 1.0;

/// Mean square of the vertical acceleration about each sample [m²/s⁴]; 0 where a log is too slow to show any.
pub fn shaking_m2_s4(time_s: &[f64], vertical_m_s2: &[f64]) -> Vec<f64> {
    // About the mean of all, so that gravity cancels no digits.
    let known = || vertical_m_s2.iter().filter(|value| value.is_finite());
    let middle = known().sum::<f64>() / (known().count().max(1) as f64);
    let (mut first, mut end) = (0, 0);
    let mut sums = Sums::default();
    let mut all = Vec::with_capacity(time_s.len());
    for at in time_s {
        while end < time_s.len() && time_s[end] <= at + REACH_S {
            sums.add(vertical_m_s2[end] - middle, 1.0);
            end += 1;
        }
        while time_s[first] < at - REACH_S {
            sums.add(vertical_m_s2[first] - middle, -1.0);
            first += 1;
        }
        all.push(sums.variance());
    }
    all
}

/// Of the samples in reach.
#[derive(Default)]
struct Sums {
    count: f64,
    values: f64,
    squares: f64,
}

impl Sums {
    fn add(&mut self, value: f64, times: f64) {
        if value.is_finite() {
            self.count += times;
            self.values += times * value;
            self.squares += times * value * value;
        }
    }

    fn variance(&self) -> f64 {
        if self.count < 1.0 {
            return 0.0;
        }
        let mean = self.values / self.count;
        // Rounding alone makes it less than nothing.
        (self.squares / self.count - mean * mean).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(count: u32, step_s: f64) -> Vec<f64> {
        (0..count).map(|row| f64::from(row) * step_s).collect()
    }

    /// Of 3, 5 and 10 m/s², a second apart, the mean is 6 and the variance (9 + 1 + 16) / 3; an end has two of them: 1, and 6.25.
    #[test]
    fn three_samples_by_hand() {
        let all = shaking_m2_s4(&times(3, 1.0), &[3.0, 5.0, 10.0]);
        for (found, expected) in all.iter().zip([1.0, 26.0 / 3.0, 6.25]) {
            assert!((found - expected).abs() < 1e-12, "{all:?}");
        }
    }

    /// A bounce of amplitude A has A²/2, whatever lasts beside it.
    #[test]
    fn a_bounce_of_two_hertz_has_half_its_square_and_gravity_none() {
        let time_s = times(1001, 0.01);
        let bounce: Vec<f64> =
            time_s.iter().map(|t| 9.81 + 1.5 * (2.0 * std::f64::consts::TAU * t).sin()).collect();
        let all = shaking_m2_s4(&time_s, &bounce);
        for found in &all[100..900] {
            assert!((found / 1.125 - 1.0).abs() < 0.01, "{found}");
        }
        let still = shaking_m2_s4(&time_s, &vec![9.81; 1001]);
        assert!(still.iter().all(|found| *found < 1e-20));
    }

    #[test]
    fn a_log_that_is_slower_than_a_second_shows_none_and_a_gap_is_left_out() {
        assert_eq!(shaking_m2_s4(&times(3, 1.1), &[3.0, 5.0, 10.0]), [0.0; 3]);
        let all = shaking_m2_s4(&times(3, 0.8), &[3.0, f64::NAN, 5.0]);
        assert_eq!(all, [0.0, 1.0, 0.0]);
    }
}
