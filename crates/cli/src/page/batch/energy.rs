//! Where the energy of each variant went.

use super::{Content, IN_DETAIL};
use crate::failure::Failure;
use headland_batch::{Cell, account_column, account_of_column};
use headland_plugin::Registry;
use headland_report::build::{Stages, staged_flow};
use headland_report::{Axis, Bar, Bars, Kind, Plot, Section};
use headland_scenario::Scenario;
use std::collections::BTreeMap;

/// Accounts that take from shafts and wires.
const TAKEN: [&str; 3] = ["power take off", "hydraulics", "auxiliary"];
/// Accounts with a colour of their own; one more stands for the others.
const COLOURS: usize = 6;
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

    /// The greatest accounts of all configurations, so that each has a colour of its own, the same on the whole page.
    fn names(&self) -> Vec<&str> {
        let cells = &self.summary.cells;
        let mut names: Vec<(&str, f64)> = Vec::new();
        for (name, energy) in cells.iter().flat_map(|cell| &cell.accounts).filter(|(name, _)| !apart(name)) {
            match names.iter_mut().find(|(other, _)| other == name) {
                Some((_, greatest)) => *greatest = greatest.max(energy.mean.abs()),
                None => names.push((name, energy.mean.abs())),
            }
        }
        let mut sizes: Vec<f64> = names.iter().map(|(_, size)| *size).collect();
        sizes.sort_by(|one, other| other.total_cmp(one));
        let least = sizes.get(COLOURS - 1).copied().unwrap_or(0.0);
        names
            .into_iter()
            .filter(|(_, size)| *size >= least && *size > 0.0)
            .take(COLOURS)
            .map(|(name, _)| name)
            .collect()
    }

    /// The accounts of variants side by side, as stacked bars.
    fn accounts(&self, cells: &[&Cell], (cycle, ground): (usize, usize)) -> Plot {
        let names = self.names();
        let value = |cell: &Cell, name: &str| account(cell, name).unwrap_or(0.0);
        let mut bars: Vec<Bar> = names
            .iter()
            .map(|name| Bar {
                name: (*name).to_owned(),
                values: cells.iter().map(|cell| value(cell, name)).collect(),
                error: None,
            })
            .collect();
        let rest = |cell: &&Cell| -> f64 {
            cell.accounts
                .iter()
                .filter(|(name, _)| !apart(name) && !names.contains(&name.as_str()))
                .map(|(_, energy)| energy.mean)
                .sum()
        };
        bars.push(Bar {
            name: "everything else".to_owned(),
            values: cells.iter().map(rest).collect(),
            error: None,
        });
        let title = format!("Energy by account: {}", self.place(cycle, ground));
        let bars = Bars {
            categories: cells.iter().map(|cell| self.variant(cell.variant).to_owned()).collect(),
            axis: Axis::new("energy", "J"),
            bars,
            stacked: true,
            horizontal: true,
        };
        Plot::new(title, bars)
    }

    fn flow(&self, cell: &Cell, registry: &Registry) -> Result<Plot, Failure> {
        let spec = |point| headland_batch::Spec {
            variant: cell.variant,
            cycle: cell.cycle,
            ground: cell.ground,
            point,
            ..self.plan.spec(0)
        };
        // A point may be refused; what was drawn of the cell came of another one.
        let built = |point| -> Result<_, Failure> {
            Ok(Scenario::with_model(self.plan.document(spec(point))?, registry)?)
        };
        let found = (0..self.plan.points()).find_map(|point| built(point).ok());
        let (_, model) = found.map_or_else(|| built(0), Ok)?;
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
        let mut plot = staged_flow(&format!("{}: {place}", self.variant(cell.variant)), &stages);
        if let Kind::Sankey(sankey) = &mut plot.kind {
            sankey.colours = self.colours(cell);
        }
        Ok(plot)
    }

    /// The colours of the accounts as the bars have them; what the stores gave is as grey as the rest.
    fn colours(&self, cell: &Cell) -> BTreeMap<String, usize> {
        let names = self.names();
        let colour = |name: &str| names.iter().position(|other| *other == name).unwrap_or(names.len());
        let plain = |name: &str| name.strip_prefix("from ").unwrap_or(name).to_owned();
        cell.accounts.iter().map(|(name, _)| (plain(name), colour(name))).collect()
    }
}

/// What stands on the other side of the ledger.
fn apart(name: &str) -> bool {
    name.starts_with("from ") || name == "residual"
}

/// Mean energy of an account [J].
fn account(cell: &Cell, name: &str) -> Option<f64> {
    cell.accounts.iter().find(|(other, _)| other == name).map(|(_, energy)| energy.mean)
}
