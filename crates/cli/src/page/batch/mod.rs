//! The page of a batch: what an engineer of drivelines puts on a slide.

mod energy;
mod pareto;
mod sensitivity;
mod tables;

pub use tables::{much_made_up, much_short};

use crate::command::batch::counted;
use crate::failure::Failure;
use crate::page::short;
use headland_batch::{Cell, Measure, Plan, Statistics, Summary};
use headland_plugin::Registry;
use headland_report::{Axis, Bar, Bars, Figure, Item, Plot, Report, Section};

/// What is compared where the comparison does not say.
const USUAL: [Measure; 7] = [
    Measure::FuelPerHectare,
    Measure::Fuel,
    Measure::Electricity,
    Measure::Time,
    Measure::Co2,
    Measure::SpecificFuel,
    Measure::AreaRate,
];

/// Cycles on grounds that are shown one by one; tables hold all.
const IN_DETAIL: usize = 9;

/// Measures that are shown as bars.
const BARS: usize = 3;
/// Places that the first lines of the page name.
const TOLD: usize = 3;

/// What all parts of the page look at.
#[derive(Clone, Copy)]
struct Content<'a> {
    plan: &'a Plan,
    summary: &'a Summary,
}

/// Indices of the measures to compare by, those that are there.
pub fn asked(plan: &Plan, summary: &Summary) -> Vec<usize> {
    let present = summary.present();
    let wanted: &[Measure] = if plan.comparison.by.is_empty() { &USUAL } else { &plan.comparison.by };
    wanted
        .iter()
        .filter_map(|measure| summary.measures.iter().position(|other| other == measure))
        .filter(|index| present.contains(index))
        .collect()
}

/// Makes the page.
pub fn page(plan: &Plan, summary: &Summary, registry: &Registry) -> Result<Report, Failure> {
    let content = Content { plan, summary };
    let lede = format!("{}. {}", counted(plan), content.verdict());
    let mut report = Report::new(plan.comparison.about.clone(), lede).with(content.overview());
    let parts = [
        content.energy(registry)?,
        content.pareto(),
        content.sensitivity(),
        content.charge(),
        content.slowed(),
        content.troubles(),
    ];
    for section in parts.into_iter().flatten() {
        report = report.with(section);
    }
    Ok(report)
}

impl Content<'_> {
    fn variant(&self, index: usize) -> &str {
        &self.plan.comparison.variants[index].name
    }

    /// Cycle and ground, as far as there is more than one.
    fn place(&self, cycle: usize, ground: usize) -> String {
        let comparison = &self.plan.comparison;
        let (cycles, grounds) = (&comparison.cycles, &comparison.grounds);
        match (cycles.len() > 1, grounds.len() > 1) {
            (false, true) => grounds[ground].name.clone(),
            (true, true) => format!("{}, {}", cycles[cycle].name, grounds[ground].name),
            _ => cycles[cycle].name.clone(),
        }
    }

    /// Every cycle on every ground.
    fn places(&self) -> Vec<(usize, usize)> {
        let comparison = &self.plan.comparison;
        let (cycles, grounds) = (comparison.cycles.len(), comparison.grounds.len());
        (0..cycles).flat_map(|cycle| (0..grounds).map(move |ground| (cycle, ground))).collect()
    }

    fn cell(&self, variant: usize, (cycle, ground): (usize, usize)) -> Option<&Cell> {
        let of = |cell: &&Cell| (cell.variant, cell.cycle, cell.ground) == (variant, cycle, ground);
        self.summary.cells.iter().find(of)
    }

    fn axis(&self, index: usize) -> Axis {
        let (name, unit) = self.summary.measures[index].label(&self.plan.comparison.accounting);
        Axis::new(name, unit)
    }

    /// One sentence: which variant is best by what is asked first, and by how much.
    fn verdict(&self) -> String {
        let asked = asked(self.plan, self.summary);
        let (Some(&index), Some(base)) = (asked.first(), self.plan.comparison.baseline) else {
            return String::new();
        };
        let more = self.summary.measures[index].more_is_better() == Some(true);
        let name = self.axis(index).label;
        let mut words = Vec::new();
        for place in self.places().into_iter().take(TOLD) {
            let share = |variant: usize| {
                let share = self.cell(variant, place)?.against[index].mean;
                share.is_finite().then_some((variant, share))
            };
            let best = (0..self.plan.comparison.variants.len()).filter_map(share).min_by(|one, other| {
                (if more { -one.1 } else { one.1 }).total_cmp(&if more { -other.1 } else { other.1 })
            });
            if let Some((variant, share)) = best {
                words.push(format!(
                    "{} {} in {}",
                    self.variant(variant),
                    percent(share),
                    self.place(place.0, place.1)
                ));
            }
        }
        if words.is_empty() {
            return String::new();
        }
        let rest = if self.places().len() > TOLD { ", and so on below" } else { "" };
        format!("By {name}, the best against {}: {}{rest}.", self.variant(base), words.join("; "))
    }

    fn overview(&self) -> Section {
        let (plan, summary) = (self.plan, self.summary);
        let mut figures = vec![Figure::text("Runs", plan.total().to_string())];
        if summary.unfinished > 0 {
            figures.push(Figure::text("Without an end", summary.unfinished.to_string()));
        }
        let asked = asked(plan, summary);
        let mut section = Section::new("At a glance").with(Item::Figures(figures));
        for index in asked.iter().copied().filter(|index| self.differs(*index)).take(BARS) {
            section = section.with(self.bars(index));
        }
        section = section.with(self.results());
        if let Some(table) = self.differences(&asked) {
            section = section.with(table);
        }
        section
    }

    /// Whether a measure is another one in some variants than in others, so that a picture of it says something.
    fn differs(&self, index: usize) -> bool {
        let one = self.plan.comparison.variants.len() < 2;
        one || self.places().into_iter().any(|place| {
            let means: Vec<f64> = (0..self.plan.comparison.variants.len())
                .filter_map(|variant| Some(self.cell(variant, place)?.measures[index].mean))
                .collect();
            varies(&means)
        })
    }

    /// Bars of a measure, the spread of repetitions on them.
    fn bars(&self, index: usize) -> Plot {
        let places: Vec<_> = self.places().into_iter().take(IN_DETAIL).collect();
        let all = |variant: usize| -> Vec<Statistics> {
            places
                .iter()
                .map(|place| self.cell(variant, *place).map(|cell| cell.measures[index]).unwrap_or_default())
                .collect()
        };
        let variants = 0..self.plan.comparison.variants.len();
        let spread = variants.clone().any(|variant| all(variant).iter().any(|one| one.deviation() > 0.0));
        let bar = |variant: usize| {
            let all = all(variant);
            let end = |sign: f64| all.iter().map(|one| one.mean + sign * one.deviation()).collect();
            Bar {
                name: self.variant(variant).to_owned(),
                values: all.iter().map(|one| one.mean).collect(),
                error: spread.then(|| (end(-1.0), end(1.0))),
            }
        };
        let axis = self.axis(index);
        let bars: Vec<Bar> = variants.map(bar).collect();
        let words = if spread {
            "Bars are means of all runs of a configuration; the marks on them are one standard deviation."
        } else {
            ""
        };
        let title = capital(&axis.label);
        let categories = places.iter().map(|(cycle, ground)| self.place(*cycle, *ground)).collect();
        Plot::new(title, Bars { categories, axis, bars, ..Bars::default() }).words(words)
    }
}

/// Whether values differ by more than a thousandth of the largest.
fn varies(values: &[f64]) -> bool {
    let (least, greatest) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |ends, value| (ends.0.min(*value), ends.1.max(*value)));
    greatest - least > 1e-3 * greatest.abs().max(least.abs())
}

/// `−5.4 %`
fn percent(share: f64) -> String {
    let share = (share * 1000.0).round() / 1000.0;
    format!("{}{} %", if share > 0.0 { "+" } else { "" }, short(100.0 * share))
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
