//! One step of the body, and what a run sees of it.

use super::contact::{forces, tilt, tilted_j};
use super::{Rig, Towed};
use crate::accounts::Step;
use crate::hop::{self, Bearer};
use crate::spin::{Spin, Turned};
use crate::track::heading_of;
use crate::wheel::{Felt, Touch, Wheel};
use crate::world::State;
use headland_sim::{AxleMotion, Carriage, Motion, Push, Stepped};
use rapier3d_f64::prelude::Vector;

/// Resistances come to their whole force on this way: about a rest they are springs, and hold [m].
///
/// Source: Dahl, *A Solid Friction Model* (1968).
const RESTING_M: f64 = 1e-3;
/// A vehicle that has come to rest rocks on its tyres, and has set off beyond this speed [m/s].
const SETS_OFF_M_S: f64 = 0.05;
/// The same where brakes hold every wheel: a hard stop rocks harder, and what goes faster slides [m/s].
pub(super) const SLIDES_M_S: f64 = 0.5;

impl Carriage for Rig<'_> {
    fn motion(&self) -> Motion {
        let mut place = self.track.place;
        place.heading_rad = heading_of(self.state.ahead(), place.heading_rad);
        let foot = self.foot();
        (place.east_m, place.north_m) = (foot.x, foot.y);
        if let Some(spot) = self.ground.spot(place.east_m, place.north_m) {
            place.elevation_m = spot.height_m;
        }
        Motion {
            position_m: self.track.position_m,
            speed_m_s: if self.resting { 0.0 } else { self.state.speed_m_s() },
            acceleration_m_s2: self.acceleration_m_s2,
            driven_m_s: self.spin.driven_m_s(),
            place,
            resistance_n: self.wheels.iter().map(|wheel| wheel.felt.resistance_n).sum(),
            slip: self.slip(),
        }
    }

    fn axle(&self, index: usize) -> AxleMotion {
        let own = || self.wheels.iter().filter(|wheel| wheel.axle == index);
        let sum = |of: &dyn Fn(&Wheel) -> f64| own().map(of).sum::<f64>();
        let wheels = own().count() as f64;
        AxleMotion {
            load_n: sum(&|wheel| wheel.touch.load_n),
            slip: sum(&|wheel| wheel.slip) / wheels,
            traction_n: sum(&|wheel| wheel.felt.gross_n),
            resistance_n: sum(&|wheel| wheel.felt.resistance_n),
            sinkage_m: sum(&|wheel| wheel.felt.rut_m) / wheels,
        }
    }

    fn advance(&mut self, push: &Push, step_s: f64) -> Option<Stepped> {
        let mass_j = self.load(push);
        let before = self.state;
        let speed_m_s = before.speed_m_s();
        self.aim(step_s);
        self.touch();
        self.feel(step_s);
        self.way = (self.way + step_s * speed_m_s / RESTING_M) / (1.0 + step_s * speed_m_s.abs() / RESTING_M);
        let rolled: Vec<f64> = self.spin.wheels_m_s.clone();
        let mut turned = self.spin.advance(
            (push.drive_n, push.way),
            push.brake_n,
            |wheel| self.wheels[wheel].felt.gross_n + self.wheels[wheel].tilting_n,
            step_s,
        );
        let (ahead, hitch) = (before.ahead(), self.hitch());
        // What resists wheels of its own acts there.
        let drawbar_n = if self.towed.is_some() { push.drawbar_n - push.towed_n } else { push.drawbar_n };
        let pulled = ahead * (push.hitch_n - self.way * drawbar_n);
        let (mut force, mut moment) = forces(&self.wheels, &self.spin, &before, self.way);
        force += ahead * (push.free_n - self.way * push.resistance_n) + pulled;
        moment += (hitch - before.centre).cross(pulled);
        let mut towed_push = (Vector::ZERO, Vector::ZERO);
        let mut towed_turned = (Vec::new(), Turned::default());
        if let Some(towed) = &mut self.towed {
            let told = towed.feel(&self.ground, self.track.place, self.track.position_m, step_s);
            self.trouble = self.trouble.take().or(told);
            let rolled_m_s = towed.spin.wheels_m_s.clone();
            let (force, moment, turned) = towed.push(self.way, self.model.gravity_m_s2, step_s);
            towed_push = (force, moment);
            towed_turned = (rolled_m_s, turned);
        }
        if self.hops {
            let (more, turn) = self.taken_back(hitch, (force, moment), step_s);
            force += more;
            moment += turn;
        }
        self.world.step((force, moment), towed_push, step_s);
        if let Some(told) = self.impossible(force.abs().max_element(), step_s) {
            self.trouble.get_or_insert(told);
            self.spin.put_back(rolled);
            if let Some(towed) = &mut self.towed {
                towed.spin.put_back(towed_turned.0);
            }
            self.world.put_back(&before, self.towed.as_ref().map(|towed| &towed.state));
            return None;
        }
        self.state = self.world.state();
        if self.hops {
            hop::follow(&mut self.wheels, (&before, &self.state), step_s);
        }
        turned.brakes_j -= tilt(&mut self.wheels, &self.spin, (&before, &self.state), step_s);
        let step = Step {
            before: &before,
            after: &self.state,
            lasts_s: step_s,
            way: self.way,
            weight_n: self.mass_kg * self.model.gravity_m_s2,
            hitch,
            turned,
        };
        let rolling = |wheel: usize| 0.5 * (rolled[wheel] + self.spin.wheels_m_s[wheel]);
        let mut stepped = step.work(&self.wheels, rolling, &mut self.own);
        stepped.mass_j = -mass_j;
        if let Some(towed) = &mut self.towed {
            let (rolled_m_s, turned) = &towed_turned;
            let scale = (self.way, step_s, self.model.gravity_m_s2);
            let pushed = (towed_push.0, *turned);
            towed.book(&self.world, rolled_m_s, pushed, scale, &before, &mut self.own, &mut stepped);
        }
        for wheel in &mut self.wheels {
            wheel.settle(step_s);
        }
        self.track.follow(self.foot());
        let after_m_s = self.state.speed_m_s();
        self.acceleration_m_s2 = Some((after_m_s - speed_m_s) / step_s);
        self.rising_m_s2 = (self.state.velocity.z - before.velocity.z) / step_s;
        self.resting = if self.resting {
            let held = self.spin.wheels_m_s.iter().all(|speed| *speed == 0.0);
            after_m_s.abs() <= if held { SLIDES_M_S } else { SETS_OFF_M_S }
        } else {
            after_m_s * speed_m_s <= 0.0
        };
        self.look(step_s);
        Some(stepped)
    }

    fn trouble(&self) -> Option<String> {
        self.trouble.clone()
    }

    fn kinetic_j(&self) -> f64 {
        let turning_j = |wheels: &[Wheel], spin: &Spin, state: &State| {
            spin.kinetic_j() + tilted_j(wheels, spin, state) + hop::kinetic_j(wheels)
        };
        let towed = self.towed.as_ref();
        let towed_j = towed.map_or(0.0, |towed| turning_j(&towed.wheels, &towed.spin, &towed.state));
        self.world.kinetic_j() + turning_j(&self.wheels, &self.spin, &self.state) + towed_j
    }

    fn accounts(&self) -> Vec<(&'static str, f64)> {
        vec![
            ("side slip", self.own.side_j),
            ("tyre damping", self.own.damping_j),
            ("tyre springs", self.spring_j() - self.first_spring_j),
            ("suspension damping", self.own.suspension_j),
            ("suspension springs", self.strut_j() - self.first_strut_j),
        ]
    }

    fn channels(&self) -> Vec<String> {
        let whole = [
            "roll_rad",
            "pitch_rad",
            "yaw_rate_rad_s",
            "side_speed_m_s",
            "path_offset_m",
            "height_m",
            RISING,
        ];
        let mut names: Vec<String> = whole.map(str::to_owned).into();
        if self.towed.is_some() {
            names.extend(TOWED_CHANNELS.map(str::to_owned));
        }
        for wheel in self.wheels.iter().chain(self.towed.iter().flat_map(|towed| &towed.wheels)) {
            names.extend(WHEEL_CHANNELS.map(|what| format!("{}_{what}", wheel.name)));
            names.extend(wheel.strut.map(|_| format!("{}_suspension_m", wheel.name)));
        }
        names
    }

    fn write(&self, row: &mut Vec<f64>) {
        let State { turning, velocity, pose, .. } = self.state;
        let (ahead, left, up) = (self.state.ahead(), self.state.left(), self.state.up());
        row.extend([
            // The right side down, and the nose up, count positive.
            left.z.atan2(up.z),
            ahead.z.asin(),
            // As headings, clockwise.
            -turning.z,
            velocity.dot(left),
            self.track.left_m,
            // As east and north, of the vehicle's own: what is loaded moves neither.
            pose.translation.z,
            self.rising_m_s2,
        ]);
        if let Some(towed) = &self.towed {
            let (ahead, left, up) = (towed.state.ahead(), towed.state.left(), towed.state.up());
            let centre = towed.state.centre;
            row.extend([
                towed.angle_rad(&self.state),
                left.z.atan2(up.z),
                ahead.z.asin(),
                heading_of(ahead, heading_of(self.state.ahead(), self.track.place.heading_rad)),
                centre.x,
                centre.y,
                centre.z,
                towed.pull_n,
                towed.load_n,
            ]);
        }
        for wheel in self.wheels.iter().chain(self.towed.iter().flat_map(|towed| &towed.wheels)) {
            let Touch { load_n, deflection_m, steer_rad, .. } = wheel.touch;
            let Felt { gross_n, side_n, resistance_n, rut_m, .. } = wheel.felt;
            row.extend([
                load_n,
                wheel.slip,
                (-wheel.side).clamp(-1.0, 1.0).asin(),
                gross_n,
                side_n,
                resistance_n,
                rut_m,
                deflection_m,
                steer_rad,
            ]);
            row.extend(wheel.strut.map(|strut| strut.squeezed_m));
        }
    }
}

impl Rig<'_> {
    /// What is taken back of the inertia of the wheels' own masses under a force in the centre of gravity and a moment about it.
    fn taken_back(&self, hitch: Vector, (force, moment): (Vector, Vector), step_s: f64) -> (Vector, Vector) {
        let bearer = Bearer { mass_kg: self.mass_kg, inverse: &self.inverse, state: &self.state };
        let pressed = self.towed.as_ref().map_or(Vector::ZERO, Towed::pressing);
        let free = force + pressed - Vector::Z * (self.mass_kg * self.model.gravity_m_s2);
        let turning = moment + (hitch - self.state.centre).cross(pressed);
        hop::taken_back(&self.wheels, bearer, (free, turning), step_s)
    }
}

/// How the centre of gravity is accelerated upward.
const RISING: &str = "vertical_acceleration_m_s2";

/// What is written of a trailer.
const TOWED_CHANNELS: [&str; 9] = [
    "trailer_angle_rad",
    "trailer_roll_rad",
    "trailer_pitch_rad",
    "trailer_heading_rad",
    "trailer_east_m",
    "trailer_north_m",
    "trailer_height_m",
    "coupling_pull_n",
    "coupling_load_n",
];

/// What is written of a wheel.
const WHEEL_CHANNELS: [&str; 9] = [
    "load_n",
    "slip",
    "slip_angle_rad",
    "traction_n",
    "side_force_n",
    "resistance_n",
    "sinkage_m",
    "deflection_m",
    "steer_rad",
];
