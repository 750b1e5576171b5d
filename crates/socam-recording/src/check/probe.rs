//! One pass over the rows: a probe per channel and a fit per fixed ratio.

use super::excitation::{excitation_of, not_excited};
use super::finding::{Finding, Severity};
use super::flat::FlatParts;
use super::motion::MotionFit;
use super::options::CheckOptions;
use super::outcome::ChannelCheck;
use super::ratio::RatioFit;
use super::scatter::{Scatter, Spikes};
use super::spectrum::{Gatherer, Spectrum};
use super::turning_points::TurningPoints;
use crate::Unit;
use crate::dataset::{Block, Dataset};

/// Share of missing values of a channel above which they are a finding.
const MISSING_SHARE: f64 = 0.001;

/// The probes of all channels and the fits of all ratios and of channels of one shaft.
pub(super) struct Pass {
    pub(super) probes: Vec<Probe>,
    pub(super) ratios: Vec<RatioFit>,
    pub(super) motions: Vec<MotionFit>,
}

impl Pass {
    pub(super) fn new(data: &Dataset, options: &CheckOptions) -> Self {
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
        let motions = options.shafts.iter().filter_map(|pair| {
            let [speed, other] = pair.channels().map(|name| data.channel_index(name).ok());
            Some(MotionFit::new(pair.clone(), [speed?, other?]))
        });
        Self { probes, ratios: ratios.collect(), motions: motions.collect() }
    }

    pub(super) fn take(&mut self, block: &Block) {
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
        for motion in &mut self.motions {
            motion.take(block);
        }
    }
}

/// The statistics of one channel.
pub(super) struct Probe {
    welch: Gatherer,
    flat: FlatParts,
    scatter: Scatter,
    spikes: Spikes,
    turning: TurningPoints,
    segment: usize,
    /// Differences an angle or a position for the spectrum; `None` for other quantities.
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

    /// The channel's entry and findings. `input_of`: the options, if this channel is the input.
    pub(super) fn finish(
        self,
        data: &Dataset,
        index: usize,
        input_of: Option<&CheckOptions>,
    ) -> (ChannelCheck, Vec<Finding>) {
        let channel = &data.channels()[index];
        let statistics = &data.statistics()[index];
        let (min, max) = (statistics.min.unwrap_or(0.0), statistics.max.unwrap_or(0.0));
        let is_rate = self.rate.is_some();
        let mut spectrum = self.welch.finish();
        if let (Some(spectrum), Some(noise_std)) = (&mut spectrum, self.scatter.noise_std(max - min))
            && !is_rate
        {
            spectrum.bound_noise(noise_std);
        }
        let counts = self.turning.finish();
        let check = ChannelCheck {
            name: channel.name.clone(),
            unit: channel.unit,
            amplitude: (max - min) / 2.0,
            noise_std: spectrum.as_ref().filter(|_| !is_rate).map(Spectrum::noise_std),
            snr_db: spectrum.as_ref().and_then(Spectrum::snr_db),
            band_hz: spectrum.as_ref().and_then(Spectrum::band_hz),
            lines: spectrum.as_ref().map(Spectrum::lines),
            steps: counts.steps,
            turning_points: counts.turning_points,
            sign_changes: counts.sign_changes,
        };
        let mut findings: Vec<Finding> = values_found(data, index, input_of.is_some()).collect();
        if min == max {
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
        let prevents = |finding: &Finding| finding.severity() == Severity::Prevents;
        if let (Some(spectrum), Some(options)) = (&spectrum, input_of)
            && !findings.iter().any(prevents)
        {
            findings.extend(not_excited(channel, &check, spectrum, &options.resonances));
        }
        findings.extend(spectrum.filter(|_| !is_rate).and_then(|spectrum| spectrum.hum(channel)));
        (check, findings)
    }
}

/// Findings that the channel's statistics alone give: values missing, or all equal.
fn values_found(data: &Dataset, index: usize, is_input: bool) -> impl Iterator<Item = Finding> {
    let (channel, statistics) = (&data.channels()[index], &data.statistics()[index]);
    let (min, max) = (statistics.min.unwrap_or(0.0), statistics.max.unwrap_or(0.0));
    let (name, unit, missing) = (channel.name.clone(), channel.unit, statistics.missing);
    let many = missing as f64 > MISSING_SHARE * data.rows() as f64;
    let missing = many.then(|| Finding::MissingValues { channel: name.clone(), missing, rows: data.rows() });
    let constant = (min == max).then_some(Finding::Constant { channel: name, unit, value: min, is_input });
    missing.into_iter().chain(constant)
}
