//! What a check can find, in numbers and in words.

use std::borrow::Cow;

use serde::Serialize;

use super::{HeldAt, Resonance};
use crate::Unit;

/// How far the built-in profiles `multisine` and `chirp` reach, Hz.
const HIGHEST_BUILT_IN_HZ: f64 = 150.0;

/// Samples per period from which a resonance is well sampled.
const SAMPLES_PER_PERIOD: f64 = 5.0;

/// How much a finding stands in the way of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// A fit is possible, and weaker for it.
    Weakens,
    /// A fit would mean nothing.
    Prevents,
}

/// Something found in a recording. Values of channels are in the channel's unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
#[allow(missing_docs, reason = "each field is explained by the sentence its variant makes")]
pub enum Finding {
    /// Channels that the model reads are not there.
    MissingChannels { channels: Vec<String>, available: Vec<String> },
    /// Too few rows for any dynamics.
    TooShort { rows: u64, needed: u64 },
    /// Rows are missing between others.
    Gaps { count: u64, total_s: f64, longest_s: f64 },
    /// Samples were lost while recording.
    LostSamples { samples: u64 },
    /// The recording was cut off.
    CutOff { missing: String },
    /// A part of the log was damaged.
    Damaged { byte: u64, bytes: u64 },
    /// Steps of time differ from each other.
    UnevenSteps { sample_time_s: f64, jitter_s: f64 },
    /// A channel lacks values.
    MissingValues { channel: String, missing: u64, rows: u64 },
    /// A channel has one value only.
    Constant { channel: String, unit: Unit, value: f64, is_input: bool },
    /// The input hardly moves.
    StandsStill { channel: String, unit: Unit, mean: f64, std: f64, snr_db: Option<f64> },
    /// No channel is known to be the input.
    InputUnknown,
    /// A channel is mostly noise.
    Buried { channel: String, snr_db: f64, is_input: bool },
    /// The input moves at too few frequencies.
    FewLines { channel: String, lines: usize, needed: usize, band_hz: [f64; 2] },
    /// The input does not move near some resonances of the model.
    ResonancesNotExcited { channel: String, resonances: Vec<Resonance>, band_hz: [f64; 2], highest_hz: f64 },
    /// A motion never turns round.
    OneWay { channel: String, parameters: Vec<String> },
    /// A channel stays at its extreme while the truth goes on.
    Saturated {
        channel: String,
        unit: Unit,
        limit: f64,
        at: HeldAt,
        rows: u64,
        share_percent: f64,
        runs: u64,
        longest_run_rows: u64,
    },
    /// A noisy channel reads one value for a while.
    Stuck { channel: String, unit: Unit, value: f64, rows: u64, longest_run_rows: u64 },
    /// Single samples far outside of everything else.
    Spikes { channel: String, unit: Unit, spikes: u64, farthest: f64, range: [f64; 2] },
    /// A channel is in another unit than the model takes it for.
    WrongUnit { channel: String, unit: Unit, expected: String },
    /// A line at the mains frequency or its harmonics.
    MainsHum { channel: String, unit: Unit, frequency_hz: f64, amplitude: f64, harmonics: Vec<u32> },
    /// Two speeds do not keep their ratio.
    RatioBroken { fast: String, slow: String, expected: f64, measured: f64, deviation_percent: f64 },
}

impl Finding {
    /// How much it stands in the way.
    #[must_use]
    pub fn severity(&self) -> Severity {
        match self {
            // A small motion that stands well above the noise still says something.
            Self::StandsStill { snr_db: Some(snr_db), .. } if *snr_db >= super::LOWEST_SNR_DB => {
                Severity::Weakens
            }
            Self::MissingChannels { .. }
            | Self::TooShort { .. }
            | Self::WrongUnit { .. }
            | Self::StandsStill { .. }
            | Self::Constant { is_input: true, .. }
            | Self::Buried { is_input: true, .. } => Severity::Prevents,
            Self::MainsHum { .. } | Self::CutOff { .. } | Self::InputUnknown => Severity::Note,
            _ => Severity::Weakens,
        }
    }

    /// What was found, as a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        match self {
            Self::MissingChannels { channels, available } => format!(
                "the model reads {}, which the recording lacks; it has {}",
                listed(channels.iter().map(|name| format!("`{name}`"))),
                available.join(", ")
            ),
            Self::TooShort { rows, needed } => {
                format!("only {rows} rows; dynamics need at least {needed}")
            }
            Self::Gaps { count, total_s, longest_s } => {
                format!("{count} gaps, {total_s:.4} s in all, the longest {longest_s:.4} s")
            }
            Self::LostSamples { samples } => {
                format!("{samples} samples were lost while recording")
            }
            Self::CutOff { missing } => format!("the recording is cut off: missing is {missing}"),
            Self::Damaged { byte, bytes } => {
                format!("{bytes} damaged bytes at byte {byte} are left out")
            }
            Self::UnevenSteps { sample_time_s, jitter_s } => format!(
                "steps of time vary by up to {:.1} % of the sample time ({sample_time_s:.4e} s)",
                100.0 * jitter_s / sample_time_s
            ),
            Self::MissingValues { channel, missing, rows } => {
                format!("`{channel}` has no value in {missing} of {rows} rows")
            }
            Self::Constant { channel, unit, value, .. } => {
                format!("`{channel}` is {value} {unit} throughout")
            }
            Self::StandsStill { channel, unit, mean, std, .. } => format!(
                "the input `{channel}` stands at {mean:.4} {unit} and varies by {std:.2e} {unit} only"
            ),
            Self::InputUnknown => {
                "no channel is known to be the input, so its excitation is not judged".into()
            }
            Self::Buried { channel, snr_db, .. } => {
                format!("`{channel}` is mostly noise (signal to noise {snr_db:.1} dB)")
            }
            Self::FewLines { channel, lines, needed, band_hz: [from, to] } => format!(
                "the input `{channel}` moves at {lines} {} only ({from:.2} to {to:.2} Hz); it takes {needed} to determine the parameters",
                if *lines == 1 { "frequency" } else { "frequencies" }
            ),
            Self::ResonancesNotExcited { channel, resonances, band_hz: [from, to], .. } => {
                let frequencies = resonances.iter().map(|r| format!("{:.1} Hz", r.frequency_hz));
                let mut parameters: Vec<&str> = Vec::new();
                for name in resonances.iter().flat_map(|resonance| &resonance.parameters) {
                    if !parameters.contains(&name.as_str()) {
                        parameters.push(name);
                    }
                }
                format!(
                    "the input `{channel}` moves from {from:.2} to {to:.2} Hz and does not excite the model's resonance{} at {}, \
                     on which {} depend{}",
                    if resonances.len() == 1 { "" } else { "s" },
                    listed(frequencies),
                    listed(parameters.iter().map(|name| (*name).to_owned())),
                    if parameters.len() == 1 { "s" } else { "" },
                )
            }
            Self::OneWay { channel, parameters } => format!(
                "`{channel}` moves one way only, so {} cannot be told apart",
                listed(parameters.iter().cloned())
            ),
            Self::Saturated { channel, unit, limit, at, rows, share_percent, runs, longest_run_rows } => {
                let end = if *at == HeldAt::Least { "lower" } else { "upper" };
                let times = if *runs == 1 { "once".to_owned() } else { format!("{runs} times") };
                format!(
                    "`{channel}` is clipped at its {end} end: it sticks at {limit} {unit} {times}, in {rows} rows ({share_percent:.1} %), up to {longest_run_rows} in a row"
                )
            }
            Self::Stuck { channel, unit, value, longest_run_rows, .. } => format!(
                "`{channel}` is stuck: it reads exactly {value} {unit} in {longest_run_rows} rows, without the noise that it has elsewhere"
            ),
            Self::Spikes { channel, unit, spikes, farthest, range: [from, to] } => format!(
                "`{channel}` has {spikes} spike{}, the farthest at {farthest:.4} {unit}, where everything else lies from {from:.4} to {to:.4} {unit}",
                if *spikes == 1 { "" } else { "s" },
            ),
            Self::WrongUnit { channel, unit, expected } => {
                format!("`{channel}` is recorded in {unit}, but the model takes it for {expected}")
            }
            Self::MainsHum { channel, unit, frequency_hz, amplitude, harmonics } => format!(
                "`{channel}` carries what looks like mains hum: {amplitude:.2e} {unit} at {frequency_hz:.1} Hz (harmonics {})",
                harmonics.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")
            ),
            Self::RatioBroken { fast, slow, expected, measured, deviation_percent } => format!(
                "`{fast}` over `{slow}` is {measured:.4} on average where the gear says {expected} ({deviation_percent:+.2} %)"
            ),
        }
    }

    /// What to record, or do, instead.
    #[must_use]
    pub fn remedy(&self) -> Cow<'static, str> {
        let words = match self {
            Self::ResonancesNotExcited { resonances, highest_hz, .. } => {
                return excite(resonances, *highest_hz).into();
            }
            Self::MissingChannels { .. } => {
                "check with the model that describes this bench (`--model`), or rename the columns in the model's [channels]"
            }
            Self::TooShort { .. } => "record at least ten seconds",
            Self::Gaps { .. } | Self::LostSamples { .. } => {
                "lower the rate or shorten the link, and record again; fits go on from gap to gap, each with its own start"
            }
            Self::CutOff { .. } => "what is there can be used; record again if it is too short",
            Self::Damaged { .. } => "check the disk and copy the log again from its source",
            Self::UnevenSteps { .. } => "record with the board's timer, or resample to even steps",
            Self::MissingValues { .. } => "check the sensor's cable, or leave the channel out",
            Self::Constant { is_input: true, .. } | Self::StandsStill { .. } => {
                "drive it: record the `multisine` profile (or `prbs`, `chirp`)"
            }
            Self::Constant { .. } => "check the sensor's cable and supply, or leave the channel out",
            Self::InputUnknown => "name it (`--input CHANNEL`)",
            Self::Buried { is_input: true, .. } => "raise the profile's amplitude",
            Self::Buried { .. } => {
                "raise the profile's amplitude, average more periods, or leave the channel out"
            }
            Self::FewLines { .. } => {
                "record `multisine`, `prbs` or `chirp`; add `reversals` where friction or backlash matter"
            }
            Self::OneWay { .. } => "record `reversals` or `triangle`, or any motion forward and backward",
            Self::Saturated { .. } => {
                "lower the amplitude or the sensor's gain, or cut these parts out with RUN@FROM..TO; a command that its own drive \
                 limits is right as it is"
            }
            Self::Stuck { .. } => "check the sensor's cable and bus, or cut this part out with RUN@FROM..TO",
            Self::Spikes { .. } => {
                "check the cable and the connector, or remove these samples (an empty cell in a CSV is a missing value)"
            }
            Self::WrongUnit { .. } => {
                "write scale = X in the model's channel, where one of the recorded unit is X of the other, or name another column"
            }
            Self::MainsHum { .. } => {
                "shield and earth the sensor, twist its leads, or record with the drive's supply off to compare"
            }
            Self::RatioBroken { .. } => {
                "calibrate both tachometers; if they are right, something slips, or the model's ratio is wrong"
            }
        };
        words.into()
    }
}

/// The profile that reaches these resonances, and the rate to sample it at.
fn excite(resonances: &[Resonance], highest_hz: f64) -> String {
    let top_hz = resonances.iter().map(|resonance| resonance.frequency_hz).fold(0.0, f64::max);
    let mut words = if top_hz < HIGHEST_BUILT_IN_HZ {
        format!("record the `multisine` profile (or `chirp`), which reach {HIGHEST_BUILT_IN_HZ} Hz")
    } else {
        format!("record a multisine with `to_Hz` above {:.0} in a profile file of your own", 1.3 * top_hz)
    };
    if highest_hz < SAMPLES_PER_PERIOD / 2.0 * top_hz {
        let rate_hz = (SAMPLES_PER_PERIOD * top_hz / 1000.0).ceil() * 1000.0;
        words += &format!(", with at least --rate {rate_hz:.0}");
    }
    words
}

/// "a, b and c".
fn listed(items: impl Iterator<Item = String>) -> String {
    let items: Vec<String> = items.collect();
    match items.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => items.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Course, ProfileFile};

    #[test]
    fn built_in_profiles_reach_as_far_as_is_said() {
        for name in ["multisine", "chirp"] {
            let (Course::Multisine { to_hz, .. } | Course::Chirp { to_hz, .. }) =
                ProfileFile::open(name).unwrap().course
            else {
                panic!("{name}");
            };
            assert_eq!(to_hz, HIGHEST_BUILT_IN_HZ, "{name}");
        }
    }

    #[test]
    fn a_resonance_beyond_them_asks_for_a_profile_and_a_rate() {
        let resonance = Resonance { frequency_hz: 400.0, parameters: vec!["k".into()] };
        assert_eq!(
            excite(&[resonance], 500.0),
            "record a multisine with `to_Hz` above 520 in a profile file of your own, with at least --rate 2000"
        );
    }
}
