//! An electric car on the road: motor torque and speed, battery voltage and current, 170 s each.

use super::{Design, Logger, Needs, anemometer, channel, flag, prior, ramps, rounded};
use crate::course::Course;
use crate::dice::Dice;
use crate::plan::{Channel, Nominal, Plan, RunPlan};
use crate::plant::{Electric, Goal, Ground, Stop, Vehicle};
use crate::sensor::Sensor;
use std::f64::consts::TAU;

/// End of the road [m].
const ROAD_M: f64 = 2600.0;
/// Length of a run [s].
const RUN_S: f64 = 170.0;

#[allow(clippy::too_many_lines, reason = "one table of constants")]
pub(super) fn plan(needs: &Needs, dice: &mut Dice) -> Plan {
    let (mass, turning) = (rounded(dice.within(1150.0, 1700.0)), rounded(dice.within(45.0, 85.0)));
    let (area, coefficient, density) = (
        rounded(dice.within(0.55, 0.8)),
        rounded(dice.within(0.008, 0.013)),
        rounded(dice.within(1.15, 1.28)),
    );
    let design = Design::new(&[5.0, 10.0, 20.0], needs, dice);
    let drive = Electric {
        voltage_v: dice.within(330.0, 390.0).round(),
        rise_v: dice.within(30.0, 60.0).round(),
        resistance_ohm: rounded(dice.within(0.07, 0.14)),
        capacity_a_h: dice.within(55.0, 110.0).round(),
        charge: rounded(dice.within(0.6, 0.85)),
        gear_ratio: rounded(dice.within(8.0, 11.0)),
        gear_efficiency: 0.97,
        radius_m: rounded(dice.within(0.31, 0.36)),
        efficiency: rounded(dice.within(0.87, 0.93)),
        standby_w: rounded(dice.within(200.0, 450.0)),
        most_torque_n_m: 250.0,
        most_power_w: 120_000.0,
    };
    let nominal = Nominal {
        priors: vec![
            prior("vehicle.mass_kg", mass, 0.012 * mass, (900.0, 2400.0), 0.7, needs, dice),
            prior("vehicle.drag_area_m2", area, 0.08 * area, (0.3, 1.5), 0.7, needs, dice),
            prior(
                "ground.soil.coefficient",
                coefficient,
                0.08 * coefficient,
                (0.004, 0.03),
                0.85,
                needs,
                dice,
            ),
            prior(
                "vehicle.driveline.drive_efficiency",
                drive.efficiency,
                0.012,
                (0.6, 1.0),
                0.8,
                needs,
                dice,
            ),
            prior(
                "vehicle.driveline.standby_power_w",
                drive.standby_w,
                60.0,
                (0.0, 3000.0),
                0.7,
                needs,
                dice,
            ),
        ],
        vehicle: format!(
            "(name: \"electric car\", mass_kg: {{vehicle.mass_kg}}, rotating_mass_kg: 0.0, drag_area_m2: \
             {{vehicle.drag_area_m2}}, driveline: ElectricSingleSpeed(open_circuit_voltage_v: {:?}, \
             open_circuit_rise_v: {:?}, resistance_ohm: {:?}, capacity_a_h: {:?}, initial_state_of_charge: {:?}, \
             max_torque_n_m: 250.0, max_regeneration_torque_n_m: 250.0, max_power_w: 120000.0, gear_ratio: {:?}, \
             gear_efficiency: 0.97, wheel_radius_m: {:?}, drive_efficiency: {{vehicle.driveline.drive_efficiency}}, \
             standby_power_w: {{vehicle.driveline.standby_power_w}}, rotating_mass_kg: {turning:?}))",
            drive.voltage_v,
            drive.rise_v,
            drive.resistance_ohm,
            drive.capacity_a_h,
            drive.charge,
            drive.gear_ratio,
            drive.radius_m,
        ),
        soil: "QuadraticSpeedLaw(coefficient: {ground.soil.coefficient}, speed_scale_m_s: \"160 km/h\")"
            .to_owned(),
        smoothing_s: 0.5,
    };
    Plan {
        family: "electric",
        about: "electric car on a road, motor and battery logged".to_owned(),
        vehicle: Vehicle {
            mass_kg: mass,
            turning_kg: turning,
            drag_area_m2: area,
            ground: Ground::Quadratic { coefficient, scale_m_s: 160.0 / 3.6 },
            air_density_kg_m3: density,
            gravity_m_s2: 9.81,
            creep: 5e-4,
            pitch_gain_rad_s2_m: dice.within(0.002, 0.005),
            pitch_hz: dice.within(1.2, 1.8),
            pitch_damping: dice.within(0.2, 0.4),
            antenna_m: dice.within(0.3, 1.0),
            electric: Some(drive),
            engine: None,
        },
        course: Course { heading_rad: dice.within(0.0, TAU), bends: Vec::new() },
        channels: channels(needs, &design, dice),
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

fn channels(needs: &Needs, design: &Design, dice: &mut Dice) -> Vec<Channel> {
    let logger = Logger { lag_s: dice.within(0.02, 0.04), hold_s: 0.0 };
    let speed_noise = dice.within(0.012, 0.03);
    let exact = |step: f64| Sensor { step, ..Sensor::default() };
    let mut channels = vec![
        channel(
            "speed_m_s",
            |sample| sample.speed_m_s,
            logger.sensor(speed_noise, 0.1 * speed_noise, 0.001),
            4,
        ),
        channel(
            "motor_torque_n_m",
            |sample| sample.motor_torque_n_m,
            logger.sensor(dice.within(0.2, 0.6), 0.02, 0.1),
            2,
        ),
        channel("motor_speed_rad_s", |sample| sample.motor_speed_rad_s, logger.sensor(0.5, 0.05, 0.05), 2),
        channel("battery_voltage_v", |sample| sample.battery_voltage_v, logger.sensor(0.15, 0.02, 0.05), 2),
        channel(
            "battery_current_a",
            |sample| sample.battery_current_a,
            logger.sensor(dice.within(0.1, 0.4), 0.03, 0.05),
            2,
        ),
        channel("state_of_charge", |sample| sample.charge, exact(0.001), 3),
    ];
    if dice.chance(0.7) || needs.position {
        let gnss = Sensor { white: 0.3, drift: 0.8, drift_s: 20.0, step: 0.01, ..Sensor::default() };
        channels.push(channel("position_m", |sample| sample.position_m, gnss, 2));
    }
    if dice.chance(0.7) || needs.heading {
        let compass = Sensor { white: 0.01, step: 0.001, ..Sensor::default() };
        channels.push(channel("heading_rad", |sample| sample.heading_rad, compass, 4));
    }
    if dice.chance(0.3) || needs.accelerometer {
        let sensor = logger.sensor(dice.within(0.05, 0.15), 0.003, 0.005);
        channels.push(channel("specific_force_m_s2", |sample| sample.specific_force_m_s2, sensor, 4));
    }
    if dice.chance(0.6) || needs.temperatures {
        let sensor = Sensor { step: 0.5, ..Sensor::default() };
        channels.push(channel("air_temperature_c", |sample| sample.air_c, sensor, 1));
    }
    if design.anemometer() {
        anemometer(&mut channels);
    }
    if needs.brake {
        channels.push(flag("brake", |sample| sample.brake));
    }
    channels
}

fn runs(needs: &Needs, design: &Design, dice: &mut Dice) -> Vec<RunPlan> {
    let varied = dice.chance(0.3) || needs.temperatures;
    let usual_c = dice.within(8.0, 24.0);
    let mut runs = Vec::new();
    for index in 0..design.runs() {
        let first = dice.within(5.0, 12.0);
        let reversed = design.reversed[index];
        let from_end = dice.within(5.0, 60.0);
        let plan = ramps(dice, first, (4.0, 24.0), (0.4, 1.6), (6.0, 18.0), RUN_S);
        runs.push(RunPlan {
            id: format!("trip_{:02}", index + 1),
            reversed,
            lane: design.lanes[index],
            lane_m: design.lane_m(index),
            held_out: design.held_out[index],
            position_m: if reversed { ROAD_M - from_end } else { from_end },
            speed_m_s: first,
            ballast_kg: 0.0,
            air_c: if varied { dice.within(-10.0, 26.0) } else { usual_c },
            goal: Goal::Follow(plan),
            stop: Stop { after_s: RUN_S, below_m_s: 0.6 },
        });
    }
    runs
}
