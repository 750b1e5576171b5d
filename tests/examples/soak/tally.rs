//! Compares what was sent with what was recorded.

use std::fmt::Write;

use socam_recording::Dataset;

use crate::source::{Part, Source};

/// Most rows that may be under way to the recorder as a device is killed, at each time.
const UNDER_WAY: u64 = 64;
/// Longest time at the end of a recording that a killed recorder may lack, s.
const MOST_LACKED_S: f64 = 2.5;

/// What the recordings of a source hold.
#[derive(Debug, Default)]
struct Held {
    rows: u64,
    /// Rows whose number is missing, and rows that came twice or in another order.
    blank: u64,
    disordered: u64,
    /// Numbers between the first and the last row of a recording that it lacks.
    missing: u64,
    /// Samples that recordings say were lost.
    lost: u64,
    gaps: u64,
    /// Missing numbers that the recording does not account for, and lost samples that no number is missing for.
    unexplained: u64,
    overcounted: u64,
    /// Longest time that a killed recorder's recording lacks at its end, s.
    lacked_s: f64,
    /// Largest uncertainty of a clock and largest spread of times of arrival that were stated, s.
    clock_s: f64,
    arrival_s: f64,
    damaged: u64,
    interruptions: u64,
}

impl Held {
    fn take(&mut self, source: &Source, part: &Part) -> Result<(), String> {
        let path = part.log.display().to_string();
        let data = Dataset::open(&path).map_err(|error| format!("{path} cannot be read: {error}"))?;
        let (name, size) = source.kind.number;
        let index = data.channel_index(name).map_err(|error| format!("{path}: {error}"))?;
        let (mut first, mut last) = (None, None::<u64>);
        let (mut distinct, mut blank) = (0_u64, 0_u64);
        let blocks = data.blocks_in(0..data.rows(), &[index]).map_err(|error| format!("{path}: {error}"))?;
        for block in blocks {
            let block = block.map_err(|error| format!("{path}: {error}"))?;
            for value in block.columns[0].values() {
                if !value.is_finite() {
                    blank += 1;
                    continue;
                }
                let mut number = (value / size).round() as u64;
                if source.kind.wrap > 0 {
                    let wrap = source.kind.wrap;
                    let before = last.unwrap_or(number);
                    number = before + (number % wrap + wrap - before % wrap) % wrap;
                }
                first.get_or_insert(number);
                match last {
                    Some(before) if number <= before => self.disordered += 1,
                    Some(before) => {
                        distinct += 1;
                        self.gaps += u64::from(number > before + 1);
                    }
                    None => distinct += 1,
                }
                last = Some(number.max(last.unwrap_or(0)));
            }
        }
        let (Some(first), Some(last)) = (first, last) else { return Err(format!("{path} holds no number")) };
        let missing = (last - first + 1).saturating_sub(distinct);
        let lost = data.lost_samples();
        self.rows += data.rows();
        self.blank += blank;
        self.missing += missing;
        self.lost += lost;
        // A row without its number is there.
        self.unexplained += missing.saturating_sub(lost + blank);
        self.overcounted += lost.saturating_sub(missing);
        if let Some(killed_at) = part.killed_at.filter(|at| *at > 0) {
            let behind = if source.kind.wrap > 0 {
                (killed_at % source.kind.wrap + source.kind.wrap - last % source.kind.wrap) % source.kind.wrap
            } else {
                killed_at.saturating_sub(last)
            };
            let span_s = data.end_s() - data.start_s();
            let rate_hz = (data.rows() as f64 / span_s).max(1.0);
            self.lacked_s = self.lacked_s.max(behind as f64 / rate_hz);
        }
        let number = |key: &str| part.result[key].as_f64().unwrap_or(0.0);
        self.clock_s = self.clock_s.max(part.result["clock"]["uncertainty_s"].as_f64().unwrap_or(0.0));
        self.arrival_s = self.arrival_s.max(number("arrival_spread_s"));
        self.damaged += number("damaged") as u64;
        self.interruptions += number("interruptions") as u64;
        Ok(())
    }
}

/// The table, and whether nothing in it is unexplained.
pub(crate) fn table(sources: &[Source], minutes: f64, load: [f64; 2]) -> (String, bool) {
    let processors = std::thread::available_parallelism().map_or(0, usize::from);
    let mut text = format!(
        "{minutes} minutes, all sources at once, load {:.1} to {:.1} on {processors} processors\n\n\
         | source | per s | sent | recorded | missing | lost, as stated | unexplained | stated too many | cuts, devices and recorders killed | lacks after kill -9, s | memory, MiB | clock within, ms | arrival within, ms |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        load[0], load[1]
    );
    let (mut is_well, mut notes) = (true, String::new());
    for source in sources {
        let mut held = Held::default();
        let mut problems = source.problems.clone();
        for part in &source.parts {
            problems.extend(held.take(source, part).err());
        }
        let sent: u64 = source.past.iter().map(|state| state.sent).sum();
        let [cuts, devices, recorders] = source.mishaps;
        let allowed = UNDER_WAY * u64::from(devices);
        is_well &= problems.is_empty()
            && held.unexplained <= allowed
            && held.disordered == 0
            && held.lacked_s <= MOST_LACKED_S;
        let memory = source.parts.iter().map(|part| part.memory_kib.map(|kib| kib as f64 / 1024.0));
        let grown = memory.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0]))).unwrap_or_default();
        let name = source.kind.name;
        let _ = writeln!(
            text,
            "| {name} | {} | {sent} | {} | {} | {} | {} | {} | {cuts}, {devices}, {recorders} | {:.2} | {:.1} to {:.1} | {:.3} | {:.1} |",
            source.kind.rate_hz,
            held.rows,
            held.missing,
            held.lost,
            held.unexplained,
            held.overcounted,
            held.lacked_s,
            grown[0],
            grown[1],
            held.clock_s * 1e3,
            held.arrival_s * 1e3,
        );
        let _ = writeln!(
            notes,
            "{name}: {} gaps, {} damaged messages, {} interruptions of the link, {} rows without a number, {} out of order",
            held.gaps, held.damaged, held.interruptions, held.blank, held.disordered
        );
        problems.iter().for_each(|problem| {
            let _ = writeln!(notes, "! {problem}");
        });
    }
    (format!("{text}\n{notes}"), is_well)
}
