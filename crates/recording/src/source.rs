//! A log as a stream of text: opened, decompressed, decoded.

use crate::text::{BadByte, Utf8, guess};
use crate::{Place, RecordingError};
use encoding_rs::Encoding;
use flate2::read::MultiGzDecoder;
use std::fs::File;
use std::io::{self, BufReader, Chain, Cursor, Read};
use std::path::Path;

/// Bytes of text that are looked at before a log is read.
const LOOK: usize = 1 << 18;

/// A log that has been opened.
pub(crate) enum Source {
    /// Delimited text.
    Text(Box<Text>),
    /// A Parquet file, which its own reader opens.
    Parquet,
}

/// Delimited text and its beginning.
pub(crate) struct Text {
    /// The beginning, cut at the end of a line unless it is the whole.
    pub start: String,
    rest: Utf8<Body>,
    after: Vec<u8>,
    /// Name of the encoding.
    pub encoding: &'static str,
    /// Whether it was compressed.
    pub gzip: bool,
}

type Body = Chain<Cursor<Vec<u8>>, Box<dyn Read>>;

impl Text {
    /// The whole text as a stream, without its first `skip` lines.
    pub fn into_reader(self, skip: usize) -> impl Read {
        let from = (0..skip)
            .fold(0, |at, _| self.start[at..].find('\n').map_or(self.start.len(), |end| at + end + 1));
        Cursor::new(self.start.into_bytes().split_off(from)).chain(Cursor::new(self.after)).chain(self.rest)
    }
}

/// Opens a log. `at` is where the description names it.
pub(crate) fn open(
    path: &Path,
    at: &Place,
    encoding: Option<&str>,
    encoding_at: &Place,
) -> Result<Source, RecordingError> {
    let refused = |source| RecordingError::File { at: at.clone(), path: path.to_owned(), source };
    if path.is_dir() {
        return Err(RecordingError::Folder { at: at.clone(), path: path.to_owned() });
    }
    let mut file = File::open(path).map_err(refused)?;
    let mut head = [0; 4];
    let known = fill(&mut file, &mut head).map_err(refused)?;
    if known == 0 {
        return Err(RecordingError::Empty { at: Place::file(path), what: "the file is empty" });
    }
    if known == 4 && &head == b"PAR1" {
        return Ok(Source::Parquet);
    }
    let file = BufReader::new(Cursor::new(head[..known].to_vec()).chain(file));
    let gzip = head[..known].starts_with(&[0x1f, 0x8b]);
    let mut body: Box<dyn Read> = if gzip { Box::new(MultiGzDecoder::new(file)) } else { Box::new(file) };
    let mut bytes = vec![0; LOOK];
    let count = fill(&mut body, &mut bytes).map_err(|error| failed(path, 0, &error))?;
    bytes.truncate(count);
    let encoding = match encoding {
        Some(label) => named(label).ok_or_else(|| RecordingError::Value {
            at: encoding_at.clone(),
            field: "encoding".to_owned(),
            found: format!("`{label}`"),
            expected: "a name such as utf-8, windows-1252, latin-1, utf-16le".to_owned(),
        })?,
        None => guess(&bytes),
    };
    if bytes.contains(&0) && !encoding.name().starts_with("UTF-16") {
        let reason = "the file is binary, expected text, gzip of text, or Parquet".to_owned();
        return Err(RecordingError::Read { at: Place::file(path), reason });
    }
    let mut rest = Utf8::new(Cursor::new(bytes).chain(body), encoding);
    let mut start = vec![0; LOOK];
    let count = fill(&mut rest, &mut start).map_err(|error| failed(path, 0, &error))?;
    start.truncate(count);
    let whole = count < LOOK;
    let end =
        if whole { count } else { start.iter().rposition(|byte| *byte == b'\n').map_or(count, |at| at + 1) };
    let after = start.split_off(end);
    // The decoder gives UTF-8, and a line's end is no part of a character.
    let start = String::from_utf8_lossy(&start).into_owned();
    Ok(Source::Text(Box::new(Text { start, rest, after, encoding: encoding.name(), gzip })))
}

/// The encoding of a name, as the web spells it or with other dashes.
fn named(label: &str) -> Option<&'static Encoding> {
    let bare = label.replace(['-', '_', ' '], "");
    Encoding::for_label(label.as_bytes()).or_else(|| Encoding::for_label(bare.as_bytes()))
}

/// What stopped the reading of a log, as an error at a line.
pub(crate) fn failed(path: &Path, line: usize, error: &io::Error) -> RecordingError {
    match error.get_ref().and_then(|inner| inner.downcast_ref::<BadByte>()) {
        Some(bad) => RecordingError::Encoding { at: Place::new(path, bad.line, 0), encoding: bad.encoding },
        None => RecordingError::Read { at: Place::new(path, line, 0), reason: error.to_string() },
    }
}

/// Reads until the buffer is full or the stream ends.
fn fill(stream: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match stream.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(count) => filled += count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(filled)
}
