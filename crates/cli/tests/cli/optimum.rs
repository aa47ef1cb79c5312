//! `headland optimum`: the least fuel of a course, and what has none.

use super::help::{Place, headland};
use std::process::Command;

const VEHICLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/vehicles");

fn scenario(management: &str, cycle: &str) -> String {
    format!(
        "(about: \"a hill\", vehicle: include(\"{VEHICLES}/xerion_3800_parallel.ron\"),
          ground: (terrain: Profile(heading_rad: 0, points: [
              (position_m: -10, elevation_m: 0), (position_m: 100, elevation_m: 4), (position_m: 300, elevation_m: 0),
          ]), soil: Constant(coefficient: 0.05)),
          air: (density_kg_m3: 1.2), start: (position_m: 0, speed_m_s: 3),
          runs: [(id: \"managed\", with: {{\"vehicle.management\": {management}}})],
          cycle: {cycle}, simulation: (fidelity: Longitudinal, step_s: 0.1))"
    )
}

fn optimum(place: &Place, text: &str, more: &[&str]) -> (Option<i32>, String, String) {
    place.write("it.ron", text);
    let mut command: Command = headland();
    command.args(["optimum", &place.path("it.ron"), "--out", &place.path("out")]).args(more);
    let output = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

const LEVELLING: &str =
    "LoadLevelling(time_constant_s: 8, target_charge: 0.55, charge_gain_w: 400e3, initial_power_w: 20e3)";

#[test]
fn no_management_takes_less_than_the_least_and_what_both_did_is_kept() {
    let place = Place::new();
    let (code, told, noted) =
        optimum(&place, &scenario(LEVELLING, "[Hold(for_s: 40)]"), &["--charges", "161"]);
    assert_eq!(code, Some(0), "{told}{noted}");
    assert!(told.contains("the least that ends at the same charge"), "{told}");
    let summary = place.json("out/summary.json");
    let run = &summary["runs"][0];
    let number = |name: &str| run[name].as_f64().unwrap();
    assert_eq!((run["id"].as_str(), run["steps"].as_u64()), (Some("managed"), Some(40)));
    assert!(number("least_fuel_j") > 0.0 && number("above_least") > -0.002, "{run}");
    let (end, least_end) = (run["charges"][1].as_f64().unwrap(), run["charges"][2].as_f64().unwrap());
    assert!(least_end > end - 5e-4, "{end} {least_end}");
    let trace = &headland_trace::read_parquet(std::path::Path::new(&place.path("out/optimum.parquet")))
        .unwrap()[0]
        .trace;
    assert!(trace.get("least_engine_power_w").unwrap().len() == 40);
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("Power of the engine") && page.contains("State of charge"));
}

#[test]
fn what_has_no_optimum_is_refused_by_name() {
    let place = Place::new();
    let whole = scenario(LEVELLING, "[Hold(for_s: 5)]");
    for (options, told) in [
        (["--step", "0"], "--step is 0, expected seconds"),
        (["--step", "60"], "the course has no step"),
        (["--charges", "2"], "--charges is 2, expected 3 or more"),
        (["--levels", "0"], "--levels is 0, expected 1 or more"),
    ] {
        let (code, _, noted) = optimum(&place, &whole, &options);
        assert_eq!(code, Some(2), "{noted}");
        assert!(noted.contains(told), "{noted}");
    }
    let plain = whole
        .replace("xerion_3800_parallel", "xerion_3800_cvt")
        .replace(&format!("runs: [(id: \"managed\", with: {{\"vehicle.management\": {LEVELLING}}})],"), "");
    let (code, _, noted) = optimum(&place, &plain, &[]);
    assert_eq!(code, Some(2), "{noted}");
    assert!(noted.contains("expected a hybrid"), "{noted}");
    let hopeless = scenario(LEVELLING, "[Hold(for_s: 200)]");
    let (code, _, noted) = optimum(&place, &hopeless, &[]);
    assert_eq!(code, Some(1), "{noted}");
    assert!(noted.contains("could not be driven to its end") && noted.contains("the path ends"), "{noted}");
}
