//! How strong a spell is while it lasts: as many steps of force as stand out from the noise.
//!
//! A spell is cut in two where that makes it most likely, by (T₁ T₂ / T) (m₁ − m₂)² / (2 σ² τ), T the lengths, m the means, and σ the
//! noise of a mean over τ; and so is each part again, while a cut says more than chance would.
//! Source: binary segmentation; Scott and Knott, "A cluster analysis method for grouping means in the analysis of variance",
//! Biometrics 30 (1974) 507.

use crate::single_runs::events::Event;
use std::ops::Range;

/// Growth of ln p from which on a cut is no accident among the some hundred places of a spell.
const LEAST_GAIN: f64 = 12.0;

/// A part of a spell.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Its end, which is the begin of the next [s].
    pub to_s: f64,
    /// Force against the motion [N].
    pub force_n: f64,
}

/// The steps of a spell with what was seen in it [s, N], where the mean over `window_s` has a noise of `noise_n`; none where it is the
/// same all the time. Their mean is the force of the spell, and none of them drives.
pub fn steps(event: &Event, seen: &[(f64, f64)], (noise_n, window_s): (f64, f64)) -> Vec<Step> {
    if seen.len() < 2 {
        return Vec::new();
    }
    let lasts_s = event.to_s - event.from_s;
    let mean_n = seen.iter().map(|(_, force_n)| force_n).sum::<f64>() / seen.len() as f64;
    let forces_n: Vec<f64> = seen.iter().map(|(_, force_n)| event.force_n + force_n - mean_n).collect();
    let cutting = Cutting {
        sums: std::iter::once(0.0)
            .chain(forces_n.iter().scan(0.0, |sum, force_n| {
                *sum += force_n;
                Some(*sum)
            }))
            .collect(),
        shortest: seen.iter().filter(|(time_s, _)| *time_s < seen[0].0 + window_s).count(),
        known: noise_n * noise_n * window_s / lasts_s * seen.len() as f64,
    };
    let mut ends = Vec::new();
    cutting.cut(0..seen.len(), &mut ends);
    if ends.len() < 2 {
        return Vec::new();
    }
    let mut begin = 0;
    let step = |end: usize| {
        let force_n = cutting.mean(&(begin..end));
        begin = end;
        let to_s = seen.get(end).map_or(event.to_s, |(next_s, _)| 0.5 * (seen[end - 1].0 + next_s));
        Step { to_s, force_n }
    };
    ends.into_iter().map(step).collect()
}

/// Samples that are cut into parts.
struct Cutting {
    /// Sums of the forces before each sample, and of all [N].
    sums: Vec<f64>,
    /// Fewest samples of a part.
    shortest: usize,
    /// Square of the noise of one sample, if each knew nothing of the others [N²].
    known: f64,
}

impl Cutting {
    fn mean(&self, part: &Range<usize>) -> f64 {
        (self.sums[part.end] - self.sums[part.start]) / part.len() as f64
    }

    /// Ends of the parts that a stretch of samples is cut into, in their order.
    fn cut(&self, part: Range<usize>, ends: &mut Vec<usize>) {
        let gain = |at: usize| {
            let (before, after) = (part.start..at, at..part.end);
            let (one_n, other_n) = (self.mean(&before), self.mean(&after));
            let weight = before.len() as f64 * after.len() as f64 / part.len() as f64;
            let drives = one_n < 0.0 || other_n < 0.0;
            if drives { 0.0 } else { weight * (one_n - other_n).powi(2) / (2.0 * self.known) }
        };
        let places = part.start + self.shortest..(part.end + 1).saturating_sub(self.shortest);
        let best = places.map(|at| (at, gain(at))).max_by(|one, other| one.1.total_cmp(&other.1));
        match best {
            Some((at, gain)) if gain > LEAST_GAIN => {
                self.cut(part.start..at, ends);
                self.cut(at..part.end, ends);
            }
            _ => ends.push(part.end),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Step, steps};
    use crate::single_runs::events::Event;

    /// Samples of a spell of 4 s, twenty a second, with a noise of 100 N that has no course.
    fn seen(force_n: impl Fn(f64) -> f64) -> (Event, Vec<(f64, f64)>) {
        let noise_n = |index: usize| if index.is_multiple_of(2) { 100.0 } else { -100.0 };
        let seen: Vec<(f64, f64)> = (0..80)
            .map(|index| {
                let time_s = 10.0 + 0.05 * index as f64;
                (time_s, force_n(time_s) + noise_n(index))
            })
            .collect();
        let force_n = seen.iter().map(|(_, force_n)| force_n).sum::<f64>() / seen.len() as f64;
        let event =
            Event { run: 0, from_s: 10.0, to_s: 14.0, force_n, sd_n: 10.0, gain: 100.0, course: Vec::new() };
        (event, seen)
    }

    #[test]
    fn a_spell_that_is_the_same_all_the_time_is_one_step() {
        let (event, seen) = seen(|_| 2e3);
        assert!(steps(&event, &seen, (30.0, 0.4)).is_empty());
        assert!(steps(&event, &seen[..1], (30.0, 0.4)).is_empty());
    }

    #[test]
    fn a_spell_that_falls_by_half_is_cut_there() {
        let (event, seen) = seen(|time_s| if time_s < 12.0 { 2e3 } else { 1e3 });
        let found = steps(&event, &seen, (30.0, 0.4));
        let [Step { to_s, force_n: one_n }, Step { to_s: end_s, force_n: other_n }] = &found[..] else {
            panic!("{found:?}")
        };
        assert!((to_s - 11.975).abs() < 1e-9 && (*end_s - 14.0).abs() < 1e-9, "{found:?}");
        assert!((one_n - 2e3).abs() < 1e-9 && (other_n - 1e3).abs() < 1e-9, "{found:?}");
    }

    /// What a ramp leaves beside its steps is less than a quarter of what it leaves beside one force; the mean is the spell's.
    #[test]
    fn a_ramp_is_followed_by_steps_with_its_mean() {
        let ramp_n = |time_s: f64| 500.0 * (time_s - 10.0);
        let (event, seen) = seen(ramp_n);
        let found = steps(&Event { force_n: event.force_n + 50.0, ..event.clone() }, &seen, (30.0, 0.4));
        let at_n = |time_s: f64| found.iter().find(|step| time_s < step.to_s).unwrap().force_n - 50.0;
        let left = |of: &dyn Fn(f64) -> f64| -> f64 {
            seen.iter().map(|(time_s, _)| (ramp_n(*time_s) - of(*time_s)).powi(2)).sum()
        };
        assert!(left(&at_n) < 0.25_f64.powi(2) * left(&|_| event.force_n), "{found:?}");
        let mean_n = seen.iter().map(|(time_s, _)| at_n(*time_s)).sum::<f64>() / seen.len() as f64;
        assert!((mean_n - event.force_n).abs() < 1e-9);
    }

    #[test]
    fn no_step_drives() {
        let (event, seen) = seen(|time_s| if time_s < 13.0 { 1e3 } else { -1e3 });
        assert!(steps(&event, &seen, (30.0, 0.4)).iter().all(|step| step.force_n >= 0.0));
    }
}
