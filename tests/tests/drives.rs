//! `record` of drives that follow a profile, as a process on a pseudo-terminal with a simulated drive behind it: what it does with them, and
//! that they come to rest whatever happens to it.

use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};
use socam_recording::Dataset;
use socam_sources::simulators::{Inertia, Mishap, MoteusSimulator, Motor};
use socam_tests::{Ending, Ran, assert_follows, path, run, socam_host};

/// A sine that reaches 10 rad/s, for 6 s.
const PROFILE: &str = "schema = \"socam.profile/1\"\ncommand = \"speed\"\nshape = \"sine\"\namplitude_rad_s = 10\nfrequency_Hz = 1\n\
    ramp_s = 0.5\nlimit_rad_s = 12\nslew_rad_s2 = 200\nduration_s = 6\n";
/// A torque whose sine reaches 0.04 N m at 4 Hz, and one that is as large and constant, for 6 s.
const TORQUES: &str = "schema = \"socam.profile/1\"\ncommand = \"torque\"\nshape = \"sine\"\namplitude_Nm = 0.04\nfrequency_Hz = 4\n\
    ramp_s = 0.5\nlimit_Nm = 0.05\nslew_Nm_s = 5\nduration_s = 6\n";
const CONSTANT: &str = "schema = \"socam.profile/1\"\ncommand = \"torque\"\nshape = \"constant\"\nlevel_Nm = 0.04\n\
    ramp_s = 0.5\nlimit_Nm = 0.05\nslew_Nm_s = 5\nduration_s = 6\n";
const LIMITS: [&str; 4] = ["--limit", "15rad/s", "--limit", "0.5Nm"];
const MODEL: &str = "schema = \"socam.model/1\"\nname = \"rotor\"\nmotion = \"rotation\"\n[parameters]\n\
    J = { value = 10, unit = \"kg cm2\", bounds = [0.1, 100] }\nc = { value = 1e-3, unit = \"N m s/rad\", bounds = [0, 0.1] }\n\
    f = { value = 5e-3, unit = \"N m\", bounds = [0, 1] }\n[[nodes]]\nname = \"motor\"\ninertia = \"J\"\n\
    [[bearings]]\nname = \"motor_bearing\"\nat = \"motor\"\ndamping = \"c\"\n\
    [[effects]]\neffect = \"coulomb_friction\"\nat = \"motor_bearing\"\nparameters = { torque = \"f\" }\n\
    [channels.torque]\nrole = \"input\"\nquantity = \"torque\"\nat = \"motor\"\n[channels.speed]\nrole = \"output\"\nquantity = \"speed\"\nat = \"motor\"\n";
/// Time after which the drive is at rest without its host, s: its watchdog's, and that of braking.
const AT_REST_S: f64 = 0.25 + 0.4;

/// A simulated moteus behind a pseudo-terminal, in real time.
struct Bench {
    folder: tempfile::TempDir,
    device: String,
    drive: Mutex<MoteusSimulator>,
    /// Bytes that arrived at the drive.
    arrived: Mutex<Vec<u8>>,
    is_over: AtomicBool,
    /// Whether the cable is pulled.
    is_cut: AtomicBool,
    begin: Instant,
}

impl Bench {
    /// Runs a test with a bench.
    fn with(test: impl FnOnce(&Self)) {
        let (line, theirs) = TTYPort::pair().unwrap();
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("profile.toml"), PROFILE).unwrap();
        let bench = Self {
            folder,
            device: format!("moteus:{}", theirs.name().unwrap()),
            drive: Mutex::new(MoteusSimulator::new(1, Motor::at_rest(Inertia::SMALL, 0.1))),
            arrived: Mutex::default(),
            is_over: AtomicBool::new(false),
            is_cut: AtomicBool::new(false),
            begin: Instant::now(),
        };
        std::thread::scope(|scope| {
            // Also where the test fails.
            let _ending = Ending(&bench.is_over);
            scope.spawn(|| bench.serve(line));
            test(&bench);
        });
        drop(theirs);
    }

    fn serve(&self, mut line: TTYPort) {
        line.set_timeout(Duration::from_millis(1)).unwrap();
        let mut line = Some(line);
        let mut bytes = [0; 4096];
        while !self.is_over.load(Ordering::Relaxed) {
            if self.is_cut.load(Ordering::Relaxed) {
                line = None;
                std::thread::sleep(Duration::from_millis(1));
            }
            let count = line.as_mut().and_then(|line| line.read(&mut bytes).ok()).unwrap_or(0);
            self.arrived.lock().unwrap().extend_from_slice(&bytes[..count]);
            let answer = self.drive.lock().unwrap().receive(self.now_s(), &bytes[..count]);
            if let Some(line) = &mut line {
                let _ = line.write_all(&answer);
            }
        }
    }

    fn now_s(&self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }

    fn path(&self, name: &str) -> String {
        path(&self.folder, name)
    }

    fn arguments(&self, more: &[&str]) -> Vec<String> {
        let (log, profile) = (self.path("run.mcap"), self.path("profile.toml"));
        let own = ["record", "-o", &log, "--device", &self.device, "--profile", &profile];
        own.iter().chain(more).map(|text| (*text).to_owned()).collect()
    }

    fn follows(&self, profile: &str) {
        std::fs::write(self.path("profile.toml"), profile).unwrap();
    }

    /// Starts the recorder, armed, and waits until the motor is fast.
    fn moving(&self) -> Child {
        self.faster_than(5.0)
    }

    fn faster_than(&self, speed_rad_s: f64) -> Child {
        let mut command = socam_host();
        command.args(self.arguments(&LIMITS)).arg("--arm").stdout(Stdio::piped()).stderr(Stdio::piped());
        let child = command.spawn().unwrap();
        self.until(20.0, |drive| drive.motor.speed_rad_s.abs() > speed_rad_s);
        child
    }

    /// Waits until something is true of the drive; returns the time that it took, s.
    fn until(&self, most_s: f64, mut is_true: impl FnMut(&MoteusSimulator) -> bool) -> f64 {
        let begin = Instant::now();
        while !is_true(&self.drive.lock().unwrap()) {
            assert!(begin.elapsed().as_secs_f64() < most_s, "{:?}", self.drive.lock().unwrap());
            std::thread::sleep(Duration::from_millis(1));
        }
        begin.elapsed().as_secs_f64()
    }

    /// The motor is at rest and stays there.
    fn is_at_rest_within(&self, most_s: f64) {
        let still = |drive: &MoteusSimulator| drive.mode != 10 && drive.motor.speed_rad_s.abs() < 0.2;
        self.until(most_s, still);
        std::thread::sleep(Duration::from_millis(300));
        let drive = self.drive.lock().unwrap();
        assert!(still(&drive), "{drive:?}");
    }

    fn recorded(&self) -> Dataset {
        Dataset::open(&self.path("run.mcap")).unwrap()
    }
}

fn ended(child: Child) -> Ran {
    Ran::from(child.wait_with_output().unwrap())
}

/// What a recording of a moteus that follows a profile gives, kg m2 and N m; `None` where it does not determine it.
fn inertia_and_friction() -> [Option<f64>; 2] {
    let mut found = [None; 2];
    Bench::with(|bench| {
        let arguments = bench.arguments(&LIMITS);
        let ran = run(arguments.iter().map(String::as_str).chain(["--arm", "--json"]));
        assert!(ran.code == Some(0) && ran.stdout.contains("\"end\": \"finished\""), "{ran:?}");
        assert!(
            ran.stderr.contains("largest torque of 0.5 N m")
                && ran.stderr.contains("it coasts, and a weight falls")
        );
        assert_eq!(bench.drive.lock().unwrap().mode, 0);
        assert_follows(&bench.recorded());
        let info = run(["info", "--json", &bench.path("run.mcap")]).stdout;
        assert!(info.contains("15 rad/s, 0.5 N m") && info.contains("profile.toml"), "{info}");

        let model = bench.path("model.toml");
        std::fs::write(&model, MODEL).unwrap();
        let fitted = run(["identify", &bench.path("run.mcap"), "--model", &model, "--json"]).json();
        let parameters = fitted["parameters"].as_array().unwrap();
        let value = |name: &str| parameters.iter().find(|one| one["name"] == name).unwrap()["value"].as_f64();
        found = [value("J"), value("f")];
    });
    found
}

/// A computer that is busy elsewhere delays commands and answers by so much that a recording may not determine both: it is taken again.
#[test]
fn a_moteus_follows_a_profile_and_its_recording_gives_its_inertia() {
    let mut found = (0..3).map(|_| inertia_and_friction());
    // 4 kg cm2 and a friction of 0.01 N m. Torques are sampled as commands arrive, before they act, so that the inertia comes out low.
    let [inertia, friction] = found
        .find_map(|[inertia, friction]| Some([inertia?, friction?]))
        .expect("three recordings determined nothing");
    assert!((3.3e-4..4.2e-4).contains(&inertia) && (friction - 0.01).abs() < 2e-3, "{inertia} {friction}");
}

#[test]
fn nothing_leaves_for_a_drive_that_is_not_armed_or_whose_profile_passes_its_limits() {
    Bench::with(|bench| {
        let model_of = |more: &[&str]| {
            let arguments = bench.arguments(more);
            run(arguments.iter().map(String::as_str))
        };
        for (more, sentence) in [
            (&LIMITS[..], "nothing was sent: add --arm to let the drive move"),
            (
                &["--limit", "9rad/s", "--limit", "0.5Nm", "--arm"],
                "reaches 10 rad/s, beyond the limit of 9 rad/s",
            ),
            (&["--limit", "15rad/s", "--arm"], "needs one --limit of its speed and one of its torque"),
            (
                &["--limit", "15rad/s", "--limit", "5A", "--arm"],
                "a moteus limits its torque, not its current",
            ),
            (
                &["--limit", "15rad/s", "--limit", "0.5Nm", "--arm", "--rate", "20"],
                "commanded at 50 Hz or faster",
            ),
        ] {
            let refused = model_of(more);
            assert!(refused.code == Some(2) && refused.stderr.contains(sentence), "{refused:?}");
        }
        let voltage =
            PROFILE.replace("\"speed\"", "\"voltage\"").replace("_rad_s2", "_V_s").replace("_rad_s", "_V");
        std::fs::write(bench.path("profile.toml"), voltage).unwrap();
        assert!(model_of(&LIMITS).refusal(2).contains("a drive takes speeds: `command = \"speed\"`"));
        assert!(bench.arrived.lock().unwrap().is_empty() && !Path::new(&bench.path("run.mcap")).exists());
        // Without a profile it is asked, and not commanded.
        let log = bench.path("asked.mcap");
        assert_eq!(
            run(["record", "-o", &log, "--device", &bench.device, "--duration", "500ms"]).code,
            Some(0)
        );
        let text = String::from_utf8(bench.arrived.lock().unwrap().clone()).unwrap();
        assert!(
            bench.drive.lock().unwrap().commands == 0 && text.lines().count() > 50 && !text.contains(" 0100")
        );
    });
}

#[test]
fn a_drive_whose_host_is_killed_is_at_rest_after_its_watchdogs_time() {
    Bench::with(|bench| {
        let mut child = bench.moving();
        // Long enough for the first second to be in the file.
        std::thread::sleep(Duration::from_millis(1200));
        bench.until(5.0, |drive| drive.motor.speed_rad_s.abs() > 5.0);
        child.kill().unwrap();
        bench.is_at_rest_within(AT_REST_S);
        assert_eq!(bench.drive.lock().unwrap().mode, 11);
        child.wait().unwrap();
    });
}

#[test]
fn a_cable_that_is_pulled_ends_the_run_and_keeps_the_recording() {
    Bench::with(|bench| {
        let child = bench.moving();
        bench.is_cut.store(true, Ordering::Relaxed);
        bench.is_at_rest_within(AT_REST_S);
        let ran = ended(child);
        // The line hangs up unless another process of these tests has inherited its other end; then it is silent.
        let is_told = ["broke while it moved", "the drive has not answered for 0."];
        assert!(ran.code == Some(1) && is_told.iter().any(|told| ran.stderr.contains(told)), "{ran:?}");
        assert!(bench.recorded().rows() > 50);
    });
}

#[test]
fn a_fault_or_a_runaway_ends_the_run_by_its_name_and_keeps_the_recording() {
    for (mishap, sentence) in [
        (Mishap::Fault(34), "the moteus reports fault 34 (over-voltage)"),
        (Mishap::RunsAway, "beyond the limit of 15 rad/s"),
    ] {
        Bench::with(|bench| {
            let child = bench.moving();
            bench.drive.lock().unwrap().mishap = Some(mishap);
            let ran = ended(child);
            assert!(ran.code == Some(1) && ran.stderr.contains(sentence), "{ran:?}");
            assert!(ran.stderr.contains("what was recorded until then is in"));
            assert!(bench.recorded().rows() > 50 && bench.drive.lock().unwrap().mode < 2);
        });
    }
}

#[test]
fn an_operator_fades_the_profile_and_stops_the_drive() {
    Bench::with(|bench| {
        let child = bench.moving();
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
        bench.until(3.0, |drive| drive.mode == 0);
        let ran = ended(child);
        assert!(ran.code == Some(0) && ran.stdout.contains("stopped by the operator"), "{ran:?}");
        assert!(bench.drive.lock().unwrap().motor.speed_rad_s.abs() < 1.0);
    });
}

/// Torques arrive as they were asked for, with the drive's own gains at 0, and the rotor's inertia follows from them.
#[test]
fn a_moteus_follows_torques_and_its_recording_gives_its_inertia() {
    Bench::with(|bench| {
        bench.follows(TORQUES);
        let arguments = bench.arguments(&["--limit", "15rad/s", "--limit", "0.03Nm", "--arm"]);
        let refused = run(arguments.iter().map(String::as_str));
        assert!(refused.refusal(2).contains("reaches 0.04 N m, beyond the limit of 0.03 N m"), "{refused:?}");
        assert!(bench.arrived.lock().unwrap().is_empty());
        let arguments = bench.arguments(&LIMITS);
        let ran = run(arguments.iter().map(String::as_str).chain(["--arm", "--json", "--rate", "500"]));
        assert!(ran.code == Some(0) && ran.stdout.contains("\"end\": \"finished\""), "{ran:?}");
        assert!(
            ran.stderr.contains("up to 0.04 N m") && ran.stderr.contains("`servo.max_velocity`"),
            "{ran:?}"
        );
        assert_eq!(bench.drive.lock().unwrap().mode, 0);
        let data = bench.recorded().load(&["command", "torque"]).unwrap();
        let [command, torque] = [0, 1].map(|column: usize| data.columns[column].values());
        // A torque is measured as the next command arrives.
        let far = command.iter().zip(&torque[1..]).filter(|(sent, is)| (*sent - *is).abs() > 5e-3).count();
        assert!(
            command.iter().any(|value| *value > 0.039) && far * 20 < command.len(),
            "{far} of {}",
            command.len()
        );

        let model = bench.path("model.toml");
        std::fs::write(&model, MODEL).unwrap();
        let fitted = run(["identify", &bench.path("run.mcap"), "--model", &model, "--json"]).json();
        let parameters = fitted["parameters"].as_array().unwrap();
        let inertia = parameters.iter().find(|one| one["name"] == "J").unwrap()["value"].as_f64().unwrap();
        assert!((3.3e-4..4.4e-4).contains(&inertia), "{parameters:?}");
    });
}

/// Nothing in the simulated drive limits its speed under a torque: this program does.
#[test]
fn a_torque_that_makes_its_motor_too_fast_ends_the_run() {
    Bench::with(|bench| {
        bench.follows(CONSTANT);
        let child = bench.moving();
        let mut fastest = 0.0_f64;
        bench.until(5.0, |drive| {
            fastest = fastest.max(drive.motor.speed_rad_s);
            drive.mode == 0
        });
        let ran = ended(child);
        assert!(ran.code == Some(1) && ran.stderr.contains("beyond the limit of 15 rad/s"), "{ran:?}");
        // 75 rad/s2 for 0.1 s on a busy computer.
        assert!((14.0..22.5).contains(&fastest), "{fastest}");
        assert!(bench.recorded().rows() > 50);
    });
}

/// The promise of the watchdog of torques: 0.1 s without a host, then the drive brakes.
#[test]
fn a_torque_ends_where_its_host_is_killed_or_its_cable_pulled() {
    for is_killed in [true, false] {
        Bench::with(|bench| {
            bench.follows(TORQUES);
            let mut child = bench.faster_than(1.0);
            std::thread::sleep(Duration::from_millis(1200));
            if is_killed {
                child.kill().unwrap();
            } else {
                bench.is_cut.store(true, Ordering::Relaxed);
            }
            bench.until(0.1 + 0.1, |drive| drive.mode == 11);
            bench.is_at_rest_within(0.4);
            let ran = ended(child);
            assert!(is_killed || ran.code == Some(1), "{ran:?}");
        });
    }
}
