//! What may stand in a law that is looked for: of the situation, never made of what is to be explained.

use crate::Case;
use crate::balances::balance::Kind;
use crate::case::range;
use crate::line::Line;
use crate::runs::recorded::Recorded;
use crate::runs::said::{Said, inputs};
use headland_calibrate::statistics::median;
use headland_sim::{Drive, Inputs, local_fit, travelled};
use headland_symbolic::{Enters, Variable};
use std::f64::consts::PI;

/// A wave takes so many blocks of samples.
const BLOCKS: f64 = 4.0;

/// Mass that rests on the wheels, sample by sample, where that is known to differ; loads of a drive are told by themselves.
fn masses_kg(case: &Case) -> Option<Vec<Vec<f64>>> {
    let priors = case.study.priors();
    let of_run = |run: &Recorded| {
        let model = case.study.model(&run.measured, &priors).ok()?;
        let trace = &run.measured.trace;
        let carried = |index: usize| trace.get("payload_kg").map_or(0.0, |payload| payload[index]);
        Some((0..trace.len()).map(|index| model.vehicle.mass_kg + carried(index)).collect())
    };
    case.runs.iter().map(of_run).collect()
}

/// How far every run came since it began, sample by sample [m].
fn ways_m(case: &Case) -> Vec<Vec<f64>> {
    let of_run = |run: &Recorded| {
        let speeds: Vec<f64> = run.motion.value.iter().map(|speed| speed.abs()).collect();
        travelled(run.measured.trace.time_s(), &speeds)
    };
    case.runs.iter().map(of_run).collect()
}

/// Whether the way that a run came says where it is as well: all of them began at one place and went on from there.
pub fn way_is_place(case: &Case) -> bool {
    let places: Vec<f64> = case.runs.iter().flat_map(|run| run.position_m.iter().copied()).collect();
    !leaves(&ways_m(case), &places)
}

/// Whether a series of every run leaves a straight line of another that says as much.
fn leaves(runs: &[Vec<f64>], other: &[f64]) -> bool {
    /// By this share of all that it spans.
    const APART: f64 = 0.05;
    let all: Vec<f64> = runs.iter().flatten().copied().collect();
    let line = Line::through(other, &all);
    let (least, most) = range(all.iter().copied());
    all.iter().zip(other).any(|(own, at)| (own - line.at(*at)).abs() > APART * (most - least))
}

/// The charge of the battery, where it is no other word for the time or the way that passed.
fn charges(case: &Case, charges: Option<Vec<Vec<f64>>>) -> Option<Vec<Vec<f64>>> {
    let times_s: Vec<f64> = case.runs.iter().flat_map(|run| run.measured.trace.time_s()).copied().collect();
    let places_m: Vec<f64> = case.runs.iter().flat_map(|run| run.position_m.iter().copied()).collect();
    charges.filter(|runs| leaves(runs, &times_s) && leaves(runs, &places_m))
}

/// What of a recorded wind blows against the vehicle, or across it from the right, sample by sample.
fn wind_m_s(case: &Case, part: fn(f64) -> f64) -> Option<Vec<Vec<f64>>> {
    let of_run = |run: &Recorded| {
        let channel = |name: &str| run.measured.trace.get(name);
        let (speed, from) = (channel("wind_speed_m_s")?, channel("wind_direction_rad")?);
        let heading = channel("heading_rad").map(<[f64]>::to_vec).or_else(|| headings_rad(case, run))?;
        let at = |index: usize| speed[index] * part(from[index] - heading[index]);
        Some((0..speed.len()).map(at).collect())
    };
    case.runs.iter().map(of_run).collect()
}

/// Where a run of which nobody recorded it was headed, sample by sample [rad]: along the terrain, or against it.
fn headings_rad(case: &Case, run: &Recorded) -> Option<Vec<f64>> {
    let model = case.study.model(&run.measured, &case.study.priors()).ok()?;
    let turned = if run.measured.how.reversed_from_m.is_some() { PI } else { 0.0 };
    Some(run.position_m.iter().map(|at_m| model.terrain.at(*at_m).heading_rad + turned).collect())
}

/// Sine of the roll, sample by sample, where the model is driven by it.
fn rolls(case: &Case) -> Option<Vec<Vec<f64>>> {
    let of_run = |(run, said): (&Recorded, &Said)| {
        let roll_rad = run.measured.trace.get("roll_rad")?;
        let sine =
            |(roll_rad, sin_slope): (&f64, &f64)| roll_rad.sin() * (1.0 - sin_slope * sin_slope).sqrt();
        Some(roll_rad.iter().zip(&said.sin_slope).map(sine).collect())
    };
    case.runs
        .iter()
        .zip(&case.nominal)
        .map(of_run)
        .collect::<Option<_>>()
        .filter(|_| is_told(case, Inputs::Roll))
}

/// Whether the model is driven by a recorded input in every run.
fn is_told(case: &Case, input: Inputs) -> bool {
    case.runs.iter().all(|run| inputs(&run.measured.trace, &run.measured.how).contains(&input))
}

/// What may stand in a law: of the situation, never made of what is to be explained.
pub fn variables(case: &Case, kind: Kind) -> Vec<Variable> {
    /// Name, unit, samples of every run where they are known.
    type Offered = (&'static str, &'static str, Option<Vec<Vec<f64>>>);
    let channel = |name: &str| -> Option<Vec<Vec<f64>>> {
        case.runs.iter().map(|run| run.measured.trace.get(name).map(<[f64]>::to_vec)).collect()
    };
    let of = |values: &dyn Fn(&crate::runs::recorded::Recorded) -> Vec<f64>| {
        Some(case.runs.iter().map(values).collect())
    };
    let block_s = crate::balances::balance::block_s(kind, &case.runs, case.rows);
    let speeds: Vec<f64> = case.runs.iter().flat_map(|run| run.motion.value.iter().copied()).collect();
    let finest = |name: &str| match name {
        "t" => BLOCKS * block_s,
        "x" | "way" => BLOCKS * block_s * median(&speeds).abs(),
        _ => 0.0,
    };
    // As the speed has it: what a measured force makes of it shares its noise with a power that is held against that force, and bends of
    // it beside the force would follow that noise, in runs that are held out as well.
    let acceleration = kind.is_power().then(|| of(&|run| run.motion.slope.clone())).flatten();
    // Where no force was measured a power is made of the acceleration already: what a mass would take of it, or what comes late,
    // goes with its sign.
    let forced = case.runs.iter().all(Recorded::force_is_known);
    let engine_speed = channel("engine_speed_rad_s").filter(|runs| kind.is_power() && tells_more(case, runs));
    // Where nobody recorded a place it is the way.
    let placed = case.runs.iter().any(|run| run.measured.trace.get("position_m").is_some());
    let from_one_place = way_is_place(case);
    let ways = (placed && !kind.is_power() || !from_one_place).then(|| ways_m(case));
    let enters = |name: &str| match name {
        "acceleration" if !forced => Enters::BySize,
        // What fades from the place at which all runs begin does so with the way.
        "x" if placed && from_one_place && !kind.is_power() => Enters::Within,
        _ => Enters::Freely,
    };
    let whole = |runs: &Vec<Vec<f64>>| runs.iter().flatten().all(|value| value.is_finite());
    let slope = Some(case.nominal.iter().map(|said| said.sin_slope.clone()).collect());
    let taken = |name: &str, input: Inputs| channel(name).filter(|_| is_told(case, input));
    let offered: [Offered; 20] = [
        ("v", "m/s", of(&|run| run.motion.value.clone())),
        ("acceleration", "m/s²", acceleration),
        ("engine_speed", "rad/s", engine_speed),
        ("x", "m", of(&|run| run.position_m.clone())),
        ("way", "m", ways),
        ("t", "s", of(&|run| run.measured.trace.time_s().to_vec())),
        ("heading", "rad", channel("heading_rad").filter(|runs| turns(runs))),
        ("kappa", "1/m", channel("curvature_per_m")),
        ("temperature", "°C", channel("air_temperature_c")),
        ("oil_temperature", "°C", channel("oil_temperature_c")),
        ("state_of_charge", "1", charges(case, channel("state_of_charge").filter(whole))),
        ("tyre_pressure", "Pa", channel("tyre_pressure_pa")),
        ("coasting", "1", channel("coasting")),
        ("slope", "1", slope),
        ("roll", "1", rolls(case)),
        ("pto_power", "W", taken("pto_power_w", Inputs::PtoPower)),
        ("hydraulic_power", "W", taken("hydraulic_power_w", Inputs::HydraulicPower)),
        ("m", "kg", masses_kg(case)),
        ("headwind", "m/s", wind_m_s(case, f64::cos)),
        ("crosswind", "m/s", wind_m_s(case, f64::sin)),
    ];
    let variable = |(name, unit, runs): Offered| {
        Some(Variable {
            name: name.to_owned(),
            unit: unit.to_owned(),
            runs: runs.filter(whole)?,
            twin: None,
            finest: finest(name),
            enters: enters(name),
        })
    };
    offered.into_iter().filter_map(variable).collect()
}

/// An acceleration that forces make [m/s²], which shows what is sudden, and over longer as the speed has it. What the nominal parameters
/// are wrong by would else be an acceleration wherever a speed is held, and tell of that speed.
fn as_it_lasts_m_s2(run: &Recorded, made: &[f64]) -> Vec<f64> {
    /// Beside the median over so long to either side nothing is sudden [s].
    const AROUND_S: f64 = 3.0;
    let time_s = run.measured.trace.time_s();
    let apart: Vec<f64> = run.motion.slope.iter().zip(made).map(|(recorded, made)| recorded - made).collect();
    let lasting = |at: &f64| {
        let from = time_s.partition_point(|time| *time < at - AROUND_S);
        let to = time_s.partition_point(|time| *time <= at + AROUND_S);
        let near: Vec<f64> = apart[from..to].iter().copied().filter(|apart| apart.is_finite()).collect();
        if near.is_empty() { 0.0 } else { median(&near) }
    };
    made.iter().zip(time_s).map(|(made, at)| made + lasting(at)).collect()
}

/// Acceleration that the recorded forces make, sample by sample of every run [m/s²].
pub fn made_m_s2(case: &Case) -> Vec<Vec<f64>> {
    case.runs.iter().map(|run| as_it_lasts_m_s2(run, &run.acceleration_m_s2)).collect()
}

/// What a force may be made of beside a measured one, sample by sample of every run [m/s²]: the acceleration as that force makes it or as
/// the speed has it, whichever is less, and none where they do not agree on its sign. Where a speed is held the first is the mismatch
/// itself, and the second where a force is: none where any run knows no force, or coasts all along.
pub fn agreed_m_s2(case: &Case) -> Option<Vec<Vec<f64>>> {
    let of_run = |run: &Recorded| {
        let made =
            local_fit(run.measured.trace.time_s(), &run.acceleration_m_s2, run.measured.how.smoothing_s);
        let least = |(made, recorded): (&f64, &f64)| {
            if made * recorded > 0.0 { made.signum() * made.abs().min(recorded.abs()) } else { 0.0 }
        };
        made.value.iter().zip(&run.motion.slope).map(least).collect()
    };
    let driven = |run: &Recorded| run.forward().is_some_and(|drive| drive != Drive::Coast);
    let forced = case.runs.iter().all(|run| run.force_is_known() && driven(run));
    forced.then(|| case.runs.iter().map(of_run).collect())
}

/// Acceleration that the recorded forces make with a law that hangs on it [m/s²], of what that says sample by sample of every run,
/// against the motion [N].
pub fn moved_m_s2(case: &Case, law_n: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let of_run = |(run, law_n): (&Recorded, &Vec<f64>)| {
        let mass_kg = &case.nominal[run.number].effective_mass_kg;
        let with = |(index, made): (usize, &f64)| {
            made - run.motion.value[index].signum() * law_n[index] / mass_kg[index]
        };
        let made: Vec<f64> = run.acceleration_m_s2.iter().enumerate().map(with).collect();
        as_it_lasts_m_s2(run, &made)
    };
    case.runs.iter().zip(law_n).map(of_run).collect()
}

/// Whether courses point to more than one direction and its opposite: of those a heading says no more than which of the two it is.
fn turns(heading_rad: &[Vec<f64>]) -> bool {
    /// Mean resultant length of the doubled angles beyond which all are of one line: within some 13° of it.
    const ONE_LINE: f64 = 0.9;
    let all = || heading_rad.iter().flatten();
    let (north, east) = all().fold((0.0, 0.0), |(north, east), heading| {
        (north + (2.0 * heading).cos(), east + (2.0 * heading).sin())
    });
    north.hypot(east) < ONE_LINE * all().count() as f64
}

/// Whether recorded speeds of the engine say more than the vehicle's: one that gears tie to the wheels turns as they do. They have
/// to be those that the model is driven by, too.
fn tells_more(case: &Case, engine_rad_s: &[Vec<f64>]) -> bool {
    /// Share of its square that may follow the speed of the vehicle.
    const TIED: f64 = 0.95;
    let speeds: Vec<f64> = case.runs.iter().flat_map(|run| &run.motion.value).map(|v| v.abs()).collect();
    let engine: Vec<f64> = engine_rad_s.iter().flatten().copied().collect();
    is_told(case, Inputs::EngineSpeed) && Line::through(&speeds, &engine).followed < TIED
}

#[cfg(test)]
mod tests {
    use super::{leaves, turns};

    #[test]
    fn to_and_fro_on_one_line_is_no_turn() {
        let lane = vec![vec![0.3, 0.31, 0.29], vec![0.3 + std::f64::consts::PI; 3]];
        assert!(!turns(&lane));
        assert!(turns(&[vec![0.0, 0.5, 1.0, 1.5, 2.0, 2.5]]));
    }

    #[test]
    fn a_charge_that_falls_as_time_passes_says_no_more_than_the_time() {
        let times_s: Vec<f64> = (0..40).map(f64::from).collect();
        let falls = |from: f64| times_s.iter().map(|time_s| from - 0.01 * time_s).collect::<Vec<f64>>();
        let twice = [times_s.clone(), times_s.clone()].concat();
        assert!(!leaves(&[falls(0.9), falls(0.9)], &twice));
        assert!(leaves(&[falls(0.9), falls(0.6)], &twice));
    }
}
