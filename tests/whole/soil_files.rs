//! The soils of `scenarios/soils` against the published table that they were taken from, and the page that tells of them.
//!
//! `HEADLAND_WRITE=1 cargo test --test whole soil_files` writes `docs/soils.md` anew.

use crate::root;
use headland_scenario::Document;
use std::fmt::Write;
use std::path::Path;

/// A row: file, exponent n, k_c [kN/m^(n+1)], k_φ [kN/m^(n+2)], c [kPa], φ [°], K [mm].
type Row = (&'static str, f64, f64, f64, f64, f64, f64);

/// Wong, *Theory of Ground Vehicles* (2008), chapter 2, and the measurements that each file names.
const TABLE: [Row; 17] = [
    ("dry_sand", 1.10, 0.99, 1528.43, 1.04, 28.0, 10.0),
    ("lete_sand", 0.793, 102.0, 5301.0, 1.3, 31.1, 12.0),
    ("sandy_loam_15", 0.70, 5.27, 1515.04, 1.72, 29.0, 25.0),
    ("clayey_soil_38", 0.50, 13.19, 692.15, 4.14, 13.0, 6.0),
    ("clayey_soil_55", 0.70, 16.03, 1262.53, 2.07, 10.0, 6.0),
    ("sandy_loam_11", 0.9, 52.53, 1127.97, 4.83, 20.0, 20.0),
    ("sandy_loam_23", 0.4, 11.42, 808.96, 9.65, 35.0, 20.0),
    ("heavy_clay_25", 0.13, 12.70, 1555.95, 68.95, 34.0, 6.0),
    ("heavy_clay_40", 0.11, 1.84, 103.27, 20.69, 6.0, 6.0),
    ("lean_clay_22", 0.20, 16.43, 1724.69, 68.95, 20.0, 6.0),
    ("lean_clay_32", 0.15, 1.52, 119.61, 13.79, 11.0, 6.0),
    ("upland_sandy_loam_51", 1.10, 74.6, 2080.0, 3.3, 33.7, 20.0),
    ("rubicon_sandy_loam_43", 0.66, 6.9, 752.0, 3.7, 29.8, 20.0),
    ("north_gower_clayey_loam_46", 0.73, 41.6, 2471.0, 6.1, 26.6, 20.0),
    ("grenville_loam_24", 1.01, 0.06, 5880.0, 3.1, 29.8, 20.0),
    ("snow_harrison", 1.6, 4.37, 196.7, 1.03, 19.7, 40.0),
    ("snow_sweden", 1.44, 10.55, 66.08, 6.0, 20.7, 40.0),
];

const HEAD: &str = "# Soils

Made from the files of `scenarios/soils`, for `Bekker` and `WongReece`: `include(\"soils/dry_sand.ron\")`. Pressure under a wheel of width b
at sinkage z is (k_c/b + k_φ) zⁿ, shear stress (c + σ tan φ)(1 − exp(−j/K)). What a file says of its source stands in the last column.

| file | n | k_c kN/m^(n+1) | k_φ kN/m^(n+2) | c kPa | φ ° | K mm | source |
|---|---:|---:|---:|---:|---:|---:|---|
";

fn number(document: &Document, field: &str) -> f64 {
    document.number(field).unwrap_or_else(|| panic!("{} lacks {field}", document.path().display()))
}

/// The six numbers of a file in the units of the table.
fn values(document: &Document) -> [f64; 6] {
    let of = |field: &str| number(document, field);
    [
        of("exponent"),
        of("cohesive_modulus") / 1e3,
        of("frictional_modulus") / 1e3,
        of("cohesion_pa") / 1e3,
        of("friction_angle_rad").to_degrees(),
        of("shear_displacement_m") * 1e3,
    ]
}

/// The lines of comment that a file begins with, as one sentence.
fn source(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    let lines = text.lines().map_while(|line| line.strip_prefix("//"));
    lines.map(str::trim).collect::<Vec<_>>().join(" ").replace('|', "\\|")
}

#[test]
fn every_soil_is_that_of_the_table() {
    let folder = root().join("scenarios/soils");
    let mut files: Vec<String> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    files.sort();
    let mut known: Vec<&str> = TABLE.iter().map(|row| row.0).collect();
    known.sort_unstable();
    assert_eq!(files, known, "a file without a row of the table, or a row without a file");
    for (name, n, k_c, k_phi, c, phi, k) in TABLE {
        let document = Document::read(&folder.join(format!("{name}.ron"))).unwrap();
        let found = values(&document);
        for (found, wanted) in found.into_iter().zip([n, k_c, k_phi, c, phi, k]) {
            assert!((found - wanted).abs() < 1e-9 * wanted, "{name}: {found}, in the table {wanted}");
        }
    }
}

#[test]
fn the_page_of_soils_is_up_to_date() {
    let mut page = HEAD.to_owned();
    for (name, ..) in TABLE {
        let path = root().join("scenarios/soils").join(format!("{name}.ron"));
        let [n, k_c, k_phi, c, phi, k] = values(&Document::read(&path).unwrap()).map(rounded);
        let _ = writeln!(
            page,
            "| `{name}` | {n} | {k_c} | {k_phi} | {c} | {phi} | {k} | {} |",
            source(&path).trim_end_matches('.')
        );
    }
    let path = root().join("docs/soils.md");
    if std::env::var_os("HEADLAND_WRITE").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(
        page, found,
        "`HEADLAND_WRITE=1 cargo test --test whole soil_files` writes docs/soils.md anew"
    );
}

/// Without what a conversion of units leaves behind.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}
