//! A tractor on the road with its engine logged: speed, torque and fuel of the engine, with or without the force at the
//! wheels, 90 s each.

use super::{Design, Logger, Needs, anemometer, channel, prior, ramps, rounded};
use crate::course::Course;
use crate::dice::Dice;
use crate::plan::{Channel, Nominal, Plan, RunPlan};
use crate::plant::{Engine, Goal, Ground, Stop, Vehicle};
use crate::sensor::Sensor;
use std::f64::consts::{PI, TAU};

/// End of the lane [m].
const LANE_M: f64 = 1100.0;
/// Length of a run [s].
const RUN_S: f64 = 90.0;
/// Rolling radius; the ratio is not logged, so that it only shows [m].
const RADIUS_M: f64 = 0.9;

#[allow(clippy::too_many_lines, reason = "one table of constants")]
pub(super) fn plan(needs: &Needs, dice: &mut Dice) -> Plan {
    let (mass, turning) = (rounded(dice.within(7000.0, 12_000.0)), rounded(dice.within(300.0, 700.0)));
    let (area, coefficient, density) =
        (rounded(dice.within(4.5, 7.5)), rounded(dice.within(0.015, 0.03)), rounded(dice.within(1.17, 1.27)));
    let design = Design::new(&[5.0, 10.0, 20.0, 50.0], needs, dice);
    let displacement_m3 = rounded(dice.within(6.5e-3, 9.5e-3));
    let friction_pa = rounded(dice.within(1.3e5, 2.0e5));
    let peak_n_m = rounded(displacement_m3 * dice.within(1.35e5, 1.6e5));
    let engine = Engine {
        efficiency: rounded(dice.within(0.4, 0.46)),
        friction_n_m: friction_pa * displacement_m3 / (4.0 * PI),
        heat_j_kg: 42.8e6,
        speeds_rad_s: [85.0, 145.0, 220.0],
        torques_n_m: [rounded(0.65 * peak_n_m), peak_n_m, rounded(0.8 * peak_n_m)],
        load_share: 0.9,
        transmission: rounded(dice.within(0.8, 0.88)),
        accessory_w: rounded(dice.within(3000.0, 8000.0)),
        alternator: 0.6,
        // Fast enough that the controller's lag is lost in the noise of the fuel.
        lag_s: dice.within(0.05, 0.12),
    };
    let points: Vec<String> = engine
        .speeds_rad_s
        .iter()
        .zip(&engine.torques_n_m)
        .map(|(speed, torque)| format!("(speed_rad_s: {speed:?}, torque_n_m: {torque:?})"))
        .collect();
    let line = "vehicle.driveline.willans_efficiency";
    let accessory = "vehicle.driveline.accessory_power_w";
    let soil = "ground.soil.coefficient";
    let nominal = Nominal {
        priors: vec![
            prior("vehicle.mass_kg", mass, 0.008 * mass, (4000.0, 18_000.0), 0.7, needs, dice),
            prior("vehicle.rotating_mass_kg", turning, 0.0, (0.0, 4000.0), 0.0, needs, dice),
            prior("vehicle.drag_area_m2", area, 0.1 * area, (2.0, 14.0), 0.6, needs, dice),
            prior(soil, coefficient, 0.07 * coefficient, (0.005, 0.1), 0.85, needs, dice),
            prior(line, engine.efficiency, 0.008, (0.25, 0.55), 0.8, needs, dice),
            prior(accessory, engine.accessory_w, 700.0, (0.0, 40_000.0), 0.7, needs, dice),
        ],
        vehicle: format!(
            "(name: \"tractor\", mass_kg: {{vehicle.mass_kg}}, rotating_mass_kg: {{vehicle.rotating_mass_kg}}, \
             drag_area_m2: {{vehicle.drag_area_m2}}, driveline: EngineCvt(displacement_m3: {displacement_m3:?}, \
             willans_efficiency: {{vehicle.driveline.willans_efficiency}}, willans_friction_pa: {friction_pa:?}, \
             lower_heating_value_j_kg: {:?}, full_load: [{}], idle_speed_rad_s: {:?}, load_share: {:?}, \
             transmission_efficiency: {:?}, max_force_n: 200000.0, accessory_power_w: \
             {{vehicle.driveline.accessory_power_w}}, alternator_efficiency: {:?}, wheel_radius_m: {RADIUS_M:?}, \
             rotating_mass_kg: 0.0))",
            engine.heat_j_kg,
            points.join(", "),
            engine.speeds_rad_s[0],
            engine.load_share,
            engine.transmission,
            engine.alternator,
        ),
        soil: "LinearSpeedLaw(coefficient: {ground.soil.coefficient}, speed_scale_m_s: 50.0)".to_owned(),
        smoothing_s: 0.5,
    };
    Plan {
        family: "fuel",
        about: "tractor on the road, engine and fuel logged".to_owned(),
        vehicle: Vehicle {
            mass_kg: mass,
            turning_kg: turning,
            drag_area_m2: area,
            ground: Ground::Linear { coefficient, scale_m_s: 50.0 },
            air_density_kg_m3: density,
            gravity_m_s2: 9.81,
            creep: 5e-4,
            pitch_gain_rad_s2_m: dice.within(0.001, 0.002),
            pitch_hz: dice.within(1.3, 2.0),
            pitch_damping: dice.within(0.15, 0.4),
            antenna_m: dice.within(0.5, 1.5),
            electric: None,
            engine: Some(engine),
        },
        course: Course { heading_rad: dice.within(0.0, TAU), bends: Vec::new() },
        channels: channels(needs, &design, peak_n_m, dice),
        runs: runs(needs, &design, dice),
        rate_hz: design.rate_hz,
        uneven: design.uneven,
        wind_m_s: design.wind_m_s,
        paths_told: design.paths_told,
        held_out_told: design.held_out_told,
        before_s: 3.0,
        nominal,
    }
}

fn channels(needs: &Needs, design: &Design, peak_n_m: f64, dice: &mut Dice) -> Vec<Channel> {
    let logger = Logger { lag_s: dice.within(0.02, 0.05), hold_s: if dice.chance(0.3) { 0.1 } else { 0.0 } };
    let speed_noise = dice.within(0.012, 0.03);
    // As a vehicle's bus has them: speed 1/8 rpm, torque 1 % of the greatest, fuel 0.05 l/h.
    let fuel_kg_s = 0.05 * 0.84 / 3600.0;
    let mut channels = vec![
        channel(
            "speed_m_s",
            |sample| sample.speed_m_s,
            logger.sensor(speed_noise, 0.1 * speed_noise, 0.001),
            4,
        ),
        channel(
            "engine_speed_rad_s",
            |sample| sample.engine_speed_rad_s,
            logger.sensor(0.3, 0.05, TAU / 480.0),
            3,
        ),
        channel(
            "engine_torque_n_m",
            |sample| sample.engine_torque_n_m,
            logger.sensor(0.01 * peak_n_m, 0.002 * peak_n_m, 0.01 * rounded(peak_n_m)),
            1,
        ),
        channel(
            "fuel_rate_kg_s",
            |sample| sample.fuel_kg_s,
            logger.sensor(dice.within(4e-5, 1.2e-4), 1e-5, fuel_kg_s),
            8,
        ),
    ];
    if dice.chance(0.5) || needs.force {
        let sensor = logger.sensor(dice.within(60.0, 250.0), 6.0, 5.0);
        channels.push(channel("tractive_force_n", |sample| sample.drive_n, sensor, 1));
    }
    if dice.chance(0.7) || needs.position {
        let gnss = Sensor { white: 0.04, drift: 0.1, drift_s: 20.0, step: 0.01, ..Sensor::default() };
        channels.push(channel("position_m", |sample| sample.position_m, gnss, 3));
    }
    if dice.chance(0.7) || needs.heading {
        let compass = Sensor { white: 0.01, step: 0.001, ..Sensor::default() };
        channels.push(channel("heading_rad", |sample| sample.heading_rad, compass, 4));
    }
    if dice.chance(0.25) || needs.accelerometer {
        let sensor = logger.sensor(dice.within(0.04, 0.12), 0.003, 0.002);
        channels.push(channel("specific_force_m_s2", |sample| sample.specific_force_m_s2, sensor, 4));
    }
    if dice.chance(0.4) || needs.temperatures {
        let sensor = Sensor { step: 0.5, ..Sensor::default() };
        channels.push(channel("air_temperature_c", |sample| sample.air_c, sensor, 1));
    }
    if design.anemometer() {
        anemometer(&mut channels);
    }
    channels
}

fn runs(needs: &Needs, design: &Design, dice: &mut Dice) -> Vec<RunPlan> {
    let usual_c = dice.within(5.0, 25.0);
    let mut runs = Vec::new();
    for index in 0..design.runs() {
        let first = dice.within(3.0, 7.0);
        let reversed = design.reversed[index];
        let from_end = dice.within(5.0, 30.0);
        // Gentle, so that the engine can brake alone.
        let plan = ramps(dice, first, (2.5, 12.0), (0.15, 0.45), (3.0, 10.0), RUN_S);
        runs.push(RunPlan {
            id: format!("run_{:02}", index + 1),
            reversed,
            lane: design.lanes[index],
            lane_m: design.lane_m(index),
            held_out: design.held_out[index],
            position_m: if reversed { LANE_M - from_end } else { from_end },
            speed_m_s: first,
            ballast_kg: 0.0,
            air_c: if needs.temperatures { dice.within(-10.0, 26.0) } else { usual_c },
            goal: Goal::Follow(plan),
            stop: Stop { after_s: RUN_S, below_m_s: 0.6 },
        });
    }
    runs
}
