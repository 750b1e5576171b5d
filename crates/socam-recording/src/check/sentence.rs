//! Findings in words: what was found, and what to record or change.

use std::borrow::Cow;

use super::finding::{Finding, HeldAt};
use super::options::Resonance;

/// Highest frequency of the built-in profiles `multisine` and `chirp`, Hz.
const HIGHEST_BUILT_IN_HZ: f64 = 150.0;

/// Samples per period that sample a resonance well.
const SAMPLES_PER_PERIOD: f64 = 5.0;

impl Finding {
    /// The finding as a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        match self {
            Self::MissingChannels { channels, available } => format!(
                "the model reads {}, which the recording lacks; it has {}",
                listed(channels.iter().map(|name| format!("`{name}`"))),
                available.join(", ")
            ),
            Self::TooShort { rows, needed } => {
                format!("only {}; dynamics need at least {needed}", counted(*rows, "row"))
            }
            Self::Gaps { count, total_s, longest_s } => {
                format!("{}, {total_s:.4} s in all, the longest {longest_s:.4} s", counted(*count, "gap"))
            }
            Self::LostSamples { samples } => {
                format!(
                    "{} lost while recording",
                    if *samples == 1 { "1 sample was".into() } else { format!("{samples} samples were") }
                )
            }
            Self::CutOff { missing } => format!("the recording is cut off: {missing} is missing"),
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
                "the input `{channel}` has only {} within 30 dB of its strongest (all that stands out of its noise lies from {from:.2} to {to:.2} Hz); it takes {needed} to determine the parameters",
                counted(*lines as u64, "resolvable spectral line")
            ),
            Self::ResonancesNotExcited { channel, resonances, band_hz: [from, to], .. } => {
                format!(
                    "the input `{channel}` moves from {from:.2} to {to:.2} Hz and does not excite {}",
                    with_parameters(resonances)
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
            Self::NotTheDerivative { speed, angle, factor } => {
                format!("`{speed}` is {factor:.4} times the derivative of `{angle}`")
            }
            Self::RunsAgainst { speed, torque } => {
                format!(
                    "`{speed}` falls where `{torque}`, which drives it, is positive: one of them has the wrong sign"
                )
            }
        }
    }

    /// Remedy as a phrase: what to record or change.
    #[must_use]
    pub fn remedy(&self) -> Cow<'static, str> {
        let words = match self {
            Self::ResonancesNotExcited { resonances, highest_hz, .. } => {
                return excite(resonances, *highest_hz).into();
            }
            Self::MissingChannels { .. } => {
                "check with the model that describes this bench, or rename the columns in the model's [channels]"
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
            Self::InputUnknown => "name the channel that drives the bench",
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
            Self::NotTheDerivative { factor, .. } => {
                return format!(
                    "state `scale = {:.4}` of that speed in the model's [channels] if the angle is right, or look at its unit and wiring",
                    1.0 / factor
                )
                .into();
            }
            Self::RunsAgainst { .. } => {
                "look at the wiring of the encoder and of the motor, or state `scale = -1` of one of them in the model's [channels]"
            }
            Self::RatioBroken { .. } => {
                "calibrate both tachometers; if they are right, something slips, or the model's ratio is wrong"
            }
        };
        words.into()
    }
}

/// "the model's resonances at 3.0 Hz and 20.0 Hz, on which k1 and k2 depend".
fn with_parameters(resonances: &[Resonance]) -> String {
    let frequencies = resonances.iter().map(|r| format!("{:.1} Hz", r.frequency_hz));
    let mut parameters: Vec<&str> = Vec::new();
    for name in resonances.iter().flat_map(|resonance| &resonance.parameters) {
        if !parameters.contains(&name.as_str()) {
            parameters.push(name);
        }
    }
    format!(
        "the model's resonance{} at {}, on which {} depend{}",
        if resonances.len() == 1 { "" } else { "s" },
        listed(frequencies),
        listed(parameters.iter().map(|name| (*name).to_owned())),
        if parameters.len() == 1 { "s" } else { "" },
    )
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
        words += &format!(", at {rate_hz:.0} samples per second or more");
    }
    words
}

/// "a, b and c".
fn counted(count: u64, one: &str) -> String {
    if count == 1 { format!("1 {one}") } else { format!("{count} {one}s") }
}

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
    use crate::{ProfileFile, Waveform};

    #[test]
    fn built_in_profiles_reach_as_far_as_is_said() {
        for name in ["multisine", "chirp"] {
            let (Waveform::Multisine { to_hz, .. } | Waveform::Chirp { to_hz, .. }) =
                ProfileFile::open(name).unwrap().waveform
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
            "record a multisine with `to_Hz` above 520 in a profile file of your own, at 2000 samples per second or more"
        );
    }
}
