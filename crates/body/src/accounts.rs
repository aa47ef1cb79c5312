//! The work of one step, booked with the mean of the velocities before and after it.
//!
//! A force that is held over a step changes kinetic energy by its product with that mean exactly; so what the ledger leaves
//! over is the error of potential and elastic energy, which only positions know.

use crate::spin::Turned;
use crate::wheel::Wheel;
use crate::world::State;
use headland_sim::Stepped;
use rapier3d_f64::prelude::Vector;

/// What a body takes beside what every run knows [J].
#[allow(clippy::struct_field_names, reason = "each name ends in its unit")]
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Own {
    /// Slip across the wheels.
    pub side_j: f64,
    /// Damping of the tyres.
    pub damping_j: f64,
    /// That of the suspension.
    pub suspension_j: f64,
}

/// The step from `before` to `after`.
pub(crate) struct Step<'a> {
    pub before: &'a State,
    pub after: &'a State,
    pub lasts_s: f64,
    pub way: f64,
    pub weight_n: f64,
    pub hitch: Vector,
    pub turned: Turned,
}

impl Step<'_> {
    /// Mean velocity of what is fixed to the vehicle at a point [m/s].
    fn velocity_at(&self, point: Vector) -> Vector {
        let velocity = (self.before.velocity + self.after.velocity) * 0.5;
        let turning = (self.before.turning + self.after.turning) * 0.5;
        velocity + turning.cross(point - self.before.centre)
    }

    /// Work of the step; `rolling_m_s` is the mean speed of each wheel.
    pub fn work(&self, wheels: &[Wheel], rolling_m_s: impl Fn(usize) -> f64, own: &mut Own) -> Stepped {
        let Self { lasts_s, way, before, turned, .. } = *self;
        let ahead = before.ahead();
        let mut stepped = Stepped {
            forward_m: lasts_s * self.velocity_at(before.centre).dot(ahead),
            hitch_m: lasts_s * self.velocity_at(self.hitch).dot(ahead),
            driven_m: turned.driven_m,
            way,
            slope_j: self.weight_n * (self.after.centre.z - before.centre.z),
            brakes_j: turned.brakes_j,
            ..Stepped::default()
        };
        for (index, wheel) in wheels.iter().enumerate() {
            let velocity = self.velocity_at(wheel.touch.point);
            let along_m_s = velocity.dot(wheel.touch.along);
            let closing_m_s = -velocity.dot(wheel.touch.normal);
            let elastic_n = wheel.stiffness_n_m * wheel.touch.deflection_m.max(0.0);
            let felt = &wheel.felt;
            stepped.slip_j += lasts_s * felt.gross_n * (rolling_m_s(index) - along_m_s);
            let hub_m_s = self.velocity_at(wheel.touch.hub()).dot(wheel.touch.along);
            stepped.soil_j +=
                lasts_s * (way * felt.resistance_n * hub_m_s + wheel.touch.load_n * wheel.sinking_m_s);
            own.side_j -= lasts_s * felt.side_n * velocity.dot(wheel.touch.across);
            let pressing_m_s = closing_m_s - wheel.sinking_m_s;
            let squeezing_m_s = wheel.strut.map_or(0.0, |strut| strut.rate_m_s);
            own.damping_j += lasts_s * (wheel.touch.load_n - elastic_n) * (pressing_m_s - squeezing_m_s);
            if let Some(strut) = wheel.strut {
                let springing_n = strut.stiffness_n_m * strut.squeezed_m;
                own.suspension_j += lasts_s * (wheel.carried_n() - springing_n) * squeezing_m_s;
                if let Some(hub) = strut.unsprung {
                    stepped.slope_j += lasts_s * hub.weight_n * wheel.touch.normal.z * hub.squeezing_m_s;
                }
            }
        }
        stepped
    }
}
