//! Proposed runs in sentences.

use super::course::{Course, Without};
use super::null_space::listed;
use super::timed;
use super::{Doubt, ENOUGH, Experiment, Judged, TELLS};
use crate::Case;
use crate::proof::refine::Cured;
use crate::told::words::number;

/// An interval that shrinks by less than this factor stays as it is.
const LEAST_NARROWING: f64 = 1.05;
/// Nobody drives the same run more often than this.
const MOST_RUNS: f64 = 30.0;

/// Every run against one rival, as `diagnosis.json` lists them.
pub fn experiments(courses: &[Course], cured: &Cured, doubt: &Doubt) -> Vec<Experiment> {
    let one = |(course, expected): (&Course, &Option<f64>)| {
        let expected = (*expected)?;
        Some(Experiment {
            run: course.name.to_owned(),
            sentence: format!("{}.", capital(&against(course, cured, &[(doubt, expected)]))),
            separates: [cured.cause.id.to_owned(), doubt.rival.to_owned()],
            expected_ln_odds: expected,
        })
    };
    courses.iter().zip(&doubt.expected).filter_map(one).collect()
}

/// What to drive next for a finding: from its rivals where it has some, else for a narrower interval.
pub fn next(case: &Case, courses: &[Course], cured: &Cured, judged: &Judged) -> Option<String> {
    if cured.accepted.rivals.is_empty() {
        return narrower(courses, cured, judged);
    }
    let told = match (even(case, cured), from_rivals(courses, cured, judged)) {
        (Some(even), Some(told)) => Some(format!("{told}; {even}")),
        (even, told) => told.or(even),
    };
    let (narrower, timed) =
        (|| narrower(courses, cured, judged), timed::more_of_the_same(case, &judged.timed));
    match (told, timed) {
        (Some(told), Some(timed)) => Some(format!("{told}; {timed}")),
        (None, Some(timed)) => {
            Some(narrower().map_or(timed.clone(), |narrower| format!("{timed}; {narrower}")))
        }
        (told, None) => told.or_else(narrower),
    }
}

/// A function over the position whose rival is the same cause with one value throughout.
fn even(case: &Case, cured: &Cured) -> Option<String> {
    let (function, (even, name)) = (cured.function()?, cured.cause.even()?);
    cured.accepted.rivals.iter().find(|rival| case.causes[rival.cause].id == even)?;
    let values: Vec<f64> = function.values.iter().flat_map(|(values, _)| values.iter().copied()).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Some(format!(
        "`{even}` is the same with one value throughout: on this ground the {name} is {} and varies by ±{} about that, \
         so drive on beyond it to tell",
        number(mean),
        number((squares / values.len() as f64).sqrt())
    ))
}

fn from_rivals(courses: &[Course], cured: &Cured, judged: &Judged) -> Option<String> {
    let doubts: Vec<&Doubt> =
        judged.doubts.iter().filter(|doubt| doubt.expected.iter().any(Option::is_some)).collect();
    let told = |place: usize| -> Vec<(&Doubt, f64)> {
        doubts.iter().filter_map(|doubt| Some((*doubt, doubt.expected[place]?))).collect()
    };
    // To tell two rivals well enough is more than to tell one beyond doubt.
    let worth = |place: usize| {
        let told = told(place);
        let enough: f64 = told.iter().map(|(_, expected)| expected.clamp(0.0, ENOUGH)).sum();
        let all: f64 = told.iter().map(|(_, expected)| expected).sum();
        // A run that the recording can take up is easier to judge than one that stands by itself.
        let joins = f64::from(u8::from(courses[place].without == Without::Nothing));
        (enough, joins, all)
    };
    let best = (0..courses.len()).filter(|place| !told(*place).is_empty()).max_by(|one, other| {
        let (one, other) = (worth(*one), worth(*other));
        one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1)).then(one.2.total_cmp(&other.2))
    })?;
    let mut told = told(best);
    told.sort_by(|one, other| other.1.total_cmp(&one.1));
    if told.iter().any(|(_, expected)| *expected >= TELLS) {
        told.retain(|(_, expected)| *expected >= TELLS);
        return Some(against(&courses[best], cured, &told));
    }
    let rivals: Vec<String> = doubts.iter().map(|doubt| format!("`{}`", doubt.rival)).collect();
    Some(format!(
        "none of {} runs that were thought through would tell `{}` from {} (the best, to {}, is expected to give ln p {:.1}); \
         instead: {}",
        courses.len(),
        cured.cause.id,
        listed(&rivals),
        courses[best].words,
        told[0].1,
        cured.cause.experiment
    ))
}

fn against(course: &Course, cured: &Cured, told: &[(&Doubt, f64)]) -> String {
    let one = |(doubt, expected): &(&Doubt, f64)| {
        let odds = if *expected >= ENOUGH {
            " with odds beyond 1000 to 1".to_owned()
        } else if *expected >= TELLS {
            format!(" with odds of {} to 1", number(expected.exp().round()))
        } else {
            String::new()
        };
        format!(
            "from `{}`{odds} (expected ln p {expected:.1}; the runs at hand give {:.1})",
            doubt.rival, doubt.now
        )
    };
    let tells = if told.iter().any(|(_, expected)| *expected >= TELLS) { "tell" } else { "not tell" };
    let told: Vec<String> = told.iter().map(one).collect();
    format!("{}: it would {tells} `{}` {}", course.words, cured.cause.id, listed(&told))
}

fn narrower(courses: &[Course], cured: &Cured, judged: &Judged) -> Option<String> {
    let known = courses.iter().zip(&judged.narrowing);
    let known = known.filter_map(|(course, factor)| Some((course, (*factor)?)));
    let (course, factor) = known.max_by(|one, other| one.1.total_cmp(&other.1))?;
    let term = cured.accepted.trial.terms.first().and_then(|term| cured.cause.terms.get(*term))?;
    // A wind is told by its speed, though it is sought by its components.
    let name = if cured.cause.id == "wind" { "speed" } else { headland_units::stem(term.name) };
    let name = name.replace('_', " ");
    let now = judged.known.map_or(String::new(), |share| format!("±{} %", number(100.0 * share)));
    if factor > LEAST_NARROWING {
        return Some(format!(
            "{}: it would narrow the interval of its {name}, {now} now, by a factor of {factor:.1}",
            course.words
        ));
    }
    // Every such run adds as much to what is known: 1/σ² is four times as large after 3/(f² − 1) of them.
    let runs = (3.0 / (factor * factor - 1.0)).ceil();
    let best = if runs <= MOST_RUNS {
        format!("the best, to {}, would have to be driven {runs} times to halve that", course.words)
    } else {
        format!("the best would be to {}", course.words)
    };
    Some(format!(
        "its {name} is known to {now}, and no single run that was thought through makes that a twentieth better ({best}); \
         to see it by other means: {}",
        cured.cause.experiment
    ))
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
