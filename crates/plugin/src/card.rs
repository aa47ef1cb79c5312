//! How a model describes itself.

/// What `headland plugins` prints of a model, and what a scenario's numbers are checked against.
#[derive(Clone, Copy, Debug)]
pub struct Card {
    /// As scenarios name it.
    pub name: &'static str,
    /// One line.
    pub about: &'static str,
    /// The equation, in the source's letters.
    pub equation: &'static str,
    /// Where the equation stands.
    pub source: &'static str,
    /// Where it holds, and what it leaves out.
    pub validity: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
}

/// One parameter of a model.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Name, ending in its unit.
    pub name: &'static str,
    /// Unit in words; `1` for a pure number.
    pub unit: &'static str,
    /// What it is.
    pub about: &'static str,
    /// What it has to be.
    pub bound: Bound,
    /// Where it usually lies; values outside are accepted and remarked upon.
    pub plausible: Option<(f64, f64)>,
    /// The value where it is left out; `None` where it has to be given.
    pub default: Option<f64>,
}

/// A parameter that has to be given and may be any finite number.
pub const fn parameter(name: &'static str, unit: &'static str, about: &'static str) -> Parameter {
    Parameter { name, unit, about, bound: Bound::Finite, plausible: None, default: None }
}

impl Parameter {
    /// It has to lie within `bound`.
    #[must_use]
    pub const fn must_be(mut self, bound: Bound) -> Self {
        self.bound = bound;
        self
    }

    /// It usually lies between `low` and `high`.
    #[must_use]
    pub const fn usually(mut self, low: f64, high: f64) -> Self {
        self.plausible = Some((low, high));
        self
    }

    /// It may be left out and is `value` then.
    #[must_use]
    pub const fn or(mut self, value: f64) -> Self {
        self.default = Some(value);
        self
    }
}

/// What a number has to be for the model to make sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Any finite number.
    Finite,
    /// More than 0.
    Positive,
    /// 0 or more.
    NotNegative,
    /// More than 0 and at most 1.
    Efficiency,
    /// Between these two, both included.
    Within(f64, f64),
}

impl Bound {
    /// Whether `value` is allowed.
    pub fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::Positive => value > 0.0,
                Self::NotNegative => value >= 0.0,
                Self::Efficiency => value > 0.0 && value <= 1.0,
                Self::Within(low, high) => (low..=high).contains(&value),
            }
    }

    /// The bound in words, to end the sentence 'expected ...'.
    pub fn in_words(self) -> String {
        match self {
            Self::Finite => "a finite number".to_owned(),
            Self::Positive => "more than 0".to_owned(),
            Self::NotNegative => "0 or more".to_owned(),
            Self::Efficiency => "more than 0 and at most 1".to_owned(),
            Self::Within(low, high) => format!("{low} to {high}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_hold_at_their_ends_as_their_words_say() {
        assert!(!Bound::Positive.holds(0.0) && Bound::NotNegative.holds(0.0));
        assert!(
            Bound::Efficiency.holds(1.0) && !Bound::Efficiency.holds(1.01) && !Bound::Efficiency.holds(0.0)
        );
        assert!(Bound::Within(-1.0, 2.0).holds(2.0) && !Bound::Within(-1.0, 2.0).holds(-1.1));
        assert!(!Bound::Finite.holds(f64::NAN) && !Bound::NotNegative.holds(f64::INFINITY));
    }
}
