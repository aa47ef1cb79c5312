//! A case as files.

pub(crate) mod faults;
mod oracle;

use crate::case::Case;
use crate::error::ConcealError;
use crate::plan::Plan;
use headland_trace::{Run, write_parquet};
use std::fmt::Write;
use std::fs;
use std::path::Path;

pub(crate) use oracle::oracle;

pub(crate) fn case(case: &Case, folder: &Path) -> Result<(), ConcealError> {
    fs::create_dir_all(folder).map_err(|source| ConcealError::File { path: folder.to_owned(), source })?;
    put(&folder.join("scenario.ron"), &scenario(&case.plan, case.truth.case, None))?;
    if let Some(effects) = &case.truth.oracle {
        put(&folder.join("oracle.ron"), &scenario(&case.plan, case.truth.case, Some(effects)))?;
    }
    put(&folder.join("recording.ron"), &recording(case))?;
    for log in &case.logs {
        put(&folder.join(format!("{}.csv", log.id)), &table(&case.plan, log))?;
    }
    write_parquet(&folder.join("truth.parquet"), &case.along)?;
    let path = folder.join("truth.json");
    let text = serde_json::to_string_pretty(&case.truth)
        .map_err(|source| ConcealError::Json { path: path.clone(), source })?;
    // Last, so that a folder with it is whole.
    put(&path, &text)
}

pub(crate) fn put(path: &Path, text: &str) -> Result<(), ConcealError> {
    fs::write(path, text).map_err(|source| ConcealError::File { path: path.to_owned(), source })
}

/// The nominal scenario: no effects, parameters wrong within what `free` states; or, with effects, the true one.
fn scenario(plan: &Plan, case: usize, effects: Option<&str>) -> String {
    let fill = |text: &str| {
        plan.nominal.priors.iter().fold(text.to_owned(), |text, prior| {
            let value = if effects.is_some() { prior.truth } else { prior.nominal };
            text.replace(&format!("{{{}}}", prior.path), &format!("{value:?}"))
        })
    };
    let mut text = String::from("(\n");
    let _ = writeln!(text, "    about: \"{}, set {case}\",", plan.about);
    let _ = writeln!(text, "    vehicle: {},", fill(&plan.nominal.vehicle));
    let _ = writeln!(
        text,
        "    ground: (terrain: Flat(heading_rad: {:.4}), soil: {}),",
        plan.course.heading_rad,
        fill(&plan.nominal.soil)
    );
    let _ = writeln!(text, "    air: (density_kg_m3: {:?}),", plan.vehicle.air_density_kg_m3);
    let _ = writeln!(text, "    gravity_m_s2: {:?},", plan.vehicle.gravity_m_s2);
    if let Some(effects) = effects {
        let _ = writeln!(text, "    effects: [{effects}],");
    }
    text.push_str("    free: [\n");
    for prior in plan.nominal.priors.iter().filter(|prior| prior.free) {
        let (low, high) = prior.bounds;
        let _ = writeln!(
            text,
            "        (name: \"{}\", sd: {:?}, bounds: ({low:?}, {high:?})),",
            prior.path, prior.sd
        );
    }
    text.push_str("    ],\n");
    let _ = writeln!(text, "    replay: (smoothing_s: {:?}),", plan.nominal.smoothing_s);
    text.push_str("    simulation: (fidelity: Longitudinal, step_s: 0.02),\n)\n");
    text
}

fn recording(case: &Case) -> String {
    let plan = &case.plan;
    let mass = plan.nominal.priors.iter().find(|prior| prior.path == "vehicle.mass_kg");
    let ballast = plan.runs.iter().any(|run| run.ballast_kg != 0.0);
    let mut text = String::from("(\n");
    let _ = writeln!(text, "    about: \"{}\",\n    runs: [", plan.about);
    for run in &plan.runs {
        let _ = write!(text, "        (id: \"{0}\", file: \"{0}.csv\"", run.id);
        if plan.paths_told {
            let lane = ["lane", "other lane"][run.lane.min(1)];
            let _ = write!(text, ", path: \"{lane}\"");
        }
        if run.reversed {
            text.push_str(", reversed: true");
        }
        if run.held_out && plan.held_out_told {
            text.push_str(", use: held_out");
        }
        if let (Some(mass), true) = (mass, ballast) {
            let value = mass.nominal + run.ballast_kg;
            let _ = write!(text, ", known: [(name: \"mass_kg\", value: {value:?}, sd: {:?})]", mass.sd);
        }
        text.push_str("),\n");
    }
    text.push_str("    ],\n    channels: [\n");
    for channel in plan.channels.iter().filter(|channel| channel.sensor.white > 0.0) {
        let noise = channel.sensor.white.hypot(channel.sensor.drift);
        let _ = writeln!(
            text,
            "        (column: \"{0}\", is: \"{0}\", sensor: (noise: {noise:.3e})),",
            channel.name
        );
    }
    text.push_str("    ],\n)\n");
    text
}

fn table(plan: &Plan, log: &Run) -> String {
    let mut text = String::from("time_s");
    for channel in log.trace.channels() {
        text.push(',');
        text.push_str(&channel.name);
    }
    text.push('\n');
    for (row, time_s) in log.trace.time_s().iter().enumerate() {
        let _ = write!(text, "{time_s:.3}");
        for (channel, spec) in log.trace.channels().iter().zip(&plan.channels) {
            let value = channel.values[row];
            if value.is_finite() {
                let _ = write!(text, ",{value:.*}", spec.decimals);
            } else {
                text.push(',');
            }
        }
        text.push('\n');
    }
    text
}
