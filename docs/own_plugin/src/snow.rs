//! A soil: snow that the wheels press down.
//!
//! F = c N + n b p z        n wheels that make a track, b tyre width, p pressure that compacts, z depth of the track
//!
//! Source: work of compaction per metre, as in Bekker, *Introduction to Terrain-Vehicle Systems* (1969), part II, with a
//! pressure that does not grow with depth.
//! Holds for fresh snow that the wheels press to its final density in one pass.

use headland_plugin::{Bound, Card, Contact, Plugin, Soil, parameter};
use serde::Deserialize;

/// Snow of one depth.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Snow {
    coefficient: f64,
    tracks: f64,
    width_m: f64,
    compaction_pressure_pa: f64,
    depth_m: f64,
}

impl Plugin for Snow {
    const CARD: Card = Card {
        name: "Snow",
        about: "snow that the wheels press down, over ground that rolls",
        equation: "F = c N + n b p z",
        source: "work of compaction per metre, after Bekker, Introduction to Terrain-Vehicle Systems (1969), part II",
        validity: "fresh snow, pressed to its final density in one pass; leaves out bulldozing",
        parameters: &[
            parameter("coefficient", "1", "rolling resistance of what lies below, c")
                .must_be(Bound::NotNegative)
                .usually(0.005, 0.1),
            parameter("tracks", "1", "wheels that press a track of their own, n")
                .must_be(Bound::NotNegative)
                .usually(2.0, 8.0),
            parameter("width_m", "m", "of a tyre, b").must_be(Bound::Positive).usually(0.1, 1.2),
            parameter("compaction_pressure_pa", "Pa", "at which the snow gives way, p")
                .must_be(Bound::NotNegative)
                .usually(1e3, 1e5),
            parameter("depth_m", "m", "by which it gives way, z")
                .must_be(Bound::NotNegative)
                .usually(0.0, 0.5),
        ],
    };
}

impl Soil for Snow {
    fn resistance_n(&self, contact: &Contact) -> f64 {
        let (c, n, b) = (self.coefficient, self.tracks, self.width_m);
        let (p, z) = (self.compaction_pressure_pa, self.depth_m);
        c * contact.load_n + n * b * p * z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.02 · 100 kN + 2 · 0.5 m · 10 kPa · 0.1 m = 2000 N + 1000 N.
    #[test]
    fn load_and_compaction_add_up() {
        let snow: Snow = ron::from_str(
            "(coefficient: 0.02, tracks: 2, width_m: 0.5, compaction_pressure_pa: 10000, depth_m: 0.1)",
        )
        .unwrap();
        let contact = Contact { load_n: 1e5, speed_m_s: 3.0, position_m: 0.0 };
        assert!((snow.resistance_n(&contact) - 3000.0).abs() < 1e-9);
    }
}
