use super::*;
use std::path::Path;

fn read(text: &str) -> Result<Points, ScenarioError> {
    Points::read(&Document::of_text("test.ron", text, Path::new("")).unwrap())
}

fn numbers(points: &Points, seed: u64) -> Vec<Vec<Option<f64>>> {
    let strata = points.strata(seed);
    let count = u64::try_from(points.len()).unwrap();
    (0..count)
        .map(|point| {
            points
                .at(point, seed, &strata)
                .iter()
                .map(|one| one.as_ref().map(|text| text.parse().unwrap()))
                .collect()
        })
        .collect()
}

#[test]
fn a_sweep_is_every_combination_in_the_units_of_its_paths() {
    let points = read("(sweep: {\"a.mass_kg\": [\"1 t\", 1200], \"b\": Range(0.1, 0.3, 3)})").unwrap();
    assert_eq!(
        numbers(&points, 1),
        [[1000.0, 0.1], [1000.0, 0.2], [1000.0, 0.3], [1200.0, 0.1], [1200.0, 0.2], [1200.0, 0.3]]
            .map(|row| row.map(Some).to_vec())
    );
}

/// Every stratum of every parameter is met once: that is what makes it a Latin hypercube.
#[test]
fn each_stratum_of_each_parameter_is_met_once() {
    let points = read("(sample: (count: 40, seed: 3, of: {\"a\": (0, 40), \"b\": (-20, 20)}))").unwrap();
    let rows = numbers(&points, 1);
    for (column, from) in [(0, 0.0), (1, -20.0)] {
        let mut strata: Vec<f64> = rows.iter().map(|row| (row[column].unwrap() - from).floor()).collect();
        strata.sort_by(f64::total_cmp);
        assert_eq!(strata, (0..40).map(f64::from).collect::<Vec<_>>());
    }
    assert_eq!(rows, numbers(&points, 1));
    assert_ne!(rows, numbers(&points, 2));
}

#[test]
fn a_logarithmic_range_has_as_many_below_as_above_its_geometric_mean() {
    let points = read("(sample: (count: 100, seed: 1, of: {\"a\": Logarithmic(1, 100)}))").unwrap();
    let below = numbers(&points, 1).iter().filter(|row| row[0].unwrap() < 10.0).count();
    assert_eq!(below, 50);
}

/// A range of thousands of millions of values was laid out in memory before anybody counted the runs.
#[test]
fn what_moves_nothing_or_more_than_memory_holds_is_refused() {
    let refused = |text: &str| read(text).unwrap_err().to_string();
    for text in ["(sweep: {})", "(vary: {})", "(sample: (count: 3, seed: 1, of: {}))"] {
        assert!(refused(text).contains("expected one path or more"), "{text}: {}", refused(text));
    }
    let many = refused("(sweep: {\"a\": Range(0, 1, 4000000000)})");
    assert!(many.contains("a count from 2 to 1000000"), "{many}");
    let back = refused("(vary: {\"a\": (2, 1)})");
    assert!(back.contains("is (2, 1), expected two numbers, low below high"), "{back}");
}

#[test]
fn one_parameter_is_varied_at_a_time_and_the_first_point_is_as_written() {
    let points = read("(vary: {\"a\": (1, 2), \"b\": (3, 4)})").unwrap();
    let expected: [[Option<f64>; 2]; 5] =
        [[None, None], [Some(1.0), None], [Some(2.0), None], [None, Some(3.0)], [None, Some(4.0)]];
    assert_eq!(numbers(&points, 1), expected.map(|row| row.to_vec()));
    assert_eq!((points.end_of(0), points.end_of(3)), (None, Some((1, 0))));
}

#[test]
fn what_makes_no_points_is_refused() {
    for text in [
        "(sweep: {\"a\": []})",
        "(sweep: {\"a\": Range(1, 2, 1)})",
        "(sweep: {\"a\": Range(1, 1, 3)})",
        "(sweep: [1])",
        "(sample: (count: 0, seed: 1, of: {\"a\": (1, 2)}))",
        "(sample: (count: 5, seed: 1, of: {\"a\": (2, 1)}))",
        "(sample: (count: 5, seed: 1, of: {\"a\": Logarithmic(0, 1)}))",
        "(sample: (count: 5, of: {\"a\": (1, 2)}))",
        "(vary: {\"a\": (1, 2, 3)})",
        "(sweep: {\"a.b\": [1]}, vary: {\"a.b\": (1, 2)})",
        "(sweep: {\"a\": [1]}, vary: {\"a.b\": (1, 2)})",
    ] {
        assert!(read(text).is_err(), "{text}");
    }
}
