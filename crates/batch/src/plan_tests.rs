//! Plans: what numbers stand for, and what cannot be planned.

use crate::{BatchError, Comparison, Plan, Setting, Status, run};
use std::path::Path;

const COMPARISON: &str = r#"(
    about: "carts",
    variants: [
        (name: "light", vehicle: (name: "cart", mass_kg: 500, rotating_mass_kg: 0, drag_area_m2: 1, driveline: Neutral)),
        (name: "heavy", with: (mass_kg: "1 t"), vehicle: (name: "cart", mass_kg: 500, rotating_mass_kg: 0, drag_area_m2: 1, driveline: Neutral)),
    ],
    cycles: [(name: "roll", cycle: [Coast(until: Elapsed(for_s: 2))]), (name: "stop", cycle: [Coast(until: Stopped)])],
    grounds: [(name: "road", ground: (terrain: Flat, soil: Constant(coefficient: 0.02)))],
    air: (density_kg_m3: 1.2),
    start: (position_m: 0, speed_m_s: 1),
    sweep: {"ground.soil.coefficient": [0.02, 0.04, -0.1]},
    repeat: (times: 2, seed: 5, scatter: {"start.speed_m_s": Within(0.1)}),
    simulation: (fidelity: Longitudinal, step_s: 0.05),
)"#;

fn plan(text: &str) -> Result<Plan, BatchError> {
    Plan::new(Comparison::of_text("test.ron", text, Path::new(""))?, &headland_stock::registry(), 1)
}

#[test]
fn a_number_says_everything_about_a_run() {
    let plan = plan(COMPARISON).unwrap();
    assert_eq!(plan.total(), 2 * 2 * 3 * 2);
    for number in 0..plan.total() {
        let spec = plan.spec(number);
        assert_eq!(plan.number(spec), number);
    }
    let last = plan.spec(23);
    assert_eq!((last.variant, last.cycle, last.ground, last.point, last.repetition), (1, 1, 0, 2, 1));
    let document = plan.document(plan.spec(12)).unwrap();
    assert_eq!(document.number("vehicle.mass_kg"), Some(1000.0));
}

/// A repetition meets the same scatter in every variant, cycle and point; another one does not.
#[test]
fn repetitions_scatter_alike_in_all_configurations() {
    let plan = plan(COMPARISON).unwrap();
    let speed = |number: u64| match &plan.settings(plan.spec(number))[1] {
        Some(Setting::Number(value)) => *value,
        other => panic!("{other:?}"),
    };
    assert_eq!(plan.columns(), ["ground.soil.coefficient", "start.speed_m_s"]);
    let (first, second) = (speed(0), speed(1));
    assert!(first != second && (first - 1.0).abs() <= 0.1);
    for number in 0..plan.total() {
        assert_eq!(speed(number), if number % 2 == 0 { first } else { second });
    }
}

#[test]
fn a_value_that_is_not_physical_is_a_row_with_its_error() {
    let plan = plan(COMPARISON).unwrap();
    let registry = headland_stock::registry();
    let (row, trace) = run(&plan, &registry, 4);
    assert_eq!((row.status, trace.is_none(), row.values.len()), (Status::Refused, true, 0));
    assert!(row.error.contains("`coefficient` is -0.1"), "{}", row.error);
    let (row, _) = run(&plan, &registry, 0);
    assert_eq!(row.status, Status::Finished);
    assert!((row.value("time_s") - 2.0).abs() < 1e-9);
}

/// One vehicle that is not physical: its runs are rows with the reason, those of the other are run.
#[test]
fn a_combination_that_is_not_physical_leaves_the_others() {
    let plan = plan(&COMPARISON.replacen("mass_kg: 500", "mass_kg: -5", 1)).unwrap();
    let refused: Vec<String> = plan.refused().map(|(of, error)| format!("{of}: {error}")).collect();
    assert_eq!(refused.len(), 2);
    assert!(
        refused[0].contains("variant `light`, cycle `roll`, ground `road`: `mass_kg` is -5"),
        "{refused:?}"
    );
    assert_eq!(plan.refused().next().unwrap().1.location().unwrap().line, 4);
    let registry = headland_stock::registry();
    let (row, _) = run(&plan, &registry, 0);
    assert_eq!(row.status, Status::Refused);
    assert!(row.error.contains("`mass_kg` is -5"), "{}", row.error);
    assert_eq!(run(&plan, &registry, 12).0.status, Status::Finished);
}

#[test]
fn a_comparison_that_has_no_combination_to_run_is_refused() {
    let text = COMPARISON.replacen("mass_kg: 500", "mass_kg: -5", 1).replace("\"1 t\"", "-1");
    let BatchError::Combination { of, error } = plan(&text).unwrap_err() else { panic!("it was planned") };
    assert!(of.contains("variant `light`") && error.to_string().contains("`mass_kg` is -5"), "{of}: {error}");
}

#[test]
fn seeds_of_models_change_with_the_repetition_and_not_with_the_variant() {
    let text = COMPARISON.replace("air:", "tasks: [(seed: 4)], air:");
    let comparison = Comparison::of_text("test.ron", &text, Path::new("")).unwrap();
    let document =
        comparison.scenario(&comparison.variants[0], &comparison.cycles[0], &comparison.grounds[0]).unwrap();
    assert_eq!(crate::combine::seeds(&document).iter().map(|(_, seed)| *seed).collect::<Vec<_>>(), [4.0]);
}

#[test]
fn mistakes_are_refused_where_they_stand() {
    for (from, to, told, line) in [
        ("\"heavy\"", "\"light\"", "\"light\" for the second time", 5),
        ("with: (mass_kg:", "with: {\"vehicle.mass\":", "not there in variant `heavy`", 5),
        ("with: (mass_kg:", "with: (mass:", "`vehicle` has no field `mass`", 5),
        ("{\"ground.soil.coefficient\": [", "{\"ground.soil.c\": [", "not there in variant `light`", 11),
        ("times: 2", "times: 0", "`times` is 0", 12),
        ("{\"start.speed_m_s\"", "{\"ground.soil\"", "no number", 12),
        ("air:", "vehicle: (mass_kg: 1), air:", "given by variant `light` and by the comparison", 4),
        ("repeat:", "report: (baseline: \"middle\"), repeat:", "no variant is named `middle`", 12),
    ] {
        let text =
            COMPARISON.replacen(from, to, 1).replace("{\"vehicle.mass\": \"1 t\")", "{\"vehicle.mass\": 1}");
        let error = plan(&text).unwrap_err();
        assert!(error.to_string().contains(told), "{to}: {error}");
        let (BatchError::Scenario(error) | BatchError::Combination { error, .. }) = error else {
            panic!("{told}")
        };
        assert_eq!(error.location().unwrap().line, line, "{to}");
    }
    let missing = COMPARISON.replace("cycles:", "candidates: [], // cycles:");
    assert!(plan(&missing).unwrap_err().to_string().contains("lacks the field `cycles`"));
    let many = COMPARISON.replace("times: 2", "times: 4000000");
    assert!(matches!(plan(&many), Err(BatchError::TooMany { found: 48_000_000, .. })));
}

#[test]
fn an_entry_without_a_name_is_called_by_its_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("stony_field.ron"),
        "// stones\n(terrain: Flat, soil: Constant(coefficient: 0.1))",
    )
    .unwrap();
    let text = "(about: \"x\", grounds: [include(\"stony_field.ron\"), (name: \"b\", ground: include(\"stony_field.ron\"))])";
    let comparison = Comparison::of_text("test.ron", text, folder.path()).unwrap();
    assert_eq!(
        comparison.grounds.iter().map(|one| one.name.as_str()).collect::<Vec<_>>(),
        ["stony field", "b"]
    );
    let nameless = "(about: \"x\", grounds: [(terrain: Flat)])";
    assert!(Comparison::of_text("test.ron", nameless, folder.path()).is_err());
}
