//! A scenario that was read and checked, and the models that it stands for.

use crate::axles::axles;
use crate::body::{Fidelity, fidelity};
use crate::candidate::{Candidate, candidates};
use crate::cycle::cycle;
use crate::document::Document;
use crate::error::ScenarioError;
use crate::fault;
use crate::ground;
use crate::plugins::{Remark, bounded, build, build_all};
use crate::schema::{DriveFile, FidelityFile, InputFile, ScenarioFile};
use crate::tree::{Node, Shape};
use headland_plugin::{Air, Bound, Registry};
use headland_sim::{Cycle, Drive, Inputs, Model, Resistance, Vehicle};
use headland_units::constants::STANDARD_GRAVITY_M_S2;
use std::path::{Path, PathBuf};

/// A scenario: text that was checked, and what it says apart from its plugins.
#[derive(Clone, Debug)]
pub struct Scenario {
    document: Document,
    /// What it is about, in its own words.
    pub about: String,
    /// Name of the vehicle.
    pub vehicle_name: Option<String>,
    /// How it is driven; `None` where it only replays recordings.
    pub cycle: Option<Cycle>,
    /// What simulates it.
    pub fidelity: Fidelity,
    /// How recordings drive it.
    pub replay: ReplaySettings,
    /// Effects that a diagnosis tries beside those it knows.
    pub candidates: Vec<Candidate>,
    /// Parameters that estimation may move.
    pub free: Vec<Free>,
    /// Its runs; empty where it is one run without a name.
    pub runs: Vec<RunSpec>,
    /// What is unusual about it.
    pub remarks: Vec<Remark>,
}

/// How a recording drives the model; what is `None` is chosen by the recording.
#[derive(Clone, Debug, PartialEq)]
pub struct ReplaySettings {
    /// What moves the model.
    pub drive: Option<Drive>,
    /// Recorded circumstances that the model is told.
    pub inputs: Option<AskedInputs>,
    /// Length of the windows that start anew from the recorded speed [s].
    pub window_s: Option<f64>,
    /// Half width of the local fit that gives speed and acceleration of the recording [s].
    pub smoothing_s: Option<f64>,
    /// Samples in which the recording slows down harder are not compared: brakes that were not recorded [m/s²].
    pub least_acceleration_m_s2: Option<f64>,
    /// Longest step of the integration [s].
    pub step_s: f64,
}

/// Recorded circumstances that a model is to be told.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AskedInputs {
    /// Whether all that a replay is told without being asked are among them, where they were recorded.
    pub all: bool,
    /// Those that stand in the list; they have to have been recorded.
    pub listed: Vec<Inputs>,
}

/// A parameter that estimation may move.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
    /// Dotted path of the parameter.
    pub path: String,
    /// Its name: the end of the path, or the path where the end is not unique.
    pub name: String,
    /// Prior value, in the unit of the name.
    pub value: f64,
    /// Prior standard deviation; `None` where nothing is known.
    pub sd: Option<f64>,
    /// Least and greatest value.
    pub bounds: (f64, f64),
}

/// One run of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct RunSpec {
    /// Its name.
    pub id: String,
    /// Path and RON of what differs from the scenario.
    pub with: Vec<(String, String)>,
}

/// No vehicle is simulated in longer steps than this [s].
const LONGEST_STEP_S: f64 = 10.0;

impl Scenario {
    /// Reads and checks a scenario and builds its model once.
    ///
    /// # Errors
    /// [`ScenarioError`] says what, where, and what was expected.
    pub fn read(path: &Path, registry: &Registry) -> Result<Self, ScenarioError> {
        Self::of(Document::read(path)?, registry)?.held_within_bounds(registry)
    }

    /// Refuses bounds of free parameters at which there is no model.
    fn held_within_bounds(self, registry: &Registry) -> Result<Self, ScenarioError> {
        for (index, free) in self.free.iter().enumerate() {
            for bound in [free.bounds.0, free.bounds.1].into_iter().filter(|bound| bound.is_finite()) {
                if let Err(error) = self.model_with(&[(&free.path, bound)], registry) {
                    let place = self.document.find(&format!("free.{index}.bounds"));
                    let why = error.to_string();
                    return Err(ScenarioError::Value {
                        name: "bounds".to_owned(),
                        found: format!("{bound}, at which `{}` is refused ({})", free.path, why.trim()),
                        expected: "bounds at which the model can be".to_owned(),
                        at: self.document.location(place.map_or(0, |node| node.span.start)),
                    });
                }
            }
        }
        Ok(self)
    }

    /// As [`Scenario::read`], from a text; `name` stands for the file, `folder` is where its includes lie.
    ///
    /// # Errors
    /// As [`Scenario::read`].
    pub fn of_text(
        name: &str,
        text: &str,
        folder: &Path,
        registry: &Registry,
    ) -> Result<Self, ScenarioError> {
        Self::of(Document::of_text(name, text, folder)?, registry)?.held_within_bounds(registry)
    }

    /// As [`Scenario::read`], from a document.
    ///
    /// # Errors
    /// As [`Scenario::read`].
    pub fn of(document: Document, registry: &Registry) -> Result<Self, ScenarioError> {
        Self::with_model(document, registry).map(|(scenario, _)| scenario)
    }

    /// The scenario of a document and its model, which is built once.
    ///
    /// # Errors
    /// As [`Scenario::read`].
    pub fn with_model(document: Document, registry: &Registry) -> Result<(Self, Model), ScenarioError> {
        let file = parse(&document)?;
        check_numbers(&document)?;
        let mut remarks = Vec::new();
        let built = model(&document, &file, registry, &mut remarks)?;
        let folder = folder(&document, &file);
        build_all(
            &document,
            "candidates",
            &registry.effects,
            "headland plugins effect",
            &folder,
            &mut remarks,
        )?;
        let cycle = cycle(&document, &file, &folder, &built)?;
        let fidelity = fidelity(&document, &file, &built, cycle.as_ref())?;
        let replay = replay_settings(&file);
        let free = free(&document, &file)?;
        let runs = runs(&document)?;
        let scenario = Self {
            about: file.about,
            vehicle_name: file.vehicle.name,
            cycle,
            fidelity,
            replay,
            candidates: candidates(&document),
            free,
            runs,
            remarks,
            document,
        };
        for run in &scenario.runs {
            scenario.run(run, registry)?;
        }
        Ok((scenario, built))
    }

    /// The model.
    ///
    /// # Errors
    /// As [`Scenario::read`].
    pub fn model(&self, registry: &Registry) -> Result<Model, ScenarioError> {
        model(&self.document, &parse(&self.document)?, registry, &mut Vec::new())
    }

    /// The model with other numbers at some paths.
    ///
    /// # Errors
    /// As [`Scenario::read`].
    pub fn model_with(&self, changes: &[(&str, f64)], registry: &Registry) -> Result<Model, ScenarioError> {
        let document = self.document.with(changes)?;
        check_numbers(&document)?;
        model(&document, &parse(&document)?, registry, &mut Vec::new())
    }

    /// The resolved text and where it comes from.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// A copy with other numbers at some paths.
    ///
    /// # Errors
    /// As [`Scenario::read`].
    pub fn with(&self, changes: &[(&str, f64)], registry: &Registry) -> Result<Self, ScenarioError> {
        Self::of(self.document.with(changes)?, registry)
    }

    /// A copy with one more effect, written as in a scenario.
    ///
    /// # Errors
    /// As [`Scenario::read`].
    pub fn with_effect(&self, effect: &str, registry: &Registry) -> Result<Self, ScenarioError> {
        Self::of(self.document.with_effect(effect)?, registry)
    }

    /// The scenario of one of its runs.
    ///
    /// # Errors
    /// As [`Scenario::read`].
    pub fn run(&self, run: &RunSpec, registry: &Registry) -> Result<Self, ScenarioError> {
        let changes: Vec<_> = run.with.iter().map(|(path, ron)| (path.as_str(), ron.clone())).collect();
        let mut document = self.document.replaced(&changes)?;
        if document.find("runs").is_some() {
            document = document.replaced(&[("runs", "[]".to_owned())])?;
        }
        Self::of(document, registry)
    }
}

fn parse(document: &Document) -> Result<ScenarioFile, ScenarioError> {
    ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str(document.text())
        .map_err(|error| {
            let whole = Node { span: 0..document.text().len(), shape: document.tree().shape.clone() };
            fault::tell(document, &whole, "scenario", &error)
        })
}

/// Bounds of the scenario's own numbers.
const BOUNDS: [(&str, Bound); 23] = [
    ("vehicle.mass_kg", Bound::Positive),
    ("vehicle.rotating_mass_kg", Bound::NotNegative),
    ("vehicle.drag_area_m2", Bound::NotNegative),
    ("vehicle.centre_of_gravity_height_m", Bound::Within(0.0, 10.0)),
    ("vehicle.hitch_height_m", Bound::Within(0.0, 10.0)),
    ("vehicle.slip_limit", Bound::Within(0.01, 0.9)),
    ("vehicle.brake_friction", Bound::Within(0.01, 3.0)),
    ("vehicle.road_load.f0_n", Bound::Finite),
    ("vehicle.road_load.f1_n_s_m", Bound::Finite),
    ("vehicle.road_load.f2_n_s2_m2", Bound::NotNegative),
    ("vehicle.road_load.air_density_kg_m3", Bound::Positive),
    ("air.density_kg_m3", Bound::NotNegative),
    ("air.wind.speed_m_s", Bound::NotNegative),
    ("air.wind.from_rad", Bound::Finite),
    ("air.temperature_c", Bound::Within(-90.0, 70.0)),
    ("gravity_m_s2", Bound::Positive),
    ("start.position_m", Bound::Finite),
    ("start.speed_m_s", Bound::Finite),
    ("simulation.step_s", Bound::Within(1e-6, LONGEST_STEP_S)),
    ("simulation.longest_s", Bound::Positive),
    ("simulation.fidelity.record_s", Bound::Positive),
    ("replay.window_s", Bound::Positive),
    ("replay.smoothing_s", Bound::Positive),
];

fn check_numbers(document: &Document) -> Result<(), ScenarioError> {
    for (path, bound) in BOUNDS {
        if let (Some(node), Some(value)) = (document.find(path), document.number(path)) {
            let name = path.rsplit('.').next().unwrap_or(path);
            bounded(document, name, value, bound, node.span.start)?;
        }
    }
    Ok(())
}

/// Where files that plugins name are looked for.
fn folder(document: &Document, file: &ScenarioFile) -> PathBuf {
    file.folder.as_ref().map_or_else(|| document.folder().to_owned(), |folder| document.folder().join(folder))
}

fn model(
    document: &Document,
    file: &ScenarioFile,
    registry: &Registry,
    remarks: &mut Vec<Remark>,
) -> Result<Model, ScenarioError> {
    let folder = folder(document, file);
    let at = |path: &str| document.find(path).map_or(0, |node| node.span.start);
    let misfit = |name: &str, found: &str, expected: &str, path: &str| ScenarioError::Value {
        name: name.to_owned(),
        found: found.to_owned(),
        expected: expected.to_owned(),
        at: document.location(at(path)),
    };
    let missing = |path: &str, of: &str, field: &str| ScenarioError::MissingField {
        field: field.to_owned(),
        of: format!("`{of}`"),
        at: document.location(at(path)),
    };
    let resistance = match (file.vehicle.drag_area_m2, &file.vehicle.road_load) {
        (Some(area_m2), None) => Resistance::Drag { area_m2 },
        (None, Some(load)) => Resistance::RoadLoad {
            f0_n: load.f0_n,
            f1_n_s_m: load.f1_n_s_m,
            f2_n_s2_m2: load.f2_n_s2_m2,
            air_density_kg_m3: load.air_density_kg_m3,
        },
        (Some(_), Some(_)) => {
            return Err(misfit(
                "road_load",
                "given beside `drag_area_m2`",
                "one of the two: road-load coefficients hold the drag already",
                "vehicle.road_load",
            ));
        }
        (None, None) => return Err(missing("vehicle", "vehicle", "drag_area_m2` or `road_load")),
    };
    let terrain = document.find("ground.terrain").ok_or_else(|| missing("ground", "ground", "terrain"))?;
    let (_, terrain) =
        build(document, terrain, &registry.terrains, "headland plugins terrain", &folder, remarks)?;
    let soil = match (document.find("ground.soil"), file.vehicle.road_load.is_some()) {
        (Some(node), false) => Some(ground::soil(document, node, registry, &folder, remarks)?),
        (None, true) => None,
        (Some(_), true) => {
            return Err(misfit(
                "soil",
                "given beside `vehicle.road_load`",
                "one of the two: road-load coefficients hold the rolling resistance already",
                "ground.soil",
            ));
        }
        (None, false) => return Err(missing("ground", "ground", "soil")),
    };
    let axles = axles(document, &file.vehicle, soil.as_deref())?;
    let rolls_as_a_body = matches!(file.simulation.fidelity, FidelityFile::RigidBody { .. });
    if let (Some(_), Some(soil), false) = (&axles, &soil, rolls_as_a_body) {
        remarks.extend(ground::beside_axles(document, soil.as_ref()));
    }
    let driveline =
        document.find("vehicle.driveline").ok_or_else(|| missing("vehicle", "vehicle", "driveline"))?;
    let more = "headland plugins driveline";
    let (_, mut driveline) = build(document, driveline, &registry.drivelines, more, &folder, remarks)?;
    match document.find("vehicle.management") {
        Some(node) => {
            let more = "headland plugins management";
            let (name, management) = build(document, node, &registry.managements, more, &folder, remarks)?;
            driveline
                .adopt(management)
                .map_err(|refusal| misfit("management", &name, &refusal.expected, "vehicle.management"))?;
        }
        None if driveline.needs_management() => return Err(missing("vehicle", "vehicle", "management")),
        None => {}
    }
    let mut tasks = build_all(document, "tasks", &registry.tasks, "headland plugins task", &folder, remarks)?;
    let more = "headland plugins task";
    let of_cycle = build_all(document, "cycle.tasks", &registry.tasks, more, &folder, remarks)?;
    if let Some(twice) = of_cycle.iter().find(|task| tasks.iter().any(|other| other.name == task.name)) {
        let found = format!("`{}`, as a task beside it", twice.name);
        return Err(misfit("tasks", &found, "a name of its own", "cycle.tasks"));
    }
    tasks.extend(of_cycle);
    let effects =
        build_all(document, "effects", &registry.effects, "headland plugins effect", &folder, remarks)?;
    Ok(Model {
        vehicle: Vehicle {
            mass_kg: file.vehicle.mass_kg,
            rotating_mass_kg: file.vehicle.rotating_mass_kg,
            resistance,
            brake_friction: file.vehicle.brake_friction.unwrap_or(f64::INFINITY),
        },
        gravity_m_s2: file.gravity_m_s2.unwrap_or(STANDARD_GRAVITY_M_S2),
        air: Air {
            density_kg_m3: file.air.density_kg_m3,
            wind_speed_m_s: file.air.wind.as_ref().map_or(0.0, |wind| wind.speed_m_s),
            wind_from_rad: file.air.wind.as_ref().map_or(0.0, |wind| wind.from_rad),
            temperature_c: file.air.temperature_c.unwrap_or(f64::NAN),
        },
        terrain,
        axles,
        soil,
        driveline,
        tasks,
        effects,
    })
}

fn replay_settings(file: &ScenarioFile) -> ReplaySettings {
    let replay = file.replay.as_ref();
    ReplaySettings {
        drive: replay.and_then(|replay| replay.drive).map(|drive| match drive {
            DriveFile::Speed => Drive::Speed,
            DriveFile::Torque => Drive::Torque,
            DriveFile::Force => Drive::Force,
            DriveFile::Coast => Drive::Coast,
        }),
        inputs: replay.and_then(|replay| replay.inputs.as_deref()).map(asked),
        window_s: replay.and_then(|replay| replay.window_s),
        smoothing_s: replay.and_then(|replay| replay.smoothing_s),
        least_acceleration_m_s2: replay.and_then(|replay| replay.least_acceleration_m_s2),
        step_s: file.simulation.step_s,
    }
}

fn asked(inputs: &[InputFile]) -> AskedInputs {
    let named = |input: &InputFile| {
        Some(match input {
            InputFile::All => return None,
            InputFile::Grade => Inputs::Grade,
            InputFile::Heading => Inputs::Heading,
            InputFile::Curvature => Inputs::Curvature,
            InputFile::Roll => Inputs::Roll,
            InputFile::VerticalAcceleration => Inputs::VerticalAcceleration,
            InputFile::Wind => Inputs::Wind,
            InputFile::AirTemperature => Inputs::AirTemperature,
            InputFile::OilTemperature => Inputs::OilTemperature,
            InputFile::StateOfCharge => Inputs::StateOfCharge,
            InputFile::TyrePressure => Inputs::TyrePressure,
            InputFile::AuxiliaryPower => Inputs::AuxiliaryPower,
            InputFile::DrawbarForce => Inputs::DrawbarForce,
            InputFile::PtoPower => Inputs::PtoPower,
            InputFile::HydraulicPower => Inputs::HydraulicPower,
            InputFile::Payload => Inputs::Payload,
            InputFile::Coasting => Inputs::Coasting,
            InputFile::Brake => Inputs::Brake,
            InputFile::EngineSpeed => Inputs::EngineSpeed,
        })
    };
    let listed: Vec<Inputs> = inputs.iter().filter_map(named).collect();
    AskedInputs { all: listed.len() < inputs.len(), listed }
}

fn free(document: &Document, file: &ScenarioFile) -> Result<Vec<Free>, ScenarioError> {
    let mut all = Vec::new();
    for (index, parameter) in file.free.iter().enumerate() {
        let place =
            |field: &str| document.find(&format!("free.{index}.{field}")).map_or(0, |node| node.span.start);
        let refuse = |name: &str, found: String, expected: &str| ScenarioError::Value {
            name: name.to_owned(),
            found,
            expected: expected.to_owned(),
            at: document.location(place(name)),
        };
        let path = document.resolve(&parameter.name).map_err(|_| {
            let found = format!("\"{}\", which names no one number of the scenario", parameter.name);
            refuse("name", found, "the dotted path of a number, as in \"vehicle.mass_kg\"")
        })?;
        let Some(stands) = document.number(&path) else {
            return Err(refuse("name", format!("\"{path}\", which is no number"), "the path of a number"));
        };
        let value = parameter.value.unwrap_or(stands);
        let bounds = parameter.bounds.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        if !value.is_finite() {
            return Err(refuse("value", value.to_string(), "a finite number"));
        }
        if let Some(sd) = parameter.sd.filter(|sd| sd.is_nan() || *sd <= 0.0) {
            return Err(refuse("sd", sd.to_string(), "more than 0"));
        }
        if all.iter().any(|one: &Free| one.path == path) {
            return Err(refuse("name", format!("\"{path}\" for the second time"), "each parameter once"));
        }
        if !(bounds.0 < bounds.1 && bounds.0 <= value && value <= bounds.1) {
            let found = format!("({}, {})", bounds.0, bounds.1);
            return Err(refuse("bounds", found, &format!("(least, greatest) about the value {value}")));
        }
        all.push(Free { path, name: String::new(), value, sd: parameter.sd, bounds });
    }
    let ends: Vec<String> =
        all.iter().map(|one| one.path.rsplit('.').next().unwrap_or("").to_owned()).collect();
    for (index, one) in all.iter_mut().enumerate() {
        let unique = ends.iter().filter(|end| **end == ends[index]).count() == 1;
        one.name = if unique { ends[index].clone() } else { one.path.clone() };
    }
    Ok(all)
}

/// The runs of a study; their values are taken as they are written.
fn runs(document: &Document) -> Result<Vec<RunSpec>, ScenarioError> {
    let Some(Node { shape: Shape::List(values), .. }) = document.find("runs") else { return Ok(Vec::new()) };
    let mut all: Vec<RunSpec> = Vec::new();
    for node in values {
        let id = match node.field("id").map(|field| &field.value) {
            Some(Node { shape: Shape::Text(id), .. }) => id.clone(),
            _ => continue,
        };
        let refuse = |name: &str, found: &str, expected: &str, at: usize| ScenarioError::Value {
            name: name.to_owned(),
            found: found.to_owned(),
            expected: expected.to_owned(),
            at: document.location(at),
        };
        let usable =
            !id.is_empty() && id.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.'));
        if !usable || all.iter().any(|other| other.id == id) {
            let at = node.field("id").map_or(node.span.start, |field| field.value.span.start);
            return Err(refuse(
                "id",
                &format!("\"{id}\""),
                "a name of its own of letters, digits, `_`, `-`, `.`",
                at,
            ));
        }
        let mut with = Vec::new();
        if let Some(Node { shape: Shape::Map(entries), .. }) = node.field("with").map(|field| &field.value) {
            for (key, value) in entries {
                let Shape::Text(path) = &key.shape else { continue };
                if document.find(path).is_none() || path == "runs" {
                    let found = format!("\"{path}\", which the scenario does not have");
                    return Err(refuse(
                        "with",
                        &found,
                        "the dotted path of a value that stands there",
                        key.span.start,
                    ));
                }
                with.push((path.clone(), document.text()[value.span.clone()].to_owned()));
            }
        }
        all.push(RunSpec { id, with });
    }
    Ok(all)
}
