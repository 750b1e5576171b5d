//! `dashboard`: the bench and its recordings in a window, or as a picture.

mod attended;
mod bench;
mod rehearsal;
mod remedy;
mod show;
mod simulated;
mod source;
mod wanted;
mod watcher;
mod window;

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::anyhow;
use socam_chart::theme::Look;
use socam_dashboard::{Dashboard, Layout, View, Viewport, picture};
use socam_job::VirtualBench;
use socam_recording::Calibration;
use socam_workbench::device::Stated;

use self::attended::Attended;
use self::rehearsal::Rehearsal;
use super::Outcome;
use crate::device::token::TokenArgs;
use crate::output::{self, WrongArguments};

/// Open the dashboard: the running bench, recordings, identification and diagnosis
///
/// Opens recordings of any format, models and input signals (.toml), identifications and diagnoses (.json, or the folder of a
/// report), and the table of a fleet (.parquet). With --screenshot it draws one picture without a display; when a recording in it is damaged or cut off, or lacks samples, it
/// ends with exit code 3.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host dashboard                                  connect to a board, or drop files into the window
  socam-host dashboard run.mcap@2..8 other.csv
  socam-host dashboard --device udp:0.0.0.0:9870        what a device sends, as it comes; a press records it
  socam-host dashboard --device moteus:/dev/ttyACM0?id=1 --rate 500 --watch rotor.toml
  socam-host dashboard report --screenshot bench.png    a diagnosis as a picture
  socam-host dashboard fleet.parquet                    the machines of a fleet")]
pub(crate) struct Args {
    /// Files to open: recordings or parts of them (RUN@FROM..TO in seconds or clock times), .toml, .json, the table of a fleet, or the folder of a report
    #[arg(value_name = "RUN")]
    files: Vec<String>,
    /// Draw a picture into this file (.png), without a display
    #[arg(long, value_name = "FILE.png")]
    screenshot: Option<PathBuf>,
    /// Replace the picture, if it exists
    #[arg(long, requires = "screenshot")]
    force: bool,
    /// View to begin with: live, time, frequency, check, identify (or parameters), diagnosis, watch, fleet, machine
    #[arg(long, value_name = "VIEW", value_parser = view)]
    view: Option<View>,
    /// Light theme
    #[arg(long, conflicts_with = "dark")]
    light: bool,
    /// Dark theme
    #[arg(long)]
    dark: bool,
    /// Size of the picture or window, points
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[f32; 2]>,
    /// Scale of the picture, pixels per point
    #[arg(long, value_name = "N", default_value_t = 1.0, requires = "screenshot")]
    scale: f32,
    /// Show differences of the other recordings to the first one in the view over time
    #[arg(long)]
    difference: bool,
    /// Diagnose the recordings as soon as they are open
    #[arg(long)]
    diagnose: bool,
    /// Held-out recordings, used for validation only; may be repeated
    #[arg(long, value_name = "RUN", requires = "diagnose")]
    holdout: Vec<String>,
    /// Watch the bench, or else the first recording, against this model; the other recordings are of the healthy bench
    #[arg(long, value_name = "MODEL", conflicts_with = "diagnose")]
    watch: Option<String>,
    /// Positions of the cursors A and B in the view over time, s
    #[arg(long, value_name = "A,B", value_delimiter = ',', allow_hyphen_values = true)]
    cursors: Vec<f64>,
    /// Moment of the recording at which the view of the machine begins, s
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    at: Option<f64>,
    /// Connect to a device at once, any that `record` takes: sim, serial, serial:PATH, tcp:HOST:PORT; serial:PATH?baud=RATE, udp:HOST:PORT,
    /// text+tcp:HOST:PORT; moteus:PATH?id=1, odrive:PATH?axis=0, dynamixel:PATH?id=1, slcan:PATH?bitrate=500k
    #[arg(long, value_name = "DEVICE")]
    device: Option<String>,
    /// File that says what the lines of a device hold: names, units, clock. Without one, what the device does not state is drawn as plain
    /// numbers, and the window offers to write it
    #[arg(long, value_name = "D.toml")]
    describe: Option<PathBuf>,
    /// Take units that names suggest without asking, and leave out signals whose names suggest none
    #[arg(long)]
    accept_guesses: bool,
    /// DBC that says what the frames of a CAN bus hold
    #[arg(long, value_name = "FILE.dbc")]
    dbc: Option<PathBuf>,
    /// Sampling rate of a run, and rate at which a device is asked, Hz
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Run and record the virtual bench for this time, s, report the frames per second and close the window; with --screenshot, draw the
    /// picture while it runs
    #[arg(long, value_name = "SECONDS", conflicts_with = "diagnose", value_parser = rehearsed)]
    rehearse: Option<f64>,
    /// Calibration file of the bench [default: that of the default bench]
    #[arg(long, value_name = "C.toml")]
    calibration: Option<PathBuf>,
    /// Folder for recorded runs
    #[arg(long, value_name = "DIR", default_value = ".")]
    record_into: PathBuf,
    #[command(flatten)]
    token: TokenArgs,
    #[command(flatten)]
    bench: VirtualBench,
}

/// Greatest time that a picture waits for its files.
const PATIENCE: Duration = Duration::from_secs(600);

/// Longest time until a device that moves has stopped after its window was closed: a drive is told to for 3 s, and a link that broke is
/// opened again for 2 s.
const STOPS_WITHIN: Duration = Duration::from_secs(8);

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    args.screenshot.iter().try_for_each(|path| output::check_free(path, args.force))?;
    let calibration = args.calibration.as_deref().map(Calibration::open).transpose()?;
    let layout = layout(&args)?;
    let size = layout.window;
    let attended = Attended::default();
    let mut dashboard = dashboard(&args, layout, calibration, &attended)?;
    let length = args.rehearse.map(Duration::from_secs_f64);
    let mut rehearsal = length.map(|length| Rehearsal::new(&mut dashboard, length));
    let Some(target) = args.screenshot else {
        dashboard.use_native_dialogs();
        let connects = args.device.is_some() && rehearsal.is_none();
        window::show(dashboard, rehearsal, connects)?;
        // What moves is stopped, and its file is closed, before this program ends.
        if !attended.wait(STOPS_WITHIN) {
            output::warn("the device did not end within 8 s: see that it is at rest");
        }
        return Ok(Outcome::Done);
    };
    if target.extension().is_none_or(|extension| extension != "png") {
        let message = format!("`{}`: a picture is written as .png", target.display());
        return Err(WrongArguments(message).into());
    }
    if let Some(rehearsal) = &mut rehearsal {
        rehearsal.go_on_until(&mut dashboard, Rehearsal::is_in_sight)?;
    }
    draw(&mut dashboard, Viewport { size, scale: args.scale }, args.view, &target)?;
    // The bench stops, and its file is closed, before this program ends.
    rehearsal.map_or(Ok(()), |mut rehearsal| rehearsal.go_on_until(&mut dashboard, |_| false))?;
    Ok(outcome(&dashboard))
}

/// Outcome of drawing a picture: whether its recordings are whole. Prints what they lack.
fn outcome(dashboard: &Dashboard) -> Outcome {
    let recordings = dashboard.workspace.entries.iter().map(|entry| &entry.recording.about);
    let incomplete: Vec<_> = recordings.filter(|about| about.is_incomplete).collect();
    for about in &incomplete {
        for warning in &about.warnings {
            output::warn(format_args!("{}: {warning}", about.name));
        }
    }
    if incomplete.is_empty() { Outcome::Done } else { Outcome::LostSamples }
}

/// The layout of the last window, or the default one for a picture, changed by the options.
fn layout(args: &Args) -> anyhow::Result<Layout> {
    // A picture does not depend on the layout of the last window.
    let mut layout = if args.screenshot.is_some() { Layout::default() } else { window::remembered() };
    if args.light || args.dark {
        layout.look = if args.light { Look::Light } else { Look::Dark };
        layout.look_is_chosen = true;
    }
    if let Some(view) = args.view {
        layout.view = view;
    }
    if let Some(size) = args.size {
        layout.window = size;
    }
    if let Some(device) = &args.device {
        layout.device.clone_from(device);
        layout.stated = Stated::default();
        // What is asked for is seen, unless files or another view are asked for too.
        if args.view.is_none() && args.files.is_empty() {
            layout.view = View::Live;
        }
    }
    let text = |path: &Option<PathBuf>| path.as_ref().map(|path| path.display().to_string());
    layout.stated.description = text(&args.describe).unwrap_or(layout.stated.description);
    layout.stated.dbc = text(&args.dbc).unwrap_or(layout.stated.dbc);
    layout.stated.takes_guesses |= args.accept_guesses;
    if args.rehearse.is_some() {
        layout.view = View::Live;
        if layout.device != "sim" {
            let message =
                format!("--rehearse moves the virtual bench only; arm and run `{}` by hand", layout.device);
            return Err(WrongArguments(message).into());
        }
    }
    Ok(layout)
}

/// A dashboard that begins to open the files.
fn dashboard(
    args: &Args,
    layout: Layout,
    calibration: Option<Calibration>,
    attended: &Attended,
) -> anyhow::Result<Dashboard> {
    let mut dashboard = Dashboard::new(layout);
    let model = socam_job::load_model(&args.bench.model)?;
    dashboard.use_model(model);
    dashboard.simulate_by(simulated::simulated);
    dashboard.workspace.next_run.folder = args.record_into.clone();
    if let Some(rate_hz) = args.rate {
        dashboard.workspace.next_run.rate_hz = rate_hz;
    }
    dashboard.workspace.bench.connect_by(bench::connector(
        args.bench.clone(),
        calibration,
        args.token.read()?,
        attended,
    ));
    let (files, held_out) = (output::expanded(&args.files)?, output::expanded(&args.holdout)?);
    let others = held_out.iter().filter(|run| !files.contains(run));
    dashboard.open(files.iter().chain(others).cloned());
    if let Some(view) = args.view {
        dashboard.show_first(view);
    }
    if let Some(model) = &args.watch {
        dashboard.use_model(socam_job::load_model(model)?);
        dashboard.watch();
    }
    if args.diagnose {
        dashboard.diagnose(held_out);
    }
    if let [a, b] = args.cursors[..] {
        dashboard.views.time.cursors = Some([a, b]);
    }
    if let Some(time_s) = args.at.filter(|time_s| time_s.is_finite()) {
        dashboard.views.machine.player.time_s = time_s;
    }
    dashboard.views.time.reference = args.difference.then_some(0);
    Ok(dashboard)
}

/// Draws the dashboard into a file once everything is open.
fn draw(
    dashboard: &mut Dashboard,
    viewport: Viewport,
    view: Option<View>,
    target: &Path,
) -> anyhow::Result<()> {
    let mut image = picture(dashboard, viewport, PATIENCE).map_err(|e| anyhow!(e))?;
    // Opening a file may have chosen another view.
    if let Some(view) = view.filter(|view| *view != dashboard.layout.view) {
        dashboard.layout.view = view;
        image = picture(dashboard, viewport, PATIENCE).map_err(|e| anyhow!(e))?;
    }
    if let Some(sentence) = dashboard.missing_letters() {
        output::warn(format_args!("{sentence}"));
    }
    let problem = dashboard.problems().next();
    // One file of several that cannot be opened does not cost the picture of the others.
    if problem.is_none() || !dashboard.workspace.entries.is_empty() {
        let bytes = socam_chart::raster::png(&image).map_err(|e| anyhow!(e))?;
        let mut file = output::create(target)?;
        std::io::Write::write_all(&mut file, &bytes)?;
        file.commit()?;
    }
    match problem {
        Some(problem) => anyhow::bail!("{problem}"),
        None => Ok(()),
    }
}

fn view(text: &str) -> Result<View, String> {
    let names: Vec<String> = View::ALL.iter().map(|view| view.name().to_lowercase()).collect();
    // The name of the view of results in earlier versions.
    let text = if text == "parameters" { "identify" } else { text };
    let found = names.iter().position(|name| name == text).map(|index| View::ALL[index]);
    found.ok_or_else(|| format!("expected one of {}", names.join(", ")))
}

fn rehearsed(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| (1.0..=600.0).contains(seconds));
    seconds.ok_or_else(|| "expected 1 to 600 seconds".into())
}

fn size(text: &str) -> Result<[f32; 2], String> {
    let numbers = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    let fits = |size: &[f32; 2]| size.iter().all(|points| (200.0..=8000.0).contains(points));
    numbers.filter(fits).ok_or_else(|| "expected a size from 200x200 to 8000x8000, as in 1280x800".into())
}

#[cfg(all(test, feature = "window-tests"))]
mod diagnosis_tests;
#[cfg(all(test, feature = "window-tests"))]
mod fleet_tests;
#[cfg(all(test, feature = "window-tests"))]
mod tests;
#[cfg(all(test, feature = "window-tests"))]
mod watch_tests;
