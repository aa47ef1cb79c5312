//! A description, read from its file and checked for what needs no log.

use crate::describe::{ChannelDescription, Description, Format, KnownDescription, SensorDescription, Split};
use crate::places::Places;
use crate::words::{misspelt, reason};
use crate::{Known, Place, RecordingError};
use headland_units::stem;
use ron::extensions::Extensions;
use std::cmp::Ordering;
use std::fs;
use std::path::{Path, PathBuf};

/// A description and where its values stand.
pub(crate) struct Described {
    pub text: Description,
    places: Places,
    path: PathBuf,
}

impl Described {
    /// Reads and checks the description.
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        let at = Place::file(path);
        if path.is_dir() {
            return Err(RecordingError::Folder { at, path: path.to_owned() });
        }
        let bytes = fs::read(path).map_err(|source| RecordingError::File {
            at: at.clone(),
            path: path.to_owned(),
            source,
        })?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let before = &error.as_bytes()[..error.utf8_error().valid_up_to()];
            let line = before.split(|byte| *byte == b'\n').count();
            RecordingError::Encoding { at: Place::new(path, line, 0), encoding: "UTF-8" }
        })?;
        if text.trim().is_empty() {
            return Err(RecordingError::Empty { at, what: "the file is empty" });
        }
        let description: Description = ron::Options::default()
            .with_default_extension(Extensions::IMPLICIT_SOME)
            .from_str(&text)
            .map_err(|error| RecordingError::Description {
                at: Place::new(path, error.span.start.line, error.span.start.col),
                reason: reason(&error.code),
            })?;
        let described = Self { text: description, places: Places::of(&text), path: path.to_owned() };
        described.check()?;
        Ok(described)
    }

    /// The description's file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where the value of this path stands.
    pub fn at(&self, path: &str) -> Place {
        let (line, column) = self.places.find(path);
        Place::new(&self.path, line, column)
    }

    /// The channels of a run: its own, then the shared ones that it does not describe itself.
    pub fn channels(&self, run: usize) -> Vec<(ChannelDescription, Place)> {
        let place = |path: String, channel: &ChannelDescription| {
            let field = if channel.column.is_some() {
                "column"
            } else if channel.columns.is_some() {
                "columns"
            } else {
                "is"
            };
            self.at(&format!("{path}.{field}"))
        };
        let own = &self.text.runs[run].channels;
        let mut all: Vec<_> = own
            .iter()
            .enumerate()
            .map(|(index, channel)| {
                (channel.clone(), place(format!("runs[{run}].channels[{index}]"), channel))
            })
            .collect();
        for (index, channel) in self.text.channels.iter().enumerate() {
            if !own.iter().any(|other| other.is == channel.is) {
                all.push((channel.clone(), place(format!("channels[{index}]"), channel)));
            }
        }
        all
    }

    /// What is known of a run, or of all.
    pub fn known(&self, run: Option<usize>) -> Result<Vec<Known>, RecordingError> {
        let shared = self.amounts(&self.text.known, "known")?;
        let Some(run) = run else { return Ok(shared) };
        let mut own = self.amounts(&self.text.runs[run].known, &format!("runs[{run}].known"))?;
        for known in shared {
            if !own.iter().any(|other| other.name == known.name) {
                own.push(known);
            }
        }
        Ok(own)
    }

    fn amounts(&self, all: &[KnownDescription], path: &str) -> Result<Vec<Known>, RecordingError> {
        let mut found: Vec<Known> = Vec::new();
        for (index, known) in all.iter().enumerate() {
            let at = |field: &str| self.at(&format!("{path}[{index}].{field}"));
            if found.iter().any(|other| other.name == known.name) {
                return Err(RecordingError::Twice {
                    at: at("name"),
                    what: "the quantity",
                    name: known.name.clone(),
                });
            }
            let amount = |amount: &crate::describe::Amount, field: &str| {
                amount
                    .resolve(&known.name, field == "sd")
                    .map_err(|reason| RecordingError::Description { at: at(field), reason })
            };
            let value = amount(&known.value, "value")?;
            let sd = known.sd.as_ref().map(|sd| amount(sd, "sd")).transpose()?;
            let positive = stem(&known.name) == "mass" || stem(&known.name).ends_with("_mass");
            // Wheels that turn may be left out of a model; a vehicle without mass may not.
            let positive = positive && stem(&known.name) != "rotating_mass";
            if !value.is_finite() || (positive && value <= 0.0) {
                let expected = if positive { "more than 0" } else { "a number" };
                return Err(value_error(at("value"), &known.name, value, expected));
            }
            if let Some(sd) = sd
                && !(sd >= 0.0 && sd.is_finite())
            {
                return Err(value_error(at("sd"), "sd", sd, "a standard deviation of 0 or more"));
            }
            found.push(Known { name: known.name.clone(), value, sd });
        }
        Ok(found)
    }

    fn check(&self) -> Result<(), RecordingError> {
        if self.text.runs.is_empty() {
            return Err(value_error(self.at("runs"), "runs", f64::NAN, "at least one run").found("empty"));
        }
        for (index, run) in self.text.runs.iter().enumerate() {
            if run.id.trim().is_empty() {
                let at = self.at(&format!("runs[{index}].id"));
                return Err(value_error(at, "id", f64::NAN, "a name").found("empty"));
            }
            if self.text.runs[..index].iter().any(|other| other.id == run.id) {
                let at = self.at(&format!("runs[{index}].id"));
                return Err(RecordingError::Twice { at, what: "the run", name: run.id.clone() });
            }
            for (part, segment) in run.segments.iter().enumerate() {
                if segment.from_s.partial_cmp(&segment.to_s) != Some(Ordering::Less) {
                    let at = self.at(&format!("runs[{index}].segments[{part}].to_s"));
                    let expected = format!("more than from_s, {}", segment.from_s);
                    return Err(value_error(at, "to_s", segment.to_s, &expected));
                }
            }
            self.check_split(run.split.as_ref(), &format!("runs[{index}].split"))?;
            self.check_channels(&run.channels, &format!("runs[{index}].channels"))?;
            self.known(Some(index))?;
        }
        self.check_split(self.text.split.as_ref(), "split")?;
        self.check_channels(&self.text.channels, "channels")?;
        let unsupported = match self.text.format {
            Some(Format::Mdf4) => "mdf4",
            Some(Format::Candump { .. }) => "candump",
            _ => return Ok(()),
        };
        Err(RecordingError::Unsupported { at: self.at("format"), format: unsupported })
    }

    fn check_split(&self, split: Option<&Split>, path: &str) -> Result<(), RecordingError> {
        let Some(split) = split else { return Ok(()) };
        for (field, value) in [("speed_jump_m_s", split.speed_jump_m_s), ("gap_s", split.gap_s)] {
            if let Some(value) = value
                && (value.is_nan() || value <= 0.0)
            {
                return Err(value_error(self.at(&format!("{path}.{field}")), field, value, "more than 0"));
            }
        }
        match split.shortest_s {
            Some(value) if value.is_nan() || value < 0.0 => {
                Err(value_error(self.at(&format!("{path}.shortest_s")), "shortest_s", value, "0 or more"))
            }
            _ => Ok(()),
        }
    }

    fn check_channels(&self, channels: &[ChannelDescription], path: &str) -> Result<(), RecordingError> {
        for (index, channel) in channels.iter().enumerate() {
            let at = |field: &str| self.at(&format!("{path}[{index}].{field}"));
            if channels[..index].iter().any(|other| other.is == channel.is) {
                return Err(RecordingError::Twice {
                    at: at("is"),
                    what: "the channel",
                    name: channel.is.clone(),
                });
            }
            if let Some(suggestion) = misspelt(&channel.is) {
                return Err(RecordingError::Misspelt { at: at("is"), name: channel.is.clone(), suggestion });
            }
            if channel.column.is_some() && channel.columns.is_some() {
                let expected = "left out where `column` is given";
                return Err(
                    value_error(at("columns"), "columns", f64::NAN, expected).found("given beside `column`")
                );
            }
            let several = channel.columns.as_ref().map_or(1, Vec::len);
            if several == 0 || (several > 1 && channel.combine.is_none()) {
                let found = if several == 0 { "empty" } else { "left out" };
                let field = if several == 0 { "columns" } else { "combine" };
                let expected =
                    if several == 0 { "at least one column" } else { "mean or sum of the columns" };
                return Err(value_error(at(field), field, f64::NAN, expected).found(found));
            }
            for (field, value) in [
                ("scale", channel.scale),
                ("offset", channel.offset),
                ("radius_m", channel.radius_m),
                ("density_kg_m3", channel.density_kg_m3),
            ] {
                let positive = matches!(field, "radius_m" | "density_kg_m3");
                if let Some(value) = value
                    && (!value.is_finite()
                        || (field == "scale" && value == 0.0)
                        || (positive && value <= 0.0))
                {
                    let expected =
                        if positive { "more than 0" } else { "a number, for `scale` other than 0" };
                    return Err(value_error(at(field), field, value, expected));
                }
            }
            if let Some(sensor) = &channel.sensor {
                check_sensor(sensor, |field| at(&format!("sensor.{field}")))?;
            }
        }
        Ok(())
    }
}

fn check_sensor(sensor: &SensorDescription, at: impl Fn(&str) -> Place) -> Result<(), RecordingError> {
    for (field, value, fits, expected) in [
        (
            "noise",
            sensor.noise,
            sensor.noise.is_none_or(|noise| noise >= 0.0),
            "a standard deviation of 0 or more",
        ),
        ("latency_s", sensor.latency_s, true, "a number"),
        ("scale", sensor.scale, sensor.scale.is_none_or(|scale| scale != 0.0), "a number other than 0"),
        ("bias", sensor.bias, true, "a number"),
    ] {
        if let Some(value) = value
            && !(fits && value.is_finite())
        {
            return Err(value_error(at(field), field, value, expected));
        }
    }
    Ok(())
}

fn value_error(at: Place, field: &str, found: f64, expected: &str) -> RecordingError {
    RecordingError::Value {
        at,
        field: field.to_owned(),
        found: found.to_string(),
        expected: expected.to_owned(),
    }
}

impl RecordingError {
    /// The same with another word for what was found.
    fn found(mut self, word: &str) -> Self {
        if let Self::Value { found, .. } = &mut self {
            word.clone_into(found);
        }
        self
    }
}
