//! What was found, as an engineer would write it.

use crate::balance::Kind;
use crate::catalogue::Cause;
use crate::report::{FindingReport, Fit, ParameterReport, RivalReport, Verdict};
use std::fmt::Write;

/// A number with as many digits as a person reads.
fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    // A few decades at most.
    #[allow(clippy::cast_possible_truncation, reason = "the exponent of a double is small")]
    let digits = (2 - value.abs().log10().floor() as i32).clamp(0, 8);
    // Clamped just above.
    let digits = usize::try_from(digits).unwrap_or(0);
    format!("{value:.digits$}")
}

fn with_unit(parameter: &ParameterReport) -> String {
    let unit = if parameter.unit == "1" { String::new() } else { format!(" {}", parameter.unit) };
    format!(
        "{} {} ({} to {}){unit}",
        headland_units::stem(&parameter.name).replace('_', " "),
        number(parameter.value),
        number(parameter.ci95[0]),
        number(parameter.ci95[1])
    )
}

/// One sentence for a finding.
pub fn sentence(
    cause: &Cause,
    kind: Kind,
    parameters: &[ParameterReport],
    share: f64,
    rivals: &[RivalReport],
) -> String {
    let values: Vec<String> =
        parameters.iter().filter(|one| one.ci95[0] < one.ci95[1]).map(with_unit).collect();
    let values = if values.is_empty() { String::new() } else { format!(": {}", values.join(", ")) };
    let others = if rivals.is_empty() {
        String::new()
    } else {
        let names: Vec<&str> = rivals.iter().map(|rival| rival.id.as_str()).collect();
        format!("; these recordings cannot tell it from {}", names.join(", "))
    };
    let words = cause.words;
    let first: String = words.chars().take(1).flat_map(char::to_uppercase).collect();
    let rest: String = words.chars().skip(1).collect();
    format!(
        "{first}{rest} was left out{values}; it explains {:.0} % of the mismatch in the {} balance{others}.",
        100.0 * share,
        kind.name()
    )
}

/// The paragraph.
pub fn answer(verdict: Verdict, findings: &[FindingReport], fit: &Fit, balances: &[Kind]) -> String {
    let balances: Vec<&str> = balances.iter().map(|balance| balance.name()).collect();
    let runs = match &fit.held_out {
        Some(held) => format!("{} runs to fit and {} held out", fit.fitted.runs.len(), held.runs.len()),
        None => format!("{} runs, none held out", fit.fitted.runs.len()),
    };
    let mut text = format!("{runs}; looked at: {}. ", balances.join(", "));
    match verdict {
        Verdict::None => text.push_str(
            "Nothing is missing: what differs is explained by the free parameters within their priors and by noise. ",
        ),
        Verdict::CannotTell => text.push_str("Something is missing, and these recordings cannot tell which of several causes it is. "),
        _ => {}
    }
    for finding in findings {
        text.push_str(&finding.sentence);
        text.push(' ');
    }
    let proof = |place: &str, runs: &crate::report::FitRuns| {
        let moves = if runs.rmse_after < 0.98 * runs.rmse_before {
            "falls"
        } else if runs.rmse_after > 1.02 * runs.rmse_before {
            "rises"
        } else {
            "stays,"
        };
        format!(
            "{place} the error of {} {moves} from {} to {}",
            fit.signal,
            number(runs.rmse_before),
            number(runs.rmse_after)
        )
    };
    if let Some(held) = &fit.held_out {
        text.push_str(&proof("On the runs it never saw", held));
    } else {
        text.push_str(&proof("On the fitted runs", &fit.fitted));
    }
    if fit.fitted.noise.is_finite() {
        let _ = write!(text, " (the sensor: {})", number(fit.fitted.noise));
    }
    text.push('.');
    if verdict == Verdict::CannotTell
        && let Some(first) = findings.first()
    {
        let _ = write!(text, " To tell: {}.", first.next_experiment);
    }
    text
}

/// One sentence for a fault that a channel shows by itself.
pub fn fault(fault: &crate::faults::Fault) -> String {
    let size = number(fault.size);
    match fault.id {
        "stuck_channel" => format!(
            "`{}` sticks for {size} s in all while the vehicle moves; those samples were left out.",
            fault.channel
        ),
        "quantisation" => {
            format!("`{}` comes in steps of {size} {}, coarser than its noise.", fault.channel, fault.unit)
        }
        _ => format!("{:.1} % of the recorded time holds no samples.", 100.0 * fault.size),
    }
}
