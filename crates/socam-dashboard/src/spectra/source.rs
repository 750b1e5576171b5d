//! What spectra are made of: the samples of the recordings that are shown, and of the channels that were derived from them.

use std::sync::Arc;

use socam_samples::Samples;
use socam_workbench::entry::{Entry, name_among};
use socam_workbench::signal::Signal;
use socam_workbench::spectrum_settings::SpectrumSettings;

use super::densities::Part;

/// Samples with the channels that they hold.
pub(super) struct Source<'e> {
    /// Number of the recording.
    pub(super) number: usize,
    /// Name of the recording.
    pub(super) name: &'e str,
    pub(super) samples: &'e Arc<Samples>,
    pub(super) signals: Vec<Signal>,
    /// What its spectra are made of.
    pub(super) part: Part,
}

/// The sources of all shown recordings.
pub(super) fn sources(
    entries: &[Entry],
    settings: SpectrumSettings,
    in_sight: Option<[f64; 2]>,
) -> Vec<Source<'_>> {
    let mut all = Vec::new();
    for entry in entries.iter().filter(|entry| entry.shown) {
        let (number, name) = (entry.number, name_among(entries, entry));
        let part = Part::of(settings, in_sight, entry.shift_s);
        let recorded = entry.recording.about.channels.len();
        let signals = entry.signals().take(recorded).collect();
        all.push(Source { number, name, samples: &entry.recording.samples, signals, part });
        // Each derived channel has samples of its own.
        for signal in entry.signals().skip(recorded) {
            if let Some((samples, _)) = entry.find(&signal) {
                all.push(Source { number, name, samples, signals: vec![signal], part });
            }
        }
    }
    all
}
