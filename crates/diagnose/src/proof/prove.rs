//! Before and after, on runs that were fitted and on runs that were not.

use crate::balances::balance::{Kind, System, change};
use crate::balances::gram::Column;
use crate::causes::catalogue::{Class, Form, LawText};
use crate::causes::sensors::corrected;
use crate::causes::trial::for_run;
use crate::choosing::search::Found;
use crate::proof::forward::{agreeing, speed_noise, speeds, usual_window_s, windows_s};
use crate::proof::refine::{Cured, Refined, said_with_all};
use crate::runs::recorded::Recorded;
use crate::runs::said::{Said, inputs};
use crate::single_runs::events::Event;
use crate::soundness::voltage::{drop_v, lost_w};
use crate::{Case, DiagnoseError};
use headland_scenario::{AskedInputs, Scenario};
use headland_sim::Inputs;

/// What an effect did along one run.
#[derive(Clone, Debug)]
pub struct Reconstructed {
    /// The cause.
    pub id: &'static str,
    /// Unit of the values: `n`, `w`, `m_s`, `m_s2`.
    pub unit: &'static str,
    /// One series for each run, sample by sample.
    pub runs: Vec<Vec<f64>>,
}

/// Errors of one signal over some runs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Errors {
    /// Root mean square with the nominal scenario.
    pub before: f64,
    /// Root mean square with what was found.
    pub after: f64,
}

impl Errors {
    /// Over the runs that are `chosen`; none where there are none.
    pub fn over(each: &[Self], chosen: &[bool]) -> Option<Self> {
        let own = || each.iter().zip(chosen).filter(|(_, chosen)| **chosen).map(|(errors, _)| errors);
        let root = |of: fn(&Self) -> f64| {
            let squares: Vec<f64> =
                own().map(|one| of(one).powi(2)).filter(|value| value.is_finite()).collect();
            (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
        };
        own().next()?;
        Some(Self { before: root(|one| one.before), after: root(|one| one.after) })
    }
}

/// The proof.
pub struct Proof {
    /// By what it is told.
    pub measure: Measure,
    /// The signal.
    pub signal: &'static str,
    /// Over the runs that were fitted.
    pub fitted: Errors,
    /// Over the runs that were not; none where there are none.
    pub held_out: Option<Errors>,
    /// Run by run.
    pub each: Vec<Errors>,
    /// What the sensor of the signal explains.
    pub noise: f64,
    /// The effects along the runs.
    pub effects: Vec<Reconstructed>,
    /// The improved scenario: each text with the runs that it is of, the first being that of `scenario.ron`.
    pub scenarios: Vec<(Vec<usize>, String)>,
}

impl Proof {
    /// Noise of the signal: that of its sensor, and where that is not known what its neighbouring rows differ by.
    pub fn told_noise(&self, case: &Case, system: &System, found: Option<&Found>) -> f64 {
        if self.noise.is_finite() {
            return self.noise;
        }
        found.map_or(f64::NAN, |found| neighbours(case, system, found, self.signal))
    }
}

/// What neighbouring rows of a signal differ by, where no sensor's noise is known: NaN where no balance has that signal.
fn neighbours(case: &Case, system: &System, found: &Found, signal: &str) -> f64 {
    let number = system.kinds.iter().position(|kind| kind.signal() == signal);
    number.map_or(f64::NAN, |number| {
        let stand = &found.stand;
        let quiet = system.quiet(&stand.left, &case.fit, &stand.noises);
        system.kinds[number].per_unit() * quiet.each[number].sd()
    })
}

/// By what a proof is told.
#[derive(Clone, Debug)]
pub struct Measure {
    /// The balance whose signal it is.
    pub kind: Kind,
    /// Windows that a run is driven forward in, run by run [s]; none of one that is driven as a whole.
    pub windows_s: Vec<Option<f64>>,
}

impl Measure {
    /// That of what was found first.
    pub fn of(case: &Case, system: &System, refined: &Refined) -> Result<Self, DiagnoseError> {
        let kind = told_by(system, refined);
        let windows_s = match kind {
            Kind::Motion if refined.causes.is_empty() => case.runs.iter().map(usual_window_s).collect(),
            Kind::Motion => {
                let runs = corrected_by(case, refined)?;
                let windows_s = windows_s(case, &runs, refined)?;
                let mut laws = refined.causes.iter().filter_map(|cured| cured.cause.law.as_ref());
                if laws.any(LawText::leads_elsewhere) {
                    let rows = rows(case, system, &runs, refined, &told(case, system, refined)?, kind)?;
                    agreeing(case, &runs, refined, windows_s, &rows)?
                } else {
                    windows_s
                }
            }
            _ => case.runs.iter().map(usual_window_s).collect(),
        };
        Ok(Self { kind, windows_s })
    }
}

/// Makes the proof.
pub fn prove(
    case: &Case,
    system: &System,
    refined: &Refined,
    measure: &Measure,
) -> Result<Proof, DiagnoseError> {
    case.step("proving")?;
    let runs = corrected_by(case, refined)?;
    let effects = refined
        .causes
        .iter()
        .map(|cured| reconstruct(case, system, &cured.along(), refined))
        .collect::<Result<Vec<_>, _>>()?;
    let told = told(case, system, refined)?;
    let mut kind = measure.kind;
    let mut signal = None;
    if kind == Kind::Motion {
        let errors = speeds(case, &runs, refined, &measure.windows_s)?;
        let other = system.kinds.iter().find(|other| **other != Kind::Motion);
        match other {
            // Where no stretch can be driven forward, another balance tells.
            Some(other) if errors.iter().all(|one| one.after.is_nan()) => kind = *other,
            _ => signal = Some((errors, speed_noise(case))),
        }
    }
    let (errors, noise) = match signal {
        Some(signal) => signal,
        None => (rows(case, system, &runs, refined, &told, kind)?, f64::NAN),
    };
    let over = |wanted: bool| {
        let chosen = case.fit.iter().zip(&case.bears).map(|(fit, bears)| *fit == wanted && *bears);
        Errors::over(&errors, &chosen.collect::<Vec<_>>())
    };
    Ok(Proof {
        measure: measure.clone(),
        signal: kind.signal(),
        fitted: over(true).unwrap_or_default(),
        held_out: over(false),
        each: errors,
        noise,
        effects,
        scenarios: scenarios(case, refined)?,
    })
}

/// Every cause as the fitted runs told it: what a run tells of itself is no proof on it.
fn told(case: &Case, system: &System, refined: &Refined) -> Result<Vec<Reconstructed>, DiagnoseError> {
    refined.causes.iter().map(|cured| reconstruct(case, system, cured, refined)).collect()
}

/// The recordings without the faults of sensors that were found.
fn corrected_by(case: &Case, refined: &Refined) -> Result<Vec<Recorded>, DiagnoseError> {
    let mut runs = case.raw.clone();
    for (id, value) in refined.artefacts() {
        runs = corrected(&runs, id, value)?;
    }
    Ok(runs)
}

/// The improved scenario of every run, each text once; of the first one alone where nothing belongs to a path or to a run.
fn scenarios(case: &Case, refined: &Refined) -> Result<Vec<(Vec<usize>, String)>, DiagnoseError> {
    let count = if by_path(refined) { case.runs.len() } else { 1 };
    let mut all: Vec<(Vec<usize>, String)> = Vec::new();
    for run in 0..count {
        let mut document = improved(case, refined, run)?.document().clone();
        if let Some(asked) = asked(case) {
            document = document.with_inputs(&asked)?;
        }
        let text = document.text().to_owned();
        match all.iter_mut().find(|(_, known)| *known == text) {
            Some((runs, _)) => runs.push(run),
            None => all.push((vec![run], text)),
        }
    }
    Ok(all)
}

/// What a replay has to be asked for where the engine of every run turned as it was recorded, which one that is not asked to
/// leaves to the model; none where it was asked, or nothing was recorded.
fn asked(case: &Case) -> Option<AskedInputs> {
    let told = |run: &Recorded| inputs(&run.measured.trace, &run.measured.how).contains(&Inputs::EngineSpeed);
    let before = &case.study.scenario().replay.inputs;
    let mut asked = before.clone().unwrap_or(AskedInputs { all: true, listed: Vec::new() });
    if asked.listed.contains(&Inputs::EngineSpeed) || !case.runs.iter().all(told) {
        return None;
    }
    asked.listed.push(Inputs::EngineSpeed);
    Some(asked)
}

/// Whether anything that was found belongs to one path or to one run.
pub fn by_path(refined: &Refined) -> bool {
    refined.causes.iter().any(|cured| cured.function().is_some() || cured.in_single_runs())
}

/// The balance whose signal tells before and after: that of what was found first, and else that of motion.
fn told_by(system: &System, refined: &Refined) -> Kind {
    let found = refined.causes.first().map(|cured| system.kinds[cured.accepted.balance]);
    let motion = system.has(Kind::Motion).then_some(Kind::Motion);
    found.or(motion).or(system.kinds.first().copied()).unwrap_or(Kind::Motion)
}

/// The scenario with everything that was found, for one run.
pub fn improved(case: &Case, refined: &Refined, run: usize) -> Result<Scenario, DiagnoseError> {
    let values = refined.values();
    let paths = case.study.paths().iter().map(String::as_str);
    let changes: Vec<(&str, f64)> = paths.zip(values.iter().copied()).collect();
    let mut document = case.study.scenario().document().with(&changes)?;
    for cured in &refined.causes {
        if let Some(text) = text(case, cured, run) {
            document = document.with_effect(&text)?;
        }
    }
    Ok(Scenario::of(document, case.registry)?)
}

/// A cause as the scenario of a run writes it; none of a sensor's.
pub fn text(case: &Case, cured: &Cured, run: usize) -> Option<String> {
    if cured.cause.class == Class::Artefact {
        return None;
    }
    let drive = &case.runs[run];
    if !cured.events.is_empty() {
        let own: Vec<&Event> = cured.events.iter().filter(|event| event.run == run).collect();
        return (!own.is_empty()).then(|| match (cured.cause.id, cured.values.first()) {
            ("regeneration_limit", Some((power_w, _))) => {
                format!("regeneration_limit(power_w: {power_w:?}), {}", spelt("braking", &own))
            }
            (id, _) => spelt(id, &own),
        });
    }
    let Some(function) = cured.function() else {
        return Some(for_run(&cured.cause.written(&cured.values()), &cured.cause, drive));
    };
    if cured.cause.by_run {
        // A run that seems to be pulled by less than nothing is pulled by nothing: within its width that is what it can be.
        let term = &cured.cause.terms[0];
        let level = function.values[run].0.iter().next().copied().unwrap_or(0.0);
        let value = level.clamp(term.low, term.high);
        return Some(cured.cause.constant(value, &cured.accepted.trial.shape));
    }
    let group = function.group_of(cured.cause.form, drive);
    let knots = function.knots(group);
    let values: Vec<f64> = function.values[group].0.iter().copied().collect();
    let list =
        |values: &[f64]| values.iter().map(|value| format!("{value:.6?}")).collect::<Vec<_>>().join(", ");
    // Steps change half way between knots, and begin and end half a step beyond them.
    let edges = |knots: &[f64]| -> Vec<f64> {
        let middles = knots.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let [first, second, ..] = knots else { return Vec::new() };
        let step = second - first;
        std::iter::once(first - 0.5 * step)
            .chain(middles)
            .chain(knots.last().map(|last| last + 0.5 * step))
            .collect()
    };
    Some(match cured.cause.id {
        "grade" => format!("grade(positions_m: [{}], grades: [{}])", list(&knots), list(&values)),
        "soft_ground" => {
            format!("soft_ground(positions_m: [{}], coefficients: [{}])", list(&edges(&knots)), list(&values))
        }
        "payload_change" => {
            format!("payload_change(times_s: [{}], masses_kg: [{}])", list(&knots), list(&values))
        }
        "drawbar_load" => {
            format!("drawbar_load(times_s: [{}], forces_n: [{}])", list(&edges(&knots)), list(&values))
        }
        _ => format!("auxiliary_power(times_s: [{}], powers_w: [{}])", list(&edges(&knots)), list(&values)),
    })
}

/// Spells as a scenario writes them.
fn spelt(id: &str, events: &[&Event]) -> String {
    if id != "braking" {
        let one = |(from_s, to_s, force_n): (f64, f64, f64)| {
            format!("drawbar_load(force_n: {force_n:?}, from_s: {from_s:?}, to_s: {to_s:?})")
        };
        return events.iter().flat_map(|event| event.steps()).map(one).collect::<Vec<_>>().join(", ");
    }
    let (mut times, mut forces) = (Vec::new(), Vec::new());
    for event in events {
        for (from_s, _, force_n) in event.steps() {
            times.push(format!("{from_s:?}"));
            forces.push(format!("{force_n:?}"));
        }
        times.push(format!("{:?}", event.to_s));
        forces.push("0.0".to_owned());
    }
    // The times are edges: the last one ends the last, empty spell.
    times.push(format!("{:?}", events.last().map_or(0.0, |event| event.to_s) + 1.0));
    format!("braking(times_s: [{}], forces_n: [{}])", times.join(", "), forces.join(", "))
}

/// What an effect does along every run.
pub fn reconstruct(
    case: &Case,
    system: &System,
    cured: &Cured,
    refined: &Refined,
) -> Result<Reconstructed, DiagnoseError> {
    let id = cured.cause.id;
    if cured.cause.class == Class::Artefact {
        let value = cured.values.first().map_or(0.0, |(value, _)| *value);
        return sensor_error(case, id, value);
    }
    let kind = system.kinds[cured.accepted.balance];
    let unit = match kind {
        Kind::Motion => "n",
        Kind::Shaft | Kind::Battery | Kind::Charge | Kind::Voltage | Kind::Fuel => "w",
        Kind::Slip => "m_s",
        Kind::Parity if system.has(Kind::Motion) => "n",
        Kind::Parity => "m_s2",
    };
    // What shows in the accelerometer is a force to the vehicle as well.
    let kind = if unit == "n" { Kind::Motion } else { kind };
    let runs = along(case, cured, refined, kind)?;
    Ok(Reconstructed { id, unit, runs })
}

/// The force on the vehicle of an effect that was found by the power that it takes, forward [N]; none where it is no force.
pub fn forces_n(
    case: &Case,
    cured: &Cured,
    refined: &Refined,
) -> Result<Option<Vec<Vec<f64>>>, DiagnoseError> {
    if !cured.events.is_empty() {
        return Ok(None);
    }
    let runs = along(case, cured, refined, Kind::Motion)?;
    let acts = runs.iter().flatten().any(|force_n| *force_n != 0.0);
    Ok(acts.then_some(runs))
}

/// What an effect does to a balance along every run, sample by sample: forces forward, as in every trace, so that what
/// resists is negative; powers are what is taken.
fn along(case: &Case, cured: &Cured, refined: &Refined, kind: Kind) -> Result<Vec<Vec<f64>>, DiagnoseError> {
    let values = refined.values();
    let bare = case.said(case.study.scenario(), &values)?;
    let way = if kind == Kind::Motion { 1.0 } else { -1.0 };
    let told = |after: &[Said]| -> Vec<Vec<f64>> {
        let of_run = |(run, (before, after)): (&Recorded, (&Said, &Said))| {
            if kind == Kind::Voltage {
                return lost_w(run, before, after);
            }
            let values = change(kind, run, before, after);
            let of_sample = |(index, value): (usize, &f64)| {
                // Driven by the wheels, the ground is slower by the slip of the slower speed.
                let stands_in = kind == Kind::Slip && run.stands_in.get(index).is_some_and(|own| *own);
                let share = before.wheel_speed_m_s[index] / after.wheel_speed_m_s[index];
                way * value * if stands_in && share.is_finite() { share } else { 1.0 }
            };
            values.iter().enumerate().map(of_sample).collect()
        };
        case.runs.iter().zip(bare.iter().zip(after)).map(of_run).collect()
    };
    if !cured.events.is_empty() {
        let of_run = |(run, recorded): (usize, &Recorded)| -> Vec<f64> {
            let own: Vec<&Event> = cured.events.iter().filter(|event| event.run == run).collect();
            let at = |time: &f64| {
                let steps = own.iter().flat_map(|event| event.steps());
                let inside = steps.filter(|(from_s, to_s, _)| (*from_s..*to_s).contains(time));
                -inside.map(|(_, _, force_n)| force_n).sum::<f64>()
            };
            recorded.measured.trace.time_s().iter().map(at).collect()
        };
        Ok(case.runs.iter().enumerate().map(of_run).collect())
    } else if let Some(function) = cured.function() {
        let even = cured.cause.terms[0].scale;
        let text = cured.cause.constant(even, &cured.accepted.trial.shape);
        let after = case.said_with(&|_: &Recorded| text.clone(), &values, &[kind])?;
        let mut series = told(&after);
        for (samples, recorded) in series.iter_mut().zip(&case.runs) {
            let time_s = recorded.measured.trace.time_s();
            let group = function.group_of(cured.cause.form, recorded);
            for (index, sample) in samples.iter_mut().enumerate() {
                let over_position = cured.cause.form == Form::OverPosition;
                let at = if over_position { recorded.position_m[index] } else { time_s[index] };
                *sample *= function.value(group, at) / even;
            }
        }
        Ok(series)
    } else {
        let effects = vec![(cured.cause.clone(), cured.values())];
        Ok(told(&said_with_all(case, &case.runs, &effects, &values)?))
    }
}

/// What a sensor's fault adds to its channel.
fn sensor_error(case: &Case, id: &'static str, value: f64) -> Result<Reconstructed, DiagnoseError> {
    const CHANNELS: [(&str, &str); 5] = [
        // The speed of wheels may stand in for that over ground, and moves it then.
        ("wheel_speed_m_s", "m_s"),
        ("speed_m_s", "m_s"),
        ("specific_force_m_s2", "m_s2"),
        ("tractive_force_n", "n"),
        ("motor_torque_n_m", "n_m"),
    ];
    let fixed = corrected(&case.raw, id, value)?;
    let differs = |name: &str| {
        let pairs = case.raw.iter().zip(&fixed);
        pairs.into_iter().any(|(one, other)| one.measured.trace.get(name) != other.measured.trace.get(name))
    };
    let (name, unit) = CHANNELS.into_iter().find(|(name, _)| differs(name)).unwrap_or(CHANNELS[0]);
    let runs = case.raw.iter().zip(&fixed).map(|(raw, fixed)| {
        match (raw.measured.trace.get(name), fixed.measured.trace.get(name)) {
            (Some(raw), Some(fixed)) => raw.iter().zip(fixed).map(|(raw, fixed)| raw - fixed).collect(),
            _ => vec![f64::NAN; raw.measured.trace.len()],
        }
    });
    Ok(Reconstructed { id, unit, runs: runs.collect() })
}

/// Errors of the rows of a balance, for signals that are not driven forward.
fn rows(
    case: &Case,
    system: &System,
    runs: &[Recorded],
    refined: &Refined,
    effects: &[Reconstructed],
    kind: Kind,
) -> Result<Vec<Errors>, DiagnoseError> {
    let unit = kind.per_unit();
    let said = case.said_of(runs, case.study.scenario(), &refined.values())?;
    let mut after = system.residual_of(runs, &said);
    for (cured, effect) in refined.causes.iter().zip(effects) {
        if system.kinds[cured.accepted.balance] != kind || cured.cause.class == Class::Artefact {
            continue;
        }
        let mass = |run: usize| case.nominal[run].mass_kg.iter().find(|mass| mass.is_finite()).copied();
        let column = system.column(|own| match (own == kind, effect.unit) {
            (false, _) => vec![Vec::new(); case.runs.len()],
            // A slope is told as a force, and read by the accelerometer as one per mass, the other way round.
            (true, "n") if kind == Kind::Parity => {
                let of_run = |(run, values): (usize, &Vec<f64>)| {
                    values.iter().map(|value| -value / mass(run).unwrap_or(f64::INFINITY)).collect()
                };
                effect.runs.iter().enumerate().map(of_run).collect()
            }
            // What drives the vehicle is missing in the force that its motion asks for.
            (true, "n") if kind == Kind::Motion => {
                effect.runs.iter().map(|values| values.iter().map(|value| -value).collect()).collect()
            }
            // More resistance is told as the power that it loses, and read by the voltage.
            (true, _) if kind == Kind::Voltage => {
                case.runs.iter().zip(&effect.runs).map(|(run, lost)| drop_v(run, lost)).collect()
            }
            (true, _) => effect.runs.clone(),
        });
        for (left, column) in after.iter_mut().zip(&column) {
            *left -= column;
        }
    }
    let of = |run: usize, column: &Column| {
        let (mut sum, mut count) = (0.0, 0usize);
        for (chunk, values) in system.chunks.iter().zip(column) {
            if chunk.run == run && system.kind(chunk) == kind {
                sum += values.norm_squared();
                count += values.len();
            }
        }
        if count == 0 { f64::NAN } else { unit * (sum / count as f64).sqrt() }
    };
    let before = system.residual_of(&case.runs, &case.nominal);
    Ok((0..case.runs.len()).map(|run| Errors { before: of(run, &before), after: of(run, &after) }).collect())
}
