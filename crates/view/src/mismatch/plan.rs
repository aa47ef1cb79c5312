//! The mismatch painted along the paths, seen from above.

use super::course::{Place, place, poses, together};
use super::scale::{Scale, smoothed, told};
use super::{Diagnosis, Left, Stage};
use crate::ViewError;
use crate::colour::Colour;
use crate::entity;
use crate::path::Pose;
use crate::recorder::Recorder;
use crate::strip::round_up;
use crate::thin::{MOST, spread};
use rerun::{Color, LineStrips2D, Points2D, Radius};

/// Pieces that a line is made of, at most.
const PIECES: usize = 500;
/// Runs lie beside one another by this share of the plan's size, all of them within `ALL`.
const GAP: f64 = 0.02;
const ALL: f64 = 0.24;
/// All lanes of runs that know no places, beside one another, as a share of the longest.
const LANES: f64 = 0.1;
/// A plan is wide if it is so many times wider than high: before stands above after, and there is little room below.
const WIDE: f64 = 2.0;
/// Margins of a wide plan over those of others.
const LOW: f64 = 0.35;
/// Thickness of a line: where nothing is left over, and what the limit adds, as half widths in points of the screen.
const THIN: f64 = 1.5;
const THICK: f64 = 2.5;
/// What is written: light on dark.
const WORDS: Colour = [225, 225, 225];

/// The plan of all runs.
#[derive(Debug)]
pub(crate) struct Plan {
    /// Places of the rows of each run that has any.
    lines: Vec<Vec<Place>>,
    /// Whether the runs lie where they drove; else each in a lane of its own, straight on.
    pub located: bool,
    /// Left, top, right, bottom of everything [m].
    pub bounds: [f64; 4],
}

impl Plan {
    /// The plan of what is left over.
    pub(crate) fn of(all: &[Left]) -> Self {
        let placed: Option<Vec<Vec<Pose>>> = all.iter().map(poses).collect();
        let mut lines: Vec<Vec<Place>> = match &placed {
            Some(poses) => {
                let mut lines =
                    poses.iter().map(|poses| poses.iter().map(place).collect()).collect::<Vec<_>>();
                together(all, &mut lines);
                lines
            }
            None => all.iter().map(|left| left.position_m.iter().map(|at| [*at, 0.0]).collect()).collect(),
        };
        let size_m = {
            let [left, top, right, bottom] = bounds(&lines);
            (right - left).max(bottom - top).max(1.0)
        };
        let count = lines.len() as f64;
        let gap_m =
            if placed.is_some() { (GAP * size_m).min(ALL * size_m / count) } else { LANES * size_m / count };
        for (index, line) in lines.iter_mut().enumerate() {
            match placed.as_ref().map(|poses| &poses[index]) {
                Some(poses) => {
                    let aside_m = gap_m * (index as f64 - 0.5 * (count - 1.0));
                    let way = if all[index].reversed { -1.0 } else { 1.0 };
                    for (at, pose) in line.iter_mut().zip(poses) {
                        let (sine, cosine) = pose.heading_rad.sin_cos();
                        *at = [at[0] + way * aside_m * cosine, at[1] + way * aside_m * sine];
                    }
                }
                None => line.iter_mut().for_each(|at| at[1] = gap_m * index as f64),
            }
        }
        let bounds = bounds(&lines);
        Self { lines, located: placed.is_some(), bounds }
    }

    /// The longer side [m].
    fn size_m(&self) -> f64 {
        let [left, top, right, bottom] = self.bounds;
        (right - left).max(bottom - top).max(1.0)
    }

    /// Whether it is wide and low.
    pub(crate) fn wide(&self) -> bool {
        let [left, top, right, bottom] = self.bounds;
        right - left > WIDE * (bottom - top)
    }

    /// A length above or below the runs.
    fn margin_m(&self, share: f64) -> f64 {
        share * self.size_m() * if self.wide() { LOW } else { 1.0 }
    }

    /// What a view has to show: everything, with room for names and the legend.
    pub(crate) fn view(&self) -> [f64; 4] {
        let [left, top, right, bottom] = self.bounds;
        let size_m = self.size_m();
        // The legend is as wide as the longer side.
        let half_m = (0.5 * (right - left) + 0.06 * size_m).max(0.55 * size_m);
        let middle = f64::midpoint(left, right);
        [middle - half_m, top - self.margin_m(0.06), middle + half_m, bottom + self.margin_m(0.22)]
    }

    /// Draws the lines of both stages, the legend, and where each run is as time passes.
    pub(crate) fn draw(&self, to: &Recorder, diagnosis: &Diagnosis, scale: Scale) -> Result<(), ViewError> {
        for (left, line) in diagnosis.left.iter().zip(&self.lines) {
            for stage in Stage::BOTH {
                paint(to, left, line, stage, scale)?;
            }
            let here = entity::painted("here", &left.run.id);
            let look = Points2D::update_fields()
                .with_radii([Radius::new_ui_points(4.0)])
                .with_colors([colour(WORDS)]);
            to.fixed(&here, &look)?;
            let rows: Vec<usize> = finite(line);
            let kept = || spread(rows.len(), MOST).into_iter().map(|index| rows[index]);
            let places: Vec<[f32; 2]> = kept().map(|row| single(line[row])).collect();
            let times = kept().map(|row| left.time_s[row]);
            to.rows(
                &here,
                times,
                Points2D::update_fields().with_positions(places).columns_of_unit_batches(),
            )?;
        }
        self.legend(to, diagnosis.unit, scale)
    }

    /// A bar of all colours with its ends and its middle told, and a length in metres.
    fn legend(&self, to: &Recorder, unit: &str, scale: Scale) -> Result<(), ViewError> {
        const STEPS: usize = 40;
        let [left, _, right, bottom] = self.bounds;
        let size_m = self.size_m();
        let middle = f64::midpoint(left, right);
        let (from, width, at) = (middle - 0.45 * size_m, 0.5 * size_m, bottom + self.margin_m(0.1));
        let value = |step: usize| scale.limit * (2.0 * (step as f64 + 0.5) / STEPS as f64 - 1.0);
        let along = |step: usize| from + width * step as f64 / STEPS as f64;
        let bar =
            LineStrips2D::new((0..STEPS).map(|step| [[along(step), at], [along(step + 1), at]].map(single)))
                .with_colors((0..STEPS).map(|step| colour(scale.colour(value(step)))))
                .with_radii([Radius::new_ui_points(4.0)]);
        to.fixed(&entity::painted("legend", "colours"), &bar)?;
        let ends = [(0, -scale.limit), (STEPS / 2, 0.0), (STEPS, scale.limit)];
        let numbers = Points2D::new(ends.map(|(step, _)| single([along(step), at])))
            .with_radii([Radius::new_ui_points(1.0)])
            .with_colors([colour(WORDS)])
            .with_labels(ends.map(|(_, value)| told(value, unit)))
            .with_show_labels(true);
        to.fixed(&entity::painted("legend", "numbers"), &numbers)?;
        let length_m = round_up(0.1 * size_m);
        let start = middle + 0.25 * size_m;
        let rule = [[start, at], [start + length_m, at]].map(single);
        let rule = LineStrips2D::new([rule])
            .with_colors([colour(WORDS)])
            .with_radii([Radius::new_ui_points(1.0)])
            .with_labels([format!("{length_m} m")])
            .with_show_labels(true);
        to.fixed(&entity::painted("legend", "length"), &rule)
    }
}

/// Paints the line of one run in one stage.
fn paint(to: &Recorder, left: &Left, line: &[Place], stage: Stage, scale: Scale) -> Result<(), ViewError> {
    let values = smoothed(left, stage);
    let rows: Vec<usize> = finite(line).into_iter().filter(|row| values[*row].is_finite()).collect();
    let kept: Vec<usize> = spread(rows.len(), PIECES).into_iter().map(|index| rows[index]).collect();
    let pieces = || kept.windows(2).map(|pair| (pair[0], pair[1]));
    let middle = |(from, to): (usize, usize)| f64::midpoint(values[from], values[to]);
    let strips = LineStrips2D::new(pieces().map(|(from, to)| [single(line[from]), single(line[to])]))
        .with_colors(pieces().map(|piece| colour(scale.colour(middle(piece)))))
        .with_radii(pieces().map(|piece| {
            let [half] = narrow([THIN + THICK * scale.share(middle(piece)).abs()]);
            Radius::new_ui_points(half)
        }));
    to.fixed(&entity::painted(stage.name(), &left.run.id), &strips)
}

/// A name is cut after so many letters.
const LETTERS: usize = 14;

/// The run: in brackets where it was held out, with an arrow where it goes against its path.
pub(crate) fn name(left: &Left) -> String {
    let id = &left.run.id;
    let mut name: String = id.chars().take(LETTERS).collect();
    if name.len() < id.len() {
        name.push('…');
    }
    if left.reversed {
        name.push_str(" ←");
    }
    if left.held_out { format!("({name})") } else { name }
}

fn finite(line: &[Place]) -> Vec<usize> {
    (0..line.len()).filter(|row| line[*row].iter().all(|at| at.is_finite())).collect()
}

fn bounds(lines: &[Vec<Place>]) -> [f64; 4] {
    let all = |axis: usize| lines.iter().flatten().map(move |at| at[axis]).filter(|at| at.is_finite());
    let least = |axis: usize| all(axis).reduce(f64::min).unwrap_or(0.0);
    let most = |axis: usize| all(axis).reduce(f64::max).unwrap_or(0.0);
    [least(0), least(1), most(0), most(1)]
}

#[expect(clippy::cast_possible_truncation, reason = "pictures are drawn in single precision")]
fn narrow<const N: usize>(values: [f64; N]) -> [f32; N] {
    values.map(|value| value as f32)
}

fn single(at: Place) -> [f32; 2] {
    narrow(at)
}

fn colour([red, green, blue]: Colour) -> Color {
    Color::from_rgb(red, green, blue)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tests::run;
    use headland_trace::Run;

    const TIMES_S: [f64; 3] = [0.0, 1.0, 2.0];
    const AT_M: [f64; 3] = [0.0, 50.0, 100.0];

    fn left(run: &Run, reversed: bool) -> Left<'_> {
        Left {
            run,
            held_out: false,
            path: 0,
            reversed,
            time_s: &TIMES_S,
            position_m: &AT_M,
            speed_m_s: &AT_M,
            before: &AT_M,
            after: &AT_M,
        }
    }

    /// Two runs straight north, 100 m long, drawn 2 m apart: the first to the left of where it drove.
    #[test]
    fn runs_of_one_place_lie_beside_one_another() {
        let north: (&str, &[f64]) = ("north_m", &AT_M);
        let one = run("r1", &[("east_m", &[7.0, 7.0, 7.0]), north]);
        let plan = Plan::of(&[left(&one, false), left(&one, false)]);
        assert!(plan.located && !plan.wide());
        assert_eq!(plan.lines[0][0], [6.0, 0.0]);
        assert_eq!(plan.lines[1][2], [8.0, -100.0]);
        // Against the path, to the left of its path is to the right of where it goes.
        let back = Plan::of(&[left(&one, true), left(&one, false)]);
        assert!((back.lines[0][0][0] - 8.0).abs() < 1e-9);
    }

    /// One goes north and its fellow comes back: where both are at 50 m of their path they are side by side.
    #[test]
    fn runs_of_one_path_that_know_directions_alone_lie_on_it() {
        let north = run("r1", &[("position_m", &AT_M), ("heading_rad", &[0.0; 3])]);
        let downward_m = [100.0, 50.0, 0.0];
        let back = run("r2", &[("position_m", &downward_m), ("heading_rad", &[std::f64::consts::PI; 3])]);
        let plan = Plan::of(&[left(&north, false), Left { position_m: &downward_m, ..left(&back, true) }]);
        for (row, along_m) in [0.0, 50.0, 100.0].into_iter().enumerate() {
            assert!((plan.lines[0][row][1] + along_m).abs() < 1e-9);
            assert!((plan.lines[1][2 - row][1] + along_m).abs() < 1e-9, "{:?}", plan.lines);
        }
        assert!((plan.lines[1][0][0] - plan.lines[0][0][0] - 2.0).abs() < 1e-9);
    }

    #[test]
    fn runs_that_know_no_direction_have_lanes() {
        let one = run("r1", &[("position_m", &AT_M)]);
        let plan = Plan::of(&[left(&one, false), left(&one, false)]);
        assert!(!plan.located && plan.wide());
        assert_eq!(plan.lines[1], [[0.0, 5.0], [50.0, 5.0], [100.0, 5.0]]);
    }
}
