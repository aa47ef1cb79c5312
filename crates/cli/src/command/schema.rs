//! `headland schema`: what files look like, for editors and other programs.

use crate::arguments::SchemaOptions;
use crate::failure::Failure;
use crate::say::Say;
use crate::schema;
use headland_plugin::Registry;

/// Runs the command.
pub fn run(registry: &Registry, options: &SchemaOptions, say: Say) -> Result<(), Failure> {
    let document =
        if options.snippets { schema::snippets(registry) } else { schema::schema_of(registry, options.kind) };
    let text = serde_json::to_string_pretty(&document)
        .map_err(|error| Failure::Machine(format!("cannot write JSON: {error}")))?;
    say.result(&text, &document)
}
