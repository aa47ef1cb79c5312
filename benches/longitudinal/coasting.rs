//! A vehicle that coasts: position, speed and ten energy accounts.

use crate::{End, Forces, HEADING_RAD, MASS_KG, START_M_S, forces, step};
use std::hint::black_box;

/// Channels of the trace that the simulation keeps.
const CHANNELS: usize = 15;

pub fn run<const RECORD: bool>(steps: usize, step_s: f64) -> End {
    let mut columns: [Vec<f64>; CHANNELS] = std::array::from_fn(|_| Vec::new());
    let mut y = [0.0; 12];
    y[1] = START_M_S;
    for index in 0..=steps {
        let (k1, now) = slope(&y);
        if RECORD {
            let time_s = index as f64 * step_s;
            let row = [
                time_s,
                y[0],
                y[1],
                y[1],
                k1[1],
                MASS_KG,
                0.0,
                0.0,
                HEADING_RAD,
                now.east_m,
                now.north_m,
                0.0,
                now.soil_n,
                -now.air_n,
                1.0,
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

fn slope(y: &[f64; 12]) -> ([f64; 12], Forces) {
    let [position_m, speed_m_s, ..] = *y;
    let now = forces(position_m, speed_m_s);
    let mut k = [0.0; 12];
    k[0] = speed_m_s;
    k[1] = (now.air_n - now.soil_n) / MASS_KG;
    // Source, soil, air, and accounts that nothing is booked to.
    k[3] = now.soil_n * speed_m_s;
    k[4] = -now.air_n * speed_m_s;
    (k, now)
}
