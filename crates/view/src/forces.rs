//! Forces as arrows at the vehicle.

use crate::colour::Colour;
use crate::entity::{Who, part, vehicle};
use crate::mesh::{Point, single};
use crate::recorder::Recorder;
use crate::scene::{Axis, Body, ForceArrow, Scene};
use crate::strip::round_up;
use crate::thin::{MOST, Thinned, thin};
use crate::{ViewError, groups};
use headland_trace::Run;
use rerun::{Arrows3D, Color, Transform3D};

/// The longest arrow, in lengths of the vehicle.
const LONGEST: f64 = 1.2;
/// A force below this share of the largest one is drawn without an arrow.
const LEAST: f64 = 0.002;
/// Above what hangs on a hitch, in heights of the vehicle.
const ABOVE: f64 = 0.5;
/// A smaller force is told as 0 N.
const LEAST_TOLD_N: f64 = 0.5;

/// How many newtons a metre of arrow stands for: a round number, the same for all arrows of a scene.
pub(crate) fn newton_per_m(scene: &Scene) -> f64 {
    let largest = scene
        .runs
        .iter()
        .flat_map(|run| scene.forces.iter().filter_map(|force| run.trace.get(force.channel)))
        .flatten()
        .filter(|force| force.is_finite())
        .fold(0.0f64, |largest, force| largest.max(force.abs()));
    if largest > 0.0 { round_up(largest / (LONGEST * scene.vehicle.length_m)) } else { 1.0 }
}

/// A force with three digits or so.
pub(crate) fn words(force_n: f64) -> String {
    match force_n.abs() {
        large if large >= 99_950.0 => format!("{:.0} kN", force_n / 1e3),
        middle if middle >= 9_995.0 => format!("{:.1} kN", force_n / 1e3),
        small if small >= 999.5 => format!("{:.2} kN", force_n / 1e3),
        _ => format!("{force_n:.0} N"),
    }
}

/// Where the arrow of the `index`-th of `count` forces begins, and its vector; it always points away from the vehicle or
/// ends at its roof. Where something hangs before or behind the vehicle it begins above that.
fn arrow(
    (body, hangs): (&Body, [bool; 2]),
    axis: Axis,
    (index, count): (usize, usize),
    length_m: f64,
) -> (Point, Point) {
    let vector = axis.vector(length_m);
    let share = (index as f64 + 0.5) / count as f64;
    let origin = match axis {
        Axis::Up => [0.0, 0.0, body.height_m - vector[2].min(0.0)],
        Axis::Forward | Axis::Backward => {
            let ahead = (axis == Axis::Forward) == (length_m >= 0.0);
            let (end, hangs) = if ahead { (0.5, hangs[0]) } else { (-0.5, hangs[1]) };
            let lowest = if hangs { ABOVE } else { 0.05 };
            [end * body.length_m, 0.0, body.height_m * (lowest + 1.05 * share)]
        }
    };
    (origin, vector)
}

/// Leaves out a force that would be told as 0 N: it is no force, and its label would hide others.
fn told(all: Thinned) -> Thinned {
    let mut left = Thinned { times_s: all.times_s, ..Thinned::default() };
    let mut values = all.values.into_iter();
    for length in all.lengths {
        let force = values.by_ref().take(length).find(|force| force.abs() >= LEAST_TOLD_N);
        left.lengths.push(usize::from(force.is_some()));
        left.values.extend(force);
    }
    left
}

/// Draws the forces of a run at its vehicle, with their names and values if they are to be labelled.
pub(crate) fn draw(
    to: &Recorder,
    scene: &Scene,
    run: &Run,
    (newton_per_m, labelled): (f64, bool),
) -> Result<(), ViewError> {
    let body = &scene.vehicle;
    let level = scene.forces.iter().filter(|force| force.axis != Axis::Up).count();
    if let Some(rig) = scene.rig(&run.id) {
        let seat = Transform3D::from_translation(single(rig.seat_m(body.wheel_radius_m)));
        to.fixed(&part(&vehicle(&run.id, Who::Modelled), "forces"), &seat)?;
    }
    let hangs = [1.0, -1.0].map(|way| scene.setting(&run.id).is_some_and(|setting| setting.hangs(way)));
    let mut rank = 0;
    for ForceArrow { channel, label, axis } in scene.forces {
        let place = (rank, level.max(1));
        rank += usize::from(*axis != Axis::Up);
        let Some(values) = run.trace.get(channel) else { continue };
        let thinned = told(thin(run.trace.time_s(), values, MOST));
        let arrows: Vec<(Point, Point)> = thinned
            .values
            .iter()
            .map(|force| {
                let length_m = force / newton_per_m;
                let drawn = length_m.abs() >= LEAST * LONGEST * body.length_m;
                arrow((body, hangs), *axis, place, if drawn { length_m } else { 0.0 })
            })
            .collect();
        let at = part(&part(&vehicle(&run.id, Who::Modelled), "forces"), channel);
        let [red, green, blue]: Colour = groups::colour(&groups::groups(scene), channel);
        let look = Arrows3D::update_fields()
            .with_colors([Color::from_rgb(red, green, blue)])
            .with_radii([radius_m(body)])
            .with_show_labels(labelled);
        to.fixed(&at, &look)?;
        let columns = Arrows3D::update_fields()
            .with_vectors(arrows.iter().map(|(_, vector)| single(*vector)))
            .with_origins(arrows.iter().map(|(origin, _)| single(*origin)))
            .with_labels(thinned.values.iter().map(|force| format!("{label} {}", words(*force))))
            .columns(thinned.lengths.clone());
        to.rows(&at, thinned.times_s, columns)?;
    }
    Ok(())
}

#[expect(clippy::cast_possible_truncation, reason = "pictures are drawn in single precision")]
fn radius_m(body: &Body) -> f32 {
    (0.03 * body.height_m) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tests::{BODY, run, scene};

    #[test]
    fn the_largest_force_of_all_runs_sets_a_round_scale() {
        let forces = [ForceArrow { channel: "drag_n", label: "drag", axis: Axis::Backward }];
        let position = ("position_m", [0.0, 1.0]);
        let one = run("r1", &[(position.0, &position.1), ("drag_n", &[100.0, f64::NAN])]);
        let other = run("r2", &[(position.0, &position.1), ("drag_n", &[-5900.0, 10.0])]);
        let runs = [one, other];
        let scene = Scene { forces: &forces, ..scene(&runs, &[]) };
        assert_eq!(newton_per_m(&scene), 1000.0, "5900 N over 7.2 m");
        assert_eq!(newton_per_m(&Scene { forces: &[], ..scene }), 1.0);
    }

    #[test]
    fn arrows_point_away_from_the_vehicle_on_both_sides() {
        let (nose, ahead) = arrow((&BODY, [false; 2]), Axis::Forward, (0, 1), 2.0);
        assert_eq!((nose[0], ahead), (3.0, [2.0, 0.0, 0.0]));
        let (tail, back) = arrow((&BODY, [false; 2]), Axis::Backward, (0, 1), 2.0);
        assert_eq!((tail[0], back), (-3.0, [-2.0, 0.0, 0.0]));
        let (turned, ahead) = arrow((&BODY, [false; 2]), Axis::Backward, (0, 1), -2.0);
        assert_eq!((turned[0], ahead), (3.0, [2.0, 0.0, 0.0]));
        let (above_it, _) = arrow((&BODY, [false, true]), Axis::Backward, (0, 1), 2.0);
        assert!((above_it[2] - tail[2] - 0.45 * BODY.height_m).abs() < 1e-12 && above_it[0] == tail[0]);
        let (still, _) = arrow((&BODY, [false; 2]), Axis::Backward, (0, 1), 0.0);
        assert_eq!(still[0], -3.0, "the label of no force stays where the force would be");
        let (roof, up) = arrow((&BODY, [false; 2]), Axis::Up, (0, 1), 2.0);
        assert_eq!((roof[2], up[2]), (BODY.height_m, 2.0));
        let (above, down) = arrow((&BODY, [false; 2]), Axis::Up, (0, 1), -2.0);
        assert_eq!(above[2] + down[2], BODY.height_m);
    }

    #[test]
    fn a_force_of_nothing_has_neither_arrow_nor_label() {
        let thinned = told(thin(&[0.0, 1.0, 2.0, 3.0, 4.0], &[3.0, 0.4, -0.2, f64::NAN, -7.0], MOST));
        assert_eq!((thinned.lengths, thinned.values), (vec![1, 0, 0, 0, 1], vec![3.0, -7.0]));
        assert_eq!(thinned.times_s, [0.0, 1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn forces_have_three_digits() {
        let texts = [0.4, -999.0, 1234.0, -20_560.0, 123_456.0].map(words);
        assert_eq!(texts, ["0 N", "-999 N", "1.23 kN", "-20.6 kN", "123 kN"]);
    }
}
