//! `record` of drives on a CAN bus, as a process: the bus, its adapter and the drive are simulated behind a pseudo-terminal, in real time.

use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};
use socam_recording::Dataset;
use socam_sources::simulators::{
    BusSimulator, CanopenSimulator, Firmware, Inertia, Motor, Node, OdriveCanSimulator,
};
use socam_tests::{Ending, Ran, assert_follows, path, record, run, socam_host};

/// A sine that reaches 10 rad/s, for 3 s.
const PROFILE: &str = "schema = \"socam.profile/1\"\ncommand = \"speed\"\nshape = \"sine\"\namplitude_rad_s = 10\nfrequency_Hz = 1\n\
    ramp_s = 0.5\nlimit_rad_s = 12\nslew_rad_s2 = 200\nduration_s = 3\n";
/// A torque that reaches 0.06 N m.
const TORQUES: &str = "schema = \"socam.profile/1\"\ncommand = \"torque\"\nshape = \"sine\"\namplitude_Nm = 0.06\nfrequency_Hz = 4\n\
    ramp_s = 0.5\nlimit_Nm = 0.08\nslew_Nm_s = 10\nduration_s = 3\n";
const LIMITS: [&str; 4] = ["--limit", "15rad/s", "--limit", "5A"];
const OBJECTS: &str = "schema = \"socam.canopen/1\"\n[channels.speed]\nsignal = \"606C:00 i32\"\nunit = \"rpm\"\nscale = 0.1\n\
    [channels.torque]\nsignal = \"6077:00 i16\"\nunit = \"N m\"\nscale = 0.002\n\
    [channels.status]\nsignal = \"6041:00 u16\"\nunit = \"1\"\n";

/// The same for a drive that may be commanded.
const COMMANDS: &str =
    "[commands]\nmay_be_written = true\nunit = \"rpm\"\nscale = 0.1\nlimits = [\"607F\", \"6072\"]\n";
const LIMITS_OF_TORQUE: [&str; 4] = ["--limit", "15rad/s", "--limit", "0.5Nm"];
/// The drive's reaction after 0.2 s, its quick stop from 10 rad/s in 0.01 s, and what a busy computer takes to see it.
const AT_REST_S: f64 = 0.5;

/// A bus with a node behind a pseudo-terminal.
struct Bench<N> {
    folder: tempfile::TempDir,
    /// The address of the adapter, to which that of the drive is added.
    adapter: String,
    bus: Mutex<BusSimulator<N>>,
    is_over: AtomicBool,
    /// Whether the line carries nothing any more.
    is_cut: AtomicBool,
}

impl<N: Node + Send> Bench<N> {
    /// Runs a test with a bench.
    fn with(node: N, test: impl FnOnce(&Self)) {
        let (line, theirs) = TTYPort::pair().unwrap();
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("profile.toml"), PROFILE).unwrap();
        std::fs::write(folder.path().join("objects.toml"), OBJECTS).unwrap();
        std::fs::write(folder.path().join("marked.toml"), format!("{OBJECTS}{COMMANDS}")).unwrap();
        let bench = Self {
            folder,
            adapter: format!("slcan:{}?bitrate=500k", theirs.name().unwrap()),
            bus: Mutex::new(BusSimulator::new(node)),
            is_over: AtomicBool::new(false),
            is_cut: AtomicBool::new(false),
        };
        std::thread::scope(|scope| {
            let _ending = Ending(&bench.is_over);
            scope.spawn(|| bench.serve(line));
            test(&bench);
        });
        drop(theirs);
    }

    fn serve(&self, mut line: TTYPort) {
        line.set_timeout(Duration::from_millis(1)).unwrap();
        let (begin, mut bytes) = (Instant::now(), [0; 4096]);
        while !self.is_over.load(Ordering::Relaxed) {
            let is_cut = self.is_cut.load(Ordering::Relaxed);
            let count = line.read(&mut bytes).unwrap_or(0) * usize::from(!is_cut);
            let answer = self.bus.lock().unwrap().receive(begin.elapsed().as_secs_f64(), &bytes[..count]);
            if !answer.is_empty() && !is_cut {
                let _ = line.write_all(&answer);
            }
        }
    }

    fn path(&self, name: &str) -> String {
        path(&self.folder, name)
    }

    /// Records a drive on the bus, such as `odrive+` of node 3.
    fn record(&self, drive: &str, node: u8, more: &[&str]) -> Ran {
        record(&format!("{drive}{}&node={node}", self.adapter), &self.path("run.mcap"), more)
    }

    fn recorded(&self) -> Dataset {
        Dataset::open(&self.path("run.mcap")).unwrap()
    }
}

fn odrive() -> OdriveCanSimulator {
    OdriveCanSimulator::new(3, Firmware::Late, Motor::at_rest(Inertia::SMALL, 0.1))
}

#[test]
fn an_odrive_on_a_bus_follows_a_profile_once_it_is_armed() {
    Bench::with(odrive(), |bench| {
        let profile = bench.path("profile.toml");
        let armed = [&["--profile", &profile], &LIMITS[..]].concat();
        let refused = bench.record("odrive+", 3, &armed);
        assert_eq!(refused.code, Some(2), "{refused:?}");
        for said in ["nothing was sent: add --arm", "CAN Simple reads no settings back"] {
            assert!(refused.stderr.contains(said), "{refused:?}");
        }
        assert!(bench.bus.lock().unwrap().adapter.commands.is_empty());
        let ran = bench.record("odrive+", 3, &[&armed[..], &["--arm", "--rate", "200"]].concat());
        assert!(ran.code == Some(0) && ran.stdout.contains("\"end\": \"finished\""), "{ran:?}");
        assert_follows(&bench.recorded());
        let bus = bench.bus.lock().unwrap();
        assert_eq!((bus.node.state, bus.node.error), (1, 0));
    });
}

/// The promise of the watchdog: without its host the drive is idle in time.
#[test]
fn an_odrive_on_a_bus_whose_host_is_killed_is_idle_after_its_watchdogs_time() {
    for profile in [PROFILE, TORQUES] {
        Bench::with(odrive(), |bench| killed(bench, profile));
    }
}

fn killed(bench: &Bench<OdriveCanSimulator>, profile: &str) {
    std::fs::write(bench.path("profile.toml"), profile).unwrap();
    let (log, profile) = (bench.path("run.mcap"), bench.path("profile.toml"));
    let device = format!("odrive+{}&node=3", bench.adapter);
    let mut command = socam_host();
    command.args(["record", "-o", &log, "--device", &device, "--profile", &profile, "--arm"]).args(LIMITS);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let until = |most_s: f64, is_so: &dyn Fn(&OdriveCanSimulator) -> bool| {
        let begin = Instant::now();
        while !is_so(&bench.bus.lock().unwrap().node) {
            assert!(begin.elapsed().as_secs_f64() < most_s, "{:?}", bench.bus.lock().unwrap().node);
            std::thread::sleep(Duration::from_millis(1));
        }
    };
    until(20.0, &|node| node.motor.speed_rad_s > 3.0);
    child.kill().unwrap();
    // The watchdog of 0.2 s, and what a busy computer takes to see it.
    until(0.4, &|node| node.state == 1 && node.error == 0x100_0000);
    // Without a torque it coasts.
    until(0.05, &|node| node.motor.torque_nm == 0.0);
    child.wait().unwrap();
}

#[test]
fn a_drive_with_canopen_is_recorded_by_its_list_and_never_commanded() {
    let mut node = CanopenSimulator::new(5, Motor::turning(12.5, 0.25, 24.0));
    node.pdo_s = Some(0.004);
    Bench::with(node, |bench| {
        let list = bench.path("objects.toml");
        let refused = bench.record("canopen+", 5, &[]);
        assert!(refused.refusal(2).contains("name a list of them by --describe FILE"), "{refused:?}");
        let profile = bench.path("profile.toml");
        let command = ["--describe", &list, "--profile", &profile, "--arm"];
        let refused = bench.record("canopen+", 5, &[&command[..], &LIMITS_OF_TORQUE].concat());
        let sentence = refused.refusal(2);
        assert!(
            sentence.contains("objects.toml`: the list of objects does not say")
                && sentence.contains("may_be_written = true")
        );
        let ran = bench.record("canopen+", 5, &["--describe", &list, "--rate", "100", "--duration", "2s"]);
        assert!(ran.code == Some(0) && ran.stdout.contains("\"damaged\": 0"), "{ran:?}");
        let data = bench.recorded().load(&["speed", "torque", "status"]).unwrap();
        let [speed, torque, status] = [0, 1, 2].map(|column: usize| data.columns[column].values());
        assert!(speed.len() > 100 && torque.iter().all(|torque| *torque == 0.25), "{}", speed.len());
        let known: Vec<_> = speed.iter().zip(status).filter(|(speed, _)| !speed.is_nan()).collect();
        assert!(2 * known.len() > speed.len(), "{} of {}", known.len(), speed.len());
        assert!(known.iter().all(|(speed, status)| (*speed - 12.5).abs() < 0.006 && **status == 567.0));
        let info = run(["info", "--json", &bench.path("run.mcap")]).stdout;
        assert!(info.contains("device.toml") && info.contains("the drive is enabled"), "{info}");
        assert!(bench.bus.lock().unwrap().sent.iter().all(|frame| frame.bytes[0] == 0x40));
    });
}

impl Bench<CanopenSimulator> {
    /// What `record` is told for a drive that may be commanded.
    fn arguments(&self) -> Vec<String> {
        let device = format!("canopen+{}&node=5", self.adapter);
        let [log, list, profile] = ["run.mcap", "marked.toml", "profile.toml"].map(|name| self.path(name));
        let command = ["record", "-o", &log, "--device", &device, "--describe", &list, "--profile", &profile];
        let more = ["--rate", "100", "--json"];
        command.iter().chain(&LIMITS_OF_TORQUE).chain(&more).map(ToString::to_string).collect()
    }

    /// `record` while the drive turns.
    fn moving(&self) -> Child {
        let mut command = socam_host();
        command.args(self.arguments()).arg("--arm").stdout(Stdio::piped()).stderr(Stdio::piped());
        let child = command.spawn().unwrap();
        self.until(20.0, |node| node.motor.speed_rad_s > 3.0);
        child
    }

    fn until(&self, most_s: f64, is_so: impl Fn(&CanopenSimulator) -> bool) {
        let begin = Instant::now();
        while !is_so(&self.bus.lock().unwrap().node) {
            assert!(begin.elapsed().as_secs_f64() < most_s, "{:?}", self.bus.lock().unwrap().node);
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn is_at_rest_within(&self, most_s: f64) {
        self.until(most_s, |node| node.status & 0x6f == 0x40 && node.motor.speed_rad_s.abs() < 0.1);
    }
}

/// What a process said until its end.
fn ended(child: Child) -> (Option<i32>, String, String) {
    let output = child.wait_with_output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

fn disabled() -> CanopenSimulator {
    CanopenSimulator::disabled(5, Motor::at_rest(Inertia::SMALL, 0.1))
}

#[test]
fn a_drive_with_canopen_whose_list_marks_it_follows_a_profile_once_it_is_armed() {
    Bench::with(disabled(), |bench| {
        let told = run(bench.arguments());
        assert_eq!(told.code, Some(2), "{told:?}");
        for said in ["nothing was sent: add --arm", "(607F or 6080)", "its own setting (605A, 6085)"] {
            assert!(told.stderr.contains(said) || told.stdout.contains(said), "{said} {told:?}");
        }
        assert!(bench.bus.lock().unwrap().adapter.commands.is_empty());
        let ran = run(bench.arguments().into_iter().chain(["--arm".into()]));
        assert!(ran.code == Some(0) && ran.stdout.contains("\"end\": \"finished\""), "{ran:?}");
        assert_follows(&bench.recorded());
        let bus = bench.bus.lock().unwrap();
        assert_eq!([bus.node.setting(0x607f, 0), bus.node.setting(0x1016, 1)], [30_000, 0]);
        assert_eq!(bus.node.status & 0x6f, 0x40);
        let info = run(["info", "--json", &bench.path("run.mcap")]).stdout;
        assert!(info.contains("device.toml") && info.contains("15 rad/s, 0.5 N m"), "{info}");
    });
}

#[test]
fn a_drive_with_canopen_is_stopped_by_the_operator_and_at_rest_without_cable_or_host() {
    std::thread::scope(|scope| {
        scope.spawn(|| {
            Bench::with(disabled(), |bench| {
                let child = bench.moving();
                assert!(
                    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success()
                );
                let (code, said, problem) = ended(child);
                assert!(code == Some(0) && said.contains("\"end\": \"stopped\""), "{said} {problem}");
                bench.is_at_rest_within(0.1);
            })
        });
        scope.spawn(|| {
            Bench::with(disabled(), |bench| {
                let child = bench.moving();
                bench.is_cut.store(true, Ordering::Relaxed);
                bench.is_at_rest_within(AT_REST_S);
                let (code, _, problem) = ended(child);
                assert!(
                    code == Some(1) && problem.contains("the drive has not answered for 0."),
                    "{problem}"
                );
                assert!(bench.recorded().rows() > 20);
            })
        });
        scope.spawn(|| {
            Bench::with(disabled(), |bench| {
                let mut child = bench.moving();
                child.kill().unwrap();
                bench.is_at_rest_within(AT_REST_S);
                child.wait().unwrap();
            })
        });
    });
}

#[test]
fn a_drive_with_canopen_that_ignores_a_missing_heartbeat_is_not_commanded() {
    let mut node = disabled();
    node.is_deaf = true;
    Bench::with(node, |bench| {
        let ran = run(bench.arguments().into_iter().chain(["--arm".into()]));
        assert!(
            ran.code == Some(1) && ran.stderr.contains("after the last heartbeat of this computer"),
            "{ran:?}"
        );
        let node = &bench.bus.lock().unwrap().node;
        assert!(node.motor.angle_rad == 0.0 && node.status & 0x6f == 0x40, "{node:?}");
    });
}

/// A bus behind an adapter that sends what it likes.
fn hostile(device: &str, bytes: &[u8], more: &[&str]) -> (Ran, bool) {
    let (mut line, theirs) = TTYPort::pair().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| path(&folder, name);
    let (log, list, dbc) = (path("run.mcap"), path("objects.toml"), path("bus.dbc"));
    std::fs::write(&list, OBJECTS).unwrap();
    let text = "VERSION \"\"\n\nBU_: A\n\nBO_ 257 M: 2 A\n SG_ speed : 0|16@1- (1,0) [0|0] \"rad/s\" A\n";
    std::fs::write(&dbc, text).unwrap();
    let device = device.replace("LINE", &theirs.name().unwrap());
    let more: Vec<&str> = more
        .iter()
        .map(|word| [&list[..], &dbc, word][["LIST", "DBC"].iter().position(|w| w == word).unwrap_or(2)])
        .collect();
    let is_over = AtomicBool::new(false);
    let ran = std::thread::scope(|scope| {
        let _ending = Ending(&is_over);
        scope.spawn(|| {
            line.set_timeout(Duration::from_millis(1)).unwrap();
            while !is_over.load(Ordering::Relaxed) {
                let _ = line.read(&mut [0; 4096]);
                let _ = line.write(bytes);
            }
        });
        run(["record", "-o", &log, "--device", &device].iter().chain(&more))
    });
    (ran, std::path::Path::new(&log).exists())
}

/// Each is refused in one sentence, without a panic and without a file.
#[test]
fn hostile_nodes_and_adapters_are_refused_in_one_sentence() {
    let noise: Vec<u8> =
        (0..1_u32 << 10).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8 | 0x80).collect();
    let odrive = "odrive+slcan:LINE?bitrate=1M&node=3";
    let canopen = "canopen+slcan:LINE?bitrate=1M&node=5";
    let cases: [(&str, &[u8], &[&str], &str); 7] = [
        ("slcan:LINE?bitrate=1M", &noise, &["--dbc", "DBC"], "what arrives is not slcan"),
        ("slcan:LINE?bitrate=1M", b"t7FF101\r", &["--dbc", "DBC"], "is in the DBC, but 7FF ("),
        // Another node, nothing but heartbeats, a flood without a line end, and numbers that are none.
        (odrive, b"t04180000000001000000\r", &[], "frames like those of nodes 2 arrive"),
        (odrive, b"t06180000000001000000\r", &[], "node 3 sends frames, and has not answered whole for 10 s"),
        (odrive, &[b'A'; 1000], &[], "has said nothing for 10 s"),
        (odrive, b"t06980000C07F0000C07F\r", &[], "node 3 sends frames, and has not answered whole for 10 s"),
        // Answers of SDO to other questions.
        (canopen, b"t58584300100012345678\r", &["--describe", "LIST"], "node 5 does not answer"),
    ];
    std::thread::scope(|scope| {
        for (device, bytes, more, sentence) in cases {
            scope.spawn(move || {
                let (ran, is_written) = hostile(device, bytes, more);
                // What is damaged is warned of before.
                let is_said = ran.stderr.lines().last().is_some_and(|line| line.contains(sentence));
                assert!(ran.code == Some(1) && is_said, "{device} {sentence}: {ran:?}");
                assert!(!ran.stderr.contains("panicked") && !is_written, "{device} {sentence}");
            });
        }
    });
}

#[test]
fn an_interface_that_is_not_there_is_refused_by_a_helpful_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let log = path(&folder, "run.mcap");
    let refused = run(["record", "-o", &log, "--device", "odrive+socketcan:nosuchcan7?node=1"]);
    let sentence = refused.refusal(1);
    assert!(sentence.contains("nosuchcan7") && sentence.contains("slcan:PATH?bitrate=500k"), "{refused:?}");
    let refused = run(["record", "-o", &log, "--device", "odrive+slcan:/dev/ttyACM0?node=1"]);
    assert!(refused.refusal(2).contains("expected odrive+slcan:PATH?bitrate=500k&node=1"), "{refused:?}");
}
