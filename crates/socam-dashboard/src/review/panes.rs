//! Draws the tiles, and takes what is done with them.

use egui::{Align2, DragAndDrop, FontId, Rect, ScrollArea, Sense, Stroke, StrokeKind, Ui, pos2, vec2};
use egui_tiles::{Behavior, EditAction, SimplificationOptions, Tile, TileId, Tiles, UiResponse};

use super::list::Dragged;
use super::plots::Plots;
use super::plots::heights::{GAP, TABS};
use super::plots::insert::{Place, place_at};
use super::{Drawing, Review};
use socam_chart::chart::{X_AXIS, ruler};
use socam_chart::theme;
use socam_workbench::Request;
use socam_workbench::arrangement::Plot;

/// Action on a tile after all tiles are drawn.
enum Done {
    Close(TileId),
    Even,
    Resized,
}

struct Panes<'a, 'b> {
    review: &'a mut Review,
    drawing: &'a mut Drawing<'b>,
    /// The part of the window that plots are drawn in: tiles do not know that they are scrolled.
    clip: Rect,
    /// Plots with the time axis.
    lowest: std::collections::BTreeSet<u64>,
    done: Option<Done>,
}

impl Review {
    /// Draws all plots in the rest of the window.
    pub(super) fn tiles(&mut self, ui: &mut Ui, drawing: &mut Drawing<'_>) {
        let mut plots = std::mem::take(&mut self.plots);
        let (room, least) = (ui.available_height(), plots.least_height());
        let is_scrolled = least > room;
        let height = room.max(least);
        plots.level(height);
        let lowest = plots.lowest();
        let bars_only =
            egui::scroll_area::ScrollSource { scroll_bar: true, ..egui::scroll_area::ScrollSource::NONE };
        // The axis of plots that are scrolled stays in sight below them.
        let part = if is_scrolled { room - X_AXIS } else { room };
        let scrolled = ScrollArea::vertical().scroll_source(bars_only).auto_shrink(false).max_height(part);
        let done = scrolled.show(ui, |ui| {
            plots.tree.set_height(height);
            let mut panes = Panes { clip: ui.clip_rect(), review: self, drawing, lowest, done: None };
            plots.tree.ui(&mut panes, ui);
            let done = panes.done;
            let problem = drop_channel(ui, &mut plots);
            (done, problem)
        });
        if is_scrolled {
            ui.spacing_mut().item_spacing.y = 0.0;
            ruler(ui, &drawing.columns, drawing.x, drawing.time_axis.scale, &drawing.time_axis.label);
        }
        let (done, problem) = done.inner;
        match done {
            Some(Done::Close(id)) => plots.dismiss(id),
            Some(Done::Even) => plots.even = true,
            Some(Done::Resized) => plots.even = false,
            None => {}
        }
        let is_there = |tile: u64| plots.tree.tiles.get(TileId(tile)).is_some();
        self.xy.retain(|tile, _| is_there(*tile));
        self.spectrograms.retain(|tile, _| is_there(*tile));
        self.histograms.retain(|tile, _| is_there(*tile));
        self.tables.retain(|tile, _| is_there(*tile));
        self.linked.end(ui.ctx());
        drawing.requests.extend(problem.map(Request::Say));
        self.plots = plots;
    }
}

/// Marks where the channel that is dragged would go, and puts it there when it is released.
fn drop_channel(ui: &Ui, plots: &mut Plots) -> Option<String> {
    let Dragged(signal) = &*DragAndDrop::payload::<Dragged>(ui.ctx())?;
    let at = ui.input(|input| input.pointer.interact_pos()).filter(|at| ui.clip_rect().contains(*at))?;
    let rect_of = |id: TileId| plots.tree.tiles.rect(id).filter(|rect| rect.contains(at));
    let (id, rect) = plots.panes().find_map(|(id, _)| rect_of(id).map(|rect| (id, rect)))?;
    let (place, part) = place_at(rect, at);
    let joined = match plots.tree.tiles.get_pane(&id).cloned() {
        Some(mut plot) if place == Place::Into => plot.join(signal.clone()).map(|()| Some(plot)),
        _ => Ok(None),
    };
    let colour = if joined.is_ok() { ui.visuals().selection.stroke.color } else { theme::alarm(ui) };
    let painter = ui.painter();
    painter.rect(part, 3.0, colour.gamma_multiply(0.16), Stroke::new(1.5, colour), StrokeKind::Inside);
    if let Err(sentence) = &joined {
        let galley =
            painter.layout(sentence.clone(), FontId::proportional(12.5), colour, rect.width() - 40.0);
        let text = Align2::CENTER_CENTER.anchor_size(rect.center(), galley.size());
        painter.rect_filled(text.expand(6.0), 3.0, ui.visuals().extreme_bg_color);
        painter.galley(text.min, galley, colour);
    }
    if !ui.input(|input| input.pointer.any_released()) {
        return None;
    }
    match joined {
        Ok(Some(plot)) => {
            plots.hidden.remove(signal);
            plots.leave(signal);
            plots.tree.tiles.insert(id, Tile::Pane(plot));
        }
        Ok(None) => {
            plots.hidden.remove(signal);
            plots.leave(signal);
            plots.insert(Plot::Time(vec![signal.clone()]), id, place);
        }
        Err(sentence) => return Some(sentence),
    }
    None
}

impl Behavior<Plot> for Panes<'_, '_> {
    fn pane_ui(&mut self, ui: &mut Ui, id: TileId, plot: &mut Plot) -> UiResponse {
        let rect = ui.max_rect();
        ui.set_clip_rect(ui.clip_rect().intersect(self.clip));
        // Plots that are scrolled out of sight cost nothing.
        if !ui.is_rect_visible(rect) {
            return UiResponse::None;
        }
        // Where times differ, each plot shows its own.
        let has_axis = self.lowest.contains(&id.0) || !self.review.own_x.is_empty();
        let first = self.drawing.seen.len();
        match plot {
            Plot::Time(signals) => self.review.over_time(ui, self.drawing, signals, (rect, has_axis)),
            Plot::Xy { y, x } => self.review.xy(ui, self.drawing, (y, x), (rect, id.0)),
            Plot::Spectrogram(signal) => {
                self.review.spectrogram(ui, self.drawing, signal, (rect, id.0, has_axis));
            }
            Plot::Statistics => self.review.statistics(ui, self.drawing),
            Plot::Histogram(signal) => self.review.histogram(ui, self.drawing, signal, (rect, id.0)),
            Plot::Table => self.review.table_of_values(ui, self.drawing, id.0),
        }
        self.handles(ui, rect, (id, first), plot)
    }

    fn tab_title_for_pane(&mut self, plot: &Plot) -> egui::WidgetText {
        plot.title().into()
    }

    fn is_tab_closable(&self, _: &Tiles<Plot>, _: TileId) -> bool {
        true
    }

    fn on_tab_close(&mut self, _: &mut Tiles<Plot>, id: TileId) -> bool {
        self.done = Some(Done::Close(id));
        false
    }

    fn tab_bar_height(&self, _: &egui::Style) -> f32 {
        TABS
    }

    fn gap_width(&self, _: &egui::Style) -> f32 {
        GAP
    }

    fn resize_stroke(&self, style: &egui::Style, state: egui_tiles::ResizeState) -> Stroke {
        match state {
            egui_tiles::ResizeState::Idle => Stroke::NONE,
            _ => Stroke::new(GAP, style.visuals.widgets.active.bg_fill),
        }
    }

    fn min_size(&self) -> f32 {
        40.0
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { prune_single_child_tabs: true, ..SimplificationOptions::default() }
    }

    fn on_edit(&mut self, action: EditAction) {
        if action == EditAction::TileResized {
            self.done = Some(Done::Resized);
        }
    }
}

/// Size of the handles, points.
const HANDLE: f32 = 20.0;

impl Panes<'_, '_> {
    /// The handle that moves a tile, its menu and its closing button: at the top right, while the pointer is over the tile.
    fn handles(&mut self, ui: &mut Ui, rect: Rect, (id, first): (TileId, usize), plot: &Plot) -> UiResponse {
        let is_touched = ui.input(egui::InputState::has_touch_screen);
        let is_wanted = is_touched || ui.rect_contains_pointer(rect) || self.review.menu_of == Some(id);
        if !is_wanted || DragAndDrop::has_any_payload(ui.ctx()) {
            return UiResponse::None;
        }
        let title = plot.title();
        let corner = rect.right_top() + vec2(-6.0, 3.0);
        let place = |from_right: f32| {
            Rect::from_min_size(pos2(corner.x - from_right * HANDLE, corner.y), vec2(HANDLE, HANDLE))
        };
        let ground = place(3.0).union(place(1.0));
        ui.painter().rect_filled(ground, 4.0, ui.visuals().panel_fill.gamma_multiply(0.9));
        let grip = ui.interact(place(3.0), ui.scope_id().with("grip"), Sense::drag());
        dots(ui, grip.rect, grip.hovered());
        let name = format!("Move {title}");
        grip.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        let grip =
            grip.on_hover_cursor(egui::CursorIcon::Grab).on_hover_text("Drag this plot to another place");
        let mut menu = ui.new_child(egui::UiBuilder::new().max_rect(place(2.0)));
        menu.spacing_mut().button_padding = vec2(4.0, 1.0);
        let more = menu.menu_button("...", |ui| self.menu(ui, (id, first), plot));
        match more.inner {
            Some(()) => self.review.menu_of = Some(id),
            None if self.review.menu_of == Some(id) => self.review.menu_of = None,
            None => {}
        }
        let name = format!("More about the plot {title}");
        more.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        let close = ui.put(place(1.0), egui::Button::new("x").frame(false));
        let name = format!("Close the plot {title}");
        close.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        if close.on_hover_text("Close this plot; its channels stay in the list").clicked() {
            self.done = Some(Done::Close(id));
        }
        if grip.drag_started() { UiResponse::DragStarted } else { UiResponse::None }
    }

    /// `first` is the tile's first chart among those that are drawn.
    fn menu(&mut self, ui: &mut Ui, (id, first): (TileId, usize), plot: &Plot) {
        if let Plot::Time(signals) = plot {
            let mut is_own = self.review.is_unlinked(signals);
            let tick = ui.checkbox(&mut is_own, "Time axis of its own");
            if tick
                .on_hover_text("Panned and zoomed apart from the other plots; Fit all links it again")
                .clicked()
            {
                self.review.toggle_link(signals, self.drawing.x);
                ui.close();
            }
        }
        if ui
            .button("Copy values")
            .on_hover_text("The drawn points as a table: chart,line,x_axis,x,y")
            .clicked()
        {
            ui.ctx().copy_text(socam_chart::export::csv(&self.drawing.seen[first..]));
        }
        if ui.button("Equal heights").on_hover_text("All plots of a column get the same height (E)").clicked()
        {
            self.done = Some(Done::Even);
        }
        if ui.button("Close plot").clicked() {
            self.done = Some(Done::Close(id));
        }
    }
}

/// Six dots, the usual sign of what can be dragged.
fn dots(ui: &Ui, rect: Rect, is_hovered: bool) {
    let colour = if is_hovered { ui.visuals().strong_text_color() } else { theme::weak(ui) };
    for (column, row) in (0..2).flat_map(|column| (0..3).map(move |row| (column, row))) {
        let at = rect.center() + vec2(5.0 * column as f32 - 2.5, 5.0 * row as f32 - 5.0);
        ui.painter().circle_filled(at, 1.3, colour);
    }
}
