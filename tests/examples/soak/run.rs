//! Runs all sources at once, and does to them what happens in a laboratory.

use std::fs::File;
use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use socam_tests::socam_host;

use crate::device::State;
use crate::kind::{KINDS, Kind, Over};
use crate::tally;

/// Time for which a cable is pulled, a device is off, and a recorder is missing.
const CUT: Duration = Duration::from_secs(3);
const OFF: Duration = Duration::from_secs(2);
const MISSING: Duration = Duration::from_secs(1);
/// Longest round of mishaps, s.
const ROUND_S: f64 = 720.0;
/// When a source's mishaps come in a round, as a share of it; that of the source with the number `k` come `k` staggers later.
const MISHAPS: [(f64, Mishap); 5] = [
    (0.20, Mishap::Cut),
    (0.34, Mishap::DeviceKilled),
    (0.50, Mishap::RecorderKilled),
    (0.64, Mishap::Cut),
    (0.78, Mishap::DeviceKilled),
];
const STAGGER: f64 = 0.01;
/// Time after which the memory of a recorder is read first.
const WARM: Duration = Duration::from_secs(15);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mishap {
    Cut,
    DeviceKilled,
    RecorderKilled,
}

/// One recording of a source.
#[derive(Debug, Clone, Default)]
pub(crate) struct Part {
    pub(crate) log: PathBuf,
    /// Number of the next row of the device as the recorder was killed.
    pub(crate) killed_at: Option<u64>,
    /// Memory of the recorder once it runs and at its end, KiB.
    pub(crate) memory_kib: [u64; 2],
    /// What the recorder printed.
    pub(crate) result: serde_json::Value,
}

/// A source while it runs, and what became of it.
pub(crate) struct Source {
    pub(crate) kind: Kind,
    pub(crate) parts: Vec<Part>,
    /// States of device processes that are over.
    pub(crate) past: Vec<State>,
    /// Number of cuts, killed devices and killed recorders.
    pub(crate) mishaps: [u32; 3],
    /// What went wrong, in words.
    pub(crate) problems: Vec<String>,
    place: String,
    served_at: String,
    folder: PathBuf,
    device: Option<Child>,
    recorder: Option<Child>,
    started: Instant,
    device_due: Option<Instant>,
    recorder_due: Option<Instant>,
}

impl Source {
    fn state_path(&self) -> PathBuf {
        self.folder.join(format!("{}-{}.state", self.kind.name, self.past.len()))
    }

    /// What the present process of the device has done.
    fn state(&self) -> State {
        State::read(&self.state_path())
    }

    fn start_device(&mut self) -> Result<(), String> {
        self.device_due = None;
        if self.kind.over == Over::Server {
            return Ok(());
        }
        let first = self.past.last().map_or(0, |state| state.next);
        let program = std::env::current_exe().map_err(|error| error.to_string())?;
        let state = self.state_path().display().to_string();
        let arguments =
            ["device", self.kind.name, &self.place, &state, &first.to_string()].map(str::to_owned);
        let child = Command::new(program).args(arguments).stdin(Stdio::piped()).spawn();
        self.device = Some(child.map_err(|error| format!("no device {}: {error}", self.kind.name))?);
        Ok(())
    }

    fn start_recorder(&mut self) -> Result<(), String> {
        self.recorder_due = None;
        let name = format!("{}-{}", self.kind.name, self.parts.len());
        let part = Part { log: self.folder.join(format!("{name}.mcap")), ..Part::default() };
        let output = |ending: &str| File::create(self.folder.join(format!("{name}.{ending}")));
        let start = || -> std::io::Result<Child> {
            let mut command = socam_host();
            command.args(["record", "--json", "--force", "--device", &self.kind.at(&self.place), "-o"]);
            command.arg(&part.log).args(self.kind.arguments(&self.folder)?);
            if self.kind.serves {
                command.args(["--serve", &self.served_at]);
            }
            command.stdout(output("json")?).stderr(output("txt")?).spawn()
        };
        self.recorder = Some(start().map_err(|error| format!("no recorder of {}: {error}", self.kind.name))?);
        self.started = Instant::now();
        self.parts.push(part);
        Ok(())
    }

    fn befall(&mut self, mishap: Mishap) {
        match mishap {
            Mishap::Cut => {
                if let Some(pipe) = self.device.as_mut().and_then(|device| device.stdin.as_mut()) {
                    let _ = writeln!(pipe, "{}", CUT.as_millis());
                    self.mishaps[0] += 1;
                }
            }
            Mishap::DeviceKilled => {
                if let Some(device) = &mut self.device {
                    let _ = device.kill();
                    let _ = device.wait();
                    if self.kind.over == Over::Pty {
                        // The name of its terminal is soon that of another one.
                        let _ = std::fs::remove_file(&self.place);
                    }
                    self.device = None;
                    self.past.push(self.state());
                    self.mishaps[1] += 1;
                    self.device_due = Some(Instant::now() + OFF);
                }
            }
            Mishap::RecorderKilled => {
                if let Some(recorder) = &mut self.recorder {
                    let _ = recorder.kill();
                    let next = State::read(&self.folder.join(format!(
                        "{}-{}.state",
                        self.kind.name,
                        self.past.len()
                    )));
                    let _ = recorder.wait();
                    self.recorder = None;
                    if let Some(part) = self.parts.last_mut() {
                        part.killed_at = Some(next.next);
                    }
                    self.mishaps[2] += 1;
                    self.recorder_due = Some(Instant::now() + MISSING);
                }
            }
        }
    }

    /// Starts again what is due, and looks whether the recorder is still there.
    fn look_after(&mut self) -> Result<(), String> {
        let now = Instant::now();
        if self.device_due.is_some_and(|due| now >= due) {
            self.start_device()?;
        }
        if self.recorder_due.is_some_and(|due| now >= due) {
            self.start_recorder()?;
        }
        if let Some(recorder) = &mut self.recorder {
            if let Ok(Some(status)) = recorder.try_wait() {
                let name = format!("{}-{}", self.kind.name, self.parts.len() - 1);
                let said =
                    std::fs::read_to_string(self.folder.join(format!("{name}.txt"))).unwrap_or_default();
                let last = said.lines().last().unwrap_or_default();
                self.problems.push(format!("the recorder of {name} ended by itself ({status}): {last}"));
                self.recorder = None;
                self.recorder_due = Some(now + MISSING);
                return Ok(());
            }
            let kib = memory_kib(recorder.id());
            if let Some(part) = self.parts.last_mut() {
                if self.started.elapsed() < WARM || part.memory_kib[0] == 0 {
                    part.memory_kib[0] = kib;
                }
                part.memory_kib[1] = kib;
            }
        }
        Ok(())
    }

    fn interrupt(&self) {
        if let Some(recorder) = &self.recorder {
            let _ = Command::new("kill").args(["-INT", &recorder.id().to_string()]).status();
        }
    }

    fn end(&mut self) {
        let until = Instant::now() + Duration::from_secs(60);
        if let Some(mut recorder) = self.recorder.take() {
            while matches!(recorder.try_wait(), Ok(None)) && Instant::now() < until {
                std::thread::sleep(Duration::from_millis(50));
            }
            if matches!(recorder.try_wait(), Ok(None)) {
                self.problems.push(format!("the recorder of {} does not end", self.kind.name));
                let _ = recorder.kill();
                let _ = recorder.wait();
            }
        }
        if let Some(mut device) = self.device.take() {
            let _ = device.kill();
            let _ = device.wait();
            self.past.push(self.state());
        }
        for (index, part) in self.parts.iter_mut().enumerate() {
            let path = self.folder.join(format!("{}-{index}.json", self.kind.name));
            let text = std::fs::read_to_string(path).unwrap_or_default();
            part.result = serde_json::from_str(&text).unwrap_or_default();
        }
    }
}

impl Drop for Source {
    fn drop(&mut self) {
        for child in [&mut self.device, &mut self.recorder].into_iter().flatten() {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Memory of a process, KiB; 0 where the system does not say.
fn memory_kib(id: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}

/// Runs the soak, prints its table and says whether nothing is unexplained. `kinds`: names of sources, none: all.
pub(crate) fn run(minutes: &str, folder: Option<&str>, kinds: &[&str]) -> Result<bool, String> {
    let minutes: f64 = minutes.parse().map_err(|_| format!("`{minutes}` is no number of minutes"))?;
    let temporary = tempfile::tempdir().map_err(|error| error.to_string())?;
    let folder = folder.map_or(temporary.path(), Path::new);
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut sources = Vec::new();
    let chosen = kinds.iter().map(|name| Kind::named(name)).collect::<Result<Vec<_>, _>>()?;
    let served_at = free_port()?;
    for kind in if chosen.is_empty() { KINDS.to_vec() } else { chosen } {
        sources.push(source(kind, folder, &served_at)?);
    }
    for source in &mut sources {
        source.start_device()?;
    }
    std::thread::sleep(Duration::from_millis(500));
    for source in &mut sources {
        let begin = Instant::now();
        let address = format!("127.0.0.1:{}", source.place);
        while source.kind.over == Over::Server
            && TcpStream::connect(&address).is_err()
            && begin.elapsed() < Duration::from_secs(30)
        {
            std::thread::sleep(Duration::from_millis(100));
        }
        source.start_recorder()?;
    }
    let load = suffer(&mut sources, minutes * 60.0)?;
    // Whoever records the server ends first.
    for source in sources.iter_mut().rev() {
        source.interrupt();
        source.end();
    }
    let (table, is_well) = tally::table(&sources, minutes, load);
    println!("{table}");
    let file = folder.join("soak.txt");
    std::fs::write(&file, table).map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(is_well)
}

fn source(kind: Kind, folder: &Path, served_at: &str) -> Result<Source, String> {
    let place = match kind.over {
        Over::Pty => folder.join(format!("{}.line", kind.name)).display().to_string(),
        Over::Tcp | Over::Udp => free_port()?,
        Over::Server => served_at.to_owned(),
    };
    Ok(Source {
        kind,
        parts: Vec::new(),
        past: Vec::new(),
        mishaps: [0; 3],
        problems: Vec::new(),
        place,
        served_at: served_at.to_owned(),
        folder: folder.to_owned(),
        device: None,
        recorder: None,
        started: Instant::now(),
        device_due: None,
        recorder_due: None,
    })
}

fn free_port() -> Result<String, String> {
    let port = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr());
    port.map(|address| address.port().to_string()).map_err(|error| error.to_string())
}

/// Lets the time pass with its mishaps. Returns the load of the computer: smallest and largest of the averages over a minute.
fn suffer(sources: &mut [Source], duration_s: f64) -> Result<[f64; 2], String> {
    let rounds = (duration_s / ROUND_S).ceil().max(1.0) as u32;
    let round_s = duration_s / f64::from(rounds);
    let begin = Instant::now();
    let mut load = [f64::INFINITY, 0.0_f64];
    let mut done = vec![0; sources.len()];
    while begin.elapsed().as_secs_f64() < duration_s {
        std::thread::sleep(Duration::from_millis(100));
        for (number, source) in sources.iter_mut().enumerate() {
            let (round, step) = (done[number] / MISHAPS.len(), done[number] % MISHAPS.len());
            let (share, mishap) = MISHAPS[step];
            let due_s = (round as f64 + share + STAGGER * number as f64) * round_s;
            if round < rounds as usize && begin.elapsed().as_secs_f64() >= due_s {
                done[number] += 1;
                // Every recorder is killed once, and some in each round; the others show an hour in one recording.
                let is_killed_often =
                    source.kind.serves || number % 2 == 0 && source.kind.over != Over::Server;
                if mishap != Mishap::RecorderKilled || round == 0 || is_killed_often {
                    source.befall(mishap);
                }
            }
            source.look_after()?;
        }
        let now = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
        if let Some(now) = now.split_whitespace().next().and_then(|text| text.parse::<f64>().ok()) {
            load = [load[0].min(now), load[1].max(now)];
        }
    }
    Ok(load)
}
