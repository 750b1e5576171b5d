//! A fleet, made up: tables of rows in files, because a machine's rows are read when it is looked at.

use std::path::{Path, PathBuf};

use socam_chart::theme::Look;
use socam_dashboard::Dashboard;
use socam_dashboard::platform::fleet::Opened;
use socam_dashboard::{Layout, View};
use socam_fleet::row::{Finding, Parameter, Stage, Status, Verdict};
use socam_fleet::{FleetOptions, Row, table};
use socam_model::Model;
use socam_workbench::job::Handle;

use super::Noise;

const DAY_MS: i64 = 86_400_000;
/// 2026-01-05
const FIRST_MS: i64 = 1_767_571_200_000;
const DATES: i64 = 6;
/// The machine with friction, with a stiffness that falls, and with an inertia of its own.
pub(crate) const RUBS: usize = 3;
pub(crate) const WEARS: usize = 11;
const HEAVY: usize = 17;
/// A name as long as people make them.
const LONG: &str = "Plant 2, hall B, line 14, cell 3, spindle drive left, rev. C";

pub(crate) fn machine(number: usize) -> String {
    if number == 5 { LONG.into() } else { format!("SN{number:03}") }
}

fn parameter(name: &str, unit: &str, value: f64, std: f64, determined: bool) -> Parameter {
    let half = 1.96 * std;
    let known = |value: f64| Some(value).filter(|_| determined);
    Parameter {
        name: name.into(),
        value: Some(value),
        std: known(std),
        low: known(value - half),
        high: known(value + half),
        unit: unit.into(),
        determined,
    }
}

fn finding(size: f64) -> Finding {
    Finding {
        effect: "coulomb_friction".into(),
        place: "load_bearing".into(),
        parameter: Some("torque".into()),
        size: Some(size),
        low: Some(size - 0.012),
        high: Some(size + 0.012),
        unit: "N m".into(),
        share: Some(0.2),
        material: true,
        log_score_gain: Some(30.0),
        log_score_std: Some(5.0),
        rivals: vec!["coulomb_friction@motor_bearing".into()],
        sentence: format!("Dry friction of {size:.3} N m acts in the load's bearing against every motion."),
    }
}

/// A recording of a machine: what it shows depends on which one it is.
fn row(noise: &mut Noise, number: usize, date: i64) -> Row {
    let day = FIRST_MS + date * 30 * DAY_MS;
    let at = jiff::Timestamp::from_millisecond(day).unwrap().strftime("%Y-%m-%d").to_string();
    let mut draw = |scale: f64| scale * noise.next();
    let p = 0.02 + 0.96 * (draw(1.0) + 0.5);
    let wear = if number == WEARS { 1.0 - 0.02 * date as f64 } else { 1.0 };
    let heavy = if number == HEAVY { 1.5 } else { 1.0 };
    let parameters = vec![
        parameter("motor.inertia", "kg m2", heavy * (1.2e-3 + draw(6e-5)), 1e-5, true),
        parameter(
            "shaft.stiffness",
            "N m/rad",
            wear * 120.0 + draw(0.4) + 0.5 * number as f64 % 3.0,
            0.4,
            true,
        ),
        parameter("load_bearing.damping", "N m s/rad", 0.02 + draw(1e-3), 4e-4, !number.is_multiple_of(4)),
        parameter("load.inertia", "kg m2", 3.1e-3 + draw(1e-4), 2e-5, true),
    ];
    Row {
        id: format!("{number:03}{date}"),
        recording: format!("{}/{at}.csv", machine(number)),
        machine: Some(machine(number)),
        date: Some(day),
        status: Status::Ok,
        message: String::new(),
        stage: Stage::ScoreTest,
        verdict: Some(Verdict::Adequate),
        p_value: Some(p),
        excess: Some(1.0 + draw(0.05)),
        samples: Some(5000),
        duration_s: Some(5.0),
        findings: Vec::new(),
        parameters,
        channels: Vec::new(),
        warnings: Vec::new(),
        model: "two-mass".into(),
        version: "0.1.0".into(),
    }
}

/// 24 machines with six recordings each: friction in one, a stiffness that falls in another, one that is heavier, one with something
/// unexplained, and recordings that cannot be used.
pub(crate) fn rows() -> Vec<Row> {
    let mut noise = Noise(31);
    let mut rows = Vec::new();
    for number in 0..24 {
        for date in 0..DATES {
            let mut row = row(&mut noise, number, date);
            if number == RUBS || (number == 5 && date > 3) {
                row.findings = vec![finding(0.04 + 0.01 * date as f64 + 0.004 * noise.next())];
                (row.verdict, row.stage) = (Some(Verdict::MissingPhysics), Stage::Diagnosis);
                (row.p_value, row.excess) = (Some(1e-9 * (date as f64 + 1.0)), Some(1.9));
            }
            if number == 20 {
                (row.verdict, row.stage) = (Some(Verdict::Unexplained), Stage::Diagnosis);
                (row.p_value, row.excess) = (Some(2e-6), Some(1.4));
            }
            if number == 8 && date == 2 {
                row.status = Status::Unfit;
                row.message =
                    "the motion is too slow to tell inertia from friction; record a profile with more acceleration".into();
                (row.verdict, row.p_value, row.excess) = (None, None, None);
                row.parameters.clear();
            }
            if number == 9 && date == 0 {
                row.warnings.push("3 samples of motor_speed are saturated".into());
            }
            rows.push(row);
        }
    }
    let mut lost = row(&mut noise, 1, 0);
    lost.recording = "SN001/cut off.mcap".into();
    (lost.status, lost.stage, lost.verdict) = (Status::Unreadable, Stage::Read, None);
    lost.message = "byte 7: the log ends within a record".into();
    (lost.p_value, lost.excess, lost.samples, lost.date) = (None, None, None, None);
    lost.parameters.clear();
    rows.push(lost);
    rows
}

/// Writes a table into a folder, and opens it.
pub(crate) fn written(folder: &Path, mut rows: Vec<Row>) -> PathBuf {
    std::fs::create_dir_all(folder).unwrap();
    let path = folder.join("fleet.parquet");
    let about = table::About::new(&Model::builtin("two-mass").unwrap(), &FleetOptions::default(), 1);
    rows.sort_by(|a, b| (&a.recording, &a.id).cmp(&(&b.recording, &b.id)));
    table::write(&path, &about, rows.into_iter().map(Ok)).unwrap();
    path
}

/// A table in a folder that stays: the window reads it later.
fn kept(name: &str, rows: Vec<Row>) -> PathBuf {
    let folder = option_env!("CARGO_TARGET_TMPDIR").map_or_else(std::env::temp_dir, PathBuf::from);
    written(&folder.join("socam-panels").join(name), rows)
}

pub(crate) fn showing(look: Look, name: &str) -> Dashboard {
    let rows = match name {
        "fleet-unfit" => unfit(),
        _ => rows(),
    };
    let mut dashboard = Dashboard::new(Layout { look, view: View::Fleet, ..Layout::default() });
    let opened = Opened::read(&kept(name, rows), &Handle::default()).unwrap();
    dashboard.show_fleet(opened);
    match name {
        "fleet-machine" => dashboard.views.fleet.select(&machine(WEARS)),
        "fleet-findings" => dashboard.views.fleet.select(LONG),
        _ => {}
    }
    dashboard
}

/// One machine without dates, none of whose recordings can be fitted.
fn unfit() -> Vec<Row> {
    let mut noise = Noise(7);
    let one = |date: i64, noise: &mut Noise| Row {
        status: Status::Unfit,
        stage: Stage::Check,
        message: "the channel load_speed is missing".into(),
        verdict: None,
        p_value: None,
        excess: None,
        date: None,
        parameters: Vec::new(),
        ..row(noise, 0, date)
    };
    (0..3).map(|date| one(date, &mut noise)).collect()
}
