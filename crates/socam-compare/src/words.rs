//! A comparison in sentences.

use crate::channel::ChannelComparison;
use crate::estimate::Estimate;
use crate::laws::CONSTANT;
use crate::{Comparison, Verdict};

/// Least delay that gets a sentence, s.
const LEAST_DELAY_S: f64 = 1e-6;

/// A number to four significant digits.
#[must_use]
pub fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e5).contains(&size) {
        return format!("{value:.3e}");
    }
    let decimals = (3 - size.log10().floor() as i32).max(0) as usize;
    format!("{value:.decimals$}")
}

fn interval(estimate: &Estimate, scale: f64) -> String {
    let [low, high] = estimate.ci95.map(|end| number(scale * end));
    format!("{} [{low}, {high}]", number(scale * estimate.value))
}

/// What there is to say: the verdict, then each channel that differs.
#[must_use]
pub fn sentences(comparison: &Comparison) -> Vec<String> {
    let percent = 100.0 * comparison.false_alarm_rate;
    let mut all = Vec::new();
    let differing = comparison.channels.iter().filter(|channel| channel.differs).count();
    all.push(match comparison.verdict {
        Verdict::Agree => format!(
            "The simulation agrees with the recording: no error depends on the simulated motion (a difference is reported of a right \
             simulation in {percent} % of comparisons). What is left is noise, or motion that the simulation was not told of."
        ),
        Verdict::NothingCompared => format!(
            "Nothing was compared: the two files have no channel in common that is not an input of the simulation{}. Channels are paired by \
             name and unit.",
            if comparison.inputs.is_empty() {
                String::new()
            } else {
                format!(" (the same in both: {})", comparison.inputs.join(", "))
            }
        ),
        Verdict::Differ => format!(
            "The simulation differs from the recording in {differing} of {} channels.",
            comparison.channels.len()
        ),
    });
    if let Some(common) = common_delay(comparison) {
        all.push(common);
    }
    for channel in comparison.channels.iter().filter(|channel| channel.differs) {
        all.push(of_channel(channel));
    }
    all
}

/// One delay of all channels is one of clocks, not of physics.
fn common_delay(comparison: &Comparison) -> Option<String> {
    let delays: Vec<Estimate> = comparison.channels.iter().filter_map(|channel| channel.delay_s).collect();
    let first = delays.first().filter(|_| delays.len() > 1)?;
    let low = delays.iter().map(|delay| delay.ci95[0]).fold(f64::NEG_INFINITY, f64::max);
    let high = delays.iter().map(|delay| delay.ci95[1]).fold(f64::INFINITY, f64::min);
    let is_common =
        low <= high && delays.iter().all(|delay| delay.excludes(0.0)) && first.value.abs() > LEAST_DELAY_S;
    is_common.then(|| {
        format!(
            "All channels of the recording are {} ms {} against the simulation: the two clocks are apart.",
            number(1e3 * (0.5 * (low + high)).abs()),
            if low + high > 0.0 { "late" } else { "early" }
        )
    })
}

fn of_channel(channel: &ChannelComparison) -> String {
    let ChannelComparison { name, unit, .. } = channel;
    let mut text = format!(
        "{name}: the error is {} {unit} rms, {} % of the channel's standard deviation",
        number(channel.error_rms),
        number(100.0 * channel.error_share)
    );
    let matched = matched(channel);
    if !matched.is_empty() && channel.error_rms_without < 0.9 * channel.error_rms {
        text.push_str(&format!(
            "; the recording {}, and without that the error is {} {unit}",
            matched.join(" and "),
            number(channel.error_rms_without)
        ));
    }
    text.push_str(&format!(
        "; a linear filter of the simulation would explain {:.0} % of its power",
        100.0 * channel.linear_share
    ));
    let laws = channel.laws.iter().filter(|law| law.share > 0.02 && law.of != CONSTANT).take(2);
    let laws: Vec<String> = laws
        .map(|law| {
            format!(
                "{} ({} {}, {:.0} % of its power)",
                law.of,
                interval(&law.factor, 1.0),
                law.unit,
                100.0 * law.share
            )
        })
        .collect();
    if !laws.is_empty() {
        text.push_str(&format!("; it follows {}", laws.join(" and ")));
    }
    let [low, high] = channel.half_power_hz;
    text.push_str(&format!("; half of its power lies from {} to {} Hz", number(low), number(high)));
    if let Some(period) = channel.periods.first() {
        let [from, to] = period.time_s;
        text.push_str(&format!("; it is largest from {} s to {} s", number(from), number(to)));
    }
    text.push('.');
    text
}

/// How the recording is shifted and scaled against the simulation.
fn matched(channel: &ChannelComparison) -> Vec<String> {
    let mut parts = Vec::new();
    if let Some(delay) =
        channel.delay_s.filter(|delay| delay.excludes(0.0) && delay.value.abs() > LEAST_DELAY_S)
    {
        let ends = delay.ci95.map(|end| number(1e3 * end.abs()));
        let [low, high] = if delay.value > 0.0 { [&ends[0], &ends[1]] } else { [&ends[1], &ends[0]] };
        let word = if delay.value > 0.0 { "late" } else { "early" };
        parts.push(format!("is {} ms [{low}, {high}] {word}", number(1e3 * delay.value.abs())));
    }
    if let Some(gain) = channel.gain.filter(|gain| gain.excludes(1.0) && (gain.value - 1.0).abs() > 1e-4) {
        parts.push(format!("is {} times as large", interval(&gain, 1.0)));
    }
    if let Some(offset) =
        channel.offset.filter(|offset| offset.excludes(0.0) && offset.value.abs() > 1e-3 * channel.error_rms)
    {
        parts.push(format!("is offset by {} {}", interval(&offset, 1.0), channel.unit));
    }
    parts
}
