//! What hangs on the hitch: a frame with its tools, as deep in the ground as they work and above it where they are lifted.

use crate::ViewError;
use crate::colour::Colour;
use crate::entity::part;
use crate::lanes::Lane;
use crate::mesh::{Mesh, Point, single};
use crate::recorder::Recorder;
use crate::ruts::{at, below_m, hub};
use crate::setting::{Implement, Rig};
use crate::vehicle;
use headland_trace::Run;
use rerun::components::TransformMat3x3;
use rerun::datatypes::Mat3x3;
use rerun::{EntityPath, Transform3D};

const IRON: Colour = [84, 88, 94];
const STEEL: Colour = [188, 194, 198];

/// How high it is lifted where nothing says so, and how far apart its tools stand [m].
const LIFT_M: f64 = 0.5;
const SPACING_M: f64 = 0.45;
/// From the hitch to the two rows of tools, and as far again on the vehicle's side to where the links begin [m].
const ROWS_M: [f64; 2] = [0.85, 1.65];
const LINKS_M: f64 = 0.8;
/// Half of a beam's thickness [m].
const BEAM_M: f64 = 0.08;

/// How far it is lifted at each sample, from 0 at work to 1; `None` where the trace does not say.
fn lifted(run: &Run, implement: &Implement) -> Option<Vec<f64>> {
    let of = |what: &str| run.trace.get(&format!("{}_{what}", implement.name));
    if let Some(shares) = of("lifted") {
        return Some(shares.to_vec());
    }
    // Where it has come forward, it has worked or it has not; standing, it is as it was.
    let (area_m2, speed_m_s) = (of("area_m2")?, run.trace.get("speed_m_s")?);
    let moved = |row: usize| {
        let grown = area_m2[row] > area_m2[row - 1];
        (grown || speed_m_s[row] != 0.0).then_some(if grown { 0.0 } else { 1.0 })
    };
    let first = (1..area_m2.len()).find_map(moved).unwrap_or(1.0);
    let follow = |share: &mut f64, row: usize| {
        *share = row.checked_sub(1).and_then(|_| moved(row)).unwrap_or(*share);
        Some(*share)
    };
    Some((0..area_m2.len()).scan(first, follow).collect())
}

/// Height of the ground in the vehicle's frame, so far ahead [m]: on the line through what lies below its wheels.
fn ground_m(run: &Run, rig: &Rig, row: usize, ahead_m: f64) -> f64 {
    let below = |wheel| {
        let [x, _, z] = hub(run, wheel, row);
        let pressed = at(run, wheel, "load_n", row).is_some_and(|load_n| load_n > 0.0);
        pressed.then(|| [x, z - below_m(run, wheel, row)])
    };
    let points: Vec<[f64; 2]> = rig.wheels.iter().filter_map(below).collect();
    if points.is_empty() {
        return 0.0;
    }
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64;
    let [x, z] = [mean(0), mean(1)];
    let spread: f64 = points.iter().map(|point| (point[0] - x).powi(2)).sum();
    let rise: f64 = points.iter().map(|point| (point[0] - x) * (point[1] - z)).sum();
    if spread > 0.0 { z + rise / spread * (ahead_m - x) } else { z }
}

/// A block between two corners, whichever is the lower one.
fn block(mesh: &mut Mesh, one: Point, other: Point, colour: Colour) {
    let part = |pick: fn(f64, f64) -> f64| [0, 1, 2].map(|axis: usize| pick(one[axis], other[axis]));
    mesh.block(part(f64::min), part(f64::max), colour);
}

/// A bar that leans from its foot to its head, both in the middle of its ends.
fn bar(mesh: &mut Mesh, foot: Point, head: Point, half_m: f64, colour: Colour) {
    let end = |[x, y, z]: Point| {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[a, b]| [x + a * half_m, y + b * half_m, z])
    };
    mesh.tower(end(foot), end(head), colour);
}

/// The frame and its tools at work, from the point of the ground below the hitch. `way` is −1 behind the vehicle and 1 before it.
fn frame(implement: &Implement, way: f64, colour: Colour) -> Mesh {
    let Implement { width_m, hitch_m: [_, height_m], .. } = *implement;
    let [first_m, last_m] = ROWS_M.map(|away_m| way * away_m);
    let mut mesh = Mesh::default();
    let (half_m, arm_m) = (0.5 * width_m, (0.5 * width_m).min(0.45));
    // The headstock, and what carries the rows.
    for y in [-arm_m, arm_m] {
        bar(&mut mesh, [0.0, y, height_m - 0.1], [0.15 * way, 0.1 * y, height_m + 0.8], 0.06, IRON);
        let (low, high) = (height_m - BEAM_M, height_m + BEAM_M);
        block(&mut mesh, [0.0, y - 0.07, low], [last_m, y + 0.07, high], colour);
    }
    bar(&mut mesh, [last_m, 0.0, height_m], [0.15 * way, 0.0, height_m + 0.75], 0.05, IRON);
    let Some(depth_m) = implement.depth_m else {
        // A machine that passes over the ground: a housing on skids.
        let (low, high) = (0.15, (0.15_f64 + 0.35).max(height_m - BEAM_M));
        block(&mut mesh, [0.6 * first_m, -half_m, low], [last_m, half_m, high], colour);
        for y in [-half_m, half_m - 0.1] {
            block(&mut mesh, [0.6 * first_m, y, 0.0], [last_m, y + 0.1, low], STEEL);
        }
        return mesh;
    };
    for x in [first_m, last_m] {
        let (low, high) = (height_m - 0.8 * BEAM_M, height_m + 0.8 * BEAM_M);
        block(&mut mesh, [x - BEAM_M, -half_m, low], [x + BEAM_M, half_m, high], colour);
    }
    let count = implement.tools.unwrap_or(width_m / SPACING_M).round().max(1.0);
    let apart_m = width_m / count;
    let share_m = (0.42 * apart_m).min(0.16);
    for tool in (0u32..).take_while(|tool| f64::from(*tool) < count) {
        let y = (f64::from(tool) + 0.5) * apart_m - half_m;
        let x = if tool % 2 == 0 { first_m } else { last_m };
        // The leg leans ahead to its share, whose point is as deep as the tools work.
        let foot = [x + 0.1, y, 0.12 - depth_m];
        bar(&mut mesh, foot, [x, y, height_m], 0.045f64.min(0.3 * apart_m), STEEL);
        let edge = |ahead: f64, z: f64, half: f64| [[x + ahead, y - half, z], [x + ahead, y + half, z]];
        let [[a, b], [c, d]] = [edge(-0.08, 0.0, share_m), edge(0.32, 0.0, 0.1 * share_m)]
            .map(|pair| pair.map(|[x, y, z]| [x, y, z - depth_m]));
        let [[e, f], [g, h]] = [edge(-0.12, 0.3, share_m), edge(0.02, 0.3, 0.5 * share_m)]
            .map(|pair| pair.map(|[x, y, z]| [x, y, z - depth_m]));
        mesh.tower([a, c, d, b], [e, g, h, f], STEEL);
    }
    mesh
}

/// Two links below and one above, from where they begin on the vehicle to the hitch.
fn links(way: f64) -> Mesh {
    let end = way * LINKS_M;
    let mut mesh = Mesh::default();
    let mut link = |y: [f64; 2], z: [f64; 2], half_m: f64| {
        let square = |x: f64, y: f64, z: f64| {
            [
                [x, y - half_m, z - half_m],
                [x, y + half_m, z - half_m],
                [x, y + half_m, z + half_m],
                [x, y - half_m, z + half_m],
            ]
        };
        let (start, finish) = (square(0.0, y[0], z[0]), square(end, y[1], z[1]));
        // As a tower that lies: its floor is the end that the other one is ahead of.
        let (floor, roof) = if end < 0.0 { (finish, start) } else { (start, finish) };
        mesh.tower(floor, roof, IRON);
    };
    link([0.35, 0.42], [0.0; 2], 0.05);
    link([-0.35, -0.42], [0.0; 2], 0.05);
    link([0.0; 2], [0.5, 0.75], 0.04);
    mesh
}

/// Draws what hangs on the hitch of a vehicle, below its entity.
pub(crate) fn draw(
    to: &Recorder,
    base: &EntityPath,
    lane: &Lane,
    rig: &Rig,
    implement: &Implement,
) -> Result<(), ViewError> {
    let Lane { run, path, colour, .. } = lane;
    let Some(lifted) = lifted(run, implement) else { return Ok(()) };
    let [ahead_m, height_m] = implement.hitch_m;
    let way = implement.way(rig);
    let lift_m = implement.lift_m.unwrap_or(LIFT_M);
    let tools_m = ahead_m + way * 0.5 * (ROWS_M[0] + ROWS_M[1]);
    // At work it follows the ground; lifted it goes with the vehicle.
    let raised_m: Vec<f64> = path
        .poses
        .iter()
        .map(|pose| {
            let share = lifted[pose.row];
            (1.0 - share) * ground_m(run, rig, pose.row, tools_m) + share * lift_m
        })
        .collect();
    let (times, each) = (|| path.poses.iter().map(|pose| pose.time_s), || vec![1; path.poses.len()]);
    let at = part(&part(base, "implements"), &implement.name);
    let hung = part(&at, "frame");
    to.fixed(&hung, &vehicle::surface(&frame(implement, way, *colour)))?;
    let places = raised_m.iter().map(|raised_m| single([ahead_m, 0.0, *raised_m]));
    to.rows(&hung, times(), Transform3D::update_fields().with_many_translation(places).columns(each()))?;
    // The links begin on the vehicle and end where the frame is: they shear.
    let held = part(&at, "links");
    to.fixed(&held, &vehicle::surface(&links(way)))?;
    let begin = [ahead_m - way * LINKS_M, 0.0, height_m];
    let shears = raised_m.iter().map(|raised_m| {
        let [.., slope] = single([0.0, 0.0, raised_m / (way * LINKS_M)]);
        TransformMat3x3::from(Mat3x3::from([[1.0, 0.0, slope], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    });
    let begins = raised_m.iter().map(|_| single(begin));
    let columns = Transform3D::update_fields().with_many_translation(begins).with_many_mat3x3(shears);
    to.rows(&held, times(), columns.columns(each()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tests::run;
    use crate::setting::tests::wheel;

    fn plough() -> Implement {
        Implement {
            name: "plough".to_owned(),
            hitch_m: [-3.0, 0.7],
            width_m: 3.0,
            depth_m: Some(0.25),
            tools: None,
            lift_m: Some(0.7),
        }
    }

    fn extent(mesh: &Mesh, axis: usize) -> [f32; 2] {
        let along = || mesh.positions.iter().map(|at| at[axis]);
        [along().fold(f32::MAX, f32::min), along().fold(f32::MIN, f32::max)]
    }

    #[test]
    fn a_plough_is_as_wide_and_as_deep_as_it_works_and_hangs_on_its_own_side() {
        let behind = frame(&plough(), -1.0, [1; 3]);
        assert_eq!((extent(&behind, 1), extent(&behind, 2)[0]), ([-1.5, 1.5], -0.25));
        assert!(extent(&behind, 0)[1] < 0.1 && extent(&behind, 0)[0] < -1.6, "{:?}", extent(&behind, 0));
        let before = frame(&plough(), 1.0, [1; 3]);
        assert!(extent(&before, 0)[0] > -0.1 && extent(&before, 0)[1] > 1.6, "{:?}", extent(&before, 0));
        let over = frame(&Implement { depth_m: None, ..plough() }, -1.0, [1; 3]);
        assert_eq!((extent(&over, 1), extent(&over, 2)[0]), ([-1.5, 1.5], 0.0));
    }

    /// 3 m by 0.45 m are 7 tools.
    #[test]
    fn it_has_as_many_tools_as_it_says() {
        let corners = |tools| frame(&Implement { tools, ..plough() }, -1.0, [1; 3]).positions.len();
        let one = corners(Some(2.0)) - corners(Some(1.0));
        assert_eq!(corners(Some(13.0)) - corners(Some(1.0)), 12 * one);
        assert_eq!(corners(None), corners(Some(7.0)));
    }

    #[test]
    fn it_is_lifted_as_its_hitch_says_or_where_its_area_does_not_grow() {
        let hitched = run("r1", &[("plough_lifted", &[1.0, 0.4, 0.0]), ("plough_area_m2", &[0.0; 3])]);
        assert_eq!(lifted(&hitched, &plough()), Some(vec![1.0, 0.4, 0.0]));
        // It stands, works, stands in the ground, drives on without working, and stands.
        let area: &[f64] = &[0.0, 0.0, 2.0, 4.0, 4.0, 4.0, 4.0];
        let speed: &[f64] = &[0.0, 0.0, 2.0, 2.0, 0.0, 2.0, 0.0];
        let bare = run("r1", &[("plough_area_m2", area), ("speed_m_s", speed)]);
        assert_eq!(lifted(&bare, &plough()), Some(vec![0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0]));
        assert_eq!(lifted(&run("r1", &[("speed_m_s", speed)]), &plough()), None);
    }

    /// A front wheel whose tyre gives way by 0.2 m, 50 mm deep: hub 0.9 m up, ground 0.9 − (1 − 0.2 − 0.05) = 0.15 m; a rear one
    /// without either, −0.1 m, 3 m behind it. On the line through both, 3 m further behind, −0.35 m.
    #[test]
    fn the_ground_below_it_is_on_the_line_through_that_below_the_wheels() {
        let rear = crate::setting::RigWheel { name: "rear".to_owned(), hub_m: [-1.5, 1.0, 0.9], ..wheel() };
        let rig = Rig { centre_height_m: 1.2, wheels: vec![wheel(), rear] };
        let run = run(
            "r1",
            &[
                ("axle_1_left_load_n", &[3e4, 0.0]),
                ("axle_1_left_deflection_m", &[0.2, 0.0]),
                ("axle_1_left_sinkage_m", &[0.05, 0.0]),
                ("rear_load_n", &[3e4, 0.0]),
            ],
        );
        assert!((ground_m(&run, &rig, 0, -4.5) + 0.35).abs() < 1e-12);
        assert_eq!(ground_m(&run, &rig, 1, -4.5), 0.0, "in the air it stays with the vehicle");
    }
}
