//! What a report says of a batch: statistics of each configuration, differences to the baseline, what parameters do.
//!
//! Differences are paired: a run is held against the run of the baseline with the same cycle, ground, point and
//! repetition, which met the same soil and the same scatter. Their spread is what repetitions leave of the difference.

use crate::error::BatchError;
use crate::journal::Journal;
use crate::measure::{Measure, made_up};
use crate::plan::{Plan, Setting, Spec};
use crate::row::{Row, Status, account_of_column};
use crate::statistics::{Line, Products, Statistics};

/// A variant in a cycle on a ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Index of the variant.
    pub variant: usize,
    /// Index of the cycle.
    pub cycle: usize,
    /// Index of the ground.
    pub ground: usize,
    /// Runs that reached the end of the cycle; all statistics are of them, less those in which one parameter is varied.
    pub finished: u64,
    /// Runs that did not.
    pub unfinished: u64,
    /// Way that all finished runs made [m].
    pub way_m: f64,
    /// Way that phases of theirs made less than their speeds ask for [m].
    pub short_m: f64,
    /// One for each measure, in its unit.
    pub measures: Vec<Statistics>,
    /// Differences to the baseline as a share of it, one for each measure.
    pub against: Vec<Statistics>,
    /// Energy of each account [J].
    pub accounts: Vec<(String, Statistics)>,
    /// Change of the state of charge.
    pub charge: Statistics,
    /// What making up for it adds to the fuel that was burnt, as a share of that.
    pub made_up: Statistics,
    /// Fuel [kg] over energy that electric stores gave [J]; without points unless the charge at the start alone is moved.
    pub fuel_over_store: Line,
}

/// What a parameter does to a measure, as a share of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Effect {
    /// Index of the variant.
    pub variant: usize,
    /// Index of the column of parameters.
    pub parameter: usize,
    /// Least and greatest value of the parameter.
    pub ends: (f64, f64),
    /// One for each measure: change at the least and at the greatest value, against the middle; NaN where not known.
    pub changes: Vec<(f64, f64)>,
}

/// A configuration, with the means of its repetitions.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The first of its runs.
    pub spec: Spec,
    /// One for each measure.
    pub measures: Vec<f64>,
}

/// What a report says of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// What is measured.
    pub measures: Vec<Measure>,
    /// Every variant, cycle and ground.
    pub cells: Vec<Cell>,
    /// What parameters do.
    pub effects: Vec<Effect>,
    /// Configurations, evenly thinned where there are very many.
    pub choices: Vec<Choice>,
    /// One of so many configurations is a choice.
    pub one_choice_of: u64,
    /// Runs that reached the end of their cycle.
    pub finished: u64,
    /// Runs that did not.
    pub unfinished: u64,
    /// The first of those that did not: number, how they ended, why.
    pub troubles: Vec<(u64, Status, String)>,
}

/// A correction for charge beyond this share of the fuel burnt is told: SAE J1711 and ISO 23274-1 allow 1 %, of drives on a
/// dynamometer that repeat themselves.
const MUCH_MADE_UP: f64 = 0.03;

/// Runs that make this share less of their way than their speeds ask for did other work than is written.
const MUCH_SHORT: f64 = 0.05;

/// Most configurations that a picture holds.
const MOST_CHOICES: u64 = 4000;
/// Most troubles that a page tells.
const MOST_TROUBLES: usize = 20;

impl Summary {
    /// Reads the journal once, and for every run those that it is held against.
    ///
    /// # Errors
    /// [`BatchError::File`].
    pub fn of(plan: &Plan, journal: &mut Journal) -> Result<Self, BatchError> {
        let mut gathered = Gathered::new(plan);
        for number in 0..plan.total() {
            if let Some(row) = journal.row(number)? {
                gathered.add(plan, journal, &row)?;
            }
        }
        gathered.close_choice();
        Ok(gathered.summary(plan))
    }

    /// The measures that at least one run has.
    pub fn present(&self) -> Vec<usize> {
        (0..self.measures.len())
            .filter(|index| self.cells.iter().any(|cell| cell.measures[*index].count > 0))
            .collect()
    }
}

struct Gathered {
    measures: Vec<Measure>,
    cells: Vec<Cell>,
    /// For each cell and measure: numeric columns and the measure.
    products: Vec<Vec<Products>>,
    /// For each variant, varied parameter and end: changes of each measure.
    varied: Vec<Vec<[Vec<Statistics>; 2]>>,
    /// Columns whose slopes are asked: swept and sampled numbers.
    columns: Vec<usize>,
    ends: Vec<(f64, f64)>,
    choices: Vec<Choice>,
    one_choice_of: u64,
    open: Option<(Spec, Vec<Statistics>)>,
    troubles: Vec<(u64, Status, String)>,
    /// Whether runs of a configuration differ in the charge that they begin with and in nothing else.
    charges: bool,
}

impl Gathered {
    fn new(plan: &Plan) -> Self {
        let comparison = &plan.comparison;
        let measures = Measure::ALL.to_vec();
        let (variants, cycles, grounds) =
            (comparison.variants.len(), comparison.cycles.len(), comparison.grounds.len());
        let none = vec![Statistics::default(); measures.len()];
        let mut cells = Vec::new();
        for index in 0..variants * cycles * grounds {
            cells.push(Cell {
                variant: index / grounds / cycles,
                cycle: index / grounds % cycles,
                ground: index % grounds,
                finished: 0,
                unfinished: 0,
                way_m: 0.0,
                short_m: 0.0,
                measures: none.clone(),
                against: none.clone(),
                accounts: Vec::new(),
                charge: Statistics::default(),
                made_up: Statistics::default(),
                fuel_over_store: Line::default(),
            });
        }
        let slopes = comparison.points.sweep.len() + comparison.points.sample.len();
        let columns: Vec<usize> = (0..slopes).collect();
        let one = vec![Products::new(columns.len() + 1); measures.len()];
        let ends_of_one = || [none.clone(), none.clone()];
        let configurations = cells.len() as u64 * plan.points();
        Self {
            products: vec![one; cells.len()],
            varied: vec![comparison.points.vary.iter().map(|_| ends_of_one()).collect(); variants],
            ends: vec![(f64::INFINITY, f64::NEG_INFINITY); columns.len()],
            one_choice_of: configurations.div_ceil(MOST_CHOICES).max(1),
            columns,
            cells,
            measures,
            choices: Vec::new(),
            open: None,
            troubles: Vec::new(),
            charges: comparison.scatter.is_empty() && {
                let mut moved = comparison.points.moved();
                matches!((moved.next(), moved.next()), (Some((path, _)), None) if path.ends_with("charge"))
            },
        }
    }

    fn add(&mut self, plan: &Plan, journal: &mut Journal, row: &Row) -> Result<(), BatchError> {
        let comparison = &plan.comparison;
        let spec = plan.spec(row.number);
        let index =
            (spec.variant * comparison.cycles.len() + spec.cycle) * comparison.grounds.len() + spec.ground;
        if row.status != Status::Finished {
            self.cells[index].unfinished += 1;
            if self.troubles.len() < MOST_TROUBLES {
                self.troubles.push((row.number, row.status, row.error.clone()));
            }
            return Ok(());
        }
        let all: Vec<f64> =
            self.measures.iter().map(|measure| measure.of(row, &comparison.accounting)).collect();
        // Where parameters are varied one by one, a configuration is what is written, not its variations.
        let varied = comparison.points.end_of(spec.point);
        if varied.is_none() {
            self.cells[index].take(row, &all);
        }
        if self.charges {
            self.cells[index].fuel_over_store.add(row.value("electricity_j"), row.value("fuel_kg"));
        }
        let cell = &mut self.cells[index];
        cell.finished += 1;
        cell.way_m += row.value("distance_m");
        cell.short_m += row.value("short_m");
        self.choose(plan, spec, &all);
        if varied.is_none()
            && let Some(base) = comparison.baseline.filter(|base| *base != spec.variant)
        {
            let base = plan.number(Spec { variant: base, ..spec });
            if let Some(shares) = self.shares(plan, journal, base, &all)? {
                self.cells[index].against.iter_mut().zip(shares).for_each(|(one, share)| one.add(share));
            }
        }
        if let Some((parameter, end)) = varied {
            let middle = spec.point - (1 + 2 * parameter + end) as u64;
            let middle = plan.number(Spec { point: middle, ..spec });
            if let Some(shares) = self.shares(plan, journal, middle, &all)? {
                let changes = &mut self.varied[spec.variant][parameter][end];
                changes.iter_mut().zip(shares).for_each(|(one, share)| one.add(share));
            }
        }
        if !self.columns.is_empty() {
            let settings = plan.settings(spec);
            let number = |column: &usize| match settings.get(*column) {
                Some(Some(Setting::Number(value))) => *value,
                _ => f64::NAN,
            };
            let mut values: Vec<f64> = self.columns.iter().map(number).collect();
            for (ends, value) in self.ends.iter_mut().zip(&values) {
                *ends = (ends.0.min(*value), ends.1.max(*value));
            }
            for (products, measure) in self.products[index].iter_mut().zip(&all) {
                values.push(*measure);
                products.add(&values);
                values.pop();
            }
        }
        Ok(())
    }

    /// Differences to another run as shares of it; `None` where that did not finish.
    fn shares(
        &self,
        plan: &Plan,
        journal: &mut Journal,
        other: u64,
        all: &[f64],
    ) -> Result<Option<Vec<f64>>, BatchError> {
        let Some(row) = journal.row(other)?.filter(|row| row.status == Status::Finished) else {
            return Ok(None);
        };
        let accounting = &plan.comparison.accounting;
        let share = |(measure, value): (&Measure, &f64)| {
            let base = measure.of(&row, accounting);
            if base == 0.0 { f64::NAN } else { (value - base) / base.abs() }
        };
        Ok(Some(self.measures.iter().zip(all).map(share).collect()))
    }

    fn choose(&mut self, plan: &Plan, spec: Spec, all: &[f64]) {
        let configuration = spec.number / u64::from(plan.comparison.times);
        let same = |open: &Spec| open.number / u64::from(plan.comparison.times) == configuration;
        if !self.open.as_ref().is_some_and(|(open, _)| same(open)) {
            self.close_choice();
            if configuration.is_multiple_of(self.one_choice_of) {
                self.open = Some((spec, vec![Statistics::default(); self.measures.len()]));
            }
        }
        if let Some((_, means)) = &mut self.open {
            means.iter_mut().zip(all).for_each(|(mean, value)| mean.add(*value));
        }
    }

    fn close_choice(&mut self) {
        if let Some((spec, means)) = self.open.take() {
            self.choices.push(Choice { spec, measures: means.iter().map(|one| one.mean).collect() });
        }
    }

    fn summary(self, plan: &Plan) -> Summary {
        let effects = self.effects(plan);
        let count = |of: fn(&Cell) -> u64| self.cells.iter().map(of).sum();
        Summary {
            finished: count(|cell| cell.finished),
            unfinished: count(|cell| cell.unfinished),
            measures: self.measures,
            cells: self.cells,
            effects,
            choices: self.choices,
            one_choice_of: self.one_choice_of,
            troubles: self.troubles,
        }
    }

    fn effects(&self, plan: &Plan) -> Vec<Effect> {
        let points = &plan.comparison.points;
        let mut effects = Vec::new();
        for (variant, varied) in self.varied.iter().enumerate() {
            for (at, &column) in self.columns.iter().enumerate() {
                let ends = self.ends[at];
                let changes: Vec<(f64, f64)> =
                    (0..self.measures.len()).map(|measure| self.slope(variant, measure, at)).collect();
                if ends.0 < ends.1 && changes.iter().any(|change| !change.0.is_nan()) {
                    effects.push(Effect { variant, parameter: column, ends, changes });
                }
            }
            for (index, (one, changes)) in points.vary.iter().zip(varied).enumerate() {
                let number = |side: usize| one.values[side].replace('_', "").parse().unwrap_or(f64::NAN);
                let change = |measure: usize| (changes[0][measure].mean, changes[1][measure].mean);
                effects.push(Effect {
                    variant,
                    parameter: points.sweep.len() + points.sample.len() + index,
                    ends: (number(0), number(1)),
                    changes: (0..self.measures.len()).map(change).collect(),
                });
            }
        }
        effects
    }

    /// Mean over the cells of a variant of what the range of a column changes in a measure, as shares of its mean.
    fn slope(&self, variant: usize, measure: usize, at: usize) -> (f64, f64) {
        let (low, high) = self.ends[at];
        let mut mean = Statistics::default();
        for (cell, products) in
            self.cells.iter().zip(&self.products).filter(|(cell, _)| cell.variant == variant)
        {
            let products = &products[measure];
            if cell.finished > 0
                && let Some(slopes) = products.slopes()
            {
                mean.add(slopes[at] * 0.5 * (high - low) / products.mean().abs());
            }
        }
        (-mean.mean, mean.mean)
    }
}

impl Cell {
    /// What making up for the charge adds to the fuel burnt, as a share of that, where it is so much that the fuel is more of the
    /// correction than of the runs.
    pub fn much_made_up(&self) -> Option<f64> {
        Some(self.made_up.mean).filter(|share| share.abs() > MUCH_MADE_UP)
    }

    /// What its runs made less of their way than their speeds ask for, as a share of that.
    pub fn short(&self) -> f64 {
        let asked_m = self.way_m + self.short_m;
        if asked_m > 0.0 { self.short_m / asked_m } else { 0.0 }
    }

    /// The same, where it is so much that other work was done than is written.
    pub fn much_short(&self) -> Option<f64> {
        Some(self.short()).filter(|share| *share > MUCH_SHORT)
    }

    fn take(&mut self, row: &Row, all: &[f64]) {
        self.measures.iter_mut().zip(all).for_each(|(one, value)| one.add(*value));
        for (name, energy_j) in &row.values {
            let Some(account) = account_of_column(name) else { continue };
            if let Some((_, statistics)) = self.accounts.iter_mut().find(|(other, _)| *other == account) {
                statistics.add(*energy_j);
            } else {
                let mut statistics = Statistics::default();
                statistics.add(*energy_j);
                self.accounts.push((account, statistics));
            }
        }
        self.charge.add(row.value("state_of_charge_end") - row.value("state_of_charge_start"));
        self.made_up.add(made_up(row));
    }
}
