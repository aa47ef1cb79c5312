//! The description of a recording with what was found of its sensors, readable from any folder.

use crate::failure::Failure;
use headland_scenario::{Document, Node, Shape};
use std::path::Path;

/// What a sensor is to be corrected by: channel, latency [s], scale, bias.
pub type Correction = (String, f64, f64, f64);

/// The text of the description at `path` with these corrections.
pub fn description(path: &Path, corrections: &[Correction]) -> Result<String, Failure> {
    let mut text = std::fs::read_to_string(path)
        .map_err(|error| Failure::Input(format!("cannot read {}: {error}", path.display())))?;
    for correction in corrections {
        text = corrected(&text, correction)?;
    }
    with_folder(&text, path)
}

fn parsed(text: &str) -> Result<Document, Failure> {
    Ok(Document::of_text("recording.ron", text, Path::new(""))?)
}

fn corrected(text: &str, (channel, latency_s, scale, bias): &Correction) -> Result<String, Failure> {
    let document = parsed(text)?;
    let channels = match document.find("channels") {
        Some(Node { shape: Shape::List(values), span }) => Some((values.clone(), span.clone())),
        _ => None,
    };
    // Quantities in the text were resolved; only spans of the text itself may be edited.
    if document.text() != text {
        return Err(Failure::Input(format!(
            "the description holds quantities or includes, so `{channel}` has to be corrected by hand: \
             latency_s: {latency_s}, scale: {scale}, bias: {bias}"
        )));
    }
    let sensor = format!("sensor: (latency_s: {latency_s:?}, scale: {scale:?}, bias: {bias:?})");
    let is = |node: &&Node| {
        node.field("is")
            .is_some_and(|field| matches!(&field.value.shape, Shape::Text(name) if name == channel))
    };
    let described = channels.as_ref().and_then(|(values, _)| values.iter().find(is));
    let known = described.and_then(|node| node.field("sensor"));
    let (at, end, piece) = if let Some(field) = known {
        let noise = field
            .value
            .field("noise")
            .map_or(String::new(), |noise| format!("noise: {}, ", &text[noise.value.span.clone()]));
        (field.key_span.start, field.value.span.end, sensor.replacen('(', &format!("({noise}"), 1))
    } else if let Some(node) = described {
        (node.span.end - 1, node.span.end - 1, format!(", {sensor}"))
    } else if let Some((_, span)) = &channels {
        let open = span.start + 1;
        (open, open, format!("(column: \"{channel}\", is: \"{channel}\", {sensor}),"))
    } else {
        let end = match &document.tree().shape {
            Shape::Struct { fields, .. } => fields.last().map_or(1, |field| field.value.span.end),
            _ => 1,
        };
        (end, end, format!(",\n    channels: [(column: \"{channel}\", is: \"{channel}\", {sensor})]"))
    };
    Ok(format!("{}{piece}{}", &text[..at], &text[end..]))
}

/// Names the folder in which the logs lie.
fn with_folder(text: &str, path: &Path) -> Result<String, Failure> {
    let document = parsed(text)?;
    let beside = path.parent().unwrap_or(Path::new("."));
    let beside = if beside.as_os_str().is_empty() { Path::new(".") } else { beside };
    let beside = beside
        .canonicalize()
        .map_err(|error| Failure::Input(format!("cannot find the folder {}: {error}", beside.display())))?;
    let Some(node) = document.tree().field("folder").map(|field| &field.value) else {
        let open = text.find('(').map_or(0, |at| at + 1);
        let folder = beside.display().to_string();
        return Ok(format!("{}\n    folder: {folder:?},{}", &text[..open], &text[open..]));
    };
    let Shape::Text(folder) = &node.shape else { return Ok(text.to_owned()) };
    if Path::new(folder).is_absolute() {
        return Ok(text.to_owned());
    }
    // A variable stands at the beginning; what is relative is its default.
    let placed = match folder.split_once(":-") {
        Some((variable, rest)) if folder.starts_with("${") => {
            format!("{variable}:-{}/{rest}", beside.display())
        }
        _ => beside.join(folder).display().to_string(),
    };
    Ok(text.replacen(&format!("{folder:?}"), &format!("{placed:?}"), 1))
}
