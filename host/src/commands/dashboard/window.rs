//! The dashboard in a window of the desktop, and its stored layout.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::anyhow;
use socam_dashboard::{Dashboard, Layout, wake};

use super::rehearsal::Rehearsal;
use crate::output;

struct Window {
    dashboard: Dashboard,
    rehearsal: Option<Rehearsal>,
    title: String,
    /// When the layout was written last.
    remembered: Instant,
}

/// Interval at which the layout is written, so that a window that is killed is remembered too.
const REMEMBER_EVERY: Duration = Duration::from_secs(20);

impl Window {
    fn remember_now_and_then(&mut self) {
        if self.remembered.elapsed() > REMEMBER_EVERY {
            self.remembered = Instant::now();
            self.remember();
        }
    }

    /// Writes the layout. If that fails, the next start uses the last one or the default.
    fn remember(&self) {
        let _ = path().map(|path| remember(&path, &self.dashboard.layout));
    }
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        // The zoom factor of a new window is not known yet.
        let size = ui.ctx().content_rect().size() * ui.ctx().zoom_factor();
        self.dashboard.layout.window = [size.x, size.y];
        if let Some(rehearsal) = &mut self.rehearsal {
            match rehearsal.go_on(&mut self.dashboard, ui.ctx()) {
                Ok(false) => {}
                Ok(true) => {
                    println!("live: {:.1} frames/s", rehearsal.frames_per_s());
                    ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
                    self.rehearsal = None;
                }
                Err(error) => {
                    output::warn(format_args!("{error:#}"));
                    self.rehearsal = None;
                }
            }
        }
        self.dashboard.ui(ui);
        self.dashboard.say_missing_letters();
        let title = self.dashboard.title();
        if title != self.title {
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
        self.remember_now_and_then();
    }

    fn on_exit(&mut self, _: Option<&eframe::glow::Context>) {
        self.remember();
    }
}

/// Shows the window until it is closed. `connects`: opens the link to the device at once.
pub(super) fn show(
    mut dashboard: Dashboard,
    rehearsal: Option<Rehearsal>,
    connects: bool,
) -> anyhow::Result<()> {
    let [width, height] = dashboard.layout.window;
    let viewport = egui::ViewportBuilder::default()
        .with_title("socam")
        .with_app_id("socam")
        .with_inner_size([width, height])
        .with_min_inner_size([640.0, 420.0]);
    let options = eframe::NativeOptions { viewport, ..eframe::NativeOptions::default() };
    let start = move |context: &eframe::CreationContext<'_>| {
        dashboard.set_up(&context.egui_ctx);
        dashboard.look_for_letters(&context.egui_ctx);
        if connects {
            dashboard.workspace.connect(wake(&context.egui_ctx));
        }
        Ok(Box::new(Window { dashboard, rehearsal, title: String::new(), remembered: Instant::now() })
            as Box<dyn eframe::App>)
    };
    eframe::run_native("socam", options, Box::new(start)).map_err(|error| no_window(&error.to_string()))
}

/// Why no window can be opened, and what to do.
fn no_window(error: &str) -> anyhow::Error {
    // winit names the line of its source that failed: `os error at FILE:LINE: REASON`.
    let reason = match error.split_once("os error at ") {
        Some((_, place)) => place.split_once(": ").map_or(place, |(_, reason)| reason),
        None => error,
    };
    let reason = reason.trim_end_matches('.');
    anyhow!(
        "no window can be opened: {reason}; set DISPLAY to an X server, as in DISPLAY=:0, or WAYLAND_DISPLAY to a compositor \
         (Linux needs libGL, too), or draw a picture without a display by --screenshot FILE.png"
    )
}

fn path() -> Option<PathBuf> {
    let given = |name: &str| std::env::var_os(name).filter(|folder| !folder.is_empty()).map(PathBuf::from);
    let folder = given("XDG_CONFIG_HOME")
        .or_else(|| given("APPDATA"))
        .or_else(|| Some(given("HOME")?.join(".config")))?;
    Some(folder.join("socam").join("dashboard.json"))
}

/// The layout of the last window.
pub(super) fn remembered() -> Layout {
    path().map_or_else(Layout::default, |path| recall(&path))
}

/// The stored layout; the default if there is none, or if it is of another version.
fn recall(path: &Path) -> Layout {
    let text = socam_recording::read_text(path).ok();
    text.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default()
}

fn remember(path: &Path, layout: &Layout) -> anyhow::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let mut file = output::create(path)?;
    serde_json::to_writer_pretty(&mut file, layout)?;
    file.commit()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use socam_chart::theme::Look;
    use socam_dashboard::View;

    use super::*;

    #[test]
    fn a_missing_display_is_said_with_its_remedy_and_without_a_line_of_source() {
        let said =
            no_window("winit EventLoopError: os error at /home/x/winit/mod.rs:765: no DISPLAY is set.");
        assert!(
            said.to_string().starts_with("no window can be opened: no DISPLAY is set; set DISPLAY"),
            "{said}"
        );
        let said = no_window("egui_glow: no OpenGL 2.0").to_string();
        assert!(said.contains("no OpenGL 2.0;") && said.contains("--screenshot"), "{said}");
    }

    #[test]
    fn a_layout_is_remembered_and_what_is_none_is_forgotten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("socam/dashboard.json");
        let layout = Layout {
            view: View::Check,
            look: Look::Light,
            zoom: 1.5,
            device: "tcp:bench:4711".into(),
            window: [900.0, 700.0],
            panels: [("recordings".into(), 333.0)].into(),
            ..Layout::default()
        };
        remember(&path, &layout).unwrap();
        assert_eq!(recall(&path), layout);
        std::fs::write(&path, "{\"view\": \"Check\", \"of another version\": 1}").unwrap();
        assert_eq!(recall(&path), Layout { view: View::Check, ..Layout::default() });
        std::fs::write(&path, "{\"view\": \"Nowhere\"}").unwrap();
        assert_eq!(recall(&path), Layout::default());
    }
}
