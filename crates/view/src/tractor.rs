//! A tractor, from its outer measures.
//!
//! It looks along x, its left is y, and the origin lies on the ground halfway between its axles.

use crate::Body;
use crate::colour::{Colour, MODELLED};
use crate::mesh::{Mesh, Point};
use std::f64::consts::TAU;

const TYRE: Colour = [58, 58, 62];
const LUG: Colour = [92, 92, 98];
const IRON: Colour = [84, 88, 94];
const RIM: Colour = [226, 226, 220];
const SPOKE: Colour = [120, 122, 126];
const GLASS: Colour = [150, 196, 216];
const LAMP: Colour = [255, 250, 220];
/// Steps around a wheel; every other one carries a lug.
const STEPS: u32 = 48;

/// Width of a tyre [m]: from the outer edge in to the middle of the track, and as much again.
pub(crate) fn tyre_width_m(body: &Body) -> f64 {
    (body.width_m - body.track_m).clamp(0.25 * body.wheel_radius_m, 0.45 * body.width_m)
}

/// Where the wheels' middles are: front left, front right, rear left, rear right.
pub(crate) fn wheels(body: &Body) -> [(&'static str, Point); 4] {
    let (x, z) = (body.wheelbase_m / 2.0, body.wheel_radius_m);
    let y = (body.width_m - tyre_width_m(body)) / 2.0;
    [
        ("front_left", [x, y, z]),
        ("front_right", [x, -y, z]),
        ("rear_left", [-x, y, z]),
        ("rear_right", [-x, -y, z]),
    ]
}

/// A wheel around the origin that turns about y: lugs on the tyre and spokes on the rim show that it does.
pub(crate) fn wheel(radius_m: f64, width_m: f64) -> Mesh {
    let (radius, half) = (radius_m, width_m / 2.0);
    let at = |step: u32, radius: f64, y: f64| -> Point {
        let (sine, cosine) = (TAU * f64::from(step) / f64::from(STEPS)).sin_cos();
        [radius * cosine, y, radius * sine]
    };
    let mut mesh = Mesh::default();
    for step in 0..STEPS {
        let lug = step % 4 < 2;
        let (outer, colour) = if lug { (radius, LUG) } else { (0.94 * radius, TYRE) };
        let rim = 0.58 * radius;
        let spoke = if step % 12 < 4 { SPOKE } else { RIM };
        let next = step + 1;
        let tread =
            [at(step, outer, half), at(next, outer, half), at(next, outer, -half), at(step, outer, -half)];
        mesh.face(&tread, colour);
        for side in [-1.0, 1.0] {
            let (edge, inset) = (side * half, side * 0.8 * half);
            let mut wall =
                [at(step, rim, edge), at(next, rim, edge), at(next, outer, edge), at(step, outer, edge)];
            let mut lip =
                [at(step, rim, inset), at(next, rim, inset), at(next, rim, edge), at(step, rim, edge)];
            let mut disc = [[0.0, inset, 0.0], at(step, rim, inset), at(next, rim, inset)];
            if side < 0.0 {
                wall.reverse();
                lip.reverse();
            } else {
                disc.reverse();
            }
            mesh.face(&wall, if lug { LUG } else { TYRE });
            mesh.face(&lip, IRON);
            mesh.face(&disc, spoke);
        }
    }
    mesh
}

/// Everything but the wheels.
pub(crate) fn body(body: &Body) -> Mesh {
    let Body { length_m, width_m, height_m, wheel_radius_m: r, .. } = *body;
    let (front, rear) = (length_m / 2.0, -length_m / 2.0);
    let axle = body.wheelbase_m / 2.0;
    let tyre = tyre_width_m(body);
    let slim = (width_m / 2.0 - tyre).max(0.15 * width_m) * 0.92;
    let sill = (1.15 * r).min(0.5 * height_m);
    let hood = sill.midpoint(height_m) * 1.04;
    let (cab_rear, cab_front) = (-0.62 * axle - 0.1 * r, 0.35 * axle);
    let mut mesh = Mesh::default();
    // Frame, axles, front weight, hitch.
    mesh.block([rear * 0.86, -slim * 0.7, 0.6 * r], [front * 0.9, slim * 0.7, sill], IRON);
    for x in [-axle, axle] {
        let reach = width_m / 2.0 - tyre * 0.7;
        mesh.block([x - 0.14 * r, -reach, 0.86 * r], [x + 0.14 * r, reach, 1.14 * r], IRON);
    }
    mesh.block([front * 0.9, -slim, 0.55 * r], [front, slim, sill], IRON);
    for y in [-0.6 * slim, 0.6 * slim] {
        mesh.block([rear, y - 0.06 * r, 0.5 * r], [rear * 0.8, y + 0.06 * r, 0.68 * r], IRON);
    }
    // Hood, falling and narrowing to the nose, with lamps and the exhaust.
    let nose = front * 0.94;
    mesh.tower(
        [[cab_front, -slim, sill], [nose, -slim, sill], [nose, slim, sill], [cab_front, slim, sill]],
        [
            [cab_front, -slim * 0.92, hood],
            [nose, -slim * 0.72, hood * 0.93],
            [nose, slim * 0.72, hood * 0.93],
            [cab_front, slim * 0.92, hood],
        ],
        MODELLED,
    );
    for y in [-0.4 * slim, 0.4 * slim] {
        let z = sill + 0.6 * (hood - sill);
        mesh.block([nose, y - 0.18 * slim, z], [nose + 0.04 * r, y + 0.18 * slim, z + 0.16 * r], LAMP);
    }
    let pipe = [cab_front + 0.25 * r, -slim, sill];
    mesh.block([pipe[0], pipe[1] - 0.16 * r, pipe[2]], [pipe[0] + 0.14 * r, pipe[1], height_m * 0.98], IRON);
    // Cab: doors, glass that leans in, posts, roof.
    let wide = (width_m / 2.0 - 0.55 * tyre).max(slim);
    let door = sill + 0.22 * (height_m - sill);
    mesh.block([cab_rear, -wide, sill], [cab_front, wide, door], MODELLED);
    let top = height_m - 0.1 * r;
    let square = |low_x: f64, high_x: f64, y: f64, z: f64| {
        [[low_x, -y, z], [high_x, -y, z], [high_x, y, z], [low_x, y, z]]
    };
    mesh.tower(
        square(cab_rear, cab_front, wide, door),
        square(cab_rear + 0.12 * r, cab_front - 0.18 * r, wide * 0.86, top),
        GLASS,
    );
    for y in [-1.0, 1.0] {
        for (low, high) in [(cab_rear, cab_rear + 0.12 * r), (cab_front - 0.09 * r, cab_front - 0.27 * r)] {
            let foot = [low - 0.02 * r, low + 0.1 * r];
            let head = [high - 0.02 * r, high + 0.1 * r];
            let edge = |x: [f64; 2], y: f64, z: f64| {
                let (right, left) = (y - 0.06 * r, y + 0.06 * r);
                [[x[0], right, z], [x[1], right, z], [x[1], left, z], [x[0], left, z]]
            };
            mesh.tower(edge(foot, y * wide * 0.99, door), edge(head, y * wide * 0.86, top), IRON);
        }
    }
    mesh.block([cab_rear - 0.02 * r, -wide * 0.92, top], [cab_front, wide * 0.92, height_m], MODELLED);
    // Fenders: three flat pieces over each wheel.
    let clear = 1.1 * r;
    for (_, [x, y, z]) in wheels(body) {
        let (inner, outer) = (y.abs() - tyre * 0.5, y.abs() + tyre * 0.42);
        let (low, high) = if y > 0.0 { (inner, outer) } else { (-outer, -inner) };
        let at = |degrees: f64, radius: f64| {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            [x - radius * cosine, z + radius * sine]
        };
        let angles: [f64; 4] = [55.0, 80.0, 105.0, 130.0];
        for pair in angles.windows(2) {
            let [under, over] = [clear, clear + 0.06 * r].map(|radius| pair_at(&at, pair, radius));
            let plate = |[start, end]: [[f64; 2]; 2]| {
                [
                    [start[0], low, start[1]],
                    [end[0], low, end[1]],
                    [end[0], high, end[1]],
                    [start[0], high, start[1]],
                ]
            };
            mesh.tower(plate(under), plate(over), MODELLED);
        }
    }
    mesh
}

fn pair_at(at: &impl Fn(f64, f64) -> [f64; 2], pair: &[f64], radius: f64) -> [[f64; 2]; 2] {
    [at(pair[0], radius), at(pair[1], radius)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent(mesh: &Mesh) -> [[f32; 2]; 3] {
        [0, 1, 2].map(|axis| {
            let along = || mesh.positions.iter().map(|at| at[axis]);
            [along().fold(f32::MAX, f32::min), along().fold(f32::MIN, f32::max)]
        })
    }

    #[test]
    fn the_tractor_has_the_measures_it_was_given() {
        let measures = Body {
            length_m: 6.0,
            width_m: 3.0,
            height_m: 3.5,
            wheel_radius_m: 0.95,
            wheelbase_m: 3.3,
            track_m: 2.3,
        };
        let [x, y, z] = extent(&body(&measures));
        assert_eq!((x, z[1]), ([-3.0, 3.0], 3.5));
        assert!(y[0] >= -1.5 && y[1] <= 1.5 && z[0] > 0.0, "{y:?} {z:?}");
        let [x, y, z] = extent(&wheel(measures.wheel_radius_m, tyre_width_m(&measures)));
        assert!([x, z].iter().flatten().all(|edge| (edge.abs() - 0.95).abs() < 0.01), "{x:?} {z:?}");
        let (_, left) = wheels(&measures)[0];
        assert!((left[1] + f64::from(y[1]) - 1.5).abs() < 1e-6, "the tyre ends at the outer width");
    }
}
