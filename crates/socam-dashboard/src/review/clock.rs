//! The time of day on the time axis, where a recording states it.

use socam_chart::chart::Scale;
use socam_recording::Epoch;
use socam_workbench::entry::Entry;
use socam_workbench::recording::short;

/// The time axis of all plots: its scale and its label.
#[derive(Debug, Clone)]
pub(super) struct TimeAxis {
    pub(super) scale: Scale,
    pub(super) label: String,
}

/// The first recording that is drawn and states the time of day.
fn stating(entries: &[Entry]) -> Option<(&Entry, Epoch)> {
    let mut shown = entries.iter().filter(|entry| entry.shown);
    shown.find_map(|entry| Some((entry, entry.recording.about.epoch?)))
}

/// Whether a recording that is drawn states the time of day.
pub(super) fn is_known(entries: &[Entry]) -> bool {
    stating(entries).is_some()
}

/// The axis, with times of day where they are wanted and known: those of the first recording that states them.
pub(super) fn axis(entries: &[Entry], is_wanted: bool) -> TimeAxis {
    match stating(entries).filter(|_| is_wanted) {
        None => TimeAxis { scale: Scale::Linear, label: "time, s".into() },
        Some((entry, epoch)) => {
            let begin_s = entry.recording.samples.span_s().map_or(0.0, |[from, _]| from);
            let clock = epoch.clock_time(begin_s);
            // Date and time, or the time alone.
            let date = clock.split_once(' ').map_or_else(String::new, |(date, _)| format!(" on {date}"));
            let others = entries.iter().filter(|own| own.shown).count() > 1;
            let of =
                if others { format!(", by {}", short(&entry.recording.about.name)) } else { String::new() };
            let at_zero_s = epoch.of_day_s() - entry.shift_s;
            TimeAxis { scale: Scale::Clock { at_zero_s }, label: format!("time of day{date}{of}") }
        }
    }
}
