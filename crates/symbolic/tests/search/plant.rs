//! Runs that never were: a vehicle that speeds up and coasts down, and rows in weak form of a force that it feels.
//!
//! Laws are closures over the samples; nothing here knows the terms that a search is made of.
#![allow(dead_code, reason = "each test and the example use a part")]

use headland_symbolic::{Enters, Nuisance, Problem, Rows, Target, Variable};
use std::f64::consts::{PI, TAU};

/// Numbers that repeat: the generator SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
pub struct Dice(u64);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x51AB)
    }

    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        low + (high - low) * (z >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform(1e-12, 1.0).ln()).sqrt() * (TAU * self.uniform(0.0, 1.0)).cos()
    }
}

/// One sample of what may stand in a law.
#[derive(Clone, Copy)]
pub struct At {
    pub v: f64,
    pub x: f64,
    pub t: f64,
    pub heading: f64,
    pub kappa: f64,
    pub temperature: f64,
    pub coasting: f64,
}

/// Samples between two rows, and in one.
const BLOCK: usize = 10;
const DT_S: f64 = 0.02;

/// The runs.
pub struct Plant {
    pub runs: Vec<Vec<At>>,
    pub sd_n: f64,
    /// Correlation of the noise of neighbouring rows; the whitening takes it for [`PERSISTENCE`].
    pub persistence: f64,
}

/// Hat-weighted means over two blocks, and a correlation between neighbours that is taken out.
#[derive(Clone)]
pub struct Weak {
    sd_n: f64,
}

/// Correlation between neighbouring rows.
const PERSISTENCE: f64 = 0.3;

impl Weak {
    fn means(samples: &[f64]) -> Vec<f64> {
        let hat = |index: usize| 1.0 - (index as f64 + 0.5 - BLOCK as f64).abs() / BLOCK as f64;
        let sum: f64 = (0..2 * BLOCK).map(hat).sum();
        (0..(samples.len() / BLOCK).saturating_sub(1))
            .map(|row| {
                (0..2 * BLOCK).map(|index| hat(index) * samples[row * BLOCK + index]).sum::<f64>() / sum
            })
            .collect()
    }

    fn whiten(&self, rows: &[f64]) -> Vec<f64> {
        let fresh = self.sd_n * (1.0 - PERSISTENCE * PERSISTENCE).sqrt();
        (0..rows.len())
            .map(|row| {
                if row == 0 { rows[0] / self.sd_n } else { (rows[row] - PERSISTENCE * rows[row - 1]) / fresh }
            })
            .collect()
    }
}

impl Rows for Weak {
    fn rows(&self, _: usize, samples: &[f64]) -> Vec<f64> {
        self.whiten(&Self::means(samples))
    }
}

/// The same rows of every second sample, each standing for two.
pub struct Sparse(pub Weak);

impl Rows for Sparse {
    fn rows(&self, run: usize, samples: &[f64]) -> Vec<f64> {
        let twice: Vec<f64> = samples.iter().flat_map(|value| [*value; 2]).collect();
        self.0.rows(run, &twice)
    }

    fn every(&self, _: usize) -> usize {
        2
    }
}

/// A problem that owns what it is made of.
pub struct Made {
    pub variables: Vec<Variable>,
    pub times_s: Vec<Vec<f64>>,
    pub residual: Vec<Vec<f64>>,
    pub nuisances: Vec<Nuisance>,
    pub fit: Vec<bool>,
    pub weak: Weak,
}

impl Made {
    pub fn problem(&self) -> Problem<'_> {
        Problem {
            variables: &self.variables,
            times_s: &self.times_s,
            target: Target::Force,
            rows: &self.weak,
            residual: &self.residual,
            nuisances: &self.nuisances,
            fit: &self.fit,
        }
    }
}

impl Plant {
    /// Ten runs of a minute at 50 Hz: speeds, directions, bends and weather of their own; rows of 0.2 s with noise `sd_n`.
    pub fn new(seed: u64, count: usize, sd_n: f64) -> Self {
        let runs = (0..count)
            .map(|run| {
                let mut dice = Dice::new(seed * 1000 + run as u64);
                let top = dice.uniform(5.0, 13.0);
                let (rise, coast) = (dice.uniform(8.0, 20.0), dice.uniform(25.0, 45.0));
                let fall = dice.uniform(8.0, 25.0);
                let wobble = (dice.uniform(0.3, 1.2), dice.uniform(6.0, 15.0), dice.uniform(0.0, TAU));
                let temperature = dice.uniform(-5.0, 25.0);
                let heading = if run % 2 == 0 { 0.6 } else { 0.6 + PI };
                let (bend, at) = (dice.uniform(-0.03, 0.03), dice.uniform(40.0, 250.0));
                let mut x = 0.0;
                (0..3000)
                    .map(|sample| {
                        let t = DT_S * f64::from(sample);
                        let up = top * (1.0 - (-t / rise).exp());
                        let down = if t > coast { (-(t - coast) / fall).exp() } else { 1.0 };
                        let v = (0.6 + up * down + wobble.0 * (TAU * t / wobble.1 + wobble.2).sin()).max(0.3);
                        x += v * DT_S;
                        let kappa = bend * (-((x - at) / 30.0_f64).powi(2)).exp();
                        let coasting = f64::from(u8::from(t > coast));
                        At { v, x, t, heading: heading + 20.0 * kappa, kappa, temperature, coasting }
                    })
                    .collect()
            })
            .collect();
        Self { runs, sd_n, persistence: PERSISTENCE }
    }

    /// The problem of a law [N]: noise, a residual that nuisances have a part in, three runs of ten held out.
    pub fn problem(&self, seed: u64, law: impl Fn(&At) -> f64) -> Made {
        let mut dice = Dice::new(seed ^ 0xA5A5);
        let weak = Weak { sd_n: self.sd_n };
        // Free parameters: rolling, drag, a wrong mass as a pull along speed's slope.
        let pulls: [fn(&[At], usize) -> f64; 3] = [
            |_, _| 1000.0,
            |run, at| run[at].v.powi(2),
            |run, at| {
                3000.0 * (run[(at + 1).min(run.len() - 1)].v - run[at.saturating_sub(1)].v) / (2.0 * DT_S)
            },
        ];
        let sds = [0.5, 4.0, 0.03];
        let offs: Vec<f64> = sds.iter().map(|sd| sd * dice.normal()).collect();
        let of = |run: &[At], pull: fn(&[At], usize) -> f64| -> Vec<f64> {
            (0..run.len()).map(|at| pull(run, at)).collect()
        };
        let nuisances: Vec<Nuisance> = pulls
            .iter()
            .zip(sds)
            .map(|(pull, sd)| Nuisance {
                sd,
                runs: self.runs.iter().map(|run| weak.whiten(&Weak::means(&of(run, *pull)))).collect(),
            })
            .collect();
        let residual = self
            .runs
            .iter()
            .map(|run| {
                let mut samples: Vec<f64> = run.iter().map(&law).collect();
                for (pull, off) in pulls.iter().zip(&offs) {
                    samples.iter_mut().zip(of(run, *pull)).for_each(|(sample, pull)| *sample += off * pull);
                }
                let mut rows = Weak::means(&samples);
                let mut noise = self.sd_n * dice.normal();
                for row in &mut rows {
                    *row += noise;
                    let fresh = self.sd_n * (1.0 - self.persistence.powi(2)).sqrt();
                    noise = self.persistence * noise + fresh * dice.normal();
                }
                weak.whiten(&rows)
            })
            .collect();
        let fit = (0..self.runs.len()).map(|run| run % 10 != 2 && run % 10 != 6 && run % 10 != 9).collect();
        let times_s = self.runs.iter().map(|run| run.iter().map(|at| at.t).collect()).collect();
        Made { variables: self.variables(), times_s, residual, nuisances, fit, weak }
    }

    fn variables(&self) -> Vec<Variable> {
        let one = |name: &str, unit: &str, of: fn(&At) -> f64| Variable {
            name: name.to_owned(),
            unit: unit.to_owned(),
            runs: self.runs.iter().map(|run| run.iter().map(of).collect()).collect(),
            twin: None,
            finest: 0.0,
            enters: Enters::Freely,
        };
        vec![
            one("v", "m/s", |at| at.v),
            one("x", "m", |at| at.x),
            one("t", "s", |at| at.t),
            one("heading", "rad", |at| at.heading),
            one("kappa", "1/m", |at| at.kappa),
            one("temperature", "°C", |at| at.temperature),
            one("coasting", "1", |at| at.coasting),
        ]
    }

    /// Share of the variance of a law on the runs that were held out that a prediction has, once what the free parameters
    /// can imitate is taken out of both.
    pub fn held_out_r2(&self, made: &Made, law: impl Fn(&At) -> f64, prediction: &[Vec<f64>]) -> f64 {
        let (mut wrong, mut whole) = (0.0, 0.0);
        let held = (0..self.runs.len()).filter(|run| !made.fit[*run]);
        let (mut truth, mut said, mut columns) =
            (Vec::new(), Vec::new(), vec![Vec::new(); made.nuisances.len()]);
        for run in held {
            let samples: Vec<f64> = self.runs[run].iter().map(&law).collect();
            truth.extend(Weak::means(&samples));
            said.extend(Weak::means(&prediction[run]));
            let ones = vec![1.0; samples.len()];
            let squares: Vec<f64> = self.runs[run].iter().map(|at| at.v.powi(2)).collect();
            columns[0].extend(Weak::means(&ones));
            columns[1].extend(Weak::means(&squares));
            columns[2].extend(Weak::means(&self.runs[run].iter().map(|_| 0.0).collect::<Vec<_>>()));
        }
        let clear = |values: &[f64]| {
            let mut values = values.to_vec();
            let mut basis: Vec<Vec<f64>> = Vec::new();
            for column in &columns {
                let mut column = column.clone();
                for q in &basis {
                    let share: f64 = q.iter().zip(&column).map(|(a, b)| a * b).sum();
                    column.iter_mut().zip(q).for_each(|(value, q)| *value -= share * q);
                }
                let size = column.iter().map(|value| value * value).sum::<f64>().sqrt();
                if size > 1e-9 {
                    basis.push(column.iter().map(|value| value / size).collect());
                }
            }
            for q in &basis {
                let share: f64 = q.iter().zip(&values).map(|(a, b)| a * b).sum();
                values.iter_mut().zip(q).for_each(|(value, q)| *value -= share * q);
            }
            values
        };
        for (truth, said) in clear(&truth).iter().zip(clear(&said)) {
            wrong += (truth - said).powi(2);
            whole += truth * truth;
        }
        1.0 - wrong / whole
    }
}
