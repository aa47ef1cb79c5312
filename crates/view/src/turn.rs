//! Which way things point: rotations as quaternions x, y, z, w.

use crate::mesh::Point;
use crate::path::Pose;
use rerun::Quaternion;

pub(crate) type Turn = [f64; 4];

/// About an axis of the frame: 0 ahead, 1 to the left, 2 up; counterclockwise seen from its tip [rad].
pub(crate) fn about(axis: usize, angle_rad: f64) -> Turn {
    let (sine, cosine) = (angle_rad / 2.0).sin_cos();
    let mut turn = [0.0, 0.0, 0.0, cosine];
    turn[axis] = sine;
    turn
}

/// First `other`, then `one`.
pub(crate) fn then([a, b, c, d]: Turn, [e, f, g, h]: Turn) -> Turn {
    [
        d * e + a * h + b * g - c * f,
        d * f - a * g + b * h + c * e,
        d * g + a * f - b * e + c * h,
        d * h - a * e - b * f - c * g,
    ]
}

/// A vector after a rotation.
pub(crate) fn rotated([x, y, z, w]: Turn, v: Point) -> Point {
    let cross = |a: Point, b: Point| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let u = [x, y, z];
    let inner = cross(u, v);
    let turned = cross(u, [0, 1, 2].map(|axis| inner[axis] + w * v[axis]));
    [0, 1, 2].map(|axis| v[axis] + 2.0 * turned[axis])
}

/// From the frame of a vehicle to that of the world: q_z(π/2 − heading) q_y(−pitch) q_x(roll).
pub(crate) fn of(pose: &Pose) -> Turn {
    let level = then(about(2, std::f64::consts::FRAC_PI_2 - pose.heading_rad), about(1, -pose.pitch_rad));
    then(level, about(0, pose.roll_rad))
}

#[expect(clippy::cast_possible_truncation, reason = "pictures are drawn in single precision")]
pub(crate) fn quaternion(turn: Turn) -> Quaternion {
    Quaternion::from_xyzw(turn.map(|part| part as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(one: Point, other: Point) -> bool {
        one.iter().zip(other).all(|(one, other)| (one - other).abs() < 1e-12)
    }

    /// The nose points to (sin h cos p, cos h cos p, sin p), the left side of a vehicle that does not roll stays level.
    #[test]
    fn the_nose_points_where_the_heading_and_the_pitch_say() {
        for (heading_rad, pitch_rad) in [(0.0f64, 0.0f64), (1.2, 0.3), (-2.0, -0.1), (3.0, 0.2)] {
            let pose = Pose { heading_rad, pitch_rad, ..Pose::default() };
            let level = pitch_rad.cos();
            let nose = [heading_rad.sin() * level, heading_rad.cos() * level, pitch_rad.sin()];
            assert!(near(rotated(of(&pose), [1.0, 0.0, 0.0]), nose));
            let left = [-heading_rad.cos(), heading_rad.sin(), 0.0];
            assert!(near(rotated(of(&pose), [0.0, 1.0, 0.0]), left));
        }
    }

    /// As the rigid body writes it: tan roll = left.z / up.z, the right side down.
    #[test]
    fn a_positive_roll_raises_the_left_side() {
        let pose = Pose { heading_rad: 0.7, pitch_rad: 0.2, roll_rad: 0.3, ..Pose::default() };
        let (left, up) = (rotated(of(&pose), [0.0, 1.0, 0.0]), rotated(of(&pose), [0.0, 0.0, 1.0]));
        assert!((left[2].atan2(up[2]) - 0.3).abs() < 1e-12, "{left:?} {up:?}");
        assert!((rotated(of(&pose), [1.0, 0.0, 0.0])[2].asin() - 0.2).abs() < 1e-12);
    }

    #[test]
    fn two_quarter_turns_are_half_a_turn() {
        let quarter = about(2, std::f64::consts::FRAC_PI_2);
        assert!(near(rotated(quarter, [1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]));
        assert!(near(rotated(then(quarter, quarter), [1.0, 2.0, 3.0]), [-1.0, -2.0, 3.0]));
    }
}
