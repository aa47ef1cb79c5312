//! Values that change along a path or over time: straight between points, or in steps.

use headland_plugin::Refusal;

/// The value at `x` of the line through the points, constant beyond its ends; `xs` increase.
pub(crate) fn linear(xs: &[f64], ys: &[f64], x: f64) -> f64 {
    let next = xs.partition_point(|point| *point <= x);
    match (next.checked_sub(1), next < xs.len()) {
        (None, _) => ys[0],
        (Some(before), false) => ys[before],
        (Some(before), true) => {
            let share = (x - xs[before]) / (xs[next] - xs[before]);
            ys[before] + share * (ys[next] - ys[before])
        }
    }
}

/// The value of the interval that holds `x`, 0 outside; `edges` increase and are one more than the values.
pub(crate) fn step(edges: &[f64], values: &[f64], x: f64) -> f64 {
    let next = edges.partition_point(|edge| *edge <= x);
    next.checked_sub(1).and_then(|interval| values.get(interval)).copied().unwrap_or(0.0)
}

/// Checks the points of a line.
pub(crate) fn check_line(x: (&str, &[f64]), y: (&str, &[f64])) -> Result<(), Refusal> {
    check(x, y, x.1.len().max(1), "as many as positions or times, at least one")
}

/// Checks edges and values of steps; both may be empty.
pub(crate) fn check_steps(x: (&str, &[f64]), y: (&str, &[f64])) -> Result<(), Refusal> {
    check(x, y, x.1.len().saturating_sub(1), "one less than edges")
}

fn check(x: (&str, &[f64]), y: (&str, &[f64]), values: usize, expected: &str) -> Result<(), Refusal> {
    for (name, numbers) in [x, y] {
        if let Some(number) = numbers.iter().find(|number| !number.is_finite()) {
            return Err(refuse(name, &number.to_string(), "finite numbers"));
        }
    }
    if let Some(at) = x.1.windows(2).position(|pair| pair[1] <= pair[0]) {
        return Err(refuse(x.0, &format!("{} after {}", x.1[at + 1], x.1[at]), "numbers that increase"));
    }
    if y.1.len() == values {
        Ok(())
    } else {
        Err(refuse(y.0, &format!("{} values beside {} of `{}`", y.1.len(), x.1.len(), x.0), expected))
    }
}

pub(crate) fn refuse(parameter: &str, found: &str, expected: &str) -> Refusal {
    Refusal { parameter: parameter.to_owned(), found: found.to_owned(), expected: expected.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_straight_between_its_points_and_constant_beyond() {
        let (xs, ys) = ([0.0, 10.0, 30.0], [1.0, 3.0, -1.0]);
        for (x, y) in
            [(-5.0, 1.0), (0.0, 1.0), (5.0, 2.0), (10.0, 3.0), (20.0, 1.0), (30.0, -1.0), (99.0, -1.0)]
        {
            assert_eq!(linear(&xs, &ys, x), y, "{x}");
        }
    }

    #[test]
    fn steps_hold_from_edge_to_edge_and_are_nothing_outside() {
        let (edges, values) = ([0.0, 10.0, 30.0], [1.0, 3.0]);
        for (x, y) in [(-1.0, 0.0), (0.0, 1.0), (9.9, 1.0), (10.0, 3.0), (29.9, 3.0), (30.0, 0.0)] {
            assert_eq!(step(&edges, &values, x), y, "{x}");
        }
        assert_eq!(step(&[], &[], 3.0), 0.0);
    }

    #[test]
    fn series_that_do_not_fit_are_refused_by_name() {
        let message = |result: Result<(), Refusal>| result.unwrap_err().to_string();
        assert!(message(check_line(("x_m", &[1.0, 1.0]), ("y", &[0.0, 0.0]))).contains("`x_m` is 1 after 1"));
        assert!(message(check_line(("x_m", &[]), ("y", &[]))).contains("`y` is 0 values"));
        assert!(message(check_line(("x_m", &[1.0]), ("y", &[f64::NAN]))).contains("finite"));
        assert!(message(check_steps(("x_m", &[1.0, 2.0]), ("y", &[0.0, 0.0]))).contains("one less"));
        assert!(check_steps(("x_m", &[]), ("y", &[])).is_ok());
    }
}
