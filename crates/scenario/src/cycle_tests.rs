//! What a cycle says, and what a mistake in it gets.

use crate::{Scenario, ScenarioError};
use headland_plugin::Mode;
use headland_sim::{EngineSpeed, Phase, Setting, Until};
use std::path::Path;

const GOOD: &str = r#"(
    about: "ploughing up and down",
    vehicle: (mass_kg: "9 t", rotating_mass_kg: 0, drag_area_m2: 6, driveline: Neutral),
    ground: (terrain: Flat, soil: Constant(coefficient: 0.08)),
    air: (density_kg_m3: 1.2),
    tasks: [PtoPower(power_w: "2 kW")],
    cycle: (
        tasks: {
            "plough": Tillage(implement: "moldboard plough", texture: Fine, width_m: 2, depth_m: "25 cm"),
            "tank": Spreader(power: (a: 0, b: 0, c: 0), width_m: 2, dose_kg_per_m2: 0.01, capacity_kg: 500,
                             initial_kg: 100, fill_rate_kg_s: 5),
        },
        phases: [
            Reach(speed_m_s: "7 km/h", acceleration_m_s2: 0.5),
            With(name: "field", work: ["PtoPower"], engine_speed_rad_s: "1800 rpm", phases: [
                Repeat(times: 2, phases: [
                    Drive(name: "furrow", speed_m_s: "7 km/h", acceleration_m_s2: 0.5, work: ["plough"],
                          until: [Travelled(distance_m: 300), PayloadBelow(task: "tank", mass_kg: 1)]),
                    [Drive(speed_m_s: 1, acceleration_m_s2: 0.5, until: Elapsed(for_s: 12))],
                ]),
            ]),
            Stand(fill: ["tank"], when: [PayloadBelow(task: "tank", mass_kg: 50)],
                  until: PayloadAbove(task: "tank", mass_kg: "0.5 t")),
        ],
    ),
    driver: Pi(gain_per_s: 0.8, integral_per_s2: 0.1, integral_limit_m_s2: 3, preview_s: 1),
    simulation: (fidelity: Longitudinal, step_s: 0.05),
)"#;

fn read(text: &str) -> Result<Scenario, ScenarioError> {
    Scenario::of_text("test.ron", text, Path::new(""), &headland_stock::registry())
}

/// The message that follows when one piece is another, and whether its carets stand below `below`.
fn broken(from: &str, to: &str, below: &str) -> String {
    assert!(GOOD.contains(from), "`{from}` is not in the scenario");
    let error = read(&GOOD.replacen(from, to, 1)).expect_err("the change is a mistake");
    let at = error.location().expect("it lies somewhere");
    let meant: String = at.excerpt.chars().skip(at.column - 1).collect();
    assert!(meant.starts_with(below), "carets below `{meant}`, expected `{below}`: {}", error.told());
    error.told()
}

fn parts(phase: &Phase) -> (&Setting, &Phase) {
    match phase {
        Phase::With { setting, phase } => (setting, phase),
        other => panic!("{other:?}"),
    }
}

#[test]
fn nested_phases_flatten_to_a_plan_and_take_on_what_is_said_around_them() {
    let scenario = read(GOOD).unwrap();
    let phases = &scenario.cycle.as_ref().unwrap().phases;
    assert_eq!(phases.len(), 6);
    let (setting, furrow) = parts(&phases[3]);
    assert_eq!(setting.name.as_deref(), Some("field, furrow"));
    let tasks = setting.tasks.as_ref().unwrap();
    assert_eq!(tasks, &[("PtoPower".to_owned(), Mode::Work), ("plough".to_owned(), Mode::Work)]);
    assert!(matches!(&setting.engine_speed, EngineSpeed::Kept(speed) if (speed - 188.4956).abs() < 1e-3));
    let below = Until::StateBelow { state: "tank_payload_kg".to_owned(), value: 1.0 };
    let until = Until::Any(vec![Until::Travelled(300.0), below]);
    assert!(matches!(furrow, Phase::Drive { until: found, .. } if *found == until));
    // The headland lies in a list of its own, within the same surroundings.
    assert_eq!(parts(&phases[4]).0.tasks.as_ref().unwrap().len(), 1);
    let (setting, stand) = parts(&phases[5]);
    assert_eq!(setting.tasks.as_ref().unwrap()[0].1, Mode::Fill);
    assert_eq!(setting.guards.len(), 1);
    let above = Until::StateAbove { state: "tank_payload_kg".to_owned(), value: 500.0 };
    assert_eq!(*stand, Phase::Stand { until: above });
    // No phase says that anything works here, though others do: so nothing does.
    assert_eq!(parts(&phases[0]).0.tasks, Some(Vec::new()));
    assert!(phases.iter().all(|phase| parts(phase).0.driver.is_some()));
}

#[test]
fn tasks_have_names_of_ones_own_and_numbers_that_a_path_leads_to() {
    let scenario = read(GOOD).unwrap();
    let deeper = scenario.with(&[("cycle.tasks.plough.depth_m", 0.3)], &headland_stock::registry());
    assert_eq!(deeper.unwrap().document().number("cycle.tasks.plough.depth_m"), Some(0.3));
    let names: Vec<_> = scenario
        .model(&headland_stock::registry())
        .unwrap()
        .tasks
        .into_iter()
        .map(|task| task.name)
        .collect();
    assert_eq!(names, ["PtoPower", "plough", "tank"]);
}

#[test]
fn names_that_stand_for_nothing_are_told_with_those_that_do() {
    let told = broken("work: [\"plough\"]", "work: [\"plow\"]", "\"plow\"");
    assert!(
        told.contains("no task is named `plow`") && told.contains("known: PtoPower, plough, tank"),
        "{told}"
    );
    let told = broken(
        "PayloadBelow(task: \"tank\", mass_kg: 1)",
        "PayloadBelow(task: \"plough\", mass_kg: 1)",
        "\"plough\"",
    );
    assert!(told.contains("known: tank"), "{told}");
    let told = broken("Travelled(distance_m: 300)", "Mark(name: \"turn\")", "\"turn\"");
    assert!(told.contains("no mark of the terrain"), "{told}");
    let told = broken("Travelled(distance_m: 300)", "ChargeBelow(state_of_charge: 0.2)", "ChargeBelow");
    assert!(told.contains("no battery"), "{told}");
    let told = broken("Travelled(distance_m: 300)", "Traveled(distance_m: 300)", "Traveled");
    assert!(told.contains("did you mean `Travelled`?"), "{told}");
    let told = broken("Stand(fill", "Stay(fill", "Stay");
    assert!(told.contains("did you mean"), "{told}");
}

#[test]
fn fields_that_do_not_exist_or_lack_are_told_where_they_stand() {
    let told = broken("work: [\"plough\"]", "wrok: [\"plough\"]", "wrok");
    assert!(told.contains("did you mean `work`?"), "{told}");
    let told = broken("speed_m_s: 1, acceleration_m_s2: 0.5, until", "speed_m_s: 1, until", "Drive");
    assert!(told.contains("`acceleration_m_s2`"), "{told}");
    let told = broken("acceleration_m_s2: 0.5, until", "acceleration_m_s2: -0.5, until", "-0.5");
    assert!(told.contains("more than 0"), "{told}");
    let told = broken("\"tank\": Spreader", "\"a tank\": Spreader", "\"a tank\"");
    assert!(told.contains("letters, digits"), "{told}");
    let told = broken("\"plough\": Tillage(implement", "\"PtoPower\": Tillage(implement", "");
    assert!(told.contains("a name of its own"), "{told}");
    let told =
        broken("when: [PayloadBelow(task: \"tank\", mass_kg: 50)]", "when: [Elapsed(for_s: 5)]", "[Elapsed");
    assert!(told.contains("at an instant"), "{told}");
    let told = broken("preview_s: 1)", "preview: 1)", "preview");
    assert!(told.contains("preview_s"), "{told}");
    let told = broken("implement: \"moldboard plough\"", "implement: \"plough\"", "\"plough\"");
    assert!(told.contains("moldboard plough"), "{told}");
}

#[test]
fn a_recorded_drive_is_followed_from_its_first_sample() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.csv");
    std::fs::write(&path, "time_s,gear,speed_m_s\n100,1,0\n101.5,1,2\n103,2,3.5\n").unwrap();
    let text = GOOD.replacen(
        "[Drive(speed_m_s: 1, acceleration_m_s2: 0.5, until: Elapsed(for_s: 12))]",
        "Follow(file: \"drive.csv\")",
        1,
    );
    let read = || Scenario::of_text("test.ron", &text, folder.path(), &headland_stock::registry());
    let scenario = read().unwrap();
    let (_, phase) = parts(&scenario.cycle.as_ref().unwrap().phases[2]);
    assert_eq!(*phase, Phase::Follow { profile: vec![(0.0, 0.0), (1.5, 2.0), (3.0, 3.5)] });
    std::fs::write(&path, "time_s,speed_m_s\n0,1\n1,fast\n").unwrap();
    assert!(read().unwrap_err().to_string().contains("`fast` in line 3"));
    std::fs::write(&path, "time_s,speed_m_s\n0,1\n0,2\n").unwrap();
    assert!(read().unwrap_err().to_string().contains("increasing"));
}

/// A cycle of nothing ran for no time and was told as done.
#[test]
fn a_cycle_that_drives_nothing_is_refused() {
    let told = |cycle: &str| {
        let (begin, end) = (GOOD.find("    cycle: (").unwrap(), GOOD.find("    driver: Pi").unwrap());
        let text = format!("{}    cycle: {cycle},\n{}", &GOOD[..begin], &GOOD[end..]);
        read(&text).map_or_else(
            |error| {
                let at = error.location().expect("it lies somewhere");
                format!("{} {}:{}", error.told(), at.line, at.column)
            },
            |_| "fine".to_owned(),
        )
    };
    assert_eq!(told("[Repeat(times: 1, phases: [Hold(for_s: 1)])]"), "fine");
    let never = told("[Repeat(times: 0, phases: [Hold(for_s: 1)])]");
    assert!(never.contains("`times` is 0, expected 1 or more") && never.ends_with("7:27"), "{never}");
    let nothing = told("[]");
    assert!(nothing.contains("one phase or more") && nothing.ends_with("7:12"), "{nothing}");
    let nothing = told("[Hold(for_s: 1), Repeat(times: 2, phases: [])]");
    assert!(nothing.contains("one phase or more") && nothing.ends_with("7:54"), "{nothing}");
}

/// They were told in the words of the reader of RON: raw identifiers, and half of the line.
#[test]
fn values_without_their_names_are_told_in_words_of_the_scenario() {
    let told = broken("Travelled(distance_m: 300)", "Travelled(300)", "300)");
    assert!(told.contains("found `300`") && told.contains("a field with its name"), "{told}");
    let told = broken("work: [\"plough\"]", "work: 1", "1");
    assert!(!told.contains("identifier"), "{told}");
}
