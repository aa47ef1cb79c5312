//! The findings: what each cause amounts to, where it works, and how sure it is.

use super::{FindingKind, FindingReport, Fit, Interval, ParameterReport, RivalReport, Verdict};
use crate::Case;
use crate::balances::balance::{Kind, System};
use crate::causes::catalogue::{ARTEFACTS, Cause, Class, Form};
use crate::causes::clocks::{DRIFT, FORCE, force_runs_apart};
use crate::causes::jumps::Jumps;
use crate::causes::sensors::late_force;
use crate::choosing::search::Found;
use crate::proof::prove::Proof;
use crate::proof::refine::{Cured, HALF_95, Refined};
use crate::single_runs::events::Event;
use crate::soundness::faults::Fault;
use crate::told::level::level;
use crate::told::locate::stretches;
use crate::told::words;
use headland_calibrate::statistics::median;

/// The findings, by their share of the mismatch.
pub fn findings(
    case: &Case,
    system: &System,
    found: &Found,
    refined: &Refined,
    proof: &Proof,
    next: &[Option<String>],
) -> Vec<FindingReport> {
    let mut findings: Vec<FindingReport> = Vec::new();
    for (place, (cured, effect)) in refined.causes.iter().zip(&proof.effects).enumerate() {
        let balance = system.kinds[cured.accepted.balance];
        let share = share(case, system, found, (refined, proof), place);
        let cured = &in_its_words(case, cured);
        let parameters = parameters(cured);
        let rivals: Vec<RivalReport> = cured
            .accepted
            .rivals
            .iter()
            .map(|rival| RivalReport {
                id: case.causes[rival.cause].id.to_owned(),
                squared_correlation: rival.squared_correlation,
                evidence: rival.gain,
                equation: law_of(&case.causes[rival.cause]),
            })
            .collect();
        findings.push(FindingReport {
            kind: match cured.cause.class {
                Class::Physics => FindingKind::Physics,
                Class::Artefact => FindingKind::Artefact,
                Class::Unlisted => FindingKind::Unlisted,
            },
            id: cured.cause.id.to_owned(),
            balance,
            sentence: words::sentence(cured, balance, &parameters, share, &case.causes),
            equation: cured.cause.equation_text(),
            depends_on: channels(case, refined, place),
            stretches: if cured.events.is_empty() {
                stretches(&case.runs, &effect.runs)
            } else {
                spells(case, &cured.events)
            },
            parameters,
            share_of_mismatch: share,
            evidence: [cured.accepted.gain, cured.accepted.by_chance],
            next_experiment: next[place].clone().unwrap_or_else(|| experiment(&cured.cause, cured, case)),
            indistinguishable_from: rivals,
        });
    }
    findings.sort_by(|one, other| other.share_of_mismatch.total_cmp(&one.share_of_mismatch));
    findings
}

/// The equation of a law.
fn law_of(cause: &Cause) -> Option<String> {
    cause.law.is_some().then(|| cause.equation_text())
}

/// What a finding depends on: a latency on the channel that is late.
fn channels(case: &Case, refined: &Refined, place: usize) -> Vec<String> {
    let cured = &refined.causes[place];
    match (cured.cause.id, cured.values.first()) {
        ("latency", Some((value, _))) => vec![late(case, *value).to_owned()],
        (DRIFT, Some((value, _))) if force_runs_apart(&case.raw, *value) => vec![FORCE.to_owned()],
        (DRIFT, Some(_)) => vec!["speed_m_s".to_owned()],
        ("speed_scale", _) => first_of(case, &["wheel_speed_m_s", "speed_m_s"]),
        ("force_scale", _) => first_of(case, &[FORCE, "motor_torque_n_m", "engine_torque_n_m"]),
        _ => cured.cause.channels(),
    }
}

/// The first of some channels that was recorded: the one that is set right.
fn first_of(case: &Case, names: &[&str]) -> Vec<String> {
    let recorded = |name: &&&str| case.raw.iter().any(|run| run.measured.trace.get(name).is_some());
    names.iter().find(recorded).map(|name| (*name).to_owned()).into_iter().collect()
}

/// The channel that is late: speed, or what drives where speed would have to come early.
pub fn late(case: &Case, latency_s: f64) -> &'static str {
    let force = case.runs.iter().any(|run| late_force(run, "latency", latency_s));
    if force { FORCE } else { "speed_m_s" }
}

/// A cause as it is told: of the channel that it is a fault of, for a speed that comes early is a force that comes late; and what was stated
/// too large as less of it.
fn in_its_words(case: &Case, cured: &Cured) -> Cured {
    let mut own = cured.clone();
    if let ("latency", Some((value, ci))) = (own.cause.id, own.values.first_mut()) {
        if late(case, *value) != "speed_m_s" {
            (*value, *ci) = (-*value, [-ci[1], -ci[0]]);
            own.cause.words = "a force that arrives late";
        } else if *value < 0.0 {
            own.cause.words = "a torque that arrives late against the speed, and all that is logged with it";
        }
    }
    if let (DRIFT, Some((value, ci))) = (own.cause.id, own.values.first_mut())
        && force_runs_apart(&case.raw, *value)
    {
        let of_force = |rate: f64| -rate / (1.0 + rate);
        (*value, *ci) = (of_force(*value), [of_force(ci[1]), of_force(ci[0])]);
        own.cause.words = "a clock of the force's logger that runs apart from the others";
    }
    let lessens = own.values.first().is_some_and(|(_, ci)| ci[1] < 0.0);
    own.cause.words = match own.cause.id {
        "engine_friction" if lessens => "less friction of the engine",
        "aerodynamic_drag" if lessens => "less aerodynamic drag",
        _ => own.cause.words,
    };
    own
}

/// The first of the balances that a channel is measured for, and else the first of all.
fn balance_of(channel: &str, kinds: &[Kind]) -> Kind {
    let measured = |kind: &&Kind| match kind {
        Kind::Parity | Kind::Slip | Kind::Fuel => kind.signal() == channel,
        Kind::Motion => ["speed_m_s", "tractive_force_n"].contains(&channel),
        Kind::Shaft => channel.starts_with("engine_"),
        Kind::Battery | Kind::Voltage => channel.starts_with("battery_"),
        Kind::Charge => channel == "state_of_charge",
    };
    kinds.iter().find(measured).or(kinds.first()).copied().unwrap_or(Kind::Motion)
}

/// A fault that a channel shows by itself.
pub fn faulty(fault: &Fault, system: &System) -> FindingReport {
    FindingReport {
        kind: FindingKind::Artefact,
        id: fault.id.to_owned(),
        balance: balance_of(&fault.channel, &system.kinds),
        sentence: words::fault(fault),
        equation: String::new(),
        depends_on: vec![fault.channel.clone()],
        stretches: fault.stretches.clone(),
        parameters: vec![ParameterReport {
            name: match fault.id {
                "speed_scale" => "scale",
                "latency" => "latency_s",
                "clock_drift" => "rate",
                _ => "size",
            }
            .to_owned(),
            value: fault.size,
            ci95: fault.ci95.unwrap_or([fault.size, fault.size]),
            unit: fault.unit.clone(),
        }],
        share_of_mismatch: 0.0,
        evidence: [0.0, 0.0],
        indistinguishable_from: Vec::new(),
        next_experiment: format!("look at the sensor and the logger of `{}`", fault.channel),
    }
}

impl FindingReport {
    /// Whether it is in doubt what it is: between faults of one sensor the doubt makes no difference.
    pub(crate) fn is_doubtful(&self) -> bool {
        let fault = |id: &str| ["accelerometer_bias", "accelerometer_tilt"].contains(&id);
        self.indistinguishable_from.iter().any(|rival| !(fault(&self.id) && fault(&rival.id)))
    }

    /// Whether it is a sensor's fault that may as well be physics.
    fn may_be_physics(&self) -> bool {
        let physics = |rival: &RivalReport| !ARTEFACTS.contains(&rival.id.as_str());
        self.kind == FindingKind::Artefact && self.indistinguishable_from.iter().any(physics)
    }
}

/// What a verdict depends on besides the findings and how well they fit.
#[derive(Clone, Copy, Debug, Default)]
pub struct Doubts {
    /// Whether anything that was found is what each run tells of itself alone.
    pub timed: bool,
    /// Whether all that was found is switched in each run by itself, of which no other run tells.
    pub courses: bool,
    /// Whether any cause may as well be none, or is unlike its kind, or all are functions of time that do not follow the runs they
    /// were made of.
    pub slight: bool,
    /// How far a free parameter ends from what was known of it, in standard deviations.
    pub strain: f64,
    /// Scatter of the rows of the balance that closes worst, over what neighbouring rows show.
    pub scatter: f64,
}

/// Rows show that something is missing before the signal does, those of a voltage and of fuel above all: where nothing was hidden they scattered
/// by up to one and a half times what neighbouring rows show in 48 sets, and by three to four where a battery polarised or a consumer was
/// switched.
pub const FAR_BY_ROWS: f64 = 2.2;

/// What a diagnosis says in a word. Beside what is certain, one cause in doubt leaves open what is missing; it takes nothing
/// from a sensor's fault. Where far more than noise is left, something is missing all the same: no cause is claimed then, or
/// what is claimed may stand in for it, unless it is `timed` and no run can show it of another: then the runs that were fitted
/// have to be near the noise. So it is where the rows of a balance scatter by far more than their neighbours say (`scatter`) and nothing was
/// found. Nor is certain what leaves most of the error that the noise does not explain, a law least of all. A free parameter that ends so
/// many standard deviations (`strain`) from what was known of it stands in for something as well. A fault that may as well be
/// physics leaves open whether anything is missing, and so does a cause that may as well be none (`slight`). What makes the error grow in
/// runs that it never saw is not certain either, whatever it is; nor are courses of each run that explain next to nothing beside an
/// error that noise does not, or functions of time that follow not even the runs that they were made of.
pub fn verdict(findings: &[FindingReport], fit: &Fit, doubts: &Doubts) -> Verdict {
    /// An error of so many times the noise is no matter of how well the noise is known.
    const FAR: f64 = 10.0;
    /// Where nothing was found, nothing that was found can be rough: a plant with suspension, tyres and sensors of its own, in which
    /// nothing was hidden, left five and a half times the noise in the worst of thirty sets.
    const FAR_WITHOUT: f64 = 6.0;
    /// A parameter that is so far from its prior is not a little wrong: one in a thousand is.
    const STRAINED: f64 = 3.3;
    /// Beside what was found, which may be mistaken by as much as its own error allows, it has to be further.
    const STRAINED_BESIDE: f64 = 4.0;
    /// Beside a sensor's fault, which a parameter may share, further still: no fault explains that.
    const STRAINED_BY_A_FAULT: f64 = 5.0;
    /// What leaves so many times the noise, and this share of the error, says little of what is missing.
    const LEFT: f64 = 5.0;
    const MOST_LEFT: f64 = 0.7;
    /// A law foretells what it is the law of: one that leaves so much is a part of something else.
    const LEFT_BY_A_LAW: f64 = 3.0;
    const MOST_LEFT_BY_A_LAW: f64 = 0.6;
    /// What each run tells of itself follows whatever there is: where so much more than the noise is left it has to be more than this share of all.
    const BEYOND: f64 = 2.0;
    const LITTLE: f64 = 0.1;
    let Doubts { timed, courses, slight, strain, scatter } = *doubts;
    let far = fit.lack_of_fit > FAR;
    let any = |kind: FindingKind| findings.iter().any(|finding| finding.kind == kind);
    let Some(first) = findings.first() else {
        let far = fit.lack_of_fit > FAR_WITHOUT || scatter > FAR_BY_ROWS;
        return if far || strain > STRAINED { Verdict::CannotTell } else { Verdict::None };
    };
    let strained = strain > if any(FindingKind::Artefact) { STRAINED_BY_A_FAULT } else { STRAINED_BESIDE };
    let claims = any(FindingKind::Physics) || any(FindingKind::Unlisted);
    let far_fitted = fit.fitted.rmse_after > FAR * fit.fitted.noise;
    let (left, most_left) = if first.kind == FindingKind::Unlisted {
        (LEFT_BY_A_LAW, MOST_LEFT_BY_A_LAW)
    } else {
        (LEFT, MOST_LEFT)
    };
    let leaves = |runs: &super::FitRuns| {
        runs.rmse_after > left * runs.noise && runs.rmse_after > most_left * runs.rmse_before
    };
    let says_little = fit.held_out.as_ref().is_some_and(leaves) && !(timed && fit.is_followed());
    let rough = far && (!timed || far_fitted) || says_little;
    let trifling = courses && first.share_of_mismatch < LITTLE && fit.lack_of_fit > BEYOND;
    let doubtful = claims && (rough || fit.grows() && !courses || slight || trifling) || strained;
    let may_be_physics = findings.iter().any(FindingReport::may_be_physics);
    if first.kind == FindingKind::Unlisted && !first.is_doubtful() && !doubtful && !may_be_physics {
        Verdict::Unlisted
    } else if first.is_doubtful()
        || doubtful
        || may_be_physics
        || !any(FindingKind::Artefact) && findings.iter().any(FindingReport::is_doubtful)
    {
        Verdict::CannotTell
    } else if any(FindingKind::Physics) && any(FindingKind::Artefact) {
        Verdict::Both
    } else if any(FindingKind::Artefact) {
        Verdict::SensorArtefact
    } else if any(FindingKind::Physics) {
        Verdict::MissingPhysics
    } else {
        Verdict::Unlisted
    }
}

/// Share of the mismatch with the nominal model, in the balance in which a cause shows most, that it explains: its mean
/// square over that of everything beyond the noise of the sensors. What the free parameters take is mismatch too.
fn share(
    case: &Case,
    system: &System,
    found: &Found,
    (refined, proof): (&Refined, &Proof),
    place: usize,
) -> f64 {
    let Some(cured) = refined.causes.get(place) else { return 0.0 };
    let balance = cured.accepted.balance;
    let size = |column: &crate::balances::gram::Column| system.mean_squares(column, &case.fit)[balance];
    let noise = found.noises.1.each[balance].sensor;
    let before = (size(&system.residual) - noise).max(f64::MIN_POSITIVE);
    let left = (size(&found.left) - noise).max(0.0);
    let of = |place: usize| found.effects.get(place).map_or(0.0, size);
    let all: f64 = (0..refined.causes.len()).map(of).sum();
    let calibrated = (before - left - all).max(0.0);
    // Rows in which a spell works were set aside, so it is judged by its samples.
    let spell = |place: usize| {
        let own = refined.causes.get(place).is_some_and(|one| !one.events.is_empty());
        if own && refined.causes[place].accepted.balance == balance {
            of_samples(case, proof, place)
        } else {
            0.0
        }
    };
    let whole = all + left + calibrated + (0..refined.causes.len()).map(spell).sum::<f64>();
    if !cured.events.is_empty() {
        return spell(place) / whole.max(f64::MIN_POSITIVE);
    }
    if found.effects.get(place).is_none() {
        // Corrected in the recording itself, before anything was left.
        return if cured.accepted.gain > 0.0 { 1.0 - left / before.max(left) } else { 0.0 };
    }
    if all > 0.0 { of(place) / whole } else { 0.0 }
}

/// Mean square of an effect over the samples of the fitted runs.
fn of_samples(case: &Case, proof: &Proof, place: usize) -> f64 {
    let Some(effect) = proof.effects.get(place) else { return 0.0 };
    let fitted = effect.runs.iter().zip(&case.fit).filter(|(_, fit)| **fit);
    let squares: Vec<f64> = fitted
        .flat_map(|(run, _)| run)
        .map(|value| value * value)
        .filter(|value| value.is_finite())
        .collect();
    squares.iter().sum::<f64>() / squares.len().max(1) as f64
}

/// Where spells work.
fn spells(case: &Case, events: &[Event]) -> Vec<Interval> {
    let one = |event: &Event| {
        let run = &case.runs[event.run];
        let at = |time_s: f64| {
            let times = run.measured.trace.time_s();
            let sample = times.partition_point(|time| *time < time_s).min(times.len().saturating_sub(1));
            run.position_m.get(sample).copied().unwrap_or(f64::NAN)
        };
        Interval {
            run: run.measured.id.clone(),
            from_s: event.from_s,
            to_s: event.to_s,
            from_position_m: at(event.from_s),
            to_position_m: at(event.to_s),
        }
    };
    events.iter().map(one).collect()
}

/// Where a wind comes from that blows otherwise in each run, its strongest as it is there.
fn blown(told: &mut [ParameterReport], cured: &Cured) -> ParameterReport {
    /// An axis that is turned until the runs tell it best is about as near [rad]; those that each went along a line tell nothing of it.
    const NEAR_RAD: f64 = 0.2;
    let half_rad = if cured.lane.is_some() { std::f64::consts::PI } else { NEAR_RAD };
    let turned = told.first().is_some_and(|peak| peak.value < 0.0);
    if let (true, Some(peak)) = (turned, told.first_mut()) {
        peak.value = -peak.value;
        peak.ci95 = [-peak.ci95[1], -peak.ci95[0]];
    }
    for (one, name) in told.iter_mut().zip(["speed_m_s", "speed_m_s_rms"]) {
        name.clone_into(&mut one.name);
    }
    let axis_rad = cured.accepted.trial.shape.first().copied().unwrap_or(0.0);
    let from_rad =
        (axis_rad + if turned { std::f64::consts::PI } else { 0.0 }).rem_euclid(std::f64::consts::TAU);
    ParameterReport {
        name: "from_rad".to_owned(),
        value: from_rad,
        ci95: [from_rad - half_rad, from_rad + half_rad],
        unit: "rad".to_owned(),
    }
}

fn parameters(cured: &Cured) -> Vec<ParameterReport> {
    let one = |name: &str, value: f64, ci95: [f64; 2], unit: &str| ParameterReport {
        name: name.to_owned(),
        value,
        ci95,
        unit: unit.to_owned(),
    };
    if let Some(function) = cured.function() {
        let mut told = function_parameters(&cured.cause, function);
        if cured.cause.blows_by_run() {
            let from = blown(&mut told, cured);
            told.push(from);
            return told;
        }
        let held = cured.cause.terms.iter().filter(|term| !term.linear).zip(&cured.accepted.trial.shape);
        // It was chosen among several that lie a factor of two apart, and moved between them.
        told.extend(held.map(|(term, value)| one(term.name, *value, [0.5 * value, 2.0 * value], term.unit)));
        return told;
    }
    if let (Some(law), Some((factor, _))) = (&cured.cause.law, cured.values.first()) {
        // The factor that was estimated beside belongs to the amplitudes.
        let constant = |constant: &headland_symbolic::Constant| {
            let factor = if constant.is_amplitude() { *factor } else { 1.0 };
            let value = factor * constant.value;
            let half = HALF_95 * (factor * constant.sd.unwrap_or(0.0)).abs();
            one(&constant.name, value, [value - half, value + half], &constant.unit)
        };
        return law.constants.iter().map(constant).collect();
    }
    match cured.cause.id {
        "wind" => {
            let [(north, north_ci), (east, east_ci), ..] = cured.values[..] else { return Vec::new() };
            // A part that was not needed is no better known than the other.
            let sd = |ci: [f64; 2]| {
                let own = |ci: [f64; 2]| (ci[1] - ci[0]) / (2.0 * HALF_95);
                if own(ci) > 0.0 { own(ci) } else { own(north_ci).max(own(east_ci)) }
            };
            // A part that nothing asked for leaves open how much blows across the lane: anything that is usual.
            let unasked = |ci: [f64; 2]| ci[0] == ci[1];
            if let (Some(lane), true) = (cured.lane, unasked(north_ci) || unasked(east_ci)) {
                let half = HALF_95 * lane.sd_m_s;
                let across = HALF_95 * cured.cause.terms[0].scale;
                let ci = [(lane.speed_m_s - half).max(0.0), (lane.speed_m_s + half).hypot(across)];
                let turn = std::f64::consts::PI;
                return vec![
                    one("speed_m_s", lane.speed_m_s, ci, "m/s"),
                    one("from_rad", lane.from_rad, [lane.from_rad - turn, lane.from_rad + turn], "rad"),
                ];
            }
            let speed = north.hypot(east);
            let from = east.atan2(north).rem_euclid(std::f64::consts::TAU);
            let along = (north * sd(north_ci)).hypot(east * sd(east_ci)) / speed.max(1e-9);
            let across = (east * sd(north_ci)).hypot(north * sd(east_ci)) / speed.max(1e-9).powi(2);
            // Every direction is within half a turn.
            let half = (HALF_95 * across).min(std::f64::consts::PI);
            let own = [from - half, from + half];
            let from_ci = match cured.mirrored.as_deref() {
                Some([north, east, ..]) => with_image(from, east.atan2(*north), half),
                _ => own,
            };
            // Whatever blows across, it is no weaker than what blows along.
            let least = cured.lane.map_or(0.0, |lane| lane.speed_m_s - HALF_95 * lane.sd_m_s);
            let low = (speed - HALF_95 * along).max(least).clamp(0.0, speed);
            vec![
                one("speed_m_s", speed, [low, speed + HALF_95 * along], "m/s"),
                one("from_rad", from, from_ci, "rad"),
            ]
        }
        // As `recording.ron` has it: what a channel shows over what it ought to.
        "speed_scale" | "force_scale" => {
            let Some((value, ci)) = cured.values.first() else { return Vec::new() };
            vec![one("scale", 1.0 + value, [1.0 + ci[0], 1.0 + ci[1]], "1")]
        }
        "cornering_drag" | "side_slope" => {
            let stiffness = |compliance: f64| 1.0 / compliance.max(1e-12);
            let terms = cured.cause.terms.iter().zip(&cured.values).filter(|(_, value)| estimated(value));
            let told = terms.map(|(term, (value, ci))| match term.name {
                "compliance_rad_n" => one(
                    "cornering_stiffness_n_per_rad",
                    stiffness(*value),
                    [stiffness(ci[1]), stiffness(ci[0].max(1e-9))],
                    "N/rad",
                ),
                name => one(name, *value, *ci, term.unit),
            });
            told.collect()
        }
        _ => cured
            .cause
            .terms
            .iter()
            .zip(&cured.values)
            .filter(|(term, value)| estimated(value) && !(term.name == "time_constant_s" && term.is_held()))
            .map(|(term, (value, ci))| one(term.name, *value, *ci, term.unit))
            .collect(),
    }
}

/// Whether a term was needed: one that was not is zero, and nothing was estimated.
fn estimated((value, ci): &(f64, [f64; 2])) -> bool {
    !(*value == 0.0 && *ci == [0.0; 2])
}

/// The interval that holds a direction and its image, each with its own: without a step over north, beyond which the same
/// direction is another number.
fn with_image(from: f64, image: f64, half: f64) -> [f64; 2] {
    let image = image.rem_euclid(std::f64::consts::TAU);
    [from.min(image) - half, from.max(image) + half]
}

fn function_parameters(cause: &Cause, function: &crate::causes::profile::Function) -> Vec<ParameterReport> {
    let term = &cause.terms[0];
    let pairs = function.values.iter().flat_map(|(values, sds)| values.iter().zip(sds.iter()));
    let pairs: Vec<(f64, f64)> = pairs.map(|(value, sd)| (*value, *sd)).collect();
    let (mut peak, rms) = peak_and_rms(&pairs, cause.form == Form::OverPosition);
    if let Some(level) = level(cause, function) {
        peak = level;
    }
    let unit = if cause.form == Form::OverPosition { "m" } else { "s" };
    let length = function.spread.length;
    let mut told = vec![
        ParameterReport {
            name: term.name.to_owned(),
            value: peak.0,
            ci95: [peak.0 - HALF_95 * peak.1, peak.0 + HALF_95 * peak.1],
            unit: term.unit.to_owned(),
        },
        ParameterReport {
            name: format!("{}_rms", term.name),
            value: rms,
            ci95: [rms - HALF_95 * peak.1, rms + HALF_95 * peak.1],
            unit: term.unit.to_owned(),
        },
    ];
    // What stays between edges has no length.
    let steps = function.spread.jumps.as_ref().is_some_and(Jumps::is_told);
    if !cause.by_run && !steps {
        told.push(ParameterReport {
            name: format!("length_{unit}"),
            value: length,
            ci95: [0.5 * length, 2.0 * length],
            unit: unit.to_owned(),
        });
    }
    told
}

/// The largest of some values with its own standard deviation, and their root mean square. Along a path they are those that are about as
/// well known as the others: a knot beyond the last row was never driven over.
fn peak_and_rms(values_and_sds: &[(f64, f64)], along_a_path: bool) -> ((f64, f64), f64) {
    /// So many times as uncertain as the middle one of all is hardly known.
    const KNOWN: f64 = 2.0;
    let sds: Vec<f64> = values_and_sds.iter().map(|(_, sd)| *sd).collect();
    let most = if along_a_path { KNOWN * median(&sds) } else { f64::INFINITY };
    let known = || values_and_sds.iter().copied().filter(|(_, sd)| *sd <= most);
    let larger = |one: (f64, f64), other: (f64, f64)| if other.0.abs() > one.0.abs() { other } else { one };
    let square: f64 = known().map(|(value, _)| value * value).sum();
    (known().fold((0.0, 0.0), larger), (square / known().count().max(1) as f64).sqrt())
}

fn experiment(cause: &Cause, cured: &Cured, case: &Case) -> String {
    /// A switch that is logged says when, and not how hard.
    const HOW_HARD: &str = "log the pressure of the brakes";
    let switched = case.runs.iter().any(|run| run.measured.trace.get("brake").is_some());
    let of = |cause: &Cause| if cause.id == "braking" && switched { HOW_HARD } else { cause.experiment };
    if cured.accepted.rivals.is_empty() {
        return of(cause).to_owned();
    }
    let mut runs = vec![of(cause)];
    for rival in &cured.accepted.rivals {
        let own = of(&case.causes[rival.cause]);
        if !runs.contains(&own) {
            runs.push(own);
        }
    }
    runs.truncate(3);
    runs.join("; or ")
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::told::report::{FitRuns, RivalReport};

    /// A finding of some kind, and what it cannot be told from.
    pub fn finding(kind: FindingKind, id: &str, rival: Option<&str>) -> FindingReport {
        let rival = rival.map(|id| RivalReport {
            id: id.to_owned(),
            squared_correlation: 1.0,
            evidence: 9.0,
            equation: None,
        });
        FindingReport {
            kind,
            id: id.to_owned(),
            balance: Kind::Motion,
            sentence: String::new(),
            equation: String::new(),
            depends_on: Vec::new(),
            stretches: Vec::new(),
            parameters: Vec::new(),
            share_of_mismatch: 0.5,
            evidence: [9.0, 7.0],
            indistinguishable_from: rival.into_iter().collect(),
            next_experiment: String::new(),
        }
    }

    #[test]
    fn a_fault_belongs_to_the_balance_of_its_channel() {
        let kinds = [Kind::Motion, Kind::Battery, Kind::Voltage];
        assert_eq!(super::balance_of("battery_current_a", &kinds), Kind::Battery);
        assert_eq!(super::balance_of("speed_m_s", &kinds), Kind::Motion);
        // What no balance is measured by stands with the first.
        assert_eq!(super::balance_of("heading_rad", &kinds), Kind::Motion);
    }

    /// An error of 1 in runs that were held out, and what becomes of it.
    fn fit(lack_of_fit: f64, after: f64) -> Fit {
        let runs = || FitRuns { runs: Vec::new(), rmse_before: 1.0, rmse_after: after, noise: 0.1 };
        Fit { signal: "speed_m_s".to_owned(), fitted: runs(), held_out: Some(runs()), lack_of_fit }
    }

    #[test]
    fn the_largest_slope_is_one_that_was_driven_over() {
        let slopes = [(0.010, 5e-4), (-0.013, 5e-4), (0.006, 9e-4), (-0.022, 5e-3)];
        let (peak, rms) = peak_and_rms(&slopes, true);
        assert_eq!(peak, (-0.013, 5e-4));
        assert!((rms - (3.05e-4_f64 / 3.0).sqrt()).abs() < 1e-12, "{rms}");
        // What is on for a moment is known less well than what is off for long, and is there.
        assert_eq!(peak_and_rms(&slopes, false).0, (-0.022, 5e-3));
        assert_eq!(peak_and_rms(&[], true), ((0.0, 0.0), 0.0));
    }

    #[test]
    fn runs_are_foretold_where_those_held_out_are_told_as_well_as_those_fitted() {
        let fit = |held_out: f64| Fit {
            held_out: Some(FitRuns { runs: Vec::new(), rmse_before: 1.0, rmse_after: held_out, noise: 0.1 }),
            ..fit(3.0, 0.3)
        };
        assert!(fit(0.35).is_foretold() && !fit(0.45).is_foretold(), "1.3 times 0.3 is as well");
        let little = Fit { fitted: fit(0.6).fitted.clone(), ..fit(0.6) };
        assert!(!little.is_foretold());
        assert!(!Fit { held_out: None, ..fit(0.3) }.is_foretold());
    }

    #[test]
    fn one_cause_in_doubt_leaves_open_what_is_missing_and_takes_nothing_from_a_sensors_fault() {
        use FindingKind::{Artefact, Physics};
        let sure = || finding(Physics, "wind", None);
        let doubtful = || finding(Physics, "grade", Some("soft_ground"));
        let fault = || finding(Artefact, "accelerometer_bias", Some("accelerometer_tilt"));
        let verdict =
            |findings: &[FindingReport]| super::verdict(findings, &fit(3.0, 0.1), &Doubts::default());
        assert_eq!(verdict(&[]), Verdict::None);
        assert_eq!(verdict(&[sure()]), Verdict::MissingPhysics);
        assert_eq!(verdict(&[sure(), doubtful()]), Verdict::CannotTell);
        assert_eq!(verdict(&[fault()]), Verdict::SensorArtefact);
        assert_eq!(verdict(&[fault(), doubtful()]), Verdict::Both);
        assert_eq!(verdict(&[doubtful(), fault()]), Verdict::CannotTell);
        let scale = |rival| finding(Artefact, "force_scale", Some(rival));
        assert_eq!(verdict(&[sure(), scale("mass")]), Verdict::CannotTell);
        assert_eq!(verdict(&[sure(), scale("speed_scale")]), Verdict::Both);
        let law = || finding(FindingKind::Unlisted, "unlisted", None);
        assert_eq!(verdict(&[law(), sure()]), Verdict::Unlisted);
        assert_eq!(verdict(&[law(), scale("mass")]), Verdict::CannotTell);
        assert_eq!(
            verdict(&[finding(FindingKind::Unlisted, "unlisted", Some("grade"))]),
            Verdict::CannotTell
        );
    }

    #[test]
    fn what_is_far_from_the_noise_is_not_nothing_and_what_leaves_it_is_no_certainty() {
        use FindingKind::{Artefact, Physics};
        let sure = [finding(Physics, "wind", None)];
        let fault = [finding(Artefact, "latency", None)];
        let verdict = |findings: &[FindingReport], lack_of_fit: f64, timed: bool| {
            super::verdict(findings, &fit(lack_of_fit, 0.1), &Doubts { timed, ..Doubts::default() })
        };
        assert_eq!(verdict(&[], 40.0, false), Verdict::CannotTell);
        assert_eq!(verdict(&[], f64::NAN, false), Verdict::None);
        let scattered =
            |scatter: f64| super::verdict(&[], &fit(1.2, 0.1), &Doubts { scatter, ..Doubts::default() });
        assert_eq!([1.5, 3.0].map(scattered), [Verdict::None, Verdict::CannotTell]);
        assert_eq!(verdict(&sure, 40.0, false), Verdict::CannotTell);
        assert_eq!(verdict(&sure, 40.0, true), Verdict::MissingPhysics);
        let mut unlike = fit(40.0, 0.1);
        unlike.fitted.rmse_after = 4.0;
        assert_eq!(
            super::verdict(&sure, &unlike, &Doubts { timed: true, ..Doubts::default() }),
            Verdict::CannotTell
        );
        assert_eq!(verdict(&fault, 40.0, false), Verdict::SensorArtefact);
        let law = [finding(FindingKind::Unlisted, "unlisted", None)];
        assert_eq!(verdict(&law, 3.0, false), Verdict::Unlisted);
        assert_eq!(verdict(&law, 40.0, false), Verdict::CannotTell);
        // A law that leaves four fifths of the error, four times the noise, is none, and what each run tells of itself is not either
        // where it does not follow what was fitted.
        let left = |found: &[FindingReport], fitted: f64, after: f64, timed| {
            let mut fit = fit(8.0, after);
            fit.fitted.rmse_after = fitted;
            let held_out = fit.held_out.as_mut().unwrap();
            held_out.rmse_before = 1.25 * after;
            super::verdict(found, &fit, &Doubts { timed, ..Doubts::default() })
        };
        assert_eq!(left(&law, 0.4, 0.4, false), Verdict::CannotTell);
        assert_eq!(left(&sure, 0.4, 0.4, false), Verdict::MissingPhysics);
        assert_eq!(left(&sure, 0.1, 0.8, false), Verdict::CannotTell);
        assert_eq!(left(&sure, 0.1, 0.8, true), Verdict::MissingPhysics);
        assert_eq!(left(&sure, 0.4, 0.8, true), Verdict::CannotTell);
    }

    #[test]
    fn what_hurts_in_runs_that_it_never_saw_is_no_certainty() {
        use FindingKind::{Artefact, Physics, Unlisted};
        let verdict = |kind, id, after: f64| {
            let mut fit = fit(3.0, after);
            fit.fitted.rmse_after = 0.1;
            super::verdict(&[finding(kind, id, None)], &fit, &Doubts { timed: true, ..Doubts::default() })
        };
        assert_eq!(verdict(Physics, "auxiliary_power", 1.01), Verdict::MissingPhysics);
        assert_eq!(verdict(Physics, "auxiliary_power", 1.1), Verdict::CannotTell);
        assert_eq!(verdict(Unlisted, "unlisted", 1.1), Verdict::CannotTell);
        assert_eq!(verdict(Artefact, "stuck_channel", 1.1), Verdict::SensorArtefact);
        assert_eq!(super::verdict(&[], &fit(3.0, 1.1), &Doubts::default()), Verdict::None);
    }

    #[test]
    fn a_cause_that_may_as_well_be_none_is_no_certainty() {
        let slight = |id: &str, kind| {
            let doubts = Doubts { slight: true, ..Doubts::default() };
            super::verdict(&[finding(kind, id, None)], &fit(1.0, 0.1), &doubts)
        };
        assert_eq!(slight("driveline_efficiency", FindingKind::Physics), Verdict::CannotTell);
        assert_eq!(slight("latency", FindingKind::Artefact), Verdict::SensorArtefact);
    }

    #[test]
    fn a_signal_is_followed_as_near_as_some_times_its_noise() {
        let followed = |after: f64, signal: &str| {
            let mut fit = fit(5.0, 0.5);
            (fit.fitted.rmse_after, fit.signal) = (after, signal.to_owned());
            fit.is_followed()
        };
        assert!(followed(0.2, "speed_m_s") && !followed(0.5, "speed_m_s"));
        // A power is rougher than its sensor. A load that came and went by tons in seconds stood in for slopes, and left ten times the noise
        // of the fuel.
        assert!(followed(0.5, "battery_power_w") && !followed(1.0, "fuel_rate_kg_s"));
    }

    #[test]
    fn a_course_that_explains_next_to_nothing_beside_what_is_left_is_no_certainty() {
        let verdict = |share_of_mismatch: f64, lack_of_fit: f64| {
            let found = finding(FindingKind::Physics, "auxiliary_power", None);
            let doubts = Doubts { timed: true, courses: true, ..Doubts::default() };
            super::verdict(&[FindingReport { share_of_mismatch, ..found }], &fit(lack_of_fit, 0.1), &doubts)
        };
        assert_eq!(verdict(0.04, 2.3), Verdict::CannotTell);
        assert_eq!(verdict(0.04, 1.3), Verdict::MissingPhysics);
        assert_eq!(verdict(0.4, 2.3), Verdict::MissingPhysics);
    }

    #[test]
    fn a_parameter_far_from_what_was_known_of_it_stands_in_for_something() {
        use FindingKind::{Artefact, Physics, Unlisted};
        let verdict = |findings: &[FindingReport], strain: f64| {
            super::verdict(findings, &fit(1.0, 0.1), &Doubts { strain, ..Doubts::default() })
        };
        assert_eq!(verdict(&[], 2.5), Verdict::None);
        assert_eq!(verdict(&[], 3.5), Verdict::CannotTell);
        assert_eq!(verdict(&[finding(Physics, "wind", None)], 3.5), Verdict::MissingPhysics);
        assert_eq!(verdict(&[finding(Physics, "wind", None)], 4.5), Verdict::CannotTell);
        assert_eq!(verdict(&[finding(Unlisted, "unlisted", None)], 4.5), Verdict::CannotTell);
        assert_eq!(verdict(&[finding(Artefact, "latency", None)], 4.5), Verdict::SensorArtefact);
        assert_eq!(verdict(&[finding(Artefact, "force_scale", None)], 6.0), Verdict::CannotTell);
    }
}
