//! `import`: other formats to MCAP.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::UNIX_EPOCH;

use socam_recording::{Dataset, Format, LegacyLog, Selection, import_mcap};

use super::Outcome;
use crate::output;

/// Turn .csv or legacy .m recordings into MCAP logs
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Recordings (.csv or .m), or parts of them: RUN@FROM..TO in seconds
    #[arg(value_name = "RUN", required = true)]
    runs: Vec<String>,
    /// Log to write, for a single RUN; beside RUN with the extension .mcap when not given
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Note that travels with the log
    #[arg(long, value_name = "TEXT")]
    note: Option<String>,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    output::single_output(&args.runs, args.output.as_deref())?;
    for run in &args.runs {
        import(run, &args)?;
    }
    Ok(Outcome::Done)
}

fn import(run: &str, args: &Args) -> anyhow::Result<()> {
    let selection = Selection::parse(run)?;
    let data = output::open(run)?;
    let target = args.output.clone().unwrap_or_else(|| selection.path.with_extension("mcap"));
    let mut metadata = settings(&data, &selection)?;
    metadata.insert("host".into(), env!("CARGO_PKG_VERSION").into());
    metadata.extend(args.note.clone().map(|note| ("note".to_owned(), note)));
    import_mcap(&data, modified_unix_ns(&selection), metadata, &target)?;
    output::say(format_args!(
        "{} samples of {} channels written to {}",
        data.rows(),
        data.channels().len(),
        target.display()
    ));
    Ok(())
}

/// The run's settings that the thesis' program noted in its log.
fn settings(data: &Dataset, selection: &Selection) -> anyhow::Result<BTreeMap<String, String>> {
    let mut metadata = BTreeMap::new();
    if data.format() == Format::LegacyM {
        let log = LegacyLog::read(&selection.path)?;
        for (name, value) in
            [("amplitude_V", log.amplitude_v), ("frequency_Hz", log.frequency_hz), ("offset_V", log.offset_v)]
        {
            metadata.extend(value.map(|value| (name.to_owned(), value.to_string())));
        }
    }
    Ok(metadata)
}

/// When the file was last written: the best guess at when it was recorded, and the same on every import.
fn modified_unix_ns(selection: &Selection) -> u64 {
    let modified = selection.path.metadata().and_then(|m| m.modified()).ok();
    let since = modified.and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    since.and_then(|s| u64::try_from(s.as_nanos()).ok()).unwrap_or(0)
}
