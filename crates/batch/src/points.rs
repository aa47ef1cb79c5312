//! Which values parameters take: every combination of a sweep, each row of a Latin hypercube, one end after the other.
//!
//! Source: McKay, Beckman and Conover, "A comparison of three methods for selecting values of input variables" (1979):
//! each of n samples lies in another of n equal strata of every parameter, anywhere within it.

use crate::comparison::expected;
use crate::draw::{generator, shuffled, uniform};
use crate::schema::SampleFile;
use crate::spread::{entries, number};
use headland_scenario::{Document, Node, ScenarioError, Shape};

/// A parameter that takes the values of a list.
#[derive(Clone, Debug, PartialEq)]
pub struct Listed {
    /// Dotted path.
    pub path: String,
    /// Its values in RON.
    pub values: Vec<String>,
    pub(crate) at: usize,
}

/// A parameter that is drawn from a range.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// Dotted path.
    pub path: String,
    /// Least and greatest value.
    pub ends: (f64, f64),
    /// Whether equal factors are equally likely, not equal steps.
    pub logarithmic: bool,
    pub(crate) at: usize,
}

/// All points of a comparison.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// Every combination of these.
    pub sweep: Vec<Listed>,
    /// A Latin hypercube of these.
    pub sample: Vec<Drawn>,
    /// Samples; 1 where there is none.
    pub count: u32,
    sample_seed: u64,
    /// First all as they are written, then each at its low and at its high end.
    pub vary: Vec<Listed>,
}

/// Most samples of a hypercube; their strata are held in memory.
const MOST_SAMPLES: u32 = 1_000_000;

/// Most values of a range; they are held in memory.
const MOST_SWEPT: u32 = 1_000_000;

impl Points {
    pub(crate) fn read(document: &Document) -> Result<Self, ScenarioError> {
        let mut points = Self { count: 1, ..Self::default() };
        if let Some(node) = document.find("sweep") {
            for (path, value, at) in some(document, node, "sweep")? {
                points.sweep.push(Listed { path, values: listed(document, value)?, at });
            }
        }
        if let Some(node) = document.find("sample") {
            let file: SampleFile = document.part(node, "sample")?;
            if file.count == 0 || file.count > MOST_SAMPLES {
                let count = document.find("sample.count").unwrap_or(node);
                return Err(expected(document, count, "count", &format!("1 to {MOST_SAMPLES}")));
            }
            (points.count, points.sample_seed) = (file.count, file.seed);
            let ranges = document.find("sample.of").unwrap_or(node);
            for (path, value, at) in some(document, ranges, "of")? {
                let (ends, logarithmic) = range(document, value)?;
                points.sample.push(Drawn { path, ends, logarithmic, at });
            }
        }
        if let Some(node) = document.find("vary") {
            for (path, value, at) in some(document, node, "vary")? {
                let values = match &value.shape {
                    Shape::Tuple { values, name: None } if values.len() == 2 => values,
                    _ => return Err(expected(document, value, "vary", "(low, high)")),
                };
                match [number(document, &values[0]), number(document, &values[1])] {
                    [Some(low), Some(high)] if low < high => {}
                    _ => return Err(expected(document, value, "vary", "two numbers, low below high")),
                }
                points.vary.push(Listed { path, values: texts(document, values), at });
            }
        }
        points.check(document)?;
        Ok(points)
    }

    /// A parameter may be moved by one of them only.
    fn check(&self, document: &Document) -> Result<(), ScenarioError> {
        let all: Vec<(&str, usize)> = self.moved().collect();
        for (index, (path, at)) in all.iter().enumerate() {
            if let Some((other, _)) =
                all[..index].iter().find(|(other, _)| inside(path, other) || inside(other, path))
            {
                return Err(ScenarioError::Value {
                    name: (*path).to_owned(),
                    found: format!("moved together with \"{other}\""),
                    expected: "each value moved once".to_owned(),
                    at: document.location(*at),
                });
            }
        }
        Ok(())
    }

    /// Paths that are moved, with their places, in the order of the columns.
    pub(crate) fn moved(&self) -> impl Iterator<Item = (&str, usize)> {
        self.sweep
            .iter()
            .map(|one| (one.path.as_str(), one.at))
            .chain(self.sample.iter().map(|one| (one.path.as_str(), one.at)))
            .chain(self.vary.iter().map(|one| (one.path.as_str(), one.at)))
    }

    /// How many points there are.
    pub fn len(&self) -> u128 {
        let sweep: u128 = self.sweep.iter().map(|one| one.values.len() as u128).product();
        sweep * u128::from(self.count) * self.vary_len() as u128
    }

    /// Whether there is no point, which never is.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn vary_len(&self) -> usize {
        1 + 2 * self.vary.len()
    }

    /// Which end of which varied parameter a point is at: (parameter, 0 low or 1 high); `None` for the middle.
    pub fn end_of(&self, point: u64) -> Option<(usize, usize)> {
        let step = usize::try_from(point % self.vary_len() as u64).ok()?.checked_sub(1)?;
        Some((step / 2, step % 2))
    }

    /// The strata of the hypercube, one order a parameter.
    pub(crate) fn strata(&self, seed: u64) -> Vec<Vec<u32>> {
        let seed = seed.wrapping_add(self.sample_seed);
        self.sample
            .iter()
            .map(|one| shuffled(self.count, &mut generator(seed, &one.path, u64::MAX)))
            .collect()
    }

    /// The values of a point in the order of [`Points::moved`]; `None` where the scenario's own stands.
    pub(crate) fn at(&self, point: u64, seed: u64, strata: &[Vec<u32>]) -> Vec<Option<String>> {
        let seed = seed.wrapping_add(self.sample_seed);
        let end = self.end_of(point);
        let rest = point / self.vary_len() as u64;
        let (row, mut rest) = (rest % u64::from(self.count), rest / u64::from(self.count));
        let mut sweep = vec![None; self.sweep.len()];
        for (value, one) in sweep.iter_mut().zip(&self.sweep).rev() {
            let length = one.values.len() as u64;
            *value = usize::try_from(rest % length).ok().map(|index| one.values[index].clone());
            rest /= length;
        }
        let sample = self.sample.iter().zip(strata).map(|(one, order)| {
            let index = usize::try_from(row).unwrap_or(0);
            let within = uniform(&mut generator(seed, &one.path, row));
            let share = (f64::from(order[index]) + within) / f64::from(self.count);
            let (low, high) = one.ends;
            let value =
                if one.logarithmic { low * (high / low).powf(share) } else { low + share * (high - low) };
            Some(format!("{value:?}"))
        });
        let vary = self.vary.iter().enumerate().map(|(index, one)| match end {
            Some((parameter, side)) if parameter == index => Some(one.values[side].clone()),
            _ => None,
        });
        sweep.into_iter().chain(sample).chain(vary).collect()
    }
}

/// Whether a path lies at or below another.
pub(crate) fn inside(path: &str, other: &str) -> bool {
    path.strip_prefix(other).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// As [`entries`], one at least: who moves nothing has forgotten what.
fn some<'a>(
    document: &Document,
    node: &'a Node,
    name: &str,
) -> Result<Vec<(String, &'a Node, usize)>, ScenarioError> {
    let all = entries(document, node, name)?;
    if all.is_empty() { Err(expected(document, node, name, "one path or more")) } else { Ok(all) }
}

fn texts(document: &Document, nodes: &[Node]) -> Vec<String> {
    nodes.iter().map(|node| document.text()[node.span.clone()].to_owned()).collect()
}

fn listed(document: &Document, node: &Node) -> Result<Vec<String>, ScenarioError> {
    const WANTED: &str =
        "a list of values, or Range(low, high, count) with two numbers and a count from 2 to 1000000";
    match &node.shape {
        Shape::List(values) if !values.is_empty() => Ok(texts(document, values)),
        Shape::Tuple { values, .. } if node.name(document.text()) == Some("Range") => {
            let [low, high, count] = values.as_slice() else {
                return Err(expected(document, node, "sweep", WANTED));
            };
            let count: Option<u32> = document.text()[count.span.clone()].parse().ok();
            match (number(document, low), number(document, high), count) {
                (Some(low), Some(high), Some(count)) if (2..=MOST_SWEPT).contains(&count) && low != high => {
                    let last = f64::from(count - 1);
                    let at = |step: u32| {
                        let share = f64::from(step) / last;
                        format!("{:?}", low * (1.0 - share) + high * share)
                    };
                    Ok((0..count).map(at).collect())
                }
                _ => Err(expected(document, node, "sweep", WANTED)),
            }
        }
        _ => Err(expected(document, node, "sweep", WANTED)),
    }
}

fn range(document: &Document, node: &Node) -> Result<((f64, f64), bool), ScenarioError> {
    const WANTED: &str = "(low, high), or Logarithmic(low, high) above 0, with low below high";
    let refuse = || expected(document, node, "of", WANTED);
    let Shape::Tuple { values, name } = &node.shape else { return Err(refuse()) };
    let logarithmic = match name.as_ref().map(|name| &document.text()[name.clone()]) {
        None => false,
        Some("Logarithmic") => true,
        Some(_) => return Err(refuse()),
    };
    let [low, high] = values.as_slice() else { return Err(refuse()) };
    match (number(document, low), number(document, high)) {
        (Some(low), Some(high)) if low < high && (low > 0.0 || !logarithmic) => {
            Ok(((low, high), logarithmic))
        }
        _ => Err(refuse()),
    }
}

#[cfg(test)]
#[path = "points_tests.rs"]
mod tests;
