//! The scenario that a calibration leads to.

use crate::failure::Failure;
use headland_calibrate::fit::Fit;
use headland_calibrate::study::Study;
use headland_plugin::Registry;
use headland_recording::Recording;
use headland_scenario::{Document, Scenario};
use std::fmt::Write;
use std::path::Path;

/// The scenario with the fitted values, free of includes, that finds its files wherever it lies.
///
/// The priors stay what they were: another calibration starts from the same knowledge.
pub fn scenario(
    study: &Study,
    recording: &Recording,
    fit: &Fit,
    registry: &Registry,
) -> Result<String, Failure> {
    let scenario = study.scenario();
    let document = scenario.document();
    let mut changes: Vec<(String, String)> = study
        .paths()
        .iter()
        .zip(fit.values())
        .map(|(path, value)| (path.clone(), format!("{value:?}")))
        .collect();
    for known in &recording.known {
        if let Ok(path) = document.resolve(&known.name)
            && !changes.iter().any(|(taken, _)| *taken == path)
        {
            changes.push((path, format!("{:?}", known.value)));
        }
    }
    changes.push(("free".to_owned(), free(study)));
    let borrowed: Vec<(&str, String)> =
        changes.iter().map(|(path, value)| (path.as_str(), value.clone())).collect();
    let text = document.replaced(&borrowed)?.text().to_owned();
    let text = with_folder(scenario, &text, registry)?;
    let named = document.path().display();
    Ok(format!("// {named}, calibrated with {}.\n{}\n", recording.path.display(), text.trim_end()))
}

fn free(study: &Study) -> String {
    let mut text = "[\n".to_owned();
    for (parameter, path) in study.parameters.iter().zip(study.paths()) {
        let _ = write!(text, "        (name: \"{path}\", value: {:?}", parameter.value);
        if let Some(sd) = parameter.sd {
            let _ = write!(text, ", sd: {sd:?}");
        }
        let (low, high) = parameter.bounds;
        if low.is_finite() || high.is_finite() {
            let _ = write!(text, ", bounds: ({low:?}, {high:?})");
        }
        text.push_str("),\n");
    }
    text + "    ]"
}

/// Names the folder of the scenario in it, if it needs files from there.
pub fn with_folder(scenario: &Scenario, text: &str, registry: &Registry) -> Result<String, Failure> {
    let nowhere = Path::new("nowhere");
    let has_folder = scenario.document().find("folder").is_some();
    if !has_folder && Scenario::of_text("scenario.ron", text, nowhere, registry).is_ok() {
        return Ok(text.to_owned());
    }
    let mut folder = scenario.document().folder().to_owned();
    if let Some(node) = scenario.document().find("folder") {
        folder = folder.join(scenario.document().text()[node.span.clone()].trim_matches('"'));
    }
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
    let folder = folder
        .canonicalize()
        .map_err(|error| Failure::Input(format!("cannot find the folder {}: {error}", folder.display())))?;
    let line = format!("{:?}", folder.display().to_string());
    let document = Document::of_text("scenario.ron", text, nowhere)?;
    if has_folder {
        return Ok(document.replaced(&[("folder", line)])?.text().to_owned());
    }
    let begin = document.tree().span.start;
    let open = text[begin..].find('(').map_or(begin, |at| begin + at + 1);
    Ok(format!("{}\n    folder: {line},{}", &text[..open], &text[open..]))
}
