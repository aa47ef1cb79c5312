//! Phases: what ends them, what goes on in them, and how a cycle that cannot be driven is told.

use crate::physics_tests::{drive, last, tractor};
use crate::{End, EngineSpeed, Guard, Model, Named, Outcome, Phase, Pi, Setting, Until, speed_not_kept};
use headland_plugin::{Delivery, Demand, Driveline, Load, Mode, Place, Situation, State, Task, Terrain};

/// A tank that takes and gives 80 kg/s, pulls 500 N where it works, and holds a tonne.
#[derive(Debug)]
struct Tank;

impl Task for Tank {
    fn states(&self) -> Vec<State> {
        vec![State { name: "payload_kg", initial: 100.0 }]
    }

    fn load(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        self.load_in(Mode::Work, at, states, rates)
    }

    fn load_in(&self, mode: Mode, _: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        rates[0] = match mode {
            Mode::Fill | Mode::Work => 80.0,
            Mode::Empty => -80.0,
            Mode::Idle | Mode::Rest => 0.0,
        };
        let drawbar_force_n = if mode == Mode::Work { 500.0 } else { 0.0 };
        Load { drawbar_force_n, mass_kg: states[0], towed_mass_kg: 2.0 * states[0], ..Load::default() }
    }

    fn trouble(&self, _: Mode, _: &Situation, states: &[f64]) -> Option<String> {
        (states[0] > 1000.0).then(|| "the tank runs over".to_owned())
    }
}

/// Marks every 40 m on a gentle slope, and an end.
#[derive(Debug)]
struct Posts;

impl Terrain for Posts {
    fn at(&self, position_m: f64) -> Place {
        Place { sin_slope: 0.01, elevation_m: 0.01 * position_m, ..Place::default() }
    }

    fn extent_m(&self) -> Option<(f64, f64)> {
        Some((0.0, 200.0))
    }

    fn next_mark_m(&self, name: &str, position_m: f64) -> Option<f64> {
        let next = 40.0 * (position_m / 40.0).floor() + 40.0;
        (name == "post" && next < 200.0).then_some(next)
    }
}

fn with_tank() -> Model {
    let mut model = tractor(f64::INFINITY, 6.0);
    model.tasks = vec![Named { name: "tank".to_owned(), plugin: Box::new(Tank) }];
    model.terrain = Box::new(Posts);
    model
}

fn at_work(mode: Mode, phase: Phase) -> Phase {
    let tasks = Some(vec![("tank".to_owned(), mode)]);
    Phase::With { setting: Setting { tasks, ..Setting::default() }, phase: Box::new(phase) }
}

fn drive_until(until: Until) -> Phase {
    Phase::Drive { speed_m_s: 3.0, acceleration_m_s2: 0.5, tolerance_m_s: None, until }
}

fn reason(outcome: &Outcome) -> (f64, f64, &str) {
    match &outcome.end {
        End::Stopped { time_s, position_m, reason } => (*time_s, *position_m, reason),
        _ => panic!("it was driven to its end: {:?}", outcome.phases),
    }
}

#[test]
fn ends_by_place_by_mark_and_by_payload_are_met_within_the_step() {
    for (until, expected) in [
        (Until::Position(33.3), 33.3),
        (Until::Mark("post".to_owned()), 40.0),
        (Until::Travelled(12.5), 12.5),
        (Until::PathEnd, 200.0),
    ] {
        let outcome = drive(&with_tank(), 0.0, 0.1, vec![at_work(Mode::Rest, drive_until(until))]);
        assert_eq!(outcome.end, End::Finished);
        assert!((last(&outcome, "position_m") / expected - 1.0).abs() < 1e-12, "{expected}");
    }
    let until = Until::StateAbove { state: "tank_payload_kg".to_owned(), value: 333.3 };
    let outcome = drive(&with_tank(), 0.0, 0.1, vec![at_work(Mode::Work, drive_until(until))]);
    // (333.3 − 100) kg / 80 kg/s.
    assert!((outcome.phases[0].to_s / 2.916_25 - 1.0).abs() < 1e-12);
    assert!((last(&outcome, "tank_payload_kg") / 333.3 - 1.0).abs() < 1e-12);
}

/// A drive for forward and backward.
#[derive(Debug)]
struct BothWays;

impl Driveline for BothWays {
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
        let drives = !demand.coasting && demand.force_n * demand.speed_m_s >= 0.0;
        let force_n = if drives { demand.force_n } else { 0.0 };
        Delivery { force_n, source_power_w: force_n * demand.speed_m_s, ..Delivery::NOTHING }
    }
}

fn both_ways() -> Model {
    Model { driveline: Box::new(BothWays), ..with_tank() }
}

fn back_until(until: Until) -> Phase {
    Phase::Drive { speed_m_s: -2.0, acceleration_m_s2: 0.5, tolerance_m_s: None, until }
}

fn halt() -> Phase {
    Phase::Drive { speed_m_s: 0.0, acceleration_m_s2: 0.5, tolerance_m_s: None, until: Until::Stopped }
}

/// A speed below 0 is backward: places lie behind, speeds are risen to and fallen to by their size.
#[test]
fn backward_places_lie_behind_and_a_rest_is_a_rest() {
    for (until, expected) in [
        (Until::Position(25.0), 25.0),
        (Until::Travelled(12.5), 33.5),
        (Until::PathEnd, 0.0),
        // 1² / (2 · 0.5) m from rest to 1 m/s.
        (Until::SpeedAbove(1.0), 45.0),
    ] {
        // 42 m and 2² / (2 · 0.5) m to stop.
        let forward = vec![
            Phase::Drive {
                speed_m_s: 2.0,
                acceleration_m_s2: 0.5,
                tolerance_m_s: None,
                until: Until::Position(42.0),
            },
            halt(),
        ];
        let phases = forward.into_iter().chain([back_until(until)]).map(|phase| at_work(Mode::Rest, phase));
        let outcome = drive(&both_ways(), 0.0, 0.1, phases.collect());
        assert_eq!(outcome.end, End::Finished, "{expected}");
        assert!((last(&outcome, "position_m") - expected).abs() < 1e-6, "{expected}: {:?}", outcome.phases);
        assert!(outcome.ledger.relative_residual() < 1e-6, "{:?}", outcome.ledger);
    }
    let coasting = Phase::Coast { until: Until::Stopped };
    let outcome = drive(&tractor(f64::INFINITY, 6.0), -3.0, 0.1, vec![coasting]);
    assert!(outcome.trace.duration_s() > 1.0 && last(&outcome, "speed_m_s") == 0.0, "{:?}", outcome.phases);
}

#[test]
fn a_vehicle_stops_before_it_goes_backward_and_knows_no_marks_there() {
    let refused = |speed_m_s: f64, phases: Vec<Phase>| {
        let phases = phases.into_iter().map(|phase| at_work(Mode::Rest, phase)).collect();
        reason(&drive(&both_ways(), speed_m_s, 0.1, phases)).2.to_owned()
    };
    let told = refused(2.0, vec![back_until(Until::Travelled(5.0))]);
    assert!(told.contains("still rolls forward at 2.00 m/s"), "{told}");
    let told = refused(0.0, vec![back_until(Until::Position(30.0))]);
    assert!(told.contains("30 m, which lies 30.0 m ahead of a vehicle that drives backward"), "{told}");
    let told = refused(0.0, vec![back_until(Until::Mark("post".to_owned()))]);
    assert!(told.contains("marks are looked for ahead"), "{told}");
}

#[test]
fn of_several_ends_the_first_one_counts_and_is_told() {
    let until = Until::Any(vec![
        Until::PathEnd,
        Until::Elapsed(60.0),
        Until::SpeedAbove(2.0),
        Until::StateAbove { state: "tank_payload_kg".to_owned(), value: 900.0 },
    ]);
    let outcome = drive(&with_tank(), 0.0, 0.1, vec![at_work(Mode::Work, drive_until(until))]);
    assert_eq!(outcome.phases[0].ended_by, "its speed has risen to 2.00 m/s");
    assert!((outcome.phases[0].to_s - 4.0).abs() < 1e-9, "{:?}", outcome.phases);
}

#[test]
fn an_end_that_lies_behind_stops_the_run_with_time_place_and_reason_and_the_trace_is_kept() {
    let phases = vec![
        drive_until(Until::Position(50.0)),
        drive_until(Until::Any(vec![Until::Elapsed(5.0), Until::Position(20.0)])),
    ];
    let mut model = with_tank();
    model.tasks.clear();
    let outcome = drive(&model, 0.0, 0.1, phases);
    let (time_s, position_m, why) = reason(&outcome);
    assert!((position_m - 50.0).abs() < 1e-9 && (time_s - outcome.phases[0].to_s).abs() < 1e-12);
    assert_eq!(why, "the phase is to end at 20 m, which lies 30.0 m behind the vehicle");
    assert!(outcome.trace.len() > 100);
    let late = drive(&model, 3.0, 0.1, vec![Phase::Hold { for_s: 8.0 }, drive_until(Until::Time(6.0))]);
    assert_eq!(reason(&late).2, "the phase is to end at 6 s, which is 2.000 s ago");
    let lost = drive(&model, 3.0, 0.1, vec![drive_until(Until::Mark("gate".to_owned()))]);
    assert!(reason(&lost).2.contains("no mark `gate`"));
    // Where something else can end the phase, a mark that does not come again is none.
    let last_post = Until::Any(vec![Until::Mark("gate".to_owned()), Until::PathEnd]);
    let outcome = drive(&model, 3.0, 0.1, vec![drive_until(last_post)]);
    assert_eq!(outcome.phases[0].ended_by, "at the end of the path");
}

#[test]
fn a_vehicle_without_enough_force_says_so_at_rest_and_where_it_falls_behind() {
    let mut steep = tractor(f64::INFINITY, 6.0);
    steep.gravity_m_s2 = 100.0;
    let outcome = drive(&steep, 0.0, 0.1, vec![drive_until(Until::Travelled(5.0))]);
    let (time_s, position_m, why) = reason(&outcome);
    assert!(position_m == 0.0 && time_s <= 0.1 && why.contains("60000 N"), "{why}");
    let phase = |tolerance_m_s| Phase::Drive {
        speed_m_s: 12.0,
        acceleration_m_s2: 5.0,
        tolerance_m_s,
        until: Until::Elapsed(20.0),
    };
    let slow = drive(&tractor(f64::INFINITY, 6.0), 3.0, 0.1, vec![phase(Some(0.5))]);
    assert!(reason(&slow).2.contains("falls behind"), "{:?}", slow.end);
    assert_eq!(drive(&tractor(f64::INFINITY, 6.0), 3.0, 0.1, vec![phase(None)]).end, End::Finished);
}

/// Held: 3 m/s for 10 s, 30 m. Followed: 0 to 6 m/s in 4 s, then 3 s at 6 m/s, 12 + 18 m. Uphill under ten times the weight no
/// force is left for either; a drive that something slows down may.
#[test]
fn a_speed_that_is_wanted_and_not_kept_is_told_by_the_way_that_is_missing() {
    let held = || vec![Phase::Hold { for_s: 10.0 }];
    let followed = || vec![Phase::Follow { profile: vec![(0.0, 0.0), (4.0, 6.0), (7.0, 6.0)] }];
    let strong = tractor(f64::INFINITY, 6.0);
    let mut weak = tractor(f64::INFINITY, 6.0);
    weak.gravity_m_s2 = 100.0;
    for (phases, start_m_s, wanted_m) in [(held as fn() -> Vec<Phase>, 3.0, 30.0), (followed, 0.0, 30.0)] {
        let kept = drive(&strong, start_m_s, 0.1, phases());
        assert!((kept.phases[0].wanted_m.unwrap() - wanted_m).abs() < 1e-9);
        assert_eq!((kept.phases[0].short_m(), speed_not_kept(&kept.phases)), (None, None));
        let outcome = drive(&weak, start_m_s, 0.1, phases());
        let driven = &outcome.phases[0];
        assert!((driven.way_m() + driven.short_m().unwrap() - wanted_m).abs() < 1e-9);
        assert!(speed_not_kept(&outcome.phases).unwrap().contains("30.0 m that its speeds ask for"));
    }
    let may = Phase::Drive {
        speed_m_s: 40.0,
        acceleration_m_s2: 5.0,
        tolerance_m_s: None,
        until: Until::Elapsed(20.0),
    };
    let slowed = drive(&strong, 3.0, 0.1, vec![may]);
    assert!(slowed.phases[0].short_m().is_some() && speed_not_kept(&slowed.phases).is_none());
}

#[test]
fn what_a_standing_vehicle_waits_for_has_to_be_able_to_come() {
    let stand = |until| vec![Phase::Stand { until }];
    let outcome = drive(&with_tank(), 0.0, 0.1, stand(Until::Travelled(1.0)));
    assert!(reason(&outcome).2.contains("comes to one that stands"));
    let rolling = drive(&with_tank(), 1.0, 0.1, stand(Until::Elapsed(1.0)));
    assert!(reason(&rolling).2.contains("rolls at 1.00 m/s"));
}

#[test]
fn tasks_do_in_a_phase_what_it_tells_them_and_a_task_in_trouble_ends_the_run() {
    let below = |value| Until::StateBelow { state: "tank_payload_kg".to_owned(), value };
    let above = |value| Until::StateAbove { state: "tank_payload_kg".to_owned(), value };
    let phases = vec![
        at_work(Mode::Fill, Phase::Stand { until: above(740.0) }),
        at_work(Mode::Rest, drive_until(Until::Travelled(30.0))),
        Phase::Reach { speed_m_s: 0.0, acceleration_m_s2: 1.0 },
        at_work(Mode::Empty, Phase::Stand { until: below(20.0) }),
    ];
    let outcome = drive(&with_tank(), 0.0, 0.1, phases);
    assert_eq!(outcome.end, End::Finished);
    // 640 kg at 80 kg/s.
    assert!((outcome.phases[0].to_s - 8.0).abs() < 1e-9);
    assert!((last(&outcome, "tank_payload_kg") - 20.0).abs() < 1e-9);
    let over =
        drive(&with_tank(), 0.0, 0.1, vec![at_work(Mode::Fill, Phase::Stand { until: above(2000.0) })]);
    let (time_s, _, why) = reason(&over);
    assert!(why == "tank: the tank runs over" && (time_s - 11.3).abs() < 0.1, "{time_s}: {why}");
    let unknown = Setting { tasks: Some(vec![("plough".to_owned(), Mode::Work)]), ..Setting::default() };
    let phase = Phase::With { setting: unknown, phase: Box::new(Phase::Hold { for_s: 1.0 }) };
    assert!(reason(&drive(&with_tank(), 0.0, 0.1, vec![phase])).2.contains("no task is named `plough`"));
}

#[test]
fn a_phase_is_passed_over_unless_what_it_waits_for_is_so() {
    let when = |value| Setting {
        guards: vec![Guard {
            group: 0,
            when: vec![Until::StateAbove { state: "tank_payload_kg".to_owned(), value }],
        }],
        tasks: Some(Vec::new()),
        ..Setting::default()
    };
    let phase = |value| Phase::With { setting: when(value), phase: Box::new(Phase::Hold { for_s: 4.0 }) };
    let one_of = |value| drive(&with_tank(), 2.0, 0.1, vec![phase(value)]).phases.remove(0);
    assert_eq!((one_of(99.0).to_s, one_of(101.0).to_s), (4.0, 0.0));
    assert!(one_of(101.0).ended_by.starts_with("passed over"));
}

/// What lets a group begin may be gone by its second phase.
#[test]
fn a_group_is_driven_whole_or_passed_over_whole() {
    let empty = |value| {
        let when = vec![Until::StateAbove { state: "tank_payload_kg".to_owned(), value }];
        let setting = Setting {
            guards: vec![Guard { group: 7, when }],
            tasks: Some(vec![("tank".to_owned(), Mode::Empty)]),
            ..Setting::default()
        };
        Phase::With { setting, phase: Box::new(Phase::Stand { until: Until::Elapsed(0.5) }) }
    };
    let outcome = drive(&with_tank(), 0.0, 0.1, vec![empty(90.0), empty(90.0)]);
    assert!((last(&outcome, "tank_payload_kg") - 20.0).abs() < 1e-9);
    let outcome = drive(&with_tank(), 0.0, 0.1, vec![empty(110.0), empty(90.0)]);
    assert_eq!(last(&outcome, "tank_payload_kg"), 100.0);
}

/// Filling while it rolls out, and emptying while it slows down further: the kinetic energy of what comes and goes is an
/// account of its own.
#[test]
fn the_ledger_closes_at_fourth_order_where_mass_changes_on_the_way() {
    let residual = |step_s: f64| {
        let coast = |for_s| Phase::Coast { until: Until::Elapsed(for_s) };
        let phases = vec![at_work(Mode::Work, coast(8.0)), at_work(Mode::Empty, coast(4.0))];
        let outcome = drive(&with_tank(), 12.0, step_s, phases);
        assert_eq!(outcome.end, End::Finished);
        let brought = outcome.ledger.sinks.iter().find(|entry| entry.name == "mass change").unwrap();
        assert!(brought.energy_j.abs() > 1000.0, "{brought:?}");
        outcome.ledger.relative_residual()
    };
    let (coarse, fine) = (residual(0.8), residual(0.4));
    assert!(fine < 1e-7 && (coarse / fine).log2() > 3.5, "{coarse} {fine}");
}

/// Under a steady acceleration speed is linear and its square a parabola, as the rule takes them: nothing is left over.
#[test]
fn the_ledger_is_exact_where_mass_and_speed_change_steadily() {
    let phases = vec![
        at_work(Mode::Work, Phase::Follow { profile: vec![(0.0, 1.0), (4.0, 6.0), (8.0, 2.0)] }),
        at_work(Mode::Empty, Phase::Follow { profile: vec![(0.0, 2.0), (6.0, 5.0)] }),
    ];
    assert!(drive(&with_tank(), 1.0, 0.4, phases).ledger.relative_residual() < 1e-12);
}

#[test]
fn a_driver_who_knows_no_resistance_ends_at_the_wanted_speed_and_sees_a_change_ahead() {
    let pi = Pi { gain_per_s: 0.8, integral_per_s2: 0.2, integral_limit_m_s2: 2.0, preview_s: 1.5 };
    let setting = Setting { driver: Some(pi), ..Setting::default() };
    let phase =
        |profile| Phase::With { setting: setting.clone(), phase: Box::new(Phase::Follow { profile }) };
    let profile = vec![(0.0, 3.0), (40.0, 3.0), (45.0, 5.0), (90.0, 5.0)];
    let outcome = drive(&tractor(f64::INFINITY, 6.0), 3.0, 0.05, vec![phase(profile)]);
    let (time, speed) = (outcome.trace.time_s(), outcome.trace.get("speed_m_s").unwrap());
    let at = |t: f64| speed[time.partition_point(|time| *time < t)];
    assert!((at(89.0) - 5.0).abs() < 1e-3, "{}", at(89.0));
    // The resistances come as a surprise: the speed drops before the integral has gathered them.
    assert!(at(1.0) < 2.8 && at(40.0) > 3.05, "{} {}", at(1.0), at(40.0));
    assert!(outcome.ledger.relative_residual() < 1e-6);
}

#[test]
fn an_engine_speed_over_time_and_a_speed_by_place_are_followed() {
    let profile = vec![(0.0, 2.0), (20.0, 2.0), (60.0, 4.0)];
    let phase =
        Phase::DriveByPlace { profile, acceleration_m_s2: 1.0, until: Until::Mark("post".to_owned()) };
    let engine_speed = EngineSpeed::Over(vec![(0.0, 100.0), (5.0, 200.0)]);
    let setting = Setting { engine_speed, tasks: Some(Vec::new()), ..Setting::default() };
    let outcome = drive(&with_tank(), 2.0, 0.05, vec![Phase::With { setting, phase: Box::new(phase) }]);
    assert_eq!(outcome.end, End::Finished);
    // Half of the way from 20 m to 60 m.
    assert!((last(&outcome, "speed_m_s") - 3.0).abs() < 1e-3, "{}", last(&outcome, "speed_m_s"));
}

/// A ramp once went on beyond its target where the rounding of time left its corner on the near side.
#[test]
fn a_ramp_ends_at_its_target_at_whatever_time_it_begins() {
    let mut model = with_tank();
    model.tasks.clear();
    let mut phases = vec![Phase::Reach { speed_m_s: 1.5, acceleration_m_s2: 1.0 }];
    for turn in 0_u8..60 {
        let speed_m_s = if turn % 2 == 0 { 0.7 } else { 1.6 };
        let until = Until::Elapsed(1.1 + 0.013 * f64::from(turn));
        phases.push(Phase::Drive { speed_m_s, acceleration_m_s2: 1.3, tolerance_m_s: None, until });
    }
    let outcome = drive(&model, 0.0, 0.05, phases);
    assert_eq!(outcome.end, End::Finished);
    let slowest = outcome.trace.get("speed_m_s").unwrap()[40..].iter().fold(f64::INFINITY, |a, b| a.min(*b));
    assert!(slowest > 0.69, "{slowest}");
}
