//! What the parts of drivelines have in common: how their parameters are told and refused, and a search for a zero.

use headland_plugin::{Bound, Parameter, Refusal};

/// Parameters of several parts, one after the other.
pub(crate) const fn join<const N: usize>(lists: &[&[Parameter]]) -> [Parameter; N] {
    let mut all = [lists[0][0]; N];
    let (mut list, mut count) = (0, 0);
    while list < lists.len() {
        let mut index = 0;
        while index < lists[list].len() {
            all[count] = lists[list][index];
            count += 1;
            index += 1;
        }
        list += 1;
    }
    assert!(count == N, "as many parameters as the lists hold");
    all
}

#[allow(
    clippy::needless_pass_by_value,
    reason = "so that callers need not borrow what they made for this alone"
)]
pub(crate) fn refuse(parameter: impl Into<String>, found: impl ToString, expected: &str) -> Refusal {
    Refusal { parameter: parameter.into(), found: found.to_string(), expected: expected.to_owned() }
}

/// Holds numbers against the bounds of the parameters of this name: those of a part are not checked by a scenario alone.
pub(crate) fn hold(parameters: &[Parameter], values: &[(&str, f64)]) -> Result<(), Refusal> {
    for (name, value) in values {
        let ends = |full: &str| full == *name || full.rsplit('.').next() == Some(*name);
        let bound =
            parameters.iter().find(|parameter| ends(parameter.name)).map_or(Bound::Finite, |p| p.bound);
        if !bound.holds(*value) {
            let full = parameters.iter().find(|parameter| ends(parameter.name)).map_or(*name, |p| p.name);
            return Err(refuse(full, value, &bound.in_words()));
        }
    }
    Ok(())
}

/// Where a smooth function that rises through 0 from `low` to `high`, whichever is greater, is 0, by false position (Illinois variant); the end
/// that it does not cross otherwise.
pub(crate) fn crossing(mut low: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    const RELATIVE_TOLERANCE: f64 = 1e-10;
    const MOST_ROUNDS: usize = 60;
    let mut at_low = function(low);
    if at_low >= 0.0 {
        return low;
    }
    let mut at_high = function(high);
    if at_high <= 0.0 {
        return high;
    }
    let mut side = 0;
    for _ in 0..MOST_ROUNDS {
        let middle = (low * at_high - high * at_low) / (at_high - at_low);
        let value = function(middle);
        if value.abs() <= RELATIVE_TOLERANCE * (at_high - at_low).abs()
            || (high - low).abs() <= RELATIVE_TOLERANCE * high.abs()
        {
            return middle;
        }
        if value < 0.0 {
            (low, at_low) = (middle, value);
            if side == -1 {
                at_high *= 0.5;
            }
            side = -1;
        } else {
            (high, at_high) = (middle, value);
            if side == 1 {
                at_low *= 0.5;
            }
            side = 1;
        }
    }
    high
}

/// Checks that numbers increase, and are finite.
pub(crate) fn increasing(parameter: &str, values: &[f64], least: usize) -> Result<(), Refusal> {
    if values.len() < least {
        return Err(refuse(parameter, format!("{} values", values.len()), &format!("{least} or more")));
    }
    if let Some(value) = values.iter().find(|value| !value.is_finite()) {
        return Err(refuse(parameter, value, "finite numbers"));
    }
    match values.windows(2).find(|pair| pair[1] <= pair[0]) {
        Some(pair) => {
            Err(refuse(parameter, format!("{} after {}", pair[1], pair[0]), "values that increase"))
        }
        None => Ok(()),
    }
}

/// What falls from 1 to 0 as a distance falls from `over` to nothing. Mostly there is nothing to divide.
#[inline]
pub(crate) fn tapered(distance: f64, over: f64) -> f64 {
    if distance >= over { 1.0 } else { (distance / over).clamp(0.0, 1.0) }
}

/// Of a grid of no more points nobody guesses where a value lies.
const FEW: usize = 8;

/// A grid of no more points is looked through from end to end.
const SHORT: usize = 24;

/// The piece of an increasing grid that holds a value, and how far along it; ends are kept outside.
#[inline]
pub(crate) fn place(grid: &[f64], value: f64) -> (usize, f64) {
    let last = grid.len() - 2;
    let share = |index: usize| {
        let share = (value - grid[index]) / (grid[index + 1] - grid[index]);
        (index, share.clamp(0.0, 1.0))
    };
    // Counting has no branch to be foreseen.
    if grid.len() <= FEW {
        return share(grid[1..=last].iter().map(|point| usize::from(*point <= value)).sum());
    }
    // Most grids are even or nearly so: where they would have it is looked at first.
    let (first, end) = (grid[0], grid[last + 1]);
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a guess; below the grid and no number at all become 0"
    )]
    let guess = (((value - first) / (end - first) * (last + 1) as f64) as usize).min(last);
    let holds = grid[guess] <= value && value < grid[guess + 1];
    let index = if holds {
        guess
    } else if grid.len() <= SHORT {
        grid.iter().map(|point| usize::from(*point <= value)).sum::<usize>().saturating_sub(1).min(last)
    } else {
        grid.partition_point(|point| *point <= value).saturating_sub(1).min(last)
    };
    share(index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_is_found_and_ends_are_kept() {
        let root = crossing(0.0, 4.0, |x| x * x - 2.0);
        assert!((root - 2f64.sqrt()).abs() < 1e-9);
        assert_eq!((crossing(3.0, 4.0, |x| x - 1.0), crossing(0.0, 0.5, |x| x - 1.0)), (3.0, 0.5));
        // Backwards too: from 4 down to 0 the function 2 − x rises.
        assert!((crossing(4.0, 0.0, |x| 2.0 - x) - 2.0).abs() < 1e-9);
    }

    #[test]
    fn values_find_their_place_on_a_grid() {
        let grid = [0.0, 1.0, 3.0];
        assert_eq!(place(&grid, 2.0), (1, 0.5));
        assert_eq!(place(&grid, -1.0), (0, 0.0));
        assert_eq!(place(&grid, 3.0), (1, 1.0));
        assert_eq!((place(&grid, 7.0), place(&[0.0, 0.1, 0.2, 10.0], 0.15).0), ((1, 1.0), 1));
    }

    #[test]
    fn grids_that_do_not_increase_are_refused() {
        assert!(increasing("x", &[0.0, 0.0], 2).unwrap_err().to_string().contains("0 after 0"));
        assert!(increasing("x", &[0.0], 2).unwrap_err().to_string().contains("1 values"));
        assert!(increasing("x", &[0.0, f64::NAN], 2).is_err());
    }
}
