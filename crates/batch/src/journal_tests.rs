use super::*;
use crate::row::Status;

fn identity() -> Identity {
    vec![("variant `a`".to_owned(), 1), ("cycle `b`".to_owned(), 2)]
}

fn row(number: u64) -> Row {
    let mut row = Row::without(number, Status::Finished, String::new());
    row.values = vec![("time_s".to_owned(), 0.1 * number as f64), ("fuel_kg".to_owned(), f64::MIN_POSITIVE)];
    row
}

fn open(folder: &Path) -> Result<Journal, BatchError> {
    Journal::open(folder, &identity(), 10, false)
}

#[test]
fn rows_come_back_bit_by_bit_in_any_order() {
    let folder = tempfile::tempdir().unwrap();
    let mut journal = open(folder.path()).unwrap();
    let refused = Row::without(3, Status::Refused, "`mass_kg` is −1".to_owned());
    journal.append(&[row(7), refused.clone()]).unwrap();
    journal.append(&[row(0)]).unwrap();
    drop(journal);
    let mut journal = open(folder.path()).unwrap();
    assert_eq!((journal.finished(), journal.torn_bytes), (3, 0));
    assert_eq!(journal.row(0).unwrap(), Some(row(0)));
    assert_eq!(journal.row(7).unwrap(), Some(row(7)));
    assert_eq!(journal.row(3).unwrap(), Some(refused));
    assert_eq!(journal.row(1).unwrap(), None);
    assert!(journal.has(7) && !journal.has(8));
}

/// Wherever the file is cut off, whole records in front of the cut are kept, and the journal goes on.
#[test]
fn a_tail_torn_at_any_byte_loses_only_the_record_that_was_being_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(FILE);
    let mut journal = open(folder.path()).unwrap();
    let empty = std::fs::metadata(&path).unwrap().len();
    journal.append(&[row(1)]).unwrap();
    let one = std::fs::metadata(&path).unwrap().len();
    journal.append(&[row(2)]).unwrap();
    drop(journal);
    let whole = std::fs::read(&path).unwrap();
    for cut in 0..whole.len() {
        std::fs::write(&path, &whole[..cut]).unwrap();
        let mut journal = open(folder.path()).unwrap();
        let kept = u64::from(cut as u64 >= one);
        assert_eq!(journal.finished(), kept, "cut at {cut}");
        journal.append(&[row(2), row(5)]).unwrap();
        drop(journal);
        let mut journal = open(folder.path()).unwrap();
        assert_eq!((journal.finished(), journal.torn_bytes), (kept + 2, 0), "cut at {cut}");
        assert_eq!(journal.row(5).unwrap(), Some(row(5)));
    }
    assert!(empty > 0);
}

#[test]
fn a_byte_that_turned_ends_the_journal_in_front_of_its_record() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(FILE);
    let mut journal = open(folder.path()).unwrap();
    journal.append(&[row(1)]).unwrap();
    let one = usize::try_from(std::fs::metadata(&path).unwrap().len()).unwrap();
    journal.append(&[row(2)]).unwrap();
    drop(journal);
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[one + 12] ^= 4;
    std::fs::write(&path, bytes).unwrap();
    let journal = open(folder.path()).unwrap();
    assert!(journal.has(1) && !journal.has(2) && journal.torn_bytes > 0);
}

#[test]
fn another_batch_is_refused_with_what_is_different_unless_it_begins_anew() {
    let folder = tempfile::tempdir().unwrap();
    open(folder.path()).unwrap().append(&[row(1)]).unwrap();
    let other = vec![("variant `a`".to_owned(), 1), ("cycle `b`".to_owned(), 3), ("repeat".to_owned(), 0)];
    let error = Journal::open(folder.path(), &other, 20, false).unwrap_err();
    let BatchError::Another { finished: 1, different, .. } = &error else { panic!("{error}") };
    assert_eq!(different, &["cycle `b` changed", "repeat is new"]);
    assert!(open(folder.path()).unwrap().has(1), "a refusal changes nothing");
    assert_eq!(Journal::open(folder.path(), &other, 20, true).unwrap().finished(), 0);
    assert!(matches!(open(folder.path()), Err(BatchError::Another { finished: 0, .. })));
}

#[test]
fn two_programs_never_write_one_journal() {
    let folder = tempfile::tempdir().unwrap();
    let _first = open(folder.path()).unwrap();
    assert!(matches!(open(folder.path()), Err(BatchError::Busy { .. })));
}

#[test]
fn a_file_that_is_no_journal_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(FILE);
    std::fs::write(&path, "a letter to my aunt about the harvest").unwrap();
    assert!(matches!(open(folder.path()), Err(BatchError::NoJournal { .. })));
    assert!(std::fs::read_to_string(&path).unwrap().contains("aunt"));
}

#[cfg(unix)]
#[test]
fn a_folder_that_is_taken_away_is_made_again_with_everything_that_was_finished() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("out");
    std::fs::create_dir(&folder).unwrap();
    let mut journal = open(&folder).unwrap();
    journal.append(&[row(1)]).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    let error = journal.append(&[row(2)]).unwrap_err();
    assert!(matches!(error, BatchError::Vanished { finished: 2, rescued: true, .. }), "{error}");
    drop(journal);
    let mut journal = open(&folder).unwrap();
    assert_eq!(journal.row(2).unwrap(), Some(row(2)));
    assert_eq!(journal.finished(), 2);
}
