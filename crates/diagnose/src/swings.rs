//! Loads that swing: what is filled or emptied goes one way, or fills and is emptied again. A load that goes to and fro all along a run is
//! a force that wanders, by another name.

use nalgebra::DVector;

/// A turn is one where the course came back by so many standard deviations of a difference,
const SIGMAS: f64 = 2.0;
/// and by this share of all that it reaches.
const SHARE: f64 = 0.3;
/// Filled and emptied again turns once.
const MOST_TURNS: usize = 1;

/// Whether most of the courses that turn at all, each of values with their standard deviations, swing.
pub fn mostly(courses: &[(DVector<f64>, DVector<f64>)]) -> bool {
    let turned: Vec<usize> = courses.iter().map(|(values, sds)| turns(values, sds)).collect();
    let swings = turned.iter().filter(|turns| **turns > MOST_TURNS).count();
    swings > turned.iter().filter(|turns| **turns == MOST_TURNS).count()
}

/// How often a course turns back.
fn turns(values: &DVector<f64>, sds: &DVector<f64>) -> usize {
    if values.is_empty() {
        return 0;
    }
    let reach = values.max() - values.min();
    let (mut low, mut high) = (0, 0);
    let mut rises: Option<bool> = None;
    let mut count = 0;
    for at in 1..values.len() {
        let clearly = |from: usize| {
            let apart = values[at] - values[from];
            let needed = (SIGMAS * sds[at].hypot(sds[from])).max(SHARE * reach);
            (apart.abs() > needed).then_some(apart > 0.0)
        };
        let turned = match rises {
            None => clearly(low).or_else(|| clearly(high)),
            Some(true) => clearly(high).filter(|rises| !rises),
            Some(false) => clearly(low).filter(|rises| *rises),
        };
        if let Some(way) = turned {
            count += usize::from(rises.is_some());
            rises = Some(way);
            (low, high) = (at, at);
        }
        low = if values[at] < values[low] { at } else { low };
        high = if values[at] > values[high] { at } else { high };
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(of: impl Fn(f64) -> f64, sd: f64) -> (DVector<f64>, DVector<f64>) {
        (DVector::from_fn(40, |row, _| of(row as f64 / 39.0)), DVector::from_element(40, sd))
    }

    #[test]
    fn what_is_filled_and_emptied_turns_once_and_a_wave_often() {
        let filled = course(|at| 900.0 * (1.0 - (2.0 * at - 1.0).abs()), 60.0);
        let wave = course(|at| 900.0 * (20.0 * at).sin(), 60.0);
        let emptied = course(|at| -900.0 * at, 60.0);
        let unknown = course(|at| 900.0 * (20.0 * at).sin(), 800.0);
        for (own, expected) in [(&filled, 1), (&wave, 6), (&emptied, 0), (&unknown, 0)] {
            assert_eq!(turns(&own.0, &own.1), expected);
        }
        assert!(mostly(&[wave.clone(), wave.clone(), filled.clone()]) && !mostly(&[emptied, unknown]));
        assert!(!mostly(&[wave, filled]));
    }
}
