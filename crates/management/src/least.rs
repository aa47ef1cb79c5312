//! The way to share the power that costs least, by looking at the ways there are.

use headland_plugin::{Bound, Consequence, Outlook, Parameter, Refusal, Share, Stores, parameter};

/// A watt that the wheels do not get costs this many watts of fuel: more than any way to serve it.
pub(crate) const SHORT_COST: f64 = 100.0;

/// The charge that is kept.
pub(crate) const TARGET_CHARGE: Parameter = parameter("target_charge", "1", "charge that is kept, S_t")
    .must_be(Bound::Within(0.0, 1.0))
    .usually(0.3, 0.9);

/// How closely is looked.
pub(crate) const LEVELS: Parameter =
    parameter("levels", "1", "powers of the engine that are looked at in every step")
        .must_be(Bound::Within(2.0, 1000.0))
        .usually(5.0, 100.0)
        .or(usual_levels());

/// How soon the engine may stop again, and start.
pub(crate) const LEAST_TIME_S: Parameter =
    parameter("least_time_s", "s", "the engine runs and rests at least so long, t_least")
        .must_be(Bound::NotNegative)
        .usually(0.0, 120.0);

/// Powers that are looked at where a scenario does not say how many.
pub(crate) const fn usual_levels() -> f64 {
    20.0
}

/// Refuses a number of levels that does not count.
pub(crate) fn whole_levels(levels: f64) -> Result<(), Refusal> {
    if levels.fract() == 0.0 {
        return Ok(());
    }
    Err(Refusal {
        parameter: LEVELS.name.to_owned(),
        found: levels.to_string(),
        expected: "a whole number".to_owned(),
    })
}

/// The cheapest sharing where the engine runs and rests for `least_s` at least, unless the store cannot do it; `since_s` is
/// the time since it was last started or stopped.
pub(crate) fn switched(
    at: &dyn Stores,
    levels: f64,
    least_s: f64,
    since_s: &mut f64,
    price: impl Fn(&Consequence) -> f64,
) -> Share {
    let outlook = at.outlook();
    let settled = *since_s >= least_s;
    let may_start = settled || outlook.power_w > outlook.most_store_w.0;
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "settled to be a small whole number"
    )]
    let share = cheapest(at, levels as usize, (settled, may_start), price);
    if share.engine_runs != outlook.engine_runs {
        *since_s = 0.0;
    }
    share
}

/// Steps of golden section between two powers of the grid: 0.618¹⁰ narrows them to a hundredth.
const NARROWINGS: usize = 10;

/// The engine stopped, or at powers from nothing to its most and at that which leaves the store alone: the cheapest.
/// `may_stop` and `may_start` say whether the engine may change.
fn cheapest(
    at: &dyn Stores,
    levels: usize,
    (may_stop, may_start): (bool, bool),
    price: impl Fn(&Consequence) -> f64,
) -> Share {
    let Outlook { power_w, most_engine_w, engine_runs, .. } = at.outlook();
    let cost = |share: Share| {
        let consequence = at.weigh(share);
        price(&consequence) + SHORT_COST * consequence.short_w
    };
    let running = |engine_w: f64| Share { engine_runs: true, engine_w };
    let stopped = Share { engine_runs: false, engine_w: 0.0 };
    let mut best = (stopped, f64::INFINITY);
    if !engine_runs || may_stop {
        best = (stopped, cost(stopped));
    }
    if !(engine_runs || may_start) {
        return best.0;
    }
    let spacing = most_engine_w / levels as f64;
    let mut at_best = f64::NAN;
    for level in 0..=levels {
        let engine_w = spacing * level as f64;
        let one = cost(running(engine_w));
        if one < best.1 {
            best = (running(engine_w), one);
            at_best = engine_w;
        }
    }
    if at_best.is_finite() {
        let (engine_w, one) =
            golden((at_best - spacing).max(0.0), (at_best + spacing).min(most_engine_w), |engine_w| {
                cost(running(engine_w))
            });
        if one < best.1 {
            best = (running(engine_w), one);
        }
    }
    // Leaving the store alone is a corner of the cost that a grid steps over.
    let alone = running(power_w.clamp(0.0, most_engine_w));
    if cost(alone) <= best.1 { alone } else { best.0 }
}

/// The least of a function with one valley, by golden section.
fn golden(mut low: f64, mut high: f64, cost: impl Fn(f64) -> f64) -> (f64, f64) {
    const SECTION: f64 = 0.618_033_988_749_894_8;
    let (mut one, mut two) = (high - SECTION * (high - low), low + SECTION * (high - low));
    let (mut at_one, mut at_two) = (cost(one), cost(two));
    for _ in 0..NARROWINGS {
        if at_one <= at_two {
            (high, two, at_two) = (two, one, at_one);
            one = high - SECTION * (high - low);
            at_one = cost(one);
        } else {
            (low, one, at_one) = (one, two, at_two);
            two = low + SECTION * (high - low);
            at_two = cost(two);
        }
    }
    if at_one <= at_two { (one, at_one) } else { (two, at_two) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_valley_is_found_between_the_levels() {
        let (at, least) = golden(0.0, 10.0, |x| (x - 3.7) * (x - 3.7) + 1.0);
        assert!((at - 3.7).abs() < 0.06 && (least - 1.0).abs() < 0.004);
    }
}
