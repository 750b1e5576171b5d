//! Syncs that fail: samples are kept, and it is said that they may not survive a loss of power.

use std::path::Path;

use super::story::{OLDER, begin, header, write};
use crate::Dataset;
use crate::disk::trace::{self, Step};

fn rows(path: &Path) -> u64 {
    Dataset::open(path.to_str().unwrap()).unwrap().rows()
}

#[test]
fn a_short_recording_whose_last_sync_fails_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    trace::start();
    let mut writing = begin(&path, &header(false));
    (0..30).for_each(|number| write(&mut writing, number));
    trace::let_syncs_fail();
    let message = writing.finish(0).unwrap_err().to_string();
    assert!(message.contains("a loss of power may take") && message.contains("30 samples"), "{message}");
    assert_eq!(rows(&path), 30);
}

#[test]
fn an_older_file_is_not_replaced_by_one_that_cannot_be_synced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    std::fs::write(&path, OLDER).unwrap();
    trace::start();
    let mut writing = begin(&path, &header(true));
    (0..30).for_each(|number| write(&mut writing, number));
    trace::let_syncs_fail();
    let message = writing.close_chunk().unwrap_err().to_string();
    drop(writing);
    assert_eq!(std::fs::read(&path).unwrap(), OLDER);
    let part = folder.path().read_dir().unwrap().map(|file| file.unwrap().path()).find(|file| *file != path);
    let part = part.expect("the new file is there too");
    assert!(message.contains(part.file_name().unwrap().to_str().unwrap()), "{message}");
    assert_eq!(rows(&part), 30);
}

#[test]
fn nothing_is_named_before_its_content_is_synced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.csv");
    trace::start();
    let mut file = crate::OutputFile::create(&path).unwrap();
    std::io::Write::write_all(&mut file, b"1").unwrap();
    file.commit().unwrap();
    assert_eq!(trace::stop(), [Step::Sync, Step::Rename, Step::SyncName]);
}
