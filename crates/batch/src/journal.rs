//! The journal of a batch: what is finished, one record after the other, never changed.
//!
//! A file of frames: length (4 bytes), check sum (CRC-32, 4 bytes), payload. The first payload says what the batch is; the
//! others are names of values, each before its first use, and rows. A frame that is cut off or does not check ends the
//! journal: it was being written when the program was killed. Opening cuts it off and goes on behind the last whole one.

use crate::error::BatchError;
use crate::frame::{self, Frame};
use crate::row::Row;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Name of the file.
pub const FILE: &str = "journal.headland";

/// An open journal. Nobody else writes to it while it is open.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    reader: BufReader<File>,
    /// Names of values, by their number.
    names: Vec<String>,
    /// Where the record of each run stands; [`NOWHERE`] where there is none.
    places: Vec<u64>,
    finished: u64,
    end: u64,
    /// Bytes that were cut off when it was opened.
    pub torn_bytes: u64,
}

/// No record begins here: the file begins with its header.
const NOWHERE: u64 = 0;

/// What a batch is: named parts and their hashes. Two batches with the same parts have the same results.
pub type Identity = Vec<(String, u64)>;

impl Journal {
    /// Opens the journal of a folder, or begins one. `anew` throws away what is there.
    ///
    /// # Errors
    /// [`BatchError::Another`] where the folder holds another batch, [`BatchError::Busy`], [`BatchError::NoJournal`],
    /// [`BatchError::File`].
    pub fn open(folder: &Path, identity: &Identity, runs: u64, anew: bool) -> Result<Self, BatchError> {
        let path = folder.join(FILE);
        let refused = |source| BatchError::File { path: path.clone(), source };
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(refused)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(BatchError::Busy { folder: folder.to_owned() }),
            // A file system without locks is no reason not to work.
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(refused(error)),
        }
        let reader = BufReader::new(File::open(&path).map_err(refused)?);
        let runs = usize::try_from(runs).unwrap_or(usize::MAX);
        let mut journal = Self {
            reader,
            file,
            names: Vec::new(),
            places: vec![NOWHERE; runs],
            finished: 0,
            end: 0,
            torn_bytes: 0,
            path,
        };
        if anew {
            journal.file.set_len(0).map_err(|source| journal.refused(source))?;
        }
        journal.read_all(folder, identity)?;
        Ok(journal)
    }

    fn refused(&self, source: io::Error) -> BatchError {
        BatchError::File { path: self.path.clone(), source }
    }

    /// Reads every whole frame and cuts off what is behind.
    fn read_all(&mut self, folder: &Path, identity: &Identity) -> Result<(), BatchError> {
        let length = self.file.metadata().map_err(|error| self.refused(error))?.len();
        let mut different = None;
        let mut first = true;
        loop {
            let frame =
                frame::read(&mut self.reader, length - self.end).map_err(|error| self.refused(error))?;
            let Some((frame, size)) = frame else { break };
            match frame {
                Frame::Header { identity: found, runs } if first => {
                    if found != *identity || runs != self.places.len() as u64 {
                        different = Some(differences(&found, identity));
                        self.places.resize(usize::try_from(runs).unwrap_or(0), NOWHERE);
                    }
                }
                _ if first => return Err(BatchError::NoJournal { path: self.path.clone() }),
                Frame::Header { .. } => break,
                Frame::Name(name) => self.names.push(name),
                Frame::Row(row) => {
                    let number = usize::try_from(row.number).unwrap_or(usize::MAX);
                    if let Some(place) = self.places.get_mut(number) {
                        self.finished += u64::from(*place == NOWHERE);
                        *place = self.end;
                    }
                }
            }
            first = false;
            self.end += size;
        }
        if first
            && length > 0
            && !frame::begins_like_a_journal(&self.path).map_err(|error| self.refused(error))?
        {
            return Err(BatchError::NoJournal { path: self.path.clone() });
        }
        if let Some(different) = different {
            return Err(BatchError::Another {
                folder: folder.to_owned(),
                finished: self.finished,
                different,
            });
        }
        self.torn_bytes = length - self.end;
        self.file.set_len(self.end).map_err(|error| self.refused(error))?;
        if first {
            let header = frame::header(identity, self.places.len() as u64);
            self.write(&header)?;
            sync_folder(folder);
        }
        Ok(())
    }

    /// Runs that are finished.
    pub fn finished(&self) -> u64 {
        self.finished
    }

    /// Whether a run is finished.
    pub fn has(&self, number: u64) -> bool {
        self.place(number).is_some()
    }

    fn place(&self, number: u64) -> Option<u64> {
        let place = self.places.get(usize::try_from(number).ok()?)?;
        (*place != NOWHERE).then_some(*place)
    }

    /// Appends rows; when this returns, they are on the disk.
    ///
    /// # Errors
    /// [`BatchError::File`]; what was there before stays as it was. [`BatchError::Vanished`].
    pub fn append(&mut self, rows: &[Row]) -> Result<(), BatchError> {
        let (mut bytes, mut places) = (Vec::new(), Vec::new());
        let names_before = self.names.len();
        for row in rows {
            for (name, _) in &row.values {
                if !self.names.contains(name) {
                    self.names.push(name.clone());
                    frame::name(&mut bytes, name);
                }
            }
            places.push((row.number, self.end + bytes.len() as u64));
            frame::row(&mut bytes, row, &self.names);
        }
        if let Err(error) = self.write(&bytes) {
            self.names.truncate(names_before);
            return Err(error);
        }
        for (number, place) in places {
            if let Some(old) = usize::try_from(number).ok().and_then(|index| self.places.get_mut(index)) {
                self.finished += u64::from(*old == NOWHERE);
                *old = place;
            }
        }
        self.still_there()
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), BatchError> {
        let written = self
            .file
            .seek(SeekFrom::Start(self.end))
            .and_then(|_| self.file.write_all(bytes))
            .and_then(|()| self.file.sync_data());
        match written {
            Ok(()) => {
                self.end += bytes.len() as u64;
                Ok(())
            }
            Err(error) => {
                // Half a record would be cut off at the next opening just as well.
                let _ = self.file.set_len(self.end);
                Err(self.refused(error))
            }
        }
    }

    /// Looks whether the file is still where it was; if not, puts everything into a new one at the same place.
    fn still_there(&mut self) -> Result<(), BatchError> {
        if same_file(&self.file, &self.path) {
            return Ok(());
        }
        let folder = self.path.parent().unwrap_or(Path::new("")).to_owned();
        let rescued = self.rescue(&folder).is_ok();
        Err(BatchError::Vanished { folder, finished: self.finished, rescued })
    }

    fn rescue(&mut self, folder: &Path) -> io::Result<()> {
        std::fs::create_dir_all(folder)?;
        let mut copy = OpenOptions::new().write(true).create_new(true).open(&self.path)?;
        self.file.seek(SeekFrom::Start(0))?;
        io::copy(&mut (&self.file).take(self.end), &mut copy)?;
        copy.sync_all()
    }

    /// The row of a run; `None` where it is not finished.
    ///
    /// # Errors
    /// [`BatchError::File`].
    pub fn row(&mut self, number: u64) -> Result<Option<Row>, BatchError> {
        let Some(place) = self.place(number) else { return Ok(None) };
        let here = self.reader.stream_position().map_err(|error| self.refused(error))?;
        let step = i64::try_from(place).unwrap_or(0) - i64::try_from(here).unwrap_or(0);
        // Runs finish nearly in order: mostly the record is already in the buffer.
        self.reader.seek_relative(step).map_err(|error| self.refused(error))?;
        match frame::read(&mut self.reader, self.end - place).map_err(|error| self.refused(error))? {
            Some((Frame::Row(row), _)) => Ok(Some(row.named(&self.names))),
            _ => {
                Err(self
                    .refused(io::Error::new(io::ErrorKind::InvalidData, "a record can no longer be read")))
            }
        }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }
}

/// What is different, in words.
fn differences(found: &Identity, wanted: &Identity) -> Vec<String> {
    let of = |all: &Identity, name: &str| all.iter().find(|(other, _)| other == name).map(|(_, hash)| *hash);
    let mut different: Vec<String> = Vec::new();
    for (name, hash) in wanted {
        match of(found, name) {
            Some(other) if other == *hash => {}
            Some(_) => different.push(format!("{name} changed")),
            None => different.push(format!("{name} is new")),
        }
    }
    for (name, _) in found.iter().filter(|(name, _)| of(wanted, name).is_none()) {
        different.push(format!("{name} is gone"));
    }
    if different.is_empty() {
        different.push("the order changed".to_owned());
    }
    different
}

/// A new file is only safe once its folder is written, too. Where folders cannot be synced, they need not be.
fn sync_folder(folder: &Path) {
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
}

#[cfg(unix)]
fn same_file(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(open), Ok(named)) => open.ino() == named.ino() && open.dev() == named.dev(),
        _ => false,
    }
}

#[cfg(not(unix))]
fn same_file(_: &File, path: &Path) -> bool {
    path.exists()
}

#[cfg(test)]
#[path = "journal_tests.rs"]
mod tests;
