//! A second opinion, where something took what may be many things.
//!
//! A map of the ground is free to be almost anything along a path, and takes the place of what any other cause does on average
//! there; a clock that runs apart from the others moves the begin of a run little and its end much, and does a part of what a
//! late speed does; a load that comes and goes in time follows what goes with the acceleration; another scale of a force or a
//! speed is all that goes with it, before a law that nobody listed can say what is missing, since sensors come first; and a
//! listed cause that goes about as a law does hides that law from causes that stand beside it alone. A wind beside one that was
//! recorded makes up for what that is not at the vehicle. A search that begins with one of them may not come back. Where one is claimed
//! and looks like that, by lying off nought all along, by standing beside
//! physics or by leaving more than noise, the runs are looked at once more without it, and the runs that were held out decide.

use crate::choosing::rivals::twin;
use crate::told::report::{Diagnosed, Diagnosis, FindingKind, FindingReport, Fit, FitRuns, Verdict};
use crate::{DiagnoseError, Options};

/// What is free to be almost anything.
const MAP: &str = "soft_ground";
/// Maps of roads that were driven one way, or by one run each, are each other's name.
const SLOPES: &str = "grade";
/// What is late by the clock.
const CLOCK: &str = "clock_drift";
/// What is late all along, which a clock that runs apart does the rest of.
const LATE: &str = "latency";
/// What goes with all of a force, or of a speed.
const SCALES: [&str; 2] = ["force_scale", "speed_scale"];
/// What may come and go in time as it likes, in the place of a law that hangs on what it moves.
const LOAD: &str = "payload_change";
/// A map with one value.
const LEVEL: &str = "rolling_resistance";
/// What blows, where the wind that was recorded is not what blew at the vehicle.
const WIND: &str = "wind";
/// What nobody listed.
const LAW: &str = "unlisted";
/// What is left is this many times the noise, and more.
const MORE_THAN_NOISE: f64 = 1.5;
/// A course of a load, another scale, or what a law may say as well, that leaves so many times the noise is none of it.
const MUCH_MORE: f64 = 4.0;
/// The error with another set of causes has to be less than this share of what it is with the first.
const BETTER: f64 = 0.85;
/// And this one without any map of the road: slopes are there, and few recordings foretell those of another road.
const FAR_BETTER: f64 = 0.25;
/// Errors of a few runs differ by this factor.
const HARDLY: f64 = 1.15;

/// What the runs are to be looked at without, one after the other, the doubtful one first: of some findings that leave so many times the
/// noise.
fn doubtful(findings: &[FindingReport], lack_of_fit: f64) -> Vec<Vec<String>> {
    let leaves = lack_of_fit > MORE_THAN_NOISE;
    let found = |id: &str| findings.iter().find(|finding| finding.id == id);
    let level = |map: &FindingReport| map.indistinguishable_from.iter().any(|rival| rival.id == LEVEL);
    let map = found(MAP).is_some_and(|map| leaves || level(map)).then_some(MAP);
    // What a channel shows by itself was sought by no search.
    let sought = |clock: &FindingReport| clock.evidence[0] > 0.0;
    let clock = (leaves && found(CLOCK).is_some_and(sought)).then_some(CLOCK);
    let physics = findings.iter().any(|finding| finding.kind != FindingKind::Artefact);
    let beside = physics || lack_of_fit > MUCH_MORE;
    let scales = SCALES.into_iter().filter(|scale| beside && found(scale).is_some_and(sought));
    // Both together follow what pushes a vehicle to and fro.
    let both = clock.filter(|_| found(LATE).is_some_and(sought)).map(|clock| vec![clock, LATE]);
    // Along with what is late a law of places has another shape; what a delay does a clock may do in its place.
    let late = (physics && lack_of_fit > MUCH_MORE && found(LATE).is_some_and(sought))
        .then(|| vec![LATE, CLOCK])
        .filter(|_| clock.is_none());
    let is_course = |load: &FindingReport| load.parameters.iter().any(|one| one.name.ends_with("_rms"));
    let load = (lack_of_fit > MUCH_MORE && found(LOAD).is_some_and(is_course)).then_some(LOAD);
    let known = map.into_iter().chain(clock).chain(scales).chain(load).map(|id| vec![id]);
    let known: Vec<Vec<&str>> = known.chain(both).chain(late).collect();
    // What a law may say as well, and leaves as much, hides the law that says it all.
    let by_law = |finding: &&FindingReport| {
        finding.kind == FindingKind::Physics
            && finding.indistinguishable_from.iter().any(|rival| rival.id == LAW)
            && !known.contains(&vec![&finding.id])
    };
    let hides =
        findings.iter().filter(|finding| lack_of_fit > MUCH_MORE && by_law(finding) && sought(finding));
    let hides = hides.map(|finding| vec![finding.id.as_str()]).collect::<Vec<_>>();
    let owned = |ids: &Vec<&str>| ids.iter().map(|id| (*id).to_owned()).collect();
    known.iter().chain(&hides).map(owned).collect()
}

/// The wind, where it stands beside other causes and leaves more than noise.
fn blown(findings: &[FindingReport], lack_of_fit: f64) -> Option<Vec<String>> {
    let among = findings.len() > 1 && findings.iter().any(|finding| finding.id == WIND);
    (among && lack_of_fit > MORE_THAN_NOISE).then(|| vec![WIND.to_owned()])
}

/// Both maps of a road, where either name would do for what leaves much: what goes with the pressure of the tyres is a map of each road too.
fn mapped(findings: &[FindingReport], lack_of_fit: f64) -> Option<Vec<String>> {
    let either = |id: &str, other: &str| {
        let rival = |map: &FindingReport| map.indistinguishable_from.iter().any(|rival| rival.id == other);
        findings.iter().any(|finding| finding.id == id && rival(finding))
    };
    let doubted = lack_of_fit > MUCH_MORE && (either(MAP, SLOPES) || either(SLOPES, MAP));
    doubted.then(|| vec![MAP.to_owned(), SLOPES.to_owned()])
}

/// A map follows the runs that it was made of; what stands in its place may leave so many times the error in those.
const FOLLOWS: f64 = 1.4;

/// Whether runs are told better by another set of causes: those held out, and those fitted no worse, but for what `id` follows.
fn is_better(id: &str, other: &Diagnosis, first: &Diagnosis) -> bool {
    let claims = !other.findings.is_empty() && other.verdict != Verdict::None;
    let left = measure(other, first);
    let errors = |fit: &Fit| (left(&fit.fitted), left(fit.held_out.as_ref().unwrap_or(&fit.fitted)));
    let ((fitted, held_out), (fitted_first, held_out_first)) = (errors(&other.fit), errors(&first.fit));
    claims
        && other.fit.signal == first.fit.signal
        && held_out < BETTER * held_out_first
        && fitted < fitted_first * if id == MAP { FOLLOWS } else { 1.0 }
}

/// Whether the runs held out are told far better.
fn is_far_better(other: &Diagnosis, first: &Diagnosis) -> bool {
    let left = measure(other, first);
    let held_out = |one: &Diagnosis| one.fit.held_out.as_ref().map(left);
    held_out(other).zip(held_out(first)).is_some_and(|(other, first)| other < FAR_BETTER * first)
}

/// By what two sets of causes are measured: the error that is left where one signal tells of both, and else its share of that before.
/// What is driven forward in windows of another length has another error before, too, and so has a power beside a force that was set
/// right.
fn measure(one: &Diagnosis, other: &Diagnosis) -> fn(&FitRuns) -> f64 {
    if one.fit.signal == other.fit.signal && one.fit.signal != "speed_m_s" {
        |runs| runs.rmse_after
    } else {
        |runs| runs.rmse_after / runs.rmse_before
    }
}

/// Whether another opinion takes the place of the first, in which `id` was doubtful. A clock that runs apart is one thing, and
/// so are what is late, a scale and a wind; what takes more than they do to say the same is a patch. And a map that goes by
/// another name, which was named beside it, is the same.
fn wins(id: &str, other: &Diagnosis, first: &Diagnosis) -> bool {
    let is_one = [CLOCK, LATE, WIND].contains(&id) || SCALES.contains(&id);
    let patches = is_one && other.findings.len() > first.findings.len();
    let left = measure(other, first);
    let errors = |one: &Diagnosis| {
        let held_out = left(one.fit.held_out.as_ref()?);
        Some((one.findings.len(), [held_out, left(&one.fit.fitted)]))
    };
    let plainer = errors(other).zip(errors(first)).is_some_and(|(other, first)| is_plainer(other, first));
    let better = is_better(id, other, first) || is_one && plainer;
    let open = leaves_more(other.fit.lack_of_fit, first.fit.lack_of_fit);
    better && !patches && !open && !is_renamed(id, &other.findings, &first.findings)
}

/// Whether more than noise is left where nothing was: one signal may be told better while the balance of another is left open.
fn leaves_more(other: f64, first: f64) -> bool {
    first <= MORE_THAN_NOISE && other > MORE_THAN_NOISE.max(HARDLY * first)
}

/// Whether fewer causes, but not none, tell the runs held out no worse, or hardly worse and those fitted better by more: a sensor at fault, or a
/// wind, is then one cause too many. Each by their number and the share of the error that they leave, held out and fitted.
fn is_plainer((others, errors): (usize, [f64; 2]), (first, errors_first): (usize, [f64; 2])) -> bool {
    let worse = [0, 1].map(|runs| errors[runs] / errors_first[runs]);
    (1..first).contains(&others) && (worse[0] <= 1.0 || worse[0] < HARDLY && worse[0] * worse[1] < 1.0)
}

/// Whether others found by its other name what was found first, and could not be told from that.
fn is_renamed(id: &str, others: &[FindingReport], first: &[FindingReport]) -> bool {
    let Some(twin) = twin(id) else { return false };
    let named = |finding: &FindingReport| {
        finding.id == id && finding.indistinguishable_from.iter().any(|rival| rival.id == twin)
    };
    first.iter().any(named) && others.iter().any(|finding| finding.id == twin)
}

/// The first opinion, or one without what is doubtful in it where that is better; a wind is where a wind was recorded, and both maps are
/// where the pressure of the tyres was, which no listed cause hangs on. `look` looks with other options.
pub fn opinion(
    first: Diagnosed,
    options: &Options,
    known: impl Fn(&str) -> bool,
    look: impl Fn(&Options) -> Result<Diagnosed, DiagnoseError>,
) -> Result<Diagnosed, DiagnoseError> {
    let mut best = first;
    let (findings, lack_of_fit) = (&best.diagnosis.findings, best.diagnosis.fit.lack_of_fit);
    let wind = blown(findings, lack_of_fit).filter(|_| known("wind_speed_m_s"));
    let maps = mapped(findings, lack_of_fit).filter(|_| known("tyre_pressure_pa"));
    for ids in doubtful(findings, lack_of_fit).into_iter().chain(wind).chain(maps) {
        let without = options.without.iter().chain(&ids).cloned().collect();
        match look(&Options { without, ..options.clone() }) {
            Ok(other)
                if wins(&ids[0], &other.diagnosis, &best.diagnosis)
                    && (ids != [MAP, SLOPES] || is_far_better(&other.diagnosis, &best.diagnosis)) =>
            {
                best = other;
            }
            // Nothing else may have been asked for.
            Ok(_) | Err(DiagnoseError::NoBalance { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(best)
}

#[cfg(test)]
mod tests {
    use super::{
        CLOCK, LATE, LAW, LEVEL, LOAD, MAP, SCALES, SLOPES, WIND, blown, doubtful, is_plainer, is_renamed,
        leaves_more, mapped,
    };
    use crate::told::report::FindingKind::{Artefact, Physics};
    use crate::told::report::{ParameterReport, finding};

    #[test]
    fn a_map_by_its_other_name_is_the_same_map() {
        let first = [finding(Physics, MAP, Some("grade"))];
        let slopes = [finding(Physics, "grade", None)];
        assert!(is_renamed(MAP, &slopes, &first));
        // What was driven both ways tells the two apart, and a level is no map.
        assert!(!is_renamed(MAP, &slopes, &[finding(Physics, MAP, None)]));
        assert!(!is_renamed(MAP, &[finding(Physics, LEVEL, None)], &first));
    }

    /// The power of a battery told 1.4 times better, and in the place of soft ground a load that leaves 2.5 times the noise of the motion.
    #[test]
    fn what_leaves_a_balance_open_that_was_closed_is_no_better() {
        assert!(leaves_more(2.5, 1.1));
        assert!(
            !leaves_more(2.5, 3.0)
                && !leaves_more(1.6, 1.45)
                && !leaves_more(1.2, 1.1)
                && !leaves_more(1.1, 2.5)
        );
    }

    /// A drag area in a wind that was recorded with noise was told as a speed law and a wind.
    #[test]
    fn a_wind_beside_another_cause_is_doubted_where_more_than_noise_is_left() {
        let own = |id: &'static str| finding(Physics, id, None);
        assert_eq!(blown(&[own("rolling_speed_law"), own(WIND)], 2.2).unwrap(), [WIND]);
        assert!(blown(&[own("rolling_speed_law"), own(WIND)], 1.1).is_none());
        assert!(blown(&[own(WIND)], 2.2).is_none() && blown(&[own("mass"), own(LOAD)], 2.2).is_none());
    }

    /// One that drifts is looked at without the clock, and beside a late speed without both.
    #[test]
    fn a_clock_that_drifts_beside_a_late_speed_is_doubted_with_it() {
        let own = |id: &'static str| finding(Artefact, id, None);
        assert_eq!(doubtful(&[own(LATE), own(CLOCK)], 9.0), [vec![CLOCK], vec![CLOCK, LATE]]);
        assert_eq!(doubtful(&[own(CLOCK)], 9.0), [vec![CLOCK]]);
        assert!(doubtful(&[own(LATE), own(CLOCK)], 1.0).is_empty() && doubtful(&[own(LATE)], 9.0).is_empty());
    }

    /// Oil that warms up, where a drag that follows the square of the speed late was hidden: a law that leaves as much was its rival.
    #[test]
    fn what_a_law_may_say_as_well_and_leaves_much_is_doubted() {
        let oil = |rival: &str| [finding(Physics, "driveline_temperature", Some(rival))];
        assert_eq!(doubtful(&oil(LAW), 9.0), [["driveline_temperature"]]);
        assert!(doubtful(&oil(LAW), 3.0).is_empty() && doubtful(&oil("rolling_temperature"), 9.0).is_empty());
        // One look without a map is enough.
        assert_eq!(doubtful(&[finding(Physics, MAP, Some(LAW))], 9.0), [[MAP]]);
    }

    /// What went with the pressure of the tyres was told as the ground of nine roads, with 55 times the noise left in two others.
    #[test]
    fn maps_that_go_by_either_name_and_leave_much_are_doubted_together() {
        let map = |id: &str, rival: &str| [finding(Physics, id, Some(rival))];
        assert_eq!(mapped(&map(SLOPES, MAP), 9.0).unwrap(), [MAP, SLOPES]);
        assert_eq!(mapped(&map(MAP, SLOPES), 9.0).unwrap(), [MAP, SLOPES]);
        assert!(mapped(&map(SLOPES, MAP), 3.0).is_none());
        assert!(mapped(&[finding(Physics, SLOPES, None)], 9.0).is_none());
    }

    /// A lug of 12 kN was told as a late speed, a wave that fades with time and slopes.
    #[test]
    fn a_late_speed_beside_physics_that_leaves_much_is_doubted() {
        let beside = || [finding(Artefact, LATE, None), finding(Physics, "grade", None)];
        assert_eq!(doubtful(&beside(), 6.2), [[LATE, CLOCK]]);
        assert!(doubtful(&beside(), 3.0).is_empty());
    }

    /// A load that was put on once is one number.
    #[test]
    fn a_course_of_a_load_that_leaves_much_is_doubted() {
        let load = |parameter: &str| {
            let mut load = finding(Physics, LOAD, None);
            load.parameters = vec![ParameterReport {
                name: parameter.to_owned(),
                value: 900.0,
                ci95: [800.0, 1000.0],
                unit: "kg".to_owned(),
            }];
            [load]
        };
        assert_eq!(doubtful(&load("mass_kg_rms"), 9.0), [[LOAD]]);
        assert!(doubtful(&load("mass_kg_rms"), 3.0).is_empty() && doubtful(&load("mass_kg"), 9.0).is_empty());
    }

    /// A sensor at fault by itself is one, and beside physics it may be what no listed cause said.
    #[test]
    fn a_scale_beside_physics_is_looked_at_once_more() {
        for scale in SCALES {
            let own = || finding(Artefact, scale, None);
            assert_eq!(doubtful(&[own(), finding(Physics, "rolling_speed_law", None)], 1.0), [[scale]]);
            assert!(doubtful(&[own(), finding(Artefact, "quantisation", None)], 1.0).is_empty());
            // What is in proportion to something else than the speed is no scale of it.
            assert_eq!(doubtful(&[own()], 9.0), [[scale]]);
        }
        // Fewer causes have to be some, and leave no more, or hardly more where the fitted runs tell of them.
        let is_plainer = |one: (usize, f64, f64), other: (usize, f64, f64)| {
            is_plainer((one.0, [one.1, one.2]), (other.0, [other.1, other.2]))
        };
        let first = (3, 0.078, 0.040);
        assert!(is_plainer((2, 0.070, 0.045), first) && !is_plainer((3, 0.070, 0.030), first));
        assert!(!is_plainer((0, 0.070, 0.030), first) && !is_plainer((2, 0.080, 0.040), first));
        assert!(is_plainer((2, 0.085, 0.030), first) && !is_plainer((2, 0.095, 0.010), first));
    }
}
