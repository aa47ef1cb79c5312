//! The simulation against closed forms, limits, conservation and observed order.

use crate::{
    Cycle, Drive, End, Model, Named, Outcome, Phase, Replay, Resistance, Simulation, Start, Until, Vehicle,
    replay, simulate,
};
use headland_plugin::{
    Action, Air, Contact, Delivery, Demand, Driveline, Effect, MAX_LOSSES, Place, Readings, Situation, Soil,
    State, Terrain,
};

const MASS_KG: f64 = 13_019.3;
const GRAVITY_M_S2: f64 = 9.81;
const COEFFICIENT: f64 = 0.069;

/// F = (c (1 + v / v_s) + d v) N, a soil with the laws that the tests need.
#[derive(Debug)]
struct TestSoil {
    coefficient: f64,
    speed_scale_m_s: f64,
    viscous_s_m: f64,
}

impl Soil for TestSoil {
    fn resistance_n(&self, contact: &Contact) -> f64 {
        let linear = self.coefficient * (1.0 + contact.speed_m_s / self.speed_scale_m_s);
        (linear + self.viscous_s_m * contact.speed_m_s) * contact.load_n
    }
}

#[derive(Debug)]
struct Incline {
    sin_slope: f64,
    extent_m: Option<(f64, f64)>,
}

impl Terrain for Incline {
    fn at(&self, position_m: f64) -> Place {
        let elevation_m = position_m * self.sin_slope;
        Place { elevation_m, sin_slope: self.sin_slope, ..Place::default() }
    }

    fn extent_m(&self) -> Option<(f64, f64)> {
        self.extent_m
    }
}

/// A store that gives up to a limit, and loses a tenth of what it gives.
#[derive(Debug)]
struct TestDrive {
    limit_n: f64,
}

impl Driveline for TestDrive {
    fn states(&self) -> Vec<State> {
        vec![State { name: "drawn_j", initial: 0.0 }]
    }

    fn losses(&self) -> &'static [&'static str] {
        &["gears"]
    }

    fn source(&self) -> &'static str {
        "store"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        100.0
    }

    fn deliver(&self, demand: &Demand, _: &[f64], rates: &mut [f64]) -> Delivery {
        let force_n = if demand.coasting { 0.0 } else { demand.force_n.clamp(0.0, self.limit_n) };
        let mut losses_w = [0.0; MAX_LOSSES];
        losses_w[0] = 0.1 * (force_n * demand.speed_m_s).abs();
        let source_power_w =
            force_n * demand.speed_m_s + losses_w[0] + demand.auxiliary_power_w + demand.shaft_power_w;
        rates[0] = source_power_w;
        Delivery { force_n, source_power_w, losses_w, readings: Readings::NONE }
    }
}

/// A drag that fades with time, to see that states of effects are integrated.
#[derive(Debug)]
struct Fading;

impl Effect for Fading {
    fn states(&self) -> Vec<State> {
        vec![State { name: "level", initial: 1.0 }]
    }

    fn act(&self, _: &Situation, states: &[f64], rates: &mut [f64]) -> Action {
        rates[0] = -0.5 * states[0];
        Action { resistance_n: 1000.0 * states[0], auxiliary_power_w: 50.0, ..Action::default() }
    }
}

pub(crate) fn tractor(speed_scale_m_s: f64, drag_area_m2: f64) -> Model {
    Model {
        vehicle: Vehicle {
            mass_kg: MASS_KG,
            rotating_mass_kg: -100.0,
            resistance: Resistance::Drag { area_m2: drag_area_m2 },
            brake_friction: f64::INFINITY,
        },
        gravity_m_s2: GRAVITY_M_S2,
        air: Air { density_kg_m3: 1.235, wind_speed_m_s: 0.0, wind_from_rad: 0.0, temperature_c: 12.0 },
        terrain: Box::new(Incline { sin_slope: 0.0, extent_m: None }),
        axles: None,
        soil: Some(Box::new(TestSoil { coefficient: COEFFICIENT, speed_scale_m_s, viscous_s_m: 0.0 })),
        // Its 100 kg of rotating mass are taken off the body again, so that the fixtures have none.
        driveline: Box::new(TestDrive { limit_n: 60e3 }),
        tasks: Vec::new(),
        effects: Vec::new(),
    }
}

pub(crate) fn drive(model: &Model, start_m_s: f64, step_s: f64, phases: Vec<Phase>) -> Outcome {
    let start = Start { position_m: 0.0, speed_m_s: start_m_s };
    let cycle = Cycle { start, phases, driver_gain_per_s: 1.0, step_s, longest_s: 1000.0 };
    simulate(model, &cycle).unwrap()
}

fn coast(model: &Model, start_m_s: f64, step_s: f64) -> Outcome {
    drive(model, start_m_s, step_s, vec![Phase::Coast { until: Until::Stopped }])
}

pub(crate) fn last(outcome: &Outcome, channel: &str) -> f64 {
    *outcome.trace.get(channel).unwrap().last().unwrap()
}

/// Time and distance of coast-downs that were computed independently, by explicit Euler with a step of 1 ms; given
/// with two decimals.
#[test]
fn coast_downs_meet_the_reference_fixtures() {
    let (km_h, mph) = (1.0 / 3.6, 0.447_04);
    let table = [
        (100.0 * km_h, [(30.0, 10.69, 42.42), (15.0, 5.72, 11.63)]),
        (100.0 * mph, [(30.0, 11.20, 45.13), (15.0, 5.87, 12.04)]),
        (100.0, [(30.0, 11.72, 47.96), (15.0, 6.02, 12.43)]),
        (f64::INFINITY, [(30.0, 12.19, 50.56), (15.0, 6.14, 12.78)]),
    ];
    for (scale, rows) in table {
        for (speed, time_s, distance_m) in rows {
            let outcome = coast(&tractor(scale, 6.0), speed * km_h, 0.01);
            assert_eq!(outcome.end, End::Finished);
            let (time, distance) = (outcome.trace.duration_s(), last(&outcome, "position_m"));
            assert!((time / time_s - 1.0).abs() < 1e-3, "{scale} {speed}: {time} s, expected {time_s}");
            assert!((distance / distance_m - 1.0).abs() < 1e-3, "{scale} {speed}: {distance} m");
        }
    }
}

/// A cross wind of 5.6 m/s with isotropic drag: 10.65 s and 42.24 m.
#[test]
fn a_cross_wind_shortens_the_coast_down_as_computed_elsewhere() {
    let mut model = tractor(100.0 / 3.6, 6.0);
    (model.air.wind_speed_m_s, model.air.wind_from_rad) = (5.6, std::f64::consts::FRAC_PI_2);
    let outcome = coast(&model, 30.0 / 3.6, 0.01);
    assert!((outcome.trace.duration_s() / 10.65 - 1.0).abs() < 1e-3);
    assert!((last(&outcome, "position_m") / 42.24 - 1.0).abs() < 1e-3);
}

/// Without air: t = (v_s / (c g)) ln(1 + v₀ / v_s).
#[test]
fn the_stop_is_located_within_its_step() {
    let (scale, start) = (100.0 / 3.6, 30.0 / 3.6);
    let expected = scale / (COEFFICIENT * GRAVITY_M_S2) * (1.0 + start / scale).ln();
    let time = coast(&tractor(scale, 0.0), start, 0.05).trace.duration_s();
    assert!((time / expected - 1.0).abs() < 1e-9, "{time} {expected}");
}

/// R = d v m g without any other force: v = v₀ exp(−d g t).
#[test]
fn speed_converges_at_fourth_order() {
    let error = |step_s: f64| {
        let mut model = tractor(1.0, 0.0);
        model.soil = Some(Box::new(TestSoil { coefficient: 0.0, speed_scale_m_s: 1.0, viscous_s_m: 0.1 }));
        let phases = vec![Phase::Coast { until: Until::Elapsed(2.0) }];
        let outcome = drive(&model, 8.0, step_s, phases);
        (last(&outcome, "speed_m_s") - 8.0 * (-0.1 * GRAVITY_M_S2 * 2.0f64).exp()).abs()
    };
    let order = (error(0.5) / error(0.25)).log2();
    assert!(order > 3.7 && order < 4.5, "observed order {order}");
}

/// Quadratic drag and Coulomb resistance: x = (m / 2k) ln(1 + k v₀² / R); the located stop must not spoil the order.
#[test]
fn the_stopping_distance_converges_at_least_at_second_order() {
    let start = 25.0;
    let k = 0.5 * 1.235 * 60.0;
    let resistance = COEFFICIENT * MASS_KG * GRAVITY_M_S2;
    let exact = MASS_KG / (2.0 * k) * (1.0 + k * start * start / resistance).ln();
    let error = |step_s: f64| {
        (last(&coast(&tractor(f64::INFINITY, 60.0), start, step_s), "position_m") - exact).abs()
    };
    let order = (error(1.6) / error(0.8)).log2();
    assert!(order > 2.0, "observed order {order}: {} {}", error(1.6), error(0.8));
}

#[test]
fn the_ledger_closes_over_a_drive_with_every_kind_of_account() {
    let mut model = tractor(100.0 / 3.6, 6.0);
    model.terrain = Box::new(Incline { sin_slope: 0.02, extent_m: None });
    model.air.wind_speed_m_s = 4.0;
    model.effects.push(Named { name: "fading".to_owned(), plugin: Box::new(Fading) });
    let outcome = drive(
        &model,
        0.0,
        0.01,
        vec![
            Phase::Reach { speed_m_s: 8.0, acceleration_m_s2: 0.7 },
            Phase::Hold { for_s: 3.0 },
            Phase::Follow { profile: vec![(0.0, 8.0), (4.0, 2.0), (6.5, 5.0)] },
            Phase::Reach { speed_m_s: 1.0, acceleration_m_s2: 3.0 },
            Phase::Coast { until: Until::Stopped },
        ],
    );
    assert_eq!(outcome.end, End::Finished);
    let ledger = &outcome.ledger;
    assert!(ledger.relative_residual() < 1e-6, "{ledger:?}");
    assert!(ledger.turnover_j() > 1e5);
    let account =
        |name: &str| ledger.sinks.iter().find(|entry| entry.name == name).map(|entry| entry.energy_j);
    let climbed = last(&outcome, "position_m") * 0.02 * MASS_KG * GRAVITY_M_S2;
    assert!((account("slope").unwrap() / climbed - 1.0).abs() < 1e-9);
    assert!(account("brakes").unwrap() > 0.0 && account("gears").unwrap() > 0.0);
    assert!(account("fading").unwrap() > 50.0 * outcome.trace.duration_s());
    // What a state of the driveline integrates is what the ledger booked.
    assert!((last(&outcome, "drawn_j") / ledger.source_j - 1.0).abs() < 1e-9);
}

#[test]
fn states_of_effects_follow_their_differential_equation() {
    let mut model = tractor(f64::INFINITY, 0.0);
    model.effects.push(Named { name: "fading".to_owned(), plugin: Box::new(Fading) });
    let outcome = drive(&model, 10.0, 0.01, vec![Phase::Coast { until: Until::Elapsed(4.0) }]);
    assert!((last(&outcome, "fading_level") - (-2.0f64).exp()).abs() < 1e-9);
}

#[test]
fn a_vehicle_rests_where_the_ground_holds_it_and_rolls_back_where_it_does_not() {
    let roll = |sin_slope: f64| {
        let mut model = tractor(f64::INFINITY, 0.0);
        model.terrain = Box::new(Incline { sin_slope, extent_m: None });
        let outcome = drive(&model, 2.0, 0.01, vec![Phase::Coast { until: Until::Elapsed(20.0) }]);
        (last(&outcome, "speed_m_s"), outcome.ledger.relative_residual())
    };
    let (held, _) = roll(0.06);
    assert_eq!(held, 0.0);
    let (back, residual) = roll(0.08);
    assert!(back < -0.1, "{back}");
    assert!(residual < 1e-6, "{residual}");
}

#[test]
fn a_drive_without_enough_force_says_when_where_and_why() {
    let mut model = tractor(100.0 / 3.6, 6.0);
    model.driveline = Box::new(TestDrive { limit_n: 9_500.0 });
    let outcome = drive(&model, 0.0, 0.05, vec![Phase::Reach { speed_m_s: 10.0, acceleration_m_s2: 0.5 }]);
    let End::Stopped { time_s, reason, .. } = &outcome.end else { panic!("it went on") };
    assert!(*time_s > 1.0 && reason.contains("10.00 m/s") && reason.contains("9500 N"), "{reason}");
    assert!(outcome.trace.len() > 10);
}

/// Runs went on for up to a step behind the end of their path, over ground that no terrain knows. 8 m/s in steps of 0.3 s pass
/// 50 m by 0.4 m. Backward it is the beginning of the path.
#[test]
fn a_path_ends_within_a_step() {
    let mut model = tractor(f64::INFINITY, 0.0);
    model.terrain = Box::new(Incline { sin_slope: 0.0, extent_m: Some((-20.0, 50.0)) });
    for (speed_m_s, end_m) in [(8.0, 50.0), (-8.0, -20.0)] {
        for quasi_static in [false, true] {
            let start = Start { position_m: 0.0, speed_m_s };
            let phases = vec![Phase::Hold { for_s: 20.0 }];
            let cycle = Cycle { start, phases, driver_gain_per_s: 1.0, step_s: 0.3, longest_s: 1000.0 };
            let simulation = Simulation::new(&model, &cycle);
            let simulation = if quasi_static { simulation.quasi_static(0.0) } else { simulation };
            let End::Stopped { position_m, reason, .. } = simulation.run().unwrap().end else {
                panic!("it went on")
            };
            assert!((position_m - end_m).abs() < 1e-5, "{position_m}");
            assert!(reason.contains("the path ends: it runs from -20 m to 50 m"), "{reason}");
        }
    }
}

#[test]
fn a_path_that_ends_and_a_phase_that_does_not_are_reported() {
    let mut model = tractor(f64::INFINITY, 0.0);
    model.terrain = Box::new(Incline { sin_slope: -0.2, extent_m: Some((0.0, 50.0)) });
    let End::Stopped { position_m, reason, .. } = coast(&model, 1.0, 0.01).end else { panic!("it went on") };
    assert!(position_m > 50.0 && reason.contains("50 m"));
    model.terrain = Box::new(Incline { sin_slope: -0.2, extent_m: None });
    assert!(matches!(coast(&model, 1.0, 0.5).end, End::Stopped { reason, .. } if reason.contains("1000 s")));
}

/// Something drives that nobody recorded, until the vehicle coasts: the model follows it so far, and coasts from there. What it
/// is told of the drive changes nothing of the coast, which another vehicle would not repeat.
#[test]
fn a_coast_that_follows_a_drive_starts_from_it() {
    let model = tractor(100.0 / 3.6, 6.0);
    let phases = vec![
        Phase::Reach { speed_m_s: 6.0, acceleration_m_s2: 0.4 },
        Phase::Hold { for_s: 5.0 },
        Phase::Coast { until: Until::SpeedBelow(1.0) },
    ];
    let mut original = drive(&model, 1.0, 0.02, phases).trace;
    let begins = 12.5 + 5.0;
    let coasting: Vec<f64> = original.time_s().iter().map(|time| f64::from(*time > begins + 0.1)).collect();
    let coasts: Vec<bool> = coasting.iter().map(|coasting| *coasting > 0.5).collect();
    original.remove("coasting");
    original.push("coasting", coasting, headland_trace::Origin::Measured).unwrap();
    let how = Replay {
        drive: Drive::Coast,
        also: vec![crate::Inputs::Coasting],
        window_s: None,
        smoothing_s: 0.05,
        step_s: 0.02,
        reversed_from_m: None,
        passes_before: 0,
        follows_brakes: false,
    };
    let apart = |model: &Model| {
        let modelled = replay(model, &original, &how).unwrap().trace;
        let speeds = modelled.get("speed_m_s").unwrap().iter().zip(original.get("speed_m_s").unwrap());
        let apart: Vec<f64> = speeds.map(|(one, other)| (one - other).abs()).collect();
        let worst = |wanted: bool| {
            let own = apart.iter().zip(&coasts).filter(|(_, coasts)| **coasts == wanted);
            own.map(|(apart, _)| *apart).fold(0.0, f64::max)
        };
        (worst(false), worst(true))
    };
    let (driven, coasted) = apart(&model);
    assert!(driven < 0.02 && coasted < 0.02, "{driven} {coasted}");
    // A drag area of 60 m² is driven along the same, and coasts otherwise.
    let (driven, coasted) = apart(&tractor(100.0 / 3.6, 60.0));
    assert!(driven < 0.02 && coasted > 0.1, "{driven} {coasted}");
}

/// What the model did, handed back to it as a recording, gives the same forces and the same motion again.
#[test]
fn a_replay_of_the_models_own_drive_repeats_it() {
    let model = tractor(100.0 / 3.6, 6.0);
    let phases = vec![
        Phase::Reach { speed_m_s: 6.0, acceleration_m_s2: 0.4 },
        Phase::Hold { for_s: 5.0 },
        Phase::Coast { until: Until::SpeedBelow(1.0) },
    ];
    let original = drive(&model, 1.0, 0.02, phases).trace;
    let how = |drive: Drive, window_s: Option<f64>| Replay {
        drive,
        also: Vec::new(),
        window_s,
        smoothing_s: 0.05,
        step_s: 0.02,
        reversed_from_m: None,
        passes_before: 0,
        follows_brakes: false,
    };
    let forward = replay(&model, &original, &how(Drive::Force, None)).unwrap();
    let worst = forward
        .trace
        .get("speed_m_s")
        .unwrap()
        .iter()
        .zip(original.get("speed_m_s").unwrap())
        .map(|(one, other)| (one - other).abs())
        .fold(0.0, f64::max);
    assert!(worst < 0.02, "{worst}");
    assert!(forward.ledger.relative_residual() < 1e-6, "{:?}", forward.ledger);

    let backward = replay(&model, &original, &how(Drive::Speed, None)).unwrap().trace;
    let (force, expected) =
        (backward.get("tractive_force_n").unwrap(), original.get("tractive_force_n").unwrap());
    let middle = original.time_s().iter().position(|time| *time > 15.0).unwrap();
    assert!((force[middle] / expected[middle] - 1.0).abs() < 1e-6);
    assert_eq!(backward.channel("speed_m_s").unwrap().origin, headland_trace::Origin::Driven);
}

/// A shuttle that swings to and fro, with the force that Newton asks for, is moved as it was.
#[test]
fn a_recording_that_goes_backward_is_replayed_backward() {
    const GREATEST_M_S: f64 = 3.0;
    const PERIOD_S: f64 = 40.0;
    const STEP_S: f64 = 0.02;
    const AREA_M2: f64 = 6.0;
    let model = tractor(f64::INFINITY, AREA_M2);
    let time_s: Vec<f64> = (0..=4000).map(|sample| f64::from(sample) * STEP_S).collect();
    let turn = std::f64::consts::TAU / PERIOD_S;
    let speed = |time_s: f64| GREATEST_M_S * (turn * time_s).sin();
    let force = |time_s: f64| {
        let v = speed(time_s);
        let resistance_n =
            MASS_KG * GRAVITY_M_S2 * COEFFICIENT + 0.5 * model.air.density_kg_m3 * AREA_M2 * v * v;
        MASS_KG * GREATEST_M_S * turn * (turn * time_s).cos() + resistance_n.copysign(v)
    };
    let all = |of: &dyn Fn(f64) -> f64| time_s.iter().map(|time_s| of(*time_s)).collect::<Vec<f64>>();
    let (speeds, forces) = (all(&speed), all(&force));
    let mut recorded = headland_trace::Trace::new(time_s.clone()).unwrap();
    recorded.push("speed_m_s", speeds.clone(), headland_trace::Origin::Measured).unwrap();
    recorded.push("tractive_force_n", forces, headland_trace::Origin::Measured).unwrap();
    let how = |window_s: Option<f64>| Replay {
        drive: Drive::Force,
        also: Vec::new(),
        window_s,
        smoothing_s: 0.05,
        step_s: STEP_S,
        reversed_from_m: None,
        passes_before: 0,
        follows_brakes: false,
    };
    for window_s in [None, Some(7.0)] {
        let moved = replay(&model, &recorded, &how(window_s)).unwrap().trace;
        let pairs = moved.get("speed_m_s").unwrap().iter().zip(&speeds);
        let worst = pairs.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
        assert!(worst < 0.05, "{window_s:?}: {worst} m/s");
    }
}
