//! A straight slope.
//!
//! sin θ = q / √(1 + q²)        q = rise over horizontal distance
//! h = s sin θ                  s along the path
//!
//! Source: definition of grade; AASHTO, *A Policy on Geometric Design of Highways and Streets* (2018), section 3.4.
//! The path is straight and never ends.

use crate::plane::Incline;
use headland_plugin::{Bound, Card, Place, Plugin, Spot, Surface, Terrain, parameter};
use serde::Deserialize;

/// A slope that is the same everywhere.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstantGrade {
    grade: f64,
    /// Where nothing blows, only the map shows it: northward unless it is said.
    #[serde(default)]
    heading_rad: f64,
}

impl Plugin for ConstantGrade {
    const CARD: Card = Card {
        name: "ConstantGrade",
        about: "a slope that is the same everywhere, and a straight path up or down it",
        equation: "h = s sin(atan q)",
        source: "definition of grade; AASHTO, A Policy on Geometric Design of Highways and Streets (2018), section 3.4",
        validity: "everywhere; leaves out roughness and turns",
        parameters: &[
            parameter("grade", "1", "rise over horizontal distance, uphill positive, q")
                .must_be(Bound::Within(-1.0, 1.0))
                .usually(-0.3, 0.3),
            parameter("heading_rad", "rad", "direction of travel, clockwise from north")
                .usually(-std::f64::consts::TAU, std::f64::consts::TAU)
                .or(0.0),
        ],
    };
}

impl Terrain for ConstantGrade {
    fn at(&self, position_m: f64) -> Place {
        let (s, q) = (position_m, self.grade);
        let cos_slope = 1.0 / q.hypot(1.0);
        let sin_slope = q * cos_slope;
        let (sin, cos) = self.heading_rad.sin_cos();
        Place {
            elevation_m: s * sin_slope,
            sin_slope,
            heading_rad: self.heading_rad,
            sin_roll: 0.0,
            curvature_per_m: 0.0,
            east_m: s * cos_slope * sin,
            north_m: s * cos_slope * cos,
        }
    }

    fn surface(&self) -> Option<&dyn Surface> {
        Some(self)
    }
}

/// The plane that is as steep everywhere and level across the path.
impl Surface for ConstantGrade {
    fn spot(&self, east_m: f64, north_m: f64) -> Option<Spot> {
        Incline { grade: self.grade, uphill_rad: self.heading_rad }.spot(east_m, north_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The 3-4-5 triangle: a grade of 3/4 rises 3 m and goes 4 m ahead on 5 m of path.
    #[test]
    fn the_right_triangle_of_three_four_five() {
        let place = ConstantGrade { grade: 0.75, heading_rad: 0.0 }.at(5.0);
        assert!((place.elevation_m - 3.0).abs() < 1e-12);
        assert!((place.north_m - 4.0).abs() < 1e-12 && place.east_m == 0.0);
        assert!((place.grade() - 0.75).abs() < 1e-12);
    }

    #[test]
    fn a_small_grade_is_its_own_sine() {
        let place = ConstantGrade { grade: -1e-4, heading_rad: 1.0 }.at(0.0);
        assert!((place.sin_slope / -1e-4 - 1.0).abs() < 1e-8);
    }

    #[test]
    fn slope_is_the_derivative_of_elevation() {
        let ground = ConstantGrade { grade: 0.1, heading_rad: 2.0 };
        let rise = ground.at(11.0).elevation_m - ground.at(10.0).elevation_m;
        assert!((rise - ground.at(10.0).sin_slope).abs() < 1e-12);
    }

    #[test]
    fn the_path_lies_on_the_surface() {
        let ground = ConstantGrade { grade: -0.3, heading_rad: 2.0 };
        let place = ground.at(40.0);
        let spot = ground.surface().unwrap().spot(place.east_m, place.north_m).unwrap();
        assert!((spot.height_m - place.elevation_m).abs() < 1e-12);
    }

    #[test]
    fn a_heading_alone_is_refused_and_a_grade_alone_leads_north() {
        assert!(ron::from_str::<ConstantGrade>("(heading_rad: 0.1)").is_err());
        assert_eq!(ron::from_str::<ConstantGrade>("(grade: 0.1)").unwrap().at(1.0).east_m, 0.0);
    }
}
