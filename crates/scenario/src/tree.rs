//! The shape of a RON text: what stands where. Values stay text; `ron` gives them their meaning afterwards.

use std::ops::Range;

/// A piece of RON.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Bytes of the text that it covers.
    pub span: Range<usize>,
    /// What it is.
    pub shape: Shape,
}

/// What a piece of RON is.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// `Name(field: value)` or `(field: value)`.
    Struct {
        /// Bytes of the name; `None` where it has none.
        name: Option<Range<usize>>,
        /// Its fields.
        fields: Vec<Field>,
    },
    /// `Name(value, value)` or `(value, value)`.
    Tuple {
        /// Bytes of the name; `None` where it has none.
        name: Option<Range<usize>>,
        /// Its values.
        values: Vec<Node>,
    },
    /// `[value, value]`.
    List(Vec<Node>),
    /// `{key: value}`.
    Map(Vec<(Node, Node)>),
    /// `"text"`.
    Text(String),
    /// A number, a character, `true`, or a bare name.
    Word,
}

/// A field of a struct.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name.
    pub key: String,
    /// Bytes of the name.
    pub key_span: Range<usize>,
    /// Its value.
    pub value: Node,
}

/// A text that is no RON, with the byte at which that shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Broken {
    /// Byte offset.
    pub at: usize,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: &'static str,
}

impl Node {
    /// The name of a struct, a tuple or a bare word.
    pub fn name<'a>(&self, text: &'a str) -> Option<&'a str> {
        match &self.shape {
            Shape::Struct { name: Some(name), .. } | Shape::Tuple { name: Some(name), .. } => {
                Some(&text[name.clone()])
            }
            Shape::Word => Some(&text[self.span.clone()]),
            _ => None,
        }
    }

    /// The field of this name.
    pub fn field(&self, key: &str) -> Option<&Field> {
        match &self.shape {
            Shape::Struct { fields, .. } => fields.iter().find(|field| field.key == key),
            _ => None,
        }
    }

    /// The piece at a dotted path: names of fields, indices of lists, or the name that an element of a list begins with.
    pub fn find(&self, text: &str, path: &str) -> Option<&Self> {
        if path.is_empty() {
            return Some(self);
        }
        let (head, rest) = path.split_once('.').unwrap_or((path, ""));
        let next = match &self.shape {
            Shape::Struct { .. } => &self.field(head)?.value,
            Shape::List(values) | Shape::Tuple { values, .. } => match head.parse::<usize>() {
                Ok(index) => values.get(index)?,
                Err(_) => values.iter().find(|value| value.name(text) == Some(head))?,
            },
            Shape::Map(entries) => {
                let named = |key: &Self| matches!(&key.shape, Shape::Text(key) if key == head);
                &entries.iter().find(|(key, _)| named(key))?.1
            }
            Shape::Text(_) | Shape::Word => return None,
        };
        next.find(text, rest)
    }
}

/// Finds out the shape of a text.
///
/// # Errors
/// [`Broken`] where brackets, commas or quotes do not match.
pub fn parse(text: &str) -> Result<Node, Broken> {
    let mut reader = Reader { text, at: 0, depth: 0 };
    reader.skip_blank()?;
    while reader.rest().starts_with("#!") {
        let Some(end) = reader.rest().find(']') else { return Err(reader.broken("`]` to end `#![`")) };
        reader.at += end + 1;
        reader.skip_blank()?;
    }
    let node = reader.value()?;
    reader.skip_blank()?;
    if reader.at < text.len() {
        return Err(reader.broken("the end of the file"));
    }
    Ok(node)
}

/// No scenario nests more deeply, and the stack has an end.
const DEEPEST: usize = 100;

struct Reader<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

impl<'a> Reader<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn broken(&self, expected: &'static str) -> Broken {
        let found = if self.peek().is_none() {
            "the end of the file".to_owned()
        } else {
            let word: String =
                self.rest().chars().take_while(|c| c.is_alphanumeric() || *c == '_').take(30).collect();
            let first = self.rest().chars().take(1).collect();
            format!("`{}`", if word.is_empty() { first } else { word })
        };
        Broken { at: self.at, found, expected }
    }

    fn skip_blank(&mut self) -> Result<(), Broken> {
        loop {
            let rest = self.rest();
            let trimmed = rest.trim_start();
            self.at += rest.len() - trimmed.len();
            if trimmed.starts_with("//") {
                self.at += trimmed.find('\n').unwrap_or(trimmed.len());
            } else if trimmed.starts_with("/*") {
                let mut depth = 0;
                loop {
                    if self.rest().starts_with("/*") {
                        depth += 1;
                        self.at += 2;
                    } else if self.rest().starts_with("*/") {
                        depth -= 1;
                        self.at += 2;
                        if depth == 0 {
                            break;
                        }
                    } else {
                        let Some(c) = self.peek() else { return Err(self.broken("`*/` to end the comment")) };
                        self.at += c.len_utf8();
                    }
                }
            } else {
                return Ok(());
            }
        }
    }

    fn value(&mut self) -> Result<Node, Broken> {
        if self.depth >= DEEPEST {
            return Err(self.broken("values nested less deeply"));
        }
        self.depth += 1;
        let node = self.value_inside();
        self.depth -= 1;
        node
    }

    fn value_inside(&mut self) -> Result<Node, Broken> {
        let start = self.at;
        let shape = match self.peek() {
            Some('(') => self.parenthesis(None)?,
            Some('[') => {
                self.at += 1;
                Shape::List(self.values(']')?)
            }
            Some('{') => {
                self.at += 1;
                Shape::Map(self.entries()?)
            }
            Some('"') => Shape::Text(self.quoted()?),
            Some('\'') => {
                self.character()?;
                Shape::Word
            }
            Some('r')
                if self.rest().starts_with("r\"")
                    || self.rest().starts_with("r#\"")
                    || self.rest().starts_with("r##") =>
            {
                Shape::Text(self.raw()?)
            }
            Some(c) if is_word(c) => {
                let word = self.word();
                let after_word = self.at;
                self.skip_blank()?;
                if self.peek() == Some('(') {
                    self.parenthesis(Some(word))?
                } else {
                    self.at = after_word;
                    Shape::Word
                }
            }
            _ => return Err(self.broken("a value")),
        };
        Ok(Node { span: start..self.at, shape })
    }

    fn word(&mut self) -> Range<usize> {
        let start = self.at;
        if self.rest().starts_with("r#") {
            self.at += 2;
        }
        let length = self.rest().find(|c| !is_word(c)).unwrap_or(self.rest().len());
        self.at += length;
        start..self.at
    }

    fn parenthesis(&mut self, name: Option<Range<usize>>) -> Result<Shape, Broken> {
        self.at += 1;
        self.skip_blank()?;
        let before = self.at;
        if self.peek().is_some_and(is_word) {
            self.word();
            self.skip_blank()?;
            let named = self.peek() == Some(':');
            self.at = before;
            if named {
                return Ok(Shape::Struct { name, fields: self.fields()? });
            }
        }
        let values = self.values(')')?;
        if values.is_empty() {
            return Ok(Shape::Struct { name, fields: Vec::new() });
        }
        Ok(Shape::Tuple { name, values })
    }

    fn fields(&mut self) -> Result<Vec<Field>, Broken> {
        let mut fields = Vec::new();
        loop {
            self.skip_blank()?;
            if self.peek() == Some(')') {
                self.at += 1;
                return Ok(fields);
            }
            if !self.peek().is_some_and(is_word) {
                return Err(self.broken("the name of a field, or `)`"));
            }
            let key_span = self.word();
            self.skip_blank()?;
            if self.peek() != Some(':') {
                return Err(self.broken("`:` after the name of a field"));
            }
            self.at += 1;
            self.skip_blank()?;
            let value = self.value()?;
            fields.push(Field {
                key: self.text[key_span.clone()].trim_start_matches("r#").to_owned(),
                key_span,
                value,
            });
            self.separator(')', "`,` or `)`")?;
        }
    }

    fn values(&mut self, close: char) -> Result<Vec<Node>, Broken> {
        let mut values = Vec::new();
        loop {
            self.skip_blank()?;
            if self.peek() == Some(close) {
                self.at += 1;
                return Ok(values);
            }
            values.push(self.value()?);
            self.separator(close, if close == ']' { "`,` or `]`" } else { "`,` or `)`" })?;
        }
    }

    fn entries(&mut self) -> Result<Vec<(Node, Node)>, Broken> {
        let mut entries = Vec::new();
        loop {
            self.skip_blank()?;
            if self.peek() == Some('}') {
                self.at += 1;
                return Ok(entries);
            }
            let key = self.value()?;
            self.skip_blank()?;
            if self.peek() != Some(':') {
                return Err(self.broken("`:` after a key"));
            }
            self.at += 1;
            self.skip_blank()?;
            entries.push((key, self.value()?));
            self.separator('}', "`,` or `}`")?;
        }
    }

    fn separator(&mut self, close: char, expected: &'static str) -> Result<(), Broken> {
        self.skip_blank()?;
        match self.peek() {
            Some(',') => self.at += 1,
            Some(c) if c == close => {}
            _ => return Err(self.broken(expected)),
        }
        Ok(())
    }

    fn quoted(&mut self) -> Result<String, Broken> {
        let start = self.at;
        let mut escaped = false;
        for (offset, c) in self.text[start + 1..].char_indices() {
            match c {
                _ if escaped => escaped = false,
                '\\' => escaped = true,
                '"' => {
                    self.at = start + 1 + offset + 1;
                    let literal = &self.text[start..self.at];
                    return ron::from_str(literal).map_err(|_| Broken {
                        at: start,
                        found: literal.to_owned(),
                        expected: "a text",
                    });
                }
                _ => {}
            }
        }
        Err(Broken { at: start, found: "a text that does not end".to_owned(), expected: "a closing `\"`" })
    }

    fn raw(&mut self) -> Result<String, Broken> {
        let start = self.at;
        let marks = self.rest()[1..].chars().take_while(|c| *c == '#').count();
        let open = start + 1 + marks + 1;
        let close = format!("\"{}", "#".repeat(marks));
        match self.text.get(open..).and_then(|body| body.find(&close)) {
            Some(length) => {
                self.at = open + length + close.len();
                Ok(self.text[open..open + length].to_owned())
            }
            None => Err(Broken {
                at: start,
                found: "a text that does not end".to_owned(),
                expected: "its closing quote",
            }),
        }
    }

    fn character(&mut self) -> Result<(), Broken> {
        let body = &self.rest()[1..];
        let skip = usize::from(body.starts_with('\\'));
        let end = body.char_indices().skip(skip + 1).find(|(_, c)| *c == '\'');
        let Some((end, _)) = end else { return Err(self.broken("a character and a closing `'`")) };
        self.at += end + 2;
        Ok(())
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '-' | '+' | '.' | '#')
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"( // a comment with ( brackets
        about: "a \"quoted\" text", /* nested /* twice */ */
        vehicle: Tractor(mass_kg: 13e3, axles: [(load: 1.0), Steered(angle: -0.1)]),
        effects: [wind(speed_m_s: 5.0), brake_drag(force_n: 100)],
        with: {"start.speed_m_s": "30 km/h"},
        nothing: (), pair: (1, 2), ends: r"\raw",
    )"#;

    fn at<'a>(path: &str) -> &'a str {
        &TEXT[parse(TEXT).unwrap().find(TEXT, path).unwrap().span.clone()]
    }

    #[test]
    fn paths_lead_to_fields_elements_and_named_elements() {
        assert_eq!(at("vehicle.mass_kg"), "13e3");
        assert_eq!(at("vehicle.axles.1.angle"), "-0.1");
        assert_eq!(at("effects.brake_drag.force_n"), "100");
        assert_eq!(at("pair.1"), "2");
        assert_eq!(parse(TEXT).unwrap().find(TEXT, "vehicle.weight"), None);
    }

    #[test]
    fn texts_are_read_with_their_escapes() {
        let tree = parse(TEXT).unwrap();
        assert_eq!(tree.field("about").unwrap().value.shape, Shape::Text("a \"quoted\" text".to_owned()));
        assert_eq!(tree.field("ends").unwrap().value.shape, Shape::Text("\\raw".to_owned()));
    }

    #[test]
    fn what_is_broken_is_found_where_it_is() {
        for (text, at, expected) in [
            ("(a: 1 b: 2)", 6, "`,` or `)`"),
            ("(a: [1, 2", 9, "`,` or `]`"),
            ("(a: \"open)", 4, "a closing `\""),
            ("(a: 1) x", 7, "the end of the file"),
            ("(a: )", 4, "a value"),
            ("", 0, "a value"),
        ] {
            let broken = parse(text).unwrap_err();
            assert_eq!(broken.at, at, "{text}");
            assert!(broken.expected.starts_with(expected), "{text}: {}", broken.expected);
        }
    }
}
