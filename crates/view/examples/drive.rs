//! A tractor on a winding road over a hill, as a Rerun recording.
//!
//! `cargo run -p headland-view --example drive -- drive.rrd [alone|compared|study] [show]`
//!
//! The speed is a formula, the forces follow from it, and the recording is the same drive against a wind, with noise.

use headland_trace::{Origin, Run, Trace, TraceError};
use headland_units::constants::STANDARD_GRAVITY_M_S2;
use headland_view::{Axis, Body, ForceArrow, Scene, show, write};
use std::error::Error;
use std::f64::consts::TAU;
use std::path::PathBuf;

const MASS_KG: f64 = 13_020.0;
const ROLLING: f64 = 0.022;
const DRAG_KG_M: f64 = 5.1;
/// Period of the speed [s], length of the hill [m] and of the bends [m].
const PERIOD_S: f64 = 40.0;
const HILL_M: f64 = 160.0;
const BEND_M: f64 = 55.0;

const TRACTOR: Body = Body {
    length_m: 6.6,
    width_m: 3.0,
    height_m: 3.7,
    wheel_radius_m: 0.98,
    wheelbase_m: 3.6,
    track_m: 2.25,
};

const FORCES: [ForceArrow; 4] = [
    ForceArrow { channel: "tractive_force_n", label: "traction", axis: Axis::Forward },
    ForceArrow { channel: "grade_force_n", label: "grade", axis: Axis::Backward },
    ForceArrow { channel: "rolling_force_n", label: "rolling", axis: Axis::Backward },
    ForceArrow { channel: "air_force_n", label: "air", axis: Axis::Backward },
];

/// v(t) and its derivative, and what it adds up to.
fn motion(time_s: f64, mean_m_s: f64) -> [f64; 3] {
    let (rate, swing) = (TAU / PERIOD_S, 0.45 * mean_m_s);
    let (sine, cosine) = (rate * time_s).sin_cos();
    [mean_m_s - swing * cosine, swing * rate * sine, mean_m_s * time_s - swing / rate * sine]
}

fn push(
    trace: &mut Trace,
    name: &str,
    origin: Origin,
    value: impl Fn(usize) -> f64,
) -> Result<(), TraceError> {
    let values = (0..trace.len()).map(value).collect();
    trace.push(name, values, origin)
}

/// Where the road is: its bends have no closed form, so that they are added up in steps.
fn road(position_m: &[f64]) -> Vec<[f64; 4]> {
    let (mut east_m, mut north_m, mut before_m) = (0.0, 0.0, 0.0);
    let mut places = Vec::with_capacity(position_m.len());
    for position_m in position_m {
        let heading_rad = 1.1 + 0.7 * (position_m / BEND_M).sin();
        let step_m = position_m - before_m;
        before_m = *position_m;
        east_m += step_m * heading_rad.sin();
        north_m += step_m * heading_rad.cos();
        let elevation_m = 3.0 * (1.0 - (TAU * position_m / HILL_M).cos());
        places.push([east_m, north_m, elevation_m, heading_rad]);
    }
    places
}

fn drive(id: &str, mean_m_s: f64, wind: f64, noise: f64, origin: Origin) -> Result<Run, TraceError> {
    let mut trace = Trace::new((0..1601).map(|index| f64::from(index) * 0.05).collect())?;
    let times = trace.time_s().to_vec();
    let motions: Vec<[f64; 3]> = times.iter().map(|time_s| motion(*time_s, mean_m_s)).collect();
    // Against the wind the vehicle falls behind: v − w (1 − exp(−t / 20 s)).
    let lost = |index: usize| wind * (1.0 - (-times[index] / 20.0).exp());
    let behind_m = |index: usize| wind * (times[index] - 20.0 * (1.0 - (-times[index] / 20.0).exp()));
    // Many frequencies that share no period look like noise.
    let noise = |index: usize, seed: f64| {
        (1..8).map(|wave| (times[index] * (7.3 + 3.7 * seed * f64::from(wave).sqrt())).sin()).sum::<f64>()
            * noise
    };
    let position_m: Vec<f64> = (0..times.len()).map(|index| motions[index][2] - behind_m(index)).collect();
    let road = road(&position_m);
    push(&mut trace, "position_m", origin, |index| position_m[index])?;
    push(&mut trace, "speed_m_s", origin, |index| motions[index][0] - lost(index) + noise(index, 1.0))?;
    push(&mut trace, "heading_rad", origin, |index| road[index][3])?;
    push(&mut trace, "east_m", origin, |index| road[index][0])?;
    push(&mut trace, "north_m", origin, |index| road[index][1])?;
    push(&mut trace, "elevation_m", origin, |index| road[index][2])?;
    if origin == Origin::Measured {
        return Ok(Run { id: id.to_owned(), trace });
    }
    let weight_n = MASS_KG * STANDARD_GRAVITY_M_S2;
    let rise = |index: usize| 3.0 * TAU / HILL_M * (TAU * position_m[index] / HILL_M).sin();
    let grade_n = |index: usize| weight_n * rise(index).atan().sin();
    let rolling_n = |index: usize| weight_n * ROLLING * rise(index).atan().cos();
    let air_n = |index: usize| DRAG_KG_M * motions[index][0].powi(2);
    let tractive_n =
        |index: usize| MASS_KG * motions[index][1] + grade_n(index) + rolling_n(index) + air_n(index);
    push(&mut trace, "tractive_force_n", origin, tractive_n)?;
    push(&mut trace, "grade_force_n", origin, grade_n)?;
    push(&mut trace, "rolling_force_n", origin, rolling_n)?;
    push(&mut trace, "air_force_n", origin, air_n)?;
    push(&mut trace, "tractive_power_w", origin, |index| tractive_n(index) * motions[index][0])?;
    push(&mut trace, "rolling_power_w", origin, |index| rolling_n(index) * motions[index][0])?;
    push(&mut trace, "grade", origin, rise)?;
    Ok(Run { id: id.to_owned(), trace })
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let path = PathBuf::from(arguments.first().map_or("drive.rrd", String::as_str));
    let scenery = arguments.get(1).map_or("compared", String::as_str);
    let (title, runs, measured) = match scenery {
        "alone" => ("A winding road", vec![drive("hill", 6.0, 0.0, 0.0, Origin::Predicted)?], vec![]),
        "compared" => (
            "A winding road, measured against a wind",
            vec![drive("hill", 6.0, 0.0, 0.0, Origin::Predicted)?],
            vec![drive("hill", 6.0, 0.12, 0.02, Origin::Measured)?],
        ),
        "study" => {
            let mut runs = Vec::new();
            for (id, mean_m_s) in [("slow", 4.0), ("middle", 5.5), ("fast", 7.0)] {
                let mut run = drive(id, mean_m_s, 0.0, 0.0, Origin::Predicted)?;
                for channel in ["east_m", "north_m", "heading_rad"] {
                    run.trace.remove(channel);
                }
                runs.push(run);
            }
            ("Three speeds side by side", runs, vec![])
        }
        other => return Err(format!("found `{other}`, expected alone, compared or study").into()),
    };
    let scene = Scene {
        title,
        runs: &runs,
        measured: &measured,
        forces: &FORCES,
        vehicle: TRACTOR,
        ground: None,
        settings: &[],
    };
    write(&scene, &path)?;
    if arguments.get(2).is_some_and(|word| word == "show") {
        show(&path)?;
    }
    Ok(())
}
