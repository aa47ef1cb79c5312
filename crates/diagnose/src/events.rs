//! Spells in single runs that no cause of every run explains: a brake that was not recorded, an implement let down.
//!
//! A matched filter: for every stretch of rows the constant force that would explain what is left, and by how much
//! ln p would grow, (xᵀΣ⁻¹r)² / (2 xᵀΣ⁻¹x). The best stretch is taken out, and the search goes on beside it.
//! Source: Kay, *Fundamentals of Statistical Signal Processing: Detection Theory* (1998), chapter 4.

use crate::Case;
use crate::balance::{Kind, System};
use crate::recorded::Recorded;
use crate::rows::{Chunk, Row};
use crate::search::Found;
use headland_units::constants::STANDARD_GRAVITY_M_S2;
use nalgebra::DVector;
use rayon::prelude::*;

/// A spell.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Index of the run.
    pub run: usize,
    /// Begin [s].
    pub from_s: f64,
    /// End [s].
    pub to_s: f64,
    /// Force against the motion [N].
    pub force_n: f64,
    /// Its standard deviation [N].
    pub sd_n: f64,
    /// Growth of ln p.
    pub gain: f64,
}

/// Growth of ln p from which on a spell is no accident among some ten thousand stretches.
pub const LEAST_GAIN: f64 = 40.0;
/// A weaker spell is what models of vehicles leave over anyway: share of the weight.
const WEAKEST: f64 = 0.02;
/// Lengths of stretches that are looked at, in rows.
const LENGTHS: [usize; 10] = [2, 3, 5, 8, 13, 21, 34, 55, 89, 144];
/// At most so many spells in a chunk.
const MOST: usize = 6;
/// Recordings begin and end while something is done: what lasts less than this at an edge is told of no vehicle [s].
const EDGE_S: f64 = 0.5;
const SHORT_S: f64 = 3.0;
/// What covers more than this share of a run is no spell in it.
const MOST_OF_A_RUN: f64 = 0.5;
/// A braked vehicle slows down at least like this [m/s²].
pub const BRAKED_M_S2: f64 = -0.25;

/// The spells of the motion balance, where there are some.
pub fn events(case: &Case, system: &System, found: &Found) -> Vec<Event> {
    let Some(whiteners) = found.noises.1.whiteners(&system.chunks) else { return Vec::new() };
    let of_chunk = |index: usize| -> Vec<Event> {
        let chunk = &system.chunks[index];
        if system.kind(chunk) != Kind::Motion {
            return Vec::new();
        }
        let whiten = |rows: &DVector<f64>| whiteners.white(index, chunk, rows);
        let boxes = Box::all(chunk, &whiten);
        let mut left = whiten(&found.left[index]);
        let mut all = Vec::new();
        for _ in 0..MOST {
            let judged = boxes.iter().filter_map(|one| {
                let product = one.white.dot(&left);
                (product > 0.0).then(|| (0.5 * product * product / one.square, product / one.square, one))
            });
            let best = judged.max_by(|one, other| one.0.total_cmp(&other.0));
            let Some((gain, force_n, one)) = best.filter(|(gain, ..)| *gain > LEAST_GAIN) else { break };
            left -= &one.white * force_n;
            all.push(one.event(&case.runs[chunk.run], chunk, force_n, gain));
        }
        all
    };
    let mut all: Vec<Event> = (0..system.chunks.len()).into_par_iter().flat_map_iter(of_chunk).collect();
    all.sort_by(|one, other| one.run.cmp(&other.run).then(one.from_s.total_cmp(&other.from_s)));
    let weight_n = |event: &Event| {
        let said = &case.nominal[event.run];
        said.effective_mass_kg.iter().find(|mass| mass.is_finite()).copied().unwrap_or(0.0)
            * STANDARD_GRAVITY_M_S2
    };
    let strong: Vec<Event> =
        joined(all).into_iter().filter(|event| event.force_n > WEAKEST * weight_n(event)).collect();
    let spell = |event: &&Event| {
        let time_s = case.runs[event.run].measured.trace.time_s();
        let (first_s, last_s) = (time_s[0], time_s[time_s.len() - 1]);
        let at_an_edge = event.from_s < first_s + EDGE_S || event.to_s > last_s - EDGE_S;
        let own = strong.iter().filter(|other| other.run == event.run);
        let covered_s: f64 = own.map(|other| other.to_s - other.from_s).sum();
        !(at_an_edge && event.to_s - event.from_s < SHORT_S) && covered_s < MOST_OF_A_RUN * (last_s - first_s)
    };
    strong.iter().filter(spell).cloned().collect()
}

/// A stretch of rows with a force of one.
struct Box {
    from: usize,
    length: usize,
    /// As it comes through the whitening.
    white: DVector<f64>,
    square: f64,
}

impl Box {
    /// Every stretch of a chunk.
    fn all(chunk: &Chunk, whiten: &dyn Fn(&DVector<f64>) -> DVector<f64>) -> Vec<Self> {
        let rows = chunk.rows.len();
        let lengths = LENGTHS.into_iter().filter(|length| 2 * length <= rows);
        let places = lengths.flat_map(|length| (0..=rows - length).map(move |from| (from, length)));
        places
            .map(|(from, length)| {
                let inside = |row: usize| f64::from((from..from + length).contains(&row));
                let white = whiten(&DVector::from_fn(rows, |row, _| inside(row)));
                Self { from, length, square: white.norm_squared(), white }
            })
            .collect()
    }

    fn event(&self, run: &Recorded, chunk: &Chunk, force_n: f64, gain: f64) -> Event {
        let time_s = run.measured.trace.time_s();
        let last = &chunk.rows[self.from + self.length - 1];
        let edge = |row: &Row| time_s[row.samples[1].min(time_s.len() - 1)];
        Event {
            run: chunk.run,
            from_s: edge(&chunk.rows[self.from]),
            to_s: edge(last).max(last.time_s),
            force_n,
            sd_n: self.square.sqrt().recip(),
            gain,
        }
    }
}

/// Spells that overlap or touch are one, with the force of their means.
fn joined(all: Vec<Event>) -> Vec<Event> {
    let mut joined: Vec<Event> = Vec::new();
    for event in all {
        match joined.last_mut() {
            Some(last) if last.run == event.run && event.from_s <= last.to_s + 0.3 => {
                let (one, other) = (last.to_s - last.from_s, event.to_s - event.from_s);
                last.force_n = (last.force_n * one + event.force_n * other) / (one + other).max(1e-9);
                last.to_s = last.to_s.max(event.to_s);
                last.gain += event.gain;
                last.sd_n = last.sd_n.max(event.sd_n);
            }
            _ => joined.push(event),
        }
    }
    joined
}

/// Samples that lie in no spell, run by run; a spell's edges go with it.
pub fn outside(runs: &[Recorded], events: &[Event], margin_s: f64) -> Vec<Vec<bool>> {
    runs.iter()
        .enumerate()
        .map(|(run, drive)| {
            let own: Vec<&Event> = events.iter().filter(|event| event.run == run).collect();
            let inside = |time: f64| {
                own.iter().any(|event| (event.from_s - margin_s..=event.to_s + margin_s).contains(&time))
            };
            drive.measured.trace.time_s().iter().map(|time| !inside(*time)).collect()
        })
        .collect()
}

/// What spells are called: brakes where the vehicle slows down without being driven, a pull at the hitch otherwise.
pub fn name(runs: &[Recorded], events: &[Event]) -> &'static str {
    let braked = |event: &&Event| {
        let drive = &runs[event.run];
        let time_s = drive.measured.trace.time_s();
        let within: Vec<usize> =
            (0..time_s.len()).filter(|index| (event.from_s..=event.to_s).contains(&time_s[*index])).collect();
        let mean = |of: &dyn Fn(usize) -> f64| {
            within.iter().map(|index| of(*index)).sum::<f64>() / within.len().max(1) as f64
        };
        let slowing = mean(&|index| drive.motion.slope[index]) < BRAKED_M_S2;
        let driven = drive.force_n.as_ref().map_or(0.0, |force| mean(&|index| force[index]));
        slowing && driven < 0.25 * event.force_n
    };
    let count = events.iter().filter(braked).count();
    if 2 * count >= events.len() { "braking" } else { "drawbar_load" }
}
