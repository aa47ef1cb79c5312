//! Draft of an implement in the soil.
//!
//! D = F_i (A + B S + C S²) W T (1 − x) φ(s)
//! S speed [km/h], T depth [cm], W width [m] or number of tools, x the hitch, φ the fluctuation along the path
//!
//! Source: ASABE D497, *Agricultural Machinery Management Data*, clause 4; the table of implements says of each row where
//! its numbers come from.
//! The standard's own spread is ±15 to ±50 %. Depth follows the hitch; leaves out the pull upward or downward, and what a
//! draft control does about the fluctuation. The implement is lifted where a run begins.

use crate::draft_table::{Per, find};
use crate::fluctuation::Fluctuation;
use crate::hitch::Hitch;
use headland_plugin::{
    Bound, Card, Implement, Load, Mode, Plugin, Refusal, Situation, State, Task, parameter,
};
use serde::Deserialize;
use std::path::Path;

/// An implement that is pulled through the soil.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tillage {
    #[serde(default)]
    implement: Option<String>,
    #[serde(default)]
    draft: Option<OwnRow>,
    texture: Texture,
    width_m: f64,
    #[serde(default)]
    tools: Option<f64>,
    #[serde(default)]
    depth_m: Option<f64>,
    #[serde(default)]
    hitch: Option<Hitch>,
    #[serde(default)]
    fluctuation: Option<Fluctuation>,
    /// A, B and C, each times what it is proportional to [N].
    #[serde(skip)]
    abc_n: [f64; 3],
}

/// Texture of the soil, or its factor F_i.
#[derive(Clone, Copy, Debug, Deserialize)]
enum Texture {
    Fine,
    Medium,
    Coarse,
    Factor(f64),
}

/// Coefficients that were measured.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct OwnRow {
    a: f64,
    b: f64,
    c: f64,
    per_tool: bool,
}

impl Plugin for Tillage {
    const CARD: Card = Card {
        name: "Tillage",
        about: "draft of an implement in the soil, with its hitch and its fluctuation along the path",
        equation: "D = F_i (A + B S + C S²) W T (1 − x) (1 + σ x(s) + σ_t y(s)); S km/h, T cm; P_lift = m g h / (T η)",
        source: "ASABE D497, Agricultural Machinery Management Data, clause 4; Uhlenbeck and Ornstein, Physical Review 36 \
                 (1930) 823, for the fluctuation",
        validity: "mean drafts within the standard's ±15 to ±50 %; leaves out vertical pulls and draft control",
        parameters: &[
            parameter(
                "implement",
                "name",
                "by name; a wrong one is answered with all that are known. Some rows are from memory; or `draft`",
            ),
            parameter(
                "draft",
                "(a, b, c, per_tool)",
                "coefficients of your own in the units of D497; or `implement`",
            ),
            parameter("texture", "name", "Fine, Medium or Coarse soil, or Factor(F_i)"),
            parameter("width_m", "m", "working width, W where the draft counts metres")
                .must_be(Bound::Positive)
                .usually(0.3, 24.0),
            parameter(
                "tools",
                "1",
                "number of tools or rows, W where the draft counts them; left out elsewhere",
            )
            .must_be(Bound::Positive)
            .usually(1.0, 100.0),
            parameter(
                "depth_m",
                "m",
                "working depth, T; left out for seeding, whose draft does not count it",
            )
            .must_be(Bound::Positive)
            .usually(0.02, 0.6),
            parameter(
                "hitch",
                "(mass_kg, height_m, time_s, efficiency, working_share, lifted_share)",
                "mass of the implement, how high, how long and how well it is lifted, and which share of its weight the \
                 vehicle carries; left out: it weighs nothing and is lifted at once",
            ),
            parameter(
                "fluctuation",
                "(sd, length_m, trend_sd, trend_length_m, seed)",
                "spread along the path as shares of the mean, and lengths of correlation; left out: none",
            ),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        let refuse = |parameter: &str, found: &str, expected: &str| Refusal {
            parameter: parameter.to_owned(),
            found: found.to_owned(),
            expected: expected.to_owned(),
        };
        let (abc, factors, per, deep) = match (&self.implement, self.draft) {
            (Some(name), None) => {
                let row = find(name)?;
                (row.abc, Some(row.factors), row.per, row.deep)
            }
            (None, Some(own)) => {
                let abc = [own.a, own.b, own.c];
                if abc.iter().any(|value| !(value.is_finite() && *value >= 0.0)) {
                    return Err(refuse("draft", &format!("{abc:?}"), "finite numbers, 0 or more"));
                }
                (abc, None, if own.per_tool { Per::Tool } else { Per::Metre }, true)
            }
            (Some(_), Some(_)) => return Err(refuse("draft", "given beside `implement`", "one of the two")),
            (None, None) => return Err(refuse("implement", "not given", "an implement by name, or `draft`")),
        };
        let factor = match (self.texture, factors) {
            (Texture::Factor(factor), _) if factor > 0.0 && factor.is_finite() => factor,
            (Texture::Factor(factor), _) => {
                return Err(refuse("texture", &factor.to_string(), "more than 0"));
            }
            (Texture::Fine, Some(factors)) => factors[0],
            (Texture::Medium, Some(factors)) => factors[1],
            (Texture::Coarse, Some(factors)) => factors[2],
            (_, None) => {
                return Err(refuse("texture", "a name", "Factor(F_i): `draft` has no factors of its own"));
            }
        };
        let count = match (per, self.tools) {
            (Per::Metre, None) => self.width_m,
            (Per::Tool, Some(tools)) => tools,
            (Per::Metre, Some(tools)) => {
                return Err(refuse("tools", &tools.to_string(), "none: this draft counts metres of width"));
            }
            (Per::Tool, None) => {
                return Err(refuse("tools", "not given", "their number: this draft counts tools"));
            }
        };
        let depth_cm = match (deep, self.depth_m) {
            (true, Some(depth_m)) => CM_IN_M * depth_m,
            (false, None) => 1.0,
            (true, None) => {
                return Err(refuse("depth_m", "not given", "the working depth: this draft counts it"));
            }
            (false, Some(depth)) => {
                return Err(refuse("depth_m", &depth.to_string(), "none: this draft does not count depth"));
            }
        };
        self.abc_n = abc.map(|coefficient| factor * coefficient * count * depth_cm);
        self.hitch.iter().try_for_each(Hitch::check)?;
        self.fluctuation.iter().try_for_each(Fluctuation::check)
    }
}

const CM_IN_M: f64 = 100.0;
const KM_H_IN_M_S: f64 = 3.6;

const AREA: usize = 0;
const LIFTED: usize = 1;

impl Task for Tillage {
    fn states(&self) -> Vec<State> {
        let mut states = vec![State { name: "area_m2", initial: 0.0 }];
        if self.hitch.is_some() {
            states.push(State { name: "lifted", initial: 1.0 });
        }
        states
    }

    fn load(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        self.load_in(Mode::Work, at, states, rates)
    }

    fn load_in(&self, mode: Mode, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        let mut load = Load::default();
        let depth_share = if let Some(hitch) = &self.hitch {
            let lifted = states[LIFTED];
            rates[LIFTED] = hitch.rate(mode, lifted);
            load.hydraulic_power_w = hitch.power_w(rates[LIFTED], at.gravity_m_s2);
            (load.mass_kg, load.towed_mass_kg) = hitch.masses_kg(lifted);
            (1.0 - lifted).max(0.0)
        } else if mode == Mode::Work {
            1.0
        } else {
            0.0
        };
        let v = at.speed_m_s.abs();
        rates[AREA] = self.width_m * v * depth_share;
        if depth_share > 0.0 {
            let ([a, b, c], s) = (self.abc_n, KM_H_IN_M_S * v);
            let factor = self.fluctuation.map_or(1.0, |fluctuation| fluctuation.factor(at.position_m));
            load.drawbar_force_n = (a + b * s + c * s * s) * depth_share * factor;
        }
        load
    }

    fn implement(&self) -> Option<Implement> {
        // A drill's draft does not count its depth.
        let depth_m = Some(self.depth_m.unwrap_or(0.0));
        let lift_m = self.hitch.as_ref().map(Hitch::lift_m);
        Some(Implement { width_m: self.width_m, depth_m, tools: self.tools, lift_m })
    }
}

#[cfg(test)]
#[path = "tillage_tests.rs"]
mod tests;
