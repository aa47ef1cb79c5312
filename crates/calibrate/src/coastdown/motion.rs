//! Speed of a vehicle that rolls out, and how it reacts to each parameter.
//!
//! m_eff dv/dt = −Σ p_k φ_k(v) − K(v, t)                    force balance; K is what is known
//! ds_k/dt = −(φ_k + (Σ p_j φ_j′ + K′) s_k) / m_eff          s_k = ∂v/∂p_k, s_k(0) = 0
//! ds_0/dt = −(Σ p_j φ_j′ + K′) s_0 / m_eff                  s_0 = ∂v/∂v(0), s_0(0) = 1
//!
//! Speed and sensitivities are integrated together by the classical Runge–Kutta method of fourth order. Nothing is
//! differentiated numerically, neither the recording nor the model.
//! Source of the sensitivity equations: Hairer, Nørsett & Wanner, *Solving Ordinary Differential Equations I*, I.14.

use super::segment::{Ambient, Coast};
use nalgebra::{DMatrix, DVector};

/// Longest step of integration [s].
const STEP_S: f64 = 0.1;

/// One parameter and the force that it scales.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// f0 [N].
    Constant,
    /// f1 [N s/m].
    Linear,
    /// f2 [N s²/m²].
    Quadratic,
    /// c_w of c_w (1 + v/scale) times the normal force; dimensionless.
    Rolling {
        /// Speed at which the coefficient has doubled [m/s].
        scale_m_s: f64,
    },
    /// Constant grade of a path, rise over run in its forward direction.
    Grade {
        /// Which path.
        path: usize,
    },
    /// Mean wind against the forward direction of a path [m/s], to first order in the wind: 2 · ½ρCdA v w.
    Headwind {
        /// Which path.
        path: usize,
    },
    /// Error of the rotating mass [kg]: scales every force alike.
    RotatingMass,
    /// Scale error of the speed sensor; no force, the reading itself.
    SpeedScale,
    /// Resistance of each run beyond what is common to all, over its weight: what varies from run to run.
    Offset,
}

/// Which air drag is counted as known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Air {
    /// All of it: the terms hold rolling resistance alone.
    Known,
    /// Only what wind adds: the terms hold air drag in calm air too, as road loads do.
    WindOnly,
}

/// Parameters, what they scale, and what is known.
#[derive(Clone, Debug)]
pub struct Motion<'a> {
    /// The terms.
    pub terms: &'a [Term],
    /// One parameter a term.
    pub parameters: &'a [f64],
    /// What is known of air drag.
    pub air: Air,
}

/// Forces of all terms at one speed, and the total.
struct Forces {
    /// φ_k.
    each: Vec<f64>,
    /// Σ p φ + K [N].
    total: f64,
    /// Its derivative to speed [N s/m].
    slope: f64,
}

impl Motion<'_> {
    /// Speed at each sample, and a Jacobian with one column a term and the initial speed last.
    pub fn roll_out(&self, coast: &Coast, initial_m_s: f64) -> (DVector<f64>, DMatrix<f64>) {
        let columns = self.terms.len() + 1;
        let samples = coast.time_s.len();
        let mut speeds = DVector::zeros(samples);
        let mut jacobian = DMatrix::zeros(samples, columns);
        let mut state = vec![0.0; columns + 1];
        state[0] = initial_m_s;
        state[columns] = 1.0;
        for sample in 0..samples {
            if sample > 0 {
                self.advance(coast, sample, &mut state);
            }
            speeds[sample] = state[0];
            for column in 0..columns {
                jacobian[(sample, column)] = if self.terms.get(column) == Some(&Term::SpeedScale) {
                    state[0]
                } else {
                    state[column + 1]
                };
            }
        }
        (speeds, jacobian)
    }

    /// Resistance against the motion at one speed [N].
    pub fn resistance_n(&self, coast: &Coast, ambient: Ambient, speed_m_s: f64) -> f64 {
        self.forces(coast, ambient, speed_m_s).total
    }

    fn advance(&self, coast: &Coast, sample: usize, state: &mut [f64]) {
        let span = coast.time_s[sample] - coast.time_s[sample - 1];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive count")]
        let steps = (span / STEP_S - 1e-9).ceil().max(1.0) as usize;
        let (before, after) = (coast.ambient[sample - 1], coast.ambient[sample]);
        let step = span / steps as f64;
        for index in 0..steps {
            let at = |part: f64| before.between(after, (index as f64 + part) / steps as f64);
            let k1 = self.rates(coast, at(0.0), state);
            let k2 = self.rates(coast, at(0.5), &moved(state, &k1, 0.5 * step));
            let k3 = self.rates(coast, at(0.5), &moved(state, &k2, 0.5 * step));
            let k4 = self.rates(coast, at(1.0), &moved(state, &k3, step));
            for (index, value) in state.iter_mut().enumerate() {
                *value += step / 6.0 * (k1[index] + 2.0 * (k2[index] + k3[index]) + k4[index]);
            }
        }
    }

    fn rates(&self, coast: &Coast, ambient: Ambient, state: &[f64]) -> Vec<f64> {
        let forces = self.forces(coast, ambient, state[0]);
        let mut rates = Vec::with_capacity(state.len());
        rates.push(-forces.total / coast.effective_mass_kg);
        for (own, sensitivity) in forces.each.iter().chain(&[0.0]).zip(&state[1..]) {
            rates.push(-(own + forces.slope * sensitivity) / coast.effective_mass_kg);
        }
        rates
    }

    fn forces(&self, coast: &Coast, ambient: Ambient, v: f64) -> Forces {
        let slope_angle = ambient.grade.atan();
        let normal = coast.weight_n() * slope_angle.cos();
        let (mut total, mut slope) = (coast.weight_n() * slope_angle.sin(), 0.0);
        if let Some(k) = coast.half_density_drag_area_kg_m {
            let along = v - ambient.tailwind_m_s;
            let relative = along.hypot(ambient.crosswind_m_s);
            total += k * relative * along;
            if relative > 0.0 {
                slope += k * (along * along / relative + relative);
            }
            if self.air == Air::WindOnly {
                total -= k * v * v.abs();
                slope -= 2.0 * k * v.abs();
            }
        }
        let mut each = Vec::with_capacity(self.terms.len());
        for (term, parameter) in self.terms.iter().zip(self.parameters) {
            let (force, derivative) = effect(*term, coast, normal, v);
            total += parameter * force;
            slope += parameter * derivative;
            each.push(force);
        }
        for (own, term) in each.iter_mut().zip(self.terms) {
            if *term == Term::RotatingMass {
                *own = -total / coast.effective_mass_kg;
            }
        }
        Forces { each, total, slope }
    }
}

fn moved(state: &[f64], rates: &[f64], step: f64) -> Vec<f64> {
    state.iter().zip(rates).map(|(value, rate)| value + step * rate).collect()
}

/// φ and dφ/dv of a term. Errors of mass and sensor are no forces; their columns are made from the others.
fn effect(term: Term, coast: &Coast, normal_n: f64, v: f64) -> (f64, f64) {
    match term {
        Term::Constant => (1.0, 0.0),
        Term::Linear => (v, 1.0),
        Term::Quadratic => (v * v.abs(), 2.0 * v.abs()),
        Term::Rolling { scale_m_s } => (normal_n * (1.0 + v / scale_m_s), normal_n / scale_m_s),
        Term::Offset => (coast.weight_n(), 0.0),
        Term::Grade { path } if path == coast.path => (coast.sign * coast.weight_n(), 0.0),
        Term::Headwind { path } if path == coast.path => {
            let k = 2.0 * coast.half_density_drag_area_kg_m.unwrap_or(0.0) * coast.sign;
            (k * v, k)
        }
        Term::Grade { .. } | Term::Headwind { .. } | Term::RotatingMass | Term::SpeedScale => (0.0, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1000 kg, ten samples a second for 5 s.
    fn coast() -> Coast {
        Coast {
            id: String::new(),
            run: 0,
            path: 0,
            sign: 1.0,
            mass_kg: 950.0,
            effective_mass_kg: 1000.0,
            half_density_drag_area_kg_m: None,
            time_s: (0..=50).map(|at| f64::from(at) * 0.1).collect(),
            speed_m_s: vec![0.0; 51],
            ambient: vec![Ambient::default(); 51],
            from_s: 0.0,
        }
    }

    fn last(terms: &[Term], parameters: &[f64], initial_m_s: f64) -> f64 {
        let motion = Motion { terms, parameters, air: Air::Known };
        motion.roll_out(&coast(), initial_m_s).0[50]
    }

    /// 700 N on 1000 kg for 5 s: 8 − 3.5 m/s.
    #[test]
    fn constant_resistance_slows_evenly() {
        assert!((last(&[Term::Constant], &[700.0], 8.0) - 4.5).abs() < 1e-12);
    }

    /// f0 + f2 v²: v(t) = √(f0/f2) tan(atan(v0 √(f2/f0)) − t √(f0 f2)/m).
    #[test]
    fn constant_and_quadratic_resistance_follow_the_tangent() {
        let (f0, f2, v0, m, t) = (400.0_f64, 6.0_f64, 12.0, 1000.0, 5.0);
        let exact = (f0 / f2).sqrt() * ((v0 * (f2 / f0).sqrt()).atan() - t * (f0 * f2).sqrt() / m).tan();
        let found = last(&[Term::Constant, Term::Quadratic], &[f0, f2], v0);
        assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
    }

    /// f0 + f1 v: v(t) = (v0 + f0/f1) exp(−f1 t/m) − f0/f1.
    #[test]
    fn constant_and_viscous_resistance_follow_the_exponential() {
        let (f0, f1, v0) = (300.0, 80.0, 9.0);
        let exact = (v0 + f0 / f1) * (-f1 * 5.0 / 1000.0_f64).exp() - f0 / f1;
        let found = last(&[Term::Constant, Term::Linear], &[f0, f1], v0);
        assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
    }

    /// Coast-downs of the reference vehicle to standstill for each unit of v in c_w (1 + v/100), c_w 0.069, ρ 1.235,
    /// CdA 6, g 9.81, without rotating parts: time and distance of an independent integration in steps of 1 ms.
    #[test]
    fn the_reference_vehicle_stops_where_it_should() {
        let table = [
            (30.0, 100.0 / 3.6, 10.69, 42.42),
            (15.0, 100.0 / 3.6, 5.72, 11.63),
            (30.0, 44.704, 11.20, 45.13),
            (30.0, 100.0, 11.72, 47.96),
            (30.0, 1e12, 12.19, 50.56),
        ];
        for (initial_km_h, scale_m_s, until_s, distance_m) in table {
            let mut coast = coast();
            (coast.mass_kg, coast.effective_mass_kg) = (13_019.3, 13_019.3);
            coast.half_density_drag_area_kg_m = Some(0.5 * 1.235 * 6.0);
            coast.time_s = (0..=2000).map(|at| until_s * f64::from(at) / 2000.0).collect();
            coast.ambient = vec![Ambient::default(); 2001];
            let parameters = [0.069 * 9.81 / 9.806_65];
            let terms = [Term::Rolling { scale_m_s }];
            let motion = Motion { terms: &terms, parameters: &parameters, air: Air::Known };
            let (speeds, _) = motion.roll_out(&coast, initial_km_h / 3.6);
            // The table is rounded to 5 ms and 5 mm; at 0.68 m/s² 0.1 % of the time is 8 mm/s.
            assert!(speeds[2000].abs() < 0.001 * until_s * 0.68, "{} m/s after {until_s} s", speeds[2000]);
            let pairs = speeds.as_slice().windows(2);
            let distance: f64 = pairs.map(|pair| 0.5 * (pair[0] + pair[1]) * until_s / 2000.0).sum();
            assert!((distance / distance_m - 1.0).abs() < 1e-3, "{distance} m, expected {distance_m}");
        }
    }

    /// A known side wind w adds to the drag: ½ρCdA √(v² + w²) v; head wind of the same strength (v + w)².
    #[test]
    fn wind_is_a_vector() {
        let mut coast = coast();
        coast.half_density_drag_area_kg_m = Some(2.0);
        let motion = Motion { terms: &[], parameters: &[], air: Air::Known };
        let side = Ambient { crosswind_m_s: 4.0, ..Ambient::default() };
        let head = Ambient { tailwind_m_s: -4.0, ..Ambient::default() };
        assert!((motion.resistance_n(&coast, side, 3.0) - 30.0).abs() < 1e-12);
        assert!((motion.resistance_n(&coast, head, 3.0) - 98.0).abs() < 1e-12);
        let road = Motion { air: Air::WindOnly, ..motion };
        assert!((road.resistance_n(&coast, side, 3.0) - 12.0).abs() < 1e-12);
    }

    #[test]
    fn sensitivities_are_the_differences_that_they_stand_for() {
        let mut coast = coast();
        coast.half_density_drag_area_kg_m = Some(1.5);
        coast.sign = -1.0;
        let side = Ambient { crosswind_m_s: 3.0, tailwind_m_s: 1.0, grade: 0.004 };
        coast.ambient = vec![side; 51];
        let terms = [
            Term::Constant,
            Term::Linear,
            Term::Quadratic,
            Term::Rolling { scale_m_s: 30.0 },
            Term::Grade { path: 0 },
            Term::Headwind { path: 0 },
        ];
        let at = [150.0, 12.0, 1.5, 0.02, 0.003, 1.0];
        let of = |parameters: &[f64], initial| {
            Motion { terms: &terms, parameters, air: Air::Known }.roll_out(&coast, initial)
        };
        let (_, jacobian) = of(&at, 9.0);
        for column in 0..=terms.len() {
            let step = if column < terms.len() { 1e-4 * at[column] } else { 1e-4 };
            let shifted = |sign: f64| {
                let mut parameters = at;
                if column < terms.len() {
                    parameters[column] += sign * step;
                }
                of(&parameters, if column == terms.len() { 9.0 + sign * step } else { 9.0 }).0[50]
            };
            let difference = (shifted(1.0) - shifted(-1.0)) / (2.0 * step);
            assert!((jacobian[(50, column)] / difference - 1.0).abs() < 1e-6, "column {column}");
        }
    }

    /// More mass at the same force is the same force divided by more: Δm acts as −F Δm/m.
    #[test]
    fn rotating_mass_reacts_as_a_difference_of_mass() {
        let terms = [Term::Constant, Term::Quadratic, Term::RotatingMass];
        let motion = Motion { terms: &terms, parameters: &[400.0, 3.0, 0.0], air: Air::Known };
        let slope = motion.roll_out(&coast(), 9.0).1[(50, 2)];
        let with = |extra: f64| {
            let mut coast = coast();
            coast.effective_mass_kg += extra;
            motion.roll_out(&coast, 9.0).0[50]
        };
        let difference = (with(0.1) - with(-0.1)) / 0.2;
        assert!((slope / difference - 1.0).abs() < 1e-6);
    }
}
