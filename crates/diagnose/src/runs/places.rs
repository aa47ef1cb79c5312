//! Spells that belong to places: a stretch of ground holds every run back that comes across it, and a spell of single runs
//! holds it back wherever it was.

use crate::Case;
use crate::runs::recorded::Recorded;
use crate::single_runs::events::Event;

/// Spells are of a place where this share of what other runs drove there lies in spells of theirs.
const SHARED: f64 = 0.75;
/// And where the force differs by less than this share.
const ALIKE: f64 = 0.25;
/// Fewer meetings tell nothing.
const FEWEST: usize = 4;

/// Whether spells are what the ground does: runs that share a path meet them at the same places, as strong.
pub fn of_places(case: &Case, events: &[Event]) -> bool {
    let mass_kg = |run: usize| case.nominal[run].first_mass_kg().unwrap_or(1.0);
    let loaded = |event: &Event| (event.force_n, mass_kg(event.run));
    let placed = events
        .iter()
        .filter_map(|event| Some((event, stretch(&case.runs[event.run], event.from_s, event.to_s)?)));
    let placed: Vec<(&Event, (f64, f64))> = placed.collect();
    let (mut met, mut shared, mut count) = (0.0, 0.0, 0usize);
    for (event, (from_m, to_m)) in &placed {
        let (run, from_m, to_m) = (&case.runs[event.run], *from_m, *to_m);
        let there = placed.iter().filter(|(own, place)| {
            case.runs[own.run].path == run.path && overlap((from_m, to_m), *place) > 0.5 * (to_m - from_m)
        });
        let there: Vec<Loaded> = there.map(|(own, _)| loaded(own)).collect();
        let as_strong = |own: &Event| alike(loaded(own), loaded(event)) || as_loaded(&there, loaded(own));
        for (number, other) in case.runs.iter().enumerate() {
            let apart = number != event.run && other.path == run.path;
            let Some((begin_m, end_m)) = extent(other).filter(|_| apart) else { continue };
            let crossed = overlap((from_m, to_m), (begin_m, end_m));
            if crossed <= 0.5 * (to_m - from_m) {
                continue;
            }
            let own = placed.iter().filter(|(own, _)| own.run == number && as_strong(own));
            let lies: f64 = own.map(|(_, place)| overlap((from_m, to_m), *place)).sum();
            met += crossed;
            shared += lies;
            count += 1;
        }
    }
    count >= FEWEST && shared > SHARED * met
}

/// A force, and the mass of the vehicle that it acts on [N, kg].
type Loaded = (f64, f64);

/// Whether two forces on vehicles of these masses are as strong: the ground holds back in proportion to the load.
fn alike(one: Loaded, other: Loaded) -> bool {
    let same = |one: f64, other: f64| (one - other).abs() < ALIKE * other.abs();
    same(one.0, other.0) || same(one.0 / one.1, other.0 / other.1)
}

/// Whether a force is what those at one place say by the load: ground that gives way more under a heavier vehicle holds it back
/// by more than its share, and still by a line.
fn as_loaded(there: &[Loaded], own: Loaded) -> bool {
    /// A line goes through two of them, whatever they are.
    const FEWEST: usize = 5;
    let count = there.len() as f64;
    let mean = |of: fn(&Loaded) -> f64| there.iter().map(of).sum::<f64>() / count;
    let (force_n, mass_kg) = (mean(|one| one.0), mean(|one| one.1));
    let spread: f64 = there.iter().map(|one| (one.1 - mass_kg).powi(2)).sum();
    let common: f64 = there.iter().map(|one| (one.1 - mass_kg) * (one.0 - force_n)).sum();
    let said_n = force_n + common / spread * (own.1 - mass_kg);
    there.len() >= FEWEST && (own.0 - said_n).abs() < ALIKE * said_n.abs()
}

/// Whether what is on between two times, in one run or in all of them, may as well be what the ground does: it is on in one and the
/// same place, and nobody comes across that at another time. What several runs show begins and ends for all of them where the ground
/// does. Nothing says so where no place was recorded.
pub fn in_one_place(case: &Case, run: Option<usize>, [from_s, to_s]: [f64; 2]) -> bool {
    /// What all were in, as a share of what any was in: a window is known to a tenth of what it lasts at either end.
    const TOGETHER: f64 = 0.8;
    let is_on = |own: &&Recorded| run.is_none_or(|run| own.number == run);
    let on: Vec<(&Recorded, Place)> =
        case.runs.iter().filter(is_on).filter_map(|run| Some((run, stretch(run, from_s, to_s)?))).collect();
    let [(first, there), others @ ..] = &on[..] else { return false };
    let mostly = |place: Place| overlap(*there, place) > 0.5 * (there.1 - there.0);
    let (shared, any) = others.iter().fold((*there, *there), |(shared, any), (_, place)| {
        ((shared.0.max(place.0), shared.1.min(place.1)), (any.0.min(place.0), any.1.max(place.1)))
    });
    let ever = (f64::NEG_INFINITY, f64::INFINITY);
    let off = |own: &Recorded| if is_on(&own) { vec![(ever.0, from_s), (to_s, ever.1)] } else { vec![ever] };
    let at_another_time = |own: &Recorded| {
        off(own).into_iter().filter_map(|(from_s, to_s)| stretch(own, from_s, to_s)).any(mostly)
    };
    first.measured.trace.get("position_m").is_some()
        && others.iter().all(|(run, _)| run.path == first.path)
        && shared.1 - shared.0 > TOGETHER * (any.1 - any.0)
        && !case.runs.iter().any(|run| run.path == first.path && at_another_time(run))
}

/// From where to where [m].
type Place = (f64, f64);

/// Where a run was between two times [m].
pub fn stretch(run: &Recorded, from_s: f64, to_s: f64) -> Option<(f64, f64)> {
    let times = run.measured.trace.time_s().iter().zip(&run.position_m);
    range(times.filter(|(time, _)| (from_s..=to_s).contains(*time)).map(|(_, position)| *position))
}

/// Where a run was at all [m].
fn extent(run: &Recorded) -> Option<(f64, f64)> {
    range(run.position_m.iter().copied())
}

fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    (low < high).then_some((low, high))
}

fn overlap(one: (f64, f64), other: (f64, f64)) -> f64 {
    (one.1.min(other.1) - one.0.max(other.0)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A patch that eight runs crossed with two loads was told as a pull in each of them.
    #[test]
    fn a_patch_holds_a_heavier_vehicle_back_by_more() {
        // 0.017 of the weight of 8.4 t and of 11.1 t; 1.4 kN and 2.1 kN on the same mass are two forces.
        assert!(alike((1400.0, 8352.0), (1860.0, 11_140.0)));
        assert!(!alike((1400.0, 8352.0), (2100.0, 8352.0)));
    }

    /// 0.007 (1 + payload / 3 t) of the weight of 9 t and a payload; the same forces on a vehicle that is always as heavy are none.
    #[test]
    fn a_patch_that_gives_way_holds_a_heavier_vehicle_back_by_more_than_its_share() {
        let of = |payload_kg: f64| {
            let mass_kg = 9000.0 + payload_kg;
            (0.007 * (1.0 + payload_kg / 3000.0) * 9.81 * mass_kg, mass_kg)
        };
        let there = [0.0, 1500.0, 3000.0, 4500.0, 6000.0].map(of);
        assert!(!alike(there[0], there[4]));
        assert!(there.iter().skip(1).all(|own| as_loaded(&there, *own)));
        let always = there.map(|(force_n, _)| (force_n, 12_000.0));
        assert!(!as_loaded(&always, always[4]));
        assert!(!as_loaded(&there[..4], there[0]), "four are too few");
    }

    #[test]
    fn stretches_overlap_by_what_they_have_in_common() {
        assert_eq!(overlap((0.0, 4.0), (3.0, 9.0)), 1.0);
        assert_eq!(overlap((0.0, 4.0), (5.0, 9.0)), 0.0);
        assert_eq!(range([3.0, f64::NAN, 1.0].into_iter()), Some((1.0, 3.0)));
        assert_eq!(range([2.0].into_iter()), None);
    }
}
