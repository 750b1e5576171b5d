//! An automatic run of the virtual bench, for pictures of a running bench and to measure the frame rate.

use std::time::{Duration, Instant};

use anyhow::bail;
use socam_core::State;
use socam_dashboard::{Dashboard, wake};
use socam_workbench::input_signal::Settings;

/// Timeout of each step.
const PATIENCE: Duration = Duration::from_secs(10);

/// An automatic run.
pub(super) struct Rehearsal {
    length: Duration,
    asked: Option<State>,
    is_connecting: bool,
    since: Instant,
    runs_since: Option<Instant>,
    /// Frames and time of the second half of the run, when the picture is full.
    frames: u32,
}

impl Rehearsal {
    /// A run of the default input signal for a given time.
    pub(super) fn new(dashboard: &mut Dashboard, length: Duration) -> Self {
        let signal = Settings { duration_s: length.as_secs_f64(), ..Settings::default() };
        dashboard.workspace.signal.change(signal);
        let (asked, runs_since) = (None, None);
        Self { length, asked, is_connecting: false, since: Instant::now(), runs_since, frames: 0 }
    }

    /// Takes the next step; called before each frame. `true` once the run has ended.
    ///
    /// # Errors
    /// When a step fails or times out; one sentence.
    pub(super) fn go_on(&mut self, dashboard: &mut Dashboard, ctx: &egui::Context) -> anyhow::Result<bool> {
        let workspace = &mut dashboard.workspace;
        if let Some((_, text, _)) = workspace.bench.ended() {
            println!("{text}");
            return Ok(true);
        }
        if let Some(problem) = workspace.bench.problem() {
            bail!("{problem}");
        }
        if self.runs_since.is_none() && self.since.elapsed() > PATIENCE {
            bail!("the bench did not run within {} s", PATIENCE.as_secs());
        }
        if !self.is_connecting {
            self.is_connecting = true;
            workspace.connect(wake(ctx));
        }
        let state = workspace.bench.state();
        match state {
            Some(State::Idle) if self.asked.is_none() => workspace.arm(),
            Some(State::Armed) if self.asked == Some(State::Idle) => workspace.bench.run(),
            Some(State::Running) => {
                let runs_since = *self.runs_since.get_or_insert_with(Instant::now);
                self.frames += u32::from(2 * runs_since.elapsed() > self.length);
                return Ok(false);
            }
            _ => return Ok(false),
        }
        self.asked = state;
        Ok(false)
    }

    /// Draws frames without a window until a condition holds or the run has ended.
    pub(super) fn go_on_until(
        &mut self,
        dashboard: &mut Dashboard,
        is: impl Fn(&Self) -> bool,
    ) -> anyhow::Result<()> {
        let ctx = egui::Context::default();
        while !is(self) {
            dashboard.workspace.bench.listen();
            if self.go_on(dashboard, &ctx)? {
                break;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        Ok(())
    }

    /// Whether the picture shows a large part of the run, which still goes on.
    pub(super) fn is_in_sight(&self) -> bool {
        self.runs_since.is_some_and(|since| since.elapsed() > self.length.mul_f64(0.8))
    }

    /// Frames per second during the second half of the run.
    pub(super) fn frames_per_s(&self) -> f64 {
        f64::from(self.frames) / (0.5 * self.length.as_secs_f64())
    }
}
