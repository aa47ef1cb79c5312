//! Bytes to text, as they stream: decompression and decoding.

use encoding_rs::{Decoder, DecoderResult, Encoding, UTF_8, WINDOWS_1252};
use std::fmt;
use std::io::{self, Read};

/// Bytes decoded at a time.
const CHUNK: usize = 1 << 16;

/// A byte that an encoding does not have.
#[derive(Debug)]
pub(crate) struct BadByte {
    /// Line from 1.
    pub line: usize,
    /// The encoding's name.
    pub encoding: &'static str,
}

impl fmt::Display for BadByte {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {} holds a byte that is no {}", self.line, self.encoding)
    }
}

impl std::error::Error for BadByte {}

/// The encoding that bytes at the start of a file show: a byte order mark, UTF-8 where they are, else Windows-1252.
pub(crate) fn guess(start: &[u8]) -> &'static Encoding {
    if let Some((encoding, _)) = Encoding::for_bom(start) {
        return encoding;
    }
    match std::str::from_utf8(start) {
        Ok(_) => UTF_8,
        // A character cut off by the end of what was looked at is no fault.
        Err(error) if error.error_len().is_none() => UTF_8,
        Err(_) => WINDOWS_1252,
    }
}

/// A reader of UTF-8 from a reader of another encoding.
pub(crate) struct Utf8<R> {
    inner: R,
    decoder: Decoder,
    encoding: &'static Encoding,
    raw: Vec<u8>,
    text: String,
    given: usize,
    line: usize,
    ended: bool,
}

impl<R: Read> Utf8<R> {
    pub fn new(inner: R, encoding: &'static Encoding) -> Self {
        Self {
            inner,
            decoder: encoding.new_decoder_with_bom_removal(),
            encoding,
            raw: Vec::new(),
            text: String::with_capacity(4 * CHUNK),
            given: 0,
            line: 1,
            ended: false,
        }
    }

    fn fill(&mut self) -> io::Result<()> {
        self.text.clear();
        self.given = 0;
        while self.text.is_empty() && !self.ended {
            let mut chunk = vec![0; CHUNK];
            let count = self.inner.read(&mut chunk)?;
            self.raw.extend_from_slice(&chunk[..count]);
            let last = count == 0;
            let (result, read) =
                self.decoder.decode_to_string_without_replacement(&self.raw, &mut self.text, last);
            self.raw.drain(..read);
            self.line += self.text.matches('\n').count();
            match result {
                DecoderResult::Malformed(..) => {
                    let bad = BadByte { line: self.line, encoding: self.encoding.name() };
                    return Err(io::Error::new(io::ErrorKind::InvalidData, bad));
                }
                DecoderResult::InputEmpty => self.ended = last,
                DecoderResult::OutputFull => {}
            }
        }
        Ok(())
    }
}

impl<R: Read> Read for Utf8<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        if self.given == self.text.len() {
            self.fill()?;
        }
        let rest = &self.text.as_bytes()[self.given..];
        let count = rest.len().min(out.len());
        out[..count].copy_from_slice(&rest[..count]);
        self.given += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8], encoding: &'static Encoding) -> io::Result<String> {
        let mut text = String::new();
        Utf8::new(bytes, encoding).read_to_string(&mut text)?;
        Ok(text)
    }

    #[test]
    fn each_encoding_gives_the_same_text() {
        let utf16: Vec<u8> = "\u{feff}T [°C]\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        for bytes in [b"T [\xb0C]\n".to_vec(), "T [°C]\n".into(), "\u{feff}T [°C]\n".into(), utf16] {
            assert_eq!(read(&bytes, guess(&bytes)).unwrap(), "T [°C]\n");
        }
    }

    #[test]
    fn a_bad_byte_is_told_with_its_line() {
        let error = read(b"a\nb\nc\xff\n", UTF_8).unwrap_err();
        let bad = error.get_ref().and_then(|inner| inner.downcast_ref::<BadByte>()).unwrap();
        assert_eq!(bad.line, 3);
    }

    #[test]
    fn text_longer_than_a_chunk_is_whole() {
        let long = "ä1;2\n".repeat(50_000);
        assert_eq!(read(long.as_bytes(), UTF_8).unwrap(), long);
    }
}
