//! Energy through a driveline: from stores over the wheels and the shafts to where it ends.

use crate::{Axis, Flow, Plot, Sankey, quantity};

/// Energies [J] by where they stand. A source gives, everything else takes; negative ones the other way round.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stages {
    /// Stores that are drawn on.
    pub sources: Vec<(String, f64)>,
    /// What is lost between stores and wheels.
    pub losses: Vec<(String, f64)>,
    /// What is taken from shafts and wires.
    pub taken: Vec<(String, f64)>,
    /// What the wheels work against.
    pub wheels: Vec<(String, f64)>,
}

/// Share of the largest side below which a flow is not drawn: nobody could see it.
const VISIBLE: f64 = 2e-3;

const DRIVELINE: &str = "driveline";
const WHEELS: &str = "wheels";

/// Flows from the stores through driveline and wheels; what is too small to be seen is told below the plot.
pub fn staged_flow(title: &str, stages: &Stages) -> Plot {
    let sources = stages.sources.iter().map(|(name, value)| (name, -value, DRIVELINE));
    let taken = stages.losses.iter().chain(&stages.taken).map(|(name, value)| (name, *value, DRIVELINE));
    let wheels = stages.wheels.iter().map(|(name, value)| (name, *value, WHEELS));
    let ends: Vec<(&String, f64, &str)> =
        sources.chain(taken).chain(wheels).filter(|(_, value, _)| value.is_finite()).collect();
    let fed: f64 = ends.iter().map(|(_, value, _)| (-value).max(0.0)).sum();
    let spent: f64 = ends.iter().map(|(_, value, _)| value.max(0.0)).sum();
    let visible = |value: f64| value.abs() > VISIBLE * fed.max(spent);
    let to_wheels: f64 = ends.iter().filter(|(_, _, at)| *at == WHEELS).map(|(_, value, _)| value).sum();
    let mut flows = Vec::new();
    let flow = |from: &str, to: &str, value: f64| Flow { from: from.to_owned(), to: to.to_owned(), value };
    if visible(to_wheels) {
        let ends = if to_wheels > 0.0 { (DRIVELINE, WHEELS) } else { (WHEELS, DRIVELINE) };
        flows.push(flow(ends.0, ends.1, to_wheels.abs()));
    }
    let mut small = 0.0;
    for (name, value, at) in &ends {
        if !visible(*value) {
            small += value;
        } else if *value > 0.0 {
            flows.push(flow(at, name, *value));
        } else {
            flows.push(flow(name, at, -value));
        }
    }
    let words = format!(
        "In {}, out {}; too small to be drawn {}.",
        quantity(fed, "J"),
        quantity(spent, "J"),
        quantity(small, "J")
    );
    Plot::new(title, Sankey { axis: Axis::new("energy", "J"), flows, ..Sankey::default() }).words(words)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kind;

    fn named(values: &[(&str, f64)]) -> Vec<(String, f64)> {
        values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
    }

    fn flows(plot: &Plot) -> Vec<(&str, &str, f64)> {
        let Kind::Sankey(sankey) = &plot.kind else { panic!("no sankey") };
        sankey.flows.iter().map(|flow| (flow.from.as_str(), flow.to.as_str(), flow.value)).collect()
    }

    #[test]
    fn what_the_wheels_take_passes_through_them() {
        let stages = Stages {
            sources: named(&[("fuel", 100.0)]),
            losses: named(&[("engine heat", 60.0)]),
            taken: named(&[("power take-off", 10.0)]),
            wheels: named(&[("soil", 25.0), ("slope", 5.0), ("air", 0.01)]),
        };
        let plot = staged_flow("flow", &stages);
        assert_eq!(
            flows(&plot),
            [
                ("driveline", "wheels", 30.01),
                ("fuel", "driveline", 100.0),
                ("driveline", "engine heat", 60.0),
                ("driveline", "power take-off", 10.0),
                ("wheels", "soil", 25.0),
                ("wheels", "slope", 5.0),
            ]
        );
        assert!(plot.words.contains("too small to be drawn 0.01"), "{}", plot.words);
        assert!(plot.draw().is_ok());
    }

    /// Down a hill with the battery charging: the slope feeds the wheels, the wheels the driveline, that the battery.
    #[test]
    fn downhill_the_flow_turns_round() {
        let stages = Stages {
            sources: named(&[("battery", -40.0)]),
            losses: named(&[("motor", 10.0)]),
            taken: Vec::new(),
            wheels: named(&[("slope", -80.0), ("soil", 30.0)]),
        };
        let plot = staged_flow("flow", &stages);
        assert_eq!(
            flows(&plot),
            [
                ("wheels", "driveline", 50.0),
                ("driveline", "battery", 40.0),
                ("driveline", "motor", 10.0),
                ("slope", "wheels", 80.0),
                ("wheels", "soil", 30.0),
            ]
        );
        assert!(plot.draw().is_ok());
    }
}
