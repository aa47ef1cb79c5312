//! What is wrong with an expression, and where.

use super::names::{FUNCTIONS, VARIABLES, WAY};
use super::parser::Constant;
use headland_plugin::{Refusal, closest};
use std::ops::Range;

/// What was found and what was expected.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    found: String,
    expected: String,
}

impl Fault {
    /// A fault in some bytes of the text; `told` follows the quotation, `expected` ends 'expected ...'.
    pub(super) fn at(text: &str, span: Range<usize>, told: &str, expected: &str) -> Self {
        let character = text[..span.start].chars().count() + 1;
        let piece = if span.is_empty() {
            "the end of the text".to_owned()
        } else {
            format!("`{}`", Self::quote(text, span))
        };
        Self { found: format!("{piece} at character {character}{told}"), expected: expected.to_owned() }
    }

    /// A name that stands for nothing.
    pub(super) fn unknown(text: &str, span: Range<usize>, constants: &[Constant]) -> Self {
        let mut known: Vec<&str> = VARIABLES.iter().map(|variable| variable.name).collect();
        known.push(WAY);
        known.extend(FUNCTIONS.iter().map(|function| function.name));
        known.extend(constants.iter().map(|constant| constant.name.as_str()));
        let suggestion = closest(&text[span.clone()], &known)
            .map_or_else(String::new, |name| format!("; is `{name}` meant?"));
        let expected = format!("a constant of `constants` or one of {}{suggestion}", known.join(" "));
        Self::at(text, span, "", &expected)
    }

    /// A piece of the text, shortened where it is long.
    pub(super) fn quote(text: &str, span: Range<usize>) -> String {
        const LONGEST: usize = 40;
        let piece = &text[span];
        match piece.char_indices().nth(LONGEST) {
            Some((end, _)) => format!("{}…", &piece[..end]),
            None => piece.to_owned(),
        }
    }

    /// As the refusal of the parameter whose value is `text`.
    pub(super) fn refusal(self, parameter: &str, text: &str) -> Refusal {
        let found = format!("\"{}\" with {}", Self::quote(text, 0..text.len()), self.found);
        Refusal { parameter: parameter.to_owned(), found, expected: self.expected }
    }
}
