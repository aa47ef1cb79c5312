//! A wheel for tests: the 900/60 R38 of the coast-down study under a quarter of its tractor.

use crate::Earth;
use headland_plugin::{Place, Plugin, Tyre, WheelContact};
use std::path::Path;

/// A quarter of 13 019.3 kg at 9.81 m/s² [N].
pub const LOAD_N: f64 = 13_019.3 * 9.81 / 4.0;

/// Nominal sizes of the marking.
pub const XERION: Tyre = Tyre {
    width_m: 0.9,
    diameter_m: 2.045,
    section_height_m: 0.54,
    inflation_pa: 1.5e5,
    carcass_pa: 0.0,
    stiffness_n_per_m: None,
};

/// It rolls without slip on fresh ground.
pub const ON: WheelContact<'static> = WheelContact {
    tyre: &XERION,
    load_n: LOAD_N,
    slip: 0.0,
    speed_m_s: 2.0,
    earlier_passes: 0,
    position_m: 0.0,
    place: Place {
        elevation_m: 0.0,
        sin_slope: 0.0,
        heading_rad: 0.0,
        sin_roll: 0.0,
        curvature_per_m: 0.0,
        east_m: 0.0,
        north_m: 0.0,
    },
};

/// Dry sand of the Land Locomotion Laboratory; its density is general knowledge.
pub const DRY_SAND: Earth = Earth {
    exponent: 1.1,
    cohesive_modulus: 990.0,
    frictional_modulus: 1_528_430.0,
    cohesion_pa: 1040.0,
    friction_angle_rad: 0.488_692_190_558_412_4,
    shear_displacement_m: 0.01,
    density_kg_m3: 1500.0,
};

/// A soil as scenarios write it.
pub fn read<S: Plugin>(text: &str) -> S {
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let mut soil: S = options.from_str(text).unwrap();
    soil.settle(Path::new("")).unwrap();
    soil
}
