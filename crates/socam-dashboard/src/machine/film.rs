//! A short animation of the drawing: a few frames are drawn in each pass of the window, so that the window and the emergency stop go on.

use egui::emath::TSTransform;
use egui::{ColorImage, Rect, Ui, epaint::ClippedShape};
use socam_chart::raster;
use socam_workbench::job::{Handle, Job};

use super::player::Player;
use super::scene::Scene;
use crate::bench::Stand;
use crate::progress::{self, wake};

/// Frames of an animation, and frames a second.
const FRAMES: usize = 45;
const RATE: u16 = 15;
/// Frames that are drawn in a pass.
const AT_ONCE: usize = 3;

/// An animation that is being made.
#[derive(Debug, Default)]
pub(super) struct Film {
    /// The frames so far; `None` while none is made.
    frames: Option<Vec<ColorImage>>,
    encoding: Option<Job<Result<Vec<u8>, String>>>,
}

impl Film {
    /// Begins one.
    pub(super) fn begin(&mut self) {
        if !self.is_busy() {
            self.frames = Some(Vec::new());
        }
    }

    /// Forgets the frames of one that cannot be made.
    pub(super) fn give_up(&mut self) {
        self.frames = None;
    }

    pub(super) fn is_busy(&self) -> bool {
        self.frames.is_some() || self.encoding.is_some()
    }

    /// The file, once.
    pub(super) fn poll(&mut self) -> Option<Result<Vec<u8>, String>> {
        let answer = self.encoding.as_ref().and_then(Job::poll)?;
        self.encoding = None;
        Some(answer.and_then(|answer| answer))
    }

    /// Says how far it is, with a way to give it up.
    pub(super) fn progress(&mut self, ui: &mut Ui) {
        if let Some(job) = &self.encoding {
            if progress::job(ui, job) {
                self.encoding = None;
            }
            return;
        }
        let done = self.frames.as_ref().map_or(0, Vec::len);
        let mut cancelled = false;
        ui.horizontal(|ui| {
            cancelled = ui.button("Cancel").clicked();
            ui.label(format!("drawing the animation, frame {done} of {FRAMES}"));
        });
        if cancelled {
            self.give_up();
        }
    }

    /// Draws the next frames of the part of the window in which the drawing stands.
    pub(super) fn go_on(&mut self, ui: &Ui, player: &Player, scene: &Scene<'_>, stand: Stand, part: Rect) {
        let Some(frames) = &mut self.frames else { return };
        let ground = ui.visuals().panel_fill;
        let Some([from, to]) = scene.motion.map(|motion| motion.span_s) else { return };
        for _ in 0..AT_ONCE.min(FRAMES - frames.len()) {
            let at_s = frames.len() as f64 / f64::from(RATE) * player.speed;
            let time_s = from + (player.time_s - from + at_s).rem_euclid(to - from);
            let shapes = Scene { time_s, ..*scene }.shapes(ui, stand).into_iter();
            let clipped = |shape| ClippedShape {
                clip_rect: part,
                shape,
                transform_after_tessellation: TSTransform::IDENTITY,
            };
            let shapes = shapes.map(clipped).collect();
            frames.push(raster::of_shapes(ui.ctx(), shapes, part, ground));
        }
        ui.ctx().request_repaint();
        if frames.len() >= FRAMES {
            let frames = self.frames.take().unwrap_or_default();
            let work = move |_: &Handle| raster::animation(&frames, RATE);
            self.encoding = Some(Job::start("writing the animation", &wake(ui.ctx()), work));
        }
    }
}
