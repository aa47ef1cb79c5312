//! Runs that share a path, laid along it by where they were: places by satellite become a distance along the path.
//!
//! The longest run is the path: each of its points has the distance that it had driven. The others have that of the nearest
//! point, which is noisy, or what they drove themselves, which drifts; here it is the second, moved by the first averaged.
//! Where another begins before it or goes on behind it, the path goes on with that one; distances before the begin are below 0.

use headland_recording::RecordedRun;
use headland_sim::{local_fit, travelled};
use headland_trace::{Origin, Trace, TraceError};

/// Mean radius of the earth [m]. Source: IUGG, R₁ of GRS 80 (Moritz 2000).
const EARTH_RADIUS_M: f64 = 6_371_008.8;
/// Half of the time over which places are averaged along the path that the others are laid on, and along these [s].
const AVERAGED_S: f64 = 2.0;
const LAID_S: f64 = 8.0;
/// The path is drawn through points so far apart [m].
const APART_M: f64 = 2.0;
/// A run that is nearer to its last place on the path than this goes on there: paths may cross themselves [m].
const NEAR_M: f64 = 60.0;
/// What is further from the path is not on it [m].
const BESIDE_M: f64 = 40.0;

/// East and north of every sample [m].
type Track = Vec<[f64; 2]>;

/// What is said of runs that were laid.
pub fn told(laid: &[String]) -> Option<String> {
    (!laid.is_empty())
        .then(|| format!("In {} the distance along the path is made of where they were.", laid.join(", ")))
}

/// Gives runs without a position the distance along the path that they share, where all of its runs know where they were.
/// The runs that were laid.
///
/// # Errors
/// [`TraceError`]: a bug.
pub fn lay(runs: &mut [RecordedRun]) -> Result<Vec<String>, TraceError> {
    let mut laid = Vec::new();
    let mut paths: Vec<String> = runs.iter().filter_map(|run| run.path.clone()).collect();
    paths.sort_unstable();
    paths.dedup();
    for path in paths {
        let own: Vec<usize> = (0..runs.len()).filter(|run| runs[*run].path.as_ref() == Some(&path)).collect();
        let origin = own.iter().find_map(|run| first_place(&runs[*run].trace));
        let tracks: Option<Vec<Track>> = own
            .iter()
            .map(|run| {
                let trace = &runs[*run].trace;
                if trace.get("position_m").is_some() { None } else { track(trace, origin) }
            })
            .collect();
        let Some(tracks) = tracks.filter(|tracks| tracks.len() > 1) else { continue };
        let driven: Vec<Vec<f64>> = own.iter().map(|run| driven(&runs[*run].trace)).collect();
        let length = |place: usize| driven[place].last().copied().unwrap_or(0.0);
        let Some(longest) = (0..own.len()).max_by(|one, other| length(*one).total_cmp(&length(*other)))
        else {
            continue;
        };
        let reversed = |place: usize| runs[own[place]].reversed;
        let mut path = Path::new(&tracks[longest], &driven[longest], reversed(longest));
        let mut positions: Vec<Option<Vec<f64>>> = vec![None; own.len()];
        // A run that does not meet the path as it is so far may meet it once another was laid.
        loop {
            let before = positions.iter().flatten().count();
            for place in (0..own.len()).filter(|place| positions[*place].is_none()).collect::<Vec<_>>() {
                let time_s = runs[own[place]].trace.time_s();
                let along = path.along(time_s, &tracks[place], &driven[place], reversed(place));
                if let Some(along) = &along {
                    path.go_on(&tracks[place], along);
                }
                positions[place] = along;
            }
            if positions.iter().flatten().count() == before {
                break;
            }
        }
        let Some(positions) = positions.into_iter().collect::<Option<Vec<Vec<f64>>>>() else { continue };
        for (run, position) in own.iter().zip(positions) {
            runs[*run].trace.push("position_m", position, Origin::Measured)?;
            laid.push(runs[*run].id.clone());
        }
    }
    Ok(laid)
}

/// Distance that a run drove [m].
fn driven(trace: &Trace) -> Vec<f64> {
    let speed = trace.get("speed_m_s").or_else(|| trace.get("wheel_speed_m_s")).unwrap_or(&[]);
    if speed.is_empty() { vec![0.0; trace.len()] } else { travelled(trace.time_s(), speed) }
}

/// Latitude and longitude of the first place that is known [rad].
pub fn first_place(trace: &Trace) -> Option<[f64; 2]> {
    let (latitude, longitude) = (trace.get("latitude_deg")?, trace.get("longitude_deg")?);
    let mut places = latitude.iter().zip(longitude);
    let (latitude, longitude) = places.find(|(one, other)| one.is_finite() && other.is_finite())?;
    Some([latitude.to_radians(), longitude.to_radians()])
}

/// East and north of a run [m], as they were recorded; none where it does not know.
pub fn places(trace: &Trace, origin: Option<[f64; 2]>) -> Option<(Vec<f64>, Vec<f64>)> {
    match (trace.get("east_m"), trace.get("north_m"), origin) {
        (Some(east), Some(north), _) => Some((east.to_vec(), north.to_vec())),
        (_, _, Some([latitude_0, longitude_0])) => {
            let (latitude, longitude) = (trace.get("latitude_deg")?, trace.get("longitude_deg")?);
            // Near the origin the earth is flat.
            let east = longitude
                .iter()
                .map(|one| EARTH_RADIUS_M * latitude_0.cos() * (one.to_radians() - longitude_0));
            let north = latitude.iter().map(|one| EARTH_RADIUS_M * (one.to_radians() - latitude_0));
            Some((east.collect(), north.collect()))
        }
        _ => None,
    }
}

/// Where a run was, averaged; none where it does not know.
fn track(trace: &Trace, origin: Option<[f64; 2]>) -> Option<Track> {
    let (east, north) = places(trace, origin)?;
    let averaged = |values: &[f64]| local_fit(trace.time_s(), values, AVERAGED_S).value;
    let track: Track = averaged(&east).into_iter().zip(averaged(&north)).map(|(e, n)| [e, n]).collect();
    track.iter().any(|place| place.iter().all(|one| one.is_finite())).then_some(track)
}

/// The path that runs are laid on: points with their distance along it.
struct Path {
    points: Vec<([f64; 2], f64)>,
}

impl Path {
    /// Through a run that drove so far at each sample, maybe from the end to the start.
    fn new(track: &Track, driven: &[f64], reversed: bool) -> Self {
        let whole = driven.last().copied().unwrap_or(0.0);
        let mut points: Vec<([f64; 2], f64)> = Vec::new();
        let mut last = f64::NEG_INFINITY;
        for (place, driven) in track.iter().zip(driven) {
            if place.iter().all(|one| one.is_finite()) && *driven >= last + APART_M {
                points.push((*place, if reversed { whole - driven } else { *driven }));
                last = *driven;
            }
        }
        Self { points }
    }

    /// Goes on with a run that lies so far along, where it reaches beyond the ends.
    fn go_on(&mut self, track: &Track, along: &[f64]) {
        let (Some((_, first)), Some((_, last))) = (self.points.first().copied(), self.points.last().copied())
        else {
            return;
        };
        let known = track.iter().zip(along).filter(|(place, _)| place.iter().all(|one| one.is_finite()));
        let beyond = known.filter(|(_, at)| **at < first - APART_M || **at > last + APART_M);
        let mut all = self.points.clone();
        all.extend(beyond.map(|(place, at)| (*place, *at)));
        all.sort_by(|one, other| one.1.total_cmp(&other.1));
        let mut before = f64::NEG_INFINITY;
        all.retain(|(_, at)| {
            let new = *at >= before + APART_M || (first..=last).contains(at);
            if new {
                before = *at;
            }
            new
        });
        self.points = all;
    }

    /// Distance along the path of the nearest point, near the point before where there was one; none beyond its ends.
    fn nearest(&self, place: [f64; 2], near: Option<f64>) -> Option<f64> {
        let among = |at: f64| near.is_none_or(|near| (at - near).abs() < NEAR_M);
        let mut best: Option<(f64, f64)> = None;
        let mut inside = false;
        for (number, pair) in self.points.windows(2).enumerate().filter(|(_, pair)| among(pair[0].1)) {
            let ((from, from_m), (to, to_m)) = (pair[0], pair[1]);
            let along = [to[0] - from[0], to[1] - from[1]];
            let square = along[0] * along[0] + along[1] * along[1];
            let product = (place[0] - from[0]) * along[0] + (place[1] - from[1]) * along[1];
            let whole = if square > 0.0 { product / square } else { 0.0 };
            let share = whole.clamp(0.0, 1.0);
            let away = (place[0] - from[0] - share * along[0]).hypot(place[1] - from[1] - share * along[1]);
            if away < BESIDE_M && best.is_none_or(|(other, _)| away < other) {
                best = Some((away, from_m + share * (to_m - from_m)));
                let (begins, ends) =
                    (number == 0 && whole < 0.0, number + 2 == self.points.len() && whole > 1.0);
                inside = !(begins || ends);
            }
        }
        best.filter(|_| inside).map(|(_, at)| at)
    }

    /// Distance along the path of every sample of a run; none where it never was on it.
    fn along(&self, time_s: &[f64], track: &Track, driven: &[f64], reversed: bool) -> Option<Vec<f64>> {
        let way = if reversed { -1.0 } else { 1.0 };
        let mut offset: Option<f64> = None;
        let offsets: Vec<f64> = track
            .iter()
            .zip(driven)
            .map(|(place, driven)| {
                let known = place.iter().all(|one| one.is_finite());
                let near = offset.map(|offset| offset + way * driven);
                let at = if known { self.nearest(*place, near) } else { None };
                let own = at.map(|at| at - way * driven);
                offset = own.or(offset);
                own.unwrap_or(f64::NAN)
            })
            .collect();
        offset?;
        let mut averaged = local_fit(time_s, &offsets, LAID_S).value;
        let first = averaged.iter().copied().find(|one| one.is_finite())?;
        let mut last = first;
        for one in &mut averaged {
            if one.is_finite() {
                last = *one;
            } else {
                *one = last;
            }
        }
        Some(averaged.iter().zip(driven).map(|(offset, driven)| offset + way * driven).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along an S of radius 200 m at 10 m/s; begun so far along it, maybe the other way, with an odometer that is off.
    fn run(id: &str, from_m: f64, reversed: bool, odometer: f64) -> RecordedRun {
        let time_s: Vec<f64> = (0..600).map(|index| 0.1 * f64::from(index)).collect();
        let at = |time_s: f64| if reversed { from_m - 10.0 * time_s } else { from_m + 10.0 * time_s };
        let radius_m = 200.0;
        let place = |along_m: f64| {
            let angle = along_m / radius_m;
            if angle < 2.0 {
                (radius_m * angle.sin(), radius_m * (1.0 - angle.cos()))
            } else {
                let (e, n) = (radius_m * 2f64.sin(), radius_m * (1.0 - 2f64.cos()));
                (e + (along_m - 400.0) * 2f64.cos(), n + (along_m - 400.0) * 2f64.sin())
            }
        };
        let noise = |index: usize| ((index * 7919) as f64).sin();
        let degrees = |m: f64| (m / EARTH_RADIUS_M).to_degrees();
        let mut trace = Trace::new(time_s.clone()).unwrap();
        let (mut latitude, mut longitude) = (Vec::new(), Vec::new());
        for (index, time_s) in time_s.iter().enumerate() {
            let (east, north) = place(at(*time_s));
            latitude.push(48.0 + degrees(north + noise(index)));
            longitude.push(11.0 + degrees(east + noise(index + 1)) / 48f64.to_radians().cos());
        }
        trace.push("latitude_deg", latitude, Origin::Measured).unwrap();
        trace.push("longitude_deg", longitude, Origin::Measured).unwrap();
        trace.push("speed_m_s", vec![10.0 * odometer; 600], Origin::Measured).unwrap();
        RecordedRun {
            id: id.to_owned(),
            trace,
            path: Some("lane".to_owned()),
            reversed,
            held_out: false,
            known: Vec::new(),
            sensors: Vec::new(),
        }
    }

    #[test]
    fn runs_that_begin_elsewhere_and_drive_the_other_way_lie_where_they_were() {
        let mut runs =
            [run("r1", 0.0, false, 1.0), run("r2", 60.0, false, 0.99), run("r3", 590.0, true, 0.98)];
        assert_eq!(lay(&mut runs).unwrap(), ["r1", "r2", "r3"]);
        let position = |run: usize, sample: usize| runs[run].trace.get("position_m").unwrap()[sample];
        for (run, sample, expected_m) in
            [(0, 300, 300.0), (1, 300, 360.0), (1, 20, 80.0), (2, 300, 290.0), (2, 20, 570.0)]
        {
            let found_m = position(run, sample);
            assert!((found_m - expected_m).abs() < 2.0, "{run} {sample}: {found_m}");
        }
    }

    /// Coast-downs to and fro on one lane share its middle: laid on one of them the others would stand still at its ends.
    #[test]
    fn runs_that_reach_beyond_the_longest_lie_beyond_its_ends() {
        let mut runs = [
            run("r1", 0.0, false, 1.0),
            run("r2", 300.0, false, 0.99),
            run("r3", 1100.0, true, 0.98),
            run("r4", -200.0, false, 0.99),
        ];
        assert_eq!(lay(&mut runs).unwrap(), ["r1", "r2", "r3", "r4"]);
        let position = |run: usize, sample: usize| runs[run].trace.get("position_m").unwrap()[sample];
        for (run, sample, expected_m) in [
            (1, 10, 310.0),
            (1, 590, 890.0),
            (2, 10, 1090.0),
            (2, 590, 510.0),
            (3, 10, -190.0),
            (3, 590, 390.0),
        ] {
            let found_m = position(run, sample);
            assert!((found_m - expected_m).abs() < 6.0, "{run} {sample}: {found_m}");
        }
    }

    #[test]
    fn a_run_that_does_not_know_where_it_was_leaves_the_path_as_it_is() {
        let mut runs = [run("r1", 0.0, false, 1.0), run("r2", 60.0, false, 1.0)];
        runs[1].trace.remove("latitude_deg");
        assert!(lay(&mut runs).unwrap().is_empty() && runs[0].trace.get("position_m").is_none());
    }
}
