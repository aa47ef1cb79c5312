//! What the tests share.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use tempfile::TempDir;

/// The program.
pub fn headland() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_headland"));
    command.env_remove("HEADLAND_RECORDINGS");
    command
}

/// Runs the program.
pub fn run(arguments: &[&str]) -> Output {
    headland().args(arguments).output().unwrap()
}

/// Runs the program, which has to succeed; gives its standard output.
pub fn done(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}\n{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs the program, which has to refuse with this status; gives what it said.
pub fn refused(status: i32, arguments: &[&str]) -> String {
    let output = run(arguments);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(status), "{arguments:?}\n{told}");
    told
}

/// A JSON document of a file.
pub fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// The top of the repository.
pub fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap().to_owned()
}

/// A path as an argument.
pub fn word(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// What `headland demo` leaves behind, made once.
pub fn demo() -> &'static Path {
    static DEMO: OnceLock<TempDir> = OnceLock::new();
    DEMO.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        done(&["demo", "--out", word(folder.path()), "--quiet"]);
        folder
    })
    .path()
}

/// A small scenario that rolls out.
pub const SCENARIO: &str = r#"(
    about: "a cart rolls out",
    vehicle: (
        name: "cart",
        mass_kg: 1000,
        rotating_mass_kg: 0,
        drag_area_m2: 2.0,
        driveline: Neutral,
    ),
    ground: (
        terrain: Flat,
        soil: Constant(coefficient: 0.02),
    ),
    air: (density_kg_m3: 1.2),
    start: (position_m: 0, speed_m_s: "36 km/h"),
    cycle: [Coast(until: Elapsed(for_s: 20))],
    free: [(name: "ground.soil.coefficient", sd: 0.02, bounds: (0.001, 0.2))],
    simulation: (fidelity: Longitudinal, step_s: 0.05),
)
"#;

/// A recording of a roll-out at 0.3 m/s².
pub const RECORDING: &str = r#"(
    about: "a cart that rolls out",
    runs: [(id: "r1", file: "r1.csv")],
    channels: [(column: "v", is: "speed_m_s", unit: "km/h")],
    known: [(name: "mass_kg", value: 1000)],
)
"#;

/// Its log: rows of 0.1 s for 20 s.
pub fn log() -> String {
    let row =
        |at: i32| format!("{:.1},{:.3},1\n", f64::from(at) / 10.0, 36.0 - 3.6 * 0.3 * f64::from(at) / 10.0);
    "time_s,v,coasting\n".to_owned() + &(0..=200).map(row).collect::<String>()
}

/// A folder with a scenario, a recording and its log.
pub struct Place(TempDir);

impl Place {
    /// The three files as above.
    pub fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        place.write("scenario.ron", SCENARIO);
        place.write("recording.ron", RECORDING);
        place.write("r1.csv", &log());
        place
    }

    /// Writes a file.
    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.path().join(name), text).unwrap();
    }

    /// Path of a file.
    pub fn path(&self, name: &str) -> String {
        word(&self.0.path().join(name)).to_owned()
    }

    /// A document that was written.
    pub fn json(&self, name: &str) -> Value {
        json(&self.0.path().join(name))
    }

    /// Compares its scenario with its recording.
    pub fn compare(&self) -> Output {
        run(&[
            "compare",
            &self.path("scenario.ron"),
            "--recording",
            &self.path("recording.ron"),
            "--out",
            &self.path("out"),
        ])
    }
}
