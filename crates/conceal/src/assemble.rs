//! Puts a case together: its runs as the plant drives them, its logs as the sensors see them, and the truth.

use crate::case::{Case, Kind};
use crate::dice::Dice;
use crate::error::ConcealError;
use crate::hidden::{Law, Now};
use crate::plan::Plan;
use crate::plant::{self, Begin, Sample};
use crate::sensor::{Artefact, measure};
use crate::truth::{Cause, SCHEMA, Truth};
use crate::twins::{self, Second};
use crate::write;
use headland_trace::{Origin, Run, Trace};

/// Drives, measures and tells.
pub(crate) fn assemble(
    (seed, case, kind): (u64, usize, Kind),
    plan: Plan,
    laws: &[Law],
    names: &[&'static str],
    faults: &[Artefact],
    dice: &mut Dice,
) -> Result<Case, ConcealError> {
    let (mut logs, mut along) = (Vec::new(), Vec::new());
    let columns = columns(laws);
    let mut sums = Sums {
        laws: vec![Square::default(); laws.len()],
        powers: vec![Square::default(); laws.len()],
        faults: vec![Square::default(); faults.len()],
        current: Square::default(),
        fitted: Vec::new(),
    };
    for index in 0..plan.runs.len() {
        let samples = driven(&plan, laws, index);
        let last_s = samples.last().map_or(0.0, |sample| sample.time_s);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few thousand rows")]
        let rows = (last_s * plan.rate_hz).floor() as usize + 1;
        let rows_s = row_times(&plan, rows, last_s, dice);
        let id = plan.runs[index].id.clone();
        let mut trace = truth_of(&plan, &columns, index, &samples, &rows_s, &mut sums)?;
        let mut log = Trace::new(rows_s.clone())?;
        for channel in &plan.channels {
            let own = dice.fork();
            let of_channel = |fault: &&Artefact| fault.channels.contains(&channel.name);
            let log_of = |faults: &[&Artefact]| {
                measure(&samples, channel.pick, &channel.sensor, faults, &rows_s, index, own.clone())
            };
            let values = log_of(&faults.iter().filter(of_channel).collect::<Vec<_>>());
            if let Some(fault) = faults.iter().position(|fault| of_channel(&fault)) {
                let sound = log_of(&[]);
                let error: Vec<f64> =
                    values.iter().zip(&sound).map(|(faulty, sound)| faulty - sound).collect();
                sums.faults[fault].add(&error);
                trace.push(format!("{}_error", channel.name), error, Origin::Measured)?;
            }
            log.push(channel.name, values, Origin::Measured)?;
        }
        logs.push(Run { id: id.clone(), trace: log });
        along.push(Run { id, trace });
    }
    let mut hidden = causes(&plan, laws, names, faults, &columns, &sums);
    for (which, cause) in hidden.iter_mut().enumerate().take(laws.len()) {
        let seen = twins::seen(&plan, laws, which, &sums.fitted);
        (cause.evidence, cause.twins) = (seen.evidence, seen.twins);
    }
    let noise = |channel: &crate::plan::Channel| {
        (channel.name.to_owned(), channel.sensor.white.hypot(channel.sensor.drift))
    };
    let tilts = plan.has("specific_force_m_s2").then(|| "accelerometer_tilt".to_owned());
    let coarse = |channel: &crate::plan::Channel| {
        channel.sensor.white > 0.0 && channel.sensor.step >= channel.sensor.white
    };
    let steps = plan.channels.iter().any(coarse).then(|| "quantisation".to_owned());
    let truth = Truth {
        schema: SCHEMA.to_owned(),
        seed,
        case,
        family: plan.family.to_owned(),
        kind: kind.name().to_owned(),
        hidden,
        also_true: tilts.into_iter().chain(steps).collect(),
        nominal: plan.nominal.priors.clone(),
        noise: plan.channels.iter().map(noise).filter(|(_, noise)| *noise > 0.0).collect(),
        force_noise_n: plan.force_noise_n(),
        power_noise_w: plan.power_noise_w(),
        oracle: write::oracle(laws, &plan),
        held_out: plan
            .runs
            .iter()
            .filter(|run| run.held_out && plan.held_out_told)
            .map(|run| run.id.clone())
            .collect(),
    };
    Ok(Case { plan, logs, along, truth })
}

/// How many runs drove the lane of a run before it.
fn passes_before(plan: &Plan, index: usize) -> f64 {
    let lane = plan.runs[index].lane;
    plan.runs[..index].iter().filter(|run| run.lane == lane).count() as f64
}

fn driven(plan: &Plan, laws: &[Law], index: usize) -> Vec<Sample> {
    let run = &plan.runs[index];
    let begin = Begin {
        position_m: run.position_m,
        lane_m: run.lane_m,
        wind: plan.wind_m_s,
        speed_m_s: run.speed_m_s,
        before_s: plan.before_s,
        reversed: run.reversed,
        run: index,
        passes_before: passes_before(plan, index),
        extra_mass_kg: run.ballast_kg,
        air_c: run.air_c,
    };
    plant::drive(&plan.vehicle, &plan.course, laws, &run.goal, &begin, run.stop)
}

/// What was hidden along a run, with true speed and position.
fn truth_of(
    plan: &Plan,
    columns: &[String],
    index: usize,
    samples: &[Sample],
    rows_s: &[f64],
    sums: &mut Sums,
) -> Result<Trace, ConcealError> {
    let run = &plan.runs[index];
    let mut truth = Trace::new(rows_s.to_vec())?;
    let at = |pick: &dyn Fn(&Sample) -> f64| -> Vec<f64> {
        rows_s.iter().map(|row_s| pick(nearest(samples, *row_s))).collect()
    };
    truth.push("speed_m_s", at(&|sample| sample.speed_m_s), Origin::Measured)?;
    truth.push("position_m", at(&|sample| sample.position_m), Origin::Measured)?;
    if plan.vehicle.electric.is_some() {
        sums.current.add(&at(&|sample| sample.battery_current_a));
    }
    if !run.held_out {
        sums.fitted.extend(twins::seconds(samples, run.reversed, passes_before(plan, index)));
    }
    for (law, column) in columns.iter().enumerate() {
        let values = at(&|sample| sample.hidden[law]);
        if let (true, Some(name)) = (plan.vehicle.engine.is_some(), column.strip_suffix("_n")) {
            let power = at(&|sample| -sample.hidden[law] * sample.source_per_n);
            if !run.held_out {
                sums.powers[law].add(&power);
            }
            truth.push(format!("{name}_w"), power, Origin::Measured)?;
        }
        if !run.held_out {
            sums.laws[law].add(&values);
        }
        truth.push(column.clone(), values, Origin::Measured)?;
    }
    Ok(truth)
}

/// A sum of squares and a count.
#[derive(Clone, Copy, Default)]
struct Square(f64, usize);

impl Square {
    fn add(&mut self, values: &[f64]) {
        let finite = values.iter().filter(|value| value.is_finite());
        self.0 += finite.map(|value| value * value).sum::<f64>();
        self.1 += values.len();
    }

    fn root(self) -> f64 {
        (self.0 / self.1.max(1) as f64).sqrt()
    }
}

/// What one pass over the runs adds up.
struct Sums {
    /// What each law does, in its unit.
    laws: Vec<Square>,
    /// What it does in power of the source.
    powers: Vec<Square>,
    /// What each fault does.
    faults: Vec<Square>,
    /// The battery's current [A].
    current: Square,
    /// Seconds of the runs that are fitted.
    fitted: Vec<Second>,
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
    let mut hidden: Vec<Cause> = Vec::new();
    for (index, law) in laws.iter().enumerate() {
        let by_source = plan.vehicle.engine.is_some() && !plan.knows_force() && unit(law) == "n";
        let root = sums.laws[index].root();
        let noise = match unit(law) {
            "w" => plan.power_noise_w(),
            "n" if by_source => plan.power_noise_w(),
            "m_s" => plan.second_noise("speed_m_s").hypot(plan.second_noise("wheel_speed_m_s")),
            _ => plan.force_noise_n(),
        };
        let strength = match law {
            // A battery's own loss shows in no terminal power: it is seen as a voltage, ΔR I.
            Law::BatteryResistance { resistance_ohm } => {
                resistance_ohm * sums.current.root() / plan.second_noise("battery_voltage_v").max(1e-12)
            }
            // What the engine could not give shows in a demand, which no log has.
            Law::TurboLag { .. } => 0.0,
            _ if by_source => sums.powers[index].root() / noise.max(1e-12),
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
        let root = sums.faults[index].root();
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
    law.amount(&Now::default(), 0.0).0
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
