//! The menu of a chart: its picture, to the clipboard or to a file.

use egui::{ColorImage, Rect, Response, Ui};

use crate::raster;

/// The menu of the right button. Returns the picture if the user asked to save it.
pub(super) fn menu(
    ui: &Ui,
    response: Response,
    whole: Rect,
    can_save: bool,
) -> (Response, Option<ColorImage>) {
    let mut asked = [false; 2];
    response.context_menu(|menu| {
        asked[0] = menu.button("Copy picture of this chart").clicked();
        asked[1] = can_save && menu.button("Save picture of this chart...").clicked();
        if asked.contains(&true) {
            menu.close();
        }
    });
    if asked[0] {
        ui.ctx().copy_image(of(ui, whole));
    }
    (response, asked[1].then(|| of(ui, whole)))
}

/// The part of the window as it is drawn so far.
fn of(ui: &Ui, part: Rect) -> ColorImage {
    let shapes = ui.ctx().graphics(|layers| {
        layers.get(ui.layer_id()).map(|list| list.all_entries().cloned().collect::<Vec<_>>())
    });
    raster::of_shapes(ui.ctx(), shapes.unwrap_or_default(), part, ui.visuals().panel_fill)
}
