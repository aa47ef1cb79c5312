//! A line in a plane as a terrain: what all patterns of field work have in common.

use crate::marks::Marks;
use crate::plane::{Incline, PlanePath};
use headland_plugin::{Card, Place, Plugin, Refusal, Surface, Terrain};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer};
use std::fmt::Debug;
use std::path::Path;

/// How a field is driven over.
pub(crate) trait Pattern: Debug + Send + Sync {
    const CARD: Card;

    /// The line on the map, from the origin.
    ///
    /// # Errors
    /// [`Refusal`] names a parameter that allows none.
    fn line(&self) -> Result<Line, Refusal>;

    /// Its numbers by the names of its card, for where it is part of another terrain.
    fn numbers(&self) -> Vec<(&'static str, f64)>;

    /// How the field lies.
    fn incline(&self) -> Incline;
}

/// A line and what stands along it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Line {
    pub path: PlanePath,
    pub marks: Marks,
}

impl Line {
    /// One that begins at the origin.
    pub fn heading(heading_rad: f64) -> Self {
        Self { path: PlanePath::heading(heading_rad), marks: Marks::default() }
    }

    /// Sets a mark where it ends so far.
    pub fn mark(&mut self, name: &str) {
        self.marks.set(name, self.path.length_m());
    }
}

/// A pattern laid over a plane.
#[derive(Clone, Debug)]
pub struct Laid<P> {
    pub(crate) pattern: P,
    line: Line,
    plane: Incline,
}

#[cfg(test)]
impl<P> Laid<P> {
    pub(crate) fn length_m(&self) -> f64 {
        self.line.path.length_m()
    }
}

impl<'de, P: Deserialize<'de>> Deserialize<'de> for Laid<P> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let pattern = P::deserialize(deserializer)?;
        Ok(Self { pattern, line: Line::default(), plane: Incline::default() })
    }
}

#[allow(private_bounds, reason = "the patterns are those of this crate")]
impl<P: Pattern + DeserializeOwned + 'static> Plugin for Laid<P> {
    const CARD: Card = P::CARD;

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        self.line = self.pattern.line()?;
        self.plane = self.pattern.incline();
        Ok(())
    }
}

#[allow(private_bounds, reason = "the patterns are those of this crate")]
impl<P: Pattern> Terrain for Laid<P> {
    fn at(&self, position_m: f64) -> Place {
        self.plane.place(&self.line.path.at(position_m))
    }

    fn extent_m(&self) -> Option<(f64, f64)> {
        Some((0.0, self.line.path.length_m()))
    }

    fn marks(&self) -> Vec<&str> {
        self.line.marks.names()
    }

    fn next_mark_m(&self, name: &str, position_m: f64) -> Option<f64> {
        self.line.marks.next_m(name, position_m)
    }

    fn surface(&self) -> Option<&dyn Surface> {
        Some(&self.plane)
    }
}
