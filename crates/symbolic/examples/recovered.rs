//! How often the search finds a law that somebody made up: random laws of several kinds, at two levels of noise, and none.
//!
//! ```sh
//! cargo run --release -p headland-symbolic --example recovered
//! ```

#[path = "../tests/search/plant.rs"]
mod plant;

use headland_symbolic::{Options, find};
use plant::{At, Dice, Plant};
use std::error::Error;
use std::f64::consts::TAU;
use std::io::Write;
use std::time::Instant;

type Law = Box<dyn Fn(&At) -> f64>;

/// A law of one of ten kinds with constants of its own, some 300 N large.
fn law(kind: usize, dice: &mut Dice) -> (&'static str, Law) {
    let f = dice.uniform(250.0, 450.0);
    match kind {
        0 => {
            let p = dice.uniform(2.5, 3.5);
            ("power of speed", Box::new(move |at| f * (at.v / 9.0).powf(p)))
        }
        1 => {
            let s = dice.uniform(0.8, 2.0);
            ("decay over speed", Box::new(move |at| f * (-at.v / s).exp()))
        }
        2 => {
            let (c, w) = (dice.uniform(3.0, 7.0), dice.uniform(0.7, 1.5));
            ("bump over speed", Box::new(move |at| f * (-((at.v - c) / w).powi(2)).exp()))
        }
        3 => {
            let s = dice.uniform(4.0, 12.0);
            ("decay over time", Box::new(move |at| 2.0 * f * (-at.t / s).exp()))
        }
        4 => {
            let (l, p) = (dice.uniform(9.0, 60.0), dice.uniform(0.0, TAU));
            ("wave over position", Box::new(move |at| f * (TAU * at.x / l + p).sin()))
        }
        5 => {
            let (s, p) = (dice.uniform(3.0, 9.0), dice.uniform(0.0, TAU));
            (
                "wave over time, growing with speed",
                Box::new(move |at| f * at.v / 6.0 * (TAU * at.t / s + p).cos()),
            )
        }
        6 => {
            let c = dice.uniform(60.0, 250.0);
            ("speed beyond a place", Box::new(move |at| if at.x > c { 0.25 * f * at.v } else { 0.0 }))
        }
        7 => {
            let c = dice.uniform(4.0, 7.0);
            ("beyond a speed, coasting", Box::new(move |at| at.coasting * 0.7 * f * (at.v - c).max(0.0)))
        }
        8 => {
            let s = dice.uniform(5.0, 20.0);
            (
                "temperature times speed",
                Box::new(move |at| 0.3 * f * at.v * (-at.temperature / s).exp() / 2.0),
            )
        }
        _ => {
            let (s, c) = (dice.uniform(1.0, 2.0), dice.uniform(80.0, 200.0));
            let bump = move |at: &At| (-((at.x - c) / 20.0_f64).powi(2)).exp();
            ("decay over speed and a place", Box::new(move |at| f * (-at.v / s).exp() + 1.5 * f * bump(at)))
        }
    }
}

/// Kinds of laws.
const KINDS: usize = 10;

fn main() -> Result<(), Box<dyn Error>> {
    let most = std::env::args().nth(1).map_or(Ok(4), |text| text.parse())?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "| law | noise of a row [N] | found | R² ≥ 0.9 held out | median R² | slowest [s] |")?;
    writeln!(out, "|---|---|---|---|---|---|")?;
    for sd_n in [100.0, 400.0] {
        let (mut all, mut good) = (0, 0);
        for kind in 0..KINDS {
            let (mut shares, mut found, mut slowest, mut name) = (Vec::new(), 0, 0.0_f64, "");
            for index in 0..most {
                let seed = (1 + kind * most + index) as u64;
                let plant = Plant::new(seed, 10, sd_n);
                let (told, law) = law(kind, &mut Dice::new(seed));
                name = told;
                let made = plant.problem(seed, &law);
                let begin = Instant::now();
                let answer = find(&made.problem(), &Options::default(), &|| false)?;
                slowest = slowest.max(begin.elapsed().as_secs_f64());
                let r2 = answer.law().map_or(0.0, |found| plant.held_out_r2(&made, &law, &found.prediction));
                found += usize::from(answer.law().is_some());
                if std::env::args().nth(2).is_some() {
                    let text = answer.law().map_or("-", |law| law.text.as_str());
                    writeln!(out, "  {r2:.3} {text} {:?}", answer.chance.steps)?;
                }
                shares.push(r2);
            }
            let passed = shares.iter().filter(|r2| **r2 >= 0.9).count();
            (all, good) = (all + shares.len(), good + passed);
            shares.sort_by(f64::total_cmp);
            let median = 0.5 * (shares[shares.len() / 2] + shares[(shares.len() - 1) / 2]);
            writeln!(
                out,
                "| {name} | {sd_n} | {found}/{most} | {passed}/{most} | {median:.3} | {slowest:.1} |"
            )?;
        }
        writeln!(out, "| all | {sd_n} | | {good}/{all} | | |")?;
    }
    let empty = 10 * most;
    let mut claimed = 0;
    for seed in 0..empty {
        let seed = 10_000 + seed as u64;
        let made = Plant::new(seed, 10, 100.0).problem(seed, |_| 0.0);
        claimed += usize::from(find(&made.problem(), &Options::default(), &|| false)?.law().is_some());
    }
    writeln!(out, "| none | 100 | {claimed}/{empty} | | | |")?;
    Ok(())
}
