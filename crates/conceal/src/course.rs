//! The lane that runs drive: its heading and its bends. Slopes and soft patches are hidden causes, not part of it.

use std::f64::consts::{PI, TAU};

/// A bend whose curvature swells and fades as a squared cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// Where it is tightest [m].
    pub middle_m: f64,
    /// From there to either end [m].
    pub half_length_m: f64,
    /// Greatest curvature, positive clockwise [1/m].
    pub curvature_per_m: f64,
}

/// A lane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// Heading at its start, clockwise from north [rad].
    pub heading_rad: f64,
    /// Its bends, which do not overlap.
    pub bends: Vec<Bend>,
}

impl Course {
    /// Curvature seen in the direction of travel [1/m].
    pub fn curvature_per_m(&self, position_m: f64, reversed: bool) -> f64 {
        let of = |bend: &Bend| {
            let away = (position_m - bend.middle_m) / bend.half_length_m;
            if away.abs() < 1.0 { bend.curvature_per_m * (0.5 * PI * away).cos().powi(2) } else { 0.0 }
        };
        let turn: f64 = self.bends.iter().map(of).sum();
        if reversed { -turn } else { turn }
    }

    /// Direction of travel, clockwise from north, 0 to 2π [rad].
    pub fn heading_rad(&self, position_m: f64, reversed: bool) -> f64 {
        let of = |bend: &Bend| {
            let away = ((position_m - bend.middle_m) / bend.half_length_m).clamp(-1.0, 1.0);
            0.5 * bend.curvature_per_m * bend.half_length_m * (away + 1.0 + (PI * away).sin() / PI)
        };
        let along = self.heading_rad + self.bends.iter().map(of).sum::<f64>();
        (if reversed { along + PI } else { along }).rem_euclid(TAU)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heading is the integral of curvature over the path.
    #[test]
    fn a_bend_turns_by_the_integral_of_its_curvature() {
        let bend = Bend { middle_m: 50.0, half_length_m: 20.0, curvature_per_m: 0.02 };
        let course = Course { heading_rad: 1.0, bends: vec![bend] };
        let sum: f64 = (0..100_000)
            .map(|step| course.curvature_per_m((f64::from(step) + 0.5) * 1e-3, false) * 1e-3)
            .sum();
        assert!((course.heading_rad(100.0, false) - 1.0 - sum).abs() < 1e-9);
        assert!((sum - 0.4).abs() < 1e-9, "κ L by hand: {sum}");
    }

    #[test]
    fn the_way_back_turns_to_the_other_side_and_heads_the_other_way() {
        let bend = Bend { middle_m: 50.0, half_length_m: 20.0, curvature_per_m: 0.02 };
        let course = Course { heading_rad: 0.3, bends: vec![bend] };
        assert_eq!(course.curvature_per_m(50.0, true), -course.curvature_per_m(50.0, false));
        assert!((course.heading_rad(0.0, true) - 0.3 - PI).abs() < 1e-12);
    }
}
