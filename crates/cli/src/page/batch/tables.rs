//! Tables of a batch: results, differences to the baseline, charge, runs without an end.

use super::Content;
use crate::page::short;
use headland_batch::{Measure, Plan, Statistics};
use headland_report::{Axis, Cell, Item, Section, Table};

/// Columns of the table of results, as far as they are there.
const COLUMNS: [Measure; 9] = [
    Measure::Fuel,
    Measure::Electricity,
    Measure::Co2,
    Measure::Time,
    Measure::Area,
    Measure::FuelPerHectare,
    Measure::SpecificFuel,
    Measure::FuelPerWork,
    Measure::FuelPerDistance,
];

impl Content<'_> {
    /// Every configuration with its numbers.
    pub(super) fn results(&self) -> Table {
        let present = self.summary.present();
        let columns: Vec<usize> = COLUMNS
            .iter()
            .filter_map(|measure| self.summary.measures.iter().position(|other| other == measure))
            .filter(|index| present.contains(index))
            .collect();
        let mut rows = Vec::new();
        for (cycle, ground) in self.places() {
            for variant in 0..self.plan.comparison.variants.len() {
                let Some(cell) = self.cell(variant, (cycle, ground)) else { continue };
                let mut row = vec![Cell::from(self.variant(variant)), Cell::from(self.place(cycle, ground))];
                row.extend(columns.iter().map(|index| Cell::Number(cell.measures[*index].mean)));
                row.push(Cell::Number(cell.finished as f64));
                rows.push(row);
            }
        }
        let mut heads = vec![Axis::new("variant", ""), Axis::new("cycle", "")];
        heads.extend(columns.iter().map(|index| self.axis(*index)));
        heads.push(Axis::new("runs", ""));
        Table { title: "Results, means of the runs".to_owned(), columns: heads, rows }
    }

    /// Differences to the baseline in per cent, paired.
    pub(super) fn differences(&self, asked: &[usize]) -> Option<Table> {
        let base = self.plan.comparison.baseline?;
        let mut rows = Vec::new();
        for (cycle, ground) in self.places() {
            for variant in (0..self.plan.comparison.variants.len()).filter(|variant| *variant != base) {
                let Some(cell) = self.cell(variant, (cycle, ground)) else { continue };
                let share = |index: &usize| difference(&cell.against[*index]);
                let mut row = vec![Cell::from(self.variant(variant)), Cell::from(self.place(cycle, ground))];
                row.extend(asked.iter().map(share));
                rows.push(row);
            }
        }
        if rows.is_empty() {
            return None;
        }
        let mut columns = vec![Axis::new("variant", ""), Axis::new("cycle", "")];
        columns.extend(asked.iter().map(|index| Axis::new(self.axis(*index).label, "%")));
        let title = format!(
            "Against {}, run by run: mean ± one standard deviation of the difference",
            self.variant(base)
        );
        Some(Table { title, columns, rows })
    }

    /// What the charge of electric stores did, and how fuel is told at the same charge.
    pub(super) fn charge(&self) -> Option<Section> {
        let charged = |cell: &&headland_batch::Cell| cell.charge.count > 0;
        if !self.summary.cells.iter().any(|cell| charged(&cell)) {
            return None;
        }
        let words = match self.plan.comparison.accounting.charge {
            Some(charge) => format!(
                "Fuel and what follows from it are told at the charge that the run began with. What the store gave is \
                 charged by the engine with an efficiency of {}, what it gained replaces work of the engine with {}, both \
                 at the engine's mean consumption in the same run: m + (ΔE / η) (m / W). This is the correction of \
                 ISO 23274-1 and SAE J1711 with a stated efficiency in the place of their tolerance. Where the charge at \
                 the start is moved and nothing else, a line through those runs, fuel over energy of the store, gives an \
                 independent value.",
                charge.charging_efficiency, charge.discharging_efficiency
            ),
            None => "The comparison does not say how a change of charge is made up for (`charge`), so the fuel of a run \
                     that ends at another charge than it began with is not compared."
                .to_owned(),
        };
        let fuel = self.summary.measures.iter().position(|measure| *measure == Measure::Fuel)?;
        let density = self.plan.comparison.accounting.fuel.map(|fuel| fuel.density_kg_m3);
        let lines = self.summary.cells.iter().any(|cell| cell.fuel_over_store.fit().is_some());
        let rows = self.summary.cells.iter().filter(charged).map(|cell| {
            let percent = |share: &Statistics| {
                let mut share = *share;
                share.scale(100.0);
                number(&share)
            };
            let mut row = vec![
                Cell::from(self.variant(cell.variant)),
                Cell::from(self.place(cell.cycle, cell.ground)),
                percent(&cell.charge),
                number(&cell.measures[fuel]),
                percent(&cell.made_up),
            ];
            if lines {
                let line = cell.fuel_over_store.fit();
                let litres = |kg: f64| density.map_or(kg, |density| 1e3 * kg / density);
                row.push(Cell::Number(line.map_or(f64::NAN, |(at_zero, _, _)| litres(at_zero))));
                row.push(Cell::Number(line.map_or(f64::NAN, |(_, _, share)| share)));
            }
            row
        });
        let axis = self.axis(fuel);
        let mut columns = vec![
            Axis::new("variant", ""),
            Axis::new("cycle", ""),
            Axis::new("change of charge", "%"),
            Axis::new("fuel at the same charge", axis.unit.clone()),
            Axis::new("made up for, of the fuel burnt", "%"),
        ];
        if lines {
            columns.extend([Axis::new("by the line", axis.unit), Axis::new("R² of the line", "")]);
        }
        let table = Table { title: "Charge".to_owned(), columns, rows: rows.collect() };
        let section = Section::new("State of charge").words(words).with(table);
        let much = self.much_made_up();
        Some(if much.is_empty() { section } else { section.with(Item::Sentences(much)) })
    }

    /// A sentence for each configuration whose fuel leans on the correction for charge.
    fn much_made_up(&self) -> Vec<String> {
        self.summary.cells.iter().filter_map(|cell| much_made_up(self.plan, cell)).collect()
    }

    /// Configurations that were slower than their cycle says.
    pub(super) fn slowed(&self) -> Option<Section> {
        let cells = &self.summary.cells;
        let slowed: Vec<String> = cells.iter().filter_map(|cell| much_short(self.plan, cell)).collect();
        let words = "A phase that may be slowed down, as by a plough, goes on at the speed that the drive can give. Such runs took \
                     more time for less power than their cycle asks for.";
        let section = || {
            Section::new("Speeds that were not reached").words(words).with(Item::Sentences(slowed.clone()))
        };
        (!slowed.is_empty()).then(section)
    }

    /// Runs that did not reach the end of their cycle.
    pub(super) fn troubles(&self) -> Option<Section> {
        let troubles = &self.summary.troubles;
        if troubles.is_empty() {
            return None;
        }
        let sentences = troubles
            .iter()
            .map(|(number, status, error)| {
                format!("{}: {}: {error}", self.plan.called(self.plan.spec(*number)), status.name())
            })
            .collect();
        let words = if (troubles.len() as u64) < self.summary.unfinished {
            format!(
                "The first {} of {}; the table of results has all.",
                troubles.len(),
                self.summary.unfinished
            )
        } else {
            "They are left out of all means and differences; the table of results has their rows.".to_owned()
        };
        Some(Section::new("Runs without an end").words(words).with(Item::Sentences(sentences)))
    }
}

/// What is to be said where the fuel of a configuration leans on the correction for charge.
pub fn much_made_up(plan: &Plan, cell: &headland_batch::Cell) -> Option<String> {
    let share = cell.much_made_up()?;
    let comparison = &plan.comparison;
    Some(format!(
        "{}, {}, {}: {:.1} % of the fuel burnt is the correction for charge, so its fuel is not known better than that \
         correction; a longer cycle, or a management that keeps the charge, makes it smaller",
        comparison.variants[cell.variant].name,
        comparison.cycles[cell.cycle].name,
        comparison.grounds[cell.ground].name,
        100.0 * share
    ))
}

/// What is to be said where a configuration made much less of its way than its speeds ask for.
pub fn much_short(plan: &Plan, cell: &headland_batch::Cell) -> Option<String> {
    let share = cell.much_short()?;
    let comparison = &plan.comparison;
    Some(format!(
        "{}, {}, {}: {:.1} % of the way that its speeds ask for was not made in their time, so it did not drive what its cycle \
         says; a lighter load, a lower speed or a stronger drive does",
        comparison.variants[cell.variant].name,
        comparison.cycles[cell.cycle].name,
        comparison.grounds[cell.ground].name,
        100.0 * share
    ))
}

/// A mean, with its standard deviation where there is one worth the ink.
fn number(value: &Statistics) -> Cell {
    /// A spread below this share of the mean is told by none of four digits.
    const SHOWN: f64 = 5e-4;
    let deviation = value.deviation();
    if deviation > SHOWN * value.mean.abs() {
        Cell::Written(format!("{} ± {}", short(value.mean), rounded(deviation)))
    } else {
        Cell::Number(value.mean)
    }
}

/// A difference in per cent, to a hundredth.
fn difference(share: &Statistics) -> Cell {
    if share.count == 0 {
        return Cell::Number(f64::NAN);
    }
    let sign = if share.mean > 0.0 { "+" } else { "" };
    let mean = short((1e4 * share.mean).round() / 100.0);
    let deviation = (1e4 * share.deviation()).round() / 100.0;
    Cell::Written(if deviation.is_nan() {
        format!("{sign}{mean}")
    } else {
        format!("{sign}{mean} ± {}", short(deviation))
    })
}

/// Two significant digits.
fn rounded(value: f64) -> String {
    let step = 10f64.powf(value.log10().floor() - 1.0);
    short((value / step).round() * step)
}
