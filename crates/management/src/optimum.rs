//! The best that could have been done: dynamic programming over a course that is known to its end.
//!
//! J_N(S) = w max(0, S_end − S)
//! J_k(S) = min over shares of  P_f Δt + J_{k+1}(S + Δt dS/dt)
//!
//! Source: Bellman, *Dynamic Programming* (1957); Sundström and Guzzella, *A generic dynamic programming Matlab function*
//! (2009), for its use here.
//!
//! No management can use it, because it sees the future; it is what managements are measured against. The charge lies on a
//! grid, values between are linear. The weight w makes missing charge dearer than any fuel that could have made it.

use headland_plugin::{Consequence, Share};
use rayon::prelude::*;

/// A course as dynamic programming sees it: demands one after the other, each for one step.
pub trait Course: Sync {
    /// How many steps.
    fn steps(&self) -> usize;

    /// Length of a step [s].
    fn step_s(&self) -> f64;

    /// The most that the engine gives in a step [W].
    fn most_engine_w(&self, step: usize) -> f64;

    /// Power that leaves the store alone in a step [W].
    fn power_w(&self, step: usize) -> f64;

    /// What a share takes in a step, at a charge.
    fn weigh(&self, step: usize, charge: f64, share: Share) -> Consequence;
}

/// How finely the optimum is looked for.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
    /// Least and greatest charge that may be used.
    pub window: (f64, f64),
    /// Charges, two or more.
    pub charges: usize,
    /// Powers of the engine beside 0.
    pub levels: usize,
    /// Value of a charge of 1 [J of fuel], for the weight of what is missing at the end.
    pub full_charge_j: f64,
}

/// How power was shared over a course, and what that took.
#[derive(Clone, Debug, PartialEq)]
pub struct Sharing {
    /// Energy of the fuel [J].
    pub fuel_j: f64,
    /// Energy that the wheels got less than was asked [J].
    pub short_j: f64,
    /// Share in every step.
    pub shares: Vec<Share>,
    /// Charge before every step, and at the end.
    pub charges: Vec<f64>,
}

/// Charges that no grid can hold.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("charges from {start} to {end} in a window from {} to {} with {charges} points: expected two points or more, and both charges within", .window.0, .window.1)]
pub struct Unreachable {
    /// Charge at the start.
    pub start: f64,
    /// Charge at the end.
    pub end: f64,
    /// Least and greatest charge.
    pub window: (f64, f64),
    /// Points of the grid.
    pub charges: usize,
}

/// Fuel energy for missing store energy: dearer than the least efficient way to charge.
const MISSING_WEIGHT: f64 = 20.0;

/// Fuel energy for energy that the wheels do not get.
const SHORT_WEIGHT: f64 = crate::least::SHORT_COST;

/// The course of least fuel from one charge to another.
///
/// # Errors
/// [`Unreachable`].
pub fn optimum(course: &dyn Course, start: f64, end: f64, grid: Grid) -> Result<Sharing, Unreachable> {
    let (least, most) = grid.window;
    let within = |charge: f64| (least..=most).contains(&charge);
    if grid.charges < 2 || most <= least || !within(start) || !within(end) {
        return Err(Unreachable { start, end, window: grid.window, charges: grid.charges });
    }
    let spacing = (most - least) / (grid.charges - 1) as f64;
    let weight = MISSING_WEIGHT * grid.full_charge_j;
    let last = (0..grid.charges).map(|i| weight * (end - (least + spacing * i as f64)).max(0.0)).collect();
    let mut values: Vec<Vec<f64>> = vec![last];
    for step in (0..course.steps()).rev() {
        let next = &values[values.len() - 1];
        let here = (0..grid.charges).into_par_iter().map(|i| {
            let charge = least + spacing * i as f64;
            best(course, step, charge, &grid, next).1
        });
        let here = here.collect();
        values.push(here);
    }
    values.reverse();

    let mut found = Sharing { fuel_j: 0.0, short_j: 0.0, shares: Vec::new(), charges: vec![start] };
    let mut charge = start;
    for step in 0..course.steps() {
        let (share, _) = best(course, step, charge, &grid, &values[step + 1]);
        let consequence = course.weigh(step, charge, share);
        found.fuel_j += consequence.fuel_w * course.step_s();
        found.short_j += consequence.short_w * course.step_s();
        charge += consequence.charge_per_s * course.step_s();
        found.shares.push(share);
        found.charges.push(charge);
    }
    Ok(found)
}

/// The best share of one step, and the cost from there to the end.
fn best(course: &dyn Course, step: usize, charge: f64, grid: &Grid, next: &[f64]) -> (Share, f64) {
    let step_s = course.step_s();
    let most = course.most_engine_w(step);
    let running = (0..=grid.levels)
        .map(|level| Share { engine_runs: true, engine_w: most * level as f64 / grid.levels.max(1) as f64 });
    let alone = Share { engine_runs: true, engine_w: course.power_w(step).clamp(0.0, most) };
    let stopped = Share { engine_runs: false, engine_w: 0.0 };
    let mut found = (stopped, f64::INFINITY);
    for share in [stopped, alone].into_iter().chain(running) {
        let consequence = course.weigh(step, charge, share);
        let then = charge + consequence.charge_per_s * step_s;
        let cost =
            (consequence.fuel_w + SHORT_WEIGHT * consequence.short_w) * step_s + value(then, grid, next);
        if cost < found.1 {
            found = (share, cost);
        }
    }
    found
}

/// The cost from a charge to the end; outside the window it grows as missing charge does.
fn value(charge: f64, grid: &Grid, next: &[f64]) -> f64 {
    let (least, most) = grid.window;
    let outside = (least - charge).max(charge - most).max(0.0);
    let place = (charge.clamp(least, most) - least) / (most - least) * (next.len() - 1) as f64;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the grid")]
    let low = (place.floor() as usize).min(next.len() - 2);
    let share = place - low as f64;
    next[low] + share * (next[low + 1] - next[low]) + MISSING_WEIGHT * grid.full_charge_j * outside
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::{MOST_ENGINE_W, Plant, STORE_J, fuel_w};
    use headland_plugin::Stores;

    struct Hill(Vec<f64>);

    impl Course for Hill {
        fn steps(&self) -> usize {
            self.0.len()
        }

        fn step_s(&self) -> f64 {
            10.0
        }

        fn most_engine_w(&self, _: usize) -> f64 {
            MOST_ENGINE_W
        }

        fn power_w(&self, step: usize) -> f64 {
            self.0[step]
        }

        fn weigh(&self, step: usize, charge: f64, share: Share) -> Consequence {
            Plant { power_w: self.0[step], state_of_charge: charge, engine_runs: share.engine_runs }
                .weigh(share)
        }
    }

    const GRID: Grid = Grid { window: (0.2, 0.8), charges: 241, levels: 80, full_charge_j: STORE_J };

    /// The costs are convex, so the best is the mean power throughout: (60 + 100) / 2 = 80 kW, if the engine never stops.
    #[test]
    fn convex_costs_and_a_store_without_losses_ask_for_the_mean() {
        let hill = Hill([vec![60e3; 20], vec![100e3; 20]].concat());
        let found = optimum(&hill, 0.5, 0.5, GRID).unwrap();
        assert!(found.short_j == 0.0 && found.charges.last().unwrap() - 0.5 > -1e-3);
        let mean = fuel_w(80e3) * 400.0;
        let unmanaged = 200.0 * (fuel_w(60e3) + fuel_w(100e3));
        assert!(found.fuel_j > 0.999 * mean && found.fuel_j < 1.001 * mean, "{} of {mean}", found.fuel_j);
        assert!(found.fuel_j < unmanaged);
    }

    /// A cheap load alone: 5 kW for 400 s take 2 MJ; running all the time burns 8 kW for nothing.
    #[test]
    fn a_light_load_is_done_in_spells_with_the_engine_off_between() {
        let light = Hill(vec![5e3; 40]);
        let found = optimum(&light, 0.5, 0.5, GRID).unwrap();
        let stopped = found.shares.iter().filter(|share| !share.engine_runs).count();
        assert!(stopped > 20, "{stopped} of 40");
        assert!(found.fuel_j < fuel_w(5e3) * 400.0);
    }

    /// All that the store may give is given where the end asks for nothing.
    #[test]
    fn an_end_at_the_bottom_empties_the_store_first() {
        let hill = Hill(vec![50e3; 40]);
        let kept = optimum(&hill, 0.5, 0.5, GRID).unwrap();
        let emptied = optimum(&hill, 0.5, 0.2, GRID).unwrap();
        assert!(emptied.fuel_j < kept.fuel_j - 0.3 * STORE_J * 2.0);
        assert!(emptied.charges.iter().all(|charge| (0.199..0.801).contains(charge)));
    }

    #[test]
    fn a_charge_outside_the_window_is_refused() {
        let hill = Hill(vec![50e3]);
        assert!(optimum(&hill, 0.9, 0.5, GRID).unwrap_err().to_string().contains("0.9"));
        assert!(optimum(&hill, 0.5, 0.5, Grid { charges: 1, ..GRID }).is_err());
    }
}
