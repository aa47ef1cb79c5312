//! Which channels share a plot: those of one unit, of all wheels those that say the same, and the two angles at which a vehicle
//! leans.

use crate::Scene;
use crate::colour::{Colour, SERIES};
use crate::plots::COMPARED;
use crate::wheel_channel::of_wheel;
use headland_trace::Channel;
use headland_units::{stem, unit_of_name};

/// Channels of one unit.
#[derive(Debug, PartialEq)]
pub(crate) struct Group {
    /// What stands over the plot.
    pub title: String,
    /// Where it is shown.
    pub rank: Rank,
    /// The channels, in the order of the traces.
    pub channels: Vec<String>,
}

/// Where a group is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Rank {
    /// It has its own place.
    Main,
    /// It shares one with the others of single wheels.
    Wheels,
    /// It shares one with the rest.
    More,
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
/// Powers stand among the rest: a plot of its own says where they go.
const MAIN: usize = 2;

fn unit(channel: &str) -> String {
    unit_of_name(channel).map_or_else(|| "1".to_owned(), |unit| unit.symbol)
}

/// A channel's name in words.
pub(crate) fn words(channel: &str) -> String {
    stem(channel).replace('_', " ")
}

/// How a vehicle leans.
const LEANING: [&str; 2] = ["roll_rad", "pitch_rad"];

/// All channels of all runs: speed, forces, powers, then the rest. Where single wheels are known, sums over axles are left out.
pub(crate) fn groups(scene: &Scene) -> Vec<Group> {
    let channels = || scene.runs.iter().chain(scene.measured).flat_map(|run| run.trace.channels());
    let mut wheels: Vec<((bool, &str), Vec<String>)> = Vec::new();
    for channel in channels() {
        let Some(own) = of_wheel(&channel.name).filter(|own| own.single) else { continue };
        if channel.values.iter().any(|value| value.is_finite()) {
            put(&mut wheels, (of_trailer(&channel.name), own.what), &channel.name);
        }
    }
    let leaning = !wheels.is_empty();
    let apart = |name: &str| {
        of_wheel(name).is_some_and(|own| wheels.iter().any(|((_, what), _)| *what == own.what))
            || (leaning && LEANING.contains(&name))
    };
    let paired = |name: &str| scene.measured.iter().any(|run| run.trace.channel(name).is_some());
    let mut groups = by_unit(channels().filter(|channel| !apart(&channel.name)), &paired);
    let names: Vec<String> = LEANING.map(str::to_owned).into();
    if leaning && channels().any(|channel| LEANING.contains(&channel.name.as_str())) {
        let place = groups.iter().take_while(|group| group.rank == Rank::Main).count();
        groups.insert(
            place,
            Group { title: "Roll, pitch [rad]".to_owned(), rank: Rank::More, channels: names },
        );
    }
    for ((towed, what), channels) in wheels {
        let noun = if towed { format!("trailer {}", words(what)) } else { words(what) };
        spread(&mut groups, (capital(&noun), &unit(what)), Rank::Wheels, channels, &paired);
    }
    groups
}

fn put<K: PartialEq>(groups: &mut Vec<(K, Vec<String>)>, key: K, name: &str) {
    let index = groups.iter().position(|(known, _)| *known == key).unwrap_or_else(|| {
        groups.push((key, Vec::new()));
        groups.len() - 1
    });
    let channels = &mut groups[index].1;
    if !channels.iter().any(|known| known == name) {
        channels.push(name.to_owned());
    }
}

/// Whether a channel is of a trailer or of what couples it.
fn of_trailer(channel: &str) -> bool {
    ["trailer_", "coupling_"].iter().any(|begin| channel.starts_with(begin))
}

/// Adds a plot of some channels, or as many as keep their lines few: no colour comes twice in one, and its legend is seen whole.
fn spread(
    groups: &mut Vec<Group>,
    (noun, unit): (String, &str),
    rank: Rank,
    channels: Vec<String>,
    paired: &impl Fn(&str) -> bool,
) {
    let mut plots: Vec<(usize, Vec<String>)> = Vec::new();
    for channel in channels {
        let lines = 1 + usize::from(paired(&channel));
        match plots.last_mut().filter(|(drawn, _)| drawn + lines <= SERIES.len()) {
            Some((drawn, plot)) => {
                *drawn += lines;
                plot.push(channel);
            }
            None => plots.push((lines, vec![channel])),
        }
    }
    groups.extend(plots.into_iter().enumerate().map(|(index, (_, channels))| match index {
        0 => Group { title: format!("{noun} [{unit}]"), rank, channels },
        again => {
            let rank = if rank == Rank::Main { Rank::More } else { rank };
            Group { title: format!("{noun}, {} [{unit}]", again + 1), rank, channels }
        }
    }));
}

/// Channels of one unit.
fn by_unit<'a>(channels: impl Iterator<Item = &'a Channel>, paired: &impl Fn(&str) -> bool) -> Vec<Group> {
    let mut units: Vec<((bool, String), Vec<String>)> = Vec::new();
    for channel in channels {
        if channel.values.iter().any(|value| value.is_finite()) {
            put(&mut units, (of_trailer(&channel.name), unit(&channel.name)), &channel.name);
        }
    }
    let rank = |unit: &str| NOUNS.iter().position(|(known, _)| *known == unit).unwrap_or(NOUNS.len());
    units.sort_by_key(|((towed, unit), _)| (*towed, rank(unit)));
    let mut groups = Vec::new();
    for ((towed, unit), channels) in units {
        let noun = NOUNS.iter().find(|(known, _)| *known == unit).map(|(_, noun)| (*noun).to_owned());
        let noun = match (&noun, channels.as_slice()) {
            (Some(noun), _) => noun.clone(),
            (None, [only]) => capital(&words(only)),
            (None, _) if unit == "1" => "Ratios".to_owned(),
            (None, _) => "Values".to_owned(),
        };
        let noun = if towed { format!("Trailer: {}", noun.to_lowercase()) } else { noun };
        let place = if rank(&unit) < MAIN && !towed { Rank::Main } else { Rank::More };
        spread(&mut groups, (noun, &unit), place, channels, paired);
    }
    // What a main plot has no room for stands among the rest.
    groups.sort_by_key(|group| group.rank != Rank::Main);
    groups
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The colour of a channel, the same in every plot, run and arrow; but for the speed, which is the colour of its run.
pub(crate) fn colour(groups: &[Group], channel: &str) -> Colour {
    let place = groups.iter().find_map(|group| {
        let beside_speed = group.channels.iter().any(|known| known == COMPARED);
        let place =
            group.channels.iter().filter(|known| *known != COMPARED).position(|known| known == channel)?;
        // The speed is orange, and its recording sky blue: beside them the first two would be taken for them.
        Some(if beside_speed { place + 2 } else { place })
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
        let scene = Scene {
            title: "",
            runs: &runs,
            measured: &[],
            forces: &[],
            vehicle,
            ground: None,
            settings: &[],
        };
        let groups = groups(&scene);
        let titles: Vec<&str> = groups.iter().map(|group| group.title.as_str()).collect();
        assert_eq!(titles, ["Speed [m/s]", "Force [N]", "Ratios [1]", "Soil [kg/m^3]"]);
        assert_eq!(groups[1].channels, ["drawbar_force_n", "tractive_force_n"]);
        assert_ne!(colour(&groups, "drawbar_force_n"), colour(&groups, "tractive_force_n"));
    }

    /// Forces of four wheels beside those of the vehicle would be a plot that nobody can read.
    #[test]
    fn channels_of_wheels_share_a_plot_by_what_they_say() {
        let mut trace = Trace::new(vec![0.0]).unwrap();
        for name in [
            "speed_m_s",
            "air_n",
            "power_w",
            "roll_rad",
            "heading_rad",
            "axle_1_load_n",
            "axle_1_left_load_n",
            "axle_1_right_load_n",
            "axle_1_left_side_force_n",
            "axle_1_sinkage_m",
        ] {
            trace.push(name, vec![1.0], Origin::Predicted).unwrap();
        }
        let runs = [Run { id: "r1".to_owned(), trace }];
        let groups = groups(&crate::scene::tests::scene(&runs, &[]));
        let told: Vec<(&str, Rank)> = groups.iter().map(|group| (group.title.as_str(), group.rank)).collect();
        let expected = [
            ("Speed [m/s]", Rank::Main),
            ("Force [N]", Rank::Main),
            ("Roll, pitch [rad]", Rank::More),
            ("Power [W]", Rank::More),
            ("Length [m]", Rank::More),
            ("Angle [rad]", Rank::More),
            ("Load [N]", Rank::Wheels),
            ("Side force [N]", Rank::Wheels),
        ];
        assert_eq!(told, expected);
        assert_eq!(groups[6].channels, ["axle_1_left_load_n", "axle_1_right_load_n"]);
    }

    /// A plot of eight forces had two pairs of one colour, and a legend of which half was seen.
    #[test]
    fn no_plot_has_a_colour_twice_and_a_trailer_has_its_own() {
        let names = ["a_n", "b_n", "c_n", "d_n", "e_n", "f_n", "g_n", "coupling_pull_n", "coupling_load_n"];
        let wheels = ["axle_1_left_load_n", "axle_1_right_load_n", "trailer_axle_1_left_load_n"];
        let mut trace = Trace::new(vec![0.0]).unwrap();
        for name in names.iter().chain(&wheels) {
            trace.push(*name, vec![1.0], Origin::Predicted).unwrap();
        }
        let runs = [Run { id: "r1".to_owned(), trace }];
        let alone = groups(&crate::scene::tests::scene(&runs, &[]));
        let told: Vec<(&str, Rank, usize)> =
            alone.iter().map(|group| (group.title.as_str(), group.rank, group.channels.len())).collect();
        let expected = [
            ("Force [N]", Rank::Main, 6),
            ("Force, 2 [N]", Rank::More, 1),
            ("Trailer: force [N]", Rank::More, 2),
            ("Load [N]", Rank::Wheels, 2),
            ("Trailer load [N]", Rank::Wheels, 1),
        ];
        assert_eq!(told, expected);
        for group in &alone {
            let mut colours: Vec<Colour> =
                group.channels.iter().map(|channel| colour(&alone, channel)).collect();
            colours.sort_unstable();
            colours.dedup();
            assert_eq!(colours.len(), group.channels.len(), "{}", group.title);
        }
        // With a recording each channel has two lines.
        let beside = groups(&crate::scene::tests::scene(&runs, &runs));
        assert_eq!(beside[0].channels.len(), 3);
    }
}
