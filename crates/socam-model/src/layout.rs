//! The drivetrain as an iconic drawing: what stands where on a grid, and what is joined. No shapes, colours or text sizes;
//! whoever draws it chooses those.
//!
//! The longest chain runs from the drive at the left to the load at the right, node and link by turns, one column each.
//! Branches and links that close a loop get lanes of their own below it. Channels stand above what they watch, bearings and
//! springs to the ground below the node that they hold. A long chain may be wrapped ([`Layout::wrapped`]): its columns go
//! on in further rows, like lines of text.

mod builder;
mod element;
mod tree;

#[cfg(test)]
mod tests;

use crate::Model;
use builder::Builder;

pub use element::{Element, ElementKind, Joint, Layout};

impl Layout {
    /// The drivetrain in one piece, however long.
    pub fn of(model: &Model) -> Self {
        Self::wrapped(model, usize::MAX)
    }

    /// The drivetrain in rows of at most `columns` columns.
    pub fn wrapped(model: &Model, columns: usize) -> Self {
        let mut builder = Builder::default();
        builder.chain(model);
        builder.grounded(model);
        builder.channels(model);
        builder.effects(model);
        builder.finish(columns.max(1))
    }
}
