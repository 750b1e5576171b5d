//! A column has the same meaning in every text dialect and container, and parts that are left out are listed.

mod tables;

use std::path::Path;

use socam_import::{ImportError, open};
use socam_recording::{Dataset, Warning};

const ROWS: usize = 400;

/// A wave of quarters, which every dialect writes exactly.
fn wave(slope: u32) -> Vec<f64> {
    (0..ROWS).map(|row| f64::from((row as u32 * slope) % 97) / 4.0 - 12.0).collect()
}

fn times(step: f64) -> Vec<f64> {
    (0..ROWS).map(|row| step * row as f64 / 1000.0).collect()
}

fn table() -> Vec<tables::Column> {
    vec![
        ("t_s", times(1.0)),
        ("command_V", wave(3)),
        ("motor_speed_rad_s", wave(5)),
        ("torque_in_mNm", wave(7)),
        ("speed_deg_per_s", wave(11)),
        ("position_deg", wave(13)),
        ("position_rad", wave(17)),
        ("Load_speed_rpm", wave(19)),
        ("Winding temperature [degC]", wave(23)),
        ("u_m", wave(29)),
        ("gain_1", wave(31)),
        ("bias_A", vec![0.0; ROWS]),
        ("pair_N_m", wave(37)),
        ("enabled", wave(41)),
        ("rate_ticks_per_s", wave(43)),
        ("stamp_ms", times(1000.0)),
    ]
}

/// Names of a recording's columns, sorted, with their values.
fn contents(data: &Dataset) -> Vec<(String, Vec<f64>)> {
    let loaded = data.load_all().unwrap();
    let columns = loaded.columns.iter().map(|column| column.values().to_vec());
    let names = data.channels().iter().map(socam_recording::Channel::column_name);
    let mut contents: Vec<_> =
        names.zip(columns).chain([("t_s".to_owned(), loaded.time_s.clone())]).collect();
    contents.sort_by(|a, b| a.0.cmp(&b.0));
    contents
}

fn warnings(data: &Dataset) -> Vec<String> {
    let mut warnings: Vec<String> = data.warnings().iter().map(Warning::to_string).collect();
    warnings.sort_unstable();
    warnings
}

#[test]
fn one_table_holds_the_same_channels_in_every_dialect_and_container() {
    let folder = tempfile::tempdir().unwrap();
    let paths = tables::write_all(folder.path(), &table());
    let native = open(paths[0].to_str().unwrap()).unwrap();
    let names = [
        "Load_speed_rad_s",
        "bias_A",
        "command_V",
        "gain_1",
        "motor_speed_rad_s",
        "pair_N_m",
        "position_2_rad",
        "position_rad",
        "speed_rad_s",
        "t_s",
        "torque_in_Nm",
        "u_m",
        "winding_temperature_K",
    ];
    let truth = contents(&native);
    assert_eq!(truth.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), names);
    let value = |name: &str| truth.iter().find(|(own, _)| own == name).unwrap().1[1];
    assert_eq!((value("command_V"), value("bias_A")), (-11.25, 0.0));
    assert!((value("torque_in_Nm") + 10.25e-3).abs() < 1e-15);
    assert!((value("Load_speed_rad_s") + 7.25 * std::f64::consts::TAU / 60.0).abs() < 1e-12);
    assert!((value("winding_temperature_K") - (273.15 - 6.25)).abs() < 1e-12);
    let said = warnings(&native);
    for column in ["enabled", "rate_ticks_per_s", "stamp_ms", "pair_N_m"] {
        assert_eq!(said.iter().filter(|text| text.contains(&format!("`{column}`"))).count(), 1, "{said:?}");
    }
    for path in &paths[1..] {
        let name = path.file_name().unwrap().to_string_lossy();
        let data = open(path.to_str().unwrap()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let found = contents(&data);
        assert_eq!(found.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), names, "{name}");
        for ((column, found), (_, truth)) in found.iter().zip(&truth) {
            let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-12 * b.abs().max(1.0);
            assert!(found.len() == ROWS && found.iter().zip(truth).all(is_near), "{column} of {name}");
        }
        assert_eq!(warnings(&data), said, "{name}");
    }
}

fn opened(folder: &Path, content: &str) -> Result<Dataset, ImportError> {
    let path = folder.join("log.csv");
    std::fs::write(&path, content).unwrap();
    open(path.to_str().unwrap())
}

#[test]
fn a_letter_that_may_be_an_index_is_read_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let data = opened(folder.path(), "time_s;u_m;x_Nm\n0;1;2\n1;2;3\n2;3;5\n").unwrap();
    assert_eq!(data.channels().iter().map(|c| c.column_name()).collect::<Vec<_>>(), ["u_m", "x_Nm"]);
    let said = warnings(&data);
    assert!(said.len() == 1 && said[0].contains("`u_m` in m") && !said[0].contains("x_Nm"), "{said:?}");
}

#[test]
fn nothing_is_lost_without_a_word() {
    let folder = tempfile::tempdir().unwrap();
    let data = opened(
        folder.path(),
        "time [s],Torque [Nm],speed_deg_per_s,clock_ms,state,void [V],note\n\
         0,0,1,5,7,,a\n1,0,2,6,7,,b\n2,0,4,7,7,,c\n",
    )
    .unwrap();
    assert_eq!(
        data.channels().iter().map(|c| c.column_name()).collect::<Vec<_>>(),
        ["torque_Nm", "speed_rad_s"]
    );
    let said = warnings(&data);
    for column in ["clock_ms", "state", "note", "void [V]"] {
        assert!(said.iter().any(|text| text.contains(&format!("`{column}`"))), "{column}: {said:?}");
    }
    // A rate of counts is no time, and is asked for.
    let refused = opened(folder.path(), "time_s,torque_Nm,vel_counts_s\n0,1,1\n1,2,5\n2,4,7\n").unwrap_err();
    assert!(
        refused.to_string().contains("the unit of `vel_counts_s`, which the file calls \"counts/s\""),
        "{refused}"
    );
}
