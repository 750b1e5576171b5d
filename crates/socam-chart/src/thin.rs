//! Lines with no more points than a picture shows.

/// Least and greatest point of each pixel, in parts without missing values.
#[must_use]
pub fn thinned(points: &[[f64; 2]], pixels: usize) -> Vec<Vec<[f64; 2]>> {
    let block = points.len().div_ceil(2 * pixels.max(1)).max(1);
    let mut parts = Vec::new();
    for run in points.split(|point| !point[1].is_finite()).filter(|run| !run.is_empty()) {
        let thin = |block: &[[f64; 2]]| {
            let by = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
            let ends = [block.iter().min_by(by), block.iter().max_by(by)];
            let mut ends: Vec<[f64; 2]> = ends.into_iter().flatten().copied().collect();
            ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
            ends.dedup();
            ends
        };
        parts.push(if block == 1 { run.to_vec() } else { run.chunks(2 * block).flat_map(thin).collect() });
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spike_stays() {
        let mut points: Vec<[f64; 2]> = (0..100_000).map(|n| [f64::from(n), 0.0]).collect();
        points[54_321][1] = 7.0;
        points[70_000][1] = f64::NAN;
        let parts = thinned(&points, 500);
        assert_eq!(parts.len(), 2);
        assert!(parts[0].contains(&[54_321.0, 7.0]) && parts.iter().flatten().count() < 2100);
    }
}
