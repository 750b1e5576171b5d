use super::*;
use egui::{Mesh, pos2};

#[test]
fn triangles_that_share_edges_however_flat_leave_no_gap_and_do_not_overlap() {
    let ctx = egui::Context::default();
    let mut output = ctx.run_ui(egui::RawInput::default(), |_| ());
    let mut raster = Raster::default();
    raster.take(&mut output.textures_delta);
    let mut mesh = Mesh::default();
    // A quarter of white, so that a pixel that is filled twice shows.
    let colour = Color32::from_rgba_premultiplied(64, 64, 64, 64);
    let corners = [[0.0, 0.0], [100.0, 1e-12], [100.0, 50.0], [0.0, 50.0], [31.7, 20.3]];
    corners.iter().for_each(|[x, y]| mesh.colored_vertex(pos2(*x, *y), colour));
    for side in 0..4 {
        mesh.add_triangle(side, (side + 1) % 4, 4);
    }
    let clip_rect = Rect::from_min_size(Pos2::ZERO, egui::vec2(100.0, 50.0));
    let whole = ClippedPrimitive { clip_rect, primitive: Primitive::Mesh(mesh) };
    let image = raster.fill(&[whole], 1.0, [100, 50], Color32::BLACK);
    let wrong = image.pixels.iter().filter(|pixel| pixel.r() != 64).count();
    assert_eq!(wrong, 0);
}
