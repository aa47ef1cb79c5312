//! What ground and driveline make of a command, for a vehicle that rolls as a whole.

#![allow(clippy::inline_always, reason = "a part of the balance")]

use crate::balance::{Asked, Command, Followed, Rolled, Sums};
use crate::deciding::Deciding;
use crate::{Model, Resistance};
use headland_plugin::{Contact, Situation};

impl Model {
    /// The forces of a vehicle that rolls as a whole.
    #[inline(always)]
    pub(crate) fn rolling<const DECIDES: bool>(
        &self,
        asked: &Asked,
        sums: &Sums,
        rates: &mut [f64],
        deciding: &mut Deciding,
    ) -> Rolled {
        let Asked { mut situation, command, given, layout, states, direction, .. } = *asked;
        let Asked { effective_mass_kg, free_n, mut demand, .. } = *asked;
        let speed_m_s = situation.speed_m_s;
        let ground_n = self.ground_n(&situation, (speed_m_s * direction).max(0.0));
        // An effect may say that the ground resists less, and never that it drives.
        let sampled = given.followed == Followed::Sampled;
        let least_n = if sampled { f64::NEG_INFINITY } else { -(sums.resistance_n + sums.drawbar_n) };
        let ground_n = ground_n.max(least_n);
        let held_n = ground_n + sums.resistance_n + sums.drawbar_n;

        let range = layout.driveline.clone();
        let lost_n = |force_n: f64| sums.loss_share * force_n.abs();
        let wanted_n = match command {
            Command::Coast => 0.0,
            Command::Recorded(force_n) => force_n,
            Command::Accelerate(wanted) => {
                let way = asked.way();
                let resting = speed_m_s == 0.0 && wanted == 0.0;
                let ground_n = if resting { 0.0 } else { effective_mass_kg * wanted - free_n + way * held_n };
                // F − way ε |F| = ground.
                if sums.loss_share == 0.0 {
                    ground_n
                } else {
                    ground_n / (1.0 - sums.loss_share * (way * ground_n).signum())
                }
            }
            Command::Push(wanted) => effective_mass_kg * wanted,
        };
        situation.tractive_force_n = wanted_n;
        demand.force_n = self.govern(&situation, command, given, layout, states, rates);
        demand.speed_m_s = sums.turning_m_s(speed_m_s, demand.force_n, direction);
        let mut own = &states[range.clone()];
        if DECIDES && !sums.slips() && !own.is_empty() {
            own = deciding.decide(&*self.driveline, &demand, own, &rates[range.clone()]);
        }
        let behind = (sums, asked.way());
        let mut delivery = self.deliver(&demand, behind, own, &mut rates[range.clone()]);
        // A recorded motion was driven by what it took, and a recorded force was there, whatever the driveline of the model
        // could have given.
        let recorded = given.is_driven() || matches!(command, Command::Recorded(_));
        if sums.slips() && delivery.force_n != demand.force_n && !recorded {
            demand.speed_m_s = sums.turning_m_s(speed_m_s, delivery.force_n, direction);
            delivery = self.deliver(&demand, behind, own, &mut rates[range]);
        }
        if let Command::Recorded(force_n) = command {
            sums.record(&mut delivery, force_n, (demand.speed_m_s, asked.way()));
        }
        let brake_n = asked.brake_n(|| {
            let more_n = (delivery.force_n - wanted_n) * direction;
            more_n - lost_n(delivery.force_n) + lost_n(wanted_n)
        });
        let driving_n = delivery.force_n + free_n;
        let held_n = held_n + lost_n(delivery.force_n);
        let (brake_n, locked) = if self.vehicle.brake_friction == f64::INFINITY {
            (brake_n, false)
        } else {
            // What the drive brakes and what resists the wheels is held by the same ground.
            let carried_n = situation.mass_kg * self.gravity_m_s2 * situation.place.cos_slope();
            let overrun_n = (-asked.way() * delivery.force_n).max(0.0);
            let most_n = self.vehicle.brake_friction * carried_n - overrun_n - ground_n;
            asked.held_by_ground(brake_n, most_n, driving_n, held_n)
        };
        let resisting_n = held_n + brake_n;
        let (way, acceleration_m_s2) = asked.moves(driving_n, resisting_n);
        Rolled {
            demand,
            delivery,
            ground_n,
            brake_n,
            way,
            acceleration_m_s2,
            traction_n: delivery.force_n,
            slip: 0.0,
            rolling_m_s: speed_m_s,
            locked,
        }
    }

    /// Resistance of the ground to a whole vehicle [N].
    #[inline(always)]
    fn ground_n(&self, situation: &Situation, rolling_speed: f64) -> f64 {
        let Situation { position_m, ref place, .. } = *situation;
        match self.vehicle.resistance {
            Resistance::Drag { .. } => {
                let weight_n = situation.mass_kg * self.gravity_m_s2;
                let load_n = if place.sin_slope == 0.0 { weight_n } else { weight_n * place.cos_slope() };
                let contact = Contact { load_n, speed_m_s: rolling_speed, position_m };
                self.soil.as_ref().map_or(0.0, |soil| soil.resistance_at_n(&contact, place))
            }
            Resistance::RoadLoad { f0_n, f1_n_s_m, .. } => {
                // The constant part goes with the mass: UN GTR 15, annex 4, correction K1.
                let carried = situation.mass_kg / self.vehicle.mass_kg;
                carried * f0_n + f1_n_s_m * rolling_speed
            }
        }
    }
}
