//! Which channels share a plot.

use crate::Scene;
use crate::colour::{Colour, SERIES};
use crate::plots::COMPARED;
use headland_units::{stem, unit_of_name};

/// Channels of one unit.
#[derive(Debug, PartialEq)]
pub(crate) struct Group {
    /// What stands over the plot.
    pub title: String,
    /// Whether it has its own place; the others share one.
    pub main: bool,
    /// The channels, in the order of the traces.
    pub channels: Vec<String>,
}

/// Units that have a noun, those of the main plots first.
const NOUNS: [(&str, &str); 10] = [
    ("m/s", "Speed"),
    ("N", "Force"),
    ("W", "Power"),
    ("m", "Length"),
    ("rad", "Angle"),
    ("m/s^2", "Acceleration"),
    ("N m", "Torque"),
    ("rad/s", "Angular speed"),
    ("J", "Energy"),
    ("°C", "Temperature"),
];
const MAIN: usize = 3;

fn unit(channel: &str) -> String {
    unit_of_name(channel).map_or_else(|| "1".to_owned(), |unit| unit.symbol)
}

/// A channel's name in words.
pub(crate) fn words(channel: &str) -> String {
    stem(channel).replace('_', " ")
}

/// All channels of all runs: speed, forces, powers, then the rest.
pub(crate) fn groups(scene: &Scene) -> Vec<Group> {
    let mut units: Vec<(String, Vec<String>)> = Vec::new();
    for channel in scene.runs.iter().chain(scene.measured).flat_map(|run| run.trace.channels()) {
        if !channel.values.iter().any(|value| value.is_finite()) {
            continue;
        }
        let unit = unit(&channel.name);
        let index = units.iter().position(|(known, _)| *known == unit).unwrap_or_else(|| {
            units.push((unit, Vec::new()));
            units.len() - 1
        });
        let channels = &mut units[index].1;
        if !channels.contains(&channel.name) {
            channels.push(channel.name.clone());
        }
    }
    let rank = |unit: &str| NOUNS.iter().position(|(known, _)| *known == unit).unwrap_or(NOUNS.len());
    units.sort_by_key(|(unit, _)| rank(unit));
    units
        .into_iter()
        .map(|(unit, channels)| {
            let noun = NOUNS.iter().find(|(known, _)| *known == unit).map(|(_, noun)| (*noun).to_owned());
            let noun = match (&noun, channels.as_slice()) {
                (Some(noun), _) => noun.clone(),
                (None, [only]) => capital(&words(only)),
                (None, _) if unit == "1" => "Ratios".to_owned(),
                (None, _) => "Values".to_owned(),
            };
            Group { title: format!("{noun} [{unit}]"), main: rank(&unit) < MAIN, channels }
        })
        .collect()
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The colour of a channel, the same in every plot, run and arrow; but for the speed, which is the colour of its run.
pub(crate) fn colour(groups: &[Group], channel: &str) -> Colour {
    let place = groups.iter().find_map(|group| {
        group.channels.iter().filter(|known| *known != COMPARED).position(|known| known == channel)
    });
    SERIES[place.unwrap_or(0) % SERIES.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Body;
    use headland_trace::{Origin, Run, Trace};

    #[test]
    fn channels_of_one_unit_share_a_plot_and_speed_comes_first() {
        let mut trace = Trace::new(vec![0.0]).unwrap();
        for name in
            ["grade", "drawbar_force_n", "speed_m_s", "tractive_force_n", "state_of_charge", "soil_kg_m3"]
        {
            trace.push(name, vec![1.0], Origin::Predicted).unwrap();
        }
        trace.push("pto_power_w", vec![f64::NAN], Origin::Predicted).unwrap();
        let runs = [Run { id: "r1".to_owned(), trace }];
        let vehicle = Body {
            length_m: 1.0,
            width_m: 1.0,
            height_m: 1.0,
            wheel_radius_m: 1.0,
            wheelbase_m: 1.0,
            track_m: 1.0,
        };
        let scene = Scene { title: "", runs: &runs, measured: &[], forces: &[], vehicle, ground: None };
        let groups = groups(&scene);
        let titles: Vec<&str> = groups.iter().map(|group| group.title.as_str()).collect();
        assert_eq!(titles, ["Speed [m/s]", "Force [N]", "Ratios [1]", "Soil [kg/m^3]"]);
        assert_eq!(groups[1].channels, ["drawbar_force_n", "tractive_force_n"]);
        assert_ne!(colour(&groups, "drawbar_force_n"), colour(&groups, "tractive_force_n"));
    }
}
