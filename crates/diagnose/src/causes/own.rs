//! Causes that the catalogue does not know: effects that a program registers beside those that are built in, and the
//! candidates that the author of the scenario wrote down. Each is tried by one number that it is in proportion to.

use crate::DiagnoseError;
use crate::balances::balance::{Kind, change};
use crate::case::Case;
use crate::causes::catalogue::{CHANNELS, Cause, Class, Form, Term};
use crate::runs::recorded::{Recorded, SLOWEST_M_S};
use crate::runs::said::Said;
use headland_plugin::{Bound, Card, Parameter, Registry};
use headland_scenario::Candidate;
use std::collections::BTreeSet;
use std::sync::Mutex;

/// How a cause of one's own is written.
#[derive(Clone, Debug)]
pub struct Own {
    /// The effect as a scenario writes it; the number that is looked for stands between the pieces.
    pieces: Vec<String>,
    /// Its equation.
    pub equation: String,
    /// Channels that it depends on.
    pub depends_on: Vec<&'static str>,
}

impl Own {
    /// The effect with a value, as a scenario writes it.
    pub fn written(&self, value: f64) -> String {
        self.pieces.join(&format!("{value:?}"))
    }
}

/// The formulas of the effect `expression`.
const FORMULAS: [&str; 6] = ["resistance", "force", "loss_share", "slip", "auxiliary_power", "shaft_power"];
/// What would show a cause of which nothing else is known.
const EXPERIMENT: &str = "repeat the run where the effect would be stronger, and where it would be weaker";

/// The causes that the catalogue does not know.
pub fn own(case: &Case) -> Result<Vec<Cause>, DiagnoseError> {
    let mut all = Vec::new();
    for card in beside_the_built_in(case.registry) {
        if let Some(mut cause) = of_card(card)
            && case.wanted(cause.id)
        {
            case.step(cause.id)?;
            // What cannot be tried by itself is no fault of the user's: it may stand among the candidates.
            if let Ok(Some(balances)) = balances(case, &cause) {
                cause.balances = balances;
                all.push(cause);
            }
        }
    }
    let registered: Vec<&'static str> = all.iter().map(|cause: &Cause| cause.id).collect();
    let candidates = &case.study.scenario().candidates;
    for (place, candidate) in candidates.iter().enumerate() {
        let earlier = candidates[..place].iter().filter(|other| other.name == candidate.name).count();
        let taken = registered.contains(&candidate.name.as_str());
        let mut cause = of_candidate(case.registry, candidate, earlier + usize::from(taken))?;
        if case.wanted(cause.id) {
            case.step(cause.id)?;
            let parameter = cause.terms[0].name.to_owned();
            let disproportionate = || DiagnoseError::Candidate {
                name: candidate.name.clone(),
                why: format!("what it does is not in proportion to `{parameter}`"),
            };
            cause.balances = balances(case, &cause)?.ok_or_else(disproportionate)?;
            all.push(cause);
        }
    }
    Ok(all)
}

/// Effects that the program added.
fn beside_the_built_in(registry: &Registry) -> Vec<&Card> {
    let mut built_in = Registry::new();
    headland_effect::register(&mut built_in);
    let cards = registry.cards(headland_plugin::Kind::Effect);
    cards.into_iter().filter(|card| built_in.effects.card(card.name).is_none()).collect()
}

/// An effect that one number describes; none where it takes more, or where nobody says how large it usually is.
fn of_card(card: &Card) -> Option<Cause> {
    let mut needed = card.parameters.iter().filter(|parameter| parameter.default.is_none());
    let (parameter, None) = (needed.next()?, needed.next()) else { return None };
    let scale = half_width(parameter)?;
    let own = Own {
        pieces: vec![format!("{}({}: ", card.name, parameter.name), ")".to_owned()],
        equation: card.equation.to_owned(),
        depends_on: Vec::new(),
    };
    Some(cause(card.name, card.about, term(parameter, scale), own))
}

/// A candidate: free is the amount of a formula, and of other effects the first number that is written.
fn of_candidate(
    registry: &Registry,
    candidate: &Candidate,
    namesakes: usize,
) -> Result<Cause, DiagnoseError> {
    let refused = |why: &str| DiagnoseError::Candidate { name: candidate.name.clone(), why: why.to_owned() };
    let card = registry.effects.card(&candidate.name).ok_or_else(|| refused("no effect has this name"))?;
    let id = numbered(card.name, namesakes);
    // The pieces are cut where the value goes.
    let (mut pieces, mut piece) = (Vec::new(), format!("{}(", card.name));
    let mut equation: Vec<String> = Vec::new();
    let mut varied = None;
    for field in &candidate.fields {
        piece += &field.name;
        piece += ": ";
        let formula = field.text.as_ref().filter(|_| is_formula(card.name, &field.name));
        let parameter = card.parameters.iter().find(|parameter| parameter.name == field.name);
        match (formula, field.number, parameter) {
            (Some(formula), ..) => {
                pieces.push(std::mem::take(&mut piece) + "\"");
                piece = format!(" * ({formula})\"");
                equation.push(format!("{} = {formula}", field.name));
                varied = Some(Term::amount());
            }
            (None, Some(number), Some(parameter)) if varied.is_none() => {
                pieces.push(std::mem::take(&mut piece));
                let usual = half_width(parameter).unwrap_or(1.0);
                varied = Some(term(parameter, if number == 0.0 { usual } else { number.abs() }));
            }
            _ => piece.push_str(&field.ron),
        }
        piece.push_str(", ");
    }
    pieces.push(piece.trim_end_matches(", ").to_owned() + ")");
    let varied = varied.ok_or_else(|| refused("it has no number that could be looked for"))?;
    let depends_on = names_of(&equation.join(" "));
    let equation = if equation.is_empty() { card.equation.to_owned() } else { equation.join(", ") };
    Ok(cause(id, card.about, varied, Own { pieces, equation, depends_on }))
}

fn is_formula(effect: &str, field: &str) -> bool {
    effect == "expression" && FORMULAS.contains(&field)
}

/// The channels that a formula's variables are read from.
fn names_of(formula: &str) -> Vec<&'static str> {
    let words: BTreeSet<&str> = formula.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
    let named = CHANNELS.iter().filter(|(name, _)| words.contains(name));
    let mut channels: Vec<&str> = named.map(|(_, channel)| *channel).collect();
    channels.dedup();
    channels
}

/// Half of the range in which a parameter usually lies.
fn half_width(parameter: &Parameter) -> Option<f64> {
    let (low, high) = parameter.plausible?;
    Some(0.5 * (high - low)).filter(|half| *half > 0.0)
}

fn term(parameter: &Parameter, scale: f64) -> Term {
    /// What has to be more than nothing may be this share of its usual size.
    const NEARLY_NOTHING: f64 = 1e-6;
    let (low, high) = match parameter.bound {
        Bound::Finite => (f64::NEG_INFINITY, f64::INFINITY),
        Bound::NotNegative => (0.0, f64::INFINITY),
        Bound::Positive => (NEARLY_NOTHING * scale, f64::INFINITY),
        Bound::Efficiency => (NEARLY_NOTHING, 1.0),
        Bound::Within(low, high) => (low, high),
    };
    Term::of_size(parameter.name, parameter.unit, scale, low, high)
}

fn cause(id: &'static str, words: &'static str, term: Term, own: Own) -> Cause {
    Cause {
        id,
        class: Class::Physics,
        balances: &[],
        form: Form::Parameters,
        terms: vec![term],
        shapes: vec![Vec::new()],
        equation: "",
        depends_on: &[],
        words,
        experiment: EXPERIMENT,
        law: None,
        own: Some(own),
        by_run: false,
        upstream: false,
        run: None,
    }
}

/// `name`, or `name_2` and so on for its namesakes. Identifiers live as long as the program, so each is made once.
fn numbered(name: &'static str, namesakes: usize) -> &'static str {
    static MADE: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    if namesakes == 0 {
        return name;
    }
    let wanted = format!("{name}_{}", namesakes + 1);
    let mut made = MADE.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some(known) = made.get(wanted.as_str()) {
        return known;
    }
    let new: &'static str = wanted.leak();
    made.insert(new);
    new
}

/// The balances that a cause shows in; none where it is not nearly in proportion to its number.
fn balances(case: &Case, cause: &Cause) -> Result<Option<&'static [Kind]>, DiagnoseError> {
    /// An effect is tried at this share of its usual size, and at half of that.
    const STEP: f64 = 0.5;
    /// Half the number may do more or less than half by this share of the whole, in the root mean square.
    const NEARLY: f64 = 0.1;
    let step = STEP * cause.terms[0].scale;
    let after = |value: f64| {
        case.said_with(&|_: &Recorded| cause.written(&[value]), &case.study.priors(), &case.kinds)
    };
    let (whole, half) = (after(step)?, after(0.5 * step)?);
    let mut shows = Vec::new();
    for kind in &case.kinds {
        let (mut size, mut bent) = (0.0_f64, 0.0_f64);
        for (run, recorded) in case.runs.iter().enumerate() {
            let of = |after: &[Said]| change(*kind, recorded, &case.nominal[run], &after[run]);
            let moves = recorded.motion.value.iter().map(|speed| speed.abs() > SLOWEST_M_S);
            for ((whole, half), moves) in of(&whole).into_iter().zip(of(&half)).zip(moves) {
                // What resists at rest only holds.
                if moves && whole.is_finite() && half.is_finite() {
                    size += whole * whole;
                    bent += (whole - 2.0 * half).powi(2);
                }
            }
        }
        if bent > NEARLY * NEARLY * size {
            return Ok(None);
        }
        if size > 0.0 {
            shows.push(*kind);
        }
    }
    Ok(Some(if shows.contains(&Kind::Parity) {
        &[Kind::Parity, Kind::Motion, Kind::Battery, Kind::Fuel]
    } else if shows.contains(&Kind::Motion) {
        &[Kind::Motion, Kind::Battery, Kind::Fuel]
    } else if shows.contains(&Kind::Slip) {
        &[Kind::Slip]
    } else {
        &[Kind::Battery, Kind::Fuel]
    }))
}
