//! A term of a law: an amplitude in the unit of the target times shapes that are pure numbers.

use crate::dictionary::POWERS;
use crate::shape::{Columns, Factor, Free, Shape};
use crate::variable::{Checked, Enters, Kind};
use crate::vector::times;

/// One or two factors; the amplitude is linear and not held here.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Term {
    pub factors: Vec<Factor>,
}

impl Term {
    /// A term of one factor.
    pub fn of(factor: Factor) -> Self {
        Self { factors: vec![factor] }
    }

    /// A term of two; none where both have a phase, or where a gate meets itself.
    pub fn product(one: Factor, other: Factor) -> Option<Self> {
        let phases = one.shape.has_phase() && other.shape.has_phase();
        (!phases).then(|| Self { factors: vec![one, other] })
    }

    /// The pulse or the switch that is on where this one is off; none of what is neither by itself.
    pub fn complement(&self) -> Option<Self> {
        let [factor] = self.factors[..] else { return None };
        let (shape, centre) = match factor.shape {
            Shape::Pulse(level) => (Shape::Pulse(-level), factor.centre + 0.5 * factor.scale),
            Shape::Latch => (Shape::Unlatch, factor.centre),
            Shape::Unlatch => (Shape::Latch, factor.centre),
            _ => return None,
        };
        Some(Self::of(Factor { shape, centre, ..factor }))
    }

    /// The same with one of its steps the other way, for each of them, or with what wears off as what grows.
    pub fn turned(&self) -> Vec<Self> {
        let turned = |shape: Shape| match shape {
            Shape::Step => Some(Shape::StepDown),
            Shape::StepDown => Some(Shape::Step),
            Shape::Latch => Some(Shape::Unlatch),
            Shape::Unlatch => Some(Shape::Latch),
            Shape::Decay => Some(Shape::Rise),
            Shape::Rise => Some(Shape::Decay),
            _ => None,
        };
        let of = |place: usize| {
            let mut other = self.clone();
            other.factors[place].shape = turned(other.factors[place].shape)?;
            Some(other)
        };
        (0..self.factors.len()).filter_map(of).collect()
    }

    /// The same with another power of a size in the place of each.
    pub fn other_powers(&self, variables: &[Checked]) -> Vec<Self> {
        let of = |place: usize| {
            let factor = self.factors[place];
            let of_size = variables[factor.variable].known.kind == Kind::Size;
            let own = match factor.shape {
                Shape::Power(power) if of_size => Some(power),
                _ => None,
            };
            let others = POWERS.into_iter().filter(move |power| own.is_some_and(|own| own != *power));
            others.map(move |power| {
                let mut other = self.clone();
                other.factors[place].shape = Shape::Power(power);
                other
            })
        };
        (0..self.factors.len()).flat_map(of).collect()
    }

    /// Whether a variable is in it that enters by what bends alone.
    pub fn bends(&self, variables: &[Checked]) -> bool {
        self.factors.iter().any(|factor| variables[factor.variable].enters == Enters::Bent)
    }

    /// How many linear columns it is.
    pub fn width(&self) -> usize {
        if self.factors.iter().any(|factor| factor.shape.has_phase()) { 2 } else { 1 }
    }

    /// Its columns in one run, at every sample that the rows look at.
    pub fn samples(&self, variables: &[Checked], run: usize) -> Vec<Vec<f64>> {
        self.along(variables, |of| (&of.seen[run], &of.seen_s[run]))
    }

    /// The same by the twins of its variables, where these have any.
    pub fn samples_by_twins(&self, variables: &[Checked], run: usize) -> Vec<Vec<f64>> {
        self.along(variables, |of| (&of.twin.as_ref().unwrap_or(&of.seen)[run], &of.seen_s[run]))
    }

    /// Whether another sensor tells of any of its variables.
    pub fn has_twin(&self, variables: &[Checked]) -> bool {
        self.factors.iter().any(|factor| variables[factor.variable].twin.is_some())
    }

    /// Its columns in one run, at every sample.
    pub fn all_samples(&self, variables: &[Checked], run: usize) -> Vec<Vec<f64>> {
        self.along(variables, |of| (&of.runs[run], &of.times_s[run]))
    }

    fn along<'a, 'b: 'a>(
        &self,
        variables: &'a [Checked<'b>],
        values: impl Fn(&'a Checked<'b>) -> (&'a [f64], &'a [f64]),
    ) -> Vec<Vec<f64>> {
        let length = self.factors.first().map_or(0, |first| values(&variables[first.variable]).0.len());
        let mut envelope = vec![1.0; length];
        let mut phased: Option<(Vec<f64>, Vec<f64>)> = None;
        for factor in &self.factors {
            let of = &variables[factor.variable];
            let (values, times_s) = values(of);
            let Columns { first, cosine } = factor.along(values, times_s, of);
            match cosine {
                Some(cosine) => phased = Some((first, cosine)),
                None => times(&mut envelope, &first),
            }
        }
        match phased {
            None => vec![envelope],
            Some((mut sine, mut cosine)) => {
                times(&mut sine, &envelope);
                times(&mut cosine, &envelope);
                vec![sine, cosine]
            }
        }
    }

    /// Its free constants: which factor, and which constant of it.
    pub fn free(&self) -> Vec<(usize, Free)> {
        let of = |(index, factor): (usize, &Factor)| {
            factor.shape.free().iter().map(move |free| (index, *free)).collect::<Vec<_>>()
        };
        self.factors.iter().enumerate().flat_map(of).collect()
    }

    /// What it costs to write it down.
    pub fn complexity(&self) -> usize {
        1 + self.factors.iter().map(Factor::complexity).sum::<usize>()
    }

    /// What it is, without its constants.
    pub fn family(&self) -> Vec<(usize, String)> {
        let mut family: Vec<_> = self.factors.iter().map(Factor::family).collect();
        family.sort();
        family
    }

    /// The wave that it is by itself.
    pub fn as_wave(&self) -> Option<Factor> {
        match self.factors[..] {
            [factor] if factor.shape == Shape::Wave => Some(factor),
            _ => None,
        }
    }

    /// Whether it is a plain or modulated wave.
    pub fn is_wave(&self) -> bool {
        self.factors.iter().any(|factor| factor.shape == Shape::Wave)
    }
}
