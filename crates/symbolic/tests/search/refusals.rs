//! What is refused.

use crate::plant::{Made, Plant};
use crate::recovery::options;
use headland_symbolic::{Problem, SymbolicError, Target, find};

fn made() -> Made {
    Plant::new(1, 3, 100.0).problem(1, |_| 0.0)
}

fn refused(made: &Made) -> SymbolicError {
    find(&made.problem(), &options(), &|| false).unwrap_err()
}

#[test]
fn a_name_that_could_be_made_of_the_target_is_refused() {
    for name in ["a", "force", "tractive_force_n", "specific_force_m_s2"] {
        let mut made = made();
        made.variables[0].name = name.to_owned();
        let error = refused(&made);
        assert!(matches!(error, SymbolicError::Unknown { .. }), "{error}");
        assert!(error.to_string().contains("explain nothing"), "{error}");
    }
}

#[test]
fn units_that_do_not_fit_are_refused() {
    let mut wrong = made();
    wrong.variables[0].unit = "km/h".to_owned();
    assert_eq!(refused(&wrong).to_string(), "`v` is in `km/h`, expected m/s");
    assert!(Target::of_unit("N m").is_err() && Target::of_unit("W") == Ok(Target::Power));
}

#[test]
fn what_has_gaps_or_another_length_is_refused() {
    let mut gap = made();
    gap.variables[1].runs[0][5] = f64::NAN;
    assert!(matches!(refused(&gap), SymbolicError::NotFinite { run: 0, .. }));
    let mut short = made();
    short.variables[1].runs[2].pop();
    assert!(matches!(refused(&short), SymbolicError::Length { run: 2, .. }));
    let mut prior = made();
    prior.nuisances[1].sd = 0.0;
    assert!(matches!(refused(&prior), SymbolicError::Prior { index: 1, .. }));
}

#[test]
fn too_few_rows_are_refused() {
    let mut few = made();
    few.fit = vec![false; 3];
    assert!(matches!(refused(&few), SymbolicError::TooFew { rows: 0, nuisances: 3 }));
}

#[test]
fn an_interruption_ends_the_search() {
    let made = made();
    assert_eq!(find(&made.problem(), &options(), &|| true).unwrap_err(), SymbolicError::Interrupted);
}

#[test]
fn without_variables_nothing_is_found() {
    let made = made();
    let problem = Problem { variables: &[], ..made.problem() };
    assert!(find(&problem, &options(), &|| false).unwrap().law().is_none());
}
