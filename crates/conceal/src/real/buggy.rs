//! Off-road buggy: two- and four-wheel drive do not differ in its coast-downs.

use super::pose::{diagnose, write};
use super::signal::{blocks, mean, short, spread};
use super::table::Table;
use super::{Figure, Options, Row};
use crate::error::ConcealError;
use std::fmt::Write;

const SET: &str = "baja_coastdown";
/// Rolling radius at which wheel speed and accelerometer agree [m].
const RADIUS_M: f64 = 0.27;
/// Means over so long are given [s].
const STEP_S: f64 = 0.05;
/// Slower than this it no longer rolls out [m/s].
const SLOWEST_M_S: f64 = 1.5;

pub fn rows(options: &Options) -> Result<Vec<Row>, ConcealError> {
    /// 97.5 % quantile of Student's t with three degrees of freedom: five runs, two means.
    const T: f64 = 3.182;
    let names: Vec<String> = ["1", "2", "3", "2WD-1", "2WD-2", "2WD-3", "4WD-1", "4WD-2"]
        .iter()
        .map(|name| format!("RR-Coastdown-{name}"))
        .collect();
    let mut runs = String::new();
    for name in &names {
        write(options, SET, &format!("{name}.csv"), &coasting(options, name)?)?;
        let _ = writeln!(runs, "(id: {name:?}, file: {:?}),", format!("{name}.csv"));
    }
    let recording = format!(
        "(about: \"buggy, eight coast-downs\", runs: [{runs}], known: [(name: \"mass_kg\", value: 250.0, sd: 10.0)])"
    );
    let recording = write(options, SET, "recording.ron", &recording)?;
    let scenario = write(options, SET, "scenario.ron", include_str!("poses/buggy.ron"))?;
    let said = diagnose(options, SET, &scenario, &recording, &[])?;
    let concealed = "nothing: runs in two- and in four-wheel drive that do not separate";
    let mut row = said.row(SET, concealed);
    let total = |name: &String| -> Option<f64> {
        let run = said.effects.iter().find(|run| run.id == *name)?;
        let effects = run.trace.channels().iter().filter(|channel| channel.name.ends_with("_n"));
        let means: Vec<f64> = effects
            .map(|channel| {
                let known: Vec<f64> =
                    channel.values.iter().copied().filter(|value| value.is_finite()).collect();
                known.iter().sum::<f64>() / known.len().max(1) as f64
            })
            .collect();
        (!means.is_empty()).then(|| means.iter().sum())
    };
    let group = |mark: &str| -> Vec<f64> {
        names.iter().filter(|name| name.contains(mark)).filter_map(total).collect()
    };
    let (two, four) = (group("2WD"), group("4WD"));
    let average = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let difference = average(&four) - average(&two);
    let scatter =
        (spread(&two).powi(2) / two.len() as f64 + spread(&four).powi(2) / four.len() as f64).sqrt();
    let differ = difference.abs() > T * scatter;
    let value = if two.is_empty() || four.is_empty() {
        "no effect that differs between runs".to_owned()
    } else {
        format!("{} ± {} N", short(difference), short(T * scatter))
    };
    row.figures.push(Figure::goal(
        "what was found makes two- and four-wheel drive differ by",
        value,
        "no difference",
        said.diagnosis.is_some() && !differ,
    ));
    Ok(vec![row])
}

/// The stretch of a log that rolls out: from the greatest speed until it stands, as means over 50 ms.
fn coasting(options: &Options, name: &str) -> Result<String, ConcealError> {
    let path = options.recordings.join(SET).join(format!("given/{name}.csv.gz"));
    let log = Table::read(&path)?;
    let time_s = log.need(&path, "Time")?;
    let to_m_s = RADIUS_M * std::f64::consts::TAU / 60.0;
    let speed_m_s: Vec<f64> = log.need(&path, "RR_Wheel,Speed")?.iter().map(|rpm| rpm * to_m_s).collect();
    let means: Vec<(f64, f64)> =
        blocks(&time_s, STEP_S).iter().map(|block| (mean(&time_s, block), mean(&speed_m_s, block))).collect();
    // Half a second behind the top the throttle is surely closed.
    let top = (0..means.len()).max_by(|one, other| means[*one].1.total_cmp(&means[*other].1)).unwrap_or(0);
    let from = (top + 10).min(means.len());
    let mut text = "time_s,speed_m_s,coasting\n".to_owned();
    for (time, speed) in means[from..].iter().take_while(|(_, speed)| *speed > SLOWEST_M_S) {
        let _ = writeln!(text, "{time:.4},{speed:.5},1");
    }
    Ok(text)
}
