//! How a machine comes along: how much of it the vehicle carries, and what its own wheels and the air take.
//!
//! R = c_r (1 − k) m g cos θ        k: share that the vehicle carries
//! F_air = −½ ρ C_d A |v − w| (v − w)ₓ
//!
//! Source: definition of the rolling coefficient; the drag equation in its vector form.
//! Its wheels see one coefficient on every ground; what it carries is spread as the machine itself is.

use headland_plugin::{Implement, Load, Refusal, Situation};
use serde::Deserialize;

/// A machine on its own wheels, or on those of the vehicle.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Carriage {
    mass_kg: f64,
    carried_share: f64,
    rolling_coefficient: f64,
    drag_area_m2: f64,
}

impl Carriage {
    /// Checks what it was read as.
    ///
    /// # Errors
    /// [`Refusal`] names the parameter.
    pub fn check(&self) -> Result<(), Refusal> {
        let refuse = |name: &str, found: f64, expected: &str| Refusal {
            parameter: format!("carriage.{name}"),
            found: found.to_string(),
            expected: expected.to_owned(),
        };
        for (name, value) in [
            ("mass_kg", self.mass_kg),
            ("rolling_coefficient", self.rolling_coefficient),
            ("drag_area_m2", self.drag_area_m2),
        ] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(refuse(name, value, "0 or more"));
            }
        }
        if !(0.0..=1.0).contains(&self.carried_share) {
            return Err(refuse("carried_share", self.carried_share, "0 to 1"));
        }
        Ok(())
    }

    /// What coming along takes, with a payload on it.
    pub fn load(&self, at: &Situation, payload_kg: f64) -> Load {
        let mass_kg = self.mass_kg + payload_kg;
        let towed_mass_kg = (1.0 - self.carried_share) * mass_kg;
        let rolling_n = self.rolling_coefficient * towed_mass_kg * at.gravity_m_s2 * at.place.cos_slope();
        let force_n = if self.drag_area_m2 == 0.0 {
            0.0
        } else {
            at.air.drag_n(self.drag_area_m2, at.speed_m_s, at.place.heading_rad)
        };
        Load {
            drawbar_force_n: rolling_n,
            force_n,
            mass_kg: self.carried_share * mass_kg,
            towed_mass_kg,
            ..Load::default()
        }
    }
}

/// What carrying a payload takes: on a machine that comes along, or else on the vehicle itself.
pub(crate) fn load(carriage: Option<&Carriage>, at: &Situation, payload_kg: f64) -> Load {
    carriage.map_or(Load { mass_kg: payload_kg, ..Load::default() }, |carriage| carriage.load(at, payload_kg))
}

/// A machine that hangs on the hitch and passes over the ground; `None` where it rolls on wheels of its own.
pub(crate) fn mounted(carriage: Option<&Carriage>, width_m: f64) -> Option<Implement> {
    let hangs = carriage.is_none_or(|carriage| carriage.carried_share == 1.0);
    hangs.then_some(Implement { width_m, depth_m: None, tools: None, lift_m: None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_plugin::{Air, Place};

    /// 8 t, a quarter of it on the hitch, on a 3-4-5 slope: 0.02 · 6000 · 10 · 0.8 = 960 N; ½ · 1.2 · 5 · 4² = 48 N.
    #[test]
    fn a_trailer_by_hand() {
        let carriage =
            Carriage { mass_kg: 3000.0, carried_share: 0.25, rolling_coefficient: 0.02, drag_area_m2: 5.0 };
        let at = Situation {
            speed_m_s: 4.0,
            gravity_m_s2: 10.0,
            place: Place { sin_slope: 0.6, ..Place::default() },
            air: Air { density_kg_m3: 1.2, ..Air::default() },
            ..Situation::default()
        };
        let load = carriage.load(&at, 5000.0);
        assert!((load.drawbar_force_n - 960.0).abs() < 1e-9 && (load.force_n + 48.0).abs() < 1e-9);
        assert_eq!((load.mass_kg, load.towed_mass_kg), (2000.0, 6000.0));
    }

    #[test]
    fn a_share_above_one_is_refused() {
        let text = "(mass_kg: 3000, carried_share: 1.2, rolling_coefficient: 0.02, drag_area_m2: 0)";
        let refusal = ron::from_str::<Carriage>(text).unwrap().check().unwrap_err();
        assert_eq!(refusal.to_string(), "`carriage.carried_share` is 1.2, expected 0 to 1");
    }
}
