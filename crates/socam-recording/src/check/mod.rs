//! Whether a recording can carry a fit, decided before any fit: excitation, clipped and stuck channels, spikes, gaps, mains hum,
//! speeds that deviate from their ratio.
//!
//! One pass over the data. Findings are values with their numbers; each says what to record instead.

mod document;
mod excitation;
mod finding;
mod flat;
mod held;
mod motion;
mod options;
mod outcome;
mod probe;
mod ratio;
mod runs;
mod scatter;
mod sentence;
mod spectrum;
mod turning_points;

use crate::Channel;
use crate::dataset::Dataset;
use crate::error::Result;
use crate::warning::Warning;
pub use document::{Document, SCHEMA};
use excitation::one_way;
pub use finding::{Finding, HeldAt, Severity};
pub use held::{Held, Saturation, held, saturations};
use motion::MotionFit;
pub use options::{AlongShaft, BothWays, CheckOptions, FixedRatio, FreeParameters, Resonance, Speed};
pub use outcome::{ChannelCheck, Check, Verdict};
use probe::Pass;
use ratio::RatioFit;

/// Fewest rows for a dynamic model.
const FEWEST_ROWS: u64 = 200;

/// Deviation of single steps from the sample time that is a finding, as a share of it. Prediction assumes even steps; a
/// deviation of a tenth shifts a sample by a tenth of a step.
const JITTER_SHARE: f64 = 0.1;

/// Checks a recording.
///
/// ```
/// # let data = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/run.rs"));
/// use socam_recording::check::{CheckOptions, Severity, Verdict, check};
///
/// let found = check(&data, &CheckOptions { channels: vec!["motor_speed".into(), "load_speed".into()], ..CheckOptions::default() })?;
/// assert_eq!(found.verdict, Verdict::Unfit);
/// let worst = &found.findings[0];
/// assert_eq!(worst.severity(), Severity::Prevents);
/// assert!(worst.sentence().contains("`load_speed`"));
/// assert!(!worst.remedy().is_empty());
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
///
/// # Errors
/// When the input does not exist and is none of the model's channels, or the file cannot be read again.
pub fn check(data: &Dataset, options: &CheckOptions) -> Result<Check> {
    let input = input_channel(data, options)?;
    let (checked, missing) = checked(data, options, input);
    let mut pass = Pass::new(data, options);
    for block in data.blocks()? {
        pass.take(&block?);
    }
    let mut findings = about_the_rows(data);
    if !missing.is_empty() {
        let available = data.channels().iter().map(Channel::column_name).collect();
        findings.push(Finding::MissingChannels { channels: missing, available });
    }
    findings
        .extend(options.units.iter().filter_map(|(channel, expected)| wrong_unit(data, channel, expected)));
    let mut channels = Vec::new();
    for (index, probe) in pass.probes.into_iter().enumerate().filter(|(index, _)| checked[*index]) {
        let (channel, mut found) = probe.finish(data, index, (Some(index) == input).then_some(options));
        channels.push(channel);
        findings.append(&mut found);
    }
    findings.extend(pass.ratios.into_iter().filter_map(RatioFit::finish));
    findings.extend(pass.motions.into_iter().filter_map(MotionFit::finish));
    findings.extend(options.both_ways.iter().filter_map(|motion| one_way(data, motion, &channels)));
    // A model without an input swings freely.
    if input.is_none() && options.input.is_none() && options.channels.is_empty() {
        findings.push(Finding::InputUnknown);
    }
    findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity()));
    let verdict = match findings.first().map(Finding::severity) {
        Some(Severity::Prevents) => Verdict::Unfit,
        Some(Severity::Weakens) => Verdict::FitWithReservations,
        Some(Severity::Note) | None => Verdict::Fit,
    };
    Ok(Check {
        recording: data.name().into(),
        verdict,
        input: input.map(|index| data.channels()[index].name.clone()),
        channels,
        findings,
    })
}

fn input_channel(data: &Dataset, options: &CheckOptions) -> Result<Option<usize>> {
    if let Some(name) = &options.input {
        let index = data.channel_index(name);
        return if options.channels.contains(name) { Ok(index.ok()) } else { index.map(Some) };
    }
    let usual = ["motor_speed", "command"];
    Ok(usual.iter().find_map(|name| data.channel_index(name).ok()))
}

/// Flags of the recording's channels that are checked (the input always is), and names of channels that the recording lacks.
fn checked(data: &Dataset, options: &CheckOptions, input: Option<usize>) -> (Vec<bool>, Vec<String>) {
    let mut checked = vec![options.channels.is_empty(); data.channels().len()];
    let mut missing = Vec::new();
    for name in &options.channels {
        match data.channel_index(name) {
            Ok(index) => checked[index] = true,
            Err(_) => missing.push(name.clone()),
        }
    }
    if let Some(input) = input {
        checked[input] = true;
    }
    (checked, missing)
}

fn wrong_unit(data: &Dataset, channel: &str, expected: &str) -> Option<Finding> {
    let channel = &data.channels()[data.channel_index(channel).ok()?];
    (channel.unit.symbol() != expected).then(|| Finding::WrongUnit {
        channel: channel.name.clone(),
        unit: channel.unit,
        expected: expected.into(),
    })
}

/// Findings that need no values: length, gaps, losses, uneven steps.
fn about_the_rows(data: &Dataset) -> Vec<Finding> {
    let mut findings = Vec::new();
    if data.rows() < FEWEST_ROWS {
        findings.push(Finding::TooShort { rows: data.rows(), needed: FEWEST_ROWS });
    }
    let gaps_s = data.segments().windows(2).map(|pair| pair[1].start_s - pair[0].end_s);
    let (count, total_s, longest_s) =
        gaps_s.fold((0, 0.0, 0.0_f64), |(n, sum, longest), gap_s| (n + 1, sum + gap_s, longest.max(gap_s)));
    if count > 0 {
        findings.push(Finding::Gaps { count, total_s, longest_s });
    }
    // Samples in damaged parts were recorded.
    let samples = if data.warnings().iter().any(Warning::is_damage) {
        data.warnings().iter().map(Warning::lost_samples).sum()
    } else {
        data.lost_samples()
    };
    if samples > 0 {
        findings.push(Finding::LostSamples { samples });
    }
    for warning in data.warnings() {
        match warning {
            Warning::CutOff { missing } => findings.push(Finding::CutOff { missing: missing.clone() }),
            Warning::Damaged { byte, bytes } => {
                findings.push(Finding::Damaged { byte: *byte, bytes: *bytes })
            }
            _ => {}
        }
    }
    let jitter_s = data.segments().iter().map(|s| s.jitter_s).fold(0.0, f64::max);
    if jitter_s > JITTER_SHARE * data.sample_time_s() {
        findings.push(Finding::UnevenSteps { sample_time_s: data.sample_time_s(), jitter_s });
    }
    findings
}
