//! What variants are compared by: numbers that an engineer asks for, each from the values of one run.

use crate::comparison::Accounting;
use crate::row::Row;
use serde::Deserialize;

/// Something to compare by. Smaller is better, but for [`Measure::AreaRate`].
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
pub enum Measure {
    /// Fuel at the charge that the run began with.
    Fuel,
    /// Energy that electric stores gave.
    Electricity,
    /// Carbon dioxide.
    Co2,
    /// Time.
    Time,
    /// Area that was worked.
    Area,
    /// Area an hour.
    AreaRate,
    /// Fuel for the area that was worked.
    FuelPerHectare,
    /// Energy of fuel and stores for the area that was worked.
    EnergyPerHectare,
    /// Fuel for the work of the engine's shaft.
    SpecificFuel,
    /// Fuel for the work at drawbar, power take-off and hydraulics.
    FuelPerWork,
    /// Fuel for the distance.
    FuelPerDistance,
    /// Energy of fuel and stores.
    Energy,
}

/// A joule in kilowatt hours.
const KWH_J: f64 = 3.6e6;
/// A square metre in hectares.
const HECTARE_M2: f64 = 1e4;

/// Accounts of the ledger in which useful work ends.
const USEFUL: [&str; 3] = ["energy_drawbar_j", "energy_power_take_off_j", "energy_hydraulics_j"];

impl Measure {
    /// All of them, in the order of a table.
    pub const ALL: [Self; 12] = [
        Self::Fuel,
        Self::Electricity,
        Self::Energy,
        Self::Co2,
        Self::Time,
        Self::Area,
        Self::AreaRate,
        Self::FuelPerHectare,
        Self::EnergyPerHectare,
        Self::SpecificFuel,
        Self::FuelPerWork,
        Self::FuelPerDistance,
    ];

    /// What it is called, and its unit.
    pub fn label(self, accounting: &Accounting) -> (&'static str, &'static str) {
        let litres = accounting.fuel.is_some();
        match self {
            Self::Fuel if litres => ("fuel", "L"),
            Self::Fuel => ("fuel", "kg"),
            Self::Electricity => ("electricity", "kWh"),
            Self::Energy => ("energy", "kWh"),
            Self::Co2 => ("CO₂", "kg"),
            Self::Time => ("time", "min"),
            Self::Area => ("area", "ha"),
            Self::AreaRate => ("area rate", "ha/h"),
            Self::FuelPerHectare if litres => ("fuel per area", "L/ha"),
            Self::FuelPerHectare => ("fuel per area", "kg/ha"),
            Self::EnergyPerHectare => ("energy per area", "kWh/ha"),
            Self::SpecificFuel => ("fuel of the shaft", "g/kWh"),
            Self::FuelPerWork => ("fuel per work", "g/kWh"),
            Self::FuelPerDistance if litres => ("fuel per distance", "L/100 km"),
            Self::FuelPerDistance => ("fuel per distance", "kg/100 km"),
        }
    }

    /// Whether more of it is better; `None` where it is neither.
    pub fn more_is_better(self) -> Option<bool> {
        match self {
            Self::Area => None,
            Self::AreaRate => Some(true),
            _ => Some(false),
        }
    }

    /// Its value in a run, in the unit of its label; NaN where the run does not have it.
    pub fn of(self, row: &Row, accounting: &Accounting) -> f64 {
        let fuel_kg = row.value("fuel_at_charge_kg");
        let fuel = accounting.fuel.map_or(fuel_kg, |fuel| 1e3 * fuel_kg / fuel.density_kg_m3);
        let hectares = row.value("area_worked_m2") / HECTARE_M2;
        let ratio = |value: f64, by: f64| if by > 0.0 { value / by } else { f64::NAN };
        match self {
            Self::Fuel => fuel,
            Self::Electricity => row.value("electricity_j") / KWH_J,
            Self::Energy => energy_j(row) / KWH_J,
            Self::Co2 => row.value("co2_kg"),
            Self::Time => row.value("time_s") / 60.0,
            Self::Area => hectares,
            Self::AreaRate => ratio(hectares, row.value("time_s") / 3600.0),
            Self::FuelPerHectare => ratio(fuel, hectares),
            Self::EnergyPerHectare => ratio(energy_j(row) / KWH_J, hectares),
            Self::SpecificFuel => ratio(1e3 * row.value("fuel_kg"), row.value("engine_work_j") / KWH_J),
            Self::FuelPerWork => ratio(1e3 * fuel_kg, useful_j(row) / KWH_J),
            Self::FuelPerDistance => ratio(100.0 * fuel, row.value("distance_m") / 1e3),
        }
    }
}

/// What making up for a change of charge adds to the fuel that was burnt, as a share of that.
pub(crate) fn made_up(row: &Row) -> f64 {
    row.value("fuel_at_charge_kg") / row.value("fuel_kg") - 1.0
}

/// Energy from the source and from electric stores beside it [J].
fn energy_j(row: &Row) -> f64 {
    let sources: Vec<f64> = row
        .values
        .iter()
        .filter(|(name, _)| name.starts_with("energy_from_"))
        .map(|(_, value)| *value)
        .collect();
    if sources.is_empty() {
        return f64::NAN;
    }
    let fuelled = !row.value("fuel_kg").is_nan();
    let stored = row.value("electricity_j");
    sources.iter().sum::<f64>() + if fuelled && !stored.is_nan() { stored } else { 0.0 }
}

/// Work that the vehicle is there for [J].
fn useful_j(row: &Row) -> f64 {
    USEFUL.iter().map(|name| row.value(name)).filter(|value| !value.is_nan()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::Status;
    use crate::schema::Fuel;

    fn row(values: &[(&str, f64)]) -> Row {
        let mut row = Row::without(0, Status::Finished, String::new());
        row.values = values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        row
    }

    /// By hand: 8.35 kg are 10 L; on 5000 m² that is 20 L/ha; for 40 kWh of shaft work 208.75 g/kWh.
    #[test]
    fn consumption_by_area_work_and_distance() {
        let run = row(&[
            ("fuel_kg", 8.35),
            ("fuel_at_charge_kg", 8.35),
            ("area_worked_m2", 5000.0),
            ("engine_work_j", 40.0 * 3.6e6),
            ("distance_m", 2500.0),
            ("time_s", 1800.0),
            ("energy_drawbar_j", 20.0 * 3.6e6),
            ("energy_power_take_off_j", 5.0 * 3.6e6),
            ("energy_from_fuel_j", 100.0 * 3.6e6),
        ]);
        let accounting = Accounting {
            fuel: Some(Fuel { density_kg_m3: 835.0, co2_kg_per_kg: 3.16 }),
            ..Accounting::default()
        };
        for (measure, expected) in [
            (Measure::Fuel, 10.0),
            (Measure::FuelPerHectare, 20.0),
            (Measure::SpecificFuel, 208.75),
            (Measure::FuelPerWork, 334.0),
            (Measure::FuelPerDistance, 400.0),
            (Measure::AreaRate, 1.0),
            (Measure::EnergyPerHectare, 200.0),
            (Measure::Time, 30.0),
        ] {
            let value = measure.of(&run, &accounting);
            assert!((value - expected).abs() < 1e-9 * expected, "{measure:?}: {value}");
        }
        assert!(Measure::Electricity.of(&run, &accounting).is_nan());
    }

    /// 8.4 kg at the same charge for 8 kg that were burnt: a twentieth more.
    #[test]
    fn what_is_made_up_for_is_a_share_of_the_fuel_burnt() {
        let share = made_up(&row(&[("fuel_kg", 8.0), ("fuel_at_charge_kg", 8.4)]));
        assert!((share - 0.05).abs() < 1e-12, "{share}");
        assert!(made_up(&row(&[("fuel_kg", f64::NAN), ("fuel_at_charge_kg", f64::NAN)])).is_nan());
    }

    #[test]
    fn what_is_not_there_is_not_a_number() {
        let run = row(&[("time_s", 10.0), ("area_worked_m2", 0.0), ("fuel_at_charge_kg", 1.0)]);
        for measure in [Measure::FuelPerHectare, Measure::FuelPerWork, Measure::Energy, Measure::Co2] {
            assert!(measure.of(&run, &Accounting::default()).is_nan(), "{measure:?}");
        }
    }
}
