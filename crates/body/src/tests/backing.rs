//! Driving backward: along a path, to and fro, and as the longitudinal fidelity does.

use super::{Circle, Tow, channel, chassis, cycle, hitched, last, model, run, soil, terrain};
use crate::chassis::{Chassis, Differential, SteeringMode};
use crate::simulate;
use headland_plugin::{Contact, Delivery, Demand, Driveline, Footing, Soil, WheelContact};
use headland_sim::{End, Model, Named, Outcome, Phase, Until};
use headland_soil::Constant;
use headland_task::Drawbar;
use headland_terrain::{ConstantGrade, Flat};

/// Gives what drives the vehicle on, forward and backward.
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

fn open(mode: SteeringMode) -> Chassis {
    let mut chassis = chassis();
    chassis.steering.mode = mode;
    chassis.centre = Differential::Open;
    for axle in &mut chassis.axles {
        axle.differential = Differential::Open;
    }
    chassis
}

fn driven(mut model: Model) -> Model {
    model.driveline = Box::new(BothWays);
    model
}

fn round() -> Model {
    driven(model(Box::new(Circle { radius_m: 15.0 }), soil::<Constant>("(coefficient: 0.03)")))
}

fn to(speed_m_s: f64, until: Until) -> Phase {
    Phase::Drive { speed_m_s, acceleration_m_s2: 0.5, tolerance_m_s: None, until }
}

/// Backward round a circle of 15 m, which turns to the right ahead and so to the left behind: steered to the right as ahead,
/// within a hand of the path, at the angle that the geometry says.
#[test]
fn it_follows_a_circle_backward() {
    for mode in [SteeringMode::Front, SteeringMode::All] {
        let cycle = cycle(-1.0, vec![Phase::Hold { for_s: 30.0 }], 2e-3);
        let outcome = simulate(&round(), &open(mode), &cycle, 0.1).unwrap();
        assert_eq!(outcome.end, End::Finished, "{mode:?}");
        assert!(
            (last(&outcome, "position_m") / -30.0 - 1.0).abs() < 0.02,
            "{mode:?} {}",
            last(&outcome, "position_m")
        );
        let furthest =
            channel(&outcome, "path_offset_m").iter().fold(0.0f64, |most, now| most.max(now.abs()));
        assert!(furthest < 0.6, "{mode:?} swings in by {furthest}");
        let offset = last(&outcome, "path_offset_m").abs();
        assert!(offset < 0.15, "{mode:?} goes on {offset} m beside it");
        // Going back it turns the other way.
        let radius = last(&outcome, "speed_m_s").hypot(last(&outcome, "side_speed_m_s"))
            / last(&outcome, "yaw_rate_rad_s");
        assert!((radius / -15.0 - 1.0).abs() < 0.02, "{mode:?}: {radius}");
    }
}

/// Forward, backward to where it began, and forward again: it stands where it stood, in its lane.
#[test]
fn a_shunt_ends_where_it_began_and_its_ledger_closes() {
    let phases = vec![
        to(1.5, Until::Travelled(12.0)),
        to(0.0, Until::Stopped),
        to(-1.5, Until::Position(0.0)),
        to(0.0, Until::Stopped),
        to(1.0, Until::Position(3.0)),
        to(0.0, Until::Stopped),
    ];
    let outcome = simulate(&round(), &open(SteeringMode::Front), &cycle(0.0, phases, 2e-3), 0.0).unwrap();
    assert_eq!(outcome.end, End::Finished, "{:?}", outcome.phases);
    // 1.5²/(2·0.5) m to stop.
    let turned = &outcome.phases[1];
    assert!((turned.to_m - 14.25).abs() < 0.1, "{turned:?}");
    assert!((outcome.phases[3].to_m + 2.25).abs() < 0.1, "{:?}", outcome.phases[3]);
    assert!((last(&outcome, "position_m") - 4.0).abs() < 0.1, "{}", last(&outcome, "position_m"));
    assert!(last(&outcome, "path_offset_m").abs() < 0.2, "{}", last(&outcome, "path_offset_m"));
    assert!(outcome.ledger.relative_residual() < 1e-3, "{:?}", outcome.ledger);
}

/// What resists acts against the motion, a slope with it: backward downhill and uphill, and against a pull, both fidelities say
/// the same.
#[test]
fn backward_both_fidelities_say_the_same() {
    for grade in [0.0, 0.05] {
        let ground = terrain::<ConstantGrade>(&format!("(grade: {grade})"));
        let mut model = driven(model(ground, soil::<Constant>("(coefficient: 0.05)")));
        let pull = Box::new(ron::from_str::<Drawbar>("(force_n: 8e3)").unwrap());
        model.tasks.push(Named { name: "Drawbar".to_owned(), plugin: pull });
        let cycle = cycle(0.0, vec![to(-2.0, Until::Travelled(15.0)), to(0.0, Until::Stopped)], 2e-3);
        let (one, three) = (headland_sim::simulate(&model, &cycle).unwrap(), run(&model, &cycle));
        assert_eq!((&one.end, &three.end), (&End::Finished, &End::Finished));
        let ratio = |of: &dyn Fn(&Outcome) -> f64| of(&three) / of(&one) - 1.0;
        let way = ratio(&|outcome| last(outcome, "position_m"));
        let time = ratio(&|outcome| outcome.trace.duration_s());
        assert!(
            last(&one, "position_m") < -15.0 && way.abs() < 3e-3 && time.abs() < 3e-3,
            "{grade}: {way} {time}"
        );
        let pulled = ratio(&|outcome| {
            outcome.ledger.sinks.iter().find(|sink| sink.name == "drawbar").unwrap().energy_j
        });
        assert!(pulled.abs() < 5e-3, "{pulled}");
        assert!(three.ledger.relative_residual() < 1e-3, "{:?}", three.ledger);
    }
}

/// Rolling back down a slope that it could not climb, a vehicle keeps to its path.
#[test]
fn a_vehicle_that_rolls_back_keeps_to_its_path() {
    let model = model(terrain::<ConstantGrade>("(grade: 0.1)"), soil::<Constant>("(coefficient: 0.03)"));
    let cycle = cycle(3.0, vec![Phase::Coast { until: Until::Elapsed(14.0) }], 2e-3);
    let outcome = run(&model, &cycle);
    assert_eq!(outcome.end, End::Finished);
    assert!(last(&outcome, "position_m") < -20.0, "{}", last(&outcome, "position_m"));
    assert!(last(&outcome, "path_offset_m").abs() < 1e-3, "{}", last(&outcome, "path_offset_m"));
}

/// A crab goes back aslant as it went ahead.
#[test]
fn a_crab_goes_backward_along_its_path() {
    let model = driven(model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.03)")));
    let phases =
        vec![to(1.5, Until::Travelled(6.0)), to(0.0, Until::Stopped), to(-1.5, Until::Travelled(30.0))];
    let mut stiff = open(SteeringMode::Crab { angle_rad: 0.3 });
    // Wheels that turn slowly leave the path at first.
    stiff.steering.rate_rad_s = 0.05;
    stiff.steering.limit_rad = 0.35;
    let outcome = simulate(&model, &stiff, &cycle(0.0, phases, 2e-3), 0.1).unwrap();
    assert_eq!(outcome.end, End::Finished);
    assert!(last(&outcome, "path_offset_m").abs() < 0.1, "{}", last(&outcome, "path_offset_m"));
    assert!((last(&outcome, "heading_rad") - 0.3).abs() < 0.03, "{}", last(&outcome, "heading_rad"));
}

/// A tractor with a trailer of 4.5 m, both in line on their path.
fn pushing(terrain: Box<dyn headland_plugin::Terrain>) -> Model {
    let mut model = driven(model(terrain, soil::<Constant>("(coefficient: 0.05)")));
    model.tasks.push(Named { name: "trailer".to_owned(), plugin: Box::new(Tow) });
    model
}

fn free(mut chassis: Chassis) -> Chassis {
    chassis.centre = Differential::Open;
    for axle in &mut chassis.axles {
        axle.differential = Differential::Open;
    }
    chassis
}

/// R_h² = R² + l², and the rear axle goes on √(R_h² − m²): round a circle of 20 m the trailer's axle keeps to the path, and the
/// hitch is bent by asin(l / R_h) + atan(m / R_rear).
#[test]
fn a_trailer_is_steered_backward_round_a_circle() {
    let radius_m = 20.0;
    let model = pushing(Box::new(Circle { radius_m }));
    for mode in [SteeringMode::Front, SteeringMode::All] {
        let mut chassis = free(hitched());
        chassis.steering.mode = mode;
        let outcome =
            simulate(&model, &chassis, &cycle(-1.0, vec![Phase::Hold { for_s: 100.0 }], 4e-3), 0.1).unwrap();
        assert_eq!(outcome.end, End::Finished, "{mode:?}");
        assert!(last(&outcome, "position_m") < -80.0, "{}", last(&outcome, "position_m"));
        let (sine, cosine) = last(&outcome, "trailer_heading_rad").sin_cos();
        // From the trailer's centre of gravity to its axle: a tenth of 4.5 m.
        let (east_m, north_m) = (
            last(&outcome, "trailer_east_m") - 0.45 * sine,
            last(&outcome, "trailer_north_m") - 0.45 * cosine,
        );
        let axle_m = (east_m - radius_m).hypot(north_m);
        assert!((axle_m - radius_m).abs() < 0.3, "{mode:?}: the trailer's axle goes on {axle_m} m");
        let pivot_m = if mode == SteeringMode::Front { -2.0 } else { -0.2 };
        let (l, m, hitch_m) = (4.5, pivot_m + 3.2, axle_m.hypot(4.5));
        let expected_rad = -((l / hitch_m).asin() + (m / hitch_m).asin());
        let angle_rad = last(&outcome, "trailer_angle_rad");
        assert!((angle_rad / expected_rad - 1.0).abs() < 0.05, "{mode:?}: {angle_rad} {expected_rad}");
        assert!(outcome.ledger.relative_residual() < 1e-3, "{:?}", outcome.ledger);
    }
}

/// Bent by a turn ahead, a trailer is straightened going back: without a driver who steers it, it would fold up within its length.
#[test]
fn a_bent_trailer_is_straightened_backward() {
    let model = pushing(Box::new(Circle { radius_m: 15.0 }));
    let phases = vec![
        to(1.5, Until::Travelled(20.0)),
        to(0.0, Until::Stopped),
        to(-1.5, Until::Position(-30.0)),
        to(0.0, Until::Stopped),
    ];
    let outcome = simulate(&model, &free(hitched()), &cycle(0.0, phases, 4e-3), 0.1).unwrap();
    assert_eq!(outcome.end, End::Finished, "{:?}", outcome.phases);
    assert!(last(&outcome, "position_m") < -30.0);
    let angle_rad = channel(&outcome, "trailer_angle_rad");
    let most_rad = angle_rad.iter().fold(0.0f64, |most, now| most.max(now.abs()));
    assert!(most_rad < 0.8, "{most_rad}");
}

/// One who goes aslant does not steer the hitch, which folds up: told with time, place and angle, and the run up to there is kept.
#[test]
fn a_trailer_that_jackknifes_is_told_with_its_angle() {
    let model = pushing(Box::new(Circle { radius_m: 15.0 }));
    let phases =
        vec![to(1.5, Until::Travelled(20.0)), to(0.0, Until::Stopped), to(-1.5, Until::Position(-30.0))];
    let mut aslant = free(hitched());
    aslant.steering.mode = SteeringMode::Crab { angle_rad: 0.05 };
    let outcome = simulate(&model, &aslant, &cycle(0.0, phases, 4e-3), 0.1).unwrap();
    let End::Stopped { reason, .. } = &outcome.end else { panic!("{:?}", outcome.end) };
    assert!(reason.contains("jackknifed") && reason.contains("hitch angle of 9"), "{reason}");
    assert!(outcome.trace.duration_s() > 3.0, "{}", outcome.trace.duration_s());
}

/// Asks for nothing but the count of earlier passes, a hundredth of resistance for each.
#[derive(Debug)]
struct Counting;

impl Soil for Counting {
    fn resistance_n(&self, contact: &Contact) -> f64 {
        0.1 * contact.load_n
    }

    fn wheel(&self, contact: &WheelContact) -> Option<Footing> {
        let passes = f64::from(contact.earlier_passes);
        Some(Footing {
            gross_traction_n: contact.load_n * contact.slip.clamp(-0.5, 0.5),
            motion_resistance_n: (0.05 - 0.02 * passes) * contact.load_n,
            sinkage_m: 0.03 + 0.01 * passes,
        })
    }
}

/// The axle that comes first presses the rut: the front one ahead, the rear one going back, in both fidelities.
#[test]
fn the_axle_that_comes_first_presses_the_rut() {
    let model = driven(model(terrain::<Flat>("()"), Box::new(Counting)));
    for (speed_m_s, depths_m) in [(1.5, [0.03, 0.04]), (-1.5, [0.04, 0.03])] {
        let cycle = cycle(0.0, vec![to(speed_m_s, Until::Travelled(15.0))], 2e-3);
        let three = simulate(&model, &open(SteeringMode::Front), &cycle, 0.0).unwrap();
        let one = headland_sim::simulate(&model, &cycle).unwrap();
        for (index, expected_m) in depths_m.into_iter().enumerate() {
            let name = format!("axle_{}_sinkage_m", index + 1);
            assert!((last(&one, &name) / expected_m - 1.0).abs() < 1e-9, "{speed_m_s} {name}");
            let name = format!("axle_{}_left_sinkage_m", index + 1);
            let found_m = last(&three, &name);
            assert!((found_m / expected_m - 1.0).abs() < 1e-3, "{speed_m_s} {name}: {found_m}");
        }
    }
}
