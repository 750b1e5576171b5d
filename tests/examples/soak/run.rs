//! Runs all sources at once, and does to them what happens in a laboratory.

use std::path::Path;
use std::time::{Duration, Instant};

use crate::kind::{KINDS, Kind, Over};
use crate::source::{Mishap, Source, free_port};
use crate::tally;

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
        sources.push(Source::new(kind, folder, &served_at)?);
    }
    for source in &mut sources {
        source.start_device()?;
    }
    std::thread::sleep(Duration::from_millis(500));
    for source in &mut sources {
        source.wait_for_server();
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
