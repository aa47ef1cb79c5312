//! What a scenario file looks like: the forms of its parts, found out from the types that read them.

use crate::axles::{BOUNDS as OF_AN_AXLE, TYRE_BOUNDS as OF_A_TYRE};
use crate::body::{AXLE_BOUNDS as OF_AN_AXLE_OF_THE_BODY, BOUNDS as OF_THE_BODY};
use crate::cycle::forms::{cycle, driver, phase};
use crate::form_about::{ABOUT, BESIDE};
use crate::schema::ScenarioFile;
use crate::trailer::{TRAILER_AXLE_BOUNDS as OF_AN_AXLE_OF_THE_TRAILER, TRAILER_BOUNDS as OF_THE_TRAILER};
use crate::until::UntilFile;
use headland_plugin::{Bound, Form, form_of};

/// A part of scenarios that other parts name.
#[derive(Clone, Debug)]
pub struct Definition {
    /// As [`Form::Named`] names it.
    pub name: &'static str,
    /// What it looks like.
    pub form: Form,
    /// What its fields are.
    pub notes: Vec<Note>,
}

/// What a field is.
#[derive(Clone, Copy, Debug)]
pub struct Note {
    /// Dotted path from the definition; lists are looked through, variants are a step of it. What any phase may say beside
    /// is told without its variant.
    pub path: &'static str,
    /// In words; its unit ends its name.
    pub about: &'static str,
    /// What its numbers have to be.
    pub bound: Bound,
}

/// Parts of a scenario that stand for a definition, or for what a family of plugins knows.
fn parts() -> Vec<(&'static str, Form)> {
    let list = |of: &'static str| Form::List(Box::new(Form::Named(of)));
    let map = |of: &'static str| Form::Map(Box::new(Form::Named(of)));
    vec![
        ("vehicle.driveline", Form::Named("driveline")),
        ("vehicle.management", Form::Named("management")),
        ("ground.terrain", Form::Named("terrain")),
        ("ground.soil", Form::Named("soil")),
        ("ground.soils", map("soil")),
        ("cycle", Form::Named("cycle")),
        ("driver", Form::Named("driver")),
        ("tasks", Form::Either(vec![list("task"), map("task")])),
        ("effects", list("effect")),
        ("candidates", list("effect")),
    ]
}

/// A scenario, first, and what it is made of. Plugins are named `soil`, `terrain`, `driveline`, `management`, `task` and
/// `effect` and are defined by a registry.
///
/// # Panics
/// Where the schema has no such part: that is a bug of ours.
pub fn definitions() -> Vec<Definition> {
    let mut scenario = form_of::<ScenarioFile>();
    for (path, form) in parts() {
        let part = scenario.find(path);
        assert!(part.is_some(), "a scenario has no `{path}`");
        if let Some(part) = part {
            *part = form;
        }
    }
    let one_or_more =
        |of: &'static str| Form::Either(vec![Form::Named(of), Form::List(Box::new(Form::Named(of)))]);
    [
        ("scenario", scenario),
        ("cycle", cycle()),
        ("phases", Form::Either(vec![Form::Named("phase"), Form::List(Box::new(Form::Named("phases")))])),
        ("phase", phase()),
        ("until", one_or_more("end")),
        ("end", form_of::<UntilFile>()),
        ("driver", driver()),
    ]
    .into_iter()
    .map(|(name, form)| Definition { name, form, notes: notes(name) })
    .collect()
}

fn notes(definition: &str) -> Vec<Note> {
    let own = |(of, path, about): &(&str, &'static str, &'static str)| {
        let bound = if *of == "scenario" { bound(path) } else { Bound::Finite };
        (*of == definition).then_some(Note { path, about, bound })
    };
    let mut notes: Vec<Note> = ABOUT.iter().filter_map(own).collect();
    if definition == "phase" {
        let beside = BESIDE.iter().map(|(path, about)| Note { path, about, bound: Bound::Finite });
        notes.extend(beside);
    }
    notes
}

/// The bound that a number of the vehicle is held to.
fn bound(path: &str) -> Bound {
    let of = |head: &str, bounds: &[(&str, Bound)]| {
        let rest = path.strip_prefix(head)?;
        bounds.iter().find(|(own, _)| *own == rest).map(|(_, bound)| *bound)
    };
    of("vehicle.body.axles.", &OF_AN_AXLE_OF_THE_BODY)
        .or_else(|| of("vehicle.body.", &OF_THE_BODY))
        .or_else(|| of("vehicle.axles.", &OF_AN_AXLE))
        .or_else(|| of("vehicle.axles.", &OF_A_TYRE))
        .or_else(|| of("vehicle.body.trailer.axles.", &OF_AN_AXLE_OF_THE_TRAILER))
        .or_else(|| of("vehicle.body.trailer.axles.", &OF_AN_AXLE_OF_THE_BODY))
        .or_else(|| of("vehicle.body.trailer.axles.", &OF_A_TYRE))
        .or_else(|| of("vehicle.body.trailer.", &OF_THE_TRAILER))
        .unwrap_or(Bound::Finite)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_is_told_and_nothing_else_is() {
        for definition in definitions() {
            let all = definition.form.paths();
            for path in &all {
                let beside = path.split_once('.').map_or("", |(_, rest)| rest);
                let told = definition
                    .notes
                    .iter()
                    .any(|note| note.path == path || definition.name == "phase" && note.path == beside);
                assert!(told, "{}: nothing is told of `{path}`", definition.name);
            }
            for note in &definition.notes {
                let any = all.iter().any(|path| {
                    path == note.path
                        || definition.name == "phase"
                            && path.split_once('.').is_some_and(|(_, rest)| rest == note.path)
                });
                assert!(any, "{}: no `{}`", definition.name, note.path);
            }
        }
    }

    #[test]
    fn bounds_of_the_vehicle_are_those_that_it_is_checked_against() {
        assert_eq!(bound("vehicle.axles.tyre.width_m"), Bound::Positive);
        assert_eq!(bound("vehicle.body.axles.friction"), Bound::Within(0.01, 3.0));
        assert_eq!(bound("vehicle.body.steering.rate_rad_s"), Bound::Positive);
        assert_eq!(bound("vehicle.body.trailer.axles.tyre.inflation_pa"), Bound::Positive);
        assert_eq!(bound("vehicle.body.trailer.yaw_radius_m"), Bound::Positive);
        assert_eq!(bound("vehicle.mass_kg"), Bound::Finite);
    }
}
