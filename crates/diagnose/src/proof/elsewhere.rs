//! The scenario for runs elsewhere: the vehicle as it is known now.
//!
//! Slopes belong to their path, consumers that are switched and brakes to their run; what was found of the vehicle goes along to
//! the next road. So do the widths of what is free: a rotor or a tyre is the same in the next run, and known as well as these
//! runs tell it. What a run loads and what it drives on may be another, and stays as free as it was stated.

use crate::proof::prove::{by_path, text};
use crate::proof::refine::{Free, HALF_95, Refined};
use crate::{Case, DiagnoseError};

/// The improved scenario without what belongs to one path or to one run; none where nothing does.
pub fn elsewhere(case: &Case, refined: &Refined) -> Result<Option<String>, DiagnoseError> {
    if !by_path(refined) {
        return Ok(None);
    }
    let paths = case.study.paths();
    let mut changes: Vec<(String, f64)> = paths.iter().cloned().zip(refined.values()).collect();
    let document = case.study.scenario().document();
    for (index, (path, free)) in paths.iter().zip(&refined.free).enumerate() {
        let stated = format!("free.{index}.sd");
        let narrower = document.number(&stated).and_then(|sd| narrower(path, free, sd));
        changes.extend(narrower.map(|sd| (stated, sd)));
    }
    let changes: Vec<(&str, f64)> = changes.iter().map(|(path, value)| (path.as_str(), *value)).collect();
    let mut document = document.with(&changes)?;
    for cured in &refined.causes {
        if cured.function().is_none() && !cured.in_single_runs() {
            // Any run will do: what is written is the same for all of them.
            if let Some(effect) = text(case, cured, 0) {
                document = document.with_effect(&effect)?;
            }
        }
    }
    Ok(Some(document.text().to_owned()))
}

/// How well a free parameter is known in the next run, where that is better than it was stated and may be carried over.
fn narrower(path: &str, free: &Free, stated_sd: f64) -> Option<f64> {
    let of_vehicle = path.starts_with("vehicle.") && path != "vehicle.mass_kg";
    let sd = (free.ci95[1] - free.ci95[0]) / (2.0 * HALF_95);
    (of_vehicle && sd > 0.0 && sd < stated_sd).then_some(sd)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotor_is_known_as_well_as_it_was_told_and_a_load_as_well_as_it_was_stated() {
        let free = |sd: f64| Free {
            name: String::new(),
            prior: 60.0,
            value: 200.0,
            ci95: [200.0 - HALF_95 * sd, 200.0 + HALF_95 * sd],
            asked: 200.0,
        };
        let rotor = "vehicle.driveline.rotating_mass_kg";
        assert!((narrower(rotor, &free(30.0), 80.0).unwrap() - 30.0).abs() < 1e-9);
        assert_eq!(narrower(rotor, &free(90.0), 80.0), None);
        assert_eq!(narrower("vehicle.mass_kg", &free(30.0), 80.0), None);
        assert_eq!(narrower("ground.soil.coefficient", &free(30.0), 80.0), None);
    }
}
