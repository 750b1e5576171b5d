//! Units: one table, one grammar, and one rule for the names of columns.
//!
//! | who asks | what for |
//! |---|---|
//! | model files | [`parse`]: the unit of a parameter, its factor to SI and its dimension |
//! | readers of tables | [`column()`]: the channel of a column, by its name and the unit that the file states apart from it |
//! | mappings of files of other programs | [`conversion`], [`seconds`], [`is_counts`]: a unit as its author spells it |
//! | derived channels | [`Product`]: products and quotients of units, and how they are written |
//!
//! A new unit is a row of `table.rs`. A new unit of channels is a variant of [`Unit`] with its suffix, its symbol and its place in
//! [`Unit::ALL`].

mod channel;
mod column;
mod names;
mod plain;
mod product;
mod scale;
mod spelling;
mod symbol;
mod table;

pub use channel::{Conversion, Unit};
pub use column::{Column, Meaning, column};
pub use names::distinct_names;
pub use plain::plain_name;
pub use product::Product;
pub use scale::{Dimension, Scale, parse};
pub use spelling::{conversion, is_counts, seconds};
pub use table::model_file_names;
