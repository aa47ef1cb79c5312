//! Before and after: figures, and the signal itself in runs that were never fitted.

use super::verdict;
use headland_diagnose::{Diagnosed, Shown};
use headland_report::{Axis, Figure, Item, Line, Lines, Plot, Section, Series};

/// Runs that get plots.
const IN_DETAIL: usize = 4;

/// The section.
pub fn proof(found: &Diagnosed) -> Section {
    let fit = &found.diagnosis.fit;
    let unit = Axis::of(&fit.signal).unit;
    let signal = Axis::of(&fit.signal).label;
    let mut figures = vec![Figure::text("Verdict", verdict(found.diagnosis.verdict))];
    let mut figure = |name: &str, value: f64| {
        if value.is_finite() {
            // A unit must not be torn at its stroke.
            let unit = unit.replace('/', "/\u{2060}");
            figures.push(Figure::text(name, format!("{}\u{a0}{unit}", three(value)).trim_end()));
        }
    };
    if let Some(held) = &fit.held_out {
        figure("Error before, runs it never saw", held.rmse_before);
        figure("Error after, runs it never saw", held.rmse_after);
    }
    figure("Error before, fitted runs", fit.fitted.rmse_before);
    figure("Error after, fitted runs", fit.fitted.rmse_after);
    let noise = fit.noise_in_words();
    let noise = noise.strip_prefix("the ").unwrap_or(noise);
    figure(&format!("{}{}", noise[..1].to_uppercase(), &noise[1..]), fit.fitted.noise);
    let mut section = Section::new("Before and after")
        .words(format!("Root mean square error of {signal}."))
        .with(Item::Figures(figures));
    for shown in found.shown.iter().take(IN_DETAIL) {
        section = section.with(both(shown)).with(errors(shown));
    }
    section
}

/// Three significant digits: a figure is read and not computed with.
fn three(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    #[expect(clippy::cast_possible_truncation, reason = "the exponent of a double is small")]
    let power = 10f64.powi(2 - value.abs().log10().floor() as i32);
    super::super::short((value * power).round() / power)
}

fn title(shown: &Shown, what: &str) -> String {
    let seen = if shown.held_out { "held out" } else { "fitted" };
    format!("{} ({seen}): {what}", super::super::titled(&shown.run))
}

fn both(shown: &Shown) -> Plot {
    let series = |name: &str, values: &[f64]| Series::new(name, shown.time_s.clone(), values.to_vec());
    let axis = Axis::of(&shown.signal);
    let title = title(shown, &axis.label);
    // In this order before and after have the colours that they have in every other plot.
    let series = vec![
        series("model before", &shown.before).drawn(Line::Dashed),
        series("model after", &shown.after),
        series("measured", &shown.measured),
    ];
    Plot::new(title, Lines::over_time(axis, series))
}

fn errors(shown: &Shown) -> Plot {
    let minus = |name: &str, modelled: &[f64]| {
        let left: Vec<f64> = shown.measured.iter().zip(modelled).map(|(one, other)| one - other).collect();
        Series::new(name, shown.time_s.clone(), left)
    };
    let Axis { label, unit } = Axis::of(&shown.signal);
    let series = vec![minus("before", &shown.before).drawn(Line::Dashed), minus("after", &shown.after)];
    Plot::new(
        title(shown, "measured minus modelled"),
        Lines::over_time(Axis { label: format!("error of {label}"), unit }, series),
    )
}
