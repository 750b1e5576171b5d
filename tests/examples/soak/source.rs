//! A source while it is recorded: its device, its recorders one after the other, and what befalls them.

use std::fs::File;
use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use socam_tests::socam_host;

use crate::device::State;
use crate::kind::{Kind, Over};

/// Time for which a cable is pulled, a device is off, and a recorder is missing.
const CUT: Duration = Duration::from_secs(3);
const OFF: Duration = Duration::from_secs(2);
const MISSING: Duration = Duration::from_secs(1);
/// Time after which the memory of a recorder is read first.
const WARM: Duration = Duration::from_secs(15);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mishap {
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
    /// A source that has not begun.
    pub(crate) fn new(kind: Kind, folder: &Path, served_at: &str) -> Result<Self, String> {
        let place = match kind.over {
            Over::Pty => folder.join(format!("{}.line", kind.name)).display().to_string(),
            Over::Tcp | Over::Udp => free_port()?,
            Over::Server => served_at.to_owned(),
        };
        Ok(Self {
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

    fn state_path(&self) -> PathBuf {
        self.folder.join(format!("{}-{}.state", self.kind.name, self.past.len()))
    }

    /// What the present process of the device has done.
    fn state(&self) -> State {
        State::read(&self.state_path())
    }

    pub(crate) fn start_device(&mut self) -> Result<(), String> {
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

    pub(crate) fn start_recorder(&mut self) -> Result<(), String> {
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

    /// Waits until the server of a source listens.
    pub(crate) fn wait_for_server(&self) {
        let begin = Instant::now();
        while !self.is_served() && begin.elapsed() < Duration::from_secs(30) {
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    /// Whether the server of a source listens; others have none.
    fn is_served(&self) -> bool {
        self.kind.over != Over::Server || TcpStream::connect(format!("127.0.0.1:{}", self.place)).is_ok()
    }

    pub(crate) fn befall(&mut self, mishap: Mishap) {
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
    pub(crate) fn look_after(&mut self) -> Result<(), String> {
        let now = Instant::now();
        if self.device_due.is_some_and(|due| now >= due) {
            self.start_device()?;
        }
        if self.recorder_due.is_some_and(|due| now >= due) && self.is_served() {
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

    pub(crate) fn interrupt(&self) {
        if let Some(recorder) = &self.recorder {
            let _ = Command::new("kill").args(["-INT", &recorder.id().to_string()]).status();
        }
    }

    pub(crate) fn end(&mut self) {
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

/// A port of loopback that is free now.
pub(crate) fn free_port() -> Result<String, String> {
    let port = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr());
    port.map(|address| address.port().to_string()).map_err(|error| error.to_string())
}
