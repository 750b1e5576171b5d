//! Whether a recording can carry a fit, said before any fit: excitation, clipped and stuck channels, spikes, gaps, hum, speeds that break the ratio.
//!
//! One pass over the data. Findings are values with their numbers; what to record instead is part of each.

mod excitation;
mod finding;
mod flat;
mod held;
mod ratio;
mod scatter;
mod spectrum;

use serde::Serialize;

use crate::dataset::{Block, Dataset, Warning};
use crate::error::Result;
use crate::{Channel, Unit};
use excitation::TurningPoints;
pub use finding::{Finding, Severity};
use flat::FlatParts;
pub use held::{Held, HeldAt, Saturation, held, saturations};
use ratio::RatioFit;
use scatter::{Scatter, Spikes};
use spectrum::{Gatherer, Spectrum};

/// Rows below which no dynamic model can be fitted.
const FEWEST_ROWS: u64 = 200;

/// Values of one channel that may be missing before it is said, as a share of all rows.
const MISSING_SHARE: f64 = 0.001;

/// Deviation of single steps from the sample time that is said, as a share of it. Prediction assumes even steps; a
/// deviation of a tenth shifts a sample by a tenth of a step.
const JITTER_SHARE: f64 = 0.1;

/// Signal to noise below which a channel says little, dB.
pub(crate) const LOWEST_SNR_DB: f64 = 10.0;

/// Spread of the input, as a share of its mean, below which it counts as standing still.
const SMALLEST_SPREAD: f64 = 0.005;

/// Fewest spectral lines that determine a drivetrain with a handful of parameters: each line gives two equations per
/// output. A model with many parameters and few outputs needs more.
const FEWEST_LINES: usize = 3;

/// How far from a resonance, as a factor of frequency, the input still excites it: a quarter up or down.
const BESIDE_RESONANCE: f64 = 1.25;

/// What to check against: what a model says of the channels that it reads. By default nothing is known of them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CheckOptions {
    /// The channel that drives the model; `motor_speed`, else `command`, when `None`.
    pub input: Option<String>,
    /// The channels that a model reads, its input among them, by name or column: these are looked at, and those that are not
    /// there are a finding. When empty, all are looked at.
    pub channels: Vec<String>,
    /// Units of channels that nothing in the model converts: channel and the unit's symbol.
    pub units: Vec<(String, String)>,
    /// Fixed ratios between two speeds; checked where both channels are there.
    pub ratios: Vec<FixedRatio>,
    /// Resonances of the model.
    pub resonances: Vec<Resonance>,
    /// What must move both ways.
    pub both_ways: Vec<BothWays>,
    /// How many parameters the model leaves free, over how many outputs.
    pub free: Option<FreeParameters>,
}

/// What the input has to determine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FreeParameters {
    /// Parameters to identify.
    pub parameters: usize,
    /// Channels that the model predicts.
    pub outputs: usize,
}

impl FreeParameters {
    /// Fewest lines of the input that can determine them: each gives an amplitude and a phase per output.
    fn lines(self) -> usize {
        self.parameters.div_ceil(2 * self.outputs.max(1))
    }
}

/// A resonance of the model, and what is learned by exciting it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Resonance {
    /// Its natural frequency, Hz.
    pub frequency_hz: f64,
    /// The free parameters that decide it, strongest first.
    pub parameters: Vec<String>,
}

/// A motion that must turn round, so that friction, which turns with it, is told from a load, which does not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BothWays {
    /// The channel that measures it: a speed, or an angle or position.
    pub channel: String,
    /// The parameters that are told apart by it.
    pub parameters: Vec<String>,
}

/// Two speeds that gears and shafts tie together.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedRatio {
    /// The faster one.
    pub fast: Speed,
    /// The slower one.
    pub slow: Speed,
    /// Speed of `fast` over speed of `slow`.
    pub ratio: f64,
    /// Relative deviation of the average that is let pass, such as 0.01.
    pub tolerance: f64,
}

/// A channel that measures a speed.
#[derive(Debug, Clone, PartialEq)]
pub struct Speed {
    /// Its name or column.
    pub channel: String,
    /// Speed = scale * column + offset.
    pub scale: f64,
    /// See `scale`.
    pub offset: f64,
}

impl Speed {
    fn si(&self, value: f64) -> f64 {
        self.scale * value + self.offset
    }
}

/// Whether a recording is fit for use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing stands in the way.
    Fit,
    /// A fit is possible; the findings say where it will be weak.
    FitWithReservations,
    /// A fit would mean nothing.
    Unfit,
}

/// What a check came to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// The recording's name.
    pub recording: String,
    /// The verdict: the worst of the findings.
    pub verdict: Verdict,
    /// The channel taken as the input; `None` when none was named and none has a usual name.
    pub input: Option<String>,
    /// Excitation of each channel that was looked at, in the dataset's order.
    pub channels: Vec<ChannelCheck>,
    /// What was found, worst first.
    pub findings: Vec<Finding>,
}

/// How one channel moves. Noise ratio, band and lines of an angle or a position are those of its rate of change: a shaft that
/// turns makes a ramp, whose spectrum says nothing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelCheck {
    /// The channel's name.
    pub name: String,
    /// Its unit.
    pub unit: Unit,
    /// Half of peak to peak, in the unit.
    pub amplitude: f64,
    /// Estimated standard deviation of its noise (white, from the top quarter of the spectrum and from the scatter of neighbouring
    /// samples, whichever is less), in the unit; `None` for an angle or a position.
    pub noise_std: Option<f64>,
    /// Signal to noise, dB.
    pub snr_db: Option<f64>,
    /// Lowest and highest frequency with power above the noise, Hz.
    pub band_hz: Option<[f64; 2]>,
    /// Distinct spectral lines (or their number's worth of continuous band) above the noise.
    pub lines: Option<usize>,
    /// Jumps of more than 2 % of peak to peak within one sample.
    pub steps: u64,
    /// Changes of direction larger than a tenth of peak to peak.
    pub turning_points: u64,
    /// Changes of sign, with a tenth of peak to peak as hysteresis.
    pub sign_changes: u64,
}

/// Checks a recording.
///
/// # Errors
/// When the input does not exist and is none of the model's channels, or the file cannot be read again.
pub fn check(data: &Dataset, options: &CheckOptions) -> Result<Check> {
    let input = input_channel(data, options)?;
    let (looked_at, missing) = looked_at(data, options, input);
    let mut pass = Pass::new(data, options);
    for block in data.blocks()? {
        pass.take(&block?);
    }
    let mut findings = about_the_rows(data);
    if !missing.is_empty() {
        let available = data.channels().iter().map(Channel::column_name).collect();
        findings.push(Finding::MissingChannels { channels: missing, available });
    }
    findings.extend(options.units.iter().filter_map(|(channel, expected)| {
        let channel = &data.channels()[data.channel_index(channel).ok()?];
        (channel.unit.symbol() != expected).then(|| Finding::WrongUnit {
            channel: channel.name.clone(),
            unit: channel.unit,
            expected: expected.clone(),
        })
    }));
    let mut channels = Vec::new();
    for (index, probe) in pass.probes.into_iter().enumerate().filter(|(index, _)| looked_at[*index]) {
        let (channel, mut found) = probe.finish(data, index, (Some(index) == input).then_some(options));
        channels.push(channel);
        findings.append(&mut found);
    }
    findings.extend(pass.ratios.into_iter().filter_map(RatioFit::finish));
    findings.extend(options.both_ways.iter().filter_map(|motion| one_way(data, motion, &channels)));
    if input.is_none() && options.input.is_none() {
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

/// Which of the recording's channels are looked at (the input always is), and which the recording lacks.
fn looked_at(data: &Dataset, options: &CheckOptions, input: Option<usize>) -> (Vec<bool>, Vec<String>) {
    let mut looked_at = vec![options.channels.is_empty(); data.channels().len()];
    let mut missing = Vec::new();
    for name in &options.channels {
        match data.channel_index(name) {
            Ok(index) => looked_at[index] = true,
            Err(_) => missing.push(name.clone()),
        }
    }
    if let Some(input) = input {
        looked_at[input] = true;
    }
    (looked_at, missing)
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
    if data.lost_samples() > 0 {
        findings.push(Finding::LostSamples { samples: data.lost_samples() });
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

/// Everything gathered while the blocks pass by.
struct Pass {
    probes: Vec<Probe>,
    ratios: Vec<RatioFit>,
}

impl Pass {
    fn new(data: &Dataset, options: &CheckOptions) -> Self {
        let longest = data.segments().iter().map(|s| s.rows).max().unwrap_or(0);
        let probes = data
            .statistics()
            .iter()
            .zip(data.channels())
            .enumerate()
            .map(|(index, (statistics, channel))| {
                let min = statistics.min.unwrap_or(0.0);
                let max = statistics.max.unwrap_or(0.0);
                Probe {
                    welch: Gatherer::new(longest, data.sample_time_s()),
                    flat: FlatParts::of(data, index),
                    scatter: Scatter::new(),
                    spikes: Spikes::new(min, max),
                    turning: TurningPoints::new(min, max),
                    segment: 0,
                    rate: matches!(channel.unit, Unit::Rad | Unit::M)
                        .then(|| Rate { previous: None, sample_time_s: data.sample_time_s() }),
                }
            })
            .collect();
        let ratios = options.ratios.iter().filter_map(|fixed| {
            let fast = data.channel_index(&fixed.fast.channel).ok()?;
            let slow = data.channel_index(&fixed.slow.channel).ok()?;
            Some(RatioFit::new(fixed.clone(), fast, slow))
        });
        Self { probes, ratios: ratios.collect() }
    }

    fn take(&mut self, block: &Block) {
        for (probe, column) in self.probes.iter_mut().zip(&block.columns) {
            if probe.segment != block.segment {
                probe.segment = block.segment;
                probe.interrupt();
            }
            for value in column.values() {
                probe.take(*value);
            }
        }
        for ratio in &mut self.ratios {
            ratio.take(block);
        }
    }
}

/// What is gathered about one channel.
struct Probe {
    welch: Gatherer,
    flat: FlatParts,
    scatter: Scatter,
    spikes: Spikes,
    turning: TurningPoints,
    segment: usize,
    /// Turns an angle or a position into its rate for the spectrum.
    rate: Option<Rate>,
}

struct Rate {
    previous: Option<f64>,
    sample_time_s: f64,
}

impl Probe {
    fn interrupt(&mut self) {
        self.welch.interrupt();
        self.scatter.interrupt();
        if let Some(rate) = &mut self.rate {
            rate.previous = None;
        }
    }

    fn take(&mut self, value: f64) {
        if value.is_nan() {
            self.interrupt();
            return;
        }
        match &mut self.rate {
            None => self.welch.push(value),
            Some(rate) => {
                if let Some(previous) = rate.previous.replace(value) {
                    self.welch.push((value - previous) / rate.sample_time_s);
                }
            }
        }
        self.flat.push(value);
        self.scatter.push(value);
        self.spikes.push(value);
        self.turning.push(value);
    }

    /// `input_of`: what the channel has to excite, if it is the input.
    fn finish(
        self,
        data: &Dataset,
        index: usize,
        input_of: Option<&CheckOptions>,
    ) -> (ChannelCheck, Vec<Finding>) {
        let channel = &data.channels()[index];
        let statistics = &data.statistics()[index];
        let (min, max) = (statistics.min.unwrap_or(0.0), statistics.max.unwrap_or(0.0));
        let mut spectrum = self.welch.finish();
        if let (Some(spectrum), Some(noise_std)) = (&mut spectrum, self.scatter.noise_std(max - min))
            && self.rate.is_none()
        {
            spectrum.bound_noise(noise_std);
        }
        let counts = self.turning.finish();
        let check = ChannelCheck {
            name: channel.name.clone(),
            unit: channel.unit,
            amplitude: (max - min) / 2.0,
            noise_std: spectrum.as_ref().filter(|_| self.rate.is_none()).map(Spectrum::noise_std),
            snr_db: spectrum.as_ref().and_then(Spectrum::snr_db),
            band_hz: spectrum.as_ref().and_then(Spectrum::band_hz),
            lines: spectrum.as_ref().map(Spectrum::lines),
            steps: counts.steps,
            turning_points: counts.turning_points,
            sign_changes: counts.sign_changes,
        };
        let mut findings = Vec::new();
        if statistics.missing as f64 > MISSING_SHARE * data.rows() as f64 {
            findings.push(Finding::MissingValues {
                channel: channel.name.clone(),
                missing: statistics.missing,
                rows: data.rows(),
            });
        }
        if min == max {
            findings.push(Finding::Constant {
                channel: channel.name.clone(),
                unit: channel.unit,
                value: min,
                is_input: input_of.is_some(),
            });
            return (check, findings);
        }
        findings.extend(self.flat.finish().iter().map(|flat| flat.finding(channel, data.rows())));
        findings.extend(self.spikes.finish().map(|spiky| Finding::Spikes {
            channel: channel.name.clone(),
            unit: channel.unit,
            spikes: spiky.spikes,
            farthest: spiky.farthest,
            range: spiky.range,
        }));
        findings.extend(excitation_of(channel, &check, statistics, input_of));
        let still = |finding: &Finding| finding.severity() == Severity::Prevents;
        if let (Some(spectrum), Some(options)) = (&spectrum, input_of)
            && !findings.iter().any(still)
        {
            findings.extend(not_excited(channel, &check, spectrum, &options.resonances));
        }
        if let Some(spectrum) = spectrum.filter(|_| self.rate.is_none()) {
            findings.extend(spectrum.hum(channel));
        }
        (check, findings)
    }
}

/// Whether a channel moves enough to say anything.
fn excitation_of(
    channel: &Channel,
    check: &ChannelCheck,
    statistics: &crate::Statistics,
    input_of: Option<&CheckOptions>,
) -> Option<Finding> {
    let is_input = input_of.is_some();
    let needed =
        input_of.and_then(|options| options.free).map_or(FEWEST_LINES, |free| free.lines().max(FEWEST_LINES));
    let mean = statistics.mean.unwrap_or(0.0);
    let std = statistics.std.unwrap_or(0.0);
    let name = channel.name.clone();
    if is_input && std < SMALLEST_SPREAD * mean.abs() {
        let snr_db = check.snr_db;
        return Some(Finding::StandsStill { channel: name, unit: channel.unit, mean, std, snr_db });
    }
    match (check.snr_db, check.lines, check.band_hz) {
        // Taking the rate of an angle makes much of its noise: there it is no measure.
        (Some(snr_db), ..) if snr_db < LOWEST_SNR_DB && check.noise_std.is_some() => {
            Some(Finding::Buried { channel: name, snr_db, is_input })
        }
        (_, Some(lines), Some(band_hz)) if is_input && lines < needed => {
            Some(Finding::FewLines { channel: name, lines, needed, band_hz })
        }
        _ => None,
    }
}

/// The resonances that the input leaves alone.
fn not_excited(
    channel: &Channel,
    check: &ChannelCheck,
    spectrum: &Spectrum,
    resonances: &[Resonance],
) -> Option<Finding> {
    let band_hz = check.band_hz?;
    let left_alone = |resonance: &&Resonance| {
        let frequency_hz = resonance.frequency_hz;
        // Slower than the spectrum can tell from the mean.
        if frequency_hz < spectrum.lowest_hz() {
            return false;
        }
        !spectrum.moves_between(frequency_hz / BESIDE_RESONANCE, frequency_hz * BESIDE_RESONANCE)
    };
    let resonances: Vec<Resonance> = resonances.iter().filter(left_alone).cloned().collect();
    (!resonances.is_empty()).then(|| Finding::ResonancesNotExcited {
        channel: channel.name.clone(),
        resonances,
        band_hz,
        highest_hz: spectrum.highest_hz(),
    })
}

/// A motion that never turns round, but should.
fn one_way(data: &Dataset, motion: &BothWays, channels: &[ChannelCheck]) -> Option<Finding> {
    let name = &data.channels()[data.channel_index(&motion.channel).ok()?].name;
    let channel = channels.iter().find(|channel| channel.name == *name)?;
    let turns = match channel.unit {
        Unit::Rad | Unit::M => channel.turning_points,
        _ => channel.sign_changes,
    };
    (turns == 0).then(|| Finding::OneWay { channel: name.clone(), parameters: motion.parameters.clone() })
}
