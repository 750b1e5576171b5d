//! Spectra of residuals.

use socam_identify::compare::Traces;
use socam_recording::Welch;

/// Longest piece that is transformed at once.
const LONGEST: usize = 16_384;

/// Sample time of a stretch, s.
pub(crate) fn step_s(trace: &Traces) -> f64 {
    let n = trace.time_s.len();
    if n < 2 { 1e-3 } else { (trace.time_s[n - 1] - trace.time_s[0]) / (n - 1) as f64 }
}

/// Measured minus predicted.
pub(crate) fn residual(trace: &Traces, output: usize) -> Vec<f64> {
    trace.measured[output].iter().zip(&trace.predicted[output]).map(|(y, p)| y - p).collect()
}

/// Power density of an output's residual: frequencies in Hz, and units squared per Hz, of one stretch. Missing values count as
/// nothing.
pub(crate) fn power(values: &[f64], step_s: f64) -> (Vec<f64>, Vec<f64>) {
    let length = values.len().min(LONGEST);
    if length < 16 {
        return (Vec::new(), Vec::new());
    }
    let mut welch = Welch::new(length);
    let mut sums = vec![0.0; welch.lines()];
    let mut pieces = 0;
    for start in (0..=values.len() - length).step_by((length / 2).max(1)) {
        let present = |value: &f64| if value.is_nan() { 0.0 } else { *value };
        let lines = welch.transform(values[start..start + length].iter().map(present));
        sums.iter_mut().zip(lines).for_each(|(sum, line)| *sum += line.norm_sqr());
        pieces += 1;
    }
    let scale = welch.density_per_sum(step_s, pieces);
    let frequency_hz = (0..sums.len()).map(|k| k as f64 * welch.step_hz(step_s)).collect();
    (frequency_hz, sums.into_iter().map(|sum| sum * scale).collect())
}

/// The frequencies of an output's strongest lines in the residuals of all stretches, strongest first, Hz.
pub(crate) fn peaks(traces: &[Traces], output: usize, most: usize) -> Vec<f64> {
    let mut found: Vec<(f64, f64)> = Vec::new();
    for trace in traces.iter().filter(|trace| trace.time_s.len() > 64) {
        let (frequency, power) = power(&residual(trace, output), step_s(trace));
        // How far a line stands out of what is near it.
        for k in 4..power.len().saturating_sub(4) {
            let is_peak = power[k] >= power[k - 1] && power[k] > power[k + 1];
            let near = &power[k.saturating_sub(40)..(k + 40).min(power.len())];
            let mut sorted = near.to_vec();
            sorted.sort_by(f64::total_cmp);
            let floor = sorted[sorted.len() / 2];
            if is_peak && power[k] > 30.0 * floor {
                found.push((power[k] / floor.max(f64::MIN_POSITIVE), refined(&power, k, frequency[1])));
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<f64> = Vec::new();
    for (_, frequency) in found {
        if kept.len() < most && kept.iter().all(|known| (known - frequency).abs() > 0.15) {
            kept.push(frequency);
        }
    }
    kept
}

/// A line's frequency between the grid's, by the parabola through the logarithms.
fn refined(power: &[f64], k: usize, spacing: f64) -> f64 {
    let [a, b, c] = [k - 1, k, k + 1].map(|i| power[i].max(f64::MIN_POSITIVE).ln());
    let bend = a - 2.0 * b + c;
    let shift = if bend < 0.0 { (0.5 * (a - c) / bend).clamp(-0.5, 0.5) } else { 0.0 };
    (k as f64 + shift) * spacing
}
