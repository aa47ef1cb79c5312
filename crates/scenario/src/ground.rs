//! The soil of a scenario, and the soils that it is made of.

use crate::document::Document;
use crate::error::ScenarioError;
use crate::plugins::{Remark, build, build_all};
use crate::tree::Node;
use headland_plugin::{Registry, Soil};
use std::path::Path;

/// Builds the soil at `node`, of those of `ground.soils` where it is made of them.
pub fn soil(
    document: &Document,
    node: &Node,
    registry: &Registry,
    folder: &Path,
    remarks: &mut Vec<Remark>,
) -> Result<Box<dyn Soil>, ScenarioError> {
    let more = "headland plugins soil";
    let (name, mut soil) = build(document, node, &registry.soils, more, folder, remarks)?;
    let parts = build_all(document, "ground.soils", &registry.soils, more, folder, remarks)?;
    if parts.is_empty() {
        if soil.needs_soils() {
            return Err(ScenarioError::MissingField {
                field: "soils".to_owned(),
                of: format!("`ground` with `{name}`"),
                at: document.location(node.span.start),
            });
        }
        return Ok(soil);
    }
    let parts = parts.into_iter().map(|part| (part.name, part.plugin)).collect();
    soil.adopt(parts).map_err(|refusal| {
        let below = format!("ground.soil.{}", refusal.parameter);
        let found = document.find(&below).or_else(|| document.find("ground.soils"));
        ScenarioError::Value {
            name: refusal.parameter,
            found: refusal.found,
            expected: refusal.expected,
            at: document.location(found.map_or(node.span.start, |node| node.span.start)),
        }
    })?;
    Ok(soil)
}

/// What to say of a soil that knows whole vehicles only, below a vehicle that stands on axles.
pub fn beside_axles(document: &Document, soil: &dyn Soil) -> Option<Remark> {
    if soil.needs_axles() || soil.needs_soils() {
        return None;
    }
    let node = document.find("ground.soil")?;
    let name = node.name(document.text()).unwrap_or("the soil");
    let text = format!(
        "`{name}` knows whole vehicles only: on it the tyres of `axles` change nothing and no wheel slips; {PER_WHEEL} speak of \
         single wheels"
    );
    Some(Remark { text, at: document.location(node.span.start) })
}

/// The soils that the remark names.
const PER_WHEEL: &str = "`Brixius`, `WismerLuth`, `Bekker` and `WongReece`";

#[cfg(test)]
mod tests {
    use crate::Scenario;
    use std::path::Path;

    const GOOD: &str = r#"(
        about: "a road through a field",
        vehicle: (mass_kg: 9000, rotating_mass_kg: 0, drag_area_m2: 5, driveline: Neutral),
        ground: (
            terrain: Flat(heading_rad: "90 deg"),
            soil: Zones(otherwise: "field", areas: [
                (soil: "road", corners: [(east_m: 20, north_m: -5), (east_m: "30 m", north_m: -5), (east_m: 25, north_m: 5)]),
            ]),
            soils: {"field": Constant(coefficient: 0.08), "road": Constant(coefficient: 0.02)},
        ),
        air: (density_kg_m3: 1.2),
        simulation: (fidelity: Longitudinal, step_s: 0.05),
    )"#;

    fn told(from: &str, to: &str) -> String {
        assert!(GOOD.contains(from));
        let text = GOOD.replacen(from, to, 1);
        Scenario::of_text("test.ron", &text, Path::new(""), &headland_stock::registry()).unwrap_err().told()
    }

    #[test]
    fn zones_take_the_soils_beside_them() {
        let scenario =
            Scenario::of_text("test.ron", GOOD, Path::new(""), &headland_stock::registry()).unwrap();
        let soil = scenario.model(&headland_stock::registry()).unwrap().soil.unwrap();
        assert!(!soil.needs_axles() && soil.needs_soils());
    }

    /// The tyres would not be looked at, which is no error and yet seldom meant.
    #[test]
    fn axles_on_a_soil_of_whole_vehicles_are_remarked_upon() {
        let axle = |at: f64| {
            format!(
                "(position_m: {at}, track_m: 2, wheels: 2, lead: 1, tyre: (width_m: 0.5, diameter_m: 1.7, section_height_m: 0.3, \
                 inflation_pa: 1e5, carcass_pa: 0))"
            )
        };
        let axles = format!(
            "drag_area_m2: 5, axles: [{}, {}], centre_of_gravity_height_m: 1, hitch_height_m: 0.5, slip_limit: 0.5,",
            axle(1.5),
            axle(-1.0)
        );
        let remarks = |soil: &str| {
            let start = GOOD.find("Zones(").unwrap();
            let end = GOOD.find("        ),\n        air:").unwrap();
            let text = GOOD.replace(&GOOD[start..end], soil).replace("drag_area_m2: 5,", &axles);
            let scenario = Scenario::of_text("test.ron", &text, Path::new(""), &headland_stock::registry());
            scenario.unwrap_or_else(|error| panic!("{}", error.told())).remarks
        };
        let told = remarks("Constant(coefficient: 0.05),\n");
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].text.starts_with("`Constant` knows whole vehicles only"), "{told:?}");
        assert_eq!(told[0].at.to_string(), "test.ron:6:19", "{told:?}");
        let per_wheel = "Brixius(cone_index_pa: 9e5, construction: Radial, pass_factor: 1.5),\n";
        assert!(remarks(per_wheel).is_empty());
    }

    /// In the list of the areas, not at its begin.
    #[test]
    fn areas_that_are_none_are_refused_where_they_stand() {
        let second = |corners: &str| {
            told("north_m: 5)]),", &format!("north_m: 5)]),\n(soil: \"road\", corners: [{corners}])"))
        };
        let few = second("(east_m: 1, north_m: 2), (east_m: 3, north_m: 5)");
        assert!(few.contains("`areas.1.corners` is 2 corners") && few.contains("test.ron:8:25"), "{few}");
        let odd = second("(east_m: 1, north_m: 2), (east_m: 3, north_m: inf), (east_m: 3, north_m: 5)");
        assert!(odd.contains("`areas.1.corners.1.north_m` is inf, expected a finite number"), "{odd}");
        assert!(odd.contains("test.ron:8:72"), "{odd}");
        let line = second("(east_m: 1, north_m: 1), (east_m: 2, north_m: 2), (east_m: 3, north_m: 3)");
        assert!(line.contains("in one line") && line.contains("test.ron:8:25"), "{line}");
    }

    #[test]
    fn bad_parameters_of_a_soil_of_the_zones_are_refused_where_they_stand() {
        let negative =
            told("\"road\": Constant(coefficient: 0.02)", "\"road\": Constant(coefficient: -0.02)");
        assert!(negative.contains("`coefficient` is -0.02, expected 0 or more"), "{negative}");
        assert!(negative.contains("test.ron:9:89"), "{negative}");
        let lacking = told(
            "\"road\": Constant(coefficient: 0.02)",
            "\"road\": Brixius(moist: (soil_type: CL),\nconstruction: Radial, pass_factor: 1)",
        );
        assert!(
            lacking.contains("lacks the field `moisture`") && lacking.contains("test.ron:9:82"),
            "{lacking}"
        );
    }

    #[test]
    fn soils_that_do_not_fit_the_zones_are_refused_where_they_stand() {
        let unknown = told("(soil: \"road\"", "(soil: \"rood\"");
        assert!(
            unknown.contains("`areas.0.soil` is \"rood\"") && unknown.contains("field, road"),
            "{unknown}"
        );
        let none = told(
            "            soils: {\"field\": Constant(coefficient: 0.08), \"road\": Constant(coefficient: 0.02)},\n",
            "",
        );
        assert!(none.contains("`soils`") && none.contains("`Zones`"), "{none}");
        let start = GOOD.find("Zones(").unwrap();
        let end = GOOD.find("            soils:").unwrap();
        let plain = told(&GOOD[start..end], "Constant(coefficient: 0.05),\n");
        assert!(plain.contains("the same everywhere"), "{plain}");
    }
}
