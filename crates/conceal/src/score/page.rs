//! The score as a page of Markdown.

use super::judge::{Covered, Found, IN_EFFECT, Outcome};
use super::run::{Options, Scored};
use super::statistics::wilson;
use crate::twins::APART;
use std::collections::BTreeMap;
use std::fmt::Write;

/// A cause weaker than this many times the noise of its balance is not expected to be found.
const STRONG: f64 = 2.0;

/// How it is counted.
const RULES: &str = "An honest doubt is the verdict `cannot_tell` that names the cause as finding or alternative. A twin is a cause \
that nobody could tell from the hidden one in these runs (expected ln p of less than 3 between them, with the free parameters moved \
within their spreads); it counts as right where it names the hidden one as its alternative, or where its force on held-out runs has \
R² ≥ 0.9. An unlisted cause counts where it is said to be unlisted and its force on held-out runs has R² ≥ 0.9. Causes that differ from \
run to run are reconstructed on fitted runs and have no improvement on others. The improvement that the true effect gives is that of the \
scenario with the hidden effect and the true parameters, driven like the others.\n\n";

/// The page.
pub fn page(scored: &[Scored], options: &Options) -> String {
    let mut text = String::from("# Concealed synthetic cases\n\n");
    if options.without_truth {
        text.push_str("The true causes were taken out of the library of the diagnosis.\n\n");
        without(&mut text, scored);
    } else {
        overall(&mut text, scored);
        by(&mut text, scored, "family", |one, _| one.truth.family.clone());
        by(&mut text, scored, "hidden cause", |one, index| one.truth.hidden[index].law.clone());
    }
    every(&mut text, scored);
    text
}

fn told(hits: usize, trials: usize) -> String {
    let (share, low, high) = wilson(hits, trials);
    if trials == 0 {
        return "- | - | 0".to_owned();
    }
    format!("{:.1} % | {:.1} to {:.1} % | {hits}/{trials}", 100.0 * share, 100.0 * low, 100.0 * high)
}

/// Cases of a kind that have a diagnosis or failed to give one.
fn of<'a>(scored: &'a [Scored], kind: &str) -> Vec<&'a Scored> {
    scored.iter().filter(|one| one.truth.kind == kind).collect()
}

fn outcomes<'a>(cases: &[&'a Scored]) -> Vec<&'a Outcome> {
    cases.iter().filter_map(|one| one.outcome.as_ref().ok()).collect()
}

fn strong(one: &Scored) -> bool {
    one.truth.hidden.iter().all(|cause| cause.strength >= STRONG)
}

fn median(mut values: Vec<f64>) -> String {
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    if values.is_empty() { "-".to_owned() } else { format!("{:.3}", values[values.len() / 2]) }
}

fn overall(text: &mut String, scored: &[Scored]) {
    let failed = scored.iter().filter(|one| one.outcome.is_err()).count();
    let _ = writeln!(text, "{} cases, {failed} without a diagnosis (they count as missed).\n", scored.len());
    text.push_str("| what | share | 95 % interval (Wilson) | cases | goal |\n|---|---|---|---|---|\n");
    let mut row = |what: &str, (hits, trials): (usize, usize), goal: &str| {
        let _ = writeln!(text, "| {what} | {} | {goal} |", told(hits, trials));
    };
    let all_good = |one: &&&Scored| {
        one.outcome.as_ref().is_ok_and(|outcome| outcome.found.iter().all(|found| found.good()))
    };
    let single: Vec<&Scored> = of(scored, "single");
    let clear: Vec<&Scored> = single.iter().copied().filter(|one| strong(one)).collect();
    let ratio = |cases: &[&Scored]| (cases.iter().filter(all_good).count(), cases.len());
    row("one cause, above twice the noise: right, or an honest doubt that names it", ratio(&clear), "≥ 95 %");
    row("one cause, of any strength", ratio(&single), "");
    let right = |one: &&&Scored| one.outcome.as_ref().is_ok_and(|outcome| outcome.found == [Found::Right]);
    row("one cause, above twice the noise: right", (clear.iter().filter(right).count(), clear.len()), "");
    let two = of(scored, "two");
    let shown: Vec<&Scored> =
        clear.iter().copied().filter(|one| one.truth.hidden[0].evidence >= APART).collect();
    row(
        "one cause, above twice the noise and beyond what free parameters can be: right or an honest doubt",
        ratio(&shown),
        "",
    );
    let invisible: Vec<&Outcome> = outcomes(
        &single.iter().copied().filter(|one| one.truth.hidden[0].evidence < APART).collect::<Vec<_>>(),
    );
    let listed = |outcome: &&&Outcome| !outcome.false_physics.is_empty();
    row(
        "one cause that the runs cannot show: another is claimed",
        (invisible.iter().filter(listed).count(), invisible.len()),
        "",
    );
    row("two causes: both right, or an honest doubt", ratio(&two), "≥ 85 %");
    let lenient = |one: &&&Scored| {
        one.outcome.as_ref().is_ok_and(|outcome| {
            outcome.found.iter().all(|found| found.good() || *found == Found::Alternative)
        })
    };
    row(
        "two causes: both right or named as an alternative",
        (two.iter().filter(lenient).count(), two.len()),
        "",
    );
    row("a listed and an unlisted cause: both", ratio(&of(scored, "two_unlisted")), "");
    row("a cause and a sensor's fault: both", ratio(&of(scored, "two_sensor")), "");
    let empty = outcomes(&of(scored, "empty"));
    let alarm = |outcome: &&&Outcome| !outcome.claimed.is_empty();
    row("nothing hidden: a false alarm", (empty.iter().filter(alarm).count(), empty.len()), "≤ 1 in 60");
    let faults = of(scored, "artefact");
    let told_faults = outcomes(&faults);
    let physics = |outcome: &&&Outcome| !outcome.false_physics.is_empty() || outcome.verdict == "unlisted";
    row(
        "a sensor's fault: physics is claimed",
        (told_faults.iter().filter(physics).count(), told_faults.len()),
        "0 in 30",
    );
    row("a sensor's fault: named", ratio(&faults), "");
    let all: Vec<&Outcome> = scored.iter().filter_map(|one| one.outcome.as_ref().ok()).collect();
    let sum = |pick: fn(&Outcome) -> Covered| {
        all.iter().fold((0, 0), |(hits, trials), outcome| {
            (hits + pick(outcome).hits, trials + pick(outcome).trials)
        })
    };
    row("95 % intervals of causes cover", sum(|outcome| outcome.parameters), "90 to 98 %");
    row("95 % intervals of nominal parameters cover", sum(|outcome| outcome.calibrated), "90 to 98 %");
    let improved: Vec<_> = all.iter().filter_map(|outcome| outcome.improvement).collect();
    let enough = |by_oracle: bool| {
        let of = improved.iter().filter(|one| one.by_oracle || !by_oracle);
        (of.clone().filter(|one| one.share >= 0.9).count(), of.count())
    };
    row("90 % of the improvement on held-out runs that the true effect gives", enough(true), "all");
    row("the same, where that cannot be run held against the noise", enough(false), "");
    let unlisted = outcomes(&of(scored, "unlisted"));
    let close = |outcome: &&&Outcome| outcome.reconstruction.is_some_and(|force| force.r2 >= IN_EFFECT);
    row(
        "unlisted: held-out R² of the force at least 0.9",
        (unlisted.iter().filter(close).count(), unlisted.len()),
        "≥ 80 %",
    );
    row("unlisted: said to be, with that R²", ratio(&of(scored, "unlisted")), "");
    row("unlisted: a listed cause is claimed", (unlisted.iter().filter(listed).count(), unlisted.len()), "");
    let shares = improved.iter().map(|one| one.share).collect();
    let _ = writeln!(text, "\nMedian share of the possible improvement: {}.", median(shares));
    let mut seconds: Vec<f64> = scored.iter().filter_map(|one| one.seconds).collect();
    seconds.sort_by(f64::total_cmp);
    if let Some(longest) = seconds.last() {
        let _ = writeln!(
            text,
            "A diagnosis took {} s (median) to {longest:.0} s with one thread.",
            median(seconds.clone())
        );
    }
    text.push('\n');
    text.push_str(RULES);
}

fn by(text: &mut String, scored: &[Scored], what: &str, key: impl Fn(&Scored, usize) -> String) {
    let _ = writeln!(
        text,
        "## By {what}\n\n| {what} | causes | right | honest doubt | twin | alternative | rough | behind | wrong | missed | no diagnosis | median strength | median correlation | median R² |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
    );
    let mut groups: BTreeMap<String, Vec<(&Scored, usize)>> = BTreeMap::new();
    for one in scored {
        for index in 0..one.truth.hidden.len() {
            groups.entry(key(one, index)).or_default().push((one, index));
        }
    }
    for (name, causes) in groups {
        let number = |wanted: Found| {
            causes
                .iter()
                .filter(|(one, index)| one.outcome.as_ref().is_ok_and(|of| of.found[*index] == wanted))
                .count()
        };
        let forces: Vec<_> = causes
            .iter()
            .filter_map(|(one, _)| one.outcome.as_ref().ok().and_then(|outcome| outcome.reconstruction))
            .collect();
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            causes.len(),
            number(Found::Right),
            number(Found::Honest),
            number(Found::Twin),
            number(Found::Alternative),
            number(Found::Rough),
            number(Found::Behind),
            number(Found::Wrong),
            number(Found::Missed),
            causes.iter().filter(|(one, _)| one.outcome.is_err()).count(),
            median(causes.iter().map(|(one, index)| one.truth.hidden[*index].strength).collect()),
            median(forces.iter().map(|force| force.correlation).collect()),
            median(forces.iter().map(|force| force.r2).collect()),
        );
    }
    text.push('\n');
}

fn without(text: &mut String, scored: &[Scored]) {
    /// What differs by a constant alone is the same force beside a free coefficient.
    const ALIKE: f64 = 0.95;
    text.push_str("| what | share | 95 % interval (Wilson) | cases | goal |\n|---|---|---|---|---|\n");
    let all: Vec<&Outcome> = scored.iter().filter_map(|one| one.outcome.as_ref().ok()).collect();
    let mut row = |what: &str, hits: usize, goal: &str| {
        let _ = writeln!(text, "| {what} | {} | {goal} |", told(hits, all.len()));
    };
    let claims = |outcome: &&&Outcome| {
        (!outcome.false_physics.is_empty() || outcome.twin) && outcome.verdict != "cannot_tell"
    };
    row("a wrong listed cause is claimed", all.iter().filter(claims).count(), "≤ 10 %");
    let no_twin = |outcome: &&&Outcome| claims(outcome) && !outcome.twin;
    row("and it is no twin of the true one", all.iter().filter(no_twin).count(), "");
    let alike = |outcome: &Outcome| outcome.reconstruction.is_some_and(|force| force.correlation >= ALIKE);
    let another = |outcome: &&&Outcome| claims(outcome) && !alike(outcome);
    row(
        "and its force goes otherwise than the true one (correlation below 0.95)",
        all.iter().filter(another).count(),
        "",
    );
    let doubts = |outcome: &&&Outcome| outcome.verdict == "cannot_tell";
    row("it is said that one cannot tell", all.iter().filter(doubts).count(), "");
    let unlisted = |outcome: &&&Outcome| outcome.verdict == "unlisted";
    row("it is said to be unlisted", all.iter().filter(unlisted).count(), "");
    let sensor = |outcome: &&&Outcome| !outcome.false_artefacts.is_empty();
    row("a sensor is blamed", all.iter().filter(sensor).count(), "");
    text.push('\n');
}

fn every(text: &mut String, scored: &[Scored]) {
    text.push_str("## Every case\n\n| case | family | hidden (times the noise) | verdict | claimed | score | R² | improvement |\n|---|---|---|---|---|---|---|---|\n");
    for one in scored {
        let hidden: Vec<String> =
            one.truth.hidden.iter().map(|cause| format!("{} ({:.1})", cause.law, cause.strength)).collect();
        let hidden = if hidden.is_empty() { "nothing".to_owned() } else { hidden.join(", ") };
        let _ = write!(text, "| {} | {} | {hidden} | ", one.name, one.truth.family);
        let _ = match &one.outcome {
            Ok(outcome) => {
                let score: Vec<String> =
                    outcome.found.iter().map(|found| format!("{found:?}").to_lowercase()).collect();
                let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.2}"));
                writeln!(
                    text,
                    "{} | {} | {} | {} | {} |",
                    outcome.verdict,
                    outcome.claimed.join(", "),
                    score.join(", "),
                    number(outcome.reconstruction.map(|force| force.r2)),
                    number(outcome.improvement.map(|one| one.share))
                )
            }
            Err(reason) => writeln!(text, "none: {} | | missed | - | - |", reason.replace('|', "/")),
        };
    }
}
