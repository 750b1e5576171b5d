//! The drawing of a model as plain shapes with roles, for everything that draws one: pages, pictures and windows. Who draws it chooses
//! colours by [`Paint`] and fonts; sizes and places are the same everywhere.
//!
//! Every element has a cell of its own, and labels are wrapped to the width of a cell, so that labels cannot overlap.
//!
//! ```
//! use socam_model::{Model, drawing::{Drawing, Paint, PlaceMark, Style}};
//!
//! let model = Model::builtin("two-mass").expect("an embedded model");
//! let drawing = Drawing::of(&model, &[("shaft", PlaceMark::Finding(1))], Style::default());
//! assert_eq!(drawing.items.iter().filter(|item| item.paint == Paint::Finding).count(), 1);
//! let shaft = drawing.places.iter().find(|place| place.name == "shaft").expect("a spring of the model");
//! assert_eq!(shaft.hint, "shaft: spring with damper");
//! ```

mod grid;
mod marks;
mod symbols;
mod wires;
mod words;

#[cfg(test)]
mod tests;

use crate::{
    Model, Role,
    layout::{Element, ElementKind, Layout},
};
use grid::{Grid, RowPosition, row_position};
pub use marks::{PlaceMark, diamond};

/// A point: x to the right, y downwards.
pub type Point = [f64; 2];

/// Sizes of a drawing. Lengths are in points of the text's size: labels are 11 high.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// Greatest number of columns; a longer chain continues in the next line.
    pub columns: usize,
    /// Width of a column, at least 64, which the widest symbol fills.
    pub column_width: f64,
}

impl Default for Style {
    /// The whole default bench in one line.
    fn default() -> Self {
        Self { columns: 13, column_width: 88.0 }
    }
}

/// Kind of part that a shape shows, which chooses its colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Paint {
    /// A wire between elements: a line.
    Wire,
    /// The lines of a symbol.
    Outline,
    /// A body: outlined and filled with a soft colour.
    Body,
    /// The teeth of a gear: a broken line.
    Teeth,
    /// Filled with the colour of lines.
    Solid,
    /// The box of a channel that the model predicts.
    Output,
    /// The box of a channel that drives the model, filled.
    Input,
    /// The frame around the place of a finding.
    Finding,
    /// The frame around the place of a competing explanation: a broken line.
    Rival,
    /// The diamond of a finding, filled with the colour of its frame.
    Diamond,
    /// The name of a place.
    Name,
    /// A letter within a symbol.
    Letter,
    /// The name of a channel that the model predicts.
    OutputName,
    /// The name of a channel that drives the model, on its filled box.
    InputName,
    /// The number of a finding, on its diamond.
    Number,
}

impl Paint {
    /// Height of text.
    #[must_use]
    pub fn text_size(self) -> f64 {
        match self {
            Self::Letter => 17.0,
            Self::OutputName | Self::InputName => 10.5,
            _ => 11.0,
        }
    }
}

/// A shape.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Joined points.
    Line(Vec<Point>),
    /// Joined points, with the last one joined to the first.
    Polygon(Vec<Point>),
    /// A rectangle with round corners.
    Rect {
        /// Upper left corner.
        from: Point,
        /// Lower right corner.
        to: Point,
        /// Radius of the corners.
        corner: f64,
    },
    /// A circle.
    Circle {
        /// Centre.
        centre: Point,
        /// Radius.
        radius: f64,
    },
    /// A line of text, centred.
    Text {
        /// Middle of its base line.
        at: Point,
        /// The text.
        text: String,
    },
}

/// A shape and what it is. Later items of a drawing lie on earlier ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// Kind of part that the shape shows.
    pub paint: Paint,
    /// The shape.
    pub shape: Shape,
}

/// The area of an element, to point at.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Name of the place or channel.
    pub name: String,
    /// Name and kind in words.
    pub hint: String,
    /// Kind of the element.
    pub kind: ElementKind,
    /// Middle of its symbol, which the wire runs through; of a channel, the middle of its box.
    pub middle: Point,
    /// Upper left corner.
    pub from: Point,
    /// Lower right corner.
    pub to: Point,
}

/// The drawing of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Width and height.
    pub size: Point,
    /// Shapes in the order in which they are drawn.
    pub items: Vec<Item>,
    /// Areas of the elements.
    pub places: Vec<Place>,
}

impl Drawing {
    /// Draws a model with marks at places or channels by name. A name that the model lacks is left out, and a place with a finding is not
    /// marked as a rival's.
    #[must_use]
    pub fn of(model: &Model, marks: &[(&str, PlaceMark)], style: Style) -> Self {
        let layout = Layout::wrapped(model, style.columns);
        let grid = Grid::new(&layout, style.column_width.max(64.0));
        let mut items = Vec::new();
        for element in &layout.elements {
            items.extend(marks::frame(element, &grid, marks));
        }
        items.extend(wires::all(&layout, &grid));
        for element in &layout.elements {
            draw(&mut items, element, &grid);
        }
        for element in &layout.elements {
            marks::diamonds(&mut items, element, &grid, marks);
        }
        let place = |element: &Element| {
            let [from, to] = grid.area(element);
            let y = match row_position(element.kind) {
                RowPosition::Chain => grid.wire(element),
                RowPosition::Sensor => 0.5 * (from[1] + to[1]),
                RowPosition::Grounded => from[1] + 0.5 * grid::GROUNDED,
            };
            Place {
                name: element.name.clone(),
                hint: words::hint(element, model.motion),
                kind: element.kind,
                middle: [grid.middle(element), y],
                from,
                to,
            }
        };
        let places = layout.elements.iter().map(place).collect();
        Self { size: grid.size(&layout), items, places }
    }
}

/// An element with its label.
fn draw(items: &mut Vec<Item>, element: &Element, grid: &Grid) {
    let x = grid.middle(element);
    match element.kind {
        ElementKind::Sensor { role, .. } => {
            let (paint, name) = match role {
                Role::Input => (Paint::Input, Paint::InputName),
                Role::Output => (Paint::Output, Paint::OutputName),
            };
            let [from, to] = grid.area(element);
            let shape = Shape::Rect { from: [from[0] + 1.5, from[1]], to: [to[0] - 1.5, to[1]], corner: 5.0 };
            items.push(Item { paint, shape });
            label(items, element, grid, (grid.upper(element) + 3.0, name));
        }
        kind if row_position(kind) == RowPosition::Grounded => {
            symbols::grounded(items, kind, [x, grid.upper(element)]);
            label(items, element, grid, (grid.upper(element) + grid::GROUNDED, Paint::Name));
        }
        kind => {
            label(items, element, grid, (grid.upper(element), Paint::Name));
            symbols::chain(items, kind, [x, grid.wire(element)]);
        }
    }
}

/// The lines of an element's label below `top`.
fn label(items: &mut Vec<Item>, element: &Element, grid: &Grid, (top, paint): (f64, Paint)) {
    let x = grid.middle(element);
    for (index, text) in grid.lines(element).into_iter().enumerate() {
        let at = [x, top + grid::LINE_HEIGHT * (index as f64 + 1.0) - 3.0];
        items.push(Item { paint, shape: Shape::Text { at, text } });
    }
}
