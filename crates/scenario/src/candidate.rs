//! Effects that the author of a scenario suspects: none of them acts, a diagnosis tries them.

use crate::document::Document;
use crate::tree::{Node, Shape};

/// An effect that may have been left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Name of the effect.
    pub name: String,
    /// Its fields, as they are written.
    pub fields: Vec<CandidateField>,
}

/// A field of a candidate.
#[derive(Clone, Debug, PartialEq)]
pub struct CandidateField {
    /// Its name.
    pub name: String,
    /// Its value in RON.
    pub ron: String,
    /// What it says where it is a text.
    pub text: Option<String>,
    /// What it is where it is a number.
    pub number: Option<f64>,
}

/// The candidates of a document; that they can be built was checked.
pub fn candidates(document: &Document) -> Vec<Candidate> {
    let text = document.text();
    let Some(Node { shape: Shape::List(values), .. }) = document.find("candidates") else {
        return Vec::new();
    };
    let candidate = |node: &Node| {
        let name = node.name(text)?.to_owned();
        let Shape::Struct { fields, .. } = &node.shape else {
            return Some(Candidate { name, fields: Vec::new() });
        };
        let field = |field: &crate::tree::Field| {
            let ron = text[field.value.span.clone()].to_owned();
            CandidateField {
                name: field.key.clone(),
                text: if let Shape::Text(text) = &field.value.shape { Some(text.clone()) } else { None },
                number: ron.replace('_', "").parse().ok(),
                ron,
            }
        };
        Some(Candidate { name, fields: fields.iter().map(field).collect() })
    };
    values.iter().filter_map(candidate).collect()
}
