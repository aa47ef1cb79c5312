//! What each run, and each pair of runs, says for itself.

use headland_calibrate::coastdown::CoastDown;
use headland_report::{Axis, Cell, Item, Section, Table};

/// The section.
pub fn runs(result: &CoastDown) -> Section {
    let run = |row: &headland_calibrate::coastdown::RunRow| {
        vec![
            Cell::from(row.run.clone()),
            Cell::from(row.path.clone().unwrap_or_default() + if row.reversed { " (back)" } else { "" }),
            (3.6 * row.initial_m_s).into(),
            row.duration_s.into(),
            row.apparent_resistance_n.into(),
            row.c_w.unwrap_or(f64::NAN).into(),
            row.c_w_apparent.unwrap_or(f64::NAN).into(),
            row.offset_in_sd.into(),
            row.rms_m_s.into(),
        ]
    };
    let table = Table {
        title: "Runs".to_owned(),
        columns: vec![
            Axis::new("run", ""),
            Axis::new("path", ""),
            Axis::new("from", "km/h"),
            Axis::new("duration", "s"),
            Axis::new("resistance", "N"),
            Axis::new("own c_w", ""),
            Axis::new("apparent c_w", ""),
            Axis::new("off", "σ"),
            Axis::new("RMS", "m/s"),
        ],
        rows: result.runs.iter().map(run).collect(),
    };
    let words = "Of each run alone: its c_w with grade and wind of the path taken out, and as if the path were level and \
                 calm; how far it lies off the pool; the root mean square of its residual.";
    let mut section = Section::new("Runs and pairs").words(words).with(table);
    if result.pairs.is_empty() {
        return section.with(Item::Words(
            "No two runs drove the same path in opposite directions, so that grade, wind and rolling resistance are not \
             separated."
                .to_owned(),
        ));
    }
    let pair = |row: &headland_calibrate::coastdown::PairRow| {
        vec![
            Cell::from(format!("{} and {}", row.forward, row.reversed)),
            row.resistance_n.into(),
            row.asymmetry_n.into(),
            (100.0 * row.as_grade).into(),
            row.as_headwind_m_s.unwrap_or(f64::NAN).into(),
            row.c_w.unwrap_or(f64::NAN).into(),
        ]
    };
    section = section.with(Table {
        title: "Pairs in opposite directions".to_owned(),
        columns: vec![
            Axis::new("runs", ""),
            Axis::new("resistance", "N"),
            Axis::new("difference by direction", "N"),
            Axis::new("read as grade", "%"),
            Axis::new("read as head wind", "m/s"),
            Axis::new("c_w", ""),
        ],
        rows: result.pairs.iter().map(pair).collect(),
    });
    section
}
