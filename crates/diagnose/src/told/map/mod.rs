//! The map of the mismatch: where, and under which conditions, a balance does not close.
//!
//! What the free parameters leave is looked over along time in each run, and over position on each path, speed,
//! direction and temperature in all runs together.

mod axes;

use crate::Case;
use crate::balances::balance::{Kind, System};
use crate::balances::gram::Column;
use crate::balances::noise::{Noise, Noises};
use crate::balances::rows::Chunk;
use crate::single_runs::events::Event;
use crate::told::change_points::{Sample, Stretch, penalty, stretches as looked};
use axes::{Axis, axes, temperature, way};
use nalgebra::DVector;
use rayon::prelude::*;
use serde::Serialize;

/// Along what a mismatch was looked over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Over {
    /// Time in one run [s].
    Time,
    /// Position on one path [m].
    Position,
    /// Speed [m/s].
    Speed,
    /// Along the path (0) and against it (1).
    Direction,
    /// Temperature of air or oil [°C].
    Temperature,
}

/// A stretch in which a balance does not close.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mismatch {
    /// The balance.
    pub balance: Kind,
    /// Along what.
    pub over: Over,
    /// The run, where it is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run: Option<String>,
    /// The path, where it is one that has a name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// The channel, for temperatures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<String>,
    /// Begin, in `unit`.
    pub from: f64,
    /// End, in `unit`.
    pub to: f64,
    /// Whether it covers everything that was looked over.
    pub everywhere: bool,
    /// Unit of begin and end.
    pub unit: &'static str,
    /// Mean of measured minus modelled.
    pub mean: f64,
    /// Standard deviation of the mean.
    pub sd: f64,
    /// Unit of both.
    pub unit_of_mean: &'static str,
    /// So many standard deviations from nothing.
    pub sigma: f64,
}

/// A map over all balances.
#[derive(Clone, Debug, Default)]
pub struct Map {
    /// The stretches, by balance, by what was looked over, and by run or path.
    pub stretches: Vec<Mismatch>,
    /// Whether each of them was seen in runs that were fitted.
    pub fitted: Vec<bool>,
    /// The first balance from the ground up that does not close.
    pub first: Option<Kind>,
    /// For the first balance, along what its mismatch is told best.
    pub best: Option<Over>,
}

/// What is left of the rows of one balance.
struct Left<'a> {
    kind: Kind,
    noise: &'a Noise,
    /// Chunks and what is left of their rows.
    chunks: Vec<(&'a Chunk, &'a DVector<f64>)>,
}

/// The map of a residual. Runs that are held out appear along their own time and nowhere else.
pub fn map(case: &Case, system: &System, noises: &Noises, residual: &Column, events: &[Event]) -> Map {
    let mut map = Map::default();
    for (number, (kind, noise)) in system.kinds.iter().zip(&noises.each).enumerate() {
        let own = system.chunks.iter().zip(residual).filter(|(chunk, _)| chunk.balance == number);
        let left = Left { kind: *kind, noise, chunks: own.collect() };
        let seen: Vec<Vec<(Mismatch, f64)>> =
            axes(case, &left).par_iter().map(|axis| stretches(case, &left, axis)).collect();
        let spells = if *kind == Kind::Motion { spells(case, events) } else { Vec::new() };
        let fitted = |one: &Mismatch| {
            let run = case.runs.iter().position(|run| Some(&run.measured.id) == one.run.as_ref());
            run.is_none_or(|run| case.fit[run])
        };
        let all: Vec<(Mismatch, f64)> = seen.into_iter().flatten().chain(spells).collect();
        if map.first.is_none() && all.iter().any(|(one, _)| fitted(one)) {
            map.first = Some(*kind);
            map.best = best(all.iter().filter(|(one, _)| fitted(one)));
        }
        map.fitted.extend(all.iter().map(|(one, _)| fitted(one)));
        map.stretches.extend(all.into_iter().map(|(one, _)| one));
    }
    map
}

/// Along what the stretches bring most; a plainer thing first where they bring as much.
fn best<'a>(all: impl Iterator<Item = &'a (Mismatch, f64)>) -> Option<Over> {
    const PLAIN: [Over; 5] = [Over::Direction, Over::Temperature, Over::Speed, Over::Position, Over::Time];
    let mut brought = [0.0; PLAIN.len()];
    for (one, gain) in all {
        if let Some(place) = PLAIN.iter().position(|over| *over == one.over) {
            brought[place] += gain;
        }
    }
    let most = brought.iter().copied().fold(0.0, f64::max);
    // A tenth less for a plainer story is well spent.
    brought.iter().position(|gain| *gain > 0.9 * most && *gain > 0.0).map(|place| PLAIN[place])
}

fn spells(case: &Case, events: &[Event]) -> Vec<(Mismatch, f64)> {
    let one = |event: &Event| {
        let mismatch = Mismatch {
            balance: Kind::Motion,
            over: Over::Time,
            run: Some(case.runs[event.run].measured.id.clone()),
            path: None,
            channel: None,
            from: event.from_s,
            to: event.to_s,
            everywhere: false,
            unit: "s",
            mean: event.force_n,
            sd: event.sd_n,
            unit_of_mean: Kind::Motion.unit(),
            sigma: event.force_n / event.sd_n,
        };
        (mismatch, 2.0 * event.gain)
    };
    events.iter().map(one).collect()
}

/// Rows of the runs of an axis, each in its cell.
fn samples(case: &Case, left: &Left, axis: &Axis) -> Vec<Sample> {
    let mut samples: Vec<Sample> = Vec::new();
    let mut last: Option<(usize, usize)> = None;
    for (chunk, residual) in left.chunks.iter().filter(|(chunk, _)| axis.runs[chunk.run]) {
        let drive = &case.runs[chunk.run];
        for (row, value) in chunk.rows.iter().zip(residual.iter()) {
            let at = match axis.over {
                Over::Time => row.time_s,
                Over::Position => row.mean(&drive.position_m),
                Over::Speed => row.mean(&drive.motion.value),
                Over::Direction => f64::from(way(drive)),
                Over::Temperature => temperature(drive, row, axis.channel.as_deref().unwrap_or("")),
            };
            // A row that follows begins where the one before it has its middle.
            let linked = last == Some((chunk.run, row.samples[0]));
            last = Some((chunk.run, row.samples[1]));
            if !at.is_finite() || !value.is_finite() {
                last = None;
                continue;
            }
            let cell = axis.edges.partition_point(|edge| *edge <= at).clamp(1, axis.edges.len() - 1) - 1;
            samples.push(Sample { value: *value, cell, linked });
        }
    }
    samples
}

fn stretches(case: &Case, left: &Left, axis: &Axis) -> Vec<(Mismatch, f64)> {
    let samples = samples(case, left, axis);
    if samples.is_empty() {
        return Vec::new();
    }
    let rows: usize = left.chunks.iter().map(|(chunk, _)| chunk.rows.len()).sum();
    let penalty = penalty(rows);
    let cells = axis.edges.len() - 1;
    let found: Vec<Stretch> = looked(left.noise, &samples, cells, penalty);
    let unit = match axis.over {
        Over::Time => "s",
        Over::Position => "m",
        Over::Speed => "m/s",
        Over::Direction => "1",
        Over::Temperature => "°C",
    };
    let one = |stretch: Stretch| {
        let (from, to) = match axis.over {
            // 0 along the path, 1 against it.
            Over::Direction => (stretch.from as f64, (stretch.to - 1) as f64),
            _ => (axis.edges[stretch.from], axis.edges[stretch.to]),
        };
        let mismatch = Mismatch {
            balance: left.kind,
            over: axis.over,
            run: axis.run.clone(),
            path: axis.path.clone(),
            channel: axis.channel.clone(),
            from,
            to,
            everywhere: stretch.from == 0 && stretch.to == cells,
            unit,
            mean: stretch.mean,
            sd: stretch.sd,
            unit_of_mean: left.kind.unit(),
            sigma: stretch.mean / stretch.sd,
        };
        (mismatch, stretch.gain - penalty)
    };
    found.into_iter().map(one).collect()
}
