//! `import`: other formats to MCAP.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use anyhow::Context;
use socam_recording::{Attachment, Calibration, Dataset, Format, LegacyLog, Selection, import_mcap};

use super::{Outcome, record};
use crate::output;

/// Turn .csv or legacy .m recordings into MCAP logs
///
/// A .csv begins with a header: `t_s` first (seconds), then one column per channel with its unit at the end of the name, such as
/// command_V, motor_speed_rad_s or torque_in_Nm. A legacy .m holds volts: speeds are converted to rad/s by the thesis' sensitivities,
/// torques stay in volts unless a calibration is given.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host import run.csv                                        writes run.mcap
  socam-host import run.csv@2..10 -o part.mcap --note \"new coupling\"
  socam-host import old.m --calibration bench.toml")]
pub(crate) struct Args {
    /// Recordings (.csv or .m), or parts of them: RUN@FROM..TO in seconds
    #[arg(value_name = "RUN", required = true)]
    runs: Vec<String>,
    /// Log to write, for a single RUN [default: beside RUN, with the extension .mcap]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Calibration file (`template calibration` prints one) that converts the volts of a legacy .m log into SI: channels in the order of the log's inputs
    #[arg(long, value_name = "C.toml")]
    calibration: Option<PathBuf>,
    /// Replace an existing log
    #[arg(long)]
    force: bool,
    /// Note to store in the log
    #[arg(long, value_name = "TEXT")]
    note: Option<String>,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    output::single_output(&args.runs, args.output.as_deref())?;
    let calibration = args.calibration.as_deref().map(read_calibration).transpose()?;
    for run in &args.runs {
        import(run, &args, calibration.as_ref())?;
    }
    Ok(Outcome::Done)
}

/// A calibration with the text of its file, which is stored in the log.
fn read_calibration(path: &Path) -> anyhow::Result<(Calibration, [Attachment; 1])> {
    let calibration = Calibration::open(path)?;
    let text =
        socam_recording::read_text(path).with_context(|| format!("cannot read `{}`", path.display()))?;
    Ok((calibration, record::attachment("calibration.toml", text)))
}

fn import(
    run: &str,
    args: &Args,
    calibration: Option<&(Calibration, [Attachment; 1])>,
) -> anyhow::Result<()> {
    let selection = Selection::parse(run)?;
    let data = match calibration {
        Some((calibration, _)) => Dataset::open_calibrated(&selection, calibration)?,
        None => Dataset::open_selection(&selection)?,
    };
    output::say_warnings(run, &data);
    let target = args.output.clone().unwrap_or_else(|| selection.path.with_extension("mcap"));
    output::check_target(&target, &selection.path, args.force)?;
    let mut metadata = settings(&data, &selection)?;
    metadata.insert("host".into(), env!("CARGO_PKG_VERSION").into());
    metadata.extend(args.note.clone().map(|note| ("note".to_owned(), note)));
    let attachments = calibration.map(|(_, attachment)| attachment.to_vec()).unwrap_or_default();
    import_mcap(&data, modified_unix_ns(&selection), metadata, attachments, &target)?;
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
