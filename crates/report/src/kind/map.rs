//! A path seen from above, north up, equal scales.

use super::scatter::colour_spec;
use crate::draw::{BY_EXTREMES, Drawn, Scale, Thinned, same_length};
use crate::thin::extremes;
use crate::{Axis, Colour, ReportError};
use serde_json::{Value, json};

/// Steps of the path that are kept of a long one, for each of its coordinates.
const STEPS: usize = 300;

/// A part of the path that is set off.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Highlight {
    /// What it is.
    pub label: String,
    /// First sample.
    pub first: usize,
    /// Last sample, included.
    pub last: usize,
}

/// A path on the ground.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    /// Metres east of the origin.
    pub east_m: Vec<f64>,
    /// Metres north of the origin.
    pub north_m: Vec<f64>,
    /// What the colour of the path shows.
    pub colour: Option<Colour>,
    /// Direction of travel, clockwise from north, in radians, drawn as arrows along the path.
    pub heading_rad: Option<Vec<f64>>,
    /// Parts that are set off.
    pub highlights: Vec<Highlight>,
}

impl Map {
    pub(crate) fn draw(&self, plot: &str) -> Result<Drawn, ReportError> {
        let samples = self.east_m.len();
        same_length(plot, "path", "north", self.north_m.len(), samples)?;
        if let Some(colour) = &self.colour {
            same_length(plot, "path", "the colour", colour.values.len(), samples)?;
        }
        if let Some(heading) = &self.heading_rad {
            same_length(plot, "path", "the heading", heading.len(), samples)?;
        }
        // One scale for both axes: the prefix of the wider one.
        let both = Scale::new(&Axis::new("", "m"), self.east_m.iter().chain(&self.north_m).copied());
        let colour =
            self.colour.as_ref().map(|colour| Scale::new(&colour.axis, colour.values.iter().copied()));
        let kept = self.kept(0, samples);
        let mut thinned = Thinned::default();
        thinned.add("the path", kept.len(), samples);
        let mut notes: Vec<String> = thinned.note(BY_EXTREMES).into_iter().collect();
        let pick = |values: &[f64], kept: &[usize]| both.all(kept.iter().map(|at| values[*at]));
        let highlights: Vec<Value> = self
            .highlights
            .iter()
            .map(|highlight| {
                let end = (highlight.last + 1).min(samples);
                let kept = self.kept(highlight.first.min(end), end);
                json!({
                    "label": highlight.label,
                    "east": pick(&self.east_m, &kept),
                    "north": pick(&self.north_m, &kept),
                })
            })
            .collect();
        if !self.highlights.is_empty() {
            let labels: Vec<&str> = self.highlights.iter().map(|one| one.label.as_str()).collect();
            notes.push(format!("Set off on the path: {}.", labels.join("; ")));
        }
        let east = Scale::new(&Axis::new("east", "m"), self.east_m.iter().copied());
        let north = Scale::new(&Axis::new("north", "m"), self.north_m.iter().copied());
        let alt = format!(
            "Map of the path, north up: east {}, north {}{}.",
            east.words(),
            north.words(),
            colour
                .as_ref()
                .map(|c| format!(", coloured by {} {}", c.axis.label, c.words()))
                .unwrap_or_default()
        );
        let spec = json!({
            "kind": "map",
            "unit": both.axis.unit,
            "east": pick(&self.east_m, &kept),
            "north": pick(&self.north_m, &kept),
            "values": self.colour.as_ref().zip(colour.as_ref())
                .map(|(colour, scale)| scale.all(kept.iter().map(|at| colour.values[*at]))),
            "colour": colour.as_ref().map(colour_spec),
            "arrows": self.heading_rad.as_ref().map(|heading| self.arrows(heading, &both)),
            "highlights": highlights,
        });
        Ok(Drawn { spec, alt, notes })
    }

    /// Samples to draw of `from..to`.
    fn kept(&self, from: usize, to: usize) -> Vec<usize> {
        let order: Vec<f64> = (from..to).map(|at| at as f64).collect();
        let mut columns = vec![&self.east_m[from..to], &self.north_m[from..to]];
        columns.extend(self.colour.iter().map(|colour| &colour.values[from..to]));
        extremes(&order, &columns, STEPS).into_iter().map(|at| from + at).collect()
    }

    /// A dozen places along the path, with the heading there.
    fn arrows(&self, heading: &[f64], scale: &Scale) -> Value {
        let mut length = vec![0.0];
        for at in 1..self.east_m.len() {
            let step = (self.east_m[at] - self.east_m[at - 1]).hypot(self.north_m[at] - self.north_m[at - 1]);
            length.push(length[at - 1] + if step.is_finite() { step } else { 0.0 });
        }
        let whole = length.last().copied().unwrap_or(0.0);
        let arrows = (0..12).filter_map(|arrow| {
            let wanted = whole * (f64::from(arrow) + 0.5) / 12.0;
            let at = length.partition_point(|length| *length < wanted);
            let (east, north, heading) = (self.east_m.get(at)?, self.north_m.get(at)?, heading.get(at)?);
            (whole > 0.0 && east.is_finite() && north.is_finite() && heading.is_finite()).then(|| {
                json!([scale.one(*east), scale.one(*north), (heading.to_degrees() * 10.0).round() / 10.0])
            })
        });
        Value::Array(arrows.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_stand_at_equal_distances_and_point_along_the_path() {
        let map = Map {
            east_m: (0..=1200).map(f64::from).collect(),
            north_m: vec![0.0; 1201],
            heading_rad: Some(vec![std::f64::consts::FRAC_PI_2; 1201]),
            ..Map::default()
        };
        let drawn = map.draw("map").unwrap();
        let arrows = drawn.spec["arrows"].as_array().unwrap();
        assert_eq!(arrows.len(), 12);
        assert_eq!(arrows[0], json!([50, 0, 90.0]));
    }

    #[test]
    fn an_empty_path_and_a_highlight_past_its_end_are_no_trouble() {
        assert!(Map::default().draw("map").is_ok());
        let map = Map {
            east_m: vec![0.0, 1.0],
            north_m: vec![0.0, 1.0],
            highlights: vec![Highlight { label: "soft".to_owned(), first: 1, last: 9 }],
            ..Map::default()
        };
        assert_eq!(map.draw("map").unwrap().spec["highlights"][0]["east"], json!([1]));
    }
}
