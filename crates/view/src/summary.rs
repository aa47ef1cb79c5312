//! A few lines that say what there is to see.

use crate::forces::words;
use crate::relief::{SQUARE_M, Surveyed};
use crate::scene::{Axis, Scene};
use std::fmt::Write as _;

/// What lengths and shades stand for.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_field_names, reason = "each name ends in its unit")]
pub(crate) struct Scales {
    /// Of the arrows at the vehicle [N/m].
    pub newton_per_m: f64,
    /// Of the arrows at the wheels of rigid bodies; `None` where there are none [N/m].
    pub wheels_newton_per_m: Option<f64>,
    /// Of velocities [m/s per m].
    pub m_s_per_m: f64,
    /// The deepest rut; `None` where no soil says how deep they are [m].
    pub deepest_m: Option<f64>,
}

/// The ground as it was drawn.
#[derive(Debug, Default)]
pub(crate) struct Grounds {
    /// Length of the light and dark pieces of the first strip [m].
    pub stripe_m: Option<f64>,
    /// The grounds that are surfaces.
    pub surveyed: Vec<Surveyed>,
}

/// The text, in Markdown.
pub(crate) fn summary(scene: &Scene, scales: &Scales, grounds: &Grounds) -> String {
    let mut text = String::new();
    if !scene.title.is_empty() {
        let _ = writeln!(text, "**{}**\n", scene.title);
    }
    let names: Vec<&str> = scene.runs.iter().map(|run| run.id.as_str()).collect();
    let _ = match names.as_slice() {
        // A scenario without runs is one that is called so.
        ["run"] | [] => Ok(()),
        [only] => writeln!(text, "Run {only}."),
        [first, .., last] => writeln!(text, "{} runs, {first} to {last}.", names.len()),
    };
    if scene.runs.iter().any(|run| scene.measured.iter().any(|measured| measured.id == run.id)) {
        text.push_str("The transparent vehicle and the pale lines are measured.\n");
    }
    if !scene.forces.is_empty() {
        let _ = writeln!(text, "1 m of arrow is {}.", words(scales.newton_per_m));
        text.push_str("Energy flow: what the wheels get, and what takes it.\n");
    }
    if scene.forces.iter().any(|force| force.axis == Axis::Up) {
        text.push_str("Arrows on the roof are upward forces.\n");
    }
    if let Some(newton_per_m) = scales.wheels_newton_per_m {
        let _ = writeln!(
            text,
            "At each wheel: load (yellow), traction less resistance (green), side force (purple), 1 m for {}. White: a bar through the \
             centre of gravity, its plumb line, and the velocity, 1 m for {} m/s.",
            words(newton_per_m),
            scales.m_s_per_m
        );
        match scales.deepest_m.filter(|deepest_m| *deepest_m > 0.0) {
            Some(deepest_m) => {
                let _ = writeln!(text, "Ruts are darker the deeper, up to {:.0} mm.", 1e3 * deepest_m);
            }
            None => text.push_str("Dark bands are the tracks of the wheels.\n"),
        }
    }
    told_ground(&mut text, grounds);
    text
}

fn told_ground(text: &mut String, grounds: &Grounds) {
    if let Some(stripe_m) = grounds.stripe_m {
        let _ = writeln!(text, "The ground changes its shade every {stripe_m:.0} m.");
    }
    let Some(first) = grounds.surveyed.first() else { return };
    let _ = write!(text, "Ground in squares of {SQUARE_M:.0} m");
    let mut kinds: Vec<&(String, &str)> = Vec::new();
    for kind in grounds.surveyed.iter().flat_map(|ground| &ground.kinds) {
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    let mut joint = ": ";
    for (kind, colour) in kinds {
        let _ = write!(text, "{joint}{kind} {colour}");
        joint = ", ";
    }
    if grounds.surveyed.len() > 1 && grounds.surveyed.iter().any(Surveyed::by_height) {
        text.push_str("; dark blue is the lowest of each, sand the highest");
    } else if first.by_height() {
        let [lowest_m, highest_m] = first.heights_m;
        let _ = write!(text, "; dark blue is {lowest_m:.2} m high, sand {highest_m:.2} m");
    }
    text.push_str(".\n");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::ForceArrow;
    use crate::scene::tests::{run, scene};

    const PLAIN: Scales =
        Scales { newton_per_m: 2000.0, wheels_newton_per_m: None, m_s_per_m: 1.0, deepest_m: None };

    #[test]
    fn it_says_what_the_colours_and_lengths_mean() {
        let runs = [run("r1", &[("position_m", &[0.0])]), run("r2", &[("position_m", &[0.0])])];
        let forces = [ForceArrow { channel: "drag_n", label: "drag", axis: Axis::Backward }];
        let both = Scene { title: "Roll-out", forces: &forces, ..scene(&runs, &runs[..1]) };
        let strips = Grounds { stripe_m: Some(10.0), surveyed: Vec::new() };
        let text = summary(&both, &PLAIN, &strips);
        for part in
            ["**Roll-out**", "2 runs, r1 to r2.", "measured", "1 m of arrow is 2.00 kN.", "every 10 m"]
        {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
        let text = summary(&scene(&runs[..1], &[]), &PLAIN, &Grounds::default());
        assert_eq!(text, "Run r1.\n");
    }

    #[test]
    fn it_says_what_is_seen_of_a_rigid_body() {
        let runs = [run("r1", &[("position_m", &[0.0])])];
        let scales =
            Scales { wheels_newton_per_m: Some(2e4), deepest_m: Some(0.072), m_s_per_m: 0.5, ..PLAIN };
        let hill =
            Surveyed { mesh: crate::mesh::Mesh::default(), heights_m: [-0.5, 2.25], kinds: Vec::new() };
        let text = summary(&scene(&runs, &[]), &scales, &Grounds { stripe_m: None, surveyed: vec![hill] });
        for part in [
            "1 m for 20.0 kN",
            "1 m for 0.5 m/s",
            "up to 72 mm",
            "-0.50 m high, sand 2.25 m",
            "squares of 10 m",
        ] {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
        let kinds = vec![("field".to_owned(), "sand"), ("road".to_owned(), "slate")];
        let zones = Surveyed { mesh: crate::mesh::Mesh::default(), heights_m: [0.0, 3.0], kinds };
        let text = summary(&scene(&runs, &[]), &scales, &Grounds { stripe_m: None, surveyed: vec![zones] });
        assert!(text.contains("field sand, road slate.") && !text.contains("high"), "{text}");
    }
}
