//! Segments selected and cleaned.

use socam_frequency::{FrequencyError, prepare::noise_std};

use crate::settings::Settings;
use crate::signals::Segment;

/// Relative difference of mean inputs up to which runs count as repeated.
const SAME: f64 = 0.05;

/// The segments as the settings say, and sentences about what was done.
pub(crate) fn prepared(
    segments: Vec<Segment>,
    settings: &Settings,
) -> Result<(Vec<Segment>, Vec<String>), FrequencyError> {
    let mut notes = Vec::new();
    let mut segments = if settings.quietest { quietest(segments, &mut notes) } else { segments };
    for segment in &mut segments {
        if let Some(limit) = settings.outliers {
            let replaced = segment.without_outliers(limit);
            if replaced > 0 {
                notes.push(format!("{}: {replaced} outliers replaced", segment.recording));
            }
        }
        if let Some((corner_hz, order)) = settings.low_pass {
            segment.filter(order, corner_hz)?;
        }
    }
    Ok((segments, notes))
}

/// Selects, of repeated runs, the one with the least noise of the output (thesis section 4.1.1).
fn quietest(segments: Vec<Segment>, notes: &mut Vec<String>) -> Vec<Segment> {
    let mean = |segment: &Segment| segment.input.iter().sum::<f64>() / segment.input.len().max(1) as f64;
    let noise = |segment: &Segment| noise_std(&segment.output);
    let mut kept: Vec<(f64, f64, Segment)> = Vec::new();
    for segment in segments {
        let (mean, noise) = (mean(&segment), noise(&segment));
        match kept.iter_mut().find(|(known, ..)| (known - mean).abs() <= SAME * known.abs()) {
            Some(best) if best.1 <= noise => {}
            Some(best) => *best = (best.0, noise, segment),
            None => kept.push((mean, noise, segment)),
        }
    }
    notes.extend(kept.iter().map(|(mean, noise, segment)| {
        format!("{}: taken for a mean input of {mean:.4}, output noise {noise:.3e}", segment.recording)
    }));
    kept.into_iter().map(|(_, _, segment)| segment).collect()
}
