//! The dashboard in a window of the desktop, and what is remembered of it.

use std::path::PathBuf;

use anyhow::anyhow;
use socam_dashboard::{Dashboard, Layout};

struct Window(Dashboard);

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let size = ui.ctx().content_rect().size();
        self.0.layout.window = [size.x, size.y];
        self.0.ui(ui);
    }

    fn on_exit(&mut self, _: Option<&eframe::glow::Context>) {
        // Where it cannot be written, the next start looks as the first.
        let _ = remember(&self.0.layout);
    }
}

/// Shows it until it is closed.
pub(super) fn show(dashboard: Dashboard) -> anyhow::Result<()> {
    let [width, height] = dashboard.layout.window;
    let viewport = egui::ViewportBuilder::default()
        .with_title("socam")
        .with_app_id("socam")
        .with_inner_size([width, height])
        .with_min_inner_size([640.0, 420.0]);
    let options = eframe::NativeOptions { viewport, ..eframe::NativeOptions::default() };
    let start = move |context: &eframe::CreationContext<'_>| {
        dashboard.set_up(&context.egui_ctx);
        Ok(Box::new(Window(dashboard)) as Box<dyn eframe::App>)
    };
    eframe::run_native("socam", options, Box::new(start)).map_err(|error| {
        anyhow!("no window can be opened here: {error}; --screenshot FILE.png draws without a display (Linux needs libGL and X11 or Wayland)")
    })
}

fn path() -> Option<PathBuf> {
    let given = |name: &str| std::env::var_os(name).filter(|folder| !folder.is_empty()).map(PathBuf::from);
    let folder = given("XDG_CONFIG_HOME")
        .or_else(|| given("APPDATA"))
        .or_else(|| Some(given("HOME")?.join(".config")))?;
    Some(folder.join("socam").join("dashboard.json"))
}

/// The layout of the last window; the default one where there was none or it is of another version.
pub(super) fn remembered() -> Layout {
    let text = path().and_then(|path| std::fs::read_to_string(path).ok());
    text.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default()
}

fn remember(layout: &Layout) -> anyhow::Result<()> {
    let path = path().ok_or_else(|| anyhow!("there is no home"))?;
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    Ok(std::fs::write(path, serde_json::to_vec_pretty(layout)?)?)
}
