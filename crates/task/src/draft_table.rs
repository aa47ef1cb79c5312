//! Coefficients of drafts by implement, after ASABE D497.
//!
//! D = F_i (A + B S + C S²) W T        S [km/h], T [cm], W [m] or number of tools
//!
//! Source: ASABE D497, *Agricultural Machinery Management Data*, clause 4 and table 1. The standard itself was not at
//! hand. Where a row says `seen`, its numbers stand in published code or pages that cite the standard; where it says
//! `from memory`, they are a default to be overridden by what was measured. The standard's own spread of each row is
//! ±15 to ±50 %.

use headland_plugin::{Refusal, closest};

/// Draft of one kind of implement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Implement {
    /// What it is called in a scenario.
    pub name: &'static str,
    /// Coefficients A, B and C.
    pub abc: [f64; 3],
    /// Factors of fine, medium and coarse soil.
    pub factors: [f64; 3],
    /// What W counts.
    pub per: Per,
    /// Whether the depth counts; for seeding it is 1.
    pub deep: bool,
    /// Spread that the standard gives [%].
    pub spread_percent: f64,
    /// Where the numbers come from.
    pub source: &'static str,
}

/// What the draft is proportional to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// Working width [m].
    Metre,
    /// Tools, or rows.
    Tool,
}

const SEEN: &str = "seen in public code that cites ASABE D497";
const PARTLY: &str = "coefficients seen in public code that cites ASABE D497, soil factors from memory";
const MEMORY: &str = "ASABE D497, from memory";
const DEEP: [f64; 3] = [1.0, 0.70, 0.45];
const TINES: [f64; 3] = [1.0, 0.85, 0.65];
const DISKS: [f64; 3] = [1.0, 0.88, 0.78];
const ALIKE: [f64; 3] = [1.0, 1.0, 1.0];

const fn row(
    name: &'static str,
    abc: [f64; 3],
    factors: [f64; 3],
    per: Per,
    spread_percent: f64,
    source: &'static str,
) -> Implement {
    Implement { name, abc, factors, per, deep: true, spread_percent, source }
}

const fn seeding(
    name: &'static str,
    pull_n: f64,
    factors: [f64; 3],
    per: Per,
    spread_percent: f64,
    source: &'static str,
) -> Implement {
    Implement { name, abc: [pull_n, 0.0, 0.0], factors, per, deep: false, spread_percent, source }
}

/// Every implement.
pub const IMPLEMENTS: [Implement; 20] = [
    row("subsoiler", [226.0, 0.0, 1.8], DEEP, Per::Tool, 50.0, SEEN),
    row("moldboard plough", [652.0, 0.0, 5.1], DEEP, Per::Metre, 40.0, SEEN),
    row("chisel plough, straight points", [91.0, 5.4, 0.0], TINES, Per::Tool, 50.0, PARTLY),
    row("chisel plough, 75 mm shovels", [107.0, 6.3, 0.0], TINES, Per::Tool, 50.0, MEMORY),
    row("chisel plough, 100 mm twisted shovels", [123.0, 7.3, 0.0], TINES, Per::Tool, 50.0, MEMORY),
    row("sweep plough, primary", [390.0, 19.0, 0.0], TINES, Per::Metre, 45.0, PARTLY),
    row("tandem disk, primary", [309.0, 16.0, 0.0], DISKS, Per::Metre, 50.0, MEMORY),
    row("tandem disk, secondary", [216.0, 11.2, 0.0], DISKS, Per::Metre, 30.0, MEMORY),
    row("offset disk, primary", [364.0, 18.8, 0.0], DISKS, Per::Metre, 50.0, MEMORY),
    row("offset disk, secondary", [254.0, 13.2, 0.0], DISKS, Per::Metre, 30.0, MEMORY),
    row("field cultivator, primary", [46.0, 2.8, 0.0], TINES, Per::Tool, 30.0, PARTLY),
    row("field cultivator, secondary", [32.0, 1.9, 0.0], TINES, Per::Tool, 25.0, PARTLY),
    row("row-crop cultivator, S-tine", [140.0, 7.0, 0.0], TINES, Per::Tool, 15.0, MEMORY),
    seeding("row planter, drawn, seed only", 900.0, ALIKE, Per::Tool, 25.0, MEMORY),
    seeding("row planter, drawn, seed and fertiliser", 1550.0, ALIKE, Per::Tool, 25.0, MEMORY),
    seeding("no-till planter, double disk", 1900.0, [1.0, 0.96, 0.92], Per::Tool, 30.0, SEEN),
    seeding("no-till planter, knife", 3400.0, [1.0, 0.96, 0.92], Per::Tool, 35.0, SEEN),
    seeding("grain drill", 200.0, ALIKE, Per::Tool, 25.0, MEMORY),
    seeding("grain drill, no-till", 720.0, [1.0, 0.92, 0.79], Per::Tool, 35.0, MEMORY),
    seeding("pneumatic drill", 3700.0, ALIKE, Per::Metre, 50.0, MEMORY),
];

/// The row of an implement.
///
/// # Errors
/// [`Refusal`] of `implement` names those that are known.
pub(crate) fn find(name: &str) -> Result<Implement, Refusal> {
    IMPLEMENTS.iter().find(|row| row.name == name).copied().ok_or_else(|| {
        let names: Vec<&str> = IMPLEMENTS.iter().map(|row| row.name).collect();
        let nearest = closest(name, &names).map_or(String::new(), |near| format!("`{near}`, or another "));
        Refusal {
            parameter: "implement".to_owned(),
            found: format!("`{name}`"),
            expected: format!("{nearest}of: {}", names.join("; ")),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_has_its_own_name_a_source_and_a_draft() {
        for (index, row) in IMPLEMENTS.iter().enumerate() {
            assert!(IMPLEMENTS[..index].iter().all(|other| other.name != row.name), "{}", row.name);
            assert!(row.source.contains("D497") && row.abc[0] > 0.0 && row.factors[0] == 1.0);
            assert!(row.factors.windows(2).all(|pair| pair[1] <= pair[0]), "{}", row.name);
            assert!((15.0..=50.0).contains(&row.spread_percent));
        }
    }

    #[test]
    fn a_misspelt_implement_is_told_with_the_nearest_and_all_others() {
        let refusal = find("mouldboard plough").unwrap_err();
        assert!(refusal.expected.starts_with("`moldboard plough`, or another of: subsoiler;"), "{refusal}");
    }
}
