//! The cycle of a scenario: nested phases, flattened to a plan.

use crate::document::Document;
use crate::error::ScenarioError;
use crate::piece::Piece;
use crate::recorded_speed;
use crate::schema::{Any, ScenarioFile};
use crate::tree::{Node, Shape};
use crate::until::{until, when};
use headland_plugin::{Bound, Mode};
use headland_sim::{Cycle, EngineSpeed, Guard, Model, Phase, Pi, Setting, Start};
use serde::Deserialize;
use std::path::Path;

/// A phase as scenarios write it, apart from what goes on in it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "phase")]
enum PhaseFile {
    Reach {
        speed_m_s: f64,
        acceleration_m_s2: f64,
    },
    Hold {
        for_s: f64,
    },
    #[allow(dead_code, reason = "read from its own piece")]
    Coast {
        until: Any,
    },
    Follow {
        times_s: Option<Vec<f64>>,
        speeds_m_s: Option<Vec<f64>>,
        file: Option<String>,
    },
    #[allow(dead_code, reason = "the end is read from its own piece")]
    Drive {
        speed_m_s: f64,
        acceleration_m_s2: f64,
        tolerance_m_s: Option<f64>,
        until: Any,
    },
    #[allow(dead_code, reason = "the end is read from its own piece")]
    DriveByPlace {
        positions_m: Vec<f64>,
        speeds_m_s: Vec<f64>,
        acceleration_m_s2: f64,
        until: Any,
    },
    #[allow(dead_code, reason = "read from its own piece")]
    Stand {
        until: Any,
    },
    #[allow(dead_code, reason = "its phases are read from their own piece")]
    Repeat {
        times: usize,
        phases: Any,
    },
    #[allow(dead_code, reason = "read from its own piece")]
    With {
        phases: Any,
    },
}

/// What any phase may say beside.
const BESIDE: [&str; 7] = ["name", "when", "work", "idle", "fill", "empty", "engine_speed_rad_s"];

/// What the fields say that tell a task what to do.
const MODES: [(&str, Mode); 4] =
    [("work", Mode::Work), ("idle", Mode::Idle), ("fill", Mode::Fill), ("empty", Mode::Empty)];

/// A cycle that brings its own tasks.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "cycle")]
struct CycleFile {
    #[allow(dead_code, reason = "for people")]
    about: Option<String>,
    #[allow(dead_code, reason = "read by the registry")]
    tasks: Option<Any>,
    #[allow(dead_code, reason = "read from its own piece")]
    phases: Any,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct EngineSpeedFile {
    times_s: Vec<f64>,
    speeds_rad_s: Vec<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "driver")]
struct KnowingFile {
    gain_per_s: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Pi")]
struct PiFile {
    gain_per_s: f64,
    integral_per_s2: f64,
    integral_limit_m_s2: f64,
    preview_s: f64,
}

/// A driver who takes back an error of speed within about a second.
const DRIVER_GAIN_PER_S: f64 = 1.0;

/// A run that lasts longer than a day has lost its way [s].
const LONGEST_S: f64 = 86_400.0;

/// No plan is longer: repeating it would fill the memory.
const MOST_PHASES: usize = 1_000_000;

/// The cycle; `None` where the scenario has none.
///
/// # Errors
/// [`ScenarioError`] where it does not fit, or names what the model does not have.
pub fn cycle(
    document: &Document,
    file: &ScenarioFile,
    folder: &Path,
    model: &Model,
) -> Result<Option<Cycle>, ScenarioError> {
    let Some(node) = document.find("cycle") else { return Ok(None) };
    let piece = Piece { document, node };
    let phases = if matches!(node.shape, Shape::Struct { name: None, .. }) {
        piece.read::<CycleFile>("cycle")?;
        piece.field("phases").unwrap_or(piece)
    } else {
        piece
    };
    let mut plan = Plan { folder, model, phases: Vec::new(), guards: 0 };
    plan.add(phases, &Setting::default())?;
    let (driver_gain_per_s, pi) = driver(document)?;
    let mut phases = plan.phases;
    let named =
        phases.iter().any(|(setting, _)| setting.tasks.as_ref().is_some_and(|tasks| !tasks.is_empty()));
    for (setting, _) in &mut phases {
        // Where a cycle says of some phase which tasks work, in the others none does.
        setting.tasks = if named { Some(setting.tasks.take().unwrap_or_default()) } else { None };
        setting.driver = pi;
    }
    let bare = |(setting, phase): (Setting, Phase)| {
        if setting == Setting::default() { phase } else { Phase::With { setting, phase: Box::new(phase) } }
    };
    let start = file.start.as_ref();
    Ok(Some(Cycle {
        start: Start {
            position_m: start.map_or(0.0, |start| start.position_m),
            speed_m_s: start.map_or(0.0, |start| start.speed_m_s),
        },
        phases: phases.into_iter().map(bare).collect(),
        driver_gain_per_s,
        step_s: file.simulation.step_s,
        longest_s: file.simulation.longest_s.unwrap_or(LONGEST_S),
    }))
}

/// Gain of a driver who knows the resistances, and the driver who does not, if it is that one.
fn driver(document: &Document) -> Result<(f64, Option<Pi>), ScenarioError> {
    let Some(node) = document.find("driver") else { return Ok((DRIVER_GAIN_PER_S, None)) };
    let piece = Piece { document, node };
    if piece.name() != Some("Pi") {
        let file: KnowingFile = piece.read("driver")?;
        piece.bounded("gain_per_s", file.gain_per_s, Bound::Positive)?;
        return Ok((file.gain_per_s, None));
    }
    let file: PiFile = piece.read("Pi")?;
    piece.bounded("gain_per_s", file.gain_per_s, Bound::Positive)?;
    piece.bounded("integral_per_s2", file.integral_per_s2, Bound::NotNegative)?;
    piece.bounded("integral_limit_m_s2", file.integral_limit_m_s2, Bound::NotNegative)?;
    piece.bounded("preview_s", file.preview_s, Bound::NotNegative)?;
    let PiFile { gain_per_s, integral_per_s2, integral_limit_m_s2, preview_s } = file;
    Ok((DRIVER_GAIN_PER_S, Some(Pi { gain_per_s, integral_per_s2, integral_limit_m_s2, preview_s })))
}

/// What phases, cycles and drivers look like.
pub mod forms {
    use super::{BESIDE, CycleFile, EngineSpeedFile, KnowingFile, MODES, PhaseFile, PiFile};
    use headland_plugin::{Field, Form, form_of};

    /// A list of phases, or a cycle that brings its tasks.
    pub fn cycle() -> Form {
        let tasks = || Box::new(Form::Named("task"));
        let mut own = form_of::<CycleFile>();
        for (path, form) in [
            ("tasks", Form::Either(vec![Form::List(tasks()), Form::Map(tasks())])),
            ("phases", Form::Named("phases")),
        ] {
            if let Some(part) = own.find(path) {
                *part = form;
            }
        }
        Form::Either(vec![Form::Named("phases"), own])
    }

    /// A phase, with what any may say beside.
    pub fn phase() -> Form {
        let Form::Choice(mut phases) = form_of::<PhaseFile>() else { return Form::Any };
        for form in phases.iter_mut().filter_map(|(_, form)| form.as_mut()) {
            for (path, of) in [("until", "until"), ("phases", "phases")] {
                if let Some(part) = form.find(path) {
                    *part = Form::Named(of);
                }
            }
            if let Form::Fields(fields) = form {
                fields.extend(BESIDE.map(beside));
            }
        }
        Form::Choice(phases)
    }

    fn beside(name: &str) -> Field {
        let form = match name {
            "name" => Form::Text,
            "when" => Form::Named("until"),
            "engine_speed_rad_s" => Form::Either(vec![Form::Number, form_of::<EngineSpeedFile>()]),
            _ => {
                debug_assert!(MODES.iter().any(|(mode, _)| *mode == name));
                Form::List(Box::new(Form::Text))
            }
        };
        Field { name: name.to_owned(), required: false, form }
    }

    /// A driver who knows the resistances, or one who does not.
    pub fn driver() -> Form {
        let pi = Form::Choice(vec![("Pi".to_owned(), Some(form_of::<PiFile>()))]);
        Form::Either(vec![form_of::<KnowingFile>(), pi])
    }
}

/// Phases one after the other.
struct Plan<'m> {
    folder: &'m Path,
    model: &'m Model,
    phases: Vec<(Setting, Phase)>,
    /// Conditions of entry so far.
    guards: usize,
}

impl Plan<'_> {
    /// Adds a phase, or a list of them.
    fn add(&mut self, piece: Piece, around: &Setting) -> Result<(), ScenarioError> {
        if let Some(values) = piece.elements() {
            if values.is_empty() {
                return Err(piece.refuse(
                    "phases",
                    "a list of 0",
                    "one phase or more: nothing would be driven",
                ));
            }
            return values.iter().try_for_each(|node| self.add(piece.at(node), around));
        }
        let file: PhaseFile = piece.read_without(&BESIDE, "phase")?;
        let setting = self.setting(piece, around)?;
        let until = |key: &str| until(piece.field(key).unwrap_or(piece), self.model);
        let not_negative = |field: &str, value: f64| piece.bounded(field, value, Bound::NotNegative);
        let positive = |field: &str, value: f64| piece.bounded(field, value, Bound::Positive);
        let phase = match file {
            PhaseFile::Reach { speed_m_s, acceleration_m_s2 } => {
                not_negative("speed_m_s", speed_m_s)?;
                positive("acceleration_m_s2", acceleration_m_s2)?;
                Phase::Reach { speed_m_s, acceleration_m_s2 }
            }
            PhaseFile::Hold { for_s } => {
                not_negative("for_s", for_s)?;
                Phase::Hold { for_s }
            }
            PhaseFile::Coast { .. } => Phase::Coast { until: until("until")? },
            PhaseFile::Follow { times_s, speeds_m_s, file } => {
                Phase::Follow { profile: self.follow(piece, times_s, speeds_m_s, file)? }
            }
            PhaseFile::Drive { speed_m_s, acceleration_m_s2, tolerance_m_s, .. } => {
                // Below 0 it is backward.
                not_negative("speed_m_s", speed_m_s.abs())?;
                positive("acceleration_m_s2", acceleration_m_s2)?;
                if let Some(tolerance) = tolerance_m_s {
                    positive("tolerance_m_s", tolerance)?;
                }
                Phase::Drive { speed_m_s, acceleration_m_s2, tolerance_m_s, until: until("until")? }
            }
            PhaseFile::DriveByPlace { positions_m, speeds_m_s, acceleration_m_s2, .. } => {
                positive("acceleration_m_s2", acceleration_m_s2)?;
                let profile = points(piece, ("positions_m", &positions_m), ("speeds_m_s", &speeds_m_s))?;
                if let Some(speed) = speeds_m_s.iter().find(|speed| **speed <= 0.0) {
                    let list = piece.field("speeds_m_s").unwrap_or(piece);
                    return Err(list.refuse(
                        "speeds_m_s",
                        &speed.to_string(),
                        "more than 0: it would never come on",
                    ));
                }
                Phase::DriveByPlace { profile, acceleration_m_s2, until: until("until")? }
            }
            PhaseFile::Stand { .. } => Phase::Stand { until: until("until")? },
            PhaseFile::Repeat { times, .. } => {
                let inner = piece.field("phases").unwrap_or(piece);
                if times == 0 {
                    let at = piece.field("times").unwrap_or(piece);
                    return Err(at.refuse("times", "0", "1 or more: its phases would never be driven"));
                }
                for _ in 0..times {
                    self.add(inner, &setting)?;
                    if self.phases.len() > MOST_PHASES {
                        return Err(piece.refuse(
                            "times",
                            &times.to_string(),
                            "a plan of a million phases at most",
                        ));
                    }
                }
                return Ok(());
            }
            PhaseFile::With { .. } => return self.add(piece.field("phases").unwrap_or(piece), &setting),
        };
        self.phases.push((setting, phase));
        Ok(())
    }

    /// What goes on in a phase, within what goes on around it.
    fn setting(&mut self, piece: Piece, around: &Setting) -> Result<Setting, ScenarioError> {
        let mut setting = around.clone();
        if let Some(name) = piece.field("name") {
            let own: String = name.read("name")?;
            setting.name = Some(around.name.as_ref().map_or(own.clone(), |outer| format!("{outer}, {own}")));
        }
        if let Some(conditions) = piece.field("when") {
            let when = when(conditions, self.model)?;
            setting.guards.push(Guard { group: self.guards, when });
            self.guards += 1;
        }
        for (field, mode) in MODES {
            let Some(list) = piece.field(field) else { continue };
            let tasks = setting.tasks.get_or_insert_default();
            for (task, at) in list.texts(field)? {
                if !self.model.tasks.iter().any(|own| own.name == task) {
                    let known: Vec<String> = self.model.tasks.iter().map(|own| own.name.clone()).collect();
                    return Err(at.unknown("task", &task, &known));
                }
                match tasks.iter_mut().find(|(own, _)| *own == task) {
                    Some(told) => told.1 = mode,
                    None => tasks.push((task, mode)),
                }
            }
        }
        if let Some(speed) = piece.field("engine_speed_rad_s") {
            setting.engine_speed = if matches!(speed.node.shape, Shape::Struct { .. }) {
                let file: EngineSpeedFile = speed.read("engine_speed_rad_s")?;
                let list = (("times_s", &file.times_s[..]), ("speeds_rad_s", &file.speeds_rad_s[..]));
                EngineSpeed::Over(points(speed, list.0, list.1)?)
            } else {
                let kept = speed.read("engine_speed_rad_s")?;
                piece.bounded("engine_speed_rad_s", kept, Bound::Positive)?;
                EngineSpeed::Kept(kept)
            };
        }
        Ok(setting)
    }

    /// The profile of a phase that follows one.
    fn follow(
        &self,
        piece: Piece,
        times_s: Option<Vec<f64>>,
        speeds_m_s: Option<Vec<f64>>,
        file: Option<String>,
    ) -> Result<Vec<(f64, f64)>, ScenarioError> {
        let missing = |field: &str| ScenarioError::MissingField {
            field: field.to_owned(),
            of: "`Follow`".to_owned(),
            at: piece.document.location(piece.node.span.start),
        };
        let (times_s, speeds_m_s) = match (file, times_s, speeds_m_s) {
            (Some(file), None, None) => {
                let at = piece.field("file").unwrap_or(piece);
                let (times, speeds) = recorded_speed::read(&self.folder.join(&file), &file)
                    .map_err(|(found, expected)| at.refuse("file", &found, &expected))?;
                let first = times.first().copied().unwrap_or(0.0);
                (times.into_iter().map(|time| time - first).collect(), speeds)
            }
            (None, Some(times), Some(speeds)) => (times, speeds),
            (None, None, _) => return Err(missing("times_s` or `file")),
            (None, Some(_), None) => return Err(missing("speeds_m_s")),
            (Some(_), ..) => {
                let at = piece.field("file").unwrap_or(piece);
                return Err(at.refuse("file", "given beside a list", "one of the two"));
            }
        };
        let profile = points(piece, ("times_s", &times_s), ("speeds_m_s", &speeds_m_s))?;
        if profile.len() < 2 || profile[0].0 != 0.0 {
            let found =
                profile.first().map_or("empty".to_owned(), |first| format!("a list from {}", first.0));
            let at = piece.field("times_s").or(piece.field("file")).unwrap_or(piece);
            return Err(at.refuse("times_s", &found, "two times or more, the first of them 0"));
        }
        Ok(profile)
    }
}

/// Pairs of two lists, the first of which increases and the second of which is not negative.
fn points(
    piece: Piece,
    (at_name, at): (&str, &[f64]),
    (name, values): (&str, &[f64]),
) -> Result<Vec<(f64, f64)>, ScenarioError> {
    let list = |name: &str| piece.field(name).unwrap_or(piece);
    let element = |name: &str, index: usize| {
        let list = list(name);
        list.elements().and_then(|nodes| nodes.get(index)).map_or(list, |node: &Node| list.at(node))
    };
    if at.len() != values.len() {
        let expected = format!("as many as `{at_name}`, {}", at.len());
        return Err(list(name).refuse(name, &format!("a list of {}", values.len()), &expected));
    }
    if at.is_empty() {
        return Err(list(at_name).refuse(at_name, "empty", "one or more"));
    }
    if let Some(index) = (1..at.len()).find(|&index| !at[index].is_finite() || at[index] <= at[index - 1]) {
        let found = format!("{} after {}", at[index], at[index - 1]);
        return Err(element(at_name, index).refuse(at_name, &found, "increasing numbers"));
    }
    if let Some(index) = values.iter().position(|value| !Bound::NotNegative.holds(*value)) {
        let found = values[index].to_string();
        return Err(element(name, index).refuse(name, &found, &Bound::NotNegative.in_words()));
    }
    Ok(at.iter().copied().zip(values.iter().copied()).collect())
}
