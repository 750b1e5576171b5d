//! `fleet`: a small fleet as a user runs it: at once, in shards, killed and resumed.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;

use socam_fleet::{Frozen, Row, Source, Table, diagnose_one, row::Status};
use socam_model::Model;
use socam_recording::{ProfileFile, export_csv};
use socam_sim::{FleetPlan, VirtualFleet};
use socam_tests::{Ran, run, socam_host};
use tempfile::TempDir;

/// Five machines of two dates, one of them with friction; a cut and an empty file; a recording of another bench.
struct Fleet {
    folder: TempDir,
    /// The table of a plain run, and what it said.
    whole: Vec<u8>,
    summary: serde_json::Value,
}

const FAULT: &str = "coulomb_friction@load_bearing:torque=0.05";

fn fleet() -> &'static Fleet {
    static FLEET: OnceLock<Fleet> = OnceLock::new();
    FLEET.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let plan = FleetPlan {
            model: Model::builtin("two-mass").unwrap(),
            machines: 5,
            dates: 2,
            spread: 0.05,
            faults: vec![FAULT.parse().unwrap()],
            faulty_share: 0.2,
            wear: Vec::new(),
            worn_share: 0.0,
            seed: 6,
        };
        let drawn = VirtualFleet::draw(&plan);
        let profile =
            ProfileFile { duration_s: 3.0, ..ProfileFile::open("multisine").unwrap() }.profile(1000).unwrap();
        let path = |name: &str| folder.path().join("all").join(name);
        for (number, machine) in drawn.machines.iter().enumerate() {
            std::fs::create_dir_all(path(&machine.serial)).unwrap();
            for date in 0..2 {
                let data = drawn.record(number, date, &profile, 1000).unwrap();
                let name = format!("{}/2026-0{}-01.csv", machine.serial, date + 1);
                export_csv(&data, &path(&name)).unwrap();
            }
        }
        let healthy = drawn.machines.iter().find(|machine| machine.fault.is_none()).unwrap();
        std::fs::copy(path(&format!("{}/2026-01-01.csv", healthy.serial)), folder.path().join("healthy.csv"))
            .unwrap();
        std::fs::write(path("SN00001/empty.csv"), "").unwrap();
        std::fs::write(path("SN00002/cut.mcap"), b"\x89MCAP0\r\n\x01").unwrap();
        std::fs::write(path("other.csv"), "t_s,position_m\n0,1\n0.1,2\n0.2,1\n").unwrap();
        let mut fleet = Fleet { folder, whole: Vec::new(), summary: serde_json::Value::Null };
        let (output, page) = (fleet.path("whole.parquet"), fleet.path("page.html"));
        let reference = fleet.path("healthy.csv");
        let written = fleet.path("reference.toml");
        let arguments = [
            "--jobs",
            "2",
            "--reference",
            &reference,
            "--write-reference",
            &written,
            "--report",
            &page,
            "--json",
        ];
        fleet.summary = run(fleet.arguments(&output).into_iter().chain(arguments.map(str::to_owned))).json();
        fleet.whole = std::fs::read(&output).unwrap();
        fleet
    })
}

impl Fleet {
    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    fn arguments(&self, output: &str) -> Vec<String> {
        let all = self.path("all");
        ["fleet", &all, "--model", "two-mass", "-o", output].map(str::to_owned).to_vec()
    }

    fn with_reference(&self, output: &str, more: &[&str]) -> Vec<String> {
        let mut arguments = self.arguments(output);
        arguments.extend(["--reference".to_owned(), self.path("reference.toml")]);
        arguments.extend(more.iter().map(|text| (*text).to_owned()));
        arguments
    }

    fn rows(&self) -> Vec<Row> {
        Table::open(Path::new(&self.path("whole.parquet"))).unwrap().map(Result::unwrap).collect()
    }
}

#[test]
fn a_fleet_is_a_table_of_which_bad_input_is_a_part() {
    let fleet = fleet();
    let counts = &fleet.summary["counts"];
    assert_eq!(fleet.summary["schema"], "socam.fleet-summary/1");
    assert_eq!((&counts["recordings"], &counts["adequate"]), (&13.into(), &8.into()), "{counts}");
    // Both dates of the one machine with friction.
    assert_eq!(counts["missing_physics"], 2, "{counts}");
    let (unreadable, unfit) = (&counts["unreadable"], &counts["unfit"]);
    assert_eq!((unreadable, unfit, &counts["failed"]), (&2.into(), &1.into(), &0.into()), "{counts}");
    let faulty = fleet.summary["faulty"].as_array().unwrap();
    assert_eq!(faulty.len(), 1, "{faulty:?}");
    assert!(faulty[0]["findings"].to_string().contains("coulomb_friction@"), "{faulty:?}");
    let rows = fleet.rows();
    let row = |name: &str| rows.iter().find(|row| row.recording == name).unwrap();
    assert_eq!(row("SN00001/empty.csv").status, Status::Unreadable);
    assert!(
        row("SN00002/cut.mcap").message.contains("SN00002/cut.mcap"),
        "{}",
        row("SN00002/cut.mcap").message
    );
    assert!(row("other.csv").message.contains("motor_torque"), "{}", row("other.csv").message);
    let good = row("SN00001/2026-02-01.csv");
    assert_eq!((good.machine.as_deref(), good.date), (Some("SN00001"), Some(1_769_904_000_000)));
    // Nothing of this computer is in the table.
    let place = fleet.folder.path().display().to_string();
    assert!(rows.iter().all(|row| !format!("{row:?}").contains(&place)));
    // Each machine of a list is a click away.
    let page = std::fs::read_to_string(fleet.path("page.html")).unwrap();
    let machine = faulty[0]["machine"].as_str().unwrap();
    assert!(page.contains(&format!("href=\"#machine-{machine}\"")), "no link to {machine}");
    assert!(page.contains(&format!("id=\"machine-{machine}\"")), "no section of {machine}");
}

#[test]
fn shards_and_the_library_give_the_rows_of_the_plain_run_to_the_byte() {
    let fleet = fleet();
    let parts = ["1/3", "2/3", "3/3"].map(|shard| {
        let part = fleet.path(&format!("part-{}.parquet", &shard[..1]));
        let jobs = if shard == "1/3" { "2" } else { "1" };
        let _ = run(fleet.with_reference(&part, &["--shard", shard, "--jobs", jobs])).done();
        part
    });
    let merged = fleet.path("merged.parquet");
    let _ = run(["fleet", "--merge", &parts[1], &parts[2], &parts[0], "-o", &merged]).done();
    assert!(std::fs::read(&merged).unwrap() == fleet.whole, "the merged table differs from the plain one");
    // The core function on bytes, as other programs call it.
    let table = Table::open(Path::new(&merged)).unwrap();
    let (options, seed) = (table.about.options.clone(), table.about.seed);
    let frozen: Frozen =
        toml::from_str(&std::fs::read_to_string(fleet.path("reference.toml")).unwrap()).unwrap();
    let options = socam_fleet::FleetOptions { frozen: Some(frozen), ..options };
    let rows = fleet.rows();
    let model = Model::builtin("two-mass").unwrap();
    for row in [&rows[0], rows.iter().find(|row| !row.findings.is_empty()).unwrap()] {
        let bytes = std::fs::read(Path::new(&fleet.path("all")).join(&row.recording)).unwrap();
        assert_eq!(diagnose_one(&Source::bytes(&row.recording, bytes), &model, &options, seed), *row);
    }
}

/// A run with one job, once its part file has more than these bytes: a further row.
fn begun(fleet: &Fleet, output: &str, bytes: u64) -> Child {
    let mut command = socam_host();
    command.args(fleet.with_reference(output, &["--jobs", "1"]));
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let part = PathBuf::from(format!("{output}.part"));
    while part.metadata().map_or(0, |part| part.len()) <= bytes {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    child
}

#[test]
fn a_run_that_was_killed_or_interrupted_goes_on_to_the_same_bytes() {
    let fleet = fleet();
    let output = fleet.path("resumed.parquet");
    let mut child = begun(fleet, &output, 0);
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!Path::new(&output).exists());
    let part = PathBuf::from(format!("{output}.part"));
    let before = part.metadata().unwrap().len();
    // The crash cut the last row off.
    let torn = [std::fs::read(&part).unwrap(), vec![77; 5]].concat();
    std::fs::write(&part, &torn).unwrap();
    let child = begun(fleet, &output, torn.len() as u64);
    // The run may be finished when the signal arrives.
    let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let ran = Ran::from(child.wait_with_output().unwrap());
    assert!(matches!(ran.code, Some(0 | 1)), "{:?} {}", ran.code, ran.stderr);
    if ran.code == Some(1) {
        assert!(ran.stderr.contains("goes on from here"), "{}", ran.stderr);
        assert!(part.metadata().unwrap().len() >= before);
    }
    let _ = run(fleet.with_reference(&output, &[])).done();
    assert!(!part.exists());
    assert!(std::fs::read(&output).unwrap() == fleet.whole, "the resumed table differs");
    // All recordings are done, so the table is unchanged.
    let _ = run(fleet.with_reference(&output, &[])).done();
    assert!(std::fs::read(&output).unwrap() == fleet.whole, "the table changed without a new recording");
}

#[test]
fn what_is_no_fleet_is_refused_in_one_sentence() {
    let fleet = fleet();
    let out = fleet.path("refused.parquet");
    let healthy = fleet.path("healthy.csv");
    let empty = fleet.path("nothing");
    std::fs::create_dir_all(&empty).unwrap();
    let cases: [(&[&str], i32, &str); 5] = [
        (&["fleet", &healthy, "-o", &out], 1, "expected a folder, or a CSV list"),
        (&["fleet", &empty, "-o", &out], 2, "there is no recording in"),
        (&["fleet", "--merge", &healthy, "-o", &out], 1, "is no table of a fleet"),
        (&["fleet", &empty, "-o", &out, "--shard", "5/4"], 2, "expected I/N"),
        (&["fleet", &empty, "-o", &out, "--fdr", "2"], 2, "between 0 and 1"),
    ];
    for (arguments, code, sentence) in cases {
        let ran = run(arguments);
        assert_eq!(ran.code, Some(code), "{arguments:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(sentence), "{arguments:?}: {}", ran.stderr);
    }
}
