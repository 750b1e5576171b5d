//! The layout: settings that are kept from one start to the next.

use std::collections::BTreeMap;
use std::path::PathBuf;

use egui::{Id, Rect, Ui};
use serde::{Deserialize, Serialize};

use socam_chart::theme::Look;
use socam_workbench::View;
use socam_workbench::arrangement::Arrangement;
use socam_workbench::device::Stated;

/// Settings that are kept from one start to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layout {
    /// The view that was shown.
    pub view: View,
    /// Light or dark.
    pub look: Look,
    /// Whether the user chose the look; otherwise it follows the system's.
    pub look_is_chosen: bool,
    /// Zoom factor; 1 is normal.
    pub zoom: f32,
    /// The folder that was last opened from.
    pub folder: PathBuf,
    /// The device that was last connected to.
    pub device: String,
    /// What was said of it.
    pub stated: Stated,
    /// Size of the window, points at zoom 1.
    pub window: [f32; 2],
    /// Widths of the panels at the left, points, by name.
    pub panels: BTreeMap<String, f32>,
    /// Files that were opened last, the latest first.
    pub recent: Vec<String>,
    /// The plots of the view over time.
    pub plots: Arrangement,
}

/// Greatest number of recent files.
const MOST_RECENT: usize = 12;

impl Layout {
    /// Puts a file before the other recent ones.
    pub(crate) fn remember(&mut self, path: &str) {
        let whole =
            std::path::absolute(path).map_or_else(|_| path.to_owned(), |path| path.display().to_string());
        self.recent.retain(|known| *known != whole);
        self.recent.insert(0, whole);
        self.recent.truncate(MOST_RECENT);
    }
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            view: View::Time,
            look: Look::Dark,
            look_is_chosen: false,
            zoom: 1.0,
            folder: PathBuf::from("."),
            device: "sim".into(),
            stated: Stated::default(),
            window: [1280.0, 800.0],
            panels: BTreeMap::new(),
            recent: Vec::new(),
            plots: Arrangement::default(),
        }
    }
}

fn free_place() -> Id {
    Id::unique("part of the window below the bars")
}

/// Keeps the part of the window that floating windows may cover: what is below the emergency stop and the controls of the bench.
pub(crate) fn set_free(ctx: &egui::Context, free: Rect) {
    ctx.data_mut(|data| data.insert_temp(free_place(), free));
}

/// The part of the window that floating windows may cover.
pub(crate) fn free(ctx: &egui::Context) -> Rect {
    ctx.data(|data| data.get_temp(free_place())).unwrap_or_else(|| ctx.content_rect())
}

/// Widths of panels by name, points; kept in the data of the egui context.
type Panels = BTreeMap<String, f32>;

fn place() -> Id {
    Id::unique("widths of panels")
}

/// Restores the widths of panels.
pub(crate) fn set_panels(ctx: &egui::Context, panels: &Panels) {
    ctx.data_mut(|data| data.insert_temp(place(), panels.clone()));
}

/// Widths of panels.
pub(crate) fn panels(ctx: &egui::Context) -> Panels {
    ctx.data(|data| data.get_temp(place())).unwrap_or_default()
}

/// Width of a panel when it is first drawn.
pub(crate) fn panel(ui: &Ui, name: &str, usual: f32) -> f32 {
    panels(ui.ctx()).get(name).copied().unwrap_or(usual)
}

/// Stores the width of a panel.
pub(crate) fn keep_panel(ui: &Ui, name: &str, width: f32) {
    ui.ctx().data_mut(|data| data.get_temp_mut_or_default::<Panels>(place()).insert(name.to_owned(), width));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_twelve_files_are_kept_each_once() {
        let mut layout = Layout::default();
        (0..20).for_each(|number| layout.remember(&format!("/runs/{number}.csv")));
        layout.remember("/runs/15.csv");
        assert_eq!(
            (layout.recent.len(), layout.recent[0].as_str(), layout.recent[1].as_str()),
            (12, "/runs/15.csv", "/runs/19.csv")
        );
    }
}
