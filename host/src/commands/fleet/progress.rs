//! Progress of a fleet, on a terminal's stderr only; and Ctrl-C.

use indicatif::{ProgressBar, ProgressStyle};
use socam_fleet::Observer;

use crate::interrupt::Interrupt;

/// A progress bar, hidden if stderr is not a terminal.
pub(crate) struct Progress {
    bar: ProgressBar,
    interrupt: Interrupt,
    before: u32,
}

impl Progress {
    pub(crate) fn new(recordings: usize, interrupt: Interrupt) -> Self {
        let bar = ProgressBar::new(recordings as u64);
        let style = "{bar:30} {pos} of {len}, {elapsed}, {eta} left, {wide_msg}";
        let style = ProgressStyle::with_template(style);
        let bar = style.map_or_else(|_| bar.clone(), |style| bar.clone().with_style(style));
        let before = interrupt.count();
        Self { bar, interrupt, before }
    }

    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Observer for Progress {
    fn done(&self, recording: &str, _known: bool) {
        self.bar.inc(1);
        self.bar.set_message(recording.to_owned());
    }

    fn stops(&self) -> bool {
        self.interrupt.count() > self.before
    }
}
