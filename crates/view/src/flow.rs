//! Where the power at the wheels goes at each instant: to what resists, into motion, into slip.
//!
//! P = F w of what drives, F v of what resists, m v (dv/dt) into motion, F (w − v) into slip        [W]
//!
//! v is the speed of the vehicle, w that at which its wheels roll; brakes are counted with the slip that they cause.

use crate::colour::{Colour, ORANGE};
use crate::groups::{Group, colour};
use crate::lanes::Lane;
use crate::plots::{COMPARED, line};
use crate::recorder::Recorder;
use crate::scene::Axis;
use crate::{Scene, ViewError, entity};
use headland_trace::Run;

/// What stands over the plot.
pub(crate) const TITLE: &str = "Energy flow [W]";
/// What no arrow has the colour of.
const MOTION: Colour = ORANGE;
const SLIP: Colour = [245, 245, 245];

/// One line of the plot.
#[derive(Debug, PartialEq)]
pub(crate) struct Flow {
    pub name: String,
    pub colour: Colour,
    /// A power for each row of the run [W].
    pub values: Vec<f64>,
}

/// The powers of a run; none where it has no forces or no speed.
pub(crate) fn flows(scene: &Scene, groups: &[Group], run: &Run) -> Vec<Flow> {
    let Some(speeds) = run.trace.get(COMPARED) else { return Vec::new() };
    let rolling = run.trace.get("wheel_speed_m_s");
    let wheels = rolling.unwrap_or(speeds);
    let power =
        |force: &[f64], at: &[f64]| force.iter().zip(at).map(|(force, speed)| force * speed).collect();
    let (mut flows, mut slip_w) = (Vec::new(), vec![0.0; speeds.len()]);
    for force in scene.forces {
        let Some(values) = run.trace.get(force.channel) else { continue };
        let at = match force.axis {
            Axis::Forward => wheels,
            Axis::Backward => speeds,
            Axis::Up => continue,
        };
        if force.axis == Axis::Forward {
            for (row, sum_w) in slip_w.iter_mut().enumerate() {
                *sum_w += values[row] * (wheels[row] - speeds[row]);
            }
        }
        flows.push(Flow {
            name: force.label.to_owned(),
            colour: colour(groups, force.channel),
            values: power(values, at),
        });
    }
    if flows.is_empty() {
        return flows;
    }
    if let Some((masses, rates)) = run.trace.get("effective_mass_kg").zip(run.trace.get("acceleration_m_s2"))
    {
        let forces: Vec<f64> = power(masses, rates);
        flows.push(Flow { name: "motion".to_owned(), colour: MOTION, values: power(&forces, speeds) });
    }
    if rolling.is_some() {
        flows.push(Flow { name: "slip".to_owned(), colour: SLIP, values: slip_w });
    }
    flows
}

/// Draws them.
pub(crate) fn draw(to: &Recorder, scene: &Scene, groups: &[Group], lane: &Lane) -> Result<(), ViewError> {
    for flow in flows(scene, groups, lane.run) {
        let at = entity::flow(&lane.run.id, &flow.name);
        line(to, &at, &flow.name, flow.colour, 2.0, lane.run.trace.time_s(), &flow.values)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ForceArrow;
    use crate::groups::groups;
    use crate::scene::tests::{run, scene};

    /// By hand: 10 kN at wheels of 2.2 m/s are 22 kW; of these 8 go to the soil at 2 m/s, 12 into 3 t that gain 2 m/s², 2 into slip.
    #[test]
    fn what_the_wheels_get_is_what_soil_motion_and_slip_take() {
        let runs = [run(
            "r1",
            &[
                ("position_m", &[0.0]),
                ("speed_m_s", &[2.0]),
                ("wheel_speed_m_s", &[2.2]),
                ("acceleration_m_s2", &[2.0]),
                ("effective_mass_kg", &[3_000.0]),
                ("tractive_force_n", &[10e3]),
                ("soil_resistance_n", &[4e3]),
            ],
        )];
        let arrow = |channel, label, axis| ForceArrow { channel, label, axis };
        let forces = [
            arrow("tractive_force_n", "traction", Axis::Forward),
            arrow("soil_resistance_n", "soil", Axis::Backward),
        ];
        let scene = Scene { forces: &forces, ..scene(&runs, &[]) };
        let groups = groups(&scene);
        let flows = flows(&scene, &groups, &runs[0]);
        let told: Vec<(&str, f64)> =
            flows.iter().map(|flow| (flow.name.as_str(), flow.values[0].round())).collect();
        assert_eq!(told, [("traction", 22e3), ("soil", 8e3), ("motion", 12e3), ("slip", 2e3)]);
        assert_eq!(flows[0].colour, colour(&groups, "tractive_force_n"), "as its arrow");
        let mut colours: Vec<Colour> = flows.iter().map(|flow| flow.colour).collect();
        colours.sort_unstable();
        colours.dedup();
        assert_eq!(colours.len(), flows.len());
    }

    #[test]
    fn a_run_without_forces_has_no_flow() {
        let runs = [run("r1", &[("position_m", &[0.0]), ("speed_m_s", &[2.0])])];
        let scene = scene(&runs, &[]);
        assert_eq!(flows(&scene, &groups(&scene), &runs[0]), []);
    }
}
