//! Where the physics is the same, both fidelities say the same.

use super::{coast_down, cycle, last, model, run, soil, terrain};
use headland_sim::{End, simulate};
use headland_soil::LinearSpeedLaw;
use headland_terrain::Flat;

const STEP_S: f64 = 2e-3;

#[test]
fn a_coast_down_on_level_ground_stops_when_and_where_the_longitudinal_one_does() {
    let model = model(
        terrain::<Flat>("()"),
        soil::<LinearSpeedLaw>("(coefficient: 0.069, speed_scale_m_s: 27.7777777777)"),
    );
    let cycle = cycle(30.0 / 3.6, coast_down(), STEP_S);
    let (one, three) = (simulate(&model, &cycle).unwrap(), run(&model, &cycle));
    assert_eq!(three.end, End::Finished);
    assert!((three.trace.duration_s() / one.trace.duration_s() - 1.0).abs() < 2e-3);
    assert!((last(&three, "position_m") / last(&one, "position_m") - 1.0).abs() < 2e-3);
    assert!(three.ledger.relative_residual() < 1e-3);
}
