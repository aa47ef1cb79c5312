//! The aggregation of the reference study.

use crate::command::coastdown::Analysis;
use headland_calibrate::coastdown::TwoStage;
use headland_report::{Axis, Cell, Cumulative, Plot, Section, Steps, Table};

/// The section.
pub fn two_stage(two: &TwoStage, analysis: &Analysis) -> Section {
    let run = |one: &headland_calibrate::coastdown::RunCoefficient| {
        vec![
            Cell::from(one.run.clone()),
            Cell::Number(one.samples as f64),
            Cell::Number(one.kept as f64),
            one.median.into(),
            one.mean.into(),
            one.weight.into(),
            Cell::from(if one.outlier { "outlier" } else { "" }),
        ]
    };
    let runs = Table {
        title: "First stage: samples to runs".to_owned(),
        columns: ["run", "samples", "within 5 to 95 %", "median", "mean", "weight", ""]
            .map(|name| Axis::new(name, ""))
            .to_vec(),
        rows: two.runs.iter().map(run).collect(),
    };
    let mut rows = Vec::new();
    let with_rotating = analysis.result().two_stage_with_rotating_mass.as_ref();
    for (mass, two) in [("as published", Some(two)), ("with rotating mass", with_rotating)] {
        let Some(two) = two else { continue };
        for (what, pool) in [("without outliers", &two.kept), ("all runs", &two.all)] {
            rows.push(vec![
                Cell::from(format!("{mass}, {what}")),
                pool.by_samples.into(),
                pool.by_runs.into(),
                pool.by_medians.into(),
            ]);
        }
    }
    let pools = Table {
        title: "Second stage: runs to one coefficient".to_owned(),
        columns: ["pool", "by samples", "by run means", "by run medians"]
            .map(|name| Axis::new(name, ""))
            .to_vec(),
        rows,
    };
    let words = "A coefficient a sample from differentiated speed, a median a run, a pool of the runs that are no \
                 outliers. The study leaves open whether samples or runs are pooled, so both stand here.";
    Section::new("The two-stage method")
        .words(words)
        .with(pools)
        .with(runs)
        .with(distribution(&analysis.samples))
}

fn distribution(samples: &[(String, Vec<f64>)]) -> Plot {
    let steps = samples
        .iter()
        .map(|(run, values)| {
            let mut x: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
            x.sort_by(f64::total_cmp);
            // The outermost samples are what differentiation makes of noise; they would squeeze the rest.
            let outer = x.len() / 20;
            let all = x.len() as f64;
            let probability = (outer..x.len() - outer).map(|rank| (rank + 1) as f64 / all).collect();
            Steps { name: run.clone(), x: x[outer..x.len() - outer].to_vec(), probability, band: None }
        })
        .collect();
    let cumulative = Cumulative { axis: Axis::new("c_w of a sample", ""), steps };
    Plot::new("Cumulative probability of the coefficient of a sample", cumulative)
        .words("Between the 5th and the 95th percentile, which is what the method keeps.")
}
