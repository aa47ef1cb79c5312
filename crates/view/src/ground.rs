//! The ground's heights.

use crate::ViewError;

/// Heights, in the same frame as the runs' `elevation_m`. Beyond the last height that height goes on.
#[derive(Clone, Copy, Debug)]
pub enum Ground<'a> {
    /// Heights along the path, the same for every run.
    Profile {
        /// Distances along the path [m], increasing.
        position_m: &'a [f64],
        /// Height at each [m].
        height_m: &'a [f64],
    },
    /// Heights over a square grid.
    Grid {
        /// East of the first height [m].
        east_m: f64,
        /// North of the first height [m].
        north_m: f64,
        /// From one height to the next, both ways [m].
        spacing_m: f64,
        /// Heights in a row from west to east; 2 or more.
        columns: usize,
        /// Rows from south to north, one behind the other; 2 or more.
        height_m: &'a [f64],
    },
}

impl Ground<'_> {
    /// # Errors
    /// [`ViewError::GroundSize`] or [`ViewError::GroundValue`].
    pub(crate) fn check(&self) -> Result<(), ViewError> {
        let heights = match self {
            Self::Profile { position_m, height_m } => {
                let positions = position_m.len();
                if height_m.len() != positions || positions < 2 {
                    return Err(ViewError::GroundSize { found: height_m.len(), expected: positions.max(2) });
                }
                increasing(position_m)?;
                height_m
            }
            Self::Grid { east_m, north_m, spacing_m, columns, height_m } => {
                if *columns < 2 || height_m.len() < 2 * columns || height_m.len() % columns != 0 {
                    let rows = (height_m.len() / (*columns).max(1)).max(2);
                    return Err(ViewError::GroundSize {
                        found: height_m.len(),
                        expected: rows * (*columns).max(2),
                    });
                }
                for (name, found) in [("east_m", *east_m), ("north_m", *north_m)] {
                    if !found.is_finite() {
                        return Err(ViewError::GroundValue { name, index: 0, found, expected: "a number" });
                    }
                }
                if !(*spacing_m > 0.0 && spacing_m.is_finite()) {
                    return Err(ViewError::GroundValue {
                        name: "spacing_m",
                        index: 0,
                        found: *spacing_m,
                        expected: "a number above 0",
                    });
                }
                height_m
            }
        };
        match heights.iter().position(|height| !height.is_finite()) {
            Some(index) => Err(ViewError::GroundValue {
                name: "height_m",
                index,
                found: heights[index],
                expected: "a number",
            }),
            None => Ok(()),
        }
    }

    /// Height [m] at a place, which is so far along the path.
    pub(crate) fn height_m(&self, travelled_m: f64, east_m: f64, north_m: f64) -> f64 {
        match self {
            Self::Profile { position_m, height_m } => {
                let right = position_m.partition_point(|at| *at <= travelled_m);
                let Some(left) = right.checked_sub(1) else { return height_m[0] };
                if right == position_m.len() {
                    return height_m[left];
                }
                let share = (travelled_m - position_m[left]) / (position_m[right] - position_m[left]);
                height_m[left] + share * (height_m[right] - height_m[left])
            }
            Self::Grid { east_m: west, north_m: south, spacing_m, columns, height_m } => {
                let rows = height_m.len() / columns;
                let (column, right) = cell((east_m - west) / spacing_m, *columns);
                let (row, up) = cell((north_m - south) / spacing_m, rows);
                let at = |row: usize, column: usize| height_m[row * columns + column];
                let low = at(row, column) + right * (at(row, column + 1) - at(row, column));
                let high = at(row + 1, column) + right * (at(row + 1, column + 1) - at(row + 1, column));
                low + up * (high - low)
            }
        }
    }
}

fn increasing(positions: &[f64]) -> Result<(), ViewError> {
    let wrong = positions.iter().enumerate().find(|(index, position)| {
        !position.is_finite() || index.checked_sub(1).is_some_and(|before| positions[before] >= **position)
    });
    wrong.map_or(Ok(()), |(index, found)| {
        Err(ViewError::GroundValue {
            name: "position_m",
            index,
            found: *found,
            expected: "a number above the one before",
        })
    })
}

/// The cell that a place lies in, and the share of the cell before it; the edge for places outside.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "kept within the grid")]
fn cell(place: f64, points: usize) -> (usize, f64) {
    let place = place.clamp(0.0, (points - 1) as f64);
    let cell = (place.floor() as usize).min(points - 2);
    (cell, place - cell as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// h = 2 + 3 e + 5 n is met exactly between the points.
    #[test]
    fn a_plane_over_a_grid_is_a_plane() {
        let height_m: Vec<f64> = (0..12)
            .map(|index| {
                let (east, north) = (10.0 + f64::from(index % 4) * 2.0, 20.0 + f64::from(index / 4) * 2.0);
                2.0 + 3.0 * east + 5.0 * north
            })
            .collect();
        let ground =
            Ground::Grid { east_m: 10.0, north_m: 20.0, spacing_m: 2.0, columns: 4, height_m: &height_m };
        ground.check().unwrap();
        let height = ground.height_m(0.0, 13.5, 22.7);
        assert!((height - (2.0 + 3.0 * 13.5 + 5.0 * 22.7)).abs() < 1e-12, "{height}");
        assert_eq!(ground.height_m(0.0, -1e6, 20.0), 2.0 + 30.0 + 100.0, "beyond the edge");
    }

    #[test]
    fn a_profile_is_linear_between_its_points_and_level_beyond() {
        let ground = Ground::Profile { position_m: &[0.0, 10.0], height_m: &[1.0, 3.0] };
        assert_eq!([-5.0, 2.5, 99.0].map(|at| ground.height_m(at, 0.0, 0.0)), [1.0, 1.5, 3.0]);
    }

    #[test]
    fn a_ground_that_does_not_fit_is_refused() {
        let profile = |position_m, height_m| Ground::Profile { position_m, height_m }.check();
        assert!(matches!(profile(&[0.0, 1.0], &[0.0]), Err(ViewError::GroundSize { found: 1, expected: 2 })));
        assert!(matches!(profile(&[0.0, 0.0], &[0.0; 2]), Err(ViewError::GroundValue { index: 1, .. })));
        let height = profile(&[0.0, 1.0], &[0.0, f64::NAN]).unwrap_err();
        assert_eq!(height.to_string(), "the ground's `height_m` is NaN at index 1, expected a number");
        let grid = |columns, spacing_m| {
            Ground::Grid { east_m: 0.0, north_m: 0.0, spacing_m, columns, height_m: &[0.0; 6] }.check()
        };
        assert!(grid(3, 1.0).is_ok());
        assert!(matches!(grid(4, 1.0), Err(ViewError::GroundSize { .. })));
        assert!(matches!(grid(3, 0.0), Err(ViewError::GroundValue { name: "spacing_m", .. })));
    }
}
