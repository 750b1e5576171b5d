//! A recording with everything that can be wrong with one.

use socam_workbench::recording::{Happening, Recording};

use super::{of, run};

/// A recording with a gap, missing values, a spike, events, notes and warnings.
pub(super) fn troubled(rows: usize) -> Recording {
    let whole = run(3, rows);
    let all = 0..rows;
    let keep = |row: &usize| !(rows / 3..rows * 2 / 5).contains(row);
    let time_s: Vec<f64> = whole.samples.times(all.clone());
    let time_s: Vec<f64> = all.clone().filter(keep).map(|row| time_s[row]).collect();
    let mut columns: Vec<Vec<f64>> = (0..5)
        .map(|channel| {
            let values = whole.samples.values(channel, all.clone());
            all.clone().filter(keep).map(|row| values[row]).collect()
        })
        .collect();
    let last = columns[0].len();
    columns[3][last / 2..last * 3 / 5].fill(f64::NAN);
    columns[4][last * 4 / 5] = 30.0;
    let mut recording = of(
        "measurements/2026-11/a-rather-long-name-of-a-recording-that-nobody-would-type_bench-2.mcap",
        time_s,
        columns,
    );
    let event = |time_s, kind: &str, text: &str| Happening { time_s, kind: kind.into(), text: text.into() };
    recording.about.events = vec![
        event(0.0, "phase", "part 0 of the profile"),
        event(1.0, "phase", "part 1 of the profile"),
        event(4.4, "note", "coupling 2 squeaks"),
        event(5.2, "fault", "motor_speed is above its limit of 120 rad/s"),
    ];
    recording.about.facts = vec![("note".into(), "after the new coupling was fitted, cold".into())];
    recording.about.warnings = vec!["the recording is cut off: missing is about 0.4 s".into()];
    recording
}
