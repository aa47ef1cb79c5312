//! What hangs on what the forces make: told a supposed acceleration and force of the drive, effects make others of them, and both
//! have to be the same in the end.
//!
//! a = A(a), found as the root of A(a) − a by secants that are kept between values of either sign; F = F(F) by going on from each
//! answer, which comes closer by about the share that is lost.
//!
//! Source: the secant method with bisection where it leaves its bracket (Brent, *Algorithms for Minimization without Derivatives*
//! (1973), chapter 4). A force that leaps across its root has none: the last of the rounds is taken then. One that pushes ahead by more
//! than the mass times the acceleration has one, at which the vehicle moves as with a mass below nought.

use crate::balance::Made;

/// What is supposed and what is made agree within this share.
const AGREED: f64 = 1e-9;
/// Accelerations below it are nought [m/s²].
const NOUGHT_M_S2: f64 = 1e-12;
const MOST_ROUNDS: usize = 20;

/// A supposed acceleration, and by how much what the forces make of it is more [m/s²].
#[derive(Clone, Copy, Debug)]
struct Tried {
    at_m_s2: f64,
    over_m_s2: f64,
}

/// The search for what agrees with itself.
#[derive(Debug)]
pub(crate) struct Agreement {
    /// Whether forces hang on the acceleration.
    by_acceleration: bool,
    supposed: Made,
    rounds: usize,
    agreed: bool,
    last: Option<Tried>,
    /// The nearest below the root, and the nearest above it.
    below: Option<Tried>,
    above: Option<Tried>,
}

impl Agreement {
    /// Nothing is known: no acceleration and no force is supposed.
    pub fn new(by_acceleration: bool) -> Self {
        Self {
            by_acceleration,
            supposed: Made::default(),
            rounds: 0,
            agreed: false,
            last: None,
            below: None,
            above: None,
        }
    }

    /// What to suppose next; nothing once it agrees, or never will.
    pub fn to_ask(&self) -> Option<Made> {
        (!self.agreed && self.rounds < MOST_ROUNDS).then_some(self.supposed)
    }

    /// Takes what came of the supposition; what is known then.
    pub fn answered(&mut self, made: Made) -> Made {
        let supposed = self.supposed;
        self.rounds += 1;
        let apart_n = (made.tractive_force_n - supposed.tractive_force_n).abs();
        let one = Tried {
            at_m_s2: supposed.acceleration_m_s2,
            over_m_s2: made.acceleration_m_s2 - supposed.acceleration_m_s2,
        };
        let near_m_s2 = AGREED * one.at_m_s2.abs() + NOUGHT_M_S2;
        let accelerates_so = !self.by_acceleration || one.over_m_s2.abs() <= near_m_s2;
        self.agreed = apart_n <= AGREED * supposed.tractive_force_n.abs() && accelerates_so
            || !made.acceleration_m_s2.is_finite();
        self.supposed = made;
        if !self.agreed && self.by_acceleration {
            self.supposed.acceleration_m_s2 = self.after(one);
        }
        self.supposed
    }

    /// The acceleration to suppose after this one.
    fn after(&mut self, one: Tried) -> f64 {
        if one.over_m_s2 == 0.0 {
            return one.at_m_s2;
        }
        if one.over_m_s2 > 0.0 {
            self.below = Some(one);
        } else {
            self.above = Some(one);
        }
        let made_m_s2 = one.at_m_s2 + one.over_m_s2;
        let secant_m_s2 = self.last.map_or(made_m_s2, |last| {
            let rise = (one.over_m_s2 - last.over_m_s2) / (one.at_m_s2 - last.at_m_s2);
            one.at_m_s2 - one.over_m_s2 / rise
        });
        self.last = Some(one);
        match (self.below, self.above) {
            (Some(below), Some(above)) => {
                let within = secant_m_s2 > below.at_m_s2.min(above.at_m_s2)
                    && secant_m_s2 < below.at_m_s2.max(above.at_m_s2);
                if within { secant_m_s2 } else { 0.5 * (below.at_m_s2 + above.at_m_s2) }
            }
            _ if secant_m_s2.is_finite() => secant_m_s2,
            _ => made_m_s2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where forces of `free_m_s2` times the mass act beside what the acceleration makes, per mass.
    fn found_m_s2(free_m_s2: f64, more_m_s2: impl Fn(f64) -> f64) -> (f64, usize) {
        let mut agreement = Agreement::new(true);
        let mut made = Made::default();
        while let Some(supposed) = agreement.to_ask() {
            let acceleration_m_s2 = free_m_s2 + more_m_s2(supposed.acceleration_m_s2);
            made = agreement.answered(Made { acceleration_m_s2, ..Made::default() });
        }
        (made.acceleration_m_s2, agreement.rounds)
    }

    #[test]
    fn an_overrun_brake_finds_the_acceleration_that_its_own_force_makes() {
        // a = a₀ − k max(0, −a − c): a = (a₀ + k c)/(1 − k) below −c.
        let brake = |k: f64| move |a: f64| -k * (-a - 0.2).max(0.0);
        for (k, free) in [(0.4, -0.7), (0.9, -0.3), (0.4, 0.5), (0.4, 0.0)] {
            let expected = if free < -0.2 { (free + k * 0.2) / (1.0 - k) } else { free };
            let (found, rounds) = found_m_s2(free, brake(k));
            assert!((found - expected).abs() <= 1e-8 * expected.abs(), "{k}, {free}: {found}, {expected}");
            assert!(rounds <= 6, "{rounds}");
        }
    }

    #[test]
    fn a_force_that_turns_steeply_with_the_sign_is_found_though_going_on_from_it_would_run_away() {
        for free in [-1.3, -0.04, 0.0, 0.6] {
            let (found, rounds) = found_m_s2(free, |a| -0.5 * (a / 0.05).tanh());
            assert!((found - (free - 0.5 * (found / 0.05).tanh())).abs() < 1e-8, "{free}: {found}");
            assert!(rounds < MOST_ROUNDS, "{free}: {rounds}");
        }
    }

    #[test]
    fn what_leaps_across_its_root_ends() {
        let (found, rounds) = found_m_s2(0.1, |a| if a > 0.0 { -0.5 } else { 0.0 });
        assert!(found.is_finite() && rounds == MOST_ROUNDS);
    }
}
