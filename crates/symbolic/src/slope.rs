//! How a shape moves with a constant inside it, on the scale on which that is moved ([`Factor::inner`]).
//!
//! With z = (u − c)/s a scale moves by ln s, so that s ∂f/∂s = −z f′(z), and a centre by its share of the spread. What remembers has
//! no closed form here, and is taken at both sides of where it is.

use crate::shape::{Columns, EDGE, Factor, Free, Shape};
use crate::variable::Checked;
use std::f64::consts::TAU;

/// Difference by which the derivative of what remembers is taken, on the inner scale.
const NUDGE: f64 = 1e-4;

impl Factor {
    /// The derivative of [`Factor::along`] by one of its free constants.
    pub fn slope(&self, free: Free, run: &[f64], time_s: &[f64], of: &Checked) -> Columns {
        let argument = || self.argument(run, of);
        match self.shape {
            Shape::Latch | Shape::Unlatch | Shape::Lag(..) | Shape::Ahead(_) => {
                self.difference(free, run, time_s, of)
            }
            Shape::Wave => Columns::phased(argument().map(|u| {
                let by = TAU * u / of.spread();
                let (sine, cosine) = (TAU * u / self.scale).sin_cos();
                (by * cosine, -by * sine)
            })),
            _ => Columns::one(argument().map(|u| self.steepness(free, u, of.spread())).collect()),
        }
    }

    /// The derivative at one value of a shape that remembers nothing and has no phase.
    fn steepness(&self, free: Free, u: f64, spread: f64) -> f64 {
        let Self { scale: s, centre: c, .. } = *self;
        let x = u / s;
        let z = (u - c) / s;
        // What a centre that moves by the spread does to z.
        let apart = spread / s;
        let moved = if free == Free::Centre { apart } else { z };
        match self.shape {
            Shape::Tanh => -x * (1.0 - x.tanh().powi(2)),
            Shape::Saturation => -u * s / (u + s).powi(2),
            Shape::Hyperbola => x / (1.0 + x).powi(2),
            Shape::Peak => -2.0 * x * (1.0 - x * x) / (1.0 + x * x).powi(2),
            Shape::Decay => x * (-x).exp(),
            Shape::Rise => -x * (-x).exp(),
            Shape::FreePower(p) if x > 0.0 => x.powf(p) * x.ln(),
            Shape::From => -apart,
            Shape::Under => spread / u,
            Shape::Above(p) if z > 0.0 => -f64::from(p) * apart * z.powi(i32::from(p) - 1),
            Shape::Below(p) if z < 0.0 => f64::from(p) * apart * (-z).powi(i32::from(p) - 1),
            Shape::Step => -0.5 * moved * (1.0 - z.tanh().powi(2)),
            Shape::StepDown => 0.5 * moved * (1.0 - z.tanh().powi(2)),
            Shape::Bump => 2.0 * z * moved * (-z * z).exp(),
            Shape::Pulse(level) => {
                let (sine, cosine) = (TAU * z).sin_cos();
                let edge = 0.5 * EDGE * (1.0 - (EDGE * (sine - level)).tanh().powi(2));
                // Scales move in cycles over the spread while the centre stays, centres in cycles, and a level as it is.
                edge * match free {
                    Free::Scale => TAU * cosine * (u - c) / spread,
                    Free::Centre => -TAU * cosine,
                    _ => -1.0,
                }
            }
            _ => 0.0,
        }
    }

    fn difference(&self, free: Free, run: &[f64], time_s: &[f64], of: &Checked) -> Columns {
        let moved = |by: f64| {
            let mut moved = *self;
            moved.set_inner(free, self.inner(free, of) + by, of);
            moved.along(run, time_s, of).first
        };
        let (below, above) = (moved(-NUDGE), moved(NUDGE));
        Columns::one(above.iter().zip(&below).map(|(above, below)| (above - below) / (2.0 * NUDGE)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Target;
    use crate::variable::{Enters, Variable, check};

    /// Every shape, moved by each of its constants a little to both sides.
    #[test]
    fn a_closed_form_is_what_a_small_move_does() {
        let values: Vec<f64> = (0..60u8).map(|at| 0.3 + 0.2 * f64::from(at)).collect();
        let times_s = vec![(0..60u8).map(f64::from).collect::<Vec<f64>>()];
        let variables = [Variable {
            name: "v".to_owned(),
            unit: "m/s".to_owned(),
            runs: vec![values.clone()],
            twin: None,
            finest: 0.0,
            enters: Enters::Freely,
        }];
        let checked = check(&variables, &times_s, &[true], Target::Force).unwrap();
        let of = &checked[0];
        let shapes = [
            Shape::FreePower(1.7),
            Shape::Tanh,
            Shape::Saturation,
            Shape::Hyperbola,
            Shape::Peak,
            Shape::Decay,
            Shape::Rise,
            Shape::From,
            Shape::Under,
            Shape::Above(1),
            Shape::Above(2),
            Shape::Below(1),
            Shape::Below(2),
            Shape::Step,
            Shape::StepDown,
            Shape::Bump,
            Shape::Wave,
            Shape::Pulse(0.3),
        ];
        for shape in shapes {
            // No sample lies where a hinge is.
            let factor = Factor { variable: 0, shape, scale: 3.17, centre: 5.23 };
            for free in shape.free() {
                let own = factor.slope(*free, &values, &times_s[0], of);
                let by = 1e-6;
                let moved = |by: f64| {
                    let mut moved = factor;
                    moved.set_inner(*free, factor.inner(*free, of) + by, of);
                    moved.along(&values, &times_s[0], of)
                };
                let (below, above) = (moved(-by), moved(by));
                let same = |own: &[f64], above: &[f64], below: &[f64]| {
                    for ((own, above), below) in own.iter().zip(above).zip(below) {
                        let expected = (above - below) / (2.0 * by);
                        assert!(
                            (own - expected).abs() < 1e-6 * (1.0 + expected.abs()),
                            "{shape:?} {free:?}: {own}, {expected}"
                        );
                    }
                };
                same(&own.first, &above.first, &below.first);
                if let (Some(own), Some(above), Some(below)) = (&own.cosine, &above.cosine, &below.cosine) {
                    same(own, above, below);
                }
            }
        }
    }
}
