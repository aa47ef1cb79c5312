//! Laws beside a consumer that is switched with time, which in each run takes a course of its own.
//!
//! Such a course swallows every law, and what it has swallowed leaves nothing to find one in. A law is found as if there were no course,
//! and the course is drawn anew beside it. Of a fan the course then takes what another power would leave: it gives back what a square is
//! above a cube. So other powers are tried, and a law whose course takes more than it gives comes first.

use crate::causes::catalogue::ELECTRIC;
use crate::causes::profile::Function;
use crate::choosing::state::{Part, Stand, State};

impl State<'_> {
    /// A set beside courses of what was found, those of these names, which are drawn anew.
    pub fn beside_courses(&self, set: &Stand, found: &Stand, names: &[&str]) -> Option<Stand> {
        let named = |part: &&Part| names.contains(&self.id(&part.trial));
        let anew = |part: &Part| {
            let mut part = part.clone();
            if let Some(spread) = part.spread.as_mut().filter(|spread| spread.jumps.is_some()) {
                *spread = spread.afresh(self.cause(&part.trial).terms[0].scale);
            }
            part
        };
        let others = set.parts.iter().filter(|part| !named(part)).cloned();
        let parts: Vec<Part> = others.chain(found.parts.iter().filter(named).map(anew)).collect();
        let settled = self.settle(&parts, &found.noises)?;
        let stepped = self.stepped(&settled).filter(|stepped| stepped.score > settled.score);
        Some(stepped.unwrap_or(settled))
    }

    /// Whether a consumer of a set that takes a course of time gives back more than it takes.
    pub fn gives_back(&self, set: &Stand) -> bool {
        let gives = |(part, function): (&Part, &Option<Function>)| {
            let level_w = set.value(part.trial.columns[0]);
            function.as_ref().is_some_and(|function| {
                let powers_w = function.values.iter().flat_map(|(powers_w, _)| powers_w.iter());
                self.id(&part.trial) == ELECTRIC
                    && self.cause(&part.trial).is_course()
                    && gives_more(powers_w.map(|power_w| level_w + power_w))
            })
        };
        set.parts.iter().zip(&set.functions).any(gives)
    }
}

/// Whether powers below nought are more than those above, by their squares.
pub fn gives_more(powers_w: impl Iterator<Item = f64>) -> bool {
    let (mut taken, mut given) = (0.0, 0.0);
    for power_w in powers_w {
        if power_w > 0.0 { taken += power_w.powi(2) } else { given += power_w.powi(2) }
    }
    given > taken
}

#[cfg(test)]
mod tests {
    use super::gives_more;

    /// Beside consumers that are known to a few hundred watts a heater of 2 kW may seem to give those back while it is off.
    #[test]
    fn a_heater_takes_more_than_it_seems_to_give_and_noise_does_not() {
        let heater = [-400.0, -380.0, 2100.0, 1900.0, -420.0, -390.0];
        assert!(!gives_more(heater.into_iter()));
        assert!(gives_more([-4927.0, 2038.0, -360.0, 300.0].into_iter()));
    }
}
