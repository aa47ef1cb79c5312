//! Recordings of which nothing can be concluded: channels that contradict each other, a vehicle that is another one,
//! runs in which nothing varies, too few runs.
//!
//! A cause is claimed on the word of the sensors. Where two of them cannot both be right, whatever closes the balance
//! would be an invention; so the diagnosis says what contradicts what, and names no cause. The bounds lie beyond what
//! any cause or fault of the library makes of a recording.

use crate::Case;
mod channels;

use crate::balances::balance::System;
use crate::proof::refine::Refined;
use crate::told::words::{capital, each_once};
use channels::{coasting, coasting_both_ways, forces, positions, powers, unforced};
use headland_calibrate::statistics::{quantile_of_sorted, sorted};

/// A channel that varies by less than this share of its median does not vary.
const STEADY: f64 = 0.1;
/// Rows that are averaged before forces are held against accelerations.
const TOGETHER: usize = 5;
/// Fewer rows than this tell nothing.
const FEWEST_ROWS: usize = 30;

/// What keeps anything from being concluded, one sentence each; nothing where the recording can be used. Samples that are
/// not `sound` are left out.
pub fn statements(case: &Case, sound: &[Vec<bool>]) -> Vec<String> {
    let mut all = Vec::new();
    // Without a balance there is nothing to conclude from, which is another error.
    if case.kinds.is_empty() {
        return all;
    }
    let system = &case.system(sound);
    all.extend(few_rows(case, system));
    all.extend(positions(case));
    all.extend(coasting(case));
    all.extend(coasting_both_ways(case));
    all.extend(forces(case, system));
    all.extend(unforced(case));
    all.extend(powers(case));
    if all.is_empty() {
        all.extend(steady(case, system));
    }
    all
}

/// Takes everything that was found away where no run was held out, and says what it was.
pub fn withhold(case: &Case, refined: &mut Refined) -> Option<String> {
    if case.fit.iter().zip(&case.bears).any(|(fit, bears)| !fit && *bears) {
        return None;
    }
    let names = each_once(refined.causes.iter().map(|cured| cured.cause.words));
    refined.causes.clear();
    let runs = case.bears.iter().filter(|bears| **bears).count();
    let runs = if runs == 1 { "one run".to_owned() } else { format!("{runs} runs") };
    let fits = if names.is_empty() {
        String::new()
    } else {
        format!(" {} would explain what was fitted, and so might much else.", capital(&names))
    };
    Some(format!(
        "With {runs} none can be held out, so no cause can be proven and none is claimed.{fits} Three runs are needed, \
         better ten."
    ))
}

fn few_rows(case: &Case, system: &System) -> Option<String> {
    let rows = |number: usize| -> usize {
        let own = system.chunks.iter().filter(|chunk| chunk.balance == number && case.fit[chunk.run]);
        own.map(|chunk| chunk.rows.len()).sum()
    };
    let most = (0..system.kinds.len()).map(rows).max().unwrap_or(0);
    (most < FEWEST_ROWS).then(|| {
        format!(
            "The vehicle moves, with everything recorded that a balance needs, for {most} short intervals only (channels \
             that stick are not used); {FEWEST_ROWS} are the least of which anything can be said."
        )
    })
}

/// Runs in which nothing varies: whatever is constant could be the cause.
fn steady(case: &Case, system: &System) -> Option<String> {
    let mut speeds = Vec::new();
    let mut others: Vec<Vec<f64>> = vec![Vec::new(); 2];
    let mut ways = [false; 2];
    let mut headings = Vec::new();
    for chunk in system.chunks.iter().filter(|chunk| case.fit[chunk.run]) {
        let drive = &case.runs[chunk.run];
        ways[usize::from(drive.measured.how.reversed_from_m.is_some())] = true;
        for group in chunk.rows.chunks_exact(chunk.rows.len().min(TOGETHER)) {
            let mean =
                |values: &[f64]| group.iter().map(|row| row.mean(values)).sum::<f64>() / group.len() as f64;
            speeds.push(mean(&drive.motion.value));
            headings.extend(drive.measured.trace.get("heading_rad").map(mean));
            let power =
                drive.measured.trace.get("battery_power_w").or(drive.measured.trace.get("fuel_rate_kg_s"));
            for (other, values) in others.iter_mut().zip([drive.force_n.as_deref(), power]) {
                other.extend(values.map(mean));
            }
        }
    }
    let varies = |values: &[f64], share: f64| {
        let values = sorted(&values.iter().copied().filter(|value| value.is_finite()).collect::<Vec<_>>());
        if values.is_empty() {
            return false;
        }
        let [low, middle, high] = [0.05, 0.5, 0.95].map(|share| quantile_of_sorted(&values, share));
        high - low > share * middle.abs()
    };
    // A radian is a turn; a force is never as steady as a speed.
    let turned =
        varies(&headings.iter().map(|heading| 1.0 + heading.sin()).collect::<Vec<_>>(), STEADY * 3.0)
            || varies(&headings.iter().map(|heading| 1.0 + heading.cos()).collect::<Vec<_>>(), STEADY * 3.0);
    let excited = varies(&speeds, STEADY)
        || ways == [true, true]
        || turned
        || others.iter().any(|values| varies(values, 3.0 * STEADY));
    (!excited).then(|| {
        "Nothing varies in these runs: one speed, one direction, one force. Every constant cause would explain them alike, \
         so none can be told. Drive both directions, at several speeds, and let the vehicle coast."
            .to_owned()
    })
}
