//! Cost of recording and reading: processor time, memory, losses.
//!
//!     recording_load record FILE SECONDS     10 kHz x 6 channels in real time
//!     recording_load fill FILE MEGABYTES     the same samples as fast as the disk takes them
//!     recording_load read FILE               one pass over a recording after opening it
//!
//! Linux only: it reads /proc/self.

use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

use socam_recording::{Channel, Dataset, Recorder, RecordingHeader, SampleRow, Unit};

const RATE_HZ: u64 = 10_000;
const CHANNELS: usize = 6;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["record", file, seconds] => record(Path::new(file), seconds.parse()?),
        ["fill", file, megabytes] => fill(Path::new(file), megabytes.parse()?),
        ["read", file] => read(file),
        _ => Err("usage: recording_load record|fill|read FILE [SECONDS|MEGABYTES]".into()),
    }
}

fn record(path: &Path, seconds: u64) -> Result<(), Box<dyn Error>> {
    let mut source = Source::new(path)?;
    let started = Instant::now();
    let mut longest_push = Duration::ZERO;
    let mut memory_kib = Vec::new();
    while source.sequence < seconds * RATE_HZ {
        std::thread::sleep(Duration::from_millis(5));
        let due = (started.elapsed().as_micros() as u64 * RATE_HZ / 1_000_000).min(seconds * RATE_HZ);
        let pushing = Instant::now();
        source.push_to(due);
        longest_push = longest_push.max(pushing.elapsed());
        if memory_kib.len() < (started.elapsed().as_secs() / 10) as usize {
            memory_kib.push(resident_kib());
        }
    }
    let summary = source.recorder.finish()?;
    let wall_s = started.elapsed().as_secs_f64();
    println!("{summary:?}");
    println!(
        "wall {wall_s:.1} s, processor {:.2} s = {:.2} % of a core (making the samples included)",
        processor_s(),
        100.0 * processor_s() / wall_s
    );
    println!("longest push {longest_push:?}; resident memory every 10 s, KiB: {memory_kib:?}");
    Ok(())
}

fn fill(path: &Path, megabytes: u64) -> Result<(), Box<dyn Error>> {
    let mut source = Source::new(path)?;
    let started = Instant::now();
    while path.metadata()?.len() < megabytes << 20 {
        source.push_to(source.sequence + 5000);
        while source.recorder.queued_bytes() > Recorder::QUEUE_BYTES / 2 {
            std::thread::sleep(Duration::from_millis(5));
        }
    }
    let summary = source.recorder.finish()?;
    println!("{summary:?} in {:.1} s", started.elapsed().as_secs_f64());
    Ok(())
}

fn read(file: &str) -> Result<(), Box<dyn Error>> {
    let started = Instant::now();
    let data = Dataset::open(file)?;
    let opened_s = started.elapsed().as_secs_f64();
    let mut sum = 0.0;
    for block in data.blocks()? {
        let block = block?;
        sum += block.columns.iter().flat_map(|c| c.values()).sum::<f64>();
    }
    let read_s = started.elapsed().as_secs_f64() - opened_s;
    let megabytes = Path::new(file).metadata()?.len() as f64 / 1e6;
    println!(
        "{} rows, {} lost; opened in {opened_s:.1} s, read again in {read_s:.1} s ({:.0} MB/s, {:.2} million rows/s), sum {sum:.6}",
        data.rows(),
        data.lost_samples(),
        megabytes / read_s,
        data.rows() as f64 / read_s / 1e6,
    );
    println!("largest resident memory {} KiB", status_kib("VmHWM:"));
    Ok(())
}

struct Source {
    recorder: Recorder,
    sequence: u64,
    noise: u64,
}

impl Source {
    fn new(path: &Path) -> Result<Self, Box<dyn Error>> {
        let channels = (0..CHANNELS).map(|i| Channel::new(format!("channel_{i}"), Unit::V));
        let mut header = RecordingHeader::new(channels.collect());
        header.replace = true;
        Ok(Self { recorder: Recorder::create(path, &header)?, sequence: 0, noise: 1 })
    }

    /// Sines with noise in twelve bits' place: neither constant nor incompressible.
    fn push_to(&mut self, end: u64) {
        for sequence in self.sequence..end {
            let mut values = [0.0; CHANNELS];
            let mut counts = [0; CHANNELS];
            let t = sequence as f64 / RATE_HZ as f64;
            for (index, value) in values.iter_mut().enumerate() {
                self.noise = self.noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                let noise = (self.noise >> 40) as f64 / f64::from(1 << 24);
                *value = (t * (1 + index) as f64).sin() + 0.01 * noise;
                counts[index] = (*value * 2000.0) as i32;
            }
            self.recorder.push_samples(&[SampleRow {
                device_time_ns: (sequence * 1_000_000_000 / RATE_HZ) as i64,
                sequence,
                flags: 0,
                raw_counts: &counts,
                values: &values,
            }]);
        }
        self.sequence = end;
    }
}

/// User and system time of this process, s (the kernel counts it in hundredths).
fn processor_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let ticks: f64 =
        after_name.split_whitespace().skip(11).take(2).filter_map(|field| field.parse::<f64>().ok()).sum();
    ticks / 100.0
}

fn resident_kib() -> u64 {
    status_kib("VmRSS:")
}

fn status_kib(name: &str) -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    status
        .lines()
        .find_map(|line| line.strip_prefix(name))
        .and_then(|rest| rest.split_whitespace().next())
        .and_then(|kib| kib.parse().ok())
        .unwrap_or(0)
}
