//! What follows a value late: dy/dt = (u − y)/τ, settled where the run begins.
//!
//! Between two samples the value goes along a straight line, for which the solution is known: over a step h with e = exp(−h/τ),
//! y₁ = e y₀ + (1 − e) u₀ + (u₁ − u₀) (1 − (1 − e) τ/h).

/// The value as it is followed, at each of the times [s], with the time constant τ [s].
pub(crate) fn lagged(values: impl Iterator<Item = f64>, time_s: &[f64], lag_s: f64) -> Vec<f64> {
    let mut all: Vec<f64> = Vec::with_capacity(time_s.len());
    let mut before: Option<(f64, f64)> = None;
    for (value, at_s) in values.zip(time_s) {
        let own = match (before, all.last()) {
            (Some((last, last_s)), Some(followed)) => {
                let step = (at_s - last_s) / lag_s;
                let left = (-step).exp();
                // Of a step that is no time nothing is gone.
                let gone = if step > 0.0 { 1.0 - (1.0 - left) / step } else { 0.0 };
                left * followed + (1.0 - left) * last + (value - last) * gone
            }
            _ => value,
        };
        all.push(own);
        before = Some((value, *at_s));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After a ramp of 1/s began, y = t − τ (1 − exp(−t/τ)); however uneven the samples are.
    #[test]
    fn a_ramp_is_followed_as_its_closed_form_says() {
        let time_s = [0.0, 0.3, 0.31, 2.0, 5.0, 5.5, 40.0];
        let lag_s = 3.0;
        let followed = lagged(time_s.iter().copied(), &time_s, lag_s);
        for (at_s, followed) in time_s.iter().zip(followed) {
            let expected = at_s - lag_s * (1.0 - (-at_s / lag_s).exp());
            assert!((followed - expected).abs() < 1e-12, "{at_s} s: {followed}, {expected}");
        }
    }

    /// It begins settled, and repeated samples change nothing.
    #[test]
    fn what_stays_is_what_it_was() {
        assert_eq!(lagged([7.0; 4].into_iter(), &[0.0, 1.0, 1.0, 9.0], 2.0), [7.0; 4]);
    }
}
