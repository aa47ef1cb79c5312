//! What data cannot tell apart, read off their own design matrix.
//!
//! Candidates are taken in order. One is separable if, after everything accepted before it has been allowed to move,
//! its effect at a stated practical size still stands out of the uncertainty. Otherwise the part of it that the others
//! imitate is a direction in which the data are blind, and the imitation is returned with its numbers.
//!
//! With the information matrix B scaled to practical sizes, candidate k and the accepted set A:
//! β = B_AA⁻¹ B_Ak and what is left is B_kk − B_kA β. It is the Gram–Schmidt process in the metric of the data.

use nalgebra::{DMatrix, DVector};

/// A candidate that the data cannot separate.
#[derive(Clone, Debug, PartialEq)]
pub struct Blind {
    /// Which candidate.
    pub candidate: usize,
    /// Whether no data of this kind could, rather than these being too short or too noisy.
    pub exact: bool,
    /// What imitates it: candidate and by how much it moves for one unit of this one. Empty where nothing does:
    /// the data do not react to the candidate at all.
    pub imitated_by: Vec<(usize, f64)>,
    /// Standard deviation with which it would be known beside the others; infinite where exact.
    pub deviation: f64,
}

impl Blind {
    /// What it means for the candidate, in a sentence.
    pub fn told(&self, names: &[&str]) -> String {
        let name = names[self.candidate];
        let others: Vec<&str> = self.imitated_by.iter().map(|(index, _)| names[*index]).collect();
        match (others.is_empty(), self.exact) {
            (true, true) => format!("The recording does not react to `{name}` at all; its prior stands."),
            (true, false) => {
                format!("The recording is too short or too noisy to tell `{name}` better than its prior.")
            }
            (false, _) => format!(
                "`{name}` cannot be told apart from `{}`: only a combination of them is known.",
                others.join("`, `")
            ),
        }
    }
}

/// Below this share of its own effect, what is left of a candidate is rounding.
const ROUNDING: f64 = 1e-7;
/// A candidate with less than this share of the strongest effect has none.
const NO_EFFECT: f64 = 1e-15;
/// An imitator that contributes less than this share of the effect is left out of the answer.
const NEGLIGIBLE: f64 = 0.02;

/// Goes through the candidates. `information` is JᵀV⁻¹J over all of them, each in its own unit; `sizes` are the
/// smallest changes that would matter, in the same units.
pub fn blind_directions(information: &DMatrix<f64>, sizes: &[f64]) -> Vec<Blind> {
    let scale = DMatrix::from_diagonal(&DVector::from_row_slice(sizes));
    let scaled = &scale * information * &scale;
    let strongest = scaled.diagonal().amax();
    let mut accepted: Vec<usize> = Vec::new();
    // What has an effect of its own, however weak: nothing may be exactly like it.
    let mut distinct: Vec<usize> = Vec::new();
    let mut blind = Vec::new();
    for candidate in 0..sizes.len() {
        let own = scaled[(candidate, candidate)];
        if own.is_nan() || own <= NO_EFFECT * strongest {
            blind.push(Blind { candidate, exact: true, imitated_by: Vec::new(), deviation: f64::INFINITY });
            continue;
        }
        let exact = own - explained(&scaled, &distinct, candidate).1 < ROUNDING * own;
        let others = if exact { &distinct } else { &accepted };
        let (imitation, explained) = explained(&scaled, others, candidate);
        let left = own - explained;
        let imitated_by = others
            .iter()
            .zip(imitation.iter())
            .filter(|(other, beta)| {
                **beta * **beta * scaled[(**other, **other)] > NEGLIGIBLE * NEGLIGIBLE * own
            })
            .map(|(other, beta)| (*other, beta * sizes[*other] / sizes[candidate]))
            .collect();
        if !exact {
            distinct.push(candidate);
            if left >= 1.0 {
                accepted.push(candidate);
                continue;
            }
        }
        let deviation = if exact { f64::INFINITY } else { sizes[candidate] / left.sqrt() };
        let hidden = explained > 0.5 * own;
        blind.push(Blind {
            candidate,
            exact,
            imitated_by: if hidden { imitated_by } else { Vec::new() },
            deviation,
        });
    }
    blind
}

/// How others would have to move to do what one size of this candidate does, and how much of its effect that is.
fn explained(scaled: &DMatrix<f64>, others: &[usize], candidate: usize) -> (DVector<f64>, f64) {
    let imitation = imitation(scaled, others, candidate);
    let explained =
        others.iter().zip(imitation.iter()).map(|(other, beta)| beta * scaled[(*other, candidate)]).sum();
    (imitation, explained)
}

/// How the accepted candidates would have to move to do what one size of this one does.
fn imitation(scaled: &DMatrix<f64>, accepted: &[usize], candidate: usize) -> DVector<f64> {
    let norm = |index: usize| scaled[(index, index)].sqrt();
    let matrix = DMatrix::from_fn(accepted.len(), accepted.len(), |row, column| {
        scaled[(accepted[row], accepted[column])] / norm(accepted[row]) / norm(accepted[column])
    });
    let target =
        DVector::from_fn(accepted.len(), |row, _| scaled[(accepted[row], candidate)] / norm(accepted[row]));
    let solved = matrix.cholesky().map(|cholesky| cholesky.solve(&target));
    let mut solved = solved.unwrap_or_else(|| DVector::zeros(accepted.len()));
    for (row, index) in accepted.iter().enumerate() {
        solved[row] /= norm(*index);
    }
    solved
}

#[cfg(test)]
mod tests {
    use super::*;

    fn information(rows: &[[f64; 3]], weight: f64) -> DMatrix<f64> {
        let mut sum = DMatrix::zeros(3, 3);
        for row in rows {
            let row = DVector::from_row_slice(row);
            sum += weight * &row * row.transpose();
        }
        sum
    }

    /// The third column is the first plus twice the second, so one unit of it is one of the first and two of the second.
    #[test]
    fn an_exact_combination_is_found_with_its_numbers() {
        let rows = [[1.0, 0.0, 1.0], [1.0, 1.0, 3.0], [1.0, 3.0, 7.0]];
        let blind = blind_directions(&information(&rows, 100.0), &[1.0, 1.0, 1.0]);
        assert_eq!(blind.len(), 1);
        assert!(blind[0].candidate == 2 && blind[0].exact);
        let [(0, first), (1, second)] = blind[0].imitated_by[..] else { panic!("{blind:?}") };
        assert!((first - 1.0).abs() < 1e-9 && (second - 2.0).abs() < 1e-9);
    }

    #[test]
    fn a_weak_difference_is_separable_with_good_data_and_not_with_poor() {
        let rows = [[1.0, 0.0, 1.0], [1.0, 1.0, 2.1], [1.0, 3.0, 4.0]];
        assert!(blind_directions(&information(&rows, 1e4), &[1.0; 3]).is_empty());
        let blind = blind_directions(&information(&rows, 10.0), &[1.0; 3]);
        assert!(blind.len() == 1 && !blind[0].exact && blind[0].deviation > 1.0, "{blind:?}");
    }

    #[test]
    fn a_candidate_without_effect_is_imitated_by_nothing() {
        let rows = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let blind = blind_directions(&information(&rows, 100.0), &[1.0; 3]);
        assert_eq!(blind.len(), 1);
        assert!(blind[0].exact && blind[0].imitated_by.is_empty() && blind[0].candidate == 2);
    }

    #[test]
    fn units_do_not_change_the_verdict() {
        let rows = [[1.0, 0.0, 1e3], [1.0, 1.0, 2.1e3], [1.0, 3.0, 4e3]];
        assert!(blind_directions(&information(&rows, 1e4), &[1.0, 1.0, 1e-3]).is_empty());
    }
}
