//! What is drawn around runs: the wheels of rigid bodies, and the ground of their terrains.

use crate::failure::Failure;
use headland_body::{BodyError, Hub, hubs, trailer_hubs};
use headland_plugin::{Place, Registry, Surface, Task};
use headland_scenario::{Fidelity, RunSpec, Scenario};
use headland_sim::{Model, Named};
use headland_trace::Run;
use headland_view::{Body, Implement, Relief, Rig, RigWheel, Setting, Towed};

/// One run and what it was driven with.
#[derive(Debug)]
pub struct Stage {
    run: String,
    /// Its wheels, where it is a rigid body.
    pub rig: Option<Rig>,
    trailer: Option<Towed>,
    implements: Vec<Implement>,
    model: Model,
}

/// Heights and soils of a model.
impl Relief for Stage {
    fn height_m(&self, east_m: f64, north_m: f64) -> Option<f64> {
        self.surface()?.spot(east_m, north_m).map(|spot| spot.height_m)
    }

    fn kind(&self, east_m: f64, north_m: f64) -> Option<&str> {
        self.model.soil.as_ref()?.called(&Place { east_m, north_m, ..Place::default() })
    }
}

impl Stage {
    fn surface(&self) -> Option<&dyn Surface> {
        self.model.terrain.surface()
    }

    /// As the picture takes it.
    pub fn setting(&self) -> Setting<'_> {
        let relief = self.surface().map(|_| self as &dyn Relief);
        let (rig, trailer, implements) = (self.rig.clone(), self.trailer.clone(), self.implements.clone());
        Setting { run: &self.run, rig, trailer, implements, relief }
    }
}

/// What each of the runs of a scenario was driven with.
pub fn stages(scenario: &Scenario, registry: &Registry, runs: &[Run]) -> Result<Vec<Stage>, Failure> {
    let own = |run: &Run| {
        let own = RunSpec { id: run.id.clone(), with: Vec::new() };
        let spec = scenario.runs.iter().find(|spec| spec.id == run.id).unwrap_or(&own);
        stage(&run.id, &scenario.run(spec, registry)?, registry)
    };
    runs.iter().map(own).collect()
}

/// What a run was driven with that a scenario describes alone.
pub fn stage(run: &str, scenario: &Scenario, registry: &Registry) -> Result<Stage, Failure> {
    let model = scenario.model(registry)?;
    let (rig, trailer, implements) = match &scenario.fidelity {
        Fidelity::Longitudinal | Fidelity::QuasiStatic { .. } => (None, None, Vec::new()),
        Fidelity::RigidBody { chassis, .. } => {
            let failed = |error: BodyError| Failure::Machine(error.to_string());
            let wheels = hubs(&model, chassis).map_err(failed)?.into_iter().map(wheel).collect();
            let centre_height_m = model.axles.as_ref().map_or(0.0, |axles| axles.centre_of_gravity_height_m);
            let trailer = trailer_hubs(&model, chassis).map_err(failed)?.map(|trailer| Towed {
                rig: Rig {
                    centre_height_m: trailer.centre_height_m,
                    wheels: trailer.hubs.into_iter().map(wheel).collect(),
                },
                coupling_m: trailer.coupling_m,
            });
            let height_m = model.axles.as_ref().map_or(0.0, |axles| axles.hitch_height_m);
            let implements = implements(&model, [chassis.hitch_position_m, height_m]);
            (Some(Rig { centre_height_m, wheels }), trailer, implements)
        }
    };
    Ok(Stage { run: run.to_owned(), rig, trailer, implements, model })
}

/// What the tasks hang on a hitch.
fn implements(model: &Model, hitch_m: [f64; 2]) -> Vec<Implement> {
    let hung = |task: &Named<dyn Task>| {
        let headland_plugin::Implement { width_m, depth_m, tools, lift_m } = task.plugin.implement()?;
        Some(Implement { name: task.name.clone(), hitch_m, width_m, depth_m, tools, lift_m })
    };
    model.tasks.iter().filter_map(hung).collect()
}

fn wheel(hub: Hub) -> RigWheel {
    let Hub { name, place_m, radius_m, width_m, squeezed_m } = hub;
    RigWheel { name, hub_m: place_m, radius_m, width_m, squeezed_m }
}

/// A vehicle that goes with its wheels; beside those a picture, no input of any model.
pub fn body(rig: &Rig) -> Body {
    let along = || rig.wheels.iter().map(|wheel| wheel.hub_m[0]);
    let wheelbase_m = along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min);
    let radius_m = rig.wheels.iter().map(|wheel| wheel.radius_m).fold(0.0, f64::max);
    let aside = |add_m: &dyn Fn(&RigWheel) -> f64| {
        rig.wheels.iter().map(|wheel| 2.0 * wheel.hub_m[1].abs() + add_m(wheel)).fold(0.0, f64::max)
    };
    Body {
        length_m: wheelbase_m + 2.9 * radius_m,
        width_m: aside(&|wheel| wheel.width_m),
        height_m: 3.7 * radius_m,
        wheel_radius_m: radius_m,
        wheelbase_m: wheelbase_m.max(radius_m),
        track_m: aside(&|_| 0.0).max(radius_m),
    }
}
