//! The runs of a comparison: each is a number that says everything about it.
//!
//! Numbers count repetitions first, then points, grounds, cycles and variants. Nothing of a run is kept before it is run.

use crate::combine::{called, nowhere, seeds};
use crate::comparison::Comparison;
use crate::draw::{BASIS, hash};
use crate::entry::Entry;
use crate::error::BatchError;
use headland_plugin::Registry;
use headland_scenario::{Document, Piece, Scenario, ScenarioError};

/// More runs than this are a mistake: at a millisecond each they take three hours.
pub const MOST_RUNS: u64 = 10_000_000;

/// All runs of a comparison.
#[derive(Debug)]
pub struct Plan {
    /// What is compared.
    pub comparison: Comparison,
    /// Seed of the command line; it joins that of the comparison.
    pub seed: u64,
    total: u64,
    points: u64,
    strata: Vec<Vec<u32>>,
    combinations: Vec<Result<Document, ScenarioError>>,
}

/// One run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spec {
    /// Its number.
    pub number: u64,
    /// Index of the variant.
    pub variant: usize,
    /// Index of the cycle.
    pub cycle: usize,
    /// Index of the ground.
    pub ground: usize,
    /// Number of the point.
    pub point: u64,
    /// Number of the repetition, from 0.
    pub repetition: u32,
}

/// What a column of parameters holds in a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Setting {
    /// A number.
    Number(f64),
    /// Anything else, in RON.
    Text(String),
}

impl Plan {
    /// Puts every combination of variant, cycle and ground together and checks it.
    ///
    /// One whose values make no sense, or whose files cannot be used, is kept as [`Plan::refused`] beside those that can be
    /// run; its runs become rows with its error. What is written wrongly is an error of the comparison.
    ///
    /// # Errors
    /// [`BatchError::Scenario`] where a piece is written wrongly, [`BatchError::Combination`] where no combination can be
    /// used, [`BatchError::TooMany`].
    pub fn new(comparison: Comparison, registry: &Registry, seed: u64) -> Result<Self, BatchError> {
        let counts =
            [&comparison.variants, &comparison.cycles, &comparison.grounds].map(|one| one.len() as u128);
        let found = counts.iter().product::<u128>() * comparison.points.len() * u128::from(comparison.times);
        let total = u64::try_from(found).ok().filter(|total| *total <= MOST_RUNS);
        let total = total.ok_or_else(|| BatchError::TooMany {
            path: comparison.document.path().to_owned(),
            found,
            most: MOST_RUNS,
        })?;
        let points = u64::try_from(comparison.points.len()).unwrap_or(0);
        let mut combinations = Vec::new();
        for variant in &comparison.variants {
            for cycle in &comparison.cycles {
                for ground in &comparison.grounds {
                    combinations.push(match combination(&comparison, (variant, cycle, ground), registry) {
                        Ok(document) => Ok(document),
                        Err(BatchError::Combination { error, .. }) if is_of_values(&error) => Err(error),
                        Err(other) => return Err(other),
                    });
                }
            }
        }
        let strata = comparison.points.strata(seed);
        let plan = Self { comparison, seed, total, points, strata, combinations };
        let first = plan.refused().next().map(|(of, error)| (of, error.clone()));
        match first.filter(|_| plan.combinations.iter().all(Result::is_err)) {
            Some((of, error)) => Err(BatchError::Combination { of, error }),
            None => Ok(plan),
        }
    }

    /// Combinations that cannot be run: what each is called, and why.
    pub fn refused(&self) -> impl Iterator<Item = (String, &ScenarioError)> {
        let runs = self.points * u64::from(self.comparison.times);
        self.combinations.iter().enumerate().filter_map(move |(index, one)| {
            let error = one.as_ref().err()?;
            Some((self.combination_called(self.spec(index as u64 * runs)), error))
        })
    }

    /// Whether the variant, cycle and ground of a run can be put together.
    pub fn is_possible(&self, spec: Spec) -> bool {
        self.combinations[self.combination_index(spec)].is_ok()
    }

    fn combination_called(&self, spec: Spec) -> String {
        let comparison = &self.comparison;
        called(
            &comparison.variants[spec.variant],
            &comparison.cycles[spec.cycle],
            &comparison.grounds[spec.ground],
        )
    }

    /// How many runs there are.
    pub fn total(&self) -> u64 {
        self.total
    }

    /// How many combinations of variant, cycle and ground there are.
    pub fn combinations(&self) -> usize {
        self.combinations.len()
    }

    /// How many points each combination has.
    pub fn points(&self) -> u64 {
        self.points
    }

    /// What a number stands for.
    pub fn spec(&self, number: u64) -> Spec {
        let times = u64::from(self.comparison.times);
        let (rest, repetition) = (number / times, number % times);
        let (rest, point) = (rest / self.points, rest % self.points);
        let combination = usize::try_from(rest).unwrap_or(usize::MAX);
        let (grounds, cycles) = (self.comparison.grounds.len(), self.comparison.cycles.len());
        Spec {
            number,
            variant: combination / grounds / cycles,
            cycle: combination / grounds % cycles,
            ground: combination % grounds,
            point,
            repetition: u32::try_from(repetition).unwrap_or(0),
        }
    }

    /// The number of a run.
    pub fn number(&self, spec: Spec) -> u64 {
        let place = self.combination_index(spec) as u64;
        (place * self.points + spec.point) * u64::from(self.comparison.times) + u64::from(spec.repetition)
    }

    fn combination_index(&self, spec: Spec) -> usize {
        (spec.variant * self.comparison.cycles.len() + spec.cycle) * self.comparison.grounds.len()
            + spec.ground
    }

    /// Columns of parameters: what is swept, sampled, varied, and what scatters.
    pub fn columns(&self) -> Vec<&str> {
        let scatter = self.comparison.scatter.iter().map(|one| one.path.as_str());
        let mut columns: Vec<&str> = Vec::new();
        for path in self.comparison.points.moved().map(|(path, _)| path).chain(scatter) {
            if !columns.contains(&path) {
                columns.push(path);
            }
        }
        columns
    }

    /// The scenario of a run.
    ///
    /// # Errors
    /// [`ScenarioError`] where the values of the run cannot be put in.
    pub fn document(&self, spec: Spec) -> Result<Document, ScenarioError> {
        let base = self.combinations[self.combination_index(spec)].as_ref().map_err(Clone::clone)?;
        let values = self.comparison.points.at(spec.point, self.seed, &self.strata);
        let moved: Vec<(&str, String)> = self
            .comparison
            .points
            .moved()
            .zip(values)
            .filter_map(|((path, _), value)| Some((path, value?)))
            .collect();
        let mut document = if moved.is_empty() { base.clone() } else { base.replaced(&moved)? };
        let Some(seed) = self.comparison.seed else { return Ok(document) };
        let seed = seed.wrapping_add(self.seed);
        if !self.comparison.scatter.is_empty() {
            let scattered: Vec<(&str, f64)> = self
                .comparison
                .scatter
                .iter()
                .filter_map(|one| {
                    let value = document.number(&one.path)?;
                    Some((one.path.as_str(), one.value(value, seed, spec.repetition)))
                })
                .collect();
            document = document.with(&scattered)?;
        }
        let edits: Vec<_> = seeds(&document)
            .into_iter()
            .map(|(span, own)| (span, Piece::Own(repeated(own, seed, spec.repetition).to_string())))
            .collect();
        if edits.is_empty() { Ok(document) } else { document.edited(edits) }
    }

    /// What the columns of parameters hold in a run; `None` where the scenario has no single value there.
    pub fn settings(&self, spec: Spec) -> Vec<Option<Setting>> {
        let Ok(document) = self.document(spec) else { return vec![None; self.columns().len()] };
        let setting = |path: &str| {
            let node = document.find(path)?;
            Some(match document.number(path) {
                Some(number) => Setting::Number(number),
                None => Setting::Text(document.text()[node.span.clone()].to_owned()),
            })
        };
        self.columns().into_iter().map(setting).collect()
    }

    /// What a run is called in words.
    pub fn called(&self, spec: Spec) -> String {
        let comparison = &self.comparison;
        let parts = [
            &comparison.variants[spec.variant],
            &comparison.cycles[spec.cycle],
            &comparison.grounds[spec.ground],
        ];
        format!("run {} ({})", spec.number, parts.map(|part| part.name.as_str()).join(", "))
    }
}

/// The seed of a repetition: another one for each seed that is written and each repetition, and one that every
/// configuration file can hold.
fn repeated(own: f64, seed: u64, repetition: u32) -> u64 {
    let hash =
        hash(hash(hash(BASIS, &seed.to_le_bytes()), &own.to_bits().to_le_bytes()), &repetition.to_le_bytes());
    (hash >> 32) ^ (hash & 0xffff_ffff)
}

/// Whether a value or a file is at fault, rather than how the comparison is written.
fn is_of_values(error: &ScenarioError) -> bool {
    matches!(error, ScenarioError::Value { .. } | ScenarioError::Body { .. } | ScenarioError::File { .. })
}

fn combination(
    comparison: &Comparison,
    (variant, cycle, ground): (&Entry, &Entry, &Entry),
    registry: &Registry,
) -> Result<Document, BatchError> {
    let document = comparison.scenario(variant, cycle, ground)?;
    let of = |error: ScenarioError| BatchError::Combination { of: called(variant, cycle, ground), error };
    let (scenario, _) = Scenario::with_model(document.clone(), registry).map_err(of)?;
    let missing = |field: &str| ScenarioError::MissingField {
        field: field.to_owned(),
        of: "comparison".to_owned(),
        at: comparison.document.location(0),
    };
    if scenario.cycle.is_none() {
        return Err(of(missing("cycles")));
    }
    if !scenario.runs.is_empty() {
        let at = document.find("runs").map_or(0, |node| node.span.start);
        return Err(of(ScenarioError::Value {
            name: "runs".to_owned(),
            found: "given".to_owned(),
            expected: "variants, cycles and grounds in its place".to_owned(),
            at: document.location(at),
        }));
    }
    let scatter = comparison.scatter.iter().map(|one| (one.path.as_str(), one.at));
    for (path, at) in comparison.points.moved().chain(scatter.clone()) {
        if document.find(path).is_none() {
            return Err(nowhere(&comparison.document, path, at, (variant, cycle, ground)).into());
        }
    }
    for (path, at) in scatter {
        if document.number(path).is_none() {
            return Err(BatchError::Scenario(ScenarioError::Value {
                name: path.to_owned(),
                found: "no number".to_owned(),
                expected: "the path of a number".to_owned(),
                at: comparison.document.location(at),
            }));
        }
    }
    Ok(document)
}
