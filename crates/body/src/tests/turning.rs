//! How the vehicle turns, and when it turns over.

use super::{Circle, GRAVITY, Ideal, MASS_KG, channel, chassis, cycle, last, model, soil, terrain};
use crate::chassis::{Chassis, Differential, SteeringMode};
use crate::rig::Rig;
use crate::tests::standing::Side;
use crate::{BodyError, simulate};
use headland_plugin::{Place, Spot, Surface, Terrain};
use headland_sim::{End, Model, Outcome, Phase, Start, Until};
use headland_soil::Constant;
use headland_terrain::Flat;

fn open(mode: SteeringMode) -> Chassis {
    let mut chassis = chassis();
    chassis.steering.mode = mode;
    chassis.centre = Differential::Open;
    for axle in &mut chassis.axles {
        axle.differential = Differential::Open;
    }
    chassis
}

fn around(radius_m: f64, speed_m_s: f64, mode: SteeringMode) -> Outcome {
    let mut model = model(Box::new(Circle { radius_m }), soil::<Constant>("(coefficient: 0.03)"));
    model.driveline = Box::new(Ideal);
    let cycle = cycle(speed_m_s, vec![Phase::Hold { for_s: 25.0 }], 2e-3);
    let outcome = simulate(&model, &open(mode), &cycle, 0.1).unwrap();
    assert_eq!(outcome.end, End::Finished);
    outcome
}

/// Angle of the wheel in the middle of an axle, of those left and right of it: Ackermann's condition in its cotangents.
fn middle_rad(outcome: &Outcome, axle: u32) -> f64 {
    let cotangent = |side: &str| 1.0 / last(outcome, &format!("axle_{axle}_{side}_steer_rad")).tan();
    (2.0 / (cotangent("left") + cotangent("right"))).atan()
}

/// Slowly, the wheels are square to the centre of the turn: tan δ = l / √(R² − b²), b from the centre of gravity to the rear.
#[test]
fn a_slow_turn_has_the_radius_that_its_wheels_point_to() {
    let outcome = around(15.0, 1.0, SteeringMode::Front);
    let radius_m = last(&outcome, "speed_m_s").hypot(last(&outcome, "side_speed_m_s"))
        / last(&outcome, "yaw_rate_rad_s");
    assert!((radius_m / 15.0 - 1.0).abs() < 0.01, "{radius_m}");
    let expected = -(3.6 / (radius_m * radius_m - 4.0).sqrt()).atan();
    let found = middle_rad(&outcome, 1);
    assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
}

/// Steering both axles, half of the angle in front.
#[test]
fn both_axles_turn_as_tightly_with_half_the_angle() {
    let outcome = around(15.0, 1.0, SteeringMode::All);
    let (front, rear) = (middle_rad(&outcome, 1), middle_rad(&outcome, 2));
    assert!((front / -(1.8f64 / 15.0).atan() - 1.0).abs() < 0.02, "{front}");
    assert!((front + rear).abs() < 1e-3, "{front} {rear}");
}

/// Equal cornering stiffness per load in front and behind: neutral, so speed changes the slip angles and not the steering.
/// Each slip angle is a / (g c_α), and the outer wheels take m a h / t over.
#[test]
fn a_fast_turn_slips_and_leans_as_its_centripetal_acceleration_says() {
    let outcome = around(40.0, 8.0, SteeringMode::Front);
    let speed = last(&outcome, "speed_m_s");
    let sideways = speed * last(&outcome, "yaw_rate_rad_s");
    assert!((sideways - 1.6).abs() < 0.05, "{sideways}");
    let side: f64 = ["left", "right"]
        .iter()
        .flat_map(|side| [1, 2].map(|axle| last(&outcome, &format!("axle_{axle}_{side}_side_force_n"))))
        .sum();
    // The force points right, which is across to the negative side.
    assert!((side / (-MASS_KG * sideways) - 1.0).abs() < 0.02, "{side}");
    let angle = last(&outcome, "axle_2_left_slip_angle_rad").abs();
    assert!((angle / (sideways / (GRAVITY * 6.0)) - 1.0).abs() < 0.06, "{angle}");
    let of = |side: &str| {
        last(&outcome, &format!("axle_1_{side}_load_n")) + last(&outcome, &format!("axle_2_{side}_load_n"))
    };
    let transfer_n = 0.5 * (of("left") - of("right"));
    let by_hand = MASS_KG * sideways * 1.3 / 2.1;
    assert!((transfer_n / by_hand - 1.0).abs() < 0.05, "{transfer_n} {by_hand}");
}

#[test]
fn a_crab_goes_aslant_along_its_path() {
    let mut model = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.03)"));
    model.driveline = Box::new(Ideal);
    let cycle = cycle(2.0, vec![Phase::Hold { for_s: 15.0 }], 2e-3);
    let crab = open(SteeringMode::Crab { angle_rad: 0.1 });
    let outcome = simulate(&model, &crab, &cycle, 0.1).unwrap();
    assert_eq!(outcome.end, End::Finished);
    assert!((last(&outcome, "heading_rad") - 0.1).abs() < 0.01, "{}", last(&outcome, "heading_rad"));
    assert!(last(&outcome, "path_offset_m").abs() < 0.1, "{}", last(&outcome, "path_offset_m"));
    assert!((last(&outcome, "axle_1_left_steer_rad") - 0.1).abs() < 0.01);
}

/// Grip beyond the slope at which it turns over.
fn gripping() -> Chassis {
    let mut chassis = chassis();
    for axle in &mut chassis.axles {
        axle.friction = 1.5;
        axle.side_friction = 1.5;
    }
    chassis
}

/// Slope at which the upper wheels carry nothing: t / (2 h), less what the tyres lean it out.
fn threshold() -> f64 {
    let (weight_n, stiffness) = (MASS_KG * GRAVITY, 1e6 / (0.365 + 170.0 / 150.0));
    let hub_m = 0.5 * 2.045 - 0.25 * weight_n / stiffness;
    let roll_stiffness = 4.0 * stiffness * 1.05 * 1.05;
    let rigid: f64 = 0.5 * 2.1 / 1.3;
    let cos = 1.0 / rigid.hypot(1.0);
    rigid * (1.0 - weight_n * cos * (1.3 - hub_m) / roll_stiffness)
}

#[test]
fn a_vehicle_stands_on_a_side_slope_up_to_its_threshold_and_not_beyond() {
    let chassis = gripping();
    let stands = |rise_west: f64| {
        let model = model(Box::new(Side { rise_west }), soil::<Constant>("(coefficient: 0.07)"));
        Rig::new(&model, &chassis, Start::default(), 2e-3).map(|_| ())
    };
    assert_eq!(stands(0.985 * threshold()), Ok(()));
    assert_eq!(stands(1.015 * threshold()), Err(BodyError::NoRest));
}

/// A side slope that grows by 2 % each metre.
#[derive(Debug)]
struct Twist;

impl Surface for Twist {
    fn spot(&self, east_m: f64, north_m: f64) -> Option<Spot> {
        let steep = 0.02 * north_m;
        Some(Spot { height_m: -steep * east_m, rise_east: -steep, rise_north: -0.02 * east_m })
    }
}

impl Terrain for Twist {
    fn at(&self, position_m: f64) -> Place {
        Place { north_m: position_m, ..Place::default() }
    }

    fn surface(&self) -> Option<&dyn Surface> {
        Some(self)
    }
}

#[test]
fn a_vehicle_that_overturns_is_told_with_time_and_place() {
    let mut model: Model = model(Box::new(Twist), soil::<Constant>("(coefficient: 0.05)"));
    model.driveline = Box::new(Ideal);
    let cycle = cycle(
        1.0,
        vec![Phase::Drive {
            speed_m_s: 1.0,
            acceleration_m_s2: 0.5,
            tolerance_m_s: None,
            until: Until::Position(80.0),
        }],
        2e-3,
    );
    let outcome = simulate(&model, &gripping(), &cycle, 0.0).unwrap();
    let End::Stopped { reason, position_m, time_s } = &outcome.end else { panic!("{:?}", outcome.end) };
    assert!(reason.contains("overturned onto its side"), "{reason} at {position_m}");
    // The trace is kept up to there, and ends at that time and place.
    assert_eq!(outcome.trace.time_s().last(), Some(time_s));
    assert_eq!(last(&outcome, "position_m"), *position_m);
    assert!(last(&outcome, "roll_rad") > 1.0 && channel(&outcome, "roll_rad")[0].abs() < 0.01);
    // The upper wheels leave the ground where the slope below the middle of the vehicle is the threshold; it sways as it
    // comes there, and is steered uphill to hold its path.
    let upper: Vec<f64> = channel(&outcome, "axle_1_left_load_n")
        .iter()
        .zip(channel(&outcome, "axle_2_left_load_n"))
        .map(|(front, rear)| front + rear)
        .collect();
    let lifted = upper.iter().position(|load| *load == 0.0).unwrap();
    let slope = 0.02 * channel(&outcome, "position_m")[lifted];
    assert!((slope / threshold() - 1.0).abs() < 0.05, "{slope} {}", threshold());
}

#[test]
fn a_path_that_bends_more_tightly_than_the_wheels_turn_is_lost_and_told() {
    let mut model = model(Box::new(Circle { radius_m: 15.0 }), soil::<Constant>("(coefficient: 0.03)"));
    model.driveline = Box::new(Ideal);
    let mut stiff = chassis();
    stiff.steering.limit_rad = 0.1;
    let cycle = cycle(2.0, vec![Phase::Hold { for_s: 60.0 }], 2e-3);
    let outcome = simulate(&model, &stiff, &cycle, 0.0).unwrap();
    let End::Stopped { reason, .. } = &outcome.end else { panic!("{:?}", outcome.end) };
    assert!(reason.contains("beside its path"), "{reason}");
}
