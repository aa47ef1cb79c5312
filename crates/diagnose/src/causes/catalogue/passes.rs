//! Ground that firms or breaks up with every pass: from run to run along one path, or from lap to lap within a run.

use super::{Around, Cause, MOTION, cause, linear, positive, shape};

/// What a pass leaves of the resistance that the one before it left: between the points of so coarse a grid lies more than
/// levels that differ from run to run leave to be told.
const PASSED_ON: [f64; 6] = [0.95, 0.85, 0.7, 0.55, 0.4, 0.25];
/// The same from lap to lap, of which a run has several.
const LAPPED: [f64; 3] = [0.75, 0.5, 0.25];
/// What a pass may leave.
const LEAST_LEFT: f64 = 0.02;
/// What every pass makes of what the one before it added, on ground that breaks up,
const BROKEN_UP: [f64; 4] = [1.04, 1.1, 1.18, 1.3];
/// and the most that it may.
const MOST_BROKEN: f64 = 1.5;
/// Usual size: part of the coefficient that passes take [1].
const USUAL: f64 = 0.03;

/// On ground that resists less than this nothing gives way [1]: a road has a quarter of it.
const SOFT: f64 = 0.015;
/// Of the longest way so many laps are the fewest and the most,
const FEWEST_LAPS: f64 = 1.4;
const MOST_LAPS: f64 = 12.0;
/// none is shorter [m],
const SHORTEST_M: f64 = 20.0;
/// and two neighbours of the grid differ by this factor, so that the first edge lies within a twentieth of its place.
const APART: f64 = 1.1;

/// What may firm or break up.
pub(super) fn passes(around: &Around) -> Vec<Cause> {
    let mut all = Vec::new();
    if around.passes > 2 {
        let terms = vec![linear("coefficient", "1", USUAL), shape("factor", "1")];
        let words = ("F = c (fⁿ⁻¹ − 1) N", "ground that firms with every pass");
        all.push(passed_over(terms, words).shaped(PASSED_ON.map(|factor| vec![factor]).into()));
        let terms = vec![positive("coefficient", "1", USUAL), shape("factor", "1").within(1.0, MOST_BROKEN)];
        let words = ("F = c (fⁿ⁻¹ − 1) N", "ground that breaks up with every pass");
        all.push(passed_over(terms, words).shaped(BROKEN_UP.map(|factor| vec![factor]).into()));
    }
    let laps_m = laps_m(around.reach_m);
    if around.soil_coefficient > SOFT && !laps_m.is_empty() {
        let terms = vec![
            positive("coefficient", "1", USUAL),
            shape("factor", "1").within(LEAST_LEFT, 1.0),
            shape("lap_length_m", "m").within(SHORTEST_M, around.reach_m),
        ];
        let shapes = laps_m.iter().flat_map(|lap_m| LAPPED.map(|factor| vec![factor, *lap_m]));
        let words = ("F = c (f^⌊x/L⌋ − 1) N", "ground that firms with every lap");
        all.push(passed_over(terms, words).shaped(shapes.collect()));
    }
    all
}

fn passed_over(terms: Vec<super::Term>, (equation, words): (&'static str, &'static str)) -> Cause {
    cause(
        "multipass",
        MOTION,
        terms,
        equation,
        &["position_m"],
        words,
        "drive a fresh lane beside the old one",
    )
}

/// Lengths that laps may have, of runs that go so far [m].
fn laps_m(reach_m: f64) -> Vec<f64> {
    let shortest_m = (reach_m / MOST_LAPS).max(SHORTEST_M);
    let longer = std::iter::successors(Some(reach_m / FEWEST_LAPS), |lap_m| Some(lap_m / APART));
    longer.take_while(|lap_m| *lap_m >= shortest_m).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every lap that divides the way into two to twelve lies within a twentieth of one that is tried.
    #[test]
    fn laps_of_all_lengths_are_tried_and_none_on_a_road_or_a_short_way() {
        let tried = laps_m(600.0);
        for count in 2..12 {
            let lap_m = 600.0 / f64::from(count);
            assert!(tried.iter().any(|one| (one / lap_m - 1.0).abs() < 0.05), "{lap_m} of {tried:?}");
        }
        let around = |soil_coefficient, reach_m| Around { reach_m, soil_coefficient, ..Around::default() };
        assert_eq!(passes(&around(0.03, 600.0)).len(), 1);
        assert!(passes(&around(0.008, 600.0)).is_empty() && passes(&around(0.03, 25.0)).is_empty());
    }
}
