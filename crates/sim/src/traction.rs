//! What ground and driveline make of a command, for a vehicle that its wheels carry.
//!
//! Loads make traction, traction makes acceleration, acceleration moves the load: one number, the moment that turns the
//! vehicle, is sought by the secant method until it makes itself again. For each try of it the slip is sought at which the
//! ground gives what is wanted, then the driveline is asked at the speed of wheels that slip so; where it gives less, what
//! it gives and the slip that goes with it are sought together.

use crate::Model;
use crate::axles::Axles;
use crate::balance::{Asked, Command, Instant, Rolled, Scratch, Sums, tell};
use crate::ledger::Slots;
use crate::root::{Root, rising};
use crate::wheels::{AxleState, FIRST_STEP, Grip, Stance, Stuck, TOLERANCE, WheelScratch};
use headland_plugin::{Delivery, Demand, Soil};

/// First step of the search for slip near that under slightly other loads.
const NEXT_STEP: f64 = 1e-4;
/// Loads are found again where the moment is, to this lever [m].
const SAME_MOMENT_M: f64 = 1e-11;
/// Each iteration finds a digit or more; this many find all there are.
const MOST_ITERATIONS: usize = 40;

/// What is asked of the ground.
#[derive(Clone, Copy)]
enum Goal {
    /// Tractions less what they lose and what resists the wheels [N].
    Net(f64),
    /// A force of the driveline [N].
    Force(f64),
}

/// One try.
struct Tried {
    rolled: Rolled,
    stuck: Option<Stuck>,
    slip: f64,
    /// What the forces turn the vehicle forward with [N m].
    moment_n_m: f64,
}

/// The slip that was found for a goal, and the force of the driveline that it takes, along the motion [N].
#[derive(Clone, Copy)]
struct Wanted {
    goal: Goal,
    root: Root,
    force_n: f64,
}

impl Model {
    /// The instant of a vehicle with axles.
    #[allow(clippy::too_many_arguments, reason = "as in the balance, whose other branch this is")]
    #[allow(
        clippy::large_types_passed_by_value,
        reason = "a reference would keep the other branch in memory"
    )]
    #[inline(never)]
    pub(crate) fn carried(
        &self,
        ground: (&Axles, &dyn Soil),
        asked: Asked,
        sums: Sums,
        slots: &Slots,
        rates: &mut [f64],
        powers: &mut [f64],
        scratch: &mut Scratch,
    ) -> Instant {
        let rolled = self.on_wheels(ground, &asked, &sums, rates, &mut scratch.wheels);
        tell(&asked, &sums, &rolled, slots, &scratch.actions, powers)
    }

    /// The forces of a vehicle with axles.
    fn on_wheels(
        &self,
        (axles, soil): (&Axles, &dyn Soil),
        asked: &Asked,
        sums: &Sums,
        rates: &mut [f64],
        scratch: &mut WheelScratch,
    ) -> Rolled {
        let weight_n = asked.situation.mass_kg * self.gravity_m_s2 * asked.situation.place.cos_slope();
        scratch.axles.resize(axles.list().len(), AxleState::default());
        let mut stance = Stance {
            soil,
            axles,
            situation: asked.situation,
            rolling_m_s: (asked.situation.speed_m_s * asked.direction).max(0.0),
            backward: asked.direction < 0.0,
            states: &mut scratch.axles,
            firm: false,
        };
        stance.place();
        let (mut moment, mut before, mut near) = (0.0, None::<(f64, f64)>, None);
        let mut iteration = 0;
        loop {
            stance.load(weight_n, moment, axles.slip_limit);
            let tried = self.attempt(&mut stance, asked, sums, rates, near);
            let off = tried.moment_n_m - moment;
            iteration += 1;
            let done =
                off.abs() <= SAME_MOMENT_M * weight_n || iteration == MOST_ITERATIONS || !off.is_finite();
            if done {
                scratch.stuck = stance.gone().or(tried.stuck);
                return tried.rolled;
            }
            near = Some(tried.slip);
            let next = match before {
                Some((at, was)) if was != off => moment - off * (moment - at) / (off - was),
                _ => tried.moment_n_m,
            };
            before = Some((moment, off));
            moment = next;
        }
    }

    /// Asks ground and driveline for what the command says, at the loads of the stance.
    fn attempt(
        &self,
        stance: &mut Stance,
        asked: &Asked,
        sums: &Sums,
        rates: &mut [f64],
        near: Option<f64>,
    ) -> Tried {
        let wanted = self.want(stance, asked, sums, near);
        let mut situation = asked.situation;
        situation.tractive_force_n = asked.way() * wanted.force_n;
        let mut demand = asked.demand;
        demand.force_n =
            self.govern(&situation, asked.command, asked.given, asked.layout, asked.states, rates);
        let (delivery, slip) = self.given(stance, asked, sums, rates, (&wanted, &mut demand));
        let grip = if stance.firm { stance.roll(asked.way() * delivery.force_n) } else { stance.grip(slip) };
        let friction = self.vehicle.brake_friction;
        let rolled = moved(asked, sums, &wanted, &grip, (delivery, demand, slip), (stance, friction));
        // The ground is what falls short where the driveline gives all that the ground could take.
        let short = !wanted.root.reached && wanted.root.at > 0.0 && delivery.force_n == demand.force_n;
        let stuck = short.then_some(Stuck::Slip { slip, most_n: grip.gross_n });
        let moment_n_m = self.moment_n_m(stance.axles, asked, sums, &rolled, &grip);
        Tried { rolled, stuck, slip, moment_n_m }
    }

    /// The slip at which the ground gives what the command wants, and the force of the driveline for it.
    fn want(&self, stance: &mut Stance, asked: &Asked, sums: &Sums, near: Option<f64>) -> Wanted {
        let way = asked.way();
        let resting = asked.situation.speed_m_s == 0.0;
        let goal = match asked.command {
            Command::Coast => Goal::Force(0.0),
            Command::Recorded(force_n) => Goal::Force(way * force_n),
            Command::Push(wanted) => Goal::Force(way * asked.effective_mass_kg * wanted),
            Command::Accelerate(wanted) if resting && wanted == 0.0 => Goal::Force(0.0),
            Command::Accelerate(wanted) => Goal::Net(
                way * (asked.effective_mass_kg * wanted - asked.free_n) + sums.resistance_n + sums.drawbar_n,
            ),
        };
        if stance.firm {
            let force_n = match goal {
                Goal::Force(force_n) => force_n,
                Goal::Net(net_n) => {
                    let gross_n = net_n + held_n(&stance.roll(0.0), sums);
                    gross_n / (1.0 - sums.loss_share * gross_n.signum())
                }
            };
            return Wanted { goal, root: Root { at: 0.0, reached: true }, force_n };
        }
        let root = self.slip(stance, asked, sums, goal, near);
        // What was recorded was driven, whatever the ground of the model would have given.
        let recorded = asked.given.is_driven() || matches!(asked.command, Command::Recorded(_));
        let force_n = match goal {
            Goal::Force(force_n) if root.reached || recorded => force_n,
            _ => stance.grip(root.at).force_n,
        };
        Wanted { goal, root, force_n }
    }

    fn slip(&self, stance: &mut Stance, asked: &Asked, sums: &Sums, goal: Goal, near: Option<f64>) -> Root {
        let limit = stance.axles.slip_limit;
        let tolerance = TOLERANCE * asked.situation.mass_kg * self.gravity_m_s2;
        let (start, step) = near.map_or((0.0, FIRST_STEP), |slip| (slip, NEXT_STEP));
        let miss = |slip: f64| {
            let grip = stance.grip(slip);
            match goal {
                Goal::Net(net_n) => net_of(&grip, sums) - net_n,
                Goal::Force(force_n) => grip.force_n - force_n,
            }
        };
        rising(miss, start, step, (-limit, limit), tolerance)
    }

    /// What the driveline gives at the speed at which the wheels turn under it, and their slip.
    fn given(
        &self,
        stance: &mut Stance,
        asked: &Asked,
        sums: &Sums,
        rates: &mut [f64],
        (wanted, demand): (&Wanted, &mut Demand),
    ) -> (Delivery, f64) {
        let way = asked.way();
        let tolerance = TOLERANCE * asked.situation.mass_kg * self.gravity_m_s2;
        let own = asked.layout.driveline.clone();
        let asked_n = demand.force_n;
        let mut ask = |force_n: f64| {
            let slip = if stance.firm {
                0.0
            } else if way * force_n == wanted.force_n {
                wanted.root.at
            } else {
                self.slip(stance, asked, sums, Goal::Force(way * force_n), Some(wanted.root.at)).at
            };
            demand.speed_m_s = turning_m_s(asked, sums, slip, force_n);
            let delivery =
                self.deliver(demand, (sums, way), &asked.states[own.clone()], &mut rates[own.clone()]);
            (delivery, slip)
        };
        let mut force_n = asked_n;
        let (mut delivery, mut slip) = ask(force_n);
        if let Command::Recorded(recorded_n) = asked.command {
            sums.record(&mut delivery, recorded_n, (demand.speed_m_s, way));
            return (delivery, slip);
        }
        let mut before = None::<(f64, f64)>;
        for _ in 0..MOST_ITERATIONS {
            let off = delivery.force_n - force_n;
            if off.abs() <= tolerance || off.is_nan() {
                break;
            }
            let next = match before {
                Some((at, was)) if was != off => force_n - off * (force_n - at) / (off - was),
                _ => delivery.force_n,
            };
            before = Some((force_n, off));
            force_n = next;
            (delivery, slip) = ask(force_n);
        }
        (delivery, slip)
    }

    /// What turns the vehicle forward about the ground below its centre of gravity [N m].
    fn moment_n_m(&self, axles: &Axles, asked: &Asked, sums: &Sums, rolled: &Rolled, grip: &Grip) -> f64 {
        let (mass_kg, sin) = (asked.situation.mass_kg, asked.situation.place.sin_slope);
        let climbing_m_s2 = rolled.acceleration_m_s2 + self.gravity_m_s2 * sin;
        let above_n = asked.air_n + sums.pushed_n - mass_kg * climbing_m_s2;
        let hitch_n = rolled.way * sums.drawbar_n - sums.task_push_n + sums.towed_kg * climbing_m_s2;
        above_n * axles.centre_of_gravity_height_m
            - hitch_n * axles.hitch_height_m
            - rolled.way * grip.resisting_n_m
    }
}

/// What holds the wheels back: an effect may say that the ground resists less, and never that it drives [N].
fn held_n(grip: &Grip, sums: &Sums) -> f64 {
    grip.resistance_n.max(-(sums.resistance_n + sums.drawbar_n))
}

fn net_of(grip: &Grip, sums: &Sums) -> f64 {
    grip.gross_n - sums.loss_share * grip.force_n.abs() - held_n(grip, sums)
}

/// Speed at which the driveline turns the wheels, with the slip that effects add.
fn turning_m_s(asked: &Asked, sums: &Sums, slip: f64, force_n: f64) -> f64 {
    sums.turning_m_s(asked.situation.speed_m_s / (1.0 - slip), force_n, asked.direction)
}

/// How the vehicle moves under what driveline and ground give.
fn moved(
    asked: &Asked,
    sums: &Sums,
    wanted: &Wanted,
    grip: &Grip,
    (delivery, demand, slip): (Delivery, Demand, f64),
    (stance, friction): (&mut Stance, f64),
) -> Rolled {
    let way = asked.way();
    let force_n = way * delivery.force_n;
    let lost_n = |force_n: f64| sums.loss_share * force_n.abs();
    // A recorded force may be more than the ground of the model gives; it moved the vehicle all the same.
    let traction_n = grip.gross_n + (force_n - grip.force_n);
    let ground_n = held_n(grip, sums);
    let brake_n = asked.brake_n(|| {
        let served = wanted.root.reached && force_n == wanted.force_n;
        let more_n = match wanted.goal {
            Goal::Net(net_n) => traction_n - lost_n(force_n) - ground_n - net_n,
            Goal::Force(goal_n) => (force_n - lost_n(force_n)) - (goal_n - lost_n(goal_n)),
        };
        if served { 0.0 } else { more_n }
    });
    let driving_n = way * traction_n + asked.free_n;
    let held_n = ground_n + sums.resistance_n + sums.drawbar_n + lost_n(force_n);
    let (brake_n, locked) = if brake_n > 0.0 {
        // Driven wheels that are braked too have the sum of both from the ground.
        let most_n = stance.locked_n(friction) + traction_n;
        asked.held_by_ground(brake_n, most_n, driving_n, held_n)
    } else {
        (brake_n, false)
    };
    if locked {
        stance.lock(friction);
    }
    let (way, acceleration_m_s2) = asked.moves(driving_n, held_n + brake_n);
    Rolled {
        demand,
        delivery,
        ground_n,
        brake_n,
        way,
        acceleration_m_s2,
        traction_n: asked.way() * traction_n,
        slip,
        rolling_m_s: asked.situation.speed_m_s / (1.0 - slip),
        locked,
    }
}
