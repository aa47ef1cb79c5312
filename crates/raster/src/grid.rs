//! A grid of samples over the map.

use crate::smooth::Smoothed;
use headland_plugin::Bounds;

/// Samples at even distances, from west to east and from south to north.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    /// East and north of the sample in the south-west [m].
    pub(crate) corner_m: [f64; 2],
    /// How far samples are apart to the east and to the north [m].
    pub(crate) cell_m: [f64; 2],
    /// Rows from south to north; NaN where nothing is known.
    pub(crate) values: Vec<f64>,
    /// Latitude and longitude [°] of the map's origin, where the file gives degrees.
    pub(crate) geographic: Option<(f64, f64)>,
}

impl Raster {
    /// A grid of values, rows from south to north, whose south-western sample lies on the origin.
    ///
    /// # Panics
    /// Where there are not as many values as the rows hold: that is a bug of the caller.
    pub fn of(columns: usize, cell_m: f64, values: Vec<f64>) -> Self {
        let rows = values.len() / columns;
        assert_eq!(rows * columns, values.len(), "whole rows");
        Self { columns, rows, corner_m: [0.0; 2], cell_m: [cell_m; 2], values, geographic: None }
    }

    /// From rows that go from north to south, as files have them.
    pub(crate) fn from_north(columns: usize, corner_m: [f64; 2], cell_m: [f64; 2], values: &[f64]) -> Self {
        let rows = values.len() / columns;
        let values = values.chunks_exact(columns).rev().flatten().copied().collect();
        Self { columns, rows, corner_m, cell_m, values, geographic: None }
    }

    /// The same grid on a map whose origin lies at this point of it [m].
    #[must_use]
    pub fn from_origin(mut self, east_m: f64, north_m: f64) -> Self {
        self.corner_m = [self.corner_m[0] - east_m, self.corner_m[1] - north_m];
        self
    }

    /// Samples from west to east.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Samples from south to north.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// How far samples are apart to the east and to the north [m].
    pub fn cell_m(&self) -> [f64; 2] {
        self.cell_m
    }

    /// Latitude and longitude [°] of the south-western sample, where the file gave degrees.
    pub fn geographic(&self) -> Option<(f64, f64)> {
        self.geographic
    }

    /// The samples, row after row from south to north; NaN where nothing is known.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// From the first to the last sample.
    pub fn bounds(&self) -> Bounds {
        let last = |axis: usize, count: usize| {
            self.corner_m[axis] + self.cell_m[axis] * count.saturating_sub(1) as f64
        };
        Bounds {
            east_m: [self.corner_m[0], last(0, self.columns)],
            north_m: [self.corner_m[1], last(1, self.rows)],
        }
    }

    /// East and north of a sample [m].
    pub fn place_m(&self, column: usize, row: usize) -> [f64; 2] {
        [self.corner_m[0] + self.cell_m[0] * column as f64, self.corner_m[1] + self.cell_m[1] * row as f64]
    }

    /// The sample whose cell holds a point [m]; `None` off the grid or where nothing is known.
    pub fn nearest(&self, east_m: f64, north_m: f64) -> Option<f64> {
        let index = |at: f64, axis: usize, count: usize| {
            let cell = ((at - self.corner_m[axis]) / self.cell_m[axis] + 0.5).floor();
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the grid")]
            (cell >= 0.0 && cell < count as f64).then_some(cell as usize)
        };
        let (column, row) = (index(east_m, 0, self.columns)?, index(north_m, 1, self.rows)?);
        Some(self.values[row * self.columns + column]).filter(|value| !value.is_nan())
    }

    /// Between the four samples around a point, evenly; `None` off the grid or where one of them is not known.
    pub fn even(&self, east_m: f64, north_m: f64) -> Option<f64> {
        let (column, u) = between(east_m, self.corner_m[0], self.cell_m[0], self.columns)?;
        let (row, v) = between(north_m, self.corner_m[1], self.cell_m[1], self.rows)?;
        let at = |c: usize, r: usize| self.values[(row + r) * self.columns + column + c];
        let south = (1.0 - u) * at(0, 0) + u * at(1, 0);
        let north = (1.0 - u) * at(0, 1) + u * at(1, 1);
        Some((1.0 - v) * south + v * north).filter(|value| !value.is_nan())
    }

    /// A surface through the samples without steps of its slope; `None` for fewer than three rows or columns.
    pub fn smoothed(&self) -> Option<Smoothed> {
        Smoothed::through(self)
    }
}

/// The sample at or before a place, and the share of the cell behind it; `None` off the grid.
pub(crate) fn between(at: f64, corner: f64, cell: f64, count: usize) -> Option<(usize, f64)> {
    let along = (at - corner) / cell;
    let last = count.checked_sub(2)?;
    if !(along >= 0.0 && along <= (count - 1) as f64) {
        return None;
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the grid")]
    let index = (along as usize).min(last);
    Some((index, along - index as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 by 2 samples, 2 m apart: 1 2 3 in the south, 4 5 and one unknown in the north.
    fn grid() -> Raster {
        Raster::of(3, 2.0, vec![1.0, 2.0, 3.0, 4.0, 5.0, f64::NAN])
    }

    #[test]
    fn the_nearest_sample_owns_a_cell_around_it() {
        let grid = grid();
        assert_eq!((grid.columns(), grid.rows()), (3, 2));
        assert_eq!(grid.nearest(0.9, 0.9), Some(1.0));
        assert_eq!(grid.nearest(1.1, 0.9), Some(2.0));
        assert_eq!(grid.nearest(-0.9, 2.9), Some(4.0));
        assert_eq!(
            (grid.nearest(4.0, 2.0), grid.nearest(-1.1, 0.0), grid.nearest(0.0, 3.1)),
            (None, None, None)
        );
    }

    #[test]
    fn between_four_samples_it_goes_evenly() {
        let grid = grid();
        // A quarter of the way east from 1 and 4 to 2 and 5, half way north.
        assert!((grid.even(0.5, 1.0).unwrap() - 2.75).abs() < 1e-15);
        assert_eq!(grid.even(2.0, 2.0), None, "beside the unknown");
        assert_eq!((grid.even(4.1, 0.0), grid.even(f64::NAN, 0.0)), (None, None));
    }

    #[test]
    fn an_origin_moves_the_map() {
        let grid = grid().from_origin(100.0, -50.0);
        assert_eq!(grid.bounds(), Bounds { east_m: [-100.0, -96.0], north_m: [50.0, 52.0] });
        assert_eq!(grid.nearest(-98.0, 50.0), Some(2.0));
        assert_eq!(grid.place_m(1, 1), [-98.0, 52.0]);
    }
}
