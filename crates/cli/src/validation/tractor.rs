//! The tractor at field work: fuel by torque and speed of its engine, pass by pass.
//!
//! ṁ = k_0 ω + k_1 τ ω        τ torque as a share of the reference torque
//!
//! Source: the line of Willans, as in Guzzella and Onder (2010), section 2.5.

use super::table::{percent, table};
use crate::failure::Failure;
use crate::held;
use crate::page::short;
use crate::say::Say;
use headland_calibrate::statistics::mean;
use headland_recording::Recording;
use headland_trace::Trace;
use std::fmt::Write;
use std::ops::Range;
use std::path::Path;

/// What the controller says of its own fuel rate, from literature: Marx and others, Nebraska tests.
const SENSOR: f64 = 0.05;
/// A pass works at no less than these for so long, without a gap.
const LEAST_TORQUE: f64 = 0.25;
const LEAST_SPEED_M_S: f64 = 0.5;
const LEAST_ENGINE_RAD_S: f64 = 120.0;
const LEAST_TIME_S: f64 = 20.0;
const LONGEST_GAP_S: f64 = 2.0;

/// The channels that are looked at.
struct Log<'a> {
    time_s: &'a [f64],
    speed_m_s: &'a [f64],
    engine_rad_s: &'a [f64],
    torque: &'a [f64],
    friction: &'a [f64],
    fuel_kg_s: &'a [f64],
}

impl<'a> Log<'a> {
    fn of(trace: &'a Trace, path: &Path) -> Result<Self, Failure> {
        let column = |name: &str| {
            trace.get(name).ok_or_else(|| Failure::Input(format!("{}: no channel `{name}`", path.display())))
        };
        Ok(Self {
            time_s: trace.time_s(),
            speed_m_s: column("wheel_speed_m_s")?,
            engine_rad_s: column("engine_speed_rad_s")?,
            torque: column("actual_torque")?,
            friction: column("friction_torque")?,
            fuel_kg_s: column("fuel_rate_kg_s")?,
        })
    }

    fn works(&self, at: usize) -> bool {
        self.speed_m_s[at] >= LEAST_SPEED_M_S
            && self.engine_rad_s[at] >= LEAST_ENGINE_RAD_S
            && self.torque[at] - self.friction[at] >= LEAST_TORQUE
            && self.fuel_kg_s[at].is_finite()
    }

    /// Stretches of work.
    fn passes(&self) -> Vec<Range<usize>> {
        let mut passes = Vec::new();
        let mut start = None;
        for at in 0..=self.time_s.len() {
            let goes_on = at < self.time_s.len()
                && self.works(at)
                && (at == 0 || self.time_s[at] - self.time_s[at - 1] <= LONGEST_GAP_S);
            match (start, goes_on) {
                (None, true) => start = Some(at),
                (Some(from), false) => {
                    if self.time_s[at - 1] - self.time_s[from] >= LEAST_TIME_S {
                        passes.push(from..at);
                    }
                    // A gap ends one stretch and begins another.
                    start = (at < self.time_s.len() && self.works(at)).then_some(at);
                }
                _ => {}
            }
        }
        passes
    }

    /// k_0 and k_1 by least squares over some stretches.
    fn line<'b>(&self, over: impl Iterator<Item = &'b Range<usize>>) -> [f64; 2] {
        let [mut aa, mut ab, mut bb, mut af, mut bf] = [0.0; 5];
        for at in over.flat_map(Clone::clone) {
            let (a, f) = (self.engine_rad_s[at], self.fuel_kg_s[at]);
            let b = self.torque[at] * a;
            aa += a * a;
            ab += a * b;
            bb += b * b;
            af += a * f;
            bf += b * f;
        }
        let determinant = aa * bb - ab * ab;
        [(af * bb - bf * ab) / determinant, (bf * aa - af * ab) / determinant]
    }

    /// Measured and modelled fuel over some samples [kg]; each stands for the time to the next.
    fn fuel_kg(&self, [k0, k1]: [f64; 2], over: impl Iterator<Item = usize>) -> (f64, f64) {
        over.filter(|at| *at + 1 < self.time_s.len()).fold((0.0, 0.0), |(measured, modelled), at| {
            let step = self.time_s[at + 1] - self.time_s[at];
            let engine = self.engine_rad_s[at];
            (measured + step * self.fuel_kg_s[at], modelled + step * (k0 + k1 * self.torque[at]) * engine)
        })
    }
}

/// The part of the page.
pub fn part(scenarios: &Path, say: Say) -> Result<String, Failure> {
    let path = scenarios.join("recordings/tractor_t7165.ron");
    let recording = held::read_recording(&path, say)?;
    let Some(run) = recording.runs.first() else {
        return Err(Failure::Input(format!("{}: no runs", path.display())));
    };
    let log = Log::of(&run.trace, &path)?;
    let passes = log.passes();
    if passes.len() < 4 {
        let found = passes.len();
        return Err(Failure::Input(format!("{}: {found} passes, expected 4 or more", path.display())));
    }
    Ok(told(&recording, &log, &passes))
}

fn told(recording: &Recording, log: &Log, passes: &[Range<usize>]) -> String {
    let line = log.line(passes.iter().step_by(2));
    let mut text = format!("## {}\n\n", recording.about);
    let _ = writeln!(
        text,
        "A pass is {LEAST_TIME_S} s or more of work: wheels at {LEAST_SPEED_M_S} m/s or more, engine at {LEAST_ENGINE_RAD_S} rad/s or \
         more, {} % or more of its reference torque beyond friction. Of {} passes every other one calibrates the line of \
         Willans, ṁ = k₀ ω + k₁ τ ω, with τ the torque as a share of the reference torque, which the log does not know: k₀ = {} \
         mg/rad, k₁ = {} mg/rad. The others are held out.\n",
        short(100.0 * LEAST_TORQUE),
        passes.len(),
        short(1e6 * line[0]),
        short(1e6 * line[1])
    );
    let mut errors = Vec::new();
    let mut rows = Vec::new();
    for (number, pass) in passes.iter().enumerate() {
        let (measured, modelled) = log.fuel_kg(line, pass.clone());
        let error = modelled / measured - 1.0;
        let held_out = number % 2 == 1;
        if held_out {
            errors.push(error);
        }
        rows.push(vec![
            format!("{}{}", number + 1, if held_out { " (held out)" } else { "" }),
            short(log.time_s[pass.end - 1] - log.time_s[pass.start]),
            short(3.6 * mean(&log.speed_m_s[pass.clone()])),
            short(100.0 * mean(&log.torque[pass.clone()])),
            short(measured),
            short(modelled),
            percent(Some(error)),
        ]);
    }
    let columns =
        ["pass", "time s", "speed km/h", "torque %", "fuel measured kg", "fuel modelled kg", "error %"];
    text += &table(&columns, &rows);
    text += &verdict(log, passes, line, &errors);
    for notice in recording.notices.iter().filter(|notice| notice.run.is_empty()) {
        let _ = writeln!(text, "- {}", notice.text);
    }
    text
}

fn verdict(log: &Log, passes: &[Range<usize>], line: [f64; 2], errors: &[f64]) -> String {
    let within = errors.iter().filter(|error| error.abs() <= SENSOR).count();
    let rms = mean(&errors.iter().map(|error| error * error).collect::<Vec<_>>()).sqrt();
    let most = errors.iter().fold(0.0, |most: f64, error| most.max(error.abs()));
    let sum = |over: &mut dyn Iterator<Item = usize>, line| {
        let (measured, modelled) = log.fuel_kg(line, over);
        percent(Some(modelled / measured - 1.0))
    };
    let half = passes.len() / 2;
    let early = log.line(passes[..half].iter());
    let works = |at: &usize| passes.iter().any(|pass| pass.contains(at));
    let mut text = format!(
        "\n**Held out: {within} of {} passes within the ±{} % that is said of such a sensor**; mean error {} %, root of the mean \
         square {} %, at most {} %.\n\n",
        errors.len(),
        short(100.0 * SENSOR),
        percent(Some(mean(errors))),
        short(100.0 * rms),
        short(100.0 * most)
    );
    let _ = writeln!(
        text,
        "- calibrated on the first {half} passes instead, the fuel of the later ones together is off by {} %",
        sum(&mut passes[half..].iter().flat_map(Clone::clone), early)
    );
    let others = |at: &usize| !works(at) && log.engine_rad_s[*at] > 0.0 && log.fuel_kg_s[*at].is_finite();
    let _ = writeln!(
        text,
        "- outside of the passes (turns, road, idling), which calibrated nothing, by {} % together",
        sum(&mut (0..log.time_s.len()).filter(others), line)
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 100 s: 30 s of work, 10 s of turning, 30 s of work, a gap of 5 s, then 20 s.
    fn columns() -> [Vec<f64>; 6] {
        let time: Vec<f64> = (0..95).map(|i| f64::from(i) + if i >= 70 { 5.0 } else { 0.0 }).collect();
        let torque: Vec<f64> = (0..95)
            .map(|i| if (30..40).contains(&i) { 0.1 } else { 0.5 + 0.01 * f64::from(i % 7) })
            .collect();
        let engine: Vec<f64> = (0..95).map(|i| 200.0 + f64::from(i % 5)).collect();
        let fuel =
            torque.iter().zip(&engine).map(|(torque, engine)| (4e-7 + 3.7e-5 * torque) * engine).collect();
        [time, vec![2.0; 95], engine, torque, vec![0.06; 95], fuel]
    }

    fn log(columns: &[Vec<f64>; 6]) -> Log<'_> {
        let [time_s, speed_m_s, engine_rad_s, torque, friction, fuel_kg_s] = columns;
        Log { time_s, speed_m_s, engine_rad_s, torque, friction, fuel_kg_s }
    }

    #[test]
    fn turns_and_gaps_part_the_passes() {
        assert_eq!(log(&columns()).passes(), [0..30, 40..70, 70..95]);
    }

    #[test]
    fn a_line_is_found_again_and_fuel_is_its_sum() {
        let columns = columns();
        let log = log(&columns);
        let line = log.line(log.passes().iter().step_by(2));
        assert!((line[0] / 4e-7 - 1.0).abs() < 1e-9 && (line[1] / 3.7e-5 - 1.0).abs() < 1e-9, "{line:?}");
        let (measured, modelled) = log.fuel_kg(line, 0..30);
        assert!((measured - columns[5][..30].iter().sum::<f64>()).abs() < 1e-12);
        assert!((modelled / measured - 1.0).abs() < 1e-9);
    }
}
