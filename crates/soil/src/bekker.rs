//! A wheel that presses a rut, by Bekker.
//!
//! p = k zⁿ,  k = k_c / b + k_φ
//! rigid:     z₀ = (3 W / ((3 − n) b k √D))^(2 / (2n + 1))                 where k z₀ⁿ stays below the tyre's pressure p_g
//! flexible:  z₀ = (p_g / k)^(1/n),  L = (W − b k √D z₀^(n+½) (3 − n)/3) / (b p_g) + √(D z₀ − z₀²)
//! R = b k z^(n+1) / (n + 1) + R_b + f W                                   compaction, bulldozing, the tyre itself
//! H = (b L c + W tan φ) [1 − K/(s L) (1 − e^(−s L / K))] + f W            gross traction
//!
//! Source: Bekker, *Introduction to Terrain-Vehicle Systems* (1969), part II; Wong, *Theory of Ground Vehicles* (2008),
//! sections 2.4 to 2.6, for the flexible tyre and its contact; formulae from memory. Slip-sinkage after Lyasko (2010), shear
//! after Janosi and Hanamoto (1961), bulldozing after Hegedus (1960).
//!
//! The rut after N passes is N^(1/a) times as deep as after one, and a pass pays for what it adds. Later passes shear a
//! contact as long as the first one's. The tyre's own resistance is overcome by its own torque, so it stands in both forces.
//! Holds for n ≤ 1.3 and a sinkage below a sixth of the diameter; leaves out lugs, the rate of loading and layers.

use crate::bulldozing::Bulldozing;
use crate::earth::{EARTH, EARTH_ABOUT};
use crate::shear::mobilised_along;
use crate::slip_sinkage::deepening;
use crate::{Earth, SUNK};
use headland_plugin::{Bound, Card, Contact, Footing, Plugin, Refusal, Soil, WheelContact, parameter};
use serde::Deserialize;
use std::path::Path;

/// A soil of one earth.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bekker {
    earth: Earth,
    tyre_resistance: f64,
    bulldozing: bool,
    slip_sinkage: f64,
    multipass_exponent: f64,
    #[serde(skip)]
    pushed: Bulldozing,
}

impl Plugin for Bekker {
    const CARD: Card = Card {
        name: "Bekker",
        about: "a rigid or flexible wheel that presses a rut, with bulldozing, slip-sinkage and later passes",
        equation: "p = (k_c/b + k_φ) zⁿ; R = b k z^(n+1)/(n + 1) + R_b + f W; H = (b L c + W tan φ)[1 − K/(s L)(1 − e^(−s \
                   L/K))] + f W; z = z₀ ((1 + s)/(1 − s/2))^q N^(1/a)",
        source: "Bekker, Introduction to Terrain-Vehicle Systems (1969), part II; Wong, Theory of Ground Vehicles (2008), \
                 sections 2.4 to 2.6; Janosi and Hanamoto (1961); Hegedus (1960); Lyasko (2010); formulae from memory",
        validity: "homogeneous soil, n up to 1.3, sinkage below a sixth of the diameter; leaves out lugs, rate of loading, \
                   layers; needs a vehicle with axles",
        parameters: &[
            parameter("earth", EARTH, EARTH_ABOUT),
            parameter("tyre_resistance", "1", "resistance of the tyre itself per load, as on hard ground, f")
                .must_be(Bound::NotNegative)
                .usually(0.0, 0.06),
            parameter("bulldozing", "(true | false)", "whether the wheel pushes soil before it, R_b"),
            parameter("slip_sinkage", "1", "how much slip digs, q: 1 as published, 0 not at all")
                .must_be(Bound::Within(0.0, 2.0))
                .usually(0.0, 1.0),
            parameter("multipass_exponent", "1", "a: 2 to 3 loose, 3 to 4 medium, 4 to 5 firm soil")
                .must_be(Bound::Positive)
                .usually(2.0, 5.0),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        self.earth.check("earth")?;
        self.pushed = Bulldozing::of(&self.earth);
        Ok(())
    }
}

/// How a wheel without slip stands on fresh soil.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stand {
    /// Depth of the rut [m].
    sinkage_m: f64,
    /// Length of the contact [m].
    length_m: f64,
}

impl Bekker {
    /// The wheel sinks until the soil carries it, or until the tyre flattens against it.
    fn stand(&self, contact: &WheelContact) -> Option<Stand> {
        let n = self.earth.exponent;
        let (b, d, w) = (contact.tyre.width_m, contact.tyre.diameter_m, contact.load_n);
        let k = self.earth.stiffness(b);
        let carried = |z: f64| b * k * d.sqrt() * z.powf(n + 0.5) * (3.0 - n) / 3.0;
        let rigid_m = (3.0 * w / ((3.0 - n) * b * k * d.sqrt())).powf(2.0 / (2.0 * n + 1.0));
        let pressure = contact.tyre.ground_pressure_pa();
        let flexible_m = (pressure / k).powf(1.0 / n);
        let sinkage_m = rigid_m.min(flexible_m);
        // Not deeper than the hub: beyond, no wheel rolls.
        if sinkage_m.is_nan() || sinkage_m >= 0.5 * d {
            return None;
        }
        let curved_m = (d * sinkage_m - sinkage_m * sinkage_m).sqrt();
        let flat_m = if flexible_m < rigid_m { (w - carried(flexible_m)) / (b * pressure) } else { 0.0 };
        Some(Stand { sinkage_m, length_m: curved_m + flat_m })
    }
}

impl Soil for Bekker {
    fn resistance_n(&self, _: &Contact) -> f64 {
        f64::NAN
    }

    fn wheel(&self, contact: &WheelContact) -> Option<Footing> {
        let Some(Stand { sinkage_m, length_m }) = self.stand(contact) else { return Some(SUNK) };
        let Earth { cohesion_pa: c, friction_angle_rad: phi, shear_displacement_m: k, .. } = self.earth;
        let (b, w, s, f) = (contact.tyre.width_m, contact.load_n, contact.slip, self.tyre_resistance);
        let dug_m = sinkage_m * deepening(s, self.slip_sinkage);
        let (earlier, a) = (contact.earlier_passes, self.multipass_exponent);
        let (before, after) = (Earth::deepened(earlier, a), Earth::deepened(earlier + 1, a));
        let compaction = self.earth.compaction_n(b, dug_m) * self.earth.later_work(earlier, a);
        let bulldozing =
            if self.bulldozing { self.pushed.resistance_n(b, (after - before) * dug_m) } else { 0.0 };
        let thrust = (b * length_m * c + w * phi.tan()) * mobilised_along(s * length_m / k);
        Some(Footing {
            gross_traction_n: thrust + f * w,
            motion_resistance_n: compaction + bulldozing + f * w,
            sinkage_m: after * dug_m,
        })
    }

    fn needs_axles(&self) -> bool {
        true
    }
}

#[cfg(test)]
#[path = "bekker_tests.rs"]
mod tests;
