//! Recordings as they are named: parts by clock times, wildcards, and files of one run that follow one another.

use std::fmt::Write as _;
use std::path::Path;

use socam_tests::{path, run};
use tempfile::TempDir;

use super::columns;

/// Ten seconds at 10 Hz, stamped by a clock; the speed counts the seconds of the day.
fn by_the_clock(folder: &TempDir, name: &str, date: &str, from_s: f64) -> String {
    let mut text = format!("{},speed_rad_s\n", if date.is_empty() { "time" } else { "date_time" });
    for k in 0..100 {
        let second = from_s + 0.1 * f64::from(k);
        let (hours, minutes) = ((second / 3600.0).floor(), (second / 60.0).floor());
        let clock = format!("{hours:02}:{:02}:{:06.3}", minutes % 60.0, second - 60.0 * minutes);
        let _ = writeln!(text, "{date}{clock},{second}");
    }
    let file = path(folder, name);
    std::fs::write(&file, text).unwrap();
    file
}

fn rows(path: &str) -> usize {
    columns(Path::new(path), &["speed"])[0].len()
}

#[test]
fn a_part_is_named_by_the_clock_that_stamped_it() {
    let folder = tempfile::tempdir().unwrap();
    let dated = by_the_clock(&folder, "dated.csv", "2026-05-01T", 50_597.0);
    let timed = by_the_clock(&folder, "timed.csv", "", 50_597.0);
    let said = run(["info", &dated]).done();
    assert!(said.contains("from 2026-05-01 14:03:17 to 2026-05-01 14:03:26.9"), "{said}");
    let target = path(&folder, "part.mcap");
    for part in [
        format!("{dated}@14:03:20..14:03:22"),
        format!("{dated}@2026-05-01T14:03:20..2026-05-01T14:03:22"),
        format!("{timed}@14:03:20..14:03:22"),
    ] {
        let _ = run(["import", &part, "-o", &target, "--force"]).done();
        let found = columns(Path::new(&target), &["speed"]);
        assert_eq!((found[1].len(), found[1][0]), (20, 50_600.0), "{part}");
        // The log knows the clock too.
        let said = run(["info", &format!("{target}@14:03:21..")]).done();
        assert!(said.contains("  10 rows over 0.9 s"), "{part}: {said}");
    }
    let plain = path(&folder, "plain.csv");
    std::fs::write(&plain, "t_s,speed_rad_s\n0,1\n0.1,2\n0.2,3\n").unwrap();
    let ran = run(["info", &format!("{plain}@14:03..14:05")]);
    let refused = ran.refusal(1);
    assert!(
        refused.contains("states neither a date nor a time of day; name its part in seconds, from 0 to 0.2"),
        "{refused}"
    );
    let _ = run(["info", &format!("{plain}@noon..")]).refusal(2);
}

#[test]
fn wildcards_are_expanded_where_no_shell_does_it() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["run_10.csv", "run_9.csv", "run[9].csv"] {
        std::fs::write(path(&folder, name), "t_s,speed_rad_s\n0,1\n0.1,2\n0.2,3\n").unwrap();
    }
    let of = |said: &str| -> Vec<String> {
        let names = said.lines().filter(|line| line.ends_with(": CSV"));
        names.map(|line| line.rsplit(['/', '\\']).next().unwrap().to_owned()).collect()
    };
    let said = run(["info", &path(&folder, "run_*.csv@0..0.15")]).done();
    assert_eq!(of(&said), ["run_9.csv@0..0.15: CSV", "run_10.csv@0..0.15: CSV"]);
    assert_eq!(of(&run(["info", &path(&folder, "run[9].csv")]).done()), ["run[9].csv: CSV"]);
    let ran = run(["info", &path(&folder, "walk_*.csv")]);
    let refused = ran.refusal(2);
    assert!(refused.contains("matches no file"), "{refused}");
    let ran = run(["compare", &path(&folder, "run_*.csv"), &path(&folder, "run_9.csv")]);
    let refused = ran.refusal(1);
    assert!(refused.contains("matches 2 files where one recording is needed"), "{refused}");
}

#[test]
fn files_that_follow_one_another_are_one_recording() {
    let folder = tempfile::tempdir().unwrap();
    for (name, from_s) in [("log_9.csv", 50_000.0), ("log_10.csv", 50_010.0), ("log_11.csv", 50_025.0)] {
        let _ = by_the_clock(&folder, name, "2026-05-01T", from_s);
    }
    let (all, target) = (path(&folder, "log_*.csv+"), path(&folder, "all.mcap"));
    let ran = run(["import", &all, "-o", &target]);
    assert!(ran.code == Some(0) && ran.stderr.contains("is a gap of 5.1"), "{}", ran.stderr);
    let found = columns(Path::new(&target), &["speed"]);
    assert_eq!(found[1].len(), 300);
    assert!(found[0].iter().zip(&found[1]).all(|(time_s, second)| (time_s + 50_000.0 - second).abs() < 1e-6));
    let said = run(["info", &target]).done();
    assert!(said.contains("1 gap:"), "{said}");
    let two = format!("{}+{}@13:53:29..13:53:31", path(&folder, "log_9.csv"), path(&folder, "log_10.csv"));
    let _ = run(["export", &two, "-o", &path(&folder, "two.csv")]).done();
    assert_eq!(rows(&path(&folder, "two.csv")), 20);
    let wrong = format!("{}+{}", path(&folder, "log_10.csv"), path(&folder, "log_9.csv"));
    let ran = run(["info", &wrong]);
    let refused = ran.refusal(1);
    assert!(
        refused.contains(
            "the second begins at 2026-05-01 13:53:20, and the first ends at 2026-05-01 13:53:39.9"
        ),
        "{refused}"
    );
}
