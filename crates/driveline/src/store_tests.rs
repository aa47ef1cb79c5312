use super::*;
use proptest::prelude::*;

/// The battery that the tests of drivelines share: 18 kWh at some 700 V.
pub(crate) const TEXT: &str = "(open_circuit: [(charge: 0, voltage_v: 616), (charge: 0.1, voltage_v: 704), \
    (charge: 0.9, voltage_v: 735), (charge: 1, voltage_v: 759)], resistance_ohm: 0.12, capacity_a_h: 25, \
    initial_charge: 0.6, least_charge: 0.2, most_charge: 0.9, max_discharge_a: 250, max_charge_a: 150, \
    least_voltage_v: 560, most_voltage_v: 780)";

pub(crate) const SUPERCAPACITOR_TEXT: &str = "(capacitance_f: 20, max_voltage_v: 700, resistance_ohm: 0.05, \
    initial_charge: 0.9, least_charge: 0.5, most_charge: 1, max_current_a: 400)";

fn battery(text: &str) -> Result<Store, Refusal> {
    let file: BatteryFile = ron::from_str(text).unwrap();
    Store::new(Some(&file), None)
}

fn supercapacitor() -> Store {
    let file: SupercapacitorFile = ron::from_str(SUPERCAPACITOR_TEXT).unwrap();
    Store::new(None, Some(&file)).unwrap()
}

/// U(0.5) = 719.5 V. 100 A give 719.5 · 100 − 0.12 · 10 000 = 70 750 W; dS/dt = −100 / 90 000.
#[test]
fn a_hundred_amperes_by_hand() {
    let drawn = battery(TEXT).unwrap().draw(70_750.0, 0.5, 0.0);
    assert!((drawn.current_a - 100.0).abs() < 1e-9 && (drawn.loss_w - 1200.0).abs() < 1e-6);
    assert!((drawn.voltage_v - 707.5).abs() < 1e-9 && (drawn.store_w - 71_950.0).abs() < 1e-6);
    assert!((drawn.charge_per_s + 100.0 / 90_000.0).abs() < 1e-12);
}

/// 250 A out and 150 A in are the limits in the middle; at the ends of the window there is nothing.
#[test]
fn power_is_limited_by_current_and_charge() {
    let store = battery(TEXT).unwrap();
    let (out, into) = store.most_w(0.5, 0.0);
    assert!((out - (719.5 - 30.0) * 250.0).abs() < 1e-6 && (into - (719.5 + 18.0) * 150.0).abs() < 1e-6);
    assert_eq!(store.most_w(0.2, 0.0).0, 0.0);
    assert_eq!(store.most_w(0.9, 0.0).1, 0.0);
    // Half the taper, half the current.
    let (u, half) = (store.open_v(0.205), 125.0);
    assert!((store.most_w(0.205, 0.0).0 - (u - 0.12 * half) * half).abs() < 1e-6);
}

/// A resistance of 2 Ω more ends at the least voltage: (719.5 − 560) / 2.12 A at 560 V.
#[test]
fn power_is_limited_by_voltage() {
    let (out, _) = battery(TEXT).unwrap().most_w(0.5, 2.0);
    assert!((out - 560.0 * 159.5 / 2.12).abs() < 1e-6, "{out}");
}

/// ½ C (U₁² − U₂²) = 10 · (490 000 − 122 500) J between full and half.
#[test]
fn a_supercapacitor_holds_half_c_u_squared() {
    let store = supercapacitor();
    assert!((store.energy_j(1.0) - store.energy_j(0.5) - 3.675e6).abs() < 1e-3);
    // dU/dt = −I / C: 100 A empty 5 V a second, 1/140 of the charge.
    let power = 630.0 * 100.0 - 0.05 * 1e4;
    assert!((store.draw(power, 0.9, 0.0).charge_per_s + 1.0 / 140.0).abs() < 1e-12);
}

/// 735 V at the 0.9 that it is charged to; 704 + (0.18 / 0.8) 31 = 710.975 V at 0.28, the least that it is discharged to.
#[test]
fn limits_of_voltage_that_let_no_current_flow_are_refused() {
    let refused =
        |from: &str, to: &str| battery(&TEXT.replace(from, to)).map(|_| ()).map_err(|told| told.to_string());
    let told = refused("least_voltage_v: 560", "least_voltage_v: 735").unwrap_err();
    assert!(told.starts_with("`battery.least_voltage_v` is 735 V, expected less than 735.0 V"), "{told}");
    assert_eq!(refused("least_voltage_v: 560", "least_voltage_v: 734.9"), Ok(()));
    let low = |most_v: &str| {
        let text = TEXT.replace("least_charge: 0.2", "least_charge: 0.28");
        battery(&text.replace("most_voltage_v: 780", &format!("most_voltage_v: {most_v}"))).map(|_| ())
    };
    let told = low("710.9").unwrap_err().to_string();
    assert!(told.starts_with("`battery.most_voltage_v` is 710.9 V, expected more than 711.0 V"), "{told}");
    assert_eq!(low("711.1"), Ok(()));
}

#[test]
fn what_cannot_be_is_refused_by_its_full_name() {
    let refused = |from: &str, to: &str| battery(&TEXT.replace(from, to)).unwrap_err().to_string();
    assert!(
        refused("initial_charge: 0.6", "initial_charge: 0.1").starts_with("`battery.initial_charge` is 0.1")
    );
    assert!(refused("least_charge: 0.2", "least_charge: 0.95").contains("most_charge"));
    assert!(refused("voltage_v: 735", "voltage_v: 600").contains("do not fall"));
    assert!(refused("(charge: 1, voltage_v: 759)", "(charge: 0.95, voltage_v: 759)").contains("from 0 to 1"));
    assert!(refused("least_voltage_v: 560", "least_voltage_v: 800").contains("most_voltage_v"));
    assert!(Store::new(None, None).unwrap_err().to_string().contains("supercapacitor"));
}

proptest! {
    /// What goes out of the store is what its terminals give and its resistance takes.
    #[test]
    fn powers_balance(power_w in -2e5f64..3e6, charge in 0.0f64..1.0) {
        for store in [battery(TEXT).unwrap(), supercapacitor()] {
            let drawn = store.draw(power_w, charge, 0.0);
            prop_assert!((drawn.store_w - power_w - drawn.loss_w).abs() < 1e-6 + 1e-9 * power_w.abs());
            let (out, into) = store.most_w(charge, 0.0);
            prop_assert!(out >= 0.0 && into >= 0.0);
        }
    }

    /// What was drawn is what the stored energy fell by.
    #[test]
    fn energy_and_charge_agree(from in 0.0f64..1.0, to in 0.0f64..1.0) {
        let store = battery(TEXT).unwrap();
        let steps = 2000;
        let sum: f64 = (0..steps)
            .map(|i| store.open_v(from + (to - from) * (f64::from(i) + 0.5) / f64::from(steps)))
            .sum();
        let expected = sum / f64::from(steps) * (to - from) * 90_000.0;
        prop_assert!((store.energy_j(to) - store.energy_j(from) - expected).abs() < 1e-4 * 90_000.0 * 700.0);
    }
}
