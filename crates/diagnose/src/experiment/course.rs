//! The runs that a user can drive, in the words in which they are proposed.

use crate::Case;
use crate::balances::balance::Kind;
use crate::causes::catalogue::Cause;
use crate::runs::recorded::Recorded;
use headland_sim::Drive;

/// How a run moves.
#[derive(Clone, Debug)]
pub enum Motion {
    /// With the speeds of the run that it is like.
    AsRecorded,
    /// The same three times on end.
    Longer {
        /// The acceleration that joins the end to the beginning [m/s²].
        back_m_s2: f64,
    },
    /// One speed.
    Hold {
        /// The speed [m/s].
        speed_m_s: f64,
    },
    /// Rolling free.
    Coast {
        /// From this speed [m/s].
        from_m_s: f64,
    },
    /// Up hard and up gently between two speeds, and down gently.
    TwoForces {
        /// The lower and the higher speed [m/s].
        between_m_s: (f64, f64),
        /// The gentle and the hard acceleration [m/s²].
        at_m_s2: (f64, f64),
    },
}

/// What a run does without.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Without {
    /// Everything acts as in the runs at hand.
    Nothing,
    /// A wind.
    Wind,
    /// Slopes and soft places: the same kind of ground elsewhere.
    Ground,
    /// What is cold at first.
    Cold,
    /// Whatever is pulled.
    Load,
    /// Consumers.
    Consumers,
}

/// A run that could be driven.
#[derive(Clone, Debug)]
pub struct Course {
    /// As `diagnosis.json` calls it.
    pub name: &'static str,
    /// As an engineer would ask for it.
    pub words: String,
    /// How it moves.
    pub motion: Motion,
    /// Whether it goes against the run that it is like.
    pub opposite: bool,
    /// Mass that is put on board [kg].
    pub ballast_kg: f64,
    /// What does not act.
    pub without: Without,
    /// Whether it carries an accelerometer that the runs at hand lack.
    pub accelerometer: bool,
}

impl Without {
    /// Whether this cause does not act on such a run.
    pub fn silences(self, cause: &Cause) -> bool {
        match self {
            Self::Nothing => false,
            Self::Wind => cause.id == "wind",
            Self::Ground => ["grade", "grade_constant", "soft_ground", "multipass"].contains(&cause.id),
            // With the air's temperature a tyre stays as cold as it is.
            Self::Cold => {
                ["rolling_temperature", "driveline_temperature", "cold_start"].contains(&cause.id)
                    && cause.depends_on.contains(&"time_s")
            }
            Self::Load => cause.id == "drawbar_load",
            Self::Consumers => cause.id == "auxiliary_power",
        }
    }
}

impl Course {
    /// Whether anything acts otherwise than in the run that it is like: a vehicle that rolls free moves otherwise then.
    pub fn alters(&self) -> bool {
        self.opposite || self.ballast_kg != 0.0 || self.without != Without::Nothing
    }
}

/// Ballast as a share of the mass: what front weights and a filled tank come to.
const BALLAST: f64 = 0.15;
/// A coast-down from this many times the highest recorded speed.
const FASTER: f64 = 1.3;
/// Gentle and hard, as shares of the hardest recorded acceleration.
const GENTLE: f64 = 0.3;
const HARD: f64 = 0.9;
/// An acceleration that any vehicle reaches [m/s²].
const LEAST_ACCELERATION_M_S2: f64 = 0.1;

/// The runs that would go with these recordings.
pub fn courses(case: &Case, base: &Recorded, mass_kg: f64) -> Vec<Course> {
    let like = |name: &'static str, words: &str| Course {
        name,
        words: words.to_owned(),
        motion: Motion::AsRecorded,
        opposite: false,
        ballast_kg: 0.0,
        without: Without::Nothing,
        accelerometer: false,
    };
    let ballast_kg = round(BALLAST * mass_kg);
    let mut all = vec![
        Course {
            opposite: true,
            ..like("other_direction", "drive the same lane once in the other direction")
        },
        Course {
            ballast_kg,
            ..like("ballast", &format!("drive the same run with {ballast_kg} kg of ballast, weighed"))
        },
    ];
    let mut speeds = sorted(case, |drive| &drive.motion.value);
    speeds.retain(|speed| *speed > 0.4);
    let speed = |share: f64| round(quantile(&speeds, share).unwrap_or(1.0));
    let driven = matches!(base.forward(), Some(Drive::Force | Drive::Torque))
        || case.kinds.iter().any(|kind| kind.is_power() || *kind == Kind::Voltage);
    if driven {
        for (name, share) in [("hold_low_speed", 0.1), ("hold_middle_speed", 0.5), ("hold_high_speed", 0.9)] {
            let speed_m_s = speed(share);
            let motion = Motion::Hold { speed_m_s };
            all.push(Course { motion, ..like(name, &format!("hold {speed_m_s} m/s on the same lane")) });
        }
        let slopes = sorted(case, |drive| &drive.motion.slope);
        let hardest = quantile(&slopes, 0.95).unwrap_or(0.0).max(LEAST_ACCELERATION_M_S2);
        let (gentle, hard) = (round(GENTLE * hardest), round(HARD * hardest));
        let motion = Motion::Longer { back_m_s2: gentle.max(0.5 * LEAST_ACCELERATION_M_S2) };
        all.push(Course { motion, ..like("longer", "drive on in the same way for three times as long") });
        let (low, high) = (speed(0.1), speed(0.9));
        if high > 1.2 * low {
            all.push(Course {
                motion: Motion::TwoForces { between_m_s: (low, high), at_m_s2: (gentle, hard) },
                ..like(
                    "two_forces",
                    &format!(
                        "drive up and down between {low} and {high} m/s, by turns at {hard} and at {gentle} m/s²"
                    ),
                )
            });
        }
    }
    if base.force_n.is_some() {
        let from_m_s = round(FASTER * quantile(&speeds, 0.98).unwrap_or(1.0));
        all.push(Course {
            motion: Motion::Coast { from_m_s },
            ..like("coast_from_higher_speed", &format!("coast down from {from_m_s} m/s on the same lane"))
        });
    }
    let less = [
        ("calm_day", "drive the same run on a calm day, and diagnose it by itself", Without::Wind),
        (
            "level_ground",
            "drive the same run on level ground of the same kind, and diagnose it by itself",
            Without::Ground,
        ),
        ("warm", "drive the same run again with everything warm, and diagnose it by itself", Without::Cold),
        (
            "unloaded",
            "drive the same run without implement or trailer, and diagnose it by itself",
            Without::Load,
        ),
        (
            "consumers_off",
            "drive the same run with every consumer off, and diagnose it by itself",
            Without::Consumers,
        ),
    ];
    all.extend(less.map(|(name, words, without)| Course { without, ..like(name, words) }));
    let has = |drive: &Recorded| drive.measured.trace.get("specific_force_m_s2").is_some();
    if base.force_n.is_some() && !case.runs.iter().any(has) {
        let words = "drive the same run with an accelerometer on board";
        all.push(Course { accelerometer: true, ..like("accelerometer", words) });
    }
    all.push(like("same_again", "drive the same run once more"));
    all
}

/// To two digits: nobody holds a speed more exactly.
fn round(value: f64) -> f64 {
    let size = 10f64.powf(value.abs().max(1e-9).log10().floor() - 1.0);
    // A power of ten below one is not exact, its inverse is.
    if size < 1.0 {
        (value * size.recip().round()).round() / size.recip().round()
    } else {
        (value / size).round() * size
    }
}

fn sorted(case: &Case, of: impl Fn(&Recorded) -> &Vec<f64>) -> Vec<f64> {
    let mut values: Vec<f64> =
        case.runs.iter().flat_map(|drive| of(drive).iter().step_by(7)).copied().collect();
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    values
}

fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    (!sorted.is_empty()).then(|| headland_calibrate::statistics::quantile_of_sorted(sorted, share))
}
