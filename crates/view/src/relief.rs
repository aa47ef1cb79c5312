//! The ground around a path as a surface, coloured by what it is, or by its height.

use crate::colour::Colour;
use crate::mesh::{Mesh, Point, single};
use crate::path::Pose;
use crate::setting::Relief;
use crate::strip::round_up;

/// Points of the surface, about.
const POINTS: f64 = 80_000.0;
/// None is finer [m].
const FINEST_M: f64 = 0.2;
/// Light and dark squares of this length show how the ground passes by [m].
pub(crate) const SQUARE_M: f64 = 10.0;
/// How much darker the dark ones are, out of 255.
const SHADE: u16 = 236;
/// Ground that rises by less is level [m].
const LEVEL_M: f64 = 0.05;

/// From the lowest to the highest ground: lighter is higher, so that the order can be read without seeing hues.
const HEIGHTS: [Colour; 4] = [[66, 96, 112], [104, 128, 118], [164, 160, 112], [232, 218, 164]];
/// Ground that is level.
const PLAIN: Colour = [134, 118, 92];
/// Kinds of ground, with the names of their colours.
const KINDS: [(&str, Colour); 6] = [
    ("sand", [206, 186, 138]),
    ("slate", [104, 122, 138]),
    ("olive", [130, 138, 74]),
    ("brown", [124, 88, 62]),
    ("rose", [186, 138, 132]),
    ("dark green", [62, 98, 84]),
];

/// What was drawn.
#[derive(Debug)]
pub(crate) struct Surveyed {
    pub mesh: Mesh,
    /// Lowest and highest ground [m].
    pub heights_m: [f64; 2],
    /// Kinds of ground, each with the name of its colour; empty where the ground is coloured by its height.
    pub kinds: Vec<(String, &'static str)>,
}

impl Surveyed {
    /// Whether its colours are heights.
    pub(crate) fn by_height(&self) -> bool {
        self.kinds.is_empty() && self.heights_m[1] - self.heights_m[0] >= LEVEL_M
    }
}

/// A colour between those of `HEIGHTS`, at a share of the way from the lowest to the highest.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "shares and colours are small")]
fn of_height(share: f64) -> Colour {
    let last = HEIGHTS.len() - 1;
    let place = share.clamp(0.0, 1.0) * last as f64;
    let left = (place as usize).min(last - 1);
    let part = place - left as f64;
    let mix = |axis: usize| {
        let (one, other) = (f64::from(HEIGHTS[left][axis]), f64::from(HEIGHTS[left + 1][axis]));
        (one + part * (other - one)).round() as u8
    };
    [mix(0), mix(1), mix(2)]
}

/// How far beyond the reach the corners lie of a cell that the border cuts, in cells.
const BORDER: f64 = std::f64::consts::SQRT_2;

/// Cells of the map, and how near to a path their corners are.
struct Map {
    west_m: f64,
    south_m: f64,
    spacing_m: f64,
    columns: usize,
    reach_m: f64,
    /// The nearest place of the path and its distance [m], for each corner of a cell that has a part within reach.
    near: Vec<Option<(f64, [f64; 2])>>,
}

impl Map {
    fn around(places: &[[f64; 2]], reach_m: f64) -> Self {
        let ends = |axis: usize| {
            let along = || places.iter().map(|place| place[axis]);
            [along().fold(f64::MAX, f64::min) - reach_m, along().fold(f64::MIN, f64::max) + reach_m]
        };
        let ([west_m, east_m], [south_m, north_m]) = (ends(0), ends(1));
        let way_m: f64 =
            places.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).sum();
        let area_m2 = ((way_m + 2.0 * reach_m) * 2.0 * reach_m).min((east_m - west_m) * (north_m - south_m));
        let spacing_m = round_up((area_m2 / POINTS).sqrt()).max(FINEST_M);
        let (west_m, south_m) = (west_m - BORDER * spacing_m, south_m - BORDER * spacing_m);
        let count = |from: f64, to: f64| points((to - from) / spacing_m + BORDER);
        let (columns, rows) = (count(west_m, east_m), count(south_m, north_m));
        let mut map = Self { west_m, south_m, spacing_m, columns, reach_m, near: vec![None; columns * rows] };
        let mut before: Option<[f64; 2]> = None;
        for (index, place) in places.iter().enumerate() {
            let moved =
                before.is_none_or(|last| (place[0] - last[0]).hypot(place[1] - last[1]) > reach_m / 4.0);
            if moved || index + 1 == places.len() {
                map.mark(*place);
                before = Some(*place);
            }
        }
        map
    }

    fn mark(&mut self, [east_m, north_m]: [f64; 2]) {
        let reach_m = self.reach_m + BORDER * self.spacing_m;
        let reach = points(reach_m / self.spacing_m);
        let (column, row) = (
            points((east_m - self.west_m) / self.spacing_m),
            points((north_m - self.south_m) / self.spacing_m),
        );
        let rows = self.near.len() / self.columns;
        for row in row.saturating_sub(reach)..(row + reach).min(rows) {
            for column in column.saturating_sub(reach)..(column + reach).min(self.columns) {
                let [e, n] = self.corner(column, row);
                let distance_m = (e - east_m).hypot(n - north_m);
                let near = &mut self.near[row * self.columns + column];
                if distance_m <= reach_m && near.is_none_or(|(before_m, _)| distance_m < before_m) {
                    *near = Some((distance_m, [east_m, north_m]));
                }
            }
        }
    }

    /// Where a corner is drawn: one beyond the reach at the border, so that the border is round and not stairs.
    fn at(&self, cell: usize) -> [f64; 2] {
        let [e, n] = self.corner(cell % self.columns, cell / self.columns);
        match self.near[cell] {
            Some((distance_m, [east_m, north_m])) if distance_m > self.reach_m => {
                let share = self.reach_m / distance_m;
                [east_m + share * (e - east_m), north_m + share * (n - north_m)]
            }
            _ => [e, n],
        }
    }

    fn within(&self, column: usize, row: usize) -> bool {
        self.near[row * self.columns + column].is_some_and(|(distance_m, _)| distance_m <= self.reach_m)
    }

    fn corner(&self, column: usize, row: usize) -> [f64; 2] {
        [self.west_m + column as f64 * self.spacing_m, self.south_m + row as f64 * self.spacing_m]
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a map of so many points fits the memory"
)]
fn points(cells: f64) -> usize {
    cells.ceil().max(0.0) as usize + 1
}

/// The ground within `reach_m` of the poses, which were moved by `shift` from where the ground knows them.
pub(crate) fn survey(relief: &dyn Relief, poses: &[Pose], reach_m: f64, shift: Point) -> Option<Surveyed> {
    let places: Vec<[f64; 2]> =
        poses.iter().map(|pose| [pose.at[0] - shift[0], pose.at[1] - shift[1]]).collect();
    if places.is_empty() {
        return None;
    }
    let map = Map::around(&places, reach_m);
    let mut mesh = Mesh::default();
    let mut known: Vec<(usize, f64)> = Vec::new();
    let mut kinds: Vec<String> = Vec::new();
    let mut kind_of: Vec<Option<usize>> = Vec::new();
    let mut index = vec![None; map.near.len()];
    for cell in (0..map.near.len()).filter(|cell| map.near[*cell].is_some()) {
        let [east_m, north_m] = map.at(cell);
        let Some(height_m) = relief.height_m(east_m, north_m).filter(|height| height.is_finite()) else {
            continue;
        };
        index[cell] = u32::try_from(mesh.positions.len()).ok();
        known.push((cell, height_m));
        mesh.positions.push(single([east_m + shift[0], north_m + shift[1], height_m + shift[2]]));
        kind_of.push(relief.kind(east_m, north_m).map(|kind| {
            kinds.iter().position(|known| known == kind).unwrap_or_else(|| {
                kinds.push(kind.to_owned());
                kinds.len() - 1
            })
        }));
    }
    let heights = || known.iter().map(|(_, height)| *height);
    let heights_m = [heights().fold(f64::MAX, f64::min), heights().fold(f64::MIN, f64::max)];
    let range_m = heights_m[1] - heights_m[0];
    for ((cell, height_m), kind) in known.iter().zip(&kind_of) {
        let place = map.at(*cell);
        let colour = match kind {
            Some(kind) if kinds.len() > 1 => KINDS[kind % KINDS.len()].1,
            _ if range_m >= LEVEL_M => of_height((height_m - heights_m[0]) / range_m),
            _ => PLAIN,
        };
        let dark = place.iter().map(|at| (at / SQUARE_M).floor()).sum::<f64>().rem_euclid(2.0) == 1.0;
        mesh.colours.push(if dark { colour.map(shaded) } else { colour });
    }
    lay(&mut mesh, &map, &index);
    let kinds = if kinds.len() > 1 { kinds } else { Vec::new() };
    let kinds =
        kinds.into_iter().enumerate().map(|(index, kind)| (kind, KINDS[index % KINDS.len()].0)).collect();
    (!mesh.triangles.is_empty()).then_some(Surveyed { mesh, heights_m, kinds })
}

fn shaded(part: u8) -> u8 {
    u8::try_from(u16::from(part) * SHADE / 255).unwrap_or(u8::MAX)
}

/// Triangles between points that are known, and the normal of each point from its neighbours.
fn lay(mesh: &mut Mesh, map: &Map, index: &[Option<u32>]) {
    let rows = index.len() / map.columns;
    let at = |column: usize, row: usize| index[row * map.columns + column];
    for row in 0..rows - 1 {
        for column in 0..map.columns - 1 {
            let corners =
                [at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)];
            let within =
                [(0, 0), (1, 0), (1, 1), (0, 1)].iter().any(|(c, r)| map.within(column + c, row + r));
            if let ([Some(a), Some(b), Some(c), Some(d)], true) = (corners, within) {
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    // Of each point the mean normal of its triangles, larger ones counting more: corners at the border lie anywhere.
    let mut normals = vec![[0.0f32; 3]; mesh.positions.len()];
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
        let [u, v] = [b, c].map(|other| [other[0] - a[0], other[1] - a[1], other[2] - a[2]]);
        let own = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        for corner in corners {
            for (sum, part) in normals[*corner as usize].iter_mut().zip(own) {
                *sum += part;
            }
        }
    }
    for normal in &mut normals {
        let length = normal.iter().map(|part| part * part).sum::<f32>().sqrt();
        *normal = if length > 0.0 { normal.map(|part| part / length) } else { [0.0, 0.0, 1.0] };
    }
    mesh.normals = normals;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rises by 1 in 10 to the east, sand west of 5 m and clay east of it, and ends 12 m east.
    #[derive(Debug)]
    struct Slope;
    impl Relief for Slope {
        fn height_m(&self, east_m: f64, _: f64) -> Option<f64> {
            (east_m <= 12.0).then_some(0.1 * east_m)
        }
        fn kind(&self, east_m: f64, _: f64) -> Option<&str> {
            Some(if east_m < 5.0 { "field" } else { "road" })
        }
    }

    #[derive(Debug)]
    struct Bare;
    impl Relief for Bare {
        fn height_m(&self, east_m: f64, _: f64) -> Option<f64> {
            Some(0.1 * east_m)
        }
    }

    fn way() -> Vec<Pose> {
        (0..50)
            .map(|step| Pose { at: [f64::from(step) * 0.2 + 100.0, 7.0, 0.0], ..Pose::default() })
            .collect()
    }

    #[test]
    fn the_ground_lies_around_the_path_as_far_as_it_is_known() {
        let ground = survey(&Slope, &way(), 4.0, [100.0, 7.0, 3.0]).unwrap();
        let positions = &ground.mesh.positions;
        assert!(positions.iter().all(|at| at[0] <= 112.001 && at[0] >= 95.9 && (at[1] - 7.0).abs() <= 4.01));
        assert!(positions.iter().all(|at| (at[2] - 3.0 - 0.1 * (at[0] - 100.0)).abs() < 1e-5));
        let length = 101f32.sqrt();
        let normals =
            ground.mesh.triangles.iter().flatten().map(|corner| ground.mesh.normals[*corner as usize]);
        assert!(
            normals
                .into_iter()
                .all(|n| (n[0] + 1.0 / length).abs() < 1e-3 && (n[2] - 10.0 / length).abs() < 1e-3)
        );
        assert_eq!(
            (positions.len(), ground.mesh.colours.len()),
            (ground.mesh.normals.len(), positions.len())
        );
        // The area seen from above is that of a corridor of 8 m around 9.8 m of path, cut off at 12 m.
        let area: f64 = ground
            .mesh
            .triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| positions[corner as usize].map(f64::from));
                ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
            })
            .sum();
        // Its border is round, not stairs of cells, which would lack more than a sixth of a cell's width along 28 m; where the ground
        // ends, at most a cell's width is left out along 8 m.
        let whole = 9.8 * 8.0 + 25.1 + 17.4;
        let least = whole - 28.0 * 0.2 / 6.0 - 8.0 * 0.2;
        assert!(area <= whole && area > least, "{area} of {whole}");
    }

    #[test]
    fn kinds_of_ground_have_colours_and_one_kind_shows_its_height() {
        let ground = survey(&Slope, &way(), 4.0, [100.0, 7.0, 0.0]).unwrap();
        let kinds: Vec<&str> = ground.kinds.iter().map(|(kind, _)| kind.as_str()).collect();
        assert!(kinds == ["field", "road"] && !ground.by_height(), "{kinds:?}");
        let bare = survey(&Bare, &way(), 4.0, [100.0, 7.0, 0.0]).unwrap();
        assert!(bare.kinds.is_empty() && bare.by_height());
        assert!(
            (bare.heights_m[0] + 0.4).abs() < 0.02 && (bare.heights_m[1] - 1.38).abs() < 0.03,
            "{:?}",
            bare.heights_m
        );
    }

    /// Whoever sees no hues sees the order of heights by their lightness.
    #[test]
    fn higher_ground_is_lighter() {
        let light = |share: f64| {
            let [red, green, blue] = of_height(share).map(f64::from);
            0.299 * red + 0.587 * green + 0.114 * blue
        };
        assert!(
            (0..100).all(|step| light(f64::from(step) / 100.0) < light(f64::from(step + 1) / 100.0) + 1e-9)
        );
        assert_eq!((of_height(0.0), of_height(1.0)), (HEIGHTS[0], HEIGHTS[3]));
    }
}
