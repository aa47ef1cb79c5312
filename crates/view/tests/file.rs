//! What a written file holds, read back with Rerun's own decoder.

use headland_trace::{Origin, Run, Trace};
use headland_view::{
    Axis, Body, ForceArrow, Implement, Relief, Rig, RigWheel, Scene, Setting, Towed, ViewError, write,
};
use rerun::external::re_log_encoding::DecoderApp;
use rerun::external::re_log_types::StoreKind;
use rerun::log::{Chunk, LogMsg};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

const BODY: Body =
    Body { length_m: 6.0, width_m: 3.0, height_m: 3.5, wheel_radius_m: 0.95, wheelbase_m: 3.3, track_m: 2.3 };
const FORCES: [ForceArrow; 1] = [ForceArrow { channel: "drag_force_n", label: "drag", axis: Axis::Backward }];

/// A run of 5000 samples, a tenth of a second apart, with one spike in its drag.
fn run(id: &str, origin: Origin) -> Run {
    let mut trace = Trace::new((0..5000).map(|index| f64::from(index) * 0.1).collect()).unwrap();
    let mut drag = vec![100.0; 5000];
    drag[3333] = 6500.0;
    drag[4000] = f64::NAN;
    trace.push("east_m", (0..5000).map(|index| f64::from(index) * 0.2).collect(), origin).unwrap();
    trace.push("north_m", vec![7.0; 5000], origin).unwrap();
    trace.push("speed_m_s", vec![2.0; 5000], origin).unwrap();
    trace.push("drag_force_n", drag, origin).unwrap();
    Run { id: id.to_owned(), trace }
}

struct Content {
    /// The chunks of the recording, by entity.
    recording: BTreeMap<String, Vec<Chunk>>,
    layout: BTreeMap<String, Vec<Chunk>>,
    activated: usize,
}

fn read(path: &Path) -> Content {
    let mut content = Content { recording: BTreeMap::new(), layout: BTreeMap::new(), activated: 0 };
    for message in DecoderApp::decode_eager(BufReader::new(File::open(path).unwrap())).unwrap() {
        match message.unwrap() {
            LogMsg::ArrowMsg(store, message) => {
                let chunk = Chunk::from_arrow_msg(&message).unwrap();
                let entity = chunk.entity_path().to_string();
                let kind = match store.kind() {
                    StoreKind::Recording => &mut content.recording,
                    StoreKind::Blueprint => &mut content.layout,
                };
                kind.entry(entity).or_default().push(chunk);
            }
            LogMsg::BlueprintActivationCommand(command) => {
                assert!(command.make_active && command.make_default);
                content.activated += 1;
            }
            LogMsg::SetStoreInfo(_) => {}
        }
    }
    content
}

impl Content {
    /// The times [s] of the rows of an entity.
    fn times_s(&self, entity: &str) -> Vec<f64> {
        let chunks = self
            .recording
            .get(entity)
            .unwrap_or_else(|| panic!("no `{entity}` among {:?}", self.recording.keys().collect::<Vec<_>>()));
        let timelines = chunks.iter().flat_map(|chunk| chunk.timelines().values());
        let mut times = Vec::new();
        for timeline in timelines {
            assert_eq!(timeline.name(), "time", "the only timeline");
            times.extend(timeline.times_raw().iter().map(|nanoseconds| *nanoseconds as f64 / 1e9));
        }
        times
    }

    /// The numbers of a plotted line.
    fn line(&self, entity: &str) -> Vec<f64> {
        let scalars = "Scalars:scalars".into();
        let chunks = self.recording[entity].iter();
        chunks
            .flat_map(|chunk| chunk.iter_slices::<f64>(scalars).flatten().copied().collect::<Vec<_>>())
            .collect()
    }

    /// The places of what moves.
    fn places_m(&self, entity: &str) -> Vec<[f32; 3]> {
        let translations = "Transform3D:translation".into();
        let chunks = self.recording[entity].iter();
        chunks
            .flat_map(|chunk| {
                chunk.iter_slices::<[f32; 3]>(translations).flatten().copied().collect::<Vec<_>>()
            })
            .collect()
    }
}

fn written(scene: &Scene) -> Content {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.rrd");
    write(scene, &path).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no part is left");
    read(&path)
}

fn scene<'a>(runs: &'a [Run], measured: &'a [Run]) -> Scene<'a> {
    Scene { title: "Roll-out", runs, measured, forces: &FORCES, vehicle: BODY, ground: None, settings: &[] }
}

#[test]
fn a_run_has_a_vehicle_arrows_and_lines_on_one_timeline_in_seconds() {
    let content = written(&scene(&[run("r1", Origin::Predicted)], &[]));
    let times = content.times_s("/world/runs/r1/modelled/vehicle");
    assert!(times.len() > 1000 && times.len() <= 2000, "{}", times.len());
    assert_eq!((times[0], times[times.len() - 1]), (0.0, 499.9));
    assert_eq!(content.times_s("/world/runs/r1/modelled/vehicle/wheels/front_left").len(), times.len());
    assert!(
        content.times_s("/world/runs/r1/modelled/vehicle/body").is_empty(),
        "the mesh is there at any time"
    );
    let arrows = content.times_s("/world/runs/r1/modelled/vehicle/forces/drag_force_n");
    assert!(arrows.contains(&333.3), "the arrow of the spike is drawn");
    assert!(content.recording.contains_key("/world/ground/r1"));
}

#[test]
fn a_line_keeps_its_spike_and_leaves_out_what_is_no_number() {
    let content = written(&scene(&[run("r1", Origin::Predicted)], &[]));
    let line = content.line("/channels/r1/drag_force_n/modelled");
    assert!(line.len() <= 2000 && line.contains(&6500.0) && line.iter().all(|value| value.is_finite()));
}

#[test]
fn a_recording_brings_a_second_vehicle_second_lines_and_a_residual() {
    let mut recording = run("r1", Origin::Measured);
    let faster =
        recording.trace.remove("speed_m_s").unwrap().values.iter().map(|speed| speed + 0.25).collect();
    recording.trace.push("speed_m_s", faster, Origin::Measured).unwrap();
    let content = written(&scene(&[run("r1", Origin::Predicted)], &[recording]));
    assert!(!content.times_s("/world/runs/r1/measured/vehicle").is_empty());
    assert!(content.line("/channels/r1/speed_m_s/measured").iter().all(|speed| *speed == 2.25));
    assert!(content.line("/channels/r1/speed_m_s/modelled").iter().all(|speed| *speed == 2.0));
    let residual = content.line("/channels/r1/speed_m_s/residual");
    assert!(!residual.is_empty() && residual.iter().all(|residual| *residual == 0.25));
}

#[test]
fn a_channel_that_the_model_was_given_is_drawn_once() {
    let content = written(&scene(&[run("r1", Origin::Driven)], &[run("r1", Origin::Measured)]));
    assert!(content.recording.contains_key("/channels/r1/speed_m_s/modelled"));
    assert!(!content.recording.contains_key("/channels/r1/speed_m_s/measured"));
    assert!(!content.recording.contains_key("/channels/r1/speed_m_s/residual"));
}

#[test]
fn several_runs_have_a_vehicle_and_a_tab_each() {
    let one = written(&scene(&[run("r1", Origin::Predicted)], &[]));
    let runs = [run("r1", Origin::Predicted), run("a/b", Origin::Predicted)];
    let two = written(&scene(&runs, &[]));
    for entity in ["/world/runs/r1/modelled/vehicle", r"/world/runs/a\/b/modelled/vehicle"] {
        assert_eq!(two.times_s(entity).len(), one.times_s("/world/runs/r1/modelled/vehicle").len());
    }
    let views =
        |content: &Content| content.layout.keys().filter(|entity| entity.ends_with("/ViewContents")).count();
    // Vehicle, text, energy flow, speed, force, length; with two runs the speeds of both, and four plots more.
    assert_eq!((views(&one), views(&two)), (6, 11));
    for id in ["r1", r"a\/b"] {
        assert!(!two.line(&format!("/flow/{id}/drag")).is_empty());
    }
}

#[test]
fn the_layout_is_put_into_force_once_and_the_eye_follows_the_first_vehicle() {
    let content = written(&scene(&[run("r1", Origin::Predicted)], &[]));
    assert_eq!(content.activated, 1);
    assert!(content.layout.contains_key("/viewport") && content.layout.contains_key("/time_panel"));
    assert!(content.layout.keys().any(|entity| entity.ends_with("/EyeControls3D")));
    assert!(content.recording.contains_key("/world/runs/r1/modelled/vehicle/reach"));
}

/// Rises by 1 in 20 to the north.
#[derive(Debug)]
struct Hill;

impl Relief for Hill {
    fn height_m(&self, _: f64, north_m: f64) -> Option<f64> {
        Some(0.05 * north_m)
    }
}

const WHEELS: [(&str, f64, f64); 4] = [
    ("axle_1_left", 1.6, 1.1),
    ("axle_1_right", 1.6, -1.1),
    ("axle_2_left", -1.7, 1.1),
    ("axle_2_right", -1.7, -1.1),
];

fn rig() -> Rig {
    let wheel = |(name, ahead, left): (&str, f64, f64)| RigWheel {
        name: name.to_owned(),
        hub_m: [ahead, left, 0.9],
        radius_m: 0.95,
        width_m: 0.7,
        squeezed_m: 0.0,
    };
    Rig { centre_height_m: 1.2, wheels: WHEELS.map(wheel).into() }
}

/// Drives north up the hill for 20 s at 2 m/s, its wheels 40 mm deep, the front ones turned.
fn rigid(id: &str) -> Run {
    let times: Vec<f64> = (0..401).map(|index| f64::from(index) * 0.05).collect();
    let north: Vec<f64> = times.iter().map(|time| 2.0 * time).collect();
    let mut trace = Trace::new(times).unwrap();
    let mut push = |name: &str, values: Vec<f64>| trace.push(name, values, Origin::Predicted).unwrap();
    push("elevation_m", north.iter().map(|north| 0.05 * north).collect());
    push("height_m", north.iter().map(|north| 0.05 * north + 1.16).collect());
    push("north_m", north);
    let constant = |value: f64| vec![value; 401];
    push("east_m", constant(3.0));
    push("speed_m_s", constant(2.0));
    push("heading_rad", constant(0.0));
    push("pitch_rad", constant(0.05f64.atan()));
    push("roll_rad", constant(0.0));
    for (name, ahead, _) in WHEELS {
        let values = [
            ("load_n", 3e4),
            ("traction_n", 4e3),
            ("resistance_n", 1e3),
            ("side_force_n", 500.0),
            ("sinkage_m", 0.04),
            ("deflection_m", 0.05),
            ("steer_rad", if ahead > 0.0 { 0.1 } else { 0.0 }),
            ("slip", 0.1),
        ];
        for (what, value) in values {
            push(&format!("{name}_{what}"), constant(value));
        }
    }
    Run { id: id.to_owned(), trace }
}

fn settings(runs: &[Run]) -> Vec<Setting<'_>> {
    runs.iter()
        .map(|run| Setting {
            run: &run.id,
            rig: Some(rig()),
            trailer: None,
            implements: Vec::new(),
            relief: Some(&Hill),
        })
        .collect()
}

#[test]
fn a_rigid_body_has_its_wheels_their_forces_its_balance_and_the_ground_around_it() {
    let runs = [rigid("r1")];
    let settings = settings(&runs);
    let content = written(&Scene { forces: &[], settings: &settings, ..scene(&runs, &[]) });
    let base = "/world/runs/r1/modelled";
    for (wheel, _, _) in WHEELS {
        assert_eq!(content.times_s(&format!("{base}/vehicle/wheels/{wheel}")).len(), 401);
        assert_eq!(content.times_s(&format!("{base}/vehicle/wheel_forces/{wheel}")).len(), 401);
        assert!(content.recording.contains_key(&format!("/channels/r1/{wheel}_load_n/modelled")));
    }
    assert!(
        !content.recording.contains_key(&format!("{base}/vehicle/wheels/front_left")),
        "no second wheels"
    );
    for what in ["vehicle/velocity", "centre_of_gravity", "centre_of_gravity/bar", "plumb_line"] {
        assert_eq!(content.times_s(&format!("{base}/{what}")).len(), 401, "{what}");
    }
    assert!(content.recording.contains_key("/world/ground/r1/surface"));
    assert!(content.recording.contains_key("/world/ground/r1/distance"));
}

/// They begin with nothing, grow with the vehicle, and no piece is there before the vehicle has come to it.
#[test]
fn ruts_grow_behind_the_vehicle() {
    let runs = [rigid("r1")];
    let settings = settings(&runs);
    let content = written(&Scene { forces: &[], settings: &settings, ..scene(&runs, &[]) });
    let pieces: Vec<Vec<f64>> = content
        .recording
        .keys()
        .filter(|entity| entity.starts_with("/world/runs/r1/modelled/ruts/"))
        .map(|entity| content.times_s(entity))
        .collect();
    assert!(pieces.len() > 20, "{}", pieces.len());
    let firsts: Vec<f64> = pieces.iter().map(|times| times[0]).collect();
    assert!(firsts[0] > 0.0 && firsts.windows(2).all(|pair| pair[0] < pair[1]), "{firsts:?}");
    assert!(pieces.iter().all(|times| times.len() > 1 && times[times.len() - 1] - times[0] < 1.0));
    assert!(pieces.last().unwrap().last().unwrap() - 20.0 < 1e-9);
}

#[test]
fn rigid_bodies_of_a_study_each_have_a_ground_of_their_own() {
    let runs = [rigid("r1"), rigid("r2")];
    let settings = settings(&runs);
    let content = written(&Scene { forces: &[], settings: &settings, ..scene(&runs, &[]) });
    for id in ["r1", "r2"] {
        assert!(content.recording.contains_key(&format!("/world/ground/{id}/surface")), "{id}");
        assert!(!content.times_s(&format!("/world/runs/{id}/modelled/ruts/00")).is_empty(), "{id}");
    }
}

#[test]
fn a_trailer_has_a_body_wheels_and_ruts_of_its_own() {
    let mut towing = rigid("r1");
    let rows = towing.trace.len();
    let behind: Vec<f64> = towing.trace.get("north_m").unwrap().iter().map(|north| north - 6.0).collect();
    let mut push = |name: &str, values: Vec<f64>| towing.trace.push(name, values, Origin::Predicted).unwrap();
    push("trailer_height_m", behind.iter().map(|north| 0.05 * north + 1.4).collect());
    push("trailer_north_m", behind);
    push("trailer_east_m", vec![3.0; rows]);
    for name in ["trailer_heading_rad", "trailer_roll_rad", "trailer_pitch_rad"] {
        push(name, vec![0.0; rows]);
    }
    push("trailer_axle_1_left_load_n", vec![2e4; rows]);
    let wheel = RigWheel { name: "trailer_axle_1_left".to_owned(), ..rig().wheels[0].clone() };
    let towed = Towed { rig: Rig { centre_height_m: 1.4, wheels: vec![wheel] }, coupling_m: [4.0, 0.7] };
    let runs = [towing];
    let settings =
        [Setting { run: "r1", rig: Some(rig()), trailer: Some(towed), implements: Vec::new(), relief: None }];
    let content = written(&Scene { forces: &[], settings: &settings, ..scene(&runs, &[]) });
    let base = "/world/runs/r1/modelled";
    for what in ["trailer", "trailer/wheels/trailer_axle_1_left", "trailer/wheel_forces/trailer_axle_1_left"]
    {
        assert_eq!(content.times_s(&format!("{base}/{what}")).len(), 401, "{what}");
    }
    assert!(content.recording.contains_key(&format!("{base}/trailer/body")));
    assert!(!content.times_s(&format!("{base}/trailer_ruts/00")).is_empty());
}

fn plough() -> Implement {
    Implement {
        name: "plough".to_owned(),
        hitch_m: [-3.0, 0.7],
        width_m: 3.0,
        depth_m: Some(0.25),
        tools: None,
        lift_m: Some(0.8),
    }
}

/// A run as above that ploughs from 5 s to 15 s.
fn ploughing(id: &str) -> Run {
    let mut run = rigid(id);
    let lifted = |time: &f64| if (5.0..15.0).contains(time) { 0.0 } else { 1.0 };
    let lifted = run.trace.time_s().iter().map(lifted).collect();
    run.trace.push("plough_lifted", lifted, Origin::Predicted).unwrap();
    run
}

/// The wheels say that the ground lies 0.9 − (0.95 − 0.05 − 0.04) = 0.04 m up in the frame of the vehicle.
#[test]
fn an_implement_is_down_on_the_ground_where_it_works_and_up_where_it_is_lifted() {
    let runs = [ploughing("r1")];
    let mut settings = settings(&runs);
    settings[0].implements.push(plough());
    let content = written(&Scene { forces: &[], settings: &settings, ..scene(&runs, &[]) });
    let at = "/world/runs/r1/modelled/vehicle/implements/plough";
    let (times, places) = (content.times_s(&format!("{at}/frame")), content.places_m(&format!("{at}/frame")));
    assert_eq!((times.len(), places.len()), (401, 401));
    for (time, place) in times.iter().zip(&places) {
        let height_m = if (5.0..15.0).contains(time) { 0.04 } else { 0.8 };
        let off = [place[0] + 3.0, place[1], place[2] - height_m];
        assert!(off.iter().all(|off| off.abs() < 1e-5), "{time} s: {place:?}");
    }
    assert_eq!(content.times_s(&format!("{at}/links")).len(), 401);
}

#[test]
fn without_an_implement_none_is_drawn_and_one_that_the_trace_does_not_know_is_not_either() {
    let runs = [ploughing("r1"), rigid("r2")];
    let mut settings = settings(&runs);
    settings[1].implements.push(plough());
    let content = written(&Scene { forces: &[], settings: &settings, ..scene(&runs, &[]) });
    assert!(content.recording.keys().all(|entity| !entity.contains("implements")));
}

#[test]
fn an_implement_of_no_width_is_refused() {
    let runs = [ploughing("r1")];
    for (width_m, lift_m, named) in [(0.0, 0.8, "width_m"), (3.0, f64::NAN, "lift_m")] {
        let mut settings = settings(&runs);
        settings[0].implements.push(Implement { width_m, lift_m: Some(lift_m), ..plough() });
        let folder = tempfile::tempdir().unwrap();
        let scene = Scene { forces: &[], settings: &settings, ..scene(&runs, &[]) };
        let error = write(&scene, &folder.path().join("run.rrd")).unwrap_err();
        assert!(matches!(error, ViewError::Body { name, .. } if name == named), "{error}");
    }
}

#[test]
fn a_rig_without_wheels_is_refused() {
    let runs = [rigid("r1")];
    let rig = Some(Rig { wheels: Vec::new(), ..rig() });
    let bare = [Setting { run: "r1", rig, trailer: None, implements: Vec::new(), relief: None }];
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene { forces: &[], settings: &bare, ..scene(&runs, &[]) };
    let error = write(&scene, &folder.path().join("run.rrd")).unwrap_err();
    assert!(matches!(error, ViewError::Body { name: "number of wheels", .. }), "{error}");
}

#[test]
fn a_path_that_cannot_be_written_is_refused_by_name_and_leaves_nothing() {
    let runs = [run("r1", Origin::Predicted)];
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing").join("run.rrd");
    let error = write(&scene(&runs, &[]), &missing).unwrap_err();
    assert!(matches!(&error, ViewError::File { path, .. } if *path == missing), "{error}");
    let taken = folder.path().join("run.rrd");
    fs::create_dir(&taken).unwrap();
    assert!(matches!(write(&scene(&runs, &[]), &taken), Err(ViewError::File { .. })));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "only the folder is left");
}
