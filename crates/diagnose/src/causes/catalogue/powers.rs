//! What takes power and makes no force.

use super::cause::{Cause, Form, LIMIT, cause};
use super::term::{Term, linear, positive, shape};
use super::{Around, MOTION, fading, spell, windows};
use crate::balances::balance::Kind;

/// What is switched at the same time in every run belongs to a plan of the runs, which long ones do not have [s].
const SHORT_RUN_S: f64 = 600.0;

/// What a start takes for a few seconds, beside a warm-up that has to be there.
pub const START: &str = "start_torque_n_m";

/// No engine warms up faster [s]: the cold phase of the American test procedure, 505 s, holds a few of its time constants
/// (40 CFR 1066.815). In runs that are short, what is over within a tenth of them is told as such.
const WARM_UP_S: f64 = 120.0;
const SHORT: f64 = 10.0;

/// Heaters and pumps of a car take so much [W] ...
const OF_A_CAR_W: f64 = 1000.0;
/// ... and what hangs on an engine of a tractor or truck several times as much: pumps on standby 3 to 10 kW, a fan 5 to 20 kW; usual
/// figures, of no one source [W].
const OF_AN_ENGINE_W: f64 = 3000.0;
/// What is switched takes more than what is always on.
const SWITCHED: f64 = 1.5;

/// A drive gives back so many watts for a kilogram of its vehicle at most: from that of a town car that hardly does, by factors of a
/// fifth, to what a machine as strong as the engine could.
const GIVEN_BACK_W_KG: f64 = 0.8;
const GIVEN_BACK_TIMES: f64 = 1.2;
const GIVEN_BACK: u8 = 22;

/// A limit of what the drive gives back, told by the power alone: where the torque was recorded, that says it. Its effect bends at the
/// limit, so that each shape is a whole one and its size the limit itself.
fn regeneration_limit(around: &Around) -> Cause {
    let least_w = GIVEN_BACK_W_KG * around.mass_kg;
    let limits_w = (0..GIVEN_BACK).map(|step| vec![least_w * GIVEN_BACK_TIMES.powi(i32::from(step))]);
    let usual_w = least_w * GIVEN_BACK_TIMES.powi(i32::from(GIVEN_BACK));
    // What is said of it is the same where brakes tell of it.
    Cause {
        balances: &[Kind::Battery],
        terms: vec![positive("power_w", "W", usual_w)],
        depends_on: &["battery_power_w"],
        form: Form::Parameters,
        ..spell(LIMIT)
    }
    .shaped(limits_w.collect())
}

/// A consumer with a level of its own in each run. What a battery gives is known well enough to tell runs apart by it; an engine has
/// more of that kind from run to run.
fn in_some_runs(usual_w: f64) -> Cause {
    cause(
        "auxiliary_power",
        &[Kind::Battery],
        vec![positive("power_w", "W", SWITCHED * usual_w)],
        "P = P₀ in each run",
        &[],
        "a consumer that is on in some of the runs",
        "log the current of heater, fan and hydraulics",
    )
    .by_run()
}

/// A pull that comes and goes, where power alone tells of it: it takes more the faster the vehicle goes, as no consumer does.
fn pull_in_spells(around: &Around) -> Cause {
    /// Of the weight, as usual as any.
    const SHARE: f64 = 0.02;
    let usual_n = SHARE * around.mass_kg * around.gravity_m_s2;
    cause(
        "drawbar_load",
        MOTION,
        vec![positive("force_n", "N", usual_n).within(0.0, f64::INFINITY)],
        "F = F(t)",
        &["time_s"],
        "a pull at the hitch that was not recorded",
        "repeat without implement or trailer, or log the drawbar force",
    )
    .over(Form::OverTime)
}

/// Adds what the drive of this vehicle could be missing.
pub fn powers(all: &mut Vec<Cause>, around: &Around) {
    let engine = around.channels.iter().any(|name| name == "fuel_rate_kg_s" || name == "engine_torque_n_m");
    let usual_w = if engine { OF_AN_ENGINE_W } else { OF_A_CAR_W };
    all.push(cause(
        "auxiliary_power",
        &[Kind::Battery, Kind::Fuel],
        vec![positive("power_w", "W", usual_w)],
        "P = P₀",
        &[],
        "a consumer that is always on",
        "stand with the drive on, and switch consumers one by one",
    ));
    all.push(
        cause(
            "auxiliary_power",
            &[Kind::Battery, Kind::Fuel],
            vec![positive("power_w", "W", SWITCHED * usual_w).within(0.0, f64::INFINITY)],
            "P = P(t)",
            &["time_s"],
            "a consumer that is switched with time",
            "log the current of heater, fan and hydraulics",
        )
        .over(Form::OverTime),
    );
    if !engine {
        all.push(in_some_runs(usual_w));
    }
    if around.duration_s <= SHORT_RUN_S {
        all.push(pull_in_spells(around));
        all.push(
            cause(
                "auxiliary_power",
                &[Kind::Battery, Kind::Fuel],
                vec![positive("power_w", "W", SWITCHED * usual_w), shape("from_s", "s"), shape("to_s", "s")],
                "P = P₀ between two times",
                &["time_s"],
                "a consumer that is on for a while in each run",
                "log the current of heater, fan and hydraulics",
            )
            .shaped(windows(around.duration_s)),
        );
    }
    let has = |name: &str| around.channels.iter().any(|channel| channel == name);
    if !engine && !has("motor_torque_n_m") && !has("tractive_force_n") {
        all.push(regeneration_limit(around));
    }
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
    // An engine that was driven just before starts warm, so that often one run alone starts cold, or each as cold as it is.
    // What enrichment and a cold catalyst take besides is over too soon to be told from a run's begin by itself.
    let cold = |words, besides: Option<Term>| {
        let fastest_s = WARM_UP_S.min(around.duration_s / SHORT);
        let slowest_s = fading(around).high.max(fastest_s);
        let warming = shape("time_constant_s", "s").within(fastest_s, slowest_s);
        let terms = [positive("cold_torque_n_m", "N m", 30.0), warming];
        cause(
            "cold_start",
            &[Kind::Fuel],
            terms.into_iter().chain(besides).collect(),
            "P = (T e^(−t/τ) + T₁ e^(−t/15 s)) ω / e",
            &["time_s", "engine_speed_rad_s"],
            words,
            "repeat the cycle with the engine warm",
        )
        .shaped(
            [30.0, 60.0, 90.0, 150.0, 240.0, 480.0, 960.0]
                .into_iter()
                .filter(|tau| (fastest_s..=slowest_s).contains(tau))
                .map(|tau| vec![tau])
                .collect(),
        )
    };
    let start = || Some(positive(START, "N m", 60.0));
    all.push(cold("an engine that starts cold", start()));
    let once = around.beginnings.iter();
    all.extend(once.map(|run| cold("an engine that starts cold in one of the runs", start()).in_run(*run)));
    if !around.beginnings.is_empty() {
        all.push(cold("an engine that starts as cold as it is in each run", None).by_run());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(duration_s: f64, id: &str) -> Vec<Cause> {
        let mut all = Vec::new();
        powers(&mut all, &Around { duration_s, ..Around::default() });
        all.into_iter().filter(|cause| cause.id == id).collect()
    }

    #[test]
    fn a_consumer_between_two_times_is_written_with_them_and_only_where_runs_are_short() {
        let windows = |duration_s: f64| -> Vec<Cause> {
            of(duration_s, "auxiliary_power").into_iter().filter(|cause| cause.window().is_some()).collect()
        };
        let short = windows(80.0);
        assert_eq!(short.len(), 1);
        assert_eq!(
            short[0].written(&[1500.0, 10.0, 30.0]),
            "auxiliary_power(times_s: [10.0, 30.0], powers_w: [1500.0])"
        );
        assert!(short[0].shapes.contains(&vec![10.0, 30.0]) && windows(7200.0).is_empty());
    }
}
