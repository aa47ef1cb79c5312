//! A law as text that the effect `expression` reads, and the numbers that its constants stand for.

use crate::known_variables;
use crate::polish::Polished;
use crate::problem::Bench;
use crate::shape::Free;
use crate::variable::Known;
use nalgebra::DMatrix;

/// A number of a law.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    /// Its name in the text; the ending says the unit.
    pub name: String,
    /// Its value, in the unit of its name.
    pub value: f64,
    /// Standard deviation; none where it was chosen, not estimated.
    pub sd: Option<f64>,
    /// Its unit.
    pub unit: String,
}

impl Constant {
    /// Whether it is what a term is multiplied by: `a1_n`, and no scale or place of a variable.
    pub fn is_amplitude(&self) -> bool {
        let number = self.name.strip_prefix('a');
        number.is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
    }
}

/// A law and how it fared.
#[derive(Clone, Debug, Default)]
pub struct Law {
    /// The formula, in the unit of its target.
    pub text: String,
    /// Its constants, in the order in which the text names them.
    pub constants: Vec<Constant>,
    /// Terms that are added.
    pub terms: usize,
    /// Terms, factors and free constants: what it costs to write down.
    pub complexity: usize,
    /// Growth of ln p on the runs that were fitted.
    pub gain: f64,
    /// Deviance on the runs that were left out, less that of no law at all, over all folds: the lower the better.
    pub error: f64,
    /// Standard error of the difference of its error from that of the best law.
    pub error_beyond_best_sd: f64,
    /// Difference of its error from that of the best law.
    pub error_beyond_best: f64,
    /// Share of the squared error on runs left out that it takes away.
    pub explained: f64,
    /// The same on runs that were never fitted; none where there are none.
    pub unseen: Option<f64>,
    /// Where another sensor tells of a variable too: the share that is left of what the law, or any term of it, takes of the squared
    /// residual where that sensor is asked instead.
    pub kept: Option<f64>,
    /// What it says, sample by sample, of every run, in the unit of its target.
    pub prediction: Vec<Vec<f64>>,
    /// Its terms by themselves, each a law with the numbers that it has here, where there are several.
    pub each: Vec<Law>,
    /// The same with another power of what stands in it, in the place of each: rows that hardly tell powers apart may do so beside what
    /// the caller knows. None of laws that are longer than the one that was chosen.
    pub powers: Vec<Law>,
}

/// Constants as the effect `expression` takes them: `{"a1_n": 120.0, "v1_m_s": 5.0}`.
pub fn constants_text(constants: &[Constant]) -> String {
    let one = |constant: &Constant| format!("\"{}\": {:?}", constant.name, constant.value);
    format!("{{{}}}", constants.iter().map(one).collect::<Vec<_>>().join(", "))
}

impl Law {
    /// Its constants as the effect `expression` takes them.
    pub fn constants_text(&self) -> String {
        constants_text(&self.constants)
    }

    /// Names of the variables that stand in it, as far as they are known to formulas.
    pub fn names(&self, name: &str) -> bool {
        has_word(&self.text, name)
    }

    /// Names of the variables of each of its terms.
    pub fn variables_of_terms(&self) -> Vec<Vec<&'static str>> {
        let of = |term: &str| -> Vec<&'static str> {
            known_variables().map(|(name, _)| name).filter(|name| has_word(term, name)).collect()
        };
        self.texts().into_iter().map(of).collect()
    }

    /// The text of each of its terms.
    pub fn texts(&self) -> Vec<&str> {
        terms(&self.text)
    }
}

fn has_word(text: &str, word: &str) -> bool {
    let letter = |c: char| c.is_alphanumeric() || c == '_';
    text.split(|c: char| !letter(c)).any(|own| own == word)
}

/// The terms of a formula: what is added outside of brackets.
fn terms(text: &str) -> Vec<&str> {
    let (mut depth, mut from) = (0usize, 0);
    let mut all = Vec::new();
    for (at, letter) in text.char_indices() {
        match letter {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            '+' if depth == 0 => {
                all.push(text[from..at].trim());
                from = at + 1;
            }
            _ => {}
        }
    }
    all.push(text[from..].trim());
    all
}

/// Text, constants and prediction of a law.
pub(crate) struct Written {
    pub text: String,
    pub constants: Vec<Constant>,
    pub prediction: Vec<Vec<f64>>,
}

/// Writes a law; `covariance` is that of amplitudes, then inner constants, with the noise in it.
pub(crate) fn write(bench: &Bench, law: &Polished, covariance: &DMatrix<f64>, runs: usize) -> Written {
    let mut writer = Writer { constants: Vec::new(), used: Vec::new() };
    let mut terms = Vec::new();
    let (mut amplitude, mut inner) = (0, law.amplitudes.len());
    for (index, term) in law.terms.iter().enumerate() {
        let of = covariance.view((amplitude, amplitude), (term.width(), term.width())).into_owned();
        let (size, phase) = polar(&law.amplitudes[amplitude..amplitude + term.width()], &of);
        amplitude += term.width();
        let ending = bench.target.ending();
        let mut parts =
            vec![writer.constant(&format!("a{}{ending}", index + 1), size, true, bench.target.unit())];
        for factor in &term.factors {
            let of = &bench.variables[factor.variable];
            let sd_of = |free: Free, inner_size: f64| {
                factor.shape.free().contains(&free).then(|| {
                    let at = inner + factor.shape.free().iter().position(|one| *one == free).unwrap_or(0);
                    covariance[(at, at)].max(0.0).sqrt() * inner_size
                })
            };
            let repeats = factor.shape.repeats();
            let reach = if repeats { factor.scale.powi(2) / of.spread() } else { factor.scale };
            let scale_sd = sd_of(Free::Scale, reach);
            let centre_sd = sd_of(Free::Centre, if repeats { factor.scale } else { of.spread() });
            let power_sd = sd_of(Free::Power, 1.0);
            let level_sd = sd_of(Free::Level, 1.0);
            let lag_sd = sd_of(Free::Lag, factor.lag_s());
            inner += factor.shape.free().len();
            let known = of.known;
            let centre = if factor.shape.has_centre() {
                writer.of(known, known.value_ending, factor.centre, centre_sd)
            } else {
                String::new()
            };
            let scale = if factor.shape.has_scale() {
                writer.of(known, known.scale_ending, factor.scale, scale_sd)
            } else {
                String::new()
            };
            let phase = match phase {
                Some(phase) if factor.shape.has_phase() => {
                    writer.constant(&format!("phase{}_rad", index + 1), phase, true, "rad")
                }
                _ => String::new(),
            };
            let mut own = |name: &str, value: f64, sd: f64, unit: &str| {
                let ending = if unit == "1" { String::new() } else { format!("_{unit}") };
                writer.constant(&format!("{name}{}{ending}", index + 1), (value, sd), true, unit)
            };
            let power = match (power_sd, level_sd, lag_sd) {
                (Some(sd), _, _) => own("power", factor.power(), sd, "1"),
                (_, Some(sd), _) => own("level", factor.level(), sd, "1"),
                (_, _, Some(sd)) => own("lag", factor.lag_s(), sd, "s"),
                _ => String::new(),
            };
            parts.push(factor.text(of, [&scale, &centre, &phase, &power]));
        }
        terms.push(parts.join(" * "));
    }
    let text = if terms.is_empty() { "0".to_owned() } else { terms.join(" + ") };
    let prediction = (0..runs).map(|run| predict(bench, law, run)).collect();
    Written { text, constants: writer.constants, prediction }
}

/// A value and its standard deviation.
type Known1 = (f64, f64);

/// Size and phase of a sine and a cosine: a sin ω + b cos ω = r sin(ω + φ).
fn polar(amplitudes: &[f64], covariance: &DMatrix<f64>) -> (Known1, Option<Known1>) {
    let variance = |row: usize, column: usize| covariance[(row, column)];
    let [a, b] = *amplitudes else {
        return ((amplitudes[0], variance(0, 0).max(0.0).sqrt()), None);
    };
    let size = a.hypot(b).max(f64::MIN_POSITIVE);
    let along =
        (a * a * variance(0, 0) + 2.0 * a * b * variance(0, 1) + b * b * variance(1, 1)) / size.powi(2);
    let across =
        (b * b * variance(0, 0) - 2.0 * a * b * variance(0, 1) + a * a * variance(1, 1)) / size.powi(4);
    ((size, along.max(0.0).sqrt()), Some((b.atan2(a), across.max(0.0).sqrt())))
}

fn predict(bench: &Bench, law: &Polished, run: usize) -> Vec<f64> {
    let columns: Vec<Vec<f64>> =
        law.terms.iter().flat_map(|term| term.all_samples(&bench.variables, run)).collect();
    let length = columns.first().map_or(0, Vec::len);
    let sum = |at: usize| columns.iter().zip(&law.amplitudes).map(|(column, share)| share * column[at]).sum();
    (0..length).map(sum).collect()
}

struct Writer {
    constants: Vec<Constant>,
    /// The variable of each constant.
    used: Vec<&'static str>,
}

impl Writer {
    fn constant(&mut self, name: &str, (value, sd): Known1, estimated: bool, unit: &str) -> String {
        let sd = estimated.then_some(sd);
        self.constants.push(Constant { name: name.to_owned(), value, sd, unit: unit.to_owned() });
        name.to_owned()
    }

    fn of(&mut self, known: &'static Known, ending: &str, value: f64, sd: Option<f64>) -> String {
        let number = 1 + self.used.iter().filter(|name| **name == known.name).count();
        self.used.push(known.name);
        let unit = if ending == "_k" { "K" } else { known.unit };
        let name = format!("{}{number}{ending}", known.name);
        self.constant(&name, (value, sd.unwrap_or(0.0)), sd.is_some(), unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_added_within_a_bracket_is_no_term() {
        let text = "a1_n * sin(6.28 * x / x1_m + phase1_rad) + a2_n * (abs(v) / v1_m_s)^0.5";
        assert_eq!(terms(text), ["a1_n * sin(6.28 * x / x1_m + phase1_rad)", "a2_n * (abs(v) / v1_m_s)^0.5"]);
        assert!(
            has_word(text, "v") && has_word(text, "x") && !has_word(text, "t") && !has_word(text, "phase1")
        );
    }
}
