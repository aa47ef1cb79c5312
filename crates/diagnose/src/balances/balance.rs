//! The balances: what was measured against what the model says, row by row, all of them side by side.

use crate::balances::gram::Column;
use crate::balances::likeliest::{Weighted, likeliest};
use crate::balances::loudness;
use crate::balances::noise::{Noise, Noises, Shape};
use crate::balances::rows::{Chunk, Row, chunks};
use crate::balances::steps::unsure;
use crate::outliers::tails::Tails;
use crate::runs::overrun::overruns;
use crate::runs::recorded::{Recorded, SLOWEST_M_S};
use crate::runs::said::Said;
use crate::soundness::voltage::change_v;
use headland_calibrate::statistics::{NORMAL_OF_MEDIAN, median};
use headland_recording::renewed_s;
use nalgebra::DVector;
use serde::Serialize;
use std::borrow::Cow;

/// Which balance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Specific force against acceleration and slope.
    Parity,
    /// Wheel speed against speed over ground.
    Slip,
    /// Forces against the change of momentum.
    Motion,
    /// The engine's power against what wheels, losses and auxiliaries take.
    Shaft,
    /// Battery power against what drives and auxiliaries take.
    Battery,
    /// What the state of charge loses against what drives and auxiliaries take: the battery balance where neither current
    /// nor voltage is known.
    #[serde(rename = "battery")]
    Charge,
    /// Battery voltage against its current: the battery balance's other half.
    #[serde(rename = "battery")]
    Voltage,
    /// Fuel against the engine's work.
    Fuel,
}

impl Kind {
    /// From the ground up: a mismatch lives in the first that does not close.
    pub const ORDER: [Self; 8] = [
        Self::Parity,
        Self::Slip,
        Self::Motion,
        Self::Shaft,
        Self::Battery,
        Self::Charge,
        Self::Voltage,
        Self::Fuel,
    ];

    /// Whether a power is balanced, and every cause that takes some shows in it.
    pub fn is_power(self) -> bool {
        matches!(self, Self::Shaft | Self::Battery | Self::Charge | Self::Fuel)
    }

    /// Whether it is among the balances that a cause is listed for: what shows in the fuel shows at the shaft as far as it
    /// takes power there, and what shows in the battery's power in its charge.
    pub fn among(self, listed: &[Self]) -> bool {
        let like = match self {
            Self::Shaft => Self::Fuel,
            Self::Charge => Self::Battery,
            own => own,
        };
        listed.contains(&self) || listed.contains(&like)
    }

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Parity => "parity",
            Self::Slip => "slip",
            Self::Motion => "motion",
            Self::Shaft => "shaft",
            Self::Battery | Self::Charge | Self::Voltage => "battery",
            Self::Fuel => "fuel",
        }
    }

    /// What it holds against what, in words.
    pub fn sides(self) -> &'static str {
        match self {
            Self::Parity => "the accelerometer against acceleration and slope",
            Self::Slip => "the speed of the wheels against that over ground",
            Self::Motion => "forces against acceleration",
            Self::Shaft => "the engine's power against what is taken from it",
            Self::Battery => "the battery's power against what is taken from it",
            Self::Charge => "the state of charge against what is taken from the battery",
            Self::Voltage => "the battery's voltage against its current",
            Self::Fuel => "fuel against the engine's work",
        }
    }

    /// Unit of its residual.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Parity => "m/s²",
            Self::Slip => "m/s",
            Self::Motion => "N",
            Self::Shaft | Self::Battery | Self::Charge | Self::Fuel => "W",
            Self::Voltage => "V",
        }
    }

    /// The signal by which before and after are told.
    pub fn signal(self) -> &'static str {
        match self {
            Self::Parity => "specific_force_m_s2",
            Self::Slip => "wheel_speed_m_s",
            Self::Motion => "speed_m_s",
            Self::Shaft => "engine_power_w",
            Self::Battery | Self::Charge => "battery_power_w",
            Self::Voltage => "battery_voltage_v",
            Self::Fuel => "fuel_rate_kg_s",
        }
    }

    /// Its signal over its rows: fuel is balanced as the power that it holds.
    pub fn per_unit(self) -> f64 {
        if self == Self::Fuel { 1.0 / FUEL_J_KG } else { 1.0 }
    }

    /// Channels whose renewals its rows wait for.
    fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Parity => &["speed_m_s", "specific_force_m_s2"],
            Self::Slip => &["speed_m_s", "wheel_speed_m_s"],
            Self::Motion => &["speed_m_s"],
            Self::Shaft => &["engine_torque_n_m"],
            Self::Battery => &["battery_power_w"],
            Self::Charge => &["state_of_charge"],
            Self::Voltage => &["battery_voltage_v"],
            Self::Fuel => &["fuel_rate_kg_s"],
        }
    }

    /// How the noise of its sensor comes through.
    fn shape(self) -> Shape {
        if matches!(self, Self::Motion | Self::Parity | Self::Charge) {
            Shape::Differenced
        } else {
            Shape::Averaged
        }
    }
}

/// The rows of all balances of all runs, those held out among them.
#[derive(Clone)]
pub struct System {
    /// The balances, from the ground up; a chunk says to which it belongs.
    pub kinds: Vec<Kind>,
    /// Rows that follow each other in one run and one balance.
    pub chunks: Vec<Chunk>,
    /// Measured minus modelled, with the nominal model.
    pub residual: Column,
    /// Length of a block of each balance [s].
    pub blocks_s: Vec<f64>,
    /// Variance that the mean of a row usually has by what lasts and is no physics, where that is known of a balance.
    pub usual: Vec<Option<f64>>,
    /// The runs, by number, whose force is known most of the time.
    pub forced: Vec<bool>,
    /// Whether what a line between fuel and work leaves grows with its power.
    pub bent: bool,
}

/// Rows wanted of a run.
const ROWS_PER_RUN: f64 = 300.0;
/// Gusts, a driver's foot, a rough surface: what lasts longer than this is no noise, it is physics [s].
const LASTING_S: f64 = 5.0;
/// Rows of a balance of powers at most: more only take longer.
const MOST_ROWS: f64 = 16_000.0;
/// Rows of a balance of forces at most: a drive in a town is braked every few seconds, and long blocks fit nowhere between.
const MOST_ROWS_OF_MOTION: f64 = 18_000.0;
/// Rows of a balance of powers at most while causes are searched.
const FEW_ROWS: f64 = 6_000.0;
/// Lower heating value that turns fuel into watts in residuals [J/kg]: diesel, EN 590; a scale only.
pub const FUEL_J_KG: f64 = 42.8e6;

/// How many rows a long recording is brought to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rows {
    /// As many as a search needs.
    Few,
    /// As many as tell what was found well.
    Many,
}

impl System {
    /// The rows of the balances `kinds`; samples that are not `allowed` belong to none.
    pub fn new(
        kinds: &[Kind],
        runs: &[Recorded],
        said: &[Said],
        block_s: &dyn Fn(Kind) -> f64,
        allowed: &[Vec<bool>],
        fit: &[bool],
    ) -> Self {
        let (mut kept, mut all): (Vec<Kind>, Vec<Chunk>) = (Vec::new(), Vec::new());
        for kind in kinds {
            let mut own = Vec::new();
            for (index, (run, said)) in runs.iter().zip(said).enumerate() {
                let usable = usable(*kind, run, said);
                let usable: Vec<bool> =
                    usable.iter().zip(&allowed[index]).map(|(one, other)| *one && *other).collect();
                own.extend(chunks(kept.len(), index, run.measured.trace.time_s(), &usable, block_s(*kind)));
            }
            if own.iter().any(|chunk| fit[chunk.run]) {
                kept.push(*kind);
                all.extend(own);
            }
        }
        let blocks_s: Vec<f64> = kept.iter().map(|kind| block_s(*kind)).collect();
        let usual = kept.iter().zip(&blocks_s).map(|(kind, block_s)| Some(unsteady(*kind, said)? / block_s));
        let usual = usual.collect();
        let mut system = Self {
            kinds: kept,
            chunks: all,
            residual: Vec::new(),
            blocks_s,
            usual,
            forced: runs.iter().map(Recorded::force_is_known).collect(),
            bent: false,
        };
        system.residual = system.residual_of(runs, said);
        system.listen(runs, said, fit);
        system.doubt_steps(runs, fit);
        system
    }

    /// Whether powers are made of nothing but motion.
    fn is_of_motion(&self) -> bool {
        !self.forced.contains(&true)
    }

    /// Lets rows of fuel be as loud as they show themselves, by their power or by their speed.
    fn listen(&mut self, runs: &[Recorded], said: &[Said], fit: &[bool]) {
        let Some(number) = self.kinds.iter().position(|kind| *kind == Kind::Fuel) else { return };
        let column = |of: &dyn Fn(usize) -> Vec<f64>| {
            self.column(|kind| match kind {
                Kind::Fuel => (0..said.len()).map(of).collect(),
                _ => vec![Vec::new(); said.len()],
            })
        };
        let power = column(&|run| said[run].fuel_w());
        let speed = column(&|run| runs[run].motion.value.iter().map(|speed| speed.abs()).collect());
        let of_fuel = |index: &usize| self.chunks[*index].balance == number;
        let (Some(first), Some(last)) =
            ((0..self.chunks.len()).find(of_fuel), (0..self.chunks.len()).rfind(of_fuel))
        else {
            return;
        };
        let own = first..last + 1;
        let grown = |size: &Column| {
            let (chunks, left) = (&self.chunks[own.clone()], &self.residual[own.clone()]);
            loudness::grown(chunks, fit, left, &power[own.clone()], &size[own.clone()])
        };
        let by_speed = if self.is_of_motion() { grown(&speed) } else { None };
        let by_power = grown(&power);
        let gain = |one: &Option<(f64, Vec<Vec<f64>>)>| one.as_ref().map_or(0.0, |one| one.0);
        self.bent = gain(&by_power) > gain(&by_speed);
        if let Some((_, loud)) = if self.bent { by_power } else { by_speed } {
            for (chunk, loud) in self.chunks[own].iter_mut().zip(loud) {
                chunk.loudness = loud;
            }
        }
    }

    /// Lets rows be as loud as a step between two samples makes them that nobody knows the time of (steps.rs).
    fn doubt_steps(&mut self, runs: &[Recorded], fit: &[bool]) {
        /// A logger is slow that leaves so much time between two values: its speed is smoothed over what drivers do [s].
        const SLOW_S: f64 = 0.4;
        let of_motion = self.is_of_motion();
        let open = |kind: Kind| -> Vec<Vec<f64>> {
            let of_run = |run: &Recorded| match run.driven(kind) {
                // What is made of motion knows of a step of the shaft only as its speed was smoothed; fuel has noise of its own there.
                Some((values, step_s)) => {
                    let smoothed_s = if kind == Kind::Shaft && of_motion && step_s > SLOW_S {
                        run.measured.how.smoothing_s
                    } else {
                        0.0
                    };
                    unsure(&values, run.measured.trace.time_s(), step_s + smoothed_s)
                }
                None => Vec::new(),
            };
            runs.iter().map(of_run).collect()
        };
        for (number, kind) in self.kinds.iter().enumerate() {
            let open = open(*kind);
            if open.iter().all(Vec::is_empty) {
                continue;
            }
            let usual = self.quiet_variance(number, &self.residual, fit);
            let Some(usual) = usual.filter(|usual| *usual > 0.0) else { continue };
            for chunk in self.chunks.iter_mut().filter(|chunk| chunk.balance == number) {
                let time_s = runs[chunk.run].measured.trace.time_s();
                let shares: Vec<f64> = chunk
                    .rows
                    .iter()
                    .map(|row| row.mean_variance(time_s, &open[chunk.run]) / usual)
                    .collect();
                // What is less than the usual noise is in it.
                if shares.iter().all(|share| *share < 1.0) {
                    continue;
                }
                let before = |row: usize| chunk.loudness.get(row).copied().unwrap_or(1.0);
                let loud = shares
                    .iter()
                    .enumerate()
                    .map(|(row, share)| before(row).hypot(if *share < 1.0 { 0.0 } else { share.sqrt() }));
                chunk.loudness = loud.collect();
            }
        }
    }

    /// How the noise of a balance may come through: that of a power that is made of motion is the speed's more often than its own.
    fn shapes_of(&self, kind: Kind) -> Vec<Shape> {
        if self.is_of_motion() && kind.is_power() {
            vec![Shape::Differenced, Shape::Averaged]
        } else {
            vec![kind.shape()]
        }
    }

    /// How many rows there are.
    pub fn row_count(&self) -> usize {
        self.chunks.iter().map(|chunk| chunk.rows.len()).sum()
    }

    /// How many rows one balance has.
    pub fn row_count_of(&self, kind: Kind) -> usize {
        self.chunks.iter().filter(|chunk| self.kind(chunk) == kind).map(|chunk| chunk.rows.len()).sum()
    }

    /// The balance of a chunk.
    pub fn kind(&self, chunk: &Chunk) -> Kind {
        self.kinds[chunk.balance]
    }

    /// Whether there is this balance.
    pub fn has(&self, kind: Kind) -> bool {
        self.kinds.contains(&kind)
    }

    /// The residual of other recordings of the same runs, on the same rows.
    pub fn residual_of(&self, runs: &[Recorded], said: &[Said]) -> Column {
        let of = |chunk: &Chunk| residual(self.kind(chunk), &runs[chunk.run], &said[chunk.run], chunk);
        self.chunks.iter().map(of).collect()
    }

    /// Samples brought to rows: those of each balance, run by run.
    pub fn column(&self, samples: impl Fn(Kind) -> Vec<Vec<f64>>) -> Column {
        let of_kind: Vec<Vec<Vec<f64>>> = self.kinds.iter().map(|kind| samples(*kind)).collect();
        let of_chunk = |chunk: &Chunk| {
            let samples = &of_kind[chunk.balance][chunk.run];
            let of = |row: &Row| {
                let mean = if samples.is_empty() { 0.0 } else { row.mean(samples) };
                if mean.is_finite() { mean } else { 0.0 }
            };
            DVector::from_iterator(chunk.rows.len(), chunk.rows.iter().map(of))
        };
        self.chunks.iter().map(of_chunk).collect()
    }

    /// Takes from a column the balances that are not `wanted`.
    pub fn silence(&self, column: &mut Column, wanted: impl Fn(Kind) -> bool) {
        for (chunk, values) in self.chunks.iter().zip(column) {
            if !wanted(self.kind(chunk)) {
                values.fill(0.0);
            }
        }
    }

    /// The noise that makes what is left of the runs that are `fit` most likely, balance by balance.
    pub fn noises(&self, left: &Column, fit: &[bool]) -> Noises {
        self.noises_like(left, fit, None)
    }

    /// The noise that neighbouring rows show of what is left of them, by the median of their second differences, where it is
    /// less than `noises`.
    pub fn quiet(&self, left: &Column, fit: &[bool], noises: &Noises) -> Noises {
        let of = |(number, noise): (usize, &Noise)| match self.quiet_variance(number, left, fit) {
            Some(variance) if variance > 0.0 && variance < noise.sensor + noise.process => {
                Noise { sensor: variance, process: 0.0, persistence: 0.0, ..*noise }
            }
            _ => *noise,
        };
        let each = noises.each.iter().enumerate().map(of).collect();
        Noises { each, ..noises.clone() }
    }

    /// Variance of a row of a balance as the median of second differences shows it; none where there are no rows.
    fn quiet_variance(&self, number: usize, left: &Column, fit: &[bool]) -> Option<f64> {
        /// Rows that share no block lie so far apart.
        const APART: usize = 2;
        /// Variance of a second difference over that of a row.
        const SECOND: f64 = 6.0;
        let own = self.chunks.iter().zip(left);
        let own = own.filter(|(chunk, _)| chunk.balance == number && fit[chunk.run]);
        let differences: Vec<f64> = own
            .flat_map(|(chunk, left)| {
                let left = chunk.alike(left);
                let last = left.len().saturating_sub(2 * APART);
                let second = |row| left[row] - 2.0 * left[row + APART] + left[row + 2 * APART];
                (0..last).map(|row: usize| second(row).abs()).collect::<Vec<_>>()
            })
            .collect();
        (!differences.is_empty()).then(|| (NORMAL_OF_MEDIAN * median(&differences)).powi(2) / SECOND)
    }

    /// As [`System::noises`], of the kind that it was before.
    pub fn noises_like(&self, left: &Column, fit: &[bool], before: Option<&Noises>) -> Noises {
        let tails = before.and_then(|before| before.tails.as_ref());
        let of = |(number, kind): (usize, &Kind)| {
            let own = || {
                let all = self.chunks.iter().enumerate().zip(left);
                all.filter(|((_, chunk), _)| chunk.balance == number && fit[chunk.run])
            };
            let brief = before.is_some_and(|before| before.brief[number]);
            let most = if brief { 0.0 } else { (-self.blocks_s[number] / LASTING_S).exp() };
            let alike: Vec<Cow<DVector<f64>>> =
                own().map(|((_, chunk), values)| chunk.alike(values)).collect();
            let residuals: Vec<&DVector<f64>> = alike.iter().map(AsRef::as_ref).collect();
            let weights: Vec<Option<&DVector<f64>>> =
                own().map(|((index, _), _)| tails.map(|tails| tails.weights(index))).collect();
            let rows = Weighted { residuals: &residuals, weights: &weights };
            likeliest(&self.shapes_of(*kind), most, self.usual[number], rows)
        };
        let mut noises = Noises::normal(self.kinds.iter().enumerate().map(of).collect());
        if let Some(before) = before {
            noises.tails = tails.and_then(|_| Tails::of(&self.chunks, &noises, left));
            noises.brief.clone_from(&before.brief);
        }
        noises
    }

    /// ln of how likely the noise is from the start.
    pub fn prior(&self, noises: &Noises) -> f64 {
        noises.each.iter().zip(&self.usual).map(|(noise, usual)| noise.prior(*usual)).sum()
    }

    /// Mean square of a column over the runs that are `fit`, balance by balance.
    pub fn mean_squares(&self, column: &Column, fit: &[bool]) -> Vec<f64> {
        let of = |number: usize| {
            let (mut sum, mut count) = (0.0, 0usize);
            for (chunk, values) in self.chunks.iter().zip(column) {
                if chunk.balance == number && fit[chunk.run] {
                    sum += values.norm_squared();
                    count += values.len();
                }
            }
            sum / count.max(1) as f64
        };
        (0..self.kinds.len()).map(of).collect()
    }
}

/// Spectral density, at the low end, of what usually pulls at a vehicle and is no physics: gusts, a rough surface [N²s].
fn unsteady(kind: Kind, said: &[Said]) -> Option<f64> {
    /// Acceleration by it in the mean of one second [m/s²]: a gust of 1 m/s at 20 m/s does that to a car, and a ground whose
    /// resistance is uneven by a fiftieth to a tractor.
    const USUAL_M_S2: f64 = 0.01;
    if kind != Kind::Motion {
        return None;
    }
    let masses: Vec<f64> = said.iter().filter_map(Said::first_mass_kg).collect();
    (!masses.is_empty()).then(|| (USUAL_M_S2 * median(&masses)).powi(2))
}

/// The balances that the channels allow.
pub fn kinds(runs: &[Recorded], said: &[Said]) -> Vec<Kind> {
    let any =
        |test: &dyn Fn(&Recorded, &Said) -> bool| runs.iter().zip(said).any(|(run, said)| test(run, said));
    let has = |run: &Recorded, name: &str| run.measured.trace.get(name).is_some();
    Kind::ORDER
        .into_iter()
        .filter(|kind| match kind {
            Kind::Parity => any(&|run, _| has(run, "specific_force_m_s2")),
            Kind::Slip => any(&|run, _| has(run, "wheel_speed_m_s")),
            Kind::Motion => any(&|run, _| run.force_n.is_some()),
            Kind::Shaft => any(&|run, said| run.engine_w.is_some() && said.engine_w.is_some()),
            Kind::Battery => any(&|run, said| has(run, "battery_power_w") && said.battery_w.is_some()),
            Kind::Charge => any(&|run, said| run.charge_j.is_some() && said.charge.is_some()),
            Kind::Voltage => any(&|run, said| {
                let known = |name| has(run, name);
                known("battery_voltage_v") && known("battery_current_a") && said.resistance_ohm.is_some()
            }),
            Kind::Fuel => any(&|run, said| has(run, "fuel_rate_kg_s") && said.fuel_kg_s.is_some()),
        })
        .collect()
}

/// Which runs any of these balances can use.
pub fn bearing(kinds: &[Kind], runs: &[Recorded], said: &[Said]) -> Vec<bool> {
    let of_run = |(run, said): (&Recorded, &Said)| {
        kinds.iter().any(|kind| usable(*kind, run, said).into_iter().any(|usable| usable))
    };
    runs.iter().zip(said).map(of_run).collect()
}

/// Whether no force was measured, so that powers are made of nothing but motion.
fn is_of_motion(runs: &[Recorded]) -> bool {
    !runs.iter().any(Recorded::force_is_known)
}

/// Length of a block of a balance; of a power that is made of motion at least as long as the window over which its acceleration was
/// smoothed, so that the noise of the speed comes through as that of differences.
pub fn block_s(kind: Kind, runs: &[Recorded], rows: Rows) -> f64 {
    /// In a short run each step of the force that was smoothed over would count in many of so few rows.
    const FEWEST_ROWS: f64 = 50.0;
    let shortest_s = shortest_block_s(kind, runs, rows);
    if !kind.is_power() || !is_of_motion(runs) {
        return shortest_s;
    }
    let smoothed_s = runs.iter().map(|run| 2.0 * run.measured.how.smoothing_s).fold(shortest_s, f64::max);
    if median_duration_s(runs) < FEWEST_ROWS * smoothed_s { shortest_s } else { smoothed_s }
}

/// Length of a run in the middle of all [s].
fn median_duration_s(runs: &[Recorded]) -> f64 {
    let mut durations: Vec<f64> = runs.iter().map(|run| run.measured.trace.duration_s()).collect();
    durations.sort_by(f64::total_cmp);
    durations.get(durations.len() / 2).copied().unwrap_or(1.0)
}

/// Length of a block: short enough to see what happens, long enough to hold two samples.
pub fn shortest_block_s(kind: Kind, runs: &[Recorded], rows: Rows) -> f64 {
    let median = median_duration_s(runs);
    let period = kind.channels().iter().map(|name| longest_renewal_s(runs, name)).fold(0.0, f64::max);
    let whole: f64 = runs.iter().map(|run| run.measured.trace.duration_s()).sum();
    let most = match (rows, kind) {
        (_, Kind::Parity | Kind::Slip | Kind::Motion) => MOST_ROWS_OF_MOTION,
        (Rows::Few, _) => FEW_ROWS,
        (Rows::Many, _) => MOST_ROWS,
    };
    (median / ROWS_PER_RUN).max(0.04).min(1.0_f64.max(2.0 * period)).max(2.0 * period).max(whole / most)
}

/// Time from one renewal of a channel to the next in the slowest run [s].
pub fn longest_renewal_s(runs: &[Recorded], name: &str) -> f64 {
    runs.iter().map(|run| renewed_s(&run.measured.trace, name)).fold(0.0, f64::max)
}

fn usable(kind: Kind, run: &Recorded, said: &Said) -> Vec<bool> {
    let trace = &run.measured.trace;
    let channel = |name: &str| trace.get(name);
    let speed = channel("speed_m_s").unwrap_or(&[]);
    let braked = channel("brake");
    let stands_in = |i: usize| run.stands_in.get(i).copied().unwrap_or(false);
    // From one speed to the other is no change of motion.
    let joins = |i: usize| stands_in(i) != stands_in(i.saturating_sub(1));
    let overruns = if matches!(kind, Kind::Shaft | Kind::Fuel) { overruns(run, said) } else { Vec::new() };
    (0..trace.len())
        .map(|i| {
            let moving = run.motion.value[i].abs() > SLOWEST_M_S && speed[i].is_finite();
            let finite = |values: Option<&[f64]>| values.is_some_and(|values| values[i].is_finite());
            match kind {
                Kind::Motion => {
                    moving
                        && finite(run.force_n.as_deref())
                        && said.resistance_n[i].is_finite()
                        && run.measured.compared[i]
                        && braked.is_none_or(|brake| brake[i] < 0.5)
                        && !joins(i)
                }
                Kind::Parity => moving && finite(channel("specific_force_m_s2")) && !joins(i),
                Kind::Shaft => {
                    finite(run.engine_w.as_deref())
                        && finite(said.engine_w.as_deref())
                        && run.measured.compared[i]
                        && !overruns[i]
                }
                Kind::Charge => {
                    run.charge_j.is_some()
                        && finite(channel("state_of_charge"))
                        && finite(said.charge.as_deref())
                        && run.measured.compared[i]
                }
                Kind::Slip => {
                    moving
                        && !stands_in(i)
                        && finite(channel("wheel_speed_m_s"))
                        && finite(Some(&said.wheel_speed_m_s))
                }
                Kind::Battery => finite(channel("battery_power_w")) && finite(said.battery_w.as_deref()),
                Kind::Voltage => {
                    said.resistance_ohm.is_some()
                        && finite(channel("battery_voltage_v"))
                        && finite(channel("battery_current_a"))
                }
                Kind::Fuel => {
                    finite(channel("fuel_rate_kg_s"))
                        && finite(said.fuel_kg_s.as_deref())
                        && run.measured.compared[i]
                        && !overruns[i]
                }
            }
        })
        .collect()
}

fn residual(kind: Kind, run: &Recorded, said: &Said, chunk: &Chunk) -> DVector<f64> {
    let trace = &run.measured.trace;
    let time_s = trace.time_s();
    let zero = vec![0.0; trace.len()];
    let channel = |name: &str| trace.get(name).unwrap_or(&zero);
    let one = |row: &Row| match kind {
        Kind::Voltage => row.mean(&said.voltage_left_v),
        Kind::Motion => {
            let force = said.force_n.as_deref().or(run.force_n.as_deref()).unwrap_or(&zero);
            let slope = row.slope(time_s, channel("speed_m_s"));
            row.mean(force) - row.mean(&said.resistance_n) - row.mean(&said.effective_mass_kg) * slope
        }
        Kind::Parity => {
            let slope = row.slope(time_s, channel("speed_m_s"));
            row.mean(channel("specific_force_m_s2")) - slope - row.mean(&said.slope_m_s2)
        }
        Kind::Slip => row.mean(channel("wheel_speed_m_s")) - row.mean(&said.wheel_speed_m_s),
        Kind::Battery => {
            row.mean(channel("battery_power_w")) - row.mean(said.battery_w.as_deref().unwrap_or(&zero))
        }
        Kind::Shaft => {
            row.mean(run.engine_w.as_deref().unwrap_or(&zero))
                - row.mean(said.engine_w.as_deref().unwrap_or(&zero))
        }
        Kind::Charge => {
            let falls = |charge: &[f64]| -run.charge_j.unwrap_or(0.0) * row.slope(time_s, charge);
            falls(channel("state_of_charge")) - falls(said.charge.as_deref().unwrap_or(&zero))
        }
        Kind::Fuel => {
            FUEL_J_KG
                * (row.mean(channel("fuel_rate_kg_s")) - row.mean(said.fuel_kg_s.as_deref().unwrap_or(&zero)))
        }
    };
    DVector::from_iterator(chunk.rows.len(), chunk.rows.iter().map(one))
}

/// What a change of the model does to the residual, sample by sample: minus what the model says more.
pub fn change(kind: Kind, run: &Recorded, before: &Said, after: &Said) -> Vec<f64> {
    let minus = |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(one, other)| one - other).collect();
    let count = before.resistance_n.len();
    let less = |before: &Option<Vec<f64>>, after: &Option<Vec<f64>>| match (before, after) {
        (Some(before), Some(after)) => minus(before, after),
        _ => vec![0.0; count],
    };
    match kind {
        Kind::Motion => (0..count)
            .map(|i| {
                let force = |said: &Said| said.force_n.as_ref().map_or(0.0, |force| force[i]);
                force(after) - force(before) + before.resistance_n[i] - after.resistance_n[i]
                    + (before.effective_mass_kg[i] - after.effective_mass_kg[i]) * run.acceleration_m_s2[i]
            })
            .collect(),
        Kind::Parity => minus(&before.slope_m_s2, &after.slope_m_s2),
        Kind::Slip => minus(&before.wheel_speed_m_s, &after.wheel_speed_m_s),
        Kind::Battery => less(&before.battery_w, &after.battery_w),
        Kind::Shaft => less(&before.engine_w, &after.engine_w),
        Kind::Charge => less(&before.drawn_w(run), &after.drawn_w(run)),
        Kind::Voltage => match (before.resistance_ohm, after.resistance_ohm) {
            (Some(before), Some(after)) => change_v(run, after - before),
            _ => vec![0.0; count],
        },
        Kind::Fuel => match (&before.fuel_kg_s, &after.fuel_kg_s) {
            (Some(before), Some(after)) => {
                before.iter().zip(after).map(|(one, other)| FUEL_J_KG * (one - other)).collect()
            }
            _ => vec![0.0; count],
        },
    }
}
