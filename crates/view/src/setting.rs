//! What is known of a run beside its trace: the wheels of a rigid body, and the ground around it.

use crate::ViewError;
use std::fmt::Debug;

/// Ground over the map.
pub trait Relief: Debug {
    /// Height at a point of the map [m], in the frame of the runs' `elevation_m`; `None` where nothing is known.
    fn height_m(&self, east_m: f64, north_m: f64) -> Option<f64>;

    /// What the ground is there; `None` where it is the same everywhere.
    fn kind(&self, east_m: f64, north_m: f64) -> Option<&str> {
        let _ = (east_m, north_m);
        None
    }
}

/// A wheel, or tyres side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct RigWheel {
    /// As its channels begin: `axle_1_left`.
    pub name: String,
    /// Its hub at rest on level ground: ahead and to the left of the centre of gravity, above the ground [m].
    pub hub_m: [f64; 3],
    /// Radius without load [m].
    pub radius_m: f64,
    /// Over all its tyres [m].
    pub width_m: f64,
    /// How far its suspension is squeezed there [m]; 0 where it has none.
    pub squeezed_m: f64,
}

/// A vehicle whose trace says how it stands: `height_m` of its centre of gravity, `roll_rad`, `pitch_rad` and `heading_rad`,
/// and of each wheel the channels that begin with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// Height of the centre of gravity above the ground at rest on level ground [m].
    pub centre_height_m: f64,
    /// Its wheels.
    pub wheels: Vec<RigWheel>,
}

impl Rig {
    /// How far the middle of its wheels is ahead of the centre of gravity [m], and how much lower their hubs are than those of
    /// wheels of this radius without load.
    pub(crate) fn seat_m(&self, radius_m: f64) -> [f64; 3] {
        let along = || self.wheels.iter().map(|wheel| wheel.hub_m[0]);
        let (first, last) = (along().fold(f64::MIN, f64::max), along().fold(f64::MAX, f64::min));
        let hubs_m = self.wheels.iter().map(|wheel| wheel.hub_m[2]).sum::<f64>() / self.wheels.len() as f64;
        [first.midpoint(last), 0.0, hubs_m - radius_m]
    }
}

/// A trailer behind a rigid body, whose trace has `trailer_east_m`, `trailer_north_m` and `trailer_height_m` of its centre of
/// gravity, and its `trailer_heading_rad`, `trailer_roll_rad` and `trailer_pitch_rad`.
#[derive(Clone, Debug, PartialEq)]
pub struct Towed {
    /// Its wheels, from its own centre of gravity.
    pub rig: Rig,
    /// Where it is coupled: ahead of its centre of gravity, and above the ground [m].
    pub coupling_m: [f64; 2],
}

/// What hangs on the hitch of a rigid body. By its name, the trace has `plough_lifted`, from 0 at work to 1, or `plough_area_m2`,
/// which grows while it works; without either it is not drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Implement {
    /// As its channels begin.
    pub name: String,
    /// Where it hangs: ahead of the centre of gravity, and above the ground [m].
    pub hitch_m: [f64; 2],
    /// Working width [m].
    pub width_m: f64,
    /// How deep its tools work [m]; `None` where it has none in the ground.
    pub depth_m: Option<f64>,
    /// Number of its tools, where that is known.
    pub tools: Option<f64>,
    /// How high it is lifted [m], where that is known.
    pub lift_m: Option<f64>,
}

/// What is known of one run.
#[derive(Clone, Debug)]
pub struct Setting<'a> {
    /// The run.
    pub run: &'a str,
    /// Its wheels, where it is a rigid body; else four wheels as large as those of the scene's vehicle roll below it.
    pub rig: Option<Rig>,
    /// What it tows, where that is a body of its own.
    pub trailer: Option<Towed>,
    /// What hangs on its hitch, where it is a rigid body.
    pub implements: Vec<Implement>,
    /// Its ground; where nothing is known of it, the ground of the scene.
    pub relief: Option<&'a dyn Relief>,
}

impl Setting<'_> {
    /// Whether something hangs on its hitch, behind it (−1) or before it (1).
    pub(crate) fn hangs(&self, way: f64) -> bool {
        self.rig.iter().any(|rig| self.implements.iter().any(|hung| hung.way(rig) == way))
    }

    /// # Errors
    /// [`ViewError::Body`] for measures that cannot be.
    pub(crate) fn check(&self) -> Result<(), ViewError> {
        let towed = self.trailer.as_ref().map(|trailer| &trailer.rig);
        self.rig.iter().chain(towed).try_for_each(Rig::check)?;
        self.implements.iter().try_for_each(Implement::check)
    }
}

impl Implement {
    /// −1 behind a vehicle on such wheels, 1 before it.
    pub(crate) fn way(&self, rig: &Rig) -> f64 {
        if self.hitch_m[0] < rig.seat_m(0.0)[0] { -1.0 } else { 1.0 }
    }

    /// # Errors
    /// [`ViewError::Body`] for measures that cannot be.
    fn check(&self) -> Result<(), ViewError> {
        let positive = |found: f64| found > 0.0 && found.is_finite();
        let there = |found: f64| found >= 0.0 && found.is_finite();
        let measures = [
            ("width_m", self.width_m, positive(self.width_m)),
            ("hitch_m", self.hitch_m[0], self.hitch_m[0].is_finite()),
            ("hitch_m", self.hitch_m[1], there(self.hitch_m[1])),
            ("depth_m", self.depth_m.unwrap_or(0.0), there(self.depth_m.unwrap_or(0.0))),
            ("tools", self.tools.unwrap_or(1.0), positive(self.tools.unwrap_or(1.0))),
            ("lift_m", self.lift_m.unwrap_or(0.0), there(self.lift_m.unwrap_or(0.0))),
        ];
        match measures.into_iter().find(|(_, _, fits)| !fits) {
            Some((name, found, _)) => Err(ViewError::Body { name, found }),
            None => Ok(()),
        }
    }
}

impl Rig {
    /// # Errors
    /// [`ViewError::Body`] for measures that cannot be.
    fn check(&self) -> Result<(), ViewError> {
        let Some(first) = self.wheels.first() else {
            return Err(ViewError::Body { name: "number of wheels", found: 0.0 });
        };
        let positive = [("centre_height_m", self.centre_height_m), ("radius_m", first.radius_m)];
        let wheels =
            self.wheels.iter().flat_map(|wheel| [("radius_m", wheel.radius_m), ("width_m", wheel.width_m)]);
        match positive.into_iter().chain(wheels).find(|(_, found)| !(*found > 0.0 && found.is_finite())) {
            Some((name, found)) => Err(ViewError::Body { name, found }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::RigWheel;

    /// The left wheel in front: 2 m in diameter, squeezed by 0.1 m on level ground.
    pub(crate) fn wheel() -> RigWheel {
        RigWheel {
            name: "axle_1_left".to_owned(),
            hub_m: [1.5, 1.0, 0.9],
            radius_m: 1.0,
            width_m: 0.6,
            squeezed_m: 0.1,
        }
    }
}
