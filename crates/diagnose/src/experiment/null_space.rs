//! Which combinations of free parameters and accepted causes the recordings know, and which they do not.

use crate::balances::gram::{Column, Whitened};
use crate::causes::trial::Pool;
use crate::choosing::search::Found;
use crate::proof::refine::Refined;
use crate::told::words::number;
use crate::{Case, System};
use headland_calibrate::separable::{Blind, blind_directions};

/// A parameter of a cause or of the scenario.
struct Candidate {
    /// As a sentence names it.
    name: String,
    unit: String,
    /// One standard deviation of its prior.
    size: f64,
    /// Its column.
    column: usize,
}

/// The directions that the recordings do not see, in sentences.
pub fn sentences(case: &Case, system: &System, pool: &Pool, found: &Found, refined: &Refined) -> Vec<String> {
    let candidates = candidates(case, pool, refined);
    let columns: Vec<&Column> = candidates.iter().map(|one| &pool.columns[one.column]).collect();
    let whitened = Whitened::new(&system.chunks, &system.residual, &columns, &found.noises.1);
    let Some(whitened) = whitened else { return Vec::new() };
    let information = whitened.reduced(&system.chunks, &case.fit).matrix;
    let sizes: Vec<f64> = candidates.iter().map(|one| one.size).collect();
    let names: Vec<&str> = candidates.iter().map(|one| one.name.as_str()).collect();
    let told = |blind: Blind| {
        let blind = without_slight(blind, &sizes);
        if blind.imitated_by.is_empty() { blind.told(&names) } else { together(&blind, &candidates) }
    };
    blind_directions(&information, &sizes).into_iter().map(told).collect()
}

/// Without what would move by next to nothing of how far it is known to: what only noise hides beside that is hidden by itself.
fn without_slight(blind: Blind, sizes: &[f64]) -> Blind {
    /// Of a standard deviation of its prior, for one of the candidate's.
    const SLIGHT: f64 = 0.05;
    if blind.exact {
        return blind;
    }
    let size = sizes[blind.candidate];
    let moves = |(index, share): &(usize, f64)| share.abs() * size >= SLIGHT * sizes[*index];
    Blind { imitated_by: blind.imitated_by.iter().copied().filter(moves).collect(), ..blind }
}

fn candidates(case: &Case, pool: &Pool, refined: &Refined) -> Vec<Candidate> {
    let unit = |name: &str| headland_units::unit_of_name(name).map_or_else(String::new, |unit| unit.symbol);
    let mut all: Vec<Candidate> = case
        .study
        .parameters
        .iter()
        .enumerate()
        .map(|(index, parameter)| Candidate {
            name: parameter.name.clone(),
            unit: unit(&parameter.name),
            size: pool.sd[index],
            column: index,
        })
        .collect();
    for cured in &refined.causes {
        if cured.cause.is_function() || !cured.events.is_empty() {
            continue;
        }
        let corrected = pool.corrected.iter().find(|(id, _)| *id == cured.cause.id);
        let trial = &cured.accepted.trial;
        let columns = corrected.map_or(trial.columns.clone(), |(_, column)| vec![*column]);
        for (column, term) in columns.into_iter().zip(&trial.terms) {
            let term = &cured.cause.terms[*term];
            all.push(Candidate {
                name: format!("{}.{}", cured.cause.id, term.name),
                unit: if term.unit == "1" { String::new() } else { term.unit.to_owned() },
                size: term.scale,
                column,
            });
        }
    }
    all
}

/// 'Raising this and lowering that changes nothing.'
fn together(blind: &Blind, candidates: &[Candidate]) -> String {
    /// So many standard deviations of a prior are still a vehicle: a straight line says nothing of one of a thousand tons.
    const FARTHEST: f64 = 20.0;
    let own = &candidates[blind.candidate];
    let amount = |value: f64, unit: &str| {
        if unit.is_empty() { number(value) } else { format!("{} {unit}", number(value)) }
    };
    let least = |(index, share): &(usize, f64)| FARTHEST * candidates[*index].size / (share.abs() * own.size);
    let step = own.size * blind.imitated_by.iter().map(least).fold(1.0, f64::min);
    let mut names = vec![format!("`{}`", own.name)];
    let mut moves = Vec::new();
    for (index, share) in &blind.imitated_by {
        let other = &candidates[*index];
        let way = if *share > 0.0 { "lowering" } else { "raising" };
        names.push(format!("`{}`", other.name));
        moves.push(format!("{way} `{}` by {}", other.name, amount(share.abs() * step, &other.unit)));
    }
    let nothing = if blind.exact { "nothing" } else { "next to nothing" };
    format!(
        "These recordings only know the sum of what {} do: raising `{}` by {} and {} changes {nothing} that was measured.",
        listed(&names),
        own.name,
        amount(step, &own.unit),
        listed(&moves)
    )
}

/// 'a, b and c'.
pub fn listed(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_hardly_moves_is_not_told_beside_what_noise_hides() {
        // A drag area of a slow vehicle, beside a mass known to 14 kg and a coefficient known to 0.0006.
        let blind = |exact: bool, mass: f64| Blind {
            candidate: 0,
            exact,
            imitated_by: vec![(1, mass), (2, -1.6e-4)],
            deviation: 0.2,
        };
        let sizes = [0.05, 14.0, 6e-4];
        let told = |exact: bool, mass: f64| without_slight(blind(exact, mass), &sizes).imitated_by;
        assert_eq!(told(false, 0.35), []);
        assert_eq!(told(false, 35.0), [(1, 35.0)]);
        assert_eq!(told(true, 0.35).len(), 2);
    }

    #[test]
    fn a_direction_is_told_with_what_to_raise_and_what_to_lower() {
        let candidate = |name: &str, unit: &str, size: f64| Candidate {
            name: name.to_owned(),
            unit: unit.to_owned(),
            size,
            column: 0,
        };
        let all = [candidate("soil.coefficient", "", 0.01), candidate("brake_drag.force_n", "N", 1000.0)];
        let blind =
            Blind { candidate: 1, exact: true, imitated_by: vec![(0, 7.84e-6)], deviation: f64::INFINITY };
        assert_eq!(
            together(&blind, &all),
            "These recordings only know the sum of what `brake_drag.force_n` and `soil.coefficient` do: raising \
             `brake_drag.force_n` by 1000 N and lowering `soil.coefficient` by 0.00784 changes nothing that was measured."
        );
        // A coefficient that would have to go by 0.784 goes by twenty times the 0.01 that it is uncertain.
        let far =
            Blind { candidate: 1, exact: true, imitated_by: vec![(0, 7.84e-4)], deviation: f64::INFINITY };
        assert!(
            together(&far, &all).contains("by 255 N and lowering `soil.coefficient` by 0.200"),
            "{}",
            together(&far, &all)
        );
    }
}
