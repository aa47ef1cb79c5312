//! A vehicle that holds its speed on a battery: position, speed, charge and thirteen energy accounts.

use crate::{End, Forces, HEADING_RAD, MASS_KG, START_M_S, forces, step};
use std::hint::black_box;

pub const PARAMETERS: &str = "(open_circuit_voltage_v: 360.0, open_circuit_rise_v: 50.0, resistance_ohm: 0.1, \
     capacity_a_h: 60.0, initial_state_of_charge: 0.8, max_torque_n_m: 250.0, max_regeneration_torque_n_m: 150.0, \
     max_power_w: 125000.0, gear_ratio: 9.665, gear_efficiency: 0.97, wheel_radius_m: 0.35, drive_efficiency: 0.9, \
     standby_power_w: 300.0, rotating_mass_kg: 60.0)";

const VOLTAGE_V: f64 = 360.0;
const RISE_V: f64 = 50.0;
const RESISTANCE_OHM: f64 = 0.1;
const CAPACITY_A_H: f64 = 60.0;
const CHARGE: f64 = 0.8;
const MOST_N_M: f64 = 250.0;
const MOST_BACK_N_M: f64 = 150.0;
const MOST_W: f64 = 125_000.0;
const LEVERAGE_PER_M: f64 = 9.665 / 0.35;
const GEAR: f64 = 0.97;
const DRIVE: f64 = 0.9;
const STANDBY_W: f64 = 300.0;
const ROTATING_KG: f64 = 60.0;
const TARGET_M_S: f64 = START_M_S;

/// Channels of the trace that the simulation keeps.
const CHANNELS: usize = 20;

struct Now {
    forces: Forces,
    force_n: f64,
    omega: f64,
    torque_n_m: f64,
    voltage_v: f64,
    current_a: f64,
}

pub fn run<const RECORD: bool>(steps: usize, step_s: f64) -> End {
    let mut columns: [Vec<f64>; CHANNELS] = std::array::from_fn(|_| Vec::new());
    let mut y = [0.0; 16];
    (y[1], y[2]) = (START_M_S, CHARGE);
    for index in 0..=steps {
        let (k1, now) = slope(&y);
        if RECORD {
            let Forces { east_m, north_m, soil_n, air_n } = now.forces;
            let row = [
                index as f64 * step_s,
                y[0],
                y[1],
                y[1],
                k1[1],
                MASS_KG + ROTATING_KG,
                0.0,
                0.0,
                HEADING_RAD,
                east_m,
                north_m,
                now.force_n,
                soil_n,
                -air_n,
                0.0,
                now.omega,
                now.torque_n_m,
                now.voltage_v,
                now.current_a,
                y[2],
            ];
            for (column, value) in columns.iter_mut().zip(row) {
                column.push(value);
            }
        }
        if index < steps {
            step(&mut y, &k1, step_s, |y| slope(y).0);
        }
    }
    black_box((&columns, &y));
    [y[0], y[1]]
}

fn slope(y: &[f64; 16]) -> ([f64; 16], Now) {
    let [position_m, speed_m_s, charge, ..] = *y;
    let forces = forces(position_m, speed_m_s);
    let mass_kg = MASS_KG + ROTATING_KG;
    let wanted_n = mass_kg * (TARGET_M_S - speed_m_s) + forces.soil_n - forces.air_n;

    let u = VOLTAGE_V + RISE_V * (charge.clamp(0.0, 1.0) - 0.5);
    let most_battery_w = u * u / (4.0 * RESISTANCE_OHM);
    let omega = LEVERAGE_PER_M * speed_m_s;
    let drives = wanted_n * omega >= 0.0;
    let gear = if drives { GEAR } else { 1.0 / GEAR };
    let wanted_n_m = wanted_n / (LEVERAGE_PER_M * gear);
    let (most_n_m, most_w) = if drives {
        let spare_w = if charge > 0.0 { DRIVE * (most_battery_w - STANDBY_W).max(0.0) } else { 0.0 };
        (MOST_N_M, MOST_W.min(spare_w))
    } else if charge < 1.0 {
        (MOST_BACK_N_M, MOST_W)
    } else {
        (0.0, 0.0)
    };
    let clamped = wanted_n_m.clamp(-most_n_m, most_n_m);
    let torque_n_m =
        if (clamped * omega).abs() > most_w { (most_w / omega).abs().copysign(clamped) } else { clamped };
    let mechanical_w = torque_n_m * omega;
    let electric_w = if mechanical_w >= 0.0 { mechanical_w / DRIVE } else { mechanical_w * DRIVE };
    let gear = if torque_n_m * speed_m_s >= 0.0 { GEAR } else { 1.0 / GEAR };
    let force_n = torque_n_m * LEVERAGE_PER_M * gear;
    let battery_w = electric_w + STANDBY_W;
    let given_w = battery_w.min(most_battery_w);
    let amperes = 2.0 * given_w / (u + (u * u - 4.0 * RESISTANCE_OHM * given_w).max(0.0).sqrt());
    let source_w = u * amperes + (battery_w - given_w);
    let brake_n = (force_n - wanted_n).max(0.0);

    let mut k = [0.0; 16];
    k[0] = speed_m_s;
    k[1] = (force_n + forces.air_n - forces.soil_n - brake_n) / mass_kg;
    k[2] = -source_w / (u * 3600.0 * CAPACITY_A_H);
    k[3] = source_w;
    k[4] = forces.soil_n * speed_m_s;
    k[5] = -forces.air_n * speed_m_s;
    k[7] = brake_n * speed_m_s;
    k[13] = RESISTANCE_OHM * amperes * amperes;
    k[14] = electric_w - force_n * speed_m_s;
    k[15] = STANDBY_W;
    let voltage_v = u - RESISTANCE_OHM * amperes;
    (k, Now { forces, force_n, omega, torque_n_m, voltage_v, current_a: source_w / u })
}
