//! How the vehicle swings: frequencies by the formula of a mass on two springs, the order of the step, the same bits.

use super::{MASS_KG, Tow, channel, chassis, coast_down, cycle, hitched, last, model, run, soil, terrain};
use crate::chassis::{Chassis, Suspension};
use crate::simulate;
use headland_plugin::{Place, Spot, Surface, Terrain};
use headland_sim::{Axles, Cycle, Model, Named, Outcome, Phase, Until};
use headland_soil::{Constant, LinearSpeedLaw};
use headland_terrain::Flat;
use std::f64::consts::TAU;

/// Level, with a step up at 4 m that is smoothed over half a metre.
#[derive(Debug)]
pub struct StepUp;

impl Surface for StepUp {
    fn spot(&self, _: f64, north_m: f64) -> Option<Spot> {
        let (height, over) = (0.03, 0.5);
        let share = ((north_m - 4.0) / over).clamp(0.0, 1.0);
        let height_m = height * share * share * (3.0 - 2.0 * share);
        let rise_north = height * 6.0 * share * (1.0 - share) / over;
        Some(Spot { height_m, rise_east: 0.0, rise_north })
    }
}

impl Terrain for StepUp {
    fn at(&self, position_m: f64) -> Place {
        Place { north_m: position_m, ..Place::default() }
    }

    fn surface(&self) -> Option<&dyn Surface> {
        Some(self)
    }
}

/// Angular frequencies of a rigid body on two springs a ahead of its centre of gravity and b behind it [rad/s]:
/// the roots of (k₁ + k₂ − m ω²) (k₁ a² + k₂ b² − J ω²) = (k₂ b − k₁ a)².
fn two_masses(k: [f64; 2], [a, b]: [f64; 2], mass_kg: f64, inertia: f64) -> [f64; 2] {
    let (bounce, pitch) = ((k[0] + k[1]) / mass_kg, (k[0] * a * a + k[1] * b * b) / inertia);
    let coupled = (k[1] * b - k[0] * a).powi(2) / (mass_kg * inertia);
    let (middle, half) = (0.5 * (bounce + pitch), 0.5 * (bounce - pitch));
    let apart = half.hypot(coupled.sqrt());
    [(middle - apart).sqrt(), (middle + apart).sqrt()]
}

/// The body with damping taken away, so that a swing lasts.
fn undamped() -> Chassis {
    let mut chassis = chassis();
    for axle in &mut chassis.axles {
        axle.damping_n_s_m = 0.0;
    }
    chassis
}

/// Power of a record at an angular frequency, by its Fourier sum with a Hann window.
fn power(times: &[f64], values: &[f64], omega: f64) -> f64 {
    let (first, last) = (times[0], times[times.len() - 1]);
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let (mut re, mut im) = (0.0, 0.0);
    for (time, value) in times.iter().zip(values) {
        let window = 0.5 - 0.5 * (TAU * (time - first) / (last - first)).cos();
        let (sin, cos) = (omega * time).sin_cos();
        re += window * (value - mean) * cos;
        im += window * (value - mean) * sin;
    }
    re.hypot(im)
}

/// The frequency of the highest peak between two bounds [rad/s].
pub fn peak(times: &[f64], values: &[f64], (low, high): (f64, f64)) -> f64 {
    let steps = 400;
    let at = |index: u32| low + (high - low) * f64::from(index) / f64::from(steps);
    (0..=steps).map(at).max_by(|a, b| power(times, values, *a).total_cmp(&power(times, values, *b))).unwrap()
}

#[test]
fn bounce_and_pitch_swing_at_the_frequencies_of_a_mass_on_two_springs() {
    let model = model(Box::new(StepUp), soil::<Constant>("(coefficient: 0.0001)"));
    let cycle = cycle(6.0, vec![Phase::Coast { until: Until::Elapsed(12.0) }], 1e-3);
    let outcome = simulate(&model, &undamped(), &cycle, 0.0).unwrap();
    let k = 2.0 * 1e6 / (0.365 + 170.0 / 150.0);
    let [slow, fast] = two_masses([k, k], [1.6, 2.0], MASS_KG, 32_000.0);
    let rows: Vec<usize> =
        (0..outcome.trace.len()).filter(|row| outcome.trace.time_s()[*row] > 2.0).collect();
    let of = |name: &str| -> Vec<f64> {
        let values = channel(&outcome, name);
        rows.iter().map(|row| values[*row]).collect()
    };
    let times: Vec<f64> = rows.iter().map(|row| outcome.trace.time_s()[*row]).collect();
    let middle = 0.5 * (slow + fast);
    let bounce = peak(&times, &of("height_m"), (0.7 * slow, middle));
    let pitch = peak(&times, &of("pitch_rad"), (middle, 1.3 * fast));
    assert!((bounce / slow - 1.0).abs() < 0.01, "{bounce} {slow}");
    assert!((pitch / fast - 1.0).abs() < 0.01, "{pitch} {fast}");
}

fn sandy() -> Model {
    model(
        terrain::<Flat>("()"),
        soil::<LinearSpeedLaw>("(coefficient: 0.069, speed_scale_m_s: 27.7777777777)"),
    )
}

fn for_seconds(step_s: f64) -> Cycle {
    cycle(8.0, vec![Phase::Coast { until: Until::Elapsed(4.0) }], step_s)
}

#[test]
fn halving_the_step_halves_the_error() {
    let model = sandy();
    let way = |step_s: f64| last(&run(&model, &for_seconds(step_s)), "position_m");
    let [coarse, middle, fine] = [4e-3, 2e-3, 1e-3].map(way);
    let order = ((coarse - middle) / (middle - fine)).abs().log2();
    assert!((order - 1.0).abs() < 0.1, "observed order {order}");
}

fn bits(outcome: &Outcome) -> Vec<u64> {
    outcome
        .trace
        .channels()
        .iter()
        .flat_map(|channel| channel.values.iter().map(|value| value.to_bits()))
        .collect()
}

#[test]
fn two_runs_are_the_same_bits_on_any_thread() {
    let plain = model(Box::new(StepUp), soil::<Constant>("(coefficient: 0.05)"));
    let mut towing = model(Box::new(StepUp), soil::<Constant>("(coefficient: 0.05)"));
    towing.tasks.push(Named { name: "trailer".to_owned(), plugin: Box::new(Tow) });
    let mut hopping = Chassis { trailer: hitched().trailer, ..sprung() };
    for suspension in hopping.axles.iter_mut().filter_map(|axle| axle.suspension.as_mut()) {
        suspension.unsprung_mass_kg = 400.0;
    }
    for (model, chassis) in [(plain, chassis()), (towing, hopping)] {
        let cycle = for_seconds(1e-3);
        let once = || bits(&simulate(&model, &chassis, &cycle, 0.0).unwrap());
        let alone = once();
        let together: Vec<Vec<u64>> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..3).map(|_| scope.spawn(once)).collect();
            threads.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        assert!(alone.len() > 100_000 && together.iter().all(|other| *other == alone));
    }
}

#[test]
fn a_bump_leaves_a_ledger_that_closes() {
    let model = model(Box::new(StepUp), soil::<Constant>("(coefficient: 0.07)"));
    let outcome = run(&model, &cycle(8.0, coast_down(), 1e-3));
    assert!(outcome.ledger.relative_residual() < 1e-3, "{:?}", outcome.ledger);
    let took = |name: &str| {
        outcome.ledger.sinks.iter().find(|sink| sink.name == name).map_or(0.0, |sink| sink.energy_j)
    };
    assert!(took("tyre damping") > 100.0, "{:?}", outcome.ledger);
    let climbed_j = MASS_KG * super::GRAVITY * 0.03;
    assert!((took("slope") / climbed_j - 1.0).abs() < 0.1, "{} {climbed_j}", took("slope"));
}

fn sprung() -> Chassis {
    let mut chassis = chassis();
    for axle in &mut chassis.axles {
        axle.suspension =
            Some(Suspension { stiffness_n_m: 300e3, damping_n_s_m: 15e3, unsprung_mass_kg: 0.0 });
    }
    chassis
}

#[test]
fn a_suspension_takes_what_tyres_do_not_and_squeezes_by_its_load() {
    let model = model(Box::new(StepUp), soil::<Constant>("(coefficient: 0.02)"));
    let cycle = cycle(6.0, vec![Phase::Coast { until: Until::Elapsed(5.0) }], 1e-3);
    let outcome = simulate(&model, &sprung(), &cycle, 0.0).unwrap();
    assert!(outcome.ledger.relative_residual() < 1e-3, "{:?}", outcome.ledger);
    let took = |name: &str| {
        outcome.ledger.sinks.iter().find(|sink| sink.name == name).map_or(0.0, |sink| sink.energy_j)
    };
    assert!(took("suspension damping") > 3.0 * took("tyre damping"), "{:?}", outcome.ledger);
    // At rest the springs share the load as their stiffness says: 300 kN/m squeeze by W / 300e3 in front.
    let load_n = MASS_KG * super::GRAVITY * 2.0 / 3.6 / 2.0;
    let squeezed_m = channel(&outcome, "axle_1_left_suspension_m")[0];
    assert!((squeezed_m / (load_n / 300e3) - 1.0).abs() < 1e-6, "{squeezed_m}");
    assert!((channel(&outcome, "axle_1_left_load_n")[0] / load_n - 1.0).abs() < 1e-6);
}

/// One mass m on k, behind it k_s with c_s: m z″ = −k δ, k δ = k_s x + c_s x′, δ + x = z (tyre without damping). The slowest
/// root of the cubic is sought by Newton's method and held against zero crossings of the body.
#[test]
fn a_body_on_suspension_swings_as_the_cubic_of_its_springs_says() {
    let mut sprung = sprung();
    let mut model = sandy();
    // The centre of gravity in the middle: bounce alone.
    model.axles = Some(Axles::new(vec![super::axle(1.8), super::axle(-1.8)], 1.3, 0.7, 0.5).unwrap());
    for axle in &mut sprung.axles {
        axle.damping_n_s_m = 0.0;
        axle.suspension =
            Some(Suspension { stiffness_n_m: 300e3, damping_n_s_m: 4e3, unsprung_mass_kg: 0.0 });
    }
    let k = 1e6 / (0.365 + 170.0 / 150.0);
    let (m, ks, cs) = (MASS_KG / 4.0, 300e3, 4e3);
    // cs m s³ + (k + ks) m s² + k cs s + k ks = 0, s = −a ± i ω: one real root r, then ω² from the quadratic left over.
    let cubic = |s: f64| ((cs * m * s + (k + ks) * m) * s + k * cs) * s + k * ks;
    let slope = |s: f64| (3.0 * cs * m * s + 2.0 * (k + ks) * m) * s + k * cs;
    let mut root = -(k + ks) / cs;
    for _ in 0..50 {
        root -= cubic(root) / slope(root);
    }
    let half = 0.5 * ((k + ks) / cs + root);
    let omega = (-k * ks / (cs * m * root) - half * half).sqrt();
    let bump = model_on_step(model);
    let cycle = cycle(6.0, vec![Phase::Coast { until: Until::Elapsed(5.0) }], 1e-3);
    let outcome = simulate(&bump, &sprung, &cycle, 0.0).unwrap();
    let times = outcome.trace.time_s();
    let rows: Vec<usize> = (0..times.len()).filter(|row| times[*row] > 1.6).collect();
    let heights = channel(&outcome, "height_m");
    let (times, heights): (Vec<f64>, Vec<f64>) = rows.iter().map(|row| (times[*row], heights[*row])).unzip();
    let found = peak(&times, &heights, (0.7 * omega, 1.3 * omega));
    assert!((found / omega - 1.0).abs() < 0.02, "{found} {omega}");
}

fn model_on_step(model: Model) -> Model {
    Model { terrain: Box::new(StepUp), ..model }
}
