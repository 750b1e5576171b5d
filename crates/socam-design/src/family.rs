//! Families of profiles, and their neighbours.

use socam_core::Lines;
use socam_recording::{ProfileCommand, ProfileFile, Waveform};

use crate::Limits;

/// Lowest and highest frequency, Hz, at a sampling rate of 1 kHz.
const SLOWEST_HZ: f64 = 0.5;
const FASTEST_HZ: f64 = 200.0;
/// Greatest number of lines, a few less than a board's multisine holds.
const MOST_LINES: f64 = 250.0;
/// Least command of a one-way profile, as a fraction of the voltage limit.
const LEAST: f64 = 0.05;
/// Fraction of the voltage limit that is used, since the peak of a multisine is known only approximately.
const FULL: f64 = 0.98;

/// Start profiles of the search: every family, at rest and at speed, over narrow and wide bands.
pub(crate) fn first(limits: &Limits) -> Vec<ProfileFile> {
    let mut all = Vec::new();
    let means: &[f64] = if limits.one_way { &[0.35, 0.6] } else { &[0.0, 0.35, 0.6] };
    for mean in means {
        for to_hz in [12.0, 40.0, 120.0] {
            all.push(multisine(limits, *mean, (SLOWEST_HZ, to_hz)));
        }
        all.push(multisine(limits, *mean, (8.0, 60.0)));
        all.push(chirp(limits, *mean, 60.0));
        all.push(prbs(limits, *mean, 0.02));
    }
    for dwell_s in [0.25, 1.0] {
        all.push(staircase(limits, dwell_s));
    }
    all
}

/// Neighbours of a profile: other bands, means, lengths of a period or step, and phases.
pub(crate) fn near(profile: &ProfileFile, limits: &Limits, round: u32) -> Vec<ProfileFile> {
    let factor = [1.8, 1.4, 1.2][round.min(2) as usize];
    let shift = limits.voltage * [0.2, 0.1, 0.05][round.min(2) as usize];
    let mut all = Vec::new();
    let mut with = |waveform: Waveform| {
        if let Some(waveform) = filled(waveform, limits) {
            all.push(ProfileFile { waveform, ..profile.clone() });
        }
    };
    match profile.waveform {
        Waveform::Multisine { offset, amplitude, lines, from_hz, to_hz, period_s, seed } => {
            let waveform = |offset, from_hz: f64, to_hz: f64, seed| {
                let from_hz = from_hz.max(1.0 / period_s);
                Waveform::Multisine { offset, amplitude, lines, from_hz, to_hz, period_s, seed }
            };
            with(waveform(offset, from_hz, (to_hz * factor).min(FASTEST_HZ), seed));
            with(waveform(offset, from_hz, (to_hz / factor).max(3.0 * from_hz), seed));
            with(waveform(offset, (from_hz * factor).min(to_hz / 3.0), to_hz, seed));
            with(waveform(offset, from_hz / factor, to_hz, seed));
            with(waveform(offset + shift, from_hz, to_hz, seed));
            with(waveform(offset - shift, from_hz, to_hz, seed));
            with(waveform(offset, from_hz, to_hz, seed + 1));
        }
        Waveform::Chirp { offset, amplitude, from_hz, to_hz, sweep_s } => {
            let waveform = |offset, to_hz| Waveform::Chirp { offset, amplitude, from_hz, to_hz, sweep_s };
            with(waveform(offset, (to_hz * factor).min(FASTEST_HZ)));
            with(waveform(offset, to_hz / factor));
            with(waveform(offset + shift, to_hz));
            with(waveform(offset - shift, to_hz));
        }
        Waveform::Prbs { offset, amplitude, bit_s, order, seed } => {
            let waveform = |offset, bit_s: f64, seed| {
                let bit_s = (bit_s * 1e3).round().max(2.0) * 1e-3;
                Waveform::Prbs { offset, amplitude, bit_s, order, seed }
            };
            with(waveform(offset, bit_s * factor, seed));
            with(waveform(offset, bit_s / factor, seed));
            with(waveform(offset + shift, bit_s, seed));
            with(waveform(offset - shift, bit_s, seed));
        }
        Waveform::Staircase { first, step, count, dwell_s, and_back } => {
            let waveform = |dwell_s: f64| {
                let dwell_s = (dwell_s * 1e3).round() * 1e-3;
                Waveform::Staircase { first, step, count, dwell_s, and_back }
            };
            with(waveform(dwell_s * factor));
            with(waveform(dwell_s / factor));
        }
        Waveform::Constant { .. } | Waveform::Sine { .. } | Waveform::Triangle { .. } => {}
    }
    all
}

/// The profile with the largest amplitude about its mean that the voltage limit allows; `None` if there is none.
fn filled(mut waveform: Waveform, limits: &Limits) -> Option<Waveform> {
    if let Waveform::Multisine { from_hz, to_hz, period_s, .. } = &mut waveform {
        // The distance between lines is the inverse of the period.
        let longest = (1e3 * MOST_LINES / (*to_hz - *from_hz)).floor() * 1e-3;
        *period_s = period_s.min(longest);
        *from_hz = from_hz.max(1.0 / *period_s);
    }
    if let Waveform::Multisine { offset, amplitude, .. }
    | Waveform::Chirp { offset, amplitude, .. }
    | Waveform::Prbs { offset, amplitude, .. } = &mut waveform
    {
        let below = if limits.one_way { offset.abs() - LEAST * limits.voltage } else { f64::INFINITY };
        *amplitude = (FULL * limits.voltage - offset.abs()).min(below);
        if *amplitude < 0.02 * limits.voltage {
            return None;
        }
    }
    Some(waveform)
}

fn profile(limits: &Limits, waveform: Waveform) -> ProfileFile {
    let ramp_s =
        if matches!(waveform, Waveform::Staircase { .. }) { 0.0 } else { (0.1 * limits.duration_s).min(0.5) };
    ProfileFile {
        purpose: None,
        command: ProfileCommand::Voltage,
        waveform: filled(waveform, limits).unwrap_or(waveform),
        ramp_s,
        limit: limits.voltage,
        slew: limits.slew_v_s,
        // The profile fades out after its own duration.
        duration_s: limits.duration_s - ramp_s,
    }
}

fn multisine(limits: &Limits, mean: f64, (from_hz, to_hz): (f64, f64)) -> ProfileFile {
    // A whole number of ms, and no longer than half the recording.
    let period_s = if limits.duration_s >= 8.0 { 4.0 } else { 2.0 };
    let offset = mean * limits.voltage;
    let waveform =
        Waveform::Multisine { offset, amplitude: 0.1, lines: Lines::Full, from_hz, to_hz, period_s, seed: 1 };
    profile(limits, waveform)
}

fn chirp(limits: &Limits, mean: f64, to_hz: f64) -> ProfileFile {
    let sweep_s = (0.8 * limits.duration_s * 1e3).round() * 1e-3;
    let offset = mean * limits.voltage;
    profile(limits, Waveform::Chirp { offset, amplitude: 0.1, from_hz: SLOWEST_HZ, to_hz, sweep_s })
}

fn prbs(limits: &Limits, mean: f64, bit_s: f64) -> ProfileFile {
    profile(
        limits,
        Waveform::Prbs { offset: mean * limits.voltage, amplitude: 0.1, bit_s, order: 9, seed: 1 },
    )
}

/// A staircase from one end of the range to the other and back.
fn staircase(limits: &Limits, dwell_s: f64) -> ProfileFile {
    let high = FULL * limits.voltage;
    let low = if limits.one_way { 0.2 * high } else { -high };
    profile(limits, Waveform::Staircase { first: high, step: low - high, count: 2, dwell_s, and_back: false })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_first_profiles_and_their_neighbours_run_within_the_limits() {
        for one_way in [false, true] {
            let limits = Limits { voltage: 1.8, slew_v_s: 500.0, duration_s: 10.0, one_way };
            for start in first(&limits) {
                start.profile(1000).unwrap();
                for round in 0..3 {
                    for other in near(&start, &limits, round) {
                        other.profile(1000).unwrap();
                        if let Waveform::Multisine { offset, amplitude, .. } = other.waveform {
                            assert!(offset.abs() + amplitude < 1.8 && (!one_way || offset > amplitude));
                        }
                    }
                }
            }
        }
    }
}
