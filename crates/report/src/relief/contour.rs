//! Lines of one height.
//!
//! Source: marching squares; a saddle is cut as its mean says.

use super::Ground;
use std::fmt::Write;

/// Appends the pieces of the line of `level_m` to a path.
pub(crate) fn draw(d: &mut String, ground: &Ground, level_m: f64, place: impl Fn(f64, f64) -> [f64; 2]) {
    for [from, to] in pieces(ground, level_m) {
        let ([x, y], [u, v]) = (place(from[0], from[1]), place(to[0], to[1]));
        let _ = write!(d, "M{x:.1} {y:.1}L{u:.1} {v:.1}");
    }
}

/// The pieces, by their ends: east and north [m].
fn pieces(ground: &Ground, level_m: f64) -> Vec<[[f64; 2]; 2]> {
    let mut all = Vec::new();
    for row in 0..ground.rows().saturating_sub(1) {
        for column in 0..ground.columns.saturating_sub(1) {
            // Around the cell, from the south-west against the clock.
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(right, up)| {
                let (column, row) = (column + right, row + up);
                let above = ground.heights_m[row * ground.columns + column] - level_m;
                let east = ground.corner_m[0] + ground.cell_m[0] * column as f64;
                let north = ground.corner_m[1] + ground.cell_m[1] * row as f64;
                (above, [east, north])
            });
            if corners.iter().any(|(above, _)| above.is_nan()) {
                continue;
            }
            let crossings: Vec<[f64; 2]> = (0..4)
                .filter_map(|side| {
                    let ((a, p), (b, q)) = (corners[side], corners[(side + 1) % 4]);
                    ((a >= 0.0) != (b >= 0.0)).then(|| {
                        let t = a / (a - b);
                        [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]
                    })
                })
                .collect();
            match crossings[..] {
                [from, to] => all.push([from, to]),
                [south, east, north, west] => {
                    let mean_above = corners.iter().map(|(above, _)| above).sum::<f64>() >= 0.0;
                    // The corner in the south-west is cut off where it does not go with the middle.
                    if (corners[0].0 >= 0.0) == mean_above {
                        all.extend([[south, east], [north, west]]);
                    } else {
                        all.extend([[west, south], [east, north]]);
                    }
                }
                _ => {}
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_a_plane_the_line_lies_where_the_height_is() {
        let heights_m = (0..12).map(|i| f64::from(i % 4)).collect();
        let ground = Ground { corner_m: [100.0, 0.0], cell_m: [2.0, 2.0], columns: 4, heights_m };
        let pieces = pieces(&ground, 1.25);
        assert_eq!(pieces.len(), 2);
        assert!(pieces.iter().flatten().all(|point| (point[0] - 102.5).abs() < 1e-12), "{pieces:?}");
    }

    #[test]
    fn a_saddle_is_crossed_twice_and_the_unknown_not_at_all() {
        let saddle = |height| Ground {
            corner_m: [0.0; 2],
            cell_m: [1.0; 2],
            columns: 2,
            heights_m: vec![height, 0.0, 0.0, 1.0],
        };
        assert_eq!(pieces(&saddle(1.0), 0.4).len(), 2);
        assert!(pieces(&saddle(f64::NAN), 0.4).is_empty());
    }
}
