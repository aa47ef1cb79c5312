//! Laws that somebody made up are found again, and nothing is found where nothing is.

use crate::plant::{At, Plant};
use headland_symbolic::{Found, Law, Options, find};
use std::cell::Cell;
use std::f64::consts::TAU;

/// Fewer draws than the default: the tests look at laws far from the threshold.
pub fn options() -> Options {
    Options { draws: 40, ..Options::default() }
}

/// What is found, and its R² on runs that were held out.
fn found(seed: u64, sd_n: f64, law: impl Fn(&At) -> f64) -> (Found, f64) {
    let plant = Plant::new(seed, 10, sd_n);
    let made = plant.problem(seed, &law);
    let found = find(&made.problem(), &options(), &|| false).unwrap();
    let r2 = found.law().map_or(0.0, |one| plant.held_out_r2(&made, &law, &one.prediction));
    (found, r2)
}

fn constant(found: &Found, name: &str) -> (f64, f64) {
    let law = found.law().unwrap();
    let one = law.constants.iter().find(|one| one.name == name);
    let one = one.unwrap_or_else(|| panic!("`{name}` is not in {} {:?}", law.text, law.constants));
    (one.value, one.sd.unwrap_or(0.0))
}

/// Within four standard deviations, and those within a tenth.
fn close((value, sd): (f64, f64), truth: f64) {
    assert!((value - truth).abs() < 4.0 * sd && sd < 0.1 * truth, "{value} ± {sd}, and it was {truth}");
}

#[test]
fn a_wave_over_the_way_is_found_with_its_length_off_any_grid() {
    let (found, r2) = found(1, 150.0, |at| 310.0 * (TAU * at.x / 13.37 + 0.7).sin());
    assert!(r2 > 0.98, "{r2}");
    close(constant(&found, "x1_m"), 13.37);
    close(constant(&found, "a1_n"), 310.0);
    close(constant(&found, "phase1_rad"), 0.7);
}

#[test]
fn a_decay_over_time_is_found_with_its_constant() {
    let (found, r2) = found(2, 100.0, |at| 800.0 * (-at.t / 6.3).exp());
    assert!(r2 > 0.98, "{r2}");
    close(constant(&found, "t1_s"), 6.3);
}

/// A constant beside a decay would say it in two terms.
#[test]
fn what_grows_towards_a_level_is_found_as_that() {
    let (found, r2) = found(3, 60.0, |at| 700.0 * (1.0 - (-at.v / 1.3).exp()));
    let law = found.law().unwrap();
    assert!(r2 > 0.95 && law.terms == 1 && law.text.contains("1 - exp"), "{r2} {}", law.text);
}

/// Above a speed it would have to take what a constant gives, and that is known better.
#[test]
fn what_is_there_below_a_speed_alone_is_found_in_one_term() {
    const LEVEL_M_S: f64 = 4.37;
    const WIDTH_M_S: f64 = 0.4;
    let below = |at: &At| 1700.0 / (1.0 + ((at.v - LEVEL_M_S) / (0.5 * WIDTH_M_S)).exp());
    let (found, r2) = found(11, 150.0, below);
    let law = found.law().unwrap();
    assert!(r2 > 0.95 && law.terms == 1 && law.text.contains("1 - tanh"), "{r2} {}", law.text);
    close(constant(&found, "a1_n"), 1700.0);
    close(constant(&found, "v1_m_s"), LEVEL_M_S);
}

/// A retarder that nobody switched off pulls hardest at one speed.
#[test]
fn what_eddy_currents_pull_with_is_found_with_its_peak() {
    const PEAK_M_S: f64 = 3.7;
    let (found, r2) = found(12, 60.0, |at| 620.0 * 2.0 / (at.v / PEAK_M_S + PEAK_M_S / at.v));
    let law = found.law().unwrap();
    assert!(r2 > 0.95 && law.terms == 1 && law.text.contains("/ (1 + (v / v1_m_s)^2)"), "{r2} {}", law.text);
    close(constant(&found, "a1_n"), 620.0);
    close(constant(&found, "v1_m_s"), PEAK_M_S);
}

#[test]
fn a_product_of_two_variables_is_found() {
    let (found, r2) = found(3, 100.0, |at| 50.0 * at.v * (at.heading - 0.9).cos());
    let law = found.law().unwrap();
    assert!(r2 > 0.95 && law.names("v") && law.names("heading") && law.terms == 1, "{r2} {}", law.text);
}

/// A cube hardly differs from a square where speeds do not differ much: who knows more may choose among them.
#[test]
fn a_power_comes_with_the_others_in_its_place() {
    let (found, _) = found(3, 30.0, |at| 4.0 * at.v * at.v * at.v);
    let law = found.law().unwrap();
    assert!(law.text.ends_with("^3") && law.powers.len() == 4, "{} {}", law.text, law.powers.len());
    let other = law.powers.iter().find(|other| other.text.ends_with("^2")).unwrap();
    let square = |law: &Law| law.prediction.iter().flatten().map(|force_n| force_n * force_n).sum::<f64>();
    assert!((0.5..2.0).contains(&(square(other) / square(law))), "its amplitude is its own");
}

/// Terms more may patch what a good one leaves: who asks for the law is told the best of fewer terms as well.
#[test]
fn behind_a_law_of_several_terms_stands_the_best_of_fewer() {
    let (found, _) =
        found(6, 60.0, |at| 400.0 * (TAU * at.x / 13.37 + 0.7).sin() + 90.0 * (at.v - 4.5).max(0.0));
    let laws = found.laws();
    assert!(laws.len() > 1 && laws[0].text == found.law().unwrap().text, "{}", laws.len());
    assert!(laws.windows(2).all(|pair| pair[1].terms < pair[0].terms));
    let one = laws.last().unwrap();
    assert!(one.terms == 1 && one.names("sin"), "{}", one.text);
}

#[test]
fn a_law_of_two_terms_is_found() {
    let law = |at: &At| {
        500.0 * (-((at.x - 120.0) / 18.0_f64).powi(2)).exp() + at.coasting * 160.0 * (at.v - 4.5).max(0.0)
    };
    let (found, r2) = found(4, 100.0, law);
    let law = found.law().unwrap();
    assert!(r2 > 0.95 && law.names("x") && law.names("coasting") && law.terms == 2, "{r2} {}", law.text);
    assert_eq!(found.chance.terms, 2, "{:?}", found.chance);
}

#[test]
fn a_wave_that_fades_is_found() {
    let (found, r2) = found(5, 100.0, |at| 600.0 * (TAU * at.t / 4.21).cos() * (-at.t / 14.0).exp());
    let law = found.law().unwrap();
    assert!(r2 > 0.95 && law.names("t") && law.names("sin"), "{r2} {}", law.text);
}

/// A wave has four fifths of it: what goes on and off is told as that, with its share.
#[test]
fn what_is_clocked_is_found_as_a_pulse_with_its_period_and_its_share() {
    /// Of each period.
    const ON: f64 = 0.35;
    let (found, r2) = found(6, 100.0, |at| if (at.t / 7.3 + 0.2).rem_euclid(1.0) < ON { 500.0 } else { 0.0 });
    let law = found.law().unwrap();
    assert!(r2 > 0.95 && law.terms == 1, "{r2} {}", law.text);
    let (amplitude, sd) = constant(&found, "a1_n");
    close((amplitude, sd), 500.0);
    close(constant(&found, "t2_s"), 7.3);
    let on = constant(&found, "level1").0.acos() / std::f64::consts::PI;
    assert!((on - ON).abs() < 0.02, "{on} {}", law.text);
}

/// Whether a switch is on that goes on at one speed and off at another; each run begins with it off.
fn switch(on_m_s: f64, off_m_s: f64) -> impl Fn(&At) -> bool {
    let on = Cell::new(false);
    move |at| {
        on.set(at.v >= on_m_s || at.v > off_m_s && at.t > 0.0 && on.get());
        on.get()
    }
}

/// A flap that opens at one speed and closes at another remembers which it passed last: no function of speed says that.
#[test]
fn a_switch_that_latches_is_found_with_its_levels() {
    const ON_M_S: f64 = 6.37;
    const OFF_M_S: f64 = 3.18;
    let open = switch(ON_M_S, OFF_M_S);
    let (found, r2) = found(8, 100.0, |at| if open(at) { 450.0 } else { 0.0 });
    let law = found.law().unwrap();
    assert!(r2 > 0.95 && law.terms == 1 && law.text.contains("latched(v, "), "{r2} {}", law.text);
    close(constant(&found, "a1_n"), 450.0);
    let (on, over) = (constant(&found, "v1_m_s").0, constant(&found, "v2_m_s").0);
    assert!((on - ON_M_S).abs() < 0.1 && (on - over - OFF_M_S).abs() < 0.1, "{on} {over}");
}

/// An axle that drags until it lets go at one speed, and drags again from a lower one down.
#[test]
fn a_switch_that_lets_go_above_a_speed_is_found_the_other_way_round() {
    let free = switch(6.37, 3.18);
    let (found, r2) = found(8, 100.0, |at| if free(at) { 0.0 } else { 450.0 });
    let law = found.law().unwrap();
    assert!(r2 > 0.95 && law.terms == 1 && law.text.contains("(1 - latched(v, "), "{r2} {}", law.text);
    close(constant(&found, "a1_n"), 450.0);
}

/// A fan that catches at one speed and lets go at another takes, while it is driven, by the cube of the speed.
#[test]
fn what_a_switch_turns_on_goes_by_a_speed_of_its_own() {
    const ON_M_S: f64 = 6.37;
    const OFF_M_S: f64 = 3.18;
    let caught = switch(ON_M_S, OFF_M_S);
    let (found, r2) = found(8, 60.0, |at| if caught(at) { 500.0 * (at.v / 8.0).powi(3) } else { 0.0 });
    let law = found.law().unwrap();
    let driven = law.text.contains("latched(v, ") && law.text.contains(")^3");
    assert!(r2 > 0.95 && law.terms == 1 && driven, "{r2} {}", law.text);
}

/// Grease that stiffens below a temperature: nothing of it is there above, and a line through all temperatures would say so.
#[test]
fn what_sets_in_below_a_temperature_goes_by_a_speed() {
    let (found, r2) = found(11, 60.0, |at| 9.0 * (14.2 - at.temperature).max(0.0) * at.v);
    let law = found.law().unwrap();
    let below = law.text.contains("max((temperature1_c - temperature)") && law.names("v");
    assert!(r2 > 0.95 && law.terms == 1 && below, "{r2} {}", law.text);
    close(constant(&found, "temperature1_c"), 14.2);
}

/// A value as it is followed with a time constant, from where it had settled.
fn late(lag_s: f64, of: fn(&At) -> f64) -> impl Fn(&At) -> f64 {
    let followed = Cell::new((0.0, 0.0));
    move |at| {
        let (before, last_s) = followed.get();
        let now =
            if at.t == 0.0 { of(at) } else { of(at) + (before - of(at)) * (-(at.t - last_s) / lag_s).exp() };
        followed.set((now, at.t));
        now
    }
}

/// The square of a speed, and a spring that a damper lets go.
#[test]
fn what_follows_late_is_found_with_its_time_constant() {
    const LAG_S: f64 = 8.7;
    let square = late(LAG_S, |at| (at.v / 10.0).powi(2));
    let (found_of_square, r2) = found(9, 100.0, |at| 900.0 * square(at));
    let law = found_of_square.law().unwrap();
    let follows = law.text.contains("lagged((v / v1_m_s)^2, lag1_s)");
    assert!(r2 > 0.95 && law.terms == 1 && follows, "{r2} {}", law.text);
    close(constant(&found_of_square, "lag1_s"), LAG_S);

    let damper = late(LAG_S, |at| at.v);
    let (found_of_spring, r2) = found(10, 100.0, |at| 90.0 * (at.v - damper(at)));
    let law = found_of_spring.law().unwrap();
    let follows = law.text.contains("((v - lagged(v, lag1_s)) / v1_m_s)");
    assert!(r2 > 0.95 && law.terms == 1 && follows, "{r2} {}", law.text);
    close(constant(&found_of_spring, "lag1_s"), LAG_S);
}

#[test]
fn what_one_side_of_a_bend_does_is_found() {
    let (found, r2) = found(7, 100.0, |at| 400.0 * (at.kappa * at.v * at.v).max(0.0));
    let law = found.law().unwrap();
    assert!(r2 > 0.95 && law.names("v") && law.names("kappa") && law.terms == 1, "{r2} {}", law.text);
}

/// The second nuisance of the plant is a force along v²: 2 N s²/m² are half of its standard deviation.
#[test]
fn what_a_free_parameter_can_imitate_earns_nothing() {
    let (found, _) = found(6, 100.0, |at| 2.0 * at.v * at.v);
    assert!(found.law().is_none(), "{:?}", found.law().map(|law| &law.text));
}

/// With a significance of one in a hundred, two of twenty happen once in sixty such tests; the seeds are fixed. The example
/// `recovered` counts over more.
#[test]
fn nothing_is_found_in_noise() {
    let claimed = (0..20)
        .filter(|seed| {
            let made = Plant::new(500 + seed, 4, 100.0).problem(900 + seed, |_| 0.0);
            find(&made.problem(), &options(), &|| false).unwrap().law().is_some()
        })
        .count();
    assert!(claimed <= 1, "{claimed} of 20");
}

/// The whitening takes neighbouring rows for correlated by 0.3, and they are by 0.7: waves and bumps appear by chance.
#[test]
fn noise_that_was_not_whitened_well_is_no_law() {
    let (mut claimed, mut persistent) = (0, 0);
    for seed in 0..6 {
        let plant = Plant { persistence: 0.7, ..Plant::new(700 + seed, 4, 100.0) };
        let found = find(&plant.problem(seed, |_| 0.0).problem(), &options(), &|| false).unwrap();
        claimed += usize::from(found.law().is_some());
        persistent += usize::from(found.chance.persistence[0] > 0.3);
    }
    assert!(claimed <= 1 && persistent == 6, "{claimed} {persistent} of 6");
}

#[test]
fn the_front_falls_in_error_as_it_grows_in_complexity() {
    let (found, _) = found(2, 100.0, |at| 800.0 * (-at.t / 6.3).exp());
    assert!(found.front.len() > 1 && found.front[0].complexity == 0 && found.front[0].error == 0.0);
    for pair in found.front.windows(2) {
        assert!(pair[0].complexity < pair[1].complexity && pair[0].error > pair[1].error);
    }
    let law = found.law().unwrap();
    assert!(law.explained > 0.3 && law.unseen.unwrap() > 0.3, "{law:?}");
}
