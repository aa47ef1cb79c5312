//! Maps of the mismatch: runs by position, and runs by speed.

use super::plan::name;
use super::scale::Scale;
use super::{Diagnosis, Left, Stage};
use crate::ViewError;
use crate::colour::Colour;
use crate::entity;
use crate::recorder::Recorder;
use rerun::{Color, Image, Points2D, Radius};

/// Cells along the axis.
const CELLS: usize = 32;
/// Width of a cell in pixels, and height of all rows together.
const WIDE: usize = 20;
const HIGH: usize = 300;
/// Room for the names on the left and the numbers below, in pixels.
const NAMES: f64 = 170.0;
const NUMBERS: f64 = 44.0;
/// Where a run never was.
const NEVER: Colour = [22, 26, 32];
/// Rows that are named.
const NAMED: usize = 8;

/// Along what a map is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Over {
    Position,
    Speed,
}

impl Over {
    pub(crate) const BOTH: [Self; 2] = [Self::Position, Self::Speed];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Speed => "speed",
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Position => "m",
            Self::Speed => "m/s",
        }
    }

    fn of<'a>(self, left: &Left<'a>) -> &'a [f64] {
        match self {
            Self::Position => left.position_m,
            Self::Speed => left.speed_m_s,
        }
    }
}

/// Left, top, right, bottom of what a view has to show, in pixels.
pub(crate) fn view(rows: usize) -> [f64; 4] {
    let (width, height) = ((CELLS * WIDE) as f64, (rows * row_height(rows)) as f64);
    [-NAMES, -6.0, width + 40.0, height + NUMBERS]
}

fn row_height(rows: usize) -> usize {
    (HIGH / rows.max(1)).clamp(2, 44)
}

/// Draws one map of each stage.
pub(crate) fn draw(to: &Recorder, diagnosis: &Diagnosis, over: Over, scale: Scale) -> Result<(), ViewError> {
    let values = || diagnosis.left.iter().flat_map(|left| over.of(left).iter().copied());
    let all = || values().filter(|value| value.is_finite());
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    if high <= low || !low.is_finite() {
        return Ok(());
    }
    let rows = diagnosis.left.len();
    let height = row_height(rows);
    for stage in Stage::BOTH {
        let means: Vec<Vec<f64>> =
            diagnosis.left.iter().map(|left| means(over.of(left), stage.of(left), [low, high])).collect();
        let mut pixels = Vec::with_capacity(rows * height * CELLS * WIDE * 3);
        for row in &means {
            for line in 0..height {
                for mean in row {
                    // A seam between rows, where there is room for one.
                    let seam = height > 6 && line + 1 == height;
                    let colour = if seam || !mean.is_finite() { NEVER } else { scale.colour(*mean) };
                    for _ in 0..WIDE {
                        pixels.extend_from_slice(&colour);
                    }
                }
            }
        }
        let size = |pixels: usize| u32::try_from(pixels).unwrap_or(u32::MAX);
        let image = Image::from_rgb24(pixels, [size(CELLS * WIDE), size(rows * height)]);
        to.fixed(&entity::mapped(over.name(), stage.name()), &image)?;
    }
    axes(to, diagnosis, over, [low, high])
}

/// The mean of each cell; NaN where the run never was.
fn means(at: &[f64], values: &[f64], [low, high]: [f64; 2]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0usize); CELLS];
    for (at, value) in at.iter().zip(values).filter(|(at, value)| at.is_finite() && value.is_finite()) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cell of the map")]
        let cell = (((at - low) / (high - low) * CELLS as f64).max(0.0) as usize).min(CELLS - 1);
        sums[cell].0 += value;
        sums[cell].1 += 1;
    }
    sums.into_iter().map(|(sum, count)| if count == 0 { f64::NAN } else { sum / count as f64 }).collect()
}

/// The names of the runs, and numbers along the axis.
fn axes(to: &Recorder, diagnosis: &Diagnosis, over: Over, [low, high]: [f64; 2]) -> Result<(), ViewError> {
    let rows = diagnosis.left.len();
    let height = row_height(rows) as f64;
    let every = rows.div_ceil(NAMED).max(1);
    let names = diagnosis.left.iter().enumerate().filter(|(row, _)| row % every == 0).map(|(row, left)| {
        let middle = (row as f64 + 0.5) * height - 0.4 * height;
        ([-0.5 * NAMES, middle], name(left))
    });
    let bottom = rows as f64 * height;
    let numbers = (0..=4u32).map(|part| {
        let share = f64::from(part) / 4.0;
        let value = low + share * (high - low);
        let told = if high - low < 20.0 { format!("{value:.1}") } else { format!("{value:.0}") };
        ([share * (CELLS * WIDE) as f64, bottom], format!("{told} {}", over.unit()))
    });
    to.fixed(&entity::mapped(over.name(), "axes"), &words(names.chain(numbers)))
}

fn words(all: impl IntoIterator<Item = ([f64; 2], String)>) -> Points2D {
    let (places, labels): (Vec<[f64; 2]>, Vec<String>) = all.into_iter().unzip();
    #[expect(clippy::cast_possible_truncation, reason = "pictures are drawn in single precision")]
    let places = places.into_iter().map(|at| at.map(|part| part as f32));
    Points2D::new(places)
        .with_radii([Radius::new_ui_points(0.5)])
        .with_colors([Color::from_rgb(200, 200, 200)])
        .with_labels(labels)
        .with_show_labels(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_holds_the_mean_of_its_rows_and_none_is_filled_in() {
        let means = means(&[0.0, 0.1, 32.0, f64::NAN, 31.9], &[2.0, 4.0, 7.0, 99.0, f64::NAN], [0.0, 32.0]);
        assert_eq!((means[0], means[CELLS - 1]), (3.0, 7.0));
        assert!(means[1..CELLS - 1].iter().all(|mean| mean.is_nan()));
    }

    #[test]
    fn many_runs_are_thinner() {
        assert_eq!([row_height(1), row_height(15), row_height(1000)], [44, 20, 2]);
    }
}
