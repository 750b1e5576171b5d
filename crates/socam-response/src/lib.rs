//! The frequency response of a model's channels, from recordings: what `identify --method frf` prints, and `socam.frf` of Python returns.
//!
//! [`estimate`](fn@estimate) reads the signals, cleans them as [`Settings`] say, and gives an [`Answer`] for each output: the lines of
//! `socam_frequency` beside the model's own response. [`document`](fn@document) is its JSON form.

pub mod answer;
mod beside;
pub mod document;
mod error;
mod estimate;
mod prepare;
mod signals;

pub use answer::Answer;
pub use beside::Beside;
pub use document::{SCHEMA, document};
pub use error::{ResponseError, Result};
pub use estimate::{Settings, estimate};
pub use signals::Pair;
