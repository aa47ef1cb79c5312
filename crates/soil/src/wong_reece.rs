//! A rigid wheel by the stresses along its contact.
//!
//! σ(θ) = k rⁿ (cos θ − cos θ₁)ⁿ                                        θ_m ≤ θ ≤ θ₁, before the greatest stress
//! σ(θ) = k rⁿ (cos [θ₁ − (θ − θ₂)/(θ_m − θ₂) (θ₁ − θ_m)] − cos θ₁)ⁿ     θ₂ ≤ θ ≤ θ_m, behind it
//! θ_m = (c₁ + c₂ s) θ₁,  j = r [(θ₁ − θ) − (1 − s)(sin θ₁ − sin θ)],  τ = (c + σ tan φ)(1 − e^(−j/K))
//! W = b r ∫ (σ cos θ + τ sin θ) dθ,  T/r = b r ∫ τ dθ,  DP = b r ∫ (τ cos θ − σ sin θ) dθ
//!
//! Source: Wong and Reece, "Prediction of rigid wheel performance based on the analysis of soil-wheel stresses", Journal of
//! Terramechanics 4 (1967), part I 81-98, part II 7-25; formulae from memory, with the exponent of Bekker's pressure.
//!
//! The angle of entry θ₁ is where the soil carries the load. Both parts of the contact are integrated by Gauss-Legendre
//! quadrature in t with θ − end ∝ t², which takes the edge off the root-like stress at the ends. The motion resistance is
//! T/r − DP. Later passes pay the share of the first pass' resistance that Bekker's work of compaction gives.
//! Where a braked wheel (s < 0) shears backward its j is negative and so is its τ; θ_m is that without slip.

use crate::earth::{EARTH, EARTH_ABOUT};
use crate::shear::mobilised;
use crate::{Earth, SUNK, quadrature};
use headland_plugin::{Bound, Card, Contact, Footing, Plugin, Refusal, Soil, WheelContact, parameter};
use serde::Deserialize;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

/// A soil of one earth below wheels that do not give.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WongReece {
    earth: Earth,
    maximum_offset: f64,
    maximum_by_slip: f64,
    exit_angle_rad: f64,
    multipass_exponent: f64,
    #[serde(skip)]
    nodes: Vec<(f64, f64)>,
}

/// Nodes of each part of the contact: with as many, forces are exact to 10⁻⁶ for n from 0.1 up.
const NODES: usize = 16;

impl Plugin for WongReece {
    const CARD: Card = Card {
        name: "WongReece",
        about: "a rigid wheel by the normal and shear stresses along its contact",
        equation: "σ = k rⁿ (cos θ − cos θ₁)ⁿ before θ_m = (c₁ + c₂ s) θ₁, mirrored behind; τ = (c + σ tan φ)(1 − \
                   e^(−j/K)); W = b r ∫(σ cos θ + τ sin θ)dθ; T/r = b r ∫τ dθ; DP = b r ∫(τ cos θ − σ sin θ)dθ",
        source: "Wong and Reece, Prediction of rigid wheel performance based on the analysis of soil-wheel stresses, Journal \
                 of Terramechanics 4 (1967); Janosi and Hanamoto (1961); formulae from memory",
        validity: "driven rigid wheels in homogeneous soil: tyres at a pressure that does not let them flatten; braked \
                   wheels by symmetry; needs a vehicle with axles; slow",
        parameters: &[
            parameter("earth", EARTH, EARTH_ABOUT),
            parameter("maximum_offset", "1", "greatest stress lies at this share of the entry angle, c₁")
                .must_be(Bound::Within(0.0, 1.0))
                .usually(0.15, 0.5),
            parameter("maximum_by_slip", "1", "by which slip moves it, c₂")
                .must_be(Bound::Within(0.0, 1.0))
                .usually(0.0, 0.4),
            parameter(
                "exit_angle_rad",
                "rad",
                "where the contact ends, behind the lowest point (negative) or at it, θ₂",
            )
            .must_be(Bound::Within(-0.5, 0.0))
            .usually(-0.3, 0.0),
            parameter("multipass_exponent", "1", "a: 2 to 3 loose, 3 to 4 medium, 4 to 5 firm soil")
                .must_be(Bound::Positive)
                .usually(2.0, 5.0),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        self.earth.check("earth")?;
        let furthest = self.maximum_offset + self.maximum_by_slip;
        if furthest >= 1.0 {
            return Err(Refusal {
                parameter: "maximum_by_slip".to_owned(),
                found: format!("{} beside {}", self.maximum_by_slip, self.maximum_offset),
                expected: "a sum with `maximum_offset` below 1: the stress is greatest within the contact"
                    .to_owned(),
            });
        }
        self.nodes = quadrature::nodes(NODES);
        Ok(())
    }
}

/// Forces of a wheel per its width and radius, and entry angle.
#[derive(Clone, Copy, Debug, Default)]
struct Stresses {
    /// ∫ (σ cos θ + τ sin θ) dθ [Pa].
    lift: f64,
    /// ∫ τ dθ [Pa].
    torque: f64,
    /// ∫ (τ cos θ − σ sin θ) dθ [Pa].
    pull: f64,
}

impl WongReece {
    /// Integrates over the contact that begins at `entry` (θ₁).
    fn integrate(&self, contact: &WheelContact, entry: f64) -> Stresses {
        let (n, s) = (self.earth.exponent, contact.slip);
        let (b, r) = (contact.tyre.width_m, 0.5 * contact.tyre.diameter_m);
        let (cohesion, tan) = (self.earth.cohesion_pa, self.earth.friction_angle_rad.tan());
        let scale = self.earth.stiffness(b) * r.powf(n);
        let greatest = (self.maximum_offset + self.maximum_by_slip * s.max(0.0)) * entry;
        let exit = self.exit_angle_rad.max(-entry);
        let sin_entry = entry.sin();
        let mut sum = Stresses::default();
        let mut add = |angle: f64, like: f64, weight: f64| {
            // cos θ − cos θ₁ without cancellation.
            let depth = 2.0 * (0.5 * (entry + like)).sin() * (0.5 * (entry - like)).sin();
            let normal = scale * depth.powf(n);
            let (sin, cos) = angle.sin_cos();
            let displacement = r * ((entry - angle) - (1.0 - s) * (sin_entry - sin));
            let shear = (cohesion + normal * tan) * mobilised(displacement / self.earth.shear_displacement_m);
            sum.lift += weight * (normal * cos + shear * sin);
            sum.torque += weight * shear;
            sum.pull += weight * (shear * cos - normal * sin);
        };
        for (t, weight) in &self.nodes {
            let (before, behind) = ((entry - greatest) * t * t, (greatest - exit) * t * t);
            add(entry - before, entry - before, weight * 2.0 * t * (entry - greatest));
            if greatest > exit {
                // The same stress as at the mirrored angle before the greatest.
                let like = entry - t * t * (entry - greatest);
                add(exit + behind, like, weight * 2.0 * t * (greatest - exit));
            }
        }
        sum
    }

    /// The entry angle at which the soil carries the load; `None` where the wheel would sink to its hub.
    fn entry(&self, contact: &WheelContact) -> Option<f64> {
        const RELATIVE_TOLERANCE: f64 = 1e-14;
        const MOST_ITERATIONS: usize = 100;
        let area = 0.5 * contact.tyre.width_m * contact.tyre.diameter_m;
        let short = |entry: f64| self.integrate(contact, entry).lift * area - contact.load_n;
        if contact.load_n == 0.0 {
            return Some(0.0);
        }
        let (mut low, mut at_low) = (0.0, -contact.load_n);
        let mut high = self.guess(contact).clamp(1e-6, FRAC_PI_2);
        let mut at_high = short(high);
        while at_high < 0.0 {
            if high >= FRAC_PI_2 {
                return None;
            }
            (low, at_low) = (high, at_high);
            high = (1.3 * high).min(FRAC_PI_2);
            at_high = short(high);
        }
        // Illinois variant of the secant method: both ends close in.
        let mut side = 0;
        for _ in 0..MOST_ITERATIONS {
            let middle = (low * at_high - high * at_low) / (at_high - at_low);
            let at_middle = short(middle);
            if at_middle.abs() <= RELATIVE_TOLERANCE * contact.load_n
                || high - low <= RELATIVE_TOLERANCE * high
            {
                return Some(middle);
            }
            if at_middle > 0.0 {
                (high, at_high) = (middle, at_middle);
                if side == 1 {
                    at_low *= 0.5;
                }
                side = 1;
            } else {
                (low, at_low) = (middle, at_middle);
                if side == -1 {
                    at_high *= 0.5;
                }
                side = -1;
            }
        }
        Some(0.5 * (low + high))
    }

    /// Entry angle by Bekker's rigid wheel.
    fn guess(&self, contact: &WheelContact) -> f64 {
        let (n, d) = (self.earth.exponent, contact.tyre.diameter_m);
        let b = contact.tyre.width_m;
        let sinkage = (3.0 * contact.load_n / ((3.0 - n) * b * self.earth.stiffness(b) * d.sqrt()))
            .powf(2.0 / (2.0 * n + 1.0));
        (1.0 - 2.0 * sinkage / d).max(0.0).acos()
    }
}

impl Soil for WongReece {
    fn resistance_n(&self, _: &Contact) -> f64 {
        f64::NAN
    }

    fn wheel(&self, contact: &WheelContact) -> Option<Footing> {
        let Some(entry) = self.entry(contact) else { return Some(SUNK) };
        let Stresses { torque, pull, .. } = self.integrate(contact, entry);
        let radius = 0.5 * contact.tyre.diameter_m;
        let area = contact.tyre.width_m * radius;
        let later = self.earth.later_work(contact.earlier_passes, self.multipass_exponent);
        let deepened = Earth::deepened(contact.earlier_passes + 1, self.multipass_exponent);
        Some(Footing {
            gross_traction_n: area * torque,
            motion_resistance_n: (area * (torque - pull)).max(0.0) * later,
            sinkage_m: radius * (1.0 - entry.cos()) * deepened,
        })
    }

    fn needs_axles(&self) -> bool {
        true
    }
}

#[cfg(test)]
#[path = "wong_reece_tests.rs"]
mod tests;
