//! Wheels that turn: shafts, differentials, brakes.
//!
//! Σ λ² m_w dw/dt = F − Σ λ G − B          a shaft, and the wheels that are locked to it
//! (m_l + m_r) dd/dt = G_l − G_r          the difference of two wheels on an open differential
//!
//! w is the speed at which a wheel rolls, m_w = J / r² what it adds to inertia, λ its lead. Speeds and masses in place of
//! angles and moments: no radius is needed. Source: Mitschke and Wallentowitz, *Dynamik der Kraftfahrzeuge* (2014), chapter A.
//! Brakes hold by dry friction: they take the speed of a step to zero and no further. They sit on the shafts of driven
//! wheels, and on the wheels that are not driven.

use crate::chassis::{Chassis, Differential};
use headland_sim::Axles;

/// One degree of freedom of turning, and the wheels that go with it.
#[derive(Clone, Debug)]
struct Shaft {
    /// Index, lead.
    wheels: Vec<(usize, f64)>,
    /// Part of the driveline's force; 0 where it is not driven.
    share: f64,
    /// Part of the brakes' force.
    braked: f64,
    mass_kg: f64,
    speed_m_s: f64,
}

/// Two wheels on an open differential: half the difference of their speeds, left less right.
#[derive(Clone, Debug)]
struct Difference {
    left: usize,
    right: usize,
    mass_kg: f64,
    speed_m_s: f64,
}

/// All that turns.
#[derive(Clone, Debug)]
pub(crate) struct Spin {
    shafts: Vec<Shaft>,
    differences: Vec<Difference>,
    /// What driveline and effects add to the driven shafts [kg].
    turning_kg: f64,
    /// Speed at which each wheel rolls [m/s].
    pub wheels_m_s: Vec<f64>,
    /// How fast that changed over the last step [m/s²].
    pub changes_m_s2: Vec<f64>,
    /// What each wheel adds to inertia [kg].
    pub masses_kg: Vec<f64>,
    /// Way of each wheel in a last step in which brakes brought it to a stand; 0 in others [m].
    pub stopped_m: Vec<f64>,
}

/// What a step took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Turned {
    pub driven_m: f64,
    pub brakes_j: f64,
}

impl Spin {
    /// Wheels in the order of the axles, left before right, of which `tyres` says how many tyres each is.
    pub fn new(
        axles: &Axles,
        chassis: &Chassis,
        tyres: &[(usize, f64)],
        rotating_kg: f64,
        speed_m_s: f64,
    ) -> Self {
        let all: f64 = tyres.iter().map(|(_, tyres)| tyres).sum();
        let masses_kg: Vec<f64> = tyres.iter().map(|(_, own)| rotating_kg * own / all).collect();
        let of_axle = |axle: usize| (0..tyres.len()).filter(move |wheel| tyres[*wheel].0 == axle);
        let shaft = |wheels: Vec<(usize, f64)>, share: f64| Shaft {
            mass_kg: wheels.iter().map(|(wheel, lead)| lead * lead * masses_kg[*wheel]).sum(),
            braked: wheels.iter().map(|(wheel, _)| tyres[*wheel].1 / all).sum(),
            wheels,
            share,
            speed_m_s,
        };
        let driven: Vec<(usize, f64)> =
            axles.list().iter().enumerate().filter_map(|(axle, of)| Some((axle, of.lead?))).collect();
        let with_lead = |axle: usize, lead: f64| of_axle(axle).map(move |wheel| (wheel, lead));
        let mut shafts = match chassis.centre {
            Differential::Locked => {
                vec![shaft(driven.iter().flat_map(|(axle, lead)| with_lead(*axle, *lead)).collect(), 1.0)]
            }
            Differential::Open => {
                let share = 1.0 / driven.len() as f64;
                driven.iter().map(|(axle, lead)| shaft(with_lead(*axle, *lead).collect(), share)).collect()
            }
        };
        let free = (0..tyres.len()).filter(|wheel| driven.iter().all(|(axle, _)| *axle != tyres[*wheel].0));
        shafts.extend(free.map(|wheel| shaft(vec![(wheel, 1.0)], 0.0)));
        let differences = driven
            .iter()
            .filter(|(axle, _)| chassis.axles[*axle].differential == Differential::Open)
            .filter_map(|(axle, _)| match of_axle(*axle).collect::<Vec<_>>()[..] {
                [left, right] => Some(Difference {
                    left,
                    right,
                    mass_kg: masses_kg[left] + masses_kg[right],
                    speed_m_s: 0.0,
                }),
                _ => None,
            })
            .collect();
        let wheels = tyres.len();
        let mut spin = Self {
            shafts,
            differences,
            turning_kg: 0.0,
            wheels_m_s: vec![0.0; wheels],
            changes_m_s2: vec![0.0; wheels],
            masses_kg,
            stopped_m: vec![0.0; wheels],
        };
        spin.spread();
        spin
    }

    /// Wheels that nothing drives or brakes, each for itself.
    pub fn free(tyres: &[f64], rotating_kg: f64, speed_m_s: f64) -> Self {
        let all: f64 = tyres.iter().sum();
        let masses_kg: Vec<f64> = tyres.iter().map(|own| rotating_kg * own / all).collect();
        let shaft = |(wheel, mass_kg): (usize, &f64)| Shaft {
            wheels: vec![(wheel, 1.0)],
            share: 0.0,
            braked: 0.0,
            mass_kg: *mass_kg,
            speed_m_s,
        };
        let mut spin = Self {
            shafts: masses_kg.iter().enumerate().map(shaft).collect(),
            differences: Vec::new(),
            turning_kg: 0.0,
            wheels_m_s: vec![0.0; tyres.len()],
            changes_m_s2: vec![0.0; tyres.len()],
            masses_kg,
            stopped_m: vec![0.0; tyres.len()],
        };
        spin.spread();
        spin
    }

    fn spread(&mut self) {
        for shaft in &self.shafts {
            for (wheel, lead) in &shaft.wheels {
                self.wheels_m_s[*wheel] = lead * shaft.speed_m_s;
            }
        }
        for difference in &self.differences {
            self.wheels_m_s[difference.left] += difference.speed_m_s;
            self.wheels_m_s[difference.right] -= difference.speed_m_s;
        }
    }

    /// Speed at which the driveline turns [m/s].
    pub fn driven_m_s(&self) -> f64 {
        self.shafts.iter().map(|shaft| shaft.share * shaft.speed_m_s).sum()
    }

    /// What wheels and driveline turn with [J].
    pub fn kinetic_j(&self) -> f64 {
        let shafts: f64 = self
            .shafts
            .iter()
            .map(|shaft| (shaft.mass_kg + shaft.share * self.turning_kg) * shaft.speed_m_s * shaft.speed_m_s)
            .sum();
        let differences: f64 =
            self.differences.iter().map(|one| one.mass_kg * one.speed_m_s * one.speed_m_s).sum();
        0.5 * (shafts + differences)
    }

    /// Couples other masses to the driven shafts, at the speed that they have; returns the energy that comes with them [J].
    pub fn couple(&mut self, turning_kg: f64) -> f64 {
        if turning_kg == self.turning_kg {
            return 0.0;
        }
        let before_j = self.kinetic_j();
        self.turning_kg = turning_kg;
        self.kinetic_j() - before_j
    }

    /// One step under the driveline's force and the brakes, with the ground's force on each wheel `gross_n`.
    ///
    /// A driveline that pushes against the `way` of the vehicle brakes: an engine holds wheels that stand, and turns none back.
    pub fn advance(
        &mut self,
        (drive_n, way): (f64, f64),
        brake_n: f64,
        gross_n: impl Fn(usize) -> f64,
        step_s: f64,
    ) -> Turned {
        let mut turned = Turned::default();
        self.changes_m_s2.copy_from_slice(&self.wheels_m_s);
        for shaft in &mut self.shafts {
            let mass_kg = shaft.mass_kg + shaft.share * self.turning_kg;
            let ground_n: f64 = shaft.wheels.iter().map(|(wheel, lead)| lead * gross_n(*wheel)).sum();
            let before_m_s = shaft.speed_m_s;
            let (pushed_n, slowed_n) =
                if drive_n * way < 0.0 { (0.0, drive_n.abs()) } else { (drive_n, 0.0) };
            let rolling_m_s = before_m_s + step_s * (shaft.share * pushed_n - ground_n) / mass_kg;
            let free_m_s = slower(rolling_m_s, step_s * shaft.share * slowed_n / mass_kg);
            // 0 · ∞ is what no brake does.
            let held_m_s = if brake_n == 0.0 { 0.0 } else { step_s * shaft.braked * brake_n / mass_kg };
            shaft.speed_m_s = slower(free_m_s, held_m_s);
            let way_m = 0.5 * step_s * (before_m_s + shaft.speed_m_s);
            turned.driven_m += shaft.share * way_m;
            turned.brakes_j += mass_kg * (free_m_s - shaft.speed_m_s) / step_s * way_m;
            let stopped_m = if held_m_s > 0.0 && shaft.speed_m_s == 0.0 { way_m } else { 0.0 };
            for (wheel, lead) in &shaft.wheels {
                self.stopped_m[*wheel] = lead * stopped_m;
            }
            if before_m_s * way < 0.0 {
                // Told that its wheels stand, the driveline books nothing: what it holds them with is heat, as in a clutch.
                turned.brakes_j +=
                    (mass_kg * (rolling_m_s - free_m_s) / step_s - shaft.share * pushed_n) * way_m;
            }
        }
        for one in &mut self.differences {
            let apart_n = gross_n(one.left) - gross_n(one.right);
            one.speed_m_s -= step_s * apart_n / one.mass_kg;
        }
        self.spread();
        for (change, speed) in self.changes_m_s2.iter_mut().zip(&self.wheels_m_s) {
            *change = (speed - *change) / step_s;
        }
        turned
    }

    /// Lets every wheel turn again as it did before a step.
    pub fn put_back(&mut self, wheels_m_s: Vec<f64>) {
        for shaft in &mut self.shafts {
            // What a differential adds on one side it takes on the other.
            let sum_m_s: f64 = shaft.wheels.iter().map(|(wheel, lead)| wheels_m_s[*wheel] / lead).sum();
            shaft.speed_m_s = sum_m_s / shaft.wheels.len() as f64;
        }
        for one in &mut self.differences {
            one.speed_m_s = 0.5 * (wheels_m_s[one.left] - wheels_m_s[one.right]);
        }
        self.wheels_m_s = wheels_m_s;
    }

    /// Inertia and wheels of each shaft, the lightest that a wheel may turn with [kg].
    pub fn shafts(&self) -> impl Iterator<Item = (f64, &[(usize, f64)])> {
        self.shafts.iter().map(|shaft| (shaft.mass_kg, shaft.wheels.as_slice()))
    }
}

/// A speed less what takes from it and cannot turn it back [m/s].
fn slower(speed_m_s: f64, by_m_s: f64) -> f64 {
    if speed_m_s.abs() <= by_m_s { 0.0 } else { speed_m_s - by_m_s.copysign(speed_m_s) }
}
