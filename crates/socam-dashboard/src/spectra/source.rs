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
    let of_entry = |entry: &'_ Entry| {
        let part = Part::of(settings, in_sight, entry.shift_s);
        let of = |samples, signals| Source {
            number: entry.number,
            name: name_among(entries, entry),
            samples,
            signals,
            part,
        };
        let recorded = entry.recording.about.channels.len();
        let mut all = vec![of(&entry.recording.samples, entry.signals().take(recorded).collect())];
        // Each derived channel has samples of its own.
        for signal in entry.signals().skip(recorded) {
            all.extend(entry.find(&signal).map(|(samples, _)| of(samples, vec![signal.clone()])));
        }
        all
    };
    entries.iter().filter(|entry| entry.shown).flat_map(of_entry).collect()
}
