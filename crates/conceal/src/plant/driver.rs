//! Who drives: a plan of speed over time, held by a proportional and integral controller, or a lever in neutral.

/// What is wanted.
#[derive(Clone, Debug, PartialEq)]
pub enum Goal {
    /// Roll free.
    Coast,
    /// Times [s], from 0 on, and speeds [m/s], straight between.
    Follow(Vec<(f64, f64)>),
}

impl Goal {
    fn at(&self, time_s: f64) -> (f64, f64) {
        let Self::Follow(points) = self else { return (0.0, 0.0) };
        let next = points.partition_point(|point| point.0 <= time_s);
        let (Some(before), Some(after)) = (next.checked_sub(1).map(|index| points[index]), points.get(next))
        else {
            let end = if next == 0 { points.first() } else { points.last() };
            return (end.map_or(0.0, |point| point.1), 0.0);
        };
        let slope = (after.1 - before.1) / (after.0 - before.0);
        (before.1 + slope * (time_s - before.0), slope)
    }
}

/// A driver.
#[derive(Clone, Debug)]
pub struct Driver {
    mass_kg: f64,
    most_n: f64,
    least_n: f64,
    integral_n: f64,
    force_n: f64,
    behind_m_s: f64,
}

/// Proportional gain of speed [1/s].
const GAIN_PER_S: f64 = 0.9;
/// Integral gain [1/s²].
const INTEGRAL_PER_S2: f64 = 0.25;
/// Lag of the drive behind the pedal [s].
const LAG_S: f64 = 0.15;
/// How fast a driver takes up speed that a brake took [m/s²].
const CATCH_UP_M_S2: f64 = 0.8;

impl Driver {
    /// A driver of a vehicle of this mass [kg], who may push and hold back with these forces [N].
    pub fn new(mass_kg: f64, least_n: f64, most_n: f64) -> Self {
        Self { mass_kg, most_n, least_n, integral_n: 0.0, force_n: 0.0, behind_m_s: 0.0 }
    }

    /// Force asked of the wheels over the next step [N].
    pub fn ask(&mut self, goal: &Goal, time_s: f64, speed_m_s: f64, braked: bool, step_s: f64) -> f64 {
        if *goal == Goal::Coast {
            self.force_n = 0.0;
            return 0.0;
        }
        let (plan, slope) = goal.at(time_s);
        let wanted = if braked {
            self.behind_m_s = (plan - speed_m_s).max(0.0);
            0.0
        } else {
            self.behind_m_s = (self.behind_m_s - CATCH_UP_M_S2 * step_s).max(0.0);
            let catching = if self.behind_m_s > 0.0 { CATCH_UP_M_S2 } else { 0.0 };
            let error = plan - self.behind_m_s - speed_m_s;
            self.integral_n += INTEGRAL_PER_S2 * self.mass_kg * error * step_s;
            self.mass_kg * (slope + catching + GAIN_PER_S * error) + self.integral_n
        };
        let wanted = wanted.clamp(self.least_n, self.most_n);
        self.force_n += (wanted - self.force_n) * step_s / LAG_S;
        self.force_n
    }

    /// Sets the force and the integral to what holds a steady speed [N].
    pub fn settle(&mut self, steady_n: f64) {
        (self.integral_n, self.force_n) = (steady_n, steady_n);
    }
}
