//! Colours of numbers on both sides of nothing.

use super::{Left, Stage};
use crate::colour::{Colour, ORANGE, SKY_BLUE};
use crate::strip::round_up;

/// Nothing: close to the dark ground, so that what stands out is what is far from nothing.
const NOTHING: Colour = [88, 92, 98];
/// A few wild rows, this share of all, must not bleach all others.
const WILD: f64 = 0.02;
/// So many means are drawn along a run.
const SMOOTHED: usize = 40;

/// From blue (less than modelled) over grey to orange (more).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    /// The number that has the full colour.
    pub limit: f64,
}

impl Scale {
    /// The scale of numbers, a few wild ones beyond its ends.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut sizes: Vec<f64> = values.map(f64::abs).filter(|size| size.is_finite()).collect();
        sizes.sort_by(f64::total_cmp);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a count")]
        let wild = (WILD * sizes.len() as f64) as usize;
        let most = sizes.len().checked_sub(1 + wild).map_or(0.0, |place| sizes[place]);
        Self { limit: if most > 0.0 { round_up(most) } else { 1.0 } }
    }

    /// How far from nothing: 1 at the limit and beyond, with the sign of the number.
    pub(crate) fn share(self, value: f64) -> f64 {
        (value / self.limit).clamp(-1.0, 1.0)
    }

    /// The colour of a number.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two colours")]
    pub(crate) fn colour(self, value: f64) -> Colour {
        let share = self.share(value);
        let end = if share < 0.0 { SKY_BLUE } else { ORANGE };
        let mix = |from: u8, to: u8| {
            (f64::from(from) + share.abs() * (f64::from(to) - f64::from(from))).round() as u8
        };
        [mix(NOTHING[0], end[0]), mix(NOTHING[1], end[1]), mix(NOTHING[2], end[2])]
    }
}

/// The running mean of what is left over: what differences of noisy speeds leave cannot be seen row by row.
pub(crate) fn smoothed(left: &Left, stage: Stage) -> Vec<f64> {
    let values = stage.of(left);
    let half = values.len() / (2 * SMOOTHED);
    let mean = |index: usize| {
        let near = &values[index.saturating_sub(half)..(index + half + 1).min(values.len())];
        near.iter().sum::<f64>() / near.len() as f64
    };
    (0..values.len()).map(mean).collect()
}

/// A number with its unit, in thousands where it is large: `+2 kN`.
pub(crate) fn told(value: f64, unit: &str) -> String {
    let thousands = value.abs() >= 1000.0 && ["N", "W", "V"].contains(&unit);
    let (value, kilo) = if thousands { (value / 1000.0, "k") } else { (value, "") };
    let sign = if value > 0.0 { "+" } else { "" };
    format!("{sign}{value} {kilo}{unit}").replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_grey_and_the_limits_have_the_full_colours() {
        let scale = Scale { limit: 200.0 };
        assert_eq!(scale.colour(0.0), NOTHING);
        assert_eq!([scale.colour(200.0), scale.colour(900.0)], [ORANGE; 2]);
        assert_eq!(scale.colour(-200.0), SKY_BLUE);
        assert_eq!(scale.colour(100.0), [159, 126, 49]);
    }

    #[test]
    fn one_wild_row_of_a_hundred_does_not_make_the_scale() {
        let values = (1..=99).map(f64::from).chain([-1e9, f64::NAN]);
        assert_eq!(Scale::of(values).limit, 100.0);
        assert_eq!(Scale::of(std::iter::empty()).limit, 1.0);
    }

    #[test]
    fn numbers_are_told_with_sign_and_unit() {
        let all = [told(2000.0, "N"), told(-0.5, "m/s"), told(0.0, "N"), told(-5000.0, "W")];
        assert_eq!(all, ["+2 kN", "−0.5 m/s", "0 N", "−5 kW"]);
    }
}
