//! Who attends to a recording of a source: a terminal here, the window in `commands::dashboard`.

use std::fmt::Arguments;

use indicatif::ProgressBar;
use socam_recording::Event;
use socam_sources::Timeline;

use super::row::Row;
use super::writer::SourceWriter;
use crate::interrupt::Interrupt;
use crate::output;

/// Who attends to a recording, and may end it.
pub(crate) trait Attendant {
    /// How often the operator has asked to stop: the first one lets a profile fade, the second one stops at once.
    fn stops(&mut self) -> u32;

    /// Tells the operator something. `is_warning`: something is not as it should be.
    fn say(&mut self, text: Arguments<'_>, is_warning: bool);

    /// The state of the recording, between reads.
    fn state(&mut self, file: &SourceWriter, timeline: &Timeline);

    /// Rows that are recorded.
    fn rows(&mut self, _rows: &[Row]) {}

    /// An event that is recorded.
    fn event(&mut self, _event: &Event) {}

    /// What the operator wants to have recorded: kind and text.
    fn mark(&mut self) -> Option<(&'static str, String)> {
        None
    }
}

/// A terminal, with Ctrl-C and a bar of the progress.
pub(crate) struct Terminal<'a> {
    interrupt: &'a Interrupt,
    progress: ProgressBar,
}

impl<'a> Terminal<'a> {
    /// `duration_s`: planned time from the first to the last sample.
    pub(crate) fn new(interrupt: &'a Interrupt, duration_s: Option<f64>) -> Self {
        Self { interrupt, progress: ProgressBar::new((duration_s.unwrap_or(0.0) * 1e3) as u64) }
    }
}

impl Attendant for Terminal<'_> {
    fn stops(&mut self) -> u32 {
        self.interrupt.count()
    }

    fn say(&mut self, text: Arguments<'_>, is_warning: bool) {
        if is_warning {
            output::warn(text);
        } else {
            output::say(text);
        }
    }

    fn state(&mut self, file: &SourceWriter, _: &Timeline) {
        self.progress.set_position(file.last_ns as u64 / 1_000_000);
    }
}

impl Drop for Terminal<'_> {
    fn drop(&mut self) {
        self.progress.finish_and_clear();
    }
}
