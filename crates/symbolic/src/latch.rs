//! A switch that stays as it is between the values at which it goes on and off.
//!
//! Where it goes over between two samples it does so where a straight line between them says, and a sample has the mean of what
//! lies nearer to it than to its neighbours: so the rows move smoothly with the values that move the switch. At all other samples this
//! is the function `latched` of an expression.

/// The switch along a run of values, between 0 and 1: on from `on` upward until it is at `off` or below.
pub(crate) fn latched(values: impl Iterator<Item = f64>, on: f64, off: f64) -> Vec<f64> {
    let mut all: Vec<f64> = Vec::with_capacity(values.size_hint().0);
    let (mut state, mut before): (f64, Option<f64>) = (0.0, None);
    for value in values {
        let next = if value >= on {
            1.0
        } else if value <= off {
            0.0
        } else {
            state
        };
        let mut own = next;
        if let (Some(before), Some(last)) = (before, all.last_mut())
            && next != state
        {
            let at: f64 = if next > state { on } else { off };
            let share = ((at - before) / (value - before)).clamp(0.0, 1.0);
            *last += (next - state) * (0.5 - share).max(0.0);
            own -= (next - state) * (share - 0.5).max(0.0);
        }
        all.push(own);
        (state, before) = (next, Some(value));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along(values: &[f64]) -> Vec<f64> {
        latched(values.iter().copied(), 4.0, 2.0)
    }

    /// On at 4, off at 2; 3 leaves it as it is. Over a quarter of the way it is on for a quarter of the sample before as well.
    #[test]
    fn it_stays_between_and_goes_over_where_the_line_says() {
        assert_eq!(along(&[3.0, 3.5, 4.5, 3.0, 3.0, 1.0, 3.0]), [0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
        assert_eq!(along(&[3.0, 7.0]), [0.25, 1.0]);
        assert_eq!(along(&[1.0, 5.0]), [0.0, 0.75]);
        assert_eq!(along(&[5.0, 3.0, -1.0]), [1.0, 0.75, 0.0]);
    }

    /// A ramp of 1 m/s a sample: the time that it is on grows as the level falls.
    #[test]
    fn how_long_it_is_on_moves_smoothly_with_the_levels() {
        let ramp = || (0..10).map(f64::from);
        for at in [3.1, 3.4, 3.6, 3.9, 4.2] {
            let time: f64 = latched(ramp(), at, 0.0).iter().sum();
            assert!((time - (9.5 - at)).abs() < 1e-12, "{at}: {time}");
        }
    }
}
