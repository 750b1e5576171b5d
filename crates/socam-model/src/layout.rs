//! The layout of a schematic drawing of the drivetrain: grid positions of its elements, and the pairs that are joined. Symbols, colours
//! and sizes are chosen by the caller that draws it.
//!
//! The longest chain runs from the drive at the left to the load at the right. Its nodes and links alternate, one per column.
//! Each branch, and each link that closes a loop, has a lane of its own below. A channel is above the element that it measures;
//! bearings and springs to the ground are below the node that they hold. A long chain may be wrapped ([`Layout::wrapped`]): its columns
//! continue in further rows, as lines of text do.
//!
//! ```
//! use socam_model::{Model, layout::{ElementKind, Layout}};
//!
//! let model = Model::builtin("two-mass").expect("an embedded model");
//! let layout = Layout::of(&model);
//! let shaft = layout.find("shaft").expect("a spring of the model");
//! assert_eq!(layout.elements[shaft].kind, ElementKind::Spring { damped: true });
//! assert_eq!((layout.columns, layout.rows), (3, 4));
//! assert!(Layout::wrapped(&model, 2).columns == 2);
//! ```

mod builder;
mod element;
mod tracks;
mod tree;

#[cfg(test)]
mod tests;

use crate::Model;
use builder::Builder;

pub use element::{Element, ElementKind, Joint, Layout};

impl Layout {
    /// The layout with the whole chain in one row of elements.
    pub fn of(model: &Model) -> Self {
        Self::wrapped(model, usize::MAX)
    }

    /// The layout with the chain wrapped into lines of at most `columns` columns (at least 1).
    pub fn wrapped(model: &Model, columns: usize) -> Self {
        let mut builder = Builder::default();
        builder.chain(model);
        builder.grounded(model);
        builder.channels(model);
        builder.effects(model);
        builder.finish(columns.max(1))
    }
}
