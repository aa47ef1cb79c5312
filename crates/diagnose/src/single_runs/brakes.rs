//! Service brakes that nobody recorded, told before anything else is looked for.
//!
//! F_b = F − R − m dv/dt, where the vehicle slows down and is not driven. A braked vehicle slows down several times harder
//! than its resistances could make it, and only while nothing drives it: no other cause does both. Left in the rows, such
//! stretches would pass for noise, and hide everything else. A brake switch says when, and not how hard.
//! Source: Newton's second law along the path; the threshold is robust, by the median absolute deviation
//! (Huber and Ronchetti, *Robust Statistics* (2009), chapter 5).

use crate::proof::prove::improved;
use crate::proof::refine::Refined;
use crate::runs::places::stretch;
use crate::runs::recorded::{Recorded, SLOWEST_M_S};
use crate::runs::said::Said;
use crate::single_runs::course::steps;
use crate::single_runs::events::{BRAKED_M_S2, Event, OPEN};
use crate::single_runs::regeneration::{limit_w, weak};
use crate::{Case, DiagnoseError};
use headland_calibrate::statistics::{NORMAL_OF_MEDIAN, mean, median, quantile_of_sorted, sorted};
use headland_units::constants::STANDARD_GRAVITY_M_S2;

/// What is averaged before it is judged [s]: a pedal is not pressed for less.
pub const WINDOW_S: f64 = 0.4;
/// A braking force is so many times what is usually left over, by its median absolute deviation.
const SIGMAS: f64 = 6.0;
/// And so many times what is left over in all but two of a hundred samples that are driven.
const DRIVEN: f64 = 2.0;
/// And this share of the weight: less is what a slope or the ground could do.
const WEAKEST: f64 = 0.04;
/// And so many times what the model has to hold the vehicle back.
const RESISTANCES: f64 = 1.0;
/// A vehicle is driven where the recorded force is more than this share of what is left over.
const IDLE: f64 = 0.25;
/// A stretch goes on while what is left over is more than this share of its greatest.
const FADED: f64 = 0.15;
/// The ground does to every run what it does to one: it holds this share of the others that cross the place back by as much, within
/// this share of the force. Drivers brake where they brake, and never twice as hard.
const CROSSED: f64 = 0.75;
const ALIKE: f64 = 0.35;
/// So many others have to cross it.
const FEWEST_OTHERS: usize = 2;
/// Fewer samples tell nothing of what is usual.
const FEWEST: usize = 50;

/// Stretches in which somebody braked.
pub fn brakes(case: &Case, sound: &[Vec<bool>]) -> Vec<Event> {
    let excess = excesses_n(case, sound, Rolling::Left);
    let each = |wanted: &dyn Fn(&Recorded, &Said, usize, f64) -> bool| {
        let mut all = Vec::new();
        for ((run, said), excess) in case.runs.iter().zip(&case.nominal).zip(&excess) {
            for (index, value) in excess.iter().flatten().enumerate() {
                if value.is_finite() && wanted(run, said, index, *value) {
                    all.push(*value);
                }
            }
        }
        sorted(&all)
    };
    let all = each(&|_, _, _, _| true);
    let driven = each(&|run, said, index, _| force(run, index) > 0.5 * said.resistance_n[index].max(0.0));
    // A switch says when; without one it is what drivers do beside driving.
    let switched = case.runs.iter().any(|run| run.measured.trace.get("brake").is_some());
    if all.len() < FEWEST || driven.len() < FEWEST && !switched {
        return Vec::new();
    }
    let driven_n = if driven.is_empty() { 0.0 } else { DRIVEN * quantile_of_sorted(&driven, 0.98) };
    let middle = quantile_of_sorted(&all, 0.5);
    let deviations = sorted(&all.iter().map(|value| (value - middle).abs()).collect::<Vec<_>>());
    let sd_n = NORMAL_OF_MEDIAN * quantile_of_sorted(&deviations, 0.5);
    let usual_n = (SIGMAS * sd_n).max(driven_n);
    let of_run = |(number, excess): (usize, &Option<Vec<f64>>)| {
        let excess = excess.as_deref().unwrap_or(&[]);
        let (time_s, open) = (case.runs[number].measured.trace.time_s(), case.runs[number].open());
        let open_n = |event: &Event| {
            open.as_ref().map_or(0.0, |open| open.spell_n(time_s, (event.from_s, event.to_s)))
        };
        stretches(&case.runs[number], &case.nominal[number], excess, usual_n)
            .into_iter()
            .map(|(from, to)| event(&case.runs[number], number, excess, (from, to), sd_n))
            .filter(|event| event.force_n > SIGMAS * event.sd_n)
            .filter(|event| event.force_n > OPEN * open_n(event))
            .collect::<Vec<Event>>()
    };
    let all: Vec<Event> = excess.iter().enumerate().flat_map(of_run).collect();
    off_the_ground(case, sound, &all)
}

/// Whether samples at which the vehicle is known to roll freely are looked at.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Rolling {
    /// They are.
    Taken,
    /// They are not: nobody brakes a coast-down.
    Left,
}

/// Stretches that are none of the ground.
pub fn off_the_ground(case: &Case, sound: &[Vec<bool>], events: &[Event]) -> Vec<Event> {
    if events.is_empty() {
        return Vec::new();
    }
    let excess = excesses_n(case, sound, Rolling::Taken);
    events.iter().filter(|event| !is_ground(case, &excess, event)).cloned().collect()
}

/// Spells that what was found does not explain, as strong as they are beside it: one that a cold driveline or a wind makes up, where
/// the nominal scenario knew of neither, is none. Those of `braked` were told beside the nominal scenario.
pub fn standing(
    case: &Case,
    refined: &Refined,
    events: &[Event],
    braked: &[Event],
) -> Result<Vec<Event>, DiagnoseError> {
    /// Of its force has to be left beside what was found.
    const LEFT: f64 = 0.5;
    let limit_w = limit_w(case, braked).map(|(limit_w, _)| limit_w);
    // As `event` makes of this noise that of a whole spell.
    let noise_n = |event: &Event| event.sd_n * ((event.to_s - event.from_s) / WINDOW_S).max(1.0).sqrt();
    let usual_n = braked.first().map_or(f64::NAN, noise_n);
    let mut standing = Vec::new();
    for (number, run) in case.runs.iter().enumerate() {
        let own: Vec<&Event> = events.iter().filter(|event| event.run == number).collect();
        if own.is_empty() && limit_w.is_none() {
            continue;
        }
        let scenario = improved(case, refined, number)?;
        let said = case.said_of(std::slice::from_ref(run), &scenario, &refined.values())?;
        let everywhere = vec![true; run.measured.trace.len()];
        let beside = |said: &Said| excess_n(run, said, &everywhere, Rolling::Taken).unwrap_or_default();
        let (left_n, nominal_n) =
            (said.first().map(beside).unwrap_or_default(), beside(&case.nominal[number]));
        let known = |time_s: f64| own.iter().any(|event| (event.from_s..=event.to_s).contains(&time_s));
        let weak = limit_w.map_or_else(Vec::new, |limit_w| weak(run, (limit_w, usual_n), &left_n, known));
        for event in own {
            let mean_n = mean_within(event, run, &left_n);
            // Where nothing is known of it, it stays what it was.
            if mean_n < LEFT * event.force_n {
                continue;
            }
            let explained_n = mean_within(event, run, &nominal_n) - mean_n;
            let told_before = braked.contains(event) && explained_n.is_finite();
            let force_n = event.force_n - if told_before { explained_n } else { 0.0 };
            // A brake that would have to drive is none.
            if force_n > 0.0 {
                standing.push(Event { force_n, ..event.clone() });
            }
        }
        standing.extend(weak);
        let window_s = averaged_over_s(run.measured.trace.time_s());
        for event in standing.iter_mut().filter(|event| event.run == number) {
            event.course = steps(event, &within(event, run, &left_n), (noise_n(event), window_s));
        }
    }
    standing.sort_by(|one, other| one.run.cmp(&other.run).then(one.from_s.total_cmp(&other.from_s)));
    Ok(standing)
}

/// Mean of what is known in a spell.
fn mean_within(event: &Event, run: &Recorded, values: &[f64]) -> f64 {
    mean(&within(event, run, values).into_iter().map(|(_, value)| value).collect::<Vec<f64>>())
}

/// Times [s] and values of the samples in a spell that are known.
fn within(event: &Event, run: &Recorded, values: &[f64]) -> Vec<(f64, f64)> {
    let samples = run.measured.trace.time_s().iter().copied().zip(values.iter().copied());
    samples
        .filter(|(time_s, value)| (event.from_s..=event.to_s).contains(time_s) && value.is_finite())
        .collect()
}

/// What holds every run back beside the model's resistances [N]; none where no force is known.
fn excesses_n(case: &Case, sound: &[Vec<bool>], rolling: Rolling) -> Vec<Option<Vec<f64>>> {
    let runs = case.runs.iter().zip(&case.nominal).zip(sound);
    runs.map(|((run, said), sound)| excess_n(run, said, sound, rolling)).collect()
}

/// Whether others that come across the place of a stretch are held back there as much. Those that all come the other way are pushed
/// as much by a slope, which was taken for soft ground then, or the other way round: the stretch is twice what the ground does.
fn is_ground(case: &Case, excess: &[Option<Vec<f64>>], event: &Event) -> bool {
    let own = &case.runs[event.run];
    let Some((from_m, to_m)) = stretch(own, event.from_s, event.to_s) else { return false };
    let held_n = |run: &Recorded| -> Option<f64> {
        let there = run.position_m.iter().zip(excess[run.number].iter().flatten());
        let there = there.filter(|(place, value)| (from_m..=to_m).contains(*place) && value.is_finite());
        let (sum, count) = there.fold((0.0, 0usize), |(sum, count), (_, value)| (sum + value, count + 1));
        (count > 0).then(|| sum / count as f64)
    };
    let near = |value_n: f64, wanted_n: f64| (value_n - wanted_n).abs() < ALIKE * wanted_n;
    let doubled = held_n(own).is_some_and(|own_n| near(own_n.abs(), 0.5 * event.force_n));
    let (mut crossed, mut alike, mut mirrored) = (0usize, 0usize, 0usize);
    for other in case.runs.iter().filter(|other| other.number != own.number && other.path == own.path) {
        let Some(other_n) = held_n(other) else { continue };
        crossed += 1;
        alike += usize::from(near(other_n, event.force_n));
        let towards =
            other.measured.how.reversed_from_m.is_some() != own.measured.how.reversed_from_m.is_some();
        mirrored += usize::from(towards && near(other_n.abs(), 0.5 * event.force_n));
    }
    let most = CROSSED * crossed as f64;
    crossed >= FEWEST_OTHERS && (alike as f64 >= most || doubled && mirrored == crossed)
}

fn force(run: &Recorded, index: usize) -> f64 {
    run.force_n.as_ref().map_or(f64::NAN, |force| force[index])
}

/// What holds a run back beside the model's resistances [N], averaged over a short window; NaN where it is not known.
fn excess_n(run: &Recorded, said: &Said, sound: &[bool], rolling: Rolling) -> Option<Vec<f64>> {
    run.force_n.as_ref()?;
    let trace = &run.measured.trace;
    // A switch tells of a coast-down that was braked after all.
    let coasting = trace.get("coasting").filter(|_| rolling == Rolling::Left && trace.get("brake").is_none());
    let heard = heard(trace.time_s(), |index| {
        sound[index] && trace.get("speed_m_s").is_none_or(|speed| speed[index].is_finite())
    });
    let raw: Vec<f64> = (0..trace.len())
        .map(|index| {
            let known = heard[index]
                && run.motion.value[index] > SLOWEST_M_S
                && coasting.is_none_or(|values| values[index] < 0.5);
            let left = force(run, index)
                - said.resistance_n[index]
                - said.effective_mass_kg[index] * run.motion.slope[index];
            if known { left } else { f64::NAN }
        })
        .collect();
    Some(averaged(trace.time_s(), &raw))
}

/// Which samples have others all around them: beside a gap the slope of the speed is told from one side, and a torque that changes
/// meanwhile would leave a brake.
fn heard(time_s: &[f64], known: impl Fn(usize) -> bool) -> Vec<bool> {
    /// So far a gap reaches into what is beside it [s].
    const BESIDE_S: f64 = 0.6;
    let mut heard: Vec<bool> = (0..time_s.len()).map(&known).collect();
    let lost: Vec<usize> = (0..time_s.len()).filter(|index| !heard[*index]).collect();
    for index in lost {
        let from = time_s.partition_point(|time| *time < time_s[index] - BESIDE_S);
        let to = time_s.partition_point(|time| *time <= time_s[index] + BESIDE_S);
        heard[from..to].fill(false);
    }
    heard
}

/// Mean over [`WINDOW_S`], or over a few samples where those are rarer, around each sample that is known, where it has others on
/// both sides: at an end, what is left of the window is noisier than the rest.
pub fn averaged(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    /// Samples on the one side for each on the other, at most.
    const LOPSIDED: usize = 2;
    let window_s = averaged_over_s(time_s);
    let (mut from, mut to) = (0, 0);
    (0..values.len())
        .map(|index| {
            while time_s[from] < time_s[index] - 0.5 * window_s {
                from += 1;
            }
            while to < values.len() && time_s[to] <= time_s[index] + 0.5 * window_s {
                to += 1;
            }
            let known =
                |range: std::ops::Range<usize>| values[range].iter().filter(|value| value.is_finite());
            let (before, after) = (known(from..index).count(), known(index + 1..to).count());
            let even = before <= LOPSIDED * after && after <= LOPSIDED * before;
            let sum: f64 = known(from..to).sum();
            if values[index].is_finite() && even { sum / (before + after + 1) as f64 } else { f64::NAN }
        })
        .collect()
}

/// [`WINDOW_S`], or longer where samples are rare [s].
fn averaged_over_s(time_s: &[f64]) -> f64 {
    /// Samples that come a little early or late still have one on each side.
    const STEPS: f64 = 3.0;
    let steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // One sample makes no step, and the median of none is no number: the other is the greatest then.
    WINDOW_S.max(STEPS * median(&steps))
}

/// First and last sample of every stretch that is braked.
fn stretches(run: &Recorded, said: &Said, excess: &[f64], usual_n: f64) -> Vec<(usize, usize)> {
    let idle = |index: usize| force(run, index) < IDLE * excess[index];
    let switch = run.measured.trace.get("brake");
    let braked = |index: usize| {
        if let Some(switch) = switch {
            return switch[index] >= 0.5 && excess[index].is_finite();
        }
        let weight_n = said.effective_mass_kg[index] * STANDARD_GRAVITY_M_S2;
        let least = usual_n.max(WEAKEST * weight_n).max(RESISTANCES * said.resistance_n[index]);
        excess[index] > least && idle(index) && run.motion.slope[index] < BRAKED_M_S2
    };
    let mut all: Vec<(usize, usize)> = Vec::new();
    let mut index = 0;
    while index < excess.len() {
        if !braked(index) {
            index += 1;
            continue;
        }
        let mut end = index;
        while end + 1 < excess.len() && braked(end + 1) {
            end += 1;
        }
        let peak = excess[index..=end].iter().copied().fold(0.0, f64::max);
        // A switch says when it begins and ends; without one the force does.
        let goes_on = |at: usize| switch.is_none() && excess[at] > FADED * peak && idle(at);
        let mut begin = index;
        while begin > 0 && goes_on(begin - 1) {
            begin -= 1;
        }
        while end + 1 < excess.len() && goes_on(end + 1) {
            end += 1;
        }
        match all.last_mut() {
            Some(last) if begin <= last.1 + 1 => last.1 = end,
            _ => all.push((begin, end)),
        }
        index = end + 1;
    }
    let time_s = run.measured.trace.time_s();
    all.into_iter().filter(|(from, to)| time_s[*to] - time_s[*from] >= WINDOW_S).collect()
}

fn event(run: &Recorded, number: usize, excess: &[f64], (from, to): (usize, usize), sd_n: f64) -> Event {
    let time_s = run.measured.trace.time_s();
    let inside = excess[from..=to].iter().filter(|value| value.is_finite());
    let (sum, count) = inside.fold((0.0, 0usize), |(sum, count), value| (sum + value, count + 1));
    let force_n = sum / count.max(1) as f64;
    let lasted_s = time_s[to] - time_s[from];
    // As many values that know nothing of each other as there are windows.
    let sd_n = sd_n / (lasted_s / WINDOW_S).max(1.0).sqrt();
    let (from_s, to_s) = (time_s[from], time_s[to]);
    let own = Event { run: number, from_s, to_s, force_n, sd_n, gain: 0.0, course: Vec::new() };
    let own = match run.measured.trace.get("brake") {
        Some(switch) => switched(&own, time_s, (excess, switch), run.measured.how.smoothing_s),
        None => own,
    };
    Event { gain: 0.5 * (own.force_n / own.sd_n).powi(2), ..own }
}

/// What a switch says of a stretch: it goes over half way between two samples, and all that holds the vehicle back meanwhile is what
/// the slope of the speed, which is smoothed over `smoothing_s` to either side, smears around it.
fn switched(own: &Event, time_s: &[f64], (excess, switch): (&[f64], &[f64]), smoothing_s: f64) -> Event {
    let first = time_s.partition_point(|time| *time < own.from_s);
    let last = time_s.partition_point(|time| *time <= own.to_s) - 1;
    let middle = |one: usize, other: usize| 0.5 * (time_s[one] + time_s[other]);
    let from_s = if first > 0 { middle(first - 1, first) } else { own.from_s };
    let to_s = if last + 1 < time_s.len() { middle(last, last + 1) } else { own.to_s };
    let reach_s = 0.5 * WINDOW_S + smoothing_s;
    // Where somebody brakes again so soon, each stretch has its half of what lies between.
    let off = |index: &usize| switch[*index] < 0.5;
    let half = |off: usize, all: usize| if off < all { off / 2 } else { off };
    let (before, after) = ((0..first).rev(), last + 1..time_s.len());
    let near_before = before.clone().take_while(|index| time_s[*index] >= from_s - reach_s).count();
    let near_after = after.clone().take_while(|index| time_s[*index] <= to_s + reach_s).count();
    let begin = first - near_before.min(half(before.clone().take_while(off).count(), before.len()));
    let end = last + near_after.min(half(after.clone().take_while(off).count(), after.len()));
    let step_s =
        |index: usize| 0.5 * (time_s[(index + 1).min(time_s.len() - 1)] - time_s[index.saturating_sub(1)]);
    let known = (begin..=end).filter(|index| excess[*index].is_finite());
    let impulse_n_s: f64 = known.map(|index| excess[index] * step_s(index)).sum();
    Event { from_s, to_s, force_n: impulse_n_s / (to_s - from_s), ..own.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rare_samples_that_come_early_and_late_are_averaged_as_well() {
        let time_s: Vec<f64> =
            (0..40).map(|index| 0.2 * f64::from(index) + 0.07 * f64::from(index % 3)).collect();
        let mean = averaged(&time_s, &[2.0; 40]);
        assert!(mean[2..38].iter().all(|value| (value - 2.0).abs() < 1e-12), "{mean:?}");
    }

    /// 1.1 s of 10 kN, which a mean over 0.4 s smears over 1.5 s; and once more so soon that both share what lies between.
    #[test]
    fn what_a_switch_says_keeps_its_impulse() {
        let time_s: Vec<f64> = (0..120).map(|index| 0.05 * f64::from(index)).collect();
        let on = |index: usize| (40..62).contains(&index) || (66..88).contains(&index);
        let switch: Vec<f64> = (0..120).map(|index| f64::from(u8::from(on(index)))).collect();
        let raw: Vec<f64> = switch.iter().map(|on| 10e3 * on).collect();
        let excess = averaged(&time_s, &raw);
        for (from, to) in [(40, 61), (66, 87)] {
            let (from_s, to_s) = (time_s[from], time_s[to]);
            let own = Event { run: 0, from_s, to_s, force_n: 0.0, sd_n: 1.0, gain: 0.0, course: Vec::new() };
            let told = switched(&own, &time_s, (&excess, &switch), 0.0);
            assert!((told.to_s - told.from_s - 1.1).abs() < 1e-9, "{told:?}");
            assert!((told.force_n - 10e3).abs() < 100.0, "{told:?}");
        }
    }

    /// Five of seven electric drives whose speed was lost now and then were told to have braked beside the gaps.
    #[test]
    fn beside_a_gap_nothing_is_told_of_brakes() {
        let time_s: Vec<f64> = (0..60).map(|index| 0.1 * f64::from(index)).collect();
        let heard = heard(&time_s, |index| !(20..=30).contains(&index));
        let silent: Vec<usize> = (0..60).filter(|index| !heard[*index]).collect();
        // 0.6 s on either side of 2.0 to 3.0 s.
        assert_eq!((silent[0], silent[silent.len() - 1], silent.len()), (14, 36, 23));
    }

    #[test]
    fn a_mean_over_a_window_leaves_out_what_is_not_known() {
        let time_s: Vec<f64> = (0..10).map(|index| 0.1 * f64::from(index)).collect();
        let mut values = vec![1.0; 10];
        values[5] = f64::NAN;
        values[6] = 5.0;
        let mean = averaged(&time_s, &values);
        assert!(mean[5].is_nan() && mean[0].is_nan() && mean[9].is_nan());
        // 0.3 to 0.7 s hold 1, 1, 1... without the fifth: (1 + 1 + 5 + 1) / 4 around 0.5 s; at 0.7 s 0.5 to 0.9: (5 + 1 + 1 + 1) / 4.
        assert!((mean[7] - 2.0).abs() < 1e-12, "{}", mean[7]);
        assert!((mean[1] - 1.0).abs() < 1e-12);
    }
}
