//! The menu of a chart: its picture, to the clipboard or to a file.

use std::sync::Arc;

use egui::{ColorImage, Context, Id, Rect, Response, Ui};

use crate::raster;

/// The menu of the right button; a picture that the user asked to save waits for [`take`].
pub(super) fn menu(ui: &Ui, response: Response, whole: Rect) -> Response {
    let mut asked = [false; 2];
    response.context_menu(|menu| {
        asked[0] = menu.button("Copy picture of this chart").clicked();
        asked[1] = menu.button("Save picture of this chart...").clicked();
        if asked.contains(&true) {
            menu.close();
        }
    });
    if asked[0] {
        ui.ctx().copy_image(of(ui, whole));
    }
    if asked[1] {
        let image = Arc::new(of(ui, whole));
        ui.ctx().data_mut(|data| data.insert_temp(place(), image));
    }
    response
}

fn place() -> Id {
    Id::unique("picture of a chart to save")
}

/// The picture of a chart that the user asked to save, once.
pub fn take(ctx: &Context) -> Option<Arc<ColorImage>> {
    ctx.data_mut(|data| data.remove_temp(place()))
}

/// The part of the window as it is drawn so far.
fn of(ui: &Ui, part: Rect) -> ColorImage {
    let shapes = ui.ctx().graphics(|layers| {
        layers.get(ui.layer_id()).map(|list| list.all_entries().cloned().collect::<Vec<_>>())
    });
    raster::of_shapes(ui.ctx(), shapes.unwrap_or_default(), part, ui.visuals().panel_fill)
}
