//! The table of a fleet as a picture.

use socam_fleet::{FleetOptions, Row, row, table};
use socam_model::Model;

use super::{Args, Outcome, run};

#[derive(clap::Parser)]
struct Command {
    #[command(flatten)]
    args: Args,
}

fn of_machine(number: u32) -> Row {
    Row {
        id: number.to_string(),
        recording: format!("SN{number}/run.mcap"),
        machine: Some(format!("SN{number}")),
        date: None,
        status: row::Status::Ok,
        message: String::new(),
        stage: row::Stage::ScoreTest,
        verdict: Some(row::Verdict::Adequate),
        p_value: Some(0.5),
        excess: Some(1.0),
        samples: Some(10),
        duration_s: Some(1.0),
        findings: Vec::new(),
        parameters: Vec::new(),
        channels: Vec::new(),
        warnings: Vec::new(),
        model: "two-mass".into(),
        version: "0.1.0".into(),
    }
}

#[test]
fn a_table_is_drawn_and_one_that_is_cut_off_fails_with_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let about = table::About::new(&Model::builtin("two-mass").unwrap(), &FleetOptions::default(), 1);
    table::write(&path("fleet.parquet"), &about, (1..4).map(|number| Ok(of_machine(number)))).unwrap();
    let draw = |table: &str, picture: &str| {
        let [table, picture] = [table, picture].map(|name| path(name).display().to_string());
        let command: Command = clap::Parser::parse_from(["", &table, "--screenshot", &picture]);
        run(command.args)
    };
    assert!(matches!(draw("fleet.parquet", "fleet.png").unwrap(), Outcome::Done));
    assert!(std::fs::read(path("fleet.png")).unwrap().starts_with(b"\x89PNG"));

    let whole = std::fs::read(path("fleet.parquet")).unwrap();
    std::fs::write(path("cut.parquet"), &whole[..whole.len() - 100]).unwrap();
    let problem = draw("cut.parquet", "cut.png").err().map(|error| error.to_string()).unwrap();
    assert!(problem.contains("cut.parquet") && !problem.contains('\n'), "{problem}");
    assert!(!path("cut.png").exists());
}
