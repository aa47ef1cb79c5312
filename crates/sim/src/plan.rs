//! What a cycle is made of: phases, what ends them, and what the driver and the tasks do in them.

use headland_plugin::Mode;
use serde::Serialize;

/// How a run begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// Distance along the path [m].
    pub position_m: f64,
    /// Speed [m/s].
    pub speed_m_s: f64,
}

/// When a phase ends. Where it is true as the phase begins, the phase ends at once; a position or a time that lies behind
/// the vehicle is none that it can reach, and stops the run.
#[derive(Clone, Debug, PartialEq)]
pub enum Until {
    /// The vehicle rests.
    Stopped,
    /// Its speed has fallen to this [m/s].
    SpeedBelow(f64),
    /// Its speed has risen to this [m/s].
    SpeedAbove(f64),
    /// This long after the phase began [s].
    Elapsed(f64),
    /// This long after the run began [s].
    Time(f64),
    /// This far after the phase began [m].
    Travelled(f64),
    /// At this distance along the path [m].
    Position(f64),
    /// At the next mark of this name along the path.
    Mark(String),
    /// At the end of the path.
    PathEnd,
    /// A state has risen to this, in its unit.
    StateAbove {
        /// Its name in the trace.
        state: String,
        /// Value to reach.
        value: f64,
    },
    /// A state has fallen to this, in its unit.
    StateBelow {
        /// Its name in the trace.
        state: String,
        /// Value to reach.
        value: f64,
    },
    /// The first of these.
    Any(Vec<Until>),
}

/// One piece of a cycle.
#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    /// Change speed at a steady rate.
    Reach {
        /// Speed to reach [m/s].
        speed_m_s: f64,
        /// Rate, more than 0 [m/s²].
        acceleration_m_s2: f64,
    },
    /// Keep the speed.
    Hold {
        /// For this long [s].
        for_s: f64,
    },
    /// Neutral, no brake.
    Coast {
        /// Until then.
        until: Until,
    },
    /// Follow a speed over time.
    Follow {
        /// Time since the phase began [s] and speed [m/s], linear in between, times increasing from 0.
        profile: Vec<(f64, f64)>,
    },
    /// Drive at a speed, coming to it at a steady rate.
    Drive {
        /// Speed to reach and to keep [m/s].
        speed_m_s: f64,
        /// Rate at which it is come to, more than 0 [m/s²].
        acceleration_m_s2: f64,
        /// The run stops where the speed falls behind what the driver wants by more than this [m/s].
        tolerance_m_s: Option<f64>,
        /// Until then.
        until: Until,
    },
    /// Drive at a speed that depends on the place.
    DriveByPlace {
        /// Distance along the path [m] and speed [m/s], linear in between, positions increasing; beyond its ends the
        /// first and the last speed hold.
        profile: Vec<(f64, f64)>,
        /// Greatest rate of change of speed [m/s²].
        acceleration_m_s2: f64,
        /// Until then.
        until: Until,
    },
    /// Stand, brakes on.
    Stand {
        /// Until then.
        until: Until,
    },
    /// Another phase, with what goes on in it.
    With {
        /// What goes on.
        setting: Setting,
        /// The phase.
        phase: Box<Phase>,
    },
}

/// What goes on in a phase beside driving.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Setting {
    /// What the phase is called.
    pub name: Option<String>,
    /// The phase is passed over unless all of these hold.
    pub guards: Vec<Guard>,
    /// What each task is told to do, by name; those that are not named rest. `None`: all work.
    pub tasks: Option<Vec<(String, Mode)>>,
    /// Speed at which the driver keeps the engine.
    pub engine_speed: EngineSpeed,
    /// A driver who knows no resistances; `None`: one who does.
    pub driver: Option<Pi>,
}

/// A condition of entry, of a phase or of a group of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Guard {
    /// Phases of one group have the same number; what holds as the first of them would begin holds for all.
    pub group: usize,
    /// All of these have to be true.
    pub when: Vec<Until>,
}

/// Speed at which the driver keeps the engine.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum EngineSpeed {
    /// The driveline chooses.
    #[default]
    Free,
    /// This one [rad/s].
    Kept(f64),
    /// Time since the phase began [s] and speed [rad/s], linear in between.
    Over(Vec<(f64, f64)>),
}

/// A driver who sees the speed and the road ahead, and knows no resistance: force over mass is
/// k (v_ref(t + preview) − v) + k_i ∫ (v_ref − v) dt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pi {
    /// Proportional gain, k [1/s].
    pub gain_per_s: f64,
    /// Integral gain, k_i [1/s²].
    pub integral_per_s2: f64,
    /// The most that the integral part asks for, either way [m/s²]; beyond it, it does not grow.
    pub integral_limit_m_s2: f64,
    /// How far ahead the driver sees the wanted speed [s].
    pub preview_s: f64,
}

/// How a run is driven.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// How it begins.
    pub start: Start,
    /// Its phases.
    pub phases: Vec<Phase>,
    /// How fast the driver takes back an error of speed [1/s].
    ///
    /// The driver knows the resistances and feeds them forward: a = dv_ref/dt + gain (v_ref − v).
    pub driver_gain_per_s: f64,
    /// Step of the integration [s].
    pub step_s: f64,
    /// A run longer than this is stopped [s].
    pub longest_s: f64,
}

/// A phase that was driven, or passed over.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Driven {
    /// Its place in the plan, from 0.
    pub phase: usize,
    /// What it is called.
    pub name: Option<String>,
    /// When it began [s].
    pub from_s: f64,
    /// When it ended [s].
    pub to_s: f64,
    /// Where it began along the path [m].
    pub from_m: f64,
    /// Where it ended [m].
    pub to_m: f64,
    /// What ended it, or why it was passed over, in words.
    pub ended_by: String,
    /// Way that its speeds make of the time that it took [m], where it says what speed is wanted when.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wanted_m: Option<f64>,
    /// Whether what it pulls may slow it down, as a plough does: a speed that is to be held or followed is not kept then.
    pub may_slow_down: bool,
}

/// A drive that makes this share less of its way than is wanted is too weak for it; less is a matter of corners.
const TOO_LITTLE: f64 = 0.05;

impl Driven {
    /// Way that it made [m].
    pub fn way_m(&self) -> f64 {
        (self.to_m - self.from_m).abs()
    }

    /// By how much it fell short of its way [m], where that is more than corners make.
    pub fn short_m(&self) -> Option<f64> {
        let least_m = |wanted_m: &f64| self.way_m() < (1.0 - TOO_LITTLE) * wanted_m;
        self.wanted_m.filter(least_m).map(|wanted_m| wanted_m - self.way_m())
    }

    /// How it fell short, in words.
    pub fn told_short(&self) -> Option<String> {
        let short_m = self.short_m()?;
        let name = self.name.as_ref().map_or_else(String::new, |name| format!(" `{name}`"));
        Some(format!(
            "phase {}{name} made {:.1} m of the {:.1} m that its speeds ask for, from {:.2} s and {:.1} m on",
            self.phase + 1,
            self.way_m(),
            self.way_m() + short_m,
            self.from_s,
            self.from_m
        ))
    }
}

/// The first phase that fell short of a speed that was to be held or followed, in words.
pub fn speed_not_kept(driven: &[Driven]) -> Option<String> {
    let told = driven.iter().filter(|driven| !driven.may_slow_down).find_map(Driven::told_short)?;
    Some(format!("the drive could not keep the speed that is wanted: {told}"))
}
