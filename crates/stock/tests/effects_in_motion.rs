//! Every effect that is built in, in a whole vehicle: driven forward, and handed its own drive as a recording.

use headland_plugin::Air;
use headland_sim::{
    Cycle, Drive, End, Inputs, Model, Named, Outcome, Phase, Replay, Resistance, Start, Until, Vehicle,
    replay, simulate,
};
use headland_stock::registry;
use std::path::Path;

const ENGINE: (&str, &str) = (
    "EngineCvt",
    "(displacement_m3: 0.0093, willans_efficiency: 0.42, willans_friction_pa: 1.8e5, \
      lower_heating_value_j_kg: 42.8e6, \
      full_load: [(speed_rad_s: 84.0, torque_n_m: 900.0), (speed_rad_s: 150.0, torque_n_m: 1570.0), \
                  (speed_rad_s: 220.0, torque_n_m: 1110.0)], \
      idle_speed_rad_s: 84.0, load_share: 0.9, transmission_efficiency: 0.85, max_force_n: 1e5, \
      accessory_power_w: 8e3, alternator_efficiency: 0.6, wheel_radius_m: 0.95, rotating_mass_kg: 500.0)",
);

const BATTERY: (&str, &str) = (
    "ElectricSingleSpeed",
    "(open_circuit_voltage_v: 360.0, resistance_ohm: 0.12, capacity_a_h: 60.0, initial_state_of_charge: 0.8, \
      max_torque_n_m: 250.0, max_regeneration_torque_n_m: 150.0, max_power_w: 125e3, gear_ratio: 9.665, \
      wheel_radius_m: 0.35, drive_efficiency: 0.9, standby_power_w: 200.0, rotating_mass_kg: 60.0)",
);

/// Each effect with parameters that show, and a channel in which they show: on the car, or on the tractor.
const EFFECTS: [(&str, &str, &str); 42] = [
    ("wind", "(speed_m_s: 4.0, from_rad: 0.5)", "tractive_force_n"),
    ("grade", "(positions_m: [0.0, 40.0, 90.0], grades: [0.0, 0.03, -0.01])", "tractive_force_n"),
    ("grade_constant", "(grade: 0.02)", "tractive_force_n"),
    ("rotating_inertia", "(rotating_mass_kg: 60.0)", "tractive_force_n"),
    ("mass", "(extra_mass_kg: 160.0)", "tractive_force_n"),
    ("payload_change", "(times_s: [0.0, 30.0], masses_kg: [200.0, 0.0])", "tractive_force_n"),
    ("aerodynamic_drag", "(extra_area_m2: 0.4)", "tractive_force_n"),
    ("rolling_resistance", "(coefficient: 0.004)", "tractive_force_n"),
    ("rolling_speed_law", "(linear: 0.002, quadratic: 0.001, reference_speed_m_s: 5.0)", "tractive_force_n"),
    ("rolling_temperature", "(cold_coefficient: 0.004, time_constant_s: 30.0)", "tractive_force_n"),
    ("soft_ground", "(positions_m: [20.0, 60.0, 80.0], coefficients: [0.03, 0.01])", "tractive_force_n"),
    ("multipass", "(coefficient: 0.008, factor: 0.8, lap_length_m: 40.0)", "tractive_force_n"),
    ("neutral_drag", "(force_n: 60.0, viscous_n_s_m: 5.0)", "position_m"),
    (
        "driveline_temperature",
        "(cold_force_n: 40.0, cold_viscous_n_s_m: 5.0, time_constant_s: 20.0)",
        "tractive_force_n",
    ),
    ("brake_drag", "(force_n: 50.0)", "tractive_force_n"),
    ("braking", "(times_s: [6.0, 9.0], forces_n: [400.0])", "tractive_force_n"),
    ("cornering_drag", "(cornering_stiffness_n_per_rad: 8e4)", ""),
    ("side_slope", "(cornering_stiffness_n_per_rad: 8e4, slip_coefficient: 0.3)", ""),
    ("roughness", "(time_constant_s: 0.02, vertical_acceleration_m_s2: 2.0)", "tractive_force_n"),
    ("load_dependence", "(coefficient: 0.012, exponent: 0.9, reference_mass_kg: 900.0)", "tractive_force_n"),
    ("drawbar_load", "(force_n: 300.0, quadratic_n_s2_m2: 2.0, from_s: 4.0, to_s: 12.0)", "tractive_force_n"),
    ("speed_threshold", "(force_n: 120.0, threshold_m_s: 4.0, width_m_s: 2.0)", "tractive_force_n"),
    ("wheel_slip", "(coefficient: 0.2)", "wheel_speed_m_s"),
    ("driveline_efficiency", "(loss: 0.08)", "tractive_force_n"),
    ("variator_loss", "(loss: 0.2, node_speeds_m_s: [3.0, 7.0])", "tractive_force_n"),
    ("shift_transient", "(force_n: 300.0, speeds_m_s: [3.0], width_m_s: 0.3)", "tractive_force_n"),
    // Upstream of the force that is told: what drives gives more.
    ("driveline_efficiency", "(loss: 0.08, upstream: true)", "battery_current_a"),
    ("variator_loss", "(loss: 0.2, node_speeds_m_s: [3.0, 7.0], upstream: true)", "battery_current_a"),
    (
        "shift_transient",
        "(force_n: 300.0, speeds_m_s: [3.0], width_m_s: 0.3, upstream: true)",
        "battery_current_a",
    ),
    ("auxiliary_power", "(power_w: 300.0, times_s: [5.0, 15.0], powers_w: [3000.0])", "battery_current_a"),
    ("engine_friction", "(torque_n_m: 30.0)", "fuel_rate_kg_s"),
    ("turbo_lag", "(time_constant_s: 1.0, unboosted_power_w: 30e3)", "tractive_force_n"),
    ("cold_start", "(cold_torque_n_m: 40.0, time_constant_s: 10.0)", "fuel_rate_kg_s"),
    ("regeneration_limit", "(power_w: 2000.0)", "brake_force_n"),
    ("battery_resistance", "(resistance_ohm: 0.1)", "battery_voltage_v"),
    (
        "expression",
        "(resistance: \"c * N * tanh(v / v0_m_s)\", auxiliary_power: \"300 * one_w * (v > v0_m_s)\", \
          constants: {\"c\": 0.01, \"v0_m_s\": 2.0, \"one_w\": 1.0})",
        "tractive_force_n",
    ),
    (
        "expression",
        "(auxiliary_power: \"p_w * (F_drive / f1_n)^2\", constants: {\"p_w\": 1000.0, \"f1_n\": 5000.0})",
        "battery_current_a",
    ),
    (
        "expression",
        "(auxiliary_power: \"p_w * (state_of_charge - s)\", constants: {\"p_w\": 1000.0, \"s\": 0.3})",
        "battery_current_a",
    ),
    (
        "expression",
        "(resistance: \"f_n * latched(v, on_m_s, off_m_s)\", \
          constants: {\"f_n\": 150.0, \"on_m_s\": 5.0, \"off_m_s\": 2.0})",
        "tractive_force_n",
    ),
    (
        "expression",
        "(resistance: \"f_n * exp(-way / l_m)\", constants: {\"f_n\": 150.0, \"l_m\": 40.0})",
        "tractive_force_n",
    ),
    (
        "expression",
        "(resistance: \"c_n_s_per_m * lagged(v, lag_s)\", constants: {\"c_n_s_per_m\": 20.0, \"lag_s\": 4.0})",
        "tractive_force_n",
    ),
    (
        "expression",
        "(auxiliary_power: \"p_w * lagged((F_drive / f1_n)^2, lag_s)\", \
          constants: {\"p_w\": 1000.0, \"f1_n\": 5000.0, \"lag_s\": 4.0})",
        "battery_current_a",
    ),
];

fn needs_engine(effect: &str) -> bool {
    ["engine_friction", "turbo_lag", "cold_start"].contains(&effect)
}

fn model(engine: bool, effects: &[(&str, &str)]) -> Model {
    let (registry, folder) = (registry(), Path::new("."));
    let (driveline, parameters) = if engine { ENGINE } else { BATTERY };
    Model {
        vehicle: Vehicle {
            mass_kg: if engine { 13_000.0 } else { 1300.0 },
            rotating_mass_kg: 20.0,
            resistance: Resistance::Drag { area_m2: if engine { 6.0 } else { 0.7 } },
            brake_friction: f64::INFINITY,
        },
        gravity_m_s2: 9.81,
        air: Air { density_kg_m3: 1.2, wind_speed_m_s: 0.0, wind_from_rad: 0.0, temperature_c: 5.0 },
        terrain: registry
            .terrains
            .build("ConstantGrade", "(grade: 0.005, heading_rad: 0.3)", folder)
            .unwrap(),
        axles: None,
        soil: Some(registry.soils.build("Constant", "(coefficient: 0.02)", folder).unwrap()),
        driveline: registry.drivelines.build(driveline, parameters, folder).unwrap(),
        tasks: Vec::new(),
        effects: effects
            .iter()
            .enumerate()
            .map(|(place, (name, parameters))| Named {
                // A second one of a name has a name of its own, as in a scenario.
                name: match effects[..place].iter().filter(|(other, _)| other == name).count() {
                    0 => (*name).to_owned(),
                    before => format!("{name}_{}", before + 1),
                },
                plugin: registry.effects.build(name, parameters, folder).unwrap(),
            })
            .collect(),
    }
}

/// Speeds up, holds, slows down with the drive and the brakes, and coasts to a stop.
fn drive(model: &Model) -> Outcome {
    let phases = vec![
        Phase::Reach { speed_m_s: 7.0, acceleration_m_s2: 1.0 },
        Phase::Hold { for_s: 5.0 },
        Phase::Reach { speed_m_s: 4.0, acceleration_m_s2: 1.5 },
        Phase::Hold { for_s: 3.0 },
        Phase::Coast { until: Until::Stopped },
    ];
    let start = Start { position_m: 0.0, speed_m_s: 0.5 };
    let cycle = Cycle { start, phases, driver_gain_per_s: 1.0, step_s: 0.01, longest_s: 300.0 };
    simulate(model, &cycle).unwrap()
}

/// Value of a channel at a time; 0 where the channel was left out.
fn at_time(outcome: &Outcome, channel: &str, time_s: f64) -> f64 {
    let trace = &outcome.trace;
    let index = trace.time_s().partition_point(|time| *time < time_s - 1e-9);
    trace.get(channel).map_or(0.0, |values| values[index.min(values.len() - 1)])
}

#[test]
fn every_effect_drives_changes_something_and_closes_the_ledger() {
    for (name, parameters, channel) in EFFECTS {
        let engine = needs_engine(name);
        let (with, without) = (drive(&model(engine, &[(name, parameters)])), drive(&model(engine, &[])));
        assert_eq!(with.end, End::Finished, "{name}");
        assert!(with.ledger.relative_residual() < 1e-5, "{name}: {:?}", with.ledger);
        let changed = (0..400).map(|step| 0.05 * f64::from(step)).any(|time_s| {
            let (one, other) = (at_time(&with, channel, time_s), at_time(&without, channel, time_s));
            (one - other).abs() > 1e-3 * other.abs().max(1e-4)
        });
        // A straight path up a slope has no corner and lies level across; the effects' own tests have both.
        assert_eq!(changed, !channel.is_empty(), "{name}: {channel}");
    }
}

#[test]
fn what_an_effect_did_is_found_again_from_the_speed_that_it_left() {
    let how = Replay {
        drive: Drive::Speed,
        also: Vec::new(),
        window_s: None,
        smoothing_s: 0.021,
        step_s: 0.01,
        reversed_from_m: None,
        passes_before: 0,
        follows_brakes: false,
    };
    for (name, parameters, channel) in EFFECTS {
        if channel.is_empty() || name == "neutral_drag" {
            continue;
        }
        let model = model(needs_engine(name), &[(name, parameters)]);
        let original = drive(&model);
        let replayed = replay(&model, &original.trace, &how).unwrap();
        // In the middle of a phase without edges of intervals.
        let time_s = 3.2;
        let (one, other) = (at_time(&original, channel, time_s), at_time(&replayed, channel, time_s));
        assert!((one - other).abs() <= 2e-3 * one.abs().max(1e-3), "{name}: {channel} is {other}, was {one}");
    }
}

#[test]
fn what_an_effect_did_is_found_again_from_the_force_that_it_took() {
    let how = Replay {
        drive: Drive::Force,
        also: vec![Inputs::Coasting],
        window_s: None,
        smoothing_s: 0.021,
        step_s: 0.01,
        reversed_from_m: None,
        passes_before: 0,
        follows_brakes: false,
    };
    for (name, parameters, channel) in EFFECTS {
        if channel.is_empty() {
            continue;
        }
        let model = model(needs_engine(name), &[(name, parameters)]);
        let original = drive(&model);
        let replayed = replay(&model, &original.trace, &how).unwrap();
        // The force of the brakes is not that of the wheels: once they were used, the replay is faster.
        let braked = original.trace.get("brake_force_n").is_some();
        let late_s = if braked { 6.5 } else { original.trace.duration_s() - 2.0 };
        for time_s in [3.2, 6.5, late_s] {
            let (one, other) =
                (at_time(&original, "speed_m_s", time_s), at_time(&replayed, "speed_m_s", time_s));
            assert!((one - other).abs() < 0.02, "{name} at {time_s} s: {other} m/s, was {one}");
        }
    }
}

/// Whatever power the tasks of the model would take, one that was recorded is all that is taken there: the fuel is that of the drive in
/// which tasks took as much.
#[test]
fn powers_that_were_recorded_stand_in_the_place_of_what_tasks_take() {
    let with_tasks = |powers_w: [f64; 2]| {
        let (registry, mut model) = (registry(), model(true, &[]));
        for (name, power_w) in ["PtoPower", "Hydraulic"].into_iter().zip(powers_w) {
            let plugin =
                registry.tasks.build(name, &format!("(power_w: {power_w:?})"), Path::new(".")).unwrap();
            model.tasks.push(Named { name: name.to_owned(), plugin });
        }
        model
    };
    let original = drive(&with_tasks([25e3, 9e3]));
    let burnt = |model: &Model, also: Vec<Inputs>| {
        let how = Replay {
            drive: Drive::Speed,
            also,
            window_s: None,
            smoothing_s: 0.021,
            step_s: 0.01,
            reversed_from_m: None,
            passes_before: 0,
            follows_brakes: false,
        };
        at_time(&replay(model, &original.trace, &how).unwrap(), "fuel_rate_kg_s", 3.2)
    };
    let took = at_time(&original, "fuel_rate_kg_s", 3.2);
    let told = vec![Inputs::PtoPower, Inputs::HydraulicPower];
    for others in [with_tasks([4e3, 5e3]), model(true, &[])] {
        assert!((burnt(&others, told.clone()) / took - 1.0).abs() < 1e-3, "{took}");
        assert!((burnt(&others, Vec::new()) / took - 1.0).abs() > 0.02, "{took}");
    }
}

#[test]
fn all_effects_at_once_close_the_ledger() {
    for engine in [false, true] {
        let all: Vec<(&str, &str)> = EFFECTS
            .iter()
            .filter(|(name, parameters, _)| {
                // A tractor has no charge that a consumer could follow.
                *name != "turbo_lag" && !(engine && parameters.contains("state_of_charge"))
            })
            .map(|(name, parameters, _)| (*name, *parameters))
            .collect();
        let outcome = drive(&model(engine, &all));
        assert_eq!(outcome.end, End::Finished);
        assert!(outcome.ledger.relative_residual() < 1e-5, "{:?}", outcome.ledger);
    }
}

/// The path climbs at 0.005 everywhere and by 0.04 more beyond 50 m; driven from its end, both fall.
#[test]
fn a_run_against_the_path_meets_its_slopes_from_the_other_end() {
    let effect = ("grade", "(positions_m: [50.0, 50.1], grades: [0.0, 0.04])");
    let model = model(false, &[effect]);
    let original = drive(&model);
    let how = Replay {
        drive: Drive::Speed,
        also: Vec::new(),
        window_s: None,
        smoothing_s: 0.021,
        step_s: 0.01,
        reversed_from_m: Some(90.0),
        passes_before: 0,
        follows_brakes: false,
    };
    let back = replay(&model, &original.trace, &how).unwrap();
    let (early_s, late_s) = (3.2, 11.0);
    let position = |time_s: f64| at_time(&back, "position_m", time_s);
    assert!((position(early_s) + at_time(&original, "position_m", early_s) - 90.0).abs() < 0.05);
    assert!(
        position(early_s) > 50.1 && position(late_s) < 50.0,
        "{} {}",
        position(early_s),
        position(late_s)
    );
    let weight_n = 1300.0 * 9.81;
    let slope_n = at_time(&back, "slope_resistance_n", early_s);
    assert!((slope_n / (-0.005 * weight_n) - 1.0).abs() < 1e-4, "{slope_n}");
    let effect_n = at_time(&back, "grade_n", early_s);
    assert!((effect_n / (0.04 * weight_n) - 1.0).abs() < 2e-3, "{effect_n}");
    assert_eq!(at_time(&back, "grade_n", late_s), 0.0);
}

/// The simulation ends with its reason, at the time when the root of a negative number is asked for.
#[test]
fn a_formula_without_a_value_stops_the_simulation() {
    for formula in ["resistance", "force"] {
        let parameters = format!(
            "({formula}: \"f_n * sqrt(1 - t / end_s)\", constants: {{\"f_n\": 50.0, \"end_s\": 4.0}})"
        );
        let outcome = drive(&model(false, &[("expression", &parameters)]));
        let End::Stopped { time_s, reason, .. } = &outcome.end else {
            panic!("{formula}: {:?}", outcome.end)
        };
        assert!((time_s - 4.0).abs() < 0.02 && reason.contains("not a finite number"), "{formula}: {reason}");
    }
}

/// The drive cannot give what is not known, so a run that needs it does not finish.
#[test]
fn a_power_without_a_value_leaves_no_drive() {
    for (formula, engine) in [("auxiliary_power", false), ("shaft_power", true)] {
        let parameters = format!(
            "({formula}: \"f_w * sqrt(1 - t / end_s)\", constants: {{\"f_w\": 50.0, \"end_s\": 4.0}})"
        );
        let outcome = drive(&model(engine, &[("expression", &parameters)]));
        let End::Stopped { time_s, .. } = &outcome.end else { panic!("{formula}: {:?}", outcome.end) };
        assert!((time_s - 4.0).abs() < 0.02, "{formula}: {:?}", outcome.end);
    }
}
