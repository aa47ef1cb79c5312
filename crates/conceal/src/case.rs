//! A case: what is hidden in it, its runs as the plant drives them, its logs as the sensors see them.

use crate::dice::Dice;
use crate::error::ConcealError;
use crate::family::{Family, Needs};
use crate::hidden::{Law, Spell, Told, ask, draw, listed_of, pair_of, parameter, unlisted_for, unlisted_of};
use crate::plan::Plan;
use crate::plant::{self, Begin, Sample};
use crate::sensor::{Artefact, Sensor, measure};
use crate::truth::{Cause, SCHEMA, Truth};
use crate::{twins, write};
use headland_trace::{Origin, Run, Trace};
use std::path::Path;

/// What is hidden in a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// One listed cause.
    Single,
    /// Two listed causes.
    Two,
    /// A listed cause, and one that no list holds.
    TwoUnlisted,
    /// A listed cause, and a fault of a sensor.
    TwoSensor,
    /// One cause that no list holds.
    Unlisted,
    /// None: the nominal parameters are wrong within their spread.
    Empty,
    /// A fault of a sensor.
    Artefact,
}

impl Kind {
    /// As the truth has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Two => "two",
            Self::TwoUnlisted => "two_unlisted",
            Self::TwoSensor => "two_sensor",
            Self::Unlisted => "unlisted",
            Self::Empty => "empty",
            Self::Artefact => "artefact",
        }
    }
}

/// Of twenty cases seven hide one listed cause, two two, one a listed and an unlisted one, one a cause and a fault, three
/// an unlisted one; four hide none, two faults.
pub fn kind_of(case: usize) -> (Kind, usize) {
    use Kind::{Artefact, Empty, Single, Two, TwoSensor, TwoUnlisted, Unlisted};
    const CYCLE: [Kind; 20] = [
        Single, Empty, Single, Two, Single, Unlisted, Artefact, Single, Empty, TwoUnlisted, Single, Unlisted,
        TwoSensor, Empty, Single, Artefact, Two, Single, Unlisted, Empty,
    ];
    let kind = CYCLE[case % CYCLE.len()];
    let a_cycle = CYCLE.iter().filter(|other| **other == kind).count();
    let before = CYCLE[..case % CYCLE.len()].iter().filter(|other| **other == kind).count();
    (kind, case / CYCLE.len() * a_cycle + before)
}

/// A case, driven and measured.
#[derive(Clone, Debug)]
pub struct Case {
    /// The plan.
    pub plan: Plan,
    /// What is in the logs.
    pub logs: Vec<Run>,
    /// What was hidden along each run, with true speed and position.
    pub along: Vec<Run>,
    /// The truth.
    pub truth: Truth,
}

/// How much of a case is as the nominal model has it: to test the plant, not a diagnosis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Probe {
    /// A case as it should be.
    #[default]
    No,
    /// Every nominal parameter is stated as it is.
    Exact,
    /// That, and sensors without noise, steps, lag and hold.
    Noiseless,
}

/// Makes a case of a set.
///
/// # Errors
/// [`ConcealError::Trace`] where the logs do not come together: a bug.
pub fn generate(seed: u64, case: usize, probe: Probe) -> Result<Case, ConcealError> {
    let (kind, number) = kind_of(case);
    // The order in which laws are dealt is that of the set; all else is the case's own.
    let mut deal = Dice::new(seed, 0);
    let mut dice = Dice::new(seed, 1 + case as u64);
    let (listed, others) = (listed_of(&mut deal), unlisted_of(&mut deal));
    let families = Family::ALL;
    let (family, names): (Family, Vec<&'static str>) = match kind {
        Kind::Single => {
            let one = listed[number % listed.len()];
            (one.family, vec![one.law])
        }
        Kind::Two => {
            let family = families[number % families.len()];
            (family, pair_of(family, &mut dice).to_vec())
        }
        Kind::TwoUnlisted => {
            let family = families[number % families.len()];
            (family, vec![pair_of(family, &mut dice)[0], unlisted_for(family, &mut dice)])
        }
        Kind::TwoSensor => {
            let family = families[number % families.len()];
            (family, vec![pair_of(family, &mut dice)[0]])
        }
        Kind::Unlisted => {
            let one = others[number % others.len()];
            (one.family, vec![one.law])
        }
        Kind::Empty | Kind::Artefact => (families[number % families.len()], Vec::new()),
    };
    let mut needs = Needs { exact: probe != Probe::No, ..Needs::default() };
    for name in &names {
        ask(name, &mut needs, &mut dice);
    }
    let chosen = match kind {
        Kind::Artefact => write::faults::choose(family, number, &mut needs, &mut dice),
        // The first only: two causes are enough.
        Kind::TwoSensor => write::faults::choose(family, number, &mut needs, &mut dice)[..1].to_vec(),
        _ => Vec::new(),
    };
    let mut plan = family.plan(&needs, &mut dice);
    if probe == Probe::Noiseless {
        for channel in &mut plan.channels {
            (channel.sensor, channel.decimals) = (Sensor::default(), channel.decimals + 4);
        }
    }
    let laws: Vec<Law> = names.iter().map(|name| draw(name, &plan, &mut dice)).collect();
    let faults: Vec<Artefact> =
        chosen.into_iter().map(|id| write::faults::draw(id, &plan, &mut dice)).collect();
    assemble((seed, case, kind), plan, &laws, &names, &faults, &mut dice)
}

fn assemble(
    (seed, case, kind): (u64, usize, Kind),
    plan: Plan,
    laws: &[Law],
    names: &[&'static str],
    faults: &[Artefact],
    dice: &mut Dice,
) -> Result<Case, ConcealError> {
    let (mut logs, mut along) = (Vec::new(), Vec::new());
    let columns: Vec<String> = columns(laws);
    let mut squares = vec![(0.0, 0usize); laws.len()];
    let mut powers = squares.clone();
    let mut faulty = vec![(0.0, 0usize); faults.len()];
    let mut currents = (0.0, 0.0);
    let mut fitted = Vec::new();
    let mut passes: Vec<(usize, f64)> = Vec::new();
    let to_power = plan.vehicle.engine.is_some();
    for (index, run) in plan.runs.iter().enumerate() {
        let before = passes.iter().position(|(lane, _)| *lane == run.lane).unwrap_or_else(|| {
            passes.push((run.lane, 0.0));
            passes.len() - 1
        });
        let passes_before = passes[before].1;
        passes[before].1 += 1.0;
        let begin = Begin {
            lane_m: run.lane_m,
            wind: plan.wind_m_s,
            position_m: run.position_m,
            speed_m_s: run.speed_m_s,
            before_s: plan.before_s,
            reversed: run.reversed,
            run: index,
            passes_before,
            extra_mass_kg: run.ballast_kg,
            air_c: run.air_c,
        };
        let samples = plant::drive(&plan.vehicle, &plan.course, laws, &run.goal, &begin, run.stop);
        let last_s = samples.last().map_or(0.0, |sample| sample.time_s);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few thousand rows")]
        let rows = (last_s * plan.rate_hz).floor() as usize + 1;
        let rows_s = row_times(&plan, rows, last_s, dice);
        if !run.held_out {
            fitted.extend(twins::seconds(&samples, run.reversed, passes_before));
        }
        let mut log = Trace::new(rows_s.clone())?;
        let mut truth = Trace::new(rows_s.clone())?;
        let at = |pick: &dyn Fn(&Sample) -> f64| -> Vec<f64> {
            rows_s.iter().map(|row_s| pick(nearest(&samples, *row_s))).collect()
        };
        truth.push("speed_m_s", at(&|sample| sample.speed_m_s), Origin::Measured)?;
        truth.push("position_m", at(&|sample| sample.position_m), Origin::Measured)?;
        for (law, column) in columns.iter().enumerate() {
            let values = at(&|sample| sample.hidden[law]);
            if !run.held_out {
                squares[law].0 += values.iter().map(|value| value * value).sum::<f64>();
                squares[law].1 += values.len();
            }
            if let (true, Some(name)) = (to_power, column.strip_suffix("_n")) {
                let power = rows_s.iter().map(|row_s| nearest(&samples, *row_s).source_per_n);
                let power: Vec<f64> = values.iter().zip(power).map(|(force, each)| -force * each).collect();
                if !run.held_out {
                    powers[law].0 += power.iter().map(|value| value * value).sum::<f64>();
                    powers[law].1 += power.len();
                }
                truth.push(format!("{name}_w"), power, Origin::Measured)?;
            }
            truth.push(column.clone(), values, Origin::Measured)?;
        }
        for sample in samples.iter().filter(|_| plan.vehicle.electric.is_some()) {
            currents = (currents.0 + sample.battery_current_a.powi(2), currents.1 + 1.0);
        }
        for channel in &plan.channels {
            let own = dice.fork();
            let mine: Vec<&Artefact> =
                faults.iter().filter(|fault| fault.channels.contains(&channel.name)).collect();
            let log_of = |faults: &[&Artefact]| {
                measure(&samples, channel.pick, &channel.sensor, faults, &rows_s, index, own.clone())
            };
            let values = log_of(&mine);
            if let Some(fault) = faults.iter().position(|fault| fault.channels.contains(&channel.name)) {
                let sound = log_of(&[]);
                let error: Vec<f64> =
                    values.iter().zip(&sound).map(|(faulty, sound)| faulty - sound).collect();
                let lost = |error: &f64| if error.is_finite() { error * error } else { 0.0 };
                faulty[fault].0 += error.iter().map(lost).sum::<f64>();
                faulty[fault].1 += error.len();
                truth.push(format!("{}_error", channel.name), error, Origin::Measured)?;
            }
            log.push(channel.name, values, Origin::Measured)?;
        }
        logs.push(Run { id: run.id.clone(), trace: log });
        along.push(Run { id: run.id.clone(), trace: truth });
    }
    let current_a = (currents.0 / f64::max(currents.1, 1.0)).sqrt();
    let sums = Sums { squares, powers, faulty, current_a };
    let mut hidden = causes(&plan, laws, names, faults, &columns, &sums);
    for (which, cause) in hidden.iter_mut().enumerate().take(laws.len()) {
        let seen = twins::seen(&plan, laws, which, &fitted);
        (cause.evidence, cause.twins) = (seen.evidence, seen.twins);
    }
    let also_true =
        if plan.has("specific_force_m_s2") { vec!["accelerometer_tilt".to_owned()] } else { Vec::new() };
    let truth = Truth {
        schema: SCHEMA.to_owned(),
        seed,
        case,
        family: plan.family.to_owned(),
        kind: kind.name().to_owned(),
        hidden,
        also_true,
        nominal: plan.nominal.priors.clone(),
        noise: plan
            .channels
            .iter()
            .map(|channel| (channel.name.to_owned(), channel.sensor.white.hypot(channel.sensor.drift)))
            .filter(|(_, noise)| *noise > 0.0)
            .collect(),
        force_noise_n: plan.force_noise_n(),
        power_noise_w: plan.power_noise_w(),
        oracle: write::oracle(laws, &plan),
        held_out: plan.runs.iter().filter(|run| run.held_out && plan.held_out_told).map(|run| run.id.clone()).collect(),
    };
    Ok(Case { plan, logs, along, truth })
}

/// Sums of squares and counts of one pass over the runs.
struct Sums {
    /// Of what each law does, in its unit.
    squares: Vec<(f64, usize)>,
    /// Of what it does in power of the source.
    powers: Vec<(f64, usize)>,
    /// Of what each fault does.
    faulty: Vec<(f64, usize)>,
    /// Root mean square of the battery's current [A].
    current_a: f64,
}

/// Times of the rows: even, or each off by up to a share of the period, in whole milliseconds.
fn row_times(plan: &Plan, rows: usize, last_s: f64, dice: &mut Dice) -> Vec<f64> {
    let period_s = 1.0 / plan.rate_hz;
    let mut time = |row: usize| {
        let off = if plan.uneven > 0.0 { plan.uneven * dice.within(-1.0, 1.0) } else { 0.0 };
        if plan.uneven > 0.0 {
            (((row as f64 + off) * period_s).clamp(0.0, last_s) * 1000.0).round() / 1000.0
        } else {
            row as f64 * period_s
        }
    };
    let mut rows_s: Vec<f64> = (0..rows).map(&mut time).collect();
    rows_s.dedup();
    rows_s
}

/// Tells what was hidden and how strong it is.
fn causes(
    plan: &Plan,
    laws: &[Law],
    names: &[&'static str],
    faults: &[Artefact],
    columns: &[String],
    sums: &Sums,
) -> Vec<Cause> {
    let rms = |(sum, count): (f64, usize)| (sum / count.max(1) as f64).sqrt();
    let mut hidden: Vec<Cause> = Vec::new();
    for (index, law) in laws.iter().enumerate() {
        let by_source = plan.vehicle.engine.is_some() && !plan.knows_force() && unit(law) == "n";
        let root = rms(sums.squares[index]);
        let noise = match unit(law) {
            "w" => plan.power_noise_w(),
            "n" if by_source => plan.power_noise_w(),
            "m_s" => plan.second_noise("speed_m_s").hypot(plan.second_noise("wheel_speed_m_s")),
            _ => plan.force_noise_n(),
        };
        let strength = match law {
            // A battery's own loss shows in no terminal power: it is seen as a voltage, ΔR I.
            Law::BatteryResistance { resistance_ohm } => {
                resistance_ohm * sums.current_a / plan.second_noise("battery_voltage_v").max(1e-12)
            }
            // What the engine could not give shows in a demand, which no log has.
            Law::TurboLag { .. } => 0.0,
            _ if by_source => rms(sums.powers[index]) / noise.max(1e-12),
            _ => root / noise.max(1e-12),
        };
        hidden.push(Cause {
            id: law.id().to_owned(),
            law: names[index].to_owned(),
            class: "physics".to_owned(),
            parameters: law.told(),
            column: columns[index].clone(),
            rms: root,
            strength,
            evidence: 0.0,
            twins: Vec::new(),
            power_column: columns[index]
                .strip_suffix("_n")
                .filter(|_| plan.vehicle.engine.is_some())
                .map(|name| format!("{name}_w")),
        });
    }
    for (index, fault) in faults.iter().enumerate() {
        let channel = fault.channels[0];
        let root = rms(sums.faulty[index]);
        hidden.push(Cause {
            id: fault.id.to_owned(),
            law: format!("{} of {channel}", fault.id),
            class: "artefact".to_owned(),
            parameters: fault.told.clone(),
            column: format!("{channel}_error"),
            rms: root,
            strength: root / plan.second_noise(channel).max(1e-12),
            evidence: 0.0,
            twins: Vec::new(),
            power_column: None,
        });
    }
    hidden
}

fn unit(law: &Law) -> &'static str {
    law.amount(&crate::hidden::Now::default(), 0.0).0
}

/// A column for each law: its id and unit, numbered where two have one id.
fn columns(laws: &[Law]) -> Vec<String> {
    let mut columns: Vec<String> = Vec::new();
    for law in laws {
        let (id, unit) = (law.id(), unit(law));
        let name = format!("{id}_{unit}");
        columns.push(if columns.contains(&name) { format!("{id}_2_{unit}") } else { name });
    }
    columns
}

fn nearest(samples: &[Sample], at_s: f64) -> &Sample {
    let index = samples.partition_point(|sample| sample.time_s < at_s - 0.5 * plant::STEP_S);
    &samples[index.min(samples.len() - 1)]
}

impl Case {
    /// Writes the case into a folder, which is made.
    ///
    /// # Errors
    /// [`ConcealError::File`], [`ConcealError::Json`] or [`ConcealError::Trace`].
    pub fn write(&self, folder: &Path) -> Result<(), ConcealError> {
        write::case(self, folder)
    }
}

/// A fault's parameter.
pub(crate) fn amount(name: &str, value: f64, unit: &str) -> Vec<Told> {
    vec![parameter(name, value, unit)]
}

/// A spell in every second run.
pub(crate) fn every_second(runs: usize, mut of: impl FnMut(usize) -> (f64, f64, f64)) -> Vec<Spell> {
    let spell = |run: usize| {
        let (from_s, to_s, amount) = of(run);
        Spell { run, from_s, to_s, amount }
    };
    (0..runs).step_by(2).map(spell).collect()
}
