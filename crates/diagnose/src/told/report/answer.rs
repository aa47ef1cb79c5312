//! Puts the answer together.

use super::finding::{Doubts, FAR_BY_ROWS, faulty, findings, verdict};
use super::series::{corrections, effects, residuals};
use super::shown::shown;
use super::{Calibrated, Diagnosed, Diagnosis, Fit, FitRuns, Tried, Verdict, bands};
use crate::balances::balance::Kind;
use crate::causes::catalogue::{Class, Form};
use crate::choosing::search::Found;
use crate::experiment::Proposals;
use crate::proof::elsewhere::elsewhere;
use crate::proof::forward::usual_window_s;
use crate::proof::prove::{Errors, Measure, Proof, prove};
use crate::proof::refine::{Cured, Free, HALF_95, Refined};
use crate::single_runs::events::Event;
use crate::soundness::faults::Fault;
use crate::told::map::map;
use crate::told::words;
use crate::{Case, DiagnoseError, System};
use headland_units::unit_of_name;

/// What else is known when the answer is put together.
pub struct Beside<'a> {
    /// Faults that channels show by themselves.
    pub faults: &'a [Fault],
    /// Spells in single runs, claimed or not.
    pub events: &'a [Event],
    /// Why nothing is claimed, where it is not.
    pub withheld: Option<String>,
    /// What is said of what was free beside it.
    pub remark: Option<String>,
    /// What to drive next.
    pub next: Proposals,
}

/// Puts the answer together.
pub fn report(
    case: &Case,
    system: &System,
    found: &Found,
    refined: &Refined,
    proof: &Proof,
    beside: &Beside,
) -> Result<Diagnosed, DiagnoseError> {
    let mut findings = findings(case, system, found, refined, proof, &beside.next.next);
    let mut notes = case.study.notes.clone();
    if beside.withheld.is_some() {
        notes.extend(beside.faults.iter().map(words::fault));
    } else {
        findings.extend(beside.faults.iter().map(|fault| faulty(fault, system)));
    }
    let fit = fit(case, system, Some(found), proof);
    let strain = refined.strain(case);
    let own = |cured: &Cured| cured.cause.class != Class::Artefact && cured.may_be_none();
    let slight = refined.causes.iter().any(own);
    let unfollowed = over_time(refined, &fit) && !fit.is_followed();
    let unlike = refined.causes.iter().find_map(Cured::is_unlike_its_kind);
    let courses = refined.is_switched_alone();
    let scatter = scatter(case, system, found);
    let verdict = if beside.withheld.is_some() {
        Verdict::CannotTell
    } else {
        let strain = strain.map_or(0.0, |(_, strain)| strain);
        verdict(
            &findings,
            &fit,
            &Doubts {
                timed: timed(refined),
                courses,
                slight: slight || unfollowed || unlike.is_some(),
                strain,
                scatter: scatter.map_or(0.0, |(_, scatter)| scatter),
            },
        )
    };
    notes.extend(remarks(case, &found.unproven));
    notes.extend(beside.remark.clone());
    notes.extend(words::whose(case, &proof.scenarios));
    let mut null_space = refined.null_space.clone();
    for finding in &findings {
        for rival in &finding.indistinguishable_from {
            null_space.push(words::as_likely(&finding.id, rival));
        }
    }
    // Both under the noise at the end: before, whatever is missing would count as noise.
    let before = map(case, system, &found.noises.1, &found.before, beside.events);
    let after = map(case, system, &found.noises.1, &found.left, &[]);
    let bands = refined
        .causes
        .iter()
        .zip(&proof.effects)
        .map(|(cured, effect)| bands::band(case, system, cured, refined, effect))
        .collect::<Result<Vec<_>, _>>()?;
    let told = words::Told {
        verdict,
        findings: &findings,
        fit: &fit,
        balances: &system.kinds,
        before: &before,
        strain,
        scatter: scatter.filter(|(_, scatter)| *scatter > FAR_BY_ROWS),
        slight,
        unfollowed,
        unlike,
        withheld: beside.withheld.as_deref(),
        null_space: &refined.null_space,
        own: told_by_itself(case, refined, beside.events),
        stands_out: !after.stretches.is_empty(),
    };
    let diagnosis = Diagnosis {
        schema: "headland.diagnosis/1",
        verdict,
        answer: words::answer(&told),
        first_balance: before.first,
        mismatch: before.stretches,
        mismatch_left: after.stretches,
        findings,
        fit,
        calibrated: calibrated(case, refined),
        null_space,
        experiments: beside.next.experiments.clone(),
        unproven: found.unproven.iter().map(|cause| case.causes[*cause].id.to_owned()).collect(),
        notes,
        tried: tried(case, found),
    };
    Ok(Diagnosed {
        diagnosis,
        scenarios: proof.scenarios.iter().map(|(_, text)| text.clone()).collect(),
        elsewhere: elsewhere(case, refined)?,
        effects: effects(case, (proof, refined), &bands)?,
        corrections: corrections(case, refined),
        residuals: residuals(case, system, found),
        shown: shown(case, system, Some(found), refined, proof)?,
    })
}

/// The answer where the recording itself keeps anything from being concluded: the statements, and the scenario as it was.
pub fn inconclusive(
    case: &Case,
    sound: &[Vec<bool>],
    statements: &[String],
) -> Result<Diagnosed, DiagnoseError> {
    let system = &case.system(sound);
    let parameters = &case.study.parameters;
    let free = parameters.iter().map(|one| {
        let sd = one.sd.unwrap_or(f64::INFINITY);
        let ci95 = [one.value - HALF_95 * sd, one.value + HALF_95 * sd];
        Free { name: one.name.clone(), prior: one.value, value: one.value, ci95, asked: one.value }
    });
    let refined = Refined { causes: Vec::new(), free: free.collect(), null_space: Vec::new() };
    // A recording that cannot even drive the model is shown as it is.
    let proof =
        Measure::of(case, system, &refined).and_then(|measure| prove(case, system, &refined, &measure));
    let proof = proof.unwrap_or_else(|_| Proof {
        measure: Measure { kind: Kind::Motion, windows_s: case.runs.iter().map(usual_window_s).collect() },
        signal: "speed_m_s",
        fitted: Errors { before: f64::NAN, after: f64::NAN },
        held_out: None,
        each: Vec::new(),
        noise: f64::NAN,
        effects: Vec::new(),
        scenarios: vec![(Vec::new(), case.study.scenario().document().text().to_owned())],
    });
    let mut notes = case.study.notes.clone();
    notes.extend(remarks(case, &[]));
    let diagnosis = Diagnosis {
        schema: "headland.diagnosis/1",
        verdict: Verdict::CannotTell,
        answer: words::inconclusive(statements),
        first_balance: None,
        mismatch: Vec::new(),
        mismatch_left: Vec::new(),
        findings: Vec::new(),
        fit: fit(case, system, None, &proof),
        calibrated: Vec::new(),
        null_space: statements.to_vec(),
        experiments: Vec::new(),
        unproven: Vec::new(),
        notes,
        tried: Vec::new(),
    };
    Ok(Diagnosed {
        diagnosis,
        scenarios: proof.scenarios.iter().map(|(_, text)| text.clone()).collect(),
        elsewhere: None,
        effects: effects(case, (&proof, &refined), &[])?,
        corrections: Vec::new(),
        residuals: Vec::new(),
        shown: shown(case, system, None, &refined, &proof).unwrap_or_default(),
    })
}

/// What runs that were held out tell of themselves.
fn told_by_itself(case: &Case, refined: &Refined, events: &[Event]) -> words::Own {
    if events.iter().any(|event| !case.fit[event.run]) {
        words::Own::Spells
    } else if refined.is_switched_alone() {
        words::Own::Courses
    } else if refined.causes.iter().any(|cured| cured.cause.by_run) {
        words::Own::Level
    } else {
        words::Own::Nothing
    }
}

/// Whether anything that was found is what each run tells of itself alone: a function of time, or spells.
fn timed(refined: &Refined) -> bool {
    refined.causes.iter().any(|cured| cured.in_single_runs() || cured.takes_its_own_course())
}

/// Whether all that was found is functions of time, but for one that all runs share and that foretells those held out.
fn over_time(refined: &Refined, fit: &Fit) -> bool {
    let shared = |cured: &Cured| cured.function().is_some_and(|function| function.spread.shared);
    let of_time = |cured: &Cured| cured.cause.form == Form::OverTime && !(shared(cured) && fit.is_foretold());
    !refined.causes.is_empty() && refined.causes.iter().all(of_time)
}

fn ids(case: &Case, wanted: bool) -> Vec<String> {
    let all = case.runs.iter().zip(case.fit.iter().zip(&case.bears));
    let chosen = all.filter(|(_, (fit, bears))| **fit == wanted && **bears);
    chosen.map(|(drive, _)| drive.measured.id.clone()).collect()
}

fn fit(case: &Case, system: &System, found: Option<&Found>, proof: &Proof) -> Fit {
    let runs = |wanted: bool, errors: &Errors| FitRuns {
        runs: ids(case, wanted),
        rmse_before: errors.before,
        rmse_after: errors.after,
        noise: proof.told_noise(case, system, found),
    };
    let lack = match (&proof.held_out, proof.noise) {
        (Some(held), noise) if noise > 0.0 => held.after / noise,
        (None, noise) if noise > 0.0 => proof.fitted.after / noise,
        // Without a noise of its own the signal is judged by the rows: all of their scatter over that of neighbours.
        _ => found.and_then(|found| scatter(case, system, found)).map_or(f64::NAN, |(_, scatter)| scatter),
    };
    Fit {
        signal: proof.signal.to_owned(),
        fitted: runs(true, &proof.fitted),
        held_out: proof.held_out.as_ref().map(|errors| runs(false, errors)),
        lack_of_fit: lack,
    }
}

/// Scatter of the rows of the balance that closes worst, over what neighbouring rows show.
fn scatter(case: &Case, system: &System, found: &Found) -> Option<(Kind, f64)> {
    let stand = &found.stand;
    let quiet = system.quiet(&stand.left, &case.fit, &stand.noises);
    let each = system.kinds.iter().zip(stand.noises.each.iter().zip(&quiet.each));
    let each = each.map(|(kind, (all, quiet))| (*kind, all.sd() / quiet.sd()));
    each.max_by(|one, other| one.1.total_cmp(&other.1))
}

/// The free parameters that could be told.
fn calibrated(case: &Case, refined: &Refined) -> Vec<Calibrated> {
    let unit = |name: &str| unit_of_name(name).map_or_else(|| "1".to_owned(), |unit| unit.symbol);
    let one = |free: &Free| Calibrated {
        name: free.name.clone(),
        prior: free.prior,
        value: free.value,
        ci95: free.ci95,
        unit: unit(&free.name),
    };
    refined.free.iter().filter(|free| case.tells(&free.name)).map(one).collect()
}

fn remarks(case: &Case, unproven: &[usize]) -> Vec<String> {
    let mut notes = Vec::new();
    if !unproven.is_empty() {
        let names = words::each_once(unproven.iter().map(|cause| words::plain(case.causes[*cause].id)));
        notes.push(format!(
            "{} would explain each run by itself, but not one from the others; so nothing of it is claimed.",
            words::capital(&names)
        ));
    }
    let held = ids(case, false);
    if case.chosen && held.is_empty() {
        notes.push(
            "There are too few runs to hold one out, so nothing is proven on runs that were not fitted."
                .to_owned(),
        );
    } else if case.chosen {
        let were = if held.len() == 1 { "was" } else { "were" };
        notes.push(format!("No run was marked `use: held_out`; held out {were} {}.", held.join(", ")));
    }
    notes
}

fn tried(case: &Case, found: &Found) -> Vec<Tried> {
    let mut all = Vec::new();
    for (number, round) in found.tried.iter().enumerate() {
        for (cause, shape, gain) in &round.causes {
            all.push(Tried {
                round: number + 1,
                id: case.causes[*cause].id.to_owned(),
                shape: shape.clone(),
                gain: *gain,
                needed: round.by_chance,
            });
        }
    }
    all
}
