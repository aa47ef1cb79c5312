//! A cause that is tried: an effect of the simulator, how its parameters are written, and what it can be.

use super::law_text::{FORCE, LawText, RESISTANCE};
use super::powers::START;
use super::term::Term;
use crate::balances::balance::Kind;
use crate::causes::own::Own;
use std::f64::consts::{PI, TAU};

/// What tyres that warm up are in proportion to.
const WARMING: &str = "cold_coefficient";
/// What a level that rises in the cold is in proportion to.
const COLD: &str = "coefficient_per_k";

/// What a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Something of the world.
    Physics,
    /// Something of a sensor.
    Artefact,
    /// Something that nobody listed.
    Unlisted,
}

/// How the cause enters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// By parameters.
    Parameters,
    /// By a function of the position along the path.
    OverPosition,
    /// By a function of time, of its own in each run.
    OverTime,
    /// By a change of what was measured.
    Measured,
    /// By an equation that was found.
    Law,
}

/// A cause that is tried.
#[derive(Clone, Debug)]
pub struct Cause {
    /// The contract's identifier.
    pub id: &'static str,
    /// World or sensor.
    pub class: Class,
    /// Balances that it can explain.
    pub balances: &'static [Kind],
    /// How it enters.
    pub form: Form,
    /// Its parameters.
    pub terms: Vec<Term>,
    /// Values at which its non-linear parameters are tried, in the order of the terms; one empty list where there are none.
    pub shapes: Vec<Vec<f64>>,
    /// Its equation.
    pub equation: &'static str,
    /// Channels that it depends on.
    pub depends_on: &'static [&'static str],
    /// What a person calls it: 'a wind', 'softer ground'.
    pub words: &'static str,
    /// The run that would show it best.
    pub experiment: &'static str,
    /// The equation, where it was found.
    pub law: Option<LawText>,
    /// How it is written, where it is the user's.
    pub own: Option<Own>,
    /// Whether a function of time has one value throughout each run.
    pub by_run: bool,
    /// Whether it lies before the place where the force at the wheels is told.
    pub upstream: bool,
    /// The one run in which it works; none where it works in all of them.
    pub run: Option<usize>,
}

pub fn cause(
    id: &'static str,
    balances: &'static [Kind],
    terms: Vec<Term>,
    equation: &'static str,
    depends_on: &'static [&'static str],
    words: &'static str,
    experiment: &'static str,
) -> Cause {
    Cause {
        id,
        class: Class::Physics,
        balances,
        form: Form::Parameters,
        terms,
        shapes: vec![Vec::new()],
        equation,
        depends_on,
        words,
        experiment,
        law: None,
        own: None,
        by_run: false,
        upstream: false,
        run: None,
    }
}

/// How long a window takes to set in and to end.
pub const RAMP: &str = "ramp_s";
/// The cause that is a limit.
pub const LIMIT: &str = "regeneration_limit";

impl Cause {
    /// The step by which a cause of this shape is told, where a share of its usual size tells something else: all of a limit, and
    /// next to nothing of a wind that blows either way.
    pub fn own_step(&self, shape: &[f64]) -> Option<f64> {
        const BREATH_M_S: f64 = 0.1;
        match self.id {
            LIMIT => shape.first().copied(),
            _ if self.blows_by_run() => Some(BREATH_M_S),
            _ => None,
        }
    }

    /// Whether it is a wind that blows otherwise in each run.
    pub fn blows_by_run(&self) -> bool {
        self.id == "wind" && self.by_run
    }

    /// Places of the begin and of the end of a window among the terms, where it has one.
    pub fn window(&self) -> Option<(usize, usize)> {
        self.places("from_s", "to_s")
    }

    /// Whether it is a map of how softly the ground bears.
    pub fn is_patch(&self) -> bool {
        self.form == Form::OverPosition && self.even().is_some_and(|(id, _)| id == "rolling_resistance")
    }

    /// When it sets in and ends, by its shape [s].
    pub fn window_s(&self, shape: &[f64]) -> Option<[f64; 2]> {
        let (from, to) = self.window()?;
        let held: Vec<usize> = (0..self.terms.len()).filter(|place| !self.terms[*place].linear).collect();
        let of = |place: usize| shape.get(held.iter().position(|held| *held == place)?).copied();
        Some([of(from)?, of(to)?])
    }

    /// How long it takes to set in and to end, by its shape [s], where that is estimated.
    pub fn ramp_s(&self, shape: &[f64]) -> Option<f64> {
        let shaped = self.terms.iter().filter(|term| !term.linear);
        shaped.zip(shape).find(|(term, _)| term.name == RAMP).map(|(_, value)| *value)
    }

    /// The cause that is the same with edges that take their time, by its place among all.
    pub fn softened(&self, all: &[Self]) -> Option<usize> {
        let names = |cause: &Self| cause.terms.iter().map(|term| term.name).collect::<Vec<_>>();
        let wanted: Vec<_> = names(self).into_iter().chain([RAMP]).collect();
        all.iter().position(|other| {
            other.id == self.id && other.upstream == self.upstream && names(other) == wanted
        })
    }

    /// How many numbers are estimated where it is no function: sizes and shapes, or those of its formula.
    pub fn numbers(&self) -> usize {
        let of_law = |law: &LawText| law.constants.iter().filter(|constant| constant.sd.is_some()).count();
        self.law.as_ref().map_or(self.terms.len(), of_law)
    }

    /// Places of the speed at which a ramp begins and of its width among the terms, where it has one.
    pub fn ramp(&self) -> Option<(usize, usize)> {
        self.places("threshold_m_s", "width_m_s")
    }

    /// How many mechanical points or changes of range it has.
    pub fn speeds(&self) -> usize {
        const SPEEDS: [&str; 2] = ["node_speed_m_s", "speed_m_s"];
        self.terms.iter().filter(|term| SPEEDS.contains(&term.name)).count()
    }

    /// Whether it takes a course of its own in each run.
    pub fn is_course(&self) -> bool {
        self.form == Form::OverTime && !self.by_run
    }

    /// Whether it is a function that is switched, as a consumer and an implement are.
    pub fn is_switched(&self) -> bool {
        self.is_function() && self.id == "auxiliary_power" || self.pulls_in_spells()
    }

    /// Whether it is a pull that takes a course of its own in each run.
    pub fn pulls_in_spells(&self) -> bool {
        self.is_course() && self.id == "drawbar_load"
    }

    /// The same cause with one speed more, by its place among all.
    pub fn with_one_more_speed(&self, all: &[Self]) -> Option<usize> {
        let wanted = |other: &Self| {
            other.id == self.id && other.upstream == self.upstream && other.speeds() == self.speeds() + 1
        };
        if self.speeds() == 0 { None } else { all.iter().position(wanted) }
    }

    /// Places of two terms by their names, where it has both.
    fn places(&self, one: &str, other: &str) -> Option<(usize, usize)> {
        let place = |name: &str| self.terms.iter().position(|term| term.name == name);
        Some((place(one)?, place(other)?))
    }

    /// Whether a shape can be: within its limits, what lasts has to begin before it ends, and a ramp ends before the fastest
    /// that its begin can be.
    pub fn possible(&self, shape: &[f64]) -> bool {
        let shapes = self.terms.iter().filter(|term| !term.linear).zip(shape);
        let mut free = shapes.filter(|(term, _)| !term.is_held());
        if free.any(|(term, value)| !(term.low..=term.high).contains(value)) {
            return false;
        }
        let value = |term: usize| {
            let place = self.terms[..term].iter().filter(|term| !term.linear).count();
            shape.get(place).copied()
        };
        let begins_first = self
            .window()
            .is_none_or(|(from, to)| value(from).zip(value(to)).is_none_or(|(from_s, to_s)| from_s < to_s));
        let ends_in_time = self.ramp().is_none_or(|(begin, width)| {
            let fastest_m_s = self.terms[begin].high;
            value(begin).zip(value(width)).is_none_or(|(begin, width)| begin + width <= fastest_m_s)
        });
        begins_first && ends_in_time
    }

    /// Where a term has to stay so that a window, which has these values, begins before it ends, and a ramp ends in time.
    pub fn within(&self, term: usize, values: &[f64]) -> (f64, f64) {
        const ANYWHERE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
        match (self.window(), self.ramp()) {
            // Each has its own side of the middle.
            (Some((from, to)), _) if term == from => (f64::NEG_INFINITY, 0.5 * (values[from] + values[to])),
            (Some((from, to)), _) if term == to => (0.5 * (values[from] + values[to]), f64::INFINITY),
            // What is left until the end is shared in halves.
            (_, Some((begin, width))) if term == begin || term == width => {
                let left = self.terms[begin].high - values[begin] - values[width];
                (f64::NEG_INFINITY, values[term] + 0.5 * left)
            }
            _ => ANYWHERE,
        }
    }

    pub fn shaped(mut self, shapes: Vec<Vec<f64>>) -> Self {
        self.shapes = shapes;
        self
    }

    /// Before the place where the force at the wheels is told: only what powers say tells of it. A sheet may state too much of a loss as
    /// well as too little, and no force that was measured has to pay for that.
    pub fn upstream(mut self) -> Self {
        /// The most that is stated too much of it, as a share.
        const STATED_TOO_MUCH: f64 = 0.2;
        self.balances = &[Kind::Battery, Kind::Fuel];
        for term in self.terms.iter_mut().filter(|term| term.name == "loss") {
            term.low = -STATED_TOO_MUCH;
        }
        self.upstream = true;
        self
    }

    pub fn in_run(mut self, run: usize) -> Self {
        self.run = Some(run);
        self
    }

    /// Whether a term can be all that there is of it.
    pub fn alone(&self, term: usize) -> bool {
        self.terms[term].name != START && !self.is_of_two()
    }

    /// Whether it is two causes of its own in one: tyres that warm up in any air, and a level that rises in the cold.
    pub fn is_of_two(&self) -> bool {
        let sizes = |name: &&str| self.terms.iter().any(|term| term.linear && term.name == *name);
        [WARMING, COLD].iter().all(sizes)
    }

    /// Whether one term of it does what the only term of another cause does, each in its own shape.
    pub fn does_the_same(&self, (term, shape): (usize, &[f64]), other: &Self, other_shape: &[f64]) -> bool {
        let name = self.terms[term].name;
        let only = || other.terms.iter().filter(|term| term.linear).map(|term| term.name).eq([name]);
        // How tyres warm up is nothing to the level.
        self.is_of_two()
            && other.id == self.id
            && only()
            && (name == COLD || shape.first() == other_shape.first())
    }

    /// Whether it is among those that the runs do not teach each other; one of them may still show it by itself.
    pub fn is_banned(&self, ids: &[&str]) -> bool {
        self.run.is_none() && ids.contains(&self.id)
    }

    /// The effect as it is in a run in which the cause does not work.
    pub fn idle(&self) -> String {
        let values: Vec<f64> = self.terms.iter().map(|term| f64::from(u8::from(!term.linear))).collect();
        self.written(&values)
    }

    pub fn over(mut self, form: Form) -> Self {
        self.form = form;
        self
    }

    /// With a value of its own in each run.
    pub fn by_run(mut self) -> Self {
        self.form = Form::OverTime;
        self.by_run = true;
        self
    }

    pub fn artefact(mut self) -> Self {
        self.class = Class::Artefact;
        self.form = Form::Measured;
        self
    }

    /// Its equation, in words of the catalogue or as it was found.
    pub fn equation_text(&self) -> String {
        if let Some(own) = &self.own {
            return own.equation.clone();
        }
        match &self.law {
            Some(LawText { role: RESISTANCE | FORCE, text, .. }) => format!("F = {text}"),
            Some(LawText { role: "loss_share", text, .. }) => format!("F = |F_drive| ({text})"),
            Some(LawText { role: "slip", text, .. }) => format!("s = {text}"),
            Some(LawText { text, .. }) => format!("P = {text}"),
            None => self.equation.to_owned(),
        }
    }

    /// Channels that it depends on.
    pub fn channels(&self) -> Vec<String> {
        let own = self.own.as_ref().map_or(self.depends_on, |own| &own.depends_on);
        let listed = self.law.as_ref().map_or(own, |law| &law.depends_on);
        listed.iter().map(|name| (*name).to_owned()).collect()
    }

    /// Whether it is a function of position or time.
    pub fn is_function(&self) -> bool {
        matches!(self.form, Form::OverPosition | Form::OverTime)
    }

    /// A function's cause with one value throughout: its identifier, and the parameter's name.
    pub fn even(&self) -> Option<(&'static str, &'static str)> {
        match (self.is_function(), self.id) {
            (false, _) => None,
            (true, "grade") => Some(("grade_constant", "grade")),
            (true, "soft_ground") => Some(("rolling_resistance", "coefficient")),
            (true, _) if self.by_run => Some((self.id, self.terms[0].name)),
            (true, "payload_change") => Some(("mass", "extra_mass_kg")),
            (true, "drawbar_load") => Some(("drawbar_load", "force_n")),
            (true, _) => Some(("auxiliary_power", "power_w")),
        }
    }

    /// The effect of a function that has one value throughout, as a scenario writes it, with its non-linear parameters.
    pub fn constant(&self, value: f64, shape: &[f64]) -> String {
        let Some((id, name)) = self.even() else { return String::new() };
        if let (true, [from_rad, ..]) = (self.blows_by_run(), shape) {
            // From the other end of its axis it blows no less.
            let from_rad = from_rad + if value < 0.0 { PI } else { 0.0 };
            return format!("wind(speed_m_s: {:?}, from_rad: {from_rad:?})", value.abs());
        }
        let held = self.terms.iter().filter(|term| !term.linear).zip(shape);
        let held = held.map(|(term, value)| format!("{}: {value:?}", term.name));
        let all: Vec<String> = std::iter::once(format!("{name}: {value:?}")).chain(held).collect();
        format!("{id}({})", all.join(", "))
    }

    /// Whether a value of a term is what it cannot be.
    pub fn impossible(&self, term: usize, value: f64) -> bool {
        !(self.terms[term].low..=self.terms[term].high).contains(&value)
    }

    /// The effect as a scenario writes it, with all parameters in the order of the terms.
    pub fn written(&self, values: &[f64]) -> String {
        let text = self.acting(values);
        match text.strip_suffix(')') {
            Some(open) if self.upstream => format!("{open}, upstream: true)"),
            _ => text,
        }
    }

    /// The same, wherever it acts.
    fn acting(&self, values: &[f64]) -> String {
        if let Some(own) = &self.own {
            return own.written(values[0]);
        }
        if let Some(law) = &self.law {
            let LawText { role, text, constants_text, .. } = law;
            // What resists counts backward.
            let times = if *role == FORCE { -values[0] } else { values[0] };
            return format!("expression({role}: \"{times:?} * ({text})\", constants: {constants_text})");
        }
        match self.id {
            "wind" => {
                let (north, east) = (values[0], values[1]);
                let from = east.atan2(north).rem_euclid(TAU);
                format!("wind(speed_m_s: {:?}, from_rad: {from:?})", north.hypot(east))
            }
            "cornering_drag" => {
                format!("cornering_drag(cornering_stiffness_n_per_rad: {:?})", 1.0 / values[0].max(1e-12))
            }
            "side_slope" => format!(
                "side_slope(cornering_stiffness_n_per_rad: {:?}, slip_coefficient: {:?})",
                1.0 / values[0].max(1e-12),
                values[1]
            ),
            "load_dependence" => format!(
                "load_dependence(coefficient: {:?}, exponent: {:?}, reference_mass_kg: {:?})",
                values[1],
                1.0 + values[0],
                values[2]
            ),
            "variator_loss" => {
                format!("variator_loss(loss: {:?}, node_speeds_m_s: {:?})", values[0], &values[1..])
            }
            "auxiliary_power" if self.window().is_some() => {
                format!("auxiliary_power(times_s: {:?}, powers_w: {:?})", &values[1..], &values[..1])
            }
            "shift_transient" => format!(
                "shift_transient(force_n: {:?}, width_m_s: {:?}, speeds_m_s: {:?})",
                values[0],
                values[1],
                &values[2..]
            ),
            _ => {
                let fields: Vec<String> = self
                    .terms
                    .iter()
                    .zip(values)
                    .map(|(term, value)| format!("{}: {value:?}", term.name))
                    .collect();
                format!("{}({})", self.id, fields.join(", "))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::spell;
    use super::*;

    #[test]
    fn a_window_begins_before_it_ends_and_a_ramp_ends_where_somebody_drove() {
        let term = |name, linear| Term { name, unit: "", scale: 1.0, linear, low: 0.0, high: f64::INFINITY };
        let mut window = spell("drawbar_load");
        window.terms = vec![term("force_n", true), term("from_s", false), term("to_s", false)];
        assert!(
            window.possible(&[2.0, 6.0]) && !window.possible(&[6.0, 2.0]) && !window.possible(&[2.0, 2.0])
        );
        let values = [300.0, 2.0, 6.0];
        assert_eq!(window.within(0, &values), (f64::NEG_INFINITY, f64::INFINITY));
        assert_eq!(window.within(1, &values).1, 4.0);
        assert_eq!(window.within(2, &values).0, 4.0);
        let mut ramp = spell("speed_threshold");
        let speed = |name| Term { high: 8.0, ..term(name, false) };
        ramp.terms = vec![term("force_n", true), speed("threshold_m_s"), term("width_m_s", false)];
        assert!(ramp.possible(&[2.0, 6.0]) && !ramp.possible(&[2.0, 6.5]) && !ramp.possible(&[9.0, 0.1]));
        assert_eq!(ramp.within(1, &[300.0, 2.0, 4.0]).1, 3.0);
        assert_eq!(ramp.within(2, &[300.0, 2.0, 4.0]).1, 5.0);
        window.terms.truncate(1);
        assert!(window.possible(&[]) && window.within(0, &[300.0]).0.is_infinite());
    }
}
