//! What may stand in a law, and in which unit.
//!
//! The names are those that the effect `expression` knows, and no others: what is made of the target itself (a measured
//! force; where a force is sought, whatever goes in proportion to an acceleration) would reproduce the residual as an identity
//! and is refused.

use crate::SymbolicError;
use crate::problem::Target;
use headland_units::parse_unit;
use std::borrow::Cow;

/// A quantity that may stand in a law, sample by sample.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Its name in a formula: `v`, `x`, `t`, ...
    pub name: String,
    /// Its unit; the samples are in SI units (°C for temperatures).
    pub unit: String,
    /// Samples of every run.
    pub runs: Vec<Vec<f64>>,
    /// The same by another sensor, likewise, where there is one: what it says by the first alone is no more than that one's noise.
    pub twin: Option<Vec<Vec<f64>>>,
    /// The finest structure that the rows can show, in its unit: shorter waves would only be seen by their beat with the
    /// rows; 0 where the samples themselves are the limit.
    pub finest: f64,
    /// How it may enter.
    pub enters: Enters,
}

/// What a variable is kept from, because that is somebody else's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Enters {
    /// Nothing.
    #[default]
    Freely,
    /// What goes with its sign: it enters by its size, whichever sign it has.
    BySize,
    /// What goes from its zero on: it enters by what is there within it, or comes again.
    Within,
    /// What is in proportion to it: it enters by what bends alone, and beside no other variable.
    Bent,
}

/// How a variable may enter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// From nothing upwards: a speed.
    Size,
    /// Along which things change, begin, end and repeat: position, time.
    Coordinate,
    /// From nothing at the begin of each run: what wears off with it starts anew every time.
    Way,
    /// Whose zero is a convention: temperature, elevation.
    Level,
    /// Of either sign, with a zero that means something.
    Signed,
    /// A direction.
    Angle,
    /// A property of vehicle or world that a force may be proportional to.
    Weight,
    /// 0 or 1.
    Gate,
}

/// A name that formulas know.
#[derive(Debug)]
pub(crate) struct Known {
    pub name: &'static str,
    pub unit: &'static str,
    /// Ending of the name of a constant that is a value of it.
    pub value_ending: &'static str,
    /// Ending of the name of a constant that is a difference of values.
    pub scale_ending: &'static str,
    pub kind: Kind,
}

const fn known(name: &'static str, unit: &'static str, ending: &'static str, kind: Kind) -> Known {
    Known { name, unit, value_ending: ending, scale_ending: ending, kind }
}

/// What forces make: in the law of a force it stands by what bends alone, since in proportion to it the residual is an identity.
pub(crate) const ACCELERATION: &str = "acceleration";

/// How fast the engine turns: what a force asks of it tells that, so that it may stand in the law of a power alone.
const ENGINE_SPEED: &str = "engine_speed";

/// The force at the wheels: by itself what a law of a force would have to say.
pub(crate) const DRIVE: &str = "F_drive";

/// The pressure of the tyres, which is never nought.
pub(crate) const PRESSURE: &str = "tyre_pressure";

/// Everything that may stand in a law.
pub(crate) const KNOWN: [Known; 27] = [
    known("v", "m/s", "_m_s", Kind::Size),
    known(ACCELERATION, "m/s²", "_m_s2", Kind::Signed),
    known(ENGINE_SPEED, "rad/s", "_rad_s", Kind::Size),
    known(DRIVE, "N", "_n", Kind::Signed),
    known("x", "m", "_m", Kind::Coordinate),
    known("way", "m", "_m", Kind::Way),
    known("t", "s", "_s", Kind::Coordinate),
    known("heading", "rad", "_rad", Kind::Angle),
    known("kappa", "1/m", "_per_m", Kind::Signed),
    known("slope", "1", "", Kind::Signed),
    known("roll", "1", "", Kind::Signed),
    known("elevation", "m", "_m", Kind::Level),
    Known { name: "temperature", unit: "°C", value_ending: "_c", scale_ending: "_k", kind: Kind::Level },
    Known { name: "oil_temperature", unit: "°C", value_ending: "_c", scale_ending: "_k", kind: Kind::Level },
    known("state_of_charge", "1", "", Kind::Level),
    known(PRESSURE, "Pa", "_pa", Kind::Level),
    known("pto_power", "W", "_w", Kind::Size),
    known("hydraulic_power", "W", "_w", Kind::Size),
    known("m", "kg", "_kg", Kind::Weight),
    known("g", "m/s²", "_m_s2", Kind::Weight),
    known("N", "N", "_n", Kind::Weight),
    known("rho", "kg/m³", "_kg_m3", Kind::Weight),
    known("area", "m²", "_m2", Kind::Weight),
    known("coasting", "1", "", Kind::Gate),
    known("braking", "1", "", Kind::Gate),
    known("headwind", "m/s", "_m_s", Kind::Signed),
    known("crosswind", "m/s", "_m_s", Kind::Signed),
];

/// A variable, checked, with what the search has to know of its values.
#[derive(Debug)]
pub(crate) struct Checked<'a> {
    pub known: &'static Known,
    pub runs: &'a [Vec<f64>],
    /// The same by another sensor.
    twin_runs: Option<&'a [Vec<f64>]>,
    /// Time of every sample of every run [s].
    pub times_s: &'a [Vec<f64>],
    /// Those samples that the rows look at, and their times [s].
    pub seen: Vec<Cow<'a, [f64]>>,
    pub seen_s: Vec<Cow<'a, [f64]>>,
    /// What another sensor says at those samples.
    pub twin: Option<Vec<Cow<'a, [f64]>>>,
    /// Least and greatest value in the runs that are fitted.
    pub low: f64,
    pub high: f64,
    /// Whether any value is negative.
    pub negative: bool,
    /// How it may enter.
    pub enters: Enters,
    /// Median of the absolute steps between samples that are not zero.
    pub step: f64,
    /// The finest structure that the rows can show.
    pub finest: f64,
}

impl Checked<'_> {
    /// Leaves only every so many samples of each run to be seen.
    pub fn look_at_every(&mut self, every: impl Fn(usize) -> usize) {
        let of = |seen: &mut [Cow<'_, [f64]>], runs: &[Vec<f64>]| {
            for (run, seen) in seen.iter_mut().enumerate() {
                let every = every(run);
                if every > 1 {
                    *seen = runs[run].iter().copied().step_by(every).collect();
                }
            }
        };
        of(&mut self.seen, self.runs);
        if let Some((twin, runs)) = self.twin.as_mut().zip(self.twin_runs) {
            of(twin, runs);
        }
        of(&mut self.seen_s, self.times_s);
    }

    /// How long the longest run is [s].
    pub fn lasts_s(&self) -> f64 {
        let of = |run: &Vec<f64>| run.last().zip(run.first()).map_or(0.0, |(last, first)| last - first);
        self.times_s.iter().map(of).fold(0.0, f64::max)
    }

    /// How far its values reach.
    pub fn spread(&self) -> f64 {
        self.high - self.low
    }

    /// Its greatest absolute value.
    pub fn size(&self) -> f64 {
        self.high.abs().max(self.low.abs())
    }

    /// A round number of its size: 1, 2 or 5 times a power of ten, for powers, whose scale is free to choose.
    pub fn round_size(&self) -> f64 {
        let power = 10f64.powf(self.size().log10().floor());
        let digit = self.size() / power;
        power
            * if digit < 1.5 {
                1.0
            } else if digit < 3.5 {
                2.0
            } else if digit < 7.5 {
                5.0
            } else {
                10.0
            }
    }
}

/// Checks names, units and values; variables that never change are left out, a constant has their place.
pub(crate) fn check<'a>(
    variables: &'a [Variable],
    times_s: &'a [Vec<f64>],
    fit: &[bool],
    target: Target,
) -> Result<Vec<Checked<'a>>, SymbolicError> {
    /// A smaller share of the greatest value is rounding.
    const LEAST_SPREAD: f64 = 1e-9;
    let of_forces = target == Target::Force;
    let allowed = |known: &&Known| !of_forces || ![ENGINE_SPEED, DRIVE].contains(&known.name);
    let bends = |variable: &&Variable| of_forces && variable.name == ACCELERATION;
    if let Some(variable) = variables.iter().find(|one| bends(one) && one.enters != Enters::Bent) {
        return Err(SymbolicError::Proportional { name: variable.name.clone() });
    }
    let mut all: Vec<Checked<'a>> = Vec::new();
    let mut names: Vec<&str> = Vec::new();
    for variable in variables {
        let name = variable.name.as_str();
        let Some(known) = KNOWN.iter().filter(allowed).find(|known| known.name == name) else {
            let known = KNOWN.iter().filter(allowed).map(|known| known.name).collect();
            return Err(SymbolicError::Unknown { name: name.to_owned(), known });
        };
        if names.contains(&name) {
            return Err(SymbolicError::Twice { name: name.to_owned() });
        }
        names.push(name);
        let (found, expected) = (parse_unit(&variable.unit), parse_unit(known.unit));
        // Same size as well: samples are SI numbers, and no conversion is made here.
        let fits = found.as_ref().ok().zip(expected.as_ref().ok()).is_some_and(|(found, expected)| {
            found.dimension == expected.dimension
                && found.factor == expected.factor
                && found.offset == expected.offset
        });
        if !fits {
            return Err(SymbolicError::Unit {
                name: name.to_owned(),
                found: variable.unit.clone(),
                expected: known.unit.to_owned(),
            });
        }
        for (run, values) in
            variable.runs.iter().enumerate().chain(variable.twin.iter().flatten().enumerate())
        {
            if !values.iter().all(|value| value.is_finite()) {
                return Err(SymbolicError::NotFinite { what: format!("`{name}`"), run });
            }
        }
        let fitted = || variable.runs.iter().zip(fit).filter(|(_, fit)| **fit).map(|(values, _)| values);
        let (low, high) =
            fitted().flatten().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(*value), high.max(*value))
            });
        let mut steps: Vec<f64> = fitted()
            .flat_map(|values| values.windows(2).map(|pair| (pair[1] - pair[0]).abs()))
            .filter(|step| *step > 0.0)
            .collect();
        steps.sort_by(f64::total_cmp);
        let step = steps.get(steps.len() / 2).copied().unwrap_or(0.0);
        let negative = variable.runs.iter().flatten().any(|value| *value < 0.0);
        let borrowed = |runs: &'a [Vec<f64>]| runs.iter().map(|run| Cow::Borrowed(run.as_slice())).collect();
        let (runs, finest) = (variable.runs.as_slice(), variable.finest);
        let (seen, seen_s, enters) = (borrowed(runs), borrowed(times_s), variable.enters);
        let twin_runs = variable.twin.as_deref();
        let twin = twin_runs.map(borrowed);
        let checked = Checked {
            known,
            runs,
            twin_runs,
            times_s,
            seen,
            seen_s,
            twin,
            low,
            high,
            negative,
            enters,
            step,
            finest,
        };
        if checked.spread() > LEAST_SPREAD * checked.size() {
            all.push(checked);
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NO_TIMES: &[Vec<f64>] = &[];

    fn variable(name: &str, unit: &str) -> Variable {
        Variable {
            name: name.to_owned(),
            unit: unit.to_owned(),
            runs: vec![vec![0.0, 1.0, 3.0]],
            twin: None,
            finest: 0.0,
            enters: Enters::Freely,
        }
    }

    #[test]
    fn endings_stand_for_the_units_of_their_variables() {
        for known in &KNOWN {
            let wanted = parse_unit(known.unit).unwrap();
            for ending in [known.value_ending, known.scale_ending] {
                let unit = headland_units::unit_of_name(&format!("q1{ending}"));
                match unit {
                    Some(unit) => assert!(unit.dimension == wanted.dimension && unit.to_si(1.0) == 1.0),
                    None => assert_eq!(wanted.dimension, headland_units::Dimension::NONE, "{known:?}"),
                }
            }
        }
    }

    #[test]
    fn what_is_made_of_the_target_is_refused() {
        for name in ["a", "force", "dv_dt", "tractive_force_n", "F_drive"] {
            let error = check(&[variable(name, "N")], NO_TIMES, &[true], Target::Force).unwrap_err();
            assert!(matches!(error, SymbolicError::Unknown { .. }), "{error}");
        }
    }

    #[test]
    fn an_acceleration_enters_the_law_of_a_force_by_what_bends_alone() {
        let of = |enters| [Variable { enters, ..variable("acceleration", "m/s²") }];
        for enters in [Enters::Freely, Enters::BySize] {
            let error = check(&of(enters), NO_TIMES, &[true], Target::Force).unwrap_err();
            assert!(matches!(error, SymbolicError::Proportional { .. }), "{error}");
            assert!(check(&of(enters), NO_TIMES, &[true], Target::Power).is_ok());
        }
        assert!(check(&of(Enters::Bent), NO_TIMES, &[true], Target::Force).is_ok());
    }

    #[test]
    fn a_unit_that_does_not_fit_is_refused() {
        for (name, unit) in [("v", "kg"), ("v", "km/h"), ("x", "s"), ("temperature", "K"), ("t", "furlong")] {
            let error = check(&[variable(name, unit)], NO_TIMES, &[true], Target::Force).unwrap_err();
            assert!(matches!(error, SymbolicError::Unit { .. }), "{error}");
        }
        assert!(
            check(&[variable("v", "m/s"), variable("v", "m/s")], NO_TIMES, &[true], Target::Force).is_err()
        );
    }

    #[test]
    fn what_never_changes_is_left_out() {
        let still = Variable { runs: vec![vec![4.0; 3]], ..variable("m", "kg") };
        let all = [still, variable("v", "m/s")];
        let checked = check(&all, NO_TIMES, &[true], Target::Force).unwrap();
        assert_eq!(checked.len(), 1);
        assert!((checked[0].round_size() - 2.0).abs() < 1e-12 && checked[0].step > 0.0);
    }
}
