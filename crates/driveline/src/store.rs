//! A battery or a supercapacitor: an open-circuit voltage by charge behind a resistance, with limits.
//!
//! P = U I − R I²,   I = (U − √(U² − 4 R P)) / (2 R),   dS/dt = −I / (3600 Q),   U = U(S)
//! I ≤ I_max, (U − U_min) / R, U / 2R;   −I ≤ I_max,c, (U_max − U) / R
//! supercapacitor: U = U_max S, 3600 Q = C U_max
//!
//! Source: Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), sections 4.5 and 4.6 (internal-resistance model).
//!
//! U(S) is straight between its points. Towards the ends of the window of charge the currents fall to nothing over the last
//! hundredth. Leaves out temperature, charge that is lost in the cell, and ageing.

use crate::parts::{hold, increasing, place, refuse, tapered};
use headland_plugin::{Bound, Parameter, Refusal, parameter};
use serde::Deserialize;

const S_PER_H: f64 = 3600.0;

/// The charge over which the current falls at the ends of the window, so that the limit has no step.
const TAPER: f64 = 0.01;

/// How a battery's parameters are told.
pub(crate) const BATTERY: [Parameter; 10] = [
    parameter(
        "battery.open_circuit",
        "[(charge, voltage_v)]",
        "open-circuit voltage by charge from 0 to 1, U",
    ),
    parameter("battery.resistance_ohm", "ohm", "of the whole battery, R")
        .must_be(Bound::Positive)
        .usually(1e-3, 1.0),
    parameter("battery.capacity_a_h", "A h", "from empty to full, Q")
        .must_be(Bound::Positive)
        .usually(1.0, 2000.0),
    parameter("battery.initial_charge", "1", "at the start of a run, S")
        .must_be(Bound::Within(0.0, 1.0))
        .usually(0.1, 1.0),
    parameter("battery.least_charge", "1", "it is discharged to this")
        .must_be(Bound::Within(0.0, 1.0))
        .usually(0.0, 0.6),
    parameter("battery.most_charge", "1", "it is charged to this")
        .must_be(Bound::Within(0.0, 1.0))
        .usually(0.5, 1.0),
    parameter("battery.max_discharge_a", "A", "greatest current out, I_max")
        .must_be(Bound::Positive)
        .usually(5.0, 3000.0),
    parameter("battery.max_charge_a", "A", "greatest current in, I_max,c")
        .must_be(Bound::Positive)
        .usually(5.0, 3000.0),
    parameter("battery.least_voltage_v", "V", "at the terminals, U_min")
        .must_be(Bound::Positive)
        .usually(10.0, 1200.0),
    parameter("battery.most_voltage_v", "V", "at the terminals, U_max")
        .must_be(Bound::Positive)
        .usually(10.0, 1200.0),
];

/// How a supercapacitor's parameters are told.
pub(crate) const SUPERCAPACITOR: [Parameter; 7] = [
    parameter("supercapacitor.capacitance_f", "F", "C, instead of a battery")
        .must_be(Bound::Positive)
        .usually(1.0, 1000.0),
    parameter("supercapacitor.max_voltage_v", "V", "at full charge, U_max")
        .must_be(Bound::Positive)
        .usually(10.0, 1200.0),
    parameter("supercapacitor.resistance_ohm", "ohm", "in series, R")
        .must_be(Bound::Positive)
        .usually(1e-3, 1.0),
    parameter("supercapacitor.initial_charge", "1", "at the start of a run, S = U / U_max")
        .must_be(Bound::Within(0.0, 1.0))
        .usually(0.5, 1.0),
    parameter(
        "supercapacitor.least_charge",
        "1",
        "it is discharged to this; half leaves three quarters of the energy",
    )
    .must_be(Bound::Within(0.0, 1.0))
    .usually(0.2, 0.7),
    parameter("supercapacitor.most_charge", "1", "it is charged to this")
        .must_be(Bound::Within(0.0, 1.0))
        .usually(0.8, 1.0),
    parameter("supercapacitor.max_current_a", "A", "greatest current, out and in")
        .must_be(Bound::Positive)
        .usually(5.0, 3000.0),
];

/// A point of the open-circuit voltage as scenarios write it.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct OpenCircuit {
    charge: f64,
    voltage_v: f64,
}

/// A battery as scenarios write it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "battery")]
pub(crate) struct BatteryFile {
    open_circuit: Vec<OpenCircuit>,
    resistance_ohm: f64,
    capacity_a_h: f64,
    initial_charge: f64,
    least_charge: f64,
    most_charge: f64,
    max_discharge_a: f64,
    max_charge_a: f64,
    least_voltage_v: f64,
    most_voltage_v: f64,
}

/// A supercapacitor as scenarios write it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "supercapacitor")]
pub(crate) struct SupercapacitorFile {
    capacitance_f: f64,
    max_voltage_v: f64,
    resistance_ohm: f64,
    initial_charge: f64,
    least_charge: f64,
    most_charge: f64,
    max_current_a: f64,
}

/// What a store does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Drawn {
    /// Power out of the store before its resistance; negative while it is charged.
    pub store_w: f64,
    pub loss_w: f64,
    pub current_a: f64,
    pub voltage_v: f64,
    /// Rate of the charge [1/s].
    pub charge_per_s: f64,
}

/// What stands behind the terminals: the open-circuit voltage [V] and the resistance [ohm].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Behind {
    u: f64,
    r: f64,
}

/// A store of electric energy.
#[derive(Clone, Debug, Default)]
pub(crate) struct Store {
    charges: Vec<f64>,
    voltages: Vec<f64>,
    resistance_ohm: f64,
    capacity_a_s: f64,
    pub initial: f64,
    pub window: (f64, f64),
    pub is_supercapacitor: bool,
    max_out_a: f64,
    max_in_a: f64,
    voltage_window: (f64, f64),
}

impl Store {
    /// From one of the two.
    ///
    /// # Errors
    /// [`Refusal`] by the full name of the parameter.
    pub(crate) fn new(
        battery: Option<&BatteryFile>,
        supercapacitor: Option<&SupercapacitorFile>,
    ) -> Result<Self, Refusal> {
        match (battery, supercapacitor) {
            (Some(battery), None) => battery.store(),
            (None, Some(supercapacitor)) => supercapacitor.store(),
            (Some(_), Some(_)) => Err(refuse("supercapacitor", "given beside `battery`", "one of the two")),
            (None, None) => Err(refuse("battery", "missing", "a `battery` or a `supercapacitor`")),
        }
    }

    /// Open-circuit voltage; it stays beyond empty and full.
    pub(crate) fn open_v(&self, charge: f64) -> f64 {
        let (index, share) = place(&self.charges, charge);
        self.voltages[index] + share * (self.voltages[index + 1] - self.voltages[index])
    }

    /// Energy in it at a charge [J]: ∫ U 3600 Q dS.
    pub(crate) fn energy_j(&self, charge: f64) -> f64 {
        let mut sum = 0.0;
        for (charges, voltages) in self.charges.windows(2).zip(self.voltages.windows(2)) {
            let end = charge.clamp(charges[0], charges[1]);
            let share = (end - charges[0]) / (charges[1] - charges[0]);
            let mean = voltages[0] + 0.5 * share * (voltages[1] - voltages[0]);
            sum += mean * (end - charges[0]);
        }
        sum * self.capacity_a_s
    }

    /// Most power at the terminals that it gives, and that it takes; both 0 or more.
    pub(crate) fn most_w(&self, charge: f64, more_ohm: f64) -> (f64, f64) {
        self.most_behind_w(charge, self.behind(charge, more_ohm))
    }

    /// The same, with what stands behind the terminals.
    pub(crate) fn most_behind_w(&self, charge: f64, Behind { u, r }: Behind) -> (f64, f64) {
        let taper = |distance: f64| tapered(distance, TAPER);
        let least_a = self.max_out_a.min((u - self.voltage_window.0) / r).min(0.5 * u / r).max(0.0);
        let out_a = least_a * taper(charge - self.window.0);
        let in_a =
            self.max_in_a.min((self.voltage_window.1 - u) / r).max(0.0) * taper(self.window.1 - charge);
        ((u - r * out_a) * out_a, (u + r * in_a) * in_a)
    }

    /// What stands behind the terminals at a charge.
    pub(crate) fn behind(&self, charge: f64, more_ohm: f64) -> Behind {
        Behind { u: self.open_v(charge), r: self.resistance(more_ohm) }
    }

    fn resistance(&self, more_ohm: f64) -> f64 {
        // An effect may say that it resists less, and never that it drives.
        (self.resistance_ohm + more_ohm).max(1e-9 * self.resistance_ohm)
    }

    /// Draws a power from its terminals, whatever its limits; beyond U² / 4R without further loss.
    pub(crate) fn draw(&self, power_w: f64, charge: f64, more_ohm: f64) -> Drawn {
        self.draw_behind(power_w, self.behind(charge, more_ohm))
    }

    /// The same, with what stands behind them.
    #[inline]
    pub(crate) fn draw_behind(&self, power_w: f64, Behind { u, r }: Behind) -> Drawn {
        let given = power_w.min(0.25 * u * u / r);
        // The lesser root, in the form that has no difference of like numbers.
        let current = 2.0 * given / (u + (u * u - 4.0 * r * given).max(0.0).sqrt());
        let store_w = u * current + (power_w - given);
        let current_a = store_w / u;
        Drawn {
            store_w,
            loss_w: r * current * current,
            current_a,
            voltage_v: u - r * current,
            charge_per_s: -current_a / self.capacity_a_s,
        }
    }
}

impl BatteryFile {
    fn store(&self) -> Result<Store, Refusal> {
        let values = [
            ("resistance_ohm", self.resistance_ohm),
            ("capacity_a_h", self.capacity_a_h),
            ("initial_charge", self.initial_charge),
            ("least_charge", self.least_charge),
            ("most_charge", self.most_charge),
            ("max_discharge_a", self.max_discharge_a),
            ("max_charge_a", self.max_charge_a),
            ("least_voltage_v", self.least_voltage_v),
            ("most_voltage_v", self.most_voltage_v),
        ];
        hold(&BATTERY, &values)?;
        let charges: Vec<f64> = self.open_circuit.iter().map(|point| point.charge).collect();
        let voltages: Vec<f64> = self.open_circuit.iter().map(|point| point.voltage_v).collect();
        increasing("battery.open_circuit", &charges, 2)?;
        if charges[0] != 0.0 || charges[charges.len() - 1] != 1.0 {
            let found = format!("charges from {} to {}", charges[0], charges[charges.len() - 1]);
            return Err(refuse("battery.open_circuit", found, "from 0 to 1"));
        }
        if let Some(voltage) = voltages.iter().find(|voltage| !(voltage.is_finite() && **voltage > 0.0)) {
            return Err(refuse("battery.open_circuit", format!("{voltage} V"), "more than 0"));
        }
        if let Some([before, after]) = voltages.array_windows().find(|[before, after]| after < before) {
            let found = format!("{after} V after {before} V");
            return Err(refuse("battery.open_circuit", found, "voltages that do not fall as it is charged"));
        }
        let window = windowed("battery", self.least_charge, self.most_charge, self.initial_charge)?;
        if self.least_voltage_v >= self.most_voltage_v {
            let expected = format!("less than `most_voltage_v`, {}", self.most_voltage_v);
            return Err(refuse("battery.least_voltage_v", self.least_voltage_v, &expected));
        }
        let store = Store {
            charges,
            voltages,
            resistance_ohm: self.resistance_ohm,
            capacity_a_s: S_PER_H * self.capacity_a_h,
            initial: self.initial_charge,
            window,
            is_supercapacitor: false,
            max_out_a: self.max_discharge_a,
            max_in_a: self.max_charge_a,
            voltage_window: (self.least_voltage_v, self.most_voltage_v),
        };
        // Behind such limits no current flows, at any charge of the window.
        let (empty_v, full_v) = (store.open_v(window.0), store.open_v(window.1));
        if self.least_voltage_v >= full_v {
            let expected =
                format!("less than {full_v:.1} V, its open circuit at `most_charge`, or it gives nothing");
            return Err(refuse("battery.least_voltage_v", format!("{} V", self.least_voltage_v), &expected));
        }
        if self.most_voltage_v <= empty_v {
            let expected =
                format!("more than {empty_v:.1} V, its open circuit at `least_charge`, or it takes nothing");
            return Err(refuse("battery.most_voltage_v", format!("{} V", self.most_voltage_v), &expected));
        }
        Ok(store)
    }
}

impl SupercapacitorFile {
    fn store(&self) -> Result<Store, Refusal> {
        let values = [
            ("capacitance_f", self.capacitance_f),
            ("max_voltage_v", self.max_voltage_v),
            ("resistance_ohm", self.resistance_ohm),
            ("initial_charge", self.initial_charge),
            ("least_charge", self.least_charge),
            ("most_charge", self.most_charge),
            ("max_current_a", self.max_current_a),
        ];
        hold(&SUPERCAPACITOR, &values)?;
        let window = windowed("supercapacitor", self.least_charge, self.most_charge, self.initial_charge)?;
        if self.least_charge < EMPTIEST {
            let expected = format!("{EMPTIEST} or more: an empty one has no voltage to draw on");
            return Err(refuse("supercapacitor.least_charge", self.least_charge, &expected));
        }
        Ok(Store {
            // Below the emptiest the voltage stays: it must not fall to 0.
            charges: vec![0.0, EMPTIEST, 1.0],
            voltages: vec![EMPTIEST * self.max_voltage_v, EMPTIEST * self.max_voltage_v, self.max_voltage_v],
            resistance_ohm: self.resistance_ohm,
            capacity_a_s: self.capacitance_f * self.max_voltage_v,
            initial: self.initial_charge,
            window,
            is_supercapacitor: true,
            max_out_a: self.max_current_a,
            max_in_a: self.max_current_a,
            voltage_window: (0.0, f64::INFINITY),
        })
    }
}

/// The least charge that a supercapacitor may be used to.
const EMPTIEST: f64 = 0.1;

fn windowed(of: &str, least: f64, most: f64, initial: f64) -> Result<(f64, f64), Refusal> {
    if least >= most {
        return Err(refuse(format!("{of}.least_charge"), least, &format!("less than `most_charge`, {most}")));
    }
    if !(least..=most).contains(&initial) {
        return Err(refuse(format!("{of}.initial_charge"), initial, &format!("{least} to {most}")));
    }
    Ok((least, most))
}

#[cfg(test)]
#[path = "store_tests.rs"]
pub(crate) mod tests;
