//! A trailer behind the vehicle: what it presses and pulls with, how far it rolls, and how it cuts a corner.

use super::{
    Circle, GRAVITY, Ideal, MASS_KG, TYRE, axles, channel, chassis, coast_down, cycle, last, model, soil,
    terrain,
};
use crate::{AxleBody, BodyError, Chassis, Differential, Trailer, TrailerAxle, simulate};
use headland_plugin::{Load, Situation, Task};
use headland_sim::{Cycle, End, Model, Named, Outcome, Phase, Until};
use headland_soil::Constant;
use headland_terrain::{ConstantGrade, Flat};

/// A trailer of 10 t, of which the vehicle carries a tenth.
const TOWED_KG: f64 = 10_000.0;
const CARRIED: f64 = 0.1;
const ROLLING: f64 = 0.02;
/// From the coupling to its axle [m], and what its wheels add to inertia [kg].
const DRAWBAR_M: f64 = 4.5;
const ROTATING_KG: f64 = 200.0;

#[derive(Debug)]
pub struct Tow;

impl Task for Tow {
    fn load(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Load {
        let towed_mass_kg = (1.0 - CARRIED) * TOWED_KG;
        Load {
            drawbar_force_n: ROLLING * towed_mass_kg * at.gravity_m_s2 * at.place.cos_slope(),
            mass_kg: CARRIED * TOWED_KG,
            towed_mass_kg,
            ..Load::default()
        }
    }

    fn load_in(&self, _: headland_plugin::Mode, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        self.load(at, states, rates)
    }
}

/// Where its centre of gravity is as high as the coupling, slowing down moves no load to the hitch, as in one dimension.
fn low() -> Chassis {
    let mut chassis = hitched();
    chassis.trailer.as_mut().unwrap().centre_of_gravity_height_m = 0.7;
    chassis
}

pub fn hitched() -> Chassis {
    let body = AxleBody {
        damping_n_s_m: 5e3,
        friction: 0.8,
        side_friction: 0.8,
        slip_stiffness: 12.0,
        cornering_stiffness_per_rad: 6.0,
        relaxation_length_m: 0.5,
        differential: Differential::Open,
        suspension: None,
    };
    let axle = TrailerAxle { position_m: -DRAWBAR_M, track_m: 1.9, wheels: 2, tyre: TYRE, body };
    let trailer = Trailer {
        centre_of_gravity_height_m: 1.4,
        roll_radius_m: 0.9,
        pitch_radius_m: 1.6,
        yaw_radius_m: 1.7,
        rotating_mass_kg: ROTATING_KG,
        axles: vec![axle],
    };
    Chassis { trailer: Some(trailer), ..chassis() }
}

fn towing(mut model: Model) -> Model {
    model.tasks.push(Named { name: "trailer".to_owned(), plugin: Box::new(Tow) });
    model
}

fn run(model: &Model, cycle: &Cycle) -> Outcome {
    simulate(model, &low(), cycle, 0.0).unwrap()
}

fn level() -> Model {
    towing(model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.05)")))
}

/// A tenth of 10 t rests on the hitch, 9.81 kN, but for what the tyres below it give way; the rear axle, 1.2 m ahead of it,
/// takes more than that by the lever.
#[test]
fn a_trailer_at_rest_presses_on_its_hitch_by_hand() {
    let outcome = run(&level(), &cycle(0.0, vec![Phase::Stand { until: Until::Elapsed(3.0) }], 2e-3));
    let pressing_n = CARRIED * TOWED_KG * GRAVITY;
    let found = last(&outcome, "coupling_load_n");
    assert!((found / pressing_n - 1.0).abs() < 2e-3, "{found} {pressing_n}");
    let rear_n = (MASS_KG * GRAVITY * 1.6 + pressing_n * (1.6 + 3.2)) / 3.6;
    assert!((last(&outcome, "axle_2_load_n") / rear_n - 1.0).abs() < 1e-3);
    let own_n = last(&outcome, "trailer_axle_1_left_load_n") + last(&outcome, "trailer_axle_1_right_load_n");
    assert!((own_n / ((1.0 - CARRIED) * TOWED_KG * GRAVITY) - 1.0).abs() < 1e-3, "{own_n}");
}

/// Both stop when and where the other does, if the longitudinal one is told of the trailer's wheels too.
#[test]
fn a_coast_down_with_a_trailer_is_the_longitudinal_one() {
    for grade in [0.0, 0.03] {
        let ground = terrain::<ConstantGrade>(&format!("(grade: {grade})"));
        let three = towing(model(ground, soil::<Constant>("(coefficient: 0.05)")));
        let ground = terrain::<ConstantGrade>(&format!("(grade: {grade})"));
        let mut one = towing(model(ground, soil::<Constant>("(coefficient: 0.05)")));
        one.vehicle.rotating_mass_kg += ROTATING_KG;
        let cycle = cycle(30.0 / 3.6, coast_down(), 2e-3);
        let (one, three) = (headland_sim::simulate(&one, &cycle).unwrap(), run(&three, &cycle));
        assert_eq!(three.end, End::Finished);
        let time = three.trace.duration_s() / one.trace.duration_s() - 1.0;
        let way = last(&three, "position_m") / last(&one, "position_m") - 1.0;
        assert!(time.abs() < 2e-3 && way.abs() < 2e-3, "grade {grade}: time {time} way {way}");
        assert!(
            three.ledger.relative_residual() < 1e-3,
            "{} {:?}",
            three.ledger.relative_residual(),
            three.ledger
        );
        let took = |outcome: &Outcome| {
            outcome.ledger.sinks.iter().find(|sink| sink.name == "drawbar").unwrap().energy_j
        };
        assert!((took(&three) / took(&one) - 1.0).abs() < 3e-3, "{} {}", took(&three), took(&one));
    }
}

/// What the coupling pulls with along the ground is what the trailer's wheels resist with; the channels are along the axes of
/// the vehicle, which noses up a little.
#[test]
fn a_steady_pull_is_what_the_trailers_wheels_resist_with() {
    let mut model = level();
    model.driveline = Box::new(Ideal);
    let outcome = run(&model, &cycle(3.0, vec![Phase::Hold { for_s: 20.0 }], 2e-3));
    let resisting_n = ROLLING * (1.0 - CARRIED) * TOWED_KG * GRAVITY;
    let (sine, cosine) = last(&outcome, "pitch_rad").sin_cos();
    let pull_n = last(&outcome, "coupling_pull_n") * cosine - last(&outcome, "coupling_load_n") * sine;
    assert!((pull_n / resisting_n - 1.0).abs() < 2e-3, "{pull_n} {resisting_n}");
}

/// ΔW = (m a (h − h_c) + (m_w a − R) (r − h_c)) / l: a trailer that is slowed down leans on its hitch; what slows the turning
/// of its wheels, and what resists them, acts in their hubs.
#[test]
fn slowing_down_presses_a_high_trailer_on_the_hitch_by_hand() {
    let model = towing(model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.1)")));
    let cycle = cycle(8.0, vec![Phase::Coast { until: Until::SpeedBelow(4.0) }], 2e-3);
    let outcome = simulate(&model, &hitched(), &cycle, 0.0).unwrap();
    let mean = |name: &str| {
        let values = channel(&outcome, name);
        let late = &values[values.len() / 2..];
        late.iter().sum::<f64>() / late.len() as f64
    };
    let slowing_m_s2 = -mean("acceleration_m_s2");
    let resisting_n = ROLLING * (1.0 - CARRIED) * TOWED_KG * GRAVITY;
    let hub_m = 0.5 * TYRE.diameter_m - mean("trailer_axle_1_left_deflection_m");
    let in_hubs_n = ROTATING_KG * slowing_m_s2 - resisting_n;
    let more_n = (TOWED_KG * slowing_m_s2 * (1.4 - 0.7) + in_hubs_n * (hub_m - 0.7)) / DRAWBAR_M;
    let stand = vec![Phase::Stand { until: Until::Elapsed(3.0) }];
    let standing = simulate(&model, &hitched(), &super::cycle(0.0, stand, 2e-3), 0.0).unwrap();
    // Its nose dips with the vehicle's tail, and its centre of gravity comes forward.
    let dips_rad = last(&standing, "trailer_pitch_rad") - mean("trailer_pitch_rad");
    let expected_n = more_n + TOWED_KG * GRAVITY * (1.4 - 0.7) * dips_rad / DRAWBAR_M;
    let upright_n = mean("coupling_load_n") + mean("coupling_pull_n") * mean("pitch_rad");
    let found_n = upright_n - last(&standing, "coupling_load_n");
    assert!(slowing_m_s2 > 0.5, "{slowing_m_s2}");
    assert!((found_n / expected_n - 1.0).abs() < 0.015, "{found_n} {expected_n} {more_n} {dips_rad}");
}

/// R_t² = R_h² − l² at low speed: R_h the radius on which the hitch goes, l the length of the trailer.
#[test]
fn a_trailer_cuts_the_corner_by_its_length() {
    let radius_m = 14.0;
    let mut model = towing(model(Box::new(Circle { radius_m }), soil::<Constant>("(coefficient: 0.05)")));
    model.driveline = Box::new(Ideal);
    let mut chassis = hitched();
    chassis.centre = Differential::Open;
    for axle in &mut chassis.axles {
        axle.differential = Differential::Open;
    }
    let outcome =
        simulate(&model, &chassis, &cycle(1.0, vec![Phase::Hold { for_s: 60.0 }], 4e-3), 0.0).unwrap();
    assert_eq!(outcome.end, End::Finished);
    // Both go round the middle of the circle, 14 m to the east of where it began.
    let from_middle_m = |east: &str, north: &str, heading: &str, ahead_m: f64| {
        let (sine, cosine) = last(&outcome, heading).sin_cos();
        let (east_m, north_m) =
            (last(&outcome, east) + ahead_m * sine, last(&outcome, north) + ahead_m * cosine);
        (east_m - radius_m).hypot(north_m)
    };
    let hitch_m = from_middle_m("east_m", "north_m", "heading_rad", chassis.hitch_position_m);
    let trailer_m =
        from_middle_m("trailer_east_m", "trailer_north_m", "trailer_heading_rad", -DRAWBAR_M * CARRIED);
    let expected_m = (hitch_m * hitch_m - DRAWBAR_M * DRAWBAR_M).sqrt();
    assert!(hitch_m - expected_m > 0.7, "{hitch_m} {expected_m}");
    assert!(
        (trailer_m - expected_m).abs() < 0.01 * (hitch_m - expected_m),
        "{trailer_m} {expected_m} {hitch_m}"
    );
    // sin φ = l / R_h at the trailer, and the vehicle's own heading leads the hitch's by the hitch's lever.
    let rear_m = from_middle_m("east_m", "north_m", "heading_rad", axles().list()[1].position_m);
    let lever_m = axles().list()[1].position_m - chassis.hitch_position_m;
    let expected_rad = -((DRAWBAR_M / hitch_m).asin() + (lever_m / rear_m).atan());
    let angle_rad = last(&outcome, "trailer_angle_rad");
    assert!((angle_rad / expected_rad - 1.0).abs() < 0.02, "{angle_rad} {expected_rad}");
}

#[test]
fn the_wheels_of_a_trailer_are_behind_its_centre_of_gravity_by_what_the_hitch_carries() {
    let found = crate::trailer_hubs(&level(), &hitched()).unwrap().unwrap();
    let given_m = 0.5 * (1.0 - CARRIED) * TOWED_KG * GRAVITY / TYRE.stiffness_n_per_m();
    let expected = [-CARRIED * DRAWBAR_M, 0.95, 0.5 * TYRE.diameter_m - given_m];
    assert!(
        found.hubs[0].place_m.iter().zip(expected).all(|(at, wanted)| (at - wanted).abs() < 1e-12),
        "{found:?}"
    );
    assert!((found.coupling_m[0] - (1.0 - CARRIED) * DRAWBAR_M).abs() < 1e-12 && found.coupling_m[1] == 0.7);
    assert_eq!((found.hubs[1].name.as_str(), found.centre_height_m), ("trailer_axle_1_right", 1.4));
    assert_eq!(crate::trailer_hubs(&level(), &chassis()).unwrap(), None);
}

#[test]
fn a_trailer_that_no_task_tows_is_refused_and_a_tow_without_a_trailer_is_told() {
    let bare = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.05)"));
    let cycle = cycle(3.0, coast_down(), 2e-3);
    let refused = simulate(&bare, &hitched(), &cycle, 0.0).unwrap_err();
    assert!(matches!(refused, crate::RunError::Body(BodyError::NothingTowed)), "{refused}");
    let told = simulate(&level(), &chassis(), &cycle, 0.0).unwrap();
    let End::Stopped { reason, .. } = &told.end else { panic!("{:?}", told.end) };
    assert!(reason.contains("9000 kg on other wheels") && reason.contains("`trailer`"), "{reason}");
    let mut ahead = hitched();
    ahead.trailer.as_mut().unwrap().axles[0].position_m = 0.5;
    let refused = simulate(&level(), &ahead, &cycle, 0.0).unwrap_err().to_string();
    assert!(refused.contains("trailer.axles.0.position_m") && refused.contains("behind"), "{refused}");
}
