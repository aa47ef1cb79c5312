//! Points, coloured by a third value where there is one.

use crate::draw::{Drawn, Scale, Thinned, same_length};
use crate::thin::cloud;
use crate::{Axis, ReportError};
use serde_json::{Value, json};

/// The third value of each point, shown by its colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Colour {
    /// What it is.
    pub axis: Axis,
    /// One value a point.
    pub values: Vec<f64>,
}

/// Points that belong together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// Their name.
    pub name: String,
    /// Horizontal places.
    pub x: Vec<f64>,
    /// Vertical places.
    pub y: Vec<f64>,
    /// Third values.
    pub colour: Option<Colour>,
    /// Whether a line joins them, as it does a front; they then have no symbols of their own.
    pub joined: bool,
}

/// Points over two axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scatter {
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// The points. Colours, where there are any, share one scale: that of the first.
    pub clouds: Vec<Cloud>,
}

impl Scatter {
    pub(crate) fn draw(&self, plot: &str) -> Result<Drawn, ReportError> {
        for cloud in &self.clouds {
            same_length(plot, &cloud.name, "y", cloud.y.len(), cloud.x.len())?;
            if let Some(colour) = &cloud.colour {
                same_length(plot, &cloud.name, "the colour", colour.values.len(), cloud.x.len())?;
            }
        }
        let x = Scale::new(&self.x, self.clouds.iter().flat_map(|cloud| cloud.x.iter().copied()));
        let y = Scale::new(&self.y, self.clouds.iter().flat_map(|cloud| cloud.y.iter().copied()));
        let colours: Vec<&Colour> = self.clouds.iter().filter_map(|cloud| cloud.colour.as_ref()).collect();
        let colour = colours
            .first()
            .map(|first| Scale::new(&first.axis, colours.iter().flat_map(|c| c.values.iter().copied())));
        let mut thinned = Thinned::default();
        let clouds: Vec<Value> = self
            .clouds
            .iter()
            .map(|points| {
                let kept = cloud(&points.x, &points.y, 120, 60);
                thinned.add(&points.name, kept.len(), points.x.len());
                let pick = |values: &[f64], scale: &Scale| scale.all(kept.iter().map(|at| values[*at]));
                let third = points.colour.as_ref().zip(colour.as_ref());
                json!({
                    "name": points.name,
                    "joined": points.joined,
                    "x": pick(&points.x, &x),
                    "y": pick(&points.y, &y),
                    "colour": third.map(|(colour, scale)| pick(&colour.values, scale)),
                })
            })
            .collect();
        let names: Vec<&str> = self.clouds.iter().map(|cloud| cloud.name.as_str()).collect();
        let alt = format!(
            "Points of {} against {}: {}. {} {}, {} {}.",
            y.axis.label,
            x.axis.label,
            names.join(", "),
            x.axis.label,
            x.words(),
            y.axis.label,
            y.words()
        );
        let colour = colour.map(|scale| colour_spec(&scale));
        let spec =
            json!({ "kind": "scatter", "x": x.spec(), "y": y.spec(), "clouds": clouds, "colour": colour });
        let how = "one where many lie on each other, and every outermost one";
        Ok(Drawn { spec, alt, notes: thinned.note(how).into_iter().collect() })
    }
}

/// Axis and ends of a colour scale.
pub(super) fn colour_spec(scale: &Scale) -> Value {
    json!({
        "label": scale.axis.label,
        "unit": scale.axis.unit,
        "from": scale.one(scale.range.0),
        "to": scale.one(scale.range.1),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_without_a_place_are_left_out_and_colours_follow_their_points() {
        let colour = Colour { axis: Axis::new("grade", ""), values: vec![1.0, 2.0, 3.0] };
        let cloud = Cloud {
            name: "r1".to_owned(),
            x: vec![0.0, f64::NAN, 2.0],
            y: vec![1.0, 1.0, 5.0],
            colour: Some(colour),
            joined: false,
        };
        let scatter = Scatter { x: Axis::of("speed_m_s"), y: Axis::of("force_n"), clouds: vec![cloud] };
        let drawn = scatter.draw("residual").unwrap();
        assert_eq!(drawn.spec["clouds"][0]["x"], json!([0, 2]));
        assert_eq!(drawn.spec["clouds"][0]["colour"], json!([1, 3]));
    }
}
