//! What shaking costs: tyres and dampers turn it into heat, and the motion pays for it.
//!
//! F = P / max(v, v₀),   P = m τ ⟨a²⟩        ⟨a²⟩ the mean square of the vertical acceleration, v₀ = 0.5 m/s
//!
//! Of a mass on springs k with dampers c beside them the dampers take P = c ⟨ẋ²⟩, x how far the springs are squeezed. They
//! shake the mass by m a = −k x − c ẋ; so a wave of the frequency ω in a loses P = (m² / c) ⟨a²⟩ (τω)² / (1 + (τω)²) with τ = c / k. About the
//! natural frequency, ω² = k / m, where springs and dampers as soft as tyres let nearly all of it be, that is m τ ⟨a²⟩.
//! Pitch and roll lose what they have beside the bounce: τ, as the bounce alone shows it, is larger by their share.
//!
//! Source: balance of power of one mass on spring and damper, as in Wong, *Theory of Ground Vehicles* (2008), chapter 7; that the
//! motion pays for it: Smith and Swift, "Power dissipation in automotive suspensions", Vehicle System Dynamics 49 (2011) 59.
//! Holds for τω ≪ 1, on ground that is alike over two seconds. Slower than v₀ the force is what it is at v₀: an engine shakes a
//! vehicle that stands. The mean square is that of two seconds of the recording; a run without one has that of `vertical_acceleration_m_s2`.
//! Fingerprint: a drag with the square of the shaking, over the speed; none on smooth ground of the same soil.

use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// Slower, what shakes a vehicle need not be its motion [m/s].
const SLOWEST_M_S: f64 = 0.5;

/// Power that shaking takes.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Roughness {
    time_constant_s: f64,
    #[serde(default)]
    vertical_acceleration_m_s2: f64,
}

impl Plugin for Roughness {
    const CARD: Card = Card {
        name: "roughness",
        about: "power that tyres and dampers take where the ground shakes the vehicle",
        equation: "F = m τ ⟨a²⟩ / max(v, 0.5 m/s)",
        source: "power of a damper beside a spring, as in Wong, Theory of Ground Vehicles (2008), chapter 7; Smith and Swift, \
                 Vehicle System Dynamics 49 (2011) 59",
        validity: "ground that is alike over two seconds; pitch and roll in proportion to the bounce",
        parameters: &[
            parameter("time_constant_s", "s", "damping over stiffness of what the vehicle springs on, τ")
                .must_be(Bound::NotNegative)
                .usually(0.002, 0.15),
            parameter(
                "vertical_acceleration_m_s2",
                "m/s²",
                "of the shaking, root mean square, in a run for which none was recorded",
            )
            .must_be(Bound::NotNegative)
            .usually(0.0, 5.0)
            .or(0.0),
        ],
    };
}

impl Effect for Roughness {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let own_m2_s4 = self.vertical_acceleration_m_s2 * self.vertical_acceleration_m_s2;
        let power_w = at.mass_kg * self.time_constant_s * at.shaking_m2_s4.unwrap_or(own_m2_s4);
        Action { resistance_n: power_w / at.speed_m_s.abs().max(SLOWEST_M_S), ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    /// 2000 kg · 10 ms · 4 m²/s⁴ = 80 W, 8 N at 10 m/s.
    #[test]
    fn a_shaken_vehicle_by_hand_recorded_or_not() {
        let mut at = at_10_m_s();
        assert!(same(
            act::<Roughness>("(time_constant_s: 0.01, vertical_acceleration_m_s2: 2.0)", &at).resistance_n,
            8.0
        ));
        at.shaking_m2_s4 = Some(1.0);
        assert!(same(
            act::<Roughness>("(time_constant_s: 0.01, vertical_acceleration_m_s2: 2.0)", &at).resistance_n,
            2.0
        ));
    }

    #[test]
    fn backward_and_at_rest_it_resists_and_does_not_grow_beyond_all_bounds() {
        let mut at = at_10_m_s();
        at.shaking_m2_s4 = Some(4.0);
        for (speed_m_s, expected_n) in [(-10.0, 8.0), (0.5, 160.0), (0.1, 160.0), (0.0, 160.0)] {
            at.speed_m_s = speed_m_s;
            let found = act::<Roughness>("(time_constant_s: 0.01)", &at).resistance_n;
            assert!(same(found, expected_n), "{speed_m_s}: {found}");
        }
    }

    /// A mass on spring and damper, shaken by its ground at its natural frequency: the damper's work over some thousand
    /// periods, which this law knows by the vertical acceleration alone. Here τω = 0.13, and (τω)² of it is left out.
    #[test]
    fn a_mass_on_a_damped_spring_loses_what_the_law_says() {
        let (mass_kg, stiffness_n_m, damping_n_s_m) = (2000.0, 4e5, 3.8e3);
        let omega = f64::sqrt(stiffness_n_m / mass_kg);
        let step_s = 1e-3;
        let (mut height_m, mut rising_m_s) = (0.0, 0.0);
        let (mut work_j, mut squares, mut count) = (0.0, 0.0, 0.0);
        for step in 0..400_000 {
            let phase = omega * step_s * f64::from(step);
            let squeezed_m = 0.01 * phase.sin() - height_m;
            let squeezing_m_s = 0.01 * omega * phase.cos() - rising_m_s;
            let rise_m_s2 = (stiffness_n_m * squeezed_m + damping_n_s_m * squeezing_m_s) / mass_kg;
            rising_m_s += step_s * rise_m_s2;
            height_m += step_s * rising_m_s;
            if step > 20_000 {
                work_j += step_s * damping_n_s_m * squeezing_m_s * squeezing_m_s;
                squares += rise_m_s2 * rise_m_s2;
                count += 1.0;
            }
        }
        let mut at = at_10_m_s();
        at.shaking_m2_s4 = Some(squares / count);
        let law = format!("(time_constant_s: {:?})", damping_n_s_m / stiffness_n_m);
        let said_w = act::<Roughness>(&law, &at).resistance_n * at.speed_m_s;
        let power_w = work_j / (count * step_s);
        assert!((said_w / power_w - 1.0).abs() < 0.03, "{said_w} W, {power_w} W");
    }

    #[test]
    fn what_tyres_spring_on_has_to_be_given() {
        assert!(build::<Roughness>("(vertical_acceleration_m_s2: 2.0)").is_err());
    }
}
