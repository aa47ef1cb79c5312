//! Functions that stay and then jump: a consumer is switched, the ground changes at the edge of a field.
//!
//! The increments from knot to knot have Student's distribution instead of a normal one, each by a normal one of its own
//! width; the widths are found with the function, round after round. Where the edges have been told, the function stays but for them.
//! Of n increments k are edges: any k of them are as likely as any other, and any k as any other k, which costs ln (n + 1) + ln C(n, k).

use crate::outliers::student::Student;
use nalgebra::DVector;
use std::sync::Arc;

/// How free the increments of a function are, one by one.
#[derive(Clone, Debug, PartialEq)]
pub struct Jumps {
    /// Distance between knots [m or s].
    pub step: f64,
    freedom: Freedom,
}

/// What is known of the increments of each group.
#[derive(Clone, Debug, PartialEq)]
enum Freedom {
    /// ξ of each, in units of the usual variance.
    Squares(Arc<Vec<Vec<f64>>>),
    /// Which of them are edges.
    Edges(Arc<Vec<Edges>>),
}

/// Where the function of a group stays and where it jumps.
#[derive(Clone, Debug, PartialEq)]
pub struct Edges {
    /// The first knot [m or s].
    pub from: f64,
    /// Whether each increment may be of any size.
    pub free: Vec<bool>,
    /// How many edges there are: of one that lies within a row two increments tell.
    pub count: usize,
}

/// A function that stays forgets itself over so many times its steps: between edges it wanders by a thousandth of its size.
pub const STAYING: f64 = 1e6;

impl Jumps {
    /// Where nothing is known of any increment.
    pub fn unknown(step: f64) -> Self {
        Self::of(step, Vec::new())
    }

    /// With the squares of increments as a round found them, in units of the usual variance.
    pub fn of(step: f64, squares: Vec<Vec<f64>>) -> Self {
        Self { step, freedom: Freedom::Squares(Arc::new(squares)) }
    }

    /// With edges that were told, group by group.
    pub fn told(step: f64, edges: Vec<Edges>) -> Self {
        Self { step, freedom: Freedom::Edges(Arc::new(edges)) }
    }

    /// The knots of a group whose edges were told: where the first lies, and how many there are.
    pub fn knots(&self, group: usize) -> Option<(f64, usize)> {
        self.edges(group).map(|edges| (edges.from, edges.free.len() + 1))
    }

    /// Whether the edges were told.
    pub fn is_told(&self) -> bool {
        matches!(self.freedom, Freedom::Edges(_))
    }

    fn edges(&self, group: usize) -> Option<&Edges> {
        match &self.freedom {
            Freedom::Squares(_) => None,
            Freedom::Edges(edges) => edges.get(group),
        }
    }

    fn square(&self, group: usize, increment: usize) -> f64 {
        match &self.freedom {
            Freedom::Squares(squares) => {
                squares.get(group).and_then(|group| group.get(increment)).copied().unwrap_or(1.0)
            }
            Freedom::Edges(_) => 1.0,
        }
    }

    /// Factor w of the precision of an increment.
    pub fn weight(&self, group: usize, increment: usize) -> f64 {
        match self.edges(group) {
            // From one level to another, which know nothing of each other.
            Some(edges) if edges.free.get(increment) == Some(&true) => STAYING.recip(),
            Some(_) => 1.0,
            None => Student::JUMPING.weight(self.square(group, increment)),
        }
    }

    /// What the bound is above the normal distributions that stand for the increments of a group.
    pub fn bound(&self, group: usize, increments: usize) -> f64 {
        if let Some(edges) = self.edges(group) {
            return -choice(increments, edges.count);
        }
        (0..increments).map(|increment| Student::JUMPING.bound(self.square(group, increment))).sum()
    }
}

/// ln (n + 1) + ln C(n, k), for k of n.
fn choice(all: usize, chosen: usize) -> f64 {
    let chosen = chosen.min(all);
    let ways = (1..=chosen).map(|place| ((all - chosen + place) as f64 / place as f64).ln());
    ((all + 1) as f64).ln() + ways.sum::<f64>()
}

/// ⟨e²⟩ of the increments e = x − φ x₋ of a group, by its values and the diagonals of their covariance.
pub fn squares(
    own: &DVector<f64>,
    beside: &DVector<f64>,
    values: &DVector<f64>,
    forgetting: f64,
) -> Vec<f64> {
    (1..values.len())
        .map(|knot| {
            let mean = values[knot] - forgetting * values[knot - 1];
            let variance =
                own[knot] + forgetting * forgetting * own[knot - 1] - 2.0 * forgetting * beside[knot];
            mean * mean + variance.max(0.0)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::choice;

    #[test]
    fn the_choices_of_edges_are_as_likely_as_one_in_all() {
        let chances = (0..=6).map(|chosen| {
            let ways = [1.0, 6.0, 15.0, 20.0, 15.0, 6.0, 1.0][chosen];
            ways * (-choice(6, chosen)).exp()
        });
        assert!((chances.sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
