//! What a model may look at.

use crate::Place;

/// The air around the vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Air {
    /// Density [kg/m³].
    pub density_kg_m3: f64,
    /// Speed of the wind over ground [m/s].
    pub wind_speed_m_s: f64,
    /// Where the wind blows from, clockwise from north [rad].
    pub wind_from_rad: f64,
    /// Temperature [°C]; NaN where it is not known.
    pub temperature_c: f64,
}

/// The vehicle at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Situation {
    /// Time since the start of the run [s].
    pub time_s: f64,
    /// Distance along the path [m].
    pub position_m: f64,
    /// Whether the path is driven from its end towards its start; `place` is already seen in the direction of travel.
    pub reversed: bool,
    /// How often the path was driven before this run.
    pub passes_before: usize,
    /// Speed over ground [m/s].
    pub speed_m_s: f64,
    /// Acceleration along the motion [m/s²], for powers that follow it; 0 while forces are asked for, which make it.
    pub acceleration_m_s2: f64,
    /// Mass that rests on the wheels [kg].
    pub mass_kg: f64,
    /// Acceleration of gravity [m/s²].
    pub gravity_m_s2: f64,
    /// The ground below.
    pub place: Place,
    /// The air around.
    pub air: Air,
    /// Drag coefficient times frontal area of the body [m²].
    pub drag_area_m2: f64,
    /// Whether the driveline is in neutral.
    pub coasting: bool,
    /// Whether a recording says that the service brakes are on.
    pub braking: bool,
    /// Force of the driven wheels on the vehicle, forward [N].
    pub tractive_force_n: f64,
    /// How hard the vehicle is shaken: its vertical acceleration in the mean square [m²/s⁴]; `None` where nothing says so.
    pub shaking_m2_s4: Option<f64>,
    /// How fast the engine turns [rad/s], for powers that follow it; `None` where the driveline has none, and while forces are
    /// asked for.
    pub engine_speed_rad_s: Option<f64>,
    /// Temperature of the driveline's oil [°C]; `None` where none was recorded.
    pub oil_temperature_c: Option<f64>,
    /// Share of the battery's capacity that is left; `None` where the driveline has none and none was recorded.
    pub state_of_charge: Option<f64>,
    /// Inflation pressure of the tyres above ambient [Pa]; `None` where none was recorded.
    pub tyre_pressure_pa: Option<f64>,
    /// Power that is taken at the power take-off, by tasks or as it was recorded [W],
    pub pto_power_w: f64,
    /// and by the hydraulics.
    pub hydraulic_power_w: f64,
}

impl Air {
    /// Force of the air on the vehicle along its path, forward [N].
    ///
    /// F = −½ ρ C_d A |v − w| (v − w)ₓ, with the wind vector w in the road frame.
    ///
    /// Source: vector form of the drag equation; Hucho, *Aerodynamics of Road Vehicles* (1998), chapter 4.
    /// The drag area is taken as the same from every side.
    #[inline]
    pub fn drag_n(&self, drag_area_m2: f64, speed_m_s: f64, heading_rad: f64) -> f64 {
        if self.wind_speed_m_s == 0.0 {
            return -0.5 * self.density_kg_m3 * drag_area_m2 * speed_m_s.abs() * speed_m_s;
        }
        // A wind from straight ahead blows against the direction of travel.
        let (sin, cos) = (self.wind_from_rad - heading_rad).sin_cos();
        let along = speed_m_s + self.wind_speed_m_s * cos;
        let across = self.wind_speed_m_s * sin;
        -0.5 * self.density_kg_m3 * drag_area_m2 * along.hypot(across) * along
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn air(wind_speed_m_s: f64, wind_from_rad: f64) -> Air {
        Air { density_kg_m3: 1.2, wind_speed_m_s, wind_from_rad, temperature_c: f64::NAN }
    }

    /// ½ · 1.2 · 5 · 10² = 300 N, by hand.
    #[test]
    fn still_air_drags_with_the_square_of_speed() {
        assert!((air(0.0, 0.0).drag_n(5.0, 10.0, 1.0) + 300.0).abs() < 1e-9);
        assert!((air(0.0, 0.0).drag_n(5.0, -10.0, 1.0) - 300.0).abs() < 1e-9);
    }

    #[test]
    fn a_head_wind_adds_to_speed_and_a_tail_wind_takes_from_it() {
        // Northward at 10 m/s: wind from the north by 2 gives ½·1.2·5·12² = 432 N, from the south 8² = 192 N.
        assert!((air(2.0, 0.0).drag_n(5.0, 10.0, 0.0) + 432.0).abs() < 1e-9);
        assert!((air(2.0, PI).drag_n(5.0, 10.0, 0.0) + 192.0).abs() < 1e-9);
    }

    /// 40 CFR 1037.528: wind 7.1 mph at 47° to a vehicle at 64.9 mph meets it with 69.93 mph at 4.26°.
    #[test]
    fn the_published_case_of_an_oblique_wind() {
        let (wind, speed) = (7.1 * 0.447_04, 64.9 * 0.447_04);
        let oblique = air(wind, 47f64.to_radians());
        let met = 69.93 * 0.447_04;
        let expected = -0.5 * 1.2 * 5.0 * met * met * 4.26f64.to_radians().cos();
        assert!((oblique.drag_n(5.0, speed, 0.0) / expected - 1.0).abs() < 2e-4);
    }

    #[test]
    fn a_cross_wind_raises_the_drag_without_turning_it() {
        let cross = air(5.0, FRAC_PI_2).drag_n(5.0, 10.0, 0.0);
        assert!((cross + 0.6 * 5.0 * 125f64.sqrt() * 10.0).abs() < 1e-9);
    }
}
