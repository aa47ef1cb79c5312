//! Full-load curve of an engine, and the lowest speed at which it gives a power.
//!
//! T(ω) is straight between its points, so P(ω) = T ω is a parabola between them.

use headland_plugin::Refusal;
use serde::Deserialize;

/// A point of the curve as scenarios write it.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Point {
    pub speed_rad_s: f64,
    pub torque_n_m: f64,
}

/// The greatest torque of an engine at each speed, from idle up.
#[derive(Clone, Debug, Default)]
pub(crate) struct FullLoad {
    segments: Vec<Segment>,
    peak_power: f64,
    peak_speed: f64,
    last_speed: f64,
}

/// T = offset + rate ω from `low` on; the power is greatest at `peak`.
#[derive(Clone, Copy, Debug)]
struct Segment {
    low: f64,
    offset: f64,
    rate: f64,
    peak: f64,
}

impl Segment {
    fn power(&self, speed: f64) -> f64 {
        (self.offset + self.rate * speed) * speed
    }
}

impl FullLoad {
    /// The curve from idle speed on.
    ///
    /// # Errors
    /// [`Refusal`] of fewer than two points, speeds that do not increase, negative torque, or an idle speed outside.
    pub(crate) fn new(points: &[Point], idle_speed: f64) -> Result<Self, Refusal> {
        check(points, idle_speed)?;
        let mut curve = Self::default();
        for pair in points.windows(2) {
            let (one, two) = (&pair[0], &pair[1]);
            let rate = (two.torque_n_m - one.torque_n_m) / (two.speed_rad_s - one.speed_rad_s);
            let (low, high) = (one.speed_rad_s.max(idle_speed), two.speed_rad_s);
            if low >= high {
                continue;
            }
            let offset = one.torque_n_m - rate * one.speed_rad_s;
            // dP/dω = offset + 2 rate ω: an inner maximum where the torque falls fast enough.
            let peak = if rate < 0.0 { (-0.5 * offset / rate).clamp(low, high) } else { high };
            let segment = Segment { low, offset, rate, peak };
            let (power, speed) = (segment.power(peak), peak);
            if power > curve.peak_power {
                (curve.peak_power, curve.peak_speed) = (power, speed);
            }
            curve.segments.push(segment);
            curve.last_speed = high;
        }
        if curve.peak_power > 0.0 {
            Ok(curve)
        } else {
            Err(refuse("full_load", "without power above idle speed".to_owned(), "some torque"))
        }
    }

    /// Greatest power.
    pub(crate) fn peak_power(&self) -> f64 {
        self.peak_power
    }

    /// Highest speed.
    pub(crate) fn last_speed(&self) -> f64 {
        self.last_speed
    }

    /// Power of full load at a speed; that of the nearest where the curve does not reach.
    pub(crate) fn power(&self, speed: f64) -> f64 {
        let within = self.segments.iter().rfind(|segment| segment.low <= speed).or(self.segments.first());
        within.map_or(0.0, |segment| segment.power(speed.max(segment.low).min(self.last_speed)))
    }

    /// Speed of the greatest power.
    pub(crate) fn peak_speed(&self) -> f64 {
        self.peak_speed
    }

    /// Greatest torque at a speed: that of idle below it, and none beyond the last point.
    pub(crate) fn torque(&self, speed: f64) -> f64 {
        if speed > self.last_speed {
            return 0.0;
        }
        let segment = self.segments.iter().rfind(|segment| segment.low <= speed).or(self.segments.first());
        segment.map_or(0.0, |segment| segment.offset + segment.rate * speed.max(segment.low))
    }

    /// The lowest speed from idle on at which full load gives `power`; that of the greatest power where none does.
    pub(crate) fn lowest_speed(&self, power: f64) -> f64 {
        let Some(segment) = self.segments.iter().find(|segment| segment.power(segment.peak) >= power) else {
            return self.peak_speed;
        };
        if segment.power(segment.low) >= power {
            return segment.low;
        }
        // rate ω² + offset ω = power: the root on the rising side of the parabola.
        let (a, b) = (segment.rate, segment.offset);
        let root = (b * b + 4.0 * a * power).max(0.0).sqrt();
        let speed = if b >= 0.0 { 2.0 * power / (b + root) } else { (root - b) / (2.0 * a) };
        speed.clamp(segment.low, segment.peak)
    }
}

/// Nearer to zero than this, as a part of what is balanced, a power is rounding.
const ROUNDING: f64 = 1e-14;

impl FullLoad {
    /// The lowest speed at which a share of full load gives `constant` + `linear` ω + `cubic` ω³ [W]; that of the greatest
    /// power where it never does below. A root in closed form, or Newton's method, within the piece of the curve that holds it.
    pub(crate) fn speed_for(&self, share: f64, [constant, linear, cubic]: [f64; 3]) -> f64 {
        for (index, segment) in self.segments.iter().enumerate() {
            let end = self.segments.get(index + 1).map_or(self.last_speed, |next| next.low);
            let (mut low, mut high) = (segment.low, end.min(self.peak_speed));
            let (first, second) = (share * segment.offset - linear, share * segment.rate);
            let spare = |w: f64| ((second - cubic * w) * w + first) * w - constant;
            let (at_low, at_high) = (spare(low), spare(high));
            if at_low >= 0.0 {
                return low;
            }
            if at_high >= 0.0 {
                let chord = (low * at_high - high * at_low) / (at_high - at_low);
                // Without a fan it is the root of a parabola, on its rising side.
                let root = 2.0 * constant / (first + (first * first + 4.0 * second * constant).sqrt());
                let mut speed = if cubic == 0.0 && root > low && root < high { root } else { chord };
                while high - low > f64::EPSILON * high {
                    let value = spare(speed);
                    if value.abs() <= ROUNDING * (constant.abs() + first.abs() * speed) {
                        break;
                    }
                    if value < 0.0 {
                        low = speed;
                    } else {
                        high = speed;
                    }
                    let slope = (2.0 * second - 3.0 * cubic * speed) * speed + first;
                    let next = speed - value / slope;
                    let within = next > low && next < high;
                    let next = if within { next } else { 0.5 * (low + high) };
                    if next == speed {
                        break;
                    }
                    speed = next;
                }
                return speed;
            }
            if end >= self.peak_speed {
                break;
            }
        }
        self.peak_speed
    }
}

fn refuse(parameter: &str, found: String, expected: &str) -> Refusal {
    Refusal { parameter: parameter.to_owned(), found, expected: expected.to_owned() }
}

fn check(points: &[Point], idle_speed: f64) -> Result<(), Refusal> {
    let (Some(first), Some(last), true) = (points.first(), points.last(), points.len() > 1) else {
        return Err(refuse("full_load", format!("{} points", points.len()), "two or more"));
    };
    for point in points {
        let (speed, torque) = (point.speed_rad_s, point.torque_n_m);
        if !(speed.is_finite() && torque.is_finite() && speed >= 0.0 && torque >= 0.0) {
            return Err(refuse("full_load", format!("({speed}, {torque})"), "finite numbers, 0 or more"));
        }
    }
    if let Some(pair) = points.windows(2).find(|pair| pair[1].speed_rad_s <= pair[0].speed_rad_s) {
        let found = format!("at {} rad/s after {} rad/s", pair[1].speed_rad_s, pair[0].speed_rad_s);
        return Err(refuse("full_load", found, "speeds that increase"));
    }
    if idle_speed < first.speed_rad_s || idle_speed >= last.speed_rad_s {
        let expected = format!("{} to below {} as in `full_load`", first.speed_rad_s, last.speed_rad_s);
        return Err(refuse("idle_speed_rad_s", idle_speed.to_string(), &expected));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points(list: &[(f64, f64)]) -> Vec<Point> {
        list.iter().map(|&(speed_rad_s, torque_n_m)| Point { speed_rad_s, torque_n_m }).collect()
    }

    fn curve() -> FullLoad {
        FullLoad::new(&points(&[(80.0, 900.0), (150.0, 1570.0), (190.0, 1340.0), (235.0, 0.0)]), 85.0)
            .unwrap()
    }

    /// The steep last line is T = 1340 · (235 − ω) / 45, whose power is greatest at 117.5 rad/s, so at its start.
    #[test]
    fn the_greatest_power_is_found_between_points_too() {
        assert!((curve().peak_power() - 1340.0 * 190.0).abs() < 1e-6);
        // T = 100 − ω between 10 and 90: P = ω (100 − ω) is 2500 W at 50 rad/s.
        let falling = FullLoad::new(&points(&[(10.0, 90.0), (90.0, 10.0)]), 10.0).unwrap();
        assert!((falling.peak_power() - 2500.0).abs() < 1e-9);
        assert!((falling.lowest_speed(2500.0) - 50.0).abs() < 1e-6);
        // ω (100 − ω) = 1600 at 20 rad/s.
        assert!((falling.lowest_speed(1600.0) - 20.0).abs() < 1e-9);
    }

    #[test]
    fn no_power_is_given_at_idle_and_too_much_at_the_speed_of_the_greatest() {
        assert_eq!(curve().lowest_speed(0.0), 85.0);
        assert_eq!(curve().lowest_speed(-1e9), 85.0);
        assert_eq!(curve().lowest_speed(1e9), 190.0);
    }

    #[test]
    fn curves_that_cannot_be_are_refused() {
        let refused =
            |list: &[(f64, f64)], idle: f64| FullLoad::new(&points(list), idle).unwrap_err().to_string();
        assert!(refused(&[(80.0, 900.0)], 80.0).contains("1 points"));
        assert!(refused(&[(80.0, 9.0), (80.0, 9.0)], 80.0).contains("at 80 rad/s after 80 rad/s"));
        assert!(refused(&[(80.0, 9.0), (90.0, -1.0)], 80.0).contains("(90, -1)"));
        assert!(refused(&[(80.0, 9.0), (90.0, 9.0)], 70.0).starts_with("`idle_speed_rad_s` is 70"));
        assert!(refused(&[(80.0, 0.0), (90.0, 0.0)], 80.0).contains("without power"));
    }

    proptest! {
        /// What the search for a zero finds, on a curve whose power rises up to its peak.
        #[test]
        fn a_share_of_full_load_meets_what_is_taken(
            share in 0.3f64..1.0, constant in -1e4f64..2.5e5, linear in 0.0f64..40.0, cubic in prop_oneof![Just(0.0), 0.0f64..2e-3],
        ) {
            let curve = curve();
            let spare = |w: f64| share * curve.torque(w) * w - constant - (linear + cubic * w * w) * w;
            let speed = curve.speed_for(share, [constant, linear, cubic]);
            let expected = crate::parts::crossing(85.0, curve.peak_speed(), spare);
            prop_assert!((speed - expected).abs() <= 1e-6 * expected, "{speed} {expected}");
            prop_assert!(speed == 85.0 || speed == curve.peak_speed() || spare(speed).abs() <= 1e-9 * constant.abs().max(1e3));
        }

        /// At the lowest speed full load gives the power, and at no speed below does it.
        #[test]
        fn the_lowest_speed_gives_the_power_and_none_below_does(share in 0.0f64..1.0, below in 0.0f64..0.999) {
            let curve = curve();
            let power = share * curve.peak_power();
            let speed = curve.lowest_speed(power);
            let at = |w: f64| {
                let segment = curve.segments.iter().rfind(|s| s.low <= w).unwrap();
                segment.power(w)
            };
            prop_assert!(at(speed) >= power * (1.0 - 1e-12));
            let lower = 85.0 + below * (speed - 85.0);
            prop_assert!(speed == 85.0 || at(lower) < power);
        }
    }
}
