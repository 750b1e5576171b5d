use std::fmt::Write as _;
use std::path::Path;

use super::*;
use crate::{Channel, Unit};

const MAY_FIRST: i64 = 1_777_593_600_000_000_000; // 2026-05-01

/// Rows at 10 Hz from a time on, whose speed is the time.
fn rows(name: &str, from_s: f64, count: u32) -> Dataset {
    let time_s: Vec<f64> = (0..count).map(|k| from_s + 0.1 * f64::from(k)).collect();
    let speed = time_s.clone();
    Dataset::from_columns(name, vec![Channel::new("speed", Unit::RadPerS)], time_s, vec![speed]).unwrap()
}

fn stamped(name: &str, epoch: Epoch, from_s: f64, count: u32) -> Dataset {
    rows(name, from_s, count).with_epoch(Some(epoch))
}

fn join(parts: Vec<Dataset>) -> Result<Dataset> {
    let mut parts = parts.into_iter();
    let mut joining = Joining::with(parts.next().unwrap(), 2)?;
    parts.try_for_each(|part| joining.append(&part))?;
    joining.finish("all".into())
}

fn said(data: &Dataset) -> String {
    data.warnings().iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

fn spans(data: &Dataset) -> Vec<[f64; 2]> {
    data.segments().iter().map(|s| [s.start_s, s.end_s].map(|t| (t * 1e6).round() / 1e6)).collect()
}

#[test]
fn stamps_that_go_on_are_one_recording() {
    let data = join(vec![rows("a", 0.0, 50), rows("b", 5.0, 50)]).unwrap();
    assert_eq!((data.rows(), spans(&data)), (100, vec![[0.0, 9.9]]));
    assert_eq!(data.statistics()[0].count, 100);
    assert_eq!(data.load(&["speed"]).unwrap().columns[0].get(99), Some(9.9));
    assert_eq!(said(&data), "");
}

#[test]
fn a_gap_between_files_is_kept_and_said() {
    let data = join(vec![rows("a", 0.0, 50), rows("b", 7.0, 50)]).unwrap();
    assert_eq!(spans(&data), [[0.0, 4.9], [7.0, 11.9]]);
    assert_eq!(said(&data), "between `a` and `b` is a gap of 2.100000 s, from 4.9 s to 7 s");
}

#[test]
fn dates_say_where_files_that_count_anew_belong() {
    let at = |seconds: i64| Epoch::Date(MAY_FIRST + seconds * 1_000_000_000);
    let data =
        join(vec![stamped("a", at(0), 0.0, 50), stamped("b", at(5), 0.0, 50), stamped("c", at(20), 0.0, 50)]);
    assert_eq!(spans(&data.unwrap()), [[0.0, 9.9], [20.0, 24.9]]);
    let why = join(vec![stamped("a", at(0), 0.0, 50), stamped("b", at(4), 0.0, 50)]).unwrap_err().to_string();
    assert!(
        why.contains("begins at 2026-05-01 00:00:04, and the first ends at 2026-05-01 00:00:04.9;"),
        "{why}"
    );
    let why = join(vec![stamped("a", at(0), 0.0, 50), rows("b", 5.0, 50)]).unwrap_err().to_string();
    assert!(why.starts_with("`a+b` cannot be joined: only one of them states when"), "{why}");
}

#[test]
fn midnight_may_lie_between_two_files() {
    let before = stamped("a", Epoch::Midnight, 86_390.0, 50);
    let data = join(vec![before.clone(), stamped("b", Epoch::Midnight, 3600.0, 50)]).unwrap();
    assert_eq!(spans(&data), [[86_390.0, 86_394.9], [90_000.0, 90_004.9]]);
    let why = join(vec![before, stamped("b", Epoch::Midnight, 86_380.0, 50)]).unwrap_err().to_string();
    assert!(why.contains("begins at 23:59:40, and the first ends at 23:59:54.9"), "{why}");
}

#[test]
fn times_that_begin_anew_without_a_date_follow_after_a_gap() {
    let data = join(vec![rows("a", 0.0, 50), rows("b", 0.0, 50), rows("c", 0.1, 50)]).unwrap();
    assert_eq!(spans(&data), [[0.0, 4.9], [5.9, 10.8], [11.8, 16.7]]);
    assert!(said(&data).contains("`b` counts its time anew and states no date"), "{}", said(&data));
    let why = join(vec![rows("a", 0.0, 50), rows("b", 2.0, 50)]).unwrap_err().to_string();
    assert!(why.contains("begins at 2 s, and the first ends at 4.9 s"), "{why}");
}

#[test]
fn other_channels_and_rates_are_refused() {
    let other = Dataset::from_columns(
        "b",
        vec![Channel::new("torque", Unit::Nm)],
        vec![5.0, 5.1],
        vec![vec![1.0, 2.0]],
    );
    let why = join(vec![rows("a", 0.0, 50), other.unwrap()]).unwrap_err().to_string();
    assert!(why.contains("the channels speed_rad_s, and the second torque_Nm"), "{why}");
    let fast = Dataset::from_columns(
        "b",
        vec![Channel::new("speed", Unit::RadPerS)],
        vec![5.0, 5.01, 5.02],
        vec![vec![1.0; 3]],
    );
    let why = join(vec![rows("a", 0.0, 50), fast.unwrap()]).unwrap_err().to_string();
    assert!(why.contains("a sample every 0.1"), "{why}");
}

/// A table of 10 Hz whose speed is its time.
fn write(path: &Path, from_s: f64, count: u32) {
    let mut text = "t_s,speed_rad_s\n".to_owned();
    for k in 0..count {
        let time_s = from_s + 0.1 * f64::from(k);
        let _ = writeln!(text, "{time_s},{time_s}");
    }
    std::fs::write(path, text).unwrap();
}

#[test]
fn files_are_joined_and_cut_by_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    for (name, from_s) in [("log_9.csv", 0.0), ("log_10.csv", 5.0), ("log_11.csv", 20.0)] {
        write(Path::new(&at(name)), from_s, 50);
    }
    let all = Dataset::open(&at("log_*.csv+")).unwrap();
    assert_eq!((all.name(), spans(&all)), (&*at("log_*.csv+"), vec![[0.0, 9.9], [20.0, 24.9]]));
    let part = format!("{}+{}@4..6", at("log_9.csv"), at("log_10.csv"));
    let part = Dataset::open(&part).unwrap();
    assert_eq!((part.rows(), spans(&part)), (20, vec![[4.0, 5.9]]));
    let why = |text: String| Dataset::open(&text).unwrap_err().to_string();
    assert!(why(at("log_*.csv")).contains("matches 3 files where one recording is needed"));
    assert!(why(at("log_9.csv+") + "+" + &at("log_9.csv")).contains("twice"));
    assert!(why(format!("{}+{}", at("log_10.csv"), at("log_9.csv"))).contains("the order of their times"));
    assert!(why(at("a+b.csv")).contains("there is no such file"));
    assert!(why(format!("{}@14:00..14:05", at("log_9.csv"))).contains("neither a date nor a time of day"));
}

#[test]
fn a_part_is_named_by_the_clock_of_unix_stamps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    write(&path, MAY_FIRST as f64 / 1e9, 100);
    let open = |span: &str| Dataset::open(&format!("{}@{span}", path.display()));
    for span in ["00:00:02..00:00:03", "2026-05-01T00:00:02..2026-05-01T00:00:03"] {
        let part = open(span).unwrap();
        assert_eq!((part.rows(), part.start_s() - MAY_FIRST as f64 / 1e9), (10, 2.0), "{span}");
        assert!(part.name().ends_with(span));
    }
    assert!(open("00:01..00:02").unwrap_err().to_string().contains("no samples in this part"));
}
