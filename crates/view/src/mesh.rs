//! Triangles with colours.

use crate::colour::Colour;

/// A surface whose faces are flat and of one colour each.
#[derive(Debug, Default)]
pub(crate) struct Mesh {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub colours: Vec<Colour>,
    pub triangles: Vec<[u32; 3]>,
}

/// A point in double precision.
pub(crate) type Point = [f64; 3];

fn minus(one: Point, other: Point) -> Point {
    [one[0] - other[0], one[1] - other[1], one[2] - other[2]]
}

fn cross(one: Point, other: Point) -> Point {
    [
        one[1] * other[2] - one[2] * other[1],
        one[2] * other[0] - one[0] * other[2],
        one[0] * other[1] - one[1] * other[0],
    ]
}

#[expect(clippy::cast_possible_truncation, reason = "pictures are drawn in single precision")]
pub(crate) fn single(point: Point) -> [f32; 3] {
    point.map(|part| part as f32)
}

impl Mesh {
    /// A flat face with three or more corners, counterclockwise seen from outside.
    pub(crate) fn face(&mut self, corners: &[Point], colour: Colour) {
        let normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
        let length = normal.iter().map(|part| part * part).sum::<f64>().sqrt();
        if length == 0.0 {
            return;
        }
        let first = self.next();
        for corner in corners {
            self.positions.push(single(*corner));
            self.normals.push(single(normal.map(|part| part / length)));
            self.colours.push(colour);
        }
        for corner in (1..).take(corners.len() - 2) {
            self.triangles.push([first, first + corner, first + corner + 1]);
        }
    }

    /// A box from its lowest to its highest corner.
    pub(crate) fn block(&mut self, low: Point, high: Point, colour: Colour) {
        let floor = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
        self.tower(floor.map(|[x, y]| [x, y, low[2]]), floor.map(|[x, y]| [x, y, high[2]]), colour);
    }

    /// What lies between a floor and a roof of four corners each, counterclockwise seen from above.
    pub(crate) fn tower(&mut self, floor: [Point; 4], roof: [Point; 4], colour: Colour) {
        self.face(&[floor[3], floor[2], floor[1], floor[0]], colour);
        self.face(&roof, colour);
        for side in 0..4 {
            let next = (side + 1) % 4;
            self.face(&[floor[side], floor[next], roof[next], roof[side]], colour);
        }
    }

    /// Gives every face the colour that its own one turns into.
    pub(crate) fn recolour(&mut self, into: impl Fn(Colour) -> Colour) {
        for colour in &mut self.colours {
            *colour = into(*colour);
        }
    }

    fn next(&self) -> u32 {
        u32::try_from(self.positions.len()).unwrap_or(u32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The divergence theorem: a closed surface whose faces look outward encloses (1/3) Σ p·n A.
    #[test]
    fn a_box_is_closed_and_looks_outward() {
        let mut mesh = Mesh::default();
        mesh.block([1.0, 2.0, 3.0], [2.0, 4.0, 7.0], [0; 3]);
        let volume: f64 = mesh
            .triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|index| mesh.positions[index as usize].map(f64::from));
                let normal = mesh.normals[corners[0] as usize].map(f64::from);
                let turn = cross(minus(b, a), minus(c, a));
                assert!(turn.iter().zip(normal).all(|(turn, normal)| turn * normal >= 0.0));
                a.iter().zip(turn).map(|(a, turn)| a * turn).sum::<f64>() / 6.0
            })
            .sum();
        assert!((volume - 8.0).abs() < 1e-9, "{volume}");
    }
}
