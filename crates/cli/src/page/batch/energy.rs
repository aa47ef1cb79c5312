//! Where the energy of each variant went.

use super::{Content, IN_DETAIL};
use crate::failure::Failure;
use headland_batch::{Cell, account_column, account_of_column};
use headland_plugin::Registry;
use headland_report::build::{Stages, staged_flow};
use headland_report::{Axis, Bar, Bars, Plot, Section};
use headland_scenario::Scenario;

/// Accounts that take from shafts and wires.
const TAKEN: [&str; 3] = ["power take off", "hydraulics", "auxiliary"];
/// Flows that one page draws.
const FLOWS: usize = 12;

impl Content<'_> {
    /// A comparison of all accounts, and the flows of each variant.
    pub(super) fn energy(&self, registry: &Registry) -> Result<Option<Section>, Failure> {
        let mut section = Section::new("Where the energy went").words(
            "Means over the runs of a configuration. The accounts are those of the energy ledger: what the stores gave is \
             what all others took, up to the residual of the integration.",
        );
        let mut drawn = 0;
        for place in self.places().into_iter().take(IN_DETAIL) {
            let cells: Vec<&Cell> = (0..self.plan.comparison.variants.len())
                .filter_map(|variant| self.cell(variant, place))
                .filter(|cell| cell.finished > 0)
                .collect();
            if cells.len() > 1 {
                section = section.with(self.accounts(&cells, place));
            }
            for cell in cells {
                if drawn < FLOWS {
                    section = section.with(self.flow(cell, registry)?);
                    drawn += 1;
                }
            }
        }
        Ok((drawn > 0).then_some(section))
    }

    /// Accounts that can be seen in some configuration, so that each has one colour on the whole page.
    fn names(&self) -> Vec<&str> {
        let cells = &self.summary.cells;
        let mut names: Vec<&str> = Vec::new();
        for (name, _) in cells.iter().flat_map(|cell| &cell.accounts) {
            let apart = name.starts_with("from ") || name == "residual";
            if !apart && !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        // What would be thinner than a line is only told in the table of results.
        let seen = |cell: &Cell, name: &str| {
            let whole: f64 = cell.accounts.iter().map(|(_, energy)| energy.mean.abs()).fold(0.0, f64::max);
            account(cell, name).is_some_and(|energy| energy.abs() > 5e-3 * whole)
        };
        names.retain(|name| cells.iter().any(|cell| seen(cell, name)));
        names
    }

    /// The accounts of variants side by side, as stacked bars.
    fn accounts(&self, cells: &[&Cell], (cycle, ground): (usize, usize)) -> Plot {
        let names = self.names();
        let value = |cell: &Cell, name: &str| account(cell, name).unwrap_or(0.0);
        let bars = names.iter().map(|name| Bar {
            name: (*name).to_owned(),
            values: cells.iter().map(|cell| value(cell, name)).collect(),
            error: None,
        });
        let title = format!("Energy by account: {}", self.place(cycle, ground));
        let bars = Bars {
            categories: cells.iter().map(|cell| self.variant(cell.variant).to_owned()).collect(),
            axis: Axis::new("energy", "J"),
            bars: bars.collect(),
            stacked: true,
            horizontal: true,
        };
        Plot::new(title, bars)
    }

    fn flow(&self, cell: &Cell, registry: &Registry) -> Result<Plot, Failure> {
        let spec = headland_batch::Spec {
            variant: cell.variant,
            cycle: cell.cycle,
            ground: cell.ground,
            ..self.plan.spec(0)
        };
        let (_, model) = Scenario::with_model(self.plan.document(spec)?, registry)?;
        let plain = |name: &str| account_of_column(&account_column(name)).unwrap_or_default();
        let losses: Vec<String> = model.driveline.losses().iter().map(|name| plain(name)).collect();
        let mut stages = Stages::default();
        for (name, energy) in &cell.accounts {
            let (entry, of) = match name.strip_prefix("from ") {
                Some(source) => ((source.to_owned(), energy.mean), &mut stages.sources),
                None if losses.contains(name) => ((name.clone(), energy.mean), &mut stages.losses),
                None if TAKEN.contains(&name.as_str()) || name == "residual" => {
                    ((name.clone(), energy.mean), &mut stages.taken)
                }
                None => ((name.clone(), energy.mean), &mut stages.wheels),
            };
            of.push(entry);
        }
        let place = self.place(cell.cycle, cell.ground);
        Ok(staged_flow(&format!("{}: {place}", self.variant(cell.variant)), &stages))
    }
}

/// Mean energy of an account [J].
fn account(cell: &Cell, name: &str) -> Option<f64> {
    cell.accounts.iter().find(|(other, _)| other == name).map(|(_, energy)| energy.mean)
}
