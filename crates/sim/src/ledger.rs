//! Where the energy came from and where it went.

use crate::Model;
use headland_plugin::MAX_LOSSES;
use serde::Serialize;

/// One line of the ledger.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Entry {
    /// What took the energy.
    pub name: String,
    /// How much [J]; negative where it gave.
    pub energy_j: f64,
}

/// Energy of a run: `source = kinetic + Σ sinks + residual`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Ledger {
    /// Name of the store that was drawn on.
    pub source_name: String,
    /// Energy that the store gave [J].
    pub source_j: f64,
    /// Gain of kinetic energy, rotating parts included [J].
    pub kinetic_j: f64,
    /// Everything else, the gain of potential energy (`slope`) included.
    pub sinks: Vec<Entry>,
    /// What the balance leaves over: the error of the integration [J].
    pub residual_j: f64,
}

impl Ledger {
    /// Sum of the magnitudes that the balance moves, halved: what left one account came to another [J].
    pub fn turnover_j(&self) -> f64 {
        let sinks: f64 = self.sinks.iter().map(|entry| entry.energy_j.abs()).sum();
        0.5 * (self.source_j.abs() + self.kinetic_j.abs() + sinks)
    }

    /// The residual as a share of the turnover.
    pub fn relative_residual(&self) -> f64 {
        let turnover = self.turnover_j();
        if turnover > 0.0 { self.residual_j.abs() / turnover } else { 0.0 }
    }

    /// Books what a carriage took besides.
    pub(crate) fn add(&mut self, accounts: Vec<(&'static str, f64)>) {
        for (name, energy_j) in accounts.into_iter().filter(|(_, energy_j)| *energy_j != 0.0) {
            self.residual_j -= energy_j;
            self.sinks.push(Entry { name: name.to_owned(), energy_j });
        }
    }

    pub(crate) fn close(source_name: &str, kinetic_j: f64, slots: &Slots, energies: &[f64]) -> Self {
        let mut sinks: Vec<Entry> = Vec::new();
        for (name, energy_j) in slots.names.iter().zip(energies).skip(1) {
            if *energy_j != 0.0 {
                sinks.push(Entry { name: name.clone(), energy_j: *energy_j });
            }
        }
        let source_j = energies[SOURCE];
        let sum: f64 = sinks.iter().map(|entry| entry.energy_j).sum();
        Self {
            source_name: source_name.to_owned(),
            source_j,
            kinetic_j,
            sinks,
            residual_j: source_j - kinetic_j - sum,
        }
    }
}

pub(crate) const SOURCE: usize = 0;
pub(crate) const SOIL: usize = 1;
pub(crate) const AIR: usize = 2;
pub(crate) const SLOPE: usize = 3;
pub(crate) const BRAKES: usize = 4;
pub(crate) const DRAWBAR: usize = 5;
pub(crate) const PTO: usize = 6;
pub(crate) const HYDRAULICS: usize = 7;
pub(crate) const AUXILIARY: usize = 8;
pub(crate) const MASS_CHANGE: usize = 9;
pub(crate) const FIRST_LOSS: usize = 10;
/// Names of the accounts, by index: the fixed ones, the driveline's losses, the effects.
#[derive(Debug)]
pub(crate) struct Slots {
    pub names: Vec<String>,
    pub first_effect: usize,
    /// What wheels that slip or slide take; `None` where the vehicle has no axles, and its brakes no limit.
    pub slip: Option<usize>,
}

impl Slots {
    pub fn of(model: &Model) -> Self {
        let ground = if model.soil.is_some() { "soil" } else { "road load" };
        let mut names: Vec<String> = [
            "source",
            ground,
            "air",
            "slope",
            "brakes",
            "drawbar",
            "power take-off",
            "hydraulics",
            "auxiliary",
            "mass change",
        ]
        .map(str::to_owned)
        .into();
        names.extend(model.driveline.losses().iter().map(|&name| name.to_owned()));
        let first_effect = names.len();
        names.extend(model.effects.iter().map(|effect| effect.name.clone()));
        let slides = model.axles.is_some() || model.vehicle.brake_friction.is_finite();
        let slip = slides.then(|| {
            names.push("slip".to_owned());
            names.len() - 1
        });
        Self { names, first_effect, slip }
    }

    /// How many accounts there are, those without a name included into which losses are written that nobody has.
    pub fn count(&self) -> usize {
        self.names.len().max(FIRST_LOSS + MAX_LOSSES)
    }
}
