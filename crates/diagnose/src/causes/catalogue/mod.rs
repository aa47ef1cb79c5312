//! The causes that are tried: each names an effect of the simulator, says how its parameters are written, and how large
//! they usually are. Catalogue: the effects and artefacts that models of field vehicles commonly leave out.

mod cause;
mod law_text;
mod passes;
mod powers;
mod sensors;
mod term;

pub use cause::{Cause, Class, Form, RAMP};
pub use law_text::{CHANNELS, ELECTRIC, FORCE, LawText, MECHANICAL, RESISTANCE, is_lost_share};
pub use sensors::{ARTEFACTS, MOST_SCALE, MOST_SPEED_SCALE};
pub use term::Term;

use crate::balances::balance::Kind;
use cause::{LIMIT, cause};
use passes::passes;
use powers::powers;
use sensors::sensors;
use std::f64::consts::{PI, TAU};
use term::{linear, positive, shape};

/// What the vehicle and its runs are like, for scales and grids.
#[derive(Clone, Debug, Default)]
pub struct Around {
    /// Mass [kg].
    pub mass_kg: f64,
    /// Gravity [m/s²].
    pub gravity_m_s2: f64,
    /// Drag area [m²].
    pub drag_area_m2: f64,
    /// Speeds below which 20, 35, 50, 65 and 80 % of the samples lie [m/s].
    pub speeds_m_s: [f64; 5],
    /// Speeds below which 5 and 98 % of the samples lie [m/s].
    pub range_m_s: (f64, f64),
    /// The greatest speed [m/s].
    pub fastest_m_s: f64,
    /// Whether motor and wheels turn at one ratio: there is no variator then, and nothing to shift.
    pub one_ratio: bool,
    /// Longest run [s].
    pub duration_s: f64,
    /// How far from where places begin any run comes [m].
    pub reach_m: f64,
    /// Channels that every run has.
    pub channels: Vec<String>,
    /// Whether force or torque drives somewhere.
    pub drives: bool,
    /// Mass that nominally belongs to what rotates [kg].
    pub rotating_mass_kg: f64,
    /// Least and greatest mass of a run [kg].
    pub masses_kg: (f64, f64),
    /// Resistance over weight, as usual as any.
    pub coefficient: f64,
    /// Resistance of the ground over weight at walking speed.
    pub soil_coefficient: f64,
    /// Largest number of runs on one path.
    pub passes: usize,
    /// Range of the air temperature [K]; 0 where it is not known.
    pub temperatures_k: f64,
    /// Range of the oil's temperature [K]; 0 where it is not known throughout.
    pub oil_k: f64,
    /// Whether the force at the wheels is known anywhere, beyond what motion takes.
    pub pulls: bool,
    /// Runs that may have begun otherwise than the others, by number.
    pub beginnings: Vec<usize>,
    /// The lines along which runs went, one for each, clockwise from north [rad]; none where any of them turned.
    pub lanes_rad: Option<Vec<f64>>,
}

/// Shares of the greatest speed at which a drag may set in, beyond most of the samples.
const FAST: [f64; 3] = [0.65, 0.78, 0.9];
/// So far beyond them.
const BEYOND: f64 = 1.1;
/// Nobody measures in a stronger wind than a fresh gale, 8 on Beaufort's scale.
const MOST_WIND_M_S: f64 = 20.0;

/// A law of speed says nothing about its own level at a reference that is slower [m/s].
const SLOWEST_REFERENCE_M_S: f64 = 0.5;

/// What a hitch lets down or lifts in less is let down at once, and in more it is something else [s].
const SHORTEST_RAMP_S: f64 = 0.1;
const LONGEST_RAMP_S: f64 = 10.0;
const MOTION: &[Kind] = &[Kind::Motion, Kind::Battery, Kind::Fuel];
/// Where slip shows: force times the difference of speeds is taken from the engine, and alone it could be any loss in proportion to load.
const SLIPS: &[Kind] = &[Kind::Slip, Kind::Fuel];

/// A rolling resistance that depends otherwise on speed, with the stated level at a speed.
fn speed_law(around: &Around, reference_m_s: f64) -> Cause {
    let [reference_m_s, usual_m_s] =
        [reference_m_s, around.speeds_m_s[2]].map(|speed| speed.max(SLOWEST_REFERENCE_M_S));
    let linear = linear("linear", "1", 0.015 * reference_m_s / usual_m_s);
    cause(
        "rolling_speed_law",
        MOTION,
        vec![linear, shape("reference_speed_m_s", "m/s").held(reference_m_s)],
        "F = Δc (v/v₀ − 1) N",
        &["speed_m_s"],
        "rolling resistance that depends otherwise on speed",
        "tow or coast at 2, 5, 10 and 20 km/h",
    )
    .shaped(vec![vec![reference_m_s]])
}

/// The same with the square of speed, where forces tell of it: powers follow too much else that bends with speed. Drag of the air
/// is this as well, but for winds and for masses that differ, and is the commoner error.
fn square_law(around: &Around, reference_m_s: f64) -> Option<Cause> {
    let [reference_m_s, usual_m_s] =
        [reference_m_s, around.speeds_m_s[2]].map(|speed| speed.max(SLOWEST_REFERENCE_M_S));
    let quadratic = linear("quadratic", "1", 0.015 * (reference_m_s / usual_m_s).powi(2));
    let law = cause(
        "rolling_speed_law",
        MOTION,
        vec![quadratic, shape("reference_speed_m_s", "m/s").held(reference_m_s)],
        "F = Δc ((v/v₀)² − 1) N",
        &["speed_m_s"],
        "rolling resistance that depends otherwise on speed, by its square",
        "tow or coast at 2, 5, 10 and 20 km/h",
    );
    (around.pulls || !around.drives).then(|| law.shaped(vec![vec![reference_m_s]]))
}

/// A time constant; what takes several times as long as the longest run does not change within it, and no oil or tyre warms
/// up within seconds.
fn fading(around: &Around) -> Term {
    let (fastest_s, slowest_s) = fading_s(around);
    shape("time_constant_s", "s").within(fastest_s, slowest_s)
}

/// The fastest and the slowest time constant that can be told.
fn fading_s(around: &Around) -> (f64, f64) {
    const FASTEST_S: f64 = 15.0;
    const MOST_RUNS: f64 = 3.0;
    (FASTEST_S, FASTEST_S.max(MOST_RUNS * around.duration_s))
}

/// Begin and end of a spell that is the same in every run, in eighths of the longest.
fn windows(duration_s: f64) -> Vec<Vec<f64>> {
    let edge = |eighth: u8| duration_s * f64::from(eighth) / 8.0;
    (1..7).flat_map(|from| (from + 1..=8).map(move |to| vec![edge(from), edge(to)])).collect()
}

/// An implement that is let down and lifted at the same times of every run, at once or within a while.
fn let_down((pull, weight, duration_s): (Term, f64, f64), ramp: Option<Term>) -> Cause {
    /// What begins before this share of the longest run was there from the start, and no window.
    const EARLIEST: f64 = 0.05;
    let linear = linear("linear_n_s_m", "N s/m", 0.004 * weight);
    let from = shape("from_s", "s").within(EARLIEST * duration_s, f64::INFINITY);
    let terms = [pull, linear, from, shape("to_s", "s")];
    cause(
        "drawbar_load",
        MOTION,
        terms.into_iter().chain(ramp).collect(),
        "F = D₀ + D₁ v between two times",
        &["time_s", "speed_m_s"],
        "an implement that is down for a while",
        "repeat without it, or log the drawbar force",
    )
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
        LIMIT => (
            LIMIT,
            "a limit of the power that the drive gives back, beyond which brakes take over",
            "−F v ≤ P_r, brakes take the rest",
            "brake at several speeds, as hard as the drive alone can, and log the brake switch",
        ),
        _ => (
            "drawbar_load",
            "a pull at the hitch that was not recorded",
            "F = F_h while it pulls",
            "repeat without implement or trailer, or log the drawbar force",
        ),
    };
    let term = match id {
        LIMIT => positive("power_w", "W", 10_000.0),
        _ => positive("force_n", "N", 1000.0),
    };
    let terms = vec![term];
    cause(id, &[Kind::Motion], terms, equation, &["time_s"], words, experiment).over(Form::OverTime)
}

/// More drag area, or less: what is taken off a vehicle leaves at least half of it, and what seems to leave less is a wind.
fn drag_area(around: &Around) -> Term {
    const LEAST: f64 = 0.5;
    linear("extra_area_m2", "m²", 0.4 * around.drag_area_m2.max(0.5)).no_less(-LEAST * around.drag_area_m2)
}

/// A load that comes and goes: a loaded truck weighs three times what it weighs empty, and no vehicle gives away more of itself.
fn load(around: &Around) -> Term {
    const LEAST: f64 = 0.7;
    linear("mass_kg", "kg", 0.1 * around.mass_kg).no_less(-LEAST * around.mass_kg)
}

/// Oil that changes by less says nothing of how it thins [K].
const LEAST_OIL_K: f64 = 5.0;

/// Oil that drags by its recorded temperature: mineral oils fall to a third over 20 to 50 K.
fn by_oil(weight: f64) -> Cause {
    const SCALES_K: [f64; 4] = [12.0, 20.0, 33.0, 60.0];
    const REFERENCE_C: f64 = 20.0;
    cause(
        "driveline_temperature",
        MOTION,
        vec![
            positive("cold_force_n", "N", 0.006 * weight),
            positive("cold_viscous_n_s_m", "N s/m", 0.001 * weight),
            shape("temperature_scale_k", "K").within(5.0, 150.0),
            shape("reference_temperature_c", "°C").held(REFERENCE_C),
        ],
        "F = (F₀ + k v) e^((T₀ − T)/ΔT), T of the oil",
        &["oil_temperature_c", "speed_m_s"],
        "oil in the driveline that drags by its temperature",
        "repeat with the oil warm and the tyres cold",
    )
    .shaped(SCALES_K.map(|scale_k| vec![scale_k, REFERENCE_C]).into())
}

/// What may differ from run to run: the surface, what is hitched or mounted.
fn by_run(around: &Around, pull: Term) -> [Cause; 4] {
    let coefficient = linear("coefficient", "1", 0.015).no_less(-around.coefficient);
    let area = drag_area(around);
    let one = |id, term, equation, depends_on, words, experiment| {
        cause(id, MOTION, vec![term], equation, depends_on, words, experiment).by_run()
    };
    [
        one(
            "rolling_resistance",
            coefficient,
            "F = Δc N in each run",
            &[],
            "rolling resistance that differs from run to run",
            "log the surface and the tyres' pressure of each run, or repeat one run at once",
        ),
        one(
            "drawbar_load",
            pull,
            "F = F₀ in each run",
            &[],
            "a pull that differs from run to run",
            "log what is hitched in each run, or the drawbar force",
        ),
        one(
            "aerodynamic_drag",
            area,
            "F = ½ ρ ΔCdA v² in each run",
            &["speed_m_s"],
            "aerodynamic drag that differs from run to run",
            "log what is mounted in each run, or repeat one run at once",
        ),
        one(
            "mass",
            linear("extra_mass_kg", "kg", 0.08 * around.mass_kg)
                .within(-0.5 * around.mass_kg, around.mass_kg),
            "F = Δm (dv/dt + g (sin θ + c cos θ)) in each run",
            &["acceleration_m_s2"],
            "a mass that differs from run to run",
            "weigh the vehicle before each run",
        ),
    ]
}

/// A wind that blows otherwise in each run, to and fro along one axis. Runs that each went along a line show no more than what blows
/// along that, whatever the axis: it is one that lies across none of them. Else it is the one that the runs tell.
fn wind_by_run(around: &Around) -> Cause {
    /// Between so many axes a wind is never far from one of them, and turned to where it blows later.
    const AXES: u8 = 3;
    /// So many are thought of, where it does not matter.
    const THOUGHT_OF: u8 = 16;
    let axis = |place: u8, count: u8| PI * f64::from(place) / f64::from(count);
    let (from_rad, axes) = if let Some(lanes_rad) = &around.lanes_rad {
        let across = |axis_rad: f64| {
            lanes_rad.iter().map(|lane_rad| (axis_rad - lane_rad).cos().abs()).fold(1.0, f64::min)
        };
        let axes =
            lanes_rad.iter().copied().take(1).chain((0..THOUGHT_OF).map(|place| axis(place, THOUGHT_OF)));
        let best_rad = axes.max_by(|one, other| across(*one).total_cmp(&across(*other))).unwrap_or(0.0);
        (shape("from_rad", "rad").held(best_rad), vec![vec![best_rad]])
    } else {
        let axes = (0..AXES).map(|place| vec![axis(place, AXES)]).collect();
        (shape("from_rad", "rad").within(-PI, TAU), axes)
    };
    cause(
        "wind",
        MOTION,
        vec![linear("headwind_m_s", "m/s", 5.0).within(-MOST_WIND_M_S, MOST_WIND_M_S), from_rad],
        "F = ½ ρ CdA (|v − w| (v − w)ₓ − v²) in each run",
        &["speed_m_s", "heading_rad"],
        "a wind that differs from run to run",
        "log the wind of each run, or repeat two runs in each direction on a calm day",
    )
    .shaped(axes)
    .by_run()
}

/// What holds a vehicle on a side slope.
fn side_slope(weight_n: f64) -> Cause {
    /// Side force per slip angle, over the load: 3 for a soft tyre on soft soil, 6 for one of a tractor on firm ground, 15 for a
    /// car's. Softer by far is no tyre: what leans by its own turns would pass for a slope.
    const SOFT_PER_RAD: f64 = 3.0;
    cause(
        "side_slope",
        &[Kind::Motion, Kind::Slip, Kind::Battery, Kind::Fuel],
        vec![
            positive("compliance_rad_n", "rad/N", 1.0 / (SOFT_PER_RAD * weight_n)),
            positive("slip_coefficient", "1", 0.5),
        ],
        "F = S (S − 2 m v² κ) / C_α, S = m g sin φ; s = k F_drive tan² φ / N",
        &["roll_rad", "speed_m_s"],
        "a side slope that the tyres hold by slip angles",
        "drive the same lane on level ground, and along the slope both ways",
    )
}

/// So many of some speeds, in all ways to choose them.
fn chosen(speeds: &[f64], count: usize) -> Vec<Vec<f64>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    let first = |place: usize| {
        let others = chosen(&speeds[place + 1..], count - 1).into_iter();
        others.map(move |others| std::iter::once(speeds[place]).chain(others).collect())
    };
    (0..speeds.len()).flat_map(first).collect()
}

/// Mechanical points of a variator with as many ranges, and changes of range: so many are looked for on a grid, and so many at
/// most, one after the other.
const GRID_SPEEDS: usize = 2;
const MOST_SPEEDS: usize = 4;

/// Losses between so many mechanical points.
fn variator_loss(around: &Around, count: usize) -> Cause {
    let node = shape("node_speed_m_s", "m/s").within(0.0, around.fastest_m_s);
    let mut terms = vec![positive("loss", "1", 0.1)];
    terms.extend(std::iter::repeat_n(node, count));
    let of_grid = if count > GRID_SPEEDS { Vec::new() } else { chosen(&around.speeds_m_s, count) };
    let nodes = of_grid.into_iter();
    let nodes = nodes.map(|speeds| speeds.into_iter().map(|speed| speed.max(0.5)).collect());
    cause(
        "variator_loss",
        &[Kind::Motion, Kind::Fuel],
        terms,
        "F = −λ min |1 − v/v_n| |F_drive|",
        &["tractive_force_n", "speed_m_s"],
        "losses of the variator away from its mechanical points",
        "hold steady speeds across the range at one load",
    )
    .shaped(nodes.collect())
}

/// Losses at so many changes of range.
fn shift_transient(around: &Around, weight_n: f64, count: usize) -> Cause {
    /// A bell is so wide as a share of its speed: alone, and beside another.
    const WIDTHS: [&[f64]; 2] = [&[0.03, 0.08], &[0.06]];
    /// Bells are narrow, so they are looked for all over the range, at so many speeds.
    const PLACES: [u8; 2] = [16, 8];
    /// And no wider than this share of the greatest speed: what is, is no change of range but a law of speed.
    const WIDEST: f64 = 0.1;
    let width = shape("width_m_s", "m/s").within(0.0, WIDEST * around.range_m_s.1);
    let mut terms = vec![positive("force_n", "N", 0.03 * weight_n), width];
    let shift = shape("speed_m_s", "m/s").within(0.0, around.fastest_m_s);
    terms.extend(std::iter::repeat_n(shift, count));
    let alone = usize::from(count > 1);
    let (from, to) = around.range_m_s;
    let place = |one: u8| from + (to - from) * (f64::from(one) + 0.5) / f64::from(PLACES[alone]);
    let speeds: Vec<f64> = (0..PLACES[alone]).map(place).collect();
    let widths = if count > GRID_SPEEDS { &[] } else { WIDTHS[alone] };
    let bells = widths.iter().flat_map(|width| {
        chosen(&speeds, count).into_iter().map(move |speeds| {
            let width_m_s = width * speeds[0].max(1.0);
            std::iter::once(width_m_s).chain(speeds).collect()
        })
    });
    cause(
        "shift_transient",
        MOTION,
        terms,
        "F = F₀ Σ e^(−½((v − v_s)/b)²)",
        &["speed_m_s"],
        "losses while ranges are shifted",
        "ramp slowly up and down through the shift",
    )
    .shaped(bells.collect())
}

/// The causes that the recording could show at all.
#[allow(clippy::too_many_lines, reason = "a table")]
pub fn causes(around: &Around) -> Vec<Cause> {
    let weight = around.mass_kg * around.gravity_m_s2;
    let has = |name: &str| around.channels.iter().any(|channel| channel == name);
    // From a tenth of the longest run on, evenly in proportion.
    let (fastest_s, slowest_s) = fading_s(around);
    let first_s = fastest_s.max(0.1 * around.duration_s);
    let taus = (0..7).map(|step| first_s * 2f64.powi(step)).filter(|tau| *tau <= slowest_s);
    let taus: Vec<Vec<f64>> = taus.map(|tau| vec![tau]).collect();
    // An implement can pull as much as the ground can hold.
    let pull = positive("force_n", "N", 0.02 * weight).within(0.0, weight);
    let implement = (pull, weight, around.duration_s);
    let mut all = vec![
        cause(
            "wind",
            MOTION,
            vec![
                linear("north_m_s", "m/s", 5.0).within(-MOST_WIND_M_S, MOST_WIND_M_S),
                linear("east_m_s", "m/s", 5.0).within(-MOST_WIND_M_S, MOST_WIND_M_S),
            ],
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
            vec![linear("coefficient", "1", 0.02).no_less(-around.coefficient)],
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
            vec![load(around)],
            "F = Δm(t) (dv/dt + g (sin θ + c cos θ))",
            &["acceleration_m_s2", "time_s"],
            "a load that changes on the way",
            "weigh before and after, or log the tank's level",
        )
        .over(Form::OverTime),
        cause(
            "aerodynamic_drag",
            MOTION,
            vec![drag_area(around)],
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
        // The level is known at a speed that nobody states: as often as not at walking pace.
        speed_law(around, around.speeds_m_s[2]),
        speed_law(around, 0.0),
        cause(
            "rolling_temperature",
            MOTION,
            vec![positive("cold_coefficient", "1", 0.01), fading(around)],
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
                fading(around),
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
        let_down(implement, None).shaped(windows(around.duration_s)),
        // Looked for where the one that is let down at once was found.
        let_down(implement, Some(shape(RAMP, "s").within(SHORTEST_RAMP_S, LONGEST_RAMP_S)))
            .shaped(Vec::new()),
        cause(
            "speed_threshold",
            MOTION,
            vec![
                positive("force_n", "N", 0.015 * weight),
                shape("threshold_m_s", "m/s").within(0.0, around.fastest_m_s),
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
                // A vehicle that slows down is fast for a moment only, and what sets in there lies beyond those.
                .chain(
                    FAST.iter()
                        .map(|share| share * around.fastest_m_s)
                        .filter(|v| *v > BEYOND * around.speeds_m_s[4])
                        .map(|v| vec![v, 0.05 * around.fastest_m_s]),
                )
                .filter(|shape| shape.iter().sum::<f64>() <= around.fastest_m_s)
                .collect(),
        ),
    ];
    all.extend(by_run(around, pull));
    all.push(wind_by_run(around));
    all.extend([around.speeds_m_s[2], 0.0].into_iter().filter_map(|speed| square_law(around, speed)));
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
    if has("roll_rad") {
        all.push(side_slope(weight));
    }
    if has("vertical_acceleration_m_s2") {
        all.push(cause(
            "roughness",
            MOTION,
            vec![positive("time_constant_s", "s", 0.03)],
            "F = m τ ⟨a²⟩ / v",
            &["vertical_acceleration_m_s2", "speed_m_s"],
            "rough ground that shakes the vehicle",
            "drive a smooth lane of the same soil beside it, and the rough one at two speeds",
        ));
    }
    if around.masses_kg.1 > 1.02 * around.masses_kg.0 && around.soil_coefficient > 0.0 {
        all.push(
            cause(
                "load_dependence",
                MOTION,
                vec![
                    linear("exponent_change", "1", 0.2).within(-0.7, 1.5),
                    shape("coefficient", "1").held(around.soil_coefficient),
                    shape("reference_mass_kg", "kg").held(around.mass_kg),
                ],
                "F = c W ((W / W₀)^(β − 1) − 1)",
                &["payload_kg"],
                "rolling resistance that is not in proportion to the load",
                "repeat with two masses that differ by a quarter",
            )
            .shaped(vec![vec![around.soil_coefficient, around.mass_kg]]),
        );
    }
    all.extend(passes(around));
    if around.drives {
        let mut lost = vec![cause(
            "driveline_efficiency",
            &[Kind::Motion, Kind::Battery, Kind::Fuel],
            vec![positive("loss", "1", 0.08)],
            "F = −λ |F_drive|",
            &["tractive_force_n"],
            "a loss in the driveline in proportion to its load",
            "drive at the same speed with two loads",
        )];
        if !around.one_ratio {
            lost.extend((1..=MOST_SPEEDS).map(|count| variator_loss(around, count)));
            lost.extend((1..=MOST_SPEEDS).map(|count| shift_transient(around, weight, count)));
        }
        // A force that was measured at the wheels has most of them behind it already: what drives tells of them then.
        if has("tractive_force_n") {
            all.extend(lost.iter().cloned().map(Cause::upstream));
        }
        all.extend(lost);
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
        // Tyres that know the temperature outside warm up from it.
        all.push(
            cause(
                "rolling_temperature",
                MOTION,
                vec![
                    positive("cold_coefficient", "1", 0.01),
                    fading(around),
                    positive("coefficient_per_k", "1/K", 3e-4),
                    shape("reference_temperature_c", "°C").held(20.0),
                ],
                "F = (Δc e^(−t/τ) + k (T₀ − T)) N",
                &["time_s", "air_temperature_c"],
                "tyres that warm up, and rolling resistance that rises in the cold",
                "repeat on a warm day, and after a rest",
            )
            .shaped(taus.iter().map(|tau| vec![tau[0], 20.0]).collect()),
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
    if around.oil_k > LEAST_OIL_K {
        all.push(by_oil(weight));
    }
    powers(&mut all, around);
    sensors(&mut all, around);
    all
}

#[cfg(test)]
mod tests {
    use super::{Around, shift_transient};

    #[test]
    fn ranges_are_shifted_at_speeds_that_were_driven() {
        let driven = Around { range_m_s: (0.5, 5.0), fastest_m_s: 5.2, ..Around::default() };
        let shifts = shift_transient(&driven, 1e5, 2);
        assert!(shifts.possible(&[0.3, 2.0, 4.0]));
        assert!(!shifts.possible(&[0.3, 2.0, 6.6]));
    }
}
