//! The words of an expression.

use std::ops::Range;

/// What a word is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// A number.
    Number(f64),
    /// The name of a variable, a constant or a function.
    Name,
    /// An operator, a bracket or a comma.
    Sign,
    /// A character that means nothing here.
    Strange,
    /// Behind the last word.
    End,
}

/// A word and the bytes of the text that it covers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    pub kind: Kind,
    pub span: Range<usize>,
}

/// Signs, longest first where one begins another.
const SIGNS: [&str; 15] = ["<=", ">=", "==", "!=", "<", ">", "+", "-", "*", "/", "^", "(", ")", ",", "−"];

/// The word that begins at or behind a byte.
pub(super) fn next(text: &str, from: usize) -> Token {
    let rest = &text[from..];
    let start = from + rest.len() - rest.trim_start().len();
    let rest = &text[start..];
    let token = |kind: Kind, length: usize| Token { kind, span: start..start + length };
    let Some(first) = rest.chars().next() else { return token(Kind::End, 0) };
    if first.is_alphabetic() || first == '_' {
        let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        return token(Kind::Name, length);
    }
    if let Some(sign) = SIGNS.iter().find(|sign| rest.starts_with(**sign)) {
        return token(Kind::Sign, sign.len());
    }
    let length = number_length(rest);
    match rest[..length].parse() {
        Ok(value) => token(Kind::Number(value), length),
        Err(_) => token(Kind::Strange, first.len_utf8()),
    }
}

/// Length of `12`, `1.5`, `.5` or `3e-4` at the start of a text; 0 where there is none.
fn number_length(text: &str) -> usize {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let mut length = digits(0);
    if text[length..].starts_with('.') {
        let behind = digits(length + 1);
        if length + behind == 0 {
            return 0;
        }
        length += 1 + behind;
    }
    if length > 0 && text[length..].starts_with(['e', 'E']) {
        let sign = usize::from(text[length + 1..].starts_with(['+', '-']));
        let power = digits(length + 1 + sign);
        if power > 0 {
            length += 1 + sign + power;
        }
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<(&str, Kind)> {
        let (mut all, mut at) = (Vec::new(), 0);
        loop {
            let token = next(text, at);
            if token.kind == Kind::End {
                return all;
            }
            at = token.span.end;
            all.push((&text[token.span], token.kind));
        }
    }

    #[test]
    fn words_are_told_apart_without_blanks() {
        let found: Vec<&str> = words("2*v0_m_s<=.5e-1+max(ρ,3)").into_iter().map(|(word, _)| word).collect();
        assert_eq!(found, ["2", "*", "v0_m_s", "<=", ".5e-1", "+", "max", "(", "ρ", ",", "3", ")"]);
    }

    #[test]
    fn numbers_end_where_they_end() {
        assert_eq!(words("2e"), [("2", Kind::Number(2.0)), ("e", Kind::Name)]);
        assert_eq!(words("1.2.3"), [("1.2", Kind::Number(1.2)), (".3", Kind::Number(0.3))]);
        assert_eq!(words("7. $."), [("7.", Kind::Number(7.0)), ("$", Kind::Strange), (".", Kind::Strange)]);
    }
}
