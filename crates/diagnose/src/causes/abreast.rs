//! Functions side by side: where two of them act on the same rows, as softer ground along a path and a tank that fills do, none
//! can be eliminated before the other. Their knots are taken together, in one matrix whose band is all of it.
//!
//! Source: Rasmussen and Williams, *Gaussian Processes for Machine Learning* (2006), section 2.7, for a sum of processes.

use crate::balances::gram::{Reduced, Whitened, right_side};
use crate::balances::rows::Chunk;
use crate::causes::band::{Band, Factor};
use crate::causes::profile::{Function, Group, Profile, Spread, Widths, log_precision, precision_entries};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Knots of all functions together are at most so many.
const MOST_KNOTS: usize = 1200;
/// So many functions act on the same rows at most: of more nothing could be told.
pub const MOST: usize = 2;

/// A function and how it is spread.
pub type Spreaded<'p, 'a> = (&'p Profile<'a>, &'p Spread);

/// Functions that act on the same rows.
pub struct Abreast<'p, 'a> {
    members: Vec<Spreaded<'p, 'a>>,
    groups: Vec<Placed>,
    knots: usize,
}

/// The knots of every group of a function, and the place of the first of them among all.
type Placed = Vec<(Group, usize)>;

/// What rows say of the knots of all members: products among themselves and with the other columns, the residual last.
pub struct Gathered {
    groups: Vec<Placed>,
    matrix: Band,
    cross: DMatrix<f64>,
}

/// The same with what was known before: the factor of its precision, and ln |P| of what was known.
pub struct Solved {
    members: Vec<(Spread, Placed)>,
    factor: Factor,
    cross: DMatrix<f64>,
    log_prior: f64,
}

impl<'p, 'a> Abreast<'p, 'a> {
    /// None where there are too many knots, or too many functions.
    pub fn of(members: &[Spreaded<'p, 'a>]) -> Option<Self> {
        let mut knots = 0;
        let mut of_member = |(profile, spread): &Spreaded| -> Placed {
            let placed = |group: Group| {
                let first = knots;
                knots += group.count;
                (group, first)
            };
            profile.groups(spread).into_iter().map(placed).collect()
        };
        let groups = members.iter().map(&mut of_member).collect();
        let able = members.len() <= MOST && knots <= MOST_KNOTS;
        able.then(|| Self { members: members.to_vec(), groups, knots })
    }

    /// The products over the runs that are `fit`.
    pub fn gathered(&self, whitened: &Whitened, chunks: &[Chunk], fit: &[bool]) -> Gathered {
        let mut matrix = Band::zeros(self.knots, self.knots);
        let mut cross = DMatrix::zeros(self.knots, whitened.width() + 1);
        // What each member does in a chunk, by its knots there.
        let of_chunk = |(index, chunk): (usize, &Chunk)| -> Vec<(usize, DMatrix<f64>)> {
            let of_member = |((profile, _), groups): (&Spreaded, &Placed)| {
                if !profile.touches(index) {
                    return None;
                }
                let (group, first) = &groups[profile.group_of[chunk.run]];
                let (low, mut basis) = profile.basis(index, chunk, group);
                whitened.whiteners.whiten(index, chunk, &mut basis);
                Some((first + low, basis))
            };
            if fit[chunk.run] {
                self.members.iter().zip(&self.groups).filter_map(of_member).collect()
            } else {
                Vec::new()
            }
        };
        let of_chunks: Vec<Vec<(usize, DMatrix<f64>)>> =
            chunks.par_iter().enumerate().map(of_chunk).collect();
        for (index, own) in of_chunks.iter().enumerate() {
            for (first, basis) in own {
                let transposed = basis.transpose();
                matrix.add_block(*first, &(&transposed * basis));
                for (other, beside) in own.iter().filter(|(other, _)| other < first) {
                    matrix.add_beside(*first, *other, &(&transposed * beside));
                }
                let mut view = cross.view_mut((*first, 0), (basis.ncols(), whitened.width() + 1));
                view.gemm(1.0, &transposed, &whitened.chunks[index], 1.0);
            }
        }
        Gathered { groups: self.groups.clone(), matrix, cross }
    }
}

impl Gathered {
    /// With the priors of spreads that have the same knots; none where the sum is not positive definite.
    pub fn solved(&self, spreads: &[&Spread]) -> Option<Solved> {
        let mut matrix = self.matrix.clone();
        let mut log_prior = 0.0;
        for (spread, groups) in spreads.iter().zip(&self.groups) {
            for (number, (group, first)) in groups.iter().enumerate() {
                for (row, column, value) in precision_entries(number, group, spread) {
                    matrix.add(first + row.max(column), first + row.min(column), value);
                }
                log_prior += log_precision(number, group, spread);
            }
        }
        let members = spreads.iter().map(|spread| (*spread).clone()).zip(self.groups.clone()).collect();
        Some(Solved { members, factor: matrix.cholesky()?, cross: self.cross.clone(), log_prior })
    }
}

impl Solved {
    /// Eliminates the functions from products that were made already.
    pub fn take(&self, reduced: &mut Reduced) {
        let mut half = self.cross.clone();
        self.factor.half_solve(&mut half);
        reduced.take(&(half.transpose() * &half), self.factor.log_determinant() - self.log_prior);
    }

    /// The functions themselves, once the other columns have the values `beta`.
    pub fn functions(&self, beta: &DVector<f64>, widths: Widths) -> Vec<Function> {
        let values = self.factor.solve(&right_side(&self.cross, beta));
        let sd = match widths {
            Widths::Wanted => self.factor.inverse_diagonals().0.map(f64::sqrt),
            Widths::Left => DVector::from_element(values.len(), f64::NAN),
        };
        let of_member = |(spread, groups): &(Spread, Placed)| {
            let own = |(group, first): &(Group, usize)| {
                (values.rows(*first, group.count).into_owned(), sd.rows(*first, group.count).into_owned())
            };
            Function {
                groups: groups.iter().map(|(group, _)| group.clone()).collect(),
                values: groups.iter().map(own).collect(),
                spread: spread.clone(),
                squares: vec![Vec::new(); groups.len()],
            }
        };
        self.members.iter().map(of_member).collect()
    }
}

/// Which functions share rows: their numbers, those that do so together. Functions that are none are left out.
pub fn clusters(profiles: &[Option<(Profile, Spread)>]) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = Vec::new();
    let profile = |number: usize| profiles[number].as_ref().map(|(profile, _)| profile);
    for number in (0..profiles.len()).filter(|number| profiles[*number].is_some()) {
        let shares = |other: &usize| {
            profile(number).zip(profile(*other)).is_some_and(|(own, other)| own.shares_rows(other))
        };
        match all.iter_mut().find(|cluster| cluster.iter().any(shares)) {
            Some(cluster) => cluster.push(number),
            None => all.push(vec![number]),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::balances::gram::Column;
    use crate::balances::noise::{Noise, Noises, Shape};
    use crate::balances::rows::Row;
    use crate::causes::profile::COARSE;

    const ROWS: usize = 14;

    fn column(of: fn(f64) -> f64) -> Column {
        vec![DVector::from_fn(ROWS, |row, _| of(row as f64))]
    }

    /// Signature times hat functions, over all knots.
    fn basis(profile: &Profile, chunk: &Chunk, group: &Group) -> DMatrix<f64> {
        let (low, part) = profile.basis(0, chunk, group);
        let mut basis = DMatrix::zeros(ROWS, group.count);
        basis.view_mut((0, low), part.shape()).copy_from(&part);
        basis
    }

    /// Two functions of different places beside noise: evidence and means are those of the sum of two processes, whose
    /// covariances are written down in full.
    #[test]
    fn two_functions_of_the_same_rows_are_a_sum_of_processes() {
        let row = |row: usize| Row { samples: [row, row, row + 1], weights: vec![1.0], time_s: row as f64 };
        let chunk = Chunk { balance: 0, run: 0, rows: (0..ROWS).map(row).collect(), loudness: Vec::new() };
        let noise = Noise { shape: Shape::Averaged, sensor: 0.3, process: 0.2, persistence: 0.5 };
        let residual = column(|row| (0.9 * row).sin() + 0.2 * row);
        let whitened =
            Whitened::new(std::slice::from_ref(&chunk), &residual, &[], &Noises::normal(vec![noise]))
                .unwrap();
        let signatures = [column(|row| 1.0 + 0.1 * row), column(|row| (0.7 * row).cos())];
        let places = [column(|row| row), column(|row| 40.0 - 1.5 * row)];
        let spreads = [(5.0, 0.8), (9.0, 1.7)].map(|(length, size)| Spread {
            length,
            size,
            knots_per_length: COARSE,
            jumps: None,
            shared: false,
        });
        let profiles: Vec<Profile> = signatures
            .iter()
            .zip(places)
            .map(|(signature, at)| Profile {
                signature,
                extents: vec![(at[0].min(), at[0].max())],
                rows: vec![ROWS],
                at,
                group_of: vec![0],
            })
            .collect();
        assert!(profiles[0].shares_rows(&profiles[1]));

        let mut covariance = noise.covariance(ROWS);
        let mut priors = Vec::new();
        for (profile, spread) in profiles.iter().zip(&spreads) {
            let group = &profile.groups(spread)[0];
            let apart = |one: usize, other: usize| group.step * one.abs_diff(other) as f64;
            let prior = DMatrix::from_fn(group.count, group.count, |one, other| {
                spread.size.powi(2) * (-apart(one, other) / spread.length).exp()
            });
            let basis = basis(profile, &chunk, group);
            covariance += &basis * &prior * basis.transpose();
            priors.push(prior * basis.transpose());
        }
        let inverse = covariance.clone().try_inverse().unwrap();
        let deviance = (residual[0].transpose() * &inverse * &residual[0])[(0, 0)]
            + covariance.determinant().ln()
            + ROWS as f64 * std::f64::consts::TAU.ln();

        let chunks = [chunk];
        let members: Vec<Spreaded> = profiles.iter().zip(&spreads).collect();
        let abreast = Abreast::of(&members).unwrap();
        let mut reduced = whitened.reduced(&chunks, &[true]);
        let known: Vec<&Spread> = spreads.iter().collect();
        let solved = abreast.gathered(&whitened, &chunks, &[true]).solved(&known).unwrap();
        solved.take(&mut reduced);
        let found = reduced.estimate(&[], &[]).unwrap().log_evidence;
        assert!((found + 0.5 * deviance).abs() < 1e-8, "{found} against {}", -0.5 * deviance);
        let nothing = DVector::zeros(0);
        let functions = solved.functions(&nothing, Widths::Wanted);
        for (function, prior) in functions.iter().zip(&priors) {
            let expected = prior * &inverse * &residual[0];
            assert!((&function.values[0].0 - expected).amax() < 1e-9);
            assert!(function.values[0].1.iter().all(|sd| *sd > 0.0 && *sd < 1.7));
        }
    }

    #[test]
    fn more_functions_than_could_be_told_apart_are_refused() {
        let signature = column(|_| 1.0);
        let spread = Spread { length: 5.0, size: 1.0, knots_per_length: COARSE, jumps: None, shared: false };
        let profile = Profile {
            signature: &signature,
            at: column(|row| row),
            group_of: vec![0],
            extents: vec![(0.0, 13.0)],
            rows: vec![ROWS],
        };
        assert!(Abreast::of(&[(&profile, &spread); MOST]).is_some());
        assert!(Abreast::of(&[(&profile, &spread); MOST + 1]).is_none());
    }
}
