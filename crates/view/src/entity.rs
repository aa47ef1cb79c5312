//! Where everything stands in the recording.

use rerun::{EntityPath, EntityPathPart};

fn entity(parts: &[&str]) -> EntityPath {
    parts.iter().map(|part| EntityPathPart::new(*part)).collect::<Vec<_>>().into()
}

/// Everything in space.
pub(crate) fn world() -> EntityPath {
    entity(&["world"])
}

/// The ground, or the strip below a run.
pub(crate) fn ground(part: &str) -> EntityPath {
    entity(&["world", "ground", part])
}

/// What belongs to a run and does not move with its vehicle.
pub(crate) fn of_run(run: &str, who: Who, part: &str) -> EntityPath {
    entity(&["world", "runs", run, who.name(), part])
}

/// The line that a run drives.
pub(crate) fn line(run: &str, who: Who) -> EntityPath {
    of_run(run, who, "path")
}

/// A run's vehicle.
pub(crate) fn vehicle(run: &str, who: Who) -> EntityPath {
    entity(&["world", "runs", run, who.name(), "vehicle"])
}

/// What has to be in sight around a run's vehicle.
pub(crate) fn reach(run: &str) -> EntityPath {
    part(&vehicle(run, Who::Modelled), "reach")
}

/// A part of something.
pub(crate) fn part(whole: &EntityPath, part: &str) -> EntityPath {
    whole.join(&entity(&[part]))
}

/// A line of a plot.
pub(crate) fn channel(run: &str, channel: &str, who: Who) -> EntityPath {
    entity(&["channels", run, channel, who.name()])
}

/// A line of where a run's power goes.
pub(crate) fn flow(run: &str, name: &str) -> EntityPath {
    entity(&["flow", run, name])
}

/// A channel of a run beside the same of the others.
pub(crate) fn beside(channel: &str, run: &str) -> EntityPath {
    entity(&["beside", channel, run])
}

/// The text.
pub(crate) fn summary() -> EntityPath {
    entity(&["summary"])
}

/// What a diagnosis answers, and what else could be the cause.
pub(crate) fn words(what: &str) -> EntityPath {
    entity(&["words", what])
}

/// A part of the plan on which a mismatch is painted.
pub(crate) fn painted(part: &str, run: &str) -> EntityPath {
    entity(&["plan", part, run])
}

/// The same of all runs.
pub(crate) fn painted_parts(part: &str) -> EntityPath {
    entity(&["plan", part])
}

/// A part of the map of a mismatch over something.
pub(crate) fn mapped(over: &str, part: &str) -> EntityPath {
    entity(&["maps", over, part])
}

/// A line of a run in a diagnosis.
pub(crate) fn diagnosed(run: &str, plot: &str, line: &str) -> EntityPath {
    entity(&["diagnosed", run, plot, line])
}

/// Where a line or a vehicle comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Who {
    Modelled,
    Measured,
    Residual,
}

impl Who {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Modelled => "modelled",
            Self::Measured => "measured",
            Self::Residual => "residual",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_of_any_name_has_one_place() {
        let path = vehicle("a/b: 3 °", Who::Modelled);
        assert_eq!(path.len(), 5);
        assert_eq!(EntityPath::from(path.to_string()), path);
    }
}
