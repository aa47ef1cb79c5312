//! How the vehicle stands: loads by the lever rule, on the level, on slopes and under forces.

use super::{GRAVITY, MASS_KG, channel, chassis, coast_down, cycle, last, model, run, soil, terrain};
use crate::rig::Rig;
use crate::{BodyError, simulate};
use headland_plugin::{Place, Spot, Surface, Terrain};
use headland_sim::{Axles, Carriage, End, Phase, Start, Until};
use headland_soil::Constant;
use headland_terrain::{ConstantGrade, Flat};

fn at_rest() -> Start {
    Start { position_m: 0.0, speed_m_s: 0.0 }
}

fn stand() -> Vec<Phase> {
    vec![Phase::Stand { until: Until::Elapsed(15.0) }]
}

/// Axles 1.6 m ahead and 2.0 m behind: 2.0 / 3.6 of the weight in front.
#[test]
fn axles_share_the_weight_by_the_lever() {
    let model = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.07)"));
    let chassis = chassis();
    let rig = Rig::new(&model, &chassis, at_rest(), 2e-3).unwrap();
    let weight_n = MASS_KG * GRAVITY;
    assert!((rig.axle(0).load_n / (weight_n * 2.0 / 3.6) - 1.0).abs() < 1e-9);
    assert!((rig.axle(1).load_n / (weight_n * 1.6 / 3.6) - 1.0).abs() < 1e-9);
}

/// Uphill by q, braked: W cos θ (l_r − h tan θ) / l in front, h to the ground. Tyres give way to the slope by some
/// millimetres, which turns the body: so to a hundredth of the transfer.
#[test]
fn a_slope_moves_load_to_the_lower_axle_by_its_height() {
    let model = model(terrain::<ConstantGrade>("(grade: 0.2)"), soil::<Constant>("(coefficient: 0.07)"));
    let outcome = run(&model, &cycle(0.0, stand(), 2e-3));
    assert_eq!(outcome.end, End::Finished);
    let weight_n = MASS_KG * GRAVITY;
    let cos = 1.0 / 0.2f64.hypot(1.0);
    let transfer_n = weight_n * cos * 0.2 * 1.3 / 3.6;
    let expected = [weight_n * cos * 2.0 / 3.6 - transfer_n, weight_n * cos * 1.6 / 3.6 + transfer_n];
    for (axle, expected) in ["axle_1_load_n", "axle_2_load_n"].iter().zip(expected) {
        let found = last(&outcome, axle);
        assert!((found - expected).abs() < 0.015 * transfer_n, "{axle}: {found} {expected}");
    }
    assert!(last(&outcome, "position_m").abs() < 0.02, "it stands: {}", last(&outcome, "position_m"));
}

/// A coast-down at a = F / m_eff: what resists acts in the hubs, the wheels give back 900 a at the ground and turn the body
/// by 900 a r as they spin down. About the centre of gravity: m_eff a (h − r) − 900 a h + 900 a r = m a (h − r).
#[test]
fn slowing_down_moves_load_to_the_front_by_hand() {
    let model = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.07)"));
    let outcome = run(&model, &cycle(8.0, coast_down(), 2e-3));
    let loads = channel(&outcome, "axle_1_load_n");
    let speeds = channel(&outcome, "speed_m_s");
    let slow: Vec<usize> = (0..loads.len()).filter(|row| (0.5..3.0).contains(&speeds[*row])).collect();
    let mean = slow.iter().map(|row| loads[*row]).sum::<f64>() / slow.len() as f64;
    let weight_n = MASS_KG * GRAVITY;
    let slowing = 0.07 * weight_n / (MASS_KG + 900.0);
    let stiffness = 1e6 / (0.365 + 170.0 / 150.0);
    let hub_m = 0.5 * 2.045 - 0.25 * weight_n / stiffness;
    let transfer_n = MASS_KG * slowing * (1.3 - hub_m) / 3.6;
    let found_n = mean - weight_n * 2.0 / 3.6;
    assert!((found_n / transfer_n - 1.0).abs() < 0.02, "{found_n} {transfer_n}");
}

/// A surface that falls away to the right.
#[derive(Debug)]
pub struct Side {
    pub rise_west: f64,
}

impl Surface for Side {
    fn spot(&self, east_m: f64, _: f64) -> Option<Spot> {
        Some(Spot { height_m: -self.rise_west * east_m, rise_east: -self.rise_west, rise_north: 0.0 })
    }
}

impl Terrain for Side {
    fn at(&self, position_m: f64) -> Place {
        Place { north_m: position_m, ..Place::default() }
    }

    fn surface(&self) -> Option<&dyn Surface> {
        Some(self)
    }
}

/// On a side slope the lower wheels carry W (cos β / 2 + h sin β / t).
#[test]
fn a_side_slope_moves_load_to_the_lower_wheels() {
    let model = model(Box::new(Side { rise_west: 0.2 }), soil::<Constant>("(coefficient: 0.07)"));
    let outcome = run(&model, &cycle(0.0, stand(), 2e-3));
    assert_eq!(outcome.end, End::Finished);
    let (weight_n, cos) = (MASS_KG * GRAVITY, 1.0 / 0.2f64.hypot(1.0));
    let lower: f64 =
        ["axle_1_right_load_n", "axle_2_right_load_n"].iter().map(|name| last(&outcome, name)).sum();
    let transfer_n = weight_n * cos * 0.2 * 1.3 / 2.1;
    // Tyres that give way lean the body by φ = transfer t / k_φ, and its weight h − r further out: wheels lean with it and
    // stay above the ground that they press.
    let stiffness = 1e6 / (0.365 + 170.0 / 150.0);
    let roll_stiffness = 4.0 * stiffness * 1.05 * 1.05;
    let hub_m = 0.5 * 2.045 - 0.25 * weight_n / stiffness;
    let leaning = 1.0 / (1.0 - weight_n * cos * (1.3 - hub_m) / roll_stiffness);
    let expected_n = 0.5 * weight_n * cos + transfer_n * leaning;
    assert!((lower - expected_n).abs() < 2e-3 * transfer_n, "{lower} {expected_n}");
    assert!(last(&outcome, "roll_rad") > 0.2, "leans to the right");
}

/// A cliff behind the origin, higher than a wheel.
#[derive(Debug)]
struct Cliff(f64);

impl Surface for Cliff {
    fn spot(&self, _: f64, north_m: f64) -> Option<Spot> {
        let height_m = if north_m > 1.0 { self.0 } else { 0.0 };
        (north_m < 30.0).then_some(Spot { height_m, ..Spot::default() })
    }
}

impl Terrain for Cliff {
    fn at(&self, position_m: f64) -> Place {
        Place { north_m: position_m, ..Place::default() }
    }

    fn surface(&self) -> Option<&dyn Surface> {
        Some(self)
    }
}

#[test]
fn a_map_that_ends_is_told_with_the_wheel_and_the_trace_is_kept() {
    let model = model(Box::new(Cliff(0.0)), soil::<Constant>("(coefficient: 0.02)"));
    let outcome = run(&model, &cycle(6.0, coast_down(), 2e-3));
    let End::Stopped { position_m, reason, .. } = &outcome.end else { panic!("{:?}", outcome.end) };
    assert!(reason.contains("wheel of axle 1 comes to the edge of the map"), "{reason}");
    // The front edge of a footprint of 0.65 m, 1.6 m ahead.
    assert!((position_m - (30.0 - 1.6 - 0.325)).abs() < 0.02 && outcome.trace.len() > 1000, "{position_m}");
}

#[test]
fn a_start_beyond_the_map_or_on_ground_that_nothing_stands_on_is_refused() {
    let far = model(Box::new(Cliff(0.0)), soil::<Constant>("(coefficient: 0.02)"));
    let start = Start { position_m: 40.0, speed_m_s: 0.0 };
    let chassis = chassis();
    let told = Rig::new(&far, &chassis, start, 2e-3).unwrap_err();
    assert!(matches!(told, BodyError::OffTheMap { .. }), "{told}");
    let level = model(settled(PATH), soil::<Constant>("(coefficient: 0.02)"));
    let told = Rig::new(&level, &chassis, Start { position_m: 75.0, speed_m_s: 0.0 }, 2e-3).unwrap_err();
    assert_eq!(told, BodyError::OffThePath { found_m: 75.0, from_m: 0.0, to_m: 60.0 });
    let cliff = model(Box::new(Cliff(9.0)), soil::<Constant>("(coefficient: 0.02)"));
    let told = Rig::new(&cliff, &chassis, at_rest(), 2e-3).unwrap_err();
    assert_eq!(told, BodyError::NoRest);
    // A vehicle of no mass presses no wheel down.
    let mut nothing = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.02)"));
    nothing.vehicle.mass_kg = 0.0;
    let told = Rig::new(&nothing, &chassis, at_rest(), 2e-3).unwrap_err();
    assert_eq!(told, BodyError::NotPositive { name: "mass_kg", found: 0.0 });
}

/// A tyre of 50 kN/m gives way by 0.6 m and more under its 29 to 35 kN, and has a section of 0.54 m.
#[test]
fn a_wheel_that_would_start_below_the_ground_is_refused_by_name() {
    let mut soft = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.02)"));
    let list = [1.6, -2.0].map(|position_m| {
        let mut axle = super::axle(position_m);
        axle.tyre.stiffness_n_per_m = Some(5e4);
        axle
    });
    soft.axles = Some(Axles::new(list.into(), 1.3, 0.7, 0.5).unwrap());
    let told = Rig::new(&soft, &chassis(), at_rest(), 2e-3).unwrap_err();
    let BodyError::BelowGround { wheel, depth_m, load_kn, most_m } = &told else { panic!("{told}") };
    let by_hand_kn = 1e-3 * 0.5 * MASS_KG * GRAVITY * 2.0 / 3.6;
    assert_eq!((wheel.as_str(), *most_m), ("the left wheel of axle 1", 0.54));
    assert!(
        (load_kn / by_hand_kn - 1.0).abs() < 0.05 && (depth_m / (load_kn / 50.0) - 1.0).abs() < 1e-6,
        "{told}"
    );
    assert!(told.to_string().contains("m below the ground, with 3"), "{told}");
}

fn settled(ron: &str) -> Box<dyn Terrain> {
    let mut profile = ron::from_str::<headland_terrain::Profile>(ron).unwrap();
    headland_plugin::Plugin::settle(&mut profile, std::path::Path::new("")).unwrap();
    Box::new(profile)
}

/// A level path of 60 m.
const PATH: &str =
    "(heading_rad: 0, points: [(position_m: 0, elevation_m: 0), (position_m: 60, elevation_m: 0)])";

/// At 60 m/s a wheel goes a third of a metre in 6 ms, and its footprint is 0.65 m long.
#[test]
fn a_step_in_which_a_wheel_leaves_its_footprint_is_refused_and_told_where_it_comes_to_that() {
    let model = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.07)"));
    let told = simulate(&model, &chassis(), &cycle(60.0, coast_down(), 6e-3), 0.0).unwrap_err().to_string();
    assert!(told.contains("`step_s` is 0.006") && told.contains("rolls past its footprint"), "{told}");
    let steep = model_on(terrain::<ConstantGrade>("(grade: -0.8)"), model);
    let outcome = run(&steep, &cycle(40.0, coast_down(), 6e-3));
    let End::Stopped { reason, .. } = &outcome.end else { panic!("{:?}", outcome.end) };
    assert!(reason.contains("a wheel rolls past its footprint in a step of 0.006 s"), "{reason}");
    assert!(outcome.trace.len() > 100, "the trace is kept");
}

fn model_on(terrain: Box<dyn Terrain>, model: headland_sim::Model) -> headland_sim::Model {
    headland_sim::Model { terrain, ..model }
}

#[test]
fn a_step_that_is_too_long_is_refused_before_it_blows_up() {
    let model = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.07)"));
    let cycle = cycle(8.0, coast_down(), 0.2);
    let told = simulate(&model, &chassis(), &cycle, 0.0).unwrap_err().to_string();
    assert!(told.contains("`step_s` is 0.2, expected at most"), "{told}");
}

/// Six axles in a row, as a track has, and twin tyres on the last: they share as springs do, like those of one dimension.
#[test]
fn a_row_of_wheels_and_twin_tyres_share_the_load_as_springs() {
    let mut list: Vec<_> = (0..6).map(|index| super::axle(2.0 - 0.7 * f64::from(index))).collect();
    list[5].wheels = 4;
    let axles = Axles::new(list, 1.3, 0.7, 0.5).unwrap();
    let mut model = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.07)"));
    let mut chassis = chassis();
    chassis.axles = vec![chassis.axles[0]; 6];
    let weight_n = MASS_KG * GRAVITY;
    let expected: Vec<f64> = (0..6).map(|index| axles.load_n(index, weight_n, 0.0)).collect();
    model.axles = Some(axles);
    let rig = Rig::new(&model, &chassis, at_rest(), 1e-3).unwrap();
    for (index, expected) in expected.iter().enumerate() {
        assert!((rig.axle(index).load_n / expected - 1.0).abs() < 1e-9, "axle {index}");
    }
    assert!(expected[5] > 1.5 * expected[4], "twins are twice as stiff");
    let coasting = simulate(&model, &chassis, &cycle(5.0, coast_down(), 1e-3), 0.1).unwrap();
    assert_eq!(coasting.end, End::Finished);
    let by_hand = 0.5 * 25.0 * (MASS_KG + 900.0) / (0.07 * weight_n);
    assert!((last(&coasting, "position_m") / by_hand - 1.0).abs() < 0.01);
}

#[test]
fn hubs_are_where_the_tyres_hold_them() {
    let model = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.05)"));
    let hubs = crate::hubs(&model, &chassis()).unwrap();
    let names: Vec<&str> = hubs.iter().map(|hub| hub.name.as_str()).collect();
    assert_eq!(names, ["axle_1_left", "axle_1_right", "axle_2_left", "axle_2_right"]);
    // Half of 2.0 m of 3.6 m of the weight, on a stiffness of 1e6 / (0.365 + 170 / 150) N/m.
    let given_m = MASS_KG * GRAVITY * 2.0 / 3.6 / 2.0 * (0.365 + 170.0 / 150.0) / 1e6;
    let expected = [1.6, 1.05, 1.0225 - given_m];
    assert!(hubs[0].place_m.iter().zip(expected).all(|(at, wanted)| (at - wanted).abs() < 1e-12), "{hubs:?}");
    assert_eq!((hubs[1].radius_m, hubs[1].width_m, hubs[1].squeezed_m), (1.0225, 0.9, 0.0));
}
