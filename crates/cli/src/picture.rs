//! Runs as a Rerun recording, where the program was built with it.

use crate::failure::Failure;
use crate::held::Pair;
use crate::output::Output;
use headland_scenario::Scenario;
use headland_trace::Run;

/// What is wanted of Rerun.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    write: bool,
    view: bool,
}

impl Wanted {
    /// Of the options; to view is to write too.
    pub fn of(rerun: bool, view: bool) -> Self {
        Self { write: rerun || view, view }
    }
}

/// Whether this program can draw, asked before anything is simulated.
pub fn possible(wanted: bool) -> Result<(), Failure> {
    if wanted && !cfg!(feature = "rerun") {
        return Err(Failure::Input(
            "this `headland` was built without Rerun; build it with `--features rerun` for --rerun and --view".to_owned(),
        ));
    }
    Ok(())
}

/// Writes `run.rrd` and opens the viewer, as wanted.
#[cfg(not(feature = "rerun"))]
pub fn draw(wanted: Wanted, _: &Scenario, _: &[Run], _: &[Pair], _: &mut Output) -> Result<(), Failure> {
    possible(wanted.write || wanted.view)
}

/// Writes `run.rrd` and opens the viewer, as wanted.
#[cfg(feature = "rerun")]
pub fn draw(
    wanted: Wanted,
    scenario: &Scenario,
    runs: &[Run],
    pairs: &[Pair],
    output: &mut Output,
) -> Result<(), Failure> {
    use headland_view::{Axis, ForceArrow, Scene};
    if !wanted.write {
        return Ok(());
    }
    let measured: Vec<Run> = pairs
        .iter()
        .map(|pair| Run { id: pair.comparison.run.clone(), trace: pair.measured.clone() })
        .collect();
    // A recording without a place cannot be drawn; its speed stands in the plots all the same.
    let placed = |run: &Run| run.trace.get("position_m").is_some() || run.trace.get("east_m").is_some();
    let measured: Vec<Run> = measured.into_iter().filter(placed).collect();
    let arrow = |channel, label, axis| ForceArrow { channel, label, axis };
    let all = [
        arrow("tractive_force_n", "traction", Axis::Forward),
        arrow("soil_resistance_n", "soil", Axis::Backward),
        arrow("air_resistance_n", "air", Axis::Backward),
        arrow("slope_resistance_n", "slope", Axis::Backward),
        arrow("brake_force_n", "brakes", Axis::Backward),
        arrow("drawbar_force_n", "drawbar", Axis::Backward),
    ];
    let drawn = |arrow: &ForceArrow| runs.iter().any(|run| run.trace.channel(arrow.channel).is_some());
    let forces: Vec<ForceArrow> = all.into_iter().filter(drawn).collect();
    let scene = Scene {
        title: &scenario.about,
        runs,
        measured: &measured,
        forces: &forces,
        vehicle: body(scenario),
        ground: None,
    };
    let path = output.file("run.rrd");
    headland_view::write(&scene, &path).map_err(refused)?;
    if wanted.view { headland_view::show(&path).map_err(refused) } else { Ok(()) }
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
