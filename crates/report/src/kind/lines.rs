//! Lines over a common axis, with bands, shaded intervals and marks.

use crate::draw::{BY_EXTREMES, Drawn, Scale, Thinned, same_length};
use crate::thin::{BUCKETS, extremes};
use crate::{Axis, ReportError};
use serde_json::{Value, json};

/// How a series is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Line {
    /// A line.
    #[default]
    Solid,
    /// A broken line.
    Dashed,
    /// A dot at each sample and no line.
    Dots,
}

/// One series: `y` over `x`, NaN where there is a gap.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    name: String,
    x: Vec<f64>,
    y: Vec<f64>,
    band: Option<(Vec<f64>, Vec<f64>)>,
    line: Line,
}

impl Series {
    /// A line through these points.
    pub fn new(name: impl Into<String>, x: impl Into<Vec<f64>>, y: impl Into<Vec<f64>>) -> Self {
        Self { name: name.into(), x: x.into(), y: y.into(), ..Self::default() }
    }

    /// With a band from `lower` to `upper`, one value each for every sample.
    #[must_use]
    pub fn band(mut self, lower: impl Into<Vec<f64>>, upper: impl Into<Vec<f64>>) -> Self {
        self.band = Some((lower.into(), upper.into()));
        self
    }

    /// Drawn as a broken line or as dots.
    #[must_use]
    pub fn drawn(mut self, line: Line) -> Self {
        self.line = line;
        self
    }
}

/// A shaded part of the horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Interval {
    /// Where it begins, in units of the axis.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// What happens there.
    pub label: String,
}

/// A marked value of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// The value, in units of its axis.
    pub at: f64,
    /// What it is.
    pub label: String,
    /// Whether it stands on the vertical axis (a level) and not on the horizontal one (a moment).
    pub level: bool,
}

/// Lines over a common axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    x: Axis,
    y: Axis,
    series: Vec<Series>,
    intervals: Vec<Interval>,
    marks: Vec<Mark>,
    stacked: bool,
    along_time: bool,
}

impl Lines {
    /// Lines over any quantity.
    pub fn over(x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self { x, y, series, ..Self::default() }
    }

    /// Lines over time in seconds. All of these in one section zoom together.
    pub fn over_time(y: Axis, series: Vec<Series>) -> Self {
        Self { along_time: true, ..Self::over(Axis::time(), y, series) }
    }

    /// With shaded intervals.
    #[must_use]
    pub fn shaded(mut self, intervals: Vec<Interval>) -> Self {
        self.intervals = intervals;
        self
    }

    /// With marked values.
    #[must_use]
    pub fn marked(mut self, marks: Vec<Mark>) -> Self {
        self.marks = marks;
        self
    }

    /// Stacked areas, positive values upward and negative ones downward. All series have the samples of the first.
    #[must_use]
    pub fn stacked(mut self) -> Self {
        self.stacked = true;
        self
    }

    /// Range of the time axis; `None` for lines over something else or without samples.
    pub(crate) fn time_range(&self) -> Option<(f64, f64)> {
        let scale = Scale::new(&self.x, self.series.iter().flat_map(|series| series.x.iter().copied()));
        (self.along_time && scale.range.0.is_finite()).then_some(scale.range)
    }

    pub(crate) fn draw(&self, plot: &str) -> Result<Drawn, ReportError> {
        self.check(plot)?;
        let x = Scale::new(&self.x, self.series.iter().flat_map(|series| series.x.iter().copied()));
        let y = Scale::new(&self.y, self.series.iter().flat_map(values));
        let mut thinned = Thinned::default();
        let common: Option<Vec<usize>> = self.stacked.then(|| {
            let columns: Vec<&[f64]> = self.series.iter().map(|series| series.y.as_slice()).collect();
            let base = self.series.first().map_or(&[][..], |first| &first.x);
            extremes(base, &columns, BUCKETS / (1 + columns.len()))
        });
        let series: Vec<Value> = self
            .series
            .iter()
            .map(|series| {
                let kept = common.clone().unwrap_or_else(|| kept(series));
                thinned.add(&series.name, kept.len(), series.x.len());
                let pick = |values: &[f64], scale: &Scale| scale.all(kept.iter().map(|at| values[*at]));
                json!({
                    "name": series.name,
                    "x": pick(&series.x, &x),
                    "y": pick(&series.y, &y),
                    "low": series.band.as_ref().map(|(low, _)| pick(low, &y)),
                    "high": series.band.as_ref().map(|(_, high)| pick(high, &y)),
                    "line": match series.line { Line::Solid => "solid", Line::Dashed => "dashed", Line::Dots => "dots" },
                })
            })
            .collect();
        let notes =
            thinned.note(BY_EXTREMES).into_iter().chain(self.intervals_in_words(&x.axis.unit)).collect();
        let spec = json!({
            "kind": "lines",
            "x": x.spec(),
            "y": y.spec(),
            "series": series,
            "stacked": self.stacked,
            "intervals": self.intervals.iter().map(|interval| json!({
                "from": x.one(interval.from), "to": x.one(interval.to), "label": interval.label,
            })).collect::<Vec<_>>(),
            "marks": self.marks.iter().map(|mark| json!({
                "at": if mark.level { y.one(mark.at) } else { x.one(mark.at) }, "label": mark.label, "level": mark.level,
            })).collect::<Vec<_>>(),
        });
        Ok(Drawn { spec, alt: self.alt(&x, &y), notes })
    }

    fn alt(&self, x: &Scale, y: &Scale) -> String {
        let names: Vec<&str> = self.series.iter().map(|series| series.name.as_str()).collect();
        format!(
            "{} of {} over {}: {}. {} {}, {} {}.",
            if self.stacked { "Stacked areas" } else { "Lines" },
            y.axis.label,
            x.axis.label,
            names.join(", "),
            x.axis.label,
            x.words(),
            y.axis.label,
            y.words()
        )
    }

    fn intervals_in_words(&self, unit: &str) -> Option<String> {
        let number = crate::number::number;
        let words: Vec<String> = self
            .intervals
            .iter()
            .map(|interval| {
                format!("{} ({} to {} {unit})", interval.label, number(interval.from), number(interval.to))
            })
            .collect();
        (!words.is_empty()).then(|| format!("Shaded: {}.", words.join("; ")))
    }

    fn check(&self, plot: &str) -> Result<(), ReportError> {
        for series in &self.series {
            let (name, samples) = (&series.name, series.x.len());
            same_length(plot, name, "y", series.y.len(), samples)?;
            if let Some((low, high)) = &series.band {
                same_length(plot, name, "the lower band", low.len(), samples)?;
                same_length(plot, name, "the upper band", high.len(), samples)?;
            }
            if self.stacked {
                same_length(plot, name, "the stacked x", samples, self.series[0].x.len())?;
            }
        }
        Ok(())
    }
}

fn values(series: &Series) -> impl Iterator<Item = f64> + '_ {
    let band = series.band.iter().flat_map(|(low, high)| low.iter().chain(high));
    series.y.iter().chain(band).copied()
}

fn kept(series: &Series) -> Vec<usize> {
    let mut columns = vec![series.y.as_slice()];
    if let Some((low, high)) = &series.band {
        columns.extend([low.as_slice(), high.as_slice()]);
    }
    extremes(&series.x, &columns, BUCKETS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_series_is_thinned_and_says_so() {
        let x: Vec<f64> = (0..50_000).map(|at| f64::from(at) * 0.01).collect();
        let mut y: Vec<f64> = x.iter().map(|x| (x * 0.1).cos()).collect();
        y[31_234] = 7.5;
        let lines = Lines::over_time(Axis::of("speed_m_s"), vec![Series::new("r1", x, y)]);
        let drawn = lines.draw("speed").unwrap();
        let points = drawn.spec["series"][0]["y"].as_array().unwrap();
        assert!(points.len() < 2_100 && points.contains(&json!(7.5)));
        assert!(drawn.notes[0].starts_with("Thinned to "), "{:?}", drawn.notes);
        assert!(drawn.alt.contains("speed from −1 to 7.5 m/s"), "{}", drawn.alt);
    }

    #[test]
    fn arrays_of_unlike_length_are_refused_by_name() {
        let short = Lines::over_time(Axis::of("speed_m_s"), vec![Series::new("r1", [0.0, 1.0], [1.0])]);
        assert_eq!(
            short.draw("speed").unwrap_err().to_string(),
            "plot `speed`: y of `r1` has 1 values, expected 2"
        );
        let band = Series::new("r1", [0.0, 1.0], [1.0, 2.0]).band([0.0], [2.0, 3.0]);
        assert!(Lines::over_time(Axis::of("speed_m_s"), vec![band]).draw("speed").is_err());
    }

    #[test]
    fn stacked_series_are_thinned_at_the_same_samples() {
        let x: Vec<f64> = (0..20_000).map(f64::from).collect();
        let series = |name: &str, step: f64| {
            Series::new(name, x.clone(), x.iter().map(|x| (x * step).sin()).collect::<Vec<_>>())
        };
        let lines =
            Lines::over_time(Axis::new("force", "N"), vec![series("a", 0.01), series("b", 0.023)]).stacked();
        let drawn = lines.draw("forces").unwrap();
        assert_eq!(drawn.spec["series"][0]["x"], drawn.spec["series"][1]["x"]);
        assert!(drawn.spec["series"][0]["x"].as_array().unwrap().len() < 2_000);
    }
}
