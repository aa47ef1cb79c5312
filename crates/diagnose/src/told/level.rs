//! The level of what is switched: a consumer takes one power wherever it is on, and an implement pulls with one force. The greatest of
//! many estimates of that is more.

use crate::causes::catalogue::Cause;
use crate::causes::profile::Function;
use headland_calibrate::statistics::{median, quantile_of_sorted, sorted};

/// More than this share of the greatest value is on.
const ON: f64 = 0.5;
/// Of the values that are on, a tenth lies below the first and a tenth above the second …
const MOST: (f64, f64) = (0.1, 0.9);
/// … and those are nearer to each other than this share of the one in the middle.
const ALIKE: f64 = 0.2;

/// The level of what is switched, with its standard deviation; none where it has several, or one of its own in each run.
pub fn level(cause: &Cause, function: &Function) -> Option<(f64, f64)> {
    let knots =
        function.values.iter().flat_map(|(values, sds)| values.iter().copied().zip(sds.iter().copied()));
    if cause.is_switched() && !cause.by_run { of_knots(&knots.collect::<Vec<_>>()) } else { None }
}

/// The same of values with their standard deviations.
fn of_knots(knots: &[(f64, f64)]) -> Option<(f64, f64)> {
    let greatest = knots.iter().map(|(value, _)| *value).fold(0.0, f64::max);
    let (values, sds): (Vec<f64>, Vec<f64>) =
        knots.iter().copied().filter(|(value, _)| *value > ON * greatest).unzip();
    if values.is_empty() {
        return None;
    }
    let all = sorted(&values);
    let [low, middle, high] = [MOST.0, 0.5, MOST.1].map(|share| quantile_of_sorted(&all, share));
    (high - low < ALIKE * middle).then(|| (middle, median(&sds)))
}

#[cfg(test)]
mod tests {
    use super::of_knots;

    /// On at 2000 W, with an edge that overshoots, and off in between.
    #[test]
    fn what_is_switched_has_one_level_and_what_wanders_has_none() {
        let knot = |knot: u32| {
            let ripple = 40.0 * f64::from(knot % 5) - 80.0;
            let value = match knot {
                20 => 2600.0,
                10..40 | 60..80 => 2000.0 + ripple,
                _ => ripple,
            };
            (value, 90.0)
        };
        let switched: Vec<(f64, f64)> = (0..100).map(knot).collect();
        let (level, sd) = of_knots(&switched).unwrap();
        assert!((level - 2000.0).abs() < 50.0 && sd == 90.0, "{level} {sd}");
        let wanders: Vec<(f64, f64)> = (0..100).map(|knot| (20.0 * f64::from(knot), 90.0)).collect();
        assert!(of_knots(&wanders).is_none() && of_knots(&[]).is_none());
    }
}
