//! What is drawn.

use crate::setting::{Rig, Setting};
use crate::{Ground, ViewError};
use headland_trace::Run;
use std::collections::BTreeSet;

/// Runs, the recordings they belong to, and what the vehicle and its ground look like.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Heading of the recording and of its summary.
    pub title: &'a str,
    /// What was simulated. Each run needs `position_m`, or `east_m` and `north_m`.
    ///
    /// With `position_m` alone the path follows `heading_rad`, or points east; several such runs are laid side by side.
    /// The height is `elevation_m`, else that of the ground, else 0.
    pub runs: &'a [Run],
    /// What was recorded, under the same names; a run may lack its recording.
    pub measured: &'a [Run],
    /// The forces that are drawn as arrows at the vehicle.
    pub forces: &'a [ForceArrow<'a>],
    /// The vehicle.
    pub vehicle: Body,
    /// The ground; a strip along the path where there is none.
    pub ground: Option<Ground<'a>>,
    /// What else is known of single runs.
    pub settings: &'a [Setting<'a>],
}

/// A channel that is drawn as an arrow.
#[derive(Clone, Copy, Debug)]
pub struct ForceArrow<'a> {
    /// The channel [N].
    pub channel: &'a str,
    /// What stands at the arrow.
    pub label: &'a str,
    /// Where a positive force points.
    pub axis: Axis,
}

/// A direction at the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Along the path: traction.
    Forward,
    /// Against the path: resistances and drawbar pull.
    Backward,
    /// Away from the ground.
    Up,
}

impl Axis {
    /// The force as a vector ahead, to the left and up.
    pub(crate) fn vector(self, force: f64) -> [f64; 3] {
        match self {
            Self::Forward => [force, 0.0, 0.0],
            Self::Backward => [-force, 0.0, 0.0],
            Self::Up => [0.0, 0.0, force],
        }
    }
}

/// The outer measures of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Nose to tail [m].
    pub length_m: f64,
    /// Over the tyres [m].
    pub width_m: f64,
    /// Ground to roof [m].
    pub height_m: f64,
    /// Radius of the wheels [m].
    pub wheel_radius_m: f64,
    /// Front axle to rear axle [m].
    pub wheelbase_m: f64,
    /// Middle of the left tyres to middle of the right ones [m].
    pub track_m: f64,
}

impl<'a> Scene<'a> {
    /// What is known of a run.
    pub(crate) fn setting(&self, run: &str) -> Option<&'a Setting<'a>> {
        self.settings.iter().find(|setting| setting.run == run)
    }

    /// The wheels of a run.
    pub(crate) fn rig(&self, run: &str) -> Option<&'a Rig> {
        self.setting(run)?.rig.as_ref()
    }

    /// # Errors
    /// What cannot be drawn, before anything is.
    pub(crate) fn check(&self) -> Result<(), ViewError> {
        let Some(first) = self.runs.first() else { return Err(ViewError::NoRun) };
        for runs in [self.runs, self.measured] {
            let mut ids = BTreeSet::new();
            for run in runs {
                if !ids.insert(&run.id) {
                    return Err(ViewError::Twice { run: run.id.clone() });
                }
            }
        }
        for force in self.forces {
            if !self.runs.iter().any(|run| run.trace.channel(force.channel).is_some()) {
                return Err(ViewError::Force {
                    channel: force.channel.to_owned(),
                    present: first.trace.channels().iter().map(|channel| channel.name.clone()).collect(),
                });
            }
        }
        let Body { length_m, width_m, height_m, wheel_radius_m, wheelbase_m, track_m } = self.vehicle;
        for (name, found) in [
            ("length_m", length_m),
            ("width_m", width_m),
            ("height_m", height_m),
            ("wheel_radius_m", wheel_radius_m),
            ("wheelbase_m", wheelbase_m),
            ("track_m", track_m),
        ] {
            if !(found > 0.0 && found.is_finite()) {
                return Err(ViewError::Body { name, found });
            }
        }
        self.settings.iter().try_for_each(Setting::check)?;
        self.ground.as_ref().map_or(Ok(()), Ground::check)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use headland_trace::{Origin, Trace};

    pub(crate) const BODY: Body = Body {
        length_m: 6.0,
        width_m: 3.0,
        height_m: 3.5,
        wheel_radius_m: 0.95,
        wheelbase_m: 3.3,
        track_m: 2.3,
    };

    /// A run with a sample every second.
    pub(crate) fn run(id: &str, channels: &[(&str, &[f64])]) -> Run {
        let times = (0..channels[0].1.len()).map(|second| second as f64).collect();
        let mut trace = Trace::new(times).unwrap();
        for (name, values) in channels {
            trace.push(*name, values.to_vec(), Origin::Predicted).unwrap();
        }
        Run { id: id.to_owned(), trace }
    }

    pub(crate) fn scene<'a>(runs: &'a [Run], measured: &'a [Run]) -> Scene<'a> {
        Scene { title: "", runs, measured, forces: &[], vehicle: BODY, ground: None, settings: &[] }
    }

    #[test]
    fn a_scene_that_cannot_be_drawn_is_refused_by_name() {
        let one = run("r1", &[("position_m", &[0.0, 1.0])]);
        let twice = [one.clone(), one];
        assert!(matches!(scene(&[], &[]).check(), Err(ViewError::NoRun)));
        assert!(matches!(scene(&twice, &[]).check(), Err(ViewError::Twice { run }) if run == "r1"));
        assert!(matches!(scene(&twice[..1], &twice).check(), Err(ViewError::Twice { .. })));
        let forces = [ForceArrow { channel: "drag_n", label: "drag", axis: Axis::Backward }];
        let error = Scene { forces: &forces, ..scene(&twice[..1], &[]) }.check().unwrap_err();
        assert_eq!(error.to_string(), "no run has the force `drag_n`; there are: position_m");
        let flat = Body { height_m: 0.0, ..BODY };
        let error = Scene { vehicle: flat, ..scene(&twice[..1], &[]) }.check().unwrap_err();
        assert_eq!(error.to_string(), "`height_m` of the vehicle is 0, expected a number above 0");
    }
}
