//! A parameter of a cause: its unit, what is usual, what it can be.

/// A parameter of a cause.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    /// As the effect names it.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// One standard deviation of what is usual.
    pub scale: f64,
    /// Whether the cause is proportional to it.
    pub linear: bool,
    /// Least that it can be.
    pub low: f64,
    /// Most that it can be.
    pub high: f64,
}

/// An effect so many times its usual size is none of this kind.
const MOST_SIZES: f64 = 8.0;

pub fn linear(name: &'static str, unit: &'static str, scale: f64) -> Term {
    Term { name, unit, scale, linear: true, low: -MOST_SIZES * scale, high: MOST_SIZES * scale }
}

pub fn positive(name: &'static str, unit: &'static str, scale: f64) -> Term {
    Term { low: 0.0, ..linear(name, unit, scale) }
}

pub fn shape(name: &'static str, unit: &'static str) -> Term {
    Term { name, unit, scale: 1.0, linear: false, low: 0.0, high: f64::INFINITY }
}

impl Term {
    /// The factor of a law that has its amplitudes in it.
    pub fn amplitude() -> Self {
        linear("amplitude", "1", 1.0)
    }

    /// The factor of a formula that the author of a scenario wrote.
    pub fn amount() -> Self {
        linear("amount", "1", 1.0)
    }

    /// A parameter that a cause is in proportion to, of a usual size, where its effect lets it be.
    pub fn of_size(name: &'static str, unit: &'static str, scale: f64, low: f64, high: f64) -> Self {
        let term = linear(name, unit, scale);
        let (low, high) = (term.low.max(low), term.high.min(high));
        term.within(low, high)
    }

    /// Held where it is.
    pub fn held(self, value: f64) -> Self {
        self.within(value, value)
    }

    /// Whether it can differ by so much, which is known within so much: whatever runs share, no two of them are farther apart than its
    /// limits are.
    pub fn has_room_for(&self, apart: f64, known: f64) -> bool {
        apart <= self.high - self.low + known
    }

    /// Whether it is held.
    pub fn is_held(&self) -> bool {
        self.low >= self.high
    }

    /// With another lower limit.
    pub fn no_less(self, low: f64) -> Self {
        Self { low, ..self }
    }

    /// With other limits.
    pub fn within(self, low: f64, high: f64) -> Self {
        Self { low, high, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::linear;

    #[test]
    fn runs_differ_by_no_more_than_limits_are_apart() {
        let mass = linear("extra_mass_kg", "kg", 600.0).within(-3750.0, 7500.0);
        assert!(mass.has_room_for(11_000.0, 0.0) && mass.has_room_for(12_000.0, 1500.0));
        assert!(!mass.has_room_for(36_000.0, 1500.0));
        assert!(linear("force_n", "N", 1000.0).has_room_for(15_000.0, 0.0));
    }
}
