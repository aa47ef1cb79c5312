//! The causes that are tried: each names an effect of the simulator, says how its parameters are written, and how large
//! they usually are. Catalogue: the effects and artefacts that models of field vehicles commonly leave out.

use crate::balance::Kind;
use crate::own::Own;

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

/// A parameter of a cause.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    /// As the effect names it.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// One standard deviation of what is usual.
    pub scale: f64,
    /// Whether the cause is proportional to it.
    pub linear: bool,
    /// Least that it can be.
    pub low: f64,
    /// Most that it can be.
    pub high: f64,
}

/// What the vehicle and its runs are like, for scales and grids.
#[derive(Clone, Debug)]
pub struct Around {
    /// Mass [kg].
    pub mass_kg: f64,
    /// Gravity [m/s²].
    pub gravity_m_s2: f64,
    /// Drag area [m²].
    pub drag_area_m2: f64,
    /// Speeds below which 20, 35, 50, 65 and 80 % of the samples lie [m/s].
    pub speeds_m_s: [f64; 5],
    /// Longest run [s].
    pub duration_s: f64,
    /// Channels that every run has.
    pub channels: Vec<String>,
    /// Whether force or torque drives somewhere.
    pub drives: bool,
    /// Mass that nominally belongs to what rotates [kg].
    pub rotating_mass_kg: f64,
    /// Least and greatest mass of a run [kg].
    pub masses_kg: (f64, f64),
    /// Resistance over weight at walking speed.
    pub coefficient: f64,
    /// Largest number of runs on one path.
    pub passes: usize,
    /// Range of the air temperature [K]; 0 where it is not known.
    pub temperatures_k: f64,
    /// Whether the force at the wheels is known anywhere, beyond what motion takes.
    pub pulls: bool,
    /// Runs that may have begun otherwise than the others, by number.
    pub beginnings: Vec<usize>,
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
    /// The one run in which it works; none where it works in all of them.
    pub run: Option<usize>,
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
    /// What the choice of it costs.
    pub cost: f64,
}

impl LawText {
    /// The text of a law of a balance.
    pub fn new(law: &headland_symbolic::Law, kind: Kind) -> Self {
        /// Every piece of it was one of about a dozen: ln of that.
        const PER_PIECE: f64 = 2.5;
        const CHANNELS: [(&str, &str); 7] = [
            ("v", "speed_m_s"),
            ("x", "position_m"),
            ("t", "time_s"),
            ("heading", "heading_rad"),
            ("kappa", "curvature_per_m"),
            ("temperature", "air_temperature_c"),
            ("coasting", "coasting"),
        ];
        Self {
            role: if kind == Kind::Motion { "resistance" } else { "auxiliary_power" },
            text: law.text.clone(),
            constants_text: law.constants_text(),
            constants: law.constants.clone(),
            depends_on: CHANNELS
                .into_iter()
                .filter(|(name, _)| law.names(name))
                .map(|(_, channel)| channel)
                .collect(),
            cost: PER_PIECE * law.complexity as f64,
        }
    }
}

const MOTION: &[Kind] = &[Kind::Motion, Kind::Battery, Kind::Fuel];

/// An effect so many times its usual size is none of this kind.
const MOST_SIZES: f64 = 8.0;

fn linear(name: &'static str, unit: &'static str, scale: f64) -> Term {
    Term { name, unit, scale, linear: true, low: -MOST_SIZES * scale, high: MOST_SIZES * scale }
}

fn positive(name: &'static str, unit: &'static str, scale: f64) -> Term {
    Term { low: 0.0, ..linear(name, unit, scale) }
}

fn shape(name: &'static str, unit: &'static str) -> Term {
    Term { name, unit, scale: 1.0, linear: false, low: 0.0, high: f64::INFINITY }
}

impl Term {
    /// The factor of a law that has its amplitudes in it.
    pub fn amplitude() -> Self {
        linear("amplitude", "1", 1.0)
    }

    /// The factor of a formula that the author of a scenario wrote.
    pub fn amount() -> Self {
        linear("amount", "1", 1.0)
    }

    /// A parameter that a cause is in proportion to, of a usual size, where its effect lets it be.
    pub fn of_size(name: &'static str, unit: &'static str, scale: f64, low: f64, high: f64) -> Self {
        let term = linear(name, unit, scale);
        let (low, high) = (term.low.max(low), term.high.min(high));
        term.within(low, high)
    }

    /// Held where it is.
    fn held(self, value: f64) -> Self {
        self.within(value, value)
    }

    /// With other limits.
    fn within(self, low: f64, high: f64) -> Self {
        Self { low, high, ..self }
    }
}

fn cause(
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
        run: None,
    }
}

impl Cause {
    /// Places of the begin and of the end of a window among the terms, where it has one.
    pub fn window(&self) -> Option<(usize, usize)> {
        let place = |name: &str| self.terms.iter().position(|term| term.name == name);
        Some((place("from_s")?, place("to_s")?))
    }

    /// Whether a shape can be: what lasts has to begin before it ends.
    pub fn possible(&self, shape: &[f64]) -> bool {
        let Some((from, to)) = self.window() else { return true };
        let place = |term: usize| self.terms[..term].iter().filter(|term| !term.linear).count();
        match (shape.get(place(from)), shape.get(place(to))) {
            (Some(from), Some(to)) => from < to,
            _ => true,
        }
    }

    /// Where a term has to stay so that a window, which has these values, begins before it ends.
    pub fn within(&self, term: usize, values: &[f64]) -> (f64, f64) {
        let Some((from, to)) = self.window() else { return (f64::NEG_INFINITY, f64::INFINITY) };
        // Each has its own side of the middle.
        let middle = 0.5 * (values[from] + values[to]);
        match term {
            term if term == from => (f64::NEG_INFINITY, middle),
            term if term == to => (middle, f64::INFINITY),
            _ => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    fn shaped(mut self, shapes: Vec<Vec<f64>>) -> Self {
        self.shapes = shapes;
        self
    }

    fn in_run(mut self, run: usize) -> Self {
        self.run = Some(run);
        self
    }

    /// The effect as it is in a run in which the cause does not work.
    pub fn idle(&self) -> String {
        let values: Vec<f64> = self.terms.iter().map(|term| f64::from(u8::from(!term.linear))).collect();
        self.written(&values)
    }

    fn over(mut self, form: Form) -> Self {
        self.form = form;
        self
    }

    fn artefact(mut self) -> Self {
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
            Some(LawText { role: "resistance", text, .. }) => format!("F = {text}"),
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
            (true, "payload_change") => Some(("mass", "extra_mass_kg")),
            (true, _) => Some(("auxiliary_power", "power_w")),
        }
    }

    /// The effect of a function that has one value throughout, as a scenario writes it.
    pub fn constant(&self, value: f64) -> String {
        self.even().map_or_else(String::new, |(id, name)| format!("{id}({name}: {value:?})"))
    }

    /// Whether a value of a term is what it cannot be.
    pub fn impossible(&self, term: usize, value: f64) -> bool {
        !(self.terms[term].low..=self.terms[term].high).contains(&value)
    }

    /// The effect as a scenario writes it, with all parameters in the order of the terms.
    pub fn written(&self, values: &[f64]) -> String {
        if let Some(own) = &self.own {
            return own.written(values[0]);
        }
        if let Some(law) = &self.law {
            let LawText { role, text, constants_text, .. } = law;
            return format!(
                "expression({role}: \"{:?} * ({text})\", constants: {constants_text})",
                values[0]
            );
        }
        match self.id {
            "wind" => {
                let (north, east) = (values[0], values[1]);
                let from = east.atan2(north).rem_euclid(std::f64::consts::TAU);
                format!("wind(speed_m_s: {:?}, from_rad: {from:?})", north.hypot(east))
            }
            "cornering_drag" => {
                format!("cornering_drag(cornering_stiffness_n_per_rad: {:?})", 1.0 / values[0].max(1e-12))
            }
            "load_dependence" => format!(
                "load_dependence(coefficient: {:?}, exponent: {:?}, reference_mass_kg: {:?})",
                values[1],
                1.0 + values[0],
                values[2]
            ),
            "variator_loss" => {
                format!("variator_loss(loss: {:?}, node_speeds_m_s: [{:?}])", values[0], values[1])
            }
            "shift_transient" => format!(
                "shift_transient(force_n: {:?}, speeds_m_s: [{:?}], width_m_s: {:?})",
                values[0], values[1], values[2]
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

/// Begin and end of a spell that is the same in every run, in eighths of the longest.
fn windows(duration_s: f64) -> Vec<Vec<f64>> {
    let edge = |eighth: u8| duration_s * f64::from(eighth) / 8.0;
    (1..7).flat_map(|from| (from + 1..=8).map(move |to| vec![edge(from), edge(to)])).collect()
}

/// A cause that works in spells of single runs.
pub fn spell(id: &str) -> Cause {
    let (id, words, equation, experiment) = match id {
        "braking" => (
            "braking",
            "service brakes that were not recorded",
            "F = F_b while braking",
            "log the brake switch",
        ),
        _ => (
            "drawbar_load",
            "a pull at the hitch that was not recorded",
            "F = F_h while it pulls",
            "repeat without implement or trailer, or log the drawbar force",
        ),
    };
    let terms = vec![positive("force_n", "N", 1000.0)];
    cause(id, &[Kind::Motion], terms, equation, &["time_s"], words, experiment).over(Form::OverTime)
}

/// The causes that the recording could show at all.
#[allow(clippy::too_many_lines, reason = "a table")]
pub fn causes(around: &Around) -> Vec<Cause> {
    let weight = around.mass_kg * around.gravity_m_s2;
    let has = |name: &str| around.channels.iter().any(|channel| channel == name);
    // From a tenth of the longest run to six of it, evenly in proportion.
    let taus: Vec<Vec<f64>> = (0..7).map(|step| vec![0.1 * around.duration_s * 2f64.powi(step)]).collect();
    // An implement can pull as much as the ground can hold.
    let pull = positive("force_n", "N", 0.02 * weight).within(0.0, weight);
    let mut all = vec![
        cause(
            "wind",
            MOTION,
            vec![linear("north_m_s", "m/s", 5.0), linear("east_m_s", "m/s", 5.0)],
            "F = ½ ρ CdA (|v − w| (v − w)ₓ − v²)",
            &["speed_m_s", "heading_rad"],
            "a wind",
            "repeat two runs in each direction on a calm day",
        ),
        cause(
            "grade_constant",
            &[Kind::Motion, Kind::Battery, Kind::Fuel, Kind::Parity],
            vec![linear("grade", "1", 0.02)],
            "F = m g sin(atan q)",
            &["position_m"],
            "a slope of the whole path",
            "drive the same lane in the other direction",
        ),
        cause(
            "grade",
            &[Kind::Motion, Kind::Battery, Kind::Fuel, Kind::Parity],
            vec![linear("grade", "1", 0.02)],
            "F = m g sin(atan q(x))",
            &["position_m"],
            "slopes along the path",
            "drive the same path in the other direction, or log elevation",
        )
        .over(Form::OverPosition),
        cause(
            "soft_ground",
            MOTION,
            vec![linear("coefficient", "1", 0.02).within(-around.coefficient, MOST_SIZES * 0.02)],
            "F = Δc(x) N",
            &["position_m"],
            "softer ground along the path",
            "drive the same path in the other direction, or measure the cone index along it",
        )
        .over(Form::OverPosition),
        cause(
            "rotating_inertia",
            MOTION,
            vec![
                linear("rotating_mass_kg", "kg", 0.06 * around.mass_kg)
                    .within(-around.rotating_mass_kg, 0.4 * around.mass_kg),
            ],
            "F = m_rot dv/dt",
            &["acceleration_m_s2"],
            "the inertia of rotating parts",
            "accelerate at two different forces, or spin the wheels down on stands",
        ),
        cause(
            "mass",
            MOTION,
            vec![
                linear("extra_mass_kg", "kg", 0.08 * around.mass_kg)
                    .within(-0.5 * around.mass_kg, around.mass_kg),
            ],
            "F = Δm (dv/dt + g (sin θ + c cos θ))",
            &["acceleration_m_s2"],
            "a different mass",
            "weigh the vehicle, or repeat runs with known ballast",
        ),
        cause(
            "payload_change",
            MOTION,
            vec![linear("mass_kg", "kg", 0.1 * around.mass_kg)],
            "F = Δm(t) (dv/dt + g (sin θ + c cos θ))",
            &["acceleration_m_s2", "time_s"],
            "a load that changes on the way",
            "weigh before and after, or log the tank's level",
        )
        .over(Form::OverTime),
        cause(
            "aerodynamic_drag",
            MOTION,
            vec![linear("extra_area_m2", "m²", 0.4 * around.drag_area_m2.max(0.5))],
            "F = ½ ρ ΔCdA v²",
            &["speed_m_s"],
            "more aerodynamic drag",
            "coast down from twice the speed",
        ),
        cause(
            "rolling_resistance",
            MOTION,
            vec![linear("coefficient", "1", 0.015)],
            "F = Δc N",
            &[],
            "a different level of rolling resistance",
            "drive both directions, coasting and driven, with two masses",
        ),
        cause(
            "rolling_speed_law",
            MOTION,
            vec![
                linear("linear", "1", 0.015),
                shape("reference_speed_m_s", "m/s").held(around.speeds_m_s[2].max(0.5)),
            ],
            "F = Δc (v/v₀ − 1) N",
            &["speed_m_s"],
            "rolling resistance that depends otherwise on speed",
            "tow or coast at 2, 5, 10 and 20 km/h",
        )
        .shaped(vec![vec![around.speeds_m_s[2].max(0.5)]]),
        cause(
            "rolling_temperature",
            MOTION,
            vec![positive("cold_coefficient", "1", 0.01), shape("time_constant_s", "s")],
            "F = Δc e^(−t/τ) N",
            &["time_s"],
            "tyres that warm up",
            "repeat after a rest, and again without",
        )
        .shaped(taus.clone()),
        cause(
            "driveline_temperature",
            MOTION,
            vec![
                linear("cold_force_n", "N", 0.006 * weight),
                positive("cold_viscous_n_s_m", "N s/m", 0.001 * weight),
                shape("time_constant_s", "s"),
            ],
            "F = (F₀ + k v) e^(−t/τ)",
            &["time_s", "speed_m_s"],
            "oil in the driveline that warms up",
            "log the oil temperature; repeat with the oil warm and the tyres cold",
        )
        .shaped(taus.clone()),
        cause(
            "neutral_drag",
            MOTION,
            vec![linear("force_n", "N", 0.006 * weight), linear("viscous_n_s_m", "N s/m", 0.0015 * weight)],
            "F = F₀ + k v in neutral",
            &["coasting", "speed_m_s"],
            "drag of the driveline in neutral",
            "coast and drive steadily at the same speed, or spin the driveline down on stands",
        ),
        cause(
            "brake_drag",
            MOTION,
            vec![positive("force_n", "N", 0.008 * weight)],
            "F = F₀",
            &[],
            "a dragging brake",
            "feel the hubs, or turn a free wheel by hand",
        ),
        cause(
            "drawbar_load",
            MOTION,
            vec![pull],
            "F = F₀",
            &[],
            "an implement or trailer that was not recorded",
            "repeat without it, or log the drawbar force",
        ),
        cause(
            "drawbar_load",
            MOTION,
            vec![
                pull,
                linear("linear_n_s_m", "N s/m", 0.004 * weight),
                shape("from_s", "s"),
                shape("to_s", "s"),
            ],
            "F = D₀ + D₁ v between two times",
            &["time_s", "speed_m_s"],
            "an implement that is down for a while",
            "repeat without it, or log the drawbar force",
        )
        .shaped(windows(around.duration_s)),
        cause(
            "speed_threshold",
            MOTION,
            vec![
                positive("force_n", "N", 0.015 * weight),
                shape("threshold_m_s", "m/s"),
                shape("width_m_s", "m/s"),
            ],
            "F = F₀ clamp((v − v₀)/b, 0, 1)",
            &["speed_m_s"],
            "a drag that sets in above a speed",
            "hold speeds just below and just above",
        )
        .shaped(
            around
                .speeds_m_s
                .iter()
                .flat_map(|v| [vec![*v, 0.1 * v.max(0.5)], vec![*v, 0.5 * v.max(0.5)]])
                .collect(),
        ),
    ];
    if has("curvature_per_m") {
        all.push(cause(
            "cornering_drag",
            MOTION,
            vec![positive("compliance_rad_n", "rad/N", 2.0 / weight)],
            "F = (m v² κ)² / C_α",
            &["speed_m_s", "curvature_per_m"],
            "drag of the tyres in curves",
            "drive circles of two radii, both ways",
        ));
    }
    if around.masses_kg.1 > 1.02 * around.masses_kg.0 {
        all.push(
            cause(
                "load_dependence",
                MOTION,
                vec![
                    linear("exponent_change", "1", 0.2).within(-0.7, 0.7),
                    shape("coefficient", "1").held(around.coefficient),
                    shape("reference_mass_kg", "kg").held(around.mass_kg),
                ],
                "F = c W ((W / W₀)^(β − 1) − 1)",
                &["payload_kg"],
                "rolling resistance that is not in proportion to the load",
                "repeat with two masses that differ by a quarter",
            )
            .shaped(vec![vec![around.coefficient, around.mass_kg]]),
        );
    }
    if around.passes > 2 {
        all.push(
            cause(
                "multipass",
                MOTION,
                vec![linear("coefficient", "1", 0.03), shape("factor", "1")],
                "F = c (fⁿ⁻¹ − 1) N",
                &["position_m"],
                "ground that firms with every pass",
                "drive a fresh lane beside the old one",
            )
            .shaped(vec![vec![0.9], vec![0.7]]),
        );
    }
    if around.drives {
        all.push(cause(
            "driveline_efficiency",
            &[Kind::Motion, Kind::Battery, Kind::Fuel],
            vec![positive("loss", "1", 0.08)],
            "F = −λ |F_drive|",
            &["tractive_force_n"],
            "a loss in the driveline in proportion to its load",
            "drive at the same speed with two loads",
        ));
        all.push(
            cause(
                "variator_loss",
                &[Kind::Motion, Kind::Fuel],
                vec![positive("loss", "1", 0.1), shape("node_speed_m_s", "m/s")],
                "F = −λ |1 − v/v_n| |F_drive|",
                &["tractive_force_n", "speed_m_s"],
                "losses of the variator away from its mechanical points",
                "hold steady speeds across the range at one load",
            )
            .shaped(around.speeds_m_s[1..4].iter().map(|v| vec![v.max(0.5)]).collect()),
        );
        all.push(
            cause(
                "shift_transient",
                &[Kind::Motion],
                vec![
                    positive("force_n", "N", 0.03 * weight),
                    shape("speed_m_s", "m/s"),
                    shape("width_m_s", "m/s"),
                ],
                "F = F₀ e^(−½((v − v_s)/b)²)",
                &["speed_m_s"],
                "losses while ranges are shifted",
                "ramp slowly up and down through the shift",
            )
            .shaped(around.speeds_m_s.iter().map(|v| vec![*v, 0.05 * v.max(1.0)]).collect()),
        );
    }
    if around.temperatures_k > 3.0 {
        all.push(
            cause(
                "rolling_temperature",
                MOTION,
                vec![
                    shape("cold_coefficient", "1").held(0.0),
                    shape("time_constant_s", "s").held(600.0),
                    linear("coefficient_per_k", "1/K", 3e-4),
                    shape("reference_temperature_c", "°C").held(20.0),
                ],
                "F = k (T₀ − T) N",
                &["air_temperature_c"],
                "rolling resistance that rises in the cold",
                "repeat on a warm day",
            )
            .shaped(vec![vec![0.0, 600.0, 20.0]]),
        );
        all.push(
            cause(
                "auxiliary_power",
                &[Kind::Battery, Kind::Fuel],
                vec![positive("freezing_power_w", "W", 1500.0), shape("balance_temperature_c", "°C")],
                "P = P₀ max(0, 1 − T/T₀)",
                &["air_temperature_c"],
                "a heater that works by the temperature outside",
                "repeat with the heater off",
            )
            .shaped(vec![vec![15.0], vec![20.0]]),
        );
    }
    powers(&mut all, around);
    sensors(&mut all, around);
    all
}

fn powers(all: &mut Vec<Cause>, around: &Around) {
    all.push(cause(
        "auxiliary_power",
        &[Kind::Battery, Kind::Fuel],
        vec![positive("power_w", "W", 1000.0)],
        "P = P₀",
        &[],
        "a consumer that is always on",
        "stand with the drive on, and switch consumers one by one",
    ));
    all.push(
        cause(
            "auxiliary_power",
            &[Kind::Battery, Kind::Fuel],
            vec![positive("power_w", "W", 1500.0).within(0.0, f64::INFINITY)],
            "P = P(t)",
            &["time_s"],
            "a consumer that is switched with time",
            "log the current of heater, fan and hydraulics",
        )
        .over(Form::OverTime),
    );
    all.push(cause(
        "battery_resistance",
        &[Kind::Voltage],
        vec![linear("resistance_ohm", "ohm", 0.1)],
        "P = ΔR I², U = U₀ − (R + ΔR) I",
        &["battery_current_a"],
        "a different resistance of the battery",
        "draw a step of current at rest and log the voltage",
    ));
    all.push(cause(
        "engine_friction",
        &[Kind::Fuel],
        vec![linear("torque_n_m", "N m", 30.0)],
        "P = T ω / e",
        &["engine_speed_rad_s"],
        "more friction of the engine",
        "motor the engine, or idle at two speeds",
    ));
    // An engine that was driven just before starts warm, so that often one run alone starts cold.
    let once = around.beginnings.iter().map(|run| Some(*run));
    for run in std::iter::once(None).chain(once) {
        let cold = cause(
            "cold_start",
            &[Kind::Fuel],
            vec![positive("cold_torque_n_m", "N m", 30.0), shape("time_constant_s", "s")],
            "P = T e^(−t/τ) ω / e",
            &["time_s", "engine_speed_rad_s"],
            if run.is_some() {
                "an engine that starts cold in one of the runs"
            } else {
                "an engine that starts cold"
            },
            "repeat the cycle with the engine warm",
        )
        .shaped([60.0, 150.0, 400.0, 900.0].iter().map(|tau| vec![*tau]).collect());
        all.push(match run {
            Some(run) => cold.in_run(run),
            None => cold,
        });
    }
}

fn sensors(all: &mut Vec<Cause>, around: &Around) {
    let artefact = |id, balances, term: Term, equation, words, experiment| {
        cause(id, balances, vec![term], equation, &[], words, experiment).artefact()
    };
    if around.drives {
        all.push(
            artefact(
                "latency",
                &[Kind::Motion],
                linear("latency_s", "s", 0.1).within(-1.5, 3.0),
                "y(t) = x(t − δ)",
                "speed that arrives late",
                "brake once hard with an accelerometer beside it",
            )
            // A late signal is not linear in its latency, so it is tried at several.
            .shaped(vec![vec![0.05], vec![0.2], vec![0.6], vec![-0.2]]),
        );
        all.push(artefact(
            "force_scale",
            &[Kind::Motion, Kind::Battery],
            linear("scale", "1", 0.05),
            "F_measured = (1 + k) F",
            "a force sensor with a wrong scale",
            "hang a known weight on it, or tow with a load cell",
        ));
    }
    all.push(artefact(
        "speed_scale",
        &[Kind::Motion, Kind::Slip, Kind::Battery],
        linear("scale", "1", 0.03),
        "v_measured = (1 + k) v",
        "a speed sensor with a wrong scale",
        "drive a measured mile",
    ));
    all.push(artefact(
        "accelerometer_bias",
        &[Kind::Parity],
        linear("bias_m_s2", "m/s²", 0.15),
        "f_measured = f + b",
        "an accelerometer with an offset",
        "stand level, and turn around on the spot",
    ));
    all.push(artefact(
        "accelerometer_tilt",
        &[Kind::Parity],
        linear("tilt_rad", "rad", 0.015),
        "f_measured = f + g sin ε",
        "an accelerometer that is mounted at a tilt",
        "stand level, and turn around on the spot",
    ));
    all.push(cause(
        "wheel_slip",
        &[Kind::Slip],
        // Where an implement may pull and nobody knows how much, the motion tells of a part of the force only.
        vec![positive("coefficient", "1", if around.pulls { 0.15 } else { 0.4 })],
        "s = k F / N",
        &["tractive_force_n"],
        "slip of the driven wheels",
        "pull two loads at one speed",
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_begins_before_it_ends() {
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
        window.terms.truncate(1);
        assert!(window.possible(&[]) && window.within(0, &[300.0]).0.is_infinite());
    }
}
