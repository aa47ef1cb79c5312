//! What effects may do to the balances, one by one and together.

use crate::{
    Cycle, Drive, Inputs, Model, Named, Outcome, Phase, Replay, Resistance, Start, Until, Vehicle, replay,
    simulate,
};
use headland_plugin::{
    Action, Air, Contact, Delivery, Demand, Driveline, Effect, MAX_LOSSES, Place, Readings, Situation, Soil,
    Terrain,
};
use headland_trace::{Origin, Trace};

const MASS_KG: f64 = 1000.0;

/// What a test wants, whatever happens; it may limit the force as well.
#[derive(Debug)]
struct Does {
    action: Action,
    most_n: f64,
}

impl Effect for Does {
    fn act(&self, _: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        self.action
    }

    fn limits_n(&self, _: &Situation, _: &[f64]) -> (f64, f64) {
        (-500.0, self.most_n)
    }
}

/// Resists in proportion to the weight that it is told of.
#[derive(Debug)]
struct Weighs;

impl Effect for Weighs {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action { resistance_n: at.mass_kg + at.drag_area_m2, ..Action::default() }
    }
}

/// Takes a share of the force of the drive in proportion to it.
#[derive(Debug)]
struct Chafes {
    per_n: f64,
}

impl Effect for Chafes {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action { loss_share: self.per_n * at.tractive_force_n.abs(), ..Action::default() }
    }

    fn follows_drive(&self) -> bool {
        true
    }
}

/// The overrun brake of a trailer: so many kilograms of what it slows down by beyond a threshold.
#[derive(Debug)]
struct Overruns {
    mass_kg: f64,
    beyond_m_s2: f64,
}

impl Effect for Overruns {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let slowing_m_s2 = (-at.acceleration_m_s2 - self.beyond_m_s2).max(0.0);
        Action { resistance_n: self.mass_kg * slowing_m_s2, ..Action::default() }
    }

    fn follows_acceleration(&self) -> bool {
        true
    }

    fn moved_by_acceleration(&self) -> bool {
        true
    }
}

#[derive(Debug)]
struct Level;

impl Terrain for Level {
    fn at(&self, _: f64) -> Place {
        Place::default()
    }
}

/// A turn to the right on ground that falls to the right.
#[derive(Debug)]
struct Aslant;

impl Terrain for Aslant {
    fn at(&self, _: f64) -> Place {
        Place { sin_roll: 0.1, curvature_per_m: 0.02, ..Place::default() }
    }
}

/// Pushes by what it is told of lean, turn and shaking.
#[derive(Debug)]
struct Feels;

impl Effect for Feels {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let force_n = 1e3 * at.place.sin_roll + 1e5 * at.place.curvature_per_m;
        Action { force_n: force_n + at.shaking_m2_s4.unwrap_or(0.0), ..Action::default() }
    }
}

#[derive(Debug)]
struct Resists(f64);

impl Soil for Resists {
    fn resistance_n(&self, _: &Contact) -> f64 {
        self.0
    }
}

/// Gives what is asked, without loss.
#[derive(Debug)]
struct Ideal;

impl Driveline for Ideal {
    fn losses(&self) -> &'static [&'static str] {
        &[]
    }

    fn source(&self) -> &'static str {
        "store"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        0.0
    }

    fn deliver(&self, demand: &Demand, _: &[f64], _: &mut [f64]) -> Delivery {
        let force_n = if demand.coasting { 0.0 } else { demand.force_n };
        let source_power_w = force_n * demand.speed_m_s + demand.auxiliary_power_w + demand.shaft_power_w;
        let readings = Readings { motor_torque_n_m: force_n, ..Readings::NONE };
        Delivery { force_n, source_power_w, losses_w: [0.0; MAX_LOSSES], readings }
    }

    fn force_of_torque_n(&self, torque_n_m: f64, _: f64) -> Option<f64> {
        Some(torque_n_m)
    }
}

fn model(effects: Vec<Box<dyn Effect>>) -> Model {
    Model {
        vehicle: Vehicle {
            mass_kg: MASS_KG,
            rotating_mass_kg: 0.0,
            resistance: Resistance::Drag { area_m2: 0.0 },
            brake_friction: f64::INFINITY,
        },
        gravity_m_s2: 9.81,
        air: Air { density_kg_m3: 1.2, ..Air::default() },
        terrain: Box::new(Level),
        axles: None,
        soil: Some(Box::new(Resists(200.0))),
        driveline: Box::new(Ideal),
        tasks: Vec::new(),
        effects: effects
            .into_iter()
            .enumerate()
            .map(|(index, plugin)| Named { name: format!("effect_{index}"), plugin })
            .collect(),
    }
}

fn does(action: Action) -> Box<dyn Effect> {
    Box::new(Does { action, most_n: f64::INFINITY })
}

fn drive(model: &Model, start_m_s: f64, phases: Vec<Phase>) -> Outcome {
    let start = Start { position_m: 0.0, speed_m_s: start_m_s };
    let cycle = Cycle { start, phases, driver_gain_per_s: 1.0, step_s: 0.01, longest_s: 1000.0 };
    simulate(model, &cycle).unwrap()
}

/// A replay of the recorded force.
fn by_force() -> Replay {
    Replay {
        drive: Drive::Force,
        also: Vec::new(),
        window_s: None,
        smoothing_s: 0.05,
        step_s: 0.01,
        reversed_from_m: None,
        passes_before: 0,
        follows_brakes: false,
    }
}

fn hold(model: &Model) -> Outcome {
    drive(model, 10.0, vec![Phase::Hold { for_s: 2.0 }])
}

fn last(outcome: &Outcome, channel: &str) -> f64 {
    *outcome.trace.get(channel).unwrap().last().unwrap()
}

/// 200 N at the ground with a tenth lost: the wheels make 200 / 0.9 = 222.2 N, and 22.2 N are the effect's.
#[test]
fn a_share_that_is_lost_is_asked_for_and_booked() {
    let outcome = hold(&model(vec![does(Action { loss_share: 0.1, ..Action::default() })]));
    assert!((last(&outcome, "tractive_force_n") - 200.0 / 0.9).abs() < 1e-9);
    assert!((last(&outcome, "effect_0_n") + 20.0 / 0.9).abs() < 1e-9);
    assert!((last(&outcome, "speed_m_s") - 10.0).abs() < 1e-12);
}

/// 200 N at the ground with k F² lost, k = 1/2000 N: F = (1 − √(1 − 4 · 200 k)) / 2k = 225.4 N, and 25.4 N are the effect's. A
/// recorded force of as much holds the speed.
#[test]
fn a_share_that_hangs_on_the_force_is_asked_for_until_both_agree() {
    let chafing = || model(vec![Box::new(Chafes { per_n: 5e-4 })]);
    let outcome = hold(&chafing());
    let expected_n = (1.0 - (1.0f64 - 0.4).sqrt()) / 1e-3;
    assert!((last(&outcome, "tractive_force_n") - expected_n).abs() < 1e-6);
    assert!((last(&outcome, "effect_0_n") + expected_n - 200.0).abs() < 1e-6);
    assert!(outcome.ledger.relative_residual() < 1e-9, "{:?}", outcome.ledger);
    let how = by_force();
    let replayed = replay(&chafing(), &outcome.trace, &how).unwrap();
    assert!((last(&replayed, "speed_m_s") - 10.0).abs() < 1e-6);
}

/// Coasting, m a = −200 N − M (−a − c): a = −(200 N − M c)/(m − M) = −0.267 m/s² with M = 400 kg and c = 0.1 m/s². Slowed down at
/// 0.5 m/s² the drive has to hold back 500 N less 200 N of the ground and 160 N of the brake.
#[test]
fn a_force_that_hangs_on_the_acceleration_is_the_one_that_makes_it() {
    let overrun = || model(vec![Box::new(Overruns { mass_kg: 400.0, beyond_m_s2: 0.1 })]);
    let coasted = drive(&overrun(), 10.0, vec![Phase::Coast { until: Until::SpeedBelow(5.0) }]);
    let slowing_m_s2 = (200.0 - 400.0 * 0.1) / 600.0;
    assert!((last(&coasted, "acceleration_m_s2") + slowing_m_s2).abs() < 1e-9);
    assert!((last(&coasted, "effect_0_n") + 400.0 * (slowing_m_s2 - 0.1)).abs() < 1e-5);
    assert!(coasted.ledger.relative_residual() < 1e-9, "{:?}", coasted.ledger);
    let slowed = drive(&overrun(), 10.0, vec![Phase::Reach { speed_m_s: 5.0, acceleration_m_s2: 0.5 }]);
    let middle = slowed.trace.len() / 2;
    let at_middle = |channel: &str| slowed.trace.get(channel).unwrap()[middle];
    assert!((at_middle("acceleration_m_s2") + 0.5).abs() < 1e-9);
    assert!((at_middle("tractive_force_n") + 140.0).abs() < 1e-6, "{}", at_middle("tractive_force_n"));
    assert!(slowed.ledger.relative_residual() < 1e-9, "{:?}", slowed.ledger);
    // Driven by that force it slows down so again.
    let replayed = replay(&overrun(), &slowed.trace, &by_force()).unwrap();
    assert!((last(&replayed, "speed_m_s") - last(&slowed, "speed_m_s")).abs() < 1e-3);
}

/// A slip of 200 · 0.0005 = 0.1: the wheels roll at 10 / 0.9 m/s, and 200 · 1.111 = 222.2 W are the effect's.
#[test]
fn slipping_wheels_turn_faster_and_take_power() {
    let outcome = hold(&model(vec![does(Action { slip_per_n: 5e-4, ..Action::default() })]));
    assert!((last(&outcome, "wheel_speed_m_s") - 10.0 / 0.9).abs() < 1e-9);
    assert!((last(&outcome, "effect_0_w") - 2000.0 / 9.0).abs() < 1e-6);
    assert!(outcome.ledger.relative_residual() < 1e-9, "{:?}", outcome.ledger);
}

/// Half of the same slip grows with the pull, 200 · (0.00025 + 200 · 1.25·10⁻⁶), or is there whatever it is, 200 · 0.00025 + 0.05: each
/// of two effects takes half of the 222.2 W.
#[test]
fn slips_of_several_kinds_share_their_power() {
    let bent = Action { slip_per_n2: 1.25e-6, ..Action::default() };
    let even = Action { slip: 0.05, ..Action::default() };
    for other in [bent, even] {
        let straight = does(Action { slip_per_n: 2.5e-4, ..Action::default() });
        let outcome = hold(&model(vec![straight, does(other)]));
        assert!((last(&outcome, "wheel_speed_m_s") - 10.0 / 0.9).abs() < 1e-9);
        for effect in ["effect_0_w", "effect_1_w"] {
            assert!((last(&outcome, effect) - 1000.0 / 9.0).abs() < 1e-6, "{effect}");
        }
        assert!(outcome.ledger.relative_residual() < 1e-9, "{:?}", outcome.ledger);
    }
}

/// Slips by a part for each newton of the drive, as it learns of that.
#[derive(Debug)]
struct Creeps {
    per_n: f64,
}

impl Effect for Creeps {
    fn follows_drive(&self) -> bool {
        true
    }

    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action { slip: self.per_n * at.tractive_force_n, ..Action::default() }
    }
}

/// 200 N by 0.0005 of each, told once as a slope and once as a slip that asks for the force: the same wheels and the same power.
#[test]
fn a_slip_that_asks_for_the_force_is_the_one_that_goes_with_it() {
    let told = hold(&model(vec![does(Action { slip_per_n: 5e-4, ..Action::default() })]));
    let asked = hold(&model(vec![Box::new(Creeps { per_n: 5e-4 })]));
    for channel in ["wheel_speed_m_s", "effect_0_w", "tractive_force_n"] {
        assert!((last(&told, channel) - last(&asked, channel)).abs() < 1e-9, "{channel}");
    }
}

/// Gives nothing, as a driveline that nobody described.
#[derive(Debug)]
struct Idle;

impl Driveline for Idle {
    fn losses(&self) -> &'static [&'static str] {
        &[]
    }

    fn source(&self) -> &'static str {
        "none"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        0.0
    }

    fn deliver(&self, _: &Demand, _: &[f64], _: &mut [f64]) -> Delivery {
        Delivery::NOTHING
    }
}

/// The same slip: what moved the vehicle was 200 N, whoever gave them.
#[test]
fn wheels_of_a_recorded_motion_slip_by_the_force_that_it_took() {
    let mut recorded = headland_trace::Trace::new((0..20).map(f64::from).collect()).unwrap();
    recorded.push("speed_m_s", vec![10.0; 20], headland_trace::Origin::Measured).unwrap();
    let slips = does(Action { slip_per_n: 5e-4, ..Action::default() });
    let model = Model { driveline: Box::new(Idle), ..model(vec![slips]) };
    let how = Replay {
        drive: Drive::Speed,
        also: Vec::new(),
        window_s: None,
        smoothing_s: 2.0,
        step_s: 0.5,
        reversed_from_m: None,
        passes_before: 0,
        follows_brakes: false,
    };
    let trace = replay(&model, &recorded, &how).unwrap().trace;
    assert!((trace.get("wheel_speed_m_s").unwrap()[10] - 10.0 / 0.9).abs() < 1e-9);
}

#[test]
fn effects_learn_of_mass_and_area_that_others_add_in_whatever_order() {
    let adds = || does(Action { mass_kg: 50.0, drag_area_m2: 3.0, ..Action::default() });
    for effects in [vec![adds(), Box::new(Weighs) as Box<dyn Effect>], vec![Box::new(Weighs), adds()]] {
        let outcome = hold(&model(effects));
        assert!((last(&outcome, "tractive_force_n") - 1253.0).abs() < 1e-9);
    }
}

#[test]
fn resistances_that_are_taken_away_never_drive() {
    let outcome = drive(
        &model(vec![does(Action { resistance_n: -300.0, ..Action::default() })]),
        3.0,
        vec![Phase::Coast { until: Until::Elapsed(5.0) }],
    );
    assert!((last(&outcome, "speed_m_s") - 3.0).abs() < 1e-12);
    assert!(outcome.ledger.relative_residual() < 1e-9, "{:?}", outcome.ledger);
    let resting = drive(
        &model(vec![does(Action { resistance_n: -300.0, ..Action::default() })]),
        0.0,
        vec![Phase::Coast { until: Until::Elapsed(1.0) }],
    );
    assert_eq!(last(&resting, "speed_m_s"), 0.0);
}

/// 200 N of the ground less 300 N: driven by 200 N the vehicle gains 0.2 m/s², as on ground that resists nothing; followed from sample to
/// sample the forces are 200 N − (200 − 300) N, so that what an effect takes is told whatever it leaves.
#[test]
fn from_sample_to_sample_an_effect_takes_all_that_it_takes() {
    let pushed = model(vec![does(Action { resistance_n: -300.0, ..Action::default() })]);
    let held = hold(&model(vec![]));
    for (window_s, expected_m_s2) in [(None, 0.2), (Some(0.0), 0.3)] {
        let replayed = replay(&pushed, &held.trace, &Replay { window_s, ..by_force() }).unwrap();
        let found = replayed.trace.get("acceleration_m_s2").unwrap()[5];
        assert!((found - expected_m_s2).abs() < 1e-9, "{window_s:?}: {found}");
    }
}

/// Asked for 1200 N and limited to 700 N: (700 − 200) / 1000 = 0.5 m/s².
#[test]
fn a_limit_holds_what_the_driver_asks_and_not_what_was_recorded() {
    let limited = model(vec![Box::new(Does { action: Action::default(), most_n: 700.0 })]);
    let outcome = drive(&limited, 1.0, vec![Phase::Reach { speed_m_s: 2.0, acceleration_m_s2: 1.0 }]);
    assert!((outcome.trace.duration_s() - 2.0).abs() < 1e-9);
    let unlimited = drive(&model(vec![]), 1.0, vec![Phase::Reach { speed_m_s: 2.0, acceleration_m_s2: 1.0 }]);
    let how = by_force();
    let replayed = replay(&limited, &unlimited.trace, &how).unwrap();
    assert!((last(&replayed, "speed_m_s") - 2.0).abs() < 1e-3);
}

/// The drive brakes with 500 N at most, less a tenth; brakes take what is missing from 1000 N.
#[test]
fn brakes_take_over_where_an_effect_limits_the_drive() {
    let action = Action { loss_share: 0.1, ..Action::default() };
    let limited = model(vec![Box::new(Does { action, most_n: f64::INFINITY })]);
    let outcome = drive(&limited, 4.0, vec![Phase::Reach { speed_m_s: 2.0, acceleration_m_s2: 1.0 }]);
    let brakes = outcome.trace.get("brake_force_n").unwrap()[10];
    assert!((brakes - (1000.0 - 200.0 - 550.0)).abs() < 1e-9, "{brakes}");
    assert!((outcome.trace.duration_s() - 2.0).abs() < 1e-9);
    assert!(outcome.ledger.relative_residual() < 1e-9, "{:?}", outcome.ledger);
}

#[test]
fn the_constant_part_of_a_road_load_goes_with_the_mass() {
    let mut loaded = model(vec![does(Action { mass_kg: 500.0, ..Action::default() })]);
    loaded.soil = None;
    loaded.vehicle.resistance =
        Resistance::RoadLoad { f0_n: 100.0, f1_n_s_m: 2.0, f2_n_s2_m2: 0.5, air_density_kg_m3: 1.2 };
    let outcome = hold(&loaded);
    assert!((last(&outcome, "tractive_force_n") - (150.0 + 20.0 + 50.0)).abs() < 1e-9);
}

/// 1200 N at 5·10⁻⁵ / N slip by 0.06: the wheels roll at v / 0.94, whatever the driveline could have given.
#[test]
fn wheels_slip_by_a_recorded_force_that_no_driveline_gives() {
    let recorded = drive(&model(vec![]), 1.0, vec![Phase::Reach { speed_m_s: 2.0, acceleration_m_s2: 1.0 }]);
    let mut slips = model(vec![does(Action { slip_per_n: 5e-5, ..Action::default() })]);
    slips.driveline = Box::new(Idle);
    let how = by_force();
    let replayed = replay(&slips, &recorded.trace, &how).unwrap();
    let of = |channel: &str| replayed.trace.get(channel).unwrap()[50];
    assert!((of("wheel_speed_m_s") - of("speed_m_s") / 0.94).abs() < 1e-9, "{}", of("wheel_speed_m_s"));
}

/// Driven from its end a curve to the right is one to the left, and its lower side is on the left; a log knows both itself.
#[test]
fn a_path_leans_and_turns_the_other_way_from_its_end_and_as_the_log_says() {
    let mut feels = model(vec![Box::new(Feels)]);
    feels.terrain = Box::new(Aslant);
    let time_s: Vec<f64> = (0..41).map(|row| 0.05 * f64::from(row)).collect();
    let mut log = Trace::new(time_s).unwrap();
    log.push("speed_m_s", vec![10.0; 41], Origin::Measured).unwrap();
    log.push("roll_rad", vec![0.3; 41], Origin::Measured).unwrap();
    // Of ±2 m/s² about gravity all 41 are within a second of the middle; their mean is 2/41 off.
    let shaken = (0..41).map(|row| 9.81 + if row % 2 == 0 { 2.0 } else { -2.0 }).collect();
    log.push("vertical_acceleration_m_s2", shaken, Origin::Measured).unwrap();
    let felt_n = |reversed_from_m: Option<f64>, also: Vec<Inputs>| {
        let how = Replay {
            drive: Drive::Speed,
            also,
            window_s: None,
            smoothing_s: 0.1,
            step_s: 0.01,
            reversed_from_m,
            passes_before: 0,
            follows_brakes: false,
        };
        replay(&feels, &log, &how).unwrap().trace.get("effect_0_n").unwrap()[20]
    };
    assert!((felt_n(None, Vec::new()) - 2100.0).abs() < 1e-9);
    assert!((felt_n(Some(90.0), Vec::new()) + 2100.0).abs() < 1e-9);
    let told_n = felt_n(None, vec![Inputs::Roll, Inputs::VerticalAcceleration]);
    let expected_n = 1e3 * 0.3f64.sin() + 2000.0 + 4.0 * (1.0 - 1.0 / 1681.0);
    assert!((told_n - expected_n).abs() < 1e-9, "{told_n}");
}
