//! The fields of a scenario. Plugins stand as [`Any`]: the registry reads them from the same text.

use crate::axles::AxleFile;
use crate::body::BodyFile;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;

/// A piece of RON whose meaning a plugin knows.
pub type Any = IgnoredAny;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "scenario")]
pub struct ScenarioFile {
    pub about: String,
    /// Where files that plugins name are looked for, relative to the scenario.
    pub folder: Option<String>,
    pub vehicle: VehicleFile,
    #[allow(dead_code, reason = "read by the registry")]
    pub ground: GroundFile,
    pub air: AirFile,
    pub gravity_m_s2: Option<f64>,
    pub start: Option<StartFile>,
    #[allow(dead_code, reason = "read from its own piece")]
    pub cycle: Option<Any>,
    #[allow(dead_code, reason = "read from its own piece")]
    pub driver: Option<Any>,
    #[allow(dead_code, reason = "read by the registry")]
    pub tasks: Option<Any>,
    #[allow(dead_code, reason = "read by the registry")]
    #[serde(default)]
    pub effects: Vec<Any>,
    #[allow(dead_code, reason = "read by the registry")]
    #[serde(default)]
    pub candidates: Vec<Any>,
    #[serde(default)]
    pub free: Vec<FreeFile>,
    pub replay: Option<ReplayFile>,
    #[allow(dead_code, reason = "its values are taken from the text")]
    #[serde(default)]
    pub runs: Vec<RunFile>,
    pub simulation: SimulationFile,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "vehicle")]
pub struct VehicleFile {
    pub name: Option<String>,
    pub mass_kg: f64,
    pub rotating_mass_kg: f64,
    pub drag_area_m2: Option<f64>,
    pub road_load: Option<RoadLoadFile>,
    pub axles: Option<Vec<AxleFile>>,
    pub centre_of_gravity_height_m: Option<f64>,
    pub hitch_height_m: Option<f64>,
    pub slip_limit: Option<f64>,
    pub brake_friction: Option<f64>,
    pub body: Option<BodyFile>,
    #[allow(dead_code, reason = "read by the registry")]
    pub driveline: Any,
    #[allow(dead_code, reason = "read by the registry")]
    pub management: Option<Any>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "road_load")]
pub struct RoadLoadFile {
    pub f0_n: f64,
    pub f1_n_s_m: f64,
    pub f2_n_s2_m2: f64,
    pub air_density_kg_m3: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "ground")]
pub struct GroundFile {
    #[allow(dead_code, reason = "read by the registry")]
    pub terrain: Any,
    #[allow(dead_code, reason = "read by the registry")]
    pub soil: Option<Any>,
    #[allow(clippy::zero_sized_map_values, reason = "the registry reads the values")]
    #[allow(dead_code, reason = "read by the registry")]
    #[serde(default)]
    pub soils: BTreeMap<String, Any>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "air")]
pub struct AirFile {
    pub density_kg_m3: f64,
    pub wind: Option<WindFile>,
    pub temperature_c: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "wind")]
pub struct WindFile {
    pub speed_m_s: f64,
    pub from_rad: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "start")]
pub struct StartFile {
    pub position_m: f64,
    pub speed_m_s: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "free parameter")]
pub struct FreeFile {
    pub name: String,
    pub value: Option<f64>,
    pub sd: Option<f64>,
    pub bounds: Option<(f64, f64)>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "replay")]
pub struct ReplayFile {
    pub drive: Option<DriveFile>,
    pub inputs: Option<Vec<InputFile>>,
    pub window_s: Option<f64>,
    pub smoothing_s: Option<f64>,
    pub least_acceleration_m_s2: Option<f64>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
pub enum DriveFile {
    Speed,
    Torque,
    Force,
    Coast,
}

#[derive(Clone, Copy, Debug, Deserialize)]
pub enum InputFile {
    All,
    Grade,
    Heading,
    Curvature,
    Roll,
    VerticalAcceleration,
    Wind,
    AirTemperature,
    OilTemperature,
    StateOfCharge,
    TyrePressure,
    AuxiliaryPower,
    DrawbarForce,
    PtoPower,
    HydraulicPower,
    Payload,
    Coasting,
    Brake,
    EngineSpeed,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "run")]
#[allow(clippy::zero_sized_map_values, reason = "the registry reads the values")]
#[allow(dead_code, reason = "its values are taken from the text")]
pub struct RunFile {
    pub id: String,
    pub with: BTreeMap<String, Any>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "simulation")]
pub struct SimulationFile {
    pub fidelity: FidelityFile,
    pub step_s: f64,
    pub longest_s: Option<f64>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename = "fidelity")]
pub enum FidelityFile {
    Longitudinal,
    QuasiStatic { record_s: f64 },
    RigidBody { record_s: f64 },
}
