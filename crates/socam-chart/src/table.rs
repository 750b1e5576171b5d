//! A table that is sorted by its heads: numbers at the right, text at the left, rows that unfold.

mod order;

use egui::{
    Align, Button, Id, Layout, Pos2, RichText, Role, Sense, Shape, StrokeKind, TextWrapMode, Ui, UiBuilder,
    WidgetInfo, vec2,
};
use egui_extras::{Column as Width, TableBuilder, TableRow};

use crate::theme;
pub use order::{Key, Sorting, sorted};

/// A column.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    /// Name; empty for a column without head, which is not sorted by.
    pub head: &'static str,
    /// First width, points; a last column of text takes what is left, and at least this.
    pub width: f32,
    /// Whether its cells are numbers, which are aligned at the right.
    pub is_number: bool,
}

/// Draws the heads of a grid and ends its row.
pub fn heads(ui: &mut Ui, texts: &[&str]) {
    for text in texts {
        ui.label(RichText::new(*text).small().color(theme::weak(ui)));
    }
    ui.end_row();
}

/// A column of text.
#[must_use]
pub const fn text(head: &'static str, width: f32) -> Column {
    Column { head, width, is_number: false }
}

/// A column of numbers.
#[must_use]
pub const fn number(head: &'static str, width: f32) -> Column {
    Column { head, width, is_number: true }
}

/// Least part of its width that a column of text keeps in a narrow window, and the width below which it gives way no more, points.
const LEAST_PART: f32 = 0.5;
const LEAST_TEXT: f32 = 60.0;
const HEAD: f32 = 22.0;
const ROW: f32 = 23.0;

/// A table. The sorting and the widths of its columns are kept in egui's memory, by the table's name.
#[derive(Debug, Clone, Copy)]
pub struct Table<'a> {
    name: &'a str,
    columns: &'a [Column],
    /// Greatest height, points.
    pub most_height: f32,
}

impl<'a> Table<'a> {
    /// A table of this name, unique in the window.
    #[must_use]
    pub fn new(name: &'a str, columns: &'a [Column]) -> Self {
        Self { name, columns, most_height: f32::INFINITY }
    }

    /// Draws the rows; `key` and `cell` take a row and the number of a column.
    pub fn show<R>(
        self,
        ui: &mut Ui,
        rows: &[R],
        key: impl Fn(&R, usize) -> Key,
        cell: impl FnMut(&mut Ui, &R, usize),
    ) {
        self.show_unfolding(ui, rows, key, cell, |_| false, |_, _| {});
    }

    /// Draws the table with expandable rows: `details` fills the full width below each row for which `is_open` holds.
    pub fn show_unfolding<R>(
        self,
        ui: &mut Ui,
        rows: &[R],
        key: impl Fn(&R, usize) -> Key,
        mut cell: impl FnMut(&mut Ui, &R, usize),
        is_open: impl Fn(&R) -> bool,
        mut details: impl FnMut(&mut Ui, &R),
    ) {
        let place = self.place();
        let sorting = self.sorting(ui);
        let order = match sorting {
            Some(by) => {
                let keys: Vec<Key> = rows.iter().map(|row| key(row, by.column)).collect();
                sorted(&keys, by.is_descending)
            }
            None => (0..rows.len()).collect(),
        };
        // Each entry is a row and whether it is the row's details, whose height is that of the last pass.
        let lines: Vec<(usize, bool)> = order
            .into_iter()
            .flat_map(|row| [Some((row, false)), is_open(&rows[row]).then_some((row, true))])
            .flatten()
            .collect();
        let height_of = |row: usize| place.with(("details", row));
        let heights: Vec<f32> = lines
            .iter()
            .map(|(row, is_details)| {
                let known = || ui.data(|data| data.get_temp::<f32>(height_of(*row)));
                if *is_details { known().unwrap_or(4.0 * ROW) } else { ROW }
            })
            .collect();
        let mut wanted = sorting;
        let full = ui.available_rect_before_wrap().x_range();
        let unfolded = lines.iter().any(|(_, is_details)| *is_details);
        self.builder(ui, !unfolded).header(HEAD, |row| self.heads(row, &mut wanted)).body(|body| {
            body.heterogeneous_rows(heights.into_iter(), |mut row| {
                let (index, is_details) = lines[row.index()];
                if is_details {
                    row.col(|ui| {
                        let height = wide(ui, full, |ui| details(ui, &rows[index]));
                        let known = ui.data(|data| data.get_temp::<f32>(height_of(index)));
                        if known != Some(height) {
                            ui.data_mut(|data| data.insert_temp(height_of(index), height));
                            ui.ctx().request_repaint();
                        }
                    });
                    return;
                }
                for (number, column) in self.columns.iter().enumerate() {
                    row.col(|ui| aligned(ui, column.is_number, |ui| cell(ui, &rows[index], number)));
                }
            });
        });
        self.keep(ui, wanted);
    }

    /// For lists too long to be sorted in every pass: the caller keeps their `order` for [`Self::sorting`]. Rows are clicked as a whole;
    /// returns the one that was.
    pub fn show_ordered(
        self,
        ui: &mut Ui,
        order: &[usize],
        selected: Option<usize>,
        mut cell: impl FnMut(&mut Ui, usize, usize),
    ) -> Option<usize> {
        let mut wanted = self.sorting(ui);
        let mut clicked = None;
        let builder = self.builder(ui, true).sense(Sense::click());
        builder.header(HEAD, |row| self.heads(row, &mut wanted)).body(|body| {
            body.rows(ROW, order.len(), |mut row| {
                let index = order[row.index()];
                row.set_selected(selected == Some(index));
                for (number, column) in self.columns.iter().enumerate() {
                    row.col(|ui| {
                        ui.style_mut().interaction.selectable_labels = false;
                        aligned(ui, column.is_number, |ui| cell(ui, index, number));
                    });
                }
                clicked = clicked.or(row.response().clicked().then_some(index));
            });
        });
        self.keep(ui, wanted);
        clicked
    }

    /// The column that its rows are sorted by.
    #[must_use]
    pub fn sorting(&self, ui: &Ui) -> Option<Sorting> {
        let kept: Option<Sorting> = ui.data(|data| data.get_temp(self.place()));
        kept.filter(|sorting| sorting.column < self.columns.len())
    }

    fn place(&self) -> Id {
        Id::unique(("table", self.name))
    }

    fn keep(&self, ui: &Ui, sorting: Option<Sorting>) {
        if let Some(sorting) = sorting {
            ui.data_mut(|data| data.insert_temp(self.place(), sorting));
        }
    }

    fn heads(&self, mut row: TableRow<'_, '_>, sorting: &mut Option<Sorting>) {
        for (index, column) in self.columns.iter().enumerate() {
            row.col(|ui| {
                aligned(ui, column.is_number, |ui| head(ui, index, column, sorting));
            });
        }
    }

    /// First widths of the columns. Where there is less room than they want, those of text give way, if that is enough.
    fn widths(&self, room: f32) -> Vec<f32> {
        let over = self.columns.iter().map(|column| column.width).sum::<f32>() - room;
        let can_give = |column: &Column| {
            let least = (LEAST_PART * column.width).max(LEAST_TEXT);
            if column.is_number { 0.0 } else { (column.width - least).max(0.0) }
        };
        let all: f32 = self.columns.iter().map(can_give).sum();
        let share = if over <= 0.0 || over > all { 0.0 } else { over / all };
        self.columns.iter().map(|column| column.width - share * can_give(column)).collect()
    }

    /// Columns are resized at lines between them. These lines would cross the details of unfolded rows, and are left out there.
    fn builder<'b>(&self, ui: &'b mut Ui, has_lines: bool) -> TableBuilder<'b> {
        let gaps = ui.spacing().item_spacing.x * self.columns.len().saturating_sub(1) as f32;
        let widths = self.widths(ui.available_width() - gaps);
        // Widths that were dragged are kept for a room of about this size.
        let is_narrow = widths.iter().zip(self.columns).any(|(width, column)| *width < column.width);
        let mut builder = TableBuilder::new(ui)
            .id_salt((self.name, is_narrow))
            .striped(true)
            .auto_shrink([false, true])
            .min_scrolled_height(0.0)
            .max_scroll_height(self.most_height)
            .cell_layout(Layout::left_to_right(Align::Center));
        for (index, width) in widths.into_iter().enumerate() {
            let is_last = index + 1 == self.columns.len();
            // Numbers stay beside the others where the table is narrower than its room.
            let fills = is_last && !self.columns[index].is_number;
            let column = if fills { Width::remainder() } else { Width::initial(width).resizable(has_lines) };
            let least = if is_last { width } else { width.min(30.0) };
            builder = builder.column(column.at_least(least).clip(true));
        }
        builder
    }
}

fn aligned(ui: &mut Ui, is_number: bool, contents: impl FnOnce(&mut Ui)) {
    ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
    if is_number {
        ui.with_layout(Layout::right_to_left(Align::Center), contents);
    } else {
        contents(ui);
    }
}

/// Contents as wide as the table, below a row; returns their height.
fn wide(ui: &mut Ui, full: egui::Rangef, contents: impl FnOnce(&mut Ui)) -> f32 {
    let mut rect = ui.max_rect();
    (rect.min.x, rect.max.x) = (full.min + 12.0, full.max - 12.0);
    let mut inner = ui.new_child(UiBuilder::new().max_rect(rect).layout(Layout::top_down(Align::Min)));
    let clip = egui::Rect::from_x_y_ranges(full, ui.clip_rect().y_range());
    inner.set_clip_rect(clip);
    inner.style_mut().wrap_mode = Some(TextWrapMode::Wrap);
    contents(&mut inner);
    inner.min_rect().height() + 8.0
}

/// The head of a column: pressed, it sorts by the column, and pressed again the other way round.
fn head(ui: &mut Ui, index: usize, column: &Column, sorting: &mut Option<Sorting>) {
    if column.head.is_empty() {
        return;
    }
    let own = sorting.filter(|sorting| sorting.column == index);
    let text = egui::RichText::new(column.head).small().color(theme::weak(ui));
    let name = format!("Sort by {}", column.head);
    if own.is_some() && column.is_number {
        arrow(ui, own);
    }
    let button = ui.add(Button::new(text).frame(false));
    button.widget_info(|| WidgetInfo::selected(Role::Button, true, own.is_some(), &name));
    // A button without frame does not show by itself that the keyboard is on it.
    if button.has_focus() {
        let ring = ui.visuals().selection.stroke;
        ui.painter().rect_stroke(button.rect.expand(2.0), 3.0, ring, StrokeKind::Outside);
    }
    if own.is_some() && !column.is_number {
        arrow(ui, own);
    }
    if button.on_hover_text(name).clicked() {
        let is_descending = own.is_some_and(|own| !own.is_descending);
        *sorting = Some(Sorting { column: index, is_descending });
    }
}

/// A triangle that points to the greater values; fonts have none.
fn arrow(ui: &mut Ui, sorting: Option<Sorting>) {
    let (rect, _) = ui.allocate_exact_size(vec2(8.0, 8.0), Sense::hover());
    let is_descending = sorting.is_some_and(|sorting| sorting.is_descending);
    let (tip, base) = if is_descending { (rect.bottom(), rect.top()) } else { (rect.top(), rect.bottom()) };
    let corners =
        [Pos2::new(rect.left(), base), Pos2::new(rect.right(), base), Pos2::new(rect.center().x, tip)];
    ui.painter().add(Shape::convex_polygon(corners.to_vec(), theme::weak(ui), egui::Stroke::NONE));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_text_give_way_and_numbers_do_not() {
        let columns = [text("name", 160.0), text("", 20.0), number("value", 90.0), text("what", 200.0)];
        let table = Table::new("t", &columns);
        assert_eq!(table.widths(600.0), [160.0, 20.0, 90.0, 200.0]);
        assert_eq!(table.widths(380.0), [120.0, 20.0, 90.0, 150.0]);
        // Where it is not enough, the table is cut or scrolled by its view.
        assert_eq!(table.widths(200.0), [160.0, 20.0, 90.0, 200.0]);
    }
}
