//! An equation that was found, as a scenario writes it.

use super::{Cause, Class, Form, MOTION, SLIPS, Term};
use crate::balances::balance::Kind;
use headland_symbolic::Target;

/// Where a vehicle is, and what it came since its run began is read from that as well.
const PLACE: &str = "position_m";
const WAY: &str = "way";

/// Channels that the variables of a formula are read from.
pub const CHANNELS: [(&str, &str); 21] = [
    ("v", "speed_m_s"),
    ("acceleration", "acceleration_m_s2"),
    ("F_drive", "tractive_force_n"),
    ("engine_speed", "engine_speed_rad_s"),
    ("x", PLACE),
    (WAY, PLACE),
    ("t", "time_s"),
    ("heading", "heading_rad"),
    ("kappa", "curvature_per_m"),
    ("temperature", "air_temperature_c"),
    ("oil_temperature", "oil_temperature_c"),
    ("state_of_charge", "state_of_charge"),
    ("tyre_pressure", "tyre_pressure_pa"),
    ("coasting", "coasting"),
    ("slope", "grade"),
    ("roll", "roll_rad"),
    ("pto_power", "pto_power_w"),
    ("hydraulic_power", "hydraulic_power_w"),
    ("m", "payload_kg"),
    ("headwind", "wind_speed_m_s"),
    ("crosswind", "wind_speed_m_s"),
];

/// What a law of a force is in the effect `expression`, and one of how wheels slip.
pub const RESISTANCE: &str = "resistance";
/// A force that may push as well: what only resists never moves a vehicle.
pub const FORCE: &str = "force";
const SLIP: &str = "slip";
/// Power that an electric consumer takes, which an engine pays for through its alternator,
pub const ELECTRIC: &str = "auxiliary_power";
/// and what is taken off its shaft.
pub const MECHANICAL: &str = "shaft_power";

/// Whether a law is a share of the drive's force that is lost on its way; a slip is a share of the speed.
pub fn is_lost_share(target: Target, kind: Kind) -> bool {
    target == Target::Share && kind != Kind::Slip
}

/// An equation that was found, as scenarios write it.
#[derive(Clone, Debug)]
pub struct LawText {
    /// What it is in the effect `expression`.
    pub role: &'static str,
    /// The formula.
    pub text: String,
    /// Its constants, as the effect takes them.
    pub constants_text: String,
    /// Its constants.
    pub constants: Vec<headland_symbolic::Constant>,
    /// Channels that it depends on.
    pub depends_on: Vec<&'static str>,
    /// Terms that are added.
    pub terms: usize,
    /// What the choice of it costs.
    pub cost: f64,
}

impl LawText {
    /// Whether it is a law of places alone, as a map is: the way since a run began is none.
    pub fn is_of_places(&self) -> bool {
        self.depends_on == [PLACE] && !self.names_the_way()
    }

    /// Whether it hangs on how far a run came, and on nothing else.
    pub fn is_of_the_way(&self) -> bool {
        self.depends_on == [PLACE] && self.names_the_way()
    }

    fn names_the_way(&self) -> bool {
        let word = |letter: char| letter.is_alphanumeric() || letter == '_';
        self.text.split(|letter| !word(letter)).any(|name| name == WAY)
    }

    /// Whether it follows what it names later than half of a run that lasts so long [s]: what grows and never settles is a course of
    /// time, whatever it names.
    pub fn never_settles(&self, lasts_s: f64) -> bool {
        const HALF: f64 = 0.5;
        self.constants.iter().any(|one| one.name.starts_with("lag") && one.value > HALF * lasts_s)
    }

    /// Whether a vehicle that is a little elsewhere, or a little slower, may be led somewhere else altogether.
    pub fn leads_elsewhere(&self) -> bool {
        self.text.contains("latched(") || self.depends_on.contains(&PLACE)
    }

    /// The text of a law of a balance, which is a force or takes power in a role. A share of the drive that is lost before its force was
    /// measured takes power alone.
    pub fn new(law: &headland_symbolic::Law, (target, kind): (Target, Kind), role: &'static str) -> Self {
        /// Every piece of it was one of about a dozen: ln of that.
        const PER_PIECE: f64 = 2.5;
        let lost = is_lost_share(target, kind);
        let named = |(name, _): &(&'static str, &'static str)| law.names(name) || lost && *name == "F_drive";
        let mut depends_on: Vec<_> = CHANNELS.into_iter().filter(named).map(|(_, channel)| channel).collect();
        depends_on.dedup();
        Self {
            role: match target {
                Target::Share if kind == Kind::Slip => SLIP,
                Target::Share if kind == Kind::Motion => "loss_share",
                Target::Force | Target::Share | Target::Power => role,
            },
            text: match target {
                Target::Share if lost && kind != Kind::Motion => format!("abs(F_drive * v) * ({})", law.text),
                _ => law.text.clone(),
            },
            constants_text: law.constants_text(),
            constants: law.constants.clone(),
            depends_on,
            terms: law.terms,
            cost: PER_PIECE * law.complexity as f64,
        }
    }

    /// One number, in a role.
    pub(crate) fn constant(role: &'static str, name: &str) -> Self {
        Self {
            role,
            text: name.to_owned(),
            constants_text: format!("{{\"{name}\": 1.0}}"),
            constants: Vec::new(),
            depends_on: Vec::new(),
            terms: 1,
            cost: 0.0,
        }
    }
}

impl Cause {
    /// A consumer in a role that is always on, whether or not any is among the causes that are tried.
    pub fn consumer(role: &'static str) -> Self {
        Self::of_law(LawText::constant(role, "power_w"), Kind::Fuel)
    }

    /// A force against the motion that is always there.
    pub fn pull() -> Self {
        Self::of_law(LawText::constant(RESISTANCE, "force_n"), Kind::Motion)
    }

    /// Wheels that slip by a share of their speed, whatever the force.
    pub fn slip() -> Self {
        Self::of_law(LawText::constant(SLIP, "slip"), Kind::Slip)
    }

    /// A cause that is a law.
    pub fn of_law(law: LawText, kind: Kind) -> Self {
        let balances: &'static [Kind] = match kind {
            // What resists shows in the powers that it takes; a share that is lost, in what is left of the force.
            Kind::Motion if [RESISTANCE, FORCE].contains(&law.role) => MOTION,
            Kind::Motion => &[Kind::Motion],
            Kind::Slip => SLIPS,
            Kind::Shaft | Kind::Fuel => &[Kind::Fuel],
            _ => &[Kind::Battery],
        };
        Self {
            id: "unlisted",
            class: Class::Unlisted,
            balances,
            form: Form::Law,
            terms: vec![Term::amplitude()],
            shapes: vec![Vec::new()],
            equation: "",
            depends_on: &[],
            words: "a cause that nobody listed",
            experiment: "repeat the runs at other speeds, places and times than these, and see whether the equation holds",
            law: Some(law),
            own: None,
            by_run: false,
            upstream: false,
            run: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A law counts what resists; a force of the effect counts forward.
    #[test]
    fn a_law_that_pushes_is_written_as_a_force_the_other_way() {
        let written = |role| Cause::of_law(LawText::constant(role, "a_n"), Kind::Motion).written(&[2.0]);
        assert!(written(RESISTANCE).starts_with("expression(resistance: \"2.0 * (a_n)\""));
        assert!(written(FORCE).starts_with("expression(force: \"-2.0 * (a_n)\""));
    }

    /// A tank that fills over a run of 520 s was told as what follows the square of the speed by a lag of 520 s.
    #[test]
    fn what_lags_by_most_of_a_run_never_settles() {
        let lag = |name: &str, value: f64| {
            let one =
                headland_symbolic::Constant { name: name.to_owned(), value, sd: None, unit: "s".to_owned() };
            LawText { constants: vec![one], ..LawText::constant(RESISTANCE, "a_n") }.never_settles(520.0)
        };
        assert!(lag("lag1_s", 500.0) && !lag("lag1_s", 200.0) && !lag("t1_s", 500.0));
    }
}
