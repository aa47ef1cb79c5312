//! What an axis measures.

use crate::number::pretty_unit;
use headland_units::{stem, unit_of_name};

/// An axis: a label and a unit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Axis {
    /// What is measured.
    pub label: String,
    /// Its unit; empty for pure numbers.
    pub unit: String,
}

impl Axis {
    /// An axis with this label and unit.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into() }
    }

    /// The axis of a channel: `speed_m_s` gives "speed" in m/s.
    pub fn of(channel: &str) -> Self {
        let unit = unit_of_name(channel).map(|unit| pretty_unit(&unit.symbol)).unwrap_or_default();
        Self { label: stem(channel).replace('_', " "), unit }
    }

    /// Time since the start of the run.
    pub fn time() -> Self {
        Self::new("time", "s")
    }

    /// Label and unit, as in "speed [m/s]".
    pub(crate) fn title(&self) -> String {
        if self.unit.is_empty() { self.label.clone() } else { format!("{} [{}]", self.label, self.unit) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_name_is_a_label_and_a_unit() {
        assert_eq!(Axis::of("acceleration_m_s2").title(), "acceleration [m/s²]");
        assert_eq!(Axis::of("tractive_force_n").title(), "tractive force [N]");
        assert_eq!(Axis::of("state_of_charge").title(), "state of charge");
    }
}
