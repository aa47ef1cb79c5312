//! What a coast-down analysis needs, from a recording and from the command line.

use crate::block;
use crate::failure::Failure;
use headland_calibrate::coastdown::{CoastRun, Constant, SpeedUnit};
use headland_plugin::closest;
use headland_recording::{RecordedRun, Recording};
use headland_trace::{Origin, Trace};
use headland_units::{Unit, parse_quantity, unit_of_name};

/// Constants that an analysis knows what to do with.
const CONSTANTS: [&str; 4] = ["mass_kg", "rotating_mass_kg", "drag_area_m2", "air_density_kg_m3"];
/// Channels that may be given as one number for a whole run.
const CHANNELS: [&str; 4] = ["heading_rad", "wind_speed_m_s", "wind_direction_rad", "grade"];

/// `NAME=VALUE` of the command line.
#[derive(Clone, Debug)]
pub struct Given {
    name: String,
    constant: Constant,
}

/// The runs of a study, and what had to be assumed for it.
#[derive(Debug)]
pub struct StudyInput {
    /// The runs.
    pub runs: Vec<CoastRun>,
    /// One sentence for each thing that nobody stated.
    pub assumed: Vec<String>,
}

/// Reads `mass_kg=13019.3`, `mass_kg=13.02 t`, `mass_kg=13.02 t+-65 kg`.
pub fn given(text: &str) -> Result<Given, Failure> {
    let refuse = |reason: String| {
        Failure::Input(format!(
            "--known {text}: {reason}; expected NAME=VALUE, as in mass_kg=13019.3 or mass_kg=13.02t+-65kg"
        ))
    };
    let (name, value) = text.split_once('=').ok_or_else(|| refuse("there is no `=`".to_owned()))?;
    let name = name.trim();
    let known: Vec<&str> = CONSTANTS.into_iter().chain(CHANNELS).collect();
    if !known.contains(&name) {
        let hint = closest(name, &known).map_or(String::new(), |name| format!("; did you mean `{name}`?"));
        return Err(refuse(format!("nothing is named `{name}`{hint} known: {}", known.join(", "))));
    }
    let (value, sd) = value.split_once("+-").or_else(|| value.split_once('±')).unwrap_or((value, "0"));
    let number = |text: &str| amount(name, text.trim()).map_err(&refuse);
    Ok(Given { name: name.to_owned(), constant: Constant::new(number(value)?, number(sd)?) })
}

fn amount(name: &str, text: &str) -> Result<f64, String> {
    if let Ok(value) = text.parse::<f64>() {
        return if value.is_finite() { Ok(value) } else { Err(format!("`{text}` is no finite number")) };
    }
    let unit: Unit = unit_of_name(name).ok_or_else(|| format!("`{text}` is no number"))?;
    parse_quantity(text, &unit).map_err(|error| error.to_string())
}

/// Reads the unit of v in c_w (1 + v/100).
pub fn speed_unit(text: &str) -> Result<SpeedUnit, Failure> {
    SpeedUnit::ALL.into_iter().find(|unit| unit.symbol() == text).ok_or_else(|| {
        let all = SpeedUnit::ALL.map(SpeedUnit::symbol).join(", ");
        Failure::Input(format!("--speed-unit is `{text}`, expected one of {all}"))
    })
}

impl StudyInput {
    /// Takes the runs that are not held out.
    pub fn new(recording: &Recording, given: &[Given]) -> Result<Self, Failure> {
        let mut assumed = Vec::new();
        let mut runs = Vec::new();
        for run in recording.runs.iter().filter(|run| !run.held_out) {
            runs.push(coast_run(recording, run, given, &mut assumed)?);
        }
        if runs.is_empty() {
            return Err(Failure::Input(format!(
                "every run of {} is held out, expected at least one to analyse",
                recording.path.display()
            )));
        }
        let held_out: Vec<&str> =
            recording.runs.iter().filter(|run| run.held_out).map(|run| run.id.as_str()).collect();
        if !held_out.is_empty() {
            assumed.push(format!("held out and not used: {}", held_out.join(", ")));
        }
        Ok(Self { runs, assumed })
    }
}

fn coast_run(
    recording: &Recording,
    run: &RecordedRun,
    given: &[Given],
    assumed: &mut Vec<String>,
) -> Result<CoastRun, Failure> {
    let constant = |name: &str| {
        let of_line = given.iter().rev().find(|one| one.name == name).map(|one| one.constant);
        let of_run = || run.known(name).map(|known| Constant::new(known.value, known.sd.unwrap_or(0.0)));
        of_line.or_else(of_run)
    };
    let mass_kg = constant("mass_kg").ok_or_else(|| {
        Failure::Input(format!(
            "run `{}`: the mass of the vehicle is not known\n  {}: add `known: [(name: \"mass_kg\", value: …, sd: …)]`, or \
             say --known mass_kg=…",
            run.id,
            recording.path.display()
        ))
    })?;
    let mut say_once = |text: &str| {
        if !assumed.iter().any(|said| said == text) {
            assumed.push(text.to_owned());
        }
    };
    if constant("rotating_mass_kg").is_none() {
        say_once(
            "`rotating_mass_kg` is not known: wheels and shafts count as nothing, which makes every resistance too small by their share of the mass",
        );
    }
    let (drag_area_m2, air_density_kg_m3) = (constant("drag_area_m2"), constant("air_density_kg_m3"));
    if drag_area_m2.is_none() || air_density_kg_m3.is_none() {
        say_once("`drag_area_m2` or `air_density_kg_m3` is not known: c_w holds the air drag too");
    }
    let mut trace = with_constants(&run.trace, constant)?;
    if block::is_fast(&trace) {
        say_once(&format!(
            "the logs are faster than a roll-out: means over {} s are analysed",
            block::BLOCK_S
        ));
        trace = block::means(&trace)?;
    }
    Ok(CoastRun {
        id: run.id.clone(),
        trace,
        path: run.path.clone(),
        reversed: run.reversed,
        mass_kg,
        rotating_mass_kg: constant("rotating_mass_kg").unwrap_or(Constant::exact(0.0)),
        drag_area_m2,
        air_density_kg_m3,
        heading_rad: None,
    })
}

/// The trace with the channels that are known as one number and were not logged.
fn with_constants(trace: &Trace, constant: impl Fn(&str) -> Option<Constant>) -> Result<Trace, Failure> {
    let mut trace = trace.clone();
    for name in CHANNELS {
        if trace.channel(name).is_none()
            && let Some(constant) = constant(name)
        {
            trace.push(name, vec![constant.value; trace.len()], Origin::Measured)?;
        }
    }
    Ok(trace)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_is_read_with_its_unit_and_its_spread() {
        let read = |text| given(text).map(|one| (one.constant.value, one.constant.sd));
        assert_eq!(read("mass_kg=250").unwrap(), (250.0, 0.0));
        assert_eq!(read("mass_kg = 13.02 t +- 65 kg").unwrap(), (13_020.0, 65.0));
        assert_eq!(read("drag_area_m2=6±0.5").unwrap(), (6.0, 0.5));
    }

    #[test]
    fn a_misspelt_constant_is_answered_with_its_name() {
        let error = given("mas_kg=1").unwrap_err().to_string();
        assert!(error.contains("did you mean `mass_kg`"), "{error}");
        assert!(given("mass_kg=3 km").unwrap_err().to_string().contains("km"));
        assert!(given("mass_kg").unwrap_err().to_string().contains("no `=`"));
    }

    #[test]
    fn a_unit_of_speed_that_the_law_is_not_found_with_is_refused() {
        assert_eq!(speed_unit("mph").unwrap(), SpeedUnit::MilesPerHour);
        assert!(speed_unit("kmh").unwrap_err().to_string().contains("km/h, mph, m/s"));
    }
}
