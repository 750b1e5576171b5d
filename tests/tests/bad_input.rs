//! Bad input: one clear sentence that names the place and what was expected, the promised exit code, and nothing left behind.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use socam_tests::bench::BENCH;
use socam_tests::{Ran, program, run, skip};
use tempfile::TempDir;

const FAILED: i32 = 1;
const WRONG_ARGUMENTS: i32 = 2;

/// A folder of its own for one test.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    /// Writes a file, and gives its path.
    fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        fs::write(self.0.path().join(name), content).unwrap();
        self.path(name)
    }

    fn names(&self) -> Vec<PathBuf> {
        let mut names: Vec<_> =
            fs::read_dir(self.0.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
        names.sort();
        names
    }

    /// Runs a command that must refuse with `code`, mention all of `mentions`, and leave the folder as it was.
    #[track_caller]
    fn refuses(&self, code: i32, arguments: &[&str], mentions: &[&str]) {
        let before = self.names();
        let ran = run(arguments);
        let sentence = ran.refusal(code);
        for mention in mentions {
            assert!(sentence.contains(mention), "{arguments:?} does not mention `{mention}`: {sentence}");
        }
        assert_eq!(self.names(), before, "{arguments:?} left something behind");
    }
}

/// A short recording of the bench.
fn csv() -> String {
    BENCH.csv(0.2, 1)
}

#[test]
fn a_bad_recording_is_refused_by_every_command_with_its_line() {
    let folder = Folder::new();
    let header = "t_s,motor_speed_rad_s,torque_in_Nm\n";
    let table = |rows: &str| format!("{header}{rows}").into_bytes();
    let cases: [(&str, Vec<u8>, &[&str]); 12] = [
        ("empty.csv", vec![], &["empty", "0 bytes"]),
        ("empty.mcap", vec![], &["empty", "0 bytes"]),
        ("photo.csv", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec(), &["expected an .mcap log"]),
        ("photo.mcap", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec(), &["expected an .mcap log"]),
        (
            "header.csv",
            b"time,speed\n0,1\n0.1,2\n".to_vec(),
            &["does not say the unit of `speed`", "--propose"],
        ),
        (
            "units.csv",
            b"t_s,motor_speed,torque_in\n0,1,2\n1,2,3\n".to_vec(),
            &["the unit of `motor_speed`", "--propose"],
        ),
        ("only_header.csv", table(""), &["no samples"]),
        ("back.csv", table("0,1,2\n0.001,1,2\n0.0005,1,2\n"), &["line 4", "0.001 s", "0.0005 s", "increase"]),
        ("nan.csv", table("0,1,2\n0.001,NaN,2\n"), &["line 3", "`motor_speed_rad_s`", "`NaN`", "finite"]),
        ("word.csv", table("0,1,2\n0.001,1,high\n"), &["line 3", "`torque_in_Nm`", "`high`", "number"]),
        ("cut.csv", table("0,1,2\n0.001,1"), &["line 3", "2 cells", "names 3"]),
        ("comma.csv", table("0,0,1,0,2,0\n"), &["line 2", "6 cells", "comma"]),
    ];
    for (name, content, mentions) in cases {
        let file = folder.file(name, content);
        let mentions = [&[name], mentions].concat();
        folder.refuses(FAILED, &["info", &file], &mentions);
        folder.refuses(FAILED, &["check", &file], &mentions);
        folder.refuses(FAILED, &["identify", &file], &mentions);
        folder.refuses(FAILED, &["import", &file, "-o", &folder.path("new.mcap")], &mentions);
        folder.refuses(FAILED, &["export", &file, "-o", &folder.path("new.csv")], &mentions);
    }
}

#[test]
fn a_log_cut_before_its_first_sample_is_refused() {
    let folder = Folder::new();
    let whole = folder.path("whole.mcap");
    let csv = folder.file("run.csv", csv());
    let _ = run(["import", &csv, "-o", &whole]).done();
    let bytes = fs::read(&whole).unwrap();
    for length in [1, 7, 8, 20, 300] {
        let cut = folder.file("cut.mcap", &bytes[..length]);
        folder.refuses(FAILED, &["info", &cut], &["cut.mcap"]);
        folder.refuses(FAILED, &["export", &cut, "-o", &folder.path("new.csv")], &["cut.mcap"]);
    }
}

#[test]
fn what_is_no_file_is_refused() {
    let folder = Folder::new();
    let absent = folder.path("absent.mcap");
    let directory = folder.path("");
    for command in ["info", "check", "identify", "import", "export"] {
        folder.refuses(FAILED, &[command, &absent], &["absent.mcap", "no such file"]);
        folder.refuses(FAILED, &[command, &directory], &["directory", "name one recording"]);
    }
}

#[test]
fn a_file_without_permission_is_refused() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    let file = folder.file("secret.csv", csv());
    fs::set_permissions(&file, fs::Permissions::from_mode(0o000)).unwrap();
    if fs::read(&file).is_ok() {
        skip("permissions do not bind this user (root)");
        return;
    }
    folder.refuses(FAILED, &["info", &file], &["secret.csv", "permission denied"]);
}

#[test]
fn a_bad_selection_is_refused() {
    let folder = Folder::new();
    let file = folder.file("run.csv", csv());
    for (selection, mentions) in
        [("@0.1..0.05", ["@0.1..0.05", "RUN@FROM..TO"]), ("@a..b", ["@a..b", "RUN@FROM..TO"])]
    {
        folder.refuses(WRONG_ARGUMENTS, &["info", &format!("{file}{selection}")], &mentions);
    }
    folder.refuses(FAILED, &["info", &format!("{file}@5..6")], &["run.csv", "no samples"]);
}

#[test]
fn a_bad_model_is_refused_with_its_line() {
    let folder = Folder::new();
    let run = folder.file("run.csv", csv());
    // A bar on a motor, with `line` in its parameters' place.
    let bar = |inertia: &str, line: &str| {
        let head = "schema = \"socam.model/1\"\nname = \"bar\"\nmotion = \"rotation\"\n\n[parameters]";
        let inertia = format!("J = {{ value = {inertia}, unit = \"kg m2\" }}");
        let node = "[[nodes]]\nname = \"bar\"\ninertia = \"J\"";
        let input = "[channels.torque_in]\nrole = \"input\"\nquantity = \"torque\"\nat = \"bar\"";
        let output = "[channels.motor_speed]\nrole = \"output\"\nquantity = \"speed\"\nat = \"bar\"";
        [head, &inertia, line, node, input, output].join("\n")
    };
    let cases: [(&str, String, &[&str]); 6] = [
        (
            "key.toml",
            bar("0.1", "[[nodes]]\nname = \"hub\"\ncolour = \"red\""),
            &["line 9", "`colour`", "expected"],
        ),
        ("word.toml", bar("0.1", "K = \"stiff\""), &["line 7", "\"stiff\"", "expected"]),
        ("negative.toml", bar("-0.1", ""), &["J", "-0.1"]),
        ("unit.toml", bar("0.1, unit2 = 3", ""), &["line 6", "unit2"]),
        ("empty.toml", String::new(), &["schema"]),
        ("photo.toml", "\u{1}\u{2}PNG".into(), &["line 1"]),
    ];
    for (name, content, mentions) in cases {
        let model = folder.file(name, content);
        folder.refuses(FAILED, &["identify", &run, "--model", &model], &[&[name], mentions].concat());
    }
    folder.refuses(FAILED, &["identify", &run, "--model", &run], &["run.csv", "line 1"]);
}

#[test]
fn wrong_arguments_are_refused() {
    let folder = Folder::new();
    let run = folder.file("run.csv", csv());
    let identify = |option: &'static str, value: &'static str, mentions: &[&str]| {
        folder.refuses(WRONG_ARGUMENTS, &["identify", &run, option, value], mentions);
    };
    identify("--model", "speed-o-cog", &["speed-o-cog", "speed-o-cam"]);
    identify("--fix", "k9=3", &["k9", "k1, k2, k3"]);
    identify("--fix", "k1=soft", &["k1=soft", "number"]);
    identify("--set", "k1=inf", &["k1=inf", "number"]);
    identify("--noise", "torque_in=-1", &["torque_in=-1", "positive number"]);
    identify("--method", "magic", &["magic", "output-error"]);
    for (band, mentions) in [
        ("2-80", &["2-80", "LOW..HIGH"][..]),
        ("80..2", &["80 to 2 Hz", "below its upper end"]),
        ("2..501", &["501 Hz", &run, "500 Hz"]),
    ] {
        let (train, test) = (format!("{run}@0..0.08"), format!("{run}@0.1..0.2"));
        let arguments = ["identify", &train, "--validate", &test, "--band", band];
        folder.refuses(WRONG_ARGUMENTS, &arguments, mentions);
    }
    identify("--band", "2..80", &["--validate"]);
    identify("--starts", "0", &["--starts", "0"]);
    identify("--no-such-option", "1", &["--no-such-option"]);
    folder.refuses(WRONG_ARGUMENTS, &[], &["no command", "identify", "--help"]);
    folder.refuses(WRONG_ARGUMENTS, &["identfy"], &["identfy", "identify"]);
    folder.refuses(WRONG_ARGUMENTS, &["info"], &["<RUN>"]);
    folder.refuses(WRONG_ARGUMENTS, &["completions", "cmd.exe"], &["cmd.exe", "bash"]);
    folder.refuses(WRONG_ARGUMENTS, &["export", &run, "--format", "xls"], &["xls", "csv"]);
}

#[test]
fn an_output_that_cannot_be_written_leaves_nothing() {
    let folder = Folder::new();
    let run = folder.file("run.csv", csv());
    let nowhere = folder.path("absent/new.mcap");
    folder.refuses(FAILED, &["import", &run, "-o", &nowhere], &["new.mcap", "folder does not exist"]);
    let nowhere = folder.path("absent/new.csv");
    folder.refuses(FAILED, &["export", &run, "-o", &nowhere], &["new.csv", "folder does not exist"]);
    folder.refuses(FAILED, &["import", &run, "-o", &folder.path("")], &["directory"]);
    let below_a_file = format!("{run}/new.mcap");
    folder.refuses(
        FAILED,
        &["import", &run, "-o", &below_a_file],
        &["new.mcap", "a part of its path is a file"],
    );
}

#[test]
fn a_file_that_is_there_is_replaced_only_by_force() {
    let folder = Folder::new();
    let run = folder.file("run.csv", csv());
    let folders = ["page", "bench"];
    folders.iter().for_each(|name| fs::create_dir(folder.path(name)).unwrap());
    let theirs = [
        ("bench/model.toml", vec!["diagnose", &run, "--model", "emps", "--report", "bench"]),
        #[cfg(feature = "full")]
        ("page/index.html", vec!["thesis", "--report", "page"]),
        ("page/index.html", vec!["compare", &run, &run, "--report", "page"]),
        ("page/index.html", vec!["diagnose", &run, "--model", "emps", "--report", "page"]),
        ("page/index.html", vec!["identify", &run, "--model", "emps", "--method", "frf", "--report", "page"]),
        ("mine.csv", vec!["simulate", "--profile", "steps", "--duration", "1s", "-o", "mine.csv"]),
        ("mine.csv", vec!["simulate", "--input", &run, "--model", "emps", "-o", "mine.csv"]),
        ("mine.toml", vec!["design", "--model", "emps", "--duration", "1s", "-o", "mine.toml"]),
        ("mine.svg", vec!["efficiency", &run, "--map", "mine.svg"]),
        ("mine.svg", vec!["calibrate", &run, "--plot", "mine.svg"]),
        #[cfg(feature = "full")]
        ("mine.html", vec!["fleet", ".", "--model", "emps", "-o", "fleet.parquet", "--report", "mine.html"]),
        #[cfg(feature = "full")]
        ("mine.png", vec!["dashboard", &run, "--screenshot", "mine.png"]),
    ];
    for (target, arguments) in theirs {
        let path = folder.file(target, "written by hand");
        let at = |word: &str| {
            if word == target || folders.contains(&word) { folder.path(word) } else { word.to_owned() }
        };
        let arguments: Vec<String> = arguments.into_iter().map(at).collect();
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        folder.refuses(FAILED, &arguments, &[target, "exists already", "--force"]);
        assert_eq!(fs::read_to_string(&path).unwrap(), "written by hand");
    }
    let target = folder.path("mine.csv");
    let arguments = ["simulate", "--profile", "steps", "--duration", "1s", "-o", &target, "--force"];
    let _ = socam_tests::run(arguments).done();
    assert!(fs::read_to_string(&target).unwrap().starts_with("t_s,"));
}

#[test]
fn what_cannot_be_flashed_is_refused() {
    let folder = Folder::new();
    let drive = folder.path("");
    folder.file("INFO_UF2.TXT", "Board-ID: RPI-RP2");
    let flash = |image: &str, mentions: &[&str]| {
        folder.refuses(FAILED, &["flash", image, "--drive", &drive], mentions);
    };
    flash(&folder.file("notes.txt", "an idea"), &["notes.txt", "no whole ELF file", "cargo build"]);
    flash(
        &folder.file("cut.uf2", [b"UF2\n".as_slice(), &[0; 600]].concat()),
        &["cut.uf2", "block 0 is damaged"],
    );
    flash(&folder.path("absent"), &["absent"]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_said() {
    let folder = Folder::new();
    let run = folder.file("run.csv", csv());
    for command in ["import", "export"] {
        folder.refuses(FAILED, &[command, &run, "-o", "/dev/full"], &["/dev/full", "disk is full"]);
    }
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let ran: Ran = socam_tests::socam_host().args(["info", &run]).stdout(full).output().unwrap().into();
    assert!(ran.refusal(FAILED).contains("cannot write to stdout"), "{ran:?}");
}

/// A disk that fills up half way is simulated: the shell lets no file grow beyond 8 KiB.
#[test]
#[cfg(unix)]
fn a_file_that_cannot_grow_is_not_left_half_written() {
    let folder = Folder::new();
    let run = folder.file("run.csv", BENCH.csv(1.0, 1));
    for (command, target) in [("import", "new.mcap"), ("export", "new.csv")] {
        let target = folder.path(target);
        let before = folder.names();
        let arguments =
            [program().as_os_str(), command.as_ref(), run.as_ref(), "-o".as_ref(), target.as_ref()];
        let ran = limited(&arguments);
        let sentence = ran.refusal(FAILED);
        assert!(sentence.contains(&target), "{sentence}");
        assert_eq!(folder.names(), before);
        assert!(!Path::new(&target).exists());
    }
}

#[cfg(unix)]
fn limited(command: &[&OsStr]) -> Ran {
    // With the signal ignored, passing the limit is an error like any other.
    let script = "trap '' XFSZ; ulimit -f 16; exec \"$@\"";
    Command::new("sh").args(["-c", script, "sh"]).args(command).output().unwrap().into()
}

#[test]
#[cfg_attr(not(feature = "full"), ignore = "full tier")]
fn a_model_that_cannot_be_exported_is_refused_in_one_sentence() {
    let folder = Folder::new();
    let nowhere = folder.path("nowhere.toml");
    let run_csv = folder.file("run.csv", csv());
    let taken = folder.file("taken.py", "mine = 1\n");
    let model = include_str!("../models/drive.toml");
    let good = folder.file("drive.toml", model);
    let wave =
        model.replace("quantity = \"torque\"\nat = \"motor\"", "quantity = \"angle\"\nat = \"coupling\"");
    let wave = folder.file("wave.toml", wave.replace("motor_torque", "mesh"));
    let to = |model: &str, target: &str, name: &str| {
        ["export-model", model, "--to", target, "-o", name].map(str::to_owned)
    };
    let cases: [(i32, [String; 6], &[&str]); 8] = [
        (WRONG_ARGUMENTS, to(&nowhere, "python", &folder.path("new.py")), &["nowhere.toml", "two-mass"]),
        (FAILED, to(&run_csv, "python", &folder.path("new.py")), &["run.csv", "line 1"]),
        (WRONG_ARGUMENTS, to(&good, "adams", &folder.path("new.py")), &["adams", "mujoco"]),
        (FAILED, to(&good, "python", &taken), &["taken.py", "--force"]),
        (WRONG_ARGUMENTS, to(&good, "matlab", &folder.path("my bench.m")), &["my bench.m", "my_bench.m"]),
        (WRONG_ARGUMENTS, to(&good, "python", &good), &["over itself"]),
        (FAILED, to(&good, "python", &run_csv), &["run.csv", "exists already"]),
        (FAILED, to(&wave, "mujoco", &folder.path("new.xml")), &["MuJoCo cannot hold the motion", "mesh"]),
    ];
    for (code, arguments, mentions) in cases {
        folder.refuses(code, &arguments.each_ref().map(String::as_str), mentions);
    }
    assert_eq!(fs::read_to_string(&taken).unwrap(), "mine = 1\n");
}
