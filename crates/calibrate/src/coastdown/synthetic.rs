//! Coast-downs with a known truth, disturbed as real ones are: to test methods on.
//!
//! The vehicle is that of the reference study. Its motion is integrated here on its own, in steps of 10 ms, so that
//! no code is shared with the fit that is tested on it.

use super::input::{CoastRun, Constant, SpeedUnit};
use crate::statistics::Draws;
use headland_trace::{Origin, Trace, TraceError};
use headland_units::constants::STANDARD_GRAVITY_M_S2;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// Steps of the integration [s].
const STEP_S: f64 = 0.01;
/// Steps between two samples.
const STEPS_A_SAMPLE: usize = 10;

/// The truth, and how it is disturbed. Every `_sd` is one standard deviation; all at zero give a noise-free set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// True c_w, the mean over all runs that could have been driven.
    pub c_w: f64,
    /// Unit of v in c_w (1 + v/100).
    pub unit: SpeedUnit,
    /// Mass [kg].
    pub mass_kg: f64,
    /// Rotating mass [kg]; the truth of a set is drawn with its standard deviation.
    pub rotating_mass_kg: Constant,
    /// Drag area [m²]; the truth of a set is drawn with its standard deviation.
    pub drag_area_m2: Constant,
    /// Density of the air [kg/m³].
    pub air_density_kg_m3: f64,
    /// Initial speed of each run [m/s]; directions alternate.
    pub initial_m_s: Vec<f64>,
    /// Grade of the lane, drawn once a set.
    pub grade_sd: f64,
    /// Grade along the track of each run beyond that of the lane.
    pub run_grade_sd: f64,
    /// Relative difference of c_w from run to run.
    pub run_c_w_sd: f64,
    /// Mean wind across the lane [m/s].
    pub wind_m_s: f64,
    /// Angle by which the wind misses the perpendicular, drawn once a set [rad].
    pub wind_angle_sd_rad: f64,
    /// Wind of each run beyond the mean, along and across [m/s].
    pub run_wind_sd_m_s: f64,
    /// Gusts along and across [m/s], lasting `gust_time_s`.
    pub gust_sd_m_s: f64,
    /// How long a gust lasts [s].
    pub gust_time_s: f64,
    /// Independent noise of a speed sample [m/s].
    pub speed_sd_m_s: f64,
    /// Noise of speed that lasts `drift_time_s` [m/s].
    pub drift_sd_m_s: f64,
    /// How long it lasts [s].
    pub drift_time_s: f64,
    /// Bias of speed, drawn once a run [m/s].
    pub bias_sd_m_s: f64,
    /// Resolution of the log [m/s]; 0 for none.
    pub resolution_m_s: f64,
}

impl Field {
    /// Five coast-downs from 30 km/h and five from 15 km/h with everything known exactly and nothing disturbed.
    pub fn noise_free() -> Self {
        let initial = |index: u8| if index < 5 { 30.0 / 3.6 } else { 15.0 / 3.6 };
        Self {
            c_w: 0.069,
            unit: SpeedUnit::KilometresPerHour,
            mass_kg: 13_019.3,
            rotating_mass_kg: Constant::exact(950.0),
            drag_area_m2: Constant::exact(6.0),
            air_density_kg_m3: 1.238,
            initial_m_s: (0..10).map(initial).collect(),
            grade_sd: 0.0,
            run_grade_sd: 0.0,
            run_c_w_sd: 0.0,
            wind_m_s: 0.0,
            wind_angle_sd_rad: 0.0,
            run_wind_sd_m_s: 0.0,
            gust_sd_m_s: 0.0,
            gust_time_s: 5.0,
            speed_sd_m_s: 0.0,
            drift_sd_m_s: 0.0,
            drift_time_s: 1.0,
            bias_sd_m_s: 0.0,
            resolution_m_s: 0.0,
        }
    }

    /// The same as it is in the field. GPS speed of 0.1 km/h (1 σ 0.03 m/s), a part of it correlated and a part
    /// constant over a run, logged to 0.01 km/h; a lane of some tenths of a per cent, driven not quite on one track;
    /// 5.6 m/s across, missed by some ten degrees; soil that varies by 1 % from run to run; a drag area and wheels
    /// that are not known exactly.
    pub fn disturbed() -> Self {
        Self {
            rotating_mass_kg: Constant::new(950.0, 20.0),
            drag_area_m2: Constant::new(6.0, 0.5),
            grade_sd: 0.003,
            run_grade_sd: 0.000_5,
            run_c_w_sd: 0.01,
            wind_m_s: 5.6,
            wind_angle_sd_rad: 10.0_f64.to_radians(),
            run_wind_sd_m_s: 0.5,
            gust_sd_m_s: 1.0,
            speed_sd_m_s: 0.03,
            drift_sd_m_s: 0.02,
            bias_sd_m_s: 0.03,
            resolution_m_s: 0.01 / 3.6,
            ..Self::noise_free()
        }
    }

    /// A set of runs. The recorded wind is the mean of the station; the runs do not know the gusts.
    ///
    /// # Errors
    /// [`TraceError`] where the constants make no motion.
    pub fn runs(&self, seed: u64) -> Result<Vec<CoastRun>, TraceError> {
        let mut draws = Draws::new(seed, 0);
        let rotating = self.rotating_mass_kg.value + self.rotating_mass_kg.sd * draws.normal();
        let drag_area = self.drag_area_m2.value + self.drag_area_m2.sd * draws.normal();
        let grade = self.grade_sd * draws.normal();
        let angle = self.wind_angle_sd_rad * draws.normal();
        self.initial_m_s
            .iter()
            .enumerate()
            .map(|(index, initial_m_s)| {
                let mut draws = Draws::new(seed, 1 + index as u64);
                let reversed = index % 2 == 1;
                let sign = if reversed { -1.0 } else { 1.0 };
                let truth = Truth {
                    c_w: self.c_w * (1.0 + self.run_c_w_sd * draws.normal()),
                    effective_mass_kg: self.mass_kg + rotating,
                    half_density_drag_area: 0.5 * self.air_density_kg_m3 * drag_area,
                    grade: sign * grade + self.run_grade_sd * draws.normal(),
                    tailwind_m_s: sign * self.wind_m_s * angle.sin() + self.run_wind_sd_m_s * draws.normal(),
                    crosswind_m_s: self.wind_m_s * angle.cos() + self.run_wind_sd_m_s * draws.normal(),
                };
                let speeds = self.sensed(self.roll(&truth, *initial_m_s, &mut draws), &mut draws);
                let samples = speeds.len();
                let mut trace = Trace::new((0..samples).map(|at| at as f64 * 0.1).collect())?;
                trace.push("speed_m_s", speeds, Origin::Measured)?;
                if self.wind_m_s > 0.0 {
                    trace.push("wind_speed_m_s", vec![self.wind_m_s; samples], Origin::Measured)?;
                    trace.push("wind_direction_rad", vec![FRAC_PI_2; samples], Origin::Measured)?;
                }
                Ok(CoastRun {
                    id: format!("r{}", index + 1),
                    trace,
                    path: Some("lane".to_owned()),
                    reversed,
                    mass_kg: Constant::exact(self.mass_kg),
                    rotating_mass_kg: self.rotating_mass_kg,
                    drag_area_m2: Some(self.drag_area_m2),
                    air_density_kg_m3: Some(Constant::exact(self.air_density_kg_m3)),
                    heading_rad: Some(if reversed { std::f64::consts::PI } else { 0.0 }),
                })
            })
            .collect()
    }

    /// True speed at each sample, until the vehicle stands.
    fn roll(&self, truth: &Truth, initial_m_s: f64, draws: &mut Draws) -> Vec<f64> {
        let mut speed = initial_m_s;
        let mut speeds = vec![speed];
        let (mut along, mut across) = (Gust::default(), Gust::default());
        while speed > 0.2 && speeds.len() < 10_000 {
            for _ in 0..STEPS_A_SAMPLE {
                let tail =
                    truth.tailwind_m_s + along.next(self.gust_sd_m_s, STEP_S / self.gust_time_s, draws);
                let cross =
                    truth.crosswind_m_s + across.next(self.gust_sd_m_s, STEP_S / self.gust_time_s, draws);
                // Heun's method: second order, 1e-7 relative at this step.
                let first = self.acceleration(truth, speed, tail, cross);
                let second = self.acceleration(truth, speed + STEP_S * first, tail, cross);
                speed += 0.5 * STEP_S * (first + second);
            }
            speeds.push(speed);
        }
        speeds
    }

    fn acceleration(&self, truth: &Truth, v: f64, tail: f64, cross: f64) -> f64 {
        let weight = self.mass_kg * STANDARD_GRAVITY_M_S2;
        let rolling = truth.c_w * (1.0 + v / self.unit.hundred_m_s()) * weight;
        let air = truth.half_density_drag_area * (v - tail).hypot(cross) * (v - tail);
        -(rolling + air + weight * truth.grade) / truth.effective_mass_kg
    }

    fn sensed(&self, mut speeds: Vec<f64>, draws: &mut Draws) -> Vec<f64> {
        let bias = self.bias_sd_m_s * draws.normal();
        let mut drift = Gust::default();
        for speed in &mut speeds {
            *speed += bias + drift.next(self.drift_sd_m_s, 0.1 / self.drift_time_s, draws);
            *speed += self.speed_sd_m_s * draws.normal();
            if self.resolution_m_s > 0.0 {
                *speed = (*speed / self.resolution_m_s).round() * self.resolution_m_s;
            }
        }
        speeds
    }
}

/// What is true in one run.
struct Truth {
    c_w: f64,
    effective_mass_kg: f64,
    half_density_drag_area: f64,
    grade: f64,
    tailwind_m_s: f64,
    crosswind_m_s: f64,
}

/// A process with exponential correlation, started from its stationary distribution.
#[derive(Default)]
struct Gust(Option<f64>);

impl Gust {
    fn next(&mut self, sd: f64, step_over_time: f64, draws: &mut Draws) -> f64 {
        if sd == 0.0 {
            return 0.0;
        }
        let memory = (-step_over_time).exp();
        let fresh = draws.normal();
        let value = self.0.map_or(fresh, |last| memory * last + (1.0 - memory * memory).sqrt() * fresh);
        self.0 = Some(value);
        sd * value
    }
}
