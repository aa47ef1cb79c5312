//! A heavy tractor on soft ground: coast-downs from about 30 and 15 km/h, and driven runs.

use super::{Design, Logger, Needs, anemometer, channel, flag, prior, ramps, rounded};
use crate::course::Course;
use crate::dice::Dice;
use crate::plan::{Nominal, Plan, RunPlan};
use crate::plant::{Goal, Ground, Stop, Vehicle};
use crate::sensor::Sensor;
use std::f64::consts::TAU;

/// End of the lane [m].
const LANE_M: f64 = 250.0;
/// Length of a driven run [s].
const DRIVEN_S: f64 = 40.0;
/// Speed below which nobody logs a coast-down [m/s].
const SLOWEST_M_S: f64 = 0.8;

pub(super) fn plan(needs: &Needs, dice: &mut Dice) -> Plan {
    let (mass, turning) = (rounded(dice.within(11_500.0, 14_500.0)), rounded(dice.within(450.0, 1100.0)));
    let (area, coefficient, density) = (
        rounded(dice.within(5.0, 7.5)),
        rounded(dice.within(0.045, 0.085)),
        rounded(dice.within(1.17, 1.27)),
    );
    let design = Design::new(&[10.0, 20.0, 25.0, 50.0, 100.0], needs, dice);
    let scale = 100.0 / 3.6;
    let heading = dice.within(0.0, TAU);
    let accelerometer = dice.chance(0.4) || needs.accelerometer;
    let position = dice.chance(0.75) || needs.position;
    let logger = Logger { lag_s: dice.within(0.02, 0.05), hold_s: if dice.chance(0.4) { 0.1 } else { 0.0 } };
    let speed_noise = dice.within(0.015, 0.035);
    let mut channels = vec![
        channel(
            "speed_m_s",
            |sample| sample.speed_m_s,
            logger.sensor(speed_noise, 0.1 * speed_noise, 0.001),
            4,
        ),
        flag("coasting", |sample| sample.coasting),
        channel(
            "tractive_force_n",
            |sample| sample.drive_n,
            logger.sensor(dice.within(80.0, 250.0), 6.0, 5.0),
            1,
        ),
    ];
    if position {
        let gnss = Sensor { white: 0.04, drift: 0.1, drift_s: 20.0, step: 0.01, ..Sensor::default() };
        channels.push(channel("position_m", |sample| sample.position_m, gnss, 3));
    }
    if dice.chance(0.8) || needs.heading {
        let compass = Sensor { white: 0.01, step: 0.001, ..Sensor::default() };
        channels.push(channel("heading_rad", |sample| sample.heading_rad, compass, 4));
    }
    if accelerometer {
        let sensor = logger.sensor(dice.within(0.04, 0.12), 0.003, 0.002);
        channels.push(channel("specific_force_m_s2", |sample| sample.specific_force_m_s2, sensor, 4));
    }
    if design.anemometer() {
        anemometer(&mut channels);
    }
    let nominal = Nominal {
        priors: vec![
            prior("vehicle.mass_kg", mass, 0.006 * mass, (8000.0, 18_000.0), 0.7, needs, dice),
            prior("vehicle.rotating_mass_kg", turning, 0.0, (0.0, 4000.0), 0.0, needs, dice),
            prior("vehicle.drag_area_m2", area, 0.1 * area, (2.0, 14.0), 0.5, needs, dice),
            prior("ground.soil.coefficient", coefficient, 0.06 * coefficient, (0.01, 0.2), 0.85, needs, dice),
        ],
        vehicle: "(name: \"heavy tractor\", mass_kg: {vehicle.mass_kg}, rotating_mass_kg: \
                  {vehicle.rotating_mass_kg}, drag_area_m2: {vehicle.drag_area_m2}, driveline: Neutral())"
            .to_owned(),
        soil: "LinearSpeedLaw(coefficient: {ground.soil.coefficient}, speed_scale_m_s: \"100 km/h\")"
            .to_owned(),
        smoothing_s: 0.5,
    };
    Plan {
        family: "coast",
        about: "coast-downs and driven runs on soft ground".to_owned(),
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
        course: Course { heading_rad: heading, bends: Vec::new() },
        runs: runs(&design, dice),
        channels,
        rate_hz: design.rate_hz,
        uneven: design.uneven,
        wind_m_s: design.wind_m_s,
        paths_told: design.paths_told,
        held_out_told: design.held_out_told,
        before_s: 1.0,
        nominal,
    }
}

/// Coast-downs from about 30 and 15 km/h, and a driven run among every four or so.
fn runs(design: &Design, dice: &mut Dice) -> Vec<RunPlan> {
    let air_c = dice.within(8.0, 22.0);
    let mut runs = Vec::new();
    // Kinds shift by one every four runs, so that each is driven both ways.
    for index in 0..design.runs() {
        let kind = (index + index / 4) % 4;
        let reversed = design.reversed[index];
        let top = if kind == 1 { dice.within(4.0, 5.2) } else { dice.within(8.0, 9.4) };
        let (speed, goal, after_s) = if kind == 2 {
            let first = dice.within(2.0, 4.0);
            let plan = ramps(dice, first, (2.0, 8.5), (0.25, 0.8), (3.0, 8.0), DRIVEN_S);
            (first, Goal::Follow(plan), DRIVEN_S)
        } else {
            (top, Goal::Coast, 60.0)
        };
        let from_end = if kind == 2 { dice.within(0.0, 15.0) } else { dice.within(60.0, 170.0) };
        runs.push(RunPlan {
            id: format!("run_{:02}", index + 1),
            reversed,
            lane: design.lanes[index],
            lane_m: design.lane_m(index),
            held_out: design.held_out[index],
            position_m: if reversed { LANE_M - from_end } else { from_end },
            speed_m_s: speed,
            ballast_kg: 0.0,
            air_c,
            goal,
            stop: Stop { after_s, below_m_s: SLOWEST_M_S },
        });
    }
    runs
}
