//! Lines that end as lines do, whatever wrote them.
//!
//! Windows ends a line with CR LF, old machines with CR. A reader of cells that counts line feeds miscounts those: every line that
//! goes through here ends with one LF, the last one too.

use std::io::{self, Read};

/// Bytes that are asked for at once.
const AT_ONCE: usize = 1 << 16;

/// A stream whose lines all end with LF.
pub(crate) struct LineEnds<R> {
    inner: R,
    read: Vec<u8>,
    at: usize,
    after_return: bool,
    last: u8,
    ended: bool,
}

impl<R: Read> LineEnds<R> {
    pub fn new(inner: R) -> Self {
        Self { inner, read: Vec::new(), at: 0, after_return: false, last: b'\n', ended: false }
    }

    /// Reads on, and ends lines with LF.
    fn refill(&mut self) -> io::Result<()> {
        self.read.resize(AT_ONCE, 0);
        let count = self.inner.read(&mut self.read)?;
        self.read.truncate(count);
        self.at = 0;
        if count == 0 {
            self.ended = true;
            if self.last != b'\n' {
                self.read.push(b'\n');
            }
            return Ok(());
        }
        if self.after_return || self.read.contains(&b'\r') {
            let mut after_return = self.after_return;
            self.read.retain_mut(|byte| {
                let second = after_return && *byte == b'\n';
                after_return = *byte == b'\r';
                if after_return {
                    *byte = b'\n';
                }
                !second
            });
            self.after_return = after_return;
        }
        self.last = self.read.last().copied().unwrap_or(self.last);
        Ok(())
    }
}

impl<R: Read> Read for LineEnds<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.at == self.read.len() && !self.ended {
            self.refill()?;
        }
        let count = buffer.len().min(self.read.len() - self.at);
        buffer[..count].copy_from_slice(&self.read[self.at..self.at + count]);
        self.at += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives few bytes at once, so that CR and LF come apart.
    struct Slowly<'a>(&'a [u8], usize);

    impl Read for Slowly<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let count = self.1.min(self.0.len()).min(buffer.len());
            buffer[..count].copy_from_slice(&self.0[..count]);
            self.0 = &self.0[count..];
            Ok(count)
        }
    }

    #[test]
    fn every_line_ends_with_a_line_feed_however_it_is_read() {
        for (text, expected) in [
            ("a\r\nb\r\n", "a\nb\n"),
            ("a\rb", "a\nb\n"),
            ("a\nb\n", "a\nb\n"),
            ("a\r\n\r\nb", "a\n\nb\n"),
            ("\r", "\n"),
            ("", ""),
        ] {
            for at_once in 1..5 {
                let mut read = String::new();
                LineEnds::new(Slowly(text.as_bytes(), at_once)).read_to_string(&mut read).unwrap();
                assert_eq!(read, expected, "{text:?} by {at_once}");
            }
        }
    }
}
