//! Levels of a switch by trying them: what it does jumps where a run just reaches a level or just does not, so that no slope leads
//! from one side of a jump to the other.

use crate::polish::{Polished, columns_of, with_columns};
use crate::problem::Bench;
use crate::shape::{Factor, Shape};

/// How far a level is moved to either side, as a share of the spread of its variable: as far as the grid of the dictionary is wide.
const REACH: f64 = 0.1;
/// Steps to either side.
const STEPS: i32 = 8;
/// Times that both levels are gone through at most.
const ROUNDS: usize = 3;

/// A law with the levels of its switches moved to where it leaves least.
pub(crate) fn levelled(bench: &Bench, start: Polished) -> Polished {
    let mut best = start;
    for _ in 0..ROUNDS {
        let before = best.cost;
        for (term, factor) in switches(&best) {
            // The other terms stay as they are.
            let mut columns = columns_of(bench, &best.terms);
            for moves in [moves_on, moves_off] {
                let own = best.terms[term].factors[factor];
                let spread = bench.variables[own.variable].spread();
                for step in (-STEPS..=STEPS).filter(|step| *step != 0) {
                    let by = REACH * spread * f64::from(step) / f64::from(STEPS);
                    let Some(moved) = moves(own, by) else { continue };
                    let mut terms = best.terms.clone();
                    terms[term].factors[factor] = moved;
                    columns[term] = bench.columns(&terms[term]);
                    let other = with_columns(bench, terms, &columns.concat());
                    if let Some(other) = other.filter(|other| other.cost < best.cost) {
                        best = other;
                    }
                }
            }
        }
        if best.cost >= before {
            break;
        }
    }
    best
}

/// Where its switches stand.
fn switches(law: &Polished) -> Vec<(usize, usize)> {
    let of = |(term, own): (usize, &crate::term::Term)| {
        let latches = [Shape::Latch, Shape::Unlatch];
        let latches = own.factors.iter().enumerate().filter(|(_, factor)| latches.contains(&factor.shape));
        latches.map(|(factor, _)| (term, factor)).collect::<Vec<_>>()
    };
    law.terms.iter().enumerate().flat_map(of).collect()
}

/// The level at which it goes on, and the other one stays.
fn moves_on(of: Factor, by: f64) -> Option<Factor> {
    sound(Factor { centre: of.centre + by, scale: of.scale + by, ..of })
}

/// The level at which it goes off.
fn moves_off(of: Factor, by: f64) -> Option<Factor> {
    sound(Factor { scale: of.scale - by, ..of })
}

/// It goes off below where it goes on.
fn sound(of: Factor) -> Option<Factor> {
    (of.scale > 0.0).then_some(of)
}
