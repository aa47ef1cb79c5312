//! Totals: what a rate adds up to over a run, and the 5 % criterion.
//!
//! ∫ y dt by the trapezoidal rule, over the same intervals for both signals.
//!
//! A total is blind to errors that cancel, and a relative error of a total means nothing where the total itself is what is
//! left of a large give and take. It is therefore given only where the measured total is more than 5 % of the integral of
//! the measured absolute value.

use crate::align::Aligned;
use headland_units::{Dimension, unit_of_name};

/// Largest relative error of a total that passes.
pub const CRITERION: f64 = 0.05;
/// Least share of a total in the integral of the absolute value for a relative error to mean something.
const LEAST_SHARE: f64 = 0.05;

/// A measured and a modelled total.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Total {
    /// The rate that was integrated.
    pub of: String,
    /// Unit of the totals.
    pub unit: String,
    /// Measured.
    pub measured: f64,
    /// Modelled.
    pub modelled: f64,
    /// Integral of the measured absolute value: what passed, whichever way.
    pub measured_absolute: f64,
    /// Modelled minus measured over the absolute value of the measured; none where the measured total is what little is
    /// left of a give and take.
    pub relative_error: Option<f64>,
    /// Whether the relative error is below 5 %.
    pub within_criterion: Option<bool>,
    /// Whether the model was given the rate, or a factor of it, as an input: then this validates nothing.
    pub driven: bool,
    /// Time that was integrated over (s).
    pub covered_s: f64,
    /// Longest interval between two pairs (s): how much the trapezoidal rule had to bridge.
    pub longest_step_s: f64,
}

impl Total {
    /// A total of these integrals, with its relative error and verdict.
    pub(crate) fn new(of: &str, unit: &str, driven: bool, sums: Sums) -> Self {
        let relative_error = (sums.measured.abs() > LEAST_SHARE * sums.measured_absolute)
            .then(|| (sums.modelled - sums.measured) / sums.measured.abs());
        Self {
            of: of.to_owned(),
            unit: unit.to_owned(),
            measured: sums.measured,
            modelled: sums.modelled,
            measured_absolute: sums.measured_absolute,
            relative_error,
            within_criterion: relative_error.map(|error| error.abs() < CRITERION),
            driven,
            covered_s: sums.covered_s,
            longest_step_s: sums.longest_step_s,
        }
    }

    pub(crate) fn sums(&self) -> Sums {
        Sums {
            measured: self.measured,
            modelled: self.modelled,
            measured_absolute: self.measured_absolute,
            covered_s: self.covered_s,
            longest_step_s: self.longest_step_s,
        }
    }
}

/// Integrals of both signals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sums {
    measured: f64,
    modelled: f64,
    measured_absolute: f64,
    covered_s: f64,
    longest_step_s: f64,
}

impl std::ops::Add for Sums {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            measured: self.measured + other.measured,
            modelled: self.modelled + other.modelled,
            measured_absolute: self.measured_absolute + other.measured_absolute,
            covered_s: self.covered_s + other.covered_s,
            longest_step_s: self.longest_step_s.max(other.longest_step_s),
        }
    }
}

/// Integral of a rate over increasing times (s), by the trapezoidal rule; 0 of fewer than two samples.
pub fn integral(time_s: &[f64], rate: &[f64]) -> f64 {
    time_s.windows(2).zip(rate.windows(2)).map(|(t, y)| (t[1] - t[0]) * f64::midpoint(y[0], y[1])).sum()
}

/// The total of one channel over its pairs, in `unit`.
pub fn total(of: &str, unit: &str, driven: bool, aligned: &Aligned) -> Total {
    let time_s = &aligned.time_s;
    let absolute: Vec<f64> = aligned.measured.iter().map(|value| value.abs()).collect();
    let sums = Sums {
        measured: integral(time_s, &aligned.measured),
        modelled: integral(time_s, &aligned.modelled),
        measured_absolute: integral(time_s, &absolute),
        covered_s: time_s.last().zip(time_s.first()).map_or(0.0, |(last, first)| last - first),
        longest_step_s: time_s.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max),
    };
    Total::new(of, unit, driven, sums)
}

/// The unit of the integral over time of a channel that is a rate of something worth adding up: power to J, mass flow to
/// kg, current to A s, the vehicle's speed to m. `None` for any other channel.
pub fn integral_unit(channel: &str) -> Option<&'static str> {
    const POWER: Dimension = Dimension::of(2, 1, -3, 0, 0, 0);
    const MASS_FLOW: Dimension = Dimension::of(0, 1, -1, 0, 0, 0);
    const CURRENT: Dimension = Dimension::of(0, 0, 0, 1, 0, 0);
    if channel == "speed_m_s" || channel == "wheel_speed_m_s" {
        return Some("m");
    }
    let unit = unit_of_name(channel).filter(|unit| unit.factor == 1.0)?;
    match unit.dimension {
        POWER => Some("J"),
        MASS_FLOW => Some("kg"),
        CURRENT => Some("A s"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::align::Dropped;

    fn pairs(time_s: &[f64], measured: &[f64], modelled: &[f64]) -> Aligned {
        Aligned {
            time_s: time_s.to_vec(),
            measured: measured.to_vec(),
            modelled: modelled.to_vec(),
            dropped: Dropped::default(),
        }
    }

    /// 1 → 3 over 2 s is 4, 3 → 3 over 1 s is 3: 7. The model has 1 → 3.2 and 3.2 → 3.2: 4.2 + 3.2 = 7.4, 5.71 % too much.
    #[test]
    fn uneven_steps_are_worked_by_hand() {
        let found =
            total("fuel_rate_kg_s", "kg", false, &pairs(&[0., 2., 3.], &[1., 3., 3.], &[1., 3.2, 3.2]));
        assert!((found.measured - 7.0).abs() < 1e-12 && (found.modelled - 7.4).abs() < 1e-12);
        assert!((found.relative_error.unwrap() - 0.4 / 7.0).abs() < 1e-12);
        assert_eq!(found.within_criterion, Some(false));
        assert_eq!((found.covered_s, found.longest_step_s), (3.0, 2.0));
    }

    /// 2.51 kg of fuel simulated, 2.56 kg measured: 2.0 % too little, which passes.
    #[test]
    fn a_total_within_five_per_cent_passes() {
        let found = total("fuel_rate_kg_s", "kg", false, &pairs(&[0., 1.], &[2.56, 2.56], &[2.51, 2.51]));
        assert!((found.relative_error.unwrap() + 0.05 / 2.56).abs() < 1e-12);
        assert_eq!(found.within_criterion, Some(true));
    }

    /// Up and down by the same: the sum of the measured is nothing, and no error is relative to nothing.
    #[test]
    fn a_total_that_cancels_has_no_relative_error() {
        let found =
            total("battery_current_a", "A s", false, &pairs(&[0., 1., 2.], &[5., 0., -5.], &[6., 0., -5.]));
        assert_eq!((found.measured, found.measured_absolute), (0.0, 5.0));
        assert_eq!((found.relative_error, found.within_criterion), (None, None));
    }

    /// The error of a negative total is relative to its size: modelled -9 against -10 is too high by a tenth.
    #[test]
    fn a_negative_total_keeps_the_sign_of_the_error() {
        let found = total("pto_power_w", "J", false, &pairs(&[0., 1.], &[-10., -10.], &[-9., -9.]));
        assert!((found.relative_error.unwrap() - 0.1).abs() < 1e-12);
    }

    #[test]
    fn rates_of_energy_fuel_charge_and_distance_add_up_and_others_do_not() {
        assert_eq!(integral_unit("auxiliary_power_w"), Some("J"));
        assert_eq!(integral_unit("fuel_rate_kg_s"), Some("kg"));
        assert_eq!(integral_unit("battery_current_a"), Some("A s"));
        assert_eq!(integral_unit("speed_m_s"), Some("m"));
        for other in ["wind_speed_m_s", "grade", "heading_rad", "tractive_force_n", "position_m"] {
            assert_eq!(integral_unit(other), None, "{other}");
        }
    }
}
