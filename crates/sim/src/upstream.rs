//! Losses between what drives and the place where the force at the wheels is told.
//!
//! Where that force was recorded, what a transmission loses on the way to it takes nothing from the motion any more; it asks more
//! of what drives. The driveline is asked for the force before those losses, and what it gives arrives less by them.

#![allow(clippy::inline_always, reason = "a part of the balance")]

use crate::Model;
use crate::balance::Sums;
use headland_plugin::{Delivery, Demand};

impl Sums {
    /// Whether anything is lost there.
    #[inline(always)]
    fn loses_upstream(&self) -> bool {
        self.upstream_share != 0.0 || self.upstream_n != 0.0
    }

    /// Lets the recording have the last word on the force; what the model would not have given is made up by no one.
    #[inline(always)]
    pub fn record(&self, delivery: &mut Delivery, force_n: f64, (speed_m_s, way): (f64, f64)) {
        let more_n = self.transmitted_n(force_n, way) - self.transmitted_n(delivery.force_n, way);
        delivery.source_power_w += more_n * speed_m_s;
        delivery.force_n = force_n;
    }

    /// Force before the losses [N], of the one that arrives; both forward, `way` is the direction of motion.
    #[inline(always)]
    pub fn transmitted_n(&self, arriving_n: f64, way: f64) -> f64 {
        if !self.loses_upstream() {
            return arriving_n;
        }
        let whole_n = arriving_n + way * self.upstream_n;
        whole_n / (1.0 - self.upstream_share * (way * whole_n).signum())
    }

    /// Force that arrives [N], of the one before the losses.
    fn arriving_n(&self, transmitted_n: f64, way: f64) -> f64 {
        transmitted_n - way * (self.upstream_n + self.upstream_share * transmitted_n.abs())
    }
}

impl Model {
    /// What the driveline gives behind the losses upstream.
    #[inline(always)]
    pub(crate) fn deliver(
        &self,
        demand: &Demand,
        (sums, way): (&Sums, f64),
        states: &[f64],
        rates: &mut [f64],
    ) -> Delivery {
        if !sums.loses_upstream() {
            return self.driveline.deliver(demand, states, rates);
        }
        let asked_n = sums.transmitted_n(demand.force_n, way);
        let mut delivery = self.driveline.deliver(&Demand { force_n: asked_n, ..*demand }, states, rates);
        // What was asked for arrives as it was asked for, and not by rounding beside it.
        delivery.force_n =
            if delivery.force_n == asked_n { demand.force_n } else { sums.arriving_n(delivery.force_n, way) };
        delivery
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_arrives_is_what_was_transmitted_less_the_losses_either_way() {
        let sums = Sums { upstream_share: 0.1, upstream_n: 200.0, ..Sums::default() };
        // 10 kN pull: 9 kN less 200 N arrive; braking, what drives has less to hold than the wheels give.
        assert!((sums.arriving_n(10_000.0, 1.0) - 8_800.0).abs() < 1e-9);
        assert!((sums.arriving_n(-10_000.0, 1.0) + 11_200.0).abs() < 1e-9);
        for (force_n, way) in [(8_800.0, 1.0), (-11_200.0, 1.0), (-8_800.0, -1.0), (50.0, 1.0)] {
            let there = sums.transmitted_n(force_n, way);
            assert!((sums.arriving_n(there, way) - force_n).abs() < 1e-9, "{force_n}: {there}");
        }
        assert_eq!(Sums::default().transmitted_n(5.0, 1.0), 5.0);
    }
}
