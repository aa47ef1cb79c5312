//! Runs as a Rerun recording, where the program was built with it.

use crate::arguments::RerunOptions;
use crate::failure::Failure;
#[cfg(feature = "rerun")]
use crate::failure::interrupted;
use crate::held::Pair;
use crate::output::Output;
#[cfg(feature = "rerun")]
use crate::painted;
use crate::say::Say;
#[cfg(feature = "rerun")]
use crate::scenery::{self, Stage};
use headland_diagnose::Diagnosed;
use headland_plugin::Registry;
use headland_recording::Recording;
use headland_scenario::Scenario;
use headland_trace::Run;
#[cfg(feature = "rerun")]
use std::path::Path;
use std::path::PathBuf;

/// What is wanted of Rerun.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(not(feature = "rerun"), allow(dead_code, reason = "without Rerun nothing is shown"))]
pub struct Wanted {
    write: bool,
    view: bool,
    serve: bool,
}

impl Wanted {
    /// Of the options; to view or to serve is to write too.
    pub fn of(options: RerunOptions) -> Self {
        let RerunOptions { rerun, view, serve } = options;
        Self { write: rerun || view || serve, view, serve }
    }

    /// Whether anything is.
    pub fn any(self) -> bool {
        self.write
    }

    /// Whether this program can draw, asked before anything is simulated.
    pub fn possible(self) -> Result<(), Failure> {
        if self.write && !cfg!(feature = "rerun") {
            return Err(Failure::Input(
                "this `headland` was built without Rerun; build it with `--features rerun` for --rerun, --view and --serve"
                    .to_owned(),
            ));
        }
        Ok(())
    }
}

/// A picture that was written, and is served if it is to be.
#[must_use = "what is to be served is served by `serve`"]
#[derive(Debug)]
pub struct Picture {
    #[cfg_attr(not(feature = "rerun"), allow(dead_code, reason = "nothing is served without Rerun"))]
    served: Option<PathBuf>,
}

impl Picture {
    /// Serves the picture, until the server ends or is interrupted.
    #[cfg(not(feature = "rerun"))]
    #[allow(clippy::unused_self, clippy::unnecessary_wraps, reason = "as with Rerun")]
    pub fn serve(self, _: Say) -> Result<(), Failure> {
        Ok(())
    }

    /// Serves the picture, until the server ends or is interrupted.
    #[cfg(feature = "rerun")]
    pub fn serve(self, say: Say) -> Result<(), Failure> {
        let Some(path) = self.served else { return Ok(()) };
        let server = headland_view::serve(&path).map_err(refused)?;
        say.progress(&format!(
            "serving {} at {}, to this machine alone, until interrupted",
            path.display(),
            server.address()
        ));
        server.wait(&interrupted).map_err(refused)
    }
}

/// What is drawn.
#[cfg_attr(not(feature = "rerun"), allow(dead_code, reason = "what is drawn is read by Rerun alone"))]
#[derive(Clone, Copy)]
pub struct Drawn<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// All models.
    pub registry: &'a Registry,
    /// What was simulated, or replayed.
    pub runs: &'a [Run],
    /// What it was held against.
    pub pairs: &'a [Pair],
}

/// Writes `run.rrd` and opens the viewer, as wanted.
#[cfg(not(feature = "rerun"))]
pub fn draw(wanted: Wanted, _: &Drawn, _: &mut Output) -> Result<Picture, Failure> {
    wanted.possible().map(|()| Picture { served: None })
}

/// Writes `run.rrd` and opens the viewer, as wanted.
#[cfg(feature = "rerun")]
pub fn draw(wanted: Wanted, drawn: &Drawn, output: &mut Output) -> Result<Picture, Failure> {
    if !wanted.write {
        return Ok(Picture { served: None });
    }
    let Drawn { scenario, registry, runs, pairs } = *drawn;
    let measured: Vec<Run> = pairs
        .iter()
        .map(|pair| Run { id: pair.comparison.run.clone(), trace: pair.measured.clone() })
        .collect();
    // A recording without a place cannot be drawn; its speed stands in the plots all the same.
    let placed = |run: &Run| run.trace.get("position_m").is_some() || run.trace.get("east_m").is_some();
    let measured: Vec<Run> = measured.into_iter().filter(placed).collect();
    // A replay follows its recording, wherever that was driven.
    let stages = if pairs.is_empty() { scenery::stages(scenario, registry, runs)? } else { Vec::new() };
    let all = All { title: &scenario.about, runs, measured: &measured, stages: &stages };
    let path = output.file("run.rrd");
    all.write(scenario, &path)?;
    opened(wanted, path)
}

/// Runs of a batch, each by a scenario of its own.
#[cfg_attr(not(feature = "rerun"), allow(dead_code, reason = "what is drawn is read by Rerun alone"))]
#[derive(Debug)]
pub struct Chosen {
    /// What the batch is about.
    pub title: String,
    /// What describes each run alone.
    pub scenarios: Vec<Scenario>,
    /// The runs.
    pub runs: Vec<Run>,
}

/// Writes `batch.rrd` and opens the viewer, as wanted.
#[cfg(not(feature = "rerun"))]
pub fn draw_batch(wanted: Wanted, _: &Chosen, _: &Registry, _: &mut Output) -> Result<Picture, Failure> {
    wanted.possible().map(|()| Picture { served: None })
}

/// Writes `batch.rrd` and opens the viewer, as wanted.
#[cfg(feature = "rerun")]
pub fn draw_batch(
    wanted: Wanted,
    chosen: &Chosen,
    registry: &Registry,
    output: &mut Output,
) -> Result<Picture, Failure> {
    let Some(first) = chosen.scenarios.first() else { return Ok(Picture { served: None }) };
    let own = chosen.runs.iter().zip(&chosen.scenarios);
    let stages: Vec<Stage> =
        own.map(|(run, scenario)| scenery::stage(&run.id, scenario, registry)).collect::<Result<_, _>>()?;
    let all = All { title: &chosen.title, runs: &chosen.runs, measured: &[], stages: &stages };
    let path = output.file("batch.rrd");
    all.write(first, &path)?;
    opened(wanted, path)
}

/// Everything of a scene.
#[cfg(feature = "rerun")]
struct All<'a> {
    title: &'a str,
    runs: &'a [Run],
    measured: &'a [Run],
    stages: &'a [Stage],
}

#[cfg(feature = "rerun")]
impl All<'_> {
    /// The file of the scene, with a vehicle of the scenario's size.
    fn write(&self, scenario: &Scenario, path: &Path) -> Result<(), Failure> {
        use headland_view::{Axis, ForceArrow, Scene, Setting};
        let arrow = |channel, label, axis| ForceArrow { channel, label, axis };
        let all = [
            arrow("tractive_force_n", "traction", Axis::Forward),
            arrow("soil_resistance_n", "soil", Axis::Backward),
            arrow("air_resistance_n", "air", Axis::Backward),
            arrow("slope_resistance_n", "slope", Axis::Backward),
            arrow("brake_force_n", "brakes", Axis::Backward),
            arrow("drawbar_force_n", "drawbar", Axis::Backward),
        ];
        let there =
            |arrow: &ForceArrow| self.runs.iter().any(|run| run.trace.channel(arrow.channel).is_some());
        let forces: Vec<ForceArrow> = all.into_iter().filter(there).collect();
        let settings: Vec<Setting> = self.stages.iter().map(Stage::setting).collect();
        let rig = self.stages.iter().find_map(|stage| stage.rig.as_ref());
        let scene = Scene {
            title: self.title,
            runs: self.runs,
            measured: self.measured,
            forces: &forces,
            vehicle: rig.map_or_else(|| body(scenario), scenery::body),
            ground: None,
            settings: &settings,
        };
        headland_view::write(&scene, path).map_err(refused)
    }
}

/// Writes `diagnosis.rrd` and opens the viewer, as wanted.
#[cfg(not(feature = "rerun"))]
pub fn draw_diagnosis(
    wanted: Wanted,
    _: &str,
    _: &Recording,
    _: &Diagnosed,
    _: &mut Output,
) -> Result<Picture, Failure> {
    wanted.possible().map(|()| Picture { served: None })
}

/// Writes `diagnosis.rrd` and opens the viewer, as wanted.
#[cfg(feature = "rerun")]
pub fn draw_diagnosis(
    wanted: Wanted,
    title: &str,
    recording: &Recording,
    found: &Diagnosed,
    output: &mut Output,
) -> Result<Picture, Failure> {
    if !wanted.write {
        return Ok(Picture { served: None });
    }
    let (runs, words) = (painted::runs(recording), painted::Words::of(&found.diagnosis));
    let path = output.file("diagnosis.rrd");
    headland_view::write_diagnosis(&painted::painted(title, found, &runs, &words), &path).map_err(refused)?;
    opened(wanted, path)
}

/// The viewer opened on a file, as wanted.
#[cfg(feature = "rerun")]
fn opened(wanted: Wanted, path: PathBuf) -> Result<Picture, Failure> {
    if wanted.view {
        headland_view::show(&path).map_err(refused)?;
    }
    Ok(Picture { served: wanted.serve.then_some(path) })
}

#[cfg(feature = "rerun")]
fn refused(error: headland_view::ViewError) -> Failure {
    match error {
        headland_view::ViewError::File { path, source } => Failure::unwritable(&path, &source),
        other => Failure::Input(other.to_string()),
    }
}

/// A vehicle of the size that goes with its wheels; a picture, no input of any model.
#[cfg(feature = "rerun")]
fn body(scenario: &Scenario) -> headland_view::Body {
    const WITHOUT_WHEELS_M: f64 = 0.8;
    let radius = scenario.document().number("vehicle.driveline.wheel_radius_m").unwrap_or(WITHOUT_WHEELS_M);
    headland_view::Body {
        length_m: 6.4 * radius,
        width_m: 3.2 * radius,
        height_m: 3.7 * radius,
        wheel_radius_m: radius,
        wheelbase_m: 3.5 * radius,
        track_m: 2.5 * radius,
    }
}
