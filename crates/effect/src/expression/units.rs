//! Which units may meet.

use super::dimension::Dimension;
use super::fault::Fault;
use std::ops::Range;

/// A piece of an expression.
#[derive(Clone, Debug)]
pub(super) struct Operand {
    pub dimension: Dimension,
    /// Its value where it is made of written numbers alone.
    pub literal: Option<f64>,
    /// The bytes of the text that it covers.
    pub span: Range<usize>,
}

impl Operand {
    /// A written 0 has every unit: `max(0, v - v0_m_s)`.
    pub(super) fn is_zero(&self) -> bool {
        self.literal == Some(0.0)
    }

    /// Refuses what has a unit.
    pub(super) fn pure(&self, text: &str, expected: &str) -> Result<(), Fault> {
        if self.dimension.is_pure() { Ok(()) } else { Err(self.fault(text, expected)) }
    }

    /// The unit of this to the power of another.
    pub(super) fn raised(&self, text: &str, exponent: &Self) -> Result<Dimension, Fault> {
        exponent.pure(text, "a pure number as the exponent")?;
        match exponent.literal {
            Some(power) => Ok(self.dimension.to_the(power)),
            None if self.dimension.is_pure() => Ok(Dimension::NONE),
            None => {
                let told = format!("a written number as the exponent of what is in {}", self.dimension);
                Err(Fault::at(text, exponent.span.clone(), "", &told))
            }
        }
    }

    pub(super) fn fault(&self, text: &str, expected: &str) -> Fault {
        let told = if self.dimension.is_pure() {
            format!(", which is {}", self.dimension)
        } else {
            format!(", which is in {}", self.dimension)
        };
        Fault::at(text, self.span.clone(), &told, expected)
    }
}

/// The unit of two pieces that are added or compared.
pub(super) fn same_unit(text: &str, left: &Operand, right: &Operand) -> Result<Dimension, Fault> {
    if left.dimension == right.dimension || right.is_zero() {
        Ok(left.dimension)
    } else if left.is_zero() {
        Ok(right.dimension)
    } else {
        let beside = Fault::quote(text, left.span.clone());
        Err(right.fault(text, &format!("{} as in `{beside}` beside it", left.dimension)))
    }
}
