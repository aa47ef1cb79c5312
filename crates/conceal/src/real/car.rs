//! BMW i3: heater and air conditioning, slopes, load and cold.

use super::pose::{Said, diagnose, write};
use super::signal::{blocks, mean, median, onto, paired, short, slope, spread};
use super::table::Table;
use super::{Figure, Options, Row};
use crate::error::ConcealError;
use crate::score::correlation;
use std::fmt::Write;

const SET: &str = "bmw_i3";
/// Means over so long are compared [s].
const BLOCK_S: f64 = 10.0;
const GRAVITY_M_S2: f64 = 9.806_65;
/// Motor to wheels, and the radius that they roll on [m]: general knowledge, a few per cent uncertain.
const REDUCTION: f64 = 9.665;
const RADIUS_M: f64 = 0.35;

/// What was measured on a trip and withheld, beside the speed.
struct Trip {
    name: String,
    winter: bool,
    time_s: Vec<f64>,
    speed_m_s: Vec<f64>,
    auxiliaries_w: Vec<f64>,
    acceleration_m_s2: Vec<f64>,
    ambient_c: Vec<f64>,
    /// What the battery gives beyond torque times speed of the motor [W].
    surplus_w: Vec<f64>,
    note: String,
}

pub fn rows(options: &Options) -> Result<Vec<Row>, ConcealError> {
    let given = options.scenarios.join("recordings/bmw_i3.ron");
    let text =
        std::fs::read_to_string(&given).map_err(|source| ConcealError::File { path: given, source })?;
    // Each trip is its own road: that trips of one road agree shall be found out, not put in.
    let own_roads = text.replace(", path: \"FTM route\"", "");
    let recording = write(options, SET, "recording.ron", &own_roads)?;
    let said = diagnose(options, SET, &options.scenarios.join("bmw_i3.ron"), &recording, &[])?;
    let load = loaded(options, &said, &own_roads)?;
    let trips = trips(options)?;
    Ok(vec![
        heater(&said, &trips),
        stale(&said, &trips),
        road(&said, &trips),
        payload(load, &said),
        cold(&said, &trips),
    ])
}

fn trips(options: &Options) -> Result<Vec<Trip>, ConcealError> {
    /// The heater takes at most some 7 kW: what is logged above is no power.
    const MOST_KW: f64 = 8.0;
    let folder = options.recordings.join(SET);
    let overview = Table::read(&folder.join("truth/overview.csv"))?;
    let names = overview.text("Trip").unwrap_or_default();
    let notes = overview.text("Note").unwrap_or_default();
    let mut trips = Vec::new();
    for (index, name) in names.iter().filter(|name| name.starts_with("Trip")).enumerate() {
        let file = format!("{name}.csv.gz");
        let (given, truth) = (folder.join("given").join(&file), folder.join("truth").join(&file));
        if !truth.is_file() {
            continue;
        }
        let (seen, hidden) = (Table::read(&given)?, Table::read(&truth)?);
        let heater = hidden.need(&truth, "Heating Power CAN [kW]")?;
        let cooler = hidden.need(&truth, "AirCon Power [kW]")?;
        let sum = |(heater, cooler): (&f64, &f64)| {
            if *heater < MOST_KW { 1000.0 * (heater + cooler) } else { f64::NAN }
        };
        let speed_m_s: Vec<f64> = seen.need(&given, "Velocity")?.iter().map(|speed| speed / 3.6).collect();
        let channel = |name: &str| seen.need(&given, name);
        let (voltage, current) = (channel("Battery Voltage")?, channel("Battery Current")?);
        let torque = channel("Motor Torque")?;
        let beyond = |index: usize| {
            -voltage[index] * current[index] - torque[index] * REDUCTION / RADIUS_M * speed_m_s[index]
        };
        trips.push(Trip {
            surplus_w: (0..speed_m_s.len()).map(beyond).collect(),
            name: (*name).to_owned(),
            winter: name.starts_with("TripB"),
            time_s: seen.need(&given, "Time [s]")?,
            speed_m_s,
            ambient_c: seen.need(&given, "Ambient Temperature")?,
            auxiliaries_w: heater.iter().zip(&cooler).map(sum).collect(),
            acceleration_m_s2: hidden.need(&truth, "Longitudinal Acceleration")?,
            note: notes.get(index).copied().unwrap_or_default().trim().to_owned(),
        });
    }
    Ok(trips)
}

/// What the tool says that auxiliaries take [W], at the times of a trip.
fn auxiliaries(said: &Said, trip: &Trip) -> Option<Vec<f64>> {
    let (time_s, power) = said.series(&trip.name, &["auxiliary_power_w", "auxiliary_power_2_w"])?;
    Some(onto(&time_s, &power, &trip.time_s))
}

fn heater(said: &Said, trips: &[Trip]) -> Row {
    /// Trips in which the power spreads less tell nothing about slope [W].
    const VARIES_W: f64 = 500.0;
    let mut row = said.row(SET, "heater and air conditioning, winter trips: power taken from the battery");
    let mut text = "| trip | spread of the measured power W | correlation | slope | mean measured W | mean reconstructed W |\n|---|---|---|---|---|---|\n".to_owned();
    let (mut correlations, mut slopes, mut wanted) = (Vec::new(), Vec::new(), 0usize);
    for trip in trips.iter().filter(|trip| trip.winter) {
        wanted += 1;
        let Some(power) = auxiliaries(said, trip) else {
            let _ = writeln!(text, "| {} | - | - | - | - | not reconstructed |", trip.name);
            continue;
        };
        let all = blocks(&trip.time_s, BLOCK_S);
        let (truth, told) =
            paired(all.iter().map(|block| (mean(&trip.auxiliaries_w, block), mean(&power, block))));
        let (r, b) = (correlation(&truth, &told), slope(&truth, &told));
        let varies = spread(&truth) > VARIES_W;
        correlations.push(if r.is_finite() { r } else { 0.0 });
        if varies {
            slopes.push(if b.is_finite() { b } else { 0.0 });
        }
        let average = |values: &[f64]| short(values.iter().sum::<f64>() / values.len() as f64);
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} |",
            trip.name,
            short(spread(&truth)),
            short(r),
            if varies { short(b) } else { format!("({})", short(b)) },
            average(&truth),
            average(&told)
        );
    }
    let named = said.found_or_first("auxiliary_power");
    row.figures.push(Figure::goal("an electrical load is named", yes(named), "yes", named));
    row.figures.push(Figure::goal(
        "winter trips with a reconstruction",
        format!("{} of {wanted}", correlations.len()),
        "all",
        correlations.len() == wanted,
    ));
    let r = median(&correlations);
    row.figures.push(Figure::goal("median correlation at 10 s", short(r), "≥ 0.985", r >= 0.985));
    let b = median(&slopes);
    let what = format!("median slope, {} trips that vary by more than 0.5 kW", slopes.len());
    row.figures.push(Figure::goal(&what, short(b), "0.95 to 1.05", (0.95..=1.05).contains(&b)));
    text.push_str("\nSlopes in parentheses are of trips that vary less. Logged heater powers above 8 kW are no power and left out.\n");
    row.details = text;
    row
}

fn stale(said: &Said, trips: &[Trip]) -> Row {
    /// The plateau of the stale channel [W].
    const PLATEAU_W: f64 = 5520.0;
    let mut row = said
        .row(SET, "nothing: summer trips whose logged heater stands at 5.52 kW that the battery never gave");
    let mut text = "| trip | greatest reconstructed load, 10 s mean, W | battery beyond the motor's torque × speed, the same 10 s, W |\n|---|---|---|\n".to_owned();
    let (mut most, mut known) = (f64::NEG_INFINITY, 0usize);
    for trip in trips.iter().filter(|trip| !trip.winter) {
        if let Some(power) = auxiliaries(said, trip) {
            let means = blocks(&trip.time_s, BLOCK_S).into_iter();
            let means = means.map(|block| (mean(&power, &block), mean(&trip.surplus_w, &block)));
            let greatest =
                means.filter(|(told, _)| told.is_finite()).max_by(|one, other| one.0.total_cmp(&other.0));
            let Some((top, surplus)) = greatest else { continue };
            most = most.max(top);
            known += 1;
            let _ = writeln!(text, "| {} | {} | {} |", trip.name, short(top), short(surplus));
        }
    }
    let fine = said.diagnosis.is_some() && (known == 0 || most < 0.8 * PLATEAU_W);
    let value = if known == 0 { "none claimed".to_owned() } else { format!("{} W at most", short(most)) };
    row.figures.push(Figure::goal("load claimed in summer trips", value, "below 4.4 kW", fine));
    text.push_str("\nWhat the battery gives beyond the motor holds the losses of the drive and all that is switched on, whatever the heater's channel says.\n");
    row.details = text;
    row
}

/// Slope that the tool gives a trip, at its times.
fn grades(said: &Said, trip: &Trip) -> Option<Vec<f64>> {
    /// A mass that only scales: correlations do not know it [kg].
    const MASS_KG: f64 = 1345.0;
    let columns = ["grade_n", "grade_constant_n", "soft_ground_n"];
    let (time_s, force) = said.series(&trip.name, &columns)?;
    let force = onto(&time_s, &force, &trip.time_s);
    Some(force.iter().map(|force| -force / (MASS_KG * GRAVITY_M_S2)).collect())
}

fn road(said: &Said, trips: &[Trip]) -> Row {
    /// Slower than this it is not moving [m/s].
    const MOVING_M_S: f64 = 2.0;
    /// Beyond this friction brakes act [m/s²].
    const BRAKED_M_S2: f64 = -0.6;
    /// Step over which braking is looked for [samples at 10 Hz].
    const STEP: usize = 10;
    let mut row = said.row(SET, "slope of the road, from speed and motor torque");
    let mut text = "| trip | blocks | correlation | spread measured % | spread reconstructed % |\n|---|---|---|---|---|\n".to_owned();
    let mut all = Vec::new();
    for trip in trips {
        let Some(grade) = grades(said, trip) else {
            let _ = writeln!(text, "| {} | - | not reconstructed | - | - |", trip.name);
            continue;
        };
        let of_block = |block: std::ops::Range<usize>| {
            let (from, to) = (block.start, block.end - 1);
            let moving = trip.speed_m_s[block.clone()].iter().all(|speed| *speed > MOVING_M_S);
            let braked = (from..to.saturating_sub(STEP)).any(|index| {
                let time = trip.time_s[index + STEP] - trip.time_s[index];
                trip.speed_m_s[index + STEP] - trip.speed_m_s[index] < BRAKED_M_S2 * time
            });
            if !moving || braked {
                return (f64::NAN, f64::NAN);
            }
            let made = (trip.speed_m_s[to] - trip.speed_m_s[from]) / (trip.time_s[to] - trip.time_s[from]);
            ((mean(&trip.acceleration_m_s2, &block) - made) / GRAVITY_M_S2, mean(&grade, &block))
        };
        let (truth, told) = paired(blocks(&trip.time_s, BLOCK_S).into_iter().map(of_block));
        let r = correlation(&truth, &told);
        let r = if r.is_finite() { r } else { 0.0 };
        all.push(r);
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} |",
            trip.name,
            truth.len(),
            short(r),
            short(100.0 * spread(&truth)),
            short(100.0 * spread(&told))
        );
    }
    let named = said.found("grade");
    let first = said.found_or_first("grade");
    row.figures.push(Figure::goal(
        "grade is named, or first among what cannot be told from it",
        if named {
            "named"
        } else if first {
            "first alternative"
        } else {
            "no"
        }
        .to_owned(),
        "yes",
        first,
    ));
    let braking = said.found("braking");
    row.figures.push(Figure::goal("unlogged brakes are named", yes(braking), "yes", braking));
    let r = median(&all);
    row.figures.push(Figure::goal(
        "median correlation at 10 s, moving and not braking",
        short(r),
        "≥ 0.93",
        r >= 0.93,
    ));
    let good = all.iter().filter(|r| **r >= 0.85).count();
    row.figures.push(Figure::goal(
        "trips with at least 0.85",
        format!("{good} of {}", trips.len()),
        "9 of 10",
        10 * good >= 9 * trips.len(),
    ));
    let agree = agreement(said, trips, &mut text);
    row.figures.push(Figure::told(
        "median correlation between trips of one road (FTMRoute), 100 m stretches",
        short(agree),
    ));
    row.details = text;
    row
}

/// How the slopes of different trips on one road agree, at the best shift of the start.
fn agreement(said: &Said, trips: &[Trip], text: &mut String) -> f64 {
    const ROAD: [&str; 4] = ["TripB02", "TripB03", "TripB16", "TripB28"];
    const STRETCH_M: f64 = 100.0;
    /// Starts lie at most so many stretches apart.
    const SHIFTS: i32 = 10;
    let stretches = |name: &str| -> Option<Vec<f64>> {
        let trip = trips.iter().find(|trip| trip.name == name)?;
        let grade = grades(said, trip)?;
        let mut sums: Vec<(f64, f64)> = Vec::new();
        let mut far = 0.0;
        for (index, value) in grade.iter().enumerate().skip(1) {
            far += trip.speed_m_s[index] * (trip.time_s[index] - trip.time_s[index - 1]);
            // A place on a road of some tens of kilometres.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small and positive")]
            let place = (far / STRETCH_M) as usize;
            sums.resize(sums.len().max(place + 1), (0.0, 0.0));
            if trip.speed_m_s[index] > 1.0 && value.is_finite() {
                sums[place] = (sums[place].0 + value, sums[place].1 + 1.0);
            }
        }
        Some(sums.into_iter().map(|(sum, count)| sum / count).collect())
    };
    let roads: Vec<(&str, Vec<f64>)> =
        ROAD.iter().filter_map(|name| Some((*name, stretches(name)?))).collect();
    let mut all = Vec::new();
    text.push_str(
        "\n| trips of one road | correlation of slope, 100 m stretches | shift m |\n|---|---|---|\n",
    );
    for (index, (one, first)) in roads.iter().enumerate() {
        for (other, second) in &roads[index + 1..] {
            let of = |shift: i32| {
                let moved = |place: usize| {
                    let place = i32::try_from(place).ok()? + shift;
                    second.get(usize::try_from(place).ok()?).copied()
                };
                let pairs =
                    first.iter().enumerate().map(|(place, value)| (*value, moved(place).unwrap_or(f64::NAN)));
                let (a, b) = paired(pairs);
                (correlation(&a, &b), shift)
            };
            let best =
                (-SHIFTS..=SHIFTS).map(of).filter(|(r, _)| r.is_finite()).max_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((r, shift)) = best {
                all.push(r);
                let _ =
                    writeln!(text, "| {one} and {other} | {} | {} |", short(r), f64::from(shift) * STRETCH_M);
            }
        }
    }
    median(&all)
}

/// The trip with most load, held against the car as all trips left it, without the slopes and consumers of any of them.
fn loaded(options: &Options, said: &Said, recording: &str) -> Result<Option<Said>, ConcealError> {
    let [car, first] = ["scenario_elsewhere.ron", "scenario.ron"].map(|name| said.out.join(name));
    let improved = if car.is_file() { car } else { first };
    if !improved.is_file() {
        return Ok(None);
    }
    let alone: Vec<&str> =
        recording.lines().filter(|line| !line.contains("(id: ") || line.contains("TripB33")).collect();
    let path = write(options, "bmw_i3_load", "recording.ron", &alone.join("\n"))?;
    // The mass that the tool found is what the trip is held against, so the one that the recording knows is left out.
    let text: Vec<&str> = alone.into_iter().filter(|line| !line.contains("name: \"mass_kg\"")).collect();
    std::fs::write(&path, text.join("\n"))
        .map_err(|source| ConcealError::File { path: path.clone(), source })?;
    diagnose(options, "bmw_i3_load", &improved, &path, &[]).map(Some)
}

fn payload(load: Option<Said>, base: &Said) -> Row {
    /// What was written down for the trip [kg].
    const LOAD_KG: f64 = 160.0;
    let concealed =
        "load of +160 kg on TripB33, held against the scenario that the diagnosis of all trips wrote";
    let Some(said) = load else {
        return Row { said: "not posed".to_owned(), answer: base.answer.clone(), ..base.row(SET, concealed) };
    };
    let mut row = said.row(SET, concealed);
    let before = base.calibrated("mass_kg").or(base.calibrated("vehicle.mass_kg"));
    let moved = said.calibrated("mass_kg").or(said.calibrated("vehicle.mass_kg"));
    let effect =
        said.findings().iter().find(|finding| finding.id == "mass" || finding.id == "payload_change");
    let found = effect.and_then(|finding| finding.parameters.first()).and_then(|parameter| {
        let [low, high] = parameter.ci95?;
        Some((parameter.value?, low?, high?))
    });
    let told = found.or_else(|| {
        let ((base, _), (mass, [low, high])) = (before?, moved?);
        Some((mass - base, low - base, high - base))
    });
    match told {
        Some((mass, low, high)) => row.figures.push(Figure::goal(
            "more mass than in the other trips, kg",
            format!("{} ({} to {})", short(mass), short(low), short(high)),
            "interval covers 160 and not 0",
            low <= LOAD_KG && LOAD_KG <= high && !(low <= 0.0 && 0.0 <= high),
        )),
        None => row.figures.push(Figure::goal(
            "more mass, kg",
            "not told".to_owned(),
            "interval covers 160",
            false,
        )),
    }
    row
}

fn cold(said: &Said, trips: &[Trip]) -> Row {
    let mut row =
        said.row(SET, "rolling resistance rises as it gets colder, about 3.5 N per K of ambient temperature");
    let columns = ["rolling_temperature_n", "driveline_temperature_n", "rolling_resistance_n"];
    let means = trips.iter().filter_map(|trip| {
        let (time_s, force) = said.series(&trip.name, &columns)?;
        let force = onto(&time_s, &force, &trip.time_s);
        let driven: Vec<f64> = force
            .iter()
            .zip(&trip.speed_m_s)
            .filter(|(force, speed)| force.is_finite() && **speed > 2.0)
            .map(|(f, _)| *f)
            .collect();
        let ambient: Vec<f64> = trip.ambient_c.iter().copied().filter(|value| value.is_finite()).collect();
        let average = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        Some((average(&ambient), -average(&driven)))
    });
    let (ambient, resistance) = paired(means);
    let b = slope(&ambient, &resistance);
    let named = said.found("rolling_temperature");
    row.figures.push(Figure::goal("a resistance that rises with cold is named", yes(named), "yes", named));
    row.figures.push(Figure::goal(
        "resistance over temperature, N/K",
        short(b),
        "negative, some −3.5",
        b < 0.0,
    ));
    let loads: Vec<String> = trips
        .iter()
        .filter(|trip| trip.note.contains("kg"))
        .map(|trip| format!("{} {}", trip.name, trip.note))
        .collect();
    row.details = format!("Loads written down: {}.\n", loads.join(", "));
    row
}

fn yes(whether: bool) -> String {
    if whether { "yes" } else { "no" }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_trace::{Origin, Run, Trace};

    /// A winter trip of 600 s at 10 Hz whose heater is switched between 1 and 4 kW every 100 s.
    fn trip() -> Trip {
        let time_s: Vec<f64> = (0..6000).map(|index| 0.1 * f64::from(index)).collect();
        let power = |time: &f64| if (time / 100.0).floor() % 2.0 == 0.0 { 1000.0 } else { 4000.0 };
        Trip {
            name: "TripB05".to_owned(),
            winter: true,
            speed_m_s: vec![10.0; 6000],
            auxiliaries_w: time_s.iter().map(power).collect(),
            acceleration_m_s2: vec![0.0; 6000],
            surplus_w: vec![1500.0; 6000],
            ambient_c: vec![5.0; 6000],
            note: String::new(),
            time_s,
        }
    }

    fn told(trip: &Trip, share: f64) -> Said {
        let mut trace = Trace::new(trip.time_s.clone()).unwrap();
        let power = trip.auxiliaries_w.iter().map(|power| 300.0 + share * power).collect();
        trace.push("auxiliary_power_w", power, Origin::Predicted).unwrap();
        Said {
            diagnosis: None,
            answer: String::new(),
            effects: vec![Run { id: trip.name.clone(), trace }],
            wall_s: 0.0,
            out: std::path::PathBuf::new(),
        }
    }

    #[test]
    fn a_heater_that_is_told_half_as_strong_correlates_and_misses_the_slope() {
        let trip = trip();
        let met = |share: f64| -> Vec<Option<bool>> {
            let row = heater(&told(&trip, share), std::slice::from_ref(&trip));
            row.figures.iter().map(|figure| figure.met).collect()
        };
        // Named, reconstructed in all, correlation, slope.
        assert_eq!(met(1.0), [Some(false), Some(true), Some(true), Some(true)]);
        assert_eq!(met(0.5), [Some(false), Some(true), Some(true), Some(false)]);
    }

    #[test]
    fn a_load_of_the_stale_channels_size_is_told_in_summer() {
        let mut summer = trip();
        summer.winter = false;
        let row = stale(&told(&summer, 2.0), std::slice::from_ref(&summer));
        assert_eq!(row.figures[0].met, Some(false));
        assert!(row.figures[0].value.starts_with("8300 W"));
    }
}
