//! Frames of the journal as bytes. Numbers are little-endian; reals keep every bit.

use crate::journal::Identity;
use crate::row::{Row, Status};
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// What a frame holds.
pub enum Frame {
    /// What the batch is, and how many runs it has.
    Header {
        /// Named parts and their hashes.
        identity: Identity,
        /// Runs.
        runs: u64,
    },
    /// A name of a value; they are numbered as they come.
    Name(String),
    /// A run.
    Row(Stored),
}

/// A row whose values are called by the numbers of their names.
pub struct Stored {
    /// Number of the run.
    pub number: u64,
    status: Status,
    error: String,
    values: Vec<(u32, f64)>,
}

impl Stored {
    /// The row with the names of its values.
    pub fn named(self, names: &[String]) -> Row {
        let name = |index: u32| usize::try_from(index).ok().and_then(|index| names.get(index)).cloned();
        Row {
            number: self.number,
            status: self.status,
            error: self.error,
            values: self.values.iter().filter_map(|(index, value)| Some((name(*index)?, *value))).collect(),
        }
    }
}

/// Begins the payload of a header; tells a journal from any other file.
const MAGIC: &[u8; 8] = b"HEADLAND";
/// Version of the format.
const VERSION: u32 = 1;
const LENGTH_AND_SUM: usize = 8;
/// No record is longer; a length beyond is no length.
const LONGEST: u32 = 1 << 24;

const HEADER: u8 = 0;
const NAME: u8 = 1;
const ROW: u8 = 2;

fn frame(into: &mut Vec<u8>, payload: &[u8]) {
    let length = u32::try_from(payload.len()).unwrap_or(u32::MAX);
    into.extend_from_slice(&length.to_le_bytes());
    into.extend_from_slice(&crc32fast::hash(payload).to_le_bytes());
    into.extend_from_slice(payload);
}

fn text(into: &mut Vec<u8>, text: &str) {
    into.extend_from_slice(&u32::try_from(text.len()).unwrap_or(0).to_le_bytes());
    into.extend_from_slice(text.as_bytes());
}

/// The frame of a header.
pub fn header(identity: &Identity, runs: u64) -> Vec<u8> {
    let mut payload = vec![HEADER];
    payload.extend_from_slice(MAGIC);
    payload.extend_from_slice(&VERSION.to_le_bytes());
    payload.extend_from_slice(&runs.to_le_bytes());
    for (name, hash) in identity {
        text(&mut payload, name);
        payload.extend_from_slice(&hash.to_le_bytes());
    }
    let mut bytes = Vec::new();
    frame(&mut bytes, &payload);
    bytes
}

/// Adds the frame of a name.
pub fn name(into: &mut Vec<u8>, name: &str) {
    let mut payload = vec![NAME];
    text(&mut payload, name);
    frame(into, &payload);
}

/// Adds the frame of a row whose names are known.
pub fn row(into: &mut Vec<u8>, row: &Row, names: &[String]) {
    let mut payload = vec![ROW];
    payload.extend_from_slice(&row.number.to_le_bytes());
    let status = Status::ALL.iter().position(|status| *status == row.status).unwrap_or(0);
    payload.push(u8::try_from(status).unwrap_or(0));
    text(&mut payload, &row.error);
    for (name, value) in &row.values {
        let index = names.iter().position(|other| other == name).and_then(|index| u32::try_from(index).ok());
        if let Some(index) = index {
            payload.extend_from_slice(&index.to_le_bytes());
            payload.extend_from_slice(&value.to_bits().to_le_bytes());
        }
    }
    frame(into, &payload);
}

/// The next frame and its size; `None` where the journal ends or is torn. `left` bytes are left in the file.
pub fn read(from: &mut impl Read, left: u64) -> io::Result<Option<(Frame, u64)>> {
    if left < LENGTH_AND_SUM as u64 {
        return Ok(None);
    }
    let mut head = [0; LENGTH_AND_SUM];
    from.read_exact(&mut head)?;
    let [l0, l1, l2, l3, c0, c1, c2, c3] = head;
    let (length, sum) = (u32::from_le_bytes([l0, l1, l2, l3]), u32::from_le_bytes([c0, c1, c2, c3]));
    let size = u64::from(length) + LENGTH_AND_SUM as u64;
    if length == 0 || length > LONGEST || size > left {
        return Ok(None);
    }
    let mut payload = vec![0; usize::try_from(length).unwrap_or(0)];
    from.read_exact(&mut payload)?;
    if crc32fast::hash(&payload) != sum {
        return Ok(None);
    }
    Ok(parse(&payload).map(|frame| (frame, size)))
}

fn parse(payload: &[u8]) -> Option<Frame> {
    let mut cursor = Cursor(payload);
    match cursor.take::<1>()?[0] {
        HEADER => {
            if cursor.take::<8>()? != *MAGIC || u32::from_le_bytes(cursor.take()?) != VERSION {
                return None;
            }
            let runs = u64::from_le_bytes(cursor.take()?);
            let mut identity = Vec::new();
            while !cursor.0.is_empty() {
                identity.push((cursor.text()?, u64::from_le_bytes(cursor.take()?)));
            }
            Some(Frame::Header { identity, runs })
        }
        NAME => Some(Frame::Name(cursor.text()?)),
        ROW => {
            let number = u64::from_le_bytes(cursor.take()?);
            let status = *Status::ALL.get(usize::from(cursor.take::<1>()?[0]))?;
            let error = cursor.text()?;
            let mut values = Vec::with_capacity(cursor.0.len() / 12);
            while !cursor.0.is_empty() {
                let index = u32::from_le_bytes(cursor.take()?);
                values.push((index, f64::from_bits(u64::from_le_bytes(cursor.take()?))));
            }
            Some(Frame::Row(Stored { number, status, error, values }))
        }
        _ => None,
    }
}

struct Cursor<'a>(&'a [u8]);

impl Cursor<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*taken)
    }

    fn text(&mut self) -> Option<String> {
        let length = usize::try_from(u32::from_le_bytes(self.take()?)).ok()?;
        let (text, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        String::from_utf8(text.to_vec()).ok()
    }
}

/// Whether a file without a whole header may be a journal whose header was being written.
pub fn begins_like_a_journal(path: &Path) -> io::Result<bool> {
    let mut head = Vec::new();
    File::open(path)?.take((LENGTH_AND_SUM + 1 + MAGIC.len()) as u64).read_to_end(&mut head)?;
    let payload = head.get(LENGTH_AND_SUM..).unwrap_or(&[]);
    let expected: Vec<u8> = std::iter::once(HEADER).chain(*MAGIC).collect();
    // A power failure may leave zeros in the place of what was written last.
    Ok(expected.starts_with(payload) || head.iter().all(|byte| *byte == 0))
}
