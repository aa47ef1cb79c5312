//! What a run asked of its driveline, as demands that each hold for one step.

use headland_plugin::Demand;
use headland_trace::Trace;

/// Means over every whole step of `step_s` [s] of what a simulated run asked: speed of the wheels, force with what the brakes
/// took, power of shafts and consumers. Force and speed together keep the energy at the wheels.
///
/// Leaves out what is no channel of its own: friction that an effect adds to the engine, resistance that one adds to the
/// battery, shaft power of effects, and a speed at which the driver keeps the engine by hand.
pub fn demands(trace: &Trace, step_s: f64) -> Vec<Demand> {
    let time_s = trace.time_s();
    let channel = |name: &str| trace.get(name);
    let Some(begin_s) = time_s.first().copied() else { return Vec::new() };
    let speed = channel("wheel_speed_m_s").or_else(|| channel("speed_m_s")).unwrap_or(&[]);
    let drive = channel("tractive_force_n").unwrap_or(&[]);
    let of = |values: Option<&[f64]>, at: usize| values.map_or(0.0, |values| values[at]);
    let (brakes, coasting) = (channel("brake_force_n"), channel("coasting"));
    let (pto, hydraulic) = (channel("pto_power_w"), channel("hydraulic_power_w"));
    let auxiliary = channel("auxiliary_power_w");
    let mut demands = Vec::new();
    let mut sums = Sums::default();
    // Rounding of sums of steps is no missing sample.
    let rounding_s = 1e-9 * step_s;
    for at in 0..speed.len().min(drive.len()).saturating_sub(1) {
        let span_s = time_s[at + 1] - time_s[at];
        let force_n = drive[at] - of(brakes, at);
        sums.time_s += span_s;
        sums.way_m += speed[at] * span_s;
        sums.impulse_n_s += force_n * span_s;
        sums.work_j += force_n * speed[at] * span_s;
        sums.shaft_j += (of(pto, at) + of(hydraulic, at)) * span_s;
        sums.auxiliary_j += of(auxiliary, at) * span_s;
        sums.coasted_s += of(coasting, at) * span_s;
        let end_s = begin_s + (demands.len() + 1) as f64 * step_s;
        if time_s[at + 1] >= end_s - rounding_s {
            demands.push(sums.demand());
            sums = Sums::default();
        }
    }
    demands
}

/// Integrals over a step.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    time_s: f64,
    way_m: f64,
    impulse_n_s: f64,
    work_j: f64,
    shaft_j: f64,
    auxiliary_j: f64,
    coasted_s: f64,
}

impl Sums {
    fn demand(&self) -> Demand {
        /// A step with less way than this mean speed makes is told by its mean force [m/s].
        const CREEPS_M_S: f64 = 0.05;
        let speed_m_s = self.way_m / self.time_s;
        let moves = speed_m_s.abs() > CREEPS_M_S;
        Demand {
            speed_m_s,
            force_n: if moves { self.work_j / self.way_m } else { self.impulse_n_s / self.time_s },
            coasting: self.coasted_s > 0.5 * self.time_s,
            auxiliary_power_w: self.auxiliary_j / self.time_s,
            shaft_power_w: self.shaft_j / self.time_s,
            ..Demand::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_trace::Origin;

    /// A channel over time.
    type Channel = (&'static str, fn(f64) -> f64);

    fn trace(step_s: f64, channels: &[Channel]) -> Trace {
        let time_s: Vec<f64> = (0..=100).map(|i| 5.0 + step_s * f64::from(i)).collect();
        let mut trace = Trace::new(time_s.clone()).unwrap();
        for (name, value) in channels {
            let values = time_s.iter().map(|time_s| value(*time_s)).collect();
            trace.push((*name).to_owned(), values, Origin::Predicted).unwrap();
        }
        trace
    }

    /// v = t and F = 1000 t for 10 s: each second keeps its work, and what is braked is part of the force.
    #[test]
    fn the_work_at_the_wheels_is_kept() {
        let trace = trace(
            0.1,
            &[
                ("wheel_speed_m_s", |time_s| time_s),
                ("tractive_force_n", |time_s| 1500.0 * time_s),
                ("brake_force_n", |time_s| 500.0 * time_s),
                ("pto_power_w", |_| 3e3),
                ("hydraulic_power_w", |_| 2e3),
            ],
        );
        let demands = demands(&trace, 1.0);
        assert_eq!(demands.len(), 10);
        let work_j: f64 = demands.iter().map(|demand| demand.force_n * demand.speed_m_s).sum();
        let left: f64 = (0..100).map(|i| 5.0 + 0.1 * f64::from(i)).map(|t| 1000.0 * t * t * 0.1).sum();
        assert!((work_j / left - 1.0).abs() < 1e-12, "{work_j} {left}");
        assert!(demands.iter().all(|demand| (demand.shaft_power_w - 5e3).abs() < 1e-6));
    }

    /// A step that does not divide that of the trace begins and ends at the nearest samples; what is over is left.
    #[test]
    fn a_rest_of_less_than_a_step_is_left() {
        let trace = trace(
            0.1,
            &[
                ("speed_m_s", |_| 2.0),
                ("tractive_force_n", |_| 10.0),
                ("coasting", |t| f64::from(u8::from(t > 8.0))),
            ],
        );
        let demands = demands(&trace, 3.0);
        assert_eq!(demands.len(), 3);
        let coasting: Vec<bool> = demands.iter().map(|demand| demand.coasting).collect();
        assert_eq!(coasting, [false, true, true]);
        assert!((demands[0].speed_m_s - 2.0).abs() < 1e-12 && demands[0].auxiliary_power_w == 0.0);
    }
}
