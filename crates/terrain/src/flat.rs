//! Level ground.
//!
//! h = 0
//!
//! Source: definition.
//! The path is straight and never ends.

use crate::plane::Incline;
use headland_plugin::{Card, Place, Plugin, Surface, Terrain, parameter};
use serde::Deserialize;

/// Level ground, and a straight path over it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flat {
    /// Where nothing blows, only the map shows it: northward unless it is said.
    #[serde(default)]
    heading_rad: f64,
}

impl Plugin for Flat {
    const CARD: Card = Card {
        name: "Flat",
        about: "level ground and a straight path that never ends",
        equation: "h = 0",
        source: "definition",
        validity: "everywhere; leaves out slope, roughness and turns",
        parameters: &[parameter("heading_rad", "rad", "direction of travel, clockwise from north")
            .usually(-std::f64::consts::TAU, std::f64::consts::TAU)
            .or(0.0)],
    };
}

impl Terrain for Flat {
    fn at(&self, position_m: f64) -> Place {
        let (sin, cos) = if self.heading_rad == 0.0 { (0.0, 1.0) } else { self.heading_rad.sin_cos() };
        Place {
            heading_rad: self.heading_rad,
            east_m: position_m * sin,
            north_m: position_m * cos,
            ..Place::default()
        }
    }

    fn surface(&self) -> Option<&dyn Surface> {
        const LEVEL: &Incline = &Incline { grade: 0.0, uphill_rad: 0.0 };
        Some(LEVEL)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn eastward_is_a_quarter_turn_clockwise_from_north() {
        let place = Flat { heading_rad: FRAC_PI_2 }.at(50.0);
        assert!((place.east_m - 50.0).abs() < 1e-12 && place.north_m.abs() < 1e-12);
        assert_eq!((place.elevation_m, place.sin_slope, place.curvature_per_m), (0.0, 0.0, 0.0));
    }

    #[test]
    fn it_never_ends_and_runs_backwards_too() {
        let ground = Flat { heading_rad: 0.0 };
        assert_eq!(ground.extent_m(), None);
        assert!((ground.at(-8.0).north_m + 8.0).abs() < 1e-12);
    }

    #[test]
    fn a_heading_in_degrees_is_refused_by_its_name() {
        assert!(ron::from_str::<Flat>("(heading_deg: 90.0)").is_err());
    }
}
