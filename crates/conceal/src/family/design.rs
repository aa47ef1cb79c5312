//! How a set of runs is laid out: how many, which way, on which lanes, how often a row, which runs are kept out.

use super::Needs;
use crate::dice::Dice;
use std::f64::consts::TAU;

/// The layout of a set of runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// Whether each run is driven from the lane's end.
    pub reversed: Vec<bool>,
    /// Whether each run is kept from every fit.
    pub held_out: Vec<bool>,
    /// Which lane each run drives: lanes lie far apart.
    pub lanes: Vec<usize>,
    /// Whether the recording says which runs share a lane.
    pub paths_told: bool,
    /// Whether the recording says which runs are kept out; else the diagnosis chooses.
    pub held_out_told: bool,
    /// Rows a second.
    pub rate_hz: f64,
    /// How far the time between two rows may be off, as a share of it.
    pub uneven: f64,
    /// Wind that an anemometer shows, north and east of where it comes from [m/s].
    pub wind_m_s: [f64; 2],
}

impl Design {
    /// Draws one.
    pub fn new(rates_hz: &[f64], needs: &Needs, dice: &mut Dice) -> Self {
        let least = if needs.ballast || needs.temperatures { 6 } else { 3 };
        let runs = least + dice.below(15 - least);
        let both_ways = dice.chance(0.75);
        let lanes = if !needs.one_lane && runs >= 8 && dice.chance(0.2) { 2 } else { 1 };
        // Lanes change every second run, so that each is driven both ways.
        let lanes: Vec<usize> = (0..runs).map(|run| (run / 2) % lanes).collect();
        let reversed: Vec<bool> = (0..runs).map(|run| both_ways && run % 2 == 1).collect();
        let paths_told = both_ways || needs.position || needs.one_lane || dice.chance(0.6);
        let wind_m_s = if !needs.calm && dice.chance(0.15) {
            let (speed, from) = (dice.within(1.0, 7.0), dice.within(0.0, TAU));
            [speed * from.cos(), speed * from.sin()]
        } else {
            [0.0; 2]
        };
        Self {
            held_out: held_out(runs, both_ways, dice),
            reversed,
            lanes,
            paths_told,
            held_out_told: dice.chance(0.75),
            rate_hz: rates_hz[dice.below(rates_hz.len())],
            uneven: if dice.chance(0.2) { dice.within(0.05, 0.35) } else { 0.0 },
            wind_m_s,
        }
    }

    /// How many runs.
    pub fn runs(&self) -> usize {
        self.reversed.len()
    }

    /// Whether an anemometer stands beside the lane.
    pub fn anemometer(&self) -> bool {
        self.wind_m_s != [0.0; 2]
    }

    /// Where a lane begins on the ground [m].
    pub fn lane_m(&self, run: usize) -> f64 {
        /// Far enough that lanes do not overlap.
        const APART_M: f64 = 10_000.0;
        APART_M * self.lanes[run] as f64
    }
}

/// Three runs of ten, so that at least two are left, one each way where both were driven.
fn held_out(runs: usize, both_ways: bool, dice: &mut Dice) -> Vec<bool> {
    let number = ((3 * runs + 5) / 10).clamp(1, runs - 2);
    let mut order: Vec<usize> = (0..runs).collect();
    loop {
        dice.shuffle(&mut order);
        let out = &order[..number];
        let left = |odd: usize| (0..runs).any(|run| run % 2 == odd && !out.contains(&run));
        if !both_ways || (left(0) && left(1)) {
            return (0..runs).map(|run| out.contains(&run)).collect();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_layout_leaves_runs_to_fit_and_one_to_prove() {
        let mut both = [0, 0];
        for seed in 0..200 {
            let design = Design::new(&[5.0, 100.0], &Needs::default(), &mut Dice::new(seed, 0));
            assert!((3..=14).contains(&design.runs()));
            let out = design.held_out.iter().filter(|out| **out).count();
            assert!(out >= 1 && design.runs() - out >= 2);
            let one_way = design.reversed.iter().all(|reversed| !reversed);
            both[usize::from(one_way)] += 1;
            let fitted = |way: bool| {
                design.reversed.iter().zip(&design.held_out).any(|(back, out)| *back == way && !out)
            };
            assert!(one_way || (fitted(true) && fitted(false)));
        }
        assert!(both[0] > 100 && both[1] > 20, "{both:?}");
    }
}
