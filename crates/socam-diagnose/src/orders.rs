//! Orders of residuals: whole numbers of cycles per turn at which their power stands out.

/// Highest order that is tested.
const HIGHEST: usize = 60;
/// Largest number of orders that are returned.
const KEPT: usize = 6;
/// Orders on either side with which one is compared.
const NEAR: usize = 6;
/// Least ratio of an order's power to the median of its neighbours.
const STANDS_OUT: f64 = 6.0;
/// Largest number of samples of one series that are used.
const SAMPLES: usize = 20_000;

/// Orders that stand out in all series together, the strongest first. A series is an angle, rad, and an output's residual at the same
/// samples.
pub(crate) fn standing_out<'s>(series: impl Iterator<Item = (&'s [f64], &'s [f64])>) -> Vec<f64> {
    let mut sums = [0.0; HIGHEST + 1];
    for (angle, residual) in series {
        let powers = powers(angle, residual);
        sums.iter_mut().zip(powers).for_each(|(sum, power)| *sum += power);
    }
    let near = |order: usize| {
        let range = order.saturating_sub(NEAR).max(1)..(order + NEAR + 1).min(HIGHEST + 1);
        let mut others: Vec<f64> = range.filter(|other| *other != order).map(|other| sums[other]).collect();
        others.sort_by(f64::total_cmp);
        others[others.len() / 2]
    };
    let mut found: Vec<usize> =
        (1..=HIGHEST).filter(|order| sums[*order] > STANDS_OUT * near(*order)).collect();
    found.sort_by(|a, b| sums[*b].total_cmp(&sums[*a]));
    found.truncate(KEPT);
    found.into_iter().map(|order| order as f64).collect()
}

/// Power of each order over the residual's total power; zero where the residual is constant.
fn powers(angle: &[f64], residual: &[f64]) -> [f64; HIGHEST + 1] {
    let mut powers = [0.0; HIGHEST + 1];
    let stride = (angle.len() / SAMPLES).max(1);
    let pairs = || angle.iter().zip(residual).step_by(stride).filter(|(_, value)| value.is_finite());
    let count = pairs().count() as f64;
    let mean = pairs().map(|(_, value)| value).sum::<f64>() / count;
    let power: f64 = pairs().map(|(_, value)| (value - mean).powi(2)).sum();
    if count < 2.0 || power == 0.0 {
        return powers;
    }
    let mut sums = [[0.0; 2]; HIGHEST + 1];
    for (angle, value) in pairs() {
        let (sin, cos) = angle.sin_cos();
        let mut rotated = [value - mean, 0.0];
        for sum in &mut sums[1..] {
            rotated = [rotated[0] * cos - rotated[1] * sin, rotated[0] * sin + rotated[1] * cos];
            sum[0] += rotated[0];
            sum[1] += rotated[1];
        }
    }
    powers.iter_mut().zip(sums).for_each(|(own, [re, im])| *own = (re * re + im * im) / power);
    powers
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two turns at a varying speed, with cogging of orders 7 and 28 and noise.
    #[test]
    fn whole_orders_are_seen_at_any_speed() {
        let angle: Vec<f64> = (0..8000)
            .map(|k| {
                let turn = f64::from(k) / 4000.0 * std::f64::consts::TAU;
                turn + 0.3 * turn.sin()
            })
            .collect();
        let noise = |k: usize| (78.233 * (k * k % 7919) as f64).sin();
        let at = |(k, angle): (usize, &f64)| {
            0.2 * (7.0 * angle + 1.0).sin() + 0.1 * (28.0 * angle).cos() + 0.3 * noise(k)
        };
        let residual: Vec<f64> = angle.iter().enumerate().map(at).collect();
        let found = standing_out([(angle.as_slice(), residual.as_slice())].into_iter());
        assert_eq!(found[..2], [7.0, 28.0], "{found:?}");
        let still = vec![0.0; 8000];
        assert!(standing_out([(still.as_slice(), residual.as_slice())].into_iter()).is_empty());
    }
}
