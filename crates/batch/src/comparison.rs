//! A comparison as it is written: variants, cycles, grounds, what is varied and what is asked.

use crate::entry::{self, Entry};
use crate::measure::Measure;
use crate::points::Points;
use crate::schema::{Charge, Electricity, Fuel, RepeatFile, ReportFile};
use crate::spread::Scatter;
use headland_scenario::{Document, Node, ScenarioError, Shape};
use std::ops::Range;
use std::path::Path;

/// A field of a scenario: its name and where its value stands in the comparison.
pub(crate) type ScenarioField = (String, Range<usize>);

/// A comparison, read and checked apart from the scenarios that it stands for.
#[derive(Clone, Debug)]
pub struct Comparison {
    pub(crate) document: Document,
    /// What it is about, in its own words.
    pub about: String,
    /// What is compared.
    pub variants: Vec<Entry>,
    /// What they do.
    pub cycles: Vec<Entry>,
    /// What they do it on.
    pub grounds: Vec<Entry>,
    /// Fields that all scenarios share.
    pub(crate) common: Vec<ScenarioField>,
    /// Parameters that are swept, sampled or varied one by one.
    pub points: Points,
    /// How often each is repeated.
    pub times: u32,
    /// Seed of the repetitions; `None` where nothing is drawn.
    pub seed: Option<u64>,
    /// What scatters between repetitions.
    pub scatter: Vec<Scatter>,
    /// What energy is worth.
    pub accounting: Accounting,
    /// Index of the variant that the others are held against.
    pub baseline: Option<usize>,
    /// What the report compares; empty where it shows what there is.
    pub by: Vec<Measure>,
}

/// What energy is worth; `None` is not known and not computed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Accounting {
    /// The fuel.
    pub fuel: Option<Fuel>,
    /// Electricity from the grid.
    pub electricity: Option<Electricity>,
    /// How a change of charge is made up for.
    pub charge: Option<Charge>,
}

/// Fields of a comparison; every other one is a field of its scenarios.
const OWN: [&str; 12] = [
    "about",
    "variants",
    "cycles",
    "grounds",
    "sweep",
    "sample",
    "vary",
    "repeat",
    "fuel",
    "electricity",
    "charge",
    "report",
];

impl Comparison {
    /// Whether a document is a comparison rather than a scenario.
    pub fn is(document: &Document) -> bool {
        ["variants", "cycles", "grounds", "sweep", "sample", "vary", "repeat"]
            .iter()
            .any(|field| document.tree().field(field).is_some())
    }

    /// Reads a comparison.
    ///
    /// # Errors
    /// [`ScenarioError`] says what, where, and what was expected.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        Self::of(Document::read(path)?)
    }

    /// As [`Comparison::read`], from a text; `name` stands for the file, `folder` is where its includes lie.
    ///
    /// # Errors
    /// As [`Comparison::read`].
    pub fn of_text(name: &str, text: &str, folder: &Path) -> Result<Self, ScenarioError> {
        Self::of(Document::of_text(name, text, folder)?)
    }

    /// As [`Comparison::read`], from a document.
    ///
    /// # Errors
    /// As [`Comparison::read`].
    pub fn of(document: Document) -> Result<Self, ScenarioError> {
        let Shape::Struct { fields, .. } = &document.tree().shape else {
            return Err(expected(&document, document.tree(), "comparison", "fields in parentheses"));
        };
        let about: String = match document.find("about") {
            Some(node) => document.part(node, "about")?,
            None => {
                return Err(ScenarioError::MissingField {
                    field: "about".to_owned(),
                    of: "comparison".to_owned(),
                    at: document.location(document.tree().span.start),
                });
            }
        };
        let common: Vec<ScenarioField> = fields
            .iter()
            .filter(|field| !OWN.contains(&field.key.as_str()))
            .map(|field| (field.key.clone(), field.value.span.clone()))
            .collect();
        let variants = entry::entries(&document, &entry::VARIANTS)?;
        let cycles = entry::entries(&document, &entry::CYCLES)?;
        let grounds = entry::entries(&document, &entry::GROUNDS)?;
        let repeat: Option<RepeatFile> = part(&document, "repeat")?;
        if let Some(RepeatFile { times: 0, .. }) = repeat {
            return Err(expected_at(&document, "repeat.times", "times", "0", "1 or more"));
        }
        let accounting = accounting(&document)?;
        let report: Option<ReportFile> = part(&document, "report")?;
        let baseline = baseline(&document, &variants, report.as_ref())?;
        Ok(Self {
            about,
            points: Points::read(&document)?,
            times: repeat.as_ref().map_or(1, |repeat| repeat.times),
            seed: repeat.as_ref().map(|repeat| repeat.seed),
            scatter: Scatter::read(&document)?,
            accounting,
            baseline,
            by: report.map_or_else(Vec::new, |report| report.by),
            variants,
            cycles,
            grounds,
            common,
            document,
        })
    }

    /// The resolved text and where it comes from.
    pub fn document(&self) -> &Document {
        &self.document
    }
}

fn part<T: serde::de::DeserializeOwned>(document: &Document, key: &str) -> Result<Option<T>, ScenarioError> {
    document.find(key).map(|node| document.part(node, key)).transpose()
}

/// Which variant is the baseline: the one that is named, else the first where there are several.
fn baseline(
    document: &Document,
    variants: &[Entry],
    report: Option<&ReportFile>,
) -> Result<Option<usize>, ScenarioError> {
    let Some(name) = report.and_then(|report| report.baseline.as_ref()) else {
        return Ok((variants.len() > 1).then_some(0));
    };
    match variants.iter().position(|variant| variant.name == *name) {
        Some(index) => Ok(Some(index)),
        None => Err(ScenarioError::UnknownName {
            kind: "variant".to_owned(),
            found: name.clone(),
            known: variants.iter().map(|variant| variant.name.clone()).collect(),
            more: None,
            at: document.location(document.find("report.baseline").map_or(0, |node| node.span.start)),
        }),
    }
}

fn accounting(document: &Document) -> Result<Accounting, ScenarioError> {
    let accounting = Accounting {
        fuel: part(document, "fuel")?,
        electricity: part(document, "electricity")?,
        charge: part(document, "charge")?,
    };
    for (path, least_open, most) in [
        ("fuel.density_kg_m3", 0.0, f64::INFINITY),
        ("fuel.co2_kg_per_kg", -f64::MIN_POSITIVE, f64::INFINITY),
        ("electricity.co2_kg_j", -f64::MIN_POSITIVE, f64::INFINITY),
        ("charge.charging_efficiency", 0.0, 1.0),
        ("charge.discharging_efficiency", 0.0, 1.0),
    ] {
        if let Some(value) = document.number(path)
            && !(value > least_open && value <= most && value.is_finite())
        {
            let wanted = match (least_open, most) {
                (0.0, 1.0) => "more than 0 and at most 1",
                (0.0, _) => "more than 0",
                _ => "0 or more",
            };
            let name = path.rsplit('.').next().unwrap_or(path);
            return Err(expected_at(document, path, name, &value.to_string(), wanted));
        }
    }
    Ok(accounting)
}

/// What was found at a node is not what was expected.
pub(crate) fn expected(document: &Document, node: &Node, name: &str, wanted: &str) -> ScenarioError {
    let found = document.text()[node.span.clone()].lines().next().unwrap_or("").trim().to_owned();
    ScenarioError::Value {
        name: name.to_owned(),
        found,
        expected: wanted.to_owned(),
        at: document.location(node.span.start),
    }
}

fn expected_at(document: &Document, path: &str, name: &str, found: &str, wanted: &str) -> ScenarioError {
    ScenarioError::Value {
        name: name.to_owned(),
        found: found.to_owned(),
        expected: wanted.to_owned(),
        at: document.location(document.find(path).map_or(0, |node| node.span.start)),
    }
}
