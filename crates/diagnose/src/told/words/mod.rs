//! What was found, as an engineer would write it.

mod answer;
mod number;
mod place;

pub use answer::{Own, Told, answer, inconclusive};
pub use number::{number, plain, quantity};

use crate::Case;
use crate::balances::balance::Kind;
use crate::causes::catalogue::{Cause, Class};
use crate::proof::refine::{Cured, HALF_95};
use crate::told::level::level;
use crate::told::report::{ParameterReport, RivalReport};
use number::with_interval;

/// With a capital at its begin.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// `a`, `a and b`, `a, b and c`.
pub fn listed(all: &[String]) -> String {
    match all {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// Whose run each improved scenario is of, where there are several.
pub fn whose(case: &Case, scenarios: &[(Vec<usize>, String)]) -> Option<String> {
    let named = |(place, (runs, _)): (usize, &(Vec<usize>, String))| {
        let runs: Vec<String> = runs.iter().map(|run| case.runs[*run].measured.id.clone()).collect();
        let file = if place == 0 { "scenario.ron".to_owned() } else { format!("scenario_{}.ron", place + 1) };
        format!("{file} is of {}", listed(&runs))
    };
    let told: Vec<String> = scenarios.iter().enumerate().map(named).collect();
    (told.len() > 1).then(|| format!("{}.", told.join("; ")))
}

/// The same of names, each once.
pub fn each_once<N: AsRef<str>>(names: impl IntoIterator<Item = N>) -> String {
    let mut all: Vec<String> = Vec::new();
    for name in names {
        if !all.iter().any(|known| known == name.as_ref()) {
            all.push(name.as_ref().to_owned());
        }
    }
    listed(&all)
}

/// Whether words speak of several things: of 'slopes along the path', and not of 'a loss in the driveline'.
fn several(words: &str) -> bool {
    let single = ["a ", "an ", "the "].iter().any(|article| words.starts_with(article));
    let head = [" that", " along", " of", " in", " while", " away"]
        .iter()
        .filter_map(|end| words.find(end))
        .min()
        .map_or(words, |end| &words[..end]);
    !single && head.ends_with('s')
}

/// One sentence for a finding.
pub fn sentence(
    cured: &Cured,
    kind: Kind,
    parameters: &[ParameterReport],
    share: f64,
    causes: &[Cause],
) -> String {
    let cause = &cured.cause;
    let many = several(cause.words) && cause.class == Class::Physics;
    let (was, it, them) = if many { ("were", "they explain", "them") } else { ("was", "it explains", "it") };
    let what = match (cause.class, values(cured, parameters)) {
        (Class::Physics, Values::None) => format!("{} {was} left out", capital(cause.words)),
        (Class::Physics, Values::Of(values)) => format!("{} {values} {was} left out", capital(cause.words)),
        (Class::Physics, Values::Beside(values)) => {
            format!("{} {was} left out ({values})", capital(cause.words))
        }
        (Class::Unlisted, Values::None) => {
            format!("{} {was} left out: {}", capital(cause.words), cause.equation_text())
        }
        (Class::Unlisted, Values::Of(values) | Values::Beside(values)) => {
            format!("{} {was} left out: {} ({values})", capital(cause.words), cause.equation_text())
        }
        (Class::Artefact, Values::None) => format!("A sensor is at fault: {}", cause.words),
        (Class::Artefact, Values::Of(values) | Values::Beside(values)) => {
            format!("A sensor is at fault: {} ({values})", cause.words)
        }
    };
    let rivals: Vec<String> = cured.accepted.rivals.iter().map(|rival| named(&causes[rival.cause])).collect();
    let others = if rivals.is_empty() {
        String::new()
    } else {
        format!("; these recordings cannot tell {them} from {}", number::either(&rivals))
    };
    format!("{what}; {it} {:.0} % of the mismatch in the {} balance{others}.", 100.0 * share, kind.name())
}

/// A rival as a sentence names it: a law with its equation and its numbers, for it has no other name.
fn named(rival: &Cause) -> String {
    let Some(law) = &rival.law else { return rival.words.to_owned() };
    let numbers =
        law.constants.iter().map(|one| format!("{} {}", label(&one.name), quantity(one.value, &one.unit)));
    let numbers = numbers.collect::<Vec<_>>().join(", ");
    format!("{}, {} ({numbers})", rival.words, rival.equation_text())
}

/// The values of a finding in a sentence.
enum Values {
    /// None that a person would want.
    None,
    /// Right behind its name: 'a wind of 5 m/s'.
    Of(String),
    /// In parentheses.
    Beside(String),
}

fn values(cured: &Cured, parameters: &[ParameterReport]) -> Values {
    let find = |name: &str| parameters.iter().find(|one| one.name == name);
    let whole = cured.function().is_none();
    if let ("wind", true, Some(speed), Some(from)) =
        (cured.cause.id, whole, find("speed_m_s"), find("from_rad"))
    {
        // Runs that all go the same way, there and back, show no more of it.
        let degrees = |rad: f64| rad.to_degrees();
        if from.ci95[1] - from.ci95[0] > std::f64::consts::PI {
            let lane = cured.lane.map_or_else(String::new, |lane| {
                let half = HALF_95 * lane.sd_m_s;
                let ci95 = [lane.speed_m_s - half, lane.speed_m_s + half];
                let along = with_interval(lane.speed_m_s, ci95, "m/s");
                format!(", {along} from {:.0}°", degrees(lane.from_rad))
            });
            return Values::Of(format!("of which these runs show only the part along their lanes{lane}"));
        }
        return Values::Of(format!(
            "of {} from {}°",
            with_interval(speed.value, speed.ci95, "m/s"),
            with_interval(degrees(from.value), from.ci95.map(degrees), "")
        ));
    }
    if let Some(function) = cured.function() {
        let [peak, rms, ..] = parameters else { return Values::None };
        let least_or_most = match level(&cured.cause, function) {
            Some(_) => "",
            None if peak.value < 0.0 => "down to ",
            None => "up to ",
        };
        let part = if cured.lane.is_some() {
            "the part along their lanes, which is all that these runs show: "
        } else {
            ""
        };
        return Values::Beside(format!(
            "{part}{} {least_or_most}{}, {} in the root mean square",
            label(&peak.name),
            with_interval(peak.value, peak.ci95, &peak.unit),
            quantity(rms.value, &rms.unit)
        ));
    }
    if !cured.events.is_empty() {
        let count = cured.events.len();
        let spells = if count == 1 { "one spell".to_owned() } else { format!("{count} spells") };
        let lasts_s: f64 = cured.events.iter().map(|event| event.to_s - event.from_s).sum();
        let lasts = quantity(lasts_s, "s");
        return Values::Beside(match parameters.first() {
            Some(limit) if limit.unit == "W" => {
                let limit = with_interval(limit.value, limit.ci95, "W");
                format!("power {limit}; {spells} of braking, {lasts} in all")
            }
            first => {
                let mean = first.map_or(0.0, |one| one.value);
                format!("{spells}, {lasts} in all, {} on average", quantity(mean, "N"))
            }
        });
    }
    let known: Vec<String> = parameters
        .iter()
        .filter(|one| one.ci95[0] < one.ci95[1])
        .map(|one| format!("{} {}", label(&one.name), with_interval(one.value, one.ci95, &one.unit)))
        .collect();
    if known.is_empty() { Values::None } else { Values::Beside(known.join(", ")) }
}

/// A parameter's name as a person says it.
fn label(name: &str) -> String {
    headland_units::stem(name).replace('_', " ")
}

/// That a rival makes the recordings as likely as what was found: by the same course, or by one of its own.
pub fn as_likely(id: &str, rival: &RivalReport) -> String {
    /// Below this squared correlation two causes do not imitate each other.
    const ALIKE: f64 = 0.5;
    let (one, other) = (capital(&plain(id)), plain(&rival.id));
    let correlation = rival.squared_correlation;
    if correlation > ALIKE {
        format!(
            "{one} and {other} explain these recordings equally well (squared correlation {correlation:.2})."
        )
    } else {
        format!(
            "{one} and {other} explain these recordings in ways of their own (squared correlation {correlation:.2}), and neither \
             much better than the other."
        )
    }
}

/// One sentence for a fault that a channel shows by itself.
pub fn fault(fault: &crate::soundness::faults::Fault) -> String {
    let channel = capital(&label(&fault.channel));
    match fault.id {
        "stuck_channel" => format!(
            "{channel} sticks for {} in all while the vehicle moves; those samples were left out.",
            quantity(fault.size, "s")
        ),
        "quantisation" => {
            format!(
                "{channel} comes in steps of {}, coarser than its noise.",
                quantity(fault.size, &fault.unit)
            )
        }
        "speed_scale" => format!(
            "{channel} is {} of what the way says that was recorded beside it: a speed sensor with a wrong scale; it was \
             corrected.",
            with_interval(fault.size, fault.ci95.unwrap_or([fault.size; 2]), "")
        ),
        "latency" if fault.channel != "speed_m_s" => format!(
            "{channel} comes {} after what it is the power of, and no time constant explains that: a sensor or a bus that is late; \
             it was corrected.",
            with_interval(fault.size, fault.ci95.unwrap_or([fault.size; 2]), &fault.unit)
        ),
        "clock_drift" => format!(
            "{channel} is later from minute to minute than what it is the power of, or earlier, by {} ms in each second: a clock that \
             runs apart; it was corrected.",
            with_interval(1e3 * fault.size, fault.ci95.unwrap_or([fault.size; 2]).map(|end| 1e3 * end), "")
        ),
        "latency" => format!(
            "{channel} goes on as it was for {} at the begin of the coast-downs: the sensor is late; it was corrected.",
            with_interval(fault.size, fault.ci95.unwrap_or([fault.size; 2]), &fault.unit)
        ),
        "dropout" if fault.leaps => format!(
            "{channel} leaps away and back, as nothing that it measures can, in {:.1} % of its samples; they were left out.",
            100.0 * fault.size
        ),
        "dropout" if fault.unit == "s" => format!(
            "All channels run along straight lines for {} in all: a gap of the log that was filled; those samples were left \
             out.",
            quantity(fault.size, "s")
        ),
        "dropout" if fault.channel != "time_s" => {
            format!("{channel} is missing in {:.1} % of its samples.", 100.0 * fault.size)
        }
        _ => format!("{:.1} % of the recorded time holds no samples.", 100.0 * fault.size),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::causes::catalogue::LawText;

    #[test]
    fn one_thing_was_and_several_were() {
        for (words, expected) in [
            ("slopes along the path", true),
            ("service brakes that were not recorded", true),
            ("tyres that warm up", true),
            ("losses while ranges are shifted", true),
            ("a loss in the driveline in proportion to its load", false),
            ("drag of the tyres in curves", false),
            ("rolling resistance that depends otherwise on speed", false),
            ("softer ground along the path", false),
        ] {
            assert_eq!(several(words), expected, "{words}");
        }
    }

    #[test]
    fn a_law_that_rivals_a_cause_is_named_by_its_equation() {
        let constant = |name: &str, value: f64, sd: Option<f64>, unit: &str| headland_symbolic::Constant {
            name: name.to_owned(),
            value,
            sd,
            unit: unit.to_owned(),
        };
        let law = LawText {
            text: "a1_n * (v / v1_m_s)^3".to_owned(),
            constants: vec![constant("a1_n", 936.0, Some(20.0), "N"), constant("v1_m_s", 20.0, None, "m/s")],
            ..LawText::constant("resistance", "a_n")
        };
        assert_eq!(
            named(&Cause::of_law(law, Kind::Motion)),
            "a cause that nobody listed, F = a1_n * (v / v1_m_s)^3 (a1 936 N, v1 20.0 m/s)"
        );
    }

    #[test]
    fn a_list_ends_with_and() {
        let all = |names: &[&str]| listed(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
        assert_eq!(all(&["slip"]), "slip");
        assert_eq!(all(&["parity", "slip", "motion"]), "parity, slip and motion");
    }
}
