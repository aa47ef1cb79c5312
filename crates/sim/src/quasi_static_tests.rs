//! The quasistatic method against closed forms, observed order, and the method of Runge and Kutta.

use crate::physics_tests::{drive, last, tractor};
use crate::{Cycle, End, Model, Named, Outcome, Phase, Simulation, Start, Until};
use headland_plugin::{Action, Delivery, Demand, Driveline, Effect, Readings, Situation, State};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

fn walked(model: &Model, start_m_s: f64, step_s: f64, record_s: f64, phases: Vec<Phase>) -> Outcome {
    let start = Start { position_m: 0.0, speed_m_s: start_m_s };
    let cycle = Cycle { start, phases, driver_gain_per_s: 1.0, step_s, longest_s: 1000.0 };
    Simulation::new(model, &cycle).quasi_static(record_s).run().unwrap()
}

fn account(outcome: &Outcome, name: &str) -> f64 {
    outcome.ledger.sinks.iter().find(|entry| entry.name == name).map_or(0.0, |entry| entry.energy_j)
}

/// A ramp of 2 m/s² for 10 s, in corners of a second as cycles have them.
fn ramp() -> Vec<Phase> {
    vec![Phase::Follow {
        profile: (0..=10).map(|second| (f64::from(second), 2.0 * f64::from(second))).collect(),
    }]
}

/// A level that fades, and a drag that goes with it.
#[derive(Debug)]
struct Fading;

impl Effect for Fading {
    fn states(&self) -> Vec<State> {
        vec![State { name: "level", initial: 1.0 }]
    }

    fn act(&self, _: &Situation, states: &[f64], rates: &mut [f64]) -> Action {
        rates[0] = -0.5 * states[0];
        Action { resistance_n: 1000.0 * states[0], ..Action::default() }
    }
}

/// Gives what is asked, up to a limit, and counts how often it is asked.
#[derive(Debug)]
struct Counting {
    asked: Arc<AtomicUsize>,
    limit_n: f64,
}

impl Driveline for Counting {
    fn losses(&self) -> &'static [&'static str] {
        &[]
    }

    fn source(&self) -> &'static str {
        "store"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        100.0
    }

    fn deliver(&self, demand: &Demand, _: &[f64], _: &mut [f64]) -> Delivery {
        self.asked.fetch_add(1, Ordering::Relaxed);
        let force_n = demand.force_n.clamp(0.0, self.limit_n);
        Delivery {
            force_n,
            source_power_w: force_n * demand.speed_m_s,
            readings: Readings::NONE,
            ..Delivery::NOTHING
        }
    }
}

/// ∫ ½ ρ A v³ dt = ½ ρ A a³ t⁴ / 4.
#[test]
fn the_work_of_the_air_converges_at_second_order() {
    let exact = 0.5 * 1.235 * 6.0 * 8.0 * 1e4 / 4.0;
    let error = |step_s: f64| {
        let outcome = walked(&tractor(f64::INFINITY, 6.0), 0.0, step_s, 0.0, ramp());
        assert_eq!(outcome.end, End::Finished);
        (account(&outcome, "air") - exact).abs()
    };
    let order = (error(0.5) / error(0.25)).log2();
    assert!((order - 2.0).abs() < 0.1, "observed order {order}: {} {}", error(0.5), error(0.25));
}

#[test]
fn what_a_model_remembers_converges_at_second_order() {
    let error = |step_s: f64| {
        let mut model = tractor(f64::INFINITY, 0.0);
        model.effects.push(Named { name: "fading".to_owned(), plugin: Box::new(Fading) });
        let outcome = walked(&model, 5.0, step_s, 0.0, vec![Phase::Hold { for_s: 8.0 }]);
        (last(&outcome, "fading_level") - (-4.0f64).exp()).abs()
    };
    let order = (error(0.1) / error(0.05)).log2();
    assert!(order > 1.8, "observed order {order}: {} {}", error(0.1), error(0.05));
}

#[test]
fn the_ledger_closes_at_a_step_of_a_second() {
    let mut model = tractor(100.0 / 3.6, 6.0);
    model.effects.push(Named { name: "fading".to_owned(), plugin: Box::new(Fading) });
    let mut phases = ramp();
    phases.push(Phase::Follow { profile: vec![(0.0, 20.0), (6.0, 0.0), (9.0, 0.0), (13.0, 5.0)] });
    phases.push(Phase::Hold { for_s: 3.7 });
    let outcome = walked(&model, 0.0, 1.0, 0.0, phases);
    assert_eq!(outcome.end, End::Finished);
    assert!(account(&outcome, "brakes") > 1e5 && outcome.ledger.turnover_j() > 1e6);
    // The first step of a run is one of Runge and Kutta, whose residual is that of its own order.
    assert!(outcome.ledger.relative_residual() < 1e-6, "{:?}", outcome.ledger);
}

/// With steps of 10 ms both methods come to the same: where the drive can, where it cannot, and where an end comes by place.
#[test]
fn it_agrees_with_runge_and_kutta() {
    let phases = || {
        vec![
            Phase::Reach { speed_m_s: 3.0, acceleration_m_s2: 1.0 },
            Phase::Follow { profile: vec![(0.0, 3.0), (4.0, 9.0), (10.0, 4.0)] },
            Phase::Drive {
                speed_m_s: 6.0,
                acceleration_m_s2: 0.5,
                tolerance_m_s: None,
                until: Until::Travelled(41.3),
            },
            Phase::Coast { until: Until::Stopped },
            Phase::Stand { until: Until::Elapsed(2.0) },
        ]
    };
    for limit_n in [60e3, 18e3] {
        let mut model = tractor(100.0 / 3.6, 6.0);
        let asked = Arc::new(AtomicUsize::new(0));
        model.driveline = Box::new(Counting { asked: Arc::clone(&asked), limit_n });
        let fine = drive(&model, 0.0, 0.01, phases());
        let often = asked.swap(0, Ordering::Relaxed);
        let quick = walked(&model, 0.0, 0.01, 0.0, phases());
        assert_eq!((&fine.end, &quick.end), (&End::Finished, &End::Finished));
        assert!(asked.load(Ordering::Relaxed) < often, "{} {often}", asked.load(Ordering::Relaxed));
        for (one, other) in [
            (quick.trace.duration_s(), fine.trace.duration_s()),
            (last(&quick, "position_m"), last(&fine, "position_m")),
            (quick.ledger.source_j, fine.ledger.source_j),
            (account(&quick, "air"), account(&fine, "air")),
            (account(&quick, "soil"), account(&fine, "soil")),
        ] {
            assert!((one / other - 1.0).abs() < 1e-5, "{limit_n}: {one} {other}");
        }
        assert!(quick.ledger.relative_residual() < 1e-6, "{:?}", quick.ledger);
    }
}

/// Ten steps of a second: one of Runge and Kutta (a first row, three stages more), nine by their middle, and the last row.
#[test]
fn a_known_motion_is_asked_once_a_step() {
    let mut model = tractor(f64::INFINITY, 6.0);
    let asked = Arc::new(AtomicUsize::new(0));
    model.driveline = Box::new(Counting { asked: Arc::clone(&asked), limit_n: f64::INFINITY });
    let outcome = walked(&model, 0.0, 1.0, 0.0, ramp());
    assert_eq!((outcome.steps, asked.load(Ordering::Relaxed)), (10, 4 + 9 + 1));
    assert_eq!(outcome.trace.len(), 1 + 9 + 1);
    assert_eq!(last(&outcome, "speed_m_s"), 20.0);
    assert!((last(&outcome, "position_m") - 100.0).abs() < 1e-9);
}

#[test]
fn rows_are_as_far_apart_as_is_asked() {
    let far = walked(&tractor(f64::INFINITY, 6.0), 0.0, 0.1, 2.0, ramp());
    let rows = far.trace.time_s();
    let apart = |pair: &[f64]| pair[1] - pair[0] > 1.9 || pair[1] == 10.0;
    assert!(rows.windows(2).all(apart) && rows.first() == Some(&0.0), "{rows:?}");
    let every = walked(&tractor(f64::INFINITY, 6.0), 0.0, 0.1, 0.0, ramp());
    assert_eq!((far.ledger.source_j, far.steps), (every.ledger.source_j, every.steps));
}
