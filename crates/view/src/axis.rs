//! What axes span, so that they can be read: the viewer writes numbers only at powers of ten, and none where these lie too close.

/// Numbers one above another need so much room [points]; the viewer drops those that have less than 20.
const NUMBER: f64 = 22.0;
/// As many numbers tell what a scale is.
const NUMBERS: f64 = 3.0;
/// Left free at both ends, as a share of what is spanned: a number at the very end would be cut.
const MARGIN: f64 = 0.06;
/// Steps of times [s].
const TIMES_S: [f64; 7] = [1.0, 10.0, 60.0, 600.0, 3_600.0, 36_000.0, 86_400.0];
/// More numbers of time than this the viewer does not write.
const TIMES: f64 = 15.0;

/// From where to where values go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    low: f64,
    high: f64,
}

impl Span {
    /// Of all values that are numbers; `None` where there are none.
    pub(crate) fn of<'a>(values: impl IntoIterator<Item = &'a f64>) -> Option<Self> {
        let numbers = values.into_iter().copied().filter(|value| value.is_finite());
        numbers.map(|value| Self { low: value, high: value }).reduce(Self::with)
    }

    /// Both.
    pub(crate) fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// What an axis of a height [points] is to span, so that it has three numbers and none is cut; `None` where all values are one.
    pub(crate) fn axis(self, height: f64) -> Option<[f64; 2]> {
        let width = self.high - self.low;
        if width <= 1e-9 * self.low.abs().max(self.high.abs()) || !width.is_normal() {
            return None;
        }
        let most = (height / NUMBER).max(NUMBERS) * (1.0 - 2.0 * MARGIN);
        let step = 10f64.powf((width / most).log10().ceil());
        // In steps, so that multiples of one are whole numbers.
        let [mut low, mut high] = [self.low / step, self.high / step];
        let inside = |low: f64, high: f64| high.floor() - low.ceil() + 1.0;
        while inside(low, high) < NUMBERS {
            let [below, above] = [(low - 1e-9).floor(), (high + 1e-9).ceil()];
            // Values that are never less than nothing get no numbers below it.
            let down = low - below < above - high && !(self.low >= 0.0 && below < 0.0);
            if down { low = below } else { high = above }
        }
        let margin = MARGIN * (high - low);
        let ends = [low - margin, high + margin];
        // A number that the margin itself lets in at the very end is given its own.
        let ends = [
            ends[0].min(ends[0].ceil() - if ends[0].ceil() - ends[0] < margin { margin } else { 0.0 }),
            ends[1].max(ends[1].floor() + if ends[1] - ends[1].floor() < margin { margin } else { 0.0 }),
        ];
        Some(ends.map(|end| end * step))
    }
}

/// The end of an axis of times [s] that is to be at `to`, or a little later where a time would be cut there.
pub(crate) fn last_s(from: f64, to: f64) -> f64 {
    let margin = MARGIN * (to - from);
    let written = |step: &f64| (2.0..TIMES).contains(&((to - from) / step));
    let past = |step: &f64| to - (to / step).floor() * step;
    let cut = TIMES_S.iter().filter(|step| written(step)).map(past).filter(|past| *past < margin);
    to + cut.map(|past| margin - past).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(low: f64, high: f64, height: f64) -> [f64; 2] {
        Span::of(&[low, f64::NAN, high]).unwrap().axis(height).unwrap()
    }

    /// Numbers that the viewer writes: powers of ten that have room, and are not cut.
    fn numbers([low, high]: [f64; 2], height: f64) -> usize {
        let wide = high - low;
        let step = 10f64.powf((20.0 * wide / height).log10().ceil());
        let free = 0.03 * wide;
        let inside = |number: i32| {
            let at = f64::from(number) * step;
            (low + free..=high - free).contains(&at)
        };
        (-100..=100).filter(|number| inside(*number)).count()
    }

    #[test]
    fn every_axis_has_three_numbers_and_holds_its_values() {
        for height in [75.0, 120.0, 185.0, 240.0] {
            for low in [-1.4, -0.14, -0.02, 0.0, 0.07, 3.3] {
                for wide in (1..100).map(|tenths| 0.1 * f64::from(tenths)) {
                    for scale in [1e-4, 1.0, 1e5] {
                        let [least, most] = [scale * low, scale * (low + wide)];
                        let axis = axis(least, most, height);
                        assert!(axis[0] < least && most < axis[1], "{least} to {most}");
                        let found = numbers(axis, height);
                        assert!(found >= 3, "{found} from {least} to {most}, {height} points, {axis:?}");
                    }
                }
            }
        }
    }

    /// Of the plots that had one number or two: an error of speed, a power, an angle.
    #[test]
    fn plots_that_had_too_few_numbers_reach_the_next() {
        let near = |found: [f64; 2], expected: [f64; 2]| {
            assert!((0..2).all(|end| (found[end] - expected[end]).abs() < 1e-9), "{found:?}");
        };
        near(axis(-0.14, 0.04, 185.0), [-0.2144, 0.0544]);
        near(axis(-5e3, 130e3, 240.0), [-17.3e3, 212.3e3]);
        near(axis(-0.07, 0.09, 170.0), [-0.1, 0.1].map(|end| 1.12 * end));
        assert_eq!(Span::of(&[2.0, 2.0]).unwrap().axis(100.0), None);
        assert_eq!(Span::of(&[f64::NAN]), None);
    }

    #[test]
    fn no_time_is_cut_at_the_end() {
        assert!((last_s(0.0, 120.0) - 127.2).abs() < 1e-9);
        assert!((last_s(0.0, 71.0) - (71.0 + 0.06 * 71.0 - 1.0)).abs() < 1e-9);
        assert_eq!(last_s(0.0, 105.0), 105.0 + (0.06 * 105.0 - 5.0));
        assert_eq!(last_s(0.0, 57.0), 57.0);
    }
}
