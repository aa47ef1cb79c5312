//! The rigid body of a vehicle: read, checked, refused with its place.

use crate::axles::TYRE_BOUNDS;
use crate::document::Document;
use crate::error::ScenarioError;
use crate::plugins::bounded;
use crate::schema::{FidelityFile, ScenarioFile, VehicleFile};
use crate::trailer::{TRAILER_AXLE_BOUNDS, TRAILER_BOUNDS, TrailerFile, trailer};
use headland_body::{
    AxleBody, BodyError, Chassis, Differential, Payload, RunError, Steering, SteeringMode, Suspension, check,
    simulate_unless,
};
use headland_plugin::Bound;
use headland_sim::{Cycle, Model, Outcome, Simulation};
use serde::Deserialize;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "body")]
pub struct BodyFile {
    pub roll_inertia_kg_m2: f64,
    pub pitch_inertia_kg_m2: f64,
    pub yaw_inertia_kg_m2: f64,
    pub hitch_position_m: f64,
    pub payload: Option<PayloadFile>,
    pub steering: SteeringFile,
    pub centre: DifferentialFile,
    pub axles: Vec<AxleBodyFile>,
    pub trailer: Option<TrailerFile>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "payload")]
pub struct PayloadFile {
    pub position_m: f64,
    pub height_m: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "steering")]
pub struct SteeringFile {
    pub mode: ModeFile,
    pub limit_rad: f64,
    pub rate_rad_s: f64,
    pub look_ahead_m: f64,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename = "steering mode")]
pub enum ModeFile {
    Front,
    All,
    Crab { angle_rad: f64 },
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename = "differential")]
pub enum DifferentialFile {
    Open,
    Locked,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "axle of the body")]
pub struct AxleBodyFile {
    pub damping_n_s_m: f64,
    pub friction: f64,
    pub side_friction: Option<f64>,
    pub slip_stiffness: f64,
    pub cornering_stiffness_per_rad: f64,
    pub relaxation_length_m: f64,
    pub differential: DifferentialFile,
    pub suspension: Option<SuspensionFile>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "suspension")]
pub struct SuspensionFile {
    pub stiffness_n_m: f64,
    pub damping_n_s_m: f64,
    pub unsprung_mass_kg: Option<f64>,
}

/// What simulates a scenario.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Fidelity {
    /// One degree of freedom along the path.
    #[default]
    Longitudinal,
    /// The same, asked once a step where its motion is known beforehand.
    QuasiStatic {
        /// Between two rows of the trace [s].
        record_s: f64,
    },
    /// A body on wheels over the surface.
    RigidBody {
        /// The body.
        chassis: Box<Chassis>,
        /// Between two rows of the trace [s].
        record_s: f64,
    },
}

impl Fidelity {
    /// What it is, in words.
    pub fn told(&self) -> &'static str {
        match self {
            Self::Longitudinal => "longitudinal",
            Self::QuasiStatic { .. } => "longitudinal, quasistatic",
            Self::RigidBody { .. } => "rigid body",
        }
    }

    /// Drives a model through a cycle.
    ///
    /// # Errors
    /// [`RunError`] where a body cannot stand on its ground.
    pub fn simulate(&self, model: &Model, cycle: &Cycle) -> Result<Outcome, RunError> {
        self.simulate_unless(model, cycle, &|| false)
    }

    /// As [`Fidelity::simulate`], and ends as [`headland_sim::End::Interrupted`] soon after `stop` says so.
    ///
    /// # Errors
    /// As [`Fidelity::simulate`].
    pub fn simulate_unless(
        &self,
        model: &Model,
        cycle: &Cycle,
        stop: &dyn Fn() -> bool,
    ) -> Result<Outcome, RunError> {
        let simulation = || Simulation::new(model, cycle).unless(stop);
        match self {
            Self::Longitudinal => Ok(simulation().run()?),
            Self::QuasiStatic { record_s } => Ok(simulation().quasi_static(*record_s).run()?),
            Self::RigidBody { chassis, record_s } => simulate_unless(model, chassis, cycle, *record_s, stop),
        }
    }
}

/// Bounds of the numbers of a body.
pub const BOUNDS: [(&str, Bound); 9] = [
    ("roll_inertia_kg_m2", Bound::Positive),
    ("pitch_inertia_kg_m2", Bound::Positive),
    ("yaw_inertia_kg_m2", Bound::Positive),
    ("hitch_position_m", Bound::Within(-50.0, 50.0)),
    ("payload.position_m", Bound::Within(-50.0, 50.0)),
    ("payload.height_m", Bound::Within(0.0, 20.0)),
    ("steering.limit_rad", Bound::Within(0.01, 1.5)),
    ("steering.rate_rad_s", Bound::Positive),
    ("steering.look_ahead_m", Bound::Positive),
];

/// Bounds of those of each of its axles.
pub const AXLE_BOUNDS: [(&str, Bound); 9] = [
    ("damping_n_s_m", Bound::NotNegative),
    ("friction", Bound::Within(0.01, 3.0)),
    ("side_friction", Bound::Within(0.01, 3.0)),
    ("slip_stiffness", Bound::Positive),
    ("cornering_stiffness_per_rad", Bound::Positive),
    ("relaxation_length_m", Bound::Within(0.01, 10.0)),
    ("suspension.stiffness_n_m", Bound::Positive),
    ("suspension.damping_n_s_m", Bound::Positive),
    ("suspension.unsprung_mass_kg", Bound::NotNegative),
];

pub fn suspension(file: Option<&SuspensionFile>) -> Option<Suspension> {
    file.map(|own| Suspension {
        stiffness_n_m: own.stiffness_n_m,
        damping_n_s_m: own.damping_n_s_m,
        unsprung_mass_kg: own.unsprung_mass_kg.unwrap_or(0.0),
    })
}

/// The body of a vehicle; `None` where it has none.
fn chassis(document: &Document, vehicle: &VehicleFile) -> Result<Option<Chassis>, ScenarioError> {
    let Some(body) = &vehicle.body else { return Ok(None) };
    let bound = |path: &str, bound: Bound| -> Result<(), ScenarioError> {
        let whole = format!("vehicle.body.{path}");
        if let (Some(node), Some(value)) = (document.find(&whole), document.number(&whole)) {
            let name = path.rsplit('.').next().unwrap_or(path);
            bounded(document, name, value, bound, node.span.start)?;
        }
        Ok(())
    };
    BOUNDS.into_iter().try_for_each(|(path, limits)| bound(path, limits))?;
    for index in 0..body.axles.len() {
        AXLE_BOUNDS
            .into_iter()
            .try_for_each(|(path, limits)| bound(&format!("axles.{index}.{path}"), limits))?;
    }
    if let Some(trailer) = &body.trailer {
        TRAILER_BOUNDS
            .into_iter()
            .try_for_each(|(path, limits)| bound(&format!("trailer.{path}"), limits))?;
        for index in 0..trailer.axles.len() {
            let of_axle =
                |(path, limits): (&str, Bound)| bound(&format!("trailer.axles.{index}.{path}"), limits);
            TRAILER_AXLE_BOUNDS.into_iter().chain(AXLE_BOUNDS).chain(TYRE_BOUNDS).try_for_each(of_axle)?;
        }
    }
    let differential = |file: DifferentialFile| match file {
        DifferentialFile::Open => Differential::Open,
        DifferentialFile::Locked => Differential::Locked,
    };
    Ok(Some(Chassis {
        roll_inertia_kg_m2: body.roll_inertia_kg_m2,
        pitch_inertia_kg_m2: body.pitch_inertia_kg_m2,
        yaw_inertia_kg_m2: body.yaw_inertia_kg_m2,
        hitch_position_m: body.hitch_position_m,
        payload: body
            .payload
            .as_ref()
            .map(|payload| Payload { position_m: payload.position_m, height_m: payload.height_m }),
        steering: Steering {
            mode: match body.steering.mode {
                ModeFile::Front => SteeringMode::Front,
                ModeFile::All => SteeringMode::All,
                ModeFile::Crab { angle_rad } => SteeringMode::Crab { angle_rad },
            },
            limit_rad: body.steering.limit_rad,
            rate_rad_s: body.steering.rate_rad_s,
            look_ahead_m: body.steering.look_ahead_m,
        },
        centre: differential(body.centre),
        axles: body
            .axles
            .iter()
            .map(|axle| AxleBody {
                damping_n_s_m: axle.damping_n_s_m,
                friction: axle.friction,
                side_friction: axle.side_friction.unwrap_or(axle.friction),
                slip_stiffness: axle.slip_stiffness,
                cornering_stiffness_per_rad: axle.cornering_stiffness_per_rad,
                relaxation_length_m: axle.relaxation_length_m,
                differential: differential(axle.differential),
                suspension: suspension(axle.suspension.as_ref()),
            })
            .collect(),
        trailer: body.trailer.as_ref().map(trailer),
    }))
}

/// The fidelity that a scenario asks for, checked with its model and its cycle.
pub fn fidelity(
    document: &Document,
    file: &ScenarioFile,
    model: &Model,
    cycle: Option<&Cycle>,
) -> Result<Fidelity, ScenarioError> {
    let at = |path: &str| document.location(document.find(path).map_or(0, |node| node.span.start));
    let lacks = |field: &str| ScenarioError::MissingField {
        field: field.to_owned(),
        of: "`vehicle` with `fidelity: RigidBody`".to_owned(),
        at: at("vehicle"),
    };
    let chassis = chassis(document, &file.vehicle)?;
    if let (Some(chassis), Some(axles)) = (&chassis, &model.axles) {
        chassis.check(axles).map_err(|refusal| refused(document, &BodyError::Chassis(refusal)))?;
    }
    let record_s = match file.simulation.fidelity {
        FidelityFile::Longitudinal => return Ok(Fidelity::Longitudinal),
        FidelityFile::QuasiStatic { record_s } => return Ok(Fidelity::QuasiStatic { record_s }),
        FidelityFile::RigidBody { record_s } => record_s,
    };
    if model.axles.is_none() {
        return Err(lacks("axles"));
    }
    let chassis = chassis.ok_or_else(|| lacks("body"))?;
    if let Some(cycle) = cycle {
        check(model, &chassis, cycle).map_err(|error| refused(document, &error))?;
    }
    Ok(Fidelity::RigidBody { chassis: Box::new(chassis), record_s })
}

/// Where a scenario says what a body is refused for.
fn refused(document: &Document, error: &BodyError) -> ScenarioError {
    let path = match error {
        BodyError::NoAxles => "vehicle".to_owned(),
        BodyError::NothingTowed => "vehicle.body.trailer".to_owned(),
        BodyError::NotPositive { name, .. } => format!("vehicle.{name}"),
        BodyError::Chassis(refusal) => format!("vehicle.body.{}", refusal.parameter),
        BodyError::Axles(refusal) => format!("vehicle.{}", refusal.parameter),
        BodyError::OffThePath { .. } => "start.position_m".to_owned(),
        BodyError::Step { .. } => "simulation.step_s".to_owned(),
        BodyError::OffTheMap { .. } | BodyError::BelowGround { .. } | BodyError::NoRest => "start".to_owned(),
        BodyError::NoSoil | BodyError::NoSurface { .. } => "ground.terrain".to_owned(),
    };
    // What is not written has its place in what it would stand in.
    let around =
        std::iter::successors(Some(path.as_str()), |path| path.rsplit_once('.').map(|(around, _)| around));
    let node =
        around.into_iter().find_map(|path| document.find(path)).or_else(|| document.find("ground.terrain"));
    ScenarioError::Body {
        error: error.clone(),
        at: document.location(node.map_or(0, |node| node.span.start)),
    }
}
