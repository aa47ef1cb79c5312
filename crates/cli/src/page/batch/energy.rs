//! Where the energy of each variant went.

use super::{Content, IN_DETAIL};
use crate::failure::Failure;
use headland_batch::{Cell, account_column, account_of_column};
use headland_plugin::Registry;
use headland_report::build::{Stages, staged_flow};
use headland_report::{Axis, Bar, Bars, Item, Kind, Plot, Section};
use headland_scenario::Scenario;
use std::collections::BTreeMap;

/// What begins the name of the account of a store that is drawn on.
const FROM: &str = "from ";
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
                    section = section.with(or_why_not(self.flow(cell, registry)?));
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
                name: self.called(name),
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
            let of = match name.strip_prefix(FROM) {
                Some(_) => &mut stages.sources,
                None if losses.contains(name) => &mut stages.losses,
                None if TAKEN.contains(&name.as_str()) || name == "residual" => &mut stages.taken,
                None => &mut stages.wheels,
            };
            of.push((self.called(name), energy.mean));
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
        cell.accounts.iter().map(|(name, _)| (self.called(name), colour(name))).collect()
    }

    /// An account as the page calls it. What a store loses is named as the store in the ledger; in a picture of flows they
    /// are two, or the flow would come back to where it began.
    fn called(&self, name: &str) -> String {
        let mut accounts = self.summary.cells.iter().flat_map(|cell| &cell.accounts);
        match name.strip_prefix(FROM) {
            Some(source) => source.to_owned(),
            None if accounts.any(|(other, _)| other.strip_prefix(FROM) == Some(name)) => {
                format!("{name} loss")
            }
            None => name.to_owned(),
        }
    }
}

/// What stands on the other side of the ledger.
fn apart(name: &str) -> bool {
    name.starts_with(FROM) || name == "residual"
}

/// A plot, or why it cannot be drawn: one that cannot leaves the rest of the page.
fn or_why_not(plot: Plot) -> Item {
    let title = plot.title.clone();
    match plot.drawable() {
        Ok(()) => Item::Plot(plot),
        Err(error) => Item::Words(format!("{title} is not drawn: {error}.")),
    }
}

/// Mean energy of an account [J].
fn account(cell: &Cell, name: &str) -> Option<f64> {
    cell.accounts.iter().find(|(other, _)| other == name).map(|(_, energy)| energy.mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_report::{Flow, Report, Sankey};

    /// One account that was named as its source, and the whole page of a batch was lost.
    #[test]
    fn a_plot_that_cannot_be_drawn_is_told_and_the_page_is_made() {
        let flow = |from: &str, to: &str| Flow { from: from.to_owned(), to: to.to_owned(), value: 1.0 };
        let flows = vec![flow("battery", "driveline"), flow("driveline", "battery")];
        let plot =
            Plot::new("electric", Sankey { axis: Axis::new("energy", "J"), flows, ..Sankey::default() });
        let Item::Words(words) = or_why_not(plot.clone()) else { panic!("it was drawn") };
        assert!(words.contains("electric is not drawn") && words.contains("run in a circle"), "{words}");
        let page = Report::new("batch", "").with(Section::new("flows").with(or_why_not(plot)));
        assert!(page.to_html().is_ok());
    }
}
