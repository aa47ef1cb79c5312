//! Where energy went.

use headland_report::{Plot, build};
use headland_sim::Ledger;

/// The ledger of a run as flows.
pub fn flow(ledger: &Ledger) -> Plot {
    let spaced = |name: &str| name.replace('_', " ");
    let source = spaced(&ledger.source_name);
    let sinks: Vec<(String, f64)> = std::iter::once(("kinetic energy".to_owned(), ledger.kinetic_j))
        .chain(ledger.sinks.iter().map(|sink| (spaced(&sink.name), sink.energy_j)))
        .collect();
    let sinks: Vec<(&str, f64)> = sinks.iter().map(|(name, energy)| (name.as_str(), *energy)).collect();
    build::energy_flow("vehicle", &[(&source, ledger.source_j)], &sinks)
}
