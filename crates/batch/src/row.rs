//! What is kept of a run.

use crate::comparison::Accounting;
use headland_sim::{Driven, End, Outcome, speed_not_kept};
use headland_trace::Trace;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Its cycle was driven to the end.
    Finished,
    /// It could not go on; the numbers are those up to there.
    Stopped,
    /// Its scenario cannot be used, as where a swept value is not physical.
    Refused,
    /// A model failed.
    Failed,
}

impl Status {
    pub(crate) const ALL: [Self; 4] = [Self::Finished, Self::Stopped, Self::Refused, Self::Failed];

    /// Its name in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Stopped => "stopped",
            Self::Refused => "refused",
            Self::Failed => "failed",
        }
    }
}

/// A run in the table of results.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Number of the run.
    pub number: u64,
    /// How it ended.
    pub status: Status,
    /// Why it did not finish; empty where it did.
    pub error: String,
    /// Name, with its unit, and value of everything that was counted.
    pub values: Vec<(String, f64)>,
}

impl Row {
    /// A run without numbers.
    pub(crate) fn without(number: u64, status: Status, error: String) -> Self {
        Self { number, status, error, values: Vec::new() }
    }

    /// A value by its name; NaN where there is none.
    pub fn value(&self, name: &str) -> f64 {
        self.values.iter().find(|(other, _)| other == name).map_or(f64::NAN, |(_, value)| *value)
    }

    /// Counts what a simulation left behind.
    pub(crate) fn of(number: u64, outcome: &Outcome, accounting: &Accounting) -> Self {
        let (status, error) = match &outcome.end {
            End::Finished => match speed_not_kept(&outcome.phases) {
                Some(told) => (Status::Stopped, told),
                None => (Status::Finished, String::new()),
            },
            End::Stopped { time_s, position_m, reason } => {
                (Status::Stopped, format!("{reason} (at {time_s:.2} s and {position_m:.1} m)"))
            }
            End::Interrupted { time_s, position_m } => {
                (Status::Stopped, format!("it was interrupted (at {time_s:.2} s and {position_m:.1} m)"))
            }
        };
        let trace = &outcome.trace;
        let series = |name: &str| trace.get(name).unwrap_or(&[]);
        let ends = |name: &str| match series(name) {
            [first, .., last] => (*first, *last),
            _ => (f64::NAN, f64::NAN),
        };
        let fuel_kg = integral(trace, &["fuel_rate_kg_s"]);
        let engine_work_j = integral(trace, &["engine_torque_n_m", "engine_speed_rad_s"]);
        let electricity_j = electricity_j(outcome);
        let (charge_start, charge_end) = ends("state_of_charge");
        let fuel_at_charge_kg = at_charge(accounting, fuel_kg, engine_work_j, electricity_j);
        let fuelled = !fuel_kg.is_nan();
        let counted = [
            ("time_s", trace.duration_s()),
            ("distance_m", series("position_m").windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum()),
            ("short_m", outcome.phases.iter().filter_map(Driven::short_m).sum()),
            ("area_worked_m2", area_m2(trace)),
            ("greatest_speed_m_s", series("speed_m_s").iter().copied().fold(0.0, f64::max)),
            ("fuel_kg", fuel_kg),
            ("fuel_at_charge_kg", fuel_at_charge_kg),
            ("fuel_m3", accounting.fuel.map_or(f64::NAN, |fuel| fuel_at_charge_kg / fuel.density_kg_m3)),
            ("electricity_j", electricity_j),
            ("state_of_charge_start", charge_start),
            ("state_of_charge_end", charge_end),
            ("co2_kg", co2_kg(accounting, fuelled.then_some(fuel_at_charge_kg), electricity_j)),
            ("engine_work_j", engine_work_j),
            ("payload_moved_kg", payload_kg(trace)),
            ("steps", outcome.steps as f64),
        ];
        let mut values: Vec<(String, f64)> = counted
            .into_iter()
            .filter(|(_, value)| value.is_finite())
            .map(|(name, value)| (name.to_owned(), value))
            .collect();
        let ledger = &outcome.ledger;
        let source = format!("from {}", ledger.source_name);
        let accounts = [(source.as_str(), ledger.source_j), ("kinetic", ledger.kinetic_j)]
            .into_iter()
            .chain(ledger.sinks.iter().map(|sink| (sink.name.as_str(), sink.energy_j)))
            .chain([("residual", ledger.residual_j)]);
        for (name, energy_j) in accounts.filter(|(_, energy_j)| energy_j.is_finite()) {
            values.push((account_column(name), energy_j));
        }
        Self { number, status, error, values }
    }
}

/// The column of an account of the ledger.
pub fn account_column(account: &str) -> String {
    let plain: String = account.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
    format!("energy_{}_j", plain.to_lowercase())
}

/// The account of a column, in words; `None` where the column is none of the ledger.
pub fn account_of_column(column: &str) -> Option<String> {
    Some(column.strip_prefix("energy_")?.strip_suffix("_j")?.replace('_', " "))
}

/// Time integral of a product of channels, by the trapezoidal rule; NaN where one is missing.
fn integral(trace: &Trace, channels: &[&str]) -> f64 {
    let Some(columns) = channels.iter().map(|name| trace.get(name)).collect::<Option<Vec<_>>>() else {
        return f64::NAN;
    };
    let at = |row: usize| columns.iter().map(|column| column[row]).product::<f64>();
    let times = trace.time_s();
    (1..times.len())
        .map(|row| 0.5 * (times[row] - times[row - 1]) * (at(row - 1) + at(row)))
        .filter(|piece| piece.is_finite())
        .sum()
}

/// Stores that a vehicle without an engine draws on.
const STORES: [&str; 2] = ["battery", "supercapacitor"];
/// What ends the name of the account of what a store beside an engine gains, as in `battery charge`.
const GAINED: &str = " charge";

/// Energy that electric stores gave, before their own losses [J]; NaN where there is none.
fn electricity_j(outcome: &Outcome) -> f64 {
    let ledger = &outcome.ledger;
    if STORES.contains(&ledger.source_name.as_str()) {
        return ledger.source_j;
    }
    let gained: Vec<f64> =
        ledger.sinks.iter().filter(|sink| sink.name.ends_with(GAINED)).map(|sink| -sink.energy_j).collect();
    if gained.is_empty() { f64::NAN } else { gained.iter().sum() }
}

/// Fuel if the store had ended as it began [kg]: what it gave is charged by the engine, what it gained is used in its
/// place, both at the engine's mean consumption in this run; see [`crate::Charge`].
fn at_charge(accounting: &Accounting, fuel_kg: f64, engine_work_j: f64, electricity_j: f64) -> f64 {
    if electricity_j.is_nan() || electricity_j == 0.0 {
        return fuel_kg;
    }
    let Some(charge) = accounting.charge else { return f64::NAN };
    let work_j = if electricity_j > 0.0 {
        electricity_j / charge.charging_efficiency
    } else {
        electricity_j * charge.discharging_efficiency
    };
    if engine_work_j > 0.0 { fuel_kg + work_j * fuel_kg / engine_work_j } else { f64::NAN }
}

/// Carbon dioxide of fuel and, where there is no fuel, of the electricity [kg].
fn co2_kg(accounting: &Accounting, fuel_kg: Option<f64>, electricity_j: f64) -> f64 {
    match fuel_kg {
        Some(fuel_kg) => accounting.fuel.map_or(f64::NAN, |fuel| fuel_kg * fuel.co2_kg_per_kg),
        None => accounting.electricity.map_or(f64::NAN, |grid| electricity_j * grid.co2_kg_j),
    }
}

/// Area that was worked [m²]: of several implements on the same ground, that of the widest.
fn area_m2(trace: &Trace) -> f64 {
    trace
        .channels()
        .iter()
        .filter(|channel| channel.name.ends_with("_area_m2"))
        .filter_map(|channel| trace.get(&channel.name))
        .filter_map(|values| Some(values.last()? - values.first()?))
        .fold(f64::NAN, f64::max)
}

/// What was loaded and unloaded [kg]: half of all changes of payload.
fn payload_kg(trace: &Trace) -> f64 {
    let mut moved = f64::NAN;
    for channel in trace.channels().iter().filter(|channel| channel.name.ends_with("payload_kg")) {
        let values = trace.get(&channel.name).unwrap_or(&[]);
        let changes: f64 = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
        moved = if moved.is_nan() { 0.5 * changes } else { moved + 0.5 * changes };
    }
    moved
}

#[cfg(test)]
#[path = "row_tests.rs"]
mod tests;
