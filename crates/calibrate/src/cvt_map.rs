//! A map of engine speeds over speed and force, from what a recording saw.
//!
//! At a node:  min over ω, a, b of  Σ w (ω_i − ω − a x_i − b y_i)²,  w = (1 − |x|) (1 − |y|)
//! x, y from the node, in cells of the grid; a and b are held by a small ridge where samples lie in one line, and ω within the
//! engine speeds that were seen about the node
//!
//! Source: Cleveland, "Robust locally weighted regression and smoothing scatterplots", Journal of the American Statistical
//! Association 74 (1979), 829-836, for local lines; the weights are those with which the map is read.
//!
//! A node stands where enough samples lie within half a cell of it, and nowhere else: nothing is extrapolated by more.

/// One instant of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Speed at the wheels [m/s].
    pub speed_m_s: f64,
    /// Force at the wheels [N].
    pub force_n: f64,
    /// Speed of the engine [rad/s].
    pub engine_rad_s: f64,
}

/// A map of engine speeds.
#[derive(Clone, Debug, PartialEq)]
pub struct CvtMap {
    /// Speeds of its nodes [m/s].
    pub speeds_m_s: Vec<f64>,
    /// Forces of its nodes [N].
    pub forces_n: Vec<f64>,
    /// Engine speed at each speed and force [rad/s]; `None` where it was not seen.
    pub engine_rad_s: Vec<Vec<Option<f64>>>,
    /// Samples within half a cell of each node.
    pub samples: Vec<Vec<usize>>,
}

/// How far a map is from samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Misfit {
    /// How many samples there are.
    pub samples: usize,
    /// For how many of them the map knows an engine speed.
    pub known: usize,
    /// Root of the mean square of what it is wrong by [rad/s]; NaN where it knows none.
    pub rmse_rad_s: f64,
}

/// Why no map can be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CvtMapError {
    /// Too few samples to lay a grid over.
    #[error("{found} samples, expected {expected} or more that lie apart in speed and force")]
    TooFew {
        /// How many there are.
        found: usize,
        /// How many are needed.
        expected: usize,
    },
    /// A grid that is none.
    #[error("a grid of {speeds} speeds and {forces} forces, expected 2 of each or more")]
    Grid {
        /// Speeds asked for.
        speeds: usize,
        /// Forces asked for.
        forces: usize,
    },
}

/// What keeps a slope from growing where the samples do not tell it, as a share of their weight.
const RIDGE: f64 = 1e-3;

/// Makes a map of so many speeds and forces, even between the least and the greatest of the samples; a node needs
/// `least_samples` near it.
///
/// # Errors
/// [`CvtMapError`] where there is no grid to be laid.
pub fn cvt_map(
    samples: &[Sample],
    (speeds, forces): (usize, usize),
    least_samples: usize,
) -> Result<CvtMap, CvtMapError> {
    if speeds < 2 || forces < 2 {
        return Err(CvtMapError::Grid { speeds, forces });
    }
    let speeds_m_s = grid(samples.iter().map(|sample| sample.speed_m_s), speeds);
    let forces_n = grid(samples.iter().map(|sample| sample.force_n), forces);
    let (Some(speeds_m_s), Some(forces_n)) = (speeds_m_s, forces_n) else {
        return Err(CvtMapError::TooFew { found: samples.len(), expected: least_samples.max(2) });
    };
    let (wide, high) = (speeds_m_s[1] - speeds_m_s[0], forces_n[1] - forces_n[0]);
    let node = |speed: f64, force: f64| {
        let mut fit = Local::default();
        for sample in samples {
            fit.add((sample.speed_m_s - speed) / wide, (sample.force_n - force) / high, sample.engine_rad_s);
        }
        (fit.near, (fit.near >= least_samples.max(1)).then(|| fit.at_node()))
    };
    let (mut engine_rad_s, mut counts) = (Vec::new(), Vec::new());
    for speed in &speeds_m_s {
        let (row_counts, row): (Vec<usize>, Vec<Option<f64>>) =
            forces_n.iter().map(|force| node(*speed, *force)).unzip();
        engine_rad_s.push(row);
        counts.push(row_counts);
    }
    Ok(CvtMap { speeds_m_s, forces_n, engine_rad_s, samples: counts })
}

/// Even nodes from the least to the greatest; `None` where they are the same.
fn grid(values: impl Iterator<Item = f64>, count: usize) -> Option<Vec<f64>> {
    let (low, high) = values
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    (low < high).then(|| (0..count).map(|i| low + (high - low) * i as f64 / (count - 1) as f64).collect())
}

/// Sums of a local line.
struct Local {
    near: usize,
    seen: (f64, f64),
    w: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
    o: f64,
    xo: f64,
    yo: f64,
}

impl Default for Local {
    fn default() -> Self {
        let [w, x, y, xx, xy, yy, o, xo, yo] = [0.0; 9];
        Self { near: 0, seen: (f64::INFINITY, f64::NEG_INFINITY), w, x, y, xx, xy, yy, o, xo, yo }
    }
}

impl Local {
    fn add(&mut self, x: f64, y: f64, omega: f64) {
        let w = (1.0 - x.abs()).max(0.0) * (1.0 - y.abs()).max(0.0);
        if w == 0.0 {
            return;
        }
        if x.abs() <= 0.5 && y.abs() <= 0.5 {
            self.near += 1;
        }
        self.seen = (self.seen.0.min(omega), self.seen.1.max(omega));
        self.w += w;
        self.x += w * x;
        self.y += w * y;
        self.xx += w * x * x;
        self.xy += w * x * y;
        self.yy += w * y * y;
        self.o += w * omega;
        self.xo += w * x * omega;
        self.yo += w * y * omega;
    }

    /// The line at the node itself.
    fn at_node(&self) -> f64 {
        let (w, mx, my, mo) = (self.w, self.x / self.w, self.y / self.w, self.o / self.w);
        let ridge = RIDGE * w;
        let (sxx, syy) = (self.xx - w * mx * mx + ridge, self.yy - w * my * my + ridge);
        let sxy = self.xy - w * mx * my;
        let (sxo, syo) = (self.xo - w * mx * mo, self.yo - w * my * mo);
        let determinant = sxx * syy - sxy * sxy;
        let (a, b) = ((sxo * syy - syo * sxy) / determinant, (syo * sxx - sxo * sxy) / determinant);
        (mo - a * mx - b * my).clamp(self.seen.0, self.seen.1)
    }
}

impl CvtMap {
    /// Engine speed at a speed and a force, evenly between four nodes; `None` where one of them that counts was not seen.
    pub fn at(&self, speed_m_s: f64, force_n: f64) -> Option<f64> {
        let (row, along) = between(&self.speeds_m_s, speed_m_s)?;
        let (column, across) = between(&self.forces_n, force_n)?;
        let mut sum = 0.0;
        for (row, weight) in [(row, 1.0 - along), (row + 1, along)] {
            for (column, share) in [(column, 1.0 - across), (column + 1, across)] {
                if weight * share > 0.0 {
                    sum += weight * share * self.engine_rad_s[row][column]?;
                }
            }
        }
        Some(sum)
    }

    /// Share of the nodes that were seen.
    pub fn covered_share(&self) -> f64 {
        let all = self.engine_rad_s.iter().flatten();
        let seen = all.clone().filter(|node| node.is_some()).count();
        seen as f64 / all.count() as f64
    }

    /// How far it is from samples.
    pub fn misfit(&self, samples: &[Sample]) -> Misfit {
        let errors: Vec<f64> = samples
            .iter()
            .filter_map(|sample| Some(self.at(sample.speed_m_s, sample.force_n)? - sample.engine_rad_s))
            .collect();
        let known = errors.len();
        let mean = errors.iter().map(|error| error * error).sum::<f64>() / known as f64;
        Misfit { samples: samples.len(), known, rmse_rad_s: mean.sqrt() }
    }
}

/// The node at or before a value, and the share of the way to the next; `None` beyond the ends.
fn between(nodes: &[f64], value: f64) -> Option<(usize, f64)> {
    let last = nodes.len().checked_sub(2)?;
    if !(value >= nodes[0] && value <= nodes[last + 1]) {
        return None;
    }
    let index = (nodes.partition_point(|node| *node <= value).max(1) - 1).min(last);
    Some((index, (value - nodes[index]) / (nodes[index + 1] - nodes[index])))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples on a fine lattice over 1 to 5 m/s and −10 to 30 kN, wherever `seen` says.
    fn drive(engine: impl Fn(f64, f64) -> f64, seen: impl Fn(f64, f64) -> bool) -> Vec<Sample> {
        let mut samples = Vec::new();
        for i in 0..=80 {
            for j in 0..=80 {
                let (speed_m_s, force_n) = (1.0 + f64::from(i) / 20.0, -10e3 + 500.0 * f64::from(j));
                if seen(speed_m_s, force_n) {
                    samples.push(Sample { speed_m_s, force_n, engine_rad_s: engine(speed_m_s, force_n) });
                }
            }
        }
        samples
    }

    fn plane(v: f64, f: f64) -> f64 {
        90.0 + 12.0 * v + 0.8e-3 * f
    }

    #[test]
    fn a_plane_is_found_up_to_the_edges() {
        let samples = drive(plane, |_, _| true);
        let map = cvt_map(&samples, (5, 5), 5).unwrap();
        assert_eq!(map.covered_share(), 1.0);
        for (v, f) in [(1.0, -10e3), (5.0, 30e3), (2.3, 11e3), (4.9, -9.7e3)] {
            // The ridge gives way by its own size.
            assert!((map.at(v, f).unwrap() - plane(v, f)).abs() < 0.2, "{v} {f}");
        }
        let misfit = map.misfit(&samples);
        assert_eq!((misfit.samples, misfit.known), (samples.len(), samples.len()));
        assert!(misfit.rmse_rad_s < 0.1, "{}", misfit.rmse_rad_s);
    }

    /// Full force at full speed was never driven: F v below 60 kW.
    #[test]
    fn what_was_not_driven_stays_unknown() {
        let map = cvt_map(&drive(plane, |v, f| v * f < 60e3), (9, 9), 5).unwrap();
        assert!(map.covered_share() > 0.6 && map.covered_share() < 0.95, "{}", map.covered_share());
        assert!(map.at(4.9, 25e3).is_none(), "122 kW were never driven");
        assert!(map.at(2.0, 25e3).is_some());
        assert!(map.at(5.1, 0.0).is_none() && map.at(2.0, -11e3).is_none(), "beyond the ends");
    }

    #[test]
    fn samples_in_one_line_give_nodes_along_it_and_no_slope_across() {
        let line = drive(plane, |_, f| f == 10e3);
        let mut samples = line.clone();
        // One far away spans the grid and is too lonely to be a node.
        samples.push(Sample { speed_m_s: 3.0, force_n: 50e3, engine_rad_s: 200.0 });
        let map = cvt_map(&samples, (5, 5), 5).unwrap();
        assert_eq!(map.covered_share(), 5.0 / 25.0);
        assert!((map.at(3.0, 10e3).unwrap() - plane(3.0, 10e3)).abs() < 0.2);
    }

    /// An engine that idles at 84 rad/s up to 2 m/s and then turns faster: a line through the bend would go below.
    #[test]
    fn no_node_turns_slower_than_the_engine_was_ever_seen() {
        let bend = |v: f64, _: f64| 84.0 + 30.0 * (v - 2.0).max(0.0);
        let map = cvt_map(&drive(bend, |_, _| true), (4, 4), 5).unwrap();
        assert!(map.engine_rad_s.iter().flatten().flatten().all(|omega| *omega >= 84.0), "{map:?}");
    }

    #[test]
    fn too_little_to_lay_a_grid_is_refused() {
        let one = [Sample { speed_m_s: 3.0, force_n: 1e3, engine_rad_s: 100.0 }; 40];
        assert!(matches!(cvt_map(&one, (4, 4), 5), Err(CvtMapError::TooFew { found: 40, .. })));
        assert!(matches!(cvt_map(&[], (4, 4), 5), Err(CvtMapError::TooFew { found: 0, .. })));
        assert_eq!(cvt_map(&one, (1, 4), 5).unwrap_err(), CvtMapError::Grid { speeds: 1, forces: 4 });
    }
}
