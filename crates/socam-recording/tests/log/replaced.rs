//! A recording or an export that replaces a file: the older one is lost only when the new one is there.

use std::path::Path;
use std::time::Duration;

use socam_recording::{OutputFile, Recorder, SampleRow, export_csv};

use crate::bench::{header, open, record};

fn files(folder: &Path) -> Vec<String> {
    let names = folder.read_dir().unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
    names.collect()
}

#[test]
fn an_older_recording_stays_until_the_first_sample_of_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    record(&path, 10, None);
    let before = std::fs::read(&path).unwrap();
    let header = socam_recording::RecordingHeader { replace: true, ..header() };
    let mut recorder = Recorder::create(&path, &header).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), before);
    // The name of the file that a kill would now leave contains the target's name.
    assert!(files(folder.path()).iter().any(|name| name.starts_with("run.mcap.") && name.ends_with(".part")));
    assert!(recorder.finish().unwrap_err().to_string().contains("not one sample"));
    assert_eq!((std::fs::read(&path).unwrap(), files(folder.path())), (before, vec!["run.mcap".to_owned()]));

    recorder = Recorder::create(&path, &header).unwrap();
    let row = SampleRow { device_time_ns: 0, sequence: 0, flags: 0, raw_counts: &[], values: &[1.0, 2.0] };
    recorder.push_samples(&[row]);
    // A chunk is closed within a second; then the new recording is the one that a kill leaves.
    std::thread::sleep(Duration::from_millis(1200));
    assert_eq!((open(&path).unwrap().rows(), files(folder.path())), (1, vec!["run.mcap".to_owned()]));
    recorder.finish().unwrap();
    assert!(open(&path).unwrap().cut().is_none());
}

#[cfg(unix)]
#[test]
fn temporary_files_have_names_of_their_own_and_follow_no_link() {
    use std::io::Write;
    use std::os::unix::fs::symlink;

    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let (log, target, users, elsewhere) =
        (at("run.mcap"), at("run.csv"), at("run.csv.part"), at("elsewhere.txt"));
    record(&log, 100, None);
    for path in [&users, &elsewhere] {
        std::fs::write(path, "mine").unwrap();
    }
    symlink(&elsewhere, &target).unwrap();
    // Two writers of one target: the last one to finish wins, and both files are whole.
    let mut other = OutputFile::create(&target).unwrap();
    other.write_all(b"other").unwrap();
    export_csv(&open(&log).unwrap(), &target).unwrap();
    assert_eq!(std::fs::read_to_string(&target).unwrap().lines().count(), 101);
    other.commit().unwrap();
    assert_eq!(std::fs::read_to_string(&target).unwrap(), "other");
    for path in [&users, &elsewhere] {
        assert_eq!(std::fs::read_to_string(path).unwrap(), "mine", "{}", path.display());
    }
    assert_eq!(files(folder.path()).len(), 4, "{:?}", files(folder.path()));
}
