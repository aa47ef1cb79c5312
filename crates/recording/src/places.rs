//! Where each value of a RON text stands, so that a value that fits the schema and not the log can be pointed at.

/// Paths such as `channels[2].unit` with line and column, both from 1.
#[derive(Debug, Default)]
pub(crate) struct Places {
    found: Vec<(String, usize, usize)>,
}

impl Places {
    /// Reads a text that RON has accepted.
    pub fn of(source: &str) -> Self {
        let mut scan =
            Scan { text: source.chars().collect(), at: 0, line: 1, column: 1, places: Self::default() };
        scan.value("");
        scan.places
    }

    /// Line and column of a value, or of the nearest thing that holds it.
    pub fn find(&self, path: &str) -> (usize, usize) {
        let mut path = path;
        loop {
            if let Some((_, line, column)) = self.found.iter().find(|(known, ..)| known == path) {
                return (*line, *column);
            }
            match path.rfind(['.', '[']) {
                Some(end) => path = &path[..end],
                None => return (1, 1),
            }
        }
    }
}

struct Scan {
    text: Vec<char>,
    at: usize,
    line: usize,
    column: usize,
    places: Places,
}

impl Scan {
    fn peek(&self) -> Option<char> {
        self.text.get(self.at).copied()
    }

    fn next(&mut self) {
        if self.peek() == Some('\n') {
            self.line += 1;
            self.column = 0;
        }
        self.column += 1;
        self.at += 1;
    }

    fn starts(&self, what: &str) -> bool {
        what.chars().enumerate().all(|(index, c)| self.text.get(self.at + index) == Some(&c))
    }

    /// Passes over white space, comments and attributes.
    fn space(&mut self) {
        loop {
            if self.starts("//") || self.starts("#!") {
                while self.peek().is_some_and(|c| c != '\n') {
                    self.next();
                }
            } else if self.starts("/*") {
                while self.peek().is_some() && !self.starts("*/") {
                    self.next();
                }
                self.next();
                self.next();
            } else if self.peek().is_some_and(char::is_whitespace) {
                self.next();
            } else {
                return;
            }
        }
    }

    fn word(&mut self) -> String {
        let start = self.at;
        while self.peek().is_some_and(|c| c.is_alphanumeric() || matches!(c, '_' | '.' | '+' | '-' | '#')) {
            self.next();
        }
        self.text[start..self.at].iter().collect()
    }

    fn string(&mut self) {
        self.next();
        while let Some(c) = self.peek() {
            self.next();
            match c {
                '\\' => self.next(),
                '"' => return,
                _ => {}
            }
        }
    }

    fn value(&mut self, path: &str) {
        self.space();
        self.places.found.push((path.to_owned(), self.line, self.column));
        match self.peek() {
            Some('"') => self.string(),
            Some(open @ ('(' | '[' | '{')) => self.items(path, open),
            Some(_) => {
                let before = self.at;
                let _ = self.word();
                self.space();
                if self.peek() == Some('(') {
                    self.items(path, '(');
                } else if self.at == before {
                    self.next();
                }
            }
            None => {}
        }
    }

    fn items(&mut self, path: &str, open: char) {
        let close = match open {
            '(' => ')',
            '[' => ']',
            _ => '}',
        };
        self.next();
        let mut index = 0;
        loop {
            self.space();
            match self.peek() {
                None => return,
                Some(c) if c == close => {
                    self.next();
                    return;
                }
                Some(',') => self.next(),
                Some(_) => {
                    let start = (self.at, self.line, self.column);
                    let key = self.word();
                    self.space();
                    if !key.is_empty() && self.peek() == Some(':') {
                        self.next();
                        let inner = if path.is_empty() { key } else { format!("{path}.{key}") };
                        self.value(&inner);
                    } else {
                        (self.at, self.line, self.column) = start;
                        self.value(&format!("{path}[{index}]"));
                        index += 1;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_found_by_their_path() {
        let text = "// comment: (a: 1)\n(\n  about: \"x, (y: 2)\",\n  runs: [(id: \"a\"), (id: \"b\", \
                    segments: [(from_s: 1.0, to_s: 2.0)])],\n  format: csv(delimiter: \";\"), /* c: */ known: []\n)";
        let places = Places::of(text);
        assert_eq!(places.find("about"), (3, 10));
        assert_eq!(places.find("runs[1].id"), (4, 26));
        assert_eq!(places.find("runs[1].segments[0].to_s"), (4, 62));
        assert_eq!(places.find("format.delimiter"), (5, 26));
        assert_eq!(places.find("known"), (5, 48));
        assert_eq!(places.find("runs[0].missing"), places.find("runs[0]"));
    }
}
