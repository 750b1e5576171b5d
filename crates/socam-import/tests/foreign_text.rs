//! Text of other programs that states more than a table does: LabVIEW, traces of PLCs, JSON; and tables with dates or several clocks.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use socam_import::{ImportError, import_guessed, open, propose};
use socam_recording::{Dataset, Selection, Warning};

const ROWS: usize = 40;

fn torque(row: usize) -> f64 {
    0.25 * row as f64 - 3.0
}

fn speed(row: usize) -> f64 {
    0.5 * row as f64 + 1.0
}

fn written(folder: &Path, name: &str, content: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

/// The sum of rows, one line each.
fn rows(line: impl Fn(usize) -> String) -> String {
    (0..ROWS).map(|row| line(row) + "\n").collect()
}

/// Names of channels with their first and last value, and the last time.
fn read(folder: &Path, name: &str, content: &str) -> Result<(Dataset, f64), ImportError> {
    let data = open(written(folder, name, content).to_str().unwrap())?;
    let last_s = *data.load_all().unwrap().time_s.last().unwrap();
    Ok((data, last_s))
}

fn assert_holds(data: &Dataset, last_s: f64, step_s: f64, what: &str) {
    let loaded = data.load_all().unwrap();
    assert!((last_s - loaded.time_s[0] - step_s * (ROWS - 1) as f64).abs() < 1e-6, "{what}: {last_s}");
    for (name, truth) in [("torque_Nm", torque as fn(usize) -> f64), ("speed_rad_s", speed)] {
        let at = data.channels().iter().position(|channel| channel.column_name() == name);
        let at = at.unwrap_or_else(|| panic!("{what} has no {name}: {:?}", data.channels()));
        for row in 0..ROWS {
            assert!(
                (loaded.columns[at].values()[row] - truth(row)).abs() < 1e-9,
                "{what}: {name}, row {row}"
            );
        }
    }
}

/// LabVIEW with no column of times, with one for all, and with one before each channel.
fn labview(times: &str, per_row: impl Fn(usize) -> String, cells: usize) -> String {
    let both = |key: &str, first: &str, second: &str| {
        let gap = if cells == 2 { "\t" } else { "" };
        format!("{key}\t{first}{gap}\t{second}{gap}\n")
    };
    let mut text = format!(
        "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\t{times}\nDate\t2026/01/05\n***End_of_Header***\t\n\t\n"
    );
    text += &both("Channels", "2", "");
    text += &both("Date", "2026/01/05", "2026/01/05");
    text += &both("Time", "10:45:47.03", "10:45:47.03");
    text += &both("Y_Unit_Label", "N m", "rad/s");
    text += &both("X_Dimension", "Time", "Time");
    text += &both("X0", "0.0", "0.0");
    text += &both("Delta_X", "0.002", "0.002");
    text += "***End_of_Header***\t\n";
    let names = if times == "Multi" {
        "X_Value\tTorque\tX_Value\tSpeed\tComment\n"
    } else {
        "X_Value\tTorque\tSpeed\tComment\n"
    };
    text + names + &rows(per_row)
}

fn formats() -> Vec<(&'static str, String)> {
    let at = |row: usize| 0.002 * row as f64;
    let pair = |row: usize| (torque(row), speed(row));
    let column =
        |of: &dyn Fn(usize) -> f64| (0..ROWS).map(|row| of(row).to_string()).collect::<Vec<_>>().join(",");
    let mut stacked = String::from("[key]; [value]\nName; Trace\n");
    for (index, (name, of)) in
        [("torque_Nm", torque as fn(usize) -> f64), ("speed_rad_s", speed)].iter().enumerate()
    {
        let _ = write!(
            stacked,
            "{index}.Variable; {name}\n{index}.Data; \n{}",
            rows(|row| format!("; {}; {}", 2 * row, of(row)))
        );
    }
    vec![
        ("none.lvm", labview("No", |row| format!("\t{}\t{}", torque(row), speed(row)), 2)),
        ("one.lvm", labview("One", |row| format!("{}\t{}\t{}", at(row), torque(row), speed(row)), 1)),
        ("multi.lvm", labview("Multi", |row| format!("{t}\t{}\t{t}\t{}", torque(row), speed(row), t = at(row)), 2)),
        (
            "scope.csv",
            format!(
                "Name\tScope\nFile\tx\n\nName\tMAIN.torque\tName\tMAIN.speed\nData-Type\tREAL64\tData-Type\tREAL64\nSampleTime[ms]\t2\tSampleTime[ms]\t2\nUnit\tNm\tUnit\trad/s\n{}",
                rows(|row| format!("{t}\t{}\t{t}\t{}", torque(row), speed(row), t = 2 * row))
            )
            .replace("MAIN.", ""),
        ),
        (
            "records.json",
            format!("[{}]", (0..ROWS).map(|row| format!(r#"{{"t_s":{},"torque_Nm":{},"motor":"a","speed_rad_s":{}}}"#, at(row), torque(row), speed(row))).collect::<Vec<_>>().join(",\n")),
        ),
        ("lines.json", rows(|row| format!(r#"{{"t_s":{},"torque_Nm":{},"speed_rad_s":{}}}"#, at(row), torque(row), speed(row)))),
        (
            "columns.json",
            format!(r#"{{"run":"7","data":{{"t_s":[{}],"torque_Nm":[{}],"speed_rad_s":[{}]}}}}"#, column(&at), column(&torque), column(&speed)),
        ),
        (
            "split.json",
            format!(
                r#"{{"columns":["t_s","torque_Nm","speed_rad_s"],"data":[{}]}}"#,
                (0..ROWS).map(|row| format!("[{},{},{}]", at(row), torque(row), speed(row))).collect::<Vec<_>>().join(",")
            ),
        ),
        (
            "day-and-time.csv",
            format!(
                "Date,Time,Torque [Nm],Speed [rad/s]\n{}",
                rows(|row| {
                    let ms = 59_960 + 2 * row;
                    let (day, clock) = if ms < 60_000 { (28, format!("23:59:{}.{:03}", ms / 1000, ms % 1000)) } else { (29, format!("00:00:00.{:03}", ms - 60_000)) };
                    format!("2026-03-{day},{clock},{},{}", torque(row), speed(row))
                })
            ),
        ),
        (
            "two-clocks.csv",
            format!(
                "Time [s];Torque [Nm];Time [s];Speed [rad/s]\n{}",
                rows(|row| format!("{t};{};{t};{}", pair(row).0, pair(row).1, t = at(row)))
            ),
        ),
        (
            "scope-of-rigol.csv",
            format!(
                "X,torque,speed,Start,Increment,\nSequence,Nm,rad/s,-1.0e-02,2.000000e-03,\n{}",
                rows(|row| format!("{row},{},{},,", torque(row), speed(row)))
            ),
        ),
    ]
    .into_iter()
    .chain([("trace.csv", stacked)])
    .collect()
}

#[test]
fn every_form_holds_the_same_numbers() {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in formats() {
        if name == "trace.csv" {
            // It does not state the unit of its times.
            let path = written(folder.path(), name, &content);
            let guessed = import_guessed(&Selection::parse(path.to_str().unwrap()).unwrap(), None).unwrap();
            assert_eq!(guessed.taken.len(), 1, "{:?}", guessed.taken);
            assert!(
                guessed.taken[0].contains("taken for ms because its step of 2 is then 500 Hz"),
                "{:?}",
                guessed.taken
            );
            let last_s = *guessed.imported.data.load_all().unwrap().time_s.last().unwrap();
            assert_holds(&guessed.imported.data, last_s, 0.002, name);
            continue;
        }
        let (data, last_s) =
            read(folder.path(), name, &content).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_holds(&data, last_s, 0.002, name);
    }
}

/// A file that was cut anywhere is read as far as it goes or refused in a sentence.
#[test]
fn a_cut_file_is_read_as_far_as_it_goes_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in formats() {
        for part in 1..40 {
            let end = content.len() * part / 40;
            match read(folder.path(), name, &content[..end]) {
                Ok((data, _)) => assert!(data.rows() <= ROWS as u64, "{name} cut at {end}"),
                Err(error) => {
                    let said = error.to_string();
                    assert!(said.contains(name) && !said.contains('\n'), "{name} cut at {end}: {said}");
                }
            }
        }
    }
}

#[test]
fn a_log_of_sysid_is_one_recording_with_gaps() {
    let folder = tempfile::tempdir().unwrap();
    let test = |from: f64| {
        let rows: Vec<String> = (0..ROWS)
            .map(|row| format!("[{},1.5,{},{}]", from + 0.02 * row as f64, 0.25 * row as f64, 0.5))
            .collect();
        rows.join(",")
    };
    let text = format!(
        r#"{{"test":"Simple","units":"Rotations","unitsPerRotation":1.0,"slow-forward":[{}],"fast-backward":[{}]}}"#,
        test(10.0),
        test(0.0)
    );
    let (data, _) = read(folder.path(), "sysid.json", &text).unwrap();
    let names: Vec<String> = data.channels().iter().map(|channel| channel.column_name()).collect();
    assert_eq!(names, ["voltage_V", "position_rad", "velocity_rad_s"]);
    let loaded = data.load_all().unwrap();
    assert_eq!(data.rows(), 2 * ROWS as u64);
    assert!((loaded.columns[2].values()[0] - 0.5 * std::f64::consts::TAU).abs() < 1e-12);
    assert!((loaded.time_s[ROWS] - loaded.time_s[ROWS - 1] - 10.0).abs() < 1e-9);
    let said: Vec<String> = data.warnings().iter().map(Warning::to_string).collect();
    assert!(said.iter().any(|text| text.contains("`fast-backward` counts its time anew")), "{said:?}");
    let wrong = text.replace("Rotations", "Furlongs");
    let error = read(folder.path(), "sysid.json", &wrong).unwrap_err().to_string();
    assert!(error.contains("`Furlongs`, a unit that is not known here"), "{error}");
}

/// A table of an older oscilloscope of Tektronix, whose header stands beside the values.
#[test]
fn headers_beside_values_are_no_columns() {
    let folder = tempfile::tempdir().unwrap();
    let head = [
        "Record Length,2.500000e+03",
        "Sample Interval,2.000000e-03",
        ",",
        "Source,CH1",
        "Vertical Units,V",
        "Horizontal Units,s",
    ];
    let text = rows(|row| {
        format!("{},,{:.12},{:.5},", head.get(row).unwrap_or(&","), 0.002 * row as f64 - 0.0025, torque(row))
    });
    let (data, last_s) = read(folder.path(), "F0000CH1.CSV", &text).unwrap();
    let loaded = data.load_all().unwrap();
    assert_eq!(data.channels()[0].column_name(), "ch1_V");
    assert!((last_s + 0.0025 - 0.002 * (ROWS - 1) as f64).abs() < 1e-9, "{last_s}");
    assert!(loaded.columns[0].values().iter().enumerate().all(|(row, value)| *value == torque(row)));
    let comma = text.replace(',', ";").replace('.', ",");
    let (data, _) = read(folder.path(), "F0001CH1.CSV", &comma).unwrap();
    assert_eq!(data.load_all().unwrap().columns[0].values(), loaded.columns[0].values());
    for part in 1..40 {
        match read(folder.path(), "F0000CH1.CSV", &text[..text.len() * part / 40]) {
            Ok((data, _)) => assert!(data.rows() <= ROWS as u64),
            Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }
}

#[test]
fn text_among_the_numbers_of_records_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"[{"t_s":0,"x_m":1},{"t_s":1,"x_m":2},{"t_s":2,"x_m":"bad"}]"#;
    let (data, _) = read(folder.path(), "log.json", text).unwrap();
    let said: Vec<String> = data.warnings().iter().map(Warning::to_string).collect();
    assert!(said.iter().any(|text| text.contains("column `x_m` holds text in 1 of 3 rows")), "{said:?}");
}

#[test]
fn times_of_day_go_on_behind_midnight_and_have_no_unit() {
    let folder = tempfile::tempdir().unwrap();
    let text = "Time;speed_rad_s\n23:59:59.980;1\n23:59:59.990;2\n00:00:00.000;3\n00:00:00.010;4\n";
    let (data, last_s) = read(folder.path(), "night.csv", text).unwrap();
    assert!((last_s - data.load_all().unwrap().time_s[0] - 0.03).abs() < 1e-6, "{last_s}");
    let said: Vec<String> = data.warnings().iter().map(Warning::to_string).collect();
    assert!(said.iter().any(|text| text.contains("pass midnight in row 3")), "{said:?}");
    let path = written(folder.path(), "night.csv", text);
    let map = |unit: &str| {
        let text = format!(
            "[[clocks]]\ntime = \"Time\"\n{unit}[channels.speed]\nsignal = \"speed_rad_s\"\nunit = \"rad/s\"\n"
        );
        let selection = Selection::parse(path.to_str().unwrap()).unwrap();
        socam_import::import(&selection, &socam_import::Mapping::parse(&text).unwrap())
    };
    assert_eq!(map("").unwrap().data.rows(), 4);
    let error = map("unit = \"s\"\n").unwrap_err().to_string();
    assert!(
        error.contains("`Time` holds dates or times of day, which have no unit; leave `unit` out"),
        "{error}"
    );
}

#[test]
fn a_rising_column_is_offered_as_the_time() {
    let folder = tempfile::tempdir().unwrap();
    let uneven = |row: usize| 46_448_100 + 20 * row + [0, 3, 1, 4][row % 4];
    let named = written(
        folder.path(),
        "vesc.csv",
        &format!("time;speed [rpm]\n{}", rows(|row| format!("{};{}", uneven(row), row * row))),
    );
    let unnamed = written(
        folder.path(),
        "tick.csv",
        &format!("tick;speed [rpm]\n{}", rows(|row| format!("{};{}", uneven(row), row * row))),
    );
    let numbered = written(
        folder.path(),
        "number.csv",
        &format!("n;speed [rpm]\n{}", rows(|row| format!("{row};{}", row % 7))),
    );
    let assumed = |path: &PathBuf| propose(path, None).unwrap().assumed;
    assert!(
        assumed(&named)[0].starts_with("the unit of the time `time`, taken for ms because"),
        "{:?}",
        assumed(&named)
    );
    assert!(
        assumed(&unnamed)[0].contains("taken for ms because it rises in every row, by 16 to 23"),
        "{:?}",
        assumed(&unnamed)
    );
    assert!(assumed(&numbered).is_empty(), "{:?}", assumed(&numbered));
}

#[test]
fn guesses_are_taken_where_they_are_accepted_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "time,motor torque,speed,widget\n{}",
        rows(|row| format!("{},{},{},{}", 0.01 * row as f64, row % 5, row % 7, row % 3))
    );
    let path = written(folder.path(), "log.csv", &text);
    let error = open(path.to_str().unwrap()).unwrap_err().to_string();
    assert!(error.contains("--accept-guesses"), "{error}");
    let guessed = import_guessed(&Selection::parse(path.to_str().unwrap()).unwrap(), None).unwrap();
    let names: Vec<String> =
        guessed.imported.data.channels().iter().map(|channel| channel.column_name()).collect();
    assert_eq!(names, ["motor_torque_Nm", "speed_rad_s"]);
    assert!(
        guessed.taken.iter().any(|text| text == "the unit of `speed`, taken for rpm by its name"),
        "{:?}",
        guessed.taken
    );
    let said: Vec<String> = guessed.imported.data.warnings().iter().map(Warning::to_string).collect();
    assert!(said.iter().any(|text| text.contains("`widget`")), "{said:?}");
    // The mapping with the guesses reads the same.
    let mapping = socam_import::Mapping::parse(&guessed.mapping).unwrap();
    let again = socam_import::import(&Selection::parse(path.to_str().unwrap()).unwrap(), &mapping).unwrap();
    assert_eq!(again.data.channels(), guessed.imported.data.channels());
}
