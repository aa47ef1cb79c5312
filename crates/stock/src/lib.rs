//! Every model that is built in; the only place that knows them all.

use headland_plugin::Registry;

/// Every soil, terrain, driveline, task and effect that is built in.
pub fn registry() -> Registry {
    let mut registry = Registry::new();
    headland_soil::register(&mut registry);
    headland_terrain::register(&mut registry);
    headland_driveline::register(&mut registry);
    headland_task::register(&mut registry);
    headland_effect::register(&mut registry);
    registry
}
