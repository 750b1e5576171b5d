//! Cost of displaying a large table: `cargo run --release -p socam-fleet --example large_table -- ROWS MACHINES`.

use std::path::Path;
use std::time::Instant;

use socam_fleet::row::{ChannelFit, Parameter, Stage, Status, Verdict};
use socam_fleet::{FleetOptions, Row, Survey, Table, table};
use socam_model::Model;

fn row(number: usize, of: usize) -> Row {
    let noise = |salt: usize| {
        let hash = (number * 31 + salt).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (hash >> 11) as f64 / (1_u64 << 53) as f64
    };
    let parameter = |index: usize| Parameter {
        name: format!("parameter_{index}"),
        value: Some(1.0 + 0.1 * noise(index)),
        std: Some(0.01),
        low: Some(0.98 + 0.1 * noise(index)),
        high: Some(1.02 + 0.1 * noise(index)),
        unit: "N m".into(),
        determined: true,
    };
    let channel = |index: usize| ChannelFit {
        name: format!("channel_{index}"),
        unit: "rad/s".into(),
        noise_std: Some(0.1),
        rms: Some(0.2 * noise(20 + index)),
        rms_corrected: None,
    };
    Row {
        id: format!("{number:064x}"),
        recording: format!("SN{:06}/{number:07}.mcap", number / of),
        machine: Some(format!("SN{:06}", number / of)),
        date: Some(86_400_000 * (number % of) as i64),
        status: Status::Ok,
        message: String::new(),
        stage: Stage::ScoreTest,
        verdict: Some(Verdict::Adequate),
        p_value: Some(noise(40)),
        excess: Some(1.0),
        samples: Some(10_000),
        duration_s: Some(10.0),
        findings: Vec::new(),
        parameters: (0..8).map(parameter).collect(),
        channels: (0..4).map(channel).collect(),
        warnings: Vec::new(),
        model: "two-mass".into(),
        version: "0.1.0".into(),
    }
}

/// Greatest memory so far, MB; 0 where the system does not say.
fn peak_mb() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<u64>().ok()).unwrap_or(0) / 1024
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let number =
        |place: usize, usual: usize| std::env::args().nth(place).map_or(Ok(usual), |text| text.parse());
    let (rows, machines) = (number(1, 100_000)?, number(2, 10_000)?);
    let path = std::env::temp_dir().join(format!("socam-large-{}.parquet", std::process::id()));
    let result = measure(&path, rows, machines.clamp(1, rows));
    std::fs::remove_file(&path)?;
    result
}

fn measure(path: &Path, rows: usize, machines: usize) -> Result<(), Box<dyn std::error::Error>> {
    let model = Model::builtin("two-mass").ok_or("the model is built in")?;
    let about = table::About::new(&model, &FleetOptions::default(), 1);
    let of = rows / machines;
    table::write(path, &about, (0..rows).map(|number| Ok(row(number, of))))?;
    println!("{rows} rows of {machines} machines, {:.1} MB", std::fs::metadata(path)?.len() as f64 / 1e6);
    let begin = Instant::now();
    println!("a fleet's table: {}, {:.4} s", Table::is_one(path), begin.elapsed().as_secs_f64());
    let begin = Instant::now();
    let survey = Survey::of(Table::open(path)?, 0.5)?;
    println!("all rows read and compared: {:.2} s, peak {} MB", begin.elapsed().as_secs_f64(), peak_mb());
    let begin = Instant::now();
    let listed = survey.at(0.05).notable().len();
    println!("listed at another rate: {:.4} s, {listed} machines", begin.elapsed().as_secs_f64());
    let begin = Instant::now();
    let own = Table::of_machine(path, &format!("SN{:06}", machines / 2))?.count();
    println!("the {own} rows of a machine: {:.3} s", begin.elapsed().as_secs_f64());
    Ok(())
}
