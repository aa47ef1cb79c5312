//! Configurations by two measures at once, and those that no other beats in both.

use super::{Content, IN_DETAIL, asked, varies};
use headland_batch::{Choice, Statistics};
use headland_report::{Cloud, Plot, Scatter, Section};

/// Configurations by which axes are chosen.
const SAMPLE: usize = 200;

impl Content<'_> {
    /// Configurations to choose from: a parameter that is varied alone asks a question and offers no choice.
    fn choices(&self) -> Vec<&Choice> {
        let points = &self.plan.comparison.points;
        let chosen = |choice: &&Choice| {
            points.end_of(choice.spec.point).is_none()
                && choice.measures.iter().any(|value| value.is_finite())
        };
        self.summary.choices.iter().filter(chosen).collect()
    }

    /// A plot for each cycle and ground; none where there is nothing to choose from.
    pub(super) fn pareto(&self) -> Option<Section> {
        let better = |index: &usize| self.summary.measures[*index].more_is_better();
        let mut wanted = asked(self.plan, self.summary);
        wanted.extend(
            self.summary.present().into_iter().filter(|index| !wanted.contains(index)).collect::<Vec<_>>(),
        );
        let choices: Vec<&Choice> = self.choices();
        // Each against the mean of its place: a long cycle is no choice against a short one.
        let column = |index: usize| -> Vec<f64> {
            let scaled = |choice: &&Choice| {
                let place = |choice: &Choice| (choice.spec.cycle, choice.spec.ground);
                let mut here = Statistics::default();
                for other in choices.iter().filter(|other| place(other) == place(choice)) {
                    here.add(other.measures[index]);
                }
                choice.measures[index] / here.mean
            };
            // A sample says as much of a correlation as all of them.
            choices.iter().step_by(choices.len().div_ceil(SAMPLE).max(1)).map(scaled).collect()
        };
        wanted.retain(|index| better(index).is_some() && varies(&column(*index)));
        let x = *wanted.first()?;
        // Carbon dioxide against fuel is a straight line and no choice.
        let mut others = wanted.iter().skip(1);
        let Some(&y) = others.find(|index| correlation(&column(x), &column(**index)).abs() < 0.999) else {
            return Some(Section::new("Choices").words(format!(
                "{} alone is left to choose by: nothing else that is measured differs by a thousandth without following \
                 from it.",
                super::capital(&self.axis(x).label)
            )));
        };
        let sign = |index: usize| if better(&index) == Some(true) { -1.0 } else { 1.0 };
        let mut section = Section::new("Choices").words(
            "Each point is a configuration, the mean of its repetitions. No other configuration is better in both by the \
             points on the line.",
        );
        if self.summary.one_choice_of > 1 {
            section = section.with(headland_report::Item::Words(format!(
                "One of {} configurations is shown; the table of results has all.",
                self.summary.one_choice_of
            )));
        }
        let mut told = 0;
        for (cycle, ground) in self.places().into_iter().take(IN_DETAIL) {
            let here: Vec<&Choice> = choices
                .iter()
                .copied()
                .filter(|choice| (choice.spec.cycle, choice.spec.ground) == (cycle, ground))
                .filter(|choice| choice.measures[x].is_finite() && choice.measures[y].is_finite())
                .collect();
            if here.len() < 3 {
                continue;
            }
            let column = |index: usize| here.iter().map(|choice| choice.measures[index]).collect::<Vec<_>>();
            if let Some(same) = [x, y].into_iter().find(|index| !varies(&column(*index))) {
                let other = if same == x { y } else { x };
                let (same, other) = (self.axis(same).label, self.axis(other).label);
                section = section.with(headland_report::Item::Words(format!(
                    "{}: {same} differs by less than a thousandth, so {other} alone is left to choose by.",
                    super::capital(&self.place(cycle, ground))
                )));
                told += 1;
                continue;
            }
            let cloud = |name: String, of: Vec<(f64, f64)>, joined: bool| {
                let (x, y) = of.into_iter().unzip();
                Cloud { name, x, y, colour: None, joined }
            };
            let at = |choice: &&Choice| (choice.measures[x], choice.measures[y]);
            let mut clouds: Vec<Cloud> = Vec::new();
            for variant in 0..self.plan.comparison.variants.len() {
                let points: Vec<_> =
                    here.iter().filter(|choice| choice.spec.variant == variant).map(at).collect();
                if !points.is_empty() {
                    clouds.push(cloud(self.variant(variant).to_owned(), points, false));
                }
            }
            let points: Vec<(f64, f64)> = here.iter().map(at).collect();
            clouds.push(cloud("not beaten".to_owned(), front(&points, (sign(x), sign(y))), true));
            let title = format!(
                "{} against {}: {}",
                self.axis(y).label,
                self.axis(x).label,
                self.place(cycle, ground)
            );
            let scatter = Scatter { x: self.axis(x), y: self.axis(y), clouds };
            section = section.with(Plot::new(super::capital(&title), scatter));
            told += 1;
        }
        (told > 0).then_some(section)
    }
}

/// Correlation of the pairs in which both are numbers; 1 where there is none.
fn correlation(one: &[f64], other: &[f64]) -> f64 {
    let pairs: Vec<(f64, f64)> = one
        .iter()
        .copied()
        .zip(other.iter().copied())
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .collect();
    let count = pairs.len() as f64;
    let mean = pairs.iter().fold((0.0, 0.0), |sum, (x, y)| (sum.0 + x / count, sum.1 + y / count));
    let sum = |of: fn(f64, f64) -> f64| pairs.iter().map(|(x, y)| of(x - mean.0, y - mean.1)).sum::<f64>();
    let product = sum(|x, y| x * y) / (sum(|x, _| x * x) * sum(|_, y| y * y)).sqrt();
    if product.is_finite() { product } else { 1.0 }
}

/// The points that no other is better than in both, from left to right. A sign of −1 wants more.
fn front(points: &[(f64, f64)], (sign_x, sign_y): (f64, f64)) -> Vec<(f64, f64)> {
    let mut sorted: Vec<(f64, f64)> = points.iter().map(|(x, y)| (sign_x * x, sign_y * y)).collect();
    sorted.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1)));
    let mut best = f64::INFINITY;
    let mut front = Vec::new();
    for (x, y) in sorted {
        if y < best {
            best = y;
            front.push((sign_x * x, sign_y * y));
        }
    }
    front
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let points = [(1.0, 5.0), (2.0, 3.0), (2.0, 4.0), (3.0, 3.0), (4.0, 1.0), (5.0, 2.0)];
        assert_eq!(front(&points, (1.0, 1.0)), [(1.0, 5.0), (2.0, 3.0), (4.0, 1.0)]);
        assert_eq!(front(&points, (1.0, -1.0)), [(1.0, 5.0)]);
        assert_eq!(front(&points, (-1.0, -1.0)), [(5.0, 2.0), (3.0, 3.0), (2.0, 4.0), (1.0, 5.0)]);
    }
}
