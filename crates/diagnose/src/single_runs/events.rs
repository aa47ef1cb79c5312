//! Spells in single runs that no cause of every run explains: a brake that was not recorded, an implement let down.
//!
//! A matched filter: for every stretch of rows the constant force that would explain what is left, and by how much
//! ln p would grow, (xᵀΣ⁻¹r)² / (2 xᵀΣ⁻¹x). The best stretch is taken out, and the search goes on beside it.
//! Source: Kay, *Fundamentals of Statistical Signal Processing: Detection Theory* (1998), chapter 4.

use crate::Case;
use crate::balances::balance::{Kind, System};
use crate::balances::gram::Column;
use crate::balances::noise::Noises;
use crate::balances::rows::{Chunk, Row};
use crate::balances::steps::Open;
use crate::causes::trial::Pool;
use crate::choosing::search::Found;
use crate::choosing::state::State;
use crate::runs::recorded::Recorded;
use crate::single_runs::course::Step;
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
    /// How strong it is while it lasts; nothing where that is the same all the time.
    pub course: Vec<Step>,
}

impl Event {
    /// Begin, end [s] and force [N] of its steps, one after the other.
    pub fn steps(&self) -> Vec<(f64, f64, f64)> {
        if self.course.is_empty() {
            return vec![(self.from_s, self.to_s, self.force_n)];
        }
        let begins = std::iter::once(self.from_s).chain(self.course.iter().map(|step| step.to_s));
        begins.zip(&self.course).map(|(from_s, step)| (from_s, step.to_s, step.force_n)).collect()
    }
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
/// A spell is so many times what steps of the recorded force between two samples leave open, in standard deviations: a step at an
/// end of its interval is 1.7 of them off.
pub const OPEN: f64 = 2.5;
/// What covers more than this share of a run is no spell in it.
const MOST_OF_A_RUN: f64 = 0.5;
/// A braked vehicle slows down at least like this [m/s²].
pub const BRAKED_M_S2: f64 = -0.25;

/// A stretch of rows of a chunk with the force that explains most of what is left there.
#[derive(Clone, Debug)]
pub struct Spot {
    /// Number of the chunk.
    pub chunk: usize,
    /// First row and the one behind the last.
    pub rows: (usize, usize),
    /// As it stands in its run.
    pub event: Event,
}

/// Which stretches are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stretches {
    /// Of some lengths.
    Some,
    /// Of every length, longer ones in steps of a thirtieth, each moved to where it fits best beside the others.
    Every,
}

/// The stretches of the motion balance that stand out from a noise.
pub fn spots(
    case: &Case,
    system: &System,
    left: &Column,
    noises: &Noises,
    stretches: Stretches,
) -> Vec<Spot> {
    let Some(whiteners) = noises.whiteners(&system.chunks) else { return Vec::new() };
    let of_chunk = |index: usize| -> Vec<Spot> {
        let chunk = &system.chunks[index];
        if system.kind(chunk) != Kind::Motion {
            return Vec::new();
        }
        let whiten = |rows: &DVector<f64>| whiteners.white(index, chunk, rows);
        let boxes = Box::all(chunk, stretches, &whiten);
        let mut filter = Filter { boxes: &boxes, left: whiten(&left[index]), taken: Vec::new() };
        filter.take();
        if stretches == Stretches::Every {
            filter.shift();
        }
        let run = &case.runs[chunk.run];
        let told = filter.taken.iter().map(|taken| Spot {
            chunk: index,
            rows: (taken.of.from, taken.of.from + taken.of.length),
            event: taken.of.event(run, chunk, taken.force_n, taken.gain),
        });
        told.collect()
    };
    (0..system.chunks.len()).into_par_iter().flat_map_iter(of_chunk).collect()
}

/// The spells of the motion balance that are more than models of vehicles leave over, where there are some.
pub fn events(case: &Case, (system, pool): (&System, &Pool), found: &Found) -> Vec<Event> {
    let all = joined(spots(case, system, &found.left, &found.noises.1, Stretches::Some));
    let state = State { case, system, pool, fit: &case.fit };
    let strong = |event: &Event| {
        event.force_n > WEAKEST * weight_n(case, event.run) && state.is_told_beside(&found.stand.parts, event)
    };
    let strong: Vec<Event> = all.into_iter().filter(strong).collect();
    within_runs(case, &strong)
}

/// Weight of the vehicle in a run, nominally.
pub fn weight_n(case: &Case, run: usize) -> f64 {
    let masses = &case.nominal[run].effective_mass_kg;
    masses.iter().find(|mass| mass.is_finite()).copied().unwrap_or(0.0) * STANDARD_GRAVITY_M_S2
}

/// Of spells those that lie well within their run, do not cover most of it, and are no step of the force between two samples.
pub fn within_runs(case: &Case, events: &[Event]) -> Vec<Event> {
    let of_run = |run: &Recorded| {
        if events.iter().any(|event| event.run == run.number) { run.open() } else { None }
    };
    let open: Vec<Option<Open>> = case.runs.iter().map(of_run).collect();
    let spell = |event: &&Event| {
        let time_s = case.runs[event.run].measured.trace.time_s();
        let open = open[event.run].as_ref();
        let open_n = open.map_or(0.0, |open| open.spell_n(time_s, (event.from_s, event.to_s)));
        let (first_s, last_s) = (time_s[0], time_s[time_s.len() - 1]);
        let at_an_edge = event.from_s < first_s + EDGE_S || event.to_s > last_s - EDGE_S;
        let own = events.iter().filter(|other| other.run == event.run);
        let covered_s: f64 = own.map(|other| other.to_s - other.from_s).sum();
        !(at_an_edge && event.to_s - event.from_s < SHORT_S)
            && covered_s < MOST_OF_A_RUN * (last_s - first_s)
            && event.force_n > OPEN * open_n
    };
    events.iter().filter(spell).cloned().collect()
}

/// The filter of one chunk.
struct Filter<'a> {
    boxes: &'a [Box],
    /// What is left, whitened, without what was taken.
    left: DVector<f64>,
    taken: Vec<Taken<'a>>,
}

/// A stretch with the force that it takes.
struct Taken<'a> {
    of: &'a Box,
    force_n: f64,
    gain: f64,
}

impl<'a> Filter<'a> {
    /// The stretch that explains most of what is left, among some.
    fn best(&self, among: impl Fn(&Box) -> bool) -> Option<Taken<'a>> {
        let judged = self.boxes.iter().filter(|one| among(one)).filter_map(|of| {
            let product = of.white.dot(&self.left);
            let taken = Taken { of, force_n: product / of.square, gain: 0.5 * product * product / of.square };
            (product > 0.0).then_some(taken)
        });
        judged.max_by(|one, other| one.gain.total_cmp(&other.gain)).filter(|best| best.gain > LEAST_GAIN)
    }

    /// Takes one stretch after the other, the best first.
    fn take(&mut self) {
        while self.taken.len() < MOST {
            let Some(best) = self.best(|_| true) else { break };
            self.left -= &best.of.white * best.force_n;
            self.taken.push(best);
        }
    }

    /// Moves every stretch to where it explains most beside the others: what was taken first had to do for all.
    fn shift(&mut self) {
        const ROUNDS: usize = 3;
        for _ in 0..ROUNDS {
            for place in (0..self.taken.len()).rev() {
                let own = self.taken.remove(place);
                self.left += &own.of.white * own.force_n;
                if let Some(best) = self.best(|other| own.of.meets(other)) {
                    self.left -= &best.of.white * best.force_n;
                    self.taken.insert(place, best);
                }
            }
            self.take();
        }
    }
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
    fn all(chunk: &Chunk, stretches: Stretches, whiten: &dyn Fn(&DVector<f64>) -> DVector<f64>) -> Vec<Self> {
        let rows = chunk.rows.len();
        let lengths: Vec<usize> = match stretches {
            Stretches::Some => LENGTHS.into_iter().filter(|length| 2 * length <= rows).collect(),
            Stretches::Every => {
                let next = |length: &usize| Some(length + (length / 30).max(1));
                std::iter::successors(Some(LENGTHS[0]), next)
                    .take_while(|length| 2 * length <= rows)
                    .collect()
            }
        };
        let places =
            lengths.into_iter().flat_map(|length| (0..=rows - length).map(move |from| (from, length)));
        places
            .map(|(from, length)| {
                let inside = |row: usize| f64::from((from..from + length).contains(&row));
                let white = whiten(&DVector::from_fn(rows, |row, _| inside(row)));
                Self { from, length, square: white.norm_squared(), white }
            })
            .collect()
    }

    /// Whether two share a row.
    fn meets(&self, other: &Self) -> bool {
        self.from < other.from + other.length && other.from < self.from + self.length
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
            course: Vec::new(),
        }
    }
}

/// Spells that overlap or touch are one, with the force of their means.
pub fn joined(spots: Vec<Spot>) -> Vec<Event> {
    let mut all: Vec<Event> = spots.into_iter().map(|spot| spot.event).collect();
    all.sort_by(|one, other| one.run.cmp(&other.run).then(one.from_s.total_cmp(&other.from_s)));
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

/// What a spell is called, by what is on average within it.
fn name(runs: &[Recorded], event: &Event) -> &'static str {
    let drive = &runs[event.run];
    let time_s = drive.measured.trace.time_s();
    let within: Vec<usize> =
        (0..time_s.len()).filter(|index| (event.from_s..=event.to_s).contains(&time_s[*index])).collect();
    let mean = |of: &dyn Fn(usize) -> f64| {
        within.iter().map(|index| of(*index)).sum::<f64>() / within.len().max(1) as f64
    };
    let switch = drive.measured.trace.get("brake").map(|switch| mean(&|index| switch[index]));
    let slope_m_s2 = mean(&|index| drive.motion.slope[index]);
    let driven_n = drive.force_n.as_ref().map_or(0.0, |force| mean(&|index| force[index]));
    called(switch, slope_m_s2, driven_n / event.force_n)
}

/// Brakes where a switch says so, and without one where the vehicle slows down without being driven, but for this share of what
/// holds it back; a pull at the hitch otherwise.
fn called(switch: Option<f64>, slope_m_s2: f64, driven: f64) -> &'static str {
    let braked = switch.map_or(slope_m_s2 < BRAKED_M_S2 && driven < 0.25, |on| on >= 0.5);
    if braked { "braking" } else { "drawbar_load" }
}

/// Spells by what they are called. Few of the one kind among many of the other are of the same kind, and no implement is let
/// down and lifted again at once; where a switch is logged it says which is which.
pub fn named(runs: &[Recorded], events: &[Event]) -> Vec<(&'static str, Vec<Event>)> {
    /// Fewer than this share are few.
    const FEW: f64 = 0.25;
    /// A pull lasts longer than this [s].
    const AT_ONCE_S: f64 = 3.0;
    let (braked, mut pulled): (Vec<Event>, Vec<Event>) =
        events.iter().cloned().partition(|event| name(runs, event) == "braking");
    let switched = runs.iter().any(|run| run.measured.trace.get("brake").is_some());
    pulled.retain(|event| event.to_s - event.from_s > AT_ONCE_S);
    let events: Vec<Event> =
        events.iter().filter(|event| braked.contains(event) || pulled.contains(event)).cloned().collect();
    let few = |one: &[Event]| one.is_empty() || !switched && (one.len() as f64) < FEW * events.len() as f64;
    if events.is_empty() {
        Vec::new()
    } else if few(&pulled) {
        vec![("braking", events)]
    } else if few(&braked) {
        vec![("drawbar_load", events)]
    } else {
        vec![("braking", braked), ("drawbar_load", pulled)]
    }
}

#[cfg(test)]
mod tests {
    use super::called;

    /// A driver who presses both pedals brakes, and one who lets off the throttle at a hitch that pulls does not.
    #[test]
    fn a_switch_says_which_spell_is_braked() {
        assert_eq!(called(None, -1.0, 0.0), "braking");
        assert_eq!(called(None, -1.0, 0.6), "drawbar_load");
        assert_eq!(called(Some(1.0), -1.0, 0.6), "braking");
        assert_eq!(called(Some(0.1), -1.0, 0.0), "drawbar_load");
    }
}
