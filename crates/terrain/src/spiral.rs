//! A field worked around from its edge to its middle.
//!
//! sides l, b, l, b − w, l − w, b − 2w, ...        w the spacing; corners of clothoids and arcs
//!
//! Source: definition; the circuitous pattern of Hunt, *Farm Power and Machinery Management* (2001), chapter 1.
//! It ends with the last side that still holds two corners, or after the rounds that are asked for. Marks: `corner` where a
//! corner begins, `side` where it ends.

use crate::laid::{Laid, Line, Pattern};
use crate::plane::{Incline, PlanePath};
use headland_plugin::{Bound, Card, Refusal, parameter};
use serde::Deserialize;
use std::f64::consts::FRAC_PI_2;

/// A plane field worked around.
pub type Spiral = Laid<Around>;

/// Rounds that close in.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Spiral")]
pub struct Around {
    heading_rad: f64,
    length_m: f64,
    breadth_m: f64,
    spacing_m: f64,
    rounds: f64,
    clockwise: bool,
    turn_radius_m: f64,
    turn_ramp_m: f64,
    #[serde(default)]
    grade: f64,
    #[serde(default)]
    uphill_rad: f64,
}

impl Pattern for Around {
    const CARD: Card = Card {
        name: "Spiral",
        about: "a field worked round and round from its edge inward; marks `corner` and `side`",
        equation: "sides l, b, l, b − w, l − w, b − 2w, ...; κ(s) = κ₀ + σ s in the corners",
        source: "definition; Hunt, Farm Power and Machinery Management (2001), chapter 1, the circuitous pattern",
        validity: "a right-angled plane field; corners without reversing; leaves out roughness",
        parameters: &[
            parameter("heading_rad", "rad", "direction of the first side, clockwise from north")
                .usually(-std::f64::consts::TAU, std::f64::consts::TAU),
            parameter("length_m", "m", "of the first side, l").must_be(Bound::Positive).usually(20.0, 3000.0),
            parameter("breadth_m", "m", "of the second side, b")
                .must_be(Bound::Positive)
                .usually(20.0, 3000.0),
            parameter("spacing_m", "m", "from one round to the next, w")
                .must_be(Bound::Positive)
                .usually(1.0, 48.0),
            parameter("rounds", "1", "how many at most")
                .must_be(Bound::Within(1.0, 10_000.0))
                .usually(1.0, 200.0),
            parameter("clockwise", "true or false", "whether it turns right"),
            parameter("turn_radius_m", "m", "of a corner").must_be(Bound::Positive).usually(3.0, 20.0),
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
            ("breadth_m", self.breadth_m),
            ("spacing_m", self.spacing_m),
            ("rounds", self.rounds),
            ("turn_radius_m", self.turn_radius_m),
            ("turn_ramp_m", self.turn_ramp_m),
        ]
    }

    fn incline(&self) -> Incline {
        Incline { grade: self.grade, uphill_rad: self.uphill_rad }
    }

    fn line(&self) -> Result<Line, Refusal> {
        let refuse = |parameter: &str, found: String, expected: String| Refusal {
            parameter: parameter.to_owned(),
            found,
            expected,
        };
        if self.rounds.fract() != 0.0 {
            return Err(refuse("rounds", self.rounds.to_string(), "a whole number".to_owned()));
        }
        let way = if self.clockwise { 1.0 } else { -1.0 };
        let mut corner = PlanePath::heading(0.0);
        corner.bend(FRAC_PI_2, self.turn_radius_m, self.turn_ramp_m);
        // A corner takes as much of one side as of the other.
        let corner_m = corner.at(corner.length_m()).north_m;
        for (name, side) in [("length_m", self.length_m), ("breadth_m", self.breadth_m)] {
            if side < 2.0 * corner_m {
                return Err(refuse(
                    name,
                    side.to_string(),
                    format!("two corners at least, {:.1} m", 2.0 * corner_m),
                ));
            }
        }
        let mut line = Line::heading(self.heading_rad);
        let (mut sides, mut driven) = ([self.length_m, self.breadth_m], 0_u32);
        while f64::from(driven) < 4.0 * self.rounds {
            let (first, which) = (driven == 0, (driven % 2) as usize);
            let side_m = sides[which];
            let straight_m = side_m - if first { corner_m } else { 2.0 * corner_m };
            if straight_m < 0.0 {
                break;
            }
            if !first {
                line.mark("corner");
                line.path.bend(way * FRAC_PI_2, self.turn_radius_m, self.turn_ramp_m);
                line.mark("side");
            }
            line.path.go(straight_m, 0.0, 0.0);
            // The first side keeps its length once more: the third lies at the far edge.
            if !first {
                sides[which] -= self.spacing_m;
            }
            driven += 1;
        }
        Ok(line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_plugin::{Plugin, Terrain};
    use std::path::Path;

    fn spiral(rounds: u32) -> Spiral {
        let mut field: Spiral = ron::from_str(&format!(
            "(heading_rad: 0, length_m: 100, breadth_m: 60, spacing_m: 5, rounds: {rounds}, clockwise: true, \
             turn_radius_m: 6, turn_ramp_m: 3)"
        ))
        .unwrap();
        field.settle(Path::new(".")).unwrap();
        field
    }

    /// Northward along east = 0, then along north = 100, east = 60, north = 0, and one spacing within each.
    #[test]
    fn each_side_lies_one_spacing_within_the_one_a_round_before() {
        let field = spiral(3);
        let mut at = 0.0;
        let lines: [(bool, f64); 9] = [
            (false, 100.0),
            (true, 60.0),
            (false, 0.0),
            (true, 5.0),
            (false, 95.0),
            (true, 55.0),
            (false, 5.0),
            (true, 10.0),
            (false, 90.0),
        ];
        for (vertical, line) in lines {
            at = field.next_mark_m("side", at).unwrap();
            let place = field.at(at + 1.0);
            let on = if vertical { place.east_m } else { place.north_m };
            assert!((on - line).abs() < 1e-9, "{place:?}: {line}");
        }
    }

    #[test]
    fn it_ends_where_no_side_holds_two_corners() {
        let end = spiral(1000).extent_m().unwrap().1;
        // 100 m by 60 m in rounds 5 m apart are about 6000 m² / 5 m of path.
        assert!((end / 1200.0 - 1.0).abs() < 0.15, "{end}");
        assert!(end > spiral(2).extent_m().unwrap().1);
        let mut narrow = spiral(1);
        narrow.pattern.breadth_m = 10.0;
        assert!(narrow.settle(Path::new(".")).unwrap_err().to_string().contains("two corners"));
    }
}
