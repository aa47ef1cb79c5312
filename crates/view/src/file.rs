//! A scene as an `.rrd` file.

use crate::entity::{self, Who};
use crate::lanes::{Lane, lanes};
use crate::recorder::{Recorder, encode};
use crate::summary::Scales;
use crate::{
    Scene, ViewError, balance, blueprint, flow, forces, groups, implement, plots, ruts, summary,
    surroundings, trailer, vehicle, wheels,
};
use rerun::external::re_build_info::CrateVersion;
use rerun::external::re_log_encoding::Encoder;
use rerun::external::re_log_encoding::rrd::EncodingOptions;
use rerun::log::LogMsg;
use rerun::{ApplicationId, RecordingStreamBuilder, TextDocument};
use std::fs;
use std::path::Path;

/// Writes the scene to a file, which appears whole or not at all.
///
/// # Errors
/// [`ViewError`]: a scene that cannot be drawn, [`ViewError::File`] where the file system refuses.
pub fn write(scene: &Scene, path: &Path) -> Result<(), ViewError> {
    store(messages(scene)?, path)
}

/// Writes messages to a file, which appears whole or not at all.
pub(crate) fn store(messages: Vec<LogMsg>, path: &Path) -> Result<(), ViewError> {
    let mut bytes = Vec::new();
    let stored = messages.into_iter().map(Ok::<LogMsg, _>);
    Encoder::encode_into(CrateVersion::LOCAL, EncodingOptions::PROTOBUF_COMPRESSED, stored, &mut bytes)
        .map_err(encode)?;
    let file_error = |source| ViewError::File { path: path.to_owned(), source };
    let part = path.with_extension("rrd.part");
    let stored = fs::write(&part, &bytes).and_then(|()| fs::rename(&part, path));
    if stored.is_err() {
        // What is left of a full disk or a path that is a folder helps nobody; that it may stay changes nothing.
        let _ = fs::remove_file(&part);
    }
    stored.map_err(file_error)
}

/// A recording of this title.
pub(crate) fn begun(title: &str) -> Result<(ApplicationId, Recorder), ViewError> {
    let title = if title.trim().is_empty() { "Headland" } else { title };
    // A name of other characters would get a number behind it.
    let plain = |letter: &char| letter.is_ascii_alphanumeric() || matches!(letter, ' ' | '-' | '_');
    let name: String = title.chars().filter(plain).collect();
    let name = if name.trim().is_empty() { "Headland" } else { name.trim() };
    let application = ApplicationId::try_new(name).map_err(encode)?;
    let to = Recorder::new(RecordingStreamBuilder::new(application.clone()).recording_name(title))?;
    Ok((application, to))
}

/// Everything that the file holds: the layout first, so that the viewer has it before the data.
pub(crate) fn messages(scene: &Scene) -> Result<Vec<LogMsg>, ViewError> {
    scene.check()?;
    let lanes = lanes(scene)?;
    let groups = groups::groups(scene);
    let (application, to) = begun(scene.title)?;
    let grounds = surroundings::draw(&to, scene, &lanes)?;
    let newton_per_m = forces::newton_per_m(scene);
    let scales = Scales {
        newton_per_m,
        wheels_newton_per_m: wheels::newton_per_m(scene),
        m_s_per_m: balance::m_s_per_m(scene.runs, &scene.vehicle),
        deepest_m: scene
            .runs
            .iter()
            .filter_map(|run| ruts::deepest_m(run, scene.rig(&run.id)?))
            .reduce(f64::max),
    };
    for (number, lane) in lanes.iter().enumerate() {
        // Of many vehicles the labels would hide one another.
        let labelled = number == 0;
        let Lane { run, path, measured, colour, pale, .. } = lane;
        let name = |who: Who| match (scene.runs.len(), measured.is_some()) {
            (1, false) => String::new(),
            (1, true) => who.name().to_owned(),
            (_, false) => run.id.clone(),
            (_, true) => format!("{} {}", run.id, who.name()),
        };
        let rig = scene.rig(&run.id);
        let named = name(Who::Modelled);
        vehicle::drive(&to, (run, rig), Who::Modelled, path, &scene.vehicle, (&named, *colour))?;
        if let Some(rig) = rig {
            ruts::draw(&to, run, path, rig, scales.deepest_m, "ruts")?;
            balance::draw(&to, run, path, rig, &scene.vehicle, (scales.m_s_per_m, labelled))?;
            let base = entity::vehicle(&run.id, Who::Modelled);
            if let Some(newton_per_m) = scales.wheels_newton_per_m {
                wheels::draw_forces(&to, &base, run, path, rig, newton_per_m)?;
            }
            for implement in scene.setting(&run.id).iter().flat_map(|setting| &setting.implements) {
                implement::draw(&to, &base, lane, rig, implement)?;
            }
        }
        if let Some(measured) = measured {
            vehicle::drive(
                &to,
                (run, None),
                Who::Measured,
                measured,
                &scene.vehicle,
                (&name(Who::Measured), *pale),
            )?;
        }
        if let Some(towed) = scene.setting(&run.id).and_then(|setting| setting.trailer.as_ref()) {
            trailer::draw(&to, lane, towed, &scales)?;
        }
        forces::draw(&to, scene, run, (newton_per_m, labelled))?;
        plots::draw(&to, scene, &groups, lane)?;
        flow::draw(&to, scene, &groups, lane)?;
        if scene.runs.len() > 1 {
            plots::beside(&to, lane)?;
        }
    }
    let text = TextDocument::from_markdown(summary::summary(scene, &scales, &grounds));
    to.fixed(&entity::summary(), &text)?;
    let mut messages = blueprint::messages((&application, &to), scene, &groups, &lanes)?;
    messages.extend(to.finish());
    Ok(messages)
}
