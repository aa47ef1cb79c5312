//! Vehicles that their wheels carry: loads, slip and traction by hand, against vehicles that roll as a whole, and the ledger.

use crate::{
    Axle, Axles, Cycle, Drive, End, Model, Named, Outcome, Phase, Replay, Resistance, Start, Until, Vehicle,
    replay, simulate,
};
use headland_plugin::{
    Air, Contact, Delivery, Demand, Driveline, Footing, Load, MAX_LOSSES, Place, Readings, Situation, Soil,
    Task, Terrain, Tyre, WheelContact,
};

const MASS_KG: f64 = 10_000.0;
const GRAVITY_M_S2: f64 = 9.81;
const WEIGHT_N: f64 = MASS_KG * GRAVITY_M_S2;
const TYRE: Tyre = Tyre {
    width_m: 0.6,
    diameter_m: 1.8,
    section_height_m: 0.4,
    inflation_pa: 1.2e5,
    carcass_pa: 0.0,
    stiffness_n_per_m: Some(4e5),
};

/// Gross traction μ W (1 − e^(−k s)) and resistance c W; `firm` knows whole vehicles only.
#[derive(Clone, Copy, Debug)]
struct Field {
    adhesion: f64,
    rate: f64,
    coefficient: f64,
    firm: bool,
}

const FIELD: Field = Field { adhesion: 0.7, rate: 8.0, coefficient: 0.06, firm: false };

impl Soil for Field {
    fn resistance_n(&self, contact: &Contact) -> f64 {
        self.coefficient * contact.load_n
    }

    fn wheel(&self, contact: &WheelContact) -> Option<Footing> {
        let (w, s) = (contact.load_n, contact.slip);
        let grip = (-(-self.rate * s.abs()).exp_m1()).copysign(s);
        let footing = Footing {
            gross_traction_n: self.adhesion * w * grip,
            motion_resistance_n: self.coefficient * w,
            sinkage_m: 0.01 * f64::from(contact.earlier_passes),
        };
        (!self.firm).then_some(footing)
    }
}

/// Gives up to a force and up to a power, and loses a tenth of what it gives.
#[derive(Debug)]
struct Motor {
    most_n: f64,
    most_w: f64,
}

impl Driveline for Motor {
    fn losses(&self) -> &'static [&'static str] {
        &["gears"]
    }

    fn source(&self) -> &'static str {
        "store"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        0.0
    }

    fn deliver(&self, demand: &Demand, _: &[f64], _: &mut [f64]) -> Delivery {
        let least = if demand.coasting { 0.0 } else { demand.force_n.clamp(0.0, self.most_n) };
        let force_n =
            if least * demand.speed_m_s > self.most_w { self.most_w / demand.speed_m_s } else { least };
        let mut losses_w = [0.0; MAX_LOSSES];
        losses_w[0] = 0.1 * force_n * demand.speed_m_s;
        let source_power_w = force_n * demand.speed_m_s + losses_w[0];
        Delivery { force_n, source_power_w, losses_w, readings: Readings::NONE }
    }
}

#[derive(Debug)]
struct Incline(f64);

impl Terrain for Incline {
    fn at(&self, position_m: f64) -> Place {
        Place { elevation_m: self.0 * position_m, sin_slope: self.0, ..Place::default() }
    }
}

#[derive(Debug)]
struct Plough(f64);

impl Task for Plough {
    fn load(&self, _: &Situation, _: &[f64], _: &mut [f64]) -> Load {
        Load { drawbar_force_n: self.0, ..Load::default() }
    }
}

fn axle(position_m: f64, lead: Option<f64>) -> Axle {
    Axle { position_m, track_m: 1.9, wheels: 2, tyre: TYRE, lead }
}

/// 1.2 m ahead and 1.8 m behind the centre of gravity, which is 1.1 m high; pulled at 0.6 m.
fn stand(front: Option<f64>, rear: Option<f64>) -> Axles {
    Axles::new(vec![axle(1.2, front), axle(-1.8, rear)], 1.1, 0.6, 0.6).unwrap()
}

fn tractor(axles: Option<Axles>, soil: Field) -> Model {
    Model {
        vehicle: Vehicle {
            mass_kg: MASS_KG,
            rotating_mass_kg: 0.0,
            resistance: Resistance::Drag { area_m2: 5.0 },
            brake_friction: f64::INFINITY,
        },
        gravity_m_s2: GRAVITY_M_S2,
        air: Air { density_kg_m3: 1.2, wind_speed_m_s: 0.0, wind_from_rad: 0.0, temperature_c: 12.0 },
        terrain: Box::new(Incline(0.0)),
        axles,
        soil: Some(Box::new(soil)),
        driveline: Box::new(Motor { most_n: 1e6, most_w: 1e9 }),
        tasks: Vec::new(),
        effects: Vec::new(),
    }
}

fn pulling(mut model: Model, force_n: f64) -> Model {
    model.tasks.push(Named { name: "plough".to_owned(), plugin: Box::new(Plough(force_n)) });
    model
}

fn drive(model: &Model, start_m_s: f64, step_s: f64, phases: Vec<Phase>) -> Outcome {
    let start = Start { position_m: 0.0, speed_m_s: start_m_s };
    simulate(model, &Cycle { start, phases, driver_gain_per_s: 1.0, step_s, longest_s: 1000.0 }).unwrap()
}

fn hold(model: &Model, speed_m_s: f64) -> Outcome {
    drive(model, speed_m_s, 0.05, vec![Phase::Hold { for_s: 2.0 }])
}

fn last(outcome: &Outcome, channel: &str) -> f64 {
    *outcome.trace.get(channel).unwrap_or_else(|| panic!("no {channel}")).last().unwrap()
}

fn account(outcome: &Outcome, name: &str) -> f64 {
    outcome.ledger.sinks.iter().find(|entry| entry.name == name).map_or(0.0, |entry| entry.energy_j)
}

fn both() -> Axles {
    stand(Some(1.0), Some(1.0))
}

/// Everything a drive and a coast-down leave behind, with and without axles.
fn agree(on_wheels: &Model, whole: &Model, tolerance: f64) {
    let phases = vec![
        Phase::Reach { speed_m_s: 6.0, acceleration_m_s2: 0.5 },
        Phase::Hold { for_s: 2.0 },
        Phase::Reach { speed_m_s: 4.0, acceleration_m_s2: 1.0 },
        Phase::Coast { until: Until::Stopped },
    ];
    let (one, other) = (drive(on_wheels, 0.0, 0.05, phases.clone()), drive(whole, 0.0, 0.05, phases));
    assert_eq!((&one.end, &other.end), (&End::Finished, &End::Finished));
    for channel in ["position_m", "speed_m_s"] {
        let (one, other) = (one.trace.get(channel).unwrap(), other.trace.get(channel).unwrap());
        let worst = one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(one.len() == other.len() && worst < tolerance, "{channel}: {worst}");
    }
    for name in ["soil", "brakes", "gears", "air"] {
        let (one, other) = (account(&one, name), account(&other, name));
        assert!((one - other).abs() <= tolerance * other.abs().max(1.0), "{name}: {one} {other}");
    }
    assert!((one.ledger.source_j / other.ledger.source_j - 1.0).abs() < tolerance);
}

#[test]
fn on_ground_that_knows_no_slip_axles_change_nothing() {
    let model = |axles| tractor(axles, Field { firm: true, ..FIELD });
    agree(&model(Some(both())), &model(None), 1e-9);
}

/// A rate of 10⁶ leaves a slip of some 10⁻⁷.
#[test]
fn where_hardly_anything_slips_the_vehicle_rolls_as_a_whole() {
    let model = |axles| tractor(axles, Field { rate: 1e6, ..FIELD });
    agree(&model(Some(both())), &model(None), 1e-5);
}

/// 98.1 kN, 60 % of it in front. At 0.8 m/s²: 10 t · 0.8 · 1.1 / 3.0 = 2933 N to the rear; each axle's resistance of 6 %
/// at a radius of 0.9 m less its deflection moves the reaction too.
#[test]
fn acceleration_moves_load_to_the_rear_by_hand() {
    let frictionless = tractor(Some(both()), Field { coefficient: 0.0, ..FIELD });
    let mut model = frictionless;
    model.vehicle.resistance = Resistance::Drag { area_m2: 0.0 };
    let phases = vec![Phase::Reach { speed_m_s: 2.0, acceleration_m_s2: 0.8 }];
    let outcome = drive(&model, 0.0, 0.05, phases);
    let (front, rear) =
        (&outcome.trace.get("axle_1_load_n").unwrap(), outcome.trace.get("axle_2_load_n").unwrap());
    let moved = 1e4 * 0.8 * 1.1 / 3.0;
    assert!((front[5] - (0.6 * WEIGHT_N - moved)).abs() < 1e-5, "{}", front[5]);
    assert!((rear[5] - (0.4 * WEIGHT_N + moved)).abs() < 1e-5, "{}", rear[5]);
}

/// On a slope of sin 0.1 with a pull of 20 kN at 0.6 m, at a steady speed: the ground carries G cos θ, and
/// (10 t · 9.81 · 0.1 · 1.1 + 20 kN · 0.6) / 3.0 = 7597 N move to the rear.
#[test]
fn slope_and_pull_move_load_to_the_rear_by_hand() {
    let mut model = pulling(tractor(Some(both()), Field { coefficient: 0.0, ..FIELD }), 20e3);
    model.terrain = Box::new(Incline(0.1));
    model.vehicle.resistance = Resistance::Drag { area_m2: 0.0 };
    let outcome = hold(&model, 2.0);
    let carried = WEIGHT_N * 0.99f64.sqrt();
    let moved = (WEIGHT_N * 0.1 * 1.1 + 20e3 * 0.6) / 3.0;
    assert!((last(&outcome, "axle_1_load_n") - (0.6 * carried - moved)).abs() < 1e-5);
    assert!((last(&outcome, "axle_2_load_n") - (0.4 * carried + moved)).abs() < 1e-5);
}

/// Rolling at a steady speed on level ground without air, the axles together carry the weight, and the resistance moves
/// Σ R r / L to the rear: R = 6 % of each load, r = 0.9 m less the deflection of its tyre.
#[test]
fn resistance_moves_the_reaction_ahead_of_the_hubs() {
    let mut model = tractor(Some(both()), FIELD);
    model.vehicle.resistance = Resistance::Drag { area_m2: 0.0 };
    let outcome = hold(&model, 2.0);
    let (front, rear) = (last(&outcome, "axle_1_load_n"), last(&outcome, "axle_2_load_n"));
    let turning: f64 = [front, rear].iter().map(|load| 0.06 * load * (0.9 - 0.5 * load / 4e5)).sum();
    assert!((front + rear - WEIGHT_N).abs() < 1e-5);
    assert!((0.6 * WEIGHT_N - front - turning / 3.0).abs() < 1e-4, "{front} {turning}");
}

/// Both axles slip alike, so Σ G = μ W (1 − e^(−k s)): with a pull of 30 kN and 6 % of resistance
/// s = −ln(1 − (30 000 + 5886) / (0.7 · 98 100)) / 8, v_wheel = v / (1 − s), and slip takes F (v_wheel − v).
#[test]
fn a_pull_makes_the_slip_that_the_soil_asks_for_it() {
    let mut model = pulling(tractor(Some(both()), FIELD), 30e3);
    model.vehicle.resistance = Resistance::Drag { area_m2: 0.0 };
    let outcome = hold(&model, 2.0);
    let force = 30e3 + 0.06 * WEIGHT_N;
    let slip = -(1.0 - force / (0.7 * WEIGHT_N)).ln() / 8.0;
    assert!((last(&outcome, "slip") - slip).abs() < 1e-12);
    assert!((last(&outcome, "wheel_speed_m_s") - 2.0 / (1.0 - slip)).abs() < 1e-11);
    assert!((last(&outcome, "tractive_force_n") / force - 1.0).abs() < 1e-12);
    let lost = force * (2.0 / (1.0 - slip) - 2.0) * 2.0;
    assert!((account(&outcome, "slip") / lost - 1.0).abs() < 1e-9, "{}", account(&outcome, "slip"));
    assert!((account(&outcome, "soil") / (0.06 * WEIGHT_N * 4.0) - 1.0).abs() < 1e-9);
    assert!(outcome.ledger.relative_residual() < 1e-9);
    assert_eq!(last(&outcome, "axle_2_sinkage_m"), 0.01);
}

/// Rear wheels alone pull with what rests on them.
#[test]
fn an_axle_that_is_not_driven_only_resists() {
    let mut model = pulling(tractor(Some(stand(None, Some(1.0))), FIELD), 10e3);
    model.vehicle.resistance = Resistance::Drag { area_m2: 0.0 };
    let outcome = hold(&model, 2.0);
    assert_eq!(last(&outcome, "axle_1_traction_n"), 0.0);
    let load = last(&outcome, "axle_2_load_n");
    let slip = -(1.0 - (10e3 + 0.06 * WEIGHT_N) / (0.7 * load)).ln() / 8.0;
    assert!((last(&outcome, "slip") - slip).abs() < 1e-11);
}

/// A front axle that leads by 4 % pulls the more; at a light load the rear one is dragged along, and power circulates.
#[test]
fn a_leading_front_axle_pulls_against_the_rear_one_at_light_load() {
    let mut model = tractor(Some(stand(Some(1.04), Some(1.0))), Field { coefficient: 0.01, ..FIELD });
    model.vehicle.resistance = Resistance::Drag { area_m2: 0.0 };
    let outcome = hold(&model, 2.0);
    let (front, rear) = (last(&outcome, "axle_1_traction_n"), last(&outcome, "axle_2_traction_n"));
    assert!(front > 0.0 && rear < 0.0, "{front} {rear}");
    assert!((front + rear - 0.01 * WEIGHT_N).abs() < 1e-6);
    let (fast, slow) = (last(&outcome, "axle_1_slip"), last(&outcome, "axle_2_slip"));
    assert!(((1.0 - slow) / (1.0 - fast) - 1.04).abs() < 1e-12);
    assert!((last(&outcome, "tractive_force_n") - (1.04 * front + rear)).abs() < 1e-6);
    assert!(outcome.ledger.relative_residual() < 1e-9 && account(&outcome, "slip") > 0.0);
}

#[test]
fn the_ledger_closes_where_power_is_short_wheels_slip_and_brakes_help() {
    let mut model = pulling(tractor(Some(stand(Some(1.02), Some(1.0))), FIELD), 15e3);
    model.driveline = Box::new(Motor { most_n: 45e3, most_w: 90e3 });
    model.terrain = Box::new(Incline(0.03));
    let outcome = drive(
        &model,
        0.0,
        0.02,
        vec![
            Phase::Follow { profile: vec![(0.0, 0.0), (4.0, 6.0), (8.0, 1.0), (10.0, 2.0)] },
            Phase::Hold { for_s: 2.0 },
            Phase::Reach { speed_m_s: 0.0, acceleration_m_s2: 4.0 },
        ],
    );
    assert_eq!(outcome.end, End::Finished);
    assert!(account(&outcome, "slip") > 1e3 && account(&outcome, "brakes") > 1e3);
    assert!(outcome.ledger.relative_residual() < 1e-6, "{:?}", outcome.ledger);
    // Where power is short, force times the speed of the wheels is what the motor has.
    let (force, speed) =
        (outcome.trace.get("tractive_force_n").unwrap(), outcome.trace.get("wheel_speed_m_s").unwrap());
    let most = force.iter().zip(speed).map(|(f, v)| f * v).fold(0.0, f64::max);
    assert!((most / 90e3 - 1.0).abs() < 1e-9, "{most}");
}

/// Power-limited wheels that slip speed a vehicle up: smooth, so that the method shows its order.
#[test]
fn slip_and_load_transfer_keep_the_fourth_order() {
    let speed = |step_s: f64| {
        let mut model = pulling(tractor(Some(stand(Some(1.01), Some(1.0))), FIELD), 5e3);
        model.driveline = Box::new(Motor { most_n: 1e6, most_w: 150e3 });
        let profile = vec![(0.0, 30.0), (4.0, 60.0)];
        last(&drive(&model, 3.0, step_s, vec![Phase::Follow { profile }]), "speed_m_s")
    };
    let exact = speed(0.005);
    let order = ((speed(0.4) - exact) / (speed(0.2) - exact)).abs().log2();
    assert!(order > 3.6 && order < 4.6, "observed order {order}");
}

/// 60 % of the load resist 6 %, 40 % on soft ground behind a border 10 %.
#[test]
fn each_axle_is_on_its_own_ground() {
    #[derive(Debug)]
    struct Border;
    impl Soil for Border {
        fn resistance_n(&self, _: &Contact) -> f64 {
            f64::NAN
        }
        fn wheel(&self, contact: &WheelContact) -> Option<Footing> {
            let coefficient = if contact.place.north_m > 0.0 { 0.06 } else { 0.1 };
            Field { coefficient, ..FIELD }.wheel(contact)
        }
    }
    let mut model = tractor(Some(both()), FIELD);
    model.soil = Some(Box::new(Border));
    let outcome = drive(&model, 0.1, 0.05, vec![Phase::Hold { for_s: 0.1 }]);
    let share = |axle: u32| {
        last(&outcome, &format!("axle_{axle}_resistance_n")) / last(&outcome, &format!("axle_{axle}_load_n"))
    };
    assert!((share(1) - 0.06).abs() < 1e-12 && (share(2) - 0.1).abs() < 1e-12, "{} {}", share(1), share(2));
}

#[test]
fn a_demand_beyond_the_ground_stops_with_time_place_and_reason() {
    // 0.7 (1 − e^(−8 · 0.6)) of 98.1 kN are 68.1 kN; 63 kN and the resistance are more.
    let model = pulling(tractor(Some(both()), FIELD), 63e3);
    let outcome = drive(&model, 2.0, 0.05, vec![Phase::Hold { for_s: 2.0 }]);
    let End::Stopped { time_s, position_m, reason } = &outcome.end else { panic!("it went on") };
    assert!(reason.starts_with("slip past the limit") && reason.contains("0.6"), "{reason}");
    assert!(*time_s == 0.0 && *position_m == 0.0 && reason.contains(" N, and they"));
    // A drive that cannot give as much as the ground is no matter of slip.
    let mut weak = pulling(tractor(Some(both()), FIELD), 63e3);
    weak.driveline = Box::new(Motor { most_n: 40e3, most_w: 1e9 });
    let outcome = drive(&weak, 2.0, 0.05, vec![Phase::Reach { speed_m_s: 3.0, acceleration_m_s2: 0.2 }]);
    assert!(
        matches!(outcome.end, End::Stopped { reason, .. } if reason.contains("only matches the resistances"))
    );
}

#[test]
fn a_pull_that_turns_the_vehicle_over_is_told() {
    let high = Axles::new(vec![axle(0.3, Some(1.0)), axle(-1.8, Some(1.0))], 1.1, 5.5, 0.6).unwrap();
    let outcome = hold(&pulling(tractor(Some(high), FIELD), 40e3), 2.0);
    assert!(
        matches!(&outcome.end, End::Stopped { reason, .. } if reason.contains("axle 1 leaves the ground")),
        "{:?}",
        outcome.end
    );
}

/// At rest on a slope that the resistance holds, and on one that it does not.
#[test]
fn at_rest_wheels_hold_and_roll_back_as_a_whole_vehicle_does() {
    for (slope, rolls) in [(0.05, false), (0.09, true)] {
        let mut model = tractor(Some(both()), FIELD);
        model.terrain = Box::new(Incline(slope));
        let outcome = drive(&model, 1.0, 0.02, vec![Phase::Coast { until: Until::Elapsed(8.0) }]);
        assert_eq!(last(&outcome, "speed_m_s") < 0.0, rolls, "{slope}");
        assert!(outcome.ledger.relative_residual() < 1e-6);
    }
}

/// What the model did, handed back to it as a recording: the force drives it the same way again, and the speed asks the
/// same force and slip of it.
#[test]
fn a_replay_on_wheels_repeats_the_drive() {
    let model = pulling(tractor(Some(both()), FIELD), 12e3);
    let phases = vec![Phase::Reach { speed_m_s: 4.0, acceleration_m_s2: 0.4 }, Phase::Hold { for_s: 4.0 }];
    let original = drive(&model, 1.0, 0.02, phases).trace;
    let again = |drive: Drive| {
        let how = Replay {
            drive,
            also: Vec::new(),
            window_s: None,
            smoothing_s: 0.05,
            step_s: 0.02,
            reversed_from_m: None,
            passes_before: 0,
            follows_brakes: false,
        };
        replay(&model, &original, &how).unwrap()
    };
    let forward = again(Drive::Force);
    let (speed, expected) = (forward.trace.get("speed_m_s").unwrap(), original.get("speed_m_s").unwrap());
    let worst = speed.iter().zip(expected).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
    assert!(worst < 0.02 && forward.ledger.relative_residual() < 1e-6, "{worst}");
    let backward = again(Drive::Speed).trace;
    let middle = original.time_s().iter().position(|time| *time > 9.0).unwrap();
    for channel in ["tractive_force_n", "slip", "axle_2_load_n"] {
        let (found, expected) =
            (backward.get(channel).unwrap()[middle], original.get(channel).unwrap()[middle]);
        assert!((found / expected - 1.0).abs() < 1e-6, "{channel}: {found} {expected}");
    }
}

/// A stop from 12 m/s that wants 9.5 m/s²; nothing drives, there is no air.
fn hard_stop(mut model: Model) -> Outcome {
    model.vehicle.resistance = Resistance::Drag { area_m2: 0.0 };
    drive(&model, 12.0, 0.01, vec![Phase::Reach { speed_m_s: 0.0, acceleration_m_s2: 9.5 }])
}

/// Locked wheels find μ W (1 − e^(−k)) and resist c W: (0.7 (1 − e^(−7.992)) + 0.06) g = 7.453 m/s², and 12² / 2a = 9.661 m.
#[test]
fn brakes_that_want_more_than_the_ground_holds_lock_the_wheels() {
    let outcome = hard_stop(tractor(Some(both()), FIELD));
    assert_eq!(outcome.end, End::Finished);
    let most = (0.7 * -(-8.0f64 * 0.999).exp_m1() + 0.06) * GRAVITY_M_S2;
    let slowing = outcome.trace.get("acceleration_m_s2").unwrap();
    let middle = slowing.len() / 2;
    assert!((-slowing[middle] / most - 1.0).abs() < 1e-9, "{} {most}", slowing[middle]);
    assert!((last(&outcome, "position_m") / (72.0 / most) - 1.0).abs() < 1e-6);
    // What slides takes it all: 10 t · 72 m²/s² less what the ground resists along the way.
    let kinetic_j = MASS_KG * 72.0;
    let slid_j = kinetic_j * (1.0 - 0.06 * GRAVITY_M_S2 / most);
    assert!((account(&outcome, "slip") / slid_j - 1.0).abs() < 1e-6, "{}", account(&outcome, "slip"));
    assert_eq!(account(&outcome, "brakes"), 0.0);
    assert!(outcome.ledger.relative_residual() < 1e-9, "{:?}", outcome.ledger);
    let at = |channel: &str| outcome.trace.get(channel).unwrap()[middle];
    assert_eq!((at("wheel_speed_m_s"), at("axle_1_slip"), at("axle_2_slip")), (0.0, -1.0, -1.0));
    // The load moves forward by m a h / L and a little for the resistance, and traction goes with it.
    assert!(at("axle_1_load_n") > 0.6 * WEIGHT_N + MASS_KG * most * 1.1 / 3.0 - 0.02 * WEIGHT_N);
    let held = at("axle_1_traction_n") + at("axle_2_traction_n");
    assert!((held / (-MASS_KG * most + 0.06 * WEIGHT_N) - 1.0).abs() < 1e-9, "{held}");
}

/// The same where the rear wheels alone are driven: brakes sit on every wheel.
#[test]
fn brakes_hold_the_wheels_that_nothing_drives() {
    let both = hard_stop(tractor(Some(both()), FIELD));
    let rear = hard_stop(tractor(Some(stand(None, Some(1.0))), FIELD));
    let (both, rear) = (last(&both, "position_m"), last(&rear, "position_m"));
    assert!((rear / both - 1.0).abs() < 1e-9, "{rear} {both}");
}

/// A driveline that brakes with 40 kN, and the brakes beside it, find no more than the brakes alone.
#[test]
fn what_the_driveline_brakes_is_not_held_twice() {
    #[derive(Debug)]
    struct Retarder;
    impl Driveline for Retarder {
        fn losses(&self) -> &'static [&'static str] {
            &["retarder"]
        }
        fn source(&self) -> &'static str {
            "store"
        }
        fn rotating_mass_kg(&self, _: bool) -> f64 {
            0.0
        }
        fn deliver(&self, demand: &Demand, _: &[f64], _: &mut [f64]) -> Delivery {
            let force_n = demand.force_n.clamp(-40e3, 0.0);
            let mut losses_w = [0.0; MAX_LOSSES];
            losses_w[0] = -force_n * demand.speed_m_s;
            Delivery { force_n, losses_w, ..Delivery::NOTHING }
        }
    }
    let way_m = |axles: Option<Axles>, friction: f64, soil: Field, retarded: bool| {
        let mut model = tractor(axles, soil);
        model.vehicle.brake_friction = friction;
        if retarded {
            model.driveline = Box::new(Retarder);
        }
        let outcome = hard_stop(model);
        assert!(outcome.ledger.relative_residual() < 1e-6, "{:?}", outcome.ledger);
        last(&outcome, "position_m")
    };
    let firm = Field { firm: true, ..FIELD };
    for (axles, friction, soil) in
        [(Some(both()), f64::INFINITY, FIELD), (Some(both()), 0.6, firm), (None, 0.6, firm)]
    {
        let [alone, beside] = [false, true].map(|retarded| way_m(axles.clone(), friction, soil, retarded));
        assert!((beside / alone - 1.0).abs() < 1e-3, "{alone} {beside}");
    }
}

/// On firm ground a stop takes v² / (2 μ g), with axles and without: what resists the wheels is a part of friction.
#[test]
fn friction_limits_the_brakes_on_ground_that_knows_no_slip() {
    for axles in [Some(both()), None] {
        let mut model = tractor(axles, Field { firm: true, ..FIELD });
        model.vehicle.brake_friction = 0.5;
        let outcome = hard_stop(model);
        let expected = 144.0 / (2.0 * 0.5 * GRAVITY_M_S2);
        assert!((last(&outcome, "position_m") / expected - 1.0).abs() < 1e-6);
        let slowing = outcome.trace.get("acceleration_m_s2").unwrap();
        assert!(slowing.iter().all(|a| *a >= -0.5 * GRAVITY_M_S2 - 1e-9));
        assert!(account(&outcome, "brakes") == 0.0 && account(&outcome, "slip") > 0.0);
        assert!(outcome.ledger.relative_residual() < 1e-9);
    }
    // The least of the two counts where both are known, wheel by wheel.
    let mut model = tractor(Some(both()), FIELD);
    model.vehicle.brake_friction = 0.4;
    let expected = 72.0 / ((0.4 + 0.06) * GRAVITY_M_S2);
    assert!((last(&hard_stop(model), "position_m") / expected - 1.0).abs() < 1e-6);
}

/// Below what the ground holds a limit changes not a bit.
#[test]
fn brakes_that_the_ground_holds_do_as_they_are_told() {
    for (axles, soil) in [(Some(both()), FIELD), (None, Field { firm: true, ..FIELD })] {
        let stop = |friction: f64| {
            let mut model = tractor(axles.clone(), soil);
            model.vehicle.brake_friction = friction;
            let phases = vec![Phase::Reach { speed_m_s: 0.0, acceleration_m_s2: 3.0 }];
            drive(&model, 12.0, 0.01, phases)
        };
        let (free, limited) = (stop(f64::INFINITY), stop(0.9));
        assert_eq!(last(&free, "position_m").to_bits(), last(&limited, "position_m").to_bits());
        assert!(account(&limited, "brakes") == account(&free, "brakes") && account(&free, "brakes") > 1e5);
    }
}

/// At rest on a slope of sin 0.5, tan 0.577: brakes hold it where friction is more than that, and it slides where it is less.
#[test]
fn a_slope_steeper_than_friction_is_slid_down_with_the_brakes_on() {
    for (friction, slides) in [(0.6, false), (0.5, true)] {
        let mut model = tractor(None, Field { firm: true, coefficient: 0.05, ..FIELD });
        model.vehicle.resistance = Resistance::Drag { area_m2: 0.0 };
        model.vehicle.brake_friction = friction;
        model.terrain = Box::new(Incline(0.5));
        model.driveline = Box::new(Motor { most_n: 0.0, most_w: 0.0 });
        let outcome = drive(&model, 0.0, 0.01, vec![Phase::Stand { until: Until::Elapsed(2.0) }]);
        let speed = last(&outcome, "speed_m_s");
        if slides {
            let expected = -(0.5 - 0.5 * 0.75f64.sqrt()) * GRAVITY_M_S2 * 2.0;
            assert!((speed / expected - 1.0).abs() < 1e-9, "{speed} {expected}");
            assert!(outcome.ledger.relative_residual() < 1e-9);
        } else {
            assert_eq!((speed, last(&outcome, "position_m")), (0.0, 0.0));
            // What holds at rest is no force of sliding wheels.
            assert!(outcome.trace.get("brake_force_n").is_none());
        }
    }
}

/// A recording that stopped harder than the ground of the model holds did stop so.
#[test]
fn a_recorded_stop_is_not_held_against_friction() {
    let firm = Field { firm: true, ..FIELD };
    let stop = drive(
        &tractor(None, firm),
        12.0,
        0.02,
        vec![Phase::Hold { for_s: 1.0 }, Phase::Reach { speed_m_s: 2.0, acceleration_m_s2: 4.0 }],
    );
    let braked = |friction: f64| {
        let mut model = tractor(None, firm);
        model.vehicle.brake_friction = friction;
        let how = Replay {
            drive: Drive::Speed,
            also: Vec::new(),
            window_s: None,
            smoothing_s: 0.05,
            step_s: 0.02,
            reversed_from_m: None,
            passes_before: 0,
            follows_brakes: false,
        };
        let again = replay(&model, &stop.trace, &how).unwrap();
        again.trace.get("brake_force_n").unwrap().to_vec()
    };
    let (free, limited) = (braked(f64::INFINITY), braked(0.1));
    assert!(free.iter().any(|force| *force > 0.2 * WEIGHT_N) && free == limited);
}
