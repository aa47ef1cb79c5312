//! One wheel, or the wheels of one side of an axle: how the ground presses, drives, holds and resists.
//!
//! N = k δ + c dδ/dt ≥ 0                                 normal to the ground, along the radius to the plane below the hub
//! σ dζ/dt = (w − u) − max(|u|, |w|) ζ                   slip that a tyre has, which follows with its relaxation length σ
//! σ dη/dt = −v − hypot(u, v) η                          the same across it; at rest both are springs
//! G = soil(ζ, N), or μ N tanh(c_ζ ζ / μ)                along the wheel; the second where the ground knows no slip
//! S = μ_s N tanh(c_α η / μ_s)                           across it
//! (G, S) → (G, S) / max(1, hypot(G / μ, S / μ_s) / N)   no more than the friction ellipse (G / μ)² + (S / μ_s)² = N² holds
//!
//! ζ ← min(|ζ|, 3 μ / c_ζ) sign ζ, η likewise with μ_s, where (w − u) ζ < 0   a tyre that slides is wound no further than it grips
//!
//! u and v are the velocity of the vehicle at the ground, along and across the wheel, w the speed at which it rolls.
//! Sources: Pacejka, *Tire and Vehicle Dynamics* (2012), chapter 7 (single contact point with relaxation), chapter 8 (the bound
//! of the deflection about a rest) and chapter 4 (similarity, the bound of combined forces); Wong, *Theory of Ground Vehicles*
//! (2008), section 1.4 (the friction ellipse); the soil's own for G. Tread and carcass damp slip with the time constant c / k of
//! the tyre. The ground is its mean over the footprint. Leaves out camber, and the moment that turns a wheel back.

use crate::chassis::{AxleBody, Suspension};
use crate::hop::Unsprung;
use headland_plugin::{Contact, Place, Soil, Spot, Tyre, WheelContact};
use rapier3d_f64::prelude::Vector;

/// Soils are asked for slips up to this: a wheel that slips more only spins.
const MOST_SLIP: f64 = 0.9;
/// A tyre that slides goes back from as many times the slip at which its stiffness would bring it to its friction: tanh 3 = 0.995.
const WOUND: f64 = 3.0;
/// Ruts deepen as wheels come to new ground; under one that stands as if it went so fast [m/s].
const SLOWEST_M_S: f64 = 1.0;

/// The wheel as it is built.
#[derive(Clone, Debug)]
pub(crate) struct Wheel<'a> {
    /// As its channels begin.
    pub name: String,
    /// As sentences call it.
    pub told: String,
    pub axle: usize,
    /// Place of the hub in the axes of the vehicle, from its own centre of gravity [m].
    pub arm: Vector,
    pub tyre: &'a Tyre,
    /// Tyres side by side.
    pub tyres: f64,
    pub body: AxleBody,
    /// Of all its tyres [N/m].
    pub stiffness_n_m: f64,
    pub damping_n_s_m: f64,
    /// Wheels that pass before it in its rut, the way the vehicle goes.
    pub earlier: u32,
    /// Half the length of its footprint on level ground [m].
    pub footprint_m: f64,
    /// What its hub springs on; `None` where it is fixed to the chassis.
    pub strut: Option<Strut>,
    /// Slip along and across, ζ and η.
    pub slip: f64,
    pub side: f64,
    /// Depth of the rut [m].
    pub sinkage_m: f64,
    /// How fast it deepens [m/s].
    pub sinking_m_s: f64,
    /// On which it rolls, as it stands on level ground [m].
    pub radius_m: f64,
    /// What keeps it turning with the body as that tilts about its axle, by the last step: a force at its rim [N].
    pub tilting_n: f64,
    /// What it last met.
    pub touch: Touch,
    /// What it last felt.
    pub felt: Felt,
}

/// A suspension and how far it is squeezed.
///
/// k δ + c dδ/dt = k_s x + c_s dx/dt        tyre and suspension carry the same load, where the hub has no mass of its own
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strut {
    pub stiffness_n_m: f64,
    pub damping_n_s_m: f64,
    /// On level ground, where the hub has its place in the axes of the vehicle [m].
    pub level_m: f64,
    pub squeezed_m: f64,
    /// How fast it was squeezed in the mean of a step [m/s].
    pub rate_m_s: f64,
    /// The mass of its hub; `None` where that goes with the chassis.
    pub unsprung: Option<Unsprung>,
}

impl Strut {
    /// A suspension at rest on level ground under the load of its tyres.
    pub fn level(own: Suspension, load_n: f64, gravity_m_s2: f64) -> Self {
        let weight_n = own.unsprung_mass_kg * gravity_m_s2;
        let level_m = (load_n - weight_n) / own.stiffness_n_m;
        let unsprung = (own.unsprung_mass_kg > 0.0).then(|| Unsprung {
            mass_kg: own.unsprung_mass_kg,
            weight_n,
            carried_n: load_n - weight_n,
            ..Unsprung::default()
        });
        let Suspension { stiffness_n_m, damping_n_s_m, .. } = own;
        Self { stiffness_n_m, damping_n_s_m, level_m, squeezed_m: level_m, rate_m_s: 0.0, unsprung }
    }
}

/// Where a wheel meets the ground.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Touch {
    pub point: Vector,
    pub normal: Vector,
    /// Along and across the wheel in the plane of the ground.
    pub along: Vector,
    pub across: Vector,
    /// Hub above the ground, along the normal [m].
    pub height_m: f64,
    pub deflection_m: f64,
    pub load_n: f64,
    /// Velocity of the vehicle there [m/s].
    pub along_m_s: f64,
    pub across_m_s: f64,
    pub steer_rad: f64,
}

/// Forces in the plane of the ground [N].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Felt {
    pub gross_n: f64,
    pub side_n: f64,
    pub resistance_n: f64,
    /// What the soil says of the depth; NaN where it does not know.
    pub rut_m: f64,
}

/// What all wheels share at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scene<'a> {
    pub soil: &'a dyn Soil,
    pub place: Place,
    pub position_m: f64,
    /// Speed of the vehicle [m/s].
    pub speed_m_s: f64,
    /// Load of all wheels [N].
    pub load_n: f64,
    /// Most slip that soils are asked for.
    pub slip_limit: f64,
}

impl Touch {
    /// The hub. What resists a wheel acts there: the ground presses it ahead of its middle, so that none of it is torque.
    pub fn hub(&self) -> Vector {
        self.point + self.normal * self.height_m
    }
}

impl Wheel<'_> {
    /// Height of the hub above the plane below it, along its normal [m], and the normal.
    pub fn above(hub: Vector, spot: &Spot) -> (f64, Vector) {
        let normal = Vector::new(-spot.rise_east, -spot.rise_north, 1.0).normalize();
        ((hub.z - spot.height_m) * normal.z, normal)
    }

    /// Meets the ground: `left` and `ahead` are axes of the vehicle, `velocity` gives that of a point fixed to it.
    pub fn meet(
        &mut self,
        hub: Vector,
        spot: &Spot,
        (ahead, left): (Vector, Vector),
        steer_rad: f64,
        velocity: impl Fn(Vector) -> Vector,
    ) {
        let (height_m, normal) = Self::above(hub, spot);
        let point = hub - normal * height_m;
        let (sin, cos) = steer_rad.sin_cos();
        let axis = left * cos - ahead * sin;
        let along = axis.cross(normal).normalize();
        let across = normal.cross(along);
        let moving = velocity(point);
        let deflection_m = 0.5 * self.tyre.diameter_m - height_m - self.sinkage_m;
        let closing_m_s = -moving.dot(normal) - self.sinking_m_s;
        let (k, c) = (self.stiffness_n_m, self.damping_n_s_m);
        let deflection_m = deflection_m - self.raised_m();
        let mut load_n = k * deflection_m + c * closing_m_s;
        if let Some(strut) = &mut self.strut {
            let springing_n = strut.stiffness_n_m * strut.squeezed_m;
            if let Some(own) = &mut strut.unsprung {
                let before = self.touch.normal;
                own.turned = if before == Vector::ZERO { before } else { normal - before };
                own.body_m_s = moving.dot(normal);
                own.carried_n = springing_n + strut.damping_n_s_m * own.squeezing_m_s;
                load_n -= c * own.squeezing_m_s;
            } else {
                strut.rate_m_s = if deflection_m > 0.0 {
                    (load_n - springing_n) / (strut.damping_n_s_m + c)
                } else {
                    -springing_n / strut.damping_n_s_m
                };
                load_n = springing_n + strut.damping_n_s_m * strut.rate_m_s;
            }
        }
        let load_n = if deflection_m > 0.0 { load_n.max(0.0) } else { 0.0 };
        self.touch = Touch {
            point,
            normal,
            along,
            across,
            height_m,
            deflection_m,
            load_n,
            along_m_s: moving.dot(along),
            across_m_s: moving.dot(across),
            steer_rad,
        };
    }

    /// Feels the ground at the speed at which it rolls, and lets its slips follow for a step.
    pub fn feel(&mut self, scene: &Scene, rolling_m_s: f64, step_s: f64) {
        let Touch { load_n, along_m_s: u, across_m_s: v, point, .. } = self.touch;
        let AxleBody { friction: mu, side_friction, relaxation_length_m: sigma, slip_stiffness, .. } =
            self.body;
        let w = rolling_m_s;
        let unwound = |slip: f64, sliding: f64, (mu, stiffness): (f64, f64)| {
            let most = WOUND * mu / stiffness;
            if sliding * slip < 0.0 { slip.clamp(-most, most) } else { slip }
        };
        self.slip = unwound(self.slip, w - u, (mu, slip_stiffness));
        self.side = unwound(self.side, -v, (side_friction, self.body.cornering_stiffness_per_rad));
        let follow = |slip: f64, sliding: f64, passing: f64| {
            (slip + step_s * sliding / sigma) / (1.0 + step_s * passing / sigma)
        };
        let slip = follow(self.slip, w - u, u.abs().max(w.abs()));
        let side = follow(self.side, -v, u.hypot(v));
        let rate = |after: f64, before: f64| if step_s > 0.0 { (after - before) / step_s } else { 0.0 };
        let damping_s = self.damping_n_s_m / self.stiffness_n_m;
        let felt_slip = slip + damping_s * rate(slip, self.slip);
        let felt_side = side + damping_s * rate(side, self.side);
        (self.slip, self.side) = (slip, side);
        if load_n <= 0.0 {
            (self.slip, self.side) = (0.0, 0.0);
            self.sinking_m_s = 0.0;
            self.felt = Felt { rut_m: f64::NAN, ..Felt::default() };
            return;
        }
        let place = Place { east_m: point.x, north_m: point.y, ..scene.place };
        let position_m = scene.position_m + self.arm.x;
        let footing = scene.soil.wheel(&WheelContact {
            tyre: self.tyre,
            load_n: load_n / self.tyres,
            slip: of_soil(felt_slip).clamp(-scene.slip_limit, scene.slip_limit),
            speed_m_s: u.abs(),
            earlier_passes: self.earlier,
            position_m,
            place,
        });
        let hold_n = mu * load_n;
        let (gross_n, resistance_n, rut_m) = if let Some(footing) = footing {
            let (gross_n, resistance_n) = (footing.gross_traction_n, footing.motion_resistance_n);
            (self.tyres * gross_n, self.tyres * resistance_n, footing.sinkage_m)
        } else {
            let contact = Contact { load_n: scene.load_n, speed_m_s: scene.speed_m_s.abs(), position_m };
            let whole_n = scene.soil.resistance_at_n(&contact, &place);
            let gross_n = hold_n * (slip_stiffness * felt_slip / mu).tanh();
            (gross_n, whole_n * load_n / scene.load_n, f64::NAN)
        };
        let cornering = self.body.cornering_stiffness_per_rad;
        let side_n = side_friction * load_n * (cornering * felt_side / side_friction).tanh();
        // The ellipse drawn out to a circle; where both are the same that changes no bit.
        let beyond = (gross_n.hypot(side_n * (mu / side_friction)) / hold_n).max(1.0);
        let pace_m_s = u.abs().max(SLOWEST_M_S);
        let deeper_m = if rut_m.is_nan() { 0.0 } else { rut_m - self.sinkage_m };
        self.sinking_m_s = deeper_m * pace_m_s / (sigma + step_s * pace_m_s);
        self.felt = Felt { gross_n: gross_n / beyond, side_n: side_n / beyond, resistance_n, rut_m };
    }

    /// Force of the ground on the vehicle in the point where they meet [N], what resists apart.
    pub fn force_n(&self) -> Vector {
        let Touch { normal, along, across, .. } = self.touch;
        normal * self.pressing_n() + along * self.felt.gross_n + across * self.felt.side_n
    }

    /// What presses the vehicle along the normal [N]: the load, or what the suspension carries and the weight of its hub.
    fn pressing_n(&self) -> f64 {
        match self.strut.and_then(|strut| strut.unsprung) {
            Some(own) => own.carried_n + own.weight_n * self.touch.normal.z,
            None => self.touch.load_n,
        }
    }

    /// What its suspension carries [N].
    pub fn carried_n(&self) -> f64 {
        self.strut.and_then(|strut| strut.unsprung).map_or(self.touch.load_n, |own| own.carried_n)
    }

    /// How much higher the hub is in the axes of the vehicle than on level ground [m].
    pub fn raised_m(&self) -> f64 {
        self.strut.map_or(0.0, |strut| strut.squeezed_m - strut.level_m)
    }

    /// Load per way of the chassis, tyre and suspension in line [N/m].
    pub fn standing_n_m(&self) -> f64 {
        let k = self.stiffness_n_m;
        self.strut.map_or(k, |strut| k * strut.stiffness_n_m / (k + strut.stiffness_n_m))
    }

    /// Stands at rest where the ground is so far above the tyre of a hub at its place [m]: takes its load, and squeezes. Of the
    /// weight of the hub the part `upright` presses along the normal of the ground.
    pub fn stand(&mut self, above_m: f64, upright: f64) {
        let level_m = self.strut.map_or(0.0, |strut| strut.level_m);
        let unsprung = self.strut.and_then(|strut| strut.unsprung);
        let hub_n = unsprung.map_or(0.0, |own| own.weight_n * upright);
        let lowered_m = self.strut.map_or(0.0, |strut| hub_n / strut.stiffness_n_m);
        let load_n = (self.standing_n_m() * (above_m + level_m + lowered_m)).max(0.0);
        if let Some(strut) = &mut self.strut {
            strut.squeezed_m = (load_n - hub_n) / strut.stiffness_n_m;
        }
        self.touch.load_n = load_n;
        self.touch.deflection_m = above_m - self.raised_m();
    }

    /// Lets rut and suspension follow for a step.
    pub fn settle(&mut self, step_s: f64) {
        self.sinkage_m += step_s * self.sinking_m_s;
        if let Some(strut) = &mut self.strut {
            // The hub's own motion is half-implicit, as that of the body.
            strut.squeezed_m += step_s * strut.unsprung.map_or(strut.rate_m_s, |own| own.squeezing_m_s);
        }
    }

    /// Energy in its tyres [J].
    pub fn spring_j(&self, deflection_m: f64) -> f64 {
        let pressed_m = deflection_m.max(0.0);
        0.5 * self.stiffness_n_m * pressed_m * pressed_m
    }
}

/// A tyre's slip as soils count it: speeds are related to that at which the wheel rolls, also where it brakes.
fn of_soil(slip: f64) -> f64 {
    let slip = slip.clamp(-MOST_SLIP / (1.0 + MOST_SLIP), MOST_SLIP);
    if slip < 0.0 { slip / (1.0 + slip) } else { slip }
}
