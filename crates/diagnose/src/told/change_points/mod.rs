//! Stretches in which a residual has a mean of its own, under the noise of its balance.
//!
//! Rows are sorted into cells: of time, position, speed. X says which row lies in which cell; A = XᵀΣ⁻¹X and g = XᵀΣ⁻¹r,
//! whitened row by row, hold all that the rows say of the means of cells. A stretch brings
//! twice its growth of ln p, (xᵀg)² / (xᵀAx) when alone, and has to bring more than a penalty. Stretches are added one by
//! one, judged together with all others, then joined with their neighbours or left out while that is worth more.
//!
//! Pruned dynamic programming (PELT) would need costs that add up. Under noise that is a difference, or that remembers,
//! they do not: what a stretch brings depends on what is said of its neighbours.
//!
//! Sources: Killick, Fearnhead and Eckley, *JASA* 107 (2012); Jeng, Cai and Li, *JASA* 105 (2010): stretches of unusual
//! mean, their penalty; Romano et al., *JASA* 117 (2022): why remembering noise has to be modelled.

use crate::balances::noise::{Noise, Passing};
use nalgebra::{DMatrix, DVector};

/// A row of a residual.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Its value.
    pub value: f64,
    /// The cell in which it lies, along whatever is looked over.
    pub cell: usize,
    /// Whether it follows the row before it without a gap.
    pub linked: bool,
}

/// A stretch of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// First cell.
    pub from: usize,
    /// The cell behind the last.
    pub to: usize,
    /// Mean of the residual.
    pub mean: f64,
    /// Its standard deviation.
    pub sd: f64,
    /// (mean / sd)².
    pub gain: f64,
}

/// The penalty at which `rows` of mere noise show a stretch about once in a hundred times.
///
/// There are fewer than `rows`² stretches, most of them nearly alike; χ² of one degree exceeds β by chance about
/// e^(−β/2) √(2/πβ) times. A test counts how often noise shows something.
pub fn penalty(rows: usize) -> f64 {
    const ALIKE: f64 = 1500.0;
    2.0 * (ALIKE * rows.max(1) as f64).ln()
}

/// The stretches of `cells` into which the rows, in the order of time, were sorted.
pub fn stretches(noise: &Noise, samples: &[Sample], cells: usize, penalty: f64) -> Vec<Stretch> {
    let Some(told) = Told::new(noise, samples, cells) else { return Vec::new() };
    let edges = told.forward(penalty);
    told.backward(&edges, penalty)
}

/// At most so many stretches are added: more of them are no map.
const MOST: usize = 12;

/// What the rows say of the means of cells, summed from the first cell on.
struct Told {
    cells: usize,
    /// Sums of A over all cells before a row and before a column.
    matrix: DMatrix<f64>,
    /// Sums of g over all cells before.
    vector: DVector<f64>,
}

impl Told {
    /// Nothing where the noise is no covariance.
    fn new(noise: &Noise, samples: &[Sample], cells: usize) -> Option<Self> {
        let whitener = noise.whitener(samples.len())?;
        let mut matrix: DMatrix<f64> = DMatrix::zeros(cells, cells);
        let mut vector: DVector<f64> = DVector::zeros(cells);
        let mut pieces = vec![Passing::default(); cells];
        // Zeros stay zeros until a cell is touched.
        let mut touched = vec![false; cells];
        let mut rest = Passing::default();
        let mut white: Vec<(usize, f64)> = Vec::with_capacity(cells);
        for sample in samples {
            if !sample.linked {
                touched.fill(false);
                rest = Passing::default();
            }
            white.clear();
            if !touched[sample.cell] {
                touched[sample.cell] = true;
                pieces[sample.cell] = Passing::behind(rest);
            }
            for (cell, piece) in pieces.iter_mut().enumerate().filter(|(cell, _)| touched[*cell]) {
                white.push((cell, whitener.step(piece, f64::from(cell == sample.cell))));
            }
            let residual = whitener.step(&mut rest, sample.value);
            for (index, (row, one)) in white.iter().enumerate() {
                vector[*row] += one * residual;
                for (column, other) in &white[..=index] {
                    matrix[(*row, *column)] += one * other;
                }
            }
        }
        matrix.fill_upper_triangle_with_lower_triangle();
        let mut sums: DMatrix<f64> = DMatrix::zeros(cells + 1, cells + 1);
        let mut sum: DVector<f64> = DVector::zeros(cells + 1);
        for row in 0..cells {
            sum[row + 1] = sum[row] + vector[row];
            for column in 0..cells {
                sums[(row + 1, column + 1)] =
                    matrix[(row, column)] + sums[(row, column + 1)] + sums[(row + 1, column)]
                        - sums[(row, column)];
            }
        }
        Some(Self { cells, matrix: sums, vector: sum })
    }

    /// xᵀg of a stretch.
    fn product(&self, (from, to): (usize, usize)) -> f64 {
        self.vector[to] - self.vector[from]
    }

    /// xᵀAy of two stretches.
    fn both(&self, one: (usize, usize), other: (usize, usize)) -> f64 {
        let at = |row: usize, column: usize| self.matrix[(row, column)];
        at(one.1, other.1) - at(one.0, other.1) - at(one.1, other.0) + at(one.0, other.0)
    }

    /// Stretches judged together: means, covariance, and what they bring less a penalty for each.
    fn joint(&self, chosen: &[(usize, usize)], penalty: f64) -> Option<(DVector<f64>, DMatrix<f64>, f64)> {
        let count = chosen.len();
        let matrix = DMatrix::from_fn(count, count, |row, column| self.both(chosen[row], chosen[column]));
        let vector = DVector::from_iterator(count, chosen.iter().map(|one| self.product(*one)));
        let cholesky = matrix.cholesky()?;
        let means = cholesky.solve(&vector);
        let worth = means.dot(&vector) - penalty * count as f64;
        Some((means, cholesky.inverse(), worth))
    }

    /// Adds the stretch that brings most beside those before it while one brings more than the penalty. They may overlap;
    /// what counts are their ends.
    fn forward(&self, penalty: f64) -> Vec<usize> {
        let mut chosen: Vec<(usize, usize)> = Vec::new();
        while chosen.len() < MOST {
            let Some((means, covariance, _)) = self.joint(&chosen, penalty) else { break };
            let mut best: Option<((usize, usize), f64)> = None;
            for from in 0..self.cells {
                for to in from + 1..=self.cells {
                    let new = (from, to);
                    let alone = self.both(new, new);
                    let cross =
                        DVector::from_iterator(chosen.len(), chosen.iter().map(|one| self.both(*one, new)));
                    let square = alone - cross.dot(&(&covariance * &cross));
                    let product = self.product(new) - cross.dot(&means);
                    // A stretch that those before it make up already.
                    if square <= 1e-9 * alone {
                        continue;
                    }
                    let gain = product * product / square;
                    if gain > best.map_or(penalty, |(_, known)| known) {
                        best = Some((new, gain));
                    }
                }
            }
            let Some((new, _)) = best else { break };
            chosen.push(new);
        }
        let mut edges: Vec<usize> = chosen.iter().flat_map(|(from, to)| [*from, *to]).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Stretches between all edges, joined with their neighbours or left out one by one while that is worth more.
    fn backward(&self, edges: &[usize], penalty: f64) -> Vec<Stretch> {
        let mut chosen: Vec<(usize, usize)> = edges.windows(2).map(|pair| (pair[0], pair[1])).collect();
        chosen.retain(|one| self.both(*one, *one) > 0.0);
        loop {
            let Some((means, covariance, now)) = self.joint(&chosen, penalty) else { return Vec::new() };
            let mut best: Option<(f64, Vec<(usize, usize)>)> = None;
            for place in 0..chosen.len() {
                let mut without = chosen.clone();
                let (_, to) = without.remove(place);
                let mut joined = without.clone();
                let tried = if place > 0 {
                    joined[place - 1].1 = to;
                    vec![joined, without]
                } else {
                    vec![without]
                };
                for fewer in tried {
                    let worth = self.joint(&fewer, penalty).map_or(f64::NEG_INFINITY, |(.., worth)| worth);
                    if worth >= best.as_ref().map_or(now, |(known, _)| *known) {
                        best = Some((worth, fewer));
                    }
                }
            }
            let Some((_, fewer)) = best else {
                let stretch = |(place, (from, to)): (usize, &(usize, usize))| {
                    let (mean, sd) = (means[place], covariance[(place, place)].sqrt());
                    Stretch { from: *from, to: *to, mean, sd, gain: (mean / sd).powi(2) }
                };
                return chosen.iter().enumerate().map(stretch).collect();
            };
            chosen = fewer;
        }
    }
}

#[cfg(test)]
mod tests;
