//! Parallel lanes up and down a field, and the turns between them.
//!
//! Each lane is straight, each turn made of clothoids and arcs: curvature has no steps.
//! d(α) = w        where lanes lie closer than the vehicle turns: away by α, back by π + 2α, away by α (a bulb)
//! else one half turn as wide as the lanes lie, or two quarters with a straight between them
//!
//! Source: definition; the turns are those of Hunt, *Farm Power and Machinery Management* (2001), chapter 1, on field
//! patterns, made of clothoids so that the steering needs time.
//! The turn is driven on one line, without reversing. The field is a plane that may be inclined. Marks: `turn` where a lane
//! ends and its turn begins, `lane` where the next begins.

use crate::laid::{Laid, Line, Pattern};
use crate::plane::{Incline, PlanePath};
use headland_plugin::{Bound, Card, Refusal, parameter};
use serde::Deserialize;
use std::f64::consts::{FRAC_PI_2, PI};

/// Lanes up and down a plane field.
pub type AbLines = Laid<UpAndDown>;

/// Lanes and turns.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "AbLines")]
pub struct UpAndDown {
    heading_rad: f64,
    length_m: f64,
    spacing_m: f64,
    lanes: f64,
    side: Side,
    turn_radius_m: f64,
    turn_ramp_m: f64,
    #[serde(default)]
    grade: f64,
    #[serde(default)]
    uphill_rad: f64,
}

/// On which side of a lane the next one lies, seen along the first.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

impl Pattern for UpAndDown {
    const CARD: Card = Card {
        name: "AbLines",
        about: "parallel lanes up and down a field with the turns between them; marks `turn` and `lane`",
        equation: "κ(s) = κ₀ + σ s; d(α) = w for bulbs of −α, π + 2α, −α",
        source: "definition; Hunt, Farm Power and Machinery Management (2001), chapter 1, for field patterns",
        validity: "turns without reversing on a plane field; leaves out roughness",
        parameters: &[
            parameter("heading_rad", "rad", "direction of the first lane, clockwise from north")
                .usually(-std::f64::consts::TAU, std::f64::consts::TAU),
            parameter("length_m", "m", "length of a lane").must_be(Bound::Positive).usually(20.0, 3000.0),
            parameter("spacing_m", "m", "from one lane to the next, w")
                .must_be(Bound::Positive)
                .usually(1.0, 48.0),
            parameter("lanes", "1", "how many").must_be(Bound::Within(1.0, 10_000.0)).usually(1.0, 500.0),
            parameter("side", "name", "on which side of the first lane the next lies: Left or Right"),
            parameter("turn_radius_m", "m", "the least in a turn")
                .must_be(Bound::Positive)
                .usually(3.0, 20.0),
            parameter("turn_ramp_m", "m", "way on which the steering goes to that radius, and back")
                .must_be(Bound::Positive)
                .usually(0.5, 15.0),
            parameter("grade", "1", "of the field, where it is steepest")
                .must_be(Bound::Within(-1.0, 1.0))
                .usually(-0.3, 0.3)
                .or(0.0),
            parameter("uphill_rad", "rad", "where the field rises, clockwise from north")
                .usually(-std::f64::consts::TAU, std::f64::consts::TAU)
                .or(0.0),
        ],
    };

    fn numbers(&self) -> Vec<(&'static str, f64)> {
        vec![
            ("heading_rad", self.heading_rad),
            ("length_m", self.length_m),
            ("spacing_m", self.spacing_m),
            ("lanes", self.lanes),
            ("turn_radius_m", self.turn_radius_m),
            ("turn_ramp_m", self.turn_ramp_m),
        ]
    }

    fn incline(&self) -> Incline {
        Incline { grade: self.grade, uphill_rad: self.uphill_rad }
    }

    fn line(&self) -> Result<Line, Refusal> {
        if self.lanes.fract() != 0.0 {
            return Err(Refusal {
                parameter: "lanes".to_owned(),
                found: self.lanes.to_string(),
                expected: "a whole number".to_owned(),
            });
        }
        let turn = Turn::between(self.spacing_m, self.turn_radius_m, self.turn_ramp_m);
        let mut line = Line::heading(self.heading_rad);
        let mut way = if self.side == Side::Right { 1.0 } else { -1.0 };
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "it is whole and small enough"
        )]
        let lanes = self.lanes as u32;
        for lane in 0..lanes {
            if lane > 0 {
                line.mark("turn");
                turn.add(&mut line.path, way);
                line.mark("lane");
                way = -way;
            }
            line.path.go(self.length_m, 0.0, 0.0);
        }
        Ok(line)
    }
}

/// A turn from one lane to the next, in the opposite direction.
#[derive(Clone, Debug)]
struct Turn {
    /// Angles of its bends [rad].
    bends: Vec<f64>,
    radius_m: f64,
    ramp_m: f64,
    /// Length of the straight after the first bend [m].
    straight_m: f64,
}

/// Halvings of an interval until nothing of it is left.
const HALVINGS: usize = 200;

impl Turn {
    /// The turn that fits between lanes.
    fn between(spacing_m: f64, radius_m: f64, ramp_m: f64) -> Self {
        let bulb = |alpha: f64| Self {
            bends: vec![-alpha, PI + 2.0 * alpha, -alpha],
            radius_m,
            ramp_m,
            straight_m: 0.0,
        };
        let half = |radius_m: f64| Self { bends: vec![PI], radius_m, ramp_m, straight_m: 0.0 };
        let quarters = |straight_m: f64| Self { bends: vec![FRAC_PI_2; 2], radius_m, ramp_m, straight_m };
        if spacing_m < half(radius_m).width_m() {
            // The wider it swings out, the nearer it comes back.
            return bulb(bisect(|alpha| bulb(alpha).width_m() - spacing_m, 1e-6, FRAC_PI_2));
        }
        let straight_m = spacing_m - quarters(0.0).width_m();
        if straight_m > 0.0 {
            return quarters(straight_m);
        }
        half(bisect(|radius| spacing_m - half(radius).width_m(), radius_m, radius_m + spacing_m))
    }

    fn add(&self, path: &mut PlanePath, way: f64) {
        for (index, angle) in self.bends.iter().enumerate() {
            if index == 1 {
                path.go(self.straight_m, 0.0, 0.0);
            }
            path.bend(way * angle, self.radius_m, self.ramp_m);
        }
    }

    /// How far beside its beginning it ends [m].
    fn width_m(&self) -> f64 {
        let mut path = PlanePath::heading(0.0);
        self.add(&mut path, 1.0);
        path.at(path.length_m()).east_m
    }
}

/// Where a function that falls is zero.
fn bisect(falls: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if falls(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_plugin::{Plugin, Terrain};
    use std::path::Path;

    fn lanes(spacing_m: f64, side: &str) -> AbLines {
        let mut field: AbLines = ron::from_str(&format!(
            "(heading_rad: 0.3, length_m: 120, spacing_m: {spacing_m}, lanes: 4, side: {side}, turn_radius_m: 6, \
             turn_ramp_m: 3)"
        ))
        .unwrap();
        field.settle(Path::new(".")).unwrap();
        field
    }

    /// Beside the first lane and along it [m].
    fn beside(field: &AbLines, position_m: f64) -> (f64, f64) {
        let place = field.at(position_m);
        let (sin, cos) = 0.3_f64.sin_cos();
        (place.east_m * cos - place.north_m * sin, place.east_m * sin + place.north_m * cos)
    }

    #[test]
    fn every_lane_begins_where_the_last_one_ended_one_spacing_beside_it() {
        // A bulb, a half turn that is widened, and two quarters with a straight.
        for spacing_m in [2.5, 13.0, 15.2, 24.0] {
            for (side, way) in [("Right", 1.0), ("Left", -1.0)] {
                let field = lanes(spacing_m, side);
                let (mut end, mut lane) = (0.0, 0.0);
                for number in 1..4 {
                    let turn = field.next_mark_m("turn", end).unwrap();
                    assert!((turn - lane - 120.0).abs() < 1e-9);
                    lane = field.next_mark_m("lane", turn).unwrap();
                    let (across, along) = beside(&field, lane);
                    let edge = if number % 2 == 1 { 120.0 } else { 0.0 };
                    assert!((across - way * spacing_m * f64::from(number)).abs() < 1e-9, "{across}");
                    assert!((along - edge).abs() < 1e-9, "{along}");
                    let turned = field.at(lane).heading_rad - field.at(turn).heading_rad;
                    assert!((turned.abs() - PI).abs() < 1e-12, "{turned}");
                    end = turn;
                }
                assert_eq!(field.extent_m().unwrap().1, field.length_m());
                assert_eq!(field.next_mark_m("turn", end), None);
            }
        }
    }

    #[test]
    fn curvature_has_no_steps_and_no_turn_is_tighter_than_its_radius() {
        for spacing_m in [2.5, 13.0, 24.0] {
            let field = lanes(spacing_m, "Left");
            let (mut before, mut s) = (0.0, 0.0);
            while s < field.length_m() {
                let curvature = field.at(s).curvature_per_m;
                assert!(curvature.abs() <= 1.0 / 6.0 + 1e-12);
                // σ = 1 / (6 · 3) per metre.
                assert!((curvature - before).abs() <= 0.05 / 18.0 + 1e-12, "{s}");
                (before, s) = (curvature, s + 0.05);
            }
        }
    }

    /// Arcs alone: away by α with 2 R (2 cos α − 1) = w; a ramp of no length comes to that.
    #[test]
    fn a_bulb_without_ramps_is_the_one_of_three_arcs() {
        let turn = Turn::between(3.0, 6.0, 1e-6);
        let alpha = (0.5 * (3.0 / 12.0 + 1.0_f64)).acos();
        assert!((turn.bends[0] + alpha).abs() < 1e-5, "{} {alpha}", turn.bends[0]);
    }

    #[test]
    fn half_a_lane_is_refused() {
        let mut field = lanes(3.0, "Left");
        field.pattern.lanes = 2.5;
        assert_eq!(
            field.settle(Path::new(".")).unwrap_err().to_string(),
            "`lanes` is 2.5, expected a whole number"
        );
    }
}
