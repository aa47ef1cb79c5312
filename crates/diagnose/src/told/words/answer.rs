//! The paragraph.

use super::number::{plain, quantity};
use super::{capital, listed, place};
use crate::balances::balance::Kind;
use crate::proof::refine::Free;
use crate::told::map::Map;
use crate::told::report::{FindingReport, Fit, FitRuns, Verdict};
use headland_units::{stem, unit_of_name};

/// What the paragraph tells.
pub struct Told<'a> {
    /// The verdict.
    pub verdict: Verdict,
    /// The findings.
    pub findings: &'a [FindingReport],
    /// Before and after.
    pub fit: &'a Fit,
    /// The balances.
    pub balances: &'a [Kind],
    /// Where they do not close with the free parameters alone.
    pub before: &'a Map,
    /// The free parameter that ends furthest from what was known of it, and by how many standard deviations.
    pub strain: Option<(&'a Free, f64)>,
    /// The balance whose rows scatter by far more than neighbouring ones say, and how many times as much.
    pub scatter: Option<(Kind, f64)>,
    /// Whether any cause may as well be none.
    pub slight: bool,
    /// Whether all that was found are functions of time that do not follow the runs they were made of.
    pub unfollowed: bool,
    /// Why something that was found is not as anything of its kind.
    pub unlike: Option<&'a str>,
    /// Why nothing is claimed, where it is not.
    pub withheld: Option<&'a str>,
    /// What the data cannot separate.
    pub null_space: &'a [String],
    /// What runs that were held out tell of themselves.
    pub own: Own,
    /// Whether any stretch of what is left stands out.
    pub stands_out: bool,
}

/// What a run tells of itself, and no other can foresee.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Own {
    /// Nothing: all that was found is of every run.
    Nothing,
    /// Spells.
    Spells,
    /// All that was found is switched in each run by itself.
    Courses,
    /// A level.
    Level,
}

/// The paragraph: what was looked at, what fails first, what was left out, what it explains, what cannot be told.
pub fn answer(told: &Told) -> String {
    let mut sentences = vec![looked_at(told)];
    sentences.extend(place::first(told.before));
    match told.verdict {
        Verdict::None if told.before.first.is_some() => sentences.push(
            "No cause of the library explains this better than chance would, so nothing is claimed; the free parameters, \
             within their priors, take what they can."
                .to_owned(),
        ),
        Verdict::None => sentences.push(
            "Nothing is missing: what differs is explained by the free parameters within their priors and by noise."
                .to_owned(),
        ),
        Verdict::CannotTell if told.withheld.is_none() && told.findings.is_empty() => {
            sentences.push(
                "Something is missing, and no cause explains it in these recordings better than chance would, so none is \
                 claimed."
                    .to_owned(),
            );
            sentences.extend(told.scatter.map(|(kind, scatter)| {
                format!(
                    "Row by row, what is left of {} scatters {scatter:.1} times as much as neighbouring rows differ by.",
                    kind.sides()
                )
            }));
        }
        Verdict::CannotTell if told.withheld.is_none() => sentences.push(doubt(told)),
        _ => {}
    }
    sentences.extend(told.withheld.map(str::to_owned));
    sentences.extend(told.findings.iter().map(|finding| finding.sentence.clone()));
    sentences.extend(calibrated(told));
    sentences.extend(strained(told));
    sentences.push(proof(told));
    sentences.extend(left_over(told));
    if told.verdict == Verdict::CannotTell
        && let Some(open) = told.findings.iter().find(|finding| finding.is_doubtful())
    {
        sentences.push(format!("To tell, {}.", open.next_experiment));
    }
    spoken(&sentences.join(" "))
}

/// Names of parameters, set off by backticks, as words.
fn spoken(text: &str) -> String {
    let parts = text.split('`').enumerate();
    parts.map(|(index, part)| if index % 2 == 1 { plain(stem(part)) } else { part.to_owned() }).collect()
}

/// The paragraph where the recording itself keeps anything from being concluded.
pub fn inconclusive(statements: &[String]) -> String {
    format!("Nothing can be concluded from this recording. {} No cause is claimed.", statements.join(" "))
}

/// `1 run` and `2 runs`.
fn runs(count: usize) -> String {
    if count == 1 { "1 run".to_owned() } else { format!("{count} runs") }
}

fn looked_at(told: &Told) -> String {
    let mut names: Vec<String> = told.balances.iter().map(|balance| balance.name().to_owned()).collect();
    names.dedup();
    let (balance, were) = if names.len() == 1 { ("balance", "was") } else { ("balances", "were") };
    let fitted = told.fit.fitted.runs.len();
    let verb = if fitted == 1 { "was" } else { "were" };
    let held = match &told.fit.held_out {
        Some(held) => format!("{} held out", held.runs.len()),
        None => "none held out".to_owned(),
    };
    format!(
        "{} {verb} fitted and {held}; the {} {balance} {were} looked at.",
        capital(&runs(fitted)),
        listed(&names)
    )
}

/// That calibration explains the greater part, where it does: shares of a quarter would look like failures.
fn calibrated(told: &Told) -> Option<String> {
    /// Causes that explain less than this leave the rest to the free parameters.
    const GREATER: f64 = 0.5;
    /// Error at the end over that at the begin below which nearly everything is explained.
    const EXPLAINED: f64 = 0.3;
    let shares: f64 = told.findings.iter().map(|finding| finding.share_of_mismatch).sum();
    let fitted = &told.fit.fitted;
    let explained = fitted.rmse_after < EXPLAINED * fitted.rmse_before;
    let any = told.findings.iter().any(|finding| finding.share_of_mismatch > 0.0);
    (any && shares < GREATER && explained && strained(told).is_none())
        .then(|| "The greater part is what the free parameters take within their priors.".to_owned())
}

/// That a free parameter had to go further than a little, where it had.
fn strained(told: &Told) -> Option<String> {
    /// Of parameters that are a little wrong one in three hundred is further [standard deviations].
    const FAR: f64 = 3.0;
    let (free, strain) = told.strain.filter(|(_, strain)| *strain > FAR)?;
    let unit = unit_of_name(&free.name).map_or_else(String::new, |unit| unit.symbol);
    if free.asked != free.value {
        return Some(format!(
            "The rows alone would have the {} at {}, {strain:.1} standard deviations from what was known of it, so they were \
             believed less and it is held at {}: something else may be missing.",
            plain(stem(&free.name)),
            quantity(free.asked, &unit),
            quantity(free.value, &unit)
        ));
    }
    Some(format!(
        "The {} ends at {}, {strain:.1} standard deviations from what was known of it: it may stand in for something that is \
         missing.",
        plain(stem(&free.name)),
        quantity(free.value, &unit)
    ))
}

fn proof(told: &Told) -> String {
    let fit = told.fit;
    let signal = stem(&fit.signal).replace('_', " ");
    let unit = unit_of_name(&fit.signal).map_or_else(String::new, |unit| unit.symbol);
    let one = |place: String, runs: &FitRuns| {
        let (before, after) = (runs.rmse_before, runs.rmse_after);
        let quantity = |value: f64| quantity(value, &unit);
        if !(before.is_finite() && after.is_finite()) {
            return format!("{place} the error of {signal} could not be computed");
        }
        if after < 0.98 * before {
            format!("{place} the error of {signal} falls from {} to {}", quantity(before), quantity(after))
        } else if runs.grows() {
            format!("{place} the error of {signal} rises from {} to {}", quantity(before), quantity(after))
        } else {
            format!("{place} the error of {signal} stays at {}", quantity(after))
        }
    };
    let noise = fit.fitted.noise;
    let sensor = if noise.is_finite() {
        let what = told.fit.noise_in_words();
        format!(" ({}: {})", what.strip_prefix("the ").unwrap_or(what), quantity(noise, &unit))
    } else {
        String::new()
    };
    let text = match &fit.held_out {
        Some(held) if held.runs.len() == 1 => one("On the run that it never saw".to_owned(), held),
        Some(held) => one(format!("On the {} that it never saw", runs(held.runs.len())), held),
        None => one("On the fitted runs".to_owned(), &fit.fitted),
    };
    let doubt = if !told.findings.is_empty() && fit.grows() && told.own != Own::Courses {
        ": it does not help there, so it is no proof"
    } else {
        ""
    };
    let own = match told.own {
        Own::Spells => {
            "; when and how strong its spells are, such a run tells itself, which could not be foreseen"
        }
        Own::Courses => "; each run takes a course of its own, which no other foretells",
        Own::Level => "; its own level such a run tells by its first half",
        Own::Nothing => "",
    };
    let own = if told.fit.held_out.is_some() { own } else { "" };
    format!("{text}{sensor}{doubt}{own}.")
}

/// Why what was found is not certain.
fn doubt(told: &Told) -> String {
    let found = |why: &str| format!("Something is missing, and {why}, so that nothing of it is certain.");
    if told.findings.first().is_some_and(FindingReport::is_doubtful) {
        "Something is missing, and these recordings cannot tell which of several causes it is.".to_owned()
    } else if told.findings.iter().any(FindingReport::is_doubtful) {
        "Something is missing, and of a part of it these recordings cannot tell which of several causes it is.".to_owned()
    } else if told.fit.grows() && told.own != Own::Courses {
        found("what explains it in the runs that were fitted does not in those held out")
    } else if told.slight {
        "Something may be missing, and within its interval what was found may as well be none, so that nothing of it is certain."
            .to_owned()
    } else if let Some(why) = told.unlike {
        found(why)
    } else if told.unfollowed {
        found("what was found follows not even the runs that it was made of as near as such a cause can")
    } else {
        "More is missing than was found, and what was found may stand in for it, so that nothing of it is certain.".to_owned()
    }
}

/// What is not explained.
fn left_over(told: &Told) -> Option<String> {
    /// Error at the end over the noise from which on something is left to explain.
    const MUCH: f64 = 2.0;
    let lack = told.fit.lack_of_fit;
    let noise = told.fit.noise_in_words();
    let left = told.fit.left_in_words();
    let much = (lack.is_finite() && lack > MUCH).then(|| {
        if told.verdict == Verdict::None || !told.stands_out {
            format!("{left} is {lack:.1} times {noise}, without a pattern that stands out.")
        } else {
            format!("{left} is {lack:.1} times {noise}: there is more to it than was found, or the noise is larger.")
        }
    });
    let cannot = told.null_space.first().map(|sentence| format!("Beyond that: {sentence}"));
    match (much, cannot) {
        (None, None) => None,
        (one, other) => Some([one, other].into_iter().flatten().collect::<Vec<_>>().join(" ")),
    }
}
