//! Averaging windows: weighted means of a recording over a fraction of a second, which need no differentiation of signals.
//!
//! The equation of motion is multiplied by a smooth weight h(t) and integrated by parts, which moves derivatives from the noisy signals to
//! the weight (modulating functions, Shinbrot 1957): the mean of an acceleration is -int h' speed, that of the second derivative of a
//! twist int h'' torque / stiffness.

use std::f64::consts::PI;

use socam_recording::Dataset;

use crate::{EfficiencyError, Section};

/// Averaging window, s: long compared with oscillations of couplings (20 Hz and more), short compared with changes of the load.
const LENGTH_S: f64 = 0.16;
/// Least speed at the input, rad/s, for the laws of sliding friction; it must hold at every sample.
const STANDSTILL_RAD_S: f64 = 2.0;

/// Least fraction of a large torque; below, near a reversal, play and the friction of the mesh dominate.
const LEAST_TORQUE: f64 = 0.1;

/// Weighted means over one averaging window, at the input side unless stated otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Torque in, N m.
    pub torque_in: f64,
    /// Torque out over the ratio, N m.
    pub torque_out: f64,
    /// Speed, rad/s.
    pub speed: f64,
    /// Sign of the motion.
    pub direction: f64,
    /// Magnitude of the torque that proportional losses act on, N m: the mean of both sensors, weighted so that the torque of acceleration
    /// cancels.
    pub size: f64,
    /// Whether the input drives the load.
    pub is_driven: bool,
    /// Acceleration of the input tachometer's place, rad/s2.
    pub acceleration: f64,
    /// Second derivative of the torque in, N m/s2, for the acceleration of the twist between tachometer and section.
    pub torque_in_curvature: f64,
    /// Speed of the output tachometer times the ratio, rad/s.
    pub speed_out: Option<f64>,
    /// First derivatives of both torques, N m/s: twist between the tachometers.
    pub torque_slopes: [f64; 2],
}

/// The averaging windows of a recording in which the motion keeps its direction; each overlaps the next by half.
pub(crate) fn of(data: &Dataset, section: &Section) -> Result<Vec<Window>, EfficiencyError> {
    let mut names = vec![&*section.torque_in.column, &section.torque_out.column, &section.speed_in.column];
    let out = section.speed_out.as_ref().filter(|channel| data.channel_index(&channel.column).is_ok());
    names.extend(out.map(|channel| &*channel.column));
    let indices = names.iter().map(|name| data.channel_index(name)).collect::<Result<Vec<_>, _>>()?;
    let weights = Weights::new(data.sample_time_s());
    let mut found = Vec::new();
    for segment in data.segments() {
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
        for block in data.blocks_in(segment.first_row..segment.first_row + segment.rows, &indices)? {
            let block = block?;
            columns.iter_mut().zip(&block.columns).for_each(|(all, more)| all.extend(more.values()));
        }
        let channels = [&section.torque_in, &section.torque_out, &section.speed_in];
        for (column, channel) in columns.iter_mut().zip(channels.into_iter().chain(out)) {
            column.iter_mut().for_each(|value| *value = channel.scale * *value + channel.offset);
        }
        let length = weights.h.len();
        let mut from = 0;
        while from + length <= columns[0].len() {
            let part: Vec<&[f64]> = columns.iter().map(|column| &column[from..from + length]).collect();
            found.extend(weights.window(&part, section));
            from += length / 2;
        }
    }
    Ok(found)
}

/// Averaging windows with substantial torque: near zero torque the proportional law does not hold, and an efficiency is meaningless.
pub(crate) fn substantial(windows: &[Window]) -> Vec<Window> {
    let mut sizes: Vec<f64> = windows.iter().map(|window| window.size).collect();
    sizes.sort_by(f64::total_cmp);
    let large = sizes.get(sizes.len() * 9 / 10).copied().unwrap_or(0.0);
    windows.iter().filter(|window| window.size > LEAST_TORQUE * large).copied().collect()
}

/// A weight of mean one and its derivatives, sample by sample.
struct Weights {
    h: Vec<f64>,
    slope: Vec<f64>,
    bend: Vec<f64>,
}

impl Weights {
    /// sin^4: it and its first three derivatives vanish at both ends.
    fn new(sample_time_s: f64) -> Self {
        let count = ((LENGTH_S / sample_time_s).round() as usize).max(8);
        let length = count as f64 * sample_time_s;
        let step = |k: usize| PI * k as f64 / count as f64;
        // The mean of sin^4 is 3/8.
        let scale = 8.0 / (3.0 * count as f64);
        let rate = PI / length;
        let h = |x: f64| x.sin().powi(4);
        let slope = |x: f64| 4.0 * rate * x.sin().powi(3) * x.cos();
        let bend = |x: f64| 4.0 * rate * rate * (3.0 * x.sin().powi(2) * x.cos().powi(2) - x.sin().powi(4));
        let all = |weight: &dyn Fn(f64) -> f64| (0..count).map(|k| scale * weight(step(k))).collect();
        Self { h: all(&h), slope: all(&slope), bend: all(&bend) }
    }

    /// `None` if a value is missing, or if motion or torque changes its sign.
    fn window(&self, columns: &[&[f64]], section: &Section) -> Option<Window> {
        let [torque_in, torque_out, speed] = [columns[0], columns[1], columns[2]];
        let mean =
            |weight: &[f64], values: &[f64]| weight.iter().zip(values).map(|(w, v)| w * v).sum::<f64>();
        let direction = speed[0].signum();
        let moves = speed.iter().all(|speed| speed * direction > STANDSTILL_RAD_S);
        if !moves || !columns.iter().all(|column| column.iter().all(|value| value.is_finite())) {
            return None;
        }
        let into = section.speed_ratio_in;
        let before = section.share_before;
        let within = |(a, b): (&f64, &f64)| (1.0 - before) * a + before * b / section.ratio;
        let carried: Vec<f64> = torque_in.iter().zip(torque_out).map(within).collect();
        // Near a reversal of the torque, play and the friction of the mesh dominate, and the proportional law does not hold.
        let pushes = carried.iter().all(|torque| torque * carried[0] > 0.0);
        if !pushes {
            return None;
        }
        let torque = mean(&self.h, &carried);
        Some(Window {
            torque_in: mean(&self.h, torque_in),
            torque_out: mean(&self.h, torque_out) / section.ratio,
            speed: mean(&self.h, speed) * into,
            direction: direction * into.signum(),
            size: torque.abs(),
            is_driven: torque * direction * into.signum() > 0.0,
            acceleration: -mean(&self.slope, speed) * into,
            torque_in_curvature: mean(&self.bend, torque_in),
            speed_out: columns.get(3).map(|out| mean(&self.h, out) * section.speed_ratio_out * into),
            torque_slopes: [-mean(&self.slope, torque_in), -mean(&self.slope, torque_out)],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_take_derivatives() {
        let weights = Weights::new(1e-3);
        let time = |k: usize| k as f64 * 1e-3;
        let signal: Vec<f64> =
            (0..weights.h.len()).map(|k| 3.0 + 5.0 * time(k) + 7.0 * time(k).powi(2)).collect();
        let mean = |w: &[f64]| w.iter().zip(&signal).map(|(w, v)| w * v).sum::<f64>();
        let middle = 0.5 * LENGTH_S;
        assert!((weights.h.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((-mean(&weights.slope) - (5.0 + 14.0 * middle)).abs() < 1e-3);
        assert!((mean(&weights.bend) - 14.0).abs() < 1e-2);
    }
}
