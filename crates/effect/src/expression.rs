//! A force, a slip or a power as a formula of the situation, for what has no effect of its own.
//!
//! R = f(…), F = f(…), λ = f(…), s = f(…), P = f(…)        each a text in the notation of `expression/parser.rs`
//!
//! Source: the author of the scenario; empirical. Notation and units: `expression/names.rs` and `expression/units.rs`.
//! A formula remembers how far the vehicle came since the run began, whether each of its switches is on, and what follows a value late
//! (dy/dt = (u − y)/τ). A force may name the acceleration that it makes itself, as that of an overrun brake does, and not the force of
//! the drive, of which a share may be lost, and by which wheels may slip. Units are checked
//! when it is read: sums and comparisons need one unit, functions pure numbers, and the whole has to come out in newtons or
//! watts, or as the pure number that a share or a slip is.
//! Where a formula has no finite value the action has none either, nothing is clamped: a force stops the simulation, a
//! power leaves the drive without any. A share or a slip of one or more has none either.
//! Fingerprint: whatever it says.

mod constants;
mod dimension;
mod fault;
mod lexer;
mod names;
mod parser;
mod program;
#[cfg(test)]
mod tests;
mod units;

use crate::series::refuse;
use constants::Constants;
use dimension::Dimension;
use fault::Fault;
use headland_plugin::{Action, Card, Effect, Plugin, Refusal, Situation, State, parameter};
use headland_units::parse_unit;
use names::{ACCELERATION, DRIVE, LAGS, WAY_STATE};
use parser::compile;
use program::Program;
use serde::Deserialize;
use std::ops::Range;
use std::path::Path;

/// Formulas of up to six of the things that an effect can do.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expression {
    #[serde(default)]
    resistance: Option<String>,
    #[serde(default)]
    force: Option<String>,
    #[serde(default)]
    loss_share: Option<String>,
    #[serde(default)]
    slip: Option<String>,
    #[serde(default)]
    auxiliary_power: Option<String>,
    #[serde(default)]
    shaft_power: Option<String>,
    #[serde(default)]
    constants: Constants,
    /// Whether it names what forces make,
    #[serde(skip)]
    follows: bool,
    /// and whether a force names the acceleration.
    #[serde(skip)]
    moved: bool,
    #[serde(skip)]
    follows_drive: bool,
    /// Names of what is remembered.
    #[serde(skip)]
    memory: Vec<&'static str>,
    #[serde(skip)]
    resistance_n: Option<Program>,
    #[serde(skip)]
    force_n: Option<Program>,
    #[serde(skip)]
    loss: Option<Program>,
    #[serde(skip)]
    slips: Option<Program>,
    #[serde(skip)]
    auxiliary_power_w: Option<Program>,
    #[serde(skip)]
    shaft_power_w: Option<Program>,
}

/// What is lost of the force of the drive.
const LOSS: &str = "loss_share";

impl Plugin for Expression {
    const CARD: Card = Card {
        name: "expression",
        about: "a force, a loss of the drive, a slip or a power as a formula of the situation",
        equation: "R, F, λ, s, P = + - * / ^ < <= > >= == != ( ) min max clamp abs sign sqrt pow exp ln log10 sin cos tanh latched lagged of \
                   v [m/s] acceleration [m/s²] F_drive [N] engine_speed [rad/s] x [m] way [m] t [s] heading [rad] kappa [1/m] slope [1] roll [1] elevation [m] temperature [°C] oil_temperature [°C] state_of_charge [1] tyre_pressure [Pa] pto_power [W] hydraulic_power [W] m [kg] \
                   g [m/s²] N [N] rho [kg/m³] area [m²] coasting [1] braking [1] headwind [m/s] crosswind [m/s] and \
                   constants",
        source: "the author of the scenario; empirical",
        validity: "units have to fit (a factor whose unit no name can say is written as quotients: p_w * (F_drive / f_n)^2); comparisons are 1 or 0; latched(u, on, off) is a switch that goes on at one value of u and off at another; lagged(u, τ) follows u with the time constant τ, settled when the run begins; way is the distance \
                   driven since the run began; slope and roll are the sines, the roll's with the right side lower; pto_power and hydraulic_power are what tasks take, or what was recorded; N = m g cos θ the normal load, the cross \
                   wind comes from the right; oil_temperature and tyre_pressure have to be recorded, state_of_charge where the driveline has no battery; of what forces make powers may name all, resistance and force the acceleration (one is sought that the forces make which it makes), loss_share and slip F_drive, the force of the drive before that loss; a force that is not finite stops the simulation, \
                   such a power leaves the drive without any",
        parameters: &[
            parameter(
                "resistance",
                "N (formula)",
                "against the motion, R; each formula may be left out, not all",
            ),
            parameter("force", "N (formula)", "forward, F"),
            parameter(
                "loss_share",
                "1 (formula)",
                "share of the force of the drive that is lost on its way to the ground, λ",
            ),
            parameter(
                "slip",
                "1 (formula)",
                "slip of the driven wheels, s: they turn as if the speed were v / (1 − s)",
            ),
            parameter("auxiliary_power", "W (formula)", "electric power that is taken beside the drive, P"),
            parameter(
                "shaft_power",
                "W (formula)",
                "mechanical power that is taken from the engine or motor, P",
            ),
            parameter(
                "constants",
                "{name: number} (the end of a name says the unit)",
                "numbers of the formulas",
            ),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        let constants = self.constants.checked()?;
        let mut used = vec![false; constants.len()];
        let formulas = [
            ("resistance", &self.resistance, "N", &mut self.resistance_n),
            ("force", &self.force, "N", &mut self.force_n),
            (LOSS, &self.loss_share, "1", &mut self.loss),
            ("slip", &self.slip, "1", &mut self.slips),
            ("auxiliary_power", &self.auxiliary_power, "W", &mut self.auxiliary_power_w),
            ("shaft_power", &self.shaft_power, "W", &mut self.shaft_power_w),
        ];
        self.memory.clear();
        let mut given = false;
        for (name, text, unit, program) in formulas {
            let Some(text) = text else { continue };
            given = true;
            let compiled =
                compile(text, &constants, &mut self.memory).map_err(|fault| fault.refusal(name, text))?;
            let wanted = parse_unit(unit).map_or(Dimension::NONE, |unit| Dimension::of(&unit));
            if compiled.dimension != wanted && !compiled.any_unit {
                let found = format!("\"{}\" in {}", Fault::quote(text, 0..text.len()), compiled.dimension);
                return Err(refuse(name, &found, &format!("a formula in {unit}")));
            }
            // An acceleration is found that the forces make which hang on it, and with a force what is lost of it and how wheels slip.
            let agrees = match unit {
                "N" => Some(ACCELERATION),
                "1" => Some(DRIVE),
                _ => None,
            };
            let named = |span: &&Range<usize>| Some(&text[(*span).clone()]) == agrees;
            let mut unknown = compiled.made.iter().filter(|span| unit != "W" && !named(span));
            if let Some(unknown) = unknown.next() {
                let found = format!("`{}` in what makes it", Fault::quote(text, unknown.clone()));
                return Err(refuse(name, &found, "a formula of what makes it; powers may name it"));
            }
            let agrees = compiled.made.iter().any(|span| named(&span));
            self.follows_drive |= unit == "1" && agrees;
            self.moved |= unit == "N" && agrees;
            self.follows |= !compiled.made.is_empty();
            for (used, uses) in used.iter_mut().zip(compiled.uses) {
                *used |= uses;
            }
            *program = Some(compiled.program);
        }
        if !given {
            let expected = "at least one of `resistance`, `force`, `loss_share`, `slip`, `auxiliary_power`, `shaft_power`";
            return Err(refuse("expression", "without a formula", expected));
        }
        match constants.iter().zip(used).find(|(_, used)| !used) {
            Some((unused, _)) => {
                let parameter = format!("constants.{}", unused.name);
                Err(refuse(&parameter, "in no formula", "a constant that a formula names"))
            }
            None => Ok(()),
        }
    }
}

impl Expression {
    fn programs(&self) -> impl Iterator<Item = &Program> {
        let forces = [&self.resistance_n, &self.force_n, &self.loss, &self.slips];
        let powers = [&self.auxiliary_power_w, &self.shaft_power_w];
        forces.into_iter().chain(powers).flatten()
    }
}

/// A share; NaN where it is none, because a drive that loses all its force or as much again moves nothing, and wheels that slip by all
/// their speed neither.
fn share(value: f64) -> f64 {
    if value.abs() < 1.0 { value } else { f64::NAN }
}

impl Effect for Expression {
    fn follows_acceleration(&self) -> bool {
        self.follows
    }

    fn moved_by_acceleration(&self) -> bool {
        self.moved
    }

    fn follows_drive(&self) -> bool {
        self.follows_drive
    }

    fn states(&self) -> Vec<State> {
        // What follows late begins as what it follows, in the first decision.
        let initial = |name: &str| if LAGS.contains(&name) { f64::NAN } else { 0.0 };
        self.memory.iter().map(|name| State { name, initial: initial(name) }).collect()
    }

    fn decide(&self, at: &Situation, states: &mut [f64]) -> bool {
        let mut changed = false;
        for program in self.programs() {
            changed |= program.switch(at, states);
        }
        changed
    }

    fn act(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Action {
        for (name, rate) in self.memory.iter().zip(rates.iter_mut()) {
            *rate = if *name == WAY_STATE { at.speed_m_s.abs() } else { 0.0 };
        }
        if self.memory.iter().any(|name| LAGS.contains(name)) {
            for program in self.programs() {
                program.rates(at, states, rates);
            }
        }
        let value =
            |program: &Option<Program>| program.as_ref().map_or(0.0, |program| program.value(at, states));
        Action {
            resistance_n: value(&self.resistance_n),
            force_n: value(&self.force_n),
            loss_share: share(value(&self.loss)),
            slip: share(value(&self.slips)),
            auxiliary_power_w: value(&self.auxiliary_power_w),
            shaft_power_w: value(&self.shaft_power_w),
            ..Action::default()
        }
    }
}
