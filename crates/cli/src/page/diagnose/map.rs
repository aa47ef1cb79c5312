//! Where the mismatch sits: heat maps of runs by position, and the stretches that stand out.

use headland_diagnose::{Diagnosed, LeftOver, Mismatch, Over};
use headland_report::{Axis, Cell, Heat, Item, Line, Lines, Plot, Section, Series, Table};

/// Columns of a heat map.
const COLUMNS: usize = 24;
/// Rows of the table of stretches, along each axis.
const PER_AXIS: usize = 6;
/// Means that are drawn along a run.
const SMOOTHED: usize = 40;
/// Runs that get plots of their own.
const IN_DETAIL: usize = 4;

/// One section for each balance.
pub fn map(found: &Diagnosed) -> Vec<Section> {
    let mut kinds: Vec<_> = found.residuals.iter().map(|left| left.balance).collect();
    kinds.dedup();
    kinds
        .into_iter()
        .map(|kind| {
            let left: Vec<&LeftOver> =
                found.residuals.iter().filter(|left| left.balance == kind && !left.time_s.is_empty()).collect();
            let first = found.diagnosis.first_balance == Some(kind);
            let words = format!(
                "Measured minus modelled, in {}: with the free parameters alone (before) and with everything that was found \
                 (after).{}",
                kind.unit(),
                if first { " This is the first balance that does not close." } else { "" }
            );
            let mut section = Section::new(format!("Where the {} balance does not close", kind.name())).words(words);
            for plot in heats(kind.unit(), &left) {
                section = section.with(plot);
            }
            let stands = |stage: &str, all: &[Mismatch]| {
                let own: Vec<&Mismatch> = all.iter().filter(|one| one.balance == kind).collect();
                (!own.is_empty()).then(|| table(stage, &own))
            };
            match stands("before", &found.diagnosis.mismatch) {
                Some(table) => section = section.with(table),
                None => section = section.with(Item::Words("Nothing stands out of the noise.".to_owned())),
            }
            if let Some(table) = stands("after", &found.diagnosis.mismatch_left) {
                section = section.with(table);
            }
            for left in detailed(&left) {
                section = section.with(along_time(kind, left));
            }
            section
        })
        .collect()
}

/// Runs that were held out first.
fn detailed<'a>(left: &[&'a LeftOver]) -> Vec<&'a LeftOver> {
    let (held, fitted): (Vec<&LeftOver>, Vec<&LeftOver>) = left.iter().partition(|left| left.held_out);
    held.into_iter().chain(fitted).take(IN_DETAIL).collect()
}

fn along_time(kind: headland_diagnose::Kind, left: &LeftOver) -> Plot {
    let half = left.time_s.len() / (2 * SMOOTHED);
    let series = vec![
        Series::new("before", left.time_s.clone(), smoothed(&left.before, half)).drawn(Line::Dashed),
        Series::new("after", left.time_s.clone(), smoothed(&left.after, half)),
    ];
    let step_s = (left.time_s.last().unwrap_or(&0.0) - left.time_s.first().unwrap_or(&0.0))
        / left.time_s.len().max(2) as f64;
    let words = format!("Running mean over {:.1} s.", (2 * half + 1) as f64 * step_s);
    let axis = Axis::new(format!("left over in the {} balance", kind.name()), kind.unit());
    let seen = if left.held_out { " (held out)" } else { "" };
    Plot::new(
        format!("{}{seen}: {} over time", super::super::titled(&left.run), kind.name()),
        Lines::over_time(axis, series),
    )
    .words(words)
}

/// The mean of so many values on both sides: what differences of noisy speeds leave over cannot be seen row by row.
fn smoothed(values: &[f64], half: usize) -> Vec<f64> {
    (0..values.len())
        .map(|index| {
            let near = &values[index.saturating_sub(half)..(index + half + 1).min(values.len())];
            near.iter().sum::<f64>() / near.len() as f64
        })
        .collect()
}

/// Runs by position, before and after, with the same scale of colours.
fn heats(unit: &str, left: &[&LeftOver]) -> Vec<Plot> {
    let positions = left.iter().flat_map(|left| left.position_m.iter().copied()).filter(|at| at.is_finite());
    let (low, high) =
        positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    if left.len() < 2 || high - low < 1.0 {
        return Vec::new();
    }
    let width = (high - low) / COLUMNS as f64;
    let columns: Vec<String> =
        (0..COLUMNS).map(|column| format!("{:.0} m", low + width * (column as f64 + 0.5))).collect();
    let rows: Vec<String> = left
        .iter()
        .map(|left| {
            let way = if left.reversed { " ←" } else { "" };
            let held = if left.held_out { " (held out)" } else { "" };
            format!("{}{way}{held}", left.run)
        })
        .collect();
    let values = |of: fn(&LeftOver) -> &[f64]| -> Vec<Vec<f64>> {
        left.iter().map(|left| means(left, of(left), low, width)).collect()
    };
    let (before, after) = (values(|left| &left.before), values(|left| &left.after));
    let mut sizes: Vec<f64> =
        before.iter().flatten().map(|value| value.abs()).filter(|value| value.is_finite()).collect();
    sizes.sort_by(f64::total_cmp);
    // A few wild cells must not bleach all others.
    let limit = sizes
        .get(sizes.len().saturating_sub(1 + sizes.len() / 50))
        .copied()
        .unwrap_or(1.0)
        .max(f64::MIN_POSITIVE);
    [("before", before), ("after", after)]
        .into_iter()
        .map(|(stage, values)| {
            let heat = Heat {
                axis: Axis::new("measured minus modelled", unit),
                columns: columns.clone(),
                rows: rows.clone(),
                values,
                limit,
            };
            Plot::new(format!("Runs by position, {stage}"), heat)
                .words("Means over the position along the path; ← marks runs against it.")
        })
        .collect()
}

fn means(left: &LeftOver, values: &[f64], low: f64, width: f64) -> Vec<f64> {
    let mut sums = vec![(0.0, 0usize); COLUMNS];
    for (at, value) in left.position_m.iter().zip(values) {
        if at.is_finite() && value.is_finite() {
            // Between 0 and the number of columns.
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a column of the map"
            )]
            let column = (((at - low) / width).max(0.0) as usize).min(COLUMNS - 1);
            sums[column].0 += value;
            sums[column].1 += 1;
        }
    }
    sums.into_iter().map(|(sum, count)| if count == 0 { f64::NAN } else { sum / count as f64 }).collect()
}

/// What stands out most comes first: all along the same axis together, and what single runs show behind it.
fn strongest<'a>(all: &[&'a Mismatch]) -> Vec<&'a Mismatch> {
    let most =
        |over: Over| all.iter().filter(|one| one.over == over).map(|one| one.sigma.abs()).fold(0.0, f64::max);
    let mut axes: Vec<(Over, f64)> =
        [Over::Position, Over::Speed, Over::Direction, Over::Temperature, Over::Time]
            .map(|over| (over, most(over)))
            .to_vec();
    axes.sort_by(|one, other| {
        (one.0 == Over::Time).cmp(&(other.0 == Over::Time)).then(other.1.total_cmp(&one.1))
    });
    let mut shown = Vec::new();
    for (over, _) in axes {
        let mut own: Vec<&Mismatch> = all.iter().filter(|one| one.over == over).copied().collect();
        own.sort_by(|one, other| other.sigma.abs().total_cmp(&one.sigma.abs()));
        shown.extend(own.into_iter().take(PER_AXIS));
    }
    shown
}

fn table(stage: &str, own: &[&Mismatch]) -> Table {
    let all = own.len();
    let own = strongest(own);
    let unit = own.first().map_or("", |one| one.unit_of_mean);
    let row = |one: &&Mismatch| {
        let (over, from, to) = match one.over {
            Over::Time => ("time [s]", format!("{:.1}", one.from), format!("{:.1}", one.to)),
            Over::Position => ("position [m]", format!("{:.0}", one.from), format!("{:.0}", one.to)),
            Over::Speed => ("speed [m/s]", format!("{:.2}", one.from), format!("{:.2}", one.to)),
            Over::Temperature => ("temperature [°C]", format!("{:.1}", one.from), format!("{:.1}", one.to)),
            Over::Direction => {
                let way = |value: f64| if value < 0.5 { "along" } else { "against" }.to_owned();
                ("direction", way(one.from), way(one.to))
            }
        };
        let place = one.run.clone().or(one.path.clone()).unwrap_or_else(|| "all fitted runs".to_owned());
        vec![
            Cell::from(over),
            Cell::from(place),
            Cell::from(from),
            Cell::from(to),
            Cell::Interval {
                value: one.mean,
                lower: one.mean - 1.96 * one.sd,
                upper: one.mean + 1.96 * one.sd,
            },
            Cell::from(format!("{:.0}", one.sigma.abs())),
        ]
    };
    let rest =
        if own.len() < all { format!(" (the strongest {} of {all})", own.len()) } else { String::new() };
    Table {
        title: format!("Stretches that stand out of the noise, {stage}{rest}"),
        columns: vec![
            Axis::new("over", ""),
            Axis::new("in", ""),
            Axis::new("from", ""),
            Axis::new("to", ""),
            Axis::new("mean, 95 % interval", unit),
            Axis::new("standard deviations", ""),
        ],
        rows: own.iter().map(row).collect(),
    }
}
