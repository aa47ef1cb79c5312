//! A few lines that say what there is to see.

use crate::forces::words;
use crate::scene::{Axis, Scene};
use std::fmt::Write as _;

/// The text, in Markdown.
pub(crate) fn summary(scene: &Scene, newton_per_m: f64, stripe_m: Option<f64>) -> String {
    let mut text = String::new();
    if !scene.title.is_empty() {
        let _ = writeln!(text, "**{}**\n", scene.title);
    }
    let names: Vec<&str> = scene.runs.iter().map(|run| run.id.as_str()).collect();
    let _ = match names.as_slice() {
        [only] => writeln!(text, "Run {only}."),
        [first, .., last] => writeln!(text, "{} runs, {first} to {last}.", names.len()),
        [] => Ok(()),
    };
    if scene.runs.iter().any(|run| scene.measured.iter().any(|measured| measured.id == run.id)) {
        text.push_str("The transparent vehicle and the pale lines are measured.\n");
    }
    if !scene.forces.is_empty() {
        let _ = writeln!(text, "1 m of arrow is {}.", words(newton_per_m));
    }
    if scene.forces.iter().any(|force| force.axis == Axis::Up) {
        text.push_str("Arrows on the roof are upward forces.\n");
    }
    if let Some(stripe_m) = stripe_m {
        let _ = writeln!(text, "The ground changes its shade every {stripe_m:.0} m.");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::ForceArrow;
    use crate::scene::tests::{run, scene};

    #[test]
    fn it_says_what_the_colours_and_lengths_mean() {
        let runs = [run("r1", &[("position_m", &[0.0])]), run("r2", &[("position_m", &[0.0])])];
        let forces = [ForceArrow { channel: "drag_n", label: "drag", axis: Axis::Backward }];
        let both = Scene { title: "Roll-out", forces: &forces, ..scene(&runs, &runs[..1]) };
        let text = summary(&both, 2000.0, Some(10.0));
        for part in
            ["**Roll-out**", "2 runs, r1 to r2.", "measured", "1 m of arrow is 2.00 kN.", "every 10 m"]
        {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
        let text = summary(&scene(&runs[..1], &[]), 1.0, None);
        assert_eq!(text, "Run r1.\n");
    }
}
