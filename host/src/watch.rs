//! Progress of a fit on stderr, and Ctrl-C, which ends the fit with the best result so far.

use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use socam_identify::{Observer, Progress, ProgressMonitor};

use crate::interrupt::Interrupt;
use crate::output;

/// Interval between lines of progress where stderr is no terminal and progress is requested.
const LINE_EVERY: Duration = Duration::from_secs(1);

/// Observer of a fit for a user who waits for it.
struct Waiting {
    interrupt: Interrupt,
    /// Number of interrupts before the fit.
    before: u32,
    since: Instant,
    /// The part of a work of several fits that is done now, and how much is usually done before it.
    part: Mutex<Option<String>>,
    display: Display,
}

enum Display {
    /// One line, redrawn; nothing where stderr is no terminal.
    Line(ProgressBar),
    /// Lines, and the time of the last one.
    Lines(Mutex<Option<Instant>>),
}

impl Observer for Waiting {
    fn progress(&self, progress: &Progress) {
        let part = self.part.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let doing = part.unwrap_or_else(|| progress.to_string());
        let text = if self.stop() { format!("ending: {doing}") } else { doing };
        match &self.display {
            Display::Line(bar) => bar.set_message(text),
            Display::Lines(last) => {
                let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
                if last.is_none_or(|last| last.elapsed() >= LINE_EVERY) {
                    *last = Some(Instant::now());
                    output::say(format_args!("{text}, {:.1} s", self.since.elapsed().as_secs_f64()));
                }
            }
        }
    }

    fn part(&self, name: &str, done: f64) {
        let percent = (100.0 * done).round();
        let text = if done > 0.0 { format!("{name} (about {percent} % done)") } else { name.to_owned() };
        *self.part.lock().unwrap_or_else(PoisonError::into_inner) = Some(text);
    }

    fn stop(&self) -> bool {
        self.interrupt.count() > self.before
    }
}

/// Runs a fit with progress on a terminal (as lines elsewhere, if requested). The first Ctrl-C ends the search, the second one the process.
pub(crate) fn fit<T>(interrupt: &Interrupt, lines: bool, work: impl FnOnce(ProgressMonitor) -> T) -> T {
    let lines = lines && !std::io::stderr().is_terminal();
    let display = if lines { Display::Lines(Mutex::new(None)) } else { Display::Line(line()) };
    let waiting = Arc::new(Waiting {
        interrupt: interrupt.clone(),
        before: interrupt.count(),
        since: Instant::now(),
        part: Mutex::new(None),
        display,
    });
    interrupt.end_after(1);
    let result = work(ProgressMonitor::by(waiting.clone()));
    interrupt.end_after(0);
    if let Display::Line(bar) = &waiting.display {
        bar.finish_and_clear();
    }
    result
}

fn line() -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    let style = ProgressStyle::with_template("{spinner} {msg}, {elapsed} (Ctrl-C ends the search)");
    let bar = style.map_or_else(|_| bar.clone(), |style| bar.clone().with_style(style));
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}
