//! How each kind of phase is driven.

use crate::balance::{Command, Instant};
use crate::cycle::{Hopeless, Running};
use crate::ending::Ending;
use crate::hand::{Hand, Knowing, Standing};
use crate::plan::{Phase, Until};
use crate::quasi_static::Stretch;
use crate::reference::{Driver, Reference};
use crate::step::{Machine, Moment};
use std::cell::Cell;

/// Below this acceleration [m/s²] a vehicle that wants more has reached the end of its force.
const NO_MORE_ACCELERATION_M_S2: f64 = 1e-5;

/// A gain of speed [m/s] that tells a drive that is getting there from one that sways.
const PROGRESS_M_S: f64 = 1e-3;

impl Running<'_> {
    /// What the driver keeps at hand.
    fn hand(&self) -> Hand {
        Hand::new(self.machine.time_s, &self.setting.engine_speed, self.backward)
    }

    /// Drives a phase; says what ended it.
    pub(crate) fn drive(&mut self, phase: &Phase) -> Result<String, String> {
        let begin_s = self.machine.time_s;
        self.backward = matches!(phase, Phase::Hold { .. }) && self.target_m_s < 0.0;
        match phase {
            Phase::Reach { speed_m_s, acceleration_m_s2 } => self.reach(*speed_m_s, *acceleration_m_s2),
            Phase::Hold { for_s } => {
                let ending = Ending::of(&Until::Elapsed(*for_s), &self.machine)?;
                if self.quasi_static || self.setting.driver.is_some() {
                    let reference = Reference::steady(begin_s, self.target_m_s);
                    return self.follow(&reference, &ending, None);
                }
                let (gain, target, hand) = (self.cycle.driver_gain_per_s, self.target_m_s, self.hand());
                let control = |at: &Moment| {
                    (Command::Accelerate(gain * (target - at.speed_m_s)), hand.given(at.time_s))
                };
                self.until(&control, &ending, f64::INFINITY, None)?;
                Ok(ending.told(&self.machine.moment()))
            }
            Phase::Coast { until } => self.coast(until),
            Phase::Follow { profile } => {
                let last_s = profile.last().map_or(0.0, |(at_s, _)| *at_s);
                let ending = Ending::at_time(begin_s + last_s, "at the end of the profile".to_owned());
                self.follow(&Reference::along(begin_s, profile), &ending, None)
            }
            Phase::Drive { speed_m_s, acceleration_m_s2, tolerance_m_s, until } => {
                self.drive_at(*speed_m_s, *acceleration_m_s2, *tolerance_m_s, until)
            }
            Phase::DriveByPlace { profile, acceleration_m_s2, until } => {
                self.by_place(profile, *acceleration_m_s2, until)
            }
            Phase::Stand { until } => {
                if self.machine.speed_m_s() != 0.0 {
                    let speed = self.machine.speed_m_s();
                    return Err(format!("the vehicle is to stand, and rolls at {speed:.2} m/s"));
                }
                self.target_m_s = 0.0;
                let ending = Ending::of(until, &self.machine)?;
                self.stand(&ending)
            }
            Phase::With { .. } => Err("a phase stands within another".to_owned()),
        }
    }

    fn reach(&mut self, target: f64, acceleration_m_s2: f64) -> Result<String, String> {
        let up = target > self.machine.speed_m_s();
        let rate = if up { acceleration_m_s2 } else { -acceleration_m_s2 };
        self.target_m_s = target;
        if target == self.machine.speed_m_s() {
            return Ok("it drives at that speed".to_owned());
        }
        let hand = self.hand();
        let control = |at: &Moment| (Command::Accelerate(rate), hand.given(at.time_s));
        let ending = Ending::at_speed(target, up);
        let patience_s = self.machine.model.driveline.patience_s();
        // How far it came, and when.
        let best = Cell::new((f64::NEG_INFINITY, self.machine.time_s));
        self.until(&control, &ending, f64::INFINITY, Some(&|machine, instant| {
            let progress = machine.speed_m_s() * rate.signum();
            if progress > best.get().0 + PROGRESS_M_S {
                best.set((progress, machine.time_s));
            }
            if machine.time_s - best.get().1 < patience_s {
                return None;
            }
            let short = (machine.speed_m_s() - target).abs() > 0.0
                && instant.acceleration_m_s2 * rate.signum() < NO_MORE_ACCELERATION_M_S2;
            short.then(|| {
                format!(
                    "the drive cannot bring the vehicle to {target:.2} m/s: at {:.2} m/s its force of {:.0} N \
                     only matches the resistances",
                    machine.speed_m_s(),
                    instant.delivery.force_n
                )
            })
        }))?;
        Ok(ending.told(&self.machine.moment()))
    }

    fn coast(&mut self, until: &Until) -> Result<String, String> {
        let hand = self.hand();
        let control = |at: &Moment| (Command::Coast, hand.given(at.time_s));
        let ending = Ending::of(until, &self.machine)?;
        // Time comes to a vehicle at rest too; and one that was at rest may be waiting for a slope's pull.
        let moving = self.machine.speed_m_s() != 0.0;
        let waits = moving && !ending.comes_at_rest() && *until != Until::Stopped;
        let result = self.until(
            &control,
            &ending,
            f64::INFINITY,
            Some(&|machine, instant| {
                (waits && machine.speed_m_s() == 0.0 && instant.acceleration_m_s2 == 0.0)
                    .then(|| "the vehicle has come to rest before the end of the coasting phase".to_owned())
            }),
        );
        self.target_m_s = self.machine.speed_m_s();
        result.map(|_| ending.told(&self.machine.moment()))
    }

    /// Comes to a speed and keeps it; one below 0 is backward.
    fn drive_at(
        &mut self,
        target: f64,
        acceleration_m_s2: f64,
        tolerance_m_s: Option<f64>,
        until: &Until,
    ) -> Result<String, String> {
        let speed = self.machine.speed_m_s();
        if target < 0.0 && speed > 0.0 {
            return Err(format!(
                "the vehicle is to drive backward, and still rolls forward at {speed:.2} m/s: it has to stop first"
            ));
        }
        let way = if target < 0.0 || (target == 0.0 && speed < 0.0) { -1.0 } else { 1.0 };
        self.backward = way < 0.0;
        let mut ending = Ending::toward(until, &self.machine, way < 0.0)?;
        self.target_m_s = target;
        if target == 0.0 {
            if speed != 0.0 {
                let hand = self.hand();
                let slowing = -way * acceleration_m_s2;
                let control = |at: &Moment| (Command::Accelerate(slowing), hand.given(at.time_s));
                let rests = |machine: &Machine, _: &Instant| (machine.speed_m_s() == 0.0).then(String::new);
                match self.until(&control, &ending, f64::INFINITY, Some(&rests)) {
                    Err(reason) if reason.is_empty() => {}
                    Err(reason) => return Err(reason),
                    Ok(_) => return Ok(ending.told(&self.machine.moment())),
                }
            }
            return self.stand(&ending);
        }
        if speed == 0.0 {
            ending = ending.without_rest();
        }
        let reference = Reference::ramp(self.machine.time_s, speed, target, acceleration_m_s2);
        self.follow(&reference, &ending, Some(&|machine, instant| {
            let behind = way * (reference.speed_m_s(machine.time_s) - machine.speed_m_s());
            let stalled =
                machine.speed_m_s() == 0.0 && way * instant.acceleration_m_s2 <= 0.0 && behind > 0.0;
            let force = instant.delivery.force_n;
            if stalled {
                return Some(format!(
                    "the vehicle stands where it is to drive at {target:.2} m/s: the {force:.0} N of its drive do not \
                     overcome the resistances"
                ));
            }
            tolerance_m_s.filter(|tolerance| behind > *tolerance).map(|tolerance| {
                format!(
                    "the speed of {:.2} m/s falls behind what is wanted by {behind:.2} m/s, more than the {tolerance} m/s \
                     that are tolerated: the drive gives {force:.0} N",
                    machine.speed_m_s()
                )
            })
        }))
    }

    /// Follows a reference piece by piece, so that no step crosses one of its corners.
    fn follow(
        &mut self,
        reference: &Reference,
        ending: &Ending,
        hopeless: Hopeless,
    ) -> Result<String, String> {
        let driver = self.setting.driver.map_or(Driver::Knowing(self.cycle.driver_gain_per_s), Driver::Pi);
        let memory = self.machine.layout.driver;
        let hand = self.hand();
        // A piece ends where the next one begins, to the bit: rounding must not leave the vehicle on the last one.
        for (piece, corner_s) in reference.corners_s().into_iter().chain([f64::INFINITY]).enumerate() {
            self.target_m_s = if corner_s.is_finite() {
                reference.on(piece + 1, corner_s).0
            } else {
                reference.speed_m_s(self.machine.time_s)
            };
            let ended = match driver {
                Driver::Knowing(gain_per_s) => {
                    let control = Knowing { gain_per_s, reference, piece, hand: &hand };
                    if self.quasi_static {
                        let control = &control;
                        self.along(&Stretch { reference, piece, end_s: corner_s, control, ending, hopeless })?
                    } else {
                        self.until(&control, ending, corner_s, hopeless)?
                    }
                }
                Driver::Pi(pi) => {
                    let control =
                        |at: &Moment| pi.follow(reference, piece, memory, at, &hand.given(at.time_s));
                    self.until(&control, ending, corner_s, hopeless)?
                }
            };
            if ended {
                break;
            }
        }
        Ok(ending.told(&self.machine.moment()))
    }

    fn by_place(&mut self, profile: &[(f64, f64)], most: f64, until: &Until) -> Result<String, String> {
        let mut ending = Ending::of(until, &self.machine)?;
        if self.machine.speed_m_s() == 0.0 {
            ending = ending.without_rest();
        }
        // A speed by place is a reference over position in place of time.
        let wanted = Reference::along(0.0, profile);
        let (gain, hand) = (self.cycle.driver_gain_per_s, self.hand());
        let control = |at: &Moment| {
            let (speed, slope) = wanted.at(at.position_m);
            let acceleration = slope * at.speed_m_s + gain * (speed - at.speed_m_s);
            (Command::Accelerate(acceleration.clamp(-most, most)), hand.given(at.time_s))
        };
        self.until(&control, &ending, f64::INFINITY, Some(&|machine, instant| {
            (machine.speed_m_s() == 0.0 && instant.acceleration_m_s2 <= 0.0).then(|| {
                let force = instant.delivery.force_n;
                format!("the vehicle stands on its way: the {force:.0} N of its drive do not overcome the resistances")
            })
        }))?;
        self.target_m_s = self.machine.speed_m_s();
        Ok(ending.told(&self.machine.moment()))
    }

    fn stand(&mut self, ending: &Ending) -> Result<String, String> {
        if !ending.comes_at_rest() && ending.left(&self.machine.moment()) > 0.0 {
            return Err("the vehicle stands, and nothing that the phase waits for comes to one that stands"
                .to_owned());
        }
        let hand = self.hand();
        let control = Standing(&hand);
        if self.quasi_static {
            let rest = Reference::steady(self.machine.time_s, 0.0);
            let (reference, control) = (&rest, &control);
            let end_s = f64::INFINITY;
            self.along(&Stretch { reference, piece: 0, end_s, control, ending, hopeless: None })?;
        } else {
            self.until(&control, ending, f64::INFINITY, None)?;
        }
        Ok(ending.told(&self.machine.moment()))
    }
}
