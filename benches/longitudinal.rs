//! Steps per second of the longitudinal simulation against a loop of the same arithmetic written by hand.
//!
//! `cargo bench --bench longitudinal`. Both sides integrate the same states (position, speed, charge and every energy
//! account) by the same method at the same step, and write the same channels. The loop knows its soil, its terrain and
//! its driveline when it is compiled; the simulation finds them behind traits. Heading and wind may change along a path,
//! so neither side computes their angles once and for all. Rounds alternate and the fastest of each side counts, so that
//! a busy machine disturbs the ratio little. Both have to come to the same end.

#![allow(clippy::print_stdout, reason = "a bench prints what it measures")]

#[path = "longitudinal/coasting.rs"]
mod coasting;
#[path = "longitudinal/electric.rs"]
mod electric;

use headland_plugin::Air;
use headland_sim::{Cycle, Model, Outcome, Phase, Resistance, Start, Vehicle, simulate};
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

const STEP_S: f64 = 1e-3;
const STEPS: usize = 4_000;
const ROUNDS: usize = 500;
/// What a model behind traits may cost, as a multiple of the loop.
const AIM: f64 = 2.0;

const MASS_KG: f64 = 1_270.0;
const DRAG_AREA_M2: f64 = 0.69;
const GRAVITY_M_S2: f64 = 9.806_65;
const AIR_DENSITY_KG_M3: f64 = 1.2;
const WIND_M_S: f64 = 3.0;
const WIND_FROM_RAD: f64 = 1.0;
const HEADING_RAD: f64 = 0.3;
const COEFFICIENT: f64 = 0.01;
const SPEED_SCALE_M_S: f64 = 50.0;
const START_M_S: f64 = 20.0;

/// Where a loop ends: position [m] and speed [m/s].
type End = [f64; 2];

fn main() {
    let coasting = Contest {
        name: "coasting",
        model: model("Neutral", "()"),
        cycle: cycle(Phase::Coast { until: headland_sim::Until::Elapsed(seconds()) }),
        arithmetic: coasting::run::<false>,
        recording: coasting::run::<true>,
    };
    let electric = Contest {
        name: "electric drive, speed held",
        model: model("ElectricSingleSpeed", electric::PARAMETERS),
        cycle: cycle(Phase::Hold { for_s: seconds() }),
        arithmetic: electric::run::<false>,
        recording: electric::run::<true>,
    };
    println!("{STEPS} steps of {STEP_S} s, fastest of {ROUNDS} rounds");
    println!(
        "{:<28}{:>16}{:>16}{:>16}{:>8}{:>8}",
        "steps per second", "headland", "loop", "without", "ratio", ""
    );
    println!("{:<28}{:>16}{:>16}{:>16}{:>8}{:>8}", "", "", "", "recording", "", "without");
    for contest in [coasting, electric] {
        contest.hold();
    }
}

struct Contest {
    name: &'static str,
    model: Model,
    cycle: Cycle,
    arithmetic: fn(usize, f64) -> End,
    recording: fn(usize, f64) -> End,
}

impl Contest {
    fn hold(&self) {
        self.must_agree();
        let mut fastest_s = [f64::INFINITY; 3];
        for _ in 0..ROUNDS {
            let took_s = [
                seconds_of(|| self.simulated()),
                seconds_of(|| (self.recording)(black_box(STEPS), black_box(STEP_S))),
                seconds_of(|| (self.arithmetic)(black_box(STEPS), black_box(STEP_S))),
            ];
            for (fastest, took) in fastest_s.iter_mut().zip(took_s) {
                *fastest = fastest.min(took);
            }
        }
        let [headland, recording, arithmetic] = fastest_s.map(|took_s| STEPS as f64 / took_s);
        let ratio = recording / headland;
        println!(
            "{:<28}{headland:>16.0}{recording:>16.0}{arithmetic:>16.0}{ratio:>8.2}{:>8.2}   {}",
            self.name,
            arithmetic / headland,
            if ratio <= AIM {
                format!("within the aim of {AIM}")
            } else {
                format!("beyond the aim of {AIM}")
            }
        );
    }

    fn simulated(&self) -> Outcome {
        simulate(black_box(&self.model), black_box(&self.cycle)).expect("steps make a trace")
    }

    /// A loop that does something else would prove nothing.
    fn must_agree(&self) {
        const TOLERANCE: f64 = 1e-9;
        let outcome = self.simulated();
        assert_eq!(outcome.steps, STEPS, "{}: {:?}", self.name, outcome.end);
        let last = |name: &str| *outcome.trace.get(name).and_then(<[f64]>::last).expect("a channel");
        for end in [(self.recording)(STEPS, STEP_S), (self.arithmetic)(STEPS, STEP_S)] {
            for (found, expected) in end.into_iter().zip([last("position_m"), last("speed_m_s")]) {
                assert!((found / expected - 1.0).abs() < TOLERANCE, "{}: {found}, {expected}", self.name);
            }
        }
    }
}

fn seconds() -> f64 {
    STEPS as f64 * STEP_S
}

fn seconds_of<T>(work: impl Fn() -> T) -> f64 {
    let begin = Instant::now();
    black_box(work());
    begin.elapsed().as_secs_f64()
}

fn cycle(phase: Phase) -> Cycle {
    Cycle {
        start: Start { position_m: 0.0, speed_m_s: START_M_S },
        phases: vec![phase],
        driver_gain_per_s: 1.0,
        step_s: STEP_S,
        longest_s: 1e6,
    }
}

fn model(driveline: &str, parameters: &str) -> Model {
    let registry = headland_stock::registry();
    let here = Path::new("");
    let soil = format!("(coefficient: {COEFFICIENT}, speed_scale_m_s: {SPEED_SCALE_M_S})");
    let terrain = format!("(heading_rad: {HEADING_RAD})");
    Model {
        vehicle: Vehicle {
            mass_kg: MASS_KG,
            rotating_mass_kg: 0.0,
            resistance: Resistance::Drag { area_m2: DRAG_AREA_M2 },
            brake_friction: f64::INFINITY,
        },
        gravity_m_s2: GRAVITY_M_S2,
        air: Air {
            density_kg_m3: AIR_DENSITY_KG_M3,
            wind_speed_m_s: WIND_M_S,
            wind_from_rad: WIND_FROM_RAD,
            temperature_c: f64::NAN,
        },
        terrain: registry.terrains.build("Flat", &terrain, here).expect("a terrain"),
        axles: None,
        soil: Some(registry.soils.build("LinearSpeedLaw", &soil, here).expect("a soil")),
        driveline: registry.drivelines.build(driveline, parameters, here).expect("a driveline"),
        tasks: Vec::new(),
        effects: Vec::new(),
    }
}

/// The forces that both loops share.
#[derive(Clone, Copy)]
struct Forces {
    east_m: f64,
    north_m: f64,
    soil_n: f64,
    air_n: f64,
}

fn forces(position_m: f64, speed_m_s: f64) -> Forces {
    let (heading_rad, wind_from_rad) = (black_box(HEADING_RAD), black_box(WIND_FROM_RAD));
    let (east, north) = heading_rad.sin_cos();
    let load_n = MASS_KG * GRAVITY_M_S2;
    let soil_n = COEFFICIENT * (1.0 + speed_m_s.max(0.0) / SPEED_SCALE_M_S) * load_n;
    let (sin, cos) = (wind_from_rad - heading_rad).sin_cos();
    let (along, across) = (speed_m_s + WIND_M_S * cos, WIND_M_S * sin);
    let air_n = -0.5 * AIR_DENSITY_KG_M3 * DRAG_AREA_M2 * along.hypot(across) * along;
    Forces { east_m: position_m * east, north_m: position_m * north, soil_n, air_n }
}

/// One step of the classical Runge-Kutta method from a slope that is known.
fn step<const N: usize>(y: &mut [f64; N], k1: &[f64; N], step_s: f64, slope: impl Fn(&[f64; N]) -> [f64; N]) {
    let ahead = |share: f64, k: &[f64; N]| std::array::from_fn(|i| y[i] + share * step_s * k[i]);
    let k2 = slope(&ahead(0.5, k1));
    let k3 = slope(&ahead(0.5, &k2));
    let k4 = slope(&ahead(1.0, &k3));
    for i in 0..N {
        y[i] += step_s * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0;
    }
}
