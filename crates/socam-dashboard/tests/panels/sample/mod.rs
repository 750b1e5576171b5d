//! Things to show, made up: recordings with gaps, spikes and missing values, a diagnosis, and a running bench.

pub(crate) mod bench;
pub(crate) mod fleet;
pub(crate) mod machine;
pub(crate) mod source;

mod tiles;
mod troubled;

use std::f64::consts::TAU;

use socam_chart::theme::Look;
use socam_dashboard::diagnosis::Over;
use socam_dashboard::spectra::ChartType;
use socam_dashboard::{Dashboard, Layout, View};
use socam_findings::Evidence;
use socam_findings::document::Overlay;
use socam_findings::evidence::{Binned, ChannelEvidence, RecordingTraces, Spectrum, Trace};
use socam_recording::{Channel, Dataset, Epoch, Unit};
use socam_samples::Samples;
use socam_spectrum::{Detrend, Window};
use socam_workbench::arrangement::Arrangement;
use socam_workbench::document::{Document, parse};
use socam_workbench::recording::{About, Recording};
use socam_workbench::spectrum_settings::{Scaling, SpectrumSettings};

/// Numbers without pattern, the same on every machine.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
    }
}

pub(crate) fn channels() -> Vec<Channel> {
    vec![
        Channel::new("command", Unit::V),
        Channel::new("motor_speed", Unit::RadPerS),
        Channel::new("output_speed", Unit::RadPerS),
        Channel::new("torque_in", Unit::Nm),
        Channel::new("torque_out", Unit::Nm),
    ]
}

/// A run of the default bench as one might imagine it; `number` makes it differ from others.
pub(crate) fn run(number: u32, rows: usize) -> Recording {
    let mut noise = Noise(u64::from(number) + 1);
    let slow = 0.5 + 0.07 * f64::from(number);
    let time_s: Vec<f64> = (0..rows).map(|row| row as f64 * 1e-3).collect();
    let mut columns = vec![Vec::new(); 5];
    for t in &time_s {
        let speed = 60.0 * (TAU * slow * t).sin() + 12.0 * (TAU * 4.0 * t).sin();
        let torque = 0.4 * speed.signum() + 0.02 * speed;
        let values = [speed / 75.0, speed, speed / 8.0, torque / 8.0, torque];
        let stds = [0.0, 0.1, 0.02, 0.004, 0.02];
        for ((column, value), std) in columns.iter_mut().zip(values).zip(stds) {
            column.push(value + std * noise.next());
        }
    }
    of(&format!("runs/multisine-{number}.mcap"), time_s, columns)
}

pub(crate) fn of(name: &str, time_s: Vec<f64>, columns: Vec<Vec<f64>>) -> Recording {
    let channels: Vec<Channel> = channels().into_iter().take(columns.len()).collect();
    with_channels(name, channels, time_s, columns)
}

pub(crate) fn with_channels(
    name: &str,
    channels: Vec<Channel>,
    time_s: Vec<f64>,
    columns: Vec<Vec<f64>>,
) -> Recording {
    let data = Dataset::from_columns(name, channels.clone(), time_s.clone(), columns.clone()).unwrap();
    let about =
        About { name: name.into(), channels, sample_time_s: data.sample_time_s(), ..About::default() };
    Recording::in_memory(about, Samples::in_memory(time_s, &columns, data.segments().to_vec()))
}

/// A diagnosis as its file has it.
pub(crate) const DIAGNOSIS: &str = include_str!("diagnosis.json");
/// An identification as its file has it.
pub(crate) const IDENTIFICATION: &str = include_str!("identification.json");

/// Residuals that show dry friction at the load's bearing.
pub(crate) fn evidence() -> Evidence {
    let mut noise = Noise(5);
    let stds = [("output_speed", "rad/s", 0.02), ("torque_in", "N m", 0.01), ("torque_out", "N m", 0.05)];
    let mut channels = Vec::new();
    let mut traces = Vec::new();
    for (name, unit, std) in stds {
        let mut binned = |from: f64, to: f64, shape: fn(f64) -> f64| {
            let x: Vec<f64> = (0..30).map(|n| from + (to - from) * (f64::from(n) + 0.5) / 30.0).collect();
            let before = x.iter().map(|x| 3.0 * std * shape(*x) + 0.2 * std * noise.next()).collect();
            let after = x.iter().map(|_| 0.2 * std * noise.next()).collect();
            Some(Binned {
                x,
                before,
                before_std: vec![0.1 * std; 30],
                after,
                after_std: vec![0.08 * std; 30],
            })
        };
        let frequency_hz: Vec<f64> = (1..400).map(|n| 0.1 * 1.02_f64.powi(n)).collect();
        let over = [
            binned(-9.0, 9.0, |x| (3.0 * x).tanh()),
            binned(0.0, TAU, |x| 0.2 * x.sin()),
            binned(-2.0, 2.0, |x| 0.7 * x),
        ];
        let floor = std * 0.045;
        let spectrum = Spectrum {
            before: frequency_hz
                .iter()
                .map(|f| floor * (1.0 + 60.0 / (1.0 + f * f)) * (1.0 + 0.4 * noise.next()))
                .collect(),
            after: frequency_hz.iter().map(|_| floor * (1.0 + 0.4 * noise.next())).collect(),
            noise: vec![floor; frequency_hz.len()],
            frequency_hz,
        };
        let [over_speed, over_angle, over_torque] = over;
        channels.push(ChannelEvidence {
            name: name.into(),
            unit: unit.into(),
            noise_std: std,
            over_speed,
            over_angle,
            over_torque,
            spectrum: Some(spectrum),
        });
        let time_s: Vec<f64> = (0..8000).map(|n| f64::from(n) * 1e-3).collect();
        let after: Vec<f64> = time_s.iter().map(|_| 2.0 * std * noise.next()).collect();
        let before = time_s
            .iter()
            .zip(&after)
            .map(|(t, rest)| 3.0 * std * (TAU * 0.5 * t).sin().signum() + rest)
            .collect();
        traces.push(Trace { channel: name.into(), time_s, before, after });
    }
    let recordings =
        vec![RecordingTraces { name: "runs/reversals-1.mcap".into(), held_out: true, channels: traces }];
    Evidence { recordings, channels }
}

pub(crate) fn dashboard(look: Look, view: View) -> Dashboard {
    Dashboard::new(Layout { look, view, ..Layout::default() })
}

fn with_runs(look: Look, view: View, runs: u32) -> Dashboard {
    let mut dashboard = dashboard(look, view);
    (0..runs).for_each(|number| dashboard.add_recording(run(number, 8000)));
    dashboard
}

fn with_spectra(look: Look, kind: ChartType, runs: u32) -> Dashboard {
    let mut dashboard = with_runs(look, View::Frequency, runs);
    dashboard.views.frequency.kind = kind;
    dashboard
}

/// Speeds of which the model misses the reversals.
fn overlay() -> Overlay {
    let mut noise = Noise(9);
    let mut shown = Overlay {
        channel: "output_speed".into(),
        unit: "rad/s".into(),
        recording: "runs/reversals-1.mcap".into(),
        held_out: true,
        ..Overlay::default()
    };
    for row in 0..1500 {
        let t = f64::from(row) * 1e-3;
        let speed = 4.0 * (TAU * 1.3 * t).sin() + 0.6 * (TAU * 6.0 * t).sin();
        let missed = 0.5 * speed.signum();
        let measured = speed + 0.1 * noise.next();
        shown.time_s.push(2.0 + t);
        shown.measured.push(Some(measured));
        shown.before.push(Some(speed + missed));
        shown.after.push(Some(speed));
        shown.residual_before.push(Some(measured - speed - missed));
        shown.residual_after.push(Some(measured - speed));
    }
    shown
}

fn diagnosed(look: Look, over: Over) -> Dashboard {
    let mut dashboard = dashboard(look, View::Diagnosis);
    if let Ok(Document::Diagnosis(mut diagnosis, Some(model))) = parse("diagnosis.json", DIAGNOSIS) {
        diagnosis.overlay = Some(overlay());
        dashboard.views.diagnosis.show(*diagnosis, Some(evidence()), *model);
    }
    dashboard.views.diagnosis.page.over = over;
    dashboard
}

/// The states in which the views are looked at, by name: with data and without, with twelve recordings, with one sample, with long
/// names, gaps, missing values and spikes, with something wrong.
pub(crate) const STATES: [&str; 54] = [
    "time-clock",
    "spectrum-window",
    "identify-range",
    "machine-columns",
    "time-bench",
    "time-formula",
    "response-decibel",
    "time-tiles",
    "time-thirty",
    "time-derive",
    "time",
    "time-trouble",
    "time-one-sample",
    "time-nothing",
    "time-differences",
    "time-twelve",
    "time-empty",
    "time-wrong",
    "spectrum",
    "spectrum-twelve",
    "spectrum-trouble",
    "response",
    "poles",
    "check",
    "check-twelve",
    "identify",
    "identify-empty",
    "identify-setup",
    "diagnosis",
    "diagnosis-signals",
    "diagnosis-torque",
    "diagnosis-frequency",
    "diagnosis-time",
    "diagnosis-fit",
    "diagnosis-shape",
    "diagnosis-empty",
    "diagnosis-angle",
    "live-empty",
    "live",
    "live-fault",
    "live-text",
    "live-drive",
    "live-drive-run",
    "watch",
    "fleet",
    "fleet-machine",
    "fleet-findings",
    "fleet-unfit",
    "fleet-empty",
    "machine",
    "machine-empty",
    "machine-new",
    "machine-sliding",
    "help",
];

/// A dashboard in one of the [`STATES`].
pub(crate) fn state(name: &str, look: Look) -> Option<Dashboard> {
    let mut state = match name {
        "time" | "time-differences" => with_runs(look, View::Time, 3),
        "time-trouble" | "time-one-sample" | "time-nothing" | "time-empty" => dashboard(look, View::Time),
        "time-twelve" => with_runs(look, View::Time, 12),
        "time-tiles" | "time-derive" | "time-bench" | "time-formula" => with_runs(look, View::Time, 2),
        "time-clock" => with_runs(look, View::Time, 2),
        "spectrum-window" => with_spectra(look, ChartType::Spectrum, 2),
        "identify-range" => with_runs(look, View::Identify, 2),
        "time-thirty" => with_runs(look, View::Time, 30),
        "time-wrong" => with_runs(look, View::Time, 1),
        "spectrum" => with_spectra(look, ChartType::Spectrum, 2),
        "spectrum-twelve" => with_spectra(look, ChartType::Spectrum, 12),
        "spectrum-trouble" => dashboard(look, View::Frequency),
        "response" | "response-decibel" => with_spectra(look, ChartType::Response, 2),
        "poles" => with_spectra(look, ChartType::Poles, 0),
        "check" => with_runs(look, View::Check, 2),
        "identify" | "identify-empty" => dashboard(look, View::Identify),
        "identify-setup" => with_runs(look, View::Identify, 3),
        "check-twelve" => with_runs(look, View::Check, 12),
        "diagnosis" => diagnosed(look, Over::Speed),
        "diagnosis-signals" => diagnosed(look, Over::Signals),
        "diagnosis-torque" => diagnosed(look, Over::Torque),
        "diagnosis-frequency" => diagnosed(look, Over::Frequency),
        "diagnosis-time" => diagnosed(look, Over::Time),
        "diagnosis-fit" => diagnosed(look, Over::Fit),
        "diagnosis-shape" => diagnosed(look, Over::Shape),
        "diagnosis-empty" => dashboard(look, View::Diagnosis),
        "diagnosis-angle" => diagnosed(look, Over::Angle),
        "live-empty" => dashboard(look, View::Live),
        "live" => bench::running(look),
        "live-fault" => bench::stopped(look),
        "live-text" => source::text(look),
        "live-drive" => source::drive(look),
        "live-drive-run" => source::commanded(look),
        "watch" => with_runs(look, View::Watch, 2),
        "fleet" | "fleet-machine" | "fleet-findings" | "fleet-unfit" => fleet::showing(look, name),
        "fleet-empty" => dashboard(look, View::Fleet),
        "machine" | "machine-empty" | "machine-new" | "machine-sliding" | "machine-columns" => {
            machine::showing(look, name)
        }
        "help" => with_runs(look, View::Time, 1),
        _ => return None,
    };
    match name {
        "help" => state.help.is_open = true,
        "time" => state.views.time.cursors = Some([2.5, 5.25]),
        "time-tiles" => state.views.time.arrange(&tiles::tiles()),
        "time-bench" => state.views.time.arrange(&tiles::bench()),
        "time-formula" => {
            state.views.time.ask_for_formula("torque_out*output_speed/(torque_in*mot");
        }
        "response-decibel" => state.views.frequency.in_decibel = true,
        "time-derive" => {
            state.views.time.ask_for_channel("torque_out");
            state.views.time.derive(tiles::power());
        }
        "time-clock" => {
            // 1 May 2026, 14:03:20 in UTC.
            state.workspace.entries[0].recording.about.epoch = Some(Epoch::Date(1_777_644_200_000_000_000));
            state.views.time.arrange(&Arrangement { clock_time: true, ..tiles::bench() });
            state.views.time.x = Some([1.5, 6.5]);
            state.workspace.has_bench = true;
        }
        "spectrum-window" => {
            let spectra = SpectrumSettings {
                window: Window::FlatTop,
                length: Some(1024),
                overlap_percent: 75,
                detrend: Detrend::Line,
                in_sight: true,
                scaling: Scaling::Amplitude,
            };
            state.views.time.arrange(&Arrangement { spectra, ..Arrangement::default() });
            state.workspace.in_sight = Some([2.0, 6.0]);
        }
        "identify-range" => state.workspace.setup.range_s = Some([2.25, 6.5]),
        "time-differences" => state.views.time.reference = Some(0),
        "time-trouble" | "spectrum-trouble" => state.add_recording(troubled::troubled(8000)),
        "time-one-sample" => state.add_recording(of("one.csv", vec![2.0], vec![vec![1.0], vec![f64::NAN]])),
        "time-nothing" => {
            state.add_recording(of("nothing.csv", vec![0.0, 1.0, 2.0], vec![vec![f64::NAN; 3]; 2]));
        }
        "time-wrong" => state.warn(
            "runs/broken.mcap: this is no recording: byte 0 is not that of an MCAP log, a CSV table or a legacy log; expected one of these",
        ),
        "identify" => state.show(parse("fit.json", IDENTIFICATION).unwrap()),
        _ => {}
    }
    Some(state)
}
