//! A tractor on the road: accelerations and holds, with the tractive force measured, 60 s each.

use super::{Design, Logger, Needs, anemometer, channel, flag, prior, ramps, rounded};
use crate::course::{Bend, Course};
use crate::dice::Dice;
use crate::plan::{Channel, Nominal, Plan, RunPlan};
use crate::plant::{Goal, Ground, Stop, Vehicle};
use crate::sensor::Sensor;
use std::f64::consts::TAU;

/// End of the lane [m].
const LANE_M: f64 = 640.0;
/// Length of a run [s].
const RUN_S: f64 = 60.0;

pub(super) fn plan(needs: &Needs, dice: &mut Dice) -> Plan {
    let (mass, turning) = (rounded(dice.within(7000.0, 13_000.0)), rounded(dice.within(300.0, 800.0)));
    let (area, coefficient, density) =
        (rounded(dice.within(4.5, 7.5)), rounded(dice.within(0.014, 0.03)), rounded(dice.within(1.17, 1.27)));
    let design = Design::new(&[10.0, 20.0, 25.0, 50.0, 100.0], needs, dice);
    let scale = rounded(dice.within(40.0, 60.0));
    let ballast = dice.chance(0.15) || needs.ballast;
    let course = Course { heading_rad: dice.within(0.0, TAU), bends: bends(needs, dice) };
    let nominal = Nominal {
        priors: vec![
            prior(
                "vehicle.mass_kg",
                mass,
                0.006 * mass,
                (4000.0, 18_000.0),
                if ballast { 0.0 } else { 0.7 },
                needs,
                dice,
            ),
            prior("vehicle.rotating_mass_kg", turning, 0.0, (0.0, 4000.0), 0.0, needs, dice),
            prior("vehicle.drag_area_m2", area, 0.1 * area, (2.0, 14.0), 0.6, needs, dice),
            prior(
                "ground.soil.coefficient",
                coefficient,
                0.06 * coefficient,
                (0.005, 0.1),
                0.85,
                needs,
                dice,
            ),
        ],
        vehicle:
            "(name: \"tractor\", mass_kg: {vehicle.mass_kg}, rotating_mass_kg: {vehicle.rotating_mass_kg}, \
                  drag_area_m2: {vehicle.drag_area_m2}, driveline: Neutral())"
                .to_owned(),
        soil: format!("LinearSpeedLaw(coefficient: {{ground.soil.coefficient}}, speed_scale_m_s: {scale:?})"),
        smoothing_s: 0.2,
    };
    Plan {
        family: "transport",
        about: "tractor on the road, tractive force measured".to_owned(),
        vehicle: Vehicle {
            mass_kg: mass,
            turning_kg: turning,
            drag_area_m2: area,
            ground: Ground::Linear { coefficient, scale_m_s: scale },
            air_density_kg_m3: density,
            gravity_m_s2: 9.81,
            creep: 5e-4,
            pitch_gain_rad_s2_m: dice.within(0.001, 0.002),
            pitch_hz: dice.within(1.3, 2.0),
            pitch_damping: dice.within(0.15, 0.4),
            antenna_m: dice.within(0.5, 1.5),
            electric: None,
            engine: None,
        },
        channels: channels(needs, &design, !course.bends.is_empty(), dice),
        course,
        runs: runs(ballast, needs.temperatures, &design, dice),
        rate_hz: design.rate_hz,
        uneven: design.uneven,
        wind_m_s: design.wind_m_s,
        paths_told: design.paths_told,
        held_out_told: design.held_out_told,
        before_s: 3.0,
        nominal,
    }
}

fn channels(needs: &Needs, design: &Design, bends: bool, dice: &mut Dice) -> Vec<Channel> {
    let logger = Logger { lag_s: dice.within(0.02, 0.05), hold_s: if dice.chance(0.3) { 0.1 } else { 0.0 } };
    let speed_noise = dice.within(0.012, 0.035);
    let force_noise = dice.within(60.0, 250.0);
    let mut channels = vec![
        channel(
            "speed_m_s",
            |sample| sample.speed_m_s,
            logger.sensor(speed_noise, 0.1 * speed_noise, 0.001),
            4,
        ),
        channel("tractive_force_n", |sample| sample.drive_n, logger.sensor(force_noise, 6.0, 5.0), 1),
    ];
    if dice.chance(0.75) || needs.position {
        let gnss = Sensor { white: 0.04, drift: 0.1, drift_s: 20.0, step: 0.01, ..Sensor::default() };
        channels.push(channel("position_m", |sample| sample.position_m, gnss, 3));
    }
    if dice.chance(0.8) || needs.heading || design.anemometer() && bends {
        let compass = Sensor { white: 0.01, step: 0.001, ..Sensor::default() };
        channels.push(channel("heading_rad", |sample| sample.heading_rad, compass, 4));
    }
    if dice.chance(0.35) || needs.accelerometer {
        let sensor = logger.sensor(dice.within(0.04, 0.12), 0.003, 0.002);
        channels.push(channel("specific_force_m_s2", |sample| sample.specific_force_m_s2, sensor, 4));
    }
    if dice.chance(0.3) || needs.wheel_speed {
        let sensor = logger.sensor(dice.within(0.01, 0.03), 0.003, 0.002);
        channels.push(channel("wheel_speed_m_s", |sample| sample.wheel_speed_m_s, sensor, 4));
    }
    if bends {
        let gyro = Sensor { white: 2e-4, step: 1e-5, ..Sensor::default() };
        channels.push(channel("curvature_per_m", |sample| sample.curvature_per_m, gyro, 6));
    }
    if design.anemometer() {
        anemometer(&mut channels);
    }
    if needs.temperatures {
        let sensor = Sensor { step: 0.5, ..Sensor::default() };
        channels.push(channel("air_temperature_c", |sample| sample.air_c, sensor, 1));
    }
    if needs.brake {
        channels.push(flag("brake", |sample| sample.brake));
    }
    channels
}

fn bends(needs: &Needs, dice: &mut Dice) -> Vec<Bend> {
    if !(dice.chance(0.2) || needs.bends) {
        return Vec::new();
    }
    let middles = [dice.within(90.0, 140.0), dice.within(270.0, 330.0), dice.within(450.0, 520.0)];
    let bend = |middle_m: f64| Bend {
        middle_m,
        half_length_m: dice.within(30.0, 60.0),
        curvature_per_m: dice.sign() * dice.within(0.012, 0.03),
    };
    middles.map(bend).to_vec()
}

fn runs(ballast: bool, varied: bool, design: &Design, dice: &mut Dice) -> Vec<RunPlan> {
    let extra_kg = dice.within(2000.0, 4000.0).round();
    let usual_c = dice.within(5.0, 25.0);
    let mut runs = Vec::new();
    for index in 0..design.runs() {
        let first = dice.within(3.0, 7.0);
        let reversed = design.reversed[index];
        let from_end = dice.within(5.0, 30.0);
        let plan = ramps(dice, first, (2.5, 13.0), (0.2, 0.9), (3.0, 9.0), RUN_S);
        runs.push(RunPlan {
            id: format!("run_{:02}", index + 1),
            reversed,
            lane: design.lanes[index],
            lane_m: design.lane_m(index),
            held_out: design.held_out[index],
            position_m: if reversed { LANE_M - from_end } else { from_end },
            speed_m_s: first,
            ballast_kg: if ballast && index % 4 >= 2 { extra_kg } else { 0.0 },
            air_c: if varied { dice.within(-10.0, 26.0) } else { usual_c },
            goal: Goal::Follow(plan),
            stop: Stop { after_s: RUN_S, below_m_s: 0.6 },
        });
    }
    runs
}
