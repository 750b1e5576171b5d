//! `import`: recordings of other programs to MCAP.

mod understood;

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use anyhow::Context;
use socam_import::{ImportError, Imported, Mapping, Opened};
use socam_recording::{Attachment, Calibration, Dataset, Format, LegacyLog, Selection, import_mcap};

use super::{Outcome, record};
use crate::output::{self, WrongArguments};

/// Turn recordings of other programs into MCAP logs
///
/// Reads text tables (.csv and relatives: any separator, decimal commas, units in names or in a line), LabVIEW .lvm, traces of CODESYS,
/// ctrlX and TwinCAT, JSON, MDF 4, TDMS, MATLAB .mat, HDF5, Parquet, Arrow, MCAP of other programs (ROS 2, protobuf, JSON), ROS 2 bags
/// (.db3), WPILOG, PX4 ULog, and logs of a CAN bus with a DBC (candump, Vector ASC and BLF), found by their content. A file that states the units and times of
/// all its signals is read as it is. For others, --propose writes a mapping of signals to channels, in which what the file does not say
/// stands as "?"; complete it and pass it by --map. A legacy .m holds volts: speeds are converted to rad/s by the thesis' sensitivities,
/// torques stay in volts unless a calibration is given.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host import bench.tdms                                      writes bench.mcap
  socam-host import log.csv --propose -o log.toml                   what is in it, and a mapping to complete
  socam-host import drive.blf --dbc motor.dbc                       frames of a CAN bus, by what a DBC says
  socam-host import log.csv --accept-guesses                        the likeliest units, printed
  socam-host import log.csv --map log.toml -o run.mcap
  socam-host import monday.csv tuesday.csv --map log.toml           the same mapping for several
  socam-host import \"runs/*.tdms\"                                  each one; 2 before 10
  socam-host import \"log_*.csv+\" -o run.mcap                       a run that its logger split, as one
  socam-host import run.csv@14:03:20..14:05 -o part.mcap            by the clock that wrote it
  socam-host import run.csv@2..10 -o part.mcap --note \"new coupling\"
  socam-host import old.m --calibration bench.toml")]
pub(crate) struct Args {
    /// Recordings, or parts of them: RUN@FROM..TO in seconds or clock times; wildcards in quotes; A+B joins files of one run
    #[arg(value_name = "RUN", required = true)]
    runs: Vec<String>,
    /// File to write, for a single RUN [default: beside RUN, with the extension .mcap; a mapping goes to stdout]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write a mapping of the file's signals to channels, to be completed
    #[arg(long, conflicts_with_all = ["map", "calibration", "note"])]
    propose: bool,
    /// Take the likeliest unit and time where the file states none, and say which; the mapping is kept in the log
    #[arg(long, conflicts_with_all = ["propose", "map", "calibration"])]
    accept_guesses: bool,
    /// Mapping of signals to channels, as --propose writes it
    #[arg(long, value_name = "MAP.toml", conflicts_with = "calibration")]
    map: Option<PathBuf>,
    /// DBC that says what the frames of a CAN bus hold (candump, ASC, BLF) [default: the only one beside RUN]; a mapping names its own
    #[arg(long, value_name = "FILE.dbc", conflicts_with_all = ["map", "calibration"])]
    dbc: Option<PathBuf>,
    /// Calibration file (`template calibration` prints one) that converts the volts of a legacy .m log into SI: channels in the order of the log's inputs
    #[arg(long, value_name = "C.toml")]
    calibration: Option<PathBuf>,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
    /// Note to store in the log
    #[arg(long, value_name = "TEXT")]
    note: Option<String>,
}

pub(crate) fn run(mut args: Args) -> anyhow::Result<Outcome> {
    args.runs = output::expanded(&args.runs)?;
    output::single_output(&args.runs, args.output.as_deref())?;
    if args.propose {
        return propose(&args);
    }
    let calibration = args.calibration.as_deref().map(read_calibration).transpose()?;
    let map = args.map.as_deref().map(read_mapping).transpose()?;
    let mut outcome = Outcome::Done;
    for run in &args.runs {
        let selection = Selection::parse(run)?;
        let log = match (&map, &calibration) {
            (Some((mapping, attachment)), _) => Log::mapped(&selection, mapping, attachment)?,
            (None, Some((calibration, attachment))) => Log {
                attachments: attachment.to_vec(),
                ..Log::own(Dataset::open_calibrated(&selection, calibration)?, &selection)?
            },
            (None, None) if args.accept_guesses => Log::guessed(&selection, args.dbc.as_deref())?,
            (None, None) => Log::stated(&selection, args.dbc.as_deref())?,
        };
        output::say_warnings(run, &log.data);
        log.write(&selection, &args)?;
        if Outcome::on([&log.data]) == Outcome::LostSamples {
            outcome = Outcome::LostSamples;
        }
    }
    Ok(outcome)
}

/// Writes a mapping to complete, and prints its basis.
fn propose(args: &Args) -> anyhow::Result<Outcome> {
    let [run] = args.runs.as_slice() else {
        let problem = format!("--propose takes one recording, not {}", args.runs.len());
        return Err(WrongArguments(problem).into());
    };
    // Files that are joined have the same signals.
    let selection = Selection::parse(run)?;
    let proposal = socam_import::propose(&selection.path, args.dbc.as_deref())?;
    output::say(understood::proposed(&proposal));
    match &args.output {
        None => output::print(&proposal.text)?,
        Some(target) => {
            output::check_target_of(target, &selection, args.force)?;
            let mut file = output::create_new(target, args.force)?;
            file.write_all(proposal.text.as_bytes())
                .with_context(|| format!("cannot write `{}`", target.display()))?;
            file.commit()?;
            output::say(format_args!("mapping written to {}", target.display()));
        }
    }
    Ok(Outcome::Done)
}

fn read_mapping(path: &Path) -> anyhow::Result<(Mapping, [Attachment; 1])> {
    let mapping = Mapping::open(path)?;
    let text =
        socam_recording::read_text(path).with_context(|| format!("cannot read `{}`", path.display()))?;
    Ok((mapping, record::attachment("import.toml", text)))
}

/// A calibration with the text of its file, which is stored in the log.
fn read_calibration(path: &Path) -> anyhow::Result<(Calibration, [Attachment; 1])> {
    let calibration = Calibration::open(path)?;
    let text =
        socam_recording::read_text(path).with_context(|| format!("cannot read `{}`", path.display()))?;
    Ok((calibration, record::attachment("calibration.toml", text)))
}

/// A recording to write, with its metadata and attachments.
struct Log {
    data: Dataset,
    metadata: BTreeMap<String, String>,
    attachments: Vec<Attachment>,
}

impl Log {
    /// A recording of one of this program's formats.
    fn own(data: Dataset, selection: &Selection) -> anyhow::Result<Self> {
        let metadata = settings(&data, selection)?;
        Ok(Self { data, metadata, attachments: Vec::new() })
    }

    /// A recording whose file states units and times of all signals.
    fn stated(selection: &Selection, dbc: Option<&Path>) -> anyhow::Result<Self> {
        Self::opened(socam_import::open_either(selection, dbc)?, selection)
    }

    fn opened(opened: Opened, selection: &Selection) -> anyhow::Result<Self> {
        match opened {
            Opened::Own(data) => Self::own(data, selection),
            Opened::Foreign(imported) => Ok(Self::imported(imported, selection)),
        }
    }

    /// A recording whose file leaves open what its numbers are: with the likeliest units and times.
    fn guessed(selection: &Selection, dbc: Option<&Path>) -> anyhow::Result<Self> {
        let guessed = match socam_import::open_either(selection, dbc) {
            Err(ImportError::Unstated { .. }) => socam_import::import_guessed(selection, dbc)?,
            opened => return Self::opened(opened?, selection),
        };
        for taken in &guessed.taken {
            output::say(format_args!("guessed: {taken}"));
        }
        let attachments = record::attachment("import.toml", guessed.mapping).to_vec();
        Ok(Self { attachments, ..Self::imported(guessed.imported, selection) })
    }

    fn mapped(selection: &Selection, mapping: &Mapping, attachment: &[Attachment]) -> anyhow::Result<Self> {
        let log = Self::imported(socam_import::import(selection, mapping)?, selection);
        Ok(Self { attachments: attachment.to_vec(), ..log })
    }

    fn imported(imported: Imported, selection: &Selection) -> Self {
        output::say(understood::imported(&imported));
        let metadata = [("source".to_owned(), selection.name())].into();
        Self { data: imported.data, metadata, attachments: Vec::new() }
    }

    fn write(&self, selection: &Selection, args: &Args) -> anyhow::Result<()> {
        let target = args.output.clone().unwrap_or_else(|| selection.path.with_extension("mcap"));
        output::check_target_of(&target, selection, args.force)?;
        let mut metadata = self.metadata.clone();
        metadata.insert("host".into(), env!("CARGO_PKG_VERSION").into());
        metadata.extend(args.note.clone().map(|note| ("note".to_owned(), note)));
        import_mcap(&self.data, modified_unix_ns(selection), metadata, self.attachments.clone(), &target)?;
        output::say(format_args!(
            "{} samples of {} channels written to {}",
            self.data.rows(),
            self.data.channels().len(),
            target.display()
        ));
        Ok(())
    }
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

/// Time at which the file was last written: the best guess of the time of recording, and the same at every import.
fn modified_unix_ns(selection: &Selection) -> u64 {
    let modified = selection.path.metadata().and_then(|m| m.modified()).ok();
    let since = modified.and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    since.and_then(|s| u64::try_from(s.as_nanos()).ok()).unwrap_or(0)
}
