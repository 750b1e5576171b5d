use socam_model::Model;
use socam_recording::{Channel, Steady, SteadyRow};

use super::*;

fn table(columns: &[&str], rows: &[&[f64]]) -> Steady {
    let channels = columns.iter().map(|name| Channel::from_column_name(name).unwrap()).collect();
    let row = |(k, values): (usize, &&[f64])| SteadyRow {
        point: k as f64,
        values: values.iter().map(|value| Some(*value).filter(|value| !value.is_nan())).collect(),
    };
    let rows = rows.iter().enumerate().map(row).collect();
    Steady { name: "points.csv".into(), channels, rows, warnings: Vec::new() }
}

const COLUMNS: [&str; 4] = ["motor_speed_rad_s", "output_speed_rad_s", "torque_in_Nm", "torque_out_Nm"];

fn diagnosed(rows: &[&[f64]]) -> Diagnosis {
    let model = Model::builtin("speed-o-cam").unwrap();
    diagnose_steady(&model, &[table(&COLUMNS, rows)], SteadyOptions::default()).unwrap().0
}

#[test]
fn a_bench_without_losses_is_adequate_and_its_bearing_is_determined() {
    let row = |speed: f64| vec![speed, speed / 8.0, 0.05 * speed / 64.0, 0.05 * speed / 8.0];
    let rows = [row(50.0), row(100.0), row(150.0), row(-80.0)];
    let diagnosis = diagnosed(&rows.iter().map(Vec::as_slice).collect::<Vec<_>>());
    assert_eq!(diagnosis.verdict, Verdict::Adequate, "{:?}", diagnosis.findings);
    let c5 = diagnosis.parameters.iter().find(|one| one.name == "c5").unwrap();
    assert!((c5.after.unwrap() - 0.05).abs() < 1e-6 && c5.identifiable);
    let loss = diagnosis.not_found.iter().find(|one| one.effect == "mesh_loss").unwrap();
    assert!((1e-3..2e-2).contains(&loss.smallest_detectable.unwrap()), "{loss:?}");
}

#[test]
fn drag_that_does_not_grow_with_torque_is_told_from_a_loss() {
    // Drag of 0.3 N m in front of the reducer at every speed and torque.
    let row = |speed: f64, load: f64| vec![speed, speed / 8.0, load / 8.0 + 0.3, load];
    let rows = [row(50.0, 1.0), row(100.0, 2.0), row(150.0, 4.0), row(120.0, 0.5)];
    let diagnosis = diagnosed(&rows.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let found = &diagnosis.findings.iter().find(|one| one.location == "cam_bearing").unwrap();
    assert_eq!(found.effect, "coulomb_friction");
    assert!((found.parameters[0].value.unwrap() - 0.3).abs() < 1e-6, "{:?}", found.parameters);
    // With one direction and one sign, an offset of either sensor explains the difference as well.
    assert!(
        found.rivals.iter().all(|rival| rival.effect == "sensor_offset") && found.rivals.len() == 2,
        "{:?}",
        found.rivals
    );
}

#[test]
fn points_without_a_reading_are_passed_over() {
    let missing = f64::NAN;
    let rows: [&[f64]; 4] = [
        &[50.0, 6.3, missing, 1.0],
        &[100.0, 12.6, 0.2, missing],
        &[missing, 18.9, 0.3, 3.0],
        &[150.0, 18.9, missing, missing],
    ];
    let diagnosis = diagnosed(&rows);
    let found = &diagnosis.findings.iter().find(|one| one.location == "output_speed").unwrap();
    assert_eq!(found.effect, "sensor_gain");
    assert!((found.parameters[0].value.unwrap() - 1.008).abs() < 1e-6);
}
