use super::*;
use crate::schema::{Charge, Electricity, Fuel};
use headland_sim::{Entry, Ledger};
use headland_trace::Origin;

fn accounting() -> Accounting {
    Accounting {
        fuel: Some(Fuel { density_kg_m3: 835.0, co2_kg_per_kg: 3.0 }),
        electricity: Some(Electricity { co2_kg_j: 1e-7 }),
        charge: Some(Charge { charging_efficiency: 0.8, discharging_efficiency: 0.9 }),
    }
}

fn outcome(channels: &[(&str, Vec<f64>)], source: &str, accounts: &[(&str, f64)]) -> Outcome {
    let mut trace = Trace::new(vec![0.0, 10.0, 30.0]).unwrap();
    for (name, values) in channels {
        trace.push(*name, values.clone(), Origin::Predicted).unwrap();
    }
    let sinks = accounts
        .iter()
        .map(|(name, energy_j)| Entry { name: (*name).to_owned(), energy_j: *energy_j })
        .collect();
    let ledger =
        Ledger { source_name: source.to_owned(), source_j: 5e6, kinetic_j: 0.0, sinks, residual_j: 1e-3 };
    Outcome { trace, ledger, end: End::Finished, steps: 2, phases: Vec::new() }
}

/// Rates 0.001, 0.003, 0.002 kg/s: 10·0.002 + 20·0.0025 = 0.07 kg. Shaft: 200 rad/s times 100, 300, 200 N m: 1.4 MJ.
#[test]
fn fuel_and_shaft_work_by_hand() {
    let run = outcome(
        &[
            ("fuel_rate_kg_s", vec![0.001, 0.003, 0.002]),
            ("engine_torque_n_m", vec![100.0, 300.0, 200.0]),
            ("engine_speed_rad_s", vec![200.0; 3]),
            ("position_m", vec![5.0, 45.0, 25.0]),
            ("speed_m_s", vec![1.0, 4.0, 2.0]),
            ("plough_area_m2", vec![0.0, 80.0, 80.0]),
        ],
        "fuel",
        &[("soil", 1e6), ("power take-off", 2e6)],
    );
    let row = Row::of(4, &run, &accounting());
    for (name, expected) in [
        ("fuel_kg", 0.07),
        ("fuel_at_charge_kg", 0.07),
        ("co2_kg", 0.21),
        ("engine_work_j", 1.4e6),
        ("distance_m", 60.0),
        ("area_worked_m2", 80.0),
        ("time_s", 30.0),
        ("energy_from_fuel_j", 5e6),
        ("energy_power_take_off_j", 2e6),
    ] {
        assert!((row.value(name) - expected).abs() < 1e-12 * expected.abs(), "{name}: {}", row.value(name));
    }
    assert!(row.value("electricity_j").is_nan() && row.value("state_of_charge_end").is_nan());
}

/// The store gave 0.1 MJ: the engine needs 0.1/0.8 MJ more at 0.07 kg / 1.4 MJ, 6.25 g. Where it gained, 0.9·0.1 MJ less.
#[test]
fn fuel_is_told_at_the_charge_that_the_run_began_with() {
    for (gained, expected) in [(-1e5, 0.07 + 0.00625), (1e5, 0.07 - 0.0045)] {
        let run = outcome(
            &[
                ("fuel_rate_kg_s", vec![0.001, 0.003, 0.002]),
                ("engine_torque_n_m", vec![100.0, 300.0, 200.0]),
                ("engine_speed_rad_s", vec![200.0; 3]),
                ("state_of_charge", vec![0.6, 0.7, 0.5]),
            ],
            "fuel",
            &[("battery", 50.0), ("battery charge", gained)],
        );
        let row = Row::of(0, &run, &accounting());
        assert!((row.value("fuel_at_charge_kg") - expected).abs() < 1e-12, "{gained}");
        assert_eq!(row.value("electricity_j"), -gained);
        assert_eq!((row.value("state_of_charge_start"), row.value("state_of_charge_end")), (0.6, 0.5));
        let without = Row::of(0, &run, &Accounting { charge: None, ..accounting() });
        assert!(without.value("fuel_at_charge_kg").is_nan(), "nobody said how to make up for it");
    }
}

#[test]
fn a_battery_alone_has_electricity_and_no_fuel() {
    let row = Row::of(0, &outcome(&[], "battery", &[]), &accounting());
    assert_eq!((row.value("electricity_j"), row.value("co2_kg")), (5e6, 0.5));
    assert!(row.value("fuel_kg").is_nan() && row.value("fuel_at_charge_kg").is_nan());
}

#[test]
fn columns_of_accounts_lead_back_to_them() {
    assert_eq!(account_column("power take-off"), "energy_power_take_off_j");
    assert_eq!(account_of_column("energy_power_take_off_j").as_deref(), Some("power take off"));
    assert_eq!(account_of_column("electricity_j"), None);
}
