//! Binary logs and logs of a CAN bus, written byte by byte after their public descriptions: known numbers in, the same out, and cuts anywhere.

mod logs;

use std::path::{Path, PathBuf};

use logs::{DBC, ROWS, logs, speed_rad_s, torque_nm};
use socam_import::{ImportError, Mapping, import, open, open_either, propose};
use socam_recording::{Dataset, Selection, Warning};

fn written(folder: &Path, name: &str, content: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

fn read(folder: &Path, name: &str, content: &[u8]) -> Result<Dataset, ImportError> {
    open(written(folder, name, content).to_str().unwrap())
}

fn column(data: &Dataset, name: &str) -> Vec<f64> {
    let at = data.channels().iter().position(|channel| channel.column_name().ends_with(name));
    let at = at.unwrap_or_else(|| panic!("no {name}: {:?}", data.channels()));
    data.load_all().unwrap().columns[at].values().to_vec()
}

fn said(data: &Dataset) -> Vec<String> {
    data.warnings().iter().map(Warning::to_string).collect()
}

/// A folder with the DBC of the logs of a bus.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), "motor.dbc", DBC.as_bytes());
    folder
}

#[test]
fn every_log_holds_the_same_numbers() {
    let folder = folder();
    for (name, content) in logs() {
        let data = read(folder.path(), name, &content).unwrap_or_else(|error| panic!("{name}: {error}"));
        let time_s = data.load_all().unwrap().time_s.clone();
        assert_eq!(time_s.len(), ROWS, "{name}");
        assert!(
            (time_s[ROWS - 1] - time_s[0] - 0.002 * (ROWS - 1) as f64).abs() < 1e-9,
            "{name}: {time_s:?}"
        );
        for (channel, truth) in [("speed_rad_s", speed_rad_s as fn(usize) -> f64), ("torque_Nm", torque_nm)] {
            for (row, value) in column(&data, channel).into_iter().enumerate() {
                assert!((value - truth(row)).abs() < 1e-9, "{name}: {channel}, row {row}: {value}");
            }
        }
    }
}

/// A log that was cut anywhere is read as far as it goes, and says so, or is refused in a sentence.
#[test]
fn a_cut_log_is_read_as_far_as_it_goes_or_refused() {
    let folder = folder();
    for (name, content) in logs() {
        let mut most = 0;
        for part in 1..30 {
            let end = content.len() * part / 30;
            match read(folder.path(), name, &content[..end]) {
                Ok(data) => {
                    assert!(data.rows() <= ROWS as u64, "{name} cut at {end}");
                    most = most.max(data.rows());
                    let speeds = column(&data, "speed_rad_s");
                    assert!((speeds[0] - speed_rad_s(0)).abs() < 1e-9, "{name} cut at {end}");
                }
                Err(error) => {
                    let said = error.to_string();
                    assert!(said.contains(name) && !said.contains('\n'), "{name} cut at {end}: {said}");
                }
            }
        }
        assert!(most > ROWS as u64 / 2, "{name}: at most {most} rows are left of a cut log");
    }
}

/// Bytes that are changed anywhere end in a recording or a sentence.
#[test]
fn damaged_bytes_end_in_a_sentence() {
    let folder = folder();
    for (name, content) in logs() {
        for at in (0..content.len()).step_by(content.len() / 50 + 1) {
            let mut damaged = content.clone();
            damaged[at] ^= 0xff;
            if let Err(error) = read(folder.path(), name, &damaged) {
                assert!(!error.to_string().contains('\n'), "{name} damaged at {at}: {error}");
            }
        }
    }
}

#[test]
fn a_cut_ulog_loses_its_last_message_only() {
    let folder = folder();
    let (name, content) = logs().into_iter().find(|(name, _)| *name == "drive.ulg").unwrap();
    let data = read(folder.path(), name, &content[..content.len() - 16]).unwrap();
    assert_eq!(data.rows(), ROWS as u64 - 1);
    assert!(!data.is_complete() && said(&data)[0].contains("cut off"), "{:?}", said(&data));
    // Damage in the middle is passed over up to the next message of synchronisation.
    let middle = content.len() / 2;
    let mut damaged = content.clone();
    damaged[middle..middle + 120].fill(0);
    let data = read(folder.path(), name, &damaged).unwrap();
    assert!(said(&data).iter().any(|text| text.contains("were passed over")), "{:?}", said(&data));
    assert!((ROWS as u64 / 2..ROWS as u64).contains(&data.rows()), "{}", data.rows());
    let (speeds, time_s) = (column(&data, "speed_rad_s"), data.load_all().unwrap().time_s.clone());
    let last = *speeds.last().unwrap();
    assert!((last - speed_rad_s(ROWS - 1)).abs() < 1e-9, "{last}");
    assert!((time_s.last().unwrap() - time_s[0] - 0.002 * (ROWS - 1) as f64).abs() < 1e-9);
}

#[test]
fn entries_of_sysid_state_their_units_and_tests() {
    let folder = folder();
    let data = read(folder.path(), "sysid.wpilog", &logs::sysid()).unwrap();
    let position = column(&data, "position_left_drive_rad");
    assert!((position[3] - 3.0 * std::f64::consts::TAU).abs() < 1e-9, "{position:?}");
    assert_eq!(column(&data, "voltage_left_drive_V")[3], 1.5);
    let said = said(&data);
    assert!(
        said.iter()
            .any(|text| text.contains("SysId's test `quasistatic-forward` lasted from 1.000 s to 1.060 s")),
        "{said:?}"
    );
    assert!(said.iter().any(|text| text.contains("`Pose (struct:Pose2d)`")), "{said:?}");
}

#[test]
fn arrays_are_signals_by_index() {
    let folder = folder();
    let (name, content) = logs().into_iter().find(|(name, _)| *name == "drive.wpilog").unwrap();
    let data = read(folder.path(), name, &content).unwrap();
    assert_eq!(column(&data, "phase_0_A")[..3], [0.0, 1.0, 2.0]);
    assert_eq!(column(&data, "phase_1_A")[..3], [0.5, 0.5, 0.5]);
}

#[test]
fn multiplexed_signals_have_rows_of_their_own() {
    let folder = folder();
    let path = written(folder.path(), "mux.log", logs::multiplexed().as_bytes());
    let proposal = propose(&path, None).unwrap();
    let groups: Vec<&str> = proposal.text.lines().filter(|line| line.starts_with("group = ")).collect();
    assert_eq!(groups, ["group = \"Status\"", "group = \"Status Page=0\"", "group = \"Status Page=1\""]);
    let map = "[[clocks]]\ngroup = \"Status Page=1\"\ntime = \"time\"\nunit = \"ns\"\n\
               [channels.temperature]\nsignal = \"Temperature\"\nunit = \"degC\"\n";
    let imported = import(&Selection::whole(&path), &Mapping::parse(map).unwrap()).unwrap();
    // Every second frame; 0.5 K a bit above -40 degrees Celsius, big-endian.
    let expected: Vec<f64> = (0..ROWS / 2).map(|row| 0.5 * (300 + row) as f64 - 40.0 + 273.15).collect();
    let found = column(&imported.data, "temperature_K");
    assert!(
        found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9) && found.len() == expected.len(),
        "{found:?}"
    );
}

#[test]
fn a_bus_without_a_dbc_asks_for_one() {
    let folder = tempfile::tempdir().unwrap();
    let (name, content) = logs().into_iter().find(|(name, _)| *name == "drive.log").unwrap();
    let error = read(folder.path(), name, &content).unwrap_err().to_string();
    assert!(
        error.contains("put the DBC beside the log, or name it, as in a mapping ([can] dbc = \"FILE\")"),
        "{error}"
    );
    for other in ["a.dbc", "b.DBC"] {
        written(folder.path(), other, DBC.as_bytes());
    }
    let error = read(folder.path(), name, &content).unwrap_err().to_string();
    assert!(error.contains("2 DBC lie beside it"), "{error}");
    // Named, it is in the mapping that is proposed, which reads the same.
    let path = folder.path().join(name);
    let dbc = folder.path().join("a.dbc");
    let selection = Selection::whole(&path);
    assert!(open_either(&selection, Some(&dbc)).is_ok());
    let mapping = Mapping::parse(&propose(&path, Some(&dbc)).unwrap().text).unwrap();
    assert_eq!(mapping.dbc.as_deref(), Some(dbc.as_path()));
    assert_eq!(import(&selection, &mapping).unwrap().data.rows(), ROWS as u64);
    // A mapping's relative path counts from the mapping.
    let text = "[can]\ndbc = \"a.dbc\"\n[channels.speed]\nsignal = \"speed\"\nunit = \"rpm\"\n";
    let mapping = Mapping::open(&written(folder.path(), "map.toml", text.as_bytes())).unwrap();
    assert_eq!(mapping.dbc.as_deref(), Some(dbc.as_path()));
    assert_eq!(import(&selection, &mapping).unwrap().data.rows(), ROWS as u64);
    // One that is damaged says where.
    written(folder.path(), "a.dbc", DBC.replace("SG_ torque", "SG_ torque torque").as_bytes());
    let error = open_either(&selection, Some(&dbc)).map(drop).unwrap_err().to_string();
    assert!(error.contains("a.dbc` is no DBC that can be read (line 1") && !error.contains('\n'), "{error}");
}

#[test]
fn frames_that_no_dbc_describes_are_named() {
    let folder = folder();
    let foreign = "(1.0) can0 777#00\n(1.1) can0 777#00\n";
    let error = read(folder.path(), "other.log", foreign.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("but 777 (2 times); name the DBC of this bus"), "{error}");
    let (_, content) = logs().into_iter().find(|(name, _)| *name == "drive.log").unwrap();
    let both = [content.as_slice(), foreign.as_bytes()].concat();
    let said = said(&read(folder.path(), "both.log", &both).unwrap());
    assert!(said.iter().any(|text| text.contains("left aside: 777 (2 times)")), "{said:?}");
    assert!(said.iter().any(|text| text.contains("motor.dbc`, the only DBC beside the log")), "{said:?}");
    let deltas: String =
        (0..40).map(|row| format!("(000.00{}) can0 101#0000000000000000\n", 2 + row % 2)).collect();
    let error = read(folder.path(), "deltas.log", deltas.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("record with `candump -L`"), "{error}");
    let error = read(folder.path(), "bare.log", b"can0  101   [2]  00 00\n").unwrap_err().to_string();
    assert!(error.contains("line 1: has no time; record with `candump -L`"), "{error}");
    let error = read(folder.path(), "odd.log", b"(1.0) can0 101#00\nhello\n(1.1) can0 101#00\n")
        .unwrap_err()
        .to_string();
    assert!(error.contains("line 2: is no frame as candump writes it"), "{error}");
}

#[test]
fn a_bag_without_definitions_is_read_where_the_type_is_known() {
    let folder = folder();
    let path = folder.path().join("old.db3");
    logs::bag(&path, &[("std_msgs/msg/Float64", "/speed_rpm"), ("my_msgs/msg/State", "/state")], false);
    let data = open(path.to_str().unwrap());
    let error = data.map(drop).unwrap_err().to_string();
    // The unit of `data` is nowhere.
    assert!(error.contains("does not say the unit of `data`"), "{error}");
    let map = "[[clocks]]\ntime = \"log_time\"\nunit = \"ns\"\n[channels.speed]\nsignal = \"data\"\nunit = \"rad/s\"\n";
    let imported = import(&Selection::whole(&path), &Mapping::parse(map).unwrap()).unwrap();
    assert!(
        column(&imported.data, "speed_rad_s")
            .iter()
            .enumerate()
            .all(|(row, value)| *value == speed_rad_s(row))
    );
    let said = said(&imported.data);
    assert!(
        said.iter().any(|text| text
            .contains("topic `/state` is left aside: the bag has no definition of `my_msgs/msg/State`")),
        "{said:?}"
    );
    let other = folder.path().join("other.db");
    rusqlite::Connection::open(&other).unwrap().execute("CREATE TABLE t (x)", []).unwrap();
    let error = open(other.to_str().unwrap()).map(drop).unwrap_err().to_string();
    assert!(error.contains("is an SQLite database and no bag of ROS 2"), "{error}");
    // A view may compute rows without end.
    let endless = folder.path().join("endless.db3");
    let sql = "CREATE TABLE topics (id, name, type, serialization_format);
        CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT 1 topic_id, i timestamp, x'00' data FROM n;";
    rusqlite::Connection::open(&endless).unwrap().execute_batch(sql).unwrap();
    assert!(open(endless.to_str().unwrap()).map(drop).unwrap_err().to_string().contains("no bag of ROS 2"));
}
