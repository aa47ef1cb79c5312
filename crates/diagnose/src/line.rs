//! The straight line through pairs.

use headland_calibrate::statistics::mean;

/// By least squares.
pub struct Line {
    middle: (f64, f64),
    /// What the second rises by, for each one that the first does; 0 where that never changes.
    pub slope: f64,
    /// Share of the second's square about its mean that goes along the line.
    pub followed: f64,
}

impl Line {
    /// Of pairs of as many values.
    pub fn through(xs: &[f64], ys: &[f64]) -> Self {
        let middle = (mean(xs), mean(ys));
        let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
        for (x, y) in xs.iter().zip(ys) {
            let (dx, dy) = (x - middle.0, y - middle.1);
            (xx, yy, xy) = (xx + dx * dx, yy + dy * dy, xy + dx * dy);
        }
        let slope = if xx > 0.0 { xy / xx } else { 0.0 };
        Self { middle, slope, followed: if yy > 0.0 { slope * xy / yy } else { 1.0 } }
    }

    /// The second, where the first is `x`.
    pub fn at(&self, x: f64) -> f64 {
        self.middle.1 + self.slope * (x - self.middle.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Line;

    /// By hand: (0, 1), (1, 2), (2, 2) have the means 1 and 5/3, the slope 1/2 and the share 3/4 of 2/3.
    #[test]
    fn of_three_pairs_it_is_the_one_by_hand() {
        let line = Line::through(&[0.0, 1.0, 2.0], &[1.0, 2.0, 2.0]);
        assert!((line.slope - 0.5).abs() < 1e-12 && (line.at(4.0) - (5.0 / 3.0 + 1.5)).abs() < 1e-12);
        assert!((line.followed - 0.75).abs() < 1e-12);
    }

    #[test]
    fn what_never_changes_has_no_slope_and_is_followed_as_a_whole() {
        let line = Line::through(&[2.0, 2.0], &[1.0, 5.0]);
        assert!(line.slope == 0.0 && line.followed == 0.0 && line.at(7.0) == 3.0);
        assert!(Line::through(&[1.0, 2.0], &[4.0, 4.0]).followed == 1.0);
    }
}
