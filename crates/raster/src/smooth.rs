//! A surface through samples whose slope has no steps: cubic convolution.
//!
//! f(x) = Σ f_i w(x − i),  w(t) = 3/2 |t|³ − 5/2 t² + 1 for |t| ≤ 1,  −½ |t|³ + 5/2 t² − 4 |t| + 2 for |t| ≤ 2
//! beyond the edge  f₋₁ = 3 f₀ − 3 f₁ + f₂;  over the map the same in both directions
//!
//! Source: Keys, "Cubic convolution interpolation for digital image processing", IEEE Transactions on Acoustics, Speech, and
//! Signal Processing 29 (1981), 1153-1160.
//!
//! It goes through the samples and follows squares exactly, so the error falls with the third power of the cell, that of the
//! slope with its square. Bilinear interpolation would have steps of the slope at every sample, which a vehicle feels as
//! jolts and an integration loses its order at; splines of higher order would spread each fault of a sample over the map.

use crate::Raster;
use crate::grid::between;
use headland_plugin::Bounds;

/// Value and slope at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Smooth {
    /// The value.
    pub value: f64,
    /// Its change per metre to the east.
    pub rise_east: f64,
    /// Its change per metre to the north.
    pub rise_north: f64,
}

/// A smooth surface over a grid.
#[derive(Clone, Debug)]
pub struct Smoothed {
    bounds: Bounds,
    cell_m: [f64; 2],
    columns: usize,
    rows: usize,
    /// The samples with one more row and column on each side.
    padded: Vec<f64>,
}

impl Smoothed {
    pub(crate) fn through(raster: &Raster) -> Option<Self> {
        let (columns, rows) = (raster.columns, raster.rows);
        if columns < 3 || rows < 3 {
            return None;
        }
        let wide = columns + 2;
        let mut padded = vec![0.0; wide * (rows + 2)];
        for (row, values) in raster.values.chunks_exact(columns).enumerate() {
            let line = &mut padded[(row + 1) * wide..(row + 2) * wide];
            line[1..=columns].copy_from_slice(values);
            line[0] = beyond([line[1], line[2], line[3]]);
            line[columns + 1] = beyond([line[columns], line[columns - 1], line[columns - 2]]);
        }
        for column in 0..wide {
            let at = |row: usize| padded[row * wide + column];
            let south = beyond([at(1), at(2), at(3)]);
            let north = beyond([at(rows), at(rows - 1), at(rows - 2)]);
            padded[column] = south;
            padded[(rows + 1) * wide + column] = north;
        }
        Some(Self { bounds: raster.bounds(), cell_m: raster.cell_m, columns, rows, padded })
    }

    /// What it covers.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Value and slope at a point [m]; `None` off the grid, or where one of the sixteen samples around is not known.
    pub fn at(&self, east_m: f64, north_m: f64) -> Option<Smooth> {
        let (column, u) = between(east_m, self.bounds.east_m[0], self.cell_m[0], self.columns)?;
        let (row, v) = between(north_m, self.bounds.north_m[0], self.cell_m[1], self.rows)?;
        let (across, across_rise) = weights(u);
        let (along, along_rise) = weights(v);
        let (mut value, mut east, mut north) = (0.0, 0.0, 0.0);
        for r in 0..4 {
            let start = (row + r) * (self.columns + 2) + column;
            let samples = &self.padded[start..start + 4];
            let (mut line, mut line_rise) = (0.0, 0.0);
            for c in 0..4 {
                line += across[c] * samples[c];
                line_rise += across_rise[c] * samples[c];
            }
            value += along[r] * line;
            east += along[r] * line_rise;
            north += along_rise[r] * line;
        }
        let smooth = Smooth { value, rise_east: east / self.cell_m[0], rise_north: north / self.cell_m[1] };
        (!value.is_nan()).then_some(smooth)
    }
}

/// The sample beyond an edge, from the edge inward.
fn beyond([edge, one, two]: [f64; 3]) -> f64 {
    3.0 * edge - 3.0 * one + two
}

/// Weights of the four samples around, and their rates over the cell, at a share `t` of it.
fn weights(t: f64) -> ([f64; 4], [f64; 4]) {
    let (t2, t3) = (t * t, t * t * t);
    (
        [
            0.5 * (-t3 + 2.0 * t2 - t),
            0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
            0.5 * (-3.0 * t3 + 4.0 * t2 + t),
            0.5 * (t3 - t2),
        ],
        [
            0.5 * (-3.0 * t2 + 4.0 * t - 1.0),
            0.5 * (9.0 * t2 - 10.0 * t),
            0.5 * (-9.0 * t2 + 8.0 * t + 1.0),
            0.5 * (3.0 * t2 - 2.0 * t),
        ],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `function` sampled on 0 to 12 m east and 0 to 9 m north.
    fn sampled(cells_per_m: u32, function: impl Fn(f64, f64) -> f64) -> Smoothed {
        let cell = 1.0 / f64::from(cells_per_m);
        let (columns, rows) = (12 * cells_per_m + 1, 9 * cells_per_m + 1);
        let values = (0..rows)
            .flat_map(|row| (0..columns).map(move |column| (f64::from(column) * cell, f64::from(row) * cell)))
            .map(|(x, y)| function(x, y))
            .collect();
        Raster::of(columns as usize, cell, values).smoothed().unwrap()
    }

    /// Places all over the grid, its edges among them.
    fn places() -> impl Iterator<Item = (f64, f64)> {
        (0..=41).flat_map(|i| (0..=31).map(move |j| (12.0 * f64::from(i) / 41.0, 9.0 * f64::from(j) / 31.0)))
    }

    #[test]
    fn squares_are_followed_exactly_up_to_the_edges() {
        let function = |x: f64, y: f64| 3.0 + 0.5 * x - 0.2 * y + 0.03 * x * x - 0.05 * x * y + 0.02 * y * y;
        let smoothed = sampled(1, function);
        for (x, y) in places() {
            let smooth = smoothed.at(x, y).unwrap();
            assert!((smooth.value - function(x, y)).abs() < 1e-12, "{x} {y}");
            assert!((smooth.rise_east - (0.5 + 0.06 * x - 0.05 * y)).abs() < 1e-12);
            assert!((smooth.rise_north - (-0.2 - 0.05 * x + 0.04 * y)).abs() < 1e-12);
        }
    }

    #[test]
    fn the_error_falls_with_the_third_power_of_the_cell_and_that_of_the_slope_with_the_second() {
        let function = |x: f64, y: f64| (0.7 * x).sin() * (0.5 * y + 0.3).cos();
        let errors = |cells_per_m: u32| {
            let smoothed = sampled(cells_per_m, function);
            let (mut of_value, mut of_slope) = (0.0_f64, 0.0_f64);
            for (x, y) in places() {
                let smooth = smoothed.at(x, y).unwrap();
                of_value = of_value.max((smooth.value - function(x, y)).abs());
                let east = 0.7 * (0.7 * x).cos() * (0.5 * y + 0.3).cos();
                let north = -0.5 * (0.7 * x).sin() * (0.5 * y + 0.3).sin();
                of_slope = of_slope.max((smooth.rise_east - east).hypot(smooth.rise_north - north));
            }
            (of_value, of_slope)
        };
        let (coarse, fine) = (errors(8), errors(32));
        let order = |one: f64, two: f64| (one / two).log2() / 2.0;
        let (of_value, of_slope) = (order(coarse.0, fine.0), order(coarse.1, fine.1));
        assert!((of_value - 3.0).abs() < 0.2, "observed order {of_value}: {coarse:?} {fine:?}");
        assert!((of_slope - 2.0).abs() < 0.2, "observed order {of_slope}: {coarse:?} {fine:?}");
    }

    #[test]
    fn slopes_are_those_of_the_values_and_have_no_steps_at_the_samples() {
        let smoothed = sampled(1, |x, y| (1.3 * x).sin() + (0.9 * x * y).cos());
        let h = 1e-5;
        for (x, y) in [(3.0, 4.2), (5.5, 6.0), (2.3, 7.9), (7.0, 5.0)] {
            let (before, after) = (smoothed.at(x - h, y).unwrap(), smoothed.at(x + h, y).unwrap());
            assert!(
                ((after.value - before.value) / (2.0 * h) - smoothed.at(x, y).unwrap().rise_east).abs()
                    < 1e-4
            );
            assert!((after.rise_east - before.rise_east).abs() < 1e-3, "{x} {y}");
            let (before, after) = (smoothed.at(x, y - h).unwrap(), smoothed.at(x, y + h).unwrap());
            assert!(
                ((after.value - before.value) / (2.0 * h) - smoothed.at(x, y).unwrap().rise_north).abs()
                    < 1e-4
            );
        }
    }

    #[test]
    fn nothing_is_made_up_off_the_grid_and_beside_what_is_not_known() {
        let mut values = vec![1.0; 49];
        values[24] = f64::NAN;
        let smoothed = Raster::of(7, 1.0, values).smoothed().unwrap();
        assert_eq!(smoothed.at(3.0, 2.5), None);
        assert_eq!(smoothed.at(0.5, 3.0).map(|smooth| smooth.value), Some(1.0));
        assert_eq!((smoothed.at(-0.1, 3.0), smoothed.at(3.0, 6.1)), (None, None));
        assert!(Raster::of(2, 1.0, vec![0.0; 8]).smoothed().is_none());
    }
}
